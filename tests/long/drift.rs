//! Rounding must not carry g off its group: long runs stay within 2e-14 at every step.

use crate::support::uncorrected::{Uncorrected, cpu_seconds};
use faer::Mat;
use lieflow::actions::LeftTranslation;
use lieflow::groups::{GroupMatrix, MatrixGroup, Sample, So3, Unitary};
use lieflow::maps::Exp;
use lieflow::methods::tableau::{EULER, RK4, Tableau};
use lieflow::methods::{Rk, Rkmk};
use lieflow::problems::{Flow, RigidBodyAttitude, RigidBodyN};
use lieflow::{
    Action, CoordinateMap, LieAlgebra, LieGroup, Method, Problem, RESTORE_EVERY, SaveAt, Stats,
    TimeGrid, integrate,
};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// ġ = u·g with a constant u, the worst case: each step errs the same way.
fn turning<G>(group: G, u: G::Alg) -> impl Problem<Group = G, Action = LeftTranslation>
where
    G: LieGroup,
{
    Flow::of_time(group, LeftTranslation, move |_, v: &mut G::Alg| v.clone_from(&u))
}

/// What a run found.
struct Run {
    worst: f64,
    stats: Stats,
    seconds: f64,
}

fn run<P: Problem, M: Method<P>>(problem: &P, method: &M, steps: u64, save: &SaveAt) -> Run
where
    P::Group: LieGroup<Scalar = f64>,
    P::Action: Action<P::Group, Point = <P::Group as LieGroup>::Elem>,
    Exp: CoordinateMap<P::Group>,
{
    let group = problem.group();
    let mut g = group.identity();
    let grid = TimeGrid::new([0.0, steps as f64], 1.0).expect("a grid");
    let mut worst = 0.0f64;
    let start = cpu_seconds();
    let look = |_: f64, g: &<P::Group as LieGroup>::Elem| worst = worst.max(group.defect(g));
    let stats = integrate(problem, method, &grid, save, &mut g, look).expect("a run");
    Run { worst, stats, seconds: cpu_seconds() - start }
}

fn euler() -> Rkmk<Exp, 1> {
    Rkmk::new(EULER, Exp)
}

fn scaled<G: LieGroup<Scalar = f64>>(group: &G, x: &G::Alg, norm: f64) -> G::Alg {
    let mut u = group.zero();
    group.axpy(norm / group.norm(x), x, &mut u);
    u
}

/// U(m) = G_M with M = 𝟙 + J.
fn unitary(m: usize) -> MatrixGroup {
    let form = Mat::from_fn(2 * m, 2 * m, |i, j| {
        f64::from(i == j) + f64::from(j == i + m) - f64::from(i == j + m)
    });
    MatrixGroup::gm(form).expect("U(m)")
}

/// M = 𝟙 + K with K = J and 3J in two planes: G_M = U(1)×U(1).
fn two_planes() -> Mat<f64> {
    faer::mat![
        [1.0, 1.0, 0.0, 0.0],
        [-1.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 3.0],
        [0.0, 0.0, -3.0, 1.0]
    ]
}

/// SO(8), U(2) and the elliptic directions u(2) ⊂ sp(4), by name.
fn compact() -> Vec<(&'static str, impl Problem<Group = MatrixGroup, Action = LeftTranslation>)> {
    let mut rng = Pcg64::seed_from_u64(41);
    let so8 = MatrixGroup::so(8).expect("SO(8)");
    let u2 = unitary(2);
    let sp4 = MatrixGroup::sp(4).expect("Sp(4)");
    let on_so8 = scaled(&so8, &so8.sample_algebra(&mut rng, 1.0), 1.0);
    let on_u2 = scaled(&u2, &u2.sample_algebra(&mut rng, 1.0), 1.0);
    let elliptic = scaled(&sp4, &u2.sample_algebra(&mut rng, 1.0), 1.0);
    vec![
        ("SO(8)", turning(so8, on_so8)),
        ("U(2)", turning(u2, on_u2)),
        ("Sp(4), elliptic", turning(sp4, elliptic)),
    ]
}

