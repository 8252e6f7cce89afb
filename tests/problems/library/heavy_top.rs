//! The heavy top: steady precession in closed form, the integrable cases, what is refused.

use super::*;
use lieflow::problems::HeavyTop;
use nalgebra::Vector3;

type V = Vector3<f64>;

/// A Lagrange top (A, A, C) with weight w leans by θ and precesses at the steady rate Ω when its spin
/// is ω₃ = (AΩ² cos θ + w)/(CΩ). Seen from the body the vertical γ turns about e₃ at the rate
/// Ω cos θ − ω₃, and μ = AΩγ + (Cω₃ − AΩ cos θ) e₃.
#[test]
fn steady_precession_of_lagranges_top() {
    let (a, c, w, theta, rate) = (1.2, 0.5, 2.0, 0.7f64, 0.9);
    let spin = (a * rate * rate * theta.cos() + w) / (c * rate);
    let at = |t: f64| {
        let phase = (rate * theta.cos() - spin) * t;
        let gamma = V::new(theta.sin() * phase.cos(), theta.sin() * phase.sin(), theta.cos());
        (a * rate * gamma + V::z() * (c * spin - a * rate * theta.cos()), gamma)
    };
    let top = HeavyTop::lagrange(a, c, w).unwrap().problem();
    let far = [200, 400, 800].map(|n| flow(&top, 2.0, n, &at(0.0)).distance(&at(2.0)));
    assert!(far[2] < 1e-7 && (far[0] / far[1]).log2() > 3.8, "{far:?}");
    assert!(((far[1] / far[2]).log2() - 4.0).abs() < 0.2, "{far:?}");
}

const START: (V, V) = (V::new(0.4, -0.3, 1.5), V::new(0.48, 0.6, 0.64));

#[test]
fn integrals_of_the_integrable_cases() {
    let names = |top: HeavyTop| -> Vec<String> {
        top.problem().invariants().into_iter().map(|i| i.name).collect()
    };
    let lagrange = HeavyTop::lagrange(1.0, 0.6, 1.3).unwrap();
    let kovalevskaya = HeavyTop::kovalevskaya(0.5, 1.1).unwrap();
    let euler = HeavyTop::new([1.0, 2.0, 2.5], [0.0; 3]).unwrap();
    let general = HeavyTop::new([1.0, 2.0, 2.5], [0.3, -0.2, 1.0]).unwrap();
    assert_eq!(names(lagrange), ["energy", "|γ|²", "μ·γ", "μ₃"]);
    assert_eq!(names(kovalevskaya).last().unwrap(), "Kovalevskaya's integral");
    assert_eq!(names(euler).last().unwrap(), "|μ|²");
    assert_eq!(names(general), ["energy", "|γ|²", "μ·γ"]);
    // A Gauss method keeps the energy, and Lagrange's and Euler's integral, since their degree is at most 2.
    let degrees = |top: HeavyTop| -> Vec<u32> {
        top.problem().invariants().into_iter().map(|i| i.law.degree).collect()
    };
    assert_eq!(degrees(lagrange), [2, 2, 2, 1]);
    assert_eq!(degrees(euler), [2, 2, 2, 2]);
    assert_eq!(degrees(kovalevskaya), [2, 2, 2, 4]);
    for top in [lagrange, kovalevskaya, euler, general] {
        has_order_4(&top.problem(), &START, 2.0, 40);
        keeps_its_invariants(&top.problem(), &START, 10.0, 4000, 1e-9);
    }
    // Kovalevskaya's integral belongs to her top alone: with another weight it moves.
    let values = |top: HeavyTop, y: &(V, V)| *top.problem().values(y).last().unwrap();
    let tilted = HeavyTop::new([1.0, 1.0, 0.5], [1.1, 0.0, 0.1]).unwrap();
    let end = flow(&tilted.problem(), 10.0, 4000, &START);
    assert!((values(kovalevskaya, &end) - values(kovalevskaya, &START)).abs() > 1e-3);
}

