//! The maps over arrays of rows: one vector after the other, or one matrix after the other, each by rows.
//!
//! An input of one vector stands for all. Results are those of [`batch`](super), to the bit from 32 vectors on. Fewer
//! vectors take the scalar form.
//!
//! ```
//! use lieflow::so3::batch::rows;
//! let u = [0.1, -0.4, 2.0, 0.3, 0.0, 0.0];
//! let mut r = [0.0; 18];
//! rows::exp(&u, &mut r)?;
//! let mut back = [0.0; 6];
//! rows::log(&r, &mut back)?;
//! assert!(u.iter().zip(back).all(|(u, back)| (u - back).abs() < 1e-15));
//! # Ok::<(), lieflow::Error>(())
//! ```

use super::kernels::{
    CayInvOf, CayOf, DcayOf, DcayinvOf, DexpOf, DexpinvOf, ExpOf, ExpOnOf, Kernel, LogOf,
};
use super::{Component, Results, run_on};
use crate::error::Error;

/// The components of rows of this size. One row stands for all.
fn components<const SIZE: usize>(n: usize, rows: &[f64]) -> Result<[Component<'_>; SIZE], Error> {
    let step = if rows.len() == SIZE && n != 1 { 0 } else { SIZE };
    if step != 0 && rows.len() != SIZE * n {
        let (arg, cols) = ("an array of the batch", 1);
        let (rows, expected_rows) = (rows.len(), SIZE * n);
        return Err(Error::Shape { arg, rows, cols, expected_rows, expected_cols: 1 });
    }
    // An empty array has no components.
    Ok(core::array::from_fn(|k| Component { numbers: rows.get(k..).unwrap_or(&[]), step }))
}

/// The number of rows of this size.
fn count(output: &[f64], size: usize) -> Result<usize, Error> {
    let n = output.len() / size;
    match output.len() == n * size {
        true => Ok(n),
        false => {
            let (arg, rows, cols) = ("an array of the batch", output.len(), 1);
            Err(Error::Shape { arg, rows, cols, expected_rows: n * size, expected_cols: 1 })
        }
    }
}

fn map<K: Kernel<IN, OUT>, const IN: usize, const OUT: usize>(
    input: &[f64],
    output: &mut [f64],
) -> Result<(), Error> {
    let n = count(output, OUT)?;
    run_on::<K, IN, OUT>(n, components::<IN>(n, input)?, Results::Rows(output))
}

fn map_two<K: Kernel<6, 3>>(u: &[f64], v: &[f64], w: &mut [f64]) -> Result<(), Error> {
    let n = count(w, 3)?;
    let ([a, b, c], [d, e, f]) = (components::<3>(n, u)?, components::<3>(n, v)?);
    run_on::<K, 6, 3>(n, [a, b, c, d, e, f], Results::Rows(w))
}

/// r ← exp(u), [`so3::exp`](crate::so3::exp()): 3 numbers each to 9.
///
/// # Errors
/// As [`batch::exp`](super::exp).
pub fn exp(u: &[f64], r: &mut [f64]) -> Result<(), Error> {
    map::<ExpOf, 3, 9>(u, r)
}

/// r ← cay(u), [`so3::cay`](crate::so3::cay()): 3 numbers each to 9.
///
/// # Errors
/// As [`batch::exp`](super::exp).
pub fn cay(u: &[f64], r: &mut [f64]) -> Result<(), Error> {
    map::<CayOf, 3, 9>(u, r)
}

/// u ← log(R), [`so3::log`](crate::so3::log()): 9 numbers each to 3.
///
/// # Errors
/// As [`batch::exp`](super::exp).
pub fn log(r: &[f64], u: &mut [f64]) -> Result<(), Error> {
    map::<LogOf, 9, 3>(r, u)
}

/// u ← cay⁻¹(R), [`so3::cay_inv`](crate::so3::cay_inv): 9 numbers each to 3.
///
/// # Errors
/// As [`batch::exp`](super::exp).
pub fn cay_inv(r: &[f64], u: &mut [f64]) -> Result<(), Error> {
    map::<CayInvOf, 9, 3>(r, u)
}

/// w ← exp(u)·x, [`so3::exp_on`](crate::so3::exp_on).
///
/// # Errors
/// As [`batch::exp`](super::exp).
pub fn exp_on(u: &[f64], x: &[f64], w: &mut [f64]) -> Result<(), Error> {
    map_two::<ExpOnOf>(u, x, w)
}

/// w ← dexp_u(v), [`so3::dexp`](crate::so3::dexp).
///
/// # Errors
/// As [`batch::exp`](super::exp).
pub fn dexp(u: &[f64], v: &[f64], w: &mut [f64]) -> Result<(), Error> {
    map_two::<DexpOf>(u, v, w)
}

/// w ← dexp_u⁻¹(v), [`so3::dexpinv`](crate::so3::dexpinv).
///
/// # Errors
/// As [`batch::exp`](super::exp).
pub fn dexpinv(u: &[f64], v: &[f64], w: &mut [f64]) -> Result<(), Error> {
    map_two::<DexpinvOf>(u, v, w)
}

/// w ← dcay_u(v), [`so3::dcay`](crate::so3::dcay).
///
/// # Errors
/// As [`batch::exp`](super::exp).
pub fn dcay(u: &[f64], v: &[f64], w: &mut [f64]) -> Result<(), Error> {
    map_two::<DcayOf>(u, v, w)
}

/// w ← dcay_u⁻¹(v), [`so3::dcayinv`](crate::so3::dcayinv).
///
/// # Errors
/// As [`batch::exp`](super::exp).
pub fn dcayinv(u: &[f64], v: &[f64], w: &mut [f64]) -> Result<(), Error> {
    map_two::<DcayinvOf>(u, v, w)
}
