//! `kind = "spin-chain"`: the Landau–Lifshitz chain on (S²)ᴺ; see [`SpinChain`].

use lieflow::actions::Linear;
use lieflow::problems::SpinChain;
use lieflow::scalar::{self, Counted};
use nalgebra::Vector3;

use super::flow::OnSpheres;
use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "spin-chain",
    equation: "ṡᵢ = Hᵢ × sᵢ + α (sᵢ × Hᵢ) × sᵢ, Hᵢ = sᵢ₋₁ + sᵢ₊₁ + K (sᵢ)₃ e₃ + B, α the damping",
    summary: "a chain of spins with exchange, anisotropy, a field and damping, on spheres",
    ..Kind::of::<Keys, Chain>(|section| read_with(section, read))
};

keys! { Keys {
    spins: Option<Vec<Reals<3>>> = "initial directions, one row a spin, normalised",
    wave: Option<Wave> = "{count, turns, cone}, instead of spins: count spins at the angle cone to e3, \
                          that turn so often around it along the chain",
    ring: Option<bool> = "are the ends joined? optional, true",
    anisotropy: Option<Real> = "K, > 0 for an easy axis e3; optional, 0",
    field: Option<Reals<3>> = "the field; optional, 0",
    damping: Option<Real> = "Gilbert's damping, at least 0; optional, 0",
} }

read_by_keys! {
    struct Wave {
        count: Whole<2>,
        turns: Real,
        cone: Real,
    }
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

type Q = Quantity<Chain>;

/// The key of the initial spins, and the spins.
fn spins_of(
    spins: Key<Option<Vec<Reals<3>>>>,
    wave: Key<Option<Wave>>,
) -> Result<(&'static str, Vec<Vector3<f64>>), ReadError> {
    match exactly_one(("spins", spins?), ("wave", wave?))? {
        Either::First(spins) => {
            Ok(("spins", spins.into_iter().map(|s| Vector3::from(s.0)).collect()))
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
            Ok(("wave", (0..count.0).map(spin).collect()))
        }
    }
}

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let spins = spins_of(keys.spins, keys.wave).and_then(|(key, spins)| {
        let refused = |error: Error| Refusal::from(error).about(key);
        let chain = SpinChain::new(spins.len()).map_err(refused)?;
        let start = chain.spins(|i| spins[i]).map_err(refused)?;
        Ok((chain, start))
    });
    let Keys { ring, anisotropy, field, damping, .. } = keys;
    let ((mut chain, start), ring, anisotropy, field, damping) =
        all!(spins, ring, anisotropy, field, damping)?;
    if ring == Some(false) {
        chain = chain.open();
    }
    let (damping, field) = (damping.map_or(0.0, |x| x.0), field.map_or([0.0; 3], |x| x.0));
    chain = chain.with_anisotropy(anisotropy.map_or(0.0, |x| x.0))?;
    chain = chain.with_field(field)?.with_damping(damping)?;
    Ok(Forms::of(Chain { chain, damped: damping != 0.0, field: field.into(), start }))
}

impl Chain {
    /// A Lie–Poisson system where nothing damps it.
    fn on<S: scalar::Real + 'static>(&self) -> Result<OnSpheres<S>, Error> {
        let chain = self.chain.on::<S>()?;
        Ok(match self.damped {
            true => OnSpheres::new(chain, Linear),
            false => OnSpheres::lie_poisson(chain, Linear),
        })
    }
    /// The size of the terms of sums over the chain: each spin has an energy of some units.
    fn size(&self, s: &[Vector3<f64>]) -> f64 {
        sum_of_squares(s) * (1.0 + self.field.norm())
    }
}

fn sum(spins: &[Vector3<f64>]) -> Vector3<f64> {
    spins.iter().sum()
}
fn sum_of_squares(spins: &[Vector3<f64>]) -> f64 {
    spins.iter().map(Vector3::norm_squared).sum()
}

impl System for Chain {
    type Problem = OnSpheres;

    const STATE: &'static [&'static str] = &["spins"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "spins",
            &["s1x", "s1y", "s1z", "…", "sNz"],
            "the spins, one after the other",
            |_, _, s, row| row.extend(s.iter().flat_map(|s| s.iter())),
        )
        .with_columns(|chain| {
            let spin = |i: usize| ["x", "y", "z"].map(|axis| format!("s{i}{axis}"));
            (1..=chain.start.len()).flat_map(spin).collect()
        }),
        Q::numbers("magnetisation", &["mx", "my", "mz"], "mean of the spins", |_, _, s, row| {
            row.extend((sum(s) / s.len() as f64).iter());
        }),
        Q::number("energy", "energy", |chain, _, s| chain.chain.energy(s))
            .kept_where(|chain| law_of(&chain.chain, "energy"))
            .in_terms(|chain, s| chain.size(s)),
        Q::number("total_spin3", "sum of the third components", |_, _, s| sum(s)[2])
            .kept_where(|chain| law_of(&chain.chain, "Σ(s_i)₃"))
            .in_terms(|chain, s| chain.size(s)),
        Q::number("lengths2", "sum of the squares of the lengths", |_, _, s| sum_of_squares(s))
            .kept_where(|chain| law_of(&chain.chain, "Σ|s_i|²")),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<OnSpheres>, Error> {
        Ok((self.on()?, self.start.clone()))
    }
    fn counted(&self) -> Option<Counting> {
        let start = self.start.iter().map(|s| s.map(Counted)).collect();
        counting(self.on().ok()?, start)
    }
    fn modelled(&self) -> String {
        format!("{} spins on spheres", self.start.len())
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("spins")
    }
}
