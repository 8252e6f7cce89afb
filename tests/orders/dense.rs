//! The points within a step, of every method of the catalog: the order of their error, that they lie on M and meet
//! the step at its end, after a plain step and after one with an estimate.

use crate::support::gap;
use crate::support::named::{self, Named};
use crate::support::orders::{MEMBERS, clocks, flow, in_units_of_one, specs, start, wave, waves};
use crate::support::points::Points;
use crate::support::represent::Represent;
use crate::support::systems;
use faer::{Mat, Scale};
use lieflow::actions::{Coadjoint, LeftTranslation};
use lieflow::catalog::Needs;
use lieflow::groups::{LieGroup, MatrixGroup, Sample, Se3, So3};
use lieflow::maps::Exp;
use lieflow::methods::tableau::{DOP853, DOPRI5, Dense, RK4, Row};
use lieflow::methods::{AnyMethod, Embedded, Facts, Rk, Rkmk, Tableau};
use lieflow::problems::{Ambient, PointOf, Problem, RigidBody, RigidBodyAttitude, RigidBodyState};
use lieflow::{Action, Error, LieAlgebra, Method, SaveAt, Step, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// The start of every step: not 0, so that a dropped t shows.
const T0: f64 = 0.3;
/// Where the points are looked at: in both halves of the step.
const PARTS: [f64; 3] = [0.15, 0.45, 0.8];
/// Step sizes from the largest on, the same for every method.
const SIZES: usize = 22;
const RATIO: f64 = 0.85;
/// Errors outside are not asymptotic, or rounding.
const WINDOW: core::ops::Range<f64> = 2e-14..1e-2;
/// A slope is that of the straight line through so many errors, the last in the window.
const POINTS: usize = 5;
/// It may be so much below the order that is claimed, and one more.
const TOLERANCE: f64 = 0.2;
/// From this order on a method may have too few errors in the window.
const HIGH: usize = 8;
/// Rounding of a few products in points of size 1.
const ROUNDING: f64 = 2e-14;
/// The length of a momentum on so(n)* after an implicit step: that ends when changes of at most 64 ε‖𝟙‖ no longer shrink, and
/// the residual is that of a square; n ≤ 5.
const OF_ITERATION: f64 = 2.0 * 64.0 * f64::EPSILON * 2.24;
/// The same with the ends of nine iterations.
const END: f64 = 5e-14;

/// Problems with their starts, and the points where each step should pass: by size, by part.
struct Steps<P: Problem> {
    largest: f64,
    /// How far points of implicit steps may be from M.
    off_implicit: f64,
    members: Vec<(P, PointOf<P>)>,
    exact: Vec<Vec<[Mat<f64>; PARTS.len()]>>,
}

/// The line through (log h, log e): its slope.
fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    let n = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (top, bottom) = logs.iter().fold((0.0, 0.0), |(top, bottom), (u, v)| {
        (top + (u - x) * (v - y), bottom + (u - x) * (u - x))
    });
    top / bottom
}

impl<P: Ambient> Steps<P>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
{
    fn new(largest: f64, make: impl Fn(u64) -> (P, PointOf<P>)) -> Self {
        let members: Vec<_> = (0..MEMBERS).map(make).collect();
        let exact = |(problem, start): &(P, PointOf<P>)| {
            let after = |time: f64| {
                let mut y = start.clone();
                let grid = TimeGrid::with_steps([T0, T0 + time], 12).expect("a grid");
                integrate(problem, &Rk(DOP853), &grid, &SaveAt::Ends, &mut y, |_, _| {})
                    .expect("a run");
                problem.action().numbers(problem.group(), &y)
            };
            (0..SIZES)
                .map(|i| PARTS.map(|part| after(part * largest * RATIO.powi(i as i32))))
                .collect()
        };
        let off_implicit = ROUNDING;
        Steps { largest, off_implicit, exact: members.iter().map(exact).collect(), members }
    }

