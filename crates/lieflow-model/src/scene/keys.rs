//! The keys of the sections that every scene has.

use core::fmt::Display;

use lieflow::StepControl;
use lieflow::catalog::{MAPS, MethodSpec, TABLEAUS};
use lieflow::error::Plain;
use lieflow::names::{find, same};
use lieflow::tolerance::Rule;
use lieflow::{Error, SaveAt, TimeGrid};

use super::defaults;
use super::plot::{Entry, PlotFigure};
use crate::formula::Lets;
use crate::kinds;
use crate::problem::{Kind, Layer, Problem, high_order};
use crate::reader::values::{Real, Span, Whole};
use crate::reader::{
    Either, Key, KeyPath, Read, ReadError, Refusal, Shape, all, at_most_one, read_by_keys, seen,
};

read_by_keys! {
    /// `[method]`.
    pub(super) struct MethodKeys {
        name: Key<Option<String>>,
        map: Key<Option<String>>,
        tableau: Key<Option<String>>,
        q: Key<Option<Whole<0>>>,
        layer: Key<Option<String>>,
    }
}

/// The sections of a scene and their keys. Those of [problem] are the keys of a kind.
pub(super) fn sections(kind: Option<&str>) -> [(&'static str, Vec<&'static str>); 4] {
    let names = |shape: Shape| match shape {
        Shape::Keys(keys) => keys.iter().map(|(name, _)| *name).collect(),
        _ => Vec::new(),
    };
    let kind = kind.and_then(|kind| kinds::named(kind).ok());
    let of_problem = kind.map_or_else(Vec::new, |kind| kind.keys.iter().map(|k| k.name).collect());
    [
        ("time", names(TimeKeys::SHAPE)),
        ("problem", of_problem),
        ("output", names(OutputKeys::SHAPE)),
        ("method", names(MethodKeys::SHAPE)),
    ]
}

/// A name, where it is one of these or is not given.
fn known(
    key: &str,
    what: &str,
    given: Key<Option<String>>,
    names: Vec<&str>,
) -> Result<Option<String>, ReadError> {
    match given? {
        Some(given) if find(&given, names.iter().copied()).is_none() => {
            Err(Refusal::unknown(what, &given, &names).about(key).into())
        }
        given => Ok(given),
    }
}

/// A part of a method by its key, which must not contradict the one in the name of the method.
fn no_other<T: Display>(
    key: &str,
    given: &Option<T>,
    named: &MethodSpec,
    part: &Option<T>,
    agree: impl Fn(&T, &T) -> bool,
) -> Result<(), Refusal> {
    match (given, part) {
        (Some(given), Some(part)) if !agree(given, part) => {
            let name = named.label();
            let message = format!(
                "`{key}` is {given} and the method `{name}` has {part}, expected one of the two"
            );
            Err(Refusal::at(key, message))
        }
        _ => Ok(()),
    }
}

impl MethodKeys {
    /// Is the method left to the program?
    pub(super) fn is_left(&self) -> bool {
        matches!(self.name, Ok(None))
    }

