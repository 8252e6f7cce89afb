//! `lieflow run`: what is written is what the library computes.

use crate::support::{Folder, SCENE, read_csv};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::problems::{RigidBody, RigidBodyAttitude};
use lieflow::{SaveAt, TimeGrid, integrate};
use lieflow_model::kinds::RigidBodySpec;
use lieflow_model::problem::Layer;
use lieflow_model::scene::{BUNDLED, Scene};
use lieflow_model::schema::Row;
use nalgebra::Vector3;

/// A bundled scene with few steps.
fn shortened(name: &str) -> String {
    let text = BUNDLED.iter().find(|scene| scene.name == name).unwrap().text;
    let line = |line: &str| match line.split(' ').next() {
        Some("t_span") => "t_span = [1.0, 1.2]".into(),
        Some("dt" | "steps" | "rtol") => "steps = 50".into(),
        Some("atol") => String::new(),
        Some("quantities") => format!("{line}\nevery = 7"),
        Some("every" | "times" | "count" | "interval") => String::new(),
        _ => line.to_owned(),
    };
    text.lines().map(|text| line(text) + "\n").collect()
}

/// Each chart says what it shows: once, with the unit that a quantity has in every scene, and not too much of it.
#[test]
fn charts_say_what_they_show() {
    let folder = Folder::new();
    folder.write("vortices.toml", &shortened("vortices-on-sphere"));
    for name in ["attitude-control", "magnetic-damping", "vortices.toml"] {
        folder.lieflow(&["run", name, "--out", name.trim_end_matches(".toml")]).ok();
    }
    let angle = folder.read("attitude-control/time-angle.svg");
    assert!(angle.contains(">angle (rad)<"), "{angle}");
    let page = folder.read("magnetic-damping/index.html");
    assert_eq!(page.matches("\"title\">Angular velocity in the body<").count(), 1);
    assert!(page.contains("\"title\">speed<"));
    let drift = folder.read("vortices/drift.svg");
    assert_eq!(drift.matches("class=\"lf-s ").count(), 6);
    assert!(drift.contains("The 6 that moved most, of 29."), "{drift}");
}

/// The next run in a folder removes the figures that lieflow wrote, with a page or without, and no other file.
#[test]
fn figures_of_an_earlier_run_do_not_stay() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let run = |more: &[&str]| {
        folder.lieflow(&[&["run", "scene.toml", "--out", "out"], more].concat()).ok();
        let names = folder.names("out").into_iter();
        names.filter(|name| name.ends_with(".svg") || name.ends_with(".html")).collect::<Vec<_>>()
    };
    let first = run(&[]);
    for name in ["index.html", "time-momentum-body.svg", "time-energy.svg"] {
        assert!(first.contains(&name.into()), "{first:?}");
    }
    folder.write("out/mine.svg", "<svg/>");
    let energy = run(&["--set", "output.quantities=[\"energy\"]"]);
    let has = |name: &str| energy.contains(&name.into());
    assert!(
        has("mine.svg") && has("time-energy.svg") && !has("time-momentum-body.svg"),
        "{energy:?}"
    );
    assert_eq!(run(&["--no-page"]), ["mine.svg"]);
    // A summary that names what is no figure of the folder.
    folder.write("other.svg", "<svg/>");
    folder.write("out/summary.json", "{\"figures\": [\"../other.svg\", \"trajectory.csv\", 3]}");
    run(&["--no-page"]);
    assert_eq!(folder.read("other.svg"), "<svg/>");
}

