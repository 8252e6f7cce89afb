//! What the driver does with the error of a step, and what it promises a method: by a method that is told its error,
//! and writes down what it was asked.

use std::cell::{Cell, RefCell};

use lieflow::actions::LeftTranslation;
use lieflow::groups::Translations;
use lieflow::methods::magnus::Magnus8;
use lieflow::methods::tableau::RK4;
use lieflow::methods::{Doubling, Embedded, Facts, Method, Rk, StepCost};
use lieflow::problems::{Problem, amplitudes, schrodinger};
use lieflow::solve::Next;
use lieflow::tolerance::Tolerance;
use lieflow::{Error, Event, Integrator, RunError, Solve, Step, StepError};

use crate::modes::{Pace, V, every_mode};
use crate::scipy::free;
use crate::support::boxed::boxed_of_time;

/// ẋ = 1.
fn moving() -> impl Problem<Group = Translations<V>, Action = LeftTranslation> {
    boxed_of_time(free(), LeftTranslation, |_: f64, v: &mut V| *v = V::x())
}

/// An attempt: t, h and the ratio of its error to its tolerance, none where it failed.
type Attempt = (f64, f64, Option<f64>);

/// A method whose error is told, with a workspace that knows what it was last used for.
struct Told<R> {
    /// The ratio of a step from t with size h.
    ratio: R,
    order: usize,
    attempts: RefCell<Vec<Attempt>>,
    prepared: Cell<u32>,
    looked_at: Cell<u32>,
}

/// The last step, from where it went and where it ended, and whether the point between is ready.
#[derive(Default)]
struct Memory {
    last: Option<(Step<f64>, V, V)>,
    ready: bool,
}

fn told<R: Fn(f64, f64) -> Option<f64>>(order: usize, ratio: R) -> Told<R> {
    let (attempts, prepared, looked_at) = Default::default();
    Told { ratio, order, attempts, prepared, looked_at }
}

impl<R, P> Method<P> for Told<R>
where
    P: Problem<Group = Translations<V>, Action = LeftTranslation>,
    R: Fn(f64, f64) -> Option<f64>,
{
    type Work = Memory;

    fn facts(&self, _: &P) -> Facts {
        Facts {
            step: StepCost { evaluations: Some(7), maps: None },
            step_with_error: StepCost { evaluations: Some(9), maps: None },
            error_order: Some(self.order),
            dense_evaluations: [Some(100), Some(10_000)],
            ..Facts::of_order(self.order)
        }
    }
    fn work(&self, _: &P, _: &V) -> Result<Memory, Error> {
        Ok(Memory::default())
    }
    fn step(&self, _: &P, step: Step<f64>, y: &mut V, work: &mut Memory) -> Result<(), StepError> {
        let from = *y;
        *y += V::x() * step.h;
        *work = Memory { last: Some((step, from, *y)), ready: false };
        Ok(())
    }
    fn prepare(
        &self,
        _: &P,
        step: Step<f64>,
        from: &V,
        to: &V,
        work: &mut Memory,
    ) -> Result<(), StepError> {
        assert_eq!(
            work.last,
            Some((step, *from, *to)),
            "prepared for another step than the last one"
        );
        assert!(!work.ready, "prepared twice");
        work.ready = true;
        self.prepared.set(self.prepared.get() + 1);
        Ok(())
    }
    fn interpolate(
        &self,
        _: &P,
        step: Step<f64>,
        theta: f64,
        from: &V,
        work: &mut Memory,
        at: &mut V,
    ) -> Result<(), StepError> {
        let known = work.last.expect("a step");
        assert!(
            work.ready && (known.0, known.1) == (step, *from),
            "looked into what was not prepared"
        );
        assert!(theta > 0.0 && theta < 1.0, "{theta}");
        *at = from + theta * (known.2 - from);
        self.looked_at.set(self.looked_at.get() + 1);
        Ok(())
    }
}

impl<R, P> Embedded<P> for Told<R>
where
    P: Problem<Group = Translations<V>, Action = LeftTranslation>,
    R: Fn(f64, f64) -> Option<f64>,
{
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<f64>,
        _: &Tolerance,
        from: &V,
        work: &mut Memory,
        to: &mut V,
    ) -> Result<f64, StepError> {
        let ratio = (self.ratio)(step.t, step.h);
        self.attempts.borrow_mut().push((step.t, step.h, ratio));
        *to = *from;
        self.step(problem, step, to, work)?;
        ratio.ok_or(StepError::NonFiniteRhs { stage: 0 })
    }
}

