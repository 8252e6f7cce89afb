//! so(3) ≅ ℝ³ and SO(3) in closed form: plain functions, and the one place of each formula.
//!
//! With α = |u|, û = hat(u), and right-trivialised differentials, d/dε Ψ(u + εv) = dΨ_u(v)·Ψ(u):
//!
//! | | | |
//! |---|---|---|
//! | [`exp`] | 𝟙 + (sin α/α) û + ((1−cos α)/α²) û² | (14) |
//! | [`dexp`] | 𝟙 + ((1−cos α)/α²) û + ((α−sin α)/α³) û² | the *left* Jacobian J_l(u) of robotics; J_r(u) = J_l(−u) |
//! | [`dexpinv`] | 𝟙 − û/2 + ((1−(α/2)cot(α/2))/α²) û² | (16) |
//! | [`log`] | 2 atan2(\|q\|, q_w)/\|q\| · q, q the quaternion of R | |
//! | [`cay`] | 𝟙 + (û + û²/2)/(1 + α²/4) = (𝟙 − û/2)⁻¹(𝟙 + û/2) | |
//! | [`dcay`] | (𝟙 + û/2)/(1 + α²/4) | |
//! | [`dcayinv`] | v + ¼(u·v)u − ½ u×v | |
//! | [`cay_inv`] | 2 q/q_w | |
//! | [`ccsk`] | exp(u_i e_i) exp(u_j e_j) exp(u_k e_k), any ordering ijk | |
//! | [`dccsk`], [`dccskinv`] | columns e_i, R_i e_j, R_i R_j e_k, and the inverse (18) | |
//! | [`ccsk_inv`] | the three angles | |
//!
//! Arrays of many vectors go through [`batch`], in SIMD lanes.
//!
//! Every value is within 4·ε·cond of the exact one, from |u| = 0 to 1e300: the rounding of |u| is
//! taken back where cot(α/2) would magnify it, and squares never leave the range. Forward maps are
//! generic in the scalar; logarithms are in `f64`.
//!
//! ```
//! use lieflow::so3;
//! use lieflow::nalgebra::Vector3;
//! let u = Vector3::new(0.3, -1.2, 0.5);
//! let r = so3::exp(&u)?;
//! assert!((so3::log(&r)? - u).norm() < 1e-15);
//! let v = Vector3::new(1.0, 0.0, 2.0);
//! assert!((so3::dexpinv(&u, &so3::dexp(&u, &v)?)? - v).norm() < 1e-14);
//! # Ok::<(), lieflow::Error>(())
//! ```

mod angle;
pub mod batch;
mod cay;
mod ccsk;
mod exp;
mod log;
mod polar;
mod quaternion;
mod vectors;

pub(crate) use angle::{Angle, SERIES};
pub(crate) use batch::{Lane, SMALL};
pub(crate) use cay::{cay_coefficients, cay_on, dcayinv_of};
pub(crate) use ccsk::{Angles, ccsk_of, dccskinv_of};

pub use cay::{cay, cay_inv, dcay, dcay_matrix, dcayinv, dcayinv_matrix};
pub use ccsk::{ccsk, ccsk_inv, dccsk, dccsk_matrix, dccskinv, dccskinv_matrix};
pub use exp::{dexp, dexp_matrix, dexpinv, dexpinv_matrix, exp, exp_on};
use log::ORTHOGONAL;
pub use log::{POLAR_MAX, log};
pub(crate) use quaternion::half_angle;
pub use quaternion::{
    cay_quaternion, ccsk_quaternion, exp_quaternion, log_quaternion, quaternion_from_matrix,
    quaternion_from_wxyz, quaternion_from_xyzw, quaternion_to_wxyz, quaternion_to_xyzw,
};

pub(crate) use polar::{cay_huge_on, dexpinv_huge, exp_huge, exp_huge_on};

pub(crate) use vectors::{add3, all_finite, apply3, compose3, cross, dot3, in_range};
pub use vectors::{hat, vee};

use nalgebra::{Matrix3, Vector3};

use crate::error::StepError;
use crate::scalar::Real;

/// 𝟙 + a·û + b·û².
#[inline(always)]
pub(crate) fn rodrigues<S: Real>(u: &Vector3<S>, a: S, b: S) -> Matrix3<S> {
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

/// The rotation of the quaternion (w, v), whose length is 1 but for rounding: the homogeneous form
/// |q|²·R, and what |q|² is off by taken back. Rounding of q costs an angle, never orthogonality.
#[inline(always)]
pub(crate) fn rotation<S: Real>(w: S, v: &Vector3<S>) -> Matrix3<S> {
    let (x, y, z) = (v[0], v[1], v[2]);
    let (w2, x2, y2) = (w + w, x + x, y + y);
    let (ww, xx, yy, zz) = (w * w, x * x, y * y, z * z);
    let (wx, wy, wz) = (w2 * x, w2 * y, w2 * z);
    let (xy, xz, yz) = (x2 * y, x2 * z, y2 * z);
    // 1 − |q|², in two halves: each is a difference of numbers of one size.
    let half = S::lit(0.5);
    let off = ((half - ww) - zz) + ((half - xx) - yy);
    let (a, b, c, d) = (ww - zz, xx - yy, ww + zz, xx + yy);
    let scaled = |r: S| r + r * off;
    #[rustfmt::skip]
    let g = Matrix3::new(
        scaled(a + b), scaled(xy - wz), scaled(xz + wy),
        scaled(xy + wz), scaled(a - b), scaled(yz - wx),
        scaled(xz - wy), scaled(yz + wx), scaled(c - d),
    );
    g
}

/// (𝟙 + a·û + b·û²)·x by two cross products.
#[inline(always)]
pub(crate) fn rodrigues_on<S: Real>(u: &Vector3<S>, a: S, b: S, x: &Vector3<S>) -> Vector3<S> {
    let ux = cross(u, x);
    let uux = cross(u, &ux);
    Vector3::new(
        x[0] + a * ux[0] + b * uux[0],
        x[1] + a * ux[1] + b * uux[1],
        x[2] + a * ux[2] + b * uux[2],
    )
}

/// w, or that it is not finite.
#[inline(always)]
pub(crate) fn finite<S: Real>(w: Vector3<S>, what: &'static str) -> Result<Vector3<S>, StepError> {
    if all_finite(&w) { Ok(w) } else { Err(StepError::NotFinite { what }) }
}

/// m, or that it is not finite.
#[inline(always)]
fn finite_matrix<S: Real>(m: Matrix3<S>, what: &'static str) -> Result<Matrix3<S>, StepError> {
    if m.iter().all(|x| x.is_finite()) { Ok(m) } else { Err(StepError::NotFinite { what }) }
}
