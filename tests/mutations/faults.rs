//! The suites catch broken methods: each fault here is put in on purpose, and the check of
//! `core/laws.rs` or `orders/fields.rs` that should see it must fail, for the reason it should.

use crate::maps::{Faulty, WrongSign};
use crate::support::orders::{
    Field, Flow, MEMBERS, Reference, clock, family, flow, measure, measure_as, measure_over,
    order_conditions, reference, start, wave,
};
use crate::support::represent::Represent;
use crate::support::{Verdict, holds, laws};
use lieflow::CoordinateMap;
use lieflow::actions::{Coadjoint, LeftTranslation};
use lieflow::groups::{MatrixGroup, Power, Product, Sample, So3};
use lieflow::maps::{CCSK123, Cay, Exp};
use lieflow::methods::commutator_free::{CF4, ProductTableau};
use lieflow::methods::crouch_grossman::CG3;
use lieflow::methods::low_storage::{LS4, LS5, TwoN};
use lieflow::methods::magnus::CFM6_5;
use lieflow::methods::one_bracket::RKMK4_2C;
use lieflow::methods::{
    CfMagnus, CommutatorFree, LowStorage, Method, OneBracket, Rkmk, Tableau,
    tableau::{HEUN, RK4, THREE_EIGHTHS, VERNER6},
};
use lieflow::space::LinearSpace;
use rand::SeedableRng;
use rand_pcg::Pcg64;

const CASES: u32 = 32;

fn so(n: usize) -> MatrixGroup {
    MatrixGroup::so(n).unwrap()
}

/// The check failed, and its message says so in these words.
fn caught(verdict: Verdict, reason: &str) {
    match verdict {
        Ok(()) => panic!("a fault was not seen, expected: {reason}"),
        Err(seen) => assert!(seen.contains(reason), "seen: {seen}\nexpected: {reason}"),
    }
}

fn map_laws<G: Represent, Psi: CoordinateMap<G>>(group: &G, psi: &Psi) -> Verdict {
    holds(CASES, |rng: &mut Pcg64| laws::map(group, psi, 1.0, rng))
}

/// Does the harness find the order that the method claims, on the group's translation problem? And
/// which order does it find on the grid of order `real`?
fn order_on<G: Represent + Clone + 'static, M: Method<Flow<G, LeftTranslation>>>(
    real: usize,
    group: G,
    method: &M,
) -> (Verdict, Verdict)
where
    G::Elem: LinearSpace<Scalar = f64>,
    Cay: CoordinateMap<G>,
{
    let n = group.element_matrix(&group.identity()).nrows();
    let flow = flow(group, LeftTranslation, wave(n, 0.5, 12));
    let reference = reference(&flow, start(&flow, 7));
    let claim = measure(&flow, method, &reference).and_then(|e| e.check());
    (claim, measure_as(real, &flow, method, &reference).and_then(|e| e.check()))
}

/// The harness refuses the claim, and finds the order that the fault leaves.
fn falls_to<G: Represent + Clone + 'static, M: Method<Flow<G, LeftTranslation>>>(
    real: usize,
    group: G,
    method: &M,
) where
    G::Elem: LinearSpace<Scalar = f64>,
    Cay: CoordinateMap<G>,
{
    let (claim, left) = order_on(real, group, method);
    assert!(claim.is_err(), "the claimed order was found");
    left.unwrap();
}

/// The harness finds order 4: it is the fault that it sees, not the code around it.
fn keeps_order_4<G: Represent + Clone + 'static, M: Method<Flow<G, LeftTranslation>>>(
    group: G,
    method: &M,
) where
    G::Elem: LinearSpace<Scalar = f64>,
    Cay: CoordinateMap<G>,
{
    order_on(4, group, method).0.unwrap();
}

const DIFFERENTIAL: &str = "Ψ(u + ε dΨ_u⁻¹v) = Ψ(εv)Ψ(u) + O(ε²)";

