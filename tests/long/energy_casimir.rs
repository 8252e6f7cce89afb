//! The energy and Casimir preserving method beyond matrix algebras: heavy tops, a body in a fluid and the
//! spherical pendulum on se(3)*, and Hamiltonians with a discrete gradient of their own.

use lieflow::catalog::Needs;
use lieflow::groups::{Se3, So3};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::{
    Composition, EnergyCasimir, KAHAN_LI6, Metric, OddMap, Rkmk, SUZUKI4, tableau::DOP853,
};
use lieflow::problems::{
    Ambient, DiscreteGradient, Euler, Hamiltonian, HeavyTop, Kinetic, LiePoisson, MeanGradient,
    PointOf, Problem, RigidBody, SphericalPendulum, SpinChain,
};
use lieflow::{
    Action, CoordinateMap, LieAlgebra, Method, SaveAt, Step, StepError, TimeGrid, integrate,
};
use nalgebra::Vector3;

type V = Vector3<f64>;
type Pair = (V, V);

/// The state at t in so many steps.
fn run<P: Problem<Group: LieAlgebra<Scalar = f64>>, M: Method<P>>(
    problem: &P,
    method: &M,
    start: &PointOf<P>,
    t: f64,
    steps: u64,
    mut see: impl FnMut(&PointOf<P>),
) -> PointOf<P> {
    let mut y = start.clone();
    let grid = TimeGrid::with_steps([0.0, t], steps).expect("a grid");
    integrate(problem, method, &grid, &SaveAt::Every(1), &mut y, |_, y| see(y)).expect("a run");
    y
}

/// The state at t = 1 by the method of that name. The types stand here: the whole catalog on each of these
/// problems would be half a minute of compilation.
fn by_name<
    P: LiePoisson + Problem<Group: LieAlgebra<Scalar = f64>>,
    Psi: CoordinateMap<P::Group> + OddMap,
>(
    name: &str,
    psi: Psi,
    problem: &P,
    start: &PointOf<P>,
    steps: u64,
) -> PointOf<P>
where
    EnergyCasimir<Psi>: Method<P>,
{
    let base = EnergyCasimir::new(psi);
    match name {
        "energy-casimir" => run(problem, &base, start, 1.0, steps, |_| {}),
        "energy-casimir4" => {
            run(problem, &Composition::new(base, SUZUKI4), start, 1.0, steps, |_| {})
        }
        "energy-casimir6" => {
            run(problem, &Composition::new(base, KAHAN_LI6), start, 1.0, steps, |_| {})
        }
        other => panic!("`{other}` is not measured"),
    }
}

/// Orders 2, 4 and 6 by name with both maps, and the energy and |γ|², μ·γ over 20 000 steps.
fn check<P>(title: &str, problem: &P, start: Pair)
where
    P: LiePoisson + Ambient + Problem<Group = Se3>,
    P::Action: Action<Se3, Point = Pair>,
{
    let exact = run(problem, &Rkmk::new(DOP853, Exp), &start, 1.0, 200, |_| {});
    for info in Needs::LiePoisson.methods() {
        for map in ["exp", "cay"] {
            let error = |steps| {
                let end = match map {
                    "exp" => by_name(info.name, Exp, problem, &start, steps),
                    _ => by_name(info.name, Cay, problem, &start, steps),
                };
                end.distance(&exact)
            };
            let (coarse, fine) = (error(20), error(40));
            let slope = (coarse / fine).log2();
            let order = info.order.number().expect("an order") as f64;
            assert!(
                slope > order - 0.3 || fine < 1e-13 * start.size(),
                "{title}, {} in {map}: {slope:.2}, {coarse:.1e} {fine:.1e}",
                info.name
            );
        }
    }
    let of = |y: &Pair| [problem.hamiltonian(y), y.1.norm_squared(), y.0.dot(&y.1)];
    // The terms of each may cancel; a step rounds them a few times, and steps add up as a walk.
    let size = [1.0 + start.0.norm_squared(), start.1.norm_squared(), start.0.norm()];
    let steps = 20_000;
    let bound = 64.0 * f64::EPSILON * (steps as f64).sqrt();
    let check = |drift: [f64; 3], map: &str| {
        for (drift, size) in drift.iter().zip(size) {
            assert!(*drift < bound * size, "{title}, {map}: {drift:.1e} of {size}");
        }
    };
    let first = of(&start);
    let mut drift = [0.0f64; 3];
    let mut see = |y: &Pair| {
        for ((drift, now), then) in drift.iter_mut().zip(of(y)).zip(first) {
            *drift = drift.max((now - then).abs());
        }
    };
    run(problem, &EnergyCasimir::new(Exp), &start, 400.0, steps, &mut see);
    run(problem, &EnergyCasimir::new(Cay), &start, 400.0, steps, &mut see);
    check(drift, "exp and cay");
}

