//! The spin as a problem of the library, and the methods that fit it.

use lieflow::actions::Linear;
use lieflow::adaptive::{AdaptiveError, AdaptiveStats};
use lieflow::catalog::{
    LINEAR_METHODS, MethodSpec, OnMethod, with_implicit_method, with_linear_method,
};
use lieflow::groups::So3;
use lieflow::problems::{Ambient, LinearField, Problem};
use lieflow::{Error, RunError, SaveAt, Stats, TimeGrid};
use nalgebra::Vector3;

use super::{KIND, SpinSpec};
use crate::catalog;
use crate::model::{Model, Sink, Steps, adapt_by, integrate_by, order_by};

/// f(t, x) = ω(t) = R₃(Ωt) ω(0); Λ(g, x) = g x. Invariant: |x|.
#[derive(Clone, Copy, Debug)]
struct Spin {
    field: Vector3<f64>,
    rate: f64,
}

impl Spin {
    fn omega(&self, t: f64) -> Vector3<f64> {
        let (s, c) = (self.rate * t).sin_cos();
        let [x, y, z]: [f64; 3] = self.field.into();
        Vector3::new(c * x - s * y, s * x + c * y, z)
    }
}

impl Problem for Spin {
    type Group = So3;
    type Action = Linear;
    type Work = ();

    fn group(&self) -> &So3 {
        const { &So3::new() }
    }
    fn action(&self) -> &Linear {
        &Linear
    }
    fn work(&self) {}
    fn f(&self, t: f64, _: &Vector3<f64>, v: &mut Vector3<f64>, _: &mut ()) {
        *v = self.omega(t);
    }
}

impl LinearField for Spin {
    fn a(&self, t: f64, v: &mut Vector3<f64>, _: &mut ()) {
        *v = self.omega(t);
    }
}

impl Ambient for Spin {
    fn field(&self, t: f64, x: &Vector3<f64>, dx: &mut Vector3<f64>, _: &mut ()) {
        *dx = self.omega(t).cross(x);
    }
    fn copy(&self, x: &Vector3<f64>, y: &mut Vector3<f64>) {
        *y = *x;
    }
    fn add(&self, a: f64, x: &Vector3<f64>, y: &mut Vector3<f64>) {
        *y += a * x;
    }
    fn is_finite(&self, x: &Vector3<f64>) -> bool {
        x.iter().all(|x| x.is_finite())
    }
}

/// Methods for equations of linear type, and those for any.
fn with_spin_method<V: OnMethod<Spin>>(spec: &MethodSpec, on: V) -> Result<V::Out, Error> {
    let info = spec.info()?;
    match LINEAR_METHODS.iter().any(|linear| linear.name == info.name) {
        true => with_linear_method(info.name, on),
        false => with_implicit_method(spec, on),
    }
}

catalog!(Spin, with_spin_method);

#[derive(Debug)]
pub(super) struct SpinModel {
    spin: Spin,
    moment: Vector3<f64>,
    quantities: Vec<&'static str>,
}

impl SpinModel {
    pub(super) fn new(spec: &SpinSpec, quantities: &[&str]) -> Result<Self, Error> {
        let names = quantities.iter().map(|name| KIND.quantity(name).map(|info| info.name));
        Ok(SpinModel {
            spin: Spin { field: spec.field, rate: spec.rate },
            moment: spec.moment,
            quantities: names.collect::<Result<_, _>>()?,
        })
    }

    /// What shows a point as a row.
    fn shown<'a>(&'a self, sink: &'a mut Sink<'_>) -> impl FnMut(f64, &Vector3<f64>) + 'a {
        let mut row = Vec::new();
        move |t, x| {
            row.clear();
            for quantity in &self.quantities {
                match *quantity {
                    "moment" => row.extend(x.iter()),
                    _ => row.push(x.norm()),
                }
            }
            sink(t, &row);
        }
    }
}

impl Model for SpinModel {
    fn columns(&self) -> Vec<String> {
        let infos = self.quantities.iter().flat_map(|name| KIND.quantity(name));
        infos.flat_map(|info| info.columns).map(|&column| column.into()).collect()
    }
    fn modelled(&self, _: &MethodSpec) -> Vec<String> {
        vec!["moment on the sphere".into()]
    }
    fn run(
        &self,
        method: &MethodSpec,
        grid: &TimeGrid,
        save: &SaveAt,
        sink: &mut Sink<'_>,
    ) -> Result<Stats, RunError> {
        integrate_by(method, &self.spin, self.moment, grid, save, self.shown(sink))
    }
    fn adapt(
        &self,
        method: &MethodSpec,
        steps: &Steps,
        save: &SaveAt,
        sink: &mut Sink<'_>,
    ) -> Result<AdaptiveStats, AdaptiveError> {
        adapt_by(method, &self.spin, self.moment, steps, save, self.shown(sink))
    }
    fn order(&self, method: &MethodSpec) -> Result<Option<usize>, Error> {
        order_by(method, &self.spin)
    }
    /// None is used: what compares methods makes its own reference.
    fn exact(&self, _: f64) -> Option<Result<Vec<f64>, Error>> {
        None
    }
}
