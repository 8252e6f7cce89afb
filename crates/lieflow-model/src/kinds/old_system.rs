//! What is the same for every kind: from what is its own, [`System`], to its [`ProblemSpec`] and its
//! [`Model`].

use core::fmt::{self, Debug};

use lieflow::adaptive::{AdaptiveError, AdaptiveStats};
use lieflow::catalog::MethodSpec;
use lieflow::problems::PointOf;
use lieflow::{Error, RunError, SaveAt, Stats, TimeGrid};

use super::law::{Law, SIZE};
use super::{Fact, Figure, Kind, ProblemSpec, QuantityInfo};
use crate::model::{
    Layer, Model, Runnable, Sink, Steps, adapt_by, fits_by, integrate_by, order_by,
};
use crate::operations::{Pace, operations_by};
use crate::scene::Refusal;

/// A problem of one kind, as its scene states it and checked: what the kind's file is about.
pub(super) trait System: Clone + Debug + Send + Sync + 'static {
    /// The problem of the library.
    type Problem: Runnable + Debug;

    /// Its entry in the list of kinds.
    fn kind(&self) -> &'static Kind;
    /// The layer that it is made of.
    fn layer(&self) -> Layer;
    /// The problem, and y(t₀).
    fn problem(&self) -> Result<(Self::Problem, PointOf<Self::Problem>), Error>;
    /// See [`ProblemSpec::check_start`].
    fn check_start(&self, _t0: f64) -> Result<(), Refusal> {
        Ok(())
    }
    /// What is integrated, in words.
    fn modelled(&self) -> String;
    /// The quantities that make up the state.
    fn state(&self) -> &'static [&'static str];
    /// What the exact motion keeps.
    fn laws(&self) -> Vec<Law>;
    /// The columns of a quantity; those of the kind, where the size of the problem does not matter.
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        quantity.column_names()
    }
    /// The values of a quantity at y, `t` after the start, go to the end of `row`.
    fn show(&self, quantity: &str, t: f64, y: &PointOf<Self::Problem>, row: &mut Vec<f64>);
    /// The sizes of the terms that an invariant is the sum of, for
    /// [`Scale::Terms`](super::Scale::Terms).
    fn size(&self, _quantity: &str, _y: &PointOf<Self::Problem>) -> f64 {
        f64::NAN
    }
    /// y at the end of a span, where it is known.
    fn exact(&self, _t_span: [f64; 2]) -> Option<Result<PointOf<Self::Problem>, Error>> {
        None
    }
    /// The operations of a step: see [`Model::operations`]. A problem of vectors counts them on the numbers
    /// that count, matrices say what they compute.
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let (problem, start) = self.problem().ok()?;
        operations_by(method, &problem, start, pace)
    }
    /// The figure of a run.
    fn figure(&self) -> Figure {
        Figure::Lines(self.state()[0])
    }
    /// The field that [`Figure::Map`] draws, from its quantity: rows from north to south, columns from
    /// west to east.
    fn field(&self, _values: &[f64]) -> Vec<Vec<f64>> {
        Vec::new()
    }
    /// What is known before any run.
    fn facts(&self) -> Vec<Fact> {
        Vec::new()
    }
}

