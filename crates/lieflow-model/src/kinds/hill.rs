//! `kind = "mathieu"` and `"hill"`: ẍ + (A − 2Q cos 2πt/T) x = 0 on Sp(2m), the fundamental solution
//! g with g = 𝟙 at the start; see [`hill`](fn@hill) and [`floquet`].

use core::f64::consts::{PI, TAU};

use faer::Mat;
use lieflow::Error;
use lieflow::groups::{GroupMatrix, LieGroup, MatrixGroup};
use lieflow::methods::magnus::Magnus6;
use lieflow::problems::{Floquet, LinearHamiltonian, floquet, hill, monodromy};
use lieflow::scalar::{Ops, tally};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::matrix::MatrixAction;
use super::old_system::System;
use super::{Fact, Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::kinds::flow::OnMatrices;
use crate::model::Layer;
use crate::scene::values::{Real, Table};
use crate::scene::{ReadError, Refusal};

/// The entry of Mathieu's equation in the list of kinds.
pub(super) const MATHIEU: Kind = Kind {
    name: "mathieu",
    equation: "ġ = [0 1; −(a − 2q cos 2t) 0] g, g = 𝟙 at the start",
    summary: "Mathieu's equation x'' + (a - 2q cos 2t) x = 0, its solutions as a matrix of Sp(2)",
    keys: &[
        KeyInfo { name: "a", meaning: "a" },
        KeyInfo { name: "q", meaning: "q, half the strength of the drive" },
    ],
    quantities: || QUANTITIES.to_vec(),
    read: |section| read_mathieu(section),
};

/// The entry of Hill's equation in the list of kinds.
pub(super) const HILL: Kind = Kind {
    name: "hill",
    equation: "ġ = [0 𝟙; −(A − 2Q cos 2πt/T) 0] g, g = 𝟙 at the start",
    summary: "m coupled equations x'' + (A - 2Q cos 2πt/T) x = 0, their solutions as a matrix of \
              Sp(2m)",
    keys: &[
        KeyInfo { name: "a", meaning: "A, symmetric" },
        KeyInfo { name: "q", meaning: "Q, symmetric" },
        KeyInfo { name: "period", meaning: "T" },
    ],
    quantities: || QUANTITIES.to_vec(),
    read: |section| read_hill(section),
};

const QUANTITIES: &[QuantityInfo] = &[
    QuantityInfo {
        name: "map",
        columns: &["g11", "…", "g(2m)(2m)"],
        meaning: "the fundamental solution, row by row; the monodromy after a period",
    },
    QuantityInfo {
        name: "solution",
        columns: &["x1", "…", "xm"],
        meaning: "the solution that starts with the first displacement 1, at rest",
    },
    QuantityInfo { name: "trace", columns: &["trace"], meaning: "trace of the map" },
    QuantityInfo {
        name: "symplectic_defect",
        columns: &["symplectic_defect"],
        meaning: "distance of g'Jg from J",
    },
];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MathieuKeys {
    a: Real,
    q: Real,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HillKeys {
    a: Table,
    q: Table,
    period: Real,
}

/// A, Q and T.
#[derive(Clone, Debug)]
struct Hill {
    kind: &'static Kind,
    a: Mat<f64>,
    q: Mat<f64>,
    period: f64,
}

fn read_mathieu(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let MathieuKeys { a, q } = MathieuKeys::deserialize(section)?;
    let one = |x: Real| Mat::from_fn(1, 1, |_, _| x.0);
    Ok(Box::new(Hill { kind: &MATHIEU, a: one(a), q: one(q), period: PI }))
}

fn read_hill(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = HillKeys::deserialize(section)?;
    let a = keys.a.matrix("a", None)?;
    let q = keys.q.matrix("q", Some(a.nrows()))?;
    if q.nrows() != a.nrows() {
        let message = format!("found {} rows, expected {} as a has them", q.nrows(), a.nrows());
        return Err(Refusal::at("q", message).into());
    }
    for (key, x) in [("a", &a), ("q", &q)] {
        let mut below = (0..x.nrows()).flat_map(|i| (0..i).map(move |j| (i, j)));
        if let Some((i, j)) = below.find(|&(i, j)| x[(i, j)] != x[(j, i)]) {
            let message = format!(
                "{} stands across from {}, expected a symmetric matrix",
                x[(i, j)],
                x[(j, i)]
            );
            return Err(Refusal::at(format!("{key}[{i},{j}]"), message).into());
        }
    }
    match keys.period.0 > 0.0 {
        true => Ok(Box::new(Hill { kind: &HILL, a, q, period: keys.period.0 })),
        false => Err(Refusal::at("period", format!("{}, expected > 0", keys.period.0)).into()),
    }
}

/// Steps of the monodromy of the facts: to rounding where a period has a few oscillations.
const STEPS: u64 = 1000;
/// Multipliers this far out of the unit circle are out of it; where two meet on it, rounding in the
/// monodromy moves them by its root.
const OFF_THE_CIRCLE: f64 = 1e-6;

impl Hill {
    fn equation(
        &self,
    ) -> Result<LinearHamiltonian<impl Fn(f64, &mut lieflow::groups::AlgebraMatrix) + use<>>, Error>
    {
        let Hill { a, q, period, .. } = self.clone();
        hill(a.nrows(), move |t, i, j| {
            tally(|| Ops::muls(3) + Ops::adds(1) + Ops::divs(1) + Ops::trigs(1));
            a[(i, j)] - 2.0 * q[(i, j)] * (TAU / period * t).cos()
        })
    }

    /// The multipliers of a period from t = 0, and the trace of its monodromy.
    fn multipliers(&self) -> Option<(Floquet, f64)> {
        let g = monodromy(&self.equation().ok()?, &Magnus6, [0.0, self.period], STEPS).ok()?;
        let trace = (0..g.nrows()).map(|i| g[(i, i)]).sum();
        Some((floquet(&g).ok()?, trace))
    }
}

impl System for Hill {
    type Problem = OnMatrices;

    fn kind(&self) -> &'static Kind {
        self.kind
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        let one = Mat::identity(2 * self.a.nrows(), 2 * self.a.nrows());
        let action = MatrixAction::Translation;
        Ok((OnMatrices::linear(self.equation()?.by(action), action), one))
    }
    fn modelled(&self) -> String {
        format!("fundamental solution in Sp({})", 2 * self.a.nrows())
    }
    fn state(&self) -> &'static [&'static str] {
        &["map"]
    }
    fn laws(&self) -> Vec<Law> {
        vec![Law::of_the_action("symplectic_defect", 2).on_scale(Scale::Terms)]
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let m = self.a.nrows();
        match quantity.name {
            "map" => {
                (1..=2 * m).flat_map(|i| (1..=2 * m).map(move |j| format!("g{i}{j}"))).collect()
            }
            "solution" => (1..=m).map(|i| format!("x{i}")).collect(),
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, _: f64, g: &Mat<f64>, row: &mut Vec<f64>) {
        let n = g.nrows();
        match quantity {
            "map" => row.extend((0..n).flat_map(|i| (0..n).map(move |j| g[(i, j)]))),
            "solution" => row.extend(&g.col_as_slice(0)[..n / 2]),
            "trace" => row.push((0..n).map(|i| g[(i, i)]).sum()),
            _ => row.push(symplectic_defect(g)),
        }
    }
    fn size(&self, _: &str, g: &Mat<f64>) -> f64 {
        g.squared_norm_l2()
    }
    fn figure(&self) -> Figure {
        Figure::Lines("solution")
    }
    fn facts(&self) -> Vec<Fact> {
        let Some((floquet, trace)) = self.multipliers() else { return Vec::new() };
        let radius = floquet.spectral_radius();
        let stable = f64::from(u8::from(radius < 1.0 + OFF_THE_CIRCLE));
        vec![
            Fact { name: "period", value: self.period },
            Fact { name: "trace_of_the_monodromy", value: trace },
            Fact { name: "largest_multiplier", value: radius },
            Fact { name: "growth_rate", value: floquet.growth(self.period) },
            Fact { name: "stable", value: stable },
        ]
    }
}

/// ‖gᵀJg − J‖.
pub(super) fn symplectic_defect(g: &Mat<f64>) -> f64 {
    let element = GroupMatrix::new_unchecked(g.clone());
    MatrixGroup::sp(g.nrows()).map_or(f64::NAN, |group| group.defect(&element))
}
