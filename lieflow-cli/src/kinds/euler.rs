//! `kind = "euler"`: Euler's equations ṁ = ad*_ξ m with a quadratic energy on the dual of a matrix algebra,
//! ξ = π(W ∘ m) with weights W and the projection π on the algebra; see [`Euler`].
//!
//! H = ½⟨m, ξ⟩, ⟨m, v⟩ = tr(mᵀv). Invariants: H, and tr mᵏ, the Casimirs.

use faer::Mat;
use lieflow::Error;
use lieflow::groups::{AlgebraMatrix, MatrixGroup};
use lieflow::problems::{Euler, Kinetic};
use lieflow::scalar::{Ops, tally};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::flow::Flow;
use super::matrix::MatrixAction;
use super::system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::Layer;
use crate::scene::values::Table;
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "euler",
    summary: "Euler's equations with a quadratic energy on the dual of so(n), sl(n), gl(n) or sp(2m)",
    keys: &[
        KeyInfo { name: "algebra", meaning: "\"so\", \"sl\", \"gl\" or \"sp\"" },
        KeyInfo {
            name: "inverse_inertia",
            meaning: "an n×n matrix of weights, symmetric for so: the gradient of the energy is the \
                      part in the algebra of the momentum times it, entry by entry",
        },
        KeyInfo { name: "momentum", meaning: "initial momentum, n×n, in the algebra" },
    ],
    quantities: &[
        QuantityInfo {
            name: "momentum",
            columns: &["m11", "…", "mnn"],
            meaning: "momentum, row by row",
        },
        QuantityInfo { name: "energy", columns: &["energy"], meaning: "the energy" },
        QuantityInfo {
            name: "casimirs",
            columns: &["trm1", "…", "trmn"],
            meaning: "traces of the powers of the momentum",
        },
    ],
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    algebra: Algebra,
    inverse_inertia: Table,
    momentum: Table,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
enum Algebra {
    So,
    Sl,
    Gl,
    Sp,
}

impl Algebra {
    fn name(self) -> &'static str {
        match self {
            Algebra::So => "so",
            Algebra::Sl => "sl",
            Algebra::Gl => "gl",
            Algebra::Sp => "sp",
        }
    }
    /// The group; that of sl(n) is GL(n), in which nothing moves out of SL(n).
    fn group(self, n: usize) -> Result<MatrixGroup, Error> {
        match self {
            Algebra::So => MatrixGroup::so(n),
            Algebra::Sp => MatrixGroup::sp(n),
            Algebra::Sl | Algebra::Gl => MatrixGroup::gl(n),
        }
    }
}

/// The system with its initial momentum.
#[derive(Clone, Debug)]
struct EulerEquation {
    algebra: Algebra,
    group: MatrixGroup,
    weights: Mat<f64>,
    momentum: Mat<f64>,
}

/// What a momentum may have outside of the algebra, relative to its size.
const ROUNDING: f64 = 1e-12;

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let momentum = keys.momentum.matrix("momentum", None)?;
    let n = momentum.nrows();
    let weights = keys.inverse_inertia.matrix("inverse_inertia", Some(n))?;
    if weights.nrows() != n {
        let message = format!("found {} rows, expected {n} as momentum has them", weights.nrows());
        return Err(Refusal::at("inverse_inertia", message).into());
    }
    let group =
        keys.algebra.group(n).map_err(|error| Refusal::at("momentum", error.to_string()))?;
    let system = EulerEquation { algebra: keys.algebra, group, weights, momentum };
    let inside = system.part(&system.momentum);
    if (&inside - &system.momentum).norm_max() > ROUNDING * system.momentum.norm_max() {
        let message = format!("it is not in {}({n})", keys.algebra.name());
        return Err(Refusal::at("momentum", message).into());
    }
    Ok(Box::new(system))
}

impl EulerEquation {
    /// The part of x in the algebra. Allocates.
    fn part(&self, x: &Mat<f64>) -> Mat<f64> {
        let n = x.nrows();
        match self.algebra {
            Algebra::Gl => x.clone(),
            Algebra::Sl => {
                let mean = (0..n).map(|i| x[(i, i)]).sum::<f64>() / n as f64;
                Mat::from_fn(n, n, |i, j| if i == j { x[(i, j)] - mean } else { x[(i, j)] })
            }
            Algebra::So | Algebra::Sp => self.group.project_algebra(x.as_ref()).into_mat(),
        }
    }

    fn system(
        &self,
    ) -> Euler<MatrixGroup, Kinetic<impl Fn(&Mat<f64>, &mut AlgebraMatrix) + use<>>> {
        let this = self.clone();
        // π(W ∘ π(m)) is symmetric, as a gradient of a quadratic energy must be.
        let gradient = move |m: &Mat<f64>, xi: &mut AlgebraMatrix| {
            let inside = this.part(m);
            let n = m.nrows();
            let part = match this.algebra {
                Algebra::Gl => Ops::NONE,
                Algebra::Sl => Ops::adds(2 * n) + Ops::divs(1),
                Algebra::So | Algebra::Sp => Ops::muladds(n * n),
            };
            tally(part * 2 + Ops::muls(n * n));
            let weighted = Mat::from_fn(n, n, |i, j| this.weights[(i, j)] * inside[(i, j)]);
            xi.copy_from(this.part(&weighted));
        };
        Euler::new(self.group.clone(), Kinetic(gradient))
    }
}

impl System for EulerEquation {
    type Problem = Flow<MatrixGroup, MatrixAction>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        Ok(Flow::nonlinear(self.system(), MatrixAction::Coadjoint, self.momentum.clone()))
    }
    fn modelled(&self) -> String {
        format!("momentum on {}({})*", self.algebra.name(), self.momentum.nrows())
    }
    fn state(&self) -> &'static [&'static str] {
        &["momentum"]
    }
    fn laws(&self) -> Vec<Law> {
        vec![
            Law::of_the_flow("energy", 2).on_scale(Scale::Terms),
            Law::of_the_action("casimirs", 0).on_scale(Scale::Terms),
        ]
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let n = self.momentum.nrows();
        match quantity.name {
            "momentum" => (1..=n).flat_map(|i| (1..=n).map(move |j| format!("m{i}{j}"))).collect(),
            "casimirs" => (1..=n).map(|k| format!("trm{k}")).collect(),
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, _: f64, m: &Mat<f64>, row: &mut Vec<f64>) {
        let n = m.nrows();
        match quantity {
            "momentum" => row.extend((0..n).flat_map(|i| (0..n).map(move |j| m[(i, j)]))),
            "energy" => row.push(self.system().energy(m)),
            _ => {
                let mut power = Mat::<f64>::identity(n, n);
                for _ in 0..n {
                    power = &power * m;
                    row.push((0..n).map(|i| power[(i, i)]).sum());
                }
            }
        }
    }
    /// |m|ⁿ, or |m|² times the largest weight: a bound of all that is summed.
    fn size(&self, quantity: &str, m: &Mat<f64>) -> f64 {
        let size = m.norm_l2();
        match quantity {
            "energy" => self.weights.norm_max() * size * size,
            _ => size.max(1.0).powi(m.nrows() as i32),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Lines("momentum")
    }
}
