//! `kind = "lorentz"`: the four-velocity of a charged particle in constant fields, in SO(3,1); see
//! [`ChargedParticle`]. u̇ = (q/m) F u in the particle's proper time, an equation of linear type.

use faer::Mat;
use lieflow::groups::{AlgebraMatrix, LieAlgebra, MatrixGroup};
use lieflow::maps::Exp;
use lieflow::problems::{ChargedParticle, Flow};
use lieflow::{CoordinateMap, Error, Problem};
use nalgebra::Vector3;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::matrix::MatrixAction;
use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::kinds::flow::OnMatrices;
use crate::model::Layer;
use crate::scene::values::{Real, Reals};
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "lorentz",
    equation: "d(γv)/dτ = (q/m)(γE + γv × B), dγ/dτ = (q/m) E·γv",
    summary: "a charged particle in constant fields, by its four-velocity; t is its proper time",
    keys: &[
        KeyInfo { name: "charge_to_mass", meaning: "charge over mass" },
        KeyInfo { name: "electric", meaning: "the electric field" },
        KeyInfo { name: "magnetic", meaning: "the magnetic field, times the speed of light" },
        KeyInfo { name: "velocity", meaning: "initial velocity over the speed of light" },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "four_velocity",
                columns: &["u1", "u2", "u3", "gamma"],
                meaning: "gamma times the velocity, and gamma",
            },
            QuantityInfo {
                name: "velocity",
                columns: &["v1", "v2", "v3"],
                meaning: "the velocity over the speed of light",
            },
            QuantityInfo {
                name: "energy",
                columns: &["gamma_energy"],
                meaning: "gamma, the energy over that at rest; kept where there is no electric field",
            },
            QuantityInfo {
                name: "mass_shell",
                columns: &["mass_shell"],
                meaning: "square of the four-velocity, -1",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    charge_to_mass: Real,
    electric: Reals<3>,
    magnetic: Reals<3>,
    velocity: Reals<3>,
}

/// (q/m) F, and the initial four-velocity.
#[derive(Clone, Debug)]
struct Particle {
    tensor: AlgebraMatrix,
    start: Mat<f64>,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let (e, b) = (Vector3::from(keys.electric.0), Vector3::from(keys.magnetic.0));
    let particle = ChargedParticle::new(keys.charge_to_mass.0, move |_: f64, _: &Mat<f64>| (e, b))?;
    let start = particle
        .four_velocity(keys.velocity.0)
        .map_err(|error| Refusal::at("velocity", error.to_string()))?;
    let mut tensor = particle.group().zero();
    particle.f(0.0, &start, &mut tensor, &mut particle.work());
    Ok(Box::new(Particle { tensor, start }))
}

impl System for Particle {
    type Problem = OnMatrices;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        let tensor = self.tensor.clone();
        let field = move |_: f64, v: &mut AlgebraMatrix| v.copy_from(&*tensor);
        let (group, action) = (MatrixGroup::indefinite(3, 1)?, MatrixAction::Linear);
        Ok((OnMatrices::linear(Flow::of_time(group, action, field), action), self.start.clone()))
    }
    fn modelled(&self) -> String {
        "four-velocity, by SO(3,1)".into()
    }
    fn state(&self) -> &'static [&'static str] {
        &["four_velocity"]
    }
    fn laws(&self) -> Vec<Law> {
        let mut laws = vec![Law::of_the_action("mass_shell", 2).on_scale(Scale::Terms)];
        if (0..3).all(|i| self.tensor[(i, 3)] == 0.0) {
            laws.push(Law::of_the_flow("energy", 1));
        }
        laws
    }
    fn show(&self, quantity: &str, _: f64, u: &Mat<f64>, row: &mut Vec<f64>) {
        let u = u.col_as_slice(0);
        match quantity {
            "four_velocity" => row.extend(u),
            "velocity" => row.extend(u[..3].iter().map(|x| x / u[3])),
            "energy" => row.push(u[3]),
            _ => row.push(u[0] * u[0] + u[1] * u[1] + u[2] * u[2] - u[3] * u[3]),
        }
    }
    fn size(&self, _: &str, u: &Mat<f64>) -> f64 {
        u.squared_norm_l2()
    }
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<Mat<f64>, Error>> {
        let turned = MatrixGroup::indefinite(3, 1).and_then(|group| {
            let mut tensor = group.zero();
            group.axpy(t1 - t0, &self.tensor, &mut tensor);
            Exp.eval(&group, &tensor)
        });
        Some(turned.map(|g| &*g * &self.start))
    }
    fn figure(&self) -> Figure {
        Figure::Lines("velocity")
    }
}
