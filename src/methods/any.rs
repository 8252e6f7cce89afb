//! A method whose type is known only at run time, such as a method chosen by name.
//!
//! [`AnyMethod`] is a [`Method`] and an [`Embedded`] for one type of problem. With it drivers, step doubling and
//! counting are compiled once for each problem type, not once for each method. Many equal steps are one call through a
//! pointer ([`Method::steps`]), and the loop over them is compiled with the method inside. A single step is the same loop,
//! taken once.

use core::fmt;
use core::marker::PhantomData;
use std::sync::Arc;

use super::doubling::{doubled as step_doubled, within_halves};
use super::streak::attempt_steps;
use super::{
    Attempt, Attempts, Embedded, EqualSteps, Facts, Method, Metric, Step, Steps, Within, take_steps,
};
use crate::error::{Error, StepError};
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::tolerance::Tolerance;

/// A method for problems of type `P`, behind a pointer. Cloning copies the pointer.
///
/// A method without an embedded error estimate gets one by step doubling ([`Doubling`](super::Doubling)).
/// [`has_pair`](Self::has_pair) is true for an embedded estimate.
pub struct AnyMethod<'p, P: Problem> {
    inner: Arc<dyn Inner<'p, P> + Send + Sync + 'p>,
}

impl<P: Problem> Clone for AnyMethod<'_, P> {
    fn clone(&self) -> Self {
        AnyMethod { inner: self.inner.clone() }
    }
}

impl<P: Problem> fmt::Debug for AnyMethod<'_, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("AnyMethod").field(&self.inner.name()).finish()
    }
}

impl<'p, P: Problem + 'p> AnyMethod<'p, P> {
    /// Wraps a method without an embedded error estimate.
    pub fn new<M: Method<P> + Clone + Send + Sync + 'p>(method: M) -> Self {
        AnyMethod { inner: Arc::new(MethodWithEstimate { method, estimate: NoEstimate }) }
    }

    /// Wraps a method with its embedded error estimate, if it has one.
    pub fn embedded<M: Embedded<P> + Clone + Send + Sync + 'p>(method: M) -> Self {
        AnyMethod { inner: Arc::new(MethodWithEstimate { method, estimate: OwnEstimate }) }
    }

    /// True if the method has an embedded error estimate on this problem. Otherwise steps are doubled.
    pub fn has_pair(&self, problem: &P) -> bool {
        self.inner.facts(problem).error_order.is_some()
    }
}

/// A method behind the pointer.
trait Inner<'p, P: Problem> {
    fn name(&self) -> &'static str;
    fn facts(&self, problem: &P) -> Facts;
    fn stepper(
        &self,
        problem: &P,
        like: &PointOf<P>,
    ) -> Result<Box<dyn Stepper<P> + Send + 'p>, Error>;
}

