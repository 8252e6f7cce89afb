//! An f that is not in 𝔤 ends a run, and rounding of f does not.

use crate::support::boxed::{boxed_flow, boxed_of_time};
use lieflow::actions::{Conjugation, Each, LeftTranslation, Linear, Pair};
use lieflow::faer::{Mat, c64};
use lieflow::groups::{
    AlgebraMatrix, ComplexMatrix, MatrixGroup, Power, Product, Sample, So3, Unitary,
};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::tableau::{DOPRI5, RK4};
use lieflow::methods::{Embedded, EnergyCasimir, Rk, Rkmk};
use lieflow::problems::{Euler, Flow, Kinetic, Lyapunov, PointOf, Problem};
use lieflow::{Action, Error, Event, LieAlgebra, LieGroup, RunError, Solve, StepError};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// From this time on f leaves 𝔤.
const LEAVES: f64 = 1.0;

/// How far f(t) is out: nothing before [`LEAVES`].
fn out(t: f64) -> f64 {
    0.3 * (t - LEAVES).max(0.0)
}

/// The error of runs to t = 3 by fixed and by adaptive steps.
fn runs<P: Problem<Group: LieAlgebra<Scalar = f64>>, M: Embedded<P>>(
    problem: &P,
    method: &M,
    y0: &PointOf<P>,
) -> [Result<f64, RunError>; 2] {
    let solve = || Solve::new(problem, method, [0.0, 3.0]);
    // f is looked at each so many steps: both runs have enough of them.
    [solve().dt(0.01), solve().tolerances(1e-11, 1e-11)]
        .map(|solve| solve.run(y0.clone()).map(|run| run.t).map_err(|failed| failed.error))
}

/// f that leaves 𝔤 ends the runs soon after, with an error of f; f that stays does not.
fn is_seen<P: Problem<Group: LieAlgebra<Scalar = f64>>>(
    name: &str,
    leaving: &P,
    staying: &P,
    y0: &PointOf<P>,
) where
    Exp: lieflow::maps::CoordinateMap<P::Group>,
{
    let method = Rkmk::new(DOPRI5, Exp);
    for run in runs(leaving, &method, y0) {
        match run {
            Err(RunError::LeftManifold {
                t,
                source: Error::NotInAlgebra { arg: "f", .. } | Error::Trace { arg: "f", .. },
            }) => assert!(t > LEAVES && t < 3.0, "{name}: seen at t = {t}"),
            run => panic!("{name}: {run:?}"),
        }
    }
    for run in runs(staying, &method, y0) {
        assert_eq!(run.expect(name), 3.0);
    }
}

fn groups() -> Vec<MatrixGroup> {
    let form =
        Mat::from_fn(3, 3, |i, j| if i == j { 1.0 + i as f64 } else { 0.3 * (i * j) as f64 });
    // Neither symmetric nor skew.
    let neither = lieflow::faer::mat![[2.0, 0.5, 0.0], [-0.3, 1.5, 0.4], [0.2, 0.0, 1.0]];
    [
        MatrixGroup::so(4),
        MatrixGroup::sp(4),
        MatrixGroup::sl(3),
        MatrixGroup::u(2),
        MatrixGroup::su(2),
        MatrixGroup::indefinite(2, 1),
        MatrixGroup::gm(form),
        MatrixGroup::gm(neither),
    ]
    .map(|group| group.expect("a group"))
    .into()
}

/// x, an element of 𝔤, and all of it that is not.
fn with_out(group: &MatrixGroup, x: &AlgebraMatrix, out: f64) -> AlgebraMatrix {
    let n = group.n();
    let mut v = group.zero();
    v.copy_from(Mat::from_fn(n, n, |i, j| x[(i, j)] + if i == 0 && j == 0 { out } else { 0.0 }));
    v
}

/// A state that the caller sets is on M, and has its size.
#[test]
fn a_state_that_is_set_is_on_the_group() {
    for group in groups() {
        let still = |_: f64, v: &mut AlgebraMatrix| v.fill(0.0);
        let flow = boxed_of_time(group.clone(), LeftTranslation, still);
        let method = Rkmk::new(DOPRI5, Exp);
        let start = group.identity();
        let mut run = Solve::new(&flow, &method, [0.0, 1.0]).dt(0.1).integrator(start).unwrap();
        run.step().unwrap();
        let n = group.n();
        let mut twice = group.identity();
        for i in 0..n {
            twice[(i, i)] = 2.0;
        }
        let smaller = MatrixGroup::so(n - 1).map(|group| group.identity());
        for wrong in core::iter::once(twice).chain(smaller) {
            assert!(run.set_state(&wrong).is_err(), "{}", group.name());
        }
        assert_eq!(run.y()[(0, 0)], 1.0);
    }
}

