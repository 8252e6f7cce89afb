//! SE(3) and SE₂(3): against references of 36 digits, against the general 4×4 matrices, the representations on
//! the algebra and its dual, the logarithm, and what is refused.

use crate::support::points::Points;
use crate::support::references::{Answer, Case, Implementation};
use crate::support::represent::{Represent, affine};
use crate::support::{EPS, gap};
use faer::Mat;
use faer::prelude::Solve;
use lieflow::actions::{Coadjoint, LeftTranslation, Linear};
use lieflow::groups::{
    Adjoint, AlgebraMatrix, LieAlgebra, LieGroup, MatrixGroup, Sample, Se3, Se23,
};
use lieflow::maps::{
    CCSK123, Cay, CoordinateMap, Exp, Pade22, dexp, dexpinv, exp, left_jacobian_inv_se23,
    left_jacobian_se3, left_jacobian_se23, log,
};
use lieflow::{Action, StepError};
use nalgebra::{SVector, Vector3, Vector6};
use rand::SeedableRng;
use rand_pcg::Pcg64;

type Twist = (Vector3<f64>, Vector3<f64>);

const SE3: Se3 = Se3::new();

fn twist(x: &[f64]) -> Twist {
    (Vector3::new(x[0], x[1], x[2]), Vector3::new(x[3], x[4], x[5]))
}

#[test]
fn exp_and_its_differential_against_36_digits() {
    fn compute(case: &Case, function: &str) -> Answer {
        let [u, v] = ["u", "v"].map(|name| twist(&case.numbers(name)));
        let text = |error: lieflow::Error| error.to_string();
        let concat = |r: &[f64], x: &Vector3<f64>| [r, x.as_slice()].concat();
        Some(match function {
            "exp" => Exp.eval(&SE3, &u).map(|g| concat(g.0.transpose().as_slice(), &g.1)),
            _ => Exp.eval_dpsi_inv(&SE3, &u, &v).map(|w| concat(w.0.as_slice(), &w.1)),
        })
        .map(|value| value.map_err(text))
    }
    Implementation {
        name: "SE(3)",
        eps: EPS,
        compute,
        // The condition is that of the absolute error.
        bound: |_, _, output| {
            let size = output.numbers().iter().map(|x| x * x).sum::<f64>().sqrt();
            4.0 * output.measure("cond").expect("a condition") / size
        },
        may_refuse: |_, _, _| false,
    }
    .check(&["se3"], 50);
}

fn dense(u: &Twist) -> AlgebraMatrix {
    AlgebraMatrix::new_unchecked(SE3.algebra_matrix(u))
}

/// The 4×4 matrices in GL(4) have the same Ψ and dΨ⁻¹.
#[test]
fn closed_forms_are_those_of_the_4x4_matrices() {
    fn check<Psi: CoordinateMap<Se3> + CoordinateMap<MatrixGroup>>(psi: Psi, c: f64) {
        let gl4 = MatrixGroup::gl(4).unwrap();
        let mut rng = Pcg64::seed_from_u64(1);
        for k in 0..200 {
            let size = 10f64.powf(-6.0 + 6.4 * k as f64 / 200.0);
            let (u, a) = (SE3.of_size(&mut rng, size), SE3.of_size(&mut rng, 1.0));
            let closed = SE3.element_matrix(&psi.eval(&SE3, &u).unwrap());
            let general = psi.eval(&gl4, &dense(&u)).unwrap();
            assert!(gap(&closed, &general) < c * EPS * general.norm_l2(), "Ψ, case {k}");
            let closed = SE3.algebra_matrix(&psi.eval_dpsi_inv(&SE3, &u, &a).unwrap());
            let general = psi.eval_dpsi_inv(&gl4, &dense(&u), &dense(&a)).unwrap();
            let far = gap(&closed, &general);
            assert!(far < c * EPS * (1.0 + size).powi(2), "dΨ⁻¹, case {k}: {far:e}");
        }
    }
    check(Exp, 32.0);
    check(Cay, 32.0);
    check(Pade22, 32.0);
}

