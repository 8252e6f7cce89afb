//! `kind = "composed"`: a system that a scene composes from parts, spins, bodies and numbers, each with its
//! space and its field as formulas; see [`system`].

mod system;

use std::collections::{BTreeMap, BTreeSet};

use lieflow::Error;
use lieflow::catalog::MethodSpec;
use lieflow::groups::{LieGroup, MEMBERSHIP, So3};
use lieflow::scalar::Counted;
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use self::system::{Coupled, ON_PARTS, Part, Point, Space, counted};
use super::flow;
use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::formula::{Formula, Parameters, read_all};
use crate::scene::values::{Numbers, Table};
use crate::scene::{ReadError, Refusal, help_for};

pub(super) use self::system::{OnParts, Parts};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "composed",
    equation: "ȧ = f × a for vectors, ȧ = f̂ a for rotations, ȧ = f for numbers, f of all parts",
    summary: "a system composed from parts, vectors on spheres, rotations and numbers, by formulas",
    keys: &[
        KeyInfo {
            name: "parts",
            meaning: "a list of {name, space, start, field}. Space is \"vector\", of the coordinates \
                      NAME1 to NAME3; \"rotation\", of NAME11 to NAME33 row by row, its start optional, \
                      the identity; or \"numbers\", of NAME1, NAME2, …, a single one NAME. Field is a \
                      list of formulas in t, the coordinates of all parts and the parameters: the \
                      angular velocity, in space, of a vector and of a rotation, the derivatives of \
                      numbers",
        },
        KeyInfo { name: "parameters", meaning: "numbers by name, for the formulas; optional" },
        KeyInfo {
            name: "invariants",
            meaning: "formulas by name, in the coordinates and the parameters, that the motion \
                      keeps; optional",
        },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "state",
                columns: &["…"],
                meaning: "the coordinates of all parts, in the order of the scene",
            },
            QuantityInfo {
                name: "vectors",
                columns: &["…"],
                meaning: "the coordinates of the vectors",
            },
            QuantityInfo {
                name: "lengths",
                columns: &["…"],
                meaning: "the lengths of the vectors, NAME_length",
            },
            QuantityInfo {
                name: "defects",
                columns: &["…"],
                meaning: "distances of g'g from the identity, of the rotations, NAME_defect",
            },
            QuantityInfo { name: "invariants", columns: &["…"], meaning: "what the scene names" },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    parts: Vec<PartKeys>,
    #[serde(default)]
    parameters: Parameters,
    #[serde(default)]
    invariants: BTreeMap<String, String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PartKeys {
    name: String,
    space: String,
    start: Option<Numbers>,
    field: Vec<String>,
}

/// What fields call the time.
const TIME: &str = "t";

/// The parts with their start, and what the scene says that they keep.
#[derive(Clone, Debug)]
struct Composed {
    parts: Vec<Part>,
    start: Point,
    /// In the coordinates of all parts.
    invariants: Vec<(String, Formula)>,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let Keys { parts: keys, parameters, invariants } = Keys::deserialize(section)?;
    if keys.is_empty() {
        return Err(Refusal::at("parts", "no parts, expected at least one").into());
    }
    let (spaces, start) = places(&keys)?;
    let (coordinates, mut taken) = names_of(&keys, &spaces, &parameters)?;
    let all = core::iter::once(TIME).chain(coordinates.iter().map(String::as_str));
    let names = parameters.names("parts", all)?;
    let mut parts = Vec::new();
    for (i, (keys, space)) in keys.into_iter().zip(spaces).enumerate() {
        let (key, expected) = (format!("parts[{i}].field"), space.dim());
        if keys.field.len() != expected {
            let found = keys.field.len();
            let message = format!("found {found} formulas of `{}`, expected {expected}", keys.name);
            return Err(Refusal::at(key, message).into());
        }
        let field = read_all(&key, &keys.field, &names)?;
        parts.push(Part { name: keys.name, space, field });
    }
    let names = parameters.names("parts", &coordinates)?;
    let mut kept = Vec::new();
    for (name, text) in invariants {
        let key = format!("invariants.{name}");
        if !taken.insert(name.clone()) {
            let message = format!("the invariant `{name}` has the name of something else");
            return Err(Refusal::at(key, message).into());
        }
        let formula = Formula::read(&key, &text, &names)?;
        kept.push((name, formula));
    }
    Ok(Box::new(Composed { parts, start, invariants: kept }))
}

