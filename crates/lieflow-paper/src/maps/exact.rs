//! The coordinate maps to 30 digits, on matrices of any size: what the library's values are
//! compared with. Nothing here is shared with the library; where its dΨ⁻¹ serves to find a
//! reference, the residual of the equation dΨ_u(w) = v in [`DoubleDouble`](Dd) says when it is found.
//!
//! | | |
//! |---|---|
//! | exp(u) | Taylor series at u/2^s, squared s times |
//! | dexp_u(v) | derivative of that series and of the squarings, times exp(−u) |
//! | cay(u) | (𝟙 − u/2)⁻¹(𝟙 + u/2) by elimination |
//! | dcay_u⁻¹(v) | (𝟙 − u/2) v (𝟙 + u/2) |
//! | ccsk321(u) | ∏_c ∏_{r>c} exp(u_rc(e_r e_cᵀ − e_c e_rᵀ)), c = 1 … n−1 |
//! | dccsk321_u(w) | Σ w_rc Ad(the factors before) (e_r e_cᵀ − e_c e_rᵀ) |
//! | log(g) | exp(log g) = the rotation nearest to g |

use core::ops::{Add, Mul, Sub};

use faer::Mat;
use lieflow::scalar::DoubleDouble as Dd;

/// A square matrix in twice the precision.
#[derive(Clone, Debug)]
pub struct Matrix {
    n: usize,
    a: Vec<Dd>,
}

impl Matrix {
    /// The matrix of these entries.
    pub fn from_fn(n: usize, entry: impl Fn(usize, usize) -> Dd) -> Self {
        Matrix { n, a: (0..n * n).map(|k| entry(k / n, k % n)).collect() }
    }
    /// The number of rows.
    pub fn n(&self) -> usize {
        self.n
    }
    /// The exact value of a matrix of doubles.
    pub fn of(x: &Mat<f64>) -> Self {
        Self::from_fn(x.nrows(), |i, j| x[(i, j)].into())
    }
    fn identity(n: usize) -> Self {
        Self::from_fn(n, |i, j| f64::from(u8::from(i == j)).into())
    }
    /// The entry in row i and column j.
    pub fn at(&self, i: usize, j: usize) -> Dd {
        self.a[i * self.n + j]
    }
    /// Rounded to doubles.
    pub fn rounded(&self) -> Mat<f64> {
        Mat::from_fn(self.n, self.n, |i, j| self.at(i, j).value())
    }
    /// The Frobenius norm.
    pub fn norm(&self) -> f64 {
        self.a.iter().map(|x| x.value().powi(2)).sum::<f64>().sqrt()
    }
    fn scaled(&self, factor: impl Into<Dd>) -> Self {
        let factor = factor.into();
        Matrix { n: self.n, a: self.a.iter().map(|x| *x * factor).collect() }
    }
    fn skew_part(&self) -> Self {
        Self::from_fn(self.n, |i, j| (self.at(i, j) - self.at(j, i)) * 0.5.into())
    }
    /// self⁻¹ b, by elimination with pivots.
    fn solve(mut self, mut b: Matrix) -> Matrix {
        let n = self.n;
        for k in 0..n {
            let size = |row: &usize| self.at(*row, k).value().abs();
            let pivot = (k..n).max_by(|p, q| size(p).total_cmp(&size(q))).unwrap_or(k);
            for j in 0..n {
                self.a.swap(k * n + j, pivot * n + j);
                b.a.swap(k * n + j, pivot * n + j);
            }
            let top = self.at(k, k);
            for i in (0..n).filter(|i| *i != k) {
                let factor = self.at(i, k) / top;
                for j in 0..n {
                    self.a[i * n + j] = self.at(i, j) - factor * self.at(k, j);
                    b.a[i * n + j] = b.at(i, j) - factor * b.at(k, j);
                }
            }
        }
        Matrix::from_fn(n, |i, j| b.at(i, j) / self.at(i, i))
    }
}

impl Add for &Matrix {
    type Output = Matrix;
    fn add(self, other: &Matrix) -> Matrix {
        Matrix { n: self.n, a: self.a.iter().zip(&other.a).map(|(x, y)| *x + *y).collect() }
    }
}
impl Sub for &Matrix {
    type Output = Matrix;
    fn sub(self, other: &Matrix) -> Matrix {
        Matrix { n: self.n, a: self.a.iter().zip(&other.a).map(|(x, y)| *x - *y).collect() }
    }
}
impl Mul for &Matrix {
    type Output = Matrix;
    fn mul(self, other: &Matrix) -> Matrix {
        let entry = |i: usize, j: usize| {
            (0..self.n).fold(Dd::default(), |sum, k| sum + self.at(i, k) * other.at(k, j))
        };
        Matrix::from_fn(self.n, entry)
    }
}

