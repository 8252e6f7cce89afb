//! Numbers that are formulas of the parameters of a scene.

use lieflow_model::reader::Tree;

use super::*;

/// Many parameters that need each other in a row are a mistake, and no crash.
#[test]
fn a_long_chain_of_parameters_is_refused() {
    let chain = |n: usize| {
        let links: String = (1..n).map(|i| format!("p{i} = \"p{}\"\n", i + 1)).collect();
        let text = format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, \"p1\"]\nomega_body = [0, 0, 1]\n\
             [problem.parameters]\n{links}p{n} = 3\n[time]\nt_span = [0, 1]\n"
        );
        Scene::parse("chain", &text)
    };
    assert!(chain(200).is_ok());
    let message = chain(5_000).unwrap_err().to_string();
    assert!(message.contains("expected at most 256 parameters that need each other"), "{message}");
}

/// A whole number may be written as a number, and a place in a matrix as two.
#[test]
fn whole_numbers_and_places() {
    let of = |lines: &str| {
        let text = format!(
            "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [0, 0, 1]\n[time]\nt_span = [0, 1]\n{lines}\n"
        );
        Scene::parse("scene", &text)
    };
    assert_eq!(of("steps = 1e3").unwrap().grid, of("steps = 1000").unwrap().grid);
    for steps in ["2.5", "-1e3", "1e16", "nan"] {
        let message = of(&format!("steps = {steps}")).unwrap_err().to_string();
        assert!(message.contains("expected a whole number, at least 1"), "{message}");
    }
    let message =
        of("steps = 10\n[output]\nevery = 1\ncount = 4\ntimes = [1]").unwrap_err().to_string();
    assert!(
        message.contains("`every`, `times` and `count`, expected at most one of them"),
        "{message}"
    );
    let entry = |place: &str| {
        let scene = std::path::Path::new("rotating-drive");
        Scene::open_with(scene, &[format!("problem.field{place}=\"cos(2*t)\"")])
    };
    assert_eq!(entry("[1,3]").unwrap().text, entry("[1][3]").unwrap().text);
    for place in ["[0, 3]", "[1,]", "[1;3]", "[1"] {
        let message = entry(place).unwrap_err().to_string();
        assert!(message.contains("expected a place from 1, such as [1] or [1, 2]"), "{message}");
    }
}

/// Each place that takes a number takes a formula: both scenes are the same problem.
#[test]
fn formulas_stand_for_numbers_of_every_shape() {
    let constants = "[problem.parameters]\nm = 3\nhalf = \"m/6\"\nw = \"2*half\"\n\n[method]";
    for (name, number, formula) in [
        ("asymmetric-top", "inertia = [1.0, 2.0, 3.0]", "inertia = [\"w\", \"4*half\", \"m\"]"),
        // Rows of numbers.
        (
            "asymmetric-top",
            "inertia = [1.0, 2.0, 3.0]",
            "inertia = [[1, 0, 0], [0, \"w + 1\", 0], [0, 0, \"m\"]]",
        ),
        // A table of a shape.
        ("flipping-book", "mass = 0.5", "mass = \"half\""),
        // A number in a list of tables, and a whole one.
        ("vortices-on-sphere", "width = 0.25", "width = \"half/2\""),
        ("vortices-on-sphere", "n = 24", "n = \"8*m\""),
        ("many-bodies", "inertia = [1.0, 1.0, 2.0]", "inertia = [\"w\", 1, \"m - 1\"]"),
        ("sorting", "  [4.0, 0.1,", "  [\"m + 1\", 0.1,"),
        ("fodo-cell", "length = 0.25 }", "length = \"half^2\" }"),
        ("mathieu", "q = 0.3", "q = \"m/10\""),
        ("spin-wave", "cone = 0.8", "cone = \"8/10\""),
        ("ellipsoid-in-fluid", "mass = [1.5,", "mass = [\"m/2\","),
        ("rabi", "amplitudes = [1.0, 0.0]", "amplitudes = [\"w\", 0]"),
        ("toda-lattice", "momenta = [1.0,", "momenta = [\"cos(0*m)\","),
        // The times and the rows know the parameters, too.
        ("mathieu", "t_span = [0.0, ", "t_span = [\"0*m\", "),
    ] {
        let text = bundled(name);
        assert!(text.contains(number), "{name} has no {number}");
        let with = text.replacen(number, formula, 1);
        let with = with.replacen("[method]", constants, 1);
        assert!(with.contains("[problem.parameters]"));
        let [plain, with] = [&text, &with]
            .map(|text| Scene::parse(name, text).unwrap_or_else(|error| panic!("{name}: {error}")));
        let start = |scene: &Scene| scene.model().unwrap().start(&scene.method).unwrap();
        let (a, b) = (start(&plain), start(&with));
        assert!(far(&a, &b) < 1e-13, "{name} {formula}: {a:?} {b:?}");
        assert_eq!(plain.grid.t_span()[0], with.grid.t_span()[0]);
        // The scene is shown as it is written.
        assert!(with.text.contains(formula));
        if !formula.contains("t_span") {
            let written = format!("Text(\"{}\")", formula.split('"').nth(1).unwrap());
            assert!(format!("{:?}", with.keys).contains(&written), "{written}: {:?}", with.keys);
        }
    }
}

