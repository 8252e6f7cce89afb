//! `kind = "beam-line"`: a particle beside the design orbit through drifts, quadrupoles and dipoles, cell
//! after cell, by the transfer map in Sp(4); see [`beam`](lieflow::problems::beam).
//!
//! ġ = A(s) g with A = \[0 𝟙; −K(s) 0\], K = diag(k_x, k_z) constant along an element: a step that ends
//! where elements do is exact by every exponential method.

use lieflow::dense::multiply;
use lieflow::groups::{AlgebraMatrix, MatrixGroup};
use lieflow::problems::Flow;
use lieflow::problems::beam::{Element, transfer_map, tunes};
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::entries::{power, rows, symplectic_defect};
use super::prelude::*;
use crate::problem::{KNOTS_MAX, Stops};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "beam-line",
    equation: "x″ = −k_x x, z″ = −k_z z: (k_x, k_z) = (k, −k) in a quadrupole, (1/radius², 0) in a dipole",
    summary: "a particle through the magnets of a periodic beam line; t is the path along it",
    time: Dimension::LENGTH,
    ..Kind::of::<Keys, BeamLine>(|section| read_with(section, read))
};

keys! { Keys {
    elements: Vec<ElementKeys> = "a cell: {kind = \"drift\", length}, {kind = \"quadrupole\", length, k}, \
                                  {kind = \"dipole\", length, radius}, in the order of the beam",
    particle: Reals<4> = "initial [x, z, x', z']",
} }

read_by_keys! {
    struct ElementKeys {
        kind: Key<String>,
        length: Key<Real>,
        k: Key<Option<Real>>,
        radius: Key<Option<Real>>,
    }
}

/// A cell, and the particle.
#[derive(Clone, Debug)]
struct BeamLine {
    elements: Vec<Element>,
    strengths: Strengths,
    particle: [f64; 4],
}

type Q = Quantity<BeamLine>;

/// An element with (k_x, k_z), and its length.
fn element(at: &str, keys: ElementKeys) -> Result<(Element, [f64; 2], f64), ReadError> {
    let ElementKeys { kind, length, k, radius } = keys;
    let length = length.and_then(|length| {
        length.checked(&at.entry("length"), "a number > 0", |length| length > 0.0)
    });
    let (kind, k, radius, length) = match all!(kind, k, radius) {
        Ok((kind, k, radius)) => (kind, k.map(|x| x.0), radius.map(|x| x.0), length),
        Err(known) => return length.and(Err(known)),
    };
    // A wrong key is told at its place, and a missing one at the element.
    let wrong = |key: &str, given: bool, message: &str| {
        let place = if given { at.entry(key) } else { at.into() };
        Err(ReadError::from(Refusal::at(place, message)))
    };
    let made = match (kind.as_str(), k, radius) {
        ("drift", None, None) => Ok([0.0, 0.0]),
        ("quadrupole", Some(k), None) => Ok([k, -k]),
        ("dipole", None, Some(radius)) if radius != 0.0 => Ok([1.0 / (radius * radius), 0.0]),
        ("drift", k, _) => {
            let key = if k.is_some() { "k" } else { "radius" };
            wrong(key, true, "a drift has a length and nothing else")
        }
        ("quadrupole", _, radius) => {
            wrong("radius", radius.is_some(), "a quadrupole has a length and k")
        }
        ("dipole", Some(_), _) => wrong("k", true, DIPOLE),
        ("dipole", None, radius) => wrong("radius", radius.is_some(), DIPOLE),
        (other, ..) => {
            let refusal = Refusal::unknown("element", other, &["drift", "quadrupole", "dipole"]);
            Err(refusal.about(at.entry("kind")).into())
        }
    };
    let (strengths, length) = all!(made, length)?;
    let element = match (k, radius) {
        (Some(k), _) => Element::Quadrupole { length, k },
        (None, Some(radius)) => Element::Dipole { length, radius },
        (None, None) => Element::Drift { length },
    };
    Ok((element, strengths, length))
}

const DIPOLE: &str = "a dipole has a length and a radius that is not 0";

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let (cell, particle) = (keys.elements.and_then(cell), keys.particle);
    let ((elements, strengths), particle) = all!(cell, particle)?;
    Ok(Forms::of(BeamLine { elements, strengths, particle: particle.0 }))
}

/// Where each element ends, and (k_x, k_z) along it.
type Strengths = Vec<(f64, [f64; 2])>;

/// The elements, and where each of them ends with its strengths.
fn cell(keys: Vec<ElementKeys>) -> Result<(Vec<Element>, Strengths), ReadError> {
    let mut mistakes = ReadError::default();
    let (mut elements, mut strengths, mut end) = (Vec::new(), Vec::new(), 0.0);
    if keys.is_empty() {
        mistakes.add(Refusal::at("elements", "no elements, expected at least one"));
    }
    for (i, keys) in keys.into_iter().enumerate() {
        let made = element(&"elements".index(i), keys);
        if let Some((element, strength, length)) = mistakes.keep(made) {
            end += length;
            elements.push(element);
            strengths.push((end, strength));
        }
    }
    let (elements, strengths) = mistakes.or(Some((elements, strengths)))?;
    let not_finite = |_| Refusal::at("elements", "the map of a cell is not finite");
    transfer_map(&elements).map_err(not_finite)?;
    Ok((elements, strengths))
}

