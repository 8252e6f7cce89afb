//! What each fuzz target does with its bytes: no panic, no hang, no NaN in an `Ok`, and an error that
//! names what was wrong. A plain module of functions from bytes: `cargo fuzz` runs them on what it
//! learns, and `cargo test` on random bytes (tests/fuzz.rs).

use crate::draw::Draw;
use faer::{Mat, c64};
use lieflow::groups::{
    Adjoint, AlgebraMatrix, ComplexMatrix, GroupMatrix, MatrixGroup, So3, UnitQuaternions, Unitary,
};
use lieflow::maps::{
    CCSK, CCSK123, CCSK321, Cay, CoordinateMap, Exp, Pade22, cay_inv, dcay, dexp,
    dexpinv_with_remainder, distance_to_singular,
};
use lieflow::methods::{Rkmk, tableau};
use lieflow::problems::RigidBody;
use lieflow::{Error, LieAlgebra, LieGroup, SaveAt, StepError, TimeGrid, integrate, so3};
use lieflow::{StepControl, integrate_adaptive};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// A target: its name and its body.
pub type Target = (&'static str, fn(&[u8]));

/// All targets of the library.
pub const TARGETS: &[Target] = &[
    ("so3_exp", so3_exp),
    ("so3_log", so3_log),
    ("so3_cay", so3_cay),
    ("so3_ccsk", so3_ccsk),
    ("so3_batch", so3_batch),
    ("groups", groups),
    ("exp", exp),
    ("dexp", dexp_both_ways),
    ("cay", cay),
    ("pade22", pade22),
    ("ccsk", ccsk),
    ("log", log),
    ("adjoint", adjoint),
    ("unitary", unitary),
    ("integrate", fixed_steps),
    ("adaptive", chosen_steps),
];

impl Draw<'_> {
    fn vector(&mut self) -> Vector3<f64> {
        match self.byte() % 4 {
            // Of a chosen length.
            0 => {
                let d = Vector3::from_fn(|_, _| self.unit());
                d / d.norm() * self.number()
            }
            1 => Vector3::ith(self.below(3), self.number()),
            _ => Vector3::from_fn(|_, _| self.number()),
        }
    }
    fn group(&mut self, most: usize) -> MatrixGroup {
        let n = 1 + self.below(most);
        match self.byte() % 5 {
            0 => MatrixGroup::gl(n),
            1 => MatrixGroup::sp(2 * n.div_ceil(2)),
            2 => MatrixGroup::indefinite(n, 1 + self.below(2)),
            3 => MatrixGroup::gm(Mat::from_fn(n, n, |i, j| {
                if i == j { 2.0 } else { 0.3 * ((3 * i + j) as f64).sin() }
            })),
            _ => MatrixGroup::so(n),
        }
        .expect("a group of ordinary size")
    }
    /// One wild entry, all of a wild size, or all wild.
    fn matrix(&mut self, n: usize) -> Mat<f64> {
        let (kind, wild) = (self.byte() % 4, self.number());
        let place = self.below(n * n);
        let mut x = Mat::zeros(n, n);
        for j in 0..n {
            for i in 0..n {
                x[(i, j)] = match kind {
                    0 => self.number(),
                    1 => wild * self.unit(),
                    2 if i + n * j == place => wild,
                    _ => self.unit(),
                };
            }
        }
        x
    }
    fn algebra(&mut self, group: &MatrixGroup) -> AlgebraMatrix {
        let x = self.matrix(group.n());
        group.project_algebra(x.as_ref())
    }
}

fn all_finite(x: &Mat<f64>) -> bool {
    x.col_iter().all(|c| c.iter().all(|x| x.is_finite()))
}

/// An error says something, and of which argument.
fn told(error: &Error) {
    let message = error.to_string();
    let names = ["u", "v", "g", "R", "M", "n", "q", "dt", "t_span", "times", "argument", "Schur"];
    assert!(names.iter().any(|name| message.contains(name)), "{message}");
}

