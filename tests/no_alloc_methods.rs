//! Linear methods, error estimates, step doubling and the adaptive driver allocate nothing in a step.

#[path = "support/counting.rs"]
mod counting;

use lieflow::actions::LeftTranslation;
use lieflow::adaptive::{Adaptive, integrate_adaptive};
use lieflow::catalog::{LINEAR_METHODS, OnMethod, with_linear_method};
use lieflow::groups::{AlgebraMatrix, LieGroup, MatrixGroup, Sample, So3};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::commutator_free::CF43;
use lieflow::methods::low_storage::LS32;
use lieflow::methods::magnus::Magnus4;
use lieflow::methods::one_bracket::MAGNUS43;
use lieflow::methods::tableau::{DOP853, DOPRI5};
use lieflow::methods::{CommutatorFree, Doubling, Embedded, LowStorage, OneBracket, Rk, Rkmk};
use lieflow::problems::{LinearEquation, PointOf, Problem, RigidBodyN, RigidBodyNAttitude};
use lieflow::{LieAlgebra, Method, SaveAt, Step};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// Of ten steps after a first one, which may make a thread's packing buffers.
struct Steps<'a, P: Problem>(&'a P, &'a PointOf<P>);

impl<P: Problem> OnMethod<P> for Steps<'_, P>
where
    P::Group: LieAlgebra<Scalar = f64>,
{
    type Out = usize;
    fn call<M: Method<P>>(self, method: M) -> usize {
        let mut y = self.1.clone();
        let mut work = method.work(self.0, &y).expect("the method fits");
        let mut before = 0;
        for n in 0..11 {
            if n == 1 {
                before = counting::total();
            }
            let step = Step { n, t: 0.1, h: 0.05 };
            method.step(self.0, step, &mut y, &mut work).expect("a step");
        }
        counting::total() - before
    }
}

#[test]
fn linear_methods() {
    let so3 = LinearEquation::new(So3::new(), LeftTranslation, |t: f64, v: &mut Vector3<f64>| {
        *v = Vector3::new(t.cos(), t.sin(), 1.0);
    });
    for info in LINEAR_METHODS {
        let identity = so3.group().identity();
        let count = with_linear_method(info.name, Steps(&so3, &identity)).expect("a method");
        assert_eq!(count, 0, "{}", info.name);
    }
    for n in [2usize, 3, 4, 8, 10, 20] {
        let mut groups = vec![
            MatrixGroup::so(n).expect("SO(n)"),
            MatrixGroup::gl(n).expect("GL(n)"),
            MatrixGroup::indefinite(n - 1, 1).expect("SO(n−1,1)"),
        ];
        groups.extend((n % 2 == 0).then(|| MatrixGroup::sp(n).expect("Sp(n)")));
        for group in groups {
            let mut rng = Pcg64::seed_from_u64(n as u64);
            let u = group.sample_algebra(&mut rng, 0.3);
            let v = group.sample_algebra(&mut rng, 0.3);
            let (identity, name, inner) = (group.identity(), group.name(), group.clone());
            let field = move |t: f64, a: &mut AlgebraMatrix| {
                inner.set_zero(a);
                inner.axpy(t.cos(), &u, a);
                inner.axpy(t.sin(), &v, a);
            };
            let problem = LinearEquation::new(group, LeftTranslation, field);
            for info in LINEAR_METHODS {
                let count = with_linear_method(info.name, Steps(&problem, &identity));
                assert_eq!(count.expect("a method"), 0, "{} on {name}", info.name);
            }
        }
    }
}

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
                    let control = Adaptive::new(1e-6, 1e-6).expect("tolerances");
                    let before = counting::total();
                    let stats = integrate_adaptive(
                        &$problem, &method, [0.0, end], &control, &SaveAt::Every(2), &mut y, |_, _| {},
                    );
                    (stats.expect("a run").accepted, counting::total() - before)
                };
                run(0.1);
                let (short, long) = (run(0.5), run(5.0));
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

/// Half of what this file is for: that the counter counts.
#[test]
fn the_counter_counts() {
    let before = counting::total();
    let group = MatrixGroup::so(5).expect("SO(5)");
    assert!(counting::total() > before && group.n() == 5);
    fn is_embedded<P: Problem, M: Embedded<P>>(_: &P, _: &M) {}
    let so3 = LinearEquation::new(So3::new(), LeftTranslation, |_: f64, v: &mut Vector3<f64>| {
        *v = Vector3::zeros();
    });
    is_embedded(&so3, &Doubling(Magnus4));
}
