//! Order from errors on a grid fixed in advance.

use lieflow::tolerance::{Rule, Tolerance};

/// Each slope may differ from the order by so much.
const TOLERANCE: f64 = 0.15;

/// Errors outside this window are not asymptotic yet, or rounding already.
const WINDOW: core::ops::Range<f64> = 1e-11..1e-3;
/// So many slopes are required, the last ones in the window.
pub(super) const SLOPES: usize = 3;

/// Numbers of steps for a method that claims order p, the same for every problem. Ratios 1.4 and
/// 1.43, not 2: an estimator that assumes halving would misread them.
pub(crate) fn grid(order: usize) -> [u64; 7] {
    let coarsest = match order {
        0 | 1 => 1280,
        2 => 160,
        3 => 80,
        _ => 20,
    };
    [10, 14, 20, 28, 40, 56, 80].map(|n| n * coarsest / 10)
}

/// What was measured.
#[derive(Clone, Debug)]
pub(crate) struct Estimate {
    /// The slopes of the last pairs of points.
    pub(crate) slopes: Vec<f64>,
    /// The order that was claimed.
    pub(crate) claimed: usize,
    /// Was the second term of the error taken out?
    pub(crate) two_terms: bool,
}

impl Estimate {
    pub(super) fn new(claimed: usize, slopes: Vec<f64>) -> Self {
        Estimate { slopes, claimed, two_terms: false }
    }
    pub(super) fn of_two_terms(self) -> Self {
        Estimate { two_terms: true, ..self }
    }

    /// The last slope.
    pub(crate) fn order(&self) -> f64 {
        self.slopes.last().copied().unwrap_or(f64::NAN)
    }

    /// Each of the last slopes lies within [`TOLERANCE`] of the claimed order.
    ///
    /// # Errors
    /// The slopes, when one does not.
    pub(crate) fn check(&self) -> super::super::Verdict {
        let near = |s: &f64| (s - self.claimed as f64).abs() <= TOLERANCE;
        match self.slopes.len() >= SLOPES && self.slopes.iter().all(near) {
            true => Ok(()),
            false => Err(format!("order {} claimed, slopes {:.2?}", self.claimed, self.slopes)),
        }
    }
}

/// The slopes log(e_i/e_{i+1})/log(h_i/h_{i+1}) of the last points in the window.
///
/// # Errors
/// Too few points with an error in the window.
pub(crate) fn estimate(claimed: usize, steps: &[u64], errors: &[f64]) -> Result<Estimate, String> {
    let points: Vec<(f64, f64)> = (steps.iter().map(|&n| n as f64).zip(errors.iter().copied()))
        .filter(|(_, e)| WINDOW.contains(e))
        .collect();
    if points.len() <= SLOPES {
        let seen: Vec<String> = errors.iter().map(|e| format!("{e:.1e}")).collect();
        return Err(format!("too few errors within {WINDOW:?}: {}", seen.join(", ")));
    }
    Ok(Estimate::new(claimed, pairwise(&points[points.len() - SLOPES - 1..])))
}

/// The slopes between neighbours of points (steps, error).
pub(super) fn pairwise(points: &[(f64, f64)]) -> Vec<f64> {
    let slope = |pair: &[(f64, f64)]| (pair[0].1 / pair[1].1).ln() / (pair[1].0 / pair[0].0).ln();
    points.windows(2).map(slope).collect()
}

/// The pairwise slopes of errors at these numbers of steps.
pub(crate) fn slopes(steps: &[f64], errors: &[f64]) -> Vec<f64> {
    pairwise(&steps.iter().copied().zip(errors.iter().copied()).collect::<Vec<_>>())
}

/// Tolerances by which the ratio that a step returns is the norm of its error.
pub(crate) fn in_units_of_one() -> Tolerance {
    Tolerance::new(0.0, 1.0).expect("tolerances").by(Rule::PerLength)
}