#[test]
fn heavy_tops() {
    let start = (V::new(0.4, -0.3, 1.8), V::new(0.0, 0.6, 0.8));
    let top = HeavyTop::new([1.0, 1.6, 0.7], [0.2, 0.5, 0.9]).expect("a top");
    check("a top", &top.problem(), start);
    let kovalevskaya = HeavyTop::kovalevskaya(0.8, 1.1).expect("a top");
    check("Kovalevskaya's", &kovalevskaya.problem(), start);
}

#[test]
fn a_body_in_a_fluid() {
    let body = Kinetic(|m: &Pair, xi: &mut Pair| {
        xi.0 = m.0.component_div(&V::new(1.0, 2.0, 3.0));
        xi.1 = m.1.component_div(&V::new(1.5, 1.2, 1.0));
    });
    let start = (V::new(0.3, 0.1, 1.0), V::new(0.0, 0.6, 0.8));
    check("a body in a fluid", &Euler::new(Se3::<f64>::new(), body), start);
}

#[test]
fn a_spherical_pendulum() {
    let pendulum = SphericalPendulum::new(1.7).expect("a pendulum");
    let start = pendulum.state([0.6, 0.0, -0.8], [0.1, 0.9, 0.2]).expect("a state");
    check("a pendulum", &pendulum, start);
}

/// Spins without damping: the energy, and every length.
#[test]
fn a_chain_of_spins() {
    let chain = SpinChain::new(5).and_then(|chain| chain.with_anisotropy(0.4)).expect("a chain");
    let chain = chain.with_field([0.1, -0.2, 0.3]).expect("a chain");
    let spins = chain.spins(|i| V::new((i as f64).sin(), (2.0 * i as f64).cos(), 0.5));
    let start = spins.expect("spins");
    let exact = run(&chain, &Rkmk::new(DOP853, Exp), &start, 1.0, 200, |_| {});
    let error =
        |steps| run(&chain, &EnergyCasimir::new(Cay), &start, 1.0, steps, |_| {}).distance(&exact);
    let slope = (error(20) / error(40)).log2();
    assert!((slope - 2.0).abs() < 0.2, "{slope:.2}");
    let (first, steps, mut drift) = (chain.energy(&start), 4000, 0.0f64);
    let see = |s: &PointOf<SpinChain>| {
        drift = drift.max((chain.energy(s) - first).abs());
        drift = s.iter().map(|s| (s.norm() - 1.0).abs()).fold(drift, f64::max);
    };
    run(&chain, &EnergyCasimir::new(Cay), &start, 200.0, steps, see);
    // A sum of 5 × 4 terms below 1 each.
    assert!(drift < 20.0 * f64::EPSILON * (steps as f64).sqrt(), "{drift:.1e}");
    // With damping there is no such method.
    let damped = chain.with_damping(0.1).expect("a chain");
    let method = EnergyCasimir::new(Cay);
    let mut work = method.work(&damped, &start).expect("a workspace");
    let failed = method.step(&damped, Step { n: 0, t: 0.0, h: 0.1 }, &mut start.clone(), &mut work);
    assert!(matches!(failed, Err(StepError::NonFiniteRhs { .. })));
}

/// H = ½ m·J⁻¹m + ¼ Σ m_i⁴: a discrete gradient of its own, (H_i(b_i) − H_i(a_i))/(b_i − a_i) as a
/// polynomial; and the same H with the mean of gradients, which is none for it.
#[derive(Clone, Copy)]
struct Quartic {
    mean: bool,
}

const RATES: [f64; 3] = [1.0, 0.6, 0.3];

impl Hamiltonian<So3> for Quartic {
    fn value(&self, _: &So3, m: &V) -> f64 {
        (0..3).map(|i| 0.5 * RATES[i] * m[i] * m[i] + 0.25 * m[i].powi(4)).sum()
    }
    fn gradient(&self, m: &V, xi: &mut V) {
        *xi = V::from_fn(|i, _| RATES[i] * m[i] + m[i].powi(3));
    }
}

impl DiscreteGradient<So3> for Quartic {
    fn between(&self, group: &So3, a: &V, b: &V, xi: &mut V, scratch: &mut V) {
        if self.mean {
            return mean_gradient(self, group, a, b, xi, scratch);
        }
        *xi = V::from_fn(|i, _| {
            let (a, b) = (a[i], b[i]);
            0.5 * RATES[i] * (a + b) + 0.25 * (a + b) * (a * a + b * b)
        });
    }
}

/// What a quadratic H has by default.
fn mean_gradient(h: &Quartic, group: &So3, a: &V, b: &V, xi: &mut V, scratch: &mut V) {
    struct Mean(Quartic);
    impl Hamiltonian<So3> for Mean {
        fn value(&self, group: &So3, m: &V) -> f64 {
            self.0.value(group, m)
        }
        fn gradient(&self, m: &V, xi: &mut V) {
            self.0.gradient(m, xi);
        }
    }
    impl DiscreteGradient<So3> for Mean {}
    Mean(*h).between(group, a, b, xi, scratch);
}