#[test]
fn every_bundled_scene_runs_and_reads_back_exactly() {
    let folder = Folder::new();
    for bundled in BUNDLED {
        let name = bundled.name;
        folder.write("short.toml", &shortened(name));
        let told = folder.lieflow(&["run", "short.toml", "--out", name]).ok();
        for file in ["trajectory.csv", "summary.json"] {
            assert!(told.contains(&format!("{name}/{file}")), "{told}");
        }
        let names = folder.names(name);
        for file in ["figure.svg", "index.html", "summary.json", "trajectory.csv"] {
            assert!(names.contains(&file.to_string()), "{names:?}");
        }

        let scene = Scene::parse("short.toml", &shortened(name)).unwrap();
        let model = scene.model().unwrap();
        let mut rows = Vec::new();
        let mut sink = |t: f64, row: Row<'_>| rows.push([&[t], row.values()].concat());
        model.run(&scene.method, &scene.grid, &scene.save, &mut sink).unwrap();
        let (header, written) = read_csv(&folder.read(&format!("{name}/trajectory.csv")));
        assert_eq!(header[0], "t");
        assert!(model.schema().columns().eq(&header[1..]), "{name}: {header:?}");
        assert_eq!(written, rows, "{name}");
        assert_eq!((rows[0][0], rows[rows.len() - 1][0], rows.len()), (1.0, 1.2, 9));

        let summary = folder.json(&format!("{name}/summary.json"));
        assert_eq!(summary["completed"], true);
        assert_eq!((&summary["steps"], &summary["rows"]), (&50.into(), &9.into()));
        assert_eq!(
            summary["method"]["order"],
            serde_json::json!(model.order(&scene.method).unwrap())
        );
        assert_eq!(summary["columns"].as_array().unwrap().len(), header.len());
        if scene.problem.kind().name != "rigid-body" {
            let exact = model.exact([0.0, 0.2]).is_some();
            assert_eq!(summary["error_at_end"].is_object(), exact, "{name}");
            continue;
        }
        assert!(summary["drift"]["momentum_norm"]["max"].as_f64().unwrap() < 1e-13);
        assert!(summary["error_at_end"]["momentum_body"].as_f64().unwrap() < 2e-5);
        let asks = |name: &str| scene.quantities.iter().any(|quantity| quantity == name);
        let with_attitude = asks("attitude") || asks("quaternion");
        let modelled = summary["modelled"].to_string();
        assert_eq!(modelled.contains("attitude"), with_attitude, "{modelled}");
        assert_eq!(modelled.contains("quaternion"), asks("quaternion"), "{modelled}");
        assert_eq!(summary["drift"]["attitude_defect"].is_object(), asks("attitude"));
        assert_eq!(summary["drift"]["quaternion_defect"].is_object(), asks("quaternion"));
        assert_eq!(summary["error_at_end"]["attitude"].is_number(), with_attitude);
    }
}

#[test]
fn the_columns_are_those_of_the_library() {
    let grid = TimeGrid::with_steps([1.0, 1.2], 50).unwrap();

    let scene = Scene::parse("top", &shortened("asymmetric-top")).unwrap();
    let body = RigidBody::new([1.0, 2.0, 3.0]).unwrap();
    let mut expected = Vec::new();
    let mut m = Vector3::new(0.2, 0.0, 3.0);
    let method = Rkmk::new(RK4, Exp);
    integrate(&body, &method, &grid, &SaveAt::Every(7), &mut m, |t, m| {
        expected.push(vec![t, m[0], m[1], m[2], body.energy(m)]);
    })
    .unwrap();
    assert_eq!(rows_of(&scene), expected);

    let scene = Scene::parse("body", &shortened("tumbling-attitude")).unwrap();
    let spec: &RigidBodySpec = scene.problem.spec().unwrap();
    let in_space = spec.attitude * Vector3::from(spec.momentum_body);
    let body = RigidBodyAttitude::new(spec.inertia, in_space.into()).unwrap();
    let mut expected = Vec::new();
    let mut g = spec.attitude;
    let method = Rkmk::new(RK4, Cay);
    integrate(&body, &method, &grid, &SaveAt::Every(7), &mut g, |t, g| {
        let entries = (0..3).flat_map(|i| (0..3).map(move |j| g[(i, j)]));
        let energy = body.body().energy(&body.momentum_body(g));
        expected.push([t].into_iter().chain(entries).chain([energy]).collect::<Vec<_>>());
    })
    .unwrap();
    assert_eq!(rows_of(&scene), expected);
}

fn rows_of(scene: &Scene) -> Vec<Vec<f64>> {
    rows_on(scene, scene.layer)
}

fn rows_on(scene: &Scene, layer: Layer) -> Vec<Vec<f64>> {
    let quantities: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
    let model = scene.model_with(layer, &quantities).unwrap();
    let mut rows = Vec::new();
    let mut sink = |t: f64, row: Row<'_>| rows.push([&[t], row.values()].concat());
    model.run(&scene.method, &scene.grid, &scene.save, &mut sink).unwrap();
    rows
}

