//! The exact motion of the free rigid body, by Jacobi's elliptic functions.
//!
//! Name the principal axes x, y, z so that y is the middle one and the momentum circles z. With
//! d_i = Σ_j m_j²(J_j − J_i)/J_j, in which no large terms cancel, and τ = λt + τ₀
//!
//! m_x = A cn τ, m_y = ±B sn τ, m_z = ±C dn τ,
//! A² = J_x d_z/(J_x − J_z), B² = J_y d_z/(J_y − J_z), C² = J_z d_x/(J_z − J_x),
//! λ² = (J_z − J_y) d_x/(J_x J_y J_z), 1 − k² = (J_z − J_x) d_y/((J_z − J_y) d_x).
//!
//! The attitude is g = S₀ R_z(φ) T(m)ᵀ with the triad T(m) of m and the axis z, and
//! φ̇ = L(m_x²/J_x + m_y²/J_y)/(m_x² + m_y²): a positive combination of L/J_x and L/J_y. It is
//! integrated as (L/J_y)·t and an elliptic integral of the third kind that weighs m_x. That weight is at most cn²τ, because
//! n = B²/A² ≥ 1, and half of the time on average. So no more than a bit cancels at any ratio of the inertias (the textbook
//! forms start from L/J_z or 2E/L and lose as many digits as that ratio has). And where J_z is nearly J_y, so that the
//! integral is divided by a small λ, the weight is small in the same proportion. Of the modulus only k' = √(1 − k²) is used,
//! because near the separatrix k loses all its digits. Where k' < 1e-20, the limits of the integrals as k' → 0 take their place:
//! then squares of k' and of cn may underflow.
//!
//! These formulas set up an orbit, and evaluate it near the separatrix (1 − k² < 0.013) and for large n. Elsewhere sn, cn, dn
//! and the periodic part of φ come from [`Theta`], which is five times as fast.
//!
//! Source: notes on E. T. Whittaker, Analytical Dynamics, § 69; B. C. Carlson's integrals.

use nalgebra::{Matrix3, Vector3};

use super::check_inertia;
use super::theta::Theta;
use crate::elliptic::{Ladder, rc, rf, rj};
use crate::error::{Error, StepError};
use crate::groups::So3;
use crate::maps::{CoordinateMap, Exp};
use crate::scalar::{ROUND, Trig, power_of_two};
use crate::so3::{cross, dexp_matrix};

/// The exact motion of a free rigid body: m(t) and g(t) at any time t, without steps.
///
/// The error in f64 is at most a few times the change by one ulp of the input, plus 3e-14 in g (references of 36 digits
/// in `tests/references`).
///
/// ```
/// use lieflow::problems::Exact;
/// use lieflow::nalgebra::Matrix3;
/// let body = Exact::new([1.0, 2.0, 3.0], [0.2, 0.0, 3.0], Matrix3::identity())?;
/// let (m, g) = body.state(400.0)?;
/// assert!((m.norm() - 9.04f64.sqrt()).abs() < 1e-14);
/// assert!((g * m - body.momentum_space()).norm() < 1e-13);
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Exact {
    inertia: [f64; 3],
    m0: Vector3<f64>,
    g0: Matrix3<f64>,
    motion: Orbit,
}

#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // in a box, every step of the exact method would allocate
enum Orbit {
    /// A rotation about a fixed axis: m is constant.
    Steady,
    /// The general case.
    Elliptic(Elliptic),
}

#[derive(Clone, Debug)]
struct Elliptic {
    /// The axes x, y, z.
    axes: [usize; 3],
    /// Amplitudes with signs, in units of `scale`.
    amplitude: [f64; 3],
    /// The power of two that m was divided by, and that time is multiplied by.
    m_scale: f64,
    t_scale: f64,
    /// The moments of inertia and |m| in these units.
    inertia: Vector3<f64>,
    length: f64,
    lambda: f64,
    tau0: f64,
    /// k' = √(1 − k²).
    kc: f64,
    ladder: Ladder,
    /// K, infinite on the separatrix.
    quarter: f64,
    /// n = B²/A² ≥ 1.
    ratio: f64,
    /// φ = base·t + swing·(D(τ) − D(τ₀)), D = ∫ m_x²/(m_x² + m_y²) dτ.
    base: f64,
    swing: f64,
    d_quarter: f64,
    d0: f64,
    /// S₀ = g₀ T(m₀).
    s0: Matrix3<f64>,
    /// Away from the separatrix.
    fast: Option<Fast>,
}

