//! Linear spaces with a norm, in which the points of M and the elements of 𝔤 and G are stored.
//!
//! For your own manifold implement [`Metric`] and [`LinearSpace`] for the storage of its points. Then every method of the
//! library runs on it, also the classical ones.

#[cfg(feature = "dense")]
mod matrix;
mod numbers;

pub use numbers::Numbers;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::error::Error;
use crate::scalar::{Counted, DoubleDouble, Ops, Real, larger, tally};
use crate::tolerance::{PartTolerance, Rule, Scales, Tolerance, least_rtol};

/// Points that can be compared: those of a linear space with a norm.
///
/// Implemented for numbers, for vectors and matrices of both layers by the Frobenius norm, and for
/// pairs and boxed slices of them. Allocates nothing.
pub trait Metric: Send + Sync {
    /// The reals of the norm.
    type Scalar: Real;
    /// True for a few numbers without an allocation: a copy of them may stay in registers. Methods keep their newest stage
    /// in such a copy.
    const IS_SMALL: bool = false;
    /// True if the point is one part, which has one tolerance.
    const IS_ONE_PART: bool = false;
    /// self ← x, into the existing storage.
    fn assign(&mut self, x: &Self);
    /// ‖self‖.
    fn size(&self) -> Self::Scalar;
    /// ‖self − x‖.
    fn distance(&self, x: &Self) -> Self::Scalar;
    /// True only if all numbers are the same. A point that cannot tell says false; then a method takes its last stage
    /// again as the first one of the next step.
    fn is_same(&self, _x: &Self) -> bool {
        false
    }
    /// Checks that the storage has the sizes of that of `like`, where it has any.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::Shape`] with the name `arg`.
    fn check_sizes(&self, _arg: &'static str, _like: &Self) -> Result<(), Error> {
        Ok(())
    }
    /// An error at this point in units of the tolerance: the largest of the ratios of the parts
    /// ([`tolerance`](crate::tolerance)).
    #[inline]
    fn error_ratio(&self, gap: Gap<'_, Self>, scales: &mut Scales<'_>) -> Self::Scalar {
        gap.ratio(self, scales.part())
    }
}

/// An error at a point.
#[derive(Debug)]
pub struct Gap<'a, M: Metric + ?Sized> {
    error: GivenBy<'a, M>,
    /// The point at which the step started, if the error is that of a step.
    from: Option<&'a M>,
}

/// A tolerance of a part below this many of its roundings cannot be met. The estimated error of a step that moves the part by
/// a millionth is rounding of that size.
const OUT_OF_REACH: f64 = 1e-6;

/// Checks that steps from y can meet a tolerance: that it is not far below the rounding of a part of y.
///
/// A part that is 0 at y has any tolerance. [`Rule::PerLength`] is not checked.
///
/// # Errors
/// [`Error::OutOfRange`].
pub fn check_within_reach<M: Metric>(tolerance: &Tolerance, y: &M) -> Result<(), Error> {
    let rounding = M::Scalar::lit(OUT_OF_REACH * M::Scalar::EPSILON);
    let rounding = Gap { error: GivenBy::Rounding(rounding), from: None };
    let ratio = y.error_ratio(rounding, &mut tolerance.scales());
    if tolerance.rule() != Rule::PerStep || ratio.any_below(1.0) {
        return Ok(());
    }
    let least = tolerance.least_atol();
    let expected = format!(
        "a larger one, or rtol = {:.0e} or more beside it: no step from this start has so small an error",
        least_rtol::<M::Scalar>()
    );
    Err(Error::out_of_range("atol", least, expected))
}

