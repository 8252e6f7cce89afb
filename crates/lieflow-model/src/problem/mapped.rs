//! A model whose rows are made of those of another one.

use core::cell::RefCell;
use core::fmt;

use lieflow::catalog::MethodSpec;
use lieflow::solve::Next;
use lieflow::{Error, RunError};

use super::model::{EventPlan, Model, Orders, Outcome, Plan, Steps, Watcher};
use crate::schema::{Row, Schema};

/// The number of this place in the row at t of the model, from the row of its base.
pub(crate) type NumberOf = dyn Fn(usize, f64, Row<'_>) -> f64;

/// The base, with other rows.
pub(crate) struct Mapped {
    pub(crate) base: Box<dyn Model>,
    pub(crate) schema: Schema,
    /// What is integrated in words, if the words differ from those of the base.
    pub(crate) modelled: Option<&'static str>,
    pub(crate) number: Box<NumberOf>,
}

impl Mapped {
    /// numbers ← the row at t from that of the base.
    fn fill(&self, t: f64, of_base: Row<'_>, numbers: &mut Vec<f64>) {
        numbers.clear();
        let places = 0..self.schema.numbers();
        numbers.extend(places.map(|place| (self.number)(place, t, of_base)));
    }
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
        self.model.fill(t, of_base, &mut self.numbers);
        self.watcher.row(t, self.model.schema.row(&self.numbers))
    }
    fn event(&mut self, event: usize, t: f64, rising: bool, of_base: Row<'_>) {
        self.model.fill(t, of_base, &mut self.numbers);
        self.watcher.event(event, t, rising, self.model.schema.row(&self.numbers));
    }
    fn end_of_step(&mut self, t: f64, of_base: Row<'_>) {
        self.model.fill(t, of_base, &mut self.numbers);
        self.watcher.end_of_step(t, self.model.schema.row(&self.numbers));
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
            let EventPlan { value, places, .. } = event;
            let numbers = RefCell::new(vec![f64::NAN; self.schema.numbers()]);
            // Nothing else of the row is computed.
            let value = move |t: f64, of_base: Row<'_>| {
                let mut numbers = numbers.borrow_mut();
                places.iter().for_each(|&place| numbers[place] = (self.number)(place, t, of_base));
                value(t, self.schema.row(&numbers))
            };
            // The numbers here may be made of any of the base, which may be mapped itself.
            let places = (0..self.base.schema().numbers()).collect();
            EventPlan { value: Box::new(value), places, ..event }
        });
        let plan = Plan { events: events.collect(), ..plan };
        let mut of_base = OfBase { model: self, watcher, numbers: Vec::new() };
        self.base.drive(method, plan, &mut of_base)
    }
    fn orders(&self, method: &MethodSpec) -> Result<Orders, Error> {
        self.base.orders(method)
    }
    fn problem_type(&self, method: &MethodSpec) -> &'static str {
        self.base.problem_type(method)
    }
    fn exact(&self, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>> {
        let end = self.base.exact(t_span)?;
        // An exact solution has no sizes.
        let values = 0..self.schema.columns().count();
        Some(end.map(|end| {
            let of_base = self.base.schema().row(&end);
            values.map(|place| (self.number)(place, t_span[1], of_base)).collect()
        }))
    }
    fn operations(&self, method: &MethodSpec, steps: &Steps) -> Option<f64> {
        self.base.operations(method, steps)
    }
    fn fits(&self, method: &MethodSpec) -> Result<(), Error> {
        self.base.fits(method)
    }
}
