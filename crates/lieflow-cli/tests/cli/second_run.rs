//! What a second run says of the error of a run, and what a run that is wrong is advised to do.

use crate::support::{Folder, read_csv};

/// A point that turns at this rate, by this method, to this time.
fn turning(rate: &str, method: &str, end: &str) -> String {
    format!(
        "[problem]\nkind = \"composed\"\nparts = [{{ name = \"x\", space = \"numbers\", start = [1.0, 0.0], \
         field = [\"{rate}*x2\", \"-{rate}*x1\"] }}]\n[method]\nname = \"{method}\"\n[time]\n\
         t_span = [0, {end}]\ndt = 1.0\n[output]\ncount = 10\n"
    )
}

/// A step that is longer than the span ends with it, and so would half of it: the second run halves what was taken.
#[test]
fn a_step_beyond_the_span_is_halved() {
    let folder = Folder::new();
    let scene = turning("1", "rkmk4", "1");
    folder.write("turn.toml", &scene.replace("[output]\ncount = 10\n", ""));
    for dt in ["1.0", "1.8", "1.999", "2.0", "3.0", "1e9"] {
        let set = format!("time.dt={dt}");
        folder.lieflow(&["run", "turn.toml", "--set", &set, "--out", "out", "--no-page"]).ok();
        let digits = folder.json("out/summary.json")["accuracy"]["digits"].as_u64().unwrap();
        // The error is 8e-3.
        assert_eq!(digits, 2, "dt = {dt}");
    }
}

/// What a run that blew up is advised to do helps: the errors of other runs are not measured by its size.
#[test]
fn advice_after_a_run_that_blew_up_is_right() {
    let folder = Folder::new();
    folder.write("turn.toml", &turning("5", "rk4", "20"));
    for dt in ["0.7", "1.0", "1.5", "2.0"] {
        let set = format!("time.dt={dt}");
        let run = ["run", "turn.toml", "--out", "out", "--no-page", "--set"];
        let told = folder.lieflow(&[&run[..], &[&set]].concat()).ok();
        let Some((_, advice)) = told.split_once("dt = ") else { panic!("dt = {dt}: {told}") };
        let (advised, digits) = advice.split_once(" would give ").unwrap();
        let digits: i32 = digits.split(' ').find_map(|word| word.parse().ok()).unwrap();
        let set = format!("time.dt={advised}");
        folder.lieflow(&[&run[..], &[&set]].concat()).ok();
        let (_, rows) = read_csv(&folder.read("out/trajectory.csv"));
        let last = &rows[rows.len() - 1];
        let error = (last[1] - 100f64.cos()).hypot(last[2] + 100f64.sin());
        assert!(error < 10f64.powi(1 - digits), "dt = {dt}: {advised}, {digits}: {error:e}");
    }
}
