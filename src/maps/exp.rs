//! Ψ = exp, canonical coordinates of the first kind (paper 4.1).
//!
//! | | exp(u) | dexp_u⁻¹ |
//! |---|---|---|
//! | any n | Padé, scaling and squaring | Σ B_k/k! ad_u^k (15); on so(n) beyond its radius the eigen form |
//! | so(3) | 𝟙 + (sin α/α) u + ((1−cos α)/α²) u² (14) | 𝟙 − u/2 + ((1−(α/2)cot(α/2))/α²) u² (16) |

use core::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use super::CoordinateMap;
use crate::dense::{Expm, ExpmChoice, SkewEigen, Structure};
use crate::error::{Error, StepError};
use crate::groups::{AlgebraMatrix, Form, GroupMatrix, LieAlgebra, MatrixGroup, So3, cross};
use crate::scalar::{Real, Trig};

/// The exponential map with dexp⁻¹ to rounding.
///
/// On n×n matrices dexp⁻¹ is the Baker series summed until its terms vanish in rounding; on so(n)
/// beyond the series' useful radius it is the eigen form, exact at any ‖u‖.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exp;

impl Exp {
    /// The same map with the Baker series cut after the power q of ad_u, as in Table 1: a method of
    /// order p needs q = p − 2. The closed form on so(3) has no series to cut.
    pub const fn truncated(self, q: usize) -> TruncatedExp {
        TruncatedExp { q }
    }
}

/// The exponential map with dexp⁻¹ cut after the power q of ad_u: `Exp.truncated(q)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TruncatedExp {
    q: usize,
}

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

// ---- so(3), closed form ---------------------------------------------------------------------

/// What exp keeps at u ∈ so(3): α² = ‖û‖² and, from [`SERIES`] on, α, sin(α/2), cos(α/2).
#[derive(Clone, Copy, Debug)]
pub struct At3<S> {
    alpha2: S,
    alpha: S,
    sin_half: S,
    cos_half: S,
}

/// Below this α² all coefficients are series: no root, no division, no trigonometric function.
const SERIES: f64 = 0.25;
/// Above this coefficient dexp⁻¹ is singular: the condition number there exceeds 1e12.
const COEFFICIENT_MAX: f64 = 1e12;
/// Above this α² the squares of the closed forms overflow.
pub(super) const SQUARE_MAX: f64 = 1e300;

/// sin α/α by α².
#[rustfmt::skip]
const SINC: [f64; 8] = [
    1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362880.0, -1.0 / 39916800.0,
    1.0 / 6227020800.0, -1.0 / 1307674368000.0,
];
/// (1 − cos α)/α² by α².
#[rustfmt::skip]
const COSC: [f64; 8] = [
    0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40320.0, 1.0 / 3628800.0, -1.0 / 479001600.0,
    1.0 / 87178291200.0, -1.0 / 20922789888000.0,
];
/// (1 − (α/2)cot(α/2))/α² by α²: |B_2k|/(2k)!.
#[rustfmt::skip]
const COTC: [f64; 8] = [
    1.0 / 12.0, 1.0 / 720.0, 1.0 / 30240.0, 1.0 / 1209600.0, 1.0 / 47900160.0,
    691.0 / 1307674368000.0, 1.0 / 74724249600.0, 3617.0 / 10670622842880000.0,
];

impl<S: Trig> At3<S> {
    fn new() -> Self {
        let (o, i) = (S::lit(0.0), S::lit(1.0));
        At3 { alpha2: o, alpha: o, sin_half: o, cos_half: i }
    }

    /// Remember α; return a = sin α/α and b = (1 − cos α)/α².
    #[inline(always)]
    fn fill(&mut self, u: &Vector3<S>) -> Result<(S, S), StepError> {
        let l = S::lit;
        let alpha2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        if !alpha2.all_below(SQUARE_MAX) {
            return Err(StepError::NormTooLarge { map: "exp" });
        }
        let [a, b, alpha, sin_half, cos_half] = alpha2.branch(
            SERIES,
            || [estrin(alpha2, &SINC), estrin(alpha2, &COSC), l(0.0), l(0.0), l(1.0)],
            || {
                let alpha = alpha2.sqrt();
                let (s, c) = (l(0.5) * alpha).sin_cos();
                let k = l(2.0) * s / alpha; // sin(α/2)/(α/2)
                [k * c, l(0.5) * k * k, alpha, s, c]
            },
        );
        *self = At3 { alpha2, alpha, sin_half, cos_half };
        Ok((a, b))
    }

    /// (1 − (α/2)cot(α/2))/α².
    #[inline(always)]
    fn dexpinv_coefficient(&self) -> S {
        let l = S::lit;
        let [c] = self.alpha2.branch(
            SERIES,
            || [estrin(self.alpha2, &COTC)],
            || [(l(1.0) - l(0.5) * self.alpha * self.cos_half / self.sin_half) / self.alpha2],
        );
        c
    }
}

/// Σ c_k x^k in Estrin's order: a step waits for the longest chain of operations, and Horner's is
/// three times as long.
#[inline(always)]
fn estrin<S: Real>(x: S, c: &[f64; 8]) -> S {
    let pair = |k: usize| S::lit(c[k]) + S::lit(c[k + 1]) * x;
    let x2 = x * x;
    (pair(0) + pair(2) * x2) + (pair(4) + pair(6) * x2) * (x2 * x2)
}

