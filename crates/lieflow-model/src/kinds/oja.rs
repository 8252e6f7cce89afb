//! `kind = "oja"`: Oja's flow on n×k matrices with orthonormal columns, which finds the leading
//! eigenvectors of a symmetric matrix; see [`Oja`].

use faer::{Mat, Side};
use lieflow::Error;
use lieflow::problems::Oja;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::matrix::MatrixAction;
use super::old_system::System;
use super::{Fact, Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::kinds::flow::OnMatrices;
use crate::model::Layer;
use crate::scene::values::Table;
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "oja",
    equation: "Ẋ = AX − XXᵀAX",
    summary: "Oja's flow on orthonormal columns, to the leading eigenvectors of a symmetric matrix",
    keys: &[
        KeyInfo { name: "a", meaning: "the symmetric matrix A" },
        KeyInfo { name: "x", meaning: "the initial n×k matrix; its columns are made orthonormal" },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "x",
                columns: &["x11", "…", "xnk"],
                meaning: "the entries of X, row by row",
            },
            QuantityInfo {
                name: "trace",
                columns: &["trace"],
                meaning: "trace of X'AX, which grows to the sum of the leading eigenvalues",
            },
            QuantityInfo {
                name: "stiefel_defect",
                columns: &["stiefel_defect"],
                meaning: "distance of X'X from the identity",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    a: Table,
    x: Table,
}

/// The flow with X(t₀).
#[derive(Clone, Debug)]
struct OjaFlow {
    flow: Oja,
    a: Mat<f64>,
    x: Mat<f64>,
}

/// Columns that depend on each other up to this part of their length span no k-dimensional space.
const DEPENDENT: f64 = 1e-8;

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let (a, x) = (keys.a.matrix("a", None)?, keys.x.columns("x")?);
    if x.nrows() != a.nrows() {
        let message = format!("found {} rows, expected {} as a has them", x.nrows(), a.nrows());
        return Err(Refusal::at("x", message).into());
    }
    if x.ncols() > x.nrows() {
        let message = format!("{} columns of {} rows depend on each other", x.ncols(), x.nrows());
        return Err(Refusal::at("x", message).into());
    }
    let wrong = |error: Error| Refusal::at("a", error.to_string().replace('A', "a"));
    let flow = Oja::new(a.clone(), x.ncols()).map_err(wrong)?;
    let qr = x.qr();
    let r = qr.thin_R();
    let depends = |j: &usize| r[(*j, *j)].abs() <= DEPENDENT * x.col(*j).norm_l2();
    if let Some(j) = (0..x.ncols()).find(depends) {
        let message = format!("column {} depends on those before it", j + 1);
        return Err(Refusal::at("x", message).into());
    }
    let q = qr.compute_thin_Q();
    let x = Mat::from_fn(x.nrows(), x.ncols(), |i, j| q[(i, j)] * r[(j, j)].signum());
    Ok(Box::new(OjaFlow { flow, a, x }))
}

impl System for OjaFlow {
    type Problem = OnMatrices;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        Ok((OnMatrices::new(self.flow.clone(), MatrixAction::Linear), self.x.clone()))
    }
    fn modelled(&self) -> String {
        format!("{} orthonormal columns in {} dimensions", self.x.ncols(), self.x.nrows())
    }
    fn state(&self) -> &'static [&'static str] {
        &["x"]
    }
    fn laws(&self) -> Vec<Law> {
        // Off the manifold the classical form of the equation keeps it not.
        vec![Law::of_the_action("stiefel_defect", 0).on_scale(Scale::One)]
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let (n, k) = (self.x.nrows(), self.x.ncols());
        match quantity.name {
            "x" => (1..=n).flat_map(|i| (1..=k).map(move |j| format!("x{i}{j}"))).collect(),
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, _: f64, x: &Mat<f64>, row: &mut Vec<f64>) {
        match quantity {
            "x" => row.extend((0..x.nrows()).flat_map(|i| (0..x.ncols()).map(move |j| x[(i, j)]))),
            "trace" => row.push(self.flow.trace(x)),
            _ => {
                row.push((x.transpose() * x - Mat::<f64>::identity(x.ncols(), x.ncols())).norm_l2())
            }
        }
    }
    fn figure(&self) -> Figure {
        Figure::Lines("trace")
    }
    fn facts(&self) -> Vec<Fact> {
        let eigenvalues = self.a.self_adjoint_eigenvalues(Side::Lower).unwrap_or_default();
        let leading = eigenvalues.iter().rev().take(self.x.ncols()).sum();
        vec![Fact { name: "sum_of_the_leading_eigenvalues", value: leading }]
    }
}
