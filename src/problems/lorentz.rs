//! A charged particle by its four-velocity u, with the group SO(3,1).
//!
//! u̇ = (q/m) F(τ, u) u in the proper time τ of the particle. f = (q/m) F ∈ so(3,1); Λ(g, u) = g u. u = (γv, γ) in
//! units of c, with space first, as in M = diag(1, 1, 1, −1), and
//!
//! ```text
//!     F = ⎡ −B̂  E ⎤      d(γv)/dτ = (q/m) (γE + γv × B),   dγ/dτ = (q/m) E·γv
//!         ⎣ Eᵀ  0 ⎦
//! ```
//!
//! Invariant: u·Mu = −1 (by the action). Every exponential method is exact for a constant F.
//! Source: J. D. Jackson, Classical Electrodynamics, section 12.1.

use faer::Mat;
use nalgebra::{Matrix4, Vector3};

use super::{Invariant, Invariants, Problem};
use crate::actions::Linear;
use crate::error::Error;
use crate::groups::{AlgebraMatrix, MatrixGroup};
use crate::scalar::{Ops, tally};

/// A particle of charge-to-mass ratio q/m in the fields (E, B) that `field` gives at (τ, u).
///
/// ```
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{ChargedParticle, four_velocity};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
/// // A constant E: the rapidity of the particle grows at the rate E in proper time.
/// let field = |_: f64, _: &_| (Vector3::new(1.0, 0.0, 0.0), Vector3::zeros());
/// let particle = ChargedParticle::new(1.0, field)?;
/// let mut u = four_velocity([0.0; 3])?;
/// let grid = TimeGrid::new([0.0, 2.0], 0.5)?;
/// integrate(&particle, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut u, |_, _| {})?;
/// assert!((u[(0, 0)] - 2f64.sinh()).abs() < 1e-14 && (u[(3, 0)] - 2f64.cosh()).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ChargedParticle<F> {
    group: MatrixGroup,
    ratio: f64,
    field: F,
}

impl<F: Fn(f64, &Mat<f64>) -> (Vector3<f64>, Vector3<f64>)> ChargedParticle<F> {
    /// Makes the particle.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a ratio that is not finite.
    pub fn new(ratio: f64, field: F) -> Result<Self, Error> {
        Error::finite("ratio", ratio)?;
        Ok(ChargedParticle { group: MatrixGroup::indefinite(3, 1)?, ratio, field })
    }
}

/// exp(tF) for F ∈ so(3,1): the motion in constant fields, with (q/m) F in place of F.
///
/// F has the eigenvalues ±a and ±ib with a² − b² = E² − B² and ab = |E·B|. So exp(tF) is a polynomial of degree 3 in F, with
/// x = at, y = bt and
///
/// c₂ = (cosh x − cos y)/(x² + y²),    c₃ = (sinh x/x − sin y/y)/(x² + y²),    c₀ = cosh x − x²c₂,    c₁ = sinh x/x − x²c₃.
///
/// Where x² + y² < 1 these are sums of powers: scaling and squaring loses all digits for fields with E² = B² and E·B = 0 at a
/// large t, because F³ = 0 there. Entries beyond the range of f64 are infinite or NaN. Allocates.
///
/// # Errors
/// [`Error::Shape`] for an F that is not 4×4.
pub fn lorentz_transformation(tensor: &Mat<f64>, t: f64) -> Result<Mat<f64>, Error> {
    let (rows, cols) = tensor.shape();
    if (rows, cols) != (4, 4) {
        return Err(Error::Shape { arg: "F", rows, cols, expected_rows: 4, expected_cols: 4 });
    }
    let f = Matrix4::from_fn(|i, j| t * tensor[(i, j)]);
    let e = Vector3::new(f[(0, 3)], f[(1, 3)], f[(2, 3)]);
    let b = Vector3::new(f[(1, 2)], f[(2, 0)], f[(0, 1)]);
    let (sigma, pi) = ((e - b).dot(&(e + b)), e.dot(&b));
    // x² and y², of which the larger one is found first.
    let larger = 0.5 * (sigma.abs() + sigma.hypot(2.0 * pi));
    let smaller = if larger > 0.0 { pi / larger * pi } else { 0.0 };
    let [x2, y2] = if sigma >= 0.0 { [larger, smaller] } else { [smaller, larger] };
    let [c0, c1, c2, c3] = coefficients(x2, y2);
    let f2 = f * f;
    let g = Matrix4::from_diagonal_element(c0) + f * c1 + f2 * c2 + f2 * f * c3;
    Ok(Mat::from_fn(4, 4, |i, j| g[(i, j)]))
}

