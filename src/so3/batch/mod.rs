//! The maps on so(3) over many vectors, in the widest SIMD lanes of the machine, chosen at run time.
//!
//! Vectors lie component by component: `[&[f64]; 3]` is x, y, z of all of them, and a matrix is its
//! nine entries by rows. [`rows`] has the same functions for arrays with one vector after the other. Results agree with the functions of the same name in [`so3`](super) to
//! rounding (4 ε·cond); the same input gives the same bits on the same machine, wherever a vector
//! stands in the array.
//!
//! Arrays are worked through in blocks. In a block the formulas run without a branch; the few vectors
//! that need one (|u| next to 2πk, the ends of the range, what is not finite) are done again, one by
//! one, by the scalar forms, which also say what is wrong with them.
//!
//! ```
//! use lieflow::so3::{self, batch};
//! use lieflow::nalgebra::Vector3;
//! let (x, y, z) = (vec![0.1; 100], vec![-0.4; 100], vec![2.0; 100]);
//! let v = [vec![1.0; 100], vec![0.0; 100], vec![0.5; 100]];
//! let mut w = [vec![0.0; 100], vec![0.0; 100], vec![0.0; 100]];
//! batch::dexpinv([&x, &y, &z], v.each_ref().map(|v| &v[..]), w.each_mut().map(|w| &mut w[..]))?;
//! let one = so3::dexpinv(&Vector3::new(0.1, -0.4, 2.0), &Vector3::new(1.0, 0.0, 0.5))?;
//! assert!((w[2][99] - one[2]).abs() < 1e-15);
//! # Ok::<(), lieflow::Error>(())
//! ```

mod kernels;
mod lane;
pub mod rows;

use pulp::{Arch, Simd, WithSimd};

use super::angle::{REFINE, SERIES, TURN};
use crate::error::Error;
use crate::scalar::SIN_COS_MAX;
use kernels::{
    CayInvOf, CayOf, DcayOf, DcayinvOf, DexpOf, DexpinvOf, ExpOf, ExpOnOf, Kernel, LogOf,
};
use lane::{BELOW, LARGE, MIXED};
pub(crate) use lane::{Lane, SMALL};

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

/// u ← log(R), [`so3::log`](super::log()).
///
/// # Errors
/// As [`exp`].
pub fn log(r: [&[f64]; 9], u: [&mut [f64]; 3]) -> Result<(), Error> {
    run::<LogOf, 9, 3>(r, u)
}

/// u ← cay⁻¹(R), [`so3::cay_inv`](super::cay_inv).
///
/// # Errors
/// As [`exp`].
pub fn cay_inv(r: [&[f64]; 9], u: [&mut [f64]; 3]) -> Result<(), Error> {
    run::<CayInvOf, 9, 3>(r, u)
}

/// w ← dcay_u(v), [`so3::dcay`](super::dcay).
///
/// # Errors
/// As [`exp`].
pub fn dcay(u: [&[f64]; 3], v: [&[f64]; 3], w: [&mut [f64]; 3]) -> Result<(), Error> {
    run::<DcayOf, 6, 3>(both(u, v), w)
}

/// w ← dcay_u⁻¹(v), [`so3::dcayinv`](super::dcayinv).
///
/// # Errors
/// As [`exp`].
pub fn dcayinv(u: [&[f64]; 3], v: [&[f64]; 3], w: [&mut [f64]; 3]) -> Result<(), Error> {
    run::<DcayinvOf, 6, 3>(both(u, v), w)
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

/// Vectors a block: its numbers stay in the first cache.
const BLOCK: usize = 64;
/// Larger α² are left to the scalar forms.
const SQUARE_MAX: f64 = SIN_COS_MAX * SIN_COS_MAX;

/// The numbers of one component: x, x + step, x + 2·step, …
#[derive(Clone, Copy)]
struct Component<'a> {
    numbers: &'a [f64],
    step: usize,
}

impl Component<'_> {
    /// x ← the numbers of these vectors.
    #[inline(always)]
    fn read(self, start: usize, x: &mut [f64]) {
        match self.step {
            1 => x.copy_from_slice(&self.numbers[start..start + x.len()]),
            0 => x.fill(self.numbers[0]),
            step => {
                let numbers = self.numbers[start * step..].iter().step_by(step);
                x.iter_mut().zip(numbers).for_each(|(x, number)| *x = *number);
            }
        }
    }
}

