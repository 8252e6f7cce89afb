//! Names: every one that is listed resolves, any other is answered with the list.

use lieflow::Step;
use lieflow::catalog::{MAPS, MethodSpec, Needs, TABLEAUS, all_methods};
use lieflow::methods::{Embedded, Method};
use lieflow::names::{Alias, MethodPart, find, meant, other_names, same};
use lieflow::problems::RigidBody;
use lieflow::tolerance::{Rule, Tolerance};
use nalgebra::Vector3;

use super::says;
use crate::support::named;

fn body() -> RigidBody {
    RigidBody::new([1.0, 2.0, 3.0]).unwrap()
}

fn order_of(spec: &MethodSpec) -> Result<usize, lieflow::Error> {
    named::explicit(spec, |method| {
        method.work(&body(), &Vector3::x()).unwrap();
        method.facts(&body()).order
    })
}

#[test]
fn every_listed_name_resolves() {
    for method in Needs::Field.methods() {
        let maps: Vec<_> = if method.takes_map() {
            MAPS.iter().map(|m| Some(m.name)).collect()
        } else {
            vec![None]
        };
        let tableaus: Vec<_> = if method.takes_tableau {
            TABLEAUS.iter().map(|t| Some(t.name)).collect()
        } else {
            vec![None]
        };
        for map in maps.iter().copied().chain([None]) {
            for tableau in &tableaus {
                let tableau = tableau.map(|t| t.to_string());
                let spec = MethodSpec { tableau, ..MethodSpec::new(method.name, map) };
                let order = order_of(&spec).unwrap();
                assert!(
                    method.order.number().is_none_or(|o| o == order),
                    "{}: {order}",
                    spec.label()
                );
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

/// One step with its estimate: the order of the estimate, and the estimate.
fn estimate(spec: &MethodSpec) -> Result<(usize, f64), lieflow::Error> {
    named::explicit(spec, |method| {
        let (start, mut to) = (Vector3::new(1.0, 0.8, -1.2), Vector3::zeros());
        let mut work = method.work(&body(), &start).unwrap();
        let step = Step { n: 0, t: 0.0, h: 0.4 };
        let one = Tolerance::new(0.0, 1.0).unwrap().by(Rule::PerLength);
        let found = method.step_with_error(&body(), step, &one, &start, &mut work, &mut to);
        (method.facts(&body()).order_of_estimate().unwrap(), found.unwrap())
    })
}

#[test]
fn every_listed_method_has_an_estimate() {
    for method in Needs::Field.methods() {
        let maps =
            if method.takes_map() { &[None, Some("cay"), Some("ccsk")][..] } else { &[None] };
        let tableaus = if method.takes_tableau { TABLEAUS } else { &TABLEAUS[..1] };
        for (map, tableau) in maps.iter().flat_map(|m| tableaus.iter().map(move |t| (m, t))) {
            let tableau = method.takes_tableau.then(|| tableau.name.to_string());
            let spec = MethodSpec { tableau, ..MethodSpec::new(method.name, *map) };
            let (order, error) = estimate(&spec).unwrap();
            let (label, full) = (spec.label(), order_of(&spec).unwrap());
            // Step doubling estimates to the order of the method, a pair to a lower one.
            assert_eq!(order < full, spec.has_pair().unwrap(), "{label}: {order}");
            assert!(order <= full, "{label}: {order}");
            assert!(error.is_finite() && error > 0.0, "{label}: {error}");
        }
    }
    let unknown = MethodSpec { tableau: Some("rk5".into()), ..MethodSpec::new("rkmk", None) };
    assert!(unknown.has_pair().is_err());
    assert_eq!(estimate(&unknown).unwrap_err(), order_of(&unknown).unwrap_err());
}

#[test]
fn unknown_names_are_answered_with_the_list() {
    let names: Vec<_> = Needs::Field.methods().iter().map(|m| m.name).collect();
    let refused = order_of(&MethodSpec::new("no such method", None)).unwrap_err();
    says(&refused, &["method", "`no such method`"]);
    says(&refused, &names);
    let refused = order_of(&MethodSpec::new("leapfrog", None)).unwrap_err();
    assert_eq!(refused.to_string(), "unknown method `leapfrog`: did you mean `mr2`?");
    let refused = "rk45".parse::<MethodSpec>().unwrap_err();
    assert_eq!(refused.to_string(), "unknown method `rk45`: did you mean `rkmk dopri5`?");
    let names: Vec<_> = MAPS.iter().map(|m| m.name).collect();
    let refused = order_of(&MethodSpec::new("rkmk4", Some("Cayley"))).unwrap_err();
    says(&refused, &["map", "`Cayley`", "did you mean `cay`?"]);
    says(&refused, &names);
    for method in ["rkmk", "rk"] {
        let tableau = Some("rk5".to_string());
        let spec = MethodSpec { tableau, ..MethodSpec::new(method, None) };
        let refused = order_of(&spec).unwrap_err();
        says(&refused, &["tableau", "`rk5`"]);
        says(&refused, &TABLEAUS.iter().map(|t| t.name).collect::<Vec<_>>());
    }
    assert!(order_of(&MethodSpec::new("", None)).is_err());
    for (text, part) in
        [("rkmk heun bs3", "tableau"), ("rkmk4 exp exp", "map"), ("rkmk4 q=2 exp q=3", "q")]
    {
        says(text.parse::<MethodSpec>().unwrap_err(), &[&format!("has a {part} already")]);
    }
    for (q, said) in [
        ("abc", "unknown q `abc`: "),
        ("nan", "unknown q `nan`: "),
        ("", "unknown q ``: "),
        ("-1", "q = -1, "),
        ("0.5", "q = 0.5, "),
        ("1001", "q = 1001, "),
        ("99999999999999999999", "q = 1e20, "),
        ("inf", "q = inf, "),
    ] {
        let error = format!("rkmk4 q={q}").parse::<MethodSpec>().unwrap_err();
        let expected = format!("{said}expected a whole number from 0 to 1000, as in q=2");
        assert_eq!(error.to_string(), expected, "{q}");
    }
    assert!("rkmk4 q=1000".parse::<MethodSpec>().is_ok());
}

/// Case and hyphens do not count, and what comes back is spelt as in the listings.
#[test]
fn names_in_other_spellings() {
    let spec: MethodSpec = "RKMK Dopri5 CAY".parse().unwrap();
    assert_eq!(spec.label(), "rkmk dopri5 cay");
    let spec: MethodSpec = "rkmk Three_Eighths".parse().unwrap();
    assert_eq!(spec.label(), "rkmk three-eighths");
    let spec =
        MethodSpec { tableau: Some("DOP853".into()), ..MethodSpec::new("Rkmk", Some("EXP")) };
    assert_eq!(spec.has_pair(), Ok(true));
    assert_eq!(spec.spelt().unwrap().label(), "rkmk dop853 exp");

    let methods: Vec<_> = all_methods().map(|m| m.name).collect();
    for list in [
        &methods,
        &MAPS.iter().map(|m| m.name).collect(),
        &TABLEAUS.iter().map(|t| t.name).collect(),
    ] {
        for (i, a) in list.iter().enumerate() {
            assert!(list[..i].iter().all(|b| !same(a, b)), "{a}");
        }
    }
    // What is no method says what it is, and each name of another program is something here.
    let parts = MAPS.iter().map(|m| m.name).chain(TABLEAUS.iter().map(|t| t.name));
    for part in parts.filter(|part| !methods.contains(part)) {
        let Some(Alias { name, part: Some(MethodPart::Tableau(meant) | MethodPart::Map(meant)) }) =
            meant(part, &methods)
        else {
            panic!("{part}")
        };
        assert_eq!((name.starts_with("rkmk"), meant), (true, part));
    }
    for (other, meant) in other_names() {
        let spec: MethodSpec = meant.to_string().parse().unwrap();
        assert_eq!(spec.label(), meant.to_string(), "{other}");
        assert!(find(other, methods.iter().copied()).is_none(), "{other} is a method");
    }
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

/// docs/methods.md names every method, map and tableau.
#[test]
fn the_guide_knows_them_all() {
    let guide = include_str!("../../../docs/methods.md");
    let methods = all_methods().map(|info| info.name);
    for name in methods.chain(TABLEAUS.iter().map(|t| t.name)).chain(MAPS.iter().map(|m| m.name)) {
        let named = guide.contains(&format!("`{name}`")) || name.starts_with("ccsk");
        assert!(named, "`{name}` is not in docs/methods.md");
    }
}
