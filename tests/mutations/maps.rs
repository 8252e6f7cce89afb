//! Coordinate maps with one fault each.
#![allow(dead_code, reason = "each suite uses its part")]

use lieflow::groups::So3;
use lieflow::maps::CCSK123;
use lieflow::methods::OddMap;
use lieflow::{CoordinateMap, Error, LieAlgebra, StepError};
use nalgebra::{Matrix3, Vector3};

use crate::support::represent::Represent;

/// What is wrong with the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// dΨ⁻¹ is the identity.
    NoDifferential,
    /// dΨ⁻¹ is trivialised from the left: taken at −u.
    LeftTrivialised,
    /// dexp⁻¹ = 𝟙 − ½ad_u + ⅙ad_u².
    Baker2,
    /// The coefficient −1/720 of ad_u⁴ has the other sign.
    Baker4Sign,
    /// dcay⁻¹ without ¼u(·)u.
    NoQuarter,
    /// cay without the ½.
    NoHalf,
    /// exp cut after u²/2.
    OffGroup,
    /// Ψ(u)·x uses the inverse.
    OnInverse,
    /// dΨ⁻¹ is evaluated at the first u that the workspace saw.
    Stale,
}

/// A sound map with a fault put in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faulty<Psi>(pub(crate) Psi, pub(crate) Fault);

impl<G: Represent, Psi: CoordinateMap<G>> CoordinateMap<G> for Faulty<Psi> {
    type At = (Psi::At, Option<G::Alg>);

    fn name(&self) -> &'static str {
        "faulty"
    }
    fn at(&self, group: &G) -> Result<Self::At, Error> {
        Ok((self.0.at(group)?, None))
    }
    fn psi(
        &self,
        group: &G,
        u: &G::Alg,
        (at, first): &mut Self::At,
        g: &mut G::Elem,
    ) -> Result<(), StepError> {
        first.get_or_insert_with(|| u.clone());
        match self.1 {
            Fault::NoHalf => self.0.psi(group, &group.scaled(2.0, u), at, g),
            Fault::OffGroup => {
                let u = group.algebra_matrix(u);
                let square = &u * &u * faer::Scale(0.5);
                *g = group.element_of(&(group.element_matrix(&group.identity()) + u + square));
                Ok(())
            }
            _ => self.0.psi(group, u, at, g),
        }
    }
    fn psi_on(
        &self,
        group: &G,
        u: &G::Alg,
        at: &mut Self::At,
        g: &mut G::Elem,
        x: &G::Vector,
        y: &mut G::Vector,
    ) -> Result<(), StepError> {
        let sign = if self.1 == Fault::OnInverse { -1.0 } else { 1.0 };
        self.psi(group, &group.scaled(sign, u), at, g)?;
        group.apply(g, x, y);
        Ok(())
    }
    fn dpsi_inv(
        &self,
        group: &G,
        u: &G::Alg,
        (at, first): &mut Self::At,
        v: &mut G::Alg,
    ) -> Result<(), StepError> {
        let ad = |v: &G::Alg| group.commutator(u, v);
        let mut exact_at = |u: &G::Alg, v: &mut G::Alg| {
            self.0.psi(group, u, at, &mut group.identity())?;
            self.0.dpsi_inv(group, u, at, v)
        };
        let uv = ad(v);
        let uuv = ad(&uv);
        match self.1 {
            Fault::NoDifferential => {}
            Fault::LeftTrivialised => exact_at(&group.scaled(-1.0, u), v)?,
            Fault::Baker2 => {
                group.axpy(-0.5, &uv, v);
                group.axpy(1.0 / 6.0, &uuv, v);
            }
            Fault::Baker4Sign => {
                exact_at(u, v)?;
                group.axpy(2.0 / 720.0, &ad(&ad(&uuv)), v);
            }
            Fault::NoQuarter => group.axpy(-0.5, &uv, v),
            Fault::NoHalf => {
                exact_at(&group.scaled(2.0, u), v)?;
                *v = group.scaled(0.5, v);
            }
            Fault::Stale => {
                let first = first.clone().unwrap_or_else(|| u.clone());
                exact_at(&first, v)?;
            }
            Fault::OffGroup | Fault::OnInverse => exact_at(u, v)?,
        }
        Ok(())
    }
}

impl<Psi: OddMap> OddMap for Faulty<Psi> {}

/// ccsk123 on so(3) with the wrong sign at sin u₂ in (18).
#[derive(Clone, Copy, Debug)]
pub(crate) struct WrongSign;

impl CoordinateMap<So3> for WrongSign {
    type At = <lieflow::maps::Ccsk<0, 1, 2> as CoordinateMap<So3>>::At;

    fn name(&self) -> &'static str {
        "faulty"
    }
    fn at(&self, group: &So3) -> Result<Self::At, Error> {
        CCSK123.at(group)
    }
    fn psi(
        &self,
        group: &So3,
        u: &Vector3<f64>,
        at: &mut Self::At,
        g: &mut Matrix3<f64>,
    ) -> Result<(), StepError> {
        CCSK123.psi(group, u, at, g)
    }
    fn dpsi_inv(
        &self,
        group: &So3,
        u: &Vector3<f64>,
        at: &mut Self::At,
        v: &mut Vector3<f64>,
    ) -> Result<(), StepError> {
        CCSK123.dpsi_inv(group, u, at, v)?;
        group.axpy(2.0 * u[1].sin() * v[2], &Vector3::x(), v);
        Ok(())
    }
}
