//! `lieflow scenes`, `methods`, `completions` and the help texts.

use std::process::{Command, Stdio};

use crate::support::{Folder, program};
use lieflow::catalog::{MAPS, TABLEAUS, all_methods};
use lieflow_model::kinds::KINDS;
use lieflow_model::scene::{BUNDLED, Scene};
use serde_json::Value;

fn names(list: &Value) -> Vec<&str> {
    list.as_array().unwrap().iter().map(|entry| entry["name"].as_str().unwrap()).collect()
}

#[test]
fn scenes_are_listed_and_printed() {
    let folder = Folder::new();
    let listed = folder.lieflow(&["scenes"]).ok();
    let json: Value = serde_json::from_str(&folder.lieflow(&["scenes", "--json"]).ok()).unwrap();
    assert_eq!(names(&json["scenes"]), BUNDLED.iter().map(|s| s.name).collect::<Vec<_>>());
    assert_eq!(names(&json["kinds"]), KINDS.iter().map(|k| k.name).collect::<Vec<_>>());
    for scene in BUNDLED {
        assert!(listed.contains(scene.name), "{listed}");
        assert!(!scene.description().is_empty());
        assert_eq!(folder.lieflow(&["scenes", scene.name]).ok(), scene.text);
        let one = folder.lieflow(&["scenes", scene.name, "--json"]).ok();
        assert_eq!(serde_json::from_str::<Value>(&one).unwrap()["text"], scene.text);
    }
    let message = folder.lieflow(&["scenes", "symetric-top"]).refused();
    assert!(message.contains("did you mean `symmetric-top`?"), "{message}");
}

#[test]
fn a_kind_is_printed_with_all_that_a_scene_of_it_can_say() {
    let folder = Folder::new();
    let overview = folder.lieflow(&["scenes"]).ok();
    assert!(overview.lines().count() < 3 * KINDS.len() + BUNDLED.len() + 10, "{overview}");
    let all = folder.lieflow(&["scenes", "--all"]).ok();
    for kind in KINDS.iter() {
        assert!(overview.contains(&format!("\n{}: {}\n", kind.name, kind.summary)), "{overview}");
        // Some kinds have the name of a scene.
        let shown = folder.lieflow(&["scenes", "--kind", kind.name]).ok();
        let keys = kind.keys.iter().map(|key| key.name);
        let all_quantities = (kind.quantities)();
        // Those that mean the same are told together.
        let alike = all_quantities.chunk_by(|a, b| a.meaning == b.meaning);
        for other in alike.clone().flat_map(|alike| &alike[1..]) {
            assert!(
                shown.contains(&format!("{},", other.name))
                    || shown.contains(&format!("{}\n", other.name))
            );
        }
        let quantities = alike.map(|alike| alike[0].name);
        for name in keys.chain(quantities) {
            for text in [&shown, &all] {
                assert!(text.contains(&format!("\n  {name} ")), "{}: {name}\n{text}", kind.name);
            }
        }
        for words in ["SI units", "Scenes of this kind:", "    [problem]\n"] {
            assert!(shown.contains(words), "{shown}");
        }
        let json = folder.lieflow(&["scenes", "--kind", kind.name, "--json"]).ok();
        let json: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["summary"], kind.summary);
    }
    let kind = folder.lieflow(&["scenes", "--kind", "rigid-body"]).ok();
    assert_eq!(folder.lieflow(&["scenes", "Rigid_Body"]).ok(), kind);
    for (name, words) in [
        ("satellite", "`driven-body` is a kind of problem: lieflow scenes driven-body"),
        ("sattelite", "`driven-body` is a kind of problem: lieflow scenes driven-body"),
        ("wingnut2", "= did you mean `wing-nut`?\n"),
        ("asymetric", "= did you mean `asymmetric-top`?\n"),
    ] {
        let message = folder.lieflow(&["scenes", name]).refused();
        assert!(message.contains(words), "{message}");
    }
    let message = folder.lieflow(&["run", "rigid-body"]).refused();
    assert!(message.contains("is a kind of problem"), "{message}");
}

#[test]
fn a_printed_scene_runs() {
    let folder = Folder::new();
    for scene in BUNDLED {
        let text = folder.lieflow(&["scenes", scene.name]).ok();
        folder.write("my.toml", &text);
        folder.lieflow(&["run", "my.toml", "--error-check", "never"]).ok();
        let mut written = folder.data("lieflow-out/my");
        written.retain(|name| name != "events.csv" || !text.contains("[[events]]"));
        assert_eq!(written, ["summary.json", "trajectory.csv"]);
    }
    folder.lieflow(&["run", "symmetric-top"]).ok();
    assert_eq!(folder.names("lieflow-out"), ["my", "symmetric-top"]);
}

