//! Scenes with formulas: against the same stated by keys, closed forms, and what is refused.

use faer::Mat;
use lieflow::CoordinateMap;
use lieflow::catalog::MethodSpec;
use lieflow::groups::{LieGroup, MatrixGroup};
use lieflow::maps::Exp;

use lieflow_model::problem::Rows;

use super::*;

pub(super) const FINE: &str = "t_span = [0, 2]\ndt = 0.005";
pub(super) const RKMK4: &str = "name = \"rkmk4\"";

/// The line and the message of a scene that is refused.
pub(super) fn refused(problem: &str, time: &str, quantity: &str) -> (usize, String) {
    let text = format!(
        "title = \"Test\"\n[problem]\n{problem}\n[method]\nname = \"rk4\"\n[time]\n{time}\n[output]\n\
         quantities = [\"{quantity}\"]\n"
    );
    let error = Scene::parse("scene", &text).unwrap_err();
    (error.line().unwrap(), error.to_string())
}

const BODY: &str = "kind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0.5, 0.4, -0.8]\n\
                    attitude = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]";

/// 400 steps, each of some hundred roundings that this motion does not amplify.
pub(super) const SAME: f64 = 1e3 * f64::EPSILON;

#[test]
fn torques_as_keys_and_as_formulas_are_the_same() {
    let run = |more: &str| {
        last(&scene(&format!("{BODY}\n{more}"), RKMK4, FINE, "[\"attitude\", \"momentum_space\"]"))
    };
    for (keys, formulas) in [
        ("damping = 0.3", "torque = [\"-c*w1\", \"-c*w2\", \"-c*w3\"]\nparameters = { c = 0.3 }"),
        ("thruster = [0.1, 0.2, -1]", "torque = [\"1/10\", \"2e-1\", \"-1\"]"),
        (
            "control = [3, 4]",
            "torque = [\"-3*(g32 - g23)/2 - 4*w1\", \"-3*(g13 - g31)/2 - 4*w2\", \
             \"-3*(g21 - g12)/2 - 4*w3\"]",
        ),
        (
            "weight = [0.2, -0.1, 0.9]",
            "torque_space = [\"-(0.2*g21 - 0.1*g22 + 0.9*g23)\", \"0.2*g11 - 0.1*g12 + 0.9*g13\", \"0\"]",
        ),
        // All at once: gravity in space, the rest in the body; mω = (gᵀm)/J restates the damping.
        (
            "damping = 0.3\nthruster = [0, 0, 1]\nweight = [0, 0, 0.5]",
            "torque = [\"-0.3*(g11*m1 + g21*m2 + g31*m3)\", \"-0.3*(g12*m1 + g22*m2 + g32*m3)/2\", \
             \"1 - 0.3*(g13*m1 + g23*m2 + g33*m3)/2.5\"]\n\
             torque_space = [\"-0.5*g23\", \"0.5*g13\", \"0\"]",
        ),
    ] {
        let apart = far(&run(keys), &run(formulas));
        assert!(apart < SAME, "{keys}: {apart:e}");
    }
}

/// A motor about the third axis with the torque cos t: Jω = Jω₀ + sin t.
#[test]
fn a_torque_that_varies_in_time() {
    let motor = "kind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0, 0, 0.3]\n\
                 torque = [\"0\", \"0\", \"cos(t)\"]";
    let of = scene(motor, RKMK4, "t_span = [1, 3]\ndt = 0.005", "[\"omega_body\", \"angle\"]");
    let rate = |t: f64| 0.3 + (t.sin() - 1f64.sin()) / 2.5;
    let angle = (0.3 - 1f64.sin() / 2.5) * 2.0 - (3f64.cos() - 1f64.cos()) / 2.5;
    assert!(far(&last(&of), &[0.0, 0.0, rate(3.0), angle]) < 1e-10);
    assert!(of.model().unwrap().modelled(&of.method)[0].ends_with("torques: formulas in the body"));
    // Nothing keeps the energy.
    assert!(of.problem.invariants(&[]).iter().all(|law| *law == "attitude_defect"));
}

