//! The rigid body on either layer, with or without its attitude.

use faer::Mat;
use lieflow::adaptive::{AdaptiveError, AdaptiveStats};
use lieflow::catalog::{MethodSpec, Needs};
use lieflow::groups::{GroupMatrix, LieGroup, MatrixGroup, So3, UnitQuaternions, hat, vee};
use lieflow::problems::{
    BodyState, Exact, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude,
    RigidBodyQuaternion, RigidBodyState,
};
use lieflow::scalar::Counted;
use lieflow::so3::{quaternion_from_matrix, quaternion_to_wxyz};
use lieflow::{Error, RunError, SaveAt, Stats, TimeGrid};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{KIND, RigidBodySpec, needs_attitude, rotation};
use crate::model::{Layer, Model, Sink, Steps, adapt_by, fits_by, integrate_by, order_by};
use crate::operations::{Pace, operations_by};

#[derive(Debug)]
enum System {
    Momentum(RigidBody),
    Attitude(RigidBodyAttitude),
    Quaternion(RigidBodyQuaternion),
    State(RigidBodyState),
    MomentumN(RigidBodyN),
    AttitudeN(RigidBodyNAttitude),
}

#[derive(Debug)]
pub(super) struct RigidBodyModel {
    system: System,
    /// Where `system` is the attitude: both as one state, for the methods that want that.
    state: Option<System>,
    inertia: [f64; 3],
    /// For ω and the energy of a row, on either layer.
    body: RigidBody,
    momentum: Vector3<f64>,
    attitude: Matrix3<f64>,
    quaternion: UnitQuaternion<f64>,
    /// The principal axes, where the scene is written in another frame.
    axes: Option<Matrix3<f64>>,
    quantities: Vec<&'static str>,
    exact: Result<Exact, Error>,
}

fn to_faer(m: &Matrix3<f64>) -> Mat<f64> {
    Mat::from_fn(3, 3, |i, j| m[(i, j)])
}

fn to_nalgebra(m: &Mat<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| m[(i, j)])
}

/// Run `$run` on the problem of `$model` with its initial state and a function that shows a point of
/// it as a row.
macro_rules! on_system {
    ($model:expr, $method:expr, $sink:expr, |$problem:ident, $y:ident, $see:ident| $run:expr) => {{
        let model: &RigidBodyModel = $model;
        let sink: &mut Sink<'_> = $sink;
        let mut row = Vec::new();
        let mut show = |t: f64, m: &Vector3<f64>, g: Option<Attitude<'_>>| {
            model.fill(m, g, &mut row);
            sink(t, &row);
        };
        match model.system($method) {
            System::Momentum($problem) => {
                let $y = model.momentum;
                let $see = |t: f64, m: &Vector3<f64>| show(t, m, None);
                $run
            }
            System::Attitude($problem) => {
                let $y = model.attitude;
                let $see = |t: f64, g: &Matrix3<f64>| {
                    show(t, &$problem.momentum_body(g), Some(Attitude::Matrix(g)));
                };
                $run
            }
            System::Quaternion($problem) => {
                let $y = model.quaternion;
                let $see = |t: f64, q: &UnitQuaternion<f64>| {
                    show(t, &$problem.momentum_body(q), Some(Attitude::Quaternion(q)));
                };
                $run
            }
            System::State($problem) => {
                let $y = BodyState { m: model.momentum, g: model.attitude };
                let $see = |t: f64, y: &BodyState| show(t, &y.m, Some(Attitude::Matrix(&y.g)));
                $run
            }
            System::MomentumN($problem) => {
                let $y = to_faer(&hat(&model.momentum));
                let $see = |t: f64, m: &Mat<f64>| show(t, &vee(&to_nalgebra(m)), None);
                $run
            }
            System::AttitudeN($problem) => {
                let $y: GroupMatrix = MatrixGroup::so(3)?.element(to_faer(&model.attitude))?;
                let $see = |t: f64, g: &GroupMatrix| {
                    let m = vee(&to_nalgebra(&$problem.momentum_body(g)));
                    show(t, &m, Some(Attitude::Matrix(&to_nalgebra(g))));
                };
                $run
            }
        }
    }};
}

