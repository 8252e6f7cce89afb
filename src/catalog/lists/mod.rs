//! The methods, list by list: what each is, promises, costs and where it comes from.

mod body;
mod magnus;

use super::facts::{
    Cost, Count, Family, Maps, MethodInfo, Needs, Operation, Order, OtherCase, Property, WorkItem,
    times,
};
use super::recipe::{GaussTableau, Recipe};
use crate::methods::commutator_free::{CF43, cf3, cf4};
use crate::methods::crouch_grossman::{CG4, cg2, cg3};
use crate::methods::low_storage::{EES25, EES27, LS3, LS3_BP, LS4, LS5, LS32};
use crate::methods::one_bracket::{MAGNUS43, RKMK4_2C};
use crate::methods::{GAUSS2, GAUSS4, GAUSS6, KAHAN_LI6, SUZUKI4};
use Operation::{
    Act, AmbientField, Bracket, DpsiInv, EnergyCasimirStep, Exp, Field, Gradient, IsospectralStep,
    Product, Psi,
};
use Property::{
    Casimirs, Energy, Group, LinearInvariants, QuadraticInvariants, Symplectic, TimeSymmetry,
};

impl Needs {
    /// The methods that need this, and nothing more.
    pub const fn methods(self) -> &'static [MethodInfo] {
        match self {
            Needs::Field => FIELD,
            Needs::LinearType => magnus::LINEAR_TYPE,
            Needs::Norm => NORM,
            Needs::Series => body::SERIES,
            Needs::Body => body::BODY,
            Needs::Momentum => body::MOMENTUM,
            Needs::Attitude => body::ATTITUDE,
            Needs::State => body::STATE,
            Needs::LiePoisson => LIE_POISSON,
            Needs::Isospectral => ISOSPECTRAL,
        }
    }
}

/// Every method that some problem can ask for.
///
/// ```
/// use lieflow::catalog::{Needs, all_methods};
/// let body_in_space = [Needs::Field, Needs::Norm, Needs::Body, Needs::Attitude];
/// let fitting: Vec<_> =
///     all_methods().filter(|m| body_in_space.contains(&m.needs)).map(|m| m.name).collect();
/// assert!(fitting.contains(&"rkmk4") && fitting.contains(&"dmv10"));
/// assert!(!fitting.contains(&"magnus4"));
/// ```
pub fn all_methods() -> impl Iterator<Item = &'static MethodInfo> {
    Needs::ALL.into_iter().flat_map(Needs::methods)
}

/// A method without map and tableau.
const fn plain(
    (family, needs): (Family, Needs),
    name: &'static str,
    order: usize,
    summary: &'static str,
    preserves: &'static [Property],
    cost: Cost,
    source: &'static str,
    recipe: Recipe,
) -> MethodInfo {
    MethodInfo {
        family,
        name,
        summary,
        order: Order::Of(order),
        maps: Maps::None,
        takes_tableau: false,
        preserves,
        cost,
        source,
        needs,
        recipe,
    }
}

/// The method in coordinates that are chosen.
const fn in_coordinates(info: MethodInfo, maps: Maps) -> MethodInfo {
    MethodInfo { maps, ..info }
}

/// The method with a tableau that is chosen.
const fn of_a_tableau(info: MethodInfo) -> MethodInfo {
    MethodInfo { takes_tableau: true, order: Order::Tableau, ..info }
}

/// An operation that is done as often as the tableau has stages.
const fn stages(operation: Operation) -> WorkItem {
    WorkItem { count: Count::Stages, operation }
}

const KEEPS_GROUP: &[Property] = &[Group, Casimirs];
const GROUP_AND_TIME: &[Property] = &[Group, Casimirs, TimeSymmetry];
const LINEAR_ONLY: &[Property] = &[LinearInvariants];
const MUNTHE_KAAS: &str = "Munthe-Kaas 1999; Celledoni & Owren, Table 1";
const KUTTA: &str = "Hairer, Nørsett, Wanner I, p. 138";
const CMO: &str = "Celledoni, Marthinsen, Owren 2003";
const BAZAVOV: &str = "Bazavov 2022";
const EES: &str = "Shmelev, Thompson, Salvi 2025";

