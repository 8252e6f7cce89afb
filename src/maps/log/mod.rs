//! log : G → 𝔤, the logarithm of a matrix group, the inverse of exp near 𝟙: the principal one, and where
//! negative eigenvalues come in pairs one with turns by π.
//!
//! | | how |
//! |---|---|
//! | ‖g − 𝟙‖₁ ≤ 0.264 | the \[7/7\] Padé approximant of log(𝟙 + x) by its partial fractions, x = g − 𝟙 |
//! | U(n), SU(n) | complex Schur form, the angles of its diagonal; on SU(n) with the sum 0 |
//! | SO(n) | real Schur form: planes turned by θ = atan2(sin θ, cos θ); eigenvalues −1 in pairs |
//! | otherwise | complex Schur form, square roots of the triangle until the first case, scaled back |
//! | eigenvalues −λ in pairs | the same for g(𝟙 − 2P), and a turn by π in each pair: `half_turns.rs` |
//!
//! The result is projected onto the algebra. Source: N. J. Higham, Functions of Matrices, SIAM 2008,
//! chapter 11; A. H. Al-Mohy, N. J. Higham, SIAM J. Sci. Comput. 34 (2012).

mod half_turns;
mod rotation;
mod schur;
mod triangular;
mod unitary;

use faer::{Mat, c64};
use triangular::{NO_DIGITS, Negative};

use super::functions::LogGroup;
use crate::dense::{Lu, RCOND_MIN, is_finite, norm_frobenius, norm1, scaled_sum};
use crate::error::{Error, NoLogarithm, StepError};
use crate::groups::{Adjoint, AlgebraMatrix, Form, GroupMatrix, LieAlgebra, LieGroup, MatrixGroup};
use crate::quadrature::GAUSS_LEGENDRE7;
use crate::so3::POLAR_MAX;

/// Up to this 1-norm of x the \[7/7\] approximant of log(𝟙 + x) is exact to rounding.
const THETA: f64 = 0.264;

/// Relative residual of a turn by π in 𝔤: rounding, times the condition of its eigenspace.
const IN_ALGEBRA: f64 = 1e-8;

impl MatrixGroup {
    /// log(g): the real u ∈ 𝔤 with exp(u) = g whose eigenvalues have imaginary parts in (−π, π), or
    /// ±π where g has negative eigenvalues.
    ///
    /// On SO(n) every g has a logarithm: a pair of eigenvalues −1 is a turn by π in the plane of its
    /// two Schur vectors, in the direction from the first to the second. On SU(n) eigenvalues whose angles in (−π, π\] have
    /// another sum than 0 have some of them outside of that: u has trace 0. So it is elsewhere with negative
    /// eigenvalues of even multiplicity that have as many eigenvectors, if 𝔤 has such a turn: one of
    /// several real logarithms then, continuous in g nowhere near. A g that is off the group by
    /// at most 1e-5 is taken for the nearby element, with an error of that size.
    ///
    /// ```
    /// use lieflow::groups::MatrixGroup;
    /// let so2 = MatrixGroup::so(2)?;
    /// let quarter = so2.element(lieflow::faer::mat![[0.0, -1.0], [1.0, 0.0]])?;
    /// let u = so2.log(&quarter)?;
    /// assert!((u[(1, 0)] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    /// # Ok::<(), lieflow::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`element`](Self::element), with [`Error::Reflection`] for determinant −1 on SO(n), and [`Error::Singular`] on each
    /// group that is not compact: the error is about ε·cond(g);
    /// [`Error::NoLogarithm`] with a negative eigenvalue that is not as above, and the reason: there is
    /// no real logarithm at all, none in 𝔤, it is not decided, or rounding leaves it no digits;
    /// [`Error::Map`] when an iteration does not converge or the result is not finite. Cost: O(n³),
    /// some 30 products, and that of [`project_algebra`](Self::project_algebra), which is more on G_M with an M that is
    /// neither symmetric nor skew; allocates.
    pub fn log(&self, g: &GroupMatrix) -> Result<AlgebraMatrix, Error> {
        // A clone: what was made unchecked is checked here.
        let g = self.element_within((**g).clone(), POLAR_MAX)?.into_mat();
        if !matches!(self.form(), Form::Free | Form::Identity) {
            self.check_condition(&g)?;
        }
        let n = self.n();
        let mut x = g.clone();
        for i in 0..n {
            x[(i, i)] -= 1.0;
        }
        let u = if norm1(x.as_ref()) <= THETA {
            self.project_algebra(near_identity(&x).as_ref())
        } else if self.is_complex() {
            self.project_algebra(unitary::log(&g, self.is_special())?.as_ref())
        } else if matches!(self.form(), Form::Identity) {
            self.project_algebra(rotation::log(&g)?.as_ref())
        } else {
            self.projected(&self.log_by_triangle(&g)?, &g)?
        };
        if is_finite(&u) { Ok(u) } else { Err(StepError::NotFinite { what: "log(g)" }.into()) }
    }
}

