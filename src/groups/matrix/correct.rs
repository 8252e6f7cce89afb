//! Corrects g to G_M: Newton–Schulz in residual form.
//!
//! With X♯ = M⁻¹XᵀM and D = 𝟙 − g♯g, the step g ← g(𝟙 + X) has to solve X + X♯ = D. It adds a small correction to g and
//! does not form g·(𝟙 + X), so its rounding error is that of the correction. X depends on P = M⁻ᵀM, with X♯♯ = P⁻¹XP:
//!
//! | P | X | residual after it |
//! |---|---|---|
//! | ±𝟙: M symmetric or skew | D/2 | O(D²) |
//! | P² = −𝟙 | (3D − 2D♯ + D♯♯)/4 | O(D²) |
//! | any other, 𝔤 skew: products of such | the same | \|1 + μ\|/2 of the one before, X♯♯ = μX |
//! | any other | 0 | no step is known to converge |
//! | where ‖M‖‖M⁻¹‖ is above 10 n | 0 | a step would move g by more than a run does |
//!
//! On U(m), with M = c𝟙 + K and P = K/c, an element is orthogonal and commutes with P. There the code subtracts the
//! part that does not commute, A = (g + PgP)/2. D is 𝟙 − gᵀg of the rest. This takes four products instead of nine. The
//! residual is ‖𝟙 − g♯g‖² = ‖D‖² + 2‖A‖², up to terms of higher order.

use faer::{ColMut, ColRef, Mat};

use super::parts::{has_scalar_part, symmetry};
use super::{Form, GroupMatrix, MatrixGroup};
use crate::dense::{axpy, mul, mul_add, norm_frobenius, scaled_sum};
use crate::groups::RESIDUAL_MAX;
use crate::so3::in_range;

/// The largest number of steps.
const STEPS_MAX: usize = 6;
/// A correction moves g by its rounding, ε‖g‖² of its size, where no step of a run needs more than ε. On a compact group
/// ‖g‖² is n. From this excess on it does more harm than good.
const LARGE: f64 = 2e-14;
/// One quadratic step takes a residual below this to rounding.
const ONE_STEP: f64 = 1e-8;