#[test]
fn an_f_that_leaves_the_algebra_ends_the_run() {
    let mut rng = Pcg64::seed_from_u64(7);
    for group in groups() {
        let x = group.sample_algebra(&mut rng, 0.4);
        let flow = |size: f64| {
            let (of, x) = (group.clone(), x.clone());
            boxed_flow(group.clone(), LeftTranslation, move |t, _: &_, v: &mut AlgebraMatrix| {
                v.copy_from(&*with_out(&of, &x, size * out(t)));
            })
        };
        is_seen(&group.name(), &flow(1.0), &flow(0.0), &group.identity());
    }
    // Skew, but without the blocks of U(2).
    let group = MatrixGroup::u(2).expect("a group");
    let x = group.sample_algebra(&mut rng, 0.4);
    let flow = |size: f64| {
        let x = x.clone();
        boxed_flow(group.clone(), LeftTranslation, move |t, _: &_, v: &mut AlgebraMatrix| {
            v.copy_from(&*x);
            v[(0, 1)] += size * out(t);
            v[(1, 0)] -= size * out(t);
        })
    };
    is_seen("blocks", &flow(1.0), &flow(0.0), &group.identity());
    let unitary = Unitary::new(3).expect("a group");
    let flow = |size: f64| {
        boxed_flow(unitary, LeftTranslation, move |t: f64, _: &_, v: &mut ComplexMatrix| {
            let level = |i: usize, j: usize| c64::new(0.0, if i == j { t } else { 0.5 });
            *v = ComplexMatrix::from_fn(3, 3, |i, j| level(i, j) + size * out(t));
        })
    };
    is_seen("U(3)", &flow(1.0), &flow(0.0), &unitary.identity());
}

/// Parts, copies, and other actions than translation.
#[test]
fn an_f_that_leaves_the_algebra_in_a_part_ends_the_run() {
    let mut rng = Pcg64::seed_from_u64(8);
    let so = MatrixGroup::so(3).expect("a group");
    let x = so.sample_algebra(&mut rng, 1.0);
    let bad = |size: f64| {
        let (so, x) = (so.clone(), x.clone());
        move |t: f64, v: &mut AlgebraMatrix| v.copy_from(&*with_out(&so, &x, size * out(t)))
    };
    let product = Product(So3::new(), so.clone());
    let action = || Pair(LeftTranslation, LeftTranslation);
    let flow = |size: f64| {
        let bad = bad(size);
        boxed_flow(product.clone(), action(), move |t, _: &_, v: &mut (_, AlgebraMatrix)| {
            v.0 = nalgebra::Vector3::new(1.0, t, 0.0);
            bad(t, &mut v.1);
        })
    };
    is_seen("a product", &flow(1.0), &flow(0.0), &(Matrix3::identity(), so.identity()));

    let power = Power::new(so.clone(), 3).expect("a group");
    let flow = |size: f64| {
        let bad = bad(size);
        let f = move |t, _: &_, v: &mut Box<[AlgebraMatrix]>| bad(t, &mut v[2]);
        boxed_flow(power.clone(), Each(LeftTranslation), f)
    };
    is_seen("a power", &flow(1.0), &flow(0.0), &power.identity());

    let flow = |size: f64| {
        let bad = bad(size);
        boxed_flow(so.clone(), Linear, move |t, _: &_, v: &mut AlgebraMatrix| bad(t, v))
    };
    is_seen("columns", &flow(1.0), &flow(0.0), &Mat::from_fn(3, 2, |i, j| (1 + i + j) as f64));
    let flow = |size: f64| {
        let bad = bad(size);
        boxed_flow(so.clone(), Conjugation, move |t, _: &_, v: &mut AlgebraMatrix| bad(t, v))
    };
    is_seen("by conjugation", &flow(1.0), &flow(0.0), &Mat::from_fn(3, 3, |i, j| (i + j) as f64));
}

