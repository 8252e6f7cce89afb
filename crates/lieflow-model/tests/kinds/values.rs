//! Problems as values: runs that are taken step by step, and curves as numbers.

use lieflow::catalog::MethodSpec;
use lieflow::{SaveAt, StepControl, TimeGrid};
use lieflow_model::kinds::own::{Formulas, Frame, GroupName, Own, Space};
use lieflow_model::problem::{CurvePlace, Model, Plan, Rows, StepByStep, Steps};
use lieflow_model::reader::Tree;

use super::*;

/// A model of a bundled scene, with its quantities.
fn model_of(name: &str) -> (Model, MethodSpec) {
    let scene = Scene::bundled(name).unwrap();
    let layer = scene.problem.layers()[0];
    let quantities: Vec<&str> = scene.problem.default_state().to_vec();
    (scene.problem.model(layer, &quantities).unwrap(), "rkmk dop853 exp".parse().unwrap())
}

const NAMES: [&str; 4] = ["flipping-book", "ellipsoid-in-fluid", "spin-and-oscillator", "mathieu"];

fn steps(t: f64) -> Steps {
    Steps::Equal(TimeGrid::with_steps([0.0, t], 20).unwrap())
}

/// A run that is taken step by step has the rows of a run at once, also from a saved state and from its numbers.
#[test]
fn a_stepper_has_the_rows_of_a_run() {
    for name in NAMES {
        let (model, method) = model_of(name);
        let mut rows = Vec::new();
        let mut keep = |_: f64, row: Row<'_>| rows = row.values().to_vec();
        model.drive(&method, Plan::new(steps(1.0), SaveAt::End), &mut Rows(&mut keep)).unwrap();

        let mut run = model.stepper(&method, None, steps(1.0)).unwrap();
        run.advance_to(0.5).unwrap();
        let (saved, state) = (run.save(), run.state());
        let mut values = Vec::new();
        run.advance_to(1.0).unwrap();
        run.row(&mut values);
        assert_eq!(values, rows, "{name}");
        assert_eq!(run.stats().accepted, 20, "{name}");

        let mut other = model.stepper(&method, None, steps(1.0)).unwrap();
        other.restore(&saved).unwrap();
        assert_eq!((other.t(), other.state()), (0.5, state.clone()), "{name}");
        other.advance_to(1.0).unwrap();
        values.clear();
        other.row(&mut values);
        assert_eq!(values, rows, "{name}");

        let stops = StepByStep { stops: vec![0.123].into(), ..steps(1.0).into() };
        let mut stopped = model.stepper(&method, None, stops).unwrap();
        let ends: Vec<f64> = (0..4).map(|_| stopped.step().unwrap()).collect();
        assert!(ends.contains(&0.123), "{name}: {ends:?}");

        let short = model.stepper(&method, Some(&state[1..]), steps(1.0));
        assert!(short.is_err(), "{name}");
        assert!(run.set_state(&vec![f64::NAN; state.len()]).is_err(), "{name}");
    }
}

/// A curve that is made again from its numbers gives the same rows.
#[test]
fn a_curve_is_made_again_from_its_numbers() {
    for name in NAMES {
        let (model, method) = model_of(name);
        let mut curve = None;
        let plan =
            Plan { curve: Some(CurvePlace(&mut curve)), ..Plan::new(steps(1.0), SaveAt::End) };
        let mut width = 0;
        model.drive(&method, plan, &mut Rows(&mut |_, row| width = row.values().len())).unwrap();
        let curve = curve.unwrap();
        let again = model.curve(&method, &curve.numbers()).unwrap();
        let (times, mut a, mut b) = ([0.9, 0.033, 0.5], Vec::new(), Vec::new());
        curve.rows(&times, &mut a).unwrap();
        again.rows(&times, &mut b).unwrap();
        assert_eq!((a.len(), &a), (3 * width, &b), "{name}");
        assert!(model.curve(&method, &curve.numbers()[1..]).is_err(), "{name}");
    }
}

