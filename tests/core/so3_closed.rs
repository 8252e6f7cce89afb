//! The closed forms on so(3): logarithms and dexp⁻¹ near 2π against references, laws over bit patterns,
//! refusals. All maps against references: `maps/references.rs`.

use lieflow::groups::{So3, hat};
use lieflow::maps::{CCSK123, Cay, CoordinateMap, Exp};
use lieflow::{Error, StepError, so3};
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;

use crate::support::references::{cases, relative_error};

const EPS: f64 = f64::EPSILON;

/// ‖x − r‖/(ε·‖r‖), less half of the least subnormal, which cannot be represented.
fn units(x: &[f64], r: &[f64]) -> f64 {
    let size = r.iter().fold(0.0f64, |s, r| s.max(r.abs()));
    let least = if size == 0.0 { 0.0 } else { 5e-324 / size };
    (relative_error(x, r) - least).max(0.0) / EPS
}

/// Next to 2π, where u is exact and its rounded norm is not: far better than ε·cond, which is 1e-6
/// at the end of this range. What is left is the condition in v alone.
#[test]
fn dexpinv_next_to_2pi() {
    let mut worst = 0.0f64;
    let mut seen = 0;
    for case in cases("so3").iter().filter(|case| case.has("u")) {
        let (u, v, exact) = (case.vector("u"), case.vector("v"), &case.output["dexpinv"]);
        if !exact.is_defined() {
            continue;
        }
        let distance = (u.norm() - 2.0 * PI).abs();
        if !(1e-11..0.2).contains(&distance) {
            continue;
        }
        let w = so3::dexpinv(&u, &v).expect("dexpinv");
        let cond_v = so3::dexpinv_matrix(&u).expect("J⁻¹").norm() * v.norm() / w.norm();
        let units = units(w.as_slice(), &exact.numbers());
        println!("2π − |u| = {distance:8.1e}: {units:5.2} eps, cond in v {cond_v:4.1}");
        worst = worst.max(units / cond_v);
        seen += 1;
    }
    assert!(seen >= 20, "{seen}");
    assert!(worst <= 2.0, "{worst}");
}

/// log to 4 ε at every angle, and within 4 ε·defect-free rounding off the group.
#[test]
fn log_against_references() {
    let (mut on, mut off) = (0.0f64, 0.0f64);
    for case in cases("so3").iter().filter(|case| case.has("g")) {
        let m = case.matrix3("g");
        let log = &case.output["log"];
        let reference = Vector3::from_vec(log.numbers());
        let u = so3::log(&m).expect("log");
        // Within 1e-14 of π either sign is right.
        let flip =
            if reference.norm() > PI - 1e-14 && u.dot(&reference) < 0.0 { -1.0 } else { 1.0 };
        let units = units((u * flip).as_slice(), reference.as_slice());
        assert!(u.norm() <= PI * (1.0 + EPS), "|log| = {}", u.norm());
        let defect = log.measure("defect").expect("a defect");
        // A rotation rounded to doubles has a defect of about ε itself. Up to 16 ε a matrix is taken
        // as it is; beyond, the polar factor is formed, with rounding of the size ε/angle.
        if defect < 5.0 * EPS {
            on = on.max(units);
        } else {
            let taken = if defect <= 16.0 * EPS { defect / EPS } else { 0.0 };
            off = off.max(units * reference.norm().min(1.0) - taken);
        }
        if units > 4.0 {
            println!("{units:.2} eps, angle {:e}, defect {defect:e}", reference.norm());
        }
    }
    println!("on the group {on:.2} eps, off the group {off:.2} eps/min(1, angle)");
    assert!(on <= 4.0 && off <= 4.0);
}