/// The attempts of a run over [0, 100] from a first step of 1, which is none of them.
fn attempts<R: Fn(f64, f64) -> Option<f64>>(
    order: usize,
    ratio: R,
) -> (Vec<Attempt>, Result<(), RunError>) {
    let (problem, method) = (moving(), told(order, ratio));
    let run = Solve::new(&problem, &method, [0.0, 100.0])
        .tolerances(1e-6, 1e-6)
        .first_step(1.0)
        .run(V::zeros());
    (method.attempts.take(), run.map(drop).map_err(RunError::from))
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-12, "{found}, expected {expected}");
}

/// Up to 1 an error is accepted, above it is not.
#[test]
fn a_ratio_of_one_is_the_limit() {
    for (ratio, accepted) in
        [(1.0 + 1e-15, false), (1.0, true), (1.5, false), (2.9, false), (0.99, true), (0.0, true)]
    {
        let (seen, _) = attempts(4, |t, h| Some(if t == 0.0 && h == 1.0 { ratio } else { 0.5 }));
        assert_eq!(seen[1].0 > 0.0, accepted, "{ratio}: {seen:?}");
    }
    // An error that is no number is none of them.
    for bad in [f64::NAN, f64::INFINITY] {
        let (seen, _) = attempts(4, |t, h| Some(if t == 0.0 && h == 1.0 { bad } else { 0.5 }));
        assert_eq!((seen[1].0, seen[1].1), (0.0, 0.5), "{bad}: it is halved");
    }
}

/// With ĥ = h·r^(−1/k), k = the order of the estimate + 1: h where it is between 0.6ĥ and 0.85ĥ, else 0.7ĥ, and
/// h·(0.7ĥ/h)^0.7 if that is larger, within a factor of 5.
#[test]
fn the_next_step() {
    for order in [2usize, 4, 7, 16] {
        let k = order as f64 + 1.0;
        let sizes = [0.61, 0.59, 0.84, 0.86, 0.7, 0.99, 0.3, 0.62, 1e-3, 0.8, 0.999];
        let n = Cell::new(0);
        let (seen, _) = attempts(order, |_, _| {
            n.set(n.get() + 1);
            Some(f64::powf(sizes[(n.get() - 1) % sizes.len()], k))
        });
        let (mut kept, mut changed) = (0, 0);
        for (pair, size) in seen.windows(2).zip(sizes) {
            let factor = match (0.6..=0.85).contains(&size) {
                true => 1.0,
                false if size < 0.7 => f64::powf(0.7 / size, 0.7).min(5.0),
                false => f64::max(0.7 / size, 0.2),
            };
            if pair[1].0 + 2.0 * pair[1].1 < 100.0 {
                near(pair[1].1, (pair[1].0 - pair[0].0) * factor);
                kept += u32::from(factor == 1.0);
                changed += u32::from(factor != 1.0);
            }
            near(pair[1].0, pair[0].0 + pair[0].1);
        }
        assert!(kept >= 5 && changed >= 5, "{kept}, {changed}: {seen:?}");
    }
    // Without an error a step grows by the largest factor.
    let (seen, _) = attempts(16, |_, _| Some(0.0));
    near(seen[1].1, 5.0);
}

/// h·max(1/5, min(0.9, 0.7·r^(−1/k))) after a rejection, and then no growth in the next step; half after a failure.
#[test]
fn after_a_rejection() {
    for order in [2usize, 4, 7] {
        let k = order as f64 + 1.0;
        for ratio in [1.01, 1.3, 3.0, 40.0, 1e9] {
            let (seen, _) =
                attempts(order, |t, h| Some(if t == 0.0 && h == 1.0 { ratio } else { 1e-3 }));
            near(seen[1].1, (0.7 * f64::powf(ratio, -1.0 / k)).clamp(0.2, 0.9));
            near(seen[2].1, seen[1].1);
            assert!(seen[3].1 > 1.1 * seen[2].1, "then it grows again: {seen:?}");
        }
    }
    // A step fails beyond t = 3.3, and is too long from t = 2 on: it is halved, and then made shorter, and no
    // longer again until t has passed the end of what failed.
    let (seen, end) = attempts(4, |t, h| match (t, h) {
        _ if t < 3.0 && t + h > 3.3 => None,
        _ if (2.0..3.3).contains(&t) && h > 0.1 => Some(1e5),
        _ => Some(1e-6),
    });
    end.expect("the end");
    for pair in seen.windows(2) {
        if pair[0].2.is_none() {
            assert_eq!(pair[1].0, pair[0].0, "no result of a failed step is used");
            near(pair[1].1, 0.5 * pair[0].1);
        }
    }
    let failed = seen.iter().rfind(|attempt| attempt.2.is_none());
    let &(t, h, _) = failed.expect("one that failed");
    let closing: Vec<f64> =
        seen.iter().filter(|at| at.0 >= t && at.0 + 1e-12 < t + h).map(|at| at.1).collect();
    let no_growth = closing.windows(2).all(|h| h[1] <= h[0] * (1.0 + 1e-12));
    assert!(no_growth && closing.len() > 5, "before {}: {closing:?}", t + h);
}

