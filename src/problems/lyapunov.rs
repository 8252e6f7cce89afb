//! Lyapunov exponents of ẋ = F(t, x) by continuous QR.
//!
//! Perturbations Ẏ = DF(t, x)Y are written as Y = QR. Only x, Q ∈ SO(n) and the growth σ_i = ln R_ii are integrated.
//!
//! With B = Qᵀ DF Q and L its strictly lower triangle: Q̇ = Q(L − Lᵀ), σ̇_i = B_ii. The group is
//! SO(n) × T(ℝⁿ × ℝⁿ), acting by left translation and addition: f = (Q(L − Lᵀ)Qᵀ, (diag B, F)).
//! The exponents are lim σ_i(t)/t. Their sum is the mean of tr DF.
//!
//! Cost: four products of n×n matrices, and F and DF. Sources: G. Benettin, L. Galgani, A. Giorgilli,
//! J.-M. Strelcyn, Meccanica 15 (1980); L. Dieci, R. D. Russell, E. S. Van Vleck, SIAM J. Numer. Anal.
//! 34 (1997).

use faer::Mat;

use super::Problem;
use crate::actions::LeftTranslation;
use crate::dense::{antisymmetrise, mul};
use crate::error::Error;
use crate::groups::{AlgebraMatrix, GroupMatrix, LieGroup, MatrixGroup, Product, Translations};

/// (σ, x), as columns.
type Growth = (Mat<f64>, Mat<f64>);

/// The variational equation of ẋ = F(t, x) in QR form; `field(t, x, dx, jacobian)` writes F and DF.
///
/// ```
/// use lieflow::faer::Mat;
/// use lieflow::maps::Cay;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::Lyapunov;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// // ẋ = (x₁ + x₂, −2x₂): the exponents are the eigenvalues.
/// let field = |_: f64, x: &Mat<f64>, dx: &mut Mat<f64>, jacobian: &mut Mat<f64>| {
///     (dx[(0, 0)], dx[(1, 0)]) = (x[(0, 0)] + x[(1, 0)], -2.0 * x[(1, 0)]);
///     jacobian.copy_from(lieflow::faer::mat![[1.0, 1.0], [0.0, -2.0]]);
/// };
/// let system = Lyapunov::new(2, field)?;
/// let mut y = system.state(&[0.0, 0.1])?;
/// let grid = TimeGrid::new([0.0, 50.0], 0.05)?;
/// integrate(&system, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
/// let exponents = system.exponents(50.0, &y);
/// assert!((exponents[0] - 1.0).abs() < 1e-2 && (exponents[1] + 2.0).abs() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Lyapunov<F> {
    group: Product<MatrixGroup, Translations<Growth>>,
    field: F,
}

impl<F: Fn(f64, &Mat<f64>, &mut Mat<f64>, &mut Mat<f64>)> Lyapunov<F> {
    /// The system on ℝⁿ.
    ///
    /// # Errors
    /// As [`MatrixGroup::so`].
    pub fn new(n: usize, field: F) -> Result<Self, Error> {
        let zero = (Mat::zeros(n, 1), Mat::zeros(n, 1));
        let group = Product(MatrixGroup::so(n)?, Translations::new(zero, 2 * n));
        Ok(Lyapunov { group, field })
    }

    /// The state at x, with Q = 𝟙 and σ = 0.
    ///
    /// # Errors
    /// [`Error::Shape`] for another length than n, [`Error::OutOfRange`] for numbers that are not
    /// finite.
    pub fn state(&self, x: &[f64]) -> Result<(GroupMatrix, Growth), Error> {
        let n = self.group.0.n();
        if x.len() != n {
            let (rows, cols) = (x.len(), 1);
            return Err(Error::Shape { arg: "x", rows, cols, expected_rows: n, expected_cols: 1 });
        }
        Error::all_finite("x", x)?;
        let x = Mat::from_fn(n, 1, |i, _| x[i]);
        Ok((self.group.0.identity(), (Mat::zeros(n, 1), x)))
    }

    /// σ_i/t, the mean growth over the time t since Q = 𝟙, σ = 0, in falling order. At t = 0 they are 0.
    ///
    /// After long times σ is mostly in falling order itself. It is not where DF does not mix the directions of Q.
    pub fn exponents(&self, t: f64, (_, (sigma, _)): &(GroupMatrix, Growth)) -> Vec<f64> {
        let mut exponents: Vec<f64> = sigma.col_as_slice(0).to_vec();
        exponents.iter_mut().filter(|s| **s != 0.0).for_each(|s| *s /= t);
        exponents.sort_unstable_by(|a, b| b.total_cmp(a));
        exponents
    }
}

impl<F: Fn(f64, &Mat<f64>, &mut Mat<f64>, &mut Mat<f64>)> Problem for Lyapunov<F> {
    type Group = Product<MatrixGroup, Translations<Growth>>;
    type Action = LeftTranslation;
    /// B, DF and a product.
    type Work = [Mat<f64>; 3];

    fn group(&self) -> &Self::Group {
        &self.group
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) -> Self::Work {
        let n = self.group.0.n();
        core::array::from_fn(|_| Mat::zeros(n, n))
    }
    fn f(
        &self,
        t: f64,
        (q, (_, x)): &(GroupMatrix, Growth),
        (turn, (growth, dx)): &mut (AlgebraMatrix, Growth),
        [b, jacobian, product]: &mut [Mat<f64>; 3],
    ) {
        (self.field)(t, x, dx, jacobian);
        mul(product, jacobian.as_ref(), q.as_ref());
        mul(b, q.transpose(), product.as_ref());
        for j in 0..b.ncols() {
            growth[(j, 0)] = b[(j, j)];
            (0..=j).for_each(|i| b[(i, j)] = 0.0);
        }
        // Q(L − Lᵀ)Qᵀ = P − Pᵀ with P = QLQᵀ.
        mul(product, q.as_ref(), b.as_ref());
        mul(turn, product.as_ref(), q.transpose());
        antisymmetrise(turn);
    }
}
