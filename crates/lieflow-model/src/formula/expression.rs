//! An expression of named variables, ready to be evaluated.

use std::sync::Arc;

use lieflow::samples::Samples;
use lieflow::scalar::Real;
use lieflow::{Failure, RunError};

use super::lost::{Lost, NEAR, Origin, Which, is_of_values};
use super::names::Names;
use super::samples::Table;
use super::tape::{LENGTH_MAX, Tape};
use super::{calculus, parse};
use crate::reader::{ReadError, Refusal};

/// An expression of a scene in named variables.
#[derive(Clone, Debug)]
pub struct Formula {
    pub(super) tape: Tape,
    /// Of its names, whether it uses them or not.
    table: Option<Arc<Table>>,
    origin: Arc<Origin>,
}

impl Formula {
    /// Read `text`; `key` names its place in the scene, `torque[1]`.
    ///
    /// # Errors
    /// A refusal of `key` that says what is wrong, and at which character. Empty if the formula needs a named one
    /// whose mistakes are reported already.
    pub fn read(key: &str, text: &str, names: &Names) -> Result<Self, ReadError> {
        let (rows, tapes) = read_value(key, text, names)?;
        let count = tapes.len();
        match <[Tape; 1]>::try_from(tapes) {
            Ok([tape]) => Ok(Formula::of(tape, key, text, names)),
            Err(_) => {
                let value = if rows == count { "a vector" } else { "a matrix" };
                let message =
                    format!("{key}: the value is {value} of {count} numbers, expected one");
                let help = "x1 is the first component of a vector x, norm(x) its length".into();
                Err(Refusal { help: Some(help), ..Refusal::at(key, message) }.into())
            }
        }
    }

    /// Checks the form of `text`, where its names are not known yet.
    ///
    /// # Errors
    /// A refusal as of [`read`](Self::read), if the text is no formula whatever its names mean.
    pub fn check_form(key: &str, text: &str) -> Result<(), ReadError> {
        match parse::parse(text, &Names::open()) {
            Err(mistake) if mistake.is_of_form => Err(refused(key, mistake)),
            _ => Ok(()),
        }
    }

    /// The formula of a text, or an entry of its value, at `key`.
    pub(super) fn of(tape: Tape, key: &str, text: &str, names: &Names) -> Self {
        let (key, text, table) = (key.into(), text.into(), names.table().cloned());
        Formula {
            tape,
            table,
            origin: Arc::new(Origin { key, text, by: None, names: names.clone() }),
        }
    }

    /// Its value where the variables have these values, in the order of their names. On numbers that count
    /// operations, or where somebody counts them, its own are counted too.
    pub fn value<S: Real + Into<f64>>(&self, values: &[S]) -> S {
        let value = self.tape.value(values, self.samples());
        if !value.is_finite() {
            self.lose(values);
        }
        S::lit(value)
    }

    #[cold]
    fn lose<S: Real + Into<f64>>(&self, values: &[S]) {
        let values: Vec<f64> = values.iter().map(|&x| x.into()).collect();
        self.origin.names.losses().see(&self.origin, &self.tape, &values);
    }

    /// Forgets what this formula and those of the same names lost in this thread.
    pub fn forget(&self) {
        self.origin.names.losses().forget();
    }

    /// Which of this formula and those of the same names had no finite value in this thread, and where.
    pub fn lost(&self, which: Which) -> Option<Lost> {
        self.origin.names.losses().tell(which)
    }

    /// The formula of the same names by which a run in this thread ended with this error.
    pub fn lost_by(&self, error: &RunError) -> Option<Lost> {
        match error {
            RunError::Step(Failure { source, .. }) if is_of_values(source) => {
                self.lost(Which::First)
            }
            RunError::StepSizeUnderflow { source: Some(source), .. } if is_of_values(source) => {
                self.lost(Which::Last)
            }
            // The last step was so small that t did not reach beyond what it failed by before.
            RunError::StepSizeUnderflow { t, .. } => self
                .lost(Which::Last)
                .filter(|lost| lost.t().is_some_and(|at| (at - t).abs() <= NEAR * (1.0 + t.abs()))),
            _ => None,
        }
    }

