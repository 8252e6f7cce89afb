//! The methods, list by list: what each is, promises, costs and where it comes from.

mod body;

pub use body::{ATTITUDE_METHODS, BODY_METHODS, SERIES_METHODS, STATE_METHODS};

use super::MethodInfo;

const RKMK: &str = "Runge–Kutta–Munthe-Kaas";
const RUNGE_KUTTA: &str = "Runge–Kutta";
const COMMUTATOR_FREE: &str = "commutator-free";
const CROUCH_GROSSMAN: &str = "Crouch–Grossman";
const MAGNUS: &str = "Magnus";
const SPLITTING: &str = "splitting";
const MOMENTUM: &str = "energy and momentum";
const DISCRETE: &str = "discrete mechanics";
const SERIES: &str = "Lie series";
const PROJECTED: &str = "projection";
const LIE_POISSON: &str = "Lie–Poisson";

/// A method without map and tableau.
const fn plain(
    family: &'static str,
    name: &'static str,
    order: Option<usize>,
    summary: &'static str,
    [preserves, cost, source]: [&'static str; 3],
) -> MethodInfo {
    MethodInfo {
        family,
        name,
        summary,
        order,
        takes_map: false,
        takes_tableau: false,
        preserves,
        cost,
        source,
    }
}

/// The same in coordinates that are chosen.
const fn in_coordinates(info: MethodInfo) -> MethodInfo {
    MethodInfo { takes_map: true, ..info }
}

/// The same with a tableau that is chosen.
const fn of_a_tableau(info: MethodInfo) -> MethodInfo {
    MethodInfo { takes_tableau: true, ..info }
}

const KEEPS_GROUP: &str = "group, Casimirs";
const LINEAR_ONLY: &str = "linear invariants only";
const MUNTHE_KAAS: &str = "Munthe-Kaas 1999; Celledoni & Owren, Table 1";
const KUTTA: &str = "Hairer, Nørsett, Wanner I, p. 138";

/// A method that keeps the group, in exp.
const fn with_exp(
    family: &'static str,
    name: &'static str,
    order: usize,
    summary: &'static str,
    [cost, source]: [&'static str; 2],
) -> MethodInfo {
    plain(family, name, Some(order), summary, [KEEPS_GROUP, cost, source])
}

const fn cf(
    name: &'static str,
    order: usize,
    summary: &'static str,
    cost: &'static str,
    source: &'static str,
) -> MethodInfo {
    with_exp(COMMUTATOR_FREE, name, order, summary, [cost, source])
}

const CMO: &str = "Celledoni, Marthinsen, Owren 2003";
const BAZAVOV: &str = "Bazavov 2022";
const EES: &str = "Shmelev, Thompson, Salvi 2025";

/// The methods for every problem: `with_method`.
pub const METHODS: &[MethodInfo] = &[
    in_coordinates(plain(
        RKMK,
        "rkmk4",
        Some(4),
        "Runge–Kutta–Munthe-Kaas with the classical tableau",
        [KEEPS_GROUP, "4 f, 4 Ψ, 3 dΨ⁻¹", MUNTHE_KAAS],
    )),
    of_a_tableau(in_coordinates(plain(
        RKMK,
        "rkmk",
        None,
        "Runge–Kutta–Munthe-Kaas with any explicit tableau",
        [KEEPS_GROUP, "s f, s Ψ, s−1 dΨ⁻¹", MUNTHE_KAAS],
    ))),
    plain(
        RUNGE_KUTTA,
        "rk4",
        Some(4),
        "classical Runge–Kutta on the entries of the state",
        [LINEAR_ONLY, "4 F", KUTTA],
    ),
    of_a_tableau(plain(
        RUNGE_KUTTA,
        "rk",
        None,
        "explicit Runge–Kutta with any tableau on the entries of the state",
        [LINEAR_ONLY, "s F", KUTTA],
    )),
    with_exp(
        RKMK,
        "rkmk4-2c",
        4,
        "RKMK of order 4 with two commutators",
        ["4 f, 4 exp, 2 brackets", "Munthe-Kaas, Owren 1999"],
    ),
    with_exp(
        MAGNUS,
        "magnus43",
        4,
        "Magnus method for nonlinear equations, pair 4(3)",
        ["6 f, 6 exp, 3 brackets", "Casas, Iserles 2006"],
    ),
    cf("cf3", 3, "commutator-free, 3 stages", "3 f, 4 exp", CMO),
    cf("cf4", 4, "commutator-free, 4 stages", "4 f, 5 exp", CMO),
    cf(
        "cf43",
        4,
        "commutator-free pair 4(3)",
        "4 f, 5 exp; 5 f, 8 exp with the error",
        "Curry, Owren 2019",
    ),
    cf("cf-ls3", 3, "commutator-free in low storage (Lüscher)", "3 f, 3 exp", BAZAVOV),
    cf(
        "cf-ls3-bp",
        3,
        "commutator-free in low storage (Bernardini, Pirozzoli)",
        "3 f, 3 exp",
        BAZAVOV,
    ),
    cf("cf-ls32", 3, "commutator-free in low storage, pair 3(2)", "5 f, 5 exp", BAZAVOV),
    cf("cf-ls4", 4, "commutator-free in low storage (Carpenter, Kennedy)", "5 f, 5 exp", BAZAVOV),
    cf("cf-ls5", 5, "commutator-free in low storage (Yan)", "13 f, 13 exp", BAZAVOV),
    cf("cf-ees25", 2, "order 2, reversible to order 5", "3 f, 3 exp", EES),
    cf("cf-ees27", 2, "order 2, reversible to order 7", "4 f, 4 exp", EES),
    with_exp(
        CROUCH_GROSSMAN,
        "cg2",
        2,
        "Crouch–Grossman, 2 stages",
        ["2 f, 2 exp", "Crouch, Grossman 1993"],
    ),
    with_exp(
        CROUCH_GROSSMAN,
        "cg3",
        3,
        "Crouch–Grossman, 3 stages",
        ["3 f, 6 exp", "Owren, Marthinsen 1999"],
    ),
    with_exp(
        CROUCH_GROSSMAN,
        "cg4",
        4,
        "Crouch–Grossman, 5 stages (CG4a)",
        ["5 f, 15 exp", "Jackiewicz, Marthinsen, Owren 2000"],
    ),
];

const fn magnus(
    name: &'static str,
    order: usize,
    summary: &'static str,
    cost: &'static str,
    source: &'static str,
) -> MethodInfo {
    let keeps = "group, Casimirs, time symmetry";
    plain(MAGNUS, name, Some(order), summary, [keeps, cost, source])
}

const BLANES: &str = "Blanes, Casas, Ros 2000";
const ALVERMANN: &str = "Alvermann, Fehske 2011";

/// The methods for equations of linear type, ẏ = λ_*(A(t))(y): `with_linear_method`.
pub const LINEAR_METHODS: &[MethodInfo] = &[
    magnus("magnus4", 4, "Magnus, order 4", "2 A, 1 exp, 1 bracket", "Iserles, Nørsett 1999"),
    magnus("magnus6", 6, "Magnus, order 6", "3 A, 1 exp, 3 brackets", BLANES),
    magnus("magnus8", 8, "Magnus, order 8", "4 A, 1 exp, 10 brackets", BLANES),
    magnus("cfm4-2", 4, "commutator-free Magnus, order 4", "2 A, 2 exp", "Blanes, Moan 2006"),
    magnus("cfm4-3", 4, "commutator-free Magnus, order 4, optimised", "3 A, 3 exp", ALVERMANN),
    magnus("cfm6-5", 6, "commutator-free Magnus, order 6", "3 A, 5 exp", ALVERMANN),
    magnus("cfm8-11", 8, "commutator-free Magnus, order 8", "4 A, 11 exp", ALVERMANN),
    magnus(
        "cayley-magnus4",
        4,
        "Magnus in Cayley coordinates, order 4",
        "2 A, 1 cay, 1 bracket, 1 triple product",
        "Iserles 2001",
    ),
    magnus(
        "cayley-magnus6",
        6,
        "Magnus in Cayley coordinates, order 6",
        "3 A, 1 cay, 5 brackets, 5 triple products",
        "Iserles 2001",
    ),
];

const QUADRATIC: &str = "quadratic invariants, time symmetry";
const ZANNA: &str = "Zanna, Engø & Munthe-Kaas 2001";
const GAUSS: &str = "Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3";

/// Implicit methods for problems whose points have a norm: `with_implicit_method`.
pub const IMPLICIT_METHODS: &[MethodInfo] = &[
    plain(
        RUNGE_KUTTA,
        "midpoint-implicit",
        Some(2),
        "the implicit midpoint rule on the entries of the state",
        [QUADRATIC, "5–20 F", GAUSS],
    ),
    plain(
        RUNGE_KUTTA,
        "gauss4",
        Some(4),
        "Gauss collocation of two stages on the entries of the state",
        [QUADRATIC, "5–20 × 2 F", GAUSS],
    ),
    plain(
        RUNGE_KUTTA,
        "gauss6",
        Some(6),
        "Gauss collocation of three stages on the entries of the state",
        [QUADRATIC, "5–20 × 3 F", GAUSS],
    ),
    rkmk_gauss("rkmk-gauss2", 2, "5–20 × (f, Ψ, dΨ⁻¹)"),
    rkmk_gauss("rkmk-gauss4", 4, "5–20 × (2 f, 2 Ψ, 2 dΨ⁻¹)"),
    rkmk_gauss("rkmk-gauss6", 6, "5–20 × (3 f, 3 Ψ, 3 dΨ⁻¹)"),
    rkmk_gauss_symmetric("rkmk-gauss2-symmetric", 2, "5–20 × (f, 2 Ψ, dΨ⁻¹)"),
    rkmk_gauss_symmetric("rkmk-gauss4-symmetric", 4, "5–20 × (2 f, 3 Ψ, 2 dΨ⁻¹)"),
    rkmk_gauss_symmetric("rkmk-gauss6-symmetric", 6, "5–20 × (3 f, 4 Ψ, 3 dΨ⁻¹)"),
];

const fn rkmk_gauss(name: &'static str, order: usize, cost: &'static str) -> MethodInfo {
    let summary = "implicit Runge–Kutta–Munthe-Kaas on a Gauss tableau";
    in_coordinates(plain(RKMK, name, Some(order), summary, [KEEPS_GROUP, cost, ZANNA]))
}

const fn rkmk_gauss_symmetric(name: &'static str, order: usize, cost: &'static str) -> MethodInfo {
    let summary = "the same with its chart in the middle of the step; exp or cay";
    let keeps = "group, Casimirs, time symmetry";
    in_coordinates(plain(RKMK, name, Some(order), summary, [keeps, cost, ZANNA]))
}

const fn energy_casimir(
    name: &'static str,
    order: usize,
    summary: &'static str,
    cost: &'static str,
) -> MethodInfo {
    let keeps = "energy, Casimirs, time symmetry";
    let source = "after Simo & Wong 1991; Lewis & Simo 1994";
    in_coordinates(plain(LIE_POISSON, name, Some(order), summary, [keeps, cost, source]))
}

/// Methods for Lie–Poisson systems: `with_euler_method`, `with_momentum_method`,
/// `with_lie_poisson_method`, `with_fluid_method`.
pub const LIE_POISSON_METHODS: &[MethodInfo] = &[
    energy_casimir(
        "energy-casimir",
        2,
        "discrete gradient in the algebra and coadjoint action; exp or cay",
        "5–20 × (∇H, Ψ, Λ)",
    ),
    energy_casimir(
        "energy-casimir4",
        4,
        "energy-casimir composed by Suzuki's fractal; exp or cay",
        "5 energy-casimir",
    ),
    energy_casimir(
        "energy-casimir6",
        6,
        "energy-casimir composed by nine stages; exp or cay",
        "9 energy-casimir",
    ),
];

const fn isospectral(
    name: &'static str,
    order: usize,
    summary: &'static str,
    cost: &'static str,
) -> MethodInfo {
    let keeps = "Casimirs, symplectic structure, time symmetry";
    plain(LIE_POISSON, name, Some(order), summary, [keeps, cost, "Modin & Viviani 2020"])
}

/// Methods for isospectral systems on matrices: `with_lie_poisson_method`, `with_fluid_method`.
pub const ISOSPECTRAL_METHODS: &[MethodInfo] = &[
    isospectral("isospectral2", 2, "isospectral Gauss of one stage", "8–25 × 3 products"),
    isospectral("isospectral4", 4, "isospectral Gauss of two stages", "8–25 × 6 products"),
    isospectral("isospectral6", 6, "isospectral Gauss of three stages", "8–25 × 9 products"),
    isospectral(
        "isospectral-suzuki4",
        4,
        "isospectral2 composed by Suzuki's fractal",
        "5 isospectral2",
    ),
    isospectral(
        "isospectral-kahan-li6",
        6,
        "isospectral2 composed by nine stages",
        "9 isospectral2",
    ),
];
