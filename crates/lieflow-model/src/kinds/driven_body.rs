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

use std::sync::Arc;

use lieflow::actions::LeftTranslation;
use lieflow::groups::{LieGroup, So3, vee};
use lieflow::problems::{BodyMotion, BodyTorque, Torque, TorqueBody};
use lieflow::scalar::Real;
use nalgebra::{Matrix3, Vector3};

use super::body::{ATTITUDE, ROTATION, attitude, by_rows};
use super::flow;
use super::prelude::*;
use crate::scene::formula::{Formula, Parameters, SamplesFile, read_all};
use crate::scene::values::{self, Rows, Texts};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "driven-body",
    equation: "m = Jω; ṁ = m × ω + gᵀ(e₃ × g weight) + thruster − damping ω − k (g − gᵀ)ᵛ/2 − c ω + torque + gᵀ torque_space, ġ = gω̂",
    summary: "a rigid body with its attitude under the torques that are named",
    ..Kind::of::<Keys, Driven>(read)
};

keys! { Keys {
    inertia: Reals<3> = "principal moments of inertia [J1, J2, J3]",
    omega_body: Reals<3> = "initial angular velocity in the body",
    attitude: Option<Rows<3>> = ATTITUDE,
    weight: Option<Reals<3>> =
        "gravity: weight times the vector from the fixed point to the centre of mass, in the body; optional",
    thruster: Option<Reals<3>> = "a constant torque in the body; optional",
    damping: Option<values::Real> = "c of a torque -c omega in the body; optional",
    control: Option<Reals<2>> = "[k, c] of a law that brings the attitude to the identity; optional",
    torque: Option<Texts<3>> =
        "a torque in the body, three formulas in t, the angular velocity in the body w1, w2, w3, the \
         momentum in space m1, m2, m3 and the attitude g11, ..., g33; optional",
    torque_space: Option<Texts<3>> = "a torque in space, three formulas in the same variables; optional",
    samples: Option<SamplesFile> = SAMPLES.meaning,
    interpolation: Option<String> = INTERPOLATION.meaning,
    #[serde(default)]
    parameters: Parameters = PARAMETERS.meaning,
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
struct Torques {
    weight: Option<Vector3<f64>>,
    thruster: Option<Vector3<f64>>,
    damping: Option<f64>,
    control: Option<[f64; 2]>,
    in_the_body: Option<Formulas>,
    in_space: Option<Formulas>,
}

impl<S: Real + Into<f64>> Torque<S> for Torques {
    fn in_space(&self, at: &BodyMotion<S>) -> Vector3<S> {
        let lit = |x: Vector3<f64>| x.map(S::lit);
        let g = &at.attitude;
        let damped = |c: f64| at.omega_body.map(|w| S::lit(-c) * w);
        let mut torque = lit(Vector3::zeros());
        let mut add = |other: Vector3<S>| {
            for i in 0..3 {
                torque[i] += other[i];
            }
        };
        if let Some(weight) = self.weight {
            let mut down = lit(weight);
            So3::new().apply(g, &lit(weight), &mut down);
            add(Vector3::new(-down[1], down[0], S::lit(0.0)));
        }
        if let Some(thruster) = self.thruster {
            add(BodyTorque(|_: &BodyMotion<S>| lit(thruster)).in_space(at));
        }
        if let Some(damping) = self.damping {
            add(BodyTorque(|_: &BodyMotion<S>| damped(damping)).in_space(at));
        }
        if let Some([stiffness, damping]) = self.control {
            let half = |i: usize, j: usize| S::lit(0.5) * (g[(i, j)] - g[(j, i)]);
            let away = Vector3::new(half(2, 1), half(0, 2), half(1, 0));
            let (k, slow) = (S::lit(-stiffness), damped(damping));
            let law = |_: &BodyMotion<S>| Vector3::from_fn(|i, _| k * away[i] + slow[i]);
            add(BodyTorque(law).in_space(at));
        }
        if let Some(formulas) = &self.in_the_body {
            add(BodyTorque(|at: &BodyMotion<S>| evaluated(formulas, at)).in_space(at));
        }
        if let Some(formulas) = &self.in_space {
            add(evaluated(formulas, at));
        }
        torque
    }
}

/// The body with its initial state (g, m_s).
#[derive(Clone, Debug)]
struct Driven {
    body: TorqueBody<Torques>,
    torques: Torques,
    start: Point,
}

type Q = Quantity<Driven>;

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let names = keys.parameters.names("torque", VARIABLES)?;
    let names = names.with_samples(keys.samples, keys.interpolation.as_deref())?;
    let formulas = |key: &str, texts: Option<Texts<3>>| match texts {
        Some(Texts(texts)) => read_all(key, &texts, &names).map(|formulas| Some(formulas.into())),
        None => Ok(None),
    };
    let torques = Torques {
        weight: keys.weight.map(|x| x.0.into()),
        thruster: keys.thruster.map(|x| x.0.into()),
        damping: keys.damping.map(|x| x.0),
        control: keys.control.map(|x| x.0),
        in_the_body: formulas("torque", keys.torque)?,
        in_space: formulas("torque_space", keys.torque_space)?,
    };
    let body = TorqueBody::new(keys.inertia.0, torques.clone())?;
    let start = body.state(attitude(keys.attitude), keys.omega_body.0)?;
    Ok(Box::new(Stated(Driven { body, torques, start })))
}

impl Driven {
    /// A law of the motion under gravity alone, or under no torque.
    fn undriven(&self, law: Law) -> Option<Law> {
        let Torques { weight: _, thruster, damping, control, in_the_body, in_space } =
            &self.torques;
        let formulas = in_the_body.is_some() || in_space.is_some();
        let driven = thruster.is_some() || damping.is_some() || control.is_some() || formulas;
        (!driven).then_some(law)
    }
}

impl System for Driven {
    type Problem<N: Number> = flow::Driven<N>;

    const STATE: &'static [&'static str] = &["attitude", "momentum_space"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "attitude",
            ROTATION,
            "rotation from body to space, row by row",
            |_, _, (g, _), row| by_rows(g, row),
        )
        .of_rotation(),
        Q::numbers(
            "momentum_space",
            &["l1", "l2", "l3"],
            "angular momentum in space",
            |_, _, (_, m), row| row.extend(m.iter()),
        ),
        Q::numbers(
            "omega_body",
            &["w1", "w2", "w3"],
            "angular velocity in the body",
            |driven, t, y, row| row.extend(driven.body.motion(t, y).omega_body.iter()),
        ),
        Q::numbers(
            "axis",
            &["a1", "a2", "a3"],
            "the third axis of the body, in space",
            |_, _, (g, _), row| row.extend(g.column(2).iter()),
        ),
        Q::number("energy", "kinetic energy, and that of the weight", |driven, _, y| {
            let height = driven.torques.weight.map_or(0.0, |weight| (y.0 * weight)[2]);
            driven.body.kinetic_energy(y) + height
        })
        .kept_where(|driven| driven.undriven(Law::by_the_flow(0)))
        .in_terms(|driven, y| {
            driven.body.kinetic_energy(y) + driven.torques.weight.map_or(0.0, |w| w.norm())
        }),
        // Exact near 0 and near π: the sine and the cosine.
        Q::number("angle", "angle of the attitude from the identity", |_, _, (g, _)| {
            let sine = vee(&((g - g.transpose()) * 0.5)).norm();
            sine.atan2(0.5 * (g.trace() - 1.0))
        }),
        Q::number("vertical_momentum", "angular momentum about e3 in space", |_, _, (_, m)| m[2])
            .kept_where(|driven| driven.undriven(Law::by_the_flow(1)))
            .in_terms(|_, (_, m)| m.norm()),
        Q::number("attitude_defect", "distance of g'g from the identity", |_, _, (g, _)| {
            So3::new().defect(g)
        })
        .kept(Law::by_the_action(2).on_scale(Scale::One)),
    ];

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem<N: Number>(&self) -> Result<Start<flow::Driven<N>>, Error> {
        let body = self.body.on::<N, _>(self.torques.clone());
        let start = (self.start.0.map(N::lit), self.start.1.map(N::lit));
        Ok((flow::Driven::new(body, LeftTranslation), start))
    }
    fn check_start(&self, t0: f64) -> Result<(), Refusal> {
        let at = variables(&self.body.motion(t0, &self.start));
        let Torques { in_the_body, in_space, .. } = &self.torques;
        for (key, torque) in [("torque", in_the_body), ("torque_space", in_space)] {
            for (i, formula) in torque.iter().flat_map(|formulas| formulas.iter()).enumerate() {
                formula.check(&format!("{key}[{i}]"), &at)?;
            }
        }
        Ok(())
    }
    fn samples(&self) -> Option<&Samples> {
        let Torques { in_the_body, in_space, .. } = &self.torques;
        in_the_body.as_ref().or(in_space.as_ref())?[0].samples()
    }
    fn modelled(&self) -> String {
        let Torques { weight, thruster, damping, control, in_the_body, in_space } = &self.torques;
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
        Some(PrincipalInertia::diagonal(self.body.inertia()))
    }
    fn figure(&self) -> Figure {
        match (&self.torques.control, &self.torques.in_the_body) {
            (None, None) => Figure::Sphere("axis"),
            _ => Figure::Lines("omega_body"),
        }
    }
}
