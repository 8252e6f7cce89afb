//! Runs of the program, each in its own folder.
#![allow(dead_code, unreachable_pub)] // each test file uses its part

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU64, Ordering};
use std::{env, fs, process};

/// A folder that goes away with its value.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new() -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = env::temp_dir().join(format!("lieflow-test-{}-{n}", process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }
    pub fn path(&self) -> &Path {
        &self.0
    }
    pub fn write(&self, name: &str, text: &str) {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap()
    }
    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }
    /// The names in a folder below, in order; none when it is not there.
    pub fn names(&self, below: &str) -> Vec<String> {
        let Ok(entries) = fs::read_dir(self.0.join(below)) else { return Vec::new() };
        let name = |entry: fs::DirEntry| entry.file_name().into_string().unwrap();
        let mut names: Vec<_> = entries.map(|entry| name(entry.unwrap())).collect();
        names.sort();
        names
    }
    /// The same without pages and figures.
    pub fn data(&self, below: &str) -> Vec<String> {
        let drawn = |name: &String| name.ends_with(".svg") || name.ends_with(".html");
        self.names(below).into_iter().filter(|name| !drawn(name)).collect()
    }
    /// Run `lieflow` here.
    pub fn lieflow(&self, args: &[&str]) -> Run {
        Run::from(self.command(args).output().unwrap())
    }
    /// Run a scene here, without a page. What it writes is in `out`.
    pub fn run(&self, scene: &str) -> Run {
        self.write("scene.toml", scene);
        self.lieflow(&["run", "scene.toml", "--out", "out", "--no-page"])
    }
    /// The digits that the run in `out` states.
    pub fn digits(&self) -> Option<u64> {
        self.json("out/summary.json")["accuracy"]["digits"].as_u64()
    }
    /// The trajectory of the run in `out`: the names of its columns, and its rows.
    pub fn trajectory(&self) -> (Vec<String>, Vec<Vec<f64>>) {
        read_csv(&self.read("out/trajectory.csv"))
    }
    /// `lieflow`, to be run here.
    pub fn command(&self, args: &[&str]) -> Command {
        self.command_of(&program(), args)
    }
    /// Another build of `lieflow`, to be run here.
    pub fn command_of(&self, program: &Path, args: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(args).current_dir(&self.0);
        command
    }
}

/// The program that is tested: the one that `LIEFLOW_BIN` names, or the one of this profile.
pub fn program() -> PathBuf {
    let own = PathBuf::from(env!("CARGO_BIN_EXE_lieflow"));
    env::var_os("LIEFLOW_BIN").map_or(own, |path| {
        fs::canonicalize(&path).unwrap_or_else(|error| panic!("LIEFLOW_BIN = {path:?}: {error}"))
    })
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// What a run of the program said.
#[derive(Debug)]
pub struct Run {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Run {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Run {
    /// Standard output of a run that went well.
    pub fn ok(self) -> String {
        assert_eq!(self.code, Some(0), "{self:?}");
        self.out
    }
    /// The message of a run that was refused.
    pub fn refused(self) -> String {
        self.failed(2)
    }
    /// The message of a run that ended with this exit code.
    pub fn failed(self, code: i32) -> String {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert_eq!(self.out, "", "{self:?}");
        assert!(self.err.starts_with("error: "), "{}", self.err);
        for noise in ["panicked", "backtrace", "Error {", "Some("] {
            assert!(!self.err.contains(noise), "{}", self.err);
        }
        self.err
    }
}

/// A trajectory: the names of its columns, and its rows.
pub fn read_csv(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    assert!(text.ends_with('\n'));
    let mut lines = text.lines();
    let header = lines.next().unwrap().split(',').map(String::from).collect();
    let rows = lines.map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    (header, rows)
}

/// A short scene; each line has its place in the table of broken scenes.
pub const SCENE: &str = r#"title = "Test"
[problem]
kind = "rigid-body"
inertia = [1, 2.0, 3.0]
omega_body = [0.2, 0.0, 1.0]
[method]
name = "rkmk4"
map = "exp"
layer = "closed"
[time]
t_span = [0, 2.0]
dt = 0.05
[output]
quantities = ["momentum_body", "energy"]
every = 10
"#;
