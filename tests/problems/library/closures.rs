//! Problems from closures: the same bits as a problem written by hand, and what is known beyond f.

use super::*;
use faer::Mat;
use lieflow::actions::{Coadjoint, LeftTranslation, Linear};
use lieflow::groups::{MatrixGroup, Product, Sample, So3, Translations};
use lieflow::methods::magnus::Magnus4;
use lieflow::methods::{EnergyCasimir, GAUSS4, Gauss};
use lieflow::problems::{
    DynFlow, Fallible, Flow, Invariant, LiePoisson, Oja, RigidBody, RigidBodyN, SphericalPendulum,
    TryFlow, WithHamiltonian,
};
use lieflow::{LieGroup, Solve};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

type V = Vector3<f64>;
const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];

fn momentum() -> V {
    V::new(0.2, 1.0, 3.0)
}

/// By a method of each kind.
fn ends<P>(problem: &P, y: &PointOf<P>) -> [PointOf<P>; 3]
where
    P: Ambient,
    Cay: CoordinateMap<P::Group>,
{
    [
        run(problem, &Rkmk::new(RK4, Cay), 1.0, 20, y),
        run(problem, &Rk(RK4), 1.0, 20, y),
        run(problem, &Gauss(GAUSS4), 1.0, 20, y),
    ]
}

#[test]
fn a_closure_is_the_problem_written_by_hand() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let closure = Flow::new(So3::<f64>::new(), Coadjoint, |_, m, v| *v = -body.omega(m));
    let ([a, b, c], [x, y, z]) = (ends(&closure, &momentum()), ends(&body, &momentum()));
    assert_eq!([a, c], [x, z]);
    // The body has a formula of its own for the field that classical methods take.
    assert!((b - y).norm() <= 4.0 * f64::EPSILON * y.norm(), "{b} and {y}");
    assert_eq!(format!("{closure:?}"), "Flow { group: \"SO(3)\", .. }");

    // The dense layer, with scratch.
    let so4 = MatrixGroup::so(4).unwrap();
    let body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0]).unwrap();
    let m = so4.sample_algebra(&mut Pcg64::seed_from_u64(1), 1.0).into_mat();
    let make = || Mat::<f64>::zeros(4, 4);
    let closure = Flow::with_work(so4, Coadjoint, make, |_, m, v, scratch: &mut Mat<f64>| {
        scratch.copy_from(m);
        body.f(0.0, scratch, v, &mut ());
    });
    assert_eq!(ends(&closure, &m), ends(&body, &m));
}

/// The storage of v holds values of other stages: a closure that writes only the entries that are not 0 must not see
/// them.
#[test]
fn a_closure_may_leave_entries_out_that_are_0() {
    fn entries(t: f64, y: &Mat<f64>, v: &mut Mat<f64>) {
        for i in 0..4 {
            v[(i, i + 1)] = (t + i as f64).cos() + y[(i, i + 1)];
            v[(i + 1, i)] = -(t + i as f64).cos() - y[(i, i + 1)];
        }
    }
    let so5 = || MatrixGroup::so(5).unwrap();
    let some = Flow::new(so5(), LeftTranslation, |t, y, v| entries(t, y, v));
    let all = Flow::new(so5(), LeftTranslation, |t, y, v| {
        so5().set_zero(v);
        entries(t, y, v);
    });
    let start = so5().identity();
    assert_eq!(ends(&some, &start), ends(&all, &start));
    let some = TryFlow::new(so5(), LeftTranslation, |t, y, v| {
        entries(t, y, v);
        Ok::<(), lieflow::Error>(())
    });
    let [some, all] = [
        run(&Fallible::new(some), &Rkmk::new(RK4, Cay), 1.0, 20, &start),
        run(&all, &Rkmk::new(RK4, Cay), 1.0, 20, &start),
    ];
    assert_eq!(some, all);
}