/// A run ends where a formula has no value any more; the rows before are there.
#[test]
fn a_run_ends_where_a_formula_has_no_value() {
    let body = format!("{BODY}\ntorque = [\"sqrt(1 - t)\", \"0\", \"0\"]");
    let of = scene(&body, RKMK4, "t_span = [0, 2]\ndt = 0.125", "[\"axis\"]");
    let mut times = Vec::new();
    let mut sink = |t: f64, _: Row<'_>| times.push(t);
    let ended = of.model().unwrap().run(&of.method, &of.grid, &of.save, &mut sink);
    assert!(ended.is_err_and(|error| error.to_string().contains("not finite")));
    assert_eq!(times.last(), Some(&1.0));
}

#[test]
fn formulas_are_refused_at_their_line() {
    let torque = |texts: &str| format!("{BODY}\ntorque = {texts}");
    for (texts, time, expected) in [
        (
            "[\"w1\", \"w4\", \"0\"]",
            FINE,
            &["torque[2]: unknown name `w4` at character 1", "`w", "[problem.parameters]"][..],
        ),
        ("[\"w1\", \"0\", \"2 w1\"]", FINE, &["torque[3]: found `w`", "2*w1"]),
        ("[\"w1\", \"0\"]", FINE, &["found 2 formulas, expected 3"]),
        ("[\"w1\", \"0\", true]", FINE, &["found true, expected a formula: a text or a number"]),
        ("[\"0\", \"1/t\", \"0\"]", FINE, &["torque[2] is inf at the start"]),
        ("[\"k\", \"0\", \"0\"]\nparameters = { c = 1 }", FINE, &["unknown name `k`", "c, pi, e"]),
    ] {
        let (line, message) = refused(&torque(texts), time, "axis");
        assert_eq!(line, 7, "{message}");
        expected.iter().for_each(|part| assert!(message.contains(part), "{message}"));
    }
    let parameters = format!("{}\nparameters = {{ w1 = 3 }}", torque("[\"w1\", \"0\", \"0\"]"));
    let (line, message) = refused(&parameters, FINE, "axis");
    assert!(line == 8 && message.contains("`w1` is the name of a variable"), "{message}");
    // The start is where the scene starts.
    let late = scene(
        &torque("[\"0\", \"1/t\", \"0\"]"),
        RKMK4,
        "t_span = [1, 2]\ndt = 0.01",
        "[\"axis\"]",
    );
    assert!(last(&late).iter().all(|x| x.is_finite()));
}

/// exp of an element of so(n).
fn exp(u: Mat<f64>) -> Mat<f64> {
    let group = MatrixGroup::so(u.nrows()).unwrap();
    let u = group.algebra(u).unwrap();
    let (mut at, mut g) = (Exp.at(&group).unwrap(), group.identity());
    Exp.psi(&group, &u, &mut at, &mut g).unwrap();
    g.into_mat()
}

/// In the frame that turns with the drive the field is constant: y = e^{tB} e^{t(A − B)}.
#[test]
fn a_rotation_that_is_driven() {
    let of = Scene::bundled("rotating-drive").unwrap();
    let (a, b, c, w, t) = (1.0, 0.7, 0.4, 2.0, 20.0);
    let skew = |entries: &[(usize, usize, f64)]| {
        let mut u = Mat::zeros(5, 5);
        for &(i, j, x) in entries {
            (u[(i, j)], u[(j, i)]) = (t * x, -t * x);
        }
        u
    };
    let turn = exp(skew(&[(1, 0, w)]));
    let exact = turn * exp(skew(&[(0, 2, a), (2, 3, b), (3, 4, c), (1, 0, -w)]));
    let exact: Vec<f64> = (0..25).map(|k| exact[(k / 5, k % 5)]).collect();
    let end = last(&of);
    assert!(far(&end[..25], &exact) < 1e-8, "{:e}", far(&end[..25], &exact));
    assert!(end[25] < 1e-13);
    // With the order of the method, and with a method that is not for linear equations.
    for (method, order) in [("magnus6", 6.0), ("magnus4", 4.0), ("rkmk4", 4.0), ("cf4", 4.0)] {
        let error = |dt: &str| {
            let text = bundled("rotating-drive").replace("dt = 0.05", &format!("dt = {dt}"));
            let text = text.replace("\"magnus6\"", &format!("\"{method}\""));
            far(&last(&Scene::parse("scene", &text).unwrap())[..25], &exact)
        };
        let slope = (error("0.2") / error("0.1")).log2();
        assert!((slope - order).abs() < 0.5, "{method}: {slope}");
    }
}

