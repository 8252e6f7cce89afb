//! A field of one's own behind slices: the group and the action by name, all numbers by rows.
//!
//! | group | action | y | f(t, y) |
//! |---|---|---|---|
//! | `SO(3)` | translation | 3×3 | 3 numbers, ω |
//! | | linear, coadjoint | 3 numbers | 3 numbers |
//! | `SE(3)` | translation | 4×4, \[R x; 0 1\] | 6 numbers, (ω, v) |
//! | | coadjoint | 6 numbers, (μ, π) | 6 numbers |
//! | `S3`, unit quaternions | translation | 4 numbers, the real part first | 3 numbers, ω |
//! | `SO(n)`, `SL(n)`, `GL(n)`, `Sp(2m)`, `SO(p,q)`, G_M | translation, conjugation, coadjoint | n×n | n×n |
//! | | linear | n numbers, n×k | n×n |
//! | | lagrangian, of Sp(2m) | m×m | 2m×2m |
//! | `U(n)`, `SU(n)` | translation, conjugation, coadjoint | n×n complex | n×n complex |
//! | | linear | n complex numbers, n×k complex | n×n complex |
//! | parts: vectors, rotations and numbers, in this order | that of each | 3 numbers, 3×3, 1 number each | 3, 3, 1 number each |
//! | `SO(3)` | conjugation; linear with k columns | 3×3; 3×k | 3 numbers |
//!
//! A complex number is two numbers, Re and Im; they are the last axis of a shape.
//! ẏ = λ_*(f(t, y))(y). On a group this is ẏ = f·y with [`Frame::Space`], and ẏ = y·f with [`Frame::Body`].

mod formulas;
mod layout;
mod run;

use std::sync::Arc;

use faer::Mat;
use lieflow::actions::{Coadjoint, Linear, Pair, Translation};
use lieflow::catalog::{MethodSpec, Needs};
use lieflow::groups::{MatrixGroup, Se3, So3, UnitQuaternions};
use lieflow::names::{near, plain};
use lieflow::{Error, RunError};
use lieflow_runs::spaces::{Composed, MatrixAction, OnMatrices, OnPairs, OnQuaternions, group_of};

pub use self::formulas::Formulas;
use self::layout::{
    ComplexMatrices, InParts, Layout, Matrices, Motions, Pairs, Quaternions, Rotations, Vectors,
};
pub use self::run::Run;
use self::run::{Given, Typed};
use super::algebra::Algebra;
use crate::problem::{Orders, Outcome, Plan, RowCurve, StepByStep, Stepper, Watcher};

/// f: writes the value at (t, y) into the last slice, which is 0 before. It returns false to end the run at once.
pub type OwnField = dyn Fn(f64, &[f64], &mut [f64]) -> bool + Send + Sync;

/// The frame of the values of a field on a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// ẏ = f·y.
    Space,
    /// ẏ = y·f.
    Body,
}

/// What is wrong with an argument.
#[derive(Clone, Debug, PartialEq)]
pub struct Misfit {
    /// The name of the argument.
    pub argument: &'static str,
    /// Its value in words.
    pub value: String,
    /// What was expected.
    pub expected: String,
}

fn misfit<T>(
    argument: &'static str,
    value: impl Into<String>,
    expected: impl Into<String>,
) -> Result<T, Misfit> {
    Err(Misfit { argument, value: value.into(), expected: expected.into() })
}

/// A group, by name or by its form M.
#[derive(Clone, Debug)]
pub enum GroupName {
    /// The name of a group, such as `SO(3)`.
    Named(String),
    /// G_M = {g : gᵀMg = M}, with n and M by rows.
    Form(usize, Vec<f64>),
    /// So many vectors, rotations and numbers: SO(3)ⁿ × SO(3)ᵐ × ℝᵏ.
    Parts([usize; 3]),
}

/// The actions by name.
pub const ACTIONS: [&str; 5] = ["translation", "linear", "conjugation", "coadjoint", "lagrangian"];
/// The groups by name; n, m, p and q stand for numbers.
pub const GROUPS: [&str; 10] =
    ["SO(3)", "SE(3)", "S3", "SO(n)", "SL(n)", "GL(n)", "Sp(2m)", "SO(p,q)", "U(n)", "SU(n)"];

/// The space of a problem: a group, an action, and the shapes of y and f.
#[derive(Clone, Debug)]
pub struct Space {
    kind: SpaceKind,
    frame: Option<Frame>,
    point: Vec<usize>,
    value: Vec<usize>,
}