/// The largest step was kept from step to step until an attempt of its size was rejected.
#[test]
fn a_size_that_is_kept_is_counted() {
    let problem = moving();
    let method = told(4, |t, h| Some(if t >= 3.0 && h > 0.9 { 3.0 } else { f64::powi(0.7, 5) }));
    let solve = Solve::new(&problem, &method, [0.0, 100.0]).tolerances(1e-6, 1e-6).first_step(1.0);
    let stats = solve.run(V::zeros()).expect("a run").stats;
    assert_eq!(stats.rejected, 1);
    assert!((stats.largest_step - 1.0).abs() < 1e-12, "{}", stats.largest_step);
    assert!(stats.smallest_step < 0.57, "{}", stats.smallest_step);
}

/// What never succeeds ends: 60 rejections in a row, or fewer where t has no room.
#[test]
fn what_never_succeeds() {
    for (ratio, last) in [(Some(2.0), None), (None, Some(StepError::NonFiniteRhs { stage: 0 }))] {
        let (seen, end) = attempts(4, |t, _| if t < 1.0 { Some(0.5) } else { ratio });
        match end.expect_err("no end") {
            RunError::StepSizeUnderflow { t, rejected, accepted, source, h } => {
                assert!((1.0..100.0).contains(&t) && h > 0.0 && source == last, "{source:?}");
                assert!(rejected <= 60 && rejected + accepted == seen.len() as u64, "{rejected}");
            }
            other => panic!("{other}"),
        }
    }
    // Next to t = 0 there is always room: exactly 60.
    let (seen, end) = attempts(4, |_, _| None);
    assert!(
        matches!(end, Err(RunError::StepSizeUnderflow { rejected: 60, accepted: 0, .. })),
        "{end:?}"
    );
    assert_eq!(seen.len(), 60);
    near(seen[59].1, 0.5f64.powi(59));
}

/// The last steps share what is left; one that comes within a hundredth of the end goes there.
#[test]
fn the_way_to_the_end() {
    let problem = moving();
    let sizes_with = |ratio: f64, span: f64, most: f64, first: f64| {
        let method = told(4, move |_, _| Some(ratio));
        let run = Solve::new(&problem, &method, [0.0, span])
            .tolerances(1e-6, 1e-6)
            .max_step(most)
            .first_step(first);
        let run = run.run(V::zeros()).expect("a run");
        assert_eq!(run.t, span);
        method.attempts.take().iter().map(|attempt| attempt.1).collect::<Vec<_>>()
    };
    let sizes = |span: f64, most: f64, first: f64| sizes_with(0.05, span, most, first);
    assert_eq!(sizes(3.5, 1.0, 1.0), [1.0, 1.0, 0.75, 0.75]);
    assert_eq!(sizes(3.0, 1.0, 1.0), [1.0, 1.0, 1.0]);
    assert_eq!(sizes(1.5, 1.0, 1.0), [0.75, 0.75]);
    assert_eq!(sizes(0.25, 1.0, 1.0), [0.25]);
    // Stretched by a hundredth, but not beyond the largest step.
    assert_eq!(sizes(1.009, 2.0, 1.0), [1.009]);
    assert_eq!(sizes(1.011, 2.0, 1.0), [0.5055, 0.5055]);
    assert_eq!(sizes(1.009, 1.0, 1.0).len(), 2);
    // Half the way is done twice, however near its limit the error is.
    assert_eq!(sizes_with(0.99, 1.5, 2.0, 1.0), [0.75, 0.75]);
    // A step that was shortened for a stop says nothing against the size before.
    let method = told(4, |_, _| Some(0.3));
    let solve = Solve::new(&problem, &method, [0.0, 100.0]).tolerances(1e-6, 1e-6).first_step(2.0);
    let mut run = solve.integrator(V::zeros()).expect("a run");
    run.advance_to(0.01).expect("a step");
    run.step().expect("a step");
    assert!(run.last_step().h >= 2.0 - 1e-12, "{:?}", run.last_step());
}

