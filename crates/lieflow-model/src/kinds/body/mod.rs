//! What all kinds of bodies share: their keys ([`BodyKeys`], [`AttitudeKeys`]), the start that these state, and their quantities.

mod euler;
mod keys;
mod quantities;
mod shape;

use std::collections::BTreeMap;
use std::sync::OnceLock;

use faer::Mat;
use lieflow::Error;
use lieflow::groups::{LieGroup, MEMBERSHIP, So3};
use lieflow::problems::inertia::{impossible, principal_axes};
use lieflow::problems::{Exact, RigidBody};
use lieflow::so3::{quaternion_from_matrix, quaternion_from_wxyz};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

pub(crate) use self::keys::{AttitudeKeys, BodyKeys};
pub(super) use self::keys::{attitude_keys, body_keys};
pub(super) use self::quantities::*;
pub(crate) use self::shape::Shape;
use super::entries::check_symmetric;
use super::prelude::*;
use crate::reader::values::Diagonal;

/// A rigid body with its initial state.
#[derive(Clone, Debug)]
pub struct RigidBodySpec {
    /// Principal moments of inertia.
    pub inertia: [f64; 3],
    /// Initial angular momentum in the body, along the principal axes.
    pub momentum_body: [f64; 3],
    /// Initial rotation to space, from the frame of the principal axes.
    pub attitude: Matrix3<f64>,
    /// The initial rotation as a quaternion, if the scene gives a quaternion.
    pub quaternion: Option<UnitQuaternion<f64>>,
    /// The principal axes, as columns, in the frame that the scene is written in, where that is
    /// another.
    pub axes: Option<Matrix3<f64>>,
    /// Changes that were made to numbers of the scene.
    pub notes: Vec<String>,
    /// The motion without torque, when it was asked for.
    orbit: OnceLock<Exact>,
}

impl RigidBodySpec {
    /// The length of the angular velocity at the start.
    pub(super) fn rate(&self) -> f64 {
        let pairs = self.momentum_body.iter().zip(&self.inertia);
        pairs.map(|(m, moment)| (m / moment).powi(2)).sum::<f64>().sqrt()
    }

    /// The inertia along the principal axes, in the frame that the scene is written in.
    pub fn principal_inertia(&self) -> PrincipalInertia {
        let diagonal = PrincipalInertia::diagonal(self.inertia);
        let columns =
            |axes: Matrix3<f64>| core::array::from_fn(|i| axes.column(i).into_owned().into());
        PrincipalInertia { axes: self.axes.map_or(diagonal.axes, columns), ..diagonal }
    }

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
        let (quaternion, axes, notes, orbit) = (None, None, Vec::new(), OnceLock::new());
        Ok(RigidBodySpec { inertia, momentum_body, attitude, quaternion, axes, notes, orbit })
    }

    /// The motion without torque, from the start. The constants of its orbit are computed once.
    ///
    /// # Errors
    /// Those of [`Exact::new`].
    pub(super) fn exact(&self) -> Result<&Exact, Error> {
        if let Some(orbit) = self.orbit.get() {
            return Ok(orbit);
        }
        let orbit = Exact::new(self.inertia, self.momentum_body, self.attitude)?;
        Ok(self.orbit.get_or_init(|| orbit))
    }

    /// The momentum in space.
    pub(super) fn momentum_space(&self) -> Vector3<f64> {
        self.attitude * Vector3::from(self.momentum_body)
    }

    /// A vector of the scene's frame along the principal axes.
    pub(super) fn along_axes(&self, x: Vector3<f64>) -> Vector3<f64> {
        self.axes.map_or(x, |axes| axes.tr_mul(&x))
    }

    /// The warning about moments of inertia that no body has.
    pub(super) fn impossible(&self) -> Vec<String> {
        impossible(self.inertia).map(|why| format!("inertia: {why}")).into_iter().collect()
    }
}

/// Numbers that are typed with a few digits are as far as this from what they stand for.
pub(super) const TYPED: f64 = 1e-3;

/// Checks that a vector has length 1 to the digits that it is written with. Few digits give a note.
///
/// # Errors
/// A refusal of `key`.
pub(super) fn check_unit(key: &str, x: &[f64], notes: &mut Vec<String>) -> Result<(), Refusal> {
    let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    match (length - 1.0).abs() {
        away if away <= MEMBERSHIP => Ok(()),
        away if away <= TYPED => {
            notes.push(format!("{key}: its length is {length:.7}; it is divided by that"));
            Ok(())
        }
        _ => {
            let unit: Vec<f64> = x.iter().map(|x| (1e7 * x / length).round() / 1e7).collect();
            let help = format!("the same direction of length 1 is {unit:?}");
            let help = (length > 0.0 && length.is_finite()).then_some(help);
            Err(Refusal { help, ..Refusal::at(key, format!("its length is {length}, expected 1")) })
        }
    }
}

