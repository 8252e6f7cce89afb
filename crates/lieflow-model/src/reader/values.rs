//! What keys of a scene hold: numbers that are finite, lists of known length.

use faer::Mat;

use super::read::{Read, ReadError, Shape, read_as_held};
use super::value::{Is, Value};
use super::{KeyPath, Refusal, amount};

const OUT_OF_RANGE: &str = "the number is out of range";
const NO_ROWS: &str = "found no rows, expected at least one";

/// A finite number; an integer is one too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Real(pub f64);

impl Read for Real {
    const SHAPE: Shape = Shape::Number;

    fn read(value: &Value) -> Result<Self, ReadError> {
        match number(value)? {
            x if x.is_finite() => Ok(Real(x)),
            _ => Err(ReadError::expected(value, "a finite number")),
        }
    }
}

impl Real {
    /// The number, where it is a good one.
    ///
    /// # Errors
    /// A refusal of `key`, with what was expected.
    pub fn checked(
        self,
        key: &str,
        expected: &str,
        good: impl FnOnce(f64) -> bool,
    ) -> Result<f64, ReadError> {
        match self.0 {
            x if good(x) => Ok(x),
            x => Err(Refusal::out_of_range(key, x, expected).into()),
        }
    }
}

/// A number, also an infinite one and NaN.
fn number(value: &Value) -> Result<f64, ReadError> {
    let number = match &value.is {
        Is::Whole(n) => n.value.map(|n| n as f64),
        Is::Number(x) => x.value,
        _ => return Err(ReadError::expected(value, "a number")),
    };
    number.ok_or_else(|| ReadError::of(value, OUT_OF_RANGE))
}

/// Below it a number can be each whole number.
const WHOLE_MAX: f64 = (1u64 << f64::MANTISSA_DIGITS) as f64;

/// A whole number from `MIN`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whole<const MIN: u64>(pub u64);

impl<const MIN: u64> Read for Whole<MIN> {
    const SHAPE: Shape = Shape::Whole;

    fn read(value: &Value) -> Result<Self, ReadError> {
        let expected = || ReadError::expected(value, format!("a whole number, at least {MIN}"));
        let n = match &value.is {
            Is::Whole(n) => n.value.and_then(|n| i64::try_from(n).ok()),
            // 1e6, where a number has each whole number.
            Is::Number(x) => match x.value.filter(|x| x.fract() == 0.0 && x.abs() < WHOLE_MAX) {
                Some(x) => Some(x as i64),
                None => return Err(expected()),
            },
            _ => return Err(expected()),
        };
        let n = n.ok_or_else(|| ReadError::of(value, OUT_OF_RANGE))?;
        let n = u64::try_from(n).ok().filter(|n| *n >= MIN);
        n.map(Whole).ok_or_else(expected)
    }
}

/// Reads a list of a given number of entries.
pub(crate) fn counted<T: Read, L: TryFrom<Vec<T>>>(
    value: &Value,
    count: usize,
    what: &str,
) -> Result<L, ReadError> {
    if value.as_list().is_none() {
        return Err(ReadError::expected(value, format!("a list of {count} {what}")));
    }
    let list = Vec::<T>::read(value)?;
    let found = if list.is_empty() { "none".into() } else { list.len().to_string() };
    let list = if list.len() == count { list.try_into().ok() } else { None };
    list.ok_or_else(|| ReadError::of(value, format!("expected {count} {what}, found {found}")))
}

/// N numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reals<const N: usize>(pub [f64; N]);

impl<const N: usize> Read for Reals<N> {
    const SHAPE: Shape = Shape::Numbers(N);

    fn read(value: &Value) -> Result<Self, ReadError> {
        let numbers: [Real; N] = counted(value, N, "numbers")?;
        Ok(Reals(numbers.map(|x| x.0)))
    }
}

/// A span of time: two numbers, of which the second may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span(pub [f64; 2]);

impl Read for Span {
    const SHAPE: Shape = Shape::Numbers(2);

    fn read(value: &Value) -> Result<Self, ReadError> {
        struct End(f64);
        impl Read for End {
            const SHAPE: Shape = Shape::Number;

            fn read(value: &Value) -> Result<Self, ReadError> {
                match number(value)? {
                    x if x.is_nan() => Err(ReadError::expected(value, "a finite number")),
                    x => Ok(End(x)),
                }
            }
        }
        let [End(start), End(end)] = counted(value, 2, "numbers")?;
        match start.is_finite() {
            true => Ok(Span([start, end])),
            false => Err(ReadError::of(value, format!("found {start}, expected a finite number"))),
        }
    }
}

/// N rows of N numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows<const N: usize>(pub [[f64; N]; N]);

impl<const N: usize> Read for Rows<N> {
    const SHAPE: Shape = Shape::Square(N);

    fn read(value: &Value) -> Result<Self, ReadError> {
        let rows: [Reals<N>; N] = counted(value, N, "rows of numbers")?;
        Ok(Rows(rows.map(|row| row.0)))
    }
}

/// Three numbers, or three rows of three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Diagonal {
    /// The diagonal.
    List([f64; 3]),
    /// The whole matrix.
    Rows([[f64; 3]; 3]),
}

