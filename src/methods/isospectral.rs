//! Isospectral symplectic Runge–Kutta methods on so(n).
//!
//! Ẇ = \[B(W), W\], B(W) ∈ so(n). With a Gauss tableau (a, b):
//! Q_i = 𝟙 + h Σ_j a_ij B_j Q_j, B_j = B(W̃_j), W̃_j = Q_j W Q_jᵀ;
//! Q⁺ = 𝟙 + h Σ_i b_i B_i Q_i, W⁺ = Q⁺ W Q⁺ᵀ.
//!
//! Q⁺ is orthogonal, because the Gauss methods keep quadratic invariants: the spectrum of W (every
//! Casimir) is kept to rounding. Order 2S, symmetric and Lie–Poisson symplectic: the energy error
//! stays bounded. The stages are found by fixed-point iteration, which converges while h‖B‖ and h
//! times the Lipschitz constant of W ↦ B(W) stay below about 1. Cost: 3S products an iteration, 8 to
//! 25 iterations. S = 1 is the isospectral midpoint rule.
//! Source: K. Modin & M. Viviani, Lie–Poisson methods for isospectral flows, Found. Comput. Math. 20
//! (2020).

use faer::Mat;

use super::gauss::ImplicitTableau;
use super::newton::Progress;
use super::{Method, Step, Symmetric};
use crate::dense::{axpy, is_finite, mul, norm_frobenius};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, LieAlgebra};
use crate::problems::{Isospectral, Problem};

/// An isospectral method on a Gauss tableau.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsospectralGauss<const S: usize>(pub ImplicitTableau<S>);

impl<const S: usize> Symmetric for IsospectralGauss<S> {}

/// Stages and scratch.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct IsospectralWork<P: Problem, const S: usize> {
    q: [Mat<f64>; S],
    /// B_i Q_i.
    slope: [Mat<f64>; S],
    b: AlgebraMatrix,
    half: Mat<f64>,
    w: Mat<f64>,
    field: P::Work,
}

/// out ← 𝟙 + h Σ c_j x_j.
fn stage<const S: usize>(h: f64, c: &[f64; S], x: &[Mat<f64>; S], out: &mut Mat<f64>) {
    out.fill(0.0);
    for (c, x) in c.iter().zip(x) {
        axpy(h * c, x, out);
    }
    for i in 0..out.nrows() {
        out[(i, i)] += 1.0;
    }
}

/// out ← the skew part of q w qᵀ, which is all of it but rounding.
fn conjugate(q: &Mat<f64>, w: &Mat<f64>, half: &mut Mat<f64>, out: &mut Mat<f64>) {
    mul(half, q.as_ref(), w.as_ref());
    mul(out, half.as_ref(), q.transpose());
    for j in 0..out.ncols() {
        out[(j, j)] = 0.0;
        for i in j + 1..out.nrows() {
            let x = 0.5 * (out[(i, j)] - out[(j, i)]);
            (out[(i, j)], out[(j, i)]) = (x, -x);
        }
    }
}

impl<P: Isospectral, const S: usize> Method<P> for IsospectralGauss<S> {
    type Work = IsospectralWork<P, S>;

    fn order(&self, _: &P) -> usize {
        self.0.order
    }
    /// Also [`Error::Unsupported`] on a group other than SO(n).
    fn work(&self, problem: &P, _: &Mat<f64>) -> Result<Self::Work, Error> {
        let group = problem.group();
        if !matches!(group.form(), Form::Identity) {
            return Err(Error::Unsupported {
                what: "isospectral",
                with: group.name(),
                why: "it is built for SO(n); use `energy-casimir`",
            });
        }
        let zero = || Mat::zeros(group.n(), group.n());
        Ok(IsospectralWork {
            q: core::array::from_fn(|_| zero()),
            slope: core::array::from_fn(|_| zero()),
            b: group.zero(),
            half: zero(),
            w: zero(),
            field: problem.work(),
        })
    }
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<f64>,
        y: &mut Mat<f64>,
        IsospectralWork { q, slope, b, half, w, field }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let tab = &self.0;
        problem.generator(y, b, field);
        if !is_finite(b) {
            return Err(StepError::NonFiniteRhs { stage: 1 });
        }
        slope.iter_mut().for_each(|s| s.copy_from(&**b));
        for i in 0..S {
            stage(h, &tab.a[i], slope, &mut q[i]);
        }
        let scale = (y.nrows() as f64).sqrt(); // ‖𝟙‖
        let mut progress = Progress::new();
        loop {
            let mut change = 0.0;
            for i in 0..S {
                conjugate(&q[i], y, half, w);
                problem.generator(w, b, field);
                mul(half, b.as_ref(), q[i].as_ref());
                core::mem::swap(half, &mut slope[i]);
                stage(h, &tab.a[i], slope, half);
                core::mem::swap(half, &mut q[i]);
                axpy(-1.0, &q[i], half);
                change += norm_frobenius(half);
            }
            if progress.done("isospectral", change / scale)? {
                break;
            }
        }
        stage(h, &tab.b, slope, &mut q[0]);
        conjugate(&q[0], y, half, w);
        if !is_finite(w) {
            return Err(StepError::NotFinite { what: "the state" });
        }
        core::mem::swap(y, w);
        Ok(())
    }
}