#[test]
fn dexpinv_without_its_brackets() {
    let psi = Faulty(Exp, crate::maps::Fault::NoDifferential);
    caught(map_laws(&so(4), &psi), DIFFERENTIAL);
    caught(map_laws(&So3::new(), &psi), DIFFERENTIAL);
    falls_to(2, so(5), &Rkmk::new(RK4, psi));
    falls_to(2, So3::new(), &Rkmk::new(RK4, psi));
}

#[test]
fn a_wrong_baker_coefficient() {
    let psi = Faulty(Exp, crate::maps::Fault::Baker2);
    caught(map_laws(&so(4), &psi), DIFFERENTIAL);
    falls_to(3, so(5), &Rkmk::new(RK4, psi));
}

/// No method of order 4 can show this one; the law can.
#[test]
fn a_wrong_sign_in_the_fourth_baker_coefficient() {
    let psi = Faulty(Exp, crate::maps::Fault::Baker4Sign);
    // Where ad_u is small, only the law dΨ_u(dΨ_u⁻¹v) = v is sharp enough to see it.
    caught(map_laws(&so(4), &psi), "dΨ_u");
    caught(map_laws(&MatrixGroup::gl(3).unwrap(), &psi), "dΨ_u");
    keeps_order_4(so(5), &Rkmk::new(RK4, psi));
}

#[test]
fn the_wrong_trivialisation() {
    for_each_map(crate::maps::Fault::LeftTrivialised, DIFFERENTIAL);
    falls_to(2, so(5), &Rkmk::new(RK4, Faulty(Exp, crate::maps::Fault::LeftTrivialised)));
    falls_to(2, so(5), &Rkmk::new(RK4, Faulty(Cay, crate::maps::Fault::LeftTrivialised)));
}

#[test]
fn cayley_without_its_factors() {
    let psi = Faulty(Cay, crate::maps::Fault::NoQuarter);
    caught(map_laws(&So3::new(), &psi), DIFFERENTIAL);
    caught(map_laws(&MatrixGroup::sp(4).unwrap(), &psi), DIFFERENTIAL);
    falls_to(2, So3::new(), &Rkmk::new(RK4, psi));
    let psi = Faulty(Cay, crate::maps::Fault::NoHalf);
    caught(map_laws(&So3::new(), &psi), "dΨ₀⁻¹ = id");
}

#[test]
fn ccsk_with_a_wrong_sign() {
    caught(map_laws(&So3::new(), &WrongSign), DIFFERENTIAL);
    falls_to(1, So3::new(), &Rkmk::new(RK4, WrongSign));
}

#[test]
fn a_map_that_leaves_the_group() {
    let psi = Faulty(Exp, crate::maps::Fault::OffGroup);
    for group in [so(4), MatrixGroup::sp(4).unwrap(), MatrixGroup::indefinite(3, 1).unwrap()] {
        caught(holds(CASES, |rng| laws::map::closure(&group, &psi, 1.0, rng)), "Ψ(u) ∈ G");
    }
}

#[test]
fn a_short_way_that_is_another_way() {
    for_each_map(crate::maps::Fault::OnInverse, "psi_on = Ψ(u)·x");
}

#[test]
fn a_workspace_that_remembers() {
    for_each_map(crate::maps::Fault::Stale, "depends on what was evaluated before");
}

fn for_each_map(fault: crate::maps::Fault, reason: &str) {
    caught(map_laws(&so(4), &Faulty(Exp, fault)), reason);
    caught(map_laws(&so(4), &Faulty(Cay, fault)), reason);
    caught(map_laws(&so(4), &Faulty(CCSK123, fault)), reason);
    caught(map_laws(&So3::new(), &Faulty(CCSK123, fault)), reason);
}

