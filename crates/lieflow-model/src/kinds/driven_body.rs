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

use lieflow::Error;
use lieflow::actions::LeftTranslation;
use lieflow::catalog::MethodSpec;
use lieflow::groups::{LieGroup, So3, vee};
use lieflow::problems::{BodyTorque, Motion, Torque, TorqueBody};
use lieflow::scalar::{Counted, Real};
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::flow;
use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, PARAMETERS, ProblemSpec, QuantityInfo, Scale};
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::formula::{Formula, Parameters, read_all};
use crate::scene::values::{self, Reals, Rows, Texts};
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "driven-body",
    equation: "m = Jω; ṁ = m × ω + gᵀ(e₃ × g weight) + thruster − damping ω − k (g − gᵀ)ᵛ/2 − c ω + torque + gᵀ torque_space, ġ = gω̂",
    summary: "a rigid body with its attitude under the torques that are named",
    keys: &[
        KeyInfo { name: "inertia", meaning: "principal moments of inertia [J1, J2, J3]" },
        KeyInfo { name: "omega_body", meaning: "initial angular velocity in the body" },
        KeyInfo {
            name: "attitude",
            meaning: "initial rotation from body to space, three rows; optional, the identity",
        },
        KeyInfo {
            name: "weight",
            meaning: "gravity: weight times the vector from the fixed point to the centre of mass, in \
                      the body; optional",
        },
        KeyInfo { name: "thruster", meaning: "a constant torque in the body; optional" },
        KeyInfo { name: "damping", meaning: "c of a torque -c omega in the body; optional" },
        KeyInfo {
            name: "control",
            meaning: "[k, c] of a law that brings the attitude to the identity; optional",
        },
        KeyInfo {
            name: "torque",
            meaning: "a torque in the body, three formulas in t, the angular velocity in the body w1, w2, \
                      w3, the momentum in space m1, m2, m3 and the attitude g11, ..., g33; optional",
        },
        KeyInfo {
            name: "torque_space",
            meaning: "a torque in space, three formulas in the same variables; optional",
        },
        PARAMETERS,
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "attitude",
                columns: &["g11", "g12", "g13", "g21", "g22", "g23", "g31", "g32", "g33"],
                meaning: "rotation from body to space, row by row",
            },
            QuantityInfo {
                name: "momentum_space",
                columns: &["l1", "l2", "l3"],
                meaning: "angular momentum in space",
            },
            QuantityInfo {
                name: "omega_body",
                columns: &["w1", "w2", "w3"],
                meaning: "angular velocity in the body",
            },
            QuantityInfo {
                name: "axis",
                columns: &["a1", "a2", "a3"],
                meaning: "the third axis of the body, in space",
            },
            QuantityInfo {
                name: "energy",
                columns: &["energy"],
                meaning: "kinetic energy, and that of the weight",
            },
            QuantityInfo {
                name: "angle",
                columns: &["angle"],
                meaning: "angle of the attitude from the identity",
            },
            QuantityInfo {
                name: "vertical_momentum",
                columns: &["vertical_momentum"],
                meaning: "angular momentum about e3 in space",
            },
            QuantityInfo {
                name: "attitude_defect",
                columns: &["attitude_defect"],
                meaning: "distance of g'g from the identity",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    inertia: Reals<3>,
    omega_body: Reals<3>,
    attitude: Option<Rows<3>>,
    weight: Option<Reals<3>>,
    thruster: Option<Reals<3>>,
    damping: Option<values::Real>,
    control: Option<Reals<2>>,
    torque: Option<Texts<3>>,
    torque_space: Option<Texts<3>>,
    #[serde(default)]
    parameters: Parameters,
}

/// What a torque may depend on, in the order of [`variables`].
#[rustfmt::skip]
const VARIABLES: [&str; 16] = [
    "t", "w1", "w2", "w3", "m1", "m2", "m3",
    "g11", "g12", "g13", "g21", "g22", "g23", "g31", "g32", "g33",
];

