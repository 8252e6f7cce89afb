//! The scene parser on any text: a scene whose problem and grid are checked, or an error that has
//! something to say. The same of the formulas in it.

use lieflow_model::formula::{Formula, Parameters};
use lieflow_model::scene::Scene;

/// Parse the bytes as a scene.
pub fn parse(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    match Scene::parse("fuzz", &text) {
        Ok(scene) => drop(scene.model()),
        Err(error) => assert!(!error.to_string().is_empty(), "{text:?}"),
    }
}

/// Read the bytes as a formula in x and y, evaluate it and derive it.
pub fn formula(data: &[u8]) {
    let names = Parameters::default().names("variables", ["x", "y"]).expect("two names");
    let text = String::from_utf8_lossy(data);
    match Formula::read("f", &text, &names) {
        Ok(formula) => {
            let _ = formula.value(&[0.3, -0.7]);
            if let Ok(slope) = formula.derivative(1) {
                let _ = slope.value(&[0.3, -0.7]);
            }
        }
        Err(error) => assert!(!error.mistakes.is_empty(), "{text:?}"),
    }
}
