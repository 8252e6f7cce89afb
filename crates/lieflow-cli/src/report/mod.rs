//! Measured curves as figures, tables and files.

mod choice;
mod kept;
mod speed;

pub use choice::{
    ADVICE, CHOICE_HEADER, Choice, Cost, KEPT, choice_cells, choice_table, choices, front_chart,
    fronts, keeps_energy, steps,
};
pub use kept::kept_table;
pub use speed::{speed_chart, speed_table, write_speed_csv};

use lieflow_figures::number::sig;
use lieflow_figures::{Page, Section};

use crate::measure::machine;

/// How many times faster, as `3.2×`.
pub fn times(ratio: f64) -> String {
    format!("{}×", sig(ratio, 2))
}

/// On which machine and how times are measured, as facts of a page.
pub fn conditions(rounds: u32) -> [(String, String); 2] {
    let how = format!(
        "CPU time of one thread, medians of {rounds} rounds that visit every method in turn"
    );
    [("Machine".into(), machine()), ("Times".into(), how)]
}

/// A page with the version of the program at its foot.
pub fn page(title: impl Into<String>, subtitle: impl Into<String>, sections: Vec<Section>) -> Page {
    let footer = format!("lieflow {}", env!("CARGO_PKG_VERSION"));
    Page { title: title.into(), subtitle: subtitle.into(), links: Vec::new(), sections, footer }
}
