//! Vectors, spins, momenta and pendulums over 100 000 steps: the driver takes them back to the orbits that they
//! started on. Without it rounding walks at random, ½ε√n at most in what was measured, and where every step is
//! the same rotation it errs the same way each time, by up to 1.3 ε a step.

use core::cell::Cell;

use crate::support::uncorrected::{Uncorrected, cpu_seconds};
use faer::{Mat, c64};
use lieflow::actions::{Coadjoint, LeftTranslation, Linear, Pair};
use lieflow::groups::{
    AlgebraMatrix, ComplexMatrix, LieAlgebra, LieGroup, MatrixGroup, Power, Product, So3,
    Translations, Unitary,
};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::magnus::Magnus4;
use lieflow::methods::{CommutatorFree, Method, Rk, Rkmk, commutator_free::CF4, tableau::RK4};
use lieflow::problems::{
    Flow, LinearFlow, PointOf, Problem, RigidBody, RigidBodyState, SphericalPendulum, SpinChain,
    amplitudes, schrodinger,
};
use lieflow::{Action, SaveAt, Stats, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};

type V = Vector3<f64>;

const STEPS: u64 = 100_000;
const EPS: f64 = f64::EPSILON;
/// |x|² is held as ‖gᵀg‖ is, to 2e-14.
const HELD: f64 = 1e-14;

/// The largest change of `length`, which is 1, at every tenth step on the way.
fn drift_over<P, M>(
    steps: u64,
    problem: &P,
    method: &M,
    start: &PointOf<P>,
    length: impl Fn(&PointOf<P>) -> f64,
) -> (f64, Stats)
where
    P: Problem<Group: LieAlgebra<Scalar = f64>>,
    M: Method<P>,
{
    let (mut y, mut worst) = (start.clone(), 0.0f64);
    let grid = TimeGrid::with_steps([0.0, 0.05 * steps as f64], steps).expect("a grid");
    let stats = integrate(problem, method, &grid, &SaveAt::Every(10), &mut y, |_, y| {
        worst = worst.max((length(y) - 1.0).abs());
    });
    (worst, stats.expect("a run"))
}

fn drift<P, M>(problem: &P, method: &M, start: &PointOf<P>, of: impl Fn(&PointOf<P>) -> f64) -> f64
where
    P: Problem<Group: LieAlgebra<Scalar = f64>>,
    M: Method<P>,
{
    let (worst, stats) = drift_over(STEPS, problem, method, start, of);
    assert!(stats.restored >= STEPS / 100 && stats.not_restored == 0, "{stats:?}");
    worst
}

/// A spin in the field ω(t).
fn spin<F: Fn(f64, &mut V)>(field: F) -> LinearFlow<So3, Linear, F> {
    Flow::of_time(So3::new(), Linear, field)
}

/// Where every step is the same rotation.
fn constant(k: i32) -> impl Fn(f64, &mut V) {
    let a = f64::from(k);
    let u = V::new((1.3 * a).sin(), (2.7 * a + 1.0).cos(), 1.5 * (0.77 * a).sin());
    move |_, v| *v = 20.0 * u
}

#[test]
fn spins_stay_on_their_spheres() {
    let turning = spin(|t: f64, v: &mut V| *v = V::new(t.cos(), t.sin(), 0.7));
    let start = V::new(0.6, 0.0, 0.8);
    let found = [
        drift(&turning, &Rkmk::new(RK4, Exp), &start, V::norm),
        drift(&turning, &Rkmk::new(RK4, Cay), &start, V::norm),
        drift(&turning, &CommutatorFree(CF4), &start, V::norm),
        drift(&turning, &Magnus4, &start, V::norm),
    ];
    assert!(found.iter().all(|x| *x < HELD), "{found:.1?}");

    let chain = SpinChain::new(4).expect("a chain").with_anisotropy(0.1).expect("a chain");
    let spins = chain.spins(|i| V::new((i as f64).sin(), (i as f64).cos(), 1.0)).expect("spins");
    for k in 0..2 {
        let found = drift(&chain, &Rkmk::new(RK4, Cay), &spins, |s| s[k].norm());
        assert!(found < HELD, "spin {k}: {found:.1e}");
    }
}

