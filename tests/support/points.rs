//! Points of the manifolds that the actions act on: random ones, their numbers, and the vector field
//! λ_*(ξ)(p) = d/dε Λ(exp(εξ), p) that an element of the algebra generates there.

use faer::Mat;
use lieflow::Action;
use lieflow::actions::{Coadjoint, LeftTranslation, Linear};
use lieflow::groups::{MatrixGroup, So3, hat};
use nalgebra::Vector3;
use rand_pcg::Pcg64;

use super::gaussian;
use super::represent::Represent;

/// An action whose points the suites can draw and take apart.
pub(crate) trait Points<G: Represent>: Action<G> {
    /// A random point.
    fn draw(&self, group: &G, rng: &mut Pcg64) -> Self::Point;
    /// Its numbers.
    fn numbers(&self, group: &G, p: &Self::Point) -> Mat<f64>;
    /// The point with these numbers.
    fn with_numbers(&self, group: &G, x: &Mat<f64>) -> Self::Point;
    /// The numbers of λ_*(ξ)(p).
    fn generator(&self, group: &G, xi: &Mat<f64>, p: &Self::Point) -> Mat<f64>;
    /// An n×n matrix made from p, smooth in p: what test fields are functions of.
    fn square(&self, group: &G, p: &Self::Point) -> Mat<f64> {
        self.numbers(group, p)
    }
}

impl<G: Represent> Points<G> for LeftTranslation {
    fn draw(&self, group: &G, rng: &mut Pcg64) -> G::Elem {
        group.sample_element(rng)
    }
    fn numbers(&self, group: &G, g: &G::Elem) -> Mat<f64> {
        group.element_matrix(g)
    }
    fn with_numbers(&self, group: &G, x: &Mat<f64>) -> G::Elem {
        group.element_of(x)
    }
    fn generator(&self, group: &G, xi: &Mat<f64>, g: &G::Elem) -> Mat<f64> {
        xi * group.element_matrix(g)
    }
}

impl<G: Represent> Points<G> for Linear {
    fn draw(&self, group: &G, rng: &mut Pcg64) -> G::Vector {
        group.sample_vector(rng)
    }
    fn numbers(&self, group: &G, x: &G::Vector) -> Mat<f64> {
        group.vector_matrix(x)
    }
    fn with_numbers(&self, group: &G, x: &Mat<f64>) -> G::Vector {
        group.vector_of(x)
    }
    fn generator(&self, group: &G, xi: &Mat<f64>, x: &G::Vector) -> Mat<f64> {
        xi * group.vector_matrix(x)
    }
    /// Column j is x/(j + 1).
    fn square(&self, group: &G, x: &G::Vector) -> Mat<f64> {
        let x = group.vector_matrix(x);
        Mat::from_fn(x.nrows(), x.nrows(), |i, j| x[(i, 0)] / (j + 1) as f64)
    }
}

impl Points<So3> for Coadjoint {
    fn draw(&self, group: &So3, rng: &mut Pcg64) -> Vector3<f64> {
        group.vector_of(&gaussian(rng, 3, 1))
    }
    fn numbers(&self, group: &So3, m: &Vector3<f64>) -> Mat<f64> {
        group.vector_matrix(m)
    }
    fn with_numbers(&self, group: &So3, x: &Mat<f64>) -> Vector3<f64> {
        group.vector_of(x)
    }
    fn generator(&self, group: &So3, xi: &Mat<f64>, m: &Vector3<f64>) -> Mat<f64> {
        xi * group.vector_matrix(m)
    }
    fn square(&self, _: &So3, m: &Vector3<f64>) -> Mat<f64> {
        super::represent::faer3(&hat(m))
    }
}

/// 𝔤* as n×n matrices with ⟨m, v⟩ = tr(mᵀv).
impl Points<MatrixGroup> for Coadjoint {
    fn draw(&self, group: &MatrixGroup, rng: &mut Pcg64) -> Mat<f64> {
        gaussian(rng, group.n(), group.n())
    }
    fn numbers(&self, _: &MatrixGroup, m: &Mat<f64>) -> Mat<f64> {
        m.clone()
    }
    fn with_numbers(&self, _: &MatrixGroup, x: &Mat<f64>) -> Mat<f64> {
        x.clone()
    }
    /// −ad*_ξ m: ⟨−ad*_ξ m, v⟩ = −⟨m, [ξ, v]⟩, so that it is mξᵀ − ξᵀm.
    fn generator(&self, _: &MatrixGroup, xi: &Mat<f64>, m: &Mat<f64>) -> Mat<f64> {
        m * xi.transpose() - xi.transpose() * m
    }
}
