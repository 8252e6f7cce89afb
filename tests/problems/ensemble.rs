//! Many bodies in lanes: each as if it were alone, by the catalog's method of the same name.

use core::f64::consts::PI;

use lieflow::ensemble::{Ensemble, EnsembleMethod};
use lieflow::groups::Sample;
use lieflow::groups::So3;
use lieflow::maps::{Cay, Exp};
use lieflow::methods::tableau::RK4;
use lieflow::methods::{Method, Rk, Rkmk};
use lieflow::problems::{Exact, RigidBodyState};
use lieflow::{Error, LieGroup, RunError, SaveAt, StepError, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;

struct Bodies {
    inertia: Vec<[f64; 3]>,
    momentum: Vec<[f64; 3]>,
    attitude: Vec<Matrix3<f64>>,
}

fn bodies(len: usize, seed: u64) -> Bodies {
    let mut rng = Pcg64::seed_from_u64(seed);
    let so3 = So3::<f64>::new();
    Bodies {
        inertia: (0..len)
            .map(|_| [(); 3].map(|()| 10f64.powf(rng.random_range(-0.5..0.5))))
            .collect(),
        momentum: (0..len).map(|_| so3.sample_vector(&mut rng).into()).collect(),
        attitude: (0..len).map(|_| so3.sample_element(&mut rng)).collect(),
    }
}

fn bodies_of(len: usize) -> Ensemble {
    bodies(len, 6).ensemble()
}

impl Bodies {
    fn ensemble(&self) -> Ensemble {
        let bodies = Ensemble::new(&self.inertia, &self.momentum).expect("bodies");
        bodies.with_attitudes(&self.attitude).expect("attitudes")
    }
    /// (m, g) of body i by a method of the library.
    fn alone<M: Method<RigidBodyState>>(
        &self,
        i: usize,
        method: &M,
        h: f64,
        steps: u64,
    ) -> (Vector3<f64>, Matrix3<f64>) {
        let body = RigidBodyState::new(self.inertia[i]).expect("a body");
        let mut y = body.state(self.momentum[i], self.attitude[i]).expect("a state");
        let grid = TimeGrid::with_steps([0.0, h * steps as f64], steps).expect("a grid");
        integrate(&body, method, &grid, &SaveAt::Ends, &mut y, |_, _| {}).expect("a run");
        (y.m, y.g)
    }
}

fn each(
    i: usize,
    b: &Bodies,
    method: EnsembleMethod,
    h: f64,
    steps: u64,
) -> (Vector3<f64>, Matrix3<f64>) {
    match method {
        EnsembleMethod::Rkmk4Exp => b.alone(i, &Rkmk::new(RK4, Exp), h, steps),
        EnsembleMethod::Rkmk4Cay => b.alone(i, &Rkmk::new(RK4, Cay), h, steps),
        _ => b.alone(i, &Rk(RK4), h, steps),
    }
}

/// How far motions part, alone, that start beside one another, over how far they started.
fn parted(i: usize, all: &Bodies, method: EnsembleMethod, h: f64, steps: u64) -> f64 {
    let beside = 1e-8 * Vector3::from(all.momentum[i]).norm();
    let run = |by: [f64; 3]| {
        let mut moved = Bodies {
            inertia: vec![all.inertia[i]],
            momentum: vec![all.momentum[i]],
            attitude: vec![all.attitude[i]],
        };
        (0..3).for_each(|k| moved.momentum[0][k] += beside * by[k]);
        each(0, &moved, method, h, steps)
    };
    let (m, g) = run([0.0; 3]);
    let all = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|by| {
        let (m_by, g_by) = run(by);
        let size = 1e8 * beside;
        ((m_by - m).norm() / size).hypot((g_by - g).norm()) / 1e-8
    });
    all.into_iter().fold(0.0, f64::max)
}

const METHODS: [EnsembleMethod; 3] =
    [EnsembleMethod::Rkmk4Exp, EnsembleMethod::Rkmk4Cay, EnsembleMethod::Rk4];

