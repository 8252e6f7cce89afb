//! The kinds of problems as scenes state them: known values, invariants, and what is refused.

#[path = "kinds/bodies.rs"]
mod bodies;
#[path = "kinds/checked.rs"]
mod checked;
#[path = "kinds/columns.rs"]
mod columns;
#[path = "kinds/composed.rs"]
mod composed;
#[path = "kinds/energies.rs"]
mod energies;
#[path = "kinds/euler.rs"]
mod euler;
#[path = "kinds/formulas.rs"]
mod formulas;
#[path = "kinds/known.rs"]
mod known;
#[path = "kinds/matrices.rs"]
mod matrices;
#[path = "kinds/methods.rs"]
mod methods;
#[path = "kinds/motions.rs"]
mod motions;
#[path = "kinds/mutants.rs"]
mod mutants;
#[path = "kinds/numbers.rs"]
mod numbers;
#[path = "kinds/passes.rs"]
mod passes;
#[path = "kinds/quantum.rs"]
mod quantum;
#[path = "kinds/refused.rs"]
mod refused;
#[path = "kinds/samples.rs"]
mod samples;
#[path = "kinds/states.rs"]
mod states;
#[path = "kinds/tops.rs"]
mod tops;
#[path = "kinds/values.rs"]
mod values;
use lieflow_model::kinds::KINDS;
use lieflow_model::scene::{BUNDLED, Scene, SceneError};
use lieflow_model::schema::Row;

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
    let mut sink = |t: f64, row: Row<'_>| rows.push([&[t], row.values()].concat());
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
    for kind in KINDS.iter() {
        let has = |name| Scene::bundled(name).unwrap().problem.kind().name == kind.name;
        assert!(BUNDLED.iter().any(|bundled| has(bundled.name)), "{}", kind.name);
    }
}

/// A row gives its values by name and by observable, and the size of each invariant by its scale.
#[test]
fn a_row_has_the_names_and_the_sizes_of_its_values() {
    let pendulum = Scene::bundled("spherical-pendulum").unwrap();
    let names = ["omega_along", "direction", "energy", "omega", "direction_norm2"];
    let model = pendulum.model_with(pendulum.layer, &names).unwrap();
    let schema = model.schema();
    assert!(schema.iter().map(|observable| observable.name).eq(names));
    assert!(schema.laws().map(|law| law.name).eq([names[0], names[2], names[4]]));
    assert_eq!(schema.columns().count(), 9);
    let [along, direction, energy, omega, norm2] = names.map(|name| schema.get(name).unwrap());
    let mut rows = 0;
    let mut sink = |_: f64, row: Row<'_>| {
        rows += 1;
        let q = &row[direction];
        assert_eq!((q, q), (row.of("direction").unwrap(), &row.values()[1..4]));
        // The size of q · q is its value; that of ω · q, which is 0, is |ω||q|.
        let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((row[norm2][0] - 1.0).abs() < 1e-12 && row[along][0].abs() < 1e-12);
        assert_eq!(row.size(norm2, 0), row[norm2][0]);
        assert!((row.size(along, 0) - length(&row[omega]) * length(q)).abs() < 1e-12);
        assert!(row.size(energy, 0) > row.size(along, 0).powi(2) / 2.0);
        assert!(schema.row(row.values()).size(along, 0).is_nan());
    };
    model.run(&pendulum.method, &pendulum.grid, &pendulum.save, &mut sink).unwrap();
    assert!(rows > 2);
    let error = schema.get("momentum").unwrap_err().to_string();
    assert!(error.contains("`momentum`") && error.contains("omega_along, direction"), "{error}");

    let attitude = scene(
        "kind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.2, 0.1, 1]",
        "name = \"rkmk4\"",
        "t_span = [0, 1]\nsteps = 2",
        "[\"attitude_defect\"]",
    );
    let model = attitude.model().unwrap();
    let defect = model.schema().get("attitude_defect").unwrap();
    let mut sink = |_: f64, row: Row<'_>| assert_eq!(row.size(defect, 0), 1.0);
    model.run(&attitude.method, &attitude.grid, &attitude.save, &mut sink).unwrap();
}
