//! Lie series (Taylor) methods of order 4 to 16 on any group, for fields with Taylor coefficients ([`TaylorField`]).
//!
//! y(t + θh) = Λ(Ψ(θ), y), Ψ' = h f Ψ, Ψ(0) = 𝟙: (k+1) Ψ_{k+1} = h Σ_{i+j=k} f_i Ψ_j
//! (Ψ_j f_i if the problem gives f in the moving frame). The distance of Σ_{k≤N} Ψ_k from the group is at most of the
//! size of the terms left out. Newton–Schulz ([`LieGroup::correct`]) moves the sum to the group, and y⁺ = Λ(Ψ, y).
//!
//! Order N. Preserves: the group and the invariants of the action, to rounding, as far as [`LieGroup::correct`] reaches;
//! energy and symmetry to the size of the terms left out. So are the determinant 1 of SL(n) and SU(n), and G_M where M is
//! neither symmetric, skew nor orthogonal, or far from a multiple of an orthogonal matrix. A sum that is far from the group
//! (0.1 in gᵀMg − M) is refused with [`StepError::OutsideChart`].
//! Cost: N(N−1)/2 products for Ψ, as many for the coefficients of a quadratic field, one action, and one or two steps
//! of Newton–Schulz. A point within a step costs only the action and Newton–Schulz. The last two terms are the error
//! estimate of an adaptive run. For the free rigid body in ℝ³ [`Taylor`](crate::methods::Taylor) is the same method on
//! quaternions. Source: W. Gröbner, Die Lie-Reihen und ihre Anwendungen (1960); À. Jorba & M. Zou, Experiment.
//! Math. 14 (2005), for the step.

#[cfg(feature = "dense")]
mod general;

use nalgebra::{Matrix3, Vector3};

use crate::actions::Action;
use crate::error::{Error, StepError};
use crate::groups::{Adjoint, LieAlgebra, LieGroup, RESIDUAL_MAX, Se3, So3, hat};
use crate::methods::embedded::ratio_of_relative;
use crate::methods::{Embedded, Facts, MapCounts, Method, Metric, Step, Within};
use crate::problems::{AlgOf, ElemOf, PointOf, ScalarOf, TaylorField};
use crate::scalar::{Real, larger};
use crate::so3::{add3, all_finite, apply3, cross};
use crate::space::{Gap, Numbers};
use crate::tolerance::{Rule, Tolerance};

/// A group whose elements lie in a linear space with products by elements of 𝔤.
pub trait SeriesGroup: LieGroup<Elem: Numbers> + LieAlgebra<Scalar: Into<f64>> {
    /// x ← 0.
    fn clear(&self, x: &mut Self::Elem);
    /// x ← a·x.
    fn scale(&self, a: Self::Scalar, x: &mut Self::Elem);
    /// y ← y + x.
    fn add(&self, x: &Self::Elem, y: &mut Self::Elem);
    /// out ← out + a·u, the product with 𝟙.
    fn add_algebra(&self, a: Self::Scalar, u: &Self::Alg, out: &mut Self::Elem);
    /// out ← out + a·u·x, or a·x·u from the right, where x is a difference of elements or a derivative of one.
    fn add_product(
        &self,
        a: Self::Scalar,
        u: &Self::Alg,
        x: &Self::Elem,
        from_right: bool,
        out: &mut Self::Elem,
    );
    /// ‖x‖, of parts without a unit.
    fn size(&self, x: &Self::Elem) -> Self::Scalar;
    /// ‖x‖ of all parts together, as [`norm`](LieAlgebra::norm) has them. The default is for parts without a unit.
    fn whole_size(&self, x: &Self::Elem) -> Self::Scalar {
        self.size(x)
    }
}

impl SeriesGroup for So3 {
    fn clear(&self, x: &mut Matrix3<f64>) {
        *x = Matrix3::zeros();
    }
    fn scale(&self, a: f64, x: &mut Matrix3<f64>) {
        *x *= a;
    }
    fn add(&self, x: &Matrix3<f64>, y: &mut Matrix3<f64>) {
        *y += x;
    }
    fn add_algebra(&self, a: f64, u: &Vector3<f64>, out: &mut Matrix3<f64>) {
        *out += hat(&(a * u));
    }
    fn add_product(
        &self,
        a: f64,
        u: &Vector3<f64>,
        x: &Matrix3<f64>,
        from_right: bool,
        out: &mut Matrix3<f64>,
    ) {
        let u = hat(&(a * u));
        *out += if from_right { x * u } else { u * x };
    }
    fn size(&self, x: &Matrix3<f64>) -> f64 {
        Metric::size(x)
    }
}

