//! Zeitlin's fluids: Laplacians and harmonics, exact flows, invariants, orders, hard input.

use core::f64::consts::PI;

use faer::{Mat, c64};
use lieflow::groups::{ComplexMatrix, LieAlgebra, Sample, Unitary};
use lieflow::maps::{Cay, Exp};
use lieflow::methods::FluidMidpoint;
use lieflow::methods::{Composition, EnergyCasimir, Metric, Rkmk, SUZUKI4, tableau::DOPRI5};
use lieflow::problems::FieldStore;
use lieflow::problems::{Invariants, LinearSpace, Sphere, Surface, Vortex, Zeitlin};
use lieflow::{Error, Method, Problem, SaveAt, Step, StepError, TimeGrid, integrate};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::support::references::{Case, cases, square};

const EPS: f64 = f64::EPSILON;

fn rng(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

/// W after so many steps of size h.
fn run<P, M: Method<P>>(
    fluid: &P,
    method: &M,
    w: &ComplexMatrix,
    h: f64,
    steps: u64,
) -> ComplexMatrix
where
    P: Problem<Group = Unitary>,
    P::Action: lieflow::Action<Unitary, Point = ComplexMatrix>,
{
    let mut w = w.clone();
    let grid = TimeGrid::with_steps([0.0, h * steps as f64], steps).expect("a grid");
    integrate(fluid, method, &grid, &SaveAt::Ends, &mut w, |_, _| {}).expect("a run");
    w
}

/// The matrix T_lm.
fn harmonic(fluid: &Zeitlin<Sphere>, l: usize, m: isize) -> ComplexMatrix {
    let mut omega = vec![0.0; (l + 1) * (l + 1)];
    omega[(l * l + l).wrapping_add_signed(m)] = 1.0;
    fluid.from_coefficients(&omega).expect("a harmonic")
}

#[test]
fn the_laplacian_is_that_of_the_spins_and_has_the_eigenvalues_of_the_sphere() {
    for n in [2, 3, 5, 8, 33] {
        let (fluid, group) =
            (Zeitlin::sphere(n).expect("a sphere"), Unitary::new(n).expect("U(n)"));
        let p = group.sample_algebra(&mut rng(n as u64), 1.0);
        // Σ_a [iJ_a, [iJ_a, P]]
        let (mut sum, mut inner, mut outer) = (group.zero(), group.zero(), group.zero());
        for axis in 0..3 {
            let spin = fluid.surface().spin(axis);
            group.bracket(&spin, &p, &mut inner);
            group.bracket(&spin, &inner, &mut outer);
            sum.add(1.0, &outer);
        }
        let w = fluid.surface().laplacian(&p);
        let size = (n * n) as f64 * p.size();
        assert!(w.distance(&sum) <= 8.0 * EPS * size, "N = {n}: {}", w.distance(&sum));
        for l in 0..n {
            for m in [0, l as isize, -(l as isize), (l / 2) as isize] {
                let t = harmonic(&fluid, l, m);
                let mut gap = fluid.surface().laplacian(&t);
                gap.add((l * (l + 1)) as f64, &t);
                assert!(
                    gap.size() <= 16.0 * EPS * (n * n) as f64 * t.size(),
                    "{n} {l} {m}: {}",
                    gap.size()
                );
                assert!((fluid.inner(&t, &t) - 1.0).abs() < 1e-14);
            }
        }
    }
}

#[test]
fn the_poisson_solve_inverts_the_laplacian_to_a_few_units() {
    for n in [2, 3, 4, 9, 16, 64, 201] {
        let fluid = Zeitlin::sphere(n).expect("a sphere");
        let mut w = Unitary::new(n).expect("U(n)").sample_algebra(&mut rng(3), 1.0);
        let mean = (0..n).map(|i| w.im[(i, i)]).sum::<f64>() / n as f64;
        (0..n).for_each(|i| w.im[(i, i)] -= mean);
        let p = fluid.stream(&w);
        assert!(p.skew_residual() == 0.0);
        let back = fluid.surface().laplacian(&p);
        // Δ itself loses ‖Δ‖·ε.
        assert!(back.distance(&w) <= EPS * (n * n) as f64 * w.size(), "N = {n}");
        for l in [1, n / 2, n - 1] {
            for m in [0, 1, l as isize, -(l as isize)] {
                let (t, eigenvalue) = (harmonic(&fluid, l, m), (l * (l + 1)) as f64);
                let mut gap = fluid.stream(&t);
                gap.add(1.0 / eigenvalue, &t);
                // T_lm is an eigenvector to ε‖Δ‖ over the gap to its neighbours, 2l.
                let bound = 8.0 * EPS * ((n * n) as f64 / (2 * l) as f64).max(4.0);
                let error = gap.size() * eigenvalue / t.size();
                assert!(error <= bound, "N = {n}, l = {l}, m = {m}: {error:.1e}");
            }
        }
    }
}

#[test]
fn coefficients_and_values_are_those_of_the_harmonics() {
    let fluid = Zeitlin::sphere(12).expect("a sphere");
    let hbar = fluid.hbar();
    // T_11 = √3 X, T_1,−1 = √3 Y, T_10 = √3 Z with X_a = ħ iJ_a.
    for (m, axis) in [(1, 0), (-1, 1), (0, 2)] {
        let mut gap = harmonic(&fluid, 1, m);
        gap.add(-(3f64.sqrt()) * hbar, &fluid.surface().spin(axis));
        assert!(gap.size() < 1e-14, "{m}: {}", gap.size());
    }
    let omega: Vec<f64> = (0..144).map(|k| ((k * k + 1) as f64).sin()).collect();
    let w = fluid.from_coefficients(&omega).expect("a vorticity");
    assert!(w.skew_residual() < 1e-15);
    for (a, b) in fluid.coefficients(&w, 12).iter().zip(&omega) {
        assert!((a - b).abs() < 1e-13);
    }
    // Y_20 = √5(3z² − 1)/2 and Y_2,−2 = √15 xy.
    let (latitude, longitude) = (0.3f64, 1.1f64);
    let z = latitude.sin();
    let (x, y) = (latitude.cos() * longitude.cos(), latitude.cos() * longitude.sin());
    let at = |l, m| fluid.at(&harmonic(&fluid, l, m), latitude, longitude);
    assert!((at(2, 0) - 5f64.sqrt() * (3.0 * z * z - 1.0) / 2.0).abs() < 1e-14);
    assert!((at(2, -2) - 15f64.sqrt() * x * y).abs() < 1e-14);
    // Row 0 is the north, column 0 the west; the rows weighted by their cosines have the mean ω_00.
    let grid = fluid.on_grid(&w, 90, 180);
    let place = |i: usize, j: usize| {
        let (i, j) = (i as f64 + 0.5, j as f64 + 0.5);
        ((90.0 - 2.0 * i).to_radians(), (2.0 * j - 180.0).to_radians())
    };
    for (i, j) in [(0, 0), (10, 100), (89, 179)] {
        let (latitude, longitude) = place(i, j);
        assert!((grid[(i, j)] - fluid.at(&w, latitude, longitude)).abs() < 1e-12);
    }
}

#[test]
fn brackets_become_poisson_brackets() {
    // {f(z), g} = f'(z) ∂g/∂φ: {Y_20, Y_32} = −6√5 z Y_3,−2, and z Y_lm = c_{l+1} Y_{l+1,m} + c_l Y_{l−1,m}.
    let c = |l: f64| ((l * l - 4.0) / (4.0 * l * l - 1.0)).sqrt();
    let mut last = f64::INFINITY;
    for n in [16, 32, 64] {
        let (fluid, group) =
            (Zeitlin::sphere(n).expect("a sphere"), Unitary::new(n).expect("U(n)"));
        let mut bracket = group.zero();
        group.bracket(&harmonic(&fluid, 2, 0), &harmonic(&fluid, 3, 2), &mut bracket);
        let mut exact = group.zero();
        exact.add(-6.0 * 5f64.sqrt() * c(4.0) * fluid.hbar(), &harmonic(&fluid, 4, -2));
        exact.add(-6.0 * 5f64.sqrt() * c(3.0) * fluid.hbar(), &harmonic(&fluid, 2, -2));
        let error = bracket.distance(&exact) / exact.size();
        assert!(error < 20.0 / (n * n) as f64, "N = {n}: {error}");
        assert!(error < last / 3.8, "order 2 in 1/N");
        last = error;
    }
}

#[test]
fn jets_are_stationary_and_a_vortex_is_where_it_was_put() {
    let fluid = Zeitlin::sphere(20).expect("a sphere");
    let jets = fluid.jets(&[(1, 0.3), (3, 1.0), (6, -0.5)]).expect("jets");
    let end = run(&fluid, &FluidMidpoint::isospectral(), &jets, 0.1, 20);
    assert!(end.distance(&jets) < 1e-14 * jets.size());

    let (latitude, longitude) = (0.7, -2.0);
    let one = Vortex { latitude, longitude, circulation: 3.0, width: 0.3 };
    let w = fluid.vortices(&[one]).expect("a vortex");
    let peak = fluid.at(&w, latitude, longitude);
    // Γ/(2πσ²) less the mean, on a plane.
    assert!((peak - 3.0 / (2.0 * PI * 0.09)).abs() < 0.1 * peak, "{peak}");
    for (a, b) in [(0.1, 0.0), (-0.1, 0.0), (0.0, 0.1), (0.0, -0.1)] {
        assert!(fluid.at(&w, latitude + a, longitude + b) < peak);
    }
    // Alone it stays; its axis is that of its angular momentum.
    let end = run(&fluid, &FluidMidpoint::energy(), &w, 0.05, 20);
    assert!(end.distance(&w) < 1e-12 * w.size());
    let [x, y, z] = fluid.surface().angular_momentum(&w);
    assert!(
        (z.atan2(x.hypot(y)) - latitude).abs() < 1e-12 && (y.atan2(x) - longitude).abs() < 1e-12
    );
}

#[test]
fn rossby_haurwitz_waves_turn_at_their_speed() {
    // On a solid rotation Ω a wave of one degree l turns eastward by Ω(1 − 2/(l(l+1))).
    let (n, rate, l, m, a, t) = (12, 1.5, 4, 3, 0.4, 0.8);
    let fluid = Zeitlin::sphere(n).expect("a sphere");
    let mut w = fluid.jets(&[(1, 2.0 * rate / 3f64.sqrt())]).expect("a rotation");
    w.add(a, &harmonic(&fluid, l, m));
    let turned = m as f64 * rate * (1.0 - 2.0 / (l * (l + 1)) as f64) * t;
    let at = |m: isize| l * l + (l as isize + m) as usize;
    let error = |end: &ComplexMatrix| {
        let omega = fluid.coefficients(end, n);
        (omega[at(m)] - a * turned.cos()).hypot(omega[at(-m)] - a * turned.sin())
    };
    let fine = run(&fluid, &Rkmk::new(DOPRI5, Exp), &w, t / 200.0, 200);
    assert!(error(&fine) < 1e-11, "{}", error(&fine));
    let [coarse, fine] = [200, 400].map(|steps| {
        error(&run(&fluid, &FluidMidpoint::isospectral(), &w, t / steps as f64, steps))
    });
    assert!(coarse < 1e-3 && (coarse / fine - 4.0).abs() < 0.1, "{coarse:.1e} {fine:.1e}");
}

#[test]
fn what_is_promised_is_kept() {
    let fluid = Zeitlin::sphere(32).expect("a sphere");
    let w = fluid.random(&mut rng(1), 10).expect("a field");
    let (levels, start) = (fluid.spectrum(&w).expect("levels"), fluid.values(&w));
    let h = 0.25 * fluid.hbar();
    let steps = 200;
    // A step rounds W once; 200 of them as a walk, eigenvalues and means of powers alike.
    let rounding = 16.0 * EPS * (steps as f64).sqrt();
    for method in [FluidMidpoint::isospectral(), FluidMidpoint::energy()] {
        let end = run(&fluid, &method, &w, h, steps);
        assert!(end.distance(&w) > 0.01 * w.size(), "it moves");
        assert!(end.skew_residual() == 0.0);
        let now = fluid.spectrum(&end).expect("levels");
        let gap = now.iter().zip(&levels).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(gap < rounding * levels[31].abs(), "the spectrum: {gap:.1e}");
        let values = fluid.values(&end);
        let drift = |k: usize| (values[k] - start[k]).abs();
        assert!((1..4).all(|k| drift(k) < rounding), "Casimirs");
        match method == FluidMidpoint::energy() {
            true => assert!(drift(0) < rounding * start[0], "the energy: {:.1e}", drift(0)),
            false => {
                assert!(drift(0) > 1e-9 && drift(0) < 1e-3 * start[0]);
                assert!((4..7).all(|k| drift(k) < rounding), "angular momentum");
            }
        }
    }
}

#[test]
fn long_runs_with_large_steps_keep_their_promises() {
    // Slow and irregular contraction: h/ħ ≈ ½, narrow vortices.
    let fluid = Zeitlin::sphere(24).expect("a sphere");
    let vortex = |k: f64| Vortex {
        latitude: 0.7 * (2.0 * k).sin(),
        longitude: 2.5 * k,
        circulation: if k > 3.0 { -2.0 } else { 1.0 },
        width: 0.2,
    };
    let w = fluid.vortices(&[0.0, 1.0, 2.0, 3.0, 4.0].map(vortex)).expect("vortices");
    let levels = fluid.spectrum(&w).expect("levels");
    let steps = 600;
    for method in [FluidMidpoint::isospectral(), FluidMidpoint::energy()] {
        let end = run(&fluid, &method, &w, 0.04, steps);
        let now = fluid.spectrum(&end).expect("levels");
        let gap = now.iter().zip(&levels).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Each step may leave its tolerance, ε/8·‖W‖, always to the same side.
        let bound = 0.25 * EPS * steps as f64 * w.size();
        assert!(gap < bound, "{method:?}: {gap:.1e} > {bound:.1e}");
    }
}

#[test]
fn the_energy_midpoint_is_the_general_method_with_cay_and_both_have_order_2() {
    let fluid = Zeitlin::sphere(9).expect("a sphere");
    let w = fluid.random(&mut rng(2), 6).expect("a field");
    let ours = run(&fluid, &FluidMidpoint::energy(), &w, 0.05, 20);
    let general = run(&fluid, &EnergyCasimir::new(Cay), &w, 0.05, 20);
    assert!(ours.distance(&general) < 64.0 * EPS * 20.0 * w.size(), "{}", ours.distance(&general));

    let exact = run(&fluid, &Rkmk::new(DOPRI5, Exp), &w, 0.005, 200);
    assert!(exact.distance(&run(&fluid, &Rkmk::new(DOPRI5, Cay), &w, 0.005, 200)) < 1e-11);
    let errors = |run: &dyn Fn(f64, u64) -> ComplexMatrix| -> Vec<f64> {
        [10, 20, 40, 80].map(|n| run(1.0 / n as f64, n).distance(&exact)).into()
    };
    let slopes = |e: Vec<f64>| e.windows(2).map(|e| (e[0] / e[1]).log2()).collect::<Vec<_>>();
    for method in [FluidMidpoint::isospectral(), FluidMidpoint::energy()] {
        let s = slopes(errors(&|h, n| run(&fluid, &method, &w, h, n)));
        assert!(s.iter().all(|s| (s - 2.0).abs() < 0.1), "{method:?}: {s:?}");
        let composed = Composition::new(method, SUZUKI4);
        let s = slopes(errors(&|h, n| run(&fluid, &composed, &w, h, n)));
        assert!(s.iter().all(|s| (s - 4.0).abs() < 0.1), "composed {method:?}: {s:?}");
    }
}

#[test]
fn the_history_changes_nothing_but_the_cost() {
    let fluid = Zeitlin::sphere(24).expect("a sphere");
    let w = fluid.random(&mut rng(4), 8).expect("a field");
    let h = 0.02;
    let method = FluidMidpoint::isospectral();
    let step = |n, h, y: &mut ComplexMatrix, work: &mut _| {
        method.step(&fluid, Step { n, t: 0.0, h }, y, work).expect("a step");
    };
    let mut work = method.work(&fluid, &w).expect("a workspace");
    let (mut warm, mut cold, mut aside) = (w.clone(), w.clone(), w.clone());
    let mut other = method.work(&fluid, &w).expect("a workspace");
    let mut without = 0;
    for n in 0..20 {
        step(n, h, &mut warm, &mut work);
        let mut new = method.work(&fluid, &w).expect("a workspace");
        step(n, h, &mut cold, &mut new);
        without += new.iterations()[0];
        // Steps to outputs in between leave the run as it is, bit for bit.
        step(n, 0.3 * h, &mut aside.clone(), &mut other);
        step(n, h, &mut aside, &mut other);
    }
    assert!(aside == warm);
    assert!(warm.distance(&cold) < 16.0 * EPS * 20.0 * w.size());
    let [with, _] = work.iterations();
    assert!(4 * with < 3 * without, "{with} iterations in place of {without}");
    // A used workspace, elsewhere: as a new one.
    let mut again = w.clone();
    step(0, h, &mut again, &mut work);
    let mut first = w.clone();
    step(0, h, &mut first, &mut method.work(&fluid, &w).expect("a workspace"));
    assert!(again == first);
}

#[test]
fn wrong_input_is_refused_by_name() {
    for n in [0, 1, 100_000] {
        assert!(matches!(Zeitlin::sphere(n), Err(Error::OutOfRange { ref arg, .. }) if arg == "N"));
    }
    let fluid = Zeitlin::sphere(6).expect("a sphere");
    let good = fluid.random(&mut rng(1), 4).expect("a field");
    let grid = TimeGrid::with_steps([0.0, 1.0], 10).expect("a grid");
    let attempt = |w: &ComplexMatrix| {
        let method = FluidMidpoint::isospectral();
        integrate(&fluid, &method, &grid, &SaveAt::Ends, &mut w.clone(), |_, _| {})
    };
    assert!(attempt(&good).is_ok());
    let mut hermitian = good.clone();
    hermitian.re[(1, 2)] += 0.1;
    assert!(matches!(
        fluid.vorticity(hermitian.clone()),
        Err(Error::NotInAlgebra { arg: "W", .. })
    ));
    assert!(attempt(&hermitian).is_err());
    let mut nan = good.clone();
    nan.im[(3, 3)] = f64::NAN;
    assert!(matches!(
        fluid.vorticity(nan.clone()),
        Err(Error::NotFiniteEntry { arg: "W", row: 3, col: 3, .. })
    ));
    assert!(attempt(&nan).is_err());
    let small = ComplexMatrix::zeros(5, 5);
    assert!(matches!(fluid.vorticity(small.clone()), Err(Error::Shape { arg: "W", rows: 5, .. })));
    assert!(attempt(&small).is_err());
    assert!(fluid.random(&mut rng(1), 7).is_err() && fluid.random(&mut rng(1), 1).is_err());
    assert!(fluid.jets(&[(6, 1.0)]).is_err() && fluid.jets(&[(0, 1.0)]).is_err());
    assert!(fluid.jets(&[(2, f64::NAN)]).is_err());
    assert!(fluid.from_coefficients(&[0.0; 5]).is_err());
    let vortex = Vortex { latitude: 0.0, longitude: 0.0, circulation: 1.0, width: 0.0 };
    assert!(fluid.vortices(&[vortex]).is_err());
    assert!(FluidMidpoint::energy().with_tolerance(0.0).is_err());
    // A step beyond the reach of the iteration.
    let mut work = FluidMidpoint::energy().work(&fluid, &good).expect("a workspace");
    let mut y = good.clone();
    let failed =
        FluidMidpoint::energy().step(&fluid, Step { n: 0, t: 0.0, h: 50.0 }, &mut y, &mut work);
    assert!(matches!(failed, Err(StepError::FixedPointDidNotConverge { .. })), "{failed:?}");
    assert!(y == good, "y is as it was");
}

/// ω̇_k of the sine–Euler equations by their sum over the pairs m + n = k, all modulo N.
fn sine_euler(n: i64, omega: &dyn Fn([i64; 2]) -> c64) -> Vec<([i64; 2], c64)> {
    let k = (n - 1) / 2;
    let range = || (-k..=k).flat_map(|a| (-k..=k).map(move |b| [a, b]));
    let mut rates = Vec::new();
    for target in range() {
        let mut sum = c64::new(0.0, 0.0);
        for m in range().filter(|m| *m != [0, 0]) {
            // T_{m+n} with m + n beyond the range is ±T_k: the sign of e^{iπ(...)}.
            let other = [0, 1].map(|i| (target[i] - m[i] + k).rem_euclid(n) - k);
            let wrapped = [0, 1].map(|i| (m[i] + other[i] - target[i]) / n);
            let (s, t) = (m, other);
            let sign = wrapped[0] * (target[1]) + wrapped[1] * target[0] + wrapped[0] * wrapped[1];
            let sign = if sign.rem_euclid(2) == 0 { 1.0 } else { -1.0 };
            let angle = PI * ((s[0] * t[1] - s[1] * t[0]) as f64) / n as f64;
            let psi = omega(m) * (-1.0 / (m[0] * m[0] + m[1] * m[1]) as f64);
            sum += psi * omega(other) * (sign * n as f64 / PI * angle.sin());
        }
        rates.push((target, sum));
    }
    rates
}

#[test]
fn the_torus_is_the_sine_euler_equations() {
    let n = 7usize;
    let fluid = Zeitlin::torus(n).expect("a torus");
    let w = fluid.random(&mut rng(5), 4).expect("a field");
    assert!(w.skew_residual() == 0.0 && (fluid.enstrophy(&w) - 0.5).abs() < 1e-14);
    let k = 3;
    let modes = fluid.modes(&w);
    let omega = |m: [i64; 2]| modes[((m[0] + k) as usize, (m[1] + k) as usize)];
    let (mut dw, mut store) = (fluid.group().zero(), FieldStore::new(&fluid));
    fluid.field(0.0, &w, &mut dw, &mut store);
    let rates = fluid.modes(&dw);
    for (m, exact) in sine_euler(n as i64, &omega) {
        let ours = rates[((m[0] + k) as usize, (m[1] + k) as usize)];
        assert!((ours - exact).norm() < 1e-13, "{m:?}: {ours} {exact}");
    }
    // One shell is stationary, and a grid shows the function.
    let shell = fluid.from_modes(&[([2, 1], [0.3, 0.1]), ([-1, 2], [0.0, 0.7])]).expect("modes");
    let end = run(&fluid, &FluidMidpoint::energy(), &shell, 0.1, 10);
    assert!(end.distance(&shell) < 1e-13 * shell.size(), "{}", end.distance(&shell));
    let grid = fluid.on_grid(&shell, 10, 20);
    let (x, y) = (2.0 * PI * 3.5 / 20.0, 2.0 * PI * (1.0 - 4.5 / 10.0));
    let exact = 0.3 * (2.0 * x + y).cos() + 0.1 * (2.0 * x + y).sin() + 0.7 * (2.0 * y - x).sin();
    assert!((grid[(4, 3)] - exact).abs() < 1e-13);
}

#[test]
fn the_torus_keeps_what_it_promises_and_shear_carries_waves() {
    let fluid = Zeitlin::torus(31).expect("a torus");
    let w = fluid.random(&mut rng(6), 5).expect("a field");
    let (levels, start) = (fluid.spectrum(&w).expect("levels"), fluid.values(&w));
    let end = run(&fluid, &FluidMidpoint::energy(), &w, 0.05, 40);
    assert!(end.distance(&w) > 0.01 * w.size());
    for (a, b) in fluid.spectrum(&end).expect("levels").iter().zip(&levels) {
        assert!((a - b).abs() < 1e-13);
    }
    for (a, b) in fluid.values(&end).iter().zip(&start) {
        assert!((a - b).abs() < 1e-13);
    }
    // ψ = −sin y: u = (cos y, 0), which carries a faint vortex to +x at y = 0 and to −x at y = π.
    let shear = fluid.from_modes(&[([0, 1], [0.0, 1.0])]).expect("a shear");
    let row = |w: &ComplexMatrix, y: f64| -> f64 {
        // The phase of the first wave along the line.
        let modes = fluid.modes(w);
        (0..31)
            .map(|l| modes[(16, l)] * c64::new(0.0, (l as f64 - 15.0) * y).exp())
            .sum::<c64>()
            .arg()
    };
    for (y, direction) in [(0.0, 1.0), (PI, -1.0)] {
        let mut w = shear.clone();
        w.add(1.0, &fluid.vortices(&[([2.0, y], 1e-6, 0.4)]).expect("a vortex"));
        assert!((row(&w, y) + 2.0).abs() < 1e-9, "it is at x = 2");
        let end = run(&fluid, &FluidMidpoint::energy(), &w, 0.001, 10);
        // The shear's own curvature carries back some of it.
        let moved = -(row(&end, y) - row(&w, y)) * direction / 0.01;
        assert!(moved > 0.5 && moved < 1.0, "y = {y}: {moved}");
    }
    assert!(Zeitlin::torus(4).is_err() && Zeitlin::torus(1).is_err());
    assert!(fluid.from_modes(&[([16, 0], [1.0, 0.0])]).is_err());
    assert!(fluid.from_modes(&[([1, 0], [f64::NAN, 0.0])]).is_err());
    assert!(fluid.vortices(&[([0.0, 0.0], 1.0, -1.0)]).is_err());
}

/// Each function of a fluid at a reference, within 8 ε·size.
fn check<S: Surface>(case: &Case, fluid: &Zeitlin<S>) {
    let matrix = |x: Mat<c64>| ComplexMatrix::from_fn(case.n, case.n, |i, j| x[(i, j)]);
    let w = fluid.vorticity(matrix(case.complex("w"))).expect("a vorticity");
    let h = case.numbers("h")[0];
    let near = |what: &str, ours: &ComplexMatrix, size: f64| {
        let exact = matrix(square(case.n, &case.output[what].complex()));
        let (error, bound) = (ours.distance(&exact), 8.0 * EPS * size);
        assert!(error <= bound, "{} {what}: {error:.1e} > {bound:.1e}", case.id);
    };
    near("p", &fluid.stream(&w), w.size());
    let mut dw = ComplexMatrix::zeros(case.n, case.n);
    fluid.field(0.0, &w, &mut dw, &mut FieldStore::new(fluid));
    near("dw", &dw, w.size() * w.size() / fluid.hbar());
    let step = |method| run(fluid, &method, &w, h, 1);
    near("isospectral", &step(FluidMidpoint::isospectral()), 2.0 * w.size());
    near("energy", &step(FluidMidpoint::energy()), 2.0 * w.size());
}

#[test]
fn references_of_34_digits() {
    let (mut fluids, mut diagonals) = (0, 0);
    for case in &cases("fluids") {
        if case.has("w") {
            match case.id.as_str() {
                "sphere" => check(case, &Zeitlin::sphere(case.n).expect("a sphere")),
                _ => check(case, &Zeitlin::torus(case.n).expect("a torus")),
            }
            fluids += 1;
            continue;
        }
        let fluid = Zeitlin::sphere(case.n).expect("a sphere");
        let [l, m] = ["l", "m"].map(|name| case.numbers(name)[0] as usize);
        let t = harmonic(&fluid, l, m as isize);
        let scale = if m == 0 { 1.0 } else { 2f64.sqrt() };
        for (i, v) in case.output["diagonal"].numbers().iter().enumerate() {
            let error = scale * t.im[(i, i + m)] - v;
            assert!(error.abs() <= 16.0 * EPS, "l = {l}, m = {m}: {error:.1e}");
        }
        diagonals += 1;
    }
    assert_eq!((fluids, diagonals), (3, 45));
}
