//! `lieflow compare`: every point is written, the advice follows from them, and a comparison that was
//! interrupted goes on.

use std::time::Duration;

use crate::support::{Folder, SCENE};
use lieflow_cli::measure::{
    Candidate, Course, Curve, Effort, JOURNAL, Journal, Judge, NEVER, Plan, Reference, Rounding,
    Rows, Size, WorkPoint, speed_against_error,
};
use lieflow_cli::report::{ADVICE, choices};
use lieflow_model::problem::Layer;
use lieflow_model::scene::Scene;

fn judge_of(scene: &Scene, quantities: &[&str], t_span: [f64; 2], steps: &[u64]) -> Judge<'static> {
    Judge::new(scene, quantities, t_span, steps, Duration::from_secs(1), &NEVER).unwrap()
}

const METHODS: &str = "rkmk4 exp,rk4,mr4,taylor8,exact,rkmk dopri5 cay";

#[test]
fn the_advice_follows_from_the_points() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let args = ["compare", "scene.toml", "--out", "out", "--quick", "--repeat", "2", "--seed", "3"];
    let args = [&args[..], &["--methods", METHODS, "--tolerances", "1e-4,1e-8"]].concat();
    let told = folder.lieflow(&args).ok();
    assert!(told.starts_with("For an error of 1e-6, take “"), "{told}");
    assert!(told.contains("\nFor an error of 1e-9, take “"), "{told}");
    assert!(told.contains("against the exact solution"), "{told}");

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
    // Those that are asked for, and runs between them that come near an error.
    let tolerances = tolerances.as_array().unwrap();
    let given = [0, tolerances.len() - 1].map(|i| tolerances[i]["size"]["Tolerance"].as_f64());
    assert_eq!(given, [Some(1e-4), Some(1e-8)]);
    assert!(tolerances.is_sorted_by(|a, b| a["evaluations"].as_u64() <= b["evaluations"].as_u64()));

    // Times without rows of output; the exact motion is nothing but its rows.
    let without_rows = |curve: &serde_json::Value, point: &serde_json::Value| {
        let number = |key: &str| point[key].as_f64().unwrap();
        let output = number("output_seconds") / (number("h") * number("steps"));
        number("seconds_per_unit") - if curve["method"] == "exact" { 0.0 } else { output }
    };
    for (advice, kept, steps) in [
        ("advice", false, false),
        ("advice_energy_kept", true, false),
        ("advice_steps", false, true),
        ("advice_steps_energy_kept", true, true),
    ] {
        let advice = json[advice].as_array().unwrap();
        assert_eq!(advice.len(), ADVICE.len());
        for choice in advice {
            // The exact motion reaches every error and keeps the energy; the others may not.
            let seconds = choice["seconds_per_unit"].as_f64();
            assert!(steps || seconds.is_some(), "{choice}");
            let error = choice["error"].as_f64().unwrap();
            for curve in curves.iter().filter(|curve| !steps || curve["method"] != "exact") {
                let points = curve["points"].as_array().unwrap();
                let reaches = |p: &&serde_json::Value| {
                    p["error"].as_f64().is_some_and(|e| e <= error)
                        && (!kept || p["energy_error"].as_f64().unwrap() < 1e-13)
                };
                for point in points.iter().filter(reaches) {
                    let time = without_rows(curve, point);
                    assert!(seconds.unwrap() <= time * (1.0 + 1e-9), "{choice} but {point}");
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

    // Operations: the same in every step of an explicit method, the exact motion has none to count.
    let per_step = |curve: &serde_json::Value| -> Vec<Option<f64>> {
        let points = curve["points"].as_array().unwrap().iter();
        let steps =
            |p: &serde_json::Value| p["steps"].as_f64().unwrap() + p["rejected"].as_f64().unwrap();
        points.map(|p| Some(p["operations"].as_f64()? / steps(p))).collect()
    };
    // 4 F of 6 operations, 7 sums y + h a k of 7, 3 times t + h c of 2; 13 flows of 11.
    for (curve, expected) in [("rk4", Some(79.0)), ("mr4", Some(143.0)), ("exact", None)] {
        let found = per_step(curves.iter().find(|c| c["method"] == curve).unwrap());
        assert!(found.iter().all(|n| *n == expected), "{curve}: {found:?}");
    }
    for adaptive in [false, true] {
        let dopri5 = |c: &&serde_json::Value| c["method"] == "rkmk" && c["adaptive"] == adaptive;
        let found = per_step(curves.iter().find(dopri5).unwrap());
        assert!(found.iter().all(|n| n.is_some_and(|n| n > 300.0)), "{found:?}");
    }

    // The front falls from left to right. The exact motion, which is there at once, is not on it.
    let mut front: Vec<(f64, f64)> = Vec::new();
    for curve in curves {
        if curve["method"] == "exact" {
            assert_eq!(curve["pareto"], serde_json::json!([]));
        }
        for at in curve["pareto"].as_array().unwrap() {
            let point = &curve["points"][at.as_u64().unwrap() as usize];
            let number = |key: &str| point[key].as_f64().unwrap();
            front.push((number("error"), without_rows(curve, point)));
        }
    }
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(!front.is_empty() && front.windows(2).all(|w| w[0].1 > w[1].1), "{front:?}");

    let csv = folder.read("out/speed.csv");
    let points: usize = curves.iter().map(|c| c["points"].as_array().unwrap().len()).sum();
    assert_eq!(csv.lines().count(), points + 1);
    for column in
        ["energy_error", "casimir_error", "group_residual", "evaluations", "operations", "pareto"]
    {
        assert!(csv.lines().next().unwrap().contains(column), "{column}");
    }
    let page = folder.read("out/index.html");
    let content = page.split("<script>").next().unwrap();
    assert!(content.contains("the best of all methods") && !content.contains("NaN"));
    assert!(page.contains("until a run takes 5ms"));
    assert!(page.contains("Casimir") && page.contains("nearest to 1e-\u{2060}6"));
    assert!(page.contains("conserve energy"));
    for figure in ["pareto.svg", "operations.svg", "evaluations.svg", "speed-lie-series.svg"] {
        assert!(folder.read(&format!("out/{figure}")).starts_with("<svg"), "{figure}");
    }
    assert!(json["reference_error"].as_f64().unwrap() < 1e-12);

    // The figure has the ten best, each in a colour of its own, also where the table has all.
    folder.lieflow(&[&args[..], &["--all"]].concat()).ok();
    let pareto = folder.read("out/pareto.svg");
    let colours = pareto.split("class=\"lf-s ").skip(1).map(|line| line.split([' ', '"']).next());
    let mut colours: Vec<_> = colours.flatten().filter(|name| *name != "lf-ink").collect();
    let lines = colours.len();
    colours.sort_unstable();
    colours.dedup();
    assert!((5..=10).contains(&lines) && colours.len() == lines, "{colours:?} of {lines}");
}

#[test]
fn both_layers_stand_side_by_side() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let args = ["compare", "scene.toml", "--out", "out", "--quick", "--repeat", "1"];
    let args = [&args[..], &["--layers", "general,closed", "--methods", "rkmk4 cay,rk4"]].concat();
    folder.lieflow(&args).ok();
    let json = folder.json("out/speed.json");
    let curves = json["curves"].as_array().unwrap();
    let layers: Vec<_> = curves.iter().map(|c| (&c["method"], &c["layer"])).collect();
    let expected =
        [("rkmk4", "closed"), ("rk4", "closed"), ("rkmk4", "general"), ("rk4", "general")];
    assert!(layers.iter().zip(expected).all(|(a, b)| *a.0 == b.0 && *a.1 == b.1), "{layers:?}");
    // The layers agree on the solution; closed formulas take fewer operations than 3×3 matrices.
    for pair in [[0, 2], [1, 3]] {
        let [closed, general] = pair.map(|i| &curves[i]["points"][3]);
        let error = |p: &serde_json::Value| p["error"].as_f64().unwrap();
        assert!((error(closed) - error(general)).abs() < 1e-9, "{closed} {general}");
        let operations = |p: &serde_json::Value| p["operations"].as_u64().unwrap();
        assert!(operations(closed) < operations(general), "{closed} {general}");
        // RK4: four fields of three weights (3), a product (27 + 18) and its skew part (3); seven sums.
        if general["steps"] == closed["steps"] && pair[0] == 1 {
            let step = 4 * (3 * 3 + 45 + 3) + 7 * 18;
            assert_eq!(operations(general), step * general["steps"].as_u64().unwrap());
        }
    }
    let page = folder.read("out/index.html");
    assert!(page.contains("on the general layer by every product"), "what an operation is");
    let refused = folder.lieflow(&["compare", "scene.toml", "--layers", "open"]);
    assert!(refused.code == Some(2) && refused.err.contains("closed"), "{refused:?}");
}

/// The operations of the bodies and methods of the paper, by another way to the same numbers.
#[test]
fn operations_are_those_of_a_step_on_counting_numbers() {
    use lieflow_paper::methods::{Body, PaperMethod};
    let scene = Scene::parse("scene", SCENE).unwrap();
    let body = Body::new([1.0, 2.0, 3.0], [0.2, 0.0, 3.0]);
    let model = scene.model_with(Layer::Closed, &["attitude"]).unwrap();
    for (row, name, map) in [
        (PaperMethod::Exp, "rkmk4", Some("exp")),
        (PaperMethod::Cay, "rkmk4", Some("cay")),
        (PaperMethod::Mr, "mr4", None),
        (PaperMethod::B4, "buss4", None),
        (PaperMethod::S, "simo-wong", None),
        (PaperMethod::Dmv10, "dmv10", None),
    ] {
        let method = lieflow::catalog::MethodSpec::new(name, map);
        let ours = Size::Steps(1).operations(&model, &method, &Course::free([0.0, 0.05]), 3);
        let step = row.counted(&body, 0.05).unwrap().unwrap().total();
        assert_eq!(ours, Some(3 * step), "{name}");
    }
}

/// What the reference cannot tell from no error, nobody is advised for.
#[test]
fn no_advice_below_the_error_of_the_reference() {
    let scene = Scene::parse("scene", SCENE).unwrap();
    let candidates = [Candidate::rkmk4("exp", Layer::Closed)];
    let plan = Plan {
        quantities: &["momentum_body"],
        candidates: &candidates,
        t_span: [0.0, 2.0],
        steps: &[10, 1000],
        tolerances: &[],
        rows: &Rows::ENDS,
    };
    let second = Duration::from_secs(1);
    let effort = Effort {
        rounds: 1,
        longest: second,
        shortest: Duration::ZERO,
        seed: 1,
        wanted: &[],
        patience: second,
        goal: None,
        stop: &NEVER,
    };
    let (curves, _) = speed_against_error(&scene, &plan, effort, None, |_| Ok(())).unwrap();
    let own = |apart| Reference::Own { by: "a".into(), beside: "b".into(), apart, largest: None };
    for (apart, told) in [(1e-14, 4), (1e-8, 2), (1e-2, 0)] {
        let reference = own(apart);
        let choices = choices(&curves, &reference, &ADVICE, |_, _| true);
        let found = choices.iter().filter(|choice| choice.best.is_some()).count();
        assert_eq!(found, told, "{apart:e}: {choices:?}");
        assert_eq!(choices[2].judged, apart <= ADVICE[2]);
    }
}

#[test]
fn wrong_options_are_refused_by_one_sentence() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    for (options, words) in [
        (["--methods", "rkmk5"], &["unknown method `rkmk5`", "did you mean `rkmk"][..]),
        (["--methods", "magnus4"], &["no method `magnus4` fits", "`lieflow methods --for`"]),
        (["--methods", "adaptive"], &["no method is named"]),
        (["--tolerances", "-1"], &["between 0 and 1"]),
        (["--error", "1"], &["between 0 and 1"]),
        (["--error", "1e-6,x"], &["between 0 and 1"]),
        (["--error", "1e-20"], &["at least 1e-15"]),
        (["--repeat", "-3"], &["--repeat"]),
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
        rows: &Rows::ENDS,
    };
    let millisecond = Duration::from_millis(1);
    let effort = |rounds| Effort {
        rounds,
        longest: 100 * millisecond,
        shortest: millisecond,
        seed: 1,
        wanted: &[],
        patience: Duration::ZERO,
        goal: None,
        stop: &NEVER,
    };
    let measure = |of: &str, rounds| {
        let mut journal = Journal::open(folder.path(), of).unwrap();
        let known = journal.known();
        let (curves, _) =
            speed_against_error(&scene, &plan, effort(rounds), Some(&mut journal), |_| Ok(()))
                .unwrap();
        (known, curves)
    };
    let (known, whole) = measure("a", 3);
    assert_eq!(known, 0);
    // Cut in the middle of a line among the timings of the second round.
    let text = folder.read(JOURNAL);
    let whole_lines = text.lines().take(1 + 6 + 6 + 2).map(|line| line.len() + 1).sum::<usize>();
    let half = &text[..whole_lines + 5];
    folder.write(JOURNAL, half);
    let (known, resumed) = measure("a", 3);
    assert_eq!(known, 6);
    // The cut line stays where it is, and says nothing.
    let entries = |kind: &str| {
        let entry = format!("{{\"{kind}\":[\"");
        let text = folder.read(JOURNAL);
        text.lines().filter(|l| l.starts_with(&entry) && l.ends_with('}')).count()
    };
    assert!(folder.read(JOURNAL).starts_with(half));
    assert_eq!((entries("Point"), entries("Time")), (6, 18));
    for (a, b) in whole.iter().zip(&resumed) {
        for (p, q) in a.points.iter().zip(&b.points) {
            // The first run was timed once.
            assert!((p.first_seconds - q.first_seconds).abs() <= 1e-12 * p.first_seconds);
            assert!((p.error - q.error).abs() <= 1e-12 * p.error);
        }
    }
    // Of something else nothing is known, and nothing of this is lost. More rounds are added.
    assert_eq!(measure("b", 3).0, 0);
    assert_eq!(measure("a", 5).0, 6);
    assert_eq!((entries("Point"), entries("Time")), (12, 18 + 18 + 12));
    assert_eq!(measure("b", 1).0, 6);
    assert_eq!(entries("Time"), 18 + 18 + 12);
}

/// Where the usual length of a run reaches no error that is wanted, some methods go on until one does.
#[test]
fn long_times_are_gone_through_to_the_wanted_error() {
    let scene = Scene::parse("scene", SCENE).unwrap();
    let names = ["rkmk4 exp", "rkmk4 cay", "rk4", "cf4", "gauss4", "cf3", "cg3", "taylor4", "mr4"];
    let all = Candidate::all_that_fit(&scene, &["momentum_body"], Layer::Closed).unwrap();
    let candidates =
        Candidate::chosen(&scene, &["momentum_body"], &all, &names.map(String::from)).unwrap();
    let steps: Vec<u64> = (2..16).map(|k| 1 << k).collect();
    let plan = Plan {
        quantities: &["momentum_body"],
        candidates: &candidates,
        t_span: [0.0, 20.0],
        steps: &steps,
        tolerances: &[],
        rows: &Rows::ENDS,
    };
    let measure = |wanted| {
        // Every run takes too long to go on by itself.
        let (longest, patience) = (Duration::ZERO, Duration::from_secs(60));
        let effort = Effort {
            rounds: 1,
            longest,
            shortest: longest,
            seed: 1,
            wanted,
            patience,
            goal: None,
            stop: &NEVER,
        };
        speed_against_error(&scene, &plan, effort, None, |_| Ok(())).unwrap().0
    };
    let runs = |curves: &[Curve]| -> Vec<usize> {
        curves.iter().map(|curve| curve.points.len()).collect()
    };
    assert!(runs(&measure(&[])).iter().all(|n| *n == 1));
    let curves = measure(&[1e-3, 1e-6]);
    let reaches = |curve: &&Curve| curve.points.iter().any(|p| p.error <= 1e-6);
    let reached = curves.iter().filter(reaches).count();
    assert!((1..=6).contains(&reached), "{reached} methods reach it, at most one round of them");
    assert!(runs(&curves).iter().sum::<usize>() < candidates.len() * 10, "{:?}", runs(&curves));
    let timed = |p: &WorkPoint| p.seconds_per_unit > 0.0 || p.failure.is_some();
    assert!(curves.iter().flat_map(|c| &c.points).all(timed));
}

/// A run that has left the range of the arithmetic is no hit.
#[test]
fn a_run_without_numbers_reaches_no_error() {
    let scene = Scene::bundled("fodo-cell").unwrap();
    let t_span = scene.grid.t_span();
    let judge = judge_of(&scene, &["phase_space"], t_span, &[]);
    let all = Candidate::all_that_fit(&scene, &["phase_space"], Layer::General).unwrap();
    let model = scene.model_with(Layer::General, &judge.quantities()).unwrap();
    for name in ["rkmk dopri5 exp", "rk dop853"] {
        let candidate = all.iter().find(|c| c.method.label() == name && !c.adaptive).unwrap();
        for steps in [30, 60, 120] {
            let size = Size::Steps(steps);
            let point = judge.point(&model, candidate, size);
            assert!(point.error.is_nan() || point.error > 1e-3, "{name}, {steps}: {point:?}");
        }
    }
}

/// A body under a torque that moves nothing: its motion is that of the free body, but it is not known.
#[test]
fn two_methods_agree_where_the_exact_solution_is_not_known() {
    let free = SCENE.replace("rigid-body", "driven-body").replace("layer = \"closed\"\n", "");
    let driven = free.replace("[method]", "thruster = [1e-30, 0, 0]\n[method]");
    let [body, free, driven] =
        [SCENE, &free, &driven].map(|text| Scene::parse("scene", text).unwrap());
    let judged = |scene| judge_of(scene, &["attitude"], [0.0, 2.0], &[1, 100]);
    let judge = judged(&driven);
    let Reference::Own { by, beside, apart, largest: None } = &judge.reference else {
        panic!("not exact")
    };
    assert_ne!(by, beside);
    assert!(*apart < 1e-11, "{apart:e}");
    assert!(judge.reference.in_words().contains("It agrees with a run of"));

    let Reference::Exact { rounding: Some(Rounding { apart, steps: 100 }) } =
        judged(&body).reference
    else {
        panic!("not exact")
    };
    assert!(apart < 1e-12, "{apart:e}");
    let exact = judged(&free);
    assert!(matches!(exact.reference, Reference::Exact { .. }), "{:?}", exact.reference);
    let [a, b] = [(&judge, &driven), (&exact, &free)].map(|(judge, scene)| {
        let model = scene.model_with(scene.layer, &judge.quantities()).unwrap();
        let candidate = Candidate::rkmk4("exp", scene.layer);
        judge.point(&model, &candidate, Size::Steps(100)).error
    });
    assert!((a - b).abs() < 1e-10, "{a:e} {b:e}");
}

/// A drive of resonance over whole turns: the errors of two long steps cancel at the end, and the state between is wrong.
#[test]
fn errors_that_cancel_at_the_end_are_seen() {
    let scene = Scene::bundled("thermal-qubit").unwrap();
    let t_span = scene.grid.t_span();
    let judge = judge_of(&scene, &["populations"], t_span, &[2]);
    let model = scene.model_with(scene.layer, &judge.quantities()).unwrap();
    let candidate = Candidate { layer: scene.layer, ..Candidate::rkmk4("cay", Layer::Closed) };
    let error = |steps| {
        let mut point = judge.point(&model, &candidate, Size::Steps(steps));
        judge.look_within(&model, &candidate.method, &mut point);
        point.error
    };
    assert!(error(2) > 0.1, "{:e}", error(2));
    // Of many steps it is that at the end.
    assert!(error(1600) < 1e-5, "{:e}", error(1600));
}

/// Gauss methods keep quadratic invariants, and so the spheres of spins. An invariant that is 0 has the size of its terms.
#[test]
fn the_distance_from_m_is_that_of_the_invariants() {
    let folder = Folder::new();
    let found = |scene: &str, methods: &str| {
        let quick = ["--quick", "--repeat", "1", "--error", "1e-5"];
        let args = [&["compare", scene, "--out", "out", "--methods", methods], &quick[..]].concat();
        (folder.lieflow(&args).ok(), folder.json("out/speed.json"))
    };
    let (told, _) = found("many-bodies", "gauss6,energy-casimir6 cay");
    assert!(told.contains("take “gauss6”") && !told.contains("leaves M"), "{told}");
    let (_, json) = found("spherical-pendulum", "rk dop853,rkmk4 exp");
    let mut points = 0;
    for curve in json["curves"].as_array().unwrap() {
        for point in curve["points"].as_array().unwrap() {
            let [off, error] = ["off_manifold", "error"].map(|key| point[key].as_f64());
            if let Some(off) = off.filter(|_| error < Some(0.01)) {
                assert!(off < 0.01, "{point}");
                points += 1;
            }
        }
    }
    assert!(points > 4, "{points}");
}

#[test]
fn a_scene_without_an_exact_solution_is_judged_by_two_runs() {
    let folder = Folder::new();
    let methods = "magnus4,magnus6,rkmk4 exp,rk4";
    let args = ["compare", "rabi", "--out", "out", "--quick", "--methods", methods];
    let told = folder.lieflow(&args).ok();
    let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.contains("It agrees with a run of"), "{told}");
    let json = folder.json("out/speed.json");
    assert!(json["reference"].as_str().unwrap().contains("dop853"), "{json}");
    let best = json["advice"][1]["method"].as_str().unwrap();
    assert!(best.starts_with("magnus"), "{best}");
    assert!(!folder.read("out/index.html").contains("conserve energy"));
}

