//! Maps of products: Ψ(u, v) = (Ψ₁(u), Ψ₂(v)) on A × B, and Ψ on each of the copies of Gᴺ.
//!
//! dΨ⁻¹ is that of each part. The library's maps work on products through these two, under their own names.

use super::{Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp};
use crate::error::{Error, StepError};
use crate::groups::{LieAlgebra, LieGroup, Power, Product};

/// A map for each part of a [`Product`]: Ψ(u, v) = (Ψ₁(u), Ψ₂(v)).
///
/// ```
/// use lieflow::{CoordinateMap, LieAlgebra};
/// use lieflow::groups::{MatrixGroup, Product, So3};
/// use lieflow::maps::{Cay, Exp, Pair};
/// let group = Product(So3::<f64>::new(), MatrixGroup::gl(3)?);
/// let (r, g) = Pair(Exp, Cay).eval(&group, &group.zero())?;
/// assert_eq!((r[(0, 0)], g[(0, 0)]), (1.0, 1.0));
/// # Ok::<(), lieflow::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pair<P, Q>(pub P, pub Q);

/// The map of a [`Power`] by one map for every copy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Each<Psi>(pub Psi);

impl<A, B, P, Q> CoordinateMap<Product<A, B>> for Pair<P, Q>
where
    A: LieGroup,
    B: LieGroup<Scalar = A::Scalar>,
    P: CoordinateMap<A>,
    Q: CoordinateMap<B>,
{
    type At = (P::At, Q::At);

    /// The name of both where they share one, else `pair`.
    fn name(&self) -> &'static str {
        if self.0.name() == self.1.name() { self.0.name() } else { "pair" }
    }
    fn at(&self, group: &Product<A, B>) -> Result<Self::At, Error> {
        Ok((self.0.at(&group.0)?, self.1.at(&group.1)?))
    }
    #[inline]
    fn begin_step(&self, at: &mut Self::At, n: u64) {
        self.0.begin_step(&mut at.0, n);
        self.1.begin_step(&mut at.1, n);
    }
    #[inline]
    fn psi(
        &self,
        group: &Product<A, B>,
        u: &(A::Alg, B::Alg),
        at: &mut Self::At,
        g: &mut (A::Elem, B::Elem),
    ) -> Result<(), StepError> {
        self.0.psi(&group.0, &u.0, &mut at.0, &mut g.0)?;
        self.1.psi(&group.1, &u.1, &mut at.1, &mut g.1)
    }
    #[inline]
    fn psi_on(
        &self,
        group: &Product<A, B>,
        u: &(A::Alg, B::Alg),
        at: &mut Self::At,
        g: &mut (A::Elem, B::Elem),
        x: &(A::Vector, B::Vector),
        y: &mut (A::Vector, B::Vector),
    ) -> Result<(), StepError> {
        self.0.psi_on(&group.0, &u.0, &mut at.0, &mut g.0, &x.0, &mut y.0)?;
        self.1.psi_on(&group.1, &u.1, &mut at.1, &mut g.1, &x.1, &mut y.1)
    }
    #[inline]
    fn dpsi_inv(
        &self,
        group: &Product<A, B>,
        u: &(A::Alg, B::Alg),
        at: &mut Self::At,
        v: &mut (A::Alg, B::Alg),
    ) -> Result<(), StepError> {
        self.0.dpsi_inv(&group.0, &u.0, &mut at.0, &mut v.0)?;
        self.1.dpsi_inv(&group.1, &u.1, &mut at.1, &mut v.1)
    }
    fn order(&self, group: &Product<A, B>) -> usize {
        self.0.order(&group.0).min(self.1.order(&group.1))
    }
}

impl<G: LieGroup, Psi: CoordinateMap<G>> CoordinateMap<Power<G>> for Each<Psi> {
    type At = Box<[Psi::At]>;

