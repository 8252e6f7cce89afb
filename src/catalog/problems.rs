//! The problems of the library whose methods can be chosen by name: what each offers, and what makes its methods.

use super::recipe::Recipe;
use super::{
    Choice, MaybeMethod, MethodsByName, Needs, bodies, classical, closed, energy_casimir, fields,
    first, implicit, isospectral, linear_type, momenta, projected, series,
};
use crate::actions::Action;
use crate::maps::{Cay, CoordinateMap, Exp, ExpOrCay, MapsByName};
use crate::methods::FluidMidpoint;
use crate::methods::magnus::TripleProduct;
use crate::methods::{AnyMethod, Composition, SeriesGroup, Wide};
use crate::problems::{
    DynFlow, Energy, Field, Flow, FlowFacts, LiePoisson, LinearField, Problem, RigidBody,
    RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude, RigidBodyQuaternion, RigidBodyState,
    Surface, TaylorField, TimeAlone, WithHamiltonian, WithSeries, Zeitlin,
};
use crate::scalar::{Real, Trig};
use crate::space::LinearSpace;

/// One line a problem: what it offers, and the functions that make its methods.
macro_rules! by_name {
    ($([$($generic:tt)*] $problem:ty, $($needs:ident)*: $($make:ident)*;)*) => {$(
        impl<$($generic)*> MethodsByName for $problem {
            fn offers(&self) -> Vec<Needs> {
                vec![$(Needs::$needs),*]
            }
            fn make<'p>(&self, choice: &Choice<'_>) -> MaybeMethod<'p, Self>
            where
                Self: 'p,
            {
                first([$($make),*], choice)
            }
        }
    )*};
}

by_name! {
    [S: Trig + Wide + Into<f64>] RigidBody<S>,
        Field Norm Series Body Momentum LiePoisson:
        closed fields implicit bodies momenta energy_casimir;
    [S: Trig + Wide + Into<f64>] RigidBodyAttitude<S>,
        Field Norm Series Body Attitude: closed fields implicit bodies projected;
    [] RigidBodyQuaternion, Field Norm Series Body: fields implicit bodies;
    [S: Real] RigidBodyState<S>, State: classical;
    [] RigidBodyN, Field Norm Series LiePoisson Isospectral:
        fields implicit series energy_casimir isospectral;
    [] RigidBodyNAttitude, Field Norm Series: fields implicit series;
    [S: Surface] Zeitlin<S>, Field Norm LiePoisson Isospectral:
        fluids fields implicit energy_casimir isospectral;
}

/// The midpoint rules that are made for fluids: the general ones with less work.
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported) for another map than exp and cay.
pub fn fluids<'p, S: Surface + 'p>(choice: &Choice<'_>) -> MaybeMethod<'p, Zeitlin<S>> {
    const ISOSPECTRAL: FluidMidpoint = FluidMidpoint::isospectral();
    const ENERGY: FluidMidpoint = FluidMidpoint::energy();
    Ok(Some(match (choice.info.recipe, choice.odd_map()?) {
        (Recipe::EnergyCasimir, ExpOrCay::Cay(_)) => AnyMethod::new(ENERGY),
        (Recipe::ComposedEnergyCasimir(scheme), ExpOrCay::Cay(_)) => {
            AnyMethod::new(Composition::new(ENERGY, scheme))
        }
        (Recipe::Isospectral2, _) => AnyMethod::new(ISOSPECTRAL),
        (Recipe::ComposedIsospectral(scheme), _) => {
            AnyMethod::new(Composition::new(ISOSPECTRAL, scheme))
        }
        _ => return Ok(None),
    }))
}

/// What is known of a problem beyond f, and the methods that rest on it.
pub trait Fact<P: Problem> {
    /// What the problem offers for it.
    fn offers() -> Vec<Needs>;
    /// The method that is chosen, where it rests on this fact.
    ///
    /// # Errors
    /// As [`MethodsByName::make`].
    fn make<'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
    where
        P: 'p;
}

impl<P: Problem> Fact<P> for () {
    fn offers() -> Vec<Needs> {
        Vec::new()
    }
    fn make<'p>(_: &Choice<'_>) -> MaybeMethod<'p, P>
    where
        P: 'p,
    {
        Ok(None)
    }
}

impl<P> Fact<P> for TimeAlone
where
    P: LinearField,
    P::Group: TripleProduct,
    Exp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    fn offers() -> Vec<Needs> {
        vec![Needs::LinearType]
    }
    fn make<'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
    where
        P: 'p,
    {
        linear_type(choice)
    }
}

impl<P: TaylorField<Group: SeriesGroup>, L: Fact<P>> Fact<P> for WithSeries<L> {
    fn offers() -> Vec<Needs> {
        [L::offers(), vec![Needs::Series]].concat()
    }
    fn make<'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
    where
        P: 'p,
    {
        first([L::make, series], choice)
    }
}

macro_rules! hamiltonian {
    ($([$($generic:ident)?] $fact:ty;)*) => {$(
        impl<P: LiePoisson, $($generic)?> Fact<P> for $fact
        where
            ExpOrCay: CoordinateMap<P::Group>,
        {
            fn offers() -> Vec<Needs> {
                vec![Needs::LiePoisson]
            }
            fn make<'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
            where
                P: 'p,
            {
                energy_casimir(choice)
            }
        }
    )*};
}
hamiltonian! {
    [E] Energy<E>;
    [] WithHamiltonian;
}

/// What problems with these facts may offer.
fn offered<P: Problem, L: Fact<P>, H: Fact<P>>() -> Vec<Needs> {
    [vec![Needs::Field, Needs::Norm], L::offers(), H::offers()].concat()
}

/// A closure. Its facts decide which properties it has.
impl<G, A, F, L, H, I> MethodsByName for Flow<G, A, F, FlowFacts<L, H, I>>
where
    G: MapsByName,
    A: Action<G, Point: LinearSpace<Scalar = G::Scalar>>,
    F: Field<G, A>,
    Exp: CoordinateMap<G>,
    ExpOrCay: CoordinateMap<G>,
    L: Fact<Self>,
    H: Fact<Self>,
{
    fn offers(&self) -> Vec<Needs> {
        offered::<Self, L, H>()
    }
    fn make<'p>(&self, choice: &Choice<'_>) -> MaybeMethod<'p, Self>
    where
        Self: 'p,
    {
        first([fields, implicit, L::make, H::make], choice)
    }
}

/// Each problem lists its own properties, of those that its type may have.
impl<G, A, L, H> MethodsByName for DynFlow<G, A, L, H>
where
    G: MapsByName,
    A: Action<G, Point: LinearSpace<Scalar = G::Scalar>>,
    Exp: CoordinateMap<G>,
    ExpOrCay: CoordinateMap<G>,
    L: Fact<Self>,
    H: Fact<Self>,
{
    fn offers(&self) -> Vec<Needs> {
        let mut offers = offered::<Self, L, H>();
        offers.retain(|need| match need {
            Needs::LinearType => self.is_linear(),
            Needs::Series => self.has_series(),
            Needs::LiePoisson => self.is_lie_poisson(),
            _ => true,
        });
        offers
    }
    fn make<'p>(&self, choice: &Choice<'_>) -> MaybeMethod<'p, Self>
    where
        Self: 'p,
    {
        first([fields, implicit, L::make, H::make], choice)
    }
}
