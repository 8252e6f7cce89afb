//! Motions on SE(3) by a twist in formulas.

use lieflow::groups::Se3;
use lieflow::maps::exp;
use nalgebra::Vector3;

use super::*;

const FINE: &str = "t_span = [0, 2]\ndt = 0.01";
const ALL: &str = "[\"position\", \"attitude\"]";

/// The position, and the rotation by rows.
fn numbers((g, x): &(nalgebra::Matrix3<f64>, Vector3<f64>)) -> Vec<f64> {
    x.iter().chain(g.transpose().iter()).copied().collect()
}

/// A constant twist moves along a screw: g(t) = exp(tξ) in both frames.
#[test]
fn constant_twists_are_screws() {
    let of = |frame: &str, method: &str| {
        let problem = format!(
            "kind = \"rigid-motion\"\nomega = [0.3, \"k/2\", 1]\nvelocity = [\"k\", 0, 0.4]\n\
             frame = \"{frame}\"\nparameters.k = -0.4"
        );
        last(&scene(&problem, method, FINE, ALL))
    };
    let twist = (Vector3::new(0.6, -0.4, 2.0), Vector3::new(-0.8, 0.0, 0.8));
    let exact = numbers(&exp(&Se3::new(), &twist).unwrap());
    for (frame, method) in [
        ("body", "name = \"rkmk4\""),
        ("space", "name = \"rkmk4\""),
        // Of linear type.
        ("space", "name = \"magnus4\""),
    ] {
        let found = of(frame, method);
        assert!(far(&found, &exact) < 1e-9, "{frame} {method}: {found:?} {exact:?}");
    }
}

/// One motion, stated in the body and in space: ω_s = gω, v_s = gv − ω_s × x.
#[test]
fn both_frames_are_one_motion() {
    let start = "attitude = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]\nposition = [1, -2, 0.5]";
    let twist = "let = { w = [\"sin(t)\", 0.3, \"x1/5\"], v = [1, \"cos(2*t)\", 0], ws = \"g*w\" }";
    let of = |lines: &str| {
        let problem = format!("kind = \"rigid-motion\"\n{lines}\n{start}\n{twist}");
        last(&scene(&problem, "name = \"rkmk\"\ntableau = \"dop853\"", FINE, ALL))
    };
    let body = of("omega = \"w\"\nvelocity = \"v\"");
    let space = of("frame = \"space\"\nomega = \"ws\"\nvelocity = \"g*v - cross(ws, x)\"");
    assert!(far(&body, &space) < 1e-12, "{body:?} {space:?}");
    assert!(far(&body[..3], &[1.0, -2.0, 0.5]) > 0.5);
}

/// A vehicle stands as a body does: by a matrix, a quaternion, or angles.
#[test]
fn a_start_may_be_a_quaternion_or_angles() {
    let of = |start: &str| {
        let problem = format!(
            "kind = \"rigid-motion\"\n{start}\nomega = [0.1, 0.2, \"t\"]\nvelocity = [1, 0, 0]\nposition = [1, 2, 3]"
        );
        last(&scene(&problem, "name = \"rkmk4\"", FINE, ALL))
    };
    let matrix = of("attitude = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]");
    for start in [
        "quaternion = [0.7071067811865476, 0, 0, 0.7071067811865476]",
        "euler.zyx = [\"pi/2\", 0, 0]",
        "fixed.xyz = [0, 0, \"pi/2\"]",
    ] {
        let found = of(start);
        assert!(far(&found, &matrix) < 1e-14, "{start}: {found:?} {matrix:?}");
    }
    let text = "[problem]\nkind = \"rigid-motion\"\nomega = [0, 0, 1]\nvelocity = [1, 0, 0]\n\
                quaternion = [1, 0, 0, 0]\neuler.zyx = [1, 0, 0]\n[time]\nt_span = [0, 1]\n";
    let message = Scene::parse("scene", text).unwrap_err().to_string();
    assert!(message.contains("both `quaternion` and `euler`"), "{message}");
}

#[test]
fn motions_that_are_none_are_refused() {
    for (line, instead, words) in [
        ("frame = \"body\"", "frame = \"bdoy\"", "did you mean `body`?"),
        ("omega = [0, 0, 1]", "omega = [0, 0]", "found 2 formulas, expected 3"),
        ("omega = [0, 0, 1]", "omega = [0, 0, \"w\"]", "unknown name `w`"),
        ("velocity = [1, 0, 0]", "velocity = [\"1/t\", 0, 0]", "velocity[1] is inf at the start"),
        ("velocity = [1, 0, 0]", "", "missing key `velocity`"),
        ("position = [0, 0, 0]", "position = [0, 0]", "expected 3 numbers"),
        ("attitude = [[1, 0, 0], ", "attitude = [[2, 0, 0], ", "SO(3)"),
    ] {
        let text = "[problem]\nkind = \"rigid-motion\"\nframe = \"body\"\nomega = [0, 0, 1]\n\
                    velocity = [1, 0, 0]\nposition = [0, 0, 0]\n\
                    attitude = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n[time]\nt_span = [0, 1]\n";
        assert!(Scene::parse("scene", text).is_ok() && text.contains(line));
        let message = Scene::parse("scene", &text.replace(line, instead)).unwrap_err().to_string();
        assert!(message.contains(words) && !message.contains(" mistakes"), "{message}");
    }
}
