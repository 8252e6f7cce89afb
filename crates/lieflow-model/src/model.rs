//! A problem ready to run, whatever its types: one dynamic dispatch a run.

use core::fmt::Debug;

use lieflow::adaptive::{Adaptive, AdaptiveError, AdaptiveStats, integrate_adaptive};
use lieflow::catalog::{MethodSpec, MethodsByName};
use lieflow::groups::LieAlgebra;
use lieflow::methods::Method;
use lieflow::problems::PointOf;
use lieflow::{Error, RunError, SaveAt, Stats, TimeGrid, integrate};

use crate::operations::Pace;
use crate::schema::{Row, Schema};

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
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    /// From when to when.
    pub t_span: [f64; 2],
    /// Tolerances and limits.
    pub control: Adaptive,
}

/// What gets the rows of a run, each with its t.
pub type Sink<'a> = dyn FnMut(f64, Row<'_>) + 'a;

/// A problem with its initial state and the quantities that are asked of it.
pub trait Model: Debug {
    /// The observables of its rows.
    fn schema(&self) -> &Schema;

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
    /// As [`MethodsByName::method`].
    fn order(&self, method: &MethodSpec) -> Result<Option<usize>, Error>;

    /// The values of the schema at the end of a span by the exact solution; `None` where none is known.
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
    fn fits(&self, method: &MethodSpec) -> Result<(), Error>;
}

/// A problem that runs are made of: its methods by name, on numbers that a file can hold.
pub trait Runnable: MethodsByName<Group: LieAlgebra<Scalar: Into<f64>>> + 'static {}
impl<P: MethodsByName<Group: LieAlgebra<Scalar: Into<f64>>> + 'static> Runnable for P {}

/// What sees the points of a run. Behind a pointer, so that every kind with a type of problem shares
/// what is compiled for it.
pub type Observer<'a, P> = dyn FnMut(f64, &PointOf<P>) + 'a;

/// Integrate `problem` from `y` by the method that `spec` names: what a [`Model::run`] calls.
///
/// # Errors
/// As [`MethodsByName::method`] and [`integrate`].
pub fn integrate_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &P,
    mut y: PointOf<P>,
    grid: &TimeGrid,
    save: &SaveAt,
    observe: &mut Observer<'_, P>,
) -> Result<Stats, RunError> {
    integrate(problem, &problem.method(spec)?, grid, save, &mut y, observe)
}

/// The same with steps chosen by their error: what a [`Model::adapt`] calls.
///
/// # Errors
/// As [`MethodsByName::method`] and [`integrate_adaptive`].
pub fn adapt_by<P: Runnable>(
    spec: &MethodSpec,
    problem: &P,
    mut y: PointOf<P>,
    Steps { t_span, control }: &Steps,
    save: &SaveAt,
    observe: &mut Observer<'_, P>,
) -> Result<AdaptiveStats, AdaptiveError> {
    integrate_adaptive(problem, &problem.method(spec)?, *t_span, control, save, &mut y, observe)
}

/// The order of the method that `spec` names: what a [`Model::order`] calls.
///
/// # Errors
/// As [`MethodsByName::method`].
pub fn order_by<P: Runnable>(spec: &MethodSpec, problem: &P) -> Result<Option<usize>, Error> {
    let order = problem.method(spec)?.order(problem);
    Ok((order != usize::MAX).then_some(order))
}

/// Can the method that `spec` names run on the problem? What a [`Model::fits`] calls.
///
/// # Errors
/// The reason why it cannot.
pub fn fits_by<P: Runnable>(spec: &MethodSpec, problem: &P, y: &PointOf<P>) -> Result<(), Error> {
    problem.method(spec)?.work(problem, y).map(drop)
}
