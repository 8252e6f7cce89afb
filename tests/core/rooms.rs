//! The order of the library's rooms, by its paths: a file uses its own room and those below only.

use std::fs;
use std::path::{Path, PathBuf};

const LIB: &str = include_str!("../../src/lib.rs");

/// The rooms in the table of `lib.rs`, lowest first.
fn rooms() -> Vec<&'static str> {
    let rows = LIB.lines().filter_map(|line| line.strip_prefix("//! | "));
    rows.filter_map(|row| row.split('|').next()?.split('`').nth(1)).collect()
}

fn files(dir: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(dir).expect("a folder of src").map(|entry| entry.expect("an entry")) {
        match entry.path() {
            path if path.is_dir() => files(&path, out),
            path => out.push(path),
        }
    }
}

/// The room that a file belongs to, by its path below src.
fn room_of(path: &Path) -> &str {
    let first = path.iter().next().and_then(|name| name.to_str()).expect("a name");
    first.strip_suffix(".rs").unwrap_or(first)
}

/// Each path `crate::room` in the code of a line, without comments.
fn targets(line: &str) -> impl Iterator<Item = &str> {
    let code = line.split("//").next().unwrap_or_default();
    code.split("crate::").skip(1).map(|rest| {
        rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or_default()
    })
}

#[test]
fn every_room_is_in_the_table() {
    let mut modules: Vec<_> = LIB
        .lines()
        .filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod ")?.strip_suffix(';'))
        .filter(|&name| name != "prelude") // names from all rooms
        .collect();
    let mut rooms = rooms();
    modules.sort_unstable();
    rooms.sort_unstable();
    assert_eq!(modules, rooms);
}

#[test]
fn no_file_uses_a_room_above_its_own() {
    let rooms = rooms();
    let level = |room: &str| rooms.iter().position(|&r| r == room);
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut all, mut arrows, mut paths) = (Vec::new(), Vec::new(), 0);
    files(&src, &mut all);
    for file in &all {
        let inside = file.strip_prefix(&src).expect("a file of src");
        let Some(own) = level(room_of(inside)) else { continue };
        let text = fs::read_to_string(file).expect("a source file");
        let code = text.split("#[cfg(test)]\nmod").next().unwrap_or_default();
        for (n, line) in code.lines().enumerate() {
            for target in targets(line) {
                paths += 1;
                if level(target).is_none_or(|target| target > own) {
                    arrows.push(format!("src/{}:{}: {}", inside.display(), n + 1, line.trim()));
                }
            }
        }
    }
    assert!(paths > 500, "{paths} paths in {} files: were they read?", all.len());
    assert!(arrows.is_empty(), "arrows up, or past the rooms:\n{}", arrows.join("\n"));
}
