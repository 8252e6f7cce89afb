//! The matrix exponential: Padé approximants with scaling and squaring, in a reusable workspace.
//!
//! Source: N. J. Higham, The scaling and squaring method for the matrix exponential revisited,
//! SIAM J. Matrix Anal. Appl. 26 (2005). The degree m ∈ {3, 5, 7, 9, 13} is the first whose bound
//! θ_m reaches the norm of u; beyond θ_13 u is halved s times and the result squared s times.

mod cols;
mod small;
mod taylor;

use faer::Mat;

use super::ops::{mul, mul_add, norm1, scaled_sum};
use super::{Lu, is_finite};
use crate::error::StepError;

/// The kind of an approximant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// The \[m/m\] Padé approximant.
    #[default]
    Pade,
    /// The Taylor polynomial of degree m.
    Taylor,
}

/// Which approximant was taken. Tests assert it, not only the result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExpmChoice {
    /// Padé or products only.
    pub kind: Kind,
    /// Its degree m.
    pub degree: usize,
    /// Number s of squarings.
    pub squarings: u32,
    /// Newton–Schulz corrections that put the result back on SO(n).
    pub corrections: u32,
}

/// What is known of the argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// Nothing.
    General,
    /// u is skew-symmetric, so that exp(u) is a rotation.
    Skew,
}

const C3: &[f64] = &[120., 60., 12., 1.];
const C5: &[f64] = &[30240., 15120., 3360., 420., 30., 1.];
const C7: &[f64] = &[17297280., 8648640., 1995840., 277200., 25200., 1512., 56., 1.];
#[rustfmt::skip]
const C9: &[f64] = &[
    17643225600., 8821612800., 2075673600., 302702400., 30270240., 2162160., 110880., 3960., 90., 1.,
];
#[rustfmt::skip]
const C13: &[f64] = &[
    64764752532480000., 32382376266240000., 7771770303897600., 1187353796428800., 129060195264000.,
    10559470521600., 670442572800., 33522128640., 1323241920., 40840800., 960960., 16380., 182., 1.,
];
/// (degree, θ_m for f64, coefficients).
const PADE: [(usize, f64, &[f64]); 5] = [
    (3, 1.495585217958292e-2, C3),
    (5, 2.53939833006323e-1, C5),
    (7, 9.504178996162932e-1, C7),
    (9, 2.097847961257068, C9),
    (13, 5.371920351148152, C13),
];

/// Above this norm no digit of a rotation's angle has a meaning.
const NORM_MAX_SKEW: f64 = 1e15;

/// The exponential of n×n matrices, with its workspace.
#[derive(Debug)]
pub struct Exponential(Expm);

impl Exponential {
    /// Workspace for n×n matrices.
    pub fn new(n: usize) -> Self {
        Exponential(Expm::new(n))
    }
    /// out ← exp(x).
    ///
    /// # Errors
    /// As above.
    pub fn exp(
        &mut self,
        x: &Mat<f64>,
        structure: Structure,
        out: &mut Mat<f64>,
    ) -> Result<ExpmChoice, StepError> {
        self.0.exp(x, structure, out)?;
        Ok(self.0.choice)
    }
    /// The last choice.
    pub fn choice(&self) -> ExpmChoice {
        self.0.choice
    }
}

/// Workspace for exp of n×n matrices.
#[derive(Debug)]
pub(crate) struct Expm {
    arch: pulp::Arch,
    a: Mat<f64>,
    a2: Mat<f64>,
    a4: Mat<f64>,
    a6: Mat<f64>,
    u: Mat<f64>,
    v: Mat<f64>,
    t: Mat<f64>,
    lu: Lu,
    /// What the last call chose.
    pub(crate) choice: ExpmChoice,
}

impl Expm {
    pub(crate) fn new(n: usize) -> Self {
        let z = || Mat::zeros(n, n);
        Expm {
            arch: pulp::Arch::new(),
            a: z(),
            a2: z(),
            a4: z(),
            a6: z(),
            u: z(),
            v: z(),
            t: z(),
            lu: Lu::new(n),
            choice: ExpmChoice::default(),
        }
    }

