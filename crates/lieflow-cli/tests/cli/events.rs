//! Events in scenes, and output between steps: what is found, what is written, what ends a run.

use crate::support::{Folder, SCENE, read_csv};
use lieflow_model::scene::{BUNDLED, Scene};

/// The names of the events of a run, and the rows beside them.
fn read_events(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let (names, rows): (Vec<String>, Vec<String>) = text
        .lines()
        .map(|line| line.split_once(',').unwrap())
        .map(|(name, row)| (name.to_owned(), row.to_owned()))
        .unzip();
    let (_, rows) = read_csv(&(rows.join("\n") + "\n"));
    (names[1..].to_vec(), rows)
}

/// The scene with this section of events.
fn with_events(events: &str) -> String {
    SCENE
        .replace("[output]", &format!("{events}\n[output]"))
        .replace("omega_body = [0.2, 0.0, 1.0]", "omega_body = [0.01, 1.5, 0.01]")
        .replace("t_span = [0, 2.0]", "t_span = [0, 50.0]")
}

#[test]
fn the_flips_of_a_body_are_found_told_marked_and_end_the_run() {
    let folder = Folder::new();
    let told = folder.lieflow(&["run", "flips", "--out", "out"]).ok();
    assert!(told.contains("ended by event flip\n  event flip: 6 times"), "{told}");
    let text = folder.read("out/events.csv");
    assert!(text.starts_with("name,t,m1,m2,m3,energy\n"), "{text}");
    let (names, rows) = read_events(&text);
    for (name, row) in names.iter().zip(&rows) {
        let [m1, m2, m3] = [row[1], row[2], row[3]];
        let zero = if name == "flip" { m2 } else { m2 * m2 - m1 * m1 - m3 * m3 };
        assert!(zero.abs() < 1e-12, "{name}: {row:?}");
    }
    assert!(rows.windows(2).all(|pair| pair[0][0] < pair[1][0]), "{rows:?}");
    let of = |wanted: &str| names.iter().filter(|name| *name == wanted).count();
    assert_eq!((of("flip"), of("half-way")), (6, 6), "{names:?}");

    let summary = folder.json("out/summary.json");
    let last = rows[rows.len() - 1][0];
    assert_eq!(summary["completed"], true);
    assert_eq!(summary["ended_by"], "flip");
    assert_eq!((&summary["t_end"], &summary["events"][0]["last"]), (&last.into(), &last.into()));
    assert_eq!(summary["events"][1]["count"], 6);
    assert!(summary["t_span"][1].is_null(), "{summary}");
    assert!(summary["error_at_end"]["momentum_body"].as_f64().unwrap() < 1e-3, "{summary}");
    let (_, rows) = folder.trajectory();
    assert_eq!(rows[rows.len() - 1][0], last);
    for figure in ["time-momentum-body", "time-energy", "drift"] {
        let svg = folder.read(&format!("out/{figure}.svg"));
        assert_eq!(svg.matches("<title>flip\n").count(), 6, "{figure}");
        assert!(svg.contains("events: flip (dotted); half-way (dashed)."), "{figure}");
    }
    assert_eq!(
        folder.data("out"),
        ["events.csv", "summary.json", "trajectory.csv"],
        "nothing of the state of the run stays"
    );
}

#[test]
fn directions_choose_and_columns_need_not_be_written() {
    let folder = Folder::new();
    let count = |direction: &str| {
        let events = format!("[[events]]\nname = \"a,b\"\nwhen = \"w2\"\n{direction}");
        let text = with_events(&events).replace("\"momentum_body\", \"energy\"", "\"energy\"");
        folder.write("scene.toml", &text);
        folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
        let text = folder.read("out/events.csv");
        assert!(text.starts_with("name,t,energy\n"), "{text}");
        assert!(text.lines().skip(1).all(|line| line.starts_with("\"a,b\",")), "{text}");
        let summary = folder.json("out/summary.json");
        let times = text.lines().skip(1).map(|line| line.split(',').nth(2).unwrap());
        (summary["events"][0]["count"].clone(), times.map(String::from).collect::<Vec<_>>())
    };
    let (both, times) = count("");
    let (rising, up) = count("direction = \"rising\"");
    let (falling, down) = count("direction = \"falling\"");
    assert_eq!((both, rising, falling), (4.into(), 2.into(), 2.into()));
    assert_eq!([&down[0], &up[0], &down[1], &up[1]], [&times[0], &times[1], &times[2], &times[3]]);
}

