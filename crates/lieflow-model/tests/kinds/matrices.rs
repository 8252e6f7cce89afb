//! Flows of matrices, linear Hamiltonian systems and the others that live in matrix groups.

use core::f64::consts::{PI, TAU};

use faer::Mat;
use lieflow::SaveAt;
use lieflow::problems::Exact;
use lieflow::problems::beam::{Element, transfer_map};
use lieflow_model::problem::Rows;
use nalgebra::Matrix3;

use super::*;

fn fact(scene: &Scene, name: &str) -> f64 {
    let facts = scene.problem.facts();
    facts.iter().find(|fact| fact.name == name).unwrap_or_else(|| panic!("{facts:?}")).value
}

/// Toda's lattice ends with the momenta −2 times the eigenvalues, the fastest to the left ahead.
#[test]
fn particles_part_with_the_eigenvalues() {
    let text = bundled("toda-lattice").replace("t_span = [0.0, 20.0]", "t_span = [0.0, 40.0]");
    let text = text.replace("[\"diagonal\", \"off_diagonal\"]", "[\"diagonal\", \"eigenvalues\"]");
    let end = last(&Scene::parse("scene", &text).unwrap());
    let (diagonal, eigenvalues) = end.split_at(4);
    let descending: Vec<f64> = eigenvalues.iter().rev().copied().collect();
    assert!(far(diagonal, &descending) < 1e-6, "{end:?}");
    // Two particles of momenta ±p far apart: the eigenvalues are ±½√(p² + e^{q₁−q₂}).
    let two = "kind = \"toda\"\npositions = [0, 1]\nmomenta = [0.7, -0.7]";
    let of = scene(two, "name = \"cf4\"", "t_span = [0, 1]\ndt = 0.05", "[\"eigenvalues\"]");
    let expected = 0.5 * (0.49 + (-1.0f64).exp()).sqrt();
    assert!(far(&last(&of), &[-expected, expected]) < 1e-13);
}

#[test]
fn a_double_bracket_sorts() {
    let text = bundled("sorting").replace("off_diagonal", "eigenvalues");
    let text = text.replace("t_span = [0.0, 8.0]", "t_span = [0.0, 20.0]");
    let end = last(&Scene::parse("scene", &text).unwrap());
    let (diagonal, eigenvalues) = end.split_at(4);
    assert!(far(diagonal, eigenvalues) < 1e-5, "{end:?}");
    let text = text.replace("order = [1.0, 2.0, 3.0, 4.0]", "order = [4.0, 2.0, 3.0, 1.0]");
    let end = last(&Scene::parse("scene", &text).unwrap());
    let (d, e) = end.split_at(4);
    assert!(far(d, &[e[3], e[1], e[2], e[0]]) < 1e-5, "{end:?}");
}

/// At t = 1, 2, … the flow has the iterates of the QR algorithm.
#[test]
fn the_qr_flow_does_the_qr_algorithm() {
    let rows = rows(&Scene::bundled("qr-flow").unwrap());
    let at = |row: &[f64]| {
        let entry = |i: usize, j: usize| row[1 + [[0, 1, 2], [1, 3, 4], [2, 4, 5]][i][j]];
        Mat::from_fn(3, 3, entry)
    };
    for (k, row) in rows.iter().enumerate().take(5) {
        assert!((row[0] - k as f64).abs() < 1e-12);
        let (l, next) = (at(row), at(&rows[k + 1]));
        let qr = l.qr();
        let (q, r) = (qr.compute_Q(), qr.thin_R());
        let expected = r * &q;
        for i in 0..3 {
            for j in 0..3 {
                // Up to the signs of the columns of Q.
                let gap = (expected[(i, j)].abs() - next[(i, j)].abs()).abs();
                assert!(gap < 1e-6, "{k}: {gap:e}");
            }
        }
    }
}

