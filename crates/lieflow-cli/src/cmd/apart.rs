//! How far the rows and the zeros of a run are from those of another motion.

use std::sync::atomic::{AtomicBool, Ordering};

use lieflow::solve::Next;
use lieflow_model::problem::Watcher;
use lieflow_model::schema::{Branch, Component, Measure, Observable, Row, length};
use lieflow_timing::{cpu_seconds, larger};

use super::shown::{OwnRows, OwnZeros, Shown};
use super::signs::changes_of_sign;
use super::watch::Watch;
use crate::output::Kind;

/// The part of a step at the end of a run where a zero may be of one run only, by rounding.
const NEAR: f64 = 1e-3;
/// The part of a step over which the slope of an event is taken.
const SLOPE: f64 = 1e-4;
/// The number of halvings that find a zero in its interval.
const HALVINGS: u32 = 8;

/// The parts of the state, with their quantities.
pub(super) fn parts_of<'a>(
    watch: &'a Watch<'_>,
) -> impl Iterator<Item = (&'a Observable, &'a Component)> {
    watch
        .state
        .iter()
        .flat_map(|observable| observable.parts.iter().map(move |part| (*observable, part)))
}

/// The quantities that are written and computed from the state, but for angles and distances from M.
pub(super) fn derived_of<'a>(watch: &'a Watch<'_>) -> impl Iterator<Item = &'a Observable> {
    let is_derived =
        |o: &&&Observable| !o.is_state && !o.is_distance && matches!(o.branch, Branch::Single);
    watch.written.iter().filter(is_derived).copied()
}

/// The distances of a run from another motion.
#[derive(Clone, Debug)]
pub(super) struct Apart {
    /// The number of rows that were compared.
    pub(super) rows: u64,
    /// The distance of each part of the state.
    pub(super) parts: Vec<Largest>,
    /// The distance of each column of these parts.
    pub(super) columns: Vec<Vec<ColumnApart>>,
    /// The distance of each quantity that is computed from the state, by its length.
    pub(super) derived: Vec<ColumnApart>,
    /// The largest distance of each column of the invariants.
    pub(super) laws: Vec<f64>,
    /// The distance of the zeros of each event.
    pub(super) events: Vec<ZerosApart>,
}

/// How far a part of the state is from what it should be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Gap {
    /// The distance.
    pub(super) absolute: f64,
    /// The distance in sizes of the part; that itself, where it is an angle. NaN where no finite size is left.
    pub(super) relative: f64,
}

/// The size of a part of the state in a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    /// That of the start, of the end or of the middle one of the rows, the largest. Errors are relative to it.
    pub(super) largest: f64,
    /// That of the middle one of the rows, in the order of their sizes.
    pub(super) middle: f64,
}

/// How far a column is from what it should be.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ColumnApart {
    /// The largest distance.
    pub(super) gap: f64,
    /// Its largest value, without the sign.
    pub(super) size: f64,
}

/// The largest distance over rows, in sizes of the part, and that of the last row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Largest {
    /// The largest one; not a number, if one is not.
    pub(super) gap: Gap,
    /// Its time.
    pub(super) t: f64,
    /// The last one.
    pub(super) last: Gap,
    /// The largest distance in sizes of the middle row, or of the row where that is larger.
    pub(super) of_middle: f64,
}

impl Largest {
    fn see(&mut self, t: f64, gap: Gap) {
        self.last = gap;
        // A comparison with NaN is false, so a NaN stays.
        if gap.relative >= self.gap.relative || gap.relative.is_nan() {
            (self.gap, self.t) = (gap, t);
        }
    }
}

/// The zeros of an event in two runs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ZerosApart {
    /// The largest distance of two zeros of the same number.
    pub(super) distance: f64,
    /// The zeros of the run.
    pub(super) own: Count,
    /// The zeros of the other one.
    pub(super) other: Count,
}

/// A number of zeros, if some are so near to the end that they may be of one run only.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Count {
    /// Those before the end.
    pub(super) sure: u64,
    /// These and those at the end.
    pub(super) possible: u64,
}

