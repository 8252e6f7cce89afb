//! Laws of 𝔤: a linear space with a bracket.

use rand::RngExt;
use rand_pcg::Pcg64;

use super::super::represent::Represent;
use super::{EPS, Verdict, commutator, in_algebra, scale, within};
use crate::support::{gap, size};

/// Roundings of one n×n product, per ε·‖a‖·‖b‖.
const C_PRODUCT: f64 = 4.0;
/// Roundings of the projection that random elements come from, per ε·‖u‖.
const C_SAMPLE: f64 = 8.0;

/// The bracket is bilinear, antisymmetric, satisfies Jacobi's identity and is uv − vu; it and the
/// linear operations stay in 𝔤.
pub(crate) fn algebra<G: Represent>(group: &G, rng: &mut Pcg64) -> Verdict {
    let [u, v, w] = core::array::from_fn(|_| {
        let size = size(rng, 10.0);
        group.of_size(rng, size)
    });
    let (a, b) = (rng.random_range(-2.0..2.0), rng.random_range(-2.0..2.0));
    let matrix = |u: &G::Alg| group.algebra_matrix(u);
    // Sizes in the Frobenius norm of the matrices, whatever norm the group has.
    let [nu, nv, nw] = [&u, &v, &w].map(|u| matrix(u).norm_l2());
    let uv = group.commutator(&u, &v);

    let bound = C_PRODUCT * EPS * nu * nv;
    within("[u,v] = uv − vu", gap(&matrix(&uv), &commutator(&matrix(&u), &matrix(&v))), bound)?;
    let vu = group.commutator(&v, &u);
    within("[u,v] = −[v,u]", group.norm(&group.moved(&uv, 1.0, &vu)), bound)?;

    let mix = group.moved(&group.scaled(a, &u), b, &w); // au + bw
    let sum = group.moved(&group.scaled(a, &uv), b, &group.commutator(&w, &v));
    let bound = C_PRODUCT * EPS * (a.abs() * nu + b.abs() * nw) * nv;
    let mixed = group.commutator(&mix, &v);
    within("[au+bw,v] = a[u,v]+b[w,v]", group.norm(&group.moved(&mixed, -1.0, &sum)), bound)?;

    let mut cycle = group.commutator(&u, &group.commutator(&v, &w));
    for (x, y, z) in [(&v, &w, &u), (&w, &u, &v)] {
        group.axpy(1.0, &group.commutator(x, &group.commutator(y, z)), &mut cycle);
    }
    within("Jacobi", group.norm(&cycle), 4.0 * C_PRODUCT * EPS * nu * nv * nw)?;

    let (h, weights) = (rng.random_range(-1.0..1.0), [0.5, 0.0, -0.25]);
    let mut combined = w.clone(); // must be overwritten
    group.combine(h, &weights, &[u.clone(), v.clone(), w.clone()], &mut combined);
    let expected = scale(0.5 * h, &matrix(&u)) - scale(0.25 * h, &matrix(&w));
    within("combine", gap(&matrix(&combined), &expected), C_PRODUCT * EPS * (nu + nw))?;

    in_algebra("u ∈ 𝔤", group, &u, C_SAMPLE, nu)?;
    in_algebra("au + bw ∈ 𝔤", group, &mix, 2.0 * C_SAMPLE, nu + nw)?;
    in_algebra("[u,v] ∈ 𝔤", group, &uv, 2.0 * C_SAMPLE, nu * nv)
}