#[test]
fn actions_from_the_wrong_side() {
    for fault in [crate::actions::Fault::Transposed, crate::actions::Fault::Swapped] {
        let action = crate::actions::Translation(fault);
        let law = holds(CASES, |rng| laws::action(&so(4), &action, rng));
        caught(law, "Λ(ab, p) = Λ(a, Λ(b, p))");
        // The equation means the same, its reference is the same, and the method misses it.
        let faulty = flow(so(4), action, wave(4, 0.5, 12));
        let sound = flow(so(4), LeftTranslation, wave(4, 0.5, 12));
        let reference = reference(&sound, start(&sound, 7)).of_the_same_points(&faulty);
        caught(measure(&faulty, &Rkmk::new(RK4, Exp), &reference).map(|_| ()), "too few errors");
    }
}

#[test]
fn a_generator_from_the_wrong_side() {
    let action = crate::actions::Translation(crate::actions::Fault::Generator);
    let law = |rng: &mut Pcg64| {
        let g = so(4).sample_element(rng);
        laws::generator(&so(4), &action, &g, rng)
    };
    caught(holds(CASES, law), "λ_*(v)(y) = d/dε Λ(exp(εv), y)");
    let law = |rng: &mut Pcg64| laws::generator_of_matrices(&so(4), &action, rng);
    caught(holds(CASES, law), "λ_*(v)(y) of matrices");
}

/// The congruence g m gᵀ passes as an action; only the pairing tells it from the coadjoint one.
#[test]
fn congruence_in_place_of_the_coadjoint_action() {
    let pairing = |group: &MatrixGroup| {
        holds(CASES, |rng| laws::coadjoint_pairing(group, &crate::actions::Congruence, rng))
    };
    pairing(&so(4)).unwrap();
    for group in [MatrixGroup::gl(3).unwrap(), MatrixGroup::sp(4).unwrap()] {
        caught(pairing(&group), "⟨Λ(g,m),v⟩ = ⟨m,g⁻¹vg⟩");
        holds(CASES, |rng| laws::coadjoint_pairing(&group, &Coadjoint, rng)).unwrap();
    }
}

#[test]
fn groups_with_a_wrong_bracket_or_product() {
    let lorentz = || MatrixGroup::indefinite(3, 1).unwrap();
    let short_cut = crate::groups::Faulty(lorentz(), crate::groups::Fault::ShortCut);
    caught(holds(CASES, |rng| laws::algebra(&short_cut, rng)), "[u,v] = uv − vu");
    let reversed = crate::groups::Faulty(so(4), crate::groups::Fault::Reversed);
    caught(holds(CASES, |rng| laws::algebra(&reversed, rng)), "[u,v] = uv − vu");
    let swapped = crate::groups::Faulty(lorentz(), crate::groups::Fault::Swapped);
    caught(holds(CASES, |rng| laws::group(&swapped, rng)), "a·b");
}

/// `check::laws` sees a wrong bracket in one part of a product, although it is a bracket by itself.
#[test]
fn a_part_with_a_wrong_bracket() {
    let check = |fault| {
        let part = crate::groups::Faulty(MatrixGroup::sp(4).unwrap(), fault);
        let group = Product(Power::new(So3::new(), 3).unwrap(), part);
        let laws = lieflow::check::laws(&group, &Exp, &mut Pcg64::seed_from_u64(1), 20, 0.3);
        let broken = laws.unwrap().into_iter().filter(|law| !law.holds());
        broken.map(|law| law.name).collect::<Vec<_>>()
    };
    assert_eq!(check(crate::groups::Fault::Sound), [""; 0]);
    for fault in [crate::groups::Fault::NoBracket, crate::groups::Fault::Reversed] {
        let broken = check(fault);
        assert!(broken.len() == 1 && broken[0].starts_with("[u, v] of commutators"), "{broken:?}");
    }
}

#[test]
fn methods_with_a_wrong_stage() {
    use crate::methods::{Fault, Faulty};
    for tableau in [RK4, THREE_EIGHTHS] {
        keeps_order_4(so(5), &Faulty(tableau, Fault::None));
        falls_to(1, so(5), &Faulty(tableau, Fault::FrozenTime));
    }
    // The row sums are right, hence order 2.
    falls_to(2, so(5), &Faulty(THREE_EIGHTHS, Fault::ReversedRows));
    caught(order_on(4, so(5), &Faulty(RK4, Fault::WrongBase)).0, "too few errors");
}

