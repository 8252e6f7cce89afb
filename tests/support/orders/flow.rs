//! Test problems that do not commute, depend on time and depend on the state, on any group and
//! action; their reference solutions; errors of a method on them.

use faer::Mat;
use lieflow::actions::LeftTranslation;
use lieflow::maps::{Cay, CoordinateMap};
use lieflow::methods::{Method, Rk, Rkmk, tableau};
use lieflow::problems::{self, Ambient, DynFlow, PointOf, Problem, TimeAlone};
use lieflow::{Step, TimeGrid};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::super::points::Points;
use super::super::represent::Represent;
use super::super::{gap, gaussian, within};
use super::estimate::{Estimate, estimate, grid};

/// The start of every test run: not 0, so that a dropped t₀ shows.
const T0: f64 = 0.3;
/// The length of every one on a single problem.
pub(super) const SPAN: f64 = 1.0;
/// Steps of the reference, of order 8; a method of that order is tested with 20 at most.
const REFERENCE_STEPS: u64 = 256;
/// A reference must be better than this, relatively: 1/2 of the least error that is used.
const REFERENCE_ERROR: f64 = 5e-14;

/// (t, a square matrix made from the point) ↦ a matrix; its projection on 𝔤 is f(t, y).
pub(crate) type Field = Box<dyn Fn(f64, &Mat<f64>) -> Mat<f64> + Send + Sync>;

/// A test problem on any group and action; those with a field as [`clock`] are of linear type.
pub(crate) type Flow<G, A> = DynFlow<G, A, TimeAlone>;

/// ẏ = λ_*(f(t, y))(y) with f from `field`.
pub(crate) fn flow<G, A>(group: G, action: A, field: Field) -> Flow<G, A>
where
    G: Represent + Clone + 'static,
    A: Points<G> + Clone + 'static,
{
    let (of_run, points) = (group.clone(), action.clone());
    let f = move |t: f64, y: &A::Point, v: &mut G::Alg| {
        *v = of_run.nearest(&field(t, &points.square(&of_run, y)));
    };
    DynFlow::new(problems::Flow::new(group, action.clone(), f), action)
}

/// A random initial point.
pub(crate) fn start<G: Represent, A: Points<G>>(flow: &Flow<G, A>, seed: u64) -> A::Point {
    flow.action().draw(flow.group(), &mut Pcg64::seed_from_u64(seed))
}

/// `strength`·(C₀ cos 1.3t Y₀₀ + sin(C₁Y + t) + 0.7 C₂ tanh Y₁₂ + C₃Y cos t), functions by entries.
pub(crate) fn wave(n: usize, strength: f64, seed: u64) -> Field {
    let mut rng = Pcg64::seed_from_u64(seed);
    let c: [Mat<f64>; 4] = core::array::from_fn(|_| gaussian(&mut rng, n, n));
    Box::new(move |t, y| {
        let (y00, y12) = (y[(0, 0)], y[(1, 2)].tanh());
        let (fast, slow) = ((1.3 * t).cos(), t.cos());
        Mat::from_fn(n, n, |i, j| {
            let times_y = |c: &Mat<f64>| (0..n).map(|k| c[(i, k)] * y[(k, j)]).sum::<f64>();
            let constant = c[0][(i, j)] * fast * y00 + 0.7 * c[2][(i, j)] * y12;
            strength * (constant + (times_y(&c[1]) + t).sin() + times_y(&c[3]) * slow)
        })
    })
}

