//! The representations of a free rigid body as systems, with their quantities stated once for all.
//!
//! | | layer | point | in methods for |
//! |---|---|---|---|
//! | [`MomentumOnly`] | closed | m ∈ so(3)* | the momentum |
//! | [`Attitude`] | closed | g ∈ SO(3) | the attitude |
//! | [`State`] | closed | (m, g), 12 numbers | both as one state, classical methods |
//! | [`Quaternion`] | closed | q ∈ S³ | the attitude as a quaternion |
//! | [`MomentumMatrix`] | general | m ∈ so(n)*, n = 3 | the momentum |
//! | [`AttitudeMatrix`] | general | g ∈ SO(n), n = 3 | the attitude |

use core::fmt::Debug;

use lieflow::groups::{GroupMatrix, LieGroup, So3, UnitQuaternions, hat, vee};
use lieflow::problems::{
    BodyState, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude, RigidBodyQuaternion,
    RigidBodyState,
};
use lieflow::scalar::Counted;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::kinds::body::*;
use crate::kinds::on_m::{OFF_M, check_antisymmetric};
use crate::kinds::prelude::*;
use crate::problem::{PointOf, Runnable, SERIES, Turned};

/// Where a body is: its momentum in the body, and its orientation where that is modelled.
pub(super) struct Pose {
    m: Vector3<f64>,
    orientation: Orientation,
}

/// A way to represent the state of a free rigid body.
pub(super) trait BodyCoordinates: Clone + Debug + Send + Sync + 'static {
    /// The problem of the library.
    type Problem: Runnable + Clone + Debug + Send + Sync;
    /// The layer of the problem.
    const LAYER: Layer;
    /// What is integrated, in words.
    const MODELLED: &'static str;
    /// Is the orientation a part of the point?
    const TURNS: bool;
    /// The degree of the energy and of |m|² in the point, where these are polynomials; else 0.
    const DEGREE: u32 = 2;

    /// The problem with its parameters.
    ///
    /// # Errors
    /// What the library refuses.
    fn problem(spec: &RigidBodySpec) -> Result<Self::Problem, Error>;
    /// The point of a pose.
    fn point(pose: &Pose) -> Point<Self>;
    /// The pose of a point.
    fn pose(problem: &Self::Problem, y: &Point<Self>) -> Pose;
    /// See [`System::check_state`].
    fn check_state(_arg: &str, _y: &Point<Self>) -> Result<(), Error> {
        Ok(())
    }
    /// See [`System::counted`].
    fn counted(_spec: &RigidBodySpec, _start: Point<Self>) -> Option<Counting> {
        None
    }
}

type Point<R> = lieflow::problems::PointOf<<R as BodyCoordinates>::Problem>;

fn to_faer(m: &Matrix3<f64>) -> Mat<f64> {
    Mat::from_fn(3, 3, |i, j| m[(i, j)])
}
fn to_nalgebra(m: &Mat<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| m[(i, j)])
}

/// m alone.
#[derive(Clone, Debug)]
pub(super) struct MomentumOnly;

impl BodyCoordinates for MomentumOnly {
    type Problem = RigidBody;
    const LAYER: Layer = Layer::Closed;
    const MODELLED: &'static str = "momentum on so(3)*";
    const TURNS: bool = false;

    fn problem(spec: &RigidBodySpec) -> Result<RigidBody, Error> {
        RigidBody::new(spec.inertia)
    }
    fn point(pose: &Pose) -> Vector3<f64> {
        pose.m
    }
    fn counted(spec: &RigidBodySpec, start: Point<Self>) -> Option<Counting> {
        let body = RigidBody::<Counted>::new(spec.inertia).ok()?;
        counting(body, start.map(Counted))
    }
    fn pose(_: &RigidBody, m: &Vector3<f64>) -> Pose {
        Pose { m: *m, orientation: Orientation::NotModelled }
    }
}

/// g; the momentum in space is constant.
#[derive(Clone, Debug)]
pub(super) struct Attitude;

impl BodyCoordinates for Attitude {
    type Problem = RigidBodyAttitude;
    const LAYER: Layer = Layer::Closed;
    const MODELLED: &'static str = "attitude on SO(3)";
    const TURNS: bool = true;

    fn problem(spec: &RigidBodySpec) -> Result<RigidBodyAttitude, Error> {
        let (inertia, m) = (spec.inertia, spec.momentum_space());
        RigidBodyAttitude::new(inertia, m.into())
    }
    fn point(pose: &Pose) -> Matrix3<f64> {
        pose.orientation.rotation()
    }
    fn counted(spec: &RigidBodySpec, start: Point<Self>) -> Option<Counting> {
        let body =
            RigidBodyAttitude::<Counted>::new(spec.inertia, spec.momentum_space().into()).ok()?;
        counting(body, start.map(Counted))
    }
    fn pose(body: &RigidBodyAttitude, g: &Matrix3<f64>) -> Pose {
        Pose { m: body.momentum_body(g), orientation: Orientation::Matrix(*g) }
    }
}

