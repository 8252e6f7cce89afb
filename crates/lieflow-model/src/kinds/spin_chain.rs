//! `kind = "spin-chain"`: the Landau–Lifshitz chain on (S²)ᴺ; see [`SpinChain`].

use lieflow::Error;
use lieflow::actions::Linear;
use lieflow::catalog::MethodSpec;
use lieflow::problems::SpinChain;
use lieflow::scalar::{Counted, Real as Scalar};
use nalgebra::Vector3;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::kinds::flow::OnSpheres;
use crate::model::Layer;
use crate::operations::{Pace, operations_by};
use crate::scene::values::{Real, Reals, Whole};
use crate::scene::{Either, ReadError, Refusal, exactly_one};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "spin-chain",
    equation: "ṡᵢ = Hᵢ × sᵢ + α (sᵢ × Hᵢ) × sᵢ, Hᵢ = sᵢ₋₁ + sᵢ₊₁ + K (sᵢ)₃ e₃ + B, α the damping",
    summary: "a chain of spins with exchange, anisotropy, a field and damping, on spheres",
    keys: &[
        KeyInfo { name: "spins", meaning: "initial directions, one row a spin, normalised" },
        KeyInfo {
            name: "wave",
            meaning: "{count, turns, cone}, instead of spins: count spins at the angle cone to e3, \
                      that turn so often around it along the chain",
        },
        KeyInfo { name: "ring", meaning: "are the ends joined? optional, true" },
        KeyInfo { name: "anisotropy", meaning: "K, > 0 for an easy axis e3; optional, 0" },
        KeyInfo { name: "field", meaning: "the field; optional, 0" },
        KeyInfo { name: "damping", meaning: "Gilbert's damping, at least 0; optional, 0" },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "spins",
                columns: &["s1x", "s1y", "s1z", "…", "sNz"],
                meaning: "the spins, one after the other",
            },
            QuantityInfo {
                name: "magnetisation",
                columns: &["mx", "my", "mz"],
                meaning: "mean of the spins",
            },
            QuantityInfo { name: "energy", columns: &["energy"], meaning: "energy" },
            QuantityInfo {
                name: "total_spin3",
                columns: &["total_spin3"],
                meaning: "sum of the third components",
            },
            QuantityInfo {
                name: "lengths2",
                columns: &["lengths2"],
                meaning: "sum of the squares of the lengths",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    spins: Option<Vec<Reals<3>>>,
    wave: Option<Wave>,
    ring: Option<bool>,
    anisotropy: Option<Real>,
    field: Option<Reals<3>>,
    damping: Option<Real>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wave {
    count: Whole<2>,
    turns: Real,
    cone: Real,
}

/// More spins are not meant.
const SPINS_MAX: u64 = 1 << 16;

/// The chain with its initial spins.
#[derive(Clone, Debug)]
struct Chain {
    chain: SpinChain,
    damped: bool,
    field: Vector3<f64>,
    start: Box<[Vector3<f64>]>,
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let (key, spins) = match exactly_one(("spins", keys.spins), ("wave", keys.wave))? {
        Either::First(spins) => {
            ("spins", spins.into_iter().map(|s| Vector3::from(s.0)).collect::<Vec<_>>())
        }
        Either::Second(Wave { count, turns, cone }) => {
            if count.0 > SPINS_MAX {
                let message = format!("count = {}, expected at most {SPINS_MAX}", count.0);
                return Err(Refusal::at("wave", message).into());
            }
            let (s, c) = cone.0.sin_cos();
            let step = core::f64::consts::TAU * turns.0 / count.0 as f64;
            let spin = |i: u64| {
                let phase = step * i as f64;
                Vector3::new(s * phase.cos(), s * phase.sin(), c)
            };
            ("wave", (0..count.0).map(spin).collect())
        }
    };
    let refused = |error: Error| Refusal::at(key, error.to_string());
    let mut chain = SpinChain::new(spins.len()).map_err(refused)?;
    let start = chain.spins(|i| spins[i]).map_err(refused)?;
    if keys.ring == Some(false) {
        chain = chain.open();
    }
    let (damping, field) =
        (keys.damping.map_or(0.0, |x| x.0), keys.field.map_or([0.0; 3], |x| x.0));
    chain = chain.with_anisotropy(keys.anisotropy.map_or(0.0, |x| x.0))?;
    chain = chain.with_field(field)?.with_damping(damping)?;
    Ok(Box::new(Chain { chain, damped: damping != 0.0, field: field.into(), start }))
}

type Spins<S> = Box<[Vector3<S>]>;

/// The chain, a Lie–Poisson system where nothing damps it.
fn flow<S: Scalar>(chain: SpinChain<S>, damped: bool, start: Spins<S>) -> (OnSpheres<S>, Spins<S>) {
    match damped {
        true => (OnSpheres::new(chain, Linear), start),
        false => (OnSpheres::lie_poisson(chain, Linear), start),
    }
}

impl System for Chain {
    type Problem = OnSpheres<f64>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<(Self::Problem, Box<[Vector3<f64>]>), Error> {
        Ok(flow(self.chain, self.damped, self.start.clone()))
    }
    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        let start = self.start.iter().map(|s| s.map(Counted)).collect();
        let (flow, start) = flow(self.chain.on::<Counted>().ok()?, self.damped, start);
        operations_by(method, &flow, start, pace)
    }
    fn modelled(&self) -> String {
        format!("{} spins on spheres", self.start.len())
    }
    fn state(&self) -> &'static [&'static str] {
        &["spins"]
    }
    fn laws(&self) -> Vec<Law> {
        let mut laws = vec![Law::of_the_action("lengths2", 2)];
        if !self.damped {
            laws.push(Law::of_the_flow("energy", 2).on_scale(Scale::Terms));
            if self.field[0] == 0.0 && self.field[1] == 0.0 {
                laws.push(Law::of_the_flow("total_spin3", 1).on_scale(Scale::Terms));
            }
        }
        laws
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        match quantity.name {
            "spins" => {
                let spin = |i: usize| ["x", "y", "z"].map(|axis| format!("s{i}{axis}"));
                (1..=self.start.len()).flat_map(spin).collect()
            }
            _ => quantity.columns.iter().map(|&column| column.into()).collect(),
        }
    }
    fn show(&self, quantity: &str, _: f64, s: &Box<[Vector3<f64>]>, row: &mut Vec<f64>) {
        let sum = || s.iter().sum::<Vector3<f64>>();
        match quantity {
            "spins" => row.extend(s.iter().flat_map(|s| s.iter())),
            "magnetisation" => row.extend((sum() / s.len() as f64).iter()),
            "energy" => row.push(self.chain.energy(s)),
            "total_spin3" => row.push(sum()[2]),
            _ => row.push(s.iter().map(Vector3::norm_squared).sum()),
        }
    }
    /// Each spin has an energy of some units.
    fn size(&self, _: &str, s: &Box<[Vector3<f64>]>) -> f64 {
        s.iter().map(Vector3::norm_squared).sum::<f64>() * (1.0 + self.field.norm())
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("spins")
    }
}
