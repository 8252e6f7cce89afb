//! The monodromy M = g(T) of a linear system with periodic coefficients, its Floquet multipliers and its stability.
//!
//! On Sp(2m) the multipliers come in pairs λ, 1/λ. The system is stable if all of them are distinct and on the unit
//! circle. At a characteristic value of Mathieu's equation two of them meet: tr M = ±2.
//! Source: V. A. Yakubovich, V. M. Starzhinskii, Linear Differential Equations with Periodic
//! Coefficients, 1975.

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

use crate::actions::LeftTranslation;
use crate::dense::{largest_entry, multiply};
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
    /// digits of M ∓ 𝟙, and tr M has none. The growth is arsinh √D. For larger m the growth is that of the fastest multiplier
    /// that no change of M by `error` can put on the circle: more than 4m·`error`‖P‖ a period, where P projects on the vector
    /// of the multiplier. ‖P‖ is 1 if M is normal, and about 1/growth where two multipliers with one vector nearly meet. Where
    /// no growth is seen, powers of M tell whether solutions grow with the number of periods.
    ///
    /// # Errors
    /// As [`Floquet::of`].
    pub fn of(m: &Mat<f64>, error: f64) -> Result<Self, Error> {
        let floquet = Floquet::of_matrix(m)?;
        // An unknown error counts as 0.
        let error = error.max(0.0);
        let mut root = 10.0 * error.sqrt();
        let growth = if m.nrows() == 2 {
            let (p, b, c) = (0.5 * (m[(0, 0)] - m[(1, 1)]), m[(0, 1)], m[(1, 0)]);
            let d = p * p + b * c;
            let unsure = (2.0 * p.abs() + b.abs() + c.abs() + error) * error;
            if d.is_finite() && d.abs() > unsure {
                return Ok(Stability { growth: d.max(0.0).sqrt().asinh(), is_bounded: d < 0.0 });
            }
            root = if d.is_finite() { unsure.sqrt() } else { 0.0 };
            let radius = floquet.spectral_radius();
            if radius - 1.0 > root { radius.ln() } else { 0.0 }
        } else {
            known_growth(m, &floquet.multipliers, error)?
        };
        if growth > 0.0 {
            return Ok(Stability { growth, is_bounded: false });
        }
        let sizes = sizes_of_powers(m);
        // Multipliers that count as one are nearer than `root`, which is no matter for so many periods.
        let many = root.recip().log2().clamp(5.0, 30.0) as usize;
        let grows = sizes[many] - sizes[many - 5] > 4.0;
        // Nor is what `error` makes of different ones.
        let far = (10.0 * error).recip().log2().clamp(10.0, 30.0) as usize;
        let is_bounded = !grows && (m.nrows() == 2 || sizes[far] - sizes[far - 10] < 5.0);
        Ok(Stability { growth, is_bounded })
    }
}

/// ln|λ| of the fastest multiplier λ that is farther from the circle than a change of M by `error` moves it, or 0 if all are
/// nearer.
///
/// To first order a change E of M moves the mean of a group of multipliers by ‖P‖‖E‖ at most, where P is the projector on
/// their space: P = X(YᵀX)⁻¹Yᵀ with the eigenvectors X of M and Y of Mᵀ. A group is λ with those that are nearest to it. So
/// a λ of several vectors has its place, and one that meets 1/λ on the circle has none, because P is large there.
fn known_growth(m: &Mat<f64>, multipliers: &[[f64; 2]], error: f64) -> Result<f64, Error> {
    let n = m.nrows();
    let failed = |_| StepError::NotConverged { what: "the eigenvectors of M" };
    // Of M in units of its largest entry: squares of entries may overflow.
    let scale = largest_entry(m.as_ref()).max(f64::MIN_POSITIVE);
    let scaled = Mat::from_fn(n, n, |i, j| m[(i, j)] / scale);
    let vectors = [scaled.eigen().map_err(failed)?, scaled.transpose().eigen().map_err(failed)?];
    let rounding = n as f64 * f64::EPSILON * scale;
    // ‖E‖ ≤ n·error, and twice that for multipliers that move as a root of E.
    let unsure = 2.0 * n as f64 * error.max(rounding);
    let off = |z: c64| z.norm() - 1.0;
    for z in multipliers.iter().map(|&[re, im]| c64::new(re, im)) {
        if off(z) <= unsure {
            break;
        }
        let near = vectors.each_ref().map(|vectors| {
            let values = vectors.S().column_vector();
            let mut near: Vec<usize> = (0..n).collect();
            let away = |i: usize| (values[i] - z / scale).norm();
            near.sort_by(|&a, &b| away(a).total_cmp(&away(b)));
            near
        });
        for size in 1..=n {
            let least = off(vectors[0].S()[near[0][size - 1]] * scale);
            if least <= unsure {
                break;
            }
            let [of_m, of_transposed] = [0, 1]
                .map(|side| Mat::from_fn(n, size, |i, j| vectors[side].U()[(i, near[side][j])]));
            let inner = of_transposed.transpose() * &of_m;
            let projector = &of_m * inner.partial_piv_lu().solve(of_transposed.transpose());
            if least > unsure * projector.norm_l2() {
                return Ok(z.norm().ln());
            }
        }
    }
    Ok(0.0)
}

/// log₂ of the largest entries of M to the powers 2ᵏ, k = 0 … 30. The powers themselves would overflow.
fn sizes_of_powers(m: &Mat<f64>) -> [f64; 31] {
    let (mut power, mut size) = (m.clone(), 0.0);
    core::array::from_fn(|k| {
        if k > 0 {
            power = multiply(power.as_ref(), power.as_ref());
            size *= 2.0;
        }
        let largest = largest_entry(power.as_ref());
        power.col_iter_mut().flat_map(|column| column.iter_mut()).for_each(|x| *x /= largest);
        size += largest.log2();
        size
    })
}
