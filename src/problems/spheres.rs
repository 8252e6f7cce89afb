//! Systems on spheres: the spherical pendulum, and chains of spins.
//!
//! **The spherical pendulum** on TS²: q̇ = ω × q, ω̇ = −(g/ℓ) q × e₃. The points (ω, q) with |q| = 1 and
//! ω·q = 0 are a coadjoint orbit of SE(3): f = (ω, (g/ℓ) e₃), Λ((R, x), (ω, q)) = (Rω + x × Rq, Rq).
//! Invariants: |q| and ω·q (by the action), the energy ½|ω|² + (g/ℓ) q₃, and ω₃.
//!
//! **The Landau–Lifshitz chain** on (S²)ᴺ: ṡ_i = H_i × s_i + α (s_i × H_i) × s_i, with
//! H_i = s_{i−1} + s_{i+1} + K (s_i)₃ e₃ + B. f_i = H_i + α s_i × H_i; Λ = SO(3)ᴺ on vectors, so no
//! rotation matrix is formed. Invariants: |s_i| (by the action); for α = 0 the energy
//! −Σ s_i·s_{i+1} − ½K Σ (s_i)₃² − Σ B·s_i, and with B along e₃ the total (s_i)₃.
//! Source: M. Lakshmanan, Phil. Trans. R. Soc. A 369 (2011); for TS² as an orbit of SE(3),
//! E. Celledoni, E. Çokaj, A. Leone, D. Murari, B. Owren, Int. J. Comput. Math. 99 (2022).

use nalgebra::Vector3;

use super::{Invariant, Invariants, LiePoisson, MomentumTerms, Problem, TaylorField};
use crate::actions::{Coadjoint, Linear};
use crate::error::Error;
use crate::groups::{Power, Se3, So3};
use crate::problems::FieldStore;
use crate::scalar::Real;
use crate::so3::{add3, cross};

type V<S = f64> = Vector3<S>;

