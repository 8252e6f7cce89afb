//! Commutator-free methods in low storage: four elements of 𝔤 and two points for any number of stages.
//!
//! For i = 1, …, s: T ← A_i T + h f(t + C_i h, Y); Y ← exp(B_i T) Y. Every Runge–Kutta method of
//! Williamson's 2N form has its full order in this way (A. Bazavov, Commutator-free Lie group methods with
//! minimum storage requirements and reuse of exponentials, BIT 62 (2022)).
//!
//! | table | order | stages | source |
//! |---|---|---|---|
//! | [`LS3`] | 3 | 3 | Williamson 1980 (6); Lüscher 2010 |
//! | [`LS3_BP`] | 3 | 3 | Bernardini, Pirozzoli 2009 |
//! | [`LS32`] | 3(2) | 5 | Bazavov 2022 |
//! | [`LS4`] | 4 | 5 | Carpenter, Kennedy 1994 |
//! | [`LS5`] | 5 | 13 | Yan 2017 |
//! | [`EES25`] | 2, reversible to 5 | 3 | Shmelev, Thompson, Salvi 2025 (x = 1/10) |
//! | [`EES27`] | 2, reversible to 7 | 4 | the same |
//!
//! An EES(2,m) method has order 2 and is nearly symmetric: a step of −h undoes a step of h up to O(h^{m+1}). The map is
//! exp. Preserves: the group, and the invariants of the action. Cost: s f, s exponentials.
//!
//! The error estimate of [`LS32`] is not that of its source, the point before the last exponential. Where f is linear in t, the
//! argument of the last exponential is 0, whatever the error. The other result of order 2 is here one exponential of the sum of
//! all arguments but the last. Cost of a step with an estimate: 5 f, 6 exponentials.

use super::embedded::ratio_between;
use super::tableau::pad;
use super::{Embedded, Facts, MapCounts, Method, Metric, Step, StepCost};
use crate::chart::ChartStore;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::{CoordinateMap, Exp};
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::tolerance::Tolerance;

/// The coefficients of a method in Williamson's 2N form with S stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoN<const S: usize> {
    /// The name of the method.
    pub name: &'static str,
    /// The order of the method.
    pub order: usize,
    /// A_i; the first is 0.
    pub a: [f64; S],
    /// B_i.
    pub b: [f64; S],
    /// C_i.
    pub c: [f64; S],
    /// The order of one exponential of all B_i T but the last as a result at t + h, if it is used for the error estimate.
    pub embedded: Option<usize>,
}

impl<const S: usize> TwoN<S> {
    /// The number of stages: S, or fewer for a [`padded`](Self::padded) method.
    pub const fn stages(&self) -> usize {
        let mut s = S;
        while s > 1 && self.b[s - 1] == 0.0 {
            s -= 1;
        }
        s
    }

    /// This method with room for N ≥ S stages. The added stages are never evaluated.
    pub const fn padded<const N: usize>(&self) -> TwoN<N> {
        let TwoN { name, order, embedded, .. } = *self;
        TwoN { name, order, a: pad(&self.a), b: pad(&self.b), c: pad(&self.c), embedded }
    }
}

/// Williamson's sixth method, known from Lüscher's Wilson flow; order 3.
pub const LS3: TwoN<3> = TwoN {
    name: "cf-ls3",
    order: 3,
    a: [0.0, -17.0 / 32.0, -32.0 / 27.0],
    b: [0.25, 8.0 / 9.0, 0.75],
    c: [0.0, 0.25, 2.0 / 3.0],
    embedded: None,
};

/// Bernardini and Pirozzoli's, order 3, chosen for the propagation of waves.
pub const LS3_BP: TwoN<3> = TwoN {
    name: "cf-ls3-bp",
    order: 3,
    a: [0.0, -0.6376944718422022, -1.3066477177371079],
    b: [0.45737999756938819, 0.92529641092092174, 0.39381359467507099],
    c: [0.0, 0.45737999756938819, 0.7926200024306075],
    embedded: None,
};