/// A scene without events has no file of them, and removes that of an earlier run.
#[test]
fn without_events_there_is_no_file_of_them() {
    let folder = Folder::new();
    folder.write("scene.toml", &with_events("[[events]]\nname = \"flip\"\nwhen = \"m2\""));
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    assert!(folder.names("out").contains(&"events.csv".into()));
    folder.write("scene.toml", &with_events(""));
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    assert_eq!(folder.data("out"), ["summary.json", "trajectory.csv"]);
    assert!(folder.json("out/summary.json")["events"].is_null());
}

/// t and the parameters of the scene are names of a formula, too.
#[test]
fn formulas_of_events_know_t_and_parameters() {
    let folder = Folder::new();
    let bundled = BUNDLED.iter().find(|scene| scene.text.contains("[problem.parameters]")).unwrap();
    let parameters = bundled.text.split("[problem.parameters]\n").nth(1).unwrap();
    let (name, value) = parameters.lines().next().unwrap().split_once('=').unwrap();
    let value: f64 = value.split('#').next().unwrap().trim().parse().unwrap();
    let events = format!("[[events]]\nname = \"late\"\nwhen = \"{name}*(t - 0.0625)\"\n[output]");
    folder.write("scene.toml", &bundled.text.replace("[output]", &events));
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let (_, rows) = read_events(&folder.read("out/events.csv"));
    assert!(value != 0.0 && rows.len() == 1 && rows[0][0] == 0.0625, "{rows:?}");
}

#[test]
fn an_event_that_is_no_number_ends_the_run_with_its_name() {
    let folder = Folder::new();
    folder.write("scene.toml", &with_events("[[events]]\nname = \"odd\"\nwhen = \"ln(m2 - 2)\""));
    let message = folder.lieflow(&["run", "scene.toml", "--out", "out"]).refused();
    assert!(
        message.contains("event `odd` at t = ") && message.contains("ln(m2 - 2) is NaN at m2 = "),
        "{message}"
    );
    assert!(
        message.matches("NaN").count() == 1 && message.contains(", expected a finite number"),
        "{message}"
    );
    assert_eq!(
        folder.data("out"),
        ["events.partial.csv", "summary.json", "trajectory.partial.csv"]
    );
}

#[test]
fn output_times_are_reached_by_dense_output_or_by_steps() {
    let folder = Folder::new();
    let rows = |by: &str| {
        let times = format!("times = [0.512, 1]\n{by}");
        let text = SCENE.replace("every = 10", &times);
        let scene = Scene::parse("scene", &text).unwrap();
        let plan = scene.plan(scene.model().unwrap().schema()).unwrap();
        assert_eq!(plan.times_by_steps, by.contains("steps"));
        folder.write("scene.toml", &text);
        folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
        assert_eq!(folder.json("out/summary.json")["side_steps"], 1);
        folder.trajectory().1
    };
    let [default, dense, steps] = ["", "times_by = \"dense\"", "times_by = \"steps\""].map(rows);
    assert_eq!(default, dense);
    assert_eq!((&dense[0], &dense[2..]), (&steps[0], &steps[2..]));
    let gap = (dense[1][1] - steps[1][1]).abs();
    assert!(gap < 1e-5, "{gap:e}");
}

#[test]
fn a_step_that_does_not_divide_the_span_ends_in_a_shorter_one() {
    let folder = Folder::new();
    let text = SCENE.replace("dt = 0.05", "dt = 0.3").replace("every = 10", "every = 1");
    folder.write("scene.toml", &text);
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    let (_, rows) = folder.trajectory();
    let times: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    assert_eq!((times.len(), times[6], times[7]), (8, 6.0 * 0.3, 2.0));
    let summary = folder.json("out/summary.json");
    assert_eq!((&summary["steps"], &summary["dt"]), (&7.into(), &0.3.into()));
}

