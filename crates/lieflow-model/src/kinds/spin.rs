//! `kind = "spin"`: a magnetic moment in a field that turns, an equation of linear type on the sphere.
//!
//! ẋ = ω(t) × x, ω(t) = R₃(Ωt) ω(0). f(t, x) = ω(t); Λ(g, x) = g x. Invariant: |x|.

use lieflow::actions::Linear;
use lieflow::groups::So3;
use lieflow::problems::Flow;
use lieflow::scalar::{Counted, Trig};
use lieflow::so3;
use lieflow_runs::spaces::OnSphere;
use nalgebra::Vector3;

use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "spin",
    equation: "ẋ = ω(t) × x, ω(t) = the field turned about e₃ by rate·t",
    summary: "a magnetic moment in a field that turns about the third axis, on the sphere",
    ..Kind::of::<Keys, Spin>(|section| read_with(section, read))
};

keys! { Keys {
    field: Reals<3> [RATE] = "angular velocity of the precession at t = 0",
    rate: Real [RATE] = "angular velocity at which the field turns",
    moment: Reals<3> = "initial moment",
} }

/// The field and the initial state.
#[derive(Clone, Copy, Debug)]
struct Spin {
    field: Vector3<f64>,
    rate: f64,
    moment: Vector3<f64>,
}

type Q = Quantity<Spin>;

fn read(Keys { field, rate, moment, .. }: Keys) -> Result<Forms, ReadError> {
    let (field, rate, moment) = all!(field, rate, moment)?;
    Ok(Forms::of(Spin { field: field.0.into(), rate: rate.0, moment: moment.0.into() }))
}

impl Spin {
    fn on<S: Trig + 'static>(&self) -> OnSphere<S> {
        let (field, rate) = (self.field.map(S::lit), S::lit(self.rate));
        let omega = move |t: S, v: &mut Vector3<S>| {
            let (s, c) = (rate * t).sin_cos();
            *v = Vector3::new(c * field[0] - s * field[1], s * field[0] + c * field[1], field[2]);
        };
        OnSphere::linear(Flow::of_time(So3::new(), Linear, omega), Linear)
    }
}

impl System for Spin {
    type Problem = OnSphere;

    const STATE: &'static [&'static str] = &["moment"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers("moment", &["x1", "x2", "x3"], "the moment", |_, _, x, row| {
            row.extend(x.iter());
        }),
        Q::number("moment_norm", "length of the moment", |_, _, x| length(x))
            .kept(Law::by_the_action(2)),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn problem(&self) -> Result<Start<OnSphere>, Error> {
        Ok((self.on(), self.moment))
    }
    fn counted(&self) -> Option<Counting> {
        counting(self.on(), self.moment.map(Counted))
    }
    fn modelled(&self) -> String {
        "moment on the sphere".into()
    }
    /// In the frame that turns with the field, Ω = rate·e₃, the field stands still: y = R₃(−Ωt)x moves by
    /// ẏ = (ω(0) − Ω) × y.
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<Vector3<f64>, Error>> {
        let rate = Vector3::new(0.0, 0.0, self.rate);
        let turned = |u: Vector3<f64>, x: Vector3<f64>| so3::exp_on(&u, &x).map_err(Error::from);
        let still = turned(rate * -t0, self.moment);
        let moved = still.and_then(|y| turned((self.field - rate) * (t1 - t0), y));
        Some(moved.and_then(|y| turned(rate * t1, y)))
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("moment")
    }
}