impl BeamLine {
    fn cell_length(&self) -> f64 {
        self.strengths.last().map_or(0.0, |(end, _)| *end)
    }
    /// The map from 0 to s: whole cells, and the elements of the last one up to s.
    fn map_to(&self, s: f64) -> Result<Mat<f64>, Error> {
        let length = self.cell_length();
        let cells = (s / length).floor();
        // The rest of the same cells: beside the end of a cell a remainder may be of another number of them.
        let (mut rest, mut begun) = ((s - cells * length).clamp(0.0, length), Vec::new());
        for element in &self.elements {
            let (Element::Drift { length }
            | Element::Quadrupole { length, .. }
            | Element::Dipole { length, .. }) = element
            else {
                continue;
            };
            let part = length.min(rest);
            begun.push(match *element {
                Element::Quadrupole { k, .. } => Element::Quadrupole { length: part, k },
                Element::Dipole { radius, .. } => Element::Dipole { length: part, radius },
                _ => Element::Drift { length: part },
            });
            rest -= part;
        }
        let cell = transfer_map(&self.elements)?.into_mat();
        let cell = if cells < 0.0 { inverse(&cell) } else { cell };
        let whole = power(cell, cells.abs() as u64);
        Ok(multiply(transfer_map(&begun)?.as_ref(), whole.as_ref()))
    }
    /// The coordinates of the particle where the map is g.
    fn particle(&self, g: &Mat<f64>, coordinates: [usize; 4]) -> [f64; 4] {
        coordinates.map(|i| (0..4).map(|j| g[(i, j)] * self.particle[j]).sum())
    }
    /// Where each element of a cell ends, and its strengths.
    fn ends_of(&self, cell: f64) -> impl Iterator<Item = (f64, [f64; 2])> {
        let start = cell * self.cell_length();
        self.strengths.iter().map(move |(end, strength)| (start + end, *strength))
    }
    /// (k_x, k_z) at s. They change exactly at the ends that the driver knows.
    fn strength(&self, s: f64) -> [f64; 2] {
        // The quotient may be rounded to the next cell.
        let cell = (s / self.cell_length()).floor();
        let mut ends = [cell - 1.0, cell, cell + 1.0].into_iter().flat_map(|i| self.ends_of(i));
        ends.find(|(end, _)| s < *end).map_or([0.0; 2], |(_, strength)| strength)
    }
}

/// −J gᵀJ.
fn inverse(g: &Mat<f64>) -> Mat<f64> {
    let sign = |i: usize, j: usize| if i / 2 == j / 2 { 1.0 } else { -1.0 };
    Mat::from_fn(4, 4, |i, j| sign(i, j) * g[((j + 2) % 4, (i + 2) % 4)])
}

impl System for BeamLine {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["map"];
    // Its points lie within a step, never on the jumps at its ends.
    const DEFAULT_METHOD: Option<&'static str> = Some("magnus6");
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "map",
            &["g11", "…", "g44"],
            "the transfer map from the start, row by row, of (x, z, x', z')",
            |_, _, g, row| row.extend(rows(g)),
        )
        .of_matrix("g", |_| [4, 4]),
        Q::numbers(
            "particle",
            &["x", "z", "x_slope", "z_slope"],
            "the particle",
            |line, _, g, row| row.extend(line.particle(g, [0, 1, 2, 3])),
        )
        .of_state(),
        Q::numbers(
            "phase_space",
            &["x", "x_slope", "z", "z_slope"],
            "the particle, plane by plane",
            |line, _, g, row| row.extend(line.particle(g, [0, 2, 1, 3])),
        )
        .of_state(),
        symplectic_defect(),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        let line = self.clone();
        let field = move |s: f64, v: &mut AlgebraMatrix| {
            v.fill(0.0);
            for (i, k) in line.strength(s).into_iter().enumerate() {
                (v[(i, i + 2)], v[(i + 2, i)]) = (1.0, -k);
            }
        };
        let (group, action) = (MatrixGroup::sp(4)?, MatrixAction::Translation);
        Ok((OnMatrices::linear(Flow::of_time(group, action, field), action), Mat::identity(4, 4)))
    }
    fn modelled(&self) -> String {
        "transfer map in Sp(4)".into()
    }
    /// Where elements end; over a span without an end one more than a run may have.
    fn knots(&self, [s0, s1]: [f64; 2]) -> Option<Stops> {
        let (from, to, length) = (s0.min(s1), s0.max(s1), self.cell_length());
        let first = if from.is_finite() { from / length } else { to / length - KNOTS_MAX as f64 };
        let cells = first.floor()..(to / length);
        let starts = (0..=KNOTS_MAX as u32)
            .map(|i| cells.start + f64::from(i))
            .take_while(|cell| *cell < cells.end);
        let ends = starts.flat_map(|cell| self.ends_of(cell)).map(|(end, _)| end);
        // One more than a run may have, which is refused.
        let counts = |s: &f64| from <= *s && *s <= to;
        Some(ends.filter(counts).take(KNOTS_MAX + 1).collect::<Vec<_>>().into())
    }
    fn exact(&self, [s0, s1]: [f64; 2]) -> Option<Result<Mat<f64>, Error>> {
        let both = self.map_to(s0).and_then(|to_start| Ok((to_start, self.map_to(s1)?)));
        Some(both.map(|(to_start, to_end)| multiply(to_end.as_ref(), inverse(&to_start).as_ref())))
    }
    fn figure(&self) -> Figure {
        Figure::Points("phase_space")
    }
    fn facts(&self) -> Vec<Property> {
        let Ok(cell) = transfer_map(&self.elements) else { return Vec::new() };
        let [x, z] = tunes(&cell);
        let trace = |i: usize| cell[(i, i)] + cell[(i + 2, i + 2)];
        let mut facts = vec![
            Property::of("cell_length", self.cell_length()),
            Property::of("trace_x", trace(0)),
            Property::of("trace_z", trace(1)),
            Property::answer("stable", x.is_some() && z.is_some()),
        ];
        facts.extend(x.map(|value| Property::of("tune_x", value)));
        facts.extend(z.map(|value| Property::of("tune_z", value)));
        facts
    }
}
