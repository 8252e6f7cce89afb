//! Where a bracket that is not closed stands, in a text that is not TOML.

use core::ops::Range;

/// The place of a bracket that is not closed, and a message, where a text is found wrong only after it: at the end, or in a
/// line that begins another key, section or table.
pub(super) fn unclosed(text: &str, wrong: usize) -> Option<(Range<usize>, String)> {
    let is_end = text[wrong..].trim().is_empty();
    let line_start = text[..wrong].rfind('\n').map_or(0, |i| i + 1);
    let open = open_bracket(&text[..if is_end { wrong } else { line_start }])?;
    let line = text[line_start..].lines().next().unwrap_or_default();
    let (bracket, closing, is_outside) = match text.as_bytes()[open] {
        b'[' => ('[', ']', begins_section(line) || begins_key(line)),
        _ => {
            // In a table of several lines a comma may be missing instead.
            let rest = text[open + 1..].lines().next().unwrap_or_default();
            let has_keys = !rest.trim().is_empty();
            let is_table = line.trim_start().starts_with('{');
            ('{', '}', begins_section(line) || is_table || has_keys && begins_key(line))
        }
    };
    let message = || format!("not TOML: `{bracket}` is not closed, expected `{closing}`");
    (is_end || is_outside).then(|| (open..open + 1, message()))
}

/// Splits a line after the name at its beginning. The name may be empty.
fn split_name(line: &str) -> (&str, &str) {
    let line = line.trim_start();
    let in_name = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    let after = line.trim_start_matches(in_name);
    (&line[..line.len() - after.len()], after.trim_start())
}

/// Does a line begin as `key =`?
fn begins_key(line: &str) -> bool {
    let (name, after) = split_name(line);
    !name.is_empty() && after.starts_with('=')
}

/// Does a line begin as `[section]`?
fn begins_section(line: &str) -> bool {
    let line = line.trim_start();
    let (name, after) = split_name(line.trim_start_matches('['));
    line.starts_with('[')
        && name.starts_with(|c: char| c.is_ascii_alphabetic())
        && after.starts_with(']')
}

/// The last bracket of a text that is not closed, outside of quotes and comments.
fn open_bracket(text: &str) -> Option<usize> {
    let (bytes, mut open, mut at) = (text.as_bytes(), Vec::new(), 0);
    while at < bytes.len() {
        let rest = &bytes[at..];
        match rest[0] {
            b'[' | b'{' => open.push(at),
            b']' | b'}' => drop(open.pop()),
            _ => {}
        }
        at += match rest[0] {
            b'#' => rest.iter().position(|c| *c == b'\n').unwrap_or(rest.len()),
            quote @ (b'"' | b'\'') => length_of_quoted(rest, quote),
            _ => 1,
        };
    }
    open.pop()
}

/// The number of bytes of the text in these quotes at the beginning. Only three quotes hold several lines.
fn length_of_quoted(bytes: &[u8], quote: u8) -> usize {
    let is_long = bytes.starts_with(&[quote; 3]);
    let end = if is_long { &[quote; 3][..] } else { &[quote][..] };
    let mut at = end.len();
    while at < bytes.len() && !bytes[at..].starts_with(end) && (is_long || bytes[at] != b'\n') {
        at += if quote == b'"' && bytes[at] == b'\\' { 2 } else { 1 };
    }
    at + end.len()
}
