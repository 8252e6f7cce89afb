//! Figures as standalone SVG text.

mod body;
mod camera;
mod chart;
mod ellipsoid;
mod heat;
mod labels;
mod scale;
mod scene;
mod series;
mod space;
mod sphere;
pub(crate) mod svg;
pub(crate) mod theme;
mod thin;
mod trace;

pub use body::{Body, Pose};
pub use chart::{Chart, Marks};
pub use heat::{Ground, Heat};
pub use scale::{Axis, Scale};
pub use series::{Marker, Point, Series, tell_apart};
pub use space::Space;
pub use sphere::{Path, Sphere};
pub(crate) use svg::{escape, slug};
pub use theme::LINE_COLOURS;
pub(crate) use theme::for_file;
