//! The errors that a run states are those of all its rows, and of the times of its events.

use crate::support::Folder;
use serde_json::Value;

/// A body about its middle axis, whose exact motion is known.
const FLIPS: &str = "\
[problem]
kind = \"rigid-body\"
inertia = [1.0, 2.0, 3.0]
omega_body = [0.1, 1.0, 0.1]
[method]
name = \"rkmk\"
tableau = \"dop853\"
[time]
t_span = [0.0, 60.0]
rtol = 1e-12
atol = 1e-13
[output]
interval = 0.05
[[events]]
name = \"flip\"
when = \"w2\"
";

/// The same body under a torque that moves nothing. Its motion is not known to the program.
fn driven() -> String {
    FLIPS.replace("\"rigid-body\"", "\"driven-body\"\nthruster = [1e-30, 0, 0]")
}

/// A run of `scene.toml`: what it says, and its summary.
fn run(folder: &Folder, text: &str, set: &[&str]) -> (String, Value) {
    folder.write("scene.toml", text);
    let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
    let told =
        folder.lieflow(&[&["run", "scene.toml", "--no-page", "--out", "out"], &set[..]].concat());
    (told.ok(), folder.json("out/summary.json"))
}

/// The part of the state of that name.
fn part<'a>(summary: &'a Value, name: &str) -> &'a Value {
    let parts = summary["accuracy"]["parts"].as_array().unwrap();
    parts.iter().find(|part| part["name"] == name).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The largest distance of two trajectories in the columns of one vector, and its time.
fn distance(a: &[Vec<f64>], b: &[Vec<f64>], columns: std::ops::Range<usize>) -> (f64, f64) {
    assert_eq!(a.len(), b.len());
    let of_row = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        assert_eq!(a[0], b[0]);
        let squares = columns.clone().map(|i| (a[i] - b[i]).powi(2));
        (squares.sum::<f64>().sqrt(), a[0])
    };
    a.iter().zip(b).map(of_row).max_by(|x, y| x.0.total_cmp(&y.0)).unwrap()
}

/// Are two errors the same but for a factor, and for rounding?
fn close(a: f64, b: f64, factor: f64) -> bool {
    let rounding = 1e-13;
    a <= factor * b + rounding && b <= factor * a + rounding
}

#[test]
fn every_row_of_a_free_body_is_compared_with_the_exact_motion() {
    let folder = Folder::new();
    let (told, summary) = run(&folder, FLIPS, &[]);
    for what in [
        "\n  event flip: 5 times, first at t = 6.885703083905",
        ", times right to about 3.",
        "\n  error, against the exact motion: momentum_body 1.",
        "e-10 of its size at t = 52.85, at the end ",
        "e-11; attitude ",
        "e-8 degrees at t = 52.85, at the end ",
        "\n  about 9 digits are right\n",
    ] {
        assert!(told.contains(what), "{what}: {told}");
    }
    assert_eq!(
        (&summary["accuracy"]["rows"], &summary["accuracy"]["digits"]),
        (&1201.into(), &9.into())
    );
    let (_, rows) = folder.trajectory();
    run(&folder, FLIPS, &["method.name=exact", "method.tableau="]);
    let (_, exact) = folder.trajectory();
    let (largest, t) = distance(&rows, &exact, 1..4);
    let momentum = part(&summary, "momentum_body");
    assert!((number(&momentum["absolute"]) - largest).abs() < 2e-12, "{momentum} {largest:e}");
    assert_eq!(number(&momentum["t"]), t);
    let at_end = number(&momentum["at_end"]["absolute"]);
    assert!(largest > 3.0 * at_end && at_end > 1e-12, "{momentum}");
}

