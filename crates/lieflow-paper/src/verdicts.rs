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

/// Every sentence.
pub(super) fn all(paper: &Paper) -> Vec<Verdict> {
    let cells = || {
        (0..2)
            .flat_map(|test| EPSILONS.map(|epsilon| (test, epsilon)))
            .map(|(test, epsilon)| (&paper.accuracy[test], TESTS[test].name, epsilon))
    };
    let faster = |all: &[Accuracy], a: PaperMethod, b: PaperMethod, epsilon: f64| {
        let time = |method| find(all, method).and_then(|x| x.seconds_to(epsilon));
        matches!((time(a), time(b)), (Some(a), Some(b)) if a < b)
    };
    let mut against_mr = Vec::new();
    let mut all_faster = true;
    for (all, name, epsilon) in cells() {
        let ahead =
            LIE.into_iter().filter(|method| faster(all, *method, PaperMethod::Mr, epsilon)).count();
        all_faster &= ahead == LIE.len();
        against_mr.push(format!(
            "{name} to {epsilon:.0e}: {} of {} are faster ({}, {})",
            ahead,
            LIE.len(),
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
        let best = timed.min_by(|a, b| a.0.total_cmp(&b.0));
        let best =
            best.map_or("none".into(), |(t, method)| format!("{} ({})", method.name(), seconds(t)));
        format!("{name} to {epsilon:.0e}: {best}")
    });
    vec![
        Verdict {
            claim: "“The Lie group methods and Runge–Kutta perform clearly better than \
                    McLachlan–Reich”",
            answer: format!(
                "{}. Of exp, cay and the three ccsk, by CPU time: {}.",
                if all_faster { "it holds here" } else { "it does not hold here" },
                against_mr.join("; ")
            ),
        },
        Verdict {
            claim: "“Some Lie group methods perform even better than the explicit Runge–Kutta \
                    method”",
            answer: format!("faster than RK4 on g are: {}.", against_rk.join("; ")),
        },
        Verdict {
            claim: "Fastest of all that are here",
            answer: format!("{}.", fastest.collect::<Vec<_>>().join("; ")),
        },
    ]
}