impl Count {
    /// Counts a zero at t of a run.
    fn see(&mut self, t: f64, run: &Shown<'_>) {
        let (before, near) = ((run.t_span[1] - t) * run.direction, NEAR * run.step);
        self.sure += u64::from(before > near);
        self.possible += u64::from(before >= -near);
    }
}

impl ZerosApart {
    /// Do both runs have the same number of zeros?
    pub(super) fn agree(&self) -> bool {
        self.own.sure <= self.other.possible && self.other.sure <= self.own.possible
    }

    /// Are zeros of the same number farther apart than zeros are on average, in a run of this length? Then they are not the
    /// same ones.
    pub(super) fn are_others(&self, length: f64) -> bool {
        self.distance * self.own.possible as f64 > length
    }
}

impl Apart {
    /// No rows yet, and this number of events.
    fn new(watch: &Watch<'_>, events: usize) -> Self {
        let none =
            Largest { gap: Gap::default(), t: f64::NAN, last: Gap::default(), of_middle: 0.0 };
        let parts = parts_of(watch).map(|_| none).collect();
        let columns = parts_of(watch)
            .map(|(_, part)| vec![ColumnApart::default(); part.columns.len()])
            .collect();
        let laws = vec![0.0; watch.laws.iter().map(|law| law.columns.len()).sum()];
        let derived = derived_of(watch).map(|_| ColumnApart::default()).collect();
        let events = vec![ZerosApart::default(); events];
        Apart { rows: 0, parts, columns, derived, laws, events }
    }