impl RigidBodyModel {
    pub(super) fn new(
        spec: &RigidBodySpec,
        layer: Layer,
        quantities: &[&str],
    ) -> Result<Self, Error> {
        let names = quantities.iter().map(|name| KIND.quantity(name).map(|info| info.name));
        let momentum = Vector3::from(spec.momentum_body);
        let in_space = spec.attitude * momentum;
        let system = match (layer, needs_attitude(quantities)) {
            (Layer::General, _) if spec.quaternion.is_some() => {
                return Err(Error::Unsupported {
                    what: "layer",
                    with: "`general` and a quaternion".into(),
                    why: "quaternions have closed forms only; leave layer out",
                });
            }
            (Layer::Closed, true) if spec.quaternion.is_some() => {
                System::Quaternion(RigidBodyQuaternion::new(spec.inertia, in_space.into())?)
            }
            (Layer::Closed, false) => System::Momentum(RigidBody::new(spec.inertia)?),
            (Layer::Closed, true) => {
                System::Attitude(RigidBodyAttitude::new(spec.inertia, in_space.into())?)
            }
            (Layer::General, with_attitude) => {
                let body = RigidBodyN::from_principal(spec.inertia)?;
                match with_attitude {
                    false => System::MomentumN(body),
                    true => {
                        System::AttitudeN(RigidBodyNAttitude::new(body, to_faer(&hat(&in_space)))?)
                    }
                }
            }
        };
        let state = match &system {
            System::Attitude(_) => Some(System::State(RigidBodyState::new(spec.inertia)?)),
            _ => None,
        };
        Ok(RigidBodyModel {
            system,
            state,
            inertia: spec.inertia,
            body: RigidBody::new(spec.inertia)?,
            momentum,
            attitude: spec.attitude,
            quaternion: spec.quaternion.unwrap_or_default(),
            axes: spec.axes,
            quantities: names.collect::<Result<_, _>>()?,
            exact: Exact::new(spec.inertia, spec.momentum_body, spec.attitude),
        })
    }

    /// What the method integrates.
    fn system(&self, method: &MethodSpec) -> &System {
        let on_state = || method.info().is_ok_and(|info| info.needs == Needs::State);
        self.state.as_ref().filter(|_| on_state()).unwrap_or(&self.system)
    }

    /// row ← the quantities at body momentum m and attitude g.
    fn fill(&self, m: &Vector3<f64>, g: Option<Attitude<'_>>, row: &mut Vec<f64>) {
        row.clear();
        let shown = |x: Vector3<f64>| self.axes.map_or(x, |axes| axes * x);
        for quantity in &self.quantities {
            match (*quantity, g) {
                ("momentum_body", _) => row.extend(shown(*m).iter()),
                ("omega_body", _) => row.extend(shown(self.body.omega(m)).iter()),
                ("energy", _) => row.push(self.body.energy(m)),
                ("momentum_norm", _) => row.push(m.norm()),
                ("attitude", Some(g)) => {
                    let g = g.rotation();
                    let shown = self.axes.map_or(g, |axes| g * axes.transpose());
                    row.extend(shown.transpose().iter());
                }
                ("attitude_defect", Some(g)) => row.push(So3::new().defect(&g.rotation())),
                ("quaternion", Some(g)) => {
                    let axes = self.axes.map_or(Ok(UnitQuaternion::identity()), |axes| {
                        quaternion_from_matrix(&axes.transpose())
                    });
                    let shown = axes.map(|axes| quaternion_to_wxyz(&(g.quaternion() * axes)));
                    row.extend(shown.unwrap_or([f64::NAN; 4]));
                }
                ("quaternion_defect", Some(g)) => row.push(UnitQuaternions.defect(&g.quaternion())),
                // The constructor takes registered names, and models the attitude where one needs it.
                (name, _) => row.resize(row.len() + width(name), f64::NAN),
            }
        }
    }
}

/// An attitude, as it was integrated.
#[derive(Clone, Copy)]
enum Attitude<'a> {
    Matrix(&'a Matrix3<f64>),
    Quaternion(&'a UnitQuaternion<f64>),
}

impl Attitude<'_> {
    fn rotation(self) -> Matrix3<f64> {
        match self {
            Attitude::Matrix(g) => *g,
            Attitude::Quaternion(q) => rotation(q),
        }
    }
    /// Of the two of a rotation, that with w ≥ 0; not a number where there is none.
    fn quaternion(self) -> UnitQuaternion<f64> {
        match self {
            Attitude::Matrix(g) => quaternion_from_matrix(g).map_or_else(
                |_| UnitQuaternion::new_unchecked([f64::NAN; 4].into()),
                |q| if q.w < 0.0 { UnitQuaternion::new_unchecked(-q.into_inner()) } else { q },
            ),
            Attitude::Quaternion(q) => *q,
        }
    }
}

