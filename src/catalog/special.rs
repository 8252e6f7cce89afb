//! What methods ask of a problem, and a function for each kind of problem.
//!
//! Two questions are answered here:
//!
//! - *Which methods fit my problem?* Know what the problem offers, as [`Needs`]; each of them lists
//!   its methods by [`Needs::methods`], and [`all_methods`] goes through all.
//! - *Run this spec on my problem.* Call the function of the problem's kind with the spec and a
//!   visitor ([`OnMethod`]); a method that is registered but does not fit is refused by
//!   [`Error::Unsupported`] with what it needs, an unknown one by [`Error::UnknownName`].
//!
//! | function | problem | offers |
//! |---|---|---|
//! | [`with_method`] | [`Ambient`] | `Field` |
//! | [`with_implicit_method`] | and points with a norm | `Field`, `Norm` |
//! | [`with_series_method`] | Taylor coefficients by recurrence | `Field`, `Norm`, `Series` |
//! | [`with_euler_method`] | Euler's equations on any algebra, by a discrete gradient | `Field`, `Norm`, `LiePoisson` |
//! | [`with_lie_poisson_method`] | momenta as matrices | `Field`, `Norm`, `Series`, `LiePoisson`, `Isospectral` |
//! | [`with_body_method`] | a free rigid body in ℝ³ | `Field`, `Norm`, `Series`, `Body` |
//! | [`with_attitude_method`] | and its attitude in the state | `Field`, `Norm`, `Series`, `Body`, `Attitude` |
//! | [`with_momentum_method`] | the body by its momentum | `Field`, `Norm`, `Series`, `Body`, `LiePoisson` |
//! | [`with_exp_cay_method`](super::with_exp_cay_method) | on a group with the maps exp and cay | `Field`, `Norm` |
//! | [`with_quaternion_method`] | a free rigid body by its quaternion | `Field`, `Norm`, `Series`, `Body` |
//! | [`with_fluid_method`](super::with_fluid_method) | an ideal fluid, [`Zeitlin`](crate::problems::Zeitlin) | `Field`, `Norm`, `LiePoisson`, `Isospectral` |
//! | [`with_state_method`](super::with_state_method) | both in one state, [`RigidBodyState`] | `State` |
//! | [`with_linear_method`](super::with_linear_method) | ẏ = λ_*(A(t))(y) | `LinearType` |
//!
//! Each but the last two hands what is not its own to the function that it extends. With the visitor
//! [`Doubled`](super::Doubled) any of them serves an adaptive run.
//!
//! [`RigidBodyState`]: crate::problems::RigidBodyState

use super::*;
use crate::actions::{Action, Coadjoint};
use crate::groups::MatrixGroup;
use crate::methods::{
    Buss4, Composition, DMV2, DMV4, DMV6, DMV8, DMV10, EnergyCasimir, ExactMotion, GAUSS2, GAUSS4,
    GAUSS6, Gauss, IsospectralGauss, KAHAN_LI6, KAHAN_LI8, LieSeries, Metric, Projected, RkmkGauss,
    RkmkGaussSymmetric, SOFRONIOU_SPALETTA10, STRANG, SUZUKI4, Scheme, SeriesGroup, SimoWong,
    Splitting, Taylor, Wide, YOSHIDA4,
};
use crate::problems::{
    FreeBody, LiePoisson, Orthogonal, PointOf, Problem, Projection, RigidBodyQuaternion, ScalarOf,
    Split, TaylorField,
};
use crate::scalar::Trig;

/// What a method asks of a problem beyond f, and so what a problem may offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Needs {
    /// F on the linear space around M ([`Ambient`]).
    Field,
    /// f that depends on time alone ([`LinearField`](crate::problems::LinearField)).
    LinearType,
    /// A norm of the points ([`Metric`]).
    Norm,
    /// Taylor coefficients by recurrence ([`TaylorField`]).
    Series,
    /// The free rigid body in ℝ³ ([`FreeBody`], [`Split`]).
    Body,
    /// An orthogonal matrix in the state ([`Orthogonal`]).
    Attitude,
    /// The momentum and the attitude as one state ([`RigidBodyState`](crate::problems::RigidBodyState)).
    State,
    /// A Hamiltonian on 𝔤* ([`LiePoisson`]).
    LiePoisson,
    /// The coadjoint action on matrices ([`Coadjoint`]): Ẇ = \[f, W\] for W = mᵀ.
    Isospectral,
}

impl Needs {
    /// Each of them.
    pub const ALL: [Needs; 9] = [
        Needs::Field,
        Needs::LinearType,
        Needs::Norm,
        Needs::Series,
        Needs::Body,
        Needs::Attitude,
        Needs::State,
        Needs::LiePoisson,
        Needs::Isospectral,
    ];

