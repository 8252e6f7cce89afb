//! `kind = "spin"`: a magnetic moment in a field that turns, an equation of linear type.

mod model;

use lieflow::Error;
use nalgebra::Vector3;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use self::model::SpinModel;
use super::{KeyInfo, Kind, ProblemSpec, QuantityInfo};
use crate::model::{Layer, Model};
use crate::scene::ReadError;
use crate::scene::values::{Real, Reals};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "spin",
    summary: "a magnetic moment in a field that turns about the third axis, on the sphere",
    keys: &[
        KeyInfo { name: "field", meaning: "angular velocity of the precession at t = 0" },
        KeyInfo { name: "rate", meaning: "angular velocity at which the field turns" },
        KeyInfo { name: "moment", meaning: "initial moment" },
    ],
    quantities: &[
        QuantityInfo { name: "moment", columns: &["x1", "x2", "x3"], meaning: "the moment" },
        QuantityInfo {
            name: "moment_norm",
            columns: &["moment_norm"],
            meaning: "length of the moment",
        },
    ],
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    field: Reals<3>,
    rate: Real,
    moment: Reals<3>,
}

/// ẋ = ω(t) × x with ω(t) = R₃(Ωt) ω(0), and its initial state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpinSpec {
    /// ω(0).
    pub field: Vector3<f64>,
    /// Ω.
    pub rate: f64,
    /// x(0).
    pub moment: Vector3<f64>,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    Ok(Box::new(SpinSpec {
        field: keys.field.0.into(),
        rate: keys.rate.0,
        moment: keys.moment.0.into(),
    }))
}

impl ProblemSpec for SpinSpec {
    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn model(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn Model>, Error> {
        match layer {
            Layer::Closed => Ok(Box::new(SpinModel::new(self, quantities)?)),
            Layer::General => Err(Error::Unsupported {
                what: "layer",
                with: "`general` and a problem of kind `spin`".into(),
                why: "it has closed formulas only; leave layer out",
            }),
        }
    }
    fn state(&self, _: &[&str]) -> &'static [&'static str] {
        &["moment"]
    }
    fn invariants(&self, _: &[&str]) -> &'static [&'static str] {
        &["moment_norm"]
    }
}
