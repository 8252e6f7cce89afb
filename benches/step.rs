//! One step of each method on the rigid body: `cargo bench --bench step`.
//!
//! The first table compares runs of lieflow with loops that a person writes by hand on nalgebra in a dozen lines, for the
//! body by its momentum. Typed: the method is a type. By name: it was chosen at run time. The second table compares steps
//! by their error with steps of given size, and so does the third on other spaces. The last has single steps of RKMK4 for each coordinate map and type of
//! problem. All loops of a table take turns. A number is the least time of the rounds.
//!
//! `examples/check_build` compiles this file in a crate of its own, for other settings of the compiler.

use std::hint::black_box;
use std::rc::Rc;
use std::time::Instant;

use lieflow::actions::{LeftTranslation, Linear, Pair};
use lieflow::catalog::{MethodSpec, MethodsByName};
use lieflow::faer::Mat;
use lieflow::groups::{LieGroup, Product, So3, Translations, hat};
use lieflow::maps::{CCSK123, CCSK321, Cay, Exp};
use lieflow::methods::commutator_free::CommutatorFree;
use lieflow::methods::crouch_grossman::CG3;
use lieflow::methods::tableau::{DOP853, DOPRI5, RK4};
use lieflow::methods::{AnyMethod, Embedded, LieSeries, Method, Rk, Rkmk, Taylor};
use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::problems::{
    Euler, Flow, HeavyTop, Kinetic, PointOf, RigidBody, RigidBodyAttitude, RigidBodyN,
    RigidBodyNAttitude,
};
use lieflow::{LieAlgebra, Problem, Solve, Step};

type V = Vector3<f64>;

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
const MOMENTUM: V = V::new(0.2, 0.5, 3.0);
const H: f64 = 0.01;
const ROUNDS: usize = 21;
const STEPS: u32 = 20_000;
/// The relative and the absolute tolerance of runs by error, and their end.
const TOLERANCE: f64 = 1e-8;
const END: f64 = 500.0;

/// Takes many steps. Returns their number.
type Loop = Box<dyn FnMut() -> u64>;

/// The least nanoseconds of a step of each loop.
fn least_times(mut loops: Vec<Loop>) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; loops.len()];
    for _ in 0..ROUNDS {
        for (steps, least) in loops.iter_mut().zip(&mut least) {
            let start = Instant::now();
            let count = steps();
            *least = least.min(1e9 * start.elapsed().as_secs_f64() / count as f64);
        }
    }
    least
}

fn body() -> RigidBody {
    RigidBody::new(INERTIA).expect("a body")
}

fn named(name: &str, tableau: Option<&str>, map: Option<&str>) -> AnyMethod<'static, RigidBody> {
    let spec = MethodSpec { tableau: tableau.map(Into::into), ..MethodSpec::new(name, map) };
    body().method(&spec).expect("a method")
}

/// A run of steps of given size.
fn run(method: impl Method<RigidBody> + 'static) -> Loop {
    let (body, method) = (body(), method);
    Box::new(move || {
        let span = [0.0, f64::from(STEPS) * black_box(H)];
        let run = Solve::new(&body, &method, span).steps(STEPS.into()).run(MOMENTUM);
        black_box(&run.expect("a run").y);
        STEPS.into()
    })
}

/// A run of steps by error.
fn by_error(method: impl Embedded<RigidBody> + 'static) -> Loop {
    let (body, method) = (body(), method);
    Box::new(move || {
        let solve = Solve::new(&body, &method, [0.0, END]).tolerances(TOLERANCE, TOLERANCE);
        let run = solve.run(MOMENTUM).expect("a run");
        black_box(&run.y);
        run.stats.accepted + run.stats.rejected
    })
}

