//! The checks of the program cover every type of problem, and hold.

use std::collections::BTreeSet;

use lieflow::catalog::MethodSpec;
use lieflow_model::check::check_runs;
use lieflow_model::problem::Layer;
use lieflow_model::scene::{BUNDLED, Scene};

/// The types of problems that the bundled scenes have: on each layer, with the quantities of the scene and with each
/// quantity of the kind alone.
fn types_of_scenes() -> BTreeSet<&'static str> {
    let mut types = BTreeSet::new();
    for bundled in BUNDLED {
        let scene = Scene::bundled(bundled.name).unwrap();
        let computed = scene.computed();
        let known = (scene.problem.kind().quantities)();
        let asked = known.iter().map(|quantity| vec![quantity.name]).chain([computed]);
        for quantities in asked {
            for layer in Layer::ALL {
                let Ok(model) = scene.model_with(layer, &quantities) else { continue };
                let methods =
                    ["rkmk dop853 exp", "rk dop853", "rkmk4 cay"].map(|text| text.parse());
                for method in methods.into_iter().flatten().chain([scene.method.clone()]) {
                    let method: MethodSpec = method;
                    if model.fits(&method).is_ok() {
                        types.insert(model.problem_type(&method));
                    }
                }
            }
        }
    }
    types
}

#[test]
fn every_type_of_problem_is_checked_and_holds() {
    let mut checked = BTreeSet::new();
    check_runs(true, |scene| {
        assert!(scene.failures.is_empty(), "{}: {:?}", scene.name, scene.failures);
        assert!(scene.methods >= 3, "{}: {} methods", scene.name, scene.methods);
        checked.extend(scene.problem_types);
    })
    .unwrap();
    let types = types_of_scenes();
    assert!(types.len() >= 14, "{types:#?}");
    let missing: Vec<_> = types.difference(&checked).collect();
    assert!(missing.is_empty(), "not checked: {missing:#?}");
}
