//! Errors: [`Error`] while a run is set up, [`StepError`] within a step, [`Failure`] of a run.
//!
//! `Debug` prints the message too: it is what a `main` that ends by `?` shows.

use core::fmt;

use thiserror::Error as ThisError;

use crate::names;

/// The smallest reciprocal condition number (1-norm) that counts as invertible.
pub const RCOND_MIN: f64 = 1e-14;

/// An argument that cannot be used. Each message names the argument, its value and what was expected.
#[derive(Clone, PartialEq, ThisError)]
#[non_exhaustive]
pub enum Error {
    /// A matrix is not square.
    #[error("{arg}: {rows}×{cols}, expected a square matrix")]
    NotSquare {
        /// The argument.
        arg: &'static str,
        /// The number of rows.
        rows: usize,
        /// The number of columns.
        cols: usize,
    },
    /// A matrix, vector or list has the wrong size.
    #[error("{arg}: {rows}×{cols}, expected {expected_rows}×{expected_cols}")]
    Shape {
        /// The argument.
        arg: &'static str,
        /// The number of rows.
        rows: usize,
        /// The number of columns.
        cols: usize,
        /// The rows it should have.
        expected_rows: usize,
        /// The columns it should have.
        expected_cols: usize,
    },
    /// An entry of a matrix is NaN or infinite.
    #[error("{arg}[{row},{col}] = {}, expected a finite number", Plain(.value))]
    NotFiniteEntry {
        /// The argument.
        arg: &'static str,
        /// Row of the entry, from 0.
        row: usize,
        /// Column of the entry, from 0.
        col: usize,
        /// The entry.
        value: f64,
    },
    /// A matrix is not an element of the Lie algebra.
    #[error(
        "{arg}: not in the Lie algebra of {group}: relative residual {residual:.3e}, expected at most {tolerance:.1e} ({expected})"
    )]
    NotInAlgebra {
        /// The argument.
        arg: &'static str,
        /// The group.
        group: String,
        /// What the elements of the algebra are, in words.
        expected: &'static str,
        /// ‖uᵀM + Mu‖/(‖M‖‖u‖).
        residual: f64,
        /// What was allowed.
        tolerance: f64,
    },
    /// A matrix is not an element of the group.
    #[error(
        "{arg}: not in {group}: relative residual {residual:.3e}, expected at most {tolerance:.1e}"
    )]
    NotOnGroup {
        /// The argument.
        arg: &'static str,
        /// The group.
        group: String,
        /// ‖gᵀMg − M‖/(‖M‖ max(1, ‖g‖²)).
        residual: f64,
        /// What was allowed.
        tolerance: f64,
    },
    /// An orthogonal matrix is a reflection (determinant −1).
    #[error("{arg}: its determinant is −1, expected a rotation (determinant +1)")]
    Reflection {
        /// The argument.
        arg: &'static str,
    },
    /// The determinant of a matrix is not 1, as that of an element of SL(n) and SU(n) is.
    #[error("{arg}: not in {group}: its determinant is {}, expected 1", plain_complex(*.re, *.im))]
    Determinant {
        /// The argument.
        arg: &'static str,
        /// The group.
        group: String,
        /// The real part of the determinant.
        re: f64,
        /// The imaginary part of the determinant; 0 of a real matrix.
        im: f64,
    },
    /// The trace of a matrix is not 0, as that of an element of 𝔰𝔩(n) and 𝔰𝔲(n) is.
    #[error("{arg}: not in the Lie algebra of {group}: its trace is {} away from 0", Plain(.distance))]
    Trace {
        /// The argument.
        arg: &'static str,
        /// The group.
        group: String,
        /// |tr|.
        distance: f64,
    },
    /// The columns of a matrix depend on each other, to rounding.
    #[error(
        "{arg}: the columns of {arg} depend on each other, to rounding (rcond = {}, expected at least {})",
        Plain(&two_digits(*.rcond)), Plain(.minimum)
    )]
    Singular {
        /// The argument.
        arg: &'static str,
        /// The reciprocal condition number in the 1-norm.
        rcond: f64,
        /// What was required.
        minimum: f64,
    },
    /// A number lies outside its range.
    #[error("{arg} = {}, expected {expected}", Plain(.value))]
    OutOfRange {
        /// The argument, with its index where it has one.
        arg: String,
        /// The value of the argument.
        value: f64,
        /// What was expected, in words.
        expected: String,
    },
    /// A list has another length than it should have.
    #[error("{arg}: length {found}, expected {expected}")]
    Length {
        /// The argument, with its index where it has one.
        arg: String,
        /// The length.
        found: usize,
        /// What was expected, in words.
        expected: String,
    },
    /// A matrix is not symmetric.
    #[error("{arg}: {arg} − {arg}ᵀ has an entry {}, expected 0: a symmetric {arg}", Plain(.skew))]
    NotSymmetric {
        /// The argument.
        arg: &'static str,
        /// The largest entry of the difference from the transpose.
        skew: f64,
    },
    /// An argument that is needed was not given.
    #[error("{arg}: not given, expected {expected}")]
    NotGiven {
        /// The argument.
        arg: &'static str,
        /// What was expected, in words.
        expected: &'static str,
    },
    /// Two parts do not fit together, such as a map and a group for which the map has no formula.
    #[error("{what} cannot be used with {with}: {why}")]
    Unsupported {
        /// The part.
        what: &'static str,
        /// The other part.
        with: String,
        /// The reason, and what to use.
        why: &'static str,
    },
    /// A map could not be evaluated at one element of an array.
    #[error("element {index}: {source}")]
    Element {
        /// The number of the element, from 0.
        index: usize,
        /// Why.
        source: Box<Error>,
    },
    /// A map could not be evaluated.
    #[error(transparent)]
    Map(#[from] StepError),
    /// A name that is not registered.
    #[error("unknown {kind} `{name}`: {}", names::help(name, expected))]
    UnknownName {
        /// What was looked up.
        kind: &'static str,
        /// The name that was given.
        name: String,
        /// The names that are registered.
        expected: Vec<&'static str>,
    },
    /// A group element has no real logarithm in the algebra, or none that can be distinguished from rounding.
    #[error(
        "g: no logarithm in the algebra of {group}: the eigenvalue {re:.3e} {im:+.1e}i lies on the negative real axis, and {why}"
    )]
    NoLogarithm {
        /// The group.
        group: String,
        /// The eigenvalue, real part.
        re: f64,
        /// The eigenvalue, imaginary part: zero to rounding.
        im: f64,
        /// Why g has no logarithm.
        why: NoLogarithm,
    },
}

