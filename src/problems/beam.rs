//! Transfer maps of a beam line in Sp(4): drifts, quadrupoles and dipoles.
//!
//! y = (x, z, x′, z′) is the deviation of a particle from the design orbit.
//!
//! In the paraxial model with hard edges x″ = −k_x x, z″ = −k_z z along an element of length L. So its map is one
//! exponential. In each plane
//!
//! ```text
//!     k > 0, ω = √k:  ⎡ cos ωL      sin ωL/ω ⎤    k < 0: cosh and sinh    k = 0: ⎡ 1  L ⎤
//!                     ⎣ −ω sin ωL   cos ωL   ⎦                                   ⎣ 0  1 ⎦
//! ```
//!
//! | element | k_x | k_z |
//! |---|---|---|
//! | drift | 0 | 0 |
//! | quadrupole of strength k | k | −k |
//! | sector dipole of radius ρ | 1/ρ² | 0 |
//!
//! A cell's tune in a plane is μ/2π with cos μ = ½ tr; it is stable while |tr| < 2.
//! Source: E. D. Courant, H. S. Snyder, Ann. Phys. 3 (1958).

use faer::Mat;

use crate::error::Error;
use crate::groups::GroupMatrix;

/// An element of a beam line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Element {
    /// A drift: no field over a length.
    Drift {
        /// The length L.
        length: f64,
    },
    /// A quadrupole; k > 0 focuses x.
    Quadrupole {
        /// The length L.
        length: f64,
        /// The strength k.
        k: f64,
    },
    /// A quadrupole of length zero: x′ changes by −x/f, z′ by z/f.
    ThinLens {
        /// The focal length f.
        focal_length: f64,
    },
    /// A sector dipole.
    Dipole {
        /// The length L along the arc.
        length: f64,
        /// The radius ρ of the arc.
        radius: f64,
    },
}

/// The 2×2 map of u″ = −ku over a length.
fn plane(length: f64, k: f64) -> [[f64; 2]; 2] {
    let omega = k.abs().sqrt();
    let phase = omega * length;
    if phase == 0.0 {
        return [[1.0, length], [-k * length, 1.0]];
    }
    let (s, c, sign) = match k > 0.0 {
        true => (phase.sin(), phase.cos(), -1.0),
        false => (phase.sinh(), phase.cosh(), 1.0),
    };
    [[c, s / omega], [sign * omega * s, c]]
}

impl Element {
    /// The maps of the planes x and z.
    fn planes(&self) -> Result<[[[f64; 2]; 2]; 2], Error> {
        let planes = |length: f64, kx: f64, kz: f64| {
            Error::finite("length", length)?;
            Error::all_finite("k", &[kx, kz])?;
            Ok([plane(length, kx), plane(length, kz)])
        };
        match *self {
            Element::Drift { length } => planes(length, 0.0, 0.0),
            Element::Quadrupole { length, k } => planes(length, k, -k),
            Element::Dipole { length, radius } => {
                let k = 1.0 / (radius * radius);
                if !k.is_finite() {
                    return Err(Error::out_of_range(
                        "radius",
                        radius,
                        "a number with a finite 1/radius²",
                    ));
                }
                planes(length, k, 0.0)
            }
            Element::ThinLens { focal_length } => {
                let kick = 1.0 / focal_length;
                Error::finite("1/focal_length", kick)?;
                Ok([[[1.0, 0.0], [-kick, 1.0]], [[1.0, 0.0], [kick, 1.0]]])
            }
        }
    }

    /// The transfer map of the element.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers that are not finite.
    pub fn map(&self) -> Result<GroupMatrix, Error> {
        transfer_map(core::slice::from_ref(self))
    }
}

/// The transfer map of elements, in the order of the beam.
///
/// ```
/// use lieflow::problems::beam::{Element, transfer_map, tunes};
/// // A FODO cell of thin lenses: sin(μ/2) = L/(4f).
/// let (length, f) = (2.0, 1.0);
/// let half = Element::Drift { length: length / 2.0 };
/// let cell = [
///     Element::ThinLens { focal_length: f },
///     half,
///     Element::ThinLens { focal_length: -f },
///     half,
/// ];
/// let expected = 2.0 * (length / (4.0 * f)).asin() / std::f64::consts::TAU;
/// let [x, z] = tunes(&transfer_map(&cell)?).map(|t| t.expect("a stable cell"));
/// assert!((x - expected).abs() < 1e-15 && (z - expected).abs() < 1e-15);
/// # Ok::<(), lieflow::Error>(())
/// ```
///
/// # Errors
/// [`Error::OutOfRange`] for numbers that are not finite.
pub fn transfer_map(elements: &[Element]) -> Result<GroupMatrix, Error> {
    let mut total = [[[1.0, 0.0], [0.0, 1.0]]; 2];
    for element in elements {
        for (total, m) in total.iter_mut().zip(element.planes()?) {
            let t = *total;
            *total = core::array::from_fn(|i| {
                core::array::from_fn(|j| m[i][0] * t[0][j] + m[i][1] * t[1][j])
            });
        }
    }
    let entry = |i: usize, j: usize| match i % 2 == j % 2 {
        true => total[i % 2][i / 2][j / 2],
        false => 0.0,
    };
    Error::all_finite("the map", &total.as_flattened().concat())?;
    Ok(GroupMatrix::new_unchecked(Mat::from_fn(4, 4, entry)))
}

/// The tunes μ/2π ∈ (0, 1) of a cell without coupling, in x and in z. `None` if |tr| ≥ 2: the cell is
/// unstable in that plane, or at the limit of stability.
pub fn tunes(cell: &GroupMatrix) -> [Option<f64>; 2] {
    [0, 1].map(|i| {
        let [a, upper, lower, d] =
            [(0, 0), (0, 2), (2, 0), (2, 2)].map(|(j, k)| cell[(i + j, i + k)]);
        // cos μ = tr/2. sin² μ = 1 − tr²/4 has all its digits in this form, as det M = 1.
        let (cos, half) = (0.5 * (a + d), 0.5 * (a - d));
        let squared = -(half * half + upper * lower);
        let mu = squared.sqrt().atan2(cos) / core::f64::consts::TAU;
        // M₁₂ = β sin μ with β > 0.
        (squared > 0.0).then_some(if upper >= 0.0 { mu } else { 1.0 - mu })
    })
}
