//! Methods, one file each: they take one step.
//!
//! To add a method: one file with an `impl` of [`Method`], one line here, one in the catalog. The order tests and the
//! command line use the catalog.

mod any;
mod buss;
pub mod commutator_free;
mod composition;
pub mod crouch_grossman;
mod dmv;
mod doubling;
mod embedded;
mod energy_casimir;
mod exact;
mod extension;
mod facts;
#[cfg(feature = "dense")]
mod fluid_midpoint;
mod gauss;
mod implicit_rkmk;
#[cfg(feature = "dense")]
mod isospectral;
mod lie_series;
pub mod low_storage;
pub mod magnus;
mod newton;
pub mod one_bracket;
mod projection;
mod rk;
mod rkmk;
mod simo_wong;
mod splitting;
mod stages;
mod streak;
pub mod tableau;
mod taylor;

pub use crate::space::Metric;
pub use any::AnyMethod;
pub use buss::Buss4;
pub use commutator_free::CommutatorFree;
pub use composition::{
    Composition, KAHAN_LI6, KAHAN_LI8, SCHEMES, SOFRONIOU_SPALETTA10, STRANG, SUZUKI4, Scheme,
    YOSHIDA4,
};
pub use dmv::{DMV2, DMV4, DMV6, DMV8, DMV10, Dmv};
pub use doubling::Doubling;
pub use embedded::Embedded;
pub(crate) use embedded::ratio_in_algebra;
pub use energy_casimir::EnergyCasimir;
pub use exact::ExactMotion;
pub use facts::{Facts, Halves, StepCost};
#[cfg(feature = "dense")]
pub use fluid_midpoint::{FluidMidpoint, MidpointRule};
pub use gauss::{GAUSS2, GAUSS4, GAUSS6, Gauss, ImplicitTableau};
pub use implicit_rkmk::{OddMap, RkmkGauss, RkmkGaussSymmetric};
#[cfg(feature = "dense")]
pub(crate) use isospectral::ConjugationAction;
#[cfg(feature = "dense")]
pub(crate) use isospectral::ConjugationGroup;
#[cfg(feature = "dense")]
pub use isospectral::IsospectralGauss;
pub use lie_series::{LieSeries, SeriesGroup};
pub use low_storage::LowStorage;
pub use magnus::CfMagnus;
pub use one_bracket::OneBracket;
pub use projection::ProjectionMethod;
pub use rk::Rk;
pub(crate) use rkmk::FARTHEST;
pub use rkmk::Rkmk;
pub use simo_wong::SimoWong;
pub use splitting::{MR2, MR4, Splitting};
pub use streak::{Attempt, Attempts, Resize, Streak, Watch};
pub use tableau::Tableau;
pub use taylor::{Taylor, TaylorMomentum, Wide};

use crate::actions::Action;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::Real;

/// A step: number n of the run, from t to t + h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<S> {
    /// The number of the step in its run, from 0. Maps that alternate use its parity.
    pub n: u64,
    /// The time at the start.
    pub t: S,
    /// The size; negative when time runs backward.
    pub h: S,
}

impl<S: Real> Step<S> {
    /// The step from the same start to t + θh.
    #[inline]
    pub fn part(self, theta: f64) -> Self {
        Step { h: S::lit(theta) * self.h, ..self }
    }
}

/// Steps of one size, one after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EqualSteps {
    /// The number of the first step.
    pub first: u64,
    /// The number of the last step + 1.
    pub end: u64,
    /// The time of step number 0.
    pub t0: f64,
    /// The size; negative when time runs backward.
    pub h: f64,
}

impl EqualSteps {
    /// The step with this number. It starts at t₀ + nh, so that no error accumulates in t.
    #[inline]
    pub fn step<S: Real>(&self, n: u64) -> Step<S> {
        Step { n, t: S::lit(self.t0 + n as f64 * self.h), h: S::lit(self.h) }
    }
}

/// One step, or steps of one size.
#[derive(Clone, Copy)]
enum Steps<S> {
    One(Step<S>),
    Equal(EqualSteps),
}

impl<S: Real> Steps<S> {
    /// The number of the first step, and how many they are.
    #[inline]
    fn numbers(&self) -> (u64, u64) {
        match self {
            Steps::One(step) => (step.n, 1),
            Steps::Equal(EqualSteps { first, end, .. }) => (*first, end.saturating_sub(*first)),
        }
    }

    /// The step with this number.
    #[inline]
    fn step(&self, n: u64) -> Step<S> {
        match self {
            Steps::One(step) => *step,
            Steps::Equal(steps) => steps.step(n),
        }
    }
}

/// The numbers of maps and brackets in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapCounts {
    /// Ψ, formed or applied.
    pub psi: u64,
    /// dΨ⁻¹.
    pub dpsi_inv: u64,
    /// Brackets outside dΨ⁻¹.
    pub brackets: u64,
}

impl MapCounts {
    /// The counts of n steps.
    pub fn times(self, n: u64) -> Self {
        let MapCounts { psi, dpsi_inv, brackets } = self;
        MapCounts { psi: n * psi, dpsi_inv: n * dpsi_inv, brackets: n * brackets }
    }
}

impl core::ops::Add for MapCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        MapCounts {
            psi: self.psi + other.psi,
            dpsi_inv: self.dpsi_inv + other.dpsi_inv,
            brackets: self.brackets + other.brackets,
        }
    }
}

/// How the points within a step depend on θ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Within {
    /// By shorter steps, or in another way that needs the step itself.
    Steps,
    /// As λ_p(u(θ)), where u(θ) ∈ 𝔤 is a polynomial of degree 7 at most.
    Chart,
    /// As a polynomial of degree 7 at most in the linear space around M.
    Space,
    /// As a series: [`Method::interpolate`] reads the step, its start, and the numbers of [`Method::each_term`] only.
    Series,
}

