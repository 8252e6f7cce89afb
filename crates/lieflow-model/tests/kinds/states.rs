//! The states that a run goes on from in place of its own are on M: its start, what an event makes of it, and what the
//! caller of a run sets.

use lieflow::catalog::MethodSpec;
use lieflow::{SaveAt, TimeGrid};
use lieflow_model::problem::{EventPlan, Model, Plan, Rows, Steps};
use lieflow_model::reader::Tree;

use super::*;

/// The kinds of which every state near one is a state, as momenta of bodies.
const ANY: [&str; 6] = ["rigid-bodies", "kirchhoff", "euler", "spin", "composed", "matrix-ode"];

fn steps(t0: f64, t: f64) -> Steps {
    Steps::Equal(TimeGrid::with_steps([t0, t0 + t], 4).unwrap())
}

/// What a start of these numbers, an event that sets them and the caller of a run who sets them end with, and in words.
fn answers(model: &Model, method: &MethodSpec, t: [f64; 2], x: &[f64]) -> [Result<(), String>; 3] {
    let [t0, length] = t;
    let started = model.stepper(method, Some(x), steps(t0, length));
    let mut run = model.stepper(method, None, steps(t0, length)).unwrap();
    let set = run.set_state(x);
    let change = EventPlan {
        change: Some(Box::new(|_, numbers: &mut [f64]| numbers.copy_from_slice(x))),
        ..EventPlan::new("change", Vec::new(), |t, _| t - t0 - 0.4 * length)
    };
    let plan = Plan { events: vec![change], ..Plan::new(steps(t0, length), SaveAt::End) };
    let changed = model.drive(method, plan, &mut Rows(&mut |_, _| {}));
    [
        started.map(drop).map_err(|error| error.to_string()),
        changed.map(drop).map_err(|error| error.to_string()),
        set.map_err(|error| error.to_string()),
    ]
}

/// A model of these quantities, with its start.
fn model_of(kind: &str, keys: &[(&str, Tree)], quantities: &[&str]) -> (Model, Vec<f64>) {
    let keys = keys.iter().map(|(key, value)| (*key, value.clone()));
    let kind = lieflow_model::kinds::named(kind).unwrap();
    let problem = kind.problem(&Tree::table(keys)).unwrap_or_else(|error| panic!("{error}"));
    let quantities = if quantities.is_empty() { problem.default_state() } else { quantities };
    let model = problem.model(problem.layers()[0], quantities).unwrap();
    let start = model.start(&problem.default_method()).unwrap();
    (model, start)
}

/// Of each scene its own start is taken, and what a run of it ends at; a start beside them is not, if it is off M. A kind
/// that is new is seen.
#[test]
fn a_state_off_m_is_refused_of_every_kind() {
    for bundled in BUNDLED {
        let scene = Scene::bundled(bundled.name).unwrap();
        let (name, kind) = (bundled.name, scene.problem.kind().name);
        let model = scene.problem.model(scene.layer, scene.problem.default_state()).unwrap();
        let method = scene.problem.default_method();
        let [t0, t1] = scene.grid.t_span();
        let span = [t0, (t1 - t0).min(10.0) * 1e-3];
        let own = model.start(&method).unwrap();
        let end = Plan::new(steps(t0, span[1]), SaveAt::End);
        let end = model.drive(&method, end, &mut Rows(&mut |_, _| {})).unwrap().state;
        for state in [&own, &end] {
            for answer in answers(&model, &method, span, state) {
                assert_eq!(answer, Ok(()), "{name}");
            }
        }
        let size = own.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        let size = if size > 0.0 { size } else { 1.0 };
        let beside = |by: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let moved = |(i, x): (usize, &f64)| x + by(*x) * (1.0 + 3.0 * i as f64).sin();
            own.iter().enumerate().map(moved).collect()
        };
        // As far as a run may drift. The library has its own measure of a fluid.
        let drift = if kind == "fluid" { 1e-13 } else { 1e-9 };
        for answer in answers(&model, &method, span, &beside(&|x| drift * x)) {
            assert_eq!(answer, Ok(()), "{name}");
        }
        let [started, changed, set] = answers(&model, &method, span, &beside(&|_| 1e-3 * size));
        if ANY.contains(&kind) && started.is_ok() {
            assert_eq!((changed, set), (Ok(()), Ok(())), "{name}");
            continue;
        }
        let message = |answer: Result<(), String>| answer.expect_err(name);
        let (started, set) = (message(started), message(set));
        for message in [started, set] {
            let is_told = ["expected", "away from 0"].iter().any(|words| message.contains(words));
            assert!(is_told, "{name}: {message}");
        }
        let changed = message(changed);
        assert!(changed.contains("event `change` set at t = "), "{name}: {changed}");
        let not_finite = vec![f64::NAN; own.len()];
        assert!(answers(&model, &method, span, &not_finite).iter().all(Result::is_err), "{name}");
    }
}

