//! Slips of the keyboard and of thought: each gets the sentence that helps.

use crate::support::{Folder, SCENE, read_csv};
use lieflow::catalog::MethodSpec;
use lieflow::tolerance::least_rtol;
use lieflow_model::scene::{BUNDLED, Scene};

/// Runs the scene with one line changed, which is refused.
fn refused(folder: &Folder, good: &str, bad: &str) -> String {
    assert_eq!(SCENE.matches(good).count(), 1, "{good}");
    folder.write("scene.toml", &SCENE.replace(good, bad));
    folder.lieflow(&["run", "scene.toml"]).refused()
}

#[test]
fn a_word_that_is_no_command_is_a_scene_or_a_command() {
    let folder = Folder::new();
    folder.write("body", SCENE);
    for (word, meant) in [
        ("cubesat.toml", "did you mean `lieflow run cubesat.toml`?"),
        ("body", "did you mean `lieflow run body`?"),
        ("asymmetric-top", "did you mean `lieflow run asymmetric-top`?"),
        ("rnu", "did you mean `lieflow run`?"),
        ("method", "did you mean `lieflow methods`?"),
        ("xxxxxx", "expected one of run, plot, compare"),
    ] {
        let message = folder.lieflow(&[word]).refused();
        assert!(message.contains(&format!("there is no command `{word}`\n{meant}")), "{message}");
    }
    for args in [&["--out", "d", "run", "body"][..], &["--quick", "run", "body"]] {
        let message = folder.lieflow(args).refused();
        assert!(message.contains("options come after the command: `lieflow run"), "{message}");
    }
    // Other mistakes are told as before.
    let message = folder.lieflow(&["run"]).refused();
    assert!(message.contains("<SCENE>"), "{message}");
}

#[test]
fn an_event_is_a_number_and_no_comparison() {
    let folder = Folder::new();
    for (when, help) in [
        ("m2 > 0", "when = \"m2\", direction = \"rising\""),
        ("m2 <= 0.5", "when = \"m2 - (0.5)\", direction = \"falling\""),
        ("m2 == m1", "when = \"m2 - (m1)\"\n"),
    ] {
        let event = format!("[[events]]\nname = \"a\"\nwhen = \"{when}\"\n[output]");
        let message = refused(&folder, "[output]", &event);
        assert!(message.starts_with("error: scene.toml:15:8: events[1].when: "), "{message}");
        let expected = format!("`{when}` is a comparison, expected a number that passes zero");
        assert!(message.contains(&expected) && message.contains(help), "{message}");
    }
}

