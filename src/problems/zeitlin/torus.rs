//! The torus \[0, 2π)² with odd N: the sine–Euler equations.
//!
//! A function ω(x, y) = Σ ω_m e^{i m·x}, |m₁|, |m₂| ≤ (N − 1)/2, is the matrix W = i Σ ω_m T_m,
//!
//! (T_m)_rc = e^{2πi m₁(r + m₂/2)/N} where c = r + m₂ mod N, else 0: T_m = ζ^{m₁m₂/2} g^{m₁} h^{m₂}
//!
//! with the clock g = diag(ζ^r), ζ = e^{2πi/N}, and the shift h. \[T_m, T_n\] = −2i sin(π(m×n)/N) T_{m+n}, so
//! that with 1/ħ = N/2π commutators become Poisson brackets, ω̇ = −u·∇ω, u = (−∂_yψ, ∂_xψ). A wave number of the sum
//! beyond (N − 1)/2 is one of those within: T_{m + Ne} = (−1)^{e₁m₂ + e₂m₁ + Ne₁e₂} T_m for whole e₁, e₂.
//!
//! Δ T_m = −|m|² T_m. It maps every cyclic diagonal c = r + m₂ to itself by a symmetric circulant, which is diagonal in
//! the real Fourier basis. So a solve takes two real products.
//! Source: V. Zeitlin, Physica D 49 (1991); D. B. Fairlie & C. K. Zachos, Phys. Lett. B 224 (1989).

use core::f64::consts::{PI, TAU};

use faer::{Mat, c64};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use super::{Surface, Zeitlin};
use crate::dense::mul;
use crate::error::Error;
use crate::groups::ComplexMatrix;
use crate::scalar::{Ops, tally};

/// The quantised torus: 1/ħ = N/2π.
#[derive(Clone, Debug)]
pub struct Torus {
    n: usize,
    /// The real Fourier basis, orthonormal columns: 1, and cos, sin of every wave number.
    basis: Mat<f64>,
    /// −1/(m₁² + m₂²) at (column of the basis, m₂); 0 at m = 0.
    inverse: Mat<f64>,
    /// e^{πik/N}, 0 ≤ k < 2N.
    phases: Vec<c64>,
}

impl Torus {
    /// The torus of N×N matrices.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless N is odd and 3 ≤ N ≤ 4095.
    pub fn new(n: usize) -> Result<Self, Error> {
        if !(3..=4095).contains(&n) || n.is_multiple_of(2) {
            return Err(Error::out_of_range("N", n as f64, "an odd number, 3 to 4095"));
        }
        let wave_number = |j: usize| j.div_ceil(2);
        let scale = (2.0 / n as f64).sqrt();
        let basis = Mat::from_fn(n, n, |r, j| {
            // The product is reduced first, so that no angle is large.
            let angle = TAU * ((wave_number(j) * r) % n) as f64 / n as f64;
            match j {
                0 => (1.0 / n as f64).sqrt(),
                _ if j % 2 == 1 => scale * angle.cos(),
                _ => scale * angle.sin(),
            }
        });
        let inverse = Mat::from_fn(n, n.div_ceil(2), |j, d| match wave_number(j).pow(2) + d * d {
            0 => 0.0,
            square => -1.0 / square as f64,
        });
        let phase = |k: usize| c64::new(0.0, PI * k as f64 / n as f64).exp();
        Ok(Torus { n, basis, inverse, phases: (0..2 * n).map(phase).collect() })
    }

    /// The largest wave number, (N − 1)/2.
    pub fn wave_number_max(&self) -> usize {
        (self.n - 1) / 2
    }

    /// The column of T_m's entry in row r, and the entry e^{2πi m₁(r + m₂/2)/N}.
    fn entry(&self, m: [i32; 2], r: usize) -> (usize, c64) {
        let (n, m) = (self.n as i64, m.map(i64::from));
        let halves = m[0] * (2 * r as i64 + m[1]);
        let column = (r as i64 + m[1]).rem_euclid(n);
        (column as usize, self.phases[halves.rem_euclid(2 * n) as usize])
    }
}

/// The place of entry r of the cyclic diagonal d > 0 on or below the diagonal, and whether it is conjugated with a
/// minus sign.
fn place(n: usize, d: usize, r: usize) -> (usize, usize, bool) {
    if r + d < n { (r + d, r, true) } else { (r, r + d - n, false) }
}

