//! Euler angles in all 24 sequences: three turns about axes that are named by letters, as in `zyx`.
//!
//! `euler_zyx` are turns about z, then the new y, then the new x (yaw, pitch and roll; SciPy's `"ZYX"`). `fixed_zyx` are
//! turns about the fixed axes z, then y, then x (SciPy's `"zyx"`). Both name the rotation from the body to space.
//!
//! Source: E. Bernardes, S. Viollet, Quaternion to Euler angles conversion (PLoS ONE 17, 2022), which is exact near the
//! singular angles, too.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use lieflow_runs::schema::Branch;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::reader::values::Reals;
use crate::reader::{KeyPath, ReadError, Refusal, help_for};

/// The axes of three turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::kinds) struct Sequence {
    /// The letters of the axes.
    pub(super) letters: &'static str,
    /// The name of the quantity of its angles.
    pub(super) name: &'static str,
    /// Their columns.
    pub(super) columns: &'static [&'static str; 3],
    /// The numbers of the axes, from 0.
    axes: [usize; 3],
    /// Do the axes stay where they are?
    fixed: bool,
}

/// The sequences about axes that move with the body, and about fixed ones.
macro_rules! sequences {
    ($($letters:literal [$($axis:literal)*])*) => {
        /// All sequences: those about axes that move, then those about fixed ones.
        pub(super) const SEQUENCES: [Sequence; 24] = [
            $(sequences!(one "euler_", $letters, [$($axis),*], false),)*
            $(sequences!(one "fixed_", $letters, [$($axis),*], true),)*
        ];
    };
    (one $frame:literal, $letters:literal, $axes:expr, $fixed:literal) => {
        Sequence {
            letters: $letters,
            name: concat!($frame, $letters),
            columns: &[
                concat!($frame, $letters, "1"),
                concat!($frame, $letters, "2"),
                concat!($frame, $letters, "3"),
            ],
            axes: $axes,
            fixed: $fixed,
        }
    };
}

sequences! {
    "xyz" [0 1 2] "xzy" [0 2 1] "yxz" [1 0 2] "yzx" [1 2 0] "zxy" [2 0 1] "zyx" [2 1 0]
    "xyx" [0 1 0] "xzx" [0 2 0] "yxy" [1 0 1] "yzy" [1 2 1] "zxz" [2 0 2] "zyz" [2 1 2]
}

