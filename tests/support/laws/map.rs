//! Laws of a coordinate map Ψ with dΨ⁻¹.

use faer::Mat;
use lieflow::{CoordinateMap, Error};
use rand::RngExt;
use rand_pcg::Pcg64;

use super::super::represent::Represent;
use super::{EPS, Verdict, in_algebra, on_group, scale, within};
use crate::support::{gap, same_bits, size};

/// Roundings of Ψ(u) and of Ψ(u)·x: a few products and one solve, per ε·‖Ψ(u)‖.
const C_PSI: f64 = 8.0;
/// Roundings of Ψ(u) in the form it keeps, per ε·‖M‖·‖Ψ(u)‖².
const C_CLOSURE: f64 = 4.0;
/// Distance of dΨ⁻¹v from 𝔤, per ε·‖M‖·‖v‖: a few products.
const C_ALGEBRA: f64 = 8.0;
/// The remainder of the five-point rule, per step⁴·‖w‖·‖Ψ(u)‖.
const C_STENCIL: f64 = 10.0;

/// Roundings of three exponentials, per ε·(1 + ‖u‖)·‖·‖.
const C_SUBGROUP: f64 = 8.0;

fn say(error: impl Into<Error>) -> String {
    format!("refused within its domain: {}", error.into())
}

/// Every law, for an u of a size up to `cap`.
pub(crate) fn map<G: Represent, Psi: CoordinateMap<G>>(
    group: &G,
    psi: &Psi,
    cap: f64,
    rng: &mut Pcg64,
) -> Verdict {
    at_zero(group, psi, rng)?;
    closure(group, psi, cap, rng)?;
    differential(group, psi, cap, rng)?;
    on_vectors(group, psi, cap, rng)?;
    history(group, psi, cap, rng)
}

/// Ψ(0) = 𝟙, dΨ₀⁻¹ = id, Ψ'(0) = id.
pub(crate) fn at_zero<G: Represent, Psi: CoordinateMap<G>>(
    group: &G,
    psi: &Psi,
    rng: &mut Pcg64,
) -> Verdict {
    let zero = group.zero();
    let one = group.element_matrix(&group.identity());
    let g = psi.eval(group, &zero).map_err(say)?;
    within("Ψ(0) = 𝟙", gap(&group.element_matrix(&g), &one), EPS)?;
    let v = group.of_size(rng, 1.0);
    let w = psi.eval_dpsi_inv(group, &zero, &v).map_err(say)?;
    within("dΨ₀⁻¹ = id", group.norm(&group.moved(&w, -1.0, &v)), 4.0 * EPS)?;
    second_order("Ψ(εv) = 𝟙 + εv + O(ε²)", |e| {
        let g = psi.eval(group, &group.scaled(e, &v)).map_err(say)?;
        let linear = &one + scale(e, &group.algebra_matrix(&v));
        Ok((gap(&group.element_matrix(&g), &linear), one.norm_l2()))
    })
}

/// Ψ(u) ∈ G.
pub(crate) fn closure<G: Represent, Psi: CoordinateMap<G>>(
    group: &G,
    psi: &Psi,
    cap: f64,
    rng: &mut Pcg64,
) -> Verdict {
    let size = size(rng, cap);
    let u = group.of_size(rng, size);
    on_group("Ψ(u) ∈ G", group, &psi.eval(group, &u).map_err(say)?, C_CLOSURE)
}

/// dΨ⁻¹ is what (8) says: Ψ(u + ε dΨ_u⁻¹v) = Ψ(εv)Ψ(u) + O(ε²), and d/dε Ψ(u + εw) = vΨ(u) for
/// w = dΨ_u⁻¹v by the five-point rule; w ∈ 𝔤.
pub(crate) fn differential<G: Represent, Psi: CoordinateMap<G>>(
    group: &G,
    psi: &Psi,
    cap: f64,
    rng: &mut Pcg64,
) -> Verdict {
    let size = size(rng, cap);
    let (u, v) = (group.of_size(rng, size), group.of_size(rng, 1.0));
    let w = psi.eval_dpsi_inv(group, &u, &v).map_err(say)?;
    in_algebra("dΨ_u⁻¹v ∈ 𝔤", group, &w, C_ALGEBRA, 1.0)?;

    let at = |u: &G::Alg| -> Result<Mat<f64>, String> {
        Ok(group.element_matrix(&psi.eval(group, u).map_err(say)?))
    };
    let g = at(&u)?;
    second_order("Ψ(u + ε dΨ_u⁻¹v) = Ψ(εv)Ψ(u) + O(ε²)", |e| {
        let product = at(&group.scaled(e, &v))? * &g;
        Ok((gap(&at(&group.moved(&u, e, &w))?, &product), g.norm_l2()))
    })?;

    let length = group.norm(&w);
    let step = 2e-3; // where the remainder step⁴/30 and the rounding ε/step meet
    let e = step / length;
    let difference = |k: f64| -> Result<Mat<f64>, String> {
        Ok(at(&group.moved(&u, k * e, &w))? - at(&group.moved(&u, -k * e, &w))?)
    };
    let slope = scale(1.0 / (12.0 * e), &(scale(8.0, &difference(1.0)?) - difference(2.0)?));
    let gap = gap(&slope, &(group.algebra_matrix(&v) * &g));
    let bound = C_STENCIL * step.powi(4) + C_PSI * EPS / step;
    within("dΨ_u(dΨ_u⁻¹v) = v", gap, bound * length * g.norm_l2())
}

