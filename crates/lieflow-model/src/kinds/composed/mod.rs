//! `kind = "composed"`: a system that a scene composes from parts, spins, bodies and numbers, each with its
//! space and its field as formulas; see [`system`].

mod system;

use core::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use lieflow::groups::{LieGroup, So3};
use lieflow::scalar::Counted;
use lieflow_runs::schema::{self, Measure};
use lieflow_runs::spaces::{self, ON_PARTS, Point};
use nalgebra::{Matrix3, Vector3};

use self::system::{Coupled, Part, Space};
use super::body::{Orientation, Oriented, check_rotation, quaternion, with_angles};
use super::entries::check_rows;
use super::prelude::*;
use crate::formula::{Formula, Names, Parameters, Text, Texts, without_value};
use crate::problem::part;
use crate::reader::values::Numbers;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "composed",
    equation: "ȧ = f × a for vectors, ȧ = f̂ a for rotations, ȧ = f for numbers, f of all parts",
    summary: "a system composed from parts, vectors on spheres, rotations and numbers, by formulas",
    ..Kind::of::<Keys, Composed>(|section| read_with(section, read))
};

keys! { Keys [sample_keys formula_keys] {
    parts: Vec<PartKeys> =
        "a list of {name, space, start, field}. Space is \"vector\", of the coordinates NAME1 to NAME3; \
         \"rotation\", of NAME11 to NAME33 row by row, its start optional, the identity; or \"numbers\", \
         of NAME1, NAME2, …, a single one NAME. Field is a list of formulas, or one whose value is a vector, in t, \
         the coordinates of all parts and the parameters: the angular velocity, in space, of a vector and of a rotation, the \
         derivatives of numbers",
    invariants: BTreeMap<String, Key<Text>> =
        "formulas by name, in the coordinates and the parameters, that the motion keeps; optional",
} }

read_by_keys! {
    struct PartKeys {
        name: Key<String>,
        space: Key<String>,
        start: Key<Option<Numbers>>,
        field: Key<Texts>,
    }
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
    /// Changes that were made to numbers of the scene.
    notes: Vec<String>,
}

