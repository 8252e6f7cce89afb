//! Systems composed from parts: against closed forms, against the kinds that have them as one system, and what
//! cannot be composed.

use super::*;

/// Column by column, a bundled scene at the end of a finer run with other lines.
fn end_of(name: &str, changes: &[(&str, &str)], quantities: &str) -> Vec<f64> {
    let mut text = bundled(name);
    for (from, to) in changes {
        assert!(text.contains(from), "{name} has no {from}");
        text = text.replace(from, to);
    }
    let start = text.find("quantities = ").unwrap();
    text.replace_range(start.., &format!("quantities = {quantities}\n"));
    last(&Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}")))
}

/// On the separatrix of its pendulum, sin(a/2) = tanh kt: the oscillator gives all it has and comes to rest,
/// the spin stands on its head.
#[test]
fn a_spin_and_an_oscillator_are_a_pendulum() {
    let (w, k, t) = (3.0f64, 0.5f64, 6.0f64);
    let (half, rest) = ((k * t).tanh(), 1.0 / (k * t).cosh());
    let (sine, cosine) = (w * t).sin_cos();
    let (across, q) = (2.0 * half * rest, 2.0 * rest);
    let exact = [-sine * across, cosine * across, 2.0 * half * half - 1.0, cosine * q, -sine * q];
    let error = |dt: &str| {
        let changes = [("[1.9]", "[2.0]"), ("[0.0, 40.0]", "[0.0, 6.0]"), ("dt = 0.02", dt)];
        far(&end_of("spin-and-oscillator", &changes, "[\"state\"]"), &exact)
    };
    let (coarse, fine) = (error("dt = 0.02"), error("dt = 0.01"));
    assert!(fine < 1e-6 && (3.7..4.3).contains(&(coarse / fine).log2()), "{coarse:e} {fine:e}");
}

/// The angular momentum in space stands still, the energy grows by the work of the motor, and the wheel's axis
/// ends along the momentum.
#[test]
fn a_satellite_turns_over() {
    let scene = Scene::bundled("gyrostat").unwrap();
    let kept = rows(&scene);
    let model = scene.model_with(scene.layer, &["state", "invariants"]).unwrap();
    let at = |name: &str| 1 + model.schema().columns().position(|column| column == name).unwrap();
    for name in ["L1", "L2", "L3", "balance"] {
        let drift = kept.iter().map(|row| (row[at(name)] - kept[0][at(name)]).abs());
        assert!(drift.fold(0.0, f64::max) < 1e-6, "{name}");
    }
    let end = &kept[kept.len() - 60..];
    assert!((end[59][at("h")] - 0.9).abs() < 1e-12 && end.iter().all(|row| row[at("m1")] > 0.95));
}

/// With a wheel at a constant rate along the axis of a symmetric body, m turns about it at
/// (m₁ − h)/J₁ − m₁/J₂, and so does ω; g m stays where it was.
#[test]
fn a_symmetric_gyrostat_precesses() {
    let changes = [
        ("u = 0.002 ", "u = 0.0 "),
        ("J3 = 3.0", "J3 = 2.5"),
        ("start = [0.1, 0.0, 1.0]", "start = [0.4, 0.0, 1.0]"),
        (
            "name = \"h\"\nspace = \"numbers\"\nstart = [0.0]",
            "name = \"h\"\nspace = \"numbers\"\nstart = [0.3]",
        ),
        ("[0.0, 450.0]", "[0.0, 10.0]"),
        ("dt = 0.1", "dt = 0.01"),
    ];
    let end = end_of("gyrostat", &changes, "[\"vectors\", \"invariants\", \"defects\"]");
    let angle: f64 = 10.0 * ((0.4 - 0.3) / 2.0 - 0.4 / 2.5);
    // ṁ₂ = m₃ω₁ − m₁ω₃, ṁ₃ = m₁ω₂ − m₂ω₁: from e₃ towards e₂ by the angle.
    assert!(far(&end[..3], &[0.4, angle.sin(), angle.cos()]) < 1e-9, "{end:?}");
    assert!(far(&end[3..6], &[0.4, 0.0, 1.0]) < 1e-9 && end[7] < 1e-14, "{end:?}");
}

