//! Compares the matrix code at n = 3 with the closed forms on so(3), for u of every magnitude.

use core::f64::consts::{FRAC_PI_2, TAU};

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use rand::{Rng, RngExt};

use super::Finding;
use crate::error::Error;
use crate::groups::{AlgebraMatrix, LieAlgebra, LieGroup, MatrixGroup, Sample, So3, hat, vee};
use crate::maps::{CCSK, CCSK123, CCSK321, Cay, CoordinateMap, Exp};
use crate::methods::{Method, Rkmk, Step, tableau::RK4};
use crate::problems::{
    PointOf, Problem, RigidBody, RigidBodyAttitude, RigidBodyN, RigidBodyNAttitude,
};

/// The promise: the layers differ by at most this, in units of ε·cond.
pub const AGREEMENT_BOUND: f64 = 8.0;

fn dense(x: &Matrix3<f64>) -> Mat<f64> {
    Mat::from_fn(3, 3, |i, j| x[(i, j)])
}
fn dense_algebra(u: &Vector3<f64>) -> AlgebraMatrix {
    AlgebraMatrix::new_unchecked(dense(&hat(u)))
}
fn fixed(x: &Mat<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| x[(i, j)])
}

/// A random u. Every eighth is along an axis. The magnitude is log-uniform over all that have a meaning, and every
/// tenth is near a multiple of π/2.
fn random_vector<R: Rng + ?Sized>(rng: &mut R) -> Vector3<f64> {
    let direction = match rng.random_range(0..8) {
        0 => Vector3::ith(rng.random_range(0..3), 1.0),
        _ => So3::new().sample_vector(rng).normalize(),
    };
    let size = match rng.random_range(0..10) {
        0 => {
            let quarter_turns: f64 = rng.random_range(1..9).into();
            quarter_turns * FRAC_PI_2 * (1.0 + 10f64.powf(rng.random_range(-15.0..0.0)))
        }
        1..5 => 10f64.powf(rng.random_range(-3.0..1.0)),
        _ => 10f64.powf(rng.random_range(-320.0..14.5)),
    };
    direction * size
}

/// The distance of α to the singular set 2π, 4π, … of dexp.
fn distance_to_singular(alpha: f64) -> f64 {
    (alpha - TAU * (alpha / TAU).round().max(1.0)).abs()
}

/// Size and condition number of the results at one u.
struct Scale {
    psi_cond: f64,
    inverse_size: f64,
    inverse_cond: f64,
}

/// Ψ and dΨ⁻¹ of one map on both layers.
struct BothLayers<'a, Psi> {
    psi: Psi,
    closed: So3,
    general: &'a MatrixGroup,
}

impl<Psi: CoordinateMap<So3> + CoordinateMap<MatrixGroup>> BothLayers<'_, Psi> {
    fn at(
        &self,
        (u, v): (&Vector3<f64>, &Vector3<f64>),
        work: &mut <Psi as CoordinateMap<MatrixGroup>>::At,
        scale: &Scale,
        [psi, inverse]: &mut [Finding; 2],
    ) {
        let place = || format!("u = ({:e}, {:e}, {:e})", u[0], u[1], u[2]);
        let dense_u = dense_algebra(u);
        let mut g = self.general.identity();
        let mine = self.psi.psi(self.general, &dense_u, work, &mut g);
        match (self.psi.eval(&self.closed, u), mine) {
            (Ok(closed), Ok(())) => {
                psi.see((closed - fixed(&g)).norm(), 3f64.sqrt(), scale.psi_cond, place);
            }
            _ => return psi.refuse(place),
        }
        let mut w = dense_algebra(v);
        let mine = self.psi.dpsi_inv(self.general, &dense_u, work, &mut w);
        match (self.psi.eval_dpsi_inv(&self.closed, u, v), mine) {
            (Ok(closed), Ok(())) => {
                let gap = (closed - vee(&fixed(&w))).norm();
                inverse.see(gap, scale.inverse_size * v.norm(), scale.inverse_cond, place);
            }
            // Each layer draws the line around the singular set by its own measure.
            _ if scale.inverse_cond * scale.inverse_size > 1e3 => {}
            _ => inverse.refuse(place),
        }
    }
}