/// Sections besides the problem.
#[test]
fn times_and_rows_are_formulas() {
    let text = "[problem]\nkind = \"spin\"\nfield = [0, 0, 1]\nrate = \"w\"\nmoment = [1, 0, 0]\n\
                [problem.parameters]\nw = \"6*rpm\"\nn = 4\n[time]\nt_span = [0, \"2*pi/w\"]\n\
                steps = \"10*n\"\n[output]\ninterval = \"pi/(n*w)\"\n\
                [[events]]\nname = \"zero\"\nwhen = \"x1\"\nstop_after = \"n - 1\"\n";
    let scene = Scene::parse("scene", text).unwrap_or_else(|error| panic!("{error}"));
    let [t0, t1] = scene.grid.t_span();
    assert!(t0 == 0.0 && (t1 - 10.0).abs() < 1e-14, "{t1}");
    assert_eq!(scene.grid.steps(), 40);
    assert_eq!(
        scene.save,
        lieflow::SaveAt::Interval(
            std::f64::consts::PI / (4.0 * 6.0 * std::f64::consts::TAU / 60.0)
        )
    );
    assert_eq!(scene.events[0].stop_after, Some(3));
}

#[test]
fn units_of_angles_are_radians() {
    for (formula, expected) in [
        ("180*deg", core::f64::consts::PI),
        ("60*rpm", core::f64::consts::TAU),
        ("rev", core::f64::consts::TAU),
        ("turn/2", core::f64::consts::PI),
        ("60*60*arcsec - 1*deg", 0.0),
        ("60*arcmin - 1*deg", 0.0),
        ("2*rad", 2.0),
    ] {
        let problem = format!(
            "kind = \"rigid-body\"\ninertia = [1, 2, 3]\nmomentum_body = [0, 0, \"{formula}\"]"
        );
        let of = scene(
            &problem,
            "name = \"rkmk4\"",
            "t_span = [0, 1]\nsteps = 1",
            "[\"momentum_body\"]",
        );
        let start = of.model().unwrap().start(&of.method).unwrap();
        assert!((start[2] - expected).abs() < 1e-15, "{formula}: {start:?}");
    }
}

