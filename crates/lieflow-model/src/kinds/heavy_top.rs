//! `kind = "heavy-top"`: a rigid body that turns about a fixed point under gravity, by its momentum μ and
//! the vertical γ in the body, on se(3)*; see [`HeavyTop`].

use lieflow::Error;
use lieflow::actions::Coadjoint;
use lieflow::catalog::MethodSpec;
use lieflow::groups::Se3;
use lieflow::problems::{HeavyTop, Invariants};
use lieflow::scalar::Counted;
use nalgebra::Vector3;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::flow::Flow;
use super::system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::values::Reals;
use crate::scene::{Either, ReadError, Refusal, exactly_one};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "heavy-top",
    equation: "μ̇ = μ × ω + γ × w, γ̇ = γ × ω, μ = Jω, γ upward, w the weight, all in the body",
    summary: "the heavy top about a fixed point, by its momentum and the vertical in the body",
    keys: &[
        KeyInfo {
            name: "inertia",
            meaning: "principal moments of inertia about the fixed point [J1, J2, J3]",
        },
        KeyInfo {
            name: "weight",
            meaning: "weight times the vector from the fixed point to the centre of mass, in the body",
        },
        KeyInfo { name: "omega_body", meaning: "initial angular velocity in the body" },
        KeyInfo {
            name: "momentum_body",
            meaning: "initial angular momentum in the body, instead of omega_body",
        },
        KeyInfo { name: "vertical", meaning: "initial direction upward in the body, of length 1" },
    ],
    quantities: &[
        QuantityInfo {
            name: "momentum_body",
            columns: &["m1", "m2", "m3"],
            meaning: "angular momentum in the body",
        },
        QuantityInfo {
            name: "omega_body",
            columns: &["w1", "w2", "w3"],
            meaning: "angular velocity in the body",
        },
        QuantityInfo {
            name: "vertical",
            columns: &["v1", "v2", "v3"],
            meaning: "the direction upward in the body",
        },
        QuantityInfo {
            name: "energy",
            columns: &["energy"],
            meaning: "kinetic and potential energy",
        },
        QuantityInfo {
            name: "vertical_norm2",
            columns: &["vertical_norm2"],
            meaning: "square of the length of the vertical",
        },
        QuantityInfo {
            name: "momentum_vertical",
            columns: &["momentum_vertical"],
            meaning: "angular momentum about the vertical",
        },
        QuantityInfo {
            name: "integral",
            columns: &["integral"],
            meaning: "the fourth integral of Euler's, Lagrange's and Kovalevskaya's top; not a number \
                      for another",
        },
    ],
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    inertia: Reals<3>,
    weight: Reals<3>,
    omega_body: Option<Reals<3>>,
    momentum_body: Option<Reals<3>>,
    vertical: Reals<3>,
}

/// The top with its initial state (μ, γ).
#[derive(Clone, Copy, Debug)]
struct Top {
    top: HeavyTop,
    inertia: [f64; 3],
    weight: Vector3<f64>,
    start: Point,
}

type Point = (Vector3<f64>, Vector3<f64>);

/// The length of the vertical may differ from 1 by the digits that it is written with.
const UNIT: f64 = 1e-6;

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let top = HeavyTop::new(keys.inertia.0, keys.weight.0)?;
    let either =
        exactly_one(("omega_body", keys.omega_body), ("momentum_body", keys.momentum_body));
    let momentum = match either? {
        Either::First(omega) => {
            Vector3::from(omega.0).component_mul(&Vector3::from(keys.inertia.0))
        }
        Either::Second(momentum) => momentum.0.into(),
    };
    let vertical = Vector3::from(keys.vertical.0);
    let length = vertical.norm();
    if (length - 1.0).abs() > UNIT {
        let message = format!("its length is {length}, expected 1");
        return Err(Refusal::at("vertical", message).into());
    }
    let (inertia, weight) = (keys.inertia.0, keys.weight.0.into());
    Ok(Box::new(Top { top, inertia, weight, start: (momentum, vertical / length) }))
}

impl Top {
    /// Is there a fourth integral?
    fn is_integrable(&self) -> bool {
        self.top.problem().invariants().len() > 3
    }
}

impl System for Top {
    type Problem = Flow<Se3, Coadjoint>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Point), Error> {
        Ok(Flow::lie_poisson(self.top.problem(), Coadjoint, self.start))
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let start = (self.start.0.map(Counted), self.start.1.map(Counted));
        let top = HeavyTop::<Counted>::new(self.inertia, self.weight.into()).ok()?;
        let (flow, start) = Flow::lie_poisson(top.problem(), Coadjoint, start);
        operations_by(method, &flow, start, pace)
    }
    fn modelled(&self) -> String {
        "momentum and vertical on se(3)*".into()
    }
    fn state(&self) -> &'static [&'static str] {
        &["momentum_body", "vertical"]
    }
    fn laws(&self) -> Vec<Law> {
        let mut laws = vec![
            Law::of_the_flow("energy", 2).on_scale(Scale::Terms),
            Law::of_the_action("vertical_norm2", 2),
            Law::of_the_action("momentum_vertical", 2).on_scale(Scale::Terms),
        ];
        if self.is_integrable() {
            laws.push(Law::of_the_flow("integral", 0));
        }
        laws
    }
    fn show(&self, quantity: &str, _: f64, y: &Point, row: &mut Vec<f64>) {
        let values = self.top.problem().values(y);
        let value = |i: usize| values.get(i).copied().unwrap_or(f64::NAN);
        match quantity {
            "momentum_body" => row.extend(y.0.iter()),
            "omega_body" => row.extend(self.top.omega(&y.0).iter()),
            "vertical" => row.extend(y.1.iter()),
            "energy" => row.push(value(0)),
            "vertical_norm2" => row.push(value(1)),
            "momentum_vertical" => row.push(value(2)),
            _ => row.push(value(3)),
        }
    }
    fn size(&self, quantity: &str, (mu, gamma): &Point) -> f64 {
        match quantity {
            "energy" => mu.dot(&self.top.omega(mu)) + self.weight.norm() * gamma.norm(),
            _ => mu.norm() * gamma.norm(),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("vertical")
    }
}