    fn size(&self, i: usize) -> f64 {
        self.largest * RATIO.powi(i as i32)
    }

    /// Is `at` on M?
    fn on_the_manifold(&self, (problem, start): &(P, PointOf<P>), at: &PointOf<P>) -> f64 {
        let (action, group) = (problem.action(), problem.group());
        let mut copy = at.clone();
        let found = action.restore_to(group, start, &mut copy, &mut action.work(group));
        found.unwrap_or(0.0)
    }

    /// The slopes of the error at each part, and what is wrong otherwise.
    ///
    /// # Errors
    /// What does not hold.
    fn check<'p>(&self, method: &Named<'p, P>) -> Result<String, String>
    where
        P: 'p,
    {
        let problem = &self.members[0].0;
        let Facts { order, dense_order: dense, .. } = method.facts(problem);
        if dense < order.saturating_sub(1).min(5) || dense > order {
            return Err(format!("dense order {dense} of a method of order {order}"));
        }
        let mut errors: Vec<Vec<(f64, f64)>> = vec![Vec::new(); PARTS.len()];
        for i in 0..SIZES {
            match self.errors(method, i)? {
                Some(found) => {
                    for (errors, e) in errors.iter_mut().zip(found) {
                        errors.push((self.size(i), e));
                    }
                }
                None if i < 8 => {} // far too large a step
                None => return Err(format!("no step of size {}", self.size(i))),
            }
        }
        let mut text = format!("{order}, {dense}:");
        for (part, errors) in PARTS.iter().zip(errors) {
            let seen: Vec<_> = errors.iter().copied().filter(|(_, e)| WINDOW.contains(e)).collect();
            if dense >= HIGH && seen.len() < POINTS {
                let last = errors[errors.len() - 1].1;
                if last > ROUNDING {
                    return Err(format!("the error at {part} is {last:e}"));
                }
                continue;
            }
            if seen.len() < POINTS {
                return Err(format!("too few errors: {errors:?}"));
            }
            let found = slope(&seen[seen.len() - POINTS..]);
            text += &format!(" {found:.2}");
            if found.is_nan() || found < dense as f64 + 1.0 - TOLERANCE {
                return Err(format!(
                    "order {dense}, the error at {part} falls as h^{found:.2}: {seen:?}"
                ));
            }
        }
        Ok(text)
    }

    /// The geometric means over the members of the errors at each part of the step of this number.
    fn errors<'p>(
        &self,
        method: &Named<'p, P>,
        i: usize,
    ) -> Result<Option<[f64; PARTS.len()]>, String>
    where
        P: 'p,
    {
        let mut logs = [0.0; PARTS.len()];
        for (member, exact) in self.members.iter().zip(&self.exact) {
            let (problem, from) = member;
            let numbers = |y: &PointOf<P>| problem.action().numbers(problem.group(), y);
            let (mut to, mut at) = (from.clone(), from.clone());
            let mut work = method.work(problem, from).map_err(|e| e.to_string())?;
            let step = Step { n: 3, t: T0, h: self.size(i) };
            if method.step(problem, step, &mut to, &mut work).is_err()
                || method.prepare(problem, step, from, &to, &mut work).is_err()
            {
                return Ok(None);
            }
            let mut points = Vec::new();
            for (j, part) in PARTS.into_iter().enumerate() {
                if method.interpolate(problem, step, part, from, &mut work, &mut at).is_err() {
                    return Ok(None);
                }
                let found = numbers(&at);
                logs[j] += (gap(&found, &exact[i][j]) / exact[i][j].norm_l2()).ln();
                let off = self.on_the_manifold(member, &at);
                let facts = method.facts(problem);
                let is_implicit = facts.step.evaluations.is_none();
                let most = if is_implicit { self.off_implicit } else { ROUNDING };
                if facts.stays_on_manifold && (off.is_nan() || off > most) {
                    return Err(format!("{off:e} off M at {part} of {}", self.size(i)));
                }
                points.push(found);
            }
            let meets = |work: &mut _, at: &mut _, to: &PointOf<P>, step| {
                method
                    .interpolate(problem, step, 1.0 - f64::EPSILON, from, work, at)
                    .map_err(|e: lieflow::StepError| e.to_string())?;
                let to = numbers(to);
                let apart = gap(&numbers(at), &to) / to.norm_l2();
                match apart < END {
                    true => Ok(()),
                    false => Err(format!("{apart:e} from the end of a step of {}", step.h)),
                }
            };
            meets(&mut work, &mut at, &to, step)?;
            // After a step with its error: the same where the method has a pair, else that of two halves.
            let tolerance = in_units_of_one();
            if method.step_with_error(problem, step, &tolerance, from, &mut work, &mut to).is_err()
            {
                continue;
            }
            method.prepare(problem, step, from, &to, &mut work).map_err(|e| e.to_string())?;
            meets(&mut work, &mut at, &to, step)?;
            if method.has_pair(problem) {
                for (part, point) in PARTS.into_iter().zip(&points) {
                    method
                        .interpolate(problem, step, part, from, &mut work, &mut at)
                        .map_err(|e| e.to_string())?;
                    if gap(&numbers(&at), point) > ROUNDING * point.norm_l2() {
                        return Err(format!("another point at {part} after a step with its error"));
                    }
                }
            }
        }
        Ok(Some(logs.map(|sum| (sum / self.members.len() as f64).exp())))
    }
}

