//! Fields that can fail, with an error of their own.
//!
//! [`Problem::f`] returns numbers. A field that has no value at some (t, y), and would have one after
//! a smaller step, says so by a number that is not finite: a fixed run stops there with
//! [`StepError::NonFiniteRhs`](crate::StepError::NonFiniteRhs), an adaptive one shrinks the step. A
//! field that failed for good, because a file could not be read or an argument was out of range, is a
//! [`TryProblem`]; [`Fallible`] makes a [`Problem`] of it and keeps its error.

use std::sync::OnceLock;

use super::Problem;
use crate::actions::Action;
use crate::error::Error;
use crate::groups::{LieAlgebra, LieGroup};
use crate::scalar::Real;

/// A [`Problem`] whose field may fail.
pub trait TryProblem {
    /// G.
    type Group: LieGroup;
    /// Λ.
    type Action: Action<Self::Group>;
    /// Scratch of f; `()` when it needs none.
    type Work;
    /// What f fails with.
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
    /// The user's own.
    fn try_f(
        &self,
        t: <Self::Group as LieAlgebra>::Scalar,
        y: &<Self::Action as Action<Self::Group>>::Point,
        v: &mut <Self::Group as LieAlgebra>::Alg,
        work: &mut Self::Work,
    ) -> Result<(), Self::Error>;
}

/// The [`Problem`] of a [`TryProblem`]. The first error of its field is kept; from then on the field
/// is not asked again and has no finite value, so that the run ends.
///
/// ```
/// use lieflow::actions::Linear;
/// use lieflow::groups::So3;
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{Fallible, TryProblem};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use nalgebra::Vector3;
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
    /// The problem, without an error so far.
    pub const fn new(problem: P) -> Self {
        Fallible { problem, error: OnceLock::new() }
    }
    /// The first error of the field; `None` when a run failed for another reason, or did not.
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

/// A problem whose every value of f is looked at: is it in 𝔤 ([`LieAlgebra::check`])? It costs a check
/// and storage for each evaluation; [`integrate`](crate::integrate()) looks at the first value only.
///
/// `Fallible::new(InAlgebra(problem))` is the problem to run, and its error names the residual.
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
