//! The hard cases of the matrix exponential, with references of 34 digits.

use faer::Mat;
use lieflow::dense::Structure;
use serde::Deserialize;

#[derive(Deserialize)]
struct File {
    cases: Vec<Case>,
}

/// One matrix by rows; numbers as decimal strings.
#[derive(Deserialize)]
#[allow(dead_code)] // not every test reads every field
pub(crate) struct Case {
    pub(crate) id: String,
    pub(crate) structure: String,
    pub(crate) n: usize,
    pub(crate) u: Vec<String>,
    pub(crate) exp: Vec<String>,
    pub(crate) cond: Option<String>,
    pub(crate) mixed: Option<String>,
}

impl Case {
    pub(crate) fn structure(&self) -> Structure {
        if self.structure == "so" { Structure::Skew } else { Structure::General }
    }
    pub(crate) fn matrix(&self, entries: &[String]) -> Mat<f64> {
        let n = self.n;
        Mat::from_fn(n, n, |i, j| entries[i * n + j].parse().expect("a number"))
    }
}

pub(crate) fn cases() -> Vec<Case> {
    let file: File =
        serde_json::from_str(include_str!("../references/expm.json")).expect("expm.json");
    file.cases
}