/// The flow that sorts, the learning of a plane and Euler's equations as equations of one's own.
#[test]
fn kinds_of_flows_as_equations_of_ones_own() {
    let time = "t_span = [0, 1]\ndt = 0.01";
    let ode = |group: &str, action: &str, field: &str, more: &str| {
        let problem = format!(
            "kind = \"matrix-ode\"\ngroup = \"{group}\"\naction = \"{action}\"\nfield = {field}\n{more}"
        );
        let of = scene(&problem, RKMK4, time, "[\"point\"]");
        let rk = MethodSpec { tableau: Some("dop853".into()), ..MethodSpec::new("rk", None) };
        let mut by_rk = Vec::new();
        let mut sink = |_: f64, row: Row<'_>| by_rk = row.values().to_vec();
        of.model().unwrap().run(&rk, &of.grid, &of.save, &mut sink).unwrap();
        let end = last(&of);
        assert!(far(&end, &by_rk) < 1e-6, "{field}: the field and the action disagree");
        end
    };
    // f = [N, L].
    let matrix = "[[2, 0.5, -0.3], [0.5, 1, 0.4], [-0.3, 0.4, 3]]";
    let bracket: Vec<Vec<String>> =
        (1..=3).map(|i| (1..=3).map(|j| format!("({i} - {j})*y{i}{j}")).collect()).collect();
    let ours = ode("so", "conjugation", &format!("{bracket:?}"), &format!("start = {matrix}"));
    let sorting = format!("kind = \"double-bracket\"\nmatrix = {matrix}\norder = [1, 2, 3]");
    let theirs = last(&scene(&sorting, RKMK4, time, "[\"matrix\"]"));
    let upper = [ours[0], ours[1], ours[2], ours[4], ours[5], ours[8]];
    assert!(far(&upper, &theirs) < SAME);
    // Oja on the sphere, f = A x xᵀ − x xᵀ A with A diagonal: x(t) = e^{tA}x/|e^{tA}x|.
    let oja: Vec<Vec<String>> =
        (1..=3).map(|i| (1..=3).map(|j| format!("({i} - {j})*y{i}1*y{j}1")).collect()).collect();
    let end = ode("so", "linear", &format!("{oja:?}"), "start = [[0.6], [0.48], [0.64]]");
    let grown: Vec<f64> =
        [0.6, 0.48, 0.64].iter().zip(1..).map(|(x, a)| x * f64::from(a).exp()).collect();
    let norm = grown.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(far(&end, &grown.iter().map(|x| x / norm).collect::<Vec<_>>()) < 1e-7);
    // Euler's equations: f = −∇H by the coadjoint action.
    let momentum = "[[0.2, 0.1, -0.3], [-0.2, 0.1, 0.2], [0.3, -0.1, -0.3]]";
    let weights = [[0.4, 0.7, 1.0], [0.6, 0.9, 0.5], [0.8, 0.3, 0.6]];
    let trace = "(0.4*y11 + 0.9*y22 + 0.6*y33)/3";
    let field: Vec<Vec<String>> = (0..3)
        .map(|i| {
            let part = |j: usize| if i == j { trace } else { "0" };
            (0..3).map(|j| format!("{} - {}*y{}{}", part(j), weights[i][j], i + 1, j + 1)).collect()
        })
        .collect();
    let ours = ode("sl", "coadjoint", &format!("{field:?}"), &format!("start = {momentum}"));
    let euler = format!(
        "kind = \"euler\"\nalgebra = \"sl\"\nmomentum = {momentum}\ninverse_inertia = {weights:?}"
    );
    assert!(far(&ours, &last(&scene(&euler, RKMK4, time, "[\"momentum\"]"))) < SAME);
    // A Riccati equation, f = [−Dᵀ B; C D].
    let riccati = "[[\"0\", \"0\", \"-1\", \"0\"], [\"-0.2\", \"0\", \"0\", \"-1\"], [\"1\", \"0\", \"0\", \"0.2\"], \
                   [\"0\", \"0.5\", \"0\", \"0\"]]";
    let ours = ode("sp", "lagrangian", riccati, "start = [[0, 0], [0, 0]]");
    let keys = "kind = \"riccati\"\nc = [[1, 0], [0, 0.5]]\nd = [[0, 0.2], [0, 0]]\n\
                b = [[-1, 0], [0, -1]]\np = [[0, 0], [0, 0]]";
    let theirs = last(&scene(keys, RKMK4, time, "[\"p\"]"));
    assert!(far(&[ours[0], ours[1], ours[3]], &theirs) < SAME);
    // Translation on Sp(2): an oscillator whose stiffness depends on where the first column is.
    let pendulum = "[[\"0\", \"1\"], [\"-sinc\", \"0\"]]".replace("sinc", "y11^2");
    let end = ode("sp", "translation", &pendulum, "");
    assert!((end[0] * end[3] - end[1] * end[2] - 1.0).abs() < 1e-14);
    // ẍ = −x³ from 1 at rest: ½ẋ² + ¼x⁴ is kept.
    assert!((0.5 * end[2] * end[2] + 0.25 * end[0].powi(4) - 0.25).abs() < 1e-8);
    // The Lorentz group: a boost at a rate that grows.
    let boost = ode("so(1,1)", "translation", "[[\"0\", \"2*t\"], [\"2*t\", \"0\"]]", "");
    assert!(far(&boost, &[1f64.cosh(), 1f64.sinh(), 1f64.sinh(), 1f64.cosh()]) < 1e-8);
}

