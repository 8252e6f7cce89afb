//! The Lie series in the frame that moves: the attitude of a free body in ℝ⁵ with the momentum m_s in space,
//! ġ = gΩ(m), m = gᵀm_s g, Ω_ij = m_ij/(λ_i + λ_j). It is `RigidBodyNAttitude`, and one step of that is held
//! to one step here.

use lieflow::actions::LeftTranslation;
use lieflow::catalog::Needs;
use lieflow::groups::{MatrixGroup, Sample};
use lieflow::problems::{Problem, RigidBodyN, RigidBodyNAttitude, TaylorField};
use lieflow::scalar::Real;
use lieflow::{LieAlgebra, LieGroup};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::D;
use super::agreement::{same_steps, wide};
use super::group::Matrices;
use super::lie_poisson::rate;
use super::members::{Span, high_orders, lie_series, members};
use super::square::Square;

const LAMBDA: [f64; 5] = [0.5, 0.9, 1.3, 1.7, 2.1];

struct Attitude {
    group: Matrices,
    momentum: Square,
}

fn omega(m: &Square) -> Square {
    Square::from_fn(m.n(), |i, j| {
        (m[(i, j)] - m[(j, i)]) * D::lit(0.5) / D::lit(LAMBDA[i] + LAMBDA[j])
    })
}

impl Attitude {
    fn in_the_body(&self, g: &Square) -> Square {
        g.transpose() * self.momentum * *g
    }
}

impl Problem for Attitude {
    type Group = Matrices;
    type Action = LeftTranslation;
    type Work = ();
    fn group(&self) -> &Matrices {
        &self.group
    }
    fn action(&self) -> &LeftTranslation {
        &LeftTranslation
    }
    fn work(&self) {}
    fn f(&self, _: D, g: &Square, v: &mut Square, (): &mut ()) {
        *v = *g * omega(&self.in_the_body(g)) * g.transpose();
    }
}

/// Ω_k in the frame of the start, g Ω_k gᵀ, with the m_k of the momentum in the body: ṁ = mΩ − Ωm.
impl TaylorField for Attitude {
    const MOVING: bool = true;
    type Series = Vec<Square>;

    fn series(&self, order: usize) -> Vec<Square> {
        vec![self.group.zero(); order + 1]
    }
    fn coefficient(
        &self,
        [_, h]: [D; 2],
        g: &Square,
        k: usize,
        f: &mut [Square],
        series: &mut Vec<Square>,
    ) {
        series[k] = match k {
            0 => self.in_the_body(g),
            _ => {
                let rates = (0..k).map(|i| {
                    let turn = omega(&series[k - 1 - i]);
                    rate(&series[i], &turn.transpose())
                });
                rates.fold(self.group.zero(), |sum, x| sum + x) * (h / D::lit(k as f64))
            }
        };
        f[k] = *g * omega(&series[k]) * g.transpose();
    }
}

/// A momentum of length 3 in space that is nothing special.
fn momentum(i: u64) -> faer::Mat<f64> {
    let so5 = MatrixGroup::so(5).unwrap();
    let m = so5.sample_algebra(&mut Pcg64::seed_from_u64(80 + i), 1.0);
    let size = so5.norm(&m);
    m.into_mat() * faer::Scale(3.0 / size)
}

fn attitude(i: u64) -> (Attitude, Square) {
    let group = Matrices::so5();
    let start = group.identity();
    (Attitude { group, momentum: wide(&momentum(i)) }, start)
}

#[test]
fn attitudes_on_so5() {
    let all = members(4, Span { length: 2.0, rate: 48.0, gap: 1e-28 }, attitude);
    high_orders("attitudes", "SO(5)", &[Needs::Series], |spec| lie_series(spec, &all));
}

#[test]
fn a_step_of_the_library_is_the_same() {
    let body = RigidBodyN::manakov(&LAMBDA).unwrap();
    let library = RigidBodyNAttitude::new(body, momentum(0)).unwrap();
    let start = library.group().identity();
    same_steps((&library, start), |g| &**g, attitude(0), 1.3);
}
