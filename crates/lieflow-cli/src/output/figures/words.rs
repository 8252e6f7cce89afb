//! What figures and tables call a quantity, its columns and its parts.

use lieflow_model::problem::Kind;
use lieflow_model::schema::{Component, Observable};

/// The title of a quantity: the first clause of its meaning, or its columns if the scene makes them.
pub(super) fn title(kind: &Kind, quantity: &Observable) -> String {
    let info = match (kind.quantity(quantity.name), &quantity.parts[..]) {
        (Ok(_), [part]) if !part.what.is_empty() => return of_part(part),
        (Ok(info), _) => info,
        (Err(_), _) => return path(quantity, &quantity.columns, 1),
    };
    let clause = first_clause(info.meaning).replace('_', " ");
    let mut letters = clause.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// The title of a part of a composed system, or of a formula.
pub(super) fn of_part(part: &Component) -> String {
    match part.what {
        "" => column(&part.name),
        what => format!("The {what} {}", part.name.replace('_', " ")),
    }
}

/// The first clause of a meaning, with the further parts of a list: "real parts, then imaginary parts".
fn first_clause(meaning: &str) -> &str {
    let ends = meaning.char_indices().filter(|(at, c)| {
        let rest = meaning[*at..].trim_start_matches(", ");
        let goes_on = ["then ", "and ", "or "].iter().any(|word| rest.starts_with(word));
        matches!(c, ';' | ':') || (*c == ',' && !goes_on)
    });
    let end = ends.map(|(at, _)| at).next().unwrap_or(meaning.len());
    &meaning[..end]
}

/// The name of a quantity on an axis: of its one part, or its columns, where one of them has that name.
pub(super) fn on_axis(quantity: &Observable) -> String {
    if let [Component { name, .. }] = &quantity.parts[..]
        && !name.is_empty()
    {
        return name.replace('_', " ");
    }
    match &quantity.columns[..] {
        columns @ [_, _, ..] if columns.iter().any(|column| column == quantity.name) => {
            columns.iter().map(|name| column(name)).collect::<Vec<_>>().join(", ")
        }
        _ => quantity.name.replace('_', " "),
    }
}

/// A column in a legend: its numbers become subscripts, as in m₁, g₁₂ and m₁,₂.
pub(super) fn column(name: &str) -> String {
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let name = match letters {
        "w" => name.replacen('w', "ω", 1),
        // An l beside numbers reads as a 1.
        "l" => name.replacen('l', "L", 1),
        _ => name.to_string(),
    };
    let mut out = String::new();
    let mut after_number = false;
    for c in name.chars() {
        match (c.to_digit(10), c) {
            (Some(digit), _) => out.push(SUBSCRIPTS[digit as usize]),
            (None, '_') => out.push(if after_number { ',' } else { ' ' }),
            (None, c) => out.push(c),
        }
        after_number = c.is_ascii_digit();
    }
    out
}

const SUBSCRIPTS: [char; 10] = ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈', '₉'];

/// The common start of the columns of one part: the name without the number or the axis at its end.
pub(super) fn stem(column: &str) -> &str {
    let axis = column.trim_end_matches(['x', 'y', 'z']);
    if axis.ends_with(|c: char| c.is_ascii_digit()) && axis != column {
        return axis;
    }
    column.trim_end_matches(|c: char| c.is_ascii_digit())
}

/// The name of a path through some columns: that of its body or part, or what the columns share.
pub(super) fn path(quantity: &Observable, columns: &[String], number: usize) -> String {
    let one = match quantity.name {
        "momentum_body" | "energy" => "body",
        "spins" => "spin",
        _ => {
            let shared = shared(columns);
            return if shared.is_empty() {
                columns.iter().map(|name| column(name)).collect::<Vec<_>>().join(", ")
            } else {
                column(shared)
            };
        }
    };
    format!("{one} {number}")
}

/// The common start of names that end in different numbers.
pub(super) fn shared(columns: &[String]) -> &str {
    let first = columns.first().map_or("", String::as_str);
    let begins = |n: &usize| {
        columns.iter().all(|name| name.as_bytes().get(..*n) == first.as_bytes().get(..*n))
    };
    let length = (0..=first.len()).rev().find(begins).unwrap_or(0);
    first.get(..length).unwrap_or("").trim_end_matches('_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_does_not_leave_parts_of_a_list_out() {
        for (meaning, clause) in [
            ("real parts, then imaginary parts", "real parts, then imaginary parts"),
            ("rotation from body to space, row by row; more", "rotation from body to space"),
            ("gamma times the velocity, and gamma", "gamma times the velocity, and gamma"),
            ("angular momentum; on the sphere", "angular momentum"),
            ("energy", "energy"),
        ] {
            assert_eq!(first_clause(meaning), clause);
        }
    }

    #[test]
    fn columns_and_what_they_share() {
        let named = |names: &[&str]| names.iter().map(|name| name.to_string()).collect::<Vec<_>>();
        assert_eq!(
            ["m1", "w3", "l11", "s_length", "m1_2"].map(column).concat(),
            "m₁ω₃L₁₁s lengthm₁,₂"
        );
        assert_eq!(
            ["m1_2", "g12", "s3x", "energy", "px"].map(stem),
            ["m1_", "g", "s3", "energy", "px"]
        );
        for (names, expected) in [
            (named(&["m1_1", "m1_2"]), "m1"),
            (named(&["a1", "a2", "a3"]), "a"),
            (named(&["x", "px"]), ""),
            (named(&[]), ""),
        ] {
            assert_eq!(shared(&names), expected);
        }
    }
}