/// The scaled argument has at most this norm, so that …
const SCALED: f64 = 1.0 / 16.0;
/// … this degree leaves 16⁻¹⁸/18! < 1e-37 of the series.
const DEGREE: u32 = 17;

/// How often u is halved before the series.
fn halvings(u: &Matrix) -> i32 {
    (u.norm() / SCALED).log2().ceil().max(0.0) as i32
}

/// exp(u).
pub fn exp(u: &Matrix) -> Matrix {
    let halvings = halvings(u);
    let x = u.scaled(0.5f64.powi(halvings));
    let one = Matrix::identity(u.n);
    let series = (1..=DEGREE).rev().fold(one.clone(), |sum, k| {
        &one + &(&x * &sum).scaled(Dd::from(1.0) / f64::from(k).into())
    });
    (0..halvings).fold(series, |g, _| &g * &g)
}

/// dexp_u(v), right trivialised: the derivative of the series and of the squarings, times exp(−u).
pub fn dexp(u: &Matrix, v: &Matrix) -> Matrix {
    let halvings = halvings(u);
    let scale = 0.5f64.powi(halvings);
    let (x, y) = (u.scaled(scale), v.scaled(scale));
    let one = Matrix::identity(u.n);
    let (mut g, mut dg) = (one.clone(), one.scaled(0.0));
    for k in (1..=DEGREE).rev() {
        let over_k = Dd::from(1.0) / f64::from(k).into();
        dg = (&(&x * &dg) + &(&y * &g)).scaled(over_k);
        g = &one + &(&x * &g).scaled(over_k);
    }
    for _ in 0..halvings {
        dg = &(&g * &dg) + &(&dg * &g);
        g = &g * &g;
    }
    &dg * &exp(&u.scaled(-1.0))
}

/// What a double-precision dΨ_u⁻¹ makes of a residual.
pub type Correct<'a> = dyn Fn(&Mat<f64>) -> Option<Mat<f64>> + 'a;

/// A residual of this size, relative to v and w, is that of a reference.
const SOLVED: f64 = 1e-27;

/// The w with `forward(w)` = v, by iterative refinement from zero. `None` if it is not found.
fn refined(
    v: &Matrix,
    forward: impl Fn(&Matrix) -> Matrix,
    correct: &Correct<'_>,
) -> Option<Matrix> {
    let mut w = v.scaled(0.0);
    let mut residual = v.clone();
    for _ in 0..12 {
        w = &w + &Matrix::of(&correct(&residual.rounded())?);
        residual = v - &forward(&w);
        if residual.norm() <= SOLVED * (v.norm() + w.norm()) {
            return Some(w);
        }
    }
    None
}

/// dexp_u⁻¹(v).
pub fn dexpinv(u: &Matrix, v: &Matrix, correct: &Correct<'_>) -> Option<Matrix> {
    refined(v, |w| dexp(u, w), correct)
}

/// cay(u).
pub fn cay(u: &Matrix) -> Matrix {
    let (one, half) = (Matrix::identity(u.n), u.scaled(0.5));
    (&one - &half).solve(&one + &half)
}

/// dcay_u⁻¹(v).
pub fn dcayinv(u: &Matrix, v: &Matrix) -> Matrix {
    let (one, half) = (Matrix::identity(u.n), u.scaled(0.5));
    &(&(&one - &half) * v) * &(&one + &half)
}

/// The planes of ccsk321 in their order, each with the cosine and sine of its angle.
fn planes(u: &Matrix) -> Vec<(usize, usize, [Dd; 2])> {
    let rotation = |angle: Dd| {
        let zero = Dd::default();
        let g = exp(&Matrix { n: 2, a: vec![zero, -angle, angle, zero] });
        [g.at(0, 0), g.at(1, 0)]
    };
    let places = (0..u.n).flat_map(|c| (c + 1..u.n).map(move |r| (r, c)));
    places.map(|(r, c)| (r, c, rotation(u.at(r, c)))).collect()
}

/// x ← G x, where G turns from e_c to e_r.
fn turn_rows(x: &mut Matrix, (r, c, [cos, sin]): (usize, usize, [Dd; 2])) {
    for j in 0..x.n {
        let (a, b) = (x.at(c, j), x.at(r, j));
        x.a[c * x.n + j] = cos * a - sin * b;
        x.a[r * x.n + j] = sin * a + cos * b;
    }
}

