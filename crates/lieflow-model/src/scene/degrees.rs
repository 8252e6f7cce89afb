//! Angular velocities that are likely in degrees: a note says so.

use core::f64::consts::TAU;

use lieflow::SaveAt;
use lieflow::catalog::Property;

use super::run::Scene;
use crate::reader::Tree;

impl Scene {
    /// What a reader should know: changes that were made to numbers of the scene, and what is likely a slip.
    pub fn notes(&self) -> Vec<String> {
        self.problem.notes().iter().cloned().chain(self.likely_in_degrees()).collect()
    }

    /// True if the step that was typed is longer than the span.
    fn has_one_long_step(&self) -> bool {
        let [start, end] = self.grid.t_span();
        self.grid.h().abs() > (end - start).abs()
    }

    /// The note where a body turns more than once in a step of the scene. A body that spins fast is right, too. So nothing
    /// is said where the start is a formula, where each point is exact, and of rows, but where the time is in seconds. There
    /// more than a turn in a second is told, too.
    fn likely_in_degrees(&self) -> Option<String> {
        let rate = self.problem.rate()?;
        let Tree::Table(keys) = &self.keys else { return None };
        let Tree::List(omega) = keys.get("omega_body")? else { return None };
        let numbers = omega.iter().map(|x| match x {
            Tree::Whole(n) => Some(*n as f64),
            Tree::Number(x) => Some(*x),
            _ => None,
        });
        let numbers = numbers.collect::<Option<Vec<f64>>>()?;
        let largest = numbers.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let is_exact = self.method.info().is_ok_and(|info| info.keeps(Property::Everything));
        let in_seconds = self.units.time.as_deref() == Some("s");
        let (between, how_long) = match (&self.adaptive, &self.save) {
            // A step that is longer than the span is the mistake, and not the angular velocity.
            (None, _) if !is_exact && !self.has_one_long_step() => {
                (format!("in a step of {}", self.grid.h().abs()), self.grid.h())
            }
            (_, SaveAt::Interval(interval))
                if in_seconds && !self.by_default.rows && rate > 1.0 =>
            {
                (format!("from row to row, {interval} s"), *interval)
            }
            // Rows that nobody chose say nothing.
            _ if in_seconds && self.by_default.rows && self.adaptive.is_some() => {
                ("in a second".into(), 1.0)
            }
            _ => return None,
        };
        let turns = rate * how_long.abs() / TAU;
        (turns > 1.0).then(|| {
            format!(
                "the body turns {turns:.1} times {between}: omega_body is in radians per time. Degrees are written \
                 \"{largest}*deg\""
            )
        })
    }
}
