//! A Hamiltonian as a formula, with the formulas of its derivatives.

use std::sync::Arc;

use lieflow::scalar::Real;

use crate::scene::Refusal;
use crate::scene::formula::{Formula, Names};

/// The key.
const KEY: &str = "hamiltonian";

/// H, and ∂H by every entry of the momentum.
#[derive(Clone, Debug)]
pub(super) struct Energy {
    value: Formula,
    gradient: Arc<[Formula]>,
}

impl Energy {
    /// # Errors
    /// A refusal of `hamiltonian`.
    pub(super) fn read(text: &str, names: &Names) -> Result<Self, Refusal> {
        let value = Formula::read(KEY, text, names)?;
        let by = |i| value.derivative(KEY, i);
        let gradient = (0..names.variables().len()).map(by).collect::<Result<_, _>>()?;
        Ok(Energy { value, gradient })
    }

    /// Checks that H and its derivatives are finite at the start.
    ///
    /// # Errors
    /// A refusal of `hamiltonian`.
    pub(super) fn check(&self, m: &[f64]) -> Result<(), Refusal> {
        self.value.check(KEY, m)?;
        match self.gradient.iter().position(|by| !by.value::<f64>(m).is_finite()) {
            None => Ok(()),
            Some(i) => {
                let by = format!("its derivative by number {} of the momentum", i + 1);
                Err(Refusal::at(KEY, format!("{KEY}: {by} is not finite at the start")))
            }
        }
    }

    /// H(m).
    pub(super) fn value<S: Real + Into<f64>>(&self, m: &[S]) -> S {
        self.value.value(m)
    }

    /// ∂H/∂m_i.
    pub(super) fn by<S: Real + Into<f64>>(&self, i: usize, m: &[S]) -> S {
        self.gradient[i].value(m)
    }
}
