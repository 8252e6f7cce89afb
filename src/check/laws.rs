//! The laws of a group with a coordinate map, at random elements.

use rand::Rng;

use super::Finding;
use crate::error::Error;
use crate::groups::Sample;
use crate::maps::CoordinateMap;
use crate::space::Metric;

/// The allowed error of a law, in units of ε·size. The size is stated where it is measured.
pub const LAW_BOUND: f64 = 4.0;

/// δ of the law of dΨ⁻¹: δ² = ε. A relative error of 1e-6 in dΨ⁻¹ is found.
const DELTA: f64 = 1.4901161193847656e-8;

/// δ of the law of commutators: δ³ = 2ε, and the δ²\[u, v\] that a missing bracket leaves is 3e5 ε.
const SMALL: f64 = 1.0 / 131072.0;

/// How far ‖moved − tangent‖² − ‖y − tangent‖² is from its change to first order, for y moved by δ along its tangent, and the
/// size of these squares. Inner products are by distances from `zero`.
fn off_direction<Y: Metric<Scalar = f64>>(
    [y, moved]: [&Y; 2],
    [tangent, zero]: [&Y; 2],
) -> (f64, f64) {
    let square = |a: &Y, b: &Y| a.distance(b).powi(2);
    let (length, size) = (square(tangent, zero), square(y, zero));
    let inner = 0.5 * (length + size - square(tangent, y));
    let change = square(moved, tangent) - square(y, tangent);
    ((change - 2.0 * DELTA * (inner - length)).abs(), 1.0 + length + size)
}