    /// The distances of rows from others, each pair with its time.
    pub(super) fn of_rows<'r>(
        watch: &Watch<'_>,
        sizes: &[Size],
        pairs: impl Iterator<Item = (f64, [&'r [f64]; 2])>,
    ) -> Self {
        let mut apart = Apart::new(watch, 0);
        pairs.for_each(|(t, pair)| apart.see(watch, sizes, t, pair));
        apart
    }

    /// The distances of a run from the exact motion. Zeros are compared with those of the exact motion beside them, and
    /// their number with its changes of sign.
    pub(super) fn from_exact(watch: &Watch<'_>, run: &Shown<'_>) -> Result<Self, String> {
        let schema = watch.model.schema();
        let events = run.events(watch)?;
        let mut apart = Apart::new(watch, events.len());
        // Zeros near the end may be of one motion only.
        let [t0, end] = run.t_span;
        let before_end = [t0, end - NEAR * run.step * run.direction];
        let changes = changes_of_sign(watch, before_end, &events);
        for (zeros, changes) in apart.events.iter_mut().zip(changes) {
            zeros.other = Count { sure: changes, possible: u64::MAX };
        }
        let mut own = run.reader()?;
        let (mut row, mut zero) = (0, 0);
        while own.read()? {
            let (kind, t, numbers) = own.records.shown();
            if let Kind::Event(event) = kind {
                apart.events[event].own.see(t, run);
            }
            match kind {
                Kind::Row => {
                    let exact = run.rows.has(row).then(|| watch.exact(t)).flatten();
                    exact
                        .iter()
                        .for_each(|exact| apart.see(watch, &run.sizes, t, [numbers, exact]));
                    row += 1;
                }
                Kind::Event(event) if run.zeros.has(zero) => {
                    let g = |t: f64| match watch.exact(t) {
                        Some(mut exact) => {
                            // The sign of a quaternion is that of the run.
                            schema.follow(numbers, &mut exact);
                            (events[event].value)(t, schema.row(&exact))
                        }
                        None => f64::NAN,
                    };
                    let distance = &mut apart.events[event].distance;
                    *distance = larger(*distance, nearest_zero(g, t, run));
                    zero += 1;
                }
                Kind::Event(_) => zero += 1,
            }
        }
        Ok(apart)
    }

    /// The next row of both; the parts of the state have these sizes.
    fn see(&mut self, watch: &Watch<'_>, sizes: &[Size], t: f64, [a, b]: [&[f64]; 2]) {
        let [a, b] = [a, b].map(|numbers| watch.model.schema().row(numbers));
        self.rows += 1;
        let laws = watch.laws.iter().flat_map(|law| a[*law].iter().zip(&b[*law]));
        self.laws.iter_mut().zip(laws).for_each(|(gap, (a, b))| *gap = gap.max((a - b).abs()));
        for (largest, observable) in self.derived.iter_mut().zip(derived_of(watch)) {
            let [a, b] = [&a[observable], &b[observable]];
            largest.gap = larger(largest.gap, Measure::Length.distance(a, b));
            largest.size = largest.size.max(length(a));
        }
        let parts = parts_of(watch).zip(sizes);
        let own = self.parts.iter_mut().zip(&mut self.columns);
        for ((largest, columns), ((observable, part), size)) in own.zip(parts) {
            let [a, b] = [&a[observable], &b[observable]].map(|row| &row[part.columns.clone()]);
            for (column, (a, b)) in columns.iter_mut().zip(a.iter().zip(b)) {
                column.gap = column.gap.max((a - b).abs());
                column.size = column.size.max(a.abs());
            }
            let absolute = part.measure.distance(a, b);
            // Where the part is larger than elsewhere, so may be its error.
            let in_sizes = |size: f64| match absolute {
                angle if part.measure.is_angle() => angle,
                absolute => relative(absolute, size.max(length(a))),
            };
            largest.see(t, Gap { absolute, relative: in_sizes(size.largest) });
            largest.of_middle = larger(largest.of_middle, in_sizes(size.middle));
        }
    }
}

/// The distance from t to the nearest zero of g, to two digits; not a number, if there is none in the time of the run.
fn nearest_zero(g: impl Fn(f64) -> f64, t: f64, run: &Shown<'_>) -> f64 {
    let at_t = g(t);
    if at_t == 0.0 || at_t.is_nan() {
        return at_t;
    }
    let aside = SLOPE * run.step;
    let by_slope = 2.0 * aside * at_t / (g(t + aside) - g(t - aside));
    // Where the slope changes it tells little, so the sign of g decides. At a pole it tells nothing.
    let rounding = f64::EPSILON * t.abs().max(run.step);
    let first = if by_slope.abs() <= run.step { by_slope.abs().max(rounding) } else { rounding };
    let on_side = |side: f64| {
        let passed = |distance: f64| g(t + side * distance) * at_t <= 0.0;
        let (mut before, mut after) = (0.0, first);
        while !passed(after) {
            (before, after) = (after, 2.0 * after);
            if after > run.length() {
                return f64::NAN;
            }
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (before + after);
            *(if passed(middle) { &mut after } else { &mut before }) = middle;
        }
        after
    };
    // The smaller one, or the one that is a number.
    on_side(1.0).min(on_side(-1.0))
}

/// A distance in sizes. Where one of the two is out of the range of numbers, it is NaN.
fn relative(distance: f64, size: f64) -> f64 {
    match distance {
        _ if !(distance.is_finite() && size.is_finite()) => f64::NAN,
        0.0 => 0.0,
        distance => distance / size,
    }
}

/// What ends a run early.
pub(super) struct Limits<'a> {
    /// The flag that cancels this run.
    pub(super) cancel: &'a AtomicBool,
    /// The flag that ends all runs.
    pub(super) stop: &'a AtomicBool,
    /// The CPU time at which the run ends.
    pub(super) deadline: Option<f64>,
}

impl Limits<'_> {
    /// Cancels the run, if it is time to.
    pub(super) fn look(&self) {
        let late = self.deadline.is_some_and(|deadline| cpu_seconds() > deadline);
        if late || self.stop.load(Ordering::Relaxed) {
            self.cancel.store(true, Ordering::Relaxed);
        }
    }
}

/// Compares a second run with the first as it goes. It shows the rows that are compared.
pub(super) struct Beside<'a> {
    watch: &'a Watch<'a>,
    run: &'a Shown<'a>,
    rows: OwnRows<'a>,
    zeros: OwnZeros<'a>,
    limits: Limits<'a>,
    apart: Apart,
    failure: Option<String>,
}

