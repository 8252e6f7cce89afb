//! Euler's equations on any algebra.

use super::*;
use faer::Mat;
use lieflow::actions::Coadjoint;
use lieflow::groups::{Adjoint, AlgebraMatrix, LieGroup, MatrixGroup, Product, Sample, Se3, So3};
use lieflow::methods::EnergyCasimir;
use lieflow::problems::{Euler, Hamiltonian, Kinetic, RigidBody, RigidBodyN};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

type V = Vector3<f64>;
type Pair = (V, V);
type Inertia = fn(&Pair, &mut Pair);

const INERTIA: [f64; 3] = [1.0, 2.0, 3.5];

fn omega(m: &V, xi: &mut V) {
    *xi = m.component_div(&V::from(INERTIA));
}

/// A rigid body is its inverse inertia and nothing else.
#[test]
fn on_so3_it_is_the_rigid_body() {
    let (general, body) = (Euler::new(So3::<f64>::new(), Kinetic(omega)), RigidBody::new(INERTIA));
    let (body, m) = (body.unwrap(), V::new(1.0, 0.8, -1.2));
    assert!((general.energy(&m) - body.energy(&m)).abs() < 4.0 * EPS);
    let far = (flow(&general, 5.0, 500, &m) - flow(&body, 5.0, 500, &m)).norm();
    assert!(far < 1e-13, "{far:e}");
    has_order_4(&general, &m, 3.0, 30);
}

/// And on so(n), with n×n matrices.
#[test]
fn on_so4_it_is_manakovs_body() {
    let lambda = [0.4, 1.1, 1.9, 2.5];
    let inverse = move |m: &Mat<f64>, xi: &mut AlgebraMatrix| {
        for j in 0..4 {
            for i in 0..4 {
                xi[(i, j)] = if i == j { 0.0 } else { m[(i, j)] / (lambda[i] + lambda[j]) };
            }
        }
    };
    let general = Euler::new(MatrixGroup::so(4).unwrap(), Kinetic(inverse));
    let body = RigidBodyN::manakov(&lambda).unwrap();
    let m = body.group().sample_algebra(&mut Pcg64::seed_from_u64(8), 1.0).into_mat();
    let (a, b) = (flow(&general, 2.0, 200, &m), flow(&body, 2.0, 200, &m));
    assert!((&a - &b).norm_l2() < 1e-13, "{:e}", (&a - &b).norm_l2());
    // ⟨m, v⟩ = tr(mᵀv) sees every pair of entries twice.
    assert!((general.energy(&m) - 2.0 * body.energy(&m)).abs() < 1e-13);
}

fn kirchhoff() -> Euler<Se3, Kinetic<Inertia>> {
    Euler::new(
        Se3::new(),
        Kinetic(|m: &(V, V), u: &mut (V, V)| {
            u.0 = m.0.component_div(&V::new(1.0, 2.0, 3.0));
            u.1 = m.1.component_div(&V::new(1.5, 1.2, 1.0));
        }),
    )
}

const KIRCHHOFF: (V, V) = (V::new(0.3, 0.6, 1.0), V::new(0.7, 0.4, 1.0));

