//! A number type that counts operations. It gives Table 2 of the paper by running the formulas.

use core::cell::Cell;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use super::{Real, Select, Trig};

/// Numbers of operations. A change of sign, |x| and a comparison do not count, as in the paper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ops {
    /// Additions and subtractions.
    pub add: u64,
    /// Multiplications.
    pub mul: u64,
    /// Divisions.
    pub div: u64,
    /// Square roots.
    pub sqrt: u64,
    /// Sines and cosines, each counted; on machine numbers also exponentials and logarithms.
    pub trig: u64,
}

impl Ops {
    /// The sum of all operations.
    pub fn total(&self) -> u64 {
        self.add + self.mul + self.div + self.sqrt + self.trig
    }
}

thread_local! {
    static OPS: Cell<Ops> =
        const { Cell::new(Ops { add: 0, mul: 0, div: 0, sqrt: 0, trig: 0 }) };
}

#[cfg(feature = "tally")]
thread_local! {
    static COUNTING: Cell<bool> = const { Cell::new(false) };
}

/// True while a count runs.
#[cfg(feature = "tally")]
#[inline(always)]
pub(super) fn is_counting() -> bool {
    COUNTING.get()
}

/// Adds the operations that a kernel on machine numbers reports.
#[cfg(feature = "tally")]
pub(super) fn add(ops: Ops) {
    OPS.set(OPS.get() + ops);
}

/// An `f64` that counts its operations, for each thread.
///
/// ```
/// use lieflow::scalar::{Counted, Real};
/// let (x, ops) = Counted::count(|| Counted::lit(3.0) * Counted::lit(4.0) + Counted::lit(1.0));
/// assert_eq!((x.0, ops.mul, ops.add), (13.0, 1, 1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted(pub f64);

impl Counted {
    /// Runs `f`, and returns its operations on such numbers. With the feature `tally` it also counts those of the
    /// library's matrices; see [`tally`](super::tally()).
    pub fn count<R>(f: impl FnOnce() -> R) -> (R, Ops) {
        let before = OPS.replace(Ops::default());
        #[cfg(feature = "tally")]
        let around = COUNTING.replace(true);
        let out = f();
        #[cfg(feature = "tally")]
        COUNTING.set(around);
        (out, OPS.replace(before))
    }

    /// Adds `n` operations of a kind.
    fn bump(n: u64, kind: impl FnOnce(&mut Ops) -> &mut u64) {
        let mut ops = OPS.get();
        *kind(&mut ops) += n;
        OPS.set(ops);
    }
}

impl From<Counted> for f64 {
    fn from(x: Counted) -> f64 {
        x.0
    }
}

macro_rules! counted_operator {
    ($($trait:ident $method:ident $op:tt $field:ident;)*) => {$(
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self::bump(1, |ops| &mut ops.$field);
                Counted(self.0 $op other.0)
            }
        }
    )*};
}
counted_operator! {
    Add add + add;
    Sub sub - add;
    Mul mul * mul;
    Div div / div;
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Counted(-self.0)
    }
}
impl AddAssign for Counted {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl SubAssign for Counted {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Real for Counted {
    const COUNTS: bool = true;

    fn lit(x: f64) -> Self {
        Counted(x)
    }
    fn sqrt(self) -> Self {
        Self::bump(1, |ops| &mut ops.sqrt);
        Counted(self.0.sqrt())
    }
    fn abs(self) -> Self {
        Counted(self.0.abs())
    }
    fn all_below(self, bound: f64) -> bool {
        self.0 < bound
    }
    fn any_below(self, bound: f64) -> bool {
        self.0 < bound
    }
    fn branch<R: Select<Self>>(
        self,
        bound: f64,
        small: impl FnOnce() -> R,
        large: impl FnOnce() -> R,
    ) -> R {
        if self.all_below(bound) { small() } else { large() }
    }
}

impl Trig for Counted {
    fn sin_cos(self) -> (Self, Self) {
        Self::bump(2, |ops| &mut ops.trig);
        let (s, c) = self.0.sin_cos();
        (Counted(s), Counted(c))
    }
}
