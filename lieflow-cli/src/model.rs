//! A problem ready to run, whatever its types: one dynamic dispatch a run.

use core::fmt::Debug;

use lieflow::catalog::{CatalogGroup, MethodSpec, OnMethod, with_method};
use lieflow::maps::{CoordinateMap, Exp};
use lieflow::methods::Method;
use lieflow::problems::{Ambient, PointOf, Problem};
use lieflow::{Error, RunError, SaveAt, Stats, TimeGrid, integrate};

/// Which code a problem runs on. Methods that stay on the group agree on the two to rounding; the
/// stages of a classical one leave it, and what it makes of an attitude agrees to its order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
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

/// What gets the rows of a run: t and one value per column.
pub type Sink<'a> = dyn FnMut(f64, &[f64]) + 'a;

/// A problem with its initial state and the quantities that are asked of it.
pub trait Model: Debug {
    /// Names of the columns after `t`.
    fn columns(&self) -> Vec<String>;

    /// What is integrated, in words. Nothing else is computed.
    fn modelled(&self) -> Vec<String>;

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

    /// The order of a method on this problem.
    ///
    /// # Errors
    /// As [`with_method`].
    fn order(&self, method: &MethodSpec) -> Result<usize, Error>;

    /// The same columns by the exact solution, `t` after the start; `None` where none is known.
    fn exact(&self, t: f64) -> Option<Result<Vec<f64>, Error>>;

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

struct Integrate<'a, P: Problem, F> {
    problem: &'a P,
    y: PointOf<P>,
    grid: &'a TimeGrid,
    save: &'a SaveAt,
    observe: F,
}

impl<P: Problem, F: FnMut(f64, &PointOf<P>)> OnMethod<P> for Integrate<'_, P, F> {
    type Out = Result<Stats, RunError>;
    fn call<M: Method<P>>(self, method: M) -> Self::Out {
        let Integrate { problem, mut y, grid, save, observe } = self;
        integrate(problem, &method, grid, save, &mut y, observe)
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
/// As [`with_method`] and [`integrate`].
pub fn integrate_by<P: Ambient>(
    spec: &MethodSpec,
    problem: &P,
    y: PointOf<P>,
    grid: &TimeGrid,
    save: &SaveAt,
    observe: impl FnMut(f64, &PointOf<P>),
) -> Result<Stats, RunError>
where
    P::Group: CatalogGroup,
    Exp: CoordinateMap<P::Group>,
{
    with_method(spec, Integrate { problem, y, grid, save, observe })?
}

/// The order of the method that `spec` names: what a [`Model::order`] calls.
///
/// # Errors
/// As [`with_method`].
pub fn order_by<P: Ambient>(spec: &MethodSpec, problem: &P) -> Result<usize, Error>
where
    P::Group: CatalogGroup,
    Exp: CoordinateMap<P::Group>,
{
    with_method(spec, Order(problem))
}
