//! A method behind a pointer. The loops of fixed, adaptive and doubled steps with code of their own for
//! every method would triple what is compiled, and so would finding the method for each of them; a call
//! through a pointer a step is around the step and not inside it. Adaptive runs come here, where it is
//! nothing beside the choice of a step, runs whose operations are counted, and every run of the problems of
//! `kinds/flow.rs`, whose field is behind a pointer already. Steps of one size of a rigid body, which are
//! timed in nanoseconds, do not.

use core::cell::Cell;

use lieflow::catalog::{OnEmbedded, OnMethod};
use lieflow::methods::{Doubling, Embedded, LocalError, Metric};
use lieflow::problems::{PointOf, Problem, ScalarOf};
use lieflow::scalar::Counted;
use lieflow::{Error, Method, Step, StepError};

/// A method, whatever its type.
trait AnyMethod<P: Problem> {
    fn order(&self, problem: &P) -> usize;
    fn evaluations(&self, problem: &P) -> Option<u64>;
    fn stays_on_manifold(&self) -> bool;
    fn error_order(&self, problem: &P) -> Result<usize, Error>;
    fn evaluations_with_error(&self, problem: &P) -> Option<u64>;
    fn stepper<'a>(&'a self, problem: &P, like: &PointOf<P>) -> Result<AnyStepper<'a, P>, Error>;
}

/// A method with its workspace, whatever its type.
pub trait Stepper<P: Problem> {
    /// As [`Method::step`].
    ///
    /// # Errors
    /// As there.
    fn step(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError>;
    /// As [`Embedded::step_with_error`].
    ///
    /// # Errors
    /// As there.
    fn step_with_error(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        to: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError>;
}

type AnyStepper<'a, P> = Box<dyn Stepper<P> + 'a>;

struct Both<'a, P: Problem, M: Method<P>> {
    method: &'a M,
    work: M::Work,
}

impl<P: Problem, M: Embedded<P>> Stepper<P> for Both<'_, P, M> {
    fn step(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        self.method.step(problem, step, y, &mut self.work)
    }
    fn step_with_error(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        to: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError> {
        self.method.step_with_error(problem, step, from, &mut self.work, to)
    }
}

impl<P: Problem + 'static, M: Embedded<P>> AnyMethod<P> for M {
    fn order(&self, problem: &P) -> usize {
        Method::order(self, problem)
    }
    fn evaluations(&self, problem: &P) -> Option<u64> {
        Method::evaluations(self, problem)
    }
    fn stays_on_manifold(&self) -> bool {
        Method::stays_on_manifold(self)
    }
    fn error_order(&self, problem: &P) -> Result<usize, Error> {
        Embedded::error_order(self, problem)
    }
    fn evaluations_with_error(&self, problem: &P) -> Option<u64> {
        Embedded::evaluations_with_error(self, problem)
    }
    fn stepper<'a>(&'a self, problem: &P, like: &PointOf<P>) -> Result<AnyStepper<'a, P>, Error> {
        Ok(Box::new(Both { method: self, work: self.work(problem, like)? }))
    }
}

/// A method that estimates no error, where one that may is asked for: it says so before any step.
struct Plain<'a, M>(&'a M);

impl<P: Problem, M: Method<P>> Method<P> for Plain<'_, M> {
    type Work = M::Work;

    fn order(&self, problem: &P) -> usize {
        self.0.order(problem)
    }
    fn evaluations(&self, problem: &P) -> Option<u64> {
        self.0.evaluations(problem)
    }
    fn stays_on_manifold(&self) -> bool {
        self.0.stays_on_manifold()
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<M::Work, Error> {
        self.0.work(problem, like)
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut M::Work,
    ) -> Result<(), StepError> {
        self.0.step(problem, step, y, work)
    }
}

const ESTIMATE: &str = "an error estimate";

impl<P: Problem, M: Method<P>> Embedded<P> for Plain<'_, M> {
    fn error_order(&self, _: &P) -> Result<usize, Error> {
        let (with, why) = ("this method".into(), "it has none");
        Err(Error::Unsupported { what: ESTIMATE, with, why })
    }
    fn evaluations_with_error(&self, _: &P) -> Option<u64> {
        None
    }
    fn step_with_error(
        &self,
        _: &P,
        _: Step<ScalarOf<P>>,
        _: &PointOf<P>,
        _: &mut M::Work,
        _: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError> {
        Err(StepError::NotFinite { what: ESTIMATE })
    }
}

/// What was counted of the steps of a method.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    operations: Cell<u64>,
    steps: Cell<u64>,
}

