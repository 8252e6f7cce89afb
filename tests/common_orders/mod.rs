//! Problems that do not commute and depend on time and state, and an order estimator that knows the
//! ratio of its grid.
#![allow(dead_code, unreachable_pub)] // each test file uses a part

use faer::Mat;
use lieflow::actions::LeftTranslation;
use lieflow::groups::{AlgebraMatrix, GroupMatrix, LieGroup, MatrixGroup, So3, vee};
use lieflow::methods::{Metric, Rk, tableau::DOP853};
use lieflow::problems::{Ambient, LinearField, PointOf, Problem};
use lieflow::{LieAlgebra, Method, SaveAt, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// A group whose elements can be read and written as matrices.
pub trait Layer: LieGroup<Scalar = f64, Elem: Metric<Scalar = f64>> {
    fn size(&self) -> usize;
    fn read(&self, g: &Self::Elem) -> Mat<f64>;
    fn write(&self, x: &Mat<f64>, g: &mut Self::Elem);
    /// The projection of x onto the algebra, times ½.
    fn half_projection(&self, x: &Mat<f64>, v: &mut Self::Alg);
    fn hat(&self, v: &Self::Alg) -> Mat<f64>;
}

impl Layer for So3 {
    fn size(&self) -> usize {
        3
    }
    fn read(&self, g: &Matrix3<f64>) -> Mat<f64> {
        Mat::from_fn(3, 3, |i, j| g[(i, j)])
    }
    fn write(&self, x: &Mat<f64>, g: &mut Matrix3<f64>) {
        *g = Matrix3::from_fn(|i, j| x[(i, j)]);
    }
    fn half_projection(&self, x: &Mat<f64>, v: &mut Vector3<f64>) {
        *v = vee(&Matrix3::from_fn(|i, j| 0.25 * (x[(i, j)] - x[(j, i)])));
    }
    fn hat(&self, v: &Vector3<f64>) -> Mat<f64> {
        let m = lieflow::groups::hat(v);
        Mat::from_fn(3, 3, |i, j| m[(i, j)])
    }
}

impl Layer for MatrixGroup {
    fn size(&self) -> usize {
        self.n()
    }
    fn read(&self, g: &GroupMatrix) -> Mat<f64> {
        (**g).clone()
    }
    fn write(&self, x: &Mat<f64>, g: &mut GroupMatrix) {
        g.copy_from(x);
    }
    fn half_projection(&self, x: &Mat<f64>, v: &mut AlgebraMatrix) {
        self.set_zero(v);
        self.axpy(0.5, &self.project_algebra(x.as_ref()), v);
    }
    fn hat(&self, v: &AlgebraMatrix) -> Mat<f64> {
        (**v).clone()
    }
}

/// ẏ = ½ proj(C₀ cos(1.3t) y₀₀ + sin(C₁y + t) + 0.7 C₂ tanh(y₁₂) + C₃ y cos t)·y.
pub struct Nonlinear<G> {
    pub group: G,
    c: [Mat<f64>; 4],
}

/// ẏ = ¾ proj(C₀ cos 1.3t + C₁ sin t + C₂ t e⁻ᵗ)·y.
pub struct TimeOnly<G> {
    pub group: G,
    c: [Mat<f64>; 4],
}

fn coefficients(n: usize, seed: u64) -> [Mat<f64>; 4] {
    let mut rng = Pcg64::seed_from_u64(seed);
    let scale = 2.0 / n as f64; // so that ‖f‖ is about 1 whatever n
    std::array::from_fn(|_| Mat::from_fn(n, n, |_, _| scale * rng.sample::<f64, _>(StandardNormal)))
}

macro_rules! problems {
    ($($name:ident)*) => {$(
        impl<G: Layer> $name<G> {
            pub fn new(group: G) -> Self {
                let c = coefficients(group.size(), 7);
                $name { group, c }
            }
        }
        impl<G: Layer> Problem for $name<G> {
            type Group = G;
            type Action = LeftTranslation;
            type Work = ();
            fn group(&self) -> &G {
                &self.group
            }
            fn action(&self) -> &LeftTranslation {
                &LeftTranslation
            }
            fn work(&self) {}
            fn f(&self, t: f64, y: &G::Elem, v: &mut G::Alg, _: &mut ()) {
                let x = self.ambient(t, &self.group.read(y));
                self.group.half_projection(&x, v);
            }
        }
        impl<G: Layer> Ambient for $name<G> {
            fn field(&self, t: f64, y: &G::Elem, dy: &mut G::Elem, _: &mut ()) {
                let mut v = self.group.zero();
                self.f(t, y, &mut v, &mut ());
                self.group.write(&(self.group.hat(&v) * self.group.read(y)), dy);
            }
            fn copy(&self, x: &G::Elem, y: &mut G::Elem) {
                y.clone_from(x);
            }
            fn add(&self, a: f64, x: &G::Elem, y: &mut G::Elem) {
                let sum = self.group.read(y) + self.group.read(x) * faer::Scale(a);
                self.group.write(&sum, y);
            }
            fn is_finite(&self, y: &G::Elem) -> bool {
                Metric::size(y).is_finite()
            }
        }
    )*};
}
problems!(Nonlinear TimeOnly);

impl<G: Layer> Nonlinear<G> {
    fn ambient(&self, t: f64, y: &Mat<f64>) -> Mat<f64> {
        let ([c0, c1, c2, c3], n) = (&self.c, self.group.size());
        let (c1y, c3y) = (c1 * y, c3 * y);
        let (a, b) = ((1.3 * t).cos() * y[(0, 0)], 0.7 * y[(1, 2)].tanh());
        Mat::from_fn(n, n, |i, j| {
            a * c0[(i, j)] + (c1y[(i, j)] + t).sin() + b * c2[(i, j)] + c3y[(i, j)] * t.cos()
        })
    }
}

impl<G: Layer> TimeOnly<G> {
    fn ambient(&self, t: f64, _: &Mat<f64>) -> Mat<f64> {
        let ([c0, c1, c2, _], n) = (&self.c, self.group.size());
        let (a, b, c) = ((1.3 * t).cos(), t.sin(), t * (-t).exp());
        Mat::from_fn(n, n, |i, j| 1.5 * (a * c0[(i, j)] + b * c1[(i, j)] + c * c2[(i, j)]))
    }
}

impl<G: Layer> LinearField for TimeOnly<G> {
    fn a(&self, t: f64, v: &mut G::Alg, _: &mut ()) {
        self.group.half_projection(&self.ambient(t, &Mat::zeros(0, 0)), v);
    }
}

/// The end of every run here.
pub const T1: f64 = 3.0;

/// y at T1 by `steps` steps.
pub fn try_run<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    start: &PointOf<P>,
    steps: u64,
) -> Option<PointOf<P>> {
    let mut y = start.clone();
    let grid = TimeGrid::with_steps([0.0, T1], steps).expect("a grid");
    integrate(problem, method, &grid, &SaveAt::Ends, &mut y, |_, _| {}).ok().map(|_| y)
}

