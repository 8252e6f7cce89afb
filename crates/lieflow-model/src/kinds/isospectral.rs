//! `kind = "toda"`, `"double-bracket"` and `"qr-flow"`: flows L̇ = \[B(L), L\] of symmetric matrices that
//! keep the eigenvalues; see [`IsospectralFlow`].

use faer::{Mat, Side};
use lieflow::Error;
use lieflow::problems::{IsospectralFlow, toda_lattice};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::matrix::MatrixAction;
use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::kinds::flow::OnMatrices;
use crate::model::Layer;
use crate::scene::values::{List, Table};
use crate::scene::{Either, ReadError, Refusal, exactly_one};

/// The entry of Toda's flow in the list of kinds.
pub(super) const TODA: Kind = Kind {
    name: "toda",
    equation: "L̇ = [L₋ᵀ − L₋, L], L₋ what is below the diagonal",
    summary: "Toda's flow of a symmetric matrix, and the lattice of particles in Flaschka's variables",
    keys: &[
        KeyInfo { name: "positions", meaning: "initial positions of the particles" },
        KeyInfo { name: "momenta", meaning: "their momenta" },
        KeyInfo { name: "matrix", meaning: "a symmetric matrix, instead of particles" },
    ],
    quantities: || QUANTITIES.to_vec(),
    read: |section| read_toda(section),
};

/// The entry of Brockett's flow in the list of kinds.
pub(super) const DOUBLE_BRACKET: Kind = Kind {
    name: "double-bracket",
    equation: "L̇ = [[N, L], L], N diagonal",
    summary: "Brockett's flow of a symmetric matrix, which diagonalises and sorts",
    keys: &[
        KeyInfo { name: "matrix", meaning: "the initial symmetric matrix" },
        KeyInfo { name: "order", meaning: "the diagonal of N: eigenvalues end sorted as it is" },
    ],
    quantities: || QUANTITIES.to_vec(),
    read: |section| read_double_bracket(section),
};

/// The entry of the QR flow in the list of kinds.
pub(super) const QR_FLOW: Kind = Kind {
    name: "qr-flow",
    equation: "L̇ = [log(L)₋ᵀ − log(L)₋, L]: L(k) is the k-th iterate",
    summary: "the flow through the iterates of the QR algorithm of a positive definite matrix",
    keys: &[KeyInfo { name: "matrix", meaning: "the initial matrix, symmetric and positive" }],
    quantities: || QUANTITIES.to_vec(),
    read: |section| read_qr(section),
};

