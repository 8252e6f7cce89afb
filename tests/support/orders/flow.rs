//! Test problems that do not commute, depend on time and depend on the state, on any group and
//! action; their reference solutions; errors of a method on them.

use faer::Mat;
use lieflow::maps::{Cay, CoordinateMap};
use lieflow::methods::{Method, Rk, Rkmk, tableau};
use lieflow::problems::{Ambient, PointOf, Problem};
use lieflow::{SaveAt, TimeGrid, integrate};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::super::points::Points;
use super::super::represent::Represent;
use super::super::{gap, gaussian, within};
use super::estimate::{Estimate, estimate, grid};

/// The span of every test run: not from 0, so that a dropped t₀ shows.
const SPAN: [f64; 2] = [0.3, 1.3];
/// Steps of the reference, of order 4; a method of that order is tested with 160 at most.
const REFERENCE_STEPS: u64 = 2048;
/// A reference must be better than this, relatively: 1/10 of the least error that is used.
const REFERENCE_ERROR: f64 = 1e-12;

/// (t, a square matrix made from the point) ↦ a matrix; its projection on 𝔤 is f(t, y).
pub(crate) type Field = Box<dyn Fn(f64, &Mat<f64>) -> Mat<f64>>;

/// ẏ = λ_*(f(t, y))(y) for any group and action.
pub(crate) struct Flow<G: Represent, A: Points<G>> {
    group: G,
    action: A,
    field: Field,
}

impl<G: Represent, A: Points<G>> Flow<G, A> {
    pub(crate) fn new(group: G, action: A, field: Field) -> Self {
        Flow { group, action, field }
    }

    /// A random initial point.
    pub(crate) fn start(&self, seed: u64) -> A::Point {
        self.action.draw(&self.group, &mut Pcg64::seed_from_u64(seed))
    }

    fn xi(&self, t: f64, y: &A::Point) -> G::Alg {
        self.group.nearest(&(self.field)(t, &self.action.square(&self.group, y)))
    }
}

/// `strength`·(C₀ cos 1.3t Y₀₀ + sin(C₁Y + t) + 0.7 C₂ tanh Y₁₂ + C₃Y cos t), functions by entries.
pub(crate) fn wave(n: usize, strength: f64, seed: u64) -> Field {
    let mut rng = Pcg64::seed_from_u64(seed);
    let c: [Mat<f64>; 4] = core::array::from_fn(|_| gaussian(&mut rng, n, n));
    Box::new(move |t, y| {
        let (c1y, c3y) = (&c[1] * y, &c[3] * y);
        let (y00, y12) = (y[(0, 0)], y[(1, 2)].tanh());
        let (fast, slow) = ((1.3 * t).cos(), t.cos());
        Mat::from_fn(n, n, |i, j| {
            let constant = c[0][(i, j)] * fast * y00 + 0.7 * c[2][(i, j)] * y12;
            strength * (constant + (c1y[(i, j)] + t).sin() + c3y[(i, j)] * slow)
        })
    })
}

/// −Ω of a free body whose inertia changes with time: Ω_ij = 2 m_ij (1 + ½ sin(t + φ_ij))/J_ij.
pub(crate) fn inertia(n: usize) -> Field {
    let pair = move |i: usize, j: usize| (i.min(j) * n + i.max(j)) as f64;
    Box::new(move |t, m| {
        Mat::from_fn(n, n, |i, j| {
            let k = pair(i, j);
            -2.0 * m[(i, j)] * (1.0 + 0.5 * (t + k).sin()) / (1.0 + 0.7 * k.sqrt())
        })
    })
}

impl<G: Represent, A: Points<G>> Problem for Flow<G, A> {
    type Group = G;
    type Action = A;
    type Work = ();
    fn group(&self) -> &G {
        &self.group
    }
    fn action(&self) -> &A {
        &self.action
    }
    fn work(&self) {}
    fn f(&self, t: f64, y: &A::Point, v: &mut G::Alg, _: &mut ()) {
        *v = self.xi(t, y);
    }
}

