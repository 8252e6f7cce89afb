//! `lieflow scenes`: the bundled scenes, and what a scene can say about its problem.

use serde::Serialize;

use super::CliError;
use crate::args::ScenesArgs;
use crate::output::{print, print_json, table, wrap};
use lieflow_model::kinds::{KINDS, Kind};
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
    keys: Vec<Meaning>,
    quantities: Vec<Meaning>,
}

#[derive(Serialize)]
struct Meaning {
    name: &'static str,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    columns: Vec<String>,
    meaning: &'static str,
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
        keys: keys.map(|k| Meaning { name: k.name, columns: vec![], meaning: k.meaning }).collect(),
        quantities: quantities
            .map(|q| Meaning { name: q.name, columns: q.column_names(), meaning: q.meaning })
            .collect(),
    }
}

fn in_words(listing: &Listing) -> String {
    let mut text = String::new();
    for scene in &listing.scenes {
        text += &format!("{}: {}\n", scene.name, scene.title);
        text += &wrap(&scene.description, "    ");
    }
    for kind in &listing.kinds {
        text += &format!("\n[problem] kind = {:?}: {}\n", kind.name, kind.summary);
        text += &wrap(kind.equation, "  ");
        for (heading, list) in [("key", &kind.keys), ("quantity", &kind.quantities)] {
            let rows = list.iter().map(|m| [m.name.into(), m.meaning.into()]);
            text += &table([heading, "meaning"], rows);
        }
    }
    text + "\nRun one: lieflow run NAME. Start from one: lieflow scenes NAME > my.toml\n"
}

/// Run the command.
///
/// # Errors
/// An unknown name; standard output cannot be written.
pub fn run(args: &ScenesArgs) -> Result<(), CliError> {
    if let Some(name) = &args.name {
        let stem = name.strip_suffix(".toml").unwrap_or(name);
        let scene = Bundled::named(stem).ok_or_else(|| unknown_scene(name))?;
        return match args.json {
            true => print_json(&scene_entry(scene)?),
            false => print(scene.text),
        };
    }
    let scenes = BUNDLED.iter().map(scene_entry).collect::<Result<_, _>>()?;
    let listing = Listing { scenes, kinds: KINDS.iter().map(kind_entry).collect() };
    match args.json {
        true => print_json(&listing),
        false => print(&in_words(&listing)),
    }
}
