//! `kind = "driven-body"`: a rigid body with its attitude under gravity, thrusters, damping and a control
//! law, each only where the scene names it; see [`TorqueBody`].
//!
//! | key | torque | frame |
//! |---|---|---|
//! | `weight` | e₃ × gw | space |
//! | `thruster` | τ, constant | body |
//! | `damping` | −cω | body |
//! | `control` = \[k, c\] | −k ½(g − gᵀ)^∨ − cω, toward g = 𝟙 | body |

use lieflow::Error;
use lieflow::actions::LeftTranslation;
use lieflow::catalog::MethodSpec;
use lieflow::groups::{LieGroup, Product, So3, Translations, vee};
use lieflow::problems::{BodyTorque, Motion, Torque, TorqueBody};
use lieflow::scalar::Counted;
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::flow::Flow;
use super::system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::ReadError;
use crate::scene::values::{Real, Reals, Rows};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "driven-body",
    equation: "m = Jω; ṁ = m × ω + gᵀ(e₃ × g weight) + thruster − damping ω − k (g − gᵀ)ᵛ/2 − c ω, ġ = gω̂",
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
    ],
    quantities: &[
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
    ],
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
    damping: Option<Real>,
    control: Option<Reals<2>>,
}

type Point = (Matrix3<f64>, Vector3<f64>);

/// The torques that were named.
#[derive(Clone, Copy, Debug, Default)]
struct Torques {
    weight: Option<Vector3<f64>>,
    thruster: Option<Vector3<f64>>,
    damping: Option<f64>,
    control: Option<[f64; 2]>,
}

impl<S: lieflow::scalar::Real> Torque<S> for Torques {
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
    let torques = Torques {
        weight: keys.weight.map(|x| x.0.into()),
        thruster: keys.thruster.map(|x| x.0.into()),
        damping: keys.damping.map(|x| x.0),
        control: keys.control.map(|x| x.0),
    };
    let attitude = keys.attitude.map_or_else(Matrix3::identity, |rows| {
        Matrix3::from_rows(&rows.0.map(|row| Vector3::from(row).transpose()))
    });
    let body = TorqueBody::new(keys.inertia.0, torques)?;
    let start = body.state(attitude, keys.omega_body.0)?;
    Ok(Box::new(Driven { body, torques, start }))
}

impl Driven {
    /// Is gravity the only torque, or none?
    fn is_conservative(&self) -> bool {
        let Torques { thruster, damping, control, .. } = self.torques;
        thruster.is_none() && damping.is_none() && control.is_none()
    }
    fn energy(&self, y: &Point) -> f64 {
        let height = self.torques.weight.map_or(0.0, |weight| (y.0 * weight)[2]);
        self.body.kinetic_energy(y) + height
    }
}

impl System for Driven {
    type Problem = Flow<Product<So3, Translations<Vector3<f64>>>, LeftTranslation>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Point), Error> {
        Ok(Flow::nonlinear(self.body.clone(), LeftTranslation, self.start))
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let start = (self.start.0.map(Counted), self.start.1.map(Counted));
        let body = self.body.on::<Counted, _>(self.torques);
        let (flow, start) = Flow::nonlinear(body, LeftTranslation, start);
        operations_by(method, &flow, start, pace)
    }
    fn modelled(&self) -> String {
        let Torques { weight, thruster, damping, control } = self.torques;
        let named = [
            ("gravity", weight.is_some()),
            ("thruster", thruster.is_some()),
            ("damping", damping.is_some()),
            ("control", control.is_some()),
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
        match self.torques.control {
            Some(_) => Figure::Lines("omega_body"),
            None => Figure::Sphere("axis"),
        }
    }
}
