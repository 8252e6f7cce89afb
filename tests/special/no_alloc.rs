//! A step of the methods that ask more of a problem than f allocates nothing either.

use crate::counting;

use lieflow::catalog::{
    MethodSpec, OnMethod, all_methods, with_attitude_method, with_lie_poisson_method,
    with_momentum_method, with_series_method, with_state_method,
};
use lieflow::groups::{LieGroup, Sample};
use lieflow::maps::Cay;
use lieflow::methods::{Composition, EnergyCasimir, KAHAN_LI6};
use lieflow::problems::{
    PointOf, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude, RigidBodyState,
};
use lieflow::{Error, LieAlgebra, Method, Problem, Step};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// The allocations of ten steps, after the workspace is made and one step has gone before.
struct Count<'a, P: Problem>(&'a P, PointOf<P>);

impl<P: Problem> OnMethod<P> for Count<'_, P>
where
    P::Group: LieAlgebra<Scalar = f64>,
{
    type Out = usize;
    fn call<M: Method<P>>(self, method: M) -> usize {
        let Count(problem, mut y) = self;
        let mut work = method.work(problem, &y).expect("it fits");
        let mut step = |n| {
            let step = Step { n, t: 0.0, h: 0.02 };
            method.step(problem, step, &mut y, &mut work).expect("a step");
        };
        step(0);
        let before = counting::total();
        (1..11).for_each(&mut step);
        counting::total() - before
    }
}

fn check(served: &mut usize, name: &str, answer: Result<usize, Error>) {
    match answer {
        Ok(count) => {
            assert_eq!(count, 0, "{name}");
            *served += 1;
        }
        Err(Error::Unsupported { .. }) => (),
        Err(other) => panic!("{name}: {other}"),
    }
}

#[test]
fn every_method_on_every_model_of_the_body() {
    let inertia = [1.0, 2.0, 3.0];
    let m = Vector3::new(0.9, 1.0, 2.1);
    let momentum = RigidBody::<f64>::new(inertia).expect("a body");
    let attitude = RigidBodyAttitude::<f64>::new(inertia, m.into()).expect("a body");
    let both = RigidBodyState::<f64>::new(inertia).expect("a body");
    let state = both.state(m.into(), Matrix3::identity()).expect("a state");
    let mut served = 0;
    for (info, _) in all_methods() {
        let (spec, name) = (MethodSpec::new(info.name, None), info.name);
        check(&mut served, name, with_momentum_method(&spec, Count(&momentum, m)));
        let g = Matrix3::identity();
        check(&mut served, name, with_attitude_method(&spec, Count(&attitude, g)));
        check(&mut served, name, with_attitude_method(&spec, Count(&both, state)));
        check(&mut served, name, with_state_method(&spec, Count(&both, state)));
        for n in [3usize, 5, 9, 17] {
            let lambda: Vec<f64> = (0..n).map(|i| 1.0 + 0.1 * i as f64).collect();
            let body = RigidBodyN::manakov(&lambda).expect("a body");
            let mut rng = Pcg64::seed_from_u64(n as u64);
            let w = body.group().sample_algebra(&mut rng, 0.5).into_mat();
            let with_g = RigidBodyNAttitude::new(body.clone(), w.clone()).expect("a body");
            let g = with_g.group().identity();
            check(&mut served, name, with_series_method(&spec, Count(&with_g, g)));
            check(&mut served, name, with_lie_poisson_method(&spec, Count(&body, w.clone())));
            if n == 5 {
                let composed = Composition::new(EnergyCasimir::new(Cay), KAHAN_LI6);
                assert_eq!(Count(&body, w).call(composed), 0, "a composition");
            }
        }
    }
    assert!(served > 100, "{served}");
    let before = counting::total();
    drop(vec![0u8; 10]);
    assert!(counting::total() > before, "the counter does not count");
}
