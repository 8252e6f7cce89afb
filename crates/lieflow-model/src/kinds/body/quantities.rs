//! The quantities of bodies, each once: `momentum_body`, `attitude`, `axis`, … of every [`AsBody`].

use lieflow::groups::{LieGroup, So3, vee};
use lieflow::so3::{quaternion_from_matrix, quaternion_to_wxyz};
use lieflow_runs::schema::Branch;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::euler::SEQUENCES;
use super::rotation;
use crate::kinds::prelude::*;
use crate::problem::PointOf;

/// A rotation from body to space, as it is integrated.
pub(in crate::kinds) enum Orientation {
    NotModelled,
    Matrix(Matrix3<f64>),
    Quaternion(UnitQuaternion<f64>),
}

impl Orientation {
    /// The rotation; the identity where none is modelled.
    pub(in crate::kinds) fn rotation(&self) -> Matrix3<f64> {
        match self {
            Orientation::NotModelled => Matrix3::identity(),
            Orientation::Matrix(g) => *g,
            Orientation::Quaternion(q) => rotation(q),
        }
    }
    /// The quaternion; one of the two of the polar factor of a matrix, and NaN where the matrix is far from all rotations.
    pub(in crate::kinds) fn quaternion(&self) -> UnitQuaternion<f64> {
        if let Orientation::Quaternion(q) = self {
            return *q;
        }
        let nan = UnitQuaternion::new_unchecked([f64::NAN; 4].into());
        let rotation = self.rotation();
        quaternion_from_matrix(&rotation)
            .or_else(|_| quaternion_from_matrix(&nearer(rotation)))
            .unwrap_or(nan)
    }
    /// The same with the axes of the body turned by this rotation.
    pub(in crate::kinds) fn about(self, turn: &Matrix3<f64>) -> Self {
        match self {
            Orientation::NotModelled => Orientation::NotModelled,
            Orientation::Matrix(g) => Orientation::Matrix(g * turn.transpose()),
            Orientation::Quaternion(q) => {
                let turn =
                    quaternion_from_matrix(turn).unwrap_or_else(|_| UnitQuaternion::identity());
                Orientation::Quaternion(q * turn.conjugate())
            }
        }
    }
}

/// Newton–Schulz steps to the polar factor. Each squares the distance.
const NEARER: usize = 6;

/// A matrix near the rotations, as methods that leave the group make them, nearer to its polar factor: by Newton–Schulz steps.
fn nearer(mut g: Matrix3<f64>) -> Matrix3<f64> {
    for _ in 0..NEARER {
        g = g * (Matrix3::identity() * 1.5 - g.tr_mul(&g) * 0.5);
    }
    g
}

/// A system with a rotation from body to space.
pub(in crate::kinds) trait Oriented: System {
    /// The rotation to space.
    fn orientation(&self, y: &PointOf<Self>) -> Orientation;
    /// The angular velocity in the body, along the axes that the rotation is about.
    fn turning(&self, t: f64, y: &PointOf<Self>) -> Vector3<f64>;
    /// Why the problem has no orientation, if it has none.
    fn without_orientation(&self) -> Option<&'static str> {
        None
    }
    /// The axes that the rotation is about, in those of the scene, where they are others.
    fn axes(&self) -> Option<Matrix3<f64>> {
        None
    }

    /// A vector along the axes of the scene.
    fn in_scene(&self, x: Vector3<f64>) -> Vector3<f64> {
        self.axes().map_or(x, |axes| axes * x)
    }
    /// The rotation from the axes of the scene to space.
    fn attitude(&self, y: &PointOf<Self>) -> Matrix3<f64> {
        let g = self.orientation(y).rotation();
        self.axes().map_or(g, |axes| g * axes.transpose())
    }
}

