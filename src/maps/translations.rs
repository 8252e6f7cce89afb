//! The maps on the translations of a linear space are all the identity: Ψ(u) = u, dΨ⁻¹ = id.

use super::{Cay, Ccsk, CoordinateMap, Exp, Pade22, TruncatedExp};
use crate::error::{Error, StepError};
use crate::groups::Translations;
use crate::space::LinearSpace;

macro_rules! identity_map {
    ($($map:ty, $name:expr $(, $index:ident)*;)*) => {$(
        impl<V: LinearSpace, $(const $index: usize),*> CoordinateMap<Translations<V>> for $map {
            type At = ();

            fn name(&self) -> &'static str {
                $name
            }
            fn at(&self, _: &Translations<V>) -> Result<(), Error> {
                Ok(())
            }
            #[inline]
            fn psi(&self, _: &Translations<V>, u: &V, _: &mut (), g: &mut V) -> Result<(), StepError> {
                g.assign(u);
                StepError::finite(g.is_finite(), "the translation")
            }
            #[inline]
            fn dpsi_inv(&self, _: &Translations<V>, _: &V, _: &mut (), _: &mut V) -> Result<(), StepError> {
                Ok(())
            }
        }
    )*};
}
identity_map! {
    Exp, "exp";
    TruncatedExp, "exp";
    Cay, "cay";
    Pade22, "pade22";
    Ccsk<I, J, K>, "ccsk", I, J, K;
}
