//! Methods by the lists of the catalog, on problems with references: what is measured of each, and the
//! report that all of it must hold.

use lieflow::catalog::{MAPS, Maps, MethodInfo, MethodSpec, Needs, TABLEAUS};
use lieflow::maps::{Cay, CoordinateMap};
use lieflow::methods::Method;
use lieflow::problems::{Ambient, PointOf, Problem};
use lieflow::{Error, LieAlgebra};

use super::super::points::Points;
use super::super::represent::Represent;
use super::ensemble::{MEMBERS, largest_error, measure_over};
use super::estimate::Estimate;
use super::flow::{Reference, measure, reference};

/// What happened to one method.
pub(crate) enum Outcome {
    /// It does not fit the problem.
    Refused,
    /// Its order is measured elsewhere.
    Elsewhere,
    /// Its order.
    Measured(Result<Estimate, String>),
    /// No order is measured: its relative error, which must be below this.
    Below(f64, Result<f64, String>),
}

/// A method that claims to be the motion itself is as near to it in one step.
const EXACT: f64 = 1e-13;
/// With so many steps a method of order 8 or more is as near to the reference.
const FINE: (u64, f64) = (96, 1e-13);

/// Problems with their references. The first is for orders up to 4, all are for those above it.
pub(crate) struct Problems<P: Problem>(Vec<(P, Reference<P>)>);

impl<P: Ambient> Problems<P>
where
    P::Group: Represent,
    P::Action: Points<P::Group>,
    Cay: CoordinateMap<P::Group>,
{
    /// A single one: orders above 4 are measured elsewhere.
    pub(crate) fn one(problem: P, start: PointOf<P>) -> Self {
        let reference = reference(&problem, start);
        Problems(vec![(problem, reference)])
    }
    /// An ensemble, of problems by their number. Orders from 8 on, for which there is no room in `f64`, are
    /// measured in `orders/wide.rs`; here such a method must solve the problems.
    pub(crate) fn many(make: impl Fn(u64) -> (P, PointOf<P>)) -> Self {
        let with_reference = |(problem, start)| {
            let reference = reference(&problem, start);
            (problem, reference)
        };
        Problems((0..MEMBERS).map(make).map(with_reference).collect())
    }

    /// The name of the group.
    pub(crate) fn group(&self) -> String {
        self.0[0].0.group().name()
    }

    /// Measure a method; `single`: one problem is enough for orders up to 4.
    pub(crate) fn measure<M: Method<P>>(&self, method: &M, single: bool) -> Outcome {
        let Problems(members) = self;
        let (problem, reference) = &members[0];
        if matches!(method.work(problem, reference.start()), Err(Error::Unsupported { .. })) {
            return Outcome::Refused;
        }
        match method.facts(problem).order {
            usize::MAX => Outcome::Below(EXACT, largest_error(&members[..1], method, 1)),
            // Where the grid of the order has rounding on it, the one that begins at 4 steps has room.
            ..=4 if single => Outcome::Measured(
                measure(problem, method, reference).or_else(|_| measure_over(members, method)),
            ),
            5.. if members.len() == 1 => Outcome::Elsewhere,
            ..=7 => Outcome::Measured(measure_over(members, method)),
            _ => Outcome::Below(FINE.1, largest_error(members, method, FINE.0)),
        }
    }
}

/// Where the tests cut the Baker series: q = p − 2 keeps the order, a smaller q leaves q + 2.
fn cuts(method: &MethodInfo, tableau: Option<&str>) -> &'static [usize] {
    match tableau.unwrap_or(method.name) {
        "rkf45" | "dopri5" => &[3],
        "verner6" => &[4],
        "dop853" => &[6],
        "rkmk4" => &[0, 1, 2],
        _ if tableau.is_some() => &[0, 1, 2],
        _ => &[],
    }
}

/// Every method of the lists with every tableau, map and cut that it takes.
pub(crate) fn specs(needs: &[Needs]) -> Vec<MethodSpec> {
    let mut specs = Vec::new();
    for method in needs.iter().flat_map(|needs| needs.methods()) {
        let tableaus = match method.takes_tableau {
            true => TABLEAUS.iter().map(|t| Some(t.name)).collect(),
            false => vec![None],
        };
        for tableau in tableaus {
            let maps: Vec<_> = match method.takes_map() {
                true => (MAPS.iter().map(|m| (Some(m.name), None)))
                    .chain(cuts(method, tableau).iter().map(|&q| (Some("exp"), Some(q))))
                    .collect(),
                false => vec![(None, None)],
            };
            for &(map, q) in &maps {
                let tableau = tableau.map(Into::into);
                specs.push(MethodSpec { tableau, q, ..MethodSpec::new(method.name, map) });
            }
        }
    }
    specs
}

/// Does the catalog say that the method's map serves it, and this group?
fn serves(spec: &MethodSpec, group: &str) -> bool {
    let Some(map) = &spec.map else { return true };
    let Some(map) = MAPS.iter().find(|m| m.name == map) else { return false };
    let odd_only = spec.info().is_ok_and(|info| info.maps == Maps::Odd);
    (map.odd || !odd_only) && map.groups.contain(group)
}

/// What is found on one problem: printed as a table, and all of it must hold.
pub(crate) struct Report {
    title: String,
    table: String,
    failures: Vec<String>,
}

impl Report {
    /// On problems of this title.
    pub(crate) fn new(title: &str) -> Self {
        Report { title: title.into(), table: format!("{title}\n"), failures: Vec::new() }
    }

    /// Every method of the lists on a group: it is measured, or refused where the catalog says so.
    pub(crate) fn of(
        title: &str,
        group: &str,
        needs: &[Needs],
        measured: impl Fn(&MethodSpec) -> Result<Outcome, Error>,
    ) {
        let mut report = Report::new(title);
        for spec in specs(needs) {
            let outcome = match measured(&spec) {
                Err(Error::Unsupported { .. }) => Outcome::Refused,
                outcome => outcome.unwrap(),
            };
            report.add(&spec.label(), serves(&spec, group), outcome);
        }
        report.assert();
    }

    /// A method that should be measured, or be refused.
    pub(crate) fn add(&mut self, label: &str, serves: bool, outcome: Outcome) {
        match outcome {
            Outcome::Refused if serves => self.failures.push(format!("{label}: refused")),
            Outcome::Refused | Outcome::Elsewhere => {}
            _ if !serves => {
                self.failures.push(format!("{label}: taken although the catalog says otherwise"));
            }
            Outcome::Below(bound, found) => match found {
                Ok(gap) if gap < bound => self.table += &format!("  {label:<30} {gap:.1e}\n"),
                other => self.failures.push(format!("{label}: {other:?}")),
            },
            Outcome::Measured(measured) => {
                let verdict = measured.as_ref().map_err(Clone::clone).and_then(Estimate::check);
                if let Err(reason) = verdict {
                    self.failures.push(format!("{label}: {reason}"));
                }
                if let Ok(m) = measured {
                    let how = if m.two_terms { ", two terms" } else { "" };
                    self.table += &format!("  {label:<30} {}  {:.2?}{how}\n", m.claimed, m.slopes);
                }
            }
        }
    }

    /// All of it held.
    pub(crate) fn assert(self) {
        let Report { title, table, failures, .. } = self;
        println!("{table}");
        assert!(failures.is_empty(), "{title}:\n  {}", failures.join("\n  "));
    }
}
