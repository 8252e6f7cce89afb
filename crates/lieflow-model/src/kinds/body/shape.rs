//! `shape`: moments of inertia from mass and measures; see [`lieflow::problems::inertia`].

use lieflow::Error;
use lieflow::problems::inertia::{cuboid, cylinder, ellipsoid};

use crate::reader::read_by_keys;
use crate::reader::values::{Real, Reals};
use crate::reader::{Refusal, help_for};

read_by_keys! {
    /// The key, as it is written: which measures belong to which kind is checked after.
    #[derive(Clone, Debug)]
    pub(crate) struct Shape {
        kind: String,
        mass: Real,
        sides: Option<Reals<3>>,
        semi_axes: Option<Reals<3>>,
        radius: Option<Real>,
        height: Option<Real>,
    }
}

impl Shape {
    /// The principal moments.
    pub(super) fn moments(&self) -> Result<[f64; 3], Refusal> {
        let mass = self.mass.0;
        let moments = match (self.kind.as_str(), self) {
            ("box", Shape { sides: Some(s), semi_axes: None, radius: None, height: None, .. }) => {
                cuboid(mass, s.0)
            }
            (
                "ellipsoid",
                Shape { sides: None, semi_axes: Some(a), radius: None, height: None, .. },
            ) => ellipsoid(mass, a.0),
            (
                "cylinder",
                Shape { sides: None, semi_axes: None, radius: Some(r), height: Some(h), .. },
            ) => cylinder(mass, r.0, h.0),
            ("box", _) => return Err(refusal("a box has a mass and sides")),
            ("ellipsoid", _) => return Err(refusal("an ellipsoid has a mass and semi_axes")),
            ("cylinder", _) => return Err(refusal("a cylinder has a mass, a radius and a height")),
            (other, _) => {
                let help = help_for(other, &["box", "ellipsoid", "cylinder"]);
                return Err(refusal(&format!("unknown shape `{other}`: {help}")));
            }
        };
        moments.map_err(|error: Error| refusal(&error.to_string().replace("edges", "sides")))
    }
}

fn refusal(message: &str) -> Refusal {
    Refusal::at("shape", message)
}
