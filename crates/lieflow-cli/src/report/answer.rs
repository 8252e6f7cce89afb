//! The answer to the question of a comparison: which method is the fastest to an error, and why.

use super::step_of;
use crate::measure::{Curve, Reached, Reference, WorkPoint};
use lieflow_figures::number::{seconds, sig, typed};

/// A method, and where it reaches an error.
pub type Found<'a> = (&'a Curve, Reached);

/// The answer for one error.
#[derive(Clone, Debug)]
pub struct Answer<'a> {
    /// The error.
    pub error: f64,
    verdict: Verdict<'a>,
}

/// What was found.
#[allow(clippy::large_enum_variant)] // one for each error that is asked for
#[derive(Clone, Debug)]
enum Verdict<'a> {
    /// The fastest method that stays on M, or of all where none does.
    Fastest {
        best: Found<'a>,
        /// The fastest of another kind among those.
        next: Option<Found<'a>>,
        /// The fastest of those that leave M, where it is faster.
        leaving: Option<Found<'a>>,
    },
    /// Such an error is below the floor.
    BelowFloor(&'a Reference),
    /// No method reaches it. The closest run.
    NotReached(Option<(&'a Curve, &'a WorkPoint)>),
}

/// The methods that reach an error, from the fastest on.
pub fn ranking(curves: &[Curve], error: f64) -> Vec<Found<'_>> {
    let mut found: Vec<Found<'_>> =
        curves.iter().filter_map(|curve| Some((curve, curve.run_to(error)?))).collect();
    found.sort_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds));
    found
}

/// Ratios below this are no difference.
const SAME: f64 = 1.3;

impl<'a> Answer<'a> {
    /// The answer for `error` that these runs give.
    pub fn new(curves: &'a [Curve], reference: &'a Reference, error: f64) -> Self {
        let found = ranking(curves, error);
        let stays = || found.iter().filter(|(curve, _)| !curve.leaves());
        let verdict = match stays().next().or(found.first()).copied() {
            Some(best) => {
                let kind = best.0.candidate.kind();
                let of_another_kind = |(curve, _): &&Found<'a>| curve.candidate.kind() != kind;
                let next = match best.0.leaves() {
                    true => found.iter().find(of_another_kind),
                    false => stays().find(of_another_kind),
                };
                let leaving = found.first().filter(|(curve, reached)| {
                    curve.leaves() && SAME * reached.seconds < best.1.seconds
                });
                Verdict::Fastest { best, next: next.copied(), leaving: leaving.copied() }
            }
            None if error < reference.floor() => Verdict::BelowFloor(reference),
            None => Verdict::NotReached(closest(curves)),
        };
        Answer { error, verdict }
    }

    /// The fastest method. None if no method reaches the error.
    pub fn best(&self) -> Option<Found<'a>> {
        match self.verdict {
            Verdict::Fastest { best, .. } => Some(best),
            _ => None,
        }
    }

    /// The fastest method of another kind than the best.
    pub fn next(&self) -> Option<Found<'a>> {
        match self.verdict {
            Verdict::Fastest { next, .. } => next,
            _ => None,
        }
    }

    /// The fastest method of those that leave M, where it is faster than the best.
    pub fn leaving(&self) -> Option<Found<'a>> {
        match self.verdict {
            Verdict::Fastest { leaving, .. } => leaving,
            _ => None,
        }
    }

    /// One to four sentences.
    pub fn in_words(&self) -> String {
        let error = self.error;
        match &self.verdict {
            Verdict::Fastest { best, next, leaving } => {
                let (curve, reached) = best;
                let take = match (curve.order, reached.tolerance) {
                    (None, _) => "at the times of the output".into(),
                    (_, None) => format!("in {} steps ({})", reached.steps, step_of(reached)),
                    (_, Some(_)) => format!(
                        "with {} and tolerance = \"per-length\" (some {} steps)",
                        step_of(reached),
                        reached.steps
                    ),
                };
                let name = name_of(curve);
                let time = seconds(reached.run_seconds());
                let mut text =
                    format!("For an error of {error:e}, take {name} {take}: the run takes {time}");
                if reached.output > 0.1 * reached.seconds {
                    text += &format!(
                        ", and {} with its rows of output",
                        seconds(reached.seconds_with_rows())
                    );
                }
                text += ".";
                text += &match next {
                    Some(next) => format!(" {}", faster(best, next)),
                    None => {
                        " No method of another kind reaches it in the runs that were made.".into()
                    }
                };
                text += &kept(best);
                if curve.leaves() {
                    text += &format!(
                        " No method that stays on M reaches it; this one ends {} away from M.",
                        off(reached)
                    );
                }
                if let Some((curve, there)) = leaving {
                    let times = sig(reached.seconds / there.seconds, 2);
                    text += &format!(
                        " {} is {times} times as fast, and leaves M: it ends {} away from it.",
                        name_of(curve),
                        off(there)
                    );
                }
                text
            }
            Verdict::BelowFloor(reference) => format!(
                "An error of {error:e} cannot be seen here. {} Ask for an error of {} or more.",
                reference.in_words(),
                typed(10f64.powf(reference.floor().log10().ceil()), 1)
            ),
            Verdict::NotReached(None) => {
                format!("No method reaches an error of {error:e}: no run came to its end.")
            }
            Verdict::NotReached(Some((curve, point))) => format!(
                "No method reaches an error of {error:e} in the runs that were made. The closest is {} \
                 with {} steps: an error of {} in {}. {}",
                name_of(curve),
                point.steps,
                typed(point.error, 1),
                seconds(point.seconds_per_unit * point.length()),
                why_not(curve, point)
            ),
        }
    }
}