/// ẏ in place of f: at y = 𝟙 both are the same. Methods that leave M see it at the end.
#[test]
fn a_derivative_in_place_of_f_is_seen() {
    let group = MatrixGroup::so(4).expect("a group");
    let k = group.sample_algebra(&mut Pcg64::seed_from_u64(9), 1.0);
    let flow = boxed_flow(
        group.clone(),
        LeftTranslation,
        move |_, y: &lieflow::groups::GroupMatrix, v: &mut AlgebraMatrix| {
            v.copy_from(k.as_ref() * y.as_ref());
        },
    );
    let y0 = group.identity();
    for run in runs(&flow, &Rkmk::new(DOPRI5, Exp), &y0) {
        assert!(matches!(run, Err(RunError::LeftManifold { t, .. }) if t < 3.0), "{run:?}");
    }
    for run in runs(&flow, &Rk(DOPRI5), &y0) {
        assert!(matches!(run, Err(RunError::LeftManifold { t: 3.0, .. })), "{run:?}");
    }
}

/// f is out for a moment, between two looks at it: then the state says so.
#[test]
fn a_state_that_has_left_m_is_seen() {
    let group = MatrixGroup::so(4).expect("a group");
    let x = group.sample_algebra(&mut Pcg64::seed_from_u64(10), 1.0);
    let of = group.clone();
    let flow =
        boxed_flow(group.clone(), LeftTranslation, move |t, _: &_, v: &mut AlgebraMatrix| {
            let size = if t > 1.0 && t < 1.0 + 5e-3 { 1.0 } else { 0.0 };
            v.copy_from(&*with_out(&of, &x, size));
        });
    let run = Solve::new(&flow, &Rkmk::new(RK4, Exp), [0.0, 3.0]).dt(1e-3).run(group.identity());
    match run.map_err(|failed| failed.error) {
        Err(RunError::LeftManifold { t, source: Error::NotOnGroup { arg: "y", .. } }) => {
            assert!(t > 1.0 && t < 1.11, "{t}");
        }
        run => panic!("{run:?}"),
    }
    // A classical method has an error of its own there, so its run ends as usual, and tells how far its end is from G.
    let run =
        Solve::new(&flow, &Rk(RK4), [0.0, 3.0]).dt(1e-3).run(group.identity()).expect("a run");
    let defect = group.defect(&run.y);
    assert!(defect > 1e-3, "{defect:e}");
    assert!(0.2 * defect < run.stats.residual && run.stats.residual < 5.0 * defect, "{run:?}");
}

/// Rounding of f is no error: near rest, where all of f is rounding, and in the body, where y is large.
#[test]
fn rounding_of_f_ends_no_run() {
    // Brockett's flow: f = [L, N] goes to 0, and its rounding is not skew.
    let group = MatrixGroup::so(4).expect("a group");
    let f = |_, l: &Mat<f64>, v: &mut AlgebraMatrix| {
        let n = Mat::from_fn(4, 4, |i, j| if i == j { 1.0 + i as f64 } else { 0.0 });
        let left = Mat::from_fn(4, 4, |i, j| (0..4).map(|k| l[(i, k)] * n[(k, j)]).sum::<f64>());
        let term = |i: usize, j: usize, k: usize| n[(i, k)] * l[(k, j)];
        let right = Mat::from_fn(4, 4, |i, j| (0..4).rev().map(|k| term(i, j, k)).sum::<f64>());
        v.copy_from(left - right);
    };
    let start = Mat::from_fn(4, 4, |i, j| 1.0 / (1 + i + j) as f64);
    let flow = boxed_flow(group, Conjugation, f);
    let method = Rkmk::new(DOPRI5, Exp);
    for solve in [0, 1].map(|i| {
        let solve = Solve::new(&flow, &method, [0.0, 200.0]);
        if i == 0 { solve.dt(0.05) } else { solve.tolerances(1e-10, 1e-12) }
    }) {
        solve.run(start.clone()).expect("a run to rest");
    }
    // In the body Ad_y f has the rounding of ‖y‖².
    let group = MatrixGroup::sp(2).expect("a group");
    let flow = Flow::in_body(group.clone(), |t: f64, _: &_, v: &mut AlgebraMatrix| {
        v.copy_from(Mat::from_fn(2, 2, |i, j| match (i, j) {
            (0, 0) => 1.0,
            (1, 1) => -1.0,
            _ => 0.3 * t.cos(),
        }));
    });
    let run = Solve::new(&flow, &method, [0.0, 8.0]).dt(0.01);
    let run = run.run(group.identity()).expect("a run that grows");
    assert!(run.y[(0, 0)].abs() > 1e3);
}

