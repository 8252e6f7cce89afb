//! Where a step went wrong.

use crate::error::StepError;
use crate::groups::LieAlgebra;

/// The same error, or the stage whose f was not finite: that is where it came from. The stages are
/// cleared, so that the next attempt does not see the numbers of this one.
#[cold]
pub(super) fn blame<G: LieAlgebra>(alg: &G, stages: &mut [G::Alg], error: StepError) -> StepError {
    let stage = stages.iter().position(|k| !alg.is_finite(k));
    stages.iter_mut().for_each(|k| alg.set_zero(k));
    stage.map_or(error, |stage| StepError::NonFiniteRhs { stage: stage + 1 })
}
