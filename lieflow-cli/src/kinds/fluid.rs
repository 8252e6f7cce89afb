//! `kind = "fluid-on-sphere"`: an ideal fluid on the sphere by Zeitlin's model, N×N matrices; see
//! [`Zeitlin`].
//!
//! The methods of the catalog that are made for it are its two midpoint rules: `isospectral2`, which keeps
//! the Lie–Poisson structure, and `energy-casimir` with cay, which keeps the energy; both keep the spectrum.

use lieflow::Error;
use lieflow::catalog::{MethodSpec, OnEmbedded, OnMethod};
use lieflow::groups::ComplexMatrix;
use lieflow::maps::{Cay, Exp};
use lieflow::methods::{
    CommutatorFree, EnergyCasimir, GAUSS2, GAUSS4, Gauss, Rk, Rkmk, commutator_free, tableau,
};
use lieflow::problems::{FluidMidpoint, Sphere, Vortex, Zeitlin};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::erased::{Doubled, Pointed};
use crate::model::{Catalog, Layer};
use crate::scene::values::{Real, Reals, Whole};
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "fluid-on-sphere",
    summary: "an ideal fluid on the sphere, Zeitlin's model with N×N matrices",
    keys: &[
        KeyInfo { name: "n", meaning: "N, at most 512: harmonics up to the degree N - 1" },
        KeyInfo {
            name: "random",
            meaning: "{seed, below}: Gaussian coefficients of the degrees below that, of size 1",
        },
        KeyInfo {
            name: "jets",
            meaning: "a list of [degree, amplitude], instead of random: jets along the parallels",
        },
        KeyInfo {
            name: "vortices",
            meaning: "a list of {latitude, longitude, circulation, width} in radians, instead of \
                      random, or with jets",
        },
    ],
    quantities: &[
        QuantityInfo {
            name: "matrix",
            columns: &["w1_1", "re2_1", "im2_1", "…", "wN_N"],
            meaning: "W on and below the diagonal, column by column: the imaginary part of the diagonal, \
                      real and imaginary parts below it",
        },
        QuantityInfo {
            name: "coefficients",
            columns: &["w1", "…", "wNN"],
            meaning: "coefficients of the harmonics, by degree l and then by order -l to l",
        },
        QuantityInfo { name: "energy", columns: &["energy"], meaning: "kinetic energy" },
        QuantityInfo {
            name: "enstrophy",
            columns: &["enstrophy"],
            meaning: "half the mean of the vorticity's square",
        },
        QuantityInfo {
            name: "levels",
            columns: &["level1", "…", "levelN"],
            meaning: "the values that the vorticity takes, in ascending order",
        },
        QuantityInfo {
            name: "angular_momentum",
            columns: &["l1", "l2", "l3"],
            meaning: "angular momentum",
        },
    ],
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    n: Whole<2>,
    random: Option<Random>,
    jets: Option<Vec<Reals<2>>>,
    vortices: Option<Vec<VortexKeys>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Random {
    seed: Whole<0>,
    below: Whole<2>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VortexKeys {
    latitude: Real,
    longitude: Real,
    circulation: Real,
    width: Real,
}

/// Larger matrices take longer than a scene should.
const N_MAX: u64 = 512;
/// The levels of larger ones are shown where they are asked for and not watched: each row takes an
/// eigenvalue problem.
const WATCHED: usize = 64;
/// The grid of the picture.
const GRID: [usize; 2] = [48, 96];

/// The fluid with its initial vorticity.
#[derive(Clone, Debug)]
struct Fluid {
    fluid: Zeitlin<Sphere>,
    start: ComplexMatrix,
}

/// The places on and below the diagonal, column by column.
fn below(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |j| (j..n).map(move |i| (i, j)))
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    if keys.n.0 > N_MAX {
        return Err(Refusal::at("n", format!("n = {}, expected at most {N_MAX}", keys.n.0)).into());
    }
    let fluid = Zeitlin::sphere(keys.n.0 as usize)?;
    let at = |key: &'static str| move |error: Error| Refusal::at(key, error.to_string());
    let given = keys.jets.is_some() || keys.vortices.is_some();
    let start = match keys.random {
        Some(_) if given => {
            let message = "both `random` and `jets` or `vortices`, expected exactly one of them";
            return Err(Refusal::at("random", message).into());
        }
        None if !given => {
            let message = "expected `random`, `jets` or `vortices`, found none";
            return Err(Refusal::section(message).into());
        }
        Some(Random { seed, below }) => {
            let mut rng = Pcg64::seed_from_u64(seed.0);
            fluid.random(&mut rng, below.0 as usize).map_err(at("random"))?
        }
        None => {
            let mut jets = Vec::new();
            for (i, Reals([degree, amplitude])) in keys.jets.unwrap_or_default().iter().enumerate()
            {
                if !(degree.fract() == 0.0 && (1.0..keys.n.0 as f64).contains(degree)) {
                    let message = format!("degree {degree}, expected 1 to {}", keys.n.0 - 1);
                    return Err(Refusal::at(format!("jets[{i}]"), message).into());
                }
                jets.push((*degree as usize, *amplitude));
            }
            let vortex = |keys: &VortexKeys| Vortex {
                latitude: keys.latitude.0,
                longitude: keys.longitude.0,
                circulation: keys.circulation.0,
                width: keys.width.0,
            };
            let vortices: Vec<_> = keys.vortices.iter().flatten().map(vortex).collect();
            let mut w = fluid.vortices(&vortices).map_err(at("vortices"))?;
            let jets = fluid.jets(&jets).map_err(at("jets"))?;
            w.re += &jets.re;
            w.im += &jets.im;
            w
        }
    };
    Ok(Box::new(Fluid { fluid, start }))
}

