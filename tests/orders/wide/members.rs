//! Problems with references of more than 20 digits, and the order that a method shows over several of them.

use faer::Mat;
use lieflow::catalog::{MethodSpec, Needs};
use lieflow::methods::tableau::DOP853;
use lieflow::methods::{LieSeries, Method, Step};
use lieflow::problems::FieldStore;
use lieflow::problems::{Ambient, BodyState, LinearSpace, PointOf};
use lieflow::scalar::Real;
use lieflow::{Error, LieAlgebra};
use nalgebra::{Matrix3, Vector3};

use super::D;
use crate::support::orders::{Outcome, Report, order_over};

/// Methods of lower order have room enough in `f64`.
const LEAST: usize = 8;
/// The start of every run.
const T0: f64 = 0.25;

/// The relative errors that count: those of the method, and those of it without its leading term.
pub(crate) type Floors = [f64; 2];
/// Coefficients that are stored as doubles leave an error of ε in Σ b_i = 1, whatever h: errors count down
/// to 50 of it.
pub(crate) const STORED: Floors = [5e-15, 5e-15];
/// In the weights of `mr10` the roundings cancel: 5e-18 are left.
pub(crate) const CANCELLED: Floors = [2e-15, 2e-14];
/// Those of the Lie series are 1/k. Down to here each of them takes about as many steps as the others.
pub(crate) fn rational(order: i32) -> Floors {
    [10f64.powf(-1.7 * f64::from(order)).max(1e-27); 2]
}

/// The numbers of a point.
pub(crate) trait Numbers {
    fn each(&self, take: &mut impl FnMut(D));
    fn numbers(&self) -> Vec<D> {
        let mut numbers = Vec::new();
        self.each(&mut |x| numbers.push(x));
        numbers
    }
}
impl Numbers for Vector3<D> {
    fn each(&self, take: &mut impl FnMut(D)) {
        self.iter().for_each(|x| take(*x));
    }
}
impl Numbers for Matrix3<D> {
    fn each(&self, take: &mut impl FnMut(D)) {
        self.iter().for_each(|x| take(*x));
    }
}
impl Numbers for BodyState<D> {
    fn each(&self, take: &mut impl FnMut(D)) {
        self.m.each(take);
        self.g.each(take);
    }
}
impl<A: Numbers, B: Numbers> Numbers for (A, B) {
    fn each(&self, take: &mut impl FnMut(D)) {
        self.0.each(take);
        self.1.each(take);
    }
}
impl<A: Numbers> Numbers for Box<[A]> {
    fn each(&self, take: &mut impl FnMut(D)) {
        self.iter().for_each(|part| part.each(take));
    }
}

/// a − b.
fn difference(a: &[D], b: &[D]) -> Mat<f64> {
    Mat::from_fn(a.len(), 1, |i, _| (a[i] - b[i]).value())
}

/// A problem in numbers of 32 digits whose points can be compared.
pub(crate) trait Measurable:
    Ambient<Group: LieAlgebra<Scalar = D>, Action: lieflow::Action<Self::Group, Point: Numbers>>
{
}
impl<P: Ambient> Measurable for P
where
    P::Group: LieAlgebra<Scalar = D>,
    PointOf<P>: Numbers,
{
}

/// How long the runs are, and the steps of the reference for a unit of time.
#[derive(Clone, Copy)]
pub(crate) struct Span {
    pub(crate) length: f64,
    pub(crate) rate: f64,
    /// What the reference and one with 3/4 of its steps may differ by.
    pub(crate) gap: f64,
}

/// For errors down to [`STORED`], and for those of the Lie series.
pub(crate) const UNIT: Span = Span { length: 1.0, rate: 24.0, gap: 1e-17 };
pub(crate) const UNIT_FINE: Span = Span { length: 1.0, rate: 96.0, gap: 1e-28 };

/// A problem, where it starts and where it is at the end.
pub(crate) struct Member<P: Measurable> {
    problem: P,
    start: PointOf<P>,
    span: [D; 2],
    end: Vec<D>,
}

impl<P: Measurable> Member<P> {
    pub(crate) fn new(Span { length, rate, gap }: Span, (problem, start): (P, PointOf<P>)) -> Self {
        let span = [T0, T0 + length].map(D::lit);
        let [coarse, end] = [0.75, 1.0].map(|part| {
            let steps = (part * rate * length).ceil() as u64;
            extrapolated(&problem, &start, span, steps).numbers()
        });
        let found = difference(&coarse, &end).norm_l2() / size(&end);
        assert!(found < gap, "the reference: {found:e}");
        Member { problem, start, span, end }
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
        Ok(difference(&y.numbers(), &self.end) * faer::Scale(1.0 / size(&self.end)))
    }
}