/// m and g.
#[derive(Clone, Debug)]
pub(super) struct State;

impl BodyCoordinates for State {
    type Problem = RigidBodyState;
    const LAYER: Layer = Layer::Closed;
    const MODELLED: &'static str = "momentum and attitude as one state of 12 numbers";
    const TURNS: bool = true;

    fn problem(spec: &RigidBodySpec) -> Result<RigidBodyState, Error> {
        RigidBodyState::new(spec.inertia)
    }
    fn point(pose: &Pose) -> BodyState {
        BodyState { m: pose.m, g: pose.orientation.rotation() }
    }
    fn counted(spec: &RigidBodySpec, start: Point<Self>) -> Option<Counting> {
        let body = RigidBodyState::<Counted>::new(spec.inertia).ok()?;
        let start = BodyState { m: start.m.map(Counted), g: start.g.map(Counted) };
        counting(body, start)
    }
    fn pose(_: &RigidBodyState, y: &BodyState) -> Pose {
        Pose { m: y.m, orientation: Orientation::Matrix(y.g) }
    }
    /// Any twelve numbers are on M = ℝ¹².
    fn check_state(_: &str, y: &BodyState) -> Result<(), Error> {
        So3::new().check_element("y", &y.g, OFF_M)
    }
}

/// q; the momentum in space is constant.
#[derive(Clone, Debug)]
pub(super) struct Quaternion;

impl BodyCoordinates for Quaternion {
    type Problem = RigidBodyQuaternion;
    const LAYER: Layer = Layer::Closed;
    const MODELLED: &'static str = "attitude on S³, a unit quaternion";
    const TURNS: bool = true;
    /// Both are of degree 4.
    const DEGREE: u32 = 0;

    fn problem(spec: &RigidBodySpec) -> Result<RigidBodyQuaternion, Error> {
        let (inertia, m) = (spec.inertia, spec.momentum_space());
        RigidBodyQuaternion::new(inertia, m.into())
    }
    fn point(pose: &Pose) -> UnitQuaternion<f64> {
        pose.orientation.quaternion()
    }
    fn pose(body: &RigidBodyQuaternion, q: &UnitQuaternion<f64>) -> Pose {
        Pose { m: body.momentum_body(q), orientation: Orientation::Quaternion(*q) }
    }
}

/// m alone, as a matrix.
#[derive(Clone, Debug)]
pub(super) struct MomentumMatrix;

impl BodyCoordinates for MomentumMatrix {
    type Problem = RigidBodyN;
    const LAYER: Layer = Layer::General;
    const MODELLED: &'static str = "momentum on so(n)*, n = 3";
    const TURNS: bool = false;

    fn problem(spec: &RigidBodySpec) -> Result<RigidBodyN, Error> {
        RigidBodyN::from_principal(spec.inertia)
    }
    fn point(pose: &Pose) -> Mat<f64> {
        to_faer(&hat(&pose.m))
    }
    fn pose(_: &RigidBodyN, m: &Mat<f64>) -> Pose {
        Pose { m: vee(&to_nalgebra(m)), orientation: Orientation::NotModelled }
    }
    fn check_state(arg: &str, m: &Mat<f64>) -> Result<(), Error> {
        check_antisymmetric(arg, m)
    }
}

/// g as a matrix; the momentum in space is constant.
#[derive(Clone, Debug)]
pub(super) struct AttitudeMatrix;

impl BodyCoordinates for AttitudeMatrix {
    type Problem = RigidBodyNAttitude;
    const LAYER: Layer = Layer::General;
    const MODELLED: &'static str = "attitude on SO(n), n = 3";
    const TURNS: bool = true;

    fn problem(spec: &RigidBodySpec) -> Result<RigidBodyNAttitude, Error> {
        let (inertia, m) = (spec.inertia, spec.momentum_space());
        RigidBodyNAttitude::new(RigidBodyN::from_principal(inertia)?, to_faer(&hat(&m)))
    }
    fn point(pose: &Pose) -> GroupMatrix {
        GroupMatrix::new_unchecked(to_faer(&pose.orientation.rotation()))
    }
    fn pose(body: &RigidBodyNAttitude, g: &GroupMatrix) -> Pose {
        Pose {
            m: vee(&to_nalgebra(&body.momentum_body(g))),
            orientation: Orientation::Matrix(to_nalgebra(g)),
        }
    }
}

/// A free rigid body in one representation.
#[derive(Clone, Debug)]
pub(super) struct Body<R: BodyCoordinates> {
    spec: RigidBodySpec,
    /// ω and the energy, for all representations.
    body: RigidBody,
    problem: R::Problem,
}

type Q<R> = Quantity<Body<R>>;