/// A number from bit patterns: special values, log-uniform magnitudes, a few ulps around multiples
/// of π/2.
fn any_number(rng: &mut impl Rng) -> f64 {
    let special = [
        0.0,
        -0.0,
        5e-324,
        -5e-324,
        f64::MIN_POSITIVE,
        f64::MAX,
        f64::MIN,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        EPS,
        1.0,
        -1.0,
    ];
    match rng.random_range(0..10) {
        0 => special[rng.random_range(0..special.len())],
        1..=3 => {
            let x = PI / 2.0 * rng.random_range(0..9) as f64;
            f64::from_bits(x.to_bits().wrapping_add(rng.random_range(0..9)).wrapping_sub(4))
        }
        4 => f64::from_bits(rng.random()),
        5 => rng.random_range(-4.0..4.0),
        _ => 10f64.powf(rng.random_range(-320.0..308.0)) * if rng.random() { 1.0 } else { -1.0 },
    }
}

fn any_vector(rng: &mut impl Rng) -> Vector3<f64> {
    match rng.random_range(0..3) {
        // Of a chosen length, in a random direction.
        0 => {
            let d = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
            d / d.norm() * any_number(rng)
        }
        1 => Vector3::ith(rng.random_range(0..3), any_number(rng)),
        _ => Vector3::from_fn(|_, _| any_number(rng)),
    }
}

fn defect(g: &Matrix3<f64>) -> f64 {
    (g.transpose() * g - Matrix3::identity()).norm()
}

/// ‖RᵀR − 𝟙‖ of exp, 4√3 ε; and of cay and ccsk. cay has the coefficient 1/(1 + α²/4) in both of its
/// terms: the rounding of α² shows in the defect 4√2 times at the half turn.
const ON_SO3: f64 = 4.0 * 1.7320508075688772 * EPS;
const ORTHOGONAL: f64 = 12.0 * EPS;

/// Whatever the bits: an Ok is finite and on the group, an error says what was wrong with a
/// non-finite or overflowing argument or a singular point, and nothing panics.
#[test]
fn any_bits() {
    let mut rng = Pcg64::seed_from_u64(1);
    let (mut fine, mut refused, mut worst) = (0, 0, [0.0f64; 4]);
    for _ in 0..30_000 {
        let (u, v) = (any_vector(&mut rng), any_vector(&mut rng));
        let finite = u.iter().all(|x| x.is_finite());
        let ordinary = finite && u.amax() < 1e307;
        for (map, g) in [
            so3::exp(&u),
            so3::cay(&u),
            so3::ccsk::<f64, 0, 1, 2>(&u),
            so3::ccsk::<f64, 2, 1, 0>(&u),
        ]
        .into_iter()
        .enumerate()
        {
            assert!(if g.is_ok() { finite } else { !ordinary }, "{u:?}: {g:?}");
            let Ok(g) = g else {
                refused += 1;
                continue;
            };
            fine += 1;
            worst[map] = worst[map].max(defect(&g));
            let bound = if map == 0 { ON_SO3 } else { ORTHOGONAL };
            assert!(defect(&g) <= bound, "{u:?}: {:e}", defect(&g));
            // Back: the same rotation, to the defect of both and an angle known to 4ε·π.
            let back = ORTHOGONAL + 4.0 * PI * EPS;
            let log = so3::log(&g).expect("a rotation");
            assert!(log.norm() <= PI * (1.0 + EPS));
            let again = so3::exp(&log).expect("exp");
            assert!((again - g).norm() <= back, "{u:?}: {:e}", (again - g).norm());
            let angles = so3::ccsk_inv::<2, 1, 0>(&g).expect("angles");
            assert!(angles[1].abs() <= PI / 2.0);
            let again = so3::ccsk::<f64, 2, 1, 0>(&angles).expect("ccsk");
            assert!((again - g).norm() <= back, "{u:?}: {:e}", (again - g).norm());
            if let Ok(c) = so3::cay_inv(&g) {
                let again = so3::cay(&c).expect("cay");
                assert!((again - g).norm() <= back, "{u:?}: {:e}", (again - g).norm());
            }
            let q = so3::quaternion_from_matrix(&g).expect("a quaternion");
            assert!((q.norm() - 1.0).abs() <= 4.0 * EPS);
        }
        for q in
            [so3::exp_quaternion(&u), so3::cay_quaternion(&u), so3::ccsk_quaternion::<1, 0, 2>(&u)]
        {
            assert!(if q.is_ok() { finite } else { !ordinary }, "{u:?}: {q:?}");
            if let Ok(q) = q {
                assert!((q.norm() - 1.0).abs() <= 4.0 * EPS, "{u:?}: {q:?}");
                assert!(
                    so3::log_quaternion(&q).expect("a unit quaternion").norm() <= PI * (1.0 + EPS)
                );
            }
        }
        for w in [
            so3::exp_on(&u, &v),
            so3::dexp(&u, &v),
            so3::dexpinv(&u, &v),
            so3::dcay(&u, &v),
            so3::dcayinv(&u, &v),
            so3::dccsk::<f64, 1, 2, 0>(&u, &v),
            so3::dccskinv::<f64, 1, 2, 0>(&u, &v),
        ] {
            match w {
                Ok(w) => assert!(w.iter().all(|x| x.is_finite()), "{u:?}, {v:?}: {w:?}"),
                Err(_) => refused += 1,
            }
        }
        for m in [
            so3::dexp_matrix(&u),
            so3::dexpinv_matrix(&u),
            so3::dcay_matrix(&u),
            so3::dcayinv_matrix(&u),
            so3::dccsk_matrix::<f64, 0, 2, 1>(&u),
            so3::dccskinv_matrix::<f64, 0, 2, 1>(&u),
        ] {
            assert!(m.is_err() || m.is_ok_and(|m| m.iter().all(|x| x.is_finite())), "{u:?}");
        }
        let r = Matrix3::from_fn(|_, _| any_number(&mut rng));
        assert!(so3::log(&r).is_err() || defect(&r) <= so3::POLAR_MAX, "{r:?}");
    }
    println!("worst defect of exp, cay, ccsk: {:.1?} eps", worst.map(|x| x / EPS));
    assert!(fine > 30_000 && refused > 3_000, "{fine} {refused}");
}