/// dexp is that of the 4×4 matrices, on both sides of α² = 1 and for small angles. The Jacobians are its matrices.
#[test]
fn dexp_is_that_of_the_4x4_matrices() {
    let gl4 = MatrixGroup::gl(4).unwrap();
    let mut rng = Pcg64::seed_from_u64(5);
    for k in 0..300 {
        let size = 10f64.powf(-6.0 + 6.8 * k as f64 / 300.0);
        let (u, w) = (SE3.of_size(&mut rng, size), SE3.of_size(&mut rng, 1.0));
        let closed = dexp(&SE3, &u, &w).unwrap();
        let general = dexp(&gl4, &dense(&u), &dense(&w)).unwrap();
        let far = gap(&SE3.algebra_matrix(&closed), &general);
        assert!(far < 32.0 * EPS * (1.0 + size).powi(2), "case {k}: {far:e}");

        let numbers = |u: &Twist| Vector6::from_iterator(u.0.iter().chain(&u.1).copied());
        let product = left_jacobian_se3(&u).unwrap() * numbers(&w);
        assert!((product - numbers(&closed)).norm() < 8.0 * EPS * (1.0 + size));
        // J_r(u) = Ad_exp(−u) J_l(u) = J_l(−u).
        let mut there = SE3.zero();
        let back = (-u.0, -u.1);
        SE3.big_ad(&Exp.eval(&SE3, &back).unwrap(), &closed, &mut there).unwrap();
        let right = left_jacobian_se3(&back).unwrap() * numbers(&w);
        assert!((numbers(&there) - right).norm() < 64.0 * EPS * (1.0 + size).powi(2));
    }
    let huge = (Vector3::new(1e200, 0.0, 0.0), Vector3::zeros());
    assert!(dexp(&SE3, &huge, &huge).is_err());
}

/// On SE₂(3) the maps, dexp and dexp⁻¹ are those of the 5×5 matrices and, of each translation alone, those of SE(3) to the
/// last bit. The Jacobians are their matrices.
#[test]
fn extended_poses_are_two_motions_and_5x5_matrices() {
    let (gl5, group) = (MatrixGroup::gl(5).unwrap(), Se23::new());
    let dense = |u: &(Vector3<f64>, Twist)| AlgebraMatrix::new_unchecked(group.algebra_matrix(u));
    let mut rng = Pcg64::seed_from_u64(6);
    for k in 0..200 {
        let size = 10f64.powf(-6.0 + 6.8 * k as f64 / 200.0);
        let (u, w) = (group.of_size(&mut rng, size), group.of_size(&mut rng, 1.0));
        let bound = 64.0 * EPS * (1.0 + size).powi(2);
        let close = |closed: &Mat<f64>, general: &Mat<f64>| {
            let far = gap(closed, general);
            assert!(far < bound * general.norm_l2().max(1.0), "case {k}: {far:e}");
        };
        let g = exp(&group, &u).unwrap();
        close(&group.element_matrix(&g), &exp(&gl5, &dense(&u)).unwrap());
        let there = dexp(&group, &u, &w).unwrap();
        close(&group.algebra_matrix(&there), &dexp(&gl5, &dense(&u), &dense(&w)).unwrap());
        let back = dexpinv(&group, &u, &w).unwrap();
        close(&group.algebra_matrix(&back), &dexpinv(&gl5, &dense(&u), &dense(&w)).unwrap());
        for (psi_g, gl) in [
            (Cay.eval(&group, &u).unwrap(), Cay.eval(&gl5, &dense(&u)).unwrap()),
            (Pade22.eval(&group, &u).unwrap(), Pade22.eval(&gl5, &dense(&u)).unwrap()),
        ] {
            close(&group.element_matrix(&psi_g), &gl);
        }

        let first = ((u.0, u.1.0), (w.0, w.1.0));
        let second = ((u.0, u.1.1), (w.0, w.1.1));
        for (pair, at) in [(first, 0), (second, 1)] {
            let of = |x: (Vector3<f64>, Twist)| (x.0, [x.1.0, x.1.1][at]);
            let motion = exp(&SE3, &pair.0).unwrap();
            assert!(motion.0 == g.0 && motion.1 == [g.1.0, g.1.1][at]);
            assert_eq!(dexp(&SE3, &pair.0, &pair.1).unwrap(), of(there));
            assert_eq!(dexpinv(&SE3, &pair.0, &pair.1).unwrap(), of(back));
        }
        if size < 3.0 {
            let again = log(&group, &g).unwrap();
            let far = group.algebra_matrix(&again) - group.algebra_matrix(&u);
            assert!(far.norm_l2() < bound, "log, case {k}: {:e}", far.norm_l2());
        }

        let numbers = |u: &(Vector3<f64>, Twist)| {
            SVector::<f64, 9>::from_iterator([u.0, u.1.0, u.1.1].iter().flatten().copied())
        };
        let j = left_jacobian_se23(&u).unwrap();
        assert!((j * numbers(&w) - numbers(&there)).norm() < bound);
        let inverse = left_jacobian_inv_se23(&u).unwrap();
        assert!((inverse * numbers(&w) - numbers(&back)).norm() < bound);
    }
    let huge = (Vector3::new(1e200, 0.0, 0.0), (Vector3::zeros(), Vector3::zeros()));
    let nan = (Vector3::zeros(), (Vector3::zeros(), Vector3::new(0.0, f64::NAN, 0.0)));
    assert!(dexp(&group, &huge, &huge).is_err() && dexpinv(&group, &huge, &huge).is_err());
    assert!(exp(&group, &nan).is_err() && Cay.eval(&group, &nan).is_err());
    assert!(Pade22.eval(&group, &nan).is_err() && CCSK123.eval(&group, &nan).is_err());
}

