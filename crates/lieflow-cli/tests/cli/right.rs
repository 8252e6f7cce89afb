//! `lieflow run`: right by default, and every run says how right it is.

use std::io::Write;
use std::process::Stdio;

use crate::support::{Folder, Run, SCENE, read_csv};
use lieflow_model::scene::BUNDLED;
use serde_json::{Value, json};

/// A book thrown about its middle axis, by a step that is too large.
const CUBESAT: &str = "\
[problem]
kind = \"rigid-body\"
inertia = [0.0026, 0.0103, 0.0108]
omega_body = [0.001, 1.0, 0.001]
quaternion = [1, 0, 0, 0]
[method]
name = \"rkmk4\"
[time]
t_span = [0, 600]
dt = 0.1
[output]
quantities = [\"quaternion\"]
every = 100
";

/// A scene without its method, its steps and its output.
fn stripped(text: &str) -> String {
    let mut section = "";
    let mut kept = String::new();
    for line in text.lines() {
        if line.starts_with('[') {
            section = line;
        }
        let steps = ["dt ", "steps ", "rtol ", "atol ", "tolerance "];
        let is_left = match section {
            "[method]" | "[output]" => true,
            "[time]" => steps.iter().any(|key| line.starts_with(key)),
            _ => line.starts_with("title"),
        };
        if !is_left {
            kept += &format!("{line}\n");
        }
    }
    kept
}

fn relative(summary: &Value) -> f64 {
    let parts = summary["accuracy"]["parts"].as_array().unwrap();
    parts.iter().map(|part| part["relative"].as_f64().unwrap()).fold(0.0, f64::max)
}

/// A body whose numbers are all far below 1, as a molecule in SI units: what a scene leaves out is as right as in units of
/// its own.
#[test]
fn the_unit_of_a_body_does_not_matter() {
    let folder = Folder::new();
    for (unit, tolerances) in [
        ("1", "rtol = atol = 1e-14"),
        ("1e-12", "rtol = 1e-14, atol = 2e-26"),
        ("1e-34", "rtol = 1e-14, atol = 2e-48"),
    ] {
        let text = format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [\"1*u\", \"2*u\", \"2.5*u\"]\n\
             omega_body = [0.1, 1.0, 0]\n[problem.parameters]\nu = {unit}\n[time]\nt_span = [0, 50]\n\
             [output]\nquantities = [\"omega_body\"]\n"
        );
        folder.write("body.toml", &text);
        let told = folder.lieflow(&["run", "body.toml", "--no-page", "--out", "out"]).ok();
        assert!(told.contains(tolerances), "{told}");
        assert!(folder.digits() >= Some(10), "{told}");
    }
}

/// Knots shorten the steps of a run: with half of the step that was asked for it would be the same run again.
#[test]
fn the_second_run_has_shorter_steps_than_knots_leave() {
    let folder = Folder::new();
    let run = |sets: &[&str]| {
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", *set]).collect();
        let args = [&["run", "gyro-record", "--no-page", "--out", "out"], &sets[..]].concat();
        folder.lieflow(&args).ok();
        folder.json("out/summary.json")
    };
    let midpoint = ["method.name=rkmk", "method.tableau=midpoint", "time.at_knots=true"];
    for dt in ["time.dt=0.2", "time.dt=0.1", "time.dt=0.07", "time.dt=0.05"] {
        let summary = run(&[&midpoint[..], &[dt]].concat());
        let stated = summary["accuracy"]["parts"][0]["at_end"]["absolute"].as_f64().unwrap();
        // The matrix at the end is the last row; the reference is that of the default.
        let last = |summary: &Value| {
            let last = &summary["final"];
            let entry = |k: usize| last[format!("g{}{}", k / 3 + 1, k % 3 + 1)].as_f64().unwrap();
            (0..9).map(entry).collect::<Vec<_>>()
        };
        let right = run(&["method.name=rkmk", "method.tableau=dop853", "time.dt=0.001"]);
        let gap =
            last(&summary).iter().zip(last(&right)).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let angle = gap.sqrt() / 2f64.sqrt();
        assert!(
            angle > 1e-3 && angle < 1.5 * stated && stated < 1.5 * angle,
            "{dt}: {stated} {angle}"
        );
    }
}

/// A scene with fewer digits: a chaotic one, in which errors grow.
const FEWER: &[(&str, f64)] = &[("lorenz", 3e-3)];

#[test]
fn eight_digits_are_right_where_a_scene_names_no_method_and_no_steps() {
    let folder = Folder::new();
    let mut wrong = Vec::new();
    for bundled in BUNDLED {
        let name = bundled.name;
        folder.write(&format!("{name}.toml"), &stripped(bundled.text));
        let file = format!("{name}.toml");
        let fewer = FEWER.iter().find(|(other, _)| *other == name);
        let bound = fewer.map_or(1e-8, |(_, bound)| *bound);
        let check = if bound < 1.0 { "always" } else { "never" };
        folder.lieflow(&["run", &file, "--no-page", "--error-check", check, "--out", name]).ok();
        let summary = folder.json(&format!("{name}/summary.json"));
        assert_eq!(summary["title"], name);
        assert_eq!(
            summary["chosen_by_default"],
            json!({ "method": true, "steps": true, "quantities": true, "rows": true }),
            "{name}"
        );
        let warnings = summary["warnings"].to_string();
        assert!(!warnings.contains("pass over"), "{name}: {warnings}");
        let (_, rows) = read_csv(&folder.read(&format!("{name}/trajectory.csv")));
        if summary["t_span"][1].is_number() {
            assert_eq!(rows.len(), 1001, "{name}");
        }
        if bound < 1.0 && relative(&summary) > bound {
            wrong.push(format!("{name}: {}", summary["accuracy"]));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn an_estimated_error_is_that_against_the_exact_motion() {
    let folder = Folder::new();
    // The same body twice: as a free body its motion is known, under a torque that moves nothing it is estimated.
    let free = "kind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.2, 0.1, 1]";
    let driven = free.replace("rigid-body", "driven-body") + "\nthruster = [1e-30, 0, 0]";
    for (method, time) in [
        ("name = \"rkmk4\"", "dt = 0.05"),
        ("name = \"cf4\"", "steps = 100"),
        ("name = \"rkmk\"\ntableau = \"heun\"", "dt = 0.01"),
        ("name = \"rkmk\"\ntableau = \"dopri5\"", "rtol = 1e-8"),
        ("name = \"rkmk\"\ntableau = \"dop853\"", "rtol = 1e-9"),
        // A limit chose the steps, or the first of them.
        ("name = \"rkmk\"\ntableau = \"bs3\"", "rtol = 1e-2\nh_init = 0.5\nh_max = 0.5"),
        ("name = \"rkmk\"\ntableau = \"dopri5\"", "rtol = 1e-3\nh_max = 0.1"),
        ("name = \"rkmk\"\ntableau = \"dopri5\"", "rtol = 1e-6\nh_init = 1e-3\nmax_steps = 66"),
        ("name = \"rkmk\"\ntableau = \"dop853\"", "rtol = 5e-14\nh_max = 0.01"),
        ("", ""),
    ] {
        let error = |problem: &str, name: &str| {
            let text = format!(
                "[problem]\n{problem}\n[method]\n{method}\n[time]\nt_span = [0, 10]\n{time}\n"
            );
            folder.write("scene.toml", &text);
            folder.lieflow(&["run", "scene.toml", "--no-page", "--out", name]).ok();
            let summary = folder.json(&format!("{name}/summary.json"));
            let mut parts = summary["accuracy"]["parts"].as_array().unwrap().iter();
            let attitude = parts.find(|part| part["name"] == "attitude").unwrap();
            let [degrees, radians] =
                ["degrees", "relative"].map(|key| attitude[key].as_f64().unwrap());
            assert!((degrees.to_radians() - radians).abs() <= 1e-12 * radians);
            (summary["accuracy"]["found_by"].clone(), radians)
        };
        let (by, exact) = error(free, "free");
        let (estimated_by, estimate) = error(&driven, "driven");
        assert_eq!(by, "exact");
        let expected = match time {
            "" => "tenfold-tolerance",
            smallest if smallest.starts_with("rtol = 5e-14") => "half-step",
            tolerance if tolerance.starts_with("rtol") => "tenth-tolerance",
            _ => "split-steps",
        };
        assert_eq!(estimated_by, expected, "{method} {time}");
        let rounding = 1e-12;
        let close = estimate < 3.0 * exact + rounding && exact < 3.0 * estimate + rounding;
        assert!(close, "{method} {time}: {estimate:e}, exact {exact:e}");
    }
}

#[test]
fn a_run_that_is_wrong_warns_and_what_it_advises_does() {
    let folder = Folder::new();
    folder.write("cubesat.toml", CUBESAT);
    let told = folder.lieflow(&["run", "cubesat.toml", "--out", "out"]).ok();
    assert!(told.contains("\n  no digit is right\n"), "{told}");
    let warning = "WARNING: `attitude` is wrong by 180 degrees at t = 510: this run is not usable. \
                   dt = 0.005 would give about 4 digits. Leave [method] and the steps out, and lieflow gives";
    assert!(told.contains(warning), "{told}");
    let summary = folder.json("out/summary.json");
    assert_eq!(summary["accuracy"]["digits"], 0);
    assert!(
        warning
            .starts_with(&format!("WARNING: {}", &summary["warnings"][0].as_str().unwrap()[..60]))
    );

    // What it advises.
    let smaller = ["run", "cubesat.toml", "--out", "out", "--set", "time.dt=0.005"];
    let told = folder.lieflow(&smaller).ok();
    assert!(!told.contains("WARNING"), "{told}");
    assert_eq!(folder.json("out/summary.json")["accuracy"]["digits"], 4);
    let left = ["run", "cubesat.toml", "--out", "out", "--set", "time.dt=", "--set", "method="];
    assert!(!folder.lieflow(&left).ok().contains("WARNING"));

    // Under a torque, where no exact motion is known.
    for scene in ["damped-satellite", "gyrostat"] {
        let large = ["run", scene, "--out", "out", "--no-page", "--set", "time.dt=3"];
        let told = folder.lieflow(&large).ok();
        assert!(
            told.contains("WARNING: ") && told.contains(" would give about 4 digits"),
            "{told}"
        );
    }
    // A chaotic motion: no step does.
    let lorenz = ["run", "lorenz", "--out", "out", "--no-page", "--set", "time.t_span=[0, 60]"];
    let told = folder.lieflow(&lorenz).ok();
    assert!(
        told.contains(
            "No step is small enough: small errors grow fast here. Take a shorter t_span"
        ),
        "{told}"
    );
    // A tolerance that is too large.
    let set = ["--set", "method.tableau=dopri5", "--set", "method.name=rkmk", "--set", "time.dt="];
    let loose = ["run", "cubesat.toml", "--out", "out", "--set", "time.rtol=1e-4"];
    let told = folder.lieflow(&[&loose[..], &set[..]].concat()).ok();
    assert!(told.contains("WARNING: `") && told.contains(". rtol = 1e-"), "{told}");
}

/// A thruster that fires for milliseconds in a minute and a half. The steps that the error chooses pass over it, in the run
/// and in the second one. The limit of steps that the warning gives finds it.
#[test]
fn a_pulse_that_all_steps_pass_over_is_told() {
    let folder = Folder::new();
    let run = |rtol: &str, width: f64, middle: f64, limit: &str| {
        let text = format!(
            "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 3]\nmomentum_body = [0.1, 0.2, 0.3]\n\
             torque = [\"5*exp(-((t - {middle})/{width})^2)\", 0, 0]\n\
             [time]\nt_span = [0, 100]\n{rtol}\n{limit}\n"
        );
        let told = folder.run(&text).ok();
        (told, folder.json("out/summary.json"))
    };
    let advice = "h_max = 0.05";
    for (rtol, width, middle) in [
        ("rtol = 1e-6", 0.002, 51.337),
        ("rtol = 1e-9", 0.002, 33.33),
        ("rtol = 1e-9", 0.01, 47.77),
        ("", 0.002, 33.33),
    ] {
        let case = format!("{rtol}, {width} s at {middle}");
        let (told, summary) = run(rtol, width, middle, "");
        assert!(told.contains("WARNING: ") && told.contains(advice), "{case}: {told}");
        assert!(summary["accuracy"]["digits"].as_u64().unwrap() <= 1, "{case}: {told}");
        let (told, summary) = run(rtol, width, middle, advice);
        assert!(!told.contains("WARNING: "), "{case}: {told}");
        assert!(summary["accuracy"]["digits"].as_u64().unwrap() >= 6, "{case}: {told}");
    }
    // The tolerance finds a longer one, and one in which a step happens to end.
    for (rtol, width, found_by) in [
        ("rtol = 1e-9", 0.1, "tenth-tolerance"),
        ("rtol = 1e-9", 0.01, "tenth-tolerance"),
        ("", 0.01, "tenfold-tolerance"),
    ] {
        let (told, summary) = run(rtol, width, 51.337, "");
        assert!(!told.contains("WARNING: "), "{told}");
        assert_eq!(summary["accuracy"]["found_by"], found_by);
        assert!(summary["accuracy"]["digits"].as_u64().unwrap() >= 6, "{told}");
    }
}

/// The steps of the run find this pulse. Those of a second run by their error alone pass over it, and said that the run was
/// wrong by 180 degrees.
#[test]
fn a_pulse_that_the_run_found_is_found_again() {
    for (rtol, width, middle) in [
        ("1e-7", 0.03, 64.148),
        ("1e-6", 0.05, 11.447),
        ("1e-9", 0.02, 50.742),
        ("1e-7", 0.08, 62.947),
    ] {
        let folder = Folder::new();
        let text = format!(
            "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 3]\nmomentum_body = [0.1, 0.2, 0.3]\n\
             torque = [\"5*exp(-((t - {middle})/{width})^2)\", 0, 0]\n\
             [time]\nt_span = [0, 100]\nrtol = {rtol}\n"
        );
        let told = folder.run(&text).ok();
        assert!(!told.contains("WARNING: "), "{middle}: {told}");
        let summary = folder.json("out/summary.json");
        assert_eq!(summary["accuracy"]["found_by"], "tenth-tolerance");
        assert!(summary["accuracy"]["digits"].as_u64().unwrap() >= 4, "{middle}: {told}");
    }
}

#[test]
fn the_error_check_can_be_switched_off() {
    let folder = Folder::new();
    let run = |args: &[&str]| {
        let told = folder.lieflow(&[&["run", "--out", "out", "--no-page"], args].concat()).ok();
        (told, folder.json("out/summary.json"))
    };
    let (told, summary) = run(&["damped-satellite"]);
    assert!(told.contains("estimated by a second run with each step in two parts"), "{told}");
    assert_eq!(summary["accuracy"]["digits"], 8);
    assert_eq!(summary["error_at_end"], Value::Null);
    for off in [["--error-check", "never"], ["--set", "output.error_check=false"]] {
        let (told, summary) = run(&[&["damped-satellite"][..], &off].concat());
        assert!(!told.contains("second run") && !told.contains("right"), "{told}");
        assert_eq!(summary["accuracy"], Value::Null);
    }
    // The exact motion needs no second run.
    let (told, summary) = run(&["asymmetric-top", "--error-check", "never"]);
    assert!(
        told.contains("error, against the exact motion: momentum_body 2.1e-5 of its size at t = 394, at the end 2e-5"),
        "{told}"
    );
    assert_eq!(summary["accuracy"]["digits"], 4);
    // An event ends both runs at the same time.
    let (_, summary) = run(&["flips"]);
    assert!(summary["accuracy"]["digits"].as_u64().unwrap() >= 5, "{}", summary["accuracy"]);
    // The exact motion by its own method: what is left is rounding.
    let (told, _) = run(&["asymmetric-top", "--set", "method.name=exact", "--set", "method.map="]);
    assert!(told.contains("right: the method is exact, the rest is rounding"), "{told}");
}

#[test]
fn rows_at_equal_times_are_asked_for_by_their_number_or_their_distance() {
    let folder = Folder::new();
    let times = |output: &str| {
        folder.run(&SCENE.replace("every = 10", output)).ok();
        let (_, rows) = folder.trajectory();
        rows.iter().map(|row| row[0]).collect::<Vec<_>>()
    };
    assert_eq!(times("count = 4"), [0.0, 0.5, 1.0, 1.5, 2.0]);
    let hundred = times("count = 100");
    assert_eq!((hundred.len(), hundred[100]), (101, 2.0));
    // 49 times a 49th of 2 is less than 2, by rounding.
    assert_eq!(times("count = 49").len(), 50);
    assert_eq!(times("interval = 0.75"), [0.0, 0.75, 1.5, 2.0]);
    assert_eq!(times("interval = 0.1").len(), 21);
    assert_eq!(times("interval = 5.0"), [0.0, 2.0]);
    // Backward, and over a span without an end.
    let set = |name: &str, set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        let run = ["run", name, "--no-page", "--out", "out"];
        folder.lieflow(&[&run[..], &set].concat())
    };
    set("scene.toml", &["time.t_span=[2, 0]", "output.interval=0.75"]).ok();
    let (_, rows) = folder.trajectory();
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [2.0, 1.25, 0.5, 0.0]);
    set("flips", &["output.interval=10"]).ok();
    let (_, rows) = folder.trajectory();
    assert_eq!((rows.len(), rows[7][0]), (9, 70.0));
    let message = set("flips", &["output.count=10"]).refused();
    assert!(
        message.contains("`count` divides a span with an end: expected `interval`"),
        "{message}"
    );
}

/// A jump of f near the end of a step is not seen by methods without a node there, nor by their halves: the digits that a run
/// claims are right all the same.
#[test]
fn a_jump_at_the_end_of_a_step_is_told() {
    let folder = Folder::new();
    let run = |omega: &str, method: &str| {
        let text = format!(
            "[problem]\nkind = \"rigid-motion\"\nomega = [\"0\", \"0\", \"{omega}\"]\n\
             velocity = [\"1\", \"0\", \"0\"]\n[time]\nt_span = [0, 8]\n{method}\n[output]\n\
             quantities = [\"position\", \"attitude\"]\n"
        );
        let told = folder.run(&text).ok();
        let (names, rows) = folder.trajectory();
        let last = |name: &str| rows[rows.len() - 1][names.iter().position(|n| n == name).unwrap()];
        (last("g21").atan2(last("g11")), folder.digits().unwrap() as f64, told)
    };
    for (t0, method, rtol) in [
        (6.995, "magnus4", "1e-6"),
        (3.451, "cf-ees25", "1e-4"),
        (1.293, "cf-ees25", "1e-8"),
        (6.995, "cfm4-2", "1e-6"),
        (2.715, "cg4", "1e-10"),
        (5.0, "cfm6-5", "1e-6"),
        (5.848, "cf-ls3", "1e-10"),
        (2.715, "gauss4", "1e-6"),
        (4.914, "cfm8-11", "1e-4"),
        (5.83, "rkmk dopri5", "1e-6"),
    ] {
        let (name, tableau) = method.split_once(' ').unwrap_or((method, ""));
        let tableau = if tableau.is_empty() { "" } else { "tableau = \"dopri5\"\n" };
        let method = format!("rtol = {rtol}\n[method]\nname = \"{name}\"\n{tableau}");
        let (angle, digits, told) = run(&format!("(1+sign(t-{t0}))/2"), &method);
        let error = 2.0 * (0.5 * (angle - (8.0 - t0))).sin().abs();
        assert!(digits <= 0.7 - error.log10(), "{t0}, {method}: {error:e}, {told}");
    }
    // The rows within a step have seen a pulse that its end has not.
    let pulse = "(sign(t-5.1758)-sign(t-5.1758-0.062))/2";
    let (angle, digits, told) = run(pulse, "");
    assert!((angle - 0.062).abs() < 1e-3 || digits <= 1.0 && told.contains("WARNING"), "{told}");
}

#[test]
fn settings_change_a_scene() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let run = |set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        let run = ["run", "scene.toml", "--no-page", "--out", "out"];
        folder.lieflow(&[&run[..], &set].concat())
    };
    run(&[
        "problem.inertia=[3, 2.0, 1]",
        "problem.inertia[2]=2.5",
        "time.dt=0.1",
        "method.map=cay",
    ])
    .ok();
    let summary = folder.json("out/summary.json");
    assert_eq!((&summary["dt"], &summary["method"]["map"]), (&json!(0.1), &json!("cay")));
    let (_, rows) = folder.trajectory();
    assert_eq!(rows[0][1..4], [0.6000000000000001, 0.0, 1.0]);
    run(&["problem.inertia=[[sqrt(9), 0, 0], [0, 2.5, 0], [0, 0, cos(0)]]"]).ok();
    let (_, rows) = folder.trajectory();
    assert_eq!(rows[0][1..4], [0.6000000000000001, 0.0, 1.0]);
    run(&["method=", "time.dt=", "time.rtol=1e-9"]).ok();
    let summary = folder.json("out/summary.json");
    assert_eq!(summary["method"]["name"], "taylor16");
    assert_eq!(
        (&summary["rtol"], &summary["chosen_by_default"]["steps"]),
        (&json!(1e-9), &json!(false))
    );
    for (set, what) in [
        ("time.dt", "expected key=value, such as time.dt=0.01"),
        ("=3", "expected a key before the `=`"),
        ("time.dtt=1", "unknown key `dtt` in [time]"),
        ("tmie.dt=1", "there is no `tmie` at the top: did you mean `time`?"),
        ("time.dtt=", "there is no `dtt`: did you mean `dt`?"),
        ("problem.inertia[4]=1", "`problem.inertia` has 3 entries"),
        ("problem.inertia[0]=1", "expected a place from 1"),
        ("problem.kind[1]=1", "`problem.kind` is no list"),
        ("problem=1", "`problem` is a section, expected a key in it"),
        ("time.dt=0,1", "`0,1` is no value of TOML"),
        ("time.dt=fast", "\"fast\" is not a number"),
        // A text with parentheses needs no quotes.
        ("problem.group=SO(3)", "unknown key `group` in [problem]"),
        ("problem.inertia={ a = f(2) }", "`{ a = f(2) }` is no value of TOML"),
        ("problem.inertia=[1, f(2), 3]", "unknown function `f`"),
        ("events[1].name=flip", "the scene has no list `events`"),
    ] {
        let message = run(&[set]).refused();
        assert!(message.contains(what), "{set}: {message}");
    }
}