    /// The method with what it takes by default spelt out, and the layer: the first of those of the
    /// problem where none is named.
    pub(super) fn resolve(
        self,
        problem: Option<&Problem>,
    ) -> Result<(MethodSpec, Layer), ReadError> {
        let MethodKeys { name, map, tableau, q, layer } = self;
        let named = name.and_then(|name| {
            let method = name.map(|name| name.parse::<MethodSpec>()).transpose();
            method.map_err(|error| Refusal::from(error).about("name").into())
        });
        let map = known("map", "map", map, MAPS.iter().map(|info| info.name).collect());
        let tableaus = TABLEAUS.iter().map(|info| info.name).collect();
        let tableau = known("tableau", "tableau", tableau, tableaus);
        let layer = layer.and_then(|layer| match layer {
            Some(name) => Ok(Layer::named(&name)?),
            None => Ok(problem.and_then(|p| p.layers().first().copied()).unwrap_or_default()),
        });
        let q = q.map(|q| q.map(|q| usize::try_from(q.0).unwrap_or(usize::MAX)));
        let (named, map, tableau, q, layer) = all!(named, map, tableau, q, layer)?;
        if let Some(named) = &named {
            let agree = |a: &String, b: &String| same(a, b);
            let map = no_other("map", &map, named, &named.map, agree);
            let tableau = no_other("tableau", &tableau, named, &named.tableau, agree);
            let q = no_other("q", &q, named, &named.q, usize::eq);
            all!(map, tableau, q)?;
        }
        // A map or a tableau alone is one for RKMK.
        let is_rkmk = map.is_some() || tableau.is_some() || q.is_some();
        let of_problem = problem.filter(|_| !is_rkmk);
        let default = || of_problem.map_or_else(high_order, Problem::default_method);
        let base = named.unwrap_or_else(default);
        let method = MethodSpec {
            name: base.name,
            map: map.or(base.map),
            tableau: tableau.or(base.tableau),
            q: q.or(base.q),
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
    pub(super) struct TimeKeys {
        t_span: Key<Span>,
        dt: Key<Option<Real>>,
        steps: Key<Option<Whole<1>>>,
        rtol: Key<Option<Real>>,
        atol: Key<Option<Real>>,
        h_init: Key<Option<Real>>,
        h_min: Key<Option<Real>>,
        h_max: Key<Option<Real>>,
        max_steps: Key<Option<Whole<1>>>,
        tolerance: Key<Option<String>>,
        at_knots: Key<Option<bool>>,
        stops: Key<Option<Vec<Real>>>,
    }
}

/// The times of a run.
pub(super) struct Times {
    /// The steps of one size; where `control` chooses, those that `compare` starts from.
    pub(super) grid: TimeGrid,
    /// How steps are chosen by their error, where they are.
    pub(super) control: Option<StepControl>,
    pub(super) limits: Limits,
    at_knots: Option<bool>,
    /// Where the problem jumps, as the scene says.
    pub(super) stops: Vec<f64>,
}

/// The tolerances and the limits of the steps, as the scene states them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    rtol: Option<f64>,
    atol: Option<f64>,
    h_init: Option<f64>,
    h_min: Option<f64>,
    pub(super) h_max: Option<f64>,
    pub(super) max_steps: Option<u64>,
    rule: Option<Rule>,
    /// Are the steps left to the program?
    pub(super) is_left: bool,
    /// Is their number given, and not their size?
    pub(super) counts_steps: bool,
}

/// A step, or the number of steps.
type Fixed = Either<f64, u64>;

/// The steps that `compare` starts from where a scene leaves them to the error.
const STEPS: u64 = 1000;

/// What is expected of a step.
const POSITIVE: &str = "a finite number > 0";

/// The rules of tolerances.
const PER_STEP: &str = "per-step";
const PER_LENGTH: &str = "per-length";

/// A span that does not end at its start.
fn not_empty(Span([t0, t1]): Span) -> Result<[f64; 2], ReadError> {
    match t0 == t1 {
        false => Ok([t0, t1]),
        true => {
            let message = format!("t_span is empty: it starts and ends at t = {t0}");
            Err(Refusal::at("t_span", message).into())
        }
    }
}

/// The steps of one size over a span. Where the scene states none, what is wrong is the span.
fn grid_of([t0, t1]: [f64; 2], fixed: Option<&Fixed>) -> Result<TimeGrid, ReadError> {
    let grid = match fixed {
        Some(Either::First(dt)) => TimeGrid::new([t0, t1], *dt),
        Some(Either::Second(steps)) => TimeGrid::with_steps([t0, t1], *steps),
        None if t1.is_finite() => TimeGrid::with_steps([t0, t1], STEPS),
        None => TimeGrid::new([t0, t1], 1.0),
    };
    grid.map_err(|error| match error {
        Error::OutOfRange { arg, .. } if fixed.is_none() && !arg.starts_with("t_span") => {
            let t = t0.abs().max(if t1.is_finite() { t1.abs() } else { 0.0 });
            let gap: f64 = format!("{:.0e}", t.next_up() - t).parse().unwrap_or(f64::NAN);
            let message = format!(
                "t_span is too far from t = 0 for its length: near t = {} the nearest numbers are {} apart",
                Plain(&t),
                Plain(&gap)
            );
            Refusal::at("t_span", message).into()
        }
        error => error.into(),
    })
}

/// The times of `stops`, which lie in the span.
fn within(stops: &[Real], [t0, t1]: [f64; 2]) -> Result<Vec<f64>, Refusal> {
    let [low, high] = [t0.min(t1), t0.max(t1)];
    let checked = stops.iter().enumerate().map(|(i, stop)| match stop.0 {
        t if low <= t && t <= high => Ok(t),
        t => {
            let message = format!("t = {t} lies outside of t_span, which is [{t0}, {t1}]");
            Err(Refusal::at("stops".index(i), message))
        }
    });
    checked.collect()
}

impl TimeKeys {
    /// The span, where it can be used; also beside steps that cannot.
    pub(super) fn t_span(&self) -> Option<[f64; 2]> {
        self.t_span.as_ref().ok().and_then(|span| not_empty(*span).ok())
    }