/// At the characteristic values a₀(1) and b₁(1) (DLMF 28.2) the trace of the monodromy is 2 and −2.
#[test]
fn mathieus_characteristic_values() {
    let period = format!("t_span = [0, {PI}]\nsteps = 200");
    for (a, trace) in [(-0.45513860410741355, 2.0), (-0.11024881699209517, -2.0)] {
        let problem = format!("kind = \"mathieu\"\na = {a}\nq = 1");
        let of = scene(&problem, "name = \"magnus6\"", &period, "[\"trace\"]");
        assert!(far(&last(&of), &[trace]) < 1e-10, "{:?}", last(&of));
        assert!((fact(&of, "trace_of_the_monodromy") - trace).abs() < 1e-11);
    }
    let stable = |a: f64| {
        let problem = format!("kind = \"mathieu\"\na = {a}\nq = 0.3");
        fact(&scene(&problem, "name = \"magnus6\"", &period, "[\"trace\"]"), "stable")
    };
    assert_eq!([stable(1.0), stable(2.5)], [0.0, 1.0]);
}

/// Two masses with a spring between them move away together: a double multiplier 1, and a solution that grows with t.
#[test]
fn a_translation_is_not_stable() {
    for (a, stable) in [("[[1, -1], [-1, 1]]", 0.0), ("[[1.3, 0], [0, 1.3]]", 1.0)] {
        let problem = format!("kind = \"hill\"\na = {a}\nq = [[0, 0], [0, 0]]\nperiod = 2.0");
        let of = scene(&problem, "name = \"magnus6\"", "t_span = [0, 2]\ndt = 0.1", "[\"map\"]");
        assert_eq!(fact(&of, "stable"), stable, "{a}");
    }
    // At a characteristic value, between two bands, and with many oscillations in a period.
    for (a, q, stable) in [
        ("-0.45513860410741355", "1", 0.0),
        ("4", "1e-4", 0.0),
        ("9", "1e-2", 1.0),
        ("1e6", "1", 1.0),
    ] {
        let problem = format!("kind = \"mathieu\"\na = {a}\nq = {q}");
        let of = scene(&problem, "name = \"magnus6\"", "t_span = [0, 2]\ndt = 0.1", "[\"map\"]");
        assert_eq!(fact(&of, "stable"), stable, "{a} {q}");
        assert_eq!(fact(&of, "growth_rate") > 0.0, (a, q) == ("4", "1e-4"), "{a} {q}");
    }
    let free = "kind = \"mathieu\"\na = 0\nq = 0";
    let of = scene(free, "name = \"magnus6\"", "t_span = [0, 2]\ndt = 0.1", "[\"map\"]");
    assert_eq!(fact(&of, "stable"), 0.0);
}

/// Two oscillators with ω = 1, √2.56 and a drive of 2K cos 2.6t between them grow by K/(2√1.6), to first order in K; a mode
/// with ẍ = g²x by g.
#[test]
fn slow_growth_beside_an_oscillator() {
    let see = |problem: &str, rate: f64| {
        let of = scene(problem, "name = \"magnus6\"", "t_span = [0, 2]\ndt = 0.1", "[\"map\"]");
        let found = fact(&of, "growth_rate");
        assert!((found / rate - 1.0).abs() < 2e-3, "{problem}: {found:e}, expected {rate:e}");
        assert_eq!(fact(&of, "stable"), 0.0, "{problem}");
    };
    for k in [1e-7, 4e-7, 1.6e-6, 4e-6, 8e-6, 1.6e-5, 1e-4, 1e-3] {
        let problem = format!(
            "kind = \"hill\"\na = [[1, 0], [0, 2.56]]\nq = [[0, {k:e}], [{k:e}, 0]]\n\
             period = 2.41660973353061"
        );
        see(&problem, k / (2.0 * 1.6f64.sqrt()));
    }
    for square in [1e-11f64, 1e-10, 1e-9, 1e-7, 1e-5, 1e-3] {
        let problem = format!(
            "kind = \"hill\"\na = [[-{square:e}, 0], [0, 1]]\nq = [[0, 0], [0, 0]]\nperiod = 1.0"
        );
        see(&problem, square.sqrt());
    }
}