#[test]
fn a_hamiltonian_with_a_discrete_gradient_of_its_own() {
    let start = V::new(0.7, -0.4, 0.9);
    let drift = |h: Quartic| {
        let problem = Euler::new(So3::<f64>::new(), h);
        let (first, mut worst) = (problem.energy(&start), 0.0f64);
        let see = |m: &V| worst = worst.max((problem.energy(m) - first).abs());
        run(&problem, &EnergyCasimir::new(Cay), &start, 100.0, 2000, see);
        worst
    };
    assert!(drift(Quartic { mean: false }) < 1e-13);
    assert!(drift(Quartic { mean: true }) > 1e-7, "the mean of gradients is none for degree 4");
}

/// The mean of its gradients is one for any H: polynomials of degree 4 and 14, and one that is none; near an
/// equilibrium, where |b − a| falls to rounding, and on se(3)* with order and Casimirs.
#[test]
fn the_mean_of_gradients_on_the_way_is_a_discrete_gradient() {
    let start = V::new(0.7, -0.4, 0.9);
    let drift = |value: fn(f64) -> f64, slope: fn(f64) -> f64, start: V, h: f64| {
        let energy = move |m: &V| (0..3).map(|i| RATES[i] * value(m[i])).sum::<f64>();
        let along = move |a: &V, way: Option<(&V, f64)>, xi: &mut V| {
            let m = way.map_or(*a, |(b, s)| a + (b - a) * s);
            *xi = V::from_fn(|i, _| RATES[i] * slope(m[i]));
        };
        let problem = Euler::new(So3::<f64>::new(), MeanGradient(energy, along));
        let (first, mut worst) = (problem.energy(&start), 0.0f64);
        let see = |m: &V| worst = worst.max((problem.energy(m) - first).abs() / first);
        run(&problem, &EnergyCasimir::new(Cay), &start, 2000.0 * h, 2000, see);
        worst
    };
    // A step rounds the energy a few times.
    let bound = 64.0 * f64::EPSILON * 2000f64.sqrt();
    let quartic: [fn(f64) -> f64; 2] = [|x| 0.5 * x * x + 0.25 * x.powi(4), |x| x + x.powi(3)];
    let degree14: [fn(f64) -> f64; 2] = [|x| x.powi(14), |x| 14.0 * x.powi(13)];
    let cosh: [fn(f64) -> f64; 2] = [f64::cosh, f64::sinh];
    for ([value, slope], h) in [(quartic, 0.05), (quartic, 0.3), (degree14, 0.02), (cosh, 0.2)] {
        let worst = drift(value, slope, start, h);
        assert!(worst < bound, "{worst:e}");
        // An axis is an equilibrium.
        let worst = drift(value, slope, V::new(0.0, 1e-9, 1.0), h);
        assert!(worst < bound, "{worst:e}");
    }

    // A top in a field that is none of the usual.
    let inverse = V::new(0.8, 0.6, 1.7);
    let energy = move |m: &Pair| {
        0.5 * m.0.component_mul(&inverse).dot(&m.0) + m.1[2].powi(3) - (m.1[0] + 0.3 * m.1[1]).exp()
    };
    let along = move |a: &Pair, way: Option<(&Pair, f64)>, xi: &mut Pair| {
        let (m, p) = way.map_or(*a, |(b, s)| (a.0 + (b.0 - a.0) * s, a.1 + (b.1 - a.1) * s));
        let e = (p[0] + 0.3 * p[1]).exp();
        *xi = (m.component_mul(&inverse), V::new(-e, -0.3 * e, 3.0 * p[2] * p[2]));
    };
    let problem = Euler::new(Se3::<f64>::new(), MeanGradient(energy, along));
    check("an unusual top", &problem, (V::new(0.2, 0.5, 0.3), V::new(0.6, 0.0, 0.8)));
}

/// What is left of an iteration has the same sign in each step: the energy would drift in a straight line, by 1e-11. Rounding of
/// steps grows with the root of their number.
#[test]
fn the_energy_does_not_drift_in_a_line() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    for (start, h) in [(V::new(0.2, 0.0, 3.0), 0.1), (V::new(1.0, 0.5, 0.7), 0.02)] {
        let (steps, base) = (500_000, EnergyCasimir::new(Cay));
        let energy = body.energy(&start);
        let mut drifts = Vec::new();
        let mut y = start;
        for _ in 0..4 {
            y = run(
                &body,
                &base,
                &y,
                h * f64::from(steps / 4),
                u64::from(steps as u32 / 4),
                |_| {},
            );
            drifts.push(body.energy(&y) / energy - 1.0);
        }
        assert!(drifts.iter().all(|drift| drift.abs() < 3e-13), "{start:?}, {h}: {drifts:?}");
    }
}
