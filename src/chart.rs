//! λ_p = Λ_p ∘ Ψ and the pulled-back field f̃: the one place where the maps of Figure 2 meet.

use crate::actions::Action;
use crate::error::{Error, StepError};
use crate::groups::LieGroup;
use crate::maps::{CoordinateMap, PsiOf};
use crate::problems::{AlgOf, ElemOf, PointOf, Problem, ScalarOf};

/// The storage of a chart, made once.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct ChartStore<P: Problem, Psi: CoordinateMap<P::Group>> {
    at: Psi::At,
    g: ElemOf<P>,
    y: PointOf<P>,
    act: <P::Action as Action<P::Group>>::Work,
    field: P::Work,
}

impl<P: Problem, Psi: CoordinateMap<P::Group>> ChartStore<P, Psi> {
    /// Makes storage for `problem`. `like` is any point of M, which gives the size.
    ///
    /// # Errors
    /// [`Error::Unsupported`] when Ψ has no formula on the problem's group, [`Error::Shape`] when
    /// `like` has another size than the group acts on.
    pub fn new(problem: &P, psi: &Psi, like: &PointOf<P>) -> Result<Self, Error> {
        let group = problem.group();
        problem.action().check(group, like)?;
        Ok(ChartStore {
            at: psi.at(group)?,
            g: group.identity(),
            y: like.clone(),
            act: problem.action().work(group),
            field: problem.work(),
        })
    }

    /// The chart around `p`, for step number `n` of the run.
    #[inline(always)]
    pub fn around<'a>(
        &'a mut self,
        problem: &'a P,
        psi: &'a Psi,
        n: u64,
        p: &'a PointOf<P>,
    ) -> Chart<'a, P, Psi> {
        psi.begin_step(&mut self.at, n);
        Chart { problem, psi, p, store: self }
    }
}

/// The chart λ_p : 𝔤 → M around a point p.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
pub struct Chart<'a, P: Problem, Psi: CoordinateMap<P::Group>> {
    problem: &'a P,
    psi: &'a Psi,
    p: &'a PointOf<P>,
    store: &'a mut ChartStore<P, Psi>,
}

impl<P: Problem, Psi: CoordinateMap<P::Group>> Chart<'_, P, Psi> {
    /// q ← λ_p(u) = Λ(Ψ(u), p), equation (6).
    ///
    /// # Errors
    /// As [`CoordinateMap::psi`].
    #[inline(always)]
    pub fn lambda(&mut self, u: &AlgOf<P>, q: &mut PointOf<P>) -> Result<(), StepError> {
        let ChartStore { at, g, act, .. } = &mut *self.store;
        let psi_u = PsiOf::new(self.problem.group(), self.psi, u, at, g);
        self.problem.action().lambda(psi_u, self.p, q, act)
    }

    /// The point λ_p(u) of the last [`pullback`](Self::pullback).
    #[inline(always)]
    pub fn last_point(&self) -> &PointOf<P> {
        &self.store.y
    }

    /// k ← f(t, p): the pulled-back field at u = 0, where Ψ and dΨ⁻¹ are the identity.
    #[inline(always)]
    pub fn field(&mut self, t: ScalarOf<P>, k: &mut AlgOf<P>) {
        self.problem.f(t, self.p, k, &mut self.store.field);
    }

    /// k ← f̃(u) = dΨ_u⁻¹ (f ∘ λ_p)(u).
    ///
    /// # Errors
    /// As [`CoordinateMap::psi`] and [`CoordinateMap::dpsi_inv`].
    #[inline(always)]
    pub fn pullback(
        &mut self,
        t: ScalarOf<P>,
        u: &AlgOf<P>,
        k: &mut AlgOf<P>,
    ) -> Result<(), StepError> {
        let group = self.problem.group();
        let ChartStore { at, g, y, act, field } = &mut *self.store;
        let psi_u = PsiOf::new(group, self.psi, u, &mut *at, g);
        self.problem.action().lambda(psi_u, self.p, y, act)?;
        self.problem.f(t, y, k, field);
        self.psi.dpsi_inv(group, u, at, k)
    }
}
