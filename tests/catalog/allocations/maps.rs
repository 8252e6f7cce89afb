//! Ψ and dΨ⁻¹ allocate nothing once their storage is made, in every branch: the series, the eigen
//! form and the halvings of dexp⁻¹, doubling and Schur coordinates of the Padé map, ccsk on every
//! group it serves, and the correction of drift.

use lieflow::groups::{MatrixGroup, Sample, Unitary};
use lieflow::maps::{CCSK, Cay, CoordinateMap, Exp, Pade22};
use lieflow::{LieAlgebra, LieGroup};
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// The allocations of the second Ψ and dΨ⁻¹ (the product library makes its packing buffer at the
/// first large product).
fn allocations<G: Sample<Scalar = f64>, Psi: CoordinateMap<G>>(
    psi: &Psi,
    group: &G,
    size: f64,
) -> usize {
    let mut rng = Pcg64::seed_from_u64(group.dim() as u64);
    let before = crate::counting::total();
    let mut at = psi.at(group).expect("the map serves the group");
    assert!(crate::counting::total() > before, "the counter does not count");
    let direction = group.sample_algebra(&mut rng, 1.0);
    let mut u = group.zero();
    group.axpy(size / group.norm(&direction), &direction, &mut u);
    let (mut v, mut g) = (group.sample_algebra(&mut rng, 1.0), group.identity());
    let mut before = 0;
    for _ in 0..2 {
        before = crate::counting::total();
        psi.psi(group, &u, &mut at, &mut g).expect("Ψ(u)");
        psi.dpsi_inv(group, &u, &mut at, &mut v).expect("dΨ⁻¹");
    }
    crate::counting::total() - before
}

#[test]
fn unitary() {
    for n in [2, 4, 10, 20] {
        let group = Unitary::new(n).expect("U(n)");
        for size in [0.1, 1.0, 5.0] {
            assert_eq!(allocations(&Exp, &group, size), 0, "exp on U({n}) at {size}");
            assert_eq!(allocations(&Cay, &group, size), 0, "cay on U({n}) at {size}");
        }
    }
}

#[test]
fn every_branch() {
    for n in [2, 4, 6, 10, 20, 40] {
        for group in [
            MatrixGroup::so(n),
            MatrixGroup::gl(n),
            MatrixGroup::indefinite(n - 1, 1),
            MatrixGroup::sp(n),
        ] {
            let group = group.expect("a group");
            for size in [0.1, 1.0, 5.0] {
                let place = format!("on {} at {size}", group.name());
                assert_eq!(allocations(&Exp, &group, size), 0, "exp {place}");
                assert_eq!(allocations(&Pade22, &group, size), 0, "pade22 {place}");
                assert_eq!(allocations(&Cay, &group, size), 0, "cay {place}");
                if CCSK.at(&group).is_ok() {
                    assert_eq!(allocations(&CCSK, &group, 0.1), 0, "ccsk {place}");
                }
            }
            let mut g = group.sample_element(&mut Pcg64::seed_from_u64(1));
            g[(0, 0)] += 1e-9;
            let mut scratch = [group.identity(), group.identity()];
            group.correct(&mut g, scratch.each_mut());
            let before = crate::counting::total();
            g[(0, 0)] += 1e-9;
            group.correct(&mut g, scratch.each_mut());
            assert_eq!(crate::counting::total(), before, "correction on {}", group.name());
        }
    }
}
