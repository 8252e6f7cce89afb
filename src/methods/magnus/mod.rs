//! Magnus methods for linear equations y' = A(t) y.
//!
//! y⁺ = exp(Ω) y with Ω from A at Gauss–Legendre nodes. They need the trait [`LinearField`], so a field that depends on
//! y does not compile.
//!
//! | method | order | A | brackets | exp | source |
//! |---|---|---|---|---|---|
//! | [`Magnus4`] | 4 | 2 | 1 | 1 | Iserles, Nørsett 1999 |
//! | [`Magnus6`] | 6 | 3 | 3 | 1 | Blanes, Casas, Ros 2002 |
//! | [`Magnus8`] | 8 | 4 | 10 | 1 | Blanes, Casas, Ros 2000 |
//! | [`CFM4_2`], [`CFM4_3`] | 4 | 2, 3 | 0 | 2, 3 | Blanes, Moan 2006; Alvermann, Fehske 2011 |
//! | [`CFM6_5`] | 6 | 3 | 0 | 5 | Alvermann, Fehske 2011 |
//! | [`CFM8_11`] | 8 | 4 | 0 | 11 | the same |
//! | [`CayleyMagnus4`], [`CayleyMagnus6`] | 4, 6 | 2, 3 | 1, 5 and as many triple products | 1 cay | Iserles 2001 |
//!
//! Preserves: the group, the invariants of the action, and time symmetry. On SL(n) and SU(n), n > 2, [`CayleyMagnus4`] and
//! [`CayleyMagnus6`] leave det = 1 by the error of the method. Cost: see the table.
//! Source: S. Blanes, F. Casas, J. A. Oteo, J. Ros, The Magnus expansion and some of its
//! applications, Phys. Rep. 470 (2009).
//!
//! ```compile_fail
//! use lieflow::methods::magnus::Magnus4;
//! use lieflow::problems::RigidBody;
//! let body = RigidBody::<f64>::new([1.0, 2.0, 3.0]).unwrap();
//! // f depends on the momentum, so Magnus4 does not compile.
//! lieflow::Method::facts(&Magnus4, &body);
//! ```

mod cayley;
mod expansion;
#[cfg(feature = "dense")]
mod general;
mod products;

pub use cayley::{CayleyMagnus4, CayleyMagnus6, TripleProduct};
pub use expansion::{Magnus4, Magnus6, Magnus8};
pub use products::{CFM4_2, CFM4_3, CFM6_5, CFM8_11, CfMagnus, CfMagnusTableau};

use super::Step;
use super::stages::copies;
use crate::chart::ChartStore;
use crate::error::{Error, StepError};
use crate::groups::LieAlgebra;
use crate::maps::CoordinateMap;
use crate::problems::{AlgOf, LinearField, PointOf, ScalarOf};
use crate::scalar::Real;

/// √3 and √15.
const ROOT_3: f64 = 1.7320508075688772935;
const ROOT_15: f64 = 3.8729833462074168852;

/// The Gauss–Legendre nodes on \[0, 1\] of order 4, 6 and 8.
const GAUSS_2: [f64; 2] = [0.5 - ROOT_3 / 6.0, 0.5 + ROOT_3 / 6.0];
const GAUSS_3: [f64; 3] = [0.5 - ROOT_15 / 10.0, 0.5, 0.5 + ROOT_15 / 10.0];
const GAUSS_4: [f64; 4] = [0.5 - V[0], 0.5 - V[1], 0.5 + V[1], 0.5 + V[0]];
/// Distances of the four nodes from the middle, and their weights (of sum ½).
const V: [f64; 2] = [0.43056815579702628761, 0.16999052179242813240];
const W: [f64; 2] = [0.17392742256872692869, 0.32607257743127307131];

/// Values of A, scratch in 𝔤 (the first holds the increment), and the chart.
#[allow(missing_debug_implementations)] // the parts belong to the problem's types
#[doc(hidden)]
pub struct MagnusWork<P: LinearField, Psi: CoordinateMap<P::Group>, const S: usize, const K: usize>
{
    a: [AlgOf<P>; S],
    scratch: [AlgOf<P>; K],
    y: PointOf<P>,
    field: P::Work,
    chart: ChartStore<P, Psi>,
}

impl<P: LinearField, Psi: CoordinateMap<P::Group>, const S: usize, const K: usize>
    MagnusWork<P, Psi, S, K>
{
    fn new(problem: &P, psi: &Psi, like: &PointOf<P>) -> Result<Self, Error> {
        let alg = problem.group();
        Ok(MagnusWork {
            a: copies(alg.zero()),
            scratch: copies(alg.zero()),
            y: like.clone(),
            field: problem.work(),
            chart: ChartStore::new(problem, psi, like)?,
        })
    }

    /// A at the nodes; y is any point.
    #[inline]
    fn sample(
        &mut self,
        problem: &P,
        nodes: &[f64; S],
        Step { t, h, .. }: Step<ScalarOf<P>>,
        y: &PointOf<P>,
    ) -> Result<(), StepError> {
        for (i, (a, c)) in self.a.iter_mut().zip(nodes).enumerate() {
            problem.f(t + h * ScalarOf::<P>::lit(*c), y, a, &mut self.field);
            if !problem.group().is_finite(a) {
                return Err(StepError::NonFiniteRhs { stage: i + 1 });
            }
        }
        Ok(())
    }

    /// y ← Ψ(u) y, with u in `scratch[0]`.
    #[inline]
    fn apply(
        &mut self,
        problem: &P,
        psi: &Psi,
        n: u64,
        y: &mut PointOf<P>,
    ) -> Result<(), StepError> {
        let u = &self.scratch[0];
        StepError::finite(problem.group().is_finite(u), "the increment Ω")?;
        self.chart.around(problem, psi, n, y).lambda(u, &mut self.y)?;
        core::mem::swap(y, &mut self.y);
        Ok(())
    }
}

/// out ← Σ c·x.
#[inline]
fn sum<G: LieAlgebra, const N: usize>(
    group: &G,
    terms: [(G::Scalar, &G::Alg); N],
    out: &mut G::Alg,
) {
    group.set_zero(out);
    for (c, x) in terms {
        group.axpy(c, x, out);
    }
}

/// A Magnus method with S nodes, K elements of scratch, one map and so many brackets.
macro_rules! magnus_method {
    ($method:ident, $order:expr, $nodes:expr, $psi:ident, $s:literal, $k:literal, [$($bound:path)?],
     $omega:path, $brackets:literal) => {
        impl<P: crate::problems::LinearField> crate::methods::Method<P> for $method
        where
            $psi: CoordinateMap<P::Group>,
            $(P::Group: $bound,)?
        {
            type Work = MagnusWork<P, $psi, $s, $k>;

            fn facts(&self, _: &P) -> crate::methods::Facts {
                let maps = crate::methods::MapCounts { psi: 1, dpsi_inv: 0, brackets: $brackets };
                crate::methods::Facts::of_order($order).cost(Some($s), maps).stages_within()
            }
            fn work(&self, problem: &P, like: &PointOf<P>) -> Result<Self::Work, Error> {
                MagnusWork::new(problem, &$psi, like)
            }
            #[inline]
            fn step(
                &self,
                problem: &P,
                step: Step<ScalarOf<P>>,
                y: &mut PointOf<P>,
                work: &mut Self::Work,
            ) -> Result<(), StepError> {
                work.sample(problem, &$nodes, step, y)?;
                $omega(problem.group(), step.h, &work.a, &mut work.scratch);
                work.apply(problem, &$psi, step.n, y)
            }
        }
    };
}
use magnus_method;