#[test]
fn two_commutators_with_the_wrong_stage() {
    keeps_order_4(so(5), &crate::methods::TwoCommutators { wrong: false });
    falls_to(2, so(5), &crate::methods::TwoCommutators { wrong: true });
}

type OnSo5 = Flow<MatrixGroup, LeftTranslation>;

/// An ensemble on SO(5).
fn members(field: impl Fn(u64) -> Field) -> Vec<(OnSo5, Reference<OnSo5>)> {
    family(MEMBERS, &so(5), field)
        .into_iter()
        .map(|(flow, start)| {
            let reference = reference(&flow, start);
            (flow, reference)
        })
        .collect()
}

/// The ensembles for orders above 4 see the same slips in a pair of order 6.
#[test]
fn a_pair_of_order_6_with_a_fault() {
    let members = members(|i| wave(5, 0.5, 11 + i));
    macro_rules! refused {
        ($($method:expr),* $(,)?) => {$(
            let seen = measure_over(&members, &$method).and_then(|e| e.check());
            assert!(seen.is_err(), "{}", stringify!($method));
        )*};
    }
    measure_over(&members, &Rkmk::new(VERNER6, Exp)).and_then(|e| e.check()).unwrap();
    // Two a_ij exchanged, in one row: its sum is the same.
    let mut swapped = VERNER6;
    swapped.a[4].swap(1, 2);
    let mut coefficient = VERNER6;
    coefficient.a[4][3] += 1e-4;
    coefficient.a[4][2] -= 1e-4;
    refused!(
        Rkmk::new(swapped, Exp),
        Rkmk::new(coefficient, Exp),
        Rkmk::new(Tableau { order: 7, ..VERNER6 }, Exp),
        Rkmk::new(Tableau { order: 5, ..VERNER6 }, Exp),
        Rkmk::new(VERNER6, Faulty(Exp, crate::maps::Fault::NoDifferential)),
        Rkmk::new(VERNER6, Faulty(Exp, crate::maps::Fault::Baker2)),
        Rkmk::new(VERNER6, Faulty(Exp, crate::maps::Fault::Baker4Sign)),
        Rkmk::new(VERNER6, Faulty(Exp, crate::maps::Fault::LeftTrivialised)),
        Rkmk::new(VERNER6, Faulty(Cay, crate::maps::Fault::LeftTrivialised)),
        Rkmk::new(VERNER6, Faulty(Cay, crate::maps::Fault::NoQuarter)),
    );
    let mut wrong = LS5;
    wrong.b[4] += 1e-4;
    measure_over(&members, &LowStorage(LS5)).and_then(|e| e.check()).unwrap();
    refused!(LowStorage(wrong), LowStorage(TwoN { c: [0.0; 13], ..LS5 }));
    for fault in [crate::actions::Fault::Transposed, crate::actions::Fault::Swapped] {
        let turned: Vec<_> = self::members(|i| wave(5, 0.5, 11 + i))
            .into_iter()
            .zip(0u64..)
            .map(|((_, reference), i)| {
                let field = wave(5, 0.5, 11 + 100 * i);
                let flow = flow(so(5), crate::actions::Translation(fault), field);
                let reference = reference.of_the_same_points(&flow);
                (flow, reference)
            })
            .collect();
        let seen = measure_over(&turned, &Rkmk::new(VERNER6, Exp)).and_then(|e| e.check());
        assert!(seen.is_err(), "{fault:?}");
    }
}

