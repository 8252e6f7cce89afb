//! The maps of se(3) and SE(3) on arrays. Vectors are (ω, v), rotation first; elements are 4×4 matrices.

use lieflow::Error;
use lieflow::groups::Se3;
use lieflow::maps::{CCSK123, CCSK321, CoordinateMap, cay, dcayinv, dexp, dexpinv, exp, log};
use nalgebra::{Matrix3, Vector3};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{each, map_one, map_two};

const GROUP: Se3 = Se3::new();
/// How far a matrix may be from a rotation, and its last row from 0 0 0 1: the sum over its entries.
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
    let right = [0.0, 0.0, 0.0, 1.0];
    let away: [f64; 4] = core::array::from_fn(|j| (x[12 + j] - right[j]).abs());
    // A sum, because a maximum would lose NaN.
    let off: f64 = away.iter().sum();
    if off.is_nan() || off > OFF_MAX {
        let j = (0..4).max_by(|&i, &j| away[i].total_cmp(&away[j])).unwrap_or_default();
        let expected = format!("{}: the last row of [R x; 0 1] is [0, 0, 0, 1]", right[j]);
        return Err(Error::OutOfRange { arg: format!("g[3, {j}]"), value: x[12 + j], expected });
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

fn one<'py>(
    (name, from, to): (&str, &[usize], &[usize]),
    f: fn(&[f64], &mut [f64]) -> Result<(), Error>,
    x: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let sizes = [from, to].map(|tail| tail.iter().product());
    map_one((name, from, to), x, out, |x, out| each([x], out, sizes, |[x], out| f(x, out)))
}

fn two<'py>(
    f: fn(&Pair, &Pair) -> Result<Pair, Error>,
    both: (&Bound<'py, PyAny>, &Bound<'py, PyAny>),
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    map_two((["u", "v"], &[6]), both, out, |both, out| {
        each(both, out, [6, 6], |both, out| {
            let [u, v] = both.map(pair);
            write_pair(&f(&u, &v)?, out);
            Ok(())
        })
    })
}

/// The functions, each with its first line of help.
macro_rules! maps {
    ($($name:ident $x:ident $from:expr, $to:expr, $doc:literal, $f:expr;)* -- $($name2:ident $doc2:literal, $f2:expr;)*) => {
        $(#[doc = $doc]
        #[doc = ""]
        #[doc = "Vectors are (ω, v), rotation first; elements are 4×4 matrices [R x; 0 1]. Leading axes stay."]
        #[doc = "``out=`` is an array of float64 in C order for the result; it may be the argument."]
        #[doc = "Errors: lieflow.ArgumentError for a shape, a number that is not finite, or a matrix that is no motion,"]
        #[doc = "with the place of the element; TypeError for what is not real numbers."]
        #[doc = "Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000)."]
        #[pyfunction]
        #[pyo3(signature = ($x, out = None))]
        fn $name<'py>(
            $x: &Bound<'py, PyAny>,
            out: Option<&Bound<'py, PyAny>>,
        ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
            one((stringify!($x), &$from, &$to), $f, $x, out)
        })*
        $(#[doc = $doc2]
        #[doc = ""]
        #[doc = "Shapes: (..., 6) both and of the result, (ω, v) with the rotation first; leading axes broadcast. ``out=`` is"]
        #[doc = "an array of float64 in C order. Right-trivialised: d/dε Ψ(u + εv) = dΨ_u(v) Ψ(u), of 4×4 matrices."]
        #[doc = "Errors: lieflow.ArgumentError for a shape, a number that is not finite, or a u at which the map is singular,"]
        #[doc = "with the place of the element; TypeError for what is not real numbers."]
        #[doc = "Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000)."]
        #[pyfunction]
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
    se3_exp u [6], [4, 4],
    "Return exp(ω, v) = [exp ω, dexp_ω v; 0 1]: vectors (..., 6) to motions (..., 4, 4).", |x, out| {
        write_element(&exp(&GROUP, &pair(x))?, out);
        Ok(())
    };
    se3_cay u [6], [4, 4],
    "Return cay(ω, v) = [cay ω, (𝟙 − ω̂/2)⁻¹ v; 0 1]: vectors (..., 6) to motions (..., 4, 4).", |x, out| {
        write_element(&cay(&GROUP, &pair(x))?, out);
        Ok(())
    };
    se3_ccsk123 u [6], [4, 4],
    "Return the translation by v times exp(ω₁e₁) exp(ω₂e₂) exp(ω₃e₃): vectors (..., 6) to motions.", |x, out| {
        write_element(&CCSK123.eval(&GROUP, &pair(x))?, out);
        Ok(())
    };
    se3_ccsk321 u [6], [4, 4],
    "Return the translation by v times exp(ω₃e₃) exp(ω₂e₂) exp(ω₁e₁): vectors (..., 6) to motions.", |x, out| {
        write_element(&CCSK321.eval(&GROUP, &pair(x))?, out);
        Ok(())
    };
    se3_log g [4, 4], [6],
    "Return (log R, dexp_ω⁻¹ x) of [R x; 0 1], with ω = log R and |ω| ≤ π: motions to vectors (..., 6).", |x, out| {
        write_pair(&log(&GROUP, &element(x)?)?, out);
        Ok(())
    };
    --
    se3_dexp "Return dexp_u(v) = Σ ad_u^k v/(k + 1)!, with d/dε exp(u + εv) = dexp_u(v) exp(u).", |u, v| dexp(&GROUP, u, v);
    se3_dexpinv "Return dexp_u⁻¹(v), the inverse of dexp_u. It is singular at |ω| = 2πk, k ≥ 1.", |u, v| dexpinv(&GROUP, u, v);
    se3_dcayinv "Return dcay_u⁻¹(v) = (𝟙 − u/2) v (𝟙 + u/2), of 4×4 matrices.", |u, v| dcayinv(&GROUP, u, v);
}
