//! `kind = "subspace"`: the flow of k-dimensional subspaces of ℝⁿ to the leading invariant subspace of a
//! symmetric matrix, on the Grassmann manifold of projectors; see [`SubspaceFlow`].
//!
//! The span of X moves as that of e^{tA}X. With V₁ the leading eigenvectors and V₂ the others, it is the
//! span of V₁ + V₂Z for Z = (V₂ᵀPV₁)(V₁ᵀPV₁)⁻¹, and the sines of its principal angles to that of V₁ are the
//! singular values of V₂ᵀP.

use faer::MatRef;
use lieflow::dense::{
    inverse, multiply, norm, singular_values, symmetric_eigen, symmetric_eigenvalues,
};
use lieflow::problems::SubspaceFlow;

use super::entries::{ROUNDING, check_rows, numbered, symmetric, trace, upper, upper_columns};
use super::flow::OnMatrices;
use super::matrix::MatrixAction;
use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "subspace",
    equation: "Ṗ = [[A, P], P] for the projector P on the subspace",
    summary: "the flow of subspaces to the leading invariant subspace of a symmetric matrix",
    ..Kind::of::<Keys, Subspace>(|section| read_with(section, read))
};

keys! { Keys {
    a: Table = "the symmetric matrix A",
    x: Table = "an n×k matrix; its columns span the initial subspace",
} }

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

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let a = keys.a.and_then(|a| symmetric("a", &a, None, ROUNDING));
    let x = keys.x.and_then(|x| x.columns("x"));
    let (a, x) = all!(a, x)?;
    check_rows("x", &x, a.nrows())?;
    let flow = SubspaceFlow::new(a.clone())?;
    let wrong = |error: Error| Refusal::at("x", error.to_string().replace('X', "x"));
    let start = flow.span(&x).map_err(wrong)?;
    let (eigenvalues, eigenvectors) = symmetric_eigen(a.as_ref())
        .map_err(|_| Refusal::at("a", "its eigenvalues cannot be found"))?;
    let mut subspace =
        Subspace { flow, dimension: x.ncols(), start, eigenvalues, eigenvectors, graph: None };
    subspace.graph = subspace.graph_at(&subspace.start);
    Ok(Forms::of(subspace))
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
        let times_v1 =
            |v: MatRef<'_, f64>| multiply(multiply(v.transpose(), p.as_ref()).as_ref(), v1);
        let cosines2 = times_v1(v1);
        let least = symmetric_eigenvalues(cosines2.as_ref()).ok()?.into_iter().next()?;
        (least > RIGHT)
            .then(|| multiply(times_v1(v2).as_ref(), inverse(cosines2.as_ref()).as_ref()))
    }
    fn angles(&self, p: &Mat<f64>) -> Vec<f64> {
        let v2 = self.parts()[0];
        let sines = singular_values(multiply(v2.transpose(), p.as_ref()).as_ref());
        let sines = sines.unwrap_or_else(|_| vec![f64::NAN; v2.ncols()]);
        let angles = sines.iter().map(|sine| sine.min(1.0).asin());
        // What a subspace shares with the leading one, it shares at the angle 0.
        angles.chain(core::iter::repeat(0.0)).take(self.dimension).collect()
    }
}

type Q = Quantity<Subspace>;

impl System for Subspace {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["projector"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "projector",
            &["p11", "…", "pnn"],
            "the entries of the projector P on and above the diagonal, row by row",
            |_, _, p, row| row.extend(upper(p)),
        )
        .with_columns(|subspace| upper_columns("p", subspace.start.nrows())),
        Q::numbers(
            "angles",
            &["angle1", "…", "anglek"],
            "principal angles to the span of the k leading eigenvectors, the largest first",
            |subspace, _, p, row| row.extend(subspace.angles(p)),
        )
        .in_radians()
        .with_columns(|subspace| numbered("angle", subspace.dimension)),
        Q::number(
            "trace",
            "trace of AP, which grows to the sum of the k leading eigenvalues",
            |subspace, _, p| subspace.flow.trace(p),
        ),
        Q::number("dimension", "trace of P, the dimension of the subspace", |_, _, p| trace(p))
            .kept(Law::by_the_action(0)),
        Q::number("projector_defect", "distance of P² from P", |_, _, p| {
            norm((multiply(p.as_ref(), p.as_ref()) - p).as_ref())
        })
        .kept(Law::by_the_action(0).on_scale(Scale::One))
        .of_distance(),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        Ok((OnMatrices::new(self.flow.clone(), MatrixAction::Conjugation), self.start.clone()))
    }
    fn modelled(&self) -> String {
        let n = self.start.nrows();
        format!("projector onto {} of {n} dimensions, conjugated by SO({n})", self.dimension)
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
    fn facts(&self) -> Vec<Property> {
        let others = self.start.nrows() - self.dimension;
        let leading = self.eigenvalues[others..].iter().sum();
        let mut facts = vec![Property::of("sum_of_the_leading_eigenvalues", leading)];
        if others > 0 {
            let gap = self.eigenvalues[others] - self.eigenvalues[others - 1];
            facts.push(Property::of("rate_of_convergence", gap));
        }
        facts
    }
}