/// A step that is the same rotation each time errs the same way each time.
#[test]
fn the_same_rotation_at_every_step() {
    let start = V::new(0.6, 0.0, 0.8);
    for k in 0..12 {
        let found = drift(&spin(constant(k)), &Magnus4, &start, V::norm);
        assert!(found < HELD, "{k}: {found:.1e}");
    }
}

/// A state of n levels keeps its length under SO(2n), as scenes have it, and under U(n); so does each column.
#[test]
fn quantum_states_keep_their_length() {
    for n in [2, 3] {
        let states = Mat::from_fn(2 * n, 2, |i, j| ((3 * i + 5 * j + 1) as f64).sin());
        let lengths =
            |x: &Mat<f64>| [0, 1].map(|j| x.col(j).iter().map(|x| x * x).sum::<f64>().sqrt());
        let begin = lengths(&states);
        let away = |x: &Mat<f64>| {
            let now = lengths(x);
            1.0 + (now[0] / begin[0] - 1.0).abs().max((now[1] / begin[1] - 1.0).abs())
        };
        // Every step is the same rotation, or none is.
        for turning in [0.0, 1.0] {
            let h = move |t: f64, i: usize, j: usize| {
                let x = ((2 * i + 3 * j) as f64 + turning * t).cos();
                [9.0 * x, if i == j { 0.0 } else { 5.0 * (1.3 * x).sin() }]
            };
            let conjugate = |[re, im]: [f64; 2]| [re, -im];
            let so = schrodinger(n, h).expect("levels");
            let found = [
                drift(&so, &Magnus4, &states, away),
                drift(&so, &Rkmk::new(RK4, Exp), &states, away),
            ];
            assert!(found.iter().all(|x| *x < HELD), "SO({}): {found:.1?}", 2 * n);
            let u = Flow::of_time(
                Unitary::new(n).expect("a group"),
                Linear,
                move |t, v: &mut ComplexMatrix| {
                    *v = ComplexMatrix::from_fn(n, n, |i, j| {
                        let [re, im] = if i <= j { h(t, i, j) } else { conjugate(h(t, j, i)) };
                        c64::new(im, -re)
                    });
                },
            );
            let parts =
                ComplexMatrix::from_fn(n, 2, |i, j| c64::new(states[(i, j)], states[(n + i, j)]));
            let found =
                drift(&u, &Magnus4, &parts, |x| {
                    away(&Mat::from_fn(2 * n, 2, |i, j| {
                        if i < n { x.re[(i, j)] } else { x.im[(i - n, j)] }
                    }))
                });
            assert!(found < HELD, "U({n}): {found:.1e}");
        }
    }
}

#[test]
fn a_momentum_stays_on_its_orbit() {
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let m = V::new(0.48, 0.6, 0.64);
    for found in [
        drift(&body, &Rkmk::new(RK4, Exp), &m, V::norm),
        drift(&body, &Rkmk::new(RK4, Cay), &m, V::norm),
    ] {
        assert!(found < HELD, "{found:.1e}");
    }
    let body = RigidBodyState::new([1.0, 2.0, 3.0]).expect("a body");
    let state = body.state(m.into(), Matrix3::identity()).expect("a state");
    let found = drift(&body, &Rkmk::new(RK4, Exp), &state, |y| y.m.norm());
    assert!(found < HELD, "{found:.1e}");
}

/// |q| and ω·q, which is no length: the orbit of SE(3) has both.
#[test]
fn a_pendulum_stays_on_its_orbit() {
    let pendulum = SphericalPendulum::new(1.0).expect("a pendulum");
    let start = pendulum.state([0.6, 0.0, -0.8], [0.1, 0.9, 0.2]).expect("a state");
    let length = drift(&pendulum, &Rkmk::new(RK4, Exp), &start, |y| y.1.norm());
    let along = drift(&pendulum, &Rkmk::new(RK4, Exp), &start, |y| 1.0 + y.0.dot(&y.1));
    assert!(length < HELD && along < HELD, "{length:.1e} {along:.1e}");
}

