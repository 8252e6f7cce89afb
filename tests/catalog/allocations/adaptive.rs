//! Error estimates, step doubling and the adaptive driver allocate nothing in a step.

use lieflow::SaveAt;
use lieflow::groups::{LieGroup, Sample};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::commutator_free::CF43;
use lieflow::methods::low_storage::LS32;
use lieflow::methods::one_bracket::MAGNUS43;
use lieflow::methods::tableau::{DOP853, DOPRI5};
use lieflow::methods::{CommutatorFree, Doubling, LowStorage, OneBracket, Rk, Rkmk};
use lieflow::problems::{Problem, RigidBodyN, RigidBodyNAttitude};
use lieflow::{StepControl, integrate_adaptive};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::counting;

/// The driver allocates as often in a long run as in a short one.
#[test]
fn adaptive_runs() {
    for n in [3usize, 4, 10] {
        let lambda: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
        let body = RigidBodyN::manakov(&lambda).expect("a body");
        let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(1), 1.0).into_mat();
        let attitude = RigidBodyNAttitude::new(body.clone(), m.clone()).expect("a body");
        let g = attitude.group().identity();
        macro_rules! check {
            ($problem:expr, $start:expr, $($method:expr),*) => {$(
                let method = $method;
                let run = |end: f64| {
                    let mut y = $start.clone();
                    let control = StepControl::new(1e-6, 1e-6).expect("tolerances");
                    let before = counting::total();
                    let stats = integrate_adaptive(
                        &$problem, &method, [0.0, end], &control, &SaveAt::Every(2), &mut y, |_, _| {},
                    );
                    (stats.expect("a run").accepted, counting::total() - before)
                };
                run(0.1);
                let (short, long) = (run(0.5), run(8.0));
                assert!(long.0 > 2 * short.0);
                assert_eq!(short.1, long.1, "{} at n = {n}", stringify!($method));
            )*};
        }
        check!(
            attitude,
            g,
            Rkmk::new(DOPRI5, Exp),
            Rkmk::new(DOP853, Cay),
            CommutatorFree(CF43),
            LowStorage(LS32),
            OneBracket(MAGNUS43),
            Doubling(CommutatorFree(CF43)),
            Rk(DOPRI5)
        );
        check!(body, m, Rkmk::new(DOPRI5, Exp), CommutatorFree(CF43), Doubling(LowStorage(LS32)));
    }
}
