//! X1, X3: sizes that do not fit, and single precision.

use super::*;

/// X1: sizes that do not fit are errors with both sizes, in every map and in a run.
#[test]
fn x1_sizes_that_do_not_fit() {
    fn shape(found: Result<impl std::fmt::Debug, Error>, text: &str) {
        let message = found.expect_err("a wrong size").to_string();
        assert!(message.contains(text), "{message}");
    }
    fn map<Psi: CoordinateMap<MatrixGroup>>(psi: Psi) {
        for n in [1, 2, 4, 9] {
            let (group, other) = (MatrixGroup::so(n), MatrixGroup::so(n + 1));
            let (group, other) = (group.expect("a group"), other.expect("a group"));
            let (u, wrong) = (group.zero(), other.zero());
            let m = n + 1;
            shape(psi.eval(&group, &wrong), &format!("u: {m}×{m}, expected {n}×{n}"));
            let inverse = psi.eval_dpsi_inv(&group, &u, &wrong);
            shape(inverse, &format!("v: {m}×{m}, expected {n}×{n}"));
        }
    }
    map(Exp);
    map(Exp.truncated(2));
    map(Cay);
    map(Pade22);
    map(CCSK123);
    map(CCSK321);

    let body = RigidBodyN::manakov(&[1.0, 2.0, 3.0, 4.0]).expect("a body");
    let grid = TimeGrid::with_steps([0.0, 1.0], 4).expect("a grid");
    let method = Rkmk::new(RK4, Exp);
    let mut small = Mat::<f64>::zeros(3, 3);
    let found = integrate(&body, &method, &grid, &SaveAt::Ends, &mut small, |_, _| {});
    assert!(matches!(
        found,
        Err(RunError::Setup(Error::Shape { arg: "y", rows: 3, expected_rows: 4, .. }))
    ));
    let attitude = RigidBodyNAttitude::new(body, Mat::zeros(4, 4)).expect("a body");
    let mut g = GroupMatrix::new_unchecked(Mat::identity(5, 5));
    let found = integrate(&attitude, &method, &grid, &SaveAt::Ends, &mut g, |_, _| {});
    assert!(matches!(found, Err(RunError::Setup(Error::Shape { arg: "y", rows: 5, .. }))));
}

/// X3: the closed forms in f32 agree with those in f64 to 4 eps_f32·cond, from 1e-40 to 1e30.
#[test]
fn x3_single_precision() {
    let mut rng = Pcg64::seed_from_u64(55);
    let eps = f64::from(f32::EPSILON);
    let mut worst = [0.0f64; 5];
    for _ in 0..20_000 {
        let size = 10f64.powf(rng.random_range(-40.0..30.0));
        let d = Vector3::<f64>::from_fn(|_, _| rng.random_range(-1.0..1.0)).normalize();
        let u32 = (d * size).map(|x| x as f32);
        let v32 = Vector3::from_fn(|_, _| rng.random_range(-1.0f32..1.0));
        let (u, v) = (u32.map(f64::from), v32.map(f64::from));
        let alpha = u.norm();
        let pole = (alpha - TAU * (alpha / TAU).round().max(1.0)).abs();
        let mut see = |k: usize, gap: f64, bound: f64| {
            let units = gap / (eps * bound);
            worst[k] = worst[k].max(units);
            assert!(units <= 4.0, "map {k} at |u| = {alpha:e}: {units}");
        };
        let wide = |g: Matrix3<f32>| g.map(f64::from);
        let (g32, g) = (so3::exp(&u32).expect("exp"), so3::exp(&u).expect("exp"));
        see(0, (wide(g32) - g).norm(), 3f64.sqrt() * alpha.max(1.0));
        let (g32, g) = (so3::cay(&u32).expect("cay"), so3::cay(&u).expect("cay"));
        see(1, (wide(g32) - g).norm(), 3f64.sqrt());
        let k32 = so3::ccsk::<f32, 2, 1, 0>(&u32).expect("ccsk");
        see(2, (wide(k32) - so3::ccsk::<f64, 2, 1, 0>(&u).expect("ccsk")).norm(), 3f64.sqrt());
        let w32 = so3::dexp(&u32, &v32).expect("dexp");
        let gap = (w32.map(f64::from) - so3::dexp(&u, &v).expect("dexp")).norm();
        see(3, gap, alpha.max(1.0) * v.norm());
        if let (Ok(w32), Ok(w)) = (so3::dexpinv(&u32, &v32), so3::dexpinv(&u, &v)) {
            let cond = (1.0 + alpha / pole) * (1.0 + alpha) * alpha.max(1.0);
            see(4, (w32.map(f64::from) - w).norm(), cond * v.norm());
        }
    }
    println!("exp, cay, ccsk, dexp, dexp⁻¹: {worst:.2?} eps_f32·cond");
}
