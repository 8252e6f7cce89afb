//! The keys of the sections that every scene has.

use lieflow::StepControl;
use lieflow::catalog::{MAPS, MethodSpec, TABLEAUS, all_methods};
use lieflow::names::find;
use lieflow::tolerance::Rule;
use lieflow::{Error, SaveAt, TimeGrid};

use super::defaults;
use crate::formula::Lets;
use crate::problem::Layer;
use crate::problem::{Kind, Problem, high_order};
use crate::reader::read_by_keys;
use crate::reader::values::{Real, Span, Whole};
use crate::reader::{Either, KeyPath, Refusal, at_most_one, exactly_one};

read_by_keys! {
    /// `[method]`.
    #[derive(Default)]
    pub(super) struct MethodKeys {
        name: Option<String>,
        map: Option<String>,
        tableau: Option<String>,
        q: Option<Whole<0>>,
        layer: Option<String>,
    }
}

impl MethodKeys {
    /// Is the method left to the program?
    pub(super) fn is_left(&self) -> bool {
        self.name.is_none()
    }

    /// The names of a method and of its parts that there are not.
    pub(super) fn unknown_names(&self) -> Vec<Refusal> {
        let tableaus = || TABLEAUS.iter().map(|info| info.name);
        let parts: [(&str, &str, &Option<String>, Vec<&str>); 3] = [
            ("name", "method", &self.name, all_methods().map(|info| info.name).collect()),
            ("map", "map", &self.map, MAPS.iter().map(|info| info.name).collect()),
            ("tableau", "tableau", &self.tableau, tableaus().collect()),
        ];
        let unknown = parts.into_iter().filter_map(|(key, what, given, names)| {
            let given = given.as_deref()?;
            let key = Some(key.to_owned());
            let known = find(given, names.iter().copied()).is_some();
            (!known).then(|| Refusal { key, ..Refusal::unknown(what, given, &names) })
        });
        unknown.collect()
    }

    /// The method with what it takes by default spelt out, and the layer: the first of those of the
    /// problem where none is named.
    pub(super) fn resolve(self, problem: Option<&Problem>) -> Result<(MethodSpec, Layer), Refusal> {
        let layer = match self.layer {
            Some(name) => Layer::named(&name)?,
            None => problem.and_then(|p| p.layers().first().copied()).unwrap_or_default(),
        };
        // A map or a tableau alone is one for RKMK.
        let is_rkmk = self.map.is_some() || self.tableau.is_some() || self.q.is_some();
        let of_problem = problem.filter(|_| !is_rkmk);
        let default = || of_problem.map_or_else(high_order, Problem::default_method);
        let base = self.name.map_or_else(default, |name| MethodSpec::new(&name, None));
        let method = MethodSpec {
            name: base.name,
            map: self.map.or(base.map),
            tableau: self.tableau.or(base.tableau),
            q: self.q.map(|q| usize::try_from(q.0).unwrap_or(usize::MAX)),
        };
        Ok((with_defaults(method.spelt()?), layer))
    }
}

/// The method with what it takes by default spelt out.
pub(super) fn with_defaults(mut method: MethodSpec) -> MethodSpec {
    if let Ok(info) = method.info() {
        if info.takes_map() && method.map.is_none() {
            method.map = Some("exp".into());
        }
        if info.takes_tableau && method.tableau.is_none() {
            method.tableau = Some("rk4".into());
        }
    }
    method
}

read_by_keys! {
    /// `[time]`.
    #[derive(Debug)]
    pub(super) struct TimeKeys {
        t_span: Span,
        dt: Option<Real>,
        steps: Option<Whole<1>>,
        rtol: Option<Real>,
        atol: Option<Real>,
        h_init: Option<Real>,
        h_min: Option<Real>,
        h_max: Option<Real>,
        max_steps: Option<Whole<1>>,
        tolerance: Option<String>,
        at_knots: Option<bool>,
    }
}

/// The steps that `compare` starts from where a scene leaves them to the error.
const STEPS: u64 = 1000;

/// The rules of tolerances.
const PER_STEP: &str = "per-step";
const PER_LENGTH: &str = "per-length";

impl TimeKeys {
    /// Are the steps left to the program?
    pub(super) fn is_left(&self) -> bool {
        self.dt.is_none() && self.steps.is_none() && self.rtol.is_none() && self.atol.is_none()
    }

    /// Are the steps of one size?
    fn is_fixed(&self) -> bool {
        self.dt.is_some() || self.steps.is_some()
    }

    /// Does a step end at each knot? By default where steps are chosen by their error.
    pub(super) fn at_knots(&self, has_knots: bool) -> Result<bool, Refusal> {
        match self.at_knots {
            Some(_) if !has_knots => {
                let message = "`at_knots` is of `samples` and of magnets: the problem has neither";
                Err(Refusal::at("at_knots", message))
            }
            given => Ok(has_knots && given.unwrap_or(!self.is_fixed())),
        }
    }