/// The way in which an error is given.
#[derive(Debug)]
enum GivenBy<'a, M: Metric + ?Sized> {
    /// The distance from another point.
    To(&'a M),
    /// The error itself.
    Of(&'a M),
    /// A multiple of the size of each part, in any direction: each number may have all of it.
    Relative(M::Scalar),
    /// A multiple of each number.
    Rounding(M::Scalar),
}

impl<M: Metric + ?Sized> Clone for Gap<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<M: Metric + ?Sized> Copy for Gap<'_, M> {}
impl<M: Metric + ?Sized> Clone for GivenBy<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<M: Metric + ?Sized> Copy for GivenBy<'_, M> {}

impl<'a, M: Metric + ?Sized> Gap<'a, M> {
    /// The distance from another point.
    #[inline]
    pub fn to(x: &'a M) -> Self {
        Gap { error: GivenBy::To(x), from: None }
    }
    /// The error itself.
    #[inline]
    pub fn of(e: &'a M) -> Self {
        Gap { error: GivenBy::Of(e), from: None }
    }
    /// A multiple of the size of each part, in any direction.
    #[inline]
    pub fn relative(e: M::Scalar) -> Self {
        Gap { error: GivenBy::Relative(e), from: None }
    }
    /// Sets the start of the step whose error this is. A step that moves a part little has a smaller tolerance
    /// ([`tolerance`](crate::tolerance)).
    #[inline]
    pub fn of_step_from(self, from: &'a M) -> Self {
        Gap { from: Some(from), ..self }
    }
    /// The error of a part of the point.
    #[inline]
    pub fn part<A: Metric<Scalar = M::Scalar> + ?Sized>(
        self,
        part: impl Fn(&'a M) -> &'a A,
    ) -> Gap<'a, A> {
        let error = match self.error {
            GivenBy::To(x) => GivenBy::To(part(x)),
            GivenBy::Of(e) => GivenBy::Of(part(e)),
            GivenBy::Relative(e) => GivenBy::Relative(e),
            GivenBy::Rounding(e) => GivenBy::Rounding(e),
        };
        Gap { error, from: self.from.map(part) }
    }
    /// The norm of the error at a point of this size.
    #[inline]
    fn error(self, at: &M, size: M::Scalar) -> M::Scalar {
        match self.error {
            GivenBy::To(x) => at.distance(x),
            GivenBy::Of(e) => e.size(),
            GivenBy::Relative(e) | GivenBy::Rounding(e) => e * size,
        }
    }
    /// The ratio of the error of a whole part.
    #[inline(always)]
    fn ratio(self, at: &M, part: &PartTolerance) -> M::Scalar {
        let size = at.size();
        let error = self.error(at, size);
        match self.from {
            Some(from) => part.ratio_of_step(error, size, at.distance(from)),
            None => part.ratio(error, size),
        }
    }
}

/// A point of a linear space with a norm. Allocates nothing.
///
/// ```
/// use lieflow::space::{LinearSpace, Metric};
/// use lieflow::nalgebra::Vector3;
/// // A vector and a number: pairs of points are points.
/// let mut y = (Vector3::new(1.0, 0.0, 0.0), 2.0);
/// y.add(-0.5, &y.clone());
/// assert_eq!(y, (Vector3::new(0.5, 0.0, 0.0), 1.0));
/// assert_eq!(y.dot(&y), 1.25);
/// ```
pub trait LinearSpace: Metric + Clone {
    /// self ← 0.
    fn clear(&mut self);
    /// self ← self + a·x.
    fn add(&mut self, a: Self::Scalar, x: &Self);
    /// ⟨self, x⟩, the sum of the products of their numbers.
    fn dot(&self, x: &Self) -> Self::Scalar;
    /// Is every number finite?
    fn is_finite(&self) -> bool;
    /// self ← y + h Σ_j w_j k_j, without the terms whose weight is 0.
    #[inline(always)]
    fn set_sum(&mut self, y: &Self, h: Self::Scalar, weights: &[f64], k: &[Self]) {
        self.assign(y);
        for j in 0..weights.len().min(k.len()) {
            if weights[j] != 0.0 {
                self.add(h * Self::Scalar::lit(weights[j]), &k[j]);
            }
        }
    }
    /// self ← h Σ_j w_j k_j, with all terms, so that a k_j that is not finite is seen.
    #[inline(always)]
    fn set_terms(&mut self, h: Self::Scalar, weights: &[f64], k: &[Self]) {
        self.clear();
        for j in 0..weights.len().min(k.len()) {
            self.add(h * Self::Scalar::lit(weights[j]), &k[j]);
        }
    }
}

macro_rules! number {
    ($($t:ty),*) => {$(
        impl Metric for $t {
            type Scalar = $t;
            const IS_SMALL: bool = true;
            const IS_ONE_PART: bool = true;
            #[inline]
            fn assign(&mut self, x: &Self) {
                *self = *x;
            }
            #[inline]
            fn size(&self) -> $t {
                Real::abs(*self)
            }
            #[inline]
            fn distance(&self, x: &Self) -> $t {
                Real::abs(*self - *x)
            }
            #[inline]
            fn is_same(&self, x: &Self) -> bool {
                *self == *x
            }
        }

        impl LinearSpace for $t {
            #[inline]
            fn clear(&mut self) {
                *self = <$t>::lit(0.0);
            }
            #[inline]
            fn add(&mut self, a: $t, x: &Self) {
                *self += a * *x;
            }
            #[inline]
            fn dot(&self, x: &Self) -> $t {
                *self * *x
            }
            #[inline]
            fn is_finite(&self) -> bool {
                Real::is_finite(*self)
            }
        }
    )*};
}
number!(f32, f64, Counted, DoubleDouble);

macro_rules! small {
    ($($t:ident: $($i:literal)*;)*) => {$(
        impl<S: Real> Metric for $t<S> {
            type Scalar = S;
            const IS_SMALL: bool = true;
            const IS_ONE_PART: bool = true;
            /// Entry by entry, because a vector that is copied whole, or in a loop, goes through memory. Here and below there is
            /// no iterator and no closure: a build of many units without LTO does not put them in line.
            #[inline]
            fn assign(&mut self, x: &Self) {
                let (y, x) = (self.as_mut_slice(), x.as_slice());
                $(y[$i] = x[$i];)*
            }
            #[inline]
            fn size(&self) -> S {
                let (mut squares, x) = (S::lit(0.0), self.as_slice());
                $(squares += x[$i] * x[$i];)*
                squares.sqrt()
            }
            #[inline]
            fn distance(&self, x: &Self) -> S {
                let (mut squares, y, x) = (S::lit(0.0), self.as_slice(), x.as_slice());
                $(
                    let d = y[$i] - x[$i];
                    squares += d * d;
                )*
                squares.sqrt()
            }
            #[inline]
            fn is_same(&self, x: &Self) -> bool {
                let (y, x) = (self.as_slice(), x.as_slice());
                true $(&& y[$i] == x[$i])*
            }
            #[inline(always)]
            fn error_ratio(&self, gap: Gap<'_, Self>, scales: &mut Scales<'_>) -> S {
                let part = scales.part();
                if part.has_components() {
                    let entries = || self.as_slice().iter().copied();
                    return match gap.error {
                        GivenBy::To(x) => part.largest((self - x).iter().copied(), entries()),
                        GivenBy::Of(e) => part.largest(e.as_slice().iter().copied(), entries()),
                        GivenBy::Relative(e) => {
                            let error = e * self.size();
                            part.largest(entries().map(|_| error), entries())
                        }
                        GivenBy::Rounding(e) => part.largest(entries().map(|x| e * x), entries()),
                    };
                }
                gap.ratio(self, part)
            }
        }

        impl<S: Real> LinearSpace for $t<S> {
            #[inline]
            fn clear(&mut self) {
                let x = self.as_mut_slice();
                $(x[$i] = S::lit(0.0);)*
            }
            #[inline]
            fn add(&mut self, a: S, x: &Self) {
                let (y, x) = (self.as_mut_slice(), x.as_slice());
                $(y[$i] += a * x[$i];)*
            }
            #[inline]
            fn dot(&self, x: &Self) -> S {
                let (mut sum, y, x) = (S::lit(0.0), self.as_slice(), x.as_slice());
                $(sum += y[$i] * x[$i];)*
                sum
            }
            #[inline]
            fn is_finite(&self) -> bool {
                let x = self.as_slice();
                true $(&& x[$i].is_finite())*
            }
            /// In a local sum, which stays in registers. Three numbers that are stored as two and one, and loaded as one
            /// and two, would wait for the store.
            #[inline(always)]
            fn set_sum(&mut self, y: &Self, h: S, weights: &[f64], k: &[Self]) {
                let mut sum = *y;
                for j in 0..weights.len().min(k.len()) {
                    if weights[j] != 0.0 {
                        sum.add(h * S::lit(weights[j]), &k[j]);
                    }
                }
                self.assign(&sum);
            }
            #[inline(always)]
            fn set_terms(&mut self, h: S, weights: &[f64], k: &[Self]) {
                let mut sum = *self;
                sum.clear();
                for j in 0..weights.len().min(k.len()) {
                    sum.add(h * S::lit(weights[j]), &k[j]);
                }
                self.assign(&sum);
            }
        }
    )*};
}
small! {
    Vector3: 0 1 2;
    Matrix3: 0 1 2 3 4 5 6 7 8;
}

/// As a point of ℝ⁴: q and −q are different points.
impl Metric for UnitQuaternion<f64> {
    type Scalar = f64;
    const IS_SMALL: bool = true;
    const IS_ONE_PART: bool = true;
    #[inline]
    fn assign(&mut self, x: &Self) {
        *self = *x;
    }
    #[inline]
    fn size(&self) -> f64 {
        tally(|| Ops::dots(1, 4) + Ops::sqrts(1));
        self.coords.norm()
    }
    #[inline]
    fn distance(&self, x: &Self) -> f64 {
        tally(|| Ops::adds(4) + Ops::dots(1, 4) + Ops::sqrts(1));
        (self.coords - x.coords).norm()
    }
    #[inline]
    fn is_same(&self, x: &Self) -> bool {
        self.coords == x.coords
    }
}

impl LinearSpace for UnitQuaternion<f64> {
    #[inline]
    fn clear(&mut self) {
        *self = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.0, 0.0, 0.0));
    }
    #[inline]
    fn add(&mut self, a: f64, x: &Self) {
        tally(|| Ops::muladds(4));
        *self = UnitQuaternion::new_unchecked(Quaternion::from(self.coords + a * x.coords));
    }
    #[inline]
    fn dot(&self, x: &Self) -> f64 {
        tally(|| Ops::dots(1, 4));
        self.coords.dot(&x.coords)
    }
    #[inline]
    fn is_finite(&self) -> bool {
        self.coords.iter().all(|x| x.is_finite())
    }
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<A: Metric, B: Metric<Scalar = A::Scalar>> Metric for (A, B) {
    type Scalar = A::Scalar;
    const IS_SMALL: bool = A::IS_SMALL && B::IS_SMALL;
    fn check_sizes(&self, arg: &'static str, like: &Self) -> Result<(), Error> {
        self.0.check_sizes(arg, &like.0)?;
        self.1.check_sizes(arg, &like.1)
    }
    #[inline]
    fn assign(&mut self, x: &Self) {
        self.0.assign(&x.0);
        self.1.assign(&x.1);
    }
    #[inline]
    fn size(&self) -> A::Scalar {
        let (a, b) = (self.0.size(), self.1.size());
        (a * a + b * b).sqrt()
    }
    #[inline]
    fn distance(&self, x: &Self) -> A::Scalar {
        let (a, b) = (self.0.distance(&x.0), self.1.distance(&x.1));
        (a * a + b * b).sqrt()
    }
    #[inline]
    fn is_same(&self, x: &Self) -> bool {
        self.0.is_same(&x.0) && self.1.is_same(&x.1)
    }
    #[inline]
    fn error_ratio(&self, gap: Gap<'_, Self>, scales: &mut Scales<'_>) -> A::Scalar {
        let first = self.0.error_ratio(gap.part(|y| &y.0), scales);
        larger(first, self.1.error_ratio(gap.part(|y| &y.1), scales))
    }
}

