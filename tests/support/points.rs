//! Points of the manifolds that the actions act on: random ones, their numbers, and the vector field
//! λ_*(ξ)(p) = d/dε Λ(exp(εξ), p) that an element of the algebra generates there.

use faer::Mat;
use lieflow::Action;
use lieflow::actions::{Coadjoint, Each, LeftTranslation, Linear, Pair, RightTranslation};
use lieflow::groups::{
    Adjoint, ComplexMatrix, MatrixGroup, Power, Product, Sample, Se3, Se23, So3, UnitQuaternions,
    Unitary, hat,
};
use lieflow::problems::{BodyFrame, BodyState};
use nalgebra::{Matrix3, Vector3};
use rand_pcg::Pcg64;

use super::gaussian;
use super::represent::{Represent, affine, blocks, complex_form, cut, faer3, order_of, real_form};

/// An action whose points the suites can draw and take apart.
pub(crate) trait Points<G: Represent>: Action<G> {
    /// A random point.
    fn draw(&self, group: &G, rng: &mut Pcg64) -> Self::Point;
    /// Its numbers.
    fn numbers(&self, group: &G, p: &Self::Point) -> Mat<f64>;
    /// The point with these numbers.
    fn with_numbers(&self, group: &G, x: &Mat<f64>) -> Self::Point;
    /// Rows and columns of the numbers of any point.
    fn shape(&self, group: &G) -> (usize, usize) {
        let p = self.draw(group, &mut rand::SeedableRng::seed_from_u64(0));
        let x = self.numbers(group, &p);
        (x.nrows(), x.ncols())
    }
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
    fn shape(&self, group: &G) -> (usize, usize) {
        (order_of(group), order_of(group))
    }
    fn generator(&self, group: &G, xi: &Mat<f64>, g: &G::Elem) -> Mat<f64> {
        xi * group.element_matrix(g)
    }
}

/// Its points are those of [`LeftTranslation`].
impl<G: Represent + Adjoint> Points<G> for RightTranslation {
    fn draw(&self, group: &G, rng: &mut Pcg64) -> G::Elem {
        LeftTranslation.draw(group, rng)
    }
    fn numbers(&self, group: &G, g: &G::Elem) -> Mat<f64> {
        LeftTranslation.numbers(group, g)
    }
    fn with_numbers(&self, group: &G, x: &Mat<f64>) -> G::Elem {
        LeftTranslation.with_numbers(group, x)
    }
    fn shape(&self, group: &G) -> (usize, usize) {
        LeftTranslation.shape(group)
    }
    fn generator(&self, group: &G, xi: &Mat<f64>, g: &G::Elem) -> Mat<f64> {
        group.element_matrix(g) * xi * faer::Scale(-1.0)
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
        group.tangent_matrix(xi, &group.vector_matrix(x))
    }
    /// Column j is x/(j + 1).
    fn square(&self, group: &G, x: &G::Vector) -> Mat<f64> {
        let x = group.vector_matrix(x);
        Mat::from_fn(x.nrows(), x.nrows(), |i, j| x[(i, 0)] / (j + 1) as f64)
    }
}

