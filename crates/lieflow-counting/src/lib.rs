//! Counts the operations of methods by name, on problems on vectors.
//!
//! Such a problem runs on [`Counted`] numbers, and every method is compiled for them, for each type of problem. That is done
//! here and not in the library, because only a comparison of methods asks for the counts: others need not link these methods,
//! and they are compiled beside other crates. Matrices report their operations on `f64`
//! ([`tally`](lieflow::scalar::tally())), and are not here.

use std::any::Any;

use lieflow::LieAlgebra;
use lieflow::actions::{Coadjoint, LeftTranslation, Linear, Pair, Translation};
use lieflow::catalog::{MethodSpec, MethodsByName};
use lieflow::groups::{Power, Product, Se3, So3, Translations};
use lieflow::problems::{
    DynFlow, PointOf, RigidBody, RigidBodyAttitude, RigidBodyState, TimeAlone, WithHamiltonian,
    WithSeries,
};
use lieflow::scalar::Counted;
use lieflow::solve::{Steps, operations_of_a_step};
use nalgebra::Vector3;

type Rotation = So3<Counted>;
type Rotations = Power<Rotation>;
type Shift = Translations<Vector3<Counted>>;
type Shifts = Translations<Box<[Counted]>>;

/// The mean number of operations of a step of a method, over the first steps of a run.
///
/// `start` is a pair of a problem on [`Counted`] numbers and its y(t₀). `None` for a problem of another type than those of
/// `lieflow-model`, for a method that does not fit, and where nothing is counted, as in the exact motion.
pub fn operations(start: Box<dyn Any>, method: &MethodSpec, steps: &Steps) -> Option<f64> {
    of::<RigidBody<Counted>>(start, method, steps)
        .or_else(|start| of::<RigidBodyAttitude<Counted>>(start, method, steps))
        .or_else(|start| of::<RigidBodyState<Counted>>(start, method, steps))
        .or_else(|start| of::<DynFlow<Rotation, Linear, TimeAlone>>(start, method, steps))
        .or_else(|start| {
            of::<DynFlow<Rotations, Linear, (), WithHamiltonian>>(start, method, steps)
        })
        .or_else(|start| {
            of::<DynFlow<Se3<Counted>, Coadjoint, WithSeries, WithHamiltonian>>(
                start, method, steps,
            )
        })
        .or_else(|start| of::<DynFlow<Se3<Counted>, Translation, TimeAlone>>(start, method, steps))
        .or_else(|start| {
            of::<DynFlow<Product<Rotation, Shift>, LeftTranslation>>(start, method, steps)
        })
        .or_else(|start| {
            type Parts = Product<Rotations, Product<Rotations, Shifts>>;
            of::<DynFlow<Parts, Pair<Linear, Translation>>>(start, method, steps)
        })
        .ok()
        .flatten()
}

/// The operations on a problem of this type.
///
/// # Errors
/// The problem, if it has another type.
fn of<P>(
    start: Box<dyn Any>,
    method: &MethodSpec,
    steps: &Steps,
) -> Result<Option<f64>, Box<dyn Any>>
where
    P: MethodsByName<Group: LieAlgebra<Scalar = Counted>> + 'static,
    PointOf<P>: 'static,
{
    let (problem, y) = *start.downcast::<(P, PointOf<P>)>()?;
    let Ok(method) = problem.method(method) else { return Ok(None) };
    Ok(operations_of_a_step(&problem, &method, y, steps))
}
