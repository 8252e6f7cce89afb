//! Spherical harmonics as matrices T_lm, and as functions on the sphere.
//!
//! Harmonics are real, without the Condon–Shortley phase, and of mean square 1: Y_11 = √3 x,
//! Y_1,−1 = √3 y, Y_10 = √3 z. Coefficient ω_lm has the index l² + l + m, so l < L takes L² of them.
//!
//! | m | T_lm |
//! |---|---|
//! | 0 | i v on the diagonal |
//! | > 0 | i v/√2 on the diagonals m above and below |
//! | < 0 | v/√2 above, −v/√2 below |
//!
//! with v = v^{l,\|m\|} the eigenvector of −Δ on the diagonal \|m\| to l(l + 1), Σv² = N, and its first
//! entry, the one nearest to the north pole, positive: ⟨T_lm, T_l′m′⟩ = δδ.
//!
//! v is computed by a twisted factorisation of −Δ − l(l + 1), in the form of the solve of [`Sphere`]: s_i from above,
//! t_i from below, joined where s + t − (m² − λ) is smallest.
//! Source: for the twist, I. S. Dhillon & B. N. Parlett, Linear Algebra Appl. 387 (2004).

use core::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

use faer::Mat;

use super::sphere::entries;
use super::{Sphere, Zeitlin};
use crate::error::Error;
use crate::groups::ComplexMatrix;

/// l² + l ± m, the place of ω_{l,±m}.
pub(super) fn place(l: usize, m: isize) -> usize {
    (l * l + l).wrapping_add_signed(m)
}

