//! `kind = "rigid-body"`: the free rigid body in ℝ³.

mod model;

use lieflow::catalog::MethodSpec;
use nalgebra::Matrix3;

use self::model::{
    Attitude, AttitudeMatrix, Body, ByMethod, MomentumMatrix, MomentumOnly, Quaternion, State,
};
use super::body::{RigidBodySpec, body_keys};
use super::prelude::*;
use crate::problem::Model;
use crate::problem::SERIES;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-body",
    equation: "ṁ = m × ω, m = Jω, in the body; ġ = gω̂ takes the body to space",
    summary: "the free rigid body, by its momentum on so(3)*, its attitude on SO(3) or its quaternion",
    ..Kind::of::<Keys, Body<Attitude>>(|section| read(Read::read(section)?))
};

keys! { Keys [body_keys] {} }

fn read(mut keys: Keys) -> Result<Box<dyn ProblemSpec>, ReadError> {
    Ok(Box::new(keys.body_keys().start(Matrix3::identity())?))
}

/// Do these quantities need the attitude? Not of a body that cannot be set up.
fn needs_attitude(body: &RigidBodySpec, quantities: &[&str]) -> bool {
    let momentum = Body::<MomentumOnly>::new(body);
    momentum.is_ok_and(|momentum| lacks_any(&Stated(momentum), quantities))
}

impl RigidBodySpec {
    /// The system that has these quantities, on a layer.
    fn system(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn ProblemSpec>, Error> {
        Ok(match (layer, needs_attitude(self, quantities)) {
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
            layer == Layer::Closed && needs_attitude(self, quantities) && self.quaternion.is_none();
        if !by_method {
            return Ok(model);
        }
        let state = Stated(Body::<State>::new(self)?).model(layer, quantities)?;
        Ok(Box::new(ByMethod { attitude: model, state }))
    }
    fn state(&self, quantities: &[&str]) -> &'static [&'static str] {
        match needs_attitude(self, quantities) {
            true => Body::<Attitude>::STATE,
            false => Body::<MomentumOnly>::STATE,
        }
    }
    /// The momentum and the attitude, in the form of the scene.
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
    fn default_method(&self) -> MethodSpec {
        MethodSpec::new(SERIES, None)
    }
    fn inertia(&self) -> Option<PrincipalInertia> {
        Some(self.principal_inertia())
    }
    fn figure(&self, _: &[&str]) -> Figure {
        Figure::Sphere("momentum_body")
    }
    fn warnings(&self) -> Vec<String> {
        self.impossible()
    }
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}
