//! `kind = "fluid"`: an ideal fluid on the sphere or the torus by Zeitlin's model, N×N matrices; see
//! [`Zeitlin`].
//!
//! Two midpoint rules are made for it: `isospectral2`, which keeps the Lie–Poisson structure, and
//! `energy-casimir` with cay, which keeps the energy; both keep the spectrum.

mod place;
mod start;

use lieflow::Error;
use lieflow::groups::ComplexMatrix;
use lieflow::problems::{Surface, Zeitlin};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use self::place::Place;
use self::start::Keys;
use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::Layer;
use crate::scene::ReadError;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "fluid",
    equation: "Ẇ = [P, W]/ħ, ΔP = W: vorticity ω carried by the stream function ψ, Δψ = ω",
    summary: "an ideal fluid on the sphere or the torus, Zeitlin's model with N×N matrices",
    keys: &[
        KeyInfo {
            name: "surface",
            meaning: "\"sphere\", or \"torus\": the square of side 2π, periodic",
        },
        KeyInfo {
            name: "n",
            meaning: "N, at most 512: harmonics up to the degree N - 1 on the sphere; on the torus odd, \
                      wave numbers up to (N - 1)/2",
        },
        KeyInfo {
            name: "random",
            meaning: "{seed, below}: Gaussian coefficients of the degrees or wave numbers below that, of \
                      size 1",
        },
        KeyInfo {
            name: "jets",
            meaning: "instead of random, a list of [degree, amplitude] of zonal harmonics on the sphere, \
                      of [k, a] for a cos(ky) on the torus",
        },
        KeyInfo {
            name: "modes",
            meaning: "with jets or instead, a list of [degree, order, amplitude] on the sphere, of \
                      [m1, m2, a, b] for a cos(m1 x + m2 y) + b sin(m1 x + m2 y) on the torus",
        },
        KeyInfo {
            name: "vortices",
            meaning: "with them or instead, a list of {latitude, longitude, circulation, width} in \
                      radians on the sphere, of {x, y, circulation, width} on the torus",
        },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "matrix",
                columns: &["w1_1", "re2_1", "im2_1", "…", "wN_N"],
                meaning: "W on and below the diagonal, column by column: the imaginary part of the diagonal, \
                      real and imaginary parts below it",
            },
            QuantityInfo {
                name: "coefficients",
                columns: &["w1", "…", "wNN"],
                meaning: "coefficients of the harmonics, by degree l and then by order -l to l; on the torus \
                      a and b of the waves of one of every m and -m, by m1 and then by m2",
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
                meaning: "angular momentum; on the sphere",
            },
        ]
    },
    read,
};

/// The levels of larger ones are shown where they are asked for and not watched: each row takes an
/// eigenvalue problem.
const WATCHED: usize = 64;

/// The fluid with its initial vorticity.
#[derive(Clone, Debug)]
struct Fluid {
    fluid: Zeitlin<Place>,
    start: ComplexMatrix,
}

/// The places on and below the diagonal, column by column.
fn below(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |j| (j..n).map(move |i| (i, j)))
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let (place, start) = Keys::deserialize(section)?.resolve()?;
    Ok(Box::new(Fluid { fluid: Zeitlin::new(place)?, start }))
}

impl System for Fluid {
    type Problem = Zeitlin<Place>;

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
        let (n, surface) = (self.fluid.n(), self.fluid.surface().name());
        format!("vorticity on the {surface} in u({n}), conjugated by U({n})")
    }
    fn state(&self) -> &'static [&'static str] {
        &["matrix"]
    }
    fn laws(&self) -> Vec<Law> {
        let mut laws = vec![Law::of_the_flow("energy", 2), Law::of_the_action("enstrophy", 2)];
        if !self.fluid.surface().momenta().is_empty() {
            laws.push(Law::of_the_flow("angular_momentum", 1).on_scale(Scale::Terms));
        }
        if self.fluid.n() <= WATCHED {
            laws.push(Law::of_the_action("levels", 0).on_scale(Scale::Terms));
        }
        laws
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let n = self.fluid.n();
        match quantity.name {
            "coefficients" => self.fluid.surface().coefficient_names(),
            "angular_momentum" if self.fluid.surface().momenta().is_empty() => Vec::new(),
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
            "coefficients" => row.extend(self.fluid.surface().coefficients(w)),
            "energy" => row.push(self.fluid.energy(w)),
            "enstrophy" => row.push(self.fluid.enstrophy(w)),
            "levels" => {
                let levels = self.fluid.spectrum(w);
                row.extend(levels.unwrap_or_else(|_| vec![f64::NAN; n]));
            }
            "angular_momentum" => row.extend(self.fluid.surface().momenta_at(w)),
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
        let grid = self.fluid.surface().on_grid(&w);
        grid.row_iter().map(|row| row.iter().copied().collect()).collect()
    }
    /// ‖W‖, whose rounding every level and every moment shares.
    fn size(&self, _: &str, w: &ComplexMatrix) -> f64 {
        (2.0 * self.fluid.enstrophy(w) * self.fluid.n() as f64).sqrt()
    }
    fn figure(&self) -> Figure {
        Figure::Map("matrix", self.fluid.surface().ground())
    }
}
