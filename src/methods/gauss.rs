//! Gauss collocation on the linear space around M, for comparison: the implicit midpoint rule and
//! the Gauss methods of order 4 and 6.
//!
//! K_i = F(t + c_i h, y + h Σ_j a_ij K_j), y⁺ = y + h Σ_i b_i K_i.
//!
//! Order 2S. Preserves: every quadratic invariant to the rounding of the iteration (|m|², gᵀg, gm,
//! the energy of a rigid body by its momentum), time symmetry, the symplectic structure of linear
//! symplectic spaces; not other groups. Fixed-point iteration finds the
//! stages. It converges while h times the Lipschitz constant of F is below about 1. Beyond that the step fails with
//! [`StepError::FixedPointDidNotConverge`], which has the last change; the error of the run also has t and h. Cost: 5
//! to 20 iterations of S evaluations of F. Dense output of order 2, 3 and 5 takes 2, 2 and 5 more.
//! Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.3, IV.2.

use super::extension::{EXTRA, Extension, of_increment};
use super::newton::Progress;
use super::stages::copies;
use super::{Facts, MapCounts, Method, Step, Symmetric, Within};
use crate::error::{Error, StepError};
use crate::problems::FieldStore;
use crate::problems::{Ambient, PointOf, ScalarOf};
use crate::scalar::{Real, larger};
use crate::space::{Gap, LinearSpace, Metric};
use crate::tolerance::Scales;

/// An implicit Runge–Kutta tableau with S stages; every `a[i][j]` is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImplicitTableau<const S: usize> {
    /// The name of the method on the linear space.
    pub name: &'static str,
    /// The classical order.
    pub order: usize,
    /// Stage weights a_ij.
    pub a: [[f64; S]; S],
    /// Update weights b_j.
    pub b: [f64; S],
    /// Nodes c_i.
    pub c: [f64; S],
}

impl<const S: usize> ImplicitTableau<S> {
    /// The number of stages: S, or fewer for a tableau with room for more.
    pub const fn stages(&self) -> usize {
        let mut s = S;
        while s > 1 && self.b[s - 1] == 0.0 {
            s -= 1;
        }
        s
    }

    /// This tableau with room for N stages, at least as many as it has, so that methods chosen by name share one type.
    /// The added stages have the weight 0. RKMK methods never evaluate them.
    #[cfg(feature = "dense")]
    pub(crate) const fn resized<const N: usize>(&self) -> ImplicitTableau<N> {
        let mut to = ImplicitTableau {
            name: self.name,
            order: self.order,
            a: [[0.0; N]; N],
            b: [0.0; N],
            c: [0.0; N],
        };
        let mut i = 0;
        while i < self.stages() {
            (to.b[i], to.c[i]) = (self.b[i], self.c[i]);
            let mut j = 0;
            while j < self.stages() {
                to.a[i][j] = self.a[i][j];
                j += 1;
            }
            i += 1;
        }
        to
    }
}

/// √3/6.
const R3: f64 = 0.288675134594812882254574390251;
/// √15.
const R15: f64 = 3.87298334620741688517926539978;

/// The implicit midpoint rule, Gauss of order 2.
pub const GAUSS2: ImplicitTableau<1> =
    ImplicitTableau { name: "midpoint-implicit", order: 2, a: [[0.5]], b: [1.0], c: [0.5] };

/// Gauss of order 4 (Hammer–Hollingsworth).
pub const GAUSS4: ImplicitTableau<2> = ImplicitTableau {
    name: "gauss4",
    order: 4,
    a: [[0.25, 0.25 - R3], [0.25 + R3, 0.25]],
    b: [0.5, 0.5],
    c: [0.5 - R3, 0.5 + R3],
};

/// Gauss of order 6 (Kuntzmann–Butcher).
pub const GAUSS6: ImplicitTableau<3> = ImplicitTableau {
    name: "gauss6",
    order: 6,
    a: [
        [5.0 / 36.0, 2.0 / 9.0 - R15 / 15.0, 5.0 / 36.0 - R15 / 30.0],
        [5.0 / 36.0 + R15 / 24.0, 2.0 / 9.0, 5.0 / 36.0 - R15 / 24.0],
        [5.0 / 36.0 + R15 / 30.0, 2.0 / 9.0 + R15 / 15.0, 5.0 / 36.0],
    ],
    b: [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0],
    c: [0.5 - R15 / 10.0, 0.5, 0.5 + R15 / 10.0],
};

