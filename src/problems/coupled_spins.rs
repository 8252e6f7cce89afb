//! Spins with couplings and fields of each bond and site, which may depend on time.
//!
//! ṡ_i = H_i × s_i + α (s_i × H_i) × s_i on (S²)ᴺ, with H_i = −∂E/∂s_i and
//!
//! E = −Σ s_i·J s_j + Σ D·(s_i × s_j) − ½ Σ s_i·K s_i − Σ B·s_i.
//!
//! The first two sums are over the bonds (i, j), the others over the sites. J and K are diagonal, D is the vector of
//! Dzyaloshinskii and Moriya. f_i = H_i + α s_i × H_i; Λ = SO(3)ᴺ on vectors. A uniform chain without D is
//! [`SpinChain`](super::SpinChain), which is faster.
//!
//! Invariants: |s_i| (by the action); E, where nothing depends on time and α = 0.
//! Source: T. Moriya, Phys. Rev. 120 (1960), for D; M. Lakshmanan, Phil. Trans. R. Soc. A 369 (2011).

use nalgebra::Vector3;

use super::{LiePoisson, Problem};
use crate::actions::Linear;
use crate::error::Error;
use crate::groups::{Power, So3};
use crate::scalar::Real;
use crate::so3::{add3, cross};

type V<S> = Vector3<S>;

/// Two spins that are coupled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bond<S = f64> {
    /// i and j, from 0.
    pub sites: [usize; 2],
    /// The diagonal of J: three equal numbers for isotropic exchange, positive for a ferromagnet.
    pub exchange: V<S>,
    /// D. Its sign is that of E = D·(s_i × s_j).
    pub dm: V<S>,
}

/// What one spin is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site<S = f64> {
    /// The diagonal of K: positive for an easy axis.
    pub anisotropy: V<S>,
    /// The field B.
    pub field: V<S>,
}

/// The bonds and the sites.
#[derive(Clone, Debug, PartialEq)]
pub struct Couplings<S = f64> {
    /// The bonds.
    pub bonds: Box<[Bond<S>]>,
    /// The sites, one for each spin.
    pub sites: Box<[Site<S>]>,
}

fn dot<S: Real>(a: &V<S>, b: &V<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn times<S: Real>(a: &V<S>, b: &V<S>) -> V<S> {
    V::new(a[0] * b[0], a[1] * b[1], a[2] * b[2])
}

impl<S: Real> Couplings<S> {
    /// h ← the H_i.
    fn fields(&self, s: &[V<S>], h: &mut [V<S>]) {
        for ((h, s), site) in h.iter_mut().zip(s).zip(&self.sites) {
            *h = add3(&site.field, &times(&site.anisotropy, s));
        }
        for Bond { sites: [i, j], exchange, dm } in &self.bonds {
            let of_j = add3(&times(exchange, &s[*j]), &cross(dm, &s[*j]));
            let of_i = add3(&times(exchange, &s[*i]), &cross(&s[*i], dm));
            h[*i] = add3(&h[*i], &of_j);
            h[*j] = add3(&h[*j], &of_i);
        }
    }

    /// The energy E.
    pub fn energy(&self, s: &[V<S>]) -> S {
        let zero = S::lit(0.0);
        let of_bond = |Bond { sites: [i, j], exchange, dm }: &Bond<S>| {
            dot(dm, &cross(&s[*i], &s[*j])) - dot(&s[*i], &times(exchange, &s[*j]))
        };
        let of_site = |(site, s): (&Site<S>, &V<S>)| {
            S::lit(0.5) * dot(s, &times(&site.anisotropy, s)) + dot(&site.field, s)
        };
        let bonds = self.bonds.iter().map(of_bond).fold(zero, |sum, x| sum + x);
        self.sites.iter().zip(s).map(of_site).fold(bonds, |sum, x| sum - x)
    }
}

/// How couplings depend on time: a closure `|t, couplings|` that writes those that do, or [`Constant`].
pub trait CouplingsAt<S>: Send + Sync {
    /// couplings ← those at t. `constant` are those that the problem was made with.
    fn write(&self, t: S, constant: &Couplings<S>, couplings: &mut Couplings<S>);
}

/// Couplings that do not depend on time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Constant;

impl<S> CouplingsAt<S> for Constant {
    #[inline]
    fn write(&self, _: S, _: &Couplings<S>, _: &mut Couplings<S>) {}
}

impl<S: Real, F: Fn(S, &mut Couplings<S>) + Send + Sync> CouplingsAt<S> for F {
    #[inline]
    fn write(&self, t: S, constant: &Couplings<S>, couplings: &mut Couplings<S>) {
        // What was written at another time is no part of f(t).
        couplings.bonds.clone_from(&constant.bonds);
        couplings.sites.clone_from(&constant.sites);
        self(t, couplings);
    }
}

/// Spins on any bonds.
///
/// ```
/// use lieflow::maps::Cay;
/// use lieflow::methods::{Rkmk, tableau::RK4};
/// use lieflow::problems::{Bond, Couplings, CoupledSpins, Site};
/// use lieflow::{SaveAt, TimeGrid, integrate};
/// use lieflow::nalgebra::Vector3;
/// // Two spins with exchange and a Dzyaloshinskii–Moriya vector, in a field along e₃ that grows with time.
/// let bond = Bond { sites: [0, 1], exchange: Vector3::repeat(1.0), dm: Vector3::new(0.0, 0.0, 0.3) };
/// let site = Site { anisotropy: Vector3::zeros(), field: Vector3::zeros() };
/// let couplings = Couplings { bonds: [bond].into(), sites: [site; 2].into() };
/// let spins = CoupledSpins::new(couplings, 0.0, |t: f64, couplings: &mut Couplings| {
///     couplings.sites.iter_mut().for_each(|site| site.field[2] = 0.1 * t);
/// })?;
/// let mut s = vec![Vector3::x(), Vector3::z()].into_boxed_slice();
/// let grid = TimeGrid::new([0.0, 5.0], 0.01)?;
/// integrate(&spins, &Rkmk::new(RK4, Cay), &grid, &SaveAt::Ends, &mut s, |_, _| {})?;
/// assert!((s[0][2] + s[1][2] - 1.0).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct CoupledSpins<S = f64, C = Constant> {
    group: Power<So3<S>>,
    couplings: Couplings<S>,
    damping: S,
    at: C,
}

