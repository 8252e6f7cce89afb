//! Tables as CSV.

use std::borrow::Cow;

/// A text as a field: in quotes where it has a comma, a quote or a line break.
///
/// ```
/// use lieflow_figures::csv::field;
/// assert_eq!([field("plain"), field("a,b"), field("a\"b")], ["plain", "\"a,b\"", "\"a\"\"b\""]);
/// ```
pub fn field(text: &str) -> Cow<'_, str> {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")).into(),
        false => text.into(),
    }
}

/// The text of a table: the names of its columns, then its rows, each on a line.
///
/// ```
/// use lieflow_figures::csv::{in_full, optional, table};
/// use lieflow_figures::fields;
/// let rows = [fields![1, in_full(0.25)], fields![2, optional(None::<u8>)]];
/// assert_eq!(table(["n", "x"], rows), "n,x\n1,2.5e-1\n2,\n");
/// ```
pub fn table<'a>(
    columns: impl IntoIterator<Item = &'a str>,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let header: Vec<Cow<'_, str>> = columns.into_iter().map(field).collect();
    let mut text = header.join(",") + "\n";
    for row in rows {
        let fields: Vec<Cow<'_, str>> = row.iter().map(|text| field(text)).collect();
        text += &fields.join(",");
        text.push('\n');
    }
    text
}

/// The digits of a number as a field. A number that is not finite gives an empty field.
pub fn in_full(x: f64) -> String {
    if x.is_finite() { format!("{x:e}") } else { String::new() }
}

/// The text of a value as a field. A value that is missing gives an empty field.
pub fn optional<T: ToString>(x: Option<T>) -> String {
    x.map_or_else(String::new, |x| x.to_string())
}

/// Values as the fields of a row of [`table`](crate::csv::table).
#[macro_export]
macro_rules! fields {
    ($($value:expr),* $(,)?) => { vec![$($value.to_string()),*] };
}
