//! `kind = "spherical-pendulum"`: a point mass on a rod that turns in every direction, on TS² as an orbit of
//! SE(3); see [`SphericalPendulum`].

use lieflow::actions::Coadjoint;
use lieflow::problems::SphericalPendulum;
use lieflow::scalar::Counted;
use lieflow_runs::spaces::OnSe3;
use nalgebra::Vector3;

use super::on_m::{check_number, check_unit};
use super::prelude::*;
use crate::problem::SERIES;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "spherical-pendulum",
    equation: "q̇ = ω × q, ω̇ = −(g/ℓ) q × e₃",
    summary: "the spherical pendulum, by its direction and its angular velocity; e3 points upward",
    ..Kind::of::<Keys, Pendulum>(|section| read_with(section, read))
};

keys! { Keys {
    gravity_over_length: Real = "gravity over the length of the rod",
    direction: Reals<3> = "initial direction of the rod, normalised",
    velocity: Reals<3> = "initial velocity of the direction; its part along the rod is left out",
} }

/// The pendulum with its initial state (ω, q).
#[derive(Clone, Copy, Debug)]
struct Pendulum {
    pendulum: SphericalPendulum,
    /// g/ℓ.
    rate2: f64,
    start: (Vector3<f64>, Vector3<f64>),
}

type Q = Quantity<Pendulum>;

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let Keys { gravity_over_length, direction, velocity, .. } = keys;
    let pendulum = gravity_over_length.and_then(|x| Ok((SphericalPendulum::new(x.0)?, x.0)));
    let refused = |error| Refusal::from(error).about("direction");
    let direction = direction.and_then(|direction| {
        // Any pendulum refuses what is no direction.
        SphericalPendulum::new(0.0)?.state(direction.0, [0.0; 3]).map_err(refused)?;
        Ok(direction)
    });
    let ((pendulum, rate2), direction, velocity) = all!(pendulum, direction, velocity)?;
    let start = pendulum.state(direction.0, velocity.0).map_err(refused)?;
    Ok(Forms::of(Pendulum { pendulum, rate2, start }))
}

impl System for Pendulum {
    type Problem = OnSe3;

    const DEFAULT_METHOD: Option<&'static str> = Some(SERIES);
    const STATE: &'static [&'static str] = &["direction", "omega"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "direction",
            &["q1", "q2", "q3"],
            "direction of the rod",
            |_, _, (_, q), row| row.extend(q.iter()),
        ),
        Q::numbers("omega", &["w1", "w2", "w3"], "angular velocity", |_, _, (omega, _), row| {
            row.extend(omega.iter())
        }),
        Q::number("energy", "energy", |pendulum, _, y| pendulum.pendulum.energy(y))
            .kept(Law::by_the_flow(2))
            .in_terms(|pendulum, (omega, q)| {
                0.5 * omega.norm_squared() + pendulum.rate2.abs() * length(q)
            }),
        Q::number(
            "vertical_momentum",
            "angular momentum about the vertical",
            |_, _, (omega, _)| omega[2],
        )
        .kept(Law::by_the_flow(1))
        .in_terms(|_, (omega, q)| length(omega) * length(q)),
        Q::number("direction_norm2", "square of the length of the direction", |_, _, (_, q)| {
            q.norm_squared()
        })
        .kept(Law::by_the_action(2)),
        Q::number("omega_along", "angular velocity along the rod, 0", |_, _, (omega, q)| {
            omega.dot(q)
        })
        .kept(Law::by_the_action(2))
        .in_terms(|_, (omega, q)| length(omega) * length(q)),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<OnSe3>, Error> {
        Ok((OnSe3::lie_poisson_with_series(self.pendulum, Coadjoint), self.start))
    }
    fn counted(&self) -> Option<Counting> {
        let counted = OnSe3::lie_poisson_with_series(self.pendulum.on::<Counted>(), Coadjoint);
        let start = (self.start.0.map(Counted), self.start.1.map(Counted));
        counting(counted, start)
    }
    fn check_state(
        &self,
        arg: &str,
        (omega, q): &(Vector3<f64>, Vector3<f64>),
    ) -> Result<(), Error> {
        check_unit("the direction", arg, q.norm())?;
        let along = format!("the angular velocity along the rod in {arg}");
        check_number(along, omega.dot(q), 0.0, omega.norm().max(1.0), "that of a point mass")
    }
    fn modelled(&self) -> String {
        "angular velocity and direction on an orbit of SE(3)".into()
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("direction")
    }
}
