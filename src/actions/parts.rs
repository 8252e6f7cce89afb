//! Actions of products, part by part.
//!
//! Λ((a, b), (p, q)) = (Λ₁(a, p), Λ₂(b, q)) on A × B, and Λ on each of the copies of Gᴺ.
//!
//! [`Linear`](super::Linear) and [`LeftTranslation`](super::LeftTranslation) also work on products directly. `Linear`
//! forms no group elements; example: spins on spheres are `Linear` on SO(3)ᴺ.

use super::{Action, Coadjoint};
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, LieGroup, Power, Product, worse};
use crate::maps::{CoordinateMap, PsiOf};
use crate::scalar::larger;
use crate::tolerance::Scales;

/// An action on M₁ × M₂ with one action for each part of a [`Product`].
///
/// ```
/// use lieflow::Action;
/// use lieflow::actions::{LeftTranslation, Linear, Pair};
/// use lieflow::groups::{LieGroup, Product, So3};
/// use lieflow::nalgebra::{Matrix3, Vector3};
/// // An attitude, and a vector that another rotation turns.
/// let (group, action) = (Product(So3::<f64>::new(), So3::new()), Pair(LeftTranslation, Linear));
/// let p = (Matrix3::identity(), Vector3::new(1.0, 2.0, 3.0));
/// let (mut q, mut work) = (p.clone(), action.work(&group));
/// action.act(&group, &group.identity(), &p, &mut q, &mut work);
/// assert_eq!(p, q);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pair<L, R>(pub L, pub R);

