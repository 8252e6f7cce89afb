//! Parts of three spaces as one problem: SO(3)ⁿ × SO(3)ᵐ × T(k) on vectors, rotations and numbers.
//!
//! | space | M | Λ | motion | coordinates of a part `a` |
//! |---|---|---|---|---|
//! | vector | ℝ³, \|a\| kept | SO(3), g·a | ȧ = f × a | a1, a2, a3 |
//! | rotation | SO(3) | left translation | ȧ = f̂ a | a11, a12, …, a33 |
//! | numbers | ℝᵏ | translation | ȧ = f | a1, …, ak; of one number a |
//!
//! The type is the same whatever the parts are: powers and numbers may be empty. What a part is, is asked
//! where its formulas are evaluated, and not in the group.

use core::ops::Range;

use lieflow::Error;
use lieflow::groups::{LieAlgebra, Product};
use lieflow::problems::Problem;
use lieflow::scalar::{Real, Trig};
use lieflow::space::LinearSpace;
use lieflow_runs::spaces::{Field, ON_PARTS, OnParts, Parts, Point, group_of};

use crate::formula::Formula;

/// The space of a part, and where in a point it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Space {
    Vector(usize),
    Rotation(usize),
    Numbers(Range<usize>),
}

/// A part with its field.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) name: String,
    pub(super) space: Space,
    /// In t and the coordinates of all parts.
    pub(super) field: Vec<Formula>,
}

impl Space {
    /// The names of its coordinates, for a part of that name.
    pub(super) fn coordinates(&self, name: &str) -> Vec<String> {
        match self {
            Space::Vector(_) => (1..=3).map(|i| format!("{name}{i}")).collect(),
            Space::Rotation(_) => {
                (1..=3).flat_map(|i| (1..=3).map(move |j| format!("{name}{i}{j}"))).collect()
            }
            Space::Numbers(place) if place.len() == 1 => vec![name.into()],
            Space::Numbers(place) => (1..=place.len()).map(|i| format!("{name}{i}")).collect(),
        }
    }

    /// The name of what its action keeps.
    pub(super) fn kept(&self, name: &str) -> Option<String> {
        match self {
            Space::Vector(_) => Some(format!("{name}_length")),
            Space::Rotation(_) => Some(format!("{name}_defect")),
            Space::Numbers(_) => None,
        }
    }

    /// Its dimension, which is the number of formulas of its field.
    pub(super) fn dim(&self) -> usize {
        match self {
            Space::Vector(_) | Space::Rotation(_) => 3,
            Space::Numbers(place) => place.len(),
        }
    }

    /// What it is.
    pub(super) fn describe(&self) -> &'static str {
        match self {
            Space::Vector(_) => "vector",
            Space::Rotation(_) => "rotation",
            Space::Numbers(place) if place.len() == 1 => "number",
            Space::Numbers(_) => "numbers",
        }
    }

    /// Its coordinates at y go to the end of `values`.
    pub(super) fn show<S: Real>(&self, y: &Point<S>, values: &mut Vec<S>) {
        let (vectors, (rotations, numbers)) = y;
        match self {
            Space::Vector(i) => values.extend(vectors[*i].iter()),
            Space::Rotation(i) => {
                let g = &rotations[*i];
                values.extend((0..3).flat_map(|i| (0..3).map(move |j| g[(i, j)])));
            }
            Space::Numbers(place) => values.extend_from_slice(&numbers[place.clone()]),
        }
    }

    /// Where its field is in that of all.
    fn of<'a, S: Real>(&self, v: &'a mut Field<S>) -> &'a mut [S] {
        match self {
            Space::Vector(i) => v.0[*i].as_mut_slice(),
            Space::Rotation(i) => v.1.0[*i].as_mut_slice(),
            Space::Numbers(place) => &mut v.1.1[place.clone()],
        }
    }
}

/// Numbers of a problem: `f64`, and the number that counts operations.
pub(crate) trait Number: Trig + Into<f64> + LinearSpace<Scalar = Self> {}
impl<S: Trig + Into<f64> + LinearSpace<Scalar = S>> Number for S {}

/// Parts that are coupled by their fields.
#[derive(Clone, Debug)]
pub(super) struct Coupled<S: Number> {
    group: Parts<S>,
    parts: Vec<Part>,
}

impl<S: Number> Coupled<S> {
    /// `like` is a point.
    pub(super) fn new(parts: Vec<Part>, like: &Point<S>) -> Result<Self, Error> {
        let (vectors, (rotations, numbers)) = like;
        let group = group_of([vectors.len(), rotations.len(), numbers.len()])?;
        Ok(Coupled { group, parts })
    }
}

impl<S: Number> Problem for Coupled<S> {
    type Group = Parts<S>;
    type Action = OnParts;
    /// t with the coordinates.
    type Work = Vec<S>;

    fn group(&self) -> &Parts<S> {
        &self.group
    }
    fn action(&self) -> &OnParts {
        &ON_PARTS
    }
    fn work(&self) -> Vec<S> {
        let Product(vectors, Product(rotations, numbers)) = &self.group;
        let numbers = 1 + 3 * vectors.copies() + 9 * rotations.copies() + numbers.dim();
        Vec::with_capacity(numbers)
    }
    fn f(&self, t: S, y: &Point<S>, v: &mut Field<S>, values: &mut Vec<S>) {
        values.clear();
        values.push(t);
        self.parts.iter().for_each(|part| part.space.show(y, values));
        for Part { space, field, .. } in &self.parts {
            for (v, formula) in space.of(v).iter_mut().zip(field) {
                *v = formula.value(values);
            }
        }
    }
}
