//! `kind = "rigid-body-n"`: the free rigid body in ℝⁿ by its momentum, on so(n)*.
//!
//! ṁ = \[m, Ω\], Ω_ij = m_ij/J_ij. f(m) = −Ω; Λ(g, m) = g m gᵀ. Invariants: tr mᵏ for even k (the
//! action), the energy, and for J_ij = λ_i + λ_j Manakov's further integrals.

use super::entries::{above_diagonal, antisymmetric, columns_at};
use super::on_m::check_antisymmetric;
use super::prelude::*;
use crate::problem::SERIES;
use lieflow::dense::multiply;
use lieflow::problems::{RigidBodyN, manakov_integrals};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-body-n",
    equation: "ṁ = [m, Ω], Ω_ij = m_ij/J_ij, with J_ij = λ_i + λ_j for Manakov's body",
    summary: "the free rigid body in n dimensions, by its momentum on so(n)*",
    ..Kind::of::<Keys, Body>(|section| read_with(section, read))
};

keys! { Keys {
    mass_moments: Option<List> = "λ_1 … λ_n of Manakov's body, of inertia λ_i + λ_j in the plane ij",
    inertia: Option<List> = "inertia of each plane 12, 13, …, 1n, 23, …, instead of mass_moments",
    momentum: List = "initial angular momentum in the body, m_12, m_13, …, m_1n, m_23, …",
} }

/// The body with its initial momentum.
#[derive(Clone, Debug)]
struct Body {
    body: RigidBodyN,
    /// λ, of Manakov's.
    lambda: Option<Vec<f64>>,
    momentum: Mat<f64>,
}

type Q = Quantity<Body>;

/// Of larger bodies Manakov's integrals are output where they are asked for, and not watched: they take n⁵
/// operations a row.
const WATCHED: usize = 8;

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let momentum = keys.momentum.and_then(|momentum| {
        let above = momentum.values();
        let message = || {
            format!(
                "found {}, expected n(n-1)/2, such as 3, 6 or 10",
                amount(above.len(), "numbers")
            )
        };
        Ok(antisymmetric(&above).ok_or_else(|| Refusal::at("momentum", message()))?)
    });
    let n = seen(&momentum).map(Mat::nrows);
    let body = body(keys.mass_moments, keys.inertia, n);
    let ((body, lambda), momentum) = all!(body, momentum)?;
    Ok(Forms::of(Body { body, lambda, momentum }))
}

/// The body in n dimensions, and λ of Manakov's.
fn body(
    mass_moments: Key<Option<List>>,
    inertia: Key<Option<List>>,
    n: Result<usize, ReadError>,
) -> Result<(RigidBodyN, Option<Vec<f64>>), ReadError> {
    let which = exactly_one(("mass_moments", mass_moments?), ("inertia", inertia?))?;
    match which {
        Either::First(lambda) => {
            let lambda = lambda.values();
            let wrong = |&(i, j): &(usize, usize)| lambda[i] + lambda[j] <= 0.0;
            if let Some((i, j)) = above_diagonal(lambda.len()).find(wrong) {
                let [first, second] = [i, j].map(|i| "mass_moments".index(i));
                let sum = lambda[i] + lambda[j];
                let message = format!("{first} + {second} = {sum}, expected a number > 0");
                return Err(Refusal::at(second, message).into());
            }
            let n = n?;
            if lambda.len() != n {
                let message = format!(
                    "found {}, expected {n}, as the momentum has {n}·{}/2 numbers",
                    amount(lambda.len(), "numbers"),
                    n - 1
                );
                return Err(Refusal::at("mass_moments", message).into());
            }
            Ok((RigidBodyN::manakov(&lambda)?, Some(lambda)))
        }
        Either::Second(inertia) => Ok((RigidBodyN::from_pairs(n?, &inertia.values())?, None)),
    }
}

impl Body {
    fn n(&self) -> usize {
        self.momentum.nrows()
    }
    /// The degree of the polynomials that the Casimirs and Manakov's integrals are made of. On so(4) tr m⁴ is one of tr m²
    /// and of the Pfaffian, and there is no integral of higher degree; on larger ones there are.
    fn degree(&self) -> u32 {
        if self.n() <= 4 { 2 } else { 0 }
    }
}

impl System for Body {
    type Problem = RigidBodyN;

    const STATE: &'static [&'static str] = &["momentum"];
    const DEFAULT_METHOD: Option<&'static str> = Some(SERIES);
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "momentum",
            &["m12", "…", "m(n-1)n"],
            "angular momentum in the body, plane by plane",
            |body, _, m, row| {
                row.extend(above_diagonal(body.n()).map(|(i, j)| 0.5 * (m[(i, j)] - m[(j, i)])));
            },
        )
        .with_columns(|body| columns_at("m", body.n(), above_diagonal(body.n()))),
        Q::number("energy", "kinetic energy", |body, _, m| body.body.energy(m))
            .kept(Law::by_the_flow(2)),
        Q::numbers(
            "casimirs",
            &["trm2", "…", "trmn"],
            "traces of the even powers of m, up to the n-th",
            |body, _, m, row| {
                let square = multiply(m.as_ref(), m.as_ref());
                let mut power = square.clone();
                for k in (2..=body.n()).step_by(2) {
                    row.push((0..body.n()).map(|i| power[(i, i)]).sum());
                    if k + 2 <= body.n() {
                        power = multiply(power.as_ref(), square.as_ref());
                    }
                }
            },
        )
        .with_columns(|body| (2..=body.n()).step_by(2).map(|k| format!("trm{k}")).collect())
        .kept_where(|body| Some(Law::by_the_action(body.degree()))),
        Q::numbers(
            "manakov_integrals",
            &["integral1", "…", "integralk"],
            "the further integrals of Manakov's body; none for another",
            |body, _, m, row| {
                row.extend(body.lambda.iter().flat_map(|lambda| manakov_integrals(lambda, m)));
            },
        )
        .with_columns(|body| {
            // One for each 1 ≤ j ≤ k − 2 with k − j even, 3 ≤ k ≤ n.
            let count: usize = (3..=body.n()).map(|k| (k - 1) / 2).sum();
            (1..=count).map(|k| format!("integral{k}")).collect()
        })
        .kept_where(|body| (body.n() <= WATCHED).then_some(Law::by_the_flow(body.degree())))
        .missing_where(|body| match body.lambda {
            Some(_) if body.n() > 2 => None,
            Some(_) => Some("a body in two dimensions has none"),
            None => Some("only Manakov's body, that of mass_moments, has them"),
        }),
    ];

    fn problem(&self) -> Result<Start<RigidBodyN>, Error> {
        Ok((self.body.clone(), self.momentum.clone()))
    }
    fn check_state(&self, arg: &str, m: &Mat<f64>) -> Result<(), Error> {
        check_antisymmetric(arg, m)
    }
    fn modelled(&self) -> String {
        format!("momentum on so(n)*, n = {}", self.n())
    }
}
