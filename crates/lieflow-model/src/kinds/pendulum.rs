//! `kind = "spherical-pendulum"`: a point mass on a rod that turns in every direction, on TS² as an orbit of
//! SE(3); see [`SphericalPendulum`].

use lieflow::Error;
use lieflow::actions::Coadjoint;
use lieflow::catalog::MethodSpec;
use lieflow::problems::SphericalPendulum;
use lieflow::scalar::Counted;
use nalgebra::Vector3;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::kinds::flow::OnSe3;
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::values::{Real, Reals};
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "spherical-pendulum",
    equation: "q̇ = ω × q, ω̇ = −(g/ℓ) q × e₃",
    summary: "the spherical pendulum, by its direction and its angular velocity; e3 points upward",
    keys: &[
        KeyInfo { name: "gravity_over_length", meaning: "gravity over the length of the rod" },
        KeyInfo { name: "direction", meaning: "initial direction of the rod, normalised" },
        KeyInfo {
            name: "velocity",
            meaning: "initial velocity of the direction; its part along the rod is left out",
        },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "direction",
                columns: &["q1", "q2", "q3"],
                meaning: "direction of the rod",
            },
            QuantityInfo {
                name: "omega",
                columns: &["w1", "w2", "w3"],
                meaning: "angular velocity",
            },
            QuantityInfo { name: "energy", columns: &["energy"], meaning: "energy" },
            QuantityInfo {
                name: "vertical_momentum",
                columns: &["vertical_momentum"],
                meaning: "angular momentum about the vertical",
            },
            QuantityInfo {
                name: "direction_norm2",
                columns: &["direction_norm2"],
                meaning: "square of the length of the direction",
            },
            QuantityInfo {
                name: "omega_along",
                columns: &["omega_along"],
                meaning: "angular velocity along the rod, 0",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    gravity_over_length: Real,
    direction: Reals<3>,
    velocity: Reals<3>,
}

type Point = (Vector3<f64>, Vector3<f64>);

/// The pendulum with its initial state (ω, q).
#[derive(Clone, Copy, Debug)]
struct Pendulum {
    pendulum: SphericalPendulum,
    rate2: f64,
    start: Point,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let rate2 = keys.gravity_over_length.0;
    let pendulum = SphericalPendulum::new(rate2)?;
    let start = pendulum
        .state(keys.direction.0, keys.velocity.0)
        .map_err(|error| Refusal::at("direction", error.to_string()))?;
    Ok(Box::new(Pendulum { pendulum, rate2, start }))
}

impl System for Pendulum {
    type Problem = OnSe3<f64>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Point), Error> {
        Ok((OnSe3::lie_poisson(self.pendulum, Coadjoint), self.start))
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let start = (self.start.0.map(Counted), self.start.1.map(Counted));
        let (flow, start) = (OnSe3::lie_poisson(self.pendulum.on::<Counted>(), Coadjoint), start);
        operations_by(method, &flow, start, pace)
    }
    fn modelled(&self) -> String {
        "angular velocity and direction on an orbit of SE(3)".into()
    }
    fn state(&self) -> &'static [&'static str] {
        &["direction", "omega"]
    }
    fn laws(&self) -> Vec<Law> {
        vec![
            Law::of_the_flow("energy", 2).on_scale(Scale::Terms),
            Law::of_the_flow("vertical_momentum", 1).on_scale(Scale::Terms),
            Law::of_the_action("direction_norm2", 2),
            Law::of_the_action("omega_along", 2).on_scale(Scale::Terms),
        ]
    }
    fn show(&self, quantity: &str, _: f64, y: &Point, row: &mut Vec<f64>) {
        let (omega, q) = y;
        match quantity {
            "direction" => row.extend(q.iter()),
            "omega" => row.extend(omega.iter()),
            "energy" => row.push(self.pendulum.energy(y)),
            "vertical_momentum" => row.push(omega[2]),
            "direction_norm2" => row.push(q.norm_squared()),
            _ => row.push(omega.dot(q)),
        }
    }
    fn size(&self, quantity: &str, (omega, q): &Point) -> f64 {
        match quantity {
            "energy" => 0.5 * omega.norm_squared() + self.rate2.abs() * q.norm(),
            _ => omega.norm() * q.norm(),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("direction")
    }
}
