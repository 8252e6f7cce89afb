//! A method behind a pointer. The loops of fixed, adaptive and doubled steps with code of their own for
//! every method would triple what is compiled; a call through a pointer a step is around the step and
//! not inside it. Adaptive runs come here, where it is nothing beside the choice of a step, runs whose
//! operations are counted, and every run of the problems of `kinds/flow.rs`, whose field is behind a
//! pointer already. Steps of one size of a rigid body, which are timed in nanoseconds, do not.

use lieflow::catalog::{OnEmbedded, OnMethod};
use lieflow::methods::{Doubling, Embedded, LocalError, Metric};
use lieflow::problems::{PointOf, Problem, ScalarOf};
use lieflow::{Error, Method, Step, StepError};

/// A method, whatever its type.
pub(crate) trait AnyMethod<P: Problem> {
    fn order(&self, problem: &P) -> usize;
    fn evaluations(&self, problem: &P) -> Option<u64>;
    fn stays_on_manifold(&self) -> bool;
    fn stepper<'a>(&'a self, problem: &P, like: &PointOf<P>) -> Result<AnyStepper<'a, P>, Error>;
}

/// A method with its workspace.
pub(crate) trait Stepper<P: Problem> {
    fn step(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError>;
}

pub(crate) type AnyStepper<'a, P> = Box<dyn Stepper<P> + 'a>;

struct Both<'a, P: Problem, M: Method<P>> {
    method: &'a M,
    work: M::Work,
}

impl<P: Problem, M: Method<P>> Stepper<P> for Both<'_, P, M> {
    fn step(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        self.method.step(problem, step, y, &mut self.work)
    }
}

impl<P: Problem + 'static, M: Method<P>> AnyMethod<P> for M {
    fn order(&self, problem: &P) -> usize {
        Method::order(self, problem)
    }
    fn evaluations(&self, problem: &P) -> Option<u64> {
        Method::evaluations(self, problem)
    }
    fn stays_on_manifold(&self) -> bool {
        Method::stays_on_manifold(self)
    }
    fn stepper<'a>(&'a self, problem: &P, like: &PointOf<P>) -> Result<AnyStepper<'a, P>, Error> {
        Ok(Box::new(Both { method: self, work: self.work(problem, like)? }))
    }
}

/// The method again, as one type for all.
pub(crate) struct Erased<'a, P: Problem>(pub(crate) &'a dyn AnyMethod<P>);

impl<'a, P: Problem> Method<P> for Erased<'a, P> {
    type Work = AnyStepper<'a, P>;

    fn order(&self, problem: &P) -> usize {
        self.0.order(problem)
    }
    fn evaluations(&self, problem: &P) -> Option<u64> {
        self.0.evaluations(problem)
    }
    fn stays_on_manifold(&self) -> bool {
        self.0.stays_on_manifold()
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        self.0.stepper(problem, like)
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        work.step(problem, step, y)
    }
}

/// A method that estimates its own error, whatever its type.
pub(crate) trait AnyPair<P: Problem> {
    fn order(&self, problem: &P) -> usize;
    fn stays_on_manifold(&self) -> bool;
    fn error_order(&self, problem: &P) -> Result<usize, Error>;
    fn evaluations_with_error(&self, problem: &P) -> Option<u64>;
    fn stepper<'a>(&'a self, problem: &P, like: &PointOf<P>) -> Result<PairStepper<'a, P>, Error>;
}

/// A method that estimates its own error, with its workspace.
pub(crate) trait StepperWithError<P: Problem>: Stepper<P> {
    fn step_with_error(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        to: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError>;
}

pub(crate) type PairStepper<'a, P> = Box<dyn StepperWithError<P> + 'a>;

impl<P: Problem, M: Embedded<P>> StepperWithError<P> for Both<'_, P, M> {
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

impl<P: Problem + 'static, M: Embedded<P>> AnyPair<P> for M {
    fn order(&self, problem: &P) -> usize {
        Method::order(self, problem)
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
    fn stepper<'a>(&'a self, problem: &P, like: &PointOf<P>) -> Result<PairStepper<'a, P>, Error> {
        Ok(Box::new(Both { method: self, work: self.work(problem, like)? }))
    }
}

/// The method again, as one type for all.
pub(crate) struct ErasedPair<'a, P: Problem>(pub(crate) &'a dyn AnyPair<P>);

impl<'a, P: Problem> Method<P> for ErasedPair<'a, P> {
    type Work = PairStepper<'a, P>;

    fn order(&self, problem: &P) -> usize {
        self.0.order(problem)
    }
    fn stays_on_manifold(&self) -> bool {
        self.0.stays_on_manifold()
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        self.0.stepper(problem, like)
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        work.step(problem, step, y)
    }
}

impl<P: Problem> Embedded<P> for ErasedPair<'_, P> {
    fn error_order(&self, problem: &P) -> Result<usize, Error> {
        self.0.error_order(problem)
    }
    fn evaluations_with_error(&self, problem: &P) -> Option<u64> {
        self.0.evaluations_with_error(problem)
    }
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<LocalError<ScalarOf<P>>, StepError> {
        work.step_with_error(problem, step, from, to)
    }
}

/// A visitor that gets every method as one type.
#[derive(Clone, Copy, Debug)]
pub struct Pointed<V>(pub V);

impl<P: Problem + 'static, V: OnMethod<P>> OnMethod<P> for Pointed<V> {
    type Out = V::Out;
    fn call<M: Method<P>>(self, method: M) -> V::Out {
        self.0.call(Erased(&method))
    }
}

impl<P: Problem + 'static, V: OnEmbedded<P>> OnEmbedded<P> for Pointed<V> {
    type Out = V::Out;
    fn call<M: Embedded<P>>(self, method: M) -> V::Out {
        self.0.call(ErasedPair(&method))
    }
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
        self.0.call(Doubling(Erased(&method)))
    }
}
