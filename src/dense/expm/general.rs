//! exp of a general matrix, with balancing, trace reduction, norms of powers, and triangular squaring.
//!
//! Sources: A. H. Al-Mohy, N. J. Higham, A new scaling and squaring algorithm for the matrix
//! exponential, SIAM J. Matrix Anal. Appl. 31 (2009) 970–989 (scaling by ‖aᵏ‖^(1/k) with the safeguard
//! ℓ, and the triangular squaring of its code fragment 2.1); B. N. Parlett, C. Reinsch, Balancing a
//! matrix for calculation of eigenvalues and eigenvectors, Numer. Math. 13 (1969).

use faer::Mat;

use super::pade::THETA;
use super::taylor::{B12, B18, T8, THETA_1, THETA_8, THETA_12, half_to_the, halvings, halvings_18};
use super::{Approximant, Expm, ExpmChoice};
use crate::dense::ops::{abs_mul, abs_sums, axpy, norm1, scaled_sum, scaled_sums};
use crate::dense::product::{mul, mul_add};
use crate::scalar::{Ops, tally};

const THETA_13: f64 = THETA[4].1;

#[derive(Clone, Copy, PartialEq)]
enum Shape {
    Full,
    Upper,
    Lower,
}

impl Expm {
    /// out ← exp(x) for finite x.
    pub(super) fn exp_general(&mut self, x: &Mat<f64>, pade_only: bool, out: &mut Mat<f64>) {
        let norm = norm1(x.as_ref());
        if norm <= THETA_1 {
            scaled_sum(out, [1.0], [x], 1.0);
            self.choice = ExpmChoice { kind: Approximant::Taylor, degree: 1, ..Default::default() };
            return;
        }
        self.a.copy_from(x);
        if norm > 1.0 && !self.is_balanced() {
            if self.balance(norm) {
                self.exp_of_a(norm1(self.a.as_ref()), pade_only, out);
                if self.unbalance(norm, out) {
                    self.choice.balanced = true;
                    return;
                }
            }
            self.a.copy_from(x);
        }
        self.exp_of_a(norm, pade_only, out);
    }

    /// out ← exp(a), with ‖a‖₁. a is overwritten.
    fn exp_of_a(&mut self, mut norm: f64, pade_only: bool, out: &mut Mat<f64>) {
        let n = self.a.nrows();
        let shape = shape(&self.a);
        if shape == Shape::Lower {
            self.t.copy_from(&self.a);
            self.a.copy_from(self.t.transpose());
            norm = norm1(self.a.as_ref());
        }
        let mut shift = 0.0;
        if shape == Shape::Full && norm > THETA_13 {
            let mean = (0..n).map(|i| self.a[(i, i)] / n as f64).sum::<f64>();
            // e^mean must neither vanish nor overflow where the result does not.
            if mean.abs() > 1.0 && mean.abs() <= 650.0 {
                scaled_sum(&mut self.t, [1.0], [&self.a], -mean);
                let reduced = norm1(self.t.as_ref());
                if reduced <= 50.0 && reduced <= 0.5 * norm {
                    core::mem::swap(&mut self.t, &mut self.a);
                    (shift, norm) = (mean, reduced);
                }
            }
        }
        let mut choice = ExpmChoice::default();
        let taylor = match shape {
            Shape::Full if !pade_only => self.taylor(norm, out),
            _ => None,
        };
        (choice.kind, choice.degree, choice.squarings) = match taylor {
            Some((degree, squarings)) => (Approximant::Taylor, degree, squarings),
            None => {
                let (degree, squarings) = self.scaled_pade(norm, out);
                (Approximant::Pade, degree, squarings)
            }
        };
        let upper = shape != Shape::Full && choice.squarings > 0;
        if upper {
            exact_bands(&self.a, 1.0, out);
        }
        let mut factor = 1.0;
        for _ in 0..choice.squarings {
            mul(&mut self.t, out.as_ref(), out.as_ref());
            core::mem::swap(&mut self.t, out);
            if upper {
                factor *= 2.0;
                exact_bands(&self.a, factor, out);
            }
        }
        if shape == Shape::Lower {
            self.t.copy_from(&*out);
            out.copy_from(self.t.transpose());
        }
        if shift != 0.0 {
            tally(|| Ops::muls(n * n) + Ops::trigs(1));
            *out *= faer::Scale(shift.exp());
        }
        self.choice = choice;
    }

    /// True if balancing would change no row and no column.
    fn is_balanced(&mut self) -> bool {
        let [rows, cols] = &mut self.vectors;
        abs_sums(&self.a, rows, cols);
        rows.iter().zip(cols.iter()).all(|(r, c)| imbalance(*c, *r).is_none())
    }

