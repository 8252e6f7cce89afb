//! Methods that ask more of a problem than f: a list and a function for each capability.
//!
//! Each function serves its own list and hands everything else to the function below it:
//!
//! ```text
//! with_attitude_method   with_momentum_method   with_lie_poisson_method
//!           └─── with_body_method ───┘                     │
//!                        └─────── with_implicit_method ────┘
//!                                          └── with_method
//! ```

use super::{KEEPS_GROUP, METHODS, MethodInfo, MethodSpec, OnMethod, ZANNA, unknown, with_method};
use crate::error::Error;
use crate::groups::LieAlgebra;
use crate::maps::{Cay, Ccsk, CoordinateMap, Exp, TruncatedExp};
use crate::methods::{
    Buss4, DMV2, DMV4, DMV6, DMV8, DMV10, EnergyCasimir, ExactMotion, GAUSS2, GAUSS4, GAUSS6,
    Gauss, IsospectralGauss, MR2, MR4, Projected, Rk, RkmkGaussSymmetric, SimoWong, Taylor,
    tableau,
};
use crate::problems::{FreeBody, Isospectral, LiePoisson, Metric, Orthogonal, Projection, Split};

/// Methods for problems with a norm: [`with_implicit_method`].
pub const IMPLICIT_METHODS: &[MethodInfo] = &[
    MethodInfo {
        name: "midpoint-implicit",
        summary: "the implicit midpoint rule on the entries of the state",
        order: Some(2),
        takes_map: false,
        takes_tableau: false,
        preserves: QUADRATIC,
        cost: "5–20 F",
        source: GAUSS,
    },
    MethodInfo {
        name: "gauss4",
        summary: "Gauss collocation of two stages on the entries of the state",
        order: Some(4),
        takes_map: false,
        takes_tableau: false,
        preserves: QUADRATIC,
        cost: "5–20 × 2 F",
        source: GAUSS,
    },
    MethodInfo {
        name: "gauss6",
        summary: "Gauss collocation of three stages on the entries of the state",
        order: Some(6),
        takes_map: false,
        takes_tableau: false,
        preserves: QUADRATIC,
        cost: "5–20 × 3 F",
        source: GAUSS,
    },
    MethodInfo {
        name: "rkmk-gauss4-symmetric",
        summary: "implicit Runge–Kutta–Munthe-Kaas, its chart in the middle: time-symmetric; exp or cay",
        order: Some(4),
        takes_map: true,
        takes_tableau: false,
        preserves: KEEPS_GROUP,
        cost: "5–20 × (2 f, 3 Ψ, 2 dΨ⁻¹)",
        source: ZANNA,
    },
];

const QUADRATIC: &str = "quadratic invariants, time symmetry";
const GAUSS: &str = "Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3";

