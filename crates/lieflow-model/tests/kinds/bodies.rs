//! What all kinds of bodies share: their keys, their quantities, and what they say of numbers that were typed.

use core::f64::consts::PI;
use std::time::Duration;

use lieflow::solve::Next;
use lieflow_model::problem::{Plan, PrincipalInertia, Watcher};
use nalgebra::{Matrix3, Vector3};

use super::formulas::{FINE, RKMK4, refused};
use super::*;

const SHARED: &str = "[\"attitude\", \"momentum_space\", \"omega_body\", \"omega_space\", \"axis\", \
                      \"nutation\", \"quaternion\", \"energy\", \"momentum_body\"]";
const TENSOR: &str = "inertia = [[1.5, 0.2, -0.1], [0.2, 2.0, 0.3], [-0.1, 0.3, 2.5]]";

/// Without a torque a driven body and a top are the free body, whatever its keys, and their exact motion is known.
#[test]
fn a_body_without_a_torque_is_the_free_one() {
    let shape = "shape = { kind = \"box\", mass = 12, sides = [1, 2, 3] }";
    let turned = "quaternion = [0.6, 0, 0.8, 0]";
    for inertia in ["inertia = [1, 2, 2.5]", "inverse_inertia = [1, 0.5, 0.4]", TENSOR, shape] {
        for start in [
            "omega_body = [0.3, 0.5, 1]",
            "momentum_space = [1, 2, 3]",
            "omega_space = [0, 1, 0.2]",
        ] {
            let of = |kind: &str, more: &str| {
                let body = format!("kind = {kind:?}\n{inertia}\n{start}\n{turned}\n{more}");
                let of = scene(&body, RKMK4, "t_span = [1, 3]\ndt = 0.005", SHARED);
                let exact = of.model().unwrap().exact([1.0, 3.0]).unwrap().unwrap();
                (last(&of), exact)
            };
            // By a quaternion as by a matrix with w ≥ 0.
            let upright = |mut row: Vec<f64>| {
                if row[22] < 0.0 {
                    row[22..26].iter_mut().for_each(|q| *q = -*q);
                }
                row
            };
            let free = upright(of("rigid-body", "").1);
            for more in ["", "torque = [0, 0.0, \"1 - 1\"]", "weight = [0, 0, 0]"] {
                let (end, exact) = of("driven-body", more);
                let names = format!("{inertia} {start} {more}");
                assert!(far(&exact, &free) < 1e-12, "{names}: {exact:?} {free:?}");
                assert!(far(&upright(end), &exact) < 1e-7, "{names}");
            }
            let (end, exact) = of("heavy-top", "weight = [0, 0, 0]");
            let gaps = [far(&exact, &free), far(&upright(end), &exact)];
            assert!(gaps[0] < 1e-12 && gaps[1] < 1e-7, "{inertia} {start}: {gaps:?}");
        }
    }
    let driven = format!("kind = \"driven-body\"\n{TENSOR}\nomega_body = [1, 0, 0]\ndamping = 0.1");
    let of = scene(&driven, RKMK4, FINE, "[\"energy\"]");
    assert!(of.model().unwrap().exact([0.0, 2.0]).is_none());
}

/// What a run shows: its rows, the times of its event, and its states.
#[derive(Default)]
struct Shown {
    rows: Vec<Vec<f64>>,
    turns: Vec<f64>,
    states: Vec<(usize, usize, Vec<u8>)>,
}

impl Watcher for Shown {
    fn row(&mut self, t: f64, row: Row<'_>) -> Next {
        self.rows.push([&[t], row.values()].concat());
        Next::Continue
    }
    fn event(&mut self, _: usize, t: f64, _: bool, _: Row<'_>) {
        self.turns.push(t);
    }
    fn state(&mut self, bytes: &[u8]) {
        self.states.push((self.rows.len(), self.turns.len(), bytes.to_vec()));
    }
}