impl Tally {
    fn count<T>(&self, step: impl FnOnce() -> T) -> T {
        let (done, operations) = Counted::count(step);
        self.operations.update(|n| n + operations.total());
        self.steps.update(|n| n + 1);
        done
    }
    /// Begin again.
    pub(crate) fn clear(&self) {
        self.operations.set(0);
        self.steps.set(0);
    }
    /// All operations so far.
    pub(crate) fn operations(&self) -> u64 {
        self.operations.get()
    }
    /// Operations of a step; none where nothing was counted.
    pub(crate) fn mean(&self) -> Option<f64> {
        let (steps, operations) = (self.steps.get(), self.operations.get());
        (steps > 0 && operations > 0).then(|| operations as f64 / steps as f64)
    }
}

/// The method again, as one type for all; its steps are counted where a tally is given.
#[allow(missing_debug_implementations)] // a method need not have it
pub struct Erased<'a, P: Problem> {
    method: &'a dyn AnyMethod<P>,
    tally: Option<&'a Tally>,
}

impl<P: Problem> Erased<'_, P> {
    fn watch<T>(&self, step: impl FnOnce() -> T) -> T {
        match self.tally {
            Some(tally) => tally.count(step),
            None => step(),
        }
    }
}

/// `see` with a method behind a pointer.
pub(crate) fn with_plain<P: Problem + 'static, T>(
    method: &impl Method<P>,
    tally: Option<&Tally>,
    see: impl FnOnce(Erased<'_, P>) -> T,
) -> T {
    see(Erased { method: &Plain(method), tally })
}

/// `see` with one that estimates its own error.
pub(crate) fn with_pair<P: Problem + 'static, T>(
    method: &impl Embedded<P>,
    tally: Option<&Tally>,
    see: impl FnOnce(Erased<'_, P>) -> T,
) -> T {
    see(Erased { method, tally })
}

impl<'a, P: Problem> Method<P> for Erased<'a, P> {
    type Work = Box<dyn Stepper<P> + 'a>;

    fn order(&self, problem: &P) -> usize {
        self.method.order(problem)
    }
    fn evaluations(&self, problem: &P) -> Option<u64> {
        self.method.evaluations(problem)
    }
    fn stays_on_manifold(&self) -> bool {
        self.method.stays_on_manifold()
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        self.method.stepper(problem, like)
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        self.watch(|| work.step(problem, step, y))
    }
}

impl<P: Problem> Embedded<P> for Erased<'_, P> {
    fn error_order(&self, problem: &P) -> Result<usize, Error> {
        self.method.error_order(problem)
    }
    fn evaluations_with_error(&self, problem: &P) -> Option<u64> {
        self.method.evaluations_with_error(problem)
    }
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError> {
        self.watch(|| work.step_with_error(problem, step, from, to))
    }
}

/// A visitor for every other one: what finds a method is compiled once for each type of problem.
#[allow(missing_debug_implementations)] // a function
pub struct Found<'a, P: Problem>(&'a mut dyn FnMut(Erased<'_, P>));

impl<P: Problem + 'static> OnMethod<P> for Found<'_, P> {
    type Out = ();
    fn call<M: Method<P>>(self, method: M) {
        with_plain(&method, None, self.0);
    }
}

impl<P: Problem + 'static> OnEmbedded<P> for Found<'_, P> {
    type Out = ();
    fn call<M: Embedded<P>>(self, method: M) {
        with_pair(&method, None, self.0);
    }
}

/// The answer of `on` to the method that `find` finds, behind a pointer.
///
/// # Errors
/// Those of `find`.
pub fn pointed<P: Problem, V: OnMethod<P>>(
    on: V,
    find: impl FnOnce(Found<'_, P>) -> Result<(), Error>,
) -> Result<V::Out, Error> {
    let (mut on, mut out) = (Some(on), None);
    find(Found(&mut |method| out = on.take().map(|on| on.call(method))))?;
    out.ok_or_else(nothing)
}

/// The same of one that estimates its own error.
///
/// # Errors
/// Those of `find`.
pub fn pointed_pair<P: Problem, V: OnEmbedded<P>>(
    on: V,
    find: impl FnOnce(Found<'_, P>) -> Result<(), Error>,
) -> Result<V::Out, Error> {
    let (mut on, mut out) = (Some(on), None);
    find(Found(&mut |method| out = on.take().map(|on| on.call(method))))?;
    out.ok_or_else(nothing)
}

/// For a `find` that finds nothing and says so by nothing.
fn nothing() -> Error {
    Error::Unsupported { what: "a method", with: "this problem".into(), why: "there is none" }
}

/// An [`OnMethod`] that hands the method over with an estimate by [`Doubling`].
#[derive(Clone, Copy, Debug)]
pub struct Doubled<V>(pub V);

impl<P: Problem + 'static, V: OnEmbedded<P>> OnMethod<P> for Doubled<V>
where
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    type Out = V::Out;
    fn call<M: Method<P>>(self, method: M) -> V::Out {
        with_plain(&method, None, |method| self.0.call(Doubling(method)))
    }
}
