//! The surfaces of a fluid as one type: they share what is compiled for a problem.

use faer::Mat;
use lieflow::groups::ComplexMatrix;
use lieflow::problems::{Sphere, Surface, Torus, Zeitlin};

/// A sphere or a torus.
#[derive(Clone, Debug)]
pub enum Place {
    /// The sphere.
    Sphere(Zeitlin<Sphere>),
    /// The torus.
    Torus(Zeitlin<Torus>),
}

/// Rows and columns of the picture.
const SPHERE_GRID: [usize; 2] = [48, 96];
const TORUS_GRID: [usize; 2] = [96, 96];

macro_rules! on_each {
    ($place:expr, $fluid:ident => $value:expr) => {
        match $place {
            Place::Sphere($fluid) => $value,
            Place::Torus($fluid) => $value,
        }
    };
}

impl Place {
    /// Its name in scenes.
    pub fn name(&self) -> &'static str {
        match self {
            Place::Sphere(_) => "sphere",
            Place::Torus(_) => "torus",
        }
    }
    /// The values of the vorticity on the grid of the picture.
    pub fn on_grid(&self, w: &ComplexMatrix) -> Mat<f64> {
        match self {
            Place::Sphere(fluid) => fluid.on_grid(w, SPHERE_GRID[0], SPHERE_GRID[1]),
            Place::Torus(fluid) => fluid.on_grid(w, TORUS_GRID[0], TORUS_GRID[1]),
        }
    }
    /// The names of the coefficients: w_lm on the sphere, (a, b) of a cos(m·x) + b sin(m·x) on the torus.
    pub fn coefficient_names(&self) -> Vec<String> {
        match self {
            Place::Sphere(fluid) => (1..=fluid.n() * fluid.n()).map(|k| format!("w{k}")).collect(),
            Place::Torus(fluid) => {
                let names = |[k, l]: [i32; 2]| ["a", "b"].map(|part| format!("{part}{k}_{l}"));
                half_plane(fluid.surface()).flat_map(names).collect()
            }
        }
    }
    /// The coefficients of these names.
    pub fn coefficients(&self, w: &ComplexMatrix) -> Vec<f64> {
        match self {
            Place::Sphere(fluid) => fluid.coefficients(w, fluid.n()),
            Place::Torus(fluid) => {
                let (modes, max) = (fluid.modes(w), fluid.surface().wave_number_max() as i32);
                let at = |m: i32| (m + max) as usize;
                // ω_m = (a − ib)/2.
                half_plane(fluid.surface())
                    .map(|[k, l]| modes[(at(k), at(l))])
                    .flat_map(|omega| [2.0 * omega.re, -2.0 * omega.im])
                    .collect()
            }
        }
    }
}

/// One wave vector of each pair m, −m, by m₁ and then by m₂.
fn half_plane(torus: &Torus) -> impl Iterator<Item = [i32; 2]> {
    let max = torus.wave_number_max() as i32;
    let all = (0..=max).flat_map(move |k| (-max..=max).map(move |l| [k, l]));
    all.filter(|m| m[0] > 0 || m[1] > 0)
}

impl Surface for Place {
    fn n(&self) -> usize {
        on_each!(self, fluid => fluid.surface().n())
    }
    fn rate(&self) -> f64 {
        on_each!(self, fluid => fluid.surface().rate())
    }
    fn solve(&self, x: &mut ComplexMatrix, scratch: &mut [Mat<f64>; 2]) {
        on_each!(self, fluid => fluid.surface().solve(x, scratch));
    }
    fn scratch(&self) -> [Mat<f64>; 2] {
        on_each!(self, fluid => fluid.surface().scratch())
    }
    fn momenta(&self) -> &'static [&'static str] {
        on_each!(self, fluid => fluid.surface().momenta())
    }
    fn momenta_at(&self, w: &ComplexMatrix) -> Vec<f64> {
        on_each!(self, fluid => fluid.surface().momenta_at(w))
    }
}