/// Matrices and rotations have their shape; other quantities that of their columns.
#[test]
fn quantities_have_shapes() {
    let shape = |scene: &str, quantity: &str| {
        let scene = Scene::bundled(scene).unwrap();
        let model = scene.problem.model(scene.problem.layers()[0], &[quantity]).unwrap();
        model.schema().get(quantity).unwrap().shape.clone()
    };
    assert_eq!(shape("flipping-book", "attitude"), [3, 3]);
    assert_eq!(shape("flipping-book", "momentum_body"), [3]);
    assert_eq!(shape("flipping-book", "energy"), []);
    assert_eq!(shape("coupled-oscillators", "map"), [4, 4]);
}

/// y at the end of a run from 0 to 1.
fn end_of(own: &Own, method: &str, start: &[f64]) -> Vec<f64> {
    let plan = Plan::new(steps(1.0), SaveAt::End);
    let method = method.parse().unwrap();
    own.run(&method, start, plan, &mut Rows(&mut |_, _| {})).unwrap().state
}

/// Formulas on parts are the equations of a composed system, and their samples bound a run.
#[test]
fn formulas_on_parts_are_a_composed_system() {
    let space = Space::new(&GroupName::Parts([1, 0, 2]), "translation", None, &[5]).unwrap();
    let variables = ["s1", "s2", "s3", "q", "p"].map(String::from);
    let field =
        Tree::from([Tree::from(["k*q", "-k*p", "w"]), Tree::from(["w*p - k*s2", "-w*q - k*s1"])]);
    let keys = [("field", field), ("parameters", Tree::table([("w", 3.0), ("k", 0.5)]))];
    let formulas = Formulas::read(&variables, &[3, 2], &Tree::table(keys)).unwrap();
    assert!(formulas.depends_on_y() && formulas.samples().is_none());
    let own = space.problem(formulas.field(), false).unwrap();
    let method: MethodSpec = "rkmk dop853 exp".parse().unwrap();
    let end = end_of(&own, "rkmk dop853 exp", &[0.0, 0.0, -1.0, 1.9, 0.0]);

    let (model, _) = model_of("spin-and-oscillator");
    let mut run = model.stepper(&method, None, steps(1.0)).unwrap();
    run.advance_to(1.0).unwrap();
    let mut rows = Vec::new();
    run.row(&mut rows);
    let far = end.iter().zip(&rows).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far < 1e-14, "{end:?} {rows:?}");

    let unknown = Tree::table([("field", Tree::from([Tree::from(["z", "0", "0"])]))]);
    let mistakes = Formulas::read(&variables, &[3], &unknown).unwrap_err();
    assert_eq!(mistakes.0[0].key.as_deref(), Some("field[1][1]"));
}

/// An error in 𝔤 is weighed by what it moves: Ṗ = −b(t)P² with a small b and a large P, as in `tests/driver/weights.rs`.
#[test]
fn a_lagrangian_subspace_has_the_digits_of_its_tolerance() {
    let space = Space::new(&GroupName::Named("Sp(2)".into()), "lagrangian", None, &[1, 1]).unwrap();
    let field = |t: f64, _: &[f64], v: &mut [f64]| {
        v[1] = 1e-6 * (1.0 + (20.0 * t).cos());
        true
    };
    let own = space.problem(std::sync::Arc::new(field), false).unwrap();
    let steps =
        Steps::ByError { control: StepControl::new(1e-6, 1e-9).unwrap(), t_span: [0.0, 2.0] };
    let method = "rkmk dopri5 exp".parse().unwrap();
    let plan = Plan::new(steps, SaveAt::End);
    let end = own.run(&method, &[1e6], plan, &mut Rows(&mut |_, _| {})).unwrap().state[0];
    let exact = 1e6 / (3.0 + 40f64.sin() / 20.0);
    assert!((end / exact - 1.0).abs() < 1e-6, "{end:e} {exact:e}");
}