/// The quaternion of a body that turns at rate 1 is (cos t/2, 0, 0, sin t/2) at all times, not (|cos t/2|, …): rows
/// and events see it without a jump, and so does a run that goes on from a saved state.
#[test]
fn a_quaternion_has_no_jump() {
    for (kind, method) in
        [("driven-body", RKMK4), ("heavy-top", RKMK4), ("rigid-body", "name = \"exact\"")]
    {
        let weight = match kind {
            "heavy-top" => "weight = [0, 0, 0]\nquaternion = [1, 0, 0, 0]\n",
            _ => "",
        };
        let text = format!(
            "title = \"Turns\"\n[problem]\nkind = {kind:?}\n{weight}inertia = [1, 2, 3]\n\
             omega_body = [0, 0, 1]\n[method]\n{method}\n[time]\nt_span = [0, 40]\nsteps = 400\n\
             [[events]]\nname = \"turn\"\nwhen = \"qz\"\n[output]\n\
             quantities = [\"quaternion\"]\ninterval = 0.07\n"
        );
        let scene = Scene::parse("turns", &text).unwrap();
        let model = scene.model().unwrap();
        let run = |resume: Option<&Vec<u8>>| {
            let mut shown = Shown::default();
            let plan = Plan {
                checkpoints: Some(Duration::ZERO),
                resume: resume.cloned(),
                ..scene.plan(model.schema()).unwrap()
            };
            model.drive(&scene.method, plan, &mut shown).unwrap();
            shown
        };
        let whole = run(None);
        for row in &whole.rows {
            let half = 0.5 * row[0];
            assert!(far(&row[1..], &[half.cos(), 0.0, 0.0, half.sin()]) < 1e-6, "{kind}: {row:?}");
        }
        let turns: Vec<f64> = (0..7).map(|k| 2.0 * PI * f64::from(k)).collect();
        assert!(whole.turns.len() == 7 && far(&whole.turns, &turns) < 1e-5, "{:?}", whole.turns);
        for (rows, turns, state) in whole.states.iter().step_by(37) {
            let rest = run(Some(state));
            assert_eq!(
                (&rest.rows[..], &rest.turns[..]),
                (&whole.rows[*rows..], &whole.turns[*turns..])
            );
        }
    }
}

/// Steps in which a body turns many times: rows are continuous, and events see the motion that rows show.
#[test]
fn long_steps_lose_no_turn() {
    let run = |steps: &str| {
        let text = format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.1, 1, 0.2]\n[time]\n\
             t_span = [0, 200]\n{steps}\n[[events]]\nname = \"turn\"\nwhen = \"qz\"\n[[events]]\n\
             name = \"angle\"\nwhen = \"euler_zyx1 - 1\"\n[output]\n\
             quantities = [\"quaternion\", \"euler_zyx\"]\ninterval = 0.05\n"
        );
        let scene = Scene::parse("turns", &text).unwrap();
        let model = scene.model().unwrap();
        let mut shown = Shown::default();
        model.drive(&scene.method, scene.plan(model.schema()).unwrap(), &mut shown).unwrap();
        for rows in shown.rows.windows(2) {
            let moved: f64 = (1..5).map(|k| (rows[1][k] - rows[0][k]).powi(2)).sum();
            assert!(moved < 0.01, "{steps}: {rows:?}");
            let turned = [5, 7].map(|k| (rows[1][k] - rows[0][k]).abs());
            assert!(turned.iter().all(|x| *x < PI + 0.1), "{steps}: {rows:?}");
        }
        shown.turns
    };
    let expected = run("rtol = 1e-12");
    assert!(expected.len() > 30);
    for steps in [
        "dt = 50\n[method]\nname = \"exact\"",
        "dt = 7\n[method]\nname = \"exact\"",
        "rtol = 1e-9\n[method]\nname = \"exact\"",
        "rtol = 1e-12\n[method]\nname = \"taylor12\"",
    ] {
        let turns = run(steps);
        assert_eq!(turns.len(), expected.len(), "{steps}: {turns:?}");
        assert!(far(&turns, &expected) < 1e-7, "{steps}: {turns:?}");
    }
}

