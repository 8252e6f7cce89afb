//! Composition: raises a symmetric method of order 2 to order 4, 6, 8 or 10.
//!
//! Φ_h = φ_{w_S h} ∘ … ∘ φ_{w_1 h}, with w_i = w_{S+1−i} and Σ w_i = 1.
//!
//! | scheme | order | stages | source |
//! |---|---|---|---|
//! | [`STRANG`] | 2 | 1 | |
//! | [`YOSHIDA4`] (the triple jump) | 4 | 3 | H. Yoshida, Phys. Lett. A 150 (1990) |
//! | [`SUZUKI4`] | 4 | 5 | M. Suzuki, Phys. Lett. A 146 (1990) |
//! | [`KAHAN_LI6`] | 6 | 9 | W. Kahan & R.-C. Li, Math. Comp. 66 (1997) |
//! | [`KAHAN_LI8`] | 8 | 17 | W. Kahan & R.-C. Li, Math. Comp. 66 (1997) |
//! | [`SOFRONIOU_SPALETTA10`] | 10 | 35 | M. Sofroniou & G. Spaletta, Optim. Methods Softw. 20 (2005) |
//!
//! A composition conserves what the base method conserves, and is symmetric. Above order 2 some w_i are negative, and
//! these steps go backward. Cost: S steps of the base method.

use super::{Facts, Method, Step, Symmetric};
use crate::error::{Error, StepError};
use crate::problems::{Ambient, PointOf, ScalarOf};
use crate::scalar::Real;
use crate::space::Metric;

/// The weights of a symmetric composition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scheme {
    /// The name in scene files.
    pub name: &'static str,
    /// The order of the composition of a symmetric method of order 2.
    pub order: usize,
    /// w₁, …, w_S.
    pub weights: &'static [f64],
}

/// The base method alone.
pub const STRANG: Scheme = Scheme { name: "strang", order: 2, weights: &[1.0] };

/// Yoshida's triple jump: 1/(2 − 2^⅓) at both ends.
pub const YOSHIDA4: Scheme =
    Scheme { name: "yoshida4", order: 4, weights: &mirror::<2, 3>(TRIPLE_JUMP) };
const TRIPLE_JUMP: [f64; 2] = [1.35120719195965763404768780897, -1.70241438391931526809537561794];

/// Suzuki's fractal: 1/(4 − 4^⅓) four times.
pub const SUZUKI4: Scheme = Scheme { name: "suzuki4", order: 4, weights: &mirror::<3, 5>(FRACTAL) };
const FRACTAL: [f64; 3] = [
    0.414490771794375737142354062861,
    0.414490771794375737142354062861,
    -0.657963087177502948569416251443,
];

/// Kahan and Li's nine stages of order 6.
pub const KAHAN_LI6: Scheme =
    Scheme { name: "kahan-li6", order: 6, weights: &mirror::<5, 9>(NINE) };
const NINE: [f64; 5] = [
    0.39216144400731413927925056,
    0.33259913678935943859974864,
    -0.70624617255763935980996482,
    0.08221359629355080023149045,
    0.79854399093482996339895035,
];

/// Kahan and Li's seventeen stages of order 8.
pub const KAHAN_LI8: Scheme =
    Scheme { name: "kahan-li8", order: 8, weights: &mirror::<9, 17>(SEVENTEEN) };
const SEVENTEEN: [f64; 9] = [
    0.13020248308889008087881763,
    0.56116298177510838456196441,
    -0.38947496264484728640807860,
    0.15884190655515560089621075,
    -0.39590389413323757733623154,
    0.18453964097831570709183254,
    0.25837438768632204729397911,
    0.29501172360931029887096624,
    -0.60550853383003451169892108,
];

/// Sofroniou and Spaletta's thirty-five stages of order 10.
pub const SOFRONIOU_SPALETTA10: Scheme =
    Scheme { name: "sofroniou-spaletta10", order: 10, weights: &mirror::<18, 35>(THIRTY_FIVE) };
