//! The problems of the library as few types, [`DynFlow`]: one for each group and action, whatever the field.
//!
//! Those of vectors have another number type where their operations are counted. Matrices report what they compute.

mod matrix;
mod parts;
mod place;

pub use matrix::{MatrixAction, MatrixWork, reverse};
pub use parts::{Field, ON_PARTS, OnParts, Parts, Point, group_of};
pub use place::Place;

use lieflow::actions::{Coadjoint, LeftTranslation, Linear, Translation};
use lieflow::groups::{MatrixGroup, Power, Product, Se3, So3, Translations, UnitQuaternions};
use lieflow::problems::{DynFlow, FromTheBody, TimeAlone, WithHamiltonian, WithSeries};
use nalgebra::Vector3;

/// A rotation, by its angular velocity in space or in the body.
pub type OnRotations = DynFlow<So3, Translation, TimeAlone>;
/// A unit quaternion, by the same.
pub type OnQuaternions = DynFlow<UnitQuaternions, Translation>;
/// A vector under SO(3): spins.
pub type OnSphere<S = f64> = DynFlow<So3<S>, Linear, TimeAlone>;
/// Vectors under SO(3)ᴺ: spin chains, many bodies, Euler's equations on so(3)*.
pub type OnSpheres<S = f64> = DynFlow<Power<So3<S>>, Linear, (), WithHamiltonian>;
/// Momenta on se(3)*: heavy tops, the spherical pendulum, Euler's equations.
pub type OnSe3<S = f64> = DynFlow<Se3<S>, Coadjoint, WithSeries, WithHamiltonian>;
/// The same with a field that is not made of a Taylor series.
pub type OnPairs = DynFlow<Se3, Coadjoint, (), WithHamiltonian>;
/// A frame that moves, by its twist in space or in the body.
pub type Motion<S = f64> = DynFlow<Se3<S>, Translation, TimeAlone>;
/// All that is made of matrices.
pub type OnMatrices = DynFlow<MatrixGroup, MatrixAction, TimeAlone, WithHamiltonian>;
/// The group element of Euler's equations on matrices.
pub type FromBody = DynFlow<MatrixGroup, FromTheBody>;
/// A body under torques: attitude and momentum.
pub type Driven<S = f64> = DynFlow<Product<So3<S>, Translations<Vector3<S>>>, LeftTranslation>;
/// Lyapunov exponents: the frame, and (σ, x).
pub type Growing = DynFlow<Product<MatrixGroup, Translations<Growth>>, LeftTranslation>;
/// What scenes compose from parts.
pub type Composed<S = f64> = DynFlow<Parts<S>, OnParts>;

/// (σ, x) of Lyapunov exponents.
pub type Growth = (faer::Mat<f64>, faer::Mat<f64>);
