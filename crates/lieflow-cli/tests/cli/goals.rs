//! `lieflow compare` with a goal: the method for an error that is asked for, or for an invariant that is kept.

use std::time::Duration;

use crate::support::{Folder, SCENE};
use lieflow_cli::measure::{
    Candidate, Curve, Effort, Judge, NEVER, Plan, Reference, Rows, Size, WorkPoint,
    speed_against_error,
};
use lieflow_cli::report::Answer;
use lieflow_model::problem::Layer;
use lieflow_model::scene::Scene;

/// Long steps of both references pass over a pulse. The end is that of short ones then, and a step of Euler is no advice.
#[test]
fn the_reference_passes_over_no_pulse() {
    let text = r#"
[problem]
kind = "driven-body"
inertia = [1.0, 2.0, 2.5]
omega_body = [0.0, 0.0, 0.1]
torque = ["10*exp(-((t-70)/0.01)^2)", "0", "0"]
[time]
t_span = [0.0, 100.0]
"#;
    let judge_of = |text: &str| {
        let scene = Scene::parse("scene", text).unwrap();
        let span = scene.grid.t_span();
        let longest = Duration::from_secs(1);
        Judge::new(&scene, &["attitude"], span, &[], longest, &NEVER).unwrap().reference
    };
    let found = judge_of(text);
    let Reference::Own { apart, largest: Some(0.05), .. } = found else { panic!("{found:?}") };
    assert!(apart < 1e-10, "{apart:e}");
    let told = found.in_words();
    assert!(told.contains("in steps of at most 0.05: longer ones pass over something"), "{told}");
    // Without the pulse long steps have the end.
    let found = judge_of(&text.replace("0.01)^2", "10)^2"));
    assert!(matches!(found, Reference::Own { largest: None, .. }), "{found:?}");
}

#[test]
fn an_answer_follows_from_the_runs() {
    let scene = Scene::parse("scene", SCENE).unwrap();
    let all = Candidate::all_that_fit(&scene, &["momentum_body"], Layer::Closed).unwrap();
    // error = h^p and a cost for each step, on a span of 1.
    let curve = |name: &str, order: usize, cost: f64| {
        let candidate = all.iter().find(|c| c.name() == name).unwrap().clone();
        let run = |steps: u64| WorkPoint {
            error: (1.0 / (steps as f64).powi(order as i32)).max(1e-12),
            seconds_per_unit: cost * steps as f64,
            ..WorkPoint::new([0.0, 1.0], Size::Steps(steps))
        };
        let points = [1, 2, 4, 8, 10, 16, 32, 64, 100, 128, 256, 512, 1024, 2048].map(run).to_vec();
        Curve {
            label: candidate.name(),
            candidate,
            order: Some(order),
            stays: name != "rk4",
            floor: 1e-13,
            points,
        }
    };
    let curves = [curve("taylor8", 8, 2e-6), curve("taylor10", 10, 4e-5), curve("rk4", 4, 1e-6)];
    let reference =
        Reference::Own { by: "a".into(), beside: "b".into(), apart: 1e-13, largest: None };
    let answer = |error| Answer::new(&curves, &reference, error);
    let told = answer(1e-8).in_words();
    for part in [
        "For an error of 1e-8, take “taylor8” in 10 steps (dt = 0.1): the run takes 20.0\u{a0}µs.",
        "It is 5.0 times as fast as “rk4”, the best method of another kind: ",
        "“rk4” needs 10 times as many steps (its order is 4, that of “taylor8” is 8), though a step of \
         “taylor8” costs 2.0 times as much.",
        "“taylor8” conserves: group, Casimirs.",
    ] {
        assert!(told.contains(part), "{told}");
    }
    assert_eq!(answer(1e-8).next().unwrap().0.label, "rk4");
    let told = answer(3e-13).in_words();
    assert!(told.contains("No method reaches an error of 3e-13"), "{told}");
    let told = answer(1e-14).in_words();
    assert!(
        told.contains("cannot be seen") && told.contains("an error of 1e-13 or more"),
        "{told}"
    );
}

