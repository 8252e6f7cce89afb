//! Ψ = ccsk, canonical coordinates of the second kind (paper 4.2).
//!
//! | | ccsk(u) | dccsk_u⁻¹ |
//! |---|---|---|
//! | SO(n) | ∏ of the plane rotations exp(u_rc(e_r e_cᵀ − e_c e_rᵀ)), c = 1 … n−1, r = c+1 … n | column by column, O(n³) |
//! | GL(n) | (𝟙 + U₊) diag(e^{u_ii}) (𝟙 + U₋), U₊ and U₋ the strict triangles of u | triangular products, O(n³) |
//! | Sp(2m) | \[𝟙 B; 0 𝟙\] diag(L, L⁻ᵀ) \[𝟙 0; C 𝟙\], u = \[A B; C −Aᵀ\], L the GL(m) chart of A | the same, in blocks |
//! | so(3) | exp(u_i e_i) exp(u_j e_j) exp(u_k e_k) for an ordering ijk | the matrix (18), in the axes ijk |
//!
//! At n = 3 the ordered basis of SO(n) is e₃, −e₂, e₁: the ordering 321 of the paper. It is
//! [`CCSK321`] for every n. [`CCSK123`] is its reverse: Ψ₁₂₃(u) = Ψ₃₂₁(−u)⁻¹. On GL(n) and Sp(2m)
//! the two names mean the product above and its reverse; their dΨ⁻¹ is never singular. A general
//! G_M has no basis with cheap factors.

mod gl;
mod so3;
mod so_n;
mod sp;

use faer::Mat;

use self::gl::Gl;
use self::so_n::SoN;
use self::sp::Sp;
use super::CoordinateMap;
use super::quotient::finite;
use crate::dense::{mul, scaled_sum};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup};

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

    /// The map with another bound on |cos|. The bound 0 gives the raw formula up to its singularity.
    pub const fn with_min_cos(min_cos: f64) -> Self {
        Ccsk { min_cos }
    }
}

impl<const I: usize, const J: usize, const K: usize> Default for Ccsk<I, J, K> {
    fn default() -> Self {
        Self::new()
    }
}

const GIMBAL: StepError =
    StepError::OutsideChart { map: "ccsk", what: "the cosine of a middle angle is nearly zero" };

/// The values that ccsk stores at u ∈ 𝔤 ⊂ gl(n): the factors, and workspace.
#[derive(Debug)]
pub struct CcskAt {
    product: Product,
    /// −u, Ψ₃₂₁(−u) and Ψ₁₂₃(u) of the reversed ordering.
    minus: Mat<f64>,
    back: Mat<f64>,
    ahead: Mat<f64>,
    w: Mat<f64>,
}

/// The ordered basis of the group.
#[derive(Debug)]
enum Product {
    SoN(SoN),
    Gl(Gl),
    Sp(Box<Sp>),
}

impl CcskAt {
    fn new(group: &MatrixGroup) -> Result<Self, Error> {
        let n = group.n();
        let product = match group.form() {
            Form::Identity => Product::SoN(SoN::new(n)),
            Form::Free => Product::Gl(Gl::new(n)),
            Form::Symplectic => Product::Sp(Box::new(Sp::new(n))),
            _ => {
                return Err(Error::Unsupported {
                    what: "ccsk",
                    with: group.name(),
                    why: "only SO(n), GL(n) and Sp(2m) have a basis with cheap factors; use exp \
                          or cay",
                });
            }
        };
        let z = || Mat::zeros(n, n);
        Ok(CcskAt { product, minus: z(), back: z(), ahead: z(), w: z() })
    }
}

impl Product {
    /// g ← Ψ(u), the factors in order.
    fn psi(&mut self, u: &Mat<f64>, g: &mut Mat<f64>) -> Result<(), StepError> {
        match self {
            Product::SoN(at) => at.psi(u, g),
            Product::Gl(at) => at.psi(u, g),
            Product::Sp(at) => at.psi(u, g),
        }
        finite(g, "ccsk(u)")
    }

    /// v ← dΨ_u⁻¹ v at the u of the last [`psi`](Self::psi).
    fn dpsi_inv(&mut self, u: &Mat<f64>, v: &mut Mat<f64>, min_cos: f64) -> Result<(), StepError> {
        match self {
            Product::SoN(at) => at.dpsi_inv(v, min_cos)?,
            Product::Gl(at) => at.dpsi_inv(u, v),
            Product::Sp(at) => at.dpsi_inv(v),
        }
        finite(v, "dccsk⁻¹")
    }

    /// g ← Ψ(u)⁻¹, given back = Ψ(u).
    fn inverse(&mut self, u: &Mat<f64>, back: &Mat<f64>, g: &mut Mat<f64>) {
        match self {
            Product::SoN(_) => g.copy_from(back.transpose()),
            Product::Gl(_) => gl::inverse(u, g),
            Product::Sp(_) => sp::inverse(back, g),
        }
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
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CcskAt,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        group.operand("u in ccsk(u)", u)?;
        at.product.psi(u, g)
    }
    fn dpsi_inv(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CcskAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        group.fits("v", v)?;
        at.product.dpsi_inv(u, v, self.min_cos)
    }
}

/// The reversed ordering: Ψ(u) = Ψ₃₂₁(−u)⁻¹ and dΨ_u⁻¹ w = d(Ψ₃₂₁)_{−u}⁻¹ (Ψ(u)⁻¹ w Ψ(u)).
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
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut CcskAt,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        group.operand("u in ccsk(u)", u)?;
        let CcskAt { product, minus, back, ahead, .. } = at;
        scaled_sum(minus, [-1.0], [u], 0.0);
        product.psi(minus, back)?;
        product.inverse(minus, back, ahead);
        g.copy_from(&*ahead);
        finite(g, "ccsk(u)")
    }
    fn dpsi_inv(
        &self,
        group: &MatrixGroup,
        _: &AlgebraMatrix,
        at: &mut CcskAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        group.fits("v", v)?;
        let CcskAt { product, minus, back, ahead, w } = at;
        mul(w, back.as_ref(), v.as_ref());
        mul(v, w.as_ref(), ahead.as_ref());
        product.dpsi_inv(minus, v, self.min_cos)
    }
}
