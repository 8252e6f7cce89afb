//! Linear Hamiltonian systems ẏ = A(t)y, A(t) ∈ sp(2m), with periodic coefficients: the monodromy
//! M = g(T), its Floquet multipliers, and whether they let y stay bounded.
//!
//! Hill: ẍ + Q(t)x = 0 is A = \[0 𝟙; −Q 0\] with y = (x, ẋ); Mathieu: Q = a − 2q cos 2t, of period π.
//! f(t, g) = A(t); Λ(a, g) = ag. The multipliers come in pairs λ, 1/λ; all on the unit circle and apart
//! is stability. At a characteristic value of Mathieu's equation they meet: tr M = ±2.
//! Source: V. A. Yakubovich, V. M. Starzhinskii, Linear Differential Equations with Periodic
//! Coefficients, 1975; NIST DLMF, chapter 28.

use faer::Mat;

use super::rigid_body::check_finite;
use super::{Flow, LinearFlow, PointOf, Problem};
use crate::actions::LeftTranslation;
use crate::error::Error;
use crate::groups::{AlgebraMatrix, GroupMatrix, LieGroup, MatrixGroup};
use crate::integrate::{RunError, SaveAt, TimeGrid, integrate};
use crate::methods::Method;

/// ġ = A(t)g on Sp(2m); the function writes A(t).
pub type LinearHamiltonian<F> = LinearFlow<MatrixGroup, LeftTranslation, F>;

/// ẍ + Q(t)x = 0 for x ∈ ℝᵐ on Sp(2m): `stiffness(t, i, j)` is Q_ij(t), of a symmetric Q.
///
/// # Errors
/// [`Error::OutOfRange`] as [`MatrixGroup::sp`].
pub fn hill<Q: Fn(f64, usize, usize) -> f64>(
    m: usize,
    stiffness: Q,
) -> Result<LinearHamiltonian<impl Fn(f64, &mut AlgebraMatrix)>, Error> {
    let group = MatrixGroup::sp(m.saturating_mul(2))?;
    let field = move |t: f64, v: &mut AlgebraMatrix| {
        v.fill(0.0);
        for j in 0..m {
            v[(j, m + j)] = 1.0;
            for i in 0..=j {
                let q = stiffness(t, i, j);
                (v[(m + i, j)], v[(m + j, i)]) = (-q, -q);
            }
        }
    };
    Ok(Flow::of_time(group, LeftTranslation, field))
}

/// Mathieu's equation ẍ + (a − 2q cos 2t)x = 0 on Sp(2), of period π.
///
/// ```
/// use lieflow::methods::magnus::Magnus6;
/// use lieflow::problems::{floquet, mathieu, monodromy};
/// use std::f64::consts::PI;
/// let stable = floquet(&monodromy(&mathieu(1.0, 0.0)?, &Magnus6, [0.0, PI], 20)?)?;
/// assert!(stable.spectral_radius() < 1.0 + 1e-7);
/// let resonant = floquet(&monodromy(&mathieu(1.0, 0.3)?, &Magnus6, [0.0, PI], 20)?)?;
/// assert!(resonant.spectral_radius() > 1.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::OutOfRange`] for numbers that are not finite.
pub fn mathieu(
    a: f64,
    q: f64,
) -> Result<LinearHamiltonian<impl Fn(f64, &mut AlgebraMatrix)>, Error> {
    check_finite("a", &[a])?;
    check_finite("q", &[q])?;
    hill(1, move |t, _, _| a - 2.0 * q * (2.0 * t).cos())
}

/// g at the end of `span` with g = 𝟙 at its start, by `steps` steps: over a period, the monodromy.
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
    /// (re, im) of each, by falling modulus.
    pub multipliers: Vec<[f64; 2]>,
}

impl Floquet {
    /// max |λ|: 1 to rounding where solutions stay bounded, more where some grow.
    ///
    /// Where two multipliers meet on the circle, rounding in M moves them apart by its root.
    pub fn spectral_radius(&self) -> f64 {
        self.multipliers.first().map_or(0.0, |[re, im]| re.hypot(*im))
    }
    /// ln|λ| / period of the fastest growing solution, its Lyapunov exponent.
    pub fn growth(&self, period: f64) -> f64 {
        self.spectral_radius().ln() / period
    }
}

/// The Floquet multipliers of M.
///
/// # Errors
/// [`Error::NotFiniteEntry`]; [`Error::Map`] when the eigenvalues do not converge.
pub fn floquet(monodromy: &GroupMatrix) -> Result<Floquet, Error> {
    let m: &Mat<f64> = monodromy;
    MatrixGroup::gl(m.nrows())?.shape("M", m.as_ref())?;
    let failed = crate::StepError::NotConverged { what: "the eigenvalues of M" };
    let values = m.eigenvalues().map_err(|_| failed)?;
    let mut multipliers: Vec<_> = values.iter().map(|z| [z.re, z.im]).collect();
    multipliers.sort_by(|a, b| b[0].hypot(b[1]).total_cmp(&a[0].hypot(a[1])));
    Ok(Floquet { multipliers })
}