    /// out ← exp(x).
    ///
    /// # Errors
    /// [`StepError::NotFinite`] when x or exp(x) is not finite, [`StepError::NormTooLarge`] for a
    /// skew x beyond 1e15.
    pub(crate) fn exp(
        &mut self,
        x: &Mat<f64>,
        structure: Structure,
        out: &mut Mat<f64>,
    ) -> Result<(), StepError> {
        if x.nrows() <= small::N_MAX
            && let Some(choice) = small::exp(self.arch, x, structure, out)
        {
            self.choice = choice;
            return Ok(());
        }
        let norm = norm1(x.as_ref());
        if !norm.is_finite() {
            return Err(StepError::NotFinite { what: "the argument of exp" });
        }
        if structure == Structure::Skew && norm > NORM_MAX_SKEW {
            return Err(StepError::NormTooLarge { map: "exp" });
        }
        let (degree, theta, c) =
            PADE.into_iter().find(|&(_, theta, _)| norm <= theta).unwrap_or(PADE[4]);
        let squarings = if norm > theta { (norm / theta).log2().ceil() as u32 } else { 0 };
        scaled_sum(&mut self.a, [0.5f64.powi(squarings as i32)], [x], 0.0);
        self.pade(degree, c, out);
        for _ in 0..squarings {
            mul(&mut self.t, out.as_ref(), out.as_ref());
            core::mem::swap(&mut self.t, out);
        }
        let mut corrections = 0;
        if structure == Structure::Skew && squarings > 0 {
            corrections = self.orthogonalise(out);
        }
        self.choice = ExpmChoice { kind: Kind::Pade, degree, squarings, corrections };
        if is_finite(out) { Ok(()) } else { Err(StepError::NotFinite { what: "exp(u)" }) }
    }

    /// out ← (V − aU)⁻¹(V + aU), the Padé approximant of exp(a) with coefficients `c`.
    fn pade(&mut self, degree: usize, c: &[f64], out: &mut Mat<f64>) {
        let Expm { a, a2, a4, a6, u, v, t, lu, .. } = self;
        mul(a2, a.as_ref(), a.as_ref());
        if degree >= 5 {
            mul(a4, a2.as_ref(), a2.as_ref());
        }
        if degree >= 7 {
            mul(a6, a4.as_ref(), a2.as_ref());
        }
        match degree {
            3 => {
                scaled_sum(u, [c[3]], [a2], c[1]);
                scaled_sum(v, [c[2]], [a2], c[0]);
            }
            5 => {
                scaled_sum(u, [c[3], c[5]], [a2, a4], c[1]);
                scaled_sum(v, [c[2], c[4]], [a2, a4], c[0]);
            }
            7 => {
                scaled_sum(u, [c[3], c[5], c[7]], [a2, a4, a6], c[1]);
                scaled_sum(v, [c[2], c[4], c[6]], [a2, a4, a6], c[0]);
            }
            9 => {
                mul(t, a6.as_ref(), a2.as_ref());
                scaled_sum(u, [c[3], c[5], c[7], c[9]], [a2, a4, a6, t], c[1]);
                scaled_sum(v, [c[2], c[4], c[6], c[8]], [a2, a4, a6, t], c[0]);
            }
            _ => {
                for (dst, odd) in [(&mut *u, 1), (&mut *v, 0)] {
                    scaled_sum(t, [c[8 + odd], c[10 + odd], c[12 + odd]], [a2, a4, a6], 0.0);
                    scaled_sum(dst, [c[2 + odd], c[4 + odd], c[6 + odd]], [a2, a4, a6], c[odd]);
                    mul_add(dst, 1.0, a6.as_ref(), t.as_ref());
                }
            }
        }
        mul(t, a.as_ref(), u.as_ref());
        scaled_sum(&mut lu.a, [1.0, -1.0], [v, t], 0.0);
        scaled_sum(out, [1.0, 1.0], [v, t], 0.0);
        lu.factor();
        lu.solve(out.as_mut());
    }

    /// g ← g + g(𝟙 − gᵀg)/2 until ‖𝟙 − gᵀg‖ is at rounding level: the squarings amplify the
    /// defect to ‖u‖ε, and Newton–Schulz in residual form takes it back to ε.
    fn orthogonalise(&mut self, g: &mut Mat<f64>) -> u32 {
        let n = g.nrows() as f64;
        for k in 0..5 {
            mul(&mut self.t, g.transpose(), g.as_ref());
            scaled_sum(&mut self.a2, [-0.5], [&self.t], 0.5);
            if k > 0 && norm1(self.a2.as_ref()) <= 2.0 * n * f64::EPSILON {
                return k;
            }
            mul(&mut self.t, g.as_ref(), self.a2.as_ref());
            scaled_sum(&mut self.a4, [1.0, 1.0], [g, &self.t], 0.0);
            core::mem::swap(&mut self.a4, g);
        }
        5
    }
}
