//! The methods, list by list: what each is, promises, costs and where it comes from.

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

const SPLIT: &str = "group, Casimirs, symplectic structure, time symmetry";
const ALL_FIRST: &str = "energy, group, Casimirs, time symmetry";
const MCLACHLAN: &str = "McLachlan 1993; Reich 1996";
const NEWTON: &str = "3–6 Newton iterations, 1 Ψ";

const fn dmv(name: &'static str, order: usize, summary: &'static str) -> MethodInfo {
    const SOURCE: &str = "Moser & Veselov 1991; McLachlan & Zanna 2005; Hairer & Vilmart 2006";
    plain(DISCRETE, name, Some(order), summary, [ALL_FIRST, NEWTON, SOURCE])
}

const fn mr2(name: &'static str) -> MethodInfo {
    let summary = "McLachlan–Reich splitting, the axes in this order (123 if none is named)";
    plain(SPLITTING, name, Some(2), summary, [SPLIT, "5 axis rotations", MCLACHLAN])
}

const fn mr4(name: &'static str) -> MethodInfo {
    let summary =
        "McLachlan–Reich by the triple jump, the axes in this order (123 if none is named)";
    plain(SPLITTING, name, Some(4), summary, [SPLIT, "13 axis rotations", MCLACHLAN])
}

/// Methods for the free rigid body in ℝ³: `with_body_method`.
pub const BODY_METHODS: &[MethodInfo] = &[
    mr2("mr2"),
    mr2("mr2-132"),
    mr2("mr2-213"),
    mr2("mr2-231"),
    mr2("mr2-312"),
    mr2("mr2-321"),
    mr4("mr4"),
    mr4("mr4-132"),
    mr4("mr4-213"),
    mr4("mr4-231"),
    mr4("mr4-312"),
    mr4("mr4-321"),
    plain(
        SPLITTING,
        "mr4-suzuki",
        Some(4),
        "McLachlan–Reich composed by Suzuki's fractal",
        [SPLIT, "21 axis rotations", "McLachlan 1993; Suzuki 1990"],
    ),
    plain(
        SPLITTING,
        "mr6",
        Some(6),
        "McLachlan–Reich composed by nine stages",
        [SPLIT, "37 axis rotations", "McLachlan 1993; Kahan & Li 1997"],
    ),
    plain(
        SPLITTING,
        "mr8",
        Some(8),
        "McLachlan–Reich composed by seventeen stages",
        [SPLIT, "69 axis rotations", "McLachlan 1993; Kahan & Li 1997"],
    ),
    plain(
        SPLITTING,
        "mr10",
        Some(10),
        "McLachlan–Reich composed by thirty-five stages",
        [SPLIT, "141 axis rotations", "McLachlan 1993; Sofroniou & Spaletta 2005"],
    ),
    plain(
        MOMENTUM,
        "simo-wong",
        Some(2),
        "Simo and Wong's implicit method, increment exp(ζ)",
        [ALL_FIRST, NEWTON, "Simo & Wong 1991"],
    ),
    plain(
        MOMENTUM,
        "simo-wong-k1",
        Some(2),
        "Simo and Wong's implicit method with k = 1: the midpoint rule in cay",
        [ALL_FIRST, NEWTON, "Austin, Krishnaprasad & Wang 1993"],
    ),
    plain(
        MOMENTUM,
        "lewis-simo",
        None,
        "the same with the k that makes the momentum of order 4 (the attitude stays at 2)",
        [ALL_FIRST, NEWTON, "Lewis & Simo 1994"],
    ),
    plain(
        MOMENTUM,
        "simo-wong4",
        Some(4),
        "Simo and Wong's method composed by Suzuki's fractal",
        [ALL_FIRST, "5 simo-wong", "Simo & Wong 1991; Suzuki 1990"],
    ),
    plain(
        MOMENTUM,
        "simo-wong6",
        Some(6),
        "Simo and Wong's method composed by nine stages",
        [ALL_FIRST, "9 simo-wong", "Simo & Wong 1991; Kahan & Li 1997"],
    ),
    plain(
        SERIES,
        "buss4",
        Some(4),
        "Buss's augmented Taylor method",
        [KEEPS_GROUP, "9 ×, 4 K, 1 exp", "Buss 2000"],
    ),
    dmv("dmv2", 2, "discrete Moser–Veselov"),
    dmv("dmv4", 4, "discrete Moser–Veselov, preprocessed to order 4"),
    dmv("dmv6", 6, "discrete Moser–Veselov, preprocessed to order 6"),
    dmv("dmv8", 8, "discrete Moser–Veselov, preprocessed to order 8"),
    dmv("dmv10", 10, "discrete Moser–Veselov, preprocessed to order 10"),
    plain(
        "exact",
        "exact",
        None,
        "the exact motion by elliptic functions, any step",
        ["everything", "1–2 µs whatever the step", "Jacobi 1850"],
    ),
];

