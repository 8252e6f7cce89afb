//! The order conditions of a tableau, over all rooted trees: Σ_i b_i Φ_i(τ) = 1/γ(τ) for every tree τ with at most p nodes.
//!
//! Source: J. C. Butcher; Hairer, Nørsett, Wanner I, II.2.

use super::trees::trees;
use super::{Dense, ErrorEstimate, Tableau};
use crate::error::Error;

/// How far weights b with stages a are from the order conditions: the worst |Σ b_i Φ_i(τ) − 1/γ(τ)| over the trees with
/// 1, 2, … `max` nodes, relative to the largest |b_i Φ_i(τ)|, at least 1. Cost: S² for each tree; there are 200 trees of 8
/// nodes or fewer.
pub fn order_defects<const S: usize>(max: usize, a: &[[f64; S]; S], b: &[f64; S]) -> Vec<f64> {
    let mut weights: Vec<[f64; S]> = Vec::new();
    let mut worst = vec![0.0f64; max];
    for tree in trees(max) {
        let mut phi = [1.0; S];
        for &child in &tree.under {
            for i in 0..S {
                phi[i] *= (0..S).map(|j| a[i][j] * weights[child][j]).sum::<f64>();
            }
        }
        let (mut sum, mut size) = (0.0, 1.0f64);
        for i in 0..S {
            sum += b[i] * phi[i];
            size = size.max((b[i] * phi[i]).abs());
        }
        weights.push(phi);
        let worst = &mut worst[tree.nodes - 1];
        let defect = (sum - 1.0 / tree.density).abs() / size;
        *worst = if defect.is_nan() { f64::INFINITY } else { worst.max(defect) };
    }
    worst
}

/// The order of weights b with stages a, at most `max`: the conditions hold up to it, to rounding of the coefficients.
pub fn order_of<const S: usize>(max: usize, a: &[[f64; S]; S], b: &[f64; S]) -> usize {
    // S² products of a size that the defect is relative to.
    let tolerance = 8.0 * f64::EPSILON * (S * S) as f64;
    order_defects(max, a, b).iter().take_while(|defect| **defect <= tolerance).count()
}

impl<const S: usize> Tableau<S> {
    /// Checks that the tableau is explicit, that c_i = Σ_j a_ij and Σ_j b_j = 1, that it has the order that it states, and that
    /// the weights of its error estimate and of its dense output fit.
    ///
    /// A build of lieflow with `debug-assertions` checks every tableau before a run. Another build leaves the order out:
    /// a release, or a profile that switches `debug-assertions` off for dependencies.
    ///
    /// ```
    /// use lieflow::methods::tableau::{RK4, Tableau};
    /// let wrong = Tableau { b: [0.5, 0.0, 0.0, 0.5], ..RK4 };
    /// assert!(wrong.check().unwrap_err().to_string().starts_with("order of the tableau `rk4` = 4"));
    /// ```
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the entry, or with the order.
    pub fn check(&self) -> Result<(), Error> {
        self.check_sums()?;
        match order_of(self.order, &self.a, &self.b) {
            held if held < self.order => {
                let expected = format!("at most {held}: a condition of order {} fails", held + 1);
                Err(Error::out_of_range(self.named("order"), self.order as f64, expected))
            }
            _ => self.check_estimate_order(),
        }
    }

    /// Checks that b̂ = b − e has the order that the estimate states. A damped estimate has two rows, and an order of both.
    fn check_estimate_order(&self) -> Result<(), Error> {
        let Some(ErrorEstimate { order, e, damp: None }) = self.error else { return Ok(()) };
        let b_hat: [f64; S] = core::array::from_fn(|j| self.b[j] - e[j]);
        match order_of(order, &self.a, &b_hat) {
            held if held < order => {
                let expected =
                    format!("at most {held}: b − e fails a condition of order {}", held + 1);
                Err(Error::out_of_range(self.named("error.order"), order as f64, expected))
            }
            _ => Ok(()),
        }
    }

    /// Checks what costs little before a run: that the tableau is explicit, the sums of its rows, and in a debug build its
    /// order.
    pub(crate) fn check_before_run(&self) -> Result<(), Error> {
        if cfg!(debug_assertions) { self.check() } else { self.check_sums() }
    }

    fn check_sums(&self) -> Result<(), Error> {
        for (i, row) in self.a.iter().enumerate() {
            for (j, &x) in row.iter().enumerate().skip(i) {
                if x != 0.0 {
                    let entry = self.named(&format!("a[{},{}]", i + 1, j + 1));
                    return Err(Error::out_of_range(entry, x, "0: a tableau is explicit"));
                }
            }
            if let Some(sum) = differs(row, self.c[i]) {
                let expected = format!("Σ a[{},j] = {sum}", i + 1);
                let entry = self.named(&format!("c[{}]", i + 1));
                return Err(Error::out_of_range(entry, self.c[i], expected));
            }
        }
        if let Some(sum) = differs(&self.b, 1.0) {
            return Err(Error::out_of_range(self.named("Σ b[j]"), sum, "1"));
        }
        if let Some(ErrorEstimate { e, damp, .. }) = &self.error {
            for (row, name) in [(Some(e), "error.e"), (damp.as_ref(), "error.damp")] {
                let Some(row) = row else { continue };
                if let Some(sum) = differs(row, 0.0) {
                    return Err(Error::out_of_range(self.named(&format!("Σ {name}[j]")), sum, "0"));
                }
                if row.iter().all(|x| *x == 0.0) {
                    let expected = "weights that are not all 0: each step would have no error";
                    return Err(Error::out_of_range(self.named(name), 0.0, expected));
                }
            }
        }
        if let Dense::Cubic { end, .. } = self.dense {
            if end.len() > S {
                let expected = format!("at most {S} weights, one for each stage");
                return Err(Error::out_of_range(
                    self.named("dense.end"),
                    end.len() as f64,
                    expected,
                ));
            }
            if let Some(sum) = differs(end, 1.0) {
                return Err(Error::out_of_range(self.named("Σ dense.end[j]"), sum, "1"));
            }
        }
        Ok(())
    }

    fn named(&self, entry: &str) -> String {
        format!("{entry} of the tableau `{}`", self.name)
    }
}

/// The sum of a row, if it is not `expected` to rounding.
fn differs(row: &[f64], expected: f64) -> Option<f64> {
    let (sum, size) = row.iter().fold((0.0, 1.0_f64), |(sum, size), x| (sum + x, size + x.abs()));
    let off = (sum - expected).abs();
    (off.is_nan() || off > 4.0 * f64::EPSILON * size).then_some(sum)
}
