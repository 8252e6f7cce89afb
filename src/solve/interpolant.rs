//! The points of a run at all times, as numbers: no step is repeated, and f is not called.
//!
//! In a step from p the method gives y(t + θh) = λ_p(u(θ)), where u(θ) ∈ 𝔤 is a polynomial of degree 7 at most
//! ([`Within::Chart`]). On the linear space around M the point itself is the polynomial ([`Within::Space`]). A piece
//! holds p and the coefficients of Chebyshev's polynomials T₀, …, T₇ in 2θ − 1. Of a Lie series it holds p and the terms
//! of the series ([`Within::Series`]).

use core::f64::consts::PI;
use std::sync::Arc;

use super::held::Held;
use super::stats::RunError;
use crate::actions::Action;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::methods::{Method, Step, Within};
use crate::problems::{AlgOf, PointOf, Problem, ScalarOf};
use crate::scalar::Real;
use crate::space::Numbers;

/// The number of coefficients.
const COUNT: usize = 8;

/// The θ of node number j.
pub(super) fn node(j: usize) -> f64 {
    0.5 + 0.5 * (PI * (j as f64 + 0.5) / COUNT as f64).cos()
}

/// The weights of the values at the nodes in coefficient number k.
fn of_values(k: usize) -> [f64; COUNT] {
    let scale = if k == 0 { 1.0 } else { 2.0 } / COUNT as f64;
    core::array::from_fn(|j| scale * (PI * k as f64 * (j as f64 + 0.5) / COUNT as f64).cos())
}

/// T₀, …, T₇ at 2θ − 1.
fn polynomials(theta: f64) -> [f64; COUNT] {
    let x = 2.0 * theta - 1.0;
    let mut t = [1.0; COUNT];
    t[1] = x;
    for k in 2..COUNT {
        t[k] = 2.0 * x * t[k - 1] - t[k - 2];
    }
    t
}

/// The function that lists the numbers of a point.
pub(super) type Listing<P> = fn(&mut PointOf<P>, &mut dyn FnMut(&mut f64));

/// The polynomial of a piece.
enum Curve<P: Problem> {
    /// u(θ) in the chart around the point.
    Chart(PointOf<P>, [AlgOf<P>; COUNT]),
    /// The numbers of y(θ), one coefficient after the other.
    Space(Vec<f64>),
    /// The terms of the series of the method from the point.
    Series(PointOf<P>, Vec<f64>),
}

/// A step, with the times at which it began and up to which it is valid.
pub(super) struct Piece<P: Problem> {
    span: [f64; 2],
    step: Step<f64>,
    curve: Curve<P>,
}

/// The point of the chart and u(θ): a function writes both for a θ.
type Coordinates<'a, P> = dyn FnMut(f64, &mut PointOf<P>, &mut AlgOf<P>) + 'a;

/// u(θ) by its values at the nodes.
fn chart_curve<P: Problem>(
    problem: &P,
    mut base: PointOf<P>,
    coordinates: &mut Coordinates<'_, P>,
) -> Result<Curve<P>, StepError> {
    let group = problem.group();
    let mut values: [AlgOf<P>; COUNT] = core::array::from_fn(|_| group.zero());
    for (j, u) in values.iter_mut().enumerate() {
        coordinates(node(j), &mut base, u);
        StepError::finite(group.is_finite(u), "the continuous extension")?;
    }
    let mut coefficients: [AlgOf<P>; COUNT] = core::array::from_fn(|_| group.zero());
    for (k, c) in coefficients.iter_mut().enumerate() {
        group.combine(ScalarOf::<P>::lit(1.0), &of_values(k), &values, c);
    }
    Ok(Curve::Chart(base, coefficients))
}

/// The coefficients by the numbers of a point at each node, one node after the other.
fn of_values_at_nodes(values: &[f64]) -> Vec<f64> {
    let size = values.len() / COUNT;
    let mut numbers = vec![0.0; values.len()];
    for k in 0..COUNT {
        for (j, w) in of_values(k).iter().enumerate() {
            for i in 0..size {
                numbers[k * size + i] += w * values[j * size + i];
            }
        }
    }
    numbers
}

