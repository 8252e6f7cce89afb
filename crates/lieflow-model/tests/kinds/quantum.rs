//! States, density matrices and unitary matrices under a given H(t), and spins under given couplings. They are compared
//! with closed solutions.

use super::formulas::{FINE, RKMK4, SAME};
use super::*;

const FINEST: &str = "name = \"rkmk\"\ntableau = \"dop853\"";
/// To rounding of some hundred steps.
const TIGHT: f64 = 1e-11;

/// Of the bundled scene, and of other couplings and rates: the state stays in its eigenstate with the probability
/// 1 − exp(−2πΓ), Γ = g²/(ħv). A span from −T to T changes that by an amplitude of about 2g/(v²T³) at each end.
#[test]
fn landau_zener() {
    let text = bundled("landau-zener");
    for (v, g, hbar) in [(1.0, 0.3, 1.0), (1.0, 0.6, 1.0), (2.0, 0.5, 1.0), (1.0, 0.3, 0.5)] {
        let e = 20.0f64 * v;
        let start = format!("amplitudes = [{:?}, {g}]\nhbar = {hbar}", e + e.hypot(g));
        let text = text
            .replace("v = 1.0", &format!("v = {v:?}"))
            .replace("g = 0.3", &format!("g = {g:?}"))
            .replace("amplitudes = [40.0022498734, 0.3]", &start);
        let of = Scene::parse("scene", &text).unwrap();
        let end = last(&of);
        // p1, p2, their sum.
        let p = 1.0 - (-std::f64::consts::TAU * g * g / (hbar * v)).exp();
        // Of the eigenstate, which is level 2 but for the angle g/E.
        assert!((end[1] - p).abs() < 2.0 * g / e, "{v} {g} {hbar}: {end:?}, expected {p}");
    }
    let of = Scene::parse("scene", &text).unwrap();
    let model = of.model_with(of.layer, &["amplitudes"]).unwrap();
    let mut end = Vec::new();
    let mut sink = |_: f64, row: Row<'_>| end = row.values().to_vec();
    model.run(&of.method, &of.grid, &of.save, &mut sink).unwrap();
    // The upper eigenstate at t = 40, (g, E + vt/2) without its length.
    let (g, e) = (0.3f64, 20.0f64.hypot(0.3));
    let (a, b) = (g, e + 20.0);
    let [re, im] = [0, 2].map(|part| (a * end[part] + b * end[part + 1]) / a.hypot(b));
    let p = 1.0 - (-std::f64::consts::TAU * g * g).exp();
    assert!((re * re + im * im - p).abs() < 1e-5, "{} {p}", re * re + im * im);
}

/// A pulse in resonance turns the state by its area, wherever it is and however short beside the span: steps by error see it.
#[test]
fn pulses_are_not_passed_over() {
    for width in [0.4, 1.6, 3.0, 6.0] {
        for k in 0..8 {
            let centre = 40.0 + 10.37 * f64::from(k);
            let problem = format!(
                "kind = \"schrodinger\"\nenergies = [0, 0]\npulse = [{centre}, {width}]\namplitudes = [1, 0]\n\
                 coupling = [[0, \"0.9/{width}\"], [\"0.9/{width}\", 0]]"
            );
            let method = "name = \"rkmk\"\ntableau = \"dopri5\"";
            let end = last(&scene(
                &problem,
                method,
                "t_span = [0, 150]\nrtol = 1e-6",
                "[\"populations\"]",
            ));
            let exact = (0.9 * std::f64::consts::PI.sqrt()).sin().powi(2);
            assert!((end[1] - exact).abs() < 1e-3, "{centre} {width}: {end:?} {exact}");
        }
    }
}

/// With sine and cosine pulses the transfer is ((W₀² + r² cos WT)/W²)².
#[test]
fn stirap() {
    let text = bundled("stirap");
    for (rabi, t) in [(1.0, 60.0f64), (0.3, 20.0), (2.0, 7.5)] {
        let text = text
            .replace("rabi = 1.0", &format!("rabi = {rabi:?}"))
            .replace("T = 60.0", &format!("T = {t:?}"))
            .replace("[0.0, 60.0]", &format!("[0.0, {t:?}]"));
        let end = last(&Scene::parse("scene", &text).unwrap());
        let (w0, r) = (0.5 * rabi, std::f64::consts::PI / (2.0 * t));
        let w = f64::hypot(w0, r);
        let transfer = ((w0 * w0 + r * r * (w * t).cos()) / (w * w)).powi(2);
        assert!((end[2] - transfer).abs() < TIGHT, "{rabi} {t}: {end:?}, expected {transfer}");
    }
}

