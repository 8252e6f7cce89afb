//! Ψ = ccsk, canonical coordinates of the second kind (paper 4.2).
//!
//! | | ccsk(u) | dccsk_u⁻¹ |
//! |---|---|---|
//! | SO(n) | ∏ of the plane rotations exp(u_rc(e_r e_cᵀ − e_c e_rᵀ)), c = 1 … n−1, r = c+1 … n | column by column, O(n³) |
//! | so(3) | exp(u_i e_i) exp(u_j e_j) exp(u_k e_k) for an ordering ijk | the matrix (18), in the axes ijk |
//!
//! At n = 3 the ordered basis of SO(n) is e₃, −e₂, e₁: the ordering 321 of the paper. It is
//! [`CCSK321`] for every n, and [`CCSK123`] is its reverse.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use super::CoordinateMap;
use crate::dense::mul;
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup, So3};
use crate::scalar::Trig;
use crate::so3::{Angles, GIMBAL, ccsk_of, dccskinv_of};

/// Canonical coordinates of the second kind with the basis ordered e_I, e_J, e_K (from 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ccsk<const I: usize, const J: usize, const K: usize> {
    min_cos: f64,
}

/// The ordering 123 (ccskf of the paper).
pub const CCSK123: Ccsk<0, 1, 2> = Ccsk::new();
/// The ordering 321 (ccskb of the paper).
pub const CCSK321: Ccsk<2, 1, 0> = Ccsk::new();

const NAMES: [[[&str; 3]; 3]; 3] = {
    let mut names = [[["ccsk"; 3]; 3]; 3];
    names[0][1][2] = "ccsk123";
    names[0][2][1] = "ccsk132";
    names[1][0][2] = "ccsk213";
    names[1][2][0] = "ccsk231";
    names[2][0][1] = "ccsk312";
    names[2][1][0] = "ccsk321";
    names
};

impl<const I: usize, const J: usize, const K: usize> Ccsk<I, J, K> {
    /// The map, with dccsk⁻¹ refused where |cos| of the middle angle is below 1e-4.
    pub const fn new() -> Self {
        const { assert!(I < 3 && J < 3 && K < 3 && I != J && J != K && K != I) };
        Ccsk { min_cos: 1e-4 }
    }

    /// The map with a bound of one's own on |cos|; 0 gives the raw formula up to its singularity.
    pub const fn with_min_cos(min_cos: f64) -> Self {
        Ccsk { min_cos }
    }
}

impl<const I: usize, const J: usize, const K: usize> Default for Ccsk<I, J, K> {
    fn default() -> Self {
        Self::new()
    }
}

// ---- so(3), closed form ---------------------------------------------------------------------

impl<S: Trig, const I: usize, const J: usize, const K: usize> CoordinateMap<So3<S>>
    for Ccsk<I, J, K>
{
    type At = Angles<S>;

    fn name(&self) -> &'static str {
        NAMES[I][J][K]
    }
    fn at(&self, _: &So3<S>) -> Result<Angles<S>, Error> {
        Ok(Angles::zero())
    }
    #[inline]
    fn psi(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut Angles<S>,
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        if !(u[0].abs() + u[1].abs() + u[2].abs()).is_finite() {
            return Err(StepError::NotFinite { what: "the argument of ccsk" });
        }
        *at = ccsk_of::<S, I, J, K>(u, g);
        Ok(())
    }
    #[inline]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        _: &Vector3<S>,
        at: &mut Angles<S>,
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        dccskinv_of::<S, I, J, K>(at, self.min_cos, v)
    }
}

// ---- SO(n) ----------------------------------------------------------------------------------

/// What ccsk keeps at u ∈ so(n): sines and cosines of the angles, and workspace.
#[derive(Debug)]
pub struct CcskAt {
    sin: Mat<f64>,
    cos: Mat<f64>,
    g: Mat<f64>,
    w: Mat<f64>,
    /// Column r holds ρ^(r).
    rho: Mat<f64>,
}

impl CcskAt {
    fn new(group: &MatrixGroup) -> Result<Self, Error> {
        match group.form() {
            Form::Identity => {
                let n = group.n();
                let z = || Mat::zeros(n, n);
                Ok(CcskAt { sin: z(), cos: z(), g: z(), w: z(), rho: z() })
            }
            _ => Err(Error::Unsupported {
                what: "ccsk",
                with: group.name(),
                why: "only SO(n) has this basis of plane rotations; use exp or cay",
            }),
        }
    }

    /// g ← ∏_c ∏_{r>c} G_rc(±u_rc).
    fn forward(&mut self, u: &Mat<f64>, sign: f64, g: &mut Mat<f64>) -> Result<(), StepError> {
        let n = u.nrows();
        g.fill(0.0);
        g.diagonal_mut().fill(1.0);
        for c in 0..n {
            for r in c + 1..n {
                let angle = sign * u[(r, c)];
                if !angle.is_finite() {
                    return Err(StepError::NotFinite { what: "the argument of ccsk" });
                }
                let (s, k) = angle.sin_cos();
                (self.sin[(r, c)], self.cos[(r, c)]) = (s, k);
                rotate_columns(g, r, c, s, k);
            }
        }
        Ok(())
    }

