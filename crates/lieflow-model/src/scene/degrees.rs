//! Angular velocities that are likely in degrees: a note says so.

use core::f64::consts::TAU;

use lieflow::SaveAt;
use lieflow::catalog::Property;

use super::run::Scene;
use crate::reader::Tree;

/// A number that is written as such.
fn number(value: &Tree) -> Option<f64> {
    match value {
        Tree::Whole(n) => Some(*n as f64),
        Tree::Number(x) => Some(*x),
        _ => None,
    }
}

impl Scene {
    /// What a reader should know: changes that were made to numbers of the scene, and what is likely a slip.
    pub fn notes(&self) -> Vec<String> {
        let angles = self.angles_in_degrees().or_else(|| self.likely_in_degrees());
        self.problem.notes().iter().cloned().chain(angles).collect()
    }

    /// The note about an Euler angle of the start that is more than a turn.
    fn angles_in_degrees(&self) -> Option<String> {
        let Tree::Table(keys) = &self.keys else { return None };
        let tables = ["euler", "fixed"].into_iter().filter_map(|key| match keys.get(key)? {
            Tree::Table(sequences) => Some((key, sequences)),
            _ => None,
        });
        let mut sequences =
            tables.flat_map(|(key, all)| all.iter().map(move |(name, list)| (key, name, list)));
        sequences.find_map(|(key, name, list)| {
            let Tree::List(angles) = list else { return None };
            let angle = angles.iter().filter_map(number).find(|angle| angle.abs() > TAU)?;
            Some(format!(
                "{key}.{name} has the angle {angle}, which is more than a turn: angles are in radians. Degrees are written \
                 \"{angle}*deg\""
            ))
        })
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
        let numbers = omega.iter().map(number).collect::<Option<Vec<f64>>>()?;
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
