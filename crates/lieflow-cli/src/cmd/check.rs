//! `lieflow check`: the program at hand proves itself, on this machine and as it was compiled.

use std::time::Instant;

use lieflow::check::Finding;
use lieflow_model::check::{CheckedScene, check_runs};
use serde::Serialize;

use crate::args::CheckArgs;
use crate::error::CliError;
use crate::measure::checks::{self, checks};
use crate::output::{self, number};

/// A group of checks.
#[derive(Serialize)]
struct Group {
    /// What is checked.
    name: String,
    /// The number of methods; none for checks without a method.
    #[serde(skip_serializing_if = "Option::is_none")]
    methods: Option<usize>,
    checks: usize,
    holds: bool,
    failures: Vec<Failure>,
}

/// A check that does not hold.
#[derive(Serialize)]
struct Failure {
    /// The method or the law.
    of: String,
    check: String,
    /// The largest error, in units of its bound.
    worst: f64,
    bound: f64,
    at: String,
}

impl Failure {
    fn new(of: String, finding: &Finding) -> Self {
        let Finding { name, worst, bound, at, .. } = finding;
        Failure { of, check: name.clone(), worst: *worst, bound: *bound, at: at.clone() }
    }

    fn in_words(&self) -> String {
        let of = if self.of.is_empty() { String::new() } else { format!("{}: ", self.of) };
        format!(
            "  {of}{}: {} where {} is allowed: {}",
            self.check,
            number(self.worst),
            number(self.bound),
            self.at
        )
    }
}

impl From<checks::Group> for Group {
    fn from((name, findings): checks::Group) -> Self {
        let broken = findings.iter().filter(|finding| !finding.holds());
        let failures: Vec<_> = broken.map(|f| Failure::new(String::new(), f)).collect();
        let (methods, checks, holds) = (None, findings.len(), failures.is_empty());
        Group { name, methods, checks, holds, failures }
    }
}

impl From<CheckedScene> for Group {
    fn from(scene: CheckedScene) -> Self {
        let CheckedScene { name, methods, checks, failures, .. } = scene;
        Group {
            name: format!("methods on {name}"),
            methods: Some(methods),
            checks,
            holds: failures.is_empty(),
            failures: failures.iter().map(|(of, f)| Failure::new(of.clone(), f)).collect(),
        }
    }
}

/// Run the command.
///
/// # Errors
/// [`CliError::Failed`] when a check does not hold.
pub fn run(args: &CheckArgs) -> Result<(), CliError> {
    let clock = Instant::now();
    let groups = checks(if args.quick { 2_000 } else { 50_000 })?;
    let mut groups: Vec<Group> = groups.into_iter().map(Group::from).collect();
    check_runs(args.quick, |scene| groups.push(scene.into()))?;
    if args.json {
        output::print_json(&groups)?;
    } else {
        let rows = groups.iter().map(|group| {
            let methods = group.methods.map_or_else(String::new, |count| count.to_string());
            let verdict = match group.failures.len() {
                0 => "ok".into(),
                count => format!("{count} FAILED"),
            };
            [group.name.clone(), methods, group.checks.to_string(), verdict]
        });
        output::print(&output::table(["group", "methods", "checks", ""], rows))?;
        let checks: usize = groups.iter().map(|group| group.checks).sum();
        let seconds = output::duration(clock.elapsed().as_secs_f64());
        output::print(&format!("{checks} checks in {seconds}\n"))?;
    }
    verdict(&groups)
}

/// An error that lists all checks that do not hold, if there is one.
fn verdict(groups: &[Group]) -> Result<(), CliError> {
    let broken: Vec<String> = groups
        .iter()
        .filter(|group| !group.holds)
        .flat_map(|group| {
            let failures = group.failures.iter().map(Failure::in_words);
            core::iter::once(group.name.clone()).chain(failures)
        })
        .collect();
    match broken.is_empty() {
        true => Ok(()),
        false => Err(CliError::Failed(format!("these checks do not hold:\n{}", broken.join("\n")))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_check_that_does_not_hold_is_listed() {
        let finding = |name: &str, worst| Finding {
            name: name.into(),
            cases: 1,
            worst,
            at: "t = 2".into(),
            bound: 3.0,
        };
        let law = ("laws on SO(3)".into(), vec![finding("bracket", 4.0), finding("Ad", 3.0)]);
        let of = "rkmk dop853 exp".to_string();
        let rows = (of.clone(), finding("rows within steps", 7e8));
        let scene = CheckedScene {
            name: "flips (closed)".into(),
            problem_types: Default::default(),
            methods: 2,
            checks: 15,
            failures: vec![rows, (of, finding("events", f64::NAN))],
        };
        let groups = [law.into(), scene.into()];
        assert!(verdict(&groups[..0]).is_ok());
        let error = verdict(&groups).unwrap_err();
        assert_eq!(error.exit_code(), 1);
        let expected = [
            "these checks do not hold:",
            "laws on SO(3)",
            "  bracket: 4 where 3 is allowed: t = 2",
            "methods on flips (closed)",
            "  rkmk dop853 exp: rows within steps: 7e8 where 3 is allowed: t = 2",
            "  rkmk dop853 exp: events: NaN where 3 is allowed: t = 2",
        ];
        assert_eq!(error.to_string().lines().collect::<Vec<_>>(), expected);
    }
}