#[test]
fn methods_are_listed_from_the_catalog() {
    let folder = Folder::new();
    let listed = folder.lieflow(&["methods"]).ok();
    let json: Value = serde_json::from_str(&folder.lieflow(&["methods", "--json"]).ok()).unwrap();
    let registered: Vec<_> = all_methods().map(|m| m.name).collect();
    assert_eq!(names(&json["methods"]), registered);
    assert_eq!(names(&json["maps"]), MAPS.iter().map(|m| m.name).collect::<Vec<_>>());
    assert_eq!(names(&json["tableaus"]), TABLEAUS.iter().map(|t| t.name).collect::<Vec<_>>());
    assert_eq!(json["tableaus"][0]["order"], 1);
    // Those that differ in a number or in the order of axes are one line.
    for name in ["rkmk4", "taylor4 … taylor16 (13)", "mr2 … mr2-321 (6)", "gauss6-mg", "exp", "cay"]
    {
        assert!(listed.contains(&format!("\n  {name} ")), "{name}: {listed}");
    }
    assert!(!listed.contains("mr4-213"), "{listed}");
    for entry in json["methods"].as_array().unwrap() {
        for what in ["summary", "preserves", "cost", "source"] {
            assert!(!entry[what].as_str().unwrap().is_empty(), "{entry}");
        }
    }
}

#[test]
fn methods_are_recommended_before_they_are_listed() {
    let folder = Folder::new();
    let told = folder.lieflow(&["methods"]).ok();
    assert!(told.starts_with("Take this one\n"), "{told}");
    // The table ends with an empty line. Its methods are names, each with the problems that it is for.
    let table = |told: &str| -> Vec<String> {
        let start = told.find("Take this one\n").unwrap();
        let lines = told[start..].lines().skip(2).take_while(|line| !line.is_empty());
        lines.map(String::from).collect()
    };
    let all = table(&told);
    assert!(all[0].contains("rkmk dop853 (the default of most kinds)"), "{all:?}");
    for (scene, with, without) in [
        (
            "asymmetric-top",
            &["taylor16 (the default)", "taylor16-m", "taylor12-m", "dmv8", "mr4", "exact"][..],
            &["magnus"][..],
        ),
        (
            "rabi",
            &["cfm6-5", "cfm4-2", "magnus6", "rkmk-gauss4-symmetric"],
            &["taylor", "dmv8", "exact"],
        ),
        ("rotating-field", &["magnus8", "cfm4-2", "magnus6"], &["cfm6-5", "taylor", "dmv8"]),
        ("toda-lattice", &["rkmk dop853 cay", "rkmk dopri5 cay"], &["taylor", "magnus", "dmv8"]),
        ("damped-satellite", &["rkmk dopri5"], &["cay", "taylor", "magnus", "dmv8"]),
        ("lagrange-top", &["taylor16", "gauss4"], &["magnus", "dmv8", "energy-casimir"]),
        ("kovalevskaya-top", &["taylor16", "gauss4"], &["magnus", "dmv8", "energy-casimir"]),
        ("manakov-body", &["gauss4"], &["magnus", "dmv8", "energy-casimir"]),
    ] {
        let told = folder.lieflow(&["methods", "--for", scene]).ok();
        let rows = table(&told);
        assert!(rows.len() <= 8, "{rows:?}");
        let rows = rows.join("\n");
        for name in with {
            assert!(rows.contains(&format!(" {name} ")), "{scene}, {name}: {rows}");
        }
        assert!(without.iter().all(|name| !rows.contains(name)), "{scene}: {rows}");
        let scene = Scene::bundled(scene).unwrap();
        assert!(rows.contains(&scene.problem.default_method().label()), "{rows}");
        assert!(told.contains(&format!("lieflow compare {} --error", scene.name)), "{told}");
    }
    // A column that says nothing is left out: none of these methods takes a map.
    let linear = told.split("an equation of linear type").nth(1).unwrap();
    assert!(
        linear
            .lines()
            .nth(1)
            .unwrap()
            .split_whitespace()
            .eq("name order it keeps a step costs".split(' '))
    );
    // The hint is the scene as it was typed.
    let folder = Folder::new();
    folder.write("my top.toml", BUNDLED[0].text);
    let told = folder.lieflow(&["methods", "--for", "my top.toml", "--set", "title=Top"]).ok();
    assert!(
        told.contains("`lieflow compare 'my top.toml' --set title=Top --error 1e-8`"),
        "{told}"
    );
}

