//! The keys of a body and its start, and those of an attitude.

use crate::problem::group;

group! {
    /// The keys of a body and its velocity, of every kind of bodies. The library's moments are about principal axes.
    BodyKeys in (crate::kinds::body) = body_keys $,
    before {
        inertia: Option<crate::reader::values::Diagonal> [INERTIA] =
            "principal moments of inertia [J1, J2, J3], or the tensor of inertia as three rows",
        inverse_inertia: Option<crate::reader::values::Reals<3>> = "their reciprocals, instead of inertia",
        shape: Option<crate::kinds::body::Shape> =
            "instead of inertia: {kind = \"box\", mass, sides = [a, b, c]}, {kind = \"ellipsoid\", mass, \
             semi_axes}, {kind = \"cylinder\", mass, radius, height}",
        omega_body: Option<crate::reader::values::Reals<3>> [RATE] = "initial angular velocity in the body",
        momentum_body: Option<crate::reader::values::Reals<3>> [ANGULAR_MOMENTUM] =
            "initial angular momentum in the body, instead of omega_body",
        omega_space: Option<crate::reader::values::Reals<3>> [RATE] =
            "initial angular velocity in space, instead of omega_body",
        momentum_space: Option<crate::reader::values::Reals<3>> [ANGULAR_MOMENTUM] =
            "initial angular momentum in space, instead of omega_body",
    }
    after {}
}

group! {
    /// The keys of an initial attitude: a matrix, a quaternion, or angles.
    AttitudeKeys in (crate::kinds::body) = attitude_keys $,
    before {
        attitude: Option<crate::reader::values::Rows<3>> =
            "initial rotation from body to space, three rows; left out, it is the identity, but a heavy-top needs it or vertical",
        quaternion: Option<crate::reader::values::Reals<4>> =
            "the same as a unit quaternion [w, x, y, z], instead of attitude; a rigid-body is then integrated by its \
             quaternion",
        euler: std::collections::BTreeMap<String, crate::reader::values::Reals<3>> =
            "the same as Euler angles in radians, instead of attitude: euler.zyx = [yaw, pitch, roll] turns about z, \
             then the new y, then the new x; any other sequence such as euler.zxz too",
        fixed: std::collections::BTreeMap<String, crate::reader::values::Reals<3>> =
            "the same as turns about fixed axes of space: fixed.xyz = [about x, then y, then z]",
    }
    after {}
}