fn assert_held<P: Problem>(name: &str, problem: &P, steps: u64)
where
    P::Group: LieGroup<Scalar = f64>,
    P::Action: Action<P::Group, Point = <P::Group as LieGroup>::Elem>,
    Exp: CoordinateMap<P::Group>,
{
    let held = run(problem, &euler(), steps, &SaveAt::Every(1));
    let plain = run(problem, &Uncorrected(euler()), steps, &SaveAt::Ends);
    println!("{name}: {:.1e} at every step of {steps}, plain {:.1e}", held.worst, plain.worst);
    assert!(held.worst <= 2e-14, "{name}: {:e}", held.worst);
    assert!(held.stats.restored >= steps / RESTORE_EVERY);
    assert_eq!(held.stats.not_restored, 0);
    // The report is a power of two above the residual: within a factor of two of what was seen.
    assert!(held.stats.residual > 0.0 && held.stats.residual <= 4e-14, "{:?}", held.stats);
    // Without the correction the same run does drift: there is something to correct.
    assert!(plain.worst > 2e-14 && plain.stats.restored == 0, "{name}: {:e}", plain.worst);
}

const STEPS: u64 = if cfg!(debug_assertions) { 50_000 } else { 1_000_000 };

#[test]
fn compact_groups_at_every_step() {
    let so3 = So3::<f64>::new();
    assert_held("SO(3)", &turning(so3, Vector3::new(0.6, -0.3, 0.5)), STEPS);
    for (name, problem) in compact() {
        assert_held(name, &problem, STEPS);
    }
    assert_held("U(3), complex", &complex(3), STEPS);
}

/// The time of a run with what takes its state back over that without: CPU time of the thread, minima
/// over rounds that take turns. A step of Euler's method is the shortest there is, and so the worst case.
fn assert_cheap<P: Problem, const S: usize>(name: &str, problem: &P, tableau: Tableau<S>)
where
    P::Group: LieGroup<Scalar = f64>,
    P::Action: Action<P::Group, Point = <P::Group as LieGroup>::Elem>,
    Exp: CoordinateMap<P::Group>,
{
    let method = Rkmk::new(tableau, Exp);
    let plain = Uncorrected(method);
    let time = |steps| run(problem, &plain, steps, &SaveAt::Ends).seconds;
    // The clock moves in steps of some milliseconds.
    let mut steps = 1000;
    while time(steps) < 0.1 {
        steps *= 2;
    }
    let (mut with, mut without) = (f64::INFINITY, f64::INFINITY);
    let mut restored = 0;
    for _ in 0..11 {
        let held = run(problem, &method, steps, &SaveAt::Ends);
        with = with.min(held.seconds);
        without = without.min(time(steps));
        restored = held.stats.restored;
    }
    let every = steps as f64 / restored as f64;
    println!("{name}: time with/without {:.3}, restored every {every:.1} steps", with / without);
    assert!(with <= 1.1 * without, "{name}: {with} beside {without} without the correction");
}

/// With a velocity of norm 1 in a random direction.
fn constant<G: LieGroup<Scalar = f64> + Sample>(
    group: G,
) -> impl Problem<Group = G, Action = LeftTranslation> {
    let mut rng = Pcg64::seed_from_u64(43);
    let u = scaled(&group, &group.sample_algebra(&mut rng, 1.0), 1.0);
    turning(group, u)
}

/// U(m) over complex matrices.
fn complex(m: usize) -> impl Problem<Group = Unitary, Action = LeftTranslation> {
    constant(Unitary::new(m).expect("U(m)"))
}

/// Ten million steps, and what the correction costs.
#[test]
#[ignore = "two minutes, with a timing; .ci/long runs it: cargo test --release --test long drift:: -- --ignored --nocapture"]
fn ten_million_steps() {
    let so3 = turning(So3::<f64>::new(), Vector3::new(0.6, -0.3, 0.5));
    assert_held("SO(3)", &so3, 10_000_000);
    assert_cheap("SO(3)", &so3, EULER);
    for (name, problem) in compact() {
        assert_held(name, &problem, 10_000_000);
        assert_cheap(name, &problem, EULER);
    }
}

