//! How fast methods that do not keep the energy lose it: the rate of E(t) as a power of the step, on
//! the free rigid body with its attitude. And whether a method asks how space is laid out: a rotation
//! of the space frame, m_s → R m_s, g₀ → R g₀, changes nothing in the body.
//!
//! | Ψ | the rate of E behaves like | a rotated frame |
//! |---|---|---|
//! | exp, cay, Padé; Buss's method; RK4 on the entries | h⁵ | changes nothing |
//! | ccsk | h⁴ on generic momenta, h⁵ when m_s has a zero component | changes E |

use lieflow::maps::{CCSK, CCSK123, CCSK321, Cay, Exp, Pade22};
use lieflow::methods::{Buss4, Method, Rk, Rkmk, tableau::RK4};
use lieflow::problems::RigidBodyAttitude;
use lieflow::so3::exp;
use lieflow::{SaveAt, TimeGrid, integrate};
use nalgebra::{Matrix3, Vector3};

const INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
const GENERIC: [f64; 3] = [0.9, 1.0, 2.1];

/// Times and energies after every step up to `end`, from the attitude `start`.
fn energies<M: Method<RigidBodyAttitude>>(
    method: &M,
    momentum: Vector3<f64>,
    start: Matrix3<f64>,
    end: f64,
    h: f64,
) -> Vec<(f64, f64)> {
    let body = RigidBodyAttitude::<f64>::new(INERTIA, momentum.into()).expect("a body");
    let (mut g, mut seen) = (start, Vec::new());
    let grid = TimeGrid::new([0.0, end], h).expect("a grid");
    integrate(&body, method, &grid, &SaveAt::Every(1), &mut g, |t, g| {
        seen.push((t, body.body().energy(&body.momentum_body(g))));
    })
    .expect("a run");
    seen
}

/// The slope of the line that fits best.
fn rate(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let t_mean = points.iter().map(|p| p.0).sum::<f64>() / n;
    let e_mean = points.iter().map(|p| p.1).sum::<f64>() / n;
    let (mut tt, mut te) = (0.0, 0.0);
    for (t, e) in points {
        tt += (t - t_mean) * (t - t_mean);
        te += (t - t_mean) * (e - e_mean);
    }
    te / tt
}

/// Rates at a step that is halved three times.
fn rates<M>(method: &M, momentum: [f64; 3], end: f64, h: f64) -> [f64; 4]
where
    M: Method<RigidBodyAttitude>,
{
    [h, h / 2.0, h / 4.0, h / 8.0]
        .map(|h| rate(&energies(method, momentum.into(), Matrix3::identity(), end, h)))
}

/// Exponents between neighbours of quantities that belong to halved steps.
fn exponents(rates: &[f64]) -> Vec<f64> {
    rates.windows(2).map(|r| (r[0] / r[1]).abs().log2()).collect()
}

macro_rules! check {
    ($momentum:expr, $end:expr, $expected:expr, $($method:expr),*) => {$({
        let rates = rates(&$method, $momentum, $end, 0.1);
        let found = exponents(&rates);
        println!("{:28} {found:.2?}  {rates:?}", stringify!($method));
        assert!(found.iter().all(|p| (p - $expected).abs() <= 0.15), "{found:?}");
    })*};
}

#[test]
fn the_energy_drifts_with_the_fifth_power() {
    check!(GENERIC, 2000.0, 5.0, Rkmk::new(RK4, Exp), Rkmk::new(RK4, Cay));
    check!(GENERIC, 2000.0, 5.0, Rkmk::new(RK4, Pade22), Buss4, Rk(RK4));
}

/// The term of h⁵ is there as well; without it, in r(h/2) − r(h)/32, the fourth power is plain.
#[test]
fn with_ccsk_it_drifts_with_the_fourth() {
    macro_rules! check {
        ($($method:expr),*) => {$({
            let found = rates(&$method, GENERIC, 2000.0, 0.05);
            let two: Vec<f64> = found.windows(2).map(|r| r[1] - r[0] / 32.0).collect();
            println!(
                "{:28} {:.2?}, without the term of h⁵ {:.2?}",
                stringify!($method), exponents(&found), exponents(&two)
            );
            assert!(exponents(&two).iter().all(|p| (p - 4.0).abs() <= 0.15));
        })*};
    }
    check!(Rkmk::new(RK4, CCSK123), Rkmk::new(RK4, CCSK321), Rkmk::new(RK4, CCSK));
}

/// A half turn about the axis of the zero reverses the motion, and ccsk commutes with it.
#[test]
fn with_a_zero_in_the_momentum_ccsk_gains_a_power() {
    check!([0.9, 0.0, 2.1], 4000.0, 5.0, Rkmk::new(RK4, CCSK123), Rkmk::new(RK4, CCSK321));
}

/// exp, cay, Buss's method and RK4 do not see the frame, ccsk does.
#[test]
fn rotated_frames() {
    let turn = exp(&Vector3::new(0.4, -1.1, 0.7)).expect("a rotation");
    let gap = |method: &dyn Fn(Vector3<f64>, Matrix3<f64>) -> Vec<(f64, f64)>| {
        let momentum = Vector3::from(GENERIC);
        let here = method(momentum, Matrix3::identity());
        let there = method(turn * momentum, turn);
        let gap = here.iter().zip(&there).map(|(a, b)| (a.1 - b.1).abs()).fold(0.0, f64::max);
        let lost = here.iter().map(|e| (e.1 - here[0].1).abs()).fold(0.0, f64::max);
        (gap, lost)
    };
    macro_rules! gap {
        ($method:expr) => {
            gap(&|momentum, start| energies(&$method, momentum, start, 100.0, 0.1))
        };
    }
    for (name, (gap, lost)) in [
        ("exp", gap!(Rkmk::new(RK4, Exp))),
        ("cay", gap!(Rkmk::new(RK4, Cay))),
        ("pade22", gap!(Rkmk::new(RK4, Pade22))),
        ("buss4", gap!(Buss4)),
        ("rk4", gap!(Rk(RK4))),
    ] {
        println!("{name}: {gap:.1e} of {lost:.1e}");
        // Rounding of 1000 steps.
        assert!(gap < 1e-12 && lost > 1e-7, "{name}: {gap:e}, {lost:e}");
    }
    for (name, (gap, lost)) in [
        ("ccsk123", gap!(Rkmk::new(RK4, CCSK123))),
        ("ccsk321", gap!(Rkmk::new(RK4, CCSK321))),
        ("ccsk", gap!(Rkmk::new(RK4, CCSK))),
    ] {
        println!("{name}: {gap:.1e} of {lost:.1e}");
        assert!(gap > 0.1 * lost && gap > 1e-7, "{name}: {gap:e}, {lost:e}");
    }
}
