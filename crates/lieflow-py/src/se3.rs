//! The maps of se(3) and SE(3) on arrays. Vectors are (ω, v), rotation first; elements are 4×4 matrices.

use lieflow::Error;
use lieflow::groups::Se3;
use lieflow::maps::{cay, dcayinv, dexp, dexpinv, exp, log};
use nalgebra::{Matrix3, Vector3};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{Input, common, fill, output};

const GROUP: Se3 = Se3::new();
/// How far from a rotation, and from the last row 0 0 0 1, a matrix may be.
const OFF_MAX: f64 = 1e-6;

type Pair = (Vector3<f64>, Vector3<f64>);
type Element = (Matrix3<f64>, Vector3<f64>);

fn pair(x: &[f64]) -> Pair {
    (Vector3::from_row_slice(&x[..3]), Vector3::from_row_slice(&x[3..6]))
}

fn write_pair((a, b): &Pair, out: &mut [f64]) {
    out[..3].copy_from_slice(a.as_slice());
    out[3..].copy_from_slice(b.as_slice());
}

fn element(x: &[f64]) -> Result<Element, Error> {
    // A sum, because a maximum would lose NaN.
    let off = (12..15).map(|k| x[k].abs()).sum::<f64>() + (x[15] - 1.0).abs();
    if off.is_nan() || off > OFF_MAX {
        let expected = "a matrix with the last row 0 0 0 1".to_owned();
        return Err(Error::OutOfRange { arg: "g".into(), value: off, expected });
    }
    let r = Matrix3::from_fn(|i, j| x[4 * i + j]);
    Ok((r, Vector3::from_fn(|i, _| x[4 * i + 3])))
}

fn write_element((r, x): &Element, out: &mut [f64]) {
    for i in 0..3 {
        for j in 0..3 {
            out[4 * i + j] = r[(i, j)];
        }
        out[4 * i + 3] = x[i];
    }
    out[12..].copy_from_slice(&[0.0, 0.0, 0.0, 1.0]);
}

/// f on each element.
fn each(
    (x, from): (&[f64], usize),
    (out, to): (&mut [f64], usize),
    mut f: impl FnMut(&[f64], &mut [f64]) -> Result<(), Error>,
) -> Result<(), Error> {
    for (index, (x, out)) in x.chunks_exact(from).zip(out.chunks_exact_mut(to)).enumerate() {
        f(x, out).map_err(|error| Error::Element { index, source: Box::new(error) })?;
    }
    Ok(())
}

fn one<'py>(
    (name, from, to): (&str, &[usize], &[usize]),
    f: fn(&[f64], &mut [f64]) -> Result<(), Error>,
    x: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = x.py();
    let mut x = Input::new(name, x, from)?;
    let lead = x.lead().to_vec();
    let out = output(py, (&lead, to), out, &mut [&mut x])?;
    let (numbers, sizes) = (x.numbers(), [from, to].map(|tail| tail.iter().product()));
    fill(py, name, (out, &lead), |out| each((numbers, sizes[0]), (out, sizes[1]), f))
}

fn two<'py>(
    f: fn(&Pair, &Pair) -> Result<Pair, Error>,
    (u, v): (&Bound<'py, PyAny>, &Bound<'py, PyAny>),
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = u.py();
    let both = (Input::new("u", u, &[6])?, Input::new("v", v, &[6])?);
    let (lead, mut u, mut v) = common(["u", "v"], both)?;
    let out = output(py, (&lead, &[6]), out, &mut [&mut u, &mut v])?;
    let (a, b) = (u.numbers(), v.numbers());
    fill(py, "u", (out, &lead), |out| {
        let step = |x: &[f64], n: usize| if x.len() == 6 && n != 1 { 0 } else { 6 };
        let n = out.len() / 6;
        let steps = [step(a, n), step(b, n)];
        for (index, out) in out.chunks_exact_mut(6).enumerate() {
            let (u, v) = (pair(&a[steps[0] * index..]), pair(&b[steps[1] * index..]));
            let w = f(&u, &v).map_err(|error| Error::Element { index, source: Box::new(error) })?;
            write_pair(&w, out);
        }
        Ok(())
    })
}

macro_rules! maps {
    ($($name:ident $x:ident $from:expr, $to:expr, $f:expr;)* -- $($name2:ident $f2:expr;)*) => {
        $(#[pyfunction]
        #[pyo3(signature = ($x, out = None))]
        fn $name<'py>(
            $x: &Bound<'py, PyAny>,
            out: Option<&Bound<'py, PyAny>>,
        ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
            one((stringify!($x), &$from, &$to), $f, $x, out)
        })*
        $(#[pyfunction]
        #[pyo3(signature = (u, v, out = None))]
        fn $name2<'py>(
            u: &Bound<'py, PyAny>,
            v: &Bound<'py, PyAny>,
            out: Option<&Bound<'py, PyAny>>,
        ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
            two($f2, (u, v), out)
        })*
        pub(crate) fn add(m: &Bound<'_, PyModule>) -> PyResult<()> {
            $(m.add_function(wrap_pyfunction!($name, m)?)?;)*
            $(m.add_function(wrap_pyfunction!($name2, m)?)?;)*
            Ok(())
        }
    };
}

maps! {
    se3_exp u [6], [4, 4], |x, out| {
        write_element(&exp(&GROUP, &pair(x))?, out);
        Ok(())
    };
    se3_cay u [6], [4, 4], |x, out| {
        write_element(&cay(&GROUP, &pair(x))?, out);
        Ok(())
    };
    se3_log g [4, 4], [6], |x, out| {
        write_pair(&log(&GROUP, &element(x)?)?, out);
        Ok(())
    };
    --
    se3_dexp |u, v| dexp(&GROUP, u, v);
    se3_dexpinv |u, v| dexpinv(&GROUP, u, v);
    se3_dcayinv |u, v| dcayinv(&GROUP, u, v);
}
