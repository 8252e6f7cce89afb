//! Bodies, tops, pendulums and spins against closed forms.

use lieflow::problems::Exact;
use lieflow_model::kinds::RigidBodySpec;
use nalgebra::{Matrix3, Vector3};

use super::*;
use lieflow_model::problem::Rows;

const FINE: &str = "t_span = [0, 2]\ndt = 0.005";
const RKMK4: &str = "name = \"rkmk4\"";

/// In three dimensions the body in n is the body in three: m₁₂ = −m₃, m₁₃ = m₂, m₂₃ = −m₁.
#[test]
fn the_body_in_n_dimensions() {
    let problem = "kind = \"rigid-body-n\"\ninertia = [3, 2, 1]\nmomentum = [-3.0, 0.1, -0.2]";
    let end = last(&scene(problem, RKMK4, FINE, "[\"momentum\"]"));
    let exact = Exact::new([1.0, 2.0, 3.0], [0.2, 0.1, 3.0], Matrix3::identity()).unwrap();
    let m = exact.momentum_body(2.0).unwrap();
    assert!(far(&end, &[-m[2], m[1], -m[0]]) < 1e-8);
}

/// Manakov's body has two further integrals in four dimensions, and another body none.
#[test]
fn manakovs_integrals_are_those_of_his_body() {
    let summary = |problem: &str| {
        let of = scene(problem, RKMK4, FINE, "[\"momentum\"]");
        let laws = of.problem.invariants(&["momentum"]);
        (laws, of.problem.columns("manakov_integrals").ok().map(|columns| columns.len()))
    };
    let momentum = "momentum = [1.0, -0.4, 0.3, 0.8, 0.2, -0.6]";
    let kind = "kind = \"rigid-body-n\"";
    let his = summary(&format!("{kind}\nmass_moments = [0.4, 1.1, 1.9, 2.5]\n{momentum}"));
    assert_eq!(his, (vec!["energy", "casimirs", "manakov_integrals"], Some(2)));
    let another = summary(&format!("{kind}\ninertia = [1, 2, 3, 4, 5, 6]\n{momentum}"));
    assert_eq!(another, (vec!["energy", "casimirs"], None));
}

/// Lagrange's top that leans by θ and precesses steadily at Ω: see `tests/problems/library/heavy_top.rs`.
#[test]
fn steady_precession_of_a_top() {
    let (a, c, w, theta, rate) = (1.2, 0.5, 2.0, 0.7f64, 0.9);
    let spin = (a * rate * rate * theta.cos() + w) / (c * rate);
    let at = |t: f64| {
        let phase = (rate * theta.cos() - spin) * t;
        let gamma = Vector3::new(theta.sin() * phase.cos(), theta.sin() * phase.sin(), theta.cos());
        let mu = a * rate * gamma + Vector3::z() * (c * spin - a * rate * theta.cos());
        [mu.as_slice(), gamma.as_slice()].concat()
    };
    let start = at(0.0);
    let problem = format!(
        "kind = \"heavy-top\"\ninertia = [{a}, {a}, {c}]\nweight = [0, 0, {w}]\nmomentum_body = \
         {:?}\nvertical = {:?}",
        &start[..3],
        &start[3..]
    );
    let of = scene(&problem, RKMK4, FINE, "[\"momentum_body\", \"vertical\"]");
    assert!(far(&last(&of), &at(2.0)) < 1e-7);
    // μ₃ is its fourth integral; a top that leans has none.
    let laws = |text: &str| {
        let of = scene(text, RKMK4, FINE, "[\"vertical\"]");
        of.problem.invariants(&[]).contains(&"integral")
    };
    assert!(laws(&problem));
    assert!(!laws(&problem.replace("weight = [0, 0,", "weight = [0.1, 0,")));
}