/// An explicit method in exp for any field.
const fn in_exp(
    family: Family,
    name: &'static str,
    order: usize,
    summary: &'static str,
    work: &'static [WorkItem],
    source: &'static str,
    recipe: Recipe,
) -> MethodInfo {
    plain((family, Needs::Field), name, order, summary, KEEPS_GROUP, Cost::of(work), source, recipe)
}

const CF: Family = Family::CommutatorFree;

/// For every problem.
const FIELD: &[MethodInfo] = &[
    in_coordinates(
        plain(
            (Family::Rkmk, Needs::Field),
            "rkmk4",
            4,
            "Runge–Kutta–Munthe-Kaas with the classical tableau",
            KEEPS_GROUP,
            Cost::of(&[times(4, Field), times(4, Psi), times(3, DpsiInv)]),
            MUNTHE_KAAS,
            Recipe::Rkmk,
        ),
        Maps::All,
    ),
    of_a_tableau(in_coordinates(
        plain(
            (Family::Rkmk, Needs::Field),
            "rkmk",
            0,
            "Runge–Kutta–Munthe-Kaas with any explicit tableau",
            KEEPS_GROUP,
            Cost::of(&[
                stages(Field),
                stages(Psi),
                WorkItem { count: Count::StagesLessOne, operation: DpsiInv },
            ]),
            MUNTHE_KAAS,
            Recipe::Rkmk,
        ),
        Maps::All,
    )),
    plain(
        (Family::RungeKutta, Needs::Field),
        "rk4",
        4,
        "classical Runge–Kutta on the entries of the state",
        LINEAR_ONLY,
        Cost::of(&[times(4, AmbientField)]),
        KUTTA,
        Recipe::Rk,
    ),
    of_a_tableau(plain(
        (Family::RungeKutta, Needs::Field),
        "rk",
        0,
        "explicit Runge–Kutta with any tableau on the entries of the state",
        LINEAR_ONLY,
        Cost::of(&[stages(AmbientField)]),
        KUTTA,
        Recipe::Rk,
    )),
    in_exp(
        Family::Rkmk,
        "rkmk4-2c",
        4,
        "RKMK of order 4 with two commutators",
        &[times(4, Field), times(4, Exp), times(2, Bracket)],
        "Munthe-Kaas, Owren 1999",
        Recipe::OneBracket(RKMK4_2C.padded()),
    ),
    plain(
        (Family::Magnus, Needs::Field),
        "magnus43",
        4,
        "Magnus method for nonlinear equations, pair 4(3)",
        KEEPS_GROUP,
        Cost {
            other_case: OtherCase::WithError(&[times(7, Field), times(9, Exp), times(3, Bracket)]),
            ..Cost::of(&[times(6, Field), times(6, Exp), times(3, Bracket)])
        },
        "Casas, Iserles 2006, with another estimate",
        Recipe::OneBracket(MAGNUS43),
    ),
    in_exp(
        CF,
        "cf3",
        3,
        "commutator-free, 3 stages",
        &[times(3, Field), times(3, Exp)],
        CMO,
        Recipe::CommutatorFree(cf3()),
    ),
    in_exp(
        CF,
        "cf4",
        4,
        "commutator-free, 4 stages",
        &[times(4, Field), times(5, Exp)],
        CMO,
        Recipe::CommutatorFree(cf4()),
    ),
    plain(
        (CF, Needs::Field),
        "cf43",
        4,
        "commutator-free pair 4(3)",
        KEEPS_GROUP,
        Cost {
            other_case: OtherCase::WithError(&[times(5, Field), times(8, Exp)]),
            ..Cost::of(&[times(4, Field), times(5, Exp)])
        },
        "Curry, Owren 2019",
        Recipe::CommutatorFree(CF43),
    ),
    low_storage("cf-ls3", 3, "commutator-free in low storage (Lüscher)", &SAME[0], LS3.padded()),
    low_storage(
        "cf-ls3-bp",
        3,
        "commutator-free in low storage (Bernardini, Pirozzoli)",
        &SAME[0],
        LS3_BP.padded(),
    ),
    plain(
        (CF, Needs::Field),
        "cf-ls32",
        3,
        "commutator-free in low storage, pair 3(2)",
        KEEPS_GROUP,
        Cost {
            other_case: OtherCase::WithError(&[times(5, Field), times(6, Exp)]),
            ..Cost::of(&SAME[2])
        },
        "Bazavov 2022, with another estimate",
        Recipe::LowStorage(LS32.padded()),
    ),
    low_storage(
        "cf-ls4",
        4,
        "commutator-free in low storage (Carpenter, Kennedy)",
        &SAME[2],
        LS4.padded(),
    ),
    low_storage("cf-ls5", 5, "commutator-free in low storage (Yan)", &SAME[3], LS5),
    MethodInfo {
        source: EES,
        ..low_storage("cf-ees25", 2, "order 2, reversible to order 5", &SAME[0], EES25.padded())
    },
    MethodInfo {
        source: EES,
        ..low_storage("cf-ees27", 2, "order 2, reversible to order 7", &SAME[1], EES27.padded())
    },
    in_exp(
        Family::CrouchGrossman,
        "cg2",
        2,
        "Crouch–Grossman, 2 stages",
        &[times(2, Field), times(2, Exp)],
        "Crouch, Grossman 1993",
        Recipe::CommutatorFree(cg2()),
    ),
    in_exp(
        Family::CrouchGrossman,
        "cg3",
        3,
        "Crouch–Grossman, 3 stages",
        &[times(3, Field), times(6, Exp)],
        "Owren, Marthinsen 1999",
        Recipe::CommutatorFree(cg3()),
    ),
    in_exp(
        Family::CrouchGrossman,
        "cg4",
        4,
        "Crouch–Grossman, 5 stages (CG4a)",
        &[times(5, Field), times(15, Exp)],
        "Jackiewicz, Marthinsen, Owren 2000",
        Recipe::CommutatorFree(CG4),
    ),
];

