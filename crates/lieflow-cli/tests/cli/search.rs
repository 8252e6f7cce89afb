//! What both runs of an estimate pass over: jumps after the last node of a step, and advices that are put through the same
//! search.

use crate::support::Folder;

/// A number x with this derivative, from 1 over the span.
fn scene(field: &str, span: &str, method: &str, time: &str, output: &str) -> String {
    format!(
        "[problem]\nkind = \"composed\"\nparts = [{{ name = \"x\", space = \"numbers\", start = [1.0], field = [\"{field}\"] }}]\n\
         [method]\n{method}\n[time]\nt_span = {span}\n{time}\n[output]\n{output}\n"
    )
}

/// What the program says of a scene, the digits that it states, and the times and values of its rows.
fn run(folder: &Folder, scene: &str) -> (String, Option<u64>, Vec<[f64; 2]>) {
    let told = folder.run(scene).ok();
    let (_, rows) = folder.trajectory();
    (told, folder.digits(), rows.iter().map(|row| [row[0], row[1]]).collect())
}

fn named(method: &str) -> String {
    match method.split_once(' ') {
        Some((name, tableau)) => format!("name = \"{name}\"\ntableau = \"{tableau}\""),
        None => format!("name = \"{method}\""),
    }
}

/// ∫ sign(s − a) ds from 0 to t.
fn sign(a: f64, t: f64) -> f64 {
    if t < a { -t } else { t - 2.0 * a }
}

/// Steps of one size, and a jump after the last node of one: two runs with the same ends of steps are as blind.
#[test]
fn a_jump_between_the_last_node_and_the_end_of_a_step_is_told() {
    let folder = Folder::new();
    for (a, method, dt) in [
        (1.0999, "gauss4", "0.1"),
        (1.0999, "cf3", "0.1"),
        (1.0999, "rk midpoint", "0.1"),
        (1.0999, "rk bs3", "0.1"),
        (1.0999, "rkmk-gauss6", "0.1"),
        (1.0999, "cf-ees25", "0.1"),
        (1.5645, "cf3", "0.005"),
        (3.1599, "midpoint-implicit", "0.0025"),
    ] {
        let field = format!("sign(t-{a})");
        let scene = scene(&field, "[0, 5]", &named(method), &format!("dt = {dt}"), "count = 10");
        let (told, digits, rows) = run(&folder, &scene);
        let [_, end] = rows[rows.len() - 1];
        let off = (end - 1.0 - sign(a, 5.0)).abs() / 4.0;
        assert!(off > 1e-6, "{method}, {a}: {end}");
        assert!(digits.is_some_and(|digits| digits as f64 <= 1.0 - off.log10()), "{off:e}: {told}");
        assert!(told.contains("`stops` in [time]"), "{told}");
    }
    // So many jumps that each is after the last node of its step.
    let scene = scene("sign(sin(7*t))", "[0, 6]", &named("gauss4"), "dt = 2e-4", "count = 10");
    let (told, digits, _) = run(&folder, &scene);
    assert!(digits.is_some_and(|digits| digits <= 6), "{told}");
}

/// Where steps end at the jumps, the run is right and the search is not. So it is where a scene names the jumps.
#[test]
fn steps_that_end_at_the_jumps_are_not_blamed() {
    let folder = Folder::new();
    for method in ["gauss4", "rk midpoint", "rkmk-gauss6"] {
        for (dt, jumps) in [
            ("0.1", [1.0, 3.5]),
            ("0.05", [1.0, 3.5]),
            ("0.02", [1.0, 3.5]),
            ("0.1", [0.123, 4.01]),
        ] {
            let is_aligned = jumps[0] == 1.0;
            let [a, b] = jumps;
            let time = format!(
                "dt = {dt}{}",
                if is_aligned { String::new() } else { format!("\nstops = [{a}, {b}]") }
            );
            let field = format!("sign(t-{a}) + 3*sign(t-{b})");
            let scene = scene(&field, "[0, 5]", &named(method), &time, "count = 10");
            let (told, digits, _) = run(&folder, &scene);
            let is_known =
                digits >= Some(11) && !told.contains("WARNING") && !told.contains("note");
            assert!(is_known, "{method}, {dt}: {told}");
        }
    }
}

/// A pulse as long as a step moves the rows within it. The ends are the same.
#[test]
fn rows_within_a_pulse_are_looked_at() {
    let folder = Folder::new();
    for (size, from, to, method) in [(0.5, 3.92, 4.42, "cf3"), (10.0, 0.521, 1.021, "gauss4")] {
        let field = format!("{size}*(sign(t-{from})-sign(t-{to}))");
        let scene = scene(&field, "[0, 5]", &named(method), "dt = 0.5", "count = 10");
        let (told, digits, rows) = run(&folder, &scene);
        let exact = |t: f64| 1.0 + size * (sign(from, t) - sign(to, t));
        let off = rows.iter().map(|[t, x]| (x - exact(*t)).abs()).fold(0.0, f64::max);
        let largest = 1.0 + 2.0 * size * (to - from);
        assert!(off > 0.01 * largest, "{off}");
        let most = 1.5 - (off / largest).log10();
        assert!(digits.is_some_and(|digits| digits as f64 <= most), "{off}: {told}");
    }
}

