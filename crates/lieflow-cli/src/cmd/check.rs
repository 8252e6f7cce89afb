//! `lieflow check`: the general layer against the closed forms, and the laws of every group with
//! every map, on this machine.

use lieflow::check::Finding;
use serde::Serialize;

use super::CliError;
use crate::args::CheckArgs;
use crate::measure::checks;
use crate::output;

/// A check as JSON.
#[derive(Serialize)]
struct Line {
    check: String,
    cases: usize,
    worst: f64,
    bound: f64,
    holds: bool,
    at: String,
}

/// Run the command.
///
/// # Errors
/// [`CliError::Failed`] when a check does not hold.
pub fn run(args: &CheckArgs) -> Result<(), CliError> {
    let findings = checks(if args.quick { 2_000 } else { 100_000 })?;
    if args.json {
        let line = |f: &Finding| Line {
            check: f.name.clone(),
            cases: f.cases,
            worst: f.worst,
            bound: f.bound,
            holds: f.holds(),
            at: f.at.clone(),
        };
        output::print_json(&findings.iter().map(line).collect::<Vec<_>>())?;
    } else {
        let rows = findings.iter().map(|f| {
            let verdict = if f.holds() { "ok" } else { "OUT OF BOUNDS" };
            let (worst, bound) = (format!("{:.2}", f.worst), f.bound.to_string());
            [f.name.clone(), f.cases.to_string(), worst, bound, verdict.into()]
        });
        let header = ["check", "cases", "worst [eps·cond]", "bound", ""];
        output::print(&output::table(header, rows))?;
    }
    let broken: Vec<String> = findings
        .iter()
        .filter(|f| !f.holds())
        .map(|f| format!("  {}: {:.3e} at {}", f.name, f.worst, f.at))
        .collect();
    match broken.is_empty() {
        true => Ok(()),
        false => Err(CliError::Failed(format!("out of bounds:\n{}", broken.join("\n")))),
    }
}