fn dot<S: Real>(a: &V<S>, b: &V<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The spherical pendulum: a point mass on a rod that swings in every direction. Points are (ω, q), and e₃ is up.
#[derive(Clone, Copy, Debug)]
pub struct SphericalPendulum<S = f64> {
    /// g/ℓ.
    rate2: S,
}

impl SphericalPendulum {
    /// Makes a pendulum with g/ℓ, gravity over length.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is not finite.
    pub fn new(gravity_over_length: f64) -> Result<Self, Error> {
        Error::finite("gravity_over_length", gravity_over_length)?;
        Ok(SphericalPendulum { rate2: gravity_over_length })
    }

    /// The state with the direction q, which is normalised, and the velocity q̇. The part of q̇ along q is removed.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers that are not finite, and for q = 0.
    pub fn state(&self, q: [f64; 3], velocity: [f64; 3]) -> Result<(V, V), Error> {
        Error::all_finite("q", &q)?;
        Error::all_finite("velocity", &velocity)?;
        let length = Error::positive("|q|", V::from(q).norm())?;
        let q = V::from(q) / length;
        Ok((q.cross(&V::from(velocity)), q))
    }

    /// The same pendulum with another number type.
    pub fn on<S: Real>(&self) -> SphericalPendulum<S> {
        SphericalPendulum { rate2: S::lit(self.rate2) }
    }
}

impl<S: Real> SphericalPendulum<S> {
    /// ½|ω|² + (g/ℓ) q₃.
    pub fn energy(&self, (omega, q): &(V<S>, V<S>)) -> S {
        S::lit(0.5) * dot(omega, omega) + self.rate2 * q[2]
    }
}

impl<S: Real> Problem for SphericalPendulum<S> {
    type Group = Se3<S>;
    type Action = Coadjoint;
    type Work = ();

    fn group(&self) -> &Se3<S> {
        const { &Se3::new() }
    }
    fn action(&self) -> &Coadjoint {
        &Coadjoint
    }
    fn work(&self) {}
    #[inline]
    fn f(&self, _: S, (omega, _): &(V<S>, V<S>), v: &mut (V<S>, V<S>), _: &mut ()) {
        *v = (*omega, V::new(S::lit(0.0), S::lit(0.0), self.rate2));
    }
    /// λ_*(f) without ω × ω = 0 and the zeros of e₃ × q. This saves half of λ_*.
    fn field(
        &self,
        _: S,
        (omega, q): &(V<S>, V<S>),
        dy: &mut (V<S>, V<S>),
        _: &mut FieldStore<Self>,
    ) {
        let torque = V::new(-(self.rate2 * q[1]), self.rate2 * q[0], S::lit(0.0));
        *dy = (torque, cross(omega, q));
    }
}

/// f is affine in (ω, q).
impl<S: Real> TaylorField for SphericalPendulum<S> {
    type Series = Vec<(V<S>, V<S>)>;

    fn series(&self, order: usize) -> Self::Series {
        self.group().momenta(order)
    }
    fn coefficient(
        &self,
        [t, h]: [S; 2],
        y: &(V<S>, V<S>),
        k: usize,
        f: &mut [(V<S>, V<S>)],
        series: &mut Self::Series,
    ) {
        let y = self.group().next(h, y, k, f, series);
        self.f(t, y, &mut f[k], &mut ());
        if k > 0 {
            f[k].1 = V::from_element(S::lit(0.0));
        }
    }
}

/// The Hamiltonian on the dual of se(3) is −H: f = (ω, (g/ℓ) e₃) is the gradient of the energy H, affine in (ω, q).
impl<S: Real> LiePoisson for SphericalPendulum<S> {
    fn hamiltonian(&self, y: &(V<S>, V<S>)) -> S {
        -self.energy(y)
    }
    fn discrete_gradient(
        &self,
        a: &(V<S>, V<S>),
        b: &(V<S>, V<S>),
        xi: &mut (V<S>, V<S>),
        _: (&mut (V<S>, V<S>), &mut (V<S>, V<S>)),
        _: &mut (),
    ) {
        let twice = add3(&a.0, &b.0);
        let zero = S::lit(0.0);
        *xi = (twice.map(|w| S::lit(-0.5) * w), V::new(zero, zero, -self.rate2));
    }
}

impl<S: Real> Invariants for SphericalPendulum<S> {
    fn invariants(&self) -> Vec<Invariant> {
        vec![
            Invariant::of_the_action("|q|²", 2),
            Invariant::of_the_action("ω·q", 2).in_terms(),
            Invariant::of_the_flow("energy", 2).in_terms(),
            Invariant::of_the_flow("ω₃", 1).in_terms(),
        ]
    }
    fn values(&self, y: &(V<S>, V<S>)) -> Vec<S> {
        vec![dot(&y.1, &y.1), dot(&y.0, &y.1), self.energy(y), y.0[2]]
    }
    fn sizes(&self, (omega, q): &(V<S>, V<S>)) -> Vec<S> {
        let (omega2, q2) = (dot(omega, omega), dot(q, q));
        let along = (omega2 * q2).sqrt();
        vec![q2, along, S::lit(0.5) * omega2 + self.rate2.abs() * q2.sqrt(), along]
    }
}

/// A chain of spins with exchange, anisotropy, a field and damping. Its ends are joined or free.
///
/// ```
/// use lieflow::maps::Cay;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::SpinChain;
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
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
pub struct SpinChain<S = f64> {
    group: Power<So3<S>>,
    periodic: bool,
    anisotropy: S,
    damping: S,
    field: V<S>,
}

impl SpinChain {
    /// Makes a ring of N spins with exchange only.
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
    /// Makes the ends free.
    #[must_use]
    pub fn open(self) -> Self {
        SpinChain { periodic: false, ..self }
    }
    /// Sets K: positive for an easy axis e₃, negative for an easy plane.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is not finite.
    pub fn with_anisotropy(self, anisotropy: f64) -> Result<Self, Error> {
        Error::finite("anisotropy", anisotropy)?;
        Ok(SpinChain { anisotropy, ..self })
    }
    /// Sets Gilbert's damping α ≥ 0. With α > 0 the energy falls.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is not finite or negative.
    pub fn with_damping(self, damping: f64) -> Result<Self, Error> {
        Ok(SpinChain { damping: Error::not_negative("damping", damping)?, ..self })
    }
    /// Sets the field B.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers that are not finite.
    pub fn with_field(self, field: [f64; 3]) -> Result<Self, Error> {
        Error::all_finite("field", &field)?;
        Ok(SpinChain { field: field.into(), ..self })
    }

    /// A state from vectors, which are normalised.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a vector that is 0 or not finite.
    pub fn spins(&self, mut direction: impl FnMut(usize) -> V) -> Result<Box<[V]>, Error> {
        let unit = |i: usize| {
            let s = direction(i);
            let length = s.norm();
            match length > 0.0 && length.is_finite() {
                true => Ok(s / length),
                false => {
                    Err(Error::out_of_range(format!("|s[{i}]|"), length, "a finite length > 0"))
                }
            }
        };
        (0..self.group.copies()).map(unit).collect()
    }

    /// The same chain with another number type.
    ///
    /// # Errors
    /// None, because [`new`](Self::new) has checked the numbers.
    pub fn on<S: Real>(&self) -> Result<SpinChain<S>, Error> {
        Ok(SpinChain {
            group: Power::new(So3::new(), self.group.copies())?,
            periodic: self.periodic,
            anisotropy: S::lit(self.anisotropy),
            damping: S::lit(self.damping),
            field: self.field.map(S::lit),
        })
    }
}

impl<S: Real> SpinChain<S> {
    /// The sum of the neighbours, s_{i−1} + s_{i+1}.
    #[inline]
    fn neighbours(&self, s: &[V<S>], i: usize) -> V<S> {
        let last = s.len() - 1;
        let left = if i > 0 { Some(i - 1) } else { self.periodic.then_some(last) };
        let right = if i < last { Some(i + 1) } else { self.periodic.then_some(0) };
        match (left, right) {
            (Some(left), Some(right)) => add3(&s[left], &s[right]),
            (Some(only), None) | (None, Some(only)) => s[only],
            (None, None) => V::from_element(S::lit(0.0)),
        }
    }

    /// H_i.
    #[inline]
    fn effective_field(&self, s: &[V<S>], i: usize) -> V<S> {
        let mut field = add3(&self.neighbours(s, i), &self.field);
        field[2] += self.anisotropy * s[i][2];
        field
    }

    /// −Σ s_i·s_{i+1} − ½K Σ (s_i)₃² − Σ B·s_i.
    pub fn energy(&self, s: &[V<S>]) -> S {
        let half = S::lit(0.5);
        let of_spin = |(i, spin): (usize, &V<S>)| {
            let exchange = half * dot(spin, &self.neighbours(s, i)); // each pair is seen twice
            exchange + half * self.anisotropy * spin[2] * spin[2] + dot(spin, &self.field)
        };
        -s.iter().enumerate().map(of_spin).fold(S::lit(0.0), |sum, x| sum + x)
    }
}

impl<S: Real> Problem for SpinChain<S> {
    type Group = Power<So3<S>>;
    type Action = Linear;
    type Work = ();

    fn group(&self) -> &Power<So3<S>> {
        &self.group
    }
    fn action(&self) -> &Linear {
        &Linear
    }
    fn work(&self) {}
    fn f(&self, _: S, s: &Box<[V<S>]>, v: &mut Box<[V<S>]>, _: &mut ()) {
        for (i, v) in v.iter_mut().enumerate() {
            *v = self.effective_field(s, i);
            if self.damping != S::lit(0.0) {
                let down = cross(&s[i], v);
                for k in 0..3 {
                    v[k] += self.damping * down[k];
                }
            }
        }
    }
}

/// f = −∇H for the energy H of degree 2, if there is no damping. With damping there is no H, and the discrete gradient
/// is NaN.
impl<S: Real> LiePoisson for SpinChain<S> {
    fn hamiltonian(&self, s: &Box<[V<S>]>) -> S {
        self.energy(s)
    }
    fn discrete_gradient(
        &self,
        a: &Box<[V<S>]>,
        b: &Box<[V<S>]>,
        xi: &mut Box<[V<S>]>,
        _: (&mut Box<[V<S>]>, &mut Box<[V<S>]>),
        _: &mut (),
    ) {
        let conserves = self.damping == S::lit(0.0);
        let half = S::lit(if conserves { -0.5 } else { f64::NAN });
        for (i, xi) in xi.iter_mut().enumerate() {
            let twice = add3(&self.effective_field(a, i), &self.effective_field(b, i));
            *xi = twice.map(|x| half * x);
        }
    }
}

impl<S: Real> Invariants for SpinChain<S> {
    fn invariants(&self) -> Vec<Invariant> {
        let mut all = vec![Invariant::of_the_action("Σ|s_i|²", 2)];
        let zero = S::lit(0.0);
        if self.damping == zero {
            all.push(Invariant::of_the_flow("energy", 2).in_terms());
            if self.field[0] == zero && self.field[1] == zero {
                all.push(Invariant::of_the_flow("Σ(s_i)₃", 1).in_terms());
            }
        }
        all
    }
    fn values(&self, s: &Box<[V<S>]>) -> Vec<S> {
        let sum = |of: fn(&V<S>) -> S| s.iter().map(of).fold(S::lit(0.0), |sum, x| sum + x);
        let all = [sum(|s| dot(s, s)), self.energy(s), sum(|s| s[2])];
        all[..self.invariants().len()].into()
    }
    /// Each spin has an energy of some units.
    fn sizes(&self, s: &Box<[V<S>]>) -> Vec<S> {
        let lengths2 = s.iter().map(|s| dot(s, s)).fold(S::lit(0.0), |sum, x| sum + x);
        let size = lengths2 * (S::lit(1.0) + dot(&self.field, &self.field).sqrt());
        vec![size; self.invariants().len()]
    }
}