/// The same H by energies and a drive, and by formulas, whole and of the upper half; with ħ, in real and complex entries.
#[test]
fn one_hamiltonian_in_all_forms() {
    let start = "amplitudes = [0.6, 0]\namplitudes_imaginary = [0, 0.8]";
    let run = |keys: &str| {
        let problem = format!("kind = \"schrodinger\"\n{keys}\n{start}");
        last(&scene(&problem, RKMK4, FINE, "[\"amplitudes\"]"))
    };
    let drive = run("energies = [-0.5, 0.7]\ncoupling = [[0.1, 0.2], [0.2, 0]]\nfrequency = 1.3\n\
                     coupling_imaginary = [[0, -0.3], [0.3, 0]]\nphase = 0.4");
    let [a, b] = ["cos(1.3*t + 0.4)"; 2];
    for keys in [
        format!(
            "hamiltonian = [[\"-0.5 + 0.1*{a}\", \"0.2*{a}\"], [\"0.2*{b}\", 0.7]]\n\
             hamiltonian_imaginary = [[0, \"-0.3*{a}\"], [\"0.3*{b}\", 0]]"
        ),
        format!(
            "hamiltonian = [[\"-0.5 + 0.1*{a}\", \"0.2*{a}\"], [0.7]]\n\
             hamiltonian_imaginary = [[0, \"-0.3*{a}\"], [0]]"
        ),
        format!(
            "hamiltonian = [[\"-1 + 0.2*{a}\", \"0.4*{a}\"], [1.4]]\nhbar = 2\n\
             hamiltonian_imaginary = [[0, \"-0.6*{a}\"], [0]]"
        ),
    ] {
        assert!(far(&run(&keys), &drive) < SAME, "{keys}");
    }
    // E/h in GHz and t in ns: a level of 1 GHz turns once a nanosecond.
    let level = "hamiltonian = [[1, 0], [0]]\nhbar = 0.15915494309189535";
    let problem = format!("kind = \"schrodinger\"\n{level}\namplitudes = [1, 1]");
    let end = last(&scene(&problem, FINEST, "t_span = [0, 1]\nsteps = 100", "[\"amplitudes\"]"));
    let half = 0.5f64.sqrt();
    assert!(far(&end, &[half, half, 0.0, 0.0]) < TIGHT, "{end:?}");
}

/// A drive that turns, in resonance: ½(1 ± 0.6 cos(rabi t)), against the formula; a pure state as its amplitudes are.
#[test]
fn density_matrices() {
    let text = bundled("thermal-qubit");
    let quarter = text.replace("125.66370614359172", "20.0");
    let of = Scene::parse("scene", &quarter).unwrap();
    let end = last(&of);
    let up = 0.5 * (1.0 + 0.6 * (0.1f64 * 20.0).cos());
    assert!(far(&end, &[up, 1.0 - up, 0.2, 0.8, 0.68]) < TIGHT, "{end:?}");
    let laws = ["trace", "purity", "eigenvalues"];
    assert_eq!(of.problem.invariants(&[]), laws);

    let keys = "hamiltonian = [[\"0.3*t\", \"0.2\", \"0.1*cos(t)\"], [\"-0.2\", \"0.5\"], [\"0.4\"]]\n\
                hamiltonian_imaginary = [[0, \"0.7*sin(t)\", 0], [0, \"0.3\"], [0]]\n\
                amplitudes = [0.6, 0, 0.2]\namplitudes_imaginary = [0, 0.7, -0.1]";
    let run = |kind: &str, quantity: &str| {
        last(&scene(
            &format!("kind = \"{kind}\"\n{keys}"),
            RKMK4,
            FINE,
            &format!("[\"{quantity}\"]"),
        ))
    };
    let psi = run("schrodinger", "amplitudes");
    let rho = run("density-matrix", "density");
    let (re, im) = (&psi[..3], &psi[3..]);
    let upper = (0..3).flat_map(|i| (i..3).map(move |j| (i, j)));
    let mut expected: Vec<f64> = upper.map(|(i, j)| re[i] * re[j] + im[i] * im[j]).collect();
    expected.extend([(0, 1), (0, 2), (1, 2)].map(|(i, j)| im[i] * re[j] - re[i] * im[j]));
    assert!(far(&rho, &expected) < 1e-9, "{rho:?} {expected:?}");
    assert!(far(&run("density-matrix", "eigenvalues"), &[0.0, 0.0, 1.0]) < 1e-13);
}