/// The distance is 0 in 𝔤, and that of what is added to it; storage of 𝔤 alone has none.
#[test]
fn the_distance_from_the_algebra() {
    let mut rng = Pcg64::seed_from_u64(11);
    for group in groups() {
        let x = group.sample_algebra(&mut rng, 1.0);
        let inside = group.off_algebra(&x);
        assert!(inside < 1e-14, "{}: {inside:e}", group.name());
        let [near, far] = [1e-6, 1e-3].map(|out| group.off_algebra(&with_out(&group, &x, out)));
        assert!((far / near - 1e3).abs() < 1e-4, "{}: {near:e} {far:e}", group.name());
        assert!(near > 1e-7 && near < 1e-5, "{}: {near:e}", group.name());
    }
    let so = MatrixGroup::so(3).expect("a group");
    let x = so.sample_algebra(&mut rng, 1.0);
    let far = with_out(&so, &x, 1.0);
    // ‖u + uᵀ‖/‖𝟙‖ with one entry of 2.
    let expected = 2.0 / 3f64.sqrt();
    let found = so.off_algebra(&far);
    assert!((found - expected).abs() < 1e-15, "{found}");
    let huge = with_out(&so, &so.zero(), 1e200);
    assert!((so.off_algebra(&huge) / 1e200 - expected).abs() < 1e-15);
    let free = MatrixGroup::gl(3).expect("a group");
    assert!(!free.holds_more() && free.off_algebra(&far) == 0.0);
    assert!(!So3::<f64>::new().holds_more() && so.holds_more());
    let product = Product(So3::<f64>::new(), so.clone());
    assert!(product.holds_more());
    assert_eq!(product.off_algebra(&(nalgebra::Vector3::x(), far.clone())), found);
    let power = Power::new(so.clone(), 2).expect("a group");
    assert!(power.holds_more());
    assert_eq!(power.off_algebra(&vec![so.zero(), far].into()), found);
}

/// Where a solution grows on a non-compact group, the rounding of a correction is larger than the error of the run.
#[test]
fn corrections_do_no_harm_where_a_solution_grows() {
    let field = |n: usize| {
        move |t: f64, _: &_, v: &mut AlgebraMatrix| {
            let boost = 1.0 + 0.3 * t.cos();
            match n {
                2 => (v[(0, 1)], v[(1, 0)]) = (1.0, 1.23 + 8.7 * (2.0 * t).cos()),
                _ => {
                    (v[(0, 3)], v[(3, 0)]) = (boost, boost);
                    (v[(0, 1)], v[(1, 0)]) = (0.4, -0.4);
                }
            }
        }
    };
    let groups = [(MatrixGroup::sp(2), 11.0), (MatrixGroup::indefinite(3, 1), 14.0)];
    for (group, end) in groups {
        let group = group.expect("a group");
        let (n, free) = (group.n(), MatrixGroup::gl(group.n()).expect("a group"));
        let [on_group, on_gl] = [group, free].map(|group| {
            let y0 = group.identity();
            let flow = boxed_flow(group, LeftTranslation, field(n));
            let method = Rkmk::new(DOPRI5, Exp);
            Solve::new(&flow, &method, [0.0, end]).steps(20_000).run(y0).expect("a run").y
        });
        let (size, apart) = (on_gl.norm_l2(), (&*on_group - &*on_gl).norm_l2());
        assert!(size > 1e4 && apart < 1e-10 * size, "{n}: {:e} of {size:e}", apart / size);
    }
}

