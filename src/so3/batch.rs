//! The maps on so(3) over many vectors, in the widest SIMD lanes of the machine, chosen at run time.
//!
//! Vectors lie component by component: `[&[f64]; 3]` is x, y, z of all of them, and a matrix is its
//! nine entries by rows. Results agree with the functions of the same name in [`so3`](super) to
//! rounding (4 ε·cond); the same input gives the same bits on the same machine, wherever a vector
//! stands in the array.
//!
//! Arrays are worked through in blocks. In a block the formulas run without a branch; the few vectors
//! that need one (|u| next to 2πk, the ends of the range, what is not finite) are done again, one by
//! one, by the scalar forms, which also say what is wrong with them.
//!
//! ```
//! use lieflow::so3::{self, batch};
//! use nalgebra::Vector3;
//! let (x, y, z) = (vec![0.1; 100], vec![-0.4; 100], vec![2.0; 100]);
//! let v = [vec![1.0; 100], vec![0.0; 100], vec![0.5; 100]];
//! let mut w = [vec![0.0; 100], vec![0.0; 100], vec![0.0; 100]];
//! batch::dexpinv([&x, &y, &z], v.each_ref().map(|v| &v[..]), w.each_mut().map(|w| &mut w[..]))?;
//! let one = so3::dexpinv(&Vector3::new(0.1, -0.4, 2.0), &Vector3::new(1.0, 0.0, 0.5))?;
//! assert!((w[2][99] - one[2]).abs() < 1e-15);
//! # Ok::<(), lieflow::Error>(())
//! ```

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use nalgebra::{Matrix3, Vector3};
use pulp::{Arch, Simd, WithSimd};

use super::angle::{Angle, REFINE, SERIES, TURN};
use super::{cay_coefficients, rodrigues, rodrigues_on};
use crate::error::{Error, StepError};
use crate::scalar::{Real, SIN_COS_MAX, Select, Trig, muladd, sin_cos};

/// exp: r ← exp(u), [`so3::exp`](super::exp()).
///
/// # Errors
/// [`Error::Shape`] for arrays of different lengths; [`Error::Element`] with the number of the first
/// vector that has no value, and why. The results before it stand.
pub fn exp(u: [&[f64]; 3], r: [&mut [f64]; 9]) -> Result<(), Error> {
    run::<ExpOf, 3, 9>(u, r)
}

/// w ← exp(u)·x, [`so3::exp_on`](super::exp_on).
///
/// # Errors
/// As [`exp`].
pub fn exp_on(u: [&[f64]; 3], x: [&[f64]; 3], w: [&mut [f64]; 3]) -> Result<(), Error> {
    run::<ExpOnOf, 6, 3>(both(u, x), w)
}

/// w ← dexp_u(v), [`so3::dexp`](super::dexp).
///
/// # Errors
/// As [`exp`].
pub fn dexp(u: [&[f64]; 3], v: [&[f64]; 3], w: [&mut [f64]; 3]) -> Result<(), Error> {
    run::<DexpOf, 6, 3>(both(u, v), w)
}

/// w ← dexp_u⁻¹(v), [`so3::dexpinv`](super::dexpinv).
///
/// # Errors
/// As [`exp`].
pub fn dexpinv(u: [&[f64]; 3], v: [&[f64]; 3], w: [&mut [f64]; 3]) -> Result<(), Error> {
    run::<DexpinvOf, 6, 3>(both(u, v), w)
}

/// r ← cay(u), [`so3::cay`](super::cay()).
///
/// # Errors
/// As [`exp`].
pub fn cay(u: [&[f64]; 3], r: [&mut [f64]; 9]) -> Result<(), Error> {
    run::<CayOf, 3, 9>(u, r)
}

/// u ← log(R), [`so3::log`](super::log()): one by one, without lanes.
///
/// # Errors
/// As [`exp`].
pub fn log(r: [&[f64]; 9], u: [&mut [f64]; 3]) -> Result<(), Error> {
    one_by_one(r, u, |r| Ok(super::log(&Matrix3::from_row_slice(r))?.into()))
}

/// u ← cay⁻¹(R), [`so3::cay_inv`](super::cay_inv): one by one, without lanes.
///
/// # Errors
/// As [`exp`].
pub fn cay_inv(r: [&[f64]; 9], u: [&mut [f64]; 3]) -> Result<(), Error> {
    one_by_one(r, u, |r| Ok(super::cay_inv(&Matrix3::from_row_slice(r))?.into()))
}

/// w ← dcay_u(v), [`so3::dcay`](super::dcay): one by one, without lanes.
///
/// # Errors
/// As [`exp`].
pub fn dcay(u: [&[f64]; 3], v: [&[f64]; 3], w: [&mut [f64]; 3]) -> Result<(), Error> {
    one_by_one(both(u, v), w, |x| Ok(super::dcay(&u_of(x), &u_of(&x[3..]))?.into()))
}

