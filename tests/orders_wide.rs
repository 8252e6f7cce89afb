//! Orders from 8 on, in numbers of 32 digits: in `f64` such a method goes from its first asymptotic step
//! to rounding within a factor of 4 to 18 in h, and three slopes near p do not fit in. Everything on
//! SO(3) in closed form is generic in the number, so each method of the catalog of order 8 and more is
//! measured here to 0.15, by the rule of the lower orders. `orders.rs` and `orders_special.rs` have the
//! other groups, in `f64`.
//!
//! The reference is extrapolation of the midpoint rule on the entries, which knows no map, no action, no
//! bracket and no coefficient of a method.

mod support;

use faer::Mat;
use lieflow::Step;
use lieflow::actions::LeftTranslation;
use lieflow::catalog::Needs;
use lieflow::groups::{So3, hat};
use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Exp, Pade22};
use lieflow::methods::magnus::{CFM8_11, Magnus8};
use lieflow::methods::tableau::DOP853;
use lieflow::methods::{
    CfMagnus, DMV8, DMV10, KAHAN_LI8, Method, Projected, Rk, Rkmk, SOFRONIOU_SPALETTA10, Splitting,
    Taylor,
};
use lieflow::problems::{
    Ambient, LinearField, PointOf, Problem, Projection, RigidBody, RigidBodyAttitude,
};
use lieflow::scalar::{DoubleDouble, Real, Trig};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use support::orders::{Estimate, Outcome, Report, STRICT, order_over, specs};

type D = DoubleDouble;

/// Methods of lower order have room enough in `f64`.
const LEAST: usize = 8;
/// The mean of the errors on so many problems is looked at: on a single one an accident of the leading
/// term may hide it.
const MEMBERS: u64 = 12;
/// The start of every run, and the lengths of those of fields and of free bodies, whose methods take larger
/// steps.
const T0: f64 = 0.25;
const FIELDS: f64 = 1.5;
const BODIES: f64 = 4.0;

/// Coefficients that are stored as doubles leave an error of ε in Σ b_i = 1, whatever h: errors count down
/// to 50 of it.
const STORED: [f64; 2] = [5e-15, 5e-15];
/// In the weights of `mr10` the roundings cancel: 5e-18 are left.
const CANCELLED: [f64; 2] = [2e-15, 2e-14];
/// Those of the Lie series are 1/k.
const RATIONAL: [f64; 2] = [1e-26, 1e-26];

/// The numbers of a point.
trait Numbers {
    fn numbers(&self) -> &[D];
}
impl Numbers for Vector3<D> {
    fn numbers(&self) -> &[D] {
        self.as_slice()
    }
}
impl Numbers for Matrix3<D> {
    fn numbers(&self) -> &[D] {
        self.as_slice()
    }
}

/// ‖a − b‖ entry by entry, relative to ‖b‖ of which all have the size 1.
fn difference(a: &[D], b: &[D]) -> Mat<f64> {
    Mat::from_fn(a.len(), 1, |i, _| (a[i] - b[i]).value())
}

/// A problem, where it starts and where it is at the end.
struct Member<P: Problem> {
    problem: P,
    start: PointOf<P>,
    span: [D; 2],
    end: Vec<D>,
}

impl<P: Ambient> Member<P>
where
    P::Group: lieflow::LieAlgebra<Scalar = D>,
    PointOf<P>: Numbers,
{
    fn new(length: f64, (problem, start): (P, PointOf<P>)) -> Self {
        let span = [T0, T0 + length].map(D::lit);
        let [end, finer] =
            [96.0, 128.0].map(|rate| extrapolated(&problem, &start, span, (rate * length) as u64));
        let gap = difference(end.numbers(), finer.numbers()).norm_l2();
        assert!(gap < 1e-27, "the reference: {gap:e}");
        Member { problem, start, span, end: finer.numbers().to_vec() }
    }

    /// The relative error of a run.
    fn error<M: Method<P>>(&self, method: &M, steps: u64) -> Result<Mat<f64>, String> {
        let mut y = self.start.clone();
        let mut work = method.work(&self.problem, &y).map_err(|e| e.to_string())?;
        let [t0, t1] = self.span;
        let h = (t1 - t0) / D::lit(steps as f64);
        for n in 0..steps {
            let t = t0 + h * D::lit(n as f64);
            let step = method.step(&self.problem, Step { n, t, h }, &mut y, &mut work);
            step.map_err(|e| format!("step {n} of {steps}: {e}"))?;
        }
        let size = self.end.iter().fold(D::lit(0.0), |s, &x| s + x * x).sqrt().value();
        Ok(difference(y.numbers(), &self.end) * faer::Scale(1.0 / size))
    }
}

/// So many columns of the tableau, order 16: more would magnify rounding.
const COLUMNS: usize = 8;

