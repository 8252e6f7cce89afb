//! Euler's equations on so(3)* ≅ ℝ³ and se(3)* ≅ ℝ⁶, where the action on vectors is the coadjoint one.

use lieflow::Error;
use lieflow::actions::{Coadjoint, Linear};
use lieflow::catalog::MethodSpec;
use lieflow::groups::{Power, Se3, So3};
use lieflow::problems::{Averaged, Euler};
use lieflow::scalar::{Counted, Real};
use nalgebra::Vector3;

use super::energy::Energy;
use super::{KIND, Keys};
use crate::kinds::flow::{OnSe3, OnSpheres};
use crate::kinds::old_system::System;
use crate::kinds::{Figure, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::Refusal;

/// The energy and the initial momentum, N numbers.
#[derive(Clone, Debug)]
struct Vectors<const N: usize> {
    energy: Energy,
    momentum: [f64; N],
}

/// The names of the numbers; so(3)* has the first three.
const NAMES: [&str; 6] = ["m1", "m2", "m3", "p1", "p2", "p3"];

fn read<const N: usize>(keys: Keys) -> Result<Vectors<N>, Refusal> {
    if keys.inverse_inertia.is_some() {
        let message =
            format!("`inverse_inertia` is for matrices; {} has a hamiltonian", keys.algebra);
        return Err(Refusal::at("inverse_inertia", message));
    }
    let missing = || Refusal::section("missing key `hamiltonian` in [problem]");
    let text = keys.hamiltonian.ok_or_else(missing)?;
    let names = keys.parameters.names("hamiltonian", NAMES[..N].iter().copied())?;
    Ok(Vectors { energy: Energy::read(&text, &names)?, momentum: keys.momentum.list("momentum")? })
}

pub(super) fn on_so3(keys: Keys) -> Result<Box<dyn ProblemSpec>, Refusal> {
    Ok(Box::new(read::<3>(keys)?))
}
pub(super) fn on_se3(keys: Keys) -> Result<Box<dyn ProblemSpec>, Refusal> {
    Ok(Box::new(read::<6>(keys)?))
}

/// a, or a + s(b − a).
fn on_the_way<S: Real, const N: usize>(a: [S; N], way: Option<([S; N], S)>) -> [S; N] {
    way.map_or(a, |(b, s)| core::array::from_fn(|i| a[i] + s * (b[i] - a[i])))
}

impl<const N: usize> Vectors<N> {
    /// |H| and |m||∇H|, whose rounding is that of H.
    fn energy_size(&self, m: &[f64; N]) -> f64 {
        let norm = |x: [f64; N]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let slope = core::array::from_fn(|i| self.energy.by(i, m));
        self.energy.value(m).abs() + norm(*m) * norm(slope)
    }
    fn columns_of(quantity: &QuantityInfo, casimirs: &[&str]) -> Vec<String> {
        let strings = |names: &[&str]| names.iter().map(|&name| name.into()).collect();
        match quantity.name {
            "momentum" => strings(&NAMES[..N]),
            "energy" => strings(&["energy"]),
            "casimirs" => strings(casimirs),
            _ => Vec::new(),
        }
    }
    fn laws_of_all() -> Vec<Law> {
        vec![
            Law::of_the_flow("energy", 0).on_scale(Scale::Terms),
            Law::of_the_action("casimirs", 2).on_scale(Scale::Terms),
        ]
    }
}

/// One momentum: the group is SO(3)¹, so that it is the problem of many bodies to the compiler.
type Momentum<S = f64> = Box<[Vector3<S>]>;

/// The problem with its start.
type OnSo3<S> = (OnSpheres<S>, Momentum<S>);

fn three<S: Real>(m: &Momentum<S>) -> [S; 3] {
    m.first().map_or([S::lit(f64::NAN); 3], |m| (*m).into())
}

impl Vectors<3> {
    fn flow<S: Real + Into<f64>>(&self) -> Result<OnSo3<S>, Error> {
        let (value, gradient) = (self.energy.clone(), self.energy.clone());
        let energy = Averaged(
            move |m: &Momentum<S>| value.value(&three(m)),
            move |a: &Momentum<S>, way: Option<(&Momentum<S>, S)>, xi: &mut Momentum<S>| {
                let m = on_the_way(three(a), way.map(|(b, s)| (three(b), s)));
                xi.fill(Vector3::from_fn(|i, _| gradient.by(i, &m)));
            },
        );
        let start = Box::new([Vector3::from(self.momentum.map(S::lit))]);
        Ok((OnSpheres::lie_poisson(Euler::new(Power::new(So3::new(), 1)?, energy), Linear), start))
    }
}

impl System for Vectors<3> {
    type Problem = OnSpheres<f64>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Momentum), Error> {
        self.flow()
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let (flow, start) = self.flow::<Counted>().ok()?;
        operations_by(method, &flow, start, pace)
    }
    fn check_start(&self, _: f64) -> Result<(), Refusal> {
        self.energy.check(&self.momentum)
    }
    fn modelled(&self) -> String {
        "momentum on so(3)*".into()
    }
    fn state(&self) -> &'static [&'static str] {
        &["momentum"]
    }
    fn laws(&self) -> Vec<Law> {
        Self::laws_of_all()
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        Self::columns_of(quantity, &["mm"])
    }
    fn show(&self, quantity: &str, _: f64, m: &Momentum, row: &mut Vec<f64>) {
        let m = three(m);
        match quantity {
            "momentum" => row.extend(m),
            "energy" => row.push(self.energy.value(&m)),
            "casimirs" => row.push(Vector3::from(m).norm_squared()),
            _ => {}
        }
    }
    fn size(&self, quantity: &str, m: &Momentum) -> f64 {
        match quantity {
            "energy" => self.energy_size(&three(m)),
            _ => Vector3::from(three(m)).norm_squared(),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("momentum")
    }
}