impl<G: Represent, A: Points<G>> Ambient for Flow<G, A> {
    fn field(&self, t: f64, y: &A::Point, dy: &mut A::Point, _: &mut ()) {
        let xi = self.group.algebra_matrix(&self.xi(t, y));
        let numbers = self.action.generator(&self.group, &xi, y);
        *dy = self.action.with_numbers(&self.group, &numbers);
    }
    fn copy(&self, x: &A::Point, y: &mut A::Point) {
        y.clone_from(x);
    }
    fn add(&self, a: f64, x: &A::Point, y: &mut A::Point) {
        let numbers = |p: &A::Point| self.action.numbers(&self.group, p);
        let sum = numbers(y) + numbers(x) * faer::Scale(a);
        *y = self.action.with_numbers(&self.group, &sum);
    }
    fn is_finite(&self, y: &A::Point) -> bool {
        self.action.numbers(&self.group, y).norm_l1().is_finite()
    }
}

/// Where a problem starts, and where it is at the end of [`SPAN`].
pub(crate) struct Reference<P: Problem> {
    start: PointOf<P>,
    end: Mat<f64>,
}

impl<P: Problem> Reference<P> {
    /// Where it starts.
    pub(crate) fn start(&self) -> &PointOf<P> {
        &self.start
    }

    /// The same reference for another problem on the same points.
    pub(crate) fn of_the_same_points<Q: Problem>(self, _: &Q) -> Reference<Q>
    where
        Q::Action: lieflow::Action<Q::Group, Point = PointOf<P>>,
    {
        Reference { start: self.start, end: self.end }
    }
}

/// y at the end of [`SPAN`], as numbers.
fn run<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    steps: u64,
    start: &PointOf<P>,
) -> Result<Mat<f64>, String>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    let grid = TimeGrid::with_steps(SPAN, steps).map_err(|e| e.to_string())?;
    let mut y = start.clone();
    integrate(problem, method, &grid, &SaveAt::Ends, &mut y, |_, _| {})
        .map_err(|e| format!("{steps} steps: {e}"))?;
    Ok(problem.action().numbers(problem.group(), &y))
}

/// A reference by a classical method on the linear space around M, which knows no map, no action
/// and no bracket. Two other runs must agree with it: half its steps, and a Lie group method.
pub(crate) fn reference<P: Ambient>(problem: &P, start: PointOf<P>) -> Reference<P>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    let classical = Rk(tableau::THREE_EIGHTHS);
    let end = run(problem, &classical, REFERENCE_STEPS, &start).unwrap();
    let size = end.norm_l2();
    // Richardson: the error of the finer run is 1/15 of what the halved one differs by.
    let coarse = run(problem, &classical, REFERENCE_STEPS / 2, &start).unwrap();
    within("reference against half its steps", gap(&end, &coarse) / size, 15.0 * REFERENCE_ERROR)
        .unwrap();
    let on_group = Rkmk::new(tableau::THREE_EIGHTHS, Cay);
    let other = run(problem, &on_group, REFERENCE_STEPS / 2, &start).unwrap();
    within("reference against RKMK", gap(&end, &other) / size, 16.0 * REFERENCE_ERROR).unwrap();
    Reference { start, end }
}

/// The order that `method` shows on `problem`, against the one that it claims.
///
/// # Errors
/// As [`measure_as`].
pub(crate) fn measure<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    reference: &Reference<P>,
) -> Result<Estimate, String>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    measure_as(method.order(problem), problem, method, reference)
}

/// The order that `method` shows on `problem`, by relative errors at the end on the grid of methods
/// of order `claimed`.
///
/// # Errors
/// A run that failed, or too few errors in the estimator's window.
pub(crate) fn measure_as<P: Problem, M: Method<P>>(
    claimed: usize,
    problem: &P,
    method: &M,
    reference: &Reference<P>,
) -> Result<Estimate, String>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    let steps = grid(claimed);
    let size = reference.end.norm_l2();
    let errors = steps
        .iter()
        .map(|&n| Ok(gap(&run(problem, method, n, &reference.start)?, &reference.end) / size))
        .collect::<Result<Vec<f64>, String>>()?;
    estimate(claimed, &steps, &errors)
}
