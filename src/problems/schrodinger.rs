//! Schrödinger's equation with n levels, iψ̇ = H(t)ψ, in real numbers.
//!
//! U(n) is the part of SO(2n) that commutes with the multiplication by i. With ψ = a + ib and H = R + iI (R symmetric,
//! I skew):
//!
//! ```text
//!     d ⎡ a ⎤   ⎡  I  R ⎤ ⎡ a ⎤
//!     ─ ⎢   ⎥ = ⎢       ⎥ ⎢   ⎥       f(t, ψ) ∈ u(n) ⊂ so(2n);  Λ(g, ψ) = gψ
//!     dt⎣ b ⎦   ⎣ −R  I ⎦ ⎣ b ⎦
//! ```
//!
//! Invariant: |ψ|² (by the action). Brackets and exponentials of elements of u(n) stay complex-linear, so all methods
//! conserve the complex structure to rounding.

use faer::Mat;

use super::{Flow, LinearFlow};
use crate::actions::Linear;
use crate::error::Error;
use crate::groups::{AlgebraMatrix, MatrixGroup};

/// Schrödinger's equation iψ̇ = H(t)ψ on SO(2n). The function writes the element of u(n).
pub type Schrodinger<F> = LinearFlow<MatrixGroup, Linear, F>;

/// Schrödinger's equation iψ̇ = H(t)ψ with n levels. `hamiltonian(t, i, j)` is (Re, Im) of H_ij.
///
/// It is called only for i ≤ j. The imaginary part of the diagonal is ignored.
///
/// ```
/// use lieflow::methods::magnus::Magnus4;
/// use lieflow::problems::{amplitudes, populations, schrodinger};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// // A π pulse on resonance, in the rotating frame: all of level 0 goes to level 1.
/// let pulse = schrodinger(2, |_, i, j| if i == j { [0.0, 0.0] } else { [0.5, 0.0] })?;
/// let mut psi = amplitudes(&[[1.0, 0.0], [0.0, 0.0]])?;
/// let grid = TimeGrid::with_steps([0.0, std::f64::consts::PI], 8)?;
/// integrate(&pulse, &Magnus4, &grid, &SaveAt::Ends, &mut psi, |_, _| {})?;
/// assert!((populations(&psi)[1] - 1.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::OutOfRange`] as [`MatrixGroup::so`].
pub fn schrodinger<H: Fn(f64, usize, usize) -> [f64; 2]>(
    n: usize,
    hamiltonian: H,
) -> Result<Schrodinger<impl Fn(f64, &mut AlgebraMatrix)>, Error> {
    let group = MatrixGroup::so(n.saturating_mul(2))?;
    let field = move |t: f64, v: &mut AlgebraMatrix| {
        for j in 0..n {
            for i in 0..=j {
                let [re, im] = hamiltonian(t, i, j);
                let im = if i == j { 0.0 } else { im };
                for (i, j, im) in [(i, j, im), (j, i, -im)] {
                    (v[(i, j)], v[(n + i, n + j)]) = (im, im);
                    (v[(i, n + j)], v[(n + i, j)]) = (re, -re);
                }
            }
        }
    };
    Ok(Flow::of_time(group, Linear, field))
}

/// The state with these complex amplitudes (re, im), normalised to length 1.
///
/// # Errors
/// [`Error::OutOfRange`] for numbers that are not finite, and for ψ = 0.
pub fn amplitudes(psi: &[[f64; 2]]) -> Result<Mat<f64>, Error> {
    let norm = psi.iter().map(|[re, im]| re * re + im * im).sum::<f64>().sqrt();
    if !(norm.is_finite() && norm > 0.0) {
        return Err(Error::out_of_range("|ψ|", norm, "a finite number > 0"));
    }
    let n = psi.len();
    Ok(Mat::from_fn(2 * n, 1, |i, _| psi[i % n][i / n] / norm))
}

/// |ψ_i|² of each level.
pub fn populations(psi: &Mat<f64>) -> Vec<f64> {
    let n = psi.nrows() / 2;
    (0..n).map(|i| psi[(i, 0)].powi(2) + psi[(n + i, 0)].powi(2)).collect()
}
