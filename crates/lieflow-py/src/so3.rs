//! The maps of so(3) and SO(3) on arrays.

use lieflow::Error;
use lieflow::so3::batch::rows;
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{Input, common, fill, output};

type Result1 = fn(&[f64], &mut [f64]) -> Result<(), Error>;
type Result2 = fn(&[f64], &[f64], &mut [f64]) -> Result<(), Error>;

fn one<'py>(
    (name, from, to): (&str, &[usize], &[usize]),
    map: Result1,
    x: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = x.py();
    let mut x = Input::new(name, x, from)?;
    let lead = x.lead().to_vec();
    let out = output(py, (&lead, to), out, &mut [&mut x])?;
    let numbers = x.numbers();
    fill(py, name, (out, &lead), |out| map(numbers, out))
}

fn two<'py>(
    second: &str,
    map: Result2,
    (u, v): (&Bound<'py, PyAny>, &Bound<'py, PyAny>),
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = u.py();
    let both = (Input::new("u", u, &[3])?, Input::new(second, v, &[3])?);
    let (lead, mut u, mut v) = common(["u", second], both)?;
    let out = output(py, (&lead, &[3]), out, &mut [&mut u, &mut v])?;
    let (a, b) = (u.numbers(), v.numbers());
    fill(py, "u", (out, &lead), |out| map(a, b, out))
}

macro_rules! maps {
    ($($name:ident $x:ident $from:expr, $to:expr, $map:path;)* -- $($name2:ident $y:ident $map2:path;)*) => {
        $(#[pyfunction]
        #[pyo3(signature = ($x, out = None))]
        fn $name<'py>(
            $x: &Bound<'py, PyAny>,
            out: Option<&Bound<'py, PyAny>>,
        ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
            one((stringify!($x), &$from, &$to), $map, $x, out)
        })*
        $(#[pyfunction]
        #[pyo3(signature = (u, $y, out = None))]
        fn $name2<'py>(
            u: &Bound<'py, PyAny>,
            $y: &Bound<'py, PyAny>,
            out: Option<&Bound<'py, PyAny>>,
        ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
            two(stringify!($y), $map2, (u, $y), out)
        })*
        pub(crate) fn add(m: &Bound<'_, PyModule>) -> PyResult<()> {
            $(m.add_function(wrap_pyfunction!($name, m)?)?;)*
            $(m.add_function(wrap_pyfunction!($name2, m)?)?;)*
            Ok(())
        }
    };
}

maps! {
    so3_exp u [3], [3, 3], rows::exp;
    so3_cay u [3], [3, 3], rows::cay;
    so3_log r [3, 3], [3], rows::log;
    so3_cay_inv r [3, 3], [3], rows::cay_inv;
    --
    so3_exp_on x rows::exp_on;
    so3_dexp v rows::dexp;
    so3_dexpinv v rows::dexpinv;
    so3_dcay v rows::dcay;
    so3_dcayinv v rows::dcayinv;
}