/// The laws of `group` with `psi`, at `cases` random elements of the algebra of standard deviation
/// `sigma`:
///
/// - bracket: \[u, v\] = −\[v, u\] and Jacobi's identity;
/// - Ψ(0) = 𝟙, Ψ(u) ∈ G;
/// - commutators: Ψ(δu)Ψ(δv) = Ψ(δ²\[u, v\])Ψ(δv)Ψ(δu) to second order in δ. So the bracket is that
///   of the group, in each part of it;
/// - dΨ⁻¹: Ψ(u + δ dΨ_u⁻¹v) = Ψ(δv)Ψ(u) to first order in δ, the definition of dΨ (8);
/// - action: (Ψ(u)Ψ(v))x = Ψ(u)(Ψ(v)x) for a vector x;
/// - tangents: Ψ(δv)g and Ψ(δw)g are δ‖vg − wg‖ apart to first order in δ, for g = Ψ(u), and so are Ψ(δv)x and Ψ(δw)x.
///   ‖Ψ(δv)g − vg‖² − ‖g − vg‖² = 2δ⟨vg, g − vg⟩ to first order, and likewise for x: this sees the sign;
/// - shortcuts, which a type may have for speed: a linear combination is the sum of its terms; Ψ(u)·x is Ψ(u) applied to x,
///   and dΨ_u⁻¹ after it is that after Ψ(u); storage that is used again gives the same; a correction moves no g = Ψ(u), and
///   no x from its own orbit.
///
/// # Errors
/// [`Error::Unsupported`] when the map has no formula on the group; a map's refusal of a random u.
pub fn laws<G, Psi, R>(
    group: &G,
    psi: &Psi,
    rng: &mut R,
    cases: usize,
    sigma: f64,
) -> Result<Vec<Finding>, Error>
where
    G: Sample<Scalar = f64>,
    Psi: CoordinateMap<G>,
    R: Rng + ?Sized,
{
    let named = |law: &str| format!("{law} on {} by {}", group.name(), psi.name());
    let mut bracket = Finding::new(format!("bracket on {}", group.name()), LAW_BOUND);
    let mut identity = Finding::new(named("Ψ(0) = 𝟙"), LAW_BOUND);
    let mut closure = Finding::new(named("Ψ(u) ∈ G"), LAW_BOUND);
    let mut commutators = Finding::new(named("[u, v] of commutators"), LAW_BOUND);
    let mut inverse = Finding::new(named("dΨ⁻¹"), LAW_BOUND);
    let mut action = Finding::new(named("(gh)x = g(hx)"), LAW_BOUND);
    let mut tangents = Finding::new(named("v·g and v·x"), LAW_BOUND);
    let mut shortcuts = Finding::new(named("shortcuts"), LAW_BOUND);

    let n = (group.dim() as f64).sqrt().max(1.0);
    let sum = |a: f64, x: &G::Alg, b: f64, y: &G::Alg| {
        let mut s = group.zero();
        group.axpy(a, x, &mut s);
        group.axpy(b, y, &mut s);
        s
    };
    let commutator = |x: &G::Alg, y: &G::Alg| {
        let mut out = group.zero();
        group.bracket(x, y, &mut out);
        out
    };
    let size_of = |g: &G::Elem| 1.0 + group.distance(g, &group.identity());

    let mut at = psi.at(group)?;
    let at_zero = psi.eval(group, &group.zero())?;
    identity.see(group.distance(&at_zero, &group.identity()), n, 1.0, String::new);
    for case in 0..cases {
        let place = || format!("case {case}");
        let [u, v, w] = [(); 3].map(|()| group.sample_algebra(rng, sigma));
        let norms = group.norm(&u) * group.norm(&v);
        let (uv, vu) = (commutator(&u, &v), commutator(&v, &u));
        bracket.see(group.norm(&sum(1.0, &uv, 1.0, &vu)), n * norms, 1.0, place);
        let cyclic = sum(1.0, &commutator(&uv, &w), 1.0, &commutator(&commutator(&v, &w), &u));
        let jacobi = sum(1.0, &cyclic, 1.0, &commutator(&commutator(&w, &u), &v));
        bracket.see(group.norm(&jacobi), n * norms * group.norm(&w), 1.0, place);

        let g = psi.eval(group, &u)?;
        closure.see(group.defect(&g), n * size_of(&g).powi(2), 1.0, place);

        let scaled = |a: f64, x: &G::Alg| psi.eval(group, &sum(a, x, 0.0, x));
        let product = |a: &G::Elem, b: &G::Elem| {
            let mut out = group.identity();
            group.compose(a, b, &mut out);
            out
        };
        let (a, b) = (scaled(SMALL, &u)?, scaled(SMALL, &v)?);
        let swapped = product(&scaled(SMALL * SMALL, &uv)?, &product(&b, &a));
        let third_order = (SMALL * (group.norm(&u) + group.norm(&v))).powi(3) / f64::EPSILON;
        commutators.see(group.distance(&product(&a, &b), &swapped), n + third_order, 1.0, place);

        // A wrong dΨ⁻¹ differs by O(δ), a right one by O(δ²) = O(ε), the size of rounding.
        let k = psi.eval_dpsi_inv(group, &u, &v)?;
        let moved = product(&scaled(DELTA, &v)?, &g);
        let gap = group.distance(&psi.eval(group, &sum(1.0, &u, DELTA, &k))?, &moved);
        let speed = (group.norm(&k) + group.norm(&v)).powi(2);
        let second_order = size_of(&g) * speed * (1.0 + group.norm(&u)).powi(2);
        inverse.see(gap, second_order + n * size_of(&g), 1.0, place);

        let x = group.sample_vector(rng);
        let apply = |g: &G::Elem, x: &G::Vector| {
            let mut out = x.clone();
            group.apply(g, x, &mut out);
            out
        };
        let h = psi.eval(group, &v)?;
        let (both, one_by_one) = (apply(&product(&g, &h), &x), apply(&g, &apply(&h, &x)));
        let size = (1.0 + x.size()) * size_of(&g) * size_of(&h);
        action.see(both.distance(&one_by_one), n * size, 1.0, place);

        let (near, other) = (scaled(DELTA, &v)?, scaled(DELTA, &w)?);
        let tangent = |v: &G::Alg| {
            let mut out = group.identity();
            group.tangent(v, &g, &mut out);
            out
        };
        let generated = |v: &G::Alg| {
            let mut out = x.clone();
            group.apply_algebra(v, &x, &mut out);
            out
        };
        let lengths = 1.0 + (group.norm(&v) + group.norm(&w)).powi(2);
        let of_g = DELTA * tangent(&v).distance(&tangent(&w));
        let moved = product(&near, &g);
        let gap = (moved.distance(&product(&other, &g)) - of_g).abs();
        tangents.see(gap, n * lengths * size_of(&g), 1.0, place);
        let (gap, size) = off_direction([&g, &moved], [&tangent(&v), &tangent(&group.zero())]);
        tangents.see(gap, n * lengths * size, 1.0, place);
        let of_x = DELTA * generated(&v).distance(&generated(&w));
        let moved = apply(&near, &x);
        let gap = (moved.distance(&apply(&other, &x)) - of_x).abs();
        tangents.see(gap, n * lengths * (1.0 + x.size()), 1.0, place);
        let (gap, size) = off_direction([&x, &moved], [&generated(&v), &generated(&group.zero())]);
        tangents.see(gap, n * lengths * size, 1.0, place);

        let mut combined = v.clone();
        group.combine(0.5, &[2.0, 0.0, -3.0], &[u.clone(), v.clone(), w.clone()], &mut combined);
        let gap = group.norm(&sum(1.0, &combined, -1.0, &sum(1.0, &u, -1.5, &w)));
        shortcuts.see(gap, n * (group.norm(&u) + group.norm(&w)), 1.0, place);
        let (mut on, mut scratch, mut other) = (x.clone(), group.identity(), group.identity());
        psi.psi_on(group, &u, &mut at, &mut scratch, &x, &mut on)?;
        shortcuts.see(on.distance(&apply(&g, &x)), n * (1.0 + x.size()) * size_of(&g), 1.0, place);
        let mut after = v.clone();
        psi.dpsi_inv(group, &u, &mut at, &mut after)?;
        let gap = group.norm(&sum(1.0, &after, -1.0, &k));
        let size = (group.norm(&k) + group.norm(&v)) * (1.0 + group.norm(&u)).powi(2);
        shortcuts.see(gap, n * size, 1.0, place);
        psi.psi(group, &u, &mut at, &mut scratch)?;
        shortcuts.see(group.distance(&scratch, &g), n * size_of(&g), 1.0, place);
        let mut corrected = g.clone();
        group.correct(&mut corrected, [&mut scratch, &mut other]);
        let size = n * size_of(&g).powi(2);
        shortcuts.see(group.distance(&corrected, &g), size, 1.0, place);
        let mut corrected = x.clone();
        group.correct_vector(&x, &mut corrected);
        shortcuts.see(corrected.distance(&x), n * (1.0 + x.size()), 1.0, place);
    }
    Ok(vec![bracket, identity, closure, commutators, inverse, action, tangents, shortcuts])
}
