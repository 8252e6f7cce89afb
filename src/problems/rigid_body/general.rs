//! The free rigid body in ℝⁿ on dense matrices: m ∈ so(n)*, and Ω = J⁻¹(m) entry by entry.

use faer::Mat;

use super::check_inertia;
use crate::actions::{Coadjoint, LeftTranslation};
use crate::dense::{antisymmetrise, mul, scaled_sum};
use crate::error::Error;
use crate::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup};
use crate::problems::FieldStore;
use crate::problems::{LiePoisson, Problem};
use crate::scalar::{Ops, tally};

/// The free n-dimensional rigid body by its body momentum: ṁ = \[m, Ω\], Ω_ij = m_ij/J_ij.
///
/// f(m) = −Ω; Λ(g, m) = g m gᵀ. The motion stays on a coadjoint orbit of SO(n). At n = 3, with m the hat of the
/// momentum vector, it is Euler's equation (5). Invariants: the energy, and the eigenvalues of m, which are Casimirs:
/// every method that acts by the group conserves them.
#[derive(Clone, Debug)]
pub struct RigidBodyN {
    group: MatrixGroup,
    /// 1/J_ij, and 0 on the diagonal.
    inverse_inertia: Mat<f64>,
}

impl RigidBodyN {
    /// Makes a body from the inertia J_ij of each plane i < j, in the order 12, 13, …, 1n, 23, …
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for n = 0 or an inertia that is not finite and positive,
    /// [`Error::Shape`] unless there are n(n−1)/2 of them.
    pub fn from_pairs(n: usize, inertia: &[f64]) -> Result<Self, Error> {
        let group = MatrixGroup::so(n)?;
        let pairs = n * (n - 1) / 2;
        if inertia.len() != pairs {
            return Err(Error::Shape {
                arg: "inertia",
                rows: inertia.len(),
                cols: 1,
                expected_rows: pairs,
                expected_cols: 1,
            });
        }
        check_inertia(inertia)?;
        let mut inverse_inertia = Mat::zeros(n, n);
        let planes = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
        for ((i, j), inertia) in planes.zip(inertia) {
            inverse_inertia[(i, j)] = 1.0 / inertia;
            inverse_inertia[(j, i)] = 1.0 / inertia;
        }
        Ok(RigidBodyN { group, inverse_inertia })
    }

    /// The body in ℝ³ with principal moments of inertia J₁, J₂, J₃: J₁ belongs to the plane 23.
    ///
    /// # Errors
    /// As [`from_pairs`](Self::from_pairs).
    pub fn from_principal(inertia: [f64; 3]) -> Result<Self, Error> {
        check_inertia(&inertia)?;
        Self::from_pairs(3, &[inertia[2], inertia[1], inertia[0]])
    }

    /// Manakov's body: J_ij = λ_i + λ_j from the mass moments λ_1, …, λ_n.
    ///
    /// # Errors
    /// As [`from_pairs`](Self::from_pairs): the sums must be positive, the λ_i need not.
    pub fn manakov(lambda: &[f64]) -> Result<Self, Error> {
        Error::all_finite("lambda", lambda)?;
        let n = lambda.len();
        let sums: Vec<f64> =
            (0..n).flat_map(|i| (i + 1..n).map(move |j| lambda[i] + lambda[j])).collect();
        Self::from_pairs(n, &sums)
    }

    /// E = ½ Σ_{i<j} m_ij²/J_ij.
    pub fn energy(&self, m: &Mat<f64>) -> f64 {
        let mut twice = 0.0;
        tally(|| (Ops::adds(2) + Ops::muls(3)) * (m.ncols() * m.ncols().saturating_sub(1) / 2));
        for j in 0..m.ncols() {
            for i in 0..j {
                let x = 0.5 * (m[(i, j)] - m[(j, i)]);
                twice += x * x * self.inverse_inertia[(i, j)];
            }
        }
        0.5 * twice
    }

    /// out ← sign·Ω(m), by the skew part of m.
    ///
    /// A momentum in so(n)* is skew, but the coadjoint action g m gᵀ leaves rounding errors in the symmetric part. With
    /// them Ω would not be in so(n), and |m| would drift quadratically with the number of steps.
    pub(super) fn omega(&self, sign: f64, m: &Mat<f64>, out: &mut Mat<f64>) {
        let half = 0.5 * sign;
        tally(|| (Ops::adds(1) + Ops::muls(2)) * (m.ncols() * m.ncols().saturating_sub(1) / 2));
        for j in 0..m.ncols() {
            out[(j, j)] = 0.0;
            for i in j + 1..m.nrows() {
                let w = half * (m[(i, j)] - m[(j, i)]) * self.inverse_inertia[(i, j)];
                (out[(i, j)], out[(j, i)]) = (w, -w);
            }
        }
    }
}

impl Problem for RigidBodyN {
    type Group = MatrixGroup;
    type Action = Coadjoint;
    type Work = ();