/// What is wrong with a number that is a formula: the place of the character, and what to do.
#[test]
fn formulas_that_are_no_numbers_are_refused_at_their_character() {
    const LINE: &str = "inertia = [1, 2, ";
    for (formula, column, words) in [
        ("5 deg", 21, &["\"5 deg\" is not a number: found `d`", "= write 5*deg"][..]),
        ("1e-5 N m s", 24, &["write 1e-5; units are left out, but for those of angles"]),
        ("2*0.1 s", 25, &["write 0.1; units are left out"]),
        ("1j*w", 20, &["an imaginary part 1 has a key of its own"]),
        ("5 deg/s", 21, &["write 5*deg", "other units than those of angles are left out"]),
        ("5deg", 20, &["write 5*deg"]),
        ("5°", 20, &["found `°`", "degrees are written 5*deg"]),
        ("2*degrees", 21, &["unknown name `degrees`", "did you mean `deg`?"]),
        ("2*mas", 21, &["unknown name `mas`", "did you mean `mass`?", "[problem.parameters]"]),
        ("2*t", 21, &["`t` may change with time", "before the run"]),
        ("3 + w1", 23, &["`w1` may change with time", "before the run"]),
        ("1/0", 18, &["the value of \"1/0\" is inf, expected a finite number"]),
        ("sqrt(-mass)", 18, &["is NaN, expected a finite number"]),
        ("[1, 2]", 18, &["is a vector of 2 numbers, expected a number"]),
        ("1 - mass", 18, &["inertia[3] = -2, expected", "the value of \"1 - mass\" is -2"]),
        ("mass*", 18, &["is not a number: the formula ends here"]),
        ("", 18, &["\"\" is not a number"]),
    ] {
        let text = format!(
            "[problem]\nkind = \"rigid-body\"\n{LINE}\"{formula}\"]\nomega_body = [1, 2, 3]\n\
             [problem.parameters]\nmass = 3\n[time]\nt_span = [0, 1]\n"
        );
        let message = Scene::parse("scene", &text).unwrap_err().to_string();
        assert!(message.starts_with(&format!("scene:3:{column}: ")), "{formula}: {message}");
        words.iter().for_each(|word| assert!(message.contains(word), "{formula}: {message}"));
        assert!(!message.contains(" mistakes"), "{message}");
    }
}

#[test]
fn parameters_that_are_no_numbers_are_refused() {
    for (parameters, words) in [
        ("a = \"b\"\nb = \"2*a\"", &["a number cannot need itself: a needs b needs a"][..]),
        ("a = \"a\"", &["a number cannot need itself: a needs a"]),
        ("a = \"2*c\"", &["scene:6:8: ", "unknown name `c`"]),
        ("a = \"t\"", &["`t` may change with time"]),
        ("a = \"1/0\"", &["the value of \"1/0\" is inf"]),
        ("a = true", &["found true, expected a number"]),
        ("a = 1\ndeg = 2", &["`deg` is a constant already; choose another name"]),
        ("a = 1\n\"x y\" = 2", &["`x y` is not a valid name"]),
        ("a = 1\nsin = 2", &["`sin` is the name of a function"]),
    ] {
        for kind in ["rigid-body", "driven-body"] {
            let text = format!(
                "[problem]\nkind = \"{kind}\"\ninertia = [1, 2, \"3*a\"]\nomega_body = [1, 2, 3]\n\
                 [problem.parameters]\n{parameters}\n[time]\nt_span = [0, \"a\"]\n"
            );
            let message = Scene::parse("scene", &text).unwrap_err().to_string();
            words.iter().for_each(|word| assert!(message.contains(word), "{message}"));
            // What needs the parameter is not told.
            assert!(!message.contains(" mistakes"), "{message}");
        }
    }
    let lets = "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, \"b\"]\nomega_body = [1, 2, 3]\n\
                let = { b = \"3\" }\n[time]\nt_span = [0, 1]\n";
    let message = Scene::parse("scene", lets).unwrap_err().to_string();
    assert!(message.contains("`b` may change with time"), "{message}");
}

/// Every kind has parameters.
#[test]
fn every_kind_has_parameters() {
    for kind in KINDS.iter() {
        let has = kind.keys.iter().filter(|key| key.name == "parameters").count();
        assert_eq!(has, 1, "{}", kind.name);
    }
    // As keys of a program.
    let kind = lieflow_model::kinds::named("rigid-body").unwrap();
    let keys = |inertia: &str| {
        Tree::table([
            ("inertia", Tree::List(vec![1.into(), 2.into(), inertia.into()])),
            ("omega_body", [0.1, 1.0, 0.0].into()),
            ("parameters", Tree::table([("a", 3.0)])),
        ])
    };
    assert!(kind.problem(&keys("a/1")).is_ok());
    let mistakes = kind.problem(&keys("b")).unwrap_err().to_string();
    assert!(
        mistakes.starts_with("inertia[3]: \"b\" is not a number: unknown name `b`"),
        "{mistakes}"
    );
}
