//! Scenes with formulas: against the same stated by keys, closed forms, and what is refused.

use super::*;

const FINE: &str = "t_span = [0, 2]\ndt = 0.005";
const RKMK4: &str = "name = \"rkmk4\"";

/// The line and the message of a scene that is refused.
fn refused(problem: &str, time: &str, quantity: &str) -> (usize, String) {
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
const SAME: f64 = 1e3 * f64::EPSILON;

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
    assert!(of.problem.invariants(&[]).iter().all(|law| law.quantity == "attitude_defect"));
}

/// A run ends where a formula has no value any more; the rows before are there.
#[test]
fn a_run_ends_where_a_formula_has_no_value() {
    let body = format!("{BODY}\ntorque = [\"sqrt(1 - t)\", \"0\", \"0\"]");
    let of = scene(&body, RKMK4, "t_span = [0, 2]\ndt = 0.125", "[\"axis\"]");
    let mut times = Vec::new();
    let mut sink = |t: f64, _: &[f64]| times.push(t);
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
            &["torque[1]: unknown name `w4` at character 1", "`w"][..],
        ),
        ("[\"w1\", \"0\", \"2 w1\"]", FINE, &["torque[2]: found `w`", "2*x"]),
        ("[\"w1\", \"0\"]", FINE, &["expected 3 formulas, found 2"]),
        ("[\"w1\", \"0\", 1]", FINE, &["integer `1`, expected a string"]),
        ("[\"0\", \"1/t\", \"0\"]", FINE, &["torque[1] is inf at the start"]),
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
