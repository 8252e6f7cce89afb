//! The advice of `lieflow methods --for` and of docs/choose.md, beside measured runs. Counts and errors do not depend on the
//! machine, so they are compared, and not times. A Lie series runs in SIMD lanes and a Magnus method has costly brackets, so
//! counts say less of them, and their factor is larger.

use crate::support::Folder;
use serde_json::Value;

/// The method that is advised for this want, or else the default.
fn advised(folder: &Folder, scene: &str, want: &str) -> String {
    let told = folder.lieflow(&["methods", "--for", scene]).ok();
    let row =
        |want: &str| told.lines().find_map(|line| line.trim().strip_prefix(want).map(str::trim));
    let take = row(want).or_else(|| row("nothing special")).unwrap();
    take.split("  ").next().unwrap().trim_end_matches(" (the default)").to_string()
}

/// The count of a run to this error, between two runs on a line through the logarithms.
fn count_to(error: f64, count: &str, curve: &Value) -> Option<f64> {
    let mut points: Vec<_> = curve["points"].as_array().unwrap().iter().collect();
    let number = |point: &Value, key: &str| point[key].as_f64();
    points.retain(|p| p["failure"].is_null() && number(p, "error").is_some_and(|e| e > 0.0));
    let of = |p: &Value| Some((number(p, "error")?.ln(), number(p, count)?.ln()));
    points.windows(2).find_map(|pair| {
        let [(e0, n0), (e1, n1)] = [of(pair[0])?, of(pair[1])?];
        let share = (e0 - error.ln()) / (e0 - e1);
        (e0 > error.ln() && error.ln() >= e1).then(|| (n0 + share * (n1 - n0)).exp())
    })
}

#[test]
fn the_advice_takes_few_evaluations_or_operations() {
    const RKMK: &[&str] = &["rkmk4 exp", "rkmk4 cay", "rkmk dopri5 exp", "rkmk dop853 exp", "cf4"];
    const BODY: &[&str] = &["rkmk4 cay", "rkmk dopri5 exp", "rkmk dop853 exp", "taylor5"];
    const LINEAR: &[&str] = &["magnus4", "magnus6", "cfm4-2", "rkmk4 exp", "rkmk dop853 exp"];
    const SPIN: &[&str] = &["magnus4", "magnus6", "cfm4-2", "cfm6-5", "rkmk dop853 exp"];
    let folder = Folder::new();
    for (scene, count, most, rivals) in [
        ("asymmetric-top", "operations", 1.5, BODY),
        ("damped-satellite", "evaluations", 1.25, RKMK),
        ("nutating-top", "evaluations", 1.25, RKMK),
        ("spin-wave", "evaluations", 1.25, RKMK),
        ("toda-lattice", "operations", 1.25, RKMK),
        ("sorting", "operations", 1.25, RKMK),
        ("rotating-field", "operations", 2.0, SPIN),
        ("stirap", "operations", 2.0, LINEAR),
        ("coupled-oscillators", "operations", 2.0, LINEAR),
    ] {
        for (want, error) in [("rough answers, soon", 1e-3), ("small errors", 1e-9)] {
            let mut advised = advised(&folder, scene, want);
            if advised.starts_with("rkmk") && advised.split(' ').count() == 2 {
                advised += " exp";
            }
            let methods = [&[advised.as_str()], rivals].concat().join(",");
            let asked = format!("{error:e}");
            let args = ["compare", scene, "--quick", "--all", "--error", &asked, "--methods"];
            folder.lieflow(&[&args[..], &[&methods, "--out", "out", "--again"]].concat()).ok();
            let report = folder.json("out/speed.json");
            let curves = report["curves"].as_array().unwrap();
            let of_steps = curves.iter().filter(|curve| curve["adaptive"] == false);
            let counted: Vec<(String, f64)> = of_steps
                .filter_map(|curve| {
                    let part = |key: &str| curve[key].as_str().map(String::from);
                    let parts = [part("method"), part("tableau"), part("map")];
                    let name = parts.into_iter().flatten().collect::<Vec<_>>().join(" ");
                    Some((name, count_to(error, count, curve)?))
                })
                .collect();
            let fewest = counted.iter().map(|(_, n)| *n).fold(f64::INFINITY, f64::min);
            let own = counted.iter().find(|(name, _)| name.starts_with(&advised));
            let (_, own) = own.unwrap_or_else(|| panic!("{scene}, {advised}: {counted:?}"));
            assert!(counted.len() > 1 && *own <= most * fewest, "{scene}, {advised}: {counted:?}");
        }
    }
}

/// The rows of the table of steps by their error: the method, and an error for each of three tolerances.
#[test]
fn the_errors_of_steps_by_their_error_are_as_stated() {
    let page = include_str!("../../../../docs/choose.md");
    let table = page.split("### Steps by their error").nth(1).unwrap();
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with("| `")).collect();
    assert_eq!(rows.len(), 13, "{rows:?}");
    let folder = Folder::new();
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let mut parts = cells[0].trim_matches('`').split(' ');
        let name = format!("method.name={}", parts.next().unwrap());
        let tableau = parts.next().map(|tableau| format!("method.tableau={tableau}"));
        for (cell, rtol) in cells[1..].iter().zip(["1e-6", "1e-9", "1e-12"]) {
            let rtol = format!("time.rtol={rtol}");
            let mut args = vec!["run", "asymmetric-top", "--no-page", "--out", "out"];
            let changes =
                [&name, "method.map=", "time.dt=", &rtol, "time.atol=0", "output.every=1"];
            for change in changes.into_iter().chain(tableau.as_deref()) {
                args.extend(["--set", change]);
            }
            folder.lieflow(&args).ok();
            let found =
                folder.json("out/summary.json")["accuracy"]["parts"][0]["relative"].as_f64();
            let (found, stated) = (found.unwrap(), cell.split(", ").nth(1).unwrap());
            let ratio = found / stated.parse::<f64>().unwrap();
            assert!((0.5..2.0).contains(&ratio), "{row} at {rtol}: {found:e}");
        }
    }
}
