//! Runs by a method that is named: generic in the problem, and compiled for each of the [`types`](super::types).

use core::cell::RefCell;
use std::sync::Arc;

use lieflow::catalog::MethodSpec;
use lieflow::methods::{AnyMethod, Facts, Method, Within};
use lieflow::problems::PointOf;
use lieflow::solve::{Interpolant, Interrupted, LONG_STEPS, Solution};
use lieflow::space::Numbers;
use lieflow::{Error, Event, RunError, Solve};

use super::following::{Followed, following};
use super::{
    CurvePlace, EventPlan, Fit, Orders, Outcome, Plan, RowCurve, RowsOf, Runnable, SharedRowOf,
    Steps, Watcher,
};
use crate::schema::{Branches, Schema};

/// The rows of a run of this type of problem at all times.
struct CurveOf<P: Runnable> {
    points: Interpolant<'static, P, AnyMethod<'static, P>>,
    row_of: Box<SharedRowOf<P>>,
    branches: Branches,
}

impl<P: Runnable> RowCurve for CurveOf<P> {
    fn t_span(&self) -> [f64; 2] {
        self.points.t_span()
    }
    fn steps(&self) -> usize {
        self.points.steps()
    }
    fn rows(&self, times: &[f64], values: &mut Vec<f64>) -> Result<(), (usize, RunError)> {
        let mut reader = self.points.reader().map_err(|error| (0, error.into()))?;
        for (i, &t) in times.iter().enumerate() {
            let row = values.len();
            (self.row_of)(t, reader.at(t).map_err(|error| (i, error))?, values);
            self.branches.follow_known(t, &mut values[row..]);
        }
        Ok(())
    }
    /// The numbers of the points, those of the choices, and the number of choices.
    fn numbers(&self) -> Vec<f64> {
        let (mut numbers, choices) = (self.points.numbers(), self.branches.numbers());
        numbers.extend_from_slice(&choices);
        numbers.push(choices.len() as f64);
        numbers
    }
}

/// The curve of these numbers. `shared` makes the values of its rows, for a run that starts at a time.
///
/// # Errors
/// As [`MethodsByName::method`] and [`Interpolant::from_numbers`].
pub(super) fn curve_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &Arc<P>,
    like: &PointOf<P>,
    numbers: &[f64],
    schema: &Schema,
    shared: &dyn Fn(f64) -> Box<SharedRowOf<P>>,
) -> Result<Box<dyn RowCurve>, Error> {
    let method = Arc::new(problem.method(spec)?);
    let (choices, numbers) = numbers
        .split_last()
        .map_or((0, numbers), |(&choices, numbers)| (choices as usize, numbers));
    let (numbers, choices) = numbers.split_at(numbers.len().saturating_sub(choices));
    let points = Interpolant::from_numbers(problem.clone(), method, like, numbers)?;
    let mut branches = Branches::new(schema, points.t_span());
    branches.set_numbers(choices);
    let row_of = shared(points.t_span()[0]);
    Ok(Box::new(CurveOf { points, row_of, branches }))
}

