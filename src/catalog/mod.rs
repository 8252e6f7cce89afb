//! Methods by name: what a scene file, a bench or a test can ask for.
//!
//! A name becomes a method in three lines, and the method runs like any other:
//!
//! ```
//! use lieflow::catalog::MethodsByName;
//! use lieflow::problems::RigidBody;
//! use lieflow::{SaveAt, TimeGrid, integrate};
//! use lieflow::nalgebra::Vector3;
//!
//! let (body, mut m) = (RigidBody::new([1.0, 2.0, 3.0])?, Vector3::new(0.2, 0.0, 3.0));
//! let grid = TimeGrid::new([0.0, 10.0], 0.05)?;
//!
//! let method = body.method(&"rkmk4 cay".parse()?)?;
//! integrate(&body, &method, &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | question | answer |
//! |---|---|
//! | Which methods are there? | [`all_methods`], with what is known of each: [`MethodInfo`] |
//! | Which methods fit my problem? | those whose [`Needs`] the problem [`offers`](MethodsByName::offers) |
//! | Run this one | [`MethodsByName::method`] gives an [`AnyMethod`]: a [`Method`](crate::Method) and an [`Embedded`](crate::methods::Embedded) |
//!
//! A method is one line of the lists in `lists/`: what is known of it, and its coefficients. Which code runs them
//! is decided in `build.rs`, once a family.

mod build;
mod facts;
mod lists;
mod problems;
mod recipe;

pub use build::{
    bodies, classical, closed, energy_casimir, fields, implicit, isospectral, linear_type, momenta,
    projected, series,
};
pub use facts::{
    Cost, Count, Family, Maps, MethodInfo, Needs, Operation, Order, OtherCase, Property, WorkItem,
};
pub use lists::all_methods;
pub use problems::{Fact, fluids};

use core::str::FromStr;

use crate::error::Error;
use crate::maps::{EXPECTED_Q, ExpOrCay, FromName, MapsByName, NamedMap};
pub use crate::maps::{MAPS, MapInfo};
use crate::methods::{AnyMethod, tableau};
use crate::names::same;
use crate::problems::{Ambient, Problem};
use recipe::SizedTableau;

/// An explicit tableau that scene files can name.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TableauInfo {
    /// The name of the tableau.
    pub name: &'static str,
    /// The order of the tableau.
    pub order: usize,
    /// The stages of a step without an error estimate.
    pub stages: usize,
    /// Is the tableau an embedded pair?
    pub pair: bool,
    pub(crate) table: SizedTableau,
}

macro_rules! tableaus {
    ($($size:ident: $($tableau:ident)*;)*) => {
        /// The explicit tableaus, in the order of listings.
        pub const TABLEAUS: &[TableauInfo] = &[$($(TableauInfo {
            name: tableau::$tableau.name,
            order: tableau::$tableau.order,
            stages: tableau::$tableau.update_stages(),
            pair: tableau::$tableau.error.is_some(),
            table: SizedTableau::$size(tableau::$tableau.padded()),
        },)*)*];
    };
}
tableaus! {
    Small: EULER MIDPOINT HEUN RK4 THREE_EIGHTHS BS3;
    Large: RKF45 DOPRI5 VERNER6 DOP853;
}

/// The tableau where none is named.
const RK4: &str = tableau::RK4.name;
/// The map where none is named.
const EXP: &str = "exp";

