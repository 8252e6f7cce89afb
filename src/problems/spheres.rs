//! Systems on spheres.
//!
//! **The spherical pendulum** on TS²: q̇ = ω × q, ω̇ = −(g/ℓ) q × e₃. The points (ω, q) with |q| = 1 and
//! ω·q = 0 are a coadjoint orbit of SE(3): f = (ω, (g/ℓ) e₃), Λ((R, x), (ω, q)) = (Rω + x × Rq, Rq).
//! Invariants: |q| and ω·q (the action), the energy ½|ω|² + (g/ℓ) q₃, and ω₃.
//!
//! **The Landau–Lifshitz chain** on (S²)ᴺ: ṡ_i = H_i × s_i + α (s_i × H_i) × s_i, with
//! H_i = s_{i−1} + s_{i+1} + K (s_i)₃ e₃ + B. f_i = H_i + α s_i × H_i; Λ = SO(3)ᴺ on vectors, so that no
//! rotation is ever formed. Invariants: |s_i| (the action); for α = 0 the energy
//! −Σ s_i·s_{i+1} − ½K Σ (s_i)₃² − Σ B·s_i, and with B along e₃ the total (s_i)₃.
//! Source: M. Lakshmanan, Phil. Trans. R. Soc. A 369 (2011); for TS² as an orbit of SE(3),
//! E. Celledoni, E. Çokaj, A. Leone, D. Murari, B. Owren, Int. J. Comput. Math. 99 (2022).

use nalgebra::Vector3;

use super::rigid_body::check_finite;
use super::{Ambient, Invariant, Invariants, LiePoisson, Problem, space::linear_space};
use crate::actions::{Coadjoint, Linear};
use crate::error::Error;
use crate::groups::{Power, Se3, So3};

type V = Vector3<f64>;

/// A point mass on a rod that turns in every direction; e₃ points up. Points are (ω, q).
#[derive(Clone, Copy, Debug)]
pub struct SphericalPendulum {
    /// g/ℓ.
    rate2: f64,
}

impl SphericalPendulum {
    /// From gravity over length, g/ℓ.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is not finite.
    pub fn new(gravity_over_length: f64) -> Result<Self, Error> {
        check_finite("gravity_over_length", &[gravity_over_length])?;
        Ok(SphericalPendulum { rate2: gravity_over_length })
    }

    /// The state at the direction q (normalised) with the velocity q̇ (its part along q is left out).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers that are not finite, and for q = 0.
    pub fn state(&self, q: [f64; 3], velocity: [f64; 3]) -> Result<(V, V), Error> {
        check_finite("q", &q)?;
        check_finite("velocity", &velocity)?;
        let length = V::from(q).norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(Error::out_of_range("|q|", length, "a finite number > 0"));
        }
        let q = V::from(q) / length;
        Ok((q.cross(&V::from(velocity)), q))
    }

    /// ½|ω|² + (g/ℓ) q₃.
    pub fn energy(&self, (omega, q): &(V, V)) -> f64 {
        0.5 * omega.norm_squared() + self.rate2 * q[2]
    }
}

impl Problem for SphericalPendulum {
    type Group = Se3;
    type Action = Coadjoint;
    type Work = ();

    fn group(&self) -> &Se3 {
        const { &Se3::new() }
    }
    fn action(&self) -> &Coadjoint {
        &Coadjoint
    }
    fn work(&self) {}
    #[inline]
    fn f(&self, _: f64, (omega, _): &(V, V), v: &mut (V, V), _: &mut ()) {
        *v = (*omega, V::new(0.0, 0.0, self.rate2));
    }
}

impl Ambient for SphericalPendulum {
    fn field(&self, _: f64, (omega, q): &(V, V), dy: &mut (V, V), _: &mut ()) {
        *dy = (V::new(-self.rate2 * q[1], self.rate2 * q[0], 0.0), omega.cross(q));
    }
    linear_space!();
}

/// On the dual of se(3) by −H: f = (ω, (g/ℓ) e₃) is the gradient of the energy H, affine in (ω, q).
impl LiePoisson for SphericalPendulum {
    fn hamiltonian(&self, y: &(V, V)) -> f64 {
        -self.energy(y)
    }
    fn discrete_gradient(&self, a: &(V, V), b: &(V, V), xi: &mut (V, V), _: &mut ()) {
        *xi = (-0.5 * (a.0 + b.0), V::new(0.0, 0.0, -self.rate2));
    }
}

impl Invariants for SphericalPendulum {
    fn invariants(&self) -> Vec<Invariant> {
        let mut all: Vec<_> = ["|q|²", "ω·q"].map(Invariant::of_the_action).into();
        all.extend(["energy", "ω₃"].map(Invariant::of_the_flow));
        all
    }
    fn values(&self, y: &(V, V)) -> Vec<f64> {
        vec![y.1.norm_squared(), y.0.dot(&y.1), self.energy(y), y.0[2]]
    }
}

