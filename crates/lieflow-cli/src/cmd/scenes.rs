//! `lieflow scenes`: the bundled scenes, and what a scene can say about its problem.

use std::io::{self, Write};

use serde::Serialize;

use crate::args::ScenesArgs;
use crate::error::CliError;
use crate::output::{print, print_json, wrap};
use lieflow_model::kinds::{self, KINDS};
use lieflow_model::problem::Kind;
use lieflow_model::reader::help_for;
use lieflow_model::scene::{BUNDLED, Bundled, Scene, unknown_scene};

#[derive(Serialize)]
struct Listing {
    scenes: Vec<SceneEntry>,
    kinds: Vec<KindEntry>,
}

#[derive(Serialize)]
struct SceneEntry {
    name: &'static str,
    title: String,
    description: String,
    problem: &'static str,
    method: String,
    layer: &'static str,
    quantities: Vec<String>,
    text: &'static str,
}

#[derive(Serialize)]
struct KindEntry {
    name: &'static str,
    summary: &'static str,
    equation: &'static str,
    keys: Vec<KeyEntry>,
    quantities: Vec<QuantityEntry>,
}

#[derive(Serialize)]
struct KeyEntry {
    name: &'static str,
    meaning: &'static str,
    shape: String,
    optional: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    dimension: Option<String>,
}

#[derive(Serialize)]
struct QuantityEntry {
    name: &'static str,
    columns: Vec<String>,
    meaning: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    dimension: Option<String>,
}

fn scene_entry(bundled: &Bundled) -> Result<SceneEntry, CliError> {
    let scene = Scene::bundled(bundled.name)?;
    Ok(SceneEntry {
        name: bundled.name,
        description: bundled.description(),
        problem: scene.problem.kind().name,
        method: scene.method.label(),
        layer: scene.layer.name(),
        title: scene.title,
        quantities: scene.quantities,
        text: bundled.text,
    })
}

fn kind_entry(kind: &Kind) -> KindEntry {
    let keys = kind.keys.iter();
    let quantities = (kind.quantities)().into_iter();
    KindEntry {
        name: kind.name,
        summary: kind.summary,
        equation: kind.equation,
        keys: keys
            .map(|k| KeyEntry {
                name: k.name,
                meaning: k.meaning,
                shape: k.shape.to_string(),
                optional: k.optional,
                dimension: k.dimension.map(|dimension| dimension.to_string()),
            })
            .collect(),
        quantities: quantities
            .map(|q| QuantityEntry {
                name: q.name,
                columns: q.column_names(),
                meaning: q.meaning,
                dimension: q.dimension.map(|dimension| dimension.to_string()),
            })
            .collect(),
    }
}

/// The units of the numbers of a scene.
const UNITS: &str = "Numbers are in SI units, or in any other units that go together; a section [units] names them. Angles are in \
     radians: 5 degrees are \"5*deg\". Each number may be such a formula of the names in [problem.parameters].";

/// A line for each kind, and below it a line for each of its scenes.
fn overview(listing: &Listing) -> String {
    let mut text = String::from("Kinds of problems, and the scenes that come with the program:\n");
    for kind in &listing.kinds {
        text += &format!("\n{}: {}\n", kind.name, kind.summary);
        text += &scenes_of(kind, &listing.scenes);
    }
    text += "\nlieflow scenes rigid-body           keys, quantities and an example of a kind\n";
    text += "lieflow scenes wing-nut > my.toml   a scene to start from\n";
    text += "lieflow run wing-nut                run it\n";
    text + "lieflow scenes --all                all of this in full\n"
}

/// A line for each scene of a kind.
fn scenes_of(kind: &KindEntry, scenes: &[SceneEntry]) -> String {
    let scenes = scenes.iter().filter(|scene| scene.problem == kind.name);
    scenes.map(|scene| format!("    {:<22}{}\n", scene.name, scene.title)).collect()
}

/// The keys and the quantities of a kind.
fn meanings(kind: &KindEntry) -> String {
    let mut text = format!("\n[problem] kind = {:?}: {}\n", kind.name, kind.summary);
    text += &wrap(kind.equation, "  ");
    let with = |meaning: &str, dimension: &Option<String>| match dimension {
        Some(dimension) => format!("{meaning} [{dimension}]"),
        None => meaning.to_string(),
    };
    let keys = kind.keys.iter().map(|key| [key.name.into(), with(key.meaning, &key.dimension)]);
    text += &format!("\n{}", entries(["key", "meaning"], keys));
    // Quantities that follow each other and mean the same, as the angles of all sequences of axes, are one line.
    let quantity = |alike: &[QuantityEntry]| {
        let (first, others) = (&alike[0], &alike[1..]);
        let mut meaning = with(first.meaning, &first.dimension);
        if !others.is_empty() {
            let others: Vec<&str> = others.iter().map(|other| other.name).collect();
            meaning += &format!("; so are {}", others.join(", "));
        }
        [first.name.into(), shown_columns(&first.columns), meaning]
    };
    let quantities = kind.quantities.chunk_by(|a, b| a.meaning == b.meaning).map(quantity);
    text + "\n" + &entries(["quantity", "columns", "meaning"], quantities)
}