fn distance(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

const ALL: &str = r#"quantities = ["momentum_body", "omega_body", "attitude", "energy", "momentum_norm", "attitude_defect"]"#;

#[test]
fn the_layers_agree() {
    // Not rk4 with the attitude: its stages leave the group, and there the fields of the two layers
    // differ. That case is below.
    let momentum = "quantities = [\"omega_body\", \"energy\"]";
    let rkmk = "name = \"rkmk\"\nmap = \"cay\"\ntableau = \"heun\"";
    for (method, quantities) in [("name = \"rk4\"", momentum), (rkmk, momentum), (rkmk, ALL)] {
        let text = SCENE
            .replace("name = \"rkmk4\"\nmap = \"exp\"", method)
            .replace("quantities = [\"momentum_body\", \"energy\"]", quantities);
        let scene = Scene::parse("scene", &text).unwrap();
        let [closed, general] = Layer::ALL.map(|layer| rows_on(&scene, layer));
        assert!(distance(&closed, &general) < 1e-10, "{text}");
    }
    for map in ["exp", "cay", "ccsk123", "ccsk321", "ccsk"] {
        let text = SCENE.replace("\"exp\"", &format!("{map:?}"));
        let scene = Scene::parse("scene", &text).unwrap();
        let [closed, general] = Layer::ALL.map(|layer| rows_on(&scene, layer));
        assert!(distance(&closed, &general) < 1e-10, "{map}");
    }
}

#[test]
fn off_the_group_the_layers_differ_by_the_order_of_the_method() {
    let gap = |dt: &str| {
        let text = SCENE
            .replace("name = \"rkmk4\"\nmap = \"exp\"", "name = \"rk4\"")
            .replace("quantities = [\"momentum_body\", \"energy\"]", "quantities = [\"attitude\"]")
            .replace("dt = 0.05", dt);
        let scene = Scene::parse("scene", &text).unwrap();
        let [closed, general] =
            Layer::ALL.map(|layer| rows_on(&scene, layer)).map(|rows| rows[rows.len() - 1].clone());
        distance(&[closed], &[general])
    };
    let ratio = gap("dt = 0.05") / gap("dt = 0.025");
    assert!((12.0..20.0).contains(&ratio), "{ratio}");
}

#[test]
fn every_quantity_follows_the_exact_solution() {
    let text = SCENE
        .replace("quantities = [\"momentum_body\", \"energy\"]", ALL)
        .replace("dt = 0.05", "dt = 0.001")
        .replace("t_span = [0, 2.0]", "t_span = [5, 3]");
    let scene = Scene::parse("scene", &text).unwrap();
    let model = scene.model().unwrap();
    let rows = rows_of(&scene);
    assert_eq!(rows[rows.len() - 1][0], 3.0);
    for row in rows {
        let exact = model.exact([5.0, row[0]]).unwrap().unwrap();
        assert!(distance(&[row[1..].to_vec()], &[exact]) < 1e-10, "{row:?}");
    }
}

#[test]
fn output_times_need_not_lie_on_the_grid() {
    let folder = Folder::new();
    folder.write("scene.toml", &SCENE.replace("every = 10", "times = [0.5, 0.512, 1]"));
    folder.lieflow(&["run", "scene.toml"]).ok();
    let (_, rows) = read_csv(&folder.read("lieflow-out/scene/trajectory.csv"));
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [0.0, 0.5, 0.512, 1.0, 2.0]);
    assert_eq!(folder.json("lieflow-out/scene/summary.json")["side_steps"], 1);
}

#[test]
fn every_value_has_17_digits_and_the_order_is_the_one_asked_for() {
    let folder = Folder::new();
    let asked = "quantities = [\"energy\", \"omega_body\"]";
    folder
        .write("scene.toml", &SCENE.replace("quantities = [\"momentum_body\", \"energy\"]", asked));
    folder.lieflow(&["run", "scene.toml", "--out", "a/b"]).ok();
    let text = folder.read("a/b/trajectory.csv");
    assert!(text.starts_with("t,energy,w1,w2,w3\n0.0000000000000000e0,1.5"), "{text}");
    for value in text.lines().skip(1).flat_map(|line| line.split(',')) {
        let (digits, _) = value.split_once('e').unwrap();
        assert_eq!(digits.trim_start_matches('-').len(), 18, "{value}");
    }
}

