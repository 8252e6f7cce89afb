//! Names: every one that is listed resolves, any other is answered with the list.

use lieflow::catalog::{MAPS, METHODS, MethodSpec, OnMethod, TABLEAUS, with_method};
use lieflow::methods::Method;
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
