//! Euler's equations of energies that are formulas: against the same stated by keys, closed forms, what is kept,
//! and what is refused.

use lieflow::problems::Exact;
use nalgebra::Matrix3;

use super::formulas::{FINE, RKMK4, SAME, refused};
use super::*;

type Rows = Vec<Vec<f64>>;

/// A matrix as a scene has it.
fn text(m: &[Vec<f64>]) -> String {
    format!("{m:?}")
}

/// Momenta of all algebras of matrices, with weights.
fn on_matrices() -> Vec<(&'static str, Rows, Rows)> {
    let rows = |rows: &[&[f64]]| rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>();
    vec![
        (
            "so",
            rows(&[
                &[0.0, 0.4, -0.2, 0.7],
                &[-0.4, 0.0, 0.5, 0.1],
                &[0.2, -0.5, 0.0, -0.3],
                &[-0.7, -0.1, 0.3, 0.0],
            ]),
            rows(&[
                &[0.0, 1.0, 2.0, 0.5],
                &[1.0, 0.0, 0.7, 1.5],
                &[2.0, 0.7, 0.0, 0.3],
                &[0.5, 1.5, 0.3, 0.0],
            ]),
        ),
        (
            "so(2,1)",
            rows(&[&[0.0, 0.4, 0.2], &[-0.4, 0.0, 0.5], &[0.2, 0.5, 0.0]]),
            rows(&[&[0.0, 1.0, 2.0], &[0.4, 0.0, 0.7], &[0.6, 1.1, 0.0]]),
        ),
        (
            "sl",
            rows(&[&[0.2, 0.1, -0.3], &[-0.2, 0.1, 0.2], &[0.3, -0.1, -0.3]]),
            rows(&[&[0.4, 0.7, 1.0], &[0.6, 0.9, 0.5], &[0.8, 0.3, 0.6]]),
        ),
        ("gl", rows(&[&[0.2, 0.5], &[-0.4, 0.3]]), rows(&[&[1.0, 2.0], &[0.5, 0.7]])),
        (
            "sp",
            rows(&[
                &[0.1, 0.2, 0.3, 0.1],
                &[-0.1, 0.2, 0.1, 0.4],
                &[0.2, 0.3, -0.1, 0.1],
                &[0.3, -0.2, -0.2, -0.2],
            ]),
            rows(&[
                &[1.0, 2.0, 3.0, 4.0],
                &[2.0, 5.0, 1.0, 3.0],
                &[3.0, 1.0, 4.0, 2.0],
                &[1.0, 3.0, 2.0, 1.0],
            ]),
        ),
    ]
}

/// ½ Σ W_ij m_ij².
fn quadratic(weights: &[Vec<f64>]) -> String {
    let entry = |(i, row): (usize, &Vec<f64>)| {
        let of = |(j, w): (usize, &f64)| format!("{w}*m{}{}^2", i + 1, j + 1);
        row.iter().enumerate().map(of).collect::<Vec<_>>()
    };
    format!("({})/2", weights.iter().enumerate().flat_map(entry).collect::<Vec<_>>().join(" + "))
}

#[test]
fn a_quadratic_energy_as_weights_and_as_a_formula_is_the_same() {
    for (algebra, momentum, weights) in on_matrices() {
        let problem = |energy: &str| {
            format!(
                "kind = \"euler\"\nalgebra = \"{algebra}\"\n{energy}\nmomentum = {}",
                text(&momentum)
            )
        };
        let by_weights = problem(&format!("inverse_inertia = {}", text(&weights)));
        let by_formula = problem(&format!("hamiltonian = \"{}\"", quadratic(&weights)));
        for method in [RKMK4, "name = \"energy-casimir\"\nmap = \"cay\""] {
            for quantities in ["[\"momentum\", \"energy\"]", "[\"momentum\", \"group\"]"] {
                if quantities.contains("group") && method != RKMK4 {
                    continue;
                }
                let time = "t_span = [0, 1]\ndt = 0.01";
                let run = |problem: &str| last(&scene(problem, method, time, quantities));
                let apart = far(&run(&by_weights), &run(&by_formula));
                assert!(apart < SAME, "{algebra}, {method}: {apart:e}");
            }
        }
    }
    // The same functional by fewer entries: on so(4) m_ji = −m_ij.
    let (_, momentum, weights) = &on_matrices()[0];
    let problem = |energy: &str| {
        format!("kind = \"euler\"\nalgebra = \"so\"\n{energy}\nmomentum = {}", text(momentum))
    };
    let upper = "m12^2 + 2*m13^2 + 0.5*m14^2 - 0.7*m23*m32 + 1.5*m24^2 + 0.3*m43^2";
    let run = |problem: &str| last(&scene(problem, RKMK4, FINE, "[\"momentum\", \"energy\"]"));
    let by_weights = run(&problem(&format!("inverse_inertia = {}", text(weights))));
    let by_formula = run(&problem(&format!("hamiltonian = \"{upper}\"")));
    assert!(far(&by_weights, &by_formula) < SAME);
}

