//! General against specialised at n = 3: the dense layer and the closed forms on so(3) are the same
//! maps, to 8 eps·cond, at every magnitude; and every branch of the dense layer is visited.

use std::collections::BTreeSet;

use lieflow::check::{Finding, laws, maps_agree, steps_agree};
use lieflow::groups::{LieGroup, MatrixGroup, Sample, So3};
use lieflow::maps::{CCSK, CCSK123, Cay, Dexpinv, Exp};
use lieflow::{CoordinateMap, LieAlgebra};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;

fn assert_all(found: &[Finding]) {
    for f in found {
        println!(
            "{:40} {:6} cases, worst {:8.2} of {}: {}",
            f.name, f.cases, f.worst, f.bound, f.at
        );
    }
    assert!(found.iter().all(Finding::holds));
}

#[test]
fn maps_and_inverse_differentials_on_100_000_vectors() {
    let found = maps_agree(&mut Pcg64::seed_from_u64(3), 100_000).expect("SO(3)");
    // dΨ⁻¹ is compared wherever neither layer is at a singularity.
    assert!(found.iter().all(|f| f.cases > 98_000));
    assert_all(&found);
}

#[test]
fn one_step_of_rkmk4_from_2000_states() {
    assert_all(&steps_agree(&mut Pcg64::seed_from_u64(4), 2000).expect("a rigid body"));
}

#[test]
fn laws_that_users_can_run() {
    let mut rng = Pcg64::seed_from_u64(6);
    let mut found = Vec::new();
    macro_rules! check {
        ($group:expr, $($psi:expr),*) => {$(
            found.extend(laws(&$group, &$psi, &mut rng, 50, 0.3).expect("the map serves the group"));
        )*};
    }
    check!(So3::new(), Exp, Cay, CCSK123, CCSK);
    check!(MatrixGroup::so(5).expect("SO(5)"), Exp, Cay, CCSK123, CCSK);
    check!(MatrixGroup::sp(4).expect("Sp(4)"), Exp, Cay);
    check!(MatrixGroup::gl(3).expect("GL(3)"), Exp, Cay);
    check!(MatrixGroup::indefinite(3, 1).expect("SO(3,1)"), Exp, Cay);
    assert_all(&found);
    // A dexp⁻¹ that is cut too early is seen.
    let broken = laws(&So3::new(), &Exp.truncated(0), &mut rng, 50, 0.3).expect("so(3)");
    assert!(broken.iter().any(|f| f.name.starts_with("dΨ⁻¹") && !f.holds()), "{broken:?}");
}
/// The choice made is part of the result: every degree, squarings and corrections, the series
/// and the eigen form are taken somewhere on a ladder of norms, and each is right there.
#[test]
fn every_branch_of_the_dense_exponential() {
    let mut rng = Pcg64::seed_from_u64(5);
    let (mut degrees, mut squarings, mut corrected) = (BTreeSet::new(), BTreeSet::new(), false);
    let (mut series, mut eigen) = (BTreeSet::new(), false);
    for n in [3usize, 5, 10] {
        let group = MatrixGroup::so(n).expect("SO(n)");
        let mut at = Exp.at(&group).expect("exp");
        for k in 0..300 {
            let size = 10f64.powf(-11.0 + 0.05 * f64::from(k));
            let mut u = group.zero();
            let direction = group.sample_algebra(&mut rng, 1.0);
            group.axpy(size / group.norm(&direction), &direction, &mut u);
            let mut g = group.identity();
            Exp.psi(&group, &u, &mut at, &mut g).expect("exp(u)");
            let choice = at.expm_choice();
            degrees.insert(choice.degree);
            squarings.insert(choice.squarings);
            corrected |= choice.corrections > 0;
            // exp(u)·exp(−u) = 𝟙 and the group, at rounding level.
            let mut minus = group.zero();
            group.axpy(-1.0, &u, &mut minus);
            let (back, mut product) =
                (Exp.eval(&group, &minus).expect("exp(−u)"), group.identity());
            group.compose(&g, &back, &mut product);
            let n = n as f64;
            let gap = group.distance(&product, &group.identity());
            assert!(gap <= 8.0 * n * EPS * size.max(1.0), "exp(u)exp(−u) at {size:e}: {gap:e}");
            let defect = group.defect(&g);
            assert!(defect <= 4.0 * n * EPS, "{choice:?} at {size:e}: defect {defect:e}");

            let mut v = group.sample_algebra(&mut rng, 1.0);
            if Exp.dpsi_inv(&group, &u, &mut at, &mut v).is_ok() {
                match at.dexpinv_choice() {
                    Dexpinv::Series(q) => drop(series.insert(q)),
                    Dexpinv::Eigen => eigen = true,
                    Dexpinv::None => panic!("no choice was recorded"),
                }
            }
        }
    }
    assert_eq!(degrees, BTreeSet::from([2, 4, 8, 12, 18]));
    assert!(squarings.len() >= 10 && corrected && eigen, "{squarings:?} {corrected} {eigen}");
    assert!(series.contains(&2) && series.len() >= 5, "{series:?}");
}
