//! Scenes of each kind that cannot be used: a message with the line of the key, and what was expected.

use super::*;

/// A line of a bundled scene, and what stands there instead. The messages are in a snapshot: `cargo insta review` shows
/// those that a change makes different.
const BROKEN: &[(&str, &str, &str)] = &[
    ("flipping-book", "sides = ", "edges = "),
    ("flipping-book", "kind = \"box\"", "kind = \"bax\""),
    ("flipping-book", "mass = 0.5", "mass = -1"),
    ("flipping-book", "mass = 0.5, ", ""),
    ("flipping-book", "sides = [0.2, 0.15, 0.03]", "radius = 1"),
    (
        "asymmetric-top",
        "inertia = [1.0, 2.0, 3.0]",
        "inertia = [[1, 0, 0], [0.1, 2, 0], [0, 0, 3]]",
    ),
    ("flipping-book", "shape = ", "shape = [\"box\", 1, [1, 2, 3]] # "),
    ("gyro-record", "samples = ", "sample = "),
    ("asymmetric-top", "inertia = [1.0, 2.0, 3.0]", "inertia = [[1, 0, 0], 2, 3]"),
    ("wing-nut", "quaternion = [1.0,", "quaternion = [1.1,"),
    ("wing-nut", "quaternion = [1.0, 0.0,", "quaternion = [1.0,"),
    (
        "wing-nut",
        "quaternion = [1.0,",
        "attitude = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nquaternion = [1.0,",
    ),
    ("damped-satellite", "damping = 0.1", "dampen = 0.1"),
    ("attitude-control", "control = [3.0, 4.0]", "control = 3.0"),
    ("attitude-control", "[0.0012727073855697268,", "[0.5,"),
    ("many-bodies", "inertia = [1.0, 1.0, 2.0]", "inertia = [1, 0, 2]"),
    ("manakov-body", "mass_moments = [0.4,", "mass_moments = [-1.4,"),
    ("manakov-body", "mass_moments = [0.4,", "mass_moments = ["),
    ("manakov-body", "momentum = [1.0,", "momentum = ["),
    ("manakov-body", "momentum = [1.0,", "momentum = [\"one\","),
    ("lagrange-top", "inertia = [1.0, 1.0, 0.5]", "inertia = [1, 1, -2]"),
    ("lagrange-top", "vertical = [0.6,", "vertical = [0.7,"),
    ("lagrange-top", "omega_body", "omega"),
    ("ellipsoid-in-fluid", "mass = [1.5,", "mass = [0,"),
    ("ellipsoid-in-fluid", "inertia = ", "inertai = "),
    ("ellipsoid-in-fluid", "mass = [1.5, 1.2, 1.0]", ""),
    ("ellipsoid-in-fluid", "mass = [1.5,", "mass = ["),
    ("ellipsoid-in-fluid", "mass = [1.5,", "mass = [\"a\","),
    ("ellipsoid-in-fluid", "mass = [1.5,", "mass = 1 # ["),
    ("euler-on-sl3", "algebra = \"sl\"", "algebra = \"su\""),
    ("euler-on-sl3", "momentum = [[0.2,", "momentum = [[0.3,"),
    ("euler-on-sl3", "inverse_inertia = [[0.4, ", "inverse_inertia = [["),
    ("vortices-on-sphere", "n = 24", "n = 1"),
    ("vortices-on-sphere", "n = 24", "n = 513"),
    ("vortices-on-sphere", "surface = \"sphere\"", "surface = \"shpere\""),
    ("vortices-on-sphere", "surface = \"sphere\"", ""),
    ("vortices-on-sphere", "n = 24", "n = 24\nrandom = { seed = 1, below = 3 }"),
    ("vortices-on-sphere", "n = 24", "n = 24\njets = [[24, 1]]"),
    ("vortices-on-sphere", "n = 24", "n = 24\nmodes = [[3, 4, 1]]"),
    ("vortices-on-sphere", "n = 24", "n = 24\nmodes = [[3, 1]]"),
    ("vortices-on-sphere", "latitude = 0.5, longitude = -0.6", "x = 0.5, y = -0.6"),
    ("subspaces", "  [4.0, 0.5,", "  [4.0, 0.6,"),
    ("subspaces", "  [4.0, 0.5,", "  [0.5,"),
    ("subspaces", "  [0.1, 0.0],", ""),
    ("vortices-on-sphere", "longitude = -0.6", "longitude = 57.3"),
    ("toda-lattice", "positions = [", "positions = [900, -900, 0, 1] # "),
    ("shear-layer", "n = 41", "n = 42"),
    ("shear-layer", "n = 41", "n = 1"),
    ("shear-layer", "jets = [[1, -0.58]", "jets = [[1.5, 1.5]"),
    ("shear-layer", "modes = [[1, 0, 0.0, 0.1]", "modes = [[21, 0, 1, 0]"),
    ("shear-layer", "modes = [[1, 0, 0.0, 0.1]", "modes = [[0, 0, 1, 0]"),
    ("shear-layer", "modes = [[1, 0, 0.0, 0.1]", "modes = [[1, 0, nan, 0]"),
    ("shear-layer", "[\"energy\", ", "[\"angular_momentum\", "),
    ("shear-layer", "jets = [", "vortices = [{ x = 1, y = 1, circulation = 1, width = -1 }] # "),
    ("vortices-on-sphere", "circulation = 6.0, width = 0.25", "circulation = 6, width = 0"),
    ("vortices-on-sphere", "isospectral4", "magnus4"),
    ("spherical-pendulum", "direction = [0.8, 0.0, -0.6]", "direction = [0, 0, 0]"),
    ("spin-wave", "count = 8", "count = 1"),
    ("spin-wave", "wave = { count = 8, turns = 1, cone = 0.8 }", ""),
    ("spin-wave", "wave = { count = 8, turns = 1, cone = 0.8 }", "spins = [[1, 0, 0], [0, 0, 0]]"),
    ("toda-lattice", "momenta = [1.0, ", "momenta = ["),
    ("sorting", "  [4.0, 0.1, 0.1, 0.1],", "  [4.0, 0.2, 0.1, 0.1],"),
    ("sorting", "order = [1.0, ", "order = ["),
    ("qr-flow", "  [2.0, 1.0, 0.0],", "  [-2.0, 1.0, 0.0],"),
    ("oja", "  [4.0, 1.0,", "  [4.0, 2.0,"),
    ("oja", "x = [[0.1, 0.2],", "x = ["),
    (
        "oja",
        "x = [[0.1, 0.2], [0.3, -0.5], [0.9, 0.4], [-0.2, 0.7]]",
        "x = [[1, 2], [1, 2], [0, 0], [0, 0]]",
    ),
    ("mathieu", "q = 0.3", ""),
    ("coupled-oscillators", "period = 2.0", "period = 0"),
    ("coupled-oscillators", "q = [[0.0, 0.1],", "q = [[0.0, 0.2],"),
    ("fodo-cell", "{ kind = \"drift\", length = 0.25 }", "{ kind = \"drift\", length = -1 }"),
    ("fodo-cell", "radius = 8.0", "k = 8.0"),
    ("fodo-cell", "kind = \"dipole\"", "kind = \"dipol\""),
    ("riccati-pole", "c = [[1.0, 0.0],", "c = [[1.0, 0.5],"),
    ("riccati-pole", "p = [[0.0, 0.0], [0.0, 0.0]]", "p = []"),
    ("crossed-fields", "velocity = [0.0, 0.0, 0.3]", "velocity = [0, 0, 1]"),
    ("rabi", "coupling = [[0.0, 0.1],", "coupling = [[0.0, 0.2],"),
    (
        "rabi",
        "amplitudes = [1.0, 0.0]",
        "coupling_imaginary = [[0, 1], [-1, 2]]\namplitudes = [1.0, 0.0]",
    ),
    ("rabi", "amplitudes = [1.0, 0.0]", "amplitudes = [0, 0]"),
    ("rabi", "amplitudes = [1.0, 0.0]", "amplitudes = [1]"),
    ("three-level-transfer", "12.533]", "0]"),
    ("lorenz", "\"x*y - beta*z\"", "\"x*y - betta*z\""),
    ("lorenz", "[\"x\", \"y\", \"z\"]", "[\"x\", \"y\"]"),
    ("lorenz", "[\"x\", \"y\", \"z\"]", "[\"x\", \"y\", \"t\"]"),
    ("lorenz", "[\"x\", \"y\", \"z\"]", "[\"x\", \"y\", \"2z\"]"),
    ("lorenz", "\"x*(rho - z) - y\", ", ""),
    ("lorenz", "sigma*(y - x)", "sqrt(x - y)"),
    ("lorenz", "sigma = 10", "sigma = \"ten\""),
    ("spin-pair", "name = \"b\"", "name = \"a\""),
    ("spin-pair", "name = \"b\"", "name = \"2b\""),
    ("spin-pair", "name = \"b\"", ""),
    ("gyrostat", "name = \"h\"", "name = \"m1\""),
    ("gyrostat", "name = \"h\"", "name = \"m_length\""),
    ("gyrostat", "name = \"h\"", "name = \"t\""),
    ("gyrostat", "name = \"h\"", "name = \"sin\""),
    ("gyrostat", "name = \"h\"", "name = \"\""),
    ("spin-pair", "field = [\"b1\", ", "field = ["),
    ("spin-pair", "field = [\"b1\", ", "field = [\"c1\", "),
    ("spin-pair", "field = [\"a1\", ", "field = [\"a1 +\", "),
    ("spin-pair", "field = [\"a1\", ", "field = [true, "),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", "start = [0, 0, 0]"),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", "start = [1e200, 0, 0]"),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", "start = [0.6, 0.8]"),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", "start = [0.6, nan, 0]"),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", "start = [[1, 2, 3]]"),
    ("spin-pair", "start = [0.6, 0.0, 0.8]", ""),
    ("spin-pair", "invariants = { energy", "invariants = { a1"),
    ("spin-pair", "field = [\"b1\", ", "field = [\"1/a2\", "),
    ("spin-pair", "total3 = \"a3", "total3 = \"ln(b1) + a3"),
    ("spin-pair", "total3 = \"a3", "total3 = \"t + a3"),
    ("spin-pair", "parameters = { K", "parameters = { a1"),
    ("gyrostat", "start = [0.0]", "start = []"),
    ("gyrostat", "space = \"rotation\"", "space = \"rotatoin\""),
    (
        "gyrostat",
        "space = \"rotation\"",
        "space = \"rotation\"\nstart = [[1, 0, 0], [0, 1, 0], [0, 1, 1]]",
    ),
    (
        "gyrostat",
        "space = \"rotation\"",
        "space = \"rotation\"\nstart = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]",
    ),
    ("gyrostat", "space = \"rotation\"", "space = \"rotation\"\nstart = [1, 0, 0]"),
    ("general-top", "[\"vertical\", ", "[\"integral\", "),
    ("spin-pair", "\"lengths\"]", "\"defects\"]"),
    ("cubic-anisotropy", "quantities = [", "quantities = [\"group\", "),
    ("asymmetric-top", "inertia = [1.0, 2.0, 3.0]", "inertia = [1.0, 2.0, 3.0"),
    ("spin-pair", "parameters = { K", "parameters = { deg = 1, K"),
    ("flipping-book", "sides = [0.2,", "sides = [1e308,"),
    ("toda-lattice", "t_span = [0.0, 20.0]", "t_span = [0.0, 20.0"),
];

