//! The group Gᴺ: N copies of one group. Each operation goes copy by copy over one slice.

use rand::Rng;

use super::product::worse;
use super::{Adjoint, LieAlgebra, LieGroup, Sample};
use crate::error::{Error, StepError};
use crate::scalar::{Real, larger};
use crate::tolerance::Scales;

/// The group Gᴺ = G × … × G, for many bodies or a chain of spins.
///
/// Elements are boxed slices, made once. Operations on a copy are resolved at compile time, as for a single group.
///
/// Every coordinate map of the library for G is also one for Gᴺ. [`maps::Each`](crate::maps::Each) does the same for
/// your own map.
///
/// ```
/// use lieflow::LieAlgebra;
/// use lieflow::groups::{Power, So3};
/// let group = Power::new(So3::<f64>::new(), 1000)?;
/// assert_eq!((group.dim(), group.zero().len()), (3000, 1000));
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Power<G> {
    group: G,
    copies: usize,
}

impl<G> Power<G> {
    /// Gᴺ with N = `copies`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for N = 0.
    pub fn new(group: G, copies: usize) -> Result<Self, Error> {
        match copies {
            0 => Err(Error::out_of_range("copies", 0.0, "at least 1")),
            _ => Ok(Power { group, copies }),
        }
    }

    /// G⁰ = {𝟙}, no copy: for an optional part of a product.
    pub const fn none(group: G) -> Self {
        Power { group, copies: 0 }
    }

    /// The group G of each copy.
    pub fn group(&self) -> &G {
        &self.group
    }

    /// The number N of copies.
    pub fn copies(&self) -> usize {
        self.copies
    }

    /// Refuses a list that has not N parts.
    pub(crate) fn check_copies<T>(&self, arg: &'static str, parts: &[T]) -> Result<(), Error> {
        match parts.len() == self.copies {
            true => Ok(()),
            false => Err(Error::Shape {
                arg,
                rows: parts.len(),
                cols: 1,
                expected_rows: self.copies,
                expected_cols: 1,
            }),
        }
    }

    /// N values, made one by one.
    pub(crate) fn fill<T>(&self, mut make: impl FnMut() -> T) -> Box<[T]> {
        (0..self.copies).map(|_| make()).collect()
    }
}

/// √Σx².
fn norm2<S: Real>(parts: impl Iterator<Item = S>) -> S {
    parts.fold(S::lit(0.0), |sum, x| sum + x * x).sqrt()
}

impl<G: LieAlgebra> LieAlgebra for Power<G> {
    type Scalar = G::Scalar;
    type Alg = Box<[G::Alg]>;

