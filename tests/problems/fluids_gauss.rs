//! Isospectral Gauss methods on fluids: with one stage they are the midpoint rule, with two and three they have
//! order 4 and 6; all keep what the midpoint rule keeps.

use lieflow::groups::ComplexMatrix;
use lieflow::maps::Exp;
use lieflow::methods::FluidMidpoint;
use lieflow::methods::{GAUSS2, GAUSS4, GAUSS6, IsospectralGauss, Metric, Rkmk, tableau::DOP853};
use lieflow::problems::{Invariants, Surface, Zeitlin};
use lieflow::{Method, SaveAt, TimeGrid, integrate};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const EPS: f64 = f64::EPSILON;

fn run<S: Surface, M: Method<Zeitlin<S>>>(
    fluid: &Zeitlin<S>,
    method: &M,
    w: &ComplexMatrix,
    t: f64,
    steps: u64,
) -> ComplexMatrix {
    let mut w = w.clone();
    let grid = TimeGrid::with_steps([0.0, t], steps).expect("a grid");
    integrate(fluid, method, &grid, &SaveAt::Ends, &mut w, |_, _| {}).expect("a run");
    w
}

#[test]
fn one_stage_is_the_midpoint_rule() {
    let fluid = Zeitlin::sphere(17).expect("a sphere");
    let w = fluid.random(&mut Pcg64::seed_from_u64(2), 6).expect("a field");
    let general = run(&fluid, &IsospectralGauss(GAUSS2), &w, 1.0, 20);
    let ours = run(&fluid, &FluidMidpoint::isospectral(), &w, 1.0, 20);
    let gap = general.distance(&ours);
    assert!(gap < 64.0 * EPS * 20.0 * w.size(), "{gap:.1e}");
}

fn orders_are_measured<S: Surface>(fluid: &Zeitlin<S>, w: &ComplexMatrix, t: f64) {
    let exact = run(fluid, &Rkmk::new(DOP853, Exp), w, t, 200);
    assert!(exact.distance(w) > 0.1 * w.size(), "it moves");
    let slope = |error: &dyn Fn(u64) -> f64| (error(5) / error(10)).log2();
    let four = slope(&|n| run(fluid, &IsospectralGauss(GAUSS4), w, t, n).distance(&exact));
    let six = slope(&|n| run(fluid, &IsospectralGauss(GAUSS6), w, t, n).distance(&exact));
    assert!((four - 4.0).abs() < 0.2 && (six - 6.0).abs() < 0.3, "{four:.2} {six:.2}");
}

#[test]
fn orders_on_both_surfaces() {
    let rng = &mut Pcg64::seed_from_u64(3);
    let (sphere, torus) =
        (Zeitlin::sphere(6).expect("a sphere"), Zeitlin::torus(7).expect("a torus"));
    orders_are_measured(&sphere, &sphere.random(rng, 5).expect("a field"), 1.5);
    orders_are_measured(&torus, &torus.random(rng, 3).expect("a field"), 1.0);
}

/// Spectrum, Casimirs and the angular momentum to rounding; the energy to the order.
#[test]
fn what_is_promised_is_kept() {
    fn check<const S: usize>(
        fluid: &Zeitlin<lieflow::problems::Sphere>,
        method: IsospectralGauss<S>,
    ) {
        let w = fluid.random(&mut Pcg64::seed_from_u64(1), 8).expect("a field");
        let (levels, start) = (fluid.spectrum(&w).expect("levels"), fluid.values(&w));
        let steps = 200;
        let end = run(fluid, &method, &w, 50.0 * fluid.hbar(), steps);
        assert!(end.distance(&w) > 0.1 * w.size(), "it moves");
        assert!(end.skew_residual() == 0.0);
        let rounding = 16.0 * EPS * (steps as f64).sqrt();
        let now = fluid.spectrum(&end).expect("levels");
        let gap = now.iter().zip(&levels).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let values = fluid.values(&end);
        let drift = |k: usize| (values[k] - start[k]).abs();
        println!(
            "{S} stages: spectrum {gap:.1e}, energy {:.1e}, momentum {:.1e}",
            drift(0),
            drift(4)
        );
        assert!(gap < rounding * w.size(), "the spectrum: {gap:.1e}");
        assert!((1..4).all(|k| drift(k) < rounding * start[k].abs().max(1.0)), "Casimirs");
        assert!((4..7).all(|k| drift(k) < rounding), "angular momentum");
        assert!(drift(0) < 1e-3 * start[0], "the energy: {:.1e}", drift(0));
    }
    let fluid = Zeitlin::sphere(24).expect("a sphere");
    check(&fluid, IsospectralGauss(GAUSS2));
    check(&fluid, IsospectralGauss(GAUSS4));
    check(&fluid, IsospectralGauss(GAUSS6));
}