    /// The steps of one size, those that are chosen by their error where tolerances are given, and the limit of
    /// their number.
    pub(super) fn resolve(&self) -> Result<(TimeGrid, Option<StepControl>, Option<u64>), Refusal> {
        let max_steps = self.max_steps.map(|n| n.0);
        let [t0, t1] = self.t_span.0;
        if t0 == t1 {
            let message = format!("t_span is empty: it starts and ends at t = {t0}");
            return Err(Refusal::at("t_span", message));
        }
        if let Some(control) = self.adaptive()? {
            let fixed = [("dt", self.dt.is_some()), ("steps", self.steps.is_some())];
            if let Some((key, _)) = fixed.into_iter().find(|(_, given)| *given) {
                let message = format!(
                    "`{key}` fixes the steps and `rtol`, `atol` leave them to the error: expected \
                     one of the two"
                );
                return Err(Refusal::at(key, message));
            }
            let grid = match t1.is_finite() {
                true => TimeGrid::with_steps([t0, t1], STEPS)?,
                false => TimeGrid::new([t0, t1], 1.0)?,
            };
            return Ok((grid, Some(control), max_steps));
        }
        let grid = match exactly_one(("dt", self.dt), ("steps", self.steps))? {
            Either::First(dt) => TimeGrid::new([t0, t1], dt.0)?,
            Either::Second(steps) => TimeGrid::with_steps([t0, t1], steps.0)
                .map_err(|error| Refusal::from(error).renamed(&[("dt", "steps")]))?,
        };
        Ok((grid, None, max_steps))
    }

    /// Tolerances and limits; none where the steps are of one size. Those of the program where none are given.
    fn adaptive(&self) -> Result<Option<StepControl>, Refusal> {
        if self.is_fixed() && self.rtol.is_none() && self.atol.is_none() {
            let limits = [
                ("h_init", self.h_init.is_some()),
                ("h_min", self.h_min.is_some()),
                ("h_max", self.h_max.is_some()),
                ("tolerance", self.tolerance.is_some()),
            ];
            return match limits.into_iter().find(|(_, given)| *given) {
                None => Ok(None),
                Some((key, _)) => {
                    let fixed = if self.dt.is_some() { "dt" } else { "steps" };
                    let message = format!(
                        "`{key}` is for steps chosen by error: give `rtol` or `atol` instead of `{fixed}`"
                    );
                    Err(Refusal::at(key, message))
                }
            };
        }
        if let Some(other) = self.tolerance.as_deref()
            && ![PER_STEP, PER_LENGTH].contains(&other)
        {
            let message =
                format!("unknown rule `{other}`, expected \"{PER_STEP}\" or \"{PER_LENGTH}\"");
            return Err(Refusal::at("tolerance", message));
        }
        let names = [("first_step", "h_init"), ("min_step", "h_min"), ("max_step", "h_max")];
        self.control(1.0).map(Some).map_err(|error| Refusal::from(error).renamed(&names))
    }

    /// Take the tolerances for a method of this order.
    pub(super) fn for_order(&mut self, order: Option<usize>) {
        let tolerance = Some(Real(defaults::tolerance(order)));
        (self.rtol, self.atol) = (tolerance, tolerance);
    }

    /// rtol and atol. Both are 1 while the steps are left to the program.
    pub(super) fn tolerances(&self) -> [f64; 2] {
        let left = if self.is_left() { 1.0 } else { 0.0 };
        [self.rtol, self.atol].map(|x| x.map_or(left, |x| x.0))
    }

    /// Limits of steps, and the tolerances times a factor. With another factor than 1 the first step is chosen, and ten
    /// times as many steps may be taken.
    pub(super) fn control(&self, factor: f64) -> Result<StepControl, Error> {
        let [rtol, atol] = self.tolerances().map(|tolerance| factor * tolerance);
        let per_length = self.tolerance.as_deref() == Some(PER_LENGTH);
        let rule = if per_length { Rule::PerLength } else { Rule::PerStep };
        let mut control = StepControl::new(rtol, atol)?.rule(rule);
        let is_own = factor == 1.0;
        if let Some(h) = self.h_init.filter(|_| is_own) {
            control = control.first_step(h.0)?;
        }
        if let Some(h) = self.h_max {
            control = control.max_step(h.0)?;
        }
        if let Some(h) = self.h_min {
            control = control.min_step(h.0)?;
        }
        if let Some(n) = self.max_steps {
            control = control.max_steps(if is_own { n.0 } else { n.0.saturating_mul(10) })?;
        }
        Ok(control)
    }
}

read_by_keys! {
    /// `[output]`.
    #[derive(Default)]
    pub(super) struct OutputKeys {
        pub(super) quantities: Option<Vec<String>>,
        formulas: Lets,
        plot: Option<Vec<String>>,
        every: Option<Whole<1>>,
        times: Option<Vec<Real>>,
        count: Option<Whole<1>>,
        interval: Option<Real>,
        times_by: Option<String>,
        error_check: Option<bool>,
    }
}

