//! exp on n×n matrices.

use core::f64::consts::PI;

use super::{Exp, TruncatedExp};
use crate::dense::{AdSchur, Direction, Expm, ExpmChoice, SkewEigen, Structure, scaled_sum};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup};
use crate::maps::CoordinateMap;

/// How dexp_u⁻¹ v was computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dexpinv {
    /// Not yet.
    #[default]
    None,
    /// The Baker series up to this power of ad_u; of ad_{u/2^s} when [`ExpAt::halvings`] is s.
    Series(usize),
    /// The eigen form, where u is skew.
    Eigen,
}

/// B_k/k! for even k, by ζ(k): B_2m/(2m)! = (−1)^(m+1)·2ζ(2m)/(2π)^2m; and −1/2 for k = 1.
#[rustfmt::skip]
const BAKER: [f64; 13] = [
    1.0, 1.0 / 12.0, -1.0 / 720.0, 1.0 / 30240.0, -1.0 / 1209600.0, 1.0 / 47900160.0,
    -691.0 / 1307674368000.0, 1.0 / 74724249600.0, -3617.0 / 10670622842880000.0,
    43867.0 / 5109094217170944000.0, -174611.0 / 802857662698291200000.0,
    77683.0 / 14101100039391805440000.0, -236364091.0 / 1693824136731743669452800000.0,
];

/// B_k/k!, the coefficient of ad_u^k.
pub(in crate::maps) fn baker(k: usize) -> f64 {
    match k {
        1 => -0.5,
        _ if k % 2 == 1 => 0.0,
        _ if k / 2 < BAKER.len() => BAKER[k / 2],
        _ => {
            // ζ(26) is 1 to 1.5e-8; one more term of the sum is exact in f64.
            let zeta = 1.0 + 0.5f64.powi(k as i32);
            let sign = if (k / 2) % 2 == 1 { 2.0 } else { -2.0 };
            sign * zeta * (2.0 * PI).powi(-(k as i32))
        }
    }
}

/// The longest series that is summed before it counts as divergent: at half the radius of
/// convergence its remainder is below rounding.
const SERIES_MAX: usize = 52;
/// The eigen form or the halvings take over where the bound of ad_u exceeds this: the series is
/// cheaper and closer up to there (36 brackets of one product each, against 50 products).
const EXACT_FROM: f64 = 3.0;
/// The bound of ad_{u/2^s} from which the halvings start.
const HALVED: f64 = 2.0;
/// dexp counts as singular where an eigenvalue of ad_u is closer to 2πik, k ≠ 0, than about this
/// times max(1, ‖u‖): the condition number of dexp⁻¹ exceeds 1e12 there.
pub(super) const SINGULAR: f64 = 1e-12;

/// What exp keeps at u ∈ 𝔤 ⊂ gl(n): workspaces, and the choices made.
#[derive(Debug)]
pub struct ExpAt {
    expm: Expm,
    powers: Powers,
    scaled: AlgebraMatrix,
    exact: Exact,
    spectrum: Option<Box<AdSchur>>,
    dexpinv: Dexpinv,
    halvings: u32,
}

/// Beyond the reach of the series.
#[derive(Debug)]
enum Exact {
    /// Of a truncated series nothing else is asked.
    None,
    /// Every u of the algebra is skew.
    Eigen(Box<SkewEigen>),
    Schur(Box<AdSchur>),
}

const SINGULAR_AT: StepError =
    StepError::OutsideChart { map: "exp", what: "an eigenvalue of ad_u is a multiple of 2πi" };
const DIVERGES: StepError =
    StepError::OutsideChart { map: "exp", what: "the Baker series of dexp⁻¹ does not converge" };

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
        let make = || Box::new(AdSchur::new(group.n(), group.ad_form()));
        let schur = self.spectrum.get_or_insert_with(make);
        schur.factor(u)?;
        Ok(schur.distance_to_singular())
    }

    pub(super) fn new(group: &MatrixGroup, exact: bool) -> Self {
        let n = group.n();
        ExpAt {
            expm: Expm::new(n),
            powers: Powers { ad: group.zero(), next: group.zero() },
            scaled: group.zero(),
            exact: match exact {
                false => Exact::None,
                true if group.is_skew() => Exact::Eigen(Box::new(SkewEigen::new(n))),
                true => Exact::Schur(Box::new(AdSchur::new(n, group.ad_form()))),
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
        self.dexpinv = self.powers.baker(group, u, Some(q), v)?;
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
            self.dexpinv = self.powers.baker(group, u, None, v)?;
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
                finite(group, v)
            }
            Exact::Schur(schur) => {
                let s = scale_down(u, norm, &mut self.scaled);
                self.dexpinv = self.powers.baker(group, &self.scaled, None, v)?;
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
            Exact::Schur(schur) => {
                let s = scale_down(u, norm, &mut self.scaled);
                self.powers.phi1(group, &self.scaled, v);
                halve(schur, group, u, s, Direction::Forward, v)
            }
        }
    }
}

