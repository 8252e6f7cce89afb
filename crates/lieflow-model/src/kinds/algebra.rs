//! The algebras of matrices that a scene can name, with the orthogonal projection on each.
//!
//! | name | 𝔤 | projection of x |
//! |---|---|---|
//! | gl | all | x |
//! | sl | tr x = 0 | x − (tr x/n)𝟙 |
//! | so, so(p,q) | xᵀM + Mx = 0, M = diag(1, …, −1) with p ones | ½(x − MxᵀM) |
//! | sp | \[a b; c −aᵀ\], b and c symmetric | the means of what must be equal |
//! | u | x† + x = 0, complex | ½(x − x†) |
//! | su | and tr x = 0 | that, less its trace/n on the diagonal |
//!
//! A complex matrix X + iY is here the real one \[X −Y; Y X\], of twice the size: U(n) is in SO(2n).

use faer::Mat;
use lieflow::Error;
use lieflow::dense::largest_entry;
use lieflow::error::Plain;
use lieflow::groups::MatrixGroup;
use lieflow::names::plain;
use lieflow::scalar::{Ops, tally};

use crate::reader::{KeyPath, Refusal, amount};

/// An algebra of n×n matrices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Algebra {
    Gl,
    Sl,
    So,
    /// p and q.
    Indefinite(usize, usize),
    Sp,
    U,
    Su,
}

/// An algebra as a scene names it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Named {
    pub(super) algebra: Algebra,
    /// The size, where the name says it.
    n: Option<usize>,
}

impl Named {
    /// Checks that the stated size is that of the value of `key`, which has n rows.
    ///
    /// # Errors
    /// A refusal of `key`.
    pub(super) fn check_size(self, n: usize, key: &str) -> Result<(), Refusal> {
        match self.n {
            Some(stated) if stated != n => {
                let name = self.algebra.name(stated);
                Err(Refusal::at(
                    key,
                    format!("found {}, expected {stated} for {name}", amount(n, "rows")),
                ))
            }
            _ => Ok(()),
        }
    }
}

/// The names in scenes; `so(p,q)` with numbers for p and q. The last two have complex matrices.
pub(super) const ALGEBRAS: [&str; 7] = ["so", "sl", "gl", "sp", "so(p,q)", "u", "su"];
/// Those with real matrices.
pub(super) const REAL_ALGEBRAS: &[&str] = ALGEBRAS.split_at(5).0;

impl Algebra {
    /// As [`named`](Self::named), for real matrices alone.
    pub(super) fn real_named(name: &str) -> Option<Named> {
        Algebra::named(name).filter(|named| !named.algebra.is_complex())
    }

    /// The algebra of that name or of its group, and n where the name has it: `so`, `so4`, `SO(4)`, `so(3,1)`; none for
    /// other names.
    pub(super) fn named(name: &str) -> Option<Named> {
        // A hyphen in it is a sign.
        let name = (!name.contains('-')).then(|| plain(name))?;
        let digits = name.find(|c: char| c.is_ascii_digit()).unwrap_or(name.len());
        let (family, size) = name.split_at(digits);
        if let Some((p, q)) = size.split_once(',').filter(|_| family == "so") {
            let algebra = Algebra::Indefinite(p.parse().ok()?, q.parse().ok()?);
            return Some(Named { algebra, n: None });
        }
        let algebra = match family {
            "gl" => Algebra::Gl,
            "sl" => Algebra::Sl,
            "so" => Algebra::So,
            "sp" => Algebra::Sp,
            "u" => Algebra::U,
            "su" => Algebra::Su,
            _ => return None,
        };
        let n = if size.is_empty() { None } else { Some(size.parse().ok()?) };
        Some(Named { algebra, n })
    }

    /// Are its matrices complex?
    pub(super) fn is_complex(self) -> bool {
        matches!(self, Algebra::U | Algebra::Su)
    }