/// U(n) and SU(n): a column of the propagator is the state, the element stays unitary, and the same by conjugation.
#[test]
fn unitary_groups_by_name() {
    let h = "hamiltonian = [[\"0.3*t\", \"0.2\"], [\"-0.3*t\"]]\nhamiltonian_imaginary = [[0, \"0.7*sin(t)\"], [0]]";
    let state = format!("kind = \"schrodinger\"\n{h}\namplitudes = [1, 0]");
    let psi = last(&scene(&state, RKMK4, FINE, "[\"amplitudes\"]"));
    // f = −iH.
    let f = "field = [[0, \"0.7*sin(t)\"], [\"-0.7*sin(t)\", 0]]\n\
             field_imaginary = [[\"-0.3*t\", \"-0.2\"], [\"-0.2\", \"0.3*t\"]]";
    let ode = |group: &str, more: &str, quantities: &str| {
        let problem = format!("kind = \"matrix-ode\"\ngroup = \"{group}\"\n{f}\n{more}");
        scene(&problem, RKMK4, FINE, quantities)
    };
    for group in ["U(2)", "su", "SU(2)", "u"] {
        let of = ode(group, "", "[\"column\", \"group_defect\"]");
        let columns = ["re11", "re21", "im11", "im21"];
        assert_eq!(of.problem.columns("column").unwrap(), columns);
        let end = last(&of);
        assert!(far(&end[..4], &psi) < SAME && end[4] < 1e-14, "{group}: {end:?}");
    }
    let linear = "action = \"linear\"\nstart = [[1], [0]]\nstart_imaginary = [[0], [0]]";
    assert!(far(&last(&ode("u", linear, "[\"point\"]")), &psi) < SAME);
    // The density matrix of that state, by conjugation.
    let conjugation = "action = \"conjugation\"\nstart = [[1, 0], [0, 0]]";
    let end = last(&ode("u", conjugation, "[\"point\", \"traces\"]"));
    let (a, b) = (psi[0].hypot(psi[2]).powi(2), psi[1].hypot(psi[3]).powi(2));
    let off = [psi[0] * psi[1] + psi[2] * psi[3], psi[2] * psi[1] - psi[0] * psi[3]];
    let point = [a, off[0], off[0], b, 0.0, off[1], -off[1], 0.0];
    assert!(far(&end[..8], &point) < 1e-9, "{end:?} {point:?}");
    assert!(far(&end[8..], &[1.0, 1.0, 0.0, 0.0]) < 1e-13, "{end:?}");
    // f may name the parts of the entries; |y11|² + |y21|² = 1, so this f is half a turn of all.
    let own = "field = [[0]]\nfield_imaginary = [[\"re11^2 + im11^2\"]]";
    let problem = format!("kind = \"matrix-ode\"\ngroup = \"u\"\n{own}");
    let end = last(&scene(&problem, FINEST, FINE, "[\"point\"]"));
    assert!(far(&end, &[2f64.cos(), 2f64.sin()]) < TIGHT, "{end:?}");
}