/// The spaces of the parts with their places, and the start.
fn places(keys: &[PartKeys]) -> Result<(Vec<Space>, Point), Refusal> {
    let (mut vectors, mut rotations, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    let mut spaces = Vec::new();
    for (i, part) in keys.iter().enumerate() {
        let refused =
            |key: &str, message: String| Refusal::at(format!("parts[{i}].{key}"), message);
        spaces.push(match (part.space.as_str(), &part.start) {
            ("vector", Some(Numbers::List(x))) => {
                vectors.push(vector(x).map_err(|message| refused("start", message))?);
                Space::Vector(vectors.len() - 1)
            }
            ("rotation", None) => {
                rotations.push(Matrix3::identity());
                Space::Rotation(rotations.len() - 1)
            }
            ("rotation", Some(Numbers::Rows(rows))) => {
                rotations.push(rotation(&format!("parts[{i}].start"), rows)?);
                Space::Rotation(rotations.len() - 1)
            }
            ("numbers", Some(Numbers::List(x))) if !x.is_empty() => {
                numbers.extend(x);
                Space::Numbers(numbers.len() - x.len()..numbers.len())
            }
            ("vector" | "rotation" | "numbers", start) => {
                let expected = match part.space.as_str() {
                    "vector" => "3 numbers",
                    "rotation" => "3 rows of 3 numbers",
                    _ => "a list of numbers",
                };
                let message = format!("the start of `{}` is to be {expected}", part.name);
                return Err(refused(if start.is_some() { "start" } else { "name" }, message));
            }
            (other, _) => {
                let help = Some(help_for(other, &["vector", "rotation", "numbers"]));
                let message = format!("unknown space `{other}`");
                return Err(Refusal { help, ..refused("space", message) });
            }
        });
    }
    Ok((spaces, (vectors.into(), (rotations.into(), numbers.into()))))
}

/// A matrix of SO(3).
fn rotation(key: &str, rows: &Table) -> Result<Matrix3<f64>, Refusal> {
    let rows = rows.matrix(key, Some(3))?;
    if rows.nrows() != 3 {
        return Err(Refusal::at(key, format!("found {} rows, expected 3", rows.nrows())));
    }
    let g = Matrix3::from_fn(|i, j| rows[(i, j)]);
    match So3::new().check_element("start", &g, MEMBERSHIP) {
        Ok(()) => Ok(g),
        Err(error) => Err(Refusal::at(key, error.to_string())),
    }
}

/// A vector on a sphere.
fn vector(x: &[f64]) -> Result<Vector3<f64>, String> {
    match *x {
        [a, b, c] => {
            let x = Vector3::new(a, b, c);
            match x.norm() {
                length if length > 0.0 && length.is_finite() => Ok(x),
                length => Err(format!("a vector of length {length}, expected a finite one > 0")),
            }
        }
        _ => Err(format!("expected 3 numbers, found {}", x.len())),
    }
}

/// The names of all coordinates, and those with what each part keeps: they are names, and none is there
/// twice.
fn names_of(
    keys: &[PartKeys],
    spaces: &[Space],
    parameters: &Parameters,
) -> Result<(Vec<String>, BTreeSet<String>), Refusal> {
    let (mut coordinates, mut taken) = (Vec::new(), BTreeSet::new());
    for (i, (PartKeys { name, .. }, space)) in keys.iter().zip(spaces).enumerate() {
        let (own, key) = (space.coordinates(name), format!("parts[{i}].name"));
        parameters.names(&key, core::iter::once(&TIME.to_string()).chain(&own))?;
        for column in own.iter().cloned().chain(space.kept(name)) {
            if taken.contains(&column) {
                let message = format!("part `{name}`: `{column}` is of another part already");
                return Err(Refusal::at(key, message));
            }
            taken.insert(column);
        }
        coordinates.extend(own);
    }
    Ok((coordinates, taken))
}

impl Composed {
    /// Those of this space.
    fn of(&self, which: impl Fn(&Space) -> bool) -> impl Iterator<Item = &Part> {
        self.parts.iter().filter(move |part| which(&part.space))
    }
    fn vectors(&self) -> impl Iterator<Item = &Part> {
        self.of(|space| matches!(space, Space::Vector(_)))
    }
    fn rotations(&self) -> impl Iterator<Item = &Part> {
        self.of(|space| matches!(space, Space::Rotation(_)))
    }
}

impl System for Composed {
    type Problem = flow::Composed<f64>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Point), Error> {
        let coupled = Coupled::new(self.parts.clone(), &self.start)?;
        Ok((flow::Composed::new(coupled, ON_PARTS), self.start.clone()))
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let start = counted(&self.start);
        let coupled = Coupled::<Counted>::new(self.parts.clone(), &start).ok()?;
        let (flow, start) = (flow::Composed::new(coupled, ON_PARTS), start);
        operations_by(method, &flow, start, pace)
    }
    fn check_start(&self, t0: f64) -> Result<(), Refusal> {
        let mut at = vec![t0];
        self.parts.iter().for_each(|part| part.space.show(&self.start, &mut at));
        for (i, part) in self.parts.iter().enumerate() {
            for (j, formula) in part.field.iter().enumerate() {
                formula.check(&format!("parts[{i}].field[{j}]"), &at)?;
            }
        }
        let mut invariants = self.invariants.iter();
        invariants
            .try_for_each(|(name, formula)| formula.check(&format!("invariants.{name}"), &at[1..]))
    }
    fn modelled(&self) -> String {
        let parts =
            self.parts.iter().map(|part| format!("{} {}", part.space.describe(), part.name));
        parts.collect::<Vec<_>>().join(", ")
    }
    fn state(&self) -> &'static [&'static str] {
        &["state"]
    }
    fn laws(&self) -> Vec<Law> {
        let mut laws = Vec::new();
        if self.vectors().next().is_some() {
            laws.push(Law::of_the_action("lengths", 2));
        }
        if self.rotations().next().is_some() {
            laws.push(Law::of_the_action("defects", 2).on_scale(Scale::One));
        }
        if !self.invariants.is_empty() {
            laws.push(Law::of_the_flow("invariants", 0));
        }
        laws
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let coordinates = |part: &Part| part.space.coordinates(&part.name);
        let kept = |part: &Part| part.space.kept(&part.name);
        match quantity.name {
            "state" => self.parts.iter().flat_map(coordinates).collect(),
            "vectors" => self.vectors().flat_map(coordinates).collect(),
            "lengths" => self.vectors().filter_map(kept).collect(),
            "defects" => self.rotations().filter_map(kept).collect(),
            _ => self.invariants.iter().map(|(name, _)| name.clone()).collect(),
        }
    }
    fn show(&self, quantity: &str, _: f64, y: &Point, row: &mut Vec<f64>) {
        let (vectors, (rotations, _)) = y;
        match quantity {
            "state" => self.parts.iter().for_each(|part| part.space.show(y, row)),
            "vectors" => row.extend(vectors.iter().flat_map(|x| x.iter())),
            "lengths" => row.extend(vectors.iter().map(Vector3::norm)),
            "defects" => row.extend(rotations.iter().map(|g| So3::new().defect(g))),
            _ => {
                let mut values = Vec::new();
                self.parts.iter().for_each(|part| part.space.show(y, &mut values));
                row.extend(self.invariants.iter().map(|(_, formula)| formula.value(&values)));
            }
        }
    }
    fn figure(&self) -> Figure {
        match self.vectors().next() {
            Some(_) => Figure::Sphere("vectors"),
            None => Figure::Lines("state"),
        }
    }
}
