//! Steps by error where times are large beside them.
//!
//! The time of a stage is rounded, so f(t, y) has an error of about ε/2·|t|·|∂f/∂t|, and the estimated error of a step has a
//! part that is a multiple of h times that. Where this part is more than the tolerance, the tolerance cannot be met: smaller
//! steps are more, and their errors add up to the same. Such steps are chosen by the rest of their error. Here an error is
//! relative to the whole of a part, because rounding relative to the length of a step does not fall with the step size.

use super::control::GOAL;
use super::points::AnyPoints;
use super::timeline::{Chooser, Pacer, Timeline};
use crate::methods::Streak;
use crate::tolerance::{Rule, Weight};

/// The part of the estimated error of a step that is rounding of t.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Noise {
    /// In units of the tolerance, for each unit of the step size; 0 where it does not count.
    pub(super) per_size: f64,
    /// The number of accepted steps at which it is computed again.
    pub(super) next: u64,
    /// The step size at which it was computed.
    size: f64,
}

impl Noise {
    /// The number of steps after which the noise is computed again: where there was none, and where there was.
    const EVERY: [u64; 2] = [256, 16];
    /// Steps of these parts of the size show the noise: their error is nothing else.
    const PARTS: [f64; 2] = [1.0 / 64.0, 1.0 / 50.0];
    /// The noise varies from step to step. This is how many times that of a part it may be.
    const VARIES: f64 = 2.0;
    /// The noise is at most this many times the error of f. The weights of an estimate are no larger.
    const MOST: f64 = 8.0;
    /// An error that may be all noise counts as one that allows a step of this many times the size. So the steps grow.
    const GROWTH: f64 = 1.3;

    /// The number of steps after which it is computed again.
    fn every(self) -> u64 {
        Self::EVERY[usize::from(self.per_size > 0.0)]
    }

    /// What the errors of steps are relative to.
    pub(super) fn weight(self) -> Weight {
        if self.per_size > 0.0 { Weight::Whole } else { Weight::Moved }
    }

    /// The ratio that counts, of an estimated error in units of the tolerance of a step of this size. `k` is the order of the
    /// estimate + 1.
    fn ratio(self, ratio: f64, size: f64, k: f64) -> f64 {
        let noise = self.per_size * size;
        if noise == 0.0 {
            return ratio;
        }
        let rest = (ratio - noise) / noise.max(1.0);
        rest.max((GOAL / Self::GROWTH).powf(k)).min(ratio)
    }
}

impl Timeline {
    /// True if the rounding of t in f may be more than the tolerance of a step of this size.
    fn may_be_noisy(&self, size: f64) -> bool {
        let Pacer::ByError(chooser) = &self.pacer else { return false };
        f64::EPSILON * self.t.abs() > chooser.control.tolerance.of_unit_size() * size
    }

    /// The part of an error, in units of the tolerance, that counts.
    pub(super) fn beyond_noise(&self, ratio: f64, size: f64) -> f64 {
        let Pacer::ByError(chooser) = &self.pacer else { return ratio };
        chooser.noise.ratio(ratio, size, chooser.controller.k())
    }

    /// Computes the noise of steps of this size, if that was long ago.
    pub(super) fn see_noise_again(&mut self, points: &mut dyn AnyPoints, size: f64) {
        let Pacer::ByError(Chooser { noise, controller, .. }) = &self.pacer else { return };
        if self.stats.accepted >= noise.next && !controller.is_exact() {
            self.see_noise(points, size);
        }
    }

    /// True if the error of a step is found to be noise that was not known. Then the end of the attempt is lost.
    pub(super) fn is_noise(&mut self, points: &mut dyn AnyPoints, ratio: f64, size: f64) -> bool {
        let Pacer::ByError(Chooser { noise, .. }) = &self.pacer else { return false };
        let is_new = noise.next == self.stats.accepted + noise.every() && 4.0 * size > noise.size;
        if is_new || self.beyond_noise(ratio, size) <= 1.0 {
            return false;
        }
        self.see_noise(points, size);
        self.beyond_noise(ratio, size) <= 1.0
    }

    /// Computes the noise of steps of this size, where there may be any.
    fn see_noise(&mut self, points: &mut dyn AnyPoints, size: f64) {
        let mut per_size = 0.0;
        if self.may_be_noisy(size) {
            points.weigh(Weight::Whole);
            per_size = self.noise_of(points, size);
        }
        let Pacer::ByError(Chooser { noise, .. }) = &mut self.pacer else { return };
        *noise = Noise { per_size, next: self.stats.accepted, size };
        noise.next += noise.every();
        points.weigh(noise.weight());
    }

    /// The noise of steps of this size for each unit of it, as their parts show it; 0 where it does not count.
    fn noise_of(&mut self, points: &mut dyn AnyPoints, size: f64) -> f64 {
        let Pacer::ByError(Chooser { controller, control, .. }) = &self.pacer else { return 0.0 };
        let rule = control.tolerance.rule();
        // Less does not keep a step from growing.
        let least = controller.kept[0];
        let (t, forward) = (self.start_of(size), self.t1 - self.t);
        let most = Noise::MOST * points.noise_of_time(t, size.copysign(forward)) / size;
        self.stats.evaluations = self.stats.evaluations.map(|n| n + 2);
        if most.is_nan() || most == 0.0 {
            return 0.0;
        }
        let mut seen = 0.0_f64;
        for part in Noise::PARTS {
            let Some((h, ratio)) = self.ratio_of_part(points, part * size) else { return 0.0 };
            // By the length of the step, the parts have the same ratio as the whole.
            let of = match rule {
                Rule::PerStep => h,
                Rule::PerLength => size,
            };
            seen = seen.max(ratio / of);
        }
        let noise = (Noise::VARIES * seen).min(most);
        if noise * size > least {
            return noise;
        }
        // Relative to the length of a short step, it does not fall with the step size.
        points.weigh(Weight::Moved);
        let short = self.ratio_of_part(points, Noise::PARTS[0] * size);
        match short {
            Some((h, ratio)) if ratio > least && ratio > 2.0 * seen * h => noise,
            _ => 0.0,
        }
    }

    /// The size of a step that is a part of another one, and its ratio; `None` where there is no such step.
    fn ratio_of_part(&mut self, points: &mut dyn AnyPoints, size: f64) -> Option<(f64, f64)> {
        let end = self.t + size.copysign(self.t1 - self.t);
        let trial = self.step_to(end, end - self.t, false);
        if trial.h == 0.0 {
            return None;
        }
        self.attempted(1);
        let ratio = points.attempt(trial, end, &Streak::ONE).ratio.ok()?;
        Some((trial.h.abs(), ratio))
    }
}