/// And the harness for orders up to 4 sees them in methods without coordinates.
#[test]
fn commutator_free_methods_with_a_fault() {
    keeps_order_4(so(5), &CommutatorFree(CF4));
    // Two weights exchanged, in one factor.
    let mut swapped = CF4;
    swapped.update.factors = &[[T12[2], T12[3], T12[2], T12[0]], [T12[0], T12[2], T12[2], T12[3]]];
    falls_to(1, so(5), &CommutatorFree(swapped));
    // One exponential in place of two: the bracket that they make is gone.
    let mut merged = CF4;
    merged.update.factors = &[[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0]];
    falls_to(2, so(5), &CommutatorFree(merged));
    // The factors from the other side, as with the other trivialisation.
    let mut reversed = CF4;
    reversed.update.factors = &[[T12[0], T12[2], T12[2], T12[3]], [T12[3], T12[2], T12[2], T12[0]]];
    falls_to(2, so(5), &CommutatorFree(reversed));
    falls_to(1, so(5), &CommutatorFree(ProductTableau { c: [0.0; 4], ..CF4 }));
    let mut from_start = CF4;
    from_start.stages[3].from = 0;
    falls_to(1, so(5), &CommutatorFree(from_start));
    let mut crouch_grossman = CG3;
    crouch_grossman.update.factors =
        &[[0.0, 0.0, 24.0 / 17.0], [0.0, -2.0 / 3.0, 0.0], [13.0 / 51.0, 0.0, 0.0]];
    falls_to(2, so(5), &CommutatorFree(crouch_grossman));
    let mut wrong_stage = RKMK4_2C;
    wrong_stage.stages[2].w = [0.5, 0.0, 0.0, 0.0];
    falls_to(2, so(5), &OneBracket(wrong_stage));
    let mut no_bracket = RKMK4_2C;
    no_bracket.update.x = [0.0; 4];
    falls_to(2, so(5), &OneBracket(no_bracket));
    let mut coefficient = LS4;
    coefficient.a[3] += 1e-3;
    assert!(order_on(4, so(5), &LowStorage(coefficient)).0.is_err());
}

/// −1/12, …: the weights of CF4 in twelfths.
const T12: [f64; 4] = [-1.0 / 12.0, 0.0, 1.0 / 6.0, 0.25];

/// Methods for fields of linear type: factors from the other side, and a digit lost.
#[test]
fn magnus_methods_with_a_fault() {
    let members = members(|i| clock(5, 1.0, 21 + i));
    let order = |method: &CfMagnus<3, 5>| measure_over(&members, method).and_then(|e| e.check());
    order(&CfMagnus(CFM6_5)).unwrap();
    let mut reversed = CFM6_5;
    reversed.factors.reverse();
    assert!(order(&CfMagnus(reversed)).is_err());
    let mut coefficient = CFM6_5;
    coefficient.factors[2][1] += 1e-5;
    assert!(order(&CfMagnus(coefficient)).is_err());
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "a debug build refuses a wrong tableau before its first step"
)]
fn tableaus_with_a_wrong_coefficient() {
    let c = |t: Tableau<4>| order_conditions(&t);
    // a₃₁ and a₃₂ exchanged: the row sum is the same.
    let mut swapped = THREE_EIGHTHS;
    swapped.a[2].swap(0, 1);
    caught(c(swapped), "condition of");
    falls_to(2, so(5), &Rkmk::new(swapped, Exp));
    // Stage 3 of RK4 built on k₁ in place of k₂.
    let mut first = RK4;
    first.a[2].swap(0, 1);
    caught(c(first), "condition of");
    falls_to(2, so(5), &Rkmk::new(first, Exp));
    // Weights exchanged.
    let mut weights = RK4;
    weights.b.swap(2, 3);
    caught(c(weights), "condition of");
    falls_to(1, so(5), &Rkmk::new(weights, Exp));
    // A node that is not its row sum is refused before a run.
    let mut node = RK4;
    node.c[3] = 0.5;
    caught(c(node), "Σ a[4,j]");
    // An order claimed too high or too low.
    caught(order_conditions(&Tableau { order: 3, ..HEUN }), "condition of");
    caught(order_conditions(&Tableau { order: 3, ..RK4 }), "higher order");
    falls_to(2, so(5), &Rkmk::new(Tableau { order: 3, ..HEUN }, Exp));
}
