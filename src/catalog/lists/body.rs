//! The methods for the free rigid body in ℝ³, for fields with Taylor coefficients, and for states that hold an
//! attitude.

use super::{Energy, GAUSS, KEEPS_GROUP, KUTTA, LINEAR_ONLY, gauss, of_a_tableau, plain, stages};
use crate::catalog::facts::{
    Cost, Count, Family, MethodInfo, Needs, Operation, Order, OtherCase, Property, WorkItem, times,
};
use crate::catalog::recipe::{GaussTableau, Recipe};
use crate::methods::{
    DMV2, DMV4, DMV6, DMV8, DMV10, Dmv, GAUSS2, GAUSS4, GAUSS6, KAHAN_LI6, KAHAN_LI8,
    SOFRONIOU_SPALETTA10, STRANG, SUZUKI4, Scheme, SimoWong, Splitting, YOSHIDA4,
};
use crate::problems::Projection;
use Operation::{
    AmbientField, AxisRotation, CrossProduct, Exp, GramSchmidt, InverseInertia, Multiplication,
    NewtonIteration, NewtonSchulz, Orbit, Product, Psi, SimoWongStep,
};
use Property::{Casimirs, Everything, Group, QuadraticInvariants, Symplectic, TimeSymmetry};

const SPLIT: &[Property] = &[Group, Casimirs, Symplectic, TimeSymmetry];
const ALL_FIRST: &[Property] = &[Energy, Group, Casimirs, TimeSymmetry];
const ALL_OF_DMV2: &[Property] = &[Energy, Group, Casimirs, Symplectic, TimeSymmetry];
const MCLACHLAN: &str = "McLachlan 1993; Reich 1996";
const NEWTON: Cost = Cost::of(&[
    WorkItem { count: Count::Between(3, 6), operation: NewtonIteration },
    times(1, Psi),
]);

const fn dmv(name: &'static str, summary: &'static str, method: Dmv) -> MethodInfo {
    const SOURCE: &str = "Moser & Veselov 1991; McLachlan & Zanna 2005; Hairer & Vilmart 2006";
    let family = (Family::DiscreteMechanics, Needs::Body);
    let keeps = if method.order() == 2 { ALL_OF_DMV2 } else { ALL_FIRST };
    plain(family, name, method.order(), summary, keeps, NEWTON, SOURCE, Recipe::Dmv(method))
}

/// A splitting by the axes in this order.
const fn splitting(
    name: &'static str,
    axes: [usize; 3],
    scheme: Scheme,
    summary: &'static str,
    rotations: &'static [WorkItem],
    source: &'static str,
) -> MethodInfo {
    let (family, cost) = ((Family::Splitting, Needs::Body), Cost::of(rotations));
    let recipe = Recipe::Splitting(Splitting::new(axes, scheme));
    plain(family, name, scheme.order, summary, SPLIT, cost, source, recipe)
}

const fn mr2(name: &'static str, axes: [usize; 3]) -> MethodInfo {
    let summary = "McLachlan–Reich splitting, the axes in this order (123 if none is named)";
    splitting(name, axes, STRANG, summary, &const { [times(5, AxisRotation)] }, MCLACHLAN)
}

const fn mr4(name: &'static str, axes: [usize; 3]) -> MethodInfo {
    let summary =
        "McLachlan–Reich by the triple jump, the axes in this order (123 if none is named)";
    splitting(name, axes, YOSHIDA4, summary, &const { [times(13, AxisRotation)] }, MCLACHLAN)
}

const fn simo_wong(
    name: &'static str,
    order: usize,
    summary: &'static str,
    cost: Cost,
    source: &'static str,
    recipe: Recipe,
) -> MethodInfo {
    let family = (Family::EnergyMomentum, Needs::Body);
    plain(family, name, order, summary, ALL_FIRST, cost, source, recipe)
}