/// Why a method or a part of it does not go with a fluid.
fn refused<T>(spec: &MethodSpec, what: &'static str, why: &'static str) -> Result<T, Error> {
    Err(Error::Unsupported { what, with: format!("`{}` on a fluid", spec.name), why })
}

/// The method of that name: U(n) has the maps exp and cay, and these methods are enough on it.
macro_rules! fluid_method {
    ($spec:expr, $on:expr, else => $else:expr) => {{
        let spec: &MethodSpec = $spec;
        let info = spec.info()?;
        let (map, tableau) = (spec.map.as_deref(), spec.tableau.as_deref().unwrap_or("rk4"));
        let cay = map == Some("cay");
        if spec.q.is_some() {
            return refused(spec, "q", "its exponential takes dexp⁻¹ to rounding; leave q out");
        }
        if !matches!(map, None | Some("exp" | "cay")) {
            return refused(spec, "map", "U(n) has the maps exp and cay");
        }
        match (info.name, tableau) {
            ("isospectral2", _) => Ok($on.call(FluidMidpoint::isospectral())),
            ("energy-casimir", _) if cay => Ok($on.call(FluidMidpoint::energy())),
            ("energy-casimir", _) => Ok($on.call(EnergyCasimir::new(Exp))),
            ("rkmk4", _) | ("rkmk", "rk4") if cay => Ok($on.call(Rkmk::new(tableau::RK4, Cay))),
            ("rkmk4", _) | ("rkmk", "rk4") => Ok($on.call(Rkmk::new(tableau::RK4, Exp))),
            ("rk4", _) | ("rk", "rk4") => Ok($on.call(Rk(tableau::RK4))),
            ("cf4", _) => Ok($on.call(CommutatorFree(commutator_free::CF4))),
            ("midpoint-implicit", _) => Ok($on.call(Gauss(GAUSS2))),
            ("gauss4", _) => Ok($on.call(Gauss(GAUSS4))),
            _ => $else,
        }
    }};
}

/// The embedded pair of that name.
macro_rules! fluid_pair {
    ($spec:expr, $on:expr) => {{
        let spec: &MethodSpec = $spec;
        match (spec.info()?.name, spec.map.as_deref(), spec.tableau.as_deref()) {
            ("rkmk", None | Some("exp"), Some("dopri5")) => {
                Ok($on.call(Rkmk::new(tableau::DOPRI5, Exp)))
            }
            ("rkmk", None | Some("exp"), Some("dop853")) => {
                Ok($on.call(Rkmk::new(tableau::DOP853, Exp)))
            }
            ("rkmk", Some("cay"), Some("dopri5")) => {
                Ok($on.call(Rkmk::new(tableau::DOPRI5, Cay)))
            }
            ("rk", _, Some("dopri5")) => Ok($on.call(Rk(tableau::DOPRI5))),
            ("rk", _, Some("dop853")) => Ok($on.call(Rk(tableau::DOP853))),
            (name, ..) => match MethodSpec::new(name, None).info()?.takes_tableau {
                true => refused(spec, "tableau", "a fluid takes rk4, dopri5 and dop853"),
                false => refused(
                    spec,
                    "method",
                    "a fluid takes isospectral2, energy-casimir, rkmk4, rkmk, rk4, rk, cf4, gauss4 and \
                     midpoint-implicit",
                ),
            },
        }
    }};
}

