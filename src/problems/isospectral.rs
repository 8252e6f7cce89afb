//! Isospectral flows on symmetric matrices: L̇ = \[B(L), L\], B(L) skew. f(L) = B(L); Λ(g, L) = g L gᵀ.
//!
//! | | B(L) | L(t → ∞) |
//! |---|---|---|
//! | [`IsospectralFlow::toda`] | L₋ᵀ − L₋ for the strictly lower L₋ | diagonal, the eigenvalues in descending order |
//! | [`IsospectralFlow::qr`] | log(L)₋ᵀ − log(L)₋, L > 0 | the same; L(k) are the iterates of the QR algorithm |
//! | [`IsospectralFlow::double_bracket`] | \[N, L\], N diagonal | diagonal, sorted as N is |
//!
//! Invariants: the eigenvalues. Every method that acts by the group conserves them to rounding. They are reported as tr
//! L, tr L², tr L³.
//! Sources: W. W. Symes, Physica D 4 (1982), for the QR algorithm as a Toda flow at integer times;
//! R. W. Brockett, Linear Algebra Appl. 146 (1991). Numbers: M. P. Calvo, A. Iserles, A. Zanna,
//! Math. Comp. 66 (1997).

use faer::Mat;

use super::{Invariant, Invariants, Problem};
use crate::actions::Conjugation;
use crate::dense::{SymmetricEigen, antisymmetrise, mul};
use crate::error::Error;
use crate::groups::{AlgebraMatrix, MatrixGroup};

/// The choice of B.
#[derive(Clone, Debug)]
enum Kind {
    Toda,
    Qr,
    DoubleBracket(Mat<f64>),
}

/// An isospectral flow L̇ = \[B(L), L\].
///
/// ```
/// use lieflow::faer::mat;
/// use lieflow::maps::Cay;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::IsospectralFlow;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// // Brockett's flow sorts 3, 1, 2. It starts from a matrix that is nearly diagonal.
/// let flow = IsospectralFlow::double_bracket(&[1.0, 2.0, 3.0])?;
/// let mut l = mat![[3.0, 0.1, 0.1], [0.1, 1.0, 0.1], [0.1, 0.1, 2.0]];
/// let grid = TimeGrid::new([0.0, 20.0], 0.05)?;
/// integrate(&flow, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut l, |_, _| {})?;
/// assert!(l[(0, 0)] < l[(1, 1)] && l[(1, 1)] < l[(2, 2)] && l[(0, 1)].abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct IsospectralFlow {
    group: MatrixGroup,
    kind: Kind,
}

impl IsospectralFlow {
    /// Toda's flow on n×n matrices: B(L) = L₋ᵀ − L₋. On a tridiagonal L it is the Toda lattice of n
    /// particles in Flaschka's variables (see [`toda_lattice`]).
    ///
    /// # Errors
    /// As [`MatrixGroup::so`].
    pub fn toda(n: usize) -> Result<Self, Error> {
        Ok(IsospectralFlow { group: MatrixGroup::so(n)?, kind: Kind::Toda })
    }

    /// The QR flow: B(L) = log(L)₋ᵀ − log(L)₋ for positive definite L.
    ///
    /// From time k to k + 1 it makes one step of the QR algorithm. If L is not positive definite, f has no value, and
    /// the step fails with [`StepError::NonFiniteRhs`](crate::StepError::NonFiniteRhs). Each f solves an eigenvalue
    /// problem.
    ///
    /// # Errors
    /// As [`MatrixGroup::so`].
    pub fn qr(n: usize) -> Result<Self, Error> {
        Ok(IsospectralFlow { group: MatrixGroup::so(n)?, kind: Kind::Qr })
    }

    /// Brockett's flow L̇ = \[L, \[L, N\]\] with N = diag(`diagonal`), as B(L) = \[N, L\]. ‖L − N‖
    /// falls, and the eigenvalues end on the diagonal in the order of those of N.
    ///
    /// # Errors
    /// As [`MatrixGroup::so`], and [`Error::OutOfRange`] for an entry that is not finite.
    pub fn double_bracket(diagonal: &[f64]) -> Result<Self, Error> {
        Error::all_finite("diagonal", diagonal)?;
        let n = diagonal.len();
        let target = Mat::from_fn(n, n, |i, j| if i == j { diagonal[i] } else { 0.0 });
        Ok(IsospectralFlow { group: MatrixGroup::so(n)?, kind: Kind::DoubleBracket(target) })
    }

    /// B(L), into v.
    fn generator(&self, l: &Mat<f64>, v: &mut Mat<f64>, log: &mut Option<Logarithm>) {
        match (&self.kind, log) {
            (Kind::Qr, Some(Logarithm { eigen, log })) => {
                let ln = |x: f64| if x > 0.0 { x.ln() } else { f64::NAN };
                match eigen.function(l, ln, log) {
                    Ok(()) => skew_of_lower(log, v),
                    Err(_) => v.fill(f64::NAN),
                }
            }
            (Kind::Toda | Kind::Qr, _) => skew_of_lower(l, v),
            // NL − LN = (NL) − (NL)ᵀ.
            (Kind::DoubleBracket(target), _) => {
                mul(v, target.as_ref(), l.as_ref());
                antisymmetrise(v);
            }
        }
    }
}

