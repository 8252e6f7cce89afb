//! Sp(2m) acting on Lagrangian subspaces, for matrix Riccati equations.
//!
//! A symmetric P stands for the subspace {(x, Px)}. g = \[A B; C D\] moves it by Λ(g, P) = (C + DP)(A + BP)⁻¹. The linear
//! equation ẏ = \[a b; c −aᵀ\] y moves P by the Riccati equation Ṗ = c − aᵀP − Pa − PbP. A step may pass a pole of P.

use faer::{Mat, MatRef};

use super::Action;
use crate::dense::{Lu, is_finite, mul_add};
use crate::error::{Error, StepError};
use crate::groups::{
    AlgebraMatrix, GroupMatrix, LieAlgebra, MatrixGroup, OFF_M_MAX, check_entries,
};
use crate::maps::CoordinateMap;
use crate::maps::PsiOf;
use crate::scalar::{Ops, tally};
use crate::space::Metric;
use crate::tolerance::Scales;

/// Λ(g, P) = (C + DP)(A + BP)⁻¹ on symmetric m×m matrices.
///
/// Where A + BP is singular P has a pole. A step that ends there fails with [`StepError::NotFinite`], or with m ≥ 2 the other
/// numbers of P lose their digits: let steps end beside it.
///
/// ```
/// use lieflow::actions::Lagrangian;
/// use lieflow::groups::MatrixGroup;
/// use lieflow::methods::magnus::Magnus4;
/// use lieflow::problems::Flow;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// // Ṗ = 1 + P² from 0: P = tan t. The steps pass its pole at π/2.
/// let riccati = Flow::of_time(MatrixGroup::sp(2)?, Lagrangian, |_, v| {
///     (v[(1, 0)], v[(0, 1)]) = (1.0, -1.0);
/// });
/// let mut p = lieflow::faer::mat![[0.0]];
/// let grid = TimeGrid::new([0.0, 3.0], 0.1)?;
/// integrate(&riccati, &Magnus4, &grid, &SaveAt::Ends, &mut p, |_, _| {})?;
/// assert!((p[(0, 0)] - 3f64.tan()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lagrangian;

/// Scratch of the action.
#[derive(Debug)]
pub struct LagrangianWork {
    numerator: Mat<f64>,
    denominator: Mat<f64>,
    lu: Lu,
}

/// The four blocks A, B, C, D.
fn blocks(g: &Mat<f64>) -> [MatRef<'_, f64>; 4] {
    let m = g.nrows() / 2;
    [(0, 0), (0, m), (m, 0), (m, m)].map(|(i, j)| g.as_ref().submatrix(i, j, m, m))
}

impl Action<MatrixGroup> for Lagrangian {
    type Point = Mat<f64>;
    type Work = LagrangianWork;

