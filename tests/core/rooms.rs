//! The order of the rooms of every crate, by their paths: a file uses its own room and those below only.

use std::fs;
use std::path::{Path, PathBuf};

/// A crate whose root has a table of its rooms.
struct Crate {
    /// Its sources, from the root of the repository.
    src: &'static str,
    /// Its `lib.rs`.
    root: &'static str,
    /// Its rooms, lowest first.
    rooms: Vec<&'static str>,
}

fn crates() -> [Crate; 5] {
    macro_rules! of {
        ($src:literal) => {
            ($src, include_str!(concat!("../../", $src, "/lib.rs")))
        };
    }
    let all = [
        of!("src"),
        of!("crates/lieflow-model/src"),
        of!("crates/lieflow-figures/src"),
        of!("crates/lieflow-paper/src"),
        of!("crates/lieflow-cli/src"),
    ];
    all.map(|(src, root)| Crate { src, root, rooms: rooms(root) })
}

/// The rooms in the table of a `lib.rs`, lowest first.
fn rooms(root: &'static str) -> Vec<&'static str> {
    let rows = root.lines().filter_map(|line| line.strip_prefix("//! | "));
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
    for Crate { src, root, mut rooms } in crates() {
        let mut modules: Vec<_> = root
            .lines()
            .filter_map(|line| {
                line.trim_start_matches("pub ").strip_prefix("mod ")?.strip_suffix(';')
            })
            .filter(|&name| name != "prelude") // names from all rooms
            .collect();
        modules.sort_unstable();
        rooms.sort_unstable();
        assert_eq!(modules, rooms, "{src}");
    }
}

#[test]
fn no_file_uses_a_room_above_its_own() {
    let (mut arrows, mut paths) = (Vec::new(), 0);
    for Crate { src, rooms, .. } in crates() {
        let level = |room: &str| rooms.iter().position(|&r| r == room);
        let src = Path::new(env!("CARGO_MANIFEST_DIR")).join(src);
        let mut all = Vec::new();
        files(&src, &mut all);
        for file in all.iter().filter(|file| file.extension().is_some_and(|end| end == "rs")) {
            let inside = file.strip_prefix(&src).expect("a file of src");
            let Some(own) = level(room_of(inside)) else { continue };
            let text = fs::read_to_string(file).expect("a source file");
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
            for (n, line) in code.lines().enumerate() {
                for target in targets(line) {
                    paths += 1;
                    if level(target).is_none_or(|target| target > own) {
                        arrows.push(format!("{}:{}: {}", file.display(), n + 1, line.trim()));
                    }
                }
            }
        }
    }
    assert!(paths > 700, "{paths} paths: were the files read?");
    assert!(arrows.is_empty(), "arrows up, or past the rooms:\n{}", arrows.join("\n"));
}