/// A body that starts near its separatrix: some numbers of steps of the exact motion meet calm moments only, and
/// others do not.
#[test]
fn the_floor_is_that_of_many_steps_near_a_separatrix() {
    let text = r#"title = "Satellite"
[problem]
kind = "rigid-body"
inertia = [0.01, 0.0103, 0.0108]
omega_body = [0.01, 1.0, 0.0]
[method]
name = "rkmk4"
[time]
t_span = [0, 600.0]
dt = 0.2
[output]
quantities = ["attitude"]
every = 100
"#;
    let scene = Scene::parse("scene", text).unwrap();
    let t_span = scene.grid.t_span();
    let many = [188, 375, 750, 1500, 3000];
    let floors = |quantity: &str| {
        [&[][..], &many].map(|steps| judge_of(&scene, &[quantity], t_span, steps).reference.floor())
    };
    let [low, high] = floors("momentum_body");
    assert!(high > 3.0 * low, "{low:e} {high:e}");
    let [low, high] = floors("attitude");
    // Where smaller steps no longer help a method of high order, its error is no larger.
    let judge = judge_of(&scene, &["attitude"], t_span, &many);
    let model = scene.model_with(Layer::Closed, &judge.quantities()).unwrap();
    let all = Candidate::all_that_fit(&scene, &["attitude"], Layer::Closed).unwrap();
    let taylor = all.iter().find(|c| c.method.name == "taylor16").unwrap();
    let mut errors =
        [1500, 2000, 2500, 3000].map(|steps| judge.point(&model, taylor, Size::Steps(steps)).error);
    errors.sort_by(f64::total_cmp);
    assert!(errors[1] > low && errors[2] < 3.0 * high, "{errors:?}, {low:e} {high:e}");
}