    /// The times of a run.
    ///
    /// # Errors
    /// Refusals of the keys that cannot be used, and of those that exclude each other.
    pub(super) fn resolve(self) -> Result<Times, ReadError> {
        let fixed = self.fixed();
        let limits = seen(&fixed).and_then(|fixed| self.limits(fixed.as_ref()));
        let TimeKeys { t_span, at_knots, stops, .. } = self;
        let t_span = t_span.and_then(not_empty);
        let stops = stops.and_then(|stops| match &t_span {
            Ok(t_span) => Ok(within(&stops.unwrap_or_default(), *t_span)?),
            Err(_) => Err(ReadError::known()),
        });
        let control = match (seen(&fixed), seen(&limits)) {
            (Ok(fixed), Ok(limits)) => limits.chosen_by_error(fixed.as_ref()),
            _ => Err(ReadError::known()),
        };
        let grid = match (&t_span, seen(&fixed)) {
            (Ok(t_span), Ok(fixed)) => grid_of(*t_span, fixed.as_ref()),
            _ => Err(ReadError::known()),
        };
        let (_, _, grid, limits, control, at_knots, stops) =
            all!(t_span, fixed, grid, limits, control, at_knots, stops)?;
        Ok(Times { grid, control, limits, at_knots, stops })
    }

    /// The step or the number of steps, where the scene states one.
    fn fixed(&self) -> Result<Option<Fixed>, ReadError> {
        let (dt, steps) = (*seen(&self.dt)?, *seen(&self.steps)?);
        at_most_one([("dt", dt.is_some()), ("steps", steps.is_some())])?;
        match dt {
            Some(dt) => Ok(Some(Either::First(dt.checked("dt", POSITIVE, |dt| dt > 0.0)?))),
            None => Ok(steps.map(|steps| Either::Second(steps.0))),
        }
    }

