//! The problems of the library as few types, [`DynFlow`]: one for each group and action, whatever the field.
//!
//! Those of vectors are generic in the number, for runs whose operations are counted; matrices say themselves
//! what they compute.

use lieflow::actions::{Coadjoint, LeftTranslation, Linear};
use lieflow::groups::{MatrixGroup, Power, Product, Se3, So3, Translations};
use lieflow::problems::{DynFlow, FromTheBody, TimeAlone, WithHamiltonian};
use nalgebra::Vector3;

use super::composed::{OnParts, Parts};
use super::matrix::MatrixAction;

/// A vector under SO(3): spins.
pub(super) type OnSphere<N> = DynFlow<So3<N>, Linear, TimeAlone>;
/// Vectors under SO(3)ᴺ: spin chains, many bodies, Euler's equations on so(3)*.
pub(super) type OnSpheres<N> = DynFlow<Power<So3<N>>, Linear, (), WithHamiltonian>;
/// Momenta on se(3)*: heavy tops, the spherical pendulum, Euler's equations.
pub(super) type OnSe3<N> = DynFlow<Se3<N>, Coadjoint, (), WithHamiltonian>;
/// All that is made of matrices.
pub(super) type OnMatrices = DynFlow<MatrixGroup, MatrixAction, TimeAlone, WithHamiltonian>;
/// The group element of Euler's equations on matrices.
pub(super) type FromBody = DynFlow<MatrixGroup, FromTheBody>;
/// A body under torques: attitude and momentum.
pub(super) type Driven<N> = DynFlow<Product<So3<N>, Translations<Vector3<N>>>, LeftTranslation>;
/// Lyapunov exponents: the frame, and (σ, x).
pub(super) type Growing = DynFlow<Product<MatrixGroup, Translations<Growth>>, LeftTranslation>;
/// What scenes compose from parts.
pub(super) type Composed<N> = DynFlow<Parts<N>, OnParts>;

/// (σ, x) of Lyapunov exponents.
pub(super) type Growth = (faer::Mat<f64>, faer::Mat<f64>);
