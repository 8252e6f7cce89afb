//! Initial vorticities.

use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::harmonics::{harmonics_at, place};
use super::{Sphere, Zeitlin};
use crate::error::Error;
use crate::groups::ComplexMatrix;

/// A vortex on the sphere: a point vortex that has diffused to a width.
///
/// ω = (Γ/4π) Σ_{l ≥ 1} e^{−l(l+1)σ²/2} Σ_m Y_lm(x₀) Y_lm, without the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vortex {
    /// The latitude in radians, north positive.
    pub latitude: f64,
    /// The longitude in radians, east positive.
    pub longitude: f64,
    /// The circulation Γ, positive for a counterclockwise flow seen from outside.
    pub circulation: f64,
    /// The width σ in radians.
    pub width: f64,
}

impl Zeitlin<Sphere> {
    /// A random field: Gaussian coefficients ω_lm of equal variance for 1 ≤ l < `below`, scaled to the root mean square
    /// 1.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless 2 ≤ `below` ≤ N.
    pub fn random<R: Rng + ?Sized>(
        &self,
        rng: &mut R,
        below: usize,
    ) -> Result<ComplexMatrix, Error> {
        self.degree("below", below)?;
        let mut omega: Vec<f64> = (0..below * below)
            .map(|k| if k == 0 { 0.0 } else { rng.sample(StandardNormal) })
            .collect();
        let size = omega.iter().map(|x| x * x).sum::<f64>().sqrt();
        omega.iter_mut().for_each(|x| *x /= size);
        self.from_coefficients(&omega)
    }

    /// Jets along the parallels: the zonal harmonics Σ a_l Y_l0, from (l, a_l). Such a flow is
    /// stationary. The solid rotation with the angular velocity Ω is l = 1 with 2Ω/√3.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless 1 ≤ l < N with finite amplitudes.
    pub fn jets(&self, amplitudes: &[(usize, f64)]) -> Result<ComplexMatrix, Error> {
        let below = amplitudes.iter().map(|(l, _)| l.saturating_add(1)).max().unwrap_or(2).max(2);
        self.degree("l + 1", below)?;
        let mut omega = vec![0.0; below * below];
        for &(l, a) in amplitudes {
            if l == 0 {
                return Err(Error::out_of_range("l", 0.0, "l ≥ 1: the mean vorticity is 0"));
            }
            omega[place(l, 0)] += a;
        }
        self.from_coefficients(&omega)
    }

    /// The sum of these vortices.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers that are not finite, and widths that are not positive.
    pub fn vortices(&self, vortices: &[Vortex]) -> Result<ComplexMatrix, Error> {
        let n = self.n();
        let mut omega = vec![0.0; n * n];
        for (i, vortex) in vortices.iter().enumerate() {
            let Vortex { latitude, longitude, circulation, width } = *vortex;
            let numbers =
                [("latitude", latitude), ("longitude", longitude), ("circulation", circulation)];
            for (name, x) in numbers {
                Error::finite(format!("vortices[{i}].{name}"), x)?;
            }
            Error::positive(format!("vortices[{i}].width"), width)?;
            let y = harmonics_at(n, latitude, longitude);
            for l in 1..n {
                let decay = (-0.5 * width * width * (l * (l + 1)) as f64).exp();
                let scale = circulation / (4.0 * core::f64::consts::PI) * decay;
                for k in l * l..(l + 1) * (l + 1) {
                    omega[k] += scale * y[k];
                }
            }
        }
        self.from_coefficients(&omega)
    }

    fn degree(&self, arg: &str, below: usize) -> Result<(), Error> {
        match (2..=self.n()).contains(&below) {
            true => Ok(()),
            false => Err(Error::out_of_range(arg, below as f64, format!("2 to N = {}", self.n()))),
        }
    }
}