/// The place of the results.
enum Results<'a, const OUT: usize> {
    Components([&'a mut [f64]; OUT]),
    Rows(&'a mut [f64]),
}

impl<const OUT: usize> Results<'_, OUT> {
    /// The results of these vectors ← y.
    #[inline(always)]
    fn write(&mut self, start: usize, len: usize, y: &Block<OUT>) {
        match self {
            Results::Components(output) => {
                for (y, output) in y.iter().zip(output) {
                    output[start..start + len].copy_from_slice(&y[..len]);
                }
            }
            Results::Rows(output) => {
                write_rows(y, &mut output[OUT * start..OUT * (start + len)]);
            }
        }
    }

    /// The result of this vector ← value.
    fn set(&mut self, index: usize, value: [f64; OUT]) {
        match self {
            Results::Components(output) => {
                for (output, value) in output.iter_mut().zip(value) {
                    output[index] = value;
                }
            }
            Results::Rows(output) => {
                output[OUT * index..OUT * (index + 1)].copy_from_slice(&value);
            }
        }
    }
}

/// The rows ← the components. It is a function of its own without the instructions of the lanes, since the compiler would
/// take one that scatters numbers, which is slower than one store for each.
#[inline(never)]
fn write_rows<const OUT: usize>(y: &Block<OUT>, rows: &mut [f64]) {
    for (i, row) in rows.chunks_exact_mut(OUT).enumerate() {
        for k in 0..OUT {
            row[k] = y[k][i];
        }
    }
}

fn run<K: Kernel<IN, OUT>, const IN: usize, const OUT: usize>(
    input: [&[f64]; IN],
    output: [&mut [f64]; OUT],
) -> Result<(), Error> {
    let n = length(&input, &output)?;
    let input = input.map(|numbers| Component { numbers, step: 1 });
    run_on::<K, IN, OUT>(n, input, Results::Components(output))
}

/// Below this number of vectors the lanes cost more than they save.
const FEW: usize = 32;

fn run_on<K: Kernel<IN, OUT>, const IN: usize, const OUT: usize>(
    n: usize,
    input: [Component<'_>; IN],
    mut output: Results<'_, OUT>,
) -> Result<(), Error> {
    if n >= FEW {
        let kernel = core::marker::PhantomData;
        return Arch::new().dispatch(Run::<K, IN, OUT> { n, input, output, kernel });
    }
    for index in 0..n {
        let x = input.map(|component| component.numbers[index * component.step]);
        output.set(index, one::<K, IN, OUT>(index, &x)?);
    }
    Ok(())
}

/// The value of one vector by the scalar form.
fn one<K: Kernel<IN, OUT>, const IN: usize, const OUT: usize>(
    index: usize,
    x: &[f64; IN],
) -> Result<[f64; OUT], Error> {
    K::one(x).map_err(|source| Error::Element { index, source: Box::new(source) })
}

struct Run<'a, K, const IN: usize, const OUT: usize> {
    n: usize,
    input: [Component<'a>; IN],
    output: Results<'a, OUT>,
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

/// Numbers from the start of a line of the cache, so that no lane lies in two lines.
#[repr(align(64))]
struct Aligned<T>(T);

impl<K: Kernel<IN, OUT>, const IN: usize, const OUT: usize> Run<'_, K, IN, OUT> {
    #[inline(always)]
    fn blocks<const FUSED: bool>(self) -> Result<(), Error> {
        let Run { n, input, mut output, .. } = self;
        let mut numbers = Aligned(([[0.0; BLOCK]; IN], [[0.0; BLOCK]; OUT], [0.0; BLOCK]));
        let Aligned((x, y, guard)) = &mut numbers;
        for start in (0..n).step_by(BLOCK) {
            let len = BLOCK.min(n - start);
            for (x, input) in x.iter_mut().zip(&input) {
                input.read(start, &mut x[..len]);
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
            match (small, below, large) {
                _ if !K::HAS_SIZES => lanes::<K, FUSED, MIXED, IN, OUT>(x, y, guard),
                (true, ..) => lanes::<K, FUSED, SMALL, IN, OUT>(x, y, guard),
                (_, true, _) => lanes::<K, FUSED, BELOW, IN, OUT>(x, y, guard),
                (.., true) => lanes::<K, FUSED, LARGE, IN, OUT>(x, y, guard),
                _ => lanes::<K, FUSED, MIXED, IN, OUT>(x, y, guard),
            }
            output.write(start, len, y);
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
    output: &mut Results<'_, OUT>,
) -> Result<(), Error> {
    for (i, guard) in guard.iter().enumerate() {
        if *guard >= REFINE {
            continue;
        }
        let index = start + i;
        output.set(index, one::<K, IN, OUT>(index, &core::array::from_fn(|k| x[k][i]))?);
    }
    Ok(())
}
