//! `kind = "kirchhoff"`: Kirchhoff's equations of a body in an ideal fluid, Euler's equations on se(3)*.
//!
//! H(μ, π) = ½ μ·J⁻¹μ + ½ π·M⁻¹π with J and M diagonal; μ̇ = μ × ω + π × v, π̇ = π × ω, ω = J⁻¹μ,
//! v = M⁻¹π. f = −(ω, v); Λ coadjoint. Invariants: H, |π|² and μ·π (the Casimirs).
//! Source: H. Lamb, Hydrodynamics, chapter 6.

use lieflow::actions::Coadjoint;
use lieflow::groups::Se3;
use lieflow::problems::{Euler, Kinetic};
use nalgebra::Vector3;

use super::body::check_each;
use super::flow::OnSe3;
use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "kirchhoff",
    equation: "μ̇ = μ × ω + π × v, π̇ = π × ω, μ = Jω, π = Mv, all in the body",
    summary: "a body in an ideal fluid, by its angular and linear momentum on se(3)*",
    keys: Keys::INFO,
    quantities: quantities_of::<Body>,
    read,
};

keys! { Keys {
    inertia: Reals<3> = "moments of inertia about its axes, with the fluid that is moved",
    mass: Reals<3> = "masses along its axes, with the fluid that is moved",
    angular_momentum: Reals<3> = "initial angular momentum in the body",
    linear_momentum: Reals<3> = "initial linear momentum in the body",
} }

/// (μ, π).
type Point<N = f64> = (Vector3<N>, Vector3<N>);

/// The body with its initial momenta.
#[derive(Clone, Copy, Debug)]
struct Body {
    inertia: Vector3<f64>,
    mass: Vector3<f64>,
    start: Point,
}

type Q = Quantity<Body>;

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    for (key, list) in [("inertia", keys.inertia.0), ("mass", keys.mass.0)] {
        check_each(key, &list, "a finite number > 0", |x| x > 0.0 && x.recip().is_finite())?;
    }
    Ok(Box::new(Stated(Body {
        inertia: keys.inertia.0.into(),
        mass: keys.mass.0.into(),
        start: (keys.angular_momentum.0.into(), keys.linear_momentum.0.into()),
    })))
}

impl System for Body {
    type Problem<N: Number> = OnSe3<N>;

    const STATE: &'static [&'static str] = &["angular_momentum", "linear_momentum"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "angular_momentum",
            &["m1", "m2", "m3"],
            "angular momentum in the body",
            |_, _, (mu, _), row| row.extend(mu.iter()),
        ),
        Q::numbers(
            "linear_momentum",
            &["p1", "p2", "p3"],
            "linear momentum in the body",
            |_, _, (_, pi), row| row.extend(pi.iter()),
        ),
        Q::number("energy", "kinetic energy", |body, _, (mu, pi)| {
            let (omega, v) = (mu.component_div(&body.inertia), pi.component_div(&body.mass));
            0.5 * (mu.dot(&omega) + pi.dot(&v))
        })
        .kept(Law::by_the_flow(2)),
        Q::number(
            "linear_norm2",
            "square of the length of the linear momentum",
            |_, _, (_, pi)| pi.norm_squared(),
        )
        .kept(Law::by_the_action(2)),
        Q::number("momenta_product", "product of the two momenta", |_, _, (mu, pi)| mu.dot(pi))
            .kept(Law::by_the_action(2))
            .in_terms(|_, (mu, pi)| mu.norm() * pi.norm()),
    ];

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem<N: Number>(&self) -> Result<Start<OnSe3<N>>, Error> {
        let lit = |x: Vector3<f64>| x.map(N::lit);
        let (inertia, mass) = (lit(self.inertia), lit(self.mass));
        let velocities = move |(mu, pi): &Point<N>, xi: &mut Point<N>| {
            *xi = (mu.zip_map(&inertia, |m, j| m / j), pi.zip_map(&mass, |p, m| p / m));
        };
        let start = (lit(self.start.0), lit(self.start.1));
        Ok((OnSe3::lie_poisson(Euler::new(Se3::new(), Kinetic(velocities)), Coadjoint), start))
    }
    fn modelled(&self) -> String {
        "angular and linear momentum on se(3)*".into()
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("linear_momentum")
    }
}
