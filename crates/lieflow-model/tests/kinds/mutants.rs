//! Every number and every word of every bundled problem in turn as something else: refused with its line, or
//! run; never a panic, never for long.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use super::*;

const INSTEAD: [&str; 15] = [
    "0",
    "-1",
    "1",
    "2",
    "3",
    "0.5",
    "1e308",
    "-1e308",
    "1e-320",
    "nan",
    "inf",
    "\"one\"",
    "[]",
    "1000000007",
    "0, 0",
];

/// Instead of a word; the kind itself is looked at elsewhere.
const INSTEAD_OF_WORDS: [&str; 5] = ["\"x\"", "\"\"", "7", "[]", "{}"];

/// Where the numbers and the words of [problem] stand.
fn places(text: &str) -> Vec<core::ops::Range<usize>> {
    let start = text.find("[problem]").unwrap() + "[problem]".len();
    let end = text.find("[method]").unwrap();
    let (mut found, mut at) = (Vec::new(), start);
    let bytes = text.as_bytes();
    while at < end {
        let c = bytes[at] as char;
        let in_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let length = match c {
            '#' => text[at..].find('\n').unwrap(),
            '"' => 2 + text[at + 1..].find('"').unwrap(),
            '-' | '0'..='9' if !in_word(bytes[at - 1] as char) => {
                let number = |c: char| c.is_ascii_digit() || "+-.e_".contains(c);
                text[at..].find(|c| !number(c)).unwrap()
            }
            _ => 1,
        };
        if length > 1 && c != '#' || c.is_ascii_digit() && !in_word(bytes[at - 1] as char) {
            found.push(at..at + length);
        }
        at += length;
    }
    found
}

/// What happens to a scene: its message where it is refused.
fn outcome(name: &str, text: &str) -> Option<String> {
    let scene = match Scene::parse(name, text) {
        Ok(scene) => scene,
        Err(error) => {
            assert!(error.line().is_some(), "no line: {error}");
            return Some(error.to_string());
        }
    };
    let model = scene.model().unwrap();
    let [t0, _] = scene.grid.t_span();
    let grid = lieflow::TimeGrid::with_steps([t0, t0 + 2.0 * scene.grid.h()], 2).unwrap();
    // It may fail, with a reason.
    let _ = model.run(&scene.method, &grid, &lieflow::SaveAt::Every(1), &mut |_, _| {});
    let _ = (scene.problem.facts(), scene.problem.warnings());
    None
}

#[test]
fn every_value_may_be_another() {
    let (mut tried, mut refused, mut wrong, mut several) = (0, 0, Vec::new(), Vec::new());
    for scene in BUNDLED {
        for place in places(scene.text) {
            let word = scene.text[place.clone()].starts_with('"');
            let instead: &[&str] = if word { &INSTEAD_OF_WORDS } else { &INSTEAD };
            for instead in instead {
                let text =
                    format!("{}{instead}{}", &scene.text[..place.start], &scene.text[place.end..]);
                let begin = Instant::now();
                let happened = catch_unwind(AssertUnwindSafe(|| outcome(scene.name, &text)));
                let line = 1 + scene.text[..place.start].matches('\n').count();
                let what =
                    format!("{}:{line}: {} as {instead}", scene.name, &scene.text[place.clone()]);
                tried += 1;
                match happened {
                    Ok(Some(message)) => {
                        refused += 1;
                        // One number is one mistake, but for a size, and a start at which formulas have no value.
                        let is_number = !word && *instead != "0, 0";
                        let of_several = ["a whole number, 1 to", "at the start"];
                        let is_one = !of_several.iter().any(|words| message.contains(words));
                        if is_number && is_one && message.contains(" mistakes") {
                            several.push(format!("{what}\n{message}\n"));
                        }
                        println!("{what}\n    {}", message.replace('\n', "\n    "));
                    }
                    Ok(None) => {}
                    Err(_) => wrong.push(format!("{what}: a panic")),
                }
                if begin.elapsed() > Duration::from_secs(10) {
                    wrong.push(format!("{what}: {:?}", begin.elapsed()));
                }
            }
        }
    }
    println!("{tried} tried, {refused} refused");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(several.is_empty(), "{} of {refused}\n{}", several.len(), several.join("\n"));
    assert!(refused * 4 > tried, "{refused} of {tried}");
}

