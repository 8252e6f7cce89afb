//! The monodromy M = g(T) of a linear system with periodic coefficients, its Floquet multipliers and its stability.
//!
//! On Sp(2m) the multipliers come in pairs λ, 1/λ. The system is stable if all of them are distinct and on the unit
//! circle. At a characteristic value of Mathieu's equation two of them meet: tr M = ±2.
//! Source: V. A. Yakubovich, V. M. Starzhinskii, Linear Differential Equations with Periodic
//! Coefficients, 1975.

use faer::Mat;

use crate::actions::LeftTranslation;
use crate::dense::multiply;
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
        Floquet::of_matrix(monodromy)
    }

    fn of_matrix(m: &Mat<f64>) -> Result<Self, Error> {
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

/// What the solutions of a linear system with a symplectic monodromy do after many periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stability {
    /// max ln|λ|, what the fastest solution grows by in a period. 0 where no multiplier is known to be off the circle.
    pub growth: f64,
    /// Do all solutions stay bounded? Where multipliers meet on the circle some may grow as the number of periods.
    pub is_bounded: bool,
}

impl Stability {
    /// The stability of a monodromy M ∈ Sp(2m), or of a matrix that is similar to it, whose entries are known up to `error`.
    ///
    /// For m = 1 it is the sign of D = tr²M/4 − 1, taken from (M₁₁ − M₂₂)²/4 + M₁₂M₂₁: where M is near ±𝟙 this has all
    /// digits of M ∓ 𝟙, and tr M has none. The growth is arsinh √D. For larger m the multipliers decide where they are
    /// farther from the circle than √`error` times ten. Nearer, and where the sign of D is rounding, powers of M tell whether
    /// solutions grow with the number of periods; for m > 1 they also see growth by more than 10⁻⁸ a period.
    ///
    /// # Errors
    /// As [`Floquet::of`].
    pub fn of(m: &Mat<f64>, error: f64) -> Result<Self, Error> {
        let radius = Floquet::of_matrix(m)?.spectral_radius();
        // An unknown error counts as 0.
        let error = error.max(0.0);
        let mut root = 10.0 * error.sqrt();
        if m.nrows() == 2 {
            let (p, b, c) = (0.5 * (m[(0, 0)] - m[(1, 1)]), m[(0, 1)], m[(1, 0)]);
            let d = p * p + b * c;
            let unsure = (2.0 * p.abs() + b.abs() + c.abs() + error) * error;
            if d.is_finite() && d.abs() > unsure {
                return Ok(Stability { growth: d.max(0.0).sqrt().asinh(), is_bounded: d < 0.0 });
            }
            root = if d.is_finite() { unsure.sqrt() } else { 0.0 };
        }
        if radius - 1.0 > root {
            return Ok(Stability { growth: radius.ln(), is_bounded: false });
        }
        let sizes = sizes_of_powers(m);
        // Multipliers that count as one are nearer than `root`, which is no matter for so many periods.
        let many = root.recip().log2().clamp(5.0, 30.0) as usize;
        let grows = sizes[many] > 16.0 * sizes[many - 5];
        if m.nrows() == 2 || grows {
            return Ok(Stability { growth: 0.0, is_bounded: !grows });
        }
        let last = sizes.iter().rposition(|size| size.is_finite()).unwrap_or(0).max(1);
        let doubled = sizes[last] / sizes[last - 1];
        // A polynomial of t, of a degree below 2m, grows by less.
        let growth = match doubled > 2f64.powi(m.nrows() as i32) {
            true => doubled.ln() / 2f64.powi(last as i32 - 1),
            false => 0.0,
        };
        let is_bounded = growth == 0.0 && sizes[30] < 32.0 * sizes[20];
        Ok(Stability { growth, is_bounded })
    }
}

/// The largest entries of M to the powers 2ᵏ, k = 0 … 30.
fn sizes_of_powers(m: &Mat<f64>) -> [f64; 31] {
    let mut power = m.clone();
    core::array::from_fn(|k| {
        if k > 0 {
            power = multiply(power.as_ref(), power.as_ref());
        }
        power.norm_max()
    })
}
