//! Euler's equations on so(3)* ≅ ℝ³ and se(3)* ≅ ℝ⁶, where the action on vectors is the coadjoint one.

use lieflow::actions::{Coadjoint, Linear};
use lieflow::groups::{Adjoint, LieGroup, Power, Se3, So3};
use lieflow::problems::{DiscreteGradient, Euler, MeanGradient};
use lieflow::scalar::{Counted, Real, Trig};
use lieflow_runs::spaces::{OnSe3, OnSpheres};
use nalgebra::Vector3;

use super::dual::{Dual, Given, OnDual, quantities};
use super::energy::Energy;
use crate::formula::{Formula, Names};
use crate::kinds::prelude::*;
use crate::problem::{PointOf, SampleKeys};

/// The energy and the initial momentum, N numbers.
#[derive(Clone, Debug)]
pub(super) struct Vectors<const N: usize> {
    energy: Energy,
    momentum: [f64; N],
}

/// The names of the numbers; so(3)* has the first three.
const NAMES: [&str; 6] = ["m1", "m2", "m3", "p1", "p2", "p3"];

/// One momentum: the group is SO(3)¹, so that it is the problem of many bodies to the compiler.
type Momentum<S> = Box<[Vector3<S>]>;

/// (m, p).
type Pair<S> = (Vector3<S>, Vector3<S>);

/// A momentum of N numbers.
trait Numbers<S, const N: usize> {
    fn numbers(&self) -> [S; N];
    fn set(&mut self, number: impl Fn(usize) -> S);
}

impl<S: Real + Into<f64> + 'static> Numbers<S, 3> for Momentum<S> {
    fn numbers(&self) -> [S; 3] {
        self.first().map_or([S::lit(f64::NAN); 3], |m| (*m).into())
    }
    fn set(&mut self, number: impl Fn(usize) -> S) {
        self.fill(Vector3::from_fn(|i, _| number(i)));
    }
}

impl<S: Real + Into<f64> + 'static> Numbers<S, 6> for Pair<S> {
    fn numbers(&self) -> [S; 6] {
        core::array::from_fn(|i| if i < 3 { self.0[i] } else { self.1[i - 3] })
    }
    fn set(&mut self, number: impl Fn(usize) -> S) {
        let vector = |first: usize| Vector3::from_fn(|i, _| number(first + i));
        *self = (vector(0), vector(3));
    }
}

impl<const N: usize> Vectors<N> {
    pub(super) fn read(algebra: &str, given: Given) -> Result<Self, ReadError> {
        let Given { names, hamiltonian, inverse_inertia, momentum } = given;
        if inverse_inertia?.is_some() {
            let message = format!("`inverse_inertia` is for matrices; {algebra} has a hamiltonian");
            return Err(Refusal::at("inverse_inertia", message).into());
        }
        let names = names.names("hamiltonian", NAMES[..N].iter().copied(), SampleKeys::none());
        let energy = hamiltonian.and_then(|text| {
            let missing = || Refusal::section("missing key `hamiltonian` in [problem]");
            Energy::read(&text.ok_or_else(missing)?, seen(&names)?)
        });
        let (names, momentum) =
            (names.and_then(Names::checked), momentum.and_then(|m| m.list("momentum")));
        let (_, energy, momentum) = all!(names, energy, momentum)?;
        Ok(Vectors { energy, momentum })
    }

    /// H, and ∇H at a or at a + s(b − a).
    fn averaged<G, S: Real + Into<f64> + 'static, M: Numbers<S, N>>(
        &self,
    ) -> impl DiscreteGradient<G> + use<G, S, M, N>
    where
        G: Adjoint<Dual = M> + LieGroup<Scalar = S, Alg = M>,
    {
        let (value, gradient) = (self.energy.clone(), self.energy.clone());
        MeanGradient(
            move |m: &M| value.value(&m.numbers()),
            move |a: &M, way: Option<(&M, S)>, xi: &mut M| {
                let mut m = a.numbers();
                if let Some((b, s)) = way {
                    let b = b.numbers();
                    m = core::array::from_fn(|i| m[i] + s * (b[i] - m[i]));
                }
                let slope = gradient.slope(&m);
                xi.set(|i| slope[i]);
            },
        )
    }
}

