//! Names that were meant: of keys, kinds and quantities, and those of the library.

use lieflow::names::{self, Alias, MethodPart};

/// Names of other programs, and what they are in a scene.
const OTHER_NAMES: &[(&str, &str)] = &[
    // Sections, and keys at the top.
    ("name", "title"),
    ("model", "problem"),
    ("system", "problem"),
    ("equation", "problem"),
    ("integrator", "method"),
    ("solver", "method"),
    ("event", "events"),
    ("save", "output"),
    // [method]
    ("method", "name"),
    ("integrator", "name"),
    ("solver", "name"),
    ("scheme", "name"),
    ("coordinates", "map"),
    ("butcher", "tableau"),
    // [time]
    ("span", "t_span"),
    ("t_end", "t_span"),
    ("t_final", "t_span"),
    ("t_max", "t_span"),
    ("t1", "t_span"),
    ("duration", "t_span"),
    ("h", "dt"),
    ("step", "dt"),
    ("step_size", "dt"),
    ("time_step", "dt"),
    ("n", "steps"),
    ("n_steps", "steps"),
    ("num_steps", "steps"),
    ("tol", "rtol"),
    ("rel_tol", "rtol"),
    ("abs_tol", "atol"),
    ("first_step", "h_init"),
    ("max_step", "h_max"),
    ("min_step", "h_min"),
    // [[events]]
    ("terminal", "stop_after"),
    ("stop", "stop_after"),
    ("function", "when"),
    // [output]
    ("t_eval", "times"),
    ("save_at", "times"),
    ("variables", "quantities"),
    ("columns", "quantities"),
    ("save_every", "every"),
    ("stride", "every"),
    ("points", "count"),
    ("rows", "count"),
    // [problem]
    ("type", "kind"),
    ("j", "inertia"),
    ("moments", "inertia"),
    ("moments_of_inertia", "inertia"),
    ("tensor", "inertia"),
    ("gravity", "weight"),
    ("mgl", "weight"),
    ("constants", "parameters"),
    ("params", "parameters"),
    ("initial", "start"),
    ("x0", "start"),
    ("y0", "start"),
    ("rhs", "field"),
    ("f", "field"),
    // Units of angles in formulas.
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("turns", "turn"),
    ("revolution", "rev"),
    // Quantities, and keys of the same names.
    ("omega", "omega_body"),
    ("omega0", "omega_body"),
    ("w", "omega_body"),
    ("w0", "omega_body"),
    ("angular_velocity", "omega_body"),
    ("l", "momentum_body"),
    ("m", "momentum_body"),
    ("angular_momentum", "momentum_body"),
    ("angular_momentum", "momentum"),
    ("orientation", "attitude"),
    ("rotation", "attitude"),
    ("rotation_matrix", "attitude"),
    ("dcm", "attitude"),
    ("r", "attitude"),
    ("quat", "quaternion"),
    ("q", "quaternion"),
    ("hamiltonian", "energy"),
    ("kinetic_energy", "energy"),
    ("nutation_angle", "nutation"),
    ("theta", "nutation"),
    // Kinds.
    ("free_body", "rigid-body"),
    ("body", "rigid-body"),
    ("euler_top", "rigid-body"),
    ("satellite", "driven-body"),
    ("spacecraft", "driven-body"),
    ("cubesat", "driven-body"),
    ("forced_body", "driven-body"),
    ("torque", "driven-body"),
    ("top", "heavy-top"),
    ("lagrange_top", "heavy-top"),
    ("kovalevskaya_top", "heavy-top"),
    ("gyroscope", "heavy-top"),
    ("manakov", "rigid-body-n"),
    ("ellipsoid", "kirchhoff"),
    ("underwater_vehicle", "kirchhoff"),
    ("lie_poisson", "euler"),
    ("vortices", "fluid"),
    ("vorticity", "fluid"),
    ("pendulum", "spherical-pendulum"),
    ("bloch", "spin"),
    ("heisenberg", "spin-chain"),
    ("landau_lifshitz", "spin-chain"),
    ("spins", "spin-chain"),
    ("dzyaloshinskii_moriya", "spin-chain"),
    ("toda_lattice", "toda"),
    ("brockett", "double-bracket"),
    ("qr", "qr-flow"),
    ("pca", "oja"),
    ("grassmann", "subspace"),
    ("floquet", "hill"),
    ("accelerator", "beam-line"),
    ("fodo", "beam-line"),
    ("lattice", "beam-line"),
    ("electron", "lorentz"),
    ("particle", "lorentz"),
    ("quantum", "schrodinger"),
    ("schroedinger", "schrodinger"),
    ("landau_zener", "schrodinger"),
    ("qubit", "schrodinger"),
    ("von_neumann", "density-matrix"),
    ("liouville", "density-matrix"),
    ("mixed_state", "density-matrix"),
    ("ode", "matrix-ode"),
    ("matrix", "matrix-ode"),
    ("lie_group", "matrix-ode"),
    ("custom", "matrix-ode"),
    ("lyapunov_exponents", "lyapunov"),
    ("coupled", "composed"),
    ("system", "composed"),
    ("product", "composed"),
];

