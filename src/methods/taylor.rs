//! The Lie-series (Taylor) method of order 4 to 16 for the free rigid body.
//!
//! The body frame turns by Ψ(t), Ψ' = Ψ ω̂, Ψ(0) = 𝟙. With Ψ the rotation of the quaternion q, both
//! fields are quadratic and their Taylor coefficients follow by recurrence:
//!
//! (k+1) m_{k+1} = Σ_j m_j × ω_{k−j}, ω_k = J⁻¹m_k, 2(k+1) q_{k+1} = Σ_j q_j ∘ ω_{k−j}.
//!
//! q(h) is cut after the power N and taken to the unit sphere, which changes it by less than the
//! terms left out: Ψ(h) is a rotation, m⁺ = Ψᵀm, g⁺ = gΨ. Order N. Preserves: |m|, gm and the group
//! to rounding. Cost: 3N(N+1)/2 + 6N(N+1) multiplications, one division; no root, no trigonometric
//! function; one step replaces N evaluations of f of other methods of this order.
//!
//! The last two coefficients tell the step: θ = min((tol/|q_{N−1}|)^{1/(N−1)}, (tol/|q_N|)^{1/N}).
//! [`Taylor::advance`] takes the largest step within the tolerance, from coefficients that it needs
//! anyway: no step is ever rejected.
//! Source: W. Gröbner, Die Lie-Reihen und ihre Anwendungen (1960); À. Jorba & M. Zou, Experiment.
//! Math. 14 (2005), for the step.

use nalgebra::{Matrix3, Vector3};

use super::simo_wong::turn_by;
use super::{Method, Step};
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::problems::{FreeBody, PointOf};

/// The Taylor method of order N, 4 ≤ N ≤ 16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Taylor<const N: usize>;

/// The most that one step of [`Taylor::advance`] grows or shrinks against the one before.
const GROWTH: f64 = 4.0;

/// The coefficients q₁ hᵏ, …, q_N hᵏ of the quaternion, scalar part last.
#[derive(Clone, Copy, Debug)]
struct Series<const N: usize>([[f64; 4]; N]);

impl<const N: usize> Series<N> {
    #[inline(always)]
    fn new(inverse_inertia: &Vector3<f64>, m: &Vector3<f64>, h: f64) -> Self {
        let j = inverse_inertia;
        let rate = [h * (j[2] - j[1]), h * (j[0] - j[2]), h * (j[1] - j[0])];
        let half = [0.5 * h * j[0], 0.5 * h * j[1], 0.5 * h * j[2]];
        let mut ms = [[0.0; 3]; N];
        let mut ws = [[0.0; 3]; N]; // hω/2
        // q_j ∘ e_1, q_j ∘ e_2, q_j ∘ e_3.
        let mut turned = [[[0.0; 4]; 3]; N];
        let mut q = [[0.0; 4]; N];
        (ms[0], turned[0]) = ([m[0], m[1], m[2]], products([0.0, 0.0, 0.0, 1.0]));
        for k in 0..N {
            ws[k] = [half[0] * ms[k][0], half[1] * ms[k][1], half[2] * ms[k][2]];
            let inverse = 1.0 / (k + 1) as f64;
            let mut sum = [0.0; 4];
            for i in 0..=k {
                let (w, t) = (&ws[k - i], &turned[i]);
                for l in 0..4 {
                    sum[l] += w[0] * t[0][l] + w[1] * t[1][l] + w[2] * t[2][l];
                }
            }
            q[k] = sum.map(|x| x * inverse);
            if k + 1 < N {
                turned[k + 1] = products(q[k]);
                let mut sum = [0.0; 3];
                for i in 0..=k {
                    let (a, b) = (&ms[i], &ms[k - i]);
                    sum[0] += a[1] * b[2];
                    sum[1] += a[2] * b[0];
                    sum[2] += a[0] * b[1];
                }
                for l in 0..3 {
                    ms[k + 1][l] = sum[l] * rate[l] * inverse;
                }
            }
        }
        Series(q)
    }

    /// Ψ(θh).
    #[inline(always)]
    fn rotation(&self, theta: f64) -> Matrix3<f64> {
        let mut q = [0.0; 4];
        for term in self.0.iter().rev() {
            for l in 0..4 {
                q[l] = (q[l] + term[l]) * theta;
            }
        }
        q[3] += 1.0;
        let [x, y, z, w] = q;
        let s = 2.0 / (x * x + y * y + z * z + w * w);
        let (sx, sy, sz) = (s * x, s * y, s * z);
        let (xx, yy, zz) = (sx * x, sy * y, sz * z);
        let (xy, xz, yz) = (sx * y, sx * z, sy * z);
        let (wx, wy, wz) = (sx * w, sy * w, sz * w);
        Matrix3::new(
            1.0 - yy - zz,
            xy - wz,
            xz + wy,
            xy + wz,
            1.0 - xx - zz,
            yz - wx,
            xz - wy,
            yz + wx,
            1.0 - xx - yy,
        )
    }