/// x ← x Gᵀ.
fn turn_columns(x: &mut Matrix, (r, c, [cos, sin]): (usize, usize, [Dd; 2])) {
    for i in 0..x.n {
        let (a, b) = (x.at(i, c), x.at(i, r));
        x.a[i * x.n + c] = cos * a - sin * b;
        x.a[i * x.n + r] = sin * a + cos * b;
    }
}

/// ccsk321(u) on so(n).
pub fn ccsk(u: &Matrix) -> Matrix {
    let mut g = Matrix::identity(u.n);
    for plane in planes(u).into_iter().rev() {
        turn_rows(&mut g, plane);
    }
    g
}

/// dccsk321_u⁻¹(v) on so(n).
pub fn dccskinv(u: &Matrix, v: &Matrix, correct: &Correct<'_>) -> Option<Matrix> {
    let planes = planes(u);
    let forward = |w: &Matrix| {
        // Horner's scheme: x ← w_k e_k + Ad(G_k) x, from the last factor to the first.
        let mut x = w.scaled(0.0);
        for &plane in planes.iter().rev() {
            turn_rows(&mut x, plane);
            turn_columns(&mut x, plane);
            let (r, c, _) = plane;
            x.a[r * x.n + c] = x.at(r, c) + w.at(r, c);
            x.a[c * x.n + r] = x.at(c, r) - w.at(r, c);
        }
        x
    };
    refined(v, forward, correct)
}

/// The logarithm of the rotation nearest to g, which is within 1e-9 of exp(`near`): one Newton step
/// g = (𝟙 + δ) exp(u), log g = u + dexp_u⁻¹(δ), with an error of δ².
pub fn log(g: &Matrix, near: &Matrix, correct: &Correct<'_>) -> Option<Matrix> {
    let delta = (&(g * &exp(&near.scaled(-1.0))) - &Matrix::identity(g.n)).skew_part();
    Some(near + &Matrix::of(&correct(&delta.rounded())?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn skew(n: usize, seed: f64) -> Matrix {
        let entry = |i: usize, j: usize| (seed * (i * n + j) as f64).sin();
        Matrix::from_fn(n, |i, j| (entry(i, j) - entry(j, i)).into())
    }
    fn gap(a: &Matrix, b: &Matrix) -> f64 {
        (a - b).norm()
    }

    #[test]
    fn a_turn_by_one_has_the_sine_of_one() {
        let u = Matrix::from_fn(3, |i, j| match (i, j) {
            (0, 1) => (-1.0).into(),
            (1, 0) => 1.0.into(),
            _ => 0.0.into(),
        });
        let sine = Dd::from(0.841_470_984_807_896_5) + 1.776_845_092_935_536e-18.into();
        let gap = (exp(&u).at(1, 0) - sine).value().abs();
        assert!(gap < 1e-30, "{gap:e}");
    }

    #[test]
    fn maps_stay_on_the_group_to_thirty_digits() {
        for (n, seed) in [(3, 0.7), (5, 1.3)] {
            let u = skew(n, seed);
            let one = Matrix::identity(n);
            for g in [exp(&u), cay(&u), ccsk(&u)] {
                let transposed = Matrix::from_fn(n, |i, j| g.at(j, i));
                assert!(gap(&(&transposed * &g), &one) < 1e-29);
            }
        }
    }

    #[test]
    fn differentials_are_those_of_their_maps() {
        let (u, v) = (skew(4, 0.9), skew(4, 1.7));
        let h = 1e-8;
        // Central differences in twice the precision: exact to h² and to 1e-32/h.
        let difference = |psi: fn(&Matrix) -> Matrix| {
            let ahead = psi(&(&u + &v.scaled(h)));
            let back = psi(&(&u - &v.scaled(h)));
            let inverse = Matrix::from_fn(4, |i, j| psi(&u).at(j, i));
            (&(&ahead - &back) * &inverse).scaled(0.5 / h)
        };
        assert!(gap(&difference(exp), &dexp(&u, &v)) < 1e-13);
        let w = difference(cay);
        assert!(gap(&dcayinv(&u, &w), &v) < 1e-13);
        // The identity as a correction: a fixed-point iteration, which converges near u = 0.
        let small = u.scaled(1e-6);
        let plain = |r: &Mat<f64>| Some(r.clone());
        let w = dexpinv(&small, &v, &plain).expect("converges");
        assert!(gap(&dexp(&small, &w), &v) < 1e-25);
        let w = dccskinv(&small, &v, &plain).expect("converges");
        let moved = |e: f64| ccsk(&(&small + &w.scaled(e)));
        let inverse = Matrix::from_fn(4, |i, j| ccsk(&small).at(j, i));
        let change = (&(&moved(h) - &moved(-h)) * &inverse).scaled(0.5 / h);
        assert!(gap(&change, &v) < 1e-13);
    }
}