/// A method by name, with its parts. As text: `rkmk dopri5 cay`, `rkmk4 exp q=2`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MethodSpec {
    /// The method.
    pub name: String,
    /// The coordinate map of the method, when it takes one; exp when none is given.
    pub map: Option<String>,
    /// The tableau of the method, when it takes one; rk4 when none is given.
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
        let info = all_methods().find(|m| same(m.name, &self.name));
        let names = || all_methods().map(|m| m.name);
        let info = info.ok_or_else(|| unknown("method", &self.name, names()))?;
        let refuse = |what, why| Error::Unsupported { what, with: format!("`{}`", info.name), why };
        if self.map.is_some() && !info.takes_map() {
            return Err(refuse("map", "it does not take one; leave map out"));
        }
        if self.q.is_some() && !info.takes_map() {
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

    /// The registered method with its parts.
    ///
    /// # Errors
    /// As [`info`](Self::info), and [`Error::UnknownName`] for a map or a tableau that there is not,
    /// [`Error::Unsupported`] for a map that the method cannot take.
    pub fn choose(&self) -> Result<Choice<'_>, Error> {
        let info = self.info()?;
        let tableau = self.tableau.as_deref().unwrap_or(RK4);
        let tableau = TABLEAUS
            .iter()
            .find(|t| same(t.name, tableau))
            .ok_or_else(|| unknown("tableau", tableau, TABLEAUS.iter().map(|t| t.name)))?;
        let map = self.map.as_deref().unwrap_or(EXP);
        let map = MAPS
            .iter()
            .find(|info| same(info.name, map))
            .ok_or_else(|| unknown("map", map, MAPS.iter().map(|info| info.name)))?;
        let choice = Choice { info, tableau, map: map.name, q: self.q };
        if info.takes_map() {
            NamedMap::named(map.name, choice.q)?;
        }
        if info.maps == Maps::Odd && (choice.q.is_some() || !map.odd) {
            return Err(Error::Unsupported {
                what: if choice.q.is_some() { "q" } else { "map" },
                with: format!("`{}` with map `{}`", self.name, choice.map),
                why: "it needs Ψ(−u) = Ψ(u)⁻¹ and dΨ⁻¹ to rounding: exp or cay",
            });
        }
        Ok(choice)
    }

    /// The same method, with each name as the listings spell it.
    ///
    /// # Errors
    /// As [`choose`](Self::choose).
    pub fn spelt(&self) -> Result<MethodSpec, Error> {
        let choice = self.choose()?;
        let spelt = |part: &Option<String>, name: &str| part.as_ref().map(|_| name.into());
        Ok(MethodSpec {
            name: choice.info.name.into(),
            map: spelt(&self.map, choice.map),
            tableau: spelt(&self.tableau, choice.tableau.name),
            q: self.q,
        })
    }

    /// Has the method an error estimate of its own? If not, an adaptive run doubles its steps.
    ///
    /// # Errors
    /// As [`choose`](Self::choose).
    pub fn has_pair(&self) -> Result<bool, Error> {
        let Choice { info, tableau, .. } = self.choose()?;
        Ok(if info.takes_tableau { tableau.pair } else { info.recipe.is_pair() })
    }

    /// Evaluations of f, F or A in a step of one size; none for an implicit method, whose number depends on the
    /// step, and for a method that evaluates no field.
    ///
    /// # Errors
    /// As [`choose`](Self::choose).
    pub fn evaluations(&self) -> Result<Option<u64>, Error> {
        let Choice { info, tableau, .. } = self.choose()?;
        Ok(info.cost.evaluations(tableau.stages as u64))
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

/// The inverse of [`MethodSpec::label`]: the method, then its parts in any order.
impl FromStr for MethodSpec {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let mut words = text.split_whitespace();
        let mut spec = MethodSpec::new(words.next().unwrap_or_default(), None);
        for word in words {
            if let Some(q) = word.strip_prefix("q=") {
                let with = spec.label();
                if spec.q.replace(q_of(q)?).is_some() {
                    let why = "it has a q already, and a method has one";
                    return Err(Error::Unsupported { what: "another q", with, why });
                }
            } else if let Some(tableau) = TABLEAUS.iter().find(|t| same(t.name, word)) {
                let with = spec.label();
                if spec.tableau.replace(tableau.name.into()).is_some() {
                    let why = "it has a tableau already, and a method has one";
                    return Err(Error::Unsupported { what: tableau.name, with, why });
                }
            } else if let Some(map) = MAPS.iter().find(|map| same(map.name, word)) {
                let with = spec.label();
                if spec.map.replace(map.name.into()).is_some() {
                    let why = "it has a map already, and a method has one";
                    return Err(Error::Unsupported { what: map.name, with, why });
                }
            } else {
                let parts = MAPS.iter().map(|m| m.name).chain(TABLEAUS.iter().map(|t| t.name));
                return Err(unknown("map or tableau", word, parts));
            }
        }
        spec.spelt()
    }
}

/// The q of a name.
fn q_of(text: &str) -> Result<usize, Error> {
    text.parse().map_err(|_| match text.parse::<f64>() {
        Ok(value) if !value.is_nan() => Error::out_of_range("q", value, EXPECTED_Q),
        _ => unknown("q", text, [EXPECTED_Q].into_iter()),
    })
}