    /// a ← D⁻¹aD with powers of two in D, until rows and columns have about the same size. True if the norm is then
    /// four times smaller; otherwise a is undefined.
    fn balance(&mut self, norm: f64) -> bool {
        let n = self.a.nrows();
        self.exponents.fill(0);
        for _ in 0..40 {
            let mut changed = false;
            for i in 0..n {
                let (mut c, mut r) = (0.0, 0.0);
                for j in (0..n).filter(|&j| j != i) {
                    c += self.a[(j, i)].abs();
                    r += self.a[(i, j)].abs();
                }
                let Some(k) = imbalance(c, r) else { continue };
                let (up, down) = (2f64.powi(k), 2f64.powi(-k));
                let e = self.exponents[i] + k;
                if e.abs() > 1000 {
                    continue;
                }
                for j in (0..n).filter(|&j| j != i) {
                    self.a[(j, i)] *= up;
                    self.a[(i, j)] *= down;
                }
                self.exponents[i] = e;
                changed = true;
            }
            if !changed {
                break;
            }
        }
        norm1(self.a.as_ref()) <= 0.25 * norm
    }

    /// out ← D·out·D⁻¹. False if this may cost more digits than the smaller norm has saved.
    ///
    /// Before it the rounding error is ε‖out‖ in every entry. If the entries of D differ much and those of the result
    /// do not (a permuted triangle, D. S. Watkins, A case where balancing is harmful, ETNA 23 (2006)), some errors
    /// become larger than expected from ‖x‖ = `norm`.
    fn unbalance(&mut self, norm: f64, out: &mut Mat<f64>) -> bool {
        let before = norm1(out.as_ref()).log2();
        let mut steepest = 0;
        for j in 0..out.ncols() {
            for i in 0..out.nrows() {
                let x = &mut out[(i, j)];
                if *x != 0.0 {
                    // In two factors: the quotient of two scales may leave the range.
                    let e = self.exponents[i] - self.exponents[j];
                    let half = e / 2;
                    *x *= 2f64.powi(half);
                    *x *= 2f64.powi(e - half);
                    steepest = steepest.max(e);
                }
            }
        }
        before + f64::from(steepest) <= norm1(out.as_ref()).log2() + norm.log2() + 3.0
    }

    /// out ← a Taylor polynomial at 2⁻ˢa, if it is as good as Padé. Returns its degree and s. The solve of Padé, with n
    /// right-hand sides, costs more than the two or three squarings that it saves.
    fn taylor(&mut self, norm: f64, out: &mut Mat<f64>) -> Option<(usize, u32)> {
        if norm > 1e3 {
            return None;
        }
        let Expm { a, a2, a4, a6, u, v, t, lu, .. } = self;
        mul(a2, a.as_ref(), a.as_ref());
        if norm <= THETA_8 {
            let [x1, x2, x3, x4, x5, x6, x7, y2] = T8;
            scaled_sum(t, [x1, x2], [a, a2], 0.0);
            mul(a4, a2.as_ref(), t.as_ref());
            scaled_sum(u, [x3, 1.0], [a2, a4], 0.0);
            scaled_sum(v, [x5, x6, x7], [a, a2, a4], x4);
            scaled_sum(out, [1.0, y2], [a, a2], 1.0);
            mul_add(out, 1.0, u.as_ref(), v.as_ref());
            return Some((8, 0));
        }
        let a3 = a4;
        mul(a3, a2.as_ref(), a.as_ref());
        // ‖a‖ as the powers see it: the error begins at a¹³ or a¹⁹, sums of a² and a³.
        let alpha = norm.min(norm1(a2.as_ref()).sqrt().max(norm1(a3.as_ref()).cbrt()));
        if norm > 8.0 * alpha.max(THETA_12) {
            return None;
        }
        if alpha <= THETA_12 {
            let [b0, b1, b2, b3] = B12;
            let c = [b0, b1, b2, b3].map(|c| [c[1], c[2], c[3]]);
            let d = [b0[0], b1[0], b2[0], b3[0]];
            scaled_sums([&mut *out, &mut *t, &mut *v, &mut *u], c, [&*a, &*a2, &*a3], d);
            mul_add(v, 1.0, u.as_ref(), u.as_ref());
            axpy(1.0, v, t);
            mul_add(out, 1.0, t.as_ref(), v.as_ref());
            return Some((12, 0));
        }
        mul(a6, a3.as_ref(), a3.as_ref());
        let [n2, n3, n6] = [&*a2, &*a3, &*a6].map(|x| norm1(x.as_ref()));
        let s = halvings_18(norm, n2, n3, n6);
        let f = half_to_the(s);
        let (f2, f3) = (f * f, f * f * f);
        let c = B18.map(|c| [c[1] * f, c[2] * f2, c[3] * f3, c[4] * (f3 * f3)]);
        let d = B18.map(|c| c[0]);
        let w = &mut lu.a;
        scaled_sums([&mut *u, &mut *out, &mut *w, &mut *v, &mut *t], c, [&*a, &*a2, &*a3, &*a6], d);
        mul_add(v, 1.0, u.as_ref(), t.as_ref());
        axpy(1.0, v, w);
        mul_add(out, 1.0, w.as_ref(), v.as_ref());
        Some((18, s))
    }

