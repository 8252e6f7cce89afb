//! Ideal fluids on a sphere and on a torus, by Zeitlin's model.
//!
//! Euler's equation in two dimensions is ω̇ = {ψ, ω} with Δψ = ω. In the model the vorticity ω is a skew-Hermitian N×N
//! matrix W, and the Poisson bracket is a commutator:
//!
//! Ẇ = \[P, W\]/ħ, ΔP = W: an isospectral flow. f(W) = P/ħ ∈ u(N); Λ(g, W) = g W g†.
//!
//! | | |
//! |---|---|
//! | mean of a product fg over the surface | ⟨F, G⟩ = tr(F†G)/N |
//! | energy ½ mean\|u\|² = −½ mean(ψω) | −½⟨P, W⟩ |
//! | enstrophy ½ mean(ω²) | ½⟨W, W⟩ |
//! | mean(ω^k) | tr((−iW)^k)/N, the Casimirs |
//! | the values that ω takes | the eigenvalues of −iW |
//!
//! Invariants: by the action the spectrum of W, and so every Casimir and the enstrophy; by the flow the energy, and on
//! the sphere the angular momentum. [`FluidMidpoint`](crate::methods::FluidMidpoint) is made for these problems. Every
//! method for a [`Problem`] with the group [`Unitary`] runs on them, too.
//! Source: V. Zeitlin, Physica D 49 (1991) for the torus, Phys. Rev. Lett. 93 (2004) for the sphere.

mod fields;
mod harmonics;
mod sphere;
mod torus;

pub use fields::Vortex;
pub use sphere::Sphere;
pub use torus::Torus;

use faer::Mat;

use super::{Invariant, Invariants, LiePoisson, Problem};
use crate::actions::Conjugation;
use crate::dense::{hermitian_eigenvalues, mirror};
use crate::error::Error;
use crate::groups::{ComplexMatrix, LieAlgebra, Unitary};
use crate::scalar::{Ops, tally};
use crate::space::Metric;

/// A quantised surface for Zeitlin's model.
pub trait Surface {
    /// The size N of the matrices.
    fn n(&self) -> usize;
    /// 1/ħ, the rate of Ẇ = \[P, W\]/ħ.
    fn rate(&self) -> f64;
    /// x ← Δ⁻¹x with trace 0. It reads and writes the lower triangle and the diagonal of a skew-Hermitian x. The upper
    /// triangle is undefined afterwards.
    fn solve(&self, x: &mut ComplexMatrix, scratch: &mut [Mat<f64>; 2]);
    /// Makes the scratch of [`solve`](Self::solve). Only this call allocates.
    fn scratch(&self) -> [Mat<f64>; 2];
    /// Linear invariants of the flow, by name.
    fn momenta(&self) -> &'static [&'static str] {
        &[]
    }
    /// The values of the linear invariants at W.
    fn momenta_at(&self, _w: &ComplexMatrix) -> Vec<f64> {
        Vec::new()
    }
}

/// The fluid on a surface: Ẇ = \[P, W\]/ħ, ΔP = W.
///
/// ```
/// use lieflow::methods::FluidMidpoint;
/// use lieflow::problems::Zeitlin;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use rand::SeedableRng;
/// use rand_pcg::Pcg64;
/// let fluid = Zeitlin::sphere(16)?;
/// let mut w = fluid.random(&mut Pcg64::seed_from_u64(7), 6)?;
/// let (energy, levels) = (fluid.energy(&w), fluid.spectrum(&w)?);
/// let grid = TimeGrid::new([0.0, 2.0], 0.05)?;
/// integrate(&fluid, &FluidMidpoint::energy(), &grid, &SaveAt::Ends, &mut w, |_, _| {})?;
/// assert!((fluid.energy(&w) - energy).abs() < 1e-14);
/// for (now, then) in fluid.spectrum(&w)?.iter().zip(levels) {
///     assert!((now - then).abs() < 1e-13);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Zeitlin<S> {
    group: Unitary,
    surface: S,
}

impl Zeitlin<Sphere> {
    /// The sphere with N×N matrices: harmonics up to l = N − 1.
    ///
    /// # Errors
    /// As [`Sphere::new`].
    pub fn sphere(n: usize) -> Result<Self, Error> {
        Zeitlin::new(Sphere::new(n)?)
    }
}

impl<S: Surface> Zeitlin<S> {
    /// The fluid on a surface.
    ///
    /// # Errors
    /// As [`Unitary::new`].
    pub fn new(surface: S) -> Result<Self, Error> {
        Ok(Zeitlin { group: Unitary::new(surface.n())?, surface })
    }
    /// The size N of the matrices.
    pub fn n(&self) -> usize {
        self.surface.n()
    }
    /// ħ: Ẇ = \[P, W\]/ħ.
    pub fn hbar(&self) -> f64 {
        1.0 / self.surface.rate()
    }
    /// The surface.
    pub fn surface(&self) -> &S {
        &self.surface
    }

