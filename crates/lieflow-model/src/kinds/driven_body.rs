//! `kind = "driven-body"`: a rigid body with its attitude under gravity, thrusters, damping, a control law
//! and torques in formulas, each only where the scene names it; see [`TorqueBody`].
//!
//! | key | torque | frame |
//! |---|---|---|
//! | `weight` | e₃ × gw | space |
//! | `thruster` | τ, constant | body |
//! | `damping` | −cω | body |
//! | `control` = \[k, c\] | −k ½(g − gᵀ)^∨ − cω, toward g = 𝟙 | body |
//! | `torque`, `torque_space` | formulas in t, ω, m_s and g | body, space |
//!
//! The body moves in the frame of its principal axes; torques are stated in the axes of the scene.

use std::sync::Arc;

use lieflow::actions::LeftTranslation;
use lieflow::groups::{LieGroup, So3};
use lieflow::problems::{BodyMotion, BodyTorque, Torque, TorqueBody};
use lieflow::scalar::{Counted, Real, Trig};
use lieflow_runs::spaces;
use nalgebra::{Matrix3, Vector3};

use super::body::*;
use super::prelude::*;
use crate::formula::{Formula, Names, Texts, without_value};
use crate::problem::{PointOf, Stops, Turned};
use crate::reader::values;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "driven-body",
    equation: "m = Jω; ṁ = m × ω + gᵀ(e₃ × g weight) + thruster − damping ω − k (g − gᵀ)ᵛ/2 − c ω + torque + gᵀ torque_space, ġ = gω̂",
    summary: "a rigid body with its attitude under the torques that are named",
    ..Kind::of::<Keys, Driven>(|section| read_with(section, read))
};

keys! { Keys [sample_keys formula_keys attitude_keys body_keys] {
    weight: Option<Reals<3>> [TORQUE] =
        "gravity: weight times the vector from the fixed point to the centre of mass, in the body; optional",
    thruster: Option<Reals<3>> [TORQUE] = "a constant torque in the body; optional",
    damping: Option<values::Real> [ANGULAR_MOMENTUM] = "c of a torque -c omega in the body; optional",
    control: Option<Reals<2>> = "[k, c] of a law that brings the attitude to the identity; optional",
    torque: Option<Texts> [TORQUE] =
        "a torque in the body, three formulas, or one whose value is a vector, in t, the angular velocity in the body \
         w1, w2, w3, the momentum in space m1, m2, m3 and the attitude g11, ..., g33; optional",
    torque_space: Option<Texts> [TORQUE] = "a torque in space, by formulas in the same variables; optional",
} }

/// What a torque may depend on, in the order of [`variables`].
#[rustfmt::skip]
const VARIABLES: [&str; 16] = [
    "t", "w1", "w2", "w3", "m1", "m2", "m3",
    "g11", "g12", "g13", "g21", "g22", "g23", "g31", "g32", "g33",
];

fn variables<S: Copy>(at: &BodyMotion<S>) -> [S; 16] {
    let (w, m, g) = (&at.omega_body, &at.momentum_space, &at.attitude);
    core::array::from_fn(|i| match i {
        0 => at.t,
        1..=3 => w[i - 1],
        4..=6 => m[i - 4],
        _ => g[((i - 7) / 3, (i - 7) % 3)],
    })
}

/// A torque in formulas, one for each component.
type Formulas = Arc<[Formula]>;

fn evaluated<S: Real + Into<f64>>(torque: &Formulas, at: &BodyMotion<S>) -> Vector3<S> {
    let variables = variables(at);
    Vector3::from_fn(|i, _| torque[i].value(&variables))
}

type Point = (Matrix3<f64>, Vector3<f64>);

/// The torques that were named.
#[derive(Clone, Debug, Default)]
pub(super) struct Torques {
    /// The principal axes in the frame of the scene, where that is another.
    axes: Option<Matrix3<f64>>,
    weight: Option<Vector3<f64>>,
    thruster: Option<Vector3<f64>>,
    damping: Option<f64>,
    control: Option<[f64; 2]>,
    in_the_body: Option<Formulas>,
    in_space: Option<Formulas>,
}

