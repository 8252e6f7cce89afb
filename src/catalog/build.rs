//! From the parts of a method to the method: one function for each thing that problems may offer.
//!
//! Tableaus with few stages share one type and so do maps, so that a problem has a few dozen methods to compile
//! whatever is in the lists.

use super::recipe::{Recipe, SizedTableau};
use super::{Choice, MaybeMethod};
use crate::maps::{Cay, CoordinateMap, Exp, ExpOrCay, MapsByName, NamedMap, Serves};
use crate::methods::tableau;
use crate::methods::{
    AnyMethod, Buss4, CfMagnus, CommutatorFree, Composition, ConjugationAction, ConjugationGroup,
    Embedded, EnergyCasimir, ExactMotion, GAUSS2, GAUSS4, GAUSS6, Gauss, IsospectralGauss,
    LieSeries, LowStorage, Method, Metric, OneBracket, ProjectionMethod, Rk, Rkmk, RkmkGauss,
    RkmkGaussSymmetric, SeriesGroup, Taylor, TaylorMomentum, Wide, magnus,
};
use crate::problems::{
    Ambient, FreeBody, LiePoisson, LinearField, Orthogonal, PointOf, Problem, ScalarOf, Split,
    TaylorField,
};
use crate::scalar::{Real, Trig};

/// A method without an estimate of its own.
fn plain<'p, P: Problem + 'p>(
    method: impl Method<P> + Clone + Send + Sync + 'p,
) -> MaybeMethod<'p, P> {
    Ok(Some(AnyMethod::new(method)))
}

/// A method with one.
fn pair<'p, P: Problem + 'p>(
    method: impl Embedded<P> + Clone + Send + Sync + 'p,
) -> MaybeMethod<'p, P> {
    Ok(Some(AnyMethod::embedded(method)))
}

/// Explicit methods for every problem ([`Needs::Field`](super::Needs::Field)), but for those of [`classical`].
///
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported) for a map that the group does not have.
pub fn fields<'p, P>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    P: Ambient<Group: MapsByName> + 'p,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
    Exp: CoordinateMap<P::Group>,
{
    match choice.info.recipe {
        Recipe::Rkmk => {
            let psi = choice.map::<P::Group>()?;
            match choice.tableau.table {
                SizedTableau::Small(table) => pair(Rkmk::new(table, psi)),
                SizedTableau::Large(table) => pair(Rkmk::new(table, psi)),
            }
        }
        Recipe::OneBracket(table) => pair(OneBracket(table)),
        Recipe::CommutatorFree(table) => pair(CommutatorFree(table)),
        Recipe::LowStorage(table) => pair(LowStorage(table)),
        _ => classical(choice),
    }
}

/// The lane of the closed rigid body, before [`fields`]: its steps are so short that the choice of the map, and a number
/// of stages that the compiler does not know, would show. RKMK of at most four stages with the map as a type, `dopri5` and
/// `dop853` with exp, and RKMK on Gauss tableaus. Numbers that count operations have no such lane.
///
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported) for a map that the group does not have.
pub fn closed<'p, P>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    P: Ambient<Group: crate::maps::AllMaps> + 'p,
    Exp: CoordinateMap<P::Group>,
{
    if ScalarOf::<P>::COUNTS {
        return Ok(None);
    }
    if let Recipe::RkmkGauss(table) = choice.info.recipe {
        let psi = choice.map::<P::Group>()?;
        return match table.stages() {
            1 => plain(RkmkGauss::new(table.resized::<1>(), psi)),
            2 => plain(RkmkGauss::new(table.resized::<2>(), psi)),
            _ => Ok(None),
        };
    }
    let is_rkmk = matches!(choice.info.recipe, Recipe::Rkmk);
    if is_rkmk && let NamedMap::Exp(psi) = choice.map::<P::Group>()? {
        let psi = *served::<P::Group, _>(&psi);
        let name = choice.tableau.name;
        if name == tableau::DOPRI5.name {
            return pair(Rkmk::new(tableau::DOPRI5, psi));
        }
        if name == tableau::DOP853.name {
            return pair(Rkmk::new(tableau::DOP853, psi));
        }
    }
    let SizedTableau::Small(table) = choice.tableau.table else { return Ok(None) };
    macro_rules! with {
        ($psi:expr) => {
            pair(Rkmk::new(table, *served::<P::Group, _>(&$psi)))
        };
    }
    match choice.info.recipe {
        Recipe::Rkmk => match choice.map::<P::Group>()? {
            NamedMap::Exp(psi) => with!(psi),
            NamedMap::Cay(psi) => with!(psi),
            NamedMap::Ccsk123(psi) => with!(psi),
            NamedMap::Ccsk321(psi) => with!(psi),
            NamedMap::Pade22(psi) => with!(psi),
            NamedMap::Ccsk(psi) => with!(psi),
            _ => Ok(None),
        },
        _ => Ok(None),
    }
}

