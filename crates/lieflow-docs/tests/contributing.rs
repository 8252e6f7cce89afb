//! What CONTRIBUTING.md says of the files of the repository.

use std::fs;
use std::path::{Path, PathBuf};

/// The folder of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap()
}

/// CONTRIBUTING.md prints a method as it is compiled and measured.
#[test]
fn the_method_that_is_printed_is_the_one_that_is_measured() {
    let page = read("CONTRIBUTING.md");
    let mut programs =
        page.split("\n```rust\n").skip(1).filter_map(|rest| rest.split("\n```").next());
    let method = programs.find(|program| program.contains("Method<P> for Cf2<Psi>")).unwrap();
    let file = read("tests/orders/cf2.rs");
    assert!(file.starts_with(&(method.replace("crate::", "lieflow::") + "\n\n")), "{method}");
}

/// A scene that comes with the program is in the list of scenes, and in a heading or a paragraph of the gallery.
#[test]
fn each_bundled_scene_is_listed_and_in_the_gallery() {
    let folder = root().join("crates/lieflow-model/scenes");
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes: Vec<String> = paths
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    assert!(scenes.len() > 40, "{scenes:?}");
    let list = read("crates/lieflow-model/src/scene/bundled.rs");
    let gallery = read("docs/gallery.md");
    for scene in &scenes {
        assert!(
            list.contains(&format!("    \"{scene}\",\n")),
            "{scene} is not in scene/bundled.rs"
        );
        assert!(gallery.contains(&format!("`{scene}`")), "{scene} is not in docs/gallery.md");
    }
}
