//! A long run of a scene allocates as often as a short one: what a kind reads, formulas among it, allocates
//! nothing in a step.

#[path = "../../../tests/support/counting.rs"]
mod counting;

use lieflow::{SaveAt, TimeGrid};
use lieflow_model::scene::{BUNDLED, Scene};

/// How often a run in so many steps of the scene's size allocates.
fn allocations(scene: &Scene, steps: u64) -> usize {
    let model = scene.model().unwrap();
    let ([t0, _], h) = (scene.grid.t_span(), scene.grid.h());
    let grid = TimeGrid::with_steps([t0, t0 + steps as f64 * h], steps).unwrap();
    let before = counting::total();
    model.run(&scene.method, &grid, &SaveAt::Ends, &mut |_, _| {}).unwrap();
    counting::total() - before
}

#[test]
fn no_step_of_a_bundled_scene_allocates() {
    for bundled in BUNDLED {
        let scene = Scene::bundled(bundled.name).unwrap();
        // The first run makes what a thread has once.
        let [_, short, long] = [2, 2, 12].map(|steps| allocations(&scene, steps));
        assert_eq!(short, long, "{}", bundled.name);
    }
}