#[test]
fn several_scenes_run_in_one_call() {
    let folder = Folder::new();
    folder.write("a.toml", SCENE);
    folder.write("b.toml", &SCENE.replace("Test", "Second"));
    let told = folder.lieflow(&["run", "a.toml", "b.toml", "--out", "both", "--no-page"]).ok();
    assert!(told.contains("Test: ") && told.contains("Second: "), "{told}");
    for name in ["both/a", "both/b"] {
        assert_eq!(folder.names(name), ["summary.json", "trajectory.csv"]);
    }
    // One that is wrong does not keep the others back.
    folder.write("bad.toml", "[problem]\n");
    let run = folder.lieflow(&["run", "bad.toml", "a.toml"]);
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.out.starts_with("Test: "), "{run:?}");
    for what in ["error: bad.toml:", "1 of 2 scenes failed"] {
        assert!(run.err.contains(what), "{run:?}");
    }
    assert_eq!(folder.data("lieflow-out/a"), ["summary.json", "trajectory.csv"]);
    // Two scenes of one folder are refused before any runs.
    std::fs::create_dir(folder.path().join("other")).unwrap();
    folder.write("other/b.toml", SCENE);
    let scenes = ["run", "a.toml", "b.toml", "other/b.toml", "--out", "none"];
    let message = folder.lieflow(&scenes).refused();
    assert!(message.contains("b.toml and other/b.toml have one folder, `none/b`"), "{message}");
    assert!(!folder.path().join("none").exists());
}

