//! Coordinate maps by name: one type that is each of them.
//!
//! [`NamedMap`] is what a method chosen by name works in. Which map it is, is looked at once for each Ψ and
//! once for each dΨ⁻¹: beside the map that is a predicted branch. Code that names the type of its map
//! ([`Rkmk::new(RK4, Cay)`](crate::methods::Rkmk)) has no such branch.
//!
//! To add a map: its file, its line in [`MAPS`], its line in `named_map!`.

use core::fmt;

use super::{
    Alternating, CCSK, CCSK123, CCSK321, Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp,
};
use crate::error::{Error, StepError};
use crate::groups::{LieGroup, UnitQuaternions};
use crate::names::same;

/// A coordinate map that scene files can name.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MapInfo {
    /// The name of the map.
    pub name: &'static str,
    /// Ψ and dΨ⁻¹ in one line.
    pub summary: &'static str,
    /// The groups that the map works on. It works on a product if it works on the parts.
    pub groups: Groups,
    /// Is Ψ(−u) = Ψ(u)⁻¹, with dΨ⁻¹ to rounding ([`OddMap`](crate::methods::OddMap))?
    pub odd: bool,
    /// Is det Ψ(u) = 1 for each u without a trace? Else runs on SL(n) and SU(n), n > 2, leave det = 1 by the error of the method.
    pub keeps_det: bool,
    map: NamedMap,
}

impl MapInfo {
    /// The groups that the map works on, in words, and where a run leaves them.
    pub fn groups_in_words(&self) -> String {
        let leaves = "; on SL(n) and SU(n), n > 2, det = 1 only up to the error";
        format!("{}{}", self.groups, if self.keeps_det { "" } else { leaves })
    }
}

/// The groups that a map works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groups {
    /// Every group.
    All,
    /// The groups of real matrices, and products of these: not S³, and not the complex U(n).
    OfRealMatrices,
    /// The groups with an ordered basis of cheap factors.
    WithOrderedBasis,
}

impl Groups {
    /// Does the map work on the group of this name, as [`LieAlgebra::name`](crate::LieAlgebra::name) gives it? U(n) and SU(n)
    /// have one name as real and as complex matrices; the answer is that for real ones.
    pub fn contain(self, group: &str) -> bool {
        let is_listed = |part: &str| {
            let family = part.split('(').next().unwrap_or_default();
            // SO(p,q) is no SO(n).
            !part.contains(',') && ["SO", "GL", "SL", "Sp", "SE", "SE2", "T"].contains(&family)
        };
        match self {
            Groups::All => true,
            Groups::OfRealMatrices => group.split(" × ").all(|part| !part.starts_with("S³")),
            Groups::WithOrderedBasis => group.split(" × ").all(is_listed),
        }
    }
}

impl fmt::Display for Groups {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Groups::All => "all",
            Groups::OfRealMatrices => "all but unit quaternions and ideal fluids",
            Groups::WithOrderedBasis => "SO(n), GL(n), SL(n), Sp(2m), SE(3), SE2(3), T(n)",
        })
    }
}

/// The maps, in the order of the paper.
pub const MAPS: &[MapInfo] = &[
    MapInfo {
        name: "exp",
        summary: "canonical coordinates of the first kind; dexp⁻¹ to rounding",
        groups: Groups::All,
        odd: true,
        keeps_det: true,
        map: NamedMap::Exp(Exp),
    },
    MapInfo {
        name: "cay",
        summary: "Cayley map (𝟙 − u/2)⁻¹(𝟙 + u/2)",
        groups: Groups::All,
        odd: true,
        keeps_det: false,
        map: NamedMap::Cay(Cay),
    },
    MapInfo {
        name: "ccsk123",
        summary: "canonical coordinates of the second kind, ordering 123 (ccskf)",
        groups: Groups::WithOrderedBasis,
        odd: false,
        keeps_det: true,
        map: NamedMap::Ccsk123(CCSK123),
    },
    MapInfo {
        name: "ccsk321",
        summary: "canonical coordinates of the second kind, ordering 321 (ccskb)",
        groups: Groups::WithOrderedBasis,
        odd: false,
        keeps_det: true,
        map: NamedMap::Ccsk321(CCSK321),
    },
    MapInfo {
        name: "pade22",
        summary: "Padé map (𝟙 − u/2 + u²/12)⁻¹(𝟙 + u/2 + u²/12), order 4 of exp",
        groups: Groups::OfRealMatrices,
        odd: false,
        keeps_det: false,
        map: NamedMap::Pade22(Pade22),
    },
    MapInfo {
        name: "ccsk",
        summary: "the orderings 321 and 123 on alternate steps",
        groups: Groups::WithOrderedBasis,
        odd: false,
        keeps_det: true,
        map: NamedMap::Ccsk(CCSK),
    },
];

