//! The rows of a run: values with the names of their quantities.

mod branch;
mod dimension;
mod measure;

pub use branch::Branch;
pub use branch::Branches;
pub use dimension::{Dimension, Units};
pub use lieflow::problems::{Law, Scale};
pub use measure::{Measure, length};

use core::ops::{Index, Range};
use std::collections::HashSet;

use lieflow::Error;
use lieflow::catalog::{MethodInfo, Property};
use lieflow::problems::Origin;

/// The numbers whose parts the columns of a quantity are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Numbers {
    /// Real numbers: a column for each.
    #[default]
    Real,
    /// Complex numbers: all real parts, then all imaginary parts.
    Complex,
    /// The entries of a Hermitian matrix: the real parts on and above the diagonal, row by row, then the imaginary
    /// parts above it.
    Hermitian,
    /// The entries of a skew-Hermitian matrix on and below the diagonal, column by column: the imaginary part of that
    /// on the diagonal, the real and the imaginary part of each below it. The point of such a problem is the matrix of the
    /// real parts, then that of the imaginary parts.
    SkewHermitian,
}

/// A part of a complex number: the number of a column, and the factor of its value, which may be 0.
pub type Part = (usize, f64);

impl Numbers {
    /// For `columns` columns: the real and imaginary part of each number, by rows. Empty for real numbers.
    pub fn parts(self, columns: usize) -> Vec<[Part; 2]> {
        let n = columns.isqrt();
        let entry = |i: usize, j: usize| {
            // The entry of the triangle that is stated, and the sign of the part that is opposite on the other side.
            let (low, high, sign) = (i.min(j), i.max(j), if i <= j { 1.0 } else { -1.0 });
            let beside = if i == j { 0.0 } else { sign };
            let before = low * n - low * (low + 1) / 2;
            match self {
                Numbers::SkewHermitian if i == j => [(0, 0.0), (low * (2 * n - low), 1.0)],
                Numbers::SkewHermitian => {
                    let real = low * (2 * n - low) + 2 * (high - low) - 1;
                    [(real, -sign), (real + 1, 1.0)]
                }
                _ => {
                    let imaginary = n * (n + 1) / 2 + before + (high - low).saturating_sub(1);
                    [(before + high, 1.0), (if i == j { 0 } else { imaginary }, beside)]
                }
            }
        };
        match self {
            Numbers::Real => Vec::new(),
            Numbers::Complex => {
                (0..columns / 2).map(|i| [(i, 1.0), (columns / 2 + i, 1.0)]).collect()
            }
            Numbers::Hermitian | Numbers::SkewHermitian => {
                (0..n * n).map(|k| entry(k / n, k % n)).collect()
            }
        }
    }
}

/// Columns of a quantity that belong together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Component {
    /// Its name; none of a quantity that is one part.
    pub name: String,
    /// What it is, as in "vector"; empty for a quantity that is one part.
    pub what: &'static str,
    /// Its columns, from 0.
    pub columns: Range<usize>,
    /// How errors of it are measured.
    pub measure: Measure,
}

/// A quantity of a model, and where its values are in a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Observable {
    /// The name of the quantity.
    pub name: &'static str,
    /// The names of its columns.
    pub columns: Vec<String>,
    /// The law that the exact motion obeys, where it keeps the columns.
    pub law: Option<Law>,
    /// Is it a state, so that a value that is not finite ends the run?
    pub is_state: bool,
    /// Is it a distance from M, which the exact motion keeps at 0?
    pub is_distance: bool,
    /// Its parts: all of its columns, in order.
    pub parts: Vec<Component>,
    /// What a run chooses so that the columns are continuous.
    pub branch: Branch,
    /// Is that choice followed between rows, at points for each radian by which the values change? Else from row to row.
    pub is_followed: bool,
    /// The shape of its values as an array, rows first; none of a number.
    pub shape: Vec<usize>,
    /// The numbers in that array.
    pub numbers: Numbers,
    place: Range<usize>,
    /// The place of the size of its terms, where its rounding is relative to that.
    size: Option<usize>,
}