/// w ← dcay_u⁻¹(v), [`so3::dcayinv`](super::dcayinv): one by one, without lanes.
///
/// # Errors
/// As [`exp`].
pub fn dcayinv(u: [&[f64]; 3], v: [&[f64]; 3], w: [&mut [f64]; 3]) -> Result<(), Error> {
    one_by_one(both(u, v), w, |x| Ok(super::dcayinv(&u_of(x), &u_of(&x[3..]))?.into()))
}

/// A function on each element of the arrays.
fn one_by_one<const IN: usize, const OUT: usize>(
    input: [&[f64]; IN],
    mut output: [&mut [f64]; OUT],
    value: impl Fn(&[f64; IN]) -> Result<[f64; OUT], Error>,
) -> Result<(), Error> {
    for index in 0..length(&input, &output)? {
        let value = value(&input.map(|x| x[index]))
            .map_err(|error| Error::Element { index, source: Box::new(error) })?;
        for (output, value) in output.iter_mut().zip(value) {
            output[index] = value;
        }
    }
    Ok(())
}

/// The length that all arrays have.
fn length(input: &[&[f64]], output: &[&mut [f64]]) -> Result<usize, Error> {
    let n = input[0].len();
    let mut lengths = input.iter().map(|x| x.len()).chain(output.iter().map(|x| x.len()));
    match lengths.find(|rows| *rows != n) {
        None => Ok(n),
        Some(rows) => {
            let arg = "an array of the batch";
            Err(Error::Shape { arg, rows, cols: 1, expected_rows: n, expected_cols: 1 })
        }
    }
}

fn both<'a>([a, b, c]: [&'a [f64]; 3], [d, e, f]: [&'a [f64]; 3]) -> [&'a [f64]; 6] {
    [a, b, c, d, e, f]
}

/// A map of IN numbers, the first three of which are u, to OUT numbers.
trait Kernel<const IN: usize, const OUT: usize> {
    /// The value by formulas without a branch, and |sin(α/2)|² or what else must not be small for them
    /// to hold; NaN where a result is not finite.
    fn lane<S: Trig>(x: &[S; IN]) -> ([S; OUT], S);
    /// The value by the scalar form.
    fn one(x: &[f64; IN]) -> Result<[f64; OUT], StepError>;
}

fn u_of<S: Real>(x: &[S]) -> Vector3<S> {
    Vector3::new(x[0], x[1], x[2])
}

fn by_rows<S: Real>(g: &Matrix3<S>) -> [S; 9] {
    let g = g.as_slice();
    [g[0], g[3], g[6], g[1], g[4], g[7], g[2], g[5], g[8]]
}

/// w, and `guard` unless w is not finite.
#[inline(always)]
fn finite<S: Real>(w: Vector3<S>, guard: S) -> ([S; 3], S) {
    let zero = S::lit(0.0);
    ([w[0], w[1], w[2]], guard + (zero * w[0] + zero * w[1] + zero * w[2]))
}

struct ExpOf;
impl Kernel<3, 9> for ExpOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 3]) -> ([S; 9], S) {
        let (angle, g) = Angle::with_matrix(&u_of(x));
        (by_rows(&g), angle.regular())
    }
    fn one(x: &[f64; 3]) -> Result<[f64; 9], StepError> {
        super::exp(&u_of(x)).map(|g| by_rows(&g))
    }
}

struct ExpOnOf;
impl Kernel<6, 3> for ExpOnOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 6]) -> ([S; 3], S) {
        let u = u_of(x);
        let (angle, a, b) = Angle::with_exp(&u);
        finite(rodrigues_on(&u, a, b, &u_of(&x[3..])), angle.regular())
    }
    fn one(x: &[f64; 6]) -> Result<[f64; 3], StepError> {
        super::exp_on(&u_of(x), &u_of(&x[3..])).map(Into::into)
    }
}

struct DexpOf;
impl Kernel<6, 3> for DexpOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 6]) -> ([S; 3], S) {
        let u = u_of(x);
        let angle = Angle::with_half(&u);
        let (b, d) = angle.dexp_coefficients();
        finite(rodrigues_on(&u, b, d, &u_of(&x[3..])), angle.regular())
    }
    fn one(x: &[f64; 6]) -> Result<[f64; 3], StepError> {
        super::dexp(&u_of(x), &u_of(&x[3..])).map(Into::into)
    }
}

struct DexpinvOf;
impl Kernel<6, 3> for DexpinvOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 6]) -> ([S; 3], S) {
        let u = u_of(x);
        let angle = Angle::of(&u);
        let w = rodrigues_on(&u, S::lit(-0.5), angle.dexpinv_coefficient(), &u_of(&x[3..]));
        finite(w, angle.regular())
    }
    fn one(x: &[f64; 6]) -> Result<[f64; 3], StepError> {
        super::dexpinv(&u_of(x), &u_of(&x[3..])).map(Into::into)
    }
}

struct CayOf;
impl Kernel<3, 9> for CayOf {
    #[inline(always)]
    fn lane<S: Trig>(x: &[S; 3]) -> ([S; 9], S) {
        let u = u_of(x);
        // In range: the block has been looked at.
        let (a, b) = cay_coefficients(&u).unwrap_or((S::lit(0.0), S::lit(0.0)));
        (by_rows(&rodrigues(&u, a, b)), S::lit(1.0))
    }
    fn one(x: &[f64; 3]) -> Result<[f64; 9], StepError> {
        super::cay(&u_of(x)).map(|g| by_rows(&g))
    }
}

