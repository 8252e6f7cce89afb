//! `kind = "heavy-top"`: a rigid body that turns about a fixed point under gravity; see [`HeavyTop`].
//!
//! | asked for | M | point |
//! |---|---|---|
//! | neither its attitude nor what follows from it | se(3)* | the momentum μ and the vertical γ in the body |
//! | its attitude | SO(3) × ℝ³ | the attitude g and the momentum in space, a [`TorqueBody`] |

use core::fmt::Debug;
use core::marker::PhantomData;

use lieflow::actions::Coadjoint;
use lieflow::problems::{HeavyTop, TorqueBody};
use lieflow::scalar::{Counted, Trig};
use lieflow_runs::spaces::{Driven, OnSe3};
use nalgebra::{Matrix3, Vector3};

use super::body::*;
use super::driven_body::{self, Torques};
use super::on_m;
use super::prelude::*;
use crate::problem::{PointOf, Runnable, Turned};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "heavy-top",
    equation: "μ̇ = μ × ω + γ × w, γ̇ = γ × ω, μ = Jω, γ upward, w the weight, all in the body; ġ = gω̂, gγ = e3",
    summary: "the heavy top about a fixed point, by its momentum and the vertical in the body, or by its attitude",
    ..Kind::of::<Keys, Top<WithAttitude>>(|section| read_with(section, read))
};

keys! { Keys [attitude_keys body_keys] {
    weight: Reals<3> [TORQUE] = "weight times the vector from the fixed point to the centre of mass, in the body",
    vertical: Option<Reals<3>> =
        "initial direction upward in the body, of length 1, instead of attitude: the attitude is then the least turn \
         that brings it to e3",
} }

/// The top with its initial state; vectors along its principal axes.
#[derive(Clone, Debug)]
struct TopSpec {
    body: RigidBodySpec,
    top: HeavyTop,
    weight: Vector3<f64>,
    vertical: Vector3<f64>,
}

/// The distance that `vertical` and `attitude` may have from each other.
const AGREED: f64 = 1e-6;
/// What is nearer is the same.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let (body, attitude, mut notes) = (keys.body_keys(), keys.attitude_keys(), Vec::new());
    let vertical = keys.vertical.and_then(|vertical| {
        let Some(vertical) = vertical else { return Ok(None) };
        check_unit("vertical", &vertical.0, &mut notes)?;
        let vertical = Vector3::from(vertical.0);
        Ok(Some(vertical / vertical.norm()))
    });
    let stands = match &vertical {
        Ok(None) if !attitude.has_attitude() => {
            let message = "expected `vertical`, `attitude` or `quaternion`, or Euler angles, found none of them";
            Err(Refusal::section(message))
        }
        _ => Ok(()),
    };
    let has_attitude = attitude.has_attitude();
    let upright = vertical.as_ref().ok().and_then(|vertical| vertical.map(upright));
    let (body, weight) =
        (body.start(&attitude, upright.unwrap_or_else(Matrix3::identity)), keys.weight);
    let (stated, (), mut body, weight) = all!(vertical, stands, body, weight)?;
    let of_attitude = body.attitude.row(2).transpose();
    let stated = stated.map_or(of_attitude, |vertical| body.along_axes(vertical));
    let apart = (stated - of_attitude).norm();
    if apart > AGREED {
        let message = format!("vertical is {apart:.1e} from the third row of the attitude");
        let help = Some("leave one of the two out".into());
        return Err(Refusal { help, ..Refusal::at("vertical", message) }.into());
    }
    // The attitude counts, in each form of the problem.
    let vertical = if has_attitude { of_attitude } else { stated };
    if has_attitude && apart > ROUNDING {
        notes.push(format!(
            "vertical: it is {apart:.1e} from the third row of the attitude, which is taken"
        ));
    }
    let weight = body.along_axes(weight.0.into());
    body.notes.extend(notes);
    let top = HeavyTop::new(body.inertia, weight.into())?;
    let spec = TopSpec { body, top, weight, vertical };
    let (momentum, attitude) =
        (spec.clone().by::<MomentumAndVertical>(), spec.by::<WithAttitude>());
    // The figure needs the attitude.
    Ok(Forms::of(momentum).or(Forms::of(attitude)).written(WithAttitude::STATE))
}

