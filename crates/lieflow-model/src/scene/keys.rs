//! The keys of the sections that every scene has.

use lieflow::StepControl;
use lieflow::catalog::MethodSpec;
use lieflow::tolerance::Rule;
use lieflow::{SaveAt, TimeGrid};
use serde::Deserialize;

use super::error::{Either, Refusal, exactly_one};
use super::values::{Real, Span, Whole};
use crate::kinds::Kind;
use crate::model::Layer;

/// `[method]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MethodKeys {
    name: String,
    map: Option<String>,
    tableau: Option<String>,
    q: Option<Whole<0>>,
    layer: Option<String>,
}

impl MethodKeys {
    /// The method with what it takes by default spelt out, and the layer: the first of those of the
    /// problem where none is named.
    pub(super) fn resolve(self, layers: &[Layer]) -> Result<(MethodSpec, Layer), Refusal> {
        let layer = match self.layer {
            Some(name) => Layer::named(&name)?,
            None => layers.first().copied().unwrap_or_default(),
        };
        let mut method = MethodSpec {
            name: self.name,
            map: self.map,
            tableau: self.tableau,
            q: self.q.map(|q| usize::try_from(q.0).unwrap_or(usize::MAX)),
        };
        let info = method.info()?;
        if info.takes_map() && method.map.is_none() {
            method.map = Some("exp".into());
        }
        if info.takes_tableau && method.tableau.is_none() {
            method.tableau = Some("rk4".into());
        }
        Ok((method, layer))
    }
}

/// `[time]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
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

/// The steps that `compare` starts from where a scene leaves them to the error.
const STEPS: u64 = 1000;

impl TimeKeys {
    /// Does a step end at each knot of the samples? By default where steps are chosen by their error.
    pub(super) fn at_knots(&self, has_samples: bool) -> Result<bool, Refusal> {
        match self.at_knots {
            Some(_) if !has_samples => {
                Err(Refusal::at("at_knots", "`at_knots` is of `samples`: the problem has none"))
            }
            given => Ok(has_samples && given.unwrap_or(self.rtol.is_some() || self.atol.is_some())),
        }
    }

    /// The steps of one size, those that are chosen by their error where tolerances are given, and the limit of
    /// their number.
    pub(super) fn resolve(self) -> Result<(TimeGrid, Option<StepControl>, Option<u64>), Refusal> {
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

    /// Tolerances and limits; none where no tolerance is given.
    fn adaptive(&self) -> Result<Option<StepControl>, Refusal> {
        if self.rtol.is_none() && self.atol.is_none() {
            let limits = [
                ("h_init", self.h_init.is_some()),
                ("h_min", self.h_min.is_some()),
                ("h_max", self.h_max.is_some()),
                ("tolerance", self.tolerance.is_some()),
            ];
            return match limits.into_iter().find(|(_, given)| *given) {
                None => Ok(None),
                Some((key, _)) => {
                    let message =
                        format!("`{key}` is for steps chosen by error: add `rtol` or `atol`");
                    Err(Refusal::at(key, message))
                }
            };
        }
        let tolerance = |x: Option<Real>| x.map_or(0.0, |x| x.0);
        let rule = match self.tolerance.as_deref() {
            None | Some("per-step") => Rule::PerStep,
            Some("per-length") => Rule::PerLength,
            Some(other) => {
                let message =
                    format!("unknown rule `{other}`, expected \"per-step\" or \"per-length\"");
                return Err(Refusal::at("tolerance", message));
            }
        };
        let control = || {
            let mut control =
                StepControl::new(tolerance(self.rtol), tolerance(self.atol))?.rule(rule);
            if let Some(h) = self.h_init {
                control = control.first_step(h.0)?;
            }
            if let Some(h) = self.h_max {
                control = control.max_step(h.0)?;
            }
            if let Some(h) = self.h_min {
                control = control.min_step(h.0)?;
            }
            if let Some(n) = self.max_steps {
                control = control.max_steps(n.0)?;
            }
            Ok(control)
        };
        let names = [("first_step", "h_init"), ("min_step", "h_min"), ("max_step", "h_max")];
        control().map(Some).map_err(|error: lieflow::Error| Refusal::from(error).renamed(&names))
    }
}

/// `[output]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OutputKeys {
    quantities: Vec<String>,
    every: Option<Whole<1>>,
    times: Option<Vec<Real>>,
    times_by: Option<String>,
}

/// What `[output]` asks for.
pub(super) struct Output {
    pub(super) quantities: Vec<String>,
    pub(super) save: SaveAt,
    pub(super) times_by_steps: bool,
}

impl OutputKeys {
    pub(super) fn resolve(self, kind: &Kind, grid: &TimeGrid) -> Result<Output, Refusal> {
        check_quantities(&self.quantities, kind)?;
        let times_by_steps = match self.times_by.as_deref() {
            None | Some("dense") => false,
            Some("steps") => true,
            Some(other) => {
                let refusal = Refusal::unknown("way", other, &["dense", "steps"]);
                return Err(Refusal { key: Some("times_by".into()), ..refusal });
            }
        };
        if self.times_by.is_some() && self.times.is_none() {
            return Err(Refusal::at(
                "times_by",
                "`times_by` is for `times`: add it, or leave this",
            ));
        }
        let save = match (self.every, self.times) {
            (None, None) => SaveAt::Every(1),
            (every, times) => match exactly_one(("every", every), ("times", times))? {
                Either::First(every) => SaveAt::Every(every.0),
                Either::Second(times) => SaveAt::Times(times.iter().map(|t| t.0).collect()),
            },
        };
        save.check(grid.t_span())?;
        let save = with_ends(save, grid.t_span());
        Ok(Output { quantities: self.quantities, save, times_by_steps })
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

fn check_quantities(quantities: &[String], kind: &Kind) -> Result<(), Refusal> {
    if quantities.is_empty() {
        let names: Vec<_> = (kind.quantities)().iter().map(|quantity| quantity.name).collect();
        let mut refusal = Refusal::at("quantities", "no quantities, expected at least one");
        refusal.help = Some(format!("choose from {}", names.join(", ")));
        return Err(refusal);
    }
    for (i, name) in quantities.iter().enumerate() {
        let key = format!("quantities[{i}]");
        if let Err(error) = kind.quantity(name) {
            return Err(Refusal { key: Some(key), ..error.into() });
        }
        if quantities[..i].contains(name) {
            return Err(Refusal::at(key, format!("quantity `{name}` is asked for twice")));
        }
    }
    Ok(())
}
