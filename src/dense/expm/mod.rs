//! The matrix exponential, in a reusable workspace.
//!
//! | | n ≤ 16 | larger n |
//! |---|---|---|
//! | so(n) | Taylor with few products, one kernel ([`taylor`], [`small`]) | cos/sin split, half products ([`skew`]) |
//! | any matrix | the same; difficult ones as for larger n | Taylor or Padé by cost, balancing, power norms ([`general`]) |
//! | Padé by request | Padé 3, 5, 7, 9, 13 ([`pade`]) | the same |
//! | many matrices | n ≤ 8: one matrix a lane ([`batch`], [`lanes`]) | one by one |
//! | complex | Taylor by the norms of powers ([`complex`]) | the same |
//!
//! After squarings on so(n) a Newton–Schulz step in residual form puts the result back on the group.

mod batch;
pub(super) mod cols;
mod complex;
mod condition;
mod general;
mod lanes;
mod narrow;
mod pade;
mod skew;
mod small;
pub(super) mod taylor;

pub use batch::ExponentialBatch;
pub use complex::ComplexExponential;
pub use condition::ApplyChoice;
use faer::Mat;
pub use narrow::ExponentialF32;
use pulp::Arch;

use super::ops::norm1;
use super::{Lu, is_finite};
use crate::error::StepError;

/// The kind of an approximant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Approximant {
    /// The \[m/m\] Padé approximant.
    #[default]
    Pade,
    /// The Taylor polynomial of degree m, by products only.
    Taylor,
    /// C(u²) + u·S(u²) of degree m on so(n), by products only.
    CosSin,
}

/// The approximant that was taken. Tests check it and the result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ExpmChoice {
    /// Padé or products only.
    pub kind: Approximant,
    /// The degree m of the approximant.
    pub degree: usize,
    /// Number s of squarings.
    pub squarings: u32,
    /// Newton–Schulz corrections that put the result back on SO(n).
    pub corrections: u32,
    /// Whether rows and columns were balanced by powers of two.
    pub balanced: bool,
}

/// The structure of the argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// A general matrix.
    General,
    /// u is skew-symmetric, so that exp(u) is a rotation.
    Skew,
}

/// Above this norm no digit of a rotation's angle has a meaning.
const NORM_MAX_SKEW: f64 = 1e15;

/// exp of n×n matrices, with a workspace of nine matrices.
///
/// ```
/// use lieflow::faer::mat;
/// use lieflow::dense::{Exponential, Structure};
///
/// let u = mat![[0.0, -1.0], [1.0, 0.0]];
/// let (mut exponential, mut g) = (Exponential::new(2), u.clone());
/// exponential.exp(&u, Structure::Skew, &mut g)?;
/// assert!((g[(1, 0)] - 1f64.sin()).abs() < 1e-15);
/// # Ok::<(), lieflow::StepError>(())
/// ```
#[derive(Debug)]
pub struct Exponential(Expm);

impl Exponential {
    /// Makes the workspace for n×n matrices. Nothing allocates after this, except functions that say so.
    pub fn new(n: usize) -> Self {
        Exponential(Expm::new(n))
    }

    /// Takes only Padé approximants, at every n and norm.
    pub fn insist_on_pade(mut self) -> Self {
        self.0.pade_only = true;
        self
    }

    /// out ← exp(u), and which approximant was taken.
    ///
    /// The relative error is a small multiple of ε times the condition number of exp at u, except for matrices far from
    /// normal: where the powers of |u| are much larger than those of u, as for \[s, −s; s, −s\], squarings lose more. For
    /// [`Structure::Skew`] ‖outᵀout − 𝟙‖_F ≤ 4√n ε at every norm. About 3 to 10 products.
    ///
    /// # Errors
    /// [`StepError::Shape`] when one of the two matrices is not n×n, [`StepError::NotFinite`] when u or
    /// exp(u) is not finite, [`StepError::NormTooLarge`] for a skew u with a norm above 1e15, where no digit
    /// of an angle is left.
    pub fn exp(
        &mut self,
        u: &Mat<f64>,
        structure: Structure,
        out: &mut Mat<f64>,
    ) -> Result<ExpmChoice, StepError> {
        let n = self.0.a.nrows();
        StepError::check_shape("u", u.shape(), (n, n))?;
        StepError::check_shape("out", out.shape(), (n, n))?;
        self.0.exp(u, structure, out)?;
        Ok(self.0.choice)
    }

    /// What the last call chose.
    pub fn choice(&self) -> ExpmChoice {
        self.0.choice
    }
}

/// Workspace for exp of n×n matrices.
#[derive(Debug)]
pub(crate) struct Expm {
    arch: Arch,
    pade_only: bool,
    a: Mat<f64>,
    a2: Mat<f64>,
    a4: Mat<f64>,
    a6: Mat<f64>,
    u: Mat<f64>,
    v: Mat<f64>,
    t: Mat<f64>,
    lu: Lu,
    vectors: [Vec<f64>; 2],
    exponents: Vec<i32>,
    /// What the last call chose.
    pub(crate) choice: ExpmChoice,
}

impl Expm {
    pub(crate) fn new(n: usize) -> Self {
        let z = || Mat::zeros(n, n);
        Expm {
            arch: Arch::new(),
            pade_only: false,
            a: z(),
            a2: z(),
            a4: z(),
            a6: z(),
            u: z(),
            v: z(),
            t: z(),
            lu: Lu::new(n),
            vectors: [vec![0.0; n], vec![0.0; n]],
            exponents: vec![0; n],
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
        let n = x.nrows();
        if n <= cols::N_MAX
            && !self.pade_only
            && let Some(choice) = small::exp(self.arch, x, structure, out)
        {
            self.choice = choice;
            return Ok(());
        }
        // A sum may overflow where every entry is finite.
        let norm = norm1(x.as_ref());
        StepError::finite(norm.is_finite(), "the argument of exp")?;
        if n == 1 {
            out[(0, 0)] = x[(0, 0)].exp();
            self.choice = ExpmChoice::default();
        } else if structure == Structure::General {
            self.exp_general(x, self.pade_only, out);
        } else if norm > NORM_MAX_SKEW {
            return Err(StepError::NormTooLarge { map: "exp" });
        } else if self.pade_only {
            self.a.copy_from(x);
            let (degree, squarings) = self.scaled_pade(norm, out);
            self.rotate_back(Approximant::Pade, degree, squarings, out);
        } else {
            self.exp_skew(x, norm, out);
        }
        StepError::finite(is_finite(out), "exp(u)")
    }
}