/// Why g with a negative eigenvalue has no real logarithm.
#[derive(Clone, Copy, PartialEq, Eq, ThisError)]
pub enum NoLogarithm {
    /// The multiplicity of the eigenvalue is odd: no real matrix has g as its exponential.
    #[error("its multiplicity is odd: no real matrix has g as its exponential")]
    Odd,
    /// The eigenvalue −1 with a form of odd signature on its eigenspace: g = exp(u) has real solutions u,
    /// and none of them lies in 𝔤.
    #[error("real logarithms exist, but none of them is in the algebra")]
    Outside,
    /// The eigenvalue is defective, or M is neither symmetric nor skew. A logarithm, if there is one, is not
    /// principal, and is not computed.
    #[error(
        "a real logarithm, if there is one, is not principal; it is not computed where the eigenvalue is defective or M neither symmetric nor skew"
    )]
    Undecided,
    /// The eigenvalue is on the negative axis or beside it, and so near to another one that rounding does not tell them apart:
    /// no digit of a logarithm is right.
    #[error(
        "it is so near to another one, or to the negative real axis, that rounding leaves the logarithm no digits"
    )]
    NoDigits,
}

impl Error {
    /// The error of an element of the algebra, about another argument.
    pub fn about(self, arg: &'static str) -> Self {
        match self {
            Error::NotInAlgebra { group, expected, residual, tolerance, .. } => {
                Error::NotInAlgebra { arg, group, expected, residual, tolerance }
            }
            Error::Trace { group, distance, .. } => Error::Trace { arg, group, distance },
            other => other,
        }
    }

    /// An [`OutOfRange`](Error::OutOfRange).
    pub(crate) fn out_of_range(
        arg: impl Into<String>,
        value: f64,
        expected: impl Into<String>,
    ) -> Self {
        Error::OutOfRange { arg: arg.into(), value, expected: expected.into() }
    }

    /// `value`, if it is finite.
    pub(crate) fn finite(arg: impl Into<String>, value: f64) -> Result<f64, Error> {
        match value.is_finite() {
            true => Ok(value),
            false => Err(Error::out_of_range(arg, value, "a finite number")),
        }
    }

    /// `value`, if it is finite and positive.
    pub(crate) fn positive(arg: impl Into<String>, value: f64) -> Result<f64, Error> {
        match value.is_finite() && value > 0.0 {
            true => Ok(value),
            false => Err(Error::out_of_range(arg, value, "a finite number > 0")),
        }
    }

    /// `value`, if it is finite and not negative.
    pub(crate) fn not_negative(arg: impl Into<String>, value: f64) -> Result<f64, Error> {
        match value.is_finite() && value >= 0.0 {
            true => Ok(value),
            false => Err(Error::out_of_range(arg, value, "a finite number ≥ 0")),
        }
    }

    /// Checks that all numbers of a list are finite.
    pub(crate) fn all_finite(arg: &str, values: &[f64]) -> Result<(), Error> {
        match values.iter().position(|x| !x.is_finite()) {
            Some(i) => Error::finite(format!("{arg}[{i}]"), values[i]).map(drop),
            None => Ok(()),
        }
    }
}

