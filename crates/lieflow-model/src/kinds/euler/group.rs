//! The same equations with the motion of g: (ġ, ṁ) = (g ∇H, ad*_{∇H} m); see
//! [`EulerGroup`](lieflow::problems::EulerGroup). The momentum in space, Ad*_{g⁻¹} m, is kept by the action.

use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;
use lieflow::Error;
use lieflow::actions::{Action, Coadjoint};
use lieflow::groups::{GroupMatrix, LieAlgebra, MatrixGroup};
use lieflow::problems::{DynFlow, FromTheBody};

use super::KIND;
use super::matrices::{EulerEquation, by_rows, names};
use crate::kinds::old_system::System;
use crate::kinds::{Figure, Kind, Law, QuantityInfo, Scale};
use crate::model::Layer;

/// The equation with g.
#[derive(Clone, Debug)]
pub(super) struct WithGroup(pub(super) EulerEquation);

type Point = (GroupMatrix, Mat<f64>);

impl WithGroup {
    fn in_space(&self, (g, m): &Point) -> Mat<f64> {
        let (group, mut out) = (&self.0.group, m.clone());
        let mut work = Action::<MatrixGroup>::work(&Coadjoint, group);
        Coadjoint.act(group, g, m, &mut out, &mut work);
        out
    }
}

impl System for WithGroup {
    type Problem = DynFlow<MatrixGroup, FromTheBody>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Point), Error> {
        Ok(self.0.flow_with_group())
    }
    fn modelled(&self) -> String {
        format!("{} and g in {}", System::modelled(&self.0), self.0.group.name())
    }
    fn state(&self) -> &'static [&'static str] {
        &["momentum", "group"]
    }
    fn laws(&self) -> Vec<Law> {
        let mut laws = System::laws(&self.0);
        laws.push(Law::of_the_action("momentum_space", 0).on_scale(Scale::Terms));
        laws
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let n = self.0.momentum.nrows();
        match quantity.name {
            "group" => names("g", n),
            "momentum_space" => names("s", n),
            _ => System::columns(&self.0, quantity),
        }
    }
    fn show(&self, quantity: &str, t: f64, y: &Point, row: &mut Vec<f64>) {
        match quantity {
            "group" => by_rows(&y.0, row),
            "momentum_space" => by_rows(&self.in_space(y), row),
            _ => System::show(&self.0, quantity, t, &y.1, row),
        }
    }
    /// |g| |g⁻¹| |m| of the momentum in space.
    fn size(&self, quantity: &str, (g, m): &Point) -> f64 {
        match quantity {
            "momentum_space" => g.norm_l2() * g.partial_piv_lu().inverse().norm_l2() * m.norm_l2(),
            _ => System::size(&self.0, quantity, m),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Lines("momentum")
    }
}