    fn name(&self) -> String {
        format!("{}^{}", self.group.name(), self.copies)
    }
    fn dim(&self) -> usize {
        self.copies * self.group.dim()
    }
    fn zero(&self) -> Self::Alg {
        self.fill(|| self.group.zero())
    }
    #[inline]
    fn set_zero(&self, u: &mut Self::Alg) {
        u.iter_mut().for_each(|u| self.group.set_zero(u));
    }
    #[inline]
    fn axpy(&self, a: G::Scalar, x: &Self::Alg, y: &mut Self::Alg) {
        for (x, y) in x.iter().zip(y) {
            self.group.axpy(a, x, y);
        }
    }
    #[inline]
    fn bracket(&self, u: &Self::Alg, v: &Self::Alg, out: &mut Self::Alg) {
        for ((u, v), out) in u.iter().zip(v).zip(out) {
            self.group.bracket(u, v, out);
        }
    }
    fn norm(&self, u: &Self::Alg) -> G::Scalar {
        norm2(u.iter().map(|u| self.group.norm(u)))
    }
    fn is_finite(&self, u: &Self::Alg) -> bool {
        u.iter().all(|u| self.group.is_finite(u))
    }
    fn check_shape(&self, arg: &'static str, u: &Self::Alg) -> Result<(), Error> {
        self.check_copies(arg, u)?;
        u.iter().try_for_each(|u| self.group.check_shape(arg, u))
    }
    fn check(&self, arg: &'static str, u: &Self::Alg) -> Result<(), Error> {
        self.check_copies(arg, u)?;
        u.iter().try_for_each(|u| self.group.check(arg, u))
    }
    #[inline]
    fn holds_more(&self) -> bool {
        self.group.holds_more()
    }
    fn off_algebra(&self, u: &Self::Alg) -> G::Scalar {
        u.iter().map(|u| self.group.off_algebra(u)).fold(G::Scalar::lit(0.0), larger)
    }
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<G: LieGroup> LieGroup for Power<G> {
    type Elem = Box<[G::Elem]>;
    type Vector = Box<[G::Vector]>;

    fn identity(&self) -> Self::Elem {
        self.fill(|| self.group.identity())
    }
    #[inline]
    fn compose(&self, a: &Self::Elem, b: &Self::Elem, out: &mut Self::Elem) {
        for ((a, b), out) in a.iter().zip(b).zip(out) {
            self.group.compose(a, b, out);
        }
    }
    #[inline]
    fn apply(&self, g: &Self::Elem, x: &Self::Vector, y: &mut Self::Vector) {
        for ((g, x), y) in g.iter().zip(x).zip(y) {
            self.group.apply(g, x, y);
        }
    }
    #[inline]
    fn tangent(&self, v: &Self::Alg, g: &Self::Elem, out: &mut Self::Elem) {
        for ((v, g), out) in v.iter().zip(g).zip(out) {
            self.group.tangent(v, g, out);
        }
    }
    #[inline]
    fn apply_algebra(&self, v: &Self::Alg, x: &Self::Vector, y: &mut Self::Vector) {
        for ((v, x), y) in v.iter().zip(x).zip(y) {
            self.group.apply_algebra(v, x, y);
        }
    }
    fn error_ratio(
        &self,
        e: &Self::Alg,
        g: &Self::Elem,
        from_right: bool,
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        scales.for_each_copy(self.copies, |i, scales| {
            self.group.error_ratio(&e[i], &g[i], from_right, scales)
        })
    }
    fn vector_error_ratio(
        &self,
        e: &Self::Alg,
        x: &Self::Vector,
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        let each =
            |i: usize, scales: &mut Scales<'_>| self.group.vector_error_ratio(&e[i], &x[i], scales);
        scales.for_each_copy(self.copies, each)
    }
    fn distance(&self, a: &Self::Elem, b: &Self::Elem) -> G::Scalar {
        norm2(a.iter().zip(b).map(|(a, b)| self.group.distance(a, b)))
    }
    fn defect(&self, g: &Self::Elem) -> G::Scalar {
        norm2(g.iter().map(|g| self.group.defect(g)))
    }
    fn check_elem(&self, g: &Self::Elem) -> Result<(), Error> {
        self.check_copies("y", g)?;
        g.iter().try_for_each(|g| self.group.check_elem(g))
    }
    fn check_member(&self, g: &Self::Elem) -> Result<(), Error> {
        g.iter().try_for_each(|g| self.group.check_member(g))
    }
    fn check_vector(&self, x: &Self::Vector) -> Result<(), Error> {
        self.check_copies("y", x)?;
        x.iter().try_for_each(|x| self.group.check_vector(x))
    }
    fn is_finite_vector(&self, x: &Self::Vector) -> bool {
        x.iter().all(|x| self.group.is_finite_vector(x))
    }
    fn residual_size(&self, g: &Self::Elem) -> G::Scalar {
        g.iter().map(|g| self.group.residual_size(g)).fold(G::Scalar::lit(1.0), larger)
    }
    /// Corrects each copy. Returns the largest residual.
    fn correct(&self, g: &mut Self::Elem, [s, t]: [&mut Self::Elem; 2]) -> G::Scalar {
        let mut residual = G::Scalar::lit(0.0);
        for ((g, s), t) in g.iter_mut().zip(s).zip(t) {
            residual = larger(residual, self.group.correct(g, [s, t]));
        }
        residual
    }
    /// Corrects each copy. Returns the largest residual.
    fn correct_vector(&self, from: &Self::Vector, x: &mut Self::Vector) -> Option<G::Scalar> {
        let each = from.iter().zip(x);
        each.fold(None, |all, (from, x)| worse(all, self.group.correct_vector(from, x)))
    }
}

impl<G: Adjoint> Adjoint for Power<G> {
    type Dual = Box<[G::Dual]>;

    type Inverting = G::Inverting;

    fn inverting(&self) -> G::Inverting {
        self.group.inverting()
    }
    fn invert(
        &self,
        g: &Self::Elem,
        scratch: &mut G::Inverting,
        out: &mut Self::Elem,
    ) -> Result<(), StepError> {
        g.iter().zip(out).try_for_each(|(g, out)| self.group.invert(g, scratch, out))
    }
    fn tangent_in_body(&self, g: &Self::Elem, v: &Self::Alg, out: &mut Self::Elem) {
        for ((g, v), out) in g.iter().zip(v).zip(out) {
            self.group.tangent_in_body(g, v, out);
        }
    }
    fn big_ad(&self, g: &Self::Elem, u: &Self::Alg, out: &mut Self::Alg) -> Result<(), StepError> {
        let mut parts = g.iter().zip(u).zip(out);
        parts.try_for_each(|((g, u), out)| self.group.big_ad(g, u, out))
    }
    fn coad_group(
        &self,
        g: &Self::Elem,
        m: &Self::Dual,
        out: &mut Self::Dual,
    ) -> Result<(), StepError> {
        let mut parts = g.iter().zip(m).zip(out);
        parts.try_for_each(|((g, m), out)| self.group.coad_group(g, m, out))
    }
    fn coad(&self, u: &Self::Alg, m: &Self::Dual, out: &mut Self::Dual) {
        for ((u, m), out) in u.iter().zip(m).zip(out) {
            self.group.coad(u, m, out);
        }
    }
    fn pair(&self, m: &Self::Dual, v: &Self::Alg) -> G::Scalar {
        let parts = m.iter().zip(v).map(|(m, v)| self.group.pair(m, v));
        parts.fold(G::Scalar::lit(0.0), |sum, x| sum + x)
    }
}

impl<G: Sample> Sample for Power<G> {
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> Self::Alg {
        self.fill(|| self.group.sample_algebra(rng, sigma))
    }
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> Self::Elem {
        self.fill(|| self.group.sample_element(rng))
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Self::Vector {
        self.fill(|| self.group.sample_vector(rng))
    }
}