impl Observable {
    /// Does the method promise to keep the columns to rounding? By what the catalog says that it preserves.
    pub fn promised_by(&self, method: &MethodInfo) -> bool {
        self.law.is_some_and(|law| {
            let by_its_kind = match law.origin {
                Origin::Action => method.keeps(Property::Group) || method.keeps(Property::Casimirs),
                Origin::Flow => self.name == "energy" && method.keeps(Property::Energy),
            };
            by_its_kind
                || method.keeps_polynomials(law.degree)
                || method.keeps(Property::Everything)
        })
    }

    /// The place of a column in the numbers of a row.
    pub fn place(&self, column: usize) -> usize {
        self.place.start + column
    }

    /// The places of its columns.
    pub fn places(&self) -> Range<usize> {
        self.place.clone()
    }

    /// Does a row have the size of its terms?
    pub fn has_size(&self) -> bool {
        self.size.is_some()
    }
}

/// The observables of a model, in the order of its rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Schema {
    observables: Vec<Observable>,
    /// The number of values in a row; the sizes of terms are after them.
    width: usize,
    sizes: usize,
}

impl Schema {
    /// Add an observable at the end.
    pub fn push(
        &mut self,
        name: &'static str,
        columns: Vec<String>,
        law: Option<Law>,
        is_state: bool,
    ) {
        let in_terms = law.is_some_and(|law| law.scale == Scale::Terms);
        let size = in_terms.then_some(self.sizes);
        let place = self.width..self.width + columns.len();
        self.width = place.end;
        self.sizes += usize::from(in_terms);
        let measure = Measure::Length;
        let parts =
            vec![Component { name: String::new(), what: "", columns: 0..columns.len(), measure }];
        let branch = Branch::Single;
        let shape = if columns.len() == 1 { Vec::new() } else { vec![columns.len()] };
        let numbers = Numbers::Real;
        let observable = Observable {
            name,
            columns,
            law,
            is_state,
            is_distance: false,
            parts,
            branch,
            is_followed: true,
            shape,
            numbers,
            place,
            size,
        };
        self.observables.push(observable);
    }

    /// Make the last observable a distance from M, where it is one.
    pub fn set_distance(&mut self, is_distance: bool) {
        if let Some(observable) = self.observables.last_mut() {
            observable.is_distance = is_distance;
        }
    }

    /// Give the last observable these parts.
    pub fn set_parts(&mut self, parts: Vec<Component>) {
        if let Some(observable) = self.observables.last_mut() {
            if let [Component { measure: Measure::Rotation, .. }] = parts[..]
                && observable.columns.len() == 9
            {
                observable.shape = vec![3, 3];
            }
            observable.parts = parts;
        }
    }

    /// Make the last observable an array of such numbers; without a size a list of complex numbers, or a square matrix.
    pub fn set_numbers(&mut self, numbers: Numbers, size: Option<[usize; 2]>) {
        if let Some(observable) = self.observables.last_mut() {
            let columns = observable.columns.len();
            let shape = match numbers {
                Numbers::Real => None,
                Numbers::Complex => Some(vec![columns / 2]),
                Numbers::Hermitian | Numbers::SkewHermitian => Some(vec![columns.isqrt(); 2]),
            };
            observable.numbers = numbers;
            if let Some(shape) = size.map(Vec::from).or(shape) {
                observable.shape = shape;
            }
        }
    }

    /// Let a run make this choice for the last observable.
    pub fn set_branch(&mut self, branch: Branch) {
        if let Some(observable) = self.observables.last_mut() {
            observable.branch = branch;
        }
    }

    /// Let a run follow these observables from row to row alone, as is enough for a figure.
    pub fn follow_from_row_to_row(&mut self, names: &[&str]) {
        let named = |observable: &&mut Observable| names.contains(&observable.name);
        self.observables.iter_mut().filter(named).for_each(|one| one.is_followed = false);
    }

    /// The longest time between two points of a run for which the choices of all its values are sure, if one is bounded.
    pub fn longest_gap(&self) -> Option<f64> {
        self.iter().filter_map(|observable| observable.branch.longest_gap()).reduce(f64::min)
    }

    /// The schema of the first `count` observables.
    pub fn first(&self, count: usize) -> Schema {
        let observables = self.observables[..count].to_vec();
        let width = observables.last().map_or(0, |last| last.place.end);
        let sizes = observables.iter().filter(|observable| observable.has_size()).count();
        Schema { observables, width, sizes }
    }