impl<A: LinearSpace, B: LinearSpace<Scalar = A::Scalar>> LinearSpace for (A, B) {
    #[inline]
    fn clear(&mut self) {
        self.0.clear();
        self.1.clear();
    }
    #[inline]
    fn add(&mut self, a: A::Scalar, x: &Self) {
        self.0.add(a, &x.0);
        self.1.add(a, &x.1);
    }
    #[inline]
    fn dot(&self, x: &Self) -> A::Scalar {
        self.0.dot(&x.0) + self.1.dot(&x.1)
    }
    #[inline]
    fn is_finite(&self) -> bool {
        self.0.is_finite() && self.1.is_finite()
    }
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<M: Metric, const N: usize> Metric for [M; N] {
    type Scalar = M::Scalar;
    fn check_sizes(&self, arg: &'static str, like: &Self) -> Result<(), Error> {
        self.iter().zip(like).try_for_each(|(x, like)| x.check_sizes(arg, like))
    }
    #[inline]
    fn assign(&mut self, x: &Self) {
        for (y, x) in self.iter_mut().zip(x) {
            y.assign(x);
        }
    }
    #[inline]
    fn size(&self) -> M::Scalar {
        norm(self.iter().map(M::size))
    }
    #[inline]
    fn distance(&self, x: &Self) -> M::Scalar {
        norm(self.iter().zip(x).map(|(a, b)| a.distance(b)))
    }
    #[inline]
    fn is_same(&self, x: &Self) -> bool {
        self.iter().zip(x).all(|(a, b)| a.is_same(b))
    }
    /// One part, of N components.
    #[inline]
    fn error_ratio(&self, gap: Gap<'_, Self>, scales: &mut Scales<'_>) -> M::Scalar {
        let part = scales.part();
        if part.has_components() {
            let error = |i: usize| gap.part(|y| &y[i]).error(&self[i], self[i].size());
            return part.largest((0..N).map(error), self.iter().map(M::size));
        }
        gap.ratio(self, part)
    }
}

/// √Σx².
#[inline]
fn norm<S: Real>(sizes: impl Iterator<Item = S>) -> S {
    sizes.fold(S::lit(0.0), |sum, x| sum + x * x).sqrt()
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<M: Metric> Metric for Box<[M]> {
    type Scalar = M::Scalar;
    fn check_sizes(&self, arg: &'static str, like: &Self) -> Result<(), Error> {
        if self.len() != like.len() {
            let (found, expected) = (self.len(), like.len().to_string());
            return Err(Error::Length { arg: arg.into(), found, expected });
        }
        self.iter().zip(like).try_for_each(|(x, like)| x.check_sizes(arg, like))
    }
    #[inline]
    fn assign(&mut self, x: &Self) {
        for (y, x) in self.iter_mut().zip(x) {
            y.assign(x);
        }
    }
    fn size(&self) -> M::Scalar {
        norm(self.iter().map(M::size))
    }
    fn distance(&self, x: &Self) -> M::Scalar {
        norm(self.iter().zip(x).map(|(a, b)| a.distance(b)))
    }
    fn is_same(&self, x: &Self) -> bool {
        self.len() == x.len() && self.iter().zip(x).all(|(a, b)| a.is_same(b))
    }
    /// All copies have the same tolerances.
    fn error_ratio(&self, gap: Gap<'_, Self>, scales: &mut Scales<'_>) -> M::Scalar {
        scales
            .for_each_copy(self.len(), |i, scales| self[i].error_ratio(gap.part(|y| &y[i]), scales))
    }
}

/// [`LinearSpace`] of entries in a row: each function goes through them.
macro_rules! entry_by_entry {
    ($([$($const:tt)*] $Entries:ty;)*) => {$(
        impl<M: LinearSpace, $($const)*> LinearSpace for $Entries {
            #[inline]
            fn clear(&mut self) {
                self.iter_mut().for_each(M::clear);
            }
            #[inline]
            fn add(&mut self, a: M::Scalar, x: &Self) {
                for (y, x) in self.iter_mut().zip(x) {
                    y.add(a, x);
                }
            }
            #[inline]
            fn dot(&self, x: &Self) -> M::Scalar {
                self.iter().zip(x).fold(M::Scalar::lit(0.0), |sum, (y, x)| sum + y.dot(x))
            }
            #[inline]
            fn is_finite(&self) -> bool {
                self.iter().all(M::is_finite)
            }
        }
    )*};
}
entry_by_entry! {
    [const N: usize] [M; N];
    [] Box<[M]>;
}