/// Spins with exchange, anisotropy, a field and damping; the ends are joined or free.
///
/// ```
/// use lieflow::maps::Cay;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::SpinChain;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use nalgebra::Vector3;
/// let chain = SpinChain::new(100)?.with_anisotropy(0.1)?;
/// let mut spins = chain.spins(|i| Vector3::new((i as f64).sin(), (i as f64).cos(), 1.0))?;
/// let start = chain.energy(&spins);
/// let grid = TimeGrid::new([0.0, 5.0], 0.05)?;
/// integrate(&chain, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut spins, |_, _| {})?;
/// assert!((chain.energy(&spins) - start).abs() < 1e-2);
/// assert!(spins.iter().all(|s| (s.norm() - 1.0).abs() < 1e-13));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SpinChain {
    group: Power<So3>,
    periodic: bool,
    anisotropy: f64,
    damping: f64,
    field: V,
}

impl SpinChain {
    /// N spins in a ring, with exchange alone.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for N < 2.
    pub fn new(spins: usize) -> Result<Self, Error> {
        if spins < 2 {
            return Err(Error::out_of_range("spins", spins as f64, "at least 2"));
        }
        let group = Power::new(So3::new(), spins)?;
        Ok(SpinChain { group, periodic: true, anisotropy: 0.0, damping: 0.0, field: V::zeros() })
    }
    /// The ends are free.
    #[must_use]
    pub fn open(self) -> Self {
        SpinChain { periodic: false, ..self }
    }
    /// K: positive for an easy axis e₃, negative for an easy plane.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is not finite.
    pub fn with_anisotropy(self, anisotropy: f64) -> Result<Self, Error> {
        check_finite("anisotropy", &[anisotropy])?;
        Ok(SpinChain { anisotropy, ..self })
    }
    /// Gilbert's α ≥ 0: with it the energy falls.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is not finite or negative.
    pub fn with_damping(self, damping: f64) -> Result<Self, Error> {
        match damping.is_finite() && damping >= 0.0 {
            true => Ok(SpinChain { damping, ..self }),
            false => Err(Error::out_of_range("damping", damping, "a finite number ≥ 0")),
        }
    }
    /// B.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers that are not finite.
    pub fn with_field(self, field: [f64; 3]) -> Result<Self, Error> {
        check_finite("field", &field)?;
        Ok(SpinChain { field: field.into(), ..self })
    }

    /// A state: the directions of these vectors.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a vector that is 0 or not finite.
    pub fn spins(&self, mut direction: impl FnMut(usize) -> V) -> Result<Box<[V]>, Error> {
        let unit = |i: usize| {
            let s = direction(i);
            let length = s.norm();
            match length > 0.0 && length.is_finite() {
                true => Ok(s / length),
                false => Err(Error::out_of_range(format!("|s[{i}]|"), length, "finite and > 0")),
            }
        };
        (0..self.group.copies()).map(unit).collect()
    }

    /// The neighbours' sum s_{i−1} + s_{i+1}.
    #[inline]
    fn neighbours(&self, s: &[V], i: usize) -> V {
        let last = s.len() - 1;
        let left = if i > 0 { Some(i - 1) } else { self.periodic.then_some(last) };
        let right = if i < last { Some(i + 1) } else { self.periodic.then_some(0) };
        [left, right].into_iter().flatten().fold(V::zeros(), |sum, j| sum + s[j])
    }

    /// H_i.
    #[inline]
    fn effective_field(&self, s: &[V], i: usize) -> V {
        self.neighbours(s, i) + self.field + V::new(0.0, 0.0, self.anisotropy * s[i][2])
    }

    /// −Σ s_i·s_{i+1} − ½K Σ (s_i)₃² − Σ B·s_i.
    pub fn energy(&self, s: &[V]) -> f64 {
        let of_spin = |(i, spin): (usize, &V)| {
            let exchange = 0.5 * spin.dot(&self.neighbours(s, i)); // each pair is seen twice
            exchange + 0.5 * self.anisotropy * spin[2] * spin[2] + spin.dot(&self.field)
        };
        -s.iter().enumerate().map(of_spin).sum::<f64>()
    }
}

impl Problem for SpinChain {
    type Group = Power<So3>;
    type Action = Linear;
    type Work = ();

    fn group(&self) -> &Power<So3> {
        &self.group
    }
    fn action(&self) -> &Linear {
        &Linear
    }
    fn work(&self) {}
    fn f(&self, _: f64, s: &Box<[V]>, v: &mut Box<[V]>, _: &mut ()) {
        for (i, v) in v.iter_mut().enumerate() {
            *v = self.effective_field(s, i);
            if self.damping != 0.0 {
                *v += self.damping * s[i].cross(v);
            }
        }
    }
}

impl Ambient for SpinChain {
    fn field(&self, t: f64, s: &Box<[V]>, ds: &mut Box<[V]>, work: &mut ()) {
        self.f(t, s, ds, work);
        for (ds, s) in ds.iter_mut().zip(s) {
            *ds = ds.cross(s);
        }
    }
    linear_space!();
}

impl Invariants for SpinChain {
    fn invariants(&self) -> Vec<Invariant> {
        let mut all = vec![Invariant::of_the_action("Σ|s_i|²")];
        if self.damping == 0.0 {
            all.push(Invariant::of_the_flow("energy"));
            if self.field[0] == 0.0 && self.field[1] == 0.0 {
                all.push(Invariant::of_the_flow("Σ(s_i)₃"));
            }
        }
        all
    }
    fn values(&self, s: &Box<[V]>) -> Vec<f64> {
        let all = [
            s.iter().map(V::norm_squared).sum(),
            self.energy(s),
            s.iter().map(|s| s[2]).sum::<f64>(),
        ];
        all[..self.invariants().len()].into()
    }
}