/// Order 3, with a result of order 2.
pub const LS32: TwoN<5> = TwoN {
    name: "cf-ls32",
    order: 3,
    a: [0.0, -5.0 / 8.0, -4.0 / 3.0, -3.0 / 4.0, -8.0 / 5.0],
    b: [0.25, 2.0 / 3.0, 0.5, 0.4, 1.0 / 9.0],
    c: [0.0, 0.25, 0.5, 0.75, 1.0],
    embedded: Some(2),
};

/// Carpenter and Kennedy's, order 4.
pub const LS4: TwoN<5> = TwoN {
    name: "cf-ls4",
    order: 4,
    a: [
        0.0,
        -567_301_805_773.0 / 1_357_537_059_087.0,
        -2_404_267_990_393.0 / 2_016_746_695_238.0,
        -3_550_918_686_646.0 / 2_091_501_179_385.0,
        -1_275_806_237_668.0 / 842_570_457_699.0,
    ],
    b: [
        1_432_997_174_477.0 / 9_575_080_441_755.0,
        5_161_836_677_717.0 / 13_612_068_292_357.0,
        1_720_146_321_549.0 / 2_090_206_949_498.0,
        3_134_564_353_537.0 / 4_481_467_310_338.0,
        2_277_821_191_437.0 / 14_882_151_754_819.0,
    ],
    c: [
        0.0,
        1_432_997_174_477.0 / 9_575_080_441_755.0,
        2_526_269_341_429.0 / 6_820_363_962_896.0,
        2_006_345_519_317.0 / 3_224_310_063_776.0,
        2_802_321_613_138.0 / 2_924_317_926_251.0,
    ],
    embedded: None,
};

/// Yan's, order 5.
pub const LS5: TwoN<13> = TwoN {
    name: "cf-ls5",
    order: 5,
    a: [
        0.0,
        -0.33672143119427413,
        -1.2018205782908164,
        -2.6261919625495068,
        -1.5418507843260567,
        -0.2845614242371758,
        -0.1700096844304301,
        -1.0839412680446804,
        -11.61787957751822,
        -4.5205208057464192,
        -35.86177355832474,
        -0.000021340899996007288,
        -0.066311516687861348,
    ],
    b: [
        0.069632640247059393,
        0.088918462778092020,
        1.0461490123426779,
        0.42761794305080487,
        0.20975844551667144,
        -0.11457151862012136,
        -0.01392019988507068,
        4.0330655626956709,
        0.35106846752457162,
        -0.16066651367556576,
        -0.0058633163225038929,
        0.077296133865151863,
        0.054301254676908338,
    ],
    c: [
        0.0,
        0.069632640247059393,
        0.12861035097891748,
        0.34083022189561149,
        0.54063706308495402,
        0.59927749518613931,
        0.49382042519248519,
        0.48207852767699775,
        0.82762865209834452,
        0.82923953914857933,
        0.67190565554748019,
        0.87194975193167848,
        0.94930216564503562,
    ],
    embedded: None,
};

/// CF-EES(2,5;1/10): order 2; a step back undoes a step to O(h⁶).
pub const EES25: TwoN<3> = TwoN {
    name: "cf-ees25",
    order: 2,
    a: [0.0, -7.0 / 15.0, -35.0 / 32.0],
    b: [1.0 / 3.0, 15.0 / 16.0, 0.4],
    c: [0.0, 1.0 / 3.0, 5.0 / 6.0],
    embedded: None,
};

const R: f64 = core::f64::consts::SQRT_2;

/// CF-EES(2,7): order 2; a step back undoes a step to O(h⁸).
pub const EES27: TwoN<4> = TwoN {
    name: "cf-ees27",
    order: 2,
    a: [0.0, (-7.0 + 4.0 * R) / 3.0, -(4.0 + 5.0 * R) / 12.0, 3.0 * (-31.0 + 8.0 * R) / 49.0],
    b: [(2.0 - R) / 3.0, (4.0 + R) / 8.0, 3.0 * (3.0 - R) / 7.0, (9.0 - 4.0 * R) / 14.0],
    c: [0.0, (2.0 - R) / 3.0, (2.0 + R) / 6.0, (4.0 + R) / 6.0],
    embedded: None,
};

/// A commutator-free method in low storage.
#[derive(Clone, Copy, Debug)]
pub struct LowStorage<const S: usize>(pub TwoN<S>);