/// f stores a value of another size in the middle of a run: its numbers are not used.
#[test]
fn a_value_of_another_size_ends_a_run() {
    let ends =
        |run: Result<(), RunError>| assert!(matches!(run, Err(RunError::Step(_))), "{run:?}");
    let copies = Power::new(So3::new(), 2).expect("two");
    let flow = boxed_of_time(copies, Linear, |t: f64, v: &mut Box<[Vector3<f64>]>| {
        *v = vec![Vector3::z(); if t < 0.5 { 2 } else { 1 }].into();
    });
    let method = Rkmk::new(RK4, Exp);
    let y: Box<[Vector3<f64>]> = vec![Vector3::x(); 2].into();
    let run = Solve::new(&flow, &method, [0.0, 1.0]).steps(10).run(y);
    ends(run.map(drop).map_err(|failed| failed.error));

    let u3 = Unitary::new(3).expect("a group");
    let flow = boxed_of_time(u3, LeftTranslation, |t: f64, v: &mut ComplexMatrix| {
        let n = if t < 0.5 { 3 } else { 2 };
        *v = ComplexMatrix::from_fn(n, n, |i, j| c64::new(0.0, if i == j { 1.0 } else { 0.0 }));
    });
    let run = Solve::new(&flow, &method, [0.0, 1.0]).steps(10).run(u3.identity());
    ends(run.map(drop).map_err(|failed| failed.error));
}

/// A gradient of another size than the algebra, and derivatives of another size: no number of them is used.
#[test]
fn gradients_of_another_size_end_a_run() {
    for n in [3, 4, 5] {
        let gradient = move |m: &Mat<f64>, xi: &mut AlgebraMatrix| {
            *xi = AlgebraMatrix::new_unchecked(Mat::from_fn(n, n, |i, j| match (i, j) {
                (0, 1) => m[(0, 1)],
                (1, 0) => -m[(0, 1)],
                _ => 0.0,
            }));
        };
        let euler = Euler::new(MatrixGroup::so(4).expect("SO(4)"), Kinetic(gradient));
        let start = Mat::from_fn(4, 4, |i, j| i as f64 - j as f64);
        macro_rules! check {
            ($($method:expr),*) => {$({
                let method = $method;
                let run = Solve::new(&euler, &method, [0.0, 0.1]).dt(0.05).run(start.clone());
                assert_eq!(run.is_ok(), n == 4, "{n}");
            })*};
        }
        check![Rkmk::new(RK4, Exp), Rkmk::new(DOPRI5, Exp), EnergyCasimir::new(Cay)];
    }
    for wrong in [1, 3] {
        let field = move |t: f64, _: &Mat<f64>, dx: &mut Mat<f64>, df: &mut Mat<f64>| {
            dx.fill(1.0);
            df.fill(0.0);
            if t > 0.5 {
                *dx = Mat::from_fn(wrong, 1, |_, _| 1.0);
                *df = Mat::zeros(wrong, wrong);
            }
        };
        let growth = Lyapunov::new(2, field).expect("two numbers");
        let start = growth.state(&[1.0, 1.0]).expect("a start");
        let method = Rkmk::new(RK4, Exp);
        let run = Solve::new(&growth, &method, [0.0, 1.0]).dt(0.1).run(start);
        run.expect_err("numbers of another size");
    }
}

/// An action of a user that checks nothing, on points of the library.
#[derive(Clone, Copy)]
struct Unchecked;

impl Action<So3<f64>> for Unchecked {
    type Point = Vector3<f64>;
    type Work = ();

    fn work(&self, _: &So3<f64>) {}
    fn act(
        &self,
        _: &So3<f64>,
        g: &Matrix3<f64>,
        y: &Vector3<f64>,
        z: &mut Vector3<f64>,
        (): &mut (),
    ) {
        *z = g * y;
    }
    fn generate(
        &self,
        _: &So3<f64>,
        v: &Vector3<f64>,
        y: &Vector3<f64>,
        w: &mut Vector3<f64>,
        (): &mut (),
    ) {
        *w = v.cross(y);
    }
}

#[test]
fn own_actions_end_at_numbers_that_are_not_finite() {
    let turn = boxed_flow(
        So3::<f64>::new(),
        Unchecked,
        |t: f64, _: &Vector3<f64>, v: &mut Vector3<f64>| {
            *v = Vector3::new(0.0, 0.0, 1.0 + t);
        },
    );
    let method = Rkmk::new(RK4, Exp);
    let solve = || Solve::new(&turn, &method, [0.0, 1.0]).dt(0.1);
    solve().run(Vector3::x()).expect("a run");
    solve().run(Vector3::new(f64::NAN, 0.0, 0.0)).expect_err("no start");
    let event = Event::new("lost", |t, _| t - 0.5).change(|_, y: &mut Vector3<f64>| y.x = f64::NAN);
    let told = solve().event(event).run(Vector3::x()).expect_err("no state").to_string();
    assert!(told.contains("lost"), "{told}");
}