    /// Its name with n.
    pub(super) fn name(self, n: usize) -> String {
        match self {
            Algebra::Gl => format!("gl({n})"),
            Algebra::Sl => format!("sl({n})"),
            Algebra::So => format!("so({n})"),
            Algebra::Indefinite(p, q) => format!("so({p},{q})"),
            Algebra::Sp => format!("sp({n})"),
            Algebra::U => format!("u({n})"),
            Algebra::Su => format!("su({n})"),
        }
    }

    /// The group; of u(n) and su(n) as real matrices.
    ///
    /// # Errors
    /// A refusal of `key`, whose value has n rows.
    pub(super) fn group(self, n: usize, key: &str) -> Result<MatrixGroup, Refusal> {
        let group = match self {
            Algebra::Gl => MatrixGroup::gl(n),
            Algebra::Sl => MatrixGroup::sl(n),
            Algebra::So => MatrixGroup::so(n),
            Algebra::Indefinite(p, q) if p.checked_add(q) == Some(n) => {
                MatrixGroup::indefinite(p, q)
            }
            Algebra::Indefinite(p, q) => {
                let message = format!("so({p},{q}) and {n}×{n} matrices, expected p + q = {n}");
                return Err(Refusal::at(key, message));
            }
            Algebra::Sp => MatrixGroup::sp(n),
            Algebra::U => MatrixGroup::u(n),
            Algebra::Su => MatrixGroup::su(n),
        };
        group.map_err(|error: Error| Refusal::from(error).about(key))
    }

    /// The form of an element g of the group of n×n matrices.
    pub(super) fn form_of_group(self, n: usize) -> String {
        match self {
            Algebra::Gl => "det g is not 0".into(),
            Algebra::Sl => "det g = 1".into(),
            Algebra::So => "the rows of g are unit vectors at right angles, and det g = 1".into(),
            Algebra::Indefinite(p, q) => {
                format!("gᵀMg = M, M diagonal with {p} entries 1 and {q} entries -1")
            }
            Algebra::Sp => {
                let m = n / 2;
                format!("gᵀJg = J with J = [0 1; -1 0] of {m}×{m} blocks; {}", coordinates(m))
            }
            Algebra::U => "g†g = 1".into(),
            Algebra::Su => "g†g = 1, and det g = 1".into(),
        }
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
            Algebra::U => skew_hermitian(x, false),
            Algebra::Su => skew_hermitian(x, true),
        }
    }
}

/// \[X −Y; Y X\] ← that of X, Y ← ½(X − Xᵀ), ½(Y + Yᵀ), from its first n columns; and Y without its trace.
fn skew_hermitian(x: &mut Mat<f64>, traceless: bool) {
    let n = x.ncols() / 2;
    tally(|| Ops::muladds(n * (n + 1)) + Ops::adds(if traceless { 2 * n } else { 0 }));
    let sum = || (0..n).map(|i| x[(n + i, i)]).sum::<f64>();
    let mean = if traceless { sum() / n as f64 } else { 0.0 };
    for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let re = 0.5 * (x[(i, j)] - x[(j, i)]);
        let im = 0.5 * (x[(n + i, j)] + x[(n + j, i)]) - if i == j { mean } else { 0.0 };
        for (i, j, re) in [(i, j, re), (j, i, -re)] {
            (x[(i, j)], x[(n + i, n + j)]) = (re, re);
            (x[(n + i, j)], x[(i, n + j)]) = (im, -im);
        }
    }
}

/// x ← ½(x − MxᵀM), M with p ones.
fn skew(x: &mut Mat<f64>, p: usize) {
    let n = x.nrows();
    tally(|| Ops::muladds(n * (n + 1) / 2));
    for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let sign = if (i < p) == (j < p) { 1.0 } else { -1.0 };
        let half = 0.5 * x[(i, j)] - sign * (0.5 * x[(j, i)]);
        (x[(i, j)], x[(j, i)]) = (half, -sign * half);
    }
}

/// How a matrix that is not in an algebra misses it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Miss {
    /// The place of the first of the entries that do not go together.
    pub(super) key: String,
    /// The mistake in these entries.
    pub(super) why: String,
    /// The form of the algebra.
    pub(super) form: String,
}