    /// The observable of that name.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn get(&self, name: &str) -> Result<&Observable, Error> {
        self.iter().find(|observable| observable.name == name).ok_or_else(|| Error::UnknownName {
            kind: "quantity",
            name: name.into(),
            expected: self.iter().map(|observable| observable.name).collect(),
        })
    }

    /// Every observable.
    pub fn iter(&self) -> core::slice::Iter<'_, Observable> {
        self.observables.iter()
    }

    /// The observables that the exact motion keeps.
    pub fn laws(&self) -> impl Iterator<Item = &Observable> {
        self.iter().filter(|observable| observable.law.is_some())
    }

    /// The number of values and sizes in a row.
    pub fn numbers(&self) -> usize {
        self.width + self.sizes
    }

    /// values ← the values whose choices ([`Branch`]) are nearest to those of the numbers of another row.
    pub fn follow(&self, before: &[f64], values: &mut [f64]) {
        for Observable { branch, place, .. } in self {
            branch.follow(&before[place.clone()], &mut values[place.clone()]);
        }
    }

    /// The names of all columns.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.iter().flat_map(|observable| &observable.columns).map(String::as_str)
    }

    /// The columns of some of its quantities, each with its place in the numbers of a row. A column that several of them
    /// have is there once: it has one value.
    pub fn each_column_once<'a>(
        quantities: impl IntoIterator<Item = &'a Observable>,
    ) -> Vec<(&'a str, usize)> {
        let all = quantities.into_iter().flat_map(|quantity| {
            quantity.columns.iter().map(String::as_str).zip(quantity.places())
        });
        let mut known = HashSet::new();
        all.filter(|(name, _)| known.insert(*name)).collect()
    }

    /// The place in the numbers of a row of a column.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn place(&self, column: &str) -> Result<usize, Error> {
        let mut columns = self.iter().flat_map(|o| o.columns.iter().zip(o.places()));
        let found = columns.find(|(name, _)| *name == column);
        found.map(|(_, place)| place).ok_or_else(|| Error::UnknownName {
            kind: "column",
            name: column.into(),
            expected: Vec::new(),
        })
    }

    /// The row of these numbers: [`Row::numbers`] of a row, or the values alone.
    pub fn row<'a>(&'a self, numbers: &'a [f64]) -> Row<'a> {
        Row { schema: self, numbers }
    }
}

impl<'a> IntoIterator for &'a Schema {
    type Item = &'a Observable;
    type IntoIter = core::slice::Iter<'a, Observable>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// The values at one time, with the schema that names them.
///
/// `row[observable]` is the values of an observable of the schema. It panics where the row has no such place.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    schema: &'a Schema,
    numbers: &'a [f64],
}

impl<'a> Row<'a> {
    /// The values of all observables.
    pub fn values(self) -> &'a [f64] {
        &self.numbers[..self.schema.width]
    }

    /// What names the values.
    pub fn schema(self) -> &'a Schema {
        self.schema
    }

    /// The values of the quantity of that name.
    ///
    /// # Errors
    /// As [`Schema::get`].
    pub fn of(self, name: &str) -> Result<&'a [f64], Error> {
        Ok(&self.numbers[self.schema.get(name)?.place.clone()])
    }

    /// The size that the rounding of the column `i` is relative to, by the scale of the law; NaN for
    /// a sum of terms in a row without their sizes.
    pub fn size(self, observable: &Observable, i: usize) -> f64 {
        let scale = observable.law.map_or(Scale::Value, |law| law.scale);
        scale.size(self[observable][i], self.terms(observable))
    }

    /// The size of the terms of a quantity; NaN without terms, and in a row without their sizes.
    pub fn terms(self, observable: &Observable) -> f64 {
        let place = observable.size.map(|size| self.schema.width + size);
        place.and_then(|place| self.numbers.get(place)).copied().unwrap_or(f64::NAN)
    }

    /// The values, and the sizes of terms after them: what [`Schema::row`] makes a row of.
    pub fn numbers(self) -> &'a [f64] {
        self.numbers
    }
}

impl Index<&Observable> for Row<'_> {
    type Output = [f64];

    fn index(&self, observable: &Observable) -> &[f64] {
        &self.numbers[observable.place.clone()]
    }
}
