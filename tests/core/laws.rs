//! The laws of every group, coordinate map and action, on random elements.
//!
//! A group joins by one line in `laws!`: its name, its value, and the maps that it takes.

use crate::support::points::Points;
use crate::support::represent::Represent;
use crate::support::{EPS, Verdict, gaussian, holds, laws, within};
use faer::{Mat, mat};
use lieflow::actions::{
    Coadjoint, Conjugation, Each, Lagrangian, LeftTranslation, Linear, Pair, RightTranslation,
};
use lieflow::groups::{
    Form, MatrixGroup, Power, Product, Sample, Se3, Se23, So3, Translations, UnitQuaternions,
    Unitary, hat, vee,
};
use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Ccsk, CoordinateMap, Dexpinv, Exp, Pade22};
use lieflow::problems::{BodyFrame, FromTheBody};
use lieflow::{Action, Error, LieAlgebra, LieGroup};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Random cases a law.
const CASES: u32 = 128;

fn so(n: usize) -> MatrixGroup {
    MatrixGroup::so(n).unwrap()
}
fn gl(n: usize) -> MatrixGroup {
    MatrixGroup::gl(n).unwrap()
}
fn sp(n: usize) -> MatrixGroup {
    MatrixGroup::sp(n).unwrap()
}
fn indefinite(p: usize, q: usize) -> MatrixGroup {
    MatrixGroup::indefinite(p, q).unwrap()
}
fn unitary(n: usize) -> Unitary {
    Unitary::new(n).unwrap()
}
/// M = 𝟙 + J, neither symmetric nor skew: gᵀg = 𝟙 and gᵀJg = J, which is U(2).
fn u2() -> MatrixGroup {
    let m = mat![
        [1.0, 0.0, 1.0, 0.0],
        [0.0, 1.0, 0.0, 1.0],
        [-1.0, 0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0, 1.0],
    ];
    MatrixGroup::gm(m).unwrap()
}
/// A well-conditioned M with no symmetry; 𝔤_M has the least dimension, n/2.
fn skewed(n: usize) -> MatrixGroup {
    let mut rng = Pcg64::seed_from_u64(3);
    let m =
        Mat::<f64>::identity(n, n) * faer::Scale(2.0) + gaussian(&mut rng, n, n) * faer::Scale(0.4);
    MatrixGroup::gm(m).unwrap()
}

/// One test a map: its laws, and its charts with every action.
macro_rules! map_laws {
    ($group:expr; $($name:ident: $map:expr, up to $cap:expr;)*) => {$(
        #[test]
        fn $name() {
            let (group, psi) = ($group, $map);
            let holds = |law: &dyn Fn(&mut Pcg64) -> Verdict| holds(CASES, law).unwrap();
            holds(&|rng| laws::map(&group, &psi, $cap, rng));
            holds(&|rng| laws::lambda(&group, &psi, &LeftTranslation, $cap, rng));
            holds(&|rng| laws::lambda(&group, &psi, &RightTranslation, $cap, rng));
            holds(&|rng| laws::lambda(&group, &psi, &Linear, $cap, rng));
            holds(&|rng| laws::lambda(&group, &psi, &Coadjoint, $cap, rng));
        }
    )*};
}