/// A method that leaves M comes after those that stay, with its distance from M.
#[test]
fn who_stays_on_m_is_told_first() {
    let scene = Scene::parse("scene", SCENE).unwrap();
    let all = Candidate::all_that_fit(&scene, &["momentum_body"], Layer::Closed).unwrap();
    let curve = |name: &str, stays: bool, cost: f64| {
        let candidate = all.iter().find(|c| c.name() == name).unwrap().clone();
        let run = |steps: u64| WorkPoint {
            error: 1.0 / (steps as f64).powi(4),
            off_manifold: if stays { 1e-16 } else { 0.1 * (steps as f64).powi(-4) },
            seconds_per_unit: cost * steps as f64 + 1e-4,
            output_seconds: 1e-4,
            ..WorkPoint::new([0.0, 1.0], Size::Steps(steps))
        };
        let steps = [1, 2, 4, 8, 16, 32, 64, 100, 128, 256, 512, 1024, 2048];
        let (label, points) = (candidate.name(), steps.map(run).to_vec());
        Curve { label, candidate, order: Some(4), stays, floor: 1e-13, points }
    };
    let reference =
        Reference::Own { by: "a".into(), beside: "b".into(), apart: 1e-13, largest: None };
    let curves =
        [curve("rkmk4 exp", true, 2e-6), curve("rk4", false, 1e-6), curve("cf4", true, 4e-6)];
    let told = Answer::new(&curves, &reference, 1e-8).in_words();
    for part in [
        "take “rkmk4 exp” in 100 steps (dt = 0.01): the run takes 200\u{a0}µs, and 300\u{a0}µs with its rows of output.",
        "It is 2.0 times as fast as “cf4”",
        "“rk4” is 2.0 times as fast, and leaves M: it ends 1e-9 away from it.",
    ] {
        assert!(told.contains(part), "{told}");
    }
    let told = Answer::new(&curves[1..2], &reference, 1e-8).in_words();
    assert!(
        told.contains("No method that stays on M reaches it; this one ends 1e-9 away from M."),
        "{told}"
    );
    // What is advised was run: it is no point between two runs.
    let mut curves = curves;
    curves[0].points.retain(|point| point.size != Size::Steps(100));
    let told = Answer::new(&curves[..1], &reference, 1e-8).in_words();
    assert!(told.contains("take “rkmk4 exp” in 128 steps"), "{told}");
    // A reference that is good enough is no reason to worry.
    let reference =
        Reference::Own { by: "a".into(), beside: "b".into(), apart: 5e-9, largest: None };
    assert!(!reference.in_words().contains("NOT") && reference.in_words().contains("to 5e-9"));
}

/// Where one error is asked for, methods stop there, and slow ones before.
#[test]
fn an_error_that_is_asked_for_is_a_goal() {
    let scene = Scene::parse("scene", SCENE).unwrap();
    let candidates = Candidate::all_that_fit(&scene, &["momentum_body"], Layer::Closed).unwrap();
    let steps: Vec<u64> = (0..14).map(|k| 1 << k).collect();
    let plan = Plan {
        quantities: &["momentum_body"],
        candidates: &candidates,
        t_span: [0.0, 20.0],
        steps: &steps,
        tolerances: &[1e-4, 1e-8, 1e-12],
        rows: &Rows::ENDS,
    };
    let measure = |goal| {
        let effort = Effort {
            rounds: 1,
            longest: Duration::from_millis(30),
            shortest: Duration::ZERO,
            seed: 1,
            wanted: &[],
            patience: Duration::ZERO,
            goal,
            stop: &NEVER,
        };
        speed_against_error(&scene, &plan, effort, None, |_| Ok(())).unwrap().0
    };
    let (every, pruned) = (measure(None), measure(Some(1e-8)));
    assert!(every.iter().zip(&pruned).all(|(a, b)| a.candidate == b.candidate));
    // A method ends with its first run within the error, or before it, where it is slow.
    let needed = |curve: &Curve| {
        let there = curve.points.iter().position(|point| point.error <= 1e-8);
        there.map_or(curve.points.len(), |there| there + 1)
    };
    let (mut slow, mut spared) = (0, 0);
    for (all, goal) in every.iter().zip(&pruned) {
        assert!(goal.points.len() <= needed(all), "{}", all.label);
        slow += usize::from(goal.points.len() < needed(all));
        spared += usize::from(needed(all) < all.points.len());
    }
    let count = every.len();
    assert!(3 * slow > count && 3 * spared > 2 * count, "{slow} and {spared} of {count}");
    let seconds = |curves: &[Curve]| -> f64 {
        curves.iter().flat_map(|curve| &curve.points).map(|point| point.first_seconds).sum()
    };
    let [goal, all] = [&pruned, &every].map(|curves| seconds(curves));
    assert!(goal < 0.2 * all, "{goal} of {all} seconds");
    let timed = |p: &WorkPoint| p.seconds_per_unit > 0.0 || p.failure.is_some();
    assert!(pruned.iter().flat_map(|curve| &curve.points).all(timed));
}