/// Without a drive the solutions of Hill's equation are cosines.
#[test]
fn hills_equation_without_a_drive() {
    let problem = "kind = \"hill\"\na = [[4, 0], [0, 9]]\nq = [[0, 0], [0, 0]]\nperiod = 1.3";
    let of = scene(problem, "name = \"cfm4-2\"", "t_span = [0, 2]\ndt = 0.1", "[\"map\"]");
    let g = last(&of);
    for (i, w) in [2.0f64, 3.0].into_iter().enumerate() {
        let (s, c) = (2.0 * w).sin_cos();
        let block = [g[5 * i], g[5 * i + 2], g[5 * i + 8], g[5 * i + 10]];
        assert!(far(&block, &[c, s / w, -w * s, c]) < 1e-13, "{g:?}");
    }
    let expected = 2.0 * (2.6f64.cos() + 3.9f64.cos());
    assert!((fact(&of, "trace_of_the_monodromy") - expected).abs() < 1e-12);
}

/// A cell by steps that end where elements do is the product of the maps of its elements.
#[test]
fn a_cell_is_its_transfer_map() {
    let text = bundled("fodo-cell")
        .replace("t_span = [0.0, 240.0]", "t_span = [0.0, 4.0]")
        .replace("every = 16", "every = 1")
        .replace("[\"phase_space\"]", "[\"map\"]");
    let of = Scene::parse("scene", &text).unwrap();
    let drift = |length: f64| Element::Drift { length };
    let quadrupole = |k: f64| Element::Quadrupole { length: 0.5, k };
    let bend = [drift(0.25), Element::Dipole { length: 1.0, radius: 8.0 }, drift(0.25)];
    let cell = [&[quadrupole(1.2)], &bend[..], &[quadrupole(-1.2)], &bend[..]].concat();
    let map = transfer_map(&cell).unwrap();
    let expected: Vec<f64> = (0..16).map(|k| map[(k / 4, k % 4)]).collect();
    assert!(far(&last(&of), &expected) < 1e-13);
    // The phase that the particle turns by in a cell is the tune.
    let tune = fact(&of, "tune_x");
    let trace = map[(0, 0)] + map[(2, 2)];
    assert!(((TAU * tune).cos() - 0.5 * trace).abs() < 1e-14 && tune > 0.0 && tune < 1.0);
    assert_eq!(fact(&of, "stable"), 1.0);
}

/// Ṗ = 1 + P² is P = tan t, far past the pole.
#[test]
fn riccati_past_a_pole() {
    let problem = "kind = \"riccati\"\nc = [[1]]\nb = [[-1]]\np = [[0]]";
    let of = scene(problem, "name = \"magnus4\"", "t_span = [0, 5]\ndt = 0.1", "[\"p\"]");
    assert!(far(&last(&of), &[5f64.tan()]) < 1e-11);
    // Ṗ = 2dP: a D alone.
    let problem = "kind = \"riccati\"\nc = [[0]]\nd = [[0.3]]\nb = [[0]]\np = [[2]]";
    for method in ["magnus4", "rk4", "rkmk4"] {
        let method = format!("name = {method:?}");
        let of = scene(problem, &method, "t_span = [0, 1]\ndt = 0.01", "[\"p\"]");
        assert!(far(&last(&of), &[2.0 * 0.6f64.exp()]) < 1e-9, "{method}");
    }
}

/// P = s tanh t in other units: the steps are those of s = 1, and so are the half turns.
#[test]
fn riccati_equations_in_other_units_take_the_same_steps() {
    for s in [1.0, 1e-6, 1e4, 1e8] {
        let problem =
            format!("kind = \"riccati\"\nc = [[{s:e}]]\nb = [[{:e}]]\np = [[0]]", 1.0 / s);
        for method in ["rkmk dop853", "magnus6", "rk dop853"] {
            let of = scene(
                &problem,
                &format!("name = {method:?}"),
                "t_span = [0, 5]\nrtol = 1e-8",
                "[\"p\", \"angles\"]",
            );
            let row = &last(&of)[..];
            let (p, angle) = (s * 5f64.tanh(), (s * 5f64.tanh()).atan());
            assert!((row[0] / p - 1.0).abs() < 1e-7, "{s:e} {method}: {row:?}");
            assert!((row[1] - angle).abs() < 1e-7 * angle, "{s:e} {method}: {row:?}");
            let mut plan = of.plan(of.model().unwrap().schema()).unwrap();
            plan.save = SaveAt::Ends;
            let done =
                of.model().unwrap().drive(&of.method, plan, &mut Rows(&mut |_, _| {})).unwrap();
            assert!(done.stats.accepted < 60, "{s:e} {method}: {} steps", done.stats.accepted);
        }
    }
    // P = s tan t passes its poles.
    for s in [1e-6, 1.0, 1e6] {
        let problem =
            format!("kind = \"riccati\"\nc = [[{s:e}]]\nb = [[{:e}]]\np = [[0]]", -1.0 / s);
        let of =
            scene(&problem, "name = \"magnus6\"", "t_span = [0, 20]\nrtol = 1e-8", "[\"angles\"]");
        let half_turns = (20.0 / PI).round();
        let angle = half_turns * PI + (s * (20.0 - half_turns * PI).tan()).atan();
        assert!((last(&of)[0] - angle).abs() < 1e-6, "{s:e}: {:?} {angle}", last(&of));
    }
}

