//! A problem ready to run, whatever its types: one dynamic dispatch a run.

use core::fmt::Debug;

use lieflow::adaptive::{Adaptive, AdaptiveError, AdaptiveStats, integrate_adaptive};
use lieflow::catalog::{MethodSpec, OnEmbedded, OnMethod};
use lieflow::groups::LieAlgebra;
use lieflow::methods::{Embedded, Method};
use lieflow::problems::{PointOf, Problem};
use lieflow::{Error, RunError, SaveAt, Stats, TimeGrid, integrate};

use crate::operations::Pace;

/// Which code a problem runs on. Methods that stay on the group agree on the two to rounding; the
/// stages of a classical one leave it, and what it makes of an attitude agrees to its order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Layer {
    /// Closed formulas on so(3) ≅ ℝ³.
    #[default]
    Closed,
    /// Matrices of any size.
    General,
}

impl Layer {
    /// Every layer.
    pub const ALL: [Layer; 2] = [Layer::Closed, Layer::General];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Layer::Closed => "closed",
            Layer::General => "general",
        }
    }

    /// The layer of that name.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn named(name: &str) -> Result<Self, Error> {
        Self::ALL.into_iter().find(|layer| layer.name() == name).ok_or_else(|| {
            let expected = Self::ALL.map(Layer::name).to_vec();
            Error::UnknownName { kind: "layer", name: name.into(), expected }
        })
    }
}

/// Steps that are chosen by their error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// From when to when.
    pub t_span: [f64; 2],
    /// Tolerances and limits.
    pub control: Adaptive,
}

/// What gets the rows of a run: t and one value per column.
pub type Sink<'a> = dyn FnMut(f64, &[f64]) + 'a;

/// A problem with its initial state and the quantities that are asked of it.
pub trait Model: Debug {
    /// Names of the columns after `t`.
    fn columns(&self) -> Vec<String>;

    /// What a method integrates, in words. Nothing else is computed.
    fn modelled(&self, method: &MethodSpec) -> Vec<String>;

    /// Integrate from the initial state; `sink` gets a row where `save` says.
    ///
    /// # Errors
    /// As [`integrate`].
    fn run(
        &self,
        method: &MethodSpec,
        grid: &TimeGrid,
        save: &SaveAt,
        sink: &mut Sink<'_>,
    ) -> Result<Stats, RunError>;

    /// The same with steps that are chosen by their error.
    ///
    /// # Errors
    /// As [`integrate_adaptive`].
    fn adapt(
        &self,
        method: &MethodSpec,
        steps: &Steps,
        save: &SaveAt,
        sink: &mut Sink<'_>,
    ) -> Result<AdaptiveStats, AdaptiveError>;

    /// The order of a method on this problem; none where it is exact.
    ///
    /// # Errors
    /// As [`Catalog::with`].
    fn order(&self, method: &MethodSpec) -> Result<Option<usize>, Error>;

    /// The same columns at the end of a span by the exact solution; `None` where none is known.
    fn exact(&self, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>>;

    /// The operations of a step (additions, multiplications, divisions, square roots, sines and
    /// cosines, each as one), in the mean over the first [`COUNTED_STEPS`]; `None` where the method has
    /// none to count, as the exact motion.
    ///
    /// [`COUNTED_STEPS`]: crate::operations::COUNTED_STEPS
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64>;

    /// Can this method run on this problem? Nothing is integrated.
    ///
    /// # Errors
    /// The reason why it cannot.
    fn fits(&self, method: &MethodSpec) -> Result<(), Error> {
        let nowhere = TimeGrid::with_steps([0.0, 0.0], 0)?;
        match self.run(method, &nowhere, &SaveAt::Ends, &mut |_, _| {}) {
            Err(RunError::Setup(error)) => Err(error),
            _ => Ok(()),
        }
    }
}

/// A problem with the methods that fit it.
pub trait Catalog: Problem<Group: LieAlgebra<Scalar: Into<f64>>> {
    /// Find the method that `spec` names and hand it over.
    ///
    /// # Errors
    /// As [`lieflow::catalog::with_method`], for a method that does not fit.
    fn with<V: OnMethod<Self>>(&self, spec: &MethodSpec, on: V) -> Result<V::Out, Error>
    where
        Self: Sized;