    /// Checks that W is a vorticity, and returns it: N×N, finite and skew-Hermitian within
    /// [`MEMBERSHIP`](crate::groups::MEMBERSHIP).
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::NotFiniteEntry`], [`Error::NotInAlgebra`].
    pub fn vorticity(&self, w: ComplexMatrix) -> Result<ComplexMatrix, Error> {
        w.check("W", self.n(), self.n())?;
        self.group.check("W", &w)?;
        Ok(w)
    }

    /// P = Δ⁻¹W. Allocates.
    pub fn stream(&self, w: &ComplexMatrix) -> ComplexMatrix {
        let mut p = w.clone();
        self.solve(&mut p, &mut self.surface.scratch());
        p
    }

    fn solve(&self, p: &mut ComplexMatrix, scratch: &mut [Mat<f64>; 2]) {
        self.surface.solve(p, scratch);
        mirror(&mut p.re, -1.0);
        mirror(&mut p.im, 1.0);
    }

    /// ⟨A, B⟩ = Re tr(A†B)/N, the mean of a product.
    pub fn inner(&self, a: &ComplexMatrix, b: &ComplexMatrix) -> f64 {
        let column = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut total = 0.0;
        tally(|| Ops::dots(1, 2 * self.n() * self.n()) + Ops::divs(1));
        for (a, b) in a.parts().into_iter().zip(b.parts()) {
            for j in 0..a.ncols() {
                total += column(a.col_as_slice(j), b.col_as_slice(j));
            }
        }
        total / self.n() as f64
    }

    /// −½⟨Δ⁻¹W, W⟩, the mean of ½|u|². Allocates.
    pub fn energy(&self, w: &ComplexMatrix) -> f64 {
        -0.5 * self.inner(&self.stream(w), w)
    }
    /// ½⟨W, W⟩, the mean of ½ω².
    pub fn enstrophy(&self, w: &ComplexMatrix) -> f64 {
        0.5 * self.inner(w, w)
    }
    /// The eigenvalues of −iW in ascending order: the values that the vorticity takes. Allocates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if they are not found.
    pub fn spectrum(&self, w: &ComplexMatrix) -> Result<Vec<f64>, Error> {
        let hermitian = Mat::from_fn(w.nrows(), w.ncols(), |i, j| {
            let z = w.get(i, j);
            faer::c64::new(z.im, -z.re)
        });
        let failed = |_| Error::out_of_range("W", f64::NAN, "a matrix with eigenvalues");
        hermitian_eigenvalues(hermitian.as_ref()).map_err(failed)
    }
    /// tr((−iW)^k)/N, the mean of ω^k. Allocates.
    ///
    /// # Errors
    /// As [`spectrum`](Self::spectrum).
    pub fn casimir(&self, w: &ComplexMatrix, k: i32) -> Result<f64, Error> {
        let levels = self.spectrum(w)?;
        Ok(levels.iter().map(|x| x.powi(k)).sum::<f64>() / self.n() as f64)
    }
}

/// The scratch of f of a fluid: P, and the scratch of its solve.
#[derive(Debug)]
pub struct StreamWork {
    p: ComplexMatrix,
    scratch: [Mat<f64>; 2],
}

impl<S: Surface> Problem for Zeitlin<S> {
    type Group = Unitary;
    type Action = Conjugation;
    type Work = StreamWork;

    fn group(&self) -> &Unitary {
        &self.group
    }
    fn action(&self) -> &Conjugation {
        &Conjugation
    }
    fn work(&self) -> StreamWork {
        StreamWork { p: self.group.zero(), scratch: self.surface.scratch() }
    }
    /// P/ħ.
    fn f(&self, _: f64, w: &ComplexMatrix, v: &mut ComplexMatrix, work: &mut StreamWork) {
        work.p.assign(w);
        self.solve(&mut work.p, &mut work.scratch);
        self.group.set_zero(v);
        self.group.axpy(self.surface.rate(), &work.p, v);
    }
}

impl<S: Surface> LiePoisson for Zeitlin<S> {
    fn hamiltonian(&self, w: &ComplexMatrix) -> f64 {
        self.energy(w)
    }
    /// −Δ⁻¹(a + b)/2ħ, for ⟨m, v⟩ = ħ⟨M, V⟩.
    fn discrete_gradient(
        &self,
        a: &ComplexMatrix,
        b: &ComplexMatrix,
        xi: &mut ComplexMatrix,
        _: (&mut ComplexMatrix, &mut ComplexMatrix),
        work: &mut StreamWork,
    ) {
        work.p.assign(a);
        self.group.axpy(1.0, b, &mut work.p);
        self.solve(&mut work.p, &mut work.scratch);
        self.group.set_zero(xi);
        self.group.axpy(-0.5 * self.surface.rate(), &work.p, xi);
    }
}

impl<S: Surface> Invariants for Zeitlin<S> {
    fn invariants(&self) -> Vec<Invariant> {
        let mut all = vec![
            Invariant::of_the_flow("energy", 2),
            Invariant::of_the_action("enstrophy", 2),
            Invariant::of_the_action("mean ω³", 3),
            Invariant::of_the_action("mean ω⁴", 4),
        ];
        all.extend(self.surface.momenta().iter().map(|m| Invariant::of_the_flow(*m, 1)));
        all
    }
    fn values(&self, w: &ComplexMatrix) -> Vec<f64> {
        let casimir = |k| self.casimir(w, k).unwrap_or(f64::NAN);
        let mut all = vec![self.energy(w), self.enstrophy(w), casimir(3), casimir(4)];
        all.extend(self.surface.momenta_at(w));
        all
    }
}
