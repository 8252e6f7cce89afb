//! Single methods on a scene: their operations, their names, and their errors in energy.

use std::time::Duration;

use crate::support::SCENE;
use lieflow::catalog::MethodSpec;
use lieflow_cli::measure::{Candidate, Course, Judge, NEVER, Rows, Size};
use lieflow_model::problem::Layer;
use lieflow_model::scene::{BUNDLED, Scene};

/// The operations of a step of a scene, over its first steps.
fn a_step(scene: &Scene, method: &MethodSpec, size: Size) -> Option<u64> {
    let quantities: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
    let model = scene.model_with(scene.layer, &quantities).unwrap();
    size.operations(&model, method, &three_steps(scene), 1)
}

/// A span as long as three of its own steps, so that all succeed.
fn three_steps(scene: &Scene) -> Course {
    let [from, _] = scene.grid.t_span();
    Course::free([from, from + 3.0 * scene.grid.h()])
}

#[test]
fn every_bundled_scene_has_operations() {
    for bundled in BUNDLED {
        let scene = Scene::bundled(bundled.name).unwrap();
        let quantities: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
        let all = Candidate::all_that_fit(&scene, &quantities, scene.layer).unwrap();
        let label = |c: &&Candidate| c.method.label();
        let mut of_steps = 0;
        for name in ["rkmk4 exp", "rkmk4 cay", "rk4", "cf4", "gauss4", "magnus4", "exact"] {
            let Some(candidate) = all.iter().find(|c| label(c) == name) else { continue };
            let found = a_step(&scene, &candidate.method, Size::Steps(3));
            assert_eq!(found.is_some_and(|n| n > 0), name != "exact", "{}: {name}", bundled.name);
            of_steps += usize::from(name != "exact");
        }
        let chosen = all.iter().find(|c| c.adaptive && c.label().contains("dopri5"));
        if let Some(Candidate { method, .. }) = chosen {
            // Where the run itself ends, which between magnets it does not.
            let size = Size::Tolerance(1e-6);
            let model = scene.model_with(scene.layer, &quantities).unwrap();
            let course = three_steps(&scene);
            let end = course.t_span[1];
            let runs =
                size.run(&model, method, (&course, end), &Rows::ENDS, None, &mut |_, _| {}).is_ok();
            let found = a_step(&scene, method, size);
            assert_eq!(found.is_some_and(|n| n > 0), runs, "{}: {}", bundled.name, method.label());
        }
        assert!(of_steps >= 2, "{}: {of_steps} methods", bundled.name);
    }
}