/// The least turn that brings a direction v to e₃: 𝟙 + a + a²/(1 + v₃), a the matrix of v × e₃.
///
/// v is its third row, to rounding. So a small tilt has all its digits.
fn upright(v: Vector3<f64>) -> Matrix3<f64> {
    let [x, y, z] = v.into();
    let tilt = x * x + y * y;
    // 1/(1 + z), and below the equator (1 − z)/(1 − z²).
    let k = match z < 0.0 {
        true if tilt == 0.0 => return Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)),
        true => (1.0 - z) / tilt,
        false => 1.0 / (1.0 + z),
    };
    Matrix3::new(1.0 - x * x * k, -x * y * k, -x, -x * y * k, 1.0 - y * y * k, -y, x, y, z)
}

/// A top at a point.
struct Pose {
    mu: Vector3<f64>,
    gamma: Vector3<f64>,
    orientation: Orientation,
}

/// A way to represent the state of a top.
trait TopCoordinates: Clone + Debug + Send + Sync + 'static {
    /// The problem of the library.
    type Problem: Runnable;
    /// What is integrated, in words.
    const MODELLED: &'static str;
    /// The quantities that make up the state.
    const STATE: &'static [&'static str];
    /// Is the attitude a part of the point?
    const TURNS: bool;
    /// The laws of the energy, of |γ|² and of μ·γ.
    const LAWS: [Law; 3];

    /// The problem with its parameters.
    ///
    /// # Errors
    /// What the library refuses.
    fn problem(spec: &TopSpec) -> Result<Self::Problem, Error>;
    /// The point at this attitude, momentum and vertical, the latter two in the body.
    fn point(g: Matrix3<f64>, mu: Vector3<f64>, gamma: Vector3<f64>) -> Point<Self>;
    /// See [`System::counted`].
    fn counted(spec: &TopSpec, start: Point<Self>) -> Option<Counting>;
    /// The pose of a point.
    fn pose(y: &Point<Self>) -> Pose;
    /// The point with the axes of the body turned by this rotation.
    fn turned(y: &Point<Self>, turn: &Matrix3<f64>) -> Point<Self>;
    /// See [`System::check_state`].
    fn check_state(_arg: &str, _y: &Point<Self>) -> Result<(), Error> {
        Ok(())
    }
    /// The momentum about the vertical.
    fn about_vertical(top: &HeavyTop, y: &Point<Self>) -> f64 {
        let Pose { mu, gamma, .. } = Self::pose(y);
        top.casimirs(&(mu, gamma))[1]
    }
}

type Point<R> = lieflow::problems::PointOf<<R as TopCoordinates>::Problem>;

/// μ and γ.
#[derive(Clone, Debug)]
struct MomentumAndVertical;

impl TopCoordinates for MomentumAndVertical {
    type Problem = OnSe3;
    const MODELLED: &'static str = "momentum and vertical on se(3)*";
    const STATE: &'static [&'static str] = &["momentum_body", "vertical"];
    const TURNS: bool = false;
    const LAWS: [Law; 3] = [Law::by_the_flow(2), Law::by_the_action(2), Law::by_the_action(2)];

    fn problem(spec: &TopSpec) -> Result<OnSe3, Error> {
        Ok(OnSe3::lie_poisson_with_series(spec.top.problem(), Coadjoint))
    }
    fn point(_: Matrix3<f64>, mu: Vector3<f64>, gamma: Vector3<f64>) -> Point<Self> {
        (mu, gamma)
    }
    fn counted(spec: &TopSpec, (mu, gamma): Point<Self>) -> Option<Counting> {
        let top = HeavyTop::<Counted>::new(spec.body.inertia, spec.weight.into()).ok()?;
        let (top, start) = (top.problem(), (mu.map(Counted), gamma.map(Counted)));
        counting(OnSe3::lie_poisson_with_series(top, Coadjoint), start)
    }
    fn pose(&(mu, gamma): &Point<Self>) -> Pose {
        Pose { mu, gamma, orientation: Orientation::NotModelled }
    }
    fn turned((mu, gamma): &Point<Self>, turn: &Matrix3<f64>) -> Point<Self> {
        (turn * mu, turn * gamma)
    }
    fn check_state(arg: &str, (_, gamma): &Point<Self>) -> Result<(), Error> {
        on_m::check_unit("the vertical", arg, gamma.norm())
    }
}

