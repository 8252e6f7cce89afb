//! Square matrices of up to five rows in numbers of 32 digits.

use core::ops::{Add, Index, IndexMut, Mul, Sub};
use std::sync::LazyLock;

use lieflow::methods::Metric;
use lieflow::problems::LinearSpace;
use lieflow::scalar::Real;

use super::D;
use super::members::Numbers;

/// No matrix has more rows.
const ROWS: usize = 5;

/// An n×n matrix. What lies outside of n×n is 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square {
    n: usize,
    rows: [[D; ROWS]; ROWS],
}

impl lieflow::space::Numbers for Square {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.rows.iter_mut().flatten().for_each(|x| x.each_number(each));
    }
}

impl Square {
    pub(crate) fn from_fn(n: usize, entry: impl Fn(usize, usize) -> D) -> Self {
        let at = |i, j| if i < n && j < n { entry(i, j) } else { D::lit(0.0) };
        Square { n, rows: core::array::from_fn(|i| core::array::from_fn(|j| at(i, j))) }
    }
    pub(crate) fn zero(n: usize) -> Self {
        Square::from_fn(n, |_, _| D::lit(0.0))
    }
    pub(crate) fn identity(n: usize) -> Self {
        Square::from_fn(n, |i, j| D::lit(f64::from(u8::from(i == j))))
    }
    pub(crate) fn n(&self) -> usize {
        self.n
    }
    pub(crate) fn transpose(&self) -> Square {
        Square::from_fn(self.n, |i, j| self.rows[j][i])
    }
    fn entries(&self) -> impl Iterator<Item = &D> {
        self.rows[..self.n].iter().flat_map(|row| &row[..self.n])
    }

    /// Where the entries are that are not 0.
    pub(crate) fn nonzero(&self) -> impl Iterator<Item = (usize, usize)> {
        let all = (0..self.n).flat_map(|i| (0..self.n).map(move |j| (i, j)));
        all.filter(|&at| self[at] != D::lit(0.0))
    }

    /// self⁻¹·b; not finite where self is singular.
    pub(crate) fn solve(self, b: Square) -> Square {
        let mut rows = [[D::lit(0.0); 2 * ROWS]; ROWS];
        for i in 0..self.n {
            rows[i][..self.n].copy_from_slice(&self.rows[i][..self.n]);
            rows[i][self.n..2 * self.n].copy_from_slice(&b.rows[i][..self.n]);
        }
        reduce(&mut rows[..self.n], 2 * self.n);
        Square::from_fn(self.n, |i, j| rows[i][self.n + j])
    }

    /// The exponential: the Taylor polynomial of degree 19 of self/2ˢ, whose norm is at most 1/8, squared
    /// s times.
    pub(crate) fn exp(self) -> Square {
        static INVERSE_FACTORIALS: LazyLock<[D; 20]> = LazyLock::new(|| {
            let mut c = [D::lit(1.0); 20];
            (1..20).for_each(|k| c[k] = c[k - 1] / D::lit(k as f64));
            c
        });
        let s = (8.0 * self.size().value()).log2().ceil().max(0.0) as i32;
        let x = self * D::lit(0.5f64.powi(s));
        let (one, square) = (Square::identity(self.n), x * x);
        let (powers, fourth) = ([one, x, square, square * x], square * square);
        let mut sum = Square::zero(self.n);
        for c in INVERSE_FACTORIALS.chunks(4).rev() {
            sum = sum * fourth;
            powers.iter().zip(c).for_each(|(x, c)| LinearSpace::add(&mut sum, *c, x));
        }
        (0..s).fold(sum, |x, _| x * x)
    }
}

/// Gauss and Jordan with pivots by rows: the first columns, as many as there are rows, become 𝟙, and the
/// others, up to `columns`, what the solution is.
pub(crate) fn reduce<const C: usize>(rows: &mut [[D; C]], columns: usize) {
    for k in 0..rows.len() {
        let size = |i: &usize| rows[*i][k].value().abs();
        let pivot = (k..rows.len()).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(k);
        rows.swap(k, pivot);
        let inverse = D::lit(1.0) / rows[k][k];
        rows[k][k..columns].iter_mut().for_each(|x| *x = *x * inverse);
        let leading = rows[k];
        for (i, row) in rows.iter_mut().enumerate() {
            let factor = row[k];
            if i != k && factor != D::lit(0.0) {
                (k..columns).for_each(|j| row[j] -= factor * leading[j]);
            }
        }
    }
}

impl Index<(usize, usize)> for Square {
    type Output = D;
    fn index(&self, (i, j): (usize, usize)) -> &D {
        &self.rows[i][j]
    }
}
impl IndexMut<(usize, usize)> for Square {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut D {
        &mut self.rows[i][j]
    }
}

impl Mul for Square {
    type Output = Square;
    fn mul(self, b: Square) -> Square {
        let mut out = Square::zero(self.n);
        for (row, a) in out.rows[..self.n].iter_mut().zip(&self.rows) {
            for (a, b) in a.iter().zip(&b.rows[..self.n]) {
                (0..self.n).for_each(|j| row[j] += *a * b[j]);
            }
        }
        out
    }
}
impl Mul<D> for Square {
    type Output = Square;
    fn mul(self, a: D) -> Square {
        Square::from_fn(self.n, |i, j| self.rows[i][j] * a)
    }
}
impl Add for Square {
    type Output = Square;
    fn add(self, b: Square) -> Square {
        Square::from_fn(self.n, |i, j| self.rows[i][j] + b.rows[i][j])
    }
}
impl Sub for Square {
    type Output = Square;
    fn sub(self, b: Square) -> Square {
        Square::from_fn(self.n, |i, j| self.rows[i][j] - b.rows[i][j])
    }
}

impl Metric for Square {
    type Scalar = D;
    fn assign(&mut self, x: &Self) {
        *self = *x;
    }
    fn size(&self) -> D {
        self.entries().fold(D::lit(0.0), |sum, &x| sum + x * x).sqrt()
    }
    fn distance(&self, x: &Self) -> D {
        (*self - *x).size()
    }
}

impl LinearSpace for Square {
    fn clear(&mut self) {
        *self = Square::zero(self.n);
    }
    fn add(&mut self, a: D, x: &Self) {
        for (y, x) in self.rows[..self.n].iter_mut().zip(&x.rows) {
            (0..self.n).for_each(|j| y[j] += a * x[j]);
        }
    }
    fn dot(&self, x: &Self) -> D {
        self.entries().zip(x.entries()).fold(D::lit(0.0), |sum, (a, b)| sum + *a * *b)
    }
    fn is_finite(&self) -> bool {
        self.entries().all(|x| Real::is_finite(*x))
    }
}

impl Numbers for Square {
    fn each(&self, take: &mut impl FnMut(D)) {
        self.entries().for_each(|x| take(*x));
    }
}