/// The rotation that a matrix is, to the digits that it is written with: the nearest one, with a note, where these
/// are few.
///
/// # Errors
/// A refusal of `key` for a matrix that is no rotation.
pub(super) fn check_rotation(
    key: &str,
    g: Matrix3<f64>,
    notes: &mut Vec<String>,
) -> Result<Matrix3<f64>, Refusal> {
    let Err(error) = So3::new().check_element("attitude", &g, MEMBERSHIP) else { return Ok(g) };
    let refused = || {
        let away = So3::new().defect(&g);
        let message = match error {
            Error::Reflection { .. } => {
                "its determinant is -1, expected a rotation of SO(3)".into()
            }
            _ => format!(
                "not in SO(3): its rows are no unit vectors at right angles; they miss this by {away:.1e}, expected \
                 at most {TYPED:.0e}"
            ),
        };
        Refusal::at(key, format!("{key}: {message}"))
    };
    let turned = g.svd(true, true);
    let (Some(u), Some(v)) = (turned.u, turned.v_t) else { return Err(refused()) };
    let nearest = u * v;
    let moved = (nearest - g).amax();
    // A number that is not finite is not near.
    if !(moved <= TYPED && nearest.determinant() > 0.0) {
        return Err(refused());
    }
    notes.push(format!(
        "{key}: it is replaced by the nearest rotation, which moves its entries by up to {moved:.1e}"
    ));
    Ok(nearest)
}

/// The rotation of a quaternion.
pub(super) fn rotation(q: &UnitQuaternion<f64>) -> Matrix3<f64> {
    q.to_rotation_matrix().into_inner()
}

/// Principal moments of inertia, and the principal axes where the scene's are others.
type Principal = ([f64; 3], Option<Matrix3<f64>>);

impl AttitudeKeys {
    /// Does the scene say how the body stands?
    pub(super) fn has_attitude(&self) -> bool {
        let Self { attitude, quaternion, euler, fixed } = self;
        let has_angles =
            [euler, fixed].iter().any(|angles| !matches!(angles, Ok(angles) if angles.is_empty()));
        has_angles || !matches!((attitude, quaternion), (Ok(None), Ok(None)))
    }

    /// The rotation to space as the scene has it, and its quaternion where the scene gives one.
    pub(super) fn orientation(
        &self,
        otherwise: Matrix3<f64>,
        notes: &mut Vec<String>,
    ) -> Result<(Matrix3<f64>, Option<UnitQuaternion<f64>>), ReadError> {
        let angles = [("euler", &self.euler), ("fixed", &self.fixed)];
        let has_angles = |(key, table): (_, &Key<BTreeMap<_, _>>)| {
            (key, seen(table).is_ok_and(|table| !table.is_empty()))
        };
        let both =
            [("attitude", is_given(&self.attitude)), ("quaternion", is_given(&self.quaternion))];
        let stated = both.into_iter().chain(angles.map(has_angles));
        let mut stated = stated.filter(|(_, stated)| *stated).map(|(key, _)| key);
        if let (Some(a), Some(b)) = (stated.next(), stated.next()) {
            let message = format!("both `{a}` and `{b}`, expected at most one of them");
            return Err(Refusal::at(b, message).into());
        }
        if let Some(rows) = seen(&self.attitude)? {
            let g = Matrix3::from_fn(|i, j| rows.0[i][j]);
            return Ok((check_rotation("attitude", g, notes)?, None));
        }
        if let Some(wxyz) = seen(&self.quaternion)? {
            check_unit("quaternion", &wxyz.0, notes)?;
            let q = quaternion_from_wxyz(wxyz.0)?;
            return Ok((rotation(&q), Some(q)));
        }
        let mut attitude = otherwise;
        for (key, table) in angles {
            attitude = euler::stated(key, seen(table)?)?.map_or(attitude, |q| rotation(&q));
        }
        Ok((attitude, None))
    }
}

impl BodyKeys {
    /// The body with its start; the attitude where the scene does not say it.
    ///
    /// # Errors
    /// Refusals of the keys that cannot be used.
    pub(super) fn start(
        self,
        attitude: &AttitudeKeys,
        otherwise: Matrix3<f64>,
    ) -> Result<RigidBodySpec, ReadError> {
        let mut notes = Vec::new();
        let (principal, rate) = (self.principal(), self.rate());
        let orientation = attitude.orientation(otherwise, &mut notes);
        let ((inertia, axes), rate, (mut attitude, mut quaternion)) =
            all!(principal, rate, orientation)?;
        let momentum = momentum(rate, inertia, axes.as_ref(), &attitude)?;
        if let Some(axes) = axes {
            attitude *= axes;
            if let Some(q) = &mut quaternion {
                *q *= quaternion_from_matrix(&axes)?;
            }
        }
        let body = RigidBodySpec::new(inertia, momentum.into(), attitude)?;
        Ok(RigidBodySpec { quaternion, axes, notes, ..body })
    }