/// g and the momentum in space.
#[derive(Clone, Debug)]
struct WithAttitude;

impl TopCoordinates for WithAttitude {
    type Problem = Driven;
    const MODELLED: &'static str = "attitude and momentum in space; torques: gravity";
    const STATE: &'static [&'static str] = &["attitude", "momentum_space"];
    const TURNS: bool = true;
    const LAWS: [Law; 3] = [Law::by_the_flow(0), Law::by_the_action(2), Law::by_the_flow(1)];

    fn problem(spec: &TopSpec) -> Result<Driven, Error> {
        under_gravity(spec)
    }
    fn point(g: Matrix3<f64>, mu: Vector3<f64>, _: Vector3<f64>) -> Point<Self> {
        (g, (g * mu))
    }
    fn counted(spec: &TopSpec, (g, m): Point<Self>) -> Option<Counting> {
        let counted = under_gravity::<Counted>(spec).ok()?;
        counting(counted, (g.map(Counted), m.map(Counted)))
    }
    fn pose((g, m): &Point<Self>) -> Pose {
        let gamma = g.row(2).transpose();
        Pose { mu: g.tr_mul(m), gamma, orientation: Orientation::Matrix(*g) }
    }
    fn turned(y: &Point<Self>, turn: &Matrix3<f64>) -> Point<Self> {
        driven_body::turned(y, turn)
    }
    /// Linear in the point, so that methods that leave the group keep it too.
    fn about_vertical(_: &HeavyTop, (_, m): &Point<Self>) -> f64 {
        m[2]
    }
}

/// The top as a body that its weight turns.
fn under_gravity<S: Trig + Into<f64> + 'static>(spec: &TopSpec) -> Result<Driven<S>, Error> {
    let torques = Torques::of_weight(spec.weight);
    let body = TorqueBody::new(spec.body.inertia, torques.clone())?;
    Ok(driven_body::on(&body, &torques))
}

/// A top in one representation.
#[derive(Clone, Debug)]
struct Top<R> {
    spec: TopSpec,
    representation: PhantomData<R>,
}

type Q<R> = Quantity<Top<R>>;

impl TopSpec {
    fn by<R>(self) -> Top<R> {
        Top { spec: self, representation: PhantomData }
    }
}

impl<R: TopCoordinates> Top<R> {
    /// μ and γ.
    fn momentum_and_vertical(y: &PointOf<Self>) -> (Vector3<f64>, Vector3<f64>) {
        let Pose { mu, gamma, .. } = R::pose(y);
        (mu, gamma)
    }
    /// Why there is no fourth integral.
    fn without_integral(&self) -> Option<&'static str> {
        const NONE: &str = "only Euler's, Lagrange's and Kovalevskaya's top have a fourth integral";
        (!self.spec.top.is_integrable()).then_some(NONE)
    }
}

impl<R: TopCoordinates> Oriented for Top<R> {
    fn orientation(&self, y: &PointOf<Self>) -> Orientation {
        R::pose(y).orientation
    }
    fn turning(&self, _: f64, y: &PointOf<Self>) -> Vector3<f64> {
        self.omega(y)
    }
    fn without_orientation(&self) -> Option<&'static str> {
        (!R::TURNS).then_some("the momentum and the vertical alone are integrated")
    }
    fn axes(&self) -> Option<Matrix3<f64>> {
        self.spec.body.axes
    }
}

impl<R: TopCoordinates> AsBody for Top<R> {
    fn momentum(&self, y: &PointOf<Self>) -> Vector3<f64> {
        R::pose(y).mu
    }
    fn omega(&self, y: &PointOf<Self>) -> Vector3<f64> {
        self.spec.top.omega(&R::pose(y).mu)
    }
    fn vertical(&self, y: &PointOf<Self>) -> Vector3<f64> {
        R::pose(y).gamma
    }
}

impl<R: TopCoordinates> System for Top<R> {
    type Problem = R::Problem;

