//! Degrees and the names of units: what is shown, and what is told of likely slips.

use crate::support::Folder;

const BODY: &str = "[problem]\nkind = \"driven-body\"\ninertia = [\"k/3\", 2, 3]\n\
                    omega_body = [\"5*deg\", \"20*deg\", \"deg\"]\ndamping = 0.1\n\
                    [problem.parameters]\nk = 3\n\
                    [time]\nt_span = [0, \"2*k\"]\n\
                    [output]\nquantities = [\"omega_body\", \"momentum_body\", \"energy\", \"nutation\", \"axis\"]\n\
                    count = 50\n";
const SI: &str = "[units]\ntime = \"s\"\nlength = \"m\"\nmass = \"kg\"\n";

#[test]
fn units_are_words_beside_numbers() {
    let folder = Folder::new();
    folder.write("named.toml", &format!("{SI}{BODY}"));
    folder.write("bare.toml", BODY);
    let named = folder.lieflow(&["run", "named.toml", "--out", "named"]).ok();
    let bare = folder.lieflow(&["run", "bare.toml", "--out", "bare"]).ok();
    assert!(named.contains("t = 0 to 6 s,"), "{named}");
    assert!(bare.contains("t = 0 to 6,"), "{bare}");
    // No number changes, and no name of a column.
    assert_eq!(folder.read("named/trajectory.csv"), folder.read("bare/trajectory.csv"));
    let first = folder.read("bare/trajectory.csv").lines().nth(1).unwrap().to_owned();
    let first: Vec<f64> = first.split(',').map(|x| x.parse().unwrap()).collect();
    let degree = core::f64::consts::PI / 180.0;
    for (x, degrees) in first[1..4].iter().zip([5.0, 20.0, 1.0]) {
        assert!((x - degrees * degree).abs() < 1e-15, "{first:?}");
    }
    let units = &folder.json("named/summary.json")["units"];
    for (name, unit) in [
        ("t", "s"),
        ("w1", "rad/s"),
        ("w3", "rad/s"),
        ("mb2", "kg·m²/s"),
        ("energy", "kg·m²/s²"),
        ("nutation", "rad"),
    ] {
        assert_eq!(units[name], unit, "{units}");
    }
    // t, and each column but those of the axis, which is a direction.
    assert_eq!(units.as_object().unwrap().len(), 1 + 3 + 3 + 1 + 1, "{units}");
    let units = folder.json("bare/summary.json")["units"].to_string();
    assert_eq!(units, "{\"nutation\":\"rad\"}");
    let [with, without] = ["named", "bare"].map(|run| folder.read(&format!("{run}/index.html")));
    assert!(with.contains("(rad/s)") && with.contains("t = 0 to 6 s"), "no unit on the page");
    assert!(!without.contains("rad/s") && without.contains("in the units of the scene"));
    // The chart of the drifts has the unit of time, too.
    let body = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nmomentum_body = [0.2, 0, 3]\n\
                [method]\nname = \"rkmk4\"\n[time]\nt_span = [0, 5]\ndt = 0.1\n";
    folder.write("free.toml", &format!("{SI}{body}"));
    folder.lieflow(&["run", "free.toml", "--out", "free"]).ok();
    assert!(folder.read("free/drift.svg").contains(">t (s)<"));
    // Both pages have the scene as it was written.
    assert!(without.contains("5*deg") && without.contains("2*k"));

    for (units, words) in [
        ("[units]\ntiem = \"s\"\n", "unknown key `tiem`"),
        ("[units]\nangle = \"deg\"\n", "expected \"rad\""),
        ("[units]\nangle = \"deg\"\n", "5*deg"),
        ("[units]\ntime = \"\"\n", "time = \"\""),
        ("[units]\nmass = \"a long word for a kilogram\"\n", "at most 12 characters"),
        ("[units]\ntime = 1\n", "found 1, expected a text"),
        ("[unit]\ntime = \"s\"\n", "did you mean `units`?"),
    ] {
        folder.write("wrong.toml", &format!("{units}{BODY}"));
        let message = folder.lieflow(&["run", "wrong.toml"]).refused();
        assert!(message.contains(words), "{message}");
    }
    folder.write("good.toml", &format!("[units]\nangle = \"rad\"\n{BODY}"));
    folder.lieflow(&["run", "good.toml", "--out", "good"]).ok();
}

