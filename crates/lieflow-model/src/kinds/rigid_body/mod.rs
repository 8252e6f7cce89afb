//! `kind = "rigid-body"`: the free rigid body in ℝ³.

mod model;

use nalgebra::Matrix3;

use self::model::{
    Attitude, AttitudeMatrix, Body, MomentumMatrix, MomentumOnly, Quaternion, State,
};
use super::body::{attitude_keys, body_keys};
use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-body",
    equation: "ṁ = m × ω, m = Jω, in the body; ġ = gω̂ takes the body to space",
    summary: "the free rigid body, by its momentum on so(3)*, its attitude on SO(3) or its quaternion",
    ..Kind::of::<Keys, Body<Attitude>>(|section| read_with(section, read))
};

keys! { Keys [attitude_keys body_keys] {} }

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let body = keys.body_keys().start(&keys.attitude_keys(), Matrix3::identity())?;
    let momentum = Forms::of(Body::<MomentumOnly>::new(&body)?);
    let forms = match body.quaternion {
        Some(_) => momentum
            .or(Forms::of(Body::<Quaternion>::new(&body)?))
            .written(&["momentum_body", "quaternion"]),
        None => momentum
            .or(Forms::of(Body::<Attitude>::new(&body)?))
            .or(Forms::of(Body::<State>::new(&body)?).for_whole_state())
            .or(Forms::of(Body::<MomentumMatrix>::new(&body)?))
            .or(Forms::of(Body::<AttitudeMatrix>::new(&body)?))
            .written(&["momentum_body", "attitude"]),
    };
    Ok(forms.with_spec(body))
}
