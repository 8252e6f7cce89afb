//! The first guess of an implicit step from the steps before it.
//!
//! Steps of equal size have increments D_n that change slowly: D_n = Σ_{q ≤ Q} ∇^q D_{n−1} + ∇^{Q+1}D_n,
//! with backward differences ∇. They are stored up to [`DEPTH`]. Q is the degree whose error ∇^{Q+1} was
//! smallest at the last step.

use super::triangle::{below, below_mut, entries, squares};
use crate::dense::wide;
use crate::groups::ComplexMatrix;
use crate::scalar::{Ops, tally};
use crate::space::{Metric, Numbers};

/// The number of stored differences.
const DEPTH: usize = 8;

/// The differences of the last steps, and the end of the last one.
#[derive(Debug)]
pub(super) struct History {
    differences: [ComplexMatrix; DEPTH],
    norms: [f64; DEPTH],
    steps: usize,
    h: f64,
    last: ComplexMatrix,
    column: Vec<f64>,
}

/// The relation of a step to the history.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Start {
    /// The step continues from the last one.
    Warm,
    /// A step of another size from the same point, or to a point within the last one. The history is not changed.
    Aside,
    /// A new run.
    Cold,
}

impl History {
    pub(super) fn new(n: usize) -> Self {
        History {
            differences: core::array::from_fn(|_| ComplexMatrix::zeros(n, n)),
            norms: [f64::INFINITY; DEPTH],
            steps: 0,
            h: f64::NAN,
            last: ComplexMatrix::zeros(n, n),
            column: vec![0.0; n],
        }
    }

    /// Call `each` with every number.
    pub(super) fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.differences.each_number(each);
        self.norms.each_number(each);
        let mut steps = self.steps as f64;
        each(&mut steps);
        self.steps = steps as usize;
        each(&mut self.h);
        self.last.each_number(each);
    }

    /// The relation of a step of size h from y to the history.
    pub(super) fn start(&self, h: f64, y: &ComplexMatrix) -> Start {
        let same = |j| {
            y.re.col_as_slice(j) == self.last.re.col_as_slice(j)
                && y.im.col_as_slice(j) == self.last.im.col_as_slice(j)
        };
        match (self.steps > 0 && (0..y.ncols()).all(same), h == self.h) {
            (true, true) => Start::Warm,
            (true, false) => Start::Aside,
            (false, _) => Start::Cold,
        }
    }

    /// d ← the guess, on and below the diagonal.
    pub(super) fn guess(&self, d: &mut ComplexMatrix) {
        let known = self.steps.min(DEPTH);
        let degree = (0..known.saturating_sub(1))
            .min_by(|&a, &b| self.norms[a + 1].total_cmp(&self.norms[b + 1]))
            .unwrap_or(0);
        tally(|| Ops::adds(degree * entries(d)));
        wide(d.nrows(), || {
            for (part, out) in d.parts_mut().into_iter().enumerate() {
                for j in 0..out.ncols() {
                    let out = below_mut(out, j);
                    out.fill(0.0);
                    for difference in &self.differences[..=degree] {
                        let terms = below(difference.parts()[part], j);
                        out.iter_mut().zip(terms).for_each(|(o, x)| *o += x);
                    }
                }
            }
        });
    }

    /// d ← θ times the increment of the last step, which has size h, on and below the diagonal; 0 where that is another.
    pub(super) fn guess_within(&self, h: f64, theta: f64, d: &mut ComplexMatrix) {
        let theta = if self.steps > 0 && self.h == h { theta } else { 0.0 };
        let [last, ..] = &self.differences;
        for (out, last) in d.parts_mut().into_iter().zip(last.parts()) {
            for j in 0..out.ncols() {
                let terms = below(last, j);
                below_mut(out, j).iter_mut().zip(terms).for_each(|(d, x)| *d = theta * x);
            }
        }
    }

    /// Records that the step of size h ended at y with the increment d.
    pub(super) fn record(&mut self, start: Start, h: f64, d: &ComplexMatrix, y: &ComplexMatrix) {
        match start {
            Start::Aside => return,
            Start::Cold => self.steps = 0,
            Start::Warm => {}
        }
        let History { differences, norms, column, steps, .. } = self;
        let known = (*steps).min(DEPTH - 1);
        norms.fill(f64::INFINITY);
        norms[..=known].fill(0.0);
        tally(|| (Ops::muladds(1) + Ops::adds(1)) * ((known + 1) * entries(d)));
        wide(d.nrows(), || {
            for (part, d) in d.parts().into_iter().enumerate() {
                for j in 0..d.ncols() {
                    let carry = &mut column[j..];
                    carry.copy_from_slice(below(d, j));
                    for q in 0..=known {
                        let [re, im] = differences[q].parts_mut();
                        let kept = below_mut(if part == 0 { re } else { im }, j);
                        norms[q] += squares(carry);
                        for (kept, x) in kept.iter_mut().zip(carry.iter_mut()) {
                            let old = *kept;
                            *kept = *x;
                            *x -= old;
                        }
                    }
                }
            }
        });
        self.steps += 1;
        self.h = h;
        self.last.assign(y);
    }
}