/// The laws that tie the forms to one another, at ordinary u.
#[test]
fn laws() {
    let mut rng = Pcg64::seed_from_u64(2);
    for _ in 0..3000 {
        let size = 10f64.powf(rng.random_range(-12.0..0.79));
        let mut draw = || Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let (d, v) = (draw(), draw());
        let u: Vector3<f64> = d / d.norm() * size;
        let close = |a: Vector3<f64>, b: Vector3<f64>, cond: f64| {
            assert!((a - b).norm() <= 8.0 * EPS * cond * v.norm(), "{u:?}: {:e}", (a - b).norm());
        };
        let ok = |w: Result<Vector3<f64>, StepError>| w.expect("a regular point");
        let inverse = so3::dexpinv_matrix(&u).expect("J⁻¹");
        close(ok(so3::dexpinv(&u, &ok(so3::dexp(&u, &v)))), v, inverse.norm());
        close(ok(so3::dcayinv(&u, &ok(so3::dcay(&u, &v)))), v, 1.0 + size * size);
        close(so3::dexp_matrix(&u).expect("J") * v, ok(so3::dexp(&u, &v)), 1.0);
        close(so3::dcay_matrix(&u).expect("J") * v, ok(so3::dcay(&u, &v)), 1.0);
        close(inverse * v, ok(so3::dexpinv(&u, &v)), inverse.norm());
        // J_l(u) = exp(u) J_r(u), J_r(u) = J_l(−u).
        let r = so3::exp(&u).expect("exp");
        close(r * ok(so3::dexp(&-u, &v)), ok(so3::dexp(&u, &v)), 1.0);
        close(ok(so3::exp_on(&u, &v)), r * v, 1.0);
        let cos = u[1].cos().abs();
        let there = ok(so3::dccsk::<f64, 0, 1, 2>(&u, &v));
        close(ok(so3::dccskinv::<f64, 0, 1, 2>(&u, &there)), v, 2.0 / cos);
        // Quaternions tell the same rotations.
        let q = so3::exp_quaternion(&u).expect("q");
        assert!((q.to_rotation_matrix().matrix() - r).norm() <= 8.0 * EPS);
        let c = so3::cay_quaternion(&u).expect("q").to_rotation_matrix();
        assert!((c.matrix() - so3::cay(&u).expect("cay")).norm() <= 8.0 * EPS);
        let k = so3::ccsk_quaternion::<2, 0, 1>(&u).expect("q").to_rotation_matrix();
        assert!((k.matrix() - so3::ccsk::<f64, 2, 0, 1>(&u).expect("ccsk")).norm() <= 8.0 * EPS);
        if size < 3.1 {
            let cond = 1.0 / (PI - size);
            assert!((so3::log_quaternion(&q).expect("log") - u).norm() <= 4.0 * EPS * size);
            assert!(
                (so3::log(&r).expect("log") - u).norm()
                    <= 4.0 * EPS * size.max(1e-9) * cond.max(1.0)
            );
            let back = so3::cay_inv(&so3::cay(&u).expect("cay")).expect("cay⁻¹");
            assert!((back - u).norm() <= 4.0 * EPS * size * (1.0 + size * size));
            let mut e = u;
            e[0] = e[0].clamp(-1.4, 1.4);
            let back = so3::ccsk_inv::<1, 0, 2>(&so3::ccsk::<f64, 1, 0, 2>(&e).expect("ccsk"))
                .expect("angles");
            if e[1].abs() < 3.0 && e[2].abs() < 3.0 {
                assert!((back - e).norm() <= 16.0 * EPS / e[0].cos(), "{e:?} {back:?}");
            }
        }
    }
}

