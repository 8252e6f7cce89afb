//! What a run shows: the points of the output, events and invariants. Like [`Points`], it knows the types of the
//! problem and method, and the driver calls it through a pointer.

use super::events::{EventFunctions, Events};
use super::interpolant::Piece;
use super::points::{AnyPoints, Place, Points};
use super::solution::{Next, Occurrence};
use super::stats::RunError;
use crate::actions::Action;
use crate::error::{Error, StepError};
use crate::methods::{Attempts, Method, Step, Streak};
use crate::problems::{Invariant, PointOf, Problem};
use crate::space::Metric;

/// A point that a run keeps for its output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Slot {
    /// The point of the output.
    Shown,
    /// The point of the search for zeros.
    Search,
}

/// What a run of any problem and method shows.
pub(super) trait AnyOutput {
    /// The points of the run.
    fn points(&mut self) -> &mut dyn AnyPoints;
    /// [`AnyPoints::attempt`]; a step in which an event may have a zero is the last attempt.
    fn attempt(
        &mut self,
        step: Step<f64>,
        end: f64,
        streak: &Streak<'_>,
        events: &mut Events,
    ) -> Attempts;
    /// The value of the event with this number at a point, or at y.
    fn event(&mut self, event: usize, t: f64, at: Option<Slot>) -> f64;
    /// slot ← the point at a place in the last step.
    fn look(&mut self, place: Place, last: Step<f64>, slot: Slot) -> Result<(), StepError>;
    /// Shows the observer the point of the output.
    fn observe(&mut self, t: f64) -> Next;
    /// Tells the zero of an event, at the point of the output.
    fn tell(&mut self, event: usize, t: f64, rising: bool);
    /// Is the state on the orbit of the run, up to rounding, and the point of the output not?
    fn shows_other_orbit(&mut self) -> bool;
    /// y ← the point of the output.
    fn take_shown(&mut self);
    /// y ← the point of the output, which the observer changed. It must be on M.
    fn take_changed(&mut self) -> Result<(), Error>;
    /// y ← y changed by the event.
    fn change(&mut self, event: usize, t: f64) -> Result<(), Error>;
    /// Shows the end of a step that had rows within it.
    fn see_end(&mut self, t: f64);
    /// Stores the last step with the times at which it began and up to which it is valid, if steps are stored.
    ///
    /// # Errors
    /// Why its polynomial could not be computed, if polynomials are stored.
    fn keep(&mut self, span: [f64; 2], last: Step<f64>) -> Result<(), RunError>;
    /// Lets the last stored step end at t.
    fn cut_kept(&mut self, t: f64);
    /// The invariants, if they are watched.
    fn invariants(&self) -> Vec<Invariant>;
    /// Their values at a point, or at y, with the sizes of their terms.
    fn values(&self, at: Option<Slot>) -> Vec<[f64; 2]>;
}

/// The point in a slot, or the state.
#[inline]
fn point<Y>(slot: Option<Slot>, [state, shown, search]: [&Y; 3]) -> &Y {
    match slot {
        None => state,
        Some(Slot::Shown) => shown,
        Some(Slot::Search) => search,
    }
}

/// The function that gives the invariants of a problem.
pub(super) struct Watch<P: Problem> {
    pub(super) invariants: fn(&P) -> Vec<Invariant>,
    pub(super) values: fn(&P, &PointOf<P>) -> Vec<[f64; 2]>,
}

/// A stored step: the times at which it began and up to which it is valid, the step, and its start.
pub(super) type Kept<Y> = ([f64; 2], Step<f64>, Y);

/// What is kept of the steps.
pub(super) enum Keep<'k, P: Problem> {
    Nothing,
    /// Their starts.
    Starts(&'k mut Vec<Kept<PointOf<P>>>),
    /// Their polynomials.
    Pieces(&'k mut Vec<Piece<P>>),
}

/// What is stored of each step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keeps {
    Nothing,
    /// Its start.
    Starts,
    /// The polynomial of its points.
    Pieces,
}

impl<P: Problem> Keep<'_, P> {
    /// What the driver knows of it.
    pub(super) fn keeps(&self) -> Keeps {
        match self {
            Keep::Nothing => Keeps::Nothing,
            Keep::Starts(_) => Keeps::Starts,
            Keep::Pieces(_) => Keeps::Pieces,
        }
    }
}

/// The function that sees the points of the output.
pub(super) type Observe<'k, Y> = dyn FnMut(f64, &mut Y) -> Next + 'k;

/// The function that sees the ends of steps with rows.
pub(super) type SeeEnd<'a, Y> = Box<dyn FnMut(f64, &Y) + 'a>;

/// What a run shows.
pub(super) struct Output<'a, 'k, P: Problem, M: Method<P>> {
    pub(super) points: Points<'a, P, M>,
    /// The point of the output.
    shown: PointOf<P>,
    /// The point of the search for zeros.
    search: PointOf<P>,
    observe: &'k mut Observe<'k, PointOf<P>>,
    events: Vec<EventFunctions<'a, PointOf<P>>>,
    watch: Option<Watch<P>>,
    see_end: Option<SeeEnd<'a, PointOf<P>>>,
    kept: Keep<'k, P>,
    /// The zeros of events that have no function for them.
    pub(super) occurrences: Vec<Occurrence<PointOf<P>>>,
}