/// A pose whose last row is no [0 0 0 1] is a transposed one.
#[test]
fn the_last_row_of_a_pose_is_checked() {
    let space =
        Space::new(&GroupName::Named("SE(3)".into()), "translation", Some(Frame::Space), &[4, 4])
            .unwrap();
    let field = |_: f64, _: &[f64], v: &mut [f64]| {
        v[2] = 1.0;
        true
    };
    let own = space.problem(std::sync::Arc::new(field), false).unwrap();
    let method = "rkmk dop853 exp".parse().unwrap();
    let mut start = vec![0.0; 16];
    (0..4).for_each(|i| start[5 * i] = 1.0);
    start[13] = 2.0;
    let plan = || Plan::new(steps(1.0), SaveAt::End);
    let refused = own.run(&method, &start, plan(), &mut Rows(&mut |_, _| {})).unwrap_err();
    assert!(refused.to_string().contains("y[3, 1]"), "{refused}");
    start[13] = 0.0;
    own.run(&method, &start, plan(), &mut Rows(&mut |_, _| {})).unwrap();
}

/// A state, a density matrix and a propagator of U(2) under one H are one motion, that of the closed form.
#[test]
fn complex_spaces_are_one_motion() {
    let run = |action: &str, frame: Option<Frame>, shape: &[usize], start: &[f64]| {
        let space = Space::new(&GroupName::Named("U(2)".into()), action, frame, shape).unwrap();
        assert_eq!(space.value(), [2, 2, 2]);
        // −iH with H = ½(0.6 σ_x + 0.8 σ_y + 0.2·𝟙): off the diagonal −0.3i ∓ 0.4.
        let field = |_: f64, _: &[f64], v: &mut [f64]| {
            v.copy_from_slice(&[0.0, -0.1, -0.4, -0.3, 0.4, -0.3, 0.0, -0.1]);
            true
        };
        let own = space.problem(std::sync::Arc::new(field), false).unwrap();
        end_of(&own, "rkmk dop853 exp", start)
    };
    // exp(−iHt) at t = 1: (cos ½ 𝟙 − i sin ½ n·σ) e^{−0.1i}.
    let ((s, c), (ps, pc)) = (0.5_f64.sin_cos(), 0.1_f64.sin_cos());
    let turned = |re: f64, im: f64| [re * pc + im * ps, im * pc - re * ps];
    let (diagonal, above, below) =
        (turned(c, 0.0), turned(-0.8 * s, -0.6 * s), turned(0.8 * s, -0.6 * s));
    let g: Vec<f64> = [diagonal, above, below, diagonal].concat();
    let near = |a: &[f64], b: &[f64], what: &str| {
        let far = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(a.len() == b.len() && far < 1e-13, "{what}: {a:?}, {b:?}");
    };
    let one = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    for frame in [Frame::Space, Frame::Body] {
        near(&run("translation", Some(frame), &[2, 2, 2], &one), &g, "g");
    }
    // The first column, as a vector and as a matrix of one column.
    let psi = [diagonal, below].concat();
    near(&run("linear", None, &[2, 2], &[1.0, 0.0, 0.0, 0.0]), &psi, "ψ");
    near(&run("linear", None, &[2, 1, 2], &[1.0, 0.0, 0.0, 0.0]), &psi, "ψ as a matrix");
    // ρ = ψψ†.
    let product = |a: &[f64], b: &[f64]| [a[0] * b[0] + a[1] * b[1], a[1] * b[0] - a[0] * b[1]];
    let (a, b) = (&psi[..2], &psi[2..]);
    let rho = [product(a, a), product(a, b), product(b, a), product(b, b)].concat();
    let start = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    near(&run("conjugation", None, &[2, 2, 2], &start), &rho, "ρ");

    let refused = |action: &str, shape: &[usize], argument: &str| {
        let frame = (action == "translation").then_some(Frame::Space);
        let misfit =
            Space::new(&GroupName::Named("SU(2)".into()), action, frame, shape).unwrap_err();
        assert_eq!(misfit.argument, argument);
    };
    refused("translation", &[3, 3, 2], "y0");
    refused("translation", &[2, 3], "y0");
    refused("lagrangian", &[1, 1, 2], "action");
}