/// A million steps are as a hundred thousand; the time of a run of a momentum over that of one without.
#[test]
#[ignore = "a million steps, with a timing; .ci/long runs it: cargo test --release --test long drift_vectors -- --ignored --nocapture"]
fn a_million_steps() {
    let start = V::new(0.6, 0.0, 0.8);
    for k in 0..12 {
        let of = spin(constant(k));
        let (found, _) = drift_over(1_000_000, &of, &Rkmk::new(RK4, Exp), &start, V::norm);
        let plain = Uncorrected(Rkmk::new(RK4, Exp));
        let (left, _) = drift_over(1_000_000, &of, &plain, &start, V::norm);
        println!("{k}: {:.1} eps, left alone {:.0} eps", found / EPS, left / EPS);
        assert!(found < HELD, "{k}: {found:.1e}");
    }
    let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).expect("a body");
    let m = V::new(0.48, 0.6, 0.64);
    let (found, _) = drift_over(1_000_000, &body, &Rkmk::new(RK4, Exp), &m, V::norm);
    let plain = Uncorrected(Rkmk::new(RK4, Exp));
    let (left, _) = drift_over(1_000_000, &body, &plain, &m, V::norm);
    println!("momentum: {:.1} eps, left alone {:.0} eps", found / EPS, left / EPS);
    assert!(found < HELD, "{found:.1e}");

    let rabi = schrodinger(2, |t, i, j| if i == j { [t.cos(), 0.0] } else { [0.3, 0.0] });
    let (rabi, psi) =
        (rabi.expect("levels"), amplitudes(&[[0.6, 0.0], [0.0, 0.8]]).expect("a state"));
    let levels = |held: bool| {
        let start = cpu_seconds();
        let (grid, mut y) =
            (TimeGrid::with_steps([0.0, 50_000.0], 1_000_000).expect("a grid"), psi.clone());
        let ran = match held {
            true => integrate(&rabi, &Magnus4, &grid, &SaveAt::Ends, &mut y, |_, _| {}),
            false => {
                let method = Uncorrected(Magnus4);
                integrate(&rabi, &method, &grid, &SaveAt::Ends, &mut y, |_, _| {})
            }
        };
        ran.expect("a run");
        cpu_seconds() - start
    };
    costs_little("two levels, magnus4", 5, levels);

    let time = |held: bool| {
        let start = cpu_seconds();
        let (grid, mut y) = (TimeGrid::with_steps([0.0, 50_000.0], 1_000_000).expect("a grid"), m);
        let method = Rkmk::new(RK4, Exp);
        let ran = match held {
            true => integrate(&body, &method, &grid, &SaveAt::Ends, &mut y, |_, _| {}),
            false => {
                integrate(&body, &Uncorrected(method), &grid, &SaveAt::Ends, &mut y, |_, _| {})
            }
        };
        ran.expect("a run");
        cpu_seconds() - start
    };
    costs_little("momentum", 11, time);
}

/// The least time of a run with the correction is at most 1.05 times that without, in turns.
fn costs_little(what: &str, rounds: usize, time: impl Fn(bool) -> f64) {
    let (mut with, mut without) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..rounds {
        with = with.min(time(true));
        without = without.min(time(false));
    }
    println!("{what}: time with/without {:.3}", with / without);
    assert!(with <= 1.05 * without, "{what}: {with} beside {without}");
}

/// What leaves M is shown as it is; what does not move is not moved; what is far off, huge or 0 is left alone.
#[test]
fn only_rounding_is_taken_back() {
    let start = V::new(0.6, 0.0, 0.8);
    let chain = SpinChain::new(2).expect("a chain").with_field([0.0, 0.0, 1.0]).expect("a chain");
    let up: Box<[V]> = [V::z(), V::z()].into();
    let grid = TimeGrid::with_steps([0.0, 50.0], 1000).expect("a grid");
    let mut y = up.clone();
    integrate(&chain, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut y, |_, _| {})
        .expect("a run");
    assert_eq!(y, up);
    let mut y = [start, V::z()].into();
    let stats =
        integrate(&chain, &Rk(RK4), &grid, &SaveAt::Ends, &mut y, |_, _| {}).expect("a run");
    assert!(stats.restored == 0 && (y[0].norm() - 1.0).abs() > 1e-9, "{stats:?} {y:?}");

    let so3 = So3::<f64>::new();
    for (from, x, residual) in [
        (start, 1.2 * start, Some(0.44)),
        (V::zeros(), start, Some(0.0)),
        (1e200 * start, start, Some(0.0)),
        (1e-200 * start, start, Some(0.0)),
    ] {
        let mut moved = x;
        let found = so3.correct_vector(&from, &mut moved);
        assert!(moved == x && (found.unwrap() - residual.unwrap()).abs() < 1e-15, "{found:?}");
    }
    let mut none = V::from_element(f64::NAN);
    assert!(so3.correct_vector(&start, &mut none).is_some_and(f64::is_nan));
}