impl<'a, 'k, P: Problem, M: Method<P>> Output<'a, 'k, P, M> {
    pub(super) fn new(
        points: Points<'a, P, M>,
        events: Vec<EventFunctions<'a, PointOf<P>>>,
        (watch, see_end): (Option<Watch<P>>, Option<SeeEnd<'a, PointOf<P>>>),
        kept: Keep<'k, P>,
        observe: &'k mut Observe<'k, PointOf<P>>,
    ) -> Self {
        let [shown, search] = [points.y.clone(), points.y.clone()];
        let occurrences = Vec::new();
        Output { points, shown, search, observe, events, watch, see_end, kept, occurrences }
    }
}

impl<P: Problem, M: Method<P>> AnyOutput for Output<'_, '_, P, M> {
    fn points(&mut self) -> &mut dyn AnyPoints {
        &mut self.points
    }
    fn attempt(
        &mut self,
        step: Step<f64>,
        end: f64,
        streak: &Streak<'_>,
        events: &mut Events,
    ) -> Attempts {
        let Output { points, events: functions, .. } = self;
        if functions.is_empty() || streak.most == 1 {
            return points.attempt_watched(step, end, streak, None);
        }
        if events.search_always() {
            return points.attempt_watched(step, end, &Streak::ONE, None);
        }
        let watch = &mut |span: [f64; 2], y: &PointOf<P>| {
            events.pass(span, functions.iter_mut().map(|event| (event.g)(span[1], y)))
        };
        points.attempt_watched(step, end, streak, Some(watch))
    }
    fn event(&mut self, event: usize, t: f64, at: Option<Slot>) -> f64 {
        let Output { points, shown, search, events, .. } = self;
        (events[event].g)(t, point(at, [&points.y, shown, search]))
    }
    fn look(&mut self, place: Place, last: Step<f64>, slot: Slot) -> Result<(), StepError> {
        match slot {
            Slot::Shown => self.points.look(place, last, &mut self.shown),
            Slot::Search => self.points.look(place, last, &mut self.search),
        }
    }
    fn observe(&mut self, t: f64) -> Next {
        let next = (self.observe)(t, &mut self.shown);
        // Whatever the observer wrote there. A point that owns no memory has one shape.
        let is_lost = match next {
            Next::Continue if core::mem::needs_drop::<PointOf<P>>() => {
                let (problem, shown) = (&*self.points.problem, &self.shown);
                shown.check_sizes("y", &self.points.y).is_err()
                    || problem.action().check(problem.group(), shown).is_err()
            }
            Next::Continue | Next::Changed => false,
            Next::Stop => true,
        };
        if is_lost {
            self.shown = self.points.y.clone();
        }
        next
    }
    fn tell(&mut self, event: usize, t: f64, rising: bool) {
        match &mut self.events[event].told {
            Some(told) => told(t, &self.shown, rising),
            None => self.occurrences.push(Occurrence { event, t, y: self.shown.clone(), rising }),
        }
    }
    fn shows_other_orbit(&mut self) -> bool {
        let Output { points, shown, .. } = self;
        points.leaves_orbit_at(shown)
    }
    fn take_shown(&mut self) {
        let Output { points, shown, .. } = self;
        points.set(shown);
    }
    fn take_changed(&mut self) -> Result<(), Error> {
        let Output { points, shown, .. } = self;
        let changed = points.change_to(shown);
        if changed.is_err() {
            *shown = points.y.clone(); // also its shape
        }
        changed
    }
    fn change(&mut self, event: usize, t: f64) -> Result<(), Error> {
        match &mut self.events[event].change {
            Some(change) => self.points.change(&mut |y| change(t, y)),
            None => Ok(()),
        }
    }
    fn see_end(&mut self, t: f64) {
        if let Some(see) = &mut self.see_end {
            see(t, &self.points.y);
        }
    }
    fn keep(&mut self, span: [f64; 2], last: Step<f64>) -> Result<(), RunError> {
        let Output { points, search, kept, .. } = self;
        match kept {
            Keep::Nothing => {}
            Keep::Starts(kept) => kept.push((span, last, points.from.clone())),
            Keep::Pieces(pieces) => pieces.push(points.record(last, span, search)?),
        }
        Ok(())
    }
    fn cut_kept(&mut self, t: f64) {
        match &mut self.kept {
            Keep::Nothing => {}
            Keep::Starts(kept) => kept.iter_mut().last().into_iter().for_each(|last| last.0[1] = t),
            Keep::Pieces(pieces) => {
                pieces.iter_mut().last().into_iter().for_each(|last| last.cut(t))
            }
        }
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.watch.as_ref().map_or_else(Vec::new, |watch| (watch.invariants)(&self.points.problem))
    }
    fn values(&self, at: Option<Slot>) -> Vec<[f64; 2]> {
        let y = point(at, [&self.points.y, &self.shown, &self.search]);
        let values = |watch: &Watch<P>| (watch.values)(&self.points.problem, y);
        self.watch.as_ref().map_or_else(Vec::new, values)
    }
}