fn vector(found: Result<Vector3<f64>, StepError>) {
    assert!(found.is_err() || found.is_ok_and(|w| w.iter().all(|x| x.is_finite())), "{found:?}");
}

fn algebra(found: Result<AlgebraMatrix, Error>) {
    match found {
        Ok(w) => assert!(all_finite(&w), "{w:?}"),
        Err(error) => told(&error),
    }
}

fn rotation(u: &Vector3<f64>, found: Result<Matrix3<f64>, StepError>) {
    match found {
        Ok(g) => {
            assert!(u.iter().all(|x| x.is_finite()), "Ok at {u:?}");
            assert!((g.transpose() * g - Matrix3::identity()).norm() <= 12.0 * f64::EPSILON);
        }
        // Every ordinary vector has a rotation.
        Err(error) => {
            assert!(u.iter().any(|x| !x.is_finite() || x.abs() > 1e307), "{u:?}: {error}")
        }
    }
}

fn so3_exp(data: &[u8]) {
    let mut draw = Draw(data);
    let (u, v) = (draw.vector(), draw.vector());
    rotation(&u, so3::exp(&u));
    for w in [so3::exp_on(&u, &v), so3::dexp(&u, &v), so3::dexpinv(&u, &v)] {
        vector(w);
    }
    for m in [so3::dexp_matrix(&u), so3::dexpinv_matrix(&u)] {
        assert!(m.is_err() || m.is_ok_and(|m| m.iter().all(|x| x.is_finite())), "{u:?}");
    }
    if let Ok(q) = so3::exp_quaternion(&u) {
        assert!((q.norm() - 1.0).abs() <= 4.0 * f64::EPSILON);
        assert!(so3::log_quaternion(&q).is_ok_and(|w| w.norm() <= PI * (1.0 + f64::EPSILON)));
    }
    for q in [0, 1, 2, 5, 20] {
        let group = So3::<f64>::new();
        if let Ok(w) = Exp.truncated(q).eval_dpsi_inv(&group, &u, &v) {
            assert!(group.is_finite(&w));
        }
    }
}

fn so3_log(data: &[u8]) {
    let mut draw = Draw(data);
    let mut r = match draw.byte() % 2 {
        0 => Matrix3::from_fn(|_, _| draw.number()),
        _ => so3::exp(&draw.vector()).unwrap_or(Matrix3::identity()),
    };
    let (i, j) = (draw.below(3), draw.below(3));
    r[(i, j)] += 1e-6 * draw.number();
    let bound = PI * (1.0 + f64::EPSILON);
    match so3::log(&r) {
        Ok(u) => assert!(u.norm() <= bound, "{r:?}"),
        Err(error) => told(&error),
    }
    if let Ok(u) = so3::cay_inv(&r) {
        assert!(u.iter().all(|x| x.is_finite()), "{r:?}");
    }
    if let Ok(u) = so3::ccsk_inv::<2, 1, 0>(&r) {
        assert!(u.iter().all(|x| x.abs() <= bound), "{r:?}");
    }
    if let Ok(q) = so3::quaternion_from_matrix(&r) {
        assert!((q.norm() - 1.0).abs() <= 4.0 * f64::EPSILON, "{r:?}");
    }
    let q = [(); 4].map(|()| draw.number());
    if let Ok(q) = so3::quaternion_from_wxyz(q) {
        assert!((q.norm() - 1.0).abs() <= 4.0 * f64::EPSILON);
    }
}

fn so3_cay(data: &[u8]) {
    let mut draw = Draw(data);
    let (u, v) = (draw.vector(), draw.vector());
    rotation(&u, so3::cay(&u));
    vector(so3::dcay(&u, &v));
    vector(so3::dcayinv(&u, &v));
    let group = So3::<f64>::new();
    if let Ok(g) = Pade22.eval(&group, &u) {
        assert!(group.defect(&g) <= 12.0 * f64::EPSILON);
    }
    if let Ok(w) = Pade22.eval_dpsi_inv(&group, &u, &v) {
        assert!(group.is_finite(&w), "{u:?} {v:?} {w:?}");
    }
}