/// For the free rigid body in ℝ³.
pub(super) const BODY: &[MethodInfo] = &[
    mr2("mr2", [0, 1, 2]),
    mr2("mr2-132", [0, 2, 1]),
    mr2("mr2-213", [1, 0, 2]),
    mr2("mr2-231", [1, 2, 0]),
    mr2("mr2-312", [2, 0, 1]),
    mr2("mr2-321", [2, 1, 0]),
    mr4("mr4", [0, 1, 2]),
    mr4("mr4-132", [0, 2, 1]),
    mr4("mr4-213", [1, 0, 2]),
    mr4("mr4-231", [1, 2, 0]),
    mr4("mr4-312", [2, 0, 1]),
    mr4("mr4-321", [2, 1, 0]),
    splitting(
        "mr4-suzuki",
        [0, 1, 2],
        SUZUKI4,
        "McLachlan–Reich composed by Suzuki's fractal",
        &[times(21, AxisRotation)],
        "McLachlan 1993; Suzuki 1990",
    ),
    splitting(
        "mr6",
        [0, 1, 2],
        KAHAN_LI6,
        "McLachlan–Reich composed by nine stages",
        &[times(37, AxisRotation)],
        "McLachlan 1993; Kahan & Li 1997",
    ),
    splitting(
        "mr8",
        [0, 1, 2],
        KAHAN_LI8,
        "McLachlan–Reich composed by seventeen stages",
        &[times(69, AxisRotation)],
        "McLachlan 1993; Kahan & Li 1997",
    ),
    splitting(
        "mr10",
        [0, 1, 2],
        SOFRONIOU_SPALETTA10,
        "McLachlan–Reich composed by thirty-five stages",
        &[times(141, AxisRotation)],
        "McLachlan 1993; Sofroniou & Spaletta 2005",
    ),
    simo_wong(
        "simo-wong",
        2,
        "Simo and Wong's implicit method, increment exp(ζ)",
        NEWTON,
        "Simo & Wong 1991",
        Recipe::SimoWong(SimoWong::TAN),
    ),
    simo_wong(
        "simo-wong-k1",
        2,
        "Simo and Wong's implicit method with k = 1: the midpoint rule in cay",
        NEWTON,
        "Austin, Krishnaprasad & Wang 1993",
        Recipe::SimoWong(SimoWong::ONE),
    ),
    MethodInfo {
        order: Order::MomentumAndAttitude(4, 2),
        ..simo_wong(
            "lewis-simo",
            0,
            "Simo and Wong's implicit method with the k that makes the momentum of order 4 (the attitude stays at 2)",
            NEWTON,
            "Lewis & Simo 1994",
            Recipe::SimoWong(SimoWong::LEWIS_SIMO),
        )
    },
    simo_wong(
        "simo-wong4",
        4,
        "Simo and Wong's method composed by Suzuki's fractal",
        Cost::of(&[times(5, SimoWongStep)]),
        "Simo & Wong 1991; Suzuki 1990",
        Recipe::ComposedSimoWong(SUZUKI4),
    ),
    simo_wong(
        "simo-wong6",
        6,
        "Simo and Wong's method composed by nine stages",
        Cost::of(&[times(9, SimoWongStep)]),
        "Simo & Wong 1991; Kahan & Li 1997",
        Recipe::ComposedSimoWong(KAHAN_LI6),
    ),
    plain(
        (Family::LieSeries, Needs::Body),
        "buss4",
        4,
        "Buss's augmented Taylor method",
        KEEPS_GROUP,
        Cost::of(&[times(9, CrossProduct), times(4, InverseInertia), times(1, Exp)]),
        "Buss 2000",
        Recipe::Buss,
    ),
    dmv("dmv2", "discrete Moser–Veselov", DMV2),
    dmv("dmv4", "discrete Moser–Veselov, preprocessed to order 4", DMV4),
    dmv("dmv6", "discrete Moser–Veselov, preprocessed to order 6", DMV6),
    dmv("dmv8", "discrete Moser–Veselov, preprocessed to order 8", DMV8),
    dmv("dmv10", "discrete Moser–Veselov, preprocessed to order 10", DMV10),
    MethodInfo {
        order: Order::Exact,
        ..plain(
            (Family::Exact, Needs::Body),
            "exact",
            0,
            "the exact motion by elliptic functions, any step",
            &[Everything],
            Cost::of(&[times(1, Orbit)]),
            "Jacobi 1850",
            Recipe::Exact,
        )
    },
];

/// 15 p (p + 1)/2 multiplications for a vector, p (p − 1) products of matrices.
const fn taylor_work(p: u32) -> [WorkItem; 2] {
    [times(15 * p * (p + 1) / 2, Multiplication), times(p * (p - 1), Product)]
}

const fn taylor(
    name: &'static str,
    [vectors, matrices]: &'static [WorkItem; 2],
    order: usize,
) -> MethodInfo {
    plain(
        (Family::LieSeries, Needs::Series),
        name,
        order,
        "Lie series: derivatives by recurrence, the flow taken to the group",
        KEEPS_GROUP,
        Cost {
            other_case: OtherCase::OnMatrices(core::slice::from_ref(matrices)),
            ..Cost::of(core::slice::from_ref(vectors))
        },
        "Gröbner 1960",
        Recipe::Series(order),
    )
}

macro_rules! taylor {
    ($($name:literal $order:literal,)*) => {
        /// For fields with Taylor coefficients, and the free rigid body in ℝ³.
        pub(super) const SERIES: &[MethodInfo] = &[
            $(taylor($name, &const { taylor_work($order) }, $order),)*
        ];
    };
}
taylor! {
    "taylor4" 4,
    "taylor5" 5,
    "taylor6" 6,
    "taylor7" 7,
    "taylor8" 8,
    "taylor9" 9,
    "taylor10" 10,
    "taylor11" 11,
    "taylor12" 12,
    "taylor13" 13,
    "taylor14" 14,
    "taylor15" 15,
    "taylor16" 16,
}