impl<'a> Beside<'a> {
    pub(super) fn new(
        watch: &'a Watch<'a>,
        run: &'a Shown<'a>,
        limits: Limits<'a>,
    ) -> Result<Self, String> {
        let events = watch.scene.events.len();
        let (rows, zeros) = (run.own_rows()?, run.own_zeros(events)?);
        let apart = Apart::new(watch, events);
        Ok(Beside { watch, run, rows, zeros, limits, apart, failure: None })
    }

    /// The distances, once the second run has ended. None: it did not show all rows.
    pub(super) fn finish(mut self) -> Result<Option<Apart>, String> {
        for event in 0..self.apart.events.len() {
            while let Some(t) = self.zeros.next_of(event)? {
                self.apart.events[event].own.see(t, self.run);
            }
        }
        match self.failure {
            Some(failure) => Err(failure),
            None => Ok((self.apart.rows == self.run.rows.count()).then_some(self.apart)),
        }
    }

    fn see_row(&mut self, t: f64, row: Row<'_>) -> Result<(), String> {
        if let Some((own_t, own)) = self.rows.next_chosen()?
            && own_t == t
        {
            self.apart.see(self.watch, &self.run.sizes, t, [own, row.numbers()]);
        }
        Ok(())
    }

    fn see_zero(&mut self, event: usize, t: f64) -> Result<(), String> {
        let apart = &mut self.apart.events[event];
        apart.other.see(t, self.run);
        if let Some(own) = self.zeros.next_of(event)? {
            apart.own.see(own, self.run);
            apart.distance = larger(apart.distance, (own - t).abs());
        }
        Ok(())
    }

    fn keep(&mut self, seen: Result<(), String>) {
        if let Err(failure) = seen {
            self.failure.get_or_insert(failure);
            self.limits.cancel.store(true, Ordering::Relaxed);
        }
    }
}

