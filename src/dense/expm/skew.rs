//! exp on so(n) by products of which every one is symmetric or skew: exp(u) = C(u²) + u·S(u²).
//!
//! C(−z) ≈ cos √z and S(−z) ≈ sin √z/√z are polynomials of degree m in b = u², symmetric, found by
//! interpolation in the Chebyshev nodes of \[0, θ²\]; u is normal, so a bound of the scalar error on
//! \[0, θ\] bounds that of the matrix: 2.8e-17 for every row.
//!
//! | degree 2m+1 | θ | half products |
//! |---|---|---|
//! | 5 | 0.0092 | b, b², u·S |
//! | 9 | 0.186 | b, b², one each for C and S, u·S |
//! | 13 | 0.755 | b, b², b³, one each, u·S |
//! | 17 | 1.75 | b, b², b³, b⁴, one each, u·S |
//!
//! A half product computes one triangle. ‖u‖₂ is bounded by ‖u²ᵏ‖₁^(1/2k) of the powers at hand.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use super::taylor::{half_to_the, halvings};
use super::{Expm, ExpmChoice, Kind};
use crate::dense::ops::{half_mul, norm1, orthogonalise, scaled_sum};

const THETA_5: f64 = 0.0092;
const THETA_9: f64 = 0.186;
const THETA_13: f64 = 0.755;
const THETA_17: f64 = 1.75;

/// Coefficients of bᵏ in C and S.
type Pair<const M: usize> = [[f64; M]; 2];

const CS5: Pair<3> = [
    [0.99999999999999997368, 0.49999999999440319222, 0.041666490333633162689],
    [0.99999999999999999624, 0.16666666666586712231, 0.0083333081428904572358],
];
#[rustfmt::skip]
const CS9: Pair<5> = [
    [0.99999999999999997334, 0.49999999999996147361, 0.041666666657757556561,
        0.0013888881677932038265, 0.000024777763124578437455],
    [0.99999999999999999758, 0.16666666666666316392, 0.0083333333325233366638,
        0.00019841263285288072889, 2.7535659462161929105e-6],
];
#[rustfmt::skip]
const CS13: Pair<7> = [
    [0.99999999999999997285, 0.49999999999999533136, 0.04166666666653560644,
        0.0013888888875090261402, 0.000024801580382268104139, 2.7555537486594897371e-7,
        2.064905701214898443e-9],
    [0.99999999999999999819, 0.16666666666666635512, 0.0083333333333245875827,
        0.00019841269832062179105, 2.7557314607042801412e-6, 2.5050919624733069944e-8,
        1.5907153766784605337e-10],
];
#[rustfmt::skip]
const CS17: Pair<9> = [
    [0.99999999999999997277, 0.49999999999999855944, 0.041666666666654119788,
        0.0013888888888468065332, 0.000024801587230862748376, 2.7557312544249129909e-7,
        2.0876386124633562702e-9, 1.1458727815713578603e-11, 4.5687188464142380408e-14],
    [0.99999999999999999856, 0.16666666666666659058, 0.0083333333333326706995,
        0.0001984126984104760359, 2.7557319186638948305e-6, 2.505210485854383306e-8,
        1.6058848058269667274e-10, 7.640821631276900926e-13, 2.7003089533330603504e-15],
];

impl Expm {
    /// out ← exp(x) for skew x of 1-norm `norm`.
    pub(super) fn exp_skew(&mut self, x: &Mat<f64>, norm: f64, out: &mut Mat<f64>) {
        let Expm { a: b, a2: b2, a4: b3, a6: b4, u: c, v: s, t, .. } = self;
        let u = x.as_ref();
        half_mul(b, u, u, 1.0);
        half_mul(b2, b.as_ref(), b.as_ref(), 1.0);
        let bound = norm.min(norm1(b.as_ref()).sqrt()).min(norm1(b2.as_ref()).sqrt().sqrt());
        let (degree, squarings, scale) = if bound <= THETA_5 {
            for (dst, k) in [(&mut *c, CS5[0]), (&mut *s, CS5[1])] {
                scaled_sum(dst, [k[1], k[2]], [&*b, &*b2], k[0]);
            }
            (5, 0, 1.0)
        } else if bound <= THETA_9 {
            for (dst, k) in [(&mut *c, CS9[0]), (&mut *s, CS9[1])] {
                scaled_sum(t, [k[3], k[4]], [&*b, &*b2], k[2]);
                half_mul(dst, b2.as_ref(), t.as_ref(), 1.0);
                add_sum(dst, [k[1]], [&*b], k[0]);
            }
            (9, 0, 1.0)
        } else {
            half_mul(b3, b2.as_ref(), b.as_ref(), 1.0);
            let bound = bound.min(norm1(b3.as_ref()).cbrt().sqrt());
            if bound <= THETA_13 {
                for (dst, k) in [(&mut *c, CS13[0]), (&mut *s, CS13[1])] {
                    scaled_sum(t, [k[4], k[5], k[6]], [&*b, &*b2, &*b3], k[3]);
                    half_mul(dst, b3.as_ref(), t.as_ref(), 1.0);
                    add_sum(dst, [k[1], k[2]], [&*b, &*b2], k[0]);
                }
                (13, 0, 1.0)
            } else {
                half_mul(b4, b2.as_ref(), b2.as_ref(), 1.0);
                let bound = bound.min(norm1(b4.as_ref()).sqrt().sqrt().sqrt());
                let q = halvings(bound, THETA_17, 1);
                let f = half_to_the(q);
                let f2 = f * f;
                let (f4, f6, f8) = (f2 * f2, f2 * f2 * f2, f2 * f2 * f2 * f2);
                for (dst, k) in [(&mut *c, CS17[0]), (&mut *s, CS17[1])] {
                    let high = [k[5] * f2, k[6] * f4, k[7] * f6, k[8] * f8];
                    scaled_sum(t, high, [&*b, &*b2, &*b3, &*b4], k[4]);
                    half_mul(dst, b4.as_ref(), t.as_ref(), 1.0);
                    let low = [k[1] * f2, k[2] * f4, k[3] * f6];
                    scaled_sum(t, [low[0], low[1], low[2], f8], [&*b, &*b2, &*b3, &*dst], k[0]);
                    core::mem::swap(t, dst);
                }
                (17, q, f)
            }
        };
        half_mul(t, u, s.as_ref(), -1.0);
        scaled_sum(out, [1.0, scale], [&*c, &*t], 0.0);
        for _ in 0..squarings {
            matmul(t.as_mut(), Accum::Replace, out.as_ref(), out.as_ref(), 1.0, Par::Seq);
            core::mem::swap(t, out);
        }
        let corrections =
            if squarings > 0 { orthogonalise(out, [&mut self.t, &mut self.a2]) } else { 0 };
        self.choice =
            ExpmChoice { kind: Kind::CosSin, degree, squarings, corrections, balanced: false };
    }
}

/// out ← out + Σ c_i·x_i + d·𝟙.
fn add_sum<const K: usize>(out: &mut Mat<f64>, c: [f64; K], x: [&Mat<f64>; K], d: f64) {
    for j in 0..out.ncols() {
        let cols = x.map(|x| x.col_as_slice(j));
        let out = out.col_as_slice_mut(j);
        for (i, o) in out.iter_mut().enumerate() {
            for k in 0..K {
                *o += c[k] * cols[k][i];
            }
        }
        if let Some(o) = out.get_mut(j) {
            *o += d;
        }
    }
}
