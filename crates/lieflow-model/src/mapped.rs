//! A model whose rows are made of those of another one.

use core::cell::RefCell;
use core::fmt;

use lieflow::catalog::MethodSpec;
use lieflow::solve::Next;
use lieflow::{Error, RunError};

use crate::model::{EventPlan, Model, Outcome, Plan, Steps, Watcher};
use crate::schema::{Row, Schema};

/// numbers ← the row at t of the model from that of its base.
pub(crate) type Fill = dyn Fn(f64, Row<'_>, &mut Vec<f64>);

/// The base, with other rows.
pub(crate) struct Mapped {
    pub(crate) base: Box<dyn Model>,
    pub(crate) schema: Schema,
    /// What is integrated in words, if the words differ from those of the base.
    pub(crate) modelled: Option<&'static str>,
    pub(crate) fill: Box<Fill>,
}

impl fmt::Debug for Mapped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Mapped").field(&self.base).field(&self.schema).finish()
    }
}

/// A watcher of the base that gives its own watcher the rows of the model.
struct OfBase<'a> {
    model: &'a Mapped,
    watcher: &'a mut dyn Watcher,
    numbers: Vec<f64>,
}

impl Watcher for OfBase<'_> {
    fn row(&mut self, t: f64, of_base: Row<'_>) -> Next {
        (self.model.fill)(t, of_base, &mut self.numbers);
        self.watcher.row(t, self.model.schema.row(&self.numbers))
    }
    fn event(&mut self, event: usize, t: f64, rising: bool, of_base: Row<'_>) {
        (self.model.fill)(t, of_base, &mut self.numbers);
        self.watcher.event(event, t, rising, self.model.schema.row(&self.numbers));
    }
    fn progress(&mut self, t: f64) {
        self.watcher.progress(t);
    }
    fn state(&mut self, bytes: &[u8]) {
        self.watcher.state(bytes);
    }
}

impl Model for Mapped {
    fn schema(&self) -> &Schema {
        &self.schema
    }
    fn modelled(&self, method: &MethodSpec) -> Vec<String> {
        self.modelled.map_or_else(|| self.base.modelled(method), |words| vec![words.into()])
    }
    fn drive(
        &self,
        method: &MethodSpec,
        mut plan: Plan<'_>,
        watcher: &mut dyn Watcher,
    ) -> Result<Outcome, RunError> {
        let events = core::mem::take(&mut plan.events).into_iter().map(|event| {
            let (value, numbers) = (event.value, RefCell::new(Vec::new()));
            let value = move |t: f64, of_base: Row<'_>| {
                let mut numbers = numbers.borrow_mut();
                (self.fill)(t, of_base, &mut numbers);
                value(t, self.schema.row(&numbers))
            };
            EventPlan { value: Box::new(value), ..event }
        });
        let plan = Plan { events: events.collect(), ..plan };
        let mut of_base = OfBase { model: self, watcher, numbers: Vec::new() };
        self.base.drive(method, plan, &mut of_base)
    }
    fn order(&self, method: &MethodSpec) -> Result<Option<usize>, Error> {
        self.base.order(method)
    }
    fn exact(&self, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>> {
        let mut row = Vec::new();
        let end = self.base.exact(t_span)?;
        let end = end.map(|end| (self.fill)(t_span[1], self.base.schema().row(&end), &mut row));
        row.truncate(self.schema.columns().count());
        Some(end.map(|()| row))
    }
    fn operations(&self, method: &MethodSpec, steps: &Steps) -> Option<f64> {
        self.base.operations(method, steps)
    }
    fn fits(&self, method: &MethodSpec) -> Result<(), Error> {
        self.base.fits(method)
    }
}