/// Without a linear momentum a body in a fluid is a free body.
#[test]
fn a_body_in_a_fluid_at_rest() {
    let problem = "kind = \"kirchhoff\"\ninertia = [1, 2, 3]\nmass = [1, 2, 1.5]\n\
                   angular_momentum = [0.2, 0.1, 3]\nlinear_momentum = [0, 0, 0]";
    let end = last(&scene(problem, RKMK4, FINE, "[\"angular_momentum\"]"));
    let exact = Exact::new([1.0, 2.0, 3.0], [0.2, 0.1, 3.0], Matrix3::identity()).unwrap();
    assert!(far(&end, exact.momentum_body(2.0).unwrap().as_slice()) < 1e-8);
}

/// Kirchhoff's equations are Euler's with this energy as a formula, by the methods of both and by Lie series.
#[test]
fn a_body_in_a_fluid_is_a_hamiltonian_on_se3() {
    let body = "kind = \"kirchhoff\"\ninertia = [1, 2, 3]\nmass = [1.5, 1.2, 0.7]\n\
                angular_momentum = [0.3, 0.6, 1.0]\nlinear_momentum = [0.7, 0.4, 1.0]";
    let energy = "kind = \"euler\"\nalgebra = \"se3\"\nmomentum = [0.3, 0.6, 1.0, 0.7, 0.4, 1.0]\n\
                  hamiltonian = \"m1^2/2 + m2^2/4 + m3^2/6 + p1^2/3 + p2^2/2.4 + p3^2/1.4\"";
    let quantities = "[\"angular_momentum\", \"linear_momentum\"]";
    let by_formula = last(&scene(energy, RKMK4, FINE, "[\"momentum\"]"));
    assert!(far(&last(&scene(body, RKMK4, FINE, quantities)), &by_formula) < 1e-13);
    let series = "name = \"taylor12\"";
    assert!(far(&last(&scene(body, series, FINE, quantities)), &by_formula) < 1e-8);
}

/// H = ½Σ(mᵢ²/Jᵢ + pᵢ²/Mᵢ), |p|², m·p, and |m||p| as the size of its terms.
#[test]
fn the_quantities_of_a_body_in_a_fluid() {
    let problem = "kind = \"kirchhoff\"\ninertia = [1, 2, 4]\nmass = [1, 2, 8]\n\
                   angular_momentum = [1, 2, 2]\nlinear_momentum = [3, 0, 4]";
    let of = scene(problem, RKMK4, FINE, "[\"energy\"]");
    let names = ["energy", "linear_norm2", "momenta_product"];
    let model = of.model_with(of.layer, &names).unwrap();
    let product = model.schema().get("momenta_product").unwrap();
    let mut rows = Vec::new();
    let mut sink = |_: f64, row: lieflow_model::schema::Row<'_>| {
        rows.push([row.values(), &[row.size(product, 0)]].concat());
    };
    model.run(&of.method, &of.grid, &of.save, &mut sink).unwrap();
    assert!(far(&rows[0], &[7.5, 25.0, 11.0, 15.0]) < 1e-14);
    assert_eq!(of.problem.invariants(&[]), names);
}

/// At the height q₃ = −cos θ the pendulum goes round at Ω² = (g/ℓ)/cos θ.
#[test]
fn the_conical_pendulum() {
    let (g, theta) = (9.81, 0.6f64);
    let rate = (g / theta.cos()).sqrt();
    let problem = format!(
        "kind = \"spherical-pendulum\"\ngravity_over_length = {g}\ndirection = [{}, 0, {}]\n\
         velocity = [0, {}, 0]",
        theta.sin(),
        -theta.cos(),
        theta.sin() * rate
    );
    let end = last(&scene(&problem, RKMK4, FINE, "[\"direction\"]"));
    let (s, c) = (2.0 * rate).sin_cos();
    assert!(far(&end, &[theta.sin() * c, theta.sin() * s, -theta.cos()]) < 1e-7);
}