fn width(quantity: &str) -> usize {
    KIND.quantity(quantity).map_or(0, |info| info.columns.len())
}

impl Model for RigidBodyModel {
    fn columns(&self) -> Vec<String> {
        let infos = self.quantities.iter().flat_map(|name| KIND.quantity(name));
        infos.flat_map(|info| info.columns).map(|&column| column.into()).collect()
    }

    fn modelled(&self, method: &MethodSpec) -> Vec<String> {
        let what = match self.system(method) {
            System::Momentum(_) => "momentum on so(3)*",
            System::Attitude(_) => "attitude on SO(3)",
            System::Quaternion(_) => "attitude on S³, a unit quaternion",
            System::State(_) => "momentum and attitude as one state of 12 numbers",
            System::MomentumN(_) => "momentum on so(n)*, n = 3",
            System::AttitudeN(_) => "attitude on SO(n), n = 3",
        };
        vec![what.into()]
    }

    fn run(
        &self,
        method: &MethodSpec,
        grid: &TimeGrid,
        save: &SaveAt,
        sink: &mut Sink<'_>,
    ) -> Result<Stats, RunError> {
        on_system!(self, method, sink, |problem, y, see| {
            integrate_by(method, problem, y, grid, save, &mut { see })
        })
    }

    fn adapt(
        &self,
        method: &MethodSpec,
        steps: &Steps,
        save: &SaveAt,
        sink: &mut Sink<'_>,
    ) -> Result<AdaptiveStats, AdaptiveError> {
        on_system!(self, method, sink, |problem, y, see| {
            adapt_by(method, problem, y, steps, save, &mut { see })
        })
    }

    fn order(&self, method: &MethodSpec) -> Result<Option<usize>, Error> {
        match self.system(method) {
            System::Momentum(body) => order_by(method, body),
            System::Attitude(body) => order_by(method, body),
            System::Quaternion(body) => order_by(method, body),
            System::State(body) => order_by(method, body),
            System::MomentumN(body) => order_by(method, body),
            System::AttitudeN(body) => order_by(method, body),
        }
    }

    fn fits(&self, method: &MethodSpec) -> Result<(), Error> {
        let sink: &mut Sink<'_> = &mut |_, _| {};
        on_system!(self, method, sink, |problem, y, see| {
            let _ = see;
            fits_by(method, problem, &y)
        })
    }

    fn operations(&self, method: &MethodSpec, pace: Pace<'_>) -> Option<f64> {
        match self.system(method) {
            System::Momentum(_) => {
                let body = RigidBody::<Counted>::new(self.inertia).ok()?;
                operations_by(method, &body, self.momentum.map(Counted), pace)
            }
            System::Attitude(body) => {
                let m_s = (*body.momentum_space()).into();
                let body = RigidBodyAttitude::<Counted>::new(self.inertia, m_s).ok()?;
                operations_by(method, &body, self.attitude.map(Counted), pace)
            }
            System::State(_) => {
                let body = RigidBodyState::<Counted>::new(self.inertia).ok()?;
                let y = BodyState { m: self.momentum.map(Counted), g: self.attitude.map(Counted) };
                operations_by(method, &body, y, pace)
            }
            System::Quaternion(body) => operations_by(method, body, self.quaternion, pace),
            System::MomentumN(body) => {
                operations_by(method, body, to_faer(&hat(&self.momentum)), pace)
            }
            System::AttitudeN(body) => {
                let g = MatrixGroup::so(3).ok()?.element(to_faer(&self.attitude)).ok()?;
                operations_by(method, body, g, pace)
            }
        }
    }

    fn exact(&self, [t0, t1]: [f64; 2]) -> Option<Result<Vec<f64>, Error>> {
        let (mut row, t) = (Vec::new(), t1 - t0);
        let filled = self.exact.as_ref().map_err(Clone::clone).and_then(|exact| {
            if needs_attitude(&self.quantities) {
                let (m, g) = exact.state(t)?;
                self.fill(&m, Some(Attitude::Matrix(&g)), &mut row);
            } else {
                self.fill(&exact.momentum_body(t)?, None, &mut row);
            }
            Ok(())
        });
        Some(filled.map(|()| row))
    }
}