#[test]
fn a_span_without_end_has_a_limit_of_steps_and_no_comparison() {
    let folder = Folder::new();
    let text = with_events("[[events]]\nname = \"never\"\nwhen = \"t + 1\"\nstop_after = 1")
        .replace("t_span = [0, 50.0]", "t_span = [0, inf]\nmax_steps = 30");
    folder.write("scene.toml", &text);
    let message = folder.lieflow(&["run", "scene.toml", "--out", "out"]).refused();
    assert!(message.contains("30 attempts did not reach the end"), "{message}");
    let message = folder.lieflow(&["compare", "scene.toml", "--out", "cmp"]).refused();
    assert!(message.contains("a span with an end"), "{message}");
    assert!(folder.names("cmp").is_empty());
}

/// The row of a zero that ends a run is one within a step: what the method keeps there is no promise.
#[test]
fn a_run_that_ends_within_a_step_breaks_no_promise() {
    let folder = Folder::new();
    let scene = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 2.5]\nomega_body = [1.3, 0.16, -0.8]\n\
                 [method]\nname = \"gauss4\"\n[time]\nt_span = [0, 20]\ndt = 0.1\n[output]\nevery = 1\n\
                 [[events]]\nname = \"turned\"\nwhen = \"w2 + 0.25\"\nstop_after = 1\n";
    let told = folder.run(scene).ok();
    assert!(told.contains("ended by event turned"), "{told}");
    assert!(!told.contains("promises to keep it"), "{told}");
    assert!(
        told.contains("`energy` drifted by") && told.contains("at rows within steps"),
        "{told}"
    );
}

/// Numbers of other units in a row say nothing of the rounding of a function: a satellite in metres that swings by 1e-6.
#[test]
fn rounding_of_a_function_is_that_of_its_own_numbers() {
    let folder = Folder::new();
    let scene = |when: &str| {
        format!(
            "[problem]\nkind = \"composed\"\nparameters = {{n = 7.292e-5}}\n[[problem.parts]]\nname = \"r\"\n\
             space = \"numbers\"\nstart = [42164e3, 0]\nfield = [\"-n*r2\", \"n*r1\"]\n[[problem.parts]]\nname = \"th\"\n\
             space = \"numbers\"\nstart = [1e-6, 0]\nfield = [\"th2\", \"-3*n^2*th1\"]\n[time]\nt_span = [0, 864000]\n\
             rtol = 1e-12\n[[events]]\nname = \"turn\"\nwhen = \"{when}\"\n[output]\ncount = 20\n"
        )
    };
    let told = |when: &str| folder.run(&scene(when)).ok();
    let turns = told("th2");
    assert!(turns.contains("event turn: 35 times"), "{turns}");
    assert!(!turns.contains("rounding. Its") && !turns.contains("up to rounding"), "{turns}");
    assert!(turns.contains("times right to about"), "{turns}");
    // A function that is 0 but for rounding: |r|² is constant.
    let none = told("r1^2 + r2^2 - 42164e3^2");
    assert!(none.contains("its function is zero up to rounding"), "{none}");
}

/// A row at the time of a jump has the value after it, and comes before the zero that is told there. No zero is missed.
#[test]
fn a_jump_at_a_row_is_no_missed_zero() {
    let folder = Folder::new();
    folder.write("u.csv", "t,s\n0,1\n1,-1\n2,0.5\n3,0.5\n");
    let held = "samples = \"u.csv\"\ninterpolation = \"previous\"\n";
    for (field, samples, when, stops, zeros) in [
        ("sign(t-1)", "", "sign(t-1)+0.5", "stops = [1]", "once, at t = 1"),
        ("s", held, "s", "", "2 times"),
    ] {
        for output in
            ["interval = 0.5", "times = [1.0, 2.0]", "every = 1", "count = 7", "count = 4"]
        {
            let scene = format!(
                "[problem]\nkind = \"composed\"\n{samples}parts = [{{ name = \"x\", space = \"numbers\", start = [1.0], \
                 field = [\"{field}\"] }}]\n[time]\nt_span = [0, 3]\n{stops}\n[output]\n{output}\n[[events]]\n\
                 name = \"z\"\nwhen = \"{when}\"\n"
            );
            let told = folder.run(&scene).ok();
            assert!(told.contains(&format!("event z: {zeros}")), "{output}: {told}");
            assert!(!told.contains("WARNING"), "{output}: {told}");
        }
    }
}