impl Torques {
    /// Gravity alone, along the axes of the body.
    pub(super) fn of_weight(weight: Vector3<f64>) -> Self {
        Torques { weight: Some(weight), ..Torques::default() }
    }

    /// The motion along the axes of the scene.
    fn in_scene<S: Real>(&self, at: &BodyMotion<S>) -> BodyMotion<S> {
        let Some(axes) = self.axes else { return *at };
        let sum = |of: &dyn Fn(usize) -> S| of(0) + of(1) + of(2);
        let (g, w) = (&at.attitude, &at.omega_body);
        let attitude = Matrix3::from_fn(|i, j| sum(&|k| g[(i, k)] * S::lit(axes[(j, k)])));
        let omega_body = Vector3::from_fn(|i, _| sum(&|k| S::lit(axes[(i, k)]) * w[k]));
        BodyMotion { attitude, omega_body, ..*at }
    }

    /// Is there none, or only one that is 0 at all times?
    fn are_none(&self) -> bool {
        let Torques { weight, thruster, damping, control, .. } = self;
        let vectors = weight.iter().chain(thruster).flat_map(|x| x.iter());
        let numbers = vectors.chain(damping).chain(control.iter().flatten());
        numbers.copied().all(|x| x == 0.0) && self.formulas().all(Formula::is_zero)
    }

    /// All formulas.
    fn formulas(&self) -> impl Iterator<Item = &Formula> {
        let of_both = self.in_the_body.iter().chain(&self.in_space);
        of_both.flat_map(|formulas| formulas.iter())
    }

    /// The sum of the torques that are stated in space, and of those that are stated in the body, along the axes of the
    /// scene. None where no torque is stated in a frame.
    fn stated<S: Real + Into<f64>>(&self, at: &BodyMotion<S>) -> [Option<Vector3<S>>; 2] {
        let lit = |x: Vector3<f64>| x.map(S::lit);
        let g = &at.attitude;
        let damped = |c: f64| at.omega_body.map(|w| S::lit(-c) * w);
        let weight = self.weight.map(|weight| {
            let mut down = lit(weight);
            So3::new().apply(g, &lit(weight), &mut down);
            Vector3::new(-down[1], down[0], S::lit(0.0))
        });
        let control = self.control.map(|[stiffness, damping]| {
            let half = |i: usize, j: usize| S::lit(0.5) * (g[(i, j)] - g[(j, i)]);
            let away = Vector3::new(half(2, 1), half(0, 2), half(1, 0));
            let (k, slow) = (S::lit(-stiffness), damped(damping));
            Vector3::from_fn(|i, _| k * away[i] + slow[i])
        });
        let value = |formulas: &Option<Formulas>| Some(evaluated(formulas.as_ref()?, at));
        let in_the_body =
            [self.thruster.map(lit), self.damping.map(damped), control, value(&self.in_the_body)];
        let in_space = [weight, value(&self.in_space)];
        [sum(&in_space), sum(&in_the_body)]
    }
}

/// The sum of the torques that are there.
fn sum<S: Real>(torques: &[Option<Vector3<S>>]) -> Option<Vector3<S>> {
    torques.iter().flatten().copied().reduce(|a, b| Vector3::from_fn(|i, _| a[i] + b[i]))
}

impl<S: Real + Into<f64>> Torque<S> for Torques {
    fn in_space(&self, at: &BodyMotion<S>) -> Vector3<S> {
        let at = &self.in_scene(at);
        let [in_space, in_the_body] = self.stated(at);
        let turned = in_the_body.map(|torque| BodyTorque(|_: &BodyMotion<S>| torque).in_space(at));
        sum(&[in_space, turned]).unwrap_or_else(|| Vector3::from_element(S::lit(0.0)))
    }
}

/// The body with its initial state (g, m_s).
#[derive(Clone, Debug)]
struct Driven {
    spec: RigidBodySpec,
    body: TorqueBody<Torques>,
    torques: Torques,
    start: Point,
    /// A formula of the samples, where no torque is one.
    samples: Option<Formula>,
}