/// The same of larger matrices, in fewer steps.
#[test]
#[ignore = "a timing; .ci/long runs it: cargo test --release --test long drift:: -- --ignored --nocapture"]
fn larger_matrices() {
    let so20 = constant(MatrixGroup::so(20).expect("SO(20)"));
    assert_held("SO(20)", &so20, 200_000);
    assert_cheap("SO(20)", &so20, EULER);
    // Four products every eighth step, beside an exponential that costs no more than four: by Euler's method
    // a sixth.
    for m in [2, 5, 8] {
        let name = format!("U({m}), complex");
        assert_held(&name, &complex(m), 200_000);
        assert_cheap(&name, &complex(m), EULER);
    }
    let u5 = constant(unitary(5));
    assert_held("U(5)", &u5, 200_000);
    assert_cheap("U(5)", &u5, RK4);
}

/// Rounding of gᵀg itself is some ε·n/5: up to n = 100 the bound leaves room.
#[test]
fn large_n() {
    let group = MatrixGroup::so(100).expect("SO(100)");
    let mut rng = Pcg64::seed_from_u64(44);
    let u = scaled(&group, &group.sample_algebra(&mut rng, 1.0), 1.0);
    let steps = if cfg!(debug_assertions) { 100 } else { 2000 };
    let found = run(&turning(group, u), &euler(), steps, &SaveAt::Every(1));
    assert!(found.worst <= 2e-14, "{:e}", found.worst);
}

/// On a non-compact group the residual is reported, and nothing is made worse: beyond the reach of
/// Newton–Schulz g is left alone.
#[test]
fn hyperbolic_runs_are_reported() {
    let sp2 = MatrixGroup::sp(2).expect("Sp(2)");
    let u = sp2.algebra(faer::mat![[0.003, 0.004], [0.004, -0.003]]).expect("sp(2)");
    let problem = turning(sp2, u);
    // ‖g‖ grows as e^{0.005 k}.
    let near = run(&problem, &euler(), 1000, &SaveAt::Ends);
    let size = 2.0 * 5f64.cosh().powi(2) * 2.0;
    assert!(near.worst <= 40.0 * f64::EPSILON * size, "{:e}", near.worst);
    assert!(near.stats.restored >= 10 && near.stats.not_restored == 0);
    let far = run(&problem, &euler(), 6000, &SaveAt::Ends);
    assert!(far.worst.is_finite() && far.stats.not_restored > 0, "{:?}", far.stats);
    assert!(far.stats.residual > 1.0, "{:?}", far.stats);
}

/// One correction: from 1e-9, and from 0.01 on a cadence, to rounding; not beyond the bound.
#[test]
fn one_correction() {
    let mut rng = Pcg64::seed_from_u64(42);
    for group in [
        MatrixGroup::so(6),
        MatrixGroup::sp(4),
        MatrixGroup::indefinite(3, 1),
        Ok(unitary(2)),
        MatrixGroup::gm(two_planes()),
        MatrixGroup::gl(3),
    ] {
        let group = group.expect("a group");
        let n = group.n();
        let exact = group.sample_element(&mut rng);
        let mut scratch = [group.identity(), group.identity()];
        let off: Mat<f64> =
            MatrixGroup::gl(n).expect("GL(n)").sample_algebra(&mut rng, 1.0).into_mat();
        let mut moved = |size: f64| {
            let g = exact.as_ref() + exact.as_ref() * &off * faer::Scale(size / off.norm_l2());
            let mut g = GroupMatrix::new_unchecked(g);
            let before = group.defect(&g);
            let residual = group.correct(&mut g, scratch.each_mut());
            (before, residual, g)
        };
        let (before, residual, g) = moved(1e-9);
        let bound = 8.0 * n as f64 * f64::EPSILON * exact.norm_l2().powi(2);
        let free = group.m().is_none();
        assert!(free || (before > 1e-10 && residual > 1e-10), "{}", group.name());
        // Two planes: X♯♯ = μX with |1 + μ|/2 = cos 27°, in six passes.
        let linear = group.m().is_some_and(|m| m == two_planes());
        let bound = if linear { 0.9f64.powi(6) * before } else { bound };
        assert!(group.defect(&g) <= bound, "{}: {:e}", group.name(), group.defect(&g));
        assert!(group.distance(&g, &exact) <= 4e-9 * exact.norm_l2());
        let (before, residual, g) = moved(1.0);
        assert!(free || residual >= 0.1, "{}: {residual}", group.name());
        assert_eq!(before, group.defect(&g), "{}", group.name());
    }
}

