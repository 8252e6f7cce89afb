//! `kind = "kirchhoff"`: a rigid body in an ideal fluid. Euler's equations on se(3)* with the kinetic energy
//! H(μ, π) = ½ μ·J⁻¹μ + ½ π·M⁻¹π, J and M diagonal.
//!
//! Source: H. Lamb, Hydrodynamics, chapter 6.

use lieflow::actions::Coadjoint;
use lieflow::groups::Se3;
use lieflow::problems::{Euler, Kinetic};
use lieflow::scalar::{Counted, Trig};
use lieflow_runs::spaces::OnSe3;
use nalgebra::Vector3;

use super::prelude::*;
use crate::problem::SERIES;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "kirchhoff",
    equation: "μ̇ = μ × ω + π × v, π̇ = π × ω, μ = Jω, π = Mv, all in the body",
    summary: "a body in an ideal fluid, by its angular and linear momentum on se(3)*",
    ..Kind::of::<Keys, Body>(|section| read_with(section, read))
};

keys! { Keys {
    inertia: Reals<3> [INERTIA] = "moments of inertia about its axes, with the fluid that is moved",
    mass: Reals<3> [MASS] = "masses along its axes, with the fluid that is moved",
    angular_momentum: Reals<3> [ANGULAR_MOMENTUM] = "initial angular momentum in the body",
    linear_momentum: Reals<3> [MOMENTUM] = "initial linear momentum in the body",
} }

/// The body with its initial momenta (μ, π).
#[derive(Clone, Copy, Debug)]
struct Body {
    inertia: Vector3<f64>,
    mass: Vector3<f64>,
    start: Momenta<f64>,
}

type Momenta<S> = (Vector3<S>, Vector3<S>);

type Q = Quantity<Body>;

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let positive = |name: &str, key: Key<Reals<3>>| {
        key.and_then(|Reals(x)| {
            let (mut mistakes, expected) = (ReadError::default(), "a finite number > 0");
            for (i, x) in x.into_iter().enumerate() {
                let good = |x: f64| x > 0.0 && x.recip().is_finite();
                mistakes.keep(Real(x).checked(&name.index(i), expected, good));
            }
            mistakes.or(Some(Vector3::from(x)))
        })
    };
    let Keys { inertia, mass, angular_momentum, linear_momentum, .. } = keys;
    let (inertia, mass) = (positive("inertia", inertia), positive("mass", mass));
    let (inertia, mass, mu, pi) = all!(inertia, mass, angular_momentum, linear_momentum)?;
    Ok(Forms::of(Body { inertia, mass, start: (mu.0.into(), pi.0.into()) }))
}

impl Body {
    fn on<S: Trig + Into<f64> + 'static>(&self) -> OnSe3<S> {
        let [inertia, mass] = [self.inertia, self.mass].map(|x| x.map(S::lit));
        let velocities = move |(mu, pi): &Momenta<S>, u: &mut Momenta<S>| {
            *u = (mu.zip_map(&inertia, |m, j| m / j), pi.zip_map(&mass, |p, m| p / m));
        };
        let system = Euler::new(Se3::new(), Kinetic(velocities));
        OnSe3::lie_poisson_with_series(system, Coadjoint)
    }
}

impl System for Body {
    type Problem = OnSe3;

    const DEFAULT_METHOD: Option<&'static str> = Some(SERIES);
    const STATE: &'static [&'static str] = &["angular_momentum", "linear_momentum"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "angular_momentum",
            &["m1", "m2", "m3"],
            "angular momentum in the body",
            |_, _, (mu, _), row| row.extend(mu.iter()),
        )
        .of_dimension(Dimension::ANGULAR_MOMENTUM),
        Q::numbers(
            "linear_momentum",
            &["p1", "p2", "p3"],
            "linear momentum in the body",
            |_, _, (_, pi), row| row.extend(pi.iter()),
        )
        .of_dimension(Dimension::MOMENTUM),
        Q::number("energy", "kinetic energy", |body, _, (mu, pi)| {
            let twice = mu.dot(&mu.component_div(&body.inertia));
            0.5 * (twice + pi.dot(&pi.component_div(&body.mass)))
        })
        .of_dimension(Dimension::ENERGY)
        .kept(Law::by_the_flow(2)),
        Q::number(
            "linear_norm2",
            "square of the length of the linear momentum",
            |_, _, (_, pi)| pi.norm_squared(),
        )
        .kept(Law::by_the_action(2)),
        Q::number("momenta_product", "product of the two momenta", |_, _, (mu, pi)| mu.dot(pi))
            .kept(Law::by_the_action(2))
            .in_terms(|_, (mu, pi)| length(mu) * length(pi)),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<OnSe3>, Error> {
        Ok((self.on(), self.start))
    }
    fn counted(&self) -> Option<Counting> {
        let (mu, pi) = self.start;
        counting(self.on(), (mu.map(Counted), pi.map(Counted)))
    }
    fn modelled(&self) -> String {
        "angular and linear momentum on se(3)*".into()
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("linear_momentum")
    }
}
