//! The laws that every group, map and action keeps. Each takes its own random case.

mod action;
mod algebra;
mod group;
pub(crate) mod map;
mod sampling;

pub(crate) use action::{
    action, coadjoint_pairing, coadjoint_spectrum, generator, generator_of_matrices, lambda,
};
pub(crate) use algebra::algebra;
pub(crate) use group::group;
pub(crate) use map::{map, one_parameter};
pub(crate) use sampling::{gaussian_algebra, haar};

use faer::Mat;

use super::represent::Represent;
use super::{EPS, Verdict, scale, within};

/// ‖uᵀM + Mu‖ ≤ c·ε·‖M‖·`size`: is u in the algebra?
fn in_algebra<G: Represent>(claim: &str, group: &G, u: &G::Alg, c: f64, size: f64) -> Verdict {
    let Some(m) = group.bilinear() else { return Ok(()) };
    let u = group.algebra_matrix(u);
    let residual = (u.transpose() * &m + &m * &u).norm_l2();
    within(claim, residual, c * EPS * m.norm_l2() * size)
}

/// ‖gᵀMg − M‖ ≤ c·ε·‖M‖·max(1, ‖g‖²): is g on the group?
fn on_group<G: Represent>(claim: &str, group: &G, g: &G::Elem, c: f64) -> Verdict {
    let Some(m) = group.bilinear() else { return Ok(()) };
    let x = group.element_matrix(g);
    let defect = x.transpose() * &m * &x - &m;
    let bound = c * EPS * m.norm_l2() * x.norm_l2().powi(2).max(1.0);
    within(claim, defect.norm_l2(), bound)?;
    let gap = (group.defect(g) - defect.norm_l2()).abs();
    within("defect(g) = ‖gᵀMg − M‖", gap, bound)
}

/// a·b − b·a.
fn commutator(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    a * b - b * a
}
