//! Arrays of so(3): the batch agrees with the scalar forms at every size, refuses what they refuse,
//! and gives the same bits wherever a vector stands.

use lieflow::so3::{self, batch};
use lieflow::{Error, StepError};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::{PI, TAU};

const EPS: f64 = f64::EPSILON;

type Columns = [Vec<f64>; 3];

fn columns(x: &[Vector3<f64>]) -> Columns {
    [0, 1, 2].map(|k| x.iter().map(|x| x[k]).collect())
}

fn views<const K: usize>(x: &[Vec<f64>; K]) -> [&[f64]; K] {
    x.each_ref().map(|x| &x[..])
}

fn views_mut<const K: usize>(x: &mut [Vec<f64>; K]) -> [&mut [f64]; K] {
    x.each_mut().map(|x| &mut x[..])
}

fn zeros<const K: usize>(n: usize) -> [Vec<f64>; K] {
    [(); K].map(|()| vec![0.0; n])
}

/// Lengths: log-uniform from the least subnormal to the largest double, around multiples of π, and
/// ordinary; in blocks of one kind and mixed.
fn vectors(rng: &mut Pcg64, n: usize) -> Vec<Vector3<f64>> {
    (0..n)
        .map(|i| {
            let size = match (i / 100) % 5 {
                0 => rng.random_range(0.0..0.99),
                1 => rng.random_range(1.01..6.0),
                2 => 10f64.powf(rng.random_range(-320.0..307.0)),
                3 => PI * rng.random_range(0..9) as f64 + 10f64.powf(rng.random_range(-16.0..0.0)),
                _ => rng.random_range(0.5..1.5),
            };
            Vector3::from_fn(|_, _| rng.random_range(-1.0f64..1.0)).normalize() * size
        })
        .collect()
}

/// The batch of one map beside its scalar form, one vector after the other: values to 4 ε·cond, or the
/// same error.
fn agrees<const OUT: usize>(
    name: &str,
    u: &[Vector3<f64>],
    batch: impl Fn(&[Vector3<f64>], [&mut [f64]; OUT]) -> Result<(), Error>,
    one: impl Fn(usize) -> Result<Vec<f64>, StepError>,
) {
    let n = u.len();
    let mut worst = 0.0f64;
    let (mut start, mut refused) = (0, 0);
    let mut out = zeros::<OUT>(n);
    // Each refusal ends a call; the next begins behind it.
    while start < n {
        let mut part = out.each_mut().map(|x| &mut x[start..]);
        let found = batch(&u[start..], part.each_mut().map(|x| &mut **x));
        let end = match found {
            Ok(()) => n,
            Err(Error::Element { index, source }) => {
                assert_eq!(one(start + index).map_err(Error::from), Err(*source), "{name}");
                refused += 1;
                start + index
            }
            Err(error) => panic!("{name}: {error}"),
        };
        for i in start..end {
            let r = one(i).unwrap_or_else(|e| panic!("{name} at {:?}: {e}", u[i]));
            let size = r.iter().map(|x| x * x).sum::<f64>().sqrt();
            let gap = (0..OUT).map(|k| (out[k][i] - r[k]).powi(2)).sum::<f64>().sqrt();
            let alpha = u[i].norm();
            let pole = (alpha - TAU * (alpha / TAU).round().max(1.0)).abs().max(1e-300);
            let cond = 1.0 + alpha.min(1e6) * (1.0 + 1.0 / pole);
            let units = if gap == 0.0 { 0.0 } else { gap / (EPS * cond * size) };
            worst = worst.max(units);
            assert!(units <= 4.0, "{name} at {:?}: {units} ε·cond", u[i]);
        }
        start = end + 1;
    }
    println!("{name:8} worst {worst:.2} ε·cond from the scalar form, {refused} refused");
}

#[test]
fn agrees_with_the_scalar_forms() {
    let mut rng = Pcg64::seed_from_u64(61);
    let u = vectors(&mut rng, 20_000);
    let v: Vec<_> =
        (0..u.len()).map(|_| Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))).collect();
    let list = |w: Result<Vector3<f64>, StepError>| w.map(|w| w.as_slice().to_vec());
    let rows =
        |g: Result<nalgebra::Matrix3<f64>, StepError>| g.map(|g| g.transpose().as_slice().to_vec());
    let v_at = |u: &[Vector3<f64>]| columns(&v[v.len() - u.len()..]);
    agrees("exp", &u, |u, r| batch::exp(views(&columns(u)), r), |i| rows(so3::exp(&u[i])));
    agrees("cay", &u, |u, r| batch::cay(views(&columns(u)), r), |i| rows(so3::cay(&u[i])));
    agrees(
        "exp_on",
        &u,
        |u, w| batch::exp_on(views(&columns(u)), views(&v_at(u)), w),
        |i| list(so3::exp_on(&u[i], &v[i])),
    );
    agrees(
        "dexp",
        &u,
        |u, w| batch::dexp(views(&columns(u)), views(&v_at(u)), w),
        |i| list(so3::dexp(&u[i], &v[i])),
    );
    agrees(
        "dexpinv",
        &u,
        |u, w| batch::dexpinv(views(&columns(u)), views(&v_at(u)), w),
        |i| list(so3::dexpinv(&u[i], &v[i])),
    );
}