/// Other names of these, and what each is.
fn others<'a>(names: &[&'a str]) -> impl Iterator<Item = (&'static str, &'a str)> {
    let listed = |name| names.iter().find(|listed| *listed == name).copied();
    OTHER_NAMES.iter().filter_map(move |(other, name)| Some((*other, listed(name)?)))
}

/// A slip in another name of so few letters is not looked for.
const NOT_SHORT: usize = 5;

/// Is this another name of one of these, as other programs have it?
pub fn is_known(given: &str, names: &[&str]) -> bool {
    others(names).any(|(other, _)| names::same(other, given))
}

/// The name that was meant, when that is clear.
fn meant<'a>(given: &str, names: &[&'a str]) -> Option<Alias<'a>> {
    let alone = |name| Alias { name, part: None };
    let other = |given: &str| {
        others(names).find(|(other, _)| names::same(other, given)).map(|(_, name)| alone(name))
    };
    // A short word is like many others.
    let nearly = || {
        if given.chars().count() < NOT_SHORT {
            return None;
        }
        let near = names::near(given, &others(names).map(|(other, _)| other).collect::<Vec<_>>())?;
        other(near)
    };
    let spelt = names::find(given, names.iter().copied()).map(alone);
    spelt.or_else(|| other(given)).or_else(|| names::meant(given, names)).or_else(nearly)
}

/// The name that was meant, when that is clear.
pub fn suggest<'a>(given: &str, names: &[&'a str]) -> Option<&'a str> {
    meant(given, names).map(|meant| meant.name)
}

/// The suggestion for the unknown name `given`: first what was probably meant, then the lines to write or the names that
/// are expected.
pub fn help_for(given: &str, names: &[&str]) -> String {
    let meant = meant(given, names);
    let (name, what, part) = match meant {
        Some(Alias { name, part: Some(MethodPart::Tableau(part)) }) => (name, "tableau", part),
        Some(Alias { name, part: Some(MethodPart::Map(part)) }) => (name, "map", part),
        _ => {
            let meant = meant.map(|meant| format!("did you mean `{}`?", meant.name));
            return names::expected(meant.as_deref(), names);
        }
    };
    let is = match names::same(given, part) {
        true => format!("a {what}"),
        false => format!("method `{name}` with {what} `{part}`"),
    };
    format!("`{given}` is {is}:\nname = \"{name}\"\n{what} = \"{part}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_names_are_suggested_and_others_are_not() {
        let names = ["inertia", "inverse_inertia", "omega_body"];
        for (given, meant) in [
            ("inertai", "inertia"),
            ("Inertia", "inertia"),
            ("J", "inertia"),
            ("omega-body", "omega_body"),
            ("omega", "omega_body"),
            ("angular velocity", "omega_body"),
        ] {
            assert_eq!(suggest(given, &names), Some(meant), "{given}");
        }
        assert_eq!(suggest("colour", &names), None);
        assert_eq!(suggest("gyroscop", &["heavy-top"]), Some("heavy-top"));
        assert_eq!(suggest("nope", &["heavy-top"]), None);
        assert_eq!(suggest("x", &[]), None);
        // One letter is close to every other.
        assert_eq!(suggest("c", &["t", "x"]), None);
    }

    #[test]
    fn the_help_begins_with_what_was_meant() {
        assert_eq!(
            help_for("exq", &["exp", "cay"]),
            "did you mean `exp`? (expected one of exp, cay)"
        );
        assert_eq!(help_for("none", &["exp", "cay"]), "expected one of exp, cay");
        // Of a long list only that.
        let many: Vec<String> = (0..40).map(|i| format!("method{i}")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert_eq!(help_for("methot7", &many), "did you mean `method7`?");
        assert!(help_for("xxxx", &many).starts_with("expected one of method0, method1"));
        // A part of a method comes with the lines to write.
        let methods = ["rkmk4", "rkmk"];
        assert_eq!(
            help_for("dopri5", &methods),
            "`dopri5` is a tableau:\nname = \"rkmk\"\ntableau = \"dopri5\""
        );
    }
}
