//! Lie series on linear equations whose A(t) has known derivatives: orders at the ends of steps and within them,
//! events, methods by name, derivatives that are not known.

use crate::support::systems::assert_order;
use lieflow::actions::LeftTranslation;
use lieflow::catalog::{MethodSpec, MethodsByName, Needs};
use lieflow::groups::{LieGroup, MatrixGroup, Sample, Se3};
use lieflow::methods::magnus::Magnus6;
use lieflow::methods::{AnyMethod, Embedded, LieSeries, SeriesGroup};
use lieflow::prelude::*;
use lieflow::problems::{
    DynFlow, PointOf, Problem, TaylorField, TaylorFlow, TimeAlone, WithSeries,
};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

type V = Vector3<f64>;

fn series(order: usize) -> LieSeries {
    LieSeries::new(order).unwrap()
}

/// The k-th derivative of (1 + t²/4) cos(rate·t + phase) by t.
fn wave(t: f64, k: usize, rate: f64, phase: f64) -> f64 {
    let n = k as f64;
    let cos = |k: i32| {
        let turned = rate * t + phase + f64::from(k) * core::f64::consts::FRAC_PI_2;
        rate.powi(k) * turned.cos()
    };
    let k = k as i32;
    let [first, second] = [0.5 * n * t, 0.25 * n * (n - 1.0)];
    (1.0 + 0.25 * t * t) * cos(k) + first * cos(k - 1) + second * cos(k - 2)
}

/// ġ = A(t)g, where A(t) = Σ a_j(t) e_j with waves a_j and e_j that do not commute.
fn waves<G>(group: G) -> TaylorFlow<G, LeftTranslation, impl Fn(f64, usize, &mut G::Alg)>
where
    G: LieGroup<Scalar = f64> + Sample + Clone,
{
    let mut rng = Pcg64::seed_from_u64(7);
    let e = [0.4, 0.7, 1.0].map(|rate| {
        let e = group.sample_algebra(&mut rng, 1.0);
        (rate, 1.2 / group.norm(&e), e)
    });
    let inner = group.clone();
    Flow::of_derivatives(group, LeftTranslation, move |t, k, v| {
        for (rate, size, e) in &e {
            inner.axpy(size * wave(t, k, *rate, 4.0 * rate), e, v);
        }
    })
}

/// From another time than 0. The time between is the middle of a step, because the numbers of steps are odd.
const SPAN: [f64; 2] = [-0.7, 2.3];
const WITHIN: f64 = 0.8;

/// The points at [`WITHIN`] and at the end by n steps of one size.
fn points<P: Problem, M: Embedded<P>>(
    problem: &P,
    method: &M,
    start: &PointOf<P>,
    n: u64,
) -> [PointOf<P>; 2]
where
    P::Group: LieGroup<Scalar = f64>,
    PointOf<P>: lieflow::methods::Metric<Scalar = f64>,
{
    let solve = Solve::new(problem, method, SPAN).steps(n).times([WITHIN, SPAN[1]]);
    solve.run(start.clone()).unwrap().points.try_into().ok().unwrap()
}

/// Numbers of steps fixed in advance.
const ORDERS: [(usize, [u64; 4]); 3] =
    [(4, [137, 205, 307, 461]), (5, [61, 91, 137, 205]), (6, [51, 71, 99, 137])];

fn has_orders<G>(group: G)
where
    G: SeriesGroup + Sample + LieGroup<Scalar = f64> + Clone,
    Exp: lieflow::maps::CoordinateMap<G>,
{
    let (name, problem, start) = (group.name(), waves(group.clone()), group.identity());
    // By A(t) alone.
    let fine = Rkmk::new(DOP853, Exp);
    let solve = Solve::new(&problem, &fine, SPAN).tolerances(1e-14, 1e-14);
    let solve = solve.times([WITHIN, SPAN[1]]).times_by_steps();
    let reference = solve.run(start.clone()).unwrap().points;
    for (order, grid) in ORDERS {
        let all = grid.map(|n| points(&problem, &series(order), &start, n));
        for (row, place) in ["within", "at the end"].iter().enumerate() {
            let errors: Vec<f64> =
                all.iter().map(|y| group.distance(&y[row], &reference[row])).collect();
            assert_order(&format!("{name} taylor{order} {place}"), order as f64, &grid, &errors);
        }
    }
}