/// φ = rate·t + p(τ) − p(τ₀).
#[derive(Clone, Debug)]
struct Fast {
    theta: Theta,
    /// In two parts, the first with half the digits.
    rate: [f64; 2],
    /// S₀ turned back by p(τ₀).
    s0: Matrix3<f64>,
    /// 2K in two parts as well, and 1/2K.
    period: [f64; 2],
    inverse: f64,
}

/// Below this k' the integrals are their limits as k' → 0. The limits are exact to the square of this.
const NEAR_SEPARATRIX: f64 = 1e-20;

/// Below this angle the square of a turn is rounding.
const SMALL_TURN: f64 = 1e-8;

impl Exact {
    /// Makes a motion from the principal moments of inertia, the body momentum and the attitude at t = 0.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a moment that is not finite and positive or a momentum that is not
    /// finite; [`So3::check_element`]'s errors for an attitude that is not a rotation within 1e-6.
    pub fn new(
        inertia: [f64; 3],
        momentum_body: [f64; 3],
        attitude: Matrix3<f64>,
    ) -> Result<Self, Error> {
        check_inertia(&inertia)?;
        Error::all_finite("momentum_body", &momentum_body)?;
        So3::new().check_element("attitude", &attitude, 1e-6)?;
        let m0 = Vector3::from(momentum_body);
        let motion = match Elliptic::new(inertia, m0, &attitude)? {
            Some(elliptic) => Orbit::Elliptic(elliptic),
            None => Orbit::Steady,
        };
        Ok(Exact { inertia, m0, g0: attitude, motion })
    }

    /// m_s = g₀m₀, constant.
    pub fn momentum_space(&self) -> Vector3<f64> {
        self.g0 * self.m0
    }

    /// The body momentum m(t).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is not finite; [`Error::Map`] where a number leaves the range of `f64`.
    pub fn momentum_body(&self, t: f64) -> Result<Vector3<f64>, Error> {
        Error::finite("t", t)?;
        match &self.motion {
            Orbit::Elliptic(motion) if t != 0.0 => finite(motion.momentum(t)),
            _ => Ok(self.m0),
        }
    }

    /// The body momentum m(t), and the attitude g(t) from body to space.
    ///
    /// # Errors
    /// As [`momentum_body`](Self::momentum_body).
    pub fn state(&self, t: f64) -> Result<(Vector3<f64>, Matrix3<f64>), Error> {
        Error::finite("t", t)?;
        if t == 0.0 {
            return Ok((self.m0, self.g0));
        }
        match &self.motion {
            Orbit::Elliptic(motion) => {
                let (m, g) = motion.state(t)?;
                Ok((finite(m)?, g))
            }
            Orbit::Steady => Ok((self.m0, self.g0 * Exp.eval(&So3::new(), &self.angle(t))?)),
        }
    }

    /// ωt of a rotation about a fixed axis.
    fn angle(&self, t: f64) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.m0[i] / self.inertia[i] * t)
    }

    /// The place at a time as the formulas give it. At t = 0 it differs from the start by their rounding. `None` for a rotation
    /// about a fixed axis.
    #[inline]
    pub(crate) fn place(&self, t: f64) -> Result<Option<Place>, Error> {
        match &self.motion {
            Orbit::Elliptic(motion) => motion.place(t * motion.t_scale).map(Some),
            Orbit::Steady => Ok(None),
        }
    }

    /// The change of m over the time t, and D with the rotation 𝟙 + D over it, g(t) = g₀(𝟙 + D). `origin` is the place at
    /// t = 0.
    ///
    /// Both are differences of two results of the same formulas, and their rounding is relative to them. What the formulas round
    /// in the same way at each place of the orbit cancels from step to step. Steps of one size thus do not drift.
    #[inline]
    pub(crate) fn change(
        &self,
        origin: Option<&Place>,
        t: f64,
    ) -> Result<(Vector3<f64>, Matrix3<f64>), Error> {
        match (&self.motion, origin) {
            (Orbit::Elliptic(motion), Some(origin)) => motion.change(origin, t * motion.t_scale),
            _ => {
                let angle = self.angle(t);
                Ok((Vector3::zeros(), angle.cross_matrix() * dexp_matrix(&angle)?))
            }
        }
    }
}

