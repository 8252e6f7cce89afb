//! Dense matrix kernels over faer. All code that calls faer's low-level interface is here.
//!
//! Workspaces are made once; after that nothing allocates. Every product runs on one core (`Par::Seq`), because below n
//! = 128 faer's parallel mode is slower, and ensembles use threads outside. Products and solves up to 8×8 run in
//! const-size kernels, chosen once for each call, because a library call costs more than the arithmetic there.

mod ad;
mod eigen;
mod expm;
mod linear_algebra;
mod lu;
mod ops;
mod product;
mod schur;
mod symmetric;

pub use crate::error::RCOND_MIN;
pub(crate) use ad::{AdForm, AdKind, AdSchur, Direction, NearlySingular};
pub(crate) use eigen::{ComplexBlocks, SkewEigen};
pub(crate) use expm::Expm;
pub use expm::{
    ApplyChoice, Approximant, ComplexExponential, ExpmChoice, Exponential, ExponentialBatch,
    ExponentialF32, Structure,
};
#[doc(hidden)] // for the crates of this workspace: the shapes are not checked
pub use linear_algebra::{
    determinant, hermitian_eigenvalues, inverse, largest_entry, multiply, norm, qr,
    singular_values, squared_norm, symmetric_eigen, symmetric_eigenvalues,
};
pub(crate) use lu::Lu;
pub(crate) use ops::{
    axpy, blocks_of_complex, complex_of_blocks, is_finite, norm_frobenius, norm_of, norm1,
    scaled_sum, wide,
};
#[doc(hidden)] // for the crates of this workspace: the shapes are not checked
pub use product::multiply_into;
pub(crate) use product::{
    antisymmetrise, congruence, lower_product, mirror, mul, mul_add, orthogonalise, skew_commutator,
};
pub(crate) use schur::{NEGLIGIBLE, Schur};
pub(crate) use symmetric::SymmetricEigen;
