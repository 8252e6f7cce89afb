//! Tolerances: the allowed error of a step.
//!
//! Each part of a point has a ratio, its error divided by the number in the last column. A step is accepted if the
//! largest ratio is at most 1:
//!
//! | part | error | compared with |
//! |---|---|---|
//! | of a linear space: a vector, a momentum | ‖error‖ | atol + rtol·‖y‖, in 𝔤; atol + rtol·min(‖y‖, 10 ‖y − y₀‖), in M |
//! | the same, with an atol for each component | \|error_i\|; in 𝔤 that of the whole part | atol_i + rtol·\|y_i\| |
//! | of a group: a rotation, a quaternion, a matrix | ‖e‖ in 𝔤, as an angle in radian | atol + rtol |
//! | any, by [`Rule::PerLength`] | ‖error‖ of all parts together | atol + rtol·(the length of the step) |
//!
//! ‖e‖ is the angle in radian on [`So3`](crate::groups::So3) and on unit quaternions. On groups of matrices of any size it is
//! the Frobenius norm. It is √2 times the angle of a rotation in one plane, so the same rtol is stricter there.
//!
//! Methods that estimate the error in M ([`Rk`](crate::methods::Rk), commutator-free methods, step doubling) know how far a
//! step from y₀ to y moves a part. A part that is near rest, as at a saddle, has a smaller tolerance, because small
//! components decide there. rtol has a floor of 4 ε·‖y‖, the rounding of y. Lengths do not depend on the axes, so a run
//! does not either.
//!
//! An rtol below [`least_rtol`] is refused where atol is 0: the error of a step has no digit there. So is an atol that is far
//! below the rounding of a part at the start, without an rtol ([`check_within_reach`](crate::space::check_within_reach)).
//!
//! A product has a part for each factor. SE(3) has two parts, rotation and translation. A power Gᴺ has the parts of G,
//! shared by all copies.

use crate::error::Error;
use crate::scalar::{Real, larger, smaller};

/// The quantity that rtol is relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rule {
    /// The size of the point, but at most 10 times the length of the step where the error is estimated in M.
    ///
    /// The [table](self) has the formulas. SciPy, DifferentialEquations.jl and diffrax take the size of each number. They do
    /// not look at the length of the step.
    #[default]
    PerStep,
    /// The length of the step: the error of a run is about rtol times the length of its time span.
    PerLength,
}

/// The smallest rtol that a run takes where atol is 0, in roundings of a number: the floor of rtol·‖y‖.
const LEAST_RTOL: f64 = 4.0;
/// The smallest one that makes a run more accurate. The errors of a free body in 5 time units, by `rkmk dop853`,
/// `rk dop853`, `taylor16`, `cf4`, `rkmk4` and `rkmk-gauss4`, are the same at 50 ε and at 4 ε, with up to a third more
/// steps.
const USEFUL_RTOL: f64 = 50.0;

/// The smallest rtol that a run on numbers of this type takes where atol is 0.
pub fn least_rtol<S: Real>() -> f64 {
    LEAST_RTOL * S::EPSILON
}

/// A part that a step moves by less than its size over this number has a smaller tolerance.
const REACH: f64 = 10.0;
/// The same where the tolerance is that of the whole part, however short the step is.
const WHOLE: f64 = 1e300;
/// The same for a step over a jump of f. There the rule is that of a step, too.
const JUMP: f64 = 1e301;

/// What the errors of steps are relative to, besides the sizes of the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weight {
    /// The way that the step moves them.
    Moved,
    /// Nothing: the error is noise.
    Whole,
    /// Nothing, nor the length of the step: f jumps in it.
    Jump,
}

/// The tolerance of a part of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct PartTolerance {
    rtol: f64,
    atol: f64,
    components: Vec<f64>,
    /// The error of a step is relative to the part, or to so many times the length that the step moves it.
    reach: f64,
}

impl PartTolerance {
    /// One rtol and one atol.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tolerance that is negative or not finite, and when both are 0.
    pub fn new(rtol: f64, atol: f64) -> Result<Self, Error> {
        let (rtol, atol) = (Error::not_negative("rtol", rtol)?, Error::not_negative("atol", atol)?);
        if rtol == 0.0 && atol == 0.0 {
            return Err(Error::out_of_range("rtol", rtol, "> 0 when atol is 0"));
        }
        Ok(PartTolerance { rtol, atol, components: Vec::new(), reach: REACH })
    }

    /// One rtol, and an atol for each component of a vector.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tolerance that is negative or not finite, and when rtol and an atol are 0.
    pub fn per_component(rtol: f64, atol: impl Into<Vec<f64>>) -> Result<Self, Error> {
        let components = atol.into();
        let mut least = f64::INFINITY;
        for &x in &components {
            least = least.min(Error::not_negative("atol", x)?);
        }
        let least = if components.is_empty() { 0.0 } else { least };
        Ok(PartTolerance { components, ..PartTolerance::new(rtol, least)? })
    }

