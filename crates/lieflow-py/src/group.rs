//! The maps of a group of matrices on arrays.

use faer::{Mat, MatRef};
use lieflow::dense::Structure;
use lieflow::groups::{
    AlgebraMatrix, Form, GroupMatrix, LieAlgebra, LieGroup, MatrixGroup as Group, Sample,
};
use lieflow::maps::{
    CCSK123, CCSK321, CoordinateMap, cay, cay_inv, dcay, dcayinv, dexp, dexpinv, dexpinv_truncated,
    log,
};
use lieflow::{Error, StepError};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::arrays::{each, fill, map_one, map_two, output};
use crate::error::{argument, refused};

/// How far from 𝔤 or from the group an argument may be, relative to its size: as a start of a run.
const OFF_MAX: f64 = 1e-6;

/// A group of matrices.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct MatrixGroup(Group);

fn matrix(n: usize, rows: &[f64]) -> Mat<f64> {
    MatRef::from_row_major_slice(rows, n, n).to_owned()
}

fn write(m: &Mat<f64>, out: &mut [f64]) {
    let n = m.nrows();
    for j in 0..n {
        for (i, x) in m.col_as_slice(j).iter().enumerate() {
            out[i * n + j] = *x;
        }
    }
}

impl MatrixGroup {
    /// The element of 𝔤 that is nearest to a matrix, which is in 𝔤 to [`OFF_MAX`].
    fn algebra(&self, rows: &[f64]) -> Result<AlgebraMatrix, Error> {
        let u = matrix(self.0.n(), rows);
        self.0.algebra(u.clone()).or_else(|_| {
            let near = self.0.algebra_within(u, OFF_MAX)?;
            Ok(self.0.project_algebra(near.as_ref()))
        })
    }

    /// A matrix that is in the group to [`OFF_MAX`].
    fn element(&self, rows: &[f64]) -> Result<GroupMatrix, Error> {
        self.0.element_within(matrix(self.0.n(), rows), OFF_MAX)
    }

    fn one<'py>(
        &self,
        name: &str,
        x: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        f: impl Fn(&[f64]) -> Result<Mat<f64>, Error> + Send + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let n = self.0.n();
        map_one((name, &[n, n], &[n, n]), x, out, |x, out| {
            each([x], out, [n * n, n * n], |[x], out| {
                write(&f(x)?, out);
                Ok(())
            })
        })
    }

    fn two<'py>(
        &self,
        both: (&Bound<'py, PyAny>, &Bound<'py, PyAny>),
        out: Option<&Bound<'py, PyAny>>,
        f: impl Fn(&AlgebraMatrix, &AlgebraMatrix) -> Result<AlgebraMatrix, Error> + Send + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let n = self.0.n();
        map_two((["u", "v"], &[n, n]), both, out, |both, out| {
            each(both, out, [n * n, n * n], |[u, v], out| {
                let u = self.algebra(u)?;
                let v = self.algebra(v).map_err(|error| error.about("v"))?;
                let value = f(&u, &v)?;
                write(&value, out);
                Ok(())
            })
        })
    }
}

