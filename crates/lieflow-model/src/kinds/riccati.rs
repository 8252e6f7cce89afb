//! `kind = "riccati"`: Ṗ = C + DP + PDᵀ − PBP for symmetric P, through the action of Sp(2m) on Lagrangian
//! subspaces: a step may pass a pole of P.
//!
//! f = \[−Dᵀ B; C D\] ∈ sp(2m); Λ(g, P) = (C′ + D′P)(A′ + B′P)⁻¹ for g = \[A′ B′; C′ D′\].

use lieflow::groups::{AlgebraMatrix, MatrixGroup};
use lieflow::problems::Flow;
use lieflow_runs::schema::Branch;
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::entries::{
    ROUNDING, check_symmetric, eigenvalues, numbered, square, symmetric, symmetric_part, upper,
    upper_columns,
};
use super::on_m;
use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "riccati",
    equation: "Ṗ = C + DP + PDᵀ − PBP",
    summary: "the matrix Riccati equation P' = C + DP + PD' − PBP, on Lagrangian subspaces",
    ..Kind::of::<Keys, Riccati>(|section| read_with(section, read))
};

keys! { Keys {
    c: Table = "C, symmetric",
    d: Option<Table> = "D; optional, 0",
    b: Table = "B, symmetric",
    p: Table = "the initial P, symmetric",
} }

/// The coefficients and P(t₀).
#[derive(Clone, Debug)]
struct Riccati {
    c: Mat<f64>,
    d: Mat<f64>,
    b: Mat<f64>,
    p: Mat<f64>,
}

type Q = Quantity<Riccati>;

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let p = keys.p.and_then(|p| p.matrix("p", None));
    let m = p.as_ref().ok().map(Mat::nrows);
    let of_p = |key, table: Key<Table>| table.and_then(|x| symmetric(key, &x, m, ROUNDING));
    let (c, b) = (of_p("c", keys.c), of_p("b", keys.b));
    let d = keys.d.and_then(|d| d.map(|d| square("d", &d, m)).transpose());
    let start = seen(&p).and_then(|p| Ok(check_symmetric("p", p, ROUNDING)?));
    let (c, d, b, p, ()) = all!(c, d, b, p, start)?;
    let d = d.unwrap_or_else(|| Mat::zeros(p.nrows(), p.nrows()));
    Ok(Forms::of(Riccati { c, d, b, p: symmetric_part(&p) }))
}

impl Riccati {
    /// The s of P = sQ that makes the equation of Q, with C/s and sB, the slowest.
    fn scale(&self) -> f64 {
        let [c, d, b, p] = [&self.c, &self.d, &self.b, &self.p].map(|x| x.norm_l2());
        let scale = match (c > 0.0, d > 0.0, b > 0.0) {
            (true, _, true) => (c / b).sqrt(),
            (true, true, false) => c / d,
            (false, true, true) => d / b,
            _ => c.max(p),
        };
        if scale > 0.0 && scale.is_finite() { scale } else { 1.0 }
    }

    /// The angles, arctan of the eigenvalues, as a run follows them: as those of Q with P = sQ.
    ///
    /// The rate of their sum is tr XᵀSX with S = \[C/s D; Dᵀ −sB\] and orthonormal columns X of the subspace, so it is at
    /// most the sum of the m largest eigenvalues of S, and at least that of the m smallest.
    fn branch(&self) -> Branch {
        let Riccati { c, d, b, .. } = self;
        let (m, scale) = (c.nrows(), self.scale());
        let s = Mat::from_fn(2 * m, 2 * m, |i, j| match (i < m, j < m) {
            (true, true) => c[(i, j)] / scale,
            (true, false) => d[(i, j - m)],
            (false, true) => d[(j, i - m)],
            (false, false) => -scale * b[(i - m, j - m)],
        });
        let eigenvalues = eigenvalues(&s);
        let [low, high] =
            [&eigenvalues[..m], &eigenvalues[m..]].map(|half| half.iter().sum::<f64>());
        Branch::HalfTurns { rate: high.max(-low), scale }
    }
}

impl System for Riccati {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["p"];
    // f is constant: each step is exact, whatever the sizes of C, D and B.
    const DEFAULT_METHOD: Option<&'static str> = Some("magnus6");
    /// None is kept: the action moves each Lagrangian subspace to each.
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "p",
            &["p11", "…", "pmm"],
            "the entries of P on and above the diagonal, row by row",
            |_, _, p, row| row.extend(upper(p)),
        )
        .with_columns(|riccati| upper_columns("p", riccati.p.nrows())),
        Q::numbers(
            "angles",
            &["angle1", "…", "anglem"],
            "arctan of the eigenvalues of P in ascending order; continuous: at a pole of P they go on over pi/2 or \
             -pi/2, and the angles less the arctan are pi times the poles that were passed",
            |_, _, p, row| row.extend(eigenvalues(p).iter().map(|x| x.atan())),
        )
        .in_radians()
        .continuous_by(Riccati::branch)
        .with_columns(|riccati| numbered("angle", riccati.p.nrows())),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
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
    fn check_state(&self, arg: &str, p: &Mat<f64>) -> Result<(), Error> {
        on_m::check_symmetric(arg, p)
    }
    fn modelled(&self) -> String {
        format!("symmetric {0}×{0} matrix, a Lagrangian subspace of dimension {0}", self.p.nrows())
    }
    fn figure(&self) -> Figure {
        Figure::Lines("angles")
    }
}