/// A system that another kind has as one, composed from its parts: the same to rounding.
#[test]
fn parts_are_what_other_kinds_are() {
    // Two spins of an open chain.
    let chain = "kind = \"spin-chain\"\nspins = [[0.6, 0.0, 0.8], [0.0, 0.96, -0.28]]\nring = false\n\
                 anisotropy = 0.5";
    let method = "name = \"rkmk4\"\nmap = \"cay\"";
    let whole =
        last(&scene(chain, method, "t_span = [0, 20]\ndt = 0.02", "[\"spins\", \"energy\"]"));
    let parts = end_of("spin-pair", &[], "[\"state\", \"invariants\"]");
    assert!(far(&parts[..7], &whole) < 1e-13, "{parts:?} {whole:?}");

    // A free body by its momentum.
    let body = "kind = \"rigid-body\"\ninertia = [2.0, 2.5, 3.0]\nmomentum_body = [0.1, 0.0, 1.0]";
    let whole = last(&scene(body, RKMK4, "t_span = [0, 450]\ndt = 0.1", "[\"momentum_body\"]"));
    let parts = end_of("gyrostat", &[("u = 0.002 ", "u = 0.0 ")], "[\"vectors\"]");
    assert!(far(&parts, &whole) < 1e-13, "{parts:?} {whole:?}");

    // A heavy top by its attitude and its momentum in space, on SO(3) × T(3).
    let driven = "kind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0.5, 0.4, -0.8]\n\
                  weight = [0.2, -0.1, 0.9]";
    let whole = last(&scene(driven, RKMK4, SHORT, "[\"attitude\", \"momentum_space\"]"));
    let body = |i: usize| format!("(g1{i}*l1 + g2{i}*l2 + g3{i}*l3)/{}", [1.0, 2.0, 2.5][i - 1]);
    let omega = |i: usize| {
        let terms = [1, 2, 3].map(|j| format!("g{i}{j}*{}", body(j)));
        format!("{:?}", terms.join(" + "))
    };
    let weight = |i: usize| format!("(0.2*g{i}1 - 0.1*g{i}2 + 0.9*g{i}3)");
    let top = format!(
        "kind = \"composed\"\n[[problem.parts]]\nname = \"g\"\nspace = \"rotation\"\nfield = [{}, {}, \
         {}]\n[[problem.parts]]\nname = \"l\"\nspace = \"numbers\"\nstart = [0.5, 0.8, -2.0]\nfield = \
         [\"-{}\", \"{}\", \"0\"]",
        omega(1),
        omega(2),
        omega(3),
        weight(2),
        weight(1)
    );
    let composed = scene(&top, RKMK4, SHORT, "[\"state\"]");
    assert!(far(&last(&composed), &whole) < 1e-13);
    assert_eq!(composed.model().unwrap().modelled(&composed.method), ["rotation g, numbers l"]);
    assert_eq!(composed.problem.invariants(&[]), ["defects"]);
}

const RKMK4: &str = "name = \"rkmk4\"";
const SHORT: &str = "t_span = [0, 2]\ndt = 0.01";

