//! Figures as standalone SVG text: line charts ([`Chart`]), the momentum sphere of a rigid body
//! ([`Sphere`]), fields on surfaces ([`Heat`]).
//!
//! A figure is a plain value; `svg()` turns it into one complete `<svg>` element that serves both
//! as a file of its own and inline in a page. Colours are CSS variables with light fallbacks (see
//! [`theme`]), so an inline figure follows the theme of its page and a file is light.

mod camera;
mod chart;
mod ellipsoid;
pub mod format;
mod heat;
mod labels;
mod scale;
mod scene;
mod series;
mod sphere;
pub(crate) mod svg;
pub mod theme;
mod thin;
mod trace;

pub use chart::Chart;
pub use heat::{Ground, Heat};
pub use scale::{Axis, Scale};
pub use series::{Marker, Point, Series, tell_apart};
pub use sphere::{Path, Sphere};
pub use svg::{escape, slug};
pub use thin::{thin_path, thin_time_series};
