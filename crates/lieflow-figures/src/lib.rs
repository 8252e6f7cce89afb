//! Figures and pages without anything from the network: plain values in, SVG and HTML text out.
//!
//! [`plot`] has charts, spheres and maps of fields; [`page`] has pages that hold them.
#![forbid(unsafe_code)]

pub mod page;
pub mod plot;