#[test]
fn equations_that_are_none_are_refused_at_their_line() {
    for (keys, line, expected) in [
        (
            "group = \"so\"\nfield = [[\"0\", \"1\"], [\"1\", \"0\"]]",
            5,
            &["field[", "the field is not in so(2)"][..],
        ),
        (
            "group = \"so\"\nfield = [[\"0\", \"y12\"], [\"-y12\", \"y12\"]]",
            5,
            &["field[2,2]", "beside the start"],
        ),
        (
            "group = \"so\"\nfield = [[\"t\", \"1\"], [\"-1\", \"0\"]]",
            5,
            &["beside the start field[1,1] is 0.5, expected 0"],
        ),
        ("group = \"sl\"\nfield = [[\"1\", \"1\"], [\"1\", \"0\"]]", 5, &["is not in sl(2)"]),
        (
            "group = \"so\"\nfield = [[\"0\", \"1e308\"], [\"1.7e308\", \"0\"]]",
            5,
            &["field[1,2] is 1e308 and field[2,1] is 1.7e308, expected field[2,1] = -field[1,2]"],
        ),
        (
            "group = \"so\"\nfield = [[\"0\", \"1/t\"], [\"-1/t\", \"0\"]]",
            5,
            &["field[1,2] is inf at the start"],
        ),
        (
            "group = \"so\"\nfield = [[\"0\", \"x\"], [\"-1\", \"0\"]]",
            5,
            &["field[1,2]: unknown name `x`", "y11"],
        ),
        (
            "group = \"so\"\nfield = [[\"0\", \"1\"], [\"-1\"]]",
            5,
            &["row 2 has 1 formula, expected 2"],
        ),
        ("group = \"so\"\nfield = []", 5, &["found 0 rows"]),
        ("field = [[\"0\"]]\ngroup = \"ru\"", 5, &["unknown group `ru`", "su"]),
        ("field = [[\"0\"]]\ngroup = \"sp\"", 4, &["even"]),
        ("field = [[\"0\"]]\ngroup = \"so(2,1)\"", 4, &["p + q = 1"]),
        (
            "field = [[\"0\"]]\ngroup = \"so\"\naction = \"rotation\"",
            6,
            &["unknown action", "translation"],
        ),
        ("field = [[\"0\"]]\ngroup = \"so\"\nstart = [[2]]", 6, &["start"]),
        ("field = [[\"0\"]]\ngroup = \"sl\"\nstart = [[1, 2]]", 6, &["expected 1 rows of 1"]),
        ("field = [[\"0\"]]\ngroup = \"so\"\naction = \"lagrangian\"", 6, &["an action of sp"]),
        (
            "field = [[\"0\", \"1\"], [\"1\", \"0\"]]\ngroup = \"sp\"\naction = \"lagrangian\"\nstart = [[0, 1], [0, 0]]",
            7,
            &["expected 1 rows of 1"],
        ),
        ("field = [[\"0\"]]\ngroup = \"sl\"\nstart = [[2]]", 6, &["determinant is 2"]),
        ("field = [[\"0\"]]\ngroup = \"so\"\naction = \"linear\"", 2, &["missing key `start`"]),
    ] {
        let (at, message) = refused(&format!("kind = \"matrix-ode\"\n{keys}"), FINE, "point");
        assert!(expected.iter().all(|part| message.contains(part)), "{message}");
        assert_eq!(at, line, "{message}");
    }
    let problem = "kind = \"matrix-ode\"\ngroup = \"gl\"\nfield = [[\"1\"]]";
    let (_, message) = refused(problem, FINE, "group_defect");
    let why =
        "this problem has no `group_defect`: it is for translation on so, sp, so(p,q), u and su";
    assert!(message.contains(why), "{message}");
}

