//! Ψ = exp, canonical coordinates of the first kind (paper 4.1).
//!
//! | | exp(u) | dexp_u⁻¹ |
//! |---|---|---|
//! | any n | Taylor or Padé by cost, scaling and squaring; cos and sin on so(n) | Σ B_k/k! ad_u^k (15); beyond its radius the eigen form on so(n) and u(n), halvings of u in Schur coordinates elsewhere |
//! | so(3) | 𝟙 + (sin α/α) u + ((1−cos α)/α²) u² (14) | 𝟙 − u/2 + ((1−(α/2)cot(α/2))/α²) u² (16) |

#[cfg(feature = "dense")]
mod functions;
#[cfg(feature = "dense")]
mod general;
#[cfg(feature = "dense")]
mod powers;
pub(super) mod se3;
mod series;
mod so3;

#[cfg(feature = "dense")]
pub use functions::{BakerSum, dexpinv_truncated, dexpinv_with_remainder, distance_to_singular};
#[cfg(feature = "dense")]
pub use powers::Dexpinv;
#[cfg(feature = "dense")]
pub(super) use powers::{EXACT_FROM, Powers, phi, phi1};

/// The exponential map with dexp⁻¹ to rounding.
///
/// On n×n matrices dexp⁻¹ is the Baker series summed until its terms vanish in rounding. Beyond the
/// series' useful radius it is the eigen form where u is skew or skew-Hermitian, and elsewhere s halvings
/// dexp_u = dexp_{u/2} ∘ ½(1 + Ad_{exp(u/2)}), exact at any ‖u‖. It is refused where an eigenvalue of
/// ad_u is closer to 2πik, k ≠ 0, than about 1e-12·max(1, ‖u‖); [`distance_to_singular`] tells.
/// Where M is neither symmetric nor skew also where only an eigenvalue of ad_u outside 𝔤 is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exp;

impl Exp {
    /// This map with the Baker series cut after the power q of ad_u, as in Table 1: a method of
    /// order p needs q = p − 2. On so(3) the brackets are cross products.
    pub const fn truncated(self, q: usize) -> TruncatedExp {
        TruncatedExp { q }
    }
}

/// The exponential map with dexp⁻¹ cut after the power q of ad_u: `Exp.truncated(q)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TruncatedExp {
    q: usize,
}

impl TruncatedExp {
    /// The highest power q of ad_u.
    pub const fn q(self) -> usize {
        self.q
    }

    /// The highest order of a method that keeps it with the series cut at q: q + 2, and one more
    /// for even q ≥ 2, because the next coefficient is zero.
    pub const fn order_kept(self) -> usize {
        if self.q >= 2 && self.q.is_multiple_of(2) { self.q + 3 } else { self.q + 2 }
    }
}