/// A torque is stated along the axes of the scene, whatever the principal ones are: l̇ = gτ.
#[test]
fn torques_are_along_the_axes_of_the_scene() {
    let g = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let (omega, tau) = (Vector3::new(0.3, -0.2, 0.9), Vector3::new(0.1, 0.2, -1.0));
    let attitude = "attitude = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]\nomega_body = [0.3, -0.2, 0.9]";
    let up = g.row(2).transpose();
    for (keys, torque) in [
        ("thruster = [0.1, 0.2, -1]", tau),
        ("torque = [0.1, \"0.2\", -1]", tau),
        ("torque = \"[0.1, 0.2, -1]\"", tau),
        ("torque_space = \"g*[0.1, 0.2, -1]\"", tau),
        ("damping = 0.5", -0.5 * omega),
        ("torque = \"-w/2\"", -0.5 * omega),
        ("weight = [0.1, 0.2, -1]", up.cross(&tau)),
    ] {
        let at = |t: f64| {
            let body = format!("kind = \"driven-body\"\n{TENSOR}\n{attitude}\n{keys}");
            let time = format!("t_span = [0, {t}]\nsteps = 1");
            last(&scene(&body, RKMK4, &time, "[\"momentum_space\"]"))
        };
        let h = 1e-4;
        let (ahead, behind) = (at(h), at(-h));
        let expected = g * torque;
        for i in 0..3 {
            let rate = (ahead[i] - behind[i]) / (2.0 * h);
            assert!((rate - expected[i]).abs() < 1e-6, "{keys}: {rate} {}", expected[i]);
        }
    }
}

/// A top moves the same by its attitude as by its momentum, and shows where its axis points.
#[test]
fn a_top_has_an_attitude_where_it_is_asked_for() {
    for inertia in ["inertia = [1, 1, 0.5]", TENSOR] {
        let top = format!(
            "kind = \"heavy-top\"\n{inertia}\nweight = [0, 0.1, 1]\nomega_body = [0.1, 0, 6]\n\
             vertical = [0.6, 0, 0.8]"
        );
        let of = |more: &str| {
            let quantities = format!(
                "[\"momentum_body\", \"vertical\", \"energy\", \"nutation\", \"momentum_vertical\"{more}]"
            );
            let of = scene(&top, RKMK4, "t_span = [0, 2]\ndt = 0.002", &quantities);
            let model = of.model().unwrap();
            (model.modelled(&of.method)[0].clone(), rows(&of))
        };
        let (modelled, momentum) = of("");
        assert_eq!(modelled, "momentum and vertical on se(3)*");
        let (modelled, attitude) = of(", \"axis\", \"attitude_defect\", \"momentum_space\"");
        assert!(modelled.starts_with("attitude"), "{modelled}");
        let first = &attitude[0];
        assert!(far(&first[4..7], &[0.6, 0.0, 0.8]) < 1e-15 && first[13] < 1e-15, "{first:?}");
        for (a, b) in momentum.iter().zip(&attitude) {
            assert!(far(a, &b[..a.len()]) < 1e-8, "{a:?} {b:?}");
            // Nutation, by the vertical and by the axis; l3 is the momentum about the vertical.
            assert!((b[8] - b[6].acos()).abs() < 1e-7 && (b[8] - b[12].acos()).abs() < 1e-7);
            assert!((b[9] - b[16]).abs() < 1e-12, "{b:?}");
        }
    }
    // By its attitude alone; the two agree, or are refused.
    let top = "kind = \"heavy-top\"\ninertia = [1, 1, 0.5]\nweight = [0, 0, 1]\nomega_body = [0, 0, 6]\n\
               quaternion = [0.6, 0.8, 0, 0]";
    let by_quaternion = last(&scene(top, RKMK4, FINE, "[\"vertical\"]"));
    let both = format!("{top}\nvertical = [0, 0.96, -0.28]");
    assert!(far(&last(&scene(&both, RKMK4, FINE, "[\"vertical\"]")), &by_quaternion) < 1e-13);
    let (line, message) = refused(&format!("{top}\nvertical = [0, 0, 1]"), FINE, "axis");
    assert!(line == 8 && message.contains("from the third row of the attitude"), "{message}");
    let (_, message) = refused(&top.replace("quaternion", "#"), FINE, "axis");
    assert!(message.contains("expected `vertical`, `attitude` or `quaternion`"), "{message}");
    // Upside down is a half turn.
    let down = top.replace("quaternion = [0.6, 0.8, 0, 0]", "vertical = [0, 0, -1]");
    assert!(far(&rows(&scene(&down, RKMK4, FINE, "[\"axis\"]"))[0], &[0.0, 0.0, 0.0, -1.0]) == 0.0);
}

