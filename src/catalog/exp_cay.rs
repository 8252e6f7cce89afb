//! Methods by name for groups that have the maps exp and cay alone: U(n), the unit quaternions, and those
//! of other crates.

use super::embedded::{no_pair, only_pairs, pair_of};
use super::*;
use crate::methods::{
    Composition, EnergyCasimir, GAUSS2, GAUSS4, GAUSS6, Gauss, IsospectralGauss, KAHAN_LI6, Metric,
    RkmkGauss, RkmkGaussSymmetric, SUZUKI4,
};
use crate::problems::{FluidMidpoint, PointOf, ScalarOf, Surface, Zeitlin};

/// Run `$body` with `$map` bound to exp or cay.
macro_rules! exp_or_cay {
    ($name:expr, $q:expr, $map:ident => $body:expr) => {
        match ($name, $q) {
            ("exp", None) => {
                let $map = Exp;
                Ok($body)
            }
            ("cay", None) => {
                let $map = Cay;
                Ok($body)
            }
            (name, q) => Err(no_such_map(name, q)),
        }
    };
}

fn no_such_map(name: &str, q: Option<usize>) -> Error {
    if !MAPS.iter().any(|map| map.name == name) {
        return unknown("map", name, MAPS.iter().map(|map| map.name));
    }
    let (what, why) = match q {
        Some(_) => ("q", "dexp⁻¹ is taken to rounding here; leave q out"),
        None => ("map", "the group of this problem has the maps exp and cay"),
    };
    Error::Unsupported { what, with: format!("map `{name}`"), why }
}

/// [`METHODS`] and [`IMPLICIT_METHODS`] with the maps exp and cay: [`with_implicit_method`] for a group
/// that is no [`CatalogGroup`].
///
/// # Errors
/// As [`with_method`].
pub fn with_exp_cay_method<P, V: OnMethod<P>>(spec: &MethodSpec, on: V) -> Result<V::Out, Error>
where
    P: Ambient,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
    Exp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    let map = spec.map.as_deref().unwrap_or("exp");
    match spec.info()?.name {
        "midpoint-implicit" => Ok(on.call(Gauss(GAUSS2))),
        "gauss4" => Ok(on.call(Gauss(GAUSS4))),
        "gauss6" => Ok(on.call(Gauss(GAUSS6))),
        "rkmk-gauss2" => exp_or_cay!(map, spec.q, psi => on.call(RkmkGauss::new(GAUSS2, psi))),
        "rkmk-gauss4" => exp_or_cay!(map, spec.q, psi => on.call(RkmkGauss::new(GAUSS4, psi))),
        "rkmk-gauss6" => exp_or_cay!(map, spec.q, psi => on.call(RkmkGauss::new(GAUSS6, psi))),
        "rkmk-gauss2-symmetric" => {
            exp_or_cay!(map, spec.q, psi => on.call(RkmkGaussSymmetric::new(GAUSS2, psi)))
        }
        "rkmk-gauss4-symmetric" => {
            exp_or_cay!(map, spec.q, psi => on.call(RkmkGaussSymmetric::new(GAUSS4, psi)))
        }
        "rkmk-gauss6-symmetric" => {
            exp_or_cay!(map, spec.q, psi => on.call(RkmkGaussSymmetric::new(GAUSS6, psi)))
        }
        _ => each_method!(spec, on, exp_or_cay, OnMethod::<P>::call, pair => OnMethod::<P>::call),
    }
}

/// The embedded pairs among [`METHODS`] with the maps exp and cay.
///
/// # Errors
/// As [`with_embedded_pair`].
pub fn with_exp_cay_pair<P, V: OnEmbedded<P>>(spec: &MethodSpec, on: V) -> Result<V::Out, Error>
where
    P: Ambient,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
    Exp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    only_pairs(spec, each_method!(spec, on, exp_or_cay, no_pair, pair => pair_of))
}

/// [`with_exp_cay_method`], [`LIE_POISSON_METHODS`] and [`ISOSPECTRAL_METHODS`]: an ideal fluid. The midpoint
/// rules are [`FluidMidpoint`]'s, which are the general
/// ones with less work.
///
/// # Errors
/// As [`with_method`].
pub fn with_fluid_method<S: Surface, V: OnMethod<Zeitlin<S>>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error> {
    const ISOSPECTRAL: FluidMidpoint = FluidMidpoint::isospectral();
    const ENERGY: FluidMidpoint = FluidMidpoint::energy();
    let name = spec.info()?.name;
    let of_energy = LIE_POISSON_METHODS.iter().any(|info| info.name == name);
    match (name, spec.map.as_deref().unwrap_or("exp")) {
        (_, map) if of_energy && (spec.q.is_some() || !["exp", "cay"].contains(&map)) => {
            Err(no_such_map(map, spec.q))
        }
        ("energy-casimir", "cay") => Ok(on.call(ENERGY)),
        ("energy-casimir4", "cay") => Ok(on.call(Composition::new(ENERGY, SUZUKI4))),
        ("energy-casimir6", "cay") => Ok(on.call(Composition::new(ENERGY, KAHAN_LI6))),
        ("energy-casimir", _) => Ok(on.call(EnergyCasimir::new(Exp))),
        ("energy-casimir4", _) => Ok(on.call(Composition::new(EnergyCasimir::new(Exp), SUZUKI4))),
        ("energy-casimir6", _) => Ok(on.call(Composition::new(EnergyCasimir::new(Exp), KAHAN_LI6))),
        ("isospectral2", _) => Ok(on.call(ISOSPECTRAL)),
        ("isospectral-suzuki4", _) => Ok(on.call(Composition::new(ISOSPECTRAL, SUZUKI4))),
        ("isospectral-kahan-li6", _) => Ok(on.call(Composition::new(ISOSPECTRAL, KAHAN_LI6))),
        ("isospectral4", _) => Ok(on.call(IsospectralGauss(GAUSS4))),
        ("isospectral6", _) => Ok(on.call(IsospectralGauss(GAUSS6))),
        _ => with_exp_cay_method(spec, on),
    }
}