impl<S: System> ProblemSpec for S {
    fn kind(&self) -> &'static Kind {
        System::kind(self)
    }
    fn layers(&self) -> &'static [Layer] {
        match self.layer() {
            Layer::Closed => &[Layer::Closed],
            Layer::General => &[Layer::General],
        }
    }
    fn columns(&self, quantity: &str) -> Result<Vec<String>, Error> {
        match quantity.strip_suffix(SIZE) {
            Some(_) => Ok(vec![quantity.into()]),
            None => Ok(System::columns(self, &System::kind(self).quantity(quantity)?)),
        }
    }
    fn model(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn Model>, Error> {
        let kind = System::kind(self);
        if layer != self.layer() {
            return Err(Error::Unsupported {
                what: "layer",
                with: format!("`{}` and a problem of kind `{}`", layer.name(), kind.name),
                why: "it has one layer only; leave layer out",
            });
        }
        let (problem, start) = self.problem()?;
        let asked = |name: &&str| match name.strip_suffix(SIZE) {
            Some(name) => Ok(Asked::Size(kind.quantity(name)?)),
            None => Ok(Asked::Value(kind.quantity(name)?)),
        };
        let quantities = quantities.iter().map(asked).collect::<Result<_, Error>>()?;
        Ok(Box::new(SystemModel { system: self.clone(), problem, start, quantities }))
    }
    fn check_start(&self, t0: f64) -> Result<(), Refusal> {
        System::check_start(self, t0)
    }
    fn state(&self, _: &[&str]) -> &'static [&'static str] {
        System::state(self)
    }
    fn invariants(&self, _: &[&str]) -> Vec<Law> {
        self.laws()
    }
    fn figure(&self) -> Figure {
        System::figure(self)
    }
    fn field(&self, values: &[f64]) -> Vec<Vec<f64>> {
        System::field(self, values)
    }
    fn facts(&self) -> Vec<Fact> {
        System::facts(self)
    }
}

/// What a row shows.
#[derive(Clone, Copy, Debug)]
enum Asked {
    Value(QuantityInfo),
    Size(QuantityInfo),
}

/// The model of a [`System`].
struct SystemModel<S: System> {
    system: S,
    problem: S::Problem,
    start: PointOf<S::Problem>,
    quantities: Vec<Asked>,
}

impl<S: System> Debug for SystemModel<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SystemModel").field(&self.system).field(&self.quantities).finish()
    }
}

impl<S: System> SystemModel<S> {
    /// row ← the quantities at y, `t` after the start.
    fn fill(&self, t: f64, y: &PointOf<S::Problem>, row: &mut Vec<f64>) {
        row.clear();
        for asked in &self.quantities {
            match asked {
                Asked::Value(quantity) => self.system.show(quantity.name, t, y, row),
                Asked::Size(quantity) => row.push(self.system.size(quantity.name, y)),
            }
        }
    }

    /// What shows a point as a row.
    fn shown<'a>(&'a self, sink: &'a mut Sink<'_>) -> impl FnMut(f64, &PointOf<S::Problem>) + 'a {
        let (mut row, mut start) = (Vec::new(), None);
        move |t, y| {
            self.fill(t - *start.get_or_insert(t), y, &mut row);
            sink(t, &row);
        }
    }
}

impl<S: System> Model for SystemModel<S> {
    fn columns(&self) -> Vec<String> {
        let columns = |asked: &Asked| match asked {
            Asked::Value(quantity) => self.system.columns(quantity),
            Asked::Size(quantity) => vec![format!("{}{SIZE}", quantity.name)],
        };
        self.quantities.iter().flat_map(columns).collect()
    }
    fn modelled(&self, _: &MethodSpec) -> Vec<String> {
        vec![self.system.modelled()]
    }
    fn run(
        &self,
        method: &MethodSpec,
        grid: &TimeGrid,
        save: &SaveAt,
        sink: &mut Sink<'_>,
    ) -> Result<Stats, RunError> {
        let start = self.start.clone();
        integrate_by(method, &self.problem, start, grid, save, &mut self.shown(sink))
    }
    fn adapt(
        &self,
        method: &MethodSpec,
        steps: &Steps,
        save: &SaveAt,
        sink: &mut Sink<'_>,
    ) -> Result<AdaptiveStats, AdaptiveError> {
        let start = self.start.clone();
        adapt_by(method, &self.problem, start, steps, save, &mut self.shown(sink))
    }
    fn order(&self, method: &MethodSpec) -> Result<Option<usize>, Error> {
        order_by(method, &self.problem)
    }
    fn fits(&self, method: &MethodSpec) -> Result<(), Error> {
        fits_by(method, &self.problem, &self.start)
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        self.system.operations(method, pace)
    }
    fn exact(&self, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>> {
        let mut row = Vec::new();
        let exact = self.system.exact(t_span)?;
        let shown = exact.map(|y| self.fill(t_span[1] - t_span[0], &y, &mut row));
        Some(shown.map(|()| row))
    }
}