/// xᵀMx on SO(3,1), of vectors of positive, negative and no square, where every step is the same matrix.
#[test]
fn vectors_keep_the_form_of_their_group() {
    let group = MatrixGroup::indefinite(3, 1).expect("SO(3,1)");
    let m = group.m().expect("a form");
    let square = |x: &Mat<f64>| (x.transpose() * &m * x)[(0, 0)];
    // A magnetic field that is stronger than the electric one, and orthogonal to it: the motion stays bounded.
    let field = faer::mat![
        [0.0, 1.1, 0.3, 0.3],
        [-1.1, 0.0, 0.7, 0.7],
        [-0.3, -0.7, 0.0, 0.0],
        [0.3, 0.7, 0.0, 0.0],
    ];
    let turn = Flow::of_time(group.clone(), Linear, |_: f64, v: &mut AlgebraMatrix| {
        v.copy_from(&field);
    });
    for x in [[0.3, 0.2, 0.1, 1.5], [2.0, 0.4, 1.0, 0.5], [0.6, 0.0, 0.8, 1.0]] {
        let start = Mat::from_fn(4, 1, |i, _| x[i]);
        // Relative to the largest |x|² so far: the orbit is an ellipse.
        let largest = Cell::new(0.0f64);
        let of = |x: &Mat<f64>| {
            largest.set(largest.get().max(x.squared_norm_l2()));
            1.0 + (square(x) - square(&start)) / largest.get()
        };
        let found = [
            drift(&turn, &Rkmk::new(RK4, Exp), &start, of),
            drift(&turn, &Rkmk::new(RK4, Cay), &start, of),
            drift(&turn, &CommutatorFree(CF4), &start, of),
        ];
        println!("{x:?}: {found:?}");
        assert!(found.iter().all(|x| *x < 3.0 * HELD), "{x:?}: {found:?}");
    }
}

/// The lengths and angles of several columns, and their products under SO(3,1), where every step is the same matrix.
#[test]
fn columns_keep_their_products() {
    let field = |last: f64| {
        faer::mat![
            [0.0, 1.1, 0.3, last * 0.3],
            [-1.1, 0.0, 0.7, last * 0.7],
            [-0.3, -0.7, 0.0, 0.0],
            [0.3, 0.7, 0.0, 0.0],
        ]
    };
    let start = faer::mat![[1.0, 0.3, 0.4], [0.2, 1.0, 0.1], [0.0, 0.5, 2.0], [0.3, 0.2, -0.6]];
    for (group, last) in [(MatrixGroup::so(4), -1.0), (MatrixGroup::indefinite(3, 1), 1.0)] {
        let (group, field) = (group.expect("a group"), field(last));
        let m = group.m().expect("a form");
        let products = |x: &Mat<f64>| x.transpose() * &m * x;
        let turn = Flow::of_time(group.clone(), Linear, |_: f64, v: &mut AlgebraMatrix| {
            v.copy_from(&field);
        });
        let largest = Cell::new(0.0f64);
        let of = |x: &Mat<f64>| {
            largest.set(largest.get().max(x.squared_norm_l2()));
            1.0 + (products(x) - products(&start)).norm_max() / largest.get()
        };
        let found = [
            drift(&turn, &Rkmk::new(RK4, Exp), &start, of),
            drift(&turn, &Rkmk::new(RK4, Cay), &start, of),
        ];
        println!("{}: {found:?}", group.name());
        assert!(found.iter().all(|x| *x < 3.0 * HELD), "{}: {found:?}", group.name());
    }
}