/// Elements are (R, x), as in [`Se3`].
impl<S: Real + Numbers + Into<f64>> SeriesGroup for Se3<S> {
    fn clear(&self, x: &mut Self::Elem) {
        self.scale(S::lit(0.0), x);
    }
    fn scale(&self, a: S, x: &mut Self::Elem) {
        *x = (x.0.map(|x| a * x), x.1.map(|x| a * x));
    }
    fn add(&self, x: &Self::Elem, y: &mut Self::Elem) {
        *y = (y.0.zip_map(&x.0, |y, x| y + x), add3(&y.1, &x.1));
    }
    fn add_algebra(&self, a: S, u: &Self::Alg, out: &mut Self::Elem) {
        let turned = u.0.map(|u| a * u);
        self.add(&(hat(&turned), u.1.map(|u| a * u)), out);
    }
    /// (ω̂R, ω × x), or (Rω̂, Rv) from the right: x is a derivative, so the last row of its matrix is 0.
    fn add_product(
        &self,
        a: S,
        u: &Self::Alg,
        x: &Self::Elem,
        from_right: bool,
        out: &mut Self::Elem,
    ) {
        let mut product = (x.0, x.1);
        if from_right {
            So3::new().tangent_in_body(&x.0, &u.0, &mut product.0);
            product.1 = apply3(&x.0, &u.1);
        } else {
            So3::new().tangent(&u.0, &x.0, &mut product.0);
            product.1 = cross(&u.0, &x.1);
        }
        self.scale(a, &mut product);
        self.add(&product, out);
    }
    /// ‖R‖. The size of x depends on the unit of length: the points of a step tell what its terms are.
    fn size(&self, x: &Self::Elem) -> S {
        if all_finite(&x.1) { Metric::size(&x.0) } else { S::lit(f64::NAN) }
    }
    fn whole_size(&self, x: &Self::Elem) -> S {
        let [turn, shift] = [Metric::size(&x.0), Metric::size(&x.1)];
        (turn * turn + shift * shift).sqrt()
    }
}

/// The Lie series method of an order that you choose.
///
/// ```
/// use lieflow::{StepControl, integrate_adaptive};
/// use lieflow::groups::Sample;
/// use lieflow::methods::LieSeries;
/// use lieflow::problems::{LiePoisson, Problem, RigidBodyN};
/// use lieflow::SaveAt;
/// use rand::SeedableRng;
///
/// let body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0])?;
/// let mut rng = rand_pcg::Pcg64::seed_from_u64(1);
/// let mut m = body.group().sample_algebra(&mut rng, 1.0).into_mat();
/// let before = body.hamiltonian(&m);
/// let (method, control) = (LieSeries::new(12)?, StepControl::new(0.0, 1e-12)?);
/// integrate_adaptive(&body, &method, [0.0, 10.0], &control, &SaveAt::Ends, &mut m, |_, _| {})?;
/// assert!((body.hamiltonian(&m) - before).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LieSeries {
    order: usize,
}

impl LieSeries {
    /// Makes the method of this order.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless 4 ≤ order ≤ 16.
    pub fn new(order: usize) -> Result<Self, Error> {
        match (4..=16).contains(&order) {
            true => Ok(LieSeries { order }),
            false => Err(Error::out_of_range("order", order as f64, "4 ≤ order ≤ 16")),
        }
    }

    /// w.g ← Ψ of the step, on the group.
    fn flow<P: TaylorField>(
        &self,
        problem: &P,
        Step { t, h, .. }: Step<ScalarOf<P>>,
        y: &PointOf<P>,
        w: &mut LieSeriesWork<P>,
    ) -> Result<(), StepError>
    where
        P::Group: SeriesGroup,
    {
        let LieSeriesWork { f, psi, g, series, .. } = w;
        let group = problem.group();
        for k in 0..self.order {
            problem.coefficient([t, h], y, k, f, series);
            if !group.is_finite(&f[k]) {
                return Err(match k {
                    0 => StepError::NonFiniteRhs { stage: 1 },
                    _ => StepError::NotFinite { what: "the Taylor coefficients" },
                });
            }
            let scale = h / ScalarOf::<P>::lit((k + 1) as f64);
            next_term(group, scale, &f[..=k], P::MOVING, &mut psi[..k + 2]);
        }
        group.clear(g);
        psi.iter().rev().for_each(|term| group.add(term, g)); // small terms first
        w.onto_group(group)
    }
}

/// The last of the terms Ψ_j ← scale·Σ_{i+j=k} f_i Ψ_j of the others, or scale·Σ Ψ_j f_i from the right.
#[inline(never)]
#[expect(clippy::disallowed_methods, reason = "not inlined, so each reference has one role")]
fn next_term<G: SeriesGroup>(
    group: &G,
    scale: G::Scalar,
    f: &[G::Alg],
    from_right: bool,
    psi: &mut [G::Elem],
) {
    if let (Some((next, known)), Some((last, f))) = (psi.split_last_mut(), f.split_last()) {
        group.clear(next);
        group.add_algebra(scale, last, next); // Ψ_0 = 𝟙
        for (f, psi) in f.iter().rev().zip(&known[1..]) {
            group.add_product(scale, f, psi, from_right, next);
        }
    }
}