    fn limits(&self, fixed: Option<&Fixed>) -> Result<Limits, ReadError> {
        let is_fixed = fixed.is_some();
        let counts_steps = matches!(fixed, Some(Either::Second(_)));
        let tolerance = |key, x: &Key<Option<Real>>| {
            let x = seen(x)?.map(|x| x.checked(key, "a finite number ≥ 0", |x| x >= 0.0));
            x.transpose()
        };
        let (rtol, atol) = (tolerance("rtol", &self.rtol), tolerance("atol", &self.atol));
        let size = |key, h: &Key<Option<Real>>| {
            seen(h)?.map(|h| h.checked(key, POSITIVE, |h| h > 0.0)).transpose()
        };
        let h_init = size("h_init", &self.h_init);
        let (h_min, h_max) = (size("h_min", &self.h_min), size("h_max", &self.h_max));
        let max_steps = seen(&self.max_steps).map(|n| n.map(|n| n.0));
        let rule = seen(&self.tolerance).and_then(|rule| match rule.as_deref() {
            None => Ok(None),
            Some(PER_STEP) => Ok(Some(Rule::PerStep)),
            Some(PER_LENGTH) => Ok(Some(Rule::PerLength)),
            // Steps of one size have no rule.
            Some(_) if is_fixed => Ok(Some(Rule::PerStep)),
            Some(other) => {
                let message =
                    format!("unknown rule `{other}`, expected \"{PER_STEP}\" or \"{PER_LENGTH}\"");
                Err(Refusal::at("tolerance", message).into())
            }
        });
        let (rtol, atol, h_init, h_min, h_max, max_steps, rule) =
            all!(rtol, atol, h_init, h_min, h_max, max_steps, rule)?;
        let is_left = !is_fixed && rtol.is_none() && atol.is_none();
        Ok(Limits { rtol, atol, h_init, h_min, h_max, max_steps, rule, is_left, counts_steps })
    }
}

impl Times {
    /// Does a step end at each knot? By default where steps are chosen by their error.
    pub(super) fn at_knots(&self, has_knots: bool) -> Result<Option<bool>, Refusal> {
        match self.at_knots {
            Some(_) if !has_knots => {
                let message = "`at_knots` is of `samples`, of magnets and of `pulse`: the problem has none of them";
                Err(Refusal::at("at_knots", message))
            }
            given => Ok(given),
        }
    }
}

/// The mistake of settings beside `key`, which fixes the steps: its place and what is wrong. `tolerances` says that there
/// are some, `limits` which limits of the step size are given.
pub fn beside_fixed_steps<'a>(
    key: &'a str,
    tolerances: bool,
    limits: &[(&'a str, bool)],
) -> Option<(&'a str, String)> {
    if tolerances {
        let message = format!(
            "`{key}` fixes the steps and `rtol`, `atol` leave them to the error: expected one of the two"
        );
        return Some((key, message));
    }
    let (limit, _) = *limits.iter().find(|(_, given)| *given)?;
    let message =
        format!("`{limit}` is for steps chosen by error: give `rtol` or `atol` instead of `{key}`");
    Some((limit, message))
}

impl Limits {
    /// How steps are chosen by their error. `None` if they have one size.
    fn chosen_by_error(&self, fixed: Option<&Fixed>) -> Result<Option<StepControl>, ReadError> {
        let fixed = fixed.map(|fixed| match fixed {
            Either::First(_) => "dt",
            Either::Second(_) => "steps",
        });
        if let Some(key) = fixed {
            let limits = [
                ("h_init", self.h_init.is_some()),
                ("h_min", self.h_min.is_some()),
                ("h_max", self.h_max.is_some()),
                ("tolerance", self.rule.is_some()),
            ];
            let tolerances = self.rtol.is_some() || self.atol.is_some();
            return match beside_fixed_steps(key, tolerances, &limits) {
                None => Ok(None),
                Some((key, message)) => Err(Refusal::at(key, message).into()),
            };
        }
        let names = [("first_step", "h_init"), ("min_step", "h_min"), ("max_step", "h_max")];
        let control = self.control(1.0).and_then(|control| {
            control.tolerance().check_rounding::<f64>()?;
            Ok(control)
        });
        Ok(Some(control.map_err(|error| Refusal::from(error).renamed(&names))?))
    }

    /// Take the tolerances that the program chooses.
    pub(super) fn take(&mut self, [rtol, atol]: [f64; 2]) {
        (self.rtol, self.atol) = (Some(rtol), Some(atol));
    }

    /// rtol and atol. Both are 1 while the steps are left to the program.
    pub(super) fn tolerances(&self) -> [f64; 2] {
        let left = if self.is_left { 1.0 } else { 0.0 };
        [self.rtol, self.atol].map(|x| x.unwrap_or(left))
    }

    /// Limits of steps, and the tolerances times a factor. With another factor than 1 the first step is chosen, and ten
    /// times as many steps may be taken.
    pub(super) fn control(&self, factor: f64) -> Result<StepControl, Error> {
        let [rtol, atol] = self.tolerances().map(|tolerance| factor * tolerance);
        let rule = self.rule.unwrap_or(Rule::PerStep);
        let mut control = StepControl::new(rtol, atol)?.rule(rule);
        let is_own = factor == 1.0;
        if let Some(h) = self.h_init.filter(|_| is_own) {
            control = control.first_step(h)?;
        }
        if let Some(h) = self.h_max {
            control = control.max_step(h)?;
        }
        if let Some(h) = self.h_min {
            control = control.min_step(h)?;
        }
        if let Some(n) = self.max_steps {
            control = control.max_steps(if is_own { n } else { n.saturating_mul(10) })?;
        }
        Ok(control)
    }
}

read_by_keys! {
    /// `[output]`.
    pub(super) struct OutputKeys {
        pub(super) quantities: Key<Option<Vec<String>>>,
        pub(super) formulas: Key<Lets>,
        plot: Key<Option<Vec<Entry>>>,
        every: Key<Option<Whole<1>>>,
        times: Key<Option<Vec<Real>>>,
        count: Key<Option<Whole<1>>>,
        interval: Key<Option<Real>>,
        times_by: Key<Option<String>>,
        error_check: Key<Option<bool>>,
    }
}

/// The keys that say where rows are written.
pub(super) const ROWS: [&str; 4] = ["every", "times", "count", "interval"];

/// The rows of a run.
pub(super) struct Rows {
    pub(super) save: SaveAt,
    pub(super) times_by_steps: bool,
    pub(super) error_check: bool,
}

impl OutputKeys {
    /// Are the times of the rows left to the program?
    pub(super) fn leaves_rows(&self) -> bool {
        !self.has_times() && matches!(self.every, Ok(None))
    }

    /// Are there times that need not be ends of steps?
    fn has_times(&self) -> bool {
        let none = (&self.times, &self.count, &self.interval);
        !matches!(none, (Ok(None), Ok(None), Ok(None)))
    }

    /// Spells the quantities as the kind does.
    pub(super) fn spell(&mut self, kind: &Kind) {
        for name in self.quantities.iter_mut().flatten().flatten() {
            if let Ok(known) = kind.quantity(name) {
                *name = known.name.into();
            }
        }
        let figures = self.plot.iter_mut().flatten().flatten();
        figures.for_each(|Entry(figure)| figure.spell(kind));
    }

    /// The figures that are asked for. `None` if a mistake in them is reported already.
    pub(super) fn figures(self) -> Option<Vec<PlotFigure>> {
        let entries = self.plot.ok()?.unwrap_or_default();
        Some(entries.into_iter().map(|Entry(figure)| figure).collect())
    }

    /// The mistakes in the list of quantities.
    pub(super) fn wrong_quantities(&self, kind: &Kind, problem: Option<&Problem>) -> Vec<Refusal> {
        let Ok(Some(asked)) = &self.quantities else { return Vec::new() };
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

    /// The rows over a span, if that is known. `steps_left` says that the program chooses the steps.
    pub(super) fn rows(
        &self,
        t_span: Option<[f64; 2]>,
        steps_left: bool,
    ) -> Result<Rows, ReadError> {
        let save = self.save(t_span, steps_left);
        let times_by_steps = seen(&self.times_by).and_then(|way| match way.as_deref() {
            None | Some("dense") => Ok(false),
            Some("steps") => Ok(true),
            Some(other) => {
                Err(Refusal::unknown("way", other, &["dense", "steps"]).about("times_by").into())
            }
        });
        let error_check = seen(&self.error_check).map(|check| check.unwrap_or(true));
        let (save, times_by_steps, error_check) = all!(save, times_by_steps, error_check)?;
        Ok(Rows { save, times_by_steps, error_check })
    }

    /// Where rows are written.
    fn save(&self, t_span: Option<[f64; 2]>, steps_left: bool) -> Result<SaveAt, ReadError> {
        if matches!(self.times_by, Ok(Some(_))) && !self.has_times() {
            let message =
                "`times_by` is for `times`, `count` and `interval`: add one, or leave this";
            return Err(Refusal::at("times_by", message).into());
        }
        let (every, times) = (*seen(&self.every)?, seen(&self.times)?);
        let (count, interval) = (*seen(&self.count)?, *seen(&self.interval)?);
        if let Some(interval) = interval {
            interval.checked("interval", POSITIVE, |length| length > 0.0)?;
        }
        let given = [every.is_some(), times.is_some(), count.is_some(), interval.is_some()];
        at_most_one(ROWS.into_iter().zip(given))?;
        let [t0, t1] = t_span.ok_or_else(ReadError::known)?;
        let intervals = |count: u64| SaveAt::Interval((t1 - t0).abs() / count as f64);
        let save = match (every, times, count, interval) {
            (Some(every), ..) => SaveAt::Every(every.0),
            (_, Some(times), ..) => SaveAt::TimesAndEnds(times.iter().map(|t| t.0).collect()),
            (_, _, Some(_), _) if !t1.is_finite() => {
                let message = "`count` divides a span with an end: expected `interval`, such as \
                               interval = 0.1";
                return Err(Refusal::at("count", message).into());
            }
            (_, _, Some(count), _) => intervals(count.0),
            (_, _, _, Some(interval)) => SaveAt::Interval(interval.0),
            _ if steps_left && t1.is_finite() => intervals(defaults::INTERVALS),
            _ => SaveAt::Every(1),
        };
        save.check([t0, t1])?;
        Ok(save)
    }
}
