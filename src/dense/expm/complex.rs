//! exp of complex matrices, by the Taylor polynomials of [`taylor`](super::taylor).
//!
//! They are scaled by the norms of the powers. Cost: 3 to 5 products, and one for each squaring.
//!
//! On u(n) u is normal, so ‖u⁶‖₁^(1/6) bounds ‖u‖₂, and Newton–Schulz puts squared results back on U(n).

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par, c64};

use super::taylor::{
    B12, B18, T8, THETA_1, THETA_8, THETA_12, THETA_18, THETA_18_6, half_to_the, halvings,
    halvings_18,
};
use super::{Approximant, ExpmChoice, NORM_MAX_SKEW, Structure};
use crate::dense::schur::{ONE, ZERO};
use crate::error::StepError;
use crate::scalar::{Ops, tally};

/// The bound of the mean: e^mean must not underflow or overflow if the result does not.
const MEAN_MAX: f64 = 650.0;

/// exp of complex n×n matrices, with a workspace of eight matrices.
///
/// [`Structure::Skew`] says that u is skew-Hermitian, u ∈ u(n), so that exp(u) is unitary; the traceless
/// ones are su(n).
///
/// ```
/// use lieflow::faer::{Mat, c64};
/// use lieflow::dense::{ComplexExponential, Structure};
///
/// // exp(i θ σ_z) = diag(e^{iθ}, e^{−iθ})
/// let u = Mat::from_fn(2, 2, |i, j| c64::new(0.0, if i != j { 0.0 } else { 0.3 - 0.6 * i as f64 }));
/// let mut g = u.clone();
/// ComplexExponential::new(2).exp(&u, Structure::Skew, &mut g)?;
/// assert!((g[(0, 0)] - c64::new(0.3f64.cos(), 0.3f64.sin())).norm() < 1e-15);
/// # Ok::<(), lieflow::StepError>(())
/// ```
#[derive(Debug)]
pub struct ComplexExponential {
    /// a, a², a³, a⁶, where a is u, scaled, with or without its trace.
    powers: [Mat<c64>; 4],
    work: [Mat<c64>; 4],
    choice: ExpmChoice,
}

impl ComplexExponential {
    /// Makes the workspace for n×n matrices. Nothing allocates after this.
    pub fn new(n: usize) -> Self {
        let four = || core::array::from_fn(|_| Mat::zeros(n, n));
        ComplexExponential { powers: four(), work: four(), choice: ExpmChoice::default() }
    }

    /// The choice of the last call.
    pub fn choice(&self) -> ExpmChoice {
        self.choice
    }

    /// out ← exp(u), and which approximant was taken.
    ///
    /// On u(n) the relative error is a small multiple of ε·max(1, ‖u‖), and ‖out*out − 𝟙‖_F ≤ 8√n ε at every norm.
    /// Elsewhere it is a small multiple of ε times the condition number of exp at u, except for matrices far from normal.
    ///
    /// # Errors
    /// As [`Exponential::exp`](super::Exponential::exp).
    pub fn exp(
        &mut self,
        u: &Mat<c64>,
        structure: Structure,
        out: &mut Mat<c64>,
    ) -> Result<ExpmChoice, StepError> {
        let n = self.powers[0].nrows();
        StepError::check_shape("u", u.shape(), (n, n))?;
        StepError::check_shape("out", out.shape(), (n, n))?;
        let (norm, skew) = (norm1(u.as_ref()), structure == Structure::Skew);
        StepError::finite(norm.is_finite(), "the argument of exp")?;
        if skew && norm > NORM_MAX_SKEW {
            return Err(StepError::NormTooLarge { map: "exp" });
        }
        let taylor = |degree, squarings| ExpmChoice {
            kind: Approximant::Taylor,
            degree,
            squarings,
            ..ExpmChoice::default()
        };
        if norm <= THETA_1 {
            sum(out, [1.0], [u], 1.0);
            self.choice = taylor(1, 0);
            return Ok(self.choice);
        }
        self.powers[0].copy_from(u);
        let (shift, norm) = self.without_trace(norm);
        let (degree, squarings) = self.polynomial(norm, skew, out);
        self.choice = taylor(degree, squarings);
        let t = &mut self.work[0];
        for _ in 0..squarings {
            mul(t, Accum::Replace, out.as_ref(), out.as_ref());
            core::mem::swap(t, out);
        }
        if shift != ZERO {
            let factor = shift.exp();
            for_all(out, |x| x * factor);
        }
        if skew && squarings > 0 {
            self.choice.corrections = self.unitary(out);
        }
        match norm1(out.as_ref()).is_finite() || finite(out) {
            true => Ok(self.choice),
            false => Err(StepError::NotFinite { what: "exp(u)" }),
        }
    }

