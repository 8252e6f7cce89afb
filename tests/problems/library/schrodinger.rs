//! Schrödinger's equation with two levels and with more: Rabi's formula, a ladder, unitarity; the same by density
//! matrices.

use super::*;
use faer::Mat;
use lieflow::methods::magnus::{Magnus4, Magnus6};
use lieflow::problems::{
    amplitudes, density_matrix, populations, populations_of, schrodinger, von_neumann,
};

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

/// A mixture of two states is at each time the mixture of these states, and its eigenvalues are the weights.
#[test]
fn a_mixture_moves_as_its_states() {
    let field = |t: f64, i: usize, j: usize| match (i, j) {
        (0, 1) => [0.7 * t.cos(), 0.4 * (2.0 * t).sin()],
        (1, 2) => [0.2, -0.9 * t],
        _ => [[0.3, -0.1, 0.5][i] * f64::from(u8::from(i == j)), 0.0],
    };
    let (pure, mixed) = (schrodinger(3, field).unwrap(), von_neumann(3, field).unwrap());
    let (a, b) = ([[0.6, 0.0], [0.0, 0.8], [0.0, 0.0]], [[0.0, 0.8], [0.6, 0.0], [0.0, 0.0]]);
    let weights = [0.7, 0.3];
    // ρ_ij = Σ w ψ_i ψ̄_j; `a` and `b` are at right angles.
    let mixture = |states: [&Mat<f64>; 2], i: usize, j: usize| {
        let term = |psi: &Mat<f64>| {
            let [re, im] = [0, 3].map(|part| move |i: usize| psi[(part + i, 0)]);
            [re(i) * re(j) + im(i) * im(j), im(i) * re(j) - re(i) * im(j)]
        };
        let [a, b] = states.map(term);
        [0, 1].map(|part| weights[0] * a[part] + weights[1] * b[part])
    };
    let states = [a, b].map(|psi| amplitudes(&psi).unwrap());
    let start = density_matrix(3, |i, j| mixture([&states[0], &states[1]], i, j)).unwrap();
    let end = run(&mixed, &Magnus6, 2.0, 40, &start);
    let moved = states.map(|psi| run(&pure, &Magnus6, 2.0, 40, &psi));
    let expected = density_matrix(3, |i, j| mixture([&moved[0], &moved[1]], i, j)).unwrap();
    assert!((&end - &expected).norm_l2() < 1e-13, "{:e}", (&end - &expected).norm_l2());
    assert!((&end - &start).norm_l2() > 0.1);
    assert!((populations_of(&end).iter().sum::<f64>() - 1.0).abs() < 1e-14);
    let spectrum = lieflow::dense::symmetric_eigenvalues(end.as_ref()).unwrap();
    for (found, weight) in spectrum.iter().zip([0.0, 0.0, 0.3, 0.3, 0.7, 0.7]) {
        assert!((found - weight).abs() < 1e-14, "{spectrum:?}");
    }
}

#[test]
fn what_is_no_density_matrix_is_refused() {
    let of = |rows: [[f64; 2]; 2]| density_matrix(2, move |i, j| [rows[i][j], 0.0]);
    assert!(of([[2.0, 0.5], [0.5, 6.0]]).is_ok_and(|rho| rho[(1, 1)] == 0.75));
    for (rows, why) in [
        ([[1.0, 2.0], [2.0, 1.0]], "the least eigenvalue"),
        ([[1.0, 0.0], [0.0, -1.0]], "tr ρ"),
        ([[1.0, f64::NAN], [f64::NAN, 1.0]], "the least eigenvalue"),
        ([[f64::INFINITY, 0.0], [0.0, 1.0]], "tr ρ"),
    ] {
        let message = of(rows).unwrap_err().to_string();
        assert!(message.contains(why), "{message}");
    }
    assert!(
        density_matrix(0, |_, _| [0.0; 2]).is_err() && von_neumann(0, |_, _, _| [0.0; 2]).is_err()
    );
}

/// The driver takes ρ back to its length: an H that does not change has the same rounding in each of 20 000 steps.
#[test]
fn a_density_matrix_stays_as_mixed_as_it_was() {
    let field = |_: f64, i: usize, j: usize| if i == j { [0.0, 0.0] } else { [0.4, -0.3] };
    let mixed = von_neumann(3, field).unwrap();
    let weights = [0.7, 0.2, 0.1];
    let start = density_matrix(3, |i, j| [if i == j { weights[i] } else { 0.0 }, 0.0]).unwrap();
    let solve = lieflow::Solve::new(&mixed, &Magnus4, [0.0, 1000.0]).steps(20_000);
    let end = solve.run(start.clone()).unwrap();
    let purity = |rho: &Mat<f64>| 0.5 * rho.squared_norm_l2();
    let drift = purity(&end.y) - purity(&start);
    assert!(drift.abs() < 30.0 * EPS, "{drift:e}");
    assert!(end.stats.residual > 0.0 && end.stats.residual < 1e-13, "{:?}", end.stats);
}