impl MatrixGroup {
    /// The logarithm u of g, projected onto 𝔤. Beside half turns the part of u that is not in 𝔤 is as large as what u has lost.
    fn projected(&self, u: &Mat<f64>, g: &Mat<f64>) -> Result<AlgebraMatrix, Error> {
        let found = self.project_algebra(u.as_ref());
        let moved = norm_frobenius(&(u - &*found));
        if moved > NO_DIGITS * norm_frobenius(u).max(1.0) + self.distance_to_group(g) {
            let eigenvalues = g.eigenvalues().unwrap_or_default();
            let turned = |z: &c64| z.arg().abs();
            let nearest = eigenvalues.iter().max_by(|a, b| turned(a).total_cmp(&turned(b)));
            let z = nearest.copied().unwrap_or(c64::ONE);
            let (group, why) = (self.name(), NoLogarithm::NoDigits);
            return Err(Error::NoLogarithm { group, re: z.re, im: z.im, why });
        }
        Ok(found)
    }

    /// How far a logarithm of g may be from 𝔤 because g is off the group.
    fn distance_to_group(&self, g: &Mat<f64>) -> f64 {
        if matches!(self.form(), Form::Free) {
            return POLAR_MAX;
        }
        let mut g = GroupMatrix::new_unchecked(g.clone());
        let [mut a, mut b] = [self.identity(), self.identity()];
        10.0 * self.correct(&mut g, [&mut a, &mut b])
    }

    /// The small eigenvalues of a g that is far from 𝟙 are the rounding of the large ones.
    fn check_condition(&self, g: &Mat<f64>) -> Result<(), Error> {
        let g = GroupMatrix::new_unchecked(g.clone());
        let mut inverse = g.clone();
        self.invert(&g, &mut self.inverting(), &mut inverse)?;
        let rcond = 1.0 / (norm1(g.as_ref()) * norm1(inverse.as_ref()));
        match rcond < RCOND_MIN {
            true => Err(Error::Singular { arg: "g", rcond, minimum: RCOND_MIN }),
            false => Ok(()),
        }
    }

    /// Where negative eigenvalues come in pairs, with a turn by π taken out.
    fn log_by_triangle(&self, g: &Mat<f64>) -> Result<Mat<f64>, Error> {
        let refuse =
            |z: c64, why| Error::NoLogarithm { group: self.name(), re: z.re, im: z.im, why };
        let negative = match triangular::log(g)? {
            Ok(u) => return Ok(u),
            Err(Negative { eigenvalues, has_no_digits: true, .. }) => {
                return Err(refuse(eigenvalues[0], NoLogarithm::NoDigits));
            }
            Err(negative) => negative,
        };
        let (rest, turn) = half_turns::apart(g, self.ad_form().as_ref(), &negative)
            .map_err(|(z, why)| refuse(z, why))?;
        // Where M is neither symmetric nor skew the turn keeps one part of it, perhaps not the other.
        if self.algebra_within(turn.clone(), IN_ALGEBRA).is_err() {
            return Err(refuse(negative.eigenvalues[0], NoLogarithm::Undecided));
        }
        match triangular::log(&rest)? {
            Ok(u) => {
                let u = u + turn;
                match triangular::is_log(&u, g) {
                    true => Ok(u),
                    false => Err(refuse(negative.eigenvalues[0], NoLogarithm::NoDigits)),
                }
            }
            Err(Negative { eigenvalues, has_no_digits: true, .. }) => {
                Err(refuse(eigenvalues[0], NoLogarithm::NoDigits))
            }
            Err(Negative { eigenvalues, .. }) => {
                Err(refuse(eigenvalues[0], NoLogarithm::Undecided))
            }
        }
    }
}

/// log(𝟙 + x) for ‖x‖₁ ≤ [`THETA`]; relative to x, however small.
fn near_identity(x: &Mat<f64>) -> Mat<f64> {
    let n = x.nrows();
    let (mut sum, mut lu) = (Mat::zeros(n, n), Lu::new(n));
    for (t, w) in GAUSS_LEGENDRE7 {
        scaled_sum(&mut lu.a, [t], [x], 1.0);
        lu.factor();
        let mut y = x.clone();
        lu.solve(y.as_mut());
        crate::dense::axpy(w, &y, &mut sum);
    }
    sum
}

impl LogGroup for MatrixGroup {
    fn log_of(&self, g: &GroupMatrix) -> Result<AlgebraMatrix, Error> {
        self.log(g)
    }
}
