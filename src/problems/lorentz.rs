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
use nalgebra::Vector3;

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
        super::rigid_body::check_finite("ratio", &[ratio])?;
        Ok(ChargedParticle { group: MatrixGroup::indefinite(3, 1)?, ratio, field })
    }
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