/// A line of a bundled scene, what stands there instead, and what stands at the place of the mistake.
const PLACES: &[(&str, &str, &str, &str)] = &[
    ("fodo-cell", "length = 0.25 }", "length = -0.25 }", "-0.25"),
    ("fodo-cell", "radius = 8.0", "radius = 0", "0 }"),
    ("fodo-cell", "\"dipole\", length", "\"dipole\", k = 1, length", "1, length"),
    ("fodo-cell", "\"dipole\"", "\"dipol\"", "\"dipol\""),
    ("fodo-cell", "length = 0.25 },", "length = 0.25,", "{ kind = \"drift\", length = 0.25,\n"),
    ("fodo-cell", "  { kind = \"drift\", length = 0.25 },\n]", "", "[\n  { kind = \"quadrupole\""),
    ("spin-pair", "parameters = { K", "parameters = { deg = 1, K", "deg"),
    ("asymmetric-top", "2.0, 3.0]", "2.0, 3.0", "[1.0, 2.0, 3.0"),
    ("asymmetric-top", "2.0, 3.0]", "2.0, 3.0,", "[1.0, 2.0, 3.0"),
    ("sorting", "order = [", "order = [ # \"] ", "[ # \"]"),
    ("vortices-on-sphere", "longitude = -0.6", "longitude = 57.3", "57.3"),
    ("many-bodies", "inertia = [1.0, 1.0, 2.0]", "inertia = [1, 0, 2]", "0, 2]"),
    ("flipping-book", "sides = [0.2, 0.15,", "sides = [0.2, -1,", "-1,"),
];