/// An energy of degree four and more on every algebra: the order of the method, Casimirs and, with the method
/// that keeps it, the energy.
#[test]
fn any_energy_on_any_algebra() {
    let more = "+ (m12 - m21)^4/4 + cosh(m11) + sin(m12*m11)";
    let mut problems: Vec<String> = on_matrices()
        .iter()
        .map(|(algebra, momentum, weights)| {
            let energy = format!("{} {more}", quadratic(weights));
            let momentum = text(momentum);
            format!("algebra = \"{algebra}\"\nhamiltonian = \"{energy}\"\nmomentum = {momentum}")
        })
        .collect();
    problems.push(
        "algebra = \"so3\"\nhamiltonian = \"m1^4 + 0.3*m2^2 + cosh(m3)\"\nmomentum = [0.4, 0.5, -0.6]".into(),
    );
    problems.push(
        "algebra = \"se3\"\nhamiltonian = \"(m1^2 + m2^2/2 + m3^2/3 + m1*p2)/2 + exp(p1) + p3^4\"\n\
         momentum = [0.4, 0.5, -0.6, 0.1, 0.9, 0.3]"
            .into(),
    );
    for problem in problems {
        let problem = format!("kind = \"euler\"\n{problem}");
        let end = |method: &str, dt: f64| {
            let time = format!("t_span = [0, 1]\ndt = {dt}");
            last(&scene(&problem, method, &time, "[\"momentum\"]"))
        };
        let exact = end("name = \"rkmk\"\ntableau = \"dop853\"", 0.01);
        let error = |dt: f64| far(&end(RKMK4, dt), &exact);
        let order = (error(0.05) / error(0.025)).log2();
        assert!((3.5..5.0).contains(&order), "{problem}: {order}");
        let method = "name = \"energy-casimir\"\nmap = \"cay\"";
        let of = scene(&problem, method, FINE, "[\"energy\", \"casimirs\", \"momentum\"]");
        let rows = rows(&of);
        let (first, end) = (&rows[0][1..], &rows[rows.len() - 1][1..]);
        let kept = 1 + of.problem.columns("casimirs").unwrap().len();
        // 400 steps that round the energy and the Casimirs, each of size up to 5, a few times.
        let drift = far(&first[..kept], &end[..kept]);
        assert!(drift < 100.0 * f64::EPSILON * 20.0, "{problem}: {drift:e}");
        assert!(far(first, end) > 1e-2, "{problem}: nothing moves");
    }
}

/// H = f(E) with the energy E of a free body is the body at the pace f′(E).
#[test]
fn a_function_of_the_energy_changes_the_pace() {
    let (inertia, m) = ([1.0, 2.0, 3.0], [0.2, 0.1, 1.5]);
    let energy = (0..3).map(|i| 0.5 * m[i] * m[i] / inertia[i]).sum::<f64>();
    let body = Exact::new(inertia, m, Matrix3::identity()).unwrap();
    let problem = format!(
        "kind = \"euler\"\nalgebra = \"so3\"\nhamiltonian = \"exp((m1^2/a + m2^2/b + m3^2/c)/2)\"\n\
         momentum = {m:?}\nparameters = {{ a = 1, b = 2, c = 3 }}"
    );
    let end = last(&scene(&problem, RKMK4, FINE, "[\"momentum\"]"));
    let exact = body.momentum_body(2.0 * energy.exp()).unwrap();
    assert!(far(&end, exact.as_slice()) < 1e-8);
}

/// A heavy top as the formula of its energy.
#[test]
fn a_heavy_top_is_its_energy() {
    let momenta = ["momentum_body = [0.3, 0.4, 1.2]", "vertical = [0.6, 0, 0.8]"];
    let top = format!(
        "kind = \"heavy-top\"\ninertia = [1, 2, 2.5]\nweight = [0.2, -0.1, 0.9]\n{}\n{}",
        momenta[0], momenta[1]
    );
    let formula = "kind = \"euler\"\nalgebra = \"se3\"\nmomentum = [0.3, 0.4, 1.2, 0.6, 0, 0.8]\nhamiltonian = \
                   \"(m1^2 + m2^2/2 + m3^2/2.5)/2 + 0.2*p1 - 0.1*p2 + 0.9*p3\"";
    for method in [RKMK4, "name = \"energy-casimir\"\nmap = \"cay\""] {
        let by_keys =
            last(&scene(&top, method, FINE, "[\"momentum_body\", \"vertical\", \"energy\"]"));
        let by_formula = last(&scene(formula, method, FINE, "[\"momentum\", \"energy\"]"));
        let apart = far(&by_keys, &by_formula);
        assert!(apart < SAME, "{method}: {apart:e}");
    }
}

