//! Runs that are killed, interrupted or cannot write: what they leave is whole, and they go on to the same bits.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::{Folder, Run, SCENE as SHORT, program};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::Value;

/// A run of some seconds; `END` is its end.
const SCENE: &str = r#"title = "Long"
[problem]
kind = "rigid-body"
inertia = [1.0, 2.0, 3.0]
omega_body = [0.01, 1.5, 0.01]
[method]
name = "rkmk4"
layer = "general"
[time]
t_span = [0.0, END]
dt = DT
[[events]]
name = "flip"
when = "w2"
[output]
quantities = ["momentum_body", "energy"]
every = ROW
"#;

/// A debug build takes the same time for a tenth of the steps. A row is at the same times.
fn scene(end: &str) -> String {
    let [dt, row] = if cfg!(debug_assertions) { ["0.01", "5"] } else { ["0.001", "50"] };
    SCENE.replace("END", end).replace("DT", dt).replace("ROW", row)
}

/// What a run writes, without the times that it took.
fn results(folder: &Folder, out: &str) -> (String, String, Value) {
    let mut summary = folder.json(&format!("{out}/summary.json"));
    (summary["wall_time_s"], summary["accuracy"]["seconds"]) = (Value::Null, Value::Null);
    let [rows, events] = ["trajectory", "events"].map(|f| folder.read(&format!("{out}/{f}.csv")));
    (rows, events, summary)
}

struct Reference {
    results: (String, String, Value),
    took: Duration,
}

/// The run without a pause.
static REFERENCE: LazyLock<Reference> = LazyLock::new(|| {
    let folder = Folder::new();
    folder.write("scene.toml", &scene("2500.0"));
    let start = Instant::now();
    folder.lieflow(&["run", "scene.toml", "--out", "out"]).ok();
    Reference { took: start.elapsed(), results: results(&folder, "out") }
});

/// The lines of a file that is there are whole, and those of the run.
fn check_lines(folder: &Folder, name: &str, reference: &str, killed: bool) {
    for file in [format!("{name}.partial.csv"), format!("{name}.csv")] {
        let path = folder.path().join("out").join(&file);
        let Ok(text) = fs::read_to_string(path) else { continue };
        assert!(reference.starts_with(&text), "{file}");
        let may_be_cut = killed && file.contains("partial");
        assert!(may_be_cut || text.is_empty() || text.ends_with('\n'), "{file}: {}", text.len());
    }
}