/// The maps of every matrix group. `up to` is the largest ‖u‖: within the Baker series' useful
/// radius for exp, where twenty of its terms reach rounding, and where 𝟙 − u/2 is well conditioned.
macro_rules! general {
    ($group:expr) => {
        map_laws! { $group;
            exp: Exp, up to 2.0;
            exp_truncated: Exp.truncated(20), up to 0.5;
            cay: Cay, up to 1.0;
            pade22: Pade22, up to 1.0;
        }
    };
}
/// The maps of groups that are not given by matrices of real numbers.
macro_rules! exp_and_cay {
    ($group:expr) => {
        map_laws! { $group;
            exp: Exp, up to 3.0;
            cay: Cay, up to 1.0;
        }
    };
}
/// And of groups whose algebra has a basis for coordinates of the second kind.
macro_rules! with_basis {
    ($group:expr) => {
        general!($group);
        map_laws! { $group;
            ccsk123: CCSK123, up to 0.5;
            ccsk321: CCSK321, up to 0.5;
            ccsk: CCSK, up to 0.5;
        }
    };
}
/// And of rotations: every angle of ccsk is then well below π/2, where it is singular.
macro_rules! rotations {
    ($group:expr) => {
        general!($group);
        map_laws! { $group;
            ccsk123: CCSK123, up to 1.2;
            ccsk321: CCSK321, up to 1.2;
            ccsk: CCSK, up to 1.2;
        }
    };
}
/// And of so(3) in closed form: the other orderings.
macro_rules! closed {
    ($group:expr) => {
        rotations!($group);
        map_laws! { $group;
            ccsk132: Ccsk::<0, 2, 1>::new(), up to 1.2;
            ccsk213: Ccsk::<1, 0, 2>::new(), up to 1.2;
            ccsk231: Ccsk::<1, 2, 0>::new(), up to 1.2;
            ccsk312: Ccsk::<2, 0, 1>::new(), up to 1.2;
        }
    };
}

macro_rules! laws {
    ($($name:ident: $group:expr, $maps:ident;)*) => {$(
        mod $name {
            use super::*;

            #[test]
            fn algebra() {
                let group = $group;
                holds(CASES, |rng| laws::algebra(&group, rng)).unwrap();
            }
            #[test]
            fn group() {
                let group = $group;
                holds(CASES, |rng| laws::group(&group, rng)).unwrap();
            }
            #[test]
            fn actions() {
                let group = $group;
                holds(CASES, |rng| laws::action(&group, &LeftTranslation, rng)).unwrap();
                holds(CASES, |rng| laws::action(&group, &RightTranslation, rng)).unwrap();
                holds(CASES, |rng| laws::action(&group, &Linear, rng)).unwrap();
                holds(CASES, |rng| laws::action(&group, &Coadjoint, rng)).unwrap();
            }
            #[test]
            fn generators() {
                let group = $group;
                let holds = |law: &dyn Fn(&mut Pcg64) -> Verdict| holds(CASES, law).unwrap();
                holds(&|rng| laws::generator_of_matrices(&group, &LeftTranslation, rng));
                holds(&|rng| laws::generator_of_matrices(&group, &RightTranslation, rng));
                holds(&|rng| laws::generator_of_matrices(&group, &Linear, rng));
                holds(&|rng| laws::generator_of_matrices(&group, &Coadjoint, rng));
            }
            #[test]
            fn gaussian_algebra() {
                laws::gaussian_algebra(&$group).unwrap();
            }
            $maps!($group);
        }
    )*
        /// The matrix groups among them.
        fn matrix_groups() -> Vec<MatrixGroup> {
            let mut groups = Vec::new();
            $(groups.extend((&$group as &dyn core::any::Any).downcast_ref().cloned());)*
            groups
        }
    };
}

laws! {
    so3_closed: So3::<f64>::new(), closed;
    so2: so(2), rotations;
    so3: so(3), rotations;
    so4: so(4), rotations;
    so5: so(5), rotations;
    so7: so(7), rotations;
    so9: so(9), rotations; // beyond the const-size kernels
    gl1: gl(1), with_basis;
    gl3: gl(3), with_basis;
    gl5: gl(5), with_basis;
    sp2: sp(2), with_basis;
    sp4: sp(4), with_basis;
    sp6: sp(6), with_basis;
    sp10: sp(10), with_basis;
    so31: indefinite(3, 1), general;
    so22: indefinite(2, 2), general;
    u2: u2(), general;
    skewed4: skewed(4), general;
    sl2: MatrixGroup::sl(2).unwrap(), general;
    complex_u2: MatrixGroup::u(2).unwrap(), general;
    complex_su2: MatrixGroup::su(2).unwrap(), general;
    se3: Se3::<f64>::new(), closed;
    se23: Se23::<f64>::new(), closed;
    quaternions: UnitQuaternions, exp_and_cay;
    unitary1: unitary(1), exp_and_cay;
    unitary2: unitary(2), exp_and_cay;
    unitary5: unitary(5), exp_and_cay;
    unitary_squared: Power::new(unitary(3), 2).unwrap(), exp_and_cay;
    so3_by_sp4: Product(So3::<f64>::new(), sp(4)), with_basis;
    so3_to_the_3: Power::new(So3::<f64>::new(), 3).unwrap(), rotations;
    nested: Product(Power::new(so(4), 2).unwrap(), gl(2)), general;
}