/// The first step: Hairer, Nørsett, Wanner I, II.4, with ‖y‖ as the unit, or 1 if it is smaller. h₀ moves by 1/100; then
/// (tolerance/100)^(1/k)/max(‖f‖, √(‖Δf‖/h₀)), at most 100 h₀.
#[test]
fn the_first_step() {
    type Field = fn(f64) -> V;
    let fields: [(Field, f64); 4] = [
        (|t| V::new(2.0, t, 0.0), 100.0),
        (|t| V::new(0.1 + 40.0 * t, 0.0, 0.0), 100.0),
        (|t| V::new((3.0 + t).cos(), t.sin(), 5.0), 1.0),
        (|t| V::new(1.0 + t, 0.0, 0.0), -10.0),
    ];
    for (field, end) in fields {
        let settings = [(1e-6, 1e-9, 4usize, 1e3), (1e-3, 1e-3, 2, 0.1), (0.0, 1e-12, 7, 30.0)];
        for (rtol, atol, order, size) in settings {
            let (start, unit) = (V::repeat(size), |y: V| y.norm().max(1.0));
            let problem =
                boxed_of_time(free(), LeftTranslation, move |t: f64, v: &mut V| *v = field(t));
            let method = told(order, |_, _| Some(0.01));
            let run = Solve::new(&problem, &method, [0.0, end]).tolerances(rtol, atol).run(start);
            run.expect("a run");
            let seen = method.attempts.take();
            let first = field(0.0).norm() / unit(start);
            let h0 = (0.01 / first).min(f64::abs(end));
            near(seen[0].1, h0.copysign(end));
            let moved = start + V::x() * h0.copysign(end);
            let bend = (field(h0.copysign(end)) - field(0.0)).norm() / unit(moved) / h0;
            let rate = first.max(bend.sqrt());
            let h = (0.01 * (atol + rtol)).powf(1.0 / (order as f64 + 1.0)) / rate;
            near(seen[1].1, h.min(100.0 * h0).min(f64::abs(end)).copysign(end));
        }
    }
    // What hardly moves: a millionth of the span, and a hundred times that.
    let problem = boxed_of_time(free(), LeftTranslation, |_: f64, v: &mut V| *v = V::x() * 1e-9);
    let method = told(4, |_, _| Some(0.01));
    let run = Solve::new(&problem, &method, [0.0, 30.0]).tolerances(1e-6, 1e-6).run(V::zeros());
    run.expect("a run");
    let seen = method.attempts.take();
    near(seen[0].1, 30e-6);
    near(seen[1].1, 30e-4);
    // One that was given is taken, whatever f says.
    let (seen, _) = attempts(4, |_, _| Some(0.5));
    assert_eq!(seen[0], (0.0, 1.0, Some(0.5)));
}

