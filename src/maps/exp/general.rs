//! exp on n×n matrices.

use core::f64::consts::PI;

use super::{Exp, TruncatedExp};
use crate::dense::{Expm, ExpmChoice, SkewEigen, Structure};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup};
use crate::maps::CoordinateMap;

/// How dexp_u⁻¹ v was computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dexpinv {
    /// Not yet.
    #[default]
    None,
    /// The Baker series up to this power of ad_u.
    Series(usize),
    /// The eigen form on so(n).
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
pub(super) fn baker(k: usize) -> f64 {
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
/// On so(n) the eigen form takes over where the bound of ad_u exceeds this: the series is cheaper
/// and closer up to there (36 brackets of one product each, against 50 products).
const EIGEN_FROM: f64 = 3.0;
/// dexp counts as singular where an eigenvalue of ad_u is closer than this (relatively) to 2πik.
const SINGULAR: f64 = 1e-12;

/// What exp keeps at u ∈ 𝔤 ⊂ gl(n): workspaces, and the choices made.
#[derive(Debug)]
pub struct ExpAt {
    expm: Expm,
    ad: AlgebraMatrix,
    ad_next: AlgebraMatrix,
    eigen: Option<SkewEigen>,
    dexpinv: Dexpinv,
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

    fn new(group: &MatrixGroup, eigen: bool) -> Self {
        ExpAt {
            expm: Expm::new(group.n()),
            ad: group.zero(),
            ad_next: group.zero(),
            eigen: eigen.then(|| SkewEigen::new(group.n())),
            dexpinv: Dexpinv::None,
        }
    }

    fn exp(
        &mut self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        let structure = match group.form() {
            Form::Identity => Structure::Skew,
            _ => Structure::General,
        };
        self.expm.exp(u, structure, g)
    }

    /// v ← Σ_{k ≤ q} B_k/k! ad_u^k v; with `q = None` until the terms vanish in rounding.
    fn series(
        &mut self,
        group: &MatrixGroup,
        u: &AlgebraMatrix,
        q: Option<usize>,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        self.ad.copy_from(&**v);
        let negligible = 0.25 * f64::EPSILON * group.norm(v);
        let radius = ad_bound(group, u);
        for k in 1..=q.unwrap_or(SERIES_MAX) {
            group.bracket(u, &self.ad, &mut self.ad_next);
            core::mem::swap(&mut self.ad, &mut self.ad_next);
            if k > 1 && k % 2 == 1 {
                continue; // B_k = 0
            }
            group.axpy(baker(k), &self.ad, v);
            self.dexpinv = Dexpinv::Series(k);
            if q.is_none() {
                let next = if k == 1 { 2 } else { k + 2 };
                let growth = radius.powi((next - k) as i32);
                if baker(next).abs() * growth * group.norm(&self.ad) <= negligible {
                    return finite(group, v);
                }
            }
        }
        match q {
            Some(_) => finite(group, v),
            None => Err(StepError::OutsideChart {
                map: "exp",
                what: "the Baker series of dexp⁻¹ does not converge",
            }),
        }
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
fn ad_bound(group: &MatrixGroup, u: &AlgebraMatrix) -> f64 {
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
        Ok(ExpAt::new(group, matches!(group.form(), Form::Identity)))
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
        let norm = ad_bound(group, u);
        match &mut at.eigen {
            Some(eigen) if norm > EIGEN_FROM => {
                at.dexpinv = Dexpinv::Eigen;
                eigen.function_of_ad(u, v, |theta| phi(theta, norm))
            }
            _ => at.series(group, u, None, v),
        }
    }
}

/// φ(z) = z/(eᶻ − 1) at z = −iθ: (θ/2)cot(θ/2) + iθ/2. `norm` is the size of u.
fn phi(theta: f64, norm: f64) -> Result<(f64, f64), StepError> {
    let half = 0.5 * theta;
    if half.abs() < 1e-4 {
        return Ok((1.0 - half * half / 3.0, half));
    }
    let (s, c) = half.sin_cos();
    if s.abs() < SINGULAR * norm.max(1.0) {
        return Err(StepError::OutsideChart {
            map: "exp",
            what: "an eigenvalue of ad_u is a multiple of 2πi",
        });
    }
    Ok((half * c / s, half))
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
        at.series(group, u, Some(self.q), v)
    }
    fn order(&self, _: &MatrixGroup) -> usize {
        self.order_kept()
    }
}

/// dexpinv(u, v, q) of Table 1: Σ_{k=0}^{q} B_k/k! ad_u^k v, the truncated series (15), any n.
///
/// `u` and `v` are elements of the algebra of `group`; q brackets. q = 0 returns v. The series
/// converges where the eigenvalues of ad_u are smaller than 2π in modulus; [`Exp`] sums it to
/// rounding and says so where it cannot.
///
/// # Errors
/// [`Error::Map`] when the result is not finite.
pub fn dexpinv(
    group: &MatrixGroup,
    u: &AlgebraMatrix,
    v: &AlgebraMatrix,
    q: usize,
) -> Result<AlgebraMatrix, Error> {
    let (mut at, mut w) = (ExpAt::new(group, false), v.clone());
    at.series(group, u, Some(q), &mut w)?;
    Ok(w)
}
