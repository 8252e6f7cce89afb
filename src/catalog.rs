//! Names → static code: what a scene file, a bench or a test can ask for.
//!
//! Dispatch happens here, once a run; inside the run everything is static. A map, a tableau or a
//! method is registered by its line in one of the macros below and its entry in the list beside it.

use crate::error::Error;
use crate::groups::LieGroup;
use crate::maps::{
    Alternating, CCSK, CCSK123, CCSK321, Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp,
};
use crate::methods::{CfMagnus, CommutatorFree, LowStorage, Method, OddMap, OneBracket, Rk, Rkmk};
use crate::methods::{commutator_free, crouch_grossman, low_storage, magnus, one_bracket, tableau};
use crate::problems::{Ambient, LinearField, Problem};

/// A coordinate map that scene files can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapInfo {
    /// Its name.
    pub name: &'static str,
    /// Ψ and dΨ⁻¹ in one line.
    pub summary: &'static str,
    /// The groups that it serves; a product where it serves the parts.
    pub groups: &'static str,
}

/// The maps, in the order of the paper.
pub const MAPS: &[MapInfo] = &[
    MapInfo {
        name: "exp",
        summary: "canonical coordinates of the first kind; dexp⁻¹ to rounding",
        groups: "all",
    },
    MapInfo { name: "cay", summary: "Cayley map (𝟙 − u/2)⁻¹(𝟙 + u/2)", groups: "all" },
    MapInfo {
        name: "ccsk123",
        summary: "canonical coordinates of the second kind, ordering 123 (ccskf)",
        groups: "SO(n), GL(n), Sp(2m), SE(3), T(n)",
    },
    MapInfo {
        name: "ccsk321",
        summary: "canonical coordinates of the second kind, ordering 321 (ccskb)",
        groups: "SO(n), GL(n), Sp(2m), SE(3), T(n)",
    },
    MapInfo {
        name: "pade22",
        summary: "Padé map (𝟙 − u/2 + u²/12)⁻¹(𝟙 + u/2 + u²/12), order 4 of exp",
        groups: "all",
    },
    MapInfo {
        name: "ccsk",
        summary: "the orderings 321 and 123 on alternate steps",
        groups: "SO(n), GL(n), Sp(2m), SE(3), T(n)",
    },
];

/// Run `$body` with `$map` bound to the map of that name.
macro_rules! each_map {
    (@bind $psi:expr, $map:ident => $body:expr) => {{
        let $map = serve::<P::Group, _>($psi);
        Ok($body)
    }};
    ($name:expr, $q:expr, $map:ident => $body:expr) => {
        match ($name, $q) {
            ("exp", Some(q)) => each_map!(@bind Exp.truncated(q), $map => $body),
            ("exp", None) => each_map!(@bind Exp, $map => $body),
            (_, Some(_)) => Err(Error::Unsupported {
                what: "q",
                with: format!("map `{}`", $name),
                why: "only the Baker series of exp can be cut; leave q out",
            }),
            ("cay", _) => each_map!(@bind Cay, $map => $body),
            ("ccsk123", _) => each_map!(@bind CCSK123, $map => $body),
            ("ccsk321", _) => each_map!(@bind CCSK321, $map => $body),
            ("pade22", _) => each_map!(@bind Pade22, $map => $body),
            ("ccsk", _) => each_map!(@bind CCSK, $map => $body),
            (other, _) => Err(unknown("map", other, MAPS.iter().map(|m| m.name))),
        }
    };
}

/// The explicit tableaus that scene files can name.
pub const TABLEAUS: &[&str] = &[
    tableau::EULER.name,
    tableau::MIDPOINT.name,
    tableau::HEUN.name,
    tableau::RK4.name,
    tableau::THREE_EIGHTHS.name,
    tableau::BS3.name,
    tableau::RKF45.name,
    tableau::DOPRI5.name,
    tableau::VERNER6.name,
    tableau::DOP853.name,
];

/// Run `$body` with `$tableau` bound to the tableau of that name, and `$pair` where it is an embedded
/// pair.
macro_rules! each_tableau {
    (@bind $which:ident, $tableau:ident => $body:expr) => {{
        let $tableau = tableau::$which;
        $body
    }};
    ($name:expr, $tableau:ident => $body:expr, pair => $pair:expr) => {
        match $name {
            "euler" => each_tableau!(@bind EULER, $tableau => $body),
            "midpoint" => each_tableau!(@bind MIDPOINT, $tableau => $body),
            "heun" => each_tableau!(@bind HEUN, $tableau => $body),
            "rk4" => each_tableau!(@bind RK4, $tableau => $body),
            "three-eighths" => each_tableau!(@bind THREE_EIGHTHS, $tableau => $body),
            "bs3" => each_tableau!(@bind BS3, $tableau => $pair),
            "rkf45" => each_tableau!(@bind RKF45, $tableau => $pair),
            "dopri5" => each_tableau!(@bind DOPRI5, $tableau => $pair),
            "verner6" => each_tableau!(@bind VERNER6, $tableau => $pair),
            "dop853" => each_tableau!(@bind DOP853, $tableau => $pair),
            other => Err(unknown("tableau", other, TABLEAUS.iter().copied())),
        }
    };
}

