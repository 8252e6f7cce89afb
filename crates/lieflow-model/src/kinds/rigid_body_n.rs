//! `kind = "rigid-body-n"`: the free rigid body in ℝⁿ by its momentum, on so(n)*.
//!
//! ṁ = \[m, Ω\], Ω_ij = m_ij/J_ij. f(m) = −Ω; Λ(g, m) = g m gᵀ. Invariants: tr mᵏ for even k (the
//! action), the energy, and for J_ij = λ_i + λ_j Manakov's further integrals.

use faer::Mat;
use lieflow::Error;
use lieflow::problems::{RigidBodyN, manakov_integrals};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo};
use crate::model::Layer;
use crate::scene::values::List;
use crate::scene::{Either, ReadError, Refusal, exactly_one};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-body-n",
    equation: "ṁ = [m, Ω], Ω_ij = m_ij/J_ij, with J_ij = λ_i + λ_j for Manakov's body",
    summary: "the free rigid body in n dimensions, by its momentum on so(n)*",
    keys: &[
        KeyInfo {
            name: "mass_moments",
            meaning: "λ_1 … λ_n of Manakov's body, of inertia λ_i + λ_j in the plane ij",
        },
        KeyInfo {
            name: "inertia",
            meaning: "inertia of each plane 12, 13, …, 1n, 23, …, instead of mass_moments",
        },
        KeyInfo {
            name: "momentum",
            meaning: "initial angular momentum in the body, m_12, m_13, …, m_1n, m_23, …",
        },
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "momentum",
                columns: &["m12", "…", "m(n-1)n"],
                meaning: "angular momentum in the body, plane by plane",
            },
            QuantityInfo { name: "energy", columns: &["energy"], meaning: "kinetic energy" },
            QuantityInfo {
                name: "casimirs",
                columns: &["trm2", "…", "trmn"],
                meaning: "traces of the even powers of m, up to the n-th",
            },
            QuantityInfo {
                name: "manakov_integrals",
                columns: &["integral1", "…", "integralk"],
                meaning: "the further integrals of Manakov's body; none for another",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    mass_moments: Option<List>,
    inertia: Option<List>,
    momentum: List,
}

/// The body with its initial momentum.
#[derive(Clone, Debug)]
struct Body {
    body: RigidBodyN,
    /// λ, of Manakov's.
    lambda: Option<Vec<f64>>,
    momentum: Mat<f64>,
}

/// Manakov's integrals of larger bodies are shown where they are asked for and not watched: they take n⁵
/// operations a row.
const WATCHED: usize = 8;

/// The planes i < j in the order of lists.
fn planes(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |i| (i + 1..n).map(move |j| (i, j)))
}

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let momentum = keys.momentum.values();
    let n = (1..).find(|n| n * (n - 1) / 2 >= momentum.len()).unwrap_or(1);
    if n < 2 || n * (n - 1) / 2 != momentum.len() {
        let message = format!("found {} numbers, expected n(n-1)/2", momentum.len());
        return Err(Refusal::at("momentum", message).into());
    }
    let which = exactly_one(("mass_moments", keys.mass_moments), ("inertia", keys.inertia))?;
    let (body, lambda) = match which {
        Either::First(lambda) => {
            let lambda = lambda.values();
            if lambda.len() != n {
                let message = format!(
                    "found {} numbers, expected {n} for a momentum of n(n-1)/2",
                    lambda.len()
                );
                return Err(Refusal::at("mass_moments", message).into());
            }
            if let Some((i, j)) = planes(n).find(|&(i, j)| lambda[i] + lambda[j] <= 0.0) {
                let message = format!(
                    "mass_moments[{i}] + mass_moments[{j}] = {}, expected a number > 0",
                    lambda[i] + lambda[j]
                );
                return Err(Refusal::at(format!("mass_moments[{j}]"), message).into());
            }
            (RigidBodyN::manakov(&lambda)?, Some(lambda))
        }
        Either::Second(inertia) => (RigidBodyN::from_pairs(n, &inertia.values())?, None),
    };
    let mut m = Mat::zeros(n, n);
    for ((i, j), x) in planes(n).zip(momentum) {
        (m[(i, j)], m[(j, i)]) = (x, -x);
    }
    Ok(Box::new(Body { body, lambda, momentum: m }))
}

impl System for Body {
    type Problem = RigidBodyN;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(RigidBodyN, Mat<f64>), Error> {
        Ok((self.body.clone(), self.momentum.clone()))
    }
    fn modelled(&self) -> String {
        format!("momentum on so(n)*, n = {}", self.momentum.nrows())
    }
    fn state(&self) -> &'static [&'static str] {
        &["momentum"]
    }
    fn laws(&self) -> Vec<Law> {
        let mut laws = vec![Law::of_the_flow("energy", 2), Law::of_the_action("casimirs", 0)];
        if self.lambda.is_some() && self.momentum.nrows() <= WATCHED {
            laws.push(Law::of_the_flow("manakov_integrals", 0));
        }
        laws
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let n = self.momentum.nrows();
        match quantity.name {
            "momentum" => planes(n).map(|(i, j)| format!("m{}{}", i + 1, j + 1)).collect(),
            "casimirs" => (2..=n).step_by(2).map(|k| format!("trm{k}")).collect(),
            // One for each 1 ≤ j ≤ k − 2 with k − j even, 3 ≤ k ≤ n.
            "manakov_integrals" => {
                let of_k = self.lambda.iter().flat_map(|_| 3..=n).map(|k| (k - 1) / 2);
                let count: usize = of_k.sum();
                (1..=count).map(|k| format!("integral{k}")).collect()
            }
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, _: f64, m: &Mat<f64>, row: &mut Vec<f64>) {
        match quantity {
            "momentum" => row.extend(planes(m.nrows()).map(|p| 0.5 * (m[p] - m[(p.1, p.0)]))),
            "energy" => row.push(self.body.energy(m)),
            "casimirs" => {
                let square = m * m;
                let mut power = square.clone();
                for k in (2..=m.nrows()).step_by(2) {
                    row.push((0..m.nrows()).map(|i| power[(i, i)]).sum());
                    if k + 2 <= m.nrows() {
                        power = &power * &square;
                    }
                }
            }
            _ => row.extend(self.lambda.iter().flat_map(|lambda| manakov_integrals(lambda, m))),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Lines("momentum")
    }
}
