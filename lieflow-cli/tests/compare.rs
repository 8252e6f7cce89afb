//! `lieflow compare`: every point is written, the advice follows from them, and a comparison that was
//! interrupted goes on.

mod support;

use std::time::Duration;

use lieflow_cli::measure::{
    Candidate, Effort, JOURNAL, Journal, Judge, Plan, Reference, speed_against_error,
};
use lieflow_cli::model::Layer;
use lieflow_cli::report::ADVICE;
use lieflow_cli::scene::Scene;
use support::{Folder, SCENE};

const METHODS: &str = "rkmk4 exp,rk4,mr4,taylor8,exact,rkmk dopri5 cay";

#[test]
fn the_advice_follows_from_the_points() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let args = ["compare", "scene.toml", "--out", "out", "--quick", "--repeat", "2", "--seed", "3"];
    let args = [&args[..], &["--methods", METHODS, "--tolerances", "1e-4,1e-8"]].concat();
    let told = folder.lieflow(&args).ok();
    assert!(told.contains("must not drift") && told.contains("the exact solution"), "{told}");
    assert!(!folder.names("out").contains(&JOURNAL.to_string()));

    let json = folder.json("out/speed.json");
    let curves = json["curves"].as_array().unwrap();
    let label = |c: &serde_json::Value| format!("{} {}", c["method"], c["adaptive"]);
    let labels: Vec<_> = curves.iter().map(label).collect();
    for expected in ["rkmk4", "rk4", "mr4", "taylor8", "exact"] {
        assert!(labels.contains(&format!("{expected:?} false")), "{labels:?}");
    }
    // A pair in steps of one size and in steps of its own.
    assert!(labels.contains(&"\"rkmk\" false".into()) && labels.contains(&"\"rkmk\" true".into()));
    assert_eq!(labels.len(), 7);
    let tolerances = &curves.iter().find(|c| c["adaptive"] == true).unwrap()["points"];
    assert_eq!(tolerances.as_array().unwrap().len(), 2);
    assert!(tolerances[1]["evaluations"].as_u64() > tolerances[0]["evaluations"].as_u64());

    for (advice, kept) in [("advice", false), ("advice_energy_kept", true)] {
        let advice = json[advice].as_array().unwrap();
        assert_eq!(advice.len(), ADVICE.len());
        for choice in advice {
            // The exact motion reaches every error and keeps the energy.
            let seconds = choice["seconds_per_unit"].as_f64().unwrap();
            let error = choice["error"].as_f64().unwrap();
            for curve in curves {
                let points = curve["points"].as_array().unwrap();
                let reaches = |p: &&serde_json::Value| {
                    p["error"].as_f64().is_some_and(|e| e <= error)
                        && (!kept || p["energy_error"].as_f64().unwrap() < 1e-13)
                };
                for point in points.iter().filter(reaches) {
                    let time = point["seconds_per_unit"].as_f64().unwrap();
                    assert!(seconds <= time * (1.0 + 1e-9), "{choice} but {point}");
                }
            }
        }
    }

    // Four evaluations a step of RKMK4 and of RK4; none that could be stated for the exact motion.
    for (curve, stages) in [("rkmk4", Some(4)), ("rk4", Some(4)), ("exact", None)] {
        let curve = curves.iter().find(|c| c["method"] == curve).unwrap();
        let point = &curve["points"][0];
        let expected = stages.map(|s: u64| s * point["steps"].as_u64().unwrap());
        assert_eq!(point["evaluations"].as_u64(), expected, "{point}");
    }

    // The front falls from left to right.
    let mut front: Vec<(f64, f64)> = Vec::new();
    for curve in curves {
        for at in curve["pareto"].as_array().unwrap() {
            let point = &curve["points"][at.as_u64().unwrap() as usize];
            let number = |key: &str| point[key].as_f64().unwrap();
            front.push((number("error"), number("seconds_per_unit")));
        }
    }
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(!front.is_empty() && front.windows(2).all(|w| w[0].1 > w[1].1), "{front:?}");

    let csv = folder.read("out/speed.csv");
    let points: usize = curves.iter().map(|c| c["points"].as_array().unwrap().len()).sum();
    assert_eq!(csv.lines().count(), points + 1);
    for column in ["energy_error", "casimir_error", "group_residual", "evaluations", "pareto"] {
        assert!(csv.lines().next().unwrap().contains(column), "{column}");
    }
    let page = folder.read("out/index.html");
    assert!(page.contains("Pareto front") && !page.contains("NaN"));
    assert!(folder.read("out/pareto.svg").starts_with("<svg"));
}

