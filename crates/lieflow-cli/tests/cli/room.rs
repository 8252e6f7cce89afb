//! What a run writes: foreseen before it begins, refused where it is too much, and stopped where it was not foreseen.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::support::{Folder, SCENE};
use lieflow_cli::args::ErrorCheck;
use lieflow_cli::cmd::run::{Options, run_scene};
use lieflow_cli::error::CliError;
use lieflow_model::scene::Scene;

/// Run a scene that may write `most` bytes; the message of one that may not.
fn run(scene: &Scene, folder: &Folder, most: u64, resume: bool) -> Result<(), CliError> {
    let options =
        Options { most, resume, no_page: true, error_check: ErrorCheck::Never, any_length: false };
    run_scene(scene, folder.path(), options, &AtomicBool::new(false)).map(drop)
}

/// The number between two words of a message.
fn number_between(message: &str, [before, after]: [&str; 2]) -> f64 {
    let rest = message.split_once(before).unwrap_or_else(|| panic!("{message}")).1;
    rest.split(after).next().unwrap().parse().unwrap_or_else(|_| panic!("{message}"))
}

#[test]
fn the_estimate_is_the_size_of_the_file() {
    let scenes: [(&str, &[&str]); 8] = [
        ("asymmetric-top", &[]),
        ("asymmetric-top", &["output.every=7"]),
        ("asymmetric-top", &["output.every=", "output.interval=0.13"]),
        ("adaptive-top", &["output.times=", "output.count=700"]),
        ("spin-wave", &["time.t_span=[3,1]"]),
        ("vortices-on-sphere", &["output.every=10"]),
        ("shear-layer", &["output.quantities=[\"levels\"]"]),
        ("gyro-record", &[]),
    ];
    for (name, changes) in scenes {
        let settings: Vec<String> = changes.iter().map(|change| (*change).into()).collect();
        let scene = Scene::open_with(Path::new(name), &settings).unwrap();
        let folder = Folder::new();
        let message = run(&scene, &folder, 0, false).unwrap_err().to_string();
        assert!(folder.names(".").is_empty());
        let foreseen = 1e3 * number_between(&message, ["write about ", " kB ("]);
        let rows = number_between(&message, ["kB (", " rows"]);
        run(&scene, &folder, u64::MAX, false).unwrap();
        let written = folder.read("trajectory.csv");
        assert_eq!(rows as usize + 1, written.lines().count(), "{name} {changes:?}");
        let ratio = foreseen / written.len() as f64;
        assert!((0.8..1.2).contains(&ratio), "{name} {changes:?}: {ratio}");
    }
}

#[test]
fn a_run_that_writes_too_much_is_refused() {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    let refused = |interval: &str, more: &[&str]| {
        let interval = format!("output.interval={interval}");
        let args = ["run", "scene.toml", "--set", "output.every=", "--set", &interval];
        folder.lieflow(&[&args, more].concat()).refused()
    };
    // No disk has room for 20 PB.
    let message = refused("1e-14", &["--yes"]);
    assert!(message.contains(". The disk has room for "), "{message}");
    assert!(message.contains("(a larger `every` or `interval`, "), "{message}");
    assert_eq!(folder.names("."), ["scene.toml"]);
    // The disk of the test may have room for this one.
    let message = refused("2.5e-8", &[]);
    let reasons = [". More than 10 GB needs --yes", ". The disk has room for "];
    assert!(reasons.iter().any(|reason| message.contains(reason)), "{message}");
}

/// Steps that are chosen by their error, with a row at each: the number of the rows is not known before.
#[test]
fn a_run_of_unknown_length_stops_at_the_limit_and_goes_on() {
    let text = SCENE.replace("dt = 0.05", "rtol = 1e-9").replace("every = 10", "");
    let text = text.replace("\"rkmk4\"", "\"rkmk\"\ntableau = \"dopri5\"");
    let text = text.replace("t_span = [0, 2.0]", "t_span = [0, 2000.0]");
    let scene = Scene::parse("scene", &text).unwrap();
    let [reference, folder] = [(); 2].map(|()| Folder::new());
    run(&scene, &reference, u64::MAX, false).unwrap();
    let reference = reference.read("trajectory.csv");
    let most = reference.len() as u64 / 2;
    let error = run(&scene, &folder, most, false).unwrap_err();
    assert!(matches!(error, CliError::TooMuch(_)), "{error}");
    assert_eq!(error.exit_code(), 1);
    assert_eq!(folder.names("."), ["run.rows", "run.state", "trajectory.partial.csv"]);
    let written = folder.read("trajectory.partial.csv");
    assert!(reference.starts_with(&written) && written.ends_with('\n'));
    let records = fs::metadata(folder.path().join("run.rows")).unwrap().len();
    // The last records may be in memory yet.
    let all = written.len() as u64 + records;
    assert!((most - most / 4..most + 1000).contains(&all), "{most} {all}");
    run(&scene, &folder, u64::MAX, true).unwrap();
    assert_eq!(folder.read("trajectory.csv"), reference);
}