/// A loop by hand.
fn repeated(step: impl Fn(&by_hand::Body, f64, V) -> V + 'static) -> Loop {
    let (body, mut m) = (by_hand::Body::new(INERTIA), MOMENTUM);
    Box::new(move || {
        for _ in 0..STEPS {
            m = step(&body, black_box(H), m);
        }
        black_box(m);
        STEPS.into()
    })
}

/// Runs beside loops by hand.
fn compare_with_hand() {
    let by_hand_by_error: Loop = {
        let body = by_hand::Body::new(INERTIA);
        Box::new(move || by_hand::dopri5_by_error(&body, black_box(END), TOLERANCE, MOMENTUM))
    };
    macro_rules! rows {
        ($($row:literal: $hand:expr, $run:ident($typed:expr, $named:expr);)*) => {{
            let rows = [$($row),*];
            (rows, vec![$($hand, $run($typed), $run($named)),*])
        }};
    }
    let (rows, loops) = rows! {
        "rk4": repeated(by_hand::rk4), run(Rk(RK4), named("rk", Some("rk4"), None));
        "rkmk4 cay": repeated(by_hand::rkmk4_cay),
            run(Rkmk::new(RK4, Cay), named("rkmk", Some("rk4"), Some("cay")));
        "rkmk4 exp": repeated(by_hand::rkmk4_exp),
            run(Rkmk::new(RK4, Exp), named("rkmk", Some("rk4"), Some("exp")));
        "cg3": repeated(by_hand::cg3), run(CommutatorFree(CG3), named("cg3", None, None));
        "rk dopri5": repeated(|body, h, m| by_hand::dopri5(body, h, m, body.field(m)).0),
            run(Rk(DOPRI5), named("rk", Some("dopri5"), None));
        "rk dopri5 by error": by_hand_by_error,
            by_error(Rk(DOPRI5), named("rk", Some("dopri5"), None));
    };
    println!("{:20} by hand     typed      by name, each beside the one before [ns]", "");
    for (row, least) in rows.iter().zip(least_times(loops).chunks(3)) {
        let (hand, typed, named) = (least[0], least[1], least[2]);
        let (beside_hand, beside_typed) = (typed / hand, named / typed);
        println!(
            "{row:20} {hand:7.1}  {typed:7.1} {beside_hand:5.2}  {named:7.1} {beside_typed:5.2}"
        );
    }
}

/// Steps by error beside steps of given size.
fn compare_choice() {
    macro_rules! rows {
        ($($row:literal: $typed:expr, $named:expr;)*) => {{
            let rows = [$($row),*];
            let loops = vec![$(run($typed), by_error($typed), run($named), by_error($named)),*];
            (rows, loops)
        }};
    }
    let (rows, loops) = rows! {
        "rk dopri5": Rk(DOPRI5), named("rk", Some("dopri5"), None);
        "rkmk dopri5 exp": Rkmk::new(DOPRI5, Exp), named("rkmk", Some("dopri5"), Some("exp"));
        "rk dop853": Rk(DOP853), named("rk", Some("dop853"), None);
        "rkmk dop853 exp": Rkmk::new(DOP853, Exp), named("rkmk", Some("dop853"), Some("exp"));
        "taylor16": Taylor::<16>, named("taylor16", None, None);
    };
    println!("\n{:20} typed: given size, by error    by name [ns an attempt]", "");
    for (row, least) in rows.iter().zip(least_times(loops).chunks(4)) {
        print!("{row:20}");
        for pair in least.chunks(2) {
            print!(" {:7.1} {:7.1} {:5.2}  ", pair[0], pair[1], pair[1] / pair[0]);
        }
        println!();
    }
}