impl<P: Problem> Piece<P> {
    /// The piece of the last step with this workspace, which is prepared for points within the step.
    pub(super) fn record<M: Method<P>>(
        (problem, method): (&P, &M),
        (step, span): (Step<f64>, [f64; 2]),
        from: &PointOf<P>,
        work: &mut M::Work,
        (at, list): (&mut PointOf<P>, Listing<P>),
    ) -> Result<Self, StepError> {
        let Step { n, t, h } = step;
        let typed = Step { n, t: ScalarOf::<P>::lit(t), h: ScalarOf::<P>::lit(h) };
        let curve = match method.within(work) {
            Within::Chart => chart_curve(problem, from.clone(), &mut |theta, base, u| {
                method.coordinates(problem, typed, theta, base, work, u);
            })?,
            Within::Space => {
                let mut values = Vec::new();
                for j in 0..COUNT {
                    method.interpolate(problem, typed, node(j), from, work, at)?;
                    list(at, &mut |x| values.push(*x));
                }
                Curve::Space(of_values_at_nodes(&values))
            }
            Within::Series => {
                let mut terms = Vec::new();
                method.each_term(work, &mut |x| terms.push(*x));
                if !terms.iter().all(|x| x.is_finite()) {
                    return Err(StepError::NotFinite { what: "the Taylor series" });
                }
                Curve::Series(from.clone(), terms)
            }
            Within::Steps => return Err(StepError::NotFinite { what: "the continuous extension" }),
        };
        Ok(Piece { span, step, curve })
    }

    /// Lets the piece end at t.
    pub(super) fn cut(&mut self, t: f64) {
        self.span[1] = t;
    }
}

/// The error of a method whose points within a step are shorter steps.
pub(super) fn no_polynomial() -> Error {
    Error::Unsupported {
        what: "dense output as data",
        with: "this method".into(),
        why: "points within its steps are shorter steps, which call f again. With an adaptive step size use rkmk or rk \
              with a pair, such as dop853, verner6, dopri5, bs3, or a Lie series, or magnus43. With steps of one size \
              use rkmk or rk with any tableau, a Lie series, rkmk4-2c, rkmk-gauss4, gauss4 or gauss6",
    }
}

/// The solution of a run at all times, as numbers.
///
/// [`Solve::run_interpolant`](super::Solve::run_interpolant) makes it. A [`reader`](Self::reader) computes points, in any
/// order. It does not call f and does not repeat steps. Cost of a point: one combination of eight elements of 𝔤, Ψ and Λ;
/// of a Lie series the sum of its terms, and Λ. Its error is that of the continuous extension of the method, and rounding.
///
/// ```
/// use lieflow::prelude::*;
/// use lieflow::problems::RigidBody;
/// use lieflow::nalgebra::Vector3;
///
/// let body = RigidBody::<f64>::new([1.0, 2.0, 3.0])?;
/// let method = Rkmk::new(DOPRI5, Exp);
/// let (run, curve) = Solve::new(&body, &method, [0.0, 10.0])
///     .tolerances(1e-9, 1e-12)
///     .run_interpolant(Vector3::new(0.2, 0.0, 3.0))?;
/// let mut reader = curve.reader()?;
/// assert!((reader.at(std::f64::consts::PI)?.norm() - 9.04f64.sqrt()).abs() < 1e-14);
/// assert_eq!(*reader.at(10.0)?, run.y);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct Interpolant<'a, P: Problem, M: Method<P>> {
    problem: Held<'a, P>,
    method: Held<'a, M>,
    pieces: Vec<Piece<P>>,
    /// The end.
    t: f64,
    y: PointOf<P>,
}

impl<'a, P: Problem, M: Method<P>> Interpolant<'a, P, M> {
    pub(super) fn new(
        (problem, method): (Held<'a, P>, Held<'a, M>),
        pieces: Vec<Piece<P>>,
        (t, y): (f64, PointOf<P>),
    ) -> Self {
        Interpolant { problem, method, pieces, t, y }
    }

    /// The first and the last time.
    pub fn t_span(&self) -> [f64; 2] {
        [self.pieces.first().map_or(self.t, |piece| piece.span[0]), self.t]
    }