fn so3_ccsk(data: &[u8]) {
    let mut draw = Draw(data);
    let (u, v) = (draw.vector(), draw.vector());
    rotation(&u, so3::ccsk::<f64, 0, 1, 2>(&u));
    rotation(&u, so3::ccsk::<f64, 1, 0, 2>(&u));
    vector(so3::dccsk::<f64, 2, 1, 0>(&u, &v));
    vector(so3::dccskinv::<f64, 2, 1, 0>(&u, &v));
    let group = So3::<f64>::new();
    for w in [CCSK123.eval_dpsi_inv(&group, &u, &v), CCSK321.eval_dpsi_inv(&group, &u, &v)] {
        assert!(w.is_err() || w.is_ok_and(|w| group.is_finite(&w)), "{u:?} {v:?}");
    }
}

fn so3_batch(data: &[u8]) {
    let mut draw = Draw(data);
    let n = draw.below(150);
    let u: [Vec<f64>; 3] = [(); 3].map(|()| (0..n).map(|_| draw.number()).collect());
    let mut r: [Vec<f64>; 9] = [(); 9].map(|()| vec![0.0; n]);
    let views = u.each_ref().map(|x| &x[..]);
    let end = match so3::batch::exp(views, r.each_mut().map(|x| &mut x[..])) {
        Ok(()) => n,
        Err(Error::Element { index, .. }) => index,
        Err(error) => panic!("{error}"),
    };
    for i in 0..end {
        let g = Matrix3::from_fn(|a, b| r[3 * a + b][i]);
        assert!((g.transpose() * g - Matrix3::identity()).norm() <= 12.0 * f64::EPSILON);
    }
    let mut w: [Vec<f64>; 3] = [(); 3].map(|()| vec![0.0; n]);
    let ones = vec![1.0; n];
    let v = [&ones[..]; 3];
    if so3::batch::dexpinv(views, v, w.each_mut().map(|x| &mut x[..])).is_ok() {
        assert!(w.iter().flatten().all(|x| x.is_finite()));
    }
}

fn groups(data: &[u8]) {
    let mut draw = Draw(data);
    let size = draw.bits(1 + u32::from(draw.0.first().copied().unwrap_or(0) % 8)) as usize;
    for group in [MatrixGroup::so(size), MatrixGroup::gl(size), MatrixGroup::sp(size)] {
        match group {
            Ok(group) => assert_eq!(group.n(), size),
            Err(error) => assert!(error.to_string().contains("n = "), "{error}"),
        }
    }
    let (rows, cols) = (draw.below(7), draw.below(7));
    let wild = draw.matrix(rows.max(cols).max(1));
    let x = Mat::from_fn(rows, cols, |i, j| wild[(i, j)]);
    if let Err(error) = MatrixGroup::gm(x.clone()) {
        told(&error);
    }
    let group = draw.group(6);
    for found in [group.algebra(x.clone()).map(|_| ()), group.element(x).map(|_| ())] {
        if let Err(error) = found {
            told(&error);
        }
    }
}

/// Ψ, Ψ(u)·x and dΨ⁻¹ of a map on a drawn group.
fn map<Psi: CoordinateMap<MatrixGroup>>(psi: Psi, data: &[u8]) {
    let mut draw = Draw(data);
    let group = draw.group(12);
    let n = group.n();
    let (u, v) = (draw.algebra(&group), draw.algebra(&group));
    match psi.eval(&group, &u) {
        Ok(g) => assert!(all_finite(&g) && all_finite(&u), "{} at {u:?}", psi.name()),
        Err(error) => told(&error),
    }
    algebra(psi.eval_dpsi_inv(&group, &u, &v));
    let Ok(mut at) = psi.at(&group) else { return };
    let (mut g, x, mut y) = (group.identity(), Mat::full(n, 1, 1.0), Mat::zeros(n, 1));
    if psi.psi_on(&group, &u, &mut at, &mut g, &x, &mut y).is_ok() {
        assert!(all_finite(&y), "{}(u)·x at {u:?}", psi.name());
    }
}