type Q = Quantity<Composed>;

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let (formulas, samples) = (keys.formula_keys(), keys.sample_keys());
    let Keys { parts: keys, invariants, .. } = keys;
    let keys = keys?;
    if keys.is_empty() {
        return Err(Refusal::at("parts", "no parts, expected at least one").into());
    }
    let (mut notes, mut mistakes) = (Vec::new(), ReadError::default());
    let (spaces, start) = places(&keys, &mut notes, &mut mistakes);
    // The formulas are read also where a start is wrong. Without the names of all coordinates their form is checked.
    let all_spaces = spaces.iter().map(Option::as_ref).collect::<Option<Vec<_>>>();
    let names = all_spaces.ok_or_else(ReadError::known).and_then(|spaces| {
        let (coordinates, taken) = names_of(&keys, &spaces, seen(&formulas.parameters)?)?;
        let all = core::iter::once(TIME).chain(coordinates.iter().map(String::as_str));
        let of_fields = formulas.names("parts", all, samples)?;
        check_names(&keys, &spaces, &of_fields)?;
        let of_invariants = seen(&formulas.parameters)?.names("parts", &coordinates)?;
        let of_invariants = of_invariants.with_usable_lets("let", seen(&formulas.r#let)?);
        Ok((taken, of_fields, of_invariants))
    });
    let mut parts = Vec::new();
    for (i, (keys, space)) in keys.into_iter().zip(spaces).enumerate() {
        let count = space.as_ref().map(Space::dim);
        let of_fields = seen(&names).map(|(_, of_fields, _)| of_fields);
        let field = keys.field.and_then(|f| f.read_by(&of_part(i, "field"), count, of_fields));
        if let (Some(field), Some(space), Ok(name)) = (mistakes.keep(field), space, keys.name) {
            parts.push(Part { name, space, field });
        }
    }
    let kept = match mistakes.keep(names) {
        Some((taken, of_fields, of_invariants)) => {
            mistakes.keep(of_fields.checked());
            invariants.and_then(|kept| read_invariants(kept, taken, &of_invariants))
        }
        None => {
            for (name, text) in invariants.iter().flatten() {
                let form = |text: &Text| Formula::check_form(&"invariants".entry(name), &text.0);
                mistakes.keep(seen(text).and_then(form));
            }
            Err(ReadError::known())
        }
    };
    let kept = mistakes.keep(kept);
    let kept = mistakes.or(kept)?;
    let composed = Composed { parts, start, invariants: kept, notes };
    // The names of parts and of what they keep are apart already.
    let known = ["state", "vectors", "lengths", "defects", "invariants"];
    Q::check_names(&composed, "parts", &coordinates(composed.parts.iter()), &known)?;
    let invariants: Vec<String> =
        composed.invariants.iter().map(|(name, _)| name.clone()).collect();
    Q::check_names(&composed, "invariants", &invariants, &known)?;
    Ok(Forms::of(composed))
}

/// The invariants, whose names are none of those that are taken.
fn read_invariants(
    texts: BTreeMap<String, Key<Text>>,
    mut taken: BTreeSet<String>,
    names: &Names,
) -> Result<Vec<(String, Formula)>, ReadError> {
    let (mut kept, mut mistakes) = (Vec::new(), ReadError::default());
    for (name, text) in texts {
        let key = "invariants".entry(&name);
        let Some(Text(text)) = mistakes.keep(text) else { continue };
        if !taken.insert(name.clone()) {
            let message = format!("the invariant `{name}` has the name of something else");
            mistakes.add(Refusal::at(key, message));
        } else if let Some(formula) = mistakes.keep(Formula::read(&key, &text, names)) {
            kept.push((name, formula));
        }
    }
    mistakes.or(Some(kept))
}

/// The path of a key of part `i`, from 0.
fn of_part(i: usize, key: &str) -> String {
    "parts".index(i).entry(key)
}

/// The spaces of the parts with their places, where they are known, and the start.
fn places(
    keys: &[PartKeys],
    notes: &mut Vec<String>,
    mistakes: &mut ReadError,
) -> (Vec<Option<Space>>, Point) {
    let (mut vectors, mut rotations, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    let spaces = keys.iter().enumerate().map(|(i, part)| {
        let space = match mistakes.keep(seen(&part.space))?.as_str() {
            // The coordinates have their names also where the start is wrong.
            "vector" => {
                vectors.push(mistakes.keep(vector(i, part)).unwrap_or_default());
                Space::Vector(vectors.len() - 1)
            }
            "rotation" => {
                rotations.push(mistakes.keep(rotation(i, part, notes)).unwrap_or_default());
                Space::Rotation(rotations.len() - 1)
            }
            "numbers" => {
                let start = mistakes.keep(list(i, part))?;
                numbers.extend(start);
                Space::Numbers(numbers.len() - start.len()..numbers.len())
            }
            other => {
                let help = Some(help_for(other, &["vector", "rotation", "numbers"]));
                let refusal = Refusal::at(of_part(i, "space"), format!("unknown space `{other}`"));
                mistakes.add(Refusal { help, ..refusal });
                return None;
            }
        };
        Some(space)
    });
    // Each is read, also after one that is wrong.
    let spaces: Vec<_> = spaces.collect();
    let start = (vectors.into(), (rotations.into(), numbers.into()));
    (spaces, start)
}

/// The refusal of a start that is missing or of another shape.
fn other_start(i: usize, part: &PartKeys, expected: &str) -> ReadError {
    let Ok(name) = &part.name else { return ReadError::known() };
    let key = of_part(i, if matches!(part.start, Ok(None)) { "name" } else { "start" });
    Refusal::at(key, format!("expected {expected} as the start of `{name}`")).into()
}

/// The start of a rotation: a matrix of SO(3).
fn rotation(i: usize, part: &PartKeys, notes: &mut Vec<String>) -> Result<Matrix3<f64>, ReadError> {
    let rows = match seen(&part.start)? {
        None => return Ok(Matrix3::identity()),
        Some(Numbers::Rows(rows)) => rows,
        Some(Numbers::List(_)) => return Err(other_start(i, part, "3 rows of 3 numbers")),
    };
    let key = of_part(i, "start");
    let rows = rows.matrix(&key, Some(3))?;
    check_rows(&key, &rows, 3)?;
    Ok(check_rotation(&key, Matrix3::from_fn(|i, j| rows[(i, j)]), notes)?)
}

/// The start of a vector on a sphere.
fn vector(i: usize, part: &PartKeys) -> Result<Vector3<f64>, ReadError> {
    let Some(Numbers::List(x)) = seen(&part.start)? else {
        return Err(other_start(i, part, "3 numbers"));
    };
    let message = match x[..] {
        [a, b, c] => {
            let x = Vector3::new(a, b, c);
            match x.norm() {
                length if length > 0.0 && length.is_finite() => return Ok(x),
                length => format!("its length is {length}, expected a finite length > 0"),
            }
        }
        _ => format!("expected 3 numbers, found {}", x.len()),
    };
    Err(Refusal::at(of_part(i, "start"), message).into())
}

/// The start of numbers.
fn list(i: usize, part: &PartKeys) -> Result<&[f64], ReadError> {
    match seen(&part.start)? {
        Some(Numbers::List(x)) if !x.is_empty() => Ok(x),
        _ => Err(other_start(i, part, "a list of numbers")),
    }
}

/// The names of all coordinates, and those with what each part keeps: they are names, and none is there
/// twice.
fn names_of(
    keys: &[PartKeys],
    spaces: &[&Space],
    parameters: &Parameters,
) -> Result<(Vec<String>, BTreeSet<String>), ReadError> {
    let (mut coordinates, mut taken) = (Vec::new(), BTreeSet::new());
    for (i, (PartKeys { name, .. }, space)) in keys.iter().zip(spaces).enumerate() {
        let name = seen(name)?;
        let (own, key) = (space.coordinates(name), of_part(i, "name"));
        parameters.names(&key, core::iter::once(&TIME.to_string()).chain(&own))?;
        for column in own.iter().cloned().chain(space.kept(name)) {
            if taken.contains(&column) {
                let message =
                    format!("part `{name}`: its column `{column}` is one of another part already");
                return Err(Refusal::at(key, message).into());
            }
            taken.insert(column);
        }
        coordinates.extend(own);
    }
    Ok((coordinates, taken))
}

/// Checks that the name of each part means its own coordinates, and not those of another part, too.
fn check_names(keys: &[PartKeys], spaces: &[&Space], names: &Names) -> Result<(), ReadError> {
    for (i, (PartKeys { name, .. }, space)) in keys.iter().zip(spaces).enumerate() {
        let name = seen(name)?;
        let own = space.coordinates(name);
        let numbers = names.numbers_of(name).map(|(_, numbers)| numbers).unwrap_or_default();
        let other = numbers.iter().find(|number| !own.contains(number));
        if let Some(other) = other.filter(|_| own.len() > 1) {
            let message = format!(
                "part `{name}`: in a formula `{name}` would have the number `{other}` of another part: rename one of them"
            );
            return Err(Refusal::at(of_part(i, "name"), message).into());
        }
    }
    Ok(())
}

impl Composed {
    /// The parts of this space.
    fn of(&self, which: impl Fn(&Space) -> bool) -> impl Iterator<Item = &Part> {
        self.parts.iter().filter(move |part| which(&part.space))
    }
    fn vectors(&self) -> impl Iterator<Item = &Part> {
        self.of(|space| matches!(space, Space::Vector(_)))
    }
    fn rotations(&self) -> impl Iterator<Item = &Part> {
        self.of(|space| matches!(space, Space::Rotation(_)))
    }
    fn has_vectors(&self) -> bool {
        self.vectors().next().is_some()
    }
    /// These parts, as a quantity has them one after the other.
    fn in_a_row<'a>(parts: impl Iterator<Item = &'a Part>) -> Vec<schema::Component> {
        let mut first = 0;
        let each = parts.map(|Part { name, space, .. }| {
            let measure = match space {
                Space::Rotation(_) => Measure::Rotation,
                _ => Measure::Length,
            };
            let columns = space.coordinates(name).len();
            first += columns;
            let what = space.describe();
            schema::Component { what, ..part(name, first - columns, columns, measure) }
        });
        each.collect()
    }
    /// Why there are no vectors.
    fn without_vectors(&self) -> Option<&'static str> {
        (!self.has_vectors()).then_some("no part is a vector")
    }
}

