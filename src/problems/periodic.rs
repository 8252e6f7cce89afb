//! Linear Hamiltonian systems ẏ = A(t)y, A(t) ∈ sp(2m), with periodic coefficients.
//!
//! [`floquet`](crate::floquet) decides whether y stays bounded.
//!
//! Hill: ẍ + Q(t)x = 0 is A = \[0 𝟙; −Q 0\] with y = (x, ẋ); Mathieu: Q = a − 2q cos 2t, of period π.
//! f(t, g) = A(t); Λ(a, g) = ag. Source: NIST DLMF, chapter 28.

use super::{Flow, LinearFlow};
use crate::actions::LeftTranslation;
use crate::error::Error;
use crate::groups::{AlgebraMatrix, MatrixGroup};

/// A linear Hamiltonian system ġ = A(t)g on Sp(2m). The function writes A(t).
pub type LinearHamiltonian<F> = LinearFlow<MatrixGroup, LeftTranslation, F>;

/// Hill's equation ẍ + Q(t)x = 0 for x ∈ ℝᵐ on Sp(2m). `stiffness(t, i, j)` is Q_ij(t) of a symmetric Q.
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
/// use lieflow::floquet::{Floquet, monodromy};
/// use lieflow::methods::magnus::Magnus6;
/// use lieflow::problems::mathieu;
/// use std::f64::consts::PI;
/// let stable = Floquet::of(&monodromy(&mathieu(1.0, 0.0)?, &Magnus6, [0.0, PI], 20)?)?;
/// assert!(stable.spectral_radius() < 1.0 + 1e-7);
/// let resonant = Floquet::of(&monodromy(&mathieu(1.0, 0.3)?, &Magnus6, [0.0, PI], 20)?)?;
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
    Error::finite("a", a)?;
    Error::finite("q", q)?;
    hill(1, move |t, _, _| a - 2.0 * q * (2.0 * t).cos())
}