    /// The same, with an estimate of its error: of its embedded pair, or by doubling its steps.
    ///
    /// # Errors
    /// As [`with`](Self::with).
    fn with_estimate<V: OnEmbedded<Self>>(&self, spec: &MethodSpec, on: V) -> Result<V::Out, Error>
    where
        Self: Sized;
}

/// [`Catalog`] for an [`Ambient`](lieflow::problems::Ambient) problem, by the catalog's function for its
/// kind, and the one for its embedded pairs. `pointed` is for problems whose methods may stand behind a
/// pointer: on numbers that count nothing is timed, and beside large matrices a call is nothing.
#[macro_export]
macro_rules! catalog {
    ($problem:ty, $with:path) => {
        $crate::catalog!($problem, $with, lieflow::catalog::with_embedded_pair);
    };
    ($problem:ty, $with:path, $pair:path) => {
        $crate::catalog!(@impl $problem, $with, $pair, |spec, on| $with(spec, on));
    };
    (pointed $problem:ty, $with:path) => {
        $crate::catalog!(pointed $problem, $with, lieflow::catalog::with_embedded_pair);
    };
    (pointed $problem:ty, $with:path, $pair:path) => {
        $crate::catalog!(@impl $problem, $with, $pair, |spec, on| {
            $crate::erased::pointed(on, |found| $with(spec, found))
        });
    };
    (@impl $problem:ty, $with:path, $pair:path, |$spec:ident, $on:ident| $find:expr) => {
        impl $crate::model::Catalog for $problem {
            fn with<V: lieflow::catalog::OnMethod<Self>>(
                &self,
                $spec: &lieflow::catalog::MethodSpec,
                $on: V,
            ) -> Result<V::Out, lieflow::Error> {
                $find
            }
            fn with_estimate<V: lieflow::catalog::OnEmbedded<Self>>(
                &self,
                spec: &lieflow::catalog::MethodSpec,
                on: V,
            ) -> Result<V::Out, lieflow::Error> {
                let pair = spec.has_pair()?;
                $crate::erased::pointed_pair(on, |found| match pair {
                    true => $pair(spec, found),
                    false => $with(spec, $crate::erased::Doubled(found)),
                })
            }
        }
    };
}

/// What sees the points of a run. Behind a pointer, so that every kind with a type of problem shares
/// what is compiled for it.
pub type Observer<'a, P> = dyn FnMut(f64, &PointOf<P>) + 'a;

struct Integrate<'a, P: Problem> {
    problem: &'a P,
    y: PointOf<P>,
    grid: &'a TimeGrid,
    save: &'a SaveAt,
    observe: &'a mut Observer<'a, P>,
}

impl<P: Problem> OnMethod<P> for Integrate<'_, P> {
    type Out = Result<Stats, RunError>;
    fn call<M: Method<P>>(self, method: M) -> Self::Out {
        let Integrate { problem, mut y, grid, save, observe } = self;
        integrate(problem, &method, grid, save, &mut y, observe)
    }
}

struct Adapt<'a, P: Problem> {
    problem: &'a P,
    y: PointOf<P>,
    steps: &'a Steps,
    save: &'a SaveAt,
    observe: &'a mut Observer<'a, P>,
}

impl<P: Problem<Group: LieAlgebra<Scalar: Into<f64>>>> OnEmbedded<P> for Adapt<'_, P> {
    type Out = Result<AdaptiveStats, AdaptiveError>;
    fn call<M: Embedded<P>>(self, method: M) -> Self::Out {
        let Adapt { problem, mut y, steps, save, observe } = self;
        let Steps { t_span, control } = steps;
        integrate_adaptive(problem, &method, *t_span, control, save, &mut y, observe)
    }
}

struct Order<'a, P>(&'a P);

impl<P: Problem> OnMethod<P> for Order<'_, P> {
    type Out = usize;
    fn call<M: Method<P>>(self, method: M) -> usize {
        method.order(self.0)
    }
}

/// Integrate `problem` from `y` by the method that `spec` names: what a [`Model::run`] calls.
///
/// # Errors
/// As [`Catalog::with`] and [`integrate`].
pub fn integrate_by<P: Catalog>(
    spec: &MethodSpec,
    problem: &P,
    y: PointOf<P>,
    grid: &TimeGrid,
    save: &SaveAt,
    observe: &mut Observer<'_, P>,
) -> Result<Stats, RunError> {
    problem.with(spec, Integrate { problem, y, grid, save, observe })?
}

/// The same with steps chosen by their error: what a [`Model::adapt`] calls.
///
/// # Errors
/// As [`Catalog::with_estimate`] and [`integrate_adaptive`].
pub fn adapt_by<P: Catalog>(
    spec: &MethodSpec,
    problem: &P,
    y: PointOf<P>,
    steps: &Steps,
    save: &SaveAt,
    observe: &mut Observer<'_, P>,
) -> Result<AdaptiveStats, AdaptiveError> {
    problem.with_estimate(spec, Adapt { problem, y, steps, save, observe })?
}

/// The order of the method that `spec` names: what a [`Model::order`] calls.
///
/// # Errors
/// As [`Catalog::with`].
pub fn order_by<P: Catalog>(spec: &MethodSpec, problem: &P) -> Result<Option<usize>, Error> {
    let order = problem.with(spec, Order(problem))?;
    Ok((order != usize::MAX).then_some(order))
}