impl<S: Trig> CoordinateMap<So3<S>> for Exp {
    type At = At3<S>;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, _: &So3<S>) -> Result<At3<S>, Error> {
        Ok(At3::new())
    }
    #[inline]
    fn psi(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        let (a, b) = at.fill(u)?;
        *g = rodrigues(u, a, b);
        Ok(())
    }
    #[inline]
    fn psi_on(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        _: &mut Matrix3<S>,
        x: &Vector3<S>,
        y: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let (a, b) = at.fill(u)?;
        *y = rodrigues_on(u, a, b, x);
        Ok(())
    }
    #[inline]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let c = at.dexpinv_coefficient();
        if !c.all_below(COEFFICIENT_MAX) {
            return Err(StepError::OutsideChart {
                map: "exp",
                what: "dexp is singular at ‖u‖ = 2πk",
            });
        }
        *v = rodrigues_on(u, S::lit(-0.5), c, v);
        Ok(())
    }
}

/// 𝟙 + a·u + b·u², u ∈ so(3).
#[inline(always)]
pub(super) fn rodrigues<S: Real>(u: &Vector3<S>, a: S, b: S) -> Matrix3<S> {
    let (x, y, z) = (u[0], u[1], u[2]);
    let (ax, ay, az) = (a * x, a * y, a * z);
    let (bx, by, bz) = (b * x, b * y, b * z);
    let (bxy, bxz, byz) = (bx * y, bx * z, by * z);
    let (bxx, byy, bzz) = (bx * x, by * y, bz * z);
    let one = S::lit(1.0);
    #[rustfmt::skip]
    let g = Matrix3::new(
        one - (byy + bzz), bxy - az, bxz + ay,
        bxy + az, one - (bxx + bzz), byz - ax,
        bxz - ay, byz + ax, one - (bxx + byy),
    );
    g
}

/// (𝟙 + a·u + b·u²)·x by two cross products.
#[inline(always)]
pub(super) fn rodrigues_on<S: Real>(u: &Vector3<S>, a: S, b: S, x: &Vector3<S>) -> Vector3<S> {
    let ux = cross(u, x);
    let uux = cross(u, &ux);
    Vector3::new(
        x[0] + a * ux[0] + b * uux[0],
        x[1] + a * ux[1] + b * uux[1],
        x[2] + a * ux[2] + b * uux[2],
    )
}

impl<S: Trig> CoordinateMap<So3<S>> for TruncatedExp {
    type At = At3<S>;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, group: &So3<S>) -> Result<At3<S>, Error> {
        Exp.at(group)
    }
    #[inline]
    fn psi(
        &self,
        group: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        g: &mut Matrix3<S>,
    ) -> Result<(), StepError> {
        Exp.psi(group, u, at, g)
    }
    #[inline]
    fn psi_on(
        &self,
        group: &So3<S>,
        u: &Vector3<S>,
        at: &mut At3<S>,
        g: &mut Matrix3<S>,
        x: &Vector3<S>,
        y: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        Exp.psi_on(group, u, at, g, x, y)
    }
    #[inline]
    fn dpsi_inv(
        &self,
        _: &So3<S>,
        u: &Vector3<S>,
        _: &mut At3<S>,
        v: &mut Vector3<S>,
    ) -> Result<(), StepError> {
        let mut ad = *v;
        for k in 1..=self.q {
            ad = cross(u, &ad);
            let c = S::lit(baker(k));
            if k == 1 || k % 2 == 0 {
                *v = Vector3::new(v[0] + c * ad[0], v[1] + c * ad[1], v[2] + c * ad[2]);
            }
        }
        Ok(())
    }
    fn order(&self, _: &So3<S>) -> usize {
        self.order_kept()
    }
}

// ---- any n ----------------------------------------------------------------------------------

/// B_k/k! for even k, by ζ(k): B_2m/(2m)! = (−1)^(m+1)·2ζ(2m)/(2π)^2m; and −1/2 for k = 1.
#[rustfmt::skip]
const BAKER: [f64; 13] = [
    1.0, 1.0 / 12.0, -1.0 / 720.0, 1.0 / 30240.0, -1.0 / 1209600.0, 1.0 / 47900160.0,
    -691.0 / 1307674368000.0, 1.0 / 74724249600.0, -3617.0 / 10670622842880000.0,
    43867.0 / 5109094217170944000.0, -174611.0 / 802857662698291200000.0,
    77683.0 / 14101100039391805440000.0, -236364091.0 / 1693824136731743669452800000.0,
];

/// B_k/k!, the coefficient of ad_u^k.
fn baker(k: usize) -> f64 {
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
                    return Ok(());
                }
            }
        }
        match q {
            Some(_) => Ok(()),
            None => Err(StepError::OutsideChart {
                map: "exp",
                what: "the Baker series of dexp⁻¹ does not converge",
            }),
        }
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

impl TruncatedExp {
    /// The highest order of a method that keeps it with the series cut at q: q + 2, and one more
    /// for even q ≥ 2, because the next coefficient is zero.
    fn order_kept(self) -> usize {
        if self.q >= 2 && self.q.is_multiple_of(2) { self.q + 3 } else { self.q + 2 }
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
    match group.is_finite(&w) {
        true => Ok(w),
        false => Err(StepError::NotFinite { what: "dexpinv(u, v, q)" }.into()),
    }
}
