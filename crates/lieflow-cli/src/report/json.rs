//! A comparison as JSON.

use serde_json::{Value, json};

use super::{Answer, Choice, Found, fronts};
use crate::measure::{Curve, Reached};

/// The methods with their runs. `pareto` has the places of the points that no other run beats.
pub fn curves(curves: &[Curve]) -> Value {
    let fronts = fronts(curves);
    let curve = |(curve, pareto): (&Curve, Vec<usize>)| {
        let method = &curve.candidate.method;
        json!({
            "method": method.name,
            "map": method.map,
            "tableau": method.tableau,
            "layer": curve.candidate.layer.name(),
            "adaptive": curve.candidate.adaptive,
            "order": curve.order,
            "measured_order": curve.measured_order(),
            "pareto": pareto,
            "points": curve.points,
        })
    };
    curves.iter().zip(fronts).map(curve).collect()
}

/// A method where it reaches an error. The times are without rows of output.
fn found((curve, Reached { h, steps, tolerance, seconds, off_manifold, .. }): Found<'_>) -> Value {
    json!({
        "method": curve.candidate.label(),
        "h": h,
        "steps": steps,
        "rtol": tolerance,
        "seconds_per_unit": seconds,
        "off_manifold": off_manifold,
    })
}

/// An answer with the fastest method, the fastest of another kind, and the fastest that leaves M if it is faster.
pub fn answer(answer: &Answer<'_>) -> Value {
    json!({
        "error": answer.error,
        "in_words": answer.in_words(),
        "best": answer.best().map(found),
        "next": answer.next().map(found),
        "leaving": answer.leaving().map(found),
    })
}

/// The fastest method to each error.
pub fn choices(choices: &[Choice<'_>]) -> Value {
    let choice = |choice: &Choice<'_>| {
        let (curve, reached) = choice.best.unzip();
        json!({
            "error": choice.error,
            "method": curve.map(|curve| curve.candidate.label()),
            "h": reached.map(|reached| reached.h),
            "rtol": reached.and_then(|reached| reached.tolerance),
            "seconds_per_unit": reached.map(|reached| reached.seconds),
        })
    };
    choices.iter().map(choice).collect()
}
