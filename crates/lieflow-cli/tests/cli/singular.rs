//! What is told of Euler angles that come near to where they are singular.

use crate::support::{Folder, SCENE};

/// Euler angles that come to where they are singular are told.
#[test]
fn singular_angles_are_told() {
    let folder = Folder::new();
    let told = |start: [f64; 2]| {
        let body = format!("omega_body = [0, 1, 0]\neuler.xyz = [0, {}, {}]", start[0], start[1]);
        let text = SCENE.replace("omega_body = [0.2, 0.0, 1.0]", &body);
        folder.write("scene.toml", &text.replace("\"energy\"", "\"euler_xyz\""));
        folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok()
    };
    let half = core::f64::consts::FRAC_PI_2;
    let text = told([half - 1.0, 0.0]);
    assert!(text.contains("note: euler_xyz is singular at t = 1:"), "{text}");
    // Between two steps, and two rows.
    let text = told([half - 1.01, 0.0]);
    assert!(text.contains("note: euler_xyz is singular at t = 1.01:"), "{text}");
    // The third axis passes the first one of space at 0.01, after a quarter turn, between two rows.
    let text = told([0.0, 0.01]);
    assert!(text.contains("note: euler_xyz comes within 0.5"), "{text}");
    assert!(text.contains(" degrees of its singular angle at t = 1.5"), "{text}");
    assert!(!told([half - 3.0, 0.0]).contains("singular"));
}

/// A ball from the identity, where proper sequences are singular. Its axis of rotation is 0.005 off the first axis: after half
/// a turn the third axis passes that of space at 0.01, the other way round.
fn ball(output: &str) -> String {
    let text = SCENE.replace("inertia = [1, 2.0, 3.0]", "inertia = [1, 1, 1]");
    let text = text.replace("omega_body = [0.2, 0.0, 1.0]", "omega_body = [1, 0, 0.005]");
    let text = text.replace("t_span = [0, 2.0]", "t_span = [0, 5.0]");
    let (text, _) = text.split_once("[output]").unwrap();
    format!("{text}{output}\n")
}

/// A singular start does not hide what comes later, and angles of events and formulas are told, too.
#[test]
fn passes_after_a_singular_start_are_told() {
    let folder = Folder::new();
    for output in [
        "[output]\nquantities = [\"euler_zxz\"]\ncount = 3",
        "[[events]]\nname = \"flip\"\nwhen = \"euler_zxz2 - 1\"\n[output]\nquantities = [\"energy\"]",
        "[output]\nquantities = [\"energy\"]\n[output.formulas]\nsum = \"euler_zxz1 + euler_zxz3\"",
    ] {
        folder.write("scene.toml", &ball(output));
        let text = folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
        assert!(text.contains("note: euler_zxz is singular at t = 0:"), "{output}\n{text}");
        assert!(text.contains("note: euler_zxz comes within 0.5"), "{output}\n{text}");
        assert!(text.contains(" degrees of its singular angle at t = 3.1"), "{output}\n{text}");
        assert_eq!(text.matches("singular").count(), 2, "{output}\n{text}");
    }
    // A body that stays there is told once.
    let spin = ball("[output]\nquantities = [\"euler_zxz\"]").replace("[1, 0, 0.005]", "[0, 0, 1]");
    folder.write("scene.toml", &spin);
    let text = folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    assert_eq!(text.matches("singular").count(), 1, "{text}");
}

/// Turns that no points can count are told: more than 100 000 points in a step, and times whose neighbours are a turn apart.
#[test]
fn lost_turns_are_told() {
    let folder = Folder::new();
    for (rate, span, is_lost) in
        [(1e6, "0, 1", true), (30.0, "1e15, 1000000000000010", true), (1e4, "0, 1", false)]
    {
        for quantity in ["euler_zyx", "quaternion"] {
            folder.write(
                "scene.toml",
                &format!(
                    "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0, 0, {rate}]\n[method]\n\
                     name = \"exact\"\n[time]\nt_span = [{span}]\nsteps = 1\n[output]\nquantities = [\"{quantity}\"]\n"
                ),
            );
            let text = folder.lieflow(&["run", "scene.toml", "--out", "out", "--no-page"]).ok();
            let told = format!("{quantity} may have lost turns since t = ");
            assert_eq!(text.contains(&told), is_lost, "{quantity}, {rate}: {text}");
        }
    }
}
