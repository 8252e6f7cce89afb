//! A run with events, output times, stops and a watch allocates before its first step, and where a zero is stored.

use lieflow::groups::{LieGroup, Sample};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::commutator_free::CF43;
use lieflow::methods::tableau::{DOP853, DOPRI5};
use lieflow::methods::{CommutatorFree, Doubling, Rkmk};
use lieflow::problems::{Problem, RigidBodyN, RigidBodyNAttitude};
use lieflow::solve::Next;
use lieflow::{Event, Solve};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::counting;

/// As often in a long run as in a short one, with a hundred times as much to look at.
#[test]
fn events_and_output() {
    let body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0]).expect("a body");
    let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(1), 1.0).into_mat();
    let attitude = RigidBodyNAttitude::new(body.clone(), m).expect("a body");
    let start = attitude.group().identity();
    macro_rules! check {
        ($($method:expr),*) => {$(for adaptive in [true, false] {
            let method = $method;
            let run = |end: f64| {
                // What a run is given is made before.
                let start = start.clone();
                let times: Vec<f64> = (0..200).map(|i| end * f64::from(i) / 199.0).collect();
                let solve = Solve::new(&attitude, &method, [0.0, end])
                    .times(times)
                    .stops([0.123 * end, 0.7 * end])
                    .event(Event::new("never", |t, g: &lieflow::groups::GroupMatrix| g[(0, 0)] + t + 2.0).points(5))
                    .event(Event::new("far", |_, g: &lieflow::groups::GroupMatrix| g[(0, 1)] - 2.0));
                let solve = if adaptive { solve.tolerances(1e-6, 1e-6) } else { solve.dt(0.01) };
                let before = counting::total();
                let done = solve.run_with(start, |_, _| Next::Continue).expect("a run");
                assert!(done.stats.points_within > 0);
                let count = counting::total() - before;
                (done.stats.accepted, count)
            };
            run(0.1);
            let (short, long) = (run(0.5), run(8.0));
            assert!(long.0 > 2 * short.0);
            assert_eq!(short.1, long.1, "{} {adaptive}", stringify!($method));
        })*};
    }
    check!(
        Rkmk::new(DOPRI5, Exp),
        Rkmk::new(DOP853, Cay),
        CommutatorFree(CF43),
        Doubling(CommutatorFree(CF43))
    );
}

/// By hand: steps, a way to a time, points between and a state that is set.
#[test]
fn by_hand() {
    let body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0]).expect("a body");
    let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(1), 1.0).into_mat();
    let attitude = RigidBodyNAttitude::new(body, m).expect("a body");
    let method = Rkmk::new(DOPRI5, Exp);
    for adaptive in [true, false] {
        let solve = Solve::new(&attitude, &method, [0.0, 100.0]);
        let solve = if adaptive { solve.tolerances(1e-6, 1e-6) } else { solve.dt(0.01) };
        let mut run = solve.integrator(attitude.group().identity()).expect("a run");
        let mut at = run.y().clone();
        run.step().expect("a step");
        let before = counting::total();
        for k in 1..200 {
            run.step().expect("a step");
            let last = run.last_step();
            run.interpolate(last.t + 0.3 * last.h, &mut at).expect("a point");
            run.advance_to(run.t() + 0.001 * f64::from(k % 7)).expect("a state");
            at.copy_from(&**run.y());
            run.set_state(&at).expect("a state");
        }
        assert_eq!(counting::total() - before, 0, "{adaptive}");
    }
}
