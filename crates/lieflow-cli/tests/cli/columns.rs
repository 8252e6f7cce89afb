//! The columns of a run: each name is there once, whatever quantities are written.

use std::collections::BTreeSet;

use crate::support::Folder;

/// Runs a scene over a short time, and returns the header of its rows.
fn header(folder: &Folder, scene: &str, sets: &[&str]) -> Vec<String> {
    let mut args =
        vec!["run", scene, "--no-page", "--error-check", "never", "--out", "out", "--set"];
    args.push("time.t_span=[0, 0.01]");
    args.extend(sets.iter().flat_map(|set| ["--set", set]));
    folder.lieflow(&args).ok();
    let summary = folder.json("out/summary.json");
    let (header, rows) = folder.trajectory();
    assert!(rows.iter().all(|row| row.len() == header.len()), "{scene}");
    assert!(summary["columns"].as_array().unwrap().iter().eq(&header), "{scene}");
    header
}

fn each_once(scene: &str, header: &[String]) {
    let names: BTreeSet<&String> = header.iter().collect();
    assert_eq!(names.len(), header.len(), "{scene}: {header:?}");
}

/// With the quantities of the scene, with those that are left to the program, and with all.
#[test]
fn every_bundled_scene_has_each_column_once() {
    let folder = Folder::new();
    let listing = folder.lieflow(&["scenes", "--json"]).ok();
    let listing: serde_json::Value = serde_json::from_str(&listing).unwrap();
    for scene in listing["scenes"].as_array().unwrap() {
        let name = scene["name"].as_str().unwrap();
        each_once(name, &header(&folder, name, &["output="]));
        // Its formulas and its times are of its own span.
        let text = folder.lieflow(&["scenes", name]).ok();
        if let Some((_, asked)) = text.split_once("quantities = ") {
            let asked = asked.split_once(']').unwrap().0;
            let set = format!("output.quantities={asked}]");
            each_once(name, &header(&folder, name, &["output=", &set]));
        }
    }
    // Both quantities have the columns of the second one.
    for (scene, both, columns) in [
        ("toda-lattice", "[\"diagonal\", \"matrix\"]", "t,l11,l22,l33,l44,l12,l13,l14,l23,l24,l34"),
        ("fodo-cell", "[\"particle\", \"phase_space\"]", "t,x,z,x_slope,z_slope"),
    ] {
        let set = format!("output.quantities={both}");
        assert_eq!(header(&folder, scene, &["output=", &set]).join(","), columns);
    }
}

#[test]
fn every_group_has_each_column_once() {
    let folder = Folder::new();
    let real = |rows: &str| format!("field = {rows}");
    let skew = "[[\"0\", \"t\"], [\"-t\", \"0\"]]";
    let complex = format!("field = {skew}\nfield_imaginary = [[\"t\", \"1\"], [\"1\", \"-t\"]]");
    for (group, field) in [
        ("so", real(skew)),
        ("sl", real("[[\"t\", \"1\"], [\"t\", \"-t\"]]")),
        ("gl", real("[[\"t\", \"1\"], [\"t\", \"0\"]]")),
        ("sp", real("[[\"t\", \"1\"], [\"t\", \"-t\"]]")),
        ("so(1,1)", real("[[\"0\", \"t\"], [\"t\", \"0\"]]")),
        ("u", complex.clone()),
        ("su", complex),
    ] {
        for action in ["translation", "linear", "conjugation", "coadjoint", "lagrangian"] {
            let start = match action {
                "translation" => "[[1, 0], [0, 1]]",
                "lagrangian" => "[[0.5]]",
                _ => "[[1, 0.5], [0.5, 2]]",
            };
            if action == "lagrangian" && group != "sp" {
                continue;
            }
            let text = format!(
                "[problem]\nkind = \"matrix-ode\"\ngroup = \"{group}\"\naction = \"{action}\"\n{field}\n\
                 start = {start}\n[time]\nt_span = [0, 1]\n"
            );
            folder.write("scene.toml", &text);
            let header = header(&folder, "scene.toml", &[]);
            each_once(&format!("{group}, {action}"), &header);
            let entry = if group.ends_with('u') { "im11" } else { "y11" };
            assert!(header.iter().any(|name| name == entry), "{header:?}");
        }
    }
}
