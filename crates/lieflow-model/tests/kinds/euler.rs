//! Euler angles: their values in all sequences against SciPy's, both ways, and from row to row.

use lieflow_model::problem::Rows;
use lieflow_model::scene::Scene;
use lieflow_model::schema::{Branch, Row};

/// What SciPy's `Rotation.as_euler` gives for eight rotations, four of them where sequences are singular.
const SCIPY: &str = include_str!("euler.csv");

/// A rotation, the name of a sequence, its key, and SciPy's angles.
struct Reference {
    quaternion: Vec<f64>,
    name: String,
    key: String,
    angles: Vec<f64>,
    singular: bool,
}

fn references() -> Vec<Reference> {
    let line = |line: &str| {
        let parts: Vec<&str> = line.split(',').collect();
        let numbers = |range: core::ops::Range<usize>| -> Vec<f64> {
            parts[range].iter().map(|x| x.parse().unwrap()).collect()
        };
        let letters = parts[4].to_lowercase();
        // Capital letters are axes that move.
        let frame = if letters == parts[4] { "fixed" } else { "euler" };
        Reference {
            quaternion: numbers(0..4),
            name: format!("{frame}_{letters}"),
            key: format!("{frame}.{letters}"),
            angles: numbers(5..8),
            singular: parts[8] == "1",
        }
    };
    SCIPY.lines().filter(|text| !text.starts_with('#')).map(line).collect()
}

fn scene(attitude: &str, omega: [f64; 3], quantity: &str) -> Scene {
    let text = format!(
        "[problem]\nkind = \"rigid-body\"\ninertia = [1.0, 1.0, 1.0]\nomega_body = {omega:?}\n{attitude}\n\
         [time]\nt_span = [0, 8]\nsteps = 400\n[method]\nname = \"exact\"\n[output]\nquantities = [{quantity:?}]\n"
    );
    Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// The rows of the first quantity.
fn rows(scene: &Scene) -> Vec<(f64, Vec<f64>)> {
    let model = scene.model().unwrap();
    let mut rows = Vec::new();
    let mut sink = |t: f64, row: Row<'_>| rows.push((t, row.values().to_vec()));
    model.run(&scene.method, &scene.grid, &scene.save, &mut sink).unwrap();
    rows
}

/// The rows of a run as the scene states it.
fn driven(scene: &Scene) -> Vec<(f64, Vec<f64>)> {
    let model = scene.model().unwrap();
    let mut rows = Vec::new();
    let mut sink = |t: f64, row: Row<'_>| rows.push((t, row.values().to_vec()));
    let plan = scene.plan(model.schema()).unwrap();
    model.drive(&scene.method, plan, &mut Rows(&mut sink)).unwrap();
    rows
}

/// The largest difference of angles, up to whole turns.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let gap = |(a, b): (&f64, &f64)| (0.5 * (a - b)).sin().abs() * 2.0;
    a.iter().zip(b).map(gap).fold(0.0, f64::max)
}

#[test]
fn angles_are_those_of_scipy_in_all_sequences() {
    let references = references();
    assert_eq!(references.len(), 8 * 24);
    assert!(references.iter().filter(|reference| reference.singular).count() > 30);
    for Reference { quaternion, name, key, angles, singular } in &references {
        let start = scene(&format!("quaternion = {quaternion:?}"), [0.3, 0.2, 0.1], name);
        let found = &rows(&start)[0].1;
        assert!(
            apart(found, angles) < 1e-14,
            "{name} of {quaternion:?}: {found:?}, not {angles:?}"
        );
        let model = start.model().unwrap();
        let far = model.schema().get(name).unwrap().branch.distance_to_singular(found).unwrap();
        assert_eq!(far <= Branch::SINGULAR, *singular, "{name} of {quaternion:?}: {far:e}");
        // Back.
        let stated = scene(&format!("{key} = {angles:?}"), [0.3, 0.2, 0.1], "quaternion");
        let found = &rows(&stated)[0].1;
        let cosine: f64 = found.iter().zip(quaternion).map(|(a, b)| a * b).sum();
        assert!((cosine.abs() - 1.0).abs() < 1e-15, "{key} = {angles:?}: {found:?}");
    }
}