/// A kind with its keys and the quantities that are asked for, the numbers of a state, and what is wrong with it.
type Case =
    (&'static str, Vec<(&'static str, Tree)>, &'static [&'static str], Vec<f64>, &'static str);

/// What is wrong is told in the words of the keys.
#[test]
fn states_off_m_are_refused_in_the_words_of_keys() {
    let rows = |rows: &[&[f64]]| Tree::List(rows.iter().map(|row| Tree::from(*row)).collect());
    let symmetric = || rows(&[&[2.0, 0.1], &[0.1, 1.0]]);
    let texts = |rows: &[[&str; 2]]| Tree::List(rows.iter().map(|row| Tree::from(*row)).collect());
    let lopsided = vec![2.0, 0.6, 0.1, 1.0];
    let cell = "y0[1, 0] = 0.6, expected a symmetric matrix, but y0[0, 1] is 0.1";
    let body = |more: Vec<(&'static str, Tree)>| {
        let inertia = ("inertia", Tree::from([1.0, 2.0, 3.0]));
        [vec![inertia, ("omega_body", Tree::from([0.3, 1.0, 0.2]))], more].concat()
    };
    let quantum = |density| {
        let hamiltonian = ("hamiltonian", texts(&[["1", "0.3"], ["0.3", "-1"]]));
        vec![hamiltonian, ("density", density)]
    };
    let mixed = || quantum(rows(&[&[0.5, 0.1], &[0.1, 0.5]]));
    // [X −Y; Y X], column by column.
    let blocks = |x: [[f64; 2]; 2], y: [[f64; 2]; 2]| -> Vec<f64> {
        let column = |j: usize, x: [[f64; 2]; 2], sign: f64| [sign * x[0][j], sign * x[1][j]];
        let left = [0, 1].map(|j| [column(j, x, 1.0), column(j, y, 1.0)].concat());
        let right = [0, 1].map(|j| [column(j, y, -1.0), column(j, x, 1.0)].concat());
        [left.concat(), right.concat()].concat()
    };
    let zero = [[0.0; 2]; 2];
    let ode = |group: &str, action: &str, field: Tree, start: Tree| {
        vec![("group", group.into()), ("action", action.into()), ("field", field), ("start", start)]
    };
    let still = || texts(&[["0", "0"], ["0", "0"]]);
    let four = {
        let row = ["0"; 4];
        Tree::List(vec![Tree::from(row); 4])
    };
    let [flat, upright] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let pendulum = || {
        vec![
            ("gravity_over_length", Tree::from(1.0)),
            ("direction", flat.into()),
            ("velocity", upright.into()),
        ]
    };
    let subspace = || {
        vec![
            ("a", rows(&[&[2.0, 0.0, 0.0], &[0.0, 1.0, 0.0], &[0.0, 0.0, 0.5]])),
            ("x", rows(&[&[1.0], &[1.0], &[0.0]])),
        ]
    };
    let diagonal = |d: [f64; 3]| vec![d[0], 0.0, 0.0, 0.0, d[1], 0.0, 0.0, 0.0, d[2]];
    let particle = || {
        vec![
            ("charge_to_mass", Tree::from(1.0)),
            ("electric", flat.into()),
            ("magnetic", upright.into()),
            ("velocity", [0.0; 3].into()),
        ]
    };
    let hill = |a, b| vec![("c", symmetric()), ("b", a), ("p", b)];
    let cases: Vec<Case> = vec![
        ("toda", vec![("matrix", symmetric())], &[], lopsided.clone(), cell),
        (
            "double-bracket",
            vec![("matrix", symmetric()), ("order", [1.0, 2.0].into())],
            &[],
            lopsided.clone(),
            cell,
        ),
        ("qr-flow", vec![("matrix", symmetric())], &[], lopsided.clone(), cell),
        (
            "qr-flow",
            vec![("matrix", symmetric())],
            &[],
            vec![2.0, 0.0, 0.0, -1.0],
            "an eigenvalue of y0 = -1, expected a number > 0",
        ),
        ("riccati", hill(symmetric(), symmetric()), &[], lopsided.clone(), cell),
        ("matrix-ode", ode("sp", "lagrangian", four, symmetric()), &[], lopsided, cell),
        (
            "matrix-ode",
            ode("u", "conjugation", still(), symmetric()),
            &[],
            [blocks([[1.0, 2.0], [3.0, 4.0]], zero)[..15].to_vec(), vec![5.0]].concat(),
            "y0[3, 3] = 5, expected 4, as the real matrix [X −Y; Y X] of X + iY has",
        ),
        (
            "rigid-body-n",
            vec![("mass_moments", [1.0, 2.0].into()), ("momentum", Tree::List(vec![1.0.into()]))],
            &[],
            vec![0.0, 1.0, 1.0, 0.0],
            "y0[1, 0] = 1, expected an antisymmetric matrix, but y0[0, 1] is 1",
        ),
        (
            "rigid-body-n",
            vec![("mass_moments", [1.0, 2.0].into()), ("momentum", Tree::List(vec![1.0.into()]))],
            &[],
            vec![0.5, -1.0, 1.0, 0.0],
            "y0[0, 0] = 0.5, expected an antisymmetric matrix",
        ),
        (
            "euler",
            vec![
                ("algebra", "so".into()),
                ("momentum", rows(&[&[0.0, 1.0], &[-1.0, 0.0]])),
                ("hamiltonian", "m12^2".into()),
            ],
            &["momentum", "group"],
            vec![1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0],
            "y: not in the Lie algebra of SO(2)",
        ),
        (
            "density-matrix",
            mixed(),
            &[],
            blocks([[0.5, 0.4], [0.0, 0.5]], zero),
            "the real part of y0[1, 0] = 0, expected a Hermitian matrix, but the real part of y0[0, 1] is 0.4",
        ),
        (
            "density-matrix",
            mixed(),
            &[],
            blocks([[0.5, 0.0], [0.0, 0.5]], [[0.0, 0.2], [0.2, 0.0]]),
            "the imaginary part of y0[1, 0] = 0.2, expected a Hermitian matrix",
        ),
        (
            "density-matrix",
            mixed(),
            &[],
            blocks([[2.0, 0.0], [0.0, -1.0]], zero),
            "the least eigenvalue of y0 = -1, expected at least 0",
        ),
        (
            "density-matrix",
            mixed(),
            &[],
            blocks([[1.0, 0.0], [0.0, 1.0]], zero),
            "the trace of y0 = 2, expected 1, that of a density matrix",
        ),
        (
            "oja",
            vec![("a", symmetric()), ("x", rows(&[&[1.0], &[0.0]]))],
            &[],
            vec![2.0, 0.0],
            "the distance of y0ᵀy0 from the identity = 3, expected 0, that of orthonormal columns",
        ),
        (
            "subspace",
            subspace(),
            &[],
            diagonal([2.0, 0.0, 0.0]),
            "the distance of y0² from y0 = 2, expected 0, that of a projector",
        ),
        (
            "subspace",
            subspace(),
            &[],
            diagonal([1.0, 1.0, 0.0]),
            "the trace of y0 = 2, expected 1, the dimension of the subspace",
        ),
        (
            "lorentz",
            particle(),
            &[],
            vec![0.0, 0.0, 0.0, 2.0],
            "the square of y0 = -4, expected -1, that of a four-velocity",
        ),
        (
            "lorentz",
            particle(),
            &[],
            vec![0.0, 0.0, 0.0, -1.0],
            "gamma in y0 = -1, expected a number > 0",
        ),
        (
            "spherical-pendulum",
            pendulum(),
            &[],
            vec![0.0, 1.0, 0.0, 2.0, 0.0, 0.0],
            "the length of the direction in y0 = 2, expected 1, that of a direction",
        ),
        (
            "spherical-pendulum",
            pendulum(),
            &[],
            vec![0.5, 1.0, 0.0, 1.0, 0.0, 0.0],
            "the angular velocity along the rod in y0 = 0.5, expected 0, that of a point mass",
        ),
        (
            "spin-chain",
            vec![("spins", rows(&[&flat, &upright]))],
            &[],
            [flat, [0.0, 0.0, 0.5]].concat(),
            "the length of spin 2 in y0 = 0.5, expected 1, that of a direction",
        ),
        (
            "heavy-top",
            body(vec![("weight", upright.into()), ("vertical", upright.into())]),
            &["vertical"],
            vec![0.1, 0.2, 0.3, 0.0, 0.0, 2.0],
            "the length of the vertical in y0 = 2, expected 1, that of a direction",
        ),
    ];
    let method = "rkmk4".parse().unwrap();
    for (kind, keys, quantities, x, words) in cases {
        let (model, own) = model_of(kind, &keys, quantities);
        assert_eq!(own.len(), x.len(), "{kind}: {own:?}");
        let ok = answers(&model, &method, [0.0, 0.1], &own);
        assert!(ok.iter().all(Result::is_ok), "{kind}: {ok:?}");
        let [started, changed, set] = answers(&model, &method, [0.0, 0.1], &x);
        let (started, set) = (started.expect_err(words), set.expect_err(words));
        assert!(started.starts_with(words), "{kind}: {started}, expected {words}");
        assert!(set.starts_with(&words.replace("y0", "state")), "{kind}: {set}");
        assert!(changed.expect_err(words).contains("event `change` set at t = "), "{kind}");
    }
}

