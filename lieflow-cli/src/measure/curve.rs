//! A method's line in the plot of time against error.

use serde::Serialize;

use super::Candidate;

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorkPoint {
    /// Its number of steps.
    pub steps: u64,
    /// Its step size.
    pub h: f64,
    /// Relative distance of the final state from the exact one.
    pub error: f64,
    /// Final minus initial energy.
    pub energy_error: f64,
    /// CPU time per unit of simulated time.
    pub seconds_per_unit: f64,
    /// Why the run stopped early, when it did.
    pub failure: Option<String>,
}

/// The runs of one method, from the largest step to the smallest.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The method.
    pub candidate: Candidate,
    /// The order it should have.
    pub order: usize,
    /// The runs.
    pub points: Vec<WorkPoint>,
}

/// Errors outside of this range say nothing of the order: larger ones are not yet asymptotic,
/// smaller ones are rounding.
const ASYMPTOTIC: core::ops::Range<f64> = 1e-10..1e-2;

impl Curve {
    pub(super) fn new(candidate: Candidate, order: usize) -> Self {
        Curve { candidate, order, points: Vec::new() }
    }

    /// The measured order: the slope of the least-squares line through log h, log error.
    pub fn measured_order(&self) -> Option<f64> {
        let used: Vec<(f64, f64)> = self
            .points
            .iter()
            .filter(|p| ASYMPTOTIC.contains(&p.error))
            .map(|p| (p.h.ln(), p.error.ln()))
            .collect();
        let n = used.len() as f64;
        let (x, y) =
            (used.iter().map(|p| p.0).sum::<f64>() / n, used.iter().map(|p| p.1).sum::<f64>() / n);
        let sxx: f64 = used.iter().map(|p| (p.0 - x).powi(2)).sum();
        let sxy: f64 = used.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        (used.len() >= 3).then_some(sxy / sxx)
    }

    /// The time per unit of simulated time at which this error is reached, between two runs by the
    /// line through them in the logarithms; `None` where no run reaches it.
    pub fn seconds_to(&self, error: f64) -> Option<f64> {
        // (log error, log time); no error is smaller than rounding, though a run may hit zero.
        let runs: Vec<(f64, f64)> = self
            .points
            .iter()
            .filter(|p| p.error >= 0.0 && p.seconds_per_unit > 0.0)
            .map(|p| (p.error.max(1e-17).ln(), p.seconds_per_unit.ln()))
            .collect();
        let target = error.ln();
        let reached = runs.iter().position(|(error, _)| *error <= target)?;
        let (e1, t1) = runs[reached];
        let time = match reached.checked_sub(1).map(|before| runs[before]) {
            Some((e0, t0)) => t0 + (e0 - target) / (e0 - e1) * (t1 - t0),
            None => t1, // the coarsest run already does
        };
        Some(time.exp())
    }

    /// CPU time of one step, at the smallest step.
    pub fn seconds_per_step(&self) -> Option<f64> {
        let last = self.points.iter().rev().find(|p| p.seconds_per_unit > 0.0)?;
        Some(last.seconds_per_unit * last.h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Layer;

    /// error = h⁴, time per unit = 1/h.
    fn ideal(hs: &[f64]) -> Curve {
        let mut curve = Curve::new(Candidate::rk4(Layer::Closed), 4);
        curve.points = hs
            .iter()
            .map(|&h| WorkPoint {
                steps: 1,
                h,
                error: h.powi(4),
                energy_error: 0.0,
                seconds_per_unit: 1.0 / h,
                failure: None,
            })
            .collect();
        curve
    }

    #[test]
    fn the_order_of_an_ideal_method() {
        let order = ideal(&[0.2, 0.13, 0.07, 0.05]).measured_order();
        assert!((order.expect("enough points") - 4.0).abs() < 1e-12);
        assert_eq!(ideal(&[0.2, 0.1]).measured_order(), None);
    }

    #[test]
    fn the_time_to_an_error_lies_on_the_line() {
        let curve = ideal(&[0.1, 0.01]);
        let time = curve.seconds_to(1e-6).expect("reached");
        assert!((time - 10f64.powf(1.5)).abs() < 1e-9);
        assert_eq!(curve.seconds_to(1e-9), None);
        assert!((curve.seconds_to(1.0).expect("coarsest") - 10.0).abs() < 1e-12);
    }

    #[test]
    fn an_error_of_zero_reaches_every_error() {
        let mut curve = ideal(&[0.1, 0.01]);
        curve.points[1].error = 0.0;
        let time = curve.seconds_to(1e-12).expect("reached");
        assert!(time > 10.0 && time < 100.0);
    }
}
