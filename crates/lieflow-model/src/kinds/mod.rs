//! The kinds of problems that scene files can name.
//!
//! To add a kind: one file with its keys and its `System`, and its entry in [`KINDS`].

mod algebra;
mod beam_line;
mod body;
mod composed;
mod driven_body;
mod entries;
mod euler;
mod fluid;
mod heavy_top;
mod hill;
mod isospectral;
mod kirchhoff;
mod lorentz;
mod lyapunov;
mod matrix_ode;
mod oja;
mod on_m;
pub mod own;
mod pendulum;
mod prelude;
mod quantum;
mod riccati;
mod rigid_bodies;
mod rigid_body;
mod rigid_body_n;
mod rigid_motion;
mod spin;
mod spin_chain;
mod subspace;

pub use body::RigidBodySpec;

use lieflow::Error;
use lieflow::names::same;

use crate::problem::Kind;

/// Every kind.
pub static KINDS: &[Kind] = &[
    rigid_body::KIND,
    driven_body::KIND,
    rigid_bodies::KIND,
    rigid_body_n::KIND,
    heavy_top::KIND,
    kirchhoff::KIND,
    euler::KIND,
    fluid::KIND,
    rigid_motion::KIND,
    pendulum::KIND,
    spin::KIND,
    spin_chain::KIND,
    isospectral::TODA,
    isospectral::DOUBLE_BRACKET,
    isospectral::QR_FLOW,
    oja::KIND,
    subspace::KIND,
    hill::MATHIEU,
    hill::HILL,
    beam_line::KIND,
    riccati::KIND,
    lorentz::KIND,
    quantum::SCHRODINGER,
    quantum::DENSITY_MATRIX,
    matrix_ode::KIND,
    lyapunov::KIND,
    composed::KIND,
];

/// The kind of that name.
///
/// # Errors
/// [`Error::UnknownName`].
pub fn named(name: &str) -> Result<&'static Kind, Error> {
    KINDS.iter().find(|kind| same(kind.name, name)).ok_or_else(|| Error::UnknownName {
        kind: "kind of problem",
        name: name.into(),
        expected: KINDS.iter().map(|kind| kind.name).collect(),
    })
}