/// Methods for the free rigid body in ℝ³: [`with_body_method`].
pub const BODY_METHODS: &[MethodInfo] = &[
    MethodInfo {
        name: "mr2",
        summary: "McLachlan–Reich splitting, ordering 123",
        order: Some(2),
        takes_map: false,
        takes_tableau: false,
        preserves: SPLIT,
        cost: "5 axis rotations",
        source: MCLACHLAN,
    },
    MethodInfo {
        name: "mr4",
        summary: "McLachlan–Reich splitting, triple jump, ordering 123",
        order: Some(4),
        takes_map: false,
        takes_tableau: false,
        preserves: SPLIT,
        cost: "13 axis rotations",
        source: MCLACHLAN,
    },
    MethodInfo {
        name: "simo-wong",
        summary: "Simo and Wong's implicit method, increment exp(ζ)",
        order: Some(2),
        takes_map: false,
        takes_tableau: false,
        preserves: ALL_FIRST,
        cost: "3–6 Newton iterations",
        source: "Simo & Wong 1991",
    },
    MethodInfo {
        name: "simo-wong-k1",
        summary: "Simo and Wong's implicit method with k = 1: the midpoint rule in cay",
        order: Some(2),
        takes_map: false,
        takes_tableau: false,
        preserves: ALL_FIRST,
        cost: "3–6 Newton iterations",
        source: "Austin, Krishnaprasad & Wang 1993",
    },
    MethodInfo {
        name: "buss4",
        summary: "Buss's augmented Taylor method",
        order: Some(4),
        takes_map: false,
        takes_tableau: false,
        preserves: KEEPS_GROUP,
        cost: "9 ×, 4 K, 1 exp",
        source: "Buss 2000",
    },
    MethodInfo {
        name: "dmv2",
        summary: "discrete Moser–Veselov",
        order: Some(2),
        takes_map: false,
        takes_tableau: false,
        preserves: ALL_FIRST,
        cost: "3–5 Newton iterations",
        source: DMV,
    },
    MethodInfo {
        name: "dmv4",
        summary: "discrete Moser–Veselov, preprocessed to order 4",
        order: Some(4),
        takes_map: false,
        takes_tableau: false,
        preserves: ALL_FIRST,
        cost: "3–5 Newton iterations",
        source: DMV,
    },
    MethodInfo {
        name: "dmv6",
        summary: "discrete Moser–Veselov, preprocessed to order 6",
        order: Some(6),
        takes_map: false,
        takes_tableau: false,
        preserves: ALL_FIRST,
        cost: "3–5 Newton iterations",
        source: DMV,
    },
    MethodInfo {
        name: "dmv8",
        summary: "discrete Moser–Veselov, preprocessed to order 8",
        order: Some(8),
        takes_map: false,
        takes_tableau: false,
        preserves: ALL_FIRST,
        cost: "3–5 Newton iterations",
        source: DMV,
    },
    MethodInfo {
        name: "dmv10",
        summary: "discrete Moser–Veselov, preprocessed to order 10",
        order: Some(10),
        takes_map: false,
        takes_tableau: false,
        preserves: ALL_FIRST,
        cost: "3–5 Newton iterations",
        source: DMV,
    },
    MethodInfo {
        name: "exact",
        summary: "the exact motion by elliptic functions, any step",
        order: None,
        takes_map: false,
        takes_tableau: false,
        preserves: "everything",
        cost: "1–2 µs whatever the step",
        source: "Jacobi 1850",
    },
    MethodInfo {
        name: "taylor4",
        summary: "Lie series of order 4, quaternion to the unit sphere",
        order: Some(4),
        takes_map: false,
        takes_tableau: false,
        preserves: KEEPS_GROUP,
        cost: "150 multiplications",
        source: "Gröbner 1960",
    },
    MethodInfo {
        name: "taylor6",
        summary: "Lie series of order 6, quaternion to the unit sphere",
        order: Some(6),
        takes_map: false,
        takes_tableau: false,
        preserves: KEEPS_GROUP,
        cost: "315 multiplications",
        source: "Gröbner 1960",
    },
    MethodInfo {
        name: "taylor8",
        summary: "Lie series of order 8, quaternion to the unit sphere",
        order: Some(8),
        takes_map: false,
        takes_tableau: false,
        preserves: KEEPS_GROUP,
        cost: "540 multiplications",
        source: "Gröbner 1960",
    },
    MethodInfo {
        name: "taylor10",
        summary: "Lie series of order 10, quaternion to the unit sphere",
        order: Some(10),
        takes_map: false,
        takes_tableau: false,
        preserves: KEEPS_GROUP,
        cost: "825 multiplications",
        source: "Gröbner 1960",
    },
    MethodInfo {
        name: "taylor12",
        summary: "Lie series of order 12, quaternion to the unit sphere",
        order: Some(12),
        takes_map: false,
        takes_tableau: false,
        preserves: KEEPS_GROUP,
        cost: "1170 multiplications",
        source: "Gröbner 1960",
    },
    MethodInfo {
        name: "taylor16",
        summary: "Lie series of order 16, quaternion to the unit sphere",
        order: Some(16),
        takes_map: false,
        takes_tableau: false,
        preserves: KEEPS_GROUP,
        cost: "2040 multiplications",
        source: "Gröbner 1960",
    },
];

const SPLIT: &str = "group, Casimirs, symplectic structure, time symmetry";
const ALL_FIRST: &str = "energy, group, Casimirs, time symmetry";
const MCLACHLAN: &str = "McLachlan 1993; Reich 1996";
const DMV: &str = "Moser & Veselov 1991; McLachlan & Zanna 2005; Hairer & Vilmart 2006";

