//! The form of 𝔤_M for the exact functions of ad_u.

use faer::{Mat, Scale};

use super::sample::{Symmetry, symmetry};
use super::{Form, MatrixGroup};
use crate::dense::{AdForm, AdKind, Lu, norm_frobenius};

/// The symmetric or skew part of M replaces M only if its reciprocal condition number is at least this.
const PART_RCOND: f64 = 1e-6;

impl MatrixGroup {
    /// A symmetric or skew form that 𝔤 conserves; none on GL(n).
    ///
    /// uᵀM + Mu = 0 holds for the symmetric and for the skew part of M. So one of the parts is used if M is neither.
    pub(crate) fn ad_form(&self) -> Option<AdForm> {
        let n = self.n();
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
                None => {
                    let parts = [
                        (AdKind::Skew, (&m + m.transpose()) * Scale(0.5)),
                        (AdKind::Symmetric, (&m - m.transpose()) * Scale(0.5)),
                    ];
                    parts.into_iter().find_map(|(kind, m)| {
                        if Lu::rcond(m.as_ref()) < PART_RCOND {
                            return None;
                        }
                        let mut lu = Lu::new(n);
                        lu.a.copy_from(&m);
                        lu.factor();
                        let mut inverse = Mat::identity(n, n);
                        lu.solve(inverse.as_mut());
                        Some(AdForm { kind, m, inverse })
                    })
                }
            },
        }
    }

    /// True if every u ∈ 𝔤 is skew-symmetric, as on SO(n) and on U(m) = G_{𝟙+J}. This is so if the symmetric part of M is
    /// exactly a multiple of 𝟙.
    pub(crate) fn is_skew(&self) -> bool {
        match &self.form {
            Form::Free | Form::Symplectic => false,
            Form::Identity => true,
            Form::Bilinear { m, .. } => has_scalar_part(m),
        }
    }
}

/// True if the symmetric part of M is exactly a multiple of 𝟙.
pub(super) fn has_scalar_part(m: &Mat<f64>) -> bool {
    let (n, part) = (m.nrows(), (m + m.transpose()) * Scale(0.5));
    let c = part[(0, 0)];
    c != 0.0 && norm_frobenius(&(part - Mat::<f64>::identity(n, n) * Scale(c))) == 0.0
}