/// What a run asks of its start alone is asked of changes, too.
#[test]
fn no_change_is_a_reflection() {
    let field = Tree::List(vec![Tree::from(["0", "-1"]), Tree::from(["1", "0"])]);
    let (model, own) = model_of("matrix-ode", &[("group", "so".into()), ("field", field)], &[]);
    let method = "rkmk4".parse().unwrap();
    for (x, is_on) in [(own, true), (vec![1.0, 0.0, 0.0, -1.0], false)] {
        let answers = answers(&model, &method, [0.0, 0.1], &x);
        assert!(answers.iter().all(|answer| answer.is_ok() == is_on), "{answers:?}");
    }
}

/// The end of a run that grows and damps may be the start of the next one, however long its rows are.
#[test]
fn starts_of_gl_and_sl_may_have_rows_of_any_length() {
    let field = || Tree::List(vec![Tree::from(["1", "0"]), Tree::from(["0", "-1"])]);
    let of = |group: &str, start: [[f64; 2]; 2]| {
        let start = Tree::List(start.map(Tree::from).to_vec());
        let keys = [("group", group.into()), ("field", field()), ("start", start)];
        let kind = lieflow_model::kinds::named("matrix-ode").unwrap();
        kind.problem(&Tree::table(keys)).map(drop).map_err(|error| error.to_string())
    };
    let grown = [[(40.0f64).exp(), 0.0], [0.0, (-40.0f64).exp()]];
    for group in ["gl", "sl"] {
        assert!(of(group, grown).is_ok(), "{group}");
        let singular = of(group, [[1.0, 2.0], [2.0, 4.0]]).unwrap_err();
        assert!(singular.contains("start"), "{singular}");
    }
}

