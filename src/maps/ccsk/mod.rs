//! Ψ = ccsk, canonical coordinates of the second kind (paper 4.2).
//!
//! | | ccsk(u) | dccsk_u⁻¹ |
//! |---|---|---|
//! | SO(n) | ∏ of the plane rotations exp(u_rc(e_r e_cᵀ − e_c e_rᵀ)), c = 1 … n−1, r = c+1 … n | column by column, O(n³) |
//! | GL(n) | (𝟙 + U₊) diag(e^{u_ii}) (𝟙 + U₋), U₊ and U₋ the strict triangles of u | triangular products, O(n³) |
//! | Sp(2m) | \[𝟙 B; 0 𝟙\] diag(L, L⁻ᵀ) \[𝟙 0; C 𝟙\], u = \[A B; C −Aᵀ\], L the GL(m) chart of A | the same, in blocks |
//! | so(3) | exp(u_i e_i) exp(u_j e_j) exp(u_k e_k) for an ordering ijk | the matrix (18), in the axes ijk |
//!
//! At n = 3 the ordered basis of SO(n) is e₃, −e₂, e₁: the ordering 321 of the paper. It is
//! [`CCSK321`] for every n. [`CCSK123`] is its reverse: Ψ₁₂₃(u) = Ψ₃₂₁(−u)⁻¹. On GL(n) and Sp(2m)
//! the two names mean the product above and its reverse; their dΨ⁻¹ is never singular. A general
//! G_M has no basis with cheap factors.

#[cfg(feature = "dense")]
mod general;
#[cfg(feature = "dense")]
mod gl;
mod so3;
#[cfg(feature = "dense")]
mod so_n;
#[cfg(feature = "dense")]
mod sp;

/// Canonical coordinates of the second kind with the basis ordered e_I, e_J, e_K (from 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ccsk<const I: usize, const J: usize, const K: usize> {
    min_cos: f64,
}

/// The ordering 123 (ccskf of the paper).
pub const CCSK123: Ccsk<0, 1, 2> = Ccsk::new();
/// The ordering 321 (ccskb of the paper).
pub const CCSK321: Ccsk<2, 1, 0> = Ccsk::new();

const NAMES: [[[&str; 3]; 3]; 3] = {
    let mut names = [[["ccsk"; 3]; 3]; 3];
    names[0][1][2] = "ccsk123";
    names[0][2][1] = "ccsk132";
    names[1][0][2] = "ccsk213";
    names[1][2][0] = "ccsk231";
    names[2][0][1] = "ccsk312";
    names[2][1][0] = "ccsk321";
    names
};

impl<const I: usize, const J: usize, const K: usize> Ccsk<I, J, K> {
    /// The map, with dccsk⁻¹ refused where |cos| of the middle angle is below 1e-4.
    pub const fn new() -> Self {
        const { assert!(I < 3 && J < 3 && K < 3 && I != J && J != K && K != I) };
        Ccsk { min_cos: 1e-4 }
    }

    /// The map with another bound on |cos|. The bound 0 gives the raw formula up to its singularity.
    pub const fn with_min_cos(min_cos: f64) -> Self {
        Ccsk { min_cos }
    }
}

impl<const I: usize, const J: usize, const K: usize> Default for Ccsk<I, J, K> {
    fn default() -> Self {
        Self::new()
    }
}