/// P = diag(tan t, tan 0.3t): the angles go on over π/2 at each pole. Where their difference passes π they cross, as
/// angles up to π, and the order of their columns stays.
#[test]
fn riccati_angles_have_no_jump() {
    let problem = "kind = \"riccati\"\nc = [[1, 0], [0, 0.3]]\nb = [[-1, 0], [0, -0.3]]\n\
                   p = [[0, 0], [0, 0]]";
    let of = scene(problem, "name = \"magnus4\"", "t_span = [0, 20]\ndt = 0.1", "[\"angles\"]");
    let rows = rows(&of);
    assert_eq!(rows.len(), 201);
    for pair in rows.windows(2) {
        assert!(far(&pair[0][1..], &pair[1][1..]) < 0.11, "{pair:?}");
        let [t, a, b] = pair[1][..] else { panic!("{pair:?}") };
        assert!((a + b - 1.3 * t).abs() < 1e-9 && a <= b && b - a < PI + 1e-9, "{pair:?}");
        assert!(t > 4.48 || far(&[a, b], &[0.3 * t, t]) < 1e-9, "{pair:?}");
    }
}

/// Steps by error are short enough to count the poles, however far the rows are apart, in one dimension and in two.
#[test]
fn riccati_angles_count_the_poles_between_rows() {
    let one = ("c = [[1]]\nb = [[-1]]\np = [[0]]", 1.0);
    let two = ("c = [[1, 0], [0, 0.3]]\nb = [[-1, 0], [0, -0.3]]\np = [[0, 0], [0, 0]]", 1.3);
    let back = ("c = [[-2]]\nb = [[2]]\np = [[0]]", -2.0);
    for ((keys, rate), method) in
        [one, two, back].into_iter().flat_map(|keys| ["magnus4", "rkmk dop853"].map(|m| (keys, m)))
    {
        let (problem, method) =
            (format!("kind = \"riccati\"\n{keys}"), format!("name = {method:?}"));
        let of = scene(&problem, &method, "t_span = [0, 60]\nrtol = 1e-12", "[\"angles\"]");
        let (mut rows, mut plan) = (Vec::new(), of.plan(of.model().unwrap().schema()).unwrap());
        plan.save = SaveAt::Ends;
        let mut sink = |_: f64, row: Row<'_>| rows.push(row.values().iter().sum::<f64>());
        of.model().unwrap().drive(&of.method, plan, &mut Rows(&mut sink)).unwrap();
        assert_eq!(rows.len(), 2);
        assert!((rows[1] - 60.0 * rate).abs() < 1e-9, "{problem}, {method}: {rows:?}");
    }
    // Steps of a given size that pass poles, too.
    for (keys, rate) in [one, two, back] {
        let problem = format!("kind = \"riccati\"\n{keys}");
        let of =
            scene(&problem, "name = \"magnus4\"", "t_span = [0, 60]\nsteps = 3", "[\"angles\"]");
        let sum: f64 = last(&of).iter().sum();
        assert!((sum - 60.0 * rate).abs() < 1e-9, "{problem}: {sum}");
    }
    // The rate that steps are limited by is that of the sum: here P moves by D and by B alone.
    let gap = |keys: &str| {
        let of = scene(
            &format!("kind = \"riccati\"\n{keys}"),
            "name = \"magnus4\"",
            "t_span = [0, 1]",
            "[\"angles\"]",
        );
        of.model().unwrap().schema().longest_gap().unwrap()
    };
    let rates = [(one.0, 1.0), (two.0, 2.0), ("c = [[0]]\nd = [[3]]\nb = [[0]]\np = [[1]]", 3.0)];
    for (keys, rate) in rates {
        assert!((gap(keys) * rate - 0.45 * PI).abs() < 1e-12, "{keys}: {}", gap(keys));
    }
}