#[test]
fn hamiltonians_and_unitary_fields_that_are_none_are_refused() {
    let quantum = |keys: &str| format!("kind = \"schrodinger\"\namplitudes = [1, 0]\n{keys}");
    let ode = |keys: &str| format!("kind = \"matrix-ode\"\n{keys}");
    let tail = "\"0.2*exp(-(t - 30)^2/10)\"";
    for (problem, line, parts) in [
        (quantum(""), 2, &["missing key `hamiltonian`"][..]),
        (quantum("energies = [0, 1]"), 2, &["missing key `coupling`"]),
        (
            quantum("energies = [\"-t/2\", \"1/2\"]\ncoupling = [[0, 1], [1, 0]]"),
            5,
            &[
                "`t` may change with time",
                "formulas of t",
                "hamiltonian = [[\"-v*t/2\", \"w\"], [\"v*t/2\"]]",
            ],
        ),
        (
            quantum("energies = [0, 1]\ncoupling = [[0, \"cos(t)\"], [1, 0]]"),
            6,
            &["`t` may change with time", "hamiltonian = [["],
        ),
        // What is no matter of time has the advice of all numbers.
        (
            quantum("energies = [\"v\", 1]\ncoupling = [[0, 1], [1, 0]]"),
            5,
            &["unknown name `v`", "[problem.parameters]"],
        ),
        (
            quantum("hamiltonian = [[0, 1], [0]]\nfrequency = 1"),
            6,
            &["both `hamiltonian` and `frequency`"],
        ),
        (
            quantum("hamiltonian = [[0, 1], [2, 0]]"),
            5,
            &["hamiltonian[2,1] is 2 and hamiltonian[1,2] is 1, expected the same", "left out"],
        ),
        (
            quantum(&format!("hamiltonian = [[0, {tail}], [\"0.1\", 0]]").replace("\"0.1\"", "0")),
            5,
            &["hamiltonian[2,1] is 0 and hamiltonian[1,2] is"],
        ),
        (
            quantum(
                "hamiltonian = [[0, 0], [0]]\nhamiltonian_imaginary = [[0, \"t\"], [\"t\", 0]]",
            ),
            6,
            &["hamiltonian_imaginary[2,1] is 0.5", "at t = 0.5, expected the negative"],
        ),
        (
            quantum("hamiltonian = [[0, 0], [0]]\nhamiltonian_imaginary = [[0, 1], [2]]"),
            6,
            &["hamiltonian_imaginary[2,2] is 2, expected 0"],
        ),
        (quantum("hamiltonian = [[0, 1, 0], [0]]"), 5, &["row 1 has 3 formulas, expected 2"]),
        (quantum("hamiltonian = [[0, 1], [\"x\"]]"), 5, &["hamiltonian[2,1]: unknown name `x`"]),
        (
            quantum("hamiltonian = [[\"1/t\", 1], [0]]"),
            5,
            &["hamiltonian[1,1] is inf at the start"],
        ),
        (quantum("hamiltonian = [[0]]"), 4, &["found 2 numbers, expected 1"]),
        (quantum("hamiltonian = []"), 5, &["found 0 rows"]),
        (quantum("hamiltonian = [[0, 0], [0]]\nhbar = 0"), 6, &["found 0, expected a number > 0"]),
        (ode("group = \"so\"\nfield = [[0]]\nfield_imaginary = [[1]]"), 6, &["real matrices"]),
        (
            ode("group = \"u\"\nfield = [[0, 1], [1, 0]]"),
            5,
            &["the field is not in u(2)", "expected field[2,1] = -field[1,2]", "-iH"],
        ),
        (
            ode("group = \"u\"\nfield = [[0, 0], [0, 0]]\nfield_imaginary = [[1, 2], [3, 4]]"),
            6,
            &["expected field_imaginary[2,1] = field_imaginary[1,2]"],
        ),
        (
            ode("group = \"su\"\nfield = [[0, 0], [0, 0]]\nfield_imaginary = [[1, 2], [2, 4]]"),
            6,
            &["su(2)", "the sum of the imaginary parts of its diagonal is 5"],
        ),
        (ode("group = \"u\"\nfield = [[0]]\nstart = [[0.5]]"), 6, &["start", "g†g = 1"]),
        (
            ode("group = \"su\"\nfield = [[0]]\nstart = [[0]]\nstart_imaginary = [[1]]"),
            6,
            &["its determinant is"],
        ),
        (ode("group = \"u(3)\"\nfield = [[0]]"), 5, &["found 1 row, expected 3 for u(3)"]),
    ] {
        let quantity = if problem.contains("matrix-ode") { "point" } else { "populations" };
        let (at, message) = super::formulas::refused(&problem, FINE, quantity);
        assert!(parts.iter().all(|part| message.contains(part)), "{problem}\n{message}");
        assert_eq!(at, line, "{problem}\n{message}");
    }
    for (keys, part) in [
        ("density = [[1, 2], [2, 1]]", "the least eigenvalue"),
        ("density = [[1, 2], [1, 1]]", "a symmetric matrix"),
        ("density = [[1, 0], [0, 1]]\namplitudes_imaginary = [1, 0]", "both `density`"),
        ("amplitudes = [1, 0]\ndensity_imaginary = [[0, 0], [0, 0]]", "both `amplitudes`"),
        ("amplitudes = [1, 0, 0]", "found 3 numbers, expected 2"),
        ("", "expected `density` or `amplitudes`"),
    ] {
        let problem = format!("kind = \"density-matrix\"\nhamiltonian = [[0, 0], [0]]\n{keys}");
        let (_, message) = super::formulas::refused(&problem, FINE, "populations");
        assert!(message.contains(part), "{message}");
    }
}