#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // one for each run
enum SpaceKind {
    Rotation,
    Vector,
    Motion,
    Pair,
    Quaternion,
    Parts(InParts),
    Matrix(MatrixGroup, MatrixAction),
    Complex(MatrixGroup, MatrixAction),
}

/// The largest size of a matrix in a group by its name.
const SIZE_MAX: usize = 16384;

/// A group of matrices by its name, and whether they are complex. `rows` is the size where the name has none.
fn matrix_group(name: &str, rows: usize) -> Result<(MatrixGroup, bool), Misfit> {
    let unknown = || {
        if GROUPS.contains(&name) {
            let expected = "numbers in place of its letters, as in SO(4), Sp(6) or SO(3,1)";
            return Misfit {
                argument: "group",
                value: format!("`{name}`"),
                expected: expected.into(),
            };
        }
        let hint = near(name, &GROUPS).map_or(String::new(), |name| format!("`{name}`? "));
        let expected = format!("{hint}one of {}, or the form M of a group", GROUPS.join(", "));
        Misfit { argument: "group", value: format!("`{name}`"), expected }
    };
    let named = Algebra::named(name).ok_or_else(unknown)?;
    let n = match named.algebra {
        Algebra::Indefinite(p, q) => p.saturating_add(q),
        _ => plain(name).trim_start_matches(char::is_alphabetic).parse().unwrap_or(rows),
    };
    let group = named.algebra.group(n, "group");
    match group {
        Ok(group) => Ok((group, named.algebra.is_complex())),
        Err(_) if n == 0 || n > SIZE_MAX => {
            misfit("group", format!("`{name}`"), format!("a size from 1 to {SIZE_MAX}"))
        }
        Err(_) => misfit("group", format!("`{name}`"), "a group of matrices of even size, 2m"),
    }
}

