//! The form of 𝔤_M for the exact functions of ad_u.

use super::parts::{Symmetry, has_scalar_part, inverse_of, part, symmetry};
use super::{Form, MatrixGroup};
use faer::Mat;

use crate::dense::{AdForm, AdKind, AdSchur, NearlySingular, norm1};
use crate::error::StepError;

/// A part S of M replaces M only if 1/(‖M‖₁‖S⁻¹‖₁) is at least this. This number is small for a part that is nearly
/// singular, and for one that is small beside M.
const PART_REGULAR: f64 = 1e-6;

impl MatrixGroup {
    /// A symmetric or skew form that 𝔤 conserves; none on GL(n).
    ///
    /// uᵀM + Mu = 0 holds for the symmetric and for the skew part of M. So one of the parts is used if M is neither: the one
    /// whose inverse is smaller. Without a regular part there is no form.
    pub(crate) fn ad_form(&self) -> Option<AdForm> {
        let m = self.m()?;
        match &self.form {
            Form::Free => None,
            Form::Identity => Some(AdForm { kind: AdKind::Skew, inverse: m.clone(), m }),
            Form::Symplectic => {
                Some(AdForm { kind: AdKind::Symmetric, inverse: m.transpose().to_owned(), m })
            }
            Form::Bilinear { inverse, .. } => match symmetry(&m) {
                Some(Symmetry::Symmetric) => {
                    Some(AdForm { kind: AdKind::Skew, inverse: inverse.clone(), m })
                }
                Some(Symmetry::Skew) => {
                    Some(AdForm { kind: AdKind::Symmetric, inverse: inverse.clone(), m })
                }
                None => [(AdKind::Skew, Symmetry::Symmetric), (AdKind::Symmetric, Symmetry::Skew)]
                    .into_iter()
                    .map(|(kind, symmetry)| {
                        let m = part(&m, symmetry);
                        let inverse = inverse_of(&m);
                        AdForm { kind, m, inverse }
                    })
                    .map(|form| (1.0 / (norm1(m.as_ref()) * norm1(form.inverse.as_ref())), form))
                    // Not for NaN: the inverse of a singular part.
                    .filter(|(regular, _)| *regular >= PART_REGULAR)
                    .reduce(|best, next| if next.0 > best.0 { next } else { best })
                    .map(|(_, form)| form),
            },
        }
    }

    /// The form by which functions of ad_u are computed. None where M is stretched: products with M and M⁻¹ would lose digits,
    /// and 𝔤 is a part of 𝔤𝔩(n).
    pub(crate) fn ad_coordinates(&self) -> Option<AdForm> {
        if self.is_stretched() { None } else { self.ad_form() }
    }

    /// A function of ad_u, which `apply` computes in these coordinates or says to be singular. With a stretched M they are those
    /// of 𝔤𝔩(n), where more u are singular: there the form decides. `apply` leaves its result as it is where it fails.
    pub(crate) fn function_of_ad(
        &self,
        schur: &mut AdSchur,
        u: &Mat<f64>,
        mut apply: impl FnMut(&mut AdSchur) -> Result<(), NearlySingular>,
    ) -> Result<Result<(), NearlySingular>, StepError> {
        schur.factor(u)?;
        let found = apply(schur);
        if found.is_ok() || !self.is_stretched() {
            return Ok(found);
        }
        let Some(form) = self.ad_form() else { return Ok(found) };
        let mut by_form = AdSchur::new(self.n(), Some(form));
        by_form.factor(u)?;
        Ok(apply(&mut by_form))
    }

    /// True if every u ∈ 𝔤 is skew-symmetric, as on SO(n) and on U(m) = G_{𝟙+J}. This is so if the symmetric part of M is
    /// exactly a multiple of 𝟙, and not small beside M.
    pub(crate) fn is_skew(&self) -> bool {
        match &self.form {
            Form::Free | Form::Symplectic => false,
            Form::Identity => true,
            Form::Bilinear { m, .. } => has_scalar_part(m),
        }
    }
}