/// v^{l,m}, m ≥ 0, of length N − m.
pub(super) fn eigenvector(n: usize, l: usize, m: usize) -> Vec<f64> {
    let size = n - m;
    let shift = (m * m) as f64 - (l * (l + 1)) as f64;
    // A pivot that vanishes: the entry next to it does.
    let safe = |p: f64| if p == 0.0 { f64::EPSILON } else { p };
    let (mut s, mut t) = (vec![0.0; size], vec![0.0; size]);
    s[0] = shift + entries(n, m, 0).0;
    for i in 1..size {
        let (q, gap, _) = entries(n, m, i);
        s[i] = shift + (gap + q * s[i - 1]) / safe(q + s[i - 1]);
    }
    t[size - 1] = shift + entries(n, m, size).0;
    for i in (0..size - 1).rev() {
        let (q, gap, _) = entries(n, m, i + 1);
        t[i] = shift + (gap + q * t[i + 1]) / safe(q + t[i + 1]);
    }
    let twist = |i: &usize| (s[*i] + t[*i] - shift).abs();
    let k = (0..size).min_by(|a, b| twist(a).total_cmp(&twist(b))).unwrap_or(0);
    let mut v = vec![0.0; size];
    v[k] = 1.0;
    for i in (0..k).rev() {
        let (q, _, o) = entries(n, m, i + 1);
        v[i] = v[i + 1] * o / safe(q + s[i]);
    }
    for i in k + 1..size {
        let (q, _, o) = entries(n, m, i);
        v[i] = v[i - 1] * o / safe(q + t[i]);
    }
    let norm = (v.iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt();
    // The first entry may underflow: the sign is that of the first that does not.
    let first = v.iter().copied().find(|x| *x != 0.0).unwrap_or(1.0);
    v.iter_mut().for_each(|x| *x /= norm * first.signum());
    v
}

/// The normalised Legendre functions P̄_lm(z) of one m ≥ 0 and m ≤ l < `below`, at z = cos θ.
fn legendre(m: usize, below: usize, z: f64) -> Vec<f64> {
    let sine = ((1.0 - z) * (1.0 + z)).sqrt();
    let mut sectoral = 1.0;
    for k in 1..=m {
        let k = k as f64;
        sectoral *=
            sine * if k == 1.0 { 3f64.sqrt() } else { ((2.0 * k + 1.0) / (2.0 * k)).sqrt() };
    }
    let mut all = vec![sectoral];
    let coupling = |l: usize| {
        let (l, m) = (l as f64, m as f64);
        ((l * l - m * m) / (4.0 * l * l - 1.0)).sqrt()
    };
    let (mut before, mut last) = (0.0, sectoral);
    for l in m + 1..below {
        let next = (z * last - coupling(l - 1) * before) / coupling(l);
        all.push(next);
        (before, last) = (last, next);
    }
    all
}

impl Zeitlin<Sphere> {
    /// W = Σ ω_lm T_lm, from L² coefficients ω_lm at l² + l + m; L ≤ N.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if their number is not a square L² ≤ N², or one is not finite.
    pub fn from_coefficients(&self, coefficients: &[f64]) -> Result<ComplexMatrix, Error> {
        let (n, count) = (self.n(), coefficients.len());
        let below = count.isqrt();
        if below * below != count || below > n {
            let expected = format!("L² coefficients with L ≤ {n}");
            return Err(Error::out_of_range("coefficients", count as f64, expected));
        }
        Error::all_finite("coefficients", coefficients)?;
        let mut w = ComplexMatrix::zeros(n, n);
        for m in 0..below {
            for l in m..below {
                let [c, s] = [m as isize, -(m as isize)].map(|m| coefficients[place(l, m)]);
                if c == 0.0 && s == 0.0 {
                    continue;
                }
                let half = if m == 0 { 1.0 } else { FRAC_1_SQRT_2 };
                for (i, v) in eigenvector(n, l, m).into_iter().enumerate() {
                    w.im[(i + m, i)] += half * c * v;
                    if m > 0 {
                        w.im[(i, i + m)] += half * c * v;
                        w.re[(i, i + m)] += half * s * v;
                        w.re[(i + m, i)] -= half * s * v;
                    }
                }
            }
        }
        Ok(w)
    }

    /// ω_lm = ⟨T_lm, W⟩ for l < `below`, at l² + l + m. Allocates; O(N·`below`²).
    pub fn coefficients(&self, w: &ComplexMatrix, below: usize) -> Vec<f64> {
        let (n, below) = (self.n(), below.min(self.n()));
        let mut all = vec![0.0; below * below];
        for m in 0..below {
            for l in m..below {
                let v = eigenvector(n, l, m);
                let along = |part: &Mat<f64>| -> f64 {
                    v.iter().enumerate().map(|(i, v)| v * part[(i + m, i)]).sum()
                };
                let scale = if m == 0 { 1.0 } else { SQRT_2 } / n as f64;
                all[place(l, m as isize)] = scale * along(&w.im);
                if m > 0 {
                    all[place(l, -(m as isize))] = -scale * along(&w.re);
                }
            }
        }
        all
    }

    /// The vorticity on an equirectangular grid: row i at the latitude 90° − (i + ½)·180°/rows, column
    /// j at the longitude −180° + (j + ½)·360°/cols. Allocates; O(N³ + rows·N·(N + cols)).
    pub fn on_grid(&self, w: &ComplexMatrix, rows: usize, cols: usize) -> Mat<f64> {
        let n = self.n();
        let omega = self.coefficients(w, n);
        let longitude = |j: usize| -PI + (j as f64 + 0.5) * 2.0 * PI / cols as f64;
        // The same for each row.
        let turns = Mat::from_fn(cols, n, |j, m| (m as f64 * longitude(j)).sin_cos());
        let mut grid = Mat::zeros(rows, cols);
        for i in 0..rows {
            let z = ((i as f64 + 0.5) * PI / rows as f64).cos();
            for m in 0..n {
                let (mut c, mut s) = (0.0, 0.0);
                for (l, p) in (m..n).zip(legendre(m, n, z)) {
                    c += omega[place(l, m as isize)] * p;
                    s += omega[place(l, -(m as isize))] * p;
                }
                for j in 0..cols {
                    let (sin, cos) = turns[(j, m)];
                    grid[(i, j)] += c * cos + if m > 0 { s * sin } else { 0.0 };
                }
            }
        }
        grid
    }

    /// The vorticity at one point, by its latitude and longitude in radians. Allocates.
    pub fn at(&self, w: &ComplexMatrix, latitude: f64, longitude: f64) -> f64 {
        let y = harmonics_at(self.n(), latitude, longitude);
        self.coefficients(w, self.n()).iter().zip(y).map(|(c, y)| c * y).sum()
    }
}

/// Y_lm at a point, l < `below`, at l² + l + m.
pub(super) fn harmonics_at(below: usize, latitude: f64, longitude: f64) -> Vec<f64> {
    let mut all = vec![0.0; below * below];
    for m in 0..below {
        let (sin, cos) = (m as f64 * longitude).sin_cos();
        for (l, p) in (m..below).zip(legendre(m, below, latitude.sin())) {
            all[place(l, -(m as isize))] = p * sin;
            all[place(l, m as isize)] = p * cos;
        }
    }
    all
}