    /// The initial velocity or momentum.
    fn rate(&self) -> Result<Rate, ReadError> {
        let keys = [
            ("omega_body", &self.omega_body, false, false),
            ("momentum_body", &self.momentum_body, true, false),
            ("omega_space", &self.omega_space, false, true),
            ("momentum_space", &self.momentum_space, true, true),
        ];
        one_of(keys.map(|(key, x, ..)| (key, is_given(x))), "exactly one")?;
        for (key, x, is_momentum, in_space) in keys {
            if let Some(Reals(x)) = *seen(x)? {
                return Ok(Rate { key, x, is_momentum, in_space });
            }
        }
        let names = keys.map(|(key, ..)| format!("`{key}`")).join(", ");
        Err(Refusal::section(format!("expected one of {names}, found none")).into())
    }

    fn principal(&self) -> Result<Principal, ReadError> {
        let keys = [
            ("inertia", is_given(&self.inertia)),
            ("inverse_inertia", is_given(&self.inverse_inertia)),
            ("shape", is_given(&self.shape)),
        ];
        one_of(keys, "exactly one")?;
        let (inertia, axes) = match seen(&self.shape)? {
            Some(shape) => (shape.moments()?, None),
            None => self.of_inertia()?,
        };
        RigidBody::<f64>::new(inertia)?;
        Ok((inertia, axes))
    }

    fn of_inertia(&self) -> Result<Principal, ReadError> {
        let (inertia, inverse) = (*seen(&self.inertia)?, *seen(&self.inverse_inertia)?);
        match exactly_one(("inertia", inertia), ("inverse_inertia", inverse))? {
            Either::First(Diagonal::List(inertia)) => Ok((inertia, None)),
            Either::First(Diagonal::Rows(rows)) => {
                let rounding = 64.0 * f64::EPSILON;
                check_symmetric("inertia", &Mat::from_fn(3, 3, |i, j| rows[i][j]), rounding)?;
                let tensor = Matrix3::from_rows(&rows.map(|row| Vector3::from(row).transpose()));
                let refused = |error: Error| Refusal::from(error).about("inertia");
                let (inertia, axes) = principal_axes(&tensor).map_err(refused)?;
                Ok((inertia, Some(axes)))
            }
            Either::Second(inverse) => {
                let range = "a finite number > 0 with a finite reciprocal";
                let good = |x: f64| x > 0.0 && (1.0 / x).is_normal();
                check_each("inverse_inertia", &inverse.0, range, good)?;
                Ok((inverse.0.map(f64::recip), None))
            }
        }
    }
}

/// Is the key there, with a value that can be used?
fn is_given<T>(key: &Key<Option<T>>) -> bool {
    matches!(key, Ok(Some(_)))
}

/// An initial velocity or momentum, and the key that states it.
struct Rate {
    key: &'static str,
    x: [f64; 3],
    is_momentum: bool,
    in_space: bool,
}

/// The initial momentum in the body along the principal axes, by a velocity or a momentum; g as the scene has it.
fn momentum(
    Rate { key, x, is_momentum, in_space }: Rate,
    inertia: [f64; 3],
    axes: Option<&Matrix3<f64>>,
    g: &Matrix3<f64>,
) -> Result<Vector3<f64>, Refusal> {
    let x = if in_space { g.tr_mul(&x.into()) } else { x.into() };
    let x = axes.map_or(x, |axes| axes.tr_mul(&x));
    if is_momentum {
        return Ok(x);
    }
    let momentum = Vector3::from(inertia).component_mul(&x);
    match momentum.iter().position(|m| !m.is_finite()) {
        None => Ok(momentum),
        Some(i) => {
            let (at, of) = (key.index(i), "inertia".index(i));
            let message = format!("the momentum {of} * {at} is not finite");
            Err(Refusal::at(at, message))
        }
    }
}

/// Checks that every entry of a list is in range.
///
/// # Errors
/// [`Error::OutOfRange`] for the first entry that is not.
pub(super) fn check_each(
    arg: &str,
    values: &[f64],
    expected: &str,
    good: impl Fn(f64) -> bool,
) -> Result<(), Error> {
    match values.iter().position(|&x| !good(x)) {
        None => Ok(()),
        // The library counts from 0.
        Some(i) => Err(Error::OutOfRange {
            arg: format!("{arg}[{i}]"),
            value: values[i],
            expected: expected.into(),
        }),
    }
}
