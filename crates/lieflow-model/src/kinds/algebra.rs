//! The algebras of matrices that a scene can name, with the orthogonal projection on each.
//!
//! | name | 𝔤 | projection of x |
//! |---|---|---|
//! | gl | all | x |
//! | sl | tr x = 0 | x − (tr x/n)𝟙 |
//! | so, so(p,q) | xᵀM + Mx = 0, M = diag(1, …, −1) with p ones | ½(x − MxᵀM) |
//! | sp | \[a b; c −aᵀ\], b and c symmetric | the means of what must be equal |

use faer::Mat;
use lieflow::Error;
use lieflow::groups::MatrixGroup;
use lieflow::scalar::{Ops, tally};

use crate::scene::Refusal;

/// An algebra of n×n matrices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Algebra {
    Gl,
    Sl,
    So,
    /// p and q.
    Indefinite(usize, usize),
    Sp,
}

/// The names in scenes; `so(p,q)` with numbers for p and q.
pub(super) const ALGEBRAS: [&str; 5] = ["so", "sl", "gl", "sp", "so(p,q)"];

impl Algebra {
    /// The algebra of that name; none for other names.
    pub(super) fn named(name: &str) -> Option<Algebra> {
        match name {
            "gl" => Some(Algebra::Gl),
            "sl" => Some(Algebra::Sl),
            "so" => Some(Algebra::So),
            "sp" => Some(Algebra::Sp),
            _ => {
                let (p, q) = name.strip_prefix("so(")?.strip_suffix(')')?.split_once(',')?;
                Some(Algebra::Indefinite(p.trim().parse().ok()?, q.trim().parse().ok()?))
            }
        }
    }

    /// Its name with n.
    pub(super) fn name(self, n: usize) -> String {
        match self {
            Algebra::Gl => format!("gl({n})"),
            Algebra::Sl => format!("sl({n})"),
            Algebra::So => format!("so({n})"),
            Algebra::Indefinite(p, q) => format!("so({p},{q})"),
            Algebra::Sp => format!("sp({n})"),
        }
    }

    /// The group. For sl(n) it is GL(n): a field in sl(n) moves nothing out of SL(n).
    ///
    /// # Errors
    /// A refusal of `key`, whose value has n rows.
    pub(super) fn group(self, n: usize, key: &str) -> Result<MatrixGroup, Refusal> {
        let group = match self {
            Algebra::Gl | Algebra::Sl => MatrixGroup::gl(n),
            Algebra::So => MatrixGroup::so(n),
            Algebra::Indefinite(p, q) if p.checked_add(q) == Some(n) => {
                MatrixGroup::indefinite(p, q)
            }
            Algebra::Indefinite(p, q) => {
                let message = format!("so({p},{q}) and {n}×{n} matrices, expected p + q = {n}");
                return Err(Refusal::at(key, message));
            }
            Algebra::Sp => MatrixGroup::sp(n),
        };
        group.map_err(|error: Error| Refusal::at(key, error.to_string()))
    }

    /// x ← its projection on the algebra.
    pub(super) fn project(self, x: &mut Mat<f64>) {
        let n = x.nrows();
        match self {
            Algebra::Gl => {}
            Algebra::Sl => {
                tally(|| Ops::adds((2 * n).saturating_sub(1)) + Ops::divs(1));
                let mean = (0..n).map(|i| x[(i, i)]).sum::<f64>() / n as f64;
                (0..n).for_each(|i| x[(i, i)] -= mean);
            }
            Algebra::So => skew(x, n),
            Algebra::Indefinite(p, _) => skew(x, p),
            Algebra::Sp => {
                let m = n / 2;
                tally(|| Ops::muladds(3 * m * m));
                for (i, j) in (0..m).flat_map(|i| (0..m).map(move |j| (i, j))) {
                    let half = 0.5 * (x[(i, j)] - x[(j + m, i + m)]);
                    (x[(i, j)], x[(j + m, i + m)]) = (half, -half);
                    for k in [0, m] {
                        let (above, below) = ((i + k, j + m - k), (j + k, i + m - k));
                        let mean = 0.5 * (x[above] + x[below]);
                        (x[above], x[below]) = (mean, mean);
                    }
                }
            }
        }
    }
}

/// x ← ½(x − MxᵀM), M with p ones.
fn skew(x: &mut Mat<f64>, p: usize) {
    let n = x.nrows();
    tally(|| Ops::muladds(n * (n + 1) / 2));
    for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let sign = if (i < p) == (j < p) { 1.0 } else { -1.0 };
        let half = 0.5 * (x[(i, j)] - sign * x[(j, i)]);
        (x[(i, j)], x[(j, i)]) = (half, -sign * half);
    }
}

/// The entry of x that is farthest from the algebra, where that is more than `tolerance` times its size.
pub(super) fn outside(algebra: Algebra, x: &Mat<f64>, tolerance: f64) -> Option<(usize, usize)> {
    let mut inside = x.clone();
    algebra.project(&mut inside);
    let entries = (0..x.nrows()).flat_map(|i| (0..x.ncols()).map(move |j| (i, j)));
    let away = |&(i, j): &(usize, usize)| (x[(i, j)] - inside[(i, j)]).abs();
    let farthest = entries.max_by(|a, b| away(a).total_cmp(&away(b)))?;
    (away(&farthest) > tolerance * x.norm_max()).then_some(farthest)
}