/// Without E the velocity turns at the rate qB/m in proper time; with E < B it drifts at E/B.
#[test]
fn a_particle_gyrates_and_drifts() {
    let run = |electric: &str, velocity: &str, t: f64| {
        let problem = format!(
            "kind = \"lorentz\"\ncharge_to_mass = 1\nelectric = {electric}\nmagnetic = [0, 0, 1.3]\n\
             velocity = {velocity}"
        );
        let time = format!("t_span = [0, {t}]\nsteps = 1000");
        let of = scene(&problem, "name = \"rkmk4\"\nmap = \"cay\"", &time, "[\"velocity\"]");
        let exact = of.model().unwrap().exact([0.0, t]).unwrap().unwrap();
        let end = last(&of);
        assert!(far(&end, &exact) < 1e-8, "{end:?} {exact:?}");
        end
    };
    // dv/dτ = v × B: against the turn of a right hand.
    let (s, c) = (1.3f64 * 2.0).sin_cos();
    assert!(far(&run("[0, 0, 0]", "[0.5, 0, 0.1]", 2.0), &[0.5 * c, -0.5 * s, 0.1]) < 1e-8);
    // In the frame that moves at E/B there is no electric field: at that velocity nothing changes.
    assert!(far(&run("[0, 0.52, 0]", "[0.4, 0, 0]", 2.0), &[0.4, 0.0, 0.0]) < 1e-8);
}

/// Two equal levels with a constant coupling c: the population swings as sin² ct.
#[test]
fn two_levels_swing() {
    let problem = "kind = \"schrodinger\"\nenergies = [0.3, 0.3]\ncoupling = [[0, 0.4], [0.4, 0]]\n\
                   amplitudes = [2, 0]";
    for method in ["magnus4", "rkmk4", "rk4", "gauss4"] {
        let method = format!("name = {method:?}");
        let of = scene(problem, &method, "t_span = [0, 3]\ndt = 0.01", "[\"populations\"]");
        let up = (0.4f64 * 3.0).sin().powi(2);
        assert!(far(&last(&of), &[1.0 - up, up]) < 1e-9, "{method}");
    }
    // An imaginary coupling of either sign, H = ∓ sin: the same swing, with real amplitudes.
    let problem = "kind = \"schrodinger\"\nenergies = [0, 0]\ncoupling = [[0, 0], [0, 0]]\n\
                   coupling_imaginary = [[0, -0.4], [0.4, 0]]\namplitudes = [1, 0]";
    let time = "t_span = [0, 3]\ndt = 0.1";
    let end = last(&scene(problem, "name = \"magnus4\"", time, "[\"amplitudes\"]"));
    assert!(far(&end, &[1.2f64.cos(), 1.2f64.sin(), 0.0, 0.0]) < 1e-12, "{end:?}");
}

#[test]
fn ojas_flow_finds_the_leading_eigenvectors() {
    let text = bundled("oja").replace("t_span = [0.0, 8.0]", "t_span = [0.0, 30.0]");
    let of = Scene::parse("scene", &text).unwrap();
    let end = last(&of);
    let expected = fact(&of, "sum_of_the_leading_eigenvalues");
    assert!((end[8] - expected).abs() < 1e-9, "{end:?} {expected}");
}