/// y at the end of the span by extrapolation of the explicit midpoint rule with 2, 4, 6, … steps, whose
/// error is a series in h² (W. Gragg, 1965; Hairer, Nørsett, Wanner I, II.9).
fn extrapolated<P: Ambient>(
    problem: &P,
    start: &PointOf<P>,
    [t0, t1]: [D; 2],
    steps: u64,
) -> PointOf<P>
where
    P::Group: lieflow::LieAlgebra<Scalar = D>,
{
    let big = (t1 - t0) / D::lit(steps as f64);
    let mut work = problem.work();
    let (mut y, mut dy) = (start.clone(), start.clone());
    for n in 0..steps {
        let at = t0 + big * D::lit(n as f64);
        let mut row: Vec<PointOf<P>> = Vec::new();
        for k in 0..COLUMNS {
            let pieces = 2 * (k + 1);
            let h = big / D::lit(pieces as f64);
            let (mut before, mut now) = (y.clone(), y.clone());
            problem.field(at, &y, &mut dy, &mut work);
            problem.add(h, &dy, &mut now);
            for i in 1..pieces {
                problem.field(at + h * D::lit(i as f64), &now, &mut dy, &mut work);
                problem.add(h + h, &dy, &mut before);
                core::mem::swap(&mut before, &mut now);
            }
            // Aitken and Neville: T ← T + (T − T′)/((n_k/n_j)² − 1), from the shortest steps on.
            row.push(now);
            for j in (0..k).rev() {
                let ratio = D::lit((k + 1) as f64) / D::lit((j + 1) as f64);
                let weight = D::lit(1.0) / (ratio * ratio - D::lit(1.0));
                let (coarse, fine) = row.split_at_mut(j + 1);
                let mut better = fine[0].clone();
                problem.add(weight, &fine[0], &mut better);
                problem.add(-weight, &coarse[j], &mut better);
                row[j] = better;
            }
        }
        y = row.swap_remove(0);
    }
    y
}

/// f(t, g) = strength·(C₀ cos 1.3t g₀₀ + sin(C₁ge₃ + t) + C₂ge₁ cos t), or without what depends on g:
/// C₀ cos 1.3t + C₁ sin t.
struct Driven {
    c: [Matrix3<D>; 3],
    strength: D,
    linear: bool,
}

impl Driven {
    fn new(seed: u64, strength: f64, linear: bool) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let c = [(); 3].map(|()| Matrix3::from_fn(|_, _| D::lit(rng.random_range(-1.0..1.0))));
        Driven { c, strength: D::lit(strength), linear }
    }

    fn xi(&self, t: D, g: &Matrix3<D>) -> Vector3<D> {
        let (fast, (sin, cos)) = ((D::lit(1.3) * t).sin_cos().1, t.sin_cos());
        let times = |c: &Matrix3<D>, i: usize, j: usize| {
            (0..3).fold(D::lit(0.0), |sum, k| sum + c[(i, k)] * g[(k, j)])
        };
        Vector3::from_fn(|i, _| {
            self.strength
                * match self.linear {
                    true => self.c[0][(i, 0)] * fast + self.c[1][(i, 0)] * sin,
                    false => {
                        self.c[0][(i, 0)] * fast * g[(0, 0)]
                            + (times(&self.c[1], i, 2) + t).sin_cos().0
                            + times(&self.c[2], i, 0) * cos
                    }
                }
        })
    }
}

impl Problem for Driven {
    type Group = So3<D>;
    type Action = LeftTranslation;
    type Work = ();
    fn group(&self) -> &So3<D> {
        const { &So3::new() }
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) {}
    fn f(&self, t: D, g: &Matrix3<D>, v: &mut Vector3<D>, _: &mut ()) {
        *v = self.xi(t, g);
    }
}

impl Ambient for Driven {
    fn field(&self, t: D, g: &Matrix3<D>, dg: &mut Matrix3<D>, _: &mut ()) {
        let xi = hat(&self.xi(t, g));
        *dg = Matrix3::from_fn(|i, j| {
            (0..3).fold(D::lit(0.0), |sum, k| sum + xi[(i, k)] * g[(k, j)])
        });
    }
    fn copy(&self, x: &Matrix3<D>, y: &mut Matrix3<D>) {
        *y = *x;
    }
    fn add(&self, a: D, x: &Matrix3<D>, y: &mut Matrix3<D>) {
        y.iter_mut().zip(x).for_each(|(y, x)| *y += a * *x);
    }
    fn is_finite(&self, y: &Matrix3<D>) -> bool {
        y.iter().all(|x| Real::is_finite(*x))
    }
}

impl LinearField for Driven {
    fn a(&self, t: D, v: &mut Vector3<D>, _: &mut ()) {
        *v = self.xi(t, &identity());
    }
}

fn identity() -> Matrix3<D> {
    Matrix3::from_fn(|i, j| D::lit(f64::from(u8::from(i == j))))
}

fn members<P: Ambient>(length: f64, make: impl Fn(u64) -> (P, PointOf<P>)) -> Vec<Member<P>>
where
    P::Group: lieflow::LieAlgebra<Scalar = D>,
    PointOf<P>: Numbers,
{
    (0..MEMBERS).map(|i| Member::new(length, make(i))).collect()
}

