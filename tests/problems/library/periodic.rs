//! Linear Hamiltonian systems: Mathieu's characteristic values, Hill's multipliers, beam lines, and
//! Riccati's equation.

use super::*;
use faer::{Mat, mat};
use lieflow::actions::Lagrangian;
use lieflow::floquet::{Floquet, Stability, monodromy};
use lieflow::groups::{AlgebraMatrix, GroupMatrix, LieGroup, MatrixGroup};
use lieflow::methods::magnus::{Magnus4, Magnus6, Magnus8};
use lieflow::problems::beam::{Element, transfer_map, tunes};
use lieflow::problems::{Flow, hill, mathieu};
use lieflow::{RunError, StepError};

const PI: f64 = core::f64::consts::PI;

fn trace(g: &GroupMatrix) -> f64 {
    (0..g.nrows()).map(|i| g[(i, i)]).sum()
}

/// At its characteristic values for q = 1 (DLMF 28.2; eigenvalues of the recurrence, 25 digits)
/// Mathieu's equation has a solution of period π or 2π: tr M = ±2.
#[test]
fn mathieus_characteristic_values() {
    for (a, expected) in [
        (-0.4551386041074135482326332, 2.0), // a₀
        (-0.1102488169920951699065, -2.0),   // b₁
        (1.859108072514363472329918, -2.0),  // a₁
        (3.917024772998471186703417, 2.0),   // b₂
    ] {
        let m = monodromy(&mathieu(a, 1.0).unwrap(), &Magnus8, [0.0, PI], 60).unwrap();
        assert!((trace(&m) - expected).abs() < 1e-10, "a = {a}: {}", trace(&m));
        // Next to it one side is stable, the other not.
        let radius = |a: f64| {
            let m = monodromy(&mathieu(a, 1.0).unwrap(), &Magnus6, [0.0, PI], 60).unwrap();
            Floquet::of(&m).unwrap().spectral_radius()
        };
        let (below, above) = (radius(a - 1e-3), radius(a + 1e-3));
        assert!(below.min(above) < 1.0 + 1e-12 && below.max(above) > 1.01, "{below} {above}");
    }
}

/// Without modulation the multipliers are e^{±iωT}; with it they come in pairs λ, 1/λ.
#[test]
fn hills_multipliers() {
    let plain = monodromy(&mathieu(2.0, 0.0).unwrap(), &Magnus4, [0.0, PI], 4).unwrap();
    let [re, im] = Floquet::of(&plain).unwrap().multipliers[0];
    let phase = 2f64.sqrt() * PI;
    assert!((re - phase.cos()).abs() < 1e-13 && (im.abs() - phase.sin().abs()).abs() < 1e-13);

    let stiffness = |t: f64, i: usize, j: usize| match i == j {
        true => 1.0 + i as f64 + 0.8 * (2.0 * t).cos(),
        false => 0.3 * (2.0 * t).sin(),
    };
    let m = monodromy(&hill(2, stiffness).unwrap(), &Magnus6, [0.0, PI], 100).unwrap();
    let sp = MatrixGroup::sp(4).unwrap();
    assert!(sp.defect(&m) < 1e-13 * m.norm_l2().powi(2), "{:e}", sp.defect(&m));
    let multipliers = Floquet::of(&m).unwrap().multipliers;
    let product = multipliers
        .iter()
        .fold([1.0, 0.0], |[a, b]: [f64; 2], [c, d]| [a * c - b * d, a * d + b * c]);
    assert!((product[0] - 1.0).abs() + product[1].abs() < 1e-11);
    for [re, im] in &multipliers {
        let square = re * re + im * im;
        let inverse = [re / square, -im / square];
        let near = multipliers.iter().map(|z| (z[0] - inverse[0]).hypot(z[1] - inverse[1]));
        assert!(near.fold(f64::INFINITY, f64::min) < 1e-10);
    }
    // The same by steps of another method.
    let rkmk = Rkmk::new(RK4, Cay);
    let again = monodromy(&hill(2, stiffness).unwrap(), &rkmk, [0.0, PI], 1000).unwrap();
    assert!((&*again - &*m).norm_l2() < 1e-9);
    assert!(hill(0, stiffness).is_err() && mathieu(f64::NAN, 1.0).is_err());
}

