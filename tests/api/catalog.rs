//! Names: every one that is listed resolves, any other is answered with the list.

use lieflow::Step;
use lieflow::catalog::{
    MAPS, METHODS, MethodSpec, OnEmbedded, OnMethod, TABLEAUS, with_embedded_method, with_method,
};
use lieflow::methods::{Embedded, Method};
use lieflow::problems::RigidBody;
use nalgebra::Vector3;

use crate::says;

struct Order<'a>(&'a RigidBody);

impl OnMethod<RigidBody> for Order<'_> {
    type Out = usize;
    fn call<M: Method<RigidBody>>(self, method: M) -> usize {
        method.work(self.0, &Vector3::x()).unwrap();
        method.order(self.0)
    }
}

fn order_of(spec: &MethodSpec) -> Result<usize, lieflow::Error> {
    with_method(spec, Order(&RigidBody::new([1.0, 2.0, 3.0]).unwrap()))
}

#[test]
fn every_listed_name_resolves() {
    for method in METHODS {
        let maps: Vec<_> =
            if method.takes_map { MAPS.iter().map(|m| Some(m.name)).collect() } else { vec![None] };
        let tableaus: Vec<_> =
            if method.takes_tableau { TABLEAUS.iter().map(Some).collect() } else { vec![None] };
        for map in maps.iter().copied().chain([None]) {
            for tableau in &tableaus {
                let tableau = tableau.map(|t| t.to_string());
                let spec = MethodSpec { tableau, ..MethodSpec::new(method.name, map) };
                let order = order_of(&spec).unwrap();
                assert!(method.order.is_none_or(|o| o == order), "{}: {order}", spec.label());
                for part in [map, spec.tableau.as_deref(), Some(method.name)].into_iter().flatten()
                {
                    assert!(spec.label().contains(part), "{}", spec.label());
                }
            }
        }
    }
    let cut = MethodSpec { q: Some(1), ..MethodSpec::new("rkmk4", Some("exp")) };
    assert_eq!((order_of(&cut).unwrap(), cut.label()), (3, "rkmk4 exp q=1".into()));
    for (q, order) in [(0, 2), (1, 3), (2, 4), (3, 4), (9, 4)] {
        assert_eq!(order_of(&MethodSpec { q: Some(q), ..cut.clone() }).unwrap(), order, "q = {q}");
    }
}

/// One step with its estimate: whether it doubles, the order of the estimate, and the estimate.
struct Estimate<'a>(&'a RigidBody);

impl OnEmbedded<RigidBody> for Estimate<'_> {
    type Out = (bool, usize, f64);
    fn call<M: Embedded<RigidBody>>(self, method: M) -> Self::Out {
        let (start, mut to) = (Vector3::new(1.0, 0.8, -1.2), Vector3::zeros());
        let mut work = method.work(self.0, &start).unwrap();
        let step = Step { n: 0, t: 0.0, h: 0.4 };
        let local = method.step_with_error(self.0, step, &start, &mut work, &mut to).unwrap();
        let doubles = std::any::type_name::<M>().contains("Doubling");
        (doubles, method.error_order(self.0).unwrap(), local.error)
    }
}

#[test]
fn every_listed_method_has_an_estimate() {
    let body = RigidBody::new([1.0, 2.0, 3.0]).unwrap();
    for method in METHODS {
        let maps = if method.takes_map { &[None, Some("cay"), Some("ccsk")][..] } else { &[None] };
        let tableaus = if method.takes_tableau { TABLEAUS } else { &["rk4"] };
        for (map, tableau) in maps.iter().flat_map(|m| tableaus.iter().map(move |t| (m, t))) {
            let tableau = method.takes_tableau.then(|| tableau.to_string());
            let spec = MethodSpec { tableau, ..MethodSpec::new(method.name, *map) };
            let (doubles, order, error) = with_embedded_method(&spec, Estimate(&body)).unwrap();
            let label = spec.label();
            assert_eq!(doubles, !spec.has_pair().unwrap(), "{label}");
            let full = order_of(&spec).unwrap();
            assert!(if doubles { order == full } else { order < full }, "{label}: {order}");
            assert!(error.is_finite() && error > 0.0, "{label}: {error}");
        }
    }
    let unknown = MethodSpec { tableau: Some("rk5".into()), ..MethodSpec::new("rkmk", None) };
    assert!(unknown.has_pair().is_err());
    assert_eq!(
        with_embedded_method(&unknown, Estimate(&body)),
        order_of(&unknown).map(|_| (false, 0, 0.0)),
        "the same error"
    );
}

#[test]
fn unknown_names_are_answered_with_the_list() {
    let names: Vec<_> = METHODS.iter().map(|m| m.name).collect();
    let refused = order_of(&MethodSpec::new("leapfrog", None)).unwrap_err();
    says(&refused, &["method", "`leapfrog`"]);
    says(&refused, &names);
    let names: Vec<_> = MAPS.iter().map(|m| m.name).collect();
    let refused = order_of(&MethodSpec::new("rkmk4", Some("Exp"))).unwrap_err();
    says(&refused, &["map", "`Exp`"]);
    says(&refused, &names);
    for method in ["rkmk", "rk"] {
        let tableau = Some("rk5".to_string());
        let spec = MethodSpec { tableau, ..MethodSpec::new(method, None) };
        let refused = order_of(&spec).unwrap_err();
        says(&refused, &["tableau", "`rk5`"]);
        says(&refused, TABLEAUS);
    }
    assert!(order_of(&MethodSpec::new("", None)).is_err());
}

#[test]
fn parts_that_a_method_does_not_take_are_refused() {
    let part = |method, map, tableau: Option<&str>, q| {
        let tableau = tableau.map(Into::into);
        order_of(&MethodSpec { tableau, q, ..MethodSpec::new(method, map) }).unwrap_err()
    };
    says(part("rk4", Some("exp"), None, None), &["map", "`rk4`", "leave map out"]);
    says(part("rk", Some("cay"), None, None), &["map", "`rk`"]);
    says(part("rk4", None, None, Some(2)), &["q", "`rk4`", "leave q out"]);
    says(part("rkmk4", None, Some("heun"), None), &["tableau", "`rkmk4`", "`rkmk`"]);
    says(part("rk4", None, Some("heun"), None), &["tableau", "`rk4`"]);
    for map in MAPS.iter().filter(|m| m.name != "exp") {
        says(part("rkmk4", Some(map.name), None, Some(2)), &["q", map.name, "exp"]);
    }
}