    fn work(&self, group: &MatrixGroup) -> LagrangianWork {
        let m = group.n() / 2;
        let zero = || Mat::zeros(m, m);
        LagrangianWork { numerator: zero(), denominator: zero(), lu: Lu::new(m) }
    }
    fn check(&self, group: &MatrixGroup, p: &Mat<f64>) -> Result<(), Error> {
        let (rows, cols, m) = (p.nrows(), p.ncols(), group.n() / 2);
        match (rows, cols) == (m, m) {
            true => check_entries("y", p.as_ref()),
            false => Err(Error::Shape { arg: "y", rows, cols, expected_rows: m, expected_cols: m }),
        }
    }
    /// The group is symplectic, so that P stays symmetric: Sp(2m), or U(m) as real matrices. P is symmetric, to 1e-6 of its
    /// size. [`act`](Action::act) takes the symmetric part of its result.
    fn check_member(&self, group: &MatrixGroup, p: &Mat<f64>) -> Result<(), Error> {
        let has_j = || MatrixGroup::sp(group.n()).is_ok_and(|sp| group.m() == sp.m());
        if !(group.is_complex() || has_j()) {
            let why = "P stays symmetric under symplectic matrices alone; use MatrixGroup::sp";
            return Err(Error::Unsupported { what: "Lagrangian", with: group.name(), why });
        }
        let skew = (p - p.transpose()).norm_max();
        match skew > OFF_M_MAX * p.norm_max() {
            true => Err(Error::NotSymmetric { arg: "y", skew }),
            false => Ok(()),
        }
    }
    fn act(
        &self,
        _: &MatrixGroup,
        g: &GroupMatrix,
        p: &Mat<f64>,
        q: &mut Mat<f64>,
        LagrangianWork { numerator, denominator, lu }: &mut LagrangianWork,
    ) {
        let [a, b, c, d] = blocks(g);
        numerator.copy_from(c);
        mul_add(numerator, 1.0, d, p.as_ref());
        denominator.copy_from(a);
        mul_add(denominator, 1.0, b, p.as_ref());
        // (A + BP)ᵀ Qᵀ = (C + DP)ᵀ.
        lu.a.copy_from(denominator.transpose());
        lu.factor();
        q.copy_from(numerator.transpose());
        lu.solve(q.as_mut());
        tally(|| (Ops::adds(1) + Ops::muls(1)) * (q.ncols() * q.ncols().saturating_sub(1) / 2));
        for j in 0..q.ncols() {
            for i in 0..j {
                let mean = 0.5 * (q[(i, j)] + q[(j, i)]);
                (q[(i, j)], q[(j, i)]) = (mean, mean);
            }
        }
    }
    /// c + dP − P(a + bP), v = \[a b; c d\].
    fn generate(
        &self,
        _: &MatrixGroup,
        v: &AlgebraMatrix,
        p: &Mat<f64>,
        dp: &mut Mat<f64>,
        LagrangianWork { denominator, .. }: &mut LagrangianWork,
    ) {
        let [a, b, c, d] = blocks(v);
        denominator.copy_from(a);
        mul_add(denominator, 1.0, b, p.as_ref());
        dp.copy_from(c);
        mul_add(dp, 1.0, d, p.as_ref());
        mul_add(dp, -1.0, p.as_ref(), denominator.as_ref());
    }
    /// e moves P by at most ‖c‖ + (‖a‖ + ‖d‖)‖P‖ + ‖b‖‖P‖².
    fn error_ratio(
        &self,
        _: &MatrixGroup,
        e: &AlgebraMatrix,
        p: &Mat<f64>,
        scales: &mut Scales<'_>,
    ) -> f64 {
        let ([a, b, c, d], size) = (blocks(e).map(|block| block.norm_l2()), p.size());
        let moved = c + (a + d + b * size) * size;
        tally(|| Ops::dots(4, p.nrows() * p.ncols()) + Ops::sqrts(5) + Ops::muladds(3));
        scales.part().ratio_in_any_direction(moved, p)
    }
    /// A step from a pole of P, or to one, has the error of its other end: P has no digits at a pole; with m = 1 it has them after it.
    fn error_ratio_of_step(
        &self,
        group: &MatrixGroup,
        e: &AlgebraMatrix,
        ends: [&Mat<f64>; 2],
        scales: &mut Scales<'_>,
    ) -> f64 {
        let start = scales.clone();
        let [at_y, at_z] = ends.map(|p| {
            *scales = start.clone();
            self.error_ratio(group, e, p, scales)
        });
        at_y.min(at_z)
    }
    fn lambda<Psi: CoordinateMap<MatrixGroup>>(
        &self,
        psi_u: PsiOf<'_, MatrixGroup, Psi>,
        p: &Mat<f64>,
        q: &mut Mat<f64>,
        work: &mut LagrangianWork,
    ) -> Result<(), StepError> {
        let (group, g) = psi_u.form()?;
        self.act(group, g, p, q, work);
        StepError::finite(is_finite(q), "P")
    }
}