/// A method with its workspace behind the pointer.
trait Stepper<P: Problem> {
    /// Takes one step or many. An error has the number of the step that failed.
    fn take(
        &mut self,
        problem: &P,
        steps: Steps<ScalarOf<P>>,
        y: &mut PointOf<P>,
    ) -> Result<(), (u64, StepError)>;
    /// See [`Embedded::attempt`].
    fn attempt(&mut self, problem: &P, attempt: Attempt<'_, P>) -> Attempts
    where
        ScalarOf<P>: Into<f64>;
    fn iterations(&self) -> u64;
    fn reused(&self) -> u64;
    fn forget(&mut self);
    fn each_memory(&mut self, each: &mut dyn FnMut(&mut f64));
    fn prepare(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        to: &PointOf<P>,
    ) -> Result<(), StepError>;
    fn interpolate(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError>;
    fn within(&self) -> Within;
    fn each_term(&mut self, each: &mut dyn FnMut(&mut f64));
    fn coordinates(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        theta: f64,
        base: &mut PointOf<P>,
        u: &mut AlgOf<P>,
    );
    fn on_chart(
        &mut self,
        problem: &P,
        n: u64,
        base: &PointOf<P>,
        u: &AlgOf<P>,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError>;
}

impl<P: Problem> dyn Stepper<P> + Send + '_ {
    fn step(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        self.take(problem, Steps::One(step), y).map_err(|(_, error)| error)
    }
}

/// The source of the error estimate of a method.
trait Estimate<P: Problem, M: Method<P>>: Copy + Send + Sync {
    fn facts(self, method: &M, problem: &P) -> Facts;
    fn attempt(
        self,
        method: &M,
        problem: &P,
        attempt: Attempt<'_, P>,
        work: &mut M::Work,
    ) -> Attempts
    where
        ScalarOf<P>: Into<f64>;
}

#[derive(Clone, Copy)]
struct NoEstimate;

impl<P: Problem, M: Method<P>> Estimate<P, M> for NoEstimate {
    fn facts(self, method: &M, problem: &P) -> Facts {
        Facts { error_order: None, ..method.facts(problem) }
    }
    fn attempt(self, _: &M, _: &P, attempt: Attempt<'_, P>, _: &mut M::Work) -> Attempts {
        let Attempt { step, end, .. } = attempt;
        Attempts::without_estimate(step, end)
    }
}

#[derive(Clone, Copy)]
struct OwnEstimate;

impl<P: Problem, M: Embedded<P>> Estimate<P, M> for OwnEstimate {
    fn facts(self, method: &M, problem: &P) -> Facts {
        method.facts(problem)
    }
    #[inline(always)]
    fn attempt(
        self,
        method: &M,
        problem: &P,
        attempt: Attempt<'_, P>,
        work: &mut M::Work,
    ) -> Attempts
    where
        ScalarOf<P>: Into<f64>,
    {
        method.attempt(problem, attempt, work)
    }
}

struct MethodWithEstimate<M, E> {
    method: M,
    estimate: E,
}

impl<'p, P, M, E> Inner<'p, P> for MethodWithEstimate<M, E>
where
    P: Problem + 'p,
    M: Method<P> + Clone + Send + Sync + 'p,
    E: Estimate<P, M> + 'p,
{
    fn name(&self) -> &'static str {
        core::any::type_name::<M>()
    }
    fn facts(&self, problem: &P) -> Facts {
        self.estimate.facts(&self.method, problem)
    }
    fn stepper(
        &self,
        problem: &P,
        like: &PointOf<P>,
    ) -> Result<Box<dyn Stepper<P> + Send + 'p>, Error> {
        let work = self.method.work(problem, like)?;
        let (method, estimate) = (self.method.clone(), self.estimate);
        Ok(Box::new(MethodWithWork { method, work, estimate, problem: PhantomData::<fn(&P)> }))
    }
}