/// ad_u^k v for one k after the other.
#[derive(Debug)]
struct Powers {
    ad: AlgebraMatrix,
    next: AlgebraMatrix,
}

impl Powers {
    /// Is \[u, v\] = 0 exactly? Then dexp_u v = v.
    fn commute(&mut self, group: &MatrixGroup, u: &AlgebraMatrix, v: &AlgebraMatrix) -> bool {
        group.bracket(u, v, &mut self.next);
        group.norm(&self.next) == 0.0
    }

    fn advance(&mut self, group: &MatrixGroup, u: &AlgebraMatrix) {
        group.bracket(u, &self.ad, &mut self.next);
        core::mem::swap(&mut self.ad, &mut self.next);
    }

    /// v ← Σ_{k ≤ q} B_k/k! ad_u^k v; with `q = None` until the terms vanish in rounding.
    fn baker(
        &mut self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        q: Option<usize>,
        v: &mut AlgebraMatrix,
    ) -> Result<Dexpinv, StepError> {
        self.ad.copy_from(&**v);
        let negligible = 0.25 * f64::EPSILON * group.norm(v);
        let radius = ad_bound(group, u);
        let mut choice = Dexpinv::Series(0);
        for k in 1..=q.unwrap_or(SERIES_MAX) {
            self.advance(group, u);
            if k > 1 && k % 2 == 1 {
                continue; // B_k = 0
            }
            group.axpy(baker(k), &self.ad, v);
            choice = Dexpinv::Series(k);
            if q.is_none() {
                let next = if k == 1 { 2 } else { k + 2 };
                let growth = radius.powi((next - k) as i32);
                if baker(next).abs() * growth * group.norm(&self.ad) <= negligible {
                    return finite(group, v).map(|()| choice);
                }
            }
        }
        match q {
            Some(_) => finite(group, v).map(|()| choice),
            None => Err(DIVERGES),
        }
    }

    /// v ← dexp_u v = Σ ad_u^k v/(k+1)!, until the terms vanish in rounding.
    fn phi1(&mut self, group: &MatrixGroup, u: &AlgebraMatrix, v: &mut AlgebraMatrix) {
        self.ad.copy_from(&**v);
        let negligible = 0.125 * f64::EPSILON * group.norm(v);
        let mut c = 1.0;
        for k in 1..=SERIES_MAX {
            self.advance(group, u);
            c /= (k + 1) as f64;
            group.axpy(c, &self.ad, v);
            if c * group.norm(&self.ad) <= negligible {
                return;
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
    schur.factor(u)?;
    let singular = SINGULAR * group.norm(u).max(1.0);
    schur.halvings(s, direction, singular, v).map_err(|_| SINGULAR_AT)?;
    match group.is_finite(v) {
        true => Ok(()),
        false => Err(StepError::NotFinite { what: "dexp_u or its inverse" }),
    }
}

fn finite(group: &MatrixGroup, v: &AlgebraMatrix) -> Result<(), StepError> {
    match group.is_finite(v) {
        true => Ok(()),
        false => Err(StepError::NotFinite { what: "dexp⁻¹" }),
    }
}

/// A bound of ‖ad_u‖ in the Frobenius norm: 2‖u‖₂ ≤ 2‖u‖_F, and ‖u‖_F on so(n), where the
/// eigenvalues of ad_u are i(±a ± b) with 2(a² + b²) ≤ ‖u‖_F².
pub(super) fn ad_bound(group: &MatrixGroup, u: &AlgebraMatrix) -> f64 {
    match group.form() {
        Form::Identity => group.norm(u),
        _ => 2.0 * group.norm(u),
    }
}

/// φ(z) = z/(eᶻ − 1) at z = −iθ: (θ/2)cot(θ/2) + iθ/2. `norm` is the size of u.
fn phi(theta: f64, norm: f64) -> Result<(f64, f64), StepError> {
    let half = 0.5 * theta;
    if half.abs() < 1e-4 {
        return Ok((1.0 - half * half / 3.0, half));
    }
    let (s, c) = half.sin_cos();
    if 2.0 * s.abs() < SINGULAR * norm.max(1.0) {
        return Err(SINGULAR_AT);
    }
    Ok((half * c / s, half))
}

/// φ₁(z) = (eᶻ − 1)/z at z = −iθ: e^{−iθ/2} sin(θ/2)/(θ/2).
fn phi1(theta: f64) -> (f64, f64) {
    let half = 0.5 * theta;
    let (s, c) = half.sin_cos();
    let sinc = if half.abs() < 1e-4 { 1.0 - half * half / 6.0 } else { s / half };
    (sinc * c, -sinc * s)
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