/// A field of many coordinates, each with a few others, is derived at once; one that would take millions of
/// operations is refused at once.
#[test]
fn fields_of_many_coordinates() {
    let (n, start) = (128, vec![0.5; 128]);
    let ring: Vec<_> = (0..n)
        .map(|i| {
            let at = |by: usize| format!("x{}", (i + by) % n + 1);
            format!("({} - {})*{} - {} + 8", at(1), at(n - 2), at(n - 1), at(0))
        })
        .collect();
    let text = |field: &[String]| format!("kind = \"lyapunov\"\nx = {start:?}\nfield = {field:?}");
    let of = scene(&text(&ring), RKMK4, "t_span = [0, 0.02]\ndt = 0.01", "[\"x\", \"growth\"]");
    let end = last(&of);
    // All coordinates are one: ẋ = 8 − x; the trace of the Jacobian is −n.
    let x = 8.0 - 7.5 * (-0.02f64).exp();
    assert!(end[..n].iter().all(|y| (y - x).abs() < 1e-9), "{:?} {x}", end[0]);
    assert!((end[n..].iter().sum::<f64>() + 0.02 * n as f64).abs() < 1e-8);
    let sum = (1..=n).map(|i| format!("x{i}^3")).collect::<Vec<_>>().join(" + ");
    let (line, message) = refused(&text(&vec![sum; n]), FINE, "x");
    assert!(line == 5 && message.contains("derivatives take more than"), "{message}");
}

