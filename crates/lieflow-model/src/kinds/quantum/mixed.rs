//! `kind = "density-matrix"`: von Neumann's equation of n levels, iħρ̇ = \[H(t), ρ\], which keeps the eigenvalues of ρ;
//! see [`von_neumann`].

use lieflow::dense::{norm, squared_norm};
use lieflow::problems::{density_matrix, populations_of, von_neumann};
use lieflow::solve::Stops;
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::super::entries::{
    ROUNDING, columns_at, eigenvalues, numbered, symmetric, upper_columns,
};
use super::super::on_m::{OFF_M, check_hermitian, check_least, check_number};
use super::super::prelude::*;
use super::{Hamiltonian, INSTEAD, above_diagonal, hamiltonian_keys, imaginary_part, state};
use crate::formula::Formula;

/// The entry in the list of kinds.
pub(in super::super) const KIND: Kind = Kind {
    name: "density-matrix",
    equation: "iħρ̇ = H(t)ρ − ρH(t), H(t) as of schrodinger",
    summary: "von Neumann's equation: a mixed state of n levels by its density matrix",
    instead: INSTEAD,
    ..Kind::of::<Keys, Mixture>(|section| read_with(section, read))
};

keys! { Keys [hamiltonian_keys sample_keys formula_keys] {
    density: Option<Table> =
        "real part of the initial density matrix, n rows, symmetric; divided by its trace",
    density_imaginary: Option<Table> = "its imaginary part, antisymmetric; optional, 0",
    amplitudes: Option<List> = "instead of density: real parts of a pure state, normalised",
    amplitudes_imaginary: Option<List> = "its imaginary parts; optional, 0",
} }

/// The levels and the initial density matrix.
#[derive(Clone, Debug)]
struct Mixture {
    hamiltonian: Hamiltonian,
    start: Mat<f64>,
}

type Q = Quantity<Mixture>;

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let (formulas, samples) = (keys.formula_keys(), keys.sample_keys());
    let (n, hamiltonian) = Hamiltonian::read(keys.hamiltonian_keys(), &formulas, samples);
    let start = start(&n, keys);
    let (hamiltonian, start) = all!(hamiltonian, start)?;
    Ok(Forms::of(Mixture { hamiltonian, start }))
}

fn start(n: &Key<usize>, keys: Keys) -> Result<Mat<f64>, ReadError> {
    let Keys { density, density_imaginary, amplitudes, amplitudes_imaginary, .. } = keys;
    let (density, density_imaginary, amplitudes, amplitudes_imaginary) =
        all!(density, density_imaginary, amplitudes, amplitudes_imaginary)?;
    let [rho, psi] = [("density", density.is_some()), ("amplitudes", amplitudes.is_some())];
    at_most_one([rho, ("amplitudes_imaginary", amplitudes_imaginary.is_some())])?;
    at_most_one([psi, ("density_imaginary", density_imaginary.is_some())])?;
    let stated = exactly_one(("density", density), ("amplitudes", amplitudes))?;
    let levels = n.as_ref().ok().copied();
    let entries: [Mat<f64>; 2] = match stated {
        Either::First(real) => {
            let real = symmetric("density", &real, levels, ROUNDING);
            let imaginary = imaginary_part("density_imaginary", density_imaginary, levels, 1.0);
            let (real, imaginary) = all!(real, imaginary)?;
            [real, imaginary]
        }
        Either::Second(list) => {
            let psi = state(n, Ok(list), Ok(amplitudes_imaginary))?;
            let size = *seen(n)?;
            let [re, im] = [0, size].map(|part| move |psi: &Mat<f64>, i: usize| psi[(part + i, 0)]);
            let of = |i, j| re(&psi, i) * re(&psi, j) + im(&psi, i) * im(&psi, j);
            let imaginary = |i, j| im(&psi, i) * re(&psi, j) - re(&psi, i) * im(&psi, j);
            [Mat::from_fn(size, size, of), Mat::from_fn(size, size, imaginary)]
        }
    };
    let rho = density_matrix(*seen(n)?, |i, j| entries.each_ref().map(|part| part[(i, j)]));
    Ok(rho.map_err(|error| Refusal::from(error).about("density"))?)
}

/// tr ρ.
fn trace(rho: &Mat<f64>) -> f64 {
    populations_of(rho).iter().sum()
}

impl System for Mixture {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["density"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "density",
            &["re11", "…", "renn", "im12", "…"],
            "real parts on and above the diagonal, row by row, then imaginary parts above it",
            |mixture, _, rho, row| {
                let n = mixture.hamiltonian.n;
                row.extend((0..n).flat_map(|i| (i..n).map(move |j| rho[(i, j)])));
                row.extend(above_diagonal(n).map(|(i, j)| rho[(n + i, j)]));
            },
        )
        .with_columns(|mixture| {
            let n = mixture.hamiltonian.n;
            [upper_columns("re", n), columns_at("im", n, above_diagonal(n))].concat()
        })
        .of_numbers(|_| Numbers::Hermitian),
        Q::numbers(
            "populations",
            &["p1", "…", "pn"],
            "probability of each level",
            |_, _, rho, row| {
                row.extend(populations_of(rho));
            },
        )
        .with_columns(|mixture| numbered("p", mixture.hamiltonian.n)),
        Q::number("trace", "sum of the populations", |_, _, rho| trace(rho))
            .kept(Law::by_the_action(0)),
        Q::number("purity", "tr ρ²: 1 for a pure state, 1/n at least", |_, _, rho| {
            0.5 * squared_norm(rho.as_ref())
        })
        .kept(Law::by_the_action(2)),
        Q::numbers(
            "eigenvalues",
            &["e1", "…", "en"],
            "the eigenvalues in ascending order: weights of the pure states of the mixture",
            // Each is there twice in real numbers.
            |_, _, rho, row| row.extend(eigenvalues(rho).iter().step_by(2)),
        )
        .with_columns(|mixture| numbered("e", mixture.hamiltonian.n))
        .kept(Law::by_the_action(0).on_scale(Scale::Terms))
        .in_terms(|_, rho| norm(rho.as_ref())),
    ];

    fn knots(&self, t_span: [f64; 2]) -> Option<Stops> {
        self.hamiltonian.knots(t_span)
    }
    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        let hamiltonian = self.hamiltonian.clone();
        let equation = von_neumann(self.hamiltonian.n, move |t, i, j| hamiltonian.entry(t, i, j))?;
        Ok((OnMatrices::linear(equation, MatrixAction::Conjugation), self.start.clone()))
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        self.hamiltonian.check_start(t0)
    }
    fn formula(&self) -> Option<&Formula> {
        self.hamiltonian.formula()
    }
    fn check_state(&self, arg: &str, rho: &Mat<f64>) -> Result<(), Error> {
        check_hermitian(arg, rho)?;
        let of = "that of a density matrix";
        check_number(format!("the trace of {arg}"), trace(rho), 1.0, 1.0, of)?;
        let least = eigenvalues(rho)[0];
        check_least(least >= -OFF_M, format!("the least eigenvalue of {arg}"), least, "at least 0")
    }
    fn modelled(&self) -> String {
        format!("density matrix of {} levels, real and imaginary parts", self.hamiltonian.n)
    }
    fn figure(&self) -> Figure {
        Figure::Lines("populations")
    }
}