#[pymethods]
impl MatrixGroup {
    #[new]
    #[pyo3(signature = (family, n, q = 0, form = None))]
    fn new(
        py: Python<'_>,
        family: &str,
        n: usize,
        q: usize,
        form: Option<Vec<f64>>,
    ) -> PyResult<Self> {
        let group = match (family, form) {
            ("gm", Some(form)) if form.len() == n * n => Group::gm(matrix(n, &form)),
            ("so", _) if q > 0 => Group::indefinite(n, q),
            ("so", _) => Group::so(n),
            ("sp", _) => Group::sp(n),
            ("gl", _) => Group::gl(n),
            ("sl", _) => Group::sl(n),
            ("u", _) => Group::u(n),
            _ => {
                return Err(argument(py, "family", family, "so, sp, gl, sl, u, or gm with a form"));
            }
        };
        group.map(MatrixGroup).map_err(|error| refused(py, "n", &error))
    }
    #[getter]
    fn name(&self) -> String {
        self.0.name()
    }
    #[getter]
    fn n(&self) -> usize {
        self.0.n()
    }
    #[getter]
    fn dim(&self) -> usize {
        self.0.dim()
    }
    /// Return exp(u) = Σ uᵏ/k! of elements of 𝔤.
    ///
    /// Shapes: (..., n, n); leading axes broadcast. ``out=`` is an array of float64 in C order for the result.
    /// Errors: lieflow.ArgumentError for what is not in 𝔤 or in G, or where the map is singular, with the place of the matrix;
    /// TypeError.
    /// Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    #[pyo3(signature = (u, out = None))]
    fn exp<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let n = self.0.n();
        let structure = match self.0.form() {
            Form::Identity => Structure::Skew,
            _ => Structure::General,
        };
        map_one(("u", &[n, n], &[n, n]), u, out, |u, out| {
            let mut elements = vec![0.0; u.len()];
            each([u], &mut elements, [n * n, n * n], |[u], element| {
                let u = self.algebra(u)?;
                write(&u, element);
                Ok(())
            })?;
            crate::expm::real(n, &elements, structure, out)
        })
    }
    /// Return the u in 𝔤 with exp(u) = g; the principal one where it is in 𝔤.
    ///
    /// Shapes: (..., n, n); leading axes broadcast. ``out=`` is an array of float64 in C order for the result.
    /// Errors: lieflow.ArgumentError for what is not in 𝔤 or in G, or where the map is singular, with the place of the matrix;
    /// TypeError.
    /// Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    #[pyo3(signature = (g, out = None))]
    fn log<'py>(
        &self,
        g: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.one("g", g, out, |g| Ok(log(&self.0, &self.element(g)?)?.into_mat()))
    }
    /// Return cay(u) = (𝟙 − u/2)⁻¹(𝟙 + u/2) of elements of 𝔤.
    ///
    /// Shapes: (..., n, n); leading axes broadcast. ``out=`` is an array of float64 in C order for the result.
    /// Errors: lieflow.ArgumentError for what is not in 𝔤 or in G, or where the map is singular, with the place of the matrix;
    /// TypeError.
    /// Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    #[pyo3(signature = (u, out = None))]
    fn cay<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.one("u", u, out, |u| Ok(cay(&self.0, &self.algebra(u)?)?.into_mat()))
    }
    /// Return the u in 𝔤 with cay(u) = g, where −1 is no eigenvalue of g.
    ///
    /// Shapes: (..., n, n); leading axes broadcast. ``out=`` is an array of float64 in C order for the result.
    /// Errors: lieflow.ArgumentError for what is not in 𝔤 or in G, or where the map is singular, with the place of the matrix;
    /// TypeError.
    /// Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    #[pyo3(signature = (g, out = None))]
    fn cay_inv<'py>(
        &self,
        g: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.one("g", g, out, |g| Ok(cay_inv(&self.0, &self.element(g)?)?.into_mat()))
    }
    #[pyo3(signature = (u, order, out = None))]
    fn ccsk<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        order: &str,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        match order {
            "123" => {
                self.one("u", u, out, |u| Ok(CCSK123.eval(&self.0, &self.algebra(u)?)?.into_mat()))
            }
            "321" => {
                self.one("u", u, out, |u| Ok(CCSK321.eval(&self.0, &self.algebra(u)?)?.into_mat()))
            }
            _ => Err(argument(u.py(), "order", format!("{order:?}"), "\"123\" or \"321\"")),
        }
    }
    /// Return the element of 𝔤 that is nearest to each matrix (Frobenius).
    ///
    /// The first call takes O(n⁶) and n⁴ numbers if M of ``Gm`` is neither symmetric nor skew. Else it takes O(n³).
    ///
    /// Shapes: (..., n, n); leading axes broadcast. ``out=`` is an array of float64 in C order for the result.
    /// Errors: lieflow.ArgumentError for a shape, or a number that is not finite, with the place of the matrix;
    /// TypeError.
    /// Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    #[pyo3(signature = (x, out = None))]
    fn project<'py>(
        &self,
        x: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let n = self.0.n();
        self.one("x", x, out, |x| match x.iter().all(|x| x.is_finite()) {
            true => Ok(self.0.project_algebra(matrix(n, x).as_ref()).into_mat()),
            false => Err(StepError::NotFinite { what: "x" }.into()),
        })
    }
    /// Return dexp_u(v) = Σ ad_u^k v/(k + 1)!, with d/dε exp(u + εv) = dexp_u(v) exp(u).
    ///
    /// Shapes: (..., n, n); leading axes broadcast. ``out=`` is an array of float64 in C order for the result. Right-trivialised.
    /// Errors: lieflow.ArgumentError for what is not in 𝔤 or in G, or where the map is singular, with the place of the matrix;
    /// TypeError.
    /// Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    #[pyo3(signature = (u, v, out = None))]
    fn dexp<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.two((u, v), out, |u, v| dexp(&self.0, u, v))
    }
    /// dexp_u⁻¹(v), or its series Σ B_k/k! ad_u^k v up to k = q.
    #[pyo3(signature = (u, v, q = None, out = None))]
    fn dexpinv<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        q: Option<usize>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.two((u, v), out, |u, v| match q {
            None => dexpinv(&self.0, u, v),
            Some(q) => dexpinv_truncated(&self.0, u, v, q),
        })
    }
    /// Return dcay_u(v) = (𝟙 − u/2)⁻¹ v (𝟙 + u/2)⁻¹, with d/dε cay(u + εv) = dcay_u(v) cay(u).
    ///
    /// Shapes: (..., n, n); leading axes broadcast. ``out=`` is an array of float64 in C order for the result. Right-trivialised.
    /// Errors: lieflow.ArgumentError for what is not in 𝔤 or in G, or where the map is singular, with the place of the matrix;
    /// TypeError.
    /// Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    #[pyo3(signature = (u, v, out = None))]
    fn dcay<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.two((u, v), out, |u, v| dcay(&self.0, u, v))
    }
    /// Return dcay_u⁻¹(v) = (𝟙 − u/2) v (𝟙 + u/2).
    ///
    /// Shapes: (..., n, n); leading axes broadcast. ``out=`` is an array of float64 in C order for the result. Right-trivialised.
    /// Errors: lieflow.ArgumentError for what is not in 𝔤 or in G, or where the map is singular, with the place of the matrix;
    /// TypeError.
    /// Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    #[pyo3(signature = (u, v, out = None))]
    fn dcayinv<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        self.two((u, v), out, |u, v| dcayinv(&self.0, u, v))
    }
    /// The distance ‖gᵀMg − M‖ of each matrix from the group; 2 for a reflection, |det g − 1| on SL(n), ∞ where g has no
    /// inverse or is not finite.
    #[pyo3(signature = (g))]
    fn defect<'py>(&self, g: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let n = self.0.n();
        map_one(("g", &[n, n], &[]), g, None, |g, out| {
            for (g, out) in g.chunks_exact(n * n).zip(out) {
                *out = match self.0.element(matrix(n, g)) {
                    Err(Error::Reflection { .. }) => 2.0,
                    Err(Error::Determinant { re, .. }) => (re - 1.0).abs(),
                    Err(Error::Singular { .. }) => f64::INFINITY,
                    _ if g.iter().any(|x| !x.is_finite()) => f64::INFINITY,
                    _ => self.0.defect(&GroupMatrix::new_unchecked(matrix(n, g))),
                };
            }
            Ok(())
        })
    }
    /// Random elements: the numbers of `count` matrices.
    fn random<'py>(
        &self,
        py: Python<'py>,
        count: usize,
        seed: u64,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let n = self.0.n();
        let mut rng = Pcg64::seed_from_u64(seed);
        let out = output(py, (&[count], &[n, n]), None, &mut [])?;
        fill(py, &[], (out, &[count]), |[], out| {
            for out in out.chunks_exact_mut(n * n) {
                write(&self.0.sample_element(&mut rng), out);
            }
            Ok(())
        })
    }
}