/// A spin wave of wave number k on a ring turns about e₃ at 2 cos θ (1 − cos k).
#[test]
fn spin_waves() {
    let (count, turns, theta) = (10u32, 2.0, 0.8f64);
    let problem = format!(
        "kind = \"spin-chain\"\nwave = {{ count = {count}, turns = {turns}, cone = {theta} }}"
    );
    let end = last(&scene(&problem, RKMK4, FINE, "[\"spins\"]"));
    let k = core::f64::consts::TAU * turns / f64::from(count);
    let rate = 2.0 * theta.cos() * (1.0 - k.cos());
    let spin = |i: u32| {
        let phase = k * f64::from(i) + 2.0 * rate;
        [theta.sin() * phase.cos(), theta.sin() * phase.sin(), theta.cos()]
    };
    let expected: Vec<f64> = (0..count).flat_map(spin).collect();
    assert!(far(&end, &expected) < 1e-8);
    // Damping takes the energy and the total spin from what is kept.
    let laws = |more: &str| {
        let of = scene(&format!("{problem}\n{more}"), RKMK4, FINE, "[\"spins\"]");
        of.problem.invariants(&[]).len()
    };
    assert_eq!([laws(""), laws("field = [0.1, 0, 0]"), laws("damping = 0.1")], [3, 2, 1]);
}

#[test]
fn many_bodies_are_each_alone() {
    let text = bundled("many-bodies").replace("dt = 0.02", "dt = 0.005");
    let of = Scene::parse("scene", &text).unwrap();
    let exact = of.model().unwrap().exact([0.0, 20.0]).unwrap().unwrap();
    assert_eq!(exact.len(), 16);
    assert!(far(&last(&of), &exact) < 1e-5);
}

/// By its quaternion a body moves as by its matrix, in the scene's own frame.
#[test]
fn a_body_by_its_quaternion() {
    let quantities = "[\"attitude\", \"momentum_body\"]";
    let (s, c) = 0.4f64.sin_cos();
    let start = format!("[{c}, 0, {s}, 0]"); // about e2 by 0.8
    let rows = "[[0.6967067093471654, 0, 0.7173560908995228], [0, 1, 0], [-0.7173560908995228, 0, \
                0.6967067093471654]]";
    for inertia in ["[1, 2, 3]", "[[1.5, 0.2, -0.1], [0.2, 2.0, 0.3], [-0.1, 0.3, 2.5]]"] {
        let body =
            format!("kind = \"rigid-body\"\ninertia = {inertia}\nomega_body = [0.3, 0.5, 1]");
        let run = |attitude: &str, method: &str, quantities: &str| {
            let of = scene(&format!("{body}\n{attitude}"), method, FINE, quantities);
            (of.model().unwrap().modelled(&of.method)[0].clone(), last(&of))
        };
        let quaternion = format!("quaternion = {start}");
        let (modelled, q) = run(&quaternion, RKMK4, quantities);
        assert!(modelled.contains("quaternion"), "{modelled}");
        let (_, g) = run(&format!("attitude = {rows}"), RKMK4, quantities);
        assert!(far(&q, &g) < 1e-12, "{inertia}");
        for method in
            ["name = \"exact\"", "name = \"mr10\"", "name = \"dmv10\"", "name = \"gauss6\""]
        {
            assert!(far(&run(&quaternion, method, quantities).1, &g) < 1e-8, "{method}");
        }
        // w, x, y, z, and the rotation that they are.
        let (_, wxyz) = run(&quaternion, RKMK4, "[\"quaternion\", \"quaternion_defect\"]");
        let [w, x, y, z] = [wxyz[0], wxyz[1], wxyz[2], wxyz[3]];
        assert!(far(&[1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z)], &q[..2]) < 1e-13);
        assert!(wxyz[4] < 1e-14);
        // The same from the matrix, up to the sign.
        let (_, of_g) = run(&format!("attitude = {rows}"), RKMK4, "[\"quaternion\"]");
        assert!(
            of_g[0] >= 0.0
                && far(&of_g, &wxyz[..4].iter().map(|x| x * w.signum()).collect::<Vec<_>>())
                    < 1e-12
        );
    }
    // What is not asked for is not modelled.
    let body = "kind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0.3, 0.5, 1]\n\
                quaternion = [1, 0, 0, 0]";
    let of = scene(body, RKMK4, FINE, "[\"energy\"]");
    assert_eq!(of.model().unwrap().modelled(&of.method), ["momentum on so(3)*"]);
}