/// Runs of a method from a start: as many steps of given size as the run by error has, and that one.
fn both<P, M>(problem: P, method: M, y: PointOf<P>) -> [Loop; 2]
where
    P: Problem<Group: LieAlgebra<Scalar = f64>> + 'static,
    M: Embedded<P> + Copy + 'static,
    PointOf<P>: Clone + 'static,
{
    let problem = Rc::new(problem);
    let run_by_error = move |problem: &P, y: &PointOf<P>| {
        let solve = Solve::new(problem, &method, [0.0, 0.1 * black_box(END)]);
        let stats = solve.tolerances(TOLERANCE, TOLERANCE).run(y.clone()).expect("a run").stats;
        stats.accepted + stats.rejected
    };
    let attempts = run_by_error(&problem, &y);
    let (again, start) = (problem.clone(), y.clone());
    let given: Loop = Box::new(move || {
        let solve = Solve::new(&*again, &method, [0.0, 0.1 * black_box(END)]).steps(attempts);
        let _ = black_box(solve.run(start.clone()).expect("a run").t);
        attempts
    });
    [given, Box::new(move || run_by_error(&problem, &y))]
}

/// Steps by error beside steps of given size, on other spaces than vectors of ℝ³.
fn compare_spaces() {
    let top = HeavyTop::<f64>::new(INERTIA, [0.1, 0.0, 1.0]).expect("a top").problem();
    let at_start = (MOMENTUM, V::new(0.6, 0.0, 0.8));
    let parts = Product(So3::<f64>::new(), Product(So3::new(), Translations::new(0.0, 1)));
    let inertia = V::from(INERTIA);
    let wheel = Flow::new(
        parts,
        Pair(Linear, LeftTranslation),
        move |_, (m, (g, h)): &(V, (Matrix3<f64>, f64)), v: &mut (V, (V, f64))| {
            let omega = (m - V::x() * *h).component_div(&inertia);
            *v = (-omega, (g * omega, 0.002));
        },
    );
    let body = |n: usize| {
        let moments: Vec<f64> = (0..n).map(|i| 1.0 + 0.7 * i as f64).collect();
        let body = RigidBodyN::manakov(&moments).expect("a body");
        let m = Mat::from_fn(n, n, |i, j| (i as f64 - j as f64) / (1.0 + (i + j) as f64));
        (body, m)
    };
    let ((body5, m5), (body10, m10)) = (body(5), body(10));
    let kinetic = Kinetic(move |m: &V, u: &mut V| *u = m.component_div(&inertia));
    let series = LieSeries::new(16).expect("an order");
    let (dopri5, dop853) = (Rkmk::new(DOPRI5, Exp), Rkmk::new(DOP853, Exp));
    let rows = [
        ("rkmk dopri5, se(3)*", both(top, dopri5, at_start)),
        ("rkmk dop853, se(3)*", both(top, dop853, at_start)),
        ("rkmk dopri5, product", both(wheel, dopri5, (MOMENTUM, (Matrix3::identity(), 0.0)))),
        ("rkmk dopri5, so(5)*", both(body5.clone(), dopri5, m5.clone())),
        ("rkmk dop853, so(5)*", both(body5, dop853, m5)),
        ("rkmk dopri5, so(10)*", both(body10, dopri5, m10)),
        ("taylor16, so(3)*", both(self::body(), Taylor::<16>, MOMENTUM)),
        ("LieSeries 16, so(3)*", both(Euler::new(So3::new(), kinetic), series, MOMENTUM)),
    ];
    let (names, loops): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
    println!("\n{:20} typed: given size, by error [ns an attempt]", "");
    for (row, least) in
        names.iter().zip(least_times(loops.into_iter().flatten().collect()).chunks(2))
    {
        println!("{row:20} {:7.1} {:7.1} {:5.2}", least[0], least[1], least[1] / least[0]);
    }
}

/// Single steps of a method.
fn steps<P, M>(problem: P, method: M, y: PointOf<P>) -> Loop
where
    P: Problem<Group: LieAlgebra<Scalar = f64>> + 'static,
    M: Method<P> + 'static,
{
    let mut y = y;
    let mut work = method.work(&problem, &y).expect("the method fits");
    Box::new(move || {
        for _ in 0..STEPS {
            let step = Step { n: 0, t: 0.0, h: black_box(H) };
            method.step(&problem, step, &mut y, &mut work).expect("a step");
        }
        STEPS.into()
    })
}

