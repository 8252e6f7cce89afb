//! Named formulas, vectors, and formulas of the columns of a run.

use std::cell::Cell;
use std::time::Instant;

use lieflow::{SaveAt, TimeGrid};
use lieflow_model::problem::Rows;
use lieflow_model::schema::Schema;

use super::formulas::{FINE, RKMK4, refused};
use super::*;

const BODY: &str = "kind = \"driven-body\"\ninertia = [1, 2, 2.5]\nomega_body = [0.5, 0.4, -0.8]\n\
                    attitude = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]";

/// A torque in named formulas and vectors is the same written out; one needs the other in whatever order.
#[test]
fn named_formulas_are_what_they_stand_for() {
    let run = |more: &str| {
        let quantities = "[\"attitude\", \"momentum_space\"]";
        last(&scene(&format!("{BODY}\n{more}"), RKMK4, FINE, quantities))
    };
    // A dipole −k(w × b) in a field that turns in space, b in the body.
    let plain = {
        let b = |i: usize| format!("(g1{i}*cos(n*t) + g3{i}*sin(n*t))");
        let mu = |i: usize, j: usize| format!("(-k*(w{i}*{} - w{j}*{}))", b(j), b(i));
        let mu = [mu(2, 3), mu(3, 1), mu(1, 2)];
        let torque =
            |i: usize, j: usize| format!("\"{}*{} - {}*{}\"", mu[i], b(j + 1), mu[j], b(i + 1));
        format!(
            "torque = [{}, {}, {}]\nparameters = {{ k = 0.3, n = 0.7 }}",
            torque(1, 2),
            torque(2, 0),
            torque(0, 1)
        )
    };
    let expected = run(&plain);
    for named in [
        "torque = \"cross(mu, b)\"\nparameters = { k = 0.3, n = 0.7 }\n[problem.let]\n\
         mu = \"-k*cross(w, b)\"\nb = \"transpose(g)*[cos(n*t), 0, sin(n*t)]\"",
        "torque = [\"mu2*b3 - mu3*b2\", \"mu3*b1 - mu1*b3\", \"mu1*b2 - mu2*b1\"]\n\
         parameters = { k = 0.3, n = 0.7 }\n[problem.let]\nmu = \"-k*cross(w, b)\"\n\
         b1 = \"g11*c + g31*s\"\nb2 = \"g12*c + g32*s\"\nb3 = \"g13*c + g33*s\"\n\
         c = \"cos(n*t)\"\ns = \"sin(n*t)\"",
        "torque = [\"mu2*b3 - mu3*b2\", \"mu3*b1 - mu1*b3\", \"dot(mu, [b2, -b1, 0])\"]\n\
         parameters = { k = 0.3, n = 0.7 }\n[problem.let]\nmu = \"-k*cross(w, b)\"\n\
         b = [\"dot(up, [g11, g21, g31])\", \"dot(up, [g12, g22, g32])\", \"dot([g13, g23, g33], up)\"]\n\
         up = [\"cos(n*t)\", 0, \"sin(n*t)\"]",
    ] {
        assert!(far(&run(named), &expected) < 1e-12, "{named}");
    }
}

/// A matrix is the same as one text and as rows of texts and numbers, in `let` and in formulas of columns.
#[test]
fn a_matrix_may_be_rows_of_formulas() {
    let run = |matrix: &str| {
        let text = format!(
            "[problem]\n{BODY}\ntorque = \"-c*(J*w)\"\nparameters = {{ c = 0.3 }}\n[problem.let]\n\
             J = {matrix}\n[method]\n{RKMK4}\n[time]\n{FINE}\n[output]\nquantities = [\"omega_body\"]\n\
             [output.formulas]\np = {matrix}\n"
        );
        let scene = Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"));
        let columns: Vec<String> =
            scene.model().unwrap().schema().columns().map(str::to_owned).collect();
        (columns, last(&scene))
    };
    let text = run("\"[[2, t/9, 0], [0.25, 1 + t, -t], [0, 3, 0.5]]\"");
    assert_eq!(text.0[3..], ["p11", "p12", "p13", "p21", "p22", "p23", "p31", "p32", "p33"]);
    let rows = run("[[2, \"t/9\", 0], [0.25, \"1 + t\", \"-t\"], [\"0\", 3, 0.5]]");
    assert_eq!(rows, text);
    // One row is no vector.
    let (columns, _) = run("[[2, \"t/9\", 0], [0, 1, 0], [0, 0, 1]]");
    assert_eq!(columns.len(), 12);
}