fn size(x: &[D]) -> f64 {
    x.iter().map(|x| x.value() * x.value()).sum::<f64>().sqrt()
}

/// So many columns of the tableau, order 16: more would magnify rounding.
const COLUMNS: usize = 8;

/// y at the end of the span by extrapolation of the explicit midpoint rule with 2, 4, 6, … steps, whose
/// error is a series in h² (W. Gragg, 1965; Hairer, Nørsett, Wanner I, II.9).
fn extrapolated<P: Measurable>(
    problem: &P,
    start: &PointOf<P>,
    [t0, t1]: [D; 2],
    steps: u64,
) -> PointOf<P> {
    let big = (t1 - t0) / D::lit(steps as f64);
    let mut store = FieldStore::new(problem);
    let (mut y, mut dy) = (start.clone(), start.clone());
    for n in 0..steps {
        let at = t0 + big * D::lit(n as f64);
        let mut row: Vec<PointOf<P>> = Vec::new();
        for k in 0..COLUMNS {
            let pieces = 2 * (k + 1);
            let h = big / D::lit(pieces as f64);
            let (mut before, mut now) = (y.clone(), y.clone());
            problem.field(at, &y, &mut dy, &mut store);
            now.add(h, &dy);
            for i in 1..pieces {
                problem.field(at + h * D::lit(i as f64), &now, &mut dy, &mut store);
                before.add(h + h, &dy);
                core::mem::swap(&mut before, &mut now);
            }
            // Aitken and Neville: T ← T + (T − T′)/((n_k/n_j)² − 1), from the shortest steps on.
            row.push(now);
            for j in (0..k).rev() {
                let ratio = D::lit((k + 1) as f64) / D::lit((j + 1) as f64);
                let weight = D::lit(1.0) / (ratio * ratio - D::lit(1.0));
                let mut better = row[j + 1].clone();
                better.add(weight, &row[j + 1]);
                better.add(-weight, &row[j]);
                row[j] = better;
            }
        }
        y = row.swap_remove(0);
    }
    y
}

/// So many of them: the geometric mean of their errors is looked at, since on a single problem an accident
/// of the leading term may hide it.
pub(crate) fn members<P: Measurable>(
    count: u64,
    span: Span,
    make: impl Fn(u64) -> (P, PointOf<P>),
) -> Vec<Member<P>> {
    (0..count).map(|i| Member::new(span, make(i))).collect()
}

/// The order of one method.
pub(crate) fn order<P: Measurable, M: Method<P>>(
    members: &[Member<P>],
    floors: Floors,
    method: &M,
) -> Outcome {
    let Member { problem, start, .. } = &members[0];
    if matches!(method.work(problem, start), Err(Error::Unsupported { .. })) {
        return Outcome::Refused;
    }
    let error = |i: usize, n| members[i].error(method, n);
    Outcome::Measured(order_over(method.facts(problem).order, members.len(), floors, &error))
}

/// The methods of the lists whose order is 8 or more, on a group: all must be measured, to 0.15, or be refused
/// where the catalog says so.
pub(crate) fn high_orders(
    title: &str,
    group: &str,
    needs: &[Needs],
    measured: impl Fn(&MethodSpec) -> Outcome,
) {
    Report::of(&format!("{title} on {group}"), group, needs, |spec| {
        let of_tableau = spec.tableau.as_deref() == Some(DOP853.name);
        let is_high = spec.info()?.order.number().is_some_and(|p| p >= LEAST) || of_tableau;
        Ok(if is_high { measured(spec) } else { Outcome::Elsewhere })
    });
}

/// The outcome of a Lie series, whose order is in its name; of another method none.
pub(crate) fn lie_series<P: Measurable>(spec: &MethodSpec, members: &[Member<P>]) -> Outcome
where
    LieSeries: Method<P>,
{
    match spec.name.strip_prefix("taylor").map(str::parse) {
        Some(Ok(p)) => order(members, rational(p as i32), &LieSeries::new(p).unwrap()),
        _ => Outcome::Measured(Err("not measured".into())),
    }
}

/// The outcome of `spec`, by the type of each method: all of the catalog's on one more type of problem would
/// be minutes of compilation. One that is missing fails.
macro_rules! by_name {
    ($spec:expr, {$($name:pat $(, $map:pat, $q:pat)? => $members:expr, $floors:expr, $method:expr;)*}) => {
        match ($spec.name.as_str(), $spec.map.as_deref(), $spec.q) {
            $(($name $(, $map, $q)?, ..) => $crate::wide::members::order($members, $floors, &$method),)*
            _ => $crate::support::orders::Outcome::Measured(Err("not measured".into())),
        }
    };
}
pub(crate) use by_name;