fn unknown(kind: &'static str, name: &str, expected: impl Iterator<Item = &'static str>) -> Error {
    Error::UnknownName { kind, name: name.into(), expected: expected.collect() }
}

/// A registered method with its parts.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Choice<'a> {
    /// The method.
    pub info: &'static MethodInfo,
    /// The tableau of the method; that of rk4 where it takes none.
    pub tableau: &'static TableauInfo,
    /// The name of its map; exp where it takes none.
    pub map: &'a str,
    /// Where the Baker series of dexp⁻¹ is cut.
    pub q: Option<usize>,
}

impl Choice<'_> {
    /// The map on a group.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a map that the group does not have.
    fn map<G: MapsByName>(&self) -> Result<G::Map, Error> {
        G::Map::named(self.map, self.q)
    }
    /// The map of a method with an odd map.
    fn odd_map(&self) -> Result<ExpOrCay, Error> {
        ExpOrCay::named(self.map, self.q)
    }
}

/// What a function that makes methods answers: none for a method that is not its own.
pub type MaybeMethod<'p, P> = Result<Option<AnyMethod<'p, P>>, Error>;

/// A problem whose methods can be chosen by name.
///
/// For a problem of your own, list what it offers and the functions of this module that make those methods:
///
/// ```
/// use lieflow::catalog::{Choice, MaybeMethod, MethodsByName, Needs, fields, first, implicit};
/// # use lieflow::{actions::Linear, groups::So3, problems::Problem};
/// # use lieflow::nalgebra::Vector3;
/// # struct Spin(So3, Linear);
/// # impl Problem for Spin {
/// #     type Group = So3;
/// #     type Action = Linear;
/// #     type Work = ();
/// #     fn group(&self) -> &So3 { &self.0 }
/// #     fn action(&self) -> &Linear { &self.1 }
/// #     fn work(&self) {}
/// #     fn f(&self, t: f64, _x: &Vector3<f64>, v: &mut Vector3<f64>, _: &mut ()) { *v = Vector3::new(0.0, 0.0, t); }
/// # }
/// impl MethodsByName for Spin {
///     fn offers(&self) -> Vec<Needs> {
///         vec![Needs::Field, Needs::Norm]
///     }
///     fn make<'p>(&self, choice: &Choice<'_>) -> MaybeMethod<'p, Self> where Self: 'p {
///         first([fields, implicit], choice)
///     }
/// }
/// ```
pub trait MethodsByName: Ambient {
    /// The properties of the problem. A method fits if it needs no others.
    fn offers(&self) -> Vec<Needs>;

    /// The method that is chosen, one that needs what the problem offers.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a map that the group does not have.
    fn make<'p>(&self, choice: &Choice<'_>) -> MaybeMethod<'p, Self>
    where
        Self: Sized + 'p;

    /// The method that `spec` names, with its parts. It is checked to fit the type of the problem; nothing is integrated. A map
    /// that the type of the group has, but not this group, as ccsk on U(n), is refused by the run.
    ///
    /// # Errors
    /// As [`MethodSpec::choose`]; [`Error::Unsupported`] with what the method needs and the problem does not offer,
    /// and for a map without a formula on the group.
    fn method<'p>(&self, spec: &MethodSpec) -> Result<AnyMethod<'p, Self>, Error>
    where
        Self: Sized + 'p,
    {
        let choice = spec.choose()?;
        let misfit = || Error::Unsupported {
            what: choice.info.name,
            with: "this problem".into(),
            why: choice.info.needs.why(),
        };
        if !self.offers().contains(&choice.info.needs) {
            return Err(misfit());
        }
        self.make(&choice)?.ok_or_else(misfit)
    }
}

/// The method that the first of these functions makes.
///
/// # Errors
/// Those of the functions.
pub fn first<'p, P: Problem, const N: usize>(
    makers: [fn(&Choice<'_>) -> MaybeMethod<'p, P>; N],
    choice: &Choice<'_>,
) -> MaybeMethod<'p, P> {
    for make in &makers {
        if let Some(method) = make(choice)? {
            return Ok(Some(method));
        }
    }
    Ok(None)
}
