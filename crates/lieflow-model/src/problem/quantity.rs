//! What can be asked of a problem: every quantity is stated once, with its columns, its meaning, its value and
//! the law that it obeys.

use lieflow_runs::schema::{Branch, Component, Dimension, Law, Measure, Numbers, Scale};

use super::kind::{Kept, QuantityInfo};
use super::system::{PointOf, System};
use crate::formula::entry_name;
use crate::reader::Refusal;

/// The columns of all entries, row by row.
pub(crate) fn row_columns(letter: &str, n: usize, k: usize) -> Vec<String> {
    (1..=n).flat_map(|i| (1..=k).map(move |j| entry_name(letter, [n, k], [i, j]))).collect()
}

/// The columns of a quantity.
enum Columns<S> {
    /// Those of the listing.
    Listed,
    /// Those that the size of the problem says.
    Named(fn(&S) -> Vec<String>),
    /// The entries of a matrix, row by row: a letter, and how many rows and columns it has.
    Matrix(&'static str, fn(&S) -> [usize; 2]),
    /// The entries of several matrices of one size, one matrix after the other: a letter of each, and the size.
    Matrices(fn(&S) -> (&'static [&'static str], [usize; 2])),
}

/// When a value is asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// The time.
    pub(crate) t: f64,
    /// The time after the start.
    pub(crate) since_start: f64,
}

impl Moment {
    /// The time t of a run that starts at t0.
    pub(crate) fn of_run(t: f64, t0: f64) -> Self {
        Moment { t, since_start: t - t0 }
    }
}

/// The value of a quantity at y.
pub(crate) enum Value<S: System> {
    /// A number.
    Number(fn(&S, Moment, &PointOf<S>) -> f64),
    /// Numbers, which go to the end of the row.
    Numbers(fn(&S, Moment, &PointOf<S>, &mut Vec<f64>)),
}

/// A part of `columns` columns, from the column `first` on.
pub(crate) fn part(name: &str, first: usize, columns: usize, measure: Measure) -> Component {
    Component { name: name.into(), what: "", columns: first..first + columns, measure }
}

/// The problems that conserve a quantity.
enum Keepers<S> {
    None,
    All(Law),
    Where(fn(&S) -> Option<Law>),
}

/// A quantity of the problems of type `S`.
pub(crate) struct Quantity<S: System> {
    pub(crate) info: QuantityInfo,
    pub(crate) value: Value<S>,
    columns: Columns<S>,
    /// Its parts. None: one part, whose error is a length.
    pub(crate) parts: Option<fn(&S) -> Vec<Component>>,
    /// The numbers whose parts the columns are.
    pub(crate) numbers: fn(&S) -> Numbers,
    /// The choice that makes the columns of a run continuous.
    pub(crate) branch: fn(&S) -> Branch,
    /// A bound of how fast the values change, in radians per time: those of points that are half a turn apart may lose turns.
    pub(crate) turn_rate: fn(&S, f64, &PointOf<S>) -> f64,
    law: Keepers<S>,
    /// Is it a distance from M, which the exact motion keeps at 0?
    pub(crate) is_distance: bool,
    /// The size of the terms, if the quantity is a sum.
    pub(crate) terms: Option<fn(&S, &PointOf<S>) -> f64>,
    /// True if a value that is not finite ends the run.
    pub(crate) is_state: bool,
    /// The reason why this problem lacks the quantity.
    pub(crate) missing: fn(&S) -> Option<&'static str>,
}

