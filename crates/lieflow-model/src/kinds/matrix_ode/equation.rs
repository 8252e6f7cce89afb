//! The equation: its field at a point, what it keeps, and the problem that it is.

use std::sync::Arc;

use faer::Mat;
use lieflow::Error;
use lieflow::actions::Action;
use lieflow::groups::{AlgebraMatrix, LieAlgebra, LieGroup, MatrixGroup};
use lieflow::maps::{CoordinateMap, Exp};
use lieflow::problems::{Flow, Problem};

use super::{ACTIONS, KIND, NAMED_MAX};
use crate::kinds::algebra::{Algebra, outside};
use crate::kinds::flow::OnMatrices;
use crate::kinds::matrix::MatrixAction;
use crate::kinds::old_system::System;
use crate::kinds::{Figure, Kind, Law, QuantityInfo, Scale};
use crate::model::Layer;
use crate::scene::Refusal;
use crate::scene::formula::Formula;

/// The equation with its initial point.
#[derive(Clone, Debug)]
pub(super) struct Equation {
    pub(super) algebra: Algebra,
    pub(super) group: MatrixGroup,
    pub(super) action: MatrixAction,
    /// f, row by row.
    pub(super) field: Arc<[Formula]>,
    /// Is f a function of t alone?
    pub(super) linear: bool,
    pub(super) start: Mat<f64>,
}

/// What f may have outside of the algebra at the points where it is looked at, relative to its size.
const IN_THE_ALGEBRA: f64 = 1e-8;

impl Equation {
    /// f(t, y) as it is stated.
    fn stated(&self, t: f64, y: &Mat<f64>, v: &mut Mat<f64>) {
        let (rows, k) = (y.nrows(), y.ncols());
        let mut values = [0.0; 1 + NAMED_MAX * NAMED_MAX];
        values[0] = t;
        for (i, j) in (0..rows).flat_map(|i| (0..k).map(move |j| (i, j))) {
            values[1 + i * k + j] = y[(i, j)];
        }
        let n = self.group.n();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            v[(i, j)] = self.field[i * n + j].value(&values);
        }
    }
    /// Its part in 𝔤.
    fn projected(&self, t: f64, y: &Mat<f64>, v: &mut Mat<f64>) {
        self.stated(t, y, v);
        self.algebra.project(v);
    }
    /// A point of M beside the start: exp of an element of 𝔤 that is nothing special, applied to it.
    fn beside_the_start(&self) -> Option<Mat<f64>> {
        let n = self.group.n();
        let mut v = self.group.zero();
        v.copy_from(Mat::from_fn(n, n, |i, j| 0.3 * ((1 + 3 * i + 5 * j) as f64).sin()));
        self.algebra.project(&mut v);
        let (mut g, mut at) = (self.group.identity(), Exp.at(&self.group).ok()?);
        Exp.psi(&self.group, &v, &mut at, &mut g).ok()?;
        let (mut moved, mut work) = (self.start.clone(), self.action.work(&self.group));
        self.action.act(&self.group, &g, &self.start, &mut moved, &mut work);
        Some(moved)
    }
    /// yᵀMy, where the group has an M.
    fn form(&self, y: &Mat<f64>) -> Option<Mat<f64>> {
        Some(y.transpose() * self.group.m()? * y)
    }
    fn keeps_a_form(&self) -> bool {
        !matches!(self.algebra, Algebra::Gl | Algebra::Sl)
    }
    /// The invariant that is reported.
    fn kept(&self) -> Option<&'static str> {
        match self.action {
            MatrixAction::Conjugation | MatrixAction::Coadjoint => Some("traces"),
            // Each Lagrangian subspace can be moved to each.
            MatrixAction::Lagrangian => None,
            _ if !self.keeps_a_form() => None,
            MatrixAction::Translation => Some("group_defect"),
            _ => Some("form"),
        }
    }
}

impl Problem for Equation {
    type Group = MatrixGroup;
    type Action = MatrixAction;
    type Work = ();

    fn group(&self) -> &MatrixGroup {
        &self.group
    }
    fn action(&self) -> &MatrixAction {
        &self.action
    }
    fn work(&self) {}
    fn f(&self, t: f64, y: &Mat<f64>, v: &mut AlgebraMatrix, _: &mut ()) {
        self.projected(t, y, v);
    }
}

