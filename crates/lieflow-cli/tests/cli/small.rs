//! What is small beside the rest of a state: bodies, columns and invariants; and columns of one name.

use crate::support::Folder;

/// A tiny body beside a huge one has an error of its own, and the constancy of its energy is not doubted.
#[test]
fn the_error_of_each_body_is_told() {
    let folder = Folder::new();
    folder.write(
        "scene.toml",
        "[problem]\nkind = \"rigid-bodies\"\nbodies = [\n\
         { inertia = [1e6, 2e6, 3e6], momentum_body = [2000.0, 100.0, 3000.0] },\n\
         { inertia = [1e-3, 2e-3, 2.5e-3], momentum_body = [3e-3, 2e-3, 1e-3] },\n]\n\
         [method]\nname = \"rkmk4\"\n[time]\nt_span = [0.0, 20.0]\ndt = 0.5\n",
    );
    let out = folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    assert!(out.contains("body 2 0.06") && out.contains("this run is inaccurate"), "{out}");
    assert!(!out.contains("no constant of this motion"), "{out}");
}

/// Columns without a right digit are named, where the vector that they belong to has some.
#[test]
fn columns_without_a_right_digit_are_told() {
    let folder = Folder::new();
    let run = |start: &str, dt: &str| {
        folder.write(
            "scene.toml",
            &format!(
                "[problem]\nkind = \"composed\"\ninvariants = {{ small = \"b2^2+b3^2\" }}\n[[problem.parts]]\nname = \"b\"\n\
                 space = \"numbers\"\nstart = {start}\nfield = [\"0\", \"4*b3\", \"-4*b2\"]\n[method]\nname = \"rkmk4\"\n\
                 [time]\nt_span = [0.0, 20.0]\ndt = {dt}\n"
            ),
        );
        folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok()
    };
    let small = run("[1e6, 1e-3, 0]", "0.25");
    let told = "note: `b2` has no right digit, and one further column: it is at most 0.00";
    assert!(small.contains(told) && small.contains("The error of `b` is relative to"), "{small}");
    assert!(!small.contains("no constant of this motion"), "{small}");
    // A column of 0 has no digits, and is no news. Large ones have theirs.
    for (start, dt) in [("[1, 0, 0]", "0.25"), ("[1, 1, 0]", "0.25"), ("[1e6, 1e-3, 0]", "0.01")] {
        let right = run(start, dt);
        assert!(!right.contains("has no right digit"), "{start} {dt}: {right}");
    }
}

/// A quantity in which the digits of the state cancel has fewer of them, and that is told where it has none. On gl(2) the
/// group element grows to 3e4, and the momentum in space, which is kept, is a difference of such numbers.
#[test]
fn a_quantity_without_a_right_digit_is_told() {
    let folder = Folder::new();
    let run = |rtol: &str| {
        folder.write(
            "scene.toml",
            &format!(
                "[problem]\nkind = \"euler\"\nalgebra = \"gl\"\ninverse_inertia = [[1.0, 0.5], [2.0, 3.0]]\n\
                 momentum = [[0.3, 1.0], [2.0, 0.5]]\n[method]\nname = \"gauss4\"\n[time]\nt_span = [0.0, 4.0]\n\
                 rtol = {rtol}\n[output]\nquantities = [\"momentum_space\"]\n"
            ),
        );
        folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok()
    };
    let told = "`momentum_space` has no right digit";
    let rough = run("1e-6");
    assert!(rough.contains("5 digits are right") && rough.contains(told), "{rough}");
    let fine = run("1e-12");
    assert!(!fine.contains(told), "{fine}");
}

/// A state that is small in most rows has fewer digits there than beside its start, and that is told.
#[test]
fn a_state_that_becomes_small_has_fewer_digits() {
    let folder = Folder::new();
    let run = |rtol: &str, field: &str| {
        folder.write(
            "scene.toml",
            &format!(
                "[problem]\nkind = \"composed\"\n[[problem.parts]]\nname = \"b\"\nspace = \"numbers\"\nstart = [1, 1, 0]\n\
                 field = {field}\n[method]\nname = \"rk dopri5\"\n[time]\nt_span = [0, 30]\nrtol = {rtol}\n"
            ),
        );
        folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok()
    };
    let decay = "[\"-b1\", \"4*b3 - b2\", \"-4*b2 - b3\"]";
    let told = "note: `b` has fewer right digits in most rows: its size is ";
    let out = run("1e-5\natol = 1e-5", decay);
    assert!(out.contains(told) && out.contains("The error above is relative to 1.4"), "{out}");
    let turns = "[\"0\", \"4*b3\", \"-4*b2\"]";
    for (rtol, field) in [("1e-5", turns), ("1e-10", decay)] {
        let out = run(rtol, field);
        assert!(!out.contains("has fewer right digits"), "{field}: {out}");
    }
}

/// An invariant whose value is 0 moves by the error of the run: that is no reason to doubt it.
#[test]
fn an_invariant_of_0_is_not_doubted() {
    let folder = Folder::new();
    for method in ["cf4", "rk4", "rkmk4"] {
        let method = format!("method.name=\"{method}\"");
        let set = ["--set", "method=", "--set", &method, "--out", "out"];
        let args = [&["run", "gyrostat", "--no-page"][..], &set[..]].concat();
        let out = folder.lieflow(&args).ok();
        assert!(!out.contains("no constant of this motion"), "{out}");
    }
}

/// A name of a scene that would hide a column of another quantity is refused.
#[test]
fn names_of_other_columns_are_refused() {
    let folder = Folder::new();
    folder.write(
        "growth.toml",
        "[problem]\nkind = \"lyapunov\"\nvariables = [\"s1\", \"y\"]\nx = [1, 1]\nfield = [\"s1\", \"-y\"]\n\
         [time]\nt_span = [0, 2]\n",
    );
    let refused = folder.lieflow(&["run", "growth.toml", "--out", "out"]).refused();
    assert!(refused.contains("growth.toml:3:"), "{refused}");
    assert!(refused.contains("`s1` is a column of the quantity `growth`"), "{refused}");
    folder.write(
        "turn.toml",
        "[problem]\nkind = \"composed\"\ninvariants = { qw = \"a\" }\n\
         [[problem.parts]]\nname = \"g\"\nspace = \"rotation\"\nframe = \"space\"\nfield = [\"0\", \"0\", \"1\"]\n\
         [[problem.parts]]\nname = \"a\"\nspace = \"numbers\"\nstart = [7]\nfield = [\"0\"]\n[time]\nt_span = [0, 2]\n",
    );
    let refused = folder.lieflow(&["run", "turn.toml", "--out", "out"]).refused();
    assert!(refused.contains("`qw` is a column of the quantity"), "{refused}");
}

/// An event is not rounding because one row is at a pole, where its numbers are 1e15.
#[test]
fn a_row_at_a_pole_is_no_measure_of_an_event() {
    let folder = Folder::new();
    folder.write(
        "scene.toml",
        "[problem]\nkind = \"riccati\"\nc = [[1]]\nb = [[-1]]\np = [[0]]\n[time]\nt_span = [0, 10]\n\
         [[events]]\nname = \"ang\"\nwhen = \"angle1 - pi/2\"\n[output]\ntimes = [1.5707963267948966]\n",
    );
    let out = folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    assert!(!out.contains("zero up to rounding") && out.contains("ang"), "{out}");
}
