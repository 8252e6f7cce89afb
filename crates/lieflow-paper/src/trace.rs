//! Table 1: one step of the algorithm, stage by stage, on both layers.

use faer::Mat;
use lieflow::Error;
use lieflow::chart::ChartStore;
use lieflow::groups::{AlgebraMatrix, LieAlgebra, MatrixGroup, hat, vee};
use lieflow::maps::{CoordinateMap, Exp};
use lieflow::methods::tableau::RK4;
use lieflow::problems::{
    AlgOf, PointOf, Problem, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude, ScalarOf,
};
use nalgebra::{Matrix3, Vector3};

use crate::methods::Body;

/// A line of the trace: u, and k = dΨ_u⁻¹ f(λ(u)) there; at the end v and nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// u_i, or v at the end.
    pub u: [f64; 3],
    /// k̃_i.
    pub k: Option<[f64; 3]>,
}

/// The trace of a step on a layer, and the point that it leads to.
#[derive(Clone, Debug)]
pub struct Trace {
    /// The four stages, and v.
    pub stages: Vec<Stage>,
    /// g after the step.
    pub end: Matrix3<f64>,
}

/// u_i = h Σ a_ij k̃_j, k̃_i = dΨ_{u_i}⁻¹ f(λ(u_i)), v = h Σ b_j k̃_j, g⁺ = λ(v).
fn traced<P, Psi>(
    problem: &P,
    psi: &Psi,
    start: PointOf<P>,
    h: f64,
    read: impl Fn(&AlgOf<P>) -> [f64; 3],
) -> Result<(Vec<Stage>, PointOf<P>), Error>
where
    P: Problem,
    P::Group: LieAlgebra<Scalar = f64>,
    Psi: CoordinateMap<P::Group>,
{
    let group = problem.group();
    let mut store = ChartStore::new(problem, psi, &start)?;
    let mut chart = store.around(problem, psi, 0, &start);
    let mut k = vec![group.zero(); 4];
    let mut stages = Vec::new();
    let mut u = group.zero();
    for i in 0..4 {
        group.combine(h, &RK4.a[i], &k, &mut u);
        let t: ScalarOf<P> = h * RK4.c[i];
        if i == 0 {
            chart.field(t, &mut k[0]);
        } else {
            let mut value = group.zero();
            chart.pullback(t, &u, &mut value)?;
            k[i] = value;
        }
        stages.push(Stage { u: read(&u), k: Some(read(&k[i])) });
    }
    group.combine(h, &RK4.b, &k, &mut u);
    stages.push(Stage { u: read(&u), k: None });
    let mut end = start.clone();
    chart.lambda(&u, &mut end)?;
    Ok((stages, end))
}

/// One step of RKMK4 with exp on the closed and on the general layer.
pub fn both_layers(body: &Body, h: f64) -> Result<[Trace; 2], Error> {
    let closed = RigidBodyAttitude::new(body.inertia, body.momentum_space)?;
    let (stages, end) = traced(&closed, &Exp, body.attitude, h, |u: &Vector3<f64>| (*u).into())?;
    let closed = Trace { stages, end };

    let dense = |x: &Matrix3<f64>| Mat::from_fn(3, 3, |i, j| x[(i, j)]);
    let fixed = |x: &Mat<f64>| Matrix3::from_fn(|i, j| x[(i, j)]);
    let m_s = hat(&Vector3::from(body.momentum_space));
    let general = RigidBodyNAttitude::new(RigidBodyN::from_principal(body.inertia)?, dense(&m_s))?;
    let start = MatrixGroup::so(3)?.element(dense(&body.attitude))?;
    let read = |u: &AlgebraMatrix| vee(&fixed(u)).into();
    let (stages, end) = traced(&general, &Exp, start, h, read)?;
    Ok([closed, Trace { stages, end: fixed(&end) }])
}
