//! The group A × B of pairs. Each operation goes part by part.
//!
//! | | |
//! |---|---|
//! | \[(u, v), (u′, v′)\] | (\[u, u′\], \[v, v′\]) |
//! | (a, b)·(a′, b′) | (aa′, bb′) |
//! | (a, b)·(x, y) | (ax, by) |
//! | ‖(u, v)‖ | (‖u‖² + ‖v‖²)^½ |

use rand::Rng;

use super::{Adjoint, LieAlgebra, LieGroup, Sample};
use crate::error::{Error, StepError};
use crate::scalar::{Real, larger};
use crate::tolerance::Scales;

/// The product A × B of two groups, for systems of two parts.
///
/// Products may be nested. Every coordinate map of the library for A and B is also one for A × B.
/// [`maps::Pair`](crate::maps::Pair) takes a different map for each part. [`Power`](super::Power) is many copies of one
/// group.
///
/// ```
/// use lieflow::groups::{MatrixGroup, Product, So3};
/// use lieflow::maps::Exp;
/// use lieflow::{CoordinateMap, LieAlgebra};
/// let group = Product(So3::new(), MatrixGroup::sp(4)?);
/// assert_eq!((group.name().as_str(), group.dim()), ("SO(3) × Sp(4)", 13));
/// let (r, s) = Exp.eval(&group, &group.zero())?;
/// assert_eq!((r[(0, 0)], s[(0, 0)]), (1.0, 1.0));
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Product<A, B>(pub A, pub B);

/// √(a² + b²).
fn norm2<S: Real>(a: S, b: S) -> S {
    (a * a + b * b).sqrt()
}

/// The larger residual of two parts.
pub(crate) fn worse<S: Real>(a: Option<S>, b: Option<S>) -> Option<S> {
    match (a, b) {
        (Some(a), Some(b)) => Some(larger(a, b)),
        (a, b) => a.or(b),
    }
}

impl<A: LieAlgebra, B: LieAlgebra<Scalar = A::Scalar>> LieAlgebra for Product<A, B> {
    type Scalar = A::Scalar;
    type Alg = (A::Alg, B::Alg);

    fn name(&self) -> String {
        format!("{} × {}", self.0.name(), self.1.name())
    }
    fn dim(&self) -> usize {
        self.0.dim() + self.1.dim()
    }
    fn zero(&self) -> Self::Alg {
        (self.0.zero(), self.1.zero())
    }
    #[inline]
    fn set_zero(&self, u: &mut Self::Alg) {
        self.0.set_zero(&mut u.0);
        self.1.set_zero(&mut u.1);
    }
    #[inline]
    fn axpy(&self, a: A::Scalar, x: &Self::Alg, y: &mut Self::Alg) {
        self.0.axpy(a, &x.0, &mut y.0);
        self.1.axpy(a, &x.1, &mut y.1);
    }
    #[inline]
    fn bracket(&self, u: &Self::Alg, v: &Self::Alg, out: &mut Self::Alg) {
        self.0.bracket(&u.0, &v.0, &mut out.0);
        self.1.bracket(&u.1, &v.1, &mut out.1);
    }
    #[inline]
    fn norm(&self, u: &Self::Alg) -> A::Scalar {
        norm2(self.0.norm(&u.0), self.1.norm(&u.1))
    }
    #[inline]
    fn is_finite(&self, u: &Self::Alg) -> bool {
        self.0.is_finite(&u.0) && self.1.is_finite(&u.1)
    }
    fn check(&self, arg: &'static str, u: &Self::Alg) -> Result<(), Error> {
        self.0.check(arg, &u.0)?;
        self.1.check(arg, &u.1)
    }
    fn check_shape(&self, arg: &'static str, u: &Self::Alg) -> Result<(), Error> {
        self.0.check_shape(arg, &u.0)?;
        self.1.check_shape(arg, &u.1)
    }
    #[inline]
    fn holds_more(&self) -> bool {
        self.0.holds_more() || self.1.holds_more()
    }
    #[inline]
    fn off_algebra(&self, u: &Self::Alg) -> A::Scalar {
        larger(self.0.off_algebra(&u.0), self.1.off_algebra(&u.1))
    }
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<A: LieGroup, B: LieGroup<Scalar = A::Scalar>> LieGroup for Product<A, B> {
    type Elem = (A::Elem, B::Elem);
    type Vector = (A::Vector, B::Vector);

    fn identity(&self) -> Self::Elem {
        (self.0.identity(), self.1.identity())
    }
    #[inline]
    fn compose(&self, a: &Self::Elem, b: &Self::Elem, out: &mut Self::Elem) {
        self.0.compose(&a.0, &b.0, &mut out.0);
        self.1.compose(&a.1, &b.1, &mut out.1);
    }
    #[inline]
    fn apply(&self, g: &Self::Elem, x: &Self::Vector, y: &mut Self::Vector) {
        self.0.apply(&g.0, &x.0, &mut y.0);
        self.1.apply(&g.1, &x.1, &mut y.1);
    }
    #[inline]
    fn tangent(&self, v: &Self::Alg, g: &Self::Elem, out: &mut Self::Elem) {
        self.0.tangent(&v.0, &g.0, &mut out.0);
        self.1.tangent(&v.1, &g.1, &mut out.1);
    }
    #[inline]
    fn apply_algebra(&self, v: &Self::Alg, x: &Self::Vector, y: &mut Self::Vector) {
        self.0.apply_algebra(&v.0, &x.0, &mut y.0);
        self.1.apply_algebra(&v.1, &x.1, &mut y.1);
    }
    #[inline]
    fn is_finite_vector(&self, x: &Self::Vector) -> bool {
        self.0.is_finite_vector(&x.0) && self.1.is_finite_vector(&x.1)
    }
    #[inline]
    fn error_ratio(
        &self,
        e: &Self::Alg,
        g: &Self::Elem,
        from_right: bool,
        scales: &mut Scales<'_>,
    ) -> A::Scalar {
        let first = self.0.error_ratio(&e.0, &g.0, from_right, scales);
        larger(first, self.1.error_ratio(&e.1, &g.1, from_right, scales))
    }
    #[inline]
    fn vector_error_ratio(
        &self,
        e: &Self::Alg,
        x: &Self::Vector,
        scales: &mut Scales<'_>,
    ) -> A::Scalar {
        let first = self.0.vector_error_ratio(&e.0, &x.0, scales);
        larger(first, self.1.vector_error_ratio(&e.1, &x.1, scales))
    }
    fn distance(&self, a: &Self::Elem, b: &Self::Elem) -> A::Scalar {
        norm2(self.0.distance(&a.0, &b.0), self.1.distance(&a.1, &b.1))
    }
    fn defect(&self, g: &Self::Elem) -> A::Scalar {
        norm2(self.0.defect(&g.0), self.1.defect(&g.1))
    }
    fn check_elem(&self, g: &Self::Elem) -> Result<(), Error> {
        self.0.check_elem(&g.0)?;
        self.1.check_elem(&g.1)
    }
    fn check_member(&self, g: &Self::Elem) -> Result<(), Error> {
        self.0.check_member(&g.0)?;
        self.1.check_member(&g.1)
    }
    fn check_vector(&self, x: &Self::Vector) -> Result<(), Error> {
        self.0.check_vector(&x.0)?;
        self.1.check_vector(&x.1)
    }
    /// Corrects each part. Returns the larger residual.
    fn correct(&self, g: &mut Self::Elem, [s, t]: [&mut Self::Elem; 2]) -> A::Scalar {
        let first = self.0.correct(&mut g.0, [&mut s.0, &mut t.0]);
        larger(first, self.1.correct(&mut g.1, [&mut s.1, &mut t.1]))
    }
    fn residual_size(&self, g: &Self::Elem) -> A::Scalar {
        larger(self.0.residual_size(&g.0), self.1.residual_size(&g.1))
    }
    /// Corrects each part. Returns the larger residual.
    fn correct_vector(&self, from: &Self::Vector, x: &mut Self::Vector) -> Option<A::Scalar> {
        let first = self.0.correct_vector(&from.0, &mut x.0);
        worse(first, self.1.correct_vector(&from.1, &mut x.1))
    }
}

impl<A: Adjoint, B: Adjoint<Scalar = A::Scalar>> Adjoint for Product<A, B> {
    type Dual = (A::Dual, B::Dual);

