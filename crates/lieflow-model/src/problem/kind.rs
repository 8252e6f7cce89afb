//! What a kind of problem states: its keys, its quantities, and what is known of it before any run.

use lieflow::Error;
use lieflow::catalog::MethodSpec;
use lieflow::names::same;
use lieflow_runs::schema::{Dimension, Units};
use serde::Serialize;

use super::forms::Forms;
use crate::formula::Instead;
use crate::reader::{ReadError, Shape, Value};

/// Reads the keys of a problem, without `kind`.
pub type ReadForms = fn(&Value) -> Result<Forms, ReadError>;

/// A kind of problem.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Its name in scene files.
    pub name: &'static str,
    /// What is integrated: the equations of motion with their signs.
    pub equation: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// The dimension of t.
    pub time: Dimension,
    /// The keys of `[problem]`, besides `kind`.
    pub keys: &'static [KeyInfo],
    /// Keys of numbers, each with what to use for numbers that change with time.
    pub(crate) instead: Instead,
    /// What can be asked of it.
    pub quantities: fn() -> Vec<QuantityInfo>,
    /// Reads the keys of `[problem]`, without `kind`.
    pub(crate) read: ReadForms,
}

/// A key of `[problem]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyInfo {
    /// The key.
    pub name: &'static str,
    /// What it means, and what it holds.
    pub meaning: &'static str,
    /// What its value is.
    pub shape: Shape,
    /// True if it may be left out.
    pub optional: bool,
    /// The dimension of its numbers, where that is the same in every problem of the kind.
    pub dimension: Option<Dimension>,
}

/// A quantity that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QuantityInfo {
    /// Its name in scene files.
    pub name: &'static str,
    /// The names of its columns. Empty: one column with the quantity's name. An `…` between the first and the last: the size
    /// of the problem decides how many there are.
    pub columns: &'static [&'static str],
    /// What it means.
    pub meaning: &'static str,
    /// Its dimension, where that is the same in every problem of the kind.
    pub dimension: Option<Dimension>,
    /// The name of the quantity that figures draw instead of this one. Empty: figures draw this one.
    pub drawn_as: &'static str,
    /// The problems of the kind whose exact motion conserves it.
    pub kept: Kept,
}

/// The problems of a kind that conserve a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// None.
    Never,
    /// Some: those with special keys.
    Sometimes,
    /// All.
    Always,
}

impl QuantityInfo {
    /// The unit where a scene names these; empty where it is not known.
    pub fn unit(&self, units: &Units) -> String {
        self.dimension.and_then(|dimension| units.of(dimension)).unwrap_or_default()
    }

    /// The names of the columns.
    pub fn column_names(&self) -> Vec<String> {
        match self.columns {
            [] => vec![self.name.into()],
            columns => columns.iter().map(|&column| column.into()).collect(),
        }
    }
}

impl Kind {
    /// The quantity of that name.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn quantity(&self, name: &str) -> Result<QuantityInfo, Error> {
        let quantity = (self.quantities)().into_iter().find(|quantity| same(quantity.name, name));
        quantity.ok_or_else(|| self.unknown_quantity(name))
    }

    /// The error for a quantity that the kind does not have.
    pub(crate) fn unknown_quantity(&self, name: &str) -> Error {
        // Of those that mean the same, as the angles of all sequences of axes, one stands for all.
        let all = (self.quantities)();
        let alike = all.chunk_by(|a, b| a.meaning == b.meaning);
        let expected = alike.map(|alike| alike[0].name).collect();
        Error::UnknownName { kind: "quantity", name: name.into(), expected }
    }
}

/// What a field lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// A sphere: rows from north to south, columns from west to east.
    Sphere,
    /// A square torus: rows from the largest y to the least, columns from the least x.
    Torus,
}

/// The figure of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// The columns of a quantity against time.
    Lines(&'static str),
    /// Three columns of a quantity after the other: paths on a sphere.
    Sphere(&'static str),
    /// The same as paths in space.
    Space(&'static str),
    /// Two columns of a quantity after the other: paths in a plane.
    Curve(&'static str),
    /// The same as points, where nothing lies between two rows.
    Points(&'static str),
    /// A field on a surface at the end, by [`Problem::field`](super::Problem::field) from a quantity.
    Map(&'static str, Ground),
}

impl Figure {
    /// The quantity that is drawn.
    pub fn quantity(self) -> &'static str {
        match self {
            Figure::Lines(name)
            | Figure::Sphere(name)
            | Figure::Space(name)
            | Figure::Curve(name)
            | Figure::Points(name)
            | Figure::Map(name, _) => name,
        }
    }
}

/// The largest number of times at which a step of a run must end.
pub const KNOTS_MAX: usize = 1_000_000;

/// The method for any problem that names none: of order 8, with a pair, and on the group.
pub fn high_order() -> MethodSpec {
    MethodSpec { tableau: Some("dop853".into()), ..MethodSpec::new("rkmk", None) }
}

/// The method for problems whose Taylor coefficients follow by recurrence and that name none: the Lie series of order
/// 16. It takes a third of the steps of [`high_order`], and a step costs less.
pub const SERIES: &str = "taylor16";

/// The inertia of a rigid body along its principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalInertia {
    /// The moments of inertia.
    pub moments: [f64; 3],
    /// The axes, one after the other, in the frame of the body.
    pub axes: [[f64; 3]; 3],
}

impl PrincipalInertia {
    /// Moments about the axes of the body.
    pub fn diagonal(moments: [f64; 3]) -> Self {
        PrincipalInertia { moments, axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }

    /// The sides of a box with these moments; the longest is 1. The box of a flat body, or of one that cannot be, has a
    /// small side instead of none.
    pub fn sides_of_a_box(&self) -> [f64; 3] {
        let sum: f64 = self.moments.iter().sum();
        let squares = self.moments.map(|j| sum - 2.0 * j);
        let largest = squares.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        squares.map(|square| (square / largest).max(0.005).sqrt())
    }

    /// The semi-axes of the ellipsoid Σ mᵢ²/(2Jᵢ) = E of the momenta with the energy of m.
    pub fn energy_ellipsoid(&self, m: &[f64; 3]) -> [f64; 3] {
        let twice: f64 = m.iter().zip(self.moments).map(|(m, j)| m * m / j).sum();
        self.moments.map(|j| (j * twice).sqrt())
    }
}

/// Something that is known of a problem before any run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Property {
    /// What.
    pub name: &'static str,
    /// Its value. It is not finite if it is unknown. 1 means yes and 0 means no.
    pub value: f64,
    /// Is it the answer to a question?
    pub is_answer: bool,
}

impl Property {
    /// A number.
    pub(crate) fn of(name: &'static str, value: f64) -> Self {
        Property { name, value, is_answer: false }
    }

    /// Yes or no.
    pub(crate) fn answer(name: &'static str, yes: bool) -> Self {
        Property { name, value: f64::from(u8::from(yes)), is_answer: true }
    }

    /// The value in words: yes or no, or the number in a format.
    pub fn in_words(&self, number: impl FnOnce(f64) -> String) -> String {
        match (self.is_answer, self.value == 1.0) {
            (false, _) => number(self.value),
            (true, yes) => if yes { "yes" } else { "no" }.into(),
        }
    }
}
