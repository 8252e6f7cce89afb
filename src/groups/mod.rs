//! 𝔤 and G: Lie algebras and Lie groups as values.
//!
//! The implementor of [`LieAlgebra`] and [`LieGroup`] is a *value* (it knows n and the matrix M of
//! G_M); elements are plain data. Every operation takes the group first, then inputs, then the
//! output, and allocates nothing except where it returns fresh storage.
//!
//! To add a group: one file with these traits, one for its maps in `maps/`, one line in each room, one
//! line in the law tests. A matrix group needs no file: it is a constructor of [`MatrixGroup`].

mod adjoint;
mod matrix;
mod power;
mod product;
mod quaternions;
mod se3;
mod so3;
mod translations;
mod unitary;

pub use crate::dense::RCOND_MIN;
pub use crate::so3::{hat, vee};
pub use adjoint::Adjoint;
pub(crate) use matrix::finite as check_entries;
pub use matrix::{AlgebraMatrix, Form, GroupMatrix, MEMBERSHIP, MatrixGroup};
pub use power::Power;
pub use product::Product;
pub(crate) use product::worse;
pub use quaternions::UnitQuaternions;
pub use se3::Se3;
pub(crate) use se3::finite_pair;
pub use so3::So3;
pub use translations::Translations;
pub use unitary::{ComplexMatrix, Unitary};
pub(crate) use unitary::{mul_adjoint_skew, mul_complex};

use rand::Rng;

use crate::error::Error;
use crate::scalar::Real;
use crate::space::{Gap, Metric};
use crate::tolerance::Scales;

/// A Lie algebra 𝔤: a linear space with a bracket.
pub trait LieAlgebra {
    /// The reals that coefficients are in.
    type Scalar: Real;
    /// An element u ∈ 𝔤.
    type Alg: Clone;

    /// The name of the group, as `SO(3)`.
    fn name(&self) -> String;
    /// dim 𝔤.
    fn dim(&self) -> usize;
    /// Fresh storage holding 0 ∈ 𝔤.
    fn zero(&self) -> Self::Alg;
    /// u ← 0.
    fn set_zero(&self, u: &mut Self::Alg);
    /// y ← y + a·x.
    fn axpy(&self, a: Self::Scalar, x: &Self::Alg, y: &mut Self::Alg);
    /// out ← \[u, v\].
    fn bracket(&self, u: &Self::Alg, v: &Self::Alg, out: &mut Self::Alg);
    /// ‖u‖, the norm that error control and tests use.
    fn norm(&self, u: &Self::Alg) -> Self::Scalar;
    /// Is every number in u finite?
    fn is_finite(&self, u: &Self::Alg) -> bool;

    /// Is u in 𝔤? Storage that can hold nothing else says yes, which is the default.
    ///
    /// # Errors
    /// [`Error::Shape`] and [`Error::NotInAlgebra`] with the name `arg`; numbers that are not finite
    /// are no error here.
    fn check(&self, _arg: &'static str, _u: &Self::Alg) -> Result<(), Error> {
        Ok(())
    }

    /// u ← Σ_j h·w_j·k_j, over the nonzero weights only.
    #[inline]
    fn combine(&self, h: Self::Scalar, weights: &[f64], terms: &[Self::Alg], u: &mut Self::Alg) {
        self.set_zero(u);
        for (&w, k) in weights.iter().zip(terms) {
            if w != 0.0 {
                self.axpy(h * Self::Scalar::lit(w), k, u);
            }
        }
    }
}

/// A Lie group G over its algebra.
pub trait LieGroup: LieAlgebra {
    /// An element g ∈ G.
    type Elem: Metric<Scalar = Self::Scalar> + Clone;
    /// A vector of the standard representation (or several, as columns).
    type Vector: Metric<Scalar = Self::Scalar> + Clone;

