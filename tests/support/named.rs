//! Methods by name: the one place where the tests ask the catalog for a method.
//!
//! Each function makes the method that a spec names from the lists of the catalog for one kind of problem, and
//! hands it over.

use lieflow::Error;
use lieflow::actions::Coadjoint;
use lieflow::catalog::{
    self, MaybeMethod, MethodSpec, Needs, bodies, classical, energy_casimir, fields, first, fluids,
    implicit, isospectral, linear_type, momenta, projected,
};
use lieflow::groups::MatrixGroup;
use lieflow::maps::{Cay, CoordinateMap, Exp, ExpOrCay, MapsByName};
use lieflow::methods::magnus::TripleProduct;
use lieflow::methods::{AnyMethod, Metric, SeriesGroup, Wide};
use lieflow::problems::{
    Ambient, FreeBody, LiePoisson, LinearField, Orthogonal, PointOf, Problem, RigidBodyQuaternion,
    RigidBodyState, ScalarOf, Split, Surface, TaylorField, Zeitlin,
};
use lieflow::scalar::{Real, Trig};

/// A method that the catalog has made.
pub(crate) type Named<'p, P> = AnyMethod<'p, P>;

fn found<'p, P: Problem>(
    spec: &MethodSpec,
    offers: &[Needs],
    made: impl FnOnce() -> MaybeMethod<'p, P>,
) -> Result<Named<'p, P>, Error> {
    let info = spec.info()?;
    let misfit = || Error::Unsupported {
        what: info.name,
        with: "this problem".into(),
        why: info.needs.describe(),
    };
    match offers.contains(&info.needs) {
        true => made()?.ok_or_else(misfit),
        false => Err(misfit()),
    }
}

/// An explicit method that is an embedded pair.
pub(crate) fn pair<'p, P, R>(
    spec: &MethodSpec,
    then: impl FnOnce(&Named<'p, P>) -> R,
) -> Result<R, Error>
where
    P: Ambient + 'p,
    P::Group: MapsByName,
    Exp: CoordinateMap<P::Group>,
{
    match spec.has_pair()? {
        true => explicit(spec, then),
        false => Err(Error::Unsupported {
            what: "an error estimate",
            with: format!("`{}`", spec.label()),
            why: "it has no embedded pair",
        }),
    }
}

macro_rules! by_name {
    ($($(#[$doc:meta])* $name:ident: $($needs:ident)*: [$($make:path),*], $problem:ty, [$($generic:tt)*],
       [$($bound:tt)*];)*) => {$(
        $(#[$doc])*
        #[allow(clippy::multiple_bound_locations)] // 'p is added to every problem
        pub(crate) fn $name<'p, R, $($generic)*>(
            spec: &MethodSpec,
            then: impl FnOnce(&Named<'p, $problem>) -> R,
        ) -> Result<R, Error>
        where
            $problem: 'p,
            $($bound)*
        {
            let choice = spec.choose()?;
            let offers = [$(Needs::$needs),*];
            Ok(then(&found::<$problem>(spec, &offers, || first([$($make),*], &choice))?))
        }
    )*};
}

by_name! {
    /// Explicit methods for any field.
    explicit: Field: [fields], P, [P: Ambient],
        [P::Group: MapsByName, Exp: CoordinateMap<P::Group>];
    /// Explicit and implicit methods for any field.
    field: Field Norm: [fields, implicit], P, [P: Ambient],
        [P::Group: MapsByName, Exp: CoordinateMap<P::Group>,
         ExpOrCay: CoordinateMap<P::Group>];
    /// Methods for fields of linear type.
    linear: LinearType: [linear_type], P, [P: LinearField],
        [P::Group: TripleProduct, Exp: CoordinateMap<P::Group>, Cay: CoordinateMap<P::Group>,
         PointOf<P>: Metric<Scalar = ScalarOf<P>>];
    /// Methods for fields with Taylor coefficients.
    series: Field Norm Series: [fields, implicit, catalog::series], P, [P: Ambient + TaylorField],
        [P::Group: SeriesGroup + MapsByName,
         Exp: CoordinateMap<P::Group>, ExpOrCay: CoordinateMap<P::Group>];
    /// Methods for the free rigid body.
    body: Field Norm Series Body: [fields, implicit, bodies], P, [P: Ambient + FreeBody + Split],
        [P::Group: MapsByName,
         ScalarOf<P>: Trig + Wide + Into<f64>, Exp: CoordinateMap<P::Group>,
         ExpOrCay: CoordinateMap<P::Group>];
    /// Methods for the attitude of the free rigid body.
    attitude: Field Norm Series Body Attitude: [fields, implicit, bodies, projected], P, [P: FreeBody + Split + Orthogonal],
        [P::Group: MapsByName,
         ScalarOf<P>: Trig + Wide + Into<f64>, Exp: CoordinateMap<P::Group>,
         ExpOrCay: CoordinateMap<P::Group>];
    /// Methods for the momentum of the free rigid body.
    momentum: Field Norm Series Body Momentum LiePoisson: [fields, implicit, bodies, momenta, energy_casimir], P, [P: FreeBody<Frame = ()> + Split + LiePoisson],
        [P::Group: MapsByName,
         ScalarOf<P>: Trig + Wide + Into<f64>, Exp: CoordinateMap<P::Group>,
         ExpOrCay: CoordinateMap<P::Group>];
    /// Methods for momenta as matrices.
    lie_poisson: Field Norm Series LiePoisson Isospectral: [fields, implicit, catalog::series, energy_casimir, isospectral], P,
        [P: LiePoisson + TaylorField + Problem<Group = MatrixGroup, Action = Coadjoint>], [];
    /// Methods for momentum and attitude in one state.
    state: State: [classical], RigidBodyState<S>, [S: Real], [];
    /// Methods for the quaternion of the free rigid body.
    quaternion: Field Norm Series Body: [fields, implicit, bodies], RigidBodyQuaternion, [], [];
    /// Methods for an ideal fluid.
    fluid: Field Norm LiePoisson Isospectral: [fluids, fields, implicit, energy_casimir, isospectral], Zeitlin<S>, [S: Surface], [];
}