/// An energy in named formulas has the gradient of what they stand for.
#[test]
fn named_formulas_are_derived() {
    let run = |energy: &str| {
        let problem =
            format!("kind = \"euler\"\nalgebra = \"so3\"\nmomentum = [0.3, -0.2, 1]\n{energy}");
        last(&scene(&problem, RKMK4, FINE, "[\"momentum\", \"energy\"]"))
    };
    let plain = run("hamiltonian = \"m1^2/2 + m2^2 + sqrt(m1^2 + m2^2 + m3^2)*m3^3\"");
    let named =
        run("hamiltonian = \"dot(m, [m1/2, m2, 0]) + cubic\"\nlet.cubic = \"norm(m)*m3^3\"");
    assert!(far(&plain, &named) < 1e-13);
}

/// `[output.formulas]` are columns of any quantity, and of each other; events see them, and named formulas.
#[test]
fn formulas_of_columns() {
    let text = |output: &str, events: &str| {
        format!(
            "title = \"Test\"\n[problem]\n{BODY}\ntorque = \"drag\"\n[problem.let]\ndrag = \"-c*w\"\n\
             tilt = \"acos(g33)\"\nin_space = \"m1 + 1\"\nmomentum_norm = \"2*in_space\"\nangle = \"2*t\"\n[problem.parameters]\nc = 0.3\n[method]\nname = \"rkmk4\"\n\
             [time]\nt_span = [0, 2]\ndt = 0.01\n{events}\n[output]\nquantities = [\"energy\"]\n{output}"
        )
    };
    let output = "plot = [\"theta\", \"energy\"]\n[output.formulas]\ntheta = \"acos(g33)\"\n\
                  power = \"dot(drag, w)\"\ntwice = \"2*energy + 0*theta + t\"\np = \"c*[g31, g32]\"";
    let event = "[[events]]\nname = \"tilted\"\nwhen = \"theta - 0.5\"\n[[events]]\nname = \"same\"\nwhen = \"tilt - 0.5\"\n[[events]]\nname = \"one\"\nwhen = \"angle - 1\"";
    let of = Scene::parse("scene", &text(output, event)).unwrap_or_else(|error| panic!("{error}"));
    assert!(of.plot.iter().map(|figure| &figure.columns[0]).eq(["theta", "energy"]));
    assert_eq!(of.quantities, ["energy", "formulas"]);
    // What formulas need is computed, and is no column.
    assert!(
        of.model()
            .unwrap()
            .schema()
            .columns()
            .eq(["energy", "p1", "p2", "power", "theta", "twice"])
    );
    let model = of.model_with(of.layer, &of.computed()).unwrap();
    let schema = model.schema();
    assert_eq!(schema.get("formulas").unwrap().columns, ["p1", "p2", "power", "theta", "twice"]);
    let (attitude, omega) = (schema.get("attitude").unwrap(), schema.get("omega_body").unwrap());
    let energy = schema.get("energy").unwrap();
    let mut seen = 0;
    let mut sink = |t: f64, row: Row<'_>| {
        let (g, w) = (&row[attitude], &row[omega]);
        let power = -0.3 * w.iter().map(|w| w * w).sum::<f64>();
        let expected = [0.3 * g[6], 0.3 * g[7], power, g[8].acos(), 2.0 * row[energy][0] + t];
        assert!(far(row.of("formulas").unwrap(), &expected) < 1e-15, "{t}");
        seen += 1;
    };
    model.run(&of.method, &of.grid, &of.save, &mut sink).unwrap();
    assert_eq!(seen, 201);
    // Both events are the same function.
    struct Zeros(Vec<(usize, f64)>);
    impl lieflow_model::problem::Watcher for Zeros {
        fn row(&mut self, _: f64, _: Row<'_>) -> lieflow::solve::Next {
            lieflow::solve::Next::Continue
        }
        fn event(&mut self, event: usize, t: f64, _: bool, _: Row<'_>) {
            self.0.push((event, t));
        }
    }
    let model = of.model_with(of.layer, &of.computed()).unwrap();
    let mut zeros = Zeros(Vec::new());
    model.drive(&of.method, of.plan(model.schema()).unwrap(), &mut zeros).unwrap();
    let of_event = |event: usize| -> Vec<f64> {
        zeros.0.iter().filter(|zero| zero.0 == event).map(|zero| zero.1).collect()
    };
    // A name is that of the problem, though a column has it.
    assert!((of_event(2)[0] - 0.5).abs() < 1e-12 && of_event(2).len() == 1, "{:?}", zeros.0);
    assert!(!of_event(0).is_empty() && of_event(0) == of_event(1), "{:?}", zeros.0);

    for (output, events, parts) in [
        (
            "[output.formulas]\ntheta = \"acos(g34)\"",
            "",
            ["formulas.theta: unknown name `g34`", "did you mean `g3"],
        ),
        (
            "[output.formulas]\nw1 = \"acos(g33)\"",
            "",
            ["`w1` is the name of a variable already", "w1 ="],
        ),
        (
            "[output.formulas]\na = \"b\"\nb = \"a\"",
            "",
            ["cannot need itself", "a needs b needs a"],
        ),
        ("plot = [\"theta\"]", "", ["unknown column `theta`", "energy"]),
        ("plot = [\"g33\"]", "", ["unknown column `g33`", "not among what the scene writes"]),
        (
            "",
            "[[events]]\nname = \"x\"\nwhen = \"in_space\"",
            ["`in_space` of [problem.let]", "`m1`"],
        ),
        // Nor does a column with the name of a formula that needs it.
        (
            "",
            "[[events]]\nname = \"x\"\nwhen = \"momentum_norm\"",
            ["`momentum_norm` of [problem.let]", "`m1`"],
        ),
        (
            "[output.formulas]\ntwice = \"2*momentum_norm\"",
            "",
            ["`momentum_norm` of [problem.let]", "`m1`"],
        ),
    ] {
        let error = Scene::parse("scene", &text(output, events)).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(error.contains(part), "{error}"));
    }
}