/// (m, g) as a column of 12 numbers.
impl Points<So3> for BodyFrame {
    fn draw(&self, group: &So3, rng: &mut Pcg64) -> BodyState {
        let m = gaussian(rng, 3, 1);
        BodyState { m: group.vector_of(&m), g: group.sample_element(rng) }
    }
    fn numbers(&self, _: &So3, p: &BodyState) -> Mat<f64> {
        Mat::from_fn(12, 1, |i, _| if i < 3 { p.m[i] } else { p.g[i - 3] })
    }
    fn with_numbers(&self, _: &So3, x: &Mat<f64>) -> BodyState {
        let numbers = |from| move |i: usize| x[(from + i, 0)];
        BodyState {
            m: Vector3::from_iterator((0..3).map(numbers(0))),
            g: Matrix3::from_iterator((0..9).map(numbers(3))),
        }
    }
    fn generator(&self, group: &So3, xi: &Mat<f64>, p: &BodyState) -> Mat<f64> {
        let xi = hat(&group.nearest(xi));
        self.numbers(group, &BodyState { m: xi * p.m, g: p.g * xi.transpose() })
    }
    fn square(&self, _: &So3, p: &BodyState) -> Mat<f64> {
        faer3(&p.g)
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

impl Points<UnitQuaternions> for Coadjoint {
    fn draw(&self, group: &UnitQuaternions, rng: &mut Pcg64) -> Vector3<f64> {
        group.sample_vector(rng)
    }
    fn numbers(&self, group: &UnitQuaternions, m: &Vector3<f64>) -> Mat<f64> {
        group.vector_matrix(m)
    }
    fn with_numbers(&self, group: &UnitQuaternions, x: &Mat<f64>) -> Vector3<f64> {
        group.vector_of(x)
    }
    fn generator(&self, group: &UnitQuaternions, xi: &Mat<f64>, m: &Vector3<f64>) -> Mat<f64> {
        group.tangent_matrix(xi, &group.vector_matrix(m))
    }
}

impl Points<Unitary> for Coadjoint {
    fn draw(&self, group: &Unitary, rng: &mut Pcg64) -> ComplexMatrix {
        group.sample_algebra(rng, 1.0)
    }
    fn numbers(&self, _: &Unitary, m: &ComplexMatrix) -> Mat<f64> {
        real_form(m)
    }
    fn with_numbers(&self, _: &Unitary, x: &Mat<f64>) -> ComplexMatrix {
        complex_form(x)
    }
    /// −ad*_ξ m = [ξ, m].
    fn generator(&self, _: &Unitary, xi: &Mat<f64>, m: &ComplexMatrix) -> Mat<f64> {
        let m = real_form(m);
        xi * &m - &m * xi
    }
}

/// (μ, π) as six numbers.
impl Points<Se3> for Coadjoint {
    fn draw(&self, group: &Se3, rng: &mut Pcg64) -> (Vector3<f64>, Vector3<f64>) {
        self.with_numbers(group, &gaussian(rng, 6, 1))
    }
    fn numbers(&self, _: &Se3, m: &(Vector3<f64>, Vector3<f64>)) -> Mat<f64> {
        Mat::from_fn(6, 1, |i, _| if i < 3 { m.0[i] } else { m.1[i - 3] })
    }
    fn with_numbers(&self, _: &Se3, x: &Mat<f64>) -> (Vector3<f64>, Vector3<f64>) {
        (Vector3::from_fn(|i, _| x[(i, 0)]), Vector3::from_fn(|i, _| x[(i + 3, 0)]))
    }
    /// −ad*_ξ m by its definition: ⟨−ad*_ξ m, e⟩ = −⟨m, [ξ, e]⟩ for a basis of e.
    fn generator(&self, group: &Se3, xi: &Mat<f64>, m: &(Vector3<f64>, Vector3<f64>)) -> Mat<f64> {
        let xi = group.nearest(xi);
        Mat::from_fn(6, 1, |i, _| {
            let e = Mat::from_fn(6, 1, |k, _| if k == i { 1.0 } else { 0.0 });
            -group.pair(m, &group.commutator(&xi, &self.with_numbers(group, &e)))
        })
    }
    fn square(&self, _: &Se3, m: &(Vector3<f64>, Vector3<f64>)) -> Mat<f64> {
        affine(&faer3(&hat(&m.0)), &m.1, 0.0)
    }
}

impl Points<Se23> for Coadjoint {
    fn draw(&self, group: &Se23, rng: &mut Pcg64) -> Self::Point {
        self.with_numbers(group, &gaussian(rng, 9, 1))
    }
    fn numbers(&self, _: &Se23, m: &Self::Point) -> Mat<f64> {
        Mat::from_fn(9, 1, |i, _| [m.0, m.1.0, m.1.1][i / 3][i % 3])
    }
    fn with_numbers(&self, _: &Se23, x: &Mat<f64>) -> Self::Point {
        let three = |first: usize| Vector3::from_fn(|i, _| x[(first + i, 0)]);
        (three(0), (three(3), three(6)))
    }
    /// As on SE(3).
    fn generator(&self, group: &Se23, xi: &Mat<f64>, m: &Self::Point) -> Mat<f64> {
        let xi = group.nearest(xi);
        Mat::from_fn(9, 1, |i, _| {
            let e = Mat::from_fn(9, 1, |k, _| if k == i { 1.0 } else { 0.0 });
            -group.pair(m, &group.commutator(&xi, &self.with_numbers(group, &e)))
        })
    }
    fn square(&self, group: &Se23, m: &Self::Point) -> Mat<f64> {
        group.algebra_matrix(m)
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

/// Part by part, as blocks.
impl<A: Represent, B: Represent, L: Points<A>, R: Points<B>> Points<Product<A, B>> for Pair<L, R> {
    fn draw(&self, group: &Product<A, B>, rng: &mut Pcg64) -> Self::Point {
        (self.0.draw(&group.0, rng), self.1.draw(&group.1, rng))
    }
    fn numbers(&self, group: &Product<A, B>, p: &Self::Point) -> Mat<f64> {
        blocks(&[self.0.numbers(&group.0, &p.0), self.1.numbers(&group.1, &p.1)])
    }
    fn with_numbers(&self, group: &Product<A, B>, x: &Mat<f64>) -> Self::Point {
        let parts = cut(x, [self.0.shape(&group.0), self.1.shape(&group.1)]);
        (self.0.with_numbers(&group.0, &parts[0]), self.1.with_numbers(&group.1, &parts[1]))
    }
    fn generator(&self, group: &Product<A, B>, xi: &Mat<f64>, p: &Self::Point) -> Mat<f64> {
        let (m, n) = (order_of(&group.0), order_of(&group.1));
        let xi = cut(xi, [(m, m), (n, n)]);
        let first = self.0.generator(&group.0, &xi[0], &p.0);
        blocks(&[first, self.1.generator(&group.1, &xi[1], &p.1)])
    }
    fn square(&self, group: &Product<A, B>, p: &Self::Point) -> Mat<f64> {
        blocks(&[self.0.square(&group.0, &p.0), self.1.square(&group.1, &p.1)])
    }
}

/// Copy by copy, as blocks.
impl<G: Represent, L: Points<G>> Points<Power<G>> for Each<L> {
    fn draw(&self, group: &Power<G>, rng: &mut Pcg64) -> Self::Point {
        (0..group.copies()).map(|_| self.0.draw(group.group(), rng)).collect()
    }
    fn numbers(&self, group: &Power<G>, p: &Self::Point) -> Mat<f64> {
        blocks(&p.iter().map(|p| self.0.numbers(group.group(), p)).collect::<Vec<_>>())
    }
    fn with_numbers(&self, group: &Power<G>, x: &Mat<f64>) -> Self::Point {
        let (rows, cols) = (x.nrows() / group.copies(), x.ncols() / group.copies());
        let parts = cut(x, vec![(rows, cols); group.copies()]);
        parts.iter().map(|x| self.0.with_numbers(group.group(), x)).collect()
    }
    fn generator(&self, group: &Power<G>, xi: &Mat<f64>, p: &Self::Point) -> Mat<f64> {
        let n = order_of(group.group());
        let xi = cut(xi, vec![(n, n); group.copies()]);
        let parts = xi.iter().zip(p).map(|(xi, p)| self.0.generator(group.group(), xi, p));
        blocks(&parts.collect::<Vec<_>>())
    }
    fn square(&self, group: &Power<G>, p: &Self::Point) -> Mat<f64> {
        blocks(&p.iter().map(|p| self.0.square(group.group(), p)).collect::<Vec<_>>())
    }
}

/// `Coadjoint` on products is the coadjoint action of each part.
macro_rules! coadjoint_by_parts {
    ([$($parameters:tt)*] $group:ty, $parts:expr, [$($bounds:tt)*]) => {
        impl<$($parameters)*> Points<$group> for Coadjoint where $($bounds)* {
            fn draw(&self, group: &$group, rng: &mut Pcg64) -> Self::Point {
                $parts.draw(group, rng)
            }
            fn numbers(&self, group: &$group, p: &Self::Point) -> Mat<f64> {
                $parts.numbers(group, p)
            }
            fn with_numbers(&self, group: &$group, x: &Mat<f64>) -> Self::Point {
                $parts.with_numbers(group, x)
            }
            fn generator(&self, group: &$group, xi: &Mat<f64>, p: &Self::Point) -> Mat<f64> {
                $parts.generator(group, xi, p)
            }
            fn square(&self, group: &$group, p: &Self::Point) -> Mat<f64> {
                $parts.square(group, p)
            }
        }
    };
}
coadjoint_by_parts!(
    [A: Represent, B: Represent] Product<A, B>,
    Pair(Coadjoint, Coadjoint),
    [Coadjoint: Points<A> + Points<B>]
);
coadjoint_by_parts!([G: Represent] Power<G>, Each(Coadjoint), [Coadjoint: Points<G>]);