/// A group that the map `Psi` has a formula for: `impl CoordinateMap<G> for Psi`, seen from the group.
pub trait Serves<Psi>: LieGroup + Sized {
    /// `Psi`.
    type Map: CoordinateMap<Self> + Copy + 'static;
    /// The map itself.
    fn map(psi: &Psi) -> &Self::Map;
}

impl<G: LieGroup, Psi: CoordinateMap<G> + Copy + 'static> Serves<Psi> for G {
    type Map = Psi;
    #[inline(always)]
    fn map(psi: &Psi) -> &Psi {
        psi
    }
}

/// The storage of a map on a group.
type At<G, Psi> = <<G as Serves<Psi>>::Map as CoordinateMap<G>>::At;

/// One type of map from several, for the groups that all of them work on.
macro_rules! named_map {
    (
        $(#[$doc:meta])* $name:ident,
        $(#[$at_doc:meta])* $at:ident,
        $(#[$group_doc:meta])* $group:ident:
        $($(#[$variant_doc:meta])* $variant:ident($map:ty),)*
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum $name {
            $($(#[$variant_doc])* $variant($map),)*
        }

        $(#[$group_doc])*
        pub trait $group: LieGroup $(+ Serves<$map>)* {}
        impl<G: LieGroup $(+ Serves<$map>)*> $group for G {}

        $(#[$at_doc])*
        #[allow(missing_debug_implementations)] // the parts belong to the group's types
        #[non_exhaustive]
        pub enum $at<G: $group> {
            $($(#[$variant_doc])* $variant($map, At<G, $map>),)*
        }

        impl<G: $group> CoordinateMap<G> for $name {
            type At = $at<G>;

            fn name(&self) -> &'static str {
                match self {
                    $($name::$variant(psi) => G::map(psi).name(),)*
                }
            }
            fn at(&self, group: &G) -> Result<$at<G>, Error> {
                match self {
                    $($name::$variant(psi) => Ok($at::$variant(*psi, G::map(psi).at(group)?)),)*
                }
            }
            #[inline]
            fn begin_step(&self, at: &mut $at<G>, n: u64) {
                match at {
                    $($at::$variant(psi, at) => G::map(psi).begin_step(at, n),)*
                }
            }
            #[inline]
            fn psi(
                &self,
                group: &G,
                u: &G::Alg,
                at: &mut $at<G>,
                g: &mut G::Elem,
            ) -> Result<(), StepError> {
                match at {
                    $($at::$variant(psi, at) => G::map(psi).psi(group, u, at, g),)*
                }
            }
            #[inline]
            fn psi_on(
                &self,
                group: &G,
                u: &G::Alg,
                at: &mut $at<G>,
                g: &mut G::Elem,
                x: &G::Vector,
                y: &mut G::Vector,
            ) -> Result<(), StepError> {
                match at {
                    $($at::$variant(psi, at) => G::map(psi).psi_on(group, u, at, g, x, y),)*
                }
            }
            #[inline]
            fn dpsi_inv(
                &self,
                group: &G,
                u: &G::Alg,
                at: &mut $at<G>,
                v: &mut G::Alg,
            ) -> Result<(), StepError> {
                match at {
                    $($at::$variant(psi, at) => G::map(psi).dpsi_inv(group, u, at, v),)*
                }
            }
            fn order(&self, group: &G) -> usize {
                match self {
                    $($name::$variant(psi) => G::map(psi).order(group),)*
                }
            }
        }
    };
}

named_map! {
    /// A map of [`MAPS`] by its name.
    NamedMap,
    /// The map, with the values that it stores at u.
    NamedAt,
    /// A group that every map of [`MAPS`] has a type for; as a value it may still be refused.
    AllMaps:
    /// exp.
    Exp(Exp),
    /// exp with a Baker series that is cut.
    Truncated(TruncatedExp),
    /// cay.
    Cay(Cay),
    /// ccsk in the ordering 123.
    Ccsk123(Ccsk<0, 1, 2>),
    /// ccsk in the ordering 321.
    Ccsk321(Ccsk<2, 1, 0>),
    /// The diagonal Padé map of degree 2.
    Pade22(Pade22),
    /// ccsk in both orderings in turn.
    Ccsk(Alternating<Ccsk<2, 1, 0>, Ccsk<0, 1, 2>>),
}

named_map! {
    /// exp or cay by name: what methods with an [`OddMap`](crate::methods::OddMap) take.
    ExpOrCay,
    /// The map, with the values that it stores at u.
    ExpOrCayAt,
    /// A group with exp and cay.
    HasExpAndCay:
    /// exp.
    Exp(Exp),
    /// cay.
    Cay(Cay),
}

/// The largest q that a name may state.
const TERMS_MOST: usize = 1000;
/// What a name may state as q.
pub(crate) const EXPECTED_Q: &str = "a whole number from 0 to 1000, as in q=2";

/// A type of maps that are found by their names.
pub trait FromName: Copy + Send + Sync + 'static {
    /// The map of this name, for exp with the Baker series of dexp⁻¹ cut after the power `q`.
    ///
    /// # Errors
    /// [`Error::UnknownName`]; [`Error::Unsupported`] for a map that the type does not hold, and for a `q`
    /// beside another map than exp; [`Error::OutOfRange`] for a q above 1000.
    fn named(name: &str, q: Option<usize>) -> Result<Self, Error>;
}

impl FromName for NamedMap {
    fn named(name: &str, q: Option<usize>) -> Result<Self, Error> {
        let info =
            MAPS.iter().find(|info| same(info.name, name)).ok_or_else(|| Error::UnknownName {
                kind: "map",
                name: name.into(),
                expected: MAPS.iter().map(|info| info.name).collect(),
            })?;
        match (info.map, q) {
            // Terms beyond are below the smallest number, wherever the series converges.
            (NamedMap::Exp(_), Some(q)) if q > TERMS_MOST => {
                Err(Error::out_of_range("q", q as f64, EXPECTED_Q))
            }
            (NamedMap::Exp(exp), Some(q)) => Ok(NamedMap::Truncated(exp.truncated(q))),
            (map, None) => Ok(map),
            (_, Some(_)) => Err(Error::Unsupported {
                what: "q",
                with: format!("map `{name}`"),
                why: "only the Baker series of exp can be cut; leave q out",
            }),
        }
    }
}

impl FromName for ExpOrCay {
    fn named(name: &str, q: Option<usize>) -> Result<Self, Error> {
        let (what, with, why) = match NamedMap::named(name, q)? {
            NamedMap::Exp(exp) => return Ok(ExpOrCay::Exp(exp)),
            NamedMap::Cay(cay) => return Ok(ExpOrCay::Cay(cay)),
            NamedMap::Truncated(_) => {
                ("q", format!("map `{name}`"), "dexp⁻¹ is taken to rounding here; leave q out")
            }
            _ => ("map", format!("`{name}`"), "the group of this problem has the maps exp and cay"),
        };
        Err(Error::Unsupported { what, with, why })
    }
}

/// A group whose maps can be chosen by name. Groups with every map of [`MAPS`] are such groups; a group
/// with exp and cay alone says `type Map = ExpOrCay`.
pub trait MapsByName: LieGroup + Sized {
    /// [`NamedMap`] or [`ExpOrCay`].
    type Map: CoordinateMap<Self> + FromName;
}

impl<G: AllMaps> MapsByName for G {
    type Map = NamedMap;
}
impl MapsByName for UnitQuaternions {
    type Map = ExpOrCay;
}