impl Catalog for Zeitlin<Sphere> {
    fn with<V: OnMethod<Self>>(&self, spec: &MethodSpec, on: V) -> Result<V::Out, Error> {
        let on = Pointed(on);
        fluid_method!(spec, on, else => fluid_pair!(spec, on))
    }
    fn with_estimate<V: OnEmbedded<Self>>(
        &self,
        spec: &MethodSpec,
        on: V,
    ) -> Result<V::Out, Error> {
        if spec.has_pair()? {
            let on = Pointed(on);
            return fluid_pair!(spec, on);
        }
        let on = Doubled(on);
        fluid_method!(spec, on, else => refused(spec, "method", "no pair fits a fluid"))
    }
}

impl System for Fluid {
    type Problem = Zeitlin<Sphere>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, ComplexMatrix), Error> {
        Ok((self.fluid.clone(), self.start.clone()))
    }
    fn modelled(&self) -> String {
        format!("vorticity in u({}), conjugated by U({0})", self.fluid.n())
    }
    fn state(&self) -> &'static [&'static str] {
        &["matrix"]
    }
    fn laws(&self) -> Vec<Law> {
        let mut laws = vec![
            Law::of_the_flow("energy", 2),
            Law::of_the_action("enstrophy", 2),
            Law::of_the_flow("angular_momentum", 1).on_scale(Scale::Terms),
        ];
        if self.fluid.n() <= WATCHED {
            laws.push(Law::of_the_action("levels", 0).on_scale(Scale::Terms));
        }
        laws
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let n = self.fluid.n();
        match quantity.name {
            "coefficients" => (1..=n * n).map(|k| format!("w{k}")).collect(),
            "levels" => (1..=n).map(|k| format!("level{k}")).collect(),
            "matrix" => {
                let entry = |(i, j): (usize, usize)| match i == j {
                    true => vec![format!("w{}_{}", i + 1, j + 1)],
                    false => ["re", "im"].map(|part| format!("{part}{}_{}", i + 1, j + 1)).into(),
                };
                below(n).flat_map(entry).collect()
            }
            _ => quantity.columns.iter().map(|&column| column.into()).collect(),
        }
    }
    fn show(&self, quantity: &str, _: f64, w: &ComplexMatrix, row: &mut Vec<f64>) {
        let n = self.fluid.n();
        match quantity {
            "coefficients" => row.extend(self.fluid.coefficients(w, n)),
            "energy" => row.push(self.fluid.energy(w)),
            "enstrophy" => row.push(self.fluid.enstrophy(w)),
            "levels" => {
                let levels = self.fluid.spectrum(w);
                row.extend(levels.unwrap_or_else(|_| vec![f64::NAN; n]));
            }
            "angular_momentum" => row.extend(self.fluid.surface().angular_momentum(w)),
            _ => {
                for (i, j) in below(n) {
                    if i != j {
                        row.push(w.re[(i, j)]);
                    }
                    row.push(w.im[(i, j)]);
                }
            }
        }
    }
    /// On the grid of the picture, from the matrix.
    fn field(&self, matrix: &[f64]) -> Vec<Vec<f64>> {
        let n = self.fluid.n();
        let (mut w, mut entries) = (ComplexMatrix::zeros(n, n), matrix.iter().copied());
        let mut next = || entries.next().unwrap_or(f64::NAN);
        for (i, j) in below(n) {
            if i != j {
                let re = next();
                (w.re[(i, j)], w.re[(j, i)]) = (re, -re);
            }
            let im = next();
            (w.im[(i, j)], w.im[(j, i)]) = (im, im);
        }
        let grid = self.fluid.on_grid(&w, GRID[0], GRID[1]);
        (0..GRID[0]).map(|i| (0..GRID[1]).map(|j| grid[(i, j)]).collect()).collect()
    }
    /// ‖W‖, whose rounding every level and every moment shares.
    fn size(&self, _: &str, w: &ComplexMatrix) -> f64 {
        (2.0 * self.fluid.enstrophy(w) * self.fluid.n() as f64).sqrt()
    }
    fn figure(&self) -> Figure {
        Figure::Map("matrix")
    }
}