/// Numbers that are typed with few digits are normalised, and the run says so; others are refused with what is meant.
#[test]
fn numbers_of_few_digits_are_normalised() {
    let of = |kind: &str, more: &str| {
        let keys = "inertia = [1, 2, 3]\nomega_body = [0.3, 0.5, 1]";
        format!("kind = {kind:?}\n{keys}\n{more}")
    };
    let (c, s) = (0.8, 0.6);
    let exact = format!("attitude = [[{c}, {}, 0], [{s}, {c}, 0], [0, 0, 1]]", -s);
    let rough = "attitude = [[0.8001, -0.6, 0], [0.6, 0.7998, 0], [0, 0, 1]]";
    for (kind, more) in
        [("rigid-body", ""), ("driven-body", "damping = 0.1"), ("heavy-top", "weight = [0, 0, 1]")]
    {
        let quantities = "[\"attitude\", \"quaternion\", \"attitude_defect\"]";
        let run = |attitude: &str| {
            let body = of(kind, &format!("{more}\n{attitude}"));
            let of = scene(&body, RKMK4, "t_span = [0, 1]\nsteps = 100", quantities);
            (rows(&of)[0].clone(), of.problem.notes().to_vec())
        };
        let (start, notes) = run(&exact);
        assert_eq!(notes, [""; 0], "{kind}");
        let (near, notes) = run(rough);
        assert!(far(&near, &start) < 2e-4 && near[14] < 1e-14, "{kind}");
        assert!(
            notes[0].starts_with("attitude: it is replaced by the nearest rotation"),
            "{notes:?}"
        );
        let (turned, notes) = run("quaternion = [0.7071, 0.7071, 0, 0]");
        assert!(notes[0].starts_with("quaternion: its length is 0.99999"), "{notes:?}");
        assert!(far(&turned[1..10], &[1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0]) < 1e-15);
        assert!((turned[10] - 0.5f64.sqrt()).abs() < 1e-15);
        for (wrong, parts) in [
            ("quaternion = [1, 1, 0, 0]", ["expected 1", "[0.7071068, 0.7071068, 0.0, 0.0]"]),
            ("quaternion = [0, 0, 0, 0]", ["its length is 0", "expected 1"]),
            (
                "attitude = [[0.9, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]]",
                ["not in SO(3)", "right angles"],
            ),
            ("attitude = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]", ["determinant is -1", "rotation"]),
        ] {
            let (_, message) = refused(&of(kind, &format!("{more}\n{wrong}")), FINE, "energy");
            parts.iter().for_each(|part| assert!(message.contains(part), "{kind}: {message}"));
        }
    }
    let vertical = of("heavy-top", "weight = [0, 0, 1]\nvertical = [0.7071, 0, 0.7071]");
    let of_vertical = scene(&vertical, RKMK4, FINE, "[\"vertical\"]");
    assert!(of_vertical.problem.notes()[0].starts_with("vertical: its length"));
    let part = "kind = \"composed\"\n[[problem.parts]]\nname = \"g\"\nspace = \"rotation\"\nfield = [0, 0, 1]\n\
                start = [[0.8001, -0.6, 0], [0.6, 0.7998, 0], [0, 0, 1]]";
    let notes = scene(part, RKMK4, FINE, "[\"state\"]").problem.notes().to_vec();
    assert!(notes[0].starts_with("parts[1].start: "), "{notes:?}");
}

/// What misses an algebra is said by both entries that do not go together, and with the form of the algebra.
#[test]
fn an_algebra_is_refused_with_its_form() {
    for (group, field, parts) in [
        (
            "sp",
            "[[1, 0, 0, 0], [0, 0, 0, 0], [0, 0, -1, 0], [0, -2, 0, 0]]",
            // Symmetric about the wrong block is fine: C = [0 0; 0 -2].
            None,
        ),
        (
            "sp",
            "[[2, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]",
            Some([
                "field[1,1] is 2 and field[3,3] is 0, expected field[3,3] = -field[1,1]",
                "(q1, q2, p1, p2)",
            ]),
        ),
        (
            "sp",
            "[[0, 0, 0, 1], [0, 0, 3, 0], [0, 0, 0, 0], [0, 0, 0, 0]]",
            Some([
                "field[1,4] is 1 and field[2,3] is 3, expected field[2,3] = field[1,4]",
                "B and C symmetric",
            ]),
        ),
        (
            "sp",
            "[[0, 2, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 2, 0]]",
            Some([
                "field[1,2] is 2 and field[4,3] is 2, expected field[4,3] = -field[1,2]",
                "[A B; C -Aᵀ]",
            ]),
        ),
        (
            "so",
            "[[0, 0.5], [0.3, 0]]",
            Some([
                "field[1,2] is 0.5 and field[2,1] is 0.3, expected field[2,1] = -field[1,2]",
                "so(2): ",
            ]),
        ),
        (
            "so(1,1)",
            "[[0, 0.5], [0.3, 0]]",
            Some([
                "field[1,2] is 0.5 and field[2,1] is 0.3, expected field[2,1] = field[1,2]",
                "so(1,1): ",
            ]),
        ),
        ("sl", "[[1, 0.5], [0.3, 1]]", Some(["sum of its diagonal is 2, expected 0", "sl(2): "])),
    ] {
        let problem = format!("kind = \"matrix-ode\"\ngroup = {group:?}\nfield = {field}");
        match parts {
            None => drop(scene(&problem, RKMK4, FINE, "[\"point\"]")),
            Some(parts) => {
                let (_, message) = refused(&problem, FINE, "point");
                parts.iter().for_each(|part| assert!(message.contains(part), "{message}"));
            }
        }
    }
}