/// The vector of the numbers from the `first` one.
fn vector<const N: usize>(m: &impl Numbers<f64, N>, first: usize) -> Vector3<f64> {
    Vector3::from_column_slice(&m.numbers()[first..first + 3])
}

impl<const N: usize> Dual for Vectors<N>
where
    Self: System,
    PointOf<Self>: Numbers<f64, N>,
{
    type Momentum = PointOf<Self>;

    fn columns(&self) -> [Vec<String>; 2] {
        let casimirs: &[&str] = if N == 3 { &["mm"] } else { &["pp", "mp"] };
        [&NAMES[..N], casimirs].map(|names| names.iter().map(|&name| name.into()).collect())
    }
    fn degrees(&self) -> [u32; 2] {
        [0, 2]
    }
    fn entries(m: &Self::Momentum, row: &mut Vec<f64>) {
        row.extend(m.numbers());
    }
    fn energy(&self, m: &Self::Momentum) -> f64 {
        self.energy.value(&m.numbers())
    }
    /// |H| and |m||∇H|, whose rounding is that of H.
    fn energy_terms(&self, m: &Self::Momentum) -> f64 {
        let m = m.numbers();
        self.energy.value(&m).abs() + length(m) * length(self.energy.slope(&m))
    }
    fn casimirs(m: &Self::Momentum, row: &mut Vec<f64>) {
        if N == 3 {
            row.push(vector(m, 0).norm_squared());
        } else {
            row.extend([vector(m, 3).norm_squared(), vector(m, 0).dot(&vector(m, 3))]);
        }
    }
    fn casimir_terms(m: &Self::Momentum) -> f64 {
        let last = vector(m, N - 3).norm();
        last * last.max(vector(m, 0).norm())
    }
}

impl<const N: usize> OnDual for Vectors<N>
where
    Self: System,
    PointOf<Self>: Numbers<f64, N>,
{
    type Dual = Self;

    fn dual(&self) -> &Self {
        self
    }
    fn momentum(m: &PointOf<Self>) -> &PointOf<Self> {
        m
    }
}

impl Vectors<3> {
    fn on<S: Trig + Into<f64> + 'static>(&self) -> Result<OnSpheres<S>, Error> {
        let system = Euler::new(Power::new(So3::new(), 1)?, self.averaged());
        Ok(OnSpheres::lie_poisson(system, Linear))
    }
}

impl Vectors<6> {
    fn on<S: Trig + Into<f64> + 'static>(&self) -> OnSe3<S> {
        OnSe3::lie_poisson(Euler::new(Se3::new(), self.averaged()), Coadjoint)
    }
    fn start(&self) -> Pair<f64> {
        let [m1, m2, m3, p1, p2, p3] = self.momentum;
        (Vector3::new(m1, m2, m3), Vector3::new(p1, p2, p3))
    }
}

impl System for Vectors<3> {
    type Problem = OnSpheres;

    const STATE: &'static [&'static str] = &["momentum"];
    const QUANTITIES: &'static [Quantity<Self>] = &quantities();

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<OnSpheres>, Error> {
        Ok((self.on()?, Box::new([self.momentum.into()])))
    }
    fn counted(&self) -> Option<Counting> {
        let start = Box::new([Vector3::from(self.momentum).map(Counted)]);
        counting(self.on().ok()?, start)
    }
    fn check_start(&self, _: f64) -> Vec<Refusal> {
        self.energy.check(&self.momentum)
    }
    fn formula(&self) -> Option<&Formula> {
        Some(self.energy.formula())
    }
    fn modelled(&self) -> String {
        "momentum on so(3)*".into()
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("momentum")
    }
}

impl System for Vectors<6> {
    type Problem = OnSe3;

    const STATE: &'static [&'static str] = &["momentum"];
    const QUANTITIES: &'static [Quantity<Self>] = &quantities();

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<OnSe3>, Error> {
        Ok((self.on(), self.start()))
    }
    fn counted(&self) -> Option<Counting> {
        let (m, p) = self.start();
        counting(self.on(), (m.map(Counted), p.map(Counted)))
    }
    fn check_start(&self, _: f64) -> Vec<Refusal> {
        self.energy.check(&self.momentum)
    }
    fn formula(&self) -> Option<&Formula> {
        Some(self.energy.formula())
    }
    fn modelled(&self) -> String {
        "momenta m and p on se(3)*".into()
    }
}