/// Why a step could not be taken. It is small and `Copy`, because it is returned from the inner loop.
#[derive(Clone, Copy, PartialEq, ThisError)]
#[non_exhaustive]
pub enum StepError {
    /// u left the domain on which Ψ or dΨ⁻¹ is defined or well conditioned.
    #[error(
        "{map}: the increment left the domain of the coordinate map ({what}); take a smaller step"
    )]
    OutsideChart {
        /// The map.
        map: &'static str,
        /// What was found there.
        what: &'static str,
    },
    /// The right-hand side returned a number that is not finite.
    #[error("the right-hand side f is not finite at stage {stage}")]
    NonFiniteRhs {
        /// The stage, from 1.
        stage: usize,
    },
    /// Numbers grew beyond the range of the arithmetic.
    #[error("{what} is not finite: the numbers left the range of the arithmetic")]
    NotFinite {
        /// What overflowed.
        what: &'static str,
    },
    /// A matrix or an array has the wrong size for the group or the workspace.
    #[error("{arg}: {rows}×{cols}, expected {expected_rows}×{expected_cols}")]
    Shape {
        /// The argument.
        arg: &'static str,
        /// The number of rows.
        rows: usize,
        /// The number of columns.
        cols: usize,
        /// The rows it should have.
        expected_rows: usize,
        /// The columns it should have.
        expected_cols: usize,
    },
    /// An argument of a map is so large that no digit of the result has a meaning.
    #[error(
        "{map}: the norm of the argument is too large for any digit of the result to have a meaning"
    )]
    NormTooLarge {
        /// The map.
        map: &'static str,
    },
    /// An inner iteration of a numerical library did not converge.
    #[error("{what} did not converge")]
    NotConverged {
        /// The iteration.
        what: &'static str,
    },
    /// Newton's iteration of an implicit step did not converge.
    #[error(
        "{method}: Newton's iteration did not converge: relative residual about 1e{residual_log10} after {iterations} iterations; take a smaller step"
    )]
    NewtonDidNotConverge {
        /// The method.
        method: &'static str,
        /// The iterations made.
        iterations: u32,
        /// ⌈log₁₀⌉ of the last relative residual; 308 where it is not finite.
        residual_log10: i32,
    },
    /// The fixed-point iteration of an implicit step did not converge.
    #[error(
        "{method}: the fixed-point iteration did not converge: last relative change about 1e{change_log10} after {iterations} iterations; take a smaller step"
    )]
    FixedPointDidNotConverge {
        /// The method.
        method: &'static str,
        /// The iterations made.
        iterations: u32,
        /// ⌈log₁₀⌉ of the last relative change; 308 where it is not finite.
        change_log10: i32,
    },
    /// A matrix that a map has to invert is singular to working accuracy.
    #[error(
        "{map}: {what} is singular to working accuracy: rcond = {rcond:.3e}; take a smaller step"
    )]
    NearlySingular {
        /// The map.
        map: &'static str,
        /// The matrix.
        what: &'static str,
        /// The reciprocal condition number in the 1-norm.
        rcond: f64,
    },
}

impl StepError {
    /// Ok if `is_finite`, else an error that says `what` is not finite.
    #[inline(always)]
    pub(crate) const fn finite(is_finite: bool, what: &'static str) -> Result<(), StepError> {
        if is_finite { Ok(()) } else { Err(StepError::NotFinite { what }) }
    }

    /// Is this size, rows×columns, the one that `arg` should have?
    #[cfg(feature = "dense")]
    pub(crate) fn check_shape(
        arg: &'static str,
        (rows, cols): (usize, usize),
        (expected_rows, expected_cols): (usize, usize),
    ) -> Result<(), StepError> {
        match (rows, cols) == (expected_rows, expected_cols) {
            true => Ok(()),
            false => Err(StepError::Shape { arg, rows, cols, expected_rows, expected_cols }),
        }
    }
}

/// A number in a message, with an exponent where it would have many zeros.
#[derive(Clone, Copy, Debug)]
pub struct Plain<'a>(pub &'a f64);

impl fmt::Display for Plain<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.abs() {
            size if size == 0.0 || (1e-5..1e16).contains(&size) => write!(f, "{}", self.0),
            _ => write!(f, "{:?}", self.0),
        }
    }
}

/// A number rounded to two digits.
fn two_digits(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

/// A complex number in a message, as a real one where its imaginary part is 0.
pub fn plain_complex(re: f64, im: f64) -> String {
    let sign = if im < 0.0 { '-' } else { '+' };
    match im == 0.0 {
        true => Plain(&re).to_string(),
        false => format!("{} {sign} {}i", Plain(&(re + 0.0)), Plain(&im.abs())),
    }
}

/// A run that stopped early. The state that the caller gave to the driver holds the last accepted point.
#[derive(Clone, Copy, PartialEq, ThisError)]
#[error("step {step} from t = {} with h = {} failed: {source}", Plain(.t), Plain(.h))]
#[non_exhaustive]
pub struct Failure {
    /// The number of steps that had been accepted.
    pub step: u64,
    /// The time of the last accepted point.
    pub t: f64,
    /// The step that failed.
    pub h: f64,
    /// Why.
    pub source: StepError,
}

/// `Debug` of an error is its message.
macro_rules! debug_is_display {
    ($($error:ty),*) => {$(
        impl fmt::Debug for $error {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(self, f)
            }
        }
    )*};
}
pub(crate) use debug_is_display;
debug_is_display!(Error, NoLogarithm, StepError, Failure);
