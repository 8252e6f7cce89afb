//! The vorticity that a run starts from: random, or the sum of jets, modes and vortices.

use core::f64::consts::{FRAC_PI_2, TAU};

use lieflow::groups::ComplexMatrix;
use lieflow::problems::{LinearSpace, Sphere, Torus, Vortex, Zeitlin};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::place::Place;
use crate::kinds::prelude::*;

read_by_keys! {
    pub(super) struct Random {
        seed: Whole<0>,
        below: Whole<2>,
    }
}

read_by_keys! {
    pub(super) struct VortexKeys {
        latitude: Option<Real>,
        longitude: Option<Real>,
        x: Option<Real>,
        y: Option<Real>,
        circulation: Real,
        width: Real,
    }
}

/// Larger matrices take longer than a scene should.
const N_MAX: u64 = 512;

/// Checks the name of the surface.
pub(super) fn check_surface(surface: String) -> Result<String, ReadError> {
    let surfaces = ["sphere", "torus"];
    match surfaces.contains(&surface.as_str()) {
        true => Ok(surface),
        false => Err(Refusal::unknown("surface", &surface, &surfaces).into()),
    }
}

/// Checks N.
pub(super) fn check_size(Whole(n): Whole<2>) -> Result<usize, ReadError> {
    match n <= N_MAX {
        true => Ok(n as usize),
        false => Err(Refusal::at("n", format!("n = {n}, expected at most {N_MAX}")).into()),
    }
}

/// What the vorticity at the start is made of.
pub(super) struct Vorticity {
    pub(super) random: Option<Random>,
    pub(super) jets: Option<Vec<Reals<2>>>,
    pub(super) modes: Option<Vec<List>>,
    pub(super) vortices: Option<Vec<VortexKeys>>,
}

impl Vorticity {
    /// The surface of that name, and the vorticity on it.
    ///
    /// # Errors
    /// Refusals of the keys.
    pub(super) fn on(self, surface: &str, n: usize) -> Result<(Place, ComplexMatrix), ReadError> {
        let given = self.jets.is_some() || self.modes.is_some() || self.vortices.is_some();
        if given && self.random.is_some() {
            let message = "`random` and `jets`, `modes` or `vortices`, expected one or the other";
            return Err(Refusal::at("random", message).into());
        }
        if !given && self.random.is_none() {
            let message = "expected `random`, `jets`, `modes` or `vortices`, found none";
            return Err(Refusal::section(message).into());
        }
        let no_surface = |error: Error| Refusal::from(error).renamed(&[("N", "n")]);
        Ok(match surface {
            "sphere" => {
                let fluid = Zeitlin::sphere(n).map_err(no_surface)?;
                let start = self.start(&fluid)?;
                (Place::Sphere(fluid), start)
            }
            _ => {
                let fluid = Zeitlin::torus(n).map_err(no_surface)?;
                let start = self.start(&fluid)?;
                (Place::Torus(fluid), start)
            }
        })
    }

    fn start<F: Fields>(&self, fluid: &F) -> Result<ComplexMatrix, ReadError> {
        if let Some(Random { seed, below }) = &self.random {
            let mut rng = Pcg64::seed_from_u64(seed.0);
            let random = fluid.random_below(&mut rng, below.0 as usize);
            return Ok(random.map_err(|error| Refusal::from(error).about("random"))?);
        }
        let jets = self.jets.iter().flatten().enumerate();
        let jets = jets.map(|(i, jet)| fluid.jet(jet.0).map_err(at("jets", i)));
        let modes = self.modes.iter().flatten().enumerate();
        let modes = modes.map(|(i, mode)| fluid.mode(&mode.values()).map_err(at("modes", i)));
        let vortices = self.vortices.iter().flatten().enumerate();
        let vortices = vortices.map(|(i, keys)| fluid.vortex(keys).map_err(at("vortices", i)));
        let mut mistakes = ReadError::default();
        let parts = jets.chain(modes).chain(vortices).filter_map(|part| mistakes.keep(part));
        let sum = parts.reduce(|mut sum, part| {
            sum.add(1.0, &part);
            sum
        });
        let none = || Refusal::section("no jets, modes or vortices, expected at least one");
        let sum = mistakes.or(Some(sum))?.ok_or_else(none)?;
        match LinearSpace::is_finite(&sum) {
            true => Ok(sum),
            false => Err(Refusal::section("the vorticity is not finite").into()),
        }
    }
}

/// A refusal of an entry of a list.
fn at(key: &str, i: usize) -> impl Fn(String) -> Refusal {
    move |message| Refusal::at(key.index(i), message)
}

