//! `kind = "rigid-body"`: the free rigid body in ℝ³.

mod model;
mod shape;

use lieflow::Error;
use lieflow::groups::{MEMBERSHIP, So3};
use lieflow::problems::RigidBody;
use lieflow::problems::inertia::{principal_axes, violates_triangle};
use lieflow::so3::{quaternion_from_matrix, quaternion_from_wxyz};
use nalgebra::{Matrix3, UnitQuaternion, Vector3, Vector4};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use self::model::RigidBodyModel;
use self::shape::Shape;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::{Layer, Model};
use crate::scene::values::{Diagonal, Reals, Rows};
use crate::scene::{Either, ReadError, Refusal, exactly_one};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-body",
    equation: "ṁ = m × ω, m = Jω, in the body; ġ = gω̂ takes the body to space",
    summary: "the free rigid body, by its momentum on so(3)*, its attitude on SO(3) or its quaternion",
    keys: &[
        KeyInfo {
            name: "inertia",
            meaning: "principal moments of inertia [J1, J2, J3], or the tensor of inertia as three rows",
        },
        KeyInfo { name: "inverse_inertia", meaning: "their reciprocals, instead of inertia" },
        KeyInfo {
            name: "shape",
            meaning: "instead of inertia: {kind = \"box\", mass, sides = [a, b, c]}, {kind = \
                      \"ellipsoid\", mass, semi_axes}, {kind = \"cylinder\", mass, radius, height}",
        },
        KeyInfo { name: "omega_body", meaning: "initial angular velocity in the body" },
        KeyInfo {
            name: "momentum_body",
            meaning: "initial angular momentum in the body, instead of omega_body",
        },
        KeyInfo {
            name: "attitude",
            meaning: "initial rotation from body to space, three rows; optional, the identity",
        },
        KeyInfo {
            name: "quaternion",
            meaning: "the same as a unit quaternion [w, x, y, z], instead of attitude: it is then \
                      integrated as one",
        },
    ],
    quantities: || QUANTITIES.to_vec(),
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
    QuantityInfo {
        name: "quaternion",
        columns: &["qw", "qx", "qy", "qz"],
        meaning: "the same as a unit quaternion, real part first, x -> q x q*; with the key quaternion \
                  it is what is integrated, and without it has w >= 0",
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
    QuantityInfo {
        name: "quaternion_defect",
        columns: &["quaternion_defect"],
        meaning: "distance of the quaternion's square from 1",
    },
];

/// Do these quantities need the attitude?
fn needs_attitude(quantities: &[&str]) -> bool {
    quantities.iter().any(|name| name.starts_with("attitude") || name.starts_with("quaternion"))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    inertia: Option<Diagonal>,
    inverse_inertia: Option<Reals<3>>,
    shape: Option<Shape>,
    omega_body: Option<Reals<3>>,
    momentum_body: Option<Reals<3>>,
    attitude: Option<Rows<3>>,
    quaternion: Option<Reals<4>>,
}

/// A free rigid body with its initial state.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBodySpec {
    /// Principal moments of inertia.
    pub inertia: [f64; 3],
    /// Initial angular momentum in the body, along the principal axes.
    pub momentum_body: [f64; 3],
    /// Initial rotation to space, from the frame of the principal axes.
    pub attitude: Matrix3<f64>,
    /// The same as a quaternion, where it is to be integrated as one.
    pub quaternion: Option<UnitQuaternion<f64>>,
    /// The principal axes, as columns, in the frame that the scene is written in, where that is
    /// another.
    pub axes: Option<Matrix3<f64>>,
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
        Ok(RigidBodySpec { inertia, momentum_body, attitude, quaternion: None, axes: None })
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

/// Principal moments of inertia, and the principal axes where the scene's are others.
type Principal = ([f64; 3], Option<Matrix3<f64>>);

