//! Euler's equations on matrices with the motion of g: (ġ, ṁ) = (g ∇H, ad*_{∇H} m); see
//! [`EulerGroup`](lieflow::problems::EulerGroup). The action keeps the momentum in space, Ad*_{g⁻¹} m.

use lieflow::actions::{Action, Coadjoint};
use lieflow::dense::{inverse, norm};
use lieflow::groups::{GroupMatrix, LieAlgebra, LieGroup, MatrixGroup};
use lieflow::problems::{Euler, FromTheBody};
use lieflow_runs::spaces::FromBody;

use super::dual::{OnDual, quantities};
use super::matrices::EulerEquation;
use crate::kinds::prelude::*;
use crate::problem::row_columns;

/// The equation with g, from g = 𝟙.
#[derive(Clone, Debug)]
pub(super) struct WithGroup(pub(super) EulerEquation);

/// (g, m).
type Point = (GroupMatrix, Mat<f64>);

impl OnDual for WithGroup {
    type Dual = EulerEquation;
    const WITHOUT_G: Option<&'static str> = None;

    fn dual(&self) -> &EulerEquation {
        &self.0
    }
    fn momentum((_, m): &Point) -> &Mat<f64> {
        m
    }
    fn group_columns(&self) -> [Vec<String>; 2] {
        let n = self.0.momentum.nrows();
        ["g", "s"].map(|letter| row_columns(letter, n, n))
    }
    fn group((g, _): &Point) -> Option<&GroupMatrix> {
        Some(g)
    }
    fn in_space(&self, (g, m): &Point) -> Option<Mat<f64>> {
        let (group, mut out) = (&self.0.group, m.clone());
        let mut work = Action::<MatrixGroup>::work(&Coadjoint, group);
        Coadjoint.act(group, g, m, &mut out, &mut work);
        Some(out)
    }
    /// |g| |g⁻¹| |m|.
    fn in_space_terms((g, m): &Point) -> f64 {
        norm(g.as_ref()) * norm(inverse(g.as_ref()).as_ref()) * norm(m.as_ref())
    }
}

impl System for WithGroup {
    type Problem = FromBody;

    const STATE: &'static [&'static str] = &["momentum", "group"];
    const QUANTITIES: &'static [Quantity<Self>] = &quantities();

    fn problem(&self) -> Result<Start<FromBody>, Error> {
        let EulerEquation { group, energy, momentum } = &self.0;
        let system = Euler::new(group.clone(), energy.clone()).with_group();
        Ok((FromBody::new(system, FromTheBody), (group.identity(), momentum.clone())))
    }
    fn check_state(&self, _: &str, (_, m): &Point) -> Result<(), Error> {
        self.0.check_momentum(m)
    }
    fn modelled(&self) -> String {
        format!("{} and g in {}", self.0.modelled(), self.0.group.name())
    }
}