impl Sequence {
    /// What the angles are.
    pub(super) const fn meaning(&self) -> &'static str {
        match self.fixed {
            false => {
                "Euler angles of the attitude: turns about these axes of the body, one after the other, as zyx: yaw, \
                 pitch, roll; in radians, the first and the third continuous from row to row"
            }
            true => {
                "the same about fixed axes of space, the first letter first; fixed_xyz is euler_zyx in reverse order"
            }
        }
    }

    /// The choices that stand for the same attitude.
    pub(super) const fn branch(&self) -> Branch {
        let [i, j, k] = self.axes;
        let is_proper = i == k;
        // An order as xyz is even. About fixed axes the same turns come in reverse.
        let is_even = (j + 3 - i) % 3 == 1;
        Branch::Euler { is_proper, rises: is_proper || is_even == self.fixed }
    }

    /// The angles of a rotation. The second is within [0, π] where the first axis is the third, and within [−π/2, π/2]
    /// otherwise. Where it is at an end of these, the third is 0.
    pub(super) fn angles(&self, [w, x, y, z]: [f64; 4]) -> [f64; 3] {
        let parts = [x, y, z];
        // The formulas are those of fixed axes.
        let [i, j, k] =
            if self.fixed { self.axes } else { [self.axes[2], self.axes[1], self.axes[0]] };
        let is_proper = i == k;
        let k = if is_proper { 3 - i - j } else { k };
        let sign = if (j + 3 - i) % 3 == 1 { 1.0 } else { -1.0 };
        let (qi, qj, qk) = (parts[i], parts[j], sign * parts[k]);
        let [a, b, c, d] = match is_proper {
            true => [w, qi, qj, qk],
            false => [w - qj, qi + qk, qj + w, qk - qi],
        };
        let second = 2.0 * c.hypot(d).atan2(a.hypot(b));
        let (sum, difference) = (b.atan2(a), d.atan2(c));
        let third = |x: f64| if is_proper { x } else { sign * x };
        let [first, last] = match Ends::of(second) {
            Ends::Neither => [sum - difference, third(sum + difference)],
            // In the order of fixed axes: one of the two angles is 0.
            Ends::Low if self.fixed => [2.0 * sum, 0.0],
            Ends::High if self.fixed => [-2.0 * difference, 0.0],
            Ends::Low => [0.0, third(2.0 * sum)],
            Ends::High => [0.0, third(2.0 * difference)],
        };
        let second = if is_proper { second } else { second - FRAC_PI_2 };
        let within = |x: f64| x - TAU * (x / TAU).round();
        let [first, last] = [first, last].map(within);
        if self.fixed { [first, second, last] } else { [last, second, first] }
    }

    /// A bound of the rates of the angles, at the rotation g with this angular velocity in the body.
    ///
    /// The first angle is the longitude in space of an axis of the body, the third is that in the body of an axis of space.
    /// The poles are where the sequence is singular. A longitude turns as fast as its axis moves, divided by the distance from
    /// the poles.
    pub(super) fn rate(&self, g: &Matrix3<f64>, omega: &Vector3<f64>) -> f64 {
        let [first, _, last] = self.axes;
        let [space, body] = if self.fixed { [last, first] } else { [first, last] };
        let across = |x: Vector3<f64>, axis: usize| {
            let (a, b) = (x[(axis + 1) % 3], x[(axis + 2) % 3]);
            (a * a + b * b).sqrt()
        };
        let sine = across(g.row(space).transpose(), body).max(Branch::SINGULAR);
        let moving = across(*omega, body).max(across(g * omega, space));
        omega.norm().max(moving / sine)
    }

    /// The rotation of three angles.
    pub(super) fn rotation(&self, angles: [f64; 3]) -> UnitQuaternion<f64> {
        let turn = |place: usize| {
            let (sin, cos) = (0.5 * angles[place]).sin_cos();
            let mut parts = [0.0; 3];
            parts[self.axes[place]] = sin;
            UnitQuaternion::new_unchecked(Quaternion::new(cos, parts[0], parts[1], parts[2]))
        };
        let [a, b, c] = [turn(0), turn(1), turn(2)];
        UnitQuaternion::new_normalize((if self.fixed { c * b * a } else { a * b * c }).into_inner())
    }
}

/// The ends of the range of the second angle: there the first and the third turn about one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ends {
    Low,
    High,
    Neither,
}

impl Ends {
    /// Of an angle from 0 to π.
    fn of(angle: f64) -> Ends {
        match angle {
            _ if angle <= Branch::SINGULAR => Ends::Low,
            _ if angle >= PI - Branch::SINGULAR => Ends::High,
            _ => Ends::Neither,
        }
    }
}

/// The rotation that a table of one sequence states, as in `euler.zyx = [0.1, 0.2, 0.3]`.
///
/// # Errors
/// Refusals of `key` for other sequences, and for more than one.
pub(super) fn stated(
    key: &str,
    table: &BTreeMap<String, Reals<3>>,
) -> Result<Option<UnitQuaternion<f64>>, ReadError> {
    let known = || SEQUENCES.iter().filter(|sequence| sequence.fixed == (key == "fixed"));
    let (mut mistakes, mut rotation) = (ReadError::default(), None);
    for (letters, angles) in table {
        let Some(sequence) = known().find(|sequence| sequence.letters == letters) else {
            let names: Vec<&str> = known().map(|sequence| sequence.letters).collect();
            let message = format!("unknown sequence of axes `{letters}`");
            let refusal = Refusal::at(key.entry(letters), message);
            mistakes.add(Refusal { help: Some(help_for(letters, &names)), ..refusal });
            continue;
        };
        rotation = Some(sequence.rotation(angles.0));
    }
    let mut names = table.keys();
    if let (Some(a), Some(b)) = (names.next(), names.next()) {
        let message = format!("both `{key}.{a}` and `{key}.{b}`, expected one of them");
        mistakes.add(Refusal::at(key.entry(b), message));
    }
    mistakes.or(Some(rotation))
}
