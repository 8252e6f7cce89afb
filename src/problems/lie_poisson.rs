//! Lie–Poisson systems with a quadratic Hamiltonian, on the dual of any matrix algebra.
//!
//! ṁ = ad*_ξ m = ξᵀm − mξᵀ, ξ = ∇H(m) = A m ∈ 𝔤, H(m) = ½⟨m, A m⟩ with ⟨m, v⟩ = tr(mᵀv).
//! f(m) = −A m; Λ(g, m) = g⁻ᵀ m gᵀ. Invariants: the spectrum of m on GL(n), the Casimirs of 𝔤, H.
//!
//! m stands for the functional v ↦ tr(mᵀv) on 𝔤, and matrices that differ by one that vanishes on 𝔤
//! stand for the same: A m must not depend on which is taken.

use faer::Mat;

use super::{Ambient, LiePoisson, MomentumSeries, Problem, TaylorField};
use crate::actions::Coadjoint;
use crate::dense::{self, mul, mul_add, scaled_sum};
use crate::groups::{Adjoint, AlgebraMatrix, LieAlgebra, MatrixGroup};

/// The system of a group and of a function that writes ξ = A m. A is linear, takes its values in 𝔤
/// and is symmetric, ⟨m, A n⟩ = ⟨n, A m⟩: the energy is kept by nothing else.
///
/// ```
/// use faer::Mat;
/// use lieflow::groups::{AlgebraMatrix, MatrixGroup};
/// use lieflow::maps::Exp;
/// use lieflow::methods::EnergyCasimir;
/// use lieflow::problems::{LiePoisson, QuadraticLiePoisson};
/// use lieflow::{SaveAt, TimeGrid, integrate};
///
/// // On sl(2) = sp(2): A m = the part of (m₁₁, 2m₁₂, 3m₂₁, m₂₂) in the algebra.
/// let system = QuadraticLiePoisson::new(
///     MatrixGroup::sp(2)?,
///     |m: &Mat<f64>, xi: &mut AlgebraMatrix| {
///         let d = 0.5 * (m[(0, 0)] - m[(1, 1)]);
///         (xi[(0, 0)], xi[(1, 1)]) = (d, -d);
///         (xi[(0, 1)], xi[(1, 0)]) = (2.0 * m[(0, 1)], 3.0 * m[(1, 0)]);
///     },
/// );
/// let mut m = Mat::from_fn(2, 2, |i, j| [[0.3, 0.5], [-0.4, -0.3]][i][j]);
/// let before = system.hamiltonian(&m);
/// let grid = TimeGrid::new([0.0, 10.0], 0.1)?;
/// integrate(&system, &EnergyCasimir::new(Exp), &grid, &SaveAt::Ends, &mut m, |_, _| {})?;
/// assert!((system.hamiltonian(&m) - before).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct QuadraticLiePoisson<A> {
    group: MatrixGroup,
    inertia: A,
    /// Are all u ∈ 𝔤 skew?
    skew: bool,
}

impl<A: Fn(&Mat<f64>, &mut AlgebraMatrix)> QuadraticLiePoisson<A> {
    /// The system.
    pub fn new(group: MatrixGroup, inertia: A) -> Self {
        let skew = group.is_skew();
        QuadraticLiePoisson { group, inertia, skew }
    }
}

/// Scratch: ξ, and the mean of two momenta.
#[derive(Debug)]
pub struct QuadraticWork {
    xi: AlgebraMatrix,
    mean: Mat<f64>,
}

impl<A: Fn(&Mat<f64>, &mut AlgebraMatrix)> Problem for QuadraticLiePoisson<A> {
    type Group = MatrixGroup;
    type Action = Coadjoint;
    type Work = QuadraticWork;

    fn group(&self) -> &MatrixGroup {
        &self.group
    }
    fn action(&self) -> &Coadjoint {
        &Coadjoint
    }
    fn work(&self) -> QuadraticWork {
        let n = self.group.n();
        QuadraticWork { xi: self.group.zero(), mean: Mat::zeros(n, n) }
    }
    fn f(&self, _: f64, m: &Mat<f64>, v: &mut AlgebraMatrix, _: &mut QuadraticWork) {
        (self.inertia)(m, v);
        **v *= faer::Scale(-1.0);
    }
}

impl<A: Fn(&Mat<f64>, &mut AlgebraMatrix)> Ambient for QuadraticLiePoisson<A> {
    fn field(&self, _: f64, m: &Mat<f64>, dm: &mut Mat<f64>, work: &mut QuadraticWork) {
        (self.inertia)(m, &mut work.xi);
        mul(dm, work.xi.transpose(), m.as_ref());
        mul_add(dm, -1.0, m.as_ref(), work.xi.transpose());
    }
    fn copy(&self, x: &Mat<f64>, y: &mut Mat<f64>) {
        y.copy_from(x);
    }
    fn add(&self, a: f64, x: &Mat<f64>, y: &mut Mat<f64>) {
        dense::axpy(a, x, y);
    }
    fn is_finite(&self, m: &Mat<f64>) -> bool {
        dense::is_finite(m)
    }
}

/// Allocates in [`hamiltonian`](LiePoisson::hamiltonian).
impl<A: Fn(&Mat<f64>, &mut AlgebraMatrix)> LiePoisson for QuadraticLiePoisson<A> {
    fn hamiltonian(&self, m: &Mat<f64>) -> f64 {
        let mut xi = self.group.zero();
        (self.inertia)(m, &mut xi);
        0.5 * self.group.pair(m, &xi)
    }
    fn discrete_gradient(
        &self,
        a: &Mat<f64>,
        b: &Mat<f64>,
        xi: &mut AlgebraMatrix,
        work: &mut QuadraticWork,
    ) {
        scaled_sum(&mut work.mean, [0.5, 0.5], [a, b], 0.0);
        (self.inertia)(&work.mean, xi);
    }
}

impl<A: Fn(&Mat<f64>, &mut AlgebraMatrix)> TaylorField for QuadraticLiePoisson<A> {
    type Series = MomentumSeries;

    fn series(&self, order: usize) -> MomentumSeries {
        MomentumSeries::new(self.group.n(), self.skew, order)
    }
    fn coefficient(
        &self,
        [_, h]: [f64; 2],
        y: &Mat<f64>,
        k: usize,
        f: &mut [AlgebraMatrix],
        series: &mut MomentumSeries,
    ) {
        if k == 0 {
            series.start().copy_from(y);
        }
        (self.inertia)(series.next(h, k, f), &mut f[k]);
        *f[k] *= faer::Scale(-1.0);
    }
}
