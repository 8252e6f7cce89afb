//! The maps on U(n).
//!
//! | | Ψ(u) | dΨ_u⁻¹ v |
//! |---|---|---|
//! | exp | scaled Taylor polynomials on u(n) | Σ B_k/k! ad_u^k v (15); the eigen form where ‖u‖ > 2.1 |
//! | cay | (𝟙 − u/2)⁻¹(𝟙 + u/2) | (𝟙 − u/2) v (𝟙 + u/2) |
//!
//! dexp⁻¹ is as on so(n): with iu = QΛQ*, (Q*(dexp_u⁻¹v)Q)_jk = φ(−i(λ_j − λ_k))·(Q*vQ)_jk, exact at
//! any ‖u‖, and refused where a difference of eigenvalues is within about 1e-12·max(1, ‖u‖) of 2πk.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{Mat, Par, c64};

use super::exp::{Dexpinv, EXACT_FROM, Powers, phi, phi1};
use super::functions::DexpGroup;
use super::named::{ExpOrCay, MapsByName};
use super::{Cay, CoordinateMap, Exp};
use crate::dense::{ComplexExponential, SkewEigen, Structure};
use crate::error::{Error, StepError};
use crate::groups::{ComplexMatrix, LieAlgebra, LieGroup, Unitary, mul_complex};
use crate::scalar::{Ops, tally};
use crate::space::{LinearSpace, Metric};

/// Above this norm no digit of cay(u) has a meaning.
const NORM_MAX: f64 = 1e15;
/// Above this norm of u the solve has lost more than rounding of the group.
const NORM_EXACT: f64 = 4.0;

/// One correction takes a residual below this to rounding.
const ONE_STEP: f64 = 1e-8;
/// From a residual of 0.1 on four are needed.
const CORRECTIONS_MAX: usize = 6;

/// The values that exp stores on U(n): workspaces, and how the last dexp⁻¹ was computed.
#[derive(Debug)]
pub struct UnitaryExpAt {
    exponential: ComplexExponential,
    u: Mat<c64>,
    /// exp(u), or v.
    g: Mat<c64>,
    powers: Powers<ComplexMatrix>,
    eigen: SkewEigen,
    dexpinv: Dexpinv,
}

impl UnitaryExpAt {
    /// How the last dexp⁻¹ was computed.
    pub fn dexpinv_choice(&self) -> Dexpinv {
        self.dexpinv
    }

    /// v ← dexp_u v to rounding at any ‖u‖: right trivialised, d/dε exp(u + εv)|₀ = dexp_u(v)·exp(u).
    ///
    /// # Errors
    /// [`StepError::NormTooLarge`], [`StepError::NotFinite`], [`StepError::NotConverged`].
    pub fn dexp(
        &mut self,
        group: &Unitary,
        u: &ComplexMatrix,
        v: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
        group.fits("u", u)?;
        group.fits("v", v)?;
        let radius = ad_bound(u, "u in dexp_u(v)")?;
        if radius <= EXACT_FROM {
            self.powers.ad.assign(v);
            self.powers.phi1(group, u, v);
        } else if !self.powers.commute(group, u, v) {
            self.eigen(u, v, |theta| Ok(phi1(theta)))?;
        }
        finite(v, "dexp_u")
    }

    /// The smallest distance of an eigenvalue of ad_u to the singular set 2πik, k ≠ 0, of dexp_u, as
    /// [`ExpAt::distance_to_singular`](super::ExpAt::distance_to_singular).
    ///
    /// # Errors
    /// [`StepError::NotFinite`], [`StepError::NotConverged`].
    pub fn distance_to_singular(&mut self, u: &ComplexMatrix) -> Result<f64, StepError> {
        finite(u, "u in dexp_u")?;
        join(u, &mut self.u);
        self.eigen.distance_to_singular(&self.u)
    }

    /// v ← φ(ad_u) v by the eigenvectors of u.
    fn eigen(
        &mut self,
        u: &ComplexMatrix,
        v: &mut ComplexMatrix,
        phi: impl Fn(f64) -> Result<(f64, f64), StepError>,
    ) -> Result<(), StepError> {
        join(u, &mut self.u);
        join(v, &mut self.g);
        self.eigen.function_of_complex_ad(&self.u, &mut self.g, phi)?;
        split(&self.g, v);
        Ok(())
    }
}