#[test]
fn the_coadjoint_action_keeps_the_pairing_and_the_spectrum() {
    for group in matrix_groups() {
        let name = group.name();
        holds(CASES, |rng| laws::coadjoint_pairing(&group, &Coadjoint, rng)).expect(&name);
        holds(CASES, |rng| laws::coadjoint_spectrum(&group, rng)).expect(&name);
    }
}

#[test]
fn generators_of_the_other_actions() {
    let symmetric = |p: Mat<f64>, sign: f64| &p + p.transpose() * faer::Scale(sign);
    for group in matrix_groups() {
        let (name, n) = (group.name(), group.n());
        // On SO(n) symmetric and skew points have a formula of their own.
        for part in [None, Some(1.0), Some(-1.0)] {
            let draw = |rng: &mut Pcg64| {
                let p = gaussian(rng, n, n);
                part.map_or(p.clone(), |sign| symmetric(p, sign))
            };
            holds(CASES, |rng| laws::generator(&group, &Conjugation, &draw(rng), rng))
                .expect(&name);
            holds(CASES, |rng| laws::generator(&group, &Coadjoint, &draw(rng), rng)).expect(&name);
        }
        let with_attitude = |rng: &mut Pcg64| {
            let y = (group.sample_element(rng), gaussian(rng, n, n));
            laws::generator(&group, &FromTheBody, &y, rng)
        };
        holds(CASES, with_attitude).expect(&name);
    }
    for group in [sp(2), sp(6)] {
        let m = group.n() / 2;
        let law = |rng: &mut Pcg64| {
            // Small: the fifth derivative of a quotient grows as |P|⁶.
            let p = symmetric(gaussian(rng, m, m), 1.0) * faer::Scale(0.1);
            laws::generator(&group, &Lagrangian, &p, rng)
        };
        holds(CASES, law).unwrap();
    }
    let group = So3::new();
    let body_frame = |rng: &mut Pcg64| laws::generator_of_matrices(&group, &BodyFrame, rng);
    holds(CASES, body_frame).unwrap();
    macro_rules! from_the_body {
        ($($group:expr),*) => {$({
            let group = $group;
            let law = |rng: &mut Pcg64| {
                let y = (group.sample_element(rng), Coadjoint.draw(&group, rng));
                laws::generator(&group, &FromTheBody, &y, rng)
            };
            holds(CASES, law).unwrap();
        })*};
    }
    from_the_body!(
        So3::<f64>::new(),
        Se3::<f64>::new(),
        UnitQuaternions,
        unitary(3),
        Product(So3::<f64>::new(), sp(4)),
        Power::new(Se3::<f64>::new(), 2).unwrap()
    );
    let law = |rng: &mut Pcg64| {
        let p = unitary(4).sample_algebra(rng, 1.0);
        laws::generator(&unitary(4), &Conjugation, &p, rng)
    };
    holds(CASES, law).unwrap();
    let group = Product(So3::<f64>::new(), Power::new(sp(4), 2).unwrap());
    let action = Pair(LeftTranslation, Each(Conjugation));
    let law = |rng: &mut Pcg64| {
        let p: Box<[_]> = (0..2).map(|_| gaussian(rng, 4, 4)).collect();
        laws::generator(&group, &action, &(group.0.sample_element(rng), p), rng)
    };
    holds(CASES, law).unwrap();
}

#[test]
fn generators_of_translations() {
    let group = Product(So3::<f64>::new(), Translations::new(Vector3::zeros(), 3));
    let mut rng = Pcg64::seed_from_u64(2);
    let y = (group.0.sample_element(&mut rng), Vector3::new(1.0, 2.0, 3.0));
    let (v, mut dy) = ((Vector3::x(), Vector3::new(0.1, 0.2, 0.3)), y);
    LeftTranslation.generate(&group, &v, &y, &mut dy, &mut LeftTranslation.work(&group));
    assert_eq!(dy, (hat(&v.0) * y.0, v.1));
    let mut dx = y.1;
    Linear.generate(&group.1, &v.1, &y.1, &mut dx, &mut ());
    assert_eq!(dx, v.1);
}

