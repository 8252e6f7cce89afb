//! The projection onto the algebra: the nearest element in the Frobenius norm.
//!
//! | group | nearest element to x |
//! |---|---|
//! | GL(n) | x |
//! | SO(n), Sp(2m), M orthogonal with Mᵀ = ±M | (x − M⁻¹xᵀM)/2 |
//! | Mᵀ = ±M = QDVᵀ, the singular values d_i | w = VᵀxQ; w_ij ← d_j(d_j w_ij ∓ d_i w_ji)/(d_i² + d_j²); VwQᵀ |
//! | any other M | by an orthonormal basis of 𝔤 in the coordinates w, from a singular value decomposition of n² rows |
//!
//! Also for any Mᵀ = ±M the map x ↦ (x − M⁻¹xᵀM)/2 is a projection onto 𝔤. It is not orthogonal where M is not a multiple
//! of an orthogonal matrix. The third row is orthogonal: Mu is skew or symmetric exactly if d_i w_ij = ∓d_j w_ji, so each
//! pair (i, j) is a problem of its own. It divides by no small number. So elements are right for a badly scaled M, too.
//!
//! Cost: four products. Once a group: a decomposition of M, O(n³). If M is neither symmetric nor skew: O(n⁶) and n⁴ numbers
//! once a group.

use faer::{Mat, MatRef, Scale};

use super::parts::{NOISE, Symmetry, symmetry};
use super::{AlgebraMatrix, Form, MatrixGroup};
use crate::dense::norm_frobenius;

/// The largest part of the constraints that counts as zero, however badly scaled M is.
const CUT_MAX: f64 = 1e-3;

/// M = QDVᵀ, with D relative to its largest entry. M is not orthogonal.
#[derive(Clone, Debug)]
pub(super) struct Projector {
    q: Mat<f64>,
    d: Vec<f64>,
    v: Mat<f64>,
    rule: Rule,
}

#[derive(Clone, Debug)]
enum Rule {
    /// Mᵀ = ±M.
    Pairs(Symmetry),
    /// An orthonormal basis of 𝔤 in the coordinates w, one vectorised element in each column.
    Basis(Mat<f64>),
}

impl Projector {
    fn of(m: &Mat<f64>) -> Self {
        let n = m.nrows();
        let rule = |d: &[f64], g: &Mat<f64>| {
            symmetry(m).map_or_else(|| Rule::Basis(null_space(d, g)), Rule::Pairs)
        };
        // M is finite and of full rank: the decomposition exists. Without it 𝔤 is taken as {0}.
        let Ok(svd) = m.svd() else {
            let zero = Mat::zeros(n, n);
            let rule = Rule::Basis(Mat::zeros(n * n, 0));
            return Projector { q: zero.clone(), d: vec![1.0; n], v: zero, rule };
        };
        let s = svd.S().column_vector();
        let d: Vec<f64> = s.iter().map(|d| d / s[0]).collect();
        let rule = rule(&d, &(svd.V().transpose() * svd.U()));
        Projector { q: svd.U().to_owned(), d, v: svd.V().to_owned(), rule }
    }

    /// The dimension of 𝔤.
    pub(super) fn dim(&self) -> usize {
        let n = self.d.len();
        match &self.rule {
            Rule::Pairs(Symmetry::Symmetric) => n * (n - 1) / 2,
            Rule::Pairs(Symmetry::Skew) => n * (n + 1) / 2,
            Rule::Basis(basis) => basis.ncols(),
        }
    }

    fn nearest(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let Projector { q, d, v, rule } = self;
        let w = v.transpose() * x * q;
        let w = match rule {
            Rule::Pairs(symmetry) => {
                let (n, sign) = (d.len(), -symmetry.sign());
                Mat::from_fn(n, n, |i, j| {
                    let mean = d[j] * w[(i, j)] + sign * (d[i] * w[(j, i)]);
                    d[j] * mean / (d[i] * d[i] + d[j] * d[j])
                })
            }
            Rule::Basis(basis) => onto(basis, &w),
        };
        v * w * q.transpose()
    }
}

/// The orthogonal projection of w onto the span of an orthonormal basis.
fn onto(basis: &Mat<f64>, w: &Mat<f64>) -> Mat<f64> {
    let n = w.nrows();
    let mut out = Mat::zeros(n, n);
    for b in basis.col_iter() {
        let mut c = 0.0;
        for k in 0..n * n {
            c += b[k] * w[(k % n, k / n)];
        }
        for k in 0..n * n {
            out[(k % n, k / n)] += c * b[k];
        }
    }
    out
}

