//! Two midpoint rules for fluids, by fixed-point iteration on the increment D.
//!
//! With ε = h/(2ħ), M = W + D, P = εΔ⁻¹M and C = \[P, M\]:
//!
//! | | D | W⁺ | |
//! |---|---|---|---|
//! | isospectral | C + P M P | W + 2C | (𝟙 − P)M(𝟙 + P) = W, W⁺ = (𝟙 + P)M(𝟙 − P) |
//! | energy | C + P D P | W + 2D | W⁺ = cay(2P) W cay(2P)†, M = (W + W⁺)/2 |
//!
//! Order 2, symmetric. Both preserve the spectrum of W, to the tolerance. The first also preserves the Lie–Poisson
//! structure and the invariants that are linear in W (angular momentum on the sphere), so its energy error stays
//! bounded. The second also preserves the energy, because tr(P W⁺) = tr(P W).
//!
//! An iteration has one Poisson solve, and three real products for C (Gauss's three for a complex one; \[P, M\] = PM −
//! (PM)†). While the cubic term still changes, it has three half products more; this term is skew-Hermitian. The first
//! guess comes from the steps before ([`History`]). The iteration converges while h/ħ times the bound of \[P, ·\] is
//! below about 1.
//!
//! Source of the first: K. Modin & M. Viviani, J. Fluid Mech. 884 (2020), with the fixed point of P. Cifani, M. Viviani &
//! K. Modin, J. Comput. Phys. 473 (2023). The second is [`EnergyCasimir`](super::EnergyCasimir) with cay.

mod history;
mod triangle;

use faer::{Accum, Mat};

use super::{Facts, Method, Step, Symmetric};
use crate::dense::{lower_product, mirror, mul, scaled_sum, wide};
use crate::error::{Error, StepError};
use crate::groups::ComplexMatrix;
use crate::problems::{Surface, Zeitlin};
use crate::scalar::{Ops, tally};
use crate::space::{LinearSpace, Metric};
use history::{History, Start};
use triangle::{below, below_mut, entries, norm, replace, sum, with_transpose};

/// One of the two midpoint rules. Both conserve the spectrum; the name is what else is conserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MidpointRule {
    /// The Lie–Poisson structure: Modin and Viviani's isospectral midpoint.
    Isospectral,
    /// The energy.
    Energy,
}

/// A midpoint rule for [`Zeitlin`]'s fluids.
///
/// If a step continues from the last one with the same h, the first guess of its iteration is extrapolated from the
/// increments of the steps before. So the result depends on the steps before, within the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidMidpoint {
    rule: MidpointRule,
    tolerance: f64,
}

/// The residual at which the iteration stops, relative to ‖W‖.
const TOLERANCE: f64 = 0.125 * f64::EPSILON;
/// Below this residual an iteration that no longer contracts has reached rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// The largest number of iterations. It is enough for a contraction by 0.93 to reach rounding.
const ITERATIONS_MAX: u32 = 500;

impl FluidMidpoint {
    /// The isospectral midpoint rule.
    pub const fn isospectral() -> Self {
        FluidMidpoint { rule: MidpointRule::Isospectral, tolerance: TOLERANCE }
    }
    /// The midpoint rule that conserves the energy.
    pub const fn energy() -> Self {
        FluidMidpoint { rule: MidpointRule::Energy, tolerance: TOLERANCE }
    }
    /// Sets the bound of the residual ‖D − D(D)‖/‖W‖. The default is an eighth of the rounding unit.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless it is finite and positive.
    pub fn with_tolerance(self, tolerance: f64) -> Result<Self, Error> {
        Ok(FluidMidpoint { tolerance: Error::positive("tolerance", tolerance)?, ..self })
    }
    /// The rule: one of the two.
    pub const fn rule(&self) -> MidpointRule {
        self.rule
    }
}

impl Symmetric for FluidMidpoint {}

/// An estimate of the contraction of an iteration: the largest observed ratio of a step. It fades from step to step,
/// and grows by at most [`CAUTION`] while it is not measured.
#[derive(Clone, Copy, Debug)]
struct Rate {
    seen: f64,
    of_run: f64,
    of_step: Option<f64>,
}

