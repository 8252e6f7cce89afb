//! Crouch–Grossman methods: products of exponentials of one stage each.
//!
//! Y_i = exp(h a_i,i−1 k_{i−1}) ⋯ exp(h a_i1 k_1) y, y⁺ = exp(h b_s k_s) ⋯ exp(h b_1 k_1) y: the
//! first stage acts first. With the reverse sequence the methods of order 3 and 4 would have order 2.
//!
//! | table | order | stages | exponentials | source |
//! |---|---|---|---|---|
//! | [`CG2`] | 2 | 2 | 2 | the midpoint rule |
//! | [`CG3`] | 3 | 3 | 6 | Crouch, Grossman 1993; Owren, Marthinsen 1999 |
//! | [`CG4`] | 4 | 5 | 15 | Jackiewicz, Marthinsen, Owren 2000 (CG4a) |
//!
//! They are tables of [`CommutatorFree`](super::CommutatorFree). The map is exp. Cost: see the table.
//! Preserves: the group, and the invariants of the action. Source: P. Crouch, R. Grossman,
//! Numerical integration of ordinary differential equations on manifolds, J. Nonlinear Sci. 3 (1993).

use super::commutator_free::{ExponentialProduct, ProductTableau, stages, start};
use super::tableau::pad;

/// The weights that select stage j.
const fn only<const S: usize>(j: usize, weight: f64) -> [f64; S] {
    let mut w = [0.0; S];
    w[j] = weight;
    w
}

/// The first rows of a diagonal matrix.
const fn factors<const S: usize, const N: usize>(weights: [f64; N]) -> [[f64; S]; N] {
    let mut all = [[0.0; S]; N];
    let mut j = 0;
    while j < N {
        all[j] = only(j, weights[j]);
        j += 1;
    }
    all
}

/// Order 2 with 2 stages.
pub const CG2: ProductTableau<2> = cg2();

/// [`CG2`] with room for S stages.
pub(crate) const fn cg2<const S: usize>() -> ProductTableau<S> {
    ProductTableau {
        name: "cg2",
        order: 2,
        c: pad(&[0.0, 0.5]),
        stages: stages([ExponentialProduct { from: 0, factors: const { &factors([0.5]) } }]),
        update: ExponentialProduct { from: 0, factors: const { &[only(1, 1.0)] } },
        update_stages: 2,
        embedded: None,
    }
}

/// Order 3 with 3 stages.
pub const CG3: ProductTableau<3> = cg3();

/// [`CG3`] with room for S stages.
pub(crate) const fn cg3<const S: usize>() -> ProductTableau<S> {
    ProductTableau {
        name: "cg3",
        order: 3,
        c: pad(&[0.0, 0.75, 17.0 / 24.0]),
        stages: stages([
            ExponentialProduct { from: 0, factors: const { &factors([0.75]) } },
            ExponentialProduct {
                from: 0,
                factors: const { &factors([119.0 / 216.0, 17.0 / 108.0]) },
            },
        ]),
        update: ExponentialProduct {
            from: 0,
            factors: const { &factors([13.0 / 51.0, -2.0 / 3.0, 24.0 / 17.0]) },
        },
        update_stages: 3,
        embedded: None,
    }
}

const A2: [f64; 1] = [0.8177227988124852];
const A3: [f64; 2] = [0.3199876375476427, 0.0659864263556022];
const A4: [f64; 3] = [0.9214417194464946, 0.4997857776773573, -1.0969984448371582];
const A5: [f64; 4] =
    [0.3552358559023322, 0.2390958372307326, 1.3918565724203246, -1.1092979392113465];

/// Order 4 with 5 stages.
pub const CG4: ProductTableau<5> = ProductTableau {
    name: "cg4",
    order: 4,
    c: [0.0, A2[0], A3[0] + A3[1], A4[0] + A4[1] + A4[2], A5[0] + A5[1] + A5[2] + A5[3]],
    stages: [
        start(),
        ExponentialProduct { from: 0, factors: &factors(A2) },
        ExponentialProduct { from: 0, factors: &factors(A3) },
        ExponentialProduct { from: 0, factors: &factors(A4) },
        ExponentialProduct { from: 0, factors: &factors(A5) },
    ],
    update: ExponentialProduct {
        from: 0,
        factors: &factors([
            0.1370831520630755,
            -0.0183698531564020,
            0.7397813985370780,
            -0.1907142565505889,
            0.3322195591068374,
        ]),
    },
    update_stages: 5,
    embedded: None,
};
