//! exp on n×n matrices.

use super::powers::{
    DIVERGES, Dexpinv, EXACT_FROM, Powers, SINGULAR, SINGULAR_AT, finite, phi, phi1,
};
use super::{Exp, TruncatedExp};
use crate::dense::{
    AdSchur, ComplexBlocks, Direction, Expm, ExpmChoice, SkewEigen, Structure, scaled_sum,
};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup};
use crate::maps::CoordinateMap;

/// The bound of ad_{u/2^s} from which the halvings start.
const HALVED: f64 = 2.0;

/// The values that exp stores at u ∈ 𝔤 ⊂ gl(n): workspaces, and the choices made.
#[derive(Debug)]
pub struct ExpAt {
    expm: Expm,
    powers: Powers<AlgebraMatrix>,
    scaled: AlgebraMatrix,
    exact: Exact,
    spectrum: Option<Box<AdSchur>>,
    dexpinv: Dexpinv,
    halvings: u32,
}

/// Beyond the reach of the series.
#[derive(Debug)]
enum Exact {
    /// Nothing: the series is truncated.
    None,
    /// Every u of the algebra is skew.
    Eigen(Box<SkewEigen>),
    /// Every u is a skew-Hermitian matrix as a real one.
    Complex(Box<ComplexBlocks>),
    Schur(Box<AdSchur>),
}

impl ExpAt {
    /// Which approximant the last Ψ took.
    pub fn expm_choice(&self) -> ExpmChoice {
        self.expm.choice
    }
    /// How the last dexp⁻¹ was computed.
    pub fn dexpinv_choice(&self) -> Dexpinv {
        self.dexpinv
    }

    /// How often the last dexp⁻¹ halved u: 0 where the series or the eigen form served u itself.
    pub fn halvings(&self) -> u32 {
        self.halvings
    }

    /// The smallest distance of an eigenvalue of ad_u on 𝔤 to the singular set 2πik, k ≠ 0, of
    /// dexp_u: what an eigenvalue has to move by. dexp_u⁻¹ is refused below about 1e-12·max(1, ‖u‖).
    ///
    /// Cost: one Schur form; storage for it is made at the first call.
    ///
    /// # Errors
    /// [`StepError::NotFinite`], [`StepError::NotConverged`].
    pub fn distance_to_singular(
        &mut self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
    ) -> Result<f64, StepError> {
        group.operand("u in dexp_u", u)?;
        if group.is_complex() {
            return ComplexBlocks::new(group.n() / 2).distance_to_singular(u);
        }
        let make = || Box::new(AdSchur::new(group.n(), group.ad_form()));
        let schur = self.spectrum.get_or_insert_with(make);
        schur.factor(u)?;
        Ok(schur.distance_to_singular())
    }

    pub(super) fn new(group: &MatrixGroup, exact: bool) -> Self {
        let n = group.n();
        ExpAt {
            expm: Expm::new(n),
            powers: Powers::new(|| group.zero()),
            scaled: group.zero(),
            exact: match exact {
                false => Exact::None,
                true if group.is_complex() => {
                    Exact::Complex(Box::new(ComplexBlocks::new(group.n() / 2)))
                }
                true if group.is_skew() => Exact::Eigen(Box::new(SkewEigen::new(n))),
                true => Exact::Schur(Box::new(AdSchur::new(n, group.ad_coordinates()))),
            },
            spectrum: None,
            dexpinv: Dexpinv::None,
            halvings: 0,
        }
    }

    fn exp(
        &mut self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        group.fits("u", u)?;
        let structure = match group.form() {
            Form::Identity => Structure::Skew,
            _ => Structure::General,
        };
        self.expm.exp(u, structure, g)
    }

    /// v ← Σ_{k ≤ q} B_k/k! ad_u^k v; returns ‖ad_u^q v‖.
    pub(super) fn truncated(
        &mut self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        q: usize,
        v: &mut AlgebraMatrix,
    ) -> Result<f64, StepError> {
        group.fits("v", v)?;
        self.powers.ad.copy_from(&**v);
        self.dexpinv = self.powers.baker(group, u, ad_bound(group, u), Some(q), v)?;
        Ok(group.norm(&self.powers.ad))
    }

