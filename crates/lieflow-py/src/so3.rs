//! The maps of so(3) and SO(3) on arrays.

use lieflow::so3::batch::rows;
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays::{map_one, map_two};

/// The functions, each with its first line of help.
macro_rules! maps {
    (
        $($name:ident $x:ident $from:expr, $to:expr, $map:path, $doc:literal;)* --
        $($name2:ident $y:ident $map2:path, $doc2:literal;)*
    ) => {
        $(#[doc = $doc]
        #[doc = ""]
        #[doc = "Leading axes stay. ``out=`` is an array of float64 in C order for the result; it may be the argument."]
        #[doc = "Errors: lieflow.ArgumentError for a shape, a number that is not finite, or a matrix that is no rotation,"]
        #[doc = "with the place of the element; TypeError for what is not real numbers."]
        #[doc = "Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000)."]
        #[pyfunction]
        #[pyo3(signature = ($x, out = None))]
        fn $name<'py>(
            $x: &Bound<'py, PyAny>,
            out: Option<&Bound<'py, PyAny>>,
        ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
            map_one((stringify!($x), &$from, &$to), $x, out, $map)
        })*
        $(#[doc = $doc2]
        #[doc = ""]
        #[doc = "Shapes: (..., 3) both and of the result; leading axes broadcast. ``out=`` is an array of float64 in C order"]
        #[doc = "for the result. Differentials are right-trivialised: d/dε Ψ(u + εv) = dΨ_u(v) Ψ(u), of which û is the matrix."]
        #[doc = "Errors: lieflow.ArgumentError for a shape, a number that is not finite, or a u at which the map is singular,"]
        #[doc = "with the place of the element; TypeError for what is not real numbers."]
        #[doc = "Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000)."]
        #[pyfunction]
        #[pyo3(signature = (u, $y, out = None))]
        fn $name2<'py>(
            u: &Bound<'py, PyAny>,
            $y: &Bound<'py, PyAny>,
            out: Option<&Bound<'py, PyAny>>,
        ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
            map_two((["u", stringify!($y)], &[3]), (u, $y), out, |[u, v], out| $map2(u, v, out))
        })*
        pub(crate) fn add(m: &Bound<'_, PyModule>) -> PyResult<()> {
            $(m.add_function(wrap_pyfunction!($name, m)?)?;)*
            $(m.add_function(wrap_pyfunction!($name2, m)?)?;)*
            Ok(())
        }
    };
}

maps! {
    so3_exp u [3], [3, 3], rows::exp,
        "Return exp(u) = 𝟙 + (sin α/α) û + ((1 − cos α)/α²) û², α = |u|: vectors (..., 3) to rotations (..., 3, 3).";
    so3_cay u [3], [3, 3], rows::cay,
        "Return cay(u) = 𝟙 + (û + û²/2)/(1 + |u|²/4): vectors (..., 3) to rotations (..., 3, 3).";
    so3_log r [3, 3], [3], rows::log,
        "Return the shortest u with exp(u) = r, |u| ≤ π: rotations (..., 3, 3) to vectors (..., 3).";
    so3_cay_inv r [3, 3], [3], rows::cay_inv,
        "Return the u with cay(u) = r, where no angle is π: rotations (..., 3, 3) to vectors (..., 3).";
    --
    so3_exp_on x rows::exp_on, "Return exp(u) x, the vectors x turned by u, without the matrix of exp(u).";
    so3_dexp v rows::dexp,
        "Return dexp_u(v) = v + ((1 − cos α)/α²) u × v + ((α − sin α)/α³) u × (u × v), α = |u|: the left Jacobian.";
    so3_dexpinv v rows::dexpinv,
        "Return dexp_u⁻¹(v) = v − u × v/2 + ((1 − (α/2) cot(α/2))/α²) u × (u × v), α = |u|.";
    so3_dcay v rows::dcay, "Return dcay_u(v) = (v + u × v/2)/(1 + |u|²/4).";
    so3_dcayinv v rows::dcayinv, "Return dcay_u⁻¹(v) = v − u × v/2 + (u·v) u/4.";
}
