//! Explicit Butcher tableaus and embedded pairs, as constants.
//!
//! Tests check the order conditions of each tableau and of each embedded row.

mod conditions;
mod dense;
mod dop853;
mod pairs;
mod trees;

pub use conditions::{order_defects, order_of};
pub use dense::{Dense, Row};
pub use dop853::DOP853;
pub use pairs::{BS3, DOPRI5, RKF45, VERNER6};

use crate::scalar::Real;

/// An explicit Runge–Kutta tableau with S stages; `a[i]` is used for j < i only.
///
/// A run believes the order of a tableau: only a debug build checks it before a run. Let a test of yours call
/// [`check`](Self::check) of a tableau of your own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tableau<const S: usize> {
    /// The name in scene files.
    pub name: &'static str,
    /// The classical order. Steps by error are chosen by it.
    pub order: usize,
    /// Stage weights a_ij.
    pub a: [[f64; S]; S],
    /// Update weights b_j.
    pub b: [f64; S],
    /// Nodes c_i.
    pub c: [f64; S],
    /// The error estimate of an embedded pair.
    pub error: Option<ErrorEstimate<S>>,
    /// The dense output: points within a step.
    pub dense: Dense,
}

impl<const S: usize> Tableau<S> {
    /// The number of stages of the update. A last stage that only the error estimate uses does not count.
    pub const fn update_stages(&self) -> usize {
        let mut s = S;
        while s > 1 && self.b[s - 1] == 0.0 {
            s -= 1;
        }
        s
    }

    /// The number of stages of the update and the error estimate: S, or fewer for a [`padded`](Self::padded) tableau.
    pub const fn all_stages(&self) -> usize {
        let Some(ErrorEstimate { e, damp, .. }) = self.error else { return self.update_stages() };
        let mut s = S;
        while s > 1 && self.b[s - 1] == 0.0 && e[s - 1] == 0.0 {
            if let Some(d) = damp
                && d[s - 1] != 0.0
            {
                break;
            }
            s -= 1;
        }
        s
    }

    /// True if the last of all stages is taken at the end of the step. Then it is the first stage of the next step.
    pub const fn ends_with_first_stage(&self) -> bool {
        let last = self.all_stages() - 1;
        let mut same = last >= self.update_stages() && self.c[last] == 1.0;
        let mut j = 0;
        while j < last {
            same = same && self.a[last][j] == self.b[j];
            j += 1;
        }
        same
    }

    /// This tableau with room for N ≥ S stages, so that methods chosen by name share one type. The added stages have
    /// the weight 0 and are never evaluated.
    pub const fn padded<const N: usize>(&self) -> Tableau<N> {
        let mut a = [[0.0; N]; N];
        let mut i = 0;
        while i < S {
            a[i] = pad(&self.a[i]);
            i += 1;
        }
        let error = match &self.error {
            None => None,
            Some(ErrorEstimate { order, e, damp }) => {
                let damp = match damp {
                    Some(d) => Some(pad(d)),
                    None => None,
                };
                Some(ErrorEstimate { order: *order, e: pad(e), damp })
            }
        };
        let Tableau { name, order, dense, .. } = *self;
        Tableau { name, order, a, b: pad(&self.b), c: pad(&self.c), error, dense }
    }
}

/// x with zeros after it.
pub(super) const fn pad<const S: usize, const N: usize>(x: &[f64; S]) -> [f64; N] {
    let mut padded = [0.0; N];
    let mut i = 0;
    while i < S {
        padded[i] = x[i];
        i += 1;
    }
    padded
}

/// E²/√(E² + D²/100), or E without a damping row, and 0 when both vanish.
#[inline]
fn fold_error<R: Real>(e: R, damp: Option<R>) -> R {
    match damp {
        Some(d) if !(e + d).all_below(f64::MIN_POSITIVE) => {
            let d = R::lit(0.1) * d;
            let top = e + d; // scaled by it, no square leaves the range
            let (x, y) = (e / top, d / top);
            e * x / (x * x + y * y).sqrt()
        }
        _ => e,
    }
}

/// The error estimate of a pair: ‖h Σ e_j k_j‖ with e = b − b̂.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate<const S: usize> {
    /// The error behaves like h to the power `order + 1`; the order of b̂, where there is one b̂.
    pub order: usize,
    /// e_j = b_j − b̂_j.
    pub e: [f64; S],
    /// A second row d of a lower order (DOP853). With it the error is E²/√(E² + D²/100), where E = ‖h Σ e_j k_j‖ and
    /// D = ‖h Σ d_j k_j‖.
    pub damp: Option<[f64; S]>,
}

