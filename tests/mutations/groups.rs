//! Groups with one fault each.

use faer::Mat;
use lieflow::groups::{AlgebraMatrix, GroupMatrix, MatrixGroup, Sample};
use lieflow::maps::Exp;
use lieflow::{CoordinateMap, Error, LieAlgebra, LieGroup, StepError};
use rand::Rng;

use crate::support::represent::Represent;

/// What is wrong with the group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// Nothing.
    Sound,
    /// [u, v] = uv − (uv)ᵀ, the short cut of so(n), on any group.
    ShortCut,
    /// [u, v] = vu − uv.
    Reversed,
    /// [u, v] = 0.
    NoBracket,
    /// a·b is b·a.
    Swapped,
}

/// A matrix group with a fault.
#[derive(Clone, Debug)]
pub(crate) struct Faulty(pub(crate) MatrixGroup, pub(crate) Fault);

impl LieAlgebra for Faulty {
    type Scalar = f64;
    type Alg = AlgebraMatrix;
    fn name(&self) -> String {
        "faulty".into()
    }
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn zero(&self) -> AlgebraMatrix {
        self.0.zero()
    }
    fn set_zero(&self, u: &mut AlgebraMatrix) {
        self.0.set_zero(u);
    }
    fn axpy(&self, a: f64, x: &AlgebraMatrix, y: &mut AlgebraMatrix) {
        self.0.axpy(a, x, y);
    }
    fn bracket(&self, u: &AlgebraMatrix, v: &AlgebraMatrix, out: &mut AlgebraMatrix) {
        let uv = u.as_ref() * v.as_ref();
        *out = AlgebraMatrix::new_unchecked(match self.1 {
            Fault::ShortCut => &uv - uv.transpose(),
            Fault::Reversed => v.as_ref() * u.as_ref() - &uv,
            Fault::NoBracket => faer::Scale(0.0) * uv,
            Fault::Sound | Fault::Swapped => &uv - v.as_ref() * u.as_ref(),
        });
    }
    fn norm(&self, u: &AlgebraMatrix) -> f64 {
        self.0.norm(u)
    }
    fn is_finite(&self, u: &AlgebraMatrix) -> bool {
        self.0.is_finite(u)
    }
}

impl LieGroup for Faulty {
    type Elem = GroupMatrix;
    type Vector = Mat<f64>;
    fn identity(&self) -> GroupMatrix {
        self.0.identity()
    }
    fn compose(&self, a: &GroupMatrix, b: &GroupMatrix, out: &mut GroupMatrix) {
        match self.1 {
            Fault::Swapped => self.0.compose(b, a, out),
            _ => self.0.compose(a, b, out),
        }
    }
    fn apply(&self, g: &GroupMatrix, x: &Mat<f64>, y: &mut Mat<f64>) {
        self.0.apply(g, x, y);
    }
    fn tangent(&self, v: &AlgebraMatrix, g: &GroupMatrix, out: &mut GroupMatrix) {
        self.0.tangent(v, g, out);
    }
    fn apply_algebra(&self, v: &AlgebraMatrix, x: &Mat<f64>, y: &mut Mat<f64>) {
        self.0.apply_algebra(v, x, y);
    }
    fn distance(&self, a: &GroupMatrix, b: &GroupMatrix) -> f64 {
        self.0.distance(a, b)
    }
    fn defect(&self, g: &GroupMatrix) -> f64 {
        self.0.defect(g)
    }
}

impl Sample for Faulty {
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> AlgebraMatrix {
        self.0.sample_algebra(rng, sigma)
    }
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> GroupMatrix {
        self.0.sample_element(rng)
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> Mat<f64> {
        self.0.sample_vector(rng)
    }
}

impl Represent for Faulty {
    fn algebra_matrix(&self, u: &AlgebraMatrix) -> Mat<f64> {
        self.0.algebra_matrix(u)
    }
    fn element_matrix(&self, g: &GroupMatrix) -> Mat<f64> {
        self.0.element_matrix(g)
    }
    fn vector_matrix(&self, x: &Mat<f64>) -> Mat<f64> {
        self.0.vector_matrix(x)
    }
    fn nearest(&self, x: &Mat<f64>) -> AlgebraMatrix {
        self.0.nearest(x)
    }
    fn element_of(&self, x: &Mat<f64>) -> GroupMatrix {
        self.0.element_of(x)
    }
    fn vector_of(&self, x: &Mat<f64>) -> Mat<f64> {
        self.0.vector_of(x)
    }
    fn bilinear(&self) -> Option<Mat<f64>> {
        self.0.bilinear()
    }
}

/// The map is sound: the fault is the group's.
impl CoordinateMap<Faulty> for Exp {
    type At = <Exp as CoordinateMap<MatrixGroup>>::At;

    fn name(&self) -> &'static str {
        "exp"
    }
    fn at(&self, group: &Faulty) -> Result<Self::At, Error> {
        self.at(&group.0)
    }
    fn psi(
        &self,
        group: &Faulty,
        u: &AlgebraMatrix,
        at: &mut Self::At,
        g: &mut GroupMatrix,
    ) -> Result<(), StepError> {
        self.psi(&group.0, u, at, g)
    }
    fn dpsi_inv(
        &self,
        group: &Faulty,
        u: &AlgebraMatrix,
        at: &mut Self::At,
        v: &mut AlgebraMatrix,
    ) -> Result<(), StepError> {
        self.dpsi_inv(&group.0, u, at, v)
    }
}