/// The torques that are named, and no other.
#[test]
fn torques_are_modelled_where_they_are_named() {
    let body = "kind = \"driven-body\"\ninertia = [1, 2, 2.5]";
    let run = |more: &str, quantities: &str| {
        let of = scene(&format!("{body}\n{more}"), RKMK4, FINE, quantities);
        (of.model().unwrap().modelled(&of.method)[0].clone(), last(&of))
    };
    let spin = "omega_body = [0.5, 0.4, -0.8]";
    let (modelled, free) = run(spin, "[\"momentum_space\"]");
    assert!(modelled.ends_with("no torque"), "{modelled}");
    assert_eq!(free, [0.5, 0.8, -2.0], "constant, bit for bit");
    // A motor about the third axis: Jω = Jω₀ + t.
    let motor = "omega_body = [0, 0, 0.3]\nthruster = [0, 0, 1]";
    let (modelled, spun) = run(motor, "[\"omega_body\", \"angle\"]");
    assert!(modelled.ends_with("torques: thruster"), "{modelled}");
    let angle: f64 = 0.3 * 2.0 + 2.0 / 2.5;
    assert!(far(&spun, &[0.0, 0.0, 0.3 + 2.0 / 2.5, angle]) < 1e-12);
    // Damping about a principal axis: ω = ω₀ e^{−ct/J}.
    let (_, damped) = run("omega_body = [0, 0.7, 0]\ndamping = 0.5", "[\"omega_body\"]");
    assert!(far(&damped, &[0.0, 0.7 * (-0.5f64).exp(), 0.0]) < 1e-11);
    // Gravity makes the heavy top of se(3)*.
    let top = "kind = \"heavy-top\"\ninertia = [1, 2, 2.5]\nweight = [0.2, -0.1, 0.9]\nvertical = [0, \
               0, 1]";
    let of = scene(&format!("{top}\n{spin}"), RKMK4, FINE, "[\"omega_body\", \"energy\"]");
    let weight = format!("{spin}\nweight = [0.2, -0.1, 0.9]");
    let (_, with_attitude) = run(&weight, "[\"omega_body\", \"energy\"]");
    assert!(far(&last(&of), &with_attitude) < 1e-9);
    // The law brings the attitude home.
    let end = last(&Scene::bundled("attitude-control").unwrap());
    assert!(end.iter().all(|x| x.abs() < 1e-4), "{end:?}");
}

