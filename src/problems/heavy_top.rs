//! The heavy top on se(3)*: a rigid body that rotates about a fixed point under gravity.
//!
//! μ is the momentum and γ the upward vertical, both in the body frame. w = (weight)·(vector from the fixed point to
//! the centre of mass):
//!
//! H(μ, γ) = ½ μ·J⁻¹μ + w·γ,    μ̇ = μ × ω + γ × w,    γ̇ = γ × ω,    ω = J⁻¹μ
//!
//! f = −∇H = −(ω, w); Λ coadjoint. Invariants: |γ|² and μ·γ (the Casimirs), H, and
//!
//! | | J | w | further |
//! |---|---|---|---|
//! | Euler | any | 0 | \|μ\|² |
//! | Lagrange | (A, A, C) | (0, 0, w) | μ₃ |
//! | Kovalevskaya | (2C, 2C, C) | (w₁, w₂, 0) | \|(ω₁ + iω₂)² − ((w₁ + iw₂)/C)(γ₁ + iγ₂)\|² |
//!
//! The axis of Lagrange's and Kovalevskaya's top may be any of the three.
//!
//! f is affine in (μ, γ), so its Taylor coefficients are short sums, and Lie series apply
//! ([`LieSeries`](crate::methods::LieSeries)).
//!
//! Source: S. Kowalevski, Acta Math. 12 (1889); V. I. Arnold, Mathematical Methods, appendix 5.

use nalgebra::Vector3;

use super::rigid_body::check_inertia;
use super::{DiscreteGradient, Euler, Hamiltonian, Invariant, Quadratic};
use crate::error::Error;
use crate::groups::Se3;
use crate::scalar::Real;

/// The energy of a heavy top.
///
/// ```
/// use lieflow::maps::Exp;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::HeavyTop;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
/// let top = HeavyTop::<f64>::lagrange(1.0, 0.5, 1.0)?.problem();
/// let mut y = (Vector3::new(0.1, 0.0, 2.0), Vector3::new(0.0, 0.6, 0.8));
/// let grid = TimeGrid::new([0.0, 10.0], 0.01)?;
/// integrate(&top, &Rkmk::new(RK4, Exp), &grid, &SaveAt::Ends, &mut y, |_, _| {})?;
/// assert!((y.1.norm() - 1.0).abs() < 1e-13 && (y.0[2] - 2.0).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct HeavyTop<S = f64> {
    inverse_inertia: Vector3<S>,
    weight: Vector3<S>,
    integral: Integral<S>,
}

/// Numbers that differ by this part of them are the same: moments and axes of a tensor have its rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The fourth integral, if there is one.
#[derive(Clone, Copy, Debug)]
enum Integral<S> {
    None,
    Euler,
    /// The axis, and the sign of w along it.
    Lagrange(usize, f64),
    /// The unit vector along w, where all moments are equal: Lagrange's top about w.
    Sphere([S; 3]),
    /// The axis k, and w/C along the axes k + 1 and k + 2.
    Kovalevskaya(usize, [S; 2]),
}

impl<S: Real> HeavyTop<S> {
    /// Makes a top from the principal moments of inertia about the fixed point, and w. Integrable cases are recognised
    /// by these numbers, up to their rounding and with any axis, and then the fourth integral is one of the invariants.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a moment that is not finite and positive, and a w that is not finite.
    pub fn new(inertia: [f64; 3], weight: [f64; 3]) -> Result<Self, Error> {
        check_inertia(&inertia)?;
        Error::all_finite("weight", &weight)?;
        let length = weight.iter().map(|w| w * w).sum::<f64>().sqrt();
        let equal = |a: f64, b: f64| (a - b).abs() <= ROUNDING * a;
        let is_none = |w: f64| w.abs() <= ROUNDING * length;
        let about = |k: usize| {
            // From the axis k on in cyclic order.
            let [[c, a, b], [z, x, y]] =
                [inertia, weight].map(|all| [0, 1, 2].map(|i| all[(k + i) % 3]));
            if equal(a, b) && is_none(x) && is_none(y) {
                Some(Integral::Lagrange(k, z.signum()))
            } else if equal(a, b) && equal(a, 2.0 * c) && is_none(z) {
                Some(Integral::Kovalevskaya(k, [x, y].map(|w| S::lit(w / c))))
            } else {
                None
            }
        };
        let is_sphere = equal(inertia[0], inertia[1]) && equal(inertia[1], inertia[2]);
        let sphere = || is_sphere.then(|| Integral::Sphere(weight.map(|w| S::lit(w / length))));
        let integral = match weight == [0.0; 3] {
            true => Integral::Euler,
            false => {
                [2, 0, 1].into_iter().find_map(about).or_else(sphere).unwrap_or(Integral::None)
            }
        };
        let vector = |x: [f64; 3]| Vector3::from(x.map(S::lit));
        let inverse_inertia = vector(inertia.map(|j| 1.0 / j));
        Ok(HeavyTop { inverse_inertia, weight: vector(weight), integral })
    }

