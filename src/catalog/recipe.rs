//! How the methods of the lists are made: the coefficients of each.

use crate::methods::commutator_free::ProductTableau;
use crate::methods::low_storage::TwoN;
use crate::methods::one_bracket::OneBracketTableau;
use crate::methods::{Dmv, ImplicitTableau, Scheme, SimoWong, Splitting, Tableau};
use crate::problems::Projection;

/// The stages of the explicit tableaus, in two sizes: methods by name share two types.
#[allow(clippy::large_enum_variant)] // constants, never moved in a step
#[derive(Clone, Copy, Debug)]
pub(crate) enum SizedTableau {
    /// At most four stages.
    Small(Tableau<4>),
    /// At most twelve stages.
    Large(Tableau<12>),
}

/// A Gauss tableau with room for three stages: methods by name share one type.
pub(crate) type GaussTableau = ImplicitTableau<3>;

/// What makes a method, before its map and its tableau are chosen.
#[allow(clippy::large_enum_variant)] // constants, never moved in a step
#[derive(Clone, Copy, Debug)]
pub(crate) enum Recipe {
    /// RKMK with the tableau and the map that are chosen.
    Rkmk,
    /// Classical Runge–Kutta with the tableau that is chosen.
    Rk,
    /// Classical Runge–Kutta with a projection after each step.
    ProjectionMethod(Projection),
    OneBracket(OneBracketTableau<7>),
    CommutatorFree(ProductTableau<5>),
    LowStorage(TwoN<13>),
    Magnus4,
    Magnus6,
    Magnus8,
    Cfm42,
    Cfm43,
    Cfm65,
    Cfm811,
    CayleyMagnus4,
    CayleyMagnus6,
    Gauss(GaussTableau),
    RkmkGauss(GaussTableau),
    RkmkGaussSymmetric(GaussTableau),
    /// A Lie series of this order.
    Series(usize),
    /// The Taylor series of this order of the momentum, on its sphere.
    MomentumSeries(usize),
    Splitting(Splitting<3>),
    SimoWong(SimoWong),
    ComposedSimoWong(Scheme),
    Buss,
    Dmv(Dmv),
    Exact,
    EnergyCasimir,
    ComposedEnergyCasimir(Scheme),
    Isospectral2,
    Isospectral4,
    Isospectral6,
    ComposedIsospectral(Scheme),
}

impl Recipe {
    /// Is a method without a chosen tableau an embedded pair?
    pub(crate) fn is_pair(&self) -> bool {
        match self {
            Recipe::OneBracket(table) => table.embedded.is_some(),
            Recipe::CommutatorFree(table) => table.embedded.is_some(),
            Recipe::LowStorage(table) => table.embedded.is_some(),
            _ => false,
        }
    }
}
