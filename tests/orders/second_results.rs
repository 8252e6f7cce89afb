//! What a method gives beside its step has an order of its own: the embedded result of a pair, the
//! estimate of the error, and output between the steps.

use crate::support::gap;
use crate::support::orders::{
    MEMBERS, clock, in_units_of_one, measure_over, reference, reference_after, slopes, wave,
};
use crate::support::points::Points;
use lieflow::maps::{Cay, Exp};
use lieflow::methods::commutator_free::{CF4, CF43, ProductTableau};
use lieflow::methods::low_storage::{LS3, LS32};
use lieflow::methods::magnus::Magnus4;
use lieflow::methods::one_bracket::MAGNUS43;
use lieflow::methods::tableau::{BS3, DOP853, DOPRI5, RK4, RKF45, VERNER6};
use lieflow::methods::{
    AnyMethod, CommutatorFree, Doubling, Embedded, LowStorage, Method, OneBracket, Rk, Rkmk,
    Tableau,
};
use lieflow::problems::Problem;
use lieflow::{SaveAt, Step, TimeGrid, integrate};

/// The embedded result of a pair as a method: b̂ = b − e.
fn hat<const S: usize>(order: usize, e: [f64; S], t: Tableau<S>) -> Tableau<S> {
    Tableau { order, b: core::array::from_fn(|j| t.b[j] - e[j]), error: None, ..t }
}

/// b̂ of the pair's first row.
fn embedded<const S: usize>(t: Tableau<S>) -> Tableau<S> {
    let error = t.error.expect("a pair");
    hat(if error.damp.is_some() { 5 } else { error.order }, error.e, t)
}

/// The damping row of DOP853: order 3.
fn damping() -> Tableau<12> {
    hat(3, DOP853.error.and_then(|e| e.damp).expect("a second row"), DOP853)
}

fn cf43_embedded() -> ProductTableau<5> {
    let (order, update) = CF43.embedded.expect("a pair");
    ProductTableau { order, update, update_stages: 5, embedded: None, ..CF43 }
}

#[test]
fn embedded_results_have_their_orders() {
    let mut wrong = Vec::new();
    crate::on_every_group!(wave, MEMBERS, flows => {
        let members: Vec<_> = flows
            .into_iter()
            .map(|(flow, start)| {
                let reference = reference(&flow, start);
                (flow, reference)
            })
            .collect();
        macro_rules! check {
            ($($method:expr),* $(,)?) => {$({
                let found = measure_over(&members, &$method).unwrap();
                println!("{} {:.2?}", stringify!($method), found.slopes);
                if let Err(reason) = found.check() {
                    let group = lieflow::LieAlgebra::name(members[0].0.group());
                    wrong.push(format!("{group} {}: {reason}", stringify!($method)));
                }
            })*};
        }
        check!(
            Rkmk::new(embedded(BS3), Exp), Rkmk::new(embedded(RKF45), Exp),
            Rkmk::new(embedded(DOPRI5), Exp), Rkmk::new(embedded(DOPRI5), Cay),
            Rkmk::new(embedded(VERNER6), Exp), Rkmk::new(embedded(DOP853), Exp),
            Rkmk::new(damping(), Exp), Rk(embedded(DOPRI5)),
            CommutatorFree(cf43_embedded()),
        );
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The estimate of one step is of order p̂ + 1: of the difference that it is, and not of rounding. Those of
/// order 8 and more are in `wide.rs`.
#[test]
fn estimates_have_their_orders() {
    let mut wrong = Vec::new();
    crate::on_every_group!(wave, MEMBERS, flows => {
        macro_rules! check {
            ($($method:expr, $steps:expr);* $(;)?) => {$({
                let method = $method;
                let steps: [f64; 5] = $steps;
                let order = method.facts(&flows[0].0).error_order.unwrap() as f64 + 1.0;
                let errors = steps.map(|h| {
                    let logs: f64 = flows.iter().map(|(flow, start)| {
                        let mut work = method.work(flow, start).unwrap();
                        let (step, mut to) = (Step { n: 0, t: 0.3, h }, start.clone());
                        method.step_with_error(flow, step, &in_units_of_one(), start, &mut work, &mut to)
                            .unwrap().ln()
                    }).sum();
                    (logs / flows.len() as f64).exp()
                });
                let found = slopes(&steps.map(|h| 1.0 / h), &errors);
                println!("{} {found:.2?}", stringify!($method));
                if found[1..].iter().any(|s| (s - order).abs() > 0.15) {
                    wrong.push(format!("{}, order {order}: {found:.2?} {errors:?}", stringify!($method)));
                }
            })*};
        }
        let fine = [0.02, 0.015, 0.011, 0.008, 0.006];
        let coarse = [0.06, 0.045, 0.034, 0.025, 0.019];
        check!(
            Rkmk::new(BS3, Exp), fine; Rkmk::new(RKF45, Exp), fine; Rkmk::new(DOPRI5, Exp), fine;
            Rkmk::new(DOPRI5, Cay), fine; Rkmk::new(VERNER6, Exp), coarse;
            Rk(BS3), fine; Rk(DOPRI5), coarse;
            CommutatorFree(CF43), fine; LowStorage(LS32), fine; OneBracket(MAGNUS43), fine;
            Doubling(CommutatorFree(CF4)), coarse; Doubling(LowStorage(LS3)), fine;
            Doubling(Rkmk::new(RK4, Cay)), coarse;
        );
    });
    crate::on_every_group!(clock, 1, flows => {
        // A method for fields of linear type has an estimate by doubling like any other.
        assert_eq!(Doubling(Magnus4).facts(&flows[0].0).error_order, Some(4));
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Output between two steps has the order of the method: here in the middle of the middle step.
#[test]
fn output_between_the_steps_has_the_order_of_the_method() {
    const STEPS: [u64; 6] = [25, 33, 43, 57, 75, 99];
    crate::on_every_group!(wave, 1, flows => {
        let Some((flow, start)) = flows.into_iter().next() else { panic!("a problem") };
        let exact = reference_after(0.5, &flow, start);
        macro_rules! check {
            ($($method:expr),*) => {$({
                let method = AnyMethod::new($method);
                let errors = STEPS.map(|n| {
                    let (mut y, mut middle) = (exact.start().to_owned(), None);
                    let grid = TimeGrid::with_steps([0.3, 1.3], n).unwrap();
                    let save = SaveAt::Times(vec![0.8]);
                    let stats = integrate(&flow, &method, &grid, &save, &mut y, |t, y| {
                        if t == 0.8 {
                            middle = Some(flow.action().numbers(flow.group(), y));
                        }
                    })
                    .unwrap();
                    assert_eq!(stats.points_within, 1);
                    gap(&middle.unwrap(), exact.end())
                });
                let found = slopes(&STEPS.map(|n| n as f64), &errors);
                let order = method.facts(&flow).order as f64;
                println!("{} {found:.2?}", stringify!($method));
                assert!(found[2..].iter().all(|s| (s - order).abs() < 0.15), "{found:?} {errors:?}");
            })*};
        }
        check!(Rkmk::new(BS3, Exp), CommutatorFree(CF4), Rkmk::new(RK4, Cay), LowStorage(LS32));
    });
}
