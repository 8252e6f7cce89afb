//! Measurements as figures, tables and files.

mod agreement;
mod choice;
mod energy;
mod kept;
mod maps;
mod speed;

pub use agreement::agreement;
pub use choice::{
    ADVICE, CHOICE_HEADER, Choice, Cost, KEPT, choice_cells, choice_table, choices, front_chart,
    fronts, keeps_energy, steps,
};
pub use energy::{EnergyRun, energy_chart, momentum_sphere};
pub use kept::kept_table;
pub use maps::{MAPS_PAGE, write_maps};
pub use speed::{SpeedRow, speed_chart, speed_csv, speed_table, tolerance_header};

use std::path::{Path, PathBuf};

use crate::cmd::CliError;
use crate::output;
use lieflow_figures::page::{Block, Page};
use lieflow_figures::plot::format::sig;
use lieflow_figures::plot::slug;

/// A number in scientific notation with two digits after the point, as `1.23e-4`; a dash for none.
pub fn scientific(x: f64) -> String {
    if x.is_nan() { "–".into() } else { format!("{x:.2e}") }
}

/// A duration in people's units; a dash for none.
pub fn duration(seconds: Option<f64>) -> String {
    seconds.map_or_else(|| "–".into(), lieflow_figures::plot::format::seconds)
}

/// A measured order with two decimals; a dash where too few runs are asymptotic.
pub fn order(order: Option<f64>) -> String {
    order.map_or_else(|| "–".into(), |order| format!("{order:.2}"))
}

/// How many times faster, as `3.2×`.
pub fn times(ratio: f64) -> String {
    format!("{}×", sig(ratio, 2))
}

/// Write a page as `index.html` with its figures as SVG files beside it; the path of the page.
///
/// # Errors
/// A file cannot be written.
pub fn write_page(folder: &Path, page: &Page) -> Result<PathBuf, CliError> {
    write_page_as(folder, "index.html", page)
}

/// Write a page under this name with its figures as SVG files beside it; the path of the page.
///
/// # Errors
/// A file cannot be written.
pub fn write_page_as(folder: &Path, name: &str, page: &Page) -> Result<PathBuf, CliError> {
    output::make_folder(folder)?;
    for block in page.sections.iter().flat_map(|section| &section.blocks) {
        write_figures(folder, block)?;
    }
    let path = folder.join(name);
    output::write_file(&path, &page.html())?;
    Ok(path)
}

fn write_figures(folder: &Path, block: &Block) -> Result<(), CliError> {
    match block {
        Block::Chart(chart) => {
            output::write_file(&folder.join(format!("{}.svg", slug(&chart.id))), &chart.svg())
        }
        Block::Sphere(sphere) => {
            output::write_file(&folder.join(format!("{}.svg", slug(&sphere.id))), &sphere.svg())
        }
        Block::Heat(heat) => {
            output::write_file(&folder.join(format!("{}.svg", heat.id)), &heat.svg())
        }
        Block::Row(blocks) | Block::Details { blocks, .. } => {
            blocks.iter().try_for_each(|block| write_figures(folder, block))
        }
        _ => Ok(()),
    }
}