const fn taylor(name: &'static str, order: usize, cost: &'static str) -> MethodInfo {
    let summary = "Lie series: derivatives by recurrence, the flow taken to the group";
    plain(SERIES, name, Some(order), summary, [KEEPS_GROUP, cost, "Gröbner 1960"])
}

/// Methods for fields with Taylor coefficients by recurrence: `with_series_method`, and the free
/// rigid body in ℝ³.
pub const SERIES_METHODS: &[MethodInfo] = &[
    taylor("taylor4", 4, "150 multiplications in ℝ³; 20 products"),
    taylor("taylor6", 6, "315 multiplications in ℝ³; 42 products"),
    taylor("taylor8", 8, "540 multiplications in ℝ³; 72 products"),
    taylor("taylor10", 10, "825 multiplications in ℝ³; 110 products"),
    taylor("taylor12", 12, "1170 multiplications in ℝ³; 156 products"),
    taylor("taylor14", 14, "1575 multiplications in ℝ³; 210 products"),
    taylor("taylor16", 16, "2040 multiplications in ℝ³; 272 products"),
];

const NEAREST: &str = "Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.4";

/// Methods for a state that holds an attitude: `with_attitude_method`.
pub const ATTITUDE_METHODS: &[MethodInfo] = &[
    plain(
        PROJECTED,
        "rk4-qr",
        Some(4),
        "classical Runge–Kutta on the entries, then the factor Q of g = QR",
        ["group", "4 F, 2 Gram–Schmidt", NEAREST],
    ),
    of_a_tableau(plain(
        PROJECTED,
        "rk-qr",
        None,
        "explicit Runge–Kutta with any tableau on the entries, then the factor Q of g = QR",
        ["group", "s F, 2 Gram–Schmidt", NEAREST],
    )),
    plain(
        PROJECTED,
        "rk4-polar",
        Some(4),
        "classical Runge–Kutta on the entries, then the polar factor of g",
        ["group", "4 F, 2–3 Newton–Schulz", NEAREST],
    ),
    of_a_tableau(plain(
        PROJECTED,
        "rk-polar",
        None,
        "explicit Runge–Kutta with any tableau on the entries, then the polar factor of g",
        ["group", "s F, 2–3 Newton–Schulz", NEAREST],
    )),
];

const ALL_QUADRATIC: &str = "energy, group, Casimirs, quadratic invariants, time symmetry";

/// Classical methods on the momentum and the entries of the attitude as one state: `with_state_method`.
pub const STATE_METHODS: &[MethodInfo] = &[
    plain(
        RUNGE_KUTTA,
        "rk4-mg",
        Some(4),
        "classical Runge–Kutta on (m, g), the momentum and the entries of the attitude as one state",
        [LINEAR_ONLY, "4 F", KUTTA],
    ),
    of_a_tableau(plain(
        RUNGE_KUTTA,
        "rk-mg",
        None,
        "explicit Runge–Kutta with any tableau on (m, g)",
        [LINEAR_ONLY, "s F", KUTTA],
    )),
    plain(
        RUNGE_KUTTA,
        "midpoint-implicit-mg",
        Some(2),
        "the implicit midpoint rule on (m, g), where everything that the body keeps is quadratic",
        [ALL_QUADRATIC, "5–20 F", GAUSS],
    ),
    plain(
        RUNGE_KUTTA,
        "gauss4-mg",
        Some(4),
        "Gauss collocation of two stages on (m, g)",
        [ALL_QUADRATIC, "5–20 × 2 F", GAUSS],
    ),
    plain(
        RUNGE_KUTTA,
        "gauss6-mg",
        Some(6),
        "Gauss collocation of three stages on (m, g)",
        [ALL_QUADRATIC, "5–20 × 3 F", GAUSS],
    ),
];

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