/// ⟨Ad*_g m, u⟩ = ⟨m, Ad_g u⟩, ⟨ad*_u m, w⟩ = ⟨m, [u, w]⟩, and g⁻¹ as the 5×5 matrices have them.
#[test]
fn the_duals_of_extended_poses() {
    let (group, mut rng) = (Se23::new(), Pcg64::seed_from_u64(7));
    for _ in 0..100 {
        let g = group.sample_element(&mut rng);
        let [u, w] = [(); 2].map(|()| group.sample_algebra(&mut rng, 1.0));
        let m = Points::<Se23>::draw(&Coadjoint, &group, &mut rng);
        let (mut there, mut back, mut one) = (group.zero(), group.zero(), group.identity());
        group.inverse(&g, &mut one).unwrap();
        let (matrix, inverse) = (group.element_matrix(&g), group.element_matrix(&one));
        let size = matrix.norm_l2().powi(2);
        assert!(gap(&(&matrix * &inverse), &Mat::identity(5, 5)) < 32.0 * EPS * size);
        group.big_ad(&g, &u, &mut there).unwrap();
        let expected = &matrix * group.algebra_matrix(&u) * &inverse;
        assert!(gap(&group.algebra_matrix(&there), &expected) < 32.0 * EPS * size);
        group.coad_group(&g, &m, &mut back).unwrap();
        assert!((group.pair(&back, &u) - group.pair(&m, &there)).abs() < 64.0 * EPS * size);
        group.coad(&u, &m, &mut back);
        let bracket = group.commutator(&u, &w);
        assert!((group.pair(&back, &w) - group.pair(&m, &bracket)).abs() < 64.0 * EPS);
    }
}

fn inverse(g: &Mat<f64>) -> Mat<f64> {
    g.partial_piv_lu().solve(Mat::<f64>::identity(4, 4))
}

#[test]
fn adjoint_and_coadjoint() {
    let mut rng = Pcg64::seed_from_u64(2);
    for _ in 0..100 {
        let [a, b] = [(); 2].map(|()| SE3.sample_element(&mut rng));
        let [u, v] = [(); 2].map(|()| SE3.sample_algebra(&mut rng, 1.0));
        let m = Points::<Se3>::draw(&Coadjoint, &SE3, &mut rng);
        let (mut out, mut moved, mut one) = (SE3.zero_twist(), m, SE3.identity());
        let matrix = SE3.element_matrix(&a);
        let size = matrix.norm_l2().powi(2);

        SE3.inverse(&a, &mut one).unwrap();
        assert!(gap(&SE3.element_matrix(&one), &inverse(&matrix)) < 16.0 * EPS * size);
        SE3.big_ad(&a, &u, &mut out).unwrap();
        let expected = &matrix * SE3.algebra_matrix(&u) * inverse(&matrix);
        assert!(gap(&SE3.algebra_matrix(&out), &expected) < 32.0 * EPS * size);

        // ⟨Ad*_a m, u⟩ = ⟨m, Ad_a u⟩ and ⟨ad*_u m, v⟩ = ⟨m, [u, v]⟩.
        SE3.coad_group(&a, &m, &mut moved).unwrap();
        assert!((SE3.pair(&moved, &u) - SE3.pair(&m, &out)).abs() < 64.0 * EPS * size);
        SE3.coad(&u, &m, &mut moved);
        let bracket = SE3.commutator(&u, &v);
        assert!((SE3.pair(&moved, &v) - SE3.pair(&m, &bracket)).abs() < 64.0 * EPS);

        // The action is Ad*_{g⁻¹}, and keeps π·π and μ·π.
        let mut acted = m;
        Coadjoint.act(&SE3, &a, &m, &mut acted, &mut ());
        SE3.coad_group(&one, &m, &mut moved).unwrap();
        assert!((acted.0 - moved.0).norm() + (acted.1 - moved.1).norm() < 32.0 * EPS * size);
        let mut twice = m;
        Coadjoint.act(&SE3, &b, &acted, &mut twice, &mut ());
        assert!((twice.1.norm() - m.1.norm()).abs() < 32.0 * EPS * m.1.norm());
        let casimir = |m: &Twist| m.0.dot(&m.1);
        let bound = 64.0 * EPS * size * SE3.element_matrix(&b).norm_l2() * m.1.norm_squared();
        assert!(
            (casimir(&twice) - casimir(&m)).abs() < bound + 64.0 * EPS * m.0.norm() * m.1.norm()
        );
    }
}

