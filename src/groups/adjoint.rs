//! Ad, ad and their duals.
//!
//! | | definition | so(3), ⟨m, v⟩ = m·v | n×n, ⟨m, v⟩ = tr(mᵀv) |
//! |---|---|---|---|
//! | [`big_ad`](Adjoint::big_ad) | Ad_g u = g u g⁻¹ | g u | g u g⁻¹ |
//! | [`ad`](Adjoint::ad) | ad_u v = \[u, v\] | u × v | uv − vu |
//! | [`coad_group`](Adjoint::coad_group) | ⟨Ad*_g m, v⟩ = ⟨m, Ad_g v⟩ (3) | gᵀ m | gᵀ m g⁻ᵀ |
//! | [`coad`](Adjoint::coad) | ⟨ad*_u m, v⟩ = ⟨m, \[u, v\]⟩ | m × u | uᵀm − m uᵀ |
//!
//! Ad is a representation: Ad_{ab} = Ad_a Ad_b. Ad* reverses the order: Ad*_a Ad*_b = Ad*_{ba}. So the left action on
//! 𝔤* is [`Coadjoint`](crate::actions::Coadjoint), Λ(g, m) = Ad*_{g⁻¹} m. On G_M an n×n matrix m stands for the
//! functional v ↦ tr(mᵀv) on 𝔤. Several matrices may stand for the same functional.

use nalgebra::{Matrix3, Vector3};

use super::{LieGroup, So3};
use crate::error::StepError;
use crate::scalar::Real;
use crate::so3::{apply3, cross};
use crate::space::Metric;

/// The adjoint and coadjoint representations of a group and of its algebra.
pub trait Adjoint: LieGroup {
    /// m ∈ 𝔤*.
    type Dual: Metric<Scalar = Self::Scalar> + Clone;
    /// Scratch of [`invert`](Self::invert); `()` where it needs none.
    type Inverting: Send;

    /// Scratch for [`invert`](Self::invert).
    fn inverting(&self) -> Self::Inverting;

    /// out ← g⁻¹. Allocates nothing.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] for a singular g on GL(n). Then out has numbers that are not finite.
    fn invert(
        &self,
        g: &Self::Elem,
        scratch: &mut Self::Inverting,
        out: &mut Self::Elem,
    ) -> Result<(), StepError>;

    /// out ← g⁻¹. Allocates scratch.
    ///
    /// # Errors
    /// As [`invert`](Self::invert).
    fn inverse(&self, g: &Self::Elem, out: &mut Self::Elem) -> Result<(), StepError> {
        self.invert(g, &mut self.inverting(), out)
    }

    /// out ← Ad_g u = g u g⁻¹.
    ///
    /// # Errors
    /// As [`inverse`](Self::inverse); [`StepError::NotFinite`] when the result is not finite.
    fn big_ad(&self, g: &Self::Elem, u: &Self::Alg, out: &mut Self::Alg) -> Result<(), StepError>;

    /// out ← g·v = d/dε g·Ψ(εv) at ε = 0: a tangent of G at g, left trivialised.
    fn tangent_in_body(&self, g: &Self::Elem, v: &Self::Alg, out: &mut Self::Elem);

    /// out ← ad_u v = \[u, v\].
    fn ad(&self, u: &Self::Alg, v: &Self::Alg, out: &mut Self::Alg) {
        self.bracket(u, v, out);
    }

    /// out ← Ad*_g m: ⟨Ad*_g m, v⟩ = ⟨m, Ad_g v⟩ for all v ∈ 𝔤.
    ///
    /// # Errors
    /// As [`big_ad`](Self::big_ad).
    fn coad_group(
        &self,
        g: &Self::Elem,
        m: &Self::Dual,
        out: &mut Self::Dual,
    ) -> Result<(), StepError>;

    /// out ← ad*_u m: ⟨ad*_u m, v⟩ = ⟨m, \[u, v\]⟩ for all v ∈ 𝔤. Euler's equations are ṁ = ad*_ω m.
    fn coad(&self, u: &Self::Alg, m: &Self::Dual, out: &mut Self::Dual);

    /// ⟨m, v⟩.
    fn pair(&self, m: &Self::Dual, v: &Self::Alg) -> Self::Scalar;
}

impl<S: Real> Adjoint for So3<S> {
    type Dual = Vector3<S>;
    type Inverting = ();

    fn inverting(&self) {}
    #[inline]
    fn invert(&self, g: &Matrix3<S>, (): &mut (), out: &mut Matrix3<S>) -> Result<(), StepError> {
        *out = g.transpose();
        Ok(())
    }
    /// Row by row: r v̂ = r × v.
    #[inline]
    fn tangent_in_body(&self, g: &Matrix3<S>, v: &Vector3<S>, out: &mut Matrix3<S>) {
        for i in 0..3 {
            let row = cross(&Vector3::new(g[(i, 0)], g[(i, 1)], g[(i, 2)]), v);
            (out[(i, 0)], out[(i, 1)], out[(i, 2)]) = (row[0], row[1], row[2]);
        }
    }
    #[inline]
    fn big_ad(
        &self,
        g: &Matrix3<S>,
        u: &Vector3<S>,
        out: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        *out = apply3(g, u);
        finite(out.iter().all(|x| x.is_finite()))
    }
    #[inline]
    fn coad_group(
        &self,
        g: &Matrix3<S>,
        m: &Vector3<S>,
        out: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        *out = apply3(&g.transpose(), m);
        finite(out.iter().all(|x| x.is_finite()))
    }
    #[inline]
    fn coad(&self, u: &Vector3<S>, m: &Vector3<S>, out: &mut Vector3<S>) {
        *out = cross(m, u);
    }
    #[inline]
    fn pair(&self, m: &Vector3<S>, v: &Vector3<S>) -> S {
        m[0] * v[0] + m[1] * v[1] + m[2] * v[2]
    }
}

fn finite(is: bool) -> Result<(), StepError> {
    if is { Ok(()) } else { Err(StepError::NotFinite { what: "Ad" }) }
}