    /// out ← a Padé approximant at 2⁻ˢa; a is scaled. Returns its degree and s.
    pub(super) fn scaled_pade(&mut self, norm: f64, out: &mut Mat<f64>) -> (usize, u32) {
        if let Some((degree, _)) = THETA[..4].iter().find(|(_, theta)| norm <= *theta) {
            self.even_powers(*degree);
            self.pade(*degree, out);
            return (*degree, 0);
        }
        // The norm alone asks for s halvings; the powers may allow `back` of them to be undone.
        let s = halvings(norm, THETA_13, 1);
        tally(|| Ops::muls(self.a.nrows() * self.a.ncols()));
        self.a *= faer::Scale(half_to_the(s));
        self.even_powers(13);
        let d4 = norm1(self.a4.as_ref()).sqrt().sqrt();
        let d6 = norm1(self.a6.as_ref()).cbrt().sqrt();
        let alpha = d4.max(d6);
        let room = if alpha > 0.0 { (THETA_13 / alpha).log2().floor() } else { 80.0 };
        let mut back = room.clamp(0.0, f64::from(s.min(80))) as u32;
        if back > 0 {
            back -= self.safeguard(norm * half_to_the(s), back).min(back);
        }
        if back > 0 {
            let f = 2f64.powi(back as i32);
            let Expm { a, a2, a4, a6, .. } = self;
            for (x, f) in [(a, f), (a2, f * f), (a4, f.powi(4)), (a6, f.powi(6))] {
                tally(|| Ops::muls(x.nrows() * x.ncols()));
                *x *= faer::Scale(f);
            }
        }
        self.pade(13, out);
        (13, s - back)
    }

    /// ℓ₁₃(2ᵇa): the halvings that keep the backward error of the rounded evaluation below 2⁻⁵³:
    /// ⌈log₂(c₁₃·‖|2ᵇa|²⁷‖/‖2ᵇa‖·2⁵³)/26⌉.
    fn safeguard(&mut self, norm: f64, b: u32) -> u32 {
        /// log₂ of 13!²/(26!·27!), the first coefficient of the backward error.
        const LOG2_C13: f64 = -116.44;
        let [x, y] = &mut self.vectors;
        x.fill(1.0);
        let mut log2 = 0.0;
        for _ in 0..27 {
            let top = abs_mul(&self.a, x, y);
            if top == 0.0 || !top.is_finite() {
                return 0;
            }
            log2 += top.log2();
            tally(|| Ops::divs(x.len()) + Ops::trigs(1));
            for (x, y) in x.iter_mut().zip(y.iter()) {
                *x = y / top;
            }
        }
        let alpha = LOG2_C13 + log2 - norm.log2() + 26.0 * f64::from(b);
        ((alpha + 53.0) / 26.0).ceil().max(0.0) as u32
    }
}

/// The power of two that makes a column of size c and a row of size r equally large, if this makes their sum smaller.
fn imbalance(c: f64, r: f64) -> Option<i32> {
    // Most pairs are within a factor of two; no logarithm is needed to see it.
    if c == 0.0 || r == 0.0 || !f64::is_finite(c + r) || (c < 2.0 * r && r < 2.0 * c) {
        return None;
    }
    let k = (0.5 * (r.log2() - c.log2())).round().clamp(-500.0, 500.0) as i32;
    let better = c * 2f64.powi(k) + r * 2f64.powi(-k) < 0.95 * (c + r);
    (k != 0 && better).then_some(k)
}

fn shape(a: &Mat<f64>) -> Shape {
    let n = a.nrows();
    if (0..n).all(|j| a.col_as_slice(j)[j + 1..].iter().all(|x| *x == 0.0)) {
        Shape::Upper
    } else if (0..n).all(|j| a.col_as_slice(j)[..j].iter().all(|x| *x == 0.0)) {
        Shape::Lower
    } else {
        Shape::Full
    }
}

/// The diagonal and the first superdiagonal of exp(c·a) for upper triangular a, from their formulas.
fn exact_bands(a: &Mat<f64>, c: f64, out: &mut Mat<f64>) {
    // A product and an exponential on the diagonal; three and two of a quotient beside it.
    tally(|| (Ops::muls(4) + Ops::adds(2) + Ops::divs(1) + Ops::trigs(3)) * a.ncols());
    for j in 0..a.ncols() {
        let y = c * a[(j, j)];
        out[(j, j)] = y.exp();
        if j > 0 {
            out[(j - 1, j)] = c * a[(j - 1, j)] * exp_difference(c * a[(j - 1, j - 1)], y);
        }
    }
}

/// (eˣ − eʸ)/(x − y).
fn exp_difference(x: f64, y: f64) -> f64 {
    let (low, gap) = (x.min(y), (x - y).abs());
    if gap == 0.0 {
        x.exp()
    } else if gap < 1.0 {
        low.exp() * (gap.exp_m1() / gap)
    } else {
        (x.max(y).exp() - low.exp()) / gap
    }
}
