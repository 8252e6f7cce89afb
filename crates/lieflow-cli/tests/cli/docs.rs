//! The scenes on the pages of the documentation, run by the program.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::Folder;

/// The folder of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// README.md and the pages of docs.
fn pages() -> Vec<PathBuf> {
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let mut pages: Vec<_> =
        docs.filter(|path| path.extension().is_some_and(|end| end == "md")).collect();
    pages.push(root().join("README.md"));
    pages.sort();
    pages
}

/// The blocks of code of a page, each with its language.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let fenced = page.split("\n```").skip(1).step_by(2);
    fenced.filter_map(|block| block.split_once('\n')).collect()
}

/// A scene as its sections, each with its header.
#[derive(Clone, Default)]
struct Sections(Vec<(String, String)>);

impl Sections {
    fn read(text: &str) -> Self {
        let mut sections = vec![(String::new(), String::new())];
        for line in text.lines() {
            match line.starts_with('[') && line.trim_end().ends_with(']') {
                true => sections.push((line.trim_end().into(), String::new())),
                false => sections.last_mut().unwrap().1 += &format!("{line}\n"),
            }
        }
        Sections(sections)
    }

    fn has(&self, header: &str) -> bool {
        self.0.iter().any(|section| section.0 == header)
    }

    /// Put the sections of `other` in place of those of the same header; tables of a list are added.
    fn overlay(&mut self, other: Sections) {
        for (header, body) in other.0 {
            if !header.starts_with("[[") {
                self.0.retain(|section| section.0 != header);
            }
            self.0.push((header, body));
        }
    }

    fn text(&self) -> String {
        let mut sections = self.0.clone();
        sections.sort_by_key(|(header, _)| !header.is_empty());
        sections.iter().map(|(header, body)| format!("{header}\n{body}")).collect()
    }
}

#[test]
fn every_scene_on_a_page_runs() {
    let mut count = 0;
    for page in pages() {
        let folder = Folder::new();
        let text = fs::read_to_string(&page).unwrap();
        let mut scene = Sections::default();
        let blocks = blocks(&text);
        for (i, (language, block)) in blocks.iter().enumerate() {
            if *language != "toml" || block.contains("[dependencies]") {
                continue;
            }
            let next = Sections::read(block);
            match next.has("[problem]") {
                true => scene = next,
                false => scene.overlay(next),
            }
            if !scene.has("[problem]") {
                scene.overlay(Sections::read("[problem]\nkind = \"rigid-body\"\ninertia = [1.0, 2.0, 3.0]\nomega_body = [0.1, 1.0, 0.0]\n"));
            }
            if !scene.has("[time]") {
                scene.overlay(Sections::read("[time]\nt_span = [0.0, 1.0]\n"));
            }
            // A page shows the file of samples after the scene that names it.
            let file = blocks.get(i + 1).filter(|(language, _)| *language == "text");
            if let (true, Some((_, rows))) = (block.contains("samples = \"wheel.csv\""), file) {
                folder.write("wheel.csv", rows);
            }
            folder.write("scene.toml", &scene.text());
            let run = folder.lieflow(&["run", "scene.toml"]);
            let name = page.file_name().unwrap().display();
            assert_eq!(
                run.code,
                Some(0),
                "{name}, block {}:\n{}\n{}",
                i + 1,
                scene.text(),
                run.err
            );
            count += 1;
        }
    }
    assert!(count >= 9, "only {count} scenes were found");
}

/// The scenes that `lieflow run --help` shows.
#[test]
fn every_scene_of_the_help_runs() {
    let folder = Folder::new();
    let help = folder.lieflow(&["run", "--help"]).ok();
    let parts: Vec<&str> = help.split("  [problem]\n").collect();
    assert!(parts.len() >= 3, "{help}");
    for part in &parts[1..] {
        let scene: Vec<&str> = part.lines().map_while(|line| line.strip_prefix("  ")).collect();
        folder.write("scene.toml", &format!("[problem]\n{}\n", scene.join("\n")));
        folder.lieflow(&["run", "scene.toml"]).ok();
    }
}

/// The one result of the README: how far both methods have left the rotations after 8000 steps.
#[test]
fn the_result_of_the_readme() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let folder = Folder::new();
    let defect = |method: &str| {
        let method = format!("method.name={method}");
        let quantities = "output.quantities=[\"attitude_defect\"]";
        let set = ["--set", &method, "--set", quantities, "--set", "method.map="];
        let run = ["run", "asymmetric-top", "--out", "out", "--no-page"];
        folder.lieflow(&[&run[..], &set].concat()).ok();
        let summary = folder.json("out/summary.json");
        assert_eq!((&summary["steps"], &summary["t_end"]), (&8000.into(), &400.0.into()));
        summary["final"]["attitude_defect"].as_f64().unwrap()
    };
    let (classical, lie) = (defect("rk4"), defect("rkmk4"));
    assert!(readme.contains(&format!("the rotations by {classical:.1e}.")), "{classical:e}");
    assert!(readme.contains("has left them by 2e-15.") && lie < 1e-14, "{lie:e}");
}

/// A user has nalgebra and faer through lieflow alone.
#[test]
fn programs_take_matrices_from_lieflow() {
    fn sources(folder: &Path, all: &mut Vec<PathBuf>) {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            match path.is_dir() {
                true => sources(&path, all),
                false => all.push(path),
            }
        }
    }
    let (mut all, mut wrong) = (pages(), Vec::new());
    ["src", "examples"].iter().for_each(|folder| sources(&root().join(folder), &mut all));
    for path in
        all.iter().filter(|path| path.extension().is_some_and(|end| end == "rs" || end == "md"))
    {
        let is_src = path.starts_with(root().join("src"));
        for line in fs::read_to_string(path).unwrap().lines() {
            // Of the sources, the programs in comments.
            let comment = line.trim_start().strip_prefix("//");
            let program = if is_src { comment.unwrap_or_default() } else { line };
            let words = program.trim_start_matches(['/', '!', ' ', '#']);
            if ["use nalgebra", "use faer"].iter().any(|start| words.starts_with(start)) {
                wrong.push(format!("{}: {line}", path.display()));
            }
        }
    }
    assert!(all.len() > 100 && wrong.is_empty(), "{wrong:#?}");
}

/// CONTRIBUTING.md prints a kind as it is compiled.
#[test]
fn the_kind_that_is_printed_is_a_file_of_the_model() {
    let page = fs::read_to_string(root().join("CONTRIBUTING.md")).unwrap();
    let file = fs::read_to_string(root().join("crates/lieflow-model/src/kinds/spin.rs")).unwrap();
    let kind = blocks(&page).into_iter().find(|(_, code)| code.contains("const KIND: Kind"));
    assert_eq!(kind.unwrap(), ("rust", file.trim_end()));
}

/// Each sentence of the README that promises something stands in promises.md, with a test that is there.
#[test]
fn each_promise_of_the_readme_has_a_test() {
    let [readme, promises] = ["README.md", "docs/promises.md"]
        .map(|page| fs::read_to_string(root().join(page)).unwrap());
    let one_line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let readme = one_line(&readme);
    let table = promises.split("| the README says | test |").nth(1).unwrap();
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let [says, tests] = cells[..] else { panic!("{row}") };
        assert!(readme.contains(says), "not in the README: {says}");
        let files = tests.split('`').skip(1).step_by(2).filter(|name| name.contains('/'));
        for file in files {
            assert!(root().join(file).exists(), "{says}: there is no {file}");
            count += 1;
        }
    }
    assert!(count > 10, "{count}");
}
