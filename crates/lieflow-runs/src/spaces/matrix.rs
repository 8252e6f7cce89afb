//! The actions of a matrix group on matrices as one type, so that all problems of matrices are one
//! [`DynFlow`](lieflow::problems::DynFlow). The choice is made once a stage, beside products of matrices.
//!
//! | | Λ(g, p) |
//! |---|---|
//! | `Linear` | g p |
//! | `Translation` | g p, p ∈ G |
//! | `RightTranslation` | p g⁻¹, p ∈ G, of minus a field in the body |
//! | `Conjugation` | g p g⁻¹ |
//! | `Coadjoint` | g⁻ᵀ p gᵀ |
//! | `Lagrangian` | (C + Dp)(A + Bp)⁻¹ |

use faer::Mat;
use lieflow::actions::{Action, Coadjoint, Conjugation, Lagrangian, LeftTranslation, Linear};
use lieflow::dense::multiply_into;
use lieflow::groups::{Adjoint, AlgebraMatrix, GroupMatrix, LieGroup, MatrixGroup};
use lieflow::maps::PsiOf;
use lieflow::tolerance::Scales;
use lieflow::{CoordinateMap, Error, StepError};

/// Which action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixAction {
    /// g p.
    Linear,
    /// g p, p ∈ G.
    Translation,
    /// p g⁻¹, p ∈ G.
    RightTranslation,
    /// g p g⁻¹.
    Conjugation,
    /// g⁻ᵀ p gᵀ.
    Coadjoint,
    /// (C + Dp)(A + Bp)⁻¹.
    Lagrangian,
}

type Inverting = <MatrixGroup as Adjoint>::Inverting;

/// Scratch of the one that was chosen.
#[allow(missing_debug_implementations, missing_docs)] // scratch
pub enum MatrixWork {
    Linear,
    Translation([GroupMatrix; 2]),
    /// With g⁻¹ and its scratch.
    RightTranslation(GroupMatrix, Inverting, [GroupMatrix; 2]),
    Conjugation(<Conjugation as Action<MatrixGroup>>::Work),
    Coadjoint(<Coadjoint as Action<MatrixGroup>>::Work),
    Lagrangian(<Lagrangian as Action<MatrixGroup>>::Work),
}

/// x ← −x.
pub fn reverse(x: &mut Mat<f64>) {
    x.col_iter_mut().for_each(|column| column.iter_mut().for_each(|x| *x = -*x));
}

#[deny(clippy::missing_trait_methods)] // passes on every function
impl Action<MatrixGroup> for MatrixAction {
    type Point = Mat<f64>;
    type Work = MatrixWork;