/// The action of a [`Power`] on Mᴺ by one action on every copy of M.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Each<L>(pub L);

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<A, B, L, R> Action<Product<A, B>> for Pair<L, R>
where
    A: LieGroup,
    B: LieGroup<Scalar = A::Scalar>,
    L: Action<A>,
    R: Action<B>,
{
    type Point = (L::Point, R::Point);
    type Work = (L::Work, R::Work);

    fn work(&self, group: &Product<A, B>) -> Self::Work {
        (self.0.work(&group.0), self.1.work(&group.1))
    }
    fn check(&self, group: &Product<A, B>, p: &Self::Point) -> Result<(), Error> {
        self.0.check(&group.0, &p.0)?;
        self.1.check(&group.1, &p.1)
    }
    fn check_member(&self, group: &Product<A, B>, p: &Self::Point) -> Result<(), Error> {
        self.0.check_member(&group.0, &p.0)?;
        self.1.check_member(&group.1, &p.1)
    }
    #[inline(always)]
    fn is_finite(&self, group: &Product<A, B>, p: &Self::Point) -> bool {
        self.0.is_finite(&group.0, &p.0) && self.1.is_finite(&group.1, &p.1)
    }
    #[inline]
    fn act(
        &self,
        group: &Product<A, B>,
        g: &(A::Elem, B::Elem),
        p: &Self::Point,
        q: &mut Self::Point,
        work: &mut Self::Work,
    ) {
        self.0.act(&group.0, &g.0, &p.0, &mut q.0, &mut work.0);
        self.1.act(&group.1, &g.1, &p.1, &mut q.1, &mut work.1);
    }
    #[inline]
    fn generate(
        &self,
        group: &Product<A, B>,
        v: &(A::Alg, B::Alg),
        y: &Self::Point,
        dy: &mut Self::Point,
        work: &mut Self::Work,
    ) {
        self.0.generate(&group.0, &v.0, &y.0, &mut dy.0, &mut work.0);
        self.1.generate(&group.1, &v.1, &y.1, &mut dy.1, &mut work.1);
    }
    #[inline(always)]
    fn lambda<Psi: CoordinateMap<Product<A, B>>>(
        &self,
        psi_u: PsiOf<'_, Product<A, B>, Psi>,
        p: &Self::Point,
        q: &mut Self::Point,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (group, g) = psi_u.form()?;
        self.act(group, g, p, q, work);
        Ok(())
    }
    fn residual_size(&self, group: &Product<A, B>, p: &Self::Point) -> A::Scalar {
        larger(self.0.residual_size(&group.0, &p.0), self.1.residual_size(&group.1, &p.1))
    }
    fn restore(
        &self,
        group: &Product<A, B>,
        p: &mut Self::Point,
        work: &mut Self::Work,
    ) -> Option<A::Scalar> {
        let first = self.0.restore(&group.0, &mut p.0, &mut work.0);
        worse(first, self.1.restore(&group.1, &mut p.1, &mut work.1))
    }
    #[inline]
    fn error_ratio(
        &self,
        group: &Product<A, B>,
        e: &(A::Alg, B::Alg),
        y: &Self::Point,
        scales: &mut Scales<'_>,
    ) -> A::Scalar {
        let first = self.0.error_ratio(&group.0, &e.0, &y.0, scales);
        larger(first, self.1.error_ratio(&group.1, &e.1, &y.1, scales))
    }
    #[inline]
    fn error_ratio_of_step(
        &self,
        group: &Product<A, B>,
        e: &(A::Alg, B::Alg),
        [y, z]: [&Self::Point; 2],
        scales: &mut Scales<'_>,
    ) -> A::Scalar {
        let first = self.0.error_ratio_of_step(&group.0, &e.0, [&y.0, &z.0], scales);
        larger(first, self.1.error_ratio_of_step(&group.1, &e.1, [&y.1, &z.1], scales))
    }
    fn restore_to(
        &self,
        group: &Product<A, B>,
        from: &Self::Point,
        p: &mut Self::Point,
        work: &mut Self::Work,
    ) -> Option<A::Scalar> {
        let first = self.0.restore_to(&group.0, &from.0, &mut p.0, &mut work.0);
        worse(first, self.1.restore_to(&group.1, &from.1, &mut p.1, &mut work.1))
    }
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl<G: LieGroup, L: Action<G>> Action<Power<G>> for Each<L> {
    type Point = Box<[L::Point]>;
    /// One copy after the other.
    type Work = L::Work;

    fn work(&self, group: &Power<G>) -> L::Work {
        self.0.work(group.group())
    }
    fn check(&self, group: &Power<G>, p: &Self::Point) -> Result<(), Error> {
        group.check_copies("y", p)?;
        p.iter().try_for_each(|p| self.0.check(group.group(), p))
    }
    fn check_member(&self, group: &Power<G>, p: &Self::Point) -> Result<(), Error> {
        p.iter().try_for_each(|p| self.0.check_member(group.group(), p))
    }
    #[inline(always)]
    fn is_finite(&self, group: &Power<G>, p: &Self::Point) -> bool {
        p.iter().all(|p| self.0.is_finite(group.group(), p))
    }
    #[inline]
    fn act(
        &self,
        group: &Power<G>,
        g: &Box<[G::Elem]>,
        p: &Self::Point,
        q: &mut Self::Point,
        work: &mut L::Work,
    ) {
        for ((g, p), q) in g.iter().zip(p).zip(q) {
            self.0.act(group.group(), g, p, q, work);
        }
    }
    #[inline]
    fn generate(
        &self,
        group: &Power<G>,
        v: &Box<[G::Alg]>,
        y: &Self::Point,
        dy: &mut Self::Point,
        work: &mut L::Work,
    ) {
        for ((v, y), dy) in v.iter().zip(y).zip(dy) {
            self.0.generate(group.group(), v, y, dy, work);
        }
    }
    #[inline(always)]
    fn lambda<Psi: CoordinateMap<Power<G>>>(
        &self,
        psi_u: PsiOf<'_, Power<G>, Psi>,
        p: &Self::Point,
        q: &mut Self::Point,
        work: &mut Self::Work,
    ) -> Result<(), StepError> {
        let (group, g) = psi_u.form()?;
        self.act(group, g, p, q, work);
        Ok(())
    }
    fn residual_size(&self, group: &Power<G>, p: &Self::Point) -> G::Scalar {
        let each = p.iter().map(|p| self.0.residual_size(group.group(), p));
        each.fold(crate::scalar::Real::lit(1.0), larger)
    }
    fn restore(
        &self,
        group: &Power<G>,
        p: &mut Self::Point,
        work: &mut L::Work,
    ) -> Option<G::Scalar> {
        p.iter_mut().fold(None, |all, p| worse(all, self.0.restore(group.group(), p, work)))
    }
    fn error_ratio(
        &self,
        group: &Power<G>,
        e: &Box<[G::Alg]>,
        y: &Self::Point,
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        scales.for_each_copy(group.copies(), |i, scales| {
            self.0.error_ratio(group.group(), &e[i], &y[i], scales)
        })
    }
    fn error_ratio_of_step(
        &self,
        group: &Power<G>,
        e: &Box<[G::Alg]>,
        [y, z]: [&Self::Point; 2],
        scales: &mut Scales<'_>,
    ) -> G::Scalar {
        scales.for_each_copy(group.copies(), |i, scales| {
            self.0.error_ratio_of_step(group.group(), &e[i], [&y[i], &z[i]], scales)
        })
    }
    fn restore_to(
        &self,
        group: &Power<G>,
        from: &Self::Point,
        p: &mut Self::Point,
        work: &mut L::Work,
    ) -> Option<G::Scalar> {
        let each = from.iter().zip(p);
        each.fold(None, |all, (from, p)| {
            worse(all, self.0.restore_to(group.group(), from, p, work))
        })
    }
}

/// Every function of [`Action`] as the action `$by` of type `$By` has it on `$Group`.
macro_rules! as_the_action {
    ($by:expr, $By:ty, $Group:ty) => {
        type Point = <$By as Action<$Group>>::Point;
        type Work = <$By as Action<$Group>>::Work;

        fn work(&self, group: &$Group) -> Self::Work {
            $by.work(group)
        }
        fn check(&self, group: &$Group, p: &Self::Point) -> Result<(), Error> {
            $by.check(group, p)
        }
        fn check_member(&self, group: &$Group, p: &Self::Point) -> Result<(), Error> {
            $by.check_member(group, p)
        }
        #[inline(always)]
        fn is_finite(&self, group: &$Group, p: &Self::Point) -> bool {
            $by.is_finite(group, p)
        }
        #[inline]
        fn act(
            &self,
            group: &$Group,
            g: &<$Group as LieGroup>::Elem,
            p: &Self::Point,
            q: &mut Self::Point,
            work: &mut Self::Work,
        ) {
            $by.act(group, g, p, q, work);
        }
        #[inline]
        fn generate(
            &self,
            group: &$Group,
            v: &<$Group as LieAlgebra>::Alg,
            y: &Self::Point,
            dy: &mut Self::Point,
            work: &mut Self::Work,
        ) {
            $by.generate(group, v, y, dy, work);
        }
        #[inline]
        fn error_ratio(
            &self,
            group: &$Group,
            e: &<$Group as LieAlgebra>::Alg,
            y: &Self::Point,
            scales: &mut Scales<'_>,
        ) -> <$Group as LieAlgebra>::Scalar {
            $by.error_ratio(group, e, y, scales)
        }
        #[inline]
        fn error_ratio_of_step(
            &self,
            group: &$Group,
            e: &<$Group as LieAlgebra>::Alg,
            ends: [&Self::Point; 2],
            scales: &mut Scales<'_>,
        ) -> <$Group as LieAlgebra>::Scalar {
            $by.error_ratio_of_step(group, e, ends, scales)
        }
        #[inline(always)]
        fn lambda<Psi: CoordinateMap<$Group>>(
            &self,
            psi_u: PsiOf<'_, $Group, Psi>,
            p: &Self::Point,
            q: &mut Self::Point,
            work: &mut Self::Work,
        ) -> Result<(), StepError> {
            $by.lambda(psi_u, p, q, work)
        }
        fn restore(
            &self,
            group: &$Group,
            p: &mut Self::Point,
            work: &mut Self::Work,
        ) -> Option<<$Group as LieAlgebra>::Scalar> {
            $by.restore(group, p, work)
        }
        fn residual_size(&self, group: &$Group, p: &Self::Point) -> <$Group as LieAlgebra>::Scalar {
            $by.residual_size(group, p)
        }
        fn restore_to(
            &self,
            group: &$Group,
            from: &Self::Point,
            p: &mut Self::Point,
            work: &mut Self::Work,
        ) -> Option<<$Group as LieAlgebra>::Scalar> {
            $by.restore_to(group, from, p, work)
        }
    };
}

/// On 𝔞* × 𝔟*, each part on its own.
#[deny(clippy::missing_trait_methods)] // passes on every function
impl<A, B> Action<Product<A, B>> for Coadjoint
where
    A: LieGroup,
    B: LieGroup<Scalar = A::Scalar>,
    Coadjoint: Action<A> + Action<B>,
{
    as_the_action!(Pair(Coadjoint, Coadjoint), Pair<Coadjoint, Coadjoint>, Product<A, B>);
}

/// On (𝔤*)ᴺ, copy by copy.
#[deny(clippy::missing_trait_methods)] // passes on every function
impl<G: LieGroup> Action<Power<G>> for Coadjoint
where
    Coadjoint: Action<G>,
{
    as_the_action!(Each(Coadjoint), Each<Coadjoint>, Power<G>);
}