#[test]
fn on_a_product() {
    // ẋ = (0, 0, s) × x, ṡ = 1: x turns by the angle t²/2.
    let group = Product(So3::<f64>::new(), Translations::new(0.0, 1));
    let flow = Flow::new(group, Linear, |_, y, v| *v = (V::new(0.0, 0.0, y.1), 1.0));
    let (x, s) = run(&flow, &Rkmk::new(RK4, Exp), 2.0, 10, &(V::x(), 0.0));
    assert!((x - V::new(2f64.cos(), 2f64.sin(), 0.0)).norm() < 1e-14 && (s - 2.0).abs() < 1e-14);
}

#[test]
fn linear_type_by_its_type_and_by_its_name() {
    let a = |t: f64| V::new(t.cos(), t.sin(), 2.0);
    let of_time = Flow::of_time(So3::<f64>::new(), Linear, |t, v| *v = a(t));
    let by_name = Flow::new(So3::<f64>::new(), Linear, |t, _, v| *v = a(t)).linear();
    let end = run(&of_time, &Magnus4, 1.0, 10, &V::x());
    assert_eq!(end, run(&by_name, &Magnus4, 1.0, 10, &V::x()));
    // The first column of ġ = A(t)g.
    let one = of_time.group().identity();
    let g = run(&of_time.by(LeftTranslation), &Magnus4, 1.0, 10, &one);
    assert!((g * V::x() - end).norm() < 1e-15);
}

/// H = Σ cosh(k_i m_i), which is not quadratic.
#[test]
fn a_hamiltonian_and_invariants() {
    let k = V::new(1.0, 0.6, 0.3);
    let energy = move |m: &V| m.component_mul(&k).map(f64::cosh).sum();
    let flow = Flow::new(So3::<f64>::new(), Coadjoint, move |_, m, v| {
        *v = -k.component_mul(&m.component_mul(&k).map(f64::sinh));
    })
    .hamiltonian(energy)
    .invariant(Invariant::of_the_action("|m|²", 2), |m| m.norm_squared());

    let names = [Invariant::of_the_flow("energy", 0), Invariant::of_the_action("|m|²", 2)];
    assert_eq!(flow.invariants(), names);
    let m = V::new(0.3, 0.1, 1.0);
    assert_eq!(flow.values(&m), [energy(&m), m.norm_squared()]);

    let (b, mut xi, mut scratch) = (V::new(-0.4, 1.3, 0.2), V::zeros(), (V::zeros(), V::zeros()));
    let (point, v) = (&mut scratch.0, &mut scratch.1);
    flow.discrete_gradient(&m, &b, &mut xi, (point, v), &mut ());
    assert!(((b - m).dot(&xi) - (energy(&b) - energy(&m))).abs() < 4.0 * EPS * energy(&b));

    let end = run(&flow, &EnergyCasimir::new(Cay), 20.0, 200, &m);
    assert!((energy(&end) - energy(&m)).abs() < 200.0 * EPS * energy(&m));
    keeps_its_invariants(&flow, &m, 10.0, 100, 1e-4);
}

/// The same bits behind a pointer, with a field on M of its own (Oja) and without one.
#[test]
fn behind_a_pointer() {
    let body = RigidBody::<f64>::new(INERTIA).unwrap();
    let pointed: DynFlow<_, _, (), WithHamiltonian> = DynFlow::lie_poisson(body, Coadjoint);
    assert_eq!(ends(&pointed, &momentum()), ends(&body, &momentum()));
    assert_eq!(pointed.hamiltonian(&momentum()), body.energy(&momentum()));
    assert!(pointed.is_lie_poisson() && !pointed.is_linear());
    let by = EnergyCasimir::new(Cay);
    assert_eq!(run(&pointed, &by, 1.0, 10, &momentum()), run(&body, &by, 1.0, 10, &momentum()));

    let a = faer::mat![[2.0, 0.5, 0.1], [0.5, 1.0, -0.3], [0.1, -0.3, 0.2]];
    let (oja, x) = (Oja::new(a, 1).unwrap(), faer::mat![[0.6], [0.0], [0.8]]);
    let pointed: DynFlow<_, _> = DynFlow::new(oja.clone(), Linear);
    assert_eq!(ends(&pointed, &x), ends(&oja, &x));

    let pendulum = SphericalPendulum::new(9.81).unwrap();
    let start = (V::new(0.3, 0.1, 0.0), V::new(0.0, 0.6, 0.8));
    let pointed: DynFlow<_, _, (), WithHamiltonian> = DynFlow::lie_poisson(pendulum, Coadjoint);
    assert_eq!(ends(&pointed, &start), ends(&pendulum, &start));
}