    /// v ← dΨ_u⁻¹ v of the forward ordering, at the angles of the last [`forward`](Self::forward).
    ///
    /// Column c: W is carried into the frame after its rotations, where E_rc has become
    /// e_r ρᵀ − ρ e_rᵀ with ρ = ρ^(r) = (G_{r+1,c} … G_nc)ᵀ e_c; v_rc is read off column c and
    /// subtracted, which leaves the trailing block.
    fn forward_inverse(&mut self, v: &mut Mat<f64>, min_cos: f64) -> Result<(), StepError> {
        let n = v.nrows();
        let CcskAt { sin, cos, w, rho, .. } = self;
        w.copy_from(&*v);
        for c in 0..n {
            for r in c + 1..n {
                rotate_rows_and_columns(w, r, c, sin[(r, c)], cos[(r, c)]);
            }
            for i in c..n {
                rho[(i, c)] = if i == c { 1.0 } else { 0.0 };
            }
            // ρ^(r) for r = n … c+1, kept in columns; column c holds the running vector.
            for r in (c + 1..n).rev() {
                for i in c..n {
                    rho[(i, r)] = rho[(i, c)];
                    rho[(i, c)] *= cos[(r, c)];
                }
                rho[(r, c)] -= sin[(r, c)];
            }
            for r in c + 1..n {
                let lead = rho[(c, r)];
                if lead.abs() < min_cos || lead == 0.0 {
                    return Err(GIMBAL);
                }
                let x = w[(r, c)] / lead;
                (v[(r, c)], v[(c, r)]) = (x, -x);
            }
            for r in c + 1..n {
                let x = v[(r, c)];
                for i in c..n {
                    w[(r, i)] -= x * rho[(i, r)];
                    w[(i, r)] += x * rho[(i, r)];
                }
            }
        }
        for i in 0..n {
            v[(i, i)] = 0.0;
        }
        Ok(())
    }
}

/// g ← g·G with G = exp(θ(e_r e_cᵀ − e_c e_rᵀ)).
fn rotate_columns(g: &mut Mat<f64>, r: usize, c: usize, sin: f64, cos: f64) {
    for i in 0..g.nrows() {
        let (x, y) = (g[(i, c)], g[(i, r)]);
        g[(i, c)] = cos * x + sin * y;
        g[(i, r)] = cos * y - sin * x;
    }
}

/// w ← Gᵀ·w·G.
fn rotate_rows_and_columns(w: &mut Mat<f64>, r: usize, c: usize, sin: f64, cos: f64) {
    rotate_columns(w, r, c, sin, cos);
    for j in 0..w.ncols() {
        let (x, y) = (w[(c, j)], w[(r, j)]);
        w[(c, j)] = cos * x + sin * y;
        w[(r, j)] = cos * y - sin * x;
    }
}

impl CoordinateMap<MatrixGroup> for Ccsk<2, 1, 0> {
    type At = CcskAt;

    fn name(&self) -> &'static str {
        NAMES[2][1][0]
    }
    fn at(&self, group: &MatrixGroup) -> Result<CcskAt, Error> {
        CcskAt::new(group)
    }
    fn psi(
        &self,
        _: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CcskAt,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        at.forward(u, 1.0, g)
    }
    fn dpsi_inv(
        &self,
        _: &MatrixGroup,
        _: &AlgebraMatrix,
        at: &mut CcskAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        at.forward_inverse(v, self.min_cos)
    }
}

/// The reversed ordering: Ψ(u) = Ψ₃₂₁(−u)ᵀ and dΨ_u⁻¹ w = d(Ψ₃₂₁)_{−u}⁻¹ (Ψ(u)ᵀ w Ψ(u)).
impl CoordinateMap<MatrixGroup> for Ccsk<0, 1, 2> {
    type At = CcskAt;

    fn name(&self) -> &'static str {
        NAMES[0][1][2]
    }
    fn at(&self, group: &MatrixGroup) -> Result<CcskAt, Error> {
        CcskAt::new(group)
    }
    fn psi(
        &self,
        _: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CcskAt,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        at.forward(u, -1.0, g)?;
        at.g.copy_from(&**g);
        g.copy_from(at.g.transpose());
        Ok(())
    }
    fn dpsi_inv(
        &self,
        _: &MatrixGroup,
        _: &AlgebraMatrix,
        at: &mut CcskAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        // at.g holds Ψ(u)ᵀ.
        mul(&mut at.w, at.g.as_ref(), v.as_ref());
        mul(v, at.w.as_ref(), at.g.transpose());
        at.forward_inverse(v, self.min_cos)
    }
}
