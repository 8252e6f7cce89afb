//! The kinds of problems as scenes state them: known values, invariants, and what is refused.

#[path = "kinds/composed.rs"]
mod composed;
#[path = "kinds/energies.rs"]
mod energies;
#[path = "kinds/formulas.rs"]
mod formulas;
#[path = "kinds/known.rs"]
mod known;
#[path = "kinds/matrices.rs"]
mod matrices;
#[path = "kinds/mutants.rs"]
mod mutants;
#[path = "kinds/refused.rs"]
mod refused;

use lieflow_model::kinds::KINDS;
use lieflow_model::scene::{BUNDLED, Scene};

/// The text of a bundled scene.
fn bundled(name: &str) -> String {
    BUNDLED.iter().find(|scene| scene.name == name).unwrap().text.into()
}

/// A scene of a problem, with a method, a span and steps, and these quantities.
fn scene(problem: &str, method: &str, time: &str, quantities: &str) -> Scene {
    let text = format!(
        "title = \"Test\"\n[problem]\n{problem}\n[method]\n{method}\n[time]\n{time}\n[output]\n\
         quantities = {quantities}\n"
    );
    Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// t and the quantities of every row.
fn rows(scene: &Scene) -> Vec<Vec<f64>> {
    let model = scene.model().unwrap();
    let mut rows = Vec::new();
    let mut sink = |t: f64, row: &[f64]| rows.push([&[t], row].concat());
    model.run(&scene.method, &scene.grid, &scene.save, &mut sink).unwrap();
    rows
}

/// The quantities of the last row.
fn last(scene: &Scene) -> Vec<f64> {
    rows(scene).pop().unwrap().split_off(1)
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn every_kind_has_a_bundled_scene() {
    for kind in KINDS {
        let has = |name| Scene::bundled(name).unwrap().problem.kind().name == kind.name;
        assert!(BUNDLED.iter().any(|bundled| has(bundled.name)), "{}", kind.name);
    }
}
