//! Rows that are made of those of another model.

use core::cell::RefCell;
use std::sync::Arc;
use std::time::Duration;

use lieflow::catalog::MethodSpec;
use lieflow::solve::Next;
use lieflow::{Error, RunError, Stats};
use lieflow_runs::run::{EventPlan, Outcome, Plan, RowCurve, Stepper, Watcher};
use lieflow_runs::schema::{Row, Schema};

use super::model::Model;

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
    fn followed(&mut self, t: f64, of_base: Row<'_>, is_sure: bool) {
        self.fill(t, of_base);
        self.watcher.followed(t, self.mapped.schema.row(&self.numbers), is_sure);
    }
    fn progress(&mut self, t: f64) {
        self.watcher.progress(t);
    }
    fn state(&mut self, bytes: &[u8]) {
        self.watcher.state(bytes);
    }
    fn end(&mut self, t: f64, state: &[f64], of_base: Row<'_>, stats: &Stats) {
        self.fill(t, of_base);
        self.watcher.end(t, state, self.mapped.schema.row(&self.numbers), stats);
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
        let done = self.base.drive(method, plan, &mut of_base)?;
        of_base.fill(done.t, self.base.schema().row(&done.row));
        Ok(Outcome { row: of_base.numbers, ..done })
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

/// What makes the values of rows of those of the base, for what outlives a run.
#[derive(Clone)]
pub(crate) struct RowMap {
    base: Schema,
    columns: usize,
    number: Arc<NumberOf<'static>>,
}

impl RowMap {
    pub(crate) fn new(base: &Schema, schema: &Schema, number: Arc<NumberOf<'static>>) -> Self {
        RowMap { base: base.clone(), columns: schema.columns().count(), number }
    }

    /// Appends the values at t, from those of the base.
    fn append(&self, t: f64, of_base: &[f64], values: &mut Vec<f64>) {
        let row = self.base.row(of_base);
        values.extend((0..self.columns).map(|place| (self.number)(place, t, row)));
    }
}

/// The rows at all times, from those of the base.
pub(crate) struct MappedCurve {
    pub(crate) curve: Box<dyn RowCurve>,
    pub(crate) map: RowMap,
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
        self.curve.rows(times, &mut of_base)?;
        let width = self.map.base.columns().count();
        for (i, &t) in times.iter().enumerate() {
            self.map.append(t, &of_base[i * width..][..width], values);
        }
        Ok(())
    }
    fn numbers(&self) -> Vec<f64> {
        self.curve.numbers()
    }
}

/// A run that the caller takes step by step, with the rows of another model.
pub(crate) struct MappedStepper {
    pub(crate) run: Box<dyn Stepper>,
    pub(crate) map: RowMap,
}

impl Stepper for MappedStepper {
    fn t(&self) -> f64 {
        self.run.t()
    }
    fn t_end(&self) -> f64 {
        self.run.t_end()
    }
    fn stats(&self) -> Stats {
        self.run.stats()
    }
    fn row(&self, values: &mut Vec<f64>) {
        let mut of_base = Vec::new();
        self.run.row(&mut of_base);
        self.map.append(self.t(), &of_base, values);
    }
    fn state(&self) -> Vec<f64> {
        self.run.state()
    }
    fn set_state(&mut self, numbers: &[f64]) -> Result<(), RunError> {
        self.run.set_state(numbers)
    }
    fn step(&mut self) -> Result<f64, RunError> {
        self.run.step()
    }
    fn advance_for(&mut self, t: f64, limit: Duration) -> Result<bool, RunError> {
        self.run.advance_for(t, limit)
    }
    fn interpolate(&mut self, t: f64, values: &mut Vec<f64>) -> Result<(), RunError> {
        let mut of_base = Vec::new();
        self.run.interpolate(t, &mut of_base)?;
        self.map.append(t, &of_base, values);
        Ok(())
    }
    fn save(&mut self) -> Vec<u8> {
        self.run.save()
    }
    fn restore(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.run.restore(bytes)
    }
}
