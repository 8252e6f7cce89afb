//! The linear space of matrices of any size.

use faer::Mat;

use super::{Gap, GivenBy, LinearSpace, Metric, Numbers};
use crate::dense;
use crate::error::Error;
use crate::scalar::{Ops, tally};
use crate::tolerance::PartTolerance;
use crate::tolerance::Scales;

impl Metric for Mat<f64> {
    type Scalar = f64;
    const IS_ONE_PART: bool = true;
    fn check_sizes(&self, arg: &'static str, like: &Self) -> Result<(), Error> {
        let (rows, cols) = (self.nrows(), self.ncols());
        let (expected_rows, expected_cols) = (like.nrows(), like.ncols());
        match (rows, cols) == (expected_rows, expected_cols) {
            true => Ok(()),
            false => Err(Error::Shape { arg, rows, cols, expected_rows, expected_cols }),
        }
    }
    fn assign(&mut self, x: &Self) {
        match (self.nrows(), self.ncols()) == (x.nrows(), x.ncols()) {
            true => self.copy_from(x),
            // It comes from a function of the caller: no number of it is used.
            false => self.fill(f64::NAN),
        }
    }
    fn size(&self) -> f64 {
        dense::norm_frobenius(self)
    }
    fn distance(&self, x: &Self) -> f64 {
        tally(|| Ops::adds(2 * x.nrows() * x.ncols()) + Ops::muls(x.nrows() * x.ncols()));
        let mut s = 0.0;
        for j in 0..self.ncols() {
            for (a, b) in self.col_as_slice(j).iter().zip(x.col_as_slice(j)) {
                s += (a - b) * (a - b);
            }
        }
        s.sqrt()
    }
    fn is_same(&self, x: &Self) -> bool {
        self == x
    }
    fn error_ratio(&self, gap: Gap<'_, Self>, scales: &mut Scales<'_>) -> f64 {
        let part = scales.part();
        if part.has_components() {
            return match gap.error {
                GivenBy::To(x) => {
                    let errors = entries(self).zip(entries(x)).map(|(a, b)| a - b);
                    part.largest(errors, entries(self))
                }
                GivenBy::Of(e) => part.largest(entries(e), entries(self)),
                GivenBy::Relative(e) => part.ratio_in_any_direction(e * self.size(), self),
                GivenBy::Rounding(e) => part.largest(entries(self).map(|x| e * x), entries(self)),
            };
        }
        gap.ratio(self, part)
    }
}

impl PartTolerance {
    /// The ratio of an error of at most this length at a matrix: each entry may have all of it.
    pub(crate) fn ratio_in_any_direction(&self, error: f64, at: &Mat<f64>) -> f64 {
        match self.has_components() {
            true => self.largest(entries(at).map(|_| error), entries(at)),
            false => self.ratio(error, at.size()),
        }
    }
}

/// The entries of a matrix, column by column.
fn entries(m: &Mat<f64>) -> impl Iterator<Item = f64> {
    (0..m.ncols()).flat_map(|j| m.col_as_slice(j)).copied()
}

impl LinearSpace for Mat<f64> {
    fn clear(&mut self) {
        self.fill(0.0);
    }
    fn add(&mut self, a: f64, x: &Self) {
        dense::axpy(a, x, self);
    }
    fn dot(&self, x: &Self) -> f64 {
        tally(|| Ops::dots(1, x.nrows() * x.ncols()));
        let column = |j| self.col_as_slice(j).iter().zip(x.col_as_slice(j));
        (0..self.ncols()).flat_map(column).map(|(y, x)| y * x).sum()
    }
    fn is_finite(&self) -> bool {
        dense::is_finite(self)
    }
}

impl Numbers for Mat<f64> {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        for j in 0..self.ncols() {
            self.col_as_slice_mut(j).iter_mut().for_each(&mut *each);
        }
    }
}
