//! `kind = "rigid-bodies"`: many free rigid bodies as one system, by their momenta on so(3)* × … × so(3)*.
//!
//! f_i = −J_i⁻¹m_i; Λ = SO(3)ᴺ on vectors, which on so(3)* is the coadjoint action. Invariants: the energy
//! and |m| of each.

use lieflow::actions::Linear;
use lieflow::groups::{Power, So3};
use lieflow::problems::inertia::impossible;
use lieflow::problems::{Euler, Exact, Kinetic, RigidBody};
use lieflow::scalar::{Counted, Trig};
use lieflow_runs::schema::{Component, Measure};
use lieflow_runs::spaces::OnSpheres;
use nalgebra::{Matrix3, Vector3};

use super::prelude::*;
use crate::problem::part;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "rigid-bodies",
    equation: "ṁᵢ = mᵢ × Jᵢ⁻¹mᵢ, each in its body",
    summary: "many free rigid bodies as one system, by their momenta",
    ..Kind::of::<Keys, Bodies>(|section| read_with(section, read))
};

keys! { Keys {
    bodies: Vec<BodyKeys> = "a list of {inertia = [J1, J2, J3], momentum_body = [m1, m2, m3]}",
} }

read_by_keys! {
    struct BodyKeys {
        inertia: Key<Reals<3>>,
        momentum_body: Key<Reals<3>>,
    }
}

type Momenta<S = f64> = Box<[Vector3<S>]>;

/// The bodies with their initial momenta.
#[derive(Clone, Debug)]
struct Bodies {
    bodies: Vec<RigidBody>,
    inertia: Vec<[f64; 3]>,
    start: Momenta,
}

type Q = Quantity<Bodies>;

fn read(Keys { bodies: keys, .. }: Keys) -> Result<Forms, ReadError> {
    let keys = keys?;
    if keys.is_empty() {
        return Err(Refusal::at("bodies", "no bodies, expected at least one").into());
    }
    let mut mistakes = ReadError::default();
    let (mut bodies, mut inertia, mut start) = (Vec::new(), Vec::new(), Vec::new());
    for (i, BodyKeys { inertia: moments, momentum_body }) in keys.into_iter().enumerate() {
        let body = moments.and_then(|Reals(moments)| {
            let refused = |error| Refusal::in_table(&"bodies".index(i), error);
            Ok((RigidBody::new(moments).map_err(refused)?, moments))
        });
        if let Some(((body, moments), Reals(m))) = mistakes.keep(all!(body, momentum_body)) {
            bodies.push(body);
            inertia.push(moments);
            start.push(m.into());
        }
    }
    mistakes.or(Some(()))?;
    let start = start.into();
    Ok(Forms::of(Bodies { bodies, inertia, start }))
}

impl Bodies {
    /// A column of each body.
    fn each<T>(&self, column: impl FnMut(usize) -> T) -> impl Iterator<Item = T> {
        (1..=self.bodies.len()).map(column)
    }

    /// The problem on these numbers.
    fn on<S: Trig + 'static>(&self) -> Result<OnSpheres<S>, Error> {
        let bodies = self.inertia.iter().map(|inertia| RigidBody::<S>::new(*inertia));
        let bodies = bodies.collect::<Result<Vec<_>, _>>()?;
        let omega = move |m: &Momenta<S>, xi: &mut Momenta<S>| {
            for ((body, m), xi) in bodies.iter().zip(m).zip(xi) {
                *xi = body.omega(m);
            }
        };
        let group = Power::new(So3::new(), self.bodies.len())?;
        Ok(OnSpheres::lie_poisson(Euler::new(group, Kinetic(omega)), Linear))
    }
}

impl System for Bodies {
    type Problem = OnSpheres;

    const STATE: &'static [&'static str] = &["momentum_body"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "momentum_body",
            &["m1_1", "m1_2", "m1_3", "…", "mN_3"],
            "angular momenta in the bodies, one after the other",
            |_, _, m, row| row.extend(m.iter().flat_map(|m| m.iter())),
        )
        .of_dimension(Dimension::ANGULAR_MOMENTUM)
        .with_columns(|bodies| {
            bodies.each(|i| [1, 2, 3].map(|axis| format!("m{i}_{axis}"))).flatten().collect()
        })
        .in_parts(|bodies| {
            let of = |i| part(&format!("body {i}"), 3 * (i - 1), 3, Measure::Length);
            bodies.each(|i| Component { what: "momentum of", ..of(i) }).collect()
        }),
        Q::numbers(
            "energy",
            &["energy1", "…", "energyN"],
            "kinetic energy of each",
            |bodies, _, m, row| {
                row.extend(bodies.bodies.iter().zip(m).map(|(body, m)| body.energy(m)));
            },
        )
        .of_dimension(Dimension::ENERGY)
        .with_columns(|bodies| bodies.each(|i| format!("energy{i}")).collect())
        .kept(Law::by_the_flow(2)),
        Q::numbers(
            "momentum_norm",
            &["norm1", "…", "normN"],
            "length of the angular momentum of each",
            |_, _, m, row| row.extend(m.iter().map(Vector3::norm)),
        )
        .of_dimension(Dimension::ANGULAR_MOMENTUM)
        .with_columns(|bodies| bodies.each(|i| format!("norm{i}")).collect())
        .kept(Law::by_the_action(2)),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<OnSpheres>, Error> {
        Ok((self.on()?, self.start.clone()))
    }
    fn counted(&self) -> Option<Counting> {
        let start = self.start.iter().map(|m| m.map(Counted)).collect();
        counting(self.on().ok()?, start)
    }
    fn warnings(&self) -> Vec<String> {
        let all = self.inertia.iter().enumerate();
        all.filter_map(|(i, inertia)| {
            let key = "bodies".index(i);
            impossible(*inertia).map(|why| format!("{key}.inertia: {why}"))
        })
        .collect()
    }
    fn modelled(&self) -> String {
        format!("momenta of {} bodies", self.bodies.len())
    }
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<Momenta, Error>> {
        let bodies = self.inertia.iter().zip(&self.start);
        let moved = bodies.map(|(inertia, m)| {
            Exact::new(*inertia, (*m).into(), Matrix3::identity())?.momentum_body(t1 - t0)
        });
        Some(moved.collect())
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("momentum_body")
    }
}
