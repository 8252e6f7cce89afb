//! The translations of a linear space V: an abelian group.
//!
//! u ∈ V, g ∈ V; \[u, v\] = 0; g·g′ = g + g′; g moves x ∈ V to x + g. In a product it holds the part of a system that
//! is on no other group. Examples: a momentum under forces, the memory of a controller, a temperature.

use super::{Adjoint, LieAlgebra, LieGroup};
use crate::error::{Error, StepError};
use crate::scalar::{Real, infinite_or_nan};
use crate::space::{Gap, LinearSpace};
use crate::tolerance::Scales;

/// The translations of a linear space with the origin `zero`.
///
/// ```
/// use lieflow::groups::{LieGroup, Translations};
/// use lieflow::nalgebra::Vector3;
/// let group = Translations::new(Vector3::<f64>::zeros(), 3);
/// let mut y = Vector3::zeros();
/// group.apply(&Vector3::new(1.0, 2.0, 3.0), &Vector3::new(1.0, 0.0, 0.0), &mut y);
/// assert_eq!(y, Vector3::new(2.0, 2.0, 3.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Translations<V> {
    zero: V,
    dim: usize,
}

impl<V: LinearSpace> Translations<V> {
    /// The group; `dim` is the dimension of V.
    pub const fn new(zero: V, dim: usize) -> Self {
        Translations { zero, dim }
    }
}

impl<V: LinearSpace> LieAlgebra for Translations<V> {
    type Scalar = V::Scalar;
    type Alg = V;

    fn name(&self) -> String {
        format!("T({})", self.dim)
    }
    fn dim(&self) -> usize {
        self.dim
    }
    fn zero(&self) -> V {
        self.zero.clone()
    }
    #[inline]
    fn set_zero(&self, u: &mut V) {
        u.clear();
    }
    #[inline]
    fn axpy(&self, a: V::Scalar, x: &V, y: &mut V) {
        y.add(a, x);
    }
    #[inline]
    fn bracket(&self, _: &V, _: &V, out: &mut V) {
        out.clear();
    }
    #[inline]
    fn norm(&self, u: &V) -> V::Scalar {
        u.size()
    }
    #[inline]
    fn is_finite(&self, u: &V) -> bool {
        u.is_finite()
    }
    fn check_shape(&self, arg: &'static str, u: &V) -> Result<(), Error> {
        u.check_sizes(arg, &self.zero)
    }
}

impl<V: LinearSpace> LieGroup for Translations<V> {
    type Elem = V;
    type Vector = V;

    fn identity(&self) -> V {
        self.zero.clone()
    }
    #[inline]
    fn compose(&self, a: &V, b: &V, out: &mut V) {
        out.assign(a);
        out.add(V::Scalar::lit(1.0), b);
    }
    /// x + g.
    #[inline]
    fn apply(&self, g: &V, x: &V, y: &mut V) {
        self.compose(g, x, y);
    }
    #[inline]
    fn tangent(&self, v: &V, _: &V, out: &mut V) {
        out.assign(v);
    }
    #[inline]
    fn apply_algebra(&self, v: &V, _: &V, y: &mut V) {
        y.assign(v);
    }
    #[inline]
    fn check_elem(&self, g: &V) -> Result<(), Error> {
        g.check_sizes("y", &self.zero)?;
        match g.is_finite() {
            true => Ok(()),
            false => Err(Error::out_of_range("y", infinite_or_nan(g.size()), "finite numbers")),
        }
    }
    #[inline]
    fn check_vector(&self, x: &V) -> Result<(), Error> {
        self.check_elem(x)
    }
    /// The driver looks at the state after each step.
    #[inline]
    fn is_finite_vector(&self, _: &V) -> bool {
        true
    }
    #[inline]
    fn error_ratio(&self, e: &V, g: &V, _: bool, scales: &mut Scales<'_>) -> V::Scalar {
        g.error_ratio(Gap::of(e), scales)
    }
    #[inline]
    fn vector_error_ratio(&self, e: &V, x: &V, scales: &mut Scales<'_>) -> V::Scalar {
        x.error_ratio(Gap::of(e), scales)
    }
    fn distance(&self, a: &V, b: &V) -> V::Scalar {
        a.distance(b)
    }
    fn defect(&self, _: &V) -> V::Scalar {
        V::Scalar::lit(0.0)
    }
}

/// Ad_g = id and ad_u = 0, on V and, by ⟨m, v⟩ = Σ mᵢvᵢ, on its dual.
impl<V: LinearSpace> Adjoint for Translations<V> {
    type Dual = V;
    type Inverting = ();

    fn inverting(&self) {}
    #[inline]
    fn invert(&self, g: &V, (): &mut (), out: &mut V) -> Result<(), StepError> {
        out.clear();
        out.add(V::Scalar::lit(-1.0), g);
        Ok(())
    }
    #[inline]
    fn tangent_in_body(&self, _: &V, v: &V, out: &mut V) {
        out.assign(v);
    }
    #[inline]
    fn big_ad(&self, _: &V, u: &V, out: &mut V) -> Result<(), StepError> {
        out.assign(u);
        Ok(())
    }
    #[inline]
    fn coad_group(&self, _: &V, m: &V, out: &mut V) -> Result<(), StepError> {
        out.assign(m);
        Ok(())
    }
    #[inline]
    fn coad(&self, _: &V, _: &V, out: &mut V) {
        out.clear();
    }
    #[inline]
    fn pair(&self, m: &V, v: &V) -> V::Scalar {
        m.dot(v)
    }
}