/// Of a linear field the exponents are the eigenvalues; of Lorenz' their sum is −41/3 at every time.
#[test]
fn lyapunov_exponents() {
    let linear = "kind = \"lyapunov\"\nx = [0, 0.1]\nfield = [\"x1 + x2\", \"-2*x2\"]";
    let time = "t_span = [3, 43]\ndt = 0.05";
    let end = last(&scene(linear, RKMK4_CAY, time, "[\"exponents\"]"));
    // The first direction stays where it is, at every time: so it does not with DFᵀ for DF.
    assert!(far(&end, &[1.0, -2.0]) < 1e-12, "{end:?}");
    // Where nothing mixes the directions they are sorted all the same.
    let apart = "kind = \"lyapunov\"\nx = [1, 1]\nfield = [\"-x1\", \"0.5*x2\"]";
    let end = last(&scene(apart, RKMK4_CAY, time, "[\"exponents\"]"));
    assert!(far(&end, &[0.5, -1.0]) < 1e-12, "{end:?}");
    let text = bundled("lorenz").replace("t_span = [0.0, 30.0]", "t_span = [0.0, 10.0]");
    let rows = rows(&Scene::parse("scene", &text).unwrap());
    for row in &rows[1..] {
        let sum: f64 = row[4..].iter().sum();
        assert!((sum + 41.0 / 3.0).abs() < 1e-7, "{row:?}");
    }
    // A pendulum that is driven and damped: whatever it does, the sum is minus the damping.
    let pendulum = "kind = \"lyapunov\"\nx = [0.5, 0]\nvariables = [\"q\", \"p\"]\n\
                    field = [\"p\", \"-sin(q) - 0.2*p + 1.2*cos(2*t/3)\"]";
    let of = scene(pendulum, RKMK4_CAY, "t_span = [1, 21]\ndt = 0.02", "[\"x\", \"exponents\"]");
    assert_eq!(of.problem.columns("x").unwrap(), ["q", "p"]);
    let end = last(&of);
    assert!((end[2] + end[3] + 0.2).abs() < 1e-8, "{end:?}");
}

const RKMK4_CAY: &str = "name = \"rkmk4\"\nmap = \"cay\"";

/// On so(3) Euler's equations are the rigid body; in sl(3) the momentum stays there.
#[test]
fn eulers_equations_on_matrix_algebras() {
    let so3 = "kind = \"euler\"\nalgebra = \"so\"\ninverse_inertia = [[0, 0.25, 0.5], [0.25, 0, 1], [0.5, \
               1, 0]]\nmomentum = [[0, -3, 0.1], [3, 0, -0.2], [-0.1, 0.2, 0]]";
    let body = "kind = \"rigid-body-n\"\ninertia = [4, 2, 1]\nmomentum = [-3, 0.1, -0.2]";
    let time = "t_span = [0, 2]\ndt = 0.01";
    let m = last(&scene(so3, RKMK4_CAY, time, "[\"momentum\"]"));
    let of_body = last(&scene(body, RKMK4_CAY, time, "[\"momentum\"]"));
    assert!(far(&[m[1], m[2], m[5]], &of_body) < 1e-13, "{m:?}");
    let end = last(&Scene::bundled("euler-on-sl3").unwrap());
    assert!((end[0] + end[4] + end[8]).abs() < 1e-14, "{end:?}");

    // With g: on SO(3) the attitude of the body; on SL(3) det g = 1, and Ad* carries the momentum back.
    let of = scene(so3, RKMK4_CAY, time, "[\"momentum\", \"group\"]");
    let exact = Exact::new([1.0, 2.0, 4.0], [0.2, 0.1, 3.0], Matrix3::identity()).unwrap();
    let (_, g) = exact.state(2.0).unwrap();
    let with_g = last(&of);
    assert!(far(&with_g[..9], &m) < 1e-14 && far(&with_g[9..], g.transpose().as_slice()) < 1e-8);
    let text =
        bundled("euler-on-sl3").replace("[\"momentum\", ", "[\"group\", \"momentum_space\", ");
    let of = Scene::parse("scene", &text).unwrap();
    assert_eq!(of.model().unwrap().modelled(&of.method), ["momentum on sl(3)* and g in SL(3)"]);
    let end = last(&of);
    let g = Matrix3::from_row_slice(&end[..9]);
    assert!((g.determinant() - 1.0).abs() < 1e-12 && (g - Matrix3::identity()).norm() > 0.5);
    assert!(far(&end[9..18], &[0.2, 0.1, -0.3, -0.2, 0.1, 0.2, 0.3, -0.1, -0.3]) < 1e-12);
    // Without it nothing but the momentum is modelled.
    let alone = Scene::bundled("euler-on-sl3").unwrap();
    assert_eq!(alone.model().unwrap().modelled(&alone.method), ["momentum on sl(3)*"]);
}

