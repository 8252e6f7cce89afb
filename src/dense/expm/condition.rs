//! The condition number of exp(u), and exp(u)·x without exp(u).

use faer::{Mat, MatRef};

use super::{ExpmChoice, Exponential, Structure};
use crate::dense::ops::{is_finite, norm_frobenius, norm1};
use crate::dense::product::mul;
use crate::error::StepError;

/// How exp(u)·x was computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ApplyChoice {
    /// exp(u) was formed.
    Formed(ExpmChoice),
    /// The Taylor series of exp(u/s)·x, s times.
    Series {
        /// The number s of parts.
        steps: u32,
        /// The number of products u·x.
        products: u32,
    },
}

impl Exponential {
    /// Estimates the relative condition number of exp at u from below.
    ///
    /// It is ‖L‖_F ‖u‖_F/‖exp(u)‖_F with the Fréchet derivative L, by at most five rounds of the power method on L*L. The
    /// expected error of exp(u) is ε times this number. Allocates; the cost is that of ten exponentials of size 2n.
    ///
    /// # Errors
    /// As [`exp`](Self::exp).
    pub fn condition(u: &Mat<f64>) -> Result<f64, StepError> {
        let n = u.nrows();
        StepError::check_shape("u", u.shape(), (n, n))?;
        let size = norm_frobenius(u);
        if size == 0.0 || n == 0 {
            return Ok(0.0);
        }
        let transposed = u.transpose().to_owned();
        let (mut wide, mut block) = (Exponential::new(2 * n), Mat::zeros(2 * n, 2 * n));
        let mut image = block.clone();
        let mut e = Mat::from_fn(n, n, |i, j| 1.0 + ((3 * i + 5 * j) % 7) as f64 / 8.0);
        let (mut best, mut value) = (0.0f64, 1.0);
        // The derivative is linear in e; small enough not to overflow where exp(u) does not.
        let small = 0.5 * size.min(1.0);
        for _ in 0..5 {
            // exp[u e; 0 u] = [exp(u) L(u, e); 0 exp(u)], and L(u, ·)* = L(uᵀ, ·).
            for a in [u, &transposed] {
                let (top, rest) = scaled_norm(e.as_ref());
                if top == 0.0 {
                    return Ok(best * size);
                }
                let scale = small / rest;
                for j in 0..n {
                    for i in 0..n {
                        block[(i, j)] = a[(i, j)];
                        block[(i + n, j + n)] = a[(i, j)];
                        block[(i, j + n)] = scale * (e[(i, j)] / top);
                    }
                }
                wide.exp(&block, Structure::General, &mut image)?;
                for j in 0..n {
                    for i in 0..n {
                        e[(i, j)] = image[(i, j + n)];
                    }
                }
                let (top, rest) = scaled_norm(e.as_ref());
                let (top_g, rest_g) = scaled_norm(image.as_ref().submatrix(0, 0, n, n));
                value = (top / top_g) * (rest / rest_g) / small;
            }
            if value <= 1.01 * best {
                break;
            }
            best = value;
        }
        Ok(best.max(value) * size)
    }

    /// x ← exp(u)·x for the columns of x, by the cheaper of two ways.
    ///
    /// The first is the series of exp(u/s)x, with about 11‖u‖₁ products u·x. The second forms exp(u). Allocates three
    /// matrices of the size of x, and one n×n if exp(u) is formed.
    ///
    /// # Errors
    /// As [`exp`](Self::exp); [`StepError::Shape`] also if x does not have n rows.
    pub fn apply(
        &mut self,
        u: &Mat<f64>,
        structure: Structure,
        x: &mut Mat<f64>,
    ) -> Result<ApplyChoice, StepError> {
        let (n, k) = (self.0.a.nrows(), x.ncols());
        StepError::check_shape("u", u.shape(), (n, n))?;
        StepError::check_shape("x", x.shape(), (n, k))?;
        let norm = norm1(u.as_ref());
        StepError::finite(norm.is_finite(), "the argument of exp")?;
        // Without columns there is nothing to do, however large u is.
        if k == 0 {
            return Ok(ApplyChoice::Series { steps: 0, products: 0 });
        }
        if 11.0 * norm.max(1.0) * k as f64 > 5.0 * n as f64 {
            let mut g = Mat::zeros(n, n);
            let choice = self.exp(u, structure, &mut g)?;
            let y = x.clone();
            mul(x, g.as_ref(), y.as_ref());
            return finite(x, ApplyChoice::Formed(choice));
        }
        // Terms grow to e²/√(4π) at most, so that no more than a digit is lost in a step.
        let steps = (0.5 * norm).ceil().max(1.0) as u32;
        let (mut term, mut next) = (x.clone(), x.clone());
        let mut products = 0;
        for _ in 0..steps {
            term.copy_from(&*x);
            let mut last = norm_frobenius(&term);
            for m in 1..40 {
                mul(&mut next, u.as_ref(), term.as_ref());
                core::mem::swap(&mut next, &mut term);
                term *= faer::Scale(1.0 / (f64::from(m) * f64::from(steps)));
                *x += &term;
                products += 1;
                let size = norm_frobenius(&term);
                if size + last <= 0.5 * f64::EPSILON * norm_frobenius(x) {
                    break;
                }
                last = size;
            }
        }
        finite(x, ApplyChoice::Series { steps, products })
    }

    /// ‖gᵀg − 𝟙‖_F, the residual of a rotation. Allocates.
    pub fn residual(g: &Mat<f64>) -> f64 {
        norm_frobenius(&(g.transpose() * g - Mat::<f64>::identity(g.ncols(), g.ncols())))
    }
}

fn finite(x: &Mat<f64>, choice: ApplyChoice) -> Result<ApplyChoice, StepError> {
    match is_finite(x) {
        true => Ok(choice),
        false => Err(StepError::NotFinite { what: "exp(u)·x" }),
    }
}

/// max|x_ij| and ‖x‖_F/max|x_ij|. Their product may overflow although no entry does.
fn scaled_norm(x: MatRef<'_, f64>) -> (f64, f64) {
    let top = x.norm_max();
    let mut sum = 0.0;
    for j in 0..x.ncols() {
        for i in 0..x.nrows() {
            sum += (x[(i, j)] / top) * (x[(i, j)] / top);
        }
    }
    (top, sum.sqrt())
}
