//! Classical methods on (m, g): the momentum and the entries of the attitude as one state of 12 numbers.
//!
//! What [`STATE_METHODS`] lists, and nothing else: a method that acts by the group moves (m, g) as it
//! moves g, and is found under the attitude.

use super::*;
use crate::methods::{GAUSS2, GAUSS4, GAUSS6, Gauss};
use crate::problems::RigidBodyState;
use crate::scalar::Real;

/// Hand the method that `$spec` names to `$single`, or to `$pair` where it estimates its own error.
macro_rules! each_state_method {
    ($spec:expr, $on:expr, $single:path, pair => $pair:path) => {{
        let spec: &MethodSpec = $spec;
        match spec.info()?.name {
            "rk4-mg" => Ok($single($on, Rk(tableau::RK4))),
            "rk-mg" => each_tableau!(spec.tableau.as_deref().unwrap_or("rk4"),
                t => Ok($single($on, Rk(t))),
                pair => Ok($pair($on, Rk(t)))),
            "midpoint-implicit-mg" => Ok($single($on, Gauss(GAUSS2))),
            "gauss4-mg" => Ok($single($on, Gauss(GAUSS4))),
            "gauss6-mg" => Ok($single($on, Gauss(GAUSS6))),
            other => Err(misfit(other)),
        }
    }};
}

/// [`STATE_METHODS`].
///
/// # Errors
/// As [`with_method`].
pub fn with_state_method<S: Real, V: OnMethod<RigidBodyState<S>>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error> {
    each_state_method!(spec, on, OnMethod::<RigidBodyState<S>>::call,
        pair => OnMethod::<RigidBodyState<S>>::call)
}

/// The embedded pairs among [`STATE_METHODS`].
///
/// # Errors
/// As [`with_embedded_pair`].
pub fn with_state_pair<S: Real, V: OnEmbedded<RigidBodyState<S>>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error> {
    embedded::only_pairs(
        spec,
        each_state_method!(spec, on, embedded::no_pair, pair => embedded::pair_of),
    )
}
