//! Problems whose field is behind a pointer.
//!
//! [`Flow`] is compiled for its closure, and the driver with each method again for each closure. A suite with a hundred
//! fields on ten groups compiles them for ten types of problem this way. Numbers are the same bits.

use lieflow::groups::LieGroup;
use lieflow::problems::{Flow, LinearFlow};
use lieflow::{Action, LieAlgebra};

/// A [`Flow`] with the field in a box.
pub(crate) type BoxedFlow<'a, G, A> = Flow<G, A, Field<'a, ScalarOf<G>, Point<G, A>, Alg<G>>>;
/// A [`LinearFlow`] with the field in a box.
pub(crate) type BoxedOfTime<'a, G, A> = LinearFlow<G, A, FieldOfTime<'a, ScalarOf<G>, Alg<G>>>;

type Field<'a, T, Y, V> = Box<dyn Fn(T, &Y, &mut V) + 'a>;
type FieldOfTime<'a, T, V> = Box<dyn Fn(T, &mut V) + 'a>;
type ScalarOf<G> = <G as LieAlgebra>::Scalar;
type Alg<G> = <G as LieAlgebra>::Alg;
type Point<G, A> = <A as Action<G>>::Point;

/// [`Flow::new`] with the field in a box.
pub(crate) fn boxed_flow<'a, G: LieGroup, A: Action<G>>(
    group: G,
    action: A,
    field: impl Fn(G::Scalar, &A::Point, &mut G::Alg) + 'a,
) -> BoxedFlow<'a, G, A> {
    Flow::new(group, action, Box::new(field))
}

/// [`Flow::of_time`] with the field in a box.
pub(crate) fn boxed_of_time<'a, G: LieGroup, A: Action<G>>(
    group: G,
    action: A,
    field: impl Fn(G::Scalar, &mut G::Alg) + 'a,
) -> BoxedOfTime<'a, G, A> {
    Flow::of_time(group, action, Box::new(field))
}