/// What is advised was run: its error is not larger than the one that is asked for.
#[test]
fn the_steps_that_are_advised_were_taken() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let args = "compare scene.toml --out out --quick --repeat 1 --error 1e-5,1e-7,1e-10 --methods";
    let methods = "rkmk4 exp,rk4,taylor8,taylor12,rkmk dopri5 exp,rkmk dop853 exp,cf4,rk dop853";
    let args: Vec<&str> = args.split(' ').chain([methods]).collect();
    folder.lieflow(&args).ok();
    let json = folder.json("out/speed.json");
    let label = |curve: &serde_json::Value| {
        let parts = ["method", "tableau", "map"].map(|key| curve[key].as_str());
        let name: Vec<_> = parts.into_iter().flatten().collect();
        name.join(" ") + if curve["adaptive"] == true { ", adaptive" } else { "" }
    };
    let points = |name: &str| {
        let curve = json["curves"].as_array().unwrap().iter().find(|curve| label(curve) == name);
        curve.expect(name)["points"].as_array().unwrap().clone()
    };
    for answer in json["answers"].as_array().unwrap() {
        let error = answer["error"].as_f64().unwrap();
        for found in ["best", "next", "leaving"].map(|key| &answer[key]) {
            let Some(name) = found["method"].as_str() else { continue };
            let is_it = |p: &serde_json::Value| match found["rtol"].is_null() {
                true => p["h"] == found["h"],
                false => p["size"]["Tolerance"] == found["rtol"],
            };
            let run = points(name).into_iter().find(is_it);
            let run = run.unwrap_or_else(|| panic!("{found} was not run"));
            assert!(run["error"].as_f64().unwrap() <= error, "{found}: {run}");
        }
    }
}

/// With the quantities that are written a method may fail that reaches the end without them: then it has no time.
#[test]
fn a_method_that_fails_with_its_rows_is_left_out() {
    let folder = Folder::new();
    let args =
        ["compare", "wing-nut", "--quick", "--repeat", "1", "--error", "1e-3", "--out", "out"];
    folder.lieflow(&[&args[..], &["--methods", "lewis-simo,rkmk4 exp,taylor11"]].concat()).ok();
    let json = folder.json("out/speed.json");
    assert!(json["answers"][0]["best"]["method"].is_string(), "{json}");
}

/// The sign of a quaternion that is only drawn costs no points within the steps.
#[test]
fn a_figure_costs_no_points_for_each_radian() {
    let folder = Folder::new();
    let within = |quantity: &str| {
        let scene = format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 2.5]\nomega_body = [30, 100, 50]\n[method]\n\
             name = \"exact\"\n[time]\nt_span = [0, 100]\nsteps = 100\n[output]\nquantities = [\"{quantity}\"]\n"
        );
        folder.run(&scene).ok();
        folder.json("out/summary.json")["side_steps"].as_u64().expect("a count")
    };
    assert!(within("quaternion") > 10_000);
    assert!(within("attitude") < 1_000);
}

#[test]
fn an_invariant_may_be_kept_for_long_times() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let args =
        ["compare", "scene.toml", "--quick", "--repeat", "1", "--error", "1e-4", "--out", "out"];
    folder.lieflow(&[&args[..], &["--keep", "energy"]].concat()).ok();
    let json = folder.json("out/speed.json");
    let curves = json["curves"].as_array().unwrap();
    let names: Vec<&str> = curves.iter().map(|curve| curve["method"].as_str().unwrap()).collect();
    assert!(names.contains(&"mr4") && names.contains(&"exact"), "{names:?}");
    assert!(!names.contains(&"rkmk4") && !names.contains(&"rk4"), "{names:?}");
    let listed = folder.lieflow(&["methods", "--for", "scene.toml", "--keep", "energy"]).ok();
    assert!(listed.contains("mr4") && !listed.contains("rkmk4"), "{listed}");
    assert!(listed.contains("--error 1e-8 --keep energy"), "{listed}");
    let refused = folder.lieflow(&[&args[..], &["--keep", "enrgy"]].concat()).refused();
    assert!(refused.contains("no invariant `enrgy`") && refused.contains("energy"), "{refused}");
    let refused = folder
        .lieflow(&[&args[..], &["--keep", "energy", "--methods", "rkmk4"]].concat())
        .refused();
    assert!(refused.contains("keeps energy"), "{refused}");
}
