//! What is not asked for is not computed: operations of f and of steps, evaluations of f and of
//! torques, counted.

use std::cell::Cell;

use lieflow::groups::{LieGroup, So3};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::{Method, Rkmk, Step, tableau::RK4};
use lieflow::problems::{
    BodyMotion, BodyTorque, PointOf, Problem, RigidBody, RigidBodyAttitude, TorqueBody,
};
use lieflow::scalar::{Counted, Ops, Real};
use lieflow::{CoordinateMap, LieAlgebra};
use nalgebra::{Matrix3, Vector3};

const INERTIA: [f64; 3] = [1.0, 2.0, 2.5];
const MOMENTUM: [f64; 3] = [0.3, -1.1, 0.4];

/// The operations of one f, and of one step of RKMK4.
fn operations<P: Problem<Group = So3<Counted>>>(problem: &P, y: &PointOf<P>) -> [Ops; 2] {
    let method = Rkmk::new(RK4, Cay);
    let (mut v, mut scratch) = (problem.group().zero(), problem.work());
    let (_, of_f) = Counted::count(|| problem.f(Counted::lit(0.0), y, &mut v, &mut scratch));
    let (mut y, mut work) = (y.clone(), method.work(problem, y).expect("a workspace"));
    let step = Step { n: 0, t: Counted::lit(0.0), h: Counted::lit(0.1) };
    let (done, of_step) = Counted::count(|| method.step(problem, step, &mut y, &mut work));
    done.expect("a step");
    [of_f, of_step]
}

#[test]
fn a_momentum_alone_costs_no_attitude_and_its_inertia_is_a_diagonal() {
    let m = Vector3::from(MOMENTUM.map(Counted::lit));
    let [f, step] = operations(&RigidBody::<Counted>::new(INERTIA).expect("a body"), &m);
    // J⁻¹m with a diagonal J⁻¹: three products and nothing else, no division.
    assert_eq!(f, Ops { mul: 3, ..Ops::default() });
    let body = RigidBodyAttitude::<Counted>::new(INERTIA, MOMENTUM).expect("a body");
    let [with, with_step] = operations(&body, &So3::<Counted>::new().identity());
    // With the attitude: two products of a matrix and a vector more, 9 and 6 each.
    assert_eq!(with, Ops { mul: 3 + 18, add: 12, ..Ops::default() });
    // A momentum never meets a 3×3 matrix in a step: a product of two has 27 multiplications.
    assert!(step.total() + 4 * 27 < with_step.total(), "{step:?} {with_step:?}");
    assert_eq!((step.sqrt, step.trig), (0, 0));
}

/// Counts the evaluations of f.
struct Watched<P>(P, Cell<u64>);

impl<P: Problem> Problem for Watched<P> {
    type Group = P::Group;
    type Action = P::Action;
    type Work = P::Work;
    fn group(&self) -> &P::Group {
        self.0.group()
    }
    fn action(&self) -> &P::Action {
        self.0.action()
    }
    fn work(&self) -> P::Work {
        self.0.work()
    }
    fn f(
        &self,
        t: <P::Group as LieAlgebra>::Scalar,
        y: &PointOf<P>,
        v: &mut <P::Group as LieAlgebra>::Alg,
        work: &mut P::Work,
    ) {
        self.1.set(self.1.get() + 1);
        self.0.f(t, y, v, work);
    }
}

fn ten_steps<P: Problem>(problem: &P, y: &PointOf<P>)
where
    P::Group: LieAlgebra<Scalar = f64>,
    Exp: CoordinateMap<P::Group>,
{
    let method = Rkmk::new(RK4, Exp);
    let (mut y, mut work) = (y.clone(), method.work(problem, y).expect("a workspace"));
    for n in 0..10 {
        method.step(problem, Step { n, t: 0.0, h: 0.1 }, &mut y, &mut work).expect("a step");
    }
}

#[test]
fn one_evaluation_a_stage_and_torques_where_there_is_one() {
    let body = Watched(RigidBody::<f64>::new(INERTIA).expect("a body"), Cell::new(0));
    ten_steps(&body, &MOMENTUM.into());
    assert_eq!(body.1.get(), 40);

    let torques = Cell::new(0);
    let torque = BodyTorque(|at: &BodyMotion| {
        torques.set(torques.get() + 1);
        -0.1 * at.omega_body
    });
    let damped = TorqueBody::new(INERTIA, torque).expect("a body");
    ten_steps(&damped, &(Matrix3::identity(), MOMENTUM.into()));
    assert_eq!(torques.get(), 40);
    // A torque costs an evaluation of itself; the free body has no place where one could be asked.
    let before = torques.get();
    ten_steps(&RigidBody::<f64>::new(INERTIA).expect("a body"), &MOMENTUM.into());
    assert_eq!(torques.get(), before);
}
