//! The coadjoint action on 𝔤*; M is a coadjoint orbit.
//!
//! The paper's Ad*_g (3) is an anti-representation (Ad*_a Ad*_b = Ad*_{ba}); the left action is
//! Λ(g, m) = Ad*_{g⁻¹} m. Its infinitesimal generator at ξ is −ad*_ξ m, so that Euler's equations
//! ṁ = ad*_ω m are f(m) = −ω.
//!
//! | | 𝔤* | Λ(g, m) | λ_*(v)(m) |
//! |---|---|---|---|
//! | so(3) | ℝ³, ⟨m, v⟩ = m·v | g m | v × m |
//! | se(3) | (μ, π), ⟨m, v⟩ = μ·ω + π·v | (Rμ + x × Rπ, Rπ) | (ω × μ + v × π, ω × π) |
//! | any n | n×n matrices, ⟨m, v⟩ = tr(mᵀv) | g⁻ᵀ m gᵀ: g m gᵀ on SO(n), MgM⁻¹ m gᵀ on G_M | m vᵀ − vᵀ m |

#[cfg(feature = "dense")]
mod general;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::Action;
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, LieGroup, RESIDUAL_MAX, Se3, Se23, So3, UnitQuaternions, worse};
use crate::maps::CoordinateMap;
use crate::maps::PsiOf;
use crate::scalar::Real;
use crate::so3::{add3, cross, dot3, in_range};
use crate::space::{Gap, Metric};
use crate::tolerance::Scales;

/// The coadjoint action Λ(g, m) = Ad*_{g⁻¹} m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coadjoint;

impl<S: Real> Action<So3<S>> for Coadjoint {
    type Point = Vector3<S>;
    type Work = ();

    fn work(&self, _: &So3<S>) {}
    #[inline]
    fn check(&self, group: &So3<S>, p: &Vector3<S>) -> Result<(), Error> {
        group.check_vector(p)
    }
    #[inline]
    fn act(&self, group: &So3<S>, g: &Matrix3<S>, p: &Vector3<S>, q: &mut Vector3<S>, _: &mut ()) {
        group.apply(g, p, q);
    }
    #[inline]
    fn generate(
        &self,
        _: &So3<S>,
        v: &Vector3<S>,
        m: &Vector3<S>,
        dm: &mut Vector3<S>,
        _: &mut (),
    ) {
        *dm = cross(v, m);
    }
    #[inline(always)]
    fn lambda<Psi: CoordinateMap<So3<S>>>(
        &self,
        psi_u: PsiOf<'_, So3<S>, Psi>,
        p: &Vector3<S>,
        q: &mut Vector3<S>,
        _: &mut (),
    ) -> Result<(), StepError> {
        psi_u.on(p, q)
    }
    #[inline]
    fn restore_to(
        &self,
        group: &So3<S>,
        from: &Vector3<S>,
        p: &mut Vector3<S>,
        _: &mut (),
    ) -> Option<S> {
        group.correct_vector(from, p)
    }
}

/// Ad*_{q⁻¹} m = q m q̄.
impl Action<UnitQuaternions> for Coadjoint {
    type Point = Vector3<f64>;
    type Work = ();

    fn work(&self, _: &UnitQuaternions) {}
    #[inline]
    fn check(&self, group: &UnitQuaternions, m: &Vector3<f64>) -> Result<(), Error> {
        group.check_vector(m)
    }
    #[inline]
    fn act(
        &self,
        group: &UnitQuaternions,
        q: &UnitQuaternion<f64>,
        m: &Vector3<f64>,
        out: &mut Vector3<f64>,
        _: &mut (),
    ) {
        group.apply(q, m, out);
    }
    #[inline]
    fn generate(
        &self,
        group: &UnitQuaternions,
        v: &Vector3<f64>,
        m: &Vector3<f64>,
        dm: &mut Vector3<f64>,
        _: &mut (),
    ) {
        group.apply_algebra(v, m, dm);
    }
    fn restore_to(
        &self,
        group: &UnitQuaternions,
        from: &Vector3<f64>,
        m: &mut Vector3<f64>,
        _: &mut (),
    ) -> Option<f64> {
        group.correct_vector(from, m)
    }
}

impl<S: Real> Action<Se3<S>> for Coadjoint {
    type Point = (Vector3<S>, Vector3<S>);
    type Work = ();