#[test]
fn the_coadjoint_action_on_so3_keeps_the_length() {
    let group = So3::new();
    holds(CASES, |rng| {
        let g = group.sample_element(rng);
        let m = Points::<So3>::draw(&Coadjoint, &group, rng);
        let mut q = m;
        Coadjoint.act(&group, &g, &m, &mut q, &mut ());
        within("|gm| = |m|", (q.norm() - m.norm()).abs(), 8.0 * EPS * m.norm())?;
        // ⟨gm, v⟩ = ⟨m, vee(g⁻¹ v̂ g)⟩: the vector form of the same pairing.
        let v = group.of_size(rng, 1.0);
        let pulled = g.transpose() * hat(&v) * g;
        let far = (q.dot(&v) - m.dot(&vee(&pulled))).abs();
        within("⟨gm,v⟩ = ⟨m,g⁻¹vg⟩", far, 16.0 * EPS * m.norm())
    })
    .unwrap();
}

#[test]
fn random_rotations_follow_haars_measure() {
    laws::haar(&So3::new()).expect("so(3), closed");
    for n in [2, 3, 4, 5] {
        laws::haar(&so(n)).unwrap_or_else(|seen| panic!("so({n}): {seen}"));
    }
    // [X −Y; Y X] of a unitary X + iY has the entries of a rotation.
    let compact = [
        MatrixGroup::u(1),
        MatrixGroup::u(2),
        MatrixGroup::u(3),
        MatrixGroup::su(2),
        MatrixGroup::su(3),
        MatrixGroup::gm(Mat::identity(3, 3)),
        MatrixGroup::gm(-4.0 * Mat::<f64>::identity(3, 3)),
    ];
    for group in compact.map(|group| group.expect("a group")) {
        laws::haar(&group).unwrap_or_else(|seen| panic!("{}: {seen}", group.name()));
    }
    let group = MatrixGroup::gm(mat![[4.0, 1.0], [1.0, 2.0]]).expect("a group");
    let mut rng = Pcg64::seed_from_u64(3);
    let mean = (0..4000).map(|_| group.sample_element(&mut rng)).fold(0.0, |sum, g| {
        assert!(group.defect(&g) < 1e-14, "{g:?}");
        sum + g[(0, 0)] + g[(1, 1)]
    });
    // The trace of a plane rotation: mean 0, deviation √2.
    assert!(mean.abs() / 4000.0 < 5.0 * (2.0 / 4000.0_f64).sqrt(), "{mean}");
}

#[test]
fn dimensions() {
    assert_eq!(So3::<f64>::new().dim(), 3);
    for n in 1..8 {
        assert_eq!(so(n).dim(), n * (n - 1) / 2, "so({n})");
        assert_eq!(gl(n).dim(), n * n, "gl({n})");
        assert_eq!(sp(2 * n).dim(), n * (2 * n + 1), "sp({})", 2 * n);
    }
    assert_eq!((UnitQuaternions.dim(), unitary(1).dim(), unitary(5).dim()), (3, 1, 25));
    assert_eq!((indefinite(3, 1).dim(), indefinite(2, 2).dim()), (6, 6));
    assert_eq!((u2().dim(), skewed(4).dim(), skewed(6).dim()), (4, 2, 3));
    let subgroups = [(MatrixGroup::sl(2), 3), (MatrixGroup::u(2), 4), (MatrixGroup::su(2), 3)];
    let subgroups = subgroups.map(|(group, dim)| (group.unwrap(), dim));
    for (group, dim) in &subgroups {
        assert_eq!(group.dim(), *dim, "{}", group.name());
    }
    let has_form_alone =
        |g: &MatrixGroup| subgroups.iter().all(|(other, _)| other.name() != g.name());
    for group in matrix_groups().into_iter().filter(has_form_alone) {
        assert_eq!(group.dim(), null_space(&group), "{}", group.name());
    }
}