/// Near tr M = ±2 the growth has the digits of M ∓ 𝟙. References: Taylor series of degree 50 with 40 digits.
#[test]
fn weak_instability() {
    for (a, q, growth) in [
        (4.0, 1e-4, 1.463503068931247e-9),
        (4.0, 1e-3, 1.4635030654096912e-7),
        (1.0, 1e-6, 1.5707963267947125e-6),
        (9.0, 1e-2, 0.0),
        (9.0, 1e-3, 0.0),
    ] {
        let m = monodromy(&mathieu(a, q).unwrap(), &Magnus6, [0.0, PI], 1000).unwrap();
        let found = Stability::of(&m, 1e-13).unwrap();
        assert!((found.growth - growth).abs() <= 1e-4 * growth, "a = {a}, q = {q}: {found:?}");
        assert_eq!(found.is_bounded, growth == 0.0, "a = {a}, q = {q}");
    }
}

/// Where multipliers meet, powers of M decide: a double one with one vector lets solutions grow with the periods.
#[test]
fn multipliers_that_meet() {
    let stability = |m: Mat<f64>| Stability::of(&m, 1e-13).unwrap();
    // Two oscillators with the frequencies x and y, or a free mass where one is 0.
    let two = |x: f64, y: f64, shear: f64| {
        Mat::from_fn(4, 4, |i, j| {
            let w = [x, y][i % 2];
            match (i / 2, j / 2) {
                _ if i % 2 != j % 2 => 0.0,
                (0, 1) if w == 0.0 => shear,
                (0, 1) => w.sin(),
                (1, 0) => -w.sin(),
                _ => w.cos(),
            }
        })
    };
    for (m, growth, is_bounded) in [
        (mat![[1.0, 0.3], [0.0, 1.0]], 0.0, false),
        (mat![[-1.0, 0.0], [0.0, -1.0]], 0.0, true),
        (mat![[-1.0, 1e-15], [1e-15, -1.0]], 0.0, true),
        (two(1.0, 1.0, 0.0), 0.0, true),
        (two(0.0, 1.0, 1.0), 0.0, false),
        (two(0.0, 1.0, 1e-5), 0.0, false),
        (mat![[2.0, 0.0], [0.0, 0.5]], 2f64.ln(), false),
        (mat![[1e200, 0.0], [0.0, 1e-200]], 1e200f64.ln(), false),
    ] {
        let found = stability(m.clone());
        let is_right = (found.growth - growth).abs() < 1e-12 && found.is_bounded == is_bounded;
        assert!(is_right, "{m:?}: {found:?}");
    }
    // An oscillator beside a mode that grows by 10⁻⁷ a period.
    let slow = 1e-7f64;
    let mut m = two(1.0, 1.0, 0.0);
    for (i, j, x) in
        [(1, 1, slow.cosh()), (1, 3, slow.sinh()), (3, 1, slow.sinh()), (3, 3, slow.cosh())]
    {
        m[(i, j)] = x;
    }
    let found = stability(m);
    assert!((found.growth - slow).abs() < 1e-3 * slow && !found.is_bounded, "{found:?}");
    assert!(Stability::of(&mat![[f64::NAN, 0.0], [0.0, 1.0]], 0.0).is_err());
}

/// M of these 2×2 blocks on (x₁, …, x_m, ẋ₁, …, ẋ_m), in a basis that mixes them.
fn of_blocks(blocks: &[[[f64; 2]; 2]]) -> Mat<f64> {
    let m = blocks.len();
    let plain = Mat::from_fn(2 * m, 2 * m, |i, j| match i % m == j % m {
        true => blocks[i % m][i / m][j / m],
        false => 0.0,
    });
    // A reflection in a vector that has no zeros: orthogonal and symmetric.
    let v = |i: usize| (1.0 + i as f64).sin();
    let square: f64 = (0..2 * m).map(|i| v(i) * v(i)).sum();
    let turn =
        Mat::from_fn(2 * m, 2 * m, |i, j| f64::from(u8::from(i == j)) - 2.0 * v(i) * v(j) / square);
    &turn * plain * &turn
}