impl<P: TaylorField> LieSeriesWork<P>
where
    P::Group: SeriesGroup,
{
    /// g ← the element of the group that is next to the sum g of the series.
    fn onto_group(&mut self, group: &P::Group) -> Result<(), StepError> {
        let LieSeriesWork { g, scratch, .. } = self;
        let residual = group.correct(g, scratch.each_mut());
        StepError::finite(group.size(g).is_finite(), "the Taylor series")?;
        if !residual.all_below(RESIDUAL_MAX) {
            return Err(StepError::OutsideChart {
                map: "Lie series",
                what: "its terms have not become small",
            });
        }
        // On so(3) and se(3) a call is one step of Newton–Schulz, which squares the residual.
        let mut rest = residual;
        for _ in 0..4 {
            if rest.all_below(ScalarOf::<P>::EPSILON.sqrt()) {
                break;
            }
            rest = group.correct(g, scratch.each_mut());
        }
        Ok(())
    }
}

/// The coefficients, and a point.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct LieSeriesWork<P: TaylorField> {
    f: Vec<AlgOf<P>>,
    psi: Vec<ElemOf<P>>,
    series: P::Series,
    g: ElemOf<P>,
    scratch: [ElemOf<P>; 2],
    act: <P::Action as Action<P::Group>>::Work,
    y: PointOf<P>,
}

impl<P: TaylorField> Method<P> for LieSeries
where
    P::Group: SeriesGroup,
{
    type Work = LieSeriesWork<P>;

    fn facts(&self, _: &P) -> Facts {
        Facts::of_order(self.order)
            .cost(Some(self.order as u64), MapCounts::default())
            .estimate("", Some(self.order - 1))
            .dense(self.order, 0)
    }
    fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
        let group = problem.group();
        Ok(LieSeriesWork {
            f: vec![group.zero(); self.order],
            psi: vec![group.identity(); self.order + 1],
            series: problem.series(self.order),
            g: group.identity(),
            scratch: [group.identity(), group.identity()],
            act: problem.action().work(group),
            y: like.clone(),
        })
    }
    fn step(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        p: &mut PointOf<P>,
        w: &mut Self::Work,
    ) -> Result<(), StepError> {
        self.flow(problem, step, p, w)?;
        problem.action().act(problem.group(), &w.g, p, &mut w.y, &mut w.act);
        core::mem::swap(p, &mut w.y);
        Ok(())
    }
    /// The series at θh, from the coefficients of the step.
    fn interpolate(
        &self,
        problem: &P,
        _: Step<ScalarOf<P>>,
        theta: f64,
        from: &PointOf<P>,
        w: &mut Self::Work,
        at: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let (group, LieSeriesWork { psi, g, .. }) = (problem.group(), &mut *w);
        group.clear(g);
        for term in psi.iter().rev() {
            group.scale(ScalarOf::<P>::lit(theta), g);
            group.add(term, g);
        }
        w.onto_group(group)?;
        problem.action().act(group, &w.g, from, at, &mut w.act);
        Ok(())
    }
    fn within(&self, _: &Self::Work) -> Within {
        Within::Series
    }
    fn each_term(&self, work: &mut Self::Work, each: &mut dyn FnMut(&mut f64)) {
        work.psi.iter_mut().for_each(|term| term.each_number(each));
    }
}

/// The error of a step follows from its last two terms.
impl<P: TaylorField> Embedded<P> for LieSeries
where
    P::Group: SeriesGroup,
{
    fn step_with_error(
        &self,
        problem: &P,
        step: Step<ScalarOf<P>>,
        tolerance: &Tolerance,
        from: &PointOf<P>,
        w: &mut Self::Work,
        to: &mut PointOf<P>,
    ) -> Result<ScalarOf<P>, StepError> {
        self.flow(problem, step, from, w)?;
        let group = problem.group();
        problem.action().act(group, &w.g, from, to, &mut w.act);
        let is_per_length = tolerance.rule() == Rule::PerLength;
        let [before, last] = [self.order - 1, self.order].map(|k| {
            let term = &w.psi[k];
            let size = if is_per_length { group.whole_size(term) } else { group.size(term) };
            Into::<f64>::into(size)
        });
        let n = self.order as f64;
        // One of the last two may vanish where the solution is even or odd.
        let error = Real::lit(last.max(before.powf(n / (n - 1.0))));
        let length = step.h.abs() * group.norm(&w.f[0]);
        let relative = ratio_of_relative(tolerance, error, from, length);
        if is_per_length {
            return Ok(relative);
        }
        // Where the last terms move a part by the size of another one, the points without them tell.
        let mut ratio = relative;
        for (k, weight) in [(self.order, 1.0), (self.order - 1, before.powf(1.0 / (n - 1.0)))] {
            let [without, _] = &mut w.scratch;
            group.clear(without);
            group.add(&w.psi[k], without);
            group.scale(ScalarOf::<P>::lit(-1.0), without);
            group.add(&w.g, without);
            problem.action().act(group, without, from, &mut w.y, &mut w.act);
            let gap = to.error_ratio(Gap::to(&w.y), &mut tolerance.scales());
            ratio = larger(ratio, ScalarOf::<P>::lit(weight) * gap);
        }
        Ok(ratio)
    }
}