/// On the dual of sp(4) the projection stays in the algebra, and the energy and the Casimirs are kept.
#[test]
fn eulers_equations_on_sp4() {
    let problem = "kind = \"euler\"\nalgebra = \"sp\"\ninverse_inertia = [[1, 2, 3, 4], [2, 5, 1, 3], [3, 1, \
                   4, 2], [1, 3, 2, 1]]\nmomentum = [[0.1, 0.2, 0.3, 0.1], [-0.1, 0.2, 0.1, 0.4], [0.2, \
                   0.3, -0.1, 0.1], [0.3, -0.2, -0.2, -0.2]]";
    let quantities = "[\"momentum\", \"energy\", \"casimirs\"]";
    let of = |method: &str| rows(&scene(problem, method, "t_span = [0, 3]\ndt = 0.02", quantities));
    let kept = of("name = \"energy-casimir\"\nmap = \"cay\"");
    let (first, end) = (&kept[0][1..], &kept.last().unwrap()[1..]);
    assert!(far(&first[..16], &end[..16]) > 0.1 && far(&first[16..], &end[16..]) < 1e-13);
    // [a b; c −aᵀ].
    assert!((end[0] + end[10]).abs() < 1e-14 && (end[1] + end[14]).abs() < 1e-14);
    assert!((end[3] - end[6]).abs() < 1e-14 && (end[9] - end[12]).abs() < 1e-14);
    let fine = of(RKMK4_CAY);
    assert!(far(&fine.last().unwrap()[1..17], &end[..16]) < 1e-2);
}

/// A line in the plane turns to the leading eigenvector by tan θ = e^{−(λ₁−λ₂)t} tan θ₀; in five dimensions a
/// plane moves as the span of e^{tA}X, with Oja's frames and without.
#[test]
fn subspaces_turn_to_the_leading_ones() {
    let line = "kind = \"subspace\"\na = [[3, 0], [0, 1]]\nx = [[1], [5]]";
    let of = scene(line, RKMK4_CAY, "t_span = [0, 2]\ndt = 0.01", "[\"angles\", \"trace\"]");
    let angle = (5.0 * (-4.0f64).exp()).atan();
    assert!(far(&last(&of), &[angle, 3.0 - 2.0 * angle.sin().powi(2)]) < 1e-8);
    assert!((fact(&of, "rate_of_convergence") - 2.0).abs() < 1e-14);

    let none = line.replace("[[1], [5]]", "[[0], [0]]");
    let none = format!("title = \"\"\n[problem]\n{none}\n[method]\n{RKMK4_CAY}");
    let message = Scene::parse("scene", &none).unwrap_err().to_string();
    assert!(message.contains("scene:5") && message.contains("depend on each other"), "{message}");

    let text = bundled("subspaces").replace("[\"angles\"", "[\"projector\", \"angles\"");
    let plane = Scene::parse("scene", &text).unwrap();
    let (end, exact) = (last(&plane), plane.model().unwrap().exact([0.0, 8.0]).unwrap().unwrap());
    assert!(far(&end[..17], &exact[..17]) < 1e-6, "{end:?}");
    assert!(end[15] < 0.1 && end[15] > end[16], "the plane has come near: {end:?}");
    let of = text.replace("\"subspace\"", "\"oja\"");
    let i = of.find("quantities").unwrap();
    let of = Scene::parse("scene", &format!("{}quantities = [\"x\"]", &of[..i])).unwrap();
    let x = Mat::from_fn(5, 2, |i, j| last(&of)[2 * i + j]);
    let p = &x * x.transpose();
    let above = (0..5).flat_map(|i| (i..5).map(move |j| (i, j)));
    assert!(far(&end[..15], &above.map(|place| p[place]).collect::<Vec<_>>()) < 1e-5);
}

/// Jets are stationary, and the energy of the harmonic of degree l is ½a²/(l(l + 1)).
#[test]
fn jets_on_a_sphere_stand_still() {
    let problem = "kind = \"fluid\"\nsurface = \"sphere\"\nn = 8\njets = [[3, 0.7], [1, -0.4]]";
    let time = "t_span = [0, 1]\ndt = 0.05";
    for method in ["name = \"isospectral2\"", "name = \"energy-casimir\"", RKMK4_CAY] {
        let end = last(&scene(problem, method, time, "[\"coefficients\", \"energy\"]"));
        let mut expected = vec![0.0; 65];
        (expected[2], expected[12]) = (-0.4, 0.7);
        expected[64] = 0.5 * (0.16 / 2.0 + 0.49 / 12.0);
        assert!(far(&end, &expected) < 1e-12, "{end:?}");
    }
}

