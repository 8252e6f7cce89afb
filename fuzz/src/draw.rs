//! Numbers out of bytes, as they come from broken input.
#![allow(dead_code, reason = "each suite draws what it needs")]

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// What is left of the bytes; zeros when they have run out.
pub(crate) struct Draw<'a>(pub(crate) &'a [u8]);

impl Draw<'_> {
    pub(crate) fn byte(&mut self) -> u8 {
        match self.0 {
            [first, rest @ ..] => {
                self.0 = rest;
                *first
            }
            [] => 0,
        }
    }
    pub(crate) fn bits(&mut self, count: u32) -> u64 {
        (0..count).fold(0, |x, _| x << 8 | u64::from(self.byte()))
    }
    /// Below `n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.bits(2) as usize % n
    }
    /// In [−1, 1].
    pub(crate) fn unit(&mut self) -> f64 {
        self.bits(4) as f64 / f64::from(1u32 << 31) - 1.0
    }
    /// Special values, magnitudes over the whole range, ulps around multiples of π/2, any bits.
    pub(crate) fn wild(&mut self) -> f64 {
        const SPECIAL: [f64; 20] = [
            0.0,
            -0.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
            f64::MIN_POSITIVE,
            5e-324,
            -5e-324,
            f64::EPSILON,
            1.0,
            2.0,
            PI,
            TAU,
            FRAC_PI_2,
            1e160,
            -1e200,
            1e308,
            1e15,
        ];
        match self.byte() % 8 {
            0..3 => SPECIAL[self.below(SPECIAL.len())],
            3 => f64::from_bits(self.bits(8)),
            4..6 => self.unit().signum() * 10f64.powf(-6.0 + 314.0 * self.unit()),
            6 => {
                let x = FRAC_PI_2 * self.below(9) as f64;
                f64::from_bits(x.to_bits().wrapping_add(self.bits(1)).wrapping_sub(128))
            }
            _ => 10.0 * self.unit(),
        }
    }
    /// Wild, or as often an ordinary number.
    pub(crate) fn number(&mut self) -> f64 {
        if self.byte() < 128 { self.wild() } else { self.unit() }
    }
}