/// Rotations are on the group to 4√3 ε, and do not depend on their neighbours in the array.
#[test]
fn on_the_group_and_independent_of_the_place() {
    let mut rng = Pcg64::seed_from_u64(62);
    let u = vectors(&mut rng, 5000);
    let mut r = zeros::<9>(u.len());
    batch::exp(views(&columns(&u)), views_mut(&mut r)).expect("exp");
    for i in 0..u.len() {
        let g = nalgebra::Matrix3::from_fn(|a, b| r[3 * a + b][i]);
        let defect = (g.transpose() * g - nalgebra::Matrix3::identity()).norm();
        assert!(defect <= 4.0 * 3f64.sqrt() * EPS, "{:?}: {:.1} ε", u[i], defect / EPS);
    }
    let (shifted, mut again) = (u[37..].to_vec(), zeros::<9>(u.len() - 37));
    batch::exp(views(&columns(&shifted)), views_mut(&mut again)).expect("exp");
    for k in 0..9 {
        assert_eq!(r[k][37..], again[k][..], "entry {k}");
    }
}

/// Lengths that differ, numbers that are none, singular points: an error that says which element, and
/// what stands before it is right. No array is too short.
#[test]
fn refusals_and_edges() {
    let (x, y) = (vec![0.5; 10], vec![0.5; 9]);
    let mut r = zeros::<9>(10);
    let error = batch::exp([&x, &y, &x], views_mut(&mut r)).expect_err("lengths");
    assert!(error.to_string().contains("9×1, expected 10×1"), "{error}");
    batch::exp([&[], &[], &[]], views_mut(&mut zeros::<9>(0))).expect("nothing to do");
    for n in [1, 2, 63, 64, 65, 200] {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut u = columns(&vec![Vector3::new(0.3, 1.0, -0.2); n]);
            u[1][n - 1] = bad;
            let mut r = zeros::<9>(n);
            match batch::exp(views(&u), views_mut(&mut r)) {
                Err(Error::Element { index, source }) => {
                    assert_eq!(index, n - 1);
                    assert!(matches!(*source, Error::Map(StepError::NotFinite { .. })));
                    assert!(source.to_string().starts_with("u in"), "{source}");
                }
                other => panic!("{other:?}"),
            }
            assert!(n == 1 || r[0][n - 2] != 0.0);
            let good = columns(&vec![Vector3::new(0.3, 1.0, -0.2); n]);
            let found = batch::dexpinv(views(&good), views(&u), views_mut(&mut zeros::<3>(n)));
            assert!(matches!(found, Err(Error::Element { index, .. }) if index == n - 1));
        }
        let mut u = columns(&vec![Vector3::new(0.0, 3.0, 0.0); n]);
        u[1][0] = TAU;
        let v = u.clone();
        let found = batch::dexpinv(views(&u), views(&v), views_mut(&mut zeros::<3>(n)));
        let Err(Error::Element { index: 0, source }) = found else { panic!("{found:?}") };
        assert!(matches!(*source, Error::Map(StepError::OutsideChart { .. })));
    }
}