/// Ψ(u)·x by the map's own way is Ψ(u) applied; dΨ⁻¹ after it is dΨ⁻¹ after Ψ.
pub(crate) fn on_vectors<G: Represent, Psi: CoordinateMap<G>>(
    group: &G,
    psi: &Psi,
    cap: f64,
    rng: &mut Pcg64,
) -> Verdict {
    let size = size(rng, cap);
    let (u, v, x) = (group.of_size(rng, size), group.of_size(rng, 1.0), group.sample_vector(rng));
    let g = group.element_matrix(&psi.eval(group, &u).map_err(say)?);
    let (mut at, mut scratch) = (psi.at(group).map_err(say)?, group.identity());
    let mut y = x.clone();
    psi.psi_on(group, &u, &mut at, &mut scratch, &x, &mut y).map_err(say)?;
    let mut w = v.clone();
    psi.dpsi_inv(group, &u, &mut at, &mut w).map_err(say)?;
    let x = group.vector_matrix(&x);
    let far = gap(&group.vector_matrix(&y), &group.applied(&g, &x));
    within("psi_on = Ψ(u)·x", far, C_PSI * EPS * g.norm_l2() * x.norm_l2())?;
    let expected = psi.eval_dpsi_inv(group, &u, &v).map_err(say)?;
    let same = same_bits(&group.algebra_matrix(&w), &group.algebra_matrix(&expected));
    if same { Ok(()) } else { Err("dΨ⁻¹ after psi_on differs from dΨ⁻¹ after psi".into()) }
}

/// What a map keeps from one u changes no bit at another: a used workspace equals a fresh one.
pub(crate) fn history<G: Represent, Psi: CoordinateMap<G>>(
    group: &G,
    psi: &Psi,
    cap: f64,
    rng: &mut Pcg64,
) -> Verdict {
    let (mut at, mut g) = (psi.at(group).map_err(say)?, group.identity());
    for _ in 0..3 {
        let size = size(rng, cap);
        let (u, v) = (group.of_size(rng, size), group.of_size(rng, 1.0));
        let mut w = v.clone();
        psi.psi(group, &u, &mut at, &mut g).map_err(say)?;
        psi.dpsi_inv(group, &u, &mut at, &mut w).map_err(say)?;
        let fresh = group.element_matrix(&psi.eval(group, &u).map_err(say)?);
        if !same_bits(&group.element_matrix(&g), &fresh) {
            return Err("Ψ(u) depends on what was evaluated before".into());
        }
        let fresh = group.algebra_matrix(&psi.eval_dpsi_inv(group, &u, &v).map_err(say)?);
        if !same_bits(&group.algebra_matrix(&w), &fresh) {
            return Err("dΨ_u⁻¹v depends on what was evaluated before".into());
        }
    }
    Ok(())
}

/// exp((s + t)u) = exp(su)·exp(tu): approximants of different degrees and numbers of squarings
/// must agree with each other.
pub(crate) fn one_parameter<G: Represent, Psi: CoordinateMap<G>>(
    group: &G,
    exp: &Psi,
    cap: f64,
    rng: &mut Pcg64,
) -> Verdict {
    let size = size(rng, cap);
    let (u, s) = (group.of_size(rng, size), rng.random_range(0.0..1.0));
    let at = |a: f64| -> Result<Mat<f64>, String> {
        let g = exp.eval(group, &group.scaled(a, &u)).map_err(say)?;
        Ok(group.element_matrix(&g))
    };
    let (whole, first, second) = (at(1.0)?, at(s)?, at(1.0 - s)?);
    // What rounding in u and in s does, and what the product does.
    let unit = EPS * (1.0 + size) * first.norm_l2() * second.norm_l2();
    within("exp((s+t)u) = exp(su)exp(tu)", gap(&whole, &(&first * &second)), C_SUBGROUP * unit)
}

/// `gap(ε)` → (gap, size) is O(ε²): halving ε divides it by 4, unless it is rounding at both.
fn second_order(claim: &str, gap: impl Fn(f64) -> Result<(f64, f64), String>) -> Verdict {
    let e = 1.0 / 512.0;
    let ((coarse, size), (fine, _)) = (gap(e)?, gap(0.5 * e)?);
    let rounding = C_PSI * EPS * size;
    // Where rounding is more than 1/100 of the gap the ratio says nothing; the gap is O(ε²) already.
    if fine < 100.0 * rounding {
        return within(claim, coarse, 800.0 * rounding);
    }
    within(&format!("{claim}, the ratio's distance from 4"), (coarse / fine - 4.0).abs(), 0.2)
}
