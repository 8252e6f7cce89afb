//! Methods on numbers that count operations, compiled here once.
//!
//! A run on [`Counted`] needs every method compiled for that number, for each type of problem. A program that counts the
//! operations of many problems need not compile them: it takes a method from [`CountingMethods`]. Matrices report their
//! operations on `f64` ([`tally`](crate::scalar::tally())), and are not here.

use nalgebra::Vector3;

use super::{MethodSpec, MethodsByName};
use crate::actions::{Coadjoint, LeftTranslation, Linear, Pair};
use crate::error::Error;
use crate::groups::{Power, Product, Se3, So3, Translations};
use crate::methods::AnyMethod;
use crate::problems::{
    DynFlow, RigidBody, RigidBodyAttitude, RigidBodyState, TimeAlone, WithHamiltonian, WithSeries,
};
use crate::scalar::Counted;

/// A problem on numbers that count operations, whose methods are compiled in this crate.
pub trait CountingMethods: MethodsByName {
    /// The method that `spec` names, as [`MethodsByName::method`].
    ///
    /// # Errors
    /// As [`MethodsByName::method`].
    fn counting_method(&self, spec: &MethodSpec) -> Result<AnyMethod<'static, Self>, Error>
    where
        Self: Sized;
}

macro_rules! counting {
    ($($problem:ty,)*) => {$(
        impl CountingMethods for $problem {
            fn counting_method(&self, spec: &MethodSpec) -> Result<AnyMethod<'static, Self>, Error> {
                self.method(spec)
            }
        }
    )*};
}

type Rotation = So3<Counted>;
type Rotations = Power<Rotation>;
type Shift = Translations<Vector3<Counted>>;
type Shifts = Translations<Box<[Counted]>>;

counting! {
    RigidBody<Counted>,
    RigidBodyAttitude<Counted>,
    RigidBodyState<Counted>,
    DynFlow<Rotation, Linear, TimeAlone>,
    DynFlow<Rotations, Linear, (), WithHamiltonian>,
    DynFlow<Se3<Counted>, Coadjoint, WithSeries, WithHamiltonian>,
    DynFlow<Se3<Counted>, LeftTranslation, TimeAlone>,
    DynFlow<Product<Rotation, Shift>, LeftTranslation>,
    DynFlow<Product<Rotations, Product<Rotations, Shifts>>, Pair<Linear, LeftTranslation>>,
}