/// c₀ to c₃ of x² and y².
fn coefficients(x2: f64, y2: f64) -> [f64; 4] {
    let d = x2 + y2;
    if d < 1.0 {
        // Σ h_k/(2k + 2)! and so on, for h_k = Σ (x²)ⁱ(−y²)^(k − i).
        let mut sums = [0.0; 4];
        let (mut h, mut power, mut factorial) = (1.0, 1.0, 2.0);
        for k in 1..12 {
            let [n, m] = [f64::from(2 * k + 1), f64::from(2 * k + 2)];
            sums[2] += h / factorial;
            sums[3] += h / (factorial * n);
            factorial *= n * m;
            sums[0] += h / factorial;
            sums[1] += h / (factorial * (m + 1.0));
            power *= -y2;
            h = x2 * h + power;
        }
        return [1.0 + x2 * y2 * sums[0], 1.0 + x2 * y2 * sums[1], sums[2], sums[3]];
    }
    let [x, y] = [x2, y2].map(f64::sqrt);
    let sinh_by_x = if x > 0.0 { x.sinh() / x } else { 1.0 };
    let sin_by_y = if y > 0.0 { y.sin() / y } else { 1.0 };
    let [p, q] = [x2 / d, y2 / d];
    [
        q * x.cosh() + p * y.cos(),
        q * sinh_by_x + p * sin_by_y,
        (x.cosh() - y.cos()) / d,
        (sinh_by_x - sin_by_y) / d,
    ]
}

/// The four-velocity (γv, γ) of a velocity v in units of c, as a column.
///
/// # Errors
/// [`Error::OutOfRange`] for |v| ≥ 1 or not finite.
pub fn four_velocity(v: [f64; 3]) -> Result<Mat<f64>, Error> {
    let speed = Vector3::from(v).norm();
    if speed.is_nan() || speed >= 1.0 {
        return Err(Error::out_of_range("|v|", speed, "less than 1"));
    }
    let gamma = 1.0 / ((1.0 - speed) * (1.0 + speed)).sqrt();
    Ok(Mat::from_fn(4, 1, |i, _| if i < 3 { gamma * v[i] } else { gamma }))
}

impl<F: Fn(f64, &Mat<f64>) -> (Vector3<f64>, Vector3<f64>)> Problem for ChargedParticle<F> {
    type Group = MatrixGroup;
    type Action = Linear;
    type Work = ();

    fn group(&self) -> &MatrixGroup {
        &self.group
    }
    fn action(&self) -> &Linear {
        &Linear
    }
    fn work(&self) {}
    /// (q/m) F.
    fn f(&self, tau: f64, u: &Mat<f64>, f: &mut AlgebraMatrix, _: &mut ()) {
        let (e, b) = (self.field)(tau, u);
        f.fill(0.0);
        tally(|| Ops::muls(6));
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            (f[(i, 3)], f[(3, i)]) = (self.ratio * e[i], self.ratio * e[i]);
            (f[(k, j)], f[(j, k)]) = (-self.ratio * b[i], self.ratio * b[i]);
        }
    }
}

impl<F: Fn(f64, &Mat<f64>) -> (Vector3<f64>, Vector3<f64>)> Invariants for ChargedParticle<F> {
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::of_the_action("u·Mu", 2).in_terms()]
    }
    fn values(&self, u: &Mat<f64>) -> Vec<f64> {
        let square = |i: usize| u[(i, 0)] * u[(i, 0)];
        vec![square(0) + square(1) + square(2) - square(3)]
    }
    fn sizes(&self, u: &Mat<f64>) -> Vec<f64> {
        vec![u.squared_norm_l2()]
    }
}