    /// Checks that rtol is not below the rounding of numbers of this type, where atol is 0.
    fn check_rounding<S: Real>(&self) -> Result<(), Error> {
        let least = least_rtol::<S>();
        match self.atol == 0.0 && self.rtol < least {
            true => {
                let expected = format!(
                    "at least {least:.0e}, where atol is 0; {:.0e} is the smallest that makes a run more accurate",
                    USEFUL_RTOL * S::EPSILON
                );
                Err(Error::out_of_range("rtol", self.rtol, expected))
            }
            false => Ok(()),
        }
    }

    /// The relative tolerance.
    pub fn rtol(&self) -> f64 {
        self.rtol
    }

    /// The absolute tolerance; of a vector with one for each component the least.
    pub fn atol(&self) -> f64 {
        self.atol
    }

    /// The allowed error of a part of this size.
    #[inline]
    pub fn scale<S: Real>(&self, size: S) -> S {
        S::lit(self.atol) + S::lit(self.rtol) * size
    }

    /// The ratio of an error of a whole part of this size. A part without components cannot have an atol for each: then
    /// the ratio is infinite, and the driver returns an error before the first step.
    #[inline(always)]
    pub fn ratio<S: Real>(&self, error: S, size: S) -> S {
        if self.components.len() > 1 {
            S::lit(f64::INFINITY)
        } else {
            ratio(error, self.scale(size))
        }
    }

    /// The ratio of an error of a whole part of this size, which a step moved by this length.
    #[inline(always)]
    pub(crate) fn ratio_of_step<S: Real>(&self, error: S, size: S, moved: S) -> S {
        if self.components.len() > 1 {
            return S::lit(f64::INFINITY);
        }
        let relative_to = smaller(size, S::lit(self.reach) * moved);
        // Where f jumps, the error of a step and its length shrink alike, down to a step of the rounding of t.
        let rounding = (1e-3 * self.rtol).clamp(4.0 * S::EPSILON, 64.0 * S::EPSILON);
        let rounding = S::lit(self.rtol.min(rounding)) * size;
        let scale = larger(S::lit(self.rtol) * relative_to, rounding);
        ratio(error, S::lit(self.atol) + scale)
    }

    /// True if there is an atol for each component.
    #[inline]
    pub(crate) fn has_components(&self) -> bool {
        !self.components.is_empty()
    }

    /// The largest ratio of the entries of an error, where there is an atol for each.
    #[inline(never)]
    pub(crate) fn largest<S: Real>(
        &self,
        errors: impl Iterator<Item = S>,
        entries: impl Iterator<Item = S>,
    ) -> S {
        let (mut most, mut atols) = (S::lit(0.0), self.components.iter());
        for (error, x) in errors.zip(entries) {
            let Some(&atol) = atols.next() else { return S::lit(f64::INFINITY) };
            most = larger(most, ratio(error.abs(), S::lit(atol) + S::lit(self.rtol) * x.abs()));
        }
        // As many tolerances as components, or no step is good enough: the driver says so before the first.
        if atols.next().is_some() { S::lit(f64::INFINITY) } else { most }
    }
}

/// error/scale, 0 for no error.
#[inline]
pub(crate) fn ratio<S: Real>(error: S, scale: S) -> S {
    if error == S::lit(0.0) { error } else { error / scale }
}

/// The tolerances of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// One for all parts, or one for each.
    parts: Vec<PartTolerance>,
    rule: Rule,
    /// Do the steps of the run have a least size?
    has_least_step: bool,
}

impl Tolerance {
    /// Sets what errors of steps are relative to.
    pub(crate) fn weigh(&mut self, by: Weight) {
        let reach = match by {
            Weight::Moved => REACH,
            Weight::Whole => WHOLE,
            Weight::Jump => JUMP,
        };
        self.parts.iter_mut().for_each(|part| part.reach = reach);
    }

    /// The same in a run whose steps have a least size, or have none.
    pub(crate) fn of_run(&self, has_least_step: bool) -> Self {
        Tolerance { has_least_step, ..self.clone() }
    }

    /// Do the steps of the run have a least size, which they take whatever their error is?
    pub(crate) fn has_least_step(&self) -> bool {
        self.has_least_step
    }

    /// One rtol and one atol for all parts.
    ///
    /// # Errors
    /// As [`PartTolerance::new`].
    pub fn new(rtol: f64, atol: f64) -> Result<Self, Error> {
        Ok(PartTolerance::new(rtol, atol)?.into())
    }