    /// Fresh storage holding 𝟙 ∈ G.
    fn identity(&self) -> Self::Elem;
    /// out ← a·b.
    fn compose(&self, a: &Self::Elem, b: &Self::Elem, out: &mut Self::Elem);
    /// y ← g·x.
    fn apply(&self, g: &Self::Elem, x: &Self::Vector, y: &mut Self::Vector);
    /// out ← v·g = d/dε Ψ(εv)·g at ε = 0: a tangent of G at g, right trivialised.
    fn tangent(&self, v: &Self::Alg, g: &Self::Elem, out: &mut Self::Elem);
    /// y ← v·x = d/dε Ψ(εv)·x at ε = 0.
    fn apply_algebra(&self, v: &Self::Alg, x: &Self::Vector, y: &mut Self::Vector);
    /// An error e ∈ 𝔤 at g in units of the tolerance: ‖e‖/(atol + rtol), e being an angle. A part that is a linear
    /// space is compared with its size, and a product gives the largest ratio of its parts.
    #[inline]
    fn error_ratio(&self, e: &Self::Alg, _g: &Self::Elem, scales: &mut Scales<'_>) -> Self::Scalar {
        scales.part().ratio(self.norm(e), Self::Scalar::lit(1.0))
    }
    /// An error e ∈ 𝔤 at a vector in units of the tolerance: ‖e‖‖x‖/(atol + rtol·‖x‖).
    #[inline]
    fn vector_error_ratio(
        &self,
        e: &Self::Alg,
        x: &Self::Vector,
        scales: &mut Scales<'_>,
    ) -> Self::Scalar {
        x.error_ratio(Gap::Relative(self.norm(e)), scales)
    }
    /// ‖a − b‖ (Frobenius).
    fn distance(&self, a: &Self::Elem, b: &Self::Elem) -> Self::Scalar;
    /// How far g is from G: ‖gᵀMg − M‖ (Frobenius), zero for GL(n).
    fn defect(&self, g: &Self::Elem) -> Self::Scalar;

    /// Has g the size of this group's elements, and are its numbers finite? Asked once a run, of what a
    /// user hands in.
    ///
    /// # Errors
    /// [`Error::Shape`] with both sizes, [`Error::NotFiniteEntry`].
    fn check_elem(&self, _g: &Self::Elem) -> Result<(), Error> {
        Ok(())
    }
    /// Check a vector as [`check_elem`](Self::check_elem) checks an element.
    ///
    /// # Errors
    /// As [`check_elem`](Self::check_elem).
    fn check_vector(&self, _x: &Self::Vector) -> Result<(), Error> {
        Ok(())
    }

    /// out ← g, into the storage that there is. The default is `clone_from`, which allocates for storage
    /// that does not know better.
    #[inline]
    fn assign(&self, g: &Self::Elem, out: &mut Self::Elem) {
        out.clone_from(g);
    }
    /// y ← x, as [`assign`](Self::assign).
    #[inline]
    fn assign_vector(&self, x: &Self::Vector, y: &mut Self::Vector) {
        y.clone_from(x);
    }

    /// Is every number in x finite? A product g·x may leave the range where g and x do not.
    #[inline]
    fn is_finite_vector(&self, _x: &Self::Vector) -> bool {
        true
    }

    /// Take g back towards G, where rounding carried it off, by Newton–Schulz in residual form: where M
    /// is symmetric or skew g ← g + g(𝟙 − M⁻¹gᵀMg)/2. Returns the residual ‖M⁻¹gᵀMg − 𝟙‖ found before.
    ///
    /// Left alone are a g whose residual is at rounding level, ε‖g‖², one whose residual is
    /// [`RESIDUAL_MAX`] or more, and every g where M is such that no step is known to converge. On a non-compact group rounding level itself grows with ‖g‖²: what
    /// this returns is then the measure of membership. Groups without a form return 0.
    ///
    /// `scratch` is overwritten; nothing is allocated.
    fn correct(&self, _g: &mut Self::Elem, _scratch: [&mut Self::Elem; 2]) -> Self::Scalar {
        Self::Scalar::lit(0.0)
    }

    /// Take x back towards the orbit G·`from`, where rounding carried it off: on SO(3)
    /// x ← x + ½x(|from|² − |x|²)/|from|². Returns how far it was, ||x|²/|from|² − 1|, `None` where
    /// nothing is done, which is the default.
    ///
    /// Left alone is an x that is as far off as [`RESIDUAL_MAX`], and one on an orbit whose squares leave
    /// the range.
    #[inline]
    fn correct_vector(&self, _from: &Self::Vector, _x: &mut Self::Vector) -> Option<Self::Scalar> {
        None
    }
}

/// From this residual on Newton–Schulz might not converge: g is left alone.
pub const RESIDUAL_MAX: f64 = 0.1;

/// A group that random elements can be drawn from.
pub trait Sample: LieGroup {
    /// u ∈ 𝔤 whose coordinates in an orthonormal basis of 𝔤 are independent Gaussians of
    /// standard deviation `sigma`.
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> Self::Alg;
    /// g ∈ G: by Haar's measure on a compact group; elsewhere the exponential of a Gaussian element
    /// of the algebra of standard deviation 1/2, since there is no invariant probability measure.
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> Self::Elem;
    /// A Gaussian vector of the standard representation.
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Self::Vector;
}