/// Integrate `problem` from `y` by the method that `spec` names: see [`Runnable::drive`].
///
/// # Errors
/// As [`MethodsByName::method`] and [`Solve::run`].
pub(super) fn drive_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &Arc<P>,
    y: PointOf<P>,
    plan: Plan<'_>,
    RowsOf { schema, row_of, turn_rate, shared, points: all }: RowsOf<'_, P>,
    watcher: &mut dyn Watcher,
) -> Result<Outcome, RunError> {
    let method = Arc::new(problem.method(spec)?);
    let Plan { steps, save, times_by_steps, stops, .. } = plan;
    let Plan { events, max_steps, cancel, checkpoints, resume, curve, .. } = plan;
    let (watcher, numbers) = (RefCell::new(watcher), RefCell::new(Vec::new()));
    // Why the numbers that an event has set are no point.
    let refused = RefCell::new(None);
    let mut branches = Branches::new(schema, steps.t_span());
    let resume = resume.map(|bytes| branches.take_from(bytes));
    if curve.is_some() {
        branches.keep_all();
    }
    let branches = RefCell::new(branches);
    let followed = RefCell::new(Followed::new(steps.t_span()));
    // What was followed comes before everything else that is seen of a step.
    let follow = || {
        followed.borrow_mut().take(
            |t, numbers| branches.borrow_mut().follow(t, numbers),
            |t, numbers, is_sure| {
                watcher.borrow_mut().followed(t, schema.row(numbers), is_sure);
            },
        );
    };
    let fill = |t: f64, y: &PointOf<P>| {
        follow();
        let mut numbers = numbers.borrow_mut();
        numbers.clear();
        row_of(t, y, &mut numbers);
        branches.borrow_mut().follow(t, &mut numbers);
    };
    let gap = schema.longest_gap();
    let is_long = method.facts(problem).order >= LONG_STEPS;
    let [t0, t1] = steps.t_span();
    let mut solve = Solve::shared(problem.clone(), method, steps.t_span()).save(save).stops(stops);
    solve = match steps {
        Steps::Equal(grid) => solve.grid(grid),
        Steps::ByError { control, .. } => solve.control(match gap {
            Some(gap) if gap < control.longest_step() => {
                control.clone().max_step(gap).unwrap_or(control)
            }
            _ => control,
        }),
    };
    if times_by_steps {
        solve = solve.times_by_steps();
    }
    if let Some(attempts) = max_steps {
        solve = solve.max_steps(attempts);
    }
    if let Some(flag) = cancel {
        solve = solve.cancel(flag);
    }
    if let Some(bytes) = resume {
        solve = solve.resume(bytes);
    }
    if let Some(every) = checkpoints {
        solve = solve.checkpoints(every, |bytes| {
            follow();
            watcher.borrow_mut().state(&branches.borrow().append_to(bytes));
        });
    }
    let (fill, follow, followed, numbers) = (&fill, &follow, &followed, &numbers);
    if !branches.borrow().is_empty() {
        let least = gap.map_or(0.0, |gap| 1.0 / gap);
        let rate = move |t: f64, y: &PointOf<P>| turn_rate(t, y).max(least);
        let begin = |at| {
            follow();
            followed.borrow_mut().begin(at);
        };
        let look = |at: [f64; 2], y: &PointOf<P>| {
            followed.borrow_mut().add(at, |row| row_of(at[0], y, row));
        };
        solve = solve.event(following(begin, look, rate, [t1 > t0, is_long]));
    }
    for (index, event) in events.into_iter().enumerate() {
        let EventPlan { name, value, direction, stop_after, points, change, .. } = event;
        let (watcher, branches, changes) = (&watcher, &branches, change.is_some());
        let refused = &refused;
        let mut event = Event::new(name, move |t, y: &PointOf<P>| {
            fill(t, y);
            value(t, schema.row(&numbers.borrow()))
        })
        .direction(direction)
        .tell(move |t, y, rising| {
            fill(t, y);
            let numbers = numbers.borrow();
            if changes {
                branches.borrow_mut().cut(t, &numbers);
            }
            watcher.borrow_mut().event(index, t, rising, schema.row(&numbers));
        });
        if let Some(count) = stop_after {
            event = event.stop_after(count);
        }
        if let Some(points) = points {
            event = event.points(points);
        }
        if let Some(mut change) = change {
            event = event.change(move |t, y| {
                let mut numbers = all.numbers_of(t, y);
                // A run may have left M, by the errors of its steps.
                let was_on_m = (all.point)(&numbers, y).is_ok();
                change(t, &mut numbers);
                if let Err(error) = (all.point)(&numbers, y)
                    && was_on_m
                {
                    // No point: the run ends with it.
                    refused.replace(Some(error));
                    y.each_number(&mut |x| *x = f64::NAN);
                }
            });
        }
        solve = solve.event(event);
    }
    let solve = solve.progress(|t| watcher.borrow_mut().progress(t)).ends_of_steps(|t, y| {
        fill(t, y);
        watcher.borrow_mut().end_of_step(t, schema.row(&numbers.borrow()));
    });
    let see = |t: f64, y: &mut PointOf<P>| {
        fill(t, y);
        watcher.borrow_mut().row(t, schema.row(&numbers.borrow()))
    };
    let done = match curve {
        None => solve.run_with(y, see),
        Some(CurvePlace(place)) => {
            let (done, points) = solve.run_interpolant_with(y, see);
            follow();
            *place = points.into_shared().map(|points| {
                let branches = branches.borrow().clone().of_run();
                Box::new(CurveOf { points, row_of: shared(), branches }) as Box<dyn RowCurve>
            });
            done
        }
    };
    let end = match &done {
        Ok(done) => Some(done),
        Err(Interrupted { solution, .. }) => solution.as_deref(),
    };
    if let Some(end) = end {
        fill(end.t, &end.y);
        let (state, row) = (all.numbers_of(end.t, &end.y), numbers.borrow());
        watcher.borrow_mut().end(end.t, &state, schema.row(&row), &end.stats);
    }
    let done = done.map_err(|stopped| match (RunError::from(stopped), refused.take()) {
        (RunError::Changed { by, t, .. }, Some(source)) => RunError::Changed { by, t, source },
        (error, _) => error,
    });
    let Solution { t, y, status, stats, .. } = done?;
    Ok(Outcome { t, status, stats, state: all.numbers_of(t, &y), row: numbers.take() })
}

/// The orders of the method that `spec` names: see [`Runnable::orders`].
///
/// # Errors
/// As [`MethodsByName::method`].
pub(super) fn orders_by<P: Runnable>(spec: &MethodSpec, problem: &P) -> Result<Orders, Error> {
    let method = problem.method(spec)?;
    let Facts { order, dense_order, stays_on_manifold, .. } = method.facts(problem);
    let step = (order != usize::MAX).then_some(order);
    Ok(Orders { step, within: dense_order, stays_on_manifold })
}

/// Can the method that `spec` names run on the problem? See [`Runnable::fits`].
///
/// # Errors
/// The reason why it cannot.
pub(super) fn fits_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &P,
    y: &PointOf<P>,
) -> Result<Fit, Error> {
    let method = problem.method(spec)?;
    let keeps_points = method.within(&method.work(problem, y)?) != Within::Steps;
    Ok(Fit { keeps_points: [keeps_points, keeps_points && method.has_pair(problem)] })
}
