//! Two coordinate maps in turn: the first on even steps, the second on odd ones.
//!
//! The paper's "ccsk" is [`CCSK`]: the ordering 321 first, then 123, and so on.

use super::{CCSK123, CCSK321, Ccsk, CoordinateMap};
use crate::error::{Error, StepError};
use crate::groups::LieGroup;

/// The first map on even steps of a run, the second on odd ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alternating<A, B> {
    name: &'static str,
    even: A,
    odd: B,
}

/// ccsk of the paper: the orderings 321 and 123 in turn.
pub const CCSK: Alternating<Ccsk<2, 1, 0>, Ccsk<0, 1, 2>> =
    Alternating::new("ccsk", CCSK321, CCSK123);

impl<A, B> Alternating<A, B> {
    /// The map that is `even` on steps 0, 2, … and `odd` on steps 1, 3, …
    pub const fn new(name: &'static str, even: A, odd: B) -> Self {
        Alternating { name, even, odd }
    }
}

/// The values that the two maps store, and whose turn it is.
#[derive(Clone, Copy, Debug)]
pub struct AlternatingAt<A, B> {
    even: A,
    odd: B,
    is_odd: bool,
}

impl<G: LieGroup, A: CoordinateMap<G>, B: CoordinateMap<G>> CoordinateMap<G> for Alternating<A, B> {
    type At = AlternatingAt<A::At, B::At>;

    fn name(&self) -> &'static str {
        self.name
    }
    fn at(&self, group: &G) -> Result<Self::At, Error> {
        Ok(AlternatingAt { even: self.even.at(group)?, odd: self.odd.at(group)?, is_odd: false })
    }
    #[inline]
    fn begin_step(&self, at: &mut Self::At, n: u64) {
        at.is_odd = n % 2 == 1;
        self.even.begin_step(&mut at.even, n / 2);
        self.odd.begin_step(&mut at.odd, n / 2);
    }
    #[inline]
    fn psi(
        &self,
        group: &G,
        u: &G::Alg,
        at: &mut Self::At,
        g: &mut G::Elem,
    ) -> Result<(), StepError> {
        match at.is_odd {
            false => self.even.psi(group, u, &mut at.even, g),
            true => self.odd.psi(group, u, &mut at.odd, g),
        }
    }
    #[inline]
    fn psi_on(
        &self,
        group: &G,
        u: &G::Alg,
        at: &mut Self::At,
        g: &mut G::Elem,
        x: &G::Vector,
        y: &mut G::Vector,
    ) -> Result<(), StepError> {
        match at.is_odd {
            false => self.even.psi_on(group, u, &mut at.even, g, x, y),
            true => self.odd.psi_on(group, u, &mut at.odd, g, x, y),
        }
    }
    #[inline]
    fn dpsi_inv(
        &self,
        group: &G,
        u: &G::Alg,
        at: &mut Self::At,
        v: &mut G::Alg,
    ) -> Result<(), StepError> {
        match at.is_odd {
            false => self.even.dpsi_inv(group, u, &mut at.even, v),
            true => self.odd.dpsi_inv(group, u, &mut at.odd, v),
        }
    }
    fn order(&self, group: &G) -> usize {
        self.even.order(group).min(self.odd.order(group))
    }
}
