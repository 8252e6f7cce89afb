//! Lie series of n×n matrices.

use faer::Mat;

use super::SeriesGroup;
use crate::dense::{axpy, mul_add};
use crate::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup};
use crate::space::Metric;

impl SeriesGroup for MatrixGroup {
    fn clear(&self, x: &mut GroupMatrix) {
        x.fill(0.0);
    }
    fn scale(&self, a: f64, x: &mut GroupMatrix) {
        let x: &mut Mat<f64> = x;
        x.col_iter_mut().for_each(|column| column.iter_mut().for_each(|x| *x *= a));
    }
    fn add(&self, x: &GroupMatrix, y: &mut GroupMatrix) {
        axpy(1.0, x, y);
    }
    fn add_algebra(&self, a: f64, u: &AlgebraMatrix, out: &mut GroupMatrix) {
        axpy(a, u, out);
    }
    fn add_product(
        &self,
        a: f64,
        u: &AlgebraMatrix,
        x: &GroupMatrix,
        from_right: bool,
        out: &mut GroupMatrix,
    ) {
        let (u, x): (&Mat<f64>, &Mat<f64>) = (u, x);
        let (left, right) = if from_right { (x, u) } else { (u, x) };
        mul_add(out, a, left.as_ref(), right.as_ref());
    }
    fn size(&self, x: &GroupMatrix) -> f64 {
        Metric::size(x)
    }
}