    type Inverting = (A::Inverting, B::Inverting);

    fn inverting(&self) -> Self::Inverting {
        (self.0.inverting(), self.1.inverting())
    }
    fn invert(
        &self,
        g: &Self::Elem,
        scratch: &mut Self::Inverting,
        out: &mut Self::Elem,
    ) -> Result<(), StepError> {
        self.0.invert(&g.0, &mut scratch.0, &mut out.0)?;
        self.1.invert(&g.1, &mut scratch.1, &mut out.1)
    }
    fn tangent_in_body(&self, g: &Self::Elem, v: &Self::Alg, out: &mut Self::Elem) {
        self.0.tangent_in_body(&g.0, &v.0, &mut out.0);
        self.1.tangent_in_body(&g.1, &v.1, &mut out.1);
    }
    fn big_ad(&self, g: &Self::Elem, u: &Self::Alg, out: &mut Self::Alg) -> Result<(), StepError> {
        self.0.big_ad(&g.0, &u.0, &mut out.0)?;
        self.1.big_ad(&g.1, &u.1, &mut out.1)
    }
    fn coad_group(
        &self,
        g: &Self::Elem,
        m: &Self::Dual,
        out: &mut Self::Dual,
    ) -> Result<(), StepError> {
        self.0.coad_group(&g.0, &m.0, &mut out.0)?;
        self.1.coad_group(&g.1, &m.1, &mut out.1)
    }
    fn coad(&self, u: &Self::Alg, m: &Self::Dual, out: &mut Self::Dual) {
        self.0.coad(&u.0, &m.0, &mut out.0);
        self.1.coad(&u.1, &m.1, &mut out.1);
    }
    fn pair(&self, m: &Self::Dual, v: &Self::Alg) -> A::Scalar {
        self.0.pair(&m.0, &v.0) + self.1.pair(&m.1, &v.1)
    }
}

impl<A: Sample, B: Sample<Scalar = A::Scalar>> Sample for Product<A, B> {
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> Self::Alg {
        (self.0.sample_algebra(rng, sigma), self.1.sample_algebra(rng, sigma))
    }
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> Self::Elem {
        (self.0.sample_element(rng), self.1.sample_element(rng))
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Self::Vector {
        (self.0.sample_vector(rng), self.1.sample_vector(rng))
    }
}