/// As many f as exp: 3, 4, 5 or 13.
const SAME: [[WorkItem; 2]; 4] = [
    [times(3, Field), times(3, Exp)],
    [times(4, Field), times(4, Exp)],
    [times(5, Field), times(5, Exp)],
    [times(13, Field), times(13, Exp)],
];

const fn low_storage(
    name: &'static str,
    order: usize,
    summary: &'static str,
    work: &'static [WorkItem],
    table: crate::methods::low_storage::TwoN<13>,
) -> MethodInfo {
    in_exp(CF, name, order, summary, work, BAZAVOV, Recipe::LowStorage(table))
}

const QUADRATIC: &[Property] = &[QuadraticInvariants, TimeSymmetry];
const ZANNA: &str = "Zanna, Engø & Munthe-Kaas 2001";
const GAUSS: &str = "Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3";
const ITERATIONS: (u32, u32) = (5, 20);

/// Implicit methods for problems whose points have a norm.
const NORM: &[MethodInfo] = &[
    gauss(
        "midpoint-implicit",
        "the implicit midpoint rule on the entries of the state",
        &[times(1, AmbientField)],
        GAUSS2.resized(),
    ),
    gauss(
        "gauss4",
        "Gauss collocation of two stages on the entries of the state",
        &[times(2, AmbientField)],
        GAUSS4.resized(),
    ),
    gauss(
        "gauss6",
        "Gauss collocation of three stages on the entries of the state",
        &[times(3, AmbientField)],
        GAUSS6.resized(),
    ),
    rkmk_gauss(
        "rkmk-gauss2",
        &[times(1, Field), times(1, Psi), times(1, DpsiInv)],
        GAUSS2.resized(),
    ),
    rkmk_gauss(
        "rkmk-gauss4",
        &[times(2, Field), times(2, Psi), times(2, DpsiInv)],
        GAUSS4.resized(),
    ),
    rkmk_gauss(
        "rkmk-gauss6",
        &[times(3, Field), times(3, Psi), times(3, DpsiInv)],
        GAUSS6.resized(),
    ),
    rkmk_gauss_symmetric(
        "rkmk-gauss2-symmetric",
        &[times(1, Field), times(2, Psi), times(1, DpsiInv)],
        GAUSS2.resized(),
    ),
    rkmk_gauss_symmetric(
        "rkmk-gauss4-symmetric",
        &[times(2, Field), times(3, Psi), times(2, DpsiInv)],
        GAUSS4.resized(),
    ),
    rkmk_gauss_symmetric(
        "rkmk-gauss6-symmetric",
        &[times(3, Field), times(4, Psi), times(3, DpsiInv)],
        GAUSS6.resized(),
    ),
];