/// Near an axis of a cubic crystal a moment goes round at the rate 2k, to the order θ²: a circle of radius θ.
#[test]
fn small_circles_about_an_axis_of_a_crystal() {
    let (k, theta) = (1.5, 1e-4);
    let period = core::f64::consts::PI / k;
    let problem = bundled("cubic-anisotropy");
    let hamiltonian = problem.lines().find(|line| line.starts_with("hamiltonian")).unwrap();
    let problem = format!(
        "kind = \"euler\"\nalgebra = \"so3\"\n{hamiltonian}\nparameters = {{ k = {k}, b = 0 }}\nmomentum = \
         [{theta}, 0, 1]"
    );
    let quarter = format!("t_span = [0, {}]\nsteps = 500", period / 4.0);
    let end = last(&scene(&problem, RKMK4, &quarter, "[\"momentum\"]"));
    assert!(far(&end, &[0.0, theta, 1.0]) < 10.0 * theta.powi(3), "{end:?}");
}

#[test]
fn hamiltonians_are_refused_at_their_line() {
    for (keys, line, expected) in [
        (
            "hamiltonian = \"m1 + q\"\nalgebra = \"so3\"\nmomentum = [1, 0, 0]",
            4,
            &["unknown name `q`", "m1 to m3"][..],
        ),
        (
            "hamiltonian = \"m1^2\"\nalgebra = \"so3\"\nmomentum = [1, 0]",
            6,
            &["found 2, expected 3 numbers"],
        ),
        (
            "hamiltonian = \"m1^2\"\nalgebra = \"se3\"\nmomentum = [[1, 0]]",
            6,
            &["rows of numbers, expected 6"],
        ),
        (
            "hamiltonian = \"m11^2\"\nalgebra = \"so\"\nmomentum = [1, 0]",
            6,
            &["found 2 numbers", "n(n-1)/2"],
        ),
        (
            "hamiltonian = \"m11^2\"\nalgebra = \"so\"\nmomentum = [[1, 0], 0]",
            6,
            &["found numbers beside rows"],
        ),
        (
            "hamiltonian = \"ln(m2)\"\nalgebra = \"so3\"\nmomentum = [1, 0, 0]",
            4,
            &["hamiltonian is -inf at the start"],
        ),
        (
            "hamiltonian = \"sqrt(m2)\"\nalgebra = \"so3\"\nmomentum = [1, 0, 0]",
            4,
            &["hamiltonian: its derivative by m2 is inf at the start"],
        ),
        (
            "inverse_inertia = [[1]]\nalgebra = \"so3\"\nmomentum = [1, 0, 0]",
            4,
            &["is for matrices"],
        ),
        (
            "inverse_inertia = [[1]]\nalgebra = \"gl\"\nmomentum = [[1]]\nhamiltonian = \"m11\"",
            7,
            &["both"],
        ),
        (
            "hamiltonian = \"1\"\nalgebra = \"so(2,2)\"\nmomentum = [[0]]",
            6,
            &["expected p + q = 1"],
        ),
        (
            "hamiltonian = \"1\"\nalgebra = \"su4\"\nmomentum = [[0]]",
            5,
            &["unknown algebra `su4`", "se3"],
        ),
    ] {
        let (at, message) = refused(&format!("kind = \"euler\"\n{keys}"), FINE, "momentum");
        assert_eq!(at, line, "{message}");
        expected.iter().for_each(|part| assert!(message.contains(part), "{message}"));
    }
    let wide = vec![vec![0.0; 10]; 10];
    let problem = format!(
        "kind = \"euler\"\nhamiltonian = \"1\"\nalgebra = \"gl\"\nmomentum = {}",
        text(&wide)
    );
    let (line, message) = refused(&problem, FINE, "momentum");
    assert!(line == 4 && message.contains("at most 9 rows"), "{message}");
    // What so3 does not have.
    let problem =
        "kind = \"euler\"\nalgebra = \"so3\"\nhamiltonian = \"m1^2\"\nmomentum = [1, 0, 0]";
    let (_, message) = refused(problem, FINE, "group");
    assert!(message.contains("this problem has no `group`"), "{message}");
}