/// 1, 2 and 5 in each of these decades.
fn in_decades(decades: core::ops::Range<i32>) -> impl Iterator<Item = f64> {
    decades.flat_map(|k| [1.0, 2.0, 5.0].map(|x| x * 10f64.powi(k)))
}

/// Growth by any known rate g beside oscillators and a free mass. Closed formulas: the multipliers e^{±g} of ẍ = g²x, and
/// of its canonical form.
#[test]
fn slow_growth_beside_other_motions() {
    let oscillator = |w: f64| [[w.cos(), w.sin()], [-w.sin(), w.cos()]];
    let free = [[1.0, 0.3], [0.0, 1.0]];
    let normal = |g: f64| [[g.cosh(), g.sinh()], [g.sinh(), g.cosh()]];
    let shear = |g: f64| [[g.cosh(), g.sinh() / g], [g * g.sinh(), g.cosh()]];
    let see = |g: f64, error: f64, blocks: &[[[f64; 2]; 2]]| {
        let found = Stability::of(&of_blocks(blocks), error).unwrap();
        let right = (found.growth / g - 1.0).abs() < 1e-2 && !found.is_bounded;
        assert!(right, "g = {g:e}, error = {error:e}, {blocks:?}: {found:?}");
    };
    for w in [1.3, 0.927, 3.0] {
        for g in in_decades(-9..-2) {
            for error in [1e-8, 1e-10, 1e-12, 1e-2 * g].into_iter().filter(|e| 20.0 * e < g) {
                see(g, error, &[normal(g), oscillator(w)]);
                see(g, error, &[oscillator(w), normal(g), oscillator(0.4 * w)]);
                see(g, error, &[normal(g), oscillator(w), normal(g)]);
            }
        }
        for g in in_decades(-6..-2) {
            for error in [1e-8, 1e-10, 1e-12, 1e-14].into_iter().filter(|e| 20.0 * e < g * g) {
                see(g, error, &[normal(g), free]);
                see(g, error, &[shear(g), oscillator(w)]);
                see(g, error, &[oscillator(w), shear(g), oscillator(0.4 * w)]);
                see(g, error, &[shear(g), oscillator(w), shear(g)]);
            }
        }
    }
    // Growth that overflows in a few periods.
    let fast = [[1e200, 0.0], [0.0, 1e-200]];
    let found = Stability::of(&of_blocks(&[fast, oscillator(1.3)]), 1e-13).unwrap();
    assert!((found.growth / 1e200f64.ln() - 1.0).abs() < 1e-12 && !found.is_bounded, "{found:?}");
}

/// Beside oscillators and free masses an M that is known to `error` shows no growth that is `error` alone.
#[test]
fn an_error_of_the_monodromy_is_no_growth() {
    let oscillator = |w: f64| [[w.cos(), w.sin()], [-w.sin(), w.cos()]];
    let free = |shear: f64| [[1.0, shear], [0.0, 1.0]];
    for error in [1e-6, 1e-8, 1e-10, 1e-13] {
        for (blocks, is_bounded) in [
            ([oscillator(1.3), oscillator(0.4)], true),
            ([oscillator(1.3), oscillator(1.3)], true),
            ([free(1.0), oscillator(0.9)], false),
            ([free(0.3), free(2.0)], false),
        ] {
            let exact = of_blocks(&blocks);
            for seed in 0..20 {
                let part = |i: usize, j: usize| (1.0 + (7 * i + 3 * j + 11 * seed) as f64).sin();
                let m = Mat::from_fn(4, 4, |i, j| exact[(i, j)] + error * part(i, j));
                let found = Stability::of(&m, error).unwrap();
                let expected = Stability { growth: 0.0, is_bounded };
                assert_eq!(found, expected, "error = {error:e}, {blocks:?}, {seed}");
            }
        }
    }
}