/// A number, or a row.
enum Entry<R> {
    Number(f64),
    Row(R),
}

impl<R: Read> Read for Entry<R> {
    const SHAPE: Shape = Shape::Or(&Shape::Number, &R::SHAPE);

    fn read(value: &Value) -> Result<Self, ReadError> {
        match value.is {
            Is::List(_) => R::read(value).map(Entry::Row),
            _ => Real::read(value).map(|x| Entry::Number(x.0)),
        }
    }
}

impl Read for Diagonal {
    const SHAPE: Shape = Shape::Or(&Shape::Numbers(3), &Shape::Square(3));

    fn read(value: &Value) -> Result<Self, ReadError> {
        match counted::<Entry<Reals<3>>, [_; 3]>(value, 3, "numbers")? {
            [Entry::Number(a), Entry::Number(b), Entry::Number(c)] => Ok(Diagonal::List([a, b, c])),
            [Entry::Row(a), Entry::Row(b), Entry::Row(c)] => Ok(Diagonal::Rows([a.0, b.0, c.0])),
            _ => {
                let message =
                    "found numbers beside rows, expected 3 numbers or 3 rows of 3 numbers";
                Err(ReadError::of(value, message))
            }
        }
    }
}

/// Numbers, or rows of them.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// Numbers; also where there are none.
    List(Vec<f64>),
    /// Rows.
    Rows(Table),
}

impl Read for Numbers {
    const SHAPE: Shape = Shape::Or(&Shape::List, &Shape::Rows);

    fn read(value: &Value) -> Result<Self, ReadError> {
        let (mut numbers, mut rows) = (Vec::new(), Vec::new());
        for entry in Vec::read(value)? {
            match entry {
                Entry::Number(x) => numbers.push(x),
                Entry::Row(row) => rows.push(row),
            }
        }
        match (numbers.is_empty(), rows.is_empty()) {
            (_, true) => Ok(Numbers::List(numbers)),
            (true, false) => Ok(Numbers::Rows(Table(rows))),
            (false, false) => Err(ReadError::of(
                value,
                "found numbers beside rows, expected either numbers or rows of numbers",
            )),
        }
    }
}

impl Numbers {
    /// The numbers, where there are N.
    ///
    /// # Errors
    /// A refusal of `key` for rows and for another count.
    pub fn list<const N: usize>(self, key: &str) -> Result<[f64; N], ReadError> {
        let refused =
            |found: String| Refusal::at(key, format!("found {found}, expected {N} numbers")).into();
        match self {
            Numbers::List(list) => {
                list.try_into().map_err(|list: Vec<_>| refused(list.len().to_string()))
            }
            Numbers::Rows(_) => Err(refused("rows of numbers".into())),
        }
    }

    /// The rows as a matrix of as many columns as rows.
    ///
    /// # Errors
    /// A refusal of `key` for numbers that are no rows, and as [`Table::matrix`].
    pub fn square(self, key: &str) -> Result<Mat<f64>, ReadError> {
        match self {
            Numbers::Rows(table) => table.matrix(key, None),
            Numbers::List(list) if list.is_empty() => Err(Refusal::at(key, NO_ROWS).into()),
            Numbers::List(_) => {
                Err(Refusal::at(key, "found numbers, expected rows of numbers").into())
            }
        }
    }
}

read_as_held!(List: Vec<Real> = Shape::List);

impl Read for Table {
    const SHAPE: Shape = Shape::Rows;

    fn read(value: &Value) -> Result<Self, ReadError> {
        match Vec::read(value)? {
            rows if rows.is_empty() => Err(ReadError::of(value, NO_ROWS)),
            rows => Ok(Table(rows)),
        }
    }
}

/// Any number of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct List(Vec<Real>);

impl List {
    /// The numbers.
    pub fn values(&self) -> Vec<f64> {
        self.0.iter().map(|x| x.0).collect()
    }
}

/// Rows of numbers, of one length; at least one.
#[derive(Clone, Debug, PartialEq)]
pub struct Table(Vec<List>);

impl Table {
    /// The rows as a matrix, of as many columns as the first row has numbers.
    ///
    /// # Errors
    /// As [`matrix`](Self::matrix), and for rows of no numbers.
    pub fn columns(&self, key: &str) -> Result<Mat<f64>, ReadError> {
        match self.0.first().map(|row| row.0.len()) {
            Some(0) => {
                Err(Refusal::at(key, "rows of no numbers, expected at least one column").into())
            }
            columns => self.matrix(key, columns),
        }
    }

    /// The rows as a matrix of `columns` columns. `None` means as many columns as rows.
    ///
    /// # Errors
    /// A refusal of `key` for a row of another length.
    pub fn matrix(&self, key: &str, columns: Option<usize>) -> Result<Mat<f64>, ReadError> {
        let columns = columns.unwrap_or(self.0.len());
        if let Some(i) = self.0.iter().position(|row| row.0.len() != columns) {
            let found = self.0[i].0.len();
            let message =
                format!("row {} has {}, expected {columns}", i + 1, amount(found, "numbers"));
            return Err(Refusal::at(key.index(i), message).into());
        }
        Ok(Mat::from_fn(self.0.len(), columns, |i, j| self.0[i].0[j].0))
    }
}