/// (m, p).
type Pair<S = f64> = (Vector3<S>, Vector3<S>);

fn six<S: Real>((m, p): &Pair<S>) -> [S; 6] {
    core::array::from_fn(|i| if i < 3 { m[i] } else { p[i - 3] })
}
fn pair<S: Real>(of: impl Fn(usize) -> S) -> Pair<S> {
    (Vector3::from_fn(|i, _| of(i)), Vector3::from_fn(|i, _| of(i + 3)))
}

impl Vectors<6> {
    fn flow<S: Real + Into<f64>>(&self) -> (OnSe3<S>, Pair<S>) {
        let (value, gradient) = (self.energy.clone(), self.energy.clone());
        let energy = Averaged(
            move |m: &Pair<S>| value.value(&six(m)),
            move |a: &Pair<S>, way: Option<(&Pair<S>, S)>, xi: &mut Pair<S>| {
                let m = on_the_way(six(a), way.map(|(b, s)| (six(b), s)));
                *xi = pair(|i| gradient.by(i, &m));
            },
        );
        let start = pair(|i| S::lit(self.momentum[i]));
        (OnSe3::lie_poisson(Euler::new(Se3::new(), energy), Coadjoint), start)
    }
}

impl System for Vectors<6> {
    type Problem = OnSe3<f64>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Pair), Error> {
        Ok(self.flow())
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let (flow, start) = self.flow::<Counted>();
        operations_by(method, &flow, start, pace)
    }
    fn check_start(&self, _: f64) -> Result<(), Refusal> {
        self.energy.check(&self.momentum)
    }
    fn modelled(&self) -> String {
        "momenta m and p on se(3)*".into()
    }
    fn state(&self) -> &'static [&'static str] {
        &["momentum"]
    }
    fn laws(&self) -> Vec<Law> {
        Self::laws_of_all()
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        Self::columns_of(quantity, &["pp", "mp"])
    }
    fn show(&self, quantity: &str, _: f64, y: &Pair, row: &mut Vec<f64>) {
        match quantity {
            "momentum" => row.extend(six(y)),
            "energy" => row.push(self.energy.value(&six(y))),
            "casimirs" => row.extend([y.1.norm_squared(), y.0.dot(&y.1)]),
            _ => {}
        }
    }
    fn size(&self, quantity: &str, y: &Pair) -> f64 {
        match quantity {
            "energy" => self.energy_size(&six(y)),
            _ => y.1.norm() * y.1.norm().max(y.0.norm()),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Lines("momentum")
    }
}