/// A method that scene files can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodInfo {
    /// The family that it belongs to.
    pub family: &'static str,
    /// Its name.
    pub name: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// Its order; `None` when it is its tableau's.
    pub order: Option<usize>,
    /// Does it take a map (and, for exp, the cut q of the Baker series)?
    pub takes_map: bool,
    /// Does it take a tableau?
    pub takes_tableau: bool,
    /// What it preserves.
    pub preserves: &'static str,
    /// Cost of a step.
    pub cost: &'static str,
    /// Where it comes from.
    pub source: &'static str,
}

/// A method by name, with its parts.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MethodSpec {
    /// The method.
    pub name: String,
    /// Its coordinate map, when it takes one; exp when none is given.
    pub map: Option<String>,
    /// Its tableau, when it takes one; rk4 when none is given.
    pub tableau: Option<String>,
    /// Where the Baker series of dexp⁻¹ is cut (exp only); to rounding when none is given.
    pub q: Option<usize>,
}

impl MethodSpec {
    /// A method with its map.
    pub fn new(name: &str, map: Option<&str>) -> Self {
        MethodSpec { name: name.into(), map: map.map(Into::into), tableau: None, q: None }
    }

    /// The registered method.
    ///
    /// # Errors
    /// [`Error::UnknownName`], and [`Error::Unsupported`] for a part that the method does not take.
    pub fn info(&self) -> Result<&'static MethodInfo, Error> {
        let info = all_methods().map(|(info, _)| info).find(|m| m.name == self.name);
        let info = info.ok_or_else(|| misfit(&self.name))?;
        let refuse = |what, why| Error::Unsupported { what, with: format!("`{}`", info.name), why };
        if self.map.is_some() && !info.takes_map {
            return Err(refuse("map", "it works without coordinates; leave map out"));
        }
        if self.q.is_some() && !info.takes_map {
            return Err(refuse("q", "it has no dexp⁻¹; leave q out"));
        }
        if self.tableau.is_some() && !info.takes_tableau {
            return Err(refuse(
                "tableau",
                "its tableau is fixed; use `rkmk` or `rk` to choose one",
            ));
        }
        Ok(info)
    }

    /// A name for tables: `rkmk4 exp`.
    pub fn label(&self) -> String {
        let mut label = self.name.clone();
        for part in [&self.tableau, &self.map].into_iter().flatten() {
            label = format!("{label} {part}");
        }
        match self.q {
            Some(q) => format!("{label} q={q}"),
            None => label,
        }
    }
}

fn unknown(kind: &'static str, name: &str, expected: impl Iterator<Item = &'static str>) -> Error {
    Error::UnknownName { kind, name: name.into(), expected: expected.collect() }
}

/// A group that the map Psi has a formula for: `impl CoordinateMap<G> for Psi`, seen from the group.
pub trait Serves<Psi>: LieGroup + Sized {
    /// Psi.
    type Map: CoordinateMap<Self>;
    /// Itself.
    fn map(psi: Psi) -> Self::Map;
}

impl<G: LieGroup, Psi: CoordinateMap<G>> Serves<Psi> for G {
    type Map = Psi;
    #[inline]
    fn map(psi: Psi) -> Psi {
        psi
    }
}

fn serve<G: Serves<Psi>, Psi>(psi: Psi) -> G::Map {
    G::map(psi)
}

/// The groups on which every registered map has a type; as a value a group may still be refused.
/// One name for the bounds of all maps: a map that is registered joins it here.
pub trait CatalogGroup:
    Serves<Exp>
    + Serves<TruncatedExp>
    + Serves<Cay, Map: OddMap>
    + Serves<Pade22>
    + Serves<Ccsk<0, 1, 2>>
    + Serves<Ccsk<2, 1, 0>>
    + Serves<Alternating<Ccsk<2, 1, 0>, Ccsk<0, 1, 2>>>
{
}

impl<G> CatalogGroup for G where
    G: Serves<Exp>
        + Serves<TruncatedExp>
        + Serves<Cay, Map: OddMap>
        + Serves<Pade22>
        + Serves<Ccsk<0, 1, 2>>
        + Serves<Ccsk<2, 1, 0>>
        + Serves<Alternating<Ccsk<2, 1, 0>, Ccsk<0, 1, 2>>>
{
}

