//! Vectors, spins and pendulums over 100 000 steps: nothing takes them back to their spheres, and nothing
//! needs to. Rounding walks at random, ½ε√n at most in what was measured; only where every step is the
//! same rotation it errs the same way each time, by less than ε/4 a step.

use lieflow::actions::Linear;
use lieflow::groups::{LieAlgebra, So3};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::magnus::Magnus4;
use lieflow::methods::{CommutatorFree, Method, Rkmk, commutator_free::CF4, tableau::RK4};
use lieflow::problems::{LinearEquation, PointOf, Problem, SphericalPendulum, SpinChain};
use lieflow::{SaveAt, TimeGrid, integrate};
use nalgebra::Vector3;

type V = Vector3<f64>;

const STEPS: u64 = 100_000;
const EPS: f64 = f64::EPSILON;

/// The largest change of `length`, which is 1, on the way.
fn drift<P, M>(
    problem: &P,
    method: &M,
    start: &PointOf<P>,
    length: impl Fn(&PointOf<P>) -> f64,
) -> f64
where
    P: Problem<Group: LieAlgebra<Scalar = f64>>,
    M: Method<P>,
{
    let (mut y, mut worst) = (start.clone(), 0.0f64);
    let grid = TimeGrid::with_steps([0.0, 0.05 * STEPS as f64], STEPS).expect("a grid");
    integrate(problem, method, &grid, &SaveAt::Every(10), &mut y, |_, y| {
        worst = worst.max((length(y) - 1.0).abs());
    })
    .expect("a run");
    worst
}

/// Four times what was measured.
const WALK: f64 = 2.0;

#[test]
fn spins_stay_on_their_spheres() {
    let bound = WALK * EPS * (STEPS as f64).sqrt();
    let turning = |t: f64, v: &mut V| *v = V::new(t.cos(), t.sin(), 0.7);
    let spin = LinearEquation::new(So3::<f64>::new(), Linear, turning);
    let start = V::new(0.6, 0.0, 0.8);
    let found = [
        drift(&spin, &Rkmk::new(RK4, Exp), &start, V::norm),
        drift(&spin, &Rkmk::new(RK4, Cay), &start, V::norm),
        drift(&spin, &CommutatorFree(CF4), &start, V::norm),
        drift(&spin, &Magnus4, &start, V::norm),
    ];
    assert!(found.iter().all(|x| *x < bound), "{found:.1?} {bound:.1e}");

    let chain = SpinChain::new(4).expect("a chain").with_anisotropy(0.1).expect("a chain");
    let spins = chain.spins(|i| V::new((i as f64).sin(), (i as f64).cos(), 1.0)).expect("spins");
    for k in 0..2 {
        let found = drift(&chain, &Rkmk::new(RK4, Cay), &spins, |s| s[k].norm());
        assert!(found < bound, "spin {k}: {found:.1e}");
    }
}

#[test]
fn a_pendulum_stays_on_its_orbit() {
    let bound = WALK * EPS * (STEPS as f64).sqrt();
    let pendulum = SphericalPendulum::new(1.0).expect("a pendulum");
    let start = pendulum.state([0.6, 0.0, -0.8], [0.1, 0.9, 0.2]).expect("a state");
    let length = drift(&pendulum, &Rkmk::new(RK4, Exp), &start, |y| y.1.norm());
    let along = drift(&pendulum, &Rkmk::new(RK4, Exp), &start, |y| 1.0 + y.0.dot(&y.1));
    assert!(length < bound && along < bound, "{length:.1e} {along:.1e}");
}

#[test]
fn the_same_rotation_at_every_step_errs_the_same_way() {
    let start = V::new(0.6, 0.0, 0.8);
    let of = |k: i32| {
        let a = f64::from(k);
        let u = V::new((1.3 * a).sin(), (2.7 * a + 1.0).cos(), 1.5 * (0.77 * a).sin());
        let field = move |_: f64, v: &mut V| *v = u;
        let spin = LinearEquation::new(So3::<f64>::new(), Linear, field);
        drift(&spin, &Magnus4, &start, V::norm)
    };
    let worst = (0..12).map(of).fold(0.0, f64::max);
    assert!(worst < 0.25 * EPS * STEPS as f64, "{worst:.1e}");
}
