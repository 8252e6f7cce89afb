//! The reading of section 5.3, judged by the numbers of this run.

use crate::accuracy::{Accuracy, EPSILONS, TESTS};
use crate::methods::PaperMethod;
use crate::results::Paper;
use lieflow_figures::number::{or_dash, seconds};

/// A sentence of the paper and what the measurements say.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The sentence.
    pub claim: &'static str,
    /// The answer.
    pub answer: String,
}

const LIE: [PaperMethod; 5] = [
    PaperMethod::Exp,
    PaperMethod::Ccsk,
    PaperMethod::Ccsk321,
    PaperMethod::Ccsk123,
    PaperMethod::Cay,
];

fn find(all: &[Accuracy], method: PaperMethod) -> Option<&Accuracy> {
    all.iter().find(|a| a.method == method)
}

/// The time of a method to ε, in words.
fn time(all: &[Accuracy], method: PaperMethod, epsilon: f64) -> String {
    let time = find(all, method).and_then(|a| a.seconds_to(epsilon));
    format!("{} {}", method.name(), or_dash(time, seconds))
}

/// Times within this factor of each other are equal: the same code differs by as much from run to run.
const EQUAL: f64 = 1.3;

/// Whether the first of two times is less, and not equal.
fn is_less(a: f64, b: f64) -> bool {
    EQUAL * a < b
}

/// Every sentence.
pub(super) fn all(paper: &Paper) -> Vec<Verdict> {
    let cells = || {
        (0..2)
            .flat_map(|test| EPSILONS.map(|epsilon| (test, epsilon)))
            .map(|(test, epsilon)| (&paper.accuracy[test], TESTS[test].name, epsilon))
    };
    let faster = |all: &[Accuracy], a: PaperMethod, b: PaperMethod, epsilon: f64| {
        let time = |method| find(all, method).and_then(|x| x.seconds_to(epsilon));
        matches!((time(a), time(b)), (Some(a), Some(b)) if is_less(a, b))
    };
    let mut against_mr = Vec::new();
    let mut all_faster = true;
    for (all, name, epsilon) in cells() {
        let count = |is: &dyn Fn(PaperMethod) -> bool| LIE.into_iter().filter(|a| is(*a)).count();
        let ahead = count(&|method| faster(all, method, PaperMethod::Mr, epsilon));
        let behind = count(&|method| faster(all, PaperMethod::Mr, method, epsilon));
        all_faster &= ahead == LIE.len();
        against_mr.push(format!(
            "{name} to {epsilon:.0e}: {ahead} faster, {behind} slower ({}, {})",
            time(all, PaperMethod::Mr, epsilon),
            time(all, PaperMethod::Exp, epsilon)
        ));
    }
    let mut against_rk = Vec::new();
    for (all, name, epsilon) in cells() {
        let ahead = LIE.into_iter().chain([PaperMethod::B4]);
        let ahead: Vec<_> =
            ahead.filter(|method| faster(all, *method, PaperMethod::Rk4, epsilon)).collect();
        let names: Vec<_> = ahead.iter().map(|method| method.name()).collect();
        let names = if names.is_empty() { "none".into() } else { names.join(", ") };
        against_rk.push(format!(
            "{name} to {epsilon:.0e}: {names} ({})",
            time(all, PaperMethod::Rk4, epsilon)
        ));
    }
    let fastest = cells().map(|(all, name, epsilon)| {
        let timed = all.iter().filter_map(|a| Some((a.seconds_to(epsilon)?, a.method)));
        let mut timed: Vec<_> = timed.collect();
        timed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = timed.first().map_or(f64::NAN, |best| best.0);
        let first = timed.into_iter().take_while(|(t, _)| !is_less(best, *t));
        let first = first.map(|(t, method)| format!("{} {}", method.name(), seconds(t)));
        let best = first.collect::<Vec<_>>().join(", ");
        format!("{name} to {epsilon:.0e}: {best}")
    });
    vec![
        Verdict {
            claim: "“The Lie group methods and Runge–Kutta perform clearly better than \
                    McLachlan–Reich”",
            answer: format!(
                "{}. Of exp, cay and the three ccsk, by CPU time, where times within a factor of {EQUAL} \
                 are equal: {}.",
                if all_faster { "it holds here" } else { "it does not hold here" },
                against_mr.join("; ")
            ),
        },
        Verdict {
            claim: "“Some Lie group methods perform even better than the explicit Runge–Kutta \
                    method”",
            answer: format!(
                "faster than RK4 on g, by more than a factor of {EQUAL}: {}.",
                against_rk.join("; ")
            ),
        },
        Verdict {
            claim: "Fastest of all that are here, with those that are as fast",
            answer: format!("{}.", fastest.collect::<Vec<_>>().join("; ")),
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::is_less;

    #[test]
    fn times_that_differ_little_are_equal() {
        let pairs = [(1.0, 1.2), (1.2, 1.0), (1.0, 1.4), (1.4, 1.0)];
        assert_eq!(pairs.map(|(a, b)| is_less(a, b)), [false, false, true, false]);
    }
}
