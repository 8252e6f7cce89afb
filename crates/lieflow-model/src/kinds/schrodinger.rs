//! `kind = "schrodinger"`: n levels under a drive, iψ̇ = (H₀ + a(t) H₁)ψ on the unit sphere of ℂⁿ; see
//! [`schrodinger`](fn@schrodinger). a(t) = cos(ωt + φ), times exp(−((t − t₁)/w)²) where there is a pulse.

use faer::Mat;
use lieflow::Error;
use lieflow::problems::{amplitudes, populations, schrodinger};
use lieflow::scalar::{Ops, tally};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::matrix::MatrixAction;
use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo};
use crate::kinds::flow::OnMatrices;
use crate::model::Layer;
use crate::scene::values::{List, Real, Reals, Table};
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "schrodinger",
    equation: "iψ̇ = (H₀ + a(t)H₁)ψ, a(t) = cos(ωt + φ) exp(−((t − t₁)/w)²), the last factor with a pulse",
    summary: "Schrödinger's equation with n levels under a drive",
    keys: &[
        KeyInfo { name: "energies", meaning: "energies of the levels without the drive" },
        KeyInfo { name: "coupling", meaning: "real part of the drive's matrix, symmetric" },
        KeyInfo {
            name: "coupling_imaginary",
            meaning: "its imaginary part, antisymmetric; optional, 0",
        },
        KeyInfo { name: "frequency", meaning: "angular frequency of the drive; optional, 0" },
        KeyInfo { name: "phase", meaning: "its phase at t = 0; optional, 0" },
        KeyInfo {
            name: "pulse",
            meaning: "[centre, width] of a Gaussian envelope; optional, a drive of constant strength",
        },
        KeyInfo { name: "amplitudes", meaning: "initial real parts, normalised" },
        KeyInfo { name: "amplitudes_imaginary", meaning: "imaginary parts; optional, 0" },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "amplitudes",
                columns: &["re1", "…", "ren", "im1", "…", "imn"],
                meaning: "real parts, then imaginary parts",
            },
            QuantityInfo {
                name: "populations",
                columns: &["p1", "…", "pn"],
                meaning: "probability of each level",
            },
            QuantityInfo {
                name: "probability",
                columns: &["probability"],
                meaning: "sum of the populations",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    energies: List,
    coupling: Table,
    coupling_imaginary: Option<Table>,
    frequency: Option<Real>,
    phase: Option<Real>,
    pulse: Option<Reals<2>>,
    amplitudes: List,
    amplitudes_imaginary: Option<List>,
}

/// The levels, the drive and the initial state.
#[derive(Clone, Debug)]
struct Levels {
    energies: Vec<f64>,
    /// Real and imaginary parts.
    coupling: [Mat<f64>; 2],
    frequency: f64,
    phase: f64,
    pulse: Option<[f64; 2]>,
    start: Mat<f64>,
}

/// An n×n matrix that its transpose is `sign` times.
fn with_symmetry(key: &str, table: &Table, n: usize, sign: f64) -> Result<Mat<f64>, Refusal> {
    let m = table.matrix(key, Some(n))?;
    if m.nrows() != n {
        let message = format!("found {} rows, expected {n}, one a level", m.nrows());
        return Err(Refusal::at(key, message));
    }
    let entries = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)));
    for (i, j) in entries {
        if m[(i, j)] != sign * m[(j, i)] {
            let what = if sign > 0.0 { "equal to" } else { "minus" };
            let message = format!("{} is not {what} {} across from it", m[(i, j)], m[(j, i)]);
            return Err(Refusal::at(format!("{key}[{i},{j}]"), message));
        }
    }
    Ok(m)
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let energies = keys.energies.values();
    let n = energies.len();
    let real = with_symmetry("coupling", &keys.coupling, n, 1.0)?;
    let imaginary = match &keys.coupling_imaginary {
        Some(table) => with_symmetry("coupling_imaginary", table, n, -1.0)?,
        None => Mat::zeros(n, n),
    };
    let parts = [
        ("amplitudes", keys.amplitudes.values()),
        ("amplitudes_imaginary", keys.amplitudes_imaginary.map_or(vec![0.0; n], |x| x.values())),
    ];
    if let Some((key, part)) = parts.iter().find(|(_, part)| part.len() != n) {
        let message = format!("found {} numbers, expected {n}, one a level", part.len());
        return Err(Refusal::at(*key, message).into());
    }
    if let Some([_, width]) = keys.pulse.map(|pulse| pulse.0)
        && width <= 0.0
    {
        return Err(Refusal::at("pulse[1]", format!("width {width}, expected > 0")).into());
    }
    let psi: Vec<_> = parts[0].1.iter().zip(&parts[1].1).map(|(re, im)| [*re, *im]).collect();
    let start = amplitudes(&psi).map_err(|error| Refusal::at("amplitudes", error.to_string()))?;
    Ok(Box::new(Levels {
        energies,
        coupling: [real, imaginary],
        frequency: keys.frequency.map_or(0.0, |x| x.0),
        phase: keys.phase.map_or(0.0, |x| x.0),
        pulse: keys.pulse.map(|pulse| pulse.0),
        start,
    }))
}

impl Levels {
    /// a(t).
    fn drive(&self, t: f64) -> f64 {
        let pulse = Ops::adds(1) + Ops::divs(1) + Ops::muls(1) + Ops::trigs(1);
        tally(|| pulse * self.pulse.iter().count() + Ops::muls(2) + Ops::adds(1) + Ops::trigs(1));
        let envelope = self.pulse.map_or(1.0, |[at, width]| (-((t - at) / width).powi(2)).exp());
        envelope * (self.frequency * t + self.phase).cos()
    }
}

impl System for Levels {
    type Problem = OnMatrices;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        let levels = self.clone();
        let hamiltonian = move |t: f64, i: usize, j: usize| {
            let (drive, [re, im]) = (levels.drive(t), &levels.coupling);
            let energy = if i == j { levels.energies[i] } else { 0.0 };
            tally(|| Ops::muls(2) + Ops::adds(1));
            [energy + drive * re[(i, j)], drive * im[(i, j)]]
        };
        let equation = schrodinger(self.energies.len(), hamiltonian)?;
        Ok((OnMatrices::linear(equation, MatrixAction::Linear), self.start.clone()))
    }
    fn modelled(&self) -> String {
        format!("state of {} levels, real and imaginary parts", self.energies.len())
    }
    fn state(&self) -> &'static [&'static str] {
        &["amplitudes"]
    }
    fn laws(&self) -> Vec<Law> {
        vec![Law::of_the_action("probability", 2)]
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let n = self.energies.len();
        let numbered = |name: &'static str| (1..=n).map(move |i| format!("{name}{i}"));
        match quantity.name {
            "amplitudes" => numbered("re").chain(numbered("im")).collect(),
            "populations" => numbered("p").collect(),
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, _: f64, psi: &Mat<f64>, row: &mut Vec<f64>) {
        match quantity {
            "amplitudes" => row.extend(psi.col_as_slice(0)),
            "populations" => row.extend(populations(psi)),
            _ => row.push(psi.squared_norm_l2()),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Lines("populations")
    }
}
