//! A method behind a pointer. Doubling the steps of every method with code of its own for each would
//! triple what is compiled; a call through a pointer a step, around the step and not inside it, is
//! nothing beside the three steps that doubling takes. Only adaptive runs of methods without an
//! embedded pair come here.

use lieflow::catalog::{OnEmbedded, OnMethod};
use lieflow::methods::{Doubling, Metric};
use lieflow::problems::{PointOf, Problem, ScalarOf};
use lieflow::{Error, Method, Step, StepError};

/// A method, whatever its type.
trait AnyMethod<P: Problem> {
    fn order(&self, problem: &P) -> usize;
    fn evaluations(&self, problem: &P) -> Option<u64>;
    fn stays_on_manifold(&self) -> bool;
    fn stepper<'a>(&'a self, problem: &P, like: &PointOf<P>) -> Result<AnyStepper<'a, P>, Error>;
}

/// A method with its workspace.
trait Stepper<P: Problem> {
    fn step(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError>;
}

type AnyStepper<'a, P> = Box<dyn Stepper<P> + 'a>;

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
struct Erased<'a, P: Problem>(&'a dyn AnyMethod<P>);

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
