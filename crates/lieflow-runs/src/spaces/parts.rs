//! SO(3)ⁿ × SO(3)ᵐ × T(k) on vectors, rotations and numbers. The powers and the numbers may be empty.

use lieflow::Error;
use lieflow::actions::{Linear, Pair, Translation};
use lieflow::groups::{Power, Product, So3, Translations};
use lieflow::scalar::Trig;
use lieflow::space::LinearSpace;
use nalgebra::{Matrix3, Vector3};

type Powers<S> = Power<So3<S>>;
/// SO(3)ⁿ × SO(3)ᵐ × T(k).
pub type Parts<S = f64> = Product<Powers<S>, Product<Powers<S>, Translations<Box<[S]>>>>;
/// On vectors, and on rotations and numbers.
pub type OnParts = Pair<Linear, Translation>;
/// Vectors, rotations and numbers.
pub type Point<S = f64> = (Box<[Vector3<S>]>, (Box<[Matrix3<S>]>, Box<[S]>));
/// f of each.
pub type Field<S = f64> = (Box<[Vector3<S>]>, (Box<[Vector3<S>]>, Box<[S]>));

/// The action of the parts.
pub const ON_PARTS: OnParts = Pair(Linear, Translation::Left);

/// The group of these numbers of vectors, rotations and numbers.
///
/// # Errors
/// As [`Power::new`].
pub fn group_of<S>(counts: [usize; 3]) -> Result<Parts<S>, Error>
where
    S: Trig + Into<f64> + LinearSpace<Scalar = S>,
{
    let copies = |n: usize| match n {
        0 => Ok(Power::none(So3::new())),
        n => Power::new(So3::new(), n),
    };
    let [vectors, rotations, numbers] = counts;
    let zero: Box<[S]> = (0..numbers).map(|_| S::lit(0.0)).collect();
    let translations = Translations::new(zero, numbers);
    Ok(Product(copies(vectors)?, Product(copies(rotations)?, translations)))
}
