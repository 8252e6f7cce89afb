//! Lie algebras 𝔤 and Lie groups G as values.
//!
//! A type with [`LieAlgebra`] and [`LieGroup`] is a *value* that knows n and the matrix M of G_M. Elements are plain
//! data. Every operation takes the group first, then inputs, then the output. It allocates only if it returns new
//! storage.
//!
//! To add a group: one file with these traits, one file for its maps in `maps/`, one line in both modules, one line in
//! the law tests. A matrix group needs no file: it is a constructor of [`MatrixGroup`].

mod adjoint;
#[cfg(feature = "dense")]
mod matrix;
mod power;
mod product;
mod quaternions;
mod se23;
mod se3;
mod so3;
mod translations;
#[cfg(feature = "dense")]
mod unitary;

pub use crate::error::RCOND_MIN;
pub use crate::so3::{hat, vee};
pub use adjoint::Adjoint;
#[cfg(feature = "dense")]
pub use matrix::{AlgebraMatrix, Form, GroupMatrix, MatrixGroup};
#[cfg(feature = "dense")]
pub(crate) use matrix::{correct_length, finite as check_entries};
pub use power::Power;
pub use product::Product;
pub(crate) use product::worse;
pub use quaternions::UnitQuaternions;
pub use se3::Se3;
pub(crate) use se3::finite_pair;
pub use se23::Se23;
pub(crate) use se23::finite_three;
pub use so3::So3;
pub use translations::Translations;
#[cfg(feature = "dense")]
pub use unitary::{ComplexMatrix, Unitary};
#[cfg(feature = "dense")]
pub(crate) use unitary::{minus_adjoint, mul_adjoint_skew, mul_complex};

use rand::Rng;

use crate::error::Error;
use crate::scalar::{Real, infinite_or_nan};
use crate::space::{Gap, Metric};
use crate::tolerance::Scales;

/// A Lie algebra 𝔤: a linear space with a bracket.
pub trait LieAlgebra: Send + Sync {
    /// The type of real coefficients.
    type Scalar: Real;
    /// An element u ∈ 𝔤.
    type Alg: Clone + Send + Sync;

    /// The name of the group. Example: `SO(3)`.
    fn name(&self) -> String;
    /// dim 𝔤.
    fn dim(&self) -> usize;
    /// Makes new storage with 0 ∈ 𝔤.
    fn zero(&self) -> Self::Alg;
    /// u ← 0.
    fn set_zero(&self, u: &mut Self::Alg);
    /// y ← y + a·x.
    fn axpy(&self, a: Self::Scalar, x: &Self::Alg, y: &mut Self::Alg);
    /// out ← \[u, v\].
    fn bracket(&self, u: &Self::Alg, v: &Self::Alg, out: &mut Self::Alg);
    /// ‖u‖, the norm that error control and tests use.
    fn norm(&self, u: &Self::Alg) -> Self::Scalar;
    /// True if every number in u is finite.
    fn is_finite(&self, u: &Self::Alg) -> bool;

    /// Checks that u is in 𝔤. The default accepts every u, for storage that holds only elements of 𝔤.
    ///
    /// # Errors
    /// [`Error::Shape`] and [`Error::NotInAlgebra`] with the name `arg`. Numbers that are not finite
    /// are accepted here.
    fn check(&self, arg: &'static str, u: &Self::Alg) -> Result<(), Error> {
        self.check_shape(arg, u)
    }

    /// Checks the sizes of u alone, where its storage has any.
    ///
    /// # Errors
    /// [`Error::Shape`] with the name `arg`.
    fn check_shape(&self, _arg: &'static str, _u: &Self::Alg) -> Result<(), Error> {
        Ok(())
    }

    /// True if the storage of u can hold more than 𝔤, as n×n matrices do for 𝔰𝔬(n). The driver then looks at f during a run.
    #[inline]
    fn holds_more(&self) -> bool {
        false
    }

    /// The distance of u from 𝔤, as ‖uᵀM + Mu‖/‖M‖ on a matrix group; 0 where the storage holds 𝔤 alone. Allocates nothing.
    #[inline]
    fn off_algebra(&self, _u: &Self::Alg) -> Self::Scalar {
        Self::Scalar::lit(0.0)
    }

    /// u ← Σ_j h·w_j·k_j over the nonzero weights.
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

/// A Lie group G with its algebra.
pub trait LieGroup: LieAlgebra {
    /// An element g ∈ G.
    type Elem: Metric<Scalar = Self::Scalar> + Clone;
    /// A vector of the standard representation (or several, as columns).
    type Vector: Metric<Scalar = Self::Scalar> + Clone;

    /// Makes new storage with 𝟙 ∈ G.
    fn identity(&self) -> Self::Elem;
    /// out ← a·b.
    fn compose(&self, a: &Self::Elem, b: &Self::Elem, out: &mut Self::Elem);
    /// y ← g·x.
    fn apply(&self, g: &Self::Elem, x: &Self::Vector, y: &mut Self::Vector);
    /// out ← v·g = d/dε Ψ(εv)·g at ε = 0: a tangent of G at g, right trivialised.
    fn tangent(&self, v: &Self::Alg, g: &Self::Elem, out: &mut Self::Elem);
    /// y ← v·x = d/dε Ψ(εv)·x at ε = 0.
    fn apply_algebra(&self, v: &Self::Alg, x: &Self::Vector, y: &mut Self::Vector);
    /// An error e ∈ 𝔤 at g, which acts from the left or from the right, in units of the tolerance: ‖e‖/(atol + rtol).
    ///
    /// ‖e‖ counts as an angle in radian. It is the angle on [`So3`] and on unit quaternions. On matrices of any size it is the
    /// Frobenius norm, √2 times the angle of a rotation in one plane. The error of a part that is a linear space is that of the
    /// place to which exp(e) moves it. A product returns the largest ratio of its parts.
    #[inline]
    fn error_ratio(
        &self,
        e: &Self::Alg,
        _g: &Self::Elem,
        _from_right: bool,
        scales: &mut Scales<'_>,
    ) -> Self::Scalar {
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
        x.error_ratio(Gap::relative(self.norm(e)), scales)
    }
    /// ‖a − b‖ (Frobenius).
    fn distance(&self, a: &Self::Elem, b: &Self::Elem) -> Self::Scalar;
    /// The distance of g from G: ‖gᵀMg − M‖ (Frobenius), zero for GL(n).
    fn defect(&self, g: &Self::Elem) -> Self::Scalar;

