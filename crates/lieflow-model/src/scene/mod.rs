//! Scenes: a problem, a method, a time span and what to write, as a TOML file.

mod brackets;
mod bundled;
mod columns;
mod defaults;
mod degrees;
mod document;
mod error;
mod events;
mod files;
mod keys;
mod losses;
mod open;
mod plot;
mod run;
mod set;
mod units;

pub use bundled::{BUNDLED, Bundled};
pub use columns::{Columns, OnRows, RowFormula};
pub use defaults::{Defaults, tolerances as default_tolerances};
pub use error::SceneError;
pub use events::SceneEvent;
pub use keys::beside_fixed_steps;
pub use open::unknown_scene;
pub use plot::PlotFigure;
pub use run::Scene;
