//! Orders of the commutator-free methods, of RKMK with every tableau, and of the pairs' second
//! results, on problems that tell a wrong coefficient.

mod common_orders;

use common_orders::{Nonlinear, Verdict, measure, reference};
use lieflow::groups::MatrixGroup;
use lieflow::maps::{Cay, Exp};
use lieflow::methods::commutator_free::{CF3, CF4, CF43};
use lieflow::methods::crouch_grossman::{CG2, CG3, CG4};
use lieflow::methods::low_storage::{EES25, EES27, LS3, LS3_BP, LS4, LS5, LS32};
use lieflow::methods::one_bracket::{MAGNUS43, RKMK4_2C};
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5, RK4, RKF45, VERNER6};
use lieflow::methods::{CommutatorFree, LowStorage, Metric, OneBracket, Rk, Rkmk};
use lieflow::{LieAlgebra, LieGroup, Method, Step};

macro_rules! orders {
    ($problem:expr, $exact:expr, $verdict:expr, $holds:ident: $($method:expr),* $(,)?) => {$(
        let order = $method.order($problem);
        let found = measure($problem, &$method, &$problem.group.identity(), $exact);
        let what = format!("{:8} {}", $problem.group.name(), stringify!($method));
        $verdict.add(&what, found.$holds(order), &found);
    )*};
}

#[test]
fn commutator_free_methods_have_their_orders() {
    let mut verdict = Verdict::default();
    on_every_group!(group => {
        let problem = Nonlinear::new(group);
        let exact = reference(&problem, &problem.group.identity());
        orders!(
            &problem, &exact, verdict, is:
            CommutatorFree(CF3), CommutatorFree(CF4), CommutatorFree(CF43),
            CommutatorFree(CG2), CommutatorFree(CG3), CommutatorFree(CG4),
            LowStorage(LS3), LowStorage(LS3_BP), LowStorage(LS32), LowStorage(LS4), LowStorage(LS5),
            LowStorage(EES25), LowStorage(EES27),
            OneBracket(RKMK4_2C), OneBracket(MAGNUS43),
        );
    });
    verdict.assert();
}

#[test]
fn rkmk_has_the_order_of_its_tableau() {
    let mut verdict = Verdict::default();
    on_every_group!(group => {
        let problem = Nonlinear::new(group);
        let exact = reference(&problem, &problem.group.identity());
        orders!(
            &problem, &exact, verdict, at_least:
            Rkmk::new(BS3, Exp.truncated(1)), Rkmk::new(RK4, Exp.truncated(2)),
            Rkmk::new(RKF45, Exp.truncated(3)), Rkmk::new(DOPRI5, Exp), Rkmk::new(DOPRI5, Cay),
            Rkmk::new(VERNER6, Exp.truncated(4)), Rkmk::new(DOP853, Exp.truncated(6)), Rk(RKF45),
        );
    });
    verdict.assert();
}

/// The slips that were found in other packages, each of which the test above must see.
#[test]
fn wrong_methods_are_seen() {
    let problem = Nonlinear::new(MatrixGroup::so(5).expect("SO(5)"));
    let start = problem.group.identity();
    let exact = reference(&problem, &start);
    macro_rules! refused {
        ($what:literal, $order:literal, $method:expr) => {{
            let found = measure(&problem, &$method, &start, &exact);
            println!("{}: {:.2?}", $what, found.slopes);
            assert!(!found.is($order) && !found.at_least($order), "{}", $what);
        }};
    }
    let mut swapped = CG3;
    swapped.update.factors =
        &[[0.0, 0.0, 24.0 / 17.0], [0.0, -2.0 / 3.0, 0.0], [13.0 / 51.0, 0.0, 0.0]];
    refused!("the factors of Crouch-Grossman reversed", 3, CommutatorFree(swapped));
    let mut wrong_stage = RKMK4_2C;
    wrong_stage.stages[2].w = [0.5, 0.0, 0.0, 0.0];
    refused!("k1/2 where k2/2 belongs", 4, OneBracket(wrong_stage));
    let mut no_bracket = RKMK4_2C;
    no_bracket.update.x = [0.0; 4];
    refused!("a bracket forgotten", 4, OneBracket(no_bracket));
    let mut frozen = CF4;
    frozen.c = [0.0; 4];
    refused!("stages at a frozen t", 4, CommutatorFree(frozen));
    refused!("RKMK4 without dexpinv", 4, Rkmk::new(RK4, Exp.truncated(0)));
    let mut from_start = CF4;
    from_start.stages[3].from = 0;
    refused!("the fourth stage of CF4 from the start", 4, CommutatorFree(from_start));
    let mut coefficient = LS4;
    coefficient.a[3] += 1e-3;
    refused!("a coefficient off by 1e-3", 4, LowStorage(coefficient));
}

/// A step undone by a step back: an EES(2,m) method comes back to O(h^{m+1}).
#[test]
fn effectively_symmetric_methods_come_back() {
    on_every_group!(group => {
        let problem = Nonlinear::new(group);
        macro_rules! check {
            ($method:expr, $least:literal, $steps:expr) => {{
                let method = $method;
                let steps: [f64; 4] = $steps;
                let start = problem.group.identity();
                let mut work = method.work(&problem, &start).expect("work");
                let gaps = steps.map(|h| {
                    let mut y = start.clone();
                    method.step(&problem, Step { n: 0, t: 0.3, h }, &mut y, &mut work)
                        .expect("there");
                    method.step(&problem, Step { n: 1, t: 0.3 + h, h: -h }, &mut y, &mut work)
                        .expect("back");
                    y.distance(&start)
                });
                for (gap, h) in gaps.windows(2).zip(steps.windows(2)) {
                    let slope = (gap[0] / gap[1]).ln() / (h[0] / h[1]).ln();
                    println!("{} {slope:.2}", problem.group.name());
                    assert!(slope > $least, "{slope} {gaps:?}");
                }
            }};
        }
        check!(LowStorage(EES25), 5.5, [0.15, 0.11, 0.08, 0.06]);
        // A method without the property shows 4 at most, EES25 shows 6.
        check!(LowStorage(EES27), 6.8, [0.3, 0.22, 0.16, 0.12]);
    });
}
