//! exp on so(n) by symmetric and skew products: exp(u) = C(u²) + u·S(u²).
//!
//! C(−z) ≈ cos √z and S(−z) ≈ sin √z/√z are polynomials of degree m in the symmetric matrix b = u², by
//! interpolation at the Chebyshev nodes of \[0, θ²\]. u is normal, so the bound of the scalar error on \[0, θ\] also
//! bounds the error of the matrix: 2.8e-17 for every row.
//!
//! | degree 2m+1 | θ | half products |
//! |---|---|---|
//! | 5 | 0.0092 | b, b², u·S |
//! | 9 | 0.186 | b, b², one each for C and S, u·S |
//! | 13 | 0.755 | b, b², b³, one each, u·S |
//! | 17 | 1.75 | b, b², b³, b⁴, one each, u·S |
//!
//! A half product computes one triangle. ‖u‖₂ is bounded by ‖u²ᵏ‖₁^(1/2k) of the powers at hand.

use faer::Mat;

use super::taylor::{half_to_the, halvings};
use super::{Approximant, Expm, ExpmChoice};
use crate::dense::ops::{norm1, scaled_sum, scaled_sums};
use crate::dense::product::{half_mul, half_mul_add, mul, orthogonalise};

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
        // c and s get the low powers, t and out what is multiplied with the highest one.
        let (degree, squarings, scale) = if bound <= THETA_5 {
            let [kc, ks] = CS5;
            let pairs = [[kc[1], kc[2]], [ks[1], ks[2]]];
            scaled_sums([&mut *c, &mut *s], pairs, [&*b, &*b2], [kc[0], ks[0]]);
            (5, 0, 1.0)
        } else if bound <= THETA_9 {
            let [kc, ks] = CS9;
            let low = [[kc[1], 0.0], [ks[1], 0.0]];
            let high = [[kc[3], kc[4]], [ks[3], ks[4]]];
            let to = [&mut *c, &mut *s, &mut *t, &mut *out];
            let d = [kc[0], ks[0], kc[2], ks[2]];
            scaled_sums(to, [low[0], low[1], high[0], high[1]], [&*b, &*b2], d);
            half_mul_add(c, b2.as_ref(), t.as_ref());
            half_mul_add(s, b2.as_ref(), out.as_ref());
            (9, 0, 1.0)
        } else {
            half_mul(b3, b2.as_ref(), b.as_ref(), 1.0);
            let bound = bound.min(norm1(b3.as_ref()).cbrt().sqrt());
            if bound <= THETA_13 {
                let [kc, ks] = CS13;
                let low = |k: [f64; 7]| [k[1], k[2], 0.0];
                let high = |k: [f64; 7]| [k[4], k[5], k[6]];
                let to = [&mut *c, &mut *s, &mut *t, &mut *out];
                let d = [kc[0], ks[0], kc[3], ks[3]];
                let all = [low(kc), low(ks), high(kc), high(ks)];
                scaled_sums(to, all, [&*b, &*b2, &*b3], d);
                half_mul_add(c, b3.as_ref(), t.as_ref());
                half_mul_add(s, b3.as_ref(), out.as_ref());
                (13, 0, 1.0)
            } else {
                half_mul(b4, b2.as_ref(), b2.as_ref(), 1.0);
                let bound = bound.min(norm1(b4.as_ref()).sqrt().sqrt().sqrt());
                let q = halvings(bound, THETA_17, 1);
                let f = half_to_the(q);
                let f2 = f * f;
                let (f4, f6, f8) = (f2 * f2, f2 * f2 * f2, f2 * f2 * f2 * f2);
                let [kc, ks] = CS17;
                let low = |k: [f64; 9]| [k[1] * f2, k[2] * f4, k[3] * f6, 0.0];
                let high =
                    |k: [f64; 9]| [k[5] * f2 * f8, k[6] * f4 * f8, k[7] * f6 * f8, k[8] * f8 * f8];
                let to = [&mut *c, &mut *s, &mut *t, &mut *out];
                let d = [kc[0], ks[0], kc[4] * f8, ks[4] * f8];
                let all = [low(kc), low(ks), high(kc), high(ks)];
                scaled_sums(to, all, [&*b, &*b2, &*b3, &*b4], d);
                half_mul_add(c, b4.as_ref(), t.as_ref());
                half_mul_add(s, b4.as_ref(), out.as_ref());
                (17, q, f)
            }
        };
        half_mul(t, u, s.as_ref(), -1.0);
        scaled_sum(out, [1.0, scale], [&*c, &*t], 0.0);
        self.rotate_back(Approximant::CosSin, degree, squarings, out);
    }

    /// out ← out^(2^squarings), put back on the group. Completes the choice.
    pub(super) fn rotate_back(
        &mut self,
        kind: Approximant,
        degree: usize,
        squarings: u32,
        out: &mut Mat<f64>,
    ) {
        for _ in 0..squarings {
            mul(&mut self.t, out.as_ref(), out.as_ref());
            core::mem::swap(&mut self.t, out);
        }
        let corrections =
            if squarings > 0 { orthogonalise(out, [&mut self.t, &mut self.a2]) } else { 0 };
        self.choice = ExpmChoice { kind, degree, squarings, corrections, balanced: false };
    }
}
