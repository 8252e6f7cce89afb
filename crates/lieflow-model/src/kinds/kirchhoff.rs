//! `kind = "kirchhoff"`: Kirchhoff's equations of a body in an ideal fluid, Euler's equations on se(3)*.
//!
//! H(μ, π) = ½ μ·J⁻¹μ + ½ π·M⁻¹π with J and M diagonal; μ̇ = μ × ω + π × v, π̇ = π × ω, ω = J⁻¹μ,
//! v = M⁻¹π. f = −(ω, v); Λ coadjoint. Invariants: H, |π|² and μ·π (the Casimirs).
//! Source: H. Lamb, Hydrodynamics, chapter 6.

use lieflow::Error;
use lieflow::actions::Coadjoint;
use lieflow::catalog::MethodSpec;
use lieflow::groups::Se3;
use lieflow::problems::{Euler, Kinetic};
use lieflow::scalar::{Counted, Real};
use nalgebra::Vector3;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::kinds::flow::OnSe3;
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::values::Reals;
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "kirchhoff",
    equation: "μ̇ = μ × ω + π × v, π̇ = π × ω, μ = Jω, π = Mv, all in the body",
    summary: "a body in an ideal fluid, by its angular and linear momentum on se(3)*",
    keys: &[
        KeyInfo {
            name: "inertia",
            meaning: "moments of inertia about its axes, with the fluid that is moved",
        },
        KeyInfo { name: "mass", meaning: "masses along its axes, with the fluid that is moved" },
        KeyInfo { name: "angular_momentum", meaning: "initial angular momentum in the body" },
        KeyInfo { name: "linear_momentum", meaning: "initial linear momentum in the body" },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "angular_momentum",
                columns: &["m1", "m2", "m3"],
                meaning: "angular momentum in the body",
            },
            QuantityInfo {
                name: "linear_momentum",
                columns: &["p1", "p2", "p3"],
                meaning: "linear momentum in the body",
            },
            QuantityInfo { name: "energy", columns: &["energy"], meaning: "kinetic energy" },
            QuantityInfo {
                name: "linear_norm2",
                columns: &["linear_norm2"],
                meaning: "square of the length of the linear momentum",
            },
            QuantityInfo {
                name: "momenta_product",
                columns: &["momenta_product"],
                meaning: "product of the two momenta",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    inertia: Reals<3>,
    mass: Reals<3>,
    angular_momentum: Reals<3>,
    linear_momentum: Reals<3>,
}

type Point<S = f64> = (Vector3<S>, Vector3<S>);

/// The body with its initial momenta (μ, π).
#[derive(Clone, Copy, Debug)]
struct Body {
    inertia: Vector3<f64>,
    mass: Vector3<f64>,
    start: Point,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    for (key, list) in [("inertia", keys.inertia.0), ("mass", keys.mass.0)] {
        if let Some(i) = list.iter().position(|x| !(*x > 0.0 && x.recip().is_finite())) {
            let message = format!("{key}[{i}] = {}, expected a finite number > 0", list[i]);
            return Err(Refusal::at(format!("{key}[{i}]"), message).into());
        }
    }
    Ok(Box::new(Body {
        inertia: keys.inertia.0.into(),
        mass: keys.mass.0.into(),
        start: (keys.angular_momentum.0.into(), keys.linear_momentum.0.into()),
    }))
}

impl Body {
    fn flow<S: Real>(&self) -> (OnSe3<S>, Point<S>) {
        let in_s = |x: &Vector3<f64>| x.map(S::lit);
        let (inertia, mass) = (in_s(&self.inertia), in_s(&self.mass));
        let gradient = move |m: &Point<S>, xi: &mut Point<S>| {
            *xi = (
                Vector3::from_fn(|i, _| m.0[i] / inertia[i]),
                Vector3::from_fn(|i, _| m.1[i] / mass[i]),
            );
        };
        let start = (in_s(&self.start.0), in_s(&self.start.1));
        (OnSe3::lie_poisson(Euler::new(Se3::new(), Kinetic(gradient)), Coadjoint), start)
    }
    fn energy(&self, (mu, pi): &Point) -> f64 {
        0.5 * (mu.dot(&mu.component_div(&self.inertia)) + pi.dot(&pi.component_div(&self.mass)))
    }
}

impl System for Body {
    type Problem = OnSe3<f64>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Point), Error> {
        Ok(self.flow())
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let (flow, start) = self.flow::<Counted>();
        operations_by(method, &flow, start, pace)
    }
    fn modelled(&self) -> String {
        "angular and linear momentum on se(3)*".into()
    }
    fn state(&self) -> &'static [&'static str] {
        &["angular_momentum", "linear_momentum"]
    }
    fn laws(&self) -> Vec<Law> {
        vec![
            Law::of_the_flow("energy", 2),
            Law::of_the_action("linear_norm2", 2),
            Law::of_the_action("momenta_product", 2).on_scale(Scale::Terms),
        ]
    }
    fn show(&self, quantity: &str, _: f64, y: &Point, row: &mut Vec<f64>) {
        match quantity {
            "angular_momentum" => row.extend(y.0.iter()),
            "linear_momentum" => row.extend(y.1.iter()),
            "energy" => row.push(self.energy(y)),
            "linear_norm2" => row.push(y.1.norm_squared()),
            _ => row.push(y.0.dot(&y.1)),
        }
    }
    fn size(&self, _: &str, (mu, pi): &Point) -> f64 {
        mu.norm() * pi.norm()
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("linear_momentum")
    }
}