/// A box by its sides; a tensor by its principal axes, and everything shown in the scene's own frame.
#[test]
fn moments_of_inertia_from_shapes_and_tensors() {
    let of = |inertia: &str, quantities: &str| {
        let body = format!("kind = \"rigid-body\"\n{inertia}\nomega_body = [0.3, 0.5, 1.0]");
        scene(&body, "name = \"exact\"", "t_span = [0, 3]\nsteps = 3", quantities)
    };
    let moments = |inertia: &str| {
        let scene = of(inertia, "[\"energy\"]");
        scene.problem.spec::<RigidBodySpec>().unwrap().inertia
    };
    let shapes = [
        ("kind = \"box\", mass = 12, sides = [1, 2, 3]", [13.0, 10.0, 5.0]),
        ("kind = \"ellipsoid\", mass = 5, semi_axes = [1, 2, 3]", [13.0, 10.0, 5.0]),
        ("kind = \"cylinder\", mass = 12, radius = 1, height = 2", [7.0, 7.0, 6.0]),
    ];
    for (shape, expected) in shapes {
        assert!(far(&moments(&format!("shape = {{ {shape} }}")), &expected) < 1e-14, "{shape}");
    }

    // The same body, its axes turned by a quarter about e₃: J₁ and J₂ change places.
    let quantities = "[\"momentum_body\", \"omega_body\", \"attitude\", \"energy\"]";
    let axes = last(&of("inertia = [1, 2, 3]", quantities));
    let tensor = last(&of("inertia = [[1, 0, 0], [0, 2, 0], [0, 0, 3]]", quantities));
    assert!(far(&axes, &tensor) < 1e-13);
    // A tensor that is not diagonal, by the equation: J ω̇ + ω × Jω = 0 and ġ = g ω̂ from rows.
    let crooked = "inertia = [[1.5, 0.2, -0.1], [0.2, 2.0, 0.3], [-0.1, 0.3, 2.5]]";
    let short = |t: f64| {
        let body = format!("kind = \"rigid-body\"\n{crooked}\nomega_body = [0.3, 0.5, 1.0]");
        let time = format!("t_span = [0, {t}]\nsteps = 1");
        last(&scene(&body, "name = \"exact\"", &time, quantities))
    };
    let j = Matrix3::new(1.5, 0.2, -0.1, 0.2, 2.0, 0.3, -0.1, 0.3, 2.5);
    let (omega, h) = (Vector3::new(0.3, 0.5, 1.0), 1e-4);
    let (ahead, behind) = (short(h), short(-h));
    let rate = |i: usize| (ahead[i] - behind[i]) / (2.0 * h);
    let m = j * omega;
    let expected = m.cross(&omega);
    for i in 0..3 {
        assert!((rate(i) - expected[i]).abs() < 1e-7, "{} {}", rate(i), expected[i]);
        assert!((0.5 * (ahead[3 + i] + behind[3 + i]) - omega[i]).abs() < 1e-7);
    }
    let hat =
        Matrix3::new(0.0, -omega[2], omega[1], omega[2], 0.0, -omega[0], -omega[1], omega[0], 0.0);
    for (i, entry) in hat.transpose().iter().enumerate() {
        assert!((rate(6 + i) - entry).abs() < 1e-7);
    }

    // No body has these moments: a warning, not an error.
    assert_eq!(of("inertia = [1, 2, 3]", "[\"energy\"]").problem.warnings(), [""; 0]);
    let body = of("inertia = [1, 2, 3.1]", "[\"energy\"]");
    let warnings = body.problem.warnings();
    assert!(
        warnings.len() == 1 && warnings[0].contains("J3 > J1 + J2 (3.1 > 1 + 2): impossible"),
        "{warnings:?}"
    );
}

/// Equations that depend on time, from any start, forward and backward: a moment in a turning field, and a
/// beam line whose elements end where steps do.
#[test]
fn exact_solutions_from_any_start() {
    let spin = "kind = \"spin\"\nfield = [0.3, 0.1, 1.0]\nrate = 0.9\nmoment = [0.2, -0.5, 1.0]";
    let beam = "kind = \"beam-line\"\nparticle = [1, 1, 0, 0]\nelements = [\n\
                { kind = \"quadrupole\", length = 0.5, k = 1.2 },\n\
                { kind = \"dipole\", length = 1.0, radius = 8.0 },\n\
                { kind = \"quadrupole\", length = 0.5, k = -1.2 },\n\
                { kind = \"drift\", length = 0.25 }]";
    for span in ["[0, 4.5]", "[0.75, 41.25]", "[-3.5, 6.0]", "[2.25, -1.75]"] {
        for (problem, quantity, method, dt) in
            [(spin, "moment", "magnus8", 0.01), (beam, "map", "cfm4-2", 0.25)]
        {
            let time = format!("t_span = {span}\ndt = {dt}");
            let quantities = format!("[{quantity:?}]");
            let of = scene(problem, &format!("name = {method:?}"), &time, &quantities);
            let model = of.problem.model(of.layer, &[quantity]).unwrap();
            let exact = model.exact(of.grid.t_span()).unwrap().unwrap();
            let size = exact.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
            let gap = far(&last(&of), &exact) / size;
            assert!(gap < 1e-11, "{quantity}, {span}: {gap:e}");
        }
    }
}

