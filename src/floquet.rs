//! The monodromy M = g(T) of a linear system with periodic coefficients, its Floquet multipliers and its stability.
//!
//! On Sp(2m) the multipliers come in pairs λ, 1/λ. The system is stable if all of them are distinct and on the unit
//! circle. At a characteristic value of Mathieu's equation two of them meet: tr M = ±2.
//! Source: V. A. Yakubovich, V. M. Starzhinskii, Linear Differential Equations with Periodic
//! Coefficients, 1975.

use faer::Mat;

use crate::actions::LeftTranslation;
use crate::error::{Error, StepError};
use crate::groups::{GroupMatrix, LieGroup, MatrixGroup};
use crate::methods::Method;
use crate::problems::{PointOf, Problem};
use crate::solve::{RunError, SaveAt, TimeGrid, integrate};

/// g at the end of `span`, with g = 𝟙 at its start, by `steps` steps. Over a period this is the monodromy.
///
/// # Errors
/// As [`integrate()`](crate::integrate()).
pub fn monodromy<P, M>(
    problem: &P,
    method: &M,
    span: [f64; 2],
    steps: u64,
) -> Result<GroupMatrix, RunError>
where
    P: Problem<Group = MatrixGroup, Action = LeftTranslation>,
    M: Method<P>,
{
    let mut g: PointOf<P> = problem.group().identity();
    let grid = TimeGrid::with_steps(span, steps)?;
    integrate(problem, method, &grid, &SaveAt::Ends, &mut g, |_, _| {})?;
    Ok(g)
}

/// The Floquet multipliers of a monodromy: its eigenvalues.
#[derive(Clone, Debug, PartialEq)]
pub struct Floquet {
    /// (re, im) of each, the largest modulus first.
    pub multipliers: Vec<[f64; 2]>,
}

impl Floquet {
    /// The eigenvalues of the monodromy M.
    ///
    /// # Errors
    /// [`Error::NotFiniteEntry`]; [`Error::Map`] when the eigenvalues do not converge.
    pub fn of(monodromy: &GroupMatrix) -> Result<Self, Error> {
        let m: &Mat<f64> = monodromy;
        MatrixGroup::gl(m.nrows())?.shape("M", m.as_ref())?;
        let failed = StepError::NotConverged { what: "the eigenvalues of M" };
        let values = m.eigenvalues().map_err(|_| failed)?;
        let mut multipliers: Vec<_> = values.iter().map(|z| [z.re, z.im]).collect();
        multipliers.sort_by(|a, b| b[0].hypot(b[1]).total_cmp(&a[0].hypot(a[1])));
        Ok(Floquet { multipliers })
    }

    /// max |λ|: 1 to rounding if solutions stay bounded, more if some grow.
    ///
    /// Where two multipliers meet on the circle, a rounding error in M moves them apart by its square root.
    pub fn spectral_radius(&self) -> f64 {
        self.multipliers.first().map_or(0.0, |[re, im]| re.hypot(*im))
    }
    /// ln|λ| / period of the fastest growing solution, its Lyapunov exponent.
    pub fn growth(&self, period: f64) -> f64 {
        self.spectral_radius().ln() / period
    }
}