/// The smallest estimate, because an error may have a new direction.
const LEAST: f64 = 1e-3;
const CAUTION: f64 = 8.0;

impl Rate {
    const fn unknown() -> Self {
        Rate { seen: f64::INFINITY, of_run: f64::INFINITY, of_step: None }
    }
    fn saw(&mut self, ratio: f64) {
        self.of_step = Some(self.of_step.unwrap_or(LEAST).max(ratio));
    }
    fn get(&self) -> f64 {
        match self.of_step {
            Some(now) if self.of_run.is_finite() => now.max(0.5 * self.of_run),
            Some(now) => now,
            None => self.of_run,
        }
    }
    fn end_step(&mut self) {
        match self.of_step.take() {
            Some(now) => {
                self.seen = if self.seen.is_finite() { now.max(0.5 * self.seen) } else { now };
                self.of_run = self.seen;
            }
            None => self.of_run = (1.5 * self.of_run).min(CAUTION * self.seen),
        }
    }
}

/// The workspace of a step, and the steps before.
#[derive(Debug)]
pub struct FluidWork {
    /// D, on and below the diagonal.
    d: ComplexMatrix,
    /// C, on and below the diagonal.
    bracket: ComplexMatrix,
    /// P M P or P D P, on and below the diagonal.
    cubic: ComplexMatrix,
    product: SkewProduct,
    scratch: [Mat<f64>; 2],
    history: History,
    /// The estimates of the iteration and of its cubic term.
    rates: [Rate; 2],
    iterations: u64,
    solves: u64,
}

impl FluidWork {
    /// The iterations of all steps, and those that computed the cubic term, too.
    pub fn iterations(&self) -> [u64; 2] {
        [self.iterations, self.solves]
    }
}

/// P·X for skew-Hermitian P and X by three real products.
#[derive(Debug)]
struct SkewProduct {
    p: ComplexMatrix,
    p_sum: Mat<f64>,
    x: ComplexMatrix,
    x_sum: Mat<f64>,
    /// The real part, the sum of the parts, and the imaginary part of P·X.
    re: Mat<f64>,
    both: Mat<f64>,
    im: Mat<f64>,
}

impl SkewProduct {
    fn new(n: usize) -> Self {
        let (zero, part) = (|| ComplexMatrix::zeros(n, n), || Mat::zeros(n, n));
        let (p, x) = (zero(), zero());
        SkewProduct { p, x, p_sum: part(), x_sum: part(), re: part(), both: part(), im: part() }
    }

    /// p and its sum from the triangle.
    fn p_is_set(&mut self) {
        complete(&mut self.p, &mut self.p_sum);
    }

    /// The product, from the triangle of x.
    fn multiply(&mut self) {
        let SkewProduct { p, p_sum, x, x_sum, re, both, im } = self;
        complete(x, x_sum);
        mul(re, p.re.as_ref(), x.re.as_ref());
        mul(both, p.im.as_ref(), x.im.as_ref());
        mul(im, p_sum.as_ref(), x_sum.as_ref());
        tally(|| Ops::adds(4 * re.nrows() * re.ncols()));
        wide(re.nrows(), || {
            for j in 0..re.ncols() {
                let (re, both) = (re.col_as_slice_mut(j), both.col_as_slice_mut(j));
                for ((re, both), im) in re.iter_mut().zip(both).zip(im.col_as_slice_mut(j)) {
                    let (a, b, c) = (*re, *both, *im);
                    *re = a - b;
                    *im = (c - b) - a;
                    *both = (c - b) - b;
                }
            }
        });
    }

    /// out ← PX − (PX)† on the triangle.
    fn bracket(&self, out: &mut ComplexMatrix) {
        with_transpose(&mut out.re, &self.re, -1.0);
        with_transpose(&mut out.im, &self.im, 1.0);
    }