/// Events of columns, of formulas in `[output.formulas]` and of t.
#[test]
fn events_of_formulas() {
    struct Zeros(Vec<Vec<f64>>);
    impl lieflow_model::problem::Watcher for Zeros {
        fn row(&mut self, _: f64, _: Row<'_>) -> lieflow::solve::Next {
            lieflow::solve::Next::Continue
        }
        fn event(&mut self, event: usize, t: f64, _: bool, _: Row<'_>) {
            self.0[event].push(t);
        }
    }
    let functions = ["m1", "twice - 2*energy", "energy - energy + m1", "t - 1"];
    let events = functions.iter().enumerate();
    let events = events.map(|(i, f)| format!("[[events]]\nname = \"e{i}\"\nwhen = \"{f}\"\n"));
    let formulas = "[output.formulas]\ntwice = \"2*energy + m1\"\n".to_string();
    let text = bundled("ellipsoid-in-fluid") + "\n" + &formulas + &events.collect::<String>();
    let scene = Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"));
    let model = scene.model_with(scene.layer, &scene.computed()).unwrap();
    let mut zeros = Zeros(vec![Vec::new(); functions.len()]);
    model.drive(&scene.method, scene.plan(model.schema()).unwrap(), &mut zeros).unwrap();
    let [first, second, third, time] = &zeros.0[..] else { panic!("four events") };
    assert!(!first.is_empty() && first.len() == second.len(), "{zeros:?}", zeros = zeros.0);
    assert!(far(first, second) < 1e-9 && first == third && far(time, &[1.0]) < 1e-12);
}