fn shape_of(shape: &[usize]) -> String {
    match shape {
        [n] => format!("({n},)"),
        shape => format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

impl Space {
    /// The space of a group, an action and a frame by name, with y of this shape.
    ///
    /// # Errors
    /// A [`Misfit`] of `group`, `action`, `frame` or `y0`.
    pub fn new(
        group: &GroupName,
        action: &str,
        frame: Option<Frame>,
        shape: &[usize],
    ) -> Result<Self, Misfit> {
        let Some(action) = ACTIONS.into_iter().find(|name| plain(name) == plain(action)) else {
            let hint = near(action, &ACTIONS).map_or(String::new(), |name| format!("`{name}`? "));
            let expected = format!("{hint}one of {}", ACTIONS.join(", "));
            return misfit("action", format!("`{action}`"), expected);
        };
        let translates = match group {
            GroupName::Parts([_, rotations, _]) => *rotations > 0,
            _ => action == "translation",
        };
        match frame {
            None if translates => {
                return misfit("frame", "None", "\"space\" (ẏ = f y) or \"body\" (ẏ = y f)");
            }
            Some(Frame::Body) if !translates => {
                let expected = match group {
                    GroupName::Parts(_) => "None: no part is a rotation".into(),
                    _ => format!("None: with action=\"{action}\" f is in space"),
                };
                return misfit("frame", "\"body\"", expected);
            }
            _ => {}
        }
        let name = match group {
            // A hyphen before a digit is a sign.
            GroupName::Named(name) if name.contains("-") && name.contains(char::is_numeric) => {
                return Self::of_matrices(group, action, frame, shape);
            }
            GroupName::Named(name) => plain(name),
            GroupName::Form(..) => String::new(),
            GroupName::Parts(counts) => return Self::of_parts(*counts, action, frame, shape),
        };
        let (kind, point, value) = match (&*name, action) {
            ("so3", "translation") => (SpaceKind::Rotation, vec![3, 3], vec![3]),
            ("so3", "coadjoint") => (SpaceKind::Vector, vec![3], vec![3]),
            ("so3", "linear") if shape.len() != 2 => (SpaceKind::Vector, vec![3], vec![3]),
            ("se3", "translation") => (SpaceKind::Motion, vec![4, 4], vec![6]),
            ("se3", "coadjoint") => (SpaceKind::Pair, vec![6], vec![6]),
            ("su2", _) if shape.len() > 1 => {
                return Self::of_matrices(group, action, frame, shape);
            }
            ("s3" | "su2" | "quaternions" | "unitquaternions", "translation") => {
                (SpaceKind::Quaternion, vec![4], vec![3])
            }
            ("se3" | "s3" | "quaternions" | "unitquaternions", _) => {
                return misfit("action", format!("`{action}`"), "\"translation\" for this group");
            }
            _ => return Self::of_matrices(group, action, frame, shape),
        };
        let space = Space { kind, frame, point, value };
        space.check_shape(shape)?;
        Ok(space)
    }

    fn of_parts(
        [vectors, rotations, numbers]: [usize; 3],
        action: &str,
        frame: Option<Frame>,
        shape: &[usize],
    ) -> Result<Self, Misfit> {
        if action != ACTIONS[0] {
            return misfit("action", format!("`{action}`"), "none: each part has its own");
        }
        let parts = InParts { vectors, rotations, numbers };
        let turns = 3 * (vectors + rotations);
        let (point, value) = (turns + 6 * rotations + numbers, turns + numbers);
        let (kind, point, value) = (SpaceKind::Parts(parts), vec![point], vec![value]);
        let space = Space { kind, frame, point, value };
        space.check_shape(shape)?;
        Ok(space)
    }

    fn of_matrices(
        group: &GroupName,
        action: &str,
        frame: Option<Frame>,
        shape: &[usize],
    ) -> Result<Self, Misfit> {
        let lagrangian = action == "lagrangian";
        let rows = shape.first().copied().unwrap_or(0);
        let (group, is_complex) = match group {
            GroupName::Named(name) => matrix_group(name, if lagrangian { 2 * rows } else { rows })?,
            GroupName::Parts(_) => return misfit("group", "parts", "a group of matrices"),
            GroupName::Form(n, m) => {
                let form = Mat::from_fn(*n, *n, |i, j| m[i * n + j]);
                match MatrixGroup::gm(form) {
                    Ok(group) => (group, false),
                    Err(error) => return misfit("group", error.to_string(), "an invertible M"),
                }
            }
        };
        let n = if is_complex { group.n() / 2 } else { group.n() };
        // The last axis of complex numbers are Re and Im.
        let (shape, last) = match shape {
            [first @ .., 2] if is_complex => (first, &[2][..]),
            _ if is_complex => return misfit("y0", "real numbers", "complex numbers"),
            _ => (shape, &[][..]),
        };
        let with_last = |shape: Vec<usize>| [&shape, last].concat();
        let (action, point) = match (action, shape) {
            ("translation", _) => (MatrixAction::Translation, vec![n, n]),
            ("conjugation", _) => (MatrixAction::Conjugation, vec![n, n]),
            ("coadjoint", _) => (MatrixAction::Coadjoint, vec![n, n]),
            ("lagrangian", _) if is_complex => {
                return misfit("action", "`lagrangian`", "translation, linear or conjugation");
            }
            ("lagrangian", _) => (MatrixAction::Lagrangian, vec![n / 2, n / 2]),
            (_, &[_, columns]) => (MatrixAction::Linear, vec![n, columns]),
            _ => (MatrixAction::Linear, vec![n]),
        };
        let is_so3 = matches!(group.form(), lieflow::groups::Form::Identity) && n == 3;
        let value = if is_so3 && !is_complex { vec![3] } else { vec![n, n] };
        let kind = match is_complex {
            true => SpaceKind::Complex(group, action),
            false => SpaceKind::Matrix(group, action),
        };
        let space = Space { kind, frame, point: with_last(point), value: with_last(value) };
        let shape = [shape, last].concat();
        space.check_shape(&shape)?;
        Ok(space)
    }

    fn check_shape(&self, shape: &[usize]) -> Result<(), Misfit> {
        // The last axis of complex numbers is not the user's.
        let axes = usize::from(matches!(self.kind, SpaceKind::Complex(..)));
        let told = |shape: &[usize]| format!("shape {}", shape_of(&shape[..shape.len() - axes]));
        match shape == self.point {
            true => Ok(()),
            false => misfit("y0", told(shape), told(&self.point)),
        }
    }

    /// The shape of y.
    pub fn point(&self) -> &[usize] {
        &self.point
    }

    /// The shape of f.
    pub fn value(&self) -> &[usize] {
        &self.value
    }

    /// True if methods for linear equations are there: not on quaternions, parts and se(3)*.
    pub fn has_linear_methods(&self) -> bool {
        !matches!(self.kind, SpaceKind::Quaternion | SpaceKind::Parts(_) | SpaceKind::Pair)
    }

    /// Checks that a method is not one for linear equations where there is none.
    ///
    /// # Errors
    /// [`Error::Unsupported`], which says where they are; [`Error::UnknownName`].
    pub fn check_linear(&self, method: &MethodSpec) -> Result<(), Error> {
        let info = method.info()?;
        match info.needs == Needs::LinearType && !self.has_linear_methods() {
            true => Err(Error::Unsupported {
                what: info.name,
                with: "unit quaternions, Parts and se(3)*".into(),
                why: "methods for linear equations are for SO(n), SE(3), U(n) and other groups of matrices, and for the \
                      vectors and matrices that they act on",
            }),
            false => Ok(()),
        }
    }

    /// The problem with this field. With `linear`, f depends only on t, and methods for linear equations fit, where there
    /// are some ([`Self::has_linear_methods`]); other methods run everywhere.
    ///
    /// # Errors
    /// What the library refuses of the group.
    pub fn problem(&self, field: Arc<OwnField>, linear: bool) -> Result<Own, Error> {
        let body = self.frame == Some(Frame::Body);
        let side = if body { Translation::Right } else { Translation::Left };
        // Only translations have a frame.
        let from = |action| if body { MatrixAction::RightTranslation } else { action };
        let run: Box<dyn Run> = match &self.kind {
            SpaceKind::Rotation => {
                Typed::linear(So3::new(), side, Rotations, ((field, body), linear))
            }
            SpaceKind::Vector => {
                Typed::linear(So3::new(), Linear, Vectors, ((field, false), linear))
            }
            SpaceKind::Motion => Typed::linear(Se3::new(), side, Motions, ((field, body), linear)),
            SpaceKind::Matrix(group, action) => {
                let columns = self.point.get(1).copied().unwrap_or(1);
                let layout = Matrices { rows: self.point[0], columns };
                on_matrices(group, from(*action), layout, ((field, body), linear))
            }
            SpaceKind::Complex(group, action) => {
                let layout = ComplexMatrices {
                    rows: self.point[0],
                    columns: if self.point.len() > 2 { self.point[1] } else { 1 },
                    vectors: *action == MatrixAction::Linear,
                };
                on_matrices(group, from(*action), layout, ((field, body), linear))
            }
            SpaceKind::Quaternion => {
                let given = (field, body);
                Typed::<OnQuaternions, _>::field(UnitQuaternions, side, Quaternions, given)
            }
            SpaceKind::Parts(parts) => {
                let InParts { vectors, rotations, numbers } = *parts;
                let (group, action) =
                    (group_of([vectors, rotations, numbers])?, Pair(Linear, side));
                Typed::<Composed, _>::field(group, action, *parts, (field, body))
            }
            SpaceKind::Pair => {
                Typed::<OnPairs, _>::field(Se3::new(), Coadjoint, Pairs, (field, false))
            }
        };
        Ok(Own { run })
    }
}

/// A problem of matrices.
fn on_matrices<L: Layout<MatrixGroup, Mat<f64>>>(
    group: &MatrixGroup,
    action: MatrixAction,
    layout: L,
    given: (Given, bool),
) -> Box<dyn Run> {
    Typed::<OnMatrices, L>::linear(group.clone(), action, layout, given)
}

/// A problem with a field of one's own.
pub struct Own {
    run: Box<dyn Run>,
}

impl core::fmt::Debug for Own {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Own").finish_non_exhaustive()
    }
}

impl Own {
    /// The orders of a method that fits.
    ///
    /// # Errors
    /// The reason why it does not.
    pub fn orders(&self, method: &MethodSpec) -> Result<Orders, Error> {
        self.run.orders(method)
    }

    /// Integrates from y0, by rows. The rows that `watcher` sees are the numbers of y.
    ///
    /// # Errors
    /// As [`Solve::run`](lieflow::Solve::run).
    pub fn run(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        plan: Plan<'_>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError> {
        self.run.run(method, y0, plan, watcher)
    }

    /// A run from y0, by rows, that the caller takes step by step, with the times at which a step ends.
    ///
    /// # Errors
    /// As [`Solve::integrator`](lieflow::Solve::integrator).
    pub fn stepper(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        steps: StepByStep,
    ) -> Result<Box<dyn Stepper>, RunError> {
        self.run.stepper(method, y0, steps)
    }

    /// The curve of these numbers, for the method that made them.
    ///
    /// # Errors
    /// [`Error::Length`] for another number of them.
    pub fn curve(
        &self,
        method: &MethodSpec,
        y0: &[f64],
        numbers: &[f64],
    ) -> Result<Box<dyn RowCurve>, Error> {
        self.run.curve(method, y0, numbers)
    }
}