/// An orthonormal basis of the w with Dw + wᵀGDG = 0, where G = VᵀQ: u = VwQᵀ ∈ 𝔤. O(n⁶).
///
/// The unknowns are z with w_ij = c_ij z_ij and c_ij = d_j/√(d_i² + d_j²), the size of w_ij for Mᵀ = ±M. Each equation is
/// divided by the size of its coefficients. So an equation of small singular values counts as much as one of large ones.
fn null_space(d: &[f64], g: &Mat<f64>) -> Mat<f64> {
    let n = d.len();
    let c = |i: usize, j: usize| d[j] / d[i].hypot(d[j]);
    let h = g * Mat::from_fn(n, n, |i, j| d[i] * g[(i, j)]);
    let mut map = Mat::<f64>::zeros(n * n, n * n);
    for j in 0..n {
        for i in 0..n {
            let own = d[i] * c(i, j);
            let others = (0..n).map(|k| (h[(k, j)] * c(k, i)).powi(2)).sum::<f64>();
            let size = own.hypot(others.sqrt());
            map[(i + j * n, i + j * n)] += own / size;
            for k in 0..n {
                map[(i + j * n, k + i * n)] += h[(k, j)] * c(k, i) / size;
            }
        }
    }
    let Ok(svd) = map.svd() else { return Mat::zeros(n * n, 0) };
    let s = svd.S().column_vector();
    // The decomposition of M has an error of ε‖M‖, which is this part of its smallest singular value.
    let rounding = 4.0 * n as f64 * f64::EPSILON / d[n - 1];
    let cut = rounding.clamp(NOISE, CUT_MAX) * s[0];
    let rank = (0..s.nrows()).filter(|&i| s[i] > cut).count();
    if rank == n * n {
        return Mat::zeros(n * n, 0);
    }
    let z = svd.V().subcols(rank, n * n - rank);
    let w = Mat::from_fn(n * n, n * n - rank, |k, l| c(k % n, k / n) * z[(k, l)]);
    w.qr().compute_thin_Q()
}

impl MatrixGroup {
    /// What the projection onto 𝔤_M needs. It is computed once a group.
    pub(super) fn projector(&self, m: &Mat<f64>) -> &Projector {
        self.projector.get_or_init(|| Projector::of(m))
    }

    /// The element of 𝔤 nearest to x in the Frobenius norm. Allocates.
    ///
    /// Cost: O(n²) on SO(n), a few products elsewhere, and O(n³) more at the first call of a group with another M. If M
    /// is neither symmetric nor skew, the first call takes O(n⁶) and n⁴ numbers of memory. Example: 0.8 GB for n = 100.
    pub fn project_algebra(&self, x: MatRef<'_, f64>) -> AlgebraMatrix {
        let half = Scale(0.5);
        let nearest = match &self.form {
            Form::Free => x.to_owned(),
            Form::Identity => (x - x.transpose()) * half,
            Form::Symplectic => match &self.m() {
                Some(m) => (x - m.transpose() * x.transpose() * m) * half,
                None => x.to_owned(),
            },
            Form::Bilinear { m, inverse } if is_orthogonal_symmetric(m) => {
                (x - inverse * x.transpose() * m) * half
            }
            Form::Bilinear { m, .. } => self.projector(m).nearest(x),
        };
        let mut nearest =
            if self.subgroup.is_complex { self.blocks(nearest.as_ref()) } else { nearest };
        if self.subgroup.is_special {
            let m = if self.subgroup.is_complex { self.n / 2 } else { 0 };
            let mean = self.trace(nearest.as_ref()) / (self.n - m) as f64;
            for i in 0..self.n - m {
                nearest[(m + i, i)] -= mean;
                if m > 0 {
                    nearest[(i, m + i)] += mean;
                }
            }
        }
        AlgebraMatrix::new_unchecked(nearest)
    }
}

fn is_orthogonal_symmetric(m: &Mat<f64>) -> bool {
    let n = m.nrows();
    let gap = m.transpose() * m - Mat::<f64>::identity(n, n);
    symmetry(m).is_some() && norm_frobenius(&gap) <= 4.0 * n as f64 * f64::EPSILON
}
