//! Scenes of each kind that cannot be used: a message with the line of the key, and what was expected.

use super::*;

/// A line of a bundled scene, what stands there instead, and what the message says.
const BROKEN: &[(&str, &str, &str, &[&str])] = &[
    ("flipping-book", "sides = ", "edges = ", &["unknown key `edges`", "sides"]),
    ("flipping-book", "kind = \"box\"", "kind = \"bax\"", &["unknown shape `bax`", "`box`"]),
    ("flipping-book", "mass = 0.5", "mass = -1", &["mass = -1"]),
    ("flipping-book", "mass = 0.5, ", "", &["missing key `mass`"]),
    ("flipping-book", "sides = [0.2, 0.15, 0.03]", "radius = 1", &["a box has a mass and sides"]),
    (
        "asymmetric-top",
        "inertia = [1.0, 2.0, 3.0]",
        "inertia = [[1, 0, 0], [0.1, 2, 0], [0, 0, 3]]",
        &["symmetric"],
    ),
    (
        "flipping-book",
        "shape = ",
        "shape = [\"box\", 1, [1, 2, 3]] # ",
        &["found a list, expected a table with the keys kind, mass, sides"],
    ),
    ("gyro-record", "samples = ", "sample = ", &["did you mean `samples`?"]),
    (
        "asymmetric-top",
        "inertia = [1.0, 2.0, 3.0]",
        "inertia = [[1, 0, 0], 2, 3]",
        &["numbers and rows"],
    ),
    ("wing-nut", "quaternion = [1.0,", "quaternion = [1.1,", &["its length is 1.1"]),
    ("wing-nut", "quaternion = [1.0, 0.0,", "quaternion = [1.0,", &["expected 4 numbers"]),
    (
        "wing-nut",
        "quaternion = [1.0,",
        "attitude = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nquaternion = [1.0,",
        &["at most one of them"],
    ),
    ("damped-satellite", "damping = 0.1", "dampen = 0.1", &["did you mean `damping`?"]),
    ("attitude-control", "control = [3.0, 4.0]", "control = 3.0", &["a list of 2 numbers"]),
    ("attitude-control", "[0.0012727073855697268,", "[0.5,", &["SO(3)"]),
    ("many-bodies", "inertia = [1.0, 1.0, 2.0]", "inertia = [1, 0, 2]", &["> 0"]),
    ("manakov-body", "mass_moments = [0.4,", "mass_moments = [-1.4,", &["mass_moments[1]", "> 0"]),
    ("manakov-body", "mass_moments = [0.4,", "mass_moments = [", &["found 3 numbers, expected 4"]),
    ("manakov-body", "momentum = [1.0,", "momentum = [", &["n(n-1)/2"]),
    ("manakov-body", "momentum = [1.0,", "momentum = [\"one\",", &["\"one\" is no number"]),
    ("lagrange-top", "inertia = [1.0, 1.0, 0.5]", "inertia = [1, 1, -2]", &["inertia[3] = -2"]),
    ("lagrange-top", "vertical = [0.6,", "vertical = [0.7,", &["length", "expected 1"]),
    ("lagrange-top", "omega_body", "omega", &["unknown key `omega`", "omega_body"]),
    ("ellipsoid-in-fluid", "mass = [1.5,", "mass = [0,", &["mass[1] = 0"]),
    ("ellipsoid-in-fluid", "inertia = ", "inertai = ", &["`inertai`", "did you mean `inertia`?"]),
    ("ellipsoid-in-fluid", "mass = [1.5, 1.2, 1.0]", "", &["missing key `mass` in [problem]"]),
    ("ellipsoid-in-fluid", "mass = [1.5,", "mass = [", &["expected 3 numbers, found 2"]),
    ("ellipsoid-in-fluid", "mass = [1.5,", "mass = [\"a\",", &["\"a\" is no number", "`a`"]),
    ("ellipsoid-in-fluid", "mass = [1.5,", "mass = 1 # [", &["found 1", "a list of 3 numbers"]),
    ("euler-on-sl3", "algebra = \"sl\"", "algebra = \"su\"", &["unknown algebra `su`", "so"]),
    ("euler-on-sl3", "momentum = [[0.2,", "momentum = [[0.3,", &["not in sl(3)"]),
    ("euler-on-sl3", "inverse_inertia = [[0.4, ", "inverse_inertia = [[", &["row 1 has 2 numbers"]),
    ("vortices-on-sphere", "n = 24", "n = 1", &["at least 2"]),
    ("vortices-on-sphere", "n = 24", "n = 513", &["n = 513, expected at most 512"]),
    (
        "vortices-on-sphere",
        "surface = \"sphere\"",
        "surface = \"shpere\"",
        &["did you mean `sphere`"],
    ),
    ("vortices-on-sphere", "surface = \"sphere\"", "", &["missing key `surface`"]),
    (
        "vortices-on-sphere",
        "n = 24",
        "n = 24\nrandom = { seed = 1, below = 3 }",
        &["one or the other"],
    ),
    ("vortices-on-sphere", "n = 24", "n = 24\njets = [[24, 1]]", &["degree = 24", "1 to 23"]),
    ("vortices-on-sphere", "n = 24", "n = 24\nmodes = [[3, 4, 1]]", &["order = 4", "-3 to 3"]),
    ("vortices-on-sphere", "n = 24", "n = 24\nmodes = [[3, 1]]", &["[degree, order, amplitude]"]),
    (
        "vortices-on-sphere",
        "latitude = 0.5, longitude = -0.6",
        "x = 0.5, y = -0.6",
        &["has a latitude and a longitude"],
    ),
    ("subspaces", "  [4.0, 0.5,", "  [4.0, 0.6,", &["symmetric"]),
    ("subspaces", "  [4.0, 0.5,", "  [0.5,", &["row 1 has 4 numbers"]),
    ("subspaces", "  [0.1, 0.0],", "", &["found 4 rows, expected 5"]),
    ("vortices-on-sphere", "longitude = -0.6", "longitude = 57.3", &["longitude = 57.3", "6.2832"]),
    ("toda-lattice", "positions = [", "positions = [900, -900, 0, 1] # ", &["overlap"]),
    ("shear-layer", "n = 41", "n = 42", &["n = 42", "odd"]),
    ("shear-layer", "n = 41", "n = 1", &["at least 2"]),
    ("shear-layer", "jets = [[1, -0.58]", "jets = [[1.5, 1.5]", &["a whole number, 1 to 20"]),
    ("shear-layer", "modes = [[1, 0, 0.0, 0.1]", "modes = [[21, 0, 1, 0]", &["-20 to 20"]),
    ("shear-layer", "modes = [[1, 0, 0.0, 0.1]", "modes = [[0, 0, 1, 0]", &["the mean"]),
    ("shear-layer", "modes = [[1, 0, 0.0, 0.1]", "modes = [[1, 0, nan, 0]", &["finite"]),
    ("shear-layer", "[\"energy\", ", "[\"angular_momentum\", ", &["has no `angular_momentum`"]),
    (
        "shear-layer",
        "jets = [",
        "vortices = [{ x = 1, y = 1, circulation = 1, width = -1 }] # ",
        &["> 0"],
    ),
    (
        "vortices-on-sphere",
        "circulation = 6.0, width = 0.25",
        "circulation = 6, width = 0",
        &["> 0"],
    ),
    ("vortices-on-sphere", "isospectral4", "magnus4", &["methods that fit: rkmk4"]),
    ("spherical-pendulum", "direction = [0.8, 0.0, -0.6]", "direction = [0, 0, 0]", &["|q|"]),
    ("spin-wave", "count = 8", "count = 1", &["at least 2"]),
    ("spin-wave", "wave = { count = 8, turns = 1, cone = 0.8 }", "", &["`spins` or `wave`"]),
    (
        "spin-wave",
        "wave = { count = 8, turns = 1, cone = 0.8 }",
        "spins = [[1, 0, 0], [0, 0, 0]]",
        &["|s[2]|"],
    ),
    ("toda-lattice", "momenta = [1.0, ", "momenta = [", &["3 momenta of 4 particles"]),
    ("sorting", "  [4.0, 0.1, 0.1, 0.1],", "  [4.0, 0.2, 0.1, 0.1],", &["symmetric"]),
    ("sorting", "order = [1.0, ", "order = [", &["found 3 numbers, expected 4"]),
    ("qr-flow", "  [2.0, 1.0, 0.0],", "  [-2.0, 1.0, 0.0],", &["eigenvalue", "> 0"]),
    ("oja", "  [4.0, 1.0,", "  [4.0, 2.0,", &["symmetric"]),
    ("oja", "x = [[0.1, 0.2],", "x = [", &["found 3 rows, expected 4"]),
    (
        "oja",
        "x = [[0.1, 0.2], [0.3, -0.5], [0.9, 0.4], [-0.2, 0.7]]",
        "x = [[1, 2], [1, 2], [0, 0], [0, 0]]",
        &["column 2 depends"],
    ),
    ("mathieu", "q = 0.3", "", &["missing key `q`"]),
    ("coupled-oscillators", "period = 2.0", "period = 0", &["> 0"]),
    (
        "coupled-oscillators",
        "q = [[0.0, 0.1],",
        "q = [[0.0, 0.2],",
        &["expected a symmetric matrix, but q[1,2] is 0.2 and q[2,1] is 0.1"],
    ),
    (
        "fodo-cell",
        "{ kind = \"drift\", length = 0.25 }",
        "{ kind = \"drift\", length = -1 }",
        &["> 0"],
    ),
    ("fodo-cell", "radius = 8.0", "k = 8.0", &["a dipole has a length and a radius"]),
    ("fodo-cell", "kind = \"dipole\"", "kind = \"dipol\"", &["did you mean `dipole`?"]),
    ("riccati-pole", "c = [[1.0, 0.0],", "c = [[1.0, 0.5],", &["symmetric"]),
    ("riccati-pole", "p = [[0.0, 0.0], [0.0, 0.0]]", "p = []", &["no rows"]),
    ("crossed-fields", "velocity = [0.0, 0.0, 0.3]", "velocity = [0, 0, 1]", &["less than 1"]),
    ("rabi", "coupling = [[0.0, 0.1],", "coupling = [[0.0, 0.2],", &["a symmetric matrix"]),
    (
        "rabi",
        "amplitudes = [1.0, 0.0]",
        "coupling_imaginary = [[0, 1], [-1, 2]]\namplitudes = [1.0, 0.0]",
        &["expected an antisymmetric matrix, but coupling_imaginary[2,2] is 2"],
    ),
    ("rabi", "amplitudes = [1.0, 0.0]", "amplitudes = [0, 0]", &["|ψ|"]),
    ("rabi", "amplitudes = [1.0, 0.0]", "amplitudes = [1]", &["expected 2, one a level"]),
    ("three-level-transfer", "12.533]", "0]", &["width 0"]),
    ("lorenz", "\"x*y - beta*z\"", "\"x*y - betta*z\"", &["character 7", "did you mean `beta`?"]),
    ("lorenz", "[\"x\", \"y\", \"z\"]", "[\"x\", \"y\"]", &["found 2 names, expected 3"]),
    (
        "lorenz",
        "[\"x\", \"y\", \"z\"]",
        "[\"x\", \"y\", \"t\"]",
        &["`t` is the name of a variable"],
    ),
    ("lorenz", "[\"x\", \"y\", \"z\"]", "[\"x\", \"y\", \"2z\"]", &["`2z` is no name"]),
    ("lorenz", "\"x*(rho - z) - y\", ", "", &["found 2 formulas, expected 3"]),
    ("lorenz", "sigma*(y - x)", "sqrt(x - y)", &["field[1]: its derivative by x is inf"]),
    ("lorenz", "sigma = 10", "sigma = \"ten\"", &["\"ten\" is no number", "`ten`"]),
    ("spin-pair", "name = \"b\"", "name = \"a\"", &["`a1` is of another part"]),
    ("spin-pair", "name = \"b\"", "name = \"2b\"", &["`2b1` is no name"]),
    ("spin-pair", "name = \"b\"", "", &["missing key `name`"]),
    ("gyrostat", "name = \"h\"", "name = \"m1\"", &["`m1` is of another part"]),
    ("gyrostat", "name = \"h\"", "name = \"m_length\"", &["`m_length` is of another part"]),
    ("gyrostat", "name = \"h\"", "name = \"t\"", &["`t` is the name of a variable"]),
    ("gyrostat", "name = \"h\"", "name = \"sin\"", &["`sin` is the name of a function"]),
    ("gyrostat", "name = \"h\"", "name = \"\"", &["is no name"]),
    (
        "spin-pair",
        "field = [\"b1\", ",
        "field = [",
        &["parts[1].field: found 2 formulas, expected 3"],
    ),
    ("spin-pair", "field = [\"b1\", ", "field = [\"c1\", ", &["parts[1].field[1]", "`c1`"]),
    ("spin-pair", "field = [\"a1\", ", "field = [\"a1 +\", ", &["parts[2].field[1]"]),
    ("spin-pair", "field = [\"a1\", ", "field = [true, ", &["a text or a number"]),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", "start = [0, 0, 0]", &["a vector of length 0"]),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", "start = [1e200, 0, 0]", &["length inf"]),
    (
        "spin-pair",
        "start = [0.6, 0.0, 0.8]",
        "start = [0.6, 0.8]",
        &["expected 3 numbers, found 2"],
    ),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", "start = [0.6, nan, 0]", &["a finite number"]),
    (
        "spin-pair",
        "start = [0.6, 0.0, 0.8]",
        "start = [[1, 2, 3]]",
        &["the start of `a` is to be 3 numbers"],
    ),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", "", &["the start of `a` is to be 3 numbers"]),
    ("spin-pair", "invariants = { energy", "invariants = { a1", &["`a1`", "something else"]),
    (
        "spin-pair",
        "field = [\"b1\", ",
        "field = [\"1/a2\", ",
        &["parts[1].field[1] is inf at the start"],
    ),
    (
        "spin-pair",
        "total3 = \"a3",
        "total3 = \"ln(b1) + a3",
        &["invariants.total3", "at the start"],
    ),
    ("spin-pair", "total3 = \"a3", "total3 = \"t + a3", &["invariants.total3", "`t`"]),
    ("spin-pair", "parameters = { K", "parameters = { a1", &["`a1`"]),
    ("gyrostat", "start = [0.0]", "start = []", &["the start of `h` is to be a list of numbers"]),
    (
        "gyrostat",
        "space = \"rotation\"",
        "space = \"rotatoin\"",
        &["unknown space `rotatoin`", "did you mean `rotation`?"],
    ),
    (
        "gyrostat",
        "space = \"rotation\"",
        "space = \"rotation\"\nstart = [[1, 0, 0], [0, 1, 0], [0, 1, 1]]",
        &["start", "SO(3)"],
    ),
    (
        "gyrostat",
        "space = \"rotation\"",
        "space = \"rotation\"\nstart = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]",
        &["start", "rotation"],
    ),
    (
        "gyrostat",
        "space = \"rotation\"",
        "space = \"rotation\"\nstart = [1, 0, 0]",
        &["the start of `g` is to be 3 rows of 3 numbers"],
    ),
    ("general-top", "[\"vertical\", ", "[\"integral\", ", &["has no `integral`: only Euler's"]),
    ("spin-pair", "\"lengths\"]", "\"defects\"]", &["has no `defects`: no part is a rotation"]),
    ("cubic-anisotropy", "quantities = [", "quantities = [\"group\", ", &["has no `group`: "]),
];