/// `strength`·(C₀ cos 1.3t + C₁ sin t + C₂ t e⁻ᵗ): a field of linear type, which does not look at y.
pub(crate) fn clock(n: usize, strength: f64, seed: u64) -> Field {
    let mut rng = Pcg64::seed_from_u64(seed);
    let c: [Mat<f64>; 3] = core::array::from_fn(|_| gaussian(&mut rng, n, n));
    Box::new(move |t, _| {
        let w = [(1.3 * t).cos(), t.sin(), t * (-t).exp()];
        Mat::from_fn(n, n, |i, j| strength * (0..3).map(|k| w[k] * c[k][(i, j)]).sum::<f64>())
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

/// Where a problem starts, and where it is at the end of its span.
pub(crate) struct Reference<P: Problem> {
    start: PointOf<P>,
    span: [f64; 2],
    end: Mat<f64>,
}

impl<P: Problem> Reference<P> {
    /// Where it starts.
    pub(crate) fn start(&self) -> &PointOf<P> {
        &self.start
    }

    /// Where it is at the end, in numbers.
    pub(crate) fn end(&self) -> &Mat<f64> {
        &self.end
    }

    /// The same reference for another problem on the same points.
    pub(crate) fn of_the_same_points<Q: Problem>(self, _: &Q) -> Reference<Q>
    where
        Q::Action: lieflow::Action<Q::Group, Point = PointOf<P>>,
    {
        Reference { start: self.start, span: self.span, end: self.end }
    }
}

/// y at the end of the reference's span, as numbers. The loop is a bare one: each method of the catalog on each
/// type of problem is compiled here, and once.
#[inline(never)]
pub(super) fn run<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    steps: u64,
    Reference { start, span, .. }: &Reference<P>,
) -> Result<Mat<f64>, String>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    let grid = TimeGrid::with_steps(*span, steps).map_err(|e| e.to_string())?;
    let mut y = start.clone();
    let mut work = method.work(problem, start).map_err(|e| e.to_string())?;
    for n in 0..steps {
        let (t, end) = (grid.time(n), grid.time(n + 1));
        method
            .step(problem, Step { n, t, h: end - t }, &mut y, &mut work)
            .map_err(|e| format!("step {n} of {steps}: {e}"))?;
    }
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
    reference_after(SPAN, problem, start)
}

/// [`reference`] over a span of this length.
pub(crate) fn reference_after<P: Ambient>(
    length: f64,
    problem: &P,
    start: PointOf<P>,
) -> Reference<P>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    let mut reference = Reference { start, span: [T0, T0 + length], end: Mat::new() };
    let classical = Rk(tableau::DOP853);
    let end = run(problem, &classical, REFERENCE_STEPS, &reference).unwrap();
    let size = end.norm_l2();
    let coarse = run(problem, &classical, REFERENCE_STEPS / 2, &reference).unwrap();
    within("reference against half its steps", gap(&end, &coarse) / size, REFERENCE_ERROR).unwrap();
    let on_group = Rkmk::new(tableau::DOP853, Cay);
    let other = run(problem, &on_group, REFERENCE_STEPS / 2, &reference).unwrap();
    within("reference against RKMK", gap(&end, &other) / size, REFERENCE_ERROR).unwrap();
    reference.end = end;
    reference
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
    measure_as(method.facts(problem).order, problem, method, reference)
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
    on_grid(claimed, &reference.end, &|n| run(problem, method, n, reference))
}

/// [`measure_as`] from the runs with n steps.
fn on_grid(
    claimed: usize,
    end: &Mat<f64>,
    run: &dyn Fn(u64) -> Result<Mat<f64>, String>,
) -> Result<Estimate, String> {
    let steps = grid(claimed);
    let size = end.norm_l2();
    let error = |&n: &u64| Ok(gap(&run(n)?, end) / size);
    let errors = steps.iter().map(error).collect::<Result<Vec<f64>, String>>()?;
    estimate(claimed, &steps, &errors)
}

/// So many translation problems on a group that differ in their coefficients, with their start: 𝟙,
/// where the field is as smooth as its coefficients say (sin(C₁y) is not, for large y).
pub(crate) fn family<G: Represent + Clone + 'static>(
    members: u64,
    group: &G,
    field: impl Fn(u64) -> Field,
) -> Vec<(Flow<G, LeftTranslation>, G::Elem)> {
    let member = |i| (flow(group.clone(), LeftTranslation, field(100 * i)), group.identity());
    (0..members).map(member).collect()
}

/// `$body` with `$flows` bound to so many translation problems with the field `$field`, on one group
/// after the other.
#[macro_export]
macro_rules! on_every_group {
    ($field:path, $members:expr, $flows:ident => $body:block) => {{
        use lieflow::groups::{MatrixGroup, Product, Se3, So3};
        use $crate::support::orders::family;
        {
            let $flows = family($members, &So3::new(), |i| $field(3, 0.5, 11 + i));
            $body
        }
        {
            let $flows = family($members, &Se3::new(), |i| $field(4, 0.5, 23 + i));
            $body
        }
        {
            let group = Product(So3::new(), MatrixGroup::sp(4).unwrap());
            let $flows = family($members, &group, |i| $field(7, 0.25, 11 + i));
            $body
        }
        for (group, n, strength, seed) in [
            (MatrixGroup::so(5).unwrap(), 5, 0.5, 11),
            (MatrixGroup::gl(3).unwrap(), 3, 0.2, 12),
            (MatrixGroup::sp(4).unwrap(), 4, 0.25, 12),
            (MatrixGroup::indefinite(3, 1).unwrap(), 4, 0.35, 11),
        ] {
            let $flows = family($members, &group, |i| $field(n, strength, seed + i));
            $body
        }
    }};
}