#[test]
fn a_mistake_has_the_place_of_its_key() {
    for (name, line, instead, at) in PLACES {
        let text = bundled(name);
        assert!(text.contains(line), "{name} has no {line}");
        let text = text.replacen(line, instead, 1);
        let before = &text[..text.find(at).unwrap_or_else(|| panic!("{name}: no {at}"))];
        let start = before.rfind('\n').map_or(0, |end| end + 1);
        let (line, column) =
            (1 + before.matches('\n').count(), 1 + before[start..].chars().count());
        let message = message_of(name, &text).to_string();
        assert!(
            message.starts_with(&format!("{name}:{line}:{column}: ")),
            "{line}:{column} {message}"
        );
    }
}

/// What is said of a scene.
fn message_of(name: &str, text: &str) -> SceneError {
    match Scene::parse(name, text) {
        Ok(_) => panic!("{name} was taken:\n{text}"),
        Err(error) => error,
    }
}

#[test]
fn each_names_the_line_and_what_was_expected() {
    let mut all = String::new();
    for (name, line, instead) in BROKEN {
        let text = bundled(name);
        let number = text.lines().position(|l| l.contains(line));
        let number = 1 + number.unwrap_or_else(|| panic!("{name} has no {line}"));
        let error = message_of(name, &text.replacen(line, instead, 1));
        let message = error.to_string();
        assert!(!message.contains(" mistakes"), "{name}, {instead}: {message}");
        // The key may begin above, the entry across may be the one that is named, and what is missing is
        // missed in its section.
        let at = error.line().unwrap_or_else(|| panic!("no line: {message}"));
        assert!(at.abs_diff(number) < 12, "line {at} for {number}: {message}");
        all += &format!("# {name}: {line:?} -> {instead:?}\n{message}\n\n");
    }
    insta::assert_snapshot!(all);
}