/// What fields may depend on: t, parameters, every part; a part may be alone, of each space.
#[test]
fn fields_see_time_parameters_and_all_parts() {
    let alone = |part: &str| {
        format!("kind = \"composed\"\nparameters = {{ k = 2 }}\n[[problem.parts]]\n{part}")
    };
    let number = alone("name = \"x\"\nspace = \"numbers\"\nstart = [1]\nfield = [\"k*t - x\"]");
    let end = last(&scene(&number, RKMK4, SHORT, "[\"state\"]"));
    // ẋ = 2t − x from 1: x = 2t − 2 + 3e^{−t}.
    assert!(far(&end, &[2.0 + 3.0 * (-2.0f64).exp()]) < 1e-9, "{end:?}");

    let vector = alone(
        "name = \"x\"\nspace = \"vector\"\nstart = [0, 3, 4]\nfield = [\"k*t\", \"0\", \"0\"]",
    );
    let end = last(&scene(&vector, RKMK4, SHORT, "[\"state\", \"lengths\"]"));
    let (s, c) = 4.0f64.sin_cos();
    assert!(far(&end, &[0.0, 3.0 * c - 4.0 * s, 3.0 * s + 4.0 * c, 5.0]) < 1e-12, "{end:?}");

    let rows = "[[0, -1, 0], [1, 0, 0], [0, 0, 1]]";
    let rotation = alone(&format!(
        "name = \"g\"\nspace = \"rotation\"\nstart = {rows}\nfield = [\"k*t\", \"0\", \"0\"]"
    ));
    let end = last(&scene(&rotation, RKMK4, SHORT, "[\"state\", \"defects\"]"));
    let exact = [0.0, -1.0, 0.0, c, 0.0, -s, s, 0.0, c, 0.0];
    assert!(far(&end, &exact) < 1e-12, "{end:?}");
}

/// What has no value on the way ends the run, and what it had stands.
#[test]
fn a_field_without_a_value_ends_the_run() {
    let pole = "kind = \"composed\"\n[[problem.parts]]\nname = \"x\"\nspace = \"numbers\"\nstart = [1]\n\
                field = [\"1/(x - 1.5)*0 + sqrt(1.5 - t)\"]";
    let of = scene(pole, RKMK4, SHORT, "[\"state\"]");
    let mut rows = 0;
    let run = of.model().unwrap().run(&of.method, &of.grid, &of.save, &mut |_, _| rows += 1);
    assert!(run.is_err() && rows > 100, "{rows}");
}

/// The rotation of a system with one, and that of a rigid motion, as a quaternion and as Euler angles: those of the matrix.
/// Systems with none or several have neither.
#[test]
fn a_rotation_is_a_quaternion_and_angles() {
    let record = end_of("gyro-record", &[], "[\"state\", \"quaternion\", \"euler_zyx\"]");
    let rolling = end_of("rolling-turn", &[], "[\"attitude\", \"quaternion\", \"euler_zyx\"]");
    for end in [record, rolling] {
        let (g, rest) = end.split_at(9);
        let (q, angles) = rest.split_at(4);
        let [w, x, y, z] = q else { panic!("{end:?}") };
        let of_q = [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ];
        assert!(far(&of_q, g) < 1e-12, "{end:?}");
        let of_angles = [g[3].atan2(g[0]), -g[6].asin(), g[7].atan2(g[8])];
        for (angle, expected) in angles.iter().zip(of_angles) {
            let turns = (angle - expected) / std::f64::consts::TAU;
            assert!((turns - turns.round()).abs() < 1e-12, "{angles:?} {of_angles:?}");
        }
    }
    let part =
        |name: &str| format!("{{ name = \"{name}\", space = \"rotation\", field = [1, 0, 0] }}");
    for (parts, why) in [
        (vec![part("a"), part("b")], "several parts are rotations"),
        (
            vec!["{ name = \"x\", space = \"numbers\", start = [1], field = [0] }".into()],
            "no part is a rotation",
        ),
        (
            vec![
                part("a"),
                "{ name = \"qx\", space = \"numbers\", start = [1], field = [0] }".into(),
            ],
            "a part has a number by the name of a column",
        ),
    ] {
        let text = format!(
            "[problem]\nkind = \"composed\"\nparts = [{}]\n[time]\nt_span = [0, 1]\n[output]\n\
             quantities = [\"quaternion\"]\n",
            parts.join(", ")
        );
        let error = Scene::parse("scene", &text).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
}