/// M of which nothing is known: the residual is told, and g stays as it is.
#[test]
fn no_correction_that_might_diverge() {
    let m = faer::mat![[1.0, 2.0, 0.0], [0.3, -1.0, 0.5], [0.1, 0.7, 2.0]];
    let group = MatrixGroup::gm(m).expect("G_M");
    let mut g = group.identity();
    g[(0, 1)] = 1e-6;
    let before = g.clone();
    let residual = group.correct(&mut g, [&mut group.identity(), &mut group.identity()]);
    assert!(residual > 1e-7 && g == before, "{residual:e}");
}

/// The classical method leaves the group, and is shown as it is.
#[test]
fn a_method_that_leaves_the_group_is_not_helped() {
    let body = RigidBodyAttitude::<f64>::new([1.0, 2.0, 3.0], [0.2, 0.5, 3.0]).expect("a body");
    let grid = TimeGrid::with_steps([0.0, 50.0], 1000).expect("a grid");
    let mut g = Matrix3::identity();
    let method = Rk(RK4);
    let stats = integrate(&body, &method, &grid, &SaveAt::Ends, &mut g, |_, _| {}).expect("a run");
    let defect = So3::new().defect(&g);
    assert!(stats.restored == 0 && defect > 1e-8, "{stats:?}");
    assert!(0.5 * defect < stats.residual && stats.residual < 4.0 * defect, "{stats:?} {defect:e}");
    let mut g = Matrix3::identity();
    let method = Rkmk::new(RK4, Exp);
    let stats = integrate(&body, &method, &grid, &SaveAt::Ends, &mut g, |_, _| {}).expect("a run");
    assert!(stats.restored >= 10);
    assert!(So3::new().defect(&g) < 2e-14);
}

/// On a coadjoint orbit nothing is taken back: |m| shows what the rounding of exp has for a bias, at every
/// length of step and in n = 20, where exp is C(u²) + uS(u²).
#[test]
fn exp_on_so_n_has_no_preferred_side() {
    const STEPS: f64 = 20_000.0;
    /// A tenth of what an error of ε/2 to one side in every step adds up to.
    const HELD: f64 = 0.1 * 0.5 * f64::EPSILON * STEPS;
    for (n, h, steps) in [
        (3, 4e-3, STEPS),
        (3, 4e-2, STEPS),
        (8, 6e-3, STEPS / 4.0),
        (8, 1.5e-2, STEPS / 4.0),
        (8, 3e-2, STEPS / 4.0),
        (20, 4e-3, STEPS / 20.0),
    ] {
        let inertia: Vec<f64> = (0..n).map(|i| 1.0 / (1.0 + 17.0 * i as f64 / n as f64)).collect();
        let body = RigidBodyN::manakov(&inertia).expect("a body");
        let mut rng = Pcg64::seed_from_u64(4);
        let mut m = body.group().sample_algebra(&mut rng, 1.0).into_mat();
        let start = m.norm_l2();
        let grid = TimeGrid::with_steps([0.0, h * steps], steps as u64).expect("a grid");
        let method = Rkmk::new(RK4, Exp);
        integrate(&body, &method, &grid, &SaveAt::Ends, &mut m, |_, _| {}).expect("a run");
        let drift = (m.norm_l2() / start - 1.0).abs();
        assert!(
            drift <= HELD,
            "n = {n}, h = {h}: |m| has moved by {drift:.1e}, held to {HELD:.1e}"
        );
    }
}