/// y at T1 by a method that knows nothing of groups: order 8 on the entries.
pub fn reference<P: Ambient>(problem: &P, start: &PointOf<P>) -> PointOf<P> {
    try_run(problem, &Rk(DOP853), start, 600).expect("a smooth problem")
}

/// Numbers of steps, fixed here once for every method, with ratios near 5/4.
const STEPS: [u64; 23] = [
    4, 5, 6, 8, 10, 12, 15, 19, 24, 30, 38, 48, 60, 75, 94, 118, 148, 185, 231, 289, 361, 451, 564,
];

/// The pairwise slopes of the errors, between neighbours of the grid.
pub fn slopes(errors: &[f64], steps: &[u64]) -> Vec<f64> {
    let pair =
        |i: usize| (errors[i] / errors[i + 1]).ln() / (steps[i + 1] as f64 / steps[i] as f64).ln();
    (0..errors.len() - 1).map(pair).collect()
}

/// Orders that were measured: all are printed, and all must hold.
#[derive(Default)]
pub struct Verdict {
    wrong: Vec<String>,
}

impl Verdict {
    pub fn add(&mut self, what: &str, holds: bool, found: &Measured) {
        let errors: Vec<_> = found.errors.iter().map(|e| format!("{e:.1e}")).collect();
        let line = format!("{what}: {:.3?} [{}]", found.slopes, errors.join(", "));
        println!("{line}");
        if !holds {
            self.wrong.push(line);
        }
    }
    pub fn assert(self) {
        assert!(self.wrong.is_empty(), "not of their order:\n{}", self.wrong.join("\n"));
    }
}

/// The last four errors that are not below 1e-11, and the three slopes between them.
pub struct Measured {
    pub errors: Vec<f64>,
    pub slopes: Vec<f64>,
}

pub fn measure<P: Ambient, M: Method<P>>(
    problem: &P,
    method: &M,
    start: &PointOf<P>,
    exact: &PointOf<P>,
) -> Measured
where
    PointOf<P>: Metric<Scalar = f64>,
{
    let mut errors = Vec::new();
    for n in STEPS {
        // A step that is far too large may fail, which is no error of the method.
        let error = try_run(problem, method, start, n).map_or(f64::INFINITY, |y| y.distance(exact));
        if error < 1e-11 {
            break;
        }
        errors.push(error);
    }
    let first = errors.len().saturating_sub(4);
    let (errors, steps) = (&errors[first..], &STEPS[first..]);
    Measured { errors: errors.to_vec(), slopes: slopes(errors, steps) }
}

impl Measured {
    /// Are there three slopes within 0.15 of p, and the errors behind them below 1e-3? At order 8
    /// within 1/4: three steps further on is rounding.
    pub fn is(&self, p: usize) -> bool {
        let within = if p < 8 { 0.15 } else { 0.25 };
        self.all(|s| (s - p as f64).abs() < within)
    }
    /// Do all slopes lie above p − ¾? For a tableau whose order conditions are checked elsewhere, one
    /// by one: a pair with a leading error as small as DOPRI5's reaches its slope beyond rounding, but
    /// one that loses an order on a manifold is seen.
    pub fn at_least(&self, p: usize) -> bool {
        self.all(|s| s > p as f64 - 0.75)
    }
    fn all(&self, holds: impl Fn(f64) -> bool) -> bool {
        self.slopes.len() == 3
            && self.slopes.iter().all(|s| holds(*s))
            && self.errors.iter().all(|e| *e < 1e-3)
    }
}

/// The groups that orders are measured on.
#[macro_export]
macro_rules! on_every_group {
    ($group:ident => $body:block) => {{
        {
            let $group = lieflow::groups::So3::new();
            $body
        }
        for $group in [
            MatrixGroup::so(5).expect("SO(5)"),
            MatrixGroup::gl(3).expect("GL(3)"),
            MatrixGroup::sp(4).expect("Sp(4)"),
            MatrixGroup::indefinite(3, 1).expect("SO(3,1)"),
        ] {
            $body
        }
    }};
}
