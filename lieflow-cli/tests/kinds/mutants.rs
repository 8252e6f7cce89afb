//! Every number of every bundled problem in turn as something else: refused with its line, or run; never a
//! panic, never for long.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use super::*;

const INSTEAD: [&str; 14] = [
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
];

/// Where the numbers of [problem] stand.
fn numbers(text: &str) -> Vec<core::ops::Range<usize>> {
    let start = text.find("[problem]").unwrap() + "[problem]".len();
    let end = text.find("[method]").unwrap();
    let (mut found, mut at) = (Vec::new(), start);
    let bytes = text.as_bytes();
    let mut quoted = false;
    while at < end {
        let c = bytes[at] as char;
        let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if c == '"' {
            quoted = !quoted;
        }
        if c == '#' && !quoted {
            at += text[at..].find('\n').unwrap();
        } else if !quoted && (c.is_ascii_digit() || c == '-') && !word(bytes[at - 1] as char) {
            let number = |c: char| c.is_ascii_digit() || "+-.e_".contains(c);
            let length = text[at..].find(|c| !number(c)).unwrap();
            found.push(at..at + length);
            at += length - 1;
        }
        at += 1;
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
fn every_number_may_be_another() {
    let (mut tried, mut refused, mut wrong) = (0, 0, Vec::new());
    for scene in BUNDLED {
        for place in numbers(scene.text) {
            for instead in INSTEAD {
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
    assert!(refused * 4 > tried, "{refused} of {tried}");
}