#[test]
fn an_error_in_the_middle_is_stated_though_the_end_is_right() {
    let folder = Folder::new();
    // The law of control brings the body to rest, and its errors with it.
    let quantities = "output.quantities=[\"attitude\"]";
    let coarse = ["run", "attitude-control", "--no-page", "--out", "out", "--set", quantities];
    let told = folder.lieflow(&coarse).ok();
    let summary = folder.json("out/summary.json");
    let (_, rows) = folder.trajectory();
    let finer = ["--set", "time.dt=0.002", "--set", "output.every=20"];
    folder.lieflow(&[&coarse[..], &finer].concat()).ok();
    let (_, fine) = folder.trajectory();
    let (largest, t) = distance(&rows, &fine, 1..10);
    // Two rotations that are near to each other are an angle times the root of 2 apart.
    let largest = largest / 2.0_f64.sqrt();
    let attitude = part(&summary, "attitude");
    assert!(close(number(&attitude["absolute"]), largest, 1.1), "{attitude}, {largest:e}");
    assert!((number(&attitude["t"]) - t).abs() <= 0.04, "{attitude}, {t}");
    assert!(largest > 1e4 * number(&attitude["at_end"]["absolute"]), "{attitude}");
    // The digits are those of the worst row.
    let digits = -part(&summary, "momentum_space")["relative"].as_f64().unwrap().log10();
    assert_eq!((&summary["accuracy"]["digits"], digits.floor()), (&6.into(), 6.0));
    let when = format!(" degrees at t = {}, at the end ", attitude["t"]);
    assert!(
        told.contains("error, estimated by a second run with each step in two parts, "),
        "{told}"
    );
    assert!(told.contains(&when) && told.contains("about 6 digits are right"), "{told}");
}

#[test]
fn a_run_that_is_poor_in_the_middle_warns_and_what_it_advises_does() {
    let folder = Folder::new();
    let large = ["run", "attitude-control", "--no-page", "--out", "out", "--set"];
    let told =
        folder.lieflow(&[&large[..], &["time.dt=0.4", "--set", "output.every=1"]].concat()).ok();
    let summary = folder.json("out/summary.json");
    let parts = summary["accuracy"]["parts"].as_array().unwrap();
    assert!(parts.iter().all(|part| number(&part["at_end"]["relative"]) < 0.01), "{summary}");
    let (_, warning) = told.split_once("WARNING: `").unwrap_or_else(|| panic!("{told}"));
    assert!(warning.contains(" at t = ") && warning.contains(": this run is "), "{told}");
    let (_, advice) = warning.split_once(". dt = ").unwrap_or_else(|| panic!("{told}"));
    let (dt, digits) = advice.split_once(" would give about ").unwrap();
    let dt = format!("time.dt={dt}");
    folder.lieflow(&[&large[..], &[&dt, "--set", "output.every=1"]].concat()).ok();
    let found = &folder.json("out/summary.json")["accuracy"]["digits"];
    assert_eq!(digits.split_once(' ').unwrap().0, found.to_string(), "{told}");
}

#[test]
fn errors_of_rows_and_of_events_are_estimated_as_they_are() {
    let folder = Folder::new();
    let driven = driven();
    for set in [
        &["time.rtol=1e-6", "time.atol="][..],
        &["time.rtol=1e-9", "time.atol=1e-9"],
        // The smallest tolerances are compared with larger ones.
        &["time.rtol=1e-14", "time.atol="],
        &["method.tableau=rk4", "time.rtol=", "time.atol=", "time.dt=0.1"],
        // Rows between the steps of a long step, and between the first and the last of a limit.
        &["method.tableau=dop853", "time.rtol=", "time.atol=", "time.dt=0.7"],
        &["method.tableau=dopri5", "time.rtol=1e-3", "time.h_max=0.3"],
        // An event ends the run.
        &["time.t_span=[0, inf]", "events[1].stop_after=3"],
        &["time.t_span=[0, -inf]", "events[1].stop_after=3", "time.rtol=1e-7"],
    ] {
        let (_, free) = run(&folder, FLIPS, set);
        let (told, driven) = run(&folder, &driven, set);
        assert_ne!(driven["accuracy"]["found_by"], "exact");
        assert_eq!(free["accuracy"]["rows"], free["rows"]);
        assert_eq!(driven["accuracy"]["rows"], driven["rows"]);
        assert!(!told.contains("zeros in this run"), "{set:?}: {told}");
        let of = |summary: &Value| {
            let attitude = part(summary, "attitude");
            let times = &summary["events"][0]["time_error"];
            [number(&attitude["relative"]), number(&attitude["at_end"]["relative"]), number(times)]
        };
        let (exact, estimate) = (of(&free), of(&driven));
        for (exact, estimate) in exact.iter().zip(estimate) {
            let rounding = 1e-11;
            let good = estimate < 3.0 * exact + rounding && *exact < 3.0 * estimate + rounding;
            assert!(good, "{set:?}: {estimate:e}, exact {exact:e}");
        }
    }
}