/// What `[output]` asks for.
pub(super) struct Output {
    pub(super) quantities: Vec<String>,
    pub(super) formulas: Lets,
    pub(super) plot: Vec<String>,
    pub(super) save: SaveAt,
    pub(super) times_by_steps: bool,
    pub(super) error_check: bool,
}

impl OutputKeys {
    /// Are the times of the rows left to the program?
    pub(super) fn leaves_rows(&self) -> bool {
        !self.has_times() && self.every.is_none()
    }

    /// Are there times that need not be ends of steps?
    fn has_times(&self) -> bool {
        self.times.is_some() || self.count.is_some() || self.interval.is_some()
    }

    /// Spells the quantities as the kind does.
    pub(super) fn spell(&mut self, kind: &Kind) {
        let plot = self.plot.iter_mut().flatten();
        for name in self.quantities.iter_mut().flatten().chain(plot) {
            if let Ok(known) = kind.quantity(name) {
                *name = known.name.into();
            }
        }
    }

    /// The mistakes in the list of quantities.
    pub(super) fn wrong_quantities(&self, kind: &Kind, problem: Option<&Problem>) -> Vec<Refusal> {
        let Some(asked) = &self.quantities else { return Vec::new() };
        if asked.is_empty() {
            let names: Vec<_> = (kind.quantities)().iter().map(|quantity| quantity.name).collect();
            let mut refusal = Refusal::at("quantities", "no quantities, expected at least one");
            refusal.help = Some(format!("choose from {}", names.join(", ")));
            return vec![refusal];
        }
        let wrong = |(i, name): (usize, &String)| {
            let key = Some("quantities".index(i));
            if let Err(error) = kind.quantity(name) {
                return Some(Refusal { key, ..error.into() });
            }
            let message = match problem.map(|problem| problem.columns(name)) {
                _ if asked[..i].contains(name) => {
                    format!("quantity `{name}` is asked for twice")
                }
                Some(Err(Error::Unsupported { why, .. })) => {
                    format!("this problem has no `{name}`: {why}")
                }
                _ => return None,
            };
            Some(Refusal { key, ..Refusal::section(message) })
        };
        asked.iter().enumerate().filter_map(wrong).collect()
    }

    /// Resolves the keys, with these quantities. `steps_left` says that the program chooses the steps.
    pub(super) fn resolve(
        self,
        quantities: Vec<String>,
        grid: &TimeGrid,
        steps_left: bool,
    ) -> Result<Output, Refusal> {
        let save = self.save(grid.t_span(), steps_left)?;
        let times_by_steps = match self.times_by.as_deref() {
            None | Some("dense") => false,
            Some("steps") => true,
            Some(other) => {
                let refusal = Refusal::unknown("way", other, &["dense", "steps"]);
                return Err(Refusal { key: Some("times_by".into()), ..refusal });
            }
        };
        let error_check = self.error_check.unwrap_or(true);
        let OutputKeys { formulas, plot, .. } = self;
        let plot = plot.unwrap_or_default();
        Ok(Output { quantities, formulas, plot, save, times_by_steps, error_check })
    }

    /// Where rows are written.
    fn save(&self, [t0, t1]: [f64; 2], steps_left: bool) -> Result<SaveAt, Refusal> {
        if self.times_by.is_some() && !self.has_times() {
            let message =
                "`times_by` is for `times`, `count` and `interval`: add one, or leave this";
            return Err(Refusal::at("times_by", message));
        }
        at_most_one([
            ("every", self.every.is_some()),
            ("times", self.times.is_some()),
            ("count", self.count.is_some()),
            ("interval", self.interval.is_some()),
        ])?;
        let intervals = |count: u64| SaveAt::Interval((t1 - t0).abs() / count as f64);
        let save = match (self.every, &self.times, self.count, self.interval) {
            (Some(every), ..) => SaveAt::Every(every.0),
            (_, Some(times), ..) => SaveAt::Times(times.iter().map(|t| t.0).collect()),
            (_, _, Some(_), _) if !t1.is_finite() => {
                let message = "`count` divides a span with an end: expected `interval`, such as \
                               interval = 0.1";
                return Err(Refusal::at("count", message));
            }
            (_, _, Some(count), _) => intervals(count.0),
            (_, _, _, Some(interval)) => SaveAt::Interval(interval.0),
            _ if steps_left && t1.is_finite() => intervals(defaults::INTERVALS),
            _ => SaveAt::Every(1),
        };
        save.check([t0, t1])?;
        Ok(with_ends(save, [t0, t1]))
    }
}

/// The start of a run is a row whatever the times, and the end, where it is known.
fn with_ends(save: SaveAt, [t0, t1]: [f64; 2]) -> SaveAt {
    let SaveAt::Times(mut times) = save else { return save };
    if times.first() != Some(&t0) {
        times.insert(0, t0);
    }
    if times.last() != Some(&t1) && t1.is_finite() {
        times.push(t1);
    }
    SaveAt::Times(times)
}