    /// v ← dexp_u⁻¹ v to rounding.
    fn inverse(
        &mut self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        group.fits("v", v)?;
        let norm = ad_bound(group, u);
        self.halvings = 0;
        if norm <= EXACT_FROM {
            self.powers.ad.copy_from(&**v);
            self.dexpinv = self.powers.baker(group, u, norm, None, v)?;
            return Ok(());
        }
        if !norm.is_finite() {
            return Err(StepError::NormTooLarge { map: "exp" });
        }
        if self.powers.commute(group, u, v) {
            self.dexpinv = Dexpinv::Series(1);
            return Ok(());
        }
        match &mut self.exact {
            Exact::None => Err(DIVERGES),
            Exact::Eigen(eigen) => {
                self.dexpinv = Dexpinv::Eigen;
                eigen.function_of_ad(u, v, |theta| phi(theta, norm))?;
                finite(group, v, "dexp⁻¹")
            }
            Exact::Complex(eigen) => {
                self.dexpinv = Dexpinv::Eigen;
                eigen.function_of_ad(u, v, |theta| phi(theta, norm))?;
                finite(group, v, "dexp⁻¹")
            }
            Exact::Schur(schur) => {
                let s = scale_down(u, norm, &mut self.scaled);
                let radius = ad_bound(group, &self.scaled);
                self.powers.ad.copy_from(&**v);
                self.dexpinv = self.powers.baker(group, &self.scaled, radius, None, v)?;
                self.halvings = s;
                halve(schur, group, u, s, Direction::Inverse, v)
            }
        }
    }

    /// v ← dexp_u v to rounding.
    pub(super) fn forward(
        &mut self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        let norm = ad_bound(group, u);
        if norm <= EXACT_FROM {
            self.powers.ad.copy_from(&**v);
            self.powers.phi1(group, u, v);
            return Ok(());
        }
        if !norm.is_finite() {
            return Err(StepError::NormTooLarge { map: "exp" });
        }
        if self.powers.commute(group, u, v) {
            return Ok(());
        }
        match &mut self.exact {
            Exact::None => Err(DIVERGES),
            Exact::Eigen(eigen) => eigen.function_of_ad(u, v, |theta| Ok(phi1(theta))),
            Exact::Complex(eigen) => eigen.function_of_ad(u, v, |theta| Ok(phi1(theta))),
            Exact::Schur(schur) => {
                let s = scale_down(u, norm, &mut self.scaled);
                self.powers.ad.copy_from(&**v);
                self.powers.phi1(group, &self.scaled, v);
                halve(schur, group, u, s, Direction::Forward, v)
            }
        }
    }
}

/// scaled ← u/2^s with ‖ad_{u/2^s}‖ ≤ [`HALVED`]; returns s.
fn scale_down(u: &AlgebraMatrix, norm: f64, scaled: &mut AlgebraMatrix) -> u32 {
    let s = (norm / HALVED).log2().ceil().max(1.0) as u32;
    scaled_sum(scaled, [0.5f64.powi(s as i32)], [u], 0.0);
    s
}

/// From u/2^s to u, in either direction.
fn halve(
    schur: &mut AdSchur,
    group: &MatrixGroup,
    u: &AlgebraMatrix,
    s: u32,
    direction: Direction,
    v: &mut AlgebraMatrix,
) -> Result<(), StepError> {
    let singular = SINGULAR * group.norm(u).max(1.0);
    let apply = |schur: &mut AdSchur| schur.halvings(s, direction, singular, v);
    group.function_of_ad(schur, u, apply)?.map_err(|_| SINGULAR_AT)?;
    finite(group, v, "dexp_u or its inverse")
}

/// A bound of ‖ad_u‖ in the Frobenius norm: 2‖u‖₂ ≤ 2‖u‖_F, and ‖u‖_F on so(n), where the
/// eigenvalues of ad_u are i(±a ± b) with 2(a² + b²) ≤ ‖u‖_F².
pub(super) fn ad_bound(group: &MatrixGroup, u: &AlgebraMatrix) -> f64 {
    match group.form() {
        Form::Identity => group.norm(u),
        _ => 2.0 * group.norm(u),
    }
}

impl CoordinateMap<MatrixGroup> for Exp {
    type At = ExpAt;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, group: &MatrixGroup) -> Result<ExpAt, Error> {
        Ok(ExpAt::new(group, true))
    }
    fn psi(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut ExpAt,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        at.exp(group, u, g)
    }
    fn dpsi_inv(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut ExpAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        at.inverse(group, u, v)
    }
}

impl CoordinateMap<MatrixGroup> for TruncatedExp {
    type At = ExpAt;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, group: &MatrixGroup) -> Result<ExpAt, Error> {
        Ok(ExpAt::new(group, false))
    }
    fn psi(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut ExpAt,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        at.exp(group, u, g)
    }
    fn dpsi_inv(
        &self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        at: &mut ExpAt,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        at.truncated(group, u, self.q, v).map(drop)
    }
    fn order(&self, _: &MatrixGroup) -> usize {
        self.order_kept()
    }
}