/// A wave of wave number k on a ring turns about e₃ at 2 cos θ (J(1 − cos k) + D sin k) + K cos θ + B(t).
#[test]
fn spin_waves_with_all_couplings() {
    let (count, turns, theta) = (10u32, 2.0, 0.8f64);
    let (j, d, anisotropy) = (1.3, 0.4, 0.7);
    let problem = format!(
        "kind = \"spin-chain\"\nwave = {{ count = {count}, turns = {turns}, cone = {theta} }}\n\
         exchange = {j}\ndm = [0, 0, {d}]\nanisotropy = {anisotropy}\nfield = [0, 0, \"0.5*cos(t)\"]"
    );
    let of = scene(&problem, FINEST, FINE, "[\"spins\"]");
    let k = core::f64::consts::TAU * turns / f64::from(count);
    let rate = 2.0 * theta.cos() * (j * (1.0 - k.cos()) + d * k.sin()) + anisotropy * theta.cos();
    let spin = |i: u32| {
        let phase = k * f64::from(i) + 2.0 * rate + 0.5 * 2f64.sin();
        [theta.sin() * phase.cos(), theta.sin() * phase.sin(), theta.cos()]
    };
    let expected: Vec<f64> = (0..count).flat_map(spin).collect();
    assert!(far(&last(&of), &expected) < TIGHT);
}

/// The same as equal numbers in any form; and with couplings of each site as the same equations by parts.
#[test]
fn chains_by_formulas_are_those_by_numbers_and_by_parts() {
    let chain = "kind = \"spin-chain\"\nring = false\nspins = [[0.6, 0.8, 0], [0, 0.6, 0.8], [0.8, 0, 0.6]]";
    let run = |keys: &str| last(&scene(&format!("{chain}\n{keys}"), FINEST, FINE, "[\"spins\"]"));
    let numbers = run("anisotropy = 0.3\nfield = [0.1, -0.2, 0.4]\ndamping = 0.1");
    for keys in [
        "exchange = \"1 + 0*t\"\nanisotropy = [0, 0, 0.3]\nfield = [0.1, -0.2, 0.4]",
        "exchange = [1, 1, \"1 + 0*i\"]\nanisotropy = 0.3\nfield = \"[0.1, -0.2, 0.4]\"",
        "anisotropy = \"K + 0*i\"\nfield = [0.1, -0.2, 0.4]\nparameters = { K = 0.3 }",
    ] {
        assert!(far(&run(&format!("{keys}\ndamping = 0.1")), &numbers) < 1e-13, "{keys}");
    }
    let own = run("exchange = [\"i\", \"2*i\", \"t\"]\ndm = [\"0.2*i\", 0.1, \"sin(t)\"]\n\
                   anisotropy = [0, \"0.3*i\", 0.1]\nfield = [\"cos(t)\", \"i^2\", 0]");
    // H_i = J s_j + D × s_j, H_j = J s_i + s_i × D.
    let parts = "kind = \"composed\"\nparts = [\
        { name = \"a\", space = \"vector\", start = [0.6, 0.8, 0], field = \"ja + cross(da, b) + ka\" }, \
        { name = \"b\", space = \"vector\", start = [0, 0.6, 0.8], field = \"jb + cross(a, da) + jc + cross(db, c) + kb\" }, \
        { name = \"c\", space = \"vector\", start = [0.8, 0, 0.6], field = \"jd + cross(b, db) + kc\" }]\n\
        [problem.let]\n\
        da = [0.2, 0.1, \"sin(t)\"]\ndb = [0.4, 0.1, \"sin(t)\"]\n\
        ja = [\"b1\", \"2*b2\", \"t*b3\"]\njb = [\"a1\", \"2*a2\", \"t*a3\"]\n\
        jc = [\"2*c1\", \"4*c2\", \"t*c3\"]\njd = [\"2*b1\", \"4*b2\", \"t*b3\"]\n\
        ka = [\"cos(t)\", \"1 + 0.3*a2\", \"0.1*a3\"]\nkb = [\"cos(t)\", \"4 + 0.6*b2\", \"0.1*b3\"]\n\
        kc = [\"cos(t)\", \"9 + 0.9*c2\", \"0.1*c3\"]";
    let state = last(&scene(parts, FINEST, FINE, "[\"state\"]"));
    assert!(far(&own, &state) < TIGHT, "{own:?} {state:?}");
}