/// v ← l₋ᵀ − l₋, with the strictly lower triangle l₋.
fn skew_of_lower(l: &Mat<f64>, v: &mut Mat<f64>) {
    for j in 0..l.ncols() {
        v[(j, j)] = 0.0;
        for i in j + 1..l.nrows() {
            v[(i, j)] = -l[(i, j)];
            v[(j, i)] = l[(i, j)];
        }
    }
}

/// Scratch of the flows: for the QR flow, log L by its eigenvectors.
#[derive(Debug)]
pub struct IsospectralFlowWork {
    log: Option<Logarithm>,
}

#[derive(Debug)]
struct Logarithm {
    eigen: SymmetricEigen,
    log: Mat<f64>,
}

impl Problem for IsospectralFlow {
    type Group = MatrixGroup;
    type Action = Conjugation;
    type Work = IsospectralFlowWork;

    fn group(&self) -> &MatrixGroup {
        &self.group
    }
    fn action(&self) -> &Conjugation {
        &Conjugation
    }
    fn work(&self) -> IsospectralFlowWork {
        let n = self.group.n();
        let log = || Logarithm { eigen: SymmetricEigen::new(n), log: Mat::zeros(n, n) };
        IsospectralFlowWork { log: matches!(self.kind, Kind::Qr).then(log) }
    }
    fn f(&self, _: f64, l: &Mat<f64>, v: &mut AlgebraMatrix, work: &mut IsospectralFlowWork) {
        self.generator(l, v, &mut work.log);
    }
}

impl Invariants for IsospectralFlow {
    fn invariants(&self) -> Vec<Invariant> {
        let trace = |name| Invariant::of_the_action(name, 0).in_terms();
        ["tr L", "tr L²", "tr L³"].map(trace).into()
    }
    fn values(&self, l: &Mat<f64>) -> Vec<f64> {
        let square = l * l;
        let trace = |a: &Mat<f64>| (0..a.nrows()).map(|i| a[(i, i)]).sum::<f64>();
        vec![trace(l), trace(&square), trace(&(&square * l))]
    }
    fn sizes(&self, l: &Mat<f64>) -> Vec<f64> {
        let size = l.norm_l2();
        [1, 2, 3].map(|k| size.powi(k)).into()
    }
}

/// The matrix L of the Toda lattice in Flaschka's variables.
///
/// The lattice is n particles on a line with positions q and momenta p, H = ½Σp² + Σ e^{q_i − q_{i+1}}. L is
/// tridiagonal with L_ii = −p_i/2 and L_{i,i+1} = ½ e^{(q_i − q_{i+1})/2}. It moves by [`IsospectralFlow::toda`]. Its
/// eigenvalues are −½ times the momenta after the last collision.
///
/// ```
/// use lieflow::prelude::*;
/// use lieflow::problems::{IsospectralFlow, toda_lattice};
/// let mut l = toda_lattice(&[-1.0, 0.2, 0.9], &[0.8, -0.1, -0.7])?;
/// let grid = TimeGrid::new([0.0, 40.0], 0.05)?;
/// let toda = IsospectralFlow::toda(3)?;
/// integrate(&toda, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut l, |_, _| {})?;
/// // After the last collision the momenta −2L_ii are sorted, and nothing acts between the particles.
/// assert!(l[(0, 0)] > l[(1, 1)] && l[(1, 1)] > l[(2, 2)] && l[(0, 1)].abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::Shape`] for lists of different lengths, [`Error::OutOfRange`] for numbers that are not
/// finite, and for neighbours whose force is not.
pub fn toda_lattice(q: &[f64], p: &[f64]) -> Result<Mat<f64>, Error> {
    let n = q.len();
    if p.len() != n {
        let (rows, cols) = (p.len(), 1);
        return Err(Error::Shape { arg: "p", rows, cols, expected_rows: n, expected_cols: 1 });
    }
    Error::all_finite("q", q)?;
    Error::all_finite("p", p)?;
    let mut b = Vec::with_capacity(n.saturating_sub(1));
    for (i, pair) in q.windows(2).enumerate() {
        let gap = pair[0] - pair[1];
        b.push(0.5 * (0.5 * gap).exp());
        if !b[i].is_finite() {
            return Err(Error::out_of_range(
                "q₁ − q₂ of two neighbours",
                gap,
                "exp((q₁ − q₂)/2) finite",
            ));
        }
    }
    Ok(Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => -0.5 * p[i],
        1 => b[i.min(j)],
        _ => 0.0,
    }))
}
