//! Euler angles that pass near to where they are singular, against closed formulas and SciPy.
//!
//! A ball turns at a constant rate about an axis of space. Then an axis of the body goes along a great circle, which passes
//! the pole at a distance δ, and its longitude is the first angle. With φ = rate·t, counted from the pass,
//! tan(first) = tan φ / sin δ. Seen from the body, an axis of space goes along a circle of the same distance from its pole.
//! Its longitude is the third angle, and swings: tan(third) = −sin φ / tan δ.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use lieflow::solve::Next;
use lieflow_model::problem::Watcher;
use lieflow_model::scene::Scene;
use lieflow_model::schema::Row;

type V = [f64; 3];

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
fn unit(axis: usize) -> V {
    core::array::from_fn(|i| if i == axis { 1.0 } else { 0.0 })
}
/// Σ xᵢ aᵢ.
fn sum<const N: usize>(terms: [(f64, V); N]) -> V {
    core::array::from_fn(|i| terms.iter().map(|(x, a)| x * a[i]).sum())
}

/// The rows and the zeros of a run.
#[derive(Default)]
struct Seen {
    rows: Vec<(f64, Vec<f64>)>,
    zeros: Vec<(usize, f64)>,
    followed: usize,
}

impl Watcher for Seen {
    fn row(&mut self, t: f64, row: Row<'_>) -> Next {
        self.rows.push((t, row.values().to_vec()));
        Next::Continue
    }
    fn event(&mut self, event: usize, t: f64, _: bool, _: Row<'_>) {
        self.zeros.push((event, t));
    }
    fn followed(&mut self, t: f64, _: Row<'_>, is_sure: bool) {
        assert!(is_sure, "t = {t}");
        self.followed += 1;
    }
}

