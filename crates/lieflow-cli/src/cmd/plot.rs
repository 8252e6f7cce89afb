//! `lieflow plot`: columns of runs that were made before, those of several runs in one figure.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use lieflow_figures::{Page, Section};
use lieflow_model::reader::help_for;
use serde::Deserialize;

use crate::args::PlotArgs;
use crate::error::CliError;
use crate::output::{self, SUMMARY, Sample, TIME, TRAJECTORY, Written, together, unit_of};

/// Run the command.
///
/// # Errors
/// A folder without a run, a run that is named twice, a file that is no file of rows, a column that the runs do not have;
/// the page cannot be written, or would replace that of a run.
pub fn run(args: &PlotArgs) -> Result<(), CliError> {
    check(args)?;
    let names = names_of(&args.runs);
    let runs = args.runs.iter().zip(names).map(|(folder, name)| read(folder, name, args));
    let runs: Vec<Written> = runs.collect::<Result<_, _>>()?;
    let columns = columns_of(&runs, &args.columns)?;
    for column in [TIME].into_iter().chain(columns.iter().map(String::as_str)) {
        known_unit(&runs, column)?;
    }
    let title = match &runs[..] {
        [only] => only.name.clone(),
        _ => format!("{} runs", runs.len()),
    };
    let subtitle = runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>().join(", ");
    let page =
        Page::new(title, subtitle, vec![Section::new("Over time", together(&runs, &columns))]);
    output::make_folder(&args.out)?;
    let path = output::write_page(&args.out, "index.html", &page)?;
    let counted = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    output::print(&format!(
        "{} of {}: {}\n",
        counted(columns.len(), "column"),
        counted(runs.len(), "run"),
        path.display()
    ))
}

/// Checks what can be checked before the runs are read.
fn check(args: &PlotArgs) -> Result<(), CliError> {
    let wrong = |message: String| Err(CliError::Message(message));
    for (name, time) in [("from", args.from), ("to", args.to)] {
        if time.is_some_and(f64::is_nan) {
            return wrong(format!("--{name} NaN is no time, expected a number"));
        }
    }
    if let (Some(from), Some(to)) = (args.from, args.to)
        && from > to
    {
        return wrong(format!("--from {from} is after --to {to}"));
    }
    let same = |folder: &PathBuf| folder.canonicalize().unwrap_or_else(|_| folder.clone());
    for (i, folder) in args.runs.iter().enumerate() {
        if args.runs[..i].iter().any(|other| same(other) == same(folder)) {
            return wrong(format!("the run in `{}` is named twice", folder.display()));
        }
    }
    if TRAJECTORY.iter().chain([&SUMMARY]).any(|file| args.out.join(file).exists()) {
        return wrong(format!(
            "`{}` is the folder of a run, whose page would be replaced: name another folder with --out",
            args.out.display()
        ));
    }
    Ok(())
}

/// What the runs are called: their folders without what all paths begin with.
fn names_of(folders: &[PathBuf]) -> Vec<String> {
    let last = |folder: &PathBuf| match folder.file_name() {
        Some(name) => name.to_string_lossy().into_owned(),
        None => folder.display().to_string(),
    };
    let names: Vec<String> = folders.iter().map(last).collect();
    let is_twice = |name: &String| names.iter().filter(|other| *other == name).count() > 1;
    match names.iter().any(is_twice) {
        true => folders.iter().map(|folder| folder.display().to_string()).collect(),
        false => names,
    }
}

/// The columns to draw: those that are named, or all that every run has.
fn columns_of(runs: &[Written], wanted: &[String]) -> Result<Vec<String>, CliError> {
    let in_all = |column: &&String| runs.iter().all(|run| run.columns.contains(column));
    let all: Vec<String> = runs[0].columns.iter().filter(in_all).cloned().collect();
    if wanted.is_empty() {
        return match all.is_empty() {
            true => Err(CliError::Message("these runs have no column in common".into())),
            false => Ok(all),
        };
    }
    // A name without its numbers stands for all of that name: m for m1, m2 and m3, l for l1_1 to l12_12, l1 for its first row.
    let mut columns = Vec::new();
    for name in wanted.iter().map(|name| name.trim()) {
        let with = |is_rest: &dyn Fn(&str) -> bool| -> Vec<String> {
            let is_meant = |column: &&String| column.strip_prefix(name).is_some_and(is_rest);
            all.iter().filter(is_meant).cloned().collect()
        };
        let is_number = |text: &str| text.chars().all(|c| c.is_ascii_digit());
        let is_entry = |rest: &str| {
            rest.split_once('_').map_or([rest, ""], |(i, j)| [i, j]).into_iter().all(is_number)
        };
        // l1 is a row before it is a part of the name of row 11.
        let names = [
            with(&str::is_empty),
            with(&|rest| rest.strip_prefix('_').is_some_and(is_number)),
            with(&is_entry),
        ];
        let mut found = names.into_iter().find(|found| !found.is_empty()).unwrap_or_default();
        if found.is_empty() {
            let known: Vec<&str> = all.iter().map(String::as_str).collect();
            let help = help_for(name, &known);
            let message = format!("--columns: no column `{name}` in every run: {help}");
            return Err(CliError::Message(message));
        }
        found.retain(|column| !columns.contains(column));
        columns.append(&mut found);
    }
    Ok(columns)
}