    /// Its derivative by a variable, as a formula.
    ///
    /// # Errors
    /// A refusal of its key where that is too long.
    pub fn derivative(&self, variable: usize) -> Result<Self, Refusal> {
        let Origin { key, text, names, .. } = &*self.origin;
        let too_long = || {
            Refusal::at(key.as_str(), format!("a derivative of more than {LENGTH_MAX} operations"))
        };
        let tape = calculus::derivative(&self.tape, variable).ok_or_else(too_long)?;
        let (key, text, names) = (key.clone(), text.clone(), names.clone());
        let origin = Arc::new(Origin { key, text, by: Some(variable), names });
        Ok(Formula { tape, table: self.table.clone(), origin })
    }

    /// The variable and the number, where the formula is a variable divided by a number; a variable is divided by 1.
    pub fn quotient(&self) -> Option<(usize, f64)> {
        self.tape.quotient()
    }

    /// Is it the number 0?
    pub fn is_zero(&self) -> bool {
        self.tape.ops().len() == 1 && self.tape.value::<f64>(&[], None) == 0.0
    }

    /// Is it the same function as another formula of the same names, operation by operation?
    pub fn is(&self, other: &Formula) -> bool {
        self.tape.ops() == other.tape.ops()
    }
    /// Does the value depend on this variable?
    pub fn uses(&self, variable: usize) -> bool {
        self.tape.uses(variable)
    }

    /// The formula 0, which may name the samples. None without samples.
    pub(crate) fn of_samples(names: &Names) -> Option<Formula> {
        names.table()?;
        Formula::read("samples", "0", names).ok()
    }

    /// Other names, the first of them `t`, and the columns of the samples that this formula may name.
    pub fn add_samples(&self, names: Names) -> Names {
        names.with_table(self.table.clone())
    }

    /// The samples whose columns it may name.
    pub fn samples(&self) -> Option<&Samples> {
        self.table.as_ref().map(|table| &table.samples)
    }

    /// The names of the columns of the samples.
    pub fn sample_names(&self) -> &[String] {
        self.table.as_ref().map_or(&[], |table| &table.columns)
    }

    /// The length of its list of operations.
    pub fn operations(&self) -> usize {
        self.tape.ops().len()
    }

    /// The refusal of its key, or of the named formula that it needs, where it has no finite value at the start.
    pub fn check(&self, start: &[f64]) -> Option<Refusal> {
        self.forget();
        let value = self.value(start);
        let lost = (!value.is_finite()).then(|| self.lost(Which::First)).flatten()?;
        let place = if lost.at.is_empty() { String::new() } else { format!(" ({})", lost.place()) };
        let Lost { key, through, by, value, .. } = lost;
        let key = through.unwrap_or(key);
        let what = by.map_or_else(|| key.clone(), |by| format!("{key}: its derivative by {by}"));
        let message = format!("{what} is {value} at the start{place}, expected a number");
        Some(Refusal::at(key, message))
    }
}

/// The refusals of the formulas that have no finite value at the start, one for each key.
pub fn without_value<'a>(
    formulas: impl IntoIterator<Item = &'a Formula>,
    start: &[f64],
) -> Vec<Refusal> {
    let mut all = Vec::new();
    for refusal in formulas.into_iter().filter_map(|formula| formula.check(start)) {
        if all.iter().all(|other: &Refusal| other.key != refusal.key) {
            all.push(refusal);
        }
    }
    all
}

/// The entries of the value of a formula, row by row, and the number of its rows.
pub(super) fn read_value(
    key: &str,
    text: &str,
    names: &Names,
) -> Result<(usize, Vec<Tape>), ReadError> {
    let value = parse::parse(text, names).map_err(|mistake| refused(key, mistake))?;
    Ok((value.rows, value.entries))
}

/// The refusal of `key` for a mistake.
fn refused(key: &str, parse::Mistake { message, help, is_known, .. }: parse::Mistake) -> ReadError {
    let refusal = Refusal { help, ..Refusal::at(key, format!("{key}: {message}")) };
    if is_known { ReadError::known() } else { refusal.into() }
}