    /// a ← a − mean·𝟙 if that halves the norm. Returns the mean and the norm.
    fn without_trace(&mut self, norm: f64) -> (c64, f64) {
        let (n, zero) = (self.powers[0].nrows(), ZERO);
        let a = &mut self.powers[0];
        let mean = (0..n).map(|i| a[(i, i)] / n as f64).sum::<c64>();
        if norm <= THETA_18 || mean.norm() < 0.5 * norm / n as f64 || mean.re.abs() > MEAN_MAX {
            return (zero, norm);
        }
        let b = &mut self.work[0];
        b.copy_from(&*a);
        (0..n).for_each(|i| b[(i, i)] -= mean);
        let rest = norm1(b.as_ref());
        if rest > 0.5 * norm {
            return (zero, norm);
        }
        core::mem::swap(a, b);
        (mean, rest)
    }

    /// out ← a Taylor polynomial at 2⁻ˢa; returns its degree and s.
    fn polynomial(&mut self, norm: f64, skew: bool, out: &mut Mat<c64>) -> (usize, u32) {
        let ([a, a2, a3, a6], [t, v, w, x]) = (&mut self.powers, &mut self.work);
        // Scaled by the norm first, so that no power overflows; the powers then give halvings back.
        let by_norm = halvings(norm, THETA_18, 1);
        if by_norm > 0 {
            let f = half_to_the(by_norm);
            for_all(a, |x| x * f);
        }
        let norm = norm * half_to_the(by_norm);
        square(a2, a);
        if by_norm == 0 && norm <= THETA_8 {
            let [x1, x2, x3, x4, x5, x6, x7, y2] = T8;
            sum(t, [x1, x2], [a, a2], 0.0);
            mul(a3, Accum::Replace, a2.as_ref(), t.as_ref());
            sum(t, [x3, 1.0], [a2, a3], 0.0);
            sum(v, [x5, x6, x7], [a, a2, a3], x4);
            sum(out, [1.0, y2], [a, a2], 1.0);
            mul(out, Accum::Add, t.as_ref(), v.as_ref());
            return (8, 0);
        }
        mul(a3, Accum::Replace, a2.as_ref(), a.as_ref());
        if by_norm == 0 && norm <= THETA_12 {
            let all = [&*a, &*a2, &*a3];
            for (to, c) in [&mut *out, &mut *t, &mut *v, &mut *w].into_iter().zip(B12) {
                sum(to, [c[1], c[2], c[3]], all, c[0]);
            }
            mul(v, Accum::Add, w.as_ref(), w.as_ref());
            sum(x, [1.0, 1.0], [t, v], 0.0);
            mul(out, Accum::Add, x.as_ref(), v.as_ref());
            return (12, 0);
        }
        square(a6, a3);
        let [n2, n3, n6] = [&*a2, &*a3, &*a6].map(|x| norm1(x.as_ref()));
        let fits = |back: u32| {
            let f = 1.0 / half_to_the(back);
            let (f2, f3) = (f * f, f * f * f);
            match skew {
                true => n6 * (f3 * f3) <= THETA_18_6,
                false => halvings_18(norm * f, n2 * f2, n3 * f3, n6 * (f3 * f3)) == 0,
            }
        };
        let back = (0..by_norm).take_while(|back| fits(back + 1)).count() as u32;
        let f = 1.0 / half_to_the(back);
        let (f2, f3) = (f * f, f * f * f);
        let all = [&*a, &*a2, &*a3, &*a6];
        for (to, c) in [&mut *t, &mut *out, &mut *v, &mut *w, &mut *x].into_iter().zip(B18) {
            sum(to, [c[1] * f, c[2] * f2, c[3] * f3, c[4] * (f3 * f3)], all, c[0]);
        }
        mul(w, Accum::Add, t.as_ref(), x.as_ref());
        sum(t, [1.0, 1.0], [v, w], 0.0);
        mul(out, Accum::Add, t.as_ref(), w.as_ref());
        (18, by_norm - back)
    }

