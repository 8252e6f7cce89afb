//! Measured curves as figures, tables and files.

mod answer;
mod best;
mod choice;
pub mod json;
mod kept;
mod speed;

pub use answer::{Answer, Found, ranking};
pub use best::{Best, Looks};
pub use choice::{
    ADVICE, Choice, Cost, KEPT, choice_table, choices, front_chart, fronts, keeps_energy, on_front,
    steps,
};
pub use kept::kept_table;
pub use speed::{above_order, maps_chart, speed_chart, speed_table, write_speed_csv};

use lieflow_figures::Cell;
use lieflow_figures::number::{DASH, sig, typed};
use lieflow_timing::machine;

use crate::measure::{Reached, Size, WorkPoint};

/// How many times faster, as `3.2×`.
pub fn times(ratio: f64) -> String {
    format!("{}×", sig(ratio, 2))
}

/// The digits of a step.
const DIGITS: usize = 3;

/// The step or the tolerance, as a scene has it: `dt = 0.8`.
fn step_of(reached: &Reached) -> String {
    match reached.tolerance {
        None => format!("dt = {}", typed(reached.length / reached.steps as f64, DIGITS)),
        Some(rtol) => format!("rtol = {}", typed(rtol, DIGITS)),
    }
}

/// The size of a run's steps, for a reader.
fn size_of(point: &WorkPoint) -> String {
    match point.size {
        Size::Steps(steps) => format!("dt = {}, {steps} steps", typed(point.h, DIGITS)),
        Size::Tolerance(rtol) => {
            format!(
                "rtol = {}, {} steps, {} rejected",
                typed(rtol, DIGITS),
                point.steps,
                point.rejected
            )
        }
    }
}

/// A number in a table; a dash for none.
fn number(x: f64, show: impl FnOnce(f64) -> String) -> Cell {
    if x.is_nan() { DASH.into() } else { Cell::number(x, show) }
}

/// On which machine and how times are measured, as facts of a page.
pub fn conditions(rounds: u32) -> [(String, String); 2] {
    let how = format!(
        "CPU time of one thread, medians of {rounds} rounds that visit every method in turn"
    );
    [("Machine".into(), machine()), ("Times".into(), how)]
}
