//! Problems as values: runs that are taken step by step, and curves as numbers.

use lieflow::catalog::MethodSpec;
use lieflow::{SaveAt, TimeGrid};
use lieflow_model::kinds::own::{Formulas, GroupName, OwnPlan, Space};
use lieflow_model::problem::{CurvePlace, Model, Plan, Rows, Steps};
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

        let mut run = model.stepper(&method, steps(1.0), None).unwrap();
        run.advance_to(0.5).unwrap();
        let (saved, state) = (run.save(), run.state());
        let mut values = Vec::new();
        run.advance_to(1.0).unwrap();
        run.row(&mut values);
        assert_eq!(values, rows, "{name}");
        assert_eq!(run.stats().accepted, 20, "{name}");

        let mut other = model.stepper(&method, steps(1.0), None).unwrap();
        other.restore(&saved).unwrap();
        assert_eq!((other.t(), other.state()), (0.5, state.clone()), "{name}");
        other.advance_to(1.0).unwrap();
        values.clear();
        other.row(&mut values);
        assert_eq!(values, rows, "{name}");

        assert!(model.stepper(&method, steps(1.0), Some(&state[1..])).is_err(), "{name}");
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
    let plan = OwnPlan {
        steps: steps(1.0),
        save: SaveAt::End,
        stops: Vec::new(),
        max_steps: None,
        dense: false,
        events: Vec::new(),
        progress: None,
    };
    let stop = std::sync::atomic::AtomicBool::new(false);
    let start = [0.0, 0.0, -1.0, 1.9, 0.0];
    let end = own.run(&method, &start, plan, &mut |_, _| {}, &stop).end.unwrap().y;

    let (model, _) = model_of("spin-and-oscillator");
    let mut run = model.stepper(&method, steps(1.0), None).unwrap();
    run.advance_to(1.0).unwrap();
    let mut rows = Vec::new();
    run.row(&mut rows);
    let far = end.iter().zip(&rows).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far < 1e-14, "{end:?} {rows:?}");

    let unknown = Tree::table([("field", Tree::from([Tree::from(["z", "0", "0"])]))]);
    let mistakes = Formulas::read(&variables, &[3], &unknown).unwrap_err();
    assert_eq!(mistakes.0[0].key.as_deref(), Some("field[1][1]"));
}
