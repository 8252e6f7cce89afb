//! The methods for the free rigid body in ℝ³, for fields with Taylor coefficients, and for states that hold an
//! attitude.

use super::{
    DISCRETE, GAUSS, KEEPS_GROUP, KUTTA, LINEAR_ONLY, MOMENTUM, PROJECTED, RUNGE_KUTTA, SERIES,
    SPLITTING, of_a_tableau, plain,
};
use crate::catalog::MethodInfo;

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
    taylor("taylor5", 5, "225 multiplications in ℝ³; 30 products"),
    taylor("taylor6", 6, "315 multiplications in ℝ³; 42 products"),
    taylor("taylor7", 7, "420 multiplications in ℝ³; 56 products"),
    taylor("taylor8", 8, "540 multiplications in ℝ³; 72 products"),
    taylor("taylor9", 9, "675 multiplications in ℝ³; 90 products"),
    taylor("taylor10", 10, "825 multiplications in ℝ³; 110 products"),
    taylor("taylor11", 11, "990 multiplications in ℝ³; 132 products"),
    taylor("taylor12", 12, "1170 multiplications in ℝ³; 156 products"),
    taylor("taylor13", 13, "1365 multiplications in ℝ³; 182 products"),
    taylor("taylor14", 14, "1575 multiplications in ℝ³; 210 products"),
    taylor("taylor15", 15, "1800 multiplications in ℝ³; 240 products"),
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