impl System for Equation {
    type Problem = OnMatrices;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        let (action, start) = (self.action, self.start.clone());
        if !self.linear {
            return Ok((OnMatrices::new(self.clone(), action), start));
        }
        let (this, like) = (self.clone(), start.clone());
        let a = move |t: f64, v: &mut AlgebraMatrix| this.projected(t, &like, v);
        Ok((OnMatrices::linear(Flow::of_time(self.group.clone(), action, a), action), start))
    }
    fn check_start(&self, t0: f64) -> Result<(), Refusal> {
        let n = self.group.n();
        let mut f = Mat::zeros(n, n);
        let beside = self.beside_the_start();
        let first = (t0, &self.start, "at the start");
        // Another time too: a field that leaves the algebra is found unless it has no value there.
        let second = beside.iter().map(|y| (t0 + 0.5, y, "beside the start"));
        for (t, y, place) in [first].into_iter().chain(second) {
            self.stated(t, y, &mut f);
            let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            let infinite = entries.map(|at| (at, f[at])).find(|(_, x)| !x.is_finite());
            let (i, j, why) = match (infinite, outside(self.algebra, &f, IN_THE_ALGEBRA)) {
                (Some(((i, j), x)), _) if t == t0 => {
                    (i, j, format!("is {x} {place}, expected a number"))
                }
                (None, Some((i, j))) => {
                    let algebra = self.algebra.name(n);
                    (i, j, format!("is {} {place}: the field is not in {algebra}", f[(i, j)]))
                }
                _ => continue,
            };
            let key = format!("field[{i},{j}]");
            return Err(Refusal::at(key.clone(), format!("{key} {why}")));
        }
        Ok(())
    }
    fn modelled(&self) -> String {
        let (rows, columns) = (self.start.nrows(), self.start.ncols());
        let action = ACTIONS.iter().find(|(_, action)| *action == self.action);
        let name = action.map_or("", |(name, _)| name);
        format!("{rows}×{columns} matrix, {} by {name}", self.group.name())
    }
    fn state(&self) -> &'static [&'static str] {
        &["point"]
    }
    fn laws(&self) -> Vec<Law> {
        let degree = |kept| if kept == "traces" { 0 } else { 2 };
        let law = |kept| Law::of_the_action(kept, degree(kept)).on_scale(Scale::Terms);
        self.kept().map(law).into_iter().collect()
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let (n, k) = (self.start.nrows(), self.start.ncols());
        match quantity.name {
            "point" => (1..=n).flat_map(|i| (1..=k).map(move |j| format!("y{i}{j}"))).collect(),
            "column" => (1..=n).map(|i| format!("y{i}1")).collect(),
            name if self.kept() != Some(name) => Vec::new(),
            "form" => (1..=k).flat_map(|i| (i..=k).map(move |j| format!("f{i}{j}"))).collect(),
            "traces" => (1..=n).map(|k| format!("tr{k}")).collect(),
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, _: f64, y: &Mat<f64>, row: &mut Vec<f64>) {
        let (n, k) = (y.nrows(), y.ncols());
        match quantity {
            "point" => row.extend((0..n).flat_map(|i| (0..k).map(move |j| y[(i, j)]))),
            "column" => row.extend((0..n).map(|i| y[(i, 0)])),
            name if self.kept() != Some(name) => {}
            "traces" => {
                let mut power = Mat::<f64>::identity(n, n);
                for _ in 0..n {
                    power = &power * y;
                    row.push((0..n).map(|i| power[(i, i)]).sum());
                }
            }
            "form" => {
                let form = self.form(y).unwrap_or_else(|| Mat::full(k, k, f64::NAN));
                row.extend((0..k).flat_map(|i| (i..k).map(move |j| (i, j))).map(|at| form[at]));
            }
            _ => {
                let away = self.form(y).zip(self.group.m()).map(|(form, m)| (form - m).norm_l2());
                row.push(away.unwrap_or(f64::NAN));
            }
        }
    }
    /// |y|ⁿ, or |y|²: a bound of all that is summed.
    fn size(&self, quantity: &str, y: &Mat<f64>) -> f64 {
        let size = y.norm_l2();
        match quantity {
            "traces" => size.max(1.0).powi(y.nrows() as i32),
            _ => size * size,
        }
    }
    fn figure(&self) -> Figure {
        match self.action {
            MatrixAction::Translation => Figure::Lines("column"),
            _ => Figure::Lines("point"),
        }
    }
}