/// A bound of ‖ad_u‖ in the Frobenius norm: |λ_j − λ_k| ≤ √2·‖u‖. `what` names u in words.
fn ad_bound(u: &ComplexMatrix, what: &'static str) -> Result<f64, StepError> {
    let bound = core::f64::consts::SQRT_2 * u.size();
    if bound.is_finite() {
        return Ok(bound);
    }
    finite(u, what)?;
    Err(StepError::NormTooLarge { map: "exp" })
}

impl CoordinateMap<Unitary> for Exp {
    type At = UnitaryExpAt;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, group: &Unitary) -> Result<UnitaryExpAt, Error> {
        let n = group.n();
        Ok(UnitaryExpAt {
            exponential: ComplexExponential::new(n),
            u: Mat::zeros(n, n),
            g: Mat::zeros(n, n),
            powers: Powers::new(|| group.zero()),
            eigen: SkewEigen::new(n),
            dexpinv: Dexpinv::None,
        })
    }
    fn psi(
        &self,
        group: &Unitary,
        u: &ComplexMatrix,
        at: &mut UnitaryExpAt,
        g: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
        group.fits("u", u)?;
        join(u, &mut at.u);
        at.exponential.exp(&at.u, Structure::Skew, &mut at.g)?;
        split(&at.g, g);
        Ok(())
    }
    fn dpsi_inv(
        &self,
        group: &Unitary,
        u: &ComplexMatrix,
        at: &mut UnitaryExpAt,
        v: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
        group.fits("u", u)?;
        group.fits("v", v)?;
        let radius = ad_bound(u, "u in dexp⁻¹")?;
        if radius <= EXACT_FROM {
            at.powers.ad.assign(v);
            at.dexpinv = at.powers.baker(group, u, radius, None, v)?;
        } else if at.powers.commute(group, u, v) {
            at.dexpinv = Dexpinv::Series(1);
        } else {
            at.dexpinv = Dexpinv::Eigen;
            at.eigen(u, v, |theta| phi(theta, radius))?;
        }
        finite(v, "dexp⁻¹")
    }
}

/// The values that cay stores on U(n): 𝟙 ± u/2 and the factors of 𝟙 − u/2.
#[derive(Debug)]
pub struct UnitaryCayAt {
    minus: ComplexMatrix,
    plus: ComplexMatrix,
    product: ComplexMatrix,
    lu: ComplexLu,
}

impl CoordinateMap<Unitary> for Cay {
    type At = UnitaryCayAt;

    fn name(&self) -> &'static str {
        "cay"
    }
    fn at(&self, group: &Unitary) -> Result<UnitaryCayAt, Error> {
        let zero = || group.zero();
        let lu = ComplexLu::new(group.n());
        Ok(UnitaryCayAt { minus: zero(), plus: zero(), product: zero(), lu })
    }
    fn psi(
        &self,
        group: &Unitary,
        u: &ComplexMatrix,
        at: &mut UnitaryCayAt,
        g: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
        group.fits("u", u)?;
        finite(u, "u in cay(u)")?;
        let norm = u.size();
        if norm > NORM_MAX {
            return Err(StepError::NormTooLarge { map: "cay" });
        }
        let UnitaryCayAt { minus, plus, product, lu } = at;
        for (x, half) in [(&mut *minus, -0.5), (&mut *plus, 0.5)] {
            x.clear();
            x.add(half, u);
            tally(|| Ops::adds(group.n()));
            x.re.diagonal_mut().column_vector_mut().iter_mut().for_each(|d| *d += 1.0);
        }
        lu.solve(minus, plus);
        split(&lu.b, g);
        if norm > NORM_EXACT {
            // Each time the residual is squared; what a solve without digits leaves does not converge.
            let mut residual = f64::INFINITY;
            for _ in 0..CORRECTIONS_MAX {
                residual = group.correct(g, [&mut *product, &mut *minus]);
                if residual <= ONE_STEP {
                    break;
                }
            }
            if residual.is_nan() || residual > ONE_STEP {
                let (what, rcond) = ("𝟙 − u/2", 1.0 / (1.0 + 0.5 * norm));
                return Err(StepError::NearlySingular { map: "cay", what, rcond });
            }
            minus.clear();
            minus.add(-0.5, u);
            minus.re.diagonal_mut().column_vector_mut().iter_mut().for_each(|d| *d += 1.0);
        }
        finite(g, "cay(u)")
    }
    fn dpsi_inv(
        &self,
        group: &Unitary,
        _: &ComplexMatrix,
        UnitaryCayAt { minus, plus, product, .. }: &mut UnitaryCayAt,
        v: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
        group.fits("v", v)?;
        mul_complex(product, minus, v);
        mul_complex(v, product, plus);
        finite(v, "dcay⁻¹")
    }
}