/// Where a named formula is wrong it is refused at its line.
#[test]
fn named_formulas_are_refused_at_their_line() {
    for (formulas, expected) in [
        ("b = \"w4\"", &["let.b: unknown name `w4` at character 1"][..]),
        (
            "b = [\"w1\", \"q\", 0]",
            &["let.b[2]: unknown name `q`", "[problem.parameters]", "[problem.let]"],
        ),
        (
            "b = \"cross(w, [1, 2])\"",
            &["let.b: cross of a vector of 3 and a vector of 2, expected two vectors of 3"],
        ),
        ("b = \"w*m\"", &["let.b: a vector of 3 times a vector of 3 at character 2", "dot(a, b)"]),
        ("b = \"w + 1\"", &["a vector of 3 and a number added"]),
        ("b = \"sin(w)\"", &["sin of a vector of 3, expected a number"]),
        ("b = \"w^2\"", &["a vector of 3 to the power of a number", "dot(a, a)"]),
        ("b = []", &["no formulas"]),
        ("b = \"b1 + 1\"", &["cannot need itself: b needs b"]),
        (
            "J = [[\"J1\", 0], [0, 1]]\n[problem.parameters]\nJ1 = 2.0",
            &["let.J: `J1` is a part of `J`, and the name of something else: rename one of them"],
        ),
        ("w1 = \"t\"", &["`w1` is the name of a variable already"]),
        ("w = \"t\"", &["`w` is the name of a vector or a matrix already"]),
        ("g = \"[t, t, t]\"", &["`g` is the name of a vector or a matrix already"]),
        ("cos = \"t\"", &["`cos` is the name of a function"]),
        ("b = true", &["a formula, or a list of formulas"]),
        ("b = [[1, \"t\"], [2]]", &["let.b: row 2 has 1 formula, expected 2"]),
        ("b = [[1, 2], [3, 4], []]", &["let.b: row 3 has 0 formulas, expected 2"]),
        ("b = [[], []]", &["let.b: row 1 has 0 formulas, expected at least 1"]),
        ("b = [[1, 2], [3, \"q\"]]", &["let.b[2,2]: unknown name `q`"]),
        (
            "b = [[1, 2], [3, \"w\"]]",
            &["let.b[2,2]: the value is a vector of 3 numbers, expected one"],
        ),
        (
            "b = [[1, 2], \"w\"]",
            &["found formulas beside rows, expected either formulas or rows of formulas"],
        ),
        ("b = [[[1]]]", &["found a list, expected a formula: a text or a number"]),
    ] {
        let problem = format!("{BODY}\ntorque = [0, 0, 0]\n[problem.let]\n{formulas}");
        let (line, message) = refused(&problem, FINE, "axis");
        assert_eq!(line, 9, "{message}");
        expected.iter().for_each(|part| assert!(message.contains(part), "{message}"));
    }
    for (torque, part) in [
        ("\"w1\"", "torque: the value of this formula is a number, expected a vector of 3"),
        ("[\"w\", 0, 0]", "torque[1]: the value is a vector of 3 numbers, expected one"),
        ("[\"c*w1\", 0, 0]", "a constant is a line `c = 0.5` in [problem.parameters]"),
    ] {
        let (_, message) = refused(&format!("{BODY}\ntorque = {torque}"), FINE, "axis");
        assert!(message.contains(part), "{message}");
    }
}

/// The sizes of terms of a row are the same beside formulas.
#[test]
fn formulas_leave_the_sizes_where_they_were() {
    let top = Scene::bundled("nutating-top").unwrap();
    let sizes = |quantities: &[&str]| {
        let model = top.model_with(top.layer, quantities).unwrap();
        let energy = model.schema().get("energy").unwrap();
        let mut sizes = Vec::new();
        let mut sink = |_: f64, row: Row<'_>| sizes.push(row.size(energy, 0));
        model.run(&top.method, &top.grid, &top.save, &mut sink).unwrap();
        sizes
    };
    let alone = sizes(&["axis", "energy"]);
    assert!(alone.len() > 10 && alone.iter().all(|size| *size > 9.0));
    assert_eq!(sizes(&["axis", "energy", "formulas"]), alone);
}