trait ZeroTwist {
    fn zero_twist(&self) -> Twist;
}
impl ZeroTwist for Se3 {
    fn zero_twist(&self) -> Twist {
        lieflow::LieAlgebra::zero(self)
    }
}

#[test]
fn logarithm() {
    let mut rng = Pcg64::seed_from_u64(3);
    let pi = core::f64::consts::PI;
    for angle in [0.0, 1e-300, 1e-12, 1e-3, 0.5, 1.0, 2.0, 3.0, pi - 1e-6] {
        for _ in 0..20 {
            let (direction, v) =
                (SE3.sample_vector(&mut rng).normalize(), SE3.sample_vector(&mut rng));
            let u = (direction * angle, v);
            let back = SE3.log(&Exp.eval(&SE3, &u).unwrap()).unwrap();
            let far = (back.0 - u.0).norm() + (back.1 - u.1).norm();
            assert!(far < 32.0 * EPS * (1.0 + v.norm()), "at {angle}: {far:e}");
            assert!((back.0 - u.0).norm() <= 16.0 * EPS * angle.max(1e-290), "at {angle}");
        }
    }
    let g = SE3.sample_element(&mut rng);
    let again = Exp.eval(&SE3, &SE3.log(&g).unwrap()).unwrap();
    assert!(SE3.distance(&again, &g) < 64.0 * EPS);
    let off = (g.0 * 1.5, g.1);
    assert!(SE3.log(&off).is_err());
}

#[test]
fn what_cannot_be_computed_is_refused() {
    let nan = (Vector3::new(0.1, f64::NAN, 0.0), Vector3::zeros());
    let far = (Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.0, f64::INFINITY, 0.0));
    let turn = (Vector3::new(0.0, core::f64::consts::TAU, 0.0), Vector3::new(1.0, 0.0, 0.0));
    let huge = (Vector3::new(1e160, 0.0, 0.0), Vector3::new(1.0, 2.0, 3.0));
    let a = (Vector3::x(), Vector3::y());
    for u in [nan, far] {
        assert!(Exp.eval(&SE3, &u).is_err() && Cay.eval(&SE3, &u).is_err());
        assert!(Pade22.eval(&SE3, &u).is_err() && CCSK123.eval(&SE3, &u).is_err());
    }
    let singular = Exp.eval_dpsi_inv(&SE3, &turn, &a);
    assert!(matches!(
        singular,
        Err(lieflow::Error::Map(StepError::OutsideChart { map: "exp", .. }))
    ));
    assert!(Exp.eval_dpsi_inv(&SE3, &huge, &a).is_err() && Pade22.eval(&SE3, &huge).is_err());
    // The map itself has a value: a rotation, and a translation that is nearly along the axis.
    let g = Exp.eval(&SE3, &huge).unwrap();
    assert!(SE3.defect(&g) < 16.0 * EPS && (g.1[0] - 1.0).abs() < 1e-12);
}

/// Left translation takes R back to SO(3) and leaves x.
#[test]
fn drift_is_corrected() {
    let mut rng = Pcg64::seed_from_u64(4);
    let mut g = SE3.sample_element(&mut rng);
    let x = g.1;
    g.0[(0, 1)] += 1e-9;
    let mut work = Action::<Se3>::work(&LeftTranslation, &SE3);
    let residual = LeftTranslation.restore(&SE3, &mut g, &mut work).unwrap();
    assert!(residual > 1e-10 && SE3.defect(&g) < 16.0 * EPS && g.1 == x);
    // A point moves as the 4×4 matrix says.
    let p = SE3.sample_vector(&mut rng);
    let mut q = p;
    Linear.act(&SE3, &g, &p, &mut q, &mut ());
    let by_matrix =
        affine(&Mat::from_fn(3, 3, |i, j| g.0[(i, j)]), &g.1, 1.0) * SE3.vector_matrix(&p);
    assert!(gap(&SE3.vector_matrix(&q), &by_matrix) < 8.0 * EPS * by_matrix.norm_l2());
}

/// The rotation of exp is one as that of exp on so(3) is: to 4√3 roundings.
#[test]
fn the_rotation_of_a_motion_is_one() {
    let mut rng = Pcg64::seed_from_u64(11);
    for size in [0.5, 3.0, 10.0, 100.0] {
        let mut worst = 0.0f64;
        for _ in 0..400 {
            let mut u = SE3.sample_algebra(&mut rng, 1.0);
            u.0 *= size / u.0.norm();
            worst = worst.max(SE3.defect(&Exp.eval(&SE3, &u).expect("exp")));
        }
        assert!(worst < 4.0 * 3f64.sqrt() * EPS, "{size}: {} roundings", worst / EPS);
    }
}
