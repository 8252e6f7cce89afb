//! `kind = "subspace"`: the flow of k-dimensional subspaces of ℝⁿ to the leading invariant subspace of a
//! symmetric matrix, on the Grassmann manifold of projectors; see [`SubspaceFlow`].
//!
//! The span of X moves as that of e^{tA}X: each row of VᵀX is multiplied by e^{tλ}, for V the eigenvectors of A. With V₁ the
//! leading ones and V₂ the others, the sines of its principal angles to the span of V₁ are the singular values of V₂ᵀP.

use lieflow::dense::{multiply, norm, qr, singular_values, symmetric_eigen};
use lieflow::problems::SubspaceFlow;
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::entries::{ROUNDING, check_rows, numbered, symmetric, trace, upper, upper_columns};
use super::on_m::{check_number, check_symmetric};
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
    /// VᵀX for an orthonormal basis X of the initial subspace.
    coordinates: Mat<f64>,
}

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let a = keys.a.and_then(|a| symmetric("a", &a, None, ROUNDING));
    let x = keys.x.and_then(|x| x.columns("x"));
    let (a, x) = all!(a, x)?;
    check_rows("x", &x, a.nrows())?;
    let flow = SubspaceFlow::new(a.clone())?;
    let start = flow.span(&x)?;
    let (eigenvalues, eigenvectors) = symmetric_eigen(a.as_ref())
        .map_err(|_| Refusal::at("a", "its eigenvalues cannot be found"))?;
    let coordinates = multiply(eigenvectors.transpose(), qr(x.as_ref()).0.as_ref());
    let dimension = x.ncols();
    Ok(Forms::of(Subspace { flow, dimension, start, eigenvalues, eigenvectors, coordinates }))
}

impl Subspace {
    /// A basis of the subspace after the time t, in terms of the eigenvectors. Its columns are independent for every t: a row
    /// of each is 1 there and 0 in the others, and these rows are among the largest at that time.
    fn basis_after(&self, t: f64) -> Mat<f64> {
        let (mut b, rates) = (self.coordinates.clone(), &self.eigenvalues);
        let (n, k) = (b.nrows(), b.ncols());
        let mut pivots: Vec<Option<usize>> = vec![None; k];
        for _ in 0..k {
            let free = |j: usize| pivots[j].is_none();
            let rows = (0..n).filter(|&i| !pivots.contains(&Some(i)));
            let all = rows.flat_map(|i| (0..k).filter(|&j| free(j)).map(move |j| (i, j)));
            // The logarithm of the entry at that time.
            let size = |&(i, j): &(usize, usize)| b[(i, j)].abs().ln() + t * rates[i];
            let Some((i, j)) = all.max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
            let pivot = b[(i, j)];
            (0..n).for_each(|row| b[(row, j)] /= pivot);
            for other in (0..k).filter(|&other| other != j) {
                let factor = b[(i, other)];
                (0..n).for_each(|row| b[(row, other)] -= factor * b[(row, j)]);
                b[(i, other)] = 0.0;
            }
            pivots[j] = Some(i);
        }
        for (j, pivot) in pivots.iter().enumerate() {
            let of_pivot = pivot.map_or(0.0, |i| rates[i]);
            for (i, rate) in rates.iter().enumerate() {
                // Nothing stays nothing, also where its factor would be infinite.
                if b[(i, j)] != 0.0 && *pivot != Some(i) {
                    b[(i, j)] *= (t * (rate - of_pivot)).exp();
                }
            }
        }
        b
    }
    fn angles(&self, p: &Mat<f64>) -> Vec<f64> {
        let others = self.start.nrows() - self.dimension;
        let (v2, v1) = (self.eigenvectors.get(.., ..others), self.eigenvectors.get(.., others..));
        // Those of the projections of P, the largest first.
        let [sines, cosines] = [v2, v1].map(|v| {
            let values = singular_values(multiply(v.transpose(), p.as_ref()).as_ref());
            values.unwrap_or_else(|_| vec![f64::NAN; v.ncols()])
        });
        // What a subspace shares with the leading one, it shares at the angle 0.
        let sines = sines.iter().copied().chain(core::iter::repeat(0.0)).take(self.dimension);
        let cosines = cosines.iter().copied().take(self.dimension).rev();
        sines.zip(cosines).map(|(sine, cosine)| sine.atan2(cosine)).collect()
    }
}

/// ‖P² − P‖.
fn defect(p: &Mat<f64>) -> f64 {
    norm((multiply(p.as_ref(), p.as_ref()) - p).as_ref())
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
        Q::number("projector_defect", "distance of P² from P", |_, _, p| defect(p))
            .kept(Law::by_the_action(0).on_scale(Scale::One))
            .of_distance(),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        Ok((OnMatrices::new(self.flow.clone(), MatrixAction::Conjugation), self.start.clone()))
    }
    fn check_state(&self, arg: &str, p: &Mat<f64>) -> Result<(), Error> {
        check_symmetric(arg, p)?;
        let distance = format!("the distance of {arg}² from {arg}");
        check_number(distance, defect(p), 0.0, 1.0, "that of a projector")?;
        let (dimension, of) = (self.dimension as f64, "the dimension of the subspace");
        check_number(format!("the trace of {arg}"), trace(p), dimension, 1.0, of)
    }
    fn modelled(&self) -> String {
        let n = self.start.nrows();
        format!("projector onto {} of {n} dimensions, conjugated by SO({n})", self.dimension)
    }
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<Mat<f64>, Error>> {
        let basis = self.basis_after(t1 - t0);
        Some(self.flow.span(&multiply(self.eigenvectors.as_ref(), basis.as_ref())))
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