/// A turn about the second axis goes through the singular angle, and back in its range; the others are half a turn away
/// there. Rows that are far apart have the same angles, up to full turns of the first and the third.
#[test]
fn angles_go_on_beyond_the_singular_one() {
    use core::f64::consts::{PI, TAU};
    for (name, rate) in
        [("euler_xyz", 1.1), ("fixed_zyx", 1.1), ("euler_zyz", -0.9), ("fixed_xyx", 1.3)]
    {
        for start in [0.0, 0.25] {
            let (key, letters) = name.split_once('_').unwrap();
            let attitude = format!("{key}.{letters} = [0.4, {start}, 0.7]");
            // About the second axis as it stands: the third turn comes after it, or the first.
            let last = if key == "euler" { 0.7_f64 } else { 0.4 };
            let axis = letters.as_bytes()[if key == "euler" { 2 } else { 0 }];
            let (s, c) = last.sin_cos();
            let omega = match axis {
                b'z' => [rate * s, rate * c, 0.0],
                _ => [0.0, rate * c, -rate * s],
            };
            let is_proper = letters.as_bytes()[0] == letters.as_bytes()[2];
            let (mut before, mut jumps) = ([0.4, 0.7], 0);
            // At the start of a proper sequence the angle 0 is singular: the third is 0 there.
            for (t, angles) in
                rows(&scene(&attitude, omega, name)).iter().filter(|(t, _)| *t > 0.05)
            {
                let second = start + rate * t;
                let (folded, is_beyond) = match is_proper {
                    true => (second.cos().acos(), second.sin() < 0.0),
                    false => (second.sin().asin(), second.cos() < 0.0),
                };
                assert!((angles[1] - folded).abs() < 1e-7, "{name}, t = {t}: {angles:?}, {folded}");
                let half = if is_beyond { PI } else { 0.0 };
                for (place, first) in [(0, 0.4), (2, 0.7)] {
                    let turns = (angles[place] - first - half) / TAU;
                    assert!((turns - turns.round()).abs() < 1e-6, "{name}, t = {t}: {angles:?}");
                }
                let moved = [angles[0] - before[0], angles[2] - before[1]];
                jumps += usize::from(moved.iter().any(|x| x.abs() > 0.03));
                before = [angles[0], angles[2]];
            }
            assert!(jumps <= 3, "{name}: {jumps} jumps");
        }
    }
}

/// A row and an event follow the points before them: what events look at changes no row, also where a path goes exactly
/// through the singular angle, and the third angle jumps by half a turn.
#[test]
fn events_change_no_angle_of_a_row() {
    use core::f64::consts::{FRAC_PI_2, PI, TAU};
    let run = |method: &str, events: &str| {
        let text = format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1.0, 1.0, 2.0]\nomega_body = [0, 1.0, 0]\n\
             euler.zyx = [0.3, 0, 0]\n[time]\nt_span = [0, 10]\n{method}\n{events}\n[output]\n\
             quantities = [\"euler_zyx\"]\ninterval = 0.1\n"
        );
        let scene = Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"));
        driven(&scene)
    };
    let event = |when: &str| format!("[[events]]\nname = \"{}\"\nwhen = \"{when}\"\n", when.len());
    let several = event("euler_zyx3 + 1") + &event("euler_zyx1") + &event("euler_zyx2 - 0.25");
    for method in [
        "",
        "rtol = 1e-10\n[method]\nname = \"rkmk dop853 exp\"",
        "dt = 0.25\n[method]\nname = \"taylor12\"",
        "steps = 40\n[method]\nname = \"exact\"",
    ] {
        let plain = run(method, "");
        assert_eq!(plain.len(), 101);
        assert_eq!(plain, run(method, &several), "{method}");
        assert_eq!(plain, run(method, &event("euler_zyx2 - 0.5")), "{method}");
        for (t, angles) in plain {
            // The number of half turns of the first and the third; at the singular angle either is right.
            let passed = ((t + FRAC_PI_2) / PI).floor();
            if ((t + FRAC_PI_2) / PI - passed).min(passed + 1.0 - (t + FRAC_PI_2) / PI) < 0.02 {
                continue;
            }
            let half = if passed % 2.0 == 0.0 { 0.0 } else { PI };
            for (angle, first) in [(angles[0], 0.3), (angles[2], 0.0)] {
                let turns = (angle - first - half) / TAU;
                assert!((turns - turns.round()).abs() < 1e-6, "{method}, t = {t}: {angles:?}");
                assert!(
                    (angle - first).abs() < (passed + 0.1) * PI,
                    "{method}, t = {t}: {angles:?}"
                );
            }
        }
    }
}

/// Between rows that are half a turn apart and more, the turns of each step count.
#[test]
fn turns_between_rows_are_counted() {
    let text = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 1, 2]\nomega_body = [0, 0, 1.5]\n\
                euler.zyx = [0.3, 0, 0]\n[time]\nt_span = [0, 40]\n[output]\n\
                quantities = [\"euler_zyx\", \"quaternion\"]\ncount = 5\n";
    for method in ["", "[method]\nname = \"exact\"\n", "[method]\nname = \"rkmk dop853 exp\"\n"] {
        let scene = Scene::parse("scene", &format!("{text}{method}")).unwrap();
        let rows = driven(&scene);
        assert!(rows.len() <= 7, "{}", rows.len());
        for (t, row) in rows {
            let yaw = 0.3 + 1.5 * t;
            assert!((row[0] - yaw).abs() < 1e-10, "{method}, t = {t}: {row:?}, {yaw}");
            assert!((row[3] - (0.5 * yaw).cos()).abs() < 1e-10, "{method}, t = {t}: {row:?}");
        }
    }
}