    /// The θ at which the last two terms fall to the tolerance; infinite when they vanish.
    fn reach(&self, tolerance: f64) -> f64 {
        let size = |k: usize| self.0[k - 1].iter().map(|x| x * x).sum::<f64>().sqrt();
        let one = |k: usize| (tolerance / size(k)).powf(1.0 / k as f64);
        one(N - 1).min(one(N))
    }
}

/// q ∘ e_1, q ∘ e_2, q ∘ e_3, scalar part last.
#[inline(always)]
fn products([x, y, z, w]: [f64; 4]) -> [[f64; 4]; 3] {
    [[w, z, -y, -x], [-z, w, x, -y], [y, -x, w, -z]]
}

impl<const N: usize> Taylor<N> {
    /// The largest step from y whose local error in the attitude is about `tolerance`, by the last
    /// two terms at the step `h` (any guess of it); infinite for a body at rest.
    pub fn largest_step<P: FreeBody>(
        &self,
        problem: &P,
        y: &PointOf<P>,
        h: f64,
        tolerance: f64,
    ) -> f64
    where
        P::Group: LieAlgebra<Scalar = f64>,
    {
        let (m, _) = problem.load(y);
        h * Series::<N>::new(problem.inverse_inertia(), &m, h).reach(tolerance)
    }

    /// Advance y over the time `span`, each step as long as the tolerance for its local error in the
    /// attitude allows; `h` is a first guess and becomes the last step. Returns the number of steps.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a span or a guess that is not finite, a guess of 0 or a tolerance
    /// that is not positive; [`Error::Map`] with [`StepError::NotFinite`] when the state leaves the
    /// range, [`StepError::NotConverged`] when the step shrinks to nothing or 10⁹ are not enough. y
    /// is then the last good state.
    pub fn advance<P: FreeBody>(
        &self,
        problem: &P,
        span: f64,
        tolerance: f64,
        h: &mut f64,
        y: &mut PointOf<P>,
    ) -> Result<u64, Error>
    where
        P::Group: LieAlgebra<Scalar = f64>,
    {
        check_order::<N>()?;
        let range = |arg, x: f64, ok: bool, expected| match ok {
            true => Ok(()),
            false => Err(Error::out_of_range(arg, x, expected)),
        };
        range("span", span, span.is_finite(), "a finite number")?;
        range("h", *h, h.is_finite() && *h != 0.0, "a finite number other than 0")?;
        range("tolerance", tolerance, tolerance.is_finite() && tolerance > 0.0, "a number > 0")?;
        let inverse = *problem.inverse_inertia();
        let mut guess = h.abs().copysign(span);
        let mut passed = 0.0;
        for steps in 0..STEPS_MAX {
            let left = span - passed;
            if left == 0.0 {
                *h = guess;
                return Ok(steps);
            }
            let (m, mut frame) = problem.load(y);
            let mut series = Series::<N>::new(&inverse, &m, guess);
            let mut theta = series.reach(tolerance);
            // A guess that is far off is made again, nearer: the terms are not to overflow.
            let mut tries = 0;
            while (!(1.0 / GROWTH..).contains(&theta) || theta.is_nan()) && tries < 200 {
                guess *= if theta > 0.0 { theta.max(1e-3) } else { 1e-3 };
                series = Series::<N>::new(&inverse, &m, guess);
                theta = series.reach(tolerance);
                tries += 1;
            }
            let step = guess * theta.min(GROWTH);
            if step == 0.0 || step.is_nan() {
                return Err(StepError::NotConverged { what: "the choice of the step" }.into());
            }
            let last = step.abs() >= left.abs();
            let theta = if last { left / guess } else { step / guess };
            turn_by(problem, &series.rotation(theta), m, &mut frame, y)?;
            passed = if last { span } else { passed + step };
            guess = step;
        }
        Err(StepError::NotConverged { what: "the span in 1e9 steps" }.into())
    }
}

/// More steps than this count as a mistake in the input.
const STEPS_MAX: u64 = 1_000_000_000;

fn check_order<const N: usize>() -> Result<(), Error> {
    match (4..=16).contains(&N) {
        true => Ok(()),
        false => Err(Error::out_of_range("order", N as f64, "4 ≤ order ≤ 16")),
    }
}

impl<P: FreeBody, const N: usize> Method<P> for Taylor<N>
where
    P::Group: LieAlgebra<Scalar = f64>,
{
    type Work = ();

    fn order(&self, _: &P) -> usize {
        N
    }
    /// [`Error::OutOfRange`] unless 4 ≤ N ≤ 16.
    fn work(&self, _: &P, _: &PointOf<P>) -> Result<(), Error> {
        check_order::<N>()
    }
    #[inline]
    fn step(
        &self,
        problem: &P,
        Step { h, .. }: Step<f64>,
        y: &mut PointOf<P>,
        (): &mut (),
    ) -> Result<(), StepError> {
        let (m, mut frame) = problem.load(y);
        let turn = Series::<N>::new(problem.inverse_inertia(), &m, h).rotation(1.0);
        turn_by(problem, &turn, m, &mut frame, y)
    }
}