/// RKMK4 on all types of problem.
fn compare_problems() {
    let attitude = || RigidBodyAttitude::new(INERTIA, MOMENTUM.into()).expect("a body");
    let general = || RigidBodyN::from_principal(INERTIA).expect("a body");
    let hat = hat(&MOMENTUM);
    let matrix = Mat::from_fn(3, 3, |i, j| hat[(i, j)]);
    let general_attitude = || RigidBodyNAttitude::new(general(), matrix.clone()).expect("a body");
    let (mut rows, mut loops): (Vec<String>, Vec<Loop>) =
        (vec!["rk4, g".into()], vec![steps(attitude(), Rk(RK4), Matrix3::identity())]);
    macro_rules! rkmk {
        ($($name:literal: $psi:expr;)*) => {$(
            let method = Rkmk::new(RK4, $psi);
            let mut add = |what: &str, steps| {
                rows.push(format!("rkmk4 {}, {what}", $name));
                loops.push(steps);
            };
            add("m", steps(body(), method, MOMENTUM));
            add("g", steps(attitude(), method, Matrix3::identity()));
            add("m as a matrix", steps(general(), method, matrix.clone()));
            let start = general_attitude().group().identity();
            add("g as a matrix", steps(general_attitude(), method, start));
        )*};
    }
    rkmk! {
        "exp": Exp;
        "cay": Cay;
        "ccsk123": CCSK123;
        "ccsk321": CCSK321;
    }
    println!("\n{:30} [ns]", "single steps");
    for (row, least) in rows.iter().zip(least_times(loops)) {
        println!("{row:30} {least:8.1}");
    }
}

fn main() {
    compare_with_hand();
    compare_choice();
    compare_spaces();
    if !std::env::args().any(|arg| arg == "--quick") {
        compare_problems();
    }
}

/// Steps as a person writes them.
mod by_hand {
    use super::V;

    pub(super) struct Body {
        inverse_inertia: V,
    }

    impl Body {
        pub(super) fn new(inertia: [f64; 3]) -> Self {
            Body { inverse_inertia: V::from(inertia.map(|j| 1.0 / j)) }
        }
        /// −J⁻¹m.
        fn f(&self, m: V) -> V {
            -self.inverse_inertia.component_mul(&m)
        }
        /// m × J⁻¹m.
        pub(super) fn field(&self, m: V) -> V {
            m.cross(&self.inverse_inertia.component_mul(&m))
        }
    }

    pub(super) fn rk4(body: &Body, h: f64, m: V) -> V {
        let k1 = body.field(m);
        let k2 = body.field(m + 0.5 * h * k1);
        let k3 = body.field(m + 0.5 * h * k2);
        let k4 = body.field(m + h * k3);
        m + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    }