/// A system that is a body: what its quantities are made of, along its principal axes.
pub(in crate::kinds) trait AsBody: Oriented {
    /// The momentum in the body.
    fn momentum(&self, y: &PointOf<Self>) -> Vector3<f64>;
    /// The angular velocity in the body.
    fn omega(&self, y: &PointOf<Self>) -> Vector3<f64>;
    /// The momentum in space.
    fn momentum_in_space(&self, y: &PointOf<Self>) -> Vector3<f64> {
        self.orientation(y).rotation() * self.momentum(y)
    }
    /// The third direction of space, seen from the body.
    fn vertical(&self, y: &PointOf<Self>) -> Vector3<f64> {
        self.orientation(y).rotation().row(2).transpose()
    }
}

/// The angular momentum in the body under these columns.
pub(in crate::kinds) const fn momentum_body<S: AsBody>(
    columns: &'static [&'static str],
) -> Quantity<S> {
    Quantity::numbers(
        "momentum_body",
        columns,
        "angular momentum in the body",
        |body: &S, _, y, row| row.extend(body.in_scene(body.momentum(y)).iter()),
    )
    .of_dimension(Dimension::ANGULAR_MOMENTUM)
}

/// The angular velocity in the body.
pub(in crate::kinds) const fn omega_body<S: AsBody>() -> Quantity<S> {
    Quantity::numbers(
        "omega_body",
        &["w1", "w2", "w3"],
        "angular velocity in the body",
        |body: &S, _, y, row| row.extend(body.in_scene(body.omega(y)).iter()),
    )
    .of_dimension(Dimension::RATE)
}

/// The angular momentum in space.
pub(in crate::kinds) const fn momentum_space<S: AsBody>() -> Quantity<S> {
    Quantity::numbers(
        "momentum_space",
        &["l1", "l2", "l3"],
        "angular momentum in space",
        |body: &S, _, y, row| row.extend(body.momentum_in_space(y).iter()),
    )
    .of_dimension(Dimension::ANGULAR_MOMENTUM)
    .missing_where(S::without_orientation)
}

/// The angular velocity in space.
pub(in crate::kinds) const fn omega_space<S: AsBody>() -> Quantity<S> {
    Quantity::numbers(
        "omega_space",
        &["ws1", "ws2", "ws3"],
        "angular velocity in space",
        |body: &S, _, y, row| {
            row.extend((body.orientation(y).rotation() * body.omega(y)).iter());
        },
    )
    .of_dimension(Dimension::RATE)
    .missing_where(S::without_orientation)
}

/// The attitude as a matrix.
pub(in crate::kinds) const fn attitude<S: AsBody>() -> Quantity<S> {
    Quantity::numbers(
        "attitude",
        &["g11", "g12", "g13", "g21", "g22", "g23", "g31", "g32", "g33"],
        "rotation from body to space, row by row; rigid-body and heavy-top integrate it only when asked for",
        |body: &S, _, y, row| row.extend(body.attitude(y).transpose().iter()),
    )
    .of_rotation()
    .drawn_as("quaternion")
    .missing_where(S::without_orientation)
}

/// The quaternion of the attitude, and whether its sign is that of the state; NaN where the state is no rotation.
fn wxyz<S: Oriented>(body: &S, y: &PointOf<S>) -> ([f64; 4], bool) {
    let orientation = body.orientation(y);
    // The quaternion by which the start was multiplied: of its two signs, the transpose may have the other one.
    let axes =
        body.axes().map_or(Ok(UnitQuaternion::identity()), |axes| quaternion_from_matrix(&axes));
    let q = axes.map(|axes| quaternion_to_wxyz(&(orientation.quaternion() * axes.conjugate())));
    (q.unwrap_or([f64::NAN; 4]), matches!(orientation, Orientation::Quaternion(_)))
}