/// Compares exp, cay, ccsk123, ccsk321 and their inverse differentials on both layers, at `cases` random u of all
/// magnitudes.
///
/// ```
/// use rand::SeedableRng;
/// let mut rng = rand_pcg::Pcg64::seed_from_u64(1);
/// for finding in lieflow::check::maps_agree(&mut rng, 1000)? {
///     assert!(finding.holds(), "{}: {} at {}", finding.name, finding.worst, finding.at);
/// }
/// # Ok::<(), lieflow::Error>(())
/// ```
///
/// # Errors
/// None that SO(3) can raise.
pub fn maps_agree(rng: &mut dyn Rng, cases: usize) -> Result<Vec<Finding>, Error> {
    let (closed, general) = (So3::<f64>::new(), MatrixGroup::so(3)?);
    let names = [
        ["exp", "dexp⁻¹"],
        ["cay", "dcay⁻¹"],
        ["ccsk123", "dccsk123⁻¹"],
        ["ccsk321", "dccsk321⁻¹"],
    ];
    let mut found = names.map(|pair| pair.map(|name| Finding::new(name, AGREEMENT_BOUND)));
    let mut at_exp = Exp.at(&general)?;
    let mut at_cay = Cay.at(&general)?;
    let mut at_123 = CCSK123.at(&general)?;
    let mut at_321 = CCSK321.at(&general)?;
    for _ in 0..cases {
        let (u, v) = (random_vector(rng), closed.sample_vector(rng));
        let alpha = u.norm();
        let phi = (0.5 * alpha / (0.5 * alpha).sin()).abs();
        let exp = Scale {
            psi_cond: alpha.max(1.0),
            inverse_size: if phi > 1.0 { phi } else { 1.0 },
            inverse_cond: 1.0 + alpha / distance_to_singular(alpha),
        };
        let half = 1.0 + 0.25 * alpha * alpha;
        let cay = Scale { psi_cond: half.sqrt(), inverse_size: half, inverse_cond: 1.0 };
        let secant = 1.0 / u[1].cos().abs();
        let ccsk = Scale { psi_cond: 1.0, inverse_size: secant, inverse_cond: secant };
        let pair = (&u, &v);
        let general = &general;
        BothLayers { psi: Exp, closed, general }.at(pair, &mut at_exp, &exp, &mut found[0]);
        BothLayers { psi: Cay, closed, general }.at(pair, &mut at_cay, &cay, &mut found[1]);
        BothLayers { psi: CCSK123, closed, general }.at(pair, &mut at_123, &ccsk, &mut found[2]);
        BothLayers { psi: CCSK321, closed, general }.at(pair, &mut at_321, &ccsk, &mut found[3]);
    }
    Ok(found.into_iter().flatten().collect())
}

/// One step of `method` from y.
fn stepped<P: Problem, M: Method<P>>(
    problem: &P,
    method: &M,
    step: Step<f64>,
    y: &PointOf<P>,
) -> Result<PointOf<P>, Error>
where
    P::Group: LieAlgebra<Scalar = f64>,
{
    let mut y = y.clone();
    let mut work = method.work(problem, &y)?;
    method.step(problem, step, &mut y, &mut work)?;
    Ok(y)
}

/// One step of RKMK4 on both layers, with every map, from `cases` random states of random bodies:
/// by the momentum, and by the attitude.
///
/// # Errors
/// None that a rigid body can raise.
pub fn steps_agree(rng: &mut dyn Rng, cases: usize) -> Result<Vec<Finding>, Error> {
    let so3 = So3::<f64>::new();
    let names = ["exp", "cay", "ccsk123", "ccsk321", "ccsk"];
    let mut found =
        names.map(|name| Finding::new(format!("one step of RKMK4, {name}"), AGREEMENT_BOUND));
    for _ in 0..cases {
        let inertia = [(); 3].map(|()| 10f64.powf(rng.random_range(-1.0..1.0)));
        let (m, g) = (so3.sample_vector(rng), so3.sample_element(rng));
        let m_space = g * m;
        let closed = RigidBody::new(inertia)?;
        let general = RigidBodyN::from_principal(inertia)?;
        let closed_g = RigidBodyAttitude::new(inertia, m_space.into())?;
        let general_g = RigidBodyNAttitude::new(general.clone(), dense(&hat(&m_space)))?;

        let h = 10f64.powf(rng.random_range(-3.0..0.0)) / closed.omega(&m).norm();
        let step = Step { n: rng.random_range(0..2), t: 0.0, h };
        // f(m) = −J⁻¹m has the Lipschitz constant |m|/J_min on the orbit.
        let smallest = inertia.into_iter().fold(f64::INFINITY, f64::min);
        let cond = 1.0 + h * m.norm() / smallest;
        let place = || format!("J = {inertia:?}, h = {h:e}");

        let dense_m = dense(&hat(&m));
        let mut dense_g = general_g.group().identity();
        dense_g.copy_from(dense(&g));
        macro_rules! compare {
            ($found:expr, $psi:expr) => {{
                let method = Rkmk::new(RK4, $psi);
                let a = stepped(&closed, &method, step, &m)?;
                let b = vee(&fixed(&stepped(&general, &method, step, &dense_m)?));
                $found.see((a - b).norm(), m.norm(), cond, place);
                let a = stepped(&closed_g, &method, step, &g)?;
                let b = fixed(&stepped(&general_g, &method, step, &dense_g)?.into_mat());
                $found.see((a - b).norm(), 3f64.sqrt(), cond, place);
            }};
        }
        compare!(found[0], Exp);
        compare!(found[1], Cay);
        compare!(found[2], CCSK123);
        compare!(found[3], CCSK321);
        compare!(found[4], CCSK);
    }
    Ok(found.into())
}
