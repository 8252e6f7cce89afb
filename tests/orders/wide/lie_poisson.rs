//! The Lie series on quadratic Lie–Poisson systems: ṁ = ξᵀm − mξᵀ, ξ = π(D ∘ π(m)), with weights D that are
//! nothing special and π the projection on 𝔤. They are those of `systems`, and one step of the library on
//! its own matrices is held to one step here.

use lieflow::LieAlgebra;
use lieflow::actions::{Action, Coadjoint};
use lieflow::catalog::Needs;
use lieflow::groups::{MatrixGroup, Sample};
use lieflow::methods::Metric;
use lieflow::problems::{Problem, TaylorField};
use lieflow::scalar::Real;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use super::D;
use super::agreement::{same_steps, wide};
use super::group::Matrices;
use super::members::{UNIT_FINE, high_orders, lie_series, members};
use super::square::Square;
use crate::support::systems;

/// Λ(g, m) = g⁻ᵀ m gᵀ.
impl Action<Matrices> for Coadjoint {
    type Point = Square;
    type Work = ();

    fn work(&self, _: &Matrices) {}
    fn act(&self, _: &Matrices, g: &Square, m: &Square, q: &mut Square, (): &mut ()) {
        *q = g.transpose().solve(*m) * g.transpose();
    }
    fn generate(&self, _: &Matrices, v: &Square, m: &Square, dm: &mut Square, (): &mut ()) {
        *dm = rate(m, v);
    }
}

/// The system on one of the groups.
struct Quadratic(Matrices);

impl Quadratic {
    /// −ξ.
    fn f(&self, m: &Square) -> Square {
        let part = self.0.project(m);
        let weighted = Square::from_fn(m.n(), |i, j| {
            part[(i, j)] * D::lit(0.4 + 0.3 * ((3 * i + 5 * j) % 7) as f64)
        });
        self.0.project(&weighted) * D::lit(-1.0)
    }
}

/// mfᵀ − fᵀm.
pub(crate) fn rate(m: &Square, f: &Square) -> Square {
    let f = f.transpose();
    *m * f - f * *m
}

impl Problem for Quadratic {
    type Group = Matrices;
    type Action = Coadjoint;
    type Work = ();
    fn group(&self) -> &Matrices {
        &self.0
    }
    fn action(&self) -> &Coadjoint {
        &Coadjoint
    }
    fn work(&self) {}
    fn f(&self, _: D, m: &Square, v: &mut Square, (): &mut ()) {
        *v = self.f(m);
    }
}

/// k m_k = h Σ_{i+j=k−1} (m_i f_jᵀ − f_jᵀ m_i).
impl TaylorField for Quadratic {
    type Series = Vec<Square>;

    fn series(&self, order: usize) -> Vec<Square> {
        vec![self.0.zero(); order + 1]
    }
    fn coefficient(
        &self,
        [_, h]: [D; 2],
        m: &Square,
        k: usize,
        f: &mut [Square],
        series: &mut Vec<Square>,
    ) {
        series[k] = match k {
            0 => *m,
            _ => {
                let rates = series[..k].iter().zip(f[..k].iter().rev()).map(|(m, f)| rate(m, f));
                rates.fold(self.0.zero(), |sum, x| sum + x) * (h / D::lit(k as f64))
            }
        };
        f[k] = self.f(&series[k]);
    }
}

/// The group of the library, ours, and a momentum.
fn systems() -> impl Iterator<Item = (MatrixGroup, Matrices, Square)> {
    let ours = [Matrices::so5(), Matrices::sp4(), Matrices::gl3(), Matrices::so31()];
    systems::systems().into_iter().zip(ours).map(|((library, m), ours)| {
        assert_eq!(library.name(), ours.name());
        (library, ours, wide(&m))
    })
}

/// The lists of which every method of order 8 and more is measured here.
const NEEDS: [Needs; 3] = [Needs::Series, Needs::LiePoisson, Needs::Isospectral];

/// One test a group: where it is not compact the motion runs away, and a shorter momentum is as far.
macro_rules! measure {
    ($($name:ident: $group:literal, $length:literal;)*) => {$(
        #[test]
        fn $name() {
            let (library, ours, start) =
                systems().find(|(library, ..)| library.name() == $group).unwrap();
            // Near one another, so that none of them is at rounding before the others.
            let all = members(4, UNIT_FINE, |i| {
                let aside = library.sample_algebra(&mut Pcg64::seed_from_u64(60 + i), 1.0);
                let m = start + wide(&aside) * D::lit(0.4 / library.norm(&aside));
                (Quadratic(ours.clone()), m * (D::lit($length) / m.size()))
            });
            high_orders("quadratic systems", $group, &NEEDS, |spec| lie_series(spec, &all));
        }
    )*};
}
measure! {
    lie_poisson_on_so5: "SO(5)", 3.0;
    lie_poisson_on_gl3: "GL(3)", 0.7;
    lie_poisson_on_sp4: "Sp(4)", 0.7;
    lie_poisson_on_so31: "SO(3,1)", 0.7;
}

/// Steps so long that every term of the series is far above rounding.
const LONG: [f64; 4] = [1.6, 0.4, 0.4, 0.8];

#[test]
fn a_step_of_the_library_is_the_same() {
    for ((library, ours, start), h) in systems().zip(LONG) {
        let m = faer::Mat::from_fn(start.n(), start.n(), |i, j| start[(i, j)].value());
        same_steps((&systems::quadratic(library), m), |m| m, (Quadratic(ours), start), h);
    }
}
