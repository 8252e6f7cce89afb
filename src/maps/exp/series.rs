//! The coefficients of the Baker series.

use core::f64::consts::PI;

/// B_k/k! for even k, by ζ(k): B_2m/(2m)! = (−1)^(m+1)·2ζ(2m)/(2π)^2m; and −1/2 for k = 1.
#[rustfmt::skip]
const BAKER: [f64; 13] = [
    1.0, 1.0 / 12.0, -1.0 / 720.0, 1.0 / 30240.0, -1.0 / 1209600.0, 1.0 / 47900160.0,
    -691.0 / 1307674368000.0, 1.0 / 74724249600.0, -3617.0 / 10670622842880000.0,
    43867.0 / 5109094217170944000.0, -174611.0 / 802857662698291200000.0,
    77683.0 / 14101100039391805440000.0, -236364091.0 / 1693824136731743669452800000.0,
];

/// B_k/k!, the coefficient of ad_u^k.
pub(in crate::maps) fn baker(k: usize) -> f64 {
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