#[test]
fn events_that_never_come_or_are_missed_are_told() {
    let folder = Folder::new();
    let run = |events: &str| {
        folder.run(&SCENE.replace("every = 10", &format!("every = 1\n{events}"))).ok()
    };
    let event = |when: &str, more: &str| {
        run(&format!("[[events]]\nname = \"z\"\nwhen = \"{when}\"\n{more}"))
    };
    let told = event("0*t", "");
    assert!(told.contains("note: event `z`: its function is zero all the time"), "{told}");
    assert!(told.contains("event z: never\n"), "{told}");
    // It is zero at each row, and not between them.
    let turns = "[[events]]\nname = \"z\"\nwhen = \"1 - cos(2*pi*t)\"\n";
    let told = folder.run(&SCENE.replace("every = 10", &format!("interval = 1\n{turns}"))).ok();
    assert!(told.contains("event z: 3 times") && !told.contains("zero all the time"), "{told}");
    let told = event("sqrt(m1^2 + m2^2 + m3^2) - sqrt(9.04)", "").replace('\n', " ");
    let rounding = told.contains("note: event `z`: its function is zero up to rounding, at most");
    assert!(rounding && !told.contains("WARNING"), "{told}");
    let told = event("t - 100", "");
    assert!(told.contains("note: event `z`: no zero"), "{told}");
    let told = event("t - 1", "stop_after = 2");
    assert!(told.contains("`z`: stop_after = 2 was not reached, it came once"), "{told}");
    // One zero has one time, also on the page.
    assert!(told.contains("event z: once, at t = 1"), "{told}");
    folder.lieflow(&["run", "scene.toml", "--out", "page"]).ok();
    let page = folder.read("page/index.html");
    assert!(page.contains("once, at t = 1") && !page.contains("1 times"), "no words for one zero");
    let told = event("sin(pi*(t - 0.25))", "");
    assert!(told.contains("event z: 2 times, first at t = 0.25"), "{told}");
    // Its period divides the steps.
    let told = event("sin(160*pi*t + 1)", "");
    assert!(told.contains("WARNING: event z: zeros were missed"), "{told}");
    let told = event("sin(160*pi*t + 1)*(t - 0.51)", "stop_after = 9");
    let wrong = "WARNING: event z ended the run at a wrong zero: this run is not usable";
    assert!(told.contains("ended by event z") && told.contains(wrong), "{told}");
    // Long steps know that they may have more zeros, where no row shows it.
    let body = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.1, 1, 0.1]\n\
                [time]\nt_span = [0, 4]\n[[events]]\nname = \"z\"\nwhen = \"sin(RATE*t)\"\n";
    for (rate, is_told) in [("1e6", true), ("40", false)] {
        let told = folder.run(&body.replace("RATE", rate)).ok();
        assert_eq!(told.contains("WARNING: zeros of events may be missed in"), is_told, "{told}");
        assert!(!told.contains("wrong zero"), "{told}");
        let told = folder.run(&(body.replace("RATE", rate) + "stop_after = 3\n")).ok();
        let wrong = "The event z may have ended the run at a wrong zero.";
        assert_eq!(told.contains(wrong), is_told, "{told}");
    }
    // A run back in time that ends where it starts.
    let scene = "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0.3, 0.2, 1]\ndamping = 0.1\n\
                 [time]\nt_span = [0, -20]\n[[events]]\nname = \"z\"\nwhen = \"sin(3*t)\"\nstop_after = 1\n";
    let told = folder.run(scene).ok();
    assert!(told.contains("ended by event z") && !told.contains("WARNING"), "{told}");
    // Nothing is said of events that come, in either direction, also at the times of rows.
    for (when, more) in [
        ("t - 1", "stop_after = 1"),
        ("sin(20*pi*t)", ""),
        ("sin(20*pi*t)", "direction = \"falling\""),
        ("m1 - 0.19", ""),
    ] {
        let told = event(when, more);
        assert!(!told.contains("event z: zeros") && !told.contains("note: event"), "{told}");
    }
}

#[test]
fn a_key_of_another_section_is_told_with_it() {
    let folder = Folder::new();
    // A section that is misspelt is no key of another one.
    let message = refused(&folder, "[time]", "[times]");
    assert!(message.contains("unknown key `times`"), "{message}");
    assert!(message.contains("did you mean `time`?"), "{message}");
    let inertia = "inertia = [1, 2.0, 3.0]";
    for (key, help) in [
        ("times = [1]", "`times` is a key of [output]\n"),
        ("h_max = 1", "`h_max` is a key of [time]\n"),
        ("tableau = \"heun\"", "`tableau` is a key of [method]\n"),
        // What other programs call a key of this section is that key.
        ("J = 1", "did you mean `inertia`?"),
    ] {
        let message = refused(&folder, inertia, &format!("{inertia}\n{key}"));
        assert!(message.contains(help), "{message}");
    }
    for (key, help) in [
        ("rtol = 1e-8", "`rtol` is a key of [time]\n"),
        ("inertia = [1, 2, 3]", "`inertia` is a key of [problem]\n"),
        ("name = \"Body\"", "did you mean `title`?"),
    ] {
        let message = refused(&folder, "[problem]", &format!("{key}\n[problem]"));
        assert!(message.contains(help), "{message}");
    }
}

#[test]
fn an_event_with_an_unknown_name_is_told_the_columns() {
    let folder = Folder::new();
    let told = |when: &str| {
        let scene = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.2, 0, 1]\n\
                     [time]\nt_span = [0, 1]\n[output]\nquantities = [\"attitude\"]\n";
        folder
            .write("scene.toml", &format!("{scene}[[events]]\nname = \"z\"\nwhen = \"{when}\"\n"));
        folder.lieflow(&["run", "scene.toml"]).refused()
    };
    for when in ["omega_body2", "omega_body2 - 0.1", "norm(omega_body) - 1"] {
        let message = told(when);
        assert!(message.contains("the numbers of omega_body are w1, w2, w3"), "{message}");
    }
    let message = told("xxxxxxxx");
    // Of numbered ones the first and the last.
    let listed = "expected one of t, g11 to g13, g21 to g23, g31 to g33, m1 to m3, w1 to w3, qw, qx, qy, qz, a1 to a3, \
                  nutation, ";
    assert!(message.contains(listed), "{message}");
}

