//! Orders from 8 on, in numbers of 32 digits: in `f64` such a method goes from its first asymptotic step
//! to rounding within a factor of 4 to 18 in h, and three slopes near p do not fit in. So every method of
//! the catalog of order 8 and more is measured here, to 0.15 by the rule of the lower orders, on SO(3),
//! SO(5), GL(3), Sp(4), SO(3,1), SE(3) and products.
//!
//! What the library has in closed form is generic in the number, and so are its methods. Its matrices are
//! in `f64`: their groups and maps stand here again, from the definitions (`group`, `maps`), and `agreement`
//! holds them to those of the library.
//!
//! The reference is extrapolation of the midpoint rule on the entries, which knows no map, no action, no
//! bracket and no coefficient of a method.

mod agreement;
mod attitude;
mod bodies;
mod faults;
mod fields;
mod group;
mod lie_poisson;
mod maps;
mod members;
mod square;

use crate::support::orders::{Report, in_units_of_one, slopes};
use fields::{CoupledField, Kind, Wide, fast_clock};
use group::Matrices;
use lieflow::catalog::Needs;
use lieflow::groups::{Power, Product, Se3, So3, Translations};
use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp};
use lieflow::methods::magnus::{CFM8_11, Magnus8};
use lieflow::methods::tableau::DOP853;
use lieflow::methods::{
    CfMagnus, Composition, Embedded, GAUSS2, KAHAN_LI8, LieSeries, Rk, Rkmk, RkmkGaussSymmetric,
    SeriesGroup,
};
use lieflow::problems::{PointOf, Problem};
use lieflow::scalar::{DoubleDouble, Real};
use lieflow::{LieAlgebra, Step};
use members::{STORED, Span, UNIT, UNIT_FINE, by_name, high_orders, lie_series, members, order};
use nalgebra::Vector3;

type D = DoubleDouble;

const MEMBERS: u64 = 8;

/// The methods for fields: RKMK in every map, and the classical ones on the entries.
fn fields_on<G: Wide>(group: &G, strength: f64)
where
    Exp: CoordinateMap<G>,
    TruncatedExp: CoordinateMap<G>,
    Cay: CoordinateMap<G>,
    Pade22: CoordinateMap<G>,
    Ccsk<0, 1, 2>: CoordinateMap<G>,
    Ccsk<2, 1, 0>: CoordinateMap<G>,
{
    let all = members(MEMBERS, UNIT, |i| CoupledField::new(group, Kind::Wave, strength, 71 + i));
    high_orders("fields", &group.name(), &[Needs::Field, Needs::Norm], |spec| {
        by_name!(spec, {
            "rk" => &all, STORED, Rk(DOP853);
            "rkmk", Some("exp"), None => &all, STORED, Rkmk::new(DOP853, Exp);
            "rkmk", Some("exp"), Some(q) => &all, STORED, Rkmk::new(DOP853, Exp.truncated(q));
            "rkmk", Some("cay"), None => &all, STORED, Rkmk::new(DOP853, Cay);
            "rkmk", Some("pade22"), None => &all, STORED, Rkmk::new(DOP853, Pade22);
            "rkmk", Some("ccsk123"), None => &all, STORED, Rkmk::new(DOP853, CCSK123);
            "rkmk", Some("ccsk321"), None => &all, STORED, Rkmk::new(DOP853, CCSK321);
            "rkmk", Some("ccsk"), None => &all, STORED, Rkmk::new(DOP853, CCSK);
        })
    });
}

/// Those for equations of linear type.
fn linear_on<G: Wide>(group: &G, strength: f64)
where
    Exp: CoordinateMap<G>,
{
    let all = members(MEMBERS, UNIT, |i| CoupledField::new(group, Kind::Clock, strength, 21 + i));
    high_orders("fields of linear type", &group.name(), &[Needs::LinearType], |spec| {
        by_name!(spec, {
            "magnus8" => &all, STORED, Magnus8;
            "cfm8-11" => &all, STORED, CfMagnus(CFM8_11);
        })
    });
}

/// A composition of order 8, which is a type and no name: of the symmetric midpoint rule on the group, on the
/// same fields, where its iteration ends at once. The scheme of order 10 is that of `mr10`, in `bodies`.
fn composition_on<G: Wide>(group: &G, strength: f64)
where
    Exp: CoordinateMap<G>,
{
    let all = members(MEMBERS, UNIT, |i| CoupledField::new(group, Kind::Clock, strength, 21 + i));
    let mut report = Report::new(&format!("a composition on {}", group.name()));
    let composed = Composition::new(RkmkGaussSymmetric::new(GAUSS2, Exp), KAHAN_LI8);
    report.add(KAHAN_LI8.name, true, order(&all, STORED, &composed));
    report.assert();
}

/// The Lie series, on polynomial fields.
fn series_on<G: Wide + SeriesGroup>(group: &G, strength: f64) {
    let all = members(MEMBERS, UNIT_FINE, |i| {
        CoupledField::new(group, Kind::Polynomial, strength, 31 + i)
    });
    let of = |order| LieSeries::new(order).unwrap();
    high_orders("polynomial fields", &group.name(), &[Needs::Series], |spec| {
        lie_series(spec, &all)
    });
    let flow = |i| CoupledField::new(group, Kind::Polynomial, strength, 31 + i);
    let flows: Vec<_> = (0..MEMBERS).map(flow).collect();
    for order in 8..=16 {
        check_estimate(&flows, &of(order), order);
    }
}