struct MethodWithWork<P: Problem, M: Method<P>, E> {
    method: M,
    work: M::Work,
    estimate: E,
    problem: PhantomData<fn(&P)>,
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<P: Problem, M: Method<P>, E: Estimate<P, M>> Stepper<P> for MethodWithWork<P, M, E> {
    fn take(
        &mut self,
        problem: &P,
        steps: Steps<ScalarOf<P>>,
        y: &mut PointOf<P>,
    ) -> Result<(), (u64, StepError)> {
        take_steps(&self.method, problem, steps, y, &mut self.work)
    }
    fn attempt(&mut self, problem: &P, attempt: Attempt<'_, P>) -> Attempts
    where
        ScalarOf<P>: Into<f64>,
    {
        let MethodWithWork { method, work, estimate, .. } = self;
        estimate.attempt(method, problem, attempt, work)
    }
    fn iterations(&self) -> u64 {
        self.method.iterations(&self.work)
    }
    fn reused(&self) -> u64 {
        self.method.reused(&self.work)
    }
    fn forget(&mut self) {
        self.method.forget(&mut self.work);
    }
    fn each_memory(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.method.each_memory(&mut self.work, each);
    }
    fn prepare(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        to: &PointOf<P>,
    ) -> Result<(), StepError> {
        self.method.prepare(problem, step, from, to, &mut self.work)
    }
    fn interpolate(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        self.method.interpolate(problem, step, theta, from, &mut self.work, at)
    }
    fn within(&self) -> Within {
        self.method.within(&self.work)
    }
    fn each_term(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.method.each_term(&mut self.work, each);
    }
    fn coordinates(
        &mut self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        theta: f64,
        base: &mut PointOf<P>,
        u: &mut AlgOf<P>,
    ) {
        self.method.coordinates(problem, step, theta, base, &mut self.work, u);
    }
    fn on_chart(
        &mut self,
        problem: &P,
        n: u64,
        base: &PointOf<P>,
        u: &AlgOf<P>,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        self.method.on_chart(problem, n, base, u, &mut self.work, at)
    }
}

/// The workspace of an [`AnyMethod`].
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct AnyWork<'p, P: Problem> {
    stepper: Box<dyn Stepper<P> + Send + 'p>,
    /// True if the method has an embedded error estimate here. If not, steps are doubled.
    has_pair: bool,
    order: usize,
    /// The point after one long step, for step doubling.
    once: PointOf<P>,
    /// The point after the first half of a doubled step.
    half: PointOf<P>,
    /// True if the last step was a doubled one.
    doubled: bool,
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<'p, P> Method<P> for AnyMethod<'p, P>
where
    P: Problem + 'p,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    type Work = AnyWork<'p, P>;

    fn facts(&self, problem: &P) -> Facts {
        let facts = self.inner.facts(problem);
        match facts.error_order {
            Some(_) => facts,
            None => facts.doubled_for_error(),
        }
    }
    fn iterations(&self, work: &Self::Work) -> u64 {
        work.stepper.iterations()
    }
    fn reused(&self, work: &Self::Work) -> u64 {
        work.stepper.reused()
    }
    fn forget(&self, work: &mut Self::Work) {
        work.stepper.forget();
    }
    fn each_memory(&self, work: &mut Self::Work, each: &mut dyn FnMut(&mut f64)) {
        work.stepper.each_memory(each);
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let facts = self.inner.facts(problem);
        Ok(AnyWork {
            stepper: self.inner.stepper(problem, like)?,
            has_pair: facts.error_order.is_some(),
            order: facts.order,
            once: like.clone(),
            half: like.clone(),
            doubled: false,
        })
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        work.doubled = false;
        work.stepper.step(problem, step, y)
    }
    fn prepare(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        to: &PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        if work.doubled { Ok(()) } else { work.stepper.prepare(problem, step, from, to) }
    }
    fn interpolate(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        AnyWork { stepper, half, doubled, .. }: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        match doubled {
            false => stepper.interpolate(problem, step, theta, from, at),
            true => within_halves(step, theta, [from, half], at, |step, y| {
                stepper.step(problem, step, y)
            }),
        }
    }
    fn within(&self, work: &Self::Work) -> Within {
        if work.doubled { Within::Steps } else { work.stepper.within() }
    }
    fn each_term(&self, work: &mut Self::Work, each: &mut dyn FnMut(&mut f64)) {
        work.stepper.each_term(each);
    }
    fn coordinates(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        theta: f64,
        base: &mut PointOf<P>,
        work: &mut Self::Work,
        u: &mut AlgOf<P>,
    ) {
        work.stepper.coordinates(problem, step, theta, base, u);
    }
    fn on_chart(
        &self,
        problem: &P,
        n: u64,
        base: &PointOf<P>,
        u: &AlgOf<P>,
        work: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        work.stepper.on_chart(problem, n, base, u, at)
    }
    fn steps(
        &self,
        problem: &P,
        steps: EqualSteps,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), (u64, StepError)> {
        work.doubled = false;
        work.stepper.take(problem, Steps::Equal(steps), y)
    }
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<'p, P> Embedded<P> for AnyMethod<'p, P>
where
    P: Problem + 'p,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
    ScalarOf<P>: Into<f64>,
{
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        AnyWork { stepper, has_pair, order, once, half, doubled }: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        *doubled = !*has_pair;
        match has_pair {
            true => {
                half.assign(from);
                let Step { n, t, h } = step;
                let step = Step { n, t: t.into(), h: h.into() };
                let one = Attempt::one(tolerance, step, [once, half, to]);
                stepper.attempt(problem, one).ratio.map(ScalarOf::<P>::lit)
            }
            false => step_doubled(*order, step, tolerance, from, [once, half], to, |step, y| {
                stepper.step(problem, step, y)
            }),
        }
    }
    fn attempt(&self, problem: &P, attempt: Attempt<'_, P>, work: &mut Self::Work) -> Attempts {
        if work.has_pair {
            work.doubled = false;
            return work.stepper.attempt(problem, attempt);
        }
        attempt_steps(self, problem, attempt, work)
    }
}