type Q = Quantity<Driven>;

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let spec = keys.body_keys().start(&keys.attitude_keys(), Matrix3::identity());
    let names = keys.formula_keys().names("torque", VARIABLES, keys.sample_keys());
    let formulas = |key: &str, texts: Key<Option<Texts>>| -> Result<Option<Formulas>, ReadError> {
        let Some(texts) = texts? else { return Ok(None) };
        Ok(Some(texts.read_by(key, Some(3), seen(&names))?.into()))
    };
    let Keys { weight, thruster, damping, control, torque, torque_space, .. } = keys;
    let in_the_body = formulas("torque", torque);
    let in_space = formulas("torque_space", torque_space);
    let names = names.and_then(Names::checked);
    let (spec, names, weight, thruster, damping, control, in_the_body, in_space) =
        all!(spec, names, weight, thruster, damping, control, in_the_body, in_space)?;
    let torques = Torques {
        axes: spec.axes,
        weight: weight.map(|x| x.0.into()),
        thruster: thruster.map(|x| x.0.into()),
        damping: damping.map(|x| x.0),
        control: control.map(|x| x.0),
        in_the_body,
        in_space,
    };
    let body = TorqueBody::new(spec.inertia, torques.clone())?;
    let start = (spec.attitude, spec.momentum_space());
    let samples = Formula::of_samples(&names);
    let forms = Forms::of(Driven { spec, body, torques: torques.clone(), start, samples });
    Ok(match torques.are_none() {
        true => forms,
        false => forms.written(&["attitude", "momentum_space", "omega_body", "torque"]),
    })
}

impl Oriented for Driven {
    fn orientation(&self, (g, _): &Point) -> Orientation {
        Orientation::Matrix(*g)
    }
    fn turning(&self, _: f64, y: &Point) -> Vector3<f64> {
        self.omega(y)
    }
    fn axes(&self) -> Option<Matrix3<f64>> {
        self.spec.axes
    }
}

/// The attitude and the momentum in space, with the axes of the body turned by this rotation.
pub(super) fn turned((g, m): &Point, turn: &Matrix3<f64>) -> Point {
    (g * turn.transpose(), *m)
}

impl AsBody for Driven {
    fn momentum(&self, (g, m): &Point) -> Vector3<f64> {
        g.tr_mul(m)
    }
    fn omega(&self, y: &Point) -> Vector3<f64> {
        self.body.motion(0.0, y).omega_body
    }
    fn momentum_in_space(&self, (_, m): &Point) -> Vector3<f64> {
        *m
    }
}

impl Driven {
    /// The sum of the torques in the body, along the axes of the scene.
    fn torque(&self, t: f64, y: &Point) -> Vector3<f64> {
        let at = &self.torques.in_scene(&self.body.motion(t, y));
        // What is stated in the body does not go through space: a small component has its own digits.
        let [in_space, in_the_body] = self.torques.stated(at);
        let turned = in_space.map(|torque| at.attitude.tr_mul(&torque));
        sum(&[turned, in_the_body]).unwrap_or_default()
    }
    /// A law of the motion under gravity alone, or under no torque.
    fn undriven(&self, law: Law) -> Option<Law> {
        let Torques { axes: _, weight: _, thruster, damping, control, in_the_body, in_space } =
            &self.torques;
        let formulas = in_the_body.is_some() || in_space.is_some();
        let driven = thruster.is_some() || damping.is_some() || control.is_some() || formulas;
        (!driven).then_some(law)
    }
}

/// The body on these numbers.
pub(super) fn on<S: Trig + Into<f64> + 'static>(
    body: &TorqueBody<Torques>,
    torques: &Torques,
) -> spaces::Driven<S> {
    spaces::Driven::new(body.on(torques.clone()), LeftTranslation)
}

impl System for Driven {
    type Problem = spaces::Driven;