/// Two oscillators with ω = 1, √2.56 and a coupling 2K cos 2.6t grow by K/(2√1.6) to first order in K, the rate of a
/// combination resonance.
#[test]
fn weak_combination_resonances() {
    let period = 2.0 * PI / 2.6;
    for k in in_decades(-8..-3) {
        let stiffness = move |t: f64, i: usize, j: usize| match i == j {
            true => [1.0, 2.56][i],
            false => -2.0 * k * (2.6 * t).cos(),
        };
        let m = monodromy(&hill(2, stiffness).unwrap(), &Magnus6, [0.0, period], 1000).unwrap();
        for error in [1e-8, 1e-10, 1e-12].into_iter().filter(|e| 50.0 * e < k) {
            let found = Stability::of(&m, error).unwrap();
            let rate = found.growth / period / (k / (2.0 * 1.6f64.sqrt()));
            let right = (rate - 1.0).abs() < 1e-3 + k && !found.is_bounded;
            assert!(right, "K = {k:e}, error = {error:e}: {rate} of the rate, {found:?}");
        }
    }
}

#[test]
fn beam_lines() {
    // Elements against the flow of their own equations.
    for (element, length, kx, kz) in [
        (Element::Drift { length: 1.3 }, 1.3, 0.0, 0.0),
        (Element::Quadrupole { length: 0.4, k: 2.5 }, 0.4, 2.5, -2.5),
        (Element::Quadrupole { length: 0.4, k: -2.5 }, 0.4, -2.5, 2.5),
        (Element::Dipole { length: 2.0, radius: 5.0 }, 2.0, 0.04, 0.0),
    ] {
        let equation = hill(2, |_, i, j| if i != j { 0.0 } else { [kx, kz][i] }).unwrap();
        let m = monodromy(&equation, &Magnus4, [0.0, length], 1).unwrap();
        assert!((&*m - &*element.map().unwrap()).norm_l2() < 1e-14, "{element:?}");
    }
    // A thick FODO cell near the thin one; its maps compose and are symplectic.
    let (f, drift) = (1.5, Element::Drift { length: 1.0 });
    let thick = |sign: f64| Element::Quadrupole { length: 1e-4, k: sign * 1e4 / f };
    let thin = |sign: f64| Element::ThinLens { focal_length: sign * f };
    let cell = transfer_map(&[thick(1.0), drift, thick(-1.0), drift]).unwrap();
    let ideal = transfer_map(&[thin(1.0), drift, thin(-1.0), drift]).unwrap();
    let expected = 2.0 * (2.0 / (4.0 * f)).asin() / (2.0 * PI); // sin(μ/2) = L/(4f)
    for (a, b) in tunes(&cell).into_iter().zip(tunes(&ideal)) {
        assert!((a.unwrap() - expected).abs() < 1e-4 && (b.unwrap() - expected).abs() < 1e-15);
    }
    let sp = MatrixGroup::sp(4).unwrap();
    assert!(sp.defect(&cell) < 1e-13);
    let half = transfer_map(&[thick(1.0), drift]).unwrap();
    let other = transfer_map(&[thick(-1.0), drift]).unwrap();
    assert!((&*other * &*half - &*cell).norm_l2() < 1e-14);
    // Weak lenses: the trace is 2 to rounding, and the tune has its digits. References of 50 digits.
    for (k, expected) in [(1e-4, 1.052710998558659e-5), (1e-8, 1.052710998369481e-9)] {
        let quadrupole = |sign: f64| Element::Quadrupole { length: 0.5, k: sign * k };
        let weak = [quadrupole(1.0), drift, quadrupole(-1.0), drift];
        let [x, z] = tunes(&transfer_map(&weak).unwrap()).map(|tune| tune.unwrap());
        assert!((x / expected - 1.0).abs() < 1e-6 && (z / expected - 1.0).abs() < 1e-6, "{x} {z}");
    }
    // Lenses too strong for their distance: f < L/4 is unstable in both planes.
    let strong = |sign: f64| Element::ThinLens { focal_length: sign * 0.4 };
    let unstable = transfer_map(&[strong(1.0), drift, strong(-1.0), drift]).unwrap();
    assert_eq!(tunes(&unstable), [None, None]);
    assert!(Floquet::of(&unstable).unwrap().spectral_radius() > 1.5);
    assert!(Element::ThinLens { focal_length: 0.0 }.map().is_err());
    assert!(Element::Quadrupole { length: f64::NAN, k: 1.0 }.map().is_err());
    let straight = Element::Dipole { length: 1.0, radius: 0.0 }.map().unwrap_err().to_string();
    assert!(straight.contains("radius = 0"), "{straight}");
}