fn run(text: &str) -> Seen {
    let scene = Scene::parse("scene", text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let model = scene.model_with(scene.layer, &scene.computed()).unwrap();
    let mut seen = Seen::default();
    let plan = scene.plan(model.schema()).unwrap();
    model.drive(&scene.method, plan, &mut seen).unwrap();
    seen
}

/// A ball that turns at 1 radian each unit of time. Its angles of a sequence pass the singular one at a distance δ, first at
/// t = −start.
struct Pass {
    name: String,
    delta: f64,
    start: f64,
    /// The attitude, its columns the axes of the body; and the axis of the turn.
    attitude: [V; 3],
    axis: V,
}

impl Pass {
    fn new(frame: &str, letters: &str, delta: f64, start: f64) -> Self {
        let axes: Vec<usize> = letters.bytes().map(|letter| usize::from(letter - b'x')).collect();
        let [space, body] = if frame == "fixed" { [axes[2], axes[0]] } else { [axes[0], axes[2]] };
        let [pole, a] = [space, (space + 1) % 3].map(unit);
        let (s, c) = delta.sin_cos();
        let axis = sum([(c, a), (s, pole)]);
        // The axis of the body at the pass, a quarter turn later, and at the start.
        let near = sum([(-s, a), (c, pole)]);
        let later = cross(axis, near);
        let (s, c) = start.sin_cos();
        let point = sum([(c, near), (s, later)]);
        // Any rotation with this axis.
        let beside = sum([(0.6, axis), (0.8, cross(axis, point))]);
        let mut attitude = [[0.0; 3]; 3];
        attitude[body] = point;
        attitude[(body + 1) % 3] = beside;
        attitude[(body + 2) % 3] = cross(point, beside);
        Pass { name: format!("{frame}_{letters}"), delta, start, attitude, axis }
    }

    /// The keys of the attitude and of the angular velocity.
    fn keys(&self, rate: f64, in_space: bool) -> String {
        let dot = |a: V, b: V| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let rows: [V; 3] = core::array::from_fn(|i| self.attitude.map(|column| column[i]));
        let omega = match in_space {
            true => self.axis,
            false => self.attitude.map(|column| dot(column, self.axis)),
        };
        format!("{rows:?}|{:?}", omega.map(|x| rate * x))
    }

    /// The changes of the first and the third angle since the start, at rate·t.
    fn turned(&self, turned: f64) -> [f64; 2] {
        let (sin, tan) = (self.delta.sin(), self.delta.tan());
        let first = |phi: f64| {
            let half_turns = PI * (phi / PI).round();
            half_turns + (phi - half_turns).sin().atan2(sin * (phi - half_turns).cos())
        };
        let third = |phi: f64| -phi.sin().atan2(tan);
        let change = |f: &dyn Fn(f64) -> f64| f(self.start + turned) - f(self.start);
        let changes = [change(&first), change(&third)];
        if self.name.starts_with("fixed") { [changes[1], changes[0]] } else { changes }
    }

    /// The rows have the angles of the closed formulas.
    fn check(&self, seen: &Seen, rate: f64, text: &str) {
        let (_, start) = &seen.rows[0];
        for (t, angles) in &seen.rows {
            // At a pass itself the angles are as uncertain as the time.
            let phi = (self.start + rate * t) / PI;
            if (phi - phi.round()).abs() * PI < 0.01 {
                continue;
            }
            let expected = self.turned(rate * t);
            for (place, expected) in [(0, expected[0]), (2, expected[1])] {
                let change = angles[place] - start[place];
                assert!(
                    (change - expected).abs() < 1e-3,
                    "{text}\nt = {t}: angle {place} changed by {change}, expected {expected}"
                );
            }
        }
    }
}

const MOVING: [&str; 12] =
    ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"];

/// All sequences, fast and slow, with few rows and with many: no turn is lost, and the points that are looked at are few.
#[test]
fn a_pass_near_the_singular_angle_loses_no_turn() {
    let sequences = ["euler", "fixed"].map(|frame| MOVING.map(|letters| (frame, letters)));
    for (number, (frame, letters)) in sequences.concat().into_iter().enumerate() {
        for delta in [0.3, 1e-2, 1e-4, 1e-6] {
            let pass = Pass::new(frame, letters, delta, -0.7);
            for (rate, method) in [
                (1.0, ""),
                (25.0, ""),
                (-2.0, "rtol = 1e-10\n[method]\nname = \"rkmk dopri5\"\n"),
                (3.0, "dt = 0.73\n[method]\nname = \"exact\"\n"),
                (0.5, "dt = 0.01\n[method]\nname = \"cf4\"\n"),
            ] {
                // Backward in time is a start on the other side.
                let count = if number % 2 == 0 { 3 } else { 400 };
                let keys = pass.keys(rate, false);
                let (attitude, omega) = keys.split_once('|').unwrap();
                let text = format!(
                    "[problem]\nkind = \"rigid-body\"\ninertia = [1, 1, 1]\nomega_body = {omega}\nattitude = {attitude}\n\
                     [time]\nt_span = [0, 10]\n{method}\n[output]\nquantities = [\"{}\"]\ncount = {count}\n",
                    pass.name
                );
                let seen = run(&text);
                pass.check(&seen, rate, &text);
                // Two for each radian, those at the ends of steps, and some for each digit at each pass.
                let passes = 2.0 + 10.0 * rate.abs() / PI;
                let most = 10.0 * rate.abs() * 10.0 + passes * 12.0 * -delta.log2() + 100.0;
                assert!(seen.followed as f64 <= most, "{text}{} points", seen.followed);
            }
        }
    }
}

/// All kinds with an attitude look where their angles turn fast.
#[test]
fn every_kind_follows_a_pass() {
    for (frame, letters) in [("euler", "zyx"), ("euler", "zxz"), ("fixed", "xyz"), ("fixed", "yxy")]
    {
        let pass = Pass::new(frame, letters, 1e-3, 0.4);
        for (in_space, kind) in [
            (
                false,
                "kind = \"driven-body\"\ninertia = [1, 1, 1]\ntorque = [0, 0, 0]\nomega_body = OMEGA\nattitude = START",
            ),
            (
                false,
                "kind = \"heavy-top\"\ninertia = [1, 1, 1]\nweight = [0, 0, 0]\nomega_body = OMEGA\nattitude = START",
            ),
            (
                false,
                "kind = \"rigid-motion\"\nomega = OMEGA\nvelocity = [0, 0, 0]\nattitude = START",
            ),
            (
                true,
                "kind = \"rigid-motion\"\nframe = \"space\"\nomega = OMEGA\nvelocity = [0, 0, 0]\nattitude = START",
            ),
            (
                true,
                "kind = \"composed\"\nparts = [{ name = \"g\", space = \"rotation\", start = START, field = OMEGA }]",
            ),
        ] {
            let keys = pass.keys(7.0, in_space);
            let (attitude, omega) = keys.split_once('|').unwrap();
            let kind = kind.replace("OMEGA", omega).replace("START", attitude);
            let text = format!(
                "[problem]\n{kind}\n[time]\nt_span = [0, 10]\n[output]\nquantities = [\"{}\"]\ncount = 4\n",
                pass.name
            );
            pass.check(&run(&text), 7.0, &text);
        }
    }
}

/// Events on the angles, and rows between them, follow what was looked at near the passes.
#[test]
fn events_on_angles_know_the_passes() {
    let pass = Pass::new("euler", "zxz", 1e-3, -0.7);
    let keys = pass.keys(3.0, false);
    let (attitude, omega) = keys.split_once('|').unwrap();
    let text = |start: f64, rows: &str| {
        let events = [2.0, 11.0, 20.0].map(|x| {
            let level = start + x;
            format!("[[events]]\nname = \"at-{x}\"\nwhen = \"euler_zxz1 - ({level:?})\"\n")
        });
        format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1, 1, 1]\nomega_body = {omega}\nattitude = {attitude}\n\
             [time]\nt_span = [0, 10]\n{}[output]\nquantities = [\"euler_zxz\"]\n{rows}\n",
            events.concat()
        )
    };
    let start = run(&text(0.0, "count = 2")).rows[0].1[0];
    for rows in ["count = 2", "count = 1000"] {
        let seen = run(&text(start, rows));
        pass.check(&seen, 3.0, rows);
        let expected = [2.0, 11.0, 20.0].map(|x| {
            // The angle at the start is -π/2 + sin δ / tan 0.7, nearly.
            let first = x + (-0.7_f64).sin().atan2(pass.delta.sin() * 0.7_f64.cos());
            let half_turns = PI * (first / PI).round();
            let rest = first - half_turns;
            let phi = half_turns + (pass.delta.sin() * rest.sin()).atan2(rest.cos());
            (phi + 0.7) / 3.0
        });
        let found: Vec<f64> = seen.zeros.iter().map(|(_, t)| *t).collect();
        assert_eq!(found.len(), 3, "{rows}: {found:?}, expected {expected:?}");
        for ((event, t), (index, expected)) in
            seen.zeros.iter().zip(expected.into_iter().enumerate())
        {
            assert!(*event == index && (t - expected).abs() < 1e-9, "{rows}: {t}, {expected}");
        }
    }
}