/// A start in a group that is typed with few digits is one of the group; another one is refused with its form.
#[test]
fn a_start_of_few_digits_is_one_of_its_group() {
    let of = |group: &str, start: &str| {
        let field = "field = [[0, 1], [-1, 0]]";
        format!("kind = \"matrix-ode\"\ngroup = {group:?}\n{field}\nstart = {start}")
    };
    for group in ["so", "SO(2)", "sp"] {
        let rough = of(group, "[[0.8001, -0.6], [0.6, 0.8]]");
        let rough = scene(&rough, RKMK4, FINE, "[\"point\", \"group_defect\"]");
        assert!(rough.problem.notes()[0].starts_with("start: it is replaced"), "{group}");
        let start = &rows(&rough)[0];
        assert!(far(&start[1..5], &[0.8, -0.6, 0.6, 0.8]) < 2e-4 && start[5] < 1e-14, "{start:?}");
        let exact = scene(&of(group, "[[0.8, -0.6], [0.6, 0.8]]"), RKMK4, FINE, "[\"point\"]");
        assert_eq!(exact.problem.notes(), [""; 0]);
        let (_, message) = refused(&of(group, "[[0.9, -0.6], [0.6, 0.8]]"), FINE, "point");
        let form = if group == "sp" { "J = [0 1; -1 0]" } else { "unit vectors at right angles" };
        assert!(message.contains(form), "{message}");
    }
    let (line, message) = refused(&of("SO(3)", "[[1, 0], [0, 1]]"), FINE, "point");
    assert!(line == 5 && message.contains("found 2 rows, expected 3 for so(3)"), "{message}");
}

/// so(n) by the entries above the diagonal is so(n) by all of them.
#[test]
fn entries_above_the_diagonal_are_enough() {
    let run = |field: &str| {
        let problem = format!("kind = \"matrix-ode\"\ngroup = \"so\"\nfield = {field}");
        let scene = scene(&problem, RKMK4, FINE, "[\"point\"]");
        // It is a problem on matrices.
        let model = scene.model().unwrap();
        let operations = model.operations(&scene.method, &scene.steps(), |_, _, _| None);
        (last(&scene), operations.unwrap())
    };
    let all = "[[0, \"t\", 0.3], [\"-t\", 0, \"y12 - 1\"], [-0.3, \"1 - y12\", 0]]";
    let [(upper, few), (all, many)] = ["[\"t\", 0.3, \"y12 - 1\"]", all].map(run);
    assert!(far(&upper, &all) < 1e-13);
    // A difference less, in each of four stages.
    assert!((many - few - 4.0).abs() < 0.5, "{few} and {many}");
    let euler = |momentum: &str| {
        let energy = "hamiltonian = \"m12^2/2 + m13^2 + m23^2/4\"\nalgebra = \"so\"";
        let problem = format!("kind = \"euler\"\n{energy}\nmomentum = {momentum}");
        last(&scene(&problem, RKMK4, FINE, "[\"momentum\"]"))
    };
    let all = "[[0, 0.3, -0.2], [-0.3, 0, 1], [0.2, -1, 0]]";
    assert_eq!(euler("[0.3, -0.2, 1]"), euler(all));
    for (keys, part) in [
        ("group = \"so\"\nfield = [\"t\", 1]", "found 2 formulas in no row"),
        ("group = \"sl\"\nfield = [\"t\", 1, 1]", "found 3 formulas in no row"),
        ("group = \"so\"\nfield = [\"t\", 1, \"y15\"]", "field[3]: unknown name `y15`"),
    ] {
        let (_, message) = refused(&format!("kind = \"matrix-ode\"\n{keys}"), FINE, "point");
        assert!(message.contains(part), "{message}");
    }
}

