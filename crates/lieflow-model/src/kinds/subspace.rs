//! `kind = "subspace"`: the flow of k-dimensional subspaces of ℝⁿ to the leading invariant subspace of a
//! symmetric matrix, on the Grassmann manifold of projectors; see [`SubspaceFlow`].
//!
//! The span of X moves as that of e^{tA}X. With V₁ the leading eigenvectors and V₂ the others, it is the
//! span of V₁ + V₂Z for Z = (V₂ᵀPV₁)(V₁ᵀPV₁)⁻¹, and the sines of its principal angles to that of V₁ are the
//! singular values of V₂ᵀP.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, MatRef, Side};
use lieflow::Error;
use lieflow::problems::SubspaceFlow;
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
    name: "subspace",
    equation: "Ṗ = [[A, P], P] for the projector P on the subspace",
    summary: "the flow of subspaces to the leading invariant subspace of a symmetric matrix",
    keys: &[
        KeyInfo { name: "a", meaning: "the symmetric matrix A" },
        KeyInfo { name: "x", meaning: "an n×k matrix; its columns span the initial subspace" },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "projector",
                columns: &["p11", "…", "pnn"],
                meaning: "the entries of the projector P on and above the diagonal, row by row",
            },
            QuantityInfo {
                name: "angles",
                columns: &["angle1", "…", "anglek"],
                meaning: "principal angles to the span of the k leading eigenvectors, the largest first",
            },
            QuantityInfo {
                name: "trace",
                columns: &["trace"],
                meaning: "trace of AP, which grows to the sum of the k leading eigenvalues",
            },
            QuantityInfo {
                name: "dimension",
                columns: &["dimension"],
                meaning: "trace of P, the dimension of the subspace",
            },
            QuantityInfo {
                name: "projector_defect",
                columns: &["projector_defect"],
                meaning: "distance of P² from P",
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

/// The flow with P(t₀).
#[derive(Clone, Debug)]
struct Subspace {
    flow: SubspaceFlow,
    dimension: usize,
    start: Mat<f64>,
    /// Eigenvalues of A in ascending order, and its eigenvectors.
    eigenvalues: Vec<f64>,
    eigenvectors: Mat<f64>,
    /// Z, where no angle is a right one.
    graph: Option<Mat<f64>>,
}

/// Below this cos² of an angle to the leading subspace nothing is left of Z.
const RIGHT: f64 = 1e-10;

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let (a, x) = (keys.a.matrix("a", None)?, keys.x.columns("x")?);
    if x.nrows() != a.nrows() {
        let message = format!("found {} rows, expected {} as a has them", x.nrows(), a.nrows());
        return Err(Refusal::at("x", message).into());
    }
    let wrong = |key: &'static str, name: &'static str| {
        move |error: Error| Refusal::at(key, error.to_string().replace(name, key))
    };
    let flow = SubspaceFlow::new(a.clone()).map_err(wrong("a", "A"))?;
    let start = flow.span(&x).map_err(wrong("x", "X"))?;
    let eigen = a.self_adjoint_eigen(Side::Lower);
    let eigen = eigen.map_err(|_| Refusal::at("a", "its eigenvalues cannot be found"))?;
    let mut subspace = Subspace {
        flow,
        dimension: x.ncols(),
        start,
        eigenvalues: eigen.S().column_vector().iter().copied().collect(),
        eigenvectors: eigen.U().to_owned(),
        graph: None,
    };
    subspace.graph = subspace.graph_at(&subspace.start);
    Ok(Box::new(subspace))
}

impl Subspace {
    /// V₂ and V₁.
    fn parts(&self) -> [MatRef<'_, f64>; 2] {
        let (v2, v1) = self.eigenvectors.split_at_col(self.start.nrows() - self.dimension);
        [v2, v1]
    }
    /// Z.
    fn graph_at(&self, p: &Mat<f64>) -> Option<Mat<f64>> {
        let [v2, v1] = self.parts();
        let cosines2 = v1.transpose() * p * v1;
        let least = cosines2.self_adjoint_eigenvalues(Side::Lower).ok()?.into_iter().next()?;
        (least > RIGHT).then(|| v2.transpose() * p * v1 * cosines2.partial_piv_lu().inverse())
    }
    fn angles(&self, p: &Mat<f64>) -> Vec<f64> {
        let v2 = self.parts()[0];
        let sines = (v2.transpose() * p).singular_values();
        let sines = sines.unwrap_or_else(|_| vec![f64::NAN; v2.ncols()]);
        let angles = sines.iter().map(|sine| sine.min(1.0).asin());
        // What a subspace shares with the leading one, it shares at the angle 0.
        angles.chain(core::iter::repeat(0.0)).take(self.dimension).collect()
    }
}

/// The places on and above the diagonal, row by row.
fn above(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |i| (i..n).map(move |j| (i, j)))
}

impl System for Subspace {
    type Problem = OnMatrices;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        Ok((OnMatrices::new(self.flow.clone(), MatrixAction::Conjugation), self.start.clone()))
    }
    fn modelled(&self) -> String {
        let n = self.start.nrows();
        format!("projector onto {} of {n} dimensions, conjugated by SO({n})", self.dimension)
    }
    fn state(&self) -> &'static [&'static str] {
        &["projector"]
    }
    fn laws(&self) -> Vec<Law> {
        vec![
            Law::of_the_action("projector_defect", 0).on_scale(Scale::One),
            Law::of_the_action("dimension", 0),
        ]
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        match quantity.name {
            "projector" => {
                above(self.start.nrows()).map(|(i, j)| format!("p{}{}", i + 1, j + 1)).collect()
            }
            "angles" => (1..=self.dimension).map(|k| format!("angle{k}")).collect(),
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, _: f64, p: &Mat<f64>, row: &mut Vec<f64>) {
        match quantity {
            "projector" => row.extend(above(p.nrows()).map(|place| p[place])),
            "angles" => row.extend(self.angles(p)),
            "trace" => row.push(self.flow.trace(p)),
            "dimension" => row.push((0..p.nrows()).map(|i| p[(i, i)]).sum()),
            _ => row.push((p * p - p).norm_l2()),
        }
    }
    /// Z(t)_ij = e^{t(λ_i − λ_j)} Z_ij, which falls where the columns of e^{tA}X become one.
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<Mat<f64>, Error>> {
        let mut z = self.graph.clone()?;
        let (others, leading) = self.eigenvalues.split_at(z.nrows());
        for (j, of_column) in leading.iter().enumerate() {
            for (i, of_row) in others.iter().enumerate() {
                z[(i, j)] *= ((t1 - t0) * (of_row - of_column)).exp();
            }
        }
        let [v2, v1] = self.parts();
        Some(self.flow.span(&(v1 + v2 * z)))
    }
    fn figure(&self) -> Figure {
        Figure::Lines("angles")
    }
    fn facts(&self) -> Vec<Fact> {
        let others = self.start.nrows() - self.dimension;
        let leading = self.eigenvalues[others..].iter().sum();
        let mut facts = vec![Fact { name: "sum_of_the_leading_eigenvalues", value: leading }];
        if others > 0 {
            let gap = self.eigenvalues[others] - self.eigenvalues[others - 1];
            facts.push(Fact { name: "rate_of_convergence", value: gap });
        }
        facts
    }
}
