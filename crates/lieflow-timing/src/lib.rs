//! What speed is measured with: the CPU time of a thread, medians, and the line of least squares.
#![forbid(unsafe_code)]

mod clock;
mod fit;

pub use clock::{cpu_seconds, machine, seconds_of};
pub use fit::Fit;

/// The larger of a and b; NaN if one of them is NaN.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// The median; not a number where there are no values. Sorts the values.
///
/// ```
/// assert_eq!(lieflow_timing::median(&mut [3.0, 1.0, 2.0]), 2.0);
/// assert!(lieflow_timing::median(&mut []).is_nan());
/// ```
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