/// The order of one method.
fn order<P: Ambient, M: Method<P>>(
    members: &[Member<P>],
    floors: [f64; 2],
    method: &M,
) -> Result<Estimate, String>
where
    P::Group: lieflow::LieAlgebra<Scalar = D>,
    PointOf<P>: Numbers,
{
    let error = |i: usize, n| members[i].error(method, n);
    order_over(method.order(&members[0].problem), members.len(), floors, STRICT, &error)
}

/// The methods of the lists whose order is 8 or more, on these members. Each has its type here: all of
/// the catalog's on one more type of problem would be minutes of compilation. One that is missing fails.
macro_rules! measured {
    ($title:literal, $needs:expr, {$($of:pat => $members:ident, $floors:ident, $method:expr;)*}) => {
        let mut report = Report::new($title);
        for spec in specs(&$needs) {
            let of_tableau = spec.tableau.as_deref() == Some(DOP853.name);
            if spec.info().unwrap().order.is_some_and(|p| p >= LEAST) || of_tableau {
                let measured = match (spec.name.as_str(), spec.map.as_deref(), spec.q) {
                    $($of => order(&$members, $floors, &$method),)*
                    _ => Err("not measured".into()),
                };
                report.add(&spec.label(), true, Outcome::Measured(measured));
            }
        }
        report.assert();
    };
}

#[test]
fn fields() {
    let members = members(FIELDS, |i| (Driven::new(11 + i, 1.0, false), identity()));
    measured!("fields", [Needs::Field, Needs::Norm], {
        ("rk", ..) => members, STORED, Rk(DOP853);
        ("rkmk", Some("exp"), None) => members, STORED, Rkmk::new(DOP853, Exp);
        ("rkmk", Some("exp"), Some(q)) => members, STORED, Rkmk::new(DOP853, Exp.truncated(q));
        ("rkmk", Some("cay"), _) => members, STORED, Rkmk::new(DOP853, Cay);
        ("rkmk", Some("pade22"), _) => members, STORED, Rkmk::new(DOP853, Pade22);
        ("rkmk", Some("ccsk123"), _) => members, STORED, Rkmk::new(DOP853, CCSK123);
        ("rkmk", Some("ccsk321"), _) => members, STORED, Rkmk::new(DOP853, CCSK321);
        ("rkmk", Some("ccsk"), _) => members, STORED, Rkmk::new(DOP853, CCSK);
    });
}

#[test]
fn fields_of_linear_type() {
    let members = members(FIELDS, |i| (Driven::new(21 + i, 2.0, true), identity()));
    measured!("fields of linear type", [Needs::LinearType], {
        ("magnus8", ..) => members, STORED, Magnus8;
        ("cfm8-11", ..) => members, STORED, CfMagnus(CFM8_11);
    });
}

/// A body that is nothing special, and one that is more even: compositions show their order there before
/// the rounding of their weights.
const INERTIA: [f64; 3] = [1.0, 2.0, 3.5];
const EVEN: [f64; 3] = [1.0, 1.5, 2.2];

/// A momentum of length 3 that is nothing special.
fn momentum(i: u64) -> [f64; 3] {
    let mut rng = Pcg64::seed_from_u64(40 + i);
    let m = Vector3::from_fn(|_, _| rng.random_range(0.3..1.0)).normalize() * 3.0;
    [m[0], m[1], -m[2]]
}

/// Every method for the body of order 8 and more, and those that only one of its problems has.
macro_rules! bodies {
    ($body:ident, $even:ident: $($test:ident: $title:literal, $needs:expr, $make:expr, {$($more:tt)*};)*) => {$(
        #[test]
        fn $test() {
            let [$body, $even] = [INERTIA, EVEN].map(|inertia| members(BODIES, $make(inertia)));
            measured!($title, $needs, {
                ("mr8", ..) => $even, STORED, Splitting::new([0, 1, 2], KAHAN_LI8);
                ("mr10", ..) => $even, CANCELLED, Splitting::new([0, 1, 2], SOFRONIOU_SPALETTA10);
                ("dmv8", ..) => $body, STORED, DMV8;
                ("dmv10", ..) => $body, STORED, DMV10;
                ("taylor8", ..) => $body, RATIONAL, Taylor::<8>;
                ("taylor10", ..) => $body, RATIONAL, Taylor::<10>;
                ("taylor12", ..) => $body, RATIONAL, Taylor::<12>;
                ("taylor14", ..) => $body, RATIONAL, Taylor::<14>;
                ("taylor16", ..) => $body, RATIONAL, Taylor::<16>;
                $($more)*
            });
        }
    )*};
}

bodies! {
    body, even:
    attitudes: "a body by its attitude", [Needs::Series, Needs::Body, Needs::Attitude],
        |j| move |i| (RigidBodyAttitude::new(j, momentum(i)).unwrap(), identity()), {
            ("rk-qr", ..) => body, STORED, Projected::new(Rk(DOP853), Projection::Qr);
            ("rk-polar", ..) => body, STORED, Projected::new(Rk(DOP853), Projection::Polar);
        };
    momenta: "a body by its momentum", [Needs::Series, Needs::Body, Needs::LiePoisson],
        |j| move |i| (RigidBody::new(j).unwrap(), Vector3::from(momentum(i)).map(D::lit)), {};
}
