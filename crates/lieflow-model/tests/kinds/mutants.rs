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