/// The names of the coordinates of these parts.
fn coordinates<'a>(parts: impl Iterator<Item = &'a Part>) -> Vec<String> {
    parts.flat_map(|part| part.space.coordinates(&part.name)).collect()
}
/// The names of what the action keeps of these parts.
fn kept<'a>(parts: impl Iterator<Item = &'a Part>) -> Vec<String> {
    parts.filter_map(|part| part.space.kept(&part.name)).collect()
}

impl Oriented for Composed {
    /// That of the only rotation.
    fn orientation(&self, (_, (rotations, _)): &Point) -> Orientation {
        rotations.first().map_or(Orientation::NotModelled, |g| Orientation::Matrix(*g))
    }
    fn turning(&self, t: f64, y: &Point) -> Vector3<f64> {
        thread_local! {
            // It is asked after each step, which allocates nothing.
            static VALUES: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
        }
        let field = self.rotations().next().map_or(&[][..], |part| &part.field);
        VALUES.with_borrow_mut(|values| {
            values.clear();
            values.push(t);
            self.parts.iter().for_each(|part| part.space.show(y, values));
            let value = |i: usize| field.get(i).map_or(0.0, |formula| formula.value(values));
            self.orientation(y).rotation().tr_mul(&Vector3::from_fn(|i, _| value(i)))
        })
    }
    fn without_orientation(&self) -> Option<&'static str> {
        match self.rotations().count() {
            0 => Some("no part is a rotation"),
            1 => {
                let taken = |part: &Part| part.space.coordinates(&part.name);
                let is_column = |name: String| ["qw", "qx", "qy", "qz"].contains(&&*name);
                let is_taken = self.parts.iter().flat_map(taken).any(is_column);
                is_taken.then_some("a part has a number by the name of a column of the quaternion")
            }
            _ => Some("several parts are rotations"),
        }
    }
}

