//! Equations of linear type: f depends on time alone, ẏ = λ_*(A(t))(y); on a matrix group Ẏ = A(t)Y.

use super::{AlgOf, PointOf, Problem, ScalarOf};
use crate::actions::Action;
use crate::groups::LieGroup;

/// A capability: f(t, y) = A(t). What a Magnus method asks for.
pub trait LinearField: Problem {
    /// v ← A(t) ∈ 𝔤, which is [`Problem::f`] at every y.
    fn a(&self, t: ScalarOf<Self>, v: &mut AlgOf<Self>, work: &mut Self::Work);
}

/// ẏ = λ_*(A(t))(y) from a group, an action and a function A.
///
/// ```
/// use lieflow::actions::Linear;
/// use lieflow::groups::So3;
/// use lieflow::methods::magnus::Magnus4;
/// use lieflow::problems::LinearEquation;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use nalgebra::Vector3;
///
/// // A spin in a field that turns.
/// let spin = LinearEquation::new(So3::new(), Linear, |t: f64, v: &mut Vector3<f64>| {
///     *v = Vector3::new(t.cos(), t.sin(), 2.0);
/// });
/// let mut x = Vector3::new(0.0, 0.0, 1.0);
/// let grid = TimeGrid::new([0.0, 1.0], 0.01)?;
/// integrate(&spin, &Magnus4, &grid, &SaveAt::Ends, &mut x, |_, _| {})?;
/// assert!((x.norm() - 1.0).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LinearEquation<G, A, F> {
    group: G,
    action: A,
    field: F,
}

impl<G: LieGroup, A: Action<G>, F: Fn(G::Scalar, &mut G::Alg)> LinearEquation<G, A, F> {
    /// The equation; `field` writes A(t).
    pub const fn new(group: G, action: A, field: F) -> Self {
        LinearEquation { group, action, field }
    }
}

impl<G: LieGroup, A: Action<G>, F: Fn(G::Scalar, &mut G::Alg)> Problem for LinearEquation<G, A, F> {
    type Group = G;
    type Action = A;
    type Work = ();

    fn group(&self) -> &G {
        &self.group
    }
    fn action(&self) -> &A {
        &self.action
    }
    fn work(&self) {}
    #[inline]
    fn f(&self, t: G::Scalar, _: &PointOf<Self>, v: &mut G::Alg, _: &mut ()) {
        (self.field)(t, v);
    }
}

impl<G: LieGroup, A: Action<G>, F: Fn(G::Scalar, &mut G::Alg)> LinearField
    for LinearEquation<G, A, F>
{
    #[inline]
    fn a(&self, t: G::Scalar, v: &mut G::Alg, _: &mut ()) {
        (self.field)(t, v);
    }
}