/// x ← x + ½x(|from|² − |x|²)/|from|² for a vector in parts, such as its real and its imaginary part. Returns
/// ||x|²/|from|² − 1|. It is [`LieGroup::correct_vector`](crate::LieGroup::correct_vector) of one vector.
pub(crate) fn correct_length<const N: usize>(
    from: [ColRef<'_, f64>; N],
    x: [ColMut<'_, f64>; N],
) -> f64 {
    let square = |parts: [ColRef<'_, f64>; N]| -> f64 {
        parts.iter().flat_map(|part| part.iter()).map(|x| x * x).sum()
    };
    let from2 = square(from);
    if !in_range(from2) {
        return 0.0;
    }
    let missing = (from2 - square(x.each_ref().map(|part| part.as_ref()))) / from2;
    if missing.abs() < RESIDUAL_MAX {
        x.into_iter().for_each(|part| part.iter_mut().for_each(|x| *x += 0.5 * missing * *x));
    }
    missing.abs()
}

/// Corrects two columns x and y, or one twice, that rounding moved off xᵀMy of `from`: with S = (M + Mᵀ)/2 and μ the missing
/// part over |Sx|² + |Sy|², x ← x + μSy and y ← y + μSx. To first order they are the nearest ones. Returns the missing part,
/// relative to |x||Sy|. It is [`LieGroup::correct_vector`](crate::LieGroup::correct_vector) of these columns. Without M it
/// is 𝟙.
///
/// They stay as they are where the rounding of xᵀMy moves them by more than a step does: where |Sy| is far below ‖S‖|y|.
pub(crate) fn correct_product(
    m: Option<&Mat<f64>>,
    from: &Mat<f64>,
    x: &mut Mat<f64>,
    [i, j]: [usize; 2],
) -> f64 {
    let n = x.nrows();
    // (Sx)_r of a column, and the same of moduli.
    let row = |x: ColRef<'_, f64>, r: usize| match m {
        None => (x[r], x[r].abs()),
        Some(m) => (0..n).fold((0.0, 0.0), |(sum, size), k| {
            let term = 0.5 * (m[(r, k)] + m[(k, r)]) * x[k];
            (sum + term, size + term.abs())
        }),
    };
    let product = |x: &Mat<f64>| (0..n).map(|r| x[(r, i)] * row(x.col(j), r).0).sum::<f64>();
    let (mut squares, mut lengths, mut size) = ([0.0; 2], [0.0; 2], 0.0);
    for r in 0..n {
        let [(first, _), (second, most)] = [i, j].map(|column| row(x.col(column), r));
        squares = [squares[0] + first * first, squares[1] + second * second];
        lengths = [lengths[0] + x[(r, i)] * x[(r, i)], lengths[1] + x[(r, j)] * x[(r, j)]];
        size += most * x[(r, i)].abs();
    }
    if lengths.iter().any(|x| x.is_nan()) {
        return f64::NAN;
    }
    if !squares.iter().chain(&lengths).all(|x| in_range(*x)) {
        return 0.0;
    }
    let missing = product(from) - product(x);
    let unit = lengths[0].sqrt() * squares[1].sqrt();
    let residual = missing.abs() / unit;
    if residual < RESIDUAL_MAX && f64::EPSILON * size <= LARGE * unit {
        let mu = missing / (squares[0] + squares[1]);
        // Each row sees those before it moved: a change of second order.
        for r in 0..n {
            let [along_i, along_j] = [i, j].map(|column| row(x.col(column), r).0);
            x[(r, i)] += mu * along_j;
            if i != j {
                x[(r, j)] += mu * along_i;
            }
        }
    }
    residual
}

/// The kind of P.
#[derive(Clone, Debug)]
pub(super) enum Cosquare {
    /// P = ±𝟙.
    One,
    /// P² = −𝟙.
    Quarter,
    /// P, where M is a multiple of 𝟙 + P and P² = −𝟙.
    Unitary(Mat<f64>),
    /// P is orthogonal.
    Orthogonal,
    /// Nothing.
    Other,
}

impl Cosquare {
    pub(super) fn of(form: &Form) -> Self {
        let Form::Bilinear { m, inverse } = form else { return Cosquare::One };
        if symmetry(m).is_some() {
            return Cosquare::One;
        }
        let n = m.nrows();
        let p = inverse.transpose() * m;
        let (square, gram) = (&p * &p, p.transpose() * &p);
        let one = Mat::<f64>::identity(n, n);
        let tolerance = 1e-10 * norm_frobenius(&p).powi(2);
        if norm_frobenius(&(square + &one)) <= tolerance {
            match has_scalar_part(m) {
                true => Cosquare::Unitary(p),
                false => Cosquare::Quarter,
            }
        } else if norm_frobenius(&(gram - &one)) <= tolerance {
            Cosquare::Orthogonal
        } else {
            Cosquare::Other
        }
    }
}

impl MatrixGroup {
    /// [`LieGroup::residual_size`](crate::LieGroup::residual_size) of the element with this matrix.
    pub fn residual_size_of(&self, g: &Mat<f64>) -> f64 {
        let scale = if self.is_stretched() { self.stretch } else { 1.0 };
        match self.form {
            Form::Identity => 1.0,
            _ => scale * norm_frobenius(g).powi(2).max(1.0),
        }
    }

    /// [`LieGroup::correct`](crate::LieGroup::correct).
    pub(super) fn newton_schulz(&self, g: &mut GroupMatrix, [a, b]: [&mut GroupMatrix; 2]) -> f64 {
        let mut first = None;
        for _ in 0..STEPS_MAX {
            let residual = match &self.cosquare {
                Cosquare::Unitary(p) => residual_of_unitary(g, p, a, b),
                _ => {
                    self.residual_of(g, a, b);
                    norm_frobenius(a)
                }
            };
            first.get_or_insert(residual);
            // The rounding of g♯g: ε‖g‖², and half of that where g is orthogonal.
            let (square, n) = (norm_frobenius(g).powi(2), self.n as f64);
            let noise = f64::EPSILON * (square - 0.5 * n);
            let is_large = f64::EPSILON * (square - n) > LARGE;
            let reach = residual > noise && residual < RESIDUAL_MAX && !is_large;
            // With a stretched M a rounding of g is a large residual, and X = D/2 is not the least correction.
            if !reach || self.is_stretched() || matches!(self.cosquare, Cosquare::Other) {
                break;
            }
            let quadratic = match (&self.form, &self.cosquare) {
                (_, Cosquare::Unitary(_)) => {
                    g.copy_from(&**b);
                    mul_add(g, 0.5, b.as_ref(), a.as_ref());
                    true
                }
                (Form::Bilinear { m, inverse }, Cosquare::Quarter | Cosquare::Orthogonal) => {
                    // X = ¾D − ½Y♯ with Y = D − ½D♯; g moves in between, which is of second order.
                    mul(b, g.as_ref(), a.as_ref());
                    axpy(0.75, b, g);
                    mul(b, a.transpose(), m.as_ref());
                    mul_add(a, -0.5, inverse.as_ref(), b.as_ref());
                    mul(b, a.transpose(), m.as_ref());
                    mul(a, inverse.as_ref(), b.as_ref());
                    mul(b, g.as_ref(), a.as_ref());
                    axpy(-0.5, b, g);
                    matches!(self.cosquare, Cosquare::Quarter)
                }
                _ => {
                    mul(b, g.as_ref(), a.as_ref());
                    axpy(0.5, b, g);
                    true
                }
            };
            if residual < ONE_STEP && quadratic {
                break;
            }
        }
        first.unwrap_or(0.0)
    }

    /// a ← D = 𝟙 − M⁻¹gᵀMg, b scratch.
    fn residual_of(&self, g: &Mat<f64>, a: &mut Mat<f64>, b: &mut Mat<f64>) {
        match &self.form {
            Form::Free => {
                a.fill(0.0);
                return;
            }
            Form::Identity => mul(b, g.transpose(), g.as_ref()),
            Form::Symplectic => {
                times_j(g, 1.0, a);
                mul(b, g.transpose(), a.as_ref());
                times_j(b, -1.0, a);
                scaled_sum(b, [1.0], [a], 0.0);
            }
            Form::Bilinear { m, inverse } => {
                mul(b, m.as_ref(), g.as_ref());
                mul(a, g.transpose(), b.as_ref());
                mul(b, inverse.as_ref(), a.as_ref());
            }
        }
        scaled_sum(a, [-1.0], [b], 1.0);
    }
}

/// b ← g without the part that does not commute with P, a ← 𝟙 − bᵀb; the residual of g.
fn residual_of_unitary(g: &Mat<f64>, p: &Mat<f64>, a: &mut Mat<f64>, b: &mut Mat<f64>) -> f64 {
    mul(a, g.as_ref(), p.as_ref());
    mul(b, p.as_ref(), a.as_ref());
    scaled_sum(a, [0.5, 0.5], [g, b], 0.0);
    let away = norm_frobenius(a);
    scaled_sum(b, [1.0, -1.0], [g, a], 0.0);
    mul(a, b.transpose(), b.as_ref());
    a.col_iter_mut().for_each(|col| col.iter_mut().for_each(|x| *x = -*x));
    a.diagonal_mut().column_vector_mut().iter_mut().for_each(|x| *x += 1.0);
    norm_frobenius(a).hypot(core::f64::consts::SQRT_2 * away)
}

/// out ← ±J·x.
fn times_j(x: &Mat<f64>, sign: f64, out: &mut Mat<f64>) {
    let m = x.nrows() / 2;
    for j in 0..x.ncols() {
        let (x, out) = (x.col_as_slice(j), out.col_as_slice_mut(j));
        for i in 0..m {
            out[i] = sign * x[i + m];
            out[i + m] = -sign * x[i];
        }
    }
}