    /// The methods that need it.
    pub const fn methods(self) -> &'static [MethodInfo] {
        match self {
            Needs::Field => METHODS,
            Needs::LinearType => LINEAR_METHODS,
            Needs::Norm => IMPLICIT_METHODS,
            Needs::Series => SERIES_METHODS,
            Needs::Body => BODY_METHODS,
            Needs::Attitude => ATTITUDE_METHODS,
            Needs::State => STATE_METHODS,
            Needs::LiePoisson => LIE_POISSON_METHODS,
            Needs::Isospectral => ISOSPECTRAL_METHODS,
        }
    }

    /// It in words.
    pub fn describe(self) -> &'static str {
        self.why().trim_start_matches("it needs ")
    }

    const fn why(self) -> &'static str {
        match self {
            Needs::Field => "it needs a vector field on the linear space around M",
            Needs::LinearType => "it needs an equation of linear type, f(t, y) = A(t)",
            Needs::Norm => "it needs a norm of the states",
            Needs::Series => "it needs a field with Taylor coefficients by recurrence",
            Needs::Body => "it needs a free rigid body in three dimensions",
            Needs::Attitude => "it needs an attitude in the state",
            Needs::State => {
                "it needs a rigid body in three dimensions by its momentum and its attitude"
            }
            Needs::LiePoisson => "it needs a Lie–Poisson system, given by its momentum",
            Needs::Isospectral => "it needs momenta as matrices",
        }
    }
}

/// Every method that some problem can ask for, with what it needs.
///
/// ```
/// use lieflow::catalog::{Needs, all_methods};
/// let body_in_space = [Needs::Field, Needs::Norm, Needs::Body, Needs::Attitude];
/// let fitting: Vec<_> =
///     all_methods().filter(|(_, needs)| body_in_space.contains(needs)).map(|(m, _)| m.name).collect();
/// assert!(fitting.contains(&"rkmk4") && fitting.contains(&"dmv10"));
/// assert!(!fitting.contains(&"magnus4"));
/// ```
pub fn all_methods() -> impl Iterator<Item = (&'static MethodInfo, Needs)> {
    Needs::ALL.into_iter().flat_map(|needs| needs.methods().iter().map(move |m| (m, needs)))
}

/// The error of a method that is registered but does not fit the problem, or of an unknown one.
pub(super) fn misfit(name: &str) -> Error {
    match all_methods().find(|(m, _)| m.name == name) {
        Some((m, needs)) => {
            let with = "this problem".into();
            Error::Unsupported { what: m.name, with, why: needs.why() }
        }
        None => unknown("method", name, all_methods().map(|(m, _)| m.name)),
    }
}

/// What the functions here ask of every problem: a group that all maps serve, and a norm of the points.
pub trait Catalogued:
    Ambient<
        Group: CatalogGroup,
        Action: Action<<Self as Problem>::Group, Point: Metric<Scalar = ScalarOf<Self>>>,
    >
{
}

impl<P: Ambient<Group: CatalogGroup>> Catalogued for P where PointOf<P>: Metric<Scalar = ScalarOf<P>>
{}

/// Run `$body` with `$map` bound to exp or cay.
macro_rules! each_odd_map {
    ($spec:expr, $map:ident => $body:expr) => {
        match ($spec.map.as_deref().unwrap_or("exp"), $spec.q) {
            ("exp", None) => {
                let $map = Exp;
                Ok($body)
            }
            ("cay", None) => {
                let $map = serve::<P::Group, _>(Cay);
                Ok($body)
            }
            (map, q) => Err(Error::Unsupported {
                what: if q.is_some() { "q" } else { "map" },
                with: format!("`{}` with map `{map}`", $spec.name),
                why: "it needs Ψ(−u) = Ψ(u)⁻¹ and dΨ⁻¹ to rounding: exp or cay",
            }),
        }
    };
}

/// [`with_method`] and [`IMPLICIT_METHODS`].
///
/// # Errors
/// As [`with_method`].
pub fn with_implicit_method<P: Catalogued, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    Exp: CoordinateMap<P::Group>,
{
    let map = spec.map.as_deref().unwrap_or("exp");
    match spec.info()?.name {
        "midpoint-implicit" => Ok(on.call(Gauss(GAUSS2))),
        "gauss4" => Ok(on.call(Gauss(GAUSS4))),
        "gauss6" => Ok(on.call(Gauss(GAUSS6))),
        "rkmk-gauss2" => each_map!(map, spec.q, psi => on.call(RkmkGauss::new(GAUSS2, psi))),
        "rkmk-gauss4" => each_map!(map, spec.q, psi => on.call(RkmkGauss::new(GAUSS4, psi))),
        "rkmk-gauss6" => each_map!(map, spec.q, psi => on.call(RkmkGauss::new(GAUSS6, psi))),
        "rkmk-gauss2-symmetric" => {
            each_odd_map!(spec, psi => on.call(RkmkGaussSymmetric::new(GAUSS2, psi)))
        }
        "rkmk-gauss4-symmetric" => {
            each_odd_map!(spec, psi => on.call(RkmkGaussSymmetric::new(GAUSS4, psi)))
        }
        "rkmk-gauss6-symmetric" => {
            each_odd_map!(spec, psi => on.call(RkmkGaussSymmetric::new(GAUSS6, psi)))
        }
        _ => with_method(spec, on),
    }
}

