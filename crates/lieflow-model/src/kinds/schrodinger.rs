//! `kind = "schrodinger"`: n levels under a drive, iψ̇ = (H₀ + a(t) H₁)ψ on the unit sphere of ℂⁿ; see
//! [`schrodinger`](fn@schrodinger). a(t) = cos(ωt + φ), times exp(−((t − t₁)/w)²) where there is a pulse.

use lieflow::dense::squared_norm;
use lieflow::problems::{amplitudes, populations, schrodinger};
use lieflow::scalar::{Ops, tally};

use super::entries::{check_antisymmetric, numbered, square, symmetric};
use super::flow::OnMatrices;
use super::matrix::MatrixAction;
use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "schrodinger",
    equation: "iψ̇ = (H₀ + a(t)H₁)ψ, a(t) = cos(ωt + φ) exp(−((t − t₁)/w)²), the last factor with a pulse",
    summary: "Schrödinger's equation with n levels under a drive",
    ..Kind::of::<Keys, Levels>(|section| read_with(section, read))
};

keys! { Keys {
    energies: List = "energies of the levels without the drive",
    coupling: Table = "real part of the drive's matrix, symmetric",
    coupling_imaginary: Option<Table> = "its imaginary part, antisymmetric; optional, 0",
    frequency: Option<Real> = "angular frequency of the drive; optional, 0",
    phase: Option<Real> = "its phase at t = 0; optional, 0",
    pulse: Option<Reals<2>> = "[centre, width] of a Gaussian envelope; optional, a drive of constant strength",
    amplitudes: List = "initial real parts, normalised",
    amplitudes_imaginary: Option<List> = "imaginary parts; optional, 0",
} }

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

type Q = Quantity<Levels>;

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let Keys { frequency, phase, pulse, .. } = keys;
    let pulse = pulse.and_then(|pulse| match pulse {
        Some(Reals([_, width])) if width <= 0.0 => {
            Err(Refusal::at("pulse".index(1), format!("width {width}, expected > 0")).into())
        }
        pulse => Ok(pulse),
    });
    let energies = keys.energies.map(|energies| energies.values());
    let n = seen(&energies).map(Vec::len);
    let real = keys.coupling.and_then(|x| symmetric("coupling", &x, Some(n.clone()?), 0.0));
    let imaginary = keys.coupling_imaginary.and_then(|table| {
        let (key, n) = ("coupling_imaginary", n.clone()?);
        let x = table.map_or(Ok(Mat::zeros(n, n)), |table| square(key, &table, n))?;
        check_antisymmetric(key, &x)?;
        Ok(x)
    });
    let one_a_level = |key: &str, numbers: Option<List>| {
        let n = n.clone()?;
        let numbers = numbers.map_or(vec![0.0; n], |numbers| numbers.values());
        let message = || format!("found {} numbers, expected {n}, one a level", numbers.len());
        match numbers.len() == n {
            true => Ok(numbers),
            false => Err(ReadError::from(Refusal::at(key, message()))),
        }
    };
    let re = keys.amplitudes.and_then(|x| one_a_level("amplitudes", Some(x)));
    let im = keys.amplitudes_imaginary.and_then(|x| one_a_level("amplitudes_imaginary", x));
    let psi = all!(re, im).and_then(|(re, im)| {
        let psi: Vec<_> = re.iter().zip(&im).map(|(re, im)| [*re, *im]).collect();
        Ok(amplitudes(&psi).map_err(|error| Refusal::from(error).about("amplitudes"))?)
    });
    let (energies, real, imaginary, frequency, phase, pulse, start) =
        all!(energies, real, imaginary, frequency, phase, pulse, psi)?;
    Ok(Forms::of(Levels {
        energies,
        coupling: [real, imaginary],
        frequency: frequency.map_or(0.0, |x| x.0),
        phase: phase.map_or(0.0, |x| x.0),
        pulse: pulse.map(|pulse| pulse.0),
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

    const STATE: &'static [&'static str] = &["amplitudes"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "amplitudes",
            &["re1", "…", "ren", "im1", "…", "imn"],
            "real parts, then imaginary parts",
            |_, _, psi, row| row.extend(psi.col_as_slice(0)),
        )
        .with_columns(|levels| {
            ["re", "im"].map(|part| numbered(part, levels.energies.len())).concat()
        }),
        Q::numbers(
            "populations",
            &["p1", "…", "pn"],
            "probability of each level",
            |_, _, psi, row| row.extend(populations(psi)),
        )
        .with_columns(|levels| numbered("p", levels.energies.len())),
        Q::number("probability", "sum of the populations", |_, _, psi| squared_norm(psi.as_ref()))
            .kept(Law::by_the_action(2)),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
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
    fn figure(&self) -> Figure {
        Figure::Lines("populations")
    }
}