/// A run in the background.
fn started(folder: &Folder, args: &[&str]) -> Child {
    let mut command = folder.command(args);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until it is so, while the run goes on.
fn until(run: &mut Child, is_so: impl Fn() -> bool) {
    while !is_so() {
        assert!(run.try_wait().unwrap().is_none(), "the run has ended");
        sleep(Duration::from_millis(1));
    }
}

/// Stops the run as Ctrl-C does.
fn interrupt(run: Child) -> Run {
    let kill = Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap();
    assert!(kill.success());
    Run::from(run.wait_with_output().unwrap())
}

/// Kill a run at some moment, see what it left, go on with it, kill that now and then, and go on to the end.
fn kill_and_go_on(random: &mut Pcg64) {
    let Reference { results: expected, took } = &*REFERENCE;
    let folder = Folder::new();
    folder.write("scene.toml", &scene("2500.0"));
    let args = ["run", "scene.toml", "--out", "out", "--resume"];
    for round in 0..3 {
        // Without a state the run was killed before it began, or after its end.
        let resumable = folder.path().join("out/run.state").exists();
        let args = if resumable { &args[..] } else { &args[..4] };
        let (out, err) = (Stdio::null(), Stdio::null());
        let mut child = folder.command(args).stdout(out).stderr(err).spawn().unwrap();
        sleep(took.mul_f64(random.random_range(0.0..0.8)));
        child.kill().unwrap();
        child.wait().unwrap();
        check_lines(&folder, "trajectory", &expected.0, true);
        check_lines(&folder, "events", &expected.1, true);
        if round > 0 || random.random_range(0.0..1.0) < 0.5 {
            break;
        }
    }
    if folder.path().join("out/run.state").exists() {
        folder.lieflow(&args).ok();
    } else {
        folder.lieflow(&args[..4]).ok();
    }
    assert_eq!(results(&folder, "out"), *expected);
    assert_eq!(folder.data("out"), ["events.csv", "summary.json", "trajectory.csv"]);
}

#[test]
fn a_run_that_is_killed_goes_on_to_the_same_bits() {
    let mut random = Pcg64::seed_from_u64(14);
    (0..3).for_each(|_| kill_and_go_on(&mut random));
}

#[test]
#[ignore = "eight minutes; .ci/long runs it: cargo test --release -p lieflow-cli --test cli resume -- --ignored"]
fn a_run_that_is_killed_at_fifty_moments_goes_on_to_the_same_bits() {
    let mut random = Pcg64::seed_from_u64(50);
    (0..50).for_each(|_| kill_and_go_on(&mut random));
}

#[test]
fn an_interrupted_run_says_how_to_go_on() {
    let expected = &REFERENCE.results;
    let folder = Folder::new();
    folder.write("scene.toml", &scene("2500.0"));
    let args = ["run", "scene.toml", "--out", "out"];
    let mut run = started(&folder, &args);
    until(&mut run, || folder.path().join("out/trajectory.partial.csv").exists());
    sleep(REFERENCE.took.mul_f64(0.1));
    // No other run writes into its folder.
    let message = folder.lieflow(&args).refused();
    assert!(message.contains("another run writes into `out`"), "{message}");
    let message = interrupt(run).failed(130);
    assert!(message.contains("error: interrupted at t = "), "{message}");
    assert!(message.contains("`lieflow run scene.toml --out out --resume`"), "{message}");
    let summary = folder.json("out/summary.json");
    assert_eq!(summary["completed"], false);
    let written = folder.read("out/trajectory.partial.csv");
    assert_eq!(summary["rows"].as_u64().unwrap() as usize + 1, written.lines().count());
    check_lines(&folder, "trajectory", &expected.0, false);
    check_lines(&folder, "events", &expected.1, false);

    // The state is that of the end: every row and every event is among its records.
    let state = fs::read(folder.path().join("out/run.state")).unwrap();
    let records = u64::from_le_bytes(state[32..40].try_into().unwrap()) as usize;
    let events = folder.read("out/events.partial.csv");
    assert_eq!(records, written.lines().count() - 1 + events.lines().count() - 1);
    // Another scene does not go on with it, and changes nothing.
    folder.write("other.toml", &scene("2500.5"));
    let message = folder.lieflow(&["run", "other.toml", "--out", "out", "--resume"]).refused();
    assert!(message.contains("the scene has changed"), "{message}");
    assert_eq!(folder.read("out/trajectory.partial.csv"), written);
    // Nor does a state without its rows.
    let [rows, away] = ["out/run.rows", "rows"].map(|name| folder.path().join(name));
    fs::rename(&rows, &away).unwrap();
    let again = [&args[..], &["--resume"]].concat();
    let message = folder.lieflow(&again).refused();
    assert!(message.contains("the saved run in `out` is damaged"), "{message}");
    fs::rename(&away, &rows).unwrap();
    // The same scene in other words does.
    folder.write("scene.toml", &format!("# In other words.\n{}", scene("2500.00")));
    folder.lieflow(&["run", "scene.toml", "--out", "out", "--resume"]).ok();
    assert_eq!(results(&folder, "out"), *expected);

    // Then it is complete, and --resume says so.
    let told = folder.lieflow(&["run", "scene.toml", "--out", "out", "--resume"]).ok();
    assert!(told.contains("is complete"), "{told}");
    assert_eq!(results(&folder, "out"), *expected);
    let message = folder.lieflow(&["run", "other.toml", "--out", "out", "--resume"]).refused();
    assert!(message.contains("no interrupted run"), "{message}");
}

/// What is typed again has the scene, the settings and the options of the call, and the folder of this scene.
#[test]
fn the_hint_to_go_on_repeats_the_call() {
    let took = REFERENCE.took;
    let folder = Folder::new();
    folder.write("a first.toml", &scene("0.1"));
    folder.write("second.toml", &scene("2500.0"));
    let args = ["run", "a first.toml", "second.toml", "--out", "both", "--no-page"];
    let more = ["--error-check", "never", "--set", "title=\"It's long\""];
    let mut run = started(&folder, &[&args[..], &more].concat());
    until(&mut run, || folder.path().join("both/second/trajectory.partial.csv").exists());
    sleep(took.mul_f64(0.1));
    let run = interrupt(run);
    assert_eq!(run.code, Some(130), "{run:?}");
    let hint = "lieflow run second.toml --set 'title=\"It'\\''s long\"' --out both/second --no-page \
                --error-check never --resume";
    assert!(run.err.contains(&format!("`{hint}`")), "{run:?}");
    // It is typed in a shell, and does what it says.
    let typed = hint.replace("lieflow run", &format!("{} run", program().display()));
    let output = Command::new("sh").args(["-c", &typed]).current_dir(folder.path()).output();
    assert!(Run::from(output.unwrap()).ok().starts_with("It's long: "));
    assert_eq!(folder.names("both/second"), ["events.csv", "summary.json", "trajectory.csv"]);
}

/// A comparison writes into its folder as a run does: alone.
#[test]
fn a_comparison_holds_its_folder() {
    let folder = Folder::new();
    folder.write("scene.toml", SHORT);
    fs::create_dir(folder.path().join("out")).unwrap();
    let lock = lieflow_cli::output::Lock::of(&folder.path().join("out")).unwrap();
    let args = ["compare", "scene.toml", "--quick", "--methods", "rkmk4,rk4", "--out", "out"];
    let message = folder.lieflow(&args).refused();
    assert!(message.contains("another run writes into `out`"), "{message}");
    drop(lock);
    folder.lieflow(&args).ok();
}

/// Of several scenes `--resume` begins those that had not begun. Where all fail alike, the exit code is that of one.
#[test]
fn several_scenes_go_on_and_fail_as_one_does() {
    let folder = Folder::new();
    let both = ["run", "a.toml", "b.toml", "--out", "both", "--no-page"];
    ["a.toml", "b.toml"].iter().for_each(|name| folder.write(name, &scene("0.1")));
    folder.write("both", "a file where the folder should be");
    folder.lieflow(&["run", "a.toml", "--out", "both"]).failed(1);
    assert!(folder.lieflow(&both).failed(1).contains("2 of 2 scenes failed"));
    fs::remove_file(folder.path().join("both")).unwrap();
    folder.lieflow(&["run", "a.toml", "--out", "both/a", "--no-page"]).ok();
    let run = folder.lieflow(&[&both[..], &["--resume"]].concat());
    assert!(run.err.contains("note: b begins: it has no interrupted run"), "{run:?}");
    assert!(run.ok().contains("the run of a in `both/a` is complete"));
    assert_eq!(folder.names("both/b"), ["events.csv", "summary.json", "trajectory.csv"]);
}

/// The run is complete when the second one begins: what is lost is the estimate of its error, and `--resume` makes it.
#[test]
fn a_second_run_is_interrupted() {
    let folder = Folder::new();
    let driven = scene("250.0").replace("rigid-body", "driven-body");
    let driven =
        driven.replace("layer = \"general\"", "").replace("[method]", "damping = 1e-6\n[method]");
    folder.write("scene.toml", &driven);
    folder.write("next.toml", &driven);
    let args = ["run", "scene.toml", "next.toml", "--out", "out", "--error-check", "always"];
    let mut run = started(&folder, &args);
    let rows = folder.path().join("out/scene/trajectory.partial.csv");
    let written = || fs::read_to_string(&rows).unwrap_or_default().lines().count();
    until(&mut run, || written() == 5002);
    let run = interrupt(run);
    assert_eq!(run.code, Some(130), "{run:?}");
    assert!(run.out.contains("did not end: it was stopped"), "{run:?}");
    assert!(run.err.contains("interrupted in the second run"), "{run:?}");
    let again = "`lieflow run scene.toml next.toml --out out --error-check always --resume` makes the second run";
    assert!(run.err.contains(again), "{run:?}");
    let summary = folder.json("out/scene/summary.json");
    assert_eq!((&summary["completed"], &summary["accuracy"]), (&true.into(), &Value::Null));
    let rows = folder.read("out/scene/trajectory.csv");
    let names = ["events.csv", "run.rows", "run.state", "summary.json", "trajectory.csv"];
    assert_eq!(folder.data("out/scene"), names);
    folder
        .lieflow(&[
            "run",
            "scene.toml",
            "--out",
            "out/scene",
            "--error-check",
            "always",
            "--resume",
        ])
        .ok();
    let summary = folder.json("out/scene/summary.json");
    assert!(summary["accuracy"]["digits"].is_number(), "{summary}");
    assert_eq!(folder.read("out/scene/trajectory.csv"), rows);
    assert!(!folder.names("out/scene").iter().any(|name| name.starts_with("run.")));
}

/// Work that takes long in one piece, with the file that is there when it has begun: a step of a fluid, a step with ten
/// million rows, the trial of a run, the reference of a comparison.
const HEAVY: [(&str, &str, &str, &str); 4] = [
    (
        "run",
        "out/run.state",
        "kind = \"fluid\"\nsurface = \"sphere\"\nn = 160\nmodes = [[2, 1, 0.3]]",
        "[method]\nname = \"isospectral2\"\n[time]\nt_span = [0.0, 50.0]\ndt = 0.001\n[output]\nevery = 100",
    ),
    (
        "run",
        "out/run.state",
        "kind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.2, 0.0, 1.0]",
        "[method]\nname = \"exact\"\n[time]\nt_span = [0.0, 100.0]\nsteps = 1\n[output]\ninterval = 1e-5",
    ),
    (
        "run",
        "",
        "kind = \"fluid\"\nsurface = \"sphere\"\nn = 96\nmodes = [[2, 1, 0.3], [5, 3, 0.4]]",
        "[method]\nname = \"rkmk\"\ntableau = \"heun\"\n[time]\nt_span = [0.0, 50.0]\nrtol = 1e-11",
    ),
    (
        "compare",
        "out",
        "kind = \"spin-chain\"\nwave = { count = 20000, turns = 1, cone = 0.8 }",
        "[time]\nt_span = [0.0, 1000.0]",
    ),
];

#[test]
fn a_signal_ends_heavy_work_at_once() {
    for (command, begun, problem, rest) in HEAVY {
        let folder = Folder::new();
        folder.write("scene.toml", &format!("[problem]\n{problem}\n{rest}\n"));
        let mut run = started(&folder, &[command, "scene.toml", "--out", "out"]);
        until(&mut run, || folder.path().join(begun).exists());
        sleep(Duration::from_millis(500));
        let clock = Instant::now();
        let run = interrupt(run);
        let took = clock.elapsed();
        assert_eq!(run.code, Some(130), "{problem}: {run:?}");
        assert!(took < Duration::from_secs(2), "{problem}: {took:?}");
    }
}

#[test]
fn a_damaged_state_is_refused() {
    let folder = Folder::new();
    folder.write("scene.toml", &scene("2500.0"));
    let expected = &REFERENCE.results;
    let args = ["run", "scene.toml", "--out", "out", "--resume"];
    let mut child = folder.command(&args[..4]).stdout(Stdio::null()).spawn().unwrap();
    until(&mut child, || folder.names("out").iter().any(|name| name == "run.rows"));
    // Until a state with rows is there.
    until(&mut child, || fs::read(folder.path().join("out/run.state")).unwrap().len() > 64);
    child.kill().unwrap();
    child.wait().unwrap();
    for (file, at) in [("run.state", 3), ("run.state", 100), ("run.rows", 100)] {
        let path = folder.path().join("out").join(file);
        let whole = fs::read(&path).unwrap();
        let mut bytes = whole.clone();
        bytes[at] ^= 1;
        let rows = folder.read("out/trajectory.partial.csv");
        for damaged in [&bytes[..], &whole[..at]] {
            fs::write(&path, damaged).unwrap();
            let message = folder.lieflow(&args).refused();
            assert!(message.contains("is damaged"), "{file}: {message}");
            // What is refused changes nothing.
            assert!(folder.read("out/trajectory.partial.csv") == rows, "{file}");
        }
        fs::write(&path, whole).unwrap();
    }
    folder.lieflow(&args).ok();
    assert_eq!(results(&folder, "out"), *expected);
}

/// The drifts at the ends of steps are no rows. A run that goes on has those of the part before: the steps are so long that
/// the probability grows a thousandfold first, and then falls to 0.
#[test]
fn the_drifts_at_the_ends_of_steps_go_on() {
    let folder = Folder::new();
    let text = "[problem]\nkind = \"schrodinger\"\n\
                hamiltonian = [[\"0\", \"w\"], [\"w\", \"0\"]]\namplitudes = [1, 0]\n\
                [problem.let]\nw = \"0.3 + 2.53*exp(-(t/60000)^2)\"\n\
                [method]\nname = \"rk4\"\n\
                [time]\nt_span = [0, 3000000]\ndt = 1\n\
                [output]\nquantities = [\"probability\"]\ninterval = 1000.37\n";
    folder.write("scene.toml", text);
    let args = ["run", "scene.toml", "--out", "out", "--no-page", "--error-check", "never"];
    let drifts = |folder: &Folder| folder.json("out/summary.json")["drift"].clone();
    folder.lieflow(&args).ok();
    let whole = drifts(&folder);
    let largest = whole["probability"]["max_at_ends_of_steps"].as_f64().unwrap();
    assert!(largest > 100.0, "{whole}");
    kill_and_resume(&folder, &args);
    assert_eq!(drifts(&folder), whole);
}

/// Kills a run into `out` once it has saved a state, and goes on from there.
fn kill_and_resume(folder: &Folder, args: &[&str]) {
    let mut child = folder.command(args).stdout(Stdio::null()).spawn().unwrap();
    until(&mut child, || {
        fs::read(folder.path().join("out/run.state")).is_ok_and(|state| state.len() > 64)
    });
    child.kill().unwrap();
    child.wait().unwrap();
    folder.lieflow(&[args, &["--resume"]].concat()).ok();
}

/// What a run saw between its rows goes on, too. Only before its first state the pitch comes near to 90 degrees, between two
/// rows, and the function of the event is not 0, at the end of a step with a row within it.
#[test]
fn what_was_seen_between_rows_goes_on() {
    let folder = Folder::new();
    let text = r#"[problem]
kind = "rigid-motion"
omega = ["5/cosh(t/300)^2", "rate*cos(roll)", "-rate*sin(roll)"]
velocity = ["1e-3*exp(-((t-100.1)/1e-3)^2)", "0", "0"]
[problem.let]
roll = "1500*tanh(t/300)"
rate = "-1.57*2*(t-60)/225*exp(-((t-60)/15)^2)"
[method]
name = "rkmk4"
[time]
t_span = [0.0, END]
dt = 0.1
[[events]]
name = "pulse"
when = "v1"
[output]
quantities = ["euler_zyx"]
interval = 50.03
error_check = false
"#;
    let end = if cfg!(debug_assertions) { "5e3" } else { "5e4" };
    folder.write("scene.toml", &text.replace("END", end));
    let args = ["run", "scene.toml", "--out", "out", "--no-page"];
    folder.lieflow(&args).ok();
    let whole = results(&folder, "out");
    let notes = whole.2["notes"].to_string();
    assert!(notes.contains("of its singular angle at t = 60.05:"), "{notes}");
    assert!(!notes.contains("event"), "{notes}");
    kill_and_resume(&folder, &args);
    let resumed = results(&folder, "out");
    assert_eq!(resumed.2, whole.2);
    assert_eq!(resumed, whole);
}

/// With a limit of the size of a file, as on a full disk: the error names the file, what was written stays, and the
/// run goes on when there is room.
#[test]
fn a_run_that_cannot_write_keeps_what_it_has() {
    let folder = Folder::new();
    folder.write("scene.toml", &scene("400.0"));
    let lieflow = program();
    let limited =
        format!("trap '' XFSZ; ulimit -f 300; {} run scene.toml --out out", lieflow.display());
    let output = Command::new("sh").args(["-c", &limited]).current_dir(folder.path()).output();
    let message = Run::from(output.unwrap()).failed(1);
    assert!(message.contains("cannot write `out/trajectory.partial.csv`: "), "{message}");
    assert!(message.contains("`lieflow run scene.toml --out out --resume`"), "{message}");
    let written = folder.read("out/trajectory.partial.csv");
    assert!(written.lines().count() > 500, "{}", written.len());
    check_lines(&folder, "trajectory", &REFERENCE.results.0, false);
    folder.lieflow(&["run", "scene.toml", "--out", "out", "--resume"]).ok();
    assert!(REFERENCE.results.0.starts_with(&folder.read("out/trajectory.csv")));
}