/// The rows of the scene are part of what is timed: the exact motion pays for each of them.
#[test]
fn the_output_of_the_scene_is_timed() {
    let text = SCENE.replace("every = 10", "every = 1").replace("dt = 0.05", "dt = 0.001");
    let scene = Scene::parse("scene", &text).unwrap();
    let rows = Rows::of(&scene);
    assert!(matches!(&rows.save, lieflow::SaveAt::Times(times) if times.len() == 2001));
    let all = Candidate::all_that_fit(&scene, &["momentum_body"], Layer::Closed).unwrap();
    let names = ["exact", "taylor8"].map(String::from);
    let candidates = Candidate::chosen(&scene, &["momentum_body"], &all, &names).unwrap();
    let exact = |rows: &Rows| {
        let plan = Plan {
            quantities: &["momentum_body"],
            candidates: &candidates,
            t_span: [0.0, 2.0],
            steps: &[1, 100],
            tolerances: &[],
            rows,
        };
        let millisecond = Duration::from_millis(1);
        let effort = Effort {
            rounds: 5,
            longest: Duration::from_secs(1),
            shortest: millisecond,
            seed: 1,
            wanted: &[],
            patience: millisecond,
            goal: None,
            stop: &NEVER,
        };
        let (curves, _) = speed_against_error(&scene, &plan, effort, None, |_| Ok(())).unwrap();
        let exact = curves.iter().find(|c| c.candidate.method.name == "exact").unwrap();
        exact.points[0].seconds_per_unit
    };
    // The two are equal where rows are not timed. A row costs about a twentieth of what comes before all rows.
    let (bare, with_rows) = (exact(&Rows::ENDS), exact(&rows));
    assert!(with_rows > 10.0 * bare, "one evaluation {bare:e}, 2001 of them {with_rows:e}");
}