fn principal(keys: &Keys) -> Result<Principal, ReadError> {
    if let Some(shape) = &keys.shape {
        let others = [
            ("inertia", keys.inertia.is_some()),
            ("inverse_inertia", keys.inverse_inertia.is_some()),
        ];
        if let Some((other, _)) = others.iter().find(|(_, given)| *given) {
            let message = format!("both `{other}` and `shape`, expected exactly one of them");
            return Err(Refusal::at("shape", message).into());
        }
        return Ok((shape.moments()?, None));
    }
    match exactly_one(("inertia", keys.inertia), ("inverse_inertia", keys.inverse_inertia))? {
        Either::First(Diagonal::List(inertia)) => Ok((inertia, None)),
        Either::First(Diagonal::Rows(rows)) => {
            let tensor = Matrix3::from_rows(&rows.map(|row| Vector3::from(row).transpose()));
            let refused = |error: Error| Refusal::at("inertia", error.to_string());
            let (inertia, axes) = principal_axes(&tensor).map_err(refused)?;
            Ok((inertia, Some(axes)))
        }
        Either::Second(inverse) => {
            let range = "a finite number > 0 with a finite reciprocal";
            check_each("inverse_inertia", inverse.0, range, |x| x > 0.0 && (1.0 / x).is_normal())?;
            Ok((inverse.0.map(f64::recip), None))
        }
    }
}

/// The length of a quaternion may differ from 1 by the digits that it is written with.
const UNIT: f64 = 1e-6;

fn unit(quaternion: Reals<4>) -> Result<UnitQuaternion<f64>, Refusal> {
    let q = Vector4::from(quaternion.0);
    match (q.norm() - 1.0).abs() <= UNIT {
        true => Ok(quaternion_from_wxyz(quaternion.0)?),
        false => {
            let message = format!("its length is {}, expected 1", q.norm());
            Err(Refusal::at("quaternion", message))
        }
    }
}

/// The rotation of a quaternion.
fn rotation(q: &UnitQuaternion<f64>) -> Matrix3<f64> {
    q.to_rotation_matrix().into_inner()
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let (inertia, axes) = principal(&keys)?;
    let along = |x: [f64; 3]| match &axes {
        Some(axes) => axes.tr_mul(&Vector3::from(x)).into(),
        None => x,
    };
    let momentum = match exactly_one(
        ("omega_body", keys.omega_body),
        ("momentum_body", keys.momentum_body),
    )? {
        Either::Second(momentum) => along(momentum.0),
        Either::First(omega) => {
            let omega: [f64; 3] = along(omega.0);
            let momentum: [f64; 3] = core::array::from_fn(|i| inertia[i] * omega[i]);
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
    if keys.attitude.is_some() && keys.quaternion.is_some() {
        let message = "both `attitude` and `quaternion`, expected at most one of them";
        return Err(Refusal::at("quaternion", message).into());
    }
    let quaternion = keys.quaternion.map(unit).transpose()?;
    let attitude = match (keys.attitude, &quaternion) {
        (Some(rows), _) => Matrix3::from_rows(&rows.0.map(|row| Vector3::from(row).transpose())),
        (None, Some(q)) => rotation(q),
        (None, None) => Matrix3::identity(),
    };
    let mut body = RigidBodySpec::new(inertia, momentum, attitude)?;
    body.quaternion = quaternion;
    if let Some(axes) = axes {
        body.attitude *= axes;
        if let Some(q) = &mut body.quaternion {
            *q *= quaternion_from_matrix(&axes)?;
        }
        body.axes = Some(axes);
    }
    Ok(Box::new(body))
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
    fn layers(&self) -> &'static [Layer] {
        match self.quaternion {
            Some(_) => &[Layer::Closed],
            None => &Layer::ALL,
        }
    }
    fn invariants(&self, quantities: &[&str]) -> Vec<Law> {
        // Of degree 4 in a quaternion.
        let by_quaternion = self.quaternion.is_some() && needs_attitude(quantities);
        let degree = if by_quaternion { 0 } else { 2 };
        let mut laws =
            vec![Law::of_the_flow("energy", degree), Law::of_the_action("momentum_norm", degree)];
        if needs_attitude(quantities) {
            let defect = if by_quaternion { "quaternion_defect" } else { "attitude_defect" };
            laws.push(Law::of_the_action(defect, 2).on_scale(Scale::One));
        }
        laws
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("momentum_body")
    }
    fn warnings(&self) -> Vec<String> {
        let missed = violates_triangle(self.inertia);
        let warning = |missed: f64| {
            format!(
                "no body has the moments of inertia {:?}: the largest is more than the sum of the \
                 others, by {:.1e} of it",
                self.inertia, missed
            )
        };
        missed.map(warning).into_iter().collect()
    }
}