    /// Checks the size of g, and that its numbers are finite. The driver calls this for the start of a run and, by
    /// default, after every step. The default checks that ‖g‖ is finite; it does not know a size.
    ///
    /// # Errors
    /// [`Error::Shape`] with both sizes, [`Error::NotFiniteEntry`], [`Error::OutOfRange`].
    fn check_elem(&self, g: &Self::Elem) -> Result<(), Error> {
        check_norm(g.size())
    }
    /// Checks, at the start of a run, what neither the form of G nor [`correct`](Self::correct) sees: determinants on SL(n)
    /// and SU(n), the blocks of complex matrices, reflections.
    ///
    /// # Errors
    /// [`Error::Determinant`], [`Error::Reflection`], [`Error::NotOnGroup`].
    fn check_member(&self, _g: &Self::Elem) -> Result<(), Error> {
        Ok(())
    }
    /// Checks a vector as [`check_elem`](Self::check_elem) checks an element.
    ///
    /// # Errors
    /// As [`check_elem`](Self::check_elem).
    fn check_vector(&self, x: &Self::Vector) -> Result<(), Error> {
        check_norm(x.size())
    }

    /// True if every number in x is finite. A product g·x may overflow although g and x do not. The default looks at ‖x‖. A group
    /// whose products cannot overflow returns true.
    #[inline]
    fn is_finite_vector(&self, x: &Self::Vector) -> bool {
        x.size().is_finite()
    }

    /// The size that a residual of g is relative to: 1 on a compact group, max(1, ‖g‖²) where elements may be large; on G_M
    /// that times ‖M‖‖M⁻¹‖/n, where this is above 10.
    fn residual_size(&self, _g: &Self::Elem) -> Self::Scalar {
        Self::Scalar::lit(1.0)
    }
    /// Corrects a g that rounding errors moved off G. Returns the residual ‖M⁻¹gᵀMg − 𝟙‖ before the correction.
    ///
    /// The correction is Newton–Schulz in residual form. For M symmetric or skew it is g ← g + g(𝟙 − M⁻¹gᵀMg)/2.
    ///
    /// g is not changed in five cases:
    ///
    /// - its residual is at rounding level, ε‖g‖²;
    /// - its residual is [`RESIDUAL_MAX`] or more;
    /// - for this M no step is known to converge;
    /// - M is far from a multiple of an orthogonal matrix, ‖M‖‖M⁻¹‖ > 10 n;
    /// - ‖g‖² is so large on a non-compact group, 90 and more above n, that the rounding of the correction moves g by more than a
    ///   run does.
    ///
    /// On a non-compact group the rounding level grows with ‖g‖², so compare the returned residual with it. Groups without a form
    /// return 0.
    ///
    /// `scratch` is overwritten. Nothing is allocated.
    fn correct(&self, _g: &mut Self::Elem, _scratch: [&mut Self::Elem; 2]) -> Self::Scalar {
        Self::Scalar::lit(0.0)
    }

    /// Corrects an x that rounding errors moved off the orbit G·`from`.
    ///
    /// On SO(3) it is x ← x + ½x(|from|² − |x|²)/|from|². Returns the residual ||x|²/|from|² − 1| before the
    /// correction. The default does nothing and returns `None`.
    /// On [`MatrixGroup`] with a form M it is the nearest x with the same xᵀMx, to first order: for k
    /// columns O(k²n), with a general M O(k²n²).
    ///
    /// x is not changed if its residual is [`RESIDUAL_MAX`] or more, or if |from|² overflows or underflows.
    #[inline]
    fn correct_vector(&self, _from: &Self::Vector, _x: &mut Self::Vector) -> Option<Self::Scalar> {
        None
    }
}

/// Checks that the norm of a state is finite.
#[inline]
fn check_norm<S: Real>(norm: S) -> Result<(), Error> {
    match norm.is_finite() {
        true => Ok(()),
        false => Err(Error::out_of_range("y", infinite_or_nan(norm), "finite numbers")),
    }
}

/// The default tolerance of membership: the relative residual that checked constructors allow.
pub const MEMBERSHIP: f64 = 1e-12;

/// The largest relative distance from M of a point that a user gives to a run.
pub(crate) const OFF_M_MAX: f64 = 1e-6;

/// The smallest residual at which Newton–Schulz might not converge. Then g is not corrected.
pub const RESIDUAL_MAX: f64 = 0.1;

/// A group with random elements.
pub trait Sample: LieGroup {
    /// A random u ∈ 𝔤. Its coordinates in an orthonormal basis of 𝔤 are independent Gaussians of
    /// standard deviation `sigma`.
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> Self::Alg;
    /// A random g ∈ G, by Haar's measure on a compact group. A non-compact group has no invariant probability measure;
    /// there g is the exponential of a Gaussian element of the algebra of standard deviation 1/2.
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> Self::Elem;
    /// A Gaussian vector of the standard representation.
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Self::Vector;
}
