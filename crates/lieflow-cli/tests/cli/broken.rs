//! Scenes that cannot be used: one clear message with the line, exit code 2, nothing written.

use crate::support::{Folder, SCENE};

/// Replace a line of the scene, and expect the message to be about this line. The messages are in a snapshot:
/// `cargo insta review` shows those that a change makes different.
const BROKEN: &[(&str, &str, usize)] = &[
    ("inertia = [1, 2.0, 3.0]", "inertai = [1, 2, 3]", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = [1, 2]", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = [1, 2, 3, 4]", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = []", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = 1.0", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = [1, \"two\", 3]", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = [1, nan, 3]", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = [1, 2, -inf]", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = [1, 2, 1e400]", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = [1, -2, 3]", 4),
    ("inertia = [1, 2.0, 3.0]", "inertia = [\n  1,\n  2,\n  0\n]", 7),
    ("inertia = [1, 2.0, 3.0]", "inverse_inertia = [1, 0, 3]", 4),
    ("inertia = [1, 2.0, 3.0]", "", 2),
    ("inertia = [1, 2.0, 3.0]", "inertia = [1, 1, 1]\ninverse_inertia = [1, 1, 1]", 5),
    ("inertia = [1, 2.0, 3.0]", "inertia = [1, 2, 3]\ninertia = [1, 2, 3]", 5),
    ("omega_body = [0.2, 0.0, 1.0]", "omega_body = [1, 1, 1]\nmomentum_body = [1, 1, 1]", 6),
    ("omega_body = [0.2, 0.0, 1.0]", "omega_body = [1, 1, 1e308]", 5),
    (
        "omega_body = [0.2, 0.0, 1.0]",
        "momentum_body = [1, 1, 1]\nattitude = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]",
        6,
    ),
    (
        "omega_body = [0.2, 0.0, 1.0]",
        "momentum_body = [1, 1, 1]\nattitude = [[1, 0, 0], [0, 1, 0], [0, 1, 1]]",
        6,
    ),
    (
        "omega_body = [0.2, 0.0, 1.0]",
        "momentum_body = [1, 1, 1]\nattitude = [[1, 0, 0], [0, 1], [0, 0, 1]]",
        6,
    ),
    ("omega_body = [0.2, 0.0, 1.0]", "momentum_body = [1, 1, 1]\nattitude = [[1, 0, 0]]", 6),
    ("kind = \"rigid-body\"", "kind = \"rigid-bdoy\"", 3),
    ("kind = \"rigid-body\"", "", 2),
    ("kind = \"rigid-body\"", "kind = 7", 3),
    ("name = \"rkmk4\"", "name = \"rkmk5\"", 7),
    ("name = \"rkmk4\"", "name = \"rk4\"", 8),
    ("name = \"rkmk4\"", "name = \"rkmk4\"\ntableau = \"heun\"", 8),
    ("name = \"rkmk4\"", "name = \"rkmk heun cay\"", 8),
    ("name = \"rkmk4\"", "name = \"rkmk heum\"", 7),
    ("name = \"rkmk4\"", "name = \"rkmk heun bs3\"", 7),
    ("name = \"rkmk4\"", "name = \"rkmk\"\ntableau = \"hune\"", 8),
    ("map = \"exp\"", "map = \"exo\"", 8),
    ("map = \"exp\"", "map = \"cay\"\nq = 2", 9),
    ("map = \"exp\"", "q = -1", 8),
    ("layer = \"closed\"", "layer = \"close\"", 9),
    ("layer = \"closed\"", "layers = \"closed\"", 9),
    ("t_span = [0, 2.0]", "t_span = [2, 2.0]", 11),
    ("t_span = [0, 2.0]", "t_span = [0, 3]\nx = 1", 12),
    ("t_span = [0, 2.0]", "t_span = [-1e308, 1e308]", 11),
    ("t_span = [0, 2.0]", "", 10),
    ("dt = 0.05", "dt = -0.05", 12),
    ("dt = 0.05", "dt = 1e-300", 12),
    ("dt = 0.05", "steps = 4\ndt = 0.5", 12),
    ("dt = 0.05", "steps = 0", 12),
    ("dt = 0.05", "rtol = 1e-6\ndt = 0.1", 13),
    ("dt = 0.05", "rtol = -1e-6", 12),
    ("dt = 0.05", "rtol = 0\natol = 0", 12),
    ("dt = 0.05", "dt = 0.05\nh_max = 1", 13),
    ("dt = 0.05", "rtol = 1e-6\nh_max = 0", 13),
    ("dt = 0.05", "rtol = 1e-6\nh_max = 1\nh_min = 2", 14),
    ("dt = 0.05", "rtol = 1e-6\nmax_steps = 0", 13),
    ("map = \"exp\"", "map = \"exp\"\ntableau = \"dopri5\"", 9),
    ("dt = 0.05", "steps = 2.5", 12),
    ("dt = 0.05", "steps = 9223372036854775808", 12),
    ("dt = 0.05", "dt = 1979-05-27", 12),
    ("dt = 0.05", "at_knots = 1\ndt = 0.05", 12),
    ("dt = 0.05", "dt = 0.05\nstops = [0.5, -1]", 13),
    ("dt = 0.05", "dt = 0.05\nstops = [nan]", 13),
    ("dt = 0.05", "steps = 9000000000000000000", 12),
    ("quantities = [\"momentum_body\", \"energy\"]", "quantities = [\"momentum\"]", 14),
    ("quantities = [\"momentum_body\", \"energy\"]", "quantities = [\"energy\", \"energy\"]", 14),
    ("quantities = [\"momentum_body\", \"energy\"]", "quantities = []", 14),
    ("every = 10", "formulas.name = \"m1 + 1\"", 15),
    ("every = 10", "every = 0", 15),
    ("every = 10", "count = 10\ninterval = 0.1", 16),
    ("every = 10", "count = 0", 15),
    ("every = 10", "interval = 0", 15),
    ("every = 10", "interval = 1e-300", 15),
    ("every = 10", "every = 2\ntimes = [1]", 16),
    ("every = 10", "times = [0.5, 0.5]", 15),
    ("every = 10", "times = [0.5, 2.5]", 15),
    ("t_span = [0, 2.0]", "t_span = [0, inf]", 11),
    ("t_span = [0, 2.0]", "t_span = [inf, 2]", 11),
    ("t_span = [0, 2.0]", "t_span = [0, nan]", 11),
    ("dt = 0.05", "rtol = 1e-6\ntolerance = \"per-mile\"", 13),
    ("every = 10", "times_by = \"steps\"", 15),
    ("every = 10", "times = [1]\ntimes_by = \"step\"", 16),
    (
        "[output]",
        "[[events]]\nname = \"flip\"\nwhen = \"m2\"\n[[events]]\nname = \"flip\"\nwhen = \"m1\"\n[output]",
        17,
    ),
    ("[output]", "[[events]]\nname = \" \"\nwhen = \"m2\"\n[output]", 14),
    ("[output]", "[[events]]\nname = \"flip\"\n[output]", 13),
    ("[output]", "[events]\nname = \"flip\"\n[output]", 13),
    ("[output]", "[[events]]\nname = \"flip\"\nwhen = \"energ\"\n[output]", 15),
    ("[output]", "[[events]]\nname = \"flip\"\nwhen = \"m1 + \"\n[output]", 15),
    ("[output]", "[[events]]\nname = \"flip\"\nwhen = \"momentum_body\"\n[output]", 15),
    ("[output]", "[[events]]\nname = \"flip\"\nwhen = \"2*pi\"\n[output]", 15),
    (
        "[output]",
        "[[events]]\nname = \"flip\"\nwhen = \"m2\"\ndirection = \"raising\"\n[output]",
        16,
    ),
    ("[output]", "[[events]]\nname = \"flip\"\nwhen = \"m2\"\nstop_after = 0\n[output]", 16),
    ("[output]", "[[events]]\nname = \"flip\"\nwhen = \"m2\"\nstop = 1\n[output]", 16),
    ("[output]", "[outptu]", 13),
    ("[method]", "[method", 6),
    ("title = \"Test\"", "title = 3", 1),
    ("title = \"Test\"", "title = \"Test\"\ncolour = \"red\"", 2),
];

#[test]
fn a_broken_scene_gets_one_message_with_its_line_and_leaves_nothing() {
    let (folder, mut all) = (Folder::new(), String::new());
    for (good, bad, line) in BROKEN {
        assert_eq!(SCENE.matches(good).count(), 1, "{good}");
        let text = SCENE.replace(good, bad);
        folder.write("broken.toml", &text);
        let message = folder.lieflow(&["run", "broken.toml", "--out", "out"]).refused();
        let place = format!("error: broken.toml:{line}:");
        assert!(message.starts_with(&place), "{bad}: expected line {line}\n{message}");
        let shown = text.lines().nth(line - 1).unwrap();
        assert!(message.contains(&format!("{line} | {shown}\n")), "{bad}\n{message}");
        assert!(message.contains('^'), "{bad}\n{message}");
        assert_eq!(folder.names("."), ["broken.toml"], "{bad}");
        all += &format!("# {good:?} -> {bad:?}\n{message}\n");
    }
    insta::assert_snapshot!(all);
}

/// Every mistake that does not follow from another one is told, in the order of the file.
#[test]
fn all_mistakes_are_told_at_once() {
    let folder = Folder::new();
    let told = |text: &str| -> Vec<String> {
        folder.write("broken.toml", text);
        let message = folder.lieflow(&["run", "broken.toml"]).refused();
        let lines = message.lines().filter(|line| line.contains("broken.toml:"));
        lines.map(|line| line.trim_start_matches("error: ").into()).collect()
    };
    let expect = |text: &str, expected: &[&str]| {
        let told = told(text);
        let several = told.len() == expected.len()
            && told.iter().zip(expected).all(|(line, words)| line.contains(words));
        assert!(several, "{expected:#?}\n{told:#?}");
    };

    // A key that is misspelt is read as the one that is meant, and its value is checked.
    let text = SCENE
        .replace("title", "titel")
        .replace("inertia = [1, 2.0, 3.0]", "inertai = [1, -2, 3]\nshape_ = 3\ncolour = 2")
        .replace("name = \"rkmk4\"", "nmae = \"rkmk5\"")
        .replace("t_span = [0, 2.0]\ndt = 0.05", "t_span = [0, \"two\"]\ndt = -1")
        .replace("[output]", "[outptu]")
        .replace("[\"momentum_body\", \"energy\"]", "[\"momentun\", \"energy\", \"energi\"]");
    let all = [
        "broken.toml: 12 mistakes",
        ":1:1: unknown key `titel`",
        ":4:1: unknown key `inertai`",
        ":5:1: unknown key `shape_`",
        ":5:10: found 3, expected a table",
        ":6:1: unknown key `colour`",
        ":9:1: unknown key `nmae`",
        ":9:8: unknown method `rkmk5`",
        ":13:15: \"two\" is not a number",
        ":14:6: dt = -1",
        ":15:2: unknown key `outptu`",
    ];
    expect(&text, &all);
    // More than ten are counted.
    let more: String = (0..9).map(|i| format!("kkk{i} = 1\n")).collect();
    folder.write("more.toml", &text.replace("t_span", &format!("{more}t_span")));
    let message = folder.lieflow(&["run", "more.toml"]).refused();
    assert!(message.contains("more.toml: 21 mistakes"), "{message}");
    assert!(message.ends_with("\n\nand 11 more\n"), "{message}");

    // What follows from a mistake is none: the kind is unknown, and with it the keys.
    let text = SCENE.replace("rigid-body", "rigid-bodx").replace("inertia", "inertai");
    expect(&text, &[":3:8: unknown kind of problem"]);
    // `k` is there, with a value that cannot be used, so that `k*w1` is right; `l` is not there.
    let keys = "torque = [\"k*w1\", \"0\", \"l\"]\nparameters = { k = \"x\" }\n[method]";
    let text = SCENE.replace("rigid-body", "driven-body").replace("[method]", keys);
    let text = text.replace("layer = \"closed\"\n", "").replace("\"momentum_body\", ", "");
    let all = ["2 mistakes", ":6:24: torque[3]: unknown name `l`", ":7:21: \"x\" is not a number"];
    expect(&text, &all);
    let text = text.replace("\"x\"", "1").replace("k*w1", "k*w9").replace("t_span", "t_spam");
    let all = ["3 mistakes", ":6:11: torque[", ":6:24: torque[", ":12:1: unknown key `t_spam`"];
    expect(&text, &all);
}

/// A name of another program, or in another place, gets the lines to write.
#[test]
fn other_names_are_understood() {
    let folder = Folder::new();
    for (good, bad, words) in [
        (
            "\"rkmk4\"",
            "\"rk45\"",
            "= `rk45` is method `rkmk` with tableau `dopri5`:\n        name = \"rkmk\"\n        \
             tableau = \"dopri5\"\n",
        ),
        (
            "\"rkmk4\"",
            "\"dopri5\"",
            "= `dopri5` is a tableau:\n        name = \"rkmk\"\n        tableau = \"dopri5\"\n",
        ),
        ("\"rkmk4\"", "\"Dop853\"", "`Dop853` is a tableau:"),
        ("\"rkmk4\"", "\"ode45\"", "tableau = \"dopri5\"\n"),
        ("\"rkmk4\"", "\"runge-kutta\"", "= did you mean `rkmk4`?\n"),
        (
            "\"rkmk4\"",
            "\"cay\"",
            "= `cay` is a map:\n        name = \"rkmk4\"\n        map = \"cay\"\n",
        ),
        ("\"exp\"", "\"cayley\"", "did you mean `cay`?"),
        ("\"exp\"", "\"expm\"", "did you mean `exp`?"),
        ("\"momentum_body\"", "\"quat\"", "did you mean `quaternion`?"),
        ("\"momentum_body\"", "\"omega\"", "did you mean `omega_body`?"),
        ("omega_body =", "w0 =", "did you mean `omega_body`?"),
        ("inertia =", "J =", "did you mean `inertia`?"),
        ("dt =", "step_size =", "did you mean `dt`?"),
        ("\"rigid-body\"", "\"satellite\"", "did you mean `driven-body`?"),
    ] {
        assert!(SCENE.contains(good), "{good}");
        folder.write("broken.toml", &SCENE.replace(good, bad));
        let message = folder.lieflow(&["run", "broken.toml"]).refused();
        assert!(message.contains(words), "{bad}: expected {words}\n{message}");
    }
    // A decimal comma.
    let torque = "torque = [\"-0,1*w1\", \"0\", \"0\"]\n[method]";
    let text = SCENE.replace("rigid-body", "driven-body").replace("[method]", torque);
    folder.write("broken.toml", &text.replace("layer = \"closed\"\n", ""));
    let message = folder.lieflow(&["run", "broken.toml"]).refused();
    assert!(
        message.contains("= a number is written with a decimal point, not a comma"),
        "{message}"
    );
    for comma in ["dt = 0,05", "dt = [0,05]"] {
        folder.write("broken.toml", &SCENE.replace("dt = 0.05", comma));
        let message = folder.lieflow(&["run", "broken.toml"]).refused();
        assert!(message.contains("not TOML") && message.contains("= a number is written with"));
    }
    // The names of both parts and of a quantity are wrong: three mistakes.
    let text =
        SCENE.replace("rkmk4", "rk45").replace("\"exp\"", "\"expp\"").replace("energy", "enrgy");
    folder.write("broken.toml", &text);
    let message = folder.lieflow(&["run", "broken.toml"]).refused();
    assert!(message.contains("broken.toml: 3 mistakes"), "{message}");
    // A scene must have a problem and a time.
    folder.write("broken.toml", "title = \"Test\"\n");
    let message = folder.lieflow(&["run", "broken.toml"]).refused();
    for lines in [
        "       [problem]\n       kind = \"rigid-body\"\n",
        "       [time]\n       t_span = [0, 10]\n",
    ] {
        assert!(message.contains(lines), "{message}");
    }
}

/// Another spelling that means one thing is taken for it.
#[test]
fn other_spellings_run() {
    let folder = Folder::new();
    let result = |text: &str| {
        folder.write("scene.toml", text);
        folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
        let method = folder.json("out/summary.json")["method"].clone();
        (folder.read("out/trajectory.csv"), method)
    };
    let expected = result(SCENE);
    let text = SCENE.replace("rigid-body", "Rigid_Body").replace("rkmk4", "RKMK4");
    let text = text.replace("\"exp\"", "\"Exp\"").replace("\"energy\"", "\"Energy\"");
    assert_eq!(result(&text), expected);
    let plotted = SCENE.replace("[output]", "[output]\nplot = [\"Energy\"]");
    assert_eq!(result(&plotted), expected);

    let scene = |group: &str| {
        format!(
            "[problem]\nkind = \"matrix-ode\"\ngroup = \"{group}\"\nfield = [[\"0\", \"-t\"], \
             [\"t\", \"0\"]]\n[time]\nt_span = [0, 1]\nsteps = 4\n"
        )
    };
    let expected = result(&scene("so"));
    for group in ["SO", "SO(2)", "so2", "so( 2 )"] {
        assert_eq!(result(&scene(group)), expected, "{group}");
    }
    folder.write("scene.toml", &scene("SO(4)"));
    let message = folder.lieflow(&["run", "scene.toml"]).refused();
    assert!(message.contains("scene.toml:4:"), "{message}");
    assert!(message.contains("found 2 rows, expected 4 for so(4)"), "{message}");
}

/// Steps that end at the elements of a beam line are as many as these.
#[test]
fn a_span_with_too_many_knots_is_refused() {
    let folder = Folder::new();
    let long = ["run", "fodo-cell", "--out", "out", "--set", "time.t_span=[0, 1e10]", "--set"];
    for set in ["time.at_knots=true", "time.dt="] {
        let message = folder.lieflow(&[&long[..], &[set]].concat()).refused();
        assert!(message.contains("more than 1000000 times in t_span"), "{message}");
    }
    folder.lieflow(&[&long[..], &["time.dt=1e6"]].concat()).ok();
    // A span without an end has magnets without an end.
    let events = "title = \"x\"\n[problem]\nkind = \"beam-line\"\nelements = [{ kind = \"quadrupole\", length = 0.5, k = 1 }, \
                  { kind = \"drift\", length = 1 }]\nparticle = [1e-3, 0, 0, 0]\n[time]\nt_span = [0, inf]\n[[events]]\n\
                  name = \"axis\"\nwhen = \"x\"\nstop_after = 1\n";
    folder.write("endless.toml", events);
    let message = folder.lieflow(&["run", "endless.toml"]).refused();
    assert!(message.contains("expected a span with an end"), "{message}");
}

#[test]
fn a_missing_part_is_named() {
    let folder = Folder::new();
    let without = |from: &str, to: &str| {
        let start = SCENE.find(from).unwrap();
        let end = SCENE.find(to).unwrap_or(SCENE.len());
        format!("{}{}", &SCENE[..start], &SCENE[end..])
    };
    for (text, what) in [
        (String::new(), "missing section [problem]"),
        (without("[problem]", "[method]"), "missing section [problem]"),
        (without("[time]", "[output]"), "missing section [time]"),
    ] {
        folder.write("broken.toml", &text);
        let message = folder.lieflow(&["run", "broken.toml"]).refused();
        assert!(message.contains(&format!("broken.toml: {what}")), "{message}");
        assert_eq!(folder.names("."), ["broken.toml"]);
    }
}

#[test]
fn files_that_are_no_scenes_are_refused() {
    let folder = Folder::new();
    std::fs::write(folder.path().join("latin.toml"), b"title = \"x\"\n# caf\xe9\n").unwrap();
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    for (scene, words) in [
        ("latin.toml", "line 2 is not UTF-8"),
        ("folder", "this is a folder"),
        ("missing.toml", "cannot read the scene"),
        ("asymetric-top", "did you mean `asymmetric-top`?"),
        ("asymmetric-top.toml", "did you mean `asymmetric-top`?"),
    ] {
        for command in [&["run", scene][..], &["methods", "--for", scene]] {
            let message = folder.lieflow(command).refused();
            assert!(message.contains(words), "{message}");
        }
    }
}

/// A file of samples stands beside its scene, wherever the program is run; a run beyond its ends is refused.
#[test]
fn samples_beside_a_scene() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    let problem = "kind = \"matrix-ode\"\ngroup = \"so\"\nsamples = \"rate.csv\"\n\
                   field = [[\"0\", \"-w\"], [\"w\", \"0\"]]";
    let rest = "[method]\nname = \"magnus4\"\n[time]\nt_span = [0, 2]\ndt = 0.5\n[output]\n\
                quantities = [\"point\"]";
    folder.write("data/scene.toml", &format!("title = \"Test\"\n[problem]\n{problem}\n{rest}\n"));
    let run = || folder.lieflow(&["run", "data/scene.toml", "--out", "out"]);
    let message = run().refused();
    let place = "data/scene.toml:5:11: there is no file `rate.csv` beside the scene";
    assert!(message.contains(place), "{message}");
    for (samples, place, what) in [
        ("t,w\n0,1\n1.5,2\n", 10, "t_span = [0, 2], and the samples span 0 to 1.5"),
        ("t,w\n0,1\n2,x\n", 5, "rate.csv, line 3: column w: found `x`, expected a finite number"),
        // All wrong lines at once.
        (
            "t,w\n0,1\n1,x\n\n1,2,3\n-1,2\n2,1\n",
            5,
            "rate.csv, line 3: column w: found `x`, expected a finite number; line 5: found 3 columns, expected 2; \
             line 6: column t: found `-1`, expected more than 0 of the row before\n",
        ),
        (
            "t,w\n0,x\n0,x\n0,x\n0,x\n0,x\n0,x\n0,x\n",
            5,
            "line 6: column w: found `x`, expected a finite number; and 2 lines more\n",
        ),
    ] {
        folder.write("data/rate.csv", samples);
        let message = run().refused();
        assert!(message.contains(&format!("data/scene.toml:{place}:")), "{message}");
        assert!(message.contains(what), "{message}");
        assert_eq!(folder.names("."), ["data"]);
    }
    // The angle is the integral of the lines, 1.
    folder.write("data/rate.csv", "t,w\n0,1\n1,0\n2,1\n");
    run().ok();
    let (_, rows) = folder.trajectory();
    assert!((rows[4][1] - 1f64.cos()).abs() < 1e-14, "{:?}", rows[4]);
}

