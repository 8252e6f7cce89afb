//! Oja's flow on the Stiefel manifold {X ∈ ℝⁿˣᵏ : XᵀX = 𝟙}: Ẋ = AX − X XᵀAX.
//!
//! f(X) = AXXᵀ − XXᵀA ∈ so(n); Λ(g, X) = gX. It is the gradient flow of ½ tr XᵀAX. The action conserves XᵀX. The span
//! of X converges to that of the k leading eigenvectors of A, and tr XᵀAX grows to the sum of their eigenvalues.
//! Source: E. Oja, J. Math. Biol. 15 (1982); W.-Y. Yan, U. Helmke, J. B. Moore, Math. Control Signals
//! Systems 7 (1994).

use faer::Mat;

use super::{Invariant, Invariants, Problem};
use crate::actions::Linear;
use crate::dense::{antisymmetrise, axpy, mul};
use crate::error::Error;
use crate::groups::{AlgebraMatrix, MatrixGroup};
use crate::problems::FieldStore;

/// Oja's flow for a symmetric A. The number of columns is that of the start.
///
/// ```
/// use lieflow::faer::mat;
/// use lieflow::maps::Cay;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::Oja;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// let flow = Oja::new(mat![[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 0.5]], 1)?;
/// let mut x = mat![[0.6], [0.0], [0.8]];
/// let grid = TimeGrid::new([0.0, 20.0], 0.1)?;
/// integrate(&flow, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut x, |_, _| {})?;
/// assert!((flow.trace(&x) - 3.0).abs() < 1e-12); // the largest eigenvalue
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Oja {
    group: MatrixGroup,
    a: Mat<f64>,
    k: usize,
}

impl Oja {
    /// Makes the flow with room for n×k matrices. A start with another number of columns has room made at its first f.
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::NotFiniteEntry`]; [`Error::OutOfRange`] for an A that is not
    /// symmetric to rounding, and for k outside 1 … n.
    pub fn new(a: Mat<f64>, k: usize) -> Result<Self, Error> {
        if a.nrows() != a.ncols() {
            return Err(Error::NotSquare { arg: "A", rows: a.nrows(), cols: a.ncols() });
        }
        let group = MatrixGroup::so(a.nrows())?;
        group.shape("A", a.as_ref())?;
        let skew = (&a - a.transpose()).norm_max();
        if skew > 64.0 * f64::EPSILON * a.norm_max() {
            return Err(Error::out_of_range("A − Aᵀ", skew, "a symmetric A"));
        }
        if k == 0 || k > a.nrows() {
            return Err(Error::out_of_range("k", k as f64, format!("1 ≤ k ≤ {}", a.nrows())));
        }
        Ok(Oja { group, a, k })
    }

    /// AX, XᵀAX and X XᵀAX for k columns.
    fn room(&self, k: usize) -> [Mat<f64>; 3] {
        let n = self.group.n();
        [Mat::zeros(n, k), Mat::zeros(k, k), Mat::zeros(n, k)]
    }

    /// Makes room for k columns, if the start has another number of them.
    fn fit(&self, k: usize, work: &mut [Mat<f64>; 3]) {
        if work[0].ncols() != k {
            *work = self.room(k);
        }
    }

    /// tr XᵀAX. Allocates.
    pub fn trace(&self, x: &Mat<f64>) -> f64 {
        let ax = &self.a * x;
        let column = |j| x.col_as_slice(j).iter().zip(ax.col_as_slice(j)).map(|(x, y)| x * y);
        (0..x.ncols()).flat_map(column).sum()
    }
}

impl Problem for Oja {
    type Group = MatrixGroup;
    type Action = Linear;
    /// AX, XᵀAX, X XᵀAX.
    type Work = [Mat<f64>; 3];

    fn group(&self) -> &MatrixGroup {
        &self.group
    }
    fn action(&self) -> &Linear {
        &Linear
    }
    fn work(&self) -> [Mat<f64>; 3] {
        self.room(self.k)
    }
    /// (AX)Xᵀ − ((AX)Xᵀ)ᵀ.
    fn f(&self, _: f64, x: &Mat<f64>, v: &mut AlgebraMatrix, work: &mut [Mat<f64>; 3]) {
        self.fit(x.ncols(), work);
        let [ax, ..] = work;
        mul(ax, self.a.as_ref(), x.as_ref());
        mul(v, ax.as_ref(), x.transpose());
        antisymmetrise(v);
    }
    /// AX − X(XᵀAX). It does not form the n×n matrix f, which is most of the work if X has few columns.
    fn field(
        &self,
        _: f64,
        x: &Mat<f64>,
        dx: &mut Mat<f64>,
        FieldStore { work, .. }: &mut FieldStore<Self>,
    ) {
        self.fit(x.ncols(), work);
        let [ax, inner, back] = work;
        mul(ax, self.a.as_ref(), x.as_ref());
        mul(inner, x.transpose(), ax.as_ref());
        mul(back, x.as_ref(), inner.as_ref());
        dx.copy_from(&*ax);
        axpy(-1.0, back, dx);
    }
}

impl Invariants for Oja {
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::of_the_action("tr XᵀX", 0)]
    }
    fn values(&self, x: &Mat<f64>) -> Vec<f64> {
        vec![x.squared_norm_l2()]
    }
}
