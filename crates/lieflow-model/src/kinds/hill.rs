//! `kind = "mathieu"` and `"hill"`: ẍ + (A − 2Q cos 2πt/T) x = 0 on Sp(2m), the fundamental solution
//! g with g = 𝟙 at the start; see [`hill`](fn@hill) and [`floquet`].

use core::f64::consts::{PI, TAU};

use lieflow::dense::largest_entry;
use lieflow::floquet::{Stability, monodromy};
use lieflow::groups::AlgebraMatrix;
use lieflow::methods::magnus::Magnus6;
use lieflow::problems::{LinearHamiltonian, explained_by_rounding, hill};
use lieflow::scalar::{Ops, tally};
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::entries::{
    self, check_symmetric, numbered, rows, symmetric, symmetric_part, symplectic_defect, trace,
};
use super::prelude::*;

/// The entry of Mathieu's equation in the list of kinds.
pub(super) const MATHIEU: Kind = Kind {
    name: "mathieu",
    equation: "ġ = [0 1; −(a − 2q cos 2t) 0] g, g = 𝟙 at the start",
    summary: "Mathieu's equation x'' + (a - 2q cos 2t) x = 0, its solutions as a matrix of Sp(2)",
    ..Kind::of::<MathieuKeys, Hill>(|section| read_with(section, read_mathieu))
};

/// The entry of Hill's equation in the list of kinds.
pub(super) const HILL: Kind = Kind {
    name: "hill",
    equation: "ġ = [0 𝟙; −(A − 2Q cos 2πt/T) 0] g, g = 𝟙 at the start",
    summary: "m coupled equations x'' + (A - 2Q cos 2πt/T) x = 0, their solutions as a matrix of \
              Sp(2m)",
    ..Kind::of::<HillKeys, Hill>(|section| read_with(section, read_hill))
};

keys! { MathieuKeys {
    a: Real = "a",
    q: Real = "q, half the strength of the drive",
} }

keys! { HillKeys {
    a: Table = "A, symmetric",
    q: Table = "Q, symmetric",
    period: Real = "T",
} }

/// A, Q and T.
#[derive(Clone, Debug)]
struct Hill {
    a: Mat<f64>,
    q: Mat<f64>,
    period: f64,
}

type Q = Quantity<Hill>;

fn read_mathieu(MathieuKeys { a, q, .. }: MathieuKeys) -> Result<Forms, ReadError> {
    let (a, q) = all!(a, q)?;
    let one = |x: Real| Mat::full(1, 1, x.0);
    Ok(Forms::of(Hill { a: one(a), q: one(q), period: PI }))
}

fn read_hill(keys: HillKeys) -> Result<Forms, ReadError> {
    let a = keys.a.and_then(|a| a.matrix("a", None));
    let symmetry = seen(&a).and_then(|a| Ok(check_symmetric("a", a, entries::ROUNDING)?));
    let n = a.as_ref().ok().map(Mat::nrows);
    let q = keys.q.and_then(|q| symmetric("q", &q, n, entries::ROUNDING));
    let period =
        keys.period.and_then(|period| period.checked("period", "a number > 0", |x| x > 0.0));
    let (a, (), q, period) = all!(a, symmetry, q, period)?;
    Ok(Forms::of(Hill { a: symmetric_part(&a), q, period }))
}

/// Steps over the period of the monodromy in the facts, at least and at most.
const STEPS: [f64; 2] = [1000.0, 200_000.0];
/// The largest phase of the fastest oscillation in such a step. The error of the sixth order is rounding there.
const PHASE: f64 = 0.1;
/// Beside the monodromy in half as many steps its error is this part of the difference.
const OF_HALF: f64 = 1.0 / 63.0;
/// A larger relative error of the monodromy tells nothing of its multipliers.
const UNKNOWN: f64 = 1e-3;

impl Hill {
    fn equation(
        &self,
    ) -> Result<LinearHamiltonian<impl Fn(f64, &mut AlgebraMatrix) + use<>>, Error> {
        let Hill { a, q, period, .. } = self.clone();
        hill(a.nrows(), move |t, i, j| {
            tally(|| Ops::muls(3) + Ops::adds(1) + Ops::divs(1) + Ops::trigs(1));
            a[(i, j)] - 2.0 * q[(i, j)] * (TAU / period * t).cos()
        })
    }

    /// The monodromy of the period from t = 0, with velocities in units in which the fastest oscillation turns a circle, and
    /// the error of its entries. None, if that is too large.
    fn monodromy(&self) -> Option<(Mat<f64>, f64)> {
        let fastest = (self.a.norm_l2() + 2.0 * self.q.norm_l2()).sqrt();
        let steps = (fastest * self.period / PHASE).clamp(STEPS[0], STEPS[1]) as u64;
        let equation = self.equation().ok()?;
        let unit = fastest.max(self.period.recip());
        let by = |steps| {
            let g = monodromy(&equation, &Magnus6, [0.0, self.period], steps).ok()?;
            Some(in_velocity_units(&g, unit))
        };
        let (coarse, fine) = (by(steps / 2)?, by(steps)?);
        let of_steps = OF_HALF * largest_entry((&fine - &coarse).as_ref());
        let size = largest_entry(fine.as_ref());
        let error = of_steps.max(explained_by_rounding(steps, size));
        (error < UNKNOWN * size).then_some((fine, error))
    }
}

/// A map of (x, ẋ) as one of (x, ẋ/unit).
fn in_velocity_units(g: &Mat<f64>, unit: f64) -> Mat<f64> {
    let m = g.nrows() / 2;
    Mat::from_fn(2 * m, 2 * m, |i, j| match (i < m, j < m) {
        (true, false) => g[(i, j)] * unit,
        (false, true) => g[(i, j)] / unit,
        _ => g[(i, j)],
    })
}

impl System for Hill {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["map"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "map",
            &["g11", "…", "g(2m)(2m)"],
            "the fundamental solution, row by row; the monodromy after a period",
            |_, _, g, row| row.extend(rows(g)),
        )
        .of_matrix("g", |hill| [2 * hill.a.nrows(); 2]),
        Q::numbers(
            "solution",
            &["x1", "…", "xm"],
            "the solution that starts with the first displacement 1, at rest",
            |_, _, g, row| row.extend(&g.col_as_slice(0)[..g.nrows() / 2]),
        )
        .with_columns(|hill| numbered("x", hill.a.nrows())),
        Q::number("trace", "trace of the map", |_, _, g| trace(g)),
        symplectic_defect(),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        let one = Mat::identity(2 * self.a.nrows(), 2 * self.a.nrows());
        let action = MatrixAction::Translation;
        Ok((OnMatrices::linear(self.equation()?.by(action), action), one))
    }
    fn modelled(&self) -> String {
        format!("fundamental solution in Sp({})", 2 * self.a.nrows())
    }
    fn figure(&self) -> Figure {
        Figure::Lines("solution")
    }
    fn facts(&self) -> Vec<Property> {
        let found = self.monodromy().and_then(|(monodromy, error)| {
            Some((trace(&monodromy), Stability::of(&monodromy, error).ok()?))
        });
        let Some((trace, Stability { growth, is_bounded })) = found else {
            return vec![
                Property::of("period", self.period),
                Property::of("growth_rate", f64::NAN),
            ];
        };
        vec![
            Property::of("period", self.period),
            Property::of("trace_of_the_monodromy", trace),
            Property::of("largest_multiplier", growth.exp()),
            Property::of("growth_rate", growth / self.period),
            Property::answer("stable", is_bounded),
        ]
    }
}
