//! `kind = "schrodinger"`: a state of n levels, iħψ̇ = H(t)ψ, on the unit sphere of ℂⁿ; see
//! [`schrodinger`](fn@schrodinger).

use lieflow::dense::squared_norm;
use lieflow::problems::{populations, schrodinger};
use lieflow::solve::Stops;
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::super::entries::numbered;
use super::super::on_m::check_number;
use super::super::prelude::*;
use super::{Hamiltonian, INSTEAD, hamiltonian_keys, state};
use crate::formula::Formula;

/// The entry in the list of kinds.
pub(in super::super) const KIND: Kind = Kind {
    name: "schrodinger",
    equation: "iħψ̇ = H(t)ψ, H(t) by formulas; or H₀ + a(t)H₁, a(t) = cos(ωt + φ) exp(−((t − t₁)/w)²), the last factor \
               with a pulse",
    summary: "Schrödinger's equation with n levels and any H(t), or under a drive",
    instead: INSTEAD,
    ..Kind::of::<Keys, Levels>(|section| read_with(section, read))
};

keys! { Keys [hamiltonian_keys sample_keys formula_keys] {
    amplitudes: List = "initial real parts, normalised",
    amplitudes_imaginary: Option<List> = "imaginary parts; optional, 0",
} }

/// The levels and the initial state.
#[derive(Clone, Debug)]
struct Levels {
    hamiltonian: Hamiltonian,
    start: Mat<f64>,
}

type Q = Quantity<Levels>;

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let (formulas, samples) = (keys.formula_keys(), keys.sample_keys());
    let (n, hamiltonian) = Hamiltonian::read(keys.hamiltonian_keys(), &formulas, samples);
    let start = state(&n, keys.amplitudes, keys.amplitudes_imaginary);
    let (hamiltonian, start) = all!(hamiltonian, start)?;
    Ok(Forms::of(Levels { hamiltonian, start }))
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
            ["re", "im"].map(|part| numbered(part, levels.hamiltonian.n)).concat()
        })
        .of_numbers(|_| Numbers::Complex),
        Q::numbers(
            "populations",
            &["p1", "…", "pn"],
            "probability of each level",
            |_, _, psi, row| row.extend(populations(psi)),
        )
        .with_columns(|levels| numbered("p", levels.hamiltonian.n)),
        Q::number("probability", "sum of the populations", |_, _, psi| squared_norm(psi.as_ref()))
            .kept(Law::by_the_action(2)),
    ];

    fn knots(&self, t_span: [f64; 2]) -> Option<Stops> {
        self.hamiltonian.knots(t_span)
    }
    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        let hamiltonian = self.hamiltonian.clone();
        let equation = schrodinger(self.hamiltonian.n, move |t, i, j| hamiltonian.entry(t, i, j))?;
        Ok((OnMatrices::linear(equation, MatrixAction::Linear), self.start.clone()))
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        self.hamiltonian.check_start(t0)
    }
    fn formula(&self) -> Option<&Formula> {
        self.hamiltonian.formula()
    }
    fn check_state(&self, arg: &str, psi: &Mat<f64>) -> Result<(), Error> {
        let length = squared_norm(psi.as_ref()).sqrt();
        check_number(format!("|{arg}|"), length, 1.0, 1.0, "the length of a state")
    }
    fn modelled(&self) -> String {
        format!("state of {} levels, real and imaginary parts", self.hamiltonian.n)
    }
    fn figure(&self) -> Figure {
        Figure::Lines("populations")
    }
}
