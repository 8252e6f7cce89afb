//! Schrödinger's equation with two levels and with more: Rabi's formula, a ladder, unitarity.

use super::*;
use faer::Mat;
use lieflow::methods::magnus::{Magnus4, Magnus6};
use lieflow::problems::{amplitudes, populations, schrodinger};

/// Rabi: H = ½[ω₀ Ωe^{−iωt}; Ωe^{iωt} −ω₀] takes level 0 to level 1 with the probability
/// Ω²/(Ω² + Δ²) sin²(√(Ω² + Δ²) t/2), Δ = ω − ω₀.
#[test]
fn rabis_formula() {
    let (omega0, omega, drive) = (3.0, 3.4, 0.9);
    let field = move |t: f64, i: usize, j: usize| match (i, j) {
        (0, 0) => [0.5 * omega0, 0.0],
        (1, 1) => [-0.5 * omega0, 0.0],
        _ => [0.5 * drive * (omega * t).cos(), -0.5 * drive * (omega * t).sin()],
    };
    let system = schrodinger(2, field).unwrap();
    let start = amplitudes(&[[1.0, 0.0], [0.0, 0.0]]).unwrap();
    let (t, general) = (5.0, (drive * drive + 0.16f64).sqrt());
    let expected = (drive / general * (0.5 * general * t).sin()).powi(2);
    let far = |p: &Mat<f64>| (populations(p)[1] - expected).abs();
    let of = [25, 50, 100].map(|n| far(&run(&system, &Magnus4, t, n, &start)));
    assert!(of[2] < 1e-5 && ((of[1] / of[2]).log2() - 4.0).abs() < 0.3, "{of:?}");
    let of = [20, 40, 80].map(|n| far(&run(&system, &Magnus6, t, n, &start)));
    assert!(of[2] < 1e-7 && ((of[1] / of[2]).log2() - 6.0).abs() < 0.5, "{of:?}");
    assert!(far(&run(&system, &Rkmk::new(RK4, Cay), t, 2000, &start)) < 1e-8);
    // |ψ| to a rounding a step, over 20 000 steps.
    let end = run(&system, &Magnus4, 1000.0, 20_000, &start);
    assert!((end.norm_l2() - 1.0).abs() < 20_000.0 * EPS, "{:e}", end.norm_l2() - 1.0);
}

/// A constant H with complex entries, against its eigenvectors: three levels in a ring.
#[test]
fn a_ring_of_three_levels() {
    // H_{j,j+1} = −e^{iφ}: energies −2 cos(k + φ) with the plane waves k = 2πl/3.
    let phi = 0.4f64;
    let ring = schrodinger(3, move |_, i, j| match (i, j) {
        (0, 2) => [-phi.cos(), phi.sin()], // from 0 back to 2: the conjugate
        _ if i == j => [0.0, 0.0],
        _ => [-phi.cos(), -phi.sin()],
    })
    .unwrap();
    for l in 0..3 {
        let k = core::f64::consts::TAU / 3.0 * f64::from(l);
        let wave = |phase: f64| {
            let at = |j: u32| [(k * f64::from(j) - phase).cos(), (k * f64::from(j) - phase).sin()];
            amplitudes(&[at(0), at(1), at(2)]).unwrap()
        };
        // ψ(t) = e^{−iEt}ψ(0).
        let energy = -2.0 * (k + phi).cos();
        let end = run(&ring, &Magnus4, 7.0, 10, &wave(0.0));
        let far = (&end - &wave(energy * 7.0)).norm_l2();
        assert!(far < 1e-13, "l = {l}: {far:e}");
    }
    assert!(amplitudes(&[]).is_err() && amplitudes(&[[0.0, 0.0]]).is_err());
    assert!(amplitudes(&[[f64::NAN, 0.0]]).is_err() && schrodinger(0, |_, _, _| [0.0; 2]).is_err());
}
