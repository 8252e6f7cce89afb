//! `kind = "riccati"`: Ṗ = C + DP + PDᵀ − PBP for symmetric P, through the action of Sp(2m) on Lagrangian
//! subspaces: a step may pass a pole of P.
//!
//! f = \[−Dᵀ B; C D\] ∈ sp(2m); Λ(g, P) = (C′ + D′P)(A′ + B′P)⁻¹ for g = \[A′ B′; C′ D′\].

use faer::{Mat, Side};
use lieflow::Error;
use lieflow::groups::{AlgebraMatrix, MatrixGroup};
use lieflow::problems::Flow;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::matrix::MatrixAction;
use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo};
use crate::kinds::flow::OnMatrices;
use crate::model::Layer;
use crate::scene::values::Table;
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "riccati",
    equation: "Ṗ = C + DP + PDᵀ − PBP",
    summary: "the matrix Riccati equation P' = C + DP + PD' − PBP, on Lagrangian subspaces",
    keys: &[
        KeyInfo { name: "c", meaning: "C, symmetric" },
        KeyInfo { name: "d", meaning: "D; optional, 0" },
        KeyInfo { name: "b", meaning: "B, symmetric" },
        KeyInfo { name: "p", meaning: "the initial P, symmetric" },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "p",
                columns: &["p11", "…", "pmm"],
                meaning: "the entries of P on and above the diagonal, row by row",
            },
            QuantityInfo {
                name: "angles",
                columns: &["angle1", "…", "anglem"],
                meaning: "arctan of the eigenvalues of P in ascending order: they jump at a pole",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    c: Table,
    d: Option<Table>,
    b: Table,
    p: Table,
}

/// The coefficients and P(t₀).
#[derive(Clone, Debug)]
struct Riccati {
    c: Mat<f64>,
    d: Mat<f64>,
    b: Mat<f64>,
    p: Mat<f64>,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let p = keys.p.matrix("p", None)?;
    let m = p.nrows();
    let (c, b) = (keys.c.matrix("c", Some(m))?, keys.b.matrix("b", Some(m))?);
    let d = keys.d.map_or(Ok(Mat::zeros(m, m)), |d| d.matrix("d", Some(m)))?;
    for (key, x) in [("c", &c), ("d", &d), ("b", &b), ("p", &p)] {
        if x.nrows() != m {
            let message = format!("found {} rows, expected {m} as p has them", x.nrows());
            return Err(Refusal::at(key, message).into());
        }
        let mut below = (0..m).flat_map(|i| (0..i).map(move |j| (i, j)));
        if let Some((i, j)) = below.find(|&(i, j)| key != "d" && x[(i, j)] != x[(j, i)]) {
            let message = format!(
                "{} stands across from {}, expected a symmetric matrix",
                x[(i, j)],
                x[(j, i)]
            );
            return Err(Refusal::at(format!("{key}[{i},{j}]"), message).into());
        }
    }
    Ok(Box::new(Riccati { c, d, b, p }))
}

impl System for Riccati {
    type Problem = OnMatrices;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        let (m, of_run) = (self.p.nrows(), self.clone());
        let field = move |_: f64, v: &mut AlgebraMatrix| {
            let Riccati { c, d, b, .. } = &of_run;
            for j in 0..m {
                for i in 0..m {
                    (v[(i, j)], v[(i, j + m)]) = (-d[(j, i)], b[(i, j)]);
                    (v[(i + m, j)], v[(i + m, j + m)]) = (c[(i, j)], d[(i, j)]);
                }
            }
        };
        let (group, action) = (MatrixGroup::sp(2 * m)?, MatrixAction::Lagrangian);
        Ok((OnMatrices::linear(Flow::of_time(group, action, field), action), self.p.clone()))
    }
    fn modelled(&self) -> String {
        format!("symmetric {0}×{0} matrix, a Lagrangian subspace of dimension {0}", self.p.nrows())
    }
    fn state(&self) -> &'static [&'static str] {
        &["p"]
    }
    /// A Lagrangian subspace has none: each can be moved to each.
    fn laws(&self) -> Vec<Law> {
        Vec::new()
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let m = self.p.nrows();
        let entry = |(i, j): (usize, usize)| format!("p{}{}", i + 1, j + 1);
        match quantity.name {
            "p" => (0..m).flat_map(|i| (i..m).map(move |j| (i, j))).map(entry).collect(),
            _ => (1..=m).map(|i| format!("angle{i}")).collect(),
        }
    }
    fn show(&self, quantity: &str, _: f64, p: &Mat<f64>, row: &mut Vec<f64>) {
        let m = p.nrows();
        match quantity {
            "p" => row.extend((0..m).flat_map(|i| (i..m).map(move |j| p[(i, j)]))),
            _ => {
                let eigenvalues = p.self_adjoint_eigenvalues(Side::Lower);
                let eigenvalues = eigenvalues.unwrap_or_else(|_| vec![f64::NAN; m]);
                row.extend(eigenvalues.iter().map(|x| x.atan()));
            }
        }
    }
    fn figure(&self) -> Figure {
        Figure::Lines("angles")
    }
}
