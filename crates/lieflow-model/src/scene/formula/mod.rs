//! Formulas: functions of a user's own, as text in a scene.
//!
//! | | |
//! |---|---|
//! | numbers | `2`, `0.5`, `1e-3`, `pi`, `e`, the names of `[problem.parameters]` |
//! | variables | those that the key says, such as `t`, `w1`, `g33`; the columns of a file of samples |
//! | operators | `+` `-` `*` `/` `^` and parentheses; −2^2 = −4, 2^−1 = ½, 2^3^2 = 2^9; whole powers are products |
//! | functions | sin cos tan asin acos atan sinh cosh tanh exp ln log10 sqrt abs sign, atan2(y, x) min(x, y) max(x, y) |
//!
//! A formula is read once, to a list of operations; its derivative is another one. Evaluating it allocates
//! nothing and cannot fail: where it has no value, the value is NaN.
//!
//! The crates for expressions have one thing or another of what is needed: powers before signs and to the
//! right, `1e-3`, mistakes with their place, derivatives, operations that are counted. None has all.

mod calculus;
mod functions;
mod names;
mod parse;
mod samples;
mod tape;
#[cfg(test)]
mod tests;

pub use names::{Names, Parameters};
pub use samples::SamplesFile;

use std::sync::Arc;

use lieflow::samples::Samples;
use lieflow::scalar::Real;

use self::samples::Table;
use self::tape::{LENGTH_MAX, Tape};
use super::Refusal;

/// An expression of a scene in named variables.
#[derive(Clone, Debug)]
pub struct Formula {
    tape: Tape,
    /// Of its names, whether it uses them or not.
    table: Option<Arc<Table>>,
}

impl Formula {
    /// Read `text`; `key` names its place in the scene, `torque[1]`.
    ///
    /// # Errors
    /// A refusal of `key` that says what is wrong, and at which character.
    pub fn read(key: &str, text: &str, names: &Names) -> Result<Self, Refusal> {
        let refused = |parse::Mistake { message, help }| Refusal {
            help,
            ..Refusal::at(key, format!("{key}: {message}"))
        };
        let tape = parse::parse(text, names).map_err(refused)?;
        Ok(Formula { tape, table: names.table().cloned() })
    }

    /// Its value where the variables have these values, in the order of their names. On numbers that count
    /// operations, or where somebody counts them, its own are counted too.
    pub fn value<S: Real + Into<f64>>(&self, values: &[S]) -> S {
        S::lit(self.tape.value(values, self.samples()))
    }

    /// Its derivative by a variable, as a formula.
    ///
    /// # Errors
    /// A refusal of `key` where that is too long.
    pub fn derivative(&self, key: &str, variable: usize) -> Result<Self, Refusal> {
        let too_long =
            || Refusal::at(key, format!("a derivative of more than {LENGTH_MAX} operations"));
        let tape = calculus::derivative(&self.tape, variable).ok_or_else(too_long)?;
        Ok(Formula { tape, table: self.table.clone() })
    }

    /// The variable and the number, where the formula is a variable divided by a number; a variable is divided by 1.
    pub fn quotient(&self) -> Option<(usize, f64)> {
        self.tape.quotient()
    }

    /// Does the value depend on this variable?
    pub fn uses(&self, variable: usize) -> bool {
        self.tape.uses(variable)
    }

    /// The samples whose columns it may name.
    pub fn samples(&self) -> Option<&Samples> {
        self.table.as_ref().map(|table| &table.samples)
    }

    /// The length of its list of operations.
    pub fn operations(&self) -> usize {
        self.tape.ops().len()
    }

    /// That it has a value at the start.
    ///
    /// # Errors
    /// A refusal of `key` where the value is not finite.
    pub fn check(&self, key: &str, start: &[f64]) -> Result<(), Refusal> {
        match self.value(start) {
            x if x.is_finite() => Ok(()),
            x => Err(Refusal::at(key, format!("{key} is {x} at the start, expected a number"))),
        }
    }
}

/// A list of formulas; the one that is refused has its index in the key.
///
/// # Errors
/// As [`Formula::read`].
pub fn read_all(key: &str, texts: &[String], names: &Names) -> Result<Vec<Formula>, Refusal> {
    let read = |(i, text): (usize, &String)| Formula::read(&format!("{key}[{i}]"), text, names);
    texts.iter().enumerate().map(read).collect()
}
