//! `kind = "euler"`: Euler's equations ṁ = ad*_ξ m with a quadratic energy on the dual of a matrix algebra,
//! ξ = π(W ∘ m) with weights W and the projection π on the algebra; see [`Euler`].
//!
//! H = ½⟨m, ξ⟩, ⟨m, v⟩ = tr(mᵀv). Invariants: H, and tr mᵏ, the Casimirs.

mod group;

use faer::Mat;
use lieflow::Error;
use lieflow::groups::{AlgebraMatrix, MatrixGroup};
use lieflow::problems::{Euler, Kinetic};
use lieflow::scalar::{Ops, tally};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use self::group::WithGroup;
use super::flow::Flow;
use super::matrix::MatrixAction;
use super::system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::{Layer, Model};
use crate::scene::values::Table;
use crate::scene::{ReadError, Refusal, help_for};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "euler",
    equation: "ṁ = P(ξᵀm − mξᵀ), ξ = P(W ∘ m), P the orthogonal projection on the algebra; energy ½ tr mᵀξ",
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
        QuantityInfo {
            name: "group",
            columns: &["g11", "…", "gnn"],
            meaning: "g with the velocity g grad H, from the identity, row by row; integrated only when \
                      asked for",
        },
        QuantityInfo {
            name: "momentum_space",
            columns: &["s11", "…", "snn"],
            meaning: "the momentum in space, Ad* of the inverse of g, row by row; needs g, which is then \
                      integrated",
        },
    ],
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    algebra: String,
    inverse_inertia: Table,
    momentum: Table,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Algebra {
    So,
    Sl,
    Gl,
    Sp,
}

impl Algebra {
    const ALL: [Algebra; 4] = [Algebra::So, Algebra::Sl, Algebra::Gl, Algebra::Sp];

    fn named(name: &str) -> Result<Algebra, Refusal> {
        Self::ALL.into_iter().find(|algebra| algebra.name() == name).ok_or_else(|| {
            let help = help_for(name, &Self::ALL.map(Algebra::name));
            let refusal = Refusal::at("algebra", format!("unknown algebra `{name}`"));
            Refusal { help: Some(help), ..refusal }
        })
    }
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
    let algebra = Algebra::named(&keys.algebra)?;
    let group = algebra.group(n).map_err(|error| Refusal::at("momentum", error.to_string()))?;
    let system = EulerEquation { algebra, group, weights, momentum };
    let mut inside = system.momentum.clone();
    system.project(&mut inside);
    if (&inside - &system.momentum).norm_max() > ROUNDING * system.momentum.norm_max() {
        let message = format!("it is not in {}({n})", algebra.name());
        return Err(Refusal::at("momentum", message).into());
    }
    Ok(Box::new(Spec { with_group: WithGroup(system.clone()), alone: system }))
}

impl EulerEquation {
    /// x ← its part in the algebra.
    fn project(&self, x: &mut Mat<f64>) {
        let n = x.nrows();
        match self.algebra {
            Algebra::Gl => {}
            Algebra::Sl => {
                tally(|| Ops::adds((2 * n).saturating_sub(1)) + Ops::divs(1));
                let mean = (0..n).map(|i| x[(i, i)]).sum::<f64>() / n as f64;
                (0..n).for_each(|i| x[(i, i)] -= mean);
            }
            Algebra::So => {
                tally(|| Ops::muladds(n * (n + 1) / 2));
                for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
                    let half = 0.5 * (x[(i, j)] - x[(j, i)]);
                    (x[(i, j)], x[(j, i)]) = (half, -half);
                }
            }
            // [a b; c −aᵀ] with symmetric b and c.
            Algebra::Sp => {
                let m = n / 2;
                tally(|| Ops::muladds(3 * m * m));
                for (i, j) in (0..m).flat_map(|i| (0..m).map(move |j| (i, j))) {
                    let half = 0.5 * (x[(i, j)] - x[(j + m, i + m)]);
                    (x[(i, j)], x[(j + m, i + m)]) = (half, -half);
                    for k in [0, m] {
                        let (above, below) = ((i + k, j + m - k), (j + k, i + m - k));
                        let mean = 0.5 * (x[above] + x[below]);
                        (x[above], x[below]) = (mean, mean);
                    }
                }
            }
        }
    }

    fn system(
        &self,
    ) -> Euler<MatrixGroup, Kinetic<impl Fn(&Mat<f64>, &mut AlgebraMatrix) + use<>>> {
        let this = self.clone();
        // π(W ∘ π(m)) is symmetric, as a gradient of a quadratic energy must be.
        let gradient = move |m: &Mat<f64>, xi: &mut AlgebraMatrix| {
            tally(|| Ops::muls(m.nrows() * m.ncols()));
            xi.copy_from(m);
            this.project(xi);
            for (xi, weights) in xi.col_iter_mut().zip(this.weights.col_iter()) {
                xi.iter_mut().zip(weights.iter()).for_each(|(x, w)| *x *= w);
            }
            this.project(xi);
        };
        Euler::new(self.group.clone(), Kinetic(gradient))
    }
}

/// The names of n×n entries, row by row.
fn names(letter: &str, n: usize) -> Vec<String> {
    (1..=n).flat_map(|i| (1..=n).map(move |j| format!("{letter}{i}{j}"))).collect()
}

fn by_rows(x: &Mat<f64>, row: &mut Vec<f64>) {
    row.extend((0..x.nrows()).flat_map(|i| (0..x.ncols()).map(move |j| x[(i, j)])));
}

/// The equation, with g where a quantity needs it.
#[derive(Clone, Debug)]
struct Spec {
    alone: EulerEquation,
    with_group: WithGroup,
}

impl Spec {
    fn of(&self, quantities: &[&str]) -> &dyn ProblemSpec {
        let needs =
            |name: &str| ["group", "momentum_space"].iter().any(|of_g| name.starts_with(of_g));
        match quantities.iter().any(|name| needs(name)) {
            true => &self.with_group,
            false => &self.alone,
        }
    }
}

impl ProblemSpec for Spec {
    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layers(&self) -> &'static [Layer] {
        &[Layer::General]
    }
    fn columns(&self, quantity: &str) -> Result<Vec<String>, Error> {
        ProblemSpec::columns(&self.with_group, quantity)
    }
    fn model(&self, layer: Layer, quantities: &[&str]) -> Result<Box<dyn Model>, Error> {
        self.of(quantities).model(layer, quantities)
    }
    fn state(&self, quantities: &[&str]) -> &'static [&'static str] {
        self.of(quantities).state(quantities)
    }
    fn invariants(&self, quantities: &[&str]) -> Vec<Law> {
        self.of(quantities).invariants(quantities)
    }
    fn figure(&self) -> Figure {
        System::figure(&self.alone)
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
        Ok(Flow::lie_poisson(self.system(), MatrixAction::Coadjoint, self.momentum.clone()))
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
            "momentum" => names("m", n),
            "casimirs" => (1..=n).map(|k| format!("trm{k}")).collect(),
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, _: f64, m: &Mat<f64>, row: &mut Vec<f64>) {
        let n = m.nrows();
        match quantity {
            "momentum" => by_rows(m, row),
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
