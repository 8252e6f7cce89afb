//! Euler's equations on the dual of an algebra of matrices.

use faer::Mat;
use lieflow::Error;
use lieflow::actions::Action;
use lieflow::groups::{AlgebraMatrix, LieAlgebra, LieGroup, MatrixGroup};
use lieflow::problems::{
    Averaged, DiscreteGradient, DynFlow, Euler, FromTheBody, Hamiltonian, Kinetic,
};
use lieflow::scalar::{Ops, tally};

use super::energy::Energy;
use super::group::WithGroup;
use super::{KIND, Keys};
use crate::kinds::algebra::{Algebra, outside};
use crate::kinds::flow::OnMatrices;
use crate::kinds::matrix::MatrixAction;
use crate::kinds::old_system::System;
use crate::kinds::{Figure, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::{Layer, Model};
use crate::scene::{Either, Refusal, exactly_one};

/// H.
#[derive(Clone, Debug)]
enum Form {
    /// ½⟨m, π(W ∘ m)⟩.
    Weights(Mat<f64>),
    Formula(Energy),
}

/// The system with its initial momentum.
#[derive(Clone, Debug)]
pub(super) struct EulerEquation {
    algebra: Algebra,
    pub(super) group: MatrixGroup,
    form: Form,
    pub(super) momentum: Mat<f64>,
}

/// What a momentum may have outside of the algebra, relative to its size.
const ROUNDING: f64 = 1e-12;

/// Formulas name entries by one digit for the row and one for the column.
const NAMED_MAX: usize = 9;

pub(super) fn on(algebra: Algebra, keys: Keys) -> Result<Box<dyn ProblemSpec>, Refusal> {
    let momentum = keys.momentum.square("momentum")?;
    let n = momentum.nrows();
    let stated = ("inverse_inertia", keys.inverse_inertia);
    let form = match exactly_one(stated, ("hamiltonian", keys.hamiltonian))? {
        Either::First(table) => {
            let weights = table.matrix("inverse_inertia", Some(n))?;
            if weights.nrows() != n {
                let found = weights.nrows();
                let message = format!("found {found} rows, expected {n} as momentum has them");
                return Err(Refusal::at("inverse_inertia", message));
            }
            Form::Weights(weights)
        }
        Either::Second(_) if n > NAMED_MAX => {
            let message = format!("the momentum is {n}×{n}, expected at most {NAMED_MAX} rows");
            return Err(Refusal::at("hamiltonian", message));
        }
        Either::Second(text) => {
            let names = keys.parameters.names("hamiltonian", names("m", n))?;
            Form::Formula(Energy::read(&text, &names)?)
        }
    };
    let group = algebra.group(n, "momentum")?;
    if outside(algebra, &momentum, ROUNDING).is_some() {
        return Err(Refusal::at("momentum", format!("it is not in {}", algebra.name(n))));
    }
    let alone = EulerEquation { algebra, group, form, momentum };
    Ok(Box::new(Spec { with_group: WithGroup(alone.clone()), alone }))
}

/// The entries of x, row by row, for formulas.
fn entries(x: &Mat<f64>) -> [f64; NAMED_MAX * NAMED_MAX] {
    let mut entries = [0.0; NAMED_MAX * NAMED_MAX];
    let n = x.nrows();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        entries[i * n + j] = x[(i, j)];
    }
    entries
}

impl EulerEquation {
    /// Of quadratic energy.
    fn weighted(&self, weights: &Mat<f64>) -> impl DiscreteGradient<MatrixGroup> + use<> {
        let (algebra, weights) = (self.algebra, weights.clone());
        // π(W ∘ π(m)) is symmetric, as a gradient of a quadratic energy must be.
        Kinetic(move |m: &Mat<f64>, xi: &mut AlgebraMatrix| {
            tally(|| Ops::muls(m.nrows() * m.ncols()));
            xi.copy_from(m);
            algebra.project(xi);
            for (xi, weights) in xi.col_iter_mut().zip(weights.col_iter()) {
                xi.iter_mut().zip(weights.iter()).for_each(|(x, w)| *x *= w);
            }
            algebra.project(xi);
        })
    }