/// Free bodies that came out wrong by whole turns: their angles by SciPy's DOP853 at rtol = 1e-12, with `numpy.unwrap` over
/// 200 000 points. The first changes its angle by as much in rows that are close; the second has three rows.
#[test]
fn angles_of_free_bodies_are_those_of_scipy() {
    let text = |rows: &str, events: &str| {
        format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1.72, 1.19, 2.2]\nomega_body = [0.4, -0.7, 0.8]\n[time]\n\
             t_span = [0, 20]\n{events}[output]\nquantities = [\"euler_zxz\"]\n{rows}\n"
        )
    };
    let events = "[[events]]\nname = \"e\"\nwhen = \"euler_zxz1 - 8\"\n\
                  [[events]]\nname = \"f\"\nwhen = \"euler_zxz1 - 20\"\n";
    for (rows, events) in [("count = 1000", ""), ("count = 4000", events), ("count = 3", events)] {
        let seen = run(&text(rows, events));
        let (_, end) = seen.rows.last().unwrap();
        assert!((end[0] - 25.228_95).abs() < 1e-4, "{rows}: {end:?}");
        for (t, angles) in seen.rows.iter().filter(|(t, _)| (t - 9.22).abs() < 1e-9) {
            assert!((angles[0] - 11.4877).abs() < 1e-3, "t = {t}: {angles:?}");
        }
        if !events.is_empty() {
            let near = |(event, t): &(usize, f64), expected: (usize, f64)| {
                *event == expected.0 && (t - expected.1).abs() < 1e-4
            };
            let [e, f] = &seen.zeros[..] else { panic!("{rows}: {:?}", seen.zeros) };
            assert!(near(e, (0, 8.5428)) && near(f, (1, 16.919_99)), "{rows}: {:?}", seen.zeros);
        }
    }
    let text = "[problem]\nkind = \"rigid-body\"\ninertia = [2.09, 1.927, 1.933]\nomega_body = [-0.483, -1.671, -2.017]\n\
                quaternion = [0.8828, 0.3827, 0.2322, -0.1425]\n[time]\nt_span = [0, 15]\n[output]\n\
                quantities = [\"euler_zxz\"]\ncount = 5\n";
    let seen = run(text);
    let (_, end) = seen.rows.last().unwrap();
    assert!((end[2] + 5.396_39).abs() < 1e-4, "{end:?}");
}

/// A body that stays where its angles are singular, or very near, is looked at as another. With a tilt its axis comes back to
/// the pole in each turn.
#[test]
fn a_body_that_stays_at_the_singular_angle_is_cheap() {
    for tilt in [0.0, 1e-12, 1e-9, 1e-5] {
        let text = format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1, 1, 2]\nomega_body = [{tilt:?}, 0, 3]\n[time]\n\
             t_span = [0, 50]\n[output]\nquantities = [\"euler_zxz\", \"fixed_zyz\"]\ncount = 5\n"
        );
        let seen = run(&text);
        assert!(seen.followed < 4_000, "tilt {tilt}: {} points", seen.followed);
        for (t, angles) in &seen.rows {
            for angles in angles.as_chunks::<3>().0 {
                let turned = angles[0] + angles[2] - 3.0 * t;
                let full = TAU * (turned / TAU).round();
                assert!(
                    (turned - full).abs() < 1e-4 && angles[1] < FRAC_PI_2,
                    "t = {t}: {angles:?}"
                );
            }
        }
    }
}