    /// out ← (PX)P on the triangle; x is overwritten.
    fn sandwich(&mut self, out: &mut ComplexMatrix) {
        let SkewProduct { p, p_sum, x_sum, re, both, im, .. } = self;
        lower_product(&mut out.re, re.as_ref(), p.re.as_ref(), 1.0, Accum::Replace);
        lower_product(x_sum, im.as_ref(), p.im.as_ref(), 1.0, Accum::Replace);
        lower_product(&mut out.im, both.as_ref(), p_sum.as_ref(), 1.0, Accum::Replace);
        tally(|| Ops::adds(3 * entries(out) / 2));
        let [re, im] = out.parts_mut();
        wide(re.nrows(), || {
            for j in 0..re.ncols() {
                let parts = below_mut(re, j).iter_mut().zip(below_mut(im, j));
                for ((re, im), b) in parts.zip(below(x_sum, j)) {
                    *im = (*im - b) - *re;
                    *re -= b;
                }
            }
        });
    }
}

/// Completes x from its triangle, with the sum of its parts. The diagonal is imaginary.
fn complete(x: &mut ComplexMatrix, both: &mut Mat<f64>) {
    (0..x.nrows()).for_each(|i| x.re[(i, i)] = 0.0);
    mirror(&mut x.re, -1.0);
    mirror(&mut x.im, 1.0);
    scaled_sum(both, [1.0, 1.0], [&x.re, &x.im], 0.0);
}

impl<S: Surface> Method<Zeitlin<S>> for FluidMidpoint {
    type Work = FluidWork;

    fn facts(&self, _: &Zeitlin<S>) -> Facts {
        Facts::of_order(2)
    }
    fn work(&self, fluid: &Zeitlin<S>, _: &ComplexMatrix) -> Result<FluidWork, Error> {
        let n = fluid.n();
        let zero = || ComplexMatrix::zeros(n, n);
        Ok(FluidWork {
            d: zero(),
            bracket: zero(),
            cubic: zero(),
            product: SkewProduct::new(n),
            scratch: fluid.surface().scratch(),
            history: History::new(n),
            rates: [Rate::unknown(); 2],
            iterations: 0,
            solves: 0,
        })
    }
    fn iterations(&self, work: &FluidWork) -> u64 {
        work.iterations
    }
    fn each_memory(&self, work: &mut FluidWork, each: &mut dyn FnMut(&mut f64)) {
        work.history.each_number(each);
        for rate in &mut work.rates {
            each(&mut rate.seen);
            each(&mut rate.of_run);
        }
    }
    fn step(
        &self,
        fluid: &Zeitlin<S>,
        Step { h, .. }: Step<f64>,
        w: &mut ComplexMatrix,
        work: &mut FluidWork,
    ) -> Result<(), StepError> {
        let start = work.history.start(h, w);
        let mut rates = [Rate::unknown(); 2];
        match start {
            Start::Warm => {
                work.history.guess(&mut work.d);
                rates = work.rates;
            }
            _ => work.d.clear(),
        }
        self.advance(fluid.surface(), h, w, work, &mut rates)?;
        work.history.record(start, h, &work.d, w);
        if start != Start::Aside {
            rates.iter_mut().for_each(Rate::end_step);
            work.rates = rates;
        }
        Ok(())
    }
    /// A shorter step, which begins with a part of the increment of the last one. The steps after it do not know of it.
    fn interpolate(
        &self,
        fluid: &Zeitlin<S>,
        Step { h, .. }: Step<f64>,
        theta: f64,
        from: &ComplexMatrix,
        work: &mut FluidWork,
        at: &mut ComplexMatrix,
    ) -> Result<(), StepError> {
        at.assign(from);
        work.history.guess_within(h, theta, &mut work.d);
        self.advance(fluid.surface(), theta * h, at, work, &mut [Rate::unknown(); 2])
    }
}

impl FluidMidpoint {
    /// w ← the point after a step of size h, from the guess d.
    fn advance<S: Surface>(
        &self,
        surface: &S,
        h: f64,
        w: &mut ComplexMatrix,
        work: &mut FluidWork,
        rates: &mut [Rate; 2],
    ) -> Result<(), StepError> {
        self.iterate(surface, h, w, work, rates)?;
        let FluidWork { d, bracket, product, .. } = work;
        let increment = match self.rule {
            MidpointRule::Isospectral => &*bracket,
            MidpointRule::Energy => &*d,
        };
        sum(&mut product.x, w, 2.0, increment);
        complete(&mut product.x, &mut product.x_sum);
        if !LinearSpace::is_finite(&product.x) {
            return Err(StepError::NotFinite { what: "the state" });
        }
        core::mem::swap(w, &mut product.x);
        Ok(())
    }