impl Surface for Torus {
    fn n(&self) -> usize {
        self.n
    }
    /// 1/ħ = N/2π.
    fn rate(&self) -> f64 {
        self.n as f64 / TAU
    }
    fn scratch(&self) -> [Mat<f64>; 2] {
        [Mat::zeros(self.n, self.n + 1), Mat::zeros(self.n, self.n + 1)]
    }
    fn solve(&self, x: &mut ComplexMatrix, [diagonals, modes]: &mut [Mat<f64>; 2]) {
        let (n, half) = (self.n, self.n.div_ceil(2));
        for d in 0..half {
            for r in 0..n {
                let (i, j, above) = place(n, d, r);
                let re = x.re[(i, j)];
                diagonals[(r, d)] = if d == 0 {
                    0.0
                } else if above {
                    -re
                } else {
                    re
                };
                diagonals[(r, half + d)] = x.im[(i, j)];
            }
        }
        mul(modes, self.basis.transpose(), diagonals.as_ref());
        tally(|| Ops::muls(2 * half * n));
        for d in 0..2 * half {
            let column = self.inverse.col_as_slice(d % half);
            modes.col_as_slice_mut(d).iter_mut().zip(column).for_each(|(x, i)| *x *= i);
        }
        mul(diagonals, self.basis.as_ref(), modes.as_ref());
        for d in 0..half {
            for r in 0..n {
                let (i, j, above) = place(n, d, r);
                let re = diagonals[(r, d)];
                x.re[(i, j)] = if d == 0 {
                    0.0
                } else if above {
                    -re
                } else {
                    re
                };
                x.im[(i, j)] = diagonals[(r, half + d)];
            }
        }
    }
}

impl Zeitlin<Torus> {
    /// The torus \[0, 2π)² with N×N matrices, N odd: wave numbers up to (N − 1)/2.
    ///
    /// # Errors
    /// As [`Torus::new`].
    pub fn torus(n: usize) -> Result<Self, Error> {
        Zeitlin::new(Torus::new(n)?)
    }

    /// ω = Σ a cos(m·x) + b sin(m·x), from (\[m₁, m₂\], \[a, b\]). The mean is 0, so m = 0 is ignored.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for wave numbers beyond (N − 1)/2 and amplitudes that are not finite.
    pub fn from_modes(&self, modes: &[([i32; 2], [f64; 2])]) -> Result<ComplexMatrix, Error> {
        let (n, max) = (self.n(), self.surface.wave_number_max());
        let mut w = ComplexMatrix::zeros(n, n);
        for (k, &(m, amplitudes)) in modes.iter().enumerate() {
            if let Some(m) = m.into_iter().find(|m| m.unsigned_abs() as usize > max) {
                let arg = format!("modes[{k}].m");
                return Err(Error::out_of_range(arg, f64::from(m), format!("−{max} ≤ m ≤ {max}")));
            }
            for x in amplitudes {
                Error::finite(format!("modes[{k}].amplitude"), x)?;
            }
            if m == [0, 0] {
                continue;
            }
            // ω_m = (a − ib)/2, and its conjugate at −m.
            for (m, b) in [(m, amplitudes[1]), ([-m[0], -m[1]], -amplitudes[1])] {
                let omega = c64::new(0.5 * amplitudes[0], -0.5 * b);
                for r in 0..n {
                    let (c, entry) = self.surface.entry(m, r);
                    let z = omega * entry;
                    w.re[(r, c)] -= z.im;
                    w.im[(r, c)] += z.re;
                }
            }
        }
        Ok(skew_hermitian(w))
    }

    /// ω_m at (m₁ + K, m₂ + K), K = (N − 1)/2. Allocates; O(N³).
    pub fn modes(&self, w: &ComplexMatrix) -> Mat<c64> {
        let (n, max) = (self.n(), self.surface.wave_number_max() as i32);
        Mat::from_fn(n, n, |i, j| {
            let m = [i as i32 - max, j as i32 - max];
            let along = |r: usize| {
                let (c, entry) = self.surface.entry(m, r);
                let z = w.get(r, c);
                c64::new(z.im, -z.re) * entry.conj()
            };
            (0..n).map(along).sum::<c64>() / n as f64
        })
    }