#[test]
fn orders_of_linear_equations() {
    has_orders(So3::new());
    has_orders(Se3::new());
    has_orders(MatrixGroup::so(4).unwrap());
    has_orders(MatrixGroup::gl(3).unwrap());
}

/// ẋ = ω(t) × x with ω = (cos t, sin t, 2), from e₃. In the frame of the field x turns about (1, 0, 1) at the rate √2.
fn spin() -> TaylorFlow<So3, Linear, impl Fn(f64, usize, &mut V) + Clone> {
    Flow::of_derivatives(So3::new(), Linear, |t: f64, k: usize, v: &mut V| {
        let (sin, cos) = (t + k as f64 * core::f64::consts::FRAC_PI_2).sin_cos();
        *v = V::new(cos, sin, if k == 0 { 2.0 } else { 0.0 });
    })
}

/// x₃(t).
fn height(t: f64) -> f64 {
    0.5 + 0.5 * (2f64.sqrt() * t).cos()
}

/// By name on the closure itself and behind a pointer: the Lie series and the Magnus methods, with the same bits as the
/// types. A linear equation without derivatives has the latter alone.
#[test]
fn by_name() {
    type Spins = DynFlow<So3, Linear, WithSeries<TimeAlone>>;
    let (typed, known) = (spin(), Spins::linear_with_series(spin(), Linear));
    let field = spin();
    let alone = Flow::of_time(So3::new(), Linear, move |t, v| field.f(t, &V::z(), v, &mut ()));
    let unknown = Spins::linear(alone.clone(), Linear);
    assert!(known.is_linear() && known.has_series() && unknown.is_linear());
    let offers = [Needs::Field, Needs::Norm, Needs::LinearType, Needs::Series];
    assert_eq!((typed.offers(), known.offers()), (offers.to_vec(), offers.to_vec()));
    assert_eq!((alone.offers(), unknown.offers()), (offers[..3].to_vec(), offers[..3].to_vec()));

    let spec = |name| MethodSpec::new(name, None);
    fn end<P: Problem<Group = So3, Action = Linear>>(p: &P, method: &impl Embedded<P>) -> V {
        Solve::new(p, method, [0.0, 10.0]).steps(200).run(V::z()).unwrap().y
    }
    let [taylor, magnus] = ["taylor16", "magnus6"].map(|name| {
        let by_name = end(&known, &known.method(&spec(name)).unwrap());
        assert_eq!(by_name, end(&typed, &typed.method(&spec(name)).unwrap()), "{name}");
        by_name
    });
    assert_eq!(taylor, end(&typed, &series(16)));
    // The error of magnus6 is some h⁶.
    assert!((taylor - magnus).norm() < 10.0 * 0.05f64.powi(6), "{:e}", (taylor - magnus).norm());
    assert!((taylor.z - height(10.0)).abs() < 1e-13, "{:e}", taylor.z - height(10.0));
    for refused in [alone.method(&spec("taylor16")).err(), unknown.method(&spec("taylor16")).err()]
    {
        let message = refused.unwrap().to_string();
        assert!(message.contains("a field with Taylor coefficients"), "{message}");
    }
    // Without derivatives a step by the type fails, and says so.
    let failed = Solve::new(&unknown, &series(8), [0.0, 1.0]).dt(0.1).run(V::z()).unwrap_err();
    assert!(failed.to_string().contains("stage 1"), "{failed}");
}