    const STATE: &'static [&'static str] = &["attitude", "momentum_space"];
    const QUANTITIES: &'static [Q] = with_angles![
        attitude(),
        quaternion(),
        momentum_space(),
        // m1, m2, m3 of formulas are the momentum in space.
        momentum_body(&["mb1", "mb2", "mb3"]),
        omega_body(),
        omega_space(),
        Q::numbers(
            "torque",
            &["torque1", "torque2", "torque3"],
            "the sum of the torques, in the body",
            |driven, at, y, row| row.extend(driven.torque(at.t, y).iter()),
        )
        .of_dimension(Dimension::ENERGY),
        axis(),
        nutation(),
        Q::number("energy", "kinetic energy, and that of the weight", |driven, _, y| {
            let height = driven.torques.weight.map_or(0.0, |w| (driven.attitude(y) * w)[2]);
            driven.body.kinetic_energy(y) + height
        })
        .of_dimension(Dimension::ENERGY)
        .kept_where(|driven| driven.undriven(Law::by_the_flow(0)))
        .in_terms(|driven, y| {
            driven.body.kinetic_energy(y) + driven.torques.weight.map_or(0.0, |w| length(&w))
        }),
        angle(),
        momentum_norm(),
        Q::number("vertical_momentum", "angular momentum about e3 in space", |_, _, (_, m)| m[2])
            .of_dimension(Dimension::ANGULAR_MOMENTUM)
            .kept_where(|driven| driven.undriven(Law::by_the_flow(1)))
            .in_terms(|_, (_, m)| length(m)),
        attitude_defect(),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn axes_of_points(&self) -> Option<(Matrix3<f64>, Turned<Self>)> {
        Some((self.spec.axes?, |_, y, turn| turned(y, turn)))
    }
    fn problem(&self) -> Result<Start<spaces::Driven>, Error> {
        Ok((on(&self.body, &self.torques), self.start))
    }
    fn counted(&self) -> Option<Counting> {
        let start = (self.start.0.map(Counted), self.start.1.map(Counted));
        counting(on(&self.body, &self.torques), start)
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        let at = variables(&self.torques.in_scene(&self.body.motion(t0, &self.start)));
        without_value(self.torques.formulas(), &at)
    }
    fn formula(&self) -> Option<&Formula> {
        self.torques.formulas().next().or(self.samples.as_ref())
    }
    /// Those of samples that a torque may depend on.
    fn knots(&self, t_span: [f64; 2]) -> Option<Stops> {
        let samples = self.torques.formulas().next()?.samples()?;
        Some(Stops::at_knots(samples, t_span))
    }
    /// Without a torque: that of the free body.
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<PointOf<Self>, Error>> {
        let at = |t: f64| Ok((self.spec.exact()?.state(t)?.1, self.start.1));
        self.torques.are_none().then(|| at(t1 - t0))
    }
    fn warnings(&self) -> Vec<String> {
        self.spec.impossible()
    }
    fn notes(&self) -> Vec<String> {
        self.spec.notes.clone()
    }
    fn modelled(&self) -> String {
        let Torques { axes: _, weight, thruster, damping, control, in_the_body, in_space } =
            &self.torques;
        let named = [
            ("gravity", weight.is_some()),
            ("thruster", thruster.is_some()),
            ("damping", damping.is_some()),
            ("control", control.is_some()),
            ("formulas in the body", in_the_body.is_some()),
            ("formulas in space", in_space.is_some()),
        ];
        let named = named.iter().filter(|(_, named)| *named).map(|(name, _)| *name);
        let torques: Vec<_> = named.collect();
        match torques.is_empty() {
            true => "attitude and momentum in space, no torque".into(),
            false => format!("attitude and momentum in space; torques: {}", torques.join(", ")),
        }
    }
    fn inertia(&self) -> Option<PrincipalInertia> {
        Some(self.spec.principal_inertia())
    }
    fn rate(&self) -> Option<f64> {
        Some(self.spec.rate())
    }
    fn figure(&self) -> Figure {
        match (&self.torques.control, &self.torques.in_the_body) {
            (None, None) => Figure::Sphere("axis"),
            _ => Figure::Lines("omega_body"),
        }
    }
}
