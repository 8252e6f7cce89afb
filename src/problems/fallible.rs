//! Fields that can fail with your own type of error.
//!
//! [`Problem::f`] returns numbers. There are two kinds of failure:
//!
//! - The field has no value at (t, y), but may have one after a smaller step. Then f returns NaN. A run with a fixed step size
//!   ends with [`StepError::NonFiniteRhs`](crate::StepError::NonFiniteRhs); an adaptive run takes a smaller step.
//! - The field failed finally. Examples: a file could not be read, or an argument is out of range. Then implement
//!   [`TryProblem`]. [`Fallible`] makes a [`Problem`] of it and stores its error.

use core::fmt;
use std::sync::OnceLock;

use super::Problem;
use crate::actions::Action;
use crate::error::Error;
use crate::groups::{LieAlgebra, LieGroup};
use crate::scalar::Real;

/// A [`Problem`] whose field may fail.
pub trait TryProblem {
    /// The group G.
    type Group: LieGroup;
    /// The action Λ.
    type Action: Action<Self::Group>;
    /// Scratch of f; `()` when it needs none.
    type Work: Send;
    /// The error of f.
    type Error;

    /// G as a value.
    fn group(&self) -> &Self::Group;
    /// Λ as a value.
    fn action(&self) -> &Self::Action;
    /// Scratch for [`try_f`](Self::try_f).
    fn work(&self) -> Self::Work;
    /// v ← f(t, y) ∈ 𝔤.
    ///
    /// # Errors
    /// Your own error.
    fn try_f(
        &self,
        t: <Self::Group as LieAlgebra>::Scalar,
        y: &<Self::Action as Action<Self::Group>>::Point,
        v: &mut <Self::Group as LieAlgebra>::Alg,
        work: &mut Self::Work,
    ) -> Result<(), Self::Error>;
}

/// The [`Problem`] of a [`TryProblem`], which stores the first error of the field.
///
/// After the error the field is not evaluated again, and f is NaN. So the run ends.
///
/// ```
/// use lieflow::actions::Linear;
/// use lieflow::groups::So3;
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{Fallible, TryProblem};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
///
/// /// A rate that was measured at full seconds.
/// struct Measured(So3, Vec<f64>);
/// impl TryProblem for Measured {
///     type Group = So3;
///     type Action = Linear;
///     type Work = ();
///     type Error = String;
///     fn group(&self) -> &So3 { &self.0 }
///     fn action(&self) -> &Linear { &Linear }
///     fn work(&self) {}
///     fn try_f(&self, t: f64, _: &Vector3<f64>, v: &mut Vector3<f64>, _: &mut ()) -> Result<(), String> {
///         let rate = self.1.get(t as usize).ok_or_else(|| format!("nothing was measured at t = {t}"))?;
///         *v = Vector3::new(0.0, 0.0, *rate);
///         Ok(())
///     }
/// }
///
/// let problem = Fallible::new(Measured(So3::new(), vec![0.1, 0.2]));
/// let mut x = Vector3::x();
/// let grid = TimeGrid::new([0.0, 3.0], 0.25)?;
/// let run = integrate(&problem, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut x, |_, _| {});
/// assert!(run.is_err());
/// assert_eq!(problem.error().unwrap(), "nothing was measured at t = 2");
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Debug)]
pub struct Fallible<P: TryProblem> {
    problem: P,
    error: OnceLock<P::Error>,
}

impl<P: TryProblem> Fallible<P> {
    /// Makes the problem, without an error so far.
    pub const fn new(problem: P) -> Self {
        Fallible { problem, error: OnceLock::new() }
    }
    /// The first error of the field; `None` if the field did not fail.
    pub fn error(&self) -> Option<&P::Error> {
        self.error.get()
    }
    /// The first error of the field, as a value.
    pub fn into_error(self) -> Option<P::Error> {
        self.error.into_inner()
    }
}

impl<P: TryProblem> Problem for Fallible<P> {
    type Group = P::Group;
    type Action = P::Action;
    type Work = P::Work;