impl<S: System> Quantity<S> {
    const fn new(
        name: &'static str,
        columns: &'static [&'static str],
        meaning: &'static str,
        value: Value<S>,
    ) -> Self {
        Quantity {
            info: QuantityInfo {
                name,
                columns,
                meaning,
                dimension: None,
                drawn_as: "",
                kept: Kept::Never,
            },
            value,
            columns: Columns::Listed,
            parts: None,
            numbers: |_| Numbers::Real,
            branch: |_| Branch::Single,
            turn_rate: |_, _, _| 0.0,
            law: Keepers::None,
            is_distance: false,
            terms: None,
            is_state: false,
            missing: |_| None,
        }
    }

    /// A number; its column has its name.
    pub(crate) const fn number(
        name: &'static str,
        meaning: &'static str,
        value: fn(&S, Moment, &PointOf<S>) -> f64,
    ) -> Self {
        Self::new(name, &[], meaning, Value::Number(value))
    }

    /// The values are distances from M, which the exact motion keeps at 0.
    pub(crate) const fn of_distance(self) -> Self {
        Quantity { is_distance: true, ..self }
    }

    /// Numbers under these columns; with an `…` between the first and the last where the size of the problem says
    /// how many there are ([`with_columns`](Self::with_columns)).
    pub(crate) const fn numbers(
        name: &'static str,
        columns: &'static [&'static str],
        meaning: &'static str,
        value: fn(&S, Moment, &PointOf<S>, &mut Vec<f64>),
    ) -> Self {
        Self::new(name, columns, meaning, Value::Numbers(value))
    }

    /// The values are angles in radians.
    pub(crate) const fn in_radians(self) -> Self {
        self.of_dimension(Dimension::ANGLE)
    }

    /// The values have this dimension.
    pub(crate) const fn of_dimension(self, dimension: Dimension) -> Self {
        let info = QuantityInfo { dimension: Some(dimension), ..self.info };
        Quantity { info, ..self }
    }

    /// A figure shows another quantity of the same problems in its place.
    pub(crate) const fn drawn_as(self, other: &'static str) -> Self {
        Quantity { info: QuantityInfo { drawn_as: other, ..self.info }, ..self }
    }

    /// With columns that depend on the problem.
    pub(crate) const fn with_columns(self, columns: fn(&S) -> Vec<String>) -> Self {
        Quantity { columns: Columns::Named(columns), ..self }
    }

    /// The values are the entries of a matrix of this size, row by row, in columns with this letter.
    pub(crate) const fn of_matrix(self, letter: &'static str, size: fn(&S) -> [usize; 2]) -> Self {
        Quantity { columns: Columns::Matrix(letter, size), ..self }
    }

    /// The values are the entries of matrices of one size, one after the other, such as a real and an imaginary part.
    pub(crate) const fn of_matrices(
        self,
        matrices: fn(&S) -> (&'static [&'static str], [usize; 2]),
    ) -> Self {
        Quantity { columns: Columns::Matrices(matrices), ..self }
    }

    /// The columns are the parts of such numbers.
    pub(crate) const fn of_numbers(self, numbers: fn(&S) -> Numbers) -> Self {
        Quantity { numbers, ..self }
    }

    /// The columns are the entries of a rotation: its error is an angle.
    pub(crate) const fn of_rotation(self) -> Self {
        self.in_parts(|_| vec![part("", 0, 9, Measure::Rotation)])
    }

    /// The columns are a unit quaternion: its error is an angle.
    pub(crate) const fn of_quaternion(self) -> Self {
        self.in_parts(|_| vec![part("", 0, 4, Measure::Quaternion)])
    }

    /// A run reports the error of each of these parts.
    pub(crate) const fn in_parts(self, parts: fn(&S) -> Vec<Component>) -> Self {
        Quantity { parts: Some(parts), ..self }
    }

    /// The values are known up to a choice.
    pub(crate) const fn continuous_by(self, branch: fn(&S) -> Branch) -> Self {
        Quantity { branch, ..self }
    }

    /// A bound of how fast the values change at (t, y), in radians.
    pub(crate) const fn turning_by(self, turn_rate: fn(&S, f64, &PointOf<S>) -> f64) -> Self {
        Quantity { turn_rate, ..self }
    }

    /// Every problem of the kind conserves the quantity.
    pub(crate) const fn kept(self, law: Law) -> Self {
        Quantity { law: Keepers::All(law), ..self }
    }

    /// Some problems of the kind conserve the quantity, or each has a different law.
    pub(crate) const fn kept_where(self, law: fn(&S) -> Option<Law>) -> Self {
        Quantity { law: Keepers::Where(law), ..self }
    }

    /// The quantity is a sum of terms of this size, which may cancel. Its rounding is relative to that size.
    pub(crate) const fn in_terms(self, terms: fn(&S, &PointOf<S>) -> f64) -> Self {
        Quantity { terms: Some(terms), ..self }
    }

    /// The quantity is part of the state. A value that is not finite ends the run.
    pub(crate) const fn of_state(self) -> Self {
        Quantity { is_state: true, ..self }
    }

    /// The reason why a problem lacks the quantity. None if it has the quantity.
    pub(crate) const fn missing_where(self, missing: fn(&S) -> Option<&'static str>) -> Self {
        Quantity { missing, ..self }
    }

    /// The law that the quantity obeys in this problem.
    pub(crate) fn law(&self, system: &S) -> Option<Law> {
        let law = match self.law {
            Keepers::None => None,
            Keepers::All(law) => Some(law),
            Keepers::Where(law) => law(system),
        }?;
        let scale = if self.terms.is_some() { Scale::Terms } else { law.scale };
        Some(Law { scale, ..law })
    }

    /// What is known of it without a system.
    pub(crate) fn info(&self) -> QuantityInfo {
        let kept = match self.law {
            Keepers::None => Kept::Never,
            Keepers::Where(_) => Kept::Sometimes,
            Keepers::All(_) => Kept::Always,
        };
        QuantityInfo { kept, ..self.info }
    }

    /// The names of the columns.
    pub(crate) fn column_names(&self, system: &S) -> Vec<String> {
        match self.columns {
            Columns::Listed => self.info.column_names(),
            Columns::Named(columns) => columns(system),
            Columns::Matrix(letter, size) => {
                let [rows, columns] = size(system);
                row_columns(letter, rows, columns)
            }
            Columns::Matrices(matrices) => {
                let (letters, [rows, columns]) = matrices(system);
                letters.iter().flat_map(|letter| row_columns(letter, rows, columns)).collect()
            }
        }
    }

    /// Checks that none of these names, which a scene gives at `key`, is a column of another quantity than its own.
    ///
    /// # Errors
    /// A refusal of the key.
    pub(crate) fn check_names(
        system: &S,
        key: &str,
        names: &[String],
        own: &[&str],
    ) -> Result<(), Refusal>
    where
        S: System,
    {
        let others = S::QUANTITIES.iter().filter(|quantity| !own.contains(&quantity.info.name));
        for other in others.filter(|quantity| (quantity.missing)(system).is_none()) {
            if let Some(name) = other.column_names(system).iter().find(|c| names.contains(c)) {
                let quantity = other.info.name;
                let message = format!(
                    "`{name}` is a column of the quantity `{quantity}`, expected another name"
                );
                return Err(Refusal::at(key, message));
            }
        }
        Ok(())
    }

    /// The rows and columns of a quantity that is a matrix, or has the parts of one.
    pub(crate) fn matrix(&self, system: &S) -> Option<[usize; 2]> {
        match self.columns {
            Columns::Matrix(_, size) => Some(size(system)),
            Columns::Matrices(matrices) => Some(matrices(system).1),
            _ => None,
        }
    }
}
