//! The types of problems that runs are compiled for.

use std::sync::Arc;

use lieflow::catalog::MethodSpec;
use lieflow::problems::{
    PointOf, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude, RigidBodyQuaternion,
    RigidBodyState, Zeitlin,
};
use lieflow::{Error, RunError};

use super::drive::{curve_by, drive_by, fits_by, orders_by};
use super::operations::operations_by;
use super::stepper::stepper_by;
use super::{
    Fit, Orders, Outcome, Plan, Points, RowCurve, RowsOf, Runnable, SharedRowOf, StepByStep,
    Stepper, Steps, Watcher,
};
use crate::schema::Schema;
use crate::spaces::{
    Composed, Driven, FromBody, Growing, Motion, OnMatrices, OnPairs, OnQuaternions, OnRotations,
    OnSe3, OnSphere, OnSpheres, Place,
};

/// A function here that is not generic is compiled here; `inline(never)` keeps it so.
macro_rules! runnable {
    ($($problem:ty,)*) => {$(
        impl Runnable for $problem {
            #[inline(never)]
            fn drive(
                spec: &MethodSpec,
                problem: &Arc<Self>,
                y: PointOf<Self>,
                plan: Plan<'_>,
                rows: RowsOf<'_, Self>,
                watcher: &mut dyn Watcher,
            ) -> Result<Outcome, RunError> {
                drive_by(spec, problem, y, plan, rows, watcher)
            }
            #[inline(never)]
            fn stepper(
                spec: &MethodSpec,
                problem: &Arc<Self>,
                y: PointOf<Self>,
                steps: StepByStep,
                points: Points<Self>,
            ) -> Result<Box<dyn Stepper>, RunError> {
                stepper_by(spec, problem, y, steps, points)
            }
            #[inline(never)]
            fn curve(
                spec: &MethodSpec,
                problem: &Arc<Self>,
                like: &PointOf<Self>,
                numbers: &[f64],
                schema: &Schema,
                shared: &dyn Fn(f64) -> Box<SharedRowOf<Self>>,
            ) -> Result<Box<dyn RowCurve>, Error> {
                curve_by(spec, problem, like, numbers, schema, shared)
            }
            #[inline(never)]
            fn orders(&self, spec: &MethodSpec) -> Result<Orders, Error> {
                orders_by(spec, self)
            }
            #[inline(never)]
            fn fits(&self, spec: &MethodSpec, y: &PointOf<Self>) -> Result<Fit, Error> {
                fits_by(spec, self, y)
            }
            #[inline(never)]
            fn operations(&self, spec: &MethodSpec, y: PointOf<Self>, steps: &Steps) -> Option<f64> {
                operations_by(spec, self, y, steps)
            }
        }
    )*};
}

runnable! {
    RigidBody,
    RigidBodyAttitude,
    RigidBodyState,
    RigidBodyQuaternion,
    RigidBodyN,
    RigidBodyNAttitude,
    Zeitlin<Place>,
    OnRotations,
    OnSphere,
    OnSpheres,
    OnQuaternions,
    OnSe3,
    OnPairs,
    Motion,
    Driven,
    Composed,
    OnMatrices,
    FromBody,
    Growing,
}