/// Values that are wrong for most keys.
const WRONG: [&str; 5] = ["-1", "0", "1e308", "nan", "\"?\""];

/// The place of the first number, or else of the first text, of the value of a key in a line.
fn value_in(line: &str) -> Option<core::ops::Range<usize>> {
    let start = line.find(" = ")? + 3;
    let value = &line[start..line.find(" #").unwrap_or(line.len()).max(start)];
    let digit = value.find(|c: char| c.is_ascii_digit());
    if let Some(mut first) = digit.filter(|&at| !value[..at].contains('"')) {
        first -= usize::from(value[..first].ends_with('-'));
        let number = |c: char| c.is_ascii_digit() || "+-._e".contains(c);
        let length = value[first..].find(|c| !number(c)).unwrap_or(value.len() - first);
        return Some(start + first..start + first + length);
    }
    let quote = value.find('"')?;
    Some(start + quote..start + quote + 2 + value[quote + 1..].find('"')?)
}

/// The lines of the mistakes of a scene.
fn lines_of(name: &str, text: &str) -> Vec<usize> {
    let Err(error) = Scene::parse(name, text) else { return Vec::new() };
    let message = error.to_string();
    let places = message.lines().filter_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
    places.filter_map(|place| place.split(':').next()?.parse().ok()).collect()
}

/// Keys whose value can be judged only with that of others: those, or none for the whole problem.
const NEEDS: &[(&str, &[&str])] = &[
    ("plot", &[]),
    ("when", &[]),
    ("times", &["t_span"]),
    ("t_span", &["samples", "interpolation", "name", "space"]),
    ("interpolation", &["name", "space"]),
    ("name", &["name", "space", "start"]),
    ("start", &["space"]),
    ("hamiltonian", &["algebra"]),
    ("momentum", &["algebra"]),
    ("amplitudes", &["energies"]),
    ("positions", &["momenta"]),
    ("jets", &["n", "surface"]),
    ("modes", &["n", "surface"]),
    ("{ latitude", &["n", "surface"]),
];

/// Can the value of a key be judged only with that of another one?
fn needs(key: &str, other: &str) -> bool {
    let of_key = NEEDS.iter().find(|(name, _)| *name == key);
    other == "kind"
        || of_key.is_some_and(|(_, others)| others.is_empty() || others.contains(&other))
}

/// Two wrong values in different lines of a scene are told together.
#[test]
fn two_wrong_values_are_told_together() {
    let (mut pairs, mut lost) = (0, std::collections::BTreeSet::new());
    for scene in BUNDLED {
        let lines: Vec<&str> = scene.text.lines().collect();
        let with = |changes: &[&(usize, String)]| {
            let mut lines = lines.clone();
            changes.iter().for_each(|(i, line)| lines[*i] = line);
            lines_of(scene.name, &lines.join("\n"))
        };
        let mut wrong = Vec::new();
        for (i, line) in lines.iter().enumerate().filter(|(_, line)| !line.starts_with('#')) {
            let Some(place) = value_in(line) else { continue };
            let changed =
                WRONG.map(|x| format!("{}{x}{}", &line[..place.start], &line[place.end..]));
            let of_line =
                changed.map(|line| (i, line)).into_iter().filter(|one| with(&[one]) == [i + 1]);
            wrong.extend(of_line);
        }
        for (k, one) in wrong.iter().enumerate() {
            for other in wrong[k..].iter().filter(|other| other.0 > one.0) {
                pairs += 1;
                let told = with(&[one, other]);
                let key = |i: usize| lines[i].split(" = ").next().unwrap_or_default().trim();
                for (mine, its) in [(one.0, other.0), (other.0, one.0)] {
                    if !told.contains(&(mine + 1)) && !needs(key(mine), key(its)) {
                        lost.insert((scene.name, key(mine), key(its)));
                    }
                }
            }
        }
    }
    println!("{pairs} pairs");
    assert!(pairs > 2000 && lost.is_empty(), "{pairs} pairs, {lost:#?}");
}