    /// Lagrange's top: J = (A, A, C), the centre of mass on its axis, w = (0, 0, w).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn lagrange(a: f64, c: f64, w: f64) -> Result<Self, Error> {
        Self::new([a, a, c], [0.0, 0.0, w])
    }

    /// Kovalevskaya's top: J = (2C, 2C, C), the centre of mass in its equator, w = (w, 0, 0).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn kovalevskaya(c: f64, w: f64) -> Result<Self, Error> {
        Self::new([2.0 * c, 2.0 * c, c], [w, 0.0, 0.0])
    }

    /// The equations of the top on se(3)*.
    pub fn problem(self) -> Euler<Se3<S>, Self> {
        Euler::new(Se3::new(), self)
    }

    /// The energy ½ μ·J⁻¹μ + w·γ.
    pub fn energy(&self, (mu, gamma): &(Vector3<S>, Vector3<S>)) -> S {
        S::lit(0.5) * dot(mu, &self.omega(mu)) + dot(&self.weight, gamma)
    }

    /// The Casimirs |γ|² and μ·γ.
    pub fn casimirs(&self, (mu, gamma): &(Vector3<S>, Vector3<S>)) -> [S; 2] {
        [dot(gamma, gamma), dot(mu, gamma)]
    }

    /// The fourth integral of Euler's, Lagrange's or Kovalevskaya's top. `None` for other tops.
    ///
    /// Euler's is |μ|², Lagrange's the momentum along w, and Kovalevskaya's |(ω_i + iω_j)² − (c + id)(γ_i + iγ_j)|², where
    /// (c, d) is w/C along the axes i and j of its equator.
    pub fn fourth_integral(&self, (mu, gamma): &(Vector3<S>, Vector3<S>)) -> Option<S> {
        match self.integral {
            Integral::None => None,
            Integral::Euler => Some(dot(mu, mu)),
            Integral::Lagrange(k, sign) => Some(S::lit(sign) * mu[k]),
            Integral::Sphere(e) => Some(dot(&Vector3::from(e), mu)),
            Integral::Kovalevskaya(k, [c, d]) => {
                let (w, [i, j]) = (self.omega(mu), [1, 2].map(|n| (k + n) % 3));
                let re = w[i] * w[i] - w[j] * w[j] - (c * gamma[i] - d * gamma[j]);
                let im = S::lit(2.0) * w[i] * w[j] - (c * gamma[j] + d * gamma[i]);
                Some(re * re + im * im)
            }
        }
    }

    /// The size of the terms of [`fourth_integral`](Self::fourth_integral), which may cancel.
    pub fn terms_of_fourth_integral(&self, (mu, gamma): &(Vector3<S>, Vector3<S>)) -> S {
        let squared = dot(mu, mu);
        match self.integral {
            Integral::None | Integral::Euler => squared,
            Integral::Lagrange(..) | Integral::Sphere(_) => squared.sqrt(),
            Integral::Kovalevskaya(_, [c, d]) => {
                let w = self.omega(mu);
                let terms = dot(&w, &w) + ((c * c + d * d) * dot(gamma, gamma)).sqrt();
                terms * terms
            }
        }
    }

    /// The degree of [`fourth_integral`](Self::fourth_integral) as a polynomial in (μ, γ). A top without one has 0.
    pub fn degree_of_fourth_integral(&self) -> u32 {
        match self.integral {
            Integral::None => 0,
            Integral::Euler => 2,
            Integral::Lagrange(..) | Integral::Sphere(_) => 1,
            Integral::Kovalevskaya(..) => 4,
        }
    }

    /// True for a top with a fourth integral.
    pub fn is_integrable(&self) -> bool {
        !matches!(self.integral, Integral::None)
    }

    /// ω = J⁻¹μ.
    #[inline]
    pub fn omega(&self, mu: &Vector3<S>) -> Vector3<S> {
        Vector3::from_fn(|i, _| self.inverse_inertia[i] * mu[i])
    }
}

fn dot<S: Real>(a: &Vector3<S>, b: &Vector3<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<S: Real> Hamiltonian<Se3<S>> for HeavyTop<S> {
    fn value(&self, _: &Se3<S>, y: &(Vector3<S>, Vector3<S>)) -> S {
        self.energy(y)
    }
    #[inline]
    fn gradient(&self, (mu, _): &(Vector3<S>, Vector3<S>), xi: &mut (Vector3<S>, Vector3<S>)) {
        *xi = (self.omega(mu), self.weight);
    }
    fn degree(&self) -> u32 {
        2
    }
    fn further(&self) -> Vec<Invariant> {
        let length = Invariant::of_the_action("|γ|²", 2);
        let casimirs = [length, Invariant::of_the_action("μ·γ", 2).in_terms()];
        let fourth = match self.integral {
            Integral::None => None,
            Integral::Euler => Some("|μ|²"),
            Integral::Lagrange(k, sign) if sign > 0.0 => Some(["μ₁", "μ₂", "μ₃"][k]),
            Integral::Lagrange(k, _) => Some(["-μ₁", "-μ₂", "-μ₃"][k]),
            Integral::Sphere(_) => Some("μ·w/|w|"),
            Integral::Kovalevskaya(..) => Some("Kovalevskaya's integral"),
        };
        let degree = self.degree_of_fourth_integral();
        let fourth = fourth.map(|name| Invariant::of_the_flow(name, degree).in_terms());
        casimirs.into_iter().chain(fourth).collect()
    }
    fn further_values(&self, y: &(Vector3<S>, Vector3<S>)) -> Vec<S> {
        self.casimirs(y).into_iter().chain(self.fourth_integral(y)).collect()
    }
    fn further_sizes(&self, y: &(Vector3<S>, Vector3<S>)) -> Vec<S> {
        let [gamma2, _] = self.casimirs(y);
        let sizes = [gamma2, (dot(&y.0, &y.0) * gamma2).sqrt()];
        let fourth = self.is_integrable().then(|| self.terms_of_fourth_integral(y));
        sizes.into_iter().chain(fourth).collect()
    }
}

impl<S: Real> DiscreteGradient<Se3<S>> for HeavyTop<S> {}

impl<S: Real> Quadratic<Se3<S>> for HeavyTop<S> {
    #[inline]
    fn linear_gradient(
        &self,
        (mu, _): &(Vector3<S>, Vector3<S>),
        xi: &mut (Vector3<S>, Vector3<S>),
    ) {
        *xi = (self.omega(mu), Vector3::from_element(S::lit(0.0)));
    }
}
