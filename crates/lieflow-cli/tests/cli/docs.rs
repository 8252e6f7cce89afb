//! The scenes on the pages of the documentation, run by the program.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::Folder;

/// README.md and the pages of docs.
fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let docs = fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let mut pages: Vec<_> =
        docs.filter(|path| path.extension().is_some_and(|end| end == "md")).collect();
    pages.push(root.join("README.md"));
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