const QUANTITIES: &[QuantityInfo] = &[
    QuantityInfo {
        name: "matrix",
        columns: &["l11", "…", "lnn"],
        meaning: "the entries on and above the diagonal, row by row",
    },
    QuantityInfo { name: "diagonal", columns: &["l11", "…", "lnn"], meaning: "the diagonal" },
    QuantityInfo {
        name: "off_diagonal",
        columns: &["off_diagonal"],
        meaning: "Frobenius norm of what is off the diagonal",
    },
    QuantityInfo {
        name: "eigenvalues",
        columns: &["e1", "…", "en"],
        meaning: "the eigenvalues in ascending order",
    },
];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TodaKeys {
    positions: Option<List>,
    momenta: Option<List>,
    matrix: Option<Table>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DoubleBracketKeys {
    matrix: Table,
    order: List,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct QrKeys {
    matrix: Table,
}

/// A flow with its initial matrix.
#[derive(Clone, Debug)]
struct Isospectral {
    kind: &'static Kind,
    flow: IsospectralFlow,
    matrix: Mat<f64>,
}

/// Asymmetry of an entry that is a rounding of how it was written, relative to the largest.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The symmetric matrix under the key `matrix`.
fn symmetric(table: &Table) -> Result<Mat<f64>, Refusal> {
    let l = table.matrix("matrix", None)?;
    let size = l.norm_max();
    for i in 0..l.nrows() {
        for j in 0..i {
            if (l[(i, j)] - l[(j, i)]).abs() > ROUNDING * size {
                let message = format!(
                    "{} stands across from {}, expected a symmetric matrix",
                    l[(i, j)],
                    l[(j, i)]
                );
                return Err(Refusal::at(format!("matrix[{i},{j}]"), message));
            }
        }
    }
    Ok(l)
}

fn read_toda(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = TodaKeys::deserialize(section)?;
    let matrix = match exactly_one(("positions", keys.positions), ("matrix", keys.matrix))? {
        Either::First(positions) => {
            let (q, p) = (positions.values(), keys.momenta.map_or(Vec::new(), |p| p.values()));
            if p.len() != q.len() {
                let message =
                    format!("found {} momenta of {} particles, expected as many", p.len(), q.len());
                return Err(Refusal::at("momenta", message).into());
            }
            let matrix = toda_lattice(&q, &p)?;
            if !matrix.norm_max().is_finite() {
                let message = "two neighbours overlap so far that their force is not finite";
                return Err(Refusal::at("positions", message).into());
            }
            matrix
        }
        Either::Second(_) if keys.momenta.is_some() => {
            return Err(Refusal::at("momenta", "a matrix has no momenta; leave momenta out").into());
        }
        Either::Second(matrix) => symmetric(&matrix)?,
    };
    let flow = IsospectralFlow::toda(matrix.nrows())?;
    Ok(Box::new(Isospectral { kind: &TODA, flow, matrix }))
}

fn read_double_bracket(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = DoubleBracketKeys::deserialize(section)?;
    let (matrix, order) = (symmetric(&keys.matrix)?, keys.order.values());
    if order.len() != matrix.nrows() {
        let message = format!("found {} numbers, expected {}", order.len(), matrix.nrows());
        return Err(Refusal::at("order", message).into());
    }
    let flow = IsospectralFlow::double_bracket(&order)?;
    Ok(Box::new(Isospectral { kind: &DOUBLE_BRACKET, flow, matrix }))
}

fn read_qr(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let matrix = symmetric(&QrKeys::deserialize(section)?.matrix)?;
    let smallest = eigenvalues(&matrix).first().copied().unwrap_or(f64::NAN);
    if smallest.is_nan() || smallest <= 0.0 {
        let message = format!("an eigenvalue is {smallest:.3e}, expected all to be > 0");
        return Err(Refusal::at("matrix", message).into());
    }
    let flow = IsospectralFlow::qr(matrix.nrows())?;
    Ok(Box::new(Isospectral { kind: &QR_FLOW, flow, matrix }))
}

/// In ascending order; not numbers where they are not found.
fn eigenvalues(l: &Mat<f64>) -> Vec<f64> {
    let found = l.self_adjoint_eigenvalues(Side::Lower);
    found.unwrap_or_else(|_| vec![f64::NAN; l.nrows()])
}

impl System for Isospectral {
    type Problem = OnMatrices;

    fn kind(&self) -> &'static Kind {
        self.kind
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        let action = MatrixAction::Conjugation;
        Ok((OnMatrices::new(self.flow.clone(), action), self.matrix.clone()))
    }
    fn modelled(&self) -> String {
        format!("symmetric {0}×{0} matrix, conjugated by SO({0})", self.matrix.nrows())
    }
    fn state(&self) -> &'static [&'static str] {
        &["matrix"]
    }
    fn laws(&self) -> Vec<Law> {
        // Rounding moves each by a part of the largest.
        vec![Law::of_the_action("eigenvalues", 0).on_scale(Scale::Terms)]
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let n = self.matrix.nrows();
        let entry = |i: usize, j: usize| format!("l{}{}", i + 1, j + 1);
        match quantity.name {
            "matrix" => (0..n).flat_map(|i| (i..n).map(move |j| entry(i, j))).collect(),
            "diagonal" => (0..n).map(|i| entry(i, i)).collect(),
            "eigenvalues" => (1..=n).map(|i| format!("e{i}")).collect(),
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, _: f64, l: &Mat<f64>, row: &mut Vec<f64>) {
        let n = l.nrows();
        match quantity {
            "matrix" => row.extend((0..n).flat_map(|i| (i..n).map(move |j| l[(i, j)]))),
            "diagonal" => row.extend((0..n).map(|i| l[(i, i)])),
            "eigenvalues" => row.extend(eigenvalues(l)),
            _ => {
                let off = |i: usize, j: usize| if i == j { 0.0 } else { l[(i, j)] };
                row.push(Mat::from_fn(n, n, off).norm_l2());
            }
        }
    }
    fn size(&self, _: &str, l: &Mat<f64>) -> f64 {
        l.norm_l2()
    }
    fn figure(&self) -> Figure {
        Figure::Lines("diagonal")
    }
}
