//! The vorticity that a run starts from: random, or the sum of jets, modes and vortices.

use core::f64::consts::{FRAC_PI_2, TAU};

use lieflow::groups::ComplexMatrix;
use lieflow::problems::{LinearSpace, Sphere, Torus, Vortex, Zeitlin};
use lieflow_runs::spaces::Place;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::kinds::prelude::*;

read_by_keys! {
    pub(super) struct Random {
        seed: Whole<0>,
        below: Whole<2>,
    }
}

read_by_keys! {
    pub(super) struct VortexKeys {
        latitude: Key<Option<Real>>,
        longitude: Key<Option<Real>>,
        x: Key<Option<Real>>,
        y: Key<Option<Real>>,
        circulation: Key<Real>,
        width: Key<Real>,
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
    pub(super) random: Key<Option<Random>>,
    pub(super) jets: Key<Option<Vec<Reals<2>>>>,
    pub(super) modes: Key<Option<Vec<List>>>,
    pub(super) vortices: Key<Option<Vec<VortexKeys>>>,
}

impl Vorticity {
    /// The surface of that name, and the vorticity on it.
    ///
    /// # Errors
    /// Refusals of the keys.
    pub(super) fn on(self, surface: &str, n: usize) -> Result<(Place, ComplexMatrix), ReadError> {
        let sum = given(&self.jets) || given(&self.modes) || given(&self.vortices);
        if sum && given(&self.random) {
            let message = "`random` and `jets`, `modes` or `vortices`, expected one or the other";
            return Err(Refusal::at("random", message).into());
        }
        if !sum && !given(&self.random) {
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
            _ if n.is_multiple_of(2) => {
                let message = format!("n = {n}, expected an odd number, 3 to {}", N_MAX - 1);
                return Err(Refusal::at("n", message).into());
            }
            _ => {
                let fluid = Zeitlin::torus(n).map_err(no_surface)?;
                let start = self.start(&fluid)?;
                (Place::Torus(fluid), start)
            }
        })
    }

    fn start<F: Fields>(self, fluid: &F) -> Result<ComplexMatrix, ReadError> {
        if let Some(Random { seed, below }) = self.random? {
            let mut rng = Pcg64::seed_from_u64(seed.0);
            let random = fluid.random_below(&mut rng, below.0 as usize);
            return Ok(random.map_err(|error| Refusal::from(error).about("random"))?);
        }
        let is_whole = self.jets.is_ok() && self.modes.is_ok() && self.vortices.is_ok();
        let mut mistakes = ReadError::default();
        let jets = mistakes.keep(self.jets).flatten().into_iter().flatten().enumerate();
        let jets = jets.map(|(i, jet)| Ok(fluid.jet(jet.0).map_err(at("jets", i))?));
        let modes = mistakes.keep(self.modes).flatten().into_iter().flatten().enumerate();
        let modes =
            modes.map(|(i, mode)| Ok(fluid.mode(&mode.values()).map_err(at("modes", i))?));
        let vortices = mistakes.keep(self.vortices).flatten().into_iter().flatten().enumerate();
        let vortices = vortices.map(|(i, keys)| fluid.vortex(&"vortices".index(i), keys));
        let parts = jets.chain(modes).chain(vortices).filter_map(|part| mistakes.keep(part));
        let sum = parts.reduce(|mut sum, part| {
            sum.add(1.0, &part);
            sum
        });
        let sum = mistakes.or(Some(sum)).and_then(|sum| match is_whole {
            true => Ok(sum),
            false => Err(ReadError::known()),
        });
        let none = || Refusal::section("no jets, modes or vortices, expected at least one");
        let sum = sum?.ok_or_else(none)?;
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
    fn vortex(&self, at: &str, keys: VortexKeys) -> Result<ComplexMatrix, ReadError>;
}

/// The circulation and the width of a vortex.
fn strength(at: &str, circulation: Key<Real>, width: Key<Real>) -> Result<(f64, f64), ReadError> {
    let width = width.and_then(|x| x.checked(&at.entry("width"), "a number > 0", |x| x > 0.0));
    let (circulation, width) = all!(circulation, width)?;
    Ok((circulation.0, width))
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
    fn vortex(&self, at: &str, keys: VortexKeys) -> Result<ComplexMatrix, ReadError> {
        let VortexKeys { latitude, longitude, x, y, circulation, width } = keys;
        let place = all!(latitude, longitude, x, y).and_then(|place| match place {
            (Some(latitude), Some(longitude), None, None) => {
                let within = |key: &str, x: Real, limit: f64| {
                    let expected = format!("{:.4} to {limit:.4}, in radians", -limit);
                    x.checked(&at.entry(key), &expected, |x| x.abs() <= limit)
                };
                let latitude = within("latitude", latitude, FRAC_PI_2);
                let longitude = within("longitude", longitude, TAU);
                all!(latitude, longitude)
            }
            _ => {
                let message = "a vortex on the sphere has a latitude and a longitude";
                Err(Refusal::at(at, message).into())
            }
        });
        let strength = strength(at, circulation, width);
        let ((latitude, longitude), (circulation, width)) = all!(place, strength)?;
        let vortex = Vortex { latitude, longitude, circulation, width };
        Ok(self.vortices(&[vortex]).map_err(|error| Refusal::from(error).about(at))?)
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
    fn vortex(&self, at: &str, keys: VortexKeys) -> Result<ComplexMatrix, ReadError> {
        let VortexKeys { latitude, longitude, x, y, circulation, width } = keys;
        let place = all!(latitude, longitude, x, y).and_then(|place| match place {
            (None, None, Some(x), Some(y)) => Ok([x.0, y.0]),
            _ => Err(Refusal::at(at, "a vortex on the torus has x and y").into()),
        });
        let strength = strength(at, circulation, width);
        let (place, (circulation, width)) = all!(place, strength)?;
        let vortex = (place, circulation, width);
        Ok(self.vortices(&[vortex]).map_err(|error| Refusal::from(error).about(at))?)
    }
}