/// m, if its numbers are finite.
fn finite(m: Vector3<f64>) -> Result<Vector3<f64>, Error> {
    match m.iter().all(|x| x.is_finite()) {
        true => Ok(m),
        false => Err(StepError::NotFinite { what: "the exact motion" }.into()),
    }
}

/// x without the lower half of its digits: the product of two such numbers is exact.
#[inline]
fn half_the_digits(x: f64) -> f64 {
    f64::from_bits(x.to_bits() >> 27 << 27)
}

impl Fast {
    /// sin and cos of rate·t.
    #[inline]
    fn turn(&self, t: f64) -> (f64, f64) {
        let head = half_the_digits(t);
        let (first, second) = (self.rate[0] * head, self.rate[0] * (t - head) + self.rate[1] * t);
        let phi = first + second;
        let lost = (first - phi) + second;
        let (s, c) = Trig::sin_cos(phi);
        // At a large t more is lost than a small angle; the result is a rotation all the same.
        let (ds, dc) = if lost.abs() < 1e-8 { (lost, 1.0) } else { Trig::sin_cos(lost) };
        (s * dc + c * ds, c * dc - s * ds)
    }
    /// (sin v, cos v) at τ = 2Kj + r with |r| ≤ K, and the sign of sn and cn.
    #[inline]
    fn angle(&self, tau: f64) -> ((f64, f64), f64) {
        // The last bit of a whole number is then the last one.
        let shifted = tau * self.inverse + ROUND;
        let half_turns = shifted - ROUND;
        let r = (tau - half_turns * self.period[0]) - half_turns * self.period[1];
        (self.theta.angle(r), if shifted.to_bits() & 1 == 0 { 1.0 } else { -1.0 })
    }
}

/// The place on the elliptic orbit at a time: τ = 2Kj + r with |r| ≤ K, and sn, cn, dn at r.
struct Phase {
    half_turns: f64,
    sn: f64,
    cn: f64,
    dn: f64,
}

/// A place of the motion: g = S₀ R_z(turn + rest) Tᵀ.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    m: Vector3<f64>,
    /// T(m).
    triad: Matrix3<f64>,
    /// (sin, cos) of the part of φ that grows with t.
    turn: (f64, f64),
    /// (sin, cos) of the rest of φ, which depends on the place of m alone.
    rest: (f64, f64),
}

/// (sin, cos) of the sum of two angles.
#[inline]
fn sum((s, c): (f64, f64), (other_s, other_c): (f64, f64)) -> (f64, f64) {
    (s * other_c + c * other_s, c * other_c - s * other_s)
}

