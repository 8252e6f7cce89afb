//! `kind = "spin"`: a magnetic moment in a field that turns, an equation of linear type on the sphere.
//!
//! ẋ = ω(t) × x, ω(t) = R₃(Ωt) ω(0). f(t, x) = ω(t); Λ(g, x) = g x. Invariant: |x|.

use lieflow::actions::Linear;
use lieflow::catalog::MethodSpec;
use lieflow::groups::So3;
use lieflow::problems::Flow;
use lieflow::scalar::{Counted, Trig};
use lieflow::{Error, so3};
use nalgebra::Vector3;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo};
use crate::kinds::flow::OnSphere;
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::ReadError;
use crate::scene::values::{Real, Reals};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "spin",
    equation: "ẋ = ω(t) × x, ω(t) = the field turned about e₃ by rate·t",
    summary: "a magnetic moment in a field that turns about the third axis, on the sphere",
    keys: &[
        KeyInfo { name: "field", meaning: "angular velocity of the precession at t = 0" },
        KeyInfo { name: "rate", meaning: "angular velocity at which the field turns" },
        KeyInfo { name: "moment", meaning: "initial moment" },
    ],
    quantities: || {
        vec![
            QuantityInfo { name: "moment", columns: &["x1", "x2", "x3"], meaning: "the moment" },
            QuantityInfo {
                name: "moment_norm",
                columns: &["moment_norm"],
                meaning: "length of the moment",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    field: Reals<3>,
    rate: Real,
    moment: Reals<3>,
}

/// The field and the initial state.
#[derive(Clone, Copy, Debug)]
struct Spin {
    field: Vector3<f64>,
    rate: f64,
    moment: Vector3<f64>,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let Keys { field, rate, moment } = Keys::deserialize(section)?;
    Ok(Box::new(Spin { field: field.0.into(), rate: rate.0, moment: moment.0.into() }))
}

impl Spin {
    fn flow<S: Trig>(&self) -> (OnSphere<S>, Vector3<S>) {
        let [field, moment] = [self.field, self.moment].map(|x| x.map(S::lit));
        let rate = S::lit(self.rate);
        let omega = move |t: S, v: &mut Vector3<S>| {
            let (s, c) = (rate * t).sin_cos();
            let turned = [c * field[0] - s * field[1], s * field[0] + c * field[1]];
            *v = Vector3::new(turned[0], turned[1], field[2]);
        };
        (OnSphere::linear(Flow::of_time(So3::new(), Linear, omega), Linear), moment)
    }
}

impl System for Spin {
    type Problem = OnSphere<f64>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Vector3<f64>), Error> {
        Ok(self.flow())
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let (flow, start) = self.flow::<Counted>();
        operations_by(method, &flow, start, pace)
    }
    fn modelled(&self) -> String {
        "moment on the sphere".into()
    }
    fn state(&self) -> &'static [&'static str] {
        &["moment"]
    }
    fn laws(&self) -> Vec<Law> {
        vec![Law::of_the_action("moment_norm", 2)]
    }
    fn show(&self, quantity: &str, _: f64, x: &Vector3<f64>, row: &mut Vec<f64>) {
        match quantity {
            "moment" => row.extend(x.iter()),
            _ => row.push(x.norm()),
        }
    }
    /// In the frame that turns with the field, Ω = rate·e₃, the field stands still: y = R₃(−Ωt)x moves by
    /// ẏ = (ω(0) − Ω) × y.
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<Vector3<f64>, Error>> {
        let rate = Vector3::new(0.0, 0.0, self.rate);
        let turned = |u: Vector3<f64>, x: Vector3<f64>| so3::exp_on(&u, &x).map_err(Error::from);
        let still = turned(rate * -t0, self.moment);
        let moved = still.and_then(|y| turned((self.field - rate) * (t1 - t0), y));
        Some(moved.and_then(|y| turned(rate * t1, y)))
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("moment")
    }
}