#[test]
fn the_error_of_event_times_is_that_against_better_times() {
    let folder = Folder::new();
    let times = |set: &[&str]| {
        let (told, summary) = run(&folder, &driven(), set);
        let text = folder.read("out/events.csv");
        let of = |line: &str| line.split(',').nth(1).unwrap().parse::<f64>().unwrap();
        (
            text.lines().skip(1).map(of).collect::<Vec<_>>(),
            summary["events"][0]["time_error"].clone(),
            told,
        )
    };
    let (coarse, stated, told) = times(&["time.rtol=1e-7", "time.atol=1e-8"]);
    let (fine, ..) = times(&["time.rtol=1e-14", "time.atol="]);
    assert_eq!((coarse.len(), fine.len()), (5, 5));
    let error = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(close(number(&stated), error, 2.0), "{stated}, {error:e}");
    assert!(told.contains(", times right to about "), "{told}");
    // Without a second run nothing is known of them.
    let (_, stated, told) = times(&["output.error_check=false"]);
    assert_eq!(stated, Value::Null);
    assert!(!told.contains("right"), "{told}");
}

#[test]
fn another_number_of_zeros_is_a_warning() {
    let folder = Folder::new();
    // A peak between the ends of two steps is missed. The second run has a point in it.
    let peak = "events[1].when=\"exp(-((t - 20.02078)/0.001)^2) - 0.5\"";
    let set = ["time.rtol=", "time.atol=", "time.dt=0.1", peak];
    let (told, summary) = run(&folder, &driven(), &set);
    let warning = "WARNING: event `flip` has 0 zeros in this run, and 2 in the second run: take smaller steps";
    assert!(told.contains(warning), "{told}");
    assert_eq!(summary["events"][0]["time_error"], Value::Null);
    assert!(summary["warnings"].to_string().contains("event `flip` has "), "{summary}");
}

/// A function whose period divides the steps has the same sign at the end of each. Beside the exact motion and beside a second
/// run its zeros are counted elsewhere.
#[test]
fn zeros_that_all_steps_hide_are_a_warning() {
    let folder = Folder::new();
    let steps = ["time.t_span=[0, 10]", "time.rtol=", "time.atol=", "time.dt=0.1"];
    for (text, others) in [(FLIPS.to_string(), "at least "), (driven(), "200 in the second run")] {
        for (when, hidden) in [("sin(20*pi*t + 1)", true), ("sin(2*pi*t + 1)", false)] {
            let when = format!("events[1].when=\"{when}\"");
            let (told, summary) = run(&folder, &text, &[&steps[..], &[&when]].concat());
            let zeros = if hidden { "has 2 zeros in this run, and " } else { "zeros in this run" };
            let warned = told.lines().any(|line| line.contains(zeros));
            assert_eq!(warned, hidden, "{told}");
            assert_eq!(told.contains(others), hidden, "{told}");
            assert_eq!(summary["events"][0]["time_error"].is_null(), hidden, "{summary}");
        }
    }
}

#[test]
fn columns_that_are_not_written_count_all_the_same() {
    let folder = Folder::new();
    for text in [FLIPS.to_string(), driven()] {
        let parts = |quantities: &str| {
            let set = format!("output.quantities={quantities}");
            run(&folder, &text, &[&set, "time.rtol=1e-9"]).1["accuracy"]["parts"].clone()
        };
        let (few, all) =
            (parts("[\"momentum_norm\"]"), parts("[\"momentum_norm\", \"momentum_body\"]"));
        assert_eq!(few, all);
        assert!(number(&few[0]["absolute"]) > 0.0, "{few}");
    }
}

#[test]
fn of_very_many_rows_some_are_compared_and_the_run_says_so() {
    let folder = Folder::new();
    let (told, summary) = run(&folder, &driven(), &["output.interval=0.001"]);
    assert_eq!((&summary["rows"], &summary["accuracy"]["rows"]), (&60001.into(), &15001.into()));
    assert!(told.contains(", in 15001 of 60001 rows: attitude "), "{told}");
    let (told, summary) = run(&folder, FLIPS, &["output.interval=0.001"]);
    assert_eq!(summary["accuracy"]["rows"], 60001);
    assert!(!told.contains(" of 60001 rows"), "{told}");
}

#[test]
fn the_page_says_what_the_terminal_says() {
    let folder = Folder::new();
    folder.write("scene.toml", FLIPS);
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let page = folder.read("out/index.html");
    for what in [
        "In the worst row about 9 digits are right. The error, against the exact motion: momentum body 1.",
        " of its size at t = 52.85, at the end ",
        "times right to about 3.",
    ] {
        assert!(page.contains(what), "{what}");
    }
}