/// A Gauss method on the entries of y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauss<const S: usize>(pub ImplicitTableau<S>);

impl<const S: usize> Symmetric for Gauss<S> {}

/// Stages, points, the dense output, and the scratch of the field.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct GaussWork<P: Ambient, const S: usize> {
    k: [PointOf<P>; S],
    old: PointOf<P>,
    z: PointOf<P>,
    /// (y⁺ − y)/h and F at the start.
    ends: [PointOf<P>; 2],
    extra: [PointOf<P>; EXTRA],
    field: FieldStore<P>,
    iterations: u64,
}

impl<const S: usize> Gauss<S> {
    fn extension(&self) -> Extension<'static, 2> {
        of_increment(self.0.order, 0.0)
    }
}

impl<P: Ambient, const S: usize> Method<P> for Gauss<S> {
    type Work = GaussWork<P, S>;

    fn facts(&self, _: &P) -> Facts {
        let extension = self.extension();
        let facts = Facts::of_order(self.0.order).cost(None, MapCounts::default());
        Facts {
            stays_on_manifold: false,
            ..facts.dense(extension.order(), 1 + extension.evaluations())
        }
    }
    fn iterations(&self, work: &Self::Work) -> u64 {
        work.iterations
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        Ok(GaussWork {
            k: copies(like.clone()),
            old: like.clone(),
            z: like.clone(),
            ends: copies(like.clone()),
            extra: copies(like.clone()),
            field: FieldStore::new(problem),
            iterations: 0,
        })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { t, h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        GaussWork { k, old, z, field, iterations, .. }: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (tab, lit) = (&self.0, ScalarOf::<P>::lit);
        let time = |i: usize| t + h * lit(tab.c[i]);
        for i in 0..S {
            problem.field(time(i), y, &mut k[i], field);
            if !k[i].is_finite() {
                return Err(StepError::NonFiniteRhs { stage: i + 1 });
            }
        }
        // From 0 the changes are relative to the length of the step.
        let norm = y.size();
        let length = || k.iter().fold(lit(0.0), |length, k| larger(length, h.abs() * k.size()));
        let size = if norm == lit(0.0) { length() } else { norm };
        let scale = if size == lit(0.0) { lit(1.0) } else { size };
        let mut progress = Progress::new(iterations);
        loop {
            let mut change = lit(0.0);
            for i in 0..S {
                z.set_sum(y, h, &tab.a[i], k);
                old.assign(&k[i]);
                problem.field(time(i), z, &mut k[i], field);
                change += k[i].distance(old);
            }
            let change = h.abs() * change / scale;
            if progress.done(tab.name, change)? {
                if PointOf::<P>::IS_ONE_PART {
                    break;
                }
                // The change of the last stage.
                old.add(lit(-1.0), &k[S - 1]);
                let of_parts = z.error_ratio(Gap::of(old), &mut Scales::relative());
                if progress.parts_are_done(change, h.abs() * of_parts) {
                    break;
                }
            }
        }
        z.set_sum(y, h, &tab.b, k);
        StepError::finite(z.is_finite(), "the state")?;
        core::mem::swap(y, z);
        Ok(())
    }
    fn prepare(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        from: &PointOf<P>,
        _: &PointOf<P>,
        GaussWork { k, z, ends, extra, field, .. }: &mut Self::Work,
    ) -> Result<(), StepError> {
        ends[0].clear();
        for (&b, k) in self.0.b.iter().zip(&*k) {
            ends[0].add(ScalarOf::<P>::lit(b), k);
        }
        problem.field(step.t, from, &mut ends[1], field);
        self.extension().prepare_in_space(problem, step, from, (ends, None), extra, z, field)
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
        GaussWork { ends, extra, .. }: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        self.extension().point_in_space((theta, h), from, ends, extra, at)
    }
}