/// The same on linear equations whose A(t) has known derivatives.
fn series_of_time_on<G: Wide + SeriesGroup>(group: &G, strength: f64) {
    let span = Span { rate: 3.0 * UNIT_FINE.rate, ..UNIT_FINE };
    let all = members(MEMBERS, span, |i| fast_clock(group, strength, 21 + i));
    high_orders("linear equations", &group.name(), &[Needs::Series], |spec| lie_series(spec, &all));
}

/// The estimate of one step is of this order.
fn check_estimate<P: Problem, M: Embedded<P>>(flows: &[(P, PointOf<P>)], method: &M, order: usize)
where
    P::Group: LieAlgebra<Scalar = D>,
{
    const STEPS: [f64; 4] = [0.02, 0.016, 0.0125, 0.01];
    assert_eq!(method.facts(&flows[0].0).error_order, Some(order - 1));
    let errors = STEPS.map(|h| {
        let logs = flows.iter().map(|(flow, start)| {
            let (mut work, mut to) = (method.work(flow, start).unwrap(), start.clone());
            let step = Step { n: 0, t: D::lit(0.25), h: D::lit(h) };
            let found =
                method.step_with_error(flow, step, &in_units_of_one(), start, &mut work, &mut to);
            found.unwrap().value().ln()
        });
        (logs.sum::<f64>() / flows.len() as f64).exp()
    });
    let found = slopes(&STEPS.map(|h| 1.0 / h), &errors);
    println!("{}, estimate: {order} {found:.2?}", flows[0].0.group().name());
    assert!(
        found.iter().all(|slope| (slope - order as f64).abs() < 0.15),
        "{found:.2?} {errors:?}"
    );
}

/// That of DOP853 is E²/√(E² + D²/100) with its rows of orders 5 and 3: of order 8 once E is far below
/// D/10, where in `f64` it is rounding.
fn estimate_on<G: Wide>(group: &G, strength: f64)
where
    Exp: CoordinateMap<G>,
{
    let flows: Vec<_> =
        (0..MEMBERS).map(|i| CoupledField::new(group, Kind::Wave, strength, 71 + i)).collect();
    check_estimate(&flows, &Rkmk::new(DOP853, Exp), 8);
    check_estimate(&flows, &Rk(DOP853), 8);
}

/// One test a group.
macro_rules! measure {
    ($on:ident: $($name:ident: $group:expr, $strength:expr;)*) => {$(
        #[test]
        fn $name() {
            $on(&$group, $strength);
        }
    )*};
}

fn so3_and_translations() -> Product<So3<D>, Translations<Vector3<D>>> {
    Product(So3::new(), Translations::new(Vector3::from_fn(|_, _| D::default()), 3))
}

measure! {
    fields_on:
    fields_on_so3: So3::new(), 1.0;
    fields_on_so5: Matrices::so5(), 0.5;
    fields_on_gl3: Matrices::gl3(), 0.5;
    fields_on_sp4: Matrices::sp4(), 0.4;
    fields_on_so31: Matrices::so31(), 0.5;
    fields_on_se3: Se3::new(), 0.7;
    fields_on_a_product: Product(So3::new(), Matrices::sp4()), 0.3;
    fields_on_a_product_with_translations: so3_and_translations(), 0.7;
    fields_on_a_power: Power::new(So3::new(), 2).unwrap(), 1.0;
}

measure! {
    composition_on:
    composition_on_so3: So3::new(), 2.0;
    composition_on_so5: Matrices::so5(), 1.0;
    composition_on_gl3: Matrices::gl3(), 1.0;
    composition_on_sp4: Matrices::sp4(), 0.7;
    composition_on_so31: Matrices::so31(), 1.0;
    composition_on_se3: Se3::new(), 2.0;
    composition_on_a_product: Product(So3::new(), Matrices::sp4()), 0.7;
    composition_on_a_product_with_translations: so3_and_translations(), 2.0;
    composition_on_a_power: Power::new(So3::new(), 2).unwrap(), 2.0;
}

measure! {
    estimate_on:
    estimate_on_so3: So3::new(), 1.0;
    estimate_on_so5: Matrices::so5(), 0.5;
    estimate_on_gl3: Matrices::gl3(), 0.5;
    estimate_on_sp4: Matrices::sp4(), 0.4;
    estimate_on_so31: Matrices::so31(), 0.5;
    estimate_on_se3: Se3::new(), 0.7;
    estimate_on_a_product: Product(So3::new(), Matrices::sp4()), 0.3;
    estimate_on_a_power: Power::new(So3::new(), 2).unwrap(), 1.0;
}

measure! {
    linear_on:
    linear_on_so3: So3::new(), 2.0;
    linear_on_so5: Matrices::so5(), 1.0;
    linear_on_gl3: Matrices::gl3(), 1.0;
    linear_on_sp4: Matrices::sp4(), 0.7;
    linear_on_so31: Matrices::so31(), 1.0;
    linear_on_se3: Se3::new(), 2.0;
    linear_on_a_product: Product(So3::new(), Matrices::sp4()), 0.7;
    linear_on_a_product_with_translations: so3_and_translations(), 2.0;
    linear_on_a_power: Power::new(So3::new(), 2).unwrap(), 2.0;
}

measure! {
    series_on:
    series_on_so5: Matrices::so5(), 0.5;
    series_on_gl3: Matrices::gl3(), 0.4;
    series_on_sp4: Matrices::sp4(), 0.4;
    series_on_so31: Matrices::so31(), 0.5;
}

measure! {
    series_of_time_on:
    series_of_time_on_so5: Matrices::so5(), 0.5;
    series_of_time_on_gl3: Matrices::gl3(), 0.5;
    series_of_time_on_se3: Se3::new(), 1.0;
}
