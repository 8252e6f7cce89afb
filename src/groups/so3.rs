//! The group SO(3) with so(3) ≅ ℝ³ by the hat map (2): fixed size, generic in the number type.

use core::marker::PhantomData;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::{LieAlgebra, LieGroup, RESIDUAL_MAX, Sample};
use crate::error::Error;
use crate::scalar::{Real, infinite_or_nan};
use crate::so3::{self, apply3, compose3, cross, dot3, in_range};

/// The group SO(3). Elements of the algebra are 3-vectors (û of the paper), elements of the group are 3×3 rotations.
///
/// nalgebra is only the container. The formulas are written out, so that the operation count is that of the formulas.
#[derive(Clone, Copy, Debug, Default)]
pub struct So3<S = f64>(PhantomData<S>);

impl<S> So3<S> {
    /// The group.
    pub const fn new() -> Self {
        So3(PhantomData)
    }
}

/// Are the numbers of a state finite?
#[inline(always)] // asked after every step of a run
pub(super) fn check_finite<S: Real>(y: &[S]) -> Result<(), Error> {
    if y.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(not_finite(y)) }
}

#[cold]
fn not_finite<S: Real>(y: &[S]) -> Error {
    let first = y.iter().find(|x| !x.is_finite());
    Error::out_of_range("y", first.map_or(f64::NAN, |x| infinite_or_nan(*x)), "finite numbers")
}

/// √Σx².
fn norm_of<S: Real>(x: &[S]) -> S {
    let squares = x.iter().fold(S::lit(0.0), |s, &x| s + x * x);
    squares.sqrt()
}

impl<S: Real> LieAlgebra for So3<S> {
    type Scalar = S;
    type Alg = Vector3<S>;

    fn name(&self) -> String {
        "SO(3)".into()
    }
    fn dim(&self) -> usize {
        3
    }
    #[inline]
    fn zero(&self) -> Vector3<S> {
        let o = S::lit(0.0);
        Vector3::new(o, o, o)
    }
    #[inline]
    fn set_zero(&self, u: &mut Vector3<S>) {
        *u = self.zero();
    }
    #[inline]
    fn axpy(&self, a: S, x: &Vector3<S>, y: &mut Vector3<S>) {
        for i in 0..3 {
            y[i] += a * x[i];
        }
    }
    #[inline]
    fn bracket(&self, u: &Vector3<S>, v: &Vector3<S>, out: &mut Vector3<S>) {
        *out = cross(u, v);
    }
    #[inline]
    fn norm(&self, u: &Vector3<S>) -> S {
        norm_of(u.as_slice())
    }
    #[inline]
    fn is_finite(&self, u: &Vector3<S>) -> bool {
        u[0].is_finite() && u[1].is_finite() && u[2].is_finite()
    }
    /// Starts from the first term instead of zero, which saves three additions.
    #[inline]
    fn combine(&self, h: S, weights: &[f64], terms: &[Vector3<S>], u: &mut Vector3<S>) {
        let mut first = true;
        // No iterator: a build of many units without LTO does not put it in line.
        for j in 0..weights.len().min(terms.len()) {
            let (w, k) = (weights[j], &terms[j]);
            if w != 0.0 {
                let a = h * S::lit(w);
                if first {
                    *u = Vector3::new(a * k[0], a * k[1], a * k[2]);
                    first = false;
                } else {
                    self.axpy(a, k, u);
                }
            }
        }
        if first {
            self.set_zero(u);
        }
    }
}

impl<S: Real> LieGroup for So3<S> {
    type Elem = Matrix3<S>;
    type Vector = Vector3<S>;