/// Vectors a block: its numbers stay in the first cache.
const BLOCK: usize = 64;
/// Larger α² are left to the scalar forms.
const SQUARE_MAX: f64 = SIN_COS_MAX * SIN_COS_MAX;

fn run<K: Kernel<IN, OUT>, const IN: usize, const OUT: usize>(
    input: [&[f64]; IN],
    output: [&mut [f64]; OUT],
) -> Result<(), Error> {
    length(&input, &output)?;
    Arch::new().dispatch(Run::<K, IN, OUT> { input, output, kernel: core::marker::PhantomData })
}

struct Run<'a, K, const IN: usize, const OUT: usize> {
    input: [&'a [f64]; IN],
    output: [&'a mut [f64]; OUT],
    kernel: core::marker::PhantomData<K>,
}

impl<K: Kernel<IN, OUT>, const IN: usize, const OUT: usize> WithSimd for Run<'_, K, IN, OUT> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        // Every x86-64 machine with lanes of four has fused products.
        match S::F64_LANES >= 4 {
            true => self.blocks::<true>(),
            false => self.blocks::<false>(),
        }
    }
}

/// The numbers of a block.
type Block<const K: usize> = [[f64; BLOCK]; K];

impl<K: Kernel<IN, OUT>, const IN: usize, const OUT: usize> Run<'_, K, IN, OUT> {
    #[inline(always)]
    fn blocks<const FUSED: bool>(self) -> Result<(), Error> {
        let Run { input, mut output, .. } = self;
        let n = input[0].len();
        let (mut x, mut y, mut guard) = ([[0.0; BLOCK]; IN], [[0.0; BLOCK]; OUT], [0.0; BLOCK]);
        for start in (0..n).step_by(BLOCK) {
            let len = BLOCK.min(n - start);
            for (x, input) in x.iter_mut().zip(&input) {
                x[..len].copy_from_slice(&input[start..start + len]);
                x[len..].fill(0.0);
            }
            let (mut small, mut below, mut large) = (true, true, true);
            for i in 0..BLOCK {
                let square = x[0][i] * x[0][i] + x[1][i] * x[1][i] + x[2][i] * x[2][i];
                // A NaN is neither.
                guard[i] = if square < SQUARE_MAX { 1.0 } else { 0.0 };
                small &= square < SERIES;
                below &= square < TURN;
                large &= square >= TURN;
            }
            let (x, y, guard) = (&x, &mut y, &mut guard);
            match (small, below, large) {
                (true, ..) => lanes::<K, FUSED, SMALL, IN, OUT>(x, y, guard),
                (_, true, _) => lanes::<K, FUSED, BELOW, IN, OUT>(x, y, guard),
                (.., true) => lanes::<K, FUSED, LARGE, IN, OUT>(x, y, guard),
                _ => lanes::<K, FUSED, MIXED, IN, OUT>(x, y, guard),
            }
            for (y, output) in y.iter().zip(&mut output) {
                output[start..start + len].copy_from_slice(&y[..len]);
            }
            let all = guard.iter().fold(true, |all, g| all & (*g >= REFINE));
            if !all {
                again::<K, IN, OUT>(start, &guard[..len], x, &mut output)?;
            }
        }
        Ok(())
    }
}

/// The block by formulas without a branch; guard ← min(guard, what the kernel says).
#[inline(always)]
fn lanes<
    K: Kernel<IN, OUT>,
    const FUSED: bool,
    const SIZE: u8,
    const IN: usize,
    const OUT: usize,
>(
    x: &Block<IN>,
    y: &mut Block<OUT>,
    guard: &mut [f64; BLOCK],
) {
    for i in 0..BLOCK {
        let (out, regular) = K::lane(&core::array::from_fn(|k| Lane::<FUSED, SIZE>(x[k][i])));
        for k in 0..OUT {
            y[k][i] = out[k].0;
        }
        guard[i] *= regular.0;
    }
}

/// The vectors whose guard is small, by the scalar form.
#[cold]
#[inline(never)]
fn again<K: Kernel<IN, OUT>, const IN: usize, const OUT: usize>(
    start: usize,
    guard: &[f64],
    x: &Block<IN>,
    output: &mut [&mut [f64]; OUT],
) -> Result<(), Error> {
    for (i, guard) in guard.iter().enumerate() {
        if *guard >= REFINE {
            continue;
        }
        let index = start + i;
        let value = K::one(&core::array::from_fn(|k| x[k][i]))
            .map_err(|error| Error::Element { index, source: Box::new(error.into()) })?;
        for (output, value) in output.iter_mut().zip(value) {
            output[index] = value;
        }
    }
    Ok(())
}

/// All α² of the block are below [`SERIES`].
pub(crate) const SMALL: u8 = 0;
/// All are below [`TURN`].
const BELOW: u8 = 1;
/// None is below [`TURN`].
const LARGE: u8 = 2;
/// Anything.
const MIXED: u8 = 3;

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