    /// One tolerance for each part of the points, in their order.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] without a part.
    pub fn of_parts(parts: impl Into<Vec<PartTolerance>>) -> Result<Self, Error> {
        let parts = parts.into();
        match parts.len() {
            0 => Err(Error::out_of_range("tolerances", 0.0, "at least one")),
            _ => Ok(Tolerance { parts, rule: Rule::default(), has_least_step: false }),
        }
    }

    /// Sets the rule: what rtol is relative to. [`Rule::PerLength`] takes one rtol and one atol for all parts.
    pub fn by(self, rule: Rule) -> Self {
        Tolerance { rule, ..self }
    }

    /// The rule.
    pub fn rule(&self) -> Rule {
        self.rule
    }

    /// The allowed error of a part of size 1. The first step is chosen by it.
    pub(crate) fn of_unit_size(&self) -> f64 {
        self.parts.iter().map(|part| part.scale(1.0)).fold(f64::INFINITY, f64::min)
    }

    /// The smallest atol.
    pub(crate) fn least_atol(&self) -> f64 {
        self.parts.iter().map(PartTolerance::atol).fold(f64::INFINITY, f64::min)
    }

    /// The tolerance of all parts together, by [`Rule::PerLength`], for this length. A step over a jump of f has that of the
    /// length 1 at least.
    #[inline]
    pub(crate) fn per_length<S: Real>(&self, length: S) -> S {
        let part = &self.parts[0];
        part.scale(if part.reach == JUMP { larger(length, S::lit(1.0)) } else { length })
    }

    /// The tolerances of the parts, in their order.
    #[inline]
    pub fn scales(&self) -> Scales<'_> {
        Scales { parts: &self.parts, next: 0 }
    }

    /// Checks that no rtol is below the rounding of numbers of this type, where its atol is 0 ([`least_rtol`]).
    /// [`Rule::PerLength`] is not checked: its tolerance is not relative to the numbers.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn check_rounding<S: Real>(&self) -> Result<(), Error> {
        match self.rule {
            Rule::PerStep => self.parts.iter().try_for_each(PartTolerance::check_rounding::<S>),
            Rule::PerLength => Ok(()),
        }
    }

    /// Checks that each of `parts` parts has a tolerance, and each component an atol.
    pub(crate) fn check(&self, parts: usize, components_fit: bool) -> Result<(), Error> {
        if !components_fit {
            let given = self.parts.iter().map(|part| part.components.len()).max().unwrap_or(0);
            let expected = "as many as the part of the point has components";
            return Err(Error::out_of_range("the number of atol", given as f64, expected));
        }
        let given = self.parts.len();
        if self.rule == Rule::PerLength && (given > 1 || !self.parts[0].components.is_empty()) {
            let expected =
                "one rtol and one atol, where the rule is relative to the length of the step";
            return Err(Error::out_of_range("tolerances", given as f64, expected));
        }
        match given == 1 || given == parts {
            true => Ok(()),
            false => Err(Error::out_of_range(
                "tolerances",
                given as f64,
                format!("1 for all parts, or {parts}, one for each part of a point"),
            )),
        }
    }
}

impl From<PartTolerance> for Tolerance {
    fn from(part: PartTolerance) -> Self {
        Tolerance { parts: vec![part], rule: Rule::default(), has_least_step: false }
    }
}

/// The tolerances of the parts of a point, one after the other.
#[derive(Clone, Debug)]
pub struct Scales<'a> {
    parts: &'a [PartTolerance],
    next: usize,
}

/// rtol = 1 and atol = 0.
static RELATIVE: [PartTolerance; 1] =
    [PartTolerance { rtol: 1.0, atol: 0.0, components: Vec::new(), reach: REACH }];

impl<'a> Scales<'a> {
    /// rtol = 1 and atol = 0 for each part: an error ratio is then a relative size.
    #[inline]
    pub(crate) fn relative() -> Self {
        Scales { parts: &RELATIVE, next: 0 }
    }
    /// The tolerance of the next part.
    #[inline]
    pub fn part(&mut self) -> &'a PartTolerance {
        let part = self.parts.get(self.next).unwrap_or(&self.parts[0]);
        self.next += 1;
        part
    }
    /// The largest error ratio over copies that share their tolerances.
    #[inline]
    pub fn for_each_copy<S: Real>(
        &mut self,
        copies: usize,
        mut ratio: impl FnMut(usize, &mut Self) -> S,
    ) -> S {
        let start = self.clone();
        let mut most = S::lit(0.0);
        for i in 0..copies {
            *self = start.clone();
            most = larger(most, ratio(i, self));
        }
        most
    }
    /// The number of parts that were requested.
    pub(crate) fn asked(&self) -> usize {
        self.next
    }
}
