//! Quantum systems with n levels in real numbers: iψ̇ = H(t)ψ, and iρ̇ = \[H(t), ρ\] for a density matrix.
//!
//! U(n) is the part of SO(2n) that commutes with the multiplication by i. With ψ = a + ib, ρ = A + iB and H = R + iI (R,
//! A symmetric, I, B skew):
//!
//! ```text
//!     d ⎡ a ⎤   ⎡  I  R ⎤ ⎡ a ⎤
//!     ─ ⎢   ⎥ = ⎢       ⎥ ⎢   ⎥       f(t, ψ) ∈ u(n) ⊂ so(2n);  Λ(g, ψ) = gψ
//!     dt⎣ b ⎦   ⎣ −R  I ⎦ ⎣ b ⎦
//!
//!           ⎡ A  −B ⎤
//!       ρ ↦ ⎢       ⎥                 the same f;  Λ(g, ρ) = gρgᵀ
//!           ⎣ B   A ⎦
//! ```
//!
//! Invariants (by the action): |ψ|²; the eigenvalues of ρ, so its trace and tr ρ². Brackets and exponentials of elements
//! of u(n) stay complex-linear, so all methods conserve the complex structure to rounding.

use faer::Mat;

use super::{Flow, LinearFlow};
use crate::actions::{Conjugation, Linear};
use crate::dense::symmetric_eigenvalues;
use crate::error::Error;
use crate::groups::{AlgebraMatrix, MatrixGroup};

/// Schrödinger's equation iψ̇ = H(t)ψ on SO(2n). The function writes the element of u(n).
pub type Schrodinger<F> = LinearFlow<MatrixGroup, Linear, F>;

/// Von Neumann's equation iρ̇ = \[H(t), ρ\] on SO(2n). The function writes the element of u(n).
pub type VonNeumann<F> = LinearFlow<MatrixGroup, Conjugation, F>;

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
    let group = MatrixGroup::u(n)?;
    Ok(Flow::of_time(group, Linear, generator(n, hamiltonian)))
}

/// Von Neumann's equation iρ̇ = \[H(t), ρ\] of a density matrix with n levels. `hamiltonian` is as of [`schrodinger`].
///
/// ```
/// use lieflow::methods::magnus::Magnus4;
/// use lieflow::problems::{density_matrix, populations_of, von_neumann};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// // A π pulse turns a mixture of 80 % and 20 % around.
/// let pulse = von_neumann(2, |_, i, j| if i == j { [0.0, 0.0] } else { [0.5, 0.0] })?;
/// let mut rho = density_matrix(2, |i, j| if i == j { [[0.8, 0.2][i], 0.0] } else { [0.0; 2] })?;
/// let grid = TimeGrid::with_steps([0.0, std::f64::consts::PI], 8)?;
/// integrate(&pulse, &Magnus4, &grid, &SaveAt::Ends, &mut rho, |_, _| {})?;
/// assert!((populations_of(&rho)[0] - 0.2).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::OutOfRange`] as [`MatrixGroup::so`].
pub fn von_neumann<H: Fn(f64, usize, usize) -> [f64; 2]>(
    n: usize,
    hamiltonian: H,
) -> Result<VonNeumann<impl Fn(f64, &mut AlgebraMatrix)>, Error> {
    let group = MatrixGroup::u(n)?;
    Ok(Flow::of_time(group, Conjugation, generator(n, hamiltonian)))
}

/// v ← −iH(t) as an element of so(2n).
fn generator<H: Fn(f64, usize, usize) -> [f64; 2]>(
    n: usize,
    hamiltonian: H,
) -> impl Fn(f64, &mut AlgebraMatrix) {
    move |t: f64, v: &mut AlgebraMatrix| {
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
    }
}

/// The state with these complex amplitudes (re, im), normalised to length 1.
///
/// # Errors
/// [`Error::OutOfRange`] for numbers that are not finite, and for ψ = 0.
pub fn amplitudes(psi: &[[f64; 2]]) -> Result<Mat<f64>, Error> {
    let norm = psi.iter().map(|[re, im]| re * re + im * im).sum::<f64>().sqrt();
    let norm = Error::positive("|ψ|", norm)?;
    let n = psi.len();
    Ok(Mat::from_fn(2 * n, 1, |i, _| psi[i % n][i / n] / norm))
}

/// |ψ_i|² of each level.
pub fn populations(psi: &Mat<f64>) -> Vec<f64> {
    let n = psi.nrows() / 2;
    (0..n).map(|i| psi[(i, 0)].powi(2) + psi[(n + i, 0)].powi(2)).collect()
}

/// The density matrix with these complex entries (re, im), divided by its trace. `entry(i, j)` is called only for i ≤ j, and
/// the imaginary part of the diagonal is ignored.
///
/// # Errors
/// [`Error::OutOfRange`] for a trace that is not finite and > 0, and for a negative eigenvalue beyond rounding.
pub fn density_matrix(
    n: usize,
    entry: impl Fn(usize, usize) -> [f64; 2],
) -> Result<Mat<f64>, Error> {
    let trace: f64 = (0..n).map(|i| entry(i, i)[0]).sum();
    Error::positive("tr ρ", trace)?;
    let mut rho = Mat::zeros(2 * n, 2 * n);
    for j in 0..n {
        for i in 0..=j {
            let [re, im] = entry(i, j).map(|x| x / trace);
            let im = if i == j { 0.0 } else { im };
            for (i, j, im) in [(i, j, im), (j, i, -im)] {
                (rho[(i, j)], rho[(n + i, n + j)]) = (re, re);
                (rho[(n + i, j)], rho[(i, n + j)]) = (im, -im);
            }
        }
    }
    let least = symmetric_eigenvalues(rho.as_ref()).map_or(f64::NAN, |values| values[0]);
    match least >= -POSITIVE {
        true => Ok(rho),
        false => Err(Error::out_of_range("the least eigenvalue of ρ/tr ρ", least, "at least 0")),
    }
}

/// How far below 0 the rounding of written entries may move an eigenvalue, for a trace of 1.
const POSITIVE: f64 = 1e-12;

/// ρ_ii of each level.
pub fn populations_of(rho: &Mat<f64>) -> Vec<f64> {
    (0..rho.nrows() / 2).map(|i| rho[(i, i)]).collect()
}