/// A symmetric method: a step back undoes a step, Φ_{−h} ∘ Φ_h = id, to rounding. Its order is even, and a
/// [`Composition`] raises it.
pub trait Symmetric {}

/// A one-step method for problems of type `P`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no method for `{P}`",
    note = "a tableau is wrapped in `Rkmk::new(tableau, map)` or `Rk(tableau)`; what a method needs of a problem is in its documentation"
)]
pub trait Method<P: Problem> {
    /// The workspace of a step, made once and used for every step.
    ///
    /// It carries no number from one step to the next that the step could not compute again from its arguments, so a step
    /// depends only on these. The one exception is [`FluidMidpoint`], which starts its iteration from the steps before.
    type Work: Send;

    /// What is known of the method on this problem before any step: its orders and costs.
    fn facts(&self, problem: &P) -> Facts;

    /// The iterations of all implicit steps with this workspace so far, failed steps included.
    fn iterations(&self, _work: &Self::Work) -> u64 {
        0
    }

    /// The evaluations of f that steps with this workspace did not need so far, because the last stage of the step before
    /// is the first one of the next.
    fn reused(&self, _work: &Self::Work) -> u64 {
        0
    }

    /// Forgets values of f that the workspace keeps for the next step, because f may be another one now. Most methods keep
    /// none.
    fn forget(&self, _work: &mut Self::Work) {}

    /// Makes the workspace. `like` is any point of M.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if the method does not fit the problem.
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error>;

    /// y ← the approximation at t + h. On an error y is unchanged.
    ///
    /// # Errors
    /// Why the step could not be taken.
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError>;

    /// Calls `each` with every number that the workspace carries from one step to the next. Most methods have none.
    /// They are saved with the state of a run.
    fn each_memory(&self, _work: &mut Self::Work, _each: &mut dyn FnMut(&mut f64)) {}

    /// Prepares [`interpolate`](Self::interpolate) for `step` from `from` to `to`, the last step with this `work`.
    ///
    /// It evaluates the additional stages of dense output. It is called once for a step, and only if output or an event
    /// needs a point within it. The default does nothing.
    ///
    /// # Errors
    /// Why a stage could not be evaluated.
    fn prepare(
        &self,
        _problem: &P,
        _step: Step<ScalarOf<P>>,
        _from: &PointOf<P>,
        _to: &PointOf<P>,
        _work: &mut Self::Work,
    ) -> Result<(), StepError> {
        Ok(())
    }

    /// `at` ← the approximation at t + θh, 0 < θ < 1, on M, for the step of the last [`prepare`](Self::prepare).
    ///
    /// The default is a step of size θh from `from`. It has the order of the method, and costs a whole step.
    ///
    /// # Errors
    /// Why the point could not be computed.
    fn interpolate(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        work: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        at.assign(from);
        self.step(problem, step.part(theta), at, work)
    }

    /// The form of the points within the last step with this workspace. The default is a shorter step.
    fn within(&self, _work: &Self::Work) -> Within {
        Within::Steps
    }

    /// u ← u(θ) for [`Within::Chart`], after [`prepare`](Self::prepare). `base` is the start of the step. A method with
    /// another centre of its chart writes this centre to `base`. The default writes u = 0.
    fn coordinates(
        &self,
        problem: &P,
        _step: Step<ScalarOf<P>>,
        _theta: f64,
        _base: &mut PointOf<P>,
        _work: &mut Self::Work,
        u: &mut AlgOf<P>,
    ) {
        problem.group().set_zero(u);
    }

    /// `at` ← λ_p(u), p = `base`, in the chart of step number n. It is for [`Within::Chart`], and calls no f.
    ///
    /// # Errors
    /// Why the point could not be computed.
    fn on_chart(
        &self,
        _problem: &P,
        _n: u64,
        _base: &PointOf<P>,
        _u: &AlgOf<P>,
        _work: &mut Self::Work,
        _at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        Err(StepError::NotFinite { what: "the continuous extension" })
    }

    /// Calls `each` with every number of the workspace that [`interpolate`](Self::interpolate) reads, for
    /// [`Within::Series`]. With other numbers in them the workspace is that of another step.
    fn each_term(&self, _work: &mut Self::Work, _each: &mut dyn FnMut(&mut f64)) {}

    /// Takes these steps. The numbers of y must be finite after each ([`Action::is_finite`]).
    ///
    /// # Errors
    /// The number of the failed step, with the reason. If [`step`](Self::step) failed, y is the point before it. If
    /// numbers of y are not finite, they are still in y.
    #[inline(never)] // in a larger function the step is compiled worse: up to 1.45 times its time
    fn steps(
        &self,
        problem: &P,
        steps: EqualSteps,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), (u64, StepError)> {
        take_steps(self, problem, Steps::Equal(steps), y, work)
    }
}

/// Takes these steps, as [`Method::steps`] does.
#[inline(always)]
fn take_steps<P: Problem, M: Method<P> + ?Sized>(
    method: &M,
    problem: &P,
    steps: Steps<ScalarOf<P>>,
    y: &mut PointOf<P>,
    work: &mut M::Work,
) -> Result<(), (u64, StepError)> {
    let (first, count) = steps.numbers();
    for i in 0..count {
        let n = first.wrapping_add(i);
        if let Err(error) = method.step(problem, steps.step(n), y, work) {
            return Err((n, error));
        }
        if !problem.action().is_finite(problem.group(), y) {
            return Err((n, StepError::NotFinite { what: "the state" }));
        }
    }
    Ok(())
}
