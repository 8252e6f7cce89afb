//! The Taylor coefficients of Euler's equations on n×n matrices.

use faer::Mat;

use super::{Euler, EulerGroup, Kinetic};
use crate::groups::{AlgebraMatrix, MatrixGroup};
use crate::problems::{MomentumSeries, PointOf, TaylorField};

/// The Taylor coefficients of −J⁻¹m, on the algebra of any matrix group.
impl<F: Fn(&Mat<f64>, &mut AlgebraMatrix)> TaylorField for Euler<MatrixGroup, Kinetic<F>> {
    type Series = MomentumSeries;

    fn series(&self, order: usize) -> MomentumSeries {
        MomentumSeries::new(self.group.n(), self.group.is_skew(), order)
    }
    fn coefficient(
        &self,
        [_, h]: [f64; 2],
        m: &Mat<f64>,
        k: usize,
        f: &mut [AlgebraMatrix],
        series: &mut MomentumSeries,
    ) {
        if k == 0 {
            series.start().copy_from(m);
        }
        (self.hamiltonian.0)(series.next(h, k, f), &mut f[k]);
        *f[k] *= faer::Scale(-1.0);
    }
}

/// f is that of the system without g.
impl<F: Fn(&Mat<f64>, &mut AlgebraMatrix)> TaylorField for EulerGroup<MatrixGroup, Kinetic<F>> {
    type Series = MomentumSeries;

    fn series(&self, order: usize) -> MomentumSeries {
        self.system.series(order)
    }
    fn coefficient(
        &self,
        time: [f64; 2],
        (_, m): &PointOf<Self>,
        k: usize,
        f: &mut [AlgebraMatrix],
        series: &mut MomentumSeries,
    ) {
        self.system.coefficient(time, m, k, f, series);
    }
}
