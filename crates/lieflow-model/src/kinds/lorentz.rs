//! `kind = "lorentz"`: the four-velocity of a charged particle in constant fields, in SO(3,1); see
//! [`ChargedParticle`]. u̇ = (q/(mc)) F u in the particle's proper time, an equation of linear type.

use lieflow::Problem;
use lieflow::dense::{multiply, squared_norm};
use lieflow::groups::{AlgebraMatrix, LieAlgebra, MatrixGroup};
use lieflow::problems::{ChargedParticle, Flow, four_velocity, lorentz_transformation};
use lieflow_runs::spaces::{MatrixAction, OnMatrices};
use nalgebra::Vector3;

use super::on_m::{check_least, check_number};
use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "lorentz",
    equation: "d(γv)/dτ = q/(mc) (γE + γv × cB), dγ/dτ = q/(mc) E·γv, v over c",
    summary: "a charged particle in constant fields, by its four-velocity; t is its proper time",
    ..Kind::of::<Keys, Particle>(|section| read_with(section, read))
};

keys! { Keys {
    charge_to_mass: Real = "charge over mass and the speed of light, q/(mc); charge over mass where units have c = 1",
    electric: Reals<3> = "the electric field",
    magnetic: Reals<3> = "the magnetic field, times the speed of light",
    velocity: Reals<3> = "initial velocity over the speed of light",
} }

/// q/(mc) F, and the initial four-velocity.
#[derive(Clone, Debug)]
struct Particle {
    tensor: AlgebraMatrix,
    start: Mat<f64>,
}

type Q = Quantity<Particle>;

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let Keys { charge_to_mass, electric, magnetic, velocity, .. } = keys;
    let start = velocity.and_then(|velocity| {
        Ok(four_velocity(velocity.0).map_err(|error| Refusal::from(error).about("velocity"))?)
    });
    let (charge_to_mass, electric, magnetic, start) =
        all!(charge_to_mass, electric, magnetic, start)?;
    let (e, b) = (Vector3::from(electric.0), Vector3::from(magnetic.0));
    let particle = ChargedParticle::new(charge_to_mass.0, move |_: f64, _: &Mat<f64>| (e, b))?;
    let mut tensor = particle.group().zero();
    particle.f(0.0, &start, &mut tensor, &mut particle.work());
    Ok(Forms::of(Particle { tensor, start }))
}

/// The square of the four-velocity.
fn mass_shell(u: &Mat<f64>) -> f64 {
    let u = u.col_as_slice(0);
    u[0] * u[0] + u[1] * u[1] + u[2] * u[2] - u[3] * u[3]
}

impl System for Particle {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["four_velocity"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "four_velocity",
            &["u1", "u2", "u3", "gamma"],
            "gamma times the velocity, and gamma",
            |_, _, u, row| row.extend(u.col_as_slice(0)),
        ),
        Q::numbers(
            "velocity",
            &["v1", "v2", "v3"],
            "the velocity over the speed of light",
            |_, _, u, row| row.extend((0..3).map(|i| u[(i, 0)] / u[(3, 0)])),
        ),
        Q::numbers(
            "energy",
            &["gamma_energy"],
            "gamma, the energy over that at rest; kept where there is no electric field",
            |_, _, u, row| row.push(u[(3, 0)]),
        )
        .kept_where(|particle| {
            let magnetic = (0..3).all(|i| particle.tensor[(i, 3)] == 0.0);
            magnetic.then_some(Law::by_the_flow(1))
        }),
        Q::number("mass_shell", "square of the four-velocity, -1", |_, _, u| mass_shell(u))
            .kept(Law::by_the_action(2))
            .in_terms(|_, u| squared_norm(u.as_ref())),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        let tensor = self.tensor.clone();
        let field = move |_: f64, v: &mut AlgebraMatrix| v.copy_from(&*tensor);
        let (group, action) = (MatrixGroup::indefinite(3, 1)?, MatrixAction::Linear);
        Ok((OnMatrices::linear(Flow::of_time(group, action, field), action), self.start.clone()))
    }
    fn check_state(&self, arg: &str, u: &Mat<f64>) -> Result<(), Error> {
        let (square, size) = (mass_shell(u), squared_norm(u.as_ref()));
        check_number(
            format!("the square of {arg}"),
            square,
            -1.0,
            size,
            "that of a four-velocity",
        )?;
        check_least(u[(3, 0)] > 0.0, format!("gamma in {arg}"), u[(3, 0)], "a number > 0")
    }
    fn modelled(&self) -> String {
        "four-velocity, by SO(3,1)".into()
    }
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<Mat<f64>, Error>> {
        let turned = lorentz_transformation(&self.tensor, t1 - t0);
        Some(turned.map(|g| multiply(g.as_ref(), self.start.as_ref())))
    }
    fn figure(&self) -> Figure {
        Figure::Lines("velocity")
    }
}