/// A vector goes back to the nearest one with its xᵀMx, whatever M is, and stays where rounding would move it farther.
#[test]
fn the_nearest_vector_with_the_same_form() {
    let mixed = faer::mat![[2.0, 0.5, 0.0], [-0.3, 1.5, 0.4], [0.2, 0.0, -1.0]];
    let group = MatrixGroup::gm(mixed.clone()).expect("a group");
    let square = |x: &Mat<f64>| (x.transpose() * &mixed * x)[(0, 0)];
    let start = Mat::from_fn(3, 1, |i, _| [0.6, -1.1, 0.7][i]);
    let change = Mat::from_fn(3, 1, |i, _| [1e-9, 3e-9, -2e-9][i]);
    let mut x = &start + &change;
    let gap = square(&x) - square(&start);
    let residual = group.correct_vector(&start, &mut x).expect("a form");
    let along = (&mixed + mixed.transpose()) * &start * faer::Scale(0.5);
    let nearest = gap.abs() / (2.0 * along.norm_l2());
    assert!((square(&x) - square(&start)).abs() < 8.0 * EPS && gap.abs() > 1e-9);
    assert!((residual - gap.abs() / (start.norm_l2() * along.norm_l2())).abs() < 1e-15);
    let moved = (&x - &start - &change).norm_l2();
    assert!((moved - nearest).abs() < 1e-6 * nearest, "{moved:e}, expected {nearest:e}");

    // |Sx| is 1e-4 of ‖S‖|x|: the rounding of xᵀMx alone moves x by 1e4 ε.
    let flat = MatrixGroup::gm(faer::mat![[1.0, 1e-4 - 1.0], [1e-4 - 1.0, 1.0]]).expect("a group");
    let from = Mat::from_fn(2, 1, |_, _| 1.0);
    let mut x = &from * faer::Scale(1.0 + 1e-9);
    let before = x.clone();
    assert!(flat.correct_vector(&from, &mut x).is_some_and(|residual| residual > 1e-9));
    assert_eq!(x, before);
    for (form, is_kept) in [(faer::mat![[0.0, 1.0], [-1.0, 0.0]], true), (mixed, false)] {
        let group = MatrixGroup::gm(form).expect("a group");
        let start = Mat::from_fn(group.n(), 1, |i, _| 1.0 + i as f64);
        let off = &start * faer::Scale(1.0 + 1e-9);
        let mut x = off.clone();
        group.correct_vector(&start, &mut x);
        assert_eq!(x == off, is_kept);
    }
    let mut none = Mat::from_fn(3, 1, |_, _| f64::NAN);
    assert!(group.correct_vector(&start, &mut none).is_some_and(f64::is_nan));
}

/// Each part goes back to its own orbit, and the largest residual is what is reported.
#[test]
fn parts_go_back_each_to_its_orbit() {
    type Parts = Product<Power<So3>, Product<So3, Translations<f64>>>;
    let group: Parts =
        Product(Power::new(So3::new(), 2).unwrap(), Product(So3::new(), Translations::new(0.0, 1)));
    let action = Pair(Linear, LeftTranslation);
    let (x, z) = (V::new(0.6, 0.0, 0.8), V::new(0.0, 3.0, 4.0));
    let from: (Box<[V]>, (Matrix3<f64>, f64)) = ([x, z].into(), (Matrix3::identity(), 7.0));
    let mut p = from.clone();
    p.0[1] *= 1.0 + 1e-9;
    p.1.0[(0, 0)] += 1e-8;
    p.1.1 = 8.0;
    let mut work = action.work(&group);
    let residual = action.restore_to(&group, &from, &mut p, &mut work).unwrap();
    assert!((1e-8..4e-8).contains(&residual), "{residual:e}");
    assert!(p.0[0] == x && (p.0[1] - z).norm() < 8.0 * EPS && p.1.1 == 8.0);
    assert!(so3_defect(&p.1.0) < 16.0 * EPS);

    // The orbit of se(3)* through (μ, π): |π| and μ·π.
    let from = (V::new(1.0, 2.0, 3.0), z);
    let mut p = (from.0 + 1e-9 * z, z * (1.0 - 1e-9));
    let se3 = lieflow::groups::Se3::<f64>::new();
    assert!(Coadjoint.restore_to(&se3, &from, &mut p, &mut ()).unwrap() > 1e-9);
    let along = from.0.dot(&from.1);
    assert!((p.1.norm() - 5.0).abs() < 8.0 * EPS && (p.0.dot(&p.1) - along).abs() < 64.0 * EPS);
}

fn so3_defect(g: &Matrix3<f64>) -> f64 {
    So3::new().defect(g)
}
