//! Motions in which small errors grow: digits are not stated that rounding takes, and no pulse is seen in them.

use crate::support::Folder;

/// The run of a pendulum of this equation in these times.
fn pendulum(start: &str, field: &str, time: &str) -> String {
    let folder = Folder::new();
    folder.write(
        "scene.toml",
        &format!(
            "[problem]\nkind = \"composed\"\n[[problem.parts]]\nname = \"y\"\nspace = \"numbers\"\nstart = {start}\n\
             field = {field}\n[time]\n{time}\n"
        ),
    );
    folder.lieflow(&["run", "scene.toml", "--out", "out", "--no-page"]).ok()
}

/// The path to the upright position, y = 4 atan(eᵗ) − π: at t = 38 rounding decides on which side the pendulum falls. Two
/// runs in large steps round alike.
#[test]
fn rounding_that_two_runs_share_is_counted() {
    let field = "[\"y2\", \"-sin(y1)\"]";
    for time in
        ["t_span = [0, 38]", "t_span = [0, 38]\nh_max = 0.019", "t_span = [0, 38]\ndt = 0.02"]
    {
        let out = pendulum("[0, 2]", field, time);
        assert!(out.contains("no digit is right"), "{time}: {out}");
        assert!(!out.contains("pulse") && !out.contains("lieflow gives"), "{time}: {out}");
    }
    let short = pendulum("[0, 2]", field, "t_span = [0, 5]");
    assert!(short.contains("about 12 digits") && !short.contains("WARNING"), "{short}");
}

/// From a start whose number is not quite the upright position the pendulum falls, but in steps that are small enough the
/// change of the angle is lost in each sum. Right is y₁ = 2.938.
#[test]
fn increments_that_are_lost_in_sums_are_counted() {
    let field = "[\"y2\", \"-9.81*sin(y1) - 0.05*y2\"]";
    for limit in ["", "\nh_max = 0.00575"] {
        let time = format!("t_span = [0, 11.5]{limit}");
        let out = pendulum("[3.141592653589793, 0]", field, &time);
        assert!(out.contains("no digit is right"), "{limit}: {out}");
        assert!(
            out.contains("WARNING: a change of 1.4e-14 of the start moves `y`"),
            "{limit}: {out}"
        );
    }
}