/// What is drawn of the files of runs has the units that their scenes name.
#[test]
fn figures_of_files_have_units() {
    let folder = Folder::new();
    for (name, units) in
        [("si", SI), ("again", SI), ("bare", ""), ("min", "[units]\ntime = \"min\"\n")]
    {
        folder.write(&format!("{name}.toml"), &format!("{units}{BODY}"));
        folder.lieflow(&["run", &format!("{name}.toml"), "--no-page"]).ok();
    }
    let plot = |runs: &[&str], columns: &str| {
        let runs: Vec<String> = runs.iter().map(|run| format!("lieflow-out/{run}")).collect();
        let runs: Vec<&str> = runs.iter().map(String::as_str).collect();
        folder.lieflow(&[&["plot"], &runs[..], &["--columns", columns]].concat())
    };
    // Several runs of one unit, and one run: columns of one name and of one unit.
    for runs in [&["si", "again"][..], &["si"]] {
        plot(runs, "w1,energy").ok();
        let [rate, energy] = [1, 2].map(|i| folder.read(&format!("lieflow-plot/plot-{i}.svg")));
        assert!(rate.contains(">t (s)<") && rate.contains(">ω₁ (rad/s)<"), "{rate}");
        assert!(energy.contains("(kg·m²/s²)"), "{energy}");
    }
    // A unit that one of them does not state is on no axis, and that is noted.
    let run = plot(&["si", "bare"], "w1");
    let noted = "note: w1 of `si` in rad/s; `bare` states no unit, so the axis has none";
    assert!(run.err.contains(noted) && run.err.contains("note: t of `si` in s"), "{run:?}");
    let rate = folder.read("lieflow-plot/plot-1.svg");
    assert!(rate.contains(">ω₁<") && !rate.contains("rad/s"), "{rate}");
    // Two units are on no axis.
    let message = plot(&["bare", "si", "min"], "nutation").refused();
    let expected = "t has different units: that of `si` in s, and that of `min` in min.";
    assert!(message.contains(expected), "{message}");
    // An angle has one unit everywhere.
    let run = plot(&["bare", "si"], "nutation");
    assert!(!run.err.contains("nutation"), "{run:?}");
    folder.write("lieflow-out/si/summary.json", "{\"units\": 1}");
    assert!(plot(&["si"], "w1").refused().contains("expected the summary of a run"));
}

#[test]
fn listings_have_dimensions() {
    let folder = Folder::new();
    let listing = folder.lieflow(&["scenes", "driven-body"]).ok();
    let listing = listing.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "angular velocity in the body [angle/time]",
        "angular momentum in space [mass·length²/time]",
        "the sum of the torques, in the body [mass·length²/time²]",
        "5 degrees are \"5*deg\"",
    ] {
        assert!(listing.contains(words), "{words}: {listing}");
    }
}

#[test]
fn numbers_are_set_as_formulas() {
    let folder = Folder::new();
    folder.write("scene.toml", BODY);
    let set =
        ["--set", "problem.omega_body=[\"90*deg\", 0, 0]", "--set", "time.t_span=[0, \"k/3\"]"];
    let told = folder.lieflow(&[&["run", "scene.toml", "--out", "out"][..], &set].concat()).ok();
    assert!(told.contains("t = 0 to 1,"), "{told}");
    let first = folder.json("out/summary.json")["initial"]["w1"].as_f64().unwrap();
    assert_eq!(first, 90.0 * (core::f64::consts::PI / 180.0));
    let set = ["--set", "problem.omega_body=[\"5 deg\", 0, 0]"];
    let message = folder.lieflow(&[&["run", "scene.toml"][..], &set].concat()).refused();
    assert!(message.contains("write 5*deg") && message.contains("changed by --set"), "{message}");
}

/// A body that turns more than once in a step is likely stated in degrees.
#[test]
fn likely_degrees_are_noted() {
    let folder = Folder::new();
    let noted = |units: &str, omega: &str, time: &str, output: &str| {
        let text = format!(
            "{units}[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = {omega}\n\
             [time]\nt_span = [0, 10]\n{time}\n[output]\nquantities = [\"omega_body\"]\n{output}\n"
        );
        folder.write("scene.toml", &text);
        let args = ["run", "scene.toml", "--out", "out", "--no-page", "--error-check", "never"];
        let told = folder.lieflow(&args).ok();
        let notes = folder.json("out/summary.json")["notes"].to_string();
        assert_eq!(told.contains("*deg\""), notes.contains("*deg"), "{told}");
        notes
    };
    let likely = noted("", "[0.1, -40, 20]", "dt = 0.5", "");
    assert!(
        likely.contains("3.6 times in a step of 0.5") && likely.contains("-40*deg"),
        "{likely}"
    );
    let likely = noted(SI, "[0.1, 40, 20]", "", "interval = 0.5");
    assert!(likely.contains("3.6 times from row to row, 0.5 s"), "{likely}");
    let likely = noted(SI, "[5, 20, 1]", "", "");
    assert!(likely.contains("3.3 times in a second") && likely.contains("20*deg"), "{likely}");
    for (units, omega, time, output) in [
        (SI, "[0.5, 5, 1]", "", ""),
        ("", "[5, 20, 1]", "", ""),
        ("", "[0.1, 0.5, 0.2]", "dt = 0.5", ""),
        // As many turns, on purpose.
        ("", "[0.1, \"40*rad\", 20]", "dt = 0.5", ""),
        ("", "[0.1, 40, 20]", "dt = 0.01", ""),
        // Steps that are chosen, and rows in units that are not known.
        ("", "[0.1, 40, 20]", "", "interval = 0.5"),
        ("", "[0.1, 40, 20]", "rtol = 1e-9", ""),
        (SI, "[0.1, 0.5, 0.2]", "", "interval = 10"),
        ("[method]\nname = \"exact\"\n", "[0.1, 40, 20]", "dt = 0.5", ""),
    ] {
        assert_eq!(noted(units, omega, time, output), "[]", "{units} {omega} {time} {output}");
    }
}