/// Methods for a state with an orthogonal matrix: [`with_attitude_method`].
pub const ATTITUDE_METHODS: &[MethodInfo] = &[
    MethodInfo {
        name: "rk4-qr",
        summary: "classical Runge–Kutta on the entries, then the factor Q of g = QR",
        order: Some(4),
        takes_map: false,
        takes_tableau: false,
        preserves: "group",
        cost: "4 F, 2 Gram–Schmidt",
        source: PROJECTION,
    },
    MethodInfo {
        name: "rk4-polar",
        summary: "classical Runge–Kutta on the entries, then the polar factor of g",
        order: Some(4),
        takes_map: false,
        takes_tableau: false,
        preserves: "group",
        cost: "4 F, 2–3 Newton–Schulz",
        source: PROJECTION,
    },
];

const PROJECTION: &str = "Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.4";

/// Methods for Lie–Poisson systems: [`with_momentum_method`], [`with_lie_poisson_method`].
pub const LIE_POISSON_METHODS: &[MethodInfo] = &[MethodInfo {
    name: "energy-casimir",
    summary: "discrete gradient in the algebra and coadjoint action; exp or cay",
    order: Some(2),
    takes_map: true,
    takes_tableau: false,
    preserves: "energy, Casimirs, time symmetry",
    cost: "5–20 × (∇H, Ψ, Λ)",
    source: "after Simo & Wong 1991; Lewis & Simo 1994",
}];

/// Methods for isospectral systems on matrices: [`with_lie_poisson_method`].
pub const ISOSPECTRAL_METHODS: &[MethodInfo] = &[
    MethodInfo {
        name: "isospectral2",
        summary: "isospectral Gauss of one stage",
        order: Some(2),
        takes_map: false,
        takes_tableau: false,
        preserves: "Casimirs, symplectic structure, time symmetry",
        cost: "8–25 × 3 products",
        source: "Modin & Viviani 2020",
    },
    MethodInfo {
        name: "isospectral4",
        summary: "isospectral Gauss of two stages",
        order: Some(4),
        takes_map: false,
        takes_tableau: false,
        preserves: "Casimirs, symplectic structure, time symmetry",
        cost: "8–25 × 6 products",
        source: "Modin & Viviani 2020",
    },
    MethodInfo {
        name: "isospectral6",
        summary: "isospectral Gauss of three stages",
        order: Some(6),
        takes_map: false,
        takes_tableau: false,
        preserves: "Casimirs, symplectic structure, time symmetry",
        cost: "8–25 × 9 products",
        source: "Modin & Viviani 2020",
    },
];

/// Each list of methods with what a problem needs for it.
const LISTS: [(&[MethodInfo], &str); 6] = [
    (METHODS, "it serves every problem"),
    (IMPLICIT_METHODS, "it needs a norm on the state; ask with_implicit_method"),
    (BODY_METHODS, "it needs a free rigid body in ℝ³; ask with_body_method"),
    (ATTITUDE_METHODS, "it needs a state with an attitude; ask with_attitude_method"),
    (
        LIE_POISSON_METHODS,
        "it needs a Lie–Poisson system by its momentum; ask with_momentum_method or with_lie_poisson_method",
    ),
    (ISOSPECTRAL_METHODS, "it needs momenta as matrices; ask with_lie_poisson_method"),
];

/// Every method that some problem can ask for, list by list.
pub fn all_methods() -> impl Iterator<Item = &'static MethodInfo> {
    LISTS.iter().flat_map(|(list, _)| list.iter())
}

/// The error of a method that is registered but does not fit the problem, or of an unknown one.
pub(super) fn misfit(name: &str) -> Error {
    let found = LISTS
        .iter()
        .find_map(|(list, why)| list.iter().find(|m| m.name == name).map(|m| (m.name, *why)));
    match found {
        Some((what, why)) => Error::Unsupported { what, with: "this problem".into(), why },
        None => unknown("method", name, all_methods().map(|m| m.name)),
    }
}