    /// The vorticity on a grid: row i at y = 2π(1 − (i + ½)/rows), column j at x = 2π(j + ½)/cols.
    /// Allocates; O(N³ + rows·N·(N + cols)).
    pub fn on_grid(&self, w: &ComplexMatrix, rows: usize, cols: usize) -> Mat<f64> {
        let (n, max) = (self.n(), self.surface.wave_number_max() as f64);
        let modes = self.modes(w);
        let wave = |k: usize, x: f64| c64::new(0.0, (k as f64 - max) * x).exp();
        let across = Mat::from_fn(n, cols, |k, j| wave(k, TAU * (j as f64 + 0.5) / cols as f64));
        let mut grid = Mat::zeros(rows, cols);
        for i in 0..rows {
            let y = TAU * (1.0 - (i as f64 + 0.5) / rows as f64);
            let line: Vec<c64> =
                (0..n).map(|k| (0..n).map(|l| modes[(k, l)] * wave(l, y)).sum()).collect();
            for j in 0..cols {
                grid[(i, j)] = (0..n).map(|k| (line[k] * across[(k, j)]).re).sum();
            }
        }
        grid
    }

    /// A random field: Gaussian amplitudes of equal variance for 0 < |m| < `below`, scaled to the root mean square 1.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless 2 ≤ `below` ≤ (N + 1)/2.
    pub fn random<R: Rng + ?Sized>(
        &self,
        rng: &mut R,
        below: usize,
    ) -> Result<ComplexMatrix, Error> {
        let max = self.surface.wave_number_max() + 1;
        if !(2..=max).contains(&below) {
            return Err(Error::out_of_range("below", below as f64, format!("2 to {max}")));
        }
        let k = below as i32 - 1;
        let mut modes = Vec::new();
        for m in half_plane(k).filter(|m| m[0] * m[0] + m[1] * m[1] < (k + 1) * (k + 1)) {
            modes.push((m, [rng.sample(StandardNormal), rng.sample(StandardNormal)]));
        }
        let squares = |(_, [a, b]): &([i32; 2], [f64; 2])| 0.5 * (a * a + b * b);
        let size = modes.iter().map(squares).sum::<f64>().sqrt();
        modes.iter_mut().for_each(|(_, a)| a.iter_mut().for_each(|a| *a /= size));
        self.from_modes(&modes)
    }

    /// Vortices from (\[x, y\], circulation Γ, width σ): each is (Γ/4π²) Σ_{m ≠ 0} e^{−σ²|m|²/2} e^{i m·(x − x₀)}.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers that are not finite, and widths that are not positive.
    pub fn vortices(&self, vortices: &[([f64; 2], f64, f64)]) -> Result<ComplexMatrix, Error> {
        let max = self.surface.wave_number_max() as i32;
        let mut modes: Vec<_> = half_plane(max).map(|m| (m, [0.0; 2])).collect();
        for (i, &([x, y], circulation, width)) in vortices.iter().enumerate() {
            for (name, value) in [("x", x), ("y", y), ("circulation", circulation)] {
                Error::finite(format!("vortices[{i}].{name}"), value)?;
            }
            Error::positive(format!("vortices[{i}].width"), width)?;
            for (m, [a, b]) in &mut modes {
                let [m1, m2] = m.map(f64::from);
                let decay = (-0.5 * width * width * (m1 * m1 + m2 * m2)).exp();
                let size = circulation / (2.0 * PI * PI) * decay;
                let (s, c) = (m1 * x + m2 * y).sin_cos();
                *a += size * c;
                *b += size * s;
            }
        }
        self.from_modes(&modes)
    }
}

/// One of every pair m, −m with |m₁|, |m₂| ≤ k, m ≠ 0.
fn half_plane(k: i32) -> impl Iterator<Item = [i32; 2]> {
    (0..=k).flat_map(move |a| (-k..=k).map(move |b| [a, b])).filter(|m| m[0] > 0 || m[1] > 0)
}

/// (w − w†)/2, which removes rounding errors.
fn skew_hermitian(w: ComplexMatrix) -> ComplexMatrix {
    ComplexMatrix::from_fn(w.nrows(), w.ncols(), |i, j| (w.get(i, j) - w.get(j, i).conj()) * 0.5)
}