    fn name(&self) -> &'static str {
        self.0.name()
    }
    fn at(&self, group: &Power<G>) -> Result<Self::At, Error> {
        (0..group.copies()).map(|_| self.0.at(group.group())).collect()
    }
    #[inline]
    fn begin_step(&self, at: &mut Self::At, n: u64) {
        at.iter_mut().for_each(|at| self.0.begin_step(at, n));
    }
    #[inline]
    fn psi(
        &self,
        group: &Power<G>,
        u: &Box<[G::Alg]>,
        at: &mut Self::At,
        g: &mut Box<[G::Elem]>,
    ) -> Result<(), StepError> {
        let mut copies = u.iter().zip(at).zip(g);
        copies.try_for_each(|((u, at), g)| self.0.psi(group.group(), u, at, g))
    }
    #[inline]
    fn psi_on(
        &self,
        group: &Power<G>,
        u: &Box<[G::Alg]>,
        at: &mut Self::At,
        g: &mut Box<[G::Elem]>,
        x: &Box<[G::Vector]>,
        y: &mut Box<[G::Vector]>,
    ) -> Result<(), StepError> {
        let mut copies = u.iter().zip(at).zip(g).zip(x.iter().zip(y));
        copies.try_for_each(|(((u, at), g), (x, y))| self.0.psi_on(group.group(), u, at, g, x, y))
    }
    #[inline]
    fn dpsi_inv(
        &self,
        group: &Power<G>,
        u: &Box<[G::Alg]>,
        at: &mut Self::At,
        v: &mut Box<[G::Alg]>,
    ) -> Result<(), StepError> {
        let mut copies = u.iter().zip(at).zip(v);
        copies.try_for_each(|((u, at), v)| self.0.dpsi_inv(group.group(), u, at, v))
    }
    fn order(&self, group: &Power<G>) -> usize {
        self.0.order(group.group())
    }
}

/// `$map` serves `$product` as `$with` of it. One `impl` a map: one for every map at once would have
/// the compiler look for the parts of an unknown product without end.
macro_rules! serves_as {
    ($map:ty, $product:ty, [$($parameters:tt)*], [$($bounds:tt)*], $by:ty, $with:expr) => {
        impl<$($parameters)*> CoordinateMap<$product> for $map
        where
            $($bounds)*
        {
            type At = <$by as CoordinateMap<$product>>::At;

            fn name(&self) -> &'static str {
                CoordinateMap::<$product>::name(&$with(self))
            }
            fn at(&self, group: &$product) -> Result<Self::At, Error> {
                $with(self).at(group)
            }
            #[inline]
            fn begin_step(&self, at: &mut Self::At, n: u64) {
                CoordinateMap::<$product>::begin_step(&$with(self), at, n);
            }
            #[inline]
            fn psi(
                &self,
                group: &$product,
                u: &<$product as LieAlgebra>::Alg,
                at: &mut Self::At,
                g: &mut <$product as LieGroup>::Elem,
            ) -> Result<(), StepError> {
                $with(self).psi(group, u, at, g)
            }
            #[inline]
            fn psi_on(
                &self,
                group: &$product,
                u: &<$product as LieAlgebra>::Alg,
                at: &mut Self::At,
                g: &mut <$product as LieGroup>::Elem,
                x: &<$product as LieGroup>::Vector,
                y: &mut <$product as LieGroup>::Vector,
            ) -> Result<(), StepError> {
                $with(self).psi_on(group, u, at, g, x, y)
            }
            #[inline]
            fn dpsi_inv(
                &self,
                group: &$product,
                u: &<$product as LieAlgebra>::Alg,
                at: &mut Self::At,
                v: &mut <$product as LieAlgebra>::Alg,
            ) -> Result<(), StepError> {
                $with(self).dpsi_inv(group, u, at, v)
            }
            fn order(&self, group: &$product) -> usize {
                $with(self).order(group)
            }
        }
    };
}

/// These maps work on products and powers of the groups that they work on.
macro_rules! serve_products {
    ($($map:ty $(: $($index:ident)*)?;)*) => {$(
        serves_as!(
            $map,
            Product<A, B>,
            [A: LieGroup, B: LieGroup<Scalar = A::Scalar>, $($(const $index: usize),*)?],
            [$map: CoordinateMap<A> + CoordinateMap<B>],
            Pair<$map, $map>,
            |psi: &Self| Pair(*psi, *psi)
        );
        serves_as!(
            $map,
            Power<G>,
            [G: LieGroup, $($(const $index: usize),*)?],
            [$map: CoordinateMap<G>],
            Each<$map>,
            |psi: &Self| Each(*psi)
        );
    )*};
}
serve_products! {
    Exp;
    TruncatedExp;
    Cay;
    Pade22;
    Ccsk<I, J, K>: I J K;
}
