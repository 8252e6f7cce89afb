//! `shape`: moments of inertia from mass and measures; see [`lieflow::problems::inertia`].

use lieflow::problems::inertia::{cuboid, cylinder, ellipsoid};

use crate::reader::read_by_keys;
use crate::reader::values::{Real, Reals};
use crate::reader::{KeyPath, ReadError, Refusal};

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
    pub(super) fn moments(&self) -> Result<[f64; 3], ReadError> {
        let mut mistakes = ReadError::default();
        let mut positive = |key: String, x: Real| {
            mistakes.keep(x.checked(&key, "a finite number > 0", |x| x > 0.0));
        };
        let &Shape { mass, sides, semi_axes, radius, height, .. } = self;
        for (key, x) in [("mass", Some(mass)), ("radius", radius), ("height", height)] {
            x.into_iter().for_each(|x| positive(KEY.entry(key), x));
        }
        for (key, list) in [("sides", sides), ("semi_axes", semi_axes)] {
            let entries = list.into_iter().flat_map(|list| list.0).enumerate();
            entries.for_each(|(i, x)| positive(KEY.entry(key).index(i), Real(x)));
        }
        mistakes.or(Some(()))?;
        let Real(mass) = mass;
        let moments = match (self.kind.as_str(), sides, semi_axes, radius, height) {
            ("box", Some(sides), None, None, None) => cuboid(mass, sides.0),
            ("ellipsoid", None, Some(axes), None, None) => ellipsoid(mass, axes.0),
            ("cylinder", None, None, Some(r), Some(h)) => cylinder(mass, r.0, h.0),
            ("box", ..) => return Err(refusal("a box has a mass and sides")),
            ("ellipsoid", ..) => return Err(refusal("an ellipsoid has a mass and semi_axes")),
            ("cylinder", ..) => {
                return Err(refusal("a cylinder has a mass, a radius and a height"));
            }
            (other, ..) => {
                let unknown = Refusal::unknown("shape", other, &["box", "ellipsoid", "cylinder"]);
                return Err(unknown.about(KEY.entry("kind")).into());
            }
        };
        moments.map_err(|_| refusal("its moments of inertia are not finite numbers > 0"))
    }
}

/// The key of a shape.
const KEY: &str = "shape";

fn refusal(message: &str) -> ReadError {
    Refusal::at(KEY, message).into()
}
