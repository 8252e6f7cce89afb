//! Rows that are made of those of another model.

use core::cell::RefCell;
use std::sync::Arc;

use lieflow::catalog::MethodSpec;
use lieflow::solve::Next;
use lieflow::{Error, RunError};

use super::model::Model;
use super::run::{EventPlan, Outcome, Plan, RowCurve, Watcher};
use crate::schema::{Row, Schema};

/// The number of this place in a row at t, from the row of the base.
pub(crate) type NumberOf<'a> = dyn Fn(usize, f64, Row<'_>) -> f64 + Send + Sync + 'a;

/// The base, with other rows.
#[derive(Clone, Copy)]
pub(crate) struct Mapped<'a> {
    pub(crate) base: &'a Model,
    pub(crate) schema: &'a Schema,
    pub(crate) number: &'a NumberOf<'a>,
}

/// A watcher of the base that gives its own watcher the mapped rows.
struct OfBase<'a> {
    mapped: Mapped<'a>,
    watcher: &'a mut dyn Watcher,
    numbers: Vec<f64>,
}

impl OfBase<'_> {
    /// numbers ← the row at t from that of the base.
    fn fill(&mut self, t: f64, of_base: Row<'_>) {
        self.numbers.clear();
        let places = 0..self.mapped.schema.numbers();
        self.numbers.extend(places.map(|place| (self.mapped.number)(place, t, of_base)));
    }
}

impl Watcher for OfBase<'_> {
    fn row(&mut self, t: f64, of_base: Row<'_>) -> Next {
        self.fill(t, of_base);
        self.watcher.row(t, self.mapped.schema.row(&self.numbers))
    }
    fn event(&mut self, event: usize, t: f64, rising: bool, of_base: Row<'_>) {
        self.fill(t, of_base);
        self.watcher.event(event, t, rising, self.mapped.schema.row(&self.numbers));
    }
    fn end_of_step(&mut self, t: f64, of_base: Row<'_>) {
        self.fill(t, of_base);
        self.watcher.end_of_step(t, self.mapped.schema.row(&self.numbers));
    }
    fn progress(&mut self, t: f64) {
        self.watcher.progress(t);
    }
    fn state(&mut self, bytes: &[u8]) {
        self.watcher.state(bytes);
    }
}

impl Mapped<'_> {
    /// Runs the base and gives the watcher the mapped rows.
    pub(crate) fn drive(
        self,
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
        let mut of_base = OfBase { mapped: self, watcher, numbers: Vec::new() };
        self.base.drive(method, plan, &mut of_base)
    }

    /// The values at the end of a span by the exact solution of the base.
    pub(crate) fn exact(self, t_span: [f64; 2]) -> Option<Result<Vec<f64>, Error>> {
        let end = self.base.exact(t_span)?;
        // An exact solution has no sizes.
        let values = 0..self.schema.columns().count();
        Some(end.map(|end| {
            let of_base = self.base.schema().row(&end);
            values.map(|place| (self.number)(place, t_span[1], of_base)).collect()
        }))
    }
}

/// The rows at all times, from those of the base.
pub(crate) struct MappedCurve {
    pub(crate) curve: Box<dyn RowCurve>,
    pub(crate) model: Model,
    pub(crate) base: Arc<Model>,
    pub(crate) number: Arc<NumberOf<'static>>,
}

impl RowCurve for MappedCurve {
    fn t_span(&self) -> [f64; 2] {
        self.curve.t_span()
    }
    fn steps(&self) -> usize {
        self.curve.steps()
    }
    fn rows(&self, times: &[f64], values: &mut Vec<f64>) -> Result<(), (usize, RunError)> {
        let mut of_base = Vec::new();
        for (i, &t) in times.iter().enumerate() {
            of_base.clear();
            self.curve.rows(&[t], &mut of_base).map_err(|(_, error)| (i, error))?;
            let row = self.base.schema().row(&of_base);
            let places = 0..self.model.schema().columns().count();
            values.extend(places.map(|place| (self.number)(place, t, row)));
        }
        Ok(())
    }
}