/// A formula that has no value in a run is named where it ends the run, and so is the first time of a column.
#[test]
fn a_formula_without_a_value_is_named() {
    let folder = Folder::new();
    let text = SCENE.replace("rigid-body", "driven-body").replace("layer = \"closed\"\n", "");
    let torque = "torque = [\"sqrt(1.01 - t)\", \"0\", \"0\"]\n[method]";
    folder.write("scene.toml", &text.replace("[method]", torque));
    let message = folder.lieflow(&["run", "scene.toml", "--out", "out"]).failed(2);
    let lost = "is not finite at stage 2: torque[1] = sqrt(1.01 - t) is NaN at t = 1.025";
    assert!(message.contains(lost), "{message}");
    folder.write("scene.toml", &format!("{text}[output.formulas]\nx = \"sqrt(1.01 - t)\"\n"));
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let warnings = folder.json("out/summary.json")["warnings"].to_string();
    let first = "x is not a finite number in 2 of 5 rows, first at t = 1.5";
    assert!(warnings.contains(first), "{warnings}");
}

#[test]
fn an_output_folder_that_cannot_be_made_is_an_error() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    folder.write("taken", "mine");
    let message = folder.lieflow(&["run", "scene.toml", "--out", "taken"]).failed(1);
    assert!(message.contains("cannot make the folder `taken`"), "{message}");
    assert_eq!(folder.read("taken"), "mine");
    // Where a file has to be, a folder is.
    std::fs::create_dir_all(folder.path().join("out/trajectory.csv")).unwrap();
    let message = folder.lieflow(&["run", "scene.toml", "--out", "out"]).failed(1);
    assert!(message.contains("cannot replace `out/trajectory.csv`"), "{message}");
}

#[test]
fn odd_bytes_are_shown_with_care() {
    let folder = Folder::new();
    for line in
        ["inertia\t=\t[1,\u{1d7d9}]", "ü = 1 # \u{1b}[31m", "inertia = [1, 2]\r", "x = [ # ∞"]
    {
        folder.write("broken.toml", &SCENE.replace("inertia = [1, 2.0, 3.0]", line));
        let message = folder.lieflow(&["run", "broken.toml"]).refused();
        assert!(message.starts_with("error: broken.toml:"), "{message}");
        assert!(!message.contains('\u{1b}'), "{message:?}");
    }
    let long = format!("times = [{}9]", "0.5, ".repeat(20_000));
    folder.write("broken.toml", &SCENE.replace("every = 10", &long));
    let message = folder.lieflow(&["run", "broken.toml"]).refused();
    assert!(message.contains("times[2]") && message.len() < 500, "{message}");
}