    /// Of the energy H(π(m)), with the gradient π(∂H(π(m))).
    fn stated(&self, energy: &Energy) -> impl DiscreteGradient<MatrixGroup> + use<> {
        let algebra = self.algebra;
        let (value, gradient) = (energy.clone(), energy.clone());
        Averaged(
            move |m: &Mat<f64>| {
                let mut inside = m.clone();
                algebra.project(&mut inside);
                value.value(&entries(&inside))
            },
            move |a: &Mat<f64>, way: Option<(&Mat<f64>, f64)>, xi: &mut AlgebraMatrix| {
                let n = a.nrows();
                xi.copy_from(a);
                if let Some((b, s)) = way {
                    tally(|| Ops::adds(n * n) + Ops::muladds(n * n));
                    for (j, column) in xi.col_iter_mut().enumerate() {
                        column.iter_mut().enumerate().for_each(|(i, x)| *x += s * (b[(i, j)] - *x));
                    }
                }
                algebra.project(xi);
                let m = entries(xi);
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    xi[(i, j)] = gradient.by(i * n + j, &m);
                }
                algebra.project(xi);
            },
        )
    }

    /// The same with g, from g = 𝟙.
    pub(super) fn flow_with_group(&self) -> (DynFlow<MatrixGroup, FromTheBody>, PointWithGroup) {
        let start = (self.group.identity(), self.momentum.clone());
        let group = self.group.clone();
        match &self.form {
            Form::Weights(weights) => {
                let system = Euler::new(group, self.weighted(weights));
                (DynFlow::new(system.with_group(), FromTheBody), start)
            }
            Form::Formula(energy) => {
                let system = Euler::new(group, self.stated(energy));
                (DynFlow::new(system.with_group(), FromTheBody), start)
            }
        }
    }

    fn energy(&self, m: &Mat<f64>) -> f64 {
        match &self.form {
            Form::Weights(weights) => self.weighted(weights).value(&self.group, m),
            Form::Formula(energy) => self.stated(energy).value(&self.group, m),
        }
    }
}

/// (g, m).
type PointWithGroup = <FromTheBody as Action<MatrixGroup>>::Point;

/// The names of n×n entries, row by row.
pub(super) fn names(letter: &str, n: usize) -> Vec<String> {
    (1..=n).flat_map(|i| (1..=n).map(move |j| format!("{letter}{i}{j}"))).collect()
}

pub(super) fn by_rows(x: &Mat<f64>, row: &mut Vec<f64>) {
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
    fn check_start(&self, t0: f64) -> Result<(), Refusal> {
        ProblemSpec::check_start(&self.alone, t0)
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
    type Problem = OnMatrices;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Mat<f64>), Error> {
        let (group, action) = (self.group.clone(), MatrixAction::Coadjoint);
        let start = self.momentum.clone();
        Ok(match &self.form {
            Form::Weights(weights) => {
                (OnMatrices::lie_poisson(Euler::new(group, self.weighted(weights)), action), start)
            }
            Form::Formula(energy) => {
                (OnMatrices::lie_poisson(Euler::new(group, self.stated(energy)), action), start)
            }
        })
    }
    fn check_start(&self, _: f64) -> Result<(), Refusal> {
        match &self.form {
            Form::Weights(_) => Ok(()),
            Form::Formula(energy) => energy.check(&entries(&self.momentum)),
        }
    }
    fn modelled(&self) -> String {
        format!("momentum on {}*", self.algebra.name(self.momentum.nrows()))
    }
    fn state(&self) -> &'static [&'static str] {
        &["momentum"]
    }
    fn laws(&self) -> Vec<Law> {
        let degree = if matches!(self.form, Form::Weights(_)) { 2 } else { 0 };
        vec![
            Law::of_the_flow("energy", degree).on_scale(Scale::Terms),
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
            "energy" => row.push(self.energy(m)),
            _ => {
                let mut power = Mat::<f64>::identity(n, n);
                for _ in 0..n {
                    power = &power * m;
                    row.push((0..n).map(|i| power[(i, i)]).sum());
                }
            }
        }
    }
    /// |m|ⁿ, or |m|² times the largest weight: a bound of all that is summed. The rounding of a formula is
    /// that of its value, and of m times its slope.
    fn size(&self, quantity: &str, m: &Mat<f64>) -> f64 {
        let size = m.norm_l2();
        match (quantity, &self.form) {
            ("energy", Form::Weights(weights)) => weights.norm_max() * size * size,
            ("energy", Form::Formula(energy)) => {
                let mut slope = self.group.zero();
                self.stated(energy).gradient(m, &mut slope);
                self.energy(m).abs() + size * slope.norm_l2()
            }
            _ => size.max(1.0).powi(m.nrows() as i32),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Lines("momentum")
    }
}