/// Ctrl-C keeps what was measured and says how to go on; the same command does, with other options too.
#[cfg(unix)]
#[test]
fn an_interrupted_comparison_goes_on() {
    use std::process::Stdio;
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let args = ["compare", "scene.toml", "--out", "out", "--methods", METHODS];
    let slow = [&args[..], &["--repeat", "1000"]].concat();
    let mut run = folder.command(&slow);
    let child = run.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let points = || match folder.names("out").contains(&JOURNAL.to_string()) {
        true => folder.read(&format!("out/{JOURNAL}")).matches("\"Point\"").count(),
        false => 0,
    };
    while points() < 10 {
        std::thread::sleep(Duration::from_millis(5));
    }
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    let run = crate::support::Run::from(child.wait_with_output().unwrap());
    let message = run.failed(130);
    assert!(message.contains(JOURNAL) && message.contains("the same command goes on"), "{message}");
    let known = points();
    let quick = [&args[..], &["--quick", "--error", "1e-5", "--repeat", "2"]].concat();
    let told = folder.lieflow(&quick).ok();
    assert!(told.starts_with(&format!("{known} runs are known from before")), "{told}");
    assert!(told.contains("For an error of 1e-5, take") && !told.contains("1e-9"), "{told}");
    // Everything is known the next time, until it is to be measured again.
    let measured = points();
    let told = folder.lieflow(&quick).ok();
    assert!(told.starts_with(&format!("{measured} runs are known")) && points() == measured);
    let told = folder.lieflow(&[&quick[..], &["--again"]].concat()).ok();
    assert!(told.starts_with("For an error of 1e-5"), "{told}");
}
