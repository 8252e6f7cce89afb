//! Laws of G.

use faer::Mat;
use rand_pcg::Pcg64;

use super::super::represent::Represent;
use super::{EPS, Verdict, on_group, within};
use crate::support::gap;

/// Roundings of a product of two or three n×n factors, per ε·∏‖·‖.
const C_PRODUCT: f64 = 4.0;
/// Roundings of a random element, per ε·‖M‖·‖g‖².
const C_ELEMENT: f64 = 4.0;

/// The product is associative, has 𝟙, is the product of matrices, stays in G and acts on vectors.
pub(crate) fn group<G: Represent>(group: &G, rng: &mut Pcg64) -> Verdict {
    let [a, b, c] = core::array::from_fn(|_| group.sample_element(rng));
    let x = group.sample_vector(rng);
    let matrix = |g: &G::Elem| group.element_matrix(g);
    let [na, nb, nc] = [&a, &b, &c].map(|g| matrix(g).norm_l2());
    let (ab, bc) = (group.product(&a, &b), group.product(&b, &c));

    let bound = C_PRODUCT * EPS * na * nb;
    within("a·b", gap(&matrix(&ab), &(matrix(&a) * matrix(&b))), bound)?;
    let far = group.distance(&group.product(&ab, &c), &group.product(&a, &bc));
    within("(ab)c = a(bc)", far, 2.0 * C_PRODUCT * EPS * na * nb * nc)?;

    let one = group.identity();
    let n = matrix(&one).nrows();
    within("𝟙", gap(&matrix(&one), &Mat::identity(n, n)), 0.0)?;
    within("𝟙a = a", group.distance(&group.product(&one, &a), &a), 0.0)?;
    within("a𝟙 = a", group.distance(&group.product(&a, &one), &a), 0.0)?;
    let apart = (group.norm_ratio() * group.distance(&a, &b) - gap(&matrix(&a), &matrix(&b))).abs();
    within("distance(a, b) = ‖a − b‖", apart, C_PRODUCT * EPS * (na + nb))?;

    let mut y = x.clone();
    group.apply(&a, &x, &mut y);
    let x = group.vector_matrix(&x);
    let far = gap(&group.vector_matrix(&y), &group.applied(&matrix(&a), &x));
    within("apply(a, x) = a·x", far, C_PRODUCT * EPS * na * x.norm_l2())?;

    on_group("g ∈ G", group, &a, C_ELEMENT)?;
    on_group("ab ∈ G", group, &ab, 4.0 * C_ELEMENT)
}