    fn group(&self) -> &MatrixGroup {
        &self.group
    }
    fn action(&self) -> &Coadjoint {
        &Coadjoint
    }
    fn work(&self) {}
    fn f(&self, _: f64, m: &Mat<f64>, v: &mut AlgebraMatrix, _: &mut ()) {
        self.omega(-1.0, m, v);
    }
    /// \[m, Ω\] = P − Pᵀ with P = mΩ, because m is skew. λ_* does not know that.
    fn field(
        &self,
        _: f64,
        m: &Mat<f64>,
        dm: &mut Mat<f64>,
        FieldStore { v, .. }: &mut FieldStore<Self>,
    ) {
        self.omega(1.0, m, v);
        mul(dm, m.as_ref(), v.as_ref());
        antisymmetrise(dm);
    }
}

/// The free n-dimensional rigid body by its attitude: ġ = f(g)·g on SO(n).
///
/// f(g) = g Ω(gᵀ m_s g) gᵀ with constant m_s. The body momentum is gᵀ m_s g.
#[derive(Clone, Debug)]
pub struct RigidBodyNAttitude {
    body: RigidBodyN,
    momentum_space: Mat<f64>,
}

impl RigidBodyNAttitude {
    /// Makes it from a body, and from the angular momentum in space as a skew-symmetric matrix.
    ///
    /// # Errors
    /// As [`MatrixGroup::algebra`] for a momentum that is not skew-symmetric and finite.
    pub fn new(body: RigidBodyN, momentum_space: Mat<f64>) -> Result<Self, Error> {
        let momentum_space = body.group.algebra(momentum_space)?.into_mat();
        Ok(RigidBodyNAttitude { body, momentum_space })
    }

    /// The body by its momentum only.
    pub fn body(&self) -> &RigidBodyN {
        &self.body
    }

    /// m_s.
    pub(super) fn momentum_space(&self) -> &Mat<f64> {
        &self.momentum_space
    }

    /// gᵀ m_s g, the angular momentum in the body. Allocates.
    pub fn momentum_body(&self, g: &GroupMatrix) -> Mat<f64> {
        g.transpose() * &self.momentum_space * g.as_ref()
    }

    /// out ← g Ω(gᵀ m_s g) gᵀ.
    fn omega_space(&self, g: &GroupMatrix, out: &mut Mat<f64>, [a, b]: &mut [Mat<f64>; 2]) {
        mul(a, g.transpose(), self.momentum_space.as_ref());
        mul(b, a.as_ref(), g.as_ref());
        self.body.omega(1.0, b, a);
        mul(b, g.as_ref(), a.as_ref());
        mul(out, b.as_ref(), g.transpose());
    }
}

impl Problem for RigidBodyNAttitude {
    type Group = MatrixGroup;
    type Action = LeftTranslation;
    type Work = [Mat<f64>; 2];

    fn group(&self) -> &MatrixGroup {
        &self.body.group
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) -> [Mat<f64>; 2] {
        let n = self.body.group.n();
        core::array::from_fn(|_| Mat::zeros(n, n))
    }
    fn f(&self, _: f64, g: &GroupMatrix, v: &mut AlgebraMatrix, work: &mut [Mat<f64>; 2]) {
        self.omega_space(g, v, work);
        tally(|| (Ops::adds(1) + Ops::muls(1)) * (v.ncols() * v.ncols().saturating_sub(1) / 2));
        // Two congruences leave rounding in the symmetric part; so(n) has none.
        for j in 0..v.ncols() {
            v[(j, j)] = 0.0;
            for i in j + 1..v.nrows() {
                let w = 0.5 * (v[(i, j)] - v[(j, i)]);
                (v[(i, j)], v[(j, i)]) = (w, -w);
            }
        }
    }
    /// λ_*(f) without taking the skew part of ω_s, because here its rounding error does not matter.
    fn field(
        &self,
        _: f64,
        g: &GroupMatrix,
        dg: &mut GroupMatrix,
        FieldStore { v, work, .. }: &mut FieldStore<Self>,
    ) {
        self.omega_space(g, v, work);
        mul(dg, v.as_ref(), g.as_ref());
    }
}

/// H = ½ Σ_{i<j} m_ij²/J_ij. Its gradient is Ω in the pairing ½tr(mᵀv), which counts each plane once.
impl LiePoisson for RigidBodyN {
    fn hamiltonian(&self, m: &Mat<f64>) -> f64 {
        self.energy(m)
    }
    fn discrete_gradient(
        &self,
        a: &Mat<f64>,
        b: &Mat<f64>,
        xi: &mut AlgebraMatrix,
        (m, _): (&mut Mat<f64>, &mut AlgebraMatrix),
        _: &mut (),
    ) {
        scaled_sum(m, [0.5, 0.5], [a, b], 0.0);
        self.omega(1.0, m, xi);
    }
}