/// The coordinate maps are these functions, bit by bit.
#[test]
fn coordinate_maps_are_these_functions() {
    let group = So3::<f64>::new();
    let mut rng = Pcg64::seed_from_u64(3);
    let mut compared = 0;
    for _ in 0..5000 {
        let (u, v) = (any_vector(&mut rng), Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0)));
        let (mut at, mut g) = (Exp.at(&group).expect("exp"), Matrix3::identity());
        assert_eq!(Exp.psi(&group, &u, &mut at, &mut g).map(|()| g), so3::exp(&u));
        let (mut w, plain) = (v, so3::dexpinv(&u, &v));
        if so3::exp(&u).is_ok() && plain.is_ok() {
            compared += 1;
            assert_eq!(Exp.dpsi_inv(&group, &u, &mut at, &mut w).map(|()| w), plain);
        }
        assert_eq!(Cay.eval(&group, &u).ok(), so3::cay(&u).ok());
        if let Ok(k) = so3::ccsk::<f64, 0, 1, 2>(&u) {
            assert_eq!(CCSK123.eval(&group, &u).expect("ccsk"), k);
        }
    }
    assert!(compared > 1000);
}

/// dexp⁻¹ at the singular points: refused, on both sides of them.
#[test]
fn singular_points_are_refused() {
    let v = Vector3::new(0.3, 1.0, -0.2);
    for turns in [1.0, 2.0, 5.0] {
        for ulps in -3i64..=3 {
            let size = f64::from_bits((2.0 * PI * turns).to_bits().wrapping_add_signed(ulps));
            let w = so3::dexpinv(&Vector3::new(size, 0.0, 0.0), &v);
            assert!(matches!(w, Err(StepError::OutsideChart { .. })), "{size:?}: {w:?}");
        }
    }
    assert!(so3::dexpinv(&Vector3::new(2.0 * PI - 1e-9, 0.0, 0.0), &v).is_ok());
    let beyond = so3::dexpinv(&Vector3::new(0.0, 2.0 * PI + 1e-9, 0.0), &v);
    assert!(beyond.is_ok(), "{beyond:?}");
}