#[test]
fn a_scene_is_read_from_standard_input() {
    let folder = Folder::new();
    let mut command = folder.command(&["run", "-", "--set", "title=Piped"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(SCENE.as_bytes()).unwrap();
    let told = Run::from(child.wait_with_output().unwrap()).ok();
    assert!(told.starts_with("Piped: "), "{told}");
    assert!(folder.names("lieflow-out/stdin").contains(&"index.html".to_string()));
}

#[test]
fn a_run_of_years_is_refused_with_the_time_that_it_would_take() {
    let folder = Folder::new();
    folder.write(
        "scene.toml",
        &SCENE.replace("dt = 0.05", "dt = 1e-14").replace("2.0]\n", "10.0]\n"),
    );
    let message = folder.lieflow(&["run", "scene.toml"]).refused();
    assert!(
        message.contains("scene.toml:12:6: dt = 1e-14: 1e15 steps would take about "),
        "{message}"
    );
    assert!(
        message.contains(" years. More than a day needs --yes\n")
            && message.contains("take a larger step"),
        "{message}"
    );
    assert_eq!(folder.names("."), ["scene.toml"]);
    // Steps that are chosen by their error are foreseen, too.
    let slow =
        ["method.name=rk", "method.map=", "method.tableau=euler", "time.dt=", "time.rtol=1e-13"];
    let slow: Vec<&str> = slow.iter().flat_map(|set| ["--set", set]).collect();
    let limit = ["--set", "time.max_steps=5000", "--set", "time.t_span=[0, 10]"];
    let run = folder.lieflow(&[&["run", "scene.toml"][..], &slow, &limit].concat());
    assert_eq!(run.code, Some(2));
    for what in [
        "note: scene: about ",
        "steps are needed, and the run ends after 5000 (max_steps)",
        "order 1",
    ] {
        assert!(run.err.contains(what), "{}", run.err);
    }
    // An event may end the run earlier.
    let stops = SCENE.replace(
        "[output]",
        "[[events]]\nname = \"turn\"\nwhen = \"m2\"\nstop_after = 1\n[output]",
    );
    folder.write("scene.toml", &stops);
    let run = folder.lieflow(&[&["run", "scene.toml"][..], &slow, &limit].concat());
    assert!(!run.err.contains("note: "), "{}", run.err);
}

#[test]
fn the_help_names_the_files_that_a_run_writes() {
    let folder = Folder::new();
    let help = folder.lieflow(&["run", "--help"]).ok();
    let [complete, partial] = lieflow_cli::output::TRAJECTORY;
    assert!(
        help.contains(&format!(" {complete}")) && help.contains(&format!(" {partial}")),
        "{help}"
    );
    assert!(!help.contains(&format!("{complete}.partial")), "{help}");
}

#[test]
fn without_a_page_none_is_left() {
    let folder = Folder::new();
    folder.lieflow(&["run", "asymmetric-top", "--out", "out"]).ok();
    assert!(folder.names("out").contains(&"index.html".to_string()));
    let told = folder.lieflow(&["run", "asymmetric-top", "--out", "out", "--no-page"]).ok();
    assert!(!told.contains("index.html"), "{told}");
    assert!(!folder.names("out").contains(&"index.html".to_string()));
}

/// Beside a separatrix the exact motion has no digit: the last digits of the start decide where it ends.
#[test]
fn the_exact_motion_has_the_digits_that_its_start_has() {
    let folder = Folder::new();
    let scene = |omega: &str| {
        let text = format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = {omega}\n\
             attitude = [[1,0,0],[0,1,0],[0,0,1]]\n[method]\nname = \"exact\"\n[time]\nt_span = [0, 60]\ndt = 60\n"
        );
        folder.write("scene.toml", &text);
        let told = folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
        (told, folder.digits().unwrap())
    };
    let (told, digits) = scene("[1, 0.3, 0.5773502691896257]");
    assert!(told.contains("the last digits of the start move `attitude` by"), "{told}");
    assert!(digits <= 2, "{told}");
    let (told, digits) = scene("[1, 0.3, 0.7]");
    assert!(!told.contains("last digits") && digits >= 12, "{told}");
}
