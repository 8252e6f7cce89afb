//! What allocates once, when it is made, and not in a step.

mod adaptive;
mod driver;
mod exponentials;
mod maps;
mod products;
mod steps;

use lieflow::methods::Metric;
use lieflow::problems::{PointOf, Problem};
use lieflow::{Action, LieAlgebra, Method, Step};

use crate::counting;

/// The allocations of ten steps, each with a point within it and its way back to M, after the workspace is made. A step goes
/// before: the product library makes its packing buffer at the first large product of a thread.
pub(crate) fn of_steps<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    start: &PointOf<P>,
) -> usize
where
    P::Group: LieAlgebra<Scalar = f64>,
{
    let (mut y, mut from, mut at) = (start.clone(), start.clone(), start.clone());
    let mut work = method.work(problem, &y).expect("the method fits");
    let mut back = problem.action().work(problem.group());
    let mut step = |n| {
        let step = Step { n, t: 0.1, h: 0.02 };
        from.assign(&y);
        method.step(problem, step, &mut y, &mut work).expect("a step");
        method.prepare(problem, step, &from, &y, &mut work).expect("the stages of the extension");
        method.interpolate(problem, step, 0.4, &from, &mut work, &mut at).expect("a point");
        problem.action().restore_to(problem.group(), start, &mut y, &mut back);
    };
    step(0);
    let before = counting::total();
    (1..11).for_each(step);
    counting::total() - before
}

#[test]
fn the_counter_counts() {
    let before = (counting::total(), counting::bytes());
    drop(std::hint::black_box(vec![0u8; 10]));
    assert_eq!((counting::total(), counting::bytes()), (before.0 + 1, before.1 + 10));
}
