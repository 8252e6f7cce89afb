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
use lieflow::methods::{CommutatorFree, LowStorage, OneBracket, Rk, Rkmk};
use lieflow::{LieAlgebra, LieGroup, Method};

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