/// Of small steps and of some that turn by several radians, which the scalar method takes.
#[test]
fn each_body_as_if_it_were_alone() {
    let all = bodies(150, 1);
    for method in METHODS {
        for (h, steps) in [(0.01, 300), (0.1, 100), (1.3, 10)] {
            if (method, h) == (EnsembleMethod::Rk4, 1.3) {
                continue; // it blows up, alone as well
            }
            let mut together = all.ensemble();
            let mut momenta = Ensemble::new(&all.inertia, &all.momentum).expect("bodies");
            together.advance(method, h, steps, 1).expect("a run");
            momenta.advance(method, h, steps, 1).expect("a run");
            for i in 0..all.inertia.len() {
                let (m, g) = each(i, &all, method, h, steps);
                let size = Vector3::from(all.momentum[i]).norm();
                let smallest = all.inertia[i].into_iter().fold(f64::INFINITY, f64::min);
                // Rounding of each step, and neighbouring motions that part over the run.
                let turned = h * steps as f64 * size / smallest;
                let parted = parted(i, &all, method, h, steps).max(1.0);
                let rounding = 4.0 * EPS * (steps as f64 + turned) * parted;
                let gap = (together.momentum(i).expect("a body") - m).norm() / size;
                assert!(gap <= rounding, "{method:?}, h = {h}, {i}: m {:e}", gap / rounding);
                let gap = (together.attitude(i).expect("an attitude") - g).norm();
                assert!(gap <= rounding, "{method:?}, h = {h}, {i}: g {:e}", gap / rounding);
                let gap = (momenta.momentum(i).expect("a body") - m).norm() / size;
                assert!(gap <= rounding && momenta.attitude(i).is_none(), "{method:?}, {i}");
            }
        }
    }
}

#[test]
fn order_4_against_the_exact_motion() {
    let all = bodies(64, 2);
    for method in METHODS {
        let errors = [40, 80, 160, 320].map(|steps| {
            let mut together = all.ensemble();
            together.advance(method, 1.0 / steps as f64, steps, 1).expect("a run");
            let error = |i: usize| {
                let exact = Exact::new(all.inertia[i], all.momentum[i], all.attitude[i]);
                let (m, g) = exact.and_then(|exact| exact.state(1.0)).expect("the exact motion");
                let g_error = (together.attitude(i).expect("an attitude") - g).norm_squared();
                (together.momentum(i).expect("a body") - m).norm_squared() + g_error
            };
            (0..64).map(error).sum::<f64>().sqrt()
        });
        for pair in errors.windows(2) {
            let slope = (pair[0] / pair[1]).log2();
            assert!((slope - 4.0).abs() < 0.15, "{method:?}: {slope} of {errors:?}");
        }
    }
}

#[test]
fn what_is_kept_over_a_hundred_thousand_steps() {
    let all = bodies(20, 3);
    for method in [EnsembleMethod::Rkmk4Exp, EnsembleMethod::Rkmk4Cay] {
        let mut together = all.ensemble();
        for _ in 0..100 {
            together.advance(method, 0.01, 1000, 1).expect("a run");
            for i in 0..20 {
                let g = together.attitude(i).expect("an attitude");
                assert!(
                    So3::new().defect(&g) < 2e-14,
                    "{method:?}, {i}: {:e}",
                    So3::new().defect(&g)
                );
            }
        }
        for i in 0..20 {
            let (m, start) =
                (together.momentum(i).expect("a body"), Vector3::from(all.momentum[i]));
            let space = together.attitude(i).expect("an attitude") * m;
            // It is taken back every 64 steps, each of which moves it by an ulp at most.
            let gap = (m.norm() / start.norm() - 1.0).abs() / EPS;
            assert!(gap < 64.0, "{method:?}, {i}: |m| {gap}");
            // 1e5 steps of half an ulp as a walk are 160.
            let gap = (space - all.attitude[i] * start).norm() / (EPS * start.norm());
            assert!(gap < 2000.0, "{method:?}, {i}: gm {gap}");
        }
    }
}

#[test]
fn the_same_bits_on_any_number_of_threads_and_in_any_company() {
    let all = bodies(1000, 4);
    let mut one = all.ensemble();
    one.advance(EnsembleMethod::Rkmk4Exp, 0.05, 100, 1).expect("a run");
    for threads in [2, 3, 7, 100] {
        let mut many = all.ensemble();
        many.advance(EnsembleMethod::Rkmk4Exp, 0.05, 60, threads).expect("a run");
        many.advance(EnsembleMethod::Rkmk4Exp, 0.05, 40, threads).expect("a run");
        let same = |i| one.momentum(i) == many.momentum(i) && one.attitude(i) == many.attitude(i);
        assert!((0..1000).all(same), "{threads} threads");
    }
    let late = 900..1000;
    let bodies = Ensemble::new(&all.inertia[late.clone()], &all.momentum[late]).expect("bodies");
    let mut few = bodies.with_attitudes(&all.attitude[900..]).expect("attitudes");
    few.advance(EnsembleMethod::Rkmk4Exp, 0.05, 100, 1).expect("a run");
    assert!((0..100).all(|i| few.momentum(i) == one.momentum(900 + i)));
}

