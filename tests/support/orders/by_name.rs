//! Every method for fields on one problem after the other: a test a problem.

use lieflow::catalog::{
    CatalogGroup, Catalogued, MethodSpec, Needs, with_implicit_method, with_linear_method,
    with_method,
};
use lieflow::maps::{Cay, CoordinateMap, Exp};
use lieflow::methods::magnus::TripleProduct;
use lieflow::problems::{Ambient, LinearField};

use super::super::points::Points;
use super::super::represent::Represent;
use super::flow::{Field, clock, wave};
use super::suite::{Measure, Problems, Report};

/// Measure every method for fields, explicit and implicit, and require the orders that they claim.
pub(crate) fn every_method_on<P: Catalogued>(title: &str, problems: Problems<P>)
where
    P::Group: Represent + CatalogGroup,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Exp: CoordinateMap<P::Group>,
{
    let measured = |spec: &MethodSpec| with_implicit_method(spec, Measure(&problems, true));
    Report::of(title, &problems.group(), &[Needs::Field, Needs::Norm], measured);
}

/// The explicit ones alone, where the action is another or the problem is one that others have: each
/// method is one more to compile for each type of problem.
pub(crate) fn every_explicit_method_on<P: Ambient>(title: &str, problems: Problems<P>)
where
    P::Group: Represent + CatalogGroup,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Exp: CoordinateMap<P::Group>,
{
    let measured = |spec: &MethodSpec| with_method(spec, Measure(&problems, true));
    Report::of(title, &problems.group(), &[Needs::Field], measured);
}

/// The same for the methods that want a field of linear type. Some of order 4 are so accurate there
/// that the grid of that order has rounding on it.
pub(crate) fn every_linear_method_on<P: LinearField + Ambient>(title: &str, problems: Problems<P>)
where
    P::Group: Represent + TripleProduct,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Exp: CoordinateMap<P::Group>,
{
    let measured = |spec: &MethodSpec| with_linear_method(&spec.name, Measure(&problems, false));
    Report::of(title, &problems.group(), &[Needs::LinearType], measured);
}

/// One test a problem, from its group, its action and its field; `one` of them, or `many` with the
/// number of each in the seeds.
#[macro_export]
macro_rules! orders {
    ($every:ident: $($name:ident: $count:ident, $group:expr, $action:expr, $field:expr;)*) => {$(
        #[test]
        fn $name() {
            let flow = |i: u64| $crate::support::orders::Flow::new($group, $action, $field(i));
            $every(stringify!($name), $crate::problems!($count, flow));
        }
    )*};
}
/// The problems of a test of [`orders!`].
#[macro_export]
macro_rules! problems {
    (one, $flow:ident) => {{
        let flow = $flow(0);
        let start = flow.start(7);
        $crate::support::orders::Problems::one(flow, start)
    }};
    ($count:ident, $flow:ident) => {
        $crate::support::orders::Problems::$count(|i| {
            let flow = $flow(i);
            let start = lieflow::LieGroup::identity(lieflow::Problem::group(&flow));
            (flow, start)
        })
    };
}

/// [`wave`] in dimension n, so strong, with coefficients from this seed on.
pub(crate) fn waves(n: usize, strength: f64, seed: u64) -> impl Fn(u64) -> Field {
    move |i| wave(n, strength, seed + 100 * i)
}

/// [`clock`] in the same way.
pub(crate) fn clocks(n: usize, strength: f64) -> impl Fn(u64) -> Field {
    move |i| clock(n, strength, 21 + 100 * i)
}