#[test]
fn on_se3_it_is_kirchhoffs_ellipsoid() {
    let body = kirchhoff();
    has_order_4(&body, &KIRCHHOFF, 3.0, 24);
    let casimirs = |m: &(V, V)| [m.0.dot(&m.1), m.1.norm_squared()];
    let end = flow(&body, 20.0, 2000, &KIRCHHOFF);
    for (a, b) in casimirs(&KIRCHHOFF).into_iter().zip(casimirs(&end)) {
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    assert!((body.energy(&end) - body.energy(&KIRCHHOFF)).abs() < 1e-8);
}

/// The discrete gradient of a quadratic H: energy and Casimirs to rounding at a large step.
#[test]
fn energy_and_casimirs_together() {
    let body = kirchhoff();
    let end = run(&body, &EnergyCasimir::new(Cay), 40.0, 400, &KIRCHHOFF);
    assert!((body.energy(&end) - body.energy(&KIRCHHOFF)).abs() < 1e-12);
    assert!((end.1.norm() - KIRCHHOFF.1.norm()).abs() < 1e-13);
    assert!((end.0.dot(&end.1) - KIRCHHOFF.0.dot(&KIRCHHOFF.1)).abs() < 1e-12);
}

/// With g: m moves as before, and the momentum in space stays where it was.
#[test]
fn with_the_group_the_space_momentum_is_constant() {
    let body = kirchhoff();
    let alone = flow(&body, 4.0, 400, &KIRCHHOFF);
    let both = body.with_group();
    let start = (Se3::<f64>::new().identity(), KIRCHHOFF);
    let (g, m) = flow(&both, 4.0, 400, &start);
    assert!((m.0 - alone.0).norm() + (m.1 - alone.1).norm() < 1e-13);
    let (group, mut inverse, mut space) = (Se3::<f64>::new(), g, m);
    group.inverse(&g, &mut inverse).unwrap();
    group.coad_group(&inverse, &m, &mut space).unwrap();
    let far = (space.0 - KIRCHHOFF.0).norm() + (space.1 - KIRCHHOFF.1).norm();
    assert!(far < 1e-12, "{far:e}");
    // ġ = g∇H: one small step moves g by h∇H.
    let mut xi = (V::zeros(), V::zeros());
    Hamiltonian::<Se3>::gradient(both.system().hamiltonian(), &KIRCHHOFF, &mut xi);
    let (g, _) = flow(&both, 1e-6, 1, &start);
    assert!((g.1 * 1e6 - xi.1).norm() < 1e-5);
}

/// H need not be quadratic, and the group may be a product: two bodies that feel each other.
#[test]
fn two_coupled_bodies() {
    let energy = |m: &(V, V)| {
        let kinetic = |m: &V| 0.5 * m.dot(&m.component_div(&V::from(INERTIA)));
        kinetic(&m.0) + kinetic(&m.1) + 0.3 * m.0.dot(&m.1).sin()
    };
    let gradient = |m: &(V, V), xi: &mut (V, V)| {
        let (slope, j) = (0.3 * m.0.dot(&m.1).cos(), V::from(INERTIA));
        *xi = (m.0.component_div(&j) + slope * m.1, m.1.component_div(&j) + slope * m.0);
    };
    let pair = Euler::new(Product(So3::<f64>::new(), So3::new()), (energy, gradient));
    let m = (V::new(1.0, 0.2, -0.4), V::new(0.3, -0.8, 0.5));
    has_order_4(&pair, &m, 3.0, 30);
    let end = flow(&pair, 10.0, 2000, &m);
    assert!((end.0.norm() - m.0.norm()).abs() + (end.1.norm() - m.1.norm()).abs() < 1e-13);
    assert!((pair.energy(&end) - pair.energy(&m)).abs() < 1e-9);
}

/// A general matrix algebra: on sp(4)* with ∇H(m) the part of m in the algebra.
#[test]
fn on_sp4() {
    let group = MatrixGroup::sp(4).unwrap();
    let (of_h, weight) = (group.clone(), [1.0, 0.5, 0.8, 1.3]);
    let gradient = move |m: &Mat<f64>, xi: &mut AlgebraMatrix| {
        let weighted = Mat::from_fn(4, 4, |i, j| weight[i] * weight[j] * m[(i, j)]);
        *xi = of_h.project_algebra(weighted.as_ref());
    };
    let system = Euler::new(group.clone(), Kinetic(gradient));
    let mut rng = Pcg64::seed_from_u64(4);
    let m = group.sample_algebra(&mut rng, 0.4).into_mat();
    has_order_4(&system, &m, 1.0, 16);
    let end = flow(&system, 1.0, 100, &m);
    let trace =
        |m: &Mat<f64>| (m * m)[(0, 0)] + (m * m)[(1, 1)] + (m * m)[(2, 2)] + (m * m)[(3, 3)];
    assert!((trace(&end) - trace(&m)).abs() < 1e-12);
    assert!((system.energy(&end) - system.energy(&m)).abs() < 1e-7);
    let _: &Coadjoint = system.action();
}
