//! What a second run says of the error of a run, and what a run that is wrong is advised to do.

use crate::support::Folder;

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
        let digits = folder.digits().unwrap();
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
        let (_, rows) = folder.trajectory();
        let last = &rows[rows.len() - 1];
        let error = (last[1] - 100f64.cos()).hypot(last[2] + 100f64.sin());
        assert!(error < 10f64.powi(1 - digits), "dt = {dt}: {advised}, {digits}: {error:e}");
    }
}

/// Two runs that miss the same number of zeros, but other ones, do not state the times of these as right.
#[test]
fn zeros_that_are_other_ones_are_told() {
    let folder = Folder::new();
    folder.write(
        "turn.toml",
        "[problem]\nkind = \"matrix-ode\"\ngroup = \"so\"\nfield = [\"-4.637\"]\n[method]\nname = \"magnus6\"\n\
         [time]\nt_span = [0, 20]\nrtol = 1e-8\n[[events]]\nname = \"e\"\nwhen = \"y21 - 0.99\"\n",
    );
    let told = folder.lieflow(&["run", "turn.toml", "--out", "out", "--no-page"]).ok();
    let event = &folder.json("out/summary.json")["events"][0];
    // sin 4.637 t = 0.99 has 30 zeros, from the formula.
    let zeros = (0..20_000).filter(|i| {
        let g = |i: i32| (4.637e-3 * f64::from(i)).sin() - 0.99;
        g(*i) * g(i + 1) < 0.0
    });
    let all = event["count"].as_u64().unwrap() == zeros.count() as u64;
    assert!(all || told.contains("zeros are missed or have no meaning"), "{told}");
}

/// The distance of a pole from the exact one is not that of its slope.
#[test]
fn times_of_poles_are_right() {
    let folder = Folder::new();
    folder.write(
        "body.toml",
        "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.2, 1, 0.3]\n[time]\nt_span = [0, 20]\n\
         [[events]]\nname = \"tangent\"\nwhen = \"tan(t)\"\n[[events]]\nname = \"pole\"\nwhen = \"1/m2\"\n",
    );
    folder.lieflow(&["run", "body.toml", "--out", "out", "--no-page"]).ok();
    for event in folder.json("out/summary.json")["events"].as_array().unwrap() {
        let error = event["time_error"].as_f64().unwrap_or(0.0);
        assert!(event["count"].as_u64() >= Some(3) && error < 1e-6, "{event}");
    }
}

/// Half of a step that is a multiple of the period of a torque is one, too. The two parts of a step have other phases.
#[test]
fn a_period_that_divides_the_steps_is_told() {
    let folder = Folder::new();
    for (dt, is_hidden) in [(0.05, true), (0.1, true), (0.001, false), (0.002, false)] {
        let text = format!(
            "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 3]\nmomentum_body = [0.1, 0.2, 0.3]\n\
             torque = [\"0.1*sin(80*pi*t)^2\", 0, 0]\n[method]\nname = \"rkmk4\"\n\
             [time]\nt_span = [0, 10]\ndt = {dt}\n"
        );
        let told = folder.run(&text).ok();
        let summary = folder.json("out/summary.json");
        let digits = summary["accuracy"]["digits"].as_u64().unwrap();
        assert_eq!(digits <= 1, is_hidden, "{dt}: {told}");
        assert_eq!(told.contains("WARNING: `attitude` is wrong by "), is_hidden, "{dt}: {told}");
    }
}

/// A torque that jumps between two steps of one size jumps between their parts, too.
#[test]
fn a_jump_between_two_steps_is_none_within_a_part() {
    let folder = Folder::new();
    for torque in ["0.1*sign(t - 1)", "0.1*sign(sin(10*pi*t))"] {
        let text = format!(
            "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 3]\nomega_body = [0.4, 0.5, 0.3]\n\
             torque = [\"{torque}\", 0, 0]\n[method]\nname = \"gauss4\"\n\
             [time]\nt_span = [0, 5]\ndt = 0.01\n"
        );
        let told = folder.run(&text).ok();
        let accuracy = &folder.json("out/summary.json")["accuracy"];
        assert!(accuracy["digits"].as_u64().unwrap() >= 8, "{told}");
        assert!(!told.contains("WARNING"), "{told}");
    }
}