#[test]
fn wrong_options_are_refused_by_one_sentence() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    for (options, words) in [
        (["--methods", "rkmk5"], &["no method `rkmk5` fits", "did you mean `rkmk"][..]),
        (["--methods", "magnus4"], &["no method `magnus4` fits", "rkmk4"]),
        (["--tolerances", "0"], &["between 0 and 1"]),
        (["--tolerances", "small"], &["between 0 and 1"]),
        (["--repeat", "0"], &["--repeat"]),
    ] {
        let run =
            folder.lieflow(&[&["compare", "scene.toml", "--out", "out"], &options[..]].concat());
        assert_eq!(run.code, Some(2), "{run:?}");
        for word in words {
            assert!(run.err.contains(word), "{options:?}: {}", run.err);
        }
        assert_eq!(folder.names("out"), [""; 0], "{options:?}");
    }
}

#[test]
fn what_was_measured_before_an_interruption_is_not_measured_again() {
    let folder = Folder::new();
    let scene = Scene::parse("scene", SCENE).unwrap();
    let candidates = [Candidate::rkmk4("exp", Layer::Closed), Candidate::rk4(Layer::Closed)];
    let plan = Plan {
        quantities: &["momentum_body"],
        candidates: &candidates,
        t_span: [0.0, 2.0],
        steps: &[10, 20, 40],
        tolerances: &[],
    };
    let millisecond = Duration::from_millis(1);
    let effort = Effort { rounds: 3, longest: 100 * millisecond, shortest: millisecond, seed: 1 };
    let measure = |of: &str| {
        let mut journal = Journal::open(folder.path(), of).unwrap();
        let known = journal.known();
        let (curves, _) =
            speed_against_error(&scene, &plan, effort, Some(&mut journal), |_| {}).unwrap();
        (known, curves)
    };
    let (known, whole) = measure("a");
    assert_eq!(known, 0);
    // Cut in the middle of a line among the timings of the second round.
    let text = folder.read(JOURNAL);
    let half = text.len() * 2 / 3;
    folder.write(JOURNAL, &text[..half]);
    let lines_before = text[..half].lines().count() - 1;
    let (known, resumed) = measure("a");
    assert_eq!(known, 6);
    assert!(folder.read(JOURNAL).starts_with(
        &text.lines().take(lines_before).map(|line| format!("{line}\n")).collect::<String>()
    ));
    assert_eq!(folder.read(JOURNAL).lines().count(), text.lines().count());
    for (a, b) in whole.iter().zip(&resumed) {
        for (p, q) in a.points.iter().zip(&b.points) {
            // The first run was timed once.
            assert!((p.first_seconds - q.first_seconds).abs() <= 1e-12 * p.first_seconds);
            assert!((p.error - q.error).abs() <= 1e-12 * p.error);
        }
    }
    // About something else it begins anew.
    assert_eq!(measure("b").0, 0);
}

#[test]
fn two_methods_agree_where_the_exact_solution_is_not_asked() {
    let scene = Scene::parse("scene", SCENE).unwrap();
    let judge = Judge::by_two_runs(&scene, &["attitude"], [0.0, 2.0]).unwrap();
    let Reference::Own { by, beside, apart } = &judge.reference else { panic!("not exact") };
    assert_ne!(by, beside);
    assert!(*apart < 1e-11, "{apart:e}");
    assert!(judge.reference.in_words().contains("they agree"));

    let exact = Judge::new(&scene, &["attitude"], [0.0, 2.0]).unwrap();
    assert_eq!(exact.reference, Reference::Exact);
    let model = scene.model_with(Layer::Closed, &judge.quantities()).unwrap();
    let candidate = Candidate::rkmk4("exp", Layer::Closed);
    let size = lieflow_cli::measure::Size::Steps(100);
    let [a, b] = [&judge, &exact].map(|j| j.point(&*model, &candidate, [0.0, 2.0], size).error);
    assert!((a - b).abs() < 1e-10, "{a:e} {b:e}");
}

#[test]
fn a_scene_without_an_exact_solution_is_judged_by_two_runs() {
    let folder = Folder::new();
    let methods = "magnus4,magnus6,rkmk4 exp,rk4";
    let args = ["compare", "rotating-field", "--out", "out", "--quick", "--methods", methods];
    let told = folder.lieflow(&args).ok();
    assert!(told.contains("they agree"), "{told}");
    let json = folder.json("out/speed.json");
    assert!(json["reference"].as_str().unwrap().contains("dop853"), "{json}");
    let best = json["advice"][1]["method"].as_str().unwrap();
    assert!(best.starts_with("magnus"), "{best}");
    assert!(!folder.read("out/index.html").contains("must not drift"));
}