#[test]
fn forward_and_back() {
    let all = bodies(10, 5);
    let mut there = all.ensemble();
    there.advance(EnsembleMethod::Rkmk4Cay, 0.01, 100, 1).expect("a run");
    there.advance(EnsembleMethod::Rkmk4Cay, -0.01, 100, 1).expect("the way back");
    let gap =
        |i: usize| (there.momentum(i).expect("a body") - Vector3::from(all.momentum[i])).norm();
    assert!((0..10).all(|i| gap(i) < 1e-6 && gap(i) > 0.0));
}

#[test]
fn what_is_refused() {
    let [good, momentum] = [[1.0, 2.0, 3.0], [0.1, 0.2, 0.3]];
    let said = |result: Result<Ensemble, Error>| result.expect_err("refused").to_string();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
        let error = said(Ensemble::new(&[good, [1.0, bad, 1.0]], &[momentum; 2]));
        assert!(error.starts_with("inertia[1][1]"), "{error}");
    }
    let error = said(Ensemble::new(&[good], &[[0.0, 0.0, f64::NAN]]));
    assert!(error.starts_with("momentum[0][2]"), "{error}");
    let error = said(Ensemble::new(&[good; 2], &[momentum]));
    assert!(error.starts_with("momentum: 1×1, expected 2×1"), "{error}");
    let mut bodies = Ensemble::new(&[good; 3], &[momentum; 3]).expect("bodies");
    let error = said(bodies.clone().with_attitudes(&[Matrix3::identity(); 2]));
    assert!(error.starts_with("attitudes: 2×1, expected 3×1"), "{error}");
    let mut attitudes = [Matrix3::identity(); 3];
    attitudes[2] *= 2.0;
    let error = said(bodies.clone().with_attitudes(&attitudes));
    assert!(error.starts_with("element 2: attitudes: not in SO(3)"), "{error}");
    // What has no reciprocal is refused with the least that has one.
    let error = said(Ensemble::new(&[[1e-310, 1.0, 1.0]], &[momentum]));
    let least = (1.0 / f64::MAX).next_up();
    assert!(error.contains(&format!("at least {least:e}")), "{error}");
    assert!(Ensemble::new(&[[least; 3]], &[momentum]).is_ok());
    assert!(Ensemble::new(&[[least.next_down(); 3]], &[momentum]).is_err());
    let mut advance = |h, threads| bodies.advance(EnsembleMethod::Rk4, h, 1, threads);
    assert!(advance(f64::NAN, 1).is_err() && advance(0.1, 0).is_err() && advance(0.0, 1).is_ok());

    // One that cannot go on: it stays where it is, and is named.
    let fast = [1.0, 1e200, -1e200];
    let mut momenta = vec![momentum; 100];
    momenta[77] = fast;
    let all_with_g = bodies_of(100);
    let mut bodies = Ensemble::new(&[good; 100], &momenta).expect("bodies");
    match bodies.advance(EnsembleMethod::Rk4, PI, 5, 2) {
        Err(Error::Element { index: 77, source }) => {
            assert!(matches!(*source, Error::Map(StepError::NonFiniteRhs { .. })), "{source}");
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(bodies.momentum(77), Some(Vector3::from(fast)));
    // Lanes that are filled up hold no bodies.
    assert!(bodies.momentum(99).is_some() && bodies.energy(99).is_some());
    assert!(bodies.momentum(100).is_none() && bodies.energy(100).is_none());
    assert!(bodies.attitude(0).is_none() && all_with_g.attitude(99).is_some());
    assert!(all_with_g.attitude(100).is_none() && all_with_g.momentum(usize::MAX).is_none());
    assert!(Ensemble::new(&[], &[]).expect("none").advance(EnsembleMethod::Rk4, 0.1, 9, 4).is_ok());
}

/// Bodies that are copied into others are these, whatever the others were.
#[test]
fn bodies_are_copied_into_others() {
    let of = |n: usize, attitudes: bool| {
        let inertia = vec![[1.0, 2.0, 3.0]; n];
        let momentum: Vec<[f64; 3]> = (0..n).map(|i| [0.1 * i as f64, 2.0, 0.3]).collect();
        let bodies = Ensemble::new(&inertia, &momentum).expect("bodies");
        match attitudes {
            true => bodies.with_attitudes(&vec![Matrix3::identity(); n]).expect("attitudes"),
            false => bodies,
        }
    };
    for (n, attitudes) in [(1, false), (130, false), (130, true)] {
        let mut bodies = of(n, attitudes);
        bodies.advance(EnsembleMethod::Rkmk4Exp, 0.1, 3, 1).expect("steps");
        for mut other in [of(130, false), of(130, true), of(7, true)] {
            other.clone_from(&bodies);
            // Both are corrected in the same step.
            let mut next = bodies.clone();
            for bodies in [&mut other, &mut next] {
                bodies.advance(EnsembleMethod::Rkmk4Exp, 0.1, 70, 1).expect("steps");
            }
            assert_eq!(other.len(), n);
            for i in 0..n + 1 {
                assert_eq!(other.momentum(i), next.momentum(i));
                assert_eq!(other.attitude(i), next.attitude(i));
            }
        }
    }
}

/// The classical method may blow g up where it keeps m. It then ends as the same method of the catalog does, and no body of
/// the block has moved in that step.
#[test]
fn attitudes_that_overflow_end_the_run() {
    let (inertia, momentum) = ([1.0, 2.0, 3.0], [0.0, 0.0, 30.0]);
    let body = RigidBodyState::new(inertia).expect("a body");
    let grid = TimeGrid::with_steps([0.0, 300.0], 300).expect("a grid");
    let mut y = body.state(momentum, Matrix3::identity()).expect("a state");
    let alone = integrate(&body, &Rk(RK4), &grid, &SaveAt::Ends, &mut y, |_, _| {});
    let Err(RunError::Step(failure)) = alone else { panic!("{alone:?}") };
    for fast in [0, 77, 129] {
        let mut momenta = [[0.1, 0.2, 0.3]; 130];
        momenta[fast] = momentum;
        let start = Ensemble::new(&[inertia; 130], &momenta).expect("bodies");
        let mut bodies = start.with_attitudes(&[Matrix3::identity(); 130]).expect("attitudes");
        let mut after = bodies.clone();
        match bodies.advance(EnsembleMethod::Rk4, 1.0, 300, 1) {
            Err(Error::Element { index, source }) => {
                assert_eq!((index, *source), (fast, Error::Map(failure.source)));
            }
            other => panic!("{other:?}"),
        }
        // Its block is at the step before, and all of its numbers are finite.
        let steps = failure.step;
        after.advance(EnsembleMethod::Rk4, 1.0, steps, 1).expect("the steps before");
        for i in (0..130).filter(|i| i / 64 == fast / 64) {
            // The scalar method took the steps, with another rounding.
            let [(m, g), (m_after, g_after)] = [&bodies, &after].map(|bodies| {
                (bodies.momentum(i).expect("a body"), bodies.attitude(i).expect("an attitude"))
            });
            let (size, gap) = (g_after.amax(), (g - g_after).amax());
            assert!((m - m_after).norm() < 1e-12 && gap < 1e-11 * size, "{i}: {gap:e} of {size:e}");
        }
    }
}

/// An attitude that another method has moved far off the rotations is not corrected: g ← g − ½g(gᵀg − 𝟙) diverges there.
#[test]
fn attitudes_far_off_the_rotations_are_not_corrected() {
    let start = Ensemble::new(&[[1.0, 2.0, 3.0]], &[[0.0, 0.0, 30.0]]).expect("a body");
    let mut body = start.with_attitudes(&[Matrix3::identity()]).expect("an attitude");
    body.advance(EnsembleMethod::Rk4, 0.5, 2, 1).expect("steps");
    let size = body.attitude(0).expect("an attitude").norm();
    assert!(size > 400.0, "{size}");
    for method in [EnsembleMethod::Rkmk4Exp, EnsembleMethod::Rkmk4Cay] {
        let mut body = body.clone();
        for _ in 0..8 {
            body.advance(method, 0.01, 64, 1).expect("steps");
            // Rotations keep the norm.
            let now = body.attitude(0).expect("an attitude").norm();
            assert!((now / size - 1.0).abs() < 1e-12, "{method:?}: {now} of {size}");
        }
    }
}

/// Where the square of |m| leaves the range of numbers, |m| is not corrected, and keeps its digits.
#[test]
fn small_momenta_keep_their_size() {
    for power in [-150, -155, -158, -160, -161, -162, -200, -300] {
        let unit = 10f64.powi(power);
        let (inertia, momentum) = ([unit, 2.0 * unit, 3.0 * unit], [0.2, 0.5, 3.0]);
        let mut body = Ensemble::new(&[inertia], &[momentum.map(|m| m * unit)]).expect("a body");
        body.advance(EnsembleMethod::Rkmk4Exp, 0.05, 6400, 1).expect("steps");
        let m = body.momentum(0).expect("a body") / unit;
        let gap = m.norm() / Vector3::from(momentum).norm() - 1.0;
        assert!(gap.abs() < 1e-12, "1e{power}: {gap:e}");
    }
}
