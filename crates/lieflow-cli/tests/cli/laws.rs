//! Every method that fits a kind runs on it and is right; what it promises to keep it keeps, and what is
//! not promised may move.

use std::sync::atomic::AtomicBool;

use crate::support::Folder;
use lieflow::catalog::{MethodSpec, all_methods};
use lieflow::problems::{Invariant, Law};
use lieflow_cli::args::ErrorCheck;
use lieflow_cli::cmd::run::{Options, run_scene};
use lieflow_cli::output::{Drift, Watched};
use lieflow_model::scene::{BUNDLED, Bundled, Scene};
use lieflow_model::schema::Row;

fn far(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A bundled scene with another method over a short time, in so many steps of the scene's.
fn short(name: &str, method: &MethodSpec, steps: u64) -> Scene {
    let mut of = Scene::bundled(name).unwrap();
    let dt = if of.adaptive.is_some() { 0.01 } else { of.grid.h() };
    let t0 = of.grid.t_span()[0];
    of.grid = lieflow::TimeGrid::with_steps([t0, t0 + steps as f64 * dt], steps).unwrap();
    of.adaptive = None;
    of.save = lieflow::SaveAt::Every(1);
    of.method = method.clone();
    of
}

fn of_kind(scene: &str, kind: &str) -> bool {
    Scene::bundled(scene).unwrap().problem.kind().name == kind
}

/// All methods with their default parts agree at small steps: every field, every action and every
/// classical form of an equation is looked at by all the others.
#[test]
fn every_method_that_fits_a_kind_is_right() {
    for bundled in BUNDLED {
        let of = Scene::bundled(bundled.name).unwrap();
        let model = of.problem.model(of.layer, of.problem.state(&[])).unwrap();
        let [t0, t1] = short(bundled.name, &of.method, 4).grid.t_span();
        // Of the scene's steps one, in eight; a fluid, whose steps are dear, in two.
        let steps = if of_kind(bundled.name, "fluid") { 2 } else { 8 };
        let span = lieflow::TimeGrid::with_steps([t0, t0 + 0.25 * (t1 - t0)], steps).unwrap();
        let end = |method: &MethodSpec| {
            let mut last = Vec::new();
            let mut sink = |_: f64, row: Row<'_>| last = row.values().to_vec();
            let run = model.run(method, &span, &lieflow::SaveAt::Ends, &mut sink);
            run.map(|_| last)
        };
        let fine = MethodSpec { tableau: Some("dop853".into()), ..MethodSpec::new("rkmk", None) };
        let reference = end(&fine).unwrap();
        let start = model.run(&fine, &span, &lieflow::SaveAt::Ends, &mut |_, _| {});
        assert!(start.is_ok());
        let size = reference.iter().fold(1e-3, |a: f64, x| a.max(x.abs()));
        let mut seen = 0;
        for info in all_methods() {
            let method = MethodSpec::new(info.name, None);
            if model.fits(&method).is_err() {
                continue;
            }
            let gap = far(&end(&method).unwrap(), &reference) / size;
            assert!(gap < 1e-3, "{} on {}: {gap:e}", info.name, bundled.name);
            seen += 1;
        }
        assert!(seen >= 19, "{}: {seen} methods", bundled.name);
    }
}

/// The methods of linear equations fit those and no others.
#[test]
fn magnus_methods_fit_linear_equations() {
    let linear = [
        "rotating-field",
        "rolling-turn",
        "mathieu",
        "coupled-oscillators",
        "fodo-cell",
        "riccati-pole",
        "crossed-fields",
        "rabi",
        "three-level-transfer",
        "rotating-drive",
        "landau-zener",
        "stirap",
        "thermal-qubit",
    ];
    for bundled in BUNDLED {
        let fits = Scene::bundled(bundled.name).unwrap().model().unwrap();
        let fits = fits.fits(&MethodSpec::new("magnus4", None));
        assert_eq!(fits.is_ok(), linear.contains(&bundled.name), "{}", bundled.name);
        if let Err(error) = fits {
            assert!(error.to_string().contains("an equation of linear type"), "{error}");
        }
    }
}

/// Over 500 steps: a drift that a method promises not to have is explained by rounding, and one that is
/// promised by none of its laws shows in a coarse method.
#[test]
fn promises_are_kept_and_only_those_are_made() {
    let folder = Folder::new();
    let map = |name: &str, map: &str| MethodSpec::new(name, Some(map));
    let coarse = MethodSpec { tableau: Some("heun".into()), ..MethodSpec::new("rk", None) };
    let methods = [
        map("rkmk4", "exp"),
        map("rkmk4", "cay"),
        MethodSpec::new("cf4", None),
        MethodSpec::new("gauss4", None),
        MethodSpec::new("isospectral2", None),
        MethodSpec::new("isospectral4", None),
        MethodSpec::new("energy-casimir", None),
        MethodSpec::new("cfm4-2", None),
        coarse.clone(),
    ];
    let mut moved = Vec::new();
    for bundled in BUNDLED {
        let scene = Scene::bundled(bundled.name).unwrap();
        let model = scene.model().unwrap();
        for method in methods.iter().filter(|method| model.fits(method).is_ok()) {
            let fluid = of_kind(bundled.name, "fluid");
            // No further than samples.
            let most = scene.problem.samples().map_or(500, |_| scene.grid.steps());
            let steps = if fluid { 20 } else { most };
            let of = short(bundled.name, method, steps);
            let options = Options { error_check: ErrorCheck::Never, ..Options::default() };
            let summary = run_scene(&of, folder.path(), options, &AtomicBool::new(false)).unwrap();
            if !summary.completed {
                // A classical method cannot pass a pole.
                assert_eq!((bundled.name, method.map.is_none()), ("riccati-pole", true));
                continue;
            }
            for (name, drift) in &summary.drift {
                assert!(
                    !drift.breaks_a_promise(),
                    "{name} on {} by {}: {drift:?}",
                    bundled.name,
                    method.label()
                );
                if *method == coarse && !drift.promised && drift.max > drift.rounding {
                    moved.push((bundled.name, name.clone()));
                }
            }
            // The paper's body of high energy is none that there is; and some of these runs are coarse. A matrix that a
            // classical method has taken far from the group has no quaternion.
            let known = |warning: &String| {
                warning.contains("impossible for a real body")
                    || warning.contains("` is wrong by ")
                    || method.map.is_none()
                        && warning.starts_with('q')
                        && bundled.name == "gyro-record"
            };
            assert!(summary.warnings.iter().all(known), "{}: {:?}", bundled.name, summary.warnings);
        }
    }
    // Heun's method promises linear invariants alone, and the others do move.
    for (scene, law) in [
        ("manakov-body", "energy"),
        ("manakov-body", "trm2"),
        ("manakov-body", "integral1"),
        ("lagrange-top", "vertical_norm2"),
        ("kovalevskaya-top", "integral"),
        ("kovalevskaya-top", "momentum_vertical"),
        ("ellipsoid-in-fluid", "linear_norm2"),
        ("euler-on-sl3", "trm3"),
        ("spherical-pendulum", "direction_norm2"),
        ("spherical-pendulum", "energy"),
        ("spin-wave", "lengths2"),
        ("rotating-field", "moment_norm"),
        ("toda-lattice", "e1"),
        ("sorting", "e4"),
        ("qr-flow", "e2"),
        ("oja", "stiefel_defect"),
        ("mathieu", "symplectic_defect"),
        ("fodo-cell", "symplectic_defect"),
        ("crossed-fields", "mass_shell"),
        ("rabi", "probability"),
        ("many-bodies", "norm3"),
        ("damped-satellite", "attitude_defect"),
        ("lorenz", "frame_defect"),
        ("vortices-on-sphere", "energy"),
        ("shear-layer", "enstrophy"),
    ] {
        let found = moved.iter().any(|(s, l)| *s == scene && l == law);
        assert!(found, "{law} of {scene} did not move by Heun's method");
    }
    // The total spin and the angular momentum about the vertical are linear: it keeps them.
    let linear = ["total_spin3", "vertical_momentum"];
    assert!(moved.iter().all(|(_, law)| !linear.contains(&law.as_str())), "{moved:?}");
}

/// What a run writes beside its rows.
#[test]
fn a_run_states_what_was_modelled_and_draws_it() {
    let folder = Folder::new();
    let told = folder.lieflow(&["run", "mathieu", "--out", "out"]).ok();
    assert!(
        told.contains("stable: no") && told.contains("conserved to rounding: symplectic_defect"),
        "{told}"
    );
    let summary = folder.json("out/summary.json");
    assert_eq!(summary["modelled"][0], "fundamental solution in Sp(2)");
    assert_eq!(summary["layer"], "general");
    assert!(summary["facts"]["largest_multiplier"].as_f64().unwrap() > 1.5);
    let drift = &summary["drift"]["symplectic_defect"];
    for key in ["initial", "at_end", "max", "slope", "rounding"] {
        assert!(drift[key].is_number(), "{drift}");
    }
    assert_eq!(drift["promised"], true);
    for figure in ["figure.svg", "drift.svg", "time-trace.svg"] {
        assert!(folder.read(&format!("out/{figure}")).starts_with("<svg"), "{figure}");
    }
    let page = folder.read("out/index.html");
    assert!(page.contains("Drifts of the invariants") && !page.contains("NaN"));

    // Damping is a torque that no energy survives, and nothing is said of it.
    folder.lieflow(&["run", "damped-satellite", "--out", "out"]).ok();
    let summary = folder.json("out/summary.json");
    assert!(
        summary["drift"]["energy"].is_null() && summary["drift"]["attitude_defect"].is_object()
    );
    assert!(summary["modelled"][0].as_str().unwrap().ends_with("torques: damping"));

    folder.write(
        "flat.toml",
        &Bundled::named("asymmetric-top")
            .unwrap()
            .text
            .replace("inertia = [1.0, 2.0, 3.0]", "inertia = [1.0, 2.0, 4.0]"),
    );
    let told = folder.lieflow(&["run", "flat.toml", "--out", "out"]).ok();
    assert!(told.contains("WARNING: inertia: J3 > J1 + J2 (4 > 1 + 2): "), "{told}");
    assert_eq!(folder.json("out/summary.json")["warnings"].as_array().unwrap().len(), 1);
}

fn energy() -> Invariant {
    Invariant::new("energy", Law::by_the_flow(2))
}

#[test]
fn the_slope_of_a_drift_is_that_of_the_line() {
    let mut watched = Watched::new(2.0, energy(), 5.0, 5.0);
    for i in 1..100 {
        let t = 2.0 + 0.1 * f64::from(i);
        let wave = if i % 2 == 0 { 1e-3 } else { -1e-3 };
        watched.see(t, 5.0 - 0.25 * (t - 2.0) + wave, 5.0);
    }
    let drift = watched.drift(true, 99);
    assert!((drift.slope + 0.25).abs() < 1e-4, "{drift:?}");
    assert!((drift.at_end - 0.25 * 9.9).abs() < 2e-3 && drift.max >= drift.at_end);
    assert!(drift.breaks_a_promise() && !Drift { promised: false, ..drift }.breaks_a_promise());
    let still = Watched::new(0.0, energy(), 1.0, 1.0).drift(true, 0);
    assert_eq!((still.max, still.slope, still.breaks_a_promise()), (0.0, 0.0, false));
}

#[test]
fn what_is_not_a_number_is_no_promise_kept() {
    let mut watched = Watched::new(0.0, energy(), 1.0, 1.0);
    watched.see(1.0, f64::NAN, 1.0);
    watched.see(2.0, 1.0, 1.0);
    assert!(watched.drift(true, 2).breaks_a_promise());
}

/// Rows within steps of a Gauss method are of a lower order, and do not keep what its steps keep: the program says so.
/// Rows at the ends of steps, by shorter steps or not, do.
#[test]
fn a_drift_of_rows_within_steps_is_a_warning() {
    let folder = Folder::new();
    let run = |output: &str| {
        let scene = format!(
            "title = \"Drift\"\n[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\n\
             omega_body = [0.1, 1, 0.1]\n[method]\nname = \"gauss4\"\n[time]\nt_span = [0, 20]\ndt = 0.2\n\
             [output]\nquantities = [\"momentum_body\"]\n{output}"
        );
        let told = folder.run(&scene).ok();
        let warned = told.matches("WARNING: ").count();
        assert_eq!(warned, told.matches("at rows within steps, but by").count(), "{told}");
        (warned, folder.json("out/summary.json")["drift"]["energy"].clone())
    };
    let (warned, energy) = run("interval = 0.05");
    assert_eq!(warned, 2, "energy and momentum_norm");
    let [at_rows, at_ends] =
        ["max", "max_at_ends_of_steps"].map(|key| energy[key].as_f64().unwrap());
    assert!(at_rows > 1e-6 && at_ends < 1e-14, "{energy}");
    for output in ["interval = 0.05\ntimes_by = \"steps\"", "interval = 0.2", "every = 1"] {
        let (warned, energy) = run(output);
        assert!(warned == 0 && energy["max"].as_f64().unwrap() < 1e-14, "{output}: {energy}");
    }
}

/// A formula that is no invariant is told; one that is, at whatever accuracy, is not.
#[test]
fn a_formula_that_is_no_invariant_is_told() {
    let folder = Folder::new();
    let told = |invariant: &str, rtol: &str| {
        folder.write(
            "scene.toml",
            &format!(
                "[problem]\nkind = \"composed\"\ninvariants = {{ kept = \"{invariant}\" }}\n[[problem.parts]]\n\
                 name = \"q\"\nspace = \"numbers\"\nstart = [1, 0]\nfield = [\"q2\", \"-q1\"]\n\
                 [method]\nname = \"rkmk dopri5\"\n[time]\nt_span = [0, 20]\nrtol = {rtol}\natol = {rtol}\n"
            ),
        );
        folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok()
    };
    let moves = "`kept` moves by 1, 1 of its size, and the error of the run does not explain that";
    let of_one = told("q1^2", "1e-9");
    assert!(of_one.contains(moves), "{of_one}");
    // The last one is 0 but for rounding of its terms.
    for kept in ["q1^2 + q2^2", "(q1^2 + q2^2)^2 - q1^4 - q2^4 - 2*q1^2*q2^2"] {
        for rtol in ["1e-3", "1e-9"] {
            let of_both = told(kept, rtol);
            assert!(!of_both.contains("no constant of this motion"), "{of_both}");
        }
    }
}
