//! `kind = "rigid-bodies"`: many free rigid bodies as one system, by their momenta on so(3)* × … × so(3)*.
//!
//! f_i = −J_i⁻¹m_i; Λ = SO(3)ᴺ on vectors, which on so(3)* is the coadjoint action. Invariants: the energy
//! and |m| of each.

use lieflow::Error;
use lieflow::actions::Linear;
use lieflow::catalog::MethodSpec;
use lieflow::groups::{Power, So3};
use lieflow::problems::{Euler, Exact, Kinetic, RigidBody};
use lieflow::scalar::{Counted, Real};
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo};
use crate::kinds::flow::OnSpheres;
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::values::Reals;
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-bodies",
    equation: "ṁᵢ = mᵢ × Jᵢ⁻¹mᵢ, each in its body",
    summary: "many free rigid bodies as one system, by their momenta",
    keys: &[KeyInfo {
        name: "bodies",
        meaning: "a list of {inertia = [J1, J2, J3], momentum_body = [m1, m2, m3]}",
    }],
    quantities: || {
        vec![
            QuantityInfo {
                name: "momentum_body",
                columns: &["m1_1", "m1_2", "m1_3", "…", "mN_3"],
                meaning: "angular momenta in the bodies, one after the other",
            },
            QuantityInfo {
                name: "energy",
                columns: &["energy1", "…", "energyN"],
                meaning: "kinetic energy of each",
            },
            QuantityInfo {
                name: "momentum_norm",
                columns: &["norm1", "…", "normN"],
                meaning: "length of the angular momentum of each",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    bodies: Vec<BodyKeys>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyKeys {
    inertia: Reals<3>,
    momentum_body: Reals<3>,
}

type Momenta<S = f64> = Box<[Vector3<S>]>;

/// The bodies with their initial momenta.
#[derive(Clone, Debug)]
struct Bodies {
    bodies: Vec<([f64; 3], RigidBody)>,
    start: Momenta,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    if keys.bodies.is_empty() {
        return Err(Refusal::at("bodies", "no bodies, expected at least one").into());
    }
    let body = |(i, keys): (usize, &BodyKeys)| match RigidBody::new(keys.inertia.0) {
        Ok(body) => Ok((keys.inertia.0, body)),
        Err(error) => Err(Refusal::at(format!("bodies[{i}]"), error.to_string())),
    };
    let bodies = keys.bodies.iter().enumerate().map(body).collect::<Result<_, _>>()?;
    let start = keys.bodies.iter().map(|keys| keys.momentum_body.0.into()).collect();
    Ok(Box::new(Bodies { bodies, start }))
}

fn flow<S: Real>(bodies: Vec<RigidBody<S>>, start: &Momenta<S>) -> Result<OnSpheres<S>, Error> {
    let group = Power::new(So3::new(), bodies.len())?;
    let omega = move |m: &Momenta<S>, xi: &mut Momenta<S>| {
        for ((body, m), xi) in bodies.iter().zip(m).zip(xi) {
            *xi = body.omega(m);
        }
    };
    Ok((OnSpheres::lie_poisson(Euler::new(group, Kinetic(omega)), Linear), start.clone()).0)
}

impl System for Bodies {
    type Problem = OnSpheres<f64>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Momenta), Error> {
        let bodies = self.bodies.iter().map(|(_, body)| *body).collect();
        Ok((flow(bodies, &self.start)?, self.start.clone()))
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let body = |(inertia, _): &([f64; 3], RigidBody)| RigidBody::<Counted>::new(*inertia);
        let bodies = self.bodies.iter().map(body).collect::<Result<_, _>>().ok()?;
        let start = self.start.iter().map(|m| m.map(Counted)).collect();
        operations_by(method, &flow(bodies, &start).ok()?, start, pace)
    }
    fn modelled(&self) -> String {
        format!("momenta of {} bodies", self.bodies.len())
    }
    fn state(&self) -> &'static [&'static str] {
        &["momentum_body"]
    }
    fn laws(&self) -> Vec<Law> {
        vec![Law::of_the_flow("energy", 2), Law::of_the_action("momentum_norm", 2)]
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let each = 1..=self.bodies.len();
        match quantity.name {
            "momentum_body" => {
                each.flat_map(|i| [1, 2, 3].map(|axis| format!("m{i}_{axis}"))).collect()
            }
            "energy" => each.map(|i| format!("energy{i}")).collect(),
            _ => each.map(|i| format!("norm{i}")).collect(),
        }
    }
    fn show(&self, quantity: &str, _: f64, m: &Momenta, row: &mut Vec<f64>) {
        match quantity {
            "momentum_body" => row.extend(m.iter().flat_map(|m| m.iter())),
            "energy" => {
                row.extend(self.bodies.iter().zip(m).map(|((_, body), m)| body.energy(m)));
            }
            _ => row.extend(m.iter().map(Vector3::norm)),
        }
    }
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<Momenta, Error>> {
        let bodies = self.bodies.iter().zip(&self.start);
        let moved = bodies.map(|((inertia, _), m)| {
            Exact::new(*inertia, (*m).into(), Matrix3::identity())?.momentum_body(t1 - t0)
        });
        Some(moved.collect())
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("momentum_body")
    }
}