#[test]
fn limits() {
    let problem = moving();
    let run = |most: Option<f64>, least: Option<f64>, ratio: fn(f64, f64) -> Option<f64>| {
        let method = told(4, ratio);
        let mut solve =
            Solve::new(&problem, &method, [0.0, 10.0]).tolerances(1e-6, 1e-6).first_step(0.5);
        if let Some(h) = most {
            solve = solve.max_step(h);
        }
        if let Some(h) = least {
            solve = solve.min_step(h);
        }
        let end = solve.max_steps(200).run(V::zeros());
        (method.attempts.take(), end.map(|run| run.stats).map_err(RunError::from))
    };
    let (seen, _) = run(Some(0.7), None, |_, _| Some(1e-9));
    assert!(
        seen.iter().all(|attempt| attempt.1 <= 0.7 + 1e-12)
            && seen.iter().any(|attempt| attempt.1 > 0.7 - 1e-12)
    );
    // An error that is too large at the smallest step ends the run. The last step may be smaller than that.
    let (seen, end) = run(None, Some(0.3), |t, _| Some(if t < 5.0 { 1e-3 } else { 1.1 }));
    assert!(matches!(end, Err(RunError::StepSizeUnderflow { .. })), "{end:?}");
    assert!(seen.iter().all(|attempt| attempt.1 >= 0.3 - 1e-12), "{seen:?}");
    // The smallest size is tried once, where less was asked for.
    let [.., before, last] = seen[..] else { panic!("{seen:?}") };
    assert!((last.1 - 0.3).abs() < 1e-12 && before.1 > 0.301, "{seen:?}");
    let (seen, end) = run(Some(0.9), Some(0.8), |_, _| Some(0.5));
    end.expect("the end");
    assert!(seen[..seen.len() - 2].iter().all(|attempt| attempt.1 >= 0.8 - 1e-12));
    // So many attempts, accepted or not, and no more.
    let (seen, end) = run(Some(0.01), None, |_, h| Some(if h > 0.009_999 { 1.001 } else { 1e-3 }));
    match end {
        Err(RunError::TooManySteps { accepted, rejected, max_steps: 200, .. }) => {
            assert!(accepted + rejected == 200 && seen.len() == 200 && rejected > 0);
        }
        other => panic!("{other:?}"),
    }
    // How far the end still is, in steps of the last size.
    let (_, end) = run(Some(0.01), None, |_, _| Some(0.5));
    let told = end.expect_err("200 steps of 0.01").to_string();
    assert!(
        told.contains("(200 accepted, 0 rejected), the rest is about 800 steps of this size; "),
        "{told}"
    );
    // By hand too, and with steps of one size.
    let rk = Rk(RK4);
    let solve = Solve::new(&problem, &rk, [0.0, 1.0]).dt(0.1).max_steps(3);
    let mut by_hand = solve.integrator(V::zeros()).expect("a run");
    let end = by_hand.advance_to(1.0).map(|_| ());
    assert!(matches!(end, Err(RunError::TooManySteps { accepted: 3, .. })), "{end:?}");
}

/// After a state was set the first step is chosen again, and nothing is remembered of the steps before.
#[test]
fn a_state_that_is_set_begins_anew() {
    let problem = moving();
    let method = told(4, |_, _| Some(1e-3));
    let solve = Solve::new(&problem, &method, [0.0, 1e6]).tolerances(1e-6, 1e-6).first_step(0.5);
    let mut run = solve.integrator(V::zeros()).expect("a run");
    let mut sizes = || {
        let of_steps: Vec<f64> = (0..4)
            .map(|_| {
                run.step().expect("a step");
                run.last_step().h
            })
            .collect();
        run.set_state(&V::zeros()).expect("a state");
        of_steps
    };
    let (first, second) = (sizes(), sizes());
    assert!((first[0] - 0.5).abs() < 1e-12 && first[1] > 1.0 && first[3] > first[2]);
    assert!(
        first.iter().zip(&second).all(|(a, b)| (a - b).abs() < 1e-12 * (1.0 + a)),
        "{first:?} {second:?}"
    );
}