    fn group(&self) -> &P::Group {
        self.problem.group()
    }
    fn action(&self) -> &P::Action {
        self.problem.action()
    }
    fn work(&self) -> P::Work {
        self.problem.work()
    }
    fn f(
        &self,
        t: <P::Group as LieAlgebra>::Scalar,
        y: &<P::Action as Action<P::Group>>::Point,
        v: &mut <P::Group as LieAlgebra>::Alg,
        work: &mut P::Work,
    ) {
        if self.error.get().is_none() {
            match self.problem.try_f(t, y, v, work) {
                Ok(()) => return,
                Err(error) => drop(self.error.set(error)),
            }
        }
        // No value: not a number, in storage of the right size whatever f left there.
        let group = self.problem.group();
        let zero = group.zero();
        *v = group.zero();
        group.axpy(<P::Group as LieAlgebra>::Scalar::lit(f64::NAN), &zero, v);
    }
}

/// A [`TryProblem`] from a group, an action and a closure that may fail.
///
/// `field(t, y, v)` writes f(t, y) into v, which is 0 before, or returns an error. Run `Fallible::new(TryFlow::new(…))`.
///
/// ```
/// use lieflow::actions::LeftTranslation;
/// use lieflow::groups::{LieGroup, So3};
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{Fallible, TryFlow};
/// use lieflow::samples::{Interpolation, Samples};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
///
/// let rates = Samples::new(&[0.0, 1.0], &[[0.1, 0.2], [0.0, 0.0], [0.5, 0.4]], Interpolation::Linear)?;
/// let attitude = TryFlow::new(So3::<f64>::new(), LeftTranslation, |t, _, v: &mut Vector3<f64>| {
///     rates.value(t, v.as_mut_slice())
/// });
/// let problem = Fallible::new(attitude);
/// let mut g = So3::new().identity();
/// let grid = TimeGrid::new([0.0, 3.0], 0.25)?;
/// let run = integrate(&problem, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut g, |_, _| {});
/// assert!(run.is_err());
/// let error = problem.error().expect("the samples end at 1").to_string();
/// assert_eq!(error, "t = 1.125 lies outside of the samples, which span 0 to 1");
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct TryFlow<G, A, F> {
    group: G,
    action: A,
    field: F,
}

impl<G, A, F, E> TryFlow<G, A, F>
where
    G: LieGroup,
    A: Action<G>,
    F: Fn(G::Scalar, &A::Point, &mut G::Alg) -> Result<(), E>,
{
    /// Makes the problem of a closure.
    pub const fn new(group: G, action: A, field: F) -> Self {
        TryFlow { group, action, field }
    }
}

impl<G: LieAlgebra, A, F> fmt::Debug for TryFlow<G, A, F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TryFlow").field("group", &self.group.name()).finish_non_exhaustive()
    }
}

impl<G, A, F, E> TryProblem for TryFlow<G, A, F>
where
    G: LieGroup,
    A: Action<G>,
    F: Fn(G::Scalar, &A::Point, &mut G::Alg) -> Result<(), E>,
{
    type Group = G;
    type Action = A;
    type Work = ();
    type Error = E;

    fn group(&self) -> &G {
        &self.group
    }
    fn action(&self) -> &A {
        &self.action
    }
    fn work(&self) {}
    fn try_f(&self, t: G::Scalar, y: &A::Point, v: &mut G::Alg, _: &mut ()) -> Result<(), E> {
        self.group.set_zero(v);
        (self.field)(t, y, v)
    }
}

/// A problem that checks for every value of f that it is in 𝔤 ([`LieAlgebra::check`]).
///
/// Run `Fallible::new(InAlgebra(problem))`; its error has the residual. The check and its storage cost time in each
/// evaluation. Without it [`integrate`](crate::integrate()) checks only the first value.
#[derive(Clone, Copy, Debug)]
pub struct InAlgebra<P>(pub P);

impl<P: Problem> TryProblem for InAlgebra<P> {
    type Group = P::Group;
    type Action = P::Action;
    type Work = P::Work;
    type Error = Error;

    fn group(&self) -> &P::Group {
        self.0.group()
    }
    fn action(&self) -> &P::Action {
        self.0.action()
    }
    fn work(&self) -> P::Work {
        self.0.work()
    }
    fn try_f(
        &self,
        t: <P::Group as LieAlgebra>::Scalar,
        y: &<P::Action as Action<P::Group>>::Point,
        v: &mut <P::Group as LieAlgebra>::Alg,
        work: &mut P::Work,
    ) -> Result<(), Error> {
        self.0.f(t, y, v, work);
        self.0.group().check("f", v)
    }
}