/// Where an event looks for its zero, what it does not need of a row is not computed.
#[test]
fn an_event_needs_no_other_column() {
    let rest = "[output]\nquantities = [\"energy\"]\n[output.formulas]\nx = \"2*energy\"\ny = \"w1\"\n\
                [[events]]\nname = \"zero\"\nwhen = \"x - w3\"\n";
    let text = format!("[problem]\n{BODY}\n[method]\n{RKMK4}\n[time]\n{FINE}\n{rest}");
    let scene = Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"));
    let model = scene.model_with(scene.layer, &scene.computed()).unwrap();
    let row_of = Cell::new((false, false));
    let mut plan = scene.plan(model.schema()).unwrap();
    plan.events[0].value = Box::new(|t, row| {
        let known = |quantity: &str| row.of(quantity).unwrap().iter().any(|x| x.is_finite());
        row_of.set((known("energy"), known("formulas")));
        t - 0.5
    });
    model.drive(&scene.method, plan, &mut Rows(&mut |_, _| {})).unwrap();
    assert_eq!(row_of.get(), (true, false));
}

/// A column that several quantities have is one number, which a run writes once.
#[test]
fn a_column_of_several_quantities_has_one_value() {
    let mut shared = 0;
    for bundled in BUNDLED {
        let scene = Scene::bundled(bundled.name).unwrap();
        let all = (scene.problem.kind().quantities)();
        let names = all.iter().map(|info| info.name);
        // Each alone is there, and some are of different layers.
        let names: Vec<&str> = names.filter(|name| scene.problem.columns(name).is_ok()).collect();
        let Ok(model) = scene.model_with(scene.layer, &names) else { continue };
        let schema = model.schema();
        let once = Schema::each_column_once(schema);
        assert!(once.len() <= schema.columns().count(), "{}", bundled.name);
        let mut sink = |_: f64, row: Row<'_>| {
            for quantity in schema {
                for (name, x) in quantity.columns.iter().zip(&row[quantity]) {
                    let place = once.iter().find(|(known, _)| known == name).unwrap().1;
                    let known = row.numbers()[place];
                    let same = known.to_bits() == x.to_bits() || (known.is_nan() && x.is_nan());
                    assert!(
                        same,
                        "{}: {name} is {known} and, of {}, {x}",
                        bundled.name, quantity.name
                    );
                }
            }
        };
        let [t0, t1] = scene.grid.t_span();
        let t1 = if t1.is_finite() { t0 + 1e-2 * (t1 - t0) } else { t0 + 0.1 };
        let grid = TimeGrid::with_steps([t0, t1], 3).unwrap();
        model.run(&scene.method, &grid, &SaveAt::Every(1), &mut sink).unwrap();
        shared += usize::from(once.len() < schema.columns().count());
    }
    assert!(shared >= 4, "{shared} scenes with columns of several quantities");
}

/// The names of hundreds of thousands of columns are read at once.
#[test]
fn many_columns_are_read() {
    let text = bundled("spin-wave").replace("count = 8", "count = 65536");
    let begin = Instant::now();
    Scene::parse("scene", &text).unwrap_or_else(|error| panic!("{error}"));
    assert!(begin.elapsed().as_secs_f64() < 10.0, "{:?}", begin.elapsed());
}

/// What is called a defect is a distance from M, and nothing else is.
#[test]
fn distances_are_known() {
    let mut distances = std::collections::BTreeSet::new();
    for scene in BUNDLED {
        let scene = Scene::parse(scene.name, scene.text);
        let Ok(scene) = scene else { continue };
        let problem = &scene.problem;
        let all = (problem.kind().quantities)();
        let names =
            all.iter().map(|quantity| quantity.name).filter(|name| problem.columns(name).is_ok());
        for name in names {
            let model = scene.model_with(scene.layer, &[name]).unwrap();
            let is_distance = model.schema().get(name).unwrap().is_distance;
            assert_eq!(is_distance, name.contains("defect"), "{}: {name}", scene.name);
            distances.extend(is_distance.then_some(name));
        }
    }
    assert!(distances.contains("defects") && distances.len() > 5, "{distances:?}");
}
