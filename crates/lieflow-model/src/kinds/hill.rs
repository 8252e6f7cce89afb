//! `kind = "mathieu"` and `"hill"`: ẍ + (A − 2Q cos 2πt/T) x = 0 on Sp(2m), the fundamental solution
//! g with g = 𝟙 at the start; see [`hill`](fn@hill) and [`floquet`].

use core::f64::consts::{PI, TAU};

use lieflow::floquet::{Floquet, monodromy};
use lieflow::groups::AlgebraMatrix;
use lieflow::methods::magnus::Magnus6;
use lieflow::problems::{LinearHamiltonian, hill};
use lieflow::scalar::{Ops, tally};

use super::entries::{
    self, check_symmetric, numbered, power, rows, symmetric, symmetric_part, symplectic_defect,
    trace,
};
use super::flow::OnMatrices;
use super::matrix::MatrixAction;
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

/// Steps over the period of the monodromy in the facts: it is exact to rounding where a period has a few
/// oscillations.
const STEPS: u64 = 1000;
/// A multiplier counts as outside of the unit circle from this distance on: where two meet on it, rounding in the
/// monodromy moves them by its root.
const OFF_THE_CIRCLE: f64 = 1e-6;
/// Multipliers so near to the circle are on it.
const ROUNDING: f64 = 1e-12;

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

    /// The multipliers of a period from t = 0, the trace of its monodromy, and whether the powers of that stay bounded.
    fn multipliers(&self) -> Option<(Floquet, f64, bool)> {
        let g = monodromy(&self.equation().ok()?, &Magnus6, [0.0, self.period], STEPS).ok()?;
        Some((Floquet::of(&g).ok()?, trace(&g), stays_bounded(g.as_ref().to_owned())))
    }
}

/// Do the powers of a monodromy stay bounded? Where two multipliers meet on the circle, they may grow as the number of
/// periods. From so many on, the distances of multipliers that count as one do not matter.
fn stays_bounded(monodromy: Mat<f64>) -> bool {
    let many = power(monodromy, 1 << 20);
    let more = power(many.clone(), 1 << 10);
    more.norm_max() < 30.0 * many.norm_max()
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
        let Some((floquet, trace, is_bounded)) = self.multipliers() else { return Vec::new() };
        let radius = floquet.spectral_radius();
        // Rounding of the multipliers is no growth.
        let is_one = (radius - 1.0).abs() < ROUNDING;
        let growth = if is_one { 0.0 } else { floquet.growth(self.period) };
        vec![
            Property::of("period", self.period),
            Property::of("trace_of_the_monodromy", trace),
            Property::of("largest_multiplier", radius),
            Property::of("growth_rate", growth),
            Property::answer("stable", radius < 1.0 + OFF_THE_CIRCLE && is_bounded),
        ]
    }
}