/// A Gauss method on the entries.
const fn gauss(
    name: &'static str,
    summary: &'static str,
    work: &'static [WorkItem],
    table: GaussTableau,
) -> MethodInfo {
    let (family, cost) = ((Family::RungeKutta, Needs::Norm), Cost::iterated(ITERATIONS, work));
    plain(family, name, table.order, summary, QUADRATIC, cost, GAUSS, Recipe::Gauss(table))
}

const fn rkmk_gauss(
    name: &'static str,
    work: &'static [WorkItem],
    table: GaussTableau,
) -> MethodInfo {
    let summary = "implicit Runge–Kutta–Munthe-Kaas on a Gauss tableau";
    let (family, cost) = ((Family::Rkmk, Needs::Norm), Cost::iterated(ITERATIONS, work));
    let recipe = Recipe::RkmkGauss(table);
    in_coordinates(
        plain(family, name, table.order, summary, KEEPS_GROUP, cost, ZANNA, recipe),
        Maps::All,
    )
}

const fn rkmk_gauss_symmetric(
    name: &'static str,
    work: &'static [WorkItem],
    table: GaussTableau,
) -> MethodInfo {
    let summary = "the same with its chart in the middle of the step; exp or cay";
    MethodInfo {
        summary,
        maps: Maps::Odd,
        preserves: GROUP_AND_TIME,
        recipe: Recipe::RkmkGaussSymmetric(table),
        ..rkmk_gauss(name, work, table)
    }
}

const fn energy_casimir(
    name: &'static str,
    order: usize,
    summary: &'static str,
    cost: Cost,
    recipe: Recipe,
) -> MethodInfo {
    let (keeps, source): (&[_], _) =
        (&[Energy, Casimirs, TimeSymmetry], "after Simo & Wong 1991; Lewis & Simo 1994");
    let family = (Family::LiePoisson, Needs::LiePoisson);
    in_coordinates(plain(family, name, order, summary, keeps, cost, source, recipe), Maps::Odd)
}

/// For Lie–Poisson systems.
const LIE_POISSON: &[MethodInfo] = &[
    energy_casimir(
        "energy-casimir",
        2,
        "discrete gradient in the algebra and coadjoint action; exp or cay",
        Cost::iterated(ITERATIONS, &[times(1, Gradient), times(1, Psi), times(1, Act)]),
        Recipe::EnergyCasimir,
    ),
    energy_casimir(
        "energy-casimir4",
        4,
        "energy-casimir composed by Suzuki's fractal; exp or cay",
        Cost::of(&[times(5, EnergyCasimirStep)]),
        Recipe::ComposedEnergyCasimir(SUZUKI4),
    ),
    energy_casimir(
        "energy-casimir6",
        6,
        "energy-casimir composed by nine stages; exp or cay",
        Cost::of(&[times(9, EnergyCasimirStep)]),
        Recipe::ComposedEnergyCasimir(KAHAN_LI6),
    ),
];

const fn isospectral(
    name: &'static str,
    order: usize,
    summary: &'static str,
    cost: Cost,
    recipe: Recipe,
) -> MethodInfo {
    let family = (Family::LiePoisson, Needs::Isospectral);
    let keeps: &[_] = &[Casimirs, Symplectic, TimeSymmetry];
    plain(family, name, order, summary, keeps, cost, "Modin & Viviani 2020", recipe)
}

/// For isospectral systems on matrices.
const ISOSPECTRAL: &[MethodInfo] = &[
    isospectral(
        "isospectral2",
        2,
        "isospectral Gauss of one stage",
        Cost::iterated((8, 25), &[times(3, Product)]),
        Recipe::Isospectral2,
    ),
    isospectral(
        "isospectral4",
        4,
        "isospectral Gauss of two stages",
        Cost::iterated((8, 25), &[times(6, Product)]),
        Recipe::Isospectral4,
    ),
    isospectral(
        "isospectral6",
        6,
        "isospectral Gauss of three stages",
        Cost::iterated((8, 25), &[times(9, Product)]),
        Recipe::Isospectral6,
    ),
    isospectral(
        "isospectral-suzuki4",
        4,
        "isospectral2 composed by Suzuki's fractal",
        Cost::of(&[times(5, IsospectralStep)]),
        Recipe::ComposedIsospectral(SUZUKI4),
    ),
    isospectral(
        "isospectral-kahan-li6",
        6,
        "isospectral2 composed by nine stages",
        Cost::of(&[times(9, IsospectralStep)]),
        Recipe::ComposedIsospectral(KAHAN_LI6),
    ),
];
