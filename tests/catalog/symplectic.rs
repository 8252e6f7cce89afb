//! Which methods for the free body are symplectic: a step Φ of the momentum carries the Lie–Poisson structure,
//! DΦ(m) m̂ DΦ(m)ᵀ = Φ(m)^.

use lieflow::catalog::{MethodSpec, MethodsByName, Needs, Property};
use lieflow::problems::RigidBody;
use lieflow::{SaveAt, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};

/// How far a step of a method is from carrying the structure, by central differences.
fn defect(name: &str) -> f64 {
    let body = RigidBody::new([1.0, 2.0, 3.0]).unwrap();
    let method = body.method(&MethodSpec::new(name, None)).unwrap();
    let grid = TimeGrid::with_steps([0.0, 0.4], 1).unwrap();
    let step = |mut m: Vector3<f64>| {
        integrate(&body, &method, &grid, &SaveAt::End, &mut m, |_, _| {}).unwrap();
        m
    };
    let (m, nudge) = (Vector3::new(0.3, 0.8, 0.6), 1e-4);
    let derivative = Matrix3::from_fn(|row, column| {
        let axis = nudge * Vector3::ith(column, 1.0);
        (step(m + axis)[row] - step(m - axis)[row]) / (2.0 * nudge)
    });
    let carried = derivative * m.cross_matrix() * derivative.transpose();
    (carried - step(m).cross_matrix()).norm()
}

#[test]
fn methods_that_promise_the_symplectic_structure_keep_it() {
    let promised: Vec<_> =
        Needs::Body.methods().iter().filter(|info| info.keeps(Property::Symplectic)).collect();
    assert!(promised.len() > 10);
    for info in promised {
        let found = defect(info.name);
        assert!(found < 1e-7, "{}: {found:e}", info.name);
    }
    // The midpoint rule changes the time by a factor that varies along the orbit.
    for name in ["simo-wong", "simo-wong-k1", "buss4"] {
        assert!(defect(name) > 1e-6, "{name} would keep it");
    }
}
