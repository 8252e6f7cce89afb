//! A step there and back.

use lieflow::actions::LeftTranslation;
use lieflow::groups::MatrixGroup;
use lieflow::maps::Exp;
use lieflow::methods::low_storage::{EES25, EES27};
use lieflow::methods::{LowStorage, Metric, Rkmk, tableau::RK4};
use lieflow::problems::{PointOf, Problem};
use lieflow::{LieAlgebra, LieGroup, Method, Step};

use crate::support::orders::{flow, slopes, wave};

/// ‖Φ₋ₕ(Φₕ(y)) − y‖.
pub(crate) fn there_and_back<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    start: &PointOf<P>,
    h: f64,
) -> f64
where
    P::Group: LieAlgebra<Scalar = f64>,
    PointOf<P>: Metric<Scalar = f64>,
{
    let mut y = start.clone();
    let mut work = method.work(problem, &y).expect("it fits");
    method.step(problem, Step { n: 0, t: 0.3, h }, &mut y, &mut work).expect("there");
    method.step(problem, Step { n: 1, t: 0.3 + h, h: -h }, &mut y, &mut work).expect("back");
    y.distance(start)
}

/// CF-EES(2,m) is of order 2 and comes back to O(h^{m+1}); RKMK4 to O(h⁶).
#[test]
fn nearly_symmetric_methods_come_back_with_a_high_order() {
    for group in [MatrixGroup::so(5), MatrixGroup::gl(3), MatrixGroup::sp(4)] {
        let group = group.expect("a group");
        let n = group.n();
        let flow = flow(group, LeftTranslation, wave(n, 0.25, 3));
        let start = flow.group().identity();
        macro_rules! check {
            ($method:expr, $order:expr, $steps:expr) => {{
                let steps: [f64; 4] = $steps;
                let gaps = steps.map(|h| there_and_back(&flow, &$method, &start, h));
                let found = slopes(&steps.map(|h| 1.0 / h), &gaps);
                println!("{} {found:.2?}", stringify!($method));
                assert!(found.iter().all(|s| *s > $order - 0.75), "{found:?} {gaps:?}");
            }};
        }
        check!(LowStorage(EES25), 6.0, [0.15, 0.11, 0.08, 0.06]);
        check!(LowStorage(EES27), 8.0, [0.3, 0.22, 0.16, 0.12]);
        check!(Rkmk::new(RK4, Exp), 5.5, [0.15, 0.11, 0.08, 0.06]);
    }
}