fn served<G: Serves<Psi>, Psi>(psi: &Psi) -> &G::Map {
    G::map(psi)
}

/// Classical methods on the entries of the state, explicit and implicit.
///
/// # Errors
/// None.
pub fn classical<'p, P: Ambient + 'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    match choice.info.recipe {
        Recipe::Rk => match choice.tableau.table {
            SizedTableau::Small(table) => pair(Rk(table)),
            SizedTableau::Large(table) => pair(Rk(table)),
        },
        // These loops are so short that a number of stages that the compiler does not know doubles their time.
        Recipe::Gauss(table) => match table.stages() {
            1 => plain(Gauss(table.resized::<1>())),
            2 => plain(Gauss(table.resized::<2>())),
            _ => plain(Gauss(table)),
        },
        _ => Ok(None),
    }
}

/// Implicit methods ([`Needs::Norm`](super::Needs::Norm)).
///
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported) for a map that the group does not have.
pub fn implicit<'p, P>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    P: Ambient<Group: MapsByName> + 'p,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
    ExpOrCay: CoordinateMap<P::Group>,
{
    match choice.info.recipe {
        Recipe::RkmkGauss(table) => plain(RkmkGauss::new(table, choice.map::<P::Group>()?)),
        Recipe::RkmkGaussSymmetric(table) => {
            plain(RkmkGaussSymmetric::new(table, choice.odd_map()?))
        }
        _ => Ok(None),
    }
}

/// Magnus methods ([`Needs::LinearType`](super::Needs::LinearType)).
///
/// # Errors
/// None.
pub fn linear_type<'p, P: LinearField + 'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    P::Group: magnus::TripleProduct,
    Exp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    match choice.info.recipe {
        Recipe::Magnus4 => plain(magnus::Magnus4),
        Recipe::Magnus6 => plain(magnus::Magnus6),
        Recipe::Magnus8 => plain(magnus::Magnus8),
        Recipe::Cfm42 => plain(CfMagnus(magnus::CFM4_2)),
        Recipe::Cfm43 => plain(CfMagnus(magnus::CFM4_3)),
        Recipe::Cfm65 => plain(CfMagnus(magnus::CFM6_5)),
        Recipe::Cfm811 => plain(CfMagnus(magnus::CFM8_11)),
        Recipe::CayleyMagnus4 => plain(magnus::CayleyMagnus4),
        Recipe::CayleyMagnus6 => plain(magnus::CayleyMagnus6),
        _ => Ok(None),
    }
}

/// Lie series for fields with Taylor coefficients ([`Needs::Series`](super::Needs::Series)).
///
/// # Errors
/// None.
pub fn series<'p, P: TaylorField<Group: SeriesGroup> + 'p>(
    choice: &Choice<'_>,
) -> MaybeMethod<'p, P> {
    match choice.info.recipe {
        Recipe::Series(order) => pair(LieSeries::new(order)?),
        _ => Ok(None),
    }
}

