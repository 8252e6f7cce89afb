//! The Taylor coefficients of the free n-dimensional rigid body.

use faer::Mat;

use super::{RigidBodyN, RigidBodyNAttitude};
use crate::dense::mul;
use crate::groups::{AlgebraMatrix, GroupMatrix, LieAlgebra};
use crate::problems::{MomentumSeries, Problem, TaylorField};

/// f = −Ω(m).
impl TaylorField for RigidBodyN {
    type Series = MomentumSeries;

    fn series(&self, order: usize) -> MomentumSeries {
        MomentumSeries::new(self.group().n(), true, order)
    }
    fn coefficient(
        &self,
        [_, h]: [f64; 2],
        m: &Mat<f64>,
        k: usize,
        f: &mut [AlgebraMatrix],
        series: &mut MomentumSeries,
    ) {
        if k == 0 {
            series.start().copy_from(m);
        }
        let m = series.next(h, k, f);
        self.omega(-1.0, m, &mut f[k]);
    }
}

/// The coefficients of the body momentum and of −Ω.
#[derive(Clone, Debug)]
pub struct AttitudeSeries {
    momentum: MomentumSeries,
    turn: Vec<AlgebraMatrix>,
    half: Mat<f64>,
}

/// g(t + θh) = Ψ g with Ψ' = Ψ·gΩgᵀ. Ω is in the frame of the body; g at the start turns it to space.
impl TaylorField for RigidBodyNAttitude {
    const MOVING: bool = true;
    type Series = AttitudeSeries;

    fn series(&self, order: usize) -> AttitudeSeries {
        let group = self.group();
        let half = Mat::zeros(group.n(), group.n());
        let momentum = MomentumSeries::new(group.n(), true, order);
        AttitudeSeries { momentum, turn: vec![group.zero(); order + 1], half }
    }
    fn coefficient(
        &self,
        [_, h]: [f64; 2],
        g: &GroupMatrix,
        k: usize,
        f: &mut [AlgebraMatrix],
        AttitudeSeries { momentum, turn, half }: &mut AttitudeSeries,
    ) {
        if k == 0 {
            mul(half, g.transpose(), self.momentum_space().as_ref());
            mul(momentum.start(), half.as_ref(), g.as_ref());
        }
        let m = momentum.next(h, k, turn);
        self.body().omega(1.0, m, &mut f[k]);
        mul(half, g.as_ref(), f[k].as_ref());
        self.body().omega(-1.0, m, &mut turn[k]);
        mul(&mut f[k], half.as_ref(), g.transpose());
    }
}
