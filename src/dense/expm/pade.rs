//! Padé approximants of exp: (V − U)⁻¹(V + U) with U = a·p(a²) odd and V = q(a²) even.
//!
//! Source: N. J. Higham, The scaling and squaring method for the matrix exponential revisited,
//! SIAM J. Matrix Anal. Appl. 26 (2005) 1179–1193: degrees, coefficients and bounds θ_m of the norm.

use faer::Mat;

use super::Expm;
use crate::dense::ops::scaled_sum;
use crate::dense::product::{mul, mul_add};

const C3: &[f64] = &[120., 60., 12., 1.];
const C5: &[f64] = &[30240., 15120., 3360., 420., 30., 1.];
const C7: &[f64] = &[17297280., 8648640., 1995840., 277200., 25200., 1512., 56., 1.];
#[rustfmt::skip]
const C9: &[f64] = &[
    17643225600., 8821612800., 2075673600., 302702400., 30270240., 2162160., 110880., 3960., 90., 1.,
];
#[rustfmt::skip]
const C13: &[f64] = &[
    64764752532480000., 32382376266240000., 7771770303897600., 1187353796428800., 129060195264000.,
    10559470521600., 670442572800., 33522128640., 1323241920., 40840800., 960960., 16380., 182., 1.,
];

/// (degree, θ_m for f64).
pub(super) const THETA: [(usize, f64); 5] = [
    (3, 1.495585217958292e-2),
    (5, 2.53939833006323e-1),
    (7, 9.504178996162932e-1),
    (9, 2.097847961257068),
    // 5.37 by its truncation alone: beyond 4.25 the numerator loses digits at negative eigenvalues
    // (Al-Mohy, Higham 2009, section 3).
    (13, 4.25),
];

impl Expm {
    /// The even powers of a for a degree, except a⁸.
    pub(super) fn even_powers(&mut self, degree: usize) {
        let Expm { a, a2, a4, a6, .. } = self;
        mul(a2, a.as_ref(), a.as_ref());
        if degree >= 5 {
            mul(a4, a2.as_ref(), a2.as_ref());
        }
        if degree >= 7 {
            mul(a6, a4.as_ref(), a2.as_ref());
        }
    }

    /// out ← the \[m/m\] approximant at a. Its even powers must be computed before.
    pub(super) fn pade(&mut self, degree: usize, out: &mut Mat<f64>) {
        let Expm { a, a2, a4, a6, u, v, t, lu, .. } = self;
        match degree {
            3 => {
                scaled_sum(u, [C3[3]], [a2], C3[1]);
                scaled_sum(v, [C3[2]], [a2], C3[0]);
            }
            5 => {
                scaled_sum(u, [C5[3], C5[5]], [a2, a4], C5[1]);
                scaled_sum(v, [C5[2], C5[4]], [a2, a4], C5[0]);
            }
            7 => {
                scaled_sum(u, [C7[3], C7[5], C7[7]], [a2, a4, a6], C7[1]);
                scaled_sum(v, [C7[2], C7[4], C7[6]], [a2, a4, a6], C7[0]);
            }
            9 => {
                let c = C9;
                mul(t, a6.as_ref(), a2.as_ref());
                scaled_sum(u, [c[3], c[5], c[7], c[9]], [a2, a4, a6, t], c[1]);
                scaled_sum(v, [c[2], c[4], c[6], c[8]], [a2, a4, a6, t], c[0]);
            }
            _ => {
                let c = C13;
                for (dst, odd) in [(&mut *u, 1), (&mut *v, 0)] {
                    scaled_sum(t, [c[8 + odd], c[10 + odd], c[12 + odd]], [a2, a4, a6], 0.0);
                    scaled_sum(dst, [c[2 + odd], c[4 + odd], c[6 + odd]], [a2, a4, a6], c[odd]);
                    mul_add(dst, 1.0, a6.as_ref(), t.as_ref());
                }
            }
        }
        mul(t, a.as_ref(), u.as_ref());
        scaled_sum(&mut lu.a, [1.0, -1.0], [v, t], 0.0);
        scaled_sum(out, [1.0, 1.0], [v, t], 0.0);
        lu.factor();
        lu.solve(out.as_mut());
    }
}
