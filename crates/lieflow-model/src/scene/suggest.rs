//! Names that were meant.

/// The name that is closest to what was given, when it is close.
pub fn suggest<'a>(given: &str, names: &[&'a str]) -> Option<&'a str> {
    let given = given.to_lowercase().replace('_', "-");
    let distance = |name: &str| {
        let name = name.replace('_', "-");
        // A name that was cut short is close whatever is missing.
        let cut = given.chars().count() >= 3 && name.starts_with(&given);
        if cut { 0 } else { strsim::damerau_levenshtein(&given, &name) }
    };
    let closest = names.iter().map(|&name| (distance(name), name)).min_by_key(|(d, _)| *d)?;
    let allowed = match given.chars().count() {
        0..=2 => 1,
        3..=5 => 2,
        n => n / 3,
    };
    (closest.0 <= allowed).then_some(closest.1)
}

/// More names than this are not listed.
const LISTED: usize = 200;

/// What was expected instead of `given`, and which of it was meant.
pub fn help_for(given: &str, names: &[&str]) -> String {
    let expected = match names {
        [] => "nothing is expected here".into(),
        [name] => format!("expected {name}"),
        [first @ .., _] if first.len() >= LISTED => {
            format!("expected one of {}, …", first[..LISTED].join(", "))
        }
        names => format!("expected one of {}", names.join(", ")),
    };
    match suggest(given, names) {
        Some(name) => format!("{expected}; did you mean `{name}`?"),
        None => expected,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_names_are_suggested_and_others_are_not() {
        let names = ["inertia", "inverse_inertia", "omega_body"];
        assert_eq!(suggest("inertai", &names), Some("inertia"));
        assert_eq!(suggest("omega-body", &names), Some("omega_body"));
        assert_eq!(suggest("Inertia", &names), Some("inertia"));
        assert_eq!(suggest("omega", &names), Some("omega_body"));
        assert_eq!(suggest("colour", &names), None);
        assert_eq!(suggest("x", &[]), None);
    }

    #[test]
    fn the_help_lists_the_names() {
        assert_eq!(
            help_for("exq", &["exp", "cay"]),
            "expected one of exp, cay; did you mean `exp`?"
        );
    }
}
