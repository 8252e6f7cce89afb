//! The invariants of the free rigid bodies by name, and Manakov's further integrals.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use super::{
    BodyState, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude, RigidBodyState,
};
use crate::dense::mul;
use crate::groups::GroupMatrix;
use crate::problems::{Invariant, Invariants, Problem};
use crate::scalar::Real;

fn squares<S: Real>(m: &Vector3<S>) -> S {
    m[0] * m[0] + m[1] * m[1] + m[2] * m[2]
}

impl<S: Real> Invariants for RigidBody<S> {
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::of_the_action("|m|²", 2), Invariant::of_the_flow("energy", 2)]
    }
    fn values(&self, m: &Vector3<S>) -> Vec<S> {
        vec![squares(m), self.energy(m)]
    }
}

/// |m|² of m = gᵀm_s, which is constant while g is orthogonal.
impl<S: Real> Invariants for RigidBodyAttitude<S> {
    fn invariants(&self) -> Vec<Invariant> {
        self.body().invariants()
    }
    fn values(&self, g: &Matrix3<S>) -> Vec<S> {
        self.body().values(&self.momentum_body(g))
    }
}

impl<S: Real> Invariants for RigidBodyState<S> {
    fn invariants(&self) -> Vec<Invariant> {
        let space = (1..=3).map(|i| Invariant::of_the_action(format!("(gm)_{i}"), 2).in_terms());
        self.body().invariants().into_iter().chain(space).collect()
    }
    fn values(&self, y: &BodyState<S>) -> Vec<S> {
        let space = crate::so3::apply3(&y.g, &y.m);
        let mut values = self.body().values(&y.m);
        values.extend(space.iter());
        values
    }
    /// |g m| and |m| are equal, and a component may be small.
    fn sizes(&self, y: &BodyState<S>) -> Vec<S> {
        let mut sizes = self.body().values(&y.m);
        let size = squares(&y.m).sqrt();
        sizes.extend([size; 3]);
        sizes
    }
}

/// tr mᵏ for even k ≤ n, which are the Casimirs of so(n)* except the Pfaffian, and the energy.
impl Invariants for RigidBodyN {
    fn invariants(&self) -> Vec<Invariant> {
        let n = self.group().n();
        let casimirs =
            (2..=n).step_by(2).map(|k| Invariant::of_the_action(format!("tr m^{k}"), k as u32));
        casimirs.chain([Invariant::of_the_flow("energy", 2)]).collect()
    }
    fn values(&self, m: &Mat<f64>) -> Vec<f64> {
        let n = m.nrows();
        let (square, mut power, mut values) = (m * m, Mat::<f64>::identity(n, n), Vec::new());
        for _ in (2..=n).step_by(2) {
            power = &power * &square;
            values.push((0..n).map(|i| power[(i, i)]).sum());
        }
        values.push(self.energy(m));
        values
    }
}

impl Invariants for RigidBodyNAttitude {
    fn invariants(&self) -> Vec<Invariant> {
        self.body().invariants()
    }
    fn values(&self, g: &GroupMatrix) -> Vec<f64> {
        self.body().values(&self.momentum_body(g))
    }
}

/// The integrals of [`RigidBodyN::manakov`] besides the Casimirs: the coefficients of zʲ in
/// tr(m + zΛ²)ᵏ for 3 ≤ k ≤ n and 1 ≤ j ≤ k − 2 with k − j even, Λ = diag(λ). They and the Casimirs
/// make the body integrable. If λ is too short, they are NaN.
///
/// Source: S. V. Manakov, Funct. Anal. Appl. 10 (1976).
pub fn manakov_integrals(lambda: &[f64], m: &Mat<f64>) -> Vec<f64> {
    let n = m.nrows();
    // Powers as polynomials in z, coefficient by coefficient: (m + zΛ²)P.
    let one = Mat::<f64>::identity(n, n);
    let (mut power, mut integrals) = (vec![one], Vec::new());
    let mut product = Mat::zeros(n, n);
    for k in 1..=n {
        let mut next = vec![Mat::<f64>::zeros(n, n); k + 1];
        for (j, p) in power.iter().enumerate() {
            mul(&mut product, m.as_ref(), p.as_ref());
            next[j] += &product;
            next[j + 1] += Mat::from_fn(n, n, |i, l| {
                let mass = lambda.get(i).copied().unwrap_or(f64::NAN);
                mass * mass * p[(i, l)]
            });
        }
        power = next;
        for j in (1..k.saturating_sub(1)).filter(|j| (k - j) % 2 == 0) {
            integrals.push((0..n).map(|i| power[j][(i, i)]).sum());
        }
    }
    integrals
}