    fn work(&self, _: &Se3<S>) {}
    #[inline]
    fn check(&self, _: &Se3<S>, p: &Self::Point) -> Result<(), Error> {
        So3::new().check_vector(&p.0)?;
        So3::new().check_vector(&p.1)
    }
    #[inline]
    fn act(
        &self,
        _: &Se3<S>,
        (r, x): &(Matrix3<S>, Vector3<S>),
        (mu, pi): &Self::Point,
        q: &mut Self::Point,
        _: &mut (),
    ) {
        So3::new().apply(r, mu, &mut q.0);
        So3::new().apply(r, pi, &mut q.1);
        q.0 = add3(&q.0, &cross(x, &q.1));
    }
    #[inline]
    fn generate(
        &self,
        _: &Se3<S>,
        (omega, v): &Self::Point,
        (mu, pi): &Self::Point,
        dm: &mut Self::Point,
        _: &mut (),
    ) {
        *dm = (add3(&cross(omega, mu), &cross(v, pi)), cross(omega, pi));
    }
    /// e moves μ by ω × μ + v × π, which may be large beside μ.
    #[inline]
    fn error_ratio(
        &self,
        _: &Se3<S>,
        (omega, v): &Self::Point,
        y: &Self::Point,
        scales: &mut Scales<'_>,
    ) -> S {
        let moved = (add3(&cross(omega, &y.0), &cross(v, &y.1)), cross(omega, &y.1));
        y.error_ratio(Gap::of(&moved), scales)
    }
    /// The orbit is that of |π| and μ·π: π as a vector, then μ along π.
    fn restore_to(
        &self,
        _: &Se3<S>,
        from: &Self::Point,
        p: &mut Self::Point,
        _: &mut (),
    ) -> Option<S> {
        let so3 = So3::new();
        let found = so3.correct_vector(&from.1, &mut p.1);
        let (pi2, size2) = (dot3(&p.1, &p.1), dot3(&p.0, &p.0) * dot3(&p.1, &p.1));
        if !in_range(pi2) || !in_range(size2) {
            return found;
        }
        let missing = dot3(&from.0, &from.1) - dot3(&p.0, &p.1);
        let residual = missing.abs() / size2.sqrt();
        if residual.all_below(RESIDUAL_MAX) {
            so3.axpy(missing / pi2, &p.1, &mut p.0);
        }
        worse(found, Some(residual))
    }
}

/// Λ(g, m) = (Rμ + v × Rπ + p × Rλ, (Rπ, Rλ)).
impl<S: Real> Action<Se23<S>> for Coadjoint {
    type Point = (Vector3<S>, (Vector3<S>, Vector3<S>));
    type Work = ();

    fn work(&self, _: &Se23<S>) {}
    #[inline]
    fn check(&self, _: &Se23<S>, (mu, (pi, lambda)): &Self::Point) -> Result<(), Error> {
        [mu, pi, lambda].into_iter().try_for_each(|x| So3::new().check_vector(x))
    }
    #[inline]
    fn act(
        &self,
        _: &Se23<S>,
        (r, (v, p)): &(Matrix3<S>, (Vector3<S>, Vector3<S>)),
        (mu, (pi, lambda)): &Self::Point,
        q: &mut Self::Point,
        _: &mut (),
    ) {
        let so3 = So3::new();
        so3.apply(r, mu, &mut q.0);
        so3.apply(r, pi, &mut q.1.0);
        so3.apply(r, lambda, &mut q.1.1);
        q.0 = add3(&q.0, &add3(&cross(v, &q.1.0), &cross(p, &q.1.1)));
    }
    #[inline]
    fn generate(
        &self,
        _: &Se23<S>,
        (omega, (v, p)): &Self::Point,
        (mu, (pi, lambda)): &Self::Point,
        dm: &mut Self::Point,
        _: &mut (),
    ) {
        let arms = add3(&cross(v, pi), &cross(p, lambda));
        *dm = (add3(&cross(omega, mu), &arms), (cross(omega, pi), cross(omega, lambda)));
    }
    /// e moves μ by the size of π and λ.
    #[inline]
    fn error_ratio(
        &self,
        group: &Se23<S>,
        e: &Self::Point,
        y: &Self::Point,
        scales: &mut Scales<'_>,
    ) -> S {
        let mut moved = *y;
        self.generate(group, e, y, &mut moved, &mut ());
        y.error_ratio(Gap::of(&moved), scales)
    }
    /// π and λ keep their lengths.
    fn restore_to(
        &self,
        _: &Se23<S>,
        from: &Self::Point,
        m: &mut Self::Point,
        _: &mut (),
    ) -> Option<S> {
        let so3 = So3::new();
        let found = so3.correct_vector(&from.1.0, &mut m.1.0);
        worse(found, so3.correct_vector(&from.1.1, &mut m.1.1))
    }
}
