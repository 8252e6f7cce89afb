//! `kind = "rigid-body"`: the free rigid body in ℝ³.

mod model;

use lieflow::Error;
use lieflow::groups::{MEMBERSHIP, So3};
use lieflow::problems::RigidBody;
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use self::model::RigidBodyModel;
use super::{KeyInfo, Kind, ProblemSpec, QuantityInfo};
use crate::model::{Layer, Model};
use crate::scene::values::{Reals, Rows};
use crate::scene::{Either, ReadError, Refusal, exactly_one};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-body",
    summary: "the free rigid body, by its momentum on so(3)* or its attitude on SO(3)",
    keys: &[
        KeyInfo { name: "inertia", meaning: "principal moments of inertia [J1, J2, J3]" },
        KeyInfo { name: "inverse_inertia", meaning: "their reciprocals, instead of inertia" },
        KeyInfo { name: "omega_body", meaning: "initial angular velocity in the body" },
        KeyInfo {
            name: "momentum_body",
            meaning: "initial angular momentum in the body, instead of omega_body",
        },
        KeyInfo {
            name: "attitude",
            meaning: "initial rotation from body to space, three rows; optional, the identity",
        },
    ],
    quantities: QUANTITIES,
    read,
};

const QUANTITIES: &[QuantityInfo] = &[
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
        name: "attitude",
        columns: &["g11", "g12", "g13", "g21", "g22", "g23", "g31", "g32", "g33"],
        meaning: "rotation from body to space, row by row; integrated only when asked for",
    },
    QuantityInfo { name: "energy", columns: &["energy"], meaning: "kinetic energy" },
    QuantityInfo {
        name: "momentum_norm",
        columns: &["momentum_norm"],
        meaning: "length of the angular momentum",
    },
    QuantityInfo {
        name: "attitude_defect",
        columns: &["attitude_defect"],
        meaning: "distance of gᵀg from the identity; needs the attitude, which is then integrated",
    },
];

/// Do these quantities need the attitude?
fn needs_attitude(quantities: &[&str]) -> bool {
    quantities.iter().any(|name| matches!(*name, "attitude" | "attitude_defect"))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    inertia: Option<Reals<3>>,
    inverse_inertia: Option<Reals<3>>,
    omega_body: Option<Reals<3>>,
    momentum_body: Option<Reals<3>>,
    attitude: Option<Rows<3>>,
}

/// A free rigid body with its initial state.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBodySpec {
    /// Principal moments of inertia.
    pub inertia: [f64; 3],
    /// Initial angular momentum in the body.
    pub momentum_body: [f64; 3],
    /// Initial rotation from body to space.
    pub attitude: Matrix3<f64>,
}

impl RigidBodySpec {
    /// Check the parts and put them together.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a moment of inertia that is not finite and positive or a momentum
    /// that is not finite, [`So3::check_element`]'s errors for the attitude.
    pub fn new(
        inertia: [f64; 3],
        momentum_body: [f64; 3],
        attitude: Matrix3<f64>,
    ) -> Result<Self, Error> {
        RigidBody::<f64>::new(inertia)?;
        check_each("momentum_body", momentum_body, "a finite number", f64::is_finite)?;
        So3::new().check_element("attitude", &attitude, MEMBERSHIP)?;
        Ok(RigidBodySpec { inertia, momentum_body, attitude })
    }
}

fn check_each(
    arg: &str,
    values: [f64; 3],
    expected: &str,
    good: impl Fn(f64) -> bool,
) -> Result<(), Error> {
    match values.iter().position(|&x| !good(x)) {
        None => Ok(()),
        Some(i) => Err(Error::OutOfRange {
            arg: format!("{arg}[{i}]"),
            value: values[i],
            expected: expected.into(),
        }),
    }
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let inertia =
        match exactly_one(("inertia", keys.inertia), ("inverse_inertia", keys.inverse_inertia))? {
            Either::First(inertia) => inertia.0,
            Either::Second(inverse) => {
                let range = "a finite number > 0 with a finite reciprocal";
                check_each("inverse_inertia", inverse.0, range, |x| {
                    x > 0.0 && (1.0 / x).is_normal()
                })?;
                inverse.0.map(f64::recip)
            }
        };
    let momentum = match exactly_one(
        ("omega_body", keys.omega_body),
        ("momentum_body", keys.momentum_body),
    )? {
        Either::Second(momentum) => momentum.0,
        Either::First(omega) => {
            let momentum: [f64; 3] = core::array::from_fn(|i| inertia[i] * omega.0[i]);
            if let Some(i) = momentum.iter().position(|m| !m.is_finite()) {
                return Err(Refusal::at(
                    format!("omega_body[{i}]"),
                    format!("the momentum inertia[{i}] * omega_body[{i}] is not finite"),
                )
                .into());
            }
            momentum
        }
    };
    let attitude = keys.attitude.map_or_else(Matrix3::identity, |rows| {
        Matrix3::from_rows(&rows.0.map(|row| Vector3::from(row).transpose()))
    });
    Ok(Box::new(RigidBodySpec::new(inertia, momentum, attitude)?))
}

impl ProblemSpec for RigidBodySpec {
    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn model(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn Model>, Error> {
        Ok(Box::new(RigidBodyModel::new(self, layer, quantities)?))
    }
    fn state(&self, quantities: &[&str]) -> &'static [&'static str] {
        match needs_attitude(quantities) {
            true => &["momentum_body", "attitude"],
            false => &["momentum_body"],
        }
    }
    fn invariants(&self, quantities: &[&str]) -> &'static [&'static str] {
        match needs_attitude(quantities) {
            true => &["energy", "momentum_norm", "attitude_defect"],
            false => &["energy", "momentum_norm"],
        }
    }
}