/// What is kept is stated where it holds, and there it is kept.
#[test]
fn what_chains_keep() {
    let laws = |keys: &str| {
        let problem =
            format!("kind = \"spin-chain\"\nwave = {{ count = 6, turns = 1, cone = 0.7 }}\n{keys}");
        let of = scene(&problem, "name = \"gauss6\"", "t_span = [0, 3]\ndt = 0.02", "[\"spins\"]");
        let laws = of.problem.invariants(&[]);
        let of = scene(
            &problem,
            "name = \"gauss6\"",
            "t_span = [0, 3]\ndt = 0.02",
            &format!("{laws:?}"),
        );
        let rows = rows(&of);
        let (first, end) = (&rows[0][1..], &rows.last().unwrap()[1..]);
        assert!(far(first, end) < 1e-11, "{keys}: {laws:?} {first:?} {end:?}");
        laws.iter().map(|law| law.chars().next().unwrap()).collect::<String>()
    };
    for (keys, expected) in [
        ("dm = [0, 0, 0.3]\nexchange = \"1 + 0.1*i\"", "etl"),
        ("dm = [0.1, 0, 0.3]\nexchange = \"1 + 0.1*i\"", "el"),
        ("exchange = [1, 1, 2]\nanisotropy = \"0.1*i\"", "etl"),
        ("exchange = [1, 1.1, 2]", "el"),
        ("exchange = \"1 + t\"\nfield = [0, 0, \"i*t\"]", "tl"),
        ("field = [\"sin(t)\", 0, 0]", "l"),
        ("anisotropy = [0.1, 0, 0]", "el"),
        ("exchange = [\"t\", \"t\", 1]", "tl"),
        ("exchange = \"2\"\ndamping = 0.1", "l"),
    ] {
        assert_eq!(laws(keys), expected, "{keys}");
    }
    let problem = "kind = \"spin-chain\"\nspins = [[1, 0, 0], [0, 0, 1]]\nfield = [0, 0, \"t\"]";
    let (_, message) = super::formulas::refused(problem, FINE, "energy");
    assert!(message.contains("its couplings depend on t"), "{message}");
    for (keys, part) in [
        ("field = [0, \"1/t\", 0]", "field[2] is inf at the start"),
        ("field = [0, \"1/(i - 2)\", 0]", "field[2] is inf at the start"),
        ("field = [0, 1]", "found 2 formulas, expected 3"),
        ("dm = \"0.2\"", "expected a vector of 3"),
        ("exchange = \"x\"", "unknown name `x`"),
    ] {
        let problem = format!("kind = \"spin-chain\"\nspins = [[1, 0, 0], [0, 0, 1]]\n{keys}");
        let (at, message) = super::formulas::refused(&problem, FINE, "spins");
        assert!(message.contains(part) && at == 5, "{at} {message}");
    }
}
