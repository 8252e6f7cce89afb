//! `kind = "rigid-body"`: the free rigid body in ℝ³.

mod model;
mod shape;

use lieflow::groups::{MEMBERSHIP, So3};
use lieflow::problems::RigidBody;
use lieflow::problems::inertia::{principal_axes, violates_triangle};
use lieflow::so3::{quaternion_from_matrix, quaternion_from_wxyz};
use nalgebra::{Matrix3, UnitQuaternion, Vector3, Vector4};

use self::model::{
    Attitude, AttitudeMatrix, Body, ByMethod, MomentumMatrix, MomentumOnly, Quaternion, State,
};
use self::shape::Shape;
use super::body::{ATTITUDE, attitude, check_each, check_unit, momentum_body};
use super::prelude::*;
use crate::model::Model;
use crate::scene::values::{Diagonal, Rows};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-body",
    equation: "ṁ = m × ω, m = Jω, in the body; ġ = gω̂ takes the body to space",
    summary: "the free rigid body, by its momentum on so(3)*, its attitude on SO(3) or its quaternion",
    ..Kind::of::<Keys, Body<Attitude>>(read)
};

keys! { Keys {
    inertia: Option<Diagonal> =
        "principal moments of inertia [J1, J2, J3], or the tensor of inertia as three rows",
    inverse_inertia: Option<Reals<3>> = "their reciprocals, instead of inertia",
    shape: Option<Shape> =
        "instead of inertia: {kind = \"box\", mass, sides = [a, b, c]}, {kind = \"ellipsoid\", mass, \
         semi_axes}, {kind = \"cylinder\", mass, radius, height}",
    omega_body: Option<Reals<3>> = "initial angular velocity in the body",
    momentum_body: Option<Reals<3>> = "initial angular momentum in the body, instead of omega_body",
    attitude: Option<Rows<3>> = ATTITUDE,
    quaternion: Option<Reals<4>> =
        "the same as a unit quaternion [w, x, y, z], instead of attitude: it is then integrated as one",
} }

/// Do these quantities need the attitude?
fn needs_attitude(quantities: &[&str]) -> bool {
    quantities.iter().any(|name| name.starts_with("attitude") || name.starts_with("quaternion"))
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
        check_each("momentum_body", &momentum_body, "a finite number", f64::is_finite)?;
        So3::new().check_element("attitude", &attitude, MEMBERSHIP)?;
        Ok(RigidBodySpec { inertia, momentum_body, attitude, quaternion: None, axes: None })
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
            check_each("inverse_inertia", &inverse.0, range, |x| x > 0.0 && (1.0 / x).is_normal())?;
            Ok((inverse.0.map(f64::recip), None))
        }
    }
}

fn unit(quaternion: Reals<4>) -> Result<UnitQuaternion<f64>, Refusal> {
    check_unit("quaternion", Vector4::from(quaternion.0).norm())?;
    Ok(quaternion_from_wxyz(quaternion.0)?)
}

/// The rotation of a quaternion.
fn rotation(q: &UnitQuaternion<f64>) -> Matrix3<f64> {
    q.to_rotation_matrix().into_inner()
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let (inertia, axes) = principal(&keys)?;
    let momentum = momentum_body(inertia, axes.as_ref(), keys.omega_body, keys.momentum_body)?;
    if keys.attitude.is_some() && keys.quaternion.is_some() {
        let message = "both `attitude` and `quaternion`, expected at most one of them";
        return Err(Refusal::at("quaternion", message).into());
    }
    let quaternion = keys.quaternion.map(unit).transpose()?;
    let attitude = quaternion.as_ref().map_or_else(|| attitude(keys.attitude), rotation);
    let mut body = RigidBodySpec::new(inertia, momentum.into(), attitude)?;
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

impl RigidBodySpec {
    /// The system that has these quantities, on a layer.
    fn system(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn ProblemSpec>, Error> {
        Ok(match (layer, needs_attitude(quantities)) {
            (Layer::General, _) if self.quaternion.is_some() => {
                return Err(Error::Unsupported {
                    what: "layer",
                    with: "`general` and a quaternion".into(),
                    why: "quaternions have closed forms only; leave layer out",
                });
            }
            (Layer::Closed, false) => Box::new(Stated(Body::<MomentumOnly>::new(self)?)),
            (Layer::Closed, true) if self.quaternion.is_some() => {
                Box::new(Stated(Body::<Quaternion>::new(self)?))
            }
            (Layer::Closed, true) => Box::new(Stated(Body::<Attitude>::new(self)?)),
            (Layer::General, false) => Box::new(Stated(Body::<MomentumMatrix>::new(self)?)),
            (Layer::General, true) => Box::new(Stated(Body::<AttitudeMatrix>::new(self)?)),
        })
    }
}

impl ProblemSpec for RigidBodySpec {
    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn model(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn Model>, Error> {
        let model = self.system(layer, quantities)?.model(layer, quantities)?;
        let by_method =
            layer == Layer::Closed && needs_attitude(quantities) && self.quaternion.is_none();
        if !by_method {
            return Ok(model);
        }
        let state = Stated(Body::<State>::new(self)?).model(layer, quantities)?;
        Ok(Box::new(ByMethod { attitude: model, state }))
    }
    fn state(&self, quantities: &[&str]) -> &'static [&'static str] {
        match needs_attitude(quantities) {
            true => Body::<Attitude>::STATE,
            false => Body::<MomentumOnly>::STATE,
        }
    }
    /// With the attitude, as the scene states it.
    fn default_state(&self) -> &'static [&'static str] {
        match self.quaternion {
            Some(_) => &["momentum_body", "quaternion"],
            None => &["momentum_body", "attitude"],
        }
    }
    fn layers(&self) -> &'static [Layer] {
        match self.quaternion {
            Some(_) => &[Layer::Closed],
            None => &Layer::ALL,
        }
    }
    /// None of a body that cannot be set up.
    fn invariants(&self, quantities: &[&str]) -> Vec<&'static str> {
        let system = self.system(Layer::Closed, quantities);
        system.map_or_else(|_| Vec::new(), |system| system.invariants(quantities))
    }
    fn inertia(&self) -> Option<PrincipalInertia> {
        let diagonal = PrincipalInertia::diagonal(self.inertia);
        let axes =
            |axes: Matrix3<f64>| core::array::from_fn(|i| axes.column(i).into_owned().into());
        let axes = self.axes.map_or(diagonal.axes, axes);
        Some(PrincipalInertia { axes, ..diagonal })
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
