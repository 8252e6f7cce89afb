//! The numbers do not depend on the settings of the compiler: two builds of the program give the same bits.
//!
//! Each bundled scene runs with every method that fits it, with equal steps and with steps by error, with rows between
//! steps and the events of the scene. `docs/compiler-fault.md` says what this found.

use std::env;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::support::{Folder, program};
use serde_json::Value;

/// The steps of a run with equal steps.
const STEPS: f64 = 60.0;
/// The time of a run with steps by error, at most.
const TIME: f64 = 20.0;

/// A scene with the keys of its sections.
struct Scene {
    name: String,
    keys: Vec<String>,
    t_span: [f64; 2],
    dt: Option<f64>,
}

impl Scene {
    fn read(name: &str, text: &str) -> Self {
        let (mut section, mut keys) = ("", Vec::new());
        let (mut t_span, mut dt, mut steps) = (None, None::<f64>, None::<f64>);
        for line in text.lines() {
            if let Some(name) = line.strip_prefix('[') {
                section = name.split(']').next().unwrap();
            } else if let Some((key, value)) = line.split_once(" = ")
                && ["method", "time", "output"].contains(&section)
            {
                let value = value.split('#').next().unwrap().trim();
                match key {
                    "t_span" => t_span = Some(value.trim_matches(['[', ']'])),
                    "dt" => dt = value.parse().ok(),
                    "steps" => steps = value.parse().ok(),
                    _ => {}
                }
                keys.push(format!("{section}.{key}"));
            }
        }
        let mut ends = t_span.expect("a span").split(',').map(|t| t.trim().parse().unwrap());
        let t_span: [f64; 2] = [(); 2].map(|()| ends.next().expect("two ends"));
        let length = (t_span[1] - t_span[0]).abs();
        Scene { name: name.into(), keys, t_span, dt: dt.or(steps.map(|steps| length / steps)) }
    }

    /// The arguments of a short run by a method.
    fn arguments(&self, [method, map, tableau]: [&str; 3], by_error: bool) -> Vec<String> {
        let [t0, t1] = self.t_span;
        let length = self.dt.map_or(TIME, |dt| STEPS * dt.abs()).min((t1 - t0).abs());
        let dt = self.dt.map_or(length / STEPS, f64::abs);
        let mut set = vec![
            format!("method.name={method}"),
            format!("time.t_span=[{t0:?},{:?}]", t0 + length.copysign(t1 - t0)),
            "output.count=97".into(),
        ];
        for (key, value) in [("map", map), ("tableau", tableau)] {
            if !value.is_empty() {
                set.push(format!("method.{key}={value}"));
            }
        }
        match by_error {
            true => set
                .extend(["rtol=1e-8", "atol=1e-10", "max_steps=3000"].map(|x| format!("time.{x}"))),
            false => set.push(format!("time.dt={dt:?}")),
        }
        let is_set = |key: &str| set.iter().any(|set| set.split('=').next() == Some(key));
        let stays = |key: &str| is_set(key) || key == "output.quantities" || key == "method.layer";
        let others = self.keys.iter().filter(|key| !stays(key)).map(|key| format!("{key}="));
        let set = others.chain(set.iter().cloned()).flat_map(|set| ["--set".into(), set]);
        let run = ["run", &self.name, "--no-page", "--error-check", "never", "--out", "out"];
        run.map(String::from).into_iter().chain(set).collect()
    }
}

/// The name, the map and the tableau of every method in a listing.
fn methods(listing: &Value) -> Vec<[String; 3]> {
    let names = |value: &Value| -> Vec<String> {
        let all = value.as_array().unwrap().iter().map(|name| name.as_str().unwrap().into());
        let all: Vec<String> = all.collect();
        if all.is_empty() { vec![String::new()] } else { all }
    };
    let mut all = Vec::new();
    for method in listing["methods"].as_array().unwrap() {
        for map in names(&method["maps"]) {
            for tableau in names(&method["tableaus"]) {
                all.push([method["name"].as_str().unwrap().into(), map.clone(), tableau]);
            }
        }
    }
    all
}

/// What a run leaves: its exit code, its message and its files of rows.
fn results(folder: &Folder, program: &Path, arguments: &[String]) -> (Option<i32>, Vec<String>) {
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let output = folder.command_of(program, &arguments).output().unwrap();
    let mut texts = vec![String::from_utf8(output.stderr).unwrap()];
    for name in ["trajectory", "trajectory.partial", "events", "events.partial"] {
        let path = folder.path().join(format!("out/{name}.csv"));
        texts.push(std::fs::read_to_string(&path).unwrap_or_default());
        let _ = std::fs::remove_file(path);
    }
    (output.status.code(), texts)
}

#[test]
#[ignore = "two builds; .ci/long runs it: LIEFLOW_OTHER=… cargo test --release -p lieflow-cli --test cli same_bits -- --ignored"]
fn two_builds_give_the_same_bits() {
    let other = PathBuf::from(env::var_os("LIEFLOW_OTHER").expect("LIEFLOW_OTHER names a program"));
    let other = other.canonicalize().unwrap();
    let folder = Folder::new();
    let json =
        |args: &[&str]| -> Value { serde_json::from_str(&folder.lieflow(args).ok()).unwrap() };
    let mut runs = Vec::new();
    for scene in json(&["scenes", "--json"])["scenes"].as_array().unwrap() {
        let name = scene["name"].as_str().unwrap();
        let read = Scene::read(name, scene["text"].as_str().unwrap());
        for method in methods(&json(&["methods", "--for", name, "--json"])) {
            let [method, map, tableau] = &method;
            for by_error in [false, true] {
                runs.push(read.arguments([method, map, tableau], by_error));
            }
        }
    }
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let worker = || {
        let folder = Folder::new();
        let mut different = Vec::new();
        while let Some(arguments) = runs.get(next.fetch_add(1, Ordering::Relaxed)) {
            let ours = results(&folder, &program(), arguments);
            if ours != results(&folder, &other, arguments) {
                different.push(arguments.join(" "));
            }
            done.fetch_add(usize::from(ours.0 == Some(0)), Ordering::Relaxed);
        }
        different
    };
    let different: Vec<String> = thread::scope(|scope| {
        let workers = [(); 2].map(|()| scope.spawn(worker));
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    let (all, done) = (runs.len(), done.into_inner());
    println!("{all} runs, {done} to their end, {} different", different.len());
    assert!(different.is_empty(), "{}", different.join("\n"));
    assert!(done > all * 9 / 10 && all > 5000, "{done} of {all} runs reached their end");
}