impl<R: BodyCoordinates> Body<R> {
    /// # Errors
    /// What the library refuses.
    pub(super) fn new(spec: &RigidBodySpec) -> Result<Self, Error> {
        let body = RigidBody::new(spec.inertia)?;
        Ok(Body { spec: spec.clone(), body, problem: R::problem(spec)? })
    }
}

impl<R: BodyCoordinates> Body<R> {
    /// The point with the axes of the body turned by this rotation.
    fn turned(&self, y: &PointOf<Self>, turn: &Matrix3<f64>) -> PointOf<Self> {
        let Pose { m, orientation } = R::pose(&self.problem, y);
        R::point(&Pose { m: turn * m, orientation: orientation.about(turn) })
    }
}

impl<R: BodyCoordinates> Oriented for Body<R> {
    fn orientation(&self, y: &PointOf<Self>) -> Orientation {
        R::pose(&self.problem, y).orientation
    }
    fn turning(&self, _: f64, y: &PointOf<Self>) -> Vector3<f64> {
        self.omega(y)
    }
    fn without_orientation(&self) -> Option<&'static str> {
        (!R::TURNS).then_some("the momentum alone is integrated")
    }
    fn axes(&self) -> Option<Matrix3<f64>> {
        self.spec.axes
    }
}

impl<R: BodyCoordinates> AsBody for Body<R> {
    fn momentum(&self, y: &PointOf<Self>) -> Vector3<f64> {
        R::pose(&self.problem, y).m
    }
    fn omega(&self, y: &PointOf<Self>) -> Vector3<f64> {
        self.body.omega(&self.momentum(y))
    }
}

impl<R: BodyCoordinates> System for Body<R> {
    type Problem = R::Problem;

    const STATE: &'static [&'static str] =
        if R::TURNS { &["momentum_body", "attitude"] } else { &["momentum_body"] };
    const QUANTITIES: &'static [Q<R>] = with_angles![
        momentum_body(&["m1", "m2", "m3"]),
        omega_body(),
        attitude(),
        quaternion(),
        axis(),
        nutation().missing_where(Self::without_orientation),
        momentum_space(),
        omega_space(),
        Q::number("energy", "kinetic energy", |body, _, y| body.body.energy(&body.momentum(y)))
            .of_dimension(Dimension::ENERGY)
            .kept(Law::by_the_flow(R::DEGREE)),
        momentum_norm().kept(Law::by_the_action(R::DEGREE)),
        angle(),
        attitude_defect().kept_where(|body| {
            let law = Law::by_the_action(2).on_scale(Scale::One);
            body.spec.quaternion.is_none().then_some(law)
        }),
        Q::number(
            "quaternion_defect",
            "distance of the quaternion's square from 1",
            |body, _, y| UnitQuaternions.defect(&body.orientation(y).quaternion()),
        )
        .of_distance()
        .kept_where(|body| {
            let law = Law::by_the_action(2).on_scale(Scale::One);
            body.spec.quaternion.map(|_| law)
        })
        .missing_where(Self::without_orientation),
    ];

    const DEFAULT_METHOD: Option<&'static str> = Some(SERIES);

    fn axes_of_points(&self) -> Option<(Matrix3<f64>, Turned<Self>)> {
        Some((self.spec.axes?, Self::turned))
    }
    fn layer(&self) -> Layer {
        R::LAYER
    }
    fn problem(&self) -> Result<Start<R::Problem>, Error> {
        let orientation = match self.spec.quaternion {
            Some(q) => Orientation::Quaternion(q),
            None => Orientation::Matrix(self.spec.attitude),
        };
        let pose = Pose { m: self.spec.momentum_body.into(), orientation };
        Ok((R::problem(&self.spec)?, R::point(&pose)))
    }
    fn counted(&self) -> Option<Counting> {
        R::counted(&self.spec, self.problem().ok()?.1)
    }
    fn check_state(&self, arg: &str, y: &PointOf<Self>) -> Result<(), Error> {
        R::check_state(arg, y)
    }
    fn modelled(&self) -> String {
        R::MODELLED.into()
    }
    fn figure(&self) -> Figure {
        Figure::Sphere("momentum_body")
    }
    fn inertia(&self) -> Option<PrincipalInertia> {
        Some(self.spec.principal_inertia())
    }
    fn rate(&self) -> Option<f64> {
        Some(self.spec.rate())
    }
    fn warnings(&self) -> Vec<String> {
        self.spec.impossible()
    }
    fn notes(&self) -> Vec<String> {
        self.spec.notes.clone()
    }
    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<PointOf<Self>, Error>> {
        let at = |t: f64| {
            let exact = self.spec.exact()?;
            let (m, orientation) = match R::TURNS {
                true => exact.state(t).map(|(m, g)| (m, Orientation::Matrix(g)))?,
                false => (exact.momentum_body(t)?, Orientation::NotModelled),
            };
            Ok(R::point(&Pose { m, orientation }))
        };
        Some(at(t1 - t0))
    }
}
