//! Classical explicit Runge–Kutta on the linear space around M: the comparison method of the paper.
//!
//! It leaves the group: gᵀg − 𝟙 and |m| drift with the order of the method. Order: that of the tableau.
//! Preserves: linear invariants only. Cost: S evaluations of F.
//! Points within a step: [`Dense`](super::tableau::Dense).
//! Source: Hairer, Nørsett, Wanner I, p. 138.

use super::embedded::LARGEST_RATIO;
use super::extension::{EXTRA, Extension};
use super::stages::{Known, copies, sum};
use super::{Embedded, Facts, MapCounts, Method, Step, StepCost, Tableau, Within};
use crate::error::{Error, StepError};
use crate::problems::FieldStore;
use crate::problems::{Ambient, PointOf, ScalarOf};
use crate::scalar::{Real, smaller};
use crate::space::{Gap, LinearSpace, Metric};
use crate::tolerance::{Rule, Tolerance, ratio};

/// An explicit Runge–Kutta method on the entries of y.
#[derive(Clone, Copy, Debug)]
pub struct Rk<const S: usize>(pub Tableau<S>);

/// Stages, a point, the extra stages of dense output, and the scratch of the field.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct RkWork<P: Ambient, const S: usize> {
    k: [PointOf<P>; S],
    z: PointOf<P>,
    extra: [PointOf<P>; EXTRA],
    field: FieldStore<P>,
    /// The last stage of the last step, where it is the first one of the next step.
    known: Known<PointOf<P>>,
}

/// The stages that a step takes.
#[derive(Clone, Copy)]
struct Stages {
    count: usize,
    /// True if the first stage is there already.
    has_first: bool,
    /// True if the last stage is taken at the end of the step. Then no further sum is needed.
    ends_at_last: bool,
}

impl<const S: usize> Rk<S> {
    /// z ← the step from y.
    #[inline(always)]
    fn advance<P: Ambient>(
        &self,
        Stages { count, has_first, ends_at_last }: Stages,
        problem: &P,
        Step { t, h, .. }: Step<ScalarOf<P>>,
        y: &PointOf<P>,
        RkWork { k, z, field, .. }: &mut RkWork<P, S>,
    ) -> Result<(), StepError> {
        let tab = &self.0;
        // Up to four stages the compiler keeps all of them in registers.
        let mut newest = if PointOf::<P>::IS_SMALL && S > 4 { Some(k[0].clone()) } else { None };
        if !has_first {
            let stage = newest.as_mut().unwrap_or(&mut k[0]);
            problem.field(t, y, stage, field);
            if let Some(newest) = &newest {
                k[0].assign(newest);
            }
        }
        for i in 1..S {
            if i >= count {
                break;
            }
            sum(y, h, &tab.a[i][..i], k, newest.as_ref(), z);
            let t = t + h * ScalarOf::<P>::lit(tab.c[i]);
            let stage = newest.as_mut().unwrap_or(&mut k[i]);
            problem.field(t, z, stage, field);
            if let Some(newest) = &newest {
                k[i].assign(newest);
            }
        }
        if !ends_at_last {
            sum(y, h, &tab.b[..count], k, newest.as_ref(), z);
        }
        if !z.is_finite() {
            return Err(match k[..count].iter().position(|k| !k.is_finite()) {
                Some(stage) => StepError::NonFiniteRhs { stage: stage + 1 },
                None => StepError::NotFinite { what: "the state" },
            });
        }
        Ok(())
    }
}

impl<P: Ambient, const S: usize> Method<P> for Rk<S> {
    type Work = RkWork<P, S>;

    fn facts(&self, _: &P) -> Facts {
        let (tableau, extension) = (&self.0, Extension::of(&self.0));
        let facts = Facts::of_order(tableau.order)
            .cost(Some(tableau.update_stages() as u64), MapCounts::default())
            .estimate(tableau.name, tableau.error.map(|e| e.order))
            .dense(extension.order(), extension.evaluations());
        let evaluations = Some(tableau.all_stages() as u64);
        let step_with_error = StepCost { evaluations, ..facts.step };
        Facts { stays_on_manifold: false, step_with_error, ..facts }
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        self.0.check_before_run()?;
        Ok(RkWork {
            k: copies(like.clone()),
            z: like.clone(),
            extra: copies(like.clone()),
            field: FieldStore::new(problem),
            known: Known::new(like, self.0.ends_with_first_stage()),
        })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        let count = self.0.update_stages();
        let stages = Stages { count, has_first: false, ends_at_last: false };
        self.advance(stages, problem, step, y, work)?;
        y.assign(&work.z);
        Ok(())
    }
    fn reused(&self, work: &Self::Work) -> u64 {
        work.known.used
    }
    fn forget(&self, work: &mut Self::Work) {
        work.known.forget();
    }
    fn prepare(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        end: &PointOf<P>,
        RkWork { k, z, extra, field, known }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let extension = Extension::of(&self.0);
        let is_known = extension.evaluations() > 0 && known.has(step.t + step.h, end);
        known.used += u64::from(is_known);
        let end = is_known.then(|| self.0.all_stages() - 1);
        extension.prepare_in_space(problem, step, from, (k, end), extra, z, field)
    }
    fn within(&self, _: &Self::Work) -> Within {
        Within::Space
    }
    fn interpolate(
        &self,
        _: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        RkWork { k, extra, .. }: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        Extension::of(&self.0).point_in_space((theta, h), from, k, extra, at)
    }
}

impl<P: Ambient, const S: usize> Embedded<P> for Rk<S> {
    #[inline(always)]
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        work: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        let stages = self.0.all_stages();
        let has_first = work.known.take(step.t, from);
        if has_first {
            work.k.swap(0, stages - 1);
        }
        let ends_at_last = work.known.is_offered;
        let which = Stages { count: stages, has_first, ends_at_last };
        self.advance(which, problem, step, from, work)?;
        let RkWork { k, z, known, .. } = work;
        to.assign(z);
        if known.is_offered {
            known.set(step.t + step.h, to);
        }
        let size = |weights: &[f64; S]| {
            z.set_terms(step.h, &weights[..stages], k);
            match tolerance.rule() {
                // Next to a jump a step may be so short that it does not move the point.
                Rule::PerLength => smaller(
                    Real::lit(LARGEST_RATIO),
                    ratio(z.size(), tolerance.per_length(to.distance(from))),
                ),
                Rule::PerStep => {
                    to.error_ratio(Gap::of(z).of_step_from(from), &mut tolerance.scales())
                }
            }
        };
        let Some(estimate) = &self.0.error else { return Ok(ScalarOf::<P>::lit(f64::INFINITY)) };
        let error = estimate.error(size);
        match error.is_finite() {
            true => Ok(error),
            false => Err(StepError::NotFinite { what: "the error estimate" }),
        }
    }
}