    /// The number of steps.
    pub fn steps(&self) -> usize {
        self.pieces.len()
    }

    /// The interpolant without a borrow; `None` if the run borrows its problem or its method.
    ///
    /// A run of [`Solve::shared`](super::Solve::shared) borrows neither.
    pub fn into_shared(self) -> Option<Interpolant<'static, P, M>> {
        let Interpolant { problem, method, pieces, t, y } = self;
        match (problem, method) {
            (Held::Shared(problem), Held::Shared(method)) => {
                let (problem, method) = (Held::Shared(problem), Held::Shared(method));
                Some(Interpolant { problem, method, pieces, t, y })
            }
            _ => None,
        }
    }

    /// Makes what computes points. Only this call allocates.
    ///
    /// # Errors
    /// As [`Method::work`].
    pub fn reader(&self) -> Result<Reader<'_, 'a, P, M>, Error> {
        let work = self.method.work(&self.problem, &self.y)?;
        let (u, at) = (self.problem.group().zero(), self.y.clone());
        Ok(Reader { of: self, work, u, at, numbers: Vec::new(), series: None })
    }
}

/// Computes the points of an [`Interpolant`].
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct Reader<'i, 'a, P: Problem, M: Method<P>> {
    of: &'i Interpolant<'a, P, M>,
    work: M::Work,
    u: AlgOf<P>,
    at: PointOf<P>,
    numbers: Vec<f64>,
    /// The piece whose terms are in the workspace.
    series: Option<usize>,
}

impl<P: Problem<Action: Action<P::Group, Point: Numbers>>, M: Method<P>> Reader<'_, '_, P, M> {
    /// The point at t.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a t outside the span, [`RunError::Within`] where the point cannot be computed.
    pub fn at(&mut self, t: f64) -> Result<&PointOf<P>, RunError> {
        let Reader { of, work, u, at, numbers, series } = self;
        let (problem, method) = (&*of.problem, &*of.method);
        let [start, end] = of.t_span();
        if !(start.min(end) <= t && t <= start.max(end)) {
            let expected = format!("within [{start}, {end}]");
            return Err(Error::out_of_range("t", t, expected).into());
        }
        let forward = end >= start;
        // The first piece that ends after t.
        let index = of.pieces.partition_point(|piece| match forward {
            true => piece.span[1] <= t,
            false => piece.span[1] >= t,
        });
        let piece = match of.pieces.get(index) {
            Some(piece) if t != end => piece,
            _ => return Ok(&of.y),
        };
        let Step { n, t: from, h } = piece.step;
        let theta = ((t - from) / h).clamp(0.0, 1.0);
        match &piece.curve {
            Curve::Series(base, terms) => {
                if *series != Some(index) {
                    let mut terms = terms.iter();
                    method.each_term(work, &mut |x| *x = terms.next().copied().unwrap_or(*x));
                    *series = Some(index);
                }
                let step = Step { n, t: ScalarOf::<P>::lit(from), h: ScalarOf::<P>::lit(h) };
                method
                    .interpolate(problem, step, theta, base, work, at)
                    .map_err(|source| RunError::Within { t: from, h, source })?;
            }
            Curve::Chart(base, coefficients) => {
                let weights = polynomials(theta);
                problem.group().combine(ScalarOf::<P>::lit(1.0), &weights, coefficients, u);
                method
                    .on_chart(problem, n, base, u, work, at)
                    .map_err(|source| RunError::Within { t: from, h, source })?;
            }
            Curve::Space(coefficients) => {
                let size = coefficients.len() / COUNT;
                numbers.clear();
                numbers.resize(size, 0.0);
                for (w, c) in polynomials(theta).iter().zip(coefficients.chunks_exact(size.max(1)))
                {
                    numbers.iter_mut().zip(c).for_each(|(x, c)| *x += w * c);
                }
                let mut numbers = numbers.iter();
                at.each_number(&mut |x| *x = numbers.next().copied().unwrap_or(*x));
            }
        }
        Ok(&self.at)
    }
}