#[test]
fn one_method_is_told_in_full() {
    let folder = Folder::new();
    let told = folder.lieflow(&["methods", "lewis-simo"]).ok();
    assert!(told.contains("order: 4 or 2") && told.contains("Simo 1994"), "{told}");
    let told = folder.lieflow(&["methods", "rkmk"]).ok();
    assert!(told.contains("tableaus: euler") && told.contains("maps: exp, cay"), "{told}");
    // A series that is cut at q keeps the order q + 2, or q + 3.
    for (name, order) in [("rkmk dop853 exp q=2", 5), ("rkmk4 q=0", 2), ("rkmk dop853 q=8", 8)] {
        let json = folder.lieflow(&["methods", name, "--json"]).ok();
        assert_eq!(serde_json::from_str::<Value>(&json).unwrap()["order"], order, "{name}");
    }
    let refused = folder.lieflow(&["methods", "rkmk", "--set", "x=1"]).refused();
    assert!(refused.contains("--set changes a scene: name it with --for"), "{refused}");
    let json = folder.lieflow(&["methods", "mr4", "--json"]).ok();
    assert_eq!(serde_json::from_str::<Value>(&json).unwrap()["order"], 4);
    let refused = folder.lieflow(&["methods", "tailor13"]).refused();
    assert!(refused.contains("did you mean `taylor13`?"), "{refused}");
}

/// What fits the momentum, the attitude and the momentum as a matrix, and what does not.
#[test]
fn methods_for_a_scene_are_those_that_run() {
    let folder = Folder::new();
    let everywhere = ["rkmk4", "rkmk", "rk4", "cf4", "gauss4", "magnus43"];
    let body = ["mr2", "mr4", "simo-wong", "buss4", "dmv10", "exact"];
    let series = ["taylor12"];
    let closed = [&body[..], &series].concat();
    let linear = ["magnus4", "magnus6", "cfm6-5"];
    for (scene, with, without) in [
        (
            "asymmetric-top",
            &[&closed[..], &["energy-casimir"]].concat()[..],
            &["rk4-qr", "rk4-mg"][..],
        ),
        ("tumbling-attitude", &[&closed[..], &["rk4-qr", "rk4-mg"]].concat(), &["energy-casimir"]),
        ("general-layer", &["energy-casimir", "isospectral4", "taylor12"], &body),
        ("rotating-field", &linear, &closed),
        ("rabi", &linear, &closed),
        ("manakov-body", &["energy-casimir", "isospectral4", "taylor12"], &body),
        ("spin-wave", &["energy-casimir"], &closed),
        ("many-bodies", &["energy-casimir6"], &closed),
        ("relaxing-spins", &[], &["energy-casimir"]),
        ("lagrange-top", &["energy-casimir", "energy-casimir6", "taylor12"], &["isospectral2"]),
        ("ellipsoid-in-fluid", &["energy-casimir4", "taylor12"], &body),
        ("spherical-pendulum", &["energy-casimir", "taylor12"], &body),
        ("shear-layer", &["isospectral2", "isospectral6", "energy-casimir6"], &closed),
        ("euler-on-sl3", &["energy-casimir"], &linear),
        ("wing-nut", &closed, &["rk4-qr", "energy-casimir"]),
    ] {
        let fitting = folder.lieflow(&["methods", "--for", scene, "--json"]).ok();
        let fitting: Value = serde_json::from_str(&fitting).unwrap();
        let fitting = names(&fitting["methods"]);
        for name in everywhere.iter().chain(with) {
            assert!(fitting.contains(name), "{scene}: {name} is missing");
        }
        let foreign = linear.iter().filter(|_| !["rotating-field", "rabi"].contains(&scene));
        for name in foreign.chain(without) {
            assert!(!fitting.contains(name), "{scene}: {name} does not fit");
        }
        assert!(folder.lieflow(&["methods", "--for", scene]).ok().contains(scene));
    }
}

#[test]
fn a_key_has_its_shape_and_its_dimension() {
    let folder = Folder::new();
    let text = folder.lieflow(&["scenes", "heavy-top", "--json"]).ok();
    let kind: Value = serde_json::from_str(&text).unwrap();
    let keys = kind["keys"].as_array().unwrap();
    let key = |name: &str| keys.iter().find(|key| key["name"] == name).unwrap();
    for (name, shape, optional, dimension) in [
        ("inertia", "a list of 3 numbers, or 3 rows of 3 numbers", true, Some("mass·length²")),
        ("omega_body", "a list of 3 numbers", true, Some("angle/time")),
        ("weight", "a list of 3 numbers", false, Some("mass·length²/time²")),
        ("vertical", "a list of 3 numbers", true, None),
    ] {
        assert_eq!(key(name)["shape"], shape);
        assert_eq!(key(name)["optional"], optional);
        assert_eq!(key(name).get("dimension").and_then(Value::as_str), dimension, "{name}");
    }
    let shown = folder.lieflow(&["scenes", "kirchhoff"]).ok();
    assert!(shown.contains("initial linear momentum in the body [mass·length/time]"), "{shown}");
}