fn exp(data: &[u8]) {
    map(Exp, data);
}

fn cay(data: &[u8]) {
    map(Cay, data);
    let mut draw = Draw(data);
    let group = draw.group(12);
    let (u, v) = (draw.algebra(&group), draw.algebra(&group));
    algebra(dcay(&group, &u, &v));
    let g = GroupMatrix::new_unchecked(draw.matrix(group.n()));
    algebra(cay_inv(&group, &g));
}

fn pade22(data: &[u8]) {
    map(Pade22, data);
}

fn ccsk(data: &[u8]) {
    map(CCSK123, data);
    map(CCSK321, data);
    map(CCSK, data);
}

fn dexp_both_ways(data: &[u8]) {
    let mut draw = Draw(data);
    let group = draw.group(12);
    let (u, v) = (draw.algebra(&group), draw.algebra(&group));
    algebra(dexp(&group, &u, &v));
    let q = draw.below(40);
    match dexpinv_with_remainder(&group, &u, &v, q) {
        Ok(cut) => assert!(all_finite(&cut.value) && !cut.remainder.is_nan(), "{u:?}"),
        Err(error) => told(&error),
    }
    match distance_to_singular(&group, &u) {
        Ok(distance) => assert!(distance >= 0.0, "{distance} at {u:?}"),
        Err(error) => told(&error),
    }
}

fn log(data: &[u8]) {
    let mut draw = Draw(data);
    let group = draw.group(12);
    let x = draw.matrix(group.n());
    algebra(group.log(&GroupMatrix::new_unchecked(x)));
    let u = draw.algebra(&group);
    if let Ok(mut g) = Exp.eval(&group, &u) {
        let (i, j) = (draw.below(group.n()), draw.below(group.n()));
        g[(i, j)] += 1e-8 * draw.number();
        algebra(group.log(&g));
    }
}

fn adjoint(data: &[u8]) {
    let mut draw = Draw(data);
    let group = draw.group(12);
    let g = GroupMatrix::new_unchecked(draw.matrix(group.n()));
    let (u, m) = (draw.algebra(&group), draw.matrix(group.n()));
    let (mut w, mut d) = (group.zero(), m.clone());
    if group.big_ad(&g, &u, &mut w).is_ok() {
        assert!(all_finite(&w));
    }
    if group.coad_group(&g, &m, &mut d).is_ok() {
        assert!(all_finite(&d));
    }
    group.ad(&u, &w.clone(), &mut w);
    group.coad(&u, &m, &mut d);
    let mut corrected = g.clone();
    group.correct(&mut corrected, [&mut group.identity(), &mut group.identity()]);
    let so3 = So3::<f64>::new();
    let (r, u) = (Matrix3::from_fn(|_, _| draw.number()), draw.vector());
    let mut w = u;
    if so3.big_ad(&r, &u, &mut w).is_ok() {
        assert!(so3.is_finite(&w));
    }
}