/// Run `$body` with `$map` bound to exp or cay.
macro_rules! each_odd_map {
    ($spec:expr, $map:ident => $body:expr) => {
        match ($spec.map.as_deref().unwrap_or("exp"), $spec.q) {
            ("exp", None) => {
                let $map = Exp;
                Ok($body)
            }
            ("cay", None) => {
                let $map = Cay;
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
pub fn with_implicit_method<P: Metric, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    Exp: CoordinateMap<P::Group>,
    TruncatedExp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Ccsk<0, 1, 2>: CoordinateMap<P::Group>,
    Ccsk<2, 1, 0>: CoordinateMap<P::Group>,
{
    match spec.info()?.name {
        "midpoint-implicit" => Ok(on.call(Gauss(GAUSS2))),
        "gauss4" => Ok(on.call(Gauss(GAUSS4))),
        "gauss6" => Ok(on.call(Gauss(GAUSS6))),
        "rkmk-gauss4-symmetric" => {
            each_odd_map!(spec, psi => on.call(RkmkGaussSymmetric::new(GAUSS4, psi)))
        }
        _ => with_method(spec, on),
    }
}

/// [`with_implicit_method`] and [`BODY_METHODS`].
///
/// # Errors
/// As [`with_method`].
pub fn with_body_method<P: FreeBody + Split + Metric, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    P::Group: LieAlgebra<Scalar = f64>,
    Exp: CoordinateMap<P::Group>,
    TruncatedExp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Ccsk<0, 1, 2>: CoordinateMap<P::Group>,
    Ccsk<2, 1, 0>: CoordinateMap<P::Group>,
{
    match spec.info()?.name {
        "mr2" => Ok(on.call(MR2)),
        "mr4" => Ok(on.call(MR4)),
        "simo-wong" => Ok(on.call(SimoWong::TAN)),
        "simo-wong-k1" => Ok(on.call(SimoWong::ONE)),
        "buss4" => Ok(on.call(Buss4)),
        "dmv2" => Ok(on.call(DMV2)),
        "dmv4" => Ok(on.call(DMV4)),
        "dmv6" => Ok(on.call(DMV6)),
        "dmv8" => Ok(on.call(DMV8)),
        "dmv10" => Ok(on.call(DMV10)),
        "exact" => Ok(on.call(ExactMotion)),
        "taylor4" => Ok(on.call(Taylor::<4>)),
        "taylor6" => Ok(on.call(Taylor::<6>)),
        "taylor8" => Ok(on.call(Taylor::<8>)),
        "taylor10" => Ok(on.call(Taylor::<10>)),
        "taylor12" => Ok(on.call(Taylor::<12>)),
        "taylor16" => Ok(on.call(Taylor::<16>)),
        _ => with_implicit_method(spec, on),
    }
}

/// [`with_body_method`] and [`ATTITUDE_METHODS`]: the body with its attitude.
///
/// # Errors
/// As [`with_method`].
pub fn with_attitude_method<P: FreeBody + Split + Metric + Orthogonal, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    P::Group: LieAlgebra<Scalar = f64>,
    Exp: CoordinateMap<P::Group>,
    TruncatedExp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Ccsk<0, 1, 2>: CoordinateMap<P::Group>,
    Ccsk<2, 1, 0>: CoordinateMap<P::Group>,
{
    match spec.info()?.name {
        "rk4-qr" => Ok(on.call(Projected::new(Rk(tableau::RK4), Projection::Qr))),
        "rk4-polar" => Ok(on.call(Projected::new(Rk(tableau::RK4), Projection::Polar))),
        _ => with_body_method(spec, on),
    }
}

/// [`with_body_method`] and [`LIE_POISSON_METHODS`]: the body in ℝ³ by its momentum.
///
/// # Errors
/// As [`with_method`].
pub fn with_momentum_method<P: FreeBody + Split + LiePoisson, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error>
where
    P::Group: LieAlgebra<Scalar = f64>,
    Exp: CoordinateMap<P::Group>,
    TruncatedExp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Ccsk<0, 1, 2>: CoordinateMap<P::Group>,
    Ccsk<2, 1, 0>: CoordinateMap<P::Group>,
{
    match spec.info()?.name {
        "energy-casimir" => each_odd_map!(spec, psi => on.call(EnergyCasimir::new(psi))),
        _ => with_body_method(spec, on),
    }
}

/// [`with_implicit_method`], [`LIE_POISSON_METHODS`] and [`ISOSPECTRAL_METHODS`]: momenta as
/// matrices.
///
/// # Errors
/// As [`with_method`].
pub fn with_lie_poisson_method<P: LiePoisson + Isospectral, V: OnMethod<P>>(
    spec: &MethodSpec,
    on: V,
) -> Result<V::Out, Error> {
    match spec.info()?.name {
        "energy-casimir" => each_odd_map!(spec, psi => on.call(EnergyCasimir::new(psi))),
        "isospectral2" => Ok(on.call(IsospectralGauss(GAUSS2))),
        "isospectral4" => Ok(on.call(IsospectralGauss(GAUSS4))),
        "isospectral6" => Ok(on.call(IsospectralGauss(GAUSS6))),
        _ => with_implicit_method(spec, on),
    }
}
