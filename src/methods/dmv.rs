//! The preprocessed discrete Moser–Veselov method for the free rigid body, of order 2, 4, 6, 8, 10.
//!
//! One step solves for c ∈ ℝ³ (cyclic i, j, k)
//!
//! c_i = (1 + |c|²) a_i + ((Ĩ_j − Ĩ_k)/Ĩ_i) c_j c_k, a_i = h m_i/(2Ĩ_i),
//!
//! by Newton's iteration. Then it rotates the body by the quaternion (1, c), which is cay(2c):
//! g⁺ = g cay(2c), m⁺ = cay(−2c) m. The true inertia (1/Ĩ = 1/J) gives order 2, the
//! modified one, 1/Ĩ_i = σ/J_i + δ, a higher order. σ and δ are polynomials in η = ½h² Σ m_i²/J_i and κ = ½h²|m|². η
//! and κ are constant along the motion. The coefficients depend on J and are computed once.
//!
//! Preserves: energy, |m|, gm and the group to rounding at every order, the Poisson structure of m (order 2 also the
//! symplectic structure of T*SO(3)), time symmetry. It is the exact motion with a changed time. Newton's iteration converges for h|m|/min J < 1. From there on it may fail for some
//! m with [`StepError::NewtonDidNotConverge`]. Cost: 3 to 6 Newton iterations of one 3×3 solve each, one cay, and at
//! most 30 multiplications for σ and δ; no trigonometric function.
//! Source: J. Moser & A. P. Veselov, Comm. Math. Phys. 139 (1991); R. McLachlan & A. Zanna, Found.
//! Comput. Math. 5 (2005); E. Hairer & G. Vilmart, J. Phys. A 39 (2006).

use nalgebra::Vector3;

use super::newton::newton3;
use super::simo_wong::turn_body;
use super::{Facts, MapCounts, Method, Step, Symmetric};
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, LieGroup, So3};
use crate::maps::Cay;
use crate::problems::{FreeBody, PointOf, ScalarOf};
use crate::scalar::{Real, power_of_two};

/// The preprocessed discrete Moser–Veselov method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dmv {
    order: usize,
}

/// The method without preprocessing, order 2.
pub const DMV2: Dmv = Dmv { order: 2 };
/// Order 4.
pub const DMV4: Dmv = Dmv { order: 4 };
/// Order 6.
pub const DMV6: Dmv = Dmv { order: 6 };
/// Order 8.
pub const DMV8: Dmv = Dmv { order: 8 };
/// Order 10.
pub const DMV10: Dmv = Dmv { order: 10 };

impl Symmetric for Dmv {}

impl Dmv {
    /// The order.
    pub const fn order(self) -> usize {
        self.order
    }
}

/// The coefficients of σ and δ in κᵃηᵇ, degree by degree: degree d has a = d, …, 0. Also the iterations so far.
#[derive(Clone, Copy, Debug)]
pub struct DmvWork {
    inertia: [f64; 3],
    sigma: [[f64; 5]; 4],
    delta: [[f64; 5]; 4],
    /// The power of two that the inertia is divided by, so that no product of many moments leaves the range of numbers.
    unit: f64,
    iterations: u64,
}

impl DmvWork {
    #[rustfmt::skip]
    fn new(inverse_inertia: Vector3<f64>) -> Self {
        let i = [0, 1, 2].map(|k| 1.0 / inverse_inertia[k]);
        let unit = power_of_two(i[0].max(i[1]).max(i[2]));
        let i = i.map(|i| i / unit);
        let d = i[0] * i[1] * i[2];
        let s = |k: i32| i.iter().map(|i| i.powi(k)).sum::<f64>();
        let x = |k: i32| i.iter().map(|i| i.powi(-k)).sum::<f64>();
        // M_ab = Σ over pairs of (I_i^a + I_j^a)/I_k^b.
        let m = |a: i32, b: i32| {
            (0..3).map(|k| (i[(k + 1) % 3].powi(a) + i[(k + 2) % 3].powi(a)) / i[k].powi(b)).sum::<f64>()
        };
        let (s1, s2, s3, s4) = (s(1), s(2), s(3), s(4));
        let (x1, x2, x3, x4) = (x(1), x(2), x(3), x(4));
        let (m11, m21, m12, m22, m31, m13) = (m(1, 1), m(2, 1), m(1, 2), m(2, 2), m(3, 1), m(1, 3));
        let (d2, d3, d4) = (d * d, d * d * d, d * d * d * d);
        let sigma = [
            [s1 / (6.0 * d), -x1 / 3.0, 0.0, 0.0, 0.0],
            [
                (s2 / d - x1) / (30.0 * d),
                (1.0 - m11) / (30.0 * d),
                (3.0 * s1 / d + 2.0 * x2) / 60.0,
                0.0, 0.0,
            ],
            [
                (4.0 * d + 17.0 * s3 - 15.0 * d * m11) / (2520.0 * d3),
                (9.0 * s1 + 10.0 * d * x2 - 6.0 * m21) / (420.0 * d2),
                ((6.0 * m12 - 100.0 * x1) * d + 53.0 * s2) / (2520.0 * d2),
                (15.0 - d * x3 - 2.0 * m11) / (630.0 * d),
                0.0,
            ],
            [
                (62.0 * s4 - 94.0 * d * m21 + 66.0 * d2 * x2 + 81.0 * d * s1) / (45360.0 * d4),
                (-77.0 * m31 + 75.0 * d * m12 + 214.0 * s2 - 240.0 * d * x1) / (22680.0 * d3),
                (26.0 * d * m22 + 55.0 * s3 + 204.0 * d - 50.0 * d2 * x3 - 59.0 * d * m11) / (7560.0 * d3),
                (137.0 * d * x2 - d * m13 + 3.0 * s1 - 69.0 * m21) / (11340.0 * d2),
                (2.0 * d2 * x4 + 5.0 * d * m12 - 171.0 * d * x1 + 159.0 * s2) / (45360.0 * d2),
            ],
        ];
        let delta = [
            [-1.0 / (3.0 * d), s1 / (6.0 * d), 0.0, 0.0, 0.0],
            [
                -s1 / (60.0 * d2),
                x1 / (10.0 * d) - s2 / (60.0 * d2),
                -(9.0 + m11) / (60.0 * d),
                0.0, 0.0,
            ],
            [
                (34.0 * d * x1 - 19.0 * s2) / (2520.0 * d3),
                (s3 + 2.0 * d * m11 - 85.0 * d) / (1260.0 * d3),
                (47.0 * s1 + 13.0 * m21 - 38.0 * d * x2) / (2520.0 * d2),
                (9.0 * d * x1 + d * m12 - 11.0 * s2) / (1260.0 * d2),
                0.0,
            ],
            [
                (60.0 * d * m11 - 61.0 * s3 - 247.0 * d) / (45360.0 * d4),
                (54.0 * d * s1 - s4 + 218.0 * d * m21 - 426.0 * d2 * x2) / (45360.0 * d4),
                (125.0 * d * x1 - 5.0 * m31 - 130.0 * s2 + 4.0 * d * m12) / (7560.0 * d3),
                (67.0 * s3 - 735.0 * d - 15.0 * d * m22 + 87.0 * d * m11 + 34.0 * d2 * x3) / (22680.0 * d3),
                (165.0 * s1 - d * m13 - 9.0 * m21 - 145.0 * d * x2) / (45360.0 * d2),
            ],
        ];
        DmvWork { inertia: i, sigma, delta, unit, iterations: 0 }
    }