/// Without a Hamiltonian the gradient is not a number: a method that asks for it fails at the first step.
#[test]
fn a_pointer_to_a_problem_without_a_hamiltonian() {
    let turn = Flow::new(So3::<f64>::new(), Coadjoint, |_, _, v| *v = V::x());
    let pointed: DynFlow<_, _, (), WithHamiltonian> = DynFlow::new(turn, Coadjoint);
    assert!(pointed.hamiltonian(&momentum()).is_nan());
    let (mut m, grid) = (momentum(), TimeGrid::with_steps([0.0, 1.0], 2).unwrap());
    let by = EnergyCasimir::new(Cay);
    assert!(integrate(&pointed, &by, &grid, &SaveAt::Ends, &mut m, |_, _| {}).is_err());
}

/// Every method for linear equations runs on complex matrices and on translations, by name: on U(2) as on its real matrices
/// \[X −Y; Y X\].
#[test]
fn linear_equations_on_unitary_groups_and_translations() {
    use lieflow::catalog::{MethodsByName, Needs, all_methods};
    use lieflow::groups::{ComplexMatrix, Unitary};
    let h = |t: f64| [[0.3, 0.5 * t.cos(), 0.7 * t.sin()], [-0.2, 0.1 * t, 0.0]];
    let complex = Unitary::new(2).expect("a group");
    let start = complex.identity();
    let complex = Flow::of_time(complex, LeftTranslation, move |t, v: &mut ComplexMatrix| {
        let [[a, x, y], [b, ..]] = h(t);
        (v.im[(0, 0)], v.im[(1, 1)]) = (a, b);
        (v.re[(0, 1)], v.re[(1, 0)]) = (y, -y);
        (v.im[(0, 1)], v.im[(1, 0)]) = (x, x);
    });
    let real = MatrixGroup::u(2).expect("a group");
    let real_start = real.identity();
    let real = Flow::of_time(real, LeftTranslation, move |t, v| {
        let [[a, x, y], [b, ..]] = h(t);
        (v[(0, 1)], v[(1, 0)], v[(2, 3)], v[(3, 2)]) = (y, -y, y, -y);
        (v[(2, 0)], v[(0, 2)], v[(3, 1)], v[(1, 3)]) = (a, -a, b, -b);
        (v[(2, 1)], v[(3, 0)], v[(0, 3)], v[(1, 2)]) = (x, x, -x, -x);
    });
    let shift =
        Flow::of_time(Translations::new(V::zeros(), 3), LeftTranslation, |t: f64, v: &mut V| {
            *v = V::new(t.cos(), 2.0, -t.sin());
        });
    let mut methods = 0;
    for info in all_methods().filter(|info| info.needs == Needs::LinearType) {
        let spec = info.name.parse().expect("a name");
        let method = complex.method(&spec).expect("a method");
        let g =
            Solve::new(&complex, &method, [0.0, 1.0]).steps(8).run(start.clone()).expect("a run").y;
        let method = real.method(&spec).expect("a method");
        let r = Solve::new(&real, &method, [0.0, 1.0])
            .steps(8)
            .run(real_start.clone())
            .expect("a run")
            .y;
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let far = (g.re[(i, j)] - r[(i, j)]).abs() + (g.im[(i, j)] - r[(2 + i, j)]).abs();
            assert!(far < 1e-14, "{}: {far:e} in ({i}, {j})", info.name);
        }
        let method = shift.method(&spec).expect("a method");
        let y = Solve::new(&shift, &method, [0.0, 1.0]).steps(64).run(V::zeros()).expect("a run").y;
        let exact = V::new(1f64.sin(), 2.0, 1f64.cos() - 1.0);
        assert!((y - exact).norm() < 1e-4, "{}: {y}", info.name);
        methods += 1;
    }
    assert!(methods > 8, "{methods}");
}