/// Checks that the runs have one unit for a column, which its axis has. A unit that some of them do not state is noted:
/// the axis has none.
fn known_unit(runs: &[Written], column: &str) -> Result<(), CliError> {
    let in_words = |run: &Written| format!("`{}` in {}", run.name, run.units[column]);
    match unit_of(runs, column) {
        Err([a, b]) => Err(CliError::Message(format!(
            "{column} has different units: that of {}, and that of {}. One axis cannot show both: convert one of the \
             runs, or draw them apart",
            in_words(a),
            in_words(b)
        ))),
        Ok(None) => {
            let is_stated = |run: &&Written| run.units.contains_key(column);
            if let (Some(with), Some(without)) =
                (runs.iter().find(is_stated), runs.iter().find(|run| !is_stated(run)))
            {
                let (with, without) = (in_words(with), &without.name);
                eprintln!(
                    "note: {column} of {with}; `{without}` states no unit, so the axis has none"
                );
            }
            Ok(())
        }
        Ok(Some(_)) => Ok(()),
    }
}

/// What the summary of a run states.
#[derive(Default, Deserialize)]
struct Stated {
    /// The units, by the names of columns.
    #[serde(default)]
    units: BTreeMap<String, String>,
    #[serde(default)]
    completed: bool,
    /// The file of its rows.
    trajectory: Option<String>,
}

/// What the summary of a run states. A folder without a summary has the rows of a run that did not end.
fn stated(folder: &Path) -> Result<Stated, CliError> {
    let path = folder.join(SUMMARY);
    if !path.exists() {
        return Ok(Stated::default());
    }
    let text = fs::read_to_string(&path).map_err(CliError::io("read", &path))?;
    serde_json::from_str(&text).map_err(|error| {
        CliError::Message(format!("{}: {error}, expected the summary of a run", path.display()))
    })
}

/// The rows of a run between two times.
fn read(folder: &Path, name: String, args: &PlotArgs) -> Result<Written, CliError> {
    let Stated { units, completed, trajectory } = stated(folder)?;
    // A folder may have the rows of a complete run and those of a later one, which has no summary where it was killed.
    let [complete, later] = TRAJECTORY.map(|file| folder.join(file));
    let paths = [trajectory.map(|file| folder.join(file)), Some(later), Some(complete)];
    let Some(path) = &paths.into_iter().flatten().find(|path| path.exists()) else {
        let has = if folder.join(SUMMARY).exists() { "rows" } else { "run" };
        let message =
            format!("there is no {has} in `{}`: {} is missing", folder.display(), TRAJECTORY[0]);
        return Err(CliError::Message(message));
    };
    let file = File::open(path).map_err(CliError::io("read", path))?;
    let mut file = BufReader::new(file);
    let mut next = || -> Result<Option<String>, CliError> {
        let mut line = String::new();
        let length = file.read_line(&mut line).map_err(CliError::io("read", path))?;
        Ok((length > 0).then_some(line))
    };
    let wrong =
        |line: usize, what: &str| CliError::Message(format!("{}:{line}: {what}", path.display()));
    let header = next()?.unwrap_or_default();
    let mut columns = header.trim_end().split(',').map(|name| name.trim_matches('"').to_string());
    if columns.next().as_deref() != Some(TIME) {
        return Err(wrong(1, "expected the names of columns, t first"));
    }
    let columns: Vec<String> = columns.collect();
    let (mut rows, mut values, mut last) = (Sample::default(), Vec::new(), f64::NAN);
    let within =
        |t: f64| args.from.is_none_or(|from| t >= from) && args.to.is_none_or(|to| t <= to);
    let mut number = 1;
    while let Some(line) = next()? {
        number += 1;
        // A run that was killed may have written a part of its last row.
        if !completed && !line.ends_with('\n') {
            break;
        }
        values.clear();
        for value in line.split(',') {
            let value = value.trim().parse::<f64>();
            values.push(value.map_err(|_| wrong(number, "expected numbers between commas"))?);
        }
        if values.len() != columns.len() + 1 {
            let what = format!("{} numbers, expected {}", values.len(), columns.len() + 1);
            return Err(wrong(number, &what));
        }
        last = values[0];
        if within(last) {
            rows.see(values[0], &values[1..]);
        }
    }
    if rows.seen() == 0 {
        return Err(CliError::Message(format!("{} has no rows at these times", path.display())));
    }
    if !completed {
        let before = folder.join(TRAJECTORY[0]);
        let other = match before.exists() && before != *path {
            true => format!("; {} is that of a run before", before.display()),
            false => String::new(),
        };
        eprintln!(
            "note: `{name}` is a run that is not complete: its rows end at t = {last}{other}"
        );
    }
    Ok(Written { name, columns, units, rows })
}