/// A run that ends by a formula names it, with its text and the point: of a body, of matrices, of parts, of energies, of
/// an event, and through named formulas.
#[test]
fn a_formula_that_loses_its_value_is_named() {
    let lost = |problem: &str, rest: &str| {
        let text = format!("[problem]\n{problem}\n[time]\nt_span = [0, 2]\n{rest}");
        let scene = Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"));
        scene.forget_losses();
        let model = scene.model_with(scene.layer, &scene.computed()).unwrap();
        let plan = scene.plan(model.schema()).unwrap();
        let error = model.drive(&scene.method, plan, &mut Rows(&mut |_, _| {})).unwrap_err();
        let lost = scene.lost(&error).unwrap_or_else(|| panic!("{error}")).to_string();
        let (what, at) = lost.split_once(" at ").unwrap();
        let mut numbers = at.split(", ").map(|at| at.split_once(" = ").unwrap());
        let (name, first) = numbers.next().unwrap();
        (what.to_owned(), name.to_owned(), first.parse::<f64>().unwrap(), at.to_owned())
    };
    let fixed = "dt = 0.1\n[method]\nname = \"rkmk4\"\n";
    let body = "kind = \"driven-body\"\ninertia = [1, 2, 3]\nomega_body = [1, 0.1, 0]\n";
    let torque = "torque = [\"0\", \"sqrt(1 - t)\", \"w1*sqrt(1 - t)\"]";
    let (what, name, t, at) = lost(&format!("{body}{torque}"), fixed);
    assert_eq!(
        (&*what, &*name, &*at),
        ("torque[2] = sqrt(1 - t) is NaN", "t", &*format!("t = {t}"))
    );
    assert!((t - 1.05).abs() < 1e-12, "{t}");
    // By steps of their own size it is found to the digit.
    let (what, _, t, _) = lost(&format!("{body}{torque}"), "rtol = 1e-8\n");
    assert!(what.starts_with("torque[2] =") && (1.0..1.0 + 1e-9).contains(&t), "{what} {t}");
    // The first named formula, also through others, with its own variables.
    let lets = "torque = \"cross(c, w)\"\n[problem.let]\na = \"t\"\nb = [1, \"ln(1.52 - t)\", \"w2\"]\nc = \"a*b\"";
    let (what, _, t, at) = lost(&format!("{body}{lets}"), fixed);
    assert_eq!(what, "let.b[2] = ln(1.52 - t), which torque needs, is NaN");
    assert!((t - 1.55).abs() < 1e-12 && !at.contains("w2"), "{at}");

    let matrix = "kind = \"matrix-ode\"\ngroup = \"so\"\nfield = [\"1/(1 - t)\", \"0\", \"y11\"]";
    let (what, _, t, _) = lost(matrix, "dt = 0.25\n[method]\nname = \"rkmk4\"\n");
    assert_eq!((&*what, t), ("field[1] = 1/(1 - t) is inf", 1.0));
    let parts = "kind = \"composed\"\n[[problem.parts]]\nname = \"x\"\nspace = \"numbers\"\nstart = [1]\n\
                 field = [\"-1\"]\n[[problem.parts]]\nname = \"y\"\nspace = \"numbers\"\nstart = [0]\n\
                 field = [\"sqrt(x)\"]";
    let (what, name, x, _) = lost(parts, fixed);
    assert_eq!((&*what, &*name), ("parts[2].field[1] = sqrt(x) is NaN", "x"));
    assert!(x < 0.0 && x > -0.1, "{x}");
    let energy = "kind = \"euler\"\nalgebra = \"so3\"\nmomentum = [1, 0, 0]\nhamiltonian = \"m3 + sqrt(m1)\"";
    let (what, name, m1, _) = lost(energy, fixed);
    assert_eq!(
        (&*what, &*name),
        ("the derivative by m1 of hamiltonian = m3 + sqrt(m1) is NaN", "m1")
    );
    assert!(m1 < 0.0, "{m1}");
    let exponents = "kind = \"lyapunov\"\nx = [1]\nfield = [\"-1 + 0*sqrt(x1)\"]";
    let (what, ..) = lost(exponents, fixed);
    assert!(what.contains("field[1] = -1 + 0*sqrt(x1)"), "{what}");

    let event = "[[events]]\nname = \"late\"\nwhen = \"e1 - 2\"\n[output.formulas]\ne1 = \"sqrt(1.5 - t)\"\n";
    let (what, _, t, _) = lost(body.trim_end(), &format!("{fixed}{event}"));
    assert_eq!(what, "formulas.e1 = sqrt(1.5 - t), which events[1].when needs, is NaN");
    assert!(t > 1.5 && t < 1.7, "{t}");
}