/// The forms of a rigid body whose points are matrices, or twelve numbers.
#[test]
fn states_of_bodies_are_on_m_in_every_form() {
    let scene = Scene::bundled("general-layer").unwrap();
    let general = scene.problem.model(scene.layer, &["momentum_body"]).unwrap();
    let wrong = [vec![0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0], vec![0.0; 9]];
    let method = "rkmk4".parse().unwrap();
    let [refused, ok] = wrong.map(|x| answers(&general, &method, [0.0, 0.1], &x));
    let [started, changed, set] = refused;
    assert!(started.unwrap_err().starts_with("y0[1, 0] = 1, expected an antisymmetric matrix"));
    assert!(changed.is_err() && set.is_err());
    assert!(ok.iter().all(Result::is_ok), "{ok:?}");
    // Classical methods that take the momentum and the attitude as one.
    let top = Scene::bundled("asymmetric-top").unwrap();
    let model = top.problem.model(top.layer, &["momentum_body", "attitude"]).unwrap();
    let method = "rk4-mg".parse().unwrap();
    let own = model.start(&method).unwrap();
    assert_eq!(own.len(), 12);
    let twice: Vec<f64> = own.iter().map(|x| 2.0 * x).collect();
    for (x, is_on) in [(&own, true), (&twice, false)] {
        let answers = answers(&model, &method, [0.0, 0.1], x);
        assert!(answers.iter().all(|answer| answer.is_ok() == is_on), "{answers:?}");
    }
}
