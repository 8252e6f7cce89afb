//! A flow of k-dimensional subspaces of ℝⁿ, on the Grassmann manifold.
//!
//! A subspace is an orthogonal projector P = Pᵀ = P², tr P = k. Ṗ = \[f(P), P\], f(P) = AP − PA ∈ so(n); Λ(g, P) = g P
//! gᵀ. This is the gradient flow of tr AP for a symmetric A. P converges to the projector onto the k leading
//! eigenvectors. The flow is that of [`Oja`](super::Oja) for P = XXᵀ, without the rotation of the frame X within its
//! span. The subspace also satisfies a Riccati equation: with P the span of \[𝟙; Z\], Ż = A₂₁ + A₂₂Z − ZA₁₁ − ZA₁₂Z.
//!
//! Invariants: the eigenvalues 1 and 0 of P (by the action).
//! Source: U. Helmke & J. B. Moore, Optimization and Dynamical Systems (1994), chapter 1.

use faer::Mat;

use super::{Invariant, Invariants, Oja, Problem};
use crate::actions::Conjugation;
use crate::dense::{antisymmetrise, mul};
use crate::error::Error;
use crate::groups::{AlgebraMatrix, MatrixGroup};

/// The flow of subspaces for a symmetric A.
///
/// ```
/// use lieflow::faer::mat;
/// use lieflow::maps::Cay;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::SubspaceFlow;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// let flow = SubspaceFlow::new(mat![[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 0.5]])?;
/// let mut p = flow.span(&mat![[0.6], [0.0], [0.8]])?;
/// let grid = TimeGrid::new([0.0, 20.0], 0.1)?;
/// integrate(&flow, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut p, |_, _| {})?;
/// // The line of (1, 1, 0).
/// assert!((p[(0, 1)] - 0.5).abs() < 1e-12 && p[(2, 2)].abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SubspaceFlow {
    group: MatrixGroup,
    a: Mat<f64>,
}

impl SubspaceFlow {
    /// Makes the flow for A.
    ///
    /// # Errors
    /// As [`Oja::new`].
    pub fn new(a: Mat<f64>) -> Result<Self, Error> {
        Oja::new(a.clone(), 1)?;
        Ok(SubspaceFlow { group: MatrixGroup::so(a.nrows())?, a })
    }

    /// The projector onto the span of the columns of X. X need not be orthonormal. Allocates.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::NotFiniteEntry`]; [`Error::Singular`] for columns that are dependent
    /// to working accuracy.
    pub fn span(&self, x: &Mat<f64>) -> Result<Mat<f64>, Error> {
        let (n, k) = (self.a.nrows(), x.ncols());
        if x.nrows() != n || k == 0 || k > n {
            let (rows, cols) = (x.nrows(), k);
            let expected_cols = k.clamp(1, n);
            return Err(Error::Shape { arg: "x", rows, cols, expected_rows: n, expected_cols });
        }
        for j in 0..k {
            if let Some(row) = (0..n).find(|&i| !x[(i, j)].is_finite()) {
                return Err(Error::NotFiniteEntry { arg: "x", row, col: j, value: x[(row, j)] });
            }
        }
        let qr = x.qr();
        let (r, q) = (qr.R(), qr.compute_thin_Q());
        let pivots = || (0..k).map(|i| r[(i, i)].abs());
        let rcond = pivots().fold(f64::INFINITY, f64::min) / pivots().fold(0.0, f64::max);
        let minimum = 1e-12;
        match rcond >= minimum {
            true => Ok(&q * q.transpose()),
            false => {
                let rcond = if rcond.is_nan() { 0.0 } else { rcond };
                Err(Error::Singular { arg: "x", rcond, minimum })
            }
        }
    }

    /// tr AP, which grows.
    pub fn trace(&self, p: &Mat<f64>) -> f64 {
        let column = |j| self.a.col_as_slice(j).iter().zip(p.col_as_slice(j)).map(|(a, p)| a * p);
        (0..p.ncols()).flat_map(column).sum()
    }
}

impl Problem for SubspaceFlow {
    type Group = MatrixGroup;
    type Action = Conjugation;
    type Work = ();

    fn group(&self) -> &MatrixGroup {
        &self.group
    }
    fn action(&self) -> &Conjugation {
        &Conjugation
    }
    fn work(&self) {}
    /// AP − (AP)ᵀ.
    fn f(&self, _: f64, p: &Mat<f64>, v: &mut AlgebraMatrix, _: &mut ()) {
        mul(v, self.a.as_ref(), p.as_ref());
        antisymmetrise(v);
    }
}

impl Invariants for SubspaceFlow {
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::of_the_action("tr P", 0), Invariant::of_the_action("tr P²", 0)]
    }
    fn values(&self, p: &Mat<f64>) -> Vec<f64> {
        vec![(0..p.nrows()).map(|i| p[(i, i)]).sum(), p.squared_norm_l2()]
    }
}
