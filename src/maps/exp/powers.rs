//! dexp and dexp⁻¹ on any algebra: the series in ad_u, and the functions of its eigenvalues.
//!
//! | | Σ over the powers of ad_u | at the eigenvalue −iθ of ad_u |
//! |---|---|---|
//! | dexp_u | ad_u^k/(k+1)! | φ₁(−iθ) = e^{−iθ/2} sin(θ/2)/(θ/2) |
//! | dexp_u⁻¹ | (B_k/k!) ad_u^k (15) | φ(−iθ) = (θ/2)cot(θ/2) + iθ/2 |

use super::series::baker;
use crate::error::StepError;
use crate::groups::LieAlgebra;

/// How dexp_u⁻¹ v was computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dexpinv {
    /// Not yet.
    #[default]
    None,
    /// The Baker series up to this power of ad_u; of ad_{u/2^s} where u was halved s times.
    Series(usize),
    /// The eigen form, where u is skew.
    Eigen,
}

/// The last k with a coefficient B_k/k! of the Baker series that is not 0 in f64, rounded up.
pub(super) const COEFFICIENTS: usize = 410;

/// The longest series that is summed before it counts as divergent: at half the radius of
/// convergence its remainder is below rounding.
const SERIES_MAX: usize = 52;
/// The eigen form or the halvings take over where the bound of ad_u exceeds this: the series is
/// cheaper and closer up to there (36 brackets of one product each, against 50 products).
pub(in crate::maps) const EXACT_FROM: f64 = 3.0;
/// dexp counts as singular where an eigenvalue of ad_u is closer to 2πik, k ≠ 0, than about this
/// times max(1, ‖u‖): the condition number of dexp⁻¹ exceeds 1e12 there.
pub(super) const SINGULAR: f64 = 1e-12;

pub(super) const SINGULAR_AT: StepError =
    StepError::OutsideChart { map: "exp", what: "an eigenvalue of ad_u is a multiple of 2πi" };
pub(super) const DIVERGES: StepError =
    StepError::OutsideChart { map: "exp", what: "the Baker series of dexp⁻¹ does not converge" };

/// ad_u^k v for one k after the other.
#[derive(Debug)]
pub(in crate::maps) struct Powers<A> {
    /// ad_u^k v: whoever sums a series puts v here first.
    pub(in crate::maps) ad: A,
    next: A,
}

impl<A: Clone> Powers<A> {
    pub(in crate::maps) fn new(zero: impl Fn() -> A) -> Self {
        Powers { ad: zero(), next: zero() }
    }

    /// Is \[u, v\] = 0 exactly? Then dexp_u v = v.
    pub(in crate::maps) fn commute<G>(&mut self, group: &G, u: &A, v: &A) -> bool
    where
        G: LieAlgebra<Scalar = f64, Alg = A>,
    {
        group.bracket(u, v, &mut self.next);
        group.norm(&self.next) == 0.0
    }

    fn advance<G: LieAlgebra<Scalar = f64, Alg = A>>(&mut self, group: &G, u: &A) {
        group.bracket(u, &self.ad, &mut self.next);
        core::mem::swap(&mut self.ad, &mut self.next);
    }

    /// v ← Σ_{k ≤ q} B_k/k! ad_u^k v; with `q = None` until the terms vanish in rounding, where
    /// ‖ad_u‖ ≤ `radius`.
    pub(in crate::maps) fn baker<G: LieAlgebra<Scalar = f64, Alg = A>>(
        &mut self,
        group: &G,
        u: &A,
        radius: f64,
        q: Option<usize>,
        v: &mut A,
    ) -> Result<Dexpinv, StepError> {
        let negligible = 0.25 * f64::EPSILON * group.norm(v);
        let mut choice = Dexpinv::Series(0);
        // Beyond it the coefficients are 0 in f64.
        for k in 1..=q.map_or(SERIES_MAX, |q| q.min(COEFFICIENTS)) {
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
                    return finite(group, v, "dexp⁻¹").map(|()| choice);
                }
            }
        }
        match q {
            Some(_) => finite(group, v, "dexp⁻¹").map(|()| choice),
            None => Err(DIVERGES),
        }
    }

    /// v ← dexp_u v = Σ ad_u^k v/(k+1)!, until the terms vanish in rounding.
    pub(in crate::maps) fn phi1<G: LieAlgebra<Scalar = f64, Alg = A>>(
        &mut self,
        group: &G,
        u: &A,
        v: &mut A,
    ) {
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

/// An error unless every number of v is finite.
pub(in crate::maps) fn finite<G: LieAlgebra>(
    group: &G,
    v: &G::Alg,
    what: &'static str,
) -> Result<(), StepError> {
    if group.is_finite(v) { Ok(()) } else { Err(StepError::NotFinite { what }) }
}

/// (Re, Im) of φ(z) = z/(eᶻ − 1) at z = −iθ. `norm` is the size of u.
pub(in crate::maps) fn phi(theta: f64, norm: f64) -> Result<(f64, f64), StepError> {
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

/// (Re, Im) of φ₁(z) = (eᶻ − 1)/z at z = −iθ.
pub(in crate::maps) fn phi1(theta: f64) -> (f64, f64) {
    let half = 0.5 * theta;
    let (s, c) = half.sin_cos();
    let sinc = if half.abs() < 1e-4 { 1.0 - half * half / 6.0 } else { s / half };
    (sinc * c, -sinc * s)
}
