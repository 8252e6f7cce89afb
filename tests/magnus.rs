//! Orders of the Magnus methods on equations of linear type.

mod common_orders;

use common_orders::{TimeOnly, Verdict, measure, reference};
use lieflow::groups::MatrixGroup;
use lieflow::methods::CfMagnus;
use lieflow::methods::magnus::{
    CFM4_2, CFM4_3, CFM6_5, CFM8_11, CayleyMagnus4, CayleyMagnus6, Magnus4, Magnus6, Magnus8,
};
use lieflow::{LieAlgebra, LieGroup, Method};

macro_rules! orders {
    ($problem:expr, $exact:expr, $verdict:expr, $($method:expr),* $(,)?) => {$(
        let order = $method.order($problem);
        let found = measure($problem, &$method, &$problem.group.identity(), $exact);
        let what = format!("{:8} {}", $problem.group.name(), stringify!($method));
        $verdict.add(&what, found.is(order), &found);
    )*};
}

#[test]
fn magnus_methods_have_their_orders() {
    let mut verdict = Verdict::default();
    on_every_group!(group => {
        let problem = TimeOnly::new(group);
        let exact = reference(&problem, &problem.group.identity());
        orders!(
            &problem, &exact, verdict,
            Magnus4, Magnus6, Magnus8, CayleyMagnus4, CayleyMagnus6,
            CfMagnus(CFM4_2), CfMagnus(CFM4_3), CfMagnus(CFM6_5), CfMagnus(CFM8_11),
        );
    });
    verdict.assert();
}

#[test]
fn wrong_methods_are_seen() {
    let problem = TimeOnly::new(MatrixGroup::so(5).expect("SO(5)"));
    let start = problem.group.identity();
    let exact = reference(&problem, &start);
    // The factors are listed in the order of application; reversed, order 2 is left.
    let mut reversed = CFM6_5;
    reversed.factors.reverse();
    assert!(!measure(&problem, &CfMagnus(reversed), &start, &exact).is(6));
    let mut coefficient = CFM8_11;
    coefficient.factors[2][1] += 1e-6;
    assert!(!measure(&problem, &CfMagnus(coefficient), &start, &exact).is(8));
}