/// The attitude as a quaternion.
pub(in crate::kinds) const fn quaternion<S: Oriented>() -> Quantity<S> {
    Quantity::numbers(
        "quaternion",
        &["qw", "qx", "qy", "qz"],
        "the attitude as a unit quaternion, real part first, x -> q x q*; q and -q are the same attitude: it is continuous \
         from the start on, also between rows; the first row has qw >= 0, or the sign of the key quaternion of a rigid-body",
        |body: &S, _, y, row| {
            let (q, is_given) = wxyz(body, y);
            row.extend(if q[0] < 0.0 && !is_given { q.map(|x| -x) } else { q });
        },
    )
    .of_quaternion()
    .continuous_by(|_| Branch::Sign)
    .turning_by(|body: &S, t, y| body.turning(t, y).norm())
    .missing_where(S::without_orientation)
}

/// The attitude as the Euler angles of a sequence.
pub(in crate::kinds) const fn angles<S: Oriented, const SEQUENCE: usize>() -> Quantity<S> {
    let sequence = &SEQUENCES[SEQUENCE];
    Quantity::numbers(sequence.name, sequence.columns, sequence.meaning(), |body: &S, _, y, row| {
        row.extend(SEQUENCES[SEQUENCE].angles(wxyz(body, y).0))
    })
    .in_radians()
    .continuous_by(|_| SEQUENCES[SEQUENCE].branch())
    .turning_by(|body: &S, t, y| {
        SEQUENCES[SEQUENCE].rate(&body.attitude(y), &body.in_scene(body.turning(t, y)))
    })
    .missing_where(S::without_orientation)
}

/// The quantities of a kind, and after them the Euler angles in all sequences.
macro_rules! with_angles {
    ($($quantity:expr,)*) => {
        with_angles!(@ $($quantity,)*; 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23)
    };
    (@ $($quantity:expr,)*; $($sequence:literal)*) => {
        &[$($quantity,)* $($crate::kinds::body::angles::<Self, $sequence>(),)*]
    };
}
pub(in crate::kinds) use with_angles;

/// The third axis of the body, in space.
pub(in crate::kinds) const fn axis<S: AsBody>() -> Quantity<S> {
    Quantity::numbers(
        "axis",
        &["a1", "a2", "a3"],
        "the third axis of the body, in space",
        |body: &S, _, y, row| row.extend(body.attitude(y).column(2).iter()),
    )
    .missing_where(S::without_orientation)
}

/// The angle between the third axis of the body and the third direction of space.
pub(in crate::kinds) const fn nutation<S: AsBody>() -> Quantity<S> {
    Quantity::number(
        "nutation",
        "angle between the third axis of the body and e3 in space, the vertical of a top; in radians, 0 to pi",
        |body: &S, _, y| {
            let up = body.in_scene(body.vertical(y));
            // Exact near 0 and near π.
            up[0].hypot(up[1]).atan2(up[2])
        },
    )
    .in_radians()
}

/// The angle of the attitude.
pub(in crate::kinds) const fn angle<S: AsBody>() -> Quantity<S> {
    // Exact near 0 and near π: the sine and the cosine.
    Quantity::number(
        "angle",
        "angle of the attitude from the identity, in radians",
        |body: &S, _, y| {
            let g = body.attitude(y);
            let sine = vee(&((g - g.transpose()) * 0.5)).norm();
            sine.atan2(0.5 * (g.trace() - 1.0))
        },
    )
    .in_radians()
    .missing_where(S::without_orientation)
}

/// The length of the angular momentum.
pub(in crate::kinds) const fn momentum_norm<S: AsBody>() -> Quantity<S> {
    Quantity::number("momentum_norm", "length of the angular momentum", |body: &S, _, y| {
        length(&body.momentum(y))
    })
    .of_dimension(Dimension::ANGULAR_MOMENTUM)
}

/// The distance of the attitude from SO(3).
pub(in crate::kinds) const fn attitude_defect<S: AsBody>() -> Quantity<S> {
    Quantity::number(
        "attitude_defect",
        "distance of gᵀg from the identity, for g the attitude",
        |body: &S, _, y| So3::new().defect(&body.orientation(y).rotation()),
    )
    .kept(Law::by_the_action(2).on_scale(Scale::One))
    .of_distance()
    .missing_where(S::without_orientation)
}