/// [`with_implicit_method`] and [`SERIES_METHODS`]: fields with Taylor coefficients by recurrence.
///
/// # Errors
/// As [`with_method`].
pub fn with_series_method<P: Catalogued + TaylorField, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    P::Group: SeriesGroup,
    Exp: CoordinateMap<P::Group>,
{
    let name = spec.info()?.name;
    match name.strip_prefix("taylor").map(str::parse) {
        Some(Ok(order)) => Ok(on.call(LieSeries::new(order)?)),
        _ => with_implicit_method(spec, on),
    }
}

/// The splitting that a name asks for.
fn splitting(name: &str) -> Option<Splitting<3>> {
    let (scheme, axes) = name.split_once('-').unwrap_or((name, "123"));
    let scheme: Scheme = match (scheme, axes) {
        ("mr4", "suzuki") => return Some(Splitting::new([0, 1, 2], SUZUKI4)),
        ("mr2", _) => STRANG,
        ("mr4", _) => YOSHIDA4,
        ("mr6", _) => KAHAN_LI6,
        ("mr8", _) => KAHAN_LI8,
        ("mr10", _) => SOFRONIOU_SPALETTA10,
        _ => return None,
    };
    let parts = match axes {
        "123" => [0, 1, 2],
        "132" => [0, 2, 1],
        "213" => [1, 0, 2],
        "231" => [1, 2, 0],
        "312" => [2, 0, 1],
        "321" => [2, 1, 0],
        _ => return None,
    };
    Some(Splitting::new(parts, scheme))
}

/// Hand the method for a free rigid body of that name to `$on`, or go on to `$else`.
macro_rules! each_body_method {
    ($name:expr, $on:expr, else => $else:expr) => {
        match $name {
            "simo-wong" => Ok($on.call(SimoWong::TAN)),
            "simo-wong-k1" => Ok($on.call(SimoWong::ONE)),
            "lewis-simo" => Ok($on.call(SimoWong::LEWIS_SIMO)),
            "simo-wong4" => Ok($on.call(Composition::new(SimoWong::TAN, SUZUKI4))),
            "simo-wong6" => Ok($on.call(Composition::new(SimoWong::TAN, KAHAN_LI6))),
            "buss4" => Ok($on.call(Buss4)),
            "dmv2" => Ok($on.call(DMV2)),
            "dmv4" => Ok($on.call(DMV4)),
            "dmv6" => Ok($on.call(DMV6)),
            "dmv8" => Ok($on.call(DMV8)),
            "dmv10" => Ok($on.call(DMV10)),
            "exact" => Ok($on.call(ExactMotion)),
            "taylor4" => Ok($on.call(Taylor::<4>)),
            "taylor5" => Ok($on.call(Taylor::<5>)),
            "taylor6" => Ok($on.call(Taylor::<6>)),
            "taylor7" => Ok($on.call(Taylor::<7>)),
            "taylor8" => Ok($on.call(Taylor::<8>)),
            "taylor9" => Ok($on.call(Taylor::<9>)),
            "taylor10" => Ok($on.call(Taylor::<10>)),
            "taylor11" => Ok($on.call(Taylor::<11>)),
            "taylor12" => Ok($on.call(Taylor::<12>)),
            "taylor13" => Ok($on.call(Taylor::<13>)),
            "taylor14" => Ok($on.call(Taylor::<14>)),
            "taylor15" => Ok($on.call(Taylor::<15>)),
            "taylor16" => Ok($on.call(Taylor::<16>)),
            name => match splitting(name) {
                Some(splitting) => Ok($on.call(splitting)),
                None => $else,
            },
        }
    };
}
/// [`with_implicit_method`], [`SERIES_METHODS`] and [`BODY_METHODS`]: the free rigid body in ℝ³.
///
/// # Errors
/// As [`with_method`].
pub fn with_body_method<P: Catalogued + FreeBody + Split, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    ScalarOf<P>: Trig + Wide + Into<f64>,
    Exp: CoordinateMap<P::Group>,
{
    each_body_method!(spec.info()?.name, on, else => with_implicit_method(spec, on))
}

/// [`with_exp_cay_method`], [`SERIES_METHODS`] and [`BODY_METHODS`]: the body in ℝ³ by the quaternion of its attitude.
///
/// # Errors
/// As [`with_method`].
pub fn with_quaternion_method<V: OnMethod<RigidBodyQuaternion>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error> {
    each_body_method!(spec.info()?.name, on, else => with_exp_cay_method(spec, on))
}

