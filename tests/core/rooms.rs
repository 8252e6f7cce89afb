//! The order of the rooms of every crate, by their paths: a file uses its own room and those below only.

use std::fs;
use std::path::{Path, PathBuf};

/// The root of the repository.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// A crate whose root has a table of its rooms.
struct Crate {
    /// Its sources, from the root of the repository.
    src: &'static str,
    /// Its `lib.rs`.
    root: &'static str,
    /// Its rooms, lowest first.
    rooms: Vec<&'static str>,
}

fn crates() -> [Crate; 6] {
    macro_rules! of {
        ($src:literal) => {
            ($src, include_str!(concat!("../../", $src, "/lib.rs")))
        };
    }
    let all = [
        of!("src"),
        of!("crates/lieflow-runs/src"),
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
        let src = Path::new(ROOT).join(src);
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

/// Each `super::module` in the code of a file, also in lists `super::{a::B, c::D}`.
fn siblings(code: &str) -> Vec<&str> {
    let name = |text: &str| text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(0);
    let mut all = Vec::new();
    // `super::super::x` is of the folder above.
    for rest in code.split("super::").skip(1).filter(|rest| !rest.starts_with("super")) {
        match rest.strip_prefix('{') {
            Some(list) => {
                let list = list.split(['}', ';']).next().unwrap_or_default();
                let parts = list.split(',').map(str::trim).filter(|part| part.contains("::"));
                all.extend(parts.map(|part| &part[..name(part)]));
            }
            None => all.push(&rest[..name(rest)]),
        }
    }
    all
}

/// The files of one folder that can be reached from each other, in groups of more than one.
fn circles(uses: &[(String, Vec<usize>)]) -> Vec<Vec<&str>> {
    let reach = |from: usize| {
        let (mut seen, mut next) = (vec![false; uses.len()], vec![from]);
        while let Some(file) = next.pop() {
            let new = uses[file].1.iter().filter(|&&to| !core::mem::replace(&mut seen[to], true));
            next.extend(new);
        }
        seen
    };
    let reached: Vec<_> = (0..uses.len()).map(reach).collect();
    let mut groups: Vec<Vec<&str>> = Vec::new();
    for a in 0..uses.len() {
        let with = |&b: &usize| reached[a][b] && reached[b][a];
        let group: Vec<&str> = (0..uses.len()).filter(with).map(|b| uses[b].0.as_str()).collect();
        if group.len() > 1 && !groups.contains(&group) {
            groups.push(group);
        }
    }
    groups
}

#[test]
fn no_circle_of_files_is_larger_than_two() {
    let root = Path::new(ROOT);
    let mut all = Vec::new();
    crates().iter().for_each(|of| files(&root.join(of.src), &mut all));
    let mut folders: Vec<&Path> = all.iter().filter_map(|file| file.parent()).collect();
    folders.sort_unstable();
    folders.dedup();
    let (mut large, mut paths) = (Vec::new(), 0);
    for folder in folders {
        let inside: Vec<(String, String)> = all
            .iter()
            .filter(|file| file.parent() == Some(folder))
            .filter(|file| file.extension().is_some_and(|end| end == "rs"))
            .filter_map(|file| Some((file.file_stem()?.to_str()?.to_owned(), file)))
            .filter(|(name, _)| !["mod", "lib", "main"].contains(&name.as_str()))
            .map(|(name, file)| (name, fs::read_to_string(file).expect("a source file")))
            .collect();
        let place = |name: &str| inside.iter().position(|(other, _)| other == name);
        let uses: Vec<(String, Vec<usize>)> = inside
            .iter()
            .map(|(name, text)| {
                let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
                let code: Vec<&str> =
                    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect();
                let code = code.join("\n");
                (name.clone(), siblings(&code).into_iter().filter_map(place).collect())
            })
            .collect();
        paths += uses.iter().map(|(_, to)| to.len()).sum::<usize>();
        let circles = circles(&uses).into_iter().filter(|circle| circle.len() > 2);
        large.extend(circles.map(|circle| format!("{}: {}", folder.display(), circle.join(", "))));
    }
    assert!(paths > 200, "{paths} paths: were the files read?");
    assert!(large.is_empty(), "circles:\n{}", large.join("\n"));
}
