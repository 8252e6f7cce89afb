//! Euler's equations on the dual of an algebra of matrices.

use lieflow::dense::norm;
use lieflow::groups::{AlgebraMatrix, LieAlgebra, MatrixGroup};
use lieflow::problems::{DiscreteGradient, Euler, Hamiltonian, Kinetic, MeanGradient};
use lieflow::scalar::{Ops, tally};
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::dual::{Dual, Given, OnDual, quantities};
use super::energy::Energy;
use super::group::WithGroup;
use crate::formula::{Formula, Text};
use crate::kinds::algebra::{Algebra, Miss, Named, miss};
use crate::kinds::entries::{
    NAMED_MAX, antisymmetric, numbered, rows, size_of_traces, square, traces,
};
use crate::kinds::on_m::OFF_M;
use crate::kinds::prelude::*;
use crate::problem::{FormulaKeys, SampleKeys, row_columns};
use crate::reader::values::Numbers;

/// How H is stated.
#[derive(Clone, Debug)]
enum Form {
    /// ½⟨m, π(W ∘ m)⟩.
    Weights(Mat<f64>),
    Formula(Energy),
}

/// H(π(m)), π the projection on the algebra.
#[derive(Clone, Debug)]
pub(super) struct Projected {
    algebra: Algebra,
    form: Form,
}

/// The system with its initial momentum.
#[derive(Clone, Debug)]
pub(super) struct EulerEquation {
    pub(super) group: MatrixGroup,
    pub(super) energy: Projected,
    pub(super) momentum: Mat<f64>,
}

/// The distance from the algebra that a momentum may have, relative to its size.
const ROUNDING: f64 = 1e-12;

pub(super) fn on(named: Named, given: Given) -> Result<Forms, ReadError> {
    let algebra = named.algebra;
    let Given { names, hamiltonian, inverse_inertia, momentum } = given;
    let momentum = momentum.and_then(|momentum| match (algebra, momentum) {
        (Algebra::So, Numbers::List(above)) => antisymmetric(&above).ok_or_else(|| {
            let message = format!(
                "found {}, expected the n(n-1)/2 entries above the diagonal, or n rows of n",
                amount(above.len(), "numbers")
            );
            Refusal::at("momentum", message).into()
        }),
        (_, momentum) => momentum.square("momentum"),
    });
    let n = seen(&momentum).map(Mat::nrows);
    let form = form_of(inverse_inertia, hamiltonian, &names, n.as_ref().ok().copied());
    let group = n.and_then(|n| {
        named.check_size(n, "momentum")?;
        Ok(algebra.group(n, "momentum")?)
    });
    let momentum = momentum.and_then(|momentum| {
        seen(&group)?;
        match miss(algebra, "momentum", &momentum, ROUNDING) {
            None => Ok(momentum),
            Some(Miss { key, why, form }) => {
                let message = format!("it is not in {}: {why}", algebra.name(momentum.nrows()));
                Err(Refusal { help: Some(form), ..Refusal::at(key, message) }.into())
            }
        }
    });
    let (group, momentum, form) = all!(group, momentum, form)?;
    let energy = Projected { algebra, form };
    let alone = EulerEquation { group, energy, momentum };
    Ok(Forms::of(alone.clone()).or(Forms::of(WithGroup(alone))))
}

/// How H of n×n matrices is stated.
fn form_of(
    inverse_inertia: Key<Option<Table>>,
    hamiltonian: Key<Option<Text>>,
    keys: &FormulaKeys,
    n: Option<usize>,
) -> Result<Form, ReadError> {
    let stated = ("inverse_inertia", inverse_inertia?);
    match exactly_one(stated, ("hamiltonian", hamiltonian?))? {
        Either::First(table) => Ok(Form::Weights(square("inverse_inertia", &table, n)?)),
        Either::Second(text) => {
            let Some(n) = n else {
                Formula::check_form("hamiltonian", &text.0)?;
                return Err(ReadError::known());
            };
            if n > NAMED_MAX {
                let message = format!("the momentum is {n}×{n}, expected at most {NAMED_MAX} rows");
                return Err(Refusal::at("hamiltonian", message).into());
            }
            let names = keys.names("hamiltonian", row_columns("m", n, n), SampleKeys::none())?;
            let (energy, names) = (Energy::read(&text, &names), names.checked());
            let (energy, _) = all!(energy, names)?;
            Ok(Form::Formula(energy))
        }
    }
}

/// The entries of x, row by row, for formulas.
fn entries(x: &Mat<f64>) -> [f64; NAMED_MAX * NAMED_MAX] {
    let mut entries = [0.0; NAMED_MAX * NAMED_MAX];
    entries.iter_mut().zip(rows(x)).for_each(|(entry, x)| *entry = x);
    entries
}

impl Projected {
    /// ½⟨m, π(W ∘ π(m))⟩.
    fn weighted(&self, weights: &Mat<f64>) -> impl DiscreteGradient<MatrixGroup> {
        // π(W ∘ π(m)) is symmetric, as a gradient of a quadratic energy must be.
        Kinetic(move |m: &Mat<f64>, xi: &mut AlgebraMatrix| {
            tally(|| Ops::muls(m.nrows() * m.ncols()));
            xi.copy_from(m);
            self.algebra.project(xi);
            for (xi, weights) in xi.col_iter_mut().zip(weights.col_iter()) {
                xi.iter_mut().zip(weights.iter()).for_each(|(x, w)| *x *= w);
            }
            self.algebra.project(xi);
        })
    }