/// dim 𝔤 by another way: the nullity of u ↦ uᵀM + Mu.
fn null_space(group: &MatrixGroup) -> usize {
    let n = group.n();
    let Some(m) = group.m() else { return n * n };
    let mut map = Mat::<f64>::zeros(n * n, n * n);
    for k in 0..n * n {
        let u = Mat::from_fn(n, n, |i, j| if i + j * n == k { 1.0 } else { 0.0 });
        let image = u.transpose() * &m + &m * &u;
        for l in 0..n * n {
            map[(l, k)] = image[(l % n, l / n)];
        }
    }
    map.singular_values().unwrap().iter().filter(|&&s| s < 1e-10).count()
}

#[test]
fn ccsk_is_refused_where_it_has_no_basis() {
    let has_none = |g: &&MatrixGroup| g.name().contains(',') || g.name().starts_with("G_M");
    for group in matrix_groups().iter().filter(has_none) {
        let refused = |e: Option<Error>| {
            assert!(matches!(e, Some(Error::Unsupported { .. })), "{}: {e:?}", group.name());
        };
        refused(CCSK123.at(group).err());
        refused(CCSK321.at(group).err());
        refused(CoordinateMap::<MatrixGroup>::at(&CCSK, group).err());
    }
}

#[test]
fn exp_runs_along_one_parameter_groups() {
    holds(CASES, |rng| laws::one_parameter(&So3::new(), &Exp, 20.0, rng)).unwrap();
    for group in matrix_groups() {
        let cap = if matches!(group.form(), Form::Identity) { 40.0 } else { 6.0 };
        let verdict = holds(CASES, |rng| laws::one_parameter(&group, &Exp, cap, rng));
        verdict.unwrap_or_else(|seen| panic!("{}: {seen}", group.name()));
    }
}

/// The laws reach every approximant: each degree, squarings, corrections, and both ways to dexp⁻¹.
#[test]
fn every_branch_of_exp_is_reached() {
    for (n, ladder) in [
        (5, [(1e-9, 2), (1e-4, 4), (1e-2, 8), (0.1, 12), (0.6, 18), (4.0, 18), (40.0, 18)]),
        (17, [(1e-9, 5), (1e-3, 5), (1e-2, 5), (0.1, 9), (0.6, 13), (4.0, 17), (40.0, 17)]),
    ] {
        let group = so(n);
        let mut rng = Pcg64::seed_from_u64(9);
        let (mut at, mut g) = (Exp.at(&group).unwrap(), group.identity());
        for (size, degree) in ladder {
            let (u, mut v) = (group.of_size(&mut rng, size), group.of_size(&mut rng, 1.0));
            Exp.psi(&group, &u, &mut at, &mut g).unwrap();
            Exp.dpsi_inv(&group, &u, &mut at, &mut v).unwrap();
            let choice = at.expm_choice();
            assert_eq!(choice.degree, degree, "so({n}) at {size}: {choice:?}");
            assert_eq!(choice.squarings > 0, size > 3.0, "so({n}) at {size}: {choice:?}");
            assert_eq!(choice.corrections > 0, size > 3.0, "so({n}) at {size}: {choice:?}");
            assert_eq!(at.dexpinv_choice() == Dexpinv::Eigen, size > 3.0, "so({n}) at {size}");
        }
    }
}

/// ccsk alternates: the step's parity chooses, and the workspace remembers nothing else.
#[test]
fn alternation_follows_the_parity_of_the_step() {
    let group = so(4);
    let mut rng = Pcg64::seed_from_u64(4);
    let mut at = CoordinateMap::<MatrixGroup>::at(&CCSK, &group).unwrap();
    let mut g = group.identity();
    for _ in 0..20 {
        let n = rng.random_range(0..1000u64);
        let u = group.of_size(&mut rng, 0.5);
        CoordinateMap::<MatrixGroup>::begin_step(&CCSK, &mut at, n);
        CCSK.psi(&group, &u, &mut at, &mut g).unwrap();
        let expected = match n % 2 {
            0 => CCSK321.eval(&group, &u).unwrap(),
            _ => CCSK123.eval(&group, &u).unwrap(),
        };
        assert_eq!(g, expected, "step {n}");
    }
}