#[test]
fn a_step_that_fails_keeps_the_rows_before_it() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let before = folder.read("out/trajectory.csv");
    // Euler's method on the entries blows up: each step squares the size.
    let unstable = SCENE
        .replace("name = \"rkmk4\"\nmap = \"exp\"", "name = \"rk\"\ntableau = \"euler\"")
        .replace("t_span = [0, 2.0]", "t_span = [0, 400]")
        .replace("dt = 0.05", "dt = 4")
        .replace("every = 10", "every = 1");
    folder.write("scene.toml", &unstable);
    let message = folder.lieflow(&["run", "scene.toml", "--out", "out"]).refused();
    assert!(message.contains("out/trajectory.partial.csv"), "{message}");
    // The rows of the good run before it stay.
    assert!(message.contains("; out/trajectory.csv is that of a run before"), "{message}");
    let files = ["summary.json", "trajectory.csv", "trajectory.partial.csv"];
    assert_eq!(folder.data("out"), files);
    assert_eq!(folder.read("out/trajectory.csv"), before);
    let summary = folder.json("out/summary.json");
    let (_, rows) = read_csv(&folder.read("out/trajectory.partial.csv"));
    assert_eq!(summary["completed"], false);
    assert!(message.contains(summary["failure"].as_str().unwrap()), "{message}");
    assert_eq!(summary["rows"].as_u64().unwrap() as usize, rows.len());
    assert_eq!(summary["steps"].as_u64().unwrap() as usize + 1, rows.len());
    // The momentum was finite where its energy no longer was.
    assert!(rows.len() > 3 && rows.iter().all(|row| row[1..4].iter().all(|m| m.is_finite())));

    folder.write("scene.toml", SCENE);
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    assert_eq!(folder.data("out"), ["summary.json", "trajectory.csv"]);
}

/// A scene with another method and other steps.
fn with(method: &str, time: &str) -> String {
    SCENE
        .replace("name = \"rkmk4\"\nmap = \"exp\"", method)
        .replace("t_span = [0, 2.0]\ndt = 0.05", time)
        .replace("every = 10", "every = 1")
}

#[test]
fn adaptive_runs_reach_their_tolerance_and_say_what_they_did() {
    let folder = Folder::new();
    let dopri5 = "name = \"rkmk\"\ntableau = \"dopri5\"\nmap = \"cay\"";
    // A pair, methods without one, on either layer, forward and backward.
    for (method, t_span) in [
        (dopri5, "[0, 20]"),
        (dopri5, "[20, 0]"),
        ("name = \"rkmk4\"", "[0, 20]"),
        ("name = \"taylor8\"", "[0, 20]"),
        ("name = \"mr4\"", "[0, 20]"),
        ("name = \"cf43\"\nlayer = \"general\"", "[0, 20]"),
    ] {
        let error = |rtol: &str| {
            let method = if method.contains("layer") {
                with(method, "").replace("layer = \"closed\"\n", "")
            } else {
                with(method, "")
            };
            let time = format!("[time]\nt_span = {t_span}\nrtol = {rtol}\nh_max = 2\n");
            folder.write("scene.toml", &method.replace("[time]\n", &time));
            folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
            let summary = folder.json("out/summary.json");
            let chosen = &summary["adaptive"];
            let (_, rows) = folder.trajectory();
            assert_eq!(chosen["accepted"].as_u64().unwrap() as usize + 1, rows.len(), "{method}");
            assert_eq!(summary["steps"], chosen["accepted"]);
            assert!(summary["dt"].is_null() && chosen["rejected"].is_number());
            let evaluations = chosen["evaluations"].as_u64();
            assert_eq!(evaluations.is_none(), method.contains("mr4"), "{method}");
            assert!(evaluations.is_none_or(|n| n > rows.len() as u64));
            assert!(chosen["largest_step"].as_f64().unwrap() <= 2.0);
            let ends: Vec<f64> = serde_json::from_str(t_span).unwrap();
            assert_eq!([rows[0][0], rows[rows.len() - 1][0]], ends[..]);
            summary["error_at_end"]["momentum_body"].as_f64().unwrap()
        };
        // rtol is an error for each unit of the way: some |m| ω t = 20 of them here.
        let (coarse, fine) = (error("1e-5"), error("1e-8"));
        assert!(coarse < 2e-3 && fine < 2e-6 && fine < coarse, "{method}: {coarse:e}, {fine:e}");
    }
}

#[test]
fn an_adaptive_run_that_cannot_go_on_keeps_its_rows() {
    let folder = Folder::new();
    folder.write(
        "scene.toml",
        &with("name = \"rkmk4\"", "t_span = [0, 200]\nrtol = 1e-8\nmax_steps = 20"),
    );
    let message = folder.lieflow(&["run", "scene.toml", "--out", "out"]).refused();
    assert!(message.contains("20 attempts") && message.contains("max_steps"), "{message}");
    assert_eq!(folder.data("out"), ["summary.json", "trajectory.partial.csv"]);
}