const THIRTY_FIVE: [f64; 18] = [
    0.07879572252168641926390768,
    0.31309610341510852776481247,
    0.02791838323507806610952027,
    -0.22959284159390709415121340,
    0.13096206107716486317465686,
    -0.26973340565451071434460973,
    0.07497334315589143566613711,
    0.11199342399981020488957508,
    0.36613344954622675119314812,
    -0.39910563013603589787862981,
    0.10308739852747107731580277,
    0.41143087395589023782070412,
    -0.00486636058313526176219566,
    -0.39203335370863990644808194,
    0.05194250296244964703718290,
    0.05066509075992449633587434,
    0.04967437063972987905456880,
    0.04931773575959453791768001,
];

/// The schemes, by ascending order.
pub const SCHEMES: [Scheme; 6] =
    [STRANG, YOSHIDA4, SUZUKI4, KAHAN_LI6, KAHAN_LI8, SOFRONIOU_SPALETTA10];

/// w₁, …, w_H, and then the same backward: N = 2H − 1.
const fn mirror<const H: usize, const N: usize>(half: [f64; H]) -> [f64; N] {
    let mut all = [0.0; N];
    let mut i = 0;
    while i < N {
        all[i] = if i < H { half[i] } else { half[N - 1 - i] };
        i += 1;
    }
    all
}

/// The composition of a symmetric method by a scheme.
///
/// A base method that is not symmetric does not compile, because the schemes would lose their order.
///
/// ```compile_fail
/// use lieflow::methods::{Composition, KAHAN_LI6, Rkmk, tableau::RK4};
/// use lieflow::maps::Exp;
/// let _ = Composition::new(Rkmk::new(RK4, Exp), KAHAN_LI6);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Composition<M> {
    base: M,
    scheme: Scheme,
}

impl<M: Symmetric> Composition<M> {
    /// Makes the method.
    pub const fn new(base: M, scheme: Scheme) -> Self {
        Composition { base, scheme }
    }
}

impl<M: Symmetric> Symmetric for Composition<M> {}

/// The base method's workspace and the state before the step.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct CompositionWork<P: Ambient, M: Method<P>> {
    base: M::Work,
    start: PointOf<P>,
}

impl<P: Ambient, M: Method<P> + Symmetric> Method<P> for Composition<M> {
    type Work = CompositionWork<P, M>;

    fn facts(&self, problem: &P) -> Facts {
        let base = self.base.facts(problem);
        let step = base.step.times(self.scheme.weights.len() as u64);
        let dense_evaluations = [Some(0), step.evaluations];
        let order = base.order.max(self.scheme.order);
        let Facts { stays_on_manifold, short_turns, .. } = base;
        let facts = Facts { stays_on_manifold, short_turns, ..Facts::of_order(order) };
        Facts { step, step_with_error: step, dense_evaluations, ..facts }
    }
    fn iterations(&self, work: &Self::Work) -> u64 {
        self.base.iterations(&work.base)
    }
    fn reused(&self, work: &Self::Work) -> u64 {
        self.base.reused(&work.base)
    }
    fn forget(&self, work: &mut Self::Work) {
        self.base.forget(&mut work.base);
    }
    fn each_memory(&self, work: &mut Self::Work, each: &mut dyn FnMut(&mut f64)) {
        self.base.each_memory(&mut work.base, each);
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        Ok(CompositionWork { base: self.base.work(problem, like)?, start: like.clone() })
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { n, t, h }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        w: &mut Self::Work,
    ) -> Result<(), StepError> {
        let lit = ScalarOf::<P>::lit;
        w.start.assign(y);
        let mut passed = 0.0;
        for &weight in self.scheme.weights {
            let stage = Step { n, t: t + h * lit(passed), h: h * lit(weight) };
            if let Err(error) = self.base.step(problem, stage, y, &mut w.base) {
                y.assign(&w.start);
                return Err(error);
            }
            passed += weight;
        }
        Ok(())
    }
}