/// Hand the method that `$spec` names to `$single`, or to `$pair` where it estimates its own error,
/// after `$on`; `$each_map` binds the maps of the group.
macro_rules! each_method {
    ($spec:expr, $on:expr, $each_map:ident, $single:path, pair => $pair:path) => {{
        let spec: &MethodSpec = $spec;
        let info = spec.info()?;
        let map = spec.map.as_deref().unwrap_or("exp");
        let tableau = spec.tableau.as_deref().unwrap_or("rk4");
        match info.name {
            "rkmk4" => $each_map!(map, spec.q, psi => $single($on, Rkmk::new(tableau::RK4, psi))),
            "rkmk" => each_tableau!(tableau,
                t => $each_map!(map, spec.q, psi => $single($on, Rkmk::new(t, psi))),
                pair => $each_map!(map, spec.q, psi => $pair($on, Rkmk::new(t, psi)))),
            "rk4" => Ok($single($on, Rk(tableau::RK4))),
            "rk" => each_tableau!(tableau,
                t => Ok($single($on, Rk(t))),
                pair => Ok($pair($on, Rk(t)))),
            "rkmk4-2c" => Ok($single($on, OneBracket(one_bracket::RKMK4_2C))),
            "magnus43" => Ok($pair($on, OneBracket(one_bracket::MAGNUS43))),
            "cf3" => Ok($single($on, CommutatorFree(commutator_free::CF3))),
            "cf4" => Ok($single($on, CommutatorFree(commutator_free::CF4))),
            "cf43" => Ok($pair($on, CommutatorFree(commutator_free::CF43))),
            "cf-ls3" => Ok($single($on, LowStorage(low_storage::LS3))),
            "cf-ls3-bp" => Ok($single($on, LowStorage(low_storage::LS3_BP))),
            "cf-ls32" => Ok($pair($on, LowStorage(low_storage::LS32))),
            "cf-ls4" => Ok($single($on, LowStorage(low_storage::LS4))),
            "cf-ls5" => Ok($single($on, LowStorage(low_storage::LS5))),
            "cf-ees25" => Ok($single($on, LowStorage(low_storage::EES25))),
            "cf-ees27" => Ok($single($on, LowStorage(low_storage::EES27))),
            "cg2" => Ok($single($on, CommutatorFree(crouch_grossman::CG2))),
            "cg3" => Ok($single($on, CommutatorFree(crouch_grossman::CG3))),
            "cg4" => Ok($single($on, CommutatorFree(crouch_grossman::CG4))),
            other => Err(misfit(other)),
        }
    }};
}

mod embedded;
mod exp_cay;
mod lists;
mod special;
mod state;

pub use embedded::{Doubled, OnEmbedded, with_embedded_method, with_embedded_pair};
pub use exp_cay::{with_exp_cay_method, with_exp_cay_pair, with_fluid_method};
pub use lists::{
    ATTITUDE_METHODS, BODY_METHODS, IMPLICIT_METHODS, ISOSPECTRAL_METHODS, LIE_POISSON_METHODS,
    LINEAR_METHODS, METHODS, SERIES_METHODS, STATE_METHODS,
};
use special::misfit;
pub use special::{
    Catalogued, Needs, all_methods, with_attitude_method, with_attitude_pair, with_body_method,
    with_euler_method, with_implicit_method, with_lie_poisson_method, with_momentum_method,
    with_quaternion_method, with_series_method,
};
pub use state::{with_state_method, with_state_pair};

/// What to do with a method, whatever its type.
pub trait OnMethod<P: Problem> {
    /// The answer.
    type Out;
    /// Do it.
    fn call<M: Method<P>>(self, method: M) -> Self::Out;
}

/// Find the method that `spec` names, with its parts, and hand it over.
///
/// # Errors
/// As [`MethodSpec::info`], and [`Error::UnknownName`] for its map or tableau.
pub fn with_method<P: Ambient, V: OnMethod<P>>(spec: &MethodSpec, on: V) -> Result<V::Out, Error>
where
    P::Group: CatalogGroup,
    Exp: CoordinateMap<P::Group>,
{
    each_method!(spec, on, each_map, OnMethod::<P>::call, pair => OnMethod::<P>::call)
}

/// Find the method for equations of linear type that has this name, and hand it over.
///
/// # Errors
/// [`Error::UnknownName`].
pub fn with_linear_method<P: LinearField, V: OnMethod<P>>(
    name: &str,
    on: V,
) -> Result<V::Out, Error>
where
    P::Group: magnus::TripleProduct,
    Exp: CoordinateMap<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    match name {
        "magnus4" => Ok(on.call(magnus::Magnus4)),
        "magnus6" => Ok(on.call(magnus::Magnus6)),
        "magnus8" => Ok(on.call(magnus::Magnus8)),
        "cfm4-2" => Ok(on.call(CfMagnus(magnus::CFM4_2))),
        "cfm4-3" => Ok(on.call(CfMagnus(magnus::CFM4_3))),
        "cfm6-5" => Ok(on.call(CfMagnus(magnus::CFM6_5))),
        "cfm8-11" => Ok(on.call(CfMagnus(magnus::CFM8_11))),
        "cayley-magnus4" => Ok(on.call(magnus::CayleyMagnus4)),
        "cayley-magnus6" => Ok(on.call(magnus::CayleyMagnus6)),
        other => Err(unknown("linear method", other, LINEAR_METHODS.iter().map(|m| m.name))),
    }
}