fn variables<S: Copy>(at: &Motion<S>) -> [S; 16] {
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

fn evaluated<S: Real + Into<f64>>(torque: &Formulas, at: &Motion<S>) -> Vector3<S> {
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
    fn in_space(&self, at: &Motion<S>) -> Vector3<S> {
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
            add(BodyTorque(|_: &Motion<S>| lit(thruster)).in_space(at));
        }
        if let Some(damping) = self.damping {
            add(BodyTorque(|_: &Motion<S>| damped(damping)).in_space(at));
        }
        if let Some([stiffness, damping]) = self.control {
            let half = |i: usize, j: usize| S::lit(0.5) * (g[(i, j)] - g[(j, i)]);
            let away = Vector3::new(half(2, 1), half(0, 2), half(1, 0));
            let (k, slow) = (S::lit(-stiffness), damped(damping));
            let law = |_: &Motion<S>| Vector3::from_fn(|i, _| k * away[i] + slow[i]);
            add(BodyTorque(law).in_space(at));
        }
        if let Some(formulas) = &self.in_the_body {
            add(BodyTorque(|at: &Motion<S>| evaluated(formulas, at)).in_space(at));
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

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let names = keys.parameters.names("torque", VARIABLES)?;
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
    let attitude = keys.attitude.map_or_else(Matrix3::identity, |rows| {
        Matrix3::from_rows(&rows.0.map(|row| Vector3::from(row).transpose()))
    });
    let body = TorqueBody::new(keys.inertia.0, torques.clone())?;
    let start = body.state(attitude, keys.omega_body.0)?;
    Ok(Box::new(Driven { body, torques, start }))
}

impl Driven {
    /// Is gravity the only torque, or none?
    fn is_conservative(&self) -> bool {
        let Torques { weight: _, thruster, damping, control, in_the_body, in_space } =
            &self.torques;
        let formulas = in_the_body.is_some() || in_space.is_some();
        thruster.is_none() && damping.is_none() && control.is_none() && !formulas
    }
    fn energy(&self, y: &Point) -> f64 {
        let height = self.torques.weight.map_or(0.0, |weight| (y.0 * weight)[2]);
        self.body.kinetic_energy(y) + height
    }
}

impl System for Driven {
    type Problem = flow::Driven<f64>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Point), Error> {
        Ok((flow::Driven::new(self.body.clone(), LeftTranslation), self.start))
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let start = (self.start.0.map(Counted), self.start.1.map(Counted));
        let body = self.body.on::<Counted, _>(self.torques.clone());
        let (flow, start) = (flow::Driven::new(body, LeftTranslation), start);
        operations_by(method, &flow, start, pace)
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
    fn state(&self) -> &'static [&'static str] {
        &["attitude", "momentum_space"]
    }
    fn laws(&self) -> Vec<Law> {
        let mut laws = vec![Law::of_the_action("attitude_defect", 2).on_scale(Scale::One)];
        if self.is_conservative() {
            laws.push(Law::of_the_flow("energy", 0).on_scale(Scale::Terms));
            laws.push(Law::of_the_flow("vertical_momentum", 1).on_scale(Scale::Terms));
        }
        laws
    }
    fn show(&self, quantity: &str, t: f64, y: &Point, row: &mut Vec<f64>) {
        let (g, m) = y;
        match quantity {
            "attitude" => row.extend(g.transpose().iter()),
            "momentum_space" => row.extend(m.iter()),
            "omega_body" => row.extend(self.body.motion(t, y).omega_body.iter()),
            "axis" => row.extend(g.column(2).iter()),
            "energy" => row.push(self.energy(y)),
            // Exact near 0 and near π: the sine and the cosine.
            "angle" => {
                let sine = vee(&((g - g.transpose()) * 0.5)).norm();
                row.push(sine.atan2(0.5 * (g.trace() - 1.0)));
            }
            "vertical_momentum" => row.push(m[2]),
            _ => row.push(So3::new().defect(g)),
        }
    }
    fn size(&self, quantity: &str, y: &Point) -> f64 {
        match quantity {
            "energy" => self.body.kinetic_energy(y) + self.torques.weight.map_or(0.0, |w| w.norm()),
            _ => y.1.norm(),
        }
    }
    fn figure(&self) -> Figure {
        match (&self.torques.control, &self.torques.in_the_body) {
            (None, None) => Figure::Sphere("axis"),
            _ => Figure::Lines("omega_body"),
        }
    }
}
