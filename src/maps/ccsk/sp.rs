//! ccsk on Sp(2m): Ψ(u) = \[𝟙 B; 0 𝟙\]·diag(L, L⁻ᵀ)·\[𝟙 0; C 𝟙\] for u = \[A B; C −Aᵀ\], L the GL(m)
//! chart of A.
//!
//! With X = \[𝟙 B; 0 𝟙\]⁻¹ w \[𝟙 B; 0 𝟙\]: dΨ_u⁻¹ w has the blocks A: dL_A⁻¹ X₁₁, B: X₁₂,
//! C: Lᵀ X₂₁ L.
//!
//! The reversed ordering is \[𝟙 0; C 𝟙\]·diag(K, K⁻ᵀ)·\[𝟙 B; 0 𝟙\], K the reversed GL(m) chart of A. With
//! X = \[𝟙 0; C 𝟙\]⁻¹ w \[𝟙 0; C 𝟙\] the blocks are A: dK_A⁻¹ X₁₁, B: K⁻¹ X₁₂ K⁻ᵀ, C: X₂₁.

use faer::Mat;

use super::gl::{self, Gl};
use crate::dense::{mul, mul_add};
use crate::scalar::{Ops, tally};

/// The blocks of u, L, and workspace; m×m each.
#[derive(Debug)]
pub(super) struct Sp {
    gl: Gl,
    a: Mat<f64>,
    b: Mat<f64>,
    c: Mat<f64>,
    l: Mat<f64>,
    inverse: Mat<f64>,
    x: [Mat<f64>; 3],
}

impl Sp {
    pub(super) fn new(n: usize) -> Self {
        let m = n / 2;
        let z = || Mat::zeros(m, m);
        Sp { gl: Gl::new(m), a: z(), b: z(), c: z(), l: z(), inverse: z(), x: [z(), z(), z()] }
    }

    /// g ← Ψ(u) = \[L + B L⁻ᵀ C, B L⁻ᵀ; L⁻ᵀ C, L⁻ᵀ\].
    pub(super) fn psi(&mut self, u: &Mat<f64>, g: &mut Mat<f64>) {
        let Sp { gl, a, b, c, l, inverse, x } = self;
        let m = a.nrows();
        a.copy_from(u.submatrix(0, 0, m, m));
        b.copy_from(u.submatrix(0, m, m, m));
        c.copy_from(u.submatrix(m, 0, m, m));
        gl.psi(a, l);
        gl::inverse(a, inverse);
        let [bl, lc, full] = x;
        mul(bl, b.as_ref(), inverse.transpose());
        mul(lc, inverse.transpose(), c.as_ref());
        full.copy_from(&*l);
        mul_add(full, 1.0, bl.as_ref(), c.as_ref());
        g.submatrix_mut(0, 0, m, m).copy_from(&*full);
        g.submatrix_mut(0, m, m, m).copy_from(&*bl);
        g.submatrix_mut(m, 0, m, m).copy_from(&*lc);
        g.submatrix_mut(m, m, m, m).copy_from(inverse.transpose());
    }

    /// v ← dΨ_u⁻¹ v at the u of the last [`psi`](Self::psi).
    pub(super) fn dpsi_inv(&mut self, v: &mut Mat<f64>) {
        let Sp { gl, a, b, l, x, .. } = self;
        let m = a.nrows();
        let [x11, x12, x21] = x;
        x21.copy_from(v.submatrix(m, 0, m, m));
        // X₁₁ = v₁₁ − B v₂₁, X₁₂ = (v₁₁ − B v₂₁) B + v₁₂ − B v₂₂, X₂₁ = v₂₁.
        x11.copy_from(v.submatrix(0, 0, m, m));
        mul_add(x11, -1.0, b.as_ref(), x21.as_ref());
        x12.copy_from(v.submatrix(0, m, m, m));
        mul_add(x12, 1.0, x11.as_ref(), b.as_ref());
        mul_add(x12, -1.0, b.as_ref(), v.submatrix(m, m, m, m));
        gl.dpsi_inv(a, x11);
        set_diagonal_blocks(v, x11);
        set_symmetric_block(v, (0, m), x12);
        mul(x11, l.transpose(), x21.as_ref());
        mul(x12, x11.as_ref(), l.as_ref());
        set_symmetric_block(v, (m, 0), x12);
    }

    /// v ← dΨ_u⁻¹ v of the reversed ordering, at the −u of the last [`psi`](Self::psi): L there is K⁻¹ here.
    pub(super) fn dpsi_inv_reversed(&mut self, v: &mut Mat<f64>) {
        let Sp { gl, a, c, l, x, .. } = self;
        let m = a.nrows();
        let [x11, x12, x21] = x;
        // With c = −C: X₁₁ = v₁₁ − v₁₂ c, X₂₁ = c X₁₁ + v₂₁ − v₂₂ c, X₁₂ = v₁₂.
        x12.copy_from(v.submatrix(0, m, m, m));
        x11.copy_from(v.submatrix(0, 0, m, m));
        mul_add(x11, -1.0, x12.as_ref(), c.as_ref());
        x21.copy_from(v.submatrix(m, 0, m, m));
        mul_add(x21, 1.0, c.as_ref(), x11.as_ref());
        mul_add(x21, -1.0, v.submatrix(m, m, m, m), c.as_ref());
        set_symmetric_block(v, (m, 0), x21);
        gl.dpsi_inv_reversed(a, x11);
        set_diagonal_blocks(v, x11);
        mul(x11, l.as_ref(), x12.as_ref());
        mul(x12, x11.as_ref(), l.transpose());
        set_symmetric_block(v, (0, m), x12);
    }
}

/// The blocks A and −Aᵀ of v.
fn set_diagonal_blocks(v: &mut Mat<f64>, a: &Mat<f64>) {
    let m = a.nrows();
    for j in 0..m {
        for i in 0..m {
            v[(i, j)] = a[(i, j)];
            v[(j + m, i + m)] = -a[(i, j)];
        }
    }
}

/// The block of v that begins at this row and column ← the symmetric part of x.
fn set_symmetric_block(v: &mut Mat<f64>, (row, column): (usize, usize), x: &Mat<f64>) {
    let m = x.nrows();
    tally(|| Ops::muladds(m * m));
    for j in 0..m {
        for i in 0..m {
            v[(row + i, column + j)] = 0.5 * (x[(i, j)] + x[(j, i)]);
        }
    }
}

/// g ← h⁻¹ = \[dᵀ −bᵀ; −cᵀ aᵀ\] for a symplectic h = \[a b; c d\].
pub(super) fn inverse(h: &Mat<f64>, g: &mut Mat<f64>) {
    let m = h.nrows() / 2;
    for j in 0..m {
        for i in 0..m {
            g[(i, j)] = h[(j + m, i + m)];
            g[(i, j + m)] = -h[(j, i + m)];
            g[(i + m, j)] = -h[(j + m, i)];
            g[(i + m, j + m)] = h[(j, i)];
        }
    }
}