    const STATE: &'static [&'static str] = R::STATE;
    const QUANTITIES: &'static [Q<R>] = with_angles![
        momentum_body(&["m1", "m2", "m3"]),
        omega_body(),
        Q::numbers(
            "vertical",
            &["v1", "v2", "v3"],
            "the direction upward in the body",
            |top, _, y, row| row.extend(top.in_scene(top.vertical(y)).iter()),
        ),
        nutation(),
        attitude(),
        quaternion(),
        axis(),
        momentum_space(),
        omega_space(),
        Q::number("energy", "kinetic and potential energy", |top, _, y| {
            top.spec.top.energy(&Top::<R>::momentum_and_vertical(y))
        })
        .of_dimension(Dimension::ENERGY)
        .kept(R::LAWS[0])
        .in_terms(|top, y| {
            let Pose { mu, gamma, .. } = R::pose(y);
            mu.dot(&top.spec.top.omega(&mu)) + length(&top.spec.weight) * length(&gamma)
        }),
        Q::number("vertical_norm2", "square of the length of the vertical", |top, _, y| {
            top.spec.top.casimirs(&Top::<R>::momentum_and_vertical(y))[0]
        })
        .kept(R::LAWS[1]),
        Q::number("momentum_vertical", "angular momentum about the vertical", |top, _, y| {
            R::about_vertical(&top.spec.top, y)
        })
        .of_dimension(Dimension::ANGULAR_MOMENTUM)
        .kept(R::LAWS[2])
        .in_terms(|_, y| {
            let Pose { mu, gamma, .. } = R::pose(y);
            length(&mu) * length(&gamma)
        }),
        Q::number(
            "integral",
            "the fourth integral of Euler's, Lagrange's (the momentum along the weight) and Kovalevskaya's top; others \
             have none",
            |top, _, y| {
                let integral = top.spec.top.fourth_integral(&Top::<R>::momentum_and_vertical(y));
                integral.unwrap_or(f64::NAN)
            },
        )
        .kept_where(|top| {
            // Where the attitude is integrated, neither the energy nor this is a polynomial of the state.
            let is_polynomial = R::LAWS[0].degree > 0;
            let degree = if is_polynomial { top.spec.top.degree_of_fourth_integral() } else { 0 };
            Some(Law::by_the_flow(degree))
        })
        .in_terms(|top, y| {
            top.spec.top.terms_of_fourth_integral(&Top::<R>::momentum_and_vertical(y))
        })
        .missing_where(Self::without_integral),
        angle(),
        momentum_norm(),
        attitude_defect(),
    ];

    fn layer(&self) -> Layer {
        Layer::Closed
    }
    fn axes_of_points(&self) -> Option<(Matrix3<f64>, Turned<Self>)> {
        Some((self.spec.body.axes?, |_, y, turn| R::turned(y, turn)))
    }
    fn problem(&self) -> Result<Start<Self::Problem>, Error> {
        let TopSpec { body, vertical, .. } = &self.spec;
        let start = R::point(body.attitude, body.momentum_body.into(), *vertical);
        Ok((R::problem(&self.spec)?, start))
    }
    fn counted(&self) -> Option<Counting> {
        let (_, start) = self.problem().ok()?;
        R::counted(&self.spec, start)
    }
    fn check_state(&self, arg: &str, y: &PointOf<Self>) -> Result<(), Error> {
        R::check_state(arg, y)
    }
    fn modelled(&self) -> String {
        R::MODELLED.into()
    }
    /// Without a weight: that of the free body.
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<PointOf<Self>, Error>> {
        let TopSpec { body, weight, vertical, .. } = &self.spec;
        let up = body.attitude * vertical;
        let at = |t: f64| {
            let (mu, g) = body.exact()?.state(t)?;
            Ok(R::point(g, mu, g.tr_mul(&up)))
        };
        (*weight == Vector3::zeros()).then(|| at(t1 - t0))
    }
    fn warnings(&self) -> Vec<String> {
        self.spec.body.impossible()
    }
    fn notes(&self) -> Vec<String> {
        self.spec.body.notes.clone()
    }
    fn inertia(&self) -> Option<PrincipalInertia> {
        Some(self.spec.body.principal_inertia())
    }
    fn rate(&self) -> Option<f64> {
        Some(self.spec.body.rate())
    }
    fn figure(&self) -> Figure {
        Figure::Sphere(if R::TURNS { "axis" } else { "vertical" })
    }
}
