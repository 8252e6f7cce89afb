//! What keys of a scene hold: numbers that are finite, lists of known length.

use core::fmt;

use faer::Mat;
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};

use super::Refusal;

/// A finite number; an integer is one too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Real(pub f64);

impl<'de> Deserialize<'de> for Real {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AsReal;
        impl Visitor<'_> for AsReal {
            type Value = Real;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<Real, E> {
                match x.is_finite() {
                    true => Ok(Real(x)),
                    false => Err(E::custom(format!("found {x}, expected a finite number"))),
                }
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<Real, E> {
                Ok(Real(x as f64))
            }
            fn visit_u64<E: Error>(self, x: u64) -> Result<Real, E> {
                Ok(Real(x as f64))
            }
            fn visit_i128<E: Error>(self, x: i128) -> Result<Real, E> {
                Ok(Real(x as f64))
            }
            fn visit_u128<E: Error>(self, x: u128) -> Result<Real, E> {
                Ok(Real(x as f64))
            }
        }
        deserializer.deserialize_any(AsReal)
    }
}

/// A whole number from `MIN`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whole<const MIN: u64>(pub u64);

impl<'de, const MIN: u64> Deserialize<'de> for Whole<MIN> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AsWhole<const MIN: u64>;
        impl<const MIN: u64> Visitor<'_> for AsWhole<MIN> {
            type Value = Whole<MIN>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a whole number, at least {MIN}")
            }
            fn visit_i64<E: Error>(self, n: i64) -> Result<Whole<MIN>, E> {
                match u64::try_from(n) {
                    Ok(n) if n >= MIN => Ok(Whole(n)),
                    _ => Err(E::custom(format!(
                        "found {n}, expected a whole number, at least {MIN}"
                    ))),
                }
            }
        }
        deserializer.deserialize_any(AsWhole::<MIN>)
    }
}

/// N entries.
struct Entries<T, const N: usize>([T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Entries<T, N> {
    fn read<D: Deserializer<'de>>(d: D, what: &'static str) -> Result<Self, D::Error> {
        struct AsEntries<T, const N: usize>(&'static str, core::marker::PhantomData<T>);
        impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for AsEntries<T, N> {
            type Value = Entries<T, N>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a list of {N} {}", self.0)
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Entries<T, N>, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = list.next_element()? {
                    entries.push(entry);
                }
                let found = entries.len();
                entries.try_into().map(Entries).map_err(|_| {
                    let found = if found == 0 { "none".into() } else { found.to_string() };
                    A::Error::custom(format!("expected {N} {}, found {found}", self.0))
                })
            }
        }
        d.deserialize_any(AsEntries(what, core::marker::PhantomData))
    }
}

/// N numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reals<const N: usize>(pub [f64; N]);

impl<'de, const N: usize> Deserialize<'de> for Reals<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let entries: Entries<Real, N> = Entries::read(deserializer, "numbers")?;
        Ok(Reals(entries.0.map(|x| x.0)))
    }
}

/// N rows of N numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows<const N: usize>(pub [[f64; N]; N]);

impl<'de, const N: usize> Deserialize<'de> for Rows<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let entries: Entries<Reals<N>, N> = Entries::read(deserializer, "rows of numbers")?;
        Ok(Rows(entries.0.map(|row| row.0)))
    }
}

/// N formulas.
#[derive(Clone, Debug, PartialEq)]
pub struct Texts<const N: usize>(pub [String; N]);

impl<'de, const N: usize> Deserialize<'de> for Texts<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Entries::read(deserializer, "formulas").map(|entries| Texts(entries.0))
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

/// A number, or a row of three.
enum Entry {
    Number(f64),
    Row([f64; 3]),
}

impl<'de> Deserialize<'de> for Entry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AsEntry;
        impl<'de> Visitor<'de> for AsEntry {
            type Value = Entry;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<Entry, E> {
                match x.is_finite() {
                    true => Ok(Entry::Number(x)),
                    false => Err(E::custom(format!("found {x}, expected a finite number"))),
                }
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<Entry, E> {
                Ok(Entry::Number(x as f64))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Entry, A::Error> {
                let list = serde::de::value::SeqAccessDeserializer::new(list);
                Reals::<3>::deserialize(list).map(|row| Entry::Row(row.0))
            }
        }
        deserializer.deserialize_any(AsEntry)
    }
}

impl<'de> Deserialize<'de> for Diagonal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Entries::<Entry, 3>::read(deserializer, "numbers")?.0 {
            [Entry::Number(a), Entry::Number(b), Entry::Number(c)] => Ok(Diagonal::List([a, b, c])),
            [Entry::Row(a), Entry::Row(b), Entry::Row(c)] => Ok(Diagonal::Rows([a, b, c])),
            _ => Err(D::Error::custom("numbers and rows, expected 3 numbers or 3 rows of them")),
        }
    }
}

/// Any number of numbers, or three rows of three.
#[derive(Clone, Debug, PartialEq)]
pub enum NumbersOrRows {
    /// Numbers.
    Numbers(Vec<f64>),
    /// A matrix.
    Rows([[f64; 3]; 3]),
}

impl<'de> Deserialize<'de> for NumbersOrRows {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let entries = Vec::<Entry>::deserialize(deserializer)?;
        if let [Entry::Row(a), Entry::Row(b), Entry::Row(c)] = entries[..] {
            return Ok(NumbersOrRows::Rows([a, b, c]));
        }
        let number = |entry: &Entry| match entry {
            Entry::Number(x) => Some(*x),
            Entry::Row(_) => None,
        };
        let numbers = entries.iter().map(number).collect::<Option<_>>();
        let expected = || D::Error::custom("expected numbers, or 3 rows of 3 numbers");
        numbers.map(NumbersOrRows::Numbers).ok_or_else(expected)
    }
}

/// Any number of numbers.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct List(Vec<Real>);

impl List {
    /// The numbers.
    pub fn values(&self) -> Vec<f64> {
        self.0.iter().map(|x| x.0).collect()
    }
}

/// Rows of numbers, of one length.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Table(Vec<List>);

impl Table {
    /// The rows as a matrix, of as many columns as the first row has numbers.
    ///
    /// # Errors
    /// As [`matrix`](Self::matrix), and for rows of no numbers.
    pub fn columns(&self, key: &str) -> Result<Mat<f64>, Refusal> {
        match self.0.first().map(|row| row.0.len()) {
            Some(0) => Err(Refusal::at(key, "rows of no numbers, expected at least one column")),
            columns => self.matrix(key, columns),
        }
    }

    /// The rows as a matrix of so many columns; as many as rows where none is said.
    ///
    /// # Errors
    /// A refusal of `key` for a row of another length, and for no rows.
    pub fn matrix(&self, key: &str, columns: Option<usize>) -> Result<Mat<f64>, Refusal> {
        let columns = columns.unwrap_or(self.0.len());
        if self.0.is_empty() {
            return Err(Refusal::at(key, "no rows, expected at least one"));
        }
        if let Some(i) = self.0.iter().position(|row| row.0.len() != columns) {
            let found = self.0[i].0.len();
            let message = format!("row {} has {found} numbers, expected {columns}", i + 1);
            return Err(Refusal::at(format!("{key}[{i}]"), message));
        }
        Ok(Mat::from_fn(self.0.len(), columns, |i, j| self.0[i].0[j].0))
    }
}