/// a⁻¹b by an LU with partial pivoting.
struct ComplexLu {
    a: Mat<c64>,
    b: Mat<c64>,
    perm: Vec<usize>,
    perm_inv: Vec<usize>,
    mem: MemBuffer,
}

impl core::fmt::Debug for ComplexLu {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("ComplexLu").finish_non_exhaustive()
    }
}

impl ComplexLu {
    fn new(n: usize) -> Self {
        let req = factor::lu_in_place_scratch::<usize, c64>(n, n, Par::Seq, Default::default())
            .or(solve::solve_in_place_scratch::<usize, c64>(n, n, Par::Seq));
        let (perm, perm_inv) = (vec![0; n], vec![0; n]);
        ComplexLu {
            a: Mat::zeros(n, n),
            b: Mat::zeros(n, n),
            perm,
            perm_inv,
            mem: MemBuffer::new(req),
        }
    }

    /// self.b ← a⁻¹b. In cay a = 𝟙 − u/2 is regular: its eigenvalues are 1 − iα/2.
    fn solve(&mut self, a: &ComplexMatrix, b: &ComplexMatrix) {
        // As in `Lu`, in complex numbers.
        let n = self.a.nrows();
        let below = n * n.saturating_sub(1) / 2;
        let factor = below * (2 * n).saturating_sub(1) / 3;
        tally(|| Ops::complex_muladds(factor + n * n * n) + Ops::divs(6 * n));
        join(a, &mut self.a);
        join(b, &mut self.b);
        let stack = MemStack::new(&mut self.mem);
        let (perm, perm_inv) = (&mut self.perm, &mut self.perm_inv);
        factor::lu_in_place(self.a.as_mut(), perm, perm_inv, Par::Seq, stack, Default::default());
        let perm = PermRef::new_checked(&self.perm, &self.perm_inv, self.a.nrows());
        let stack = MemStack::new(&mut self.mem);
        solve::solve_in_place(
            self.a.as_ref(),
            self.a.as_ref(),
            perm,
            self.b.as_mut(),
            Par::Seq,
            stack,
        );
    }
}

/// Both parts together.
fn join(x: &ComplexMatrix, out: &mut Mat<c64>) {
    for j in 0..out.ncols() {
        let parts = x.re.col_as_slice(j).iter().zip(x.im.col_as_slice(j));
        out.col_as_slice_mut(j).iter_mut().zip(parts).for_each(|(z, (a, b))| *z = c64::new(*a, *b));
    }
}

/// The parts apart.
fn split(x: &Mat<c64>, out: &mut ComplexMatrix) {
    for j in 0..x.ncols() {
        let parts = out.re.col_as_slice_mut(j).iter_mut().zip(out.im.col_as_slice_mut(j));
        x.col_as_slice(j).iter().zip(parts).for_each(|(z, (a, b))| (*a, *b) = (z.re, z.im));
    }
}

fn finite(x: &ComplexMatrix, what: &'static str) -> Result<(), StepError> {
    if LinearSpace::is_finite(x) { Ok(()) } else { Err(StepError::NotFinite { what }) }
}

impl DexpGroup for Unitary {
    fn dexp_of(&self, u: &ComplexMatrix, v: &ComplexMatrix) -> Result<ComplexMatrix, Error> {
        let mut w = v.clone();
        CoordinateMap::<Unitary>::at(&Exp, self)?.dexp(self, u, &mut w)?;
        Ok(w)
    }
}

impl MapsByName for Unitary {
    type Map = ExpOrCay;
}