#[test]
fn each_names_the_line_and_what_was_expected() {
    for (name, line, instead, words) in BROKEN {
        let text = bundled(name);
        let number = text.lines().position(|l| l.contains(line));
        let number = 1 + number.unwrap_or_else(|| panic!("{name} has no {line}"));
        let error = match Scene::parse(name, &text.replacen(line, instead, 1)) {
            Ok(_) => panic!("{name} with {instead} was taken"),
            Err(error) => error,
        };
        let message = error.to_string();
        for word in *words {
            assert!(message.contains(word), "{name}, {instead}: {message}");
        }
        assert!(!message.contains(" mistakes"), "{name}, {instead}: {message}");
        // The key may begin above, the entry across may be the one that is named, and what is missing is
        // missed in its section.
        let at = error.line().unwrap_or_else(|| panic!("no line: {message}"));
        assert!(at.abs_diff(number) < 12, "line {at} for {number}: {message}");
    }
}

/// Of two mistakes in one scene both are told where the second can be found without the first, and never more.
#[test]
fn two_mistakes_are_two() {
    let (mut told, mut wrong) = (0, Vec::new());
    for (i, (name, line, instead, words)) in BROKEN.iter().enumerate() {
        for (other_name, other_line, other_instead, other_words) in &BROKEN[i + 1..] {
            let text = bundled(name);
            let place = |line: &str| text.find(line).map(|at| at..at + line.len());
            let (Some(a), Some(b)) = (place(line), place(other_line)) else { continue };
            if name != other_name || a.start < b.end && b.start < a.end {
                continue;
            }
            let text = text.replacen(line, instead, 1).replacen(other_line, other_instead, 1);
            let message = Scene::parse(name, &text).unwrap_err().to_string();
            if message.contains(" mistakes") && !message.contains(": 2 mistakes") {
                wrong.push(format!("{name}: {instead} and {other_instead}\n{message}\n"));
            }
            let mut all = words.iter().chain(*other_words);
            told += usize::from(all.all(|word| message.contains(word)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(told > 90, "only {told}");
}

/// Wrong values and wrong types of several sections; what would follow from them is not told.
#[test]
fn all_values_at_once() {
    let told = |scene: &str| {
        let message = Scene::parse("scene", scene).unwrap_err().to_string();
        let lines = message.lines().filter_map(|line| line.strip_prefix("scene:"));
        lines.filter(|line| !line.ends_with(" mistakes")).map(str::to_owned).collect::<Vec<_>>()
    };
    let rest = "[time]\nt_span = [0, 0]\ndt = -1\n[[events]]\nname = \"a\"\nwhen = \"m1 +\"\n\
                stop_after = 0\n[[events]]\nname = \"\"\nwhen = \"m9\"\ndirection = \"up\"\n";
    let body = "[problem]\nkind = \"rigid-body\"\ninertia = [1, -2, 3]\nomega_body = [1, 2]\n\
                attitude = [[1, 0, 0], [0, 1, 0], [0, 1, 1]]\n";
    let expected = [
        "3:15: inertia[2] = -2",
        "4:14: expected 3 numbers, found 2",
        "5:12: attitude: not in SO(3)",
        "7:10: t_span is empty",
        "8:6: dt = -1",
        "12:14: found 0",
        "14:8: an event without a name",
        "16:13: unknown direction `up`",
    ];
    let found = told(&format!("{body}{rest}"));
    let as_expected = |found: &[String], expected: &[&str]| {
        let mut pairs = found.iter().zip(expected);
        let each = pairs.all(|(found, expected)| found.starts_with(expected));
        assert!(each && found.len() == expected.len(), "{found:#?}\n{expected:#?}");
    };
    as_expected(&found, &expected);
    // With a problem the events are read too.
    let good = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [1, 2, 0]\n";
    let expected = [
        "6:10: t_span is empty",
        "7:6: dt = -1",
        "10:8: events[1].when: found nothing more",
        "11:14: found 0",
        "13:8: an event without a name",
        "14:8: events[2].when: unknown name `m9`",
        "15:13: unknown direction `up`",
    ];
    as_expected(&told(&format!("{good}{rest}")), &expected);

    // The size of the levels is not known, and what does not fit it is not told; types are.
    let rabi = bundled("rabi").replace("energies = [", "energies = 3 # [");
    let rabi = rabi.replace("frequency = ", "frequency = \"fast\" # ");
    let message = Scene::parse("scene", &rabi).unwrap_err().to_string();
    assert!(
        message.contains(": 2 mistakes") && message.contains("\"fast\" is no number"),
        "{message}"
    );
    // Each entry of a list that is no table is told, and not the keys that it cannot have.
    let bodies =
        "[problem]\nkind = \"rigid-bodies\"\nbodies = [1, {}, [2, 3]]\n[time]\nt_span = [0, 1]\n";
    let expected = [
        "3:11: found 1, expected a table with the keys inertia, momentum_body",
        "3:14: missing key `inertia`",
        "3:14: missing key `momentum_body`",
        "3:18: found a list, expected a table",
    ];
    as_expected(&told(bodies), &expected);
    // What a wrong named formula is needed for is left alone, also where it is needed by another one.
    let field = "[problem]\nkind = \"driven-body\"\ninertia = [1, 2, 3]\nomega_body = [1, 2, 0]\n\
                 torque = \"cross(c, w)\"\ntorque_space = [\"c2\", \"u\", 0]\n[problem.let]\n\
                 b = \"cross(w, v)\"\nc = \"2*b\"\n[time]\nt_span = [0, 1]\n";
    let expected = ["6:23: torque_space[2]: unknown name `u`", "8:5: let.b: unknown name `v`"];
    as_expected(&told(field), &expected);
    // Two keys that do not fit together are one mistake, also where one of them was mended.
    let top = bundled("lagrange-top")
        .replace("vertical = [", "attitude = [[1, 0, 0], [0, 1, 0], [0, 1, 1]]\nvertical = [");
    let message = Scene::parse("scene", &top).unwrap_err().to_string();
    assert!(message.contains("not in SO(3)") && !message.contains(" mistakes"), "{message}");
}

/// The name of a scene is a folder: it is neither empty nor the folder above.
#[test]
fn a_scene_has_a_name() {
    let name = |source: &str| Scene::parse(source, &bundled("oja")).unwrap().name;
    let sources = ["my.scene.toml", "a/b.toml", "", "...toml", ".toml", "a/...."];
    assert_eq!(sources.map(name), ["my.scene", "b", "scene", "scene", ".toml", "scene"]);
}

/// Two scenes with one fingerprint state the same, however they are written.
#[test]
fn the_fingerprint_is_of_what_is_stated() {
    let problem =
        "[problem]\nkind = \"spin\"\nfield = [0, 0, 1]\nrate = 1e-1\nmoment = [1, 0, 0]\n";
    let time = "[time]\nt_span = [0, 1]\n";
    let of = |text: &str| Scene::parse("scene", text).unwrap().fingerprint;
    let first = of(&format!("{problem}{time}"));
    let written = problem.replace("rate = 1e-1\nmoment", "  moment").replace(", ", ",");
    assert_eq!(first, of(&format!("# A spin.\n{time}{written}rate = 0.1 # slow\n")));
    assert_ne!(first, of(&format!("{problem}{time}").replace("1e-1", "2e-1")));
}

/// The line is that of the part, however far below; without parts there is no system.
#[test]
fn a_part_is_named_by_its_line() {
    let text = bundled("gyrostat").replace("\"u*(h/Jw", "\"u*(v/Jw");
    let line = 1 + text.lines().position(|line| line.contains("u*(v/Jw")).unwrap();
    assert_eq!(Scene::parse("gyrostat", &text).unwrap_err().line(), Some(line));

    let text = bundled("spin-pair");
    let (start, end) = (text.find("[[problem.parts]]").unwrap(), text.find("[method]").unwrap());
    for (parts, word) in [("", "missing key `parts`"), ("parts = []\n", "at least one")] {
        let text = format!("{}{parts}{}", &text[..start], &text[end..]);
        let message = Scene::parse("scene", &text).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    }
}

/// A layer that a kind does not have.
#[test]
fn a_kind_of_one_layer() {
    for (name, layer) in
        [("rabi", "closed"), ("spin-wave", "general"), ("ellipsoid-in-fluid", "general")]
    {
        let text = bundled(name);
        let asked = format!("[method]\nlayer = {layer:?}");
        let message =
            Scene::parse(name, &text.replace("[method]", &asked)).unwrap_err().to_string();
        assert!(message.contains("leave layer out"), "{message}");
        let own = if layer == "closed" { "general" } else { "closed" };
        let asked = format!("[method]\nlayer = {own:?}");
        assert!(Scene::parse(name, &text.replace("[method]", &asked)).is_ok());
    }
}