impl<const S: usize> ErrorEstimate<S> {
    /// Makes the estimate from both rows of weights; b̂ has the order `order`.
    pub const fn of_pair(order: usize, b: [f64; S], b_hat: [f64; S]) -> Self {
        ErrorEstimate { order, e: difference(b, b_hat), damp: None }
    }

    /// The error from the size of ‖h Σ w_j k_j‖ for each row w.
    #[inline(always)]
    pub(super) fn error<R: Real>(&self, mut size: impl FnMut(&[f64; S]) -> R) -> R {
        let mut sizes = [R::lit(0.0); 2];
        // One call of `size` in the code: with two it would not be put in line.
        for (i, size_of_row) in sizes.iter_mut().enumerate() {
            let row = if i == 0 { Some(&self.e) } else { self.damp.as_ref() };
            let Some(row) = row else { break };
            *size_of_row = size(row);
        }
        fold_error(sizes[0], self.damp.is_some().then_some(sizes[1]))
    }
}

/// x − y.
const fn difference<const S: usize>(x: [f64; S], y: [f64; S]) -> [f64; S] {
    let mut d = [0.0; S];
    let mut j = 0;
    while j < S {
        d[j] = x[j] - y[j];
        j += 1;
    }
    d
}

/// The square matrix with these rows, filled up with zeros.
pub(crate) const fn lower<const S: usize>(rows: [&[f64]; S]) -> [[f64; S]; S] {
    let mut a = [[0.0; S]; S];
    let mut i = 0;
    while i < S {
        let mut j = 0;
        while j < rows[i].len() {
            a[i][j] = rows[i][j];
            j += 1;
        }
        i += 1;
    }
    a
}

/// Euler's method, order 1 (L. Euler, Institutiones calculi integralis I, 1768).
pub const EULER: Tableau<1> = Tableau {
    name: "euler",
    order: 1,
    a: [[0.0]],
    b: [1.0],
    c: [0.0],
    error: None,
    dense: Dense::Cubic { order: 1, end: &[1.0] },
};

/// The explicit midpoint rule, order 2 (C. Runge, Über die numerische Auflösung von Differentialgleichungen, 1895).
pub const MIDPOINT: Tableau<2> = Tableau {
    name: "midpoint",
    order: 2,
    a: [[0.0; 2], [0.5, 0.0]],
    b: [0.0, 1.0],
    c: [0.0, 0.5],
    error: None,
    dense: Dense::Cubic { order: 2, end: &[-1.0, 2.0] },
};

/// Heun's method, the explicit trapezoidal rule, order 2 (K. Heun, Neue Methoden zur approximativen Integration der
/// Differentialgleichungen einer unabhängigen Veränderlichen, 1900).
pub const HEUN: Tableau<2> = Tableau {
    name: "heun",
    order: 2,
    a: [[0.0; 2], [1.0, 0.0]],
    b: [0.5, 0.5],
    c: [0.0, 1.0],
    error: None,
    dense: Dense::Cubic { order: 2, end: &[0.0, 1.0] },
};

/// The classical method of order 4 (Hairer, Nørsett, Wanner I, p. 138).
pub const RK4: Tableau<4> = Tableau {
    name: "rk4",
    order: 4,
    a: [[0.0; 4], [0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
    b: [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    c: [0.0, 0.5, 0.5, 1.0],
    error: None,
    dense: Dense::Cubic { order: 3, end: &[0.0, 0.0, 0.0, 1.0] },
};

/// Kutta's 3/8 rule, order 4 (Hairer, Nørsett, Wanner I, p. 138).
pub const THREE_EIGHTHS: Tableau<4> = Tableau {
    name: "three-eighths",
    order: 4,
    a: [[0.0; 4], [1.0 / 3.0, 0.0, 0.0, 0.0], [-1.0 / 3.0, 1.0, 0.0, 0.0], [1.0, -1.0, 1.0, 0.0]],
    b: [1.0 / 8.0, 3.0 / 8.0, 3.0 / 8.0, 1.0 / 8.0],
    c: [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0],
    error: None,
    dense: Dense::Cubic { order: 3, end: &[0.25, -0.75, 0.75, 0.75] },
};
