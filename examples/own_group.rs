//! Your own group, outside the crate: the unit quaternions SU(2) ≅ S³ as four plain numbers.
//!
//! The example implements the library's Cayley map for the group and checks its laws. Then a rigid body turns by
//! quaternions, and the result is compared with that by rotation matrices.
//!
//! ```sh
//! cargo run --release --example own_group
//! ```

use lieflow::actions::LeftTranslation;
use lieflow::check::laws;
use lieflow::groups::{Sample, So3};
use lieflow::maps::Cay;
use lieflow::methods::{Rkmk, tableau::RK4};
use lieflow::nalgebra::{Matrix3, Vector3};
use lieflow::problems::{Flow, RigidBodyAttitude};
use lieflow::{CoordinateMap, Error, LieAlgebra, LieGroup, SaveAt, StepError, TimeGrid};
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::StandardNormal;

type V = Vector3<f64>;

/// q = (w, x, y, z) with |q| = 1; u ∈ ℝ³ stands for (u₁i + u₂j + u₃k)/2, so that [u, v] = u × v.
struct Su2;

impl LieAlgebra for Su2 {
    type Scalar = f64;
    type Alg = V;

    fn name(&self) -> String {
        "SU(2)".into()
    }
    fn dim(&self) -> usize {
        3
    }
    fn zero(&self) -> V {
        V::zeros()
    }
    fn set_zero(&self, u: &mut V) {
        *u = V::zeros();
    }
    fn axpy(&self, a: f64, x: &V, y: &mut V) {
        *y += a * x;
    }
    fn bracket(&self, u: &V, v: &V, out: &mut V) {
        *out = u.cross(v);
    }
    fn norm(&self, u: &V) -> f64 {
        u.norm()
    }
    fn is_finite(&self, u: &V) -> bool {
        u.iter().all(|x| x.is_finite())
    }
}

impl LieGroup for Su2 {
    type Elem = [f64; 4];
    type Vector = V;

    fn identity(&self) -> [f64; 4] {
        [1.0, 0.0, 0.0, 0.0]
    }
    fn compose(&self, a: &[f64; 4], b: &[f64; 4], out: &mut [f64; 4]) {
        let (v, w) = (V::from_row_slice(&a[1..]), V::from_row_slice(&b[1..]));
        let s = a[0] * w + b[0] * v + v.cross(&w);
        *out = [a[0] * b[0] - v.dot(&w), s[0], s[1], s[2]];
    }
    /// The rotation x ↦ q x q̄.
    fn apply(&self, q: &[f64; 4], x: &V, y: &mut V) {
        let v = V::from_row_slice(&q[1..]);
        let t = 2.0 * v.cross(x);
        *y = x + q[0] * t + v.cross(&t);
    }
    /// (v/2)·q.
    fn tangent(&self, v: &V, q: &[f64; 4], out: &mut [f64; 4]) {
        self.compose(&[0.0, 0.5 * v[0], 0.5 * v[1], 0.5 * v[2]], q, out);
    }
    fn apply_algebra(&self, v: &V, x: &V, y: &mut V) {
        *y = v.cross(x);
    }
    fn distance(&self, a: &[f64; 4], b: &[f64; 4]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }
    fn defect(&self, q: &[f64; 4]) -> f64 {
        (q.iter().map(|x| x * x).sum::<f64>() - 1.0).abs()
    }
}

/// cay(u) = (1 + u/2)/|1 + u/2|. dcay⁻¹ is that of so(3), because it depends only on the algebra.
impl CoordinateMap<Su2> for Cay {
    type At = ();

    fn name(&self) -> &'static str {
        "cay"
    }
    fn at(&self, _: &Su2) -> Result<(), Error> {
        Ok(())
    }
    fn psi(&self, _: &Su2, u: &V, _: &mut (), q: &mut [f64; 4]) -> Result<(), StepError> {
        let s = 1.0 / (1.0 + 0.25 * u.norm_squared()).sqrt();
        *q = [s, 0.5 * s * u[0], 0.5 * s * u[1], 0.5 * s * u[2]];
        Ok(())
    }
    fn dpsi_inv(&self, _: &Su2, u: &V, _: &mut (), v: &mut V) -> Result<(), StepError> {
        *v += 0.25 * u.dot(v) * u - 0.5 * u.cross(v);
        Ok(())
    }
}

impl Sample for Su2 {
    fn sample_algebra<R: Rng + ?Sized>(&self, rng: &mut R, sigma: f64) -> V {
        V::from_fn(|_, _| sigma * rng.sample::<f64, _>(StandardNormal))
    }
    fn sample_element<R: Rng + ?Sized>(&self, rng: &mut R) -> [f64; 4] {
        let q = [(); 4].map(|()| rng.sample::<f64, _>(StandardNormal));
        let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        q.map(|x| x / norm)
    }
    fn sample_vector<R: Rng + ?Sized>(&self, rng: &mut R) -> V {
        self.sample_algebra(rng, 1.0)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for law in laws(&Su2, &Cay, &mut rand_pcg::Pcg64::seed_from_u64(1), 200, 0.5)? {
        println!("{:24} {:6.2} of {}", law.name, law.worst, law.bound);
        assert!(law.holds());
    }

    let (inertia, momentum) = ([1.0, 2.0, 3.0], [0.2, 0.5, 3.0]);
    let grid = TimeGrid::new([0.0, 20.0], 0.02)?;
    let method = Rkmk::new(RK4, Cay);
    // The free rigid body by its attitude quaternion: q̇ = f(q)·q, f(q) = q J⁻¹ q̄ m_s.
    let body = Flow::new(Su2, LeftTranslation, |_, q, omega| {
        let mut m = V::zeros();
        Su2.apply(&[q[0], -q[1], -q[2], -q[3]], &V::from(momentum), &mut m);
        Su2.apply(q, &m.component_div(&V::from(inertia)), omega);
    });
    let mut q = Su2.identity();
    lieflow::integrate(&body, &method, &grid, &SaveAt::Ends, &mut q, |_, _| {})?;

    let body = RigidBodyAttitude::new(inertia, momentum)?;
    let mut g = Matrix3::identity();
    lieflow::integrate(&body, &method, &grid, &SaveAt::Ends, &mut g, |_, _| {})?;

    let columns = [V::x(), V::y(), V::z()].map(|e| {
        let mut column = V::zeros();
        Su2.apply(&q, &e, &mut column);
        column
    });
    let gap = So3::new().distance(&Matrix3::from_columns(&columns), &g);
    println!("after 1000 steps: |q| − 1 = {:.0e}, against matrices {gap:.0e}", Su2.defect(&q));
    assert!(Su2.defect(&q) < 1e-13 && gap < 1e-12);
    Ok(())
}