/// Off the group: refused with the residual, or the determinant; never a number.
#[test]
fn log_refuses_what_is_no_rotation() {
    let r = so3::exp(&Vector3::new(0.3, -1.0, 0.8)).expect("exp");
    let mut far = r;
    far[(0, 1)] += 0.1;
    match so3::log(&far) {
        Err(Error::NotOnGroup { arg: "R", residual, tolerance, .. }) => {
            assert!(residual > 0.01 && tolerance == so3::POLAR_MAX);
        }
        other => panic!("{other:?}"),
    }
    assert!(matches!(so3::log(&-r), Err(Error::Reflection { arg: "R" })));
    for (i, bad) in [f64::NAN, f64::INFINITY, 1e300].into_iter().enumerate() {
        let mut r = r;
        r[(i, 2)] = bad;
        assert!(so3::log(&r).is_err() && so3::cay_inv(&r).is_err());
        assert!(so3::ccsk_inv::<0, 1, 2>(&r).is_err() && so3::quaternion_from_matrix(&r).is_err());
    }
    assert!(matches!(
        so3::log(&Matrix3::from_element(f64::NAN)),
        Err(Error::NotFiniteEntry { arg: "R", row: 0, col: 0, .. })
    ));
    let half_turn = so3::exp(&Vector3::new(PI, 0.0, 0.0)).expect("exp");
    assert!(so3::cay_inv(&half_turn).is_err());
}

/// q and −q are one rotation; half turns are decided by the first component, whatever their zeros.
#[test]
fn half_turns_and_signs() {
    let axes = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.6, -0.8, 0.0],
        [0.0, 0.6, 0.8],
        [0.36, 0.48, -0.8],
    ];
    for axis in axes {
        let n = Vector3::from(axis);
        for sign in [1.0, -1.0] {
            for w in [0.0, -0.0] {
                let q = UnitQuaternion::new_unchecked(Quaternion::from_parts(w, n * sign));
                let u = so3::log_quaternion(&q).expect("log");
                assert!((u - n * PI).norm() <= 4.0 * EPS * PI, "{q:?}: {u:?}");
            }
            // Exactly symmetric: no sign is left in the matrix.
            let r = n * n.transpose() * 2.0 - Matrix3::identity();
            let u = so3::log(&r).expect("log");
            assert!((u - n * PI).norm() <= 8.0 * EPS, "{u:?}");
        }
    }
    let q = so3::exp_quaternion(&Vector3::new(0.1, 0.2, -0.4)).expect("q");
    let minus = UnitQuaternion::new_unchecked(-q.into_inner());
    assert_eq!(so3::log_quaternion(&q), so3::log_quaternion(&minus));
    let long = UnitQuaternion::new_unchecked(Quaternion::new(1.0, 1.0, 0.0, 0.0));
    assert!(so3::log_quaternion(&long).is_err());
}

/// Interop with nalgebra, and the order of components by name.
#[test]
fn nalgebra() {
    let u = Vector3::new(0.4, -0.7, 1.1);
    let r = so3::exp(&u).expect("exp");
    assert!((Rotation3::from_scaled_axis(u).matrix() - r).norm() < 4.0 * EPS);
    let q = so3::exp_quaternion(&u).expect("q");
    assert!(q.angle_to(&UnitQuaternion::from_scaled_axis(u)) < 1e-15);
    let [w, x, y, z] = so3::quaternion_to_wxyz(&q);
    assert_eq!([w, x, y, z], [q.w, q.i, q.j, q.k]);
    assert_eq!(so3::quaternion_to_xyzw(&q), [x, y, z, w]);
    assert!(so3::quaternion_from_wxyz([w, x, y, z]).expect("q").angle_to(&q) < 1e-15);
    let scaled =
        so3::quaternion_from_xyzw([1e200 * x, 1e200 * y, 1e200 * z, 1e200 * w]).expect("q");
    assert!(scaled.angle_to(&q) < 1e-15);
    assert!(so3::quaternion_from_wxyz([0.0; 4]).is_err());
    assert!(so3::quaternion_from_wxyz([0.0, f64::NAN, 0.0, 1.0]).is_err());
    // roll, pitch, yaw of nalgebra are the ordering 321 of ours.
    let e = Rotation3::from_euler_angles(0.3, -0.5, 1.2);
    let angles = so3::ccsk_inv::<2, 1, 0>(e.matrix()).expect("angles");
    assert!((angles - Vector3::new(0.3, -0.5, 1.2)).norm() < 8.0 * EPS);
    assert_eq!(hat(&u) * u, Vector3::zeros());
}