    /// Σ over the degrees below order/2 of c_ab κᵃηᵇ.
    #[inline(always)]
    fn series<S: Real>(order: usize, table: &[[f64; 5]; 4], kappa: S, eta: S) -> S {
        let mut powers = [S::lit(1.0); 5]; // of κ
        for k in 1..order / 2 {
            powers[k] = powers[k - 1] * kappa;
        }
        let mut sum = S::lit(0.0);
        for degree in 1..order / 2 {
            // Horner's rule in η.
            let term = |b: usize| S::lit(table[degree - 1][b]) * powers[degree - b];
            sum += (0..degree).rev().fold(term(degree), |s, b| s * eta + term(b));
        }
        sum
    }
}

impl Dmv {
    /// c of the step from m.
    #[inline(always)]
    fn solve<S: Real>(
        &self,
        w: &mut DmvWork,
        inverse: &Vector3<S>,
        h: S,
        m: &Vector3<S>,
    ) -> Result<Vector3<S>, StepError> {
        let l = S::lit;
        // h² and m² may leave the range where hm does not. Momenta and moments are divided by the same unit.
        let half = l(0.5);
        let (h, unit) = (h * l(1.0 / w.unit), l(w.unit));
        let turn = m.map(|m| h * m);
        let inverse = inverse.map(|x| x * unit);
        let squares = [turn[0] * turn[0], turn[1] * turn[1], turn[2] * turn[2]];
        let kappa = half * (squares[0] + squares[1] + squares[2]);
        let eta =
            half * (squares[0] * inverse[0] + squares[1] * inverse[1] + squares[2] * inverse[2]);
        let sigma = l(1.0) + DmvWork::series(self.order, &w.sigma, kappa, eta);
        let delta = DmvWork::series(self.order, &w.delta, kappa, eta);
        let modified = [0, 1, 2].map(|i| sigma * inverse[i] + delta); // 1/Ĩ
        let a = |i: usize| half * turn[i] * modified[i];
        let a = Vector3::new(a(0), a(1), a(2));
        // (Ĩ_j − Ĩ_k)/Ĩ_i; for the true inertia without the rounding of 1/(1/I).
        let i = match self.order {
            2 => w.inertia.map(l),
            _ => modified.map(|x| l(1.0) / x),
        };
        let d =
            [(i[1] - i[2]) * modified[0], (i[2] - i[0]) * modified[1], (i[0] - i[1]) * modified[2]];
        newton3("dmv", a, l(1.0) + So3::new().norm(&a), &mut w.iterations, |c| {
            let grown = l(1.0) + (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
            let mut residual = *c;
            let mut jacobian = So3::new().identity();
            for i in 0..3 {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                residual[i] = c[i] - grown * a[i] - d[i] * c[j] * c[k];
                for n in 0..3 {
                    jacobian[(i, n)] -= l(2.0) * a[i] * c[n];
                }
                jacobian[(i, j)] -= d[i] * c[k];
                jacobian[(i, k)] -= d[i] * c[j];
            }
            (residual, jacobian)
        })
    }
}

impl<P: FreeBody> Method<P> for Dmv
where
    ScalarOf<P>: Into<f64>,
{
    type Work = DmvWork;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(self.order).cost(None, MapCounts { psi: 1, ..MapCounts::default() })
    }
    fn iterations(&self, work: &DmvWork) -> u64 {
        work.iterations
    }
    fn work(&self, problem: &P, _: &PointOf<P>) -> Result<DmvWork, Error> {
        Ok(DmvWork::new(problem.inverse_inertia().map(Into::into)))
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<ScalarOf<P>>,
        y: &mut PointOf<P>,
        w: &mut DmvWork,
    ) -> Result<(), StepError> {
        let (m, frame) = problem.load(y);
        let c = self.solve(w, problem.inverse_inertia(), h, &m)?;
        let u = c.map(|x| ScalarOf::<P>::lit(2.0) * x);
        turn_body(problem, &Cay, &mut (), &u, m, frame, y)
    }
}
