//! From the points of a line to the pixels of a drawing.

use super::scale::{Axis, Map, Scale};
use super::series::{Marker, Series};
use super::thin::{thin_path, thin_time_series};

/// A line as it is drawn: runs of pixels without gaps, and the indices of the drawn points.
pub(crate) struct Trace {
    pub(crate) runs: Vec<Vec<(f64, f64)>>,
    pub(crate) points: Vec<usize>,
}

impl Trace {
    /// Places the points of `series`, and thins the line if it has no markers.
    pub(crate) fn new(series: &Series, x: &Map, y: &Map) -> Self {
        let mut result = Trace { runs: vec![Vec::new()], points: Vec::new() };
        for (i, point) in series.points.iter().enumerate() {
            let place = x.pixel(point.x).zip(y.pixel(point.y));
            match place {
                Some(place) => {
                    result.points.push(i);
                    if let Some(run) = result.runs.last_mut() {
                        run.push(place);
                    }
                }
                None => result.runs.push(Vec::new()),
            }
        }
        result.runs.retain(|run| !run.is_empty());
        if series.marker == Marker::None {
            for run in &mut result.runs {
                // A run backward in time, or a path in a plane, need not begin at the left.
                let left = run.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
                let right = run.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
                let pairs = thin_time_series(run, 2 * (right - left).ceil() as usize);
                let pairs: Vec<[f64; 2]> = pairs.into_iter().map(|(x, y)| [x, y]).collect();
                *run = thin_path(&pairs, 0.1).into_iter().map(|[x, y]| (x, y)).collect();
            }
        }
        result
    }
}

/// Why `value` is not drawn, if it is not.
pub(crate) fn omission(axis: &Axis, map: &Map, value: f64) -> Option<String> {
    let quantity = &axis.title;
    match map.pixel(value) {
        Some(_) => None,
        None if value == 0.0 => Some(format!("with {quantity} 0")),
        None if value.is_finite() && value < 0.0 && axis.scale == Scale::Log10 => {
            Some(format!("with negative {quantity}"))
        }
        None if value.is_finite() => Some(format!("with {quantity} too large to draw")),
        None => Some(format!("with {quantity} not finite")),
    }
}
