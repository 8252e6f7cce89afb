//! `kind = "fluid"`: an ideal fluid on the sphere or the torus by Zeitlin's model, N×N matrices; see
//! [`Zeitlin`].
//!
//! Two midpoint rules are made for it: `isospectral2`, which keeps the Lie–Poisson structure, and
//! `energy-casimir` with cay, which keeps the energy; both keep the spectrum.

mod start;

use lieflow::groups::ComplexMatrix;
use lieflow::problems::{Surface, Zeitlin};
use lieflow_runs::spaces::Place;

use self::start::{Random, VortexKeys, Vorticity, check_size, check_surface};
use super::entries::numbered;
use super::prelude::*;
use crate::problem::Ground;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "fluid",
    equation: "Ẇ = [P, W]/ħ, ΔP = W: vorticity ω carried by the stream function ψ, Δψ = ω",
    summary: "an ideal fluid on the sphere or the torus, Zeitlin's model with N×N matrices",
    ..Kind::of::<Keys, Fluid>(|section| read_with(section, read))
};

keys! { Keys {
    surface: String = "\"sphere\", or \"torus\": the square of side 2π, periodic",
    n: Whole<2> =
        "N, at most 512: harmonics up to the degree N - 1 on the sphere; on the torus odd, wave numbers up to \
         (N - 1)/2",
    random: Option<Random> =
        "{seed, below}: Gaussian coefficients of the degrees or wave numbers below that, of size 1",
    jets: Option<Vec<Reals<2>>> =
        "instead of random, a list of [degree, amplitude] of zonal harmonics on the sphere, of [k, a] for \
         a cos(ky) on the torus",
    modes: Option<Vec<List>> =
        "with jets or instead, a list of [degree, order, amplitude] on the sphere, of [m1, m2, a, b] for \
         a cos(m1 x + m2 y) + b sin(m1 x + m2 y) on the torus",
    vortices: Option<Vec<VortexKeys>> =
        "with jets and modes or instead of them, a list of {latitude, longitude, circulation, width} in radians on the sphere, of \
         {x, y, circulation, width} on the torus",
} }

/// The levels of a larger N are shown where they are asked for, and not watched: each row takes an eigenvalue
/// problem.
const WATCHED: usize = 64;

/// The fluid with its initial vorticity.
#[derive(Clone, Debug)]
struct Fluid {
    fluid: Zeitlin<Place>,
    start: ComplexMatrix,
}

type Q = Quantity<Fluid>;

/// The places on and below the diagonal, column by column.
fn below(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |j| (j..n).map(move |i| (i, j)))
}

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let Keys { surface, n, random, jets, modes, vortices, .. } = keys;
    let (surface, size) = (surface.and_then(check_surface), n.and_then(check_size));
    let (surface, n) = all!(surface, size)?;
    let (place, start) = Vorticity { random, jets, modes, vortices }.on(&surface, n)?;
    Ok(Forms::of(Fluid { fluid: Zeitlin::new(place)?, start }))
}

impl Fluid {
    /// ‖W‖, whose rounding every level and every moment shares.
    fn size(&self, w: &ComplexMatrix) -> f64 {
        (2.0 * self.fluid.enstrophy(w) * self.fluid.n() as f64).sqrt()
    }
}

impl System for Fluid {
    type Problem = Zeitlin<Place>;

    const STATE: &'static [&'static str] = &["matrix"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "matrix",
            &["w1_1", "re2_1", "im2_1", "…", "wN_N"],
            "W on and below the diagonal, column by column: the imaginary part of the diagonal, real and imaginary \
             parts below it",
            |fluid, _, w, row| {
                for (i, j) in below(fluid.fluid.n()) {
                    if i != j {
                        row.push(w.re[(i, j)]);
                    }
                    row.push(w.im[(i, j)]);
                }
            },
        )
        .with_columns(|fluid| {
            let entry = |(i, j): (usize, usize)| match i == j {
                true => vec![format!("w{}_{}", i + 1, j + 1)],
                false => ["re", "im"].map(|part| format!("{part}{}_{}", i + 1, j + 1)).into(),
            };
            below(fluid.fluid.n()).flat_map(entry).collect()
        })
        .of_numbers(|_| Numbers::SkewHermitian),
        Q::numbers(
            "coefficients",
            &["w1", "…", "wNN"],
            "coefficients of the harmonics, by degree l and then by order -l to l; on the torus a0_1 b0_1 …, a \
             and b of the waves of one of every m and -m, by m1 and then by m2",
            |fluid, _, w, row| row.extend(fluid.fluid.surface().coefficients(w)),
        )
        .with_columns(|fluid| fluid.fluid.surface().coefficient_names()),
        Q::number("energy", "kinetic energy", |fluid, _, w| fluid.fluid.energy(w))
            .kept(Law::by_the_flow(2)),
        Q::number("enstrophy", "half the mean of the vorticity's square", |fluid, _, w| {
            fluid.fluid.enstrophy(w)
        })
        .kept(Law::by_the_action(2)),
        Q::numbers(
            "levels",
            &["level1", "…", "levelN"],
            "the values that the vorticity takes, in ascending order",
            |fluid, _, w, row| {
                let levels = fluid.fluid.spectrum(w);
                row.extend(levels.unwrap_or_else(|_| vec![f64::NAN; w.re.nrows()]));
            },
        )
        .with_columns(|fluid| numbered("level", fluid.fluid.n()))
        .kept_where(|fluid| (fluid.fluid.n() <= WATCHED).then(|| Law::by_the_action(0)))
        .in_terms(Fluid::size),
        Q::numbers(
            "angular_momentum",
            &["l1", "l2", "l3"],
            "angular momentum; on the sphere",
            |fluid, _, w, row| row.extend(fluid.fluid.surface().momenta_at(w)),
        )
        .kept(Law::by_the_flow(1))
        .in_terms(Fluid::size)
        .missing_where(|fluid| {
            let none = fluid.fluid.surface().momenta().is_empty();
            none.then_some("a fluid on the torus has none")
        }),
    ];

    fn problem(&self) -> Result<Start<Zeitlin<Place>>, Error> {
        Ok((self.fluid.clone(), self.start.clone()))
    }
    fn modelled(&self) -> String {
        let (n, surface) = (self.fluid.n(), self.fluid.surface().name());
        format!("vorticity on the {surface} in u({n}), conjugated by U({n})")
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
    fn figure(&self) -> Figure {
        let ground = match self.fluid.surface() {
            Place::Sphere(_) => Ground::Sphere,
            Place::Torus(_) => Ground::Torus,
        };
        Figure::Map("matrix", ground)
    }
}