impl System for Composed {
    type Problem = spaces::Composed;

    const STATE: &'static [&'static str] = &["state"];
    const QUANTITIES: &'static [Q] = with_angles![
        Q::numbers(
            "state",
            &["…"],
            "the coordinates of all parts, in the order of the scene",
            |composed, _, y, row| composed.parts.iter().for_each(|part| part.space.show(y, row)),
        )
        .with_columns(|composed| coordinates(composed.parts.iter()))
        .in_parts(|composed| Composed::in_a_row(composed.parts.iter())),
        Q::numbers("vectors", &["…"], "the coordinates of the vectors", |_, _, y, row| {
            row.extend(y.0.iter().flat_map(|x| x.iter()));
        })
        .with_columns(|composed| coordinates(composed.vectors()))
        .in_parts(|composed| Composed::in_a_row(composed.vectors()))
        .missing_where(Composed::without_vectors),
        Q::numbers(
            "lengths",
            &["…"],
            "the lengths of the vectors, NAME_length",
            |_, _, y, row| row.extend(y.0.iter().map(Vector3::norm)),
        )
        .with_columns(|composed| kept(composed.vectors()))
        .kept(Law::by_the_action(2))
        .missing_where(Composed::without_vectors),
        Q::numbers(
            "defects",
            &["…"],
            "distances of g'g from the identity, of the rotations, NAME_defect",
            |_, _, (_, (rotations, _)), row| {
                row.extend(rotations.iter().map(|g| So3::new().defect(g)));
            },
        )
        .with_columns(|composed| kept(composed.rotations()))
        .kept(Law::by_the_action(2).on_scale(Scale::One))
        .of_distance()
        .missing_where(|composed| {
            let without = composed.rotations().next().is_none();
            without.then_some("no part is a rotation")
        }),
        quaternion(),
        Q::numbers(
            "invariants",
            &["…"],
            "the invariants that the scene names",
            |composed, _, y, row| {
                let mut values = Vec::new();
                composed.parts.iter().for_each(|part| part.space.show(y, &mut values));
                row.extend(composed.invariants.iter().map(|(_, formula)| formula.value(&values)));
            },
        )
        .with_columns(|composed| composed.invariants.iter().map(|(name, _)| name.clone()).collect())
        .kept(Law::by_the_flow(0))
        .missing_where(|composed| composed.invariants.is_empty().then_some("the scene names none")),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<spaces::Composed>, Error> {
        let coupled = Coupled::new(self.parts.clone(), &self.start)?;
        Ok((spaces::Composed::new(coupled, ON_PARTS), self.start.clone()))
    }
    fn counted(&self) -> Option<Counting> {
        let (vectors, (rotations, numbers)) = &self.start;
        let vectors = vectors.iter().map(|x| x.map(Counted)).collect();
        let rotations = rotations.iter().map(|g| g.map(Counted)).collect();
        let start = (vectors, (rotations, numbers.iter().map(|&x| Counted(x)).collect()));
        let coupled = Coupled::new(self.parts.clone(), &start).ok()?;
        counting(spaces::Composed::new(coupled, ON_PARTS), start)
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        let mut at = vec![t0];
        self.parts.iter().for_each(|part| part.space.show(&self.start, &mut at));
        let fields = self.parts.iter().flat_map(|part| &part.field);
        let mut wrong = without_value(fields, &at);
        wrong.extend(without_value(self.invariants.iter().map(|(_, formula)| formula), &at[1..]));
        wrong
    }
    fn formula(&self) -> Option<&Formula> {
        self.parts.first()?.field.first()
    }
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
    fn modelled(&self) -> String {
        let parts =
            self.parts.iter().map(|part| format!("{} {}", part.space.describe(), part.name));
        parts.collect::<Vec<_>>().join(", ")
    }
    fn figure(&self) -> Figure {
        match self.has_vectors() {
            true => Figure::Sphere("vectors"),
            false => Figure::Lines("state"),
        }
    }
}