/// Steps by error: the events are at the exact times, and where `magnus8` has them in more steps.
#[test]
fn events() {
    let (spin, end, rtol) = (DynFlow::linear_with_series(spin(), Linear), 60.0, 1e-10);
    let spin: DynFlow<_, _, WithSeries<TimeAlone>> = spin;
    let events = |name| {
        let method = spin.method(&MethodSpec::new(name, None)).unwrap();
        let solve = Solve::new(&spin, &method, [0.0, end]).tolerances(rtol, 0.0);
        let run = solve.event(Event::new("level", |_, x: &V| x.z - 0.3)).run(V::z()).unwrap();
        assert!((run.y.z - height(end)).abs() < 1e3 * rtol, "{name}");
        (run.times_of(0).collect::<Vec<_>>(), run.stats.accepted)
    };
    let [(series, steps), (magnus, more)] = ["taylor16", "magnus8"].map(events);
    assert!(steps < more, "{steps} and {more} steps");
    // √2 t = ± arccos(−0.4) + 2πk.
    let turns = (0..).map(|k| core::f64::consts::TAU * f64::from(k));
    let exact = turns.flat_map(|turn| {
        let angle = (-0.4f64).acos();
        [turn + angle, turn + core::f64::consts::TAU - angle].map(|angle| angle / 2f64.sqrt())
    });
    let exact: Vec<f64> = exact.take_while(|t| *t < end).collect();
    assert_eq!((series.len(), magnus.len()), (exact.len(), exact.len()));
    for ((a, b), t) in series.iter().zip(&magnus).zip(&exact) {
        assert!((a - t).abs() < 1e3 * rtol && (b - t).abs() < 1e3 * rtol, "{t}: {a} and {b}");
    }
}

/// NaN stands for a derivative that is not known: the methods that need it fail, and others run.
#[test]
fn derivatives_that_are_not_known() {
    let spin = spin();
    let known = Flow::of_derivatives(So3::new(), Linear, |t, k, v: &mut V| match k {
        0..5 => {
            let mut f = [V::zeros(); 5];
            spin.coefficient([t, 1.0], &V::z(), k, &mut f, &mut V::zeros());
            *v = f[k] * (1..=k).map(|i| i as f64).product::<f64>();
        }
        _ => *v = V::from_element(f64::NAN),
    });
    fn run<P: Problem<Group = So3, Action = Linear>>(
        p: &P,
        method: &impl Embedded<P>,
    ) -> Result<V, String> {
        let run = Solve::new(p, method, [0.0, 1.0]).steps(50).run(V::z());
        run.map(|run| run.y).map_err(|error| error.to_string())
    }
    for order in [4, 5] {
        let [some, all] = [run(&known, &series(order)), run(&spin, &series(order))];
        assert!((some.unwrap() - all.unwrap()).norm() < 1e-14, "order {order}");
    }
    for order in [6, 16] {
        let message = run(&known, &series(order)).unwrap_err();
        assert!(message.contains("the Taylor coefficients"), "{message}");
    }
    assert!((run(&known, &AnyMethod::new(Magnus6)).unwrap().z - height(1.0)).abs() < 1e-12);
}

/// The sum of the coefficients of θᵏ with θ = 1 is A(t + h), up to the remainder of cos and sin, which each coefficient
/// exceeds.
#[test]
fn coefficients_sum_to_the_field() {
    let (spin, h) = (spin(), 1.0);
    for order in 4..=16 {
        let remainder = (1..=order).fold(2f64.sqrt(), |size, k| size * h / k as f64);
        for t in [-3.0, 0.3, 7.5] {
            let mut f = vec![V::zeros(); order];
            let mut storage = spin.series(order);
            (0..order).for_each(|k| spin.coefficient([t, h], &V::z(), k, &mut f, &mut storage));
            let apart = f.iter().sum::<V>() - V::new((t + h).cos(), (t + h).sin(), 2.0);
            assert!(apart.norm() < remainder, "{order} terms at {t}: {apart}");
            assert!(f[order - 1].norm() > 2.0 * remainder, "{order} terms: {remainder:e}");
        }
    }
}
