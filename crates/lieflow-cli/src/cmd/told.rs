//! What a run prints at its end.

use std::path::Path;

use lieflow::problems::explained_by_rounding;

use crate::output::{self, Drift, SUMMARY, Summary, duration, number, rough, time};

/// The number of drifts in the text. summary.json has all.
const DRIFTS: usize = 10;

/// The result of a run, in lines; `page` is the name of its page, where it has one.
pub(super) fn in_words(summary: &Summary, folder: &Path, page: Option<&str>) -> String {
    let Summary { title, steps, rows, wall_time_s, t_span: [t0, t1], .. } = summary;
    let t1 = summary.t_end.unwrap_or(*t1);
    let sizes = match (summary.dt, &summary.adaptive) {
        (Some(dt), _) => format!(" of {}", number(dt)),
        (None, Some(chosen)) => format!(
            " of {} to {} ({} rejected)",
            rough(chosen.smallest_step),
            rough(chosen.largest_step),
            chosen.rejected
        ),
        (None, None) => String::new(),
    };
    let of_steps = if *steps == 1 { "step" } else { "steps" };
    let unit = match summary.time_unit() {
        none if none.is_empty() => none,
        unit => format!(" {unit}"),
    };
    let mut text = format!(
        "{title}: {}, {}, {} layer\n  t = {} to {}{unit}, {steps} {of_steps}{sizes}, {rows} rows, {}\n",
        summary.modelled.join(", "),
        summary.method.label,
        summary.layer,
        time(*t0, [*t0, t1]),
        time(t1, [*t0, t1]),
        duration(*wall_time_s),
    );
    let mut line = |told: String| text += &format!("  {told}\n");
    summary
        .defaults_in_words
        .iter()
        .for_each(|chosen| line(format!("chosen by default: {chosen}")));
    summary.ended_by.iter().for_each(|name| line(format!("ended by event {name}")));
    for event in &summary.events {
        let came = event.in_words(|t| t.to_string());
        let mut told = format!("event {}: {came}", event.name);
        event.time_error_in_words().iter().for_each(|error| told += &format!(", {error}"));
        line(told);
    }
    // A warning names the others.
    let known = summary.drift.iter().filter(|(_, drift)| drift.is_known());
    let (kept, mut drifts): (Vec<_>, Vec<_>) = known.partition(|(_, drift)| drift.is_rounding());
    let more = |names: usize| names.saturating_sub(DRIFTS);
    if !kept.is_empty() {
        let names: Vec<&str> = kept.iter().take(DRIFTS).map(|(name, _)| name.as_str()).collect();
        let further = match more(kept.len()) {
            0 => String::new(),
            further => format!(" and {further} more"),
        };
        line(format!("conserved to rounding: {}{further}", names.join(", ")));
    }
    drifts.sort_by(|(_, a), (_, b)| b.max.total_cmp(&a.max));
    for (name, drift) in drifts.iter().take(DRIFTS) {
        line(format!("{name}: {}", drifted(drift, summary.steps)));
    }
    if more(drifts.len()) > 0 {
        line(format!("{} further drifts are smaller", more(drifts.len())));
    }
    for fact in &summary.facts {
        line(format!("{}: {}", fact.name.replace('_', " "), fact.in_words(number)));
    }
    if let Some(accuracy) = &summary.accuracy {
        line(format!("error, {}: {}", accuracy.found_in_words(*rows), accuracy.errors_in_words()));
        let why = if summary.method.order.is_none() {
            ": the method is exact, the rest is rounding"
        } else {
            ""
        };
        line(accuracy.rightness_in_words() + why);
    }
    summary.accuracy_unknown.iter().for_each(|why| line(format!("error: {why}")));
    summary.notes.iter().for_each(|note| line(format!("note: {note}")));
    summary.warnings.iter().for_each(|warning| line(format!("WARNING: {warning}")));
    let mut file = |name: &str| line(folder.join(name).display().to_string());
    file(summary.trajectory);
    if !summary.events.is_empty() {
        file(output::EVENTS[0]);
    }
    file(SUMMARY);
    page.into_iter().for_each(file);
    text
}

/// How far an invariant drifted: in parts of its value, where that is no small difference of large terms.
fn drifted(drift: &Drift, steps: u64) -> String {
    let size = drift.rounding / explained_by_rounding(steps, 1.0);
    let (value, of) = match drift.initial.abs() > 1e-3 * size {
        true => (drift.initial.abs(), " of its value"),
        false => (1.0, ""),
    };
    let [at_end, largest] = [drift.at_end, drift.max].map(|moved| rough(moved / value));
    format!("drifted by {at_end}{of} (largest {largest})")
}