    /// A step of RKMK4 from Ψ(u)·m and dΨ_u⁻¹(v).
    fn rkmk4(body: &Body, h: f64, m: V, act: impl Fn(V, V) -> V, dinv: impl Fn(V, V) -> V) -> V {
        let f = |u: V| dinv(u, body.f(act(u, m)));
        let k1 = body.f(m);
        let k2 = f(0.5 * h * k1);
        let k3 = f(0.5 * h * k2);
        let k4 = f(h * k3);
        act(h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), m)
    }

    pub(super) fn rkmk4_cay(body: &Body, h: f64, m: V) -> V {
        let act = |u: V, m: V| {
            let um = u.cross(&m);
            m + (um + 0.5 * u.cross(&um)) / (1.0 + 0.25 * u.norm_squared())
        };
        rkmk4(body, h, m, act, |u, v| v - 0.5 * u.cross(&v) + 0.25 * u.dot(&v) * u)
    }

    /// exp(u)·m, by Rodrigues' formula.
    fn exp_on(u: V, m: V) -> V {
        let angle = u.norm();
        if angle < 1e-8 {
            return m + u.cross(&m);
        }
        let (sin, cos) = angle.sin_cos();
        let um = u.cross(&m);
        m + sin / angle * um + (1.0 - cos) / (angle * angle) * u.cross(&um)
    }

    pub(super) fn rkmk4_exp(body: &Body, h: f64, m: V) -> V {
        let dinv = |u: V, v: V| {
            let angle = u.norm();
            let c = match angle < 1e-2 {
                true => 1.0 / 12.0 + angle * angle / 720.0,
                false => (1.0 - 0.5 * angle / (0.5 * angle).tan()) / (angle * angle),
            };
            let uv = u.cross(&v);
            v - 0.5 * uv + c * u.cross(&uv)
        };
        rkmk4(body, h, m, exp_on, dinv)
    }

    /// Crouch–Grossman, order 3.
    pub(super) fn cg3(body: &Body, h: f64, m: V) -> V {
        let k1 = body.f(m);
        let k2 = body.f(exp_on(0.75 * h * k1, m));
        let at = exp_on(17.0 / 108.0 * h * k2, exp_on(119.0 / 216.0 * h * k1, m));
        let k3 = body.f(at);
        let m = exp_on(-2.0 / 3.0 * h * k2, exp_on(13.0 / 51.0 * h * k1, m));
        exp_on(24.0 / 17.0 * h * k3, m)
    }

    /// The end of a step, f there, and the error. k₁ is f at the start.
    pub(super) fn dopri5(body: &Body, h: f64, m: V, k1: V) -> (V, V, V) {
        let f = |m| body.field(m);
        let k2 = f(m + h * (k1 / 5.0));
        let k3 = f(m + h * (3.0 / 40.0 * k1 + 9.0 / 40.0 * k2));
        let k4 = f(m + h * (44.0 / 45.0 * k1 - 56.0 / 15.0 * k2 + 32.0 / 9.0 * k3));
        let k5 = f(m + h
            * (19372.0 / 6561.0 * k1 - 25360.0 / 2187.0 * k2 + 64448.0 / 6561.0 * k3
                - 212.0 / 729.0 * k4));
        let k6 = f(m + h
            * (9017.0 / 3168.0 * k1 - 355.0 / 33.0 * k2
                + 46732.0 / 5247.0 * k3
                + 49.0 / 176.0 * k4
                - 5103.0 / 18656.0 * k5));
        let y = m + h
            * (35.0 / 384.0 * k1 + 500.0 / 1113.0 * k3 + 125.0 / 192.0 * k4 - 2187.0 / 6784.0 * k5
                + 11.0 / 84.0 * k6);
        let k7 = f(y);
        let e = h
            * (71.0 / 57600.0 * k1 - 71.0 / 16695.0 * k3 + 71.0 / 1920.0 * k4
                - 17253.0 / 339200.0 * k5
                + 22.0 / 525.0 * k6
                - k7 / 40.0);
        (y, k7, e)
    }

    /// Steps by their error to the end. Returns their number.
    pub(super) fn dopri5_by_error(body: &Body, end: f64, tolerance: f64, m: V) -> u64 {
        let (mut t, mut h, mut m, mut k1) = (0.0, 0.01, m, body.field(m));
        let mut attempts = 0;
        while t < end {
            h = f64::min(h, end - t);
            let (y, k7, e) = dopri5(body, h, m, k1);
            let ratio = e.norm() / (tolerance + tolerance * y.norm().max(m.norm()));
            if ratio <= 1.0 {
                (t, m, k1) = (t + h, y, k7);
            }
            h *= (0.9 * ratio.powf(-0.2)).clamp(0.2, 5.0);
            attempts += 1;
        }
        std::hint::black_box(m);
        attempts
    }
}
