//! Figures and pages without anything from the network: plain values in, SVG and HTML text out.
//!
//! A figure ([`Chart`], [`Sphere`], [`Space`], [`Heat`]) is a plain value; `svg()` turns it into one complete `<svg>`
//! element, which serves as a file and inline in a [`Page`]. Colours are CSS variables with light
//! fallbacks, so that an inline figure follows the theme of its page. A file that a page writes follows
//! the theme of who looks at it.
//!
//! | room | what is in it |
//! |---|---|
//! | `number` | numbers as text |
//! | `csv` | tables as CSV |
//! | `plot` | figures |
//! | `page` | pages of tables and figures |
//!
//! A room uses those above it in this table only.
#![forbid(unsafe_code)]

pub mod csv;
pub mod number;
mod page;
mod plot;

pub use page::{Block, Cell, Column, Page, Row, Section, Table};
pub use plot::{
    Axis, Body, Chart, Ground, Heat, LINE_COLOURS, Marker, Marks, Path, Point, Pose, Scale, Series,
    Space, Sphere, tell_apart,
};