/// Ṗ = c − aᵀP − Pa − PbP on symmetric 2×2 matrices, with coefficients that depend on t.
#[test]
fn riccati_on_lagrangian_subspaces() {
    let blocks = |t: f64| {
        let a = mat![[0.1, 0.4 * t.cos()], [-0.2, 0.3]];
        let b = mat![[1.0, 0.2], [0.2, 0.5 + 0.3 * t.sin()]];
        let c = mat![[0.8, -0.1 * t], [-0.1 * t, 1.1]];
        (a, b, c)
    };
    let field = move |t: f64, v: &mut AlgebraMatrix| {
        let (a, b, c) = blocks(t);
        for j in 0..2 {
            for i in 0..2 {
                (v[(i, j)], v[(i, j + 2)]) = (a[(i, j)], b[(i, j)]);
                (v[(i + 2, j)], v[(i + 2, j + 2)]) = (c[(i, j)], -a[(j, i)]);
            }
        }
    };
    let sp = MatrixGroup::sp(4).unwrap();
    let riccati = Flow::of_time(sp, Lagrangian, field);
    let start = mat![[0.3, 0.1], [0.1, -0.2]];
    // The same equation by its entries, with the classical method.
    let slope = |t: f64, p: &Mat<f64>| {
        let (a, b, c) = blocks(t);
        c - a.transpose() * p - p * &a - p * b * p
    };
    let (mut p, n) = (start.clone(), 4000);
    let h = 2.0 / n as f64;
    for k in 0..n {
        let t = k as f64 * h;
        let at = |s: f64, k: &Mat<f64>| slope(t + s * h, &(&p + k * faer::Scale(s * h)));
        let k1 = slope(t, &p);
        let k2 = at(0.5, &k1);
        let k3 = at(0.5, &k2);
        let k4 = at(1.0, &k3);
        p = &p + (k1 + (k2 + k3) * faer::Scale(2.0) + k4) * faer::Scale(h / 6.0);
    }
    for (far, name) in [
        (run(&riccati, &Magnus4, 2.0, 400, &start), "magnus4"),
        (run(&riccati, &Rkmk::new(RK4, Cay), 2.0, 400, &start), "rkmk4"),
    ] {
        assert!((&far - &p).norm_l2() < 1e-8, "{name}: {:e}", (&far - &p).norm_l2());
    }
    let end = run(&riccati, &Magnus4, 2.0, 100, &start);
    assert_eq!(end[(0, 1)], end[(1, 0)]);
}

/// P may become infinite between steps; where a step ends there it says so.
#[test]
fn poles_of_riccatis_equation() {
    let turn =
        Flow::of_time(MatrixGroup::sp(2).unwrap(), Lagrangian, |_: f64, v: &mut AlgebraMatrix| {
            (v[(1, 0)], v[(0, 1)]) = (1.0, -1.0)
        });
    let end = run(&turn, &Magnus4, 10.0, 70, &mat![[0.0]]);
    assert!((end[(0, 0)] - 10f64.tan()).abs() < 1e-11);
    // cay(u) for u = 2·[0 −1; 1 0] is a quarter of a turn, exactly: A + BP = 0.
    let grid = TimeGrid::with_steps([0.0, 2.0], 1).unwrap();
    let mut p = mat![[0.0]];
    let method = Rkmk::new(lieflow::methods::tableau::EULER, Cay);
    let failed = integrate(&turn, &method, &grid, &SaveAt::Ends, &mut p, |_, _| {});
    let Err(RunError::Step(failure)) = failed else { panic!("{failed:?}, P = {p:?}") };
    assert_eq!(failure.source, StepError::NotFinite { what: "P" });
}
