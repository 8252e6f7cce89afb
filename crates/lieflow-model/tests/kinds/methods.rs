//! `[method]`: a name with its parts, as the command line takes it, and the same parts by their keys.

use lieflow::catalog::{MAPS, MethodSpec, TABLEAUS};

use super::*;

const BODY: &str = "kind = \"driven-body\"\ninertia = [1, 2, 3]\nomega_body = [0.2, 0.1, 1]";

fn method_of(keys: &str) -> MethodSpec {
    scene(BODY, keys, "t_span = [0, 1]\nsteps = 2", "[\"omega_body\"]").method
}

#[test]
fn a_name_may_have_its_parts() {
    for tableau in TABLEAUS {
        for map in MAPS {
            let [tableau, map] = [tableau.name, map.name];
            let by_name = method_of(&format!("name = \"RKMK {map} {tableau}\""));
            assert_eq!(by_name.label(), format!("rkmk {tableau} {map}"));
            for keys in [
                format!("name = \"rkmk\"\ntableau = \"{tableau}\"\nmap = \"{map}\""),
                format!("name = \"rkmk {tableau}\"\nmap = \"{map}\""),
                format!("name = \"rkmk {map}\"\ntableau = \"{tableau}\""),
                // The same twice is no contradiction.
                format!("name = \"rkmk {tableau} {map}\"\nmap = \"{map}\""),
            ] {
                assert_eq!(method_of(&keys), by_name, "{keys}");
            }
        }
    }
    assert_eq!(method_of("name = \"rkmk4 exp q=2\""), method_of("name = \"rkmk4\"\nq = 2"));
    assert_eq!(method_of("name = \"rkmk4 q=2\"").q, Some(2));
}

#[test]
fn a_part_that_contradicts_the_name_is_refused() {
    for (keys, said) in [
        ("name = \"rkmk dopri5 cay\"\nmap = \"exp\"", "`map` is exp and the method"),
        ("name = \"rkmk dopri5\"\ntableau = \"bs3\"", "`rkmk dopri5` has dopri5"),
        ("name = \"rkmk4 q=2\"\nq = 3", "`q` is 3 and the method `rkmk4 q=2` has 2"),
        ("name = \"rkmk4 dopri5\"", "its tableau is fixed"),
    ] {
        let text = format!("[problem]\n{BODY}\n[method]\n{keys}\n[time]\nt_span = [0, 1]\n");
        let error = Scene::parse("scene", &text).unwrap_err().to_string();
        assert!(error.contains(said), "{keys}: {error}");
    }
}
