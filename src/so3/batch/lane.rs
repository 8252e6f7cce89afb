//! One number of a block.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::super::angle::TURN;
use crate::scalar::{Real, Select, Trig, muladd, sin_cos};

/// All α² of the block are below [`SERIES`].
pub(crate) const SMALL: u8 = 0;
/// All are below [`TURN`].
pub(super) const BELOW: u8 = 1;
/// None is below [`TURN`].
pub(super) const LARGE: u8 = 2;
/// Anything.
pub(super) const MIXED: u8 = 3;

/// One number of a block. It asks no questions: what needs an answer is done again by the scalar forms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lane<const FUSED: bool, const SIZE: u8>(pub(crate) f64);

macro_rules! lane_operator {
    ($($trait:ident $method:ident $op:tt;)*) => {$(
        impl<const FUSED: bool, const SIZE: u8> $trait for Lane<FUSED, SIZE> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Lane(self.0 $op other.0)
            }
        }
    )*};
}
lane_operator! {
    Add add +;
    Sub sub -;
    Mul mul *;
    Div div /;
}
impl<const FUSED: bool, const SIZE: u8> Neg for Lane<FUSED, SIZE> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lane(-self.0)
    }
}
impl<const FUSED: bool, const SIZE: u8> AddAssign for Lane<FUSED, SIZE> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}
impl<const FUSED: bool, const SIZE: u8> SubAssign for Lane<FUSED, SIZE> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.0 -= other.0;
    }
}

impl<const FUSED: bool, const SIZE: u8> Real for Lane<FUSED, SIZE> {
    #[inline(always)]
    fn lit(x: f64) -> Self {
        Lane(x)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Lane(muladd::<FUSED>(self.0, a.0, b.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Lane(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Lane(self.0.abs())
    }
    #[inline(always)]
    fn all_below(self, _: f64) -> bool {
        true
    }
    #[inline(always)]
    fn any_below(self, _: f64) -> bool {
        false
    }
    #[inline(always)]
    fn branch<R: Select<Self>>(
        self,
        bound: f64,
        small: impl FnOnce() -> R,
        large: impl FnOnce() -> R,
    ) -> R {
        match SIZE {
            SMALL => small(),
            BELOW if bound == TURN => small(),
            LARGE => large(),
            // Both formulas run, and one result is selected.
            _ => {
                let below = self.0 < bound;
                R::select(&mut |a: Self, b: Self| if below { a } else { b }, small(), large())
            }
        }
    }
}

impl<const FUSED: bool, const SIZE: u8> Trig for Lane<FUSED, SIZE> {
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = sin_cos::<FUSED>(self.0);
        (Lane(s), Lane(c))
    }
}