/// The maps of U(n) and of the unit quaternions, dexp both ways, log, Ad.
fn unitary(data: &[u8]) {
    let mut draw = Draw(data);
    let n = 1 + draw.below(6);
    let group = Unitary::new(n).expect("a group of ordinary size");
    let mut element = || {
        let (re, im) = (draw.matrix(n), draw.matrix(n));
        ComplexMatrix { re, im }
    };
    let (x, y, wild) = (element(), element(), element());
    let skew = |x: &ComplexMatrix| {
        let z = |i, j| 0.5 * (x.get(i, j) - x.get(j, i).conj());
        ComplexMatrix::from_fn(
            n,
            n,
            |i, j| if i == j { c64::new(0.0, z(i, i).im) } else { z(i, j) },
        )
    };
    let (u, v) = (skew(&x), skew(&y));
    let finite = |x: &ComplexMatrix| all_finite(&x.re) && all_finite(&x.im);
    for g in [Exp.eval(&group, &u), Cay.eval(&group, &u)] {
        match g {
            Ok(g) => assert!(finite(&u) && group.defect(&g) <= 1e-12, "{u:?}"),
            Err(error) => told(&error),
        }
    }
    for w in [Exp.eval_dpsi_inv(&group, &u, &v), Cay.eval_dpsi_inv(&group, &u, &v)] {
        match w {
            Ok(w) => assert!(finite(&w), "{u:?} {v:?}"),
            Err(error) => told(&error),
        }
    }
    let mut at = Exp.at(&group).expect("exp serves the group");
    let mut w = v.clone();
    assert!(at.dexp(&group, &u, &mut w).is_err() || finite(&w), "{u:?} {v:?}");
    match at.distance_to_singular(&u) {
        Ok(distance) => assert!(distance >= 0.0, "{distance} at {u:?}"),
        Err(error) => told(&error.into()),
    }
    assert!(group.big_ad(&wild, &u, &mut w).is_err() || finite(&w), "{wild:?} {u:?}");
    assert!(group.coad_group(&wild, &u, &mut w).is_err() || finite(&w), "{wild:?} {u:?}");
    let mut g = wild;
    group.correct(&mut g, [&mut group.identity(), &mut group.identity()]);
    let (u, v) = (draw.vector(), draw.vector());
    for w in
        [Exp.eval_dpsi_inv(&UnitQuaternions, &u, &v), Cay.eval_dpsi_inv(&UnitQuaternions, &u, &v)]
    {
        assert!(w.is_err() || w.is_ok_and(|w| w.iter().all(|x| x.is_finite())), "{u:?} {v:?}");
    }
}

fn body(draw: &mut Draw<'_>) -> Option<(RigidBody, Vector3<f64>)> {
    let inertia = [(); 3].map(|()| draw.number().abs());
    Some((RigidBody::new(inertia).ok()?, draw.vector()))
}

fn fixed_steps(data: &[u8]) {
    let mut draw = Draw(data);
    let span = [draw.number(), draw.number()];
    let steps = draw.below(50) as u64;
    if let Err(error) = TimeGrid::new(span, draw.number()) {
        told(&error);
    }
    let Ok(grid) = TimeGrid::with_steps(span, steps) else { return };
    let save = match draw.byte() % 3 {
        0 => SaveAt::Ends,
        1 => SaveAt::Every(draw.below(5) as u64),
        _ => SaveAt::Times((0..draw.below(5)).map(|_| draw.number()).collect()),
    };
    let Some((body, mut m)) = body(&mut draw) else { return };
    let finite = m.iter().all(|x| x.is_finite());
    let mut seen = Vec::new();
    let look = |t: f64, m: &Vector3<f64>| seen.push((t, *m));
    let method = Rkmk::new(tableau::RK4, Exp);
    let found = integrate(&body, &method, &grid, &save, &mut m, look);
    assert!(!finite || seen.iter().all(|(t, m)| t.is_finite() && m.iter().all(|x| x.is_finite())));
    // An empty span has no steps, whatever was asked for.
    assert!(finite || grid.steps() == 0 || found.is_err(), "a start that is not finite");
    if let Err(error) = found {
        assert!(!error.to_string().is_empty());
    }
}

fn chosen_steps(data: &[u8]) {
    let mut draw = Draw(data);
    let span = [draw.number(), draw.number()];
    let control = StepControl::new(draw.number(), draw.number()).and_then(|c| c.max_steps(200));
    let Ok(control) = control else { return };
    let Some((body, mut m)) = body(&mut draw) else { return };
    let finite = m.iter().all(|x| x.is_finite());
    let method = Rkmk::new(tableau::DOPRI5, Exp);
    let look = |_: f64, m: &Vector3<f64>| assert!(!finite || m.iter().all(|x| x.is_finite()));
    let found = integrate_adaptive(&body, &method, span, &control, &SaveAt::Ends, &mut m, look);
    if let Err(error) = found {
        assert!(!error.to_string().is_empty());
    }
}