/// log and cay⁻¹ of rotations, next to 𝟙 and to turns by π too, and dcay and dcay⁻¹, beside the scalar forms.
#[test]
fn inverse_maps_agree_with_the_scalar_forms() {
    let mut rng = Pcg64::seed_from_u64(63);
    let mut u = vectors(&mut rng, 20_000);
    u.extend((0..2000).map(|i| {
        let size = PI - 10f64.powi(-(i % 17));
        Vector3::from_fn(|_, _| rng.random_range(-1.0f64..1.0)).normalize() * size
    }));
    u.extend([[PI, 0.0, 0.0], [0.0, -PI, 0.0], [0.0; 3]].map(Vector3::from));
    let v: Vec<_> =
        (0..u.len()).map(|_| Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))).collect();
    let rotations: Vec<_> = u.iter().map(|u| so3::exp(u).expect("exp")).collect();
    let flat = |x: &[Vector3<f64>]| x.iter().flat_map(|x| [x[0], x[1], x[2]]).collect::<Vec<f64>>();
    let by_rows: Vec<f64> =
        rotations.iter().flat_map(|g| g.transpose().as_slice().to_vec()).collect();

    let mut logs = vec![0.0; 3 * u.len()];
    batch::rows::log(&by_rows, &mut logs).expect("log");
    let mut worst = 0.0f64;
    for (g, log) in rotations.iter().zip(logs.chunks(3)) {
        let (one, log) = (so3::log(g).expect("log"), Vector3::from_row_slice(log));
        let units = (one - log).norm() / (EPS * one.norm().max(f64::MIN_POSITIVE));
        worst = worst.max(units);
        assert!(units <= 8.0, "log {g}: {log} beside {one}: {units} ε");
    }
    println!("log      worst {worst:.2} ε");

    for (index, g) in rotations.iter().enumerate() {
        let mut w = [0.0; 3];
        let found = batch::rows::cay_inv(&by_rows[9 * index..9 * (index + 1)], &mut w);
        assert_eq!(found.is_ok(), so3::cay_inv(g).is_ok());
    }
    let tame: Vec<usize> = (0..u.len()).filter(|&i| so3::cay_inv(&rotations[i]).is_ok()).collect();
    let of_tame: Vec<f64> =
        tame.iter().flat_map(|&i| by_rows[9 * i..9 * (i + 1)].to_vec()).collect();
    let mut back = vec![0.0; 3 * tame.len()];
    batch::rows::cay_inv(&of_tame, &mut back).expect("cay⁻¹");
    for (&i, back) in tame.iter().zip(back.chunks(3)) {
        let one = so3::cay_inv(&rotations[i]).expect("cay⁻¹");
        let gap = (one - Vector3::from_row_slice(back)).norm();
        assert!(gap <= 8.0 * EPS * one.norm() * (1.0 + one.norm()), "cay⁻¹ of {}", rotations[i]);
    }

    let list = |w: Result<Vector3<f64>, StepError>| w.map(|w| w.as_slice().to_vec());
    let v_at = |u: &[Vector3<f64>]| columns(&v[v.len() - u.len()..]);
    agrees(
        "dcay",
        &u,
        |u, w| batch::dcay(views(&columns(u)), views(&v_at(u)), w),
        |i| list(so3::dcay(&u[i], &v[i])),
    );
    agrees(
        "dcayinv",
        &u,
        |u, w| batch::dcayinv(views(&columns(u)), views(&v_at(u)), w),
        |i| list(so3::dcayinv(&u[i], &v[i])),
    );

    let mut w = [vec![0.0; 3 * u.len()], vec![0.0; 3 * u.len()]];
    let tame: Vec<_> = u.iter().map(|u| u * (0.5 / (1.0 + u.norm()))).collect();
    let one = flat(&tame[..1]);
    batch::rows::dexpinv(&one, &flat(&v), &mut w[0]).expect("one u for all v");
    let all = flat(&vec![tame[0]; u.len()]);
    batch::rows::dexpinv(&all, &flat(&v), &mut w[1]).expect("as many u as v");
    assert_eq!(w[0], w[1]);
}

/// Matrices that are no rotation are refused by number, in any place of an array; rows of the wrong length, too.
#[test]
fn rows_refuse_what_is_no_rotation() {
    for n in [1, 5, 31, 32, 64, 65, 130] {
        let u: Vec<f64> = (0..3 * n).map(|i| (i as f64).sin()).collect();
        let mut r = vec![0.0; 9 * n];
        batch::rows::exp(&u, &mut r).expect("exp");
        let mut component = zeros::<9>(n);
        let of_u = [0, 1, 2].map(|k| u.iter().skip(k).step_by(3).copied().collect::<Vec<_>>());
        batch::exp(views(&of_u), views_mut(&mut component)).expect("exp");
        for (k, numbers) in component.iter().enumerate() {
            assert!(r.iter().skip(k).step_by(9).eq(numbers), "n = {n}, entry {k}");
        }
        let mut w = vec![0.0; 3 * n];
        for bad in [2.0, -1.0, f64::NAN] {
            let mut r = r.clone();
            r[9 * (n - 1)..].iter_mut().for_each(|x| *x *= bad);
            match batch::rows::log(&r, &mut w) {
                Err(Error::Element { index, .. }) => assert_eq!(index, n - 1),
                other => panic!("{other:?}"),
            }
        }
        assert!(matches!(batch::rows::log(&r[1..], &mut w), Err(Error::Shape { .. })));
        assert!(matches!(batch::rows::exp(&u, &mut r[1..]), Err(Error::Shape { .. })));
    }
    batch::rows::exp(&[], &mut []).expect("nothing to do");
    batch::rows::dexpinv(&[], &[], &mut []).expect("nothing to do");
}