/// The vectors by addition, with nothing but what the traits ask for.
struct Plain;

impl LieAlgebra for Plain {
    type Scalar = f64;
    type Alg = Vector3<f64>;
    fn name(&self) -> String {
        "plain".into()
    }
    fn dim(&self) -> usize {
        3
    }
    fn zero(&self) -> Vector3<f64> {
        Vector3::zeros()
    }
    fn set_zero(&self, u: &mut Vector3<f64>) {
        u.fill(0.0);
    }
    fn axpy(&self, a: f64, x: &Vector3<f64>, y: &mut Vector3<f64>) {
        *y += a * x;
    }
    fn bracket(&self, _: &Vector3<f64>, _: &Vector3<f64>, out: &mut Vector3<f64>) {
        out.fill(0.0);
    }
    fn norm(&self, u: &Vector3<f64>) -> f64 {
        u.norm()
    }
    fn is_finite(&self, u: &Vector3<f64>) -> bool {
        u.iter().all(|x| x.is_finite())
    }
}

impl LieGroup for Plain {
    type Elem = Vector3<f64>;
    type Vector = Vector3<f64>;
    fn identity(&self) -> Vector3<f64> {
        Vector3::zeros()
    }
    fn compose(&self, a: &Vector3<f64>, b: &Vector3<f64>, out: &mut Vector3<f64>) {
        *out = a + b;
    }
    fn apply(&self, g: &Vector3<f64>, x: &Vector3<f64>, y: &mut Vector3<f64>) {
        *y = g + x;
    }
    fn tangent(&self, v: &Vector3<f64>, _: &Vector3<f64>, out: &mut Vector3<f64>) {
        *out = *v;
    }
    fn apply_algebra(&self, v: &Vector3<f64>, _: &Vector3<f64>, y: &mut Vector3<f64>) {
        *y = *v;
    }
    fn distance(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
        (a - b).norm()
    }
    fn defect(&self, _: &Vector3<f64>) -> f64 {
        0.0
    }
}

/// exp on it.
struct Same;

impl lieflow::maps::CoordinateMap<Plain> for Same {
    type At = ();
    fn name(&self) -> &'static str {
        "same"
    }
    fn at(&self, _: &Plain) -> Result<(), Error> {
        Ok(())
    }
    fn psi(
        &self,
        _: &Plain,
        u: &Vector3<f64>,
        (): &mut (),
        g: &mut Vector3<f64>,
    ) -> Result<(), StepError> {
        *g = *u;
        Ok(())
    }
    fn dpsi_inv(
        &self,
        _: &Plain,
        _: &Vector3<f64>,
        (): &mut (),
        _: &mut Vector3<f64>,
    ) -> Result<(), StepError> {
        Ok(())
    }
}

#[test]
fn own_groups_end_at_numbers_that_are_not_finite() {
    let method = Rkmk::new(RK4, Same);
    let check = |action: &str, ends: &dyn Fn(f64, f64, bool) -> Result<f64, String>| {
        let right = ends(0.0, 1.0, false).expect("a run");
        assert!((right - 10.0).abs() < 1e-12, "{action}: {right}");
        for (start, rate, changes) in [
            (f64::NAN, 1.0, false),
            (f64::INFINITY, 1.0, false),
            (0.0, 1e308, false),
            (0.0, 1.0, true),
        ] {
            let end = ends(start, rate, changes);
            assert!(end.is_err(), "{action} from {start} with {rate}: {end:?}");
        }
    };
    macro_rules! ends {
        ($action:expr) => {
            &|start, rate, changes| {
                let field = move |_: f64, _: &Vector3<f64>, v: &mut Vector3<f64>| {
                    *v = Vector3::new(1.0, 0.0, rate);
                };
                let flow = boxed_flow(Plain, $action, field);
                let mut solve = Solve::new(&flow, &method, [0.0, 10.0]).dt(0.5);
                if changes {
                    let lost = Event::new("lost", |t, _: &Vector3<f64>| t - 5.0);
                    solve = solve.event(lost.change(|_, y: &mut Vector3<f64>| y.x = f64::NAN));
                }
                let run = solve.run(Vector3::new(0.0, 0.0, start));
                run.map(|run| run.y.x).map_err(|failed| failed.to_string())
            }
        };
    }
    check("translation", ends!(LeftTranslation));
    check("linear", ends!(Linear));
}