/// A box with sides a, b, c and mass 12 has moments of inertia b² + c², c² + a², a² + b².
#[test]
fn sides_have_their_moments() {
    let sides = |moments| PrincipalInertia::diagonal(moments).sides_of_a_box();
    let [a, b, c]: [f64; 3] = [3.0, 2.0, 1.0];
    let all = sides([b * b + c * c, c * c + a * a, a * a + b * b]);
    for (side, expected) in all.iter().zip([1.0, 2.0 / 3.0, 1.0 / 3.0]) {
        assert!((side - expected).abs() < 1e-12, "{all:?}");
    }
    assert!(sides([1.0, 1.0, 2.0])[2] > 0.0 && sides([1.0, 1.0, 9.0])[2] > 0.0);
}

#[test]
fn an_ellipsoid_has_the_energy() {
    let (inertia, m) = (PrincipalInertia::diagonal([1.0, 2.0, 4.0]), [0.3, -2.0, 1.0]);
    let energy = 0.5 * (0.09 + 2.0 + 0.25);
    for (axis, j) in inertia.energy_ellipsoid(&m).iter().zip([1.0, 2.0, 4.0]) {
        assert!((axis * axis / (2.0 * j) - energy).abs() < 1e-15);
    }
}

/// After an attempt whose iteration failed, and a kink of f behind it, the steps grow again.
#[test]
fn a_kink_after_a_failed_attempt_does_not_hold_the_steps() {
    for (omega, method) in [
        ("min(1, max(0, t - 4.092))", "gauss4"),
        ("(1 + sign(t - 5))/2", "gauss4"),
        ("min(1, max(0, t - 4.092))", "gauss6"),
        ("min(1, max(0, t - 4.092))", "midpoint-implicit"),
    ] {
        for rtol in ["1e-4", "1e-6"] {
            let text = format!(
                "[problem]\nkind = \"rigid-motion\"\nomega = [\"0\", \"0\", \"{omega}\"]\n\
                 velocity = [\"1\", \"0\", \"0\"]\n[method]\nname = \"{method}\"\n[time]\n\
                 t_span = [0, 8]\nrtol = {rtol}\nmax_steps = 2000\n"
            );
            let scene = Scene::parse("rest", &text).unwrap();
            let model = scene.model().unwrap();
            let mut steps = 0;
            let mut sink = |_: f64, _: Row<'_>| steps += 1;
            let plan = scene.plan(model.schema()).unwrap();
            let mut rows = lieflow_model::problem::Rows(&mut sink);
            let done = model.drive(&scene.method, plan, &mut rows);
            assert!(done.is_ok(), "{omega}, {method}, {rtol}: {steps} steps, {done:?}");
        }
    }
}

/// The first row has the quaternion of the scene with its sign, whatever the principal axes are.
#[test]
fn the_first_row_has_the_sign_of_the_scene() {
    for inertia in [
        "[2, 1, 1.5]",
        "[[2, 0.3, 0], [0.3, 1.5, 0], [0, 0, 2.5]]",
        "[[2, 0, 0], [0, 1.5, -0.2], [0, -0.2, 1.8]]",
        "[[2, 0.1, 0.2], [0.1, 1.5, -0.3], [0.2, -0.3, 1.8]]",
    ] {
        for sign in [1.0, -1.0] {
            let q = [0.5, -0.5, 0.1, 0.7].map(|x| sign * x);
            let problem = format!(
                "kind = \"rigid-body\"\ninertia = {inertia}\nomega_body = [0.1, 0.2, 0.3]\nquaternion = {q:?}"
            );
            let start = &rows(&scene(&problem, RKMK4, FINE, "[\"quaternion\"]"))[0];
            assert!(far(&start[1..], &q) < 1e-14, "{inertia}: {start:?} {q:?}");
        }
    }
}