    fn identity(&self) -> Matrix3<S> {
        let (o, i) = (S::lit(0.0), S::lit(1.0));
        Matrix3::new(i, o, o, o, i, o, o, o, i)
    }
    #[inline]
    fn compose(&self, a: &Matrix3<S>, b: &Matrix3<S>, out: &mut Matrix3<S>) {
        compose3(a, b, out);
    }
    #[inline]
    fn apply(&self, g: &Matrix3<S>, x: &Vector3<S>, y: &mut Vector3<S>) {
        *y = apply3(g, x);
    }
    /// Column by column: v̂ x = v × x.
    #[inline]
    fn tangent(&self, v: &Vector3<S>, g: &Matrix3<S>, out: &mut Matrix3<S>) {
        for j in 0..3 {
            let column = cross(v, &Vector3::new(g[(0, j)], g[(1, j)], g[(2, j)]));
            (out[(0, j)], out[(1, j)], out[(2, j)]) = (column[0], column[1], column[2]);
        }
    }
    #[inline]
    fn apply_algebra(&self, v: &Vector3<S>, x: &Vector3<S>, y: &mut Vector3<S>) {
        *y = cross(v, x);
    }
    fn distance(&self, a: &Matrix3<S>, b: &Matrix3<S>) -> S {
        let mut d = *a;
        for (d, b) in d.iter_mut().zip(b) {
            *d -= *b;
        }
        norm_of(d.as_slice())
    }
    fn defect(&self, g: &Matrix3<S>) -> S {
        let mut gram = self.identity();
        compose3(&g.transpose(), g, &mut gram);
        self.distance(&gram, &self.identity())
    }
    #[inline]
    fn check_elem(&self, g: &Matrix3<S>) -> Result<(), Error> {
        check_finite(g.as_slice())
    }
    #[inline]
    fn check_vector(&self, x: &Vector3<S>) -> Result<(), Error> {
        check_finite(x.as_slice())
    }
    /// The driver looks at the state after each step.
    #[inline]
    fn is_finite_vector(&self, _: &Vector3<S>) -> bool {
        true
    }
    #[inline]
    fn correct(&self, g: &mut Matrix3<S>, [half, step]: [&mut Matrix3<S>; 2]) -> S {
        compose3(&g.transpose(), g, step);
        for i in 0..3 {
            for j in 0..3 {
                let one = S::lit(if i == j { 0.5 } else { 0.0 });
                half[(i, j)] = one - S::lit(0.5) * step[(i, j)];
            }
        }
        let mut residual = S::lit(2.0) * norm_of(half.as_slice());
        let [a, b, c] = [0, 1, 2].map(|j| Vector3::new(g[(0, j)], g[(1, j)], g[(2, j)]));
        if dot3(&cross(&a, &b), &c).all_below(0.0) {
            // A reflection is 2 away from the rotations, although gᵀg = 𝟙.
            residual = S::lit(2.0);
        }
        if residual.all_below(RESIDUAL_MAX) {
            compose3(g, half, step);
            for (g, s) in g.iter_mut().zip(step.iter()) {
                *g += *s;
            }
        }
        residual
    }
    #[inline]
    fn correct_vector(&self, from: &Vector3<S>, x: &mut Vector3<S>) -> Option<S> {
        let (from2, x2) = (dot3(from, from), dot3(x, x));
        if !in_range(from2) {
            return Some(S::lit(0.0));
        }
        let missing = (from2 - x2) / from2;
        if missing.abs().all_below(RESIDUAL_MAX) {
            self.axpy(S::lit(0.5) * missing, &x.clone_owned(), x);
        }
        Some(missing.abs())
    }
}

impl So3<f64> {
    /// Checks that `g` is a rotation: finite, ‖gᵀg − 𝟙‖ ≤ `tolerance`·max(1, ‖g‖²), determinant +1.
    ///
    /// # Errors
    /// [`Error::NotFiniteEntry`], [`Error::NotOnGroup`] with the residual, [`Error::Reflection`].
    pub fn check_element(
        &self,
        arg: &'static str,
        g: &Matrix3<f64>,
        tolerance: f64,
    ) -> Result<(), Error> {
        for i in 0..3 {
            for j in 0..3 {
                if !g[(i, j)].is_finite() {
                    return Err(Error::NotFiniteEntry { arg, row: i, col: j, value: g[(i, j)] });
                }
            }
        }
        let residual = self.defect(g) / norm_of(g.as_slice()).powi(2).max(1.0);
        if residual.is_nan() || residual > tolerance {
            return Err(Error::NotOnGroup { arg, group: self.name(), residual, tolerance });
        }
        if g.determinant() < 0.0 {
            return Err(Error::Reflection { arg });
        }
        Ok(())
    }
}

impl So3<f64> {
    /// The element of a rotation of nalgebra: of a `Rotation3`, or of a `UnitQuaternion`.
    ///
    /// ```
    /// use lieflow::groups::So3;
    /// use lieflow::nalgebra::{Rotation3, UnitQuaternion, Vector3};
    /// let q = UnitQuaternion::new(Vector3::new(0.1, -0.2, 0.3));
    /// let g = So3::from_rotation(q);
    /// assert!((So3::from_rotation(Rotation3::from(q)) - g).norm() < 1e-15);
    /// assert!(So3::to_quaternion(&g)?.angle_to(&q) < 1e-15);
    /// assert_eq!(So3::to_rotation(&g)?.into_inner(), g);
    /// # Ok::<(), lieflow::Error>(())
    /// ```
    pub fn from_rotation(rotation: impl Into<Rotation3<f64>>) -> Matrix3<f64> {
        rotation.into().into_inner()
    }

    /// The `Rotation3` of an element.
    ///
    /// # Errors
    /// As [`so3::log`], for a matrix that is no rotation.
    pub fn to_rotation(g: &Matrix3<f64>) -> Result<Rotation3<f64>, Error> {
        so3::log(g)?;
        Ok(Rotation3::from_matrix_unchecked(*g))
    }

    /// The `UnitQuaternion` of an element. Its largest component, or nearly the largest, is positive.
    ///
    /// # Errors
    /// As [`so3::log`], for a matrix that is no rotation.
    pub fn to_quaternion(g: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, Error> {
        so3::quaternion_from_matrix(g)
    }
}

impl Sample for So3<f64> {
    /// Independent Gaussian components of û.
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| sigma * rng.sample::<f64, _>(StandardNormal))
    }
    /// Haar's measure, by a unit quaternion uniform on the 3-sphere.
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> Matrix3<f64> {
        let q = nalgebra::Quaternion::new(
            rng.sample(StandardNormal),
            rng.sample(StandardNormal),
            rng.sample(StandardNormal),
            rng.sample(StandardNormal),
        );
        nalgebra::UnitQuaternion::from_quaternion(q).to_rotation_matrix().into_inner()
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Vector3<f64> {
        self.sample_algebra(rng, 1.0)
    }
}