    fn work(&self, group: &MatrixGroup) -> MatrixWork {
        match self {
            MatrixAction::Linear => MatrixWork::Linear,
            MatrixAction::Translation => MatrixWork::Translation(LeftTranslation.work(group)),
            MatrixAction::RightTranslation => MatrixWork::RightTranslation(
                group.identity(),
                group.inverting(),
                LeftTranslation.work(group),
            ),
            MatrixAction::Conjugation => MatrixWork::Conjugation(Conjugation.work(group)),
            MatrixAction::Coadjoint => MatrixWork::Coadjoint(Coadjoint.work(group)),
            MatrixAction::Lagrangian => MatrixWork::Lagrangian(Lagrangian.work(group)),
        }
    }
    fn check(&self, group: &MatrixGroup, p: &Mat<f64>) -> Result<(), Error> {
        match self {
            MatrixAction::Linear | MatrixAction::Translation | MatrixAction::RightTranslation => {
                Linear.check(group, p)
            }
            MatrixAction::Conjugation => Conjugation.check(group, p),
            MatrixAction::Coadjoint => Coadjoint.check(group, p),
            MatrixAction::Lagrangian => Lagrangian.check(group, p),
        }
    }
    fn check_member(&self, group: &MatrixGroup, p: &Mat<f64>) -> Result<(), Error> {
        match self {
            MatrixAction::Translation | MatrixAction::RightTranslation => {
                group.check_member(&GroupMatrix::new_unchecked(p.clone()))
            }
            MatrixAction::Lagrangian => Lagrangian.check_member(group, p),
            _ => Ok(()),
        }
    }
    fn is_finite(&self, group: &MatrixGroup, p: &Mat<f64>) -> bool {
        self.check(group, p).is_ok()
    }
    fn act(
        &self,
        group: &MatrixGroup,
        g: &GroupMatrix,
        p: &Mat<f64>,
        q: &mut Mat<f64>,
        work: &mut MatrixWork,
    ) {
        match work {
            MatrixWork::Linear | MatrixWork::Translation(_) => group.apply(g, p, q),
            MatrixWork::RightTranslation(inverse, inverting, _) => {
                // A singular g is not in G; its numbers are not finite, and the step ends with that.
                let _ = group.invert(g, inverting, inverse);
                multiply_into(q, p.as_ref(), inverse.as_ref());
            }
            MatrixWork::Conjugation(work) => Conjugation.act(group, g, p, q, work),
            MatrixWork::Coadjoint(work) => Coadjoint.act(group, g, p, q, work),
            MatrixWork::Lagrangian(work) => Lagrangian.act(group, g, p, q, work),
        }
    }
    fn generate(
        &self,
        group: &MatrixGroup,
        v: &AlgebraMatrix,
        p: &Mat<f64>,
        dp: &mut Mat<f64>,
        work: &mut MatrixWork,
    ) {
        match work {
            MatrixWork::Linear | MatrixWork::Translation(_) => group.apply_algebra(v, p, dp),
            MatrixWork::RightTranslation(..) => {
                multiply_into(dp, p.as_ref(), v.as_ref());
                reverse(dp);
            }
            MatrixWork::Conjugation(work) => Conjugation.generate(group, v, p, dp, work),
            MatrixWork::Coadjoint(work) => Coadjoint.generate(group, v, p, dp, work),
            MatrixWork::Lagrangian(work) => Lagrangian.generate(group, v, p, dp, work),
        }
    }
    fn error_ratio(
        &self,
        group: &MatrixGroup,
        e: &AlgebraMatrix,
        p: &Mat<f64>,
        scales: &mut Scales<'_>,
    ) -> f64 {
        match self {
            MatrixAction::Lagrangian => Lagrangian.error_ratio(group, e, p, scales),
            // All others have a relative error of p.
            _ => Conjugation.error_ratio(group, e, p, scales),
        }
    }
    fn error_ratio_of_step(
        &self,
        group: &MatrixGroup,
        e: &AlgebraMatrix,
        ends: [&Mat<f64>; 2],
        scales: &mut Scales<'_>,
    ) -> f64 {
        match self {
            MatrixAction::Lagrangian => Lagrangian.error_ratio_of_step(group, e, ends, scales),
            _ => Conjugation.error_ratio_of_step(group, e, ends, scales),
        }
    }
    fn lambda<Psi: CoordinateMap<MatrixGroup>>(
        &self,
        psi_u: PsiOf<'_, MatrixGroup, Psi>,
        p: &Mat<f64>,
        q: &mut Mat<f64>,
        work: &mut MatrixWork,
    ) -> Result<(), StepError> {
        match work {
            MatrixWork::Linear => psi_u.on(p, q),
            MatrixWork::Lagrangian(work) => Lagrangian.lambda(psi_u, p, q, work),
            work => {
                let (group, g) = psi_u.form()?;
                self.act(group, g, p, q, work);
                Ok(())
            }
        }
    }
    fn residual_size(&self, group: &MatrixGroup, p: &Mat<f64>) -> f64 {
        match self {
            MatrixAction::Translation | MatrixAction::RightTranslation => group.residual_size_of(p),
            _ => 1.0,
        }
    }
    fn restore(&self, group: &MatrixGroup, p: &mut Mat<f64>, work: &mut MatrixWork) -> Option<f64> {
        let (MatrixWork::Translation(scratch) | MatrixWork::RightTranslation(.., scratch)) = work
        else {
            return None;
        };
        let mut g = GroupMatrix::new_unchecked(core::mem::replace(p, Mat::new()));
        let residual = group.correct(&mut g, scratch.each_mut());
        *p = g.into_mat();
        Some(residual)
    }
    fn restore_to(
        &self,
        group: &MatrixGroup,
        from: &Mat<f64>,
        p: &mut Mat<f64>,
        work: &mut MatrixWork,
    ) -> Option<f64> {
        match work {
            MatrixWork::Conjugation(work) => Conjugation.restore_to(group, from, p, work),
            MatrixWork::Coadjoint(work) => Coadjoint.restore_to(group, from, p, work),
            MatrixWork::Linear => Linear.restore_to(group, from, p, &mut ()),
            work => self.restore(group, p, work),
        }
    }
}