/// How x, the value of `key`, misses the algebra by more than `tolerance` times its size, at the entry where it does
/// most. The imaginary part of a complex one is the value of `{key}_imaginary`.
pub(super) fn miss(algebra: Algebra, key: &str, x: &Mat<f64>, tolerance: f64) -> Option<Miss> {
    let rows = x.nrows();
    let n = if algebra.is_complex() { rows / 2 } else { rows };
    let mut inside = x.clone();
    algebra.project(&mut inside);
    // Of a complex one the last n rows are the imaginary part.
    let entries = (0..rows).flat_map(|i| (0..n).map(move |j| (i, j)));
    let away = |&(i, j): &(usize, usize)| (x[(i, j)] - inside[(i, j)]).abs();
    let farthest = entries.max_by(|a, b| away(a).total_cmp(&away(b)))?;
    if away(&farthest) <= tolerance * largest_entry(x.as_ref()) {
        return None;
    }
    let (i, j) = farthest;
    // The entry that follows from this one, and its factor.
    let (partner, factor) = match algebra {
        Algebra::Gl | Algebra::Sl => ((i, j), 1.0),
        Algebra::So => ((j, i), -1.0),
        Algebra::Indefinite(p, _) => ((j, i), if (i < p) == (j < p) { -1.0 } else { 1.0 }),
        Algebra::Sp => {
            let other = |i: usize| (i + n / 2) % n;
            let same_half = (i < n / 2) == (j < n / 2);
            ((other(j), other(i)), if same_half { -1.0 } else { 1.0 })
        }
        Algebra::U | Algebra::Su if i < n => ((j, i), -1.0),
        Algebra::U | Algebra::Su => ((n + j, i - n), 1.0),
    };
    let [first, second] = [farthest.min(partner), farthest.max(partner)];
    let name = |(i, j): (usize, usize)| match i < n {
        true => key.cell(i, j),
        false => format!("{key}_imaginary").cell(i - n, j),
    };
    let why = match algebra {
        Algebra::Gl | Algebra::Sl => {
            let trace: f64 = (0..n).map(|i| x[(i, i)]).sum();
            format!("the sum of its diagonal is {}, expected 0", Plain(&trace))
        }
        Algebra::Su if i >= n && i - n == j => {
            let trace: f64 = (0..n).map(|i| x[(n + i, i)]).sum();
            format!(
                "the sum of the imaginary parts of its diagonal is {}, expected 0",
                Plain(&trace)
            )
        }
        _ if first == second => format!("{} is {}, expected 0", name(first), Plain(&x[first])),
        _ => {
            let sign = if factor < 0.0 { "-" } else { "" };
            format!(
                "{} is {} and {} is {}, expected {} = {sign}{}",
                name(first),
                Plain(&x[first]),
                name(second),
                Plain(&x[second]),
                name(second),
                name(first)
            )
        }
    };
    let of = algebra.name(n);
    let form = match algebra {
        Algebra::Gl | Algebra::Sl => format!("{of}: the sum of the diagonal is 0"),
        Algebra::So => format!("{of}: each entry below the diagonal is minus that above it"),
        Algebra::Indefinite(p, _) => format!(
            "{of}: each entry below the diagonal is minus that above it; where one of its row and column is up to {p} \
             and the other is not, it is the same"
        ),
        Algebra::Sp => {
            let m = n / 2;
            format!(
                "{of} here is [A B; C -Aᵀ] of {m}×{m} blocks, B and C symmetric; {}",
                coordinates(m)
            )
        }
        Algebra::U | Algebra::Su => {
            let traceless = if algebra == Algebra::Su { ", with the trace 0" } else { "" };
            format!(
                "{of}: the real part is antisymmetric and the imaginary part symmetric{traceless}; -iH is in it for a \
                 Hermitian H"
            )
        }
    };
    Some(Miss { key: name(first), why, form })
}

/// The order of the coordinates of sp(2m).
fn coordinates(m: usize) -> String {
    let names =
        |letter: &str| (1..=m).map(|i| format!("{letter}{i}")).collect::<Vec<_>>().join(", ");
    format!("the coordinates are ({}, {})", names("q"), names("p"))
}