#[test]
fn every_method_that_is_listed_runs_and_is_right() {
    let folder = Folder::new();
    for (layer, quantities) in
        [("closed", "momentum_body"), ("closed", "attitude"), ("general", "momentum_body")]
    {
        let scene = |method: &str| {
            with(method, "t_span = [0, 1]\ndt = 0.01")
                .replace("layer = \"closed\"", &format!("layer = {layer:?}"))
                .replace("\"momentum_body\", \"energy\"", &format!("{quantities:?}"))
        };
        let start = Scene::parse("scene", &scene("name = \"rk4\"")).unwrap();
        let model = start.model().unwrap();
        let mut seen = 0;
        for info in lieflow::catalog::all_methods() {
            let parsed = Scene::parse("scene", &scene(&format!("name = {:?}", info.name)));
            let Ok(parsed) = parsed else {
                let message = parsed.unwrap_err().to_string();
                assert!(message.contains("methods that fit: rkmk4, rkmk, rk4"), "{message}");
                assert!(message.starts_with("scene:7:"), "{message}");
                continue;
            };
            let rows = rows_of(&parsed);
            let exact = model.exact([0.0, 1.0]).unwrap().unwrap();
            let gap = distance(&[rows[rows.len() - 1][1..].to_vec()], &[exact]);
            assert!(gap < 2e-4, "{} on the {layer} layer: {gap:e}", info.name);
            seen += 1;
        }
        assert!(seen > 20, "{seen}");
    }
    // A method that fits with some maps only names the map, not other methods.
    folder.write(
        "scene.toml",
        &with("name = \"energy-casimir\"\nmap = \"ccsk123\"", "t_span = [0, 1]\ndt = 0.1"),
    );
    let message = folder.lieflow(&["run", "scene.toml"]).refused();
    assert!(message.contains("exp or cay") && !message.contains("methods that fit"), "{message}");
}

/// Against the solution in the frame that turns with the field: x(t) = R₃(Ωt) exp(t(ω(0) − Ωe₃)) x(0).
#[test]
fn a_spin_precesses_about_the_field_in_the_frame_that_turns() {
    let text = BUNDLED.iter().find(|s| s.name == "rotating-field").unwrap().text;
    for method in ["magnus6", "magnus8", "cfm6-5", "rkmk4", "gauss6", "cf-ls5", "rk4"] {
        let text = text.replace("magnus6", method).replace("dt = 0.25", "dt = 0.025");
        let scene = Scene::parse("scene", &text).unwrap();
        let rows = rows_of(&scene);
        let last = &rows[rows.len() - 1];
        let turn = |u: Vector3<f64>| lieflow::so3::exp(&(100.0 * u)).unwrap();
        let exact = turn(Vector3::new(0.0, 0.0, 1.05))
            * turn(Vector3::new(0.2, 0.0, 1.0 - 1.05))
            * Vector3::new(0.0, 0.0, 1.0);
        let gap = (Vector3::from_column_slice(&last[1..4]) - exact).norm();
        assert!(gap < 2e-6, "{method}: {gap:e}");
    }
}

/// A particle that leaves the range of numbers ends the run: exit code 2, the column by its name, and the rows
/// before it.
#[test]
fn a_particle_that_is_not_finite_ends_the_run() {
    let folder = Folder::new();
    for quantity in ["phase_space", "particle"] {
        folder.write(
            "far.toml",
            &format!(
                "title = \"Far\"\n[problem]\nkind = \"beam-line\"\n\
                 elements = [{{ kind = \"drift\", length = 4.0 }}]\n\
                 particle = [0.001, 0.001, 1e308, 0.0]\n[method]\nname = \"cfm4-2\"\n\
                 [time]\nt_span = [0.0, 12.0]\ndt = 1.0\n[output]\nquantities = [\"{quantity}\"]\n"
            ),
        );
        let message = "the state is out of the range of numbers at t = 2: x is inf";
        let error = folder.lieflow(&["run", "far.toml", "--out", "out"]).refused();
        assert!(error.contains(message), "{quantity}: {error}");
        let summary = folder.json("out/summary.json");
        assert_eq!(summary["failure"], message, "{quantity}");
        assert_eq!(summary["warnings"], serde_json::json!([]), "{quantity}");
        let rows = folder.read("out/trajectory.partial.csv");
        assert_eq!(rows.lines().count(), 3, "{quantity}: {rows}");
        assert!(!rows.contains("inf"), "{quantity}: {rows}");
    }
}
