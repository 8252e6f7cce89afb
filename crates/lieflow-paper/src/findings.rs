//! What is not in the paper: the space frame and ccsk, the orders of the drift, the separatrix.

use lieflow::groups::{Sample, So3};
use lieflow::problems::{Exact, RigidBody};
use lieflow::{RunError, SaveAt, TimeGrid};
use lieflow_timing::larger;
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::energy::energy_run;
use crate::experiments::{EXAMPLE1, EXAMPLE3, Experiment};
use crate::methods::{Body, PaperMethod};

/// The energy drift of one method in many space frames.
#[derive(Clone, Debug)]
pub struct Frames {
    /// The example of the paper.
    pub example: u8,
    /// The end of the run.
    pub t: f64,
    /// The method.
    pub method: PaperMethod,
    /// |E(t) − E(0)| in the frame of the paper.
    pub printed: f64,
    /// |E(t) − E(0)| in random frames, in order of size.
    pub random: Vec<f64>,
}

impl Frames {
    /// The value that this share of the frames stays below.
    pub fn quantile(&self, share: f64) -> f64 {
        let last = self.random.len().saturating_sub(1);
        self.random.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
    }
    /// The share of frames below a value.
    pub fn below(&self, value: f64) -> f64 {
        self.random.iter().filter(|x| **x < value).count() as f64 / self.random.len() as f64
    }
}

/// The drift in `count` random frames, for exp and both orderings of ccsk, in examples 1 and 3.
pub fn frames(count: usize, seed: u64, mut tick: impl FnMut(f64)) -> Result<Vec<Frames>, RunError> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let turns: Vec<Matrix3<f64>> =
        (0..count).map(|_| So3::<f64>::new().sample_element(&mut rng)).collect();
    let mut all = Vec::new();
    for (example, Experiment { body, dt, .. }, t) in
        [(1, EXAMPLE1, Experiment::END), (3, EXAMPLE3, 80.0)]
    {
        let grid = TimeGrid::new([0.0, t], dt)?;
        for method in [PaperMethod::Exp, PaperMethod::Ccsk321, PaperMethod::Ccsk123] {
            // exp does not see the frame: a few show it.
            let turns =
                if method == PaperMethod::Exp { &turns[..count.min(10)] } else { &turns[..] };
            let drift = |body: &Body| Ok::<_, RunError>(end_of(body, method, &grid)?.abs());
            let mut random =
                turns.iter().map(|r| drift(&body.turned(r))).collect::<Result<Vec<_>, _>>()?;
            random.sort_by(f64::total_cmp);
            all.push(Frames { example, t, method, printed: drift(&body)?, random });
            tick(all.len() as f64 / 6.0);
        }
    }
    Ok(all)
}

/// E(t) − E(0) at the end, with nothing looked at on the way.
fn end_of(body: &Body, method: PaperMethod, grid: &TimeGrid) -> Result<f64, RunError> {
    let energy = RigidBody::<f64>::new(body.inertia)?;
    let start = energy.energy(&body.momentum_body());
    let mut last = f64::NAN;
    method.run(body, grid, SaveAt::Ends, &mut |_, m, _| last = energy.energy(&m) - start)?;
    Ok(last)
}

/// The slope of the energy over time, step by step smaller.
#[derive(Clone, Debug)]
pub struct DriftOrder {
    /// The method.
    pub method: PaperMethod,
    /// h and |slope of E(t)|.
    pub points: Vec<(f64, f64)>,
}

impl DriftOrder {
    /// The powers of h that follow from neighbours.
    pub fn orders(&self) -> Vec<f64> {
        let pairs = self.points.windows(2);
        pairs.map(|w| (w[0].1 / w[1].1).ln() / (w[0].0 / w[1].0).ln()).collect()
    }
}

/// J = diag(1, 2, 3) with no component of m_s zero: no half turn reverses the motion.
pub const GENERIC: Body = Body::new([1.0, 2.0, 3.0], [0.9, 1.0, 2.1]);

/// How the drift falls with the step on generic data, over t = 0 … 400.
pub fn drift_orders() -> Result<Vec<DriftOrder>, RunError> {
    let methods = [
        PaperMethod::Exp,
        PaperMethod::Cay,
        PaperMethod::B4,
        PaperMethod::Rk4,
        PaperMethod::Ccsk321,
        PaperMethod::Ccsk123,
    ];
    let order = |method| {
        let point = |h: f64| {
            let grid = TimeGrid::new([0.0, 400.0], h)?;
            Ok::<_, RunError>((h, energy_run(&GENERIC, method, &grid)?.drift().abs()))
        };
        let points =
            [0.1, 0.05, 0.025, 0.0125, 0.00625].into_iter().map(point).collect::<Result<_, _>>()?;
        Ok(DriftOrder { method, points })
    };
    methods.into_iter().map(order).collect()
}

/// One method near the separatrix.
#[derive(Clone, Debug)]
pub struct Separatrix {
    /// The method.
    pub method: PaperMethod,
    /// t and L² − 2EJ₂, whose sign says on which side of the separatrix the motion is.
    pub side: Vec<(f64, f64)>,
    /// The largest ‖g − exact‖ at the times of `side`.
    pub error: f64,
}

/// A motion that starts 1e-6 from the unstable axis, on the side where L² < 2EJ₂.
pub const NEAR_SEPARATRIX: Body = Body::new([1.0, 2.0, 3.0], [1e-6, 1.0, 1e-6]);

/// L² − 2EJ₂ without cancellation: Σ m_j²(1 − J₂/J_j).
pub fn side(body: &Body, m: &Vector3<f64>) -> f64 {
    (0..3).map(|j| m[j] * m[j] * (1.0 - body.inertia[1] / body.inertia[j])).sum()
}

/// Methods on g and methods that keep m as a state, over t = 0 … 200 with steps of 0.05.
pub fn separatrix() -> Result<Vec<Separatrix>, RunError> {
    let body = NEAR_SEPARATRIX;
    let grid = TimeGrid::new([0.0, 200.0], 0.05)?;
    let exact = Exact::new(body.inertia, body.momentum_body().into(), body.attitude)?;
    let methods = [
        PaperMethod::Exp,
        PaperMethod::Cay,
        PaperMethod::Rk4,
        PaperMethod::Mr,
        PaperMethod::Mr2,
        PaperMethod::S,
        PaperMethod::Rk4mg,
    ];
    let run = |method: PaperMethod| {
        let (mut side_of, mut error) = (Vec::new(), 0.0);
        method.run(&body, &grid, SaveAt::Every(20), &mut |t, m, g| {
            side_of.push((t, side(&body, &m)));
            let gap = g.zip(exact.state(t).ok()).map(|(g, (_, exact))| (g - exact).norm());
            error = larger(error, gap.unwrap_or(f64::NAN));
        })?;
        Ok(Separatrix { method, side: side_of, error })
    };
    methods.into_iter().map(run).collect()
}
