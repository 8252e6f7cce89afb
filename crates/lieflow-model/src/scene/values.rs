//! What keys of a scene hold: numbers that are finite, lists of known length.

use core::fmt;

use faer::Mat;
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Visitor};

use super::{KeyPath, Refusal};

/// A finite number; an integer is one too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Real(pub f64);

/// Reads a number; where that is allowed, an infinite one.
struct AsNumber {
    infinite: bool,
}

impl Visitor<'_> for AsNumber {
    type Value = f64;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number")
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<f64, E> {
        match x.is_finite() || (self.infinite && !x.is_nan()) {
            true => Ok(x),
            false => Err(E::custom(format!("found {x}, expected a finite number"))),
        }
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<f64, E> {
        Ok(x as f64)
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<f64, E> {
        Ok(x as f64)
    }
    fn visit_i128<E: Error>(self, x: i128) -> Result<f64, E> {
        Ok(x as f64)
    }
    fn visit_u128<E: Error>(self, x: u128) -> Result<f64, E> {
        Ok(x as f64)
    }
}

impl<'de> Deserialize<'de> for Real {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AsNumber { infinite: false }).map(Real)
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

/// Reads a list of as many entries as the count says.
struct ReadList<T> {
    count: usize,
    what: &'static str,
    entries: Vec<T>,
}

impl<T> ReadList<T> {
    fn new(count: usize, what: &'static str) -> Self {
        ReadList { count, what, entries: Vec::new() }
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for ReadList<T> {
    type Value = Vec<T>;
    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list of {} {}", self.count, self.what)
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
        let ReadList { count, what, mut entries } = self;
        while let Some(entry) = list.next_element()? {
            entries.push(entry);
        }
        match entries.len() {
            found if found == count => Ok(entries),
            0 => Err(A::Error::custom(format!("expected {count} {what}, found none"))),
            found => Err(A::Error::custom(format!("expected {count} {what}, found {found}"))),
        }
    }
}

/// Reads a list of so many numbers.
#[derive(Clone, Copy, Debug)]
pub struct NumberList(pub usize);

impl<'de> DeserializeSeed<'de> for NumberList {
    type Value = Vec<f64>;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<Vec<f64>, D::Error> {
        let list = d.deserialize_any(ReadList::<Real>::new(self.0, "numbers"))?;
        Ok(list.iter().map(|x| x.0).collect())
    }
}

/// N entries.
struct Entries<T, const N: usize>([T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Entries<T, N> {
    fn read<D: Deserializer<'de>>(d: D, what: &'static str) -> Result<Self, D::Error> {
        let list = d.deserialize_any(ReadList::new(N, what))?;
        list.try_into()
            .map(Entries)
            .map_err(|list: Vec<T>| D::Error::invalid_length(list.len(), &what))
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

/// A span of time: two numbers, of which the second may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span(pub [f64; 2]);

impl<'de> Deserialize<'de> for Span {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct End(f64);
        impl<'de> Deserialize<'de> for End {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(AsNumber { infinite: true }).map(End)
            }
        }
        let [start, end] = Entries::<End, 2>::read(deserializer, "numbers")?.0;
        match start.0.is_finite() {
            true => Ok(Span([start.0, end.0])),
            false => Err(D::Error::custom(format!("found {}, expected a finite number", start.0))),
        }
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

impl<'de, R: Deserialize<'de>> Deserialize<'de> for Entry<R> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AsEntry<R>(core::marker::PhantomData<R>);
        impl<'de, R: Deserialize<'de>> Visitor<'de> for AsEntry<R> {
            type Value = Entry<R>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<Entry<R>, E> {
                match x.is_finite() {
                    true => Ok(Entry::Number(x)),
                    false => Err(E::custom(format!("found {x}, expected a finite number"))),
                }
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<Entry<R>, E> {
                Ok(Entry::Number(x as f64))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Entry<R>, A::Error> {
                let list = serde::de::value::SeqAccessDeserializer::new(list);
                R::deserialize(list).map(Entry::Row)
            }
        }
        deserializer.deserialize_any(AsEntry(core::marker::PhantomData))
    }
}

impl<'de> Deserialize<'de> for Diagonal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match Entries::<Entry<Reals<3>>, 3>::read(deserializer, "numbers")?.0 {
            [Entry::Number(a), Entry::Number(b), Entry::Number(c)] => Ok(Diagonal::List([a, b, c])),
            [Entry::Row(a), Entry::Row(b), Entry::Row(c)] => Ok(Diagonal::Rows([a.0, b.0, c.0])),
            _ => Err(D::Error::custom("numbers and rows, expected 3 numbers or 3 rows of them")),
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

impl<'de> Deserialize<'de> for Numbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (mut numbers, mut rows) = (Vec::new(), Vec::new());
        for entry in Vec::<Entry<List>>::deserialize(deserializer)? {
            match entry {
                Entry::Number(x) => numbers.push(x),
                Entry::Row(row) => rows.push(row),
            }
        }
        match (numbers.is_empty(), rows.is_empty()) {
            (_, true) => Ok(Numbers::List(numbers)),
            (true, false) => Ok(Numbers::Rows(Table(rows))),
            (false, false) => Err(D::Error::custom("numbers and rows, expected one of the two")),
        }
    }
}

impl Numbers {
    /// The numbers, where there are N.
    ///
    /// # Errors
    /// A refusal of `key` for rows and for another count.
    pub fn list<const N: usize>(self, key: &str) -> Result<[f64; N], Refusal> {
        let refused =
            |found: String| Refusal::at(key, format!("found {found}, expected {N} numbers"));
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
    pub fn square(self, key: &str) -> Result<Mat<f64>, Refusal> {
        match self {
            Numbers::Rows(table) => table.matrix(key, None),
            Numbers::List(list) if list.is_empty() => Table(Vec::new()).matrix(key, None),
            Numbers::List(_) => Err(Refusal::at(key, "found numbers, expected rows of numbers")),
        }
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
            return Err(Refusal::at(key.index(i), message));
        }
        Ok(Mat::from_fn(self.0.len(), columns, |i, j| self.0[i].0[j].0))
    }
}