/// R_z(φ) from (sin φ, cos φ).
fn about_z((s, c): (f64, f64)) -> Matrix3<f64> {
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

/// \[x̂, ŷ, ẑ\] as columns: ẑ = m/|m|, x̂ the direction of e_axis orthogonal to it.
fn triad(m: &Vector3<f64>, axis: usize) -> Matrix3<f64> {
    let m = m * (1.0 / power_of_two(m.amax()));
    let z = m * (1.0 / m.norm());
    let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
    // ŷ = ẑ × x̂ lies in the plane orthogonal to the axis; relative accuracy even for a tiny part of
    // m there.
    let scale = 1.0 / power_of_two(m[p].abs().max(m[q].abs()));
    let (a, b) = (m[p] * scale, m[q] * scale);
    let inverse = 1.0 / (a * a + b * b).sqrt();
    let mut y = Vector3::zeros();
    (y[p], y[q]) = (b * inverse, -a * inverse);
    let x = cross(&y, &z);
    Matrix3::from_columns(&[x, y, z])
}

impl Elliptic {
    /// `None` when m does not change.
    fn new(inertia: [f64; 3], m0: Vector3<f64>, g0: &Matrix3<f64>) -> Result<Option<Self>, Error> {
        if m0.amax() == 0.0 {
            return Ok(None);
        }
        let m_scale = power_of_two(m0.amax());
        let j_scale = power_of_two(inertia.into_iter().fold(0.0, f64::max));
        let m = m0 / m_scale;
        let j = inertia.map(|x| x / j_scale);

        let mut sorted = [0, 1, 2];
        sorted.sort_by(|&a, &b| j[a].total_cmp(&j[b]));
        let [a, b, c] = sorted;
        // d_b = s²·(…)/s² with s the size of the two components, whose squares may underflow.
        let size = m[a].abs().max(m[c].abs());
        let s = if size > 0.0 { 1.0 / power_of_two(size) } else { 1.0 };
        let part = |k: usize| (m[k] * s) * (m[k] * s) * ((j[k] - j[b]) / j[k]);
        let d = part(a) + part(c);
        let about_c = j[a] == j[b] || (d > 0.0 && j[b] != j[c]);
        let axes @ [x, y, z] = if about_c { [a, b, c] } else { [c, b, a] };

        // Sums of squares of one sign each: nothing cancels, nothing underflows.
        let ratio = (j[y] * (j[x] - j[z]) / (j[x] * (j[y] - j[z]))).max(1.0);
        let amplitude_x = m[x].hypot(m[y] / ratio.sqrt());
        let amplitude_y = (m[x] * ratio.sqrt()).hypot(m[y]);
        let tilt = j[z] * (j[y] - j[x]) / (j[y] * (j[z] - j[x]));
        let amplitude_z = m[z].hypot(m[y] * tilt.sqrt());
        let lambda = amplitude_z / j[z] * (((j[z] - j[y]) / j[x]) * ((j[z] - j[x]) / j[y])).sqrt();
        if !(lambda > 0.0 && amplitude_x > 0.0) {
            return Ok(None);
        }
        // 1 − k² = d_y J_z/(C²(J_z − J_y)).
        let kc = (d.abs() * (j[z] / (j[z] - j[y]).abs())).sqrt() / s / amplitude_z;
        let kc = kc.min(1.0);
        let sign_z = 1.0f64.copysign(m[z]);
        // ṁ_y = m_p m_q (1/J_q − 1/J_p) for y, p, q cyclic.
        let (p, q) = ((y + 1) % 3, (y + 2) % 3);
        let sign_y = sign_z * (j[p] - j[q]).signum();
        let mut amplitude = [amplitude_x, sign_y * amplitude_y, sign_z * amplitude_z];

        let (cn, sn) = (m[x] / amplitude[0], m[y] / amplitude[1]);
        let r = cn.hypot(sn);
        let (cn, sn) = (cn / r, sn / r);
        if kc == 0.0 && cn == 0.0 {
            return Ok(None); // on the middle axis exactly
        }
        let quarter = first_kind(kc, (1.0, 0.0))?;
        let tau0 = if kc == 0.0 {
            // cn = sech τ > 0 on the separatrix; cn < 0 is the orbit turned by π about z.
            amplitude[0] *= cn.signum();
            amplitude[1] *= cn.signum();
            (sn / cn).asinh()
        } else {
            let f = first_kind(kc, (sn, cn.abs()))?;
            if cn >= 0.0 { f } else { 2.0 * quarter.copysign(sn) - f }
        };

        let length = m.norm();
        let mut motion = Elliptic {
            axes,
            amplitude,
            m_scale,
            t_scale: m_scale / j_scale,
            inertia: j.into(),
            length,
            lambda,
            tau0,
            kc,
            ladder: Ladder::new(kc),
            quarter,
            ratio,
            base: length / j[y],
            swing: length * ((j[y] - j[x]) / (j[y] * j[x])) / lambda,
            d_quarter: 0.0,
            d0: 0.0,
            s0: g0 * triad(&m0, z),
            fast: None,
        };
        if quarter.is_finite() {
            motion.d_quarter = motion.third_kind(1.0, 0.0, kc)?;
        }
        motion.fast = motion.fast(length, j[x], j[y])?;
        if motion.fast.is_none() {
            motion.d0 = motion.swept(&motion.phase(0.0))?;
        }
        Ok(Some(motion))
    }

    /// From |m| and the two moments of inertia of the plane that m circles in.
    fn fast(&self, length: f64, j_x: f64, j_y: f64) -> Result<Option<Fast>, Error> {
        let theta = match self.quarter.is_finite() {
            true => Theta::new(self.kc * self.kc, self.quarter, self.ratio)?,
            false => None,
        };
        Ok(theta.map(|theta| {
            let (s, c) = self.periodic(&theta, theta.angle(self.tau0));
            // L/J_y·(1 + (J_y − J_x)/J_x·D/K), with what the rounding of its two largest steps leaves:
            // after 1e5 radians the last digit of this rate is the error of the angle.
            let base = length / j_y;
            let left = base.mul_add(-j_y, length) / j_y;
            let swing = base * ((j_y - j_x) / j_x * (self.d_quarter / self.quarter));
            let rate = base + swing;
            let added = rate - base;
            let left = (base - (rate - added)) + (swing - added) + left;
            let period = 2.0 * self.quarter;
            let [period_first, rate_first] = [period, rate].map(half_the_digits);
            Fast {
                theta,
                rate: [rate_first, (rate - rate_first) + left],
                s0: self.s0 * about_z((-s, c)),
                period: [period_first, period - period_first],
                inverse: 1.0 / period,
            }
        }))
    }

    /// (sin p, cos p): ϑ₁ sweeps forward where φ̇ is larger where m_x is.
    #[inline]
    fn periodic(&self, theta: &Theta, v: (f64, f64)) -> (f64, f64) {
        let (s, c) = theta.periodic(v);
        (if self.swing >= 0.0 { s } else { -s }, c)
    }

    #[inline]
    fn momentum(&self, t: f64) -> Vector3<f64> {
        let t = t * self.t_scale;
        match &self.fast {
            Some(fast) => {
                let (v, sign) = fast.angle(self.lambda * t + self.tau0);
                self.momentum_at(sign, fast.theta.jacobi(v))
            }
            None => self.place_at(&self.phase(t)),
        }
    }

    /// m and g = S₀ R_z(φ) T(m)ᵀ.
    #[inline]
    fn state(&self, t: f64) -> Result<(Vector3<f64>, Matrix3<f64>), Error> {
        let Place { m, triad, turn, rest } = self.place(t * self.t_scale)?;
        let s0 = self.fast.as_ref().map_or(&self.s0, |fast| &fast.s0);
        Ok((m, s0 * about_z(sum(turn, rest)) * triad.transpose()))
    }

    #[inline]
    fn place(&self, t: f64) -> Result<Place, Error> {
        let (m, turn, rest) = match &self.fast {
            Some(fast) => {
                let (v, sign) = fast.angle(self.lambda * t + self.tau0);
                let rest = self.periodic(&fast.theta, v);
                (self.momentum_at(sign, fast.theta.jacobi(v)), fast.turn(t), rest)
            }
            None => {
                let phase = self.phase(t);
                let phi = Trig::sin_cos(self.precession(t, &phase)?);
                (self.place_at(&phase), phi, (0.0, 1.0))
            }
        };
        Ok(Place { m, triad: triad(&m, self.axes[2]), turn, rest })
    }

    /// See [`Exact::change`].
    #[inline]
    fn change(&self, origin: &Place, t: f64) -> Result<(Vector3<f64>, Matrix3<f64>), Error> {
        let place = self.place(t)?;
        let (s, c) = sum(place.turn, sum(place.rest, (-origin.rest.0, origin.rest.1)));
        let less = if c > 0.0 { -s * s / (1.0 + c) } else { c - 1.0 };
        let turn = Matrix3::new(less, -s, 0.0, s, less, 0.0, 0.0, 0.0, 0.0);
        let moved = (place.triad - origin.triad).transpose();
        let d = origin.triad * (turn * place.triad.transpose() + moved);
        let (lost, late) = self.lost(t, &place.m);
        let late = late.cross_matrix();
        Ok(((place.m - origin.m) + lost, d + (late + d * late)))
    }

    /// The change of m and the rotation in the body that the rounding of the phase λt + τ₀ takes away: ṁ and the rate of the turn
    /// without that part of φ that grows with t, times the time that is lost.
    ///
    /// It is less than the last digit of m. But in steps of one size it is the same in all of them, and adds up.
    #[inline]
    fn lost(&self, t: f64, m: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let (added, tau) = (self.lambda * t, self.lambda * t + self.tau0);
        let start = tau - added;
        let rest = (added - (tau - start)) + (self.tau0 - start);
        let time = (rest + self.lambda.mul_add(t, -added)) / self.lambda;
        let m = m / self.m_scale;
        let omega = m.component_div(&self.inertia);
        let mean = self.fast.as_ref().map_or(self.base, |fast| fast.rate[0] + fast.rate[1]);
        let turn = omega - m * (mean / self.length);
        // Of a step over many turns the lost time is no small one, and the phase has no such digits.
        let is_small = turn.norm() * time.abs() < SMALL_TURN;
        if !is_small {
            return (Vector3::zeros(), Vector3::zeros());
        }
        (cross(&m, &omega) * (time * self.m_scale), turn * time)
    }

    fn phase(&self, t: f64) -> Phase {
        let tau = self.lambda * t + self.tau0;
        let half_turns =
            if self.quarter.is_finite() { (tau / (2.0 * self.quarter)).round() } else { 0.0 };
        let r = match half_turns == 0.0 {
            true => tau,
            false => (-2.0 * self.quarter).mul_add(half_turns, tau),
        };
        let (sn, cn, dn) = self.ladder.jacobi(r);
        Phase { half_turns, sn, cn, dn }
    }

    fn place_at(&self, &Phase { half_turns, sn, cn, dn, .. }: &Phase) -> Vector3<f64> {
        self.momentum_at(if half_turns % 2.0 == 0.0 { 1.0 } else { -1.0 }, (sn, cn, dn))
    }

    #[inline]
    fn momentum_at(&self, sign: f64, (sn, cn, dn): (f64, f64, f64)) -> Vector3<f64> {
        let mut m = Vector3::zeros();
        m[self.axes[0]] = self.m_scale * self.amplitude[0] * sign * cn;
        m[self.axes[1]] = self.m_scale * self.amplitude[1] * sign * sn;
        m[self.axes[2]] = self.m_scale * self.amplitude[2] * dn;
        m
    }

    /// φ(t).
    fn precession(&self, t: f64, phase: &Phase) -> Result<f64, Error> {
        Ok(self.base * t + self.swing * (self.swept(phase)? - self.d0))
    }

    /// D(τ), with D(0) = 0.
    fn swept(&self, phase: &Phase) -> Result<f64, Error> {
        let whole =
            if phase.half_turns == 0.0 { 0.0 } else { 2.0 * phase.half_turns * self.d_quarter };
        Ok(whole + self.third_kind(phase.sn, phase.cn, phase.dn)?)
    }

    /// D for |τ| ≤ K. With s, c, d = sn, cn, dn, n = B²/A², p = c² + n s² and q = c² + (1−k²)s²/n:
    /// ∫ c²/p = s·(c·R_C(d², pq) + (1−k²)s²/(3n)·R_J(c², d², 1, q)) (DLMF 19.21.12).
    fn third_kind(&self, s: f64, c: f64, d: f64) -> Result<f64, Error> {
        let (n, kc) = (self.ratio, self.kc);
        if s == 0.0 {
            return Ok(0.0);
        }
        let p = c * c + n * s * s;
        if kc > NEAR_SEPARATRIX {
            let (c2, kc2) = (c * c, kc * kc * s * s);
            let q = c2 + kc2 / n;
            let elementary = if c > 0.0 { c * rc(d * d, p * q)? } else { 0.0 };
            return Ok(s * (elementary + kc2 / (3.0 * n) * rj(c2, d * d, 1.0, q)?));
        }
        // In parts of d, which may be as small as k'. Far on the separatrix c = d, and both may be zero.
        let (c_d, kc_d) = if d > 0.0 { (c / d, kc * s / d) } else { (1.0, 0.0) };
        let elementary = c_d * rc(1.0, p * (c_d * c_d + kc_d * kc_d / n))?;
        // Where z = 1 is far above x, y and p, R_J(x, y, z, p) is 3 ∫ dw/(y − p + w²(p − x)) from w = 1 to √(y/x). With
        // d² − c² = (1−k²)s² the rest is ∫ dw/(n − 1 + w²) from 1 to d/c, the arc tangent of (d − c)/((n − 1)c + d).
        let x = kc_d * kc_d / (1.0 + c_d) / (1.0 + (n - 1.0) * c_d);
        Ok(s * (elementary + x * rc(1.0, 1.0 + (n - 1.0) * x * x)?))
    }
}

/// F, the integral of the first kind with k', at (sin, cos) of its amplitude, cos ≥ 0; infinite for K on the separatrix.
///
/// As k' → 0 it is arsinh(s/c), and near K it is K − arsinh(c/(s k')) with K = ln(4/k').
fn first_kind(kc: f64, (s, c): (f64, f64)) -> Result<f64, Error> {
    if kc > NEAR_SEPARATRIX {
        Ok(s * rf(c * c, c * c + kc * kc * s * s, 1.0)?)
    } else if c > 1e-10 {
        Ok((s / c).asinh())
    } else {
        let left = if c > 0.0 { (c / s.abs() / kc).asinh() } else { 0.0 };
        Ok((4f64.ln() - kc.ln() - left).copysign(s))
    }
}
