//! How near the Euler angles of a run come to where they are singular.

use crate::output;
use lieflow_model::schema::{Branch, Observable, Row};

/// Euler angles that are nearer to where they are singular turn fast: a degree, in radians.
const NEAR: f64 = 0.0175;

/// What is known of the Euler angles of one sequence: how far they are from where they are singular, and when.
///
/// A run may start there, as from the identity. The start does not hide what comes later.
pub(super) struct Singular<'a> {
    angles: &'a Observable,
    /// At the start.
    start: [f64; 2],
    /// How far they have come from the start, as long as they leave it; infinite once they have come nearer again.
    risen: f64,
    /// The nearest later.
    pass: [f64; 2],
}

impl<'a> Singular<'a> {
    /// None for other quantities.
    pub(super) fn of(angles: &'a Observable) -> Option<Self> {
        let none = [f64::INFINITY, 0.0];
        let is_euler = matches!(angles.branch, Branch::Euler { .. });
        is_euler.then_some(Singular { angles, start: none, risen: 0.0, pass: none })
    }

    /// The next point in the order of time.
    pub(super) fn see(&mut self, t: f64, row: Row<'_>) {
        let Some(far) = self.angles.branch.distance_to_singular(&row[self.angles]) else { return };
        if self.start[0].is_infinite() {
            (self.start, self.risen) = ([far, t], far);
        }
        // Rounding moves angles that stay at the singular one.
        if far >= self.risen || far <= Branch::SINGULAR && self.risen <= Branch::SINGULAR {
            self.risen = far;
            return;
        }
        self.risen = f64::INFINITY;
        if far < self.pass[0] {
            self.pass = [far, t];
        }
    }

    /// Calls `each` with all that was seen, as numbers.
    pub(super) fn each_unshown(&mut self, each: &mut dyn FnMut(&mut f64)) {
        let Singular { start, risen, pass, .. } = self;
        start.iter_mut().chain([risen]).chain(pass).for_each(each);
    }

    /// What is to be known: of the start if it is singular, and of what comes nearest.
    pub(super) fn in_words(&self) -> impl Iterator<Item = String> {
        let Singular { start, pass, .. } = *self;
        let is_singular = start[0] <= Branch::SINGULAR;
        let nearest = if !is_singular && start[0] < pass[0] { start } else { pass };
        let told = [Some(start).filter(|_| is_singular), Some(nearest)];
        told.into_iter().flatten().filter_map(|[far, t]| {
            let (name, t) = (self.angles.name, output::number(t));
            let [degrees, radians] = [far.to_degrees(), far].map(output::rough);
            match far {
                _ if far <= Branch::SINGULAR => Some(format!(
                    "{name} is singular at t = {t}: the first and the third angle turn about one axis there, and the \
                     third angle keeps its value"
                )),
                _ if far <= NEAR => Some(format!(
                    "{name} comes within {degrees} degrees of its singular angle at t = {t}: the first and the third \
                     angle turn fast there. If the error of the attitude is not far below {radians} radians, they may \
                     lose whole turns; another sequence or the quaternion does not"
                )),
                _ => None,
            }
        })
    }
}