/// The run with the smallest error, and its method.
fn closest(curves: &[Curve]) -> Option<(&Curve, &WorkPoint)> {
    let runs = curves.iter().flat_map(|curve| curve.points.iter().map(move |p| (curve, p)));
    let ended = runs.filter(|(_, p)| p.error.is_finite() && p.seconds_per_unit > 0.0);
    ended.min_by(|a, b| a.1.error.total_cmp(&b.1.error))
}

/// Why no smaller step of the closest method was better.
fn why_not(curve: &Curve, point: &WorkPoint) -> &'static str {
    match curve.points.iter().any(|p| p.steps > point.steps && p.error > point.error) {
        true => "Smaller steps do not help: rounding stops them.",
        false => "It needs smaller steps. Such runs take longer than a comparison lets them.",
    }
}

/// The distance from M in a sentence.
fn off(reached: &Reached) -> String {
    typed(reached.off_manifold, 1)
}

/// The name of a method in a sentence.
fn name_of(curve: &Curve) -> String {
    format!("“{}”", curve.label)
}

/// How much faster the best method is than the next, and why.
fn faster((best, here): &Found<'_>, (next, there): &Found<'_>) -> String {
    let [a, b] = [best, next].map(|curve| name_of(curve));
    let times = |ratio: f64| format!("{} times", sig(ratio, 2));
    let ratio = there.seconds / here.seconds;
    if ratio < SAME {
        let steps = match (best.order, next.order) {
            (Some(order), Some(other)) => format!(
                ": it takes {} steps of order {other}, and {a} takes {} of order {order}",
                there.steps, here.steps
            ),
            _ => String::new(),
        };
        return format!("{b}, the best method of another kind, is about as fast{steps}.");
    }
    let mut text =
        format!("It is {} as fast as {b}, the best method of another kind", times(ratio));
    let (Some(order), Some(other)) = (best.order, next.order) else {
        text += match best.order {
            None => ": the exact motion needs no steps between the rows of the output.",
            Some(_) => ": the exact motion computes elliptic functions for each row of the output.",
        };
        return text;
    };
    let steps = there.steps as f64 / here.steps as f64;
    let [mine, others] = [here, there].map(|at| at.seconds * at.h);
    let cost = others / mine;
    let more_steps = |who: &str, ratio: f64| format!("{who} needs {} as many steps", times(ratio));
    let dearer = |who: &str, ratio: f64| format!("a step of {who} costs {} as much", times(ratio));
    let mut reasons = Vec::new();
    if steps >= SAME {
        let orders = match order > other {
            true => format!(" (its order is {other}, that of {a} is {order})"),
            false => String::new(),
        };
        reasons.push(more_steps(&b, steps) + &orders);
    }
    if cost >= SAME {
        let counts = [best, next].map(|curve| curve.candidate.evaluations_per_step());
        let evaluations = match counts {
            [Some(few), Some(many)] if few < many => {
                format!(" ({many} evaluations of f, not {few})")
            }
            _ => String::new(),
        };
        reasons.push(dearer(&b, cost) + &evaluations);
    }
    let but = match (steps * SAME <= 1.0, cost * SAME <= 1.0) {
        (true, _) => Some(more_steps(&a, 1.0 / steps)),
        (_, true) => Some(dearer(&a, 1.0 / cost)),
        _ => None,
    };
    if !reasons.is_empty() {
        text += &format!(": {}", reasons.join(", and "));
        if let Some(but) = but {
            text += &format!(", though {but}");
        }
    }
    text + "."
}

/// The invariants that the method conserves, and its error in energy.
fn kept((curve, reached): &Found<'_>) -> String {
    let keeps = curve.candidate.keeps();
    let energy = match reached.energy_error.is_nan() || curve.candidate.keeps_energy() {
        true => String::new(),
        false => {
            format!(
                "the energy at the end is off by {} of its value",
                typed(reached.energy_error, 1)
            )
        }
    };
    let name = name_of(curve);
    match (keeps.is_empty(), energy.is_empty()) {
        (true, true) => String::new(),
        (true, false) => format!(" With {name}, {energy}."),
        (false, true) => format!(" {name} conserves: {keeps}."),
        (false, false) => format!(" {name} conserves: {keeps}; {energy}."),
    }
}