fn in_words(error: Error) -> String {
    error.to_string()
}

/// A whole number in a list of numbers.
fn whole(name: &str, x: f64, range: [f64; 2]) -> Result<i32, String> {
    match x.fract() == 0.0 && (range[0]..=range[1]).contains(&x) {
        true => Ok(x as i32),
        false => {
            Err(format!("{name} = {x}, expected a whole number, {} to {}", range[0], range[1]))
        }
    }
}

/// Fields of a surface.
trait Fields {
    fn random_below(&self, rng: &mut Pcg64, below: usize) -> Result<ComplexMatrix, Error>;
    fn jet(&self, jet: [f64; 2]) -> Result<ComplexMatrix, String>;
    fn mode(&self, mode: &[f64]) -> Result<ComplexMatrix, String>;
    fn vortex(&self, keys: &VortexKeys) -> Result<ComplexMatrix, String>;
}

impl Fields for Zeitlin<Sphere> {
    fn random_below(&self, rng: &mut Pcg64, below: usize) -> Result<ComplexMatrix, Error> {
        self.random(rng, below)
    }
    fn jet(&self, [degree, amplitude]: [f64; 2]) -> Result<ComplexMatrix, String> {
        self.mode(&[degree, 0.0, amplitude])
    }
    fn mode(&self, mode: &[f64]) -> Result<ComplexMatrix, String> {
        let &[degree, order, amplitude] = mode else {
            return Err(format!(
                "found {}, expected [degree, order, amplitude]",
                amount(mode.len(), "numbers")
            ));
        };
        let l = whole("degree", degree, [1.0, self.n() as f64 - 1.0])?;
        let m = whole("order", order, [-degree, degree])?;
        let mut omega = vec![0.0; ((l + 1) * (l + 1)) as usize];
        omega[(l * l + l + m) as usize] = amplitude;
        self.from_coefficients(&omega).map_err(in_words)
    }
    fn vortex(&self, keys: &VortexKeys) -> Result<ComplexMatrix, String> {
        let VortexKeys {
            latitude: Some(latitude),
            longitude: Some(longitude),
            x: None,
            y: None,
            ..
        } = keys
        else {
            return Err("a vortex on the sphere has a latitude and a longitude".into());
        };
        for (name, x, limit) in [("latitude", latitude, FRAC_PI_2), ("longitude", longitude, TAU)] {
            if x.0.abs() > limit {
                return Err(format!(
                    "{name} = {}, expected {:.4} to {limit:.4}, in radians",
                    x.0, -limit
                ));
            }
        }
        let vortex = Vortex {
            latitude: latitude.0,
            longitude: longitude.0,
            circulation: keys.circulation.0,
            width: width(keys)?,
        };
        self.vortices(&[vortex]).map_err(in_words)
    }
}

impl Fields for Zeitlin<Torus> {
    fn random_below(&self, rng: &mut Pcg64, below: usize) -> Result<ComplexMatrix, Error> {
        self.random(rng, below)
    }
    fn jet(&self, [wave_number, amplitude]: [f64; 2]) -> Result<ComplexMatrix, String> {
        let max = self.surface().wave_number_max() as f64;
        let k = whole("wave number", wave_number, [1.0, max])?;
        self.from_modes(&[([0, k], [amplitude, 0.0])]).map_err(in_words)
    }
    fn mode(&self, mode: &[f64]) -> Result<ComplexMatrix, String> {
        let &[m1, m2, a, b] = mode else {
            return Err(format!(
                "found {}, expected [m1, m2, a, b]",
                amount(mode.len(), "numbers")
            ));
        };
        if m1 == 0.0 && m2 == 0.0 {
            return Err("mode [0, 0] is the mean of the vorticity, which is 0 on a torus; expected another mode".into());
        }
        let max = self.surface().wave_number_max() as f64;
        let m = [whole("m1", m1, [-max, max])?, whole("m2", m2, [-max, max])?];
        self.from_modes(&[(m, [a, b])]).map_err(in_words)
    }
    fn vortex(&self, keys: &VortexKeys) -> Result<ComplexMatrix, String> {
        let VortexKeys { latitude: None, longitude: None, x: Some(x), y: Some(y), .. } = keys
        else {
            return Err("a vortex on the torus has x and y".into());
        };
        self.vortices(&[([x.0, y.0], keys.circulation.0, width(keys)?)]).map_err(in_words)
    }
}

fn width(keys: &VortexKeys) -> Result<f64, String> {
    match keys.width.0 {
        width if width > 0.0 => Ok(width),
        width => Err(format!("width = {width}, expected a number > 0")),
    }
}