impl Watcher for Beside<'_> {
    fn row(&mut self, t: f64, row: Row<'_>) -> Next {
        let seen = self.see_row(t, row);
        self.keep(seen);
        if self.failure.is_some() { Next::Stop } else { Next::Continue }
    }

    fn event(&mut self, event: usize, t: f64, _rising: bool, _row: Row<'_>) {
        let seen = self.see_zero(event, t);
        self.keep(seen);
    }

    fn progress(&mut self, _t: f64) {
        self.limits.look();
    }
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};
    use std::{env, fs, process};

    use lieflow::SaveAt;
    use lieflow_model::problem::Plan;
    use lieflow_model::scene::Scene;

    use super::*;
    use crate::cmd::shown::Choice;
    use crate::cmd::watch::quantities;
    use crate::output::RunState;

    /// A folder that goes away with its value.
    struct Folder(PathBuf);

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    /// The number of the row, from 0, and of the zero, that are changed.
    const CHANGED: [usize; 2] = [30, 1];

    /// Records what a run shows. Row `CHANGED` gets a wrong number, and zero `CHANGED` a wrong time, or none at all.
    struct Wrong {
        state: RunState,
        rows: usize,
        zeros: usize,
        by: f64,
        late: Option<f64>,
    }

    impl Watcher for Wrong {
        fn row(&mut self, t: f64, row: Row<'_>) -> Next {
            let mut numbers = row.numbers().to_vec();
            numbers[0] += if self.rows == CHANGED[0] { self.by } else { 0.0 };
            self.rows += 1;
            self.state.record(Kind::Row, t, &numbers).unwrap();
            Next::Continue
        }
        fn event(&mut self, event: usize, t: f64, _rising: bool, row: Row<'_>) {
            let late = if self.zeros == CHANGED[1] { self.late } else { Some(0.0) };
            self.zeros += 1;
            if let Some(late) = late {
                self.state.record(Kind::Event(event), t + late, row.numbers()).unwrap();
            }
        }
    }

    /// The distances of a run with a wrong row and a wrong zero from the exact motion, and from the run itself.
    fn apart(name: &str, by: f64, late: Option<f64>) -> [Apart; 2] {
        let text = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.1, 1, 0.1]\n\
                    [time]\nt_span = [0, 60]\n\
                    [output]\nquantities = [\"momentum_body\"]\ninterval = 0.5\n\
                    [[events]]\nname = \"flip\"\nwhen = \"w2\"\n";
        let scene = Scene::parse("scene", text).unwrap();
        let model = scene.model_with(scene.layer, &quantities(&scene)).unwrap();
        let watch = Watch::new(&scene, &model).unwrap();
        let folder = env::temp_dir().join(format!("lieflow-apart-{name}-{}", process::id()));
        fs::create_dir_all(&folder).unwrap();
        let folder = Folder(folder);
        let plan = || scene.plan(model.schema()).unwrap();
        let state = RunState::begin(Path::new(&folder.0), 0).unwrap();
        let mut wrong = Wrong { state, rows: 0, zeros: 0, by, late };
        let stats = model.drive(&scene.method, plan(), &mut wrong).unwrap().stats;
        let [stop, cancel] = [(); 2].map(|()| AtomicBool::new(false));
        let run = Shown {
            records: wrong.state.shown().unwrap(),
            rows: Choice::new(wrong.rows as u64, 1000),
            zeros: Choice::new(wrong.zeros as u64, 1000),
            sizes: vec![Size { largest: 1.0, middle: 1.0 }],
            t_span: [0.0, 60.0],
            direction: 1.0,
            step: stats.largest_step,
            stop: &stop,
        };
        let exact = Apart::from_exact(&watch, &run).unwrap();
        let limits = Limits { cancel: &cancel, stop: &stop, deadline: None };
        let mut beside = Beside::new(&watch, &run, limits).unwrap();
        let save = SaveAt::Times(run.times().unwrap());
        let plan = Plan { save, times_by_steps: true, ..plan() };
        model.drive(&scene.method, plan, &mut beside).unwrap();
        [exact, beside.finish().unwrap().unwrap()]
    }

    #[test]
    fn a_wrong_row_and_a_wrong_zero_are_found() {
        for apart in apart("wrong", 1e-3, Some(1e-4)) {
            let Largest { gap, t, last, .. } = apart.parts[0];
            assert_eq!((apart.rows, t), (121, 15.0));
            assert!((gap.absolute - 1e-3).abs() < 1e-9, "{gap:?}");
            assert!(last.absolute < 1e-9, "{last:?}");
            // The momentum is twice as long as its size here.
            assert!((1.9..2.1).contains(&(gap.absolute / gap.relative)), "{gap:?}");
            let zeros = apart.events[0];
            assert!((zeros.distance - 1e-4).abs() < 2e-6 && zeros.agree(), "{zeros:?}");
        }
    }

    #[test]
    fn a_right_run_is_right_and_a_missing_zero_is_missed() {
        for apart in apart("right", 0.0, Some(0.0)) {
            assert!(apart.parts[0].gap.absolute < 1e-9, "{:?}", apart.parts);
            assert!(apart.events[0].distance < 1e-9 && apart.events[0].agree());
        }
        let [_, apart] = apart("missing", 0.0, None);
        let ZerosApart { own, other, .. } = apart.events[0];
        assert_eq!((own.possible, other.possible), (4, 5));
        assert!(!apart.events[0].agree());
    }

    #[test]
    fn a_distance_that_is_no_number_stays() {
        let gap = |x: f64| Gap { absolute: x, relative: x };
        let mut largest = Largest { gap: gap(0.0), t: 0.0, last: gap(0.0), of_middle: 0.0 };
        for (t, x) in [(1.0, 2.0), (2.0, f64::NAN), (3.0, 5.0)] {
            largest.see(t, gap(x));
        }
        assert!(largest.gap.relative.is_nan());
        assert_eq!((largest.t, largest.last), (2.0, gap(5.0)));
    }
}