#[test]
fn a_comma_and_quotation_marks() {
    let folder = Folder::new();
    let inertia = "inertia = [1, 2.0, 3.0]";
    let message = refused(&folder, inertia, "inertia = [1, 2.0 3.0]");
    assert!(message.contains("= a comma is missing: 2.0, 3.0\n"), "{message}");
    for (kind, quote) in [("“rigid-body”", '“'), ("‘rigid-body’", '‘')] {
        let message = refused(&folder, "\"rigid-body\"", kind);
        let help = format!("`{quote}` is no plain quotation mark: write \"");
        assert!(message.contains("scene.toml:3:8:") && message.contains(&help), "{message}");
    }
}

#[test]
fn a_setting_names_its_section_and_no_line_of_no_file() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let refused =
        |set: &str| folder.lieflow(&["run", "scene.toml", "--set", set, "--out", "out"]).refused();
    for (set, meant) in [
        ("dt=0.1", "time.dt"),
        ("inertia[2]=3", "problem.inertia"),
        ("tableau=heun", "method.tableau"),
        ("evry=3", "output.every"),
        ("tiem.dt=1", "time"),
    ] {
        let message = refused(set);
        assert!(message.contains(&format!("at the top: did you mean `{meant}`?")), "{message}");
    }
    // The line of a setting is in no file.
    let message = refused("time.dt=-1");
    assert!(message.starts_with("error: scene.toml, changed by --set: dt = -1"), "{message}");
    assert!(message.contains("\n | dt = -1\n |      ^^\n"), "{message}");
    // Lines of the file have the numbers of the file, wherever a setting puts them.
    folder.write("scene.toml", &SCENE.replace("every = 10", "evry = 10"));
    let message = refused("problem.quaternion=[1, 0, 0, 0]");
    assert!(message.starts_with("error: scene.toml:15:1: unknown key `evry`"), "{message}");
}

#[test]
fn a_step_that_is_longer_than_the_span_is_told() {
    let folder = Folder::new();
    folder.write("scene.toml", &SCENE.replace("dt = 0.05", "dt = 100"));
    let told = folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    assert!(told.contains("t = 0 to 2, 1 step of 2, 2 rows"), "{told}");
    let warning =
        "WARNING: dt = 100 is longer than t_span, which is 2 long: the run is a single step";
    assert!(told.contains(warning), "{told}");
}

/// What is likely meant is said: a text in another encoding, angles in degrees, a name of another list.
#[test]
fn slips_are_told() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let utf16: Vec<u8> =
        std::iter::once(0xfeff).chain(SCENE.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    std::fs::write(folder.path().join("utf16.toml"), utf16).unwrap();
    let tensor = "problem.inertia=[[1, 2, 0], [2, 1, 0], [0, 0, 1]]";
    for (args, what) in [
        (&["run", "utf16.toml"][..], "the text is UTF-16: save it as UTF-8"),
        (&["run", "scene.toml", "--set", tensor], "the least principal moment of inertia = -"),
        (&["scenes", "--kind", "lorenz"], "`lorenz` is a scene of kind `lyapunov`"),
        (&["scenes", "--kind", "rigid-bdy"], "did you mean `rigid-body`?"),
        (&["methods", "--set", "time.dt=1"], "--set changes a scene: name it with --for"),
        (
            &["order", "scene.toml", "--method", "dopri5"],
            "`dopri5` is a tableau: name it after a method, as in `rkmk dopri5`",
        ),
        (&["order", "scene.toml", "--method", "rkmk5"], "unknown method `rkmk5`; did you mean"),
        (&["order", "scene.toml", "--method", "magnus6"], "no method `magnus6` fits this scene"),
    ] {
        let message = folder.lieflow(args).refused();
        assert!(message.contains(what), "{args:?}: {message}");
    }
    let told = |angle: &str| {
        let set = format!("problem.euler.zyx=[{angle}, 0, 0]");
        folder.lieflow(&["run", "scene.toml", "--no-page", "--set", &set]).ok()
    };
    let note = "euler.zyx has the angle 90, which is more than a turn: angles are in radians. Degrees are written \"90*deg\"";
    let words = told("90").split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(note), "{words}");
    assert!(!told("\"90*deg\"").contains("radians"));
}

