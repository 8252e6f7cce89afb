//! A Hamiltonian as a formula, with the formulas of its derivatives.

use std::sync::Arc;

use lieflow::scalar::{Ops, Real, tally};

use crate::formula::{Formula, Names, Text, without_value};
use crate::reader::{ReadError, Refusal};

/// The key.
const KEY: &str = "hamiltonian";

/// H, and ∂H by every entry of the momentum.
#[derive(Clone, Debug)]
pub(super) struct Energy {
    value: Formula,
    gradient: Arc<[Formula]>,
    /// The c_i of a sum of squares Σ m_i²/(2c_i), whose gradient m_i/c_i takes no formulas.
    divisors: Option<Arc<[f64]>>,
}

impl Energy {
    /// # Errors
    /// Refusals of `hamiltonian`.
    pub(super) fn read(Text(text): &Text, names: &Names) -> Result<Self, ReadError> {
        let value = Formula::read(KEY, text, names)?;
        let by = |i| value.derivative(i);
        let gradient: Arc<[Formula]> =
            (0..names.variables().len()).map(by).collect::<Result<_, _>>()?;
        let divisor =
            |(i, by): (usize, &Formula)| Some(by.quotient().filter(|(at, _)| *at == i)?.1);
        let divisors = gradient.iter().enumerate().map(divisor).collect();
        Ok(Energy { value, gradient, divisors })
    }

    /// The refusals where H or a derivative has no finite value at the start.
    pub(super) fn check(&self, m: &[f64]) -> Vec<Refusal> {
        without_value([&self.value].into_iter().chain(&*self.gradient), m)
    }

    /// H as a formula.
    pub(super) fn formula(&self) -> &Formula {
        &self.value
    }

    /// H(m).
    pub(super) fn value<S: Real + Into<f64>>(&self, m: &[S]) -> S {
        self.value.value(m)
    }

    /// ∂H/∂m_i.
    pub(super) fn by<S: Real + Into<f64>>(&self, i: usize, m: &[S]) -> S {
        self.gradient[i].value(m)
    }

    /// ∇H, for momenta of N numbers.
    pub(super) fn slope<S: Real + Into<f64>, const N: usize>(&self, m: &[S; N]) -> [S; N] {
        match self.divisors.as_deref() {
            Some(divisors) if divisors.len() == N => {
                tally(|| Ops::divs(N));
                core::array::from_fn(|i| S::lit(m[i].into() / divisors[i]))
            }
            _ => core::array::from_fn(|i| self.by(i, m)),
        }
    }
}