/// Methods for the free rigid body in ℝ³ ([`Needs::Body`](super::Needs::Body)), Lie series among them.
///
/// # Errors
/// None.
pub fn bodies<'p, P: FreeBody + Split + 'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    ScalarOf<P>: Trig + Wide + Into<f64>,
{
    match choice.info.recipe {
        Recipe::Splitting(method) => plain(method),
        Recipe::SimoWong(method) => plain(method),
        Recipe::ComposedSimoWong(scheme) => {
            plain(Composition::new(crate::methods::SimoWong::TAN, scheme))
        }
        Recipe::Buss => plain(Buss4),
        Recipe::Dmv(method) => plain(method),
        Recipe::Exact => pair(ExactMotion),
        Recipe::Series(4) => pair(Taylor::<4>),
        Recipe::Series(5) => pair(Taylor::<5>),
        Recipe::Series(6) => pair(Taylor::<6>),
        Recipe::Series(7) => pair(Taylor::<7>),
        Recipe::Series(8) => pair(Taylor::<8>),
        Recipe::Series(9) => pair(Taylor::<9>),
        Recipe::Series(10) => pair(Taylor::<10>),
        Recipe::Series(11) => pair(Taylor::<11>),
        Recipe::Series(12) => pair(Taylor::<12>),
        Recipe::Series(13) => pair(Taylor::<13>),
        Recipe::Series(14) => pair(Taylor::<14>),
        Recipe::Series(15) => pair(Taylor::<15>),
        Recipe::Series(16) => pair(Taylor::<16>),
        _ => Ok(None),
    }
}

/// Methods for the momentum of the free rigid body ([`Needs::Momentum`](super::Needs::Momentum)).
///
/// # Errors
/// None.
pub fn momenta<'p, P: FreeBody<Frame = ()> + 'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    ScalarOf<P>: Wide + Into<f64>,
{
    match choice.info.recipe {
        Recipe::MomentumSeries(12) => pair(TaylorMomentum::<12>),
        Recipe::MomentumSeries(16) => pair(TaylorMomentum::<16>),
        _ => Ok(None),
    }
}

/// Classical methods with a projection ([`Needs::Attitude`](super::Needs::Attitude)).
///
/// # Errors
/// None.
pub fn projected<'p, P: Orthogonal + 'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    match (choice.info.recipe, choice.tableau.table) {
        (Recipe::ProjectionMethod(how), SizedTableau::Small(t)) => {
            pair(ProjectionMethod::new(Rk(t), how))
        }
        (Recipe::ProjectionMethod(how), SizedTableau::Large(t)) => {
            pair(ProjectionMethod::new(Rk(t), how))
        }
        _ => Ok(None),
    }
}

/// Methods that conserve energy and Casimirs ([`Needs::LiePoisson`](super::Needs::LiePoisson)).
///
/// # Errors
/// None.
pub fn energy_casimir<'p, P: LiePoisson + 'p>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
    ExpOrCay: CoordinateMap<P::Group>,
{
    match choice.info.recipe {
        Recipe::EnergyCasimir => plain(EnergyCasimir::new(choice.odd_map()?)),
        Recipe::ComposedEnergyCasimir(scheme) => {
            plain(Composition::new(EnergyCasimir::new(choice.odd_map()?), scheme))
        }
        _ => Ok(None),
    }
}

/// Isospectral methods ([`Needs::Isospectral`](super::Needs::Isospectral)).
///
/// # Errors
/// None.
pub fn isospectral<'p, P>(choice: &Choice<'_>) -> MaybeMethod<'p, P>
where
    P: Ambient<Group: ConjugationGroup> + 'p,
    P::Action: ConjugationAction<P::Group>,
{
    match choice.info.recipe {
        Recipe::Isospectral2 => plain(IsospectralGauss(GAUSS2)),
        Recipe::Isospectral4 => plain(IsospectralGauss(GAUSS4)),
        Recipe::Isospectral6 => plain(IsospectralGauss(GAUSS6)),
        Recipe::ComposedIsospectral(scheme) => {
            plain(Composition::new(IsospectralGauss(GAUSS2), scheme))
        }
        _ => Ok(None),
    }
}