/// At the ends of cells, whose length is no binary fraction, quotient and remainder of rounded numbers may be those of
/// different cells.
#[test]
fn the_exact_map_of_whole_cells_is_a_power() {
    for (length, k) in [(1.3, 0.4), (0.7, 0.9), (0.1, 3.0)] {
        let keys = format!(
            "kind = \"beam-line\"\nparticle = [1, 1, 0, 0]\nelements = [\n\
             {{ kind = \"quadrupole\", length = {length}, k = {k} }},\n\
             {{ kind = \"quadrupole\", length = {length}, k = -{k} }}]"
        );
        for cells in 1..60 {
            // Both roundings of the end.
            for end in [f64::from(cells) * (2.0 * length), (f64::from(20 * cells) * length) / 10.0]
            {
                let time = format!("t_span = [0, {end:?}]\nat_knots = true\ndt = {length}");
                let of = scene(&keys, "name = \"magnus4\"", &time, "[\"map\"]");
                let exact = of.model().unwrap().exact([0.0, end]).unwrap().unwrap();
                let gap = far(&last_at_stops(&of), &exact);
                assert!(gap < 1e-10, "{length}, {cells}, {end}: {gap:e}");
            }
        }
    }
}

/// Where magnets end, a step of the grid may end a rounding before, and its last stage a rounding behind. The lengths are
/// no binary fractions.
#[test]
fn steps_between_magnets_keep_their_order() {
    for method in ["rkmk4", "cg4", "rk4", "rkmk dop853 exp"] {
        for (length, span) in [
            (0.7, [0.0, 15.0]),
            (1.3, [0.3, 20.0]),
            (0.7, [1000.25, 1020.25]),
            // Backward, also from where a magnet or a cell ends.
            (1.3, [20.0, 0.3]),
            (0.7, [11.4, 0.25]),
            (0.7, [11.0, 0.0]),
        ] {
            let keys = format!(
                "kind = \"beam-line\"\nparticle = [1, 1, 0, 0]\nelements = [\n\
                 {{ kind = \"quadrupole\", length = 0.4, k = 1.2 }},\n\
                 {{ kind = \"drift\", length = {length} }},\n\
                 {{ kind = \"quadrupole\", length = 0.4, k = -1.2 }},\n\
                 {{ kind = \"drift\", length = {length} }}]"
            );
            let gap = |dt: f64| {
                let time = format!("t_span = {span:?}\nat_knots = true\ndt = {dt}");
                let of = scene(&keys, &format!("name = {method:?}"), &time, "[\"map\"]");
                let exact = of.model().unwrap().exact(span).unwrap().unwrap();
                let size = exact.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
                far(&last_at_stops(&of), &exact) / size
            };
            let (long, short) = (gap(0.05), gap(0.025));
            let what = format!("{method}, {length}, {span:?}: {long:e}, {short:e}");
            assert!(long < 1e-5, "{what}");
            assert!(short < long / 12.0 || short < 1e-11, "{what}");
        }
    }
}

/// The last row of a run whose steps end at the knots.
pub(crate) fn last_at_stops(of: &Scene) -> Vec<f64> {
    let (model, mut end) = (of.model().unwrap(), Vec::new());
    let plan = of.plan(model.schema()).unwrap();
    let mut sink = |_: f64, row: Row<'_>| end = row.values().to_vec();
    model.drive(&of.method, plan, &mut Rows(&mut sink)).unwrap();
    end
}