/// A method is asked for a point of its last step, prepared once, at 0 < θ < 1; what it says that it costs is counted.
#[test]
fn what_a_method_is_promised() {
    let problem = moving();
    for pace in [Pace::ByError(1e-6, 1e-6), Pace::Equal(0.21)] {
        for span in [[0.0, 3.0], [3.0, 0.0]] {
            // Rejected now and then: the workspace has seen another step since.
            let method = told(4, |t, h| {
                Some(if h.abs() > 0.4 && (t * 10.0) as i64 % 2 == 0 { 1.5 } else { 0.01 })
            });
            for ran in every_mode(&problem, &method, span, pace, V::zeros()) {
                let (t, y) = ran.end.expect(ran.mode);
                assert!(
                    ran.mode == "a stop" || (y.x - (t - span[0])).abs() < 1e-13,
                    "{}: {y}",
                    ran.mode
                );
            }
            let (prepared, points) = (method.prepared.get(), method.looked_at.get());
            assert!(prepared > 50 && points > 100, "{prepared} {points}");
        }
    }
    // Counted: 9 an attempt, 100 to prepare, 10000 a point; with steps of one size 7 a step.
    for adaptive in [true, false] {
        let method = told(4, |_, _| Some(0.01));
        let solve = Solve::new(&problem, &method, [0.0, 10.0]).times([0.0, 0.3, 0.31, 10.0]);
        let solve = if adaptive {
            solve.tolerances(1e-6, 1e-6).first_step(0.5).max_step(0.5)
        } else {
            solve.dt(0.5)
        };
        let stats = solve.run(V::zeros()).expect("a run").stats;
        let each = if adaptive { 9 } else { 7 };
        assert_eq!((stats.accepted, stats.points_within), (20, 2));
        assert_eq!(stats.evaluations, Some(20 * each + 100 + 2 * 10_000));
        // By a step from the start of the step, taken as the steps of the run are, and nothing to prepare.
        let method = told(4, |_, _| Some(0.01));
        let solve = Solve::new(&problem, &method, [0.0, 10.0]).times([0.3, 0.31]).times_by_steps();
        let solve = if adaptive {
            solve.tolerances(1e-6, 1e-6).first_step(0.5).max_step(0.5)
        } else {
            solve.dt(0.5)
        };
        let stats = solve.run(V::zeros()).expect("a run").stats;
        assert_eq!(stats.evaluations, Some(22 * each));
        assert_eq!((method.prepared.get(), method.looked_at.get()), (0, 0));
        // An event whose sign is the same at every end, and whose slope does not change, is not looked for.
        let method = told(4, |_, _| Some(0.01));
        let g = Cell::new(0);
        let solve =
            Solve::new(&problem, &method, [0.0, 10.0]).event(Event::new("never", |_, y: &V| {
                g.set(g.get() + 1);
                y.x + 5.0
            }));
        let solve = if adaptive {
            solve.tolerances(1e-6, 1e-6).first_step(0.5).max_step(0.5)
        } else {
            solve.dt(0.5)
        };
        let stats = solve.run(V::zeros()).expect("a run").stats;
        assert_eq!(
            (stats.accepted, g.get(), stats.points_within),
            (20, 1 + 20 + 7, 7),
            "the first step alone"
        );
    }
}

/// What is not looked at costs nothing: no point within a step is computed, whatever the output.
#[test]
fn ends_of_steps_are_not_computed() {
    let problem = moving();
    let method = told(4, |_, _| Some(0.01));
    let solve = || {
        Solve::new(&problem, &method, [0.0, 10.0])
            .tolerances(1e-6, 1e-6)
            .first_step(0.5)
            .max_step(0.5)
    };
    let run = solve()
        .every(1)
        .stops([2.1, 7.7])
        .run_with(V::zeros(), |t, _| if t == 2.1 { Next::Changed } else { Next::Continue });
    assert_eq!(run.expect("a run").stats.points_within, 0);
    let kept = solve().run_continuous(V::zeros()).expect("a run");
    assert_eq!(kept.solution.stats.points_within, 0);
    let times: Vec<f64> = kept.solution.times.clone();
    let mut by_hand: Integrator<'_, _, _> = solve().integrator(V::zeros()).expect("a run");
    by_hand.advance_to(10.0).expect("the end");
    assert_eq!((by_hand.stats().points_within, method.prepared.get(), times), (0, 0, vec![10.0]));
}

/// A state that turns fast under a field that changes slowly: the error of a step of order 8 goes below rounding where the
/// step becomes a little smaller.
#[test]
fn errors_that_may_be_rounding_do_not_make_steps_that_are_rejected() -> Result<(), Error> {
    // Landau–Zener, far from the crossing.
    let energies = |t: f64, i: usize, j: usize| match (i, j) {
        (0, 0) => [-t / 2.0, 0.0],
        (1, 1) => [t / 2.0, 0.0],
        _ => [0.3, 0.0],
    };
    let levels = schrodinger(2, energies)?;
    let start = amplitudes(&[[1.0, 0.0], [0.0, 0.0]])?;
    // The last tolerance is below rounding: there an error that is rounding can be too large.
    for (tolerance, most) in [(1e-13, 0.1), (1e-14, 0.1), (1e-15, 0.2)] {
        let method = Doubling(Magnus8);
        let run = Solve::new(&levels, &method, [-2000.0, -1999.0]).tolerances(tolerance, tolerance);
        let stats = run.run(start.clone()).expect("the end").stats;
        let (accepted, rejected) = (stats.accepted, stats.rejected);
        assert!(
            rejected as f64 <= most * accepted as f64,
            "{tolerance:e}: {accepted} accepted, {rejected} rejected"
        );
    }
    Ok(())
}