/// Hand the projected method that `$spec` names to `$single`, or to `$pair` where it estimates its own
/// error, or go on to `$else`.
macro_rules! each_projected {
    (@of $spec:expr, $on:expr, $how:expr, $single:path, pair => $pair:path) => {
        each_tableau!($spec.tableau.as_deref().unwrap_or("rk4"),
            t => Ok($single($on, Projected::new(Rk(t), $how))),
            pair => Ok($pair($on, Projected::new(Rk(t), $how))))
    };
    ($spec:expr, $on:expr, $single:path, pair => $pair:path, else => $else:expr) => {{
        let how = match $spec.info()?.name {
            "rk4-qr" | "rk-qr" => Some(Projection::Qr),
            "rk4-polar" | "rk-polar" => Some(Projection::Polar),
            _ => None,
        };
        match how {
            Some(how) => each_projected!(@of $spec, $on, how, $single, pair => $pair),
            None => $else,
        }
    }};
}

/// [`with_body_method`] and [`ATTITUDE_METHODS`]: the body with its attitude.
///
/// # Errors
/// As [`with_method`].
pub fn with_attitude_method<P: Catalogued + FreeBody + Split + Orthogonal, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    ScalarOf<P>: Trig + Wide + Into<f64>,
    Exp: CoordinateMap<P::Group>,
{
    each_projected!(spec, on, OnMethod::<P>::call, pair => OnMethod::<P>::call,
        else => with_body_method(spec, on))
}

/// The embedded pairs among [`ATTITUDE_METHODS`] and those of [`with_embedded_pair`].
///
/// # Errors
/// As [`with_embedded_pair`].
pub fn with_attitude_pair<P: Catalogued + Orthogonal, V: OnEmbedded<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
    Exp: CoordinateMap<P::Group>,
{
    let pair = each_projected!(spec, on, embedded::no_pair, pair => embedded::pair_of,
        else => return with_embedded_pair(spec, on));
    embedded::only_pairs(spec, pair)
}

/// Hand the energy and Casimir preserving method of that name to `$on`, or go on to `$else`.
macro_rules! each_energy_casimir {
    ($spec:expr, $on:expr, else => $else:expr) => {
        match $spec.info()?.name {
            "energy-casimir" => each_odd_map!($spec, psi => $on.call(EnergyCasimir::new(psi))),
            "energy-casimir4" => each_odd_map!($spec, psi =>
                $on.call(Composition::new(EnergyCasimir::new(psi), SUZUKI4))),
            "energy-casimir6" => each_odd_map!($spec, psi =>
                $on.call(Composition::new(EnergyCasimir::new(psi), KAHAN_LI6))),
            _ => $else,
        }
    };
}

/// [`with_implicit_method`] and [`LIE_POISSON_METHODS`]: Euler's equations on any algebra.
///
/// # Errors
/// As [`with_method`].
pub fn with_euler_method<P: Catalogued + LiePoisson, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    Exp: CoordinateMap<P::Group>,
{
    each_energy_casimir!(spec, on, else => with_implicit_method(spec, on))
}

/// [`with_body_method`] and [`LIE_POISSON_METHODS`]: the body in ℝ³ by its momentum.
///
/// # Errors
/// As [`with_method`].
pub fn with_momentum_method<P: Catalogued + FreeBody + Split + LiePoisson, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    ScalarOf<P>: Trig + Wide + Into<f64>,
    Exp: CoordinateMap<P::Group>,
{
    each_energy_casimir!(spec, on, else => with_body_method(spec, on))
}

/// [`with_series_method`], [`LIE_POISSON_METHODS`] and [`ISOSPECTRAL_METHODS`]: momenta as matrices.
///
/// # Errors
/// As [`with_method`].
pub fn with_lie_poisson_method<P, V: OnMethod<P>>(spec: &MethodSpec, on: V) -> Result<V::Out, Error>
where
    P: LiePoisson + TaylorField + Problem<Group = MatrixGroup, Action = Coadjoint>,
{
    match spec.info()?.name {
        "isospectral2" => Ok(on.call(IsospectralGauss(GAUSS2))),
        "isospectral4" => Ok(on.call(IsospectralGauss(GAUSS4))),
        "isospectral6" => Ok(on.call(IsospectralGauss(GAUSS6))),
        "isospectral-suzuki4" => Ok(on.call(Composition::new(IsospectralGauss(GAUSS2), SUZUKI4))),
        "isospectral-kahan-li6" => {
            Ok(on.call(Composition::new(IsospectralGauss(GAUSS2), KAHAN_LI6)))
        }
        _ => each_energy_casimir!(spec, on, else => with_series_method(spec, on)),
    }
}