/// A scene with these keys of its problem.
fn scene(problem: &str, quantity: &str) -> Scene {
    let text = format!(
        "title = \"Test\"\n[problem]\n{problem}\n[method]\nname = \"rk4\"\n[time]\n\
         t_span = [0.0, 1.0]\ndt = 0.1\n[output]\nquantities = [\"{quantity}\"]\n"
    );
    Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// RK4 takes four fields, seven sums y + h·a·k of 2d + 1 operations in d dimensions, and three times t + h·c.
fn rk4(field: u64, d: u64) -> u64 {
    4 * field + 7 * (2 * d + 1) + 3 * 2
}

#[test]
fn classical_steps_on_vectors_take_what_their_fields_take() {
    let cross = 9;
    for (problem, quantity, expected) in [
        // ω(t): Ωt, its sine and cosine, four products and two sums.
        (
            "kind = \"spin\"\nfield = [1.0, 0.0, 2.0]\nrate = 1.0\nmoment = [0.0, 0.6, 0.8]",
            "moment",
            rk4(9 + cross, 3),
        ),
        // Two neighbours, the field, and the anisotropy.
        (
            "kind = \"spin-chain\"\nwave = { count = 5, turns = 1.0, cone = 0.5 }\nanisotropy = 0.1",
            "spins",
            rk4(5 * (3 + 3 + 2 + cross), 15),
        ),
        (
            "kind = \"spherical-pendulum\"\ngravity_over_length = 9.81\n\
             direction = [0.0, 0.6, 0.8]\nvelocity = [1.0, 0.0, 0.0]",
            "direction",
            rk4(2 + cross, 6),
        ),
        // ω = J⁻¹gᵀm, and a product with a vector for every row of g.
        (
            "kind = \"driven-body\"\ninertia = [1.0, 2.0, 3.0]\nomega_body = [1.0, 0.2, 0.0]",
            "axis",
            rk4(15 + 3 + 3 * cross, 12),
        ),
        // Two spins as parts: a sum and a product in each field. One more number, and its product with t.
        (
            "kind = \"composed\"\nparameters = { K = 0.5 }\nparts = [{ name = \"a\", space = \"vector\", start \
             = [1, 0, 0], field = [\"b1\", \"b2\", \"b3 + K*a3\"] }, { name = \"b\", space = \"vector\", start = \
             [0, 0, 1], field = [\"a1\", \"a2\", \"a3 + K*b3\"] }, { name = \"x\", space = \"numbers\", start \
             = [1], field = [\"t*x\"] }]",
            "state",
            rk4(2 * (2 + cross) + 1, 7),
        ),
        // With damping: −c·ω, turned.
        (
            "kind = \"driven-body\"\ninertia = [1.0, 2.0, 3.0]\nomega_body = [1.0, 0.2, 0.0]\n\
             damping = 0.1",
            "axis",
            rk4(15 + 3 + 3 * cross + 3 + 15, 12),
        ),
        // As formulas.
        (
            "kind = \"driven-body\"\ninertia = [1.0, 2.0, 3.0]\nomega_body = [1.0, 0.2, 0.0]\n\
             torque = [\"-0.1*w1\", \"-0.1*w2\", \"-0.1*w3\"]",
            "axis",
            rk4(15 + 3 + 3 * cross + 3 + 15, 12),
        ),
    ] {
        let found =
            a_step(&scene(problem, quantity), &MethodSpec::new("rk4", None), Size::Steps(3));
        assert_eq!(found, Some(expected), "{problem}");
    }
}

/// The same on matrices, where the arithmetic of single numbers is free.
#[test]
fn classical_steps_on_matrices_take_what_their_products_take() {
    // Ẏ = A(t)Y on Sp(2): a − 2q cos(2πt/T), once; a product of 2×2 matrices.
    let (entry, product, numbers) = (6, 12, 4);
    let expected = 4 * (entry + product) + 7 * 2 * numbers;
    // A body by its quaternion: q̄ m q, ω and q ω q̄ (30 each, and 3), half of it times q (3 + 28).
    let body = "kind = \"rigid-body\"\ninertia = [1.0, 2.0, 3.0]\nomega_body = [1.0, 0.2, 0.0]\n\
                quaternion = [1.0, 0.0, 0.0, 0.0]";
    let found = a_step(&scene(body, "quaternion"), &MethodSpec::new("rk4", None), Size::Steps(3));
    assert_eq!(found, Some(4 * (30 + 3 + 30 + 3 + 28) + 7 * 8));
    let mathieu = scene("kind = \"mathieu\"\na = 1.0\nq = 0.2", "solution");
    let found = a_step(&mathieu, &MethodSpec::new("rk4", None), Size::Steps(3));
    assert_eq!(found, Some(expected));
    // The same as formulas: 2t, its cosine, a product and a difference, and three means of the projection.
    let own = "kind = \"matrix-ode\"\ngroup = \"sp\"\n\
               field = [[\"0\", \"1\"], [\"-(1 - 0.4*cos(2*t))\", \"0\"]]";
    let found = a_step(&scene(own, "point"), &MethodSpec::new("rk4", None), Size::Steps(3));
    assert_eq!(found, Some(4 * (4 + 6 + product) + 7 * 2 * numbers));
}

/// A list with spaces, and a method as the tables name it.
#[test]
fn methods_are_named_as_a_reader_would() {
    let scene = Scene::parse("scene", SCENE).unwrap();
    let all = Candidate::all_that_fit(&scene, &["momentum_body"], Layer::General).unwrap();
    let chosen = |names: &str| {
        let names: Vec<String> = names.split(',').map(Into::into).collect();
        let chosen = Candidate::chosen(&scene, &["momentum_body"], &all, &names).unwrap();
        chosen.iter().map(Candidate::label).collect::<Vec<_>>()
    };
    assert_eq!(chosen("rk4, taylor8"), ["rk4, general", "taylor8, general"]);
    let pair = ["rkmk dopri5 cay, general", "rkmk dopri5 cay, adaptive, general"];
    assert_eq!(chosen(pair[1]), pair);
    // Its parts in another order, and parts that the list of all does not have.
    assert_eq!(chosen("rkmk cay dopri5"), pair);
    assert_eq!(chosen("rkmk4 q=2"), ["rkmk4 q=2, general"]);
    assert_eq!(chosen("rkmk rk4 exp q=2, rk4"), ["rk4, general", "rkmk rk4 exp q=2, general"]);
}

/// The error in energy is that of the worst body, whatever their order, and relative to the value.
#[test]
fn the_energy_of_every_body_counts() {
    let first = "{inertia = [1, 2, 3], momentum_body = [1, 4, 2]}";
    let second = "{inertia = [1, 2, 3], momentum_body = [0, 0, 1]}";
    let energy = |bodies: [&str; 2]| {
        let text = format!(
            "[problem]\nkind = \"rigid-bodies\"\nbodies = [{}]\n[time]\nt_span = [0, 10]\nsteps = 8\n",
            bodies.join(", ")
        );
        let scene = Scene::parse("scene", &text).unwrap();
        let quantities = ["momentum_body", "energy"];
        let judge =
            Judge::new(&scene, &quantities, [0.0, 10.0], &[8], Duration::from_secs(1), &NEVER)
                .unwrap();
        let model = scene.model_with(Layer::Closed, &judge.quantities()).unwrap();
        judge.point(&model, &Candidate::rkmk4("exp", Layer::Closed), Size::Steps(8)).energy_error
    };
    let (one, other) = (energy([first, second]), energy([second, first]));
    assert!(one > 0.1 && one == other, "{one:e} {other:e}");
}