/// T and the point, with storage for their updates.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
#[doc(hidden)]
pub struct LowStorageWork<P: Problem>
where
    Exp: CoordinateMap<P::Group>,
{
    inner: Inner<P>,
    y: PointOf<P>,
}

struct Inner<P: Problem>
where
    Exp: CoordinateMap<P::Group>,
{
    sum: AlgOf<P>,
    k: AlgOf<P>,
    u: AlgOf<P>,
    /// The sum of all increments but the last.
    before_last: AlgOf<P>,
    aside: PointOf<P>,
    chart: ChartStore<P, Exp>,
}

impl<P: Problem> Inner<P>
where
    Exp: CoordinateMap<P::Group>,
{
    /// `to` ← the step from p. The sum of all increments but the last is made if requested.
    #[inline(always)]
    fn advance<const S: usize>(
        &mut self,
        table: &TwoN<S>,
        problem: &P,
        Step { n, t, h }: Step<ScalarOf<P>>,
        p: &PointOf<P>,
        to: &mut PointOf<P>,
        with_error: bool,
    ) -> Result<(), StepError> {
        let (alg, lit) = (problem.group(), ScalarOf::<P>::lit);
        let Inner { sum, k, u, before_last, aside, chart } = self;
        if with_error {
            alg.set_zero(before_last);
        }
        for i in 0..table.stages() {
            let from = match i {
                0 => p,
                _ => {
                    core::mem::swap(aside, to);
                    &*aside
                }
            };
            let mut chart = chart.around(problem, &Exp, n, from);
            chart.field(t + h * lit(table.c[i]), k);
            if !alg.is_finite(k) {
                return Err(StepError::NonFiniteRhs { stage: i + 1 });
            }
            alg.set_zero(u); // T ← A_i T + h k
            if i > 0 {
                alg.axpy(lit(table.a[i]), sum, u);
            }
            alg.axpy(h, k, u);
            core::mem::swap(sum, u);
            alg.set_zero(u);
            alg.axpy(lit(table.b[i]), sum, u);
            if with_error && i + 1 < table.stages() {
                alg.axpy(lit(1.0), u, before_last);
            }
            chart.lambda(u, to)?;
        }
        Ok(())
    }
}

impl<P: Problem, const S: usize> Method<P> for LowStorage<S>
where
    Exp: CoordinateMap<P::Group>,
{
    type Work = LowStorageWork<P>;

    fn facts(&self, _: &P) -> Facts {
        let stages = self.0.stages() as u64;
        let maps = |psi| MapCounts { psi, ..MapCounts::default() };
        let facts = Facts::of_order(self.0.order)
            .cost(Some(stages), maps(stages))
            .estimate(self.0.name, self.0.embedded);
        let more = u64::from(self.0.embedded.is_some());
        let step_with_error = StepCost { maps: Some(maps(stages + more)), ..facts.step };
        Facts { step_with_error, ..facts }
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let alg = problem.group();
        let inner = Inner {
            sum: alg.zero(),
            k: alg.zero(),
            u: alg.zero(),
            before_last: alg.zero(),
            aside: like.clone(),
            chart: ChartStore::new(problem, &Exp, like)?,
        };
        Ok(LowStorageWork { inner, y: like.clone() })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        p: &mut PointOf<P>,
        LowStorageWork { inner, y }: &mut Self::Work,
    ) -> Result<(), StepError> {
        inner.advance(&self.0, problem, step, p, y, false)?;
        core::mem::swap(p, y);
        Ok(())
    }
}

impl<P: Problem, const S: usize> Embedded<P> for LowStorage<S>
where
    Exp: CoordinateMap<P::Group>,
    PointOf<P>: Metric<Scalar = ScalarOf<P>>,
{
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        LowStorageWork { inner, .. }: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        inner.advance(&self.0, problem, step, from, to, true)?;
        if self.0.embedded.is_none() {
            return Ok(ScalarOf::<P>::lit(f64::INFINITY));
        }
        let Inner { before_last, aside, chart, .. } = inner;
        chart.around(problem, &Exp, step.n, from).lambda(before_last, aside)?;
        Ok(ratio_between(tolerance, aside, 1.0, from, &*to))
    }
}
