//! Actions with one fault each.
#![allow(dead_code, reason = "each suite uses its part")]

use faer::Mat;
use lieflow::actions::LeftTranslation;
use lieflow::groups::{Adjoint, AlgebraMatrix, GroupMatrix, MatrixGroup};
use lieflow::{Action, LieGroup};
use rand_pcg::Pcg64;

use crate::support::points::Points;

/// What is wrong with left translation.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fault {
    /// Λ(g, p) = gᵀp.
    Transposed,
    /// Λ(g, p) = pg.
    Swapped,
    /// λ_*(v)(p) = pv.
    Generator,
}

/// Left translation with a fault.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Translation(pub(crate) Fault);

impl Action<MatrixGroup> for Translation {
    type Point = GroupMatrix;
    type Work = ();
    fn work(&self, _: &MatrixGroup) {}
    fn act(
        &self,
        _: &MatrixGroup,
        g: &GroupMatrix,
        p: &GroupMatrix,
        q: &mut GroupMatrix,
        _: &mut (),
    ) {
        *q = GroupMatrix::new_unchecked(match self.0 {
            Fault::Transposed => g.transpose() * p.as_ref(),
            Fault::Swapped => p.as_ref() * g.as_ref(),
            Fault::Generator => g.as_ref() * p.as_ref(),
        });
    }
    /// Sound where the fault is in Λ: what the equation means does not change with it.
    fn generate(
        &self,
        group: &MatrixGroup,
        v: &AlgebraMatrix,
        p: &GroupMatrix,
        dp: &mut GroupMatrix,
        _: &mut (),
    ) {
        match self.0 {
            Fault::Generator => group.tangent_in_body(p, v, dp),
            _ => group.tangent(v, p, dp),
        }
    }
}

impl Points<MatrixGroup> for Translation {
    fn draw(&self, group: &MatrixGroup, rng: &mut Pcg64) -> GroupMatrix {
        LeftTranslation.draw(group, rng)
    }
    fn numbers(&self, group: &MatrixGroup, p: &GroupMatrix) -> Mat<f64> {
        LeftTranslation.numbers(group, p)
    }
    fn with_numbers(&self, group: &MatrixGroup, x: &Mat<f64>) -> GroupMatrix {
        LeftTranslation.with_numbers(group, x)
    }
    fn generator(&self, group: &MatrixGroup, xi: &Mat<f64>, p: &GroupMatrix) -> Mat<f64> {
        LeftTranslation.generator(group, xi, p)
    }
}

/// g m gᵀ on every group. It is an action; beyond SO(n) it is not the coadjoint one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Congruence;

impl Action<MatrixGroup> for Congruence {
    type Point = Mat<f64>;
    type Work = ();
    fn work(&self, _: &MatrixGroup) {}
    fn act(&self, _: &MatrixGroup, g: &GroupMatrix, p: &Mat<f64>, q: &mut Mat<f64>, _: &mut ()) {
        *q = g.as_ref() * p * g.transpose();
    }
    fn generate(
        &self,
        _: &MatrixGroup,
        v: &AlgebraMatrix,
        p: &Mat<f64>,
        dp: &mut Mat<f64>,
        _: &mut (),
    ) {
        *dp = v.as_ref() * p + p * v.transpose();
    }
}
