//! Names → static code: what a scene file, a bench or a test can ask for.
//!
//! Dispatch happens here, once a run; inside the run everything is static. A map, a tableau or a
//! method is registered by its line in one of the macros below and its entry in the list beside it.

use crate::error::Error;
use crate::groups::LieGroup;
use crate::maps::{
    Alternating, CCSK, CCSK123, CCSK321, Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp,
};
use crate::methods::{Method, Rk, Rkmk, tableau};
use crate::problems::{Ambient, Problem};

/// A coordinate map that scene files can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapInfo {
    /// Its name.
    pub name: &'static str,
    /// Ψ and dΨ⁻¹ in one line.
    pub summary: &'static str,
    /// The groups that it serves.
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
        groups: "SO(n), GL(n), Sp(2m)",
    },
    MapInfo {
        name: "ccsk321",
        summary: "canonical coordinates of the second kind, ordering 321 (ccskb)",
        groups: "SO(n), GL(n), Sp(2m)",
    },
    MapInfo {
        name: "pade22",
        summary: "Padé map (𝟙 − u/2 + u²/12)⁻¹(𝟙 + u/2 + u²/12), order 4 of exp",
        groups: "all",
    },
    MapInfo {
        name: "ccsk",
        summary: "the orderings 321 and 123 on alternate steps",
        groups: "SO(n), GL(n), Sp(2m)",
    },
];

/// Run `$body` with `$map` bound to the map of that name.
macro_rules! each_map {
    ($name:expr, $q:expr, $map:ident => $body:expr) => {
        match ($name, $q) {
            ("exp", Some(q)) => {
                let $map = serve::<P::Group, _>(Exp.truncated(q));
                Ok($body)
            }
            ("exp", None) => {
                let $map = serve::<P::Group, _>(Exp);
                Ok($body)
            }
            (_, Some(_)) => Err(Error::Unsupported {
                what: "q",
                with: format!("map `{}`", $name),
                why: "only the Baker series of exp can be cut; leave q out",
            }),
            ("cay", _) => {
                let $map = serve::<P::Group, _>(Cay);
                Ok($body)
            }
            ("ccsk123", _) => {
                let $map = serve::<P::Group, _>(CCSK123);
                Ok($body)
            }
            ("ccsk321", _) => {
                let $map = serve::<P::Group, _>(CCSK321);
                Ok($body)
            }
            ("pade22", _) => {
                let $map = serve::<P::Group, _>(Pade22);
                Ok($body)
            }
            ("ccsk", _) => {
                let $map = serve::<P::Group, _>(CCSK);
                Ok($body)
            }
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
];

/// Run `$body` with `$tableau` bound to the tableau of that name.
macro_rules! each_tableau {
    ($name:expr, $tableau:ident => $body:expr) => {
        match $name {
            "euler" => {
                let $tableau = tableau::EULER;
                $body
            }
            "midpoint" => {
                let $tableau = tableau::MIDPOINT;
                $body
            }
            "heun" => {
                let $tableau = tableau::HEUN;
                $body
            }
            "rk4" => {
                let $tableau = tableau::RK4;
                $body
            }
            "three-eighths" => {
                let $tableau = tableau::THREE_EIGHTHS;
                $body
            }
            other => Err(unknown("tableau", other, TABLEAUS.iter().copied())),
        }
    };
}

/// A method that scene files can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodInfo {
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

const KEEPS_GROUP: &str = "group, Casimirs";
const MUNTHE_KAAS: &str = "Munthe-Kaas 1999; Celledoni & Owren, Table 1";
const KUTTA: &str = "Hairer, Nørsett, Wanner I, p. 138";

/// The methods.
pub const METHODS: &[MethodInfo] = &[
    MethodInfo {
        name: "rkmk4",
        summary: "Runge–Kutta–Munthe-Kaas with the classical tableau",
        order: Some(4),
        takes_map: true,
        takes_tableau: false,
        preserves: KEEPS_GROUP,
        cost: "4 f, 4 Ψ, 3 dΨ⁻¹",
        source: MUNTHE_KAAS,
    },
    MethodInfo {
        name: "rkmk",
        summary: "Runge–Kutta–Munthe-Kaas with any explicit tableau",
        order: None,
        takes_map: true,
        takes_tableau: true,
        preserves: KEEPS_GROUP,
        cost: "s f, s Ψ, s−1 dΨ⁻¹",
        source: MUNTHE_KAAS,
    },
    MethodInfo {
        name: "rk4",
        summary: "classical Runge–Kutta on the entries of the state",
        order: Some(4),
        takes_map: false,
        takes_tableau: false,
        preserves: "linear invariants only",
        cost: "4 F",
        source: KUTTA,
    },
    MethodInfo {
        name: "rk",
        summary: "explicit Runge–Kutta with any tableau on the entries of the state",
        order: None,
        takes_map: false,
        takes_tableau: true,
        preserves: "linear invariants only",
        cost: "s F",
        source: KUTTA,
    },
];

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
        let info = METHODS
            .iter()
            .find(|m| m.name == self.name)
            .ok_or_else(|| unknown("method", &self.name, METHODS.iter().map(|m| m.name)))?;
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
    + Serves<Cay>
    + Serves<Pade22>
    + Serves<Ccsk<0, 1, 2>>
    + Serves<Ccsk<2, 1, 0>>
    + Serves<Alternating<Ccsk<2, 1, 0>, Ccsk<0, 1, 2>>>
{
}

impl<G> CatalogGroup for G where
    G: Serves<Exp>
        + Serves<TruncatedExp>
        + Serves<Cay>
        + Serves<Pade22>
        + Serves<Ccsk<0, 1, 2>>
        + Serves<Ccsk<2, 1, 0>>
        + Serves<Alternating<Ccsk<2, 1, 0>, Ccsk<0, 1, 2>>>
{
}

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
{
    let info = spec.info()?;
    let map = spec.map.as_deref().unwrap_or("exp");
    let tableau = spec.tableau.as_deref().unwrap_or("rk4");
    match info.name {
        "rkmk4" => each_map!(map, spec.q, psi => on.call(Rkmk::new(tableau::RK4, psi))),
        "rkmk" => each_tableau!(tableau, t =>
            each_map!(map, spec.q, psi => on.call(Rkmk::new(t, psi)))),
        "rk4" => Ok(on.call(Rk(tableau::RK4))),
        "rk" => each_tableau!(tableau, t => Ok(on.call(Rk(t)))),
        other => Err(unknown("method", other, METHODS.iter().map(|m| m.name))),
    }
}