/// By the length of a step no step over a jump is short enough: the step there counts as a whole one.
#[test]
fn runs_by_length_pass_a_jump_in_short_steps() {
    let folder = Folder::new();
    let field = "15*(sign(t-4.07)-sign(t-4.12))";
    for (method, rtol) in [("rk dopri5", "1e-4"), ("rkmk dop853", "1e-6"), ("cf4", "1e-5")] {
        let time = format!("rtol = {rtol}\ntolerance = \"per-length\"");
        let (told, digits, rows) =
            run(&folder, &scene(field, "[0, 5]", &named(method), &time, "count = 10"));
        let [_, end] = rows[rows.len() - 1];
        assert!(
            (end - 2.5).abs() < 0.01 || digits <= Some(1) && told.contains("WARNING"),
            "{told}"
        );
        let limited = format!("{time}\nh_max = 0.0025");
        let (told, _, rows) =
            run(&folder, &scene(field, "[0, 5]", &named(method), &limited, "count = 10"));
        let [_, end] = rows[rows.len() - 1];
        assert!((end - 2.5).abs() < 0.01, "{method}: {end}, {told}");
    }
}

/// A search that does not end has met something: no digit is stated.
#[test]
fn a_search_that_takes_far_longer_leaves_the_error_unknown() {
    let folder = Folder::new();
    let field = "0.01*(sign(t-4.44)-sign(t-4.44-0.01))/2";
    let time = "rtol = 1e-4\ntolerance = \"per-length\"";
    let (told, digits, rows) =
        run(&folder, &scene(field, "[0, 5]", &named("cf-ls4"), time, "count = 10"));
    let [_, end] = rows[rows.len() - 1];
    let off = (end - 1.0001_f64).abs();
    assert!(digits.is_none_or(|digits| digits as f64 <= 0.7 - off.log10()), "{off:e}: {told}");
}

/// What an advice promises, its run states, too.
#[test]
fn an_advice_is_searched_like_a_run() {
    let folder = Folder::new();
    for (field, method, time, count) in [
        ("30*(sign(t-4.07)-sign(t-4.12))/2", "rkmk dop853", "rtol = 1e-3", 10),
        ("sign(t-1.003)", "gauss4", "rtol = 1e-6", 10),
        ("20*sign(t-1.9)", "cf3", "steps = 3", 10),
        ("sign(t-0.4)", "gauss6", "steps = 3", 10),
        ("exp(-((t-3.9)/0.02)^2)", "magnus43", "rtol = 1e-5", 10),
        ("(sign(t-0.37)-sign(t-0.42))/2", "cf4", "rtol = 1e-3", 10),
        // Smooth, with rows within steps.
        ("20*cos(5.2*t)", "rk dopri5", "rtol = 1e-2", 37),
        ("20*cos(5.2*t)", "rk dopri5", "rtol = 1e-3\ntolerance = \"per-length\"", 10),
        ("20*cos(5.2*t)", "gauss4", "dt = 0.5", 37),
    ] {
        let output = format!("count = {count}");
        let (told, _, _) = run(&folder, &scene(field, "[0, 5]", &named(method), time, &output));
        let case = format!("{field}, {method}, {time}: {told}");
        let Some((before, after)) = told.split_once(" would give about ") else { continue };
        let promised: u64 = after.split(' ').next().and_then(|n| n.parse().ok()).expect(&case);
        // As `dt = 0.1 instead of `steps``, `rtol = 1e-4 and atol = 1e-4`.
        let setting = before.rsplit(". ").next().unwrap_or_default();
        assert!(!time.contains("steps") || setting.ends_with("instead of `steps`"), "{case}");
        let advised = setting.replace(" instead of `steps`", "").replace(" and ", "\n");
        let rule = if time.contains("tolerance") { "\ntolerance = \"per-length\"" } else { "" };
        let (again, digits, _) = run(
            &folder,
            &scene(field, "[0, 5]", &named(method), &format!("{advised}{rule}"), &output),
        );
        assert!(digits.is_some_and(|digits| digits + 1 >= promised), "{case}\n{setting}: {again}");
    }
}

/// What a scene says of knots, the run by default that is promised has, too.
#[test]
fn a_promise_of_the_default_keeps_at_knots() {
    let folder = Folder::new();
    folder.write(
        "u.csv",
        "t,u\n0,0.1\n0.3,0.4\n1,-0.2\n1.1,0.5\n2.5,0.1\n4,-0.3\n5.5,0.4\n5.6,0.1\n7,0.2\n10,0\n",
    );
    let scene = |method: &str, time: &str| {
        format!(
            "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0.3, 2, 0.1]\n\
             torque = [\"0\", \"-0.1*w2\", \"-0.8*u\"]\nsamples = \"u.csv\"\ninterpolation = \"cubic\"\n{method}\n\
             [time]\nt_span = [0, 10]\nat_knots = false\n{time}\n"
        )
    };
    let (told, _, _) =
        run(&folder, &scene("[method]\nname = \"rk\"\ntableau = \"euler\"", "steps = 3000"));
    let after = told.split("lieflow gives about ").nth(1).expect("a promise");
    let promised: u64 = after.split(' ').next().and_then(|n| n.parse().ok()).expect("digits");
    let (own, digits, _) = run(&folder, &scene("", ""));
    assert!(digits.is_some_and(|digits| digits + 1 >= promised), "{told}\n{own}");
}