    /// H(π(m)) of a formula, with the gradient π(∂H(π(m))).
    fn stated(&self, energy: &Energy) -> impl DiscreteGradient<MatrixGroup> {
        MeanGradient(
            move |m: &Mat<f64>| {
                let mut inside = m.clone();
                self.algebra.project(&mut inside);
                energy.value(&entries(&inside))
            },
            move |a: &Mat<f64>, way: Option<(&Mat<f64>, f64)>, xi: &mut AlgebraMatrix| {
                let n = a.nrows();
                xi.copy_from(a);
                if let Some((b, s)) = way {
                    tally(|| Ops::adds(n * n) + Ops::muladds(n * n));
                    for (j, column) in xi.col_iter_mut().enumerate() {
                        column.iter_mut().enumerate().for_each(|(i, x)| *x += s * (b[(i, j)] - *x));
                    }
                }
                self.algebra.project(xi);
                let m = entries(xi);
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    xi[(i, j)] = energy.by(i * n + j, &m);
                }
                self.algebra.project(xi);
            },
        )
    }
}

impl Hamiltonian<MatrixGroup> for Projected {
    fn value(&self, group: &MatrixGroup, m: &Mat<f64>) -> f64 {
        match &self.form {
            Form::Weights(weights) => self.weighted(weights).value(group, m),
            Form::Formula(energy) => self.stated(energy).value(group, m),
        }
    }
    fn gradient(&self, m: &Mat<f64>, xi: &mut AlgebraMatrix) {
        match &self.form {
            Form::Weights(weights) => self.weighted(weights).gradient(m, xi),
            Form::Formula(energy) => self.stated(energy).gradient(m, xi),
        }
    }
}

impl DiscreteGradient<MatrixGroup> for Projected {
    fn between(
        &self,
        group: &MatrixGroup,
        a: &Mat<f64>,
        b: &Mat<f64>,
        xi: &mut AlgebraMatrix,
        scratch: &mut AlgebraMatrix,
    ) {
        match &self.form {
            Form::Weights(weights) => self.weighted(weights).between(group, a, b, xi, scratch),
            Form::Formula(energy) => self.stated(energy).between(group, a, b, xi, scratch),
        }
    }
}

impl EulerEquation {
    /// Is the momentum of a state in the algebra?
    ///
    /// # Errors
    /// [`Error::NotInAlgebra`] and [`Error::Trace`], about `y`.
    pub(super) fn check_momentum(&self, m: &Mat<f64>) -> Result<(), Error> {
        self.group.algebra_within(m.clone(), OFF_M).map(drop).map_err(|error| error.about("y"))
    }
}

impl Dual for EulerEquation {
    type Momentum = Mat<f64>;

    fn columns(&self) -> [Vec<String>; 2] {
        let n = self.momentum.nrows();
        [row_columns("m", n, n), numbered("trm", n)]
    }
    fn degrees(&self) -> [u32; 2] {
        [if matches!(self.energy.form, Form::Weights(_)) { 2 } else { 0 }, 0]
    }
    fn entries(m: &Mat<f64>, row: &mut Vec<f64>) {
        row.extend(rows(m));
    }
    fn energy(&self, m: &Mat<f64>) -> f64 {
        self.energy.value(&self.group, m)
    }
    /// |H| and |m||∇H|, whose rounding is that of H.
    fn energy_terms(&self, m: &Mat<f64>) -> f64 {
        let mut slope = self.group.zero();
        self.energy.gradient(m, &mut slope);
        self.energy(m).abs() + norm(m.as_ref()) * norm(slope.as_ref())
    }
    fn casimirs(m: &Mat<f64>, row: &mut Vec<f64>) {
        row.extend(traces(m));
    }
    fn casimir_terms(m: &Mat<f64>) -> f64 {
        size_of_traces(m)
    }
}

impl OnDual for EulerEquation {
    type Dual = Self;

    fn dual(&self) -> &Self {
        self
    }
    fn momentum(m: &Mat<f64>) -> &Mat<f64> {
        m
    }
}

impl System for EulerEquation {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["momentum"];
    const QUANTITIES: &'static [Quantity<Self>] = &quantities();

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        let system = Euler::new(self.group.clone(), self.energy.clone());
        Ok((OnMatrices::lie_poisson(system, MatrixAction::Coadjoint), self.momentum.clone()))
    }
    fn check_start(&self, _: f64) -> Vec<Refusal> {
        match &self.energy.form {
            Form::Weights(_) => Vec::new(),
            Form::Formula(energy) => energy.check(&entries(&self.momentum)),
        }
    }
    fn formula(&self) -> Option<&Formula> {
        match &self.energy.form {
            Form::Weights(_) => None,
            Form::Formula(energy) => Some(energy.formula()),
        }
    }
    fn check_state(&self, _: &str, m: &Mat<f64>) -> Result<(), Error> {
        self.check_momentum(m)
    }
    fn modelled(&self) -> String {
        format!("momentum on {}*", self.energy.algebra.name(self.momentum.nrows()))
    }
}