/// The mark of a piece in a chart, in its numbers.
const CHART: f64 = 1.0;
/// The mark of a piece in the linear space.
const SPACE: f64 = 2.0;
/// The mark of a piece of a series.
const SERIES: f64 = 3.0;

impl<'a, P, M> Interpolant<'a, P, M>
where
    P: Problem<Action: Action<P::Group, Point: Numbers>>,
    AlgOf<P>: Numbers,
    M: Method<P>,
{
    /// All its numbers, to store it. [`from_numbers`](Self::from_numbers) makes it again.
    pub fn numbers(&self) -> Vec<f64> {
        let mut all = vec![self.t];
        self.y.clone().each_number(&mut |x| all.push(*x));
        for Piece { span: [from, until], step: Step { n, t, h }, curve } in &self.pieces {
            let mark = match curve {
                Curve::Chart(..) => CHART,
                Curve::Space(_) => SPACE,
                Curve::Series(..) => SERIES,
            };
            all.extend([mark, *from, *until, f64::from_bits(*n), *t, *h]);
            match curve {
                Curve::Chart(base, coefficients) => {
                    base.clone().each_number(&mut |x| all.push(*x));
                    coefficients.clone().each_number(&mut |x| all.push(*x));
                }
                Curve::Space(coefficients) => all.extend(coefficients),
                Curve::Series(base, terms) => {
                    base.clone().each_number(&mut |x| all.push(*x));
                    all.extend(terms);
                }
            }
        }
        all
    }

    /// Makes it from its [`numbers`](Self::numbers), for the same problem and method. f is not called. `like` is any
    /// point of M, which gives the size.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for numbers that are not those of such a problem.
    pub fn from_numbers(
        problem: Arc<P>,
        method: Arc<M>,
        like: &PointOf<P>,
        numbers: &[f64],
    ) -> Result<Self, Error> {
        let wrong = || {
            let expected = "the numbers of an interpolant of the same problem and method";
            Error::out_of_range("numbers", numbers.len() as f64, expected)
        };
        let mut rest = numbers.iter().copied();
        let t = rest.next().ok_or_else(wrong)?;
        let mut complete = true;
        let mut fill = |rest: &mut dyn Iterator<Item = f64>, x: &mut f64| match rest.next() {
            Some(value) => *x = value,
            None => complete = false,
        };
        let mut y = like.clone();
        let mut size = 0;
        y.each_number(&mut |x| {
            size += 1;
            fill(&mut rest, x);
        });
        let (mut pieces, mut work) = (Vec::new(), method.work(&problem, like)?);
        while let Some(mark) = rest.next() {
            let mut head = [0.0; 5];
            head.iter_mut().for_each(|x| fill(&mut rest, x));
            let [from, until, n, t, h] = head;
            let curve = if mark == CHART {
                let mut base = like.clone();
                base.each_number(&mut |x| fill(&mut rest, x));
                let mut coefficients: [AlgOf<P>; COUNT] =
                    core::array::from_fn(|_| problem.group().zero());
                coefficients.each_number(&mut |x| fill(&mut rest, x));
                Curve::Chart(base, coefficients)
            } else if mark == SPACE {
                let mut coefficients = vec![0.0; size * COUNT];
                coefficients.iter_mut().for_each(|x| fill(&mut rest, x));
                Curve::Space(coefficients)
            } else if mark == SERIES {
                let mut base = like.clone();
                base.each_number(&mut |x| fill(&mut rest, x));
                let mut terms = Vec::new();
                method.each_term(&mut work, &mut |x| {
                    fill(&mut rest, x);
                    terms.push(*x);
                });
                Curve::Series(base, terms)
            } else {
                return Err(wrong());
            };
            let step = Step { n: n.to_bits(), t, h };
            pieces.push(Piece { span: [from, until], step, curve });
        }
        let finite = |piece: &Piece<P>| piece.span[1].is_finite() && piece.step.h.is_finite();
        if !complete || !t.is_finite() || !pieces.iter().all(finite) {
            return Err(wrong());
        }
        let (problem, method) = (Held::Shared(problem), Held::Shared(method));
        Ok(Interpolant { problem, method, pieces, t, y })
    }
}