/// Of two mistakes in one scene both are told where the second can be found without the first, and never more.
#[test]
fn two_mistakes_are_two() {
    // The message without its place, which another mistake may move.
    let words = |error: &SceneError| {
        let message = error.to_string();
        let line = message.lines().next().unwrap_or_default();
        line.splitn(4, ':').last().unwrap_or_default().trim().to_owned()
    };
    let alone: Vec<String> = (BROKEN.iter())
        .map(|(name, line, instead)| {
            words(&message_of(name, &bundled(name).replacen(line, instead, 1)))
        })
        .collect();
    let (mut told, mut wrong) = (0, Vec::new());
    for (i, (name, line, instead)) in BROKEN.iter().enumerate() {
        for (j, (other_name, other_line, other_instead)) in BROKEN.iter().enumerate().skip(i + 1) {
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
            told += usize::from([i, j].iter().all(|&one| message.contains(&alone[one])));
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
        "11:8: events[1].when: the formula ends here",
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
    // Without a problem and a span the form of formulas is read, and what needs neither.
    let output = "[output]\nevery = 2\ncount = 3\n[output.formulas]\ne = \"energy + 2*)\"\nf = \"norm(w\"\n\
                  g = [\"dot(w, x) + sine(m1)\", \"w*x + nothing\"]\n";
    let expected = [
        "3:15: inertia[2] = -2",
        "4:14: expected 3 numbers, found 2",
        "5:12: attitude: not in SO(3)",
        "7:10: t_span is empty",
        "10:9: both `every` and `count`",
        "12:5: formulas.e: found `)`",
        "13:5: formulas.f: the formula ends here",
        "14:6: formulas.g[1]: unknown function `sine`",
    ];
    as_expected(&told(&format!("{body}[time]\nt_span = [0, 0]\n{output}")), &expected);
    // With a problem the events are read too.
    let good = "[problem]\nkind = \"rigid-body\"\ninertia = [1, 2, 3]\nomega_body = [1, 2, 0]\n";
    let expected = [
        "6:10: t_span is empty",
        "7:6: dt = -1",
        "10:8: events[1].when: the formula ends here",
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
        message.contains(": 2 mistakes") && message.contains("\"fast\" is not a number"),
        "{message}"
    );
    // Each value of a table in a list, also beside one of another type.
    let line =
        bundled("fodo-cell").replace("length = 0.25", "length = 0").replacen("1.2", "\"a\"", 1);
    let message = Scene::parse("scene", &line.replace("8.0", "0")).unwrap_err().to_string();
    assert!(message.contains(": 7 mistakes"), "{message}");
    let tolerances = "rtol = -1\natol = -1\nh_min = 0\nh_max = -1\n";
    let expected = ["7:8: rtol = -1", "8:8: atol = -1", "9:9: h_min = 0", "10:9: h_max = -1"];
    as_expected(&told(&format!("{good}[time]\nt_span = [0, 1]\n{tolerances}")), &expected);
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
