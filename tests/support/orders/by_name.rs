//! Every method for fields on one problem after the other: a test a problem.

use lieflow::catalog::{MethodSpec, Needs};
use lieflow::maps::{AllMaps, Cay, CoordinateMap, Exp};
use lieflow::methods::magnus::TripleProduct;
use lieflow::problems::{Ambient, LinearField};

use super::super::named;
use super::super::points::Points;
use super::super::represent::Represent;
use super::flow::{Field, clock, wave};
use super::suite::{Problems, Report};

/// Measure every method for fields, explicit and implicit, and require the orders that they claim.
pub(crate) fn every_method_on<P: Ambient>(title: &str, problems: Problems<P>)
where
    P::Group: Represent + AllMaps,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Exp: CoordinateMap<P::Group>,
{
    let measured = |spec: &MethodSpec| named::field(spec, |method| problems.measure(method, true));
    Report::of(title, &problems.group(), &[Needs::Field, Needs::Norm], measured);
}

/// The explicit ones alone, where the action is another or the problem is one that others have: each
/// method is one more to compile for each type of problem.
pub(crate) fn every_explicit_method_on<P: Ambient>(title: &str, problems: Problems<P>)
where
    P::Group: Represent + AllMaps,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
    Exp: CoordinateMap<P::Group>,
{
    let measured =
        |spec: &MethodSpec| named::explicit(spec, |method| problems.measure(method, true));
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
    let measured =
        |spec: &MethodSpec| named::linear(spec, |method| problems.measure(method, false));
    Report::of(title, &problems.group(), &[Needs::LinearType], measured);
}

/// One test a problem, from its group, its action and its field; `one` of them, or `many` with the
/// number of each in the seeds.
#[macro_export]
macro_rules! orders {
    ($every:ident: $($name:ident: $count:ident, $group:expr, $action:expr, $field:expr;)*) => {$(
        #[test]
        fn $name() {
            let flow = |i: u64| $crate::support::orders::flow($group, $action, $field(i));
            $every(stringify!($name), $crate::problems!($count, flow));
        }
    )*};
}
/// The problems of a test of [`orders!`].
#[macro_export]
macro_rules! problems {
    (one, $flow:ident) => {{
        let flow = $flow(0);
        let start = $crate::support::orders::start(&flow, 7);
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