    /// g ← g + g(𝟙 − g*g)/2 until ‖𝟙 − g*g‖ is at rounding level.
    fn unitary(&mut self, g: &mut Mat<c64>) -> u32 {
        let [gram, half, ..] = &mut self.work;
        let mut steps = 0;
        while steps < 6 {
            steps += 1;
            tally_product(g.nrows(), Accum::Replace);
            matmul(gram.as_mut(), Accum::Replace, g.adjoint(), g.as_ref(), ONE, Par::Seq);
            sum(half, [-0.5], [gram], 0.5);
            let defect = norm1(half.as_ref());
            mul(gram, Accum::Replace, g.as_ref(), half.as_ref());
            tally(|| Ops::adds(2 * g.nrows() * g.ncols()));
            for j in 0..g.ncols() {
                for (x, dx) in g.col_as_slice_mut(j).iter_mut().zip(gram.col_as_slice(j)) {
                    *x += dx;
                }
            }
            // The next defect is the square of this one.
            if defect <= 1e-9 {
                break;
            }
        }
        steps
    }
}

/// A complex product is four real ones, and is counted so.
fn tally_product(n: usize, accum: Accum) {
    let more = if matches!(accum, Accum::Add) { 2 * n * n } else { 0 };
    tally(|| Ops::dots(2 * n * n, 2 * n) + Ops::adds(more));
}

fn mul(out: &mut Mat<c64>, accum: Accum, a: MatRef<'_, c64>, b: MatRef<'_, c64>) {
    tally_product(a.nrows(), accum);
    matmul(out.as_mut(), accum, a, b, ONE, Par::Seq);
}

fn square(out: &mut Mat<c64>, a: &Mat<c64>) {
    mul(out, Accum::Replace, a.as_ref(), a.as_ref());
}

/// out ← Σ c_i·x_i + d·𝟙.
fn sum<const K: usize>(out: &mut Mat<c64>, c: [f64; K], x: [&Mat<c64>; K], d: f64) {
    let (n, diagonal) = (out.nrows(), if d == 0.0 { 0 } else { out.nrows() });
    tally(|| Ops::dots(2 * n * n, K) + Ops::adds(diagonal));
    for j in 0..out.ncols() {
        let cols = x.map(|x| x.col_as_slice(j));
        let out = out.col_as_slice_mut(j);
        for (i, o) in out.iter_mut().enumerate() {
            *o = (0..K).map(|k| cols[k][i] * c[k]).sum();
        }
        if let Some(o) = out.get_mut(j) {
            o.re += d;
        }
    }
}

fn for_all(x: &mut Mat<c64>, f: impl Fn(c64) -> c64) {
    tally(|| Ops::muls(2 * x.nrows() * x.ncols()));
    for j in 0..x.ncols() {
        x.col_as_slice_mut(j).iter_mut().for_each(|x| *x = f(*x));
    }
}

/// The largest column sum of |re| + |im|; NaN when an entry is NaN.
fn norm1(x: MatRef<'_, c64>) -> f64 {
    tally(|| Ops::adds((2 * x.nrows()).saturating_sub(1) * x.ncols()));
    let mut best = 0.0;
    for col in x.col_iter() {
        let s: f64 = col.iter().map(|z| z.re.abs() + z.im.abs()).sum();
        if s > best || s.is_nan() {
            best = s;
        }
    }
    best
}

fn finite(x: &Mat<c64>) -> bool {
    (0..x.ncols()).all(|j| x.col_as_slice(j).iter().all(|z| z.re.is_finite() && z.im.is_finite()))
}