/// The axis of a top may be any of the three, and the centre of mass of Kovalevskaya's anywhere in its equator.
#[test]
fn integrable_tops_about_any_axis() {
    for k in 0..3 {
        let axes = |c: f64, a: f64, b: f64| {
            let mut all = [0.0; 3];
            [c, a, b].into_iter().enumerate().for_each(|(i, x)| all[(k + i) % 3] = x);
            all
        };
        let lagrange = HeavyTop::new(axes(0.6, 1.0, 1.0), axes(1.3, 0.0, 0.0)).unwrap();
        assert_eq!(lagrange.problem().invariants()[3].name, ["μ₁", "μ₂", "μ₃"][k]);
        keeps_its_invariants(&lagrange.problem(), &START, 10.0, 4000, 1e-9);
        for [x, y] in [[1.1, 0.0], [0.0, -0.7], [0.6, 0.8]] {
            let top = HeavyTop::new(axes(0.5, 1.0, 1.0), axes(0.0, x, y)).unwrap();
            assert_eq!(top.problem().invariants()[3].name, "Kovalevskaya's integral");
            keeps_its_invariants(&top.problem(), &START, 10.0, 4000, 1e-9);
        }
        let tilted: HeavyTop = HeavyTop::new(axes(0.5, 1.0, 1.0), axes(0.1, 1.1, 0.0)).unwrap();
        assert!(!tilted.is_integrable());
    }
    // Moments and axes of a tensor have its rounding.
    let top = HeavyTop::new([1.0, 1.0 + f64::EPSILON, 0.6], [1e-17, -2e-17, 1.3]).unwrap();
    assert_eq!(top.problem().invariants()[3].name, "μ₃");
    keeps_its_invariants(&top.problem(), &START, 10.0, 4000, 1e-9);
    let top: HeavyTop = HeavyTop::new([1.0, 1.0 - f64::EPSILON, 0.5], [0.6, 0.8, 2e-17]).unwrap();
    assert_eq!(top.problem().invariants()[3].name, "Kovalevskaya's integral");
    // With three equal moments each top is Lagrange's, about w.
    let sphere = HeavyTop::new([2.0; 3], [0.3, 0.4, 0.5]).unwrap();
    assert_eq!(sphere.problem().invariants()[3].name, "μ·w/|w|");
    keeps_its_invariants(&sphere.problem(), &START, 10.0, 4000, 1e-9);
    let nearly: HeavyTop = HeavyTop::new([1.0, 1.0 + 1e-12, 0.6], [0.0, 0.0, 1.3]).unwrap();
    assert!(!nearly.is_integrable());
}

/// Hanging straight down is a fixed point, bit for bit; upright with enough spin stays upright.
#[test]
fn sleeping_tops() {
    let top = HeavyTop::lagrange(1.0, 0.5, 1.0).unwrap().problem();
    let hanging = (V::zeros(), V::new(0.0, 0.0, -1.0));
    assert_eq!(flow(&top, 10.0, 100, &hanging), hanging);
    // Stable for C²ω₃² > 4Aw.
    let sleeping = (V::new(0.0, 1e-6, 0.5 * 4.2), V::z());
    let end = flow(&top, 30.0, 6000, &sleeping);
    assert!(end.1[2] > 1.0 - 1e-9, "{}", 1.0 - end.1[2]);
    let falling = (V::new(0.0, 1e-6, 0.5 * 3.0), V::z());
    let (mut lowest, mut y) = (1.0f64, falling);
    let (grid, method) = (TimeGrid::new([0.0, 40.0], 0.01).unwrap(), Rkmk::new(RK4, Exp));
    integrate(&top, &method, &grid, &SaveAt::Every(10), &mut y, |_, y| lowest = lowest.min(y.1[2]))
        .unwrap();
    assert!(lowest < 0.5, "{lowest}");
}

#[test]
fn invalid_tops_are_refused() {
    assert!(HeavyTop::<f64>::new([1.0, 0.0, 1.0], [0.0; 3]).is_err());
    assert!(HeavyTop::<f64>::new([1.0, 1.0, f64::NAN], [0.0; 3]).is_err());
    let error = HeavyTop::<f64>::new([1.0; 3], [0.0, f64::INFINITY, 0.0]).unwrap_err();
    assert!(error.to_string().starts_with("weight[1]"), "{error}");
}