#[test]
fn steps_that_pass_ends_of_magnets_are_told() {
    let folder = Folder::new();
    // 1.3 long magnets and steps of 0.25.
    let line = |more: &str| {
        folder.write(
            "line.toml",
            &format!(
                "[problem]\nkind = \"beam-line\"\nparticle = [1, 1, 0, 0]\nelements = [\n\
                 {{ kind = \"quadrupole\", length = 1.3, k = 0.4 }},\n\
                 {{ kind = \"quadrupole\", length = 1.3, k = -0.4 }}]\n\
                 [method]\nname = \"magnus4\"\n[time]\nt_span = [0, 26]\ndt = 0.25\n{more}"
            ),
        );
        folder.lieflow(&["run", "line.toml", "--no-page", "--out", "out"]).ok()
    };
    let told = line("");
    assert!(told.contains("`at_knots = true` in [time] ends a step at each"), "{told}");
    let told = line("at_knots = true");
    assert!(told.contains("digits are right") && !told.contains("ends a step"), "{told}");
}

#[test]
fn a_tolerance_below_rounding_and_very_many_steps_are_refused_at_once() {
    let folder = Folder::new();
    for rtol in ["1e-30", "1e-16"] {
        let message = refused(&folder, "dt = 0.05", &format!("rtol = {rtol}"));
        let words = format!(
            ":12:8: rtol = {rtol}, expected at least {:.0e}, where atol",
            least_rtol::<f64>()
        );
        assert!(message.contains(&words), "{message}");
    }
    folder.write("scene.toml", &SCENE.replace("dt = 0.05", "rtol = 1e-30\natol = 1e-12"));
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let message = refused(&folder, "t_span = [0, 2.0]\ndt = 0.05", "t_span = [0, 5e13]\ndt = 50");
    assert!(message.contains("More than a day needs --yes"), "{message}");
}

#[test]
fn a_pole_of_a_formula_is_named() {
    let folder = Folder::new();
    let torque = "torque = [\"0.01/(t-1.5)\", \"0\", \"0\"]\n[method]";
    let text = SCENE.replace("rigid-body", "driven-body").replace("layer = \"closed\"\n", "");
    let text = text.replace("[method]", torque).replace("dt = 0.05", "rtol = 1e-9");
    folder.write("scene.toml", &text);
    let message = folder.lieflow(&["run", "scene.toml", "--out", "out"]).failed(2);
    let pole = "`torque[1]` has a pole there: it has no finite value at t = 1.5";
    assert!(message.contains(pole), "{message}");
}

/// A run whose attempts are used up is told of the methods for a field of t alone, where it has one and takes none.
#[test]
fn methods_with_larger_steps_are_named() {
    let folder = Folder::new();
    let told = |scene: &str, method: &str| {
        let method = format!("method.name={method}");
        let sets = ["--set", "time.dt=", "--set", "time.max_steps=50", "--set", "time.rtol=1e-9"];
        let args = ["run", scene, "--out", "out", "--set", &method];
        folder.lieflow(&[&args[..], &sets].concat()).failed(2)
    };
    let both = "raise max_steps or the tolerances; or take one of ";
    for scene in ["landau-zener", "rotating-drive", "rotating-field"] {
        let message = told(scene, "\"rkmk dop853\"");
        assert!(message.contains(both) && message.contains("`magnus6`"), "{message}");
        let message = told(scene, "magnus4");
        assert!(message.contains("raise max_steps") && !message.contains("one of"), "{message}");
    }
    // Its field depends on the state.
    let message = told("spin-wave", "\"rkmk dop853\"");
    assert!(message.contains("raise max_steps") && !message.contains("magnus"), "{message}");
}

/// A tensor of inertia in `let`, as a matrix that is written out.
#[test]
fn a_formula_may_have_a_matrix() {
    let folder = Folder::new();
    let text = SCENE.replace("rigid-body", "driven-body").replace("layer = \"closed\"\n", "");
    let run = |torque: &str, lets: &str| {
        let keys = format!("torque = {torque}\nlet = {{ {lets} }}\n[method]");
        folder.run(&text.replace("[method]", &keys))
    };
    let matrix = "J = \"[[0.02, 0, 0], [0, 0.05, 0.01], [0, 0.01, 0.06]]\"";
    run("\"-J*w\"", matrix).ok();
    let by_matrix = folder.read("out/trajectory.csv");
    run("[\"-0.02*w1\", \"-0.05*w2 - 0.01*w3\", \"-0.01*w2 - 0.06*w3\"]", "a = 0").ok();
    let (_, plain) = folder.trajectory();
    for (row, other) in read_csv(&by_matrix).1.iter().zip(&plain) {
        assert!(row.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-14), "{row:?} {other:?}");
    }
    let message = run("\"-J*w\"", "J = \"[[1, 2], [3]]\"").refused();
    assert!(message.contains("found a number, expected a row of 2 numbers"), "{message}");
}