/// A table whose last column is text of any length.
fn entries<const N: usize>(header: [&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let rows: Vec<_> = [header.map(Into::into)].into_iter().chain(rows).collect();
    let width = |i: usize| rows.iter().map(|row| row[i].chars().count()).max().unwrap_or(0) + 2;
    let widths: Vec<usize> = (0..N - 1).map(width).collect();
    let indent = " ".repeat(2 + widths.iter().sum::<usize>());
    let entry = |row: &[String; N]| {
        let cells = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:width$}"));
        format!("  {}{}", cells.collect::<String>(), wrap(&row[N - 1], &indent).trim_start())
    };
    rows.iter().map(entry).collect()
}

/// The names of columns, in one cell of a table.
fn shown_columns(columns: &[String]) -> String {
    match columns {
        [first, .., last] if columns.len() > 4 => format!("{first} … {last}"),
        columns => columns.join(" "),
    }
}

/// All that is known of a kind, with a scene to start from.
fn kind_in_full(kind: &KindEntry, scenes: &[SceneEntry]) -> String {
    let mut text = format!("{}\n{UNITS}\n", meanings(kind).trim_start());
    text += &format!("\nScenes of this kind:\n{}", scenes_of(kind, scenes));
    if let Some(scene) = scenes.iter().find(|scene| scene.problem == kind.name) {
        text += &format!("\nAn example, from lieflow scenes {} > my.toml:\n\n", scene.name);
        text += &scene.text.lines().map(|line| format!("    {line}\n")).collect::<String>();
    }
    text
}

/// Everything of every scene and kind.
fn in_full(listing: &Listing) -> String {
    let mut text = String::new();
    for scene in &listing.scenes {
        text += &format!("{}: {}\n", scene.name, scene.title);
        text += &wrap(&scene.description, "    ");
    }
    for kind in &listing.kinds {
        text += &meanings(kind);
    }
    format!(
        "{text}\n{UNITS}\nRun one: lieflow run NAME. Start from one: lieflow scenes NAME > my.toml\n"
    )
}

fn all_scenes() -> Result<Vec<SceneEntry>, CliError> {
    BUNDLED.iter().map(scene_entry).collect()
}

fn one(name: &str, args: &ScenesArgs) -> Result<(), CliError> {
    let stem = name.strip_suffix(".toml").unwrap_or(name);
    let (scene, kind) = (Bundled::named(stem), kinds::named(name).ok());
    match (scene.filter(|_| !args.kind), kind) {
        (Some(scene), _) if args.json => print_json(&scene_entry(scene)?),
        (Some(scene), kind) => {
            if let Some(kind) = kind {
                let name = kind.name;
                // A reader of the scene alone does not miss it.
                let note = format!("note: {name} is a kind too: lieflow scenes --kind {name}");
                let _ = writeln!(io::stderr(), "{note}");
            }
            print(scene.text)
        }
        (None, Some(kind)) if args.json => print_json(&kind_entry(kind)),
        (None, Some(kind)) => print(&kind_in_full(&kind_entry(kind), &all_scenes()?)),
        (None, None) if args.kind => Err(unknown_kind(name)),
        (None, None) => Err(unknown_scene(name).into()),
    }
}

/// The error for a name that is no kind.
fn unknown_kind(name: &str) -> CliError {
    let of_scene = Scene::bundled(name.strip_suffix(".toml").unwrap_or(name));
    let kinds: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
    let help = match of_scene {
        Ok(scene) => format!("`{name}` is a scene of kind `{}`", scene.problem.kind().name),
        Err(_) => help_for(name, &kinds),
    };
    CliError::Message(format!("unknown kind of problem `{name}`: {help}"))
}

/// Run the command.
///
/// # Errors
/// An unknown name; standard output cannot be written.
pub fn run(args: &ScenesArgs) -> Result<(), CliError> {
    if let Some(name) = &args.name {
        return one(name, args);
    }
    let listing = Listing { scenes: all_scenes()?, kinds: KINDS.iter().map(kind_entry).collect() };
    match (args.json, args.all) {
        (true, _) => print_json(&listing),
        (false, true) => print(&in_full(&listing)),
        (false, false) => print(&overview(&listing)),
    }
}
