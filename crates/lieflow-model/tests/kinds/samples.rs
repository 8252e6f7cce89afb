//! Samples as variables of formulas: the same as the formulas that they are samples of, in every kind; the exact
//! coning motion; and files that are no samples.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::{env, fs, process};

use lieflow_model::scene::SceneError;

use super::formulas::{FINE, RKMK4, SAME};
use super::known::last_at_stops;
use super::*;

/// A folder with a file of samples, gone with its value.
struct Folder(PathBuf);

impl Folder {
    fn with(samples: impl AsRef<[u8]>) -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = env::temp_dir().join(format!("lieflow-samples-{}-{n}", process::id()));
        fs::create_dir_all(&path).unwrap();
        fs::write(path.join("data.csv"), samples).unwrap();
        Folder(path)
    }
    /// The scene of a problem, in this folder.
    fn scene(&self, problem: &str, time: &str, quantity: &str) -> Result<Scene, SceneError> {
        let text = format!(
            "title = \"Test\"\n[problem]\n{problem}\n[method]\n{RKMK4}\n[time]\n{time}\n[output]\n\
             quantities = [\"{quantity}\"]\n"
        );
        Scene::parse(self.0.join("scene.toml").to_str().unwrap(), &text)
    }
    fn last(&self, problem: &str, quantity: &str) -> Vec<f64> {
        let scene = self.scene(problem, FINE, quantity);
        last_at_stops(&scene.unwrap_or_else(|error| panic!("{error}")))
    }
    /// The line and the message of a scene that is refused.
    fn refused(&self, problem: &str, time: &str) -> (usize, String) {
        let error = self.scene(problem, time, "axis").unwrap_err();
        (error.line().unwrap(), error.to_string())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A body under a torque, with the file.
fn body(torque: &str, more: &str) -> String {
    format!(
        "kind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0.5, 0.4, -0.8]\n\
         torque = {torque}\nsamples = \"data.csv\"\n{more}"
    )
}

/// `u` is 1 + t and `v` is t³ − t at uneven times; their spline is themselves. The rows need not be tidy.
const DATA: &str = "\u{feff}# a comment\n\n t , u, v\n-1, 0,0\n0.5, 1.5 ,-0.375\n 1,2,0\n# 3\n1.5,2.5,1.875\n\
                    2,3,6\n3.5,4.5,39.375\n";

#[test]
fn samples_are_what_they_are_samples_of() {
    let folder = Folder::with(DATA);
    let files = "\nsamples = \"data.csv\"\ninterpolation = \"cubic\"";
    for (problem, quantity) in [
        (
            "kind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0.5, 0.4, -0.8]\n\
             torque = [\"U\", \"0\", \"V - w3\"]\ntorque_space = [\"0\", \"U*V\", \"0\"]",
            "momentum_space",
        ),
        (
            "kind = \"matrix-ode\"\ngroup = \"so\"\nfield = [[\"0\", \"-U\"], [\"U\", \"0\"]]",
            "point",
        ),
        (
            "kind = \"matrix-ode\"\ngroup = \"gl\"\naction = \"linear\"\nstart = [[1], [0.5]]\n\
             field = [[\"-U\", \"y11\"], [\"V\", \"0\"]]",
            "point",
        ),
        ("kind = \"lyapunov\"\nx = [0.3, 0.2]\nfield = [\"x2*U\", \"-x1 + V*sin(x2)\"]", "growth"),
        (
            "kind = \"composed\"\nparts = [{ name = \"a\", space = \"vector\", start = [1, 0, 0], \
             field = [\"U\", \"V\", \"0\"] }, { name = \"b\", space = \"numbers\", start = [0.5], \
             field = [\"a2*V - b\"] }]",
            "state",
        ),
    ] {
        let stated = problem.replace('U', "(1 + t)").replace('V', "(t^3 - t)");
        let sampled = problem.replace('U', "u").replace('V', "v") + files;
        let apart = far(&folder.last(&stated, quantity), &folder.last(&sampled, quantity));
        assert!(apart < SAME, "{problem}: {apart:e}");
        let samples = folder.scene(&sampled, FINE, quantity).unwrap();
        let samples = samples.problem.samples().unwrap();
        assert_eq!((samples.span(), samples.columns()), ([-1.0, 3.5], 2));
        assert!(samples.knots([0.0, 2.0]).eq([1.0, 1.5]));
    }
}

/// About a main axis of a body the momentum is the integral of the torque: of lines, which are what is taken where
/// a scene does not say, and of the spline and of increments.
#[test]
fn each_interpolation_is_what_a_scene_says() {
    let folder = Folder::with("t,u\n0,0\n1,1\n2,1\n3,3\n");
    let gained = |interpolation: &str| {
        let about = body("[\"0\", \"0\", \"u\"]", interpolation).replace("[0.5, 0.4,", "[0, 0,");
        folder.last(&about, "momentum_space")[2] + 2.0
    };
    // From 0 to 2. The cubic is t − t(t − 1)/2 + t(t − 1)(t − 2)/2.
    for (interpolation, exact) in [
        ("", 1.5),
        ("interpolation = \"linear\"", 1.5),
        ("interpolation = \"cubic\"", 5.0 / 3.0),
        ("interpolation = \"previous\"", 1.0),
        ("interpolation = \"mean-rate\"", 2.0),
    ] {
        let gained = gained(interpolation);
        assert!((gained - exact).abs() < 1e-12, "{interpolation}: {gained} {exact}");
    }
}

/// Values that are held jump: steps of one size end there, too, and those by error. So they do at the `stops` of a scene.
#[test]
fn steps_end_where_values_jump() {
    let folder = Folder::with("t,u\n0,1\n0.55,-2\n1.23,0.5\n2,7\n");
    let held = body("[\"0\", \"0\", \"u\"]", "interpolation = \"previous\"");
    let stated = "1 - 1.5*(1 + sign(t - 0.55)) + 1.25*(1 + sign(t - 1.23))";
    let stated = body(&format!("[\"0\", \"0\", \"{stated}\"]"), "");
    let stated = stated.replace("samples = \"data.csv\"", "");
    // About a main axis the momentum is the integral of the torque.
    let exact = 0.55 - 2.0 * (1.23 - 0.55) + 0.5 * (2.0 - 1.23);
    let off = |problem: &str, time: &str| {
        let scene = folder.scene(&problem.replace("[0.5, 0.4,", "[0, 0,"), time, "momentum_space");
        (last_at_stops(&scene.expect("a scene"))[2] + 2.0 - exact).abs()
    };
    for steps in ["steps = 10", "dt = 0.3", "rtol = 1e-8"] {
        let time = |more: &str| format!("t_span = [0, 2]\n{steps}\n{more}");
        let [jumps, none] = [time("stops = [1.23, 0.55]"), time("")];
        assert!(off(&held, &none) < 1e-12, "{steps}: {:e}", off(&held, &none));
        assert!(off(&stated, &jumps) < 1e-12, "{steps}: {:e}", off(&stated, &jumps));
        // Steps of one size do not know of a jump that no stop tells, nor of one that they are to pass.
        if !steps.starts_with("rtol") {
            assert!(off(&stated, &none) > 1e-3);
            assert!(off(&held, &time("at_knots = false")) > 1e-3);
        }
    }
    let (line, message) = folder.refused(&stated, "t_span = [0, 2]\nstops = [0.5,\n3]\ndt = 1");
    assert_eq!(line, 14, "{message}");
    assert!(message.contains("t = 3 lies outside of t_span, which is [0, 2]"), "{message}");
}

/// g = exp(0.3 (cos πt, sin πt, 0)^) at the end is what it was at the start. Straight lines through the mean rates
/// at the ends of the intervals are far from it.
#[test]
fn the_gyro_record_cones() {
    let error = |text: &str| {
        let end = last(&Scene::parse("scene", text).unwrap());
        let (sine, cosine) = 0.3f64.sin_cos();
        far(&end[..9], &[1.0, 0.0, 0.0, 0.0, cosine, -sine, 0.0, sine, cosine])
    };
    let text = bundled("gyro-record");
    let rate = error(&text);
    assert!(rate < 3e-6, "{rate:e}");
    let lines = ["wx", "wy", "wz"].iter().fold(text.replace("mean-rate", "linear"), |text, w| {
        text.replace(&format!("*{w}"), &format!("*{w}/0.05"))
    });
    let lines = error(&lines);
    assert!(lines > 1000.0 * rate, "{lines:e} {rate:e}");
    // From its name, the same.
    let named = last(&Scene::bundled("gyro-record").unwrap());
    assert_eq!(named, last(&Scene::parse("scene", &text).unwrap()));
}

#[test]
fn a_run_stays_in_the_span_of_its_samples() {
    let folder = Folder::with(DATA);
    let problem = body("[\"u\", \"0\", \"0\"]", "");
    for (time, inside) in [
        ("t_span = [-1, 3.5]\nsteps = 9", true),
        ("t_span = [3.5, -1]\nrtol = 1e-6", true),
        ("t_span = [0, 4]\ndt = 0.01", false),
        ("t_span = [4, 0]\nrtol = 1e-6", false),
        ("t_span = [-2, 2]\ndt = 0.01", false),
    ] {
        if inside {
            folder.scene(&problem, time, "axis").unwrap_or_else(|error| panic!("{error}"));
            continue;
        }
        let (line, message) = folder.refused(&problem, time);
        assert_eq!(line, 12, "{message}");
        assert!(message.contains("and the samples span -1 to 3.5"), "{message}");
        let span = time.lines().next().unwrap();
        assert!(message.contains(&format!("{span}, and")), "{message}");
    }
}

#[test]
fn what_is_no_file_of_samples_is_refused_at_its_line() {
    let torque = "[\"u\", \"0\", \"0\"]";
    let parts = |message: &str, parts: &[&str]| {
        parts.iter().for_each(|part| assert!(message.contains(part), "{message}"));
    };
    for (data, expected) in [
        ("", &["data.csv, line 1: found ``, expected the names of columns, `t` first"][..]),
        ("u,t\n0,1\n", &["line 1: found `u,t`", "`t` first"]),
        ("\n0,1\n1,2\n", &["line 2: found `0,1`, expected the names"]),
        ("t\n0\n1\n", &["line 1: found `t`, expected the names"]),
        ("t,u\n0,1\n\n1,2,3\n", &["line 4: found 3 columns, expected 2"]),
        ("t,u\n0,1\n1,one\n", &["line 3: column u: found `one`, expected a finite number"]),
        ("t,u\n0,1\n1,\n", &["line 3: column u: found ``, expected a finite number"]),
        ("t,u\n0,1\n1,1e999\n", &["column u: found `1e999`, expected a finite number"]),
        ("t,u\n0,1\nnan,1\n", &["line 3: column t: found `nan`, expected a finite number"]),
        ("t,u\n0,1\n2,1\n2,3\n", &["line 4: column t: found `2`, expected more than 2 of the row"]),
        ("t,u\n0,1\n", &["data.csv: found 1 row, expected at least 2"]),
        ("t,u\n0,0\n1e-3,1e307\n", &["data.csv: columns[1][2] = 1e307", "slope"]),
        ("t,w1\n0,1\n1,2\n", &["data.csv: `w1` is the name of a variable already", "another name"]),
        ("t,t\n0,1\n1,1\n", &["data.csv: `t` is the name of a variable already"]),
        ("t,u,t\n0,1,0\n1,2,1\n", &["data.csv: `t` is the name of a variable already"]),
        ("t,u,u\n0,1,0\n1,2,1\n", &["data.csv: `u` is the name of a column already"]),
        ("t,k\n0,1\n1,2\n", &["data.csv: `k` is the name of a variable already"]),
        ("t,sin\n0,1\n1,2\n", &["data.csv: `sin` is the name of a function"]),
        ("t,a b\n0,1\n1,2\n", &["data.csv: `a b` is not a valid name"]),
    ] {
        let (line, message) = Folder::with(data).refused(&body(torque, "parameters.k = 1"), FINE);
        assert_eq!(line, 7, "{message}");
        parts(&message, expected);
    }
    let (line, message) = Folder::with(b"t,u\n0,1\n\xe9").refused(&body(torque, ""), FINE);
    assert!(line == 7 && message.contains("data.csv: line 3 is not UTF-8"), "{message}");
    let folder = Folder::with(DATA);
    let instead = |from: &str, to: &str| {
        let problem = body(torque, "interpolation = \"cubic\"");
        assert!(problem.contains(from));
        folder.refused(&problem.replace(from, to), FINE)
    };
    for (from, to, line, expected) in [
        ("\"data.csv\"", "\"dada.csv\"", 7, &["there is no file `dada.csv` beside the scene"][..]),
        ("\"data.csv\"", "\".\"", 7, &["there is no file `.`"]),
        (
            "\"data.csv\"",
            "[\"data.csv\", \"t,u\"]",
            7,
            &["found a list, expected the name of a file"],
        ),
        ("\"cubic\"", "\"cubical\"", 8, &["unknown interpolation `cubical`", "`cubic`"]),
        ("samples = \"data.csv\"", "", 8, &["`interpolation` is of `samples`"]),
        ("\"u\"", "\"uu\"", 6, &["torque[1]: unknown name `uu`", "did you mean `u`?"]),
    ] {
        let (at, message) = instead(from, to);
        assert_eq!(at, line, "{message}");
        parts(&message, expected);
    }
    // An energy has no time, and so no samples.
    let euler = "kind = \"euler\"\nalgebra = \"so3\"\nmomentum = [1, 2, 3]\nhamiltonian = \"m1\"\n\
                 samples = \"data.csv\"";
    let (line, message) = folder.refused(euler, FINE);
    assert!(line == 7 && message.contains("unknown key `samples`"), "{message}");
}

/// Two files of the same size are told apart: a comparison that was interrupted is about one of them.
#[test]
fn other_numbers_are_another_scene() {
    let shown = |data: &str| {
        let folder = Folder::with(data);
        let scene = folder.scene(&body("[\"u\", \"0\", \"0\"]", ""), FINE, "axis").unwrap();
        (format!("{:?}", scene.problem), scene.fingerprint)
    };
    let [first, again, other] = ["0", "0", "1"].map(|x| shown(&format!("t,u\n0,{x}\n2,1\n")));
    assert_eq!(first, again);
    assert!(
        first.0 != other.0 && first.1 != other.1,
        "a run of the one is not resumed as the other"
    );
}

/// Another name of a column is another scene.
#[test]
fn other_names_are_another_scene() {
    let numbers = "0,1,2\n5,0,1\n10,2,3\n";
    let fingerprint = |names: &str| {
        let folder = Folder::with(format!("{names}\n{numbers}"));
        let problem = body("[\"u\", \"0\", \"v\"]", "");
        folder.scene(&problem, "t_span = [0, 1]\ndt = 0.1", "axis").unwrap().fingerprint
    };
    assert_eq!(fingerprint("t,u,v"), fingerprint("t, u, v"));
    assert_ne!(fingerprint("t,u,v"), fingerprint("t,v,u"));
}

/// Events and columns of formulas know the samples where no formula of the problem needs them.
#[test]
fn samples_are_known_beside_numbers() {
    let folder = Folder::with("t,u\n0,1\n3,2\n");
    let body = "kind = \"driven-body\"\ninertia = [1, 2, 3]\nomega_body = [0.1, 0, 1]\nthruster = [0, 0, 0.1]";
    let chain = "kind = \"spin-chain\"\nspins = [[1, 0, 0], [0, 0, 1]]\nexchange = 1";
    for (problem, quantity) in [(body, "axis"), (chain, "spins")] {
        let problem = format!("{problem}\nsamples = \"data.csv\"");
        let time = "t_span = [0, 3]\ndt = 0.1\n[[events]]\nname = \"e\"\nwhen = \"u - 1.1\"";
        let scene = folder.scene(&problem, time, quantity);
        assert_eq!(scene.unwrap_or_else(|error| panic!("{error}")).events.len(), 1);
        // They have to cover the span, as in every kind.
        let late = folder.scene(&problem, "t_span = [0, 4]\ndt = 0.1", quantity).unwrap_err();
        assert!(late.to_string().contains("the samples span 0 to 3"), "{late}");
    }
}

/// A drive has no formula: samples beside it would do nothing.
#[test]
fn samples_beside_a_drive_are_refused() {
    let folder = Folder::with("t,u\n0,1\n3,2\n");
    for (kind, start, quantity) in [
        ("schrodinger", "amplitudes = [1, 0]", "populations"),
        ("density-matrix", "density = [[1, 0], [0, 0]]", "populations"),
    ] {
        let drive = format!(
            "kind = \"{kind}\"\nenergies = [0, 1]\ncoupling = [[0, 0.3], [0.3, 0]]\nfrequency = 1\n{start}"
        );
        let scene = |more: &str| {
            folder.scene(&format!("{drive}\n{more}"), "t_span = [0, 3]\ndt = 0.1", quantity)
        };
        scene("").unwrap_or_else(|error| panic!("{kind}: {error}"));
        scene("let = { twice = \"2*t\" }").unwrap_or_else(|error| panic!("{kind}: {error}"));
        for (more, words) in [
            ("samples = \"data.csv\"", "`samples` is for the formulas of `hamiltonian`"),
            ("interpolation = \"cubic\"", "`interpolation` is for the formulas of `hamiltonian`"),
            ("let = { twice = \"foo((\" }", "foo"),
        ] {
            let refused = scene(more).expect_err(more).to_string();
            assert!(refused.contains(words), "{kind}: {refused}");
        }
    }
}