/// Every method of these lists, made by one of the functions of [`named`]; each is measured with one map at least.
macro_rules! every_method {
    ($family:ident, $title:expr, $needs:expr, $steps:expr) => {{
        let (steps, mut wrong, mut measured) = ($steps, Vec::new(), Vec::new());
        for spec in specs(&$needs) {
            let label = spec.label();
            match named::$family(&spec, |method| {
                let fits = method.work(&steps.members[0].0, &steps.members[0].1).is_ok();
                fits.then(|| steps.check(method))
            }) {
                Err(Error::Unsupported { .. }) | Ok(None) => continue,
                Ok(Some(Ok(found))) => println!("{} {label:<30} {found}", $title),
                Ok(Some(Err(reason))) => wrong.push(format!("{} {label}: {reason}", $title)),
                Err(other) => panic!("{label}: {other}"),
            }
            measured.push(spec.name);
        }
        for info in $needs.iter().flat_map(|needs| needs.methods()) {
            assert!(
                measured.iter().any(|name| name == info.name),
                "{} was not measured",
                info.name
            );
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }};
}

/// Problems on a group that differ in their coefficients, from 𝟙.
macro_rules! translations {
    ($group:expr, $field:expr) => {
        Steps::new(0.8, |i| {
            let flow = flow($group, LeftTranslation, $field(i));
            let start = flow.group().identity();
            (flow, start)
        })
    };
}

const FIELDS: [Needs; 2] = [Needs::Field, Needs::Norm];

#[test]
fn fields_on_so3() {
    every_method!(field, "SO(3)", FIELDS, translations!(So3::new(), waves(3, 0.5, 11)));
}

#[test]
fn fields_on_sp4() {
    let group = MatrixGroup::sp(4).expect("a group");
    every_method!(field, "Sp(4)", FIELDS, translations!(group.clone(), waves(4, 0.25, 12)));
}

#[test]
fn fields_on_orbits_of_se3() {
    let make = |i: u64| {
        let flow = flow(Se3::new(), Coadjoint, wave(4, 0.3, 22 + 100 * i));
        let start = start(&flow, 7 + i);
        (flow, start)
    };
    every_method!(explicit, "orbits of SE(3)", [Needs::Field], Steps::new(0.8, make));
}

#[test]
fn fields_of_linear_type_on_so5() {
    let group = MatrixGroup::so(5).expect("a group");
    let steps = translations!(group.clone(), clocks(5, 1.0));
    every_method!(linear, "SO(5)", [Needs::LinearType], steps);
}

/// Momenta of length 2 that are nothing special.
fn momentum(i: u64) -> Vector3<f64> {
    let mut rng = Pcg64::seed_from_u64(40 + i);
    let mut entry = || rng.random_range(0.3..1.0);
    Vector3::new(entry(), entry(), -entry()).normalize() * 2.0
}
const INERTIA: [f64; 3] = [1.0, 2.0, 3.5];

#[test]
fn attitudes_of_bodies() {
    let steps = Steps::new(0.8, |i| {
        let body = RigidBodyAttitude::new(INERTIA, momentum(i).into()).expect("a body");
        (body, Matrix3::identity())
    });
    let needs = [Needs::Series, Needs::Body, Needs::Attitude];
    every_method!(attitude, "attitude", needs, steps);
}

#[test]
fn momenta_of_bodies() {
    let steps = Steps::new(1.6, |i| (RigidBody::new(INERTIA).expect("a body"), momentum(i)));
    let needs = [Needs::Series, Needs::Body, Needs::Momentum, Needs::LiePoisson];
    every_method!(momentum, "momentum", needs, steps);
}

#[test]
fn momenta_with_attitudes() {
    let steps = Steps::new(0.8, |i| {
        let body = RigidBodyState::new(INERTIA).expect("a body");
        (body, body.state(momentum(i).into(), Matrix3::identity()).expect("a state"))
    });
    every_method!(state, "state", [Needs::State], steps);
}

#[test]
fn quadratic_systems() {
    for (group, start) in systems::systems().into_iter().take(2) {
        let name = group.name();
        let make = |i| {
            let aside = group.sample_algebra(&mut Pcg64::seed_from_u64(60 + i), 1.0);
            let m = &start + Scale(0.4 / group.norm(&aside)) * aside.into_mat();
            let length = if name == "SO(5)" { 1.5 } else { 0.7 } / m.norm_l2();
            (systems::quadratic(group.clone()), m * Scale(length))
        };
        let needs = [Needs::Series, Needs::LiePoisson, Needs::Isospectral];
        let title = format!("momenta, {name}");
        let steps = Steps { off_implicit: OF_ITERATION, ..Steps::new(1.2, make) };
        every_method!(lie_poisson, title, needs, steps);
    }
}

#[test]
fn a_wrong_extension_is_seen() {
    const WRONG_ROW: &[Row] = &[Row { stages: &[-1.0], extra: &[1.0] }];
    const RAISED: &[f64] = &[0.0, 0.0, 0.0, 1.0];
    let steps = translations!(So3::new(), waves(3, 0.5, 11));
    let check = |dense, on: Tableau<7>| {
        let method = AnyMethod::embedded(Rkmk::new(Tableau { dense, ..on }, Exp));
        steps.check(&method)
    };
    let four = Tableau { error: DOPRI5.error, ..RK4.padded() };
    let raised = |order, rows| Dense::Raised { order, stages: &[], rows };
    assert!(check(DOPRI5.dense, DOPRI5).is_ok() && check(RK4.dense, four).is_ok());
    for (dense, on, what) in [
        (raised(4, WRONG_ROW), DOPRI5, "falls as h^"),
        (raised(4, &[]), DOPRI5, "falls as h^"),
        (Dense::Cubic { order: 3, end: &[0.0, 0.0, 1.0] }, four, "falls as h^"),
        (Dense::Cubic { order: 4, end: RAISED }, four, "falls as h^"),
        (Dense::Cubic { order: 2, end: RAISED }, four, "dense order 2"),
    ] {
        let reason = check(dense, on).expect_err("a fault");
        assert!(reason.contains(what), "{reason}");
    }
}
