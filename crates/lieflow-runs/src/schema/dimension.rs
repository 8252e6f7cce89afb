//! Dimensions of quantities, and the units that a scene names.

use core::fmt;

/// The dimension of a quantity: powers of mass, length, angle and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    mass: i8,
    length: i8,
    angle: i8,
    time: i8,
}

/// The names of units. `None` if a scene does not name them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// The unit of masses, such as `kg`.
    pub mass: Option<String>,
    /// The unit of lengths, such as `m`.
    pub length: Option<String>,
    /// The unit of times, such as `s`.
    pub time: Option<String>,
}

/// The unit of every angle.
const RADIAN: &str = "rad";

impl Dimension {
    /// A time.
    pub const TIME: Dimension = Dimension::of(0, 0, 0, 1);
    /// A length.
    pub const LENGTH: Dimension = Dimension::of(0, 1, 0, 0);
    /// A mass.
    pub const MASS: Dimension = Dimension::of(1, 0, 0, 0);
    /// A moment of inertia.
    pub const INERTIA: Dimension = Dimension::of(1, 2, 0, 0);
    /// A velocity.
    pub const VELOCITY: Dimension = Dimension::of(0, 1, 0, -1);
    /// An angle.
    pub const ANGLE: Dimension = Dimension::of(0, 0, 1, 0);
    /// An angular velocity.
    pub const RATE: Dimension = Dimension::of(0, 0, 1, -1);
    /// An angular momentum.
    pub const ANGULAR_MOMENTUM: Dimension = Dimension::of(1, 2, 0, -1);
    /// A momentum.
    pub const MOMENTUM: Dimension = Dimension::of(1, 1, 0, -1);
    /// A torque: an energy for each radian.
    pub const TORQUE: Dimension = Dimension::ENERGY;
    /// An energy.
    pub const ENERGY: Dimension = Dimension::of(1, 2, 0, -2);

    const fn of(mass: i8, length: i8, angle: i8, time: i8) -> Self {
        Dimension { mass, length, angle, time }
    }

    /// The only one of a list.
    pub const fn first(dimensions: &[Dimension]) -> Option<Dimension> {
        match dimensions {
            [first, ..] => Some(*first),
            [] => None,
        }
    }

    /// The product of powers of these names, such as `kg·m²/s`. `None` if a name is missing.
    fn product(self, names: [Option<&str>; 4]) -> Option<String> {
        let powers = [self.mass, self.length, self.angle, self.time];
        let (mut above, mut below) = (Vec::new(), Vec::new());
        for (power, name) in powers.into_iter().zip(names).filter(|(power, _)| *power != 0) {
            let factor = match power.unsigned_abs() {
                1 => name?.to_string(),
                2 => format!("{}²", name?),
                3 => format!("{}³", name?),
                n => format!("{}^{n}", name?),
            };
            if power > 0 { above.push(factor) } else { below.push(factor) }
        }
        if above.is_empty() {
            above.push("1".into());
        }
        Some(
            above.into_iter().reduce(|all, one| format!("{all}·{one}"))?
                + &below.iter().map(|one| format!("/{one}")).collect::<String>(),
        )
    }
}

/// The dimension in words, such as `mass·length²/time`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = ["mass", "length", "angle", "time"].map(Some);
        f.write_str(&self.product(names).unwrap_or_default())
    }
}

impl Units {
    /// The unit of a quantity. `None` if the scene does not name all units that it is made of.
    pub fn of(&self, dimension: Dimension) -> Option<String> {
        let Units { mass, length, time } = self;
        dimension.product([mass.as_deref(), length.as_deref(), Some(RADIAN), time.as_deref()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_products_of_powers() {
        let si =
            Units { mass: Some("kg".into()), length: Some("m".into()), time: Some("s".into()) };
        for (dimension, unit, words) in [
            (Dimension::TIME, "s", "time"),
            (Dimension::ANGLE, "rad", "angle"),
            (Dimension::RATE, "rad/s", "angle/time"),
            (Dimension::VELOCITY, "m/s", "length/time"),
            (Dimension::ANGULAR_MOMENTUM, "kg·m²/s", "mass·length²/time"),
            (Dimension::ENERGY, "kg·m²/s²", "mass·length²/time²"),
            (Dimension::of(0, 0, 0, -1), "1/s", "1/time"),
        ] {
            assert_eq!(si.of(dimension).as_deref(), Some(unit));
            assert_eq!(dimension.to_string(), words);
        }
        let time = Units { time: Some("min".into()), ..Units::default() };
        assert_eq!(time.of(Dimension::RATE).as_deref(), Some("rad/min"));
        assert_eq!(time.of(Dimension::ENERGY), None);
        assert_eq!(Units::default().of(Dimension::ANGLE).as_deref(), Some("rad"));
    }
}