    /// d ← its fixed point.
    fn iterate<S: Surface>(
        &self,
        surface: &S,
        h: f64,
        w: &ComplexMatrix,
        work: &mut FluidWork,
        [rate, cubic_rate]: &mut [Rate; 2],
    ) -> Result<(), StepError> {
        let FluidWork { d, bracket, cubic, product, scratch, iterations, solves, .. } = work;
        let size = norm(w).max(f64::MIN_POSITIVE);
        let noise = ROUNDING * size;
        let (mut last, mut since_cubic) = (f64::INFINITY, f64::INFINITY);
        let (mut due, mut was_due) = (true, true);
        let (mut least, mut idle) = (f64::INFINITY, 0);
        for iteration in 1..=ITERATIONS_MAX {
            *iterations += 1;
            sum(&mut product.x, w, 1.0, d);
            sum(&mut product.p, w, 1.0, d);
            surface.solve(&mut product.p, scratch);
            scale(&mut product.p, 0.5 * h * surface.rate());
            product.p_is_set();
            product.multiply();
            product.bracket(bracket);
            if due {
                *solves += 1;
                if self.rule == MidpointRule::Energy {
                    sum(&mut product.x, d, 0.0, w);
                    product.multiply();
                }
                // What the term was before moves to where it is compared.
                core::mem::swap(cubic, &mut product.x);
                product.sandwich(cubic);
                if since_cubic.is_finite() && since_cubic > noise {
                    cubic_rate.saw(distance(cubic, &product.x) / since_cubic);
                }
                since_cubic = 0.0;
            }
            let change = replace(d, bracket, cubic);
            since_cubic += change;
            let lag = cubic_rate.get() * since_cubic;
            if !change.is_finite() || iteration == ITERATIONS_MAX {
                // Both terms at rounding, where a slow contraction shows no end.
                if change <= noise && lag <= noise {
                    return Ok(());
                }
                return Err(StepError::FixedPointDidNotConverge {
                    method: "fluid midpoint",
                    iterations: iteration,
                    change_log10: (change / size).log10().ceil().min(308.0) as i32,
                });
            }
            // A cubic term that has waited jumps: its change is none of the iteration's.
            let goes_on = was_due || !due;
            if goes_on && last.is_finite() && last > noise {
                rate.saw(change / last);
            }
            // Changes need not fall monotonically: at rounding level is what falls no further.
            if !goes_on {
                (least, idle) = (f64::INFINITY, 0);
            }
            if change < noise && change >= 0.9 * least {
                idle += if change < f64::EPSILON * size { 4 } else { 1 };
            }
            least = least.min(change);
            let stalled = idle >= 8;
            // What is left is a geometric series.
            let left = rate.get() / (1.0 - rate.get()).max(0.1) * change;
            let bound = self.tolerance * size;
            let converged = stalled || left <= bound;
            if converged && (lag <= bound || stalled && (due && goes_on || lag <= noise / 16.0)) {
                return Ok(());
            }
            (due, was_due) = (converged || cubic_rate.get() > 0.1, due);
            last = change;
        }
        Ok(())
    }
}

/// x ← a·x on the triangle.
fn scale(x: &mut ComplexMatrix, a: f64) {
    tally(|| Ops::muls(entries(x)));
    wide(x.nrows(), || {
        for x in x.parts_mut() {
            for j in 0..x.ncols() {
                below_mut(x, j).iter_mut().for_each(|x| *x *= a);
            }
        }
    });
}

/// The norm of x − y on the triangle.
fn distance(x: &ComplexMatrix, y: &ComplexMatrix) -> f64 {
    tally(|| (Ops::adds(1) + Ops::muladds(1)) * entries(x) + Ops::sqrts(1));
    let part = |x: &Mat<f64>, y: &Mat<f64>| {
        let column = |j| below(x, j).iter().zip(below(y, j)).map(|(x, y)| (x - y) * (x - y));
        (0..x.ncols()).flat_map(column).sum::<f64>()
    };
    (part(&x.re, &y.re) + part(&x.im, &y.im)).sqrt()
}