#[test]
fn methods_answers_for_tableaus_maps_and_parts() {
    let folder = Folder::new();
    let told = |name: &str| folder.lieflow(&["methods", name]).ok();
    // What it says a method is for is where it fits.
    for name in
        ["rkmk", "rkmk4", "cf4", "rk", "magnus4", "taylor16", "gauss4", "rkmk-gauss4-symmetric"]
    {
        let fits =
            |scene: &Scene| scene.model().unwrap().fits(&MethodSpec::new(name, None)).is_ok();
        let everywhere =
            BUNDLED.iter().all(|scene| fits(&Scene::parse(scene.name, scene.text).unwrap()));
        let text = told(name);
        let says = ["\n for: every problem\n", "\n needs: "].map(|words| text.contains(words));
        assert!(says[0] != says[1] && (everywhere || says[1]), "{text}");
        assert_eq!(says[0], ["rkmk", "rkmk4", "cf4", "rk"].contains(&name), "{text}");
    }
    let dop853 = told("dop853");
    assert!(dop853.contains("tableau of order 8 with 12 stages"), "{dop853}");
    assert!(dop853.contains("methods that take it: rkmk,"), "{dop853}");
    assert!(told("cay").contains("A coordinate map: "));
    // A method and a tableau.
    let both = told("rk4");
    assert!(both.starts_with("rk4\n classical Runge–Kutta on the entries"), "{both}");
    assert!(both.contains("A Runge–Kutta tableau of order 4 with 4 stages"), "{both}");
    let spelt = told("rkmk dopri5 cay");
    for line in ["rkmk\n", "order: 5\n", "maps: cay\n", "tableaus: dopri5\n"] {
        assert!(spelt.contains(line), "{line}{spelt}");
    }
    let message = folder.lieflow(&["methods", "dop583"]).refused();
    assert!(message.contains("did you mean `dop853`?"), "{message}");
    let message = folder.lieflow(&["methods", "rkmk4 dopri5"]).refused();
    assert!(message.contains("there is no method `rkmk4 dopri5`: "), "{message}");
    let message = folder.lieflow(&["methods", "rkmk4", "--keep", "energy"]).refused();
    assert!(message.contains("'[NAME]' cannot be used with"), "{message}");
}

/// A limit on steps of given size is not raised by a tolerance.
#[test]
fn what_a_limit_on_steps_needs() {
    let folder = Folder::new();
    let told = |steps: &str| {
        let args = ["run", "asymmetric-top", "--out", "out", "--set", "time.max_steps=1"];
        folder.lieflow(&[&args[..], &["--set", steps]].concat()).failed(2)
    };
    let message = told("time.dt=0.25");
    assert!(message.contains("1 attempt did not reach the end: t = 0.25"), "{message}");
    assert!(message.contains("raise max_steps or the step size"), "{message}");
    let message = told("time.dt=");
    assert!(message.contains("raise max_steps or the tolerances"), "{message}");
}

/// The last row has its numbers by the names of the columns.
#[test]
fn the_last_row_is_there_by_name() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let summary = folder.json("out/summary.json");
    let (columns, rows) = folder.trajectory();
    for (end, row) in [("initial", &rows[0]), ("final", &rows[rows.len() - 1])] {
        assert_eq!(summary[end].as_object().unwrap().len(), columns.len());
        for (column, x) in columns.iter().zip(row) {
            let by_name = summary[end][column].as_f64().unwrap();
            assert!((by_name - x).abs() < 1e-15 * (1.0 + x.abs()), "{end}: {column}");
        }
    }
}

/// Where the span is wrong, no value is named that the scene does not have.
#[test]
fn a_span_that_is_too_far_from_zero_is_refused_at_its_place() {
    let folder = Folder::new();
    let text = SCENE.replace("dt = 0.05\n", "");
    for (span, t, gap) in [
        ("[1e16, 10000000000000002]", "1.0000000000000002e16", "2"),
        ("[1e308, inf]", "1e308", "2e292"),
    ] {
        let end = "[[events]]\nname = \"e\"\nwhen = \"m1\"\nstop_after = 1\n[output]";
        let text = text.replace("[0, 2.0]", span).replace("[output]", end);
        folder.write("scene.toml", &text.replace("every = 10\n", ""));
        let message = folder.lieflow(&["run", "scene.toml"]).refused();
        let told = format!(
            "scene.toml:11:10: t_span is too far from t = 0 for its length: near t = {t} the nearest numbers are {gap} apart"
        );
        assert!(message.contains(&told), "{message}");
        assert!(!message.contains("steps") && !message.contains("dt"), "{message}");
    }
}