/// Bodies of every kind that turn about the third axis by 3 radians each unit of time, many turns in a step: no turn is
/// lost, whatever the method, its steps and the rows.
#[test]
fn no_kind_loses_a_turn() {
    let kinds = [
        "kind = \"rigid-body\"\ninertia = [1, 1, 2]\nomega_body = [0, 0, 3]",
        "kind = \"heavy-top\"\ninertia = [1, 1, 1.5]\nweight = [0, 0, 1]\nomega_body = [0, 0, 3]\neuler.zyx = [0, 0, 0]",
        "kind = \"driven-body\"\ninertia = [1, 1, 1.5]\nomega_body = [0, 0, 3]\ntorque = [0, 0, 0]",
        "kind = \"rigid-motion\"\nomega = [0, 0, 3]\nvelocity = [\"1e6*t\", 0, 0]",
        "kind = \"rigid-motion\"\nomega = [0, 0, 3]\nvelocity = [0, 0, 0]\nframe = \"space\"",
        "kind = \"composed\"\nparts = [{ name = \"x\", space = \"numbers\", start = [0], field = [\"sin(t)\"] },\n\
         { name = \"g\", space = \"rotation\", field = [0, 0, 3] }]",
    ];
    let methods = [
        "",
        "rtol = 1e-6\n[method]\nname = \"rkmk dopri5\"",
        "dt = 1.25\n[method]\nname = \"rkmk4\"",
        "dt = 7.5\n[method]\nname = \"cf4\"",
        "steps = 1\n[method]\nname = \"rkmk dop853\"",
    ];
    for (kind, method) in kinds.iter().flat_map(|kind| methods.map(|method| (kind, method))) {
        for rows in ["count = 2", "count = 41", "every = 1"] {
            let text = format!(
                "[problem]\n{kind}\n[time]\nt_span = [0, 60]\n{method}\n[output]\n\
                 quantities = [\"euler_zyx\", \"quaternion\"]\n{rows}\n"
            );
            let scene = Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"));
            for (t, row) in driven(&scene) {
                let yaw = 3.0 * t;
                assert!((row[0] - yaw).abs() < 1e-7, "{text}, t = {t}: {row:?}, {yaw}");
                assert!((row[3] - (0.5 * yaw).cos()).abs() < 1e-7, "{text}, t = {t}: {row:?}");
            }
        }
    }
}

/// The rate of a body grows from 0 to 40 radians each unit of time, and falls again. It is the rate of each step that counts.
#[test]
fn a_rate_that_grows_loses_no_turn() {
    let text = "[problem]\nkind = \"rigid-motion\"\nomega = [0, 0, \"2*t\"]\nvelocity = [0, 0, 0]\n[time]\n\
                t_span = [-20, 20]\n[output]\nquantities = [\"euler_zyx\"]\n";
    for method in ["", "[method]\nname = \"magnus43\"\n", "[method]\nname = \"rkmk dop853\"\n"] {
        for rows in ["count = 3\n", "interval = 0.7\n"] {
            let scene = Scene::parse("scene", &format!("{text}{rows}{method}")).unwrap();
            for (t, row) in driven(&scene) {
                let yaw = t * t - 400.0;
                assert!((row[0] - yaw).abs() < 1e-4, "{method}{rows}, t = {t}: {row:?}, {yaw}");
            }
        }
    }
}

#[test]
fn other_sequences_are_refused() {
    for (keys, message) in [
        ("euler.xxy = [0, 0, 0]", "unknown sequence of axes `xxy`"),
        ("euler = { xxy = [0, 0, 0], zyy = [0, 0, 0] }", "unknown sequence of axes `zyy`"),
        ("euler = { xxy = [0, 0, 0], zyy = [0, 0, 0] }", "unknown sequence of axes `xxy`"),
        ("euler.xxy = [0, 0, 0]\nshape = 3", "unknown sequence of axes `xxy`"),
        ("euler = { xyz = [0, 0, 0], zyx = [0, 0, 0] }", "both `euler.xyz` and `euler.zyx`"),
        ("fixed.zyx = [0, 0]", "expected 3 numbers"),
        ("euler.zyx = [0, 0, 0]\nquaternion = [1, 0, 0, 0]", "`euler`"),
    ] {
        let text = format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [1, 0, 0]\n{keys}\n\
             [time]\nt_span = [0, 1]\n"
        );
        let error = Scene::parse("scene", &text).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}