#[test]
fn the_keys_and_quantities_that_are_listed_are_those_that_scenes_take() {
    for kind in KINDS.iter() {
        let text = BUNDLED.iter().find(|s| s.text.contains(&format!("{:?}", kind.name))).unwrap();
        let text = text.text.replace("[problem]", "[problem]\nno_such_key = 1");
        let message = Scene::parse("scene", &text).unwrap_err().to_string();
        let keys: Vec<_> = kind.keys.iter().map(|key| key.name).collect();
        let one_of = if keys.len() == 1 { "" } else { "one of " };
        assert!(message.contains(&format!("expected {one_of}{}", keys.join(", "))), "{message}");

        let of_kind = |s: &&lieflow_model::scene::Bundled| {
            Scene::bundled(s.name).unwrap().problem.kind().name == kind.name
        };
        let scene = Scene::bundled(BUNDLED.iter().find(of_kind).unwrap().name).unwrap();
        // A quantity that this problem does not have is refused.
        let of_scene = (kind.quantities)().into_iter();
        let of_scene: Vec<_> = of_scene.filter(|q| scene.problem.columns(q.name).is_ok()).collect();
        let quantities: Vec<_> = of_scene.iter().map(|quantity| quantity.name).collect();
        let model = scene.problem.model(scene.layer, &quantities).unwrap();
        let all: Vec<_> = quantities.iter().map(|q| scene.problem.columns(q).unwrap()).collect();
        assert!(model.schema().columns().eq(&all.concat()), "{}", kind.name);
        // Where the size of the problem says how many there are, the list names the first.
        for (info, columns) in of_scene.iter().zip(&all) {
            let listed = info.column_names();
            let open = listed.iter().any(|column| column == "…");
            let listed: Vec<_> = listed.iter().take_while(|c| **c != "…").collect();
            assert!(open || listed.len() == columns.len(), "{}: {columns:?}", info.name);
            let named = listed.iter().zip(columns).all(|(a, b)| *a == b);
            assert!(named, "{} {}: {columns:?}", kind.name, info.name);
        }
    }
}

#[test]
fn help_has_examples() {
    let folder = Folder::new();
    let commands = ["run", "compare", "paper", "check", "scenes", "methods", "completions"];
    let top = folder.lieflow(&["--help"]).ok();
    for command in commands {
        assert!(top.contains(command), "{top}");
        let help = folder.lieflow(&[command, "--help"]).ok();
        assert!(help.contains("Examples:") && help.contains("lieflow "), "{help}");
    }
    for option in ["--quick", "--out", "Examples:"] {
        assert!(top.contains(option), "{top}");
    }
    assert!(folder.lieflow(&["--version"]).ok().starts_with("lieflow "));
    assert_eq!(folder.lieflow(&["no-such-command"]).code, Some(2));
    assert_eq!(folder.lieflow(&["run"]).code, Some(2));
}

#[test]
fn completions_are_printed() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        assert!(folder.lieflow(&["completions", shell]).ok().contains("lieflow"));
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    for args in [&["scenes"][..], &["methods"], &["completions", "zsh"], &["--help"]] {
        let mut child = Command::new(program())
            .args(args)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(String::from_utf8(output.stderr).unwrap(), "", "{args:?}");
        assert!(output.status.success(), "{args:?}");
    }
}

/// The program that ships proves itself: one line for each group.
#[test]
fn the_checks_of_the_program_hold() {
    let folder = Folder::new();
    let json = folder.lieflow(&["check", "--quick", "--json"]).ok();
    let groups: Vec<serde_json::Value> = serde_json::from_str(&json).unwrap();
    let names: Vec<&str> = groups.iter().map(|group| group["name"].as_str().unwrap()).collect();
    for (n, (group, name)) in groups.iter().zip(&names).enumerate() {
        assert_eq!(group["holds"], true, "{name}: {}", group["failures"]);
        assert_eq!(group["failures"], serde_json::json!([]), "{name}");
        assert!(group["checks"].as_u64().unwrap() > 0, "{name}");
        assert!(!names[..n].contains(name), "{name} stands twice");
    }
    let scenes = names.iter().filter(|name| name.starts_with("methods on ")).count();
    assert!(scenes > 25, "{names:#?}");
    let table = folder.lieflow(&["check", "--quick"]).ok();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), groups.len() + 2, "{table}");
    for (line, name) in lines[1..].iter().zip(&names) {
        assert!(line.trim_start().starts_with(name) && line.ends_with(" ok"), "{line}");
    }
    assert!(lines.last().unwrap().contains(" checks in "), "{table}");
}
