//! Commutator-free Magnus methods: y⁺ = exp(h Σ_j r_fj A_j) ⋯ exp(h Σ_j r_1j A_j) y.
//!
//! Above order 4 some sums of r_f are negative. This cannot be avoided with real coefficients (Hofstätter, Koch 2017).
//! Source: S. Blanes, P. C. Moan, Appl. Numer. Math. 56 (2006); A. Alvermann, H. Fehske, High-order commutator-free
//! exponential time-propagation of driven quantum systems, J. Comput. Phys. 230 (2011).

use super::{GAUSS_2, GAUSS_3, GAUSS_4, MagnusWork, ROOT_3, ROOT_15, V, W};
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::{CoordinateMap, Exp};
use crate::methods::{Facts, MapCounts, Method, Step, Symmetric};
use crate::problems::{LinearField, PointOf, ScalarOf};

/// The coefficients of a commutator-free Magnus method: S nodes, F factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CfMagnusTableau<const S: usize, const F: usize> {
    /// The name of the method.
    pub name: &'static str,
    /// The order of the method.
    pub order: usize,
    /// The nodes of A.
    pub nodes: [f64; S],
    /// The weights of A in each factor; the first is applied first.
    pub factors: [[f64; S]; F],
}

/// Order 4 with two exponentials.
pub const CFM4_2: CfMagnusTableau<2, 2> = CfMagnusTableau {
    name: "cfm4-2",
    order: 4,
    nodes: GAUSS_2,
    factors: mirrored([[0.25 + ROOT_3 / 6.0, 0.25 - ROOT_3 / 6.0]]),
};

/// Order 4 with three exponentials and a smaller error.
pub const CFM4_3: CfMagnusTableau<3, 3> = {
    const D: f64 = 10.0 * ROOT_15 / 261.0;
    const M: f64 = 37.0 / 240.0;
    CfMagnusTableau {
        name: "cfm4-3",
        order: 4,
        nodes: GAUSS_3,
        factors: mirrored([
            [M + D, -1.0 / 30.0, M - D],
            [-11.0 / 360.0, 23.0 / 45.0, -11.0 / 360.0],
        ]),
    }
};

/// Order 6 with five exponentials.
pub const CFM6_5: CfMagnusTableau<3, 5> = CfMagnusTableau {
    name: "cfm6-5",
    order: 6,
    nodes: GAUSS_3,
    factors: mirrored([
        [0.2372404318862121, -0.04895973005926203, 0.01171929817304994],
        [0.08846415180365895, 0.30920364839883846, -0.04951287461452351],
        [-0.01013322947061972, -0.07604339223470825, -0.01013322947061972],
    ]),
};

/// Order 8 with eleven exponentials.
pub const CFM8_11: CfMagnusTableau<4, 11> = CfMagnusTableau {
    name: "cfm8-11",
    order: 8,
    nodes: GAUSS_4,
    factors: mirrored([
        by_moments([
            0.169715531043933180,
            -0.152866146944615910,
            0.119167378745981370,
            -0.068619226448029559,
        ]),
        by_moments([
            0.379420807516005432,
            -0.148839980923180991,
            -0.115880829186628075,
            0.188555246668412628,
        ]),
        by_moments([
            0.469459306644050573,
            0.379844237839363505,
            0.022898814729462899,
            -0.571855043580130805,
        ]),
        by_moments([
            -0.448225927391070886,
            -0.362889857410989943,
            -0.022565582830528472,
            0.544507517141613384,
        ]),
        by_moments([
            -0.293924473106317605,
            0.026255628265819381,
            0.096761509131620390,
            -0.000018330145571672,
        ]),
        by_moments([0.447109510586798614, 0.0, -0.200762581179816222, 0.0]),
    ]),
};

/// Completes the factors: the first half is given, and the second half is its mirror image, so the method is symmetric
/// in time.
const fn mirrored<const S: usize, const HALF: usize, const F: usize>(
    first: [[f64; S]; HALF],
) -> [[f64; S]; F] {
    let mut all = [[0.0; S]; F];
    let mut i = 0;
    while i < HALF {
        let mut j = 0;
        while j < S {
            all[i][j] = first[i][j];
            all[F - 1 - i][S - 1 - j] = first[i][j];
            j += 1;
        }
        i += 1;
    }
    all
}

/// The weights of A at the four Gauss nodes from those of its Legendre moments
/// A_k = (2k + 1) Σ_m w_m P_k(x_m) A_m.
const fn by_moments(f: [f64; 4]) -> [f64; 4] {
    let mut out = [0.0; 4];
    let mut m = 0;
    while m < 4 {
        // x on [−1, 1], and the weight, of sum 1.
        let (v, w) = if m == 0 || m == 3 { (V[0], W[0]) } else { (V[1], W[1]) };
        let x = if m < 2 { -2.0 * v } else { 2.0 * v };
        let p = [1.0, x, (3.0 * x * x - 1.0) / 2.0, (5.0 * x * x - 3.0) * x / 2.0];
        let mut k = 0;
        while k < 4 {
            out[m] += f[k] * (2.0 * k as f64 + 1.0) * w * p[k];
            k += 1;
        }
        m += 1;
    }
    out
}

/// A commutator-free Magnus method, with a table of S. Blanes and P. C. Moan (2006) or of A. Alvermann and H. Fehske
/// (2011).
#[derive(Clone, Copy, Debug)]
pub struct CfMagnus<const S: usize, const F: usize>(pub CfMagnusTableau<S, F>);

impl<const S: usize, const F: usize> Symmetric for CfMagnus<S, F> {}

impl<P: LinearField, const S: usize, const F: usize> Method<P> for CfMagnus<S, F>
where
    Exp: CoordinateMap<P::Group>,
{
    type Work = (MagnusWork<P, Exp, S, 1>, PointOf<P>);

    fn facts(&self, _: &P) -> Facts {
        let maps = MapCounts { psi: F as u64, ..MapCounts::default() };
        Facts::of_order(self.0.order).cost(Some(S as u64), maps).stages_within()
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        Ok((MagnusWork::new(problem, &Exp, like)?, like.clone()))
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        (work, next): &mut Self::Work,
    ) -> Result<(), StepError> {
        work.sample(problem, &self.0.nodes, step, y)?;
        for (i, weights) in self.0.factors.iter().enumerate() {
            let MagnusWork { a, scratch: [u], y: aside, chart, .. } = work;
            problem.group().combine(step.h, weights, a, u);
            let from = match i {
                0 => &*y,
                _ => {
                    core::mem::swap(aside, next);
                    &*aside
                }
            };
            chart.around(problem, &Exp, step.n, from).lambda(u, next)?;
        }
        core::mem::swap(y, next);
        Ok(())
    }
}