/// On the rotation Ω a wave of degree l and order m turns by m Ω(1 − 2/(l(l + 1))) a time.
#[test]
fn rossby_haurwitz_waves_turn_at_their_speed() {
    let (rate, a) = (1.5, 0.4);
    let problem = format!(
        "kind = \"fluid\"\nsurface = \"sphere\"\nn = 8\njets = [[1, {}]]\nmodes = [[4, 3, {a}]]",
        2.0 * rate / 3f64.sqrt()
    );
    let time = "t_span = [0, 0.8]\ndt = 0.02";
    let end = last(&scene(&problem, "name = \"gauss6\"", time, "[\"coefficients\"]"));
    let (s, c) = (3.0 * rate * 0.9 * 0.8).sin_cos();
    assert!(far(&[end[16 + 4 + 3], end[16 + 4 - 3]], &[a * c, a * s]) < 1e-8);
}

/// Waves of one length on the torus are stationary together, and their energies add.
#[test]
fn waves_of_one_length_on_a_torus_stand_still() {
    let problem = "kind = \"fluid\"\nsurface = \"torus\"\nn = 11\njets = [[5, 0.3]]\n\
                   modes = [[3, 4, 0.7, 0.2], [4, -3, 0, 0.5]]";
    let time = "t_span = [0, 1]\ndt = 0.05";
    let quantities = "[\"coefficients\", \"energy\", \"enstrophy\"]";
    for method in ["name = \"isospectral-suzuki4\"", "name = \"energy-casimir\"", RKMK4_CAY] {
        let of = scene(problem, method, time, quantities);
        let (columns, end) = (of.problem.columns("coefficients").unwrap(), last(&of));
        let squares = 0.3 * 0.3 + 0.7 * 0.7 + 0.2 * 0.2 + 0.5 * 0.5;
        let at = |name: &str| columns.iter().position(|column| column == name).unwrap();
        let mut expected = vec![0.0; columns.len()];
        for (name, x) in [("a0_5", 0.3), ("a3_4", 0.7), ("b3_4", 0.2), ("b4_-3", 0.5)] {
            expected[at(name)] = x;
        }
        expected.extend([squares / 100.0, 0.25 * squares]);
        assert!(far(&end, &expected) < 1e-12, "{method}: {end:?}");
    }
}

/// A vortex on a torus is where it was put: the wave numbers of its Gaussian turn with it. And the same
/// seed is the same field.
#[test]
fn vortices_on_a_torus_and_random_fields() {
    let fluid = "kind = \"fluid\"\nsurface = \"torus\"\nn = 9";
    let start = |more: &str| {
        let quantities = "[\"coefficients\", \"enstrophy\"]";
        let of =
            scene(&format!("{fluid}\n{more}"), RKMK4_CAY, "t_span = [0, 1]\nsteps = 1", quantities);
        let columns = of.problem.columns("coefficients").unwrap();
        (columns, rows(&of).remove(0).split_off(1))
    };
    let vortex = "vortices = [{ x = 1, y = 2, circulation = 3, width = 0.5 }]";
    let (columns, omega) = start(vortex);
    let size = 3.0 / (2.0 * PI * PI) * (-0.125f64 * 5.0).exp();
    let at = |name: &str| omega[columns.iter().position(|column| column == name).unwrap()];
    // m·x₀ = 2·1 − 1·2 for m = (2, −1).
    assert!(far(&[at("a2_-1"), at("b2_-1")], &[size, 0.0]) < 1e-14);
    assert!((at("b2_1") - size * 4f64.sin()).abs() < 1e-14);
    let random = |seed: u32| start(&format!("random = {{ seed = {seed}, below = 4 }}")).1;
    assert_eq!(random(7), random(7));
    assert!(far(&random(7), &random(8)) > 0.1);
    // Of root mean square 1.
    assert!((random(7).last().unwrap() - 0.5).abs() < 1e-14);
}
