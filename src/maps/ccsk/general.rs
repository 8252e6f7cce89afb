//! ccsk of n×n matrices.

use faer::Mat;

use super::gl::{self, Gl};
use super::so_n::SoN;
use super::sp::{self, Sp};
use super::{Ccsk, NAMES};
use crate::dense::{mul, scaled_sum};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup};
use crate::maps::CoordinateMap;
use crate::maps::quotient::finite;

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
        if group.is_complex() {
            return Err(Error::Unsupported {
                what: "ccsk",
                with: group.name(),
                why: "its factors turn single pairs of real axes, and leave the complex matrices; use exp or cay",
            });
        }
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

    /// v ← dΨ_u⁻¹ v of the reversed ordering, at the −u = `minus` of the last [`psi`](Self::psi).
    ///
    /// On SO(n) it is d(Ψ₃₂₁)_{−u}⁻¹ of Ψ(u)⁻¹ v Ψ(u), `back` and `ahead` around v. Elsewhere these factors may be large,
    /// and triangular ones do.
    fn dpsi_inv_reversed(
        &mut self,
        minus: &Mat<f64>,
        [back, ahead, w]: [&mut Mat<f64>; 3],
        v: &mut Mat<f64>,
        min_cos: f64,
    ) -> Result<(), StepError> {
        match self {
            Product::SoN(at) => {
                mul(w, back.as_ref(), v.as_ref());
                mul(v, w.as_ref(), ahead.as_ref());
                at.dpsi_inv(v, min_cos)?;
            }
            Product::Gl(at) => at.dpsi_inv_reversed(minus, v),
            Product::Sp(at) => at.dpsi_inv_reversed(v),
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

/// The reversed ordering: Ψ(u) = Ψ₃₂₁(−u)⁻¹.
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
        product.dpsi_inv_reversed(minus, [back, ahead, w], v, self.min_cos)
    }
}
