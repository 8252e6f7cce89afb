//! The keys of the sections that every scene has.

use lieflow::catalog::MethodSpec;
use lieflow::{SaveAt, TimeGrid};
use serde::Deserialize;

use super::error::{Either, Refusal, exactly_one};
use super::values::{Real, Reals, Whole};
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
    /// The method with what it takes by default spelt out.
    pub(super) fn resolve(self) -> Result<(MethodSpec, Layer), Refusal> {
        let layer = self.layer.map_or(Ok(Layer::default()), |name| Layer::named(&name))?;
        let mut method = MethodSpec {
            name: self.name,
            map: self.map,
            tableau: self.tableau,
            q: self.q.map(|q| usize::try_from(q.0).unwrap_or(usize::MAX)),
        };
        let info = method.info()?;
        if info.takes_map && method.map.is_none() {
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
    t_span: Reals<2>,
    dt: Option<Real>,
    steps: Option<Whole<1>>,
}

impl TimeKeys {
    pub(super) fn resolve(self) -> Result<TimeGrid, Refusal> {
        let [t0, t1] = self.t_span.0;
        if t0 == t1 {
            let message = format!("t_span is empty: it starts and ends at t = {t0}");
            return Err(Refusal::at("t_span", message));
        }
        Ok(match exactly_one(("dt", self.dt), ("steps", self.steps))? {
            Either::First(dt) => TimeGrid::new([t0, t1], dt.0)?,
            Either::Second(steps) => {
                TimeGrid::with_steps([t0, t1], steps.0).map_err(|error| {
                    let mut refusal = Refusal::from(error);
                    if refusal.key.as_deref() == Some("dt") {
                        refusal.key = Some("steps".into()); // the key that this dt comes from
                    }
                    refusal
                })?
            }
        })
    }
}

/// `[output]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OutputKeys {
    quantities: Vec<String>,
    every: Option<Whole<1>>,
    times: Option<Vec<Real>>,
}

impl OutputKeys {
    pub(super) fn resolve(
        self,
        kind: &Kind,
        grid: &TimeGrid,
    ) -> Result<(Vec<String>, SaveAt), Refusal> {
        check_quantities(&self.quantities, kind)?;
        let save = match (self.every, self.times) {
            (None, None) => SaveAt::Every(1),
            (every, times) => match exactly_one(("every", every), ("times", times))? {
                Either::First(every) => SaveAt::Every(every.0),
                Either::Second(times) => SaveAt::Times(times.iter().map(|t| t.0).collect()),
            },
        };
        save.check(grid)?;
        Ok((self.quantities, save))
    }
}

fn check_quantities(quantities: &[String], kind: &Kind) -> Result<(), Refusal> {
    if quantities.is_empty() {
        let names: Vec<_> = kind.quantities.iter().map(|quantity| quantity.name).collect();
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
