//! Numbers, vectors and matrices while a formula is read: each entry is an operation of its list.
//!
//! | | |
//! |---|---|
//! | a ± b | of one shape, entry by entry |
//! | c a, a c, a/c | c a number |
//! | A b | the product of matrices; a vector is a matrix of one column |
//! | dot(a, b), cross(a, b), norm(a), transpose(A) | vectors of one length, of 3; a vector; a matrix |

use core::fmt;

use super::functions::{Called, Function, OfVectors, Operator};
use super::tape::Builder;

/// A matrix of operations, row by row. A vector has one column, a number one entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Value {
    pub(super) rows: usize,
    pub(super) entries: Vec<usize>,
}

/// The shape in words, such as `a vector of 3`.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.rows, self.columns()) {
            (1, 1) => f.write_str("a number"),
            (rows, 1) => write!(f, "a vector of {rows}"),
            (rows, columns) => write!(f, "a {rows}×{columns} matrix"),
        }
    }
}

/// A mistake, with a suggestion.
type Wrong = (String, Option<String>);

impl Value {
    pub(super) fn number(entry: usize) -> Value {
        Value { rows: 1, entries: vec![entry] }
    }
    pub(super) fn as_number(&self) -> Option<usize> {
        match *self.entries {
            [entry] => Some(entry),
            _ => None,
        }
    }
    pub(super) fn columns(&self) -> usize {
        self.entries.len() / self.rows
    }
    fn as_vector(&self, rows: usize) -> Option<&[usize]> {
        (self.rows == rows && self.columns() == 1).then_some(&*self.entries)
    }

    /// Every entry changed.
    pub(super) fn map(&self, change: impl FnMut(usize) -> usize) -> Value {
        Value { rows: self.rows, entries: self.entries.iter().copied().map(change).collect() }
    }

    /// self ∘ y.
    ///
    /// # Errors
    /// Shapes for which the operator has no meaning.
    pub(super) fn combine(
        &self,
        operator: Operator,
        y: &Value,
        build: &mut Builder,
    ) -> Result<Value, Wrong> {
        let of_one_shape = (self.rows, self.entries.len()) == (y.rows, y.entries.len());
        match (operator, self.as_number(), y.as_number()) {
            (_, Some(a), Some(b)) => Ok(Value::number(build.combine(operator, a, b))),
            (Operator::Add | Operator::Sub, ..) if of_one_shape => {
                let pairs = self.entries.iter().zip(&y.entries);
                let entries = pairs.map(|(&a, &b)| build.combine(operator, a, b)).collect();
                Ok(Value { rows: self.rows, entries })
            }
            (Operator::Mul, Some(a), None) => Ok(y.map(|b| build.combine(operator, a, b))),
            (Operator::Mul | Operator::Div, None, Some(b)) => {
                Ok(self.map(|a| build.combine(operator, a, b)))
            }
            (Operator::Mul, None, None) if self.columns() == y.rows => Ok(self.times(y, build)),
            (Operator::Mul, ..) => {
                let help = match self.columns() == 1 && of_one_shape {
                    true => "two vectors are multiplied by dot(a, b) or cross(a, b)",
                    false => "a matrix is multiplied by a vector of as many numbers as its columns",
                };
                Err((format!("{self} times {y}"), Some(help.into())))
            }
            (Operator::Pow, ..) => {
                let help = "the square of the length of a is dot(a, a)";
                Err((format!("{self} to the power of {y}"), Some(help.into())))
            }
            (Operator::Div, ..) => Err((format!("{self} divided by {y}"), None)),
            (Operator::Sub, ..) => Err((format!("{y} subtracted from {self}"), None)),
            _ => Err((format!("{self} and {y} added"), None)),
        }
    }

    /// The product of matrices.
    fn times(&self, y: &Value, build: &mut Builder) -> Value {
        let (inner, columns) = (y.rows, y.columns());
        let places = (0..self.rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
        let entries = places.map(|(i, j)| {
            let pairs = (0..inner)
                .map(|k| (self.entries[i * inner + k], y.entries[k * columns + j]))
                .collect::<Vec<_>>();
            sum_of_products(&pairs, build)
        });
        Value { rows: self.rows, entries: entries.collect() }
    }

    /// The function of self, and of `second` where it takes two.
    ///
    /// # Errors
    /// The mistake of an argument that the function does not take.
    pub(super) fn call(
        &self,
        called: Called,
        second: Option<&Value>,
        build: &mut Builder,
    ) -> Result<Value, String> {
        let found = || match second {
            None => self.to_string(),
            Some(second) => format!("{self} and {second}"),
        };
        let value = match (called, second) {
            (Called::One(function), _) => {
                self.as_number().map(|x| Value::number(build.apply(function, x)))
            }
            (Called::Two(operator), Some(second)) => {
                let both = self.as_number().zip(second.as_number());
                both.map(|(x, y)| Value::number(build.combine(operator, x, y)))
            }
            (Called::OfVectors(OfVectors::Dot), Some(second)) => {
                let both = self.as_vector(self.rows).zip(second.as_vector(self.rows));
                both.map(|(x, y)| {
                    let pairs: Vec<_> = x.iter().copied().zip(y.iter().copied()).collect();
                    Value::number(sum_of_products(&pairs, build))
                })
            }
            (Called::OfVectors(OfVectors::Cross), Some(second)) => {
                let both = self.as_vector(3).zip(second.as_vector(3));
                both.map(|(x, y)| {
                    let entries = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
                        let first = build.combine(Operator::Mul, x[i], y[j]);
                        let second = build.combine(Operator::Mul, x[j], y[i]);
                        build.combine(Operator::Sub, first, second)
                    });
                    Value { rows: 3, entries: entries.into() }
                })
            }
            (Called::OfVectors(OfVectors::Norm), _) => self.as_vector(self.rows).map(|x| {
                let pairs: Vec<_> = x.iter().map(|&x| (x, x)).collect();
                let squares = sum_of_products(&pairs, build);
                Value::number(build.apply(Function::Sqrt, squares))
            }),
            (Called::OfVectors(OfVectors::Transpose), _) => {
                let (rows, columns) = (self.rows, self.columns());
                let places = (0..columns).flat_map(|j| (0..rows).map(move |i| i * columns + j));
                let entries = places.map(|place| self.entries[place]).collect();
                Some(Value { rows: columns, entries })
            }
            (Called::Two(_) | Called::OfVectors(_), _) => None,
        };
        value.ok_or_else(found)
    }
}

/// x₁y₁ + x₂y₂ + …
fn sum_of_products(pairs: &[(usize, usize)], build: &mut Builder) -> usize {
    let zero = build.number(0.0);
    pairs.iter().fold(zero, |sum, &(x, y)| {
        let product = match x == y {
            true => build.power(x, 2),
            false => build.combine(Operator::Mul, x, y),
        };
        build.combine(Operator::Add, sum, product)
    })
}