impl<S: Real, C: CouplingsAt<S>> CoupledSpins<S, C> {
    /// Makes the problem from couplings, Gilbert's damping α and what changes the couplings with time.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for no sites, for a bond of a site with itself or with one that is not there, and for a damping
    /// that is negative or not finite.
    pub fn new(couplings: Couplings<S>, damping: S, at: C) -> Result<Self, Error>
    where
        S: Into<f64>,
    {
        let group = Power::new(So3::new(), couplings.sites.len())?;
        let wrong = |i: usize, j: usize| i == j || i.max(j) >= couplings.sites.len();
        if let Some(b) = couplings.bonds.iter().position(|bond| wrong(bond.sites[0], bond.sites[1]))
        {
            let [i, j] = couplings.bonds[b].sites;
            let expected = format!("two different sites below {}", couplings.sites.len());
            let value = i.max(j) as f64;
            return Err(Error::OutOfRange { arg: format!("bonds[{b}].sites"), value, expected });
        }
        Error::not_negative("damping", damping.into())?;
        Ok(CoupledSpins { group, couplings, damping, at })
    }
}

impl<S: Real, C: CouplingsAt<S>> Problem for CoupledSpins<S, C> {
    type Group = Power<So3<S>>;
    type Action = Linear;
    /// The couplings at the time of f.
    type Work = Couplings<S>;

    fn group(&self) -> &Power<So3<S>> {
        &self.group
    }
    fn action(&self) -> &Linear {
        &Linear
    }
    fn work(&self) -> Couplings<S> {
        self.couplings.clone()
    }
    fn f(&self, t: S, s: &Box<[V<S>]>, v: &mut Box<[V<S>]>, couplings: &mut Couplings<S>) {
        self.at.write(t, &self.couplings, couplings);
        couplings.fields(s, v);
        if self.damping != S::lit(0.0) {
            for (v, s) in v.iter_mut().zip(s) {
                let down = cross(s, v);
                for k in 0..3 {
                    v[k] += self.damping * down[k];
                }
            }
        }
    }
}

/// f = −∇E for constant couplings, if there is no damping. With damping the discrete gradient is NaN.
impl<S: Real> LiePoisson for CoupledSpins<S, Constant> {
    fn hamiltonian(&self, s: &Box<[V<S>]>) -> S {
        self.couplings.energy(s)
    }
    fn discrete_gradient(
        &self,
        a: &Box<[V<S>]>,
        b: &Box<[V<S>]>,
        xi: &mut Box<[V<S>]>,
        (middle, _): (&mut Box<[V<S>]>, &mut Box<[V<S>]>),
        couplings: &mut Couplings<S>,
    ) {
        // E has degree 2: its gradient at the middle.
        for (m, (a, b)) in middle.iter_mut().zip(a.iter().zip(b)) {
            *m = add3(a, b).map(|x| S::lit(0.5) * x);
        }
        couplings.fields(middle, xi);
        let sign = S::lit(if self.damping == S::lit(0.0) { -1.0 } else { f64::NAN });
        xi.iter_mut().for_each(|xi| *xi = xi.map(|x| sign * x));
    }
}