const fn taylor_momentum(
    name: &'static str,
    work: &'static [WorkItem],
    order: usize,
) -> MethodInfo {
    const SOURCE: &str = "Jorba & Zou 2005; Hairer, Lubich, Wanner IV.4";
    let summary = "Taylor series of the momentum, brought back to its sphere";
    let (family, cost) = ((Family::Projection, Needs::Momentum), Cost::of(work));
    let recipe = Recipe::MomentumSeries(order);
    plain(family, name, order, summary, &[Casimirs], cost, SOURCE, recipe)
}

/// 3 p (p + 1)/2 multiplications.
const fn momentum_work(p: u32) -> [WorkItem; 1] {
    [times(3 * p * (p + 1) / 2, Multiplication)]
}

/// For the momentum of the free rigid body in ℝ³.
pub(super) const MOMENTUM: &[MethodInfo] = &[
    taylor_momentum("taylor12-m", &const { momentum_work(12) }, 12),
    taylor_momentum("taylor16-m", &const { momentum_work(16) }, 16),
];

const fn projected(
    name: &'static str,
    summary: &'static str,
    work: &'static [WorkItem],
    how: Projection,
) -> MethodInfo {
    const NEAREST: &str = "Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.4";
    let (family, cost) = ((Family::Projection, Needs::Attitude), Cost::of(work));
    plain(family, name, 4, summary, &[Group], cost, NEAREST, Recipe::ProjectionMethod(how))
}

const SCHULZ: WorkItem = WorkItem { count: Count::Between(2, 3), operation: NewtonSchulz };

/// For a state that holds an attitude.
pub(super) const ATTITUDE: &[MethodInfo] = &[
    projected(
        "rk4-qr",
        "classical Runge–Kutta on the entries, then the factor Q of g = QR",
        &[times(4, AmbientField), times(2, GramSchmidt)],
        Projection::Qr,
    ),
    of_a_tableau(projected(
        "rk-qr",
        "explicit Runge–Kutta with any tableau on the entries, then the factor Q of g = QR",
        &[stages(AmbientField), times(2, GramSchmidt)],
        Projection::Qr,
    )),
    projected(
        "rk4-polar",
        "classical Runge–Kutta on the entries, then the polar factor of g",
        &[times(4, AmbientField), SCHULZ],
        Projection::Polar,
    ),
    of_a_tableau(projected(
        "rk-polar",
        "explicit Runge–Kutta with any tableau on the entries, then the polar factor of g",
        &[stages(AmbientField), SCHULZ],
        Projection::Polar,
    )),
];

/// Every invariant of a body is quadratic in (m, g).
const fn gauss_mg(
    name: &'static str,
    summary: &'static str,
    work: &'static [WorkItem],
    table: GaussTableau,
) -> MethodInfo {
    const ALL: &[Property] = &[Energy, Group, Casimirs, QuadraticInvariants, TimeSymmetry];
    let info = gauss(name, summary, work, table);
    MethodInfo { preserves: ALL, needs: Needs::State, source: GAUSS, ..info }
}

/// Classical methods on the momentum and the entries of the attitude as one state.
pub(super) const STATE: &[MethodInfo] = &[
    plain(
        (Family::RungeKutta, Needs::State),
        "rk4-mg",
        4,
        "classical Runge–Kutta on (m, g), the momentum and the entries of the attitude as one state",
        LINEAR_ONLY,
        Cost::of(&[times(4, AmbientField)]),
        KUTTA,
        Recipe::Rk,
    ),
    of_a_tableau(plain(
        (Family::RungeKutta, Needs::State),
        "rk-mg",
        0,
        "explicit Runge–Kutta with any tableau on (m, g)",
        LINEAR_ONLY,
        Cost::of(&[stages(AmbientField)]),
        KUTTA,
        Recipe::Rk,
    )),
    gauss_mg(
        "midpoint-implicit-mg",
        "the implicit midpoint rule on (m, g), where everything that the body keeps is quadratic",
        &[times(1, AmbientField)],
        GAUSS2.resized(),
    ),
    gauss_mg(
        "gauss4-mg",
        "Gauss collocation of two stages on (m, g)",
        &[times(2, AmbientField)],
        GAUSS4.resized(),
    ),
    gauss_mg(
        "gauss6-mg",
        "Gauss collocation of three stages on (m, g)",
        &[times(3, AmbientField)],
        GAUSS6.resized(),
    ),
];
