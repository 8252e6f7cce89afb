//! `kind = "rigid-motion"`: a frame that moves in space by a twist in formulas, on SE(3). A point p of the frame is at gp + x.
//!
//! | `frame` | ġ | ẋ |
//! |---|---|---|
//! | `"body"` | g ω̂ | g v |
//! | `"space"` | ω̂ g | ω × x + v |

use std::sync::Arc;

use lieflow::actions::Translation;
use lieflow::groups::{LieGroup, Se3, So3};
use lieflow::problems::Flow;
use lieflow::scalar::{Counted, Trig};
use lieflow_runs::spaces;
use nalgebra::{Matrix3, Vector3};

use super::body::{Orientation, Oriented, attitude_keys, quaternion, with_angles};
use super::prelude::*;
use crate::formula::{Formula, Names, Texts, without_value};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-motion",
    equation: "ġ = g ω̂, ẋ = g v of a twist in the body; ġ = ω̂ g, ẋ = ω × x + v of one in space",
    summary: "a vehicle or a tool that moves in space by its twist, by formulas",
    ..Kind::of::<Keys, Motion>(|section| read_with(section, read))
};

keys! { Keys [sample_keys formula_keys attitude_keys] {
    omega: Texts [RATE] =
        "the angular velocity: three formulas, or one whose value is a vector, in t, the attitude g11, ..., g33 and the \
         position x1, x2, x3",
    velocity: Texts [VELOCITY] =
        "the velocity, by formulas in the same variables: that of the origin of the body; with frame = \"space\" that of \
         the point of the body at the origin of space",
    frame: Option<String> =
        "the axes of omega and velocity: \"body\" or \"space\"; optional, \"body\"",
    position: Option<Reals<3>> [LENGTH] = "initial position; optional, the origin",
} }

/// What a twist may depend on.
#[rustfmt::skip]
const VARIABLES: [&str; 13] = [
    "t", "g11", "g12", "g13", "g21", "g22", "g23", "g31", "g32", "g33", "x1", "x2", "x3",
];

/// A rotation and a position.
type Pose<S = f64> = (Matrix3<S>, Vector3<S>);

fn variables<S: Copy>(t: S, (g, x): &Pose<S>) -> [S; 13] {
    core::array::from_fn(|i| match i {
        0 => t,
        1..=9 => g[((i - 1) / 3, (i - 1) % 3)],
        _ => x[i - 10],
    })
}

/// The motion with its start.
#[derive(Clone, Debug)]
struct Motion {
    /// ω and v.
    twist: Arc<[Formula]>,
    in_body: bool,
    start: Pose,
    /// Changes that were made to numbers of the scene.
    notes: Vec<String>,
}

type Q = Quantity<Motion>;

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let names = keys.formula_keys().names("omega", VARIABLES, keys.sample_keys());
    let formulas = |key: &str, texts: Key<Texts>| texts?.read_by(key, Some(3), seen(&names));
    let mut notes = Vec::new();
    let attitude = keys.attitude_keys().orientation(Matrix3::identity(), &mut notes);
    let Keys { omega, velocity, frame, position, .. } = keys;
    let (omega, velocity) = (formulas("omega", omega), formulas("velocity", velocity));
    let names = names.and_then(Names::checked);
    let in_body = frame.and_then(|frame| match frame.as_deref() {
        None | Some("body") => Ok(true),
        Some("space") => Ok(false),
        Some(other) => Err(Refusal::unknown("frame", other, &["body", "space"]).into()),
    });
    let (omega, velocity, _, in_body, (attitude, _), position) =
        all!(omega, velocity, names, in_body, attitude, position)?;
    let position = position.map_or_else(Vector3::zeros, |x| x.0.into());
    let twist = omega.into_iter().chain(velocity).collect();
    Ok(Forms::of(Motion { twist, in_body, start: (attitude, position), notes }))
}

impl Motion {
    /// The problem on these numbers.
    fn on<S: Trig + Into<f64> + 'static>(&self) -> spaces::Motion<S> {
        let in_body = self.in_body;
        let side = if in_body { Translation::Right } else { Translation::Left };
        let twist = self.twist.clone();
        let field = move |t: S, y: &Pose<S>, v: &mut (Vector3<S>, Vector3<S>)| {
            let at = variables(t, y);
            v.0 = Vector3::from_fn(|i, _| twist[i].value(&at));
            v.1 = Vector3::from_fn(|i, _| twist[3 + i].value(&at));
            if in_body {
                *v = (-v.0, -v.1);
            }
        };
        let flow = Flow::new(Se3::new(), side, field);
        let of_time = !(1..VARIABLES.len()).any(|i| self.twist.iter().any(|f| f.uses(i)));
        match of_time {
            true => spaces::Motion::linear(flow.linear(), side),
            false => spaces::Motion::new(flow, side),
        }
    }

    /// Three numbers of the twist, from the first on.
    fn part(&self, first: usize, t: f64, y: &Pose, row: &mut Vec<f64>) {
        let at = variables(t, y);
        row.extend(self.twist[first..first + 3].iter().map(|formula| formula.value(&at)));
    }
}

impl Oriented for Motion {
    fn orientation(&self, (g, _): &Pose) -> Orientation {
        Orientation::Matrix(*g)
    }
    fn turning(&self, t: f64, y: &Pose) -> Vector3<f64> {
        let at = variables(t, y);
        let omega = Vector3::from_fn(|i, _| self.twist[i].value(&at));
        if self.in_body { omega } else { y.0.tr_mul(&omega) }
    }
}

impl System for Motion {
    type Problem = spaces::Motion;

    const STATE: &'static [&'static str] = &["position", "attitude"];
    const QUANTITIES: &'static [Q] = with_angles![
        Q::numbers(
            "position",
            &["x1", "x2", "x3"],
            "position of the origin of the body",
            |_, _, (_, x), row| {
                row.extend(x.iter());
            }
        )
        .of_dimension(Dimension::LENGTH),
        Q::numbers(
            "attitude",
            &["g11", "g12", "g13", "g21", "g22", "g23", "g31", "g32", "g33"],
            "rotation from body to space, row by row",
            |_, _, (g, _), row| row.extend(g.transpose().iter()),
        )
        .of_rotation()
        .drawn_as("quaternion"),
        quaternion(),
        Q::numbers(
            "omega",
            &["w1", "w2", "w3"],
            "angular velocity, in the axes of the scene's twist",
            |motion, at, y, row| motion.part(0, at.t, y, row),
        )
        .of_dimension(Dimension::RATE),
        Q::numbers(
            "velocity",
            &["v1", "v2", "v3"],
            "velocity, in the axes of the scene's twist",
            |motion, at, y, row| motion.part(3, at.t, y, row),
        )
        .of_dimension(Dimension::VELOCITY),
        Q::number("attitude_defect", "distance of g'g from the identity", |_, _, (g, _)| {
            So3::new().defect(g)
        })
        .kept(Law::by_the_action(2).on_scale(Scale::One))
        .of_distance(),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<spaces::Motion>, Error> {
        Ok((self.on(), self.start))
    }
    fn counted(&self) -> Option<Counting> {
        let (g, x) = self.start;
        counting(self.on(), (g.map(Counted), x.map(Counted)))
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        without_value(self.twist.iter(), &variables(t0, &self.start))
    }
    fn formula(&self) -> Option<&Formula> {
        self.twist.first()
    }
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
    fn modelled(&self) -> String {
        let frame = if self.in_body { "the body" } else { "space" };
        format!("attitude and position on SE(3), by a twist in {frame}")
    }
    fn figure(&self) -> Figure {
        Figure::Space("position")
    }
}
