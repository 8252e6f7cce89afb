//! `kind = "heavy-top"`: a rigid body that turns about a fixed point under gravity, by its momentum μ and
//! the vertical γ in the body, on se(3)*; see [`HeavyTop`].

use lieflow::actions::Coadjoint;
use lieflow::problems::{HeavyTop, Invariants};
use nalgebra::Vector3;

use super::body::{check_unit, momentum_body};
use super::flow::OnSe3;
use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "heavy-top",
    equation: "μ̇ = μ × ω + γ × w, γ̇ = γ × ω, μ = Jω, γ upward, w the weight, all in the body",
    summary: "the heavy top about a fixed point, by its momentum and the vertical in the body",
    ..Kind::of::<Keys, Top>(read)
};

keys! { Keys {
    inertia: Reals<3> = "principal moments of inertia about the fixed point [J1, J2, J3]",
    weight: Reals<3> = "weight times the vector from the fixed point to the centre of mass, in the body",
    omega_body: Option<Reals<3>> = "initial angular velocity in the body",
    momentum_body: Option<Reals<3>> = "initial angular momentum in the body, instead of omega_body",
    vertical: Reals<3> = "initial direction upward in the body, of length 1",
} }

/// The top with its initial state (μ, γ).
#[derive(Clone, Copy, Debug)]
struct Top {
    top: HeavyTop,
    inertia: [f64; 3],
    weight: Vector3<f64>,
    start: Point,
}

type Point = (Vector3<f64>, Vector3<f64>);

type Q = Quantity<Top>;

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let top = HeavyTop::new(keys.inertia.0, keys.weight.0)?;
    let inertia = keys.inertia.0;
    let momentum = momentum_body(inertia, None, keys.omega_body, keys.momentum_body)?;
    let vertical = Vector3::from(keys.vertical.0);
    let length = vertical.norm();
    check_unit("vertical", length)?;
    let start = (momentum, vertical / length);
    Ok(Box::new(Stated(Top { top, inertia, weight: keys.weight.0.into(), start })))
}

impl Top {
    fn invariant(&self, y: &Point, i: usize) -> f64 {
        self.top.problem().values(y)[i]
    }
    /// Is there a fourth integral?
    fn is_integrable(&self) -> bool {
        self.top.problem().invariants().len() > 3
    }
}

impl System for Top {
    type Problem<N: Number> = OnSe3<N>;

    const STATE: &'static [&'static str] = &["momentum_body", "vertical"];
    const QUANTITIES: &'static [Quantity<Self>] = &[
        Q::numbers(
            "momentum_body",
            &["m1", "m2", "m3"],
            "angular momentum in the body",
            |_, _, (mu, _), row| row.extend(mu.iter()),
        ),
        Q::numbers(
            "omega_body",
            &["w1", "w2", "w3"],
            "angular velocity in the body",
            |top, _, (mu, _), row| row.extend(top.top.omega(mu).iter()),
        ),
        Q::numbers(
            "vertical",
            &["v1", "v2", "v3"],
            "the direction upward in the body",
            |_, _, (_, gamma), row| row.extend(gamma.iter()),
        ),
        Q::number("energy", "kinetic and potential energy", |top, _, y| top.invariant(y, 0))
            .kept(Law::by_the_flow(2))
            .in_terms(|top, (mu, gamma)| {
                mu.dot(&top.top.omega(mu)) + top.weight.norm() * gamma.norm()
            }),
        Q::number("vertical_norm2", "square of the length of the vertical", |top, _, y| {
            top.invariant(y, 1)
        })
        .kept(Law::by_the_action(2)),
        Q::number("momentum_vertical", "angular momentum about the vertical", |top, _, y| {
            top.invariant(y, 2)
        })
        .kept(Law::by_the_action(2))
        .in_terms(|_, (mu, gamma)| mu.norm() * gamma.norm()),
        Q::number(
            "integral",
            "the fourth integral of Euler's, Lagrange's and Kovalevskaya's top; others have none",
            |top, _, y| top.invariant(y, 3),
        )
        .kept(Law::by_the_flow(0))
        .missing_where(|top| {
            const NONE: &str =
                "only Euler's, Lagrange's and Kovalevskaya's top have a fourth integral";
            (!top.is_integrable()).then_some(NONE)
        }),
    ];

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem<N: Number>(&self) -> Result<Start<Self::Problem<N>>, Error> {
        let top = HeavyTop::<N>::new(self.inertia, self.weight.into())?;
        let start = (self.start.0.map(N::lit), self.start.1.map(N::lit));
        Ok((OnSe3::lie_poisson(top.problem(), Coadjoint), start))
    }
    fn modelled(&self) -> String {
        "momentum and vertical on se(3)*".into()
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("vertical")
    }
}
