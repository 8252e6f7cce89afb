//! The free rigid bodies' invariants by name, Manakov's integrals, and many bodies at once.

use super::*;
use faer::Mat;
use lieflow::groups::{Power, Sample, So3};
use lieflow::problems::{
    Euler, Kinetic, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude, RigidBodyState,
    manakov_integrals,
};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// A vector for each body.
type Bodies = Box<[Vector3<f64>]>;

const INERTIA: [f64; 3] = [1.0, 2.0, 3.5];

#[test]
fn bodies_name_what_they_keep() {
    let m = Vector3::new(1.0, 0.8, -1.2);
    keeps_its_invariants(&RigidBody::new(INERTIA).unwrap(), &m, 10.0, 2000, 1e-10);
    let attitude = RigidBodyAttitude::<f64>::new(INERTIA, m.into()).unwrap();
    keeps_its_invariants(&attitude, &Matrix3::identity(), 10.0, 2000, 1e-10);
    let both = RigidBodyState::<f64>::new(INERTIA).unwrap();
    let start = both.state(m.into(), Matrix3::identity()).unwrap();
    keeps_its_invariants(&both, &start, 10.0, 2000, 1e-10);
    assert_eq!(both.invariants().len(), 5);
}

/// On so(4) and so(5) the extra integrals of Manakov's body are constant, and of another body not.
#[test]
fn manakovs_integrals() {
    for (n, count) in [(4, 2), (5, 4)] {
        let lambda = &[0.4, 1.1, 1.9, 2.5, 3.2][..n];
        let body = RigidBodyN::manakov(lambda).unwrap();
        let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(8), 1.0).into_mat();
        keeps_its_invariants(&body, &m, 4.0, 1000, 1e-9);
        let names: Vec<String> = body.invariants().into_iter().map(|i| i.name).collect();
        assert_eq!(names, ["tr m^2", "tr m^4", "energy"]);
        let attitude = RigidBodyNAttitude::new(body.clone(), m.clone()).unwrap();
        keeps_its_invariants(
            &attitude,
            &attitude.group().sample_element(&mut Pcg64::seed_from_u64(9)),
            1.0,
            400,
            1e-8,
        );

        let before = manakov_integrals(lambda, &m);
        assert_eq!(before.len(), count, "so({n})");
        let far = |m: &Mat<f64>| {
            let gaps = manakov_integrals(lambda, m).into_iter().zip(&before);
            gaps.map(|(a, b)| (a - b).abs() / b.abs().max(1.0)).fold(0.0, f64::max)
        };
        assert!(far(&flow(&body, 4.0, 1000, &m)) < 1e-8);
        let pairs: Vec<f64> = (0..n * (n - 1) / 2).map(|k| 1.0 + 0.3 * k as f64).collect();
        let other = RigidBodyN::from_pairs(n, &pairs).unwrap();
        assert!(far(&flow(&other, 4.0, 1000, &m)) > 1e-3);
    }
}

/// A hundred bodies as one system are a hundred systems.
#[test]
fn many_bodies_at_once() {
    let inertia = |i: usize| Vector3::from(INERTIA) * (1.0 + 0.01 * i as f64);
    let inverse = move |m: &Bodies, xi: &mut Bodies| {
        for (i, (m, xi)) in m.iter().zip(xi).enumerate() {
            *xi = m.component_div(&inertia(i));
        }
    };
    let all = Euler::new(Power::new(So3::<f64>::new(), 100).unwrap(), Kinetic(inverse));
    let start: Box<[_]> = (0..100).map(|i| Vector3::new(1.0, 0.01 * i as f64, -1.2)).collect();
    let end = flow(&all, 2.0, 100, &start);
    for i in (0..100).step_by(9) {
        let alone = Euler::new(
            So3::<f64>::new(),
            Kinetic(move |m: &Vector3<f64>, xi: &mut Vector3<f64>| {
                *xi = m.component_div(&inertia(i))
            }),
        );
        let far = (flow(&alone, 2.0, 100, &start[i]) - end[i]).norm();
        assert!(far < 64.0 * EPS, "body {i}: {far:e}");
    }
}
