//! Settings that change a scene before it is read: `time.dt=0.01`, `problem.inertia[2]=2.5`.

use toml_edit::{DocumentMut, Item, TableLike, Value};

use super::document::TOP;
use super::error::SceneError;
use super::keys::sections;
use crate::reader::{help_for, suggest};

/// A step on the way to a value: a key, or the place in a list, from 1.
enum Step<'a> {
    Key(&'a str),
    Place(usize),
}

/// The text of a scene with these settings, in their order. A setting is `key=value`: the key with its section, as in
/// `time.dt`, and places in lists in brackets, from 1, `[3]` or `[1, 3]`; the value in TOML. Nothing after the `=` takes the key away.
///
/// # Errors
/// A setting that is no such text, or that goes into what the scene does not have.
pub(super) fn with_settings(
    source: &str,
    text: &str,
    settings: &[String],
) -> Result<String, SceneError> {
    if settings.is_empty() {
        return Ok(text.into());
    }
    let Ok(mut document) = text.parse::<DocumentMut>() else {
        // What is wrong with the text is said where it is read.
        return Ok(text.into());
    };
    for setting in settings {
        set(document.as_item_mut(), setting)
            .map_err(|why| SceneError::new(source, format!("--set {setting}: {why}")))?;
    }
    Ok(document.to_string())
}

fn set(root: &mut Item, setting: &str) -> Result<(), String> {
    let Some((path, text)) = setting.split_once('=') else {
        return Err("expected key=value, such as time.dt=0.01".into());
    };
    let steps = steps(path.trim())?;
    let Some((last, before)) = steps.split_last() else {
        return Err("expected a key before the `=`, such as time.dt".into());
    };
    if let Some(Step::Key(first)) = steps.first()
        && !TOP.contains(first)
    {
        return Err(unknown_at_the_top(root, first));
    }
    let mut item = root;
    let mut done = String::new();
    for step in before {
        item = enter(item, step, &done)?;
        done += &step.in_words(&done);
    }
    match (last, value(text.trim())?) {
        (Step::Key(key), None) => {
            let table = table(item, &done)?;
            if table.remove(key).is_none() {
                return Err(format!("there is no `{key}`: {}", keys(table, key)));
            }
        }
        (Step::Key(key), Some(value)) => match table(item, &done)?.get_mut(key) {
            Some(old @ Item::Value(_)) => *old = Item::Value(value),
            Some(_) => return Err(format!("`{key}` is a section, expected a key in it")),
            None => {
                table(item, &done)?.insert(key, Item::Value(value));
            }
        },
        (Step::Place(_), None) => return Err("expected a value after the `=`".into()),
        (place @ Step::Place(_), Some(value)) => *enter(item, place, &done)? = Item::Value(value),
    }
    Ok(())
}

/// What is said of a key that no scene has at the top: the section that has it, or the name that was meant.
fn unknown_at_the_top(root: &Item, given: &str) -> String {
    let kind = root.get("problem").and_then(|problem| problem.get("kind"));
    let sections = sections(kind.and_then(Item::as_str));
    let in_section = sections
        .iter()
        .find_map(|(section, names)| names.contains(&given).then(|| format!("{section}.{given}")));
    let meant = in_section.or_else(|| suggest(given, TOP).map(str::to_owned)).or_else(|| {
        let meant = |(section, names): &(&str, Vec<&str>)| {
            Some(format!("{section}.{}", suggest(given, names)?))
        };
        sections.iter().find_map(meant)
    });
    match meant {
        Some(meant) => format!("there is no `{given}` at the top: did you mean `{meant}`?"),
        None => format!(
            "there is no `{given}` at the top, expected a key with its section, such as time.dt"
        ),
    }
}

impl Step<'_> {
    fn in_words(&self, done: &str) -> String {
        match self {
            Step::Key(key) if done.is_empty() => (*key).into(),
            Step::Key(key) => format!(".{key}"),
            Step::Place(place) => format!("[{place}]"),
        }
    }
}

/// The steps of a path such as `problem.parts[1].start[2]`.
fn steps(path: &str) -> Result<Vec<Step<'_>>, String> {
    let mut steps = Vec::new();
    for part in path.split('.') {
        let (key, places) = part.split_at(part.find('[').unwrap_or(part.len()));
        if key.trim().is_empty() {
            return Err("expected a key before the `=`, such as time.dt".into());
        }
        steps.push(Step::Key(key.trim()));
        for place in places.split_inclusive(']') {
            let wrong =
                || format!("found `{place}`, expected a place from 1, such as [1] or [1, 2]");
            let numbers = place.strip_prefix('[').and_then(|place| place.strip_suffix(']'));
            for number in numbers.ok_or_else(wrong)?.split(',') {
                let place = number.trim().parse().ok().filter(|&place| place >= 1);
                steps.push(Step::Place(place.ok_or_else(wrong)?));
            }
        }
    }
    Ok(steps)
}

/// A value; none for nothing. A word, a name such as SO(3) and a formula with parentheses are texts, with or without quotes,
/// also in lists.
fn value(text: &str) -> Result<Option<Value>, String> {
    let read = |text: &str| {
        text.parse().ok().or_else(|| is_bare_text(text).then(|| text.into())).or_else(|| list(text))
    };
    match read(text) {
        _ if text.is_empty() => Ok(None),
        Some(value) => Ok(Some(value)),
        None => Err(format!(
            "`{text}` is no value of TOML, expected a number, a list such as [1, 2, 3] or a text in quotes"
        )),
    }
}

/// Is it a word, or a formula with parentheses?
fn is_bare_text(text: &str) -> bool {
    let is_word = text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
    is_word || text.contains('(') && !text.starts_with(['[', '{', '"', '\''])
}

/// A list with texts that have no quotes. None if it is no list.
fn list(text: &str) -> Option<Value> {
    let inner = text.strip_prefix('[')?.strip_suffix(']')?;
    let (mut entries, mut depth, mut first) = (Vec::new(), 0, 0);
    for (place, c) in inner.char_indices() {
        match c {
            // Within quotes a comma may be anything.
            '"' | '\'' => return None,
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ',' if depth == 0 => {
                entries.push(&inner[first..place]);
                first = place + 1;
            }
            _ => {}
        }
    }
    entries.push(&inner[first..]);
    let values = entries.into_iter().map(|entry| value(entry.trim()).ok().flatten());
    values.collect::<Option<Vec<Value>>>().map(|values| Value::Array(values.into_iter().collect()))
}

/// The item at one step of a key. A missing section is created.
fn enter<'i>(item: &'i mut Item, step: &Step<'_>, done: &str) -> Result<&'i mut Item, String> {
    match step {
        Step::Key(key) => Ok(table(item, done)?.entry(key).or_insert_with(toml_edit::table)),
        Step::Place(place) => {
            let length = match &*item {
                Item::Value(Value::Array(list)) => list.len(),
                Item::ArrayOfTables(list) => list.len(),
                item if item.as_table_like().is_some_and(TableLike::is_empty) => {
                    return Err(format!("the scene has no list `{done}`"));
                }
                _ => return Err(format!("`{done}` is no list")),
            };
            if *place > length {
                let entries = if length == 1 { "entry" } else { "entries" };
                return Err(format!("`{done}` has {length} {entries}"));
            }
            Ok(&mut item[place - 1])
        }
    }
}

/// An item as a table.
fn table<'i>(item: &'i mut Item, done: &str) -> Result<&'i mut dyn TableLike, String> {
    item.as_table_like_mut().ok_or_else(|| format!("`{done}` has no keys"))
}

/// The keys of a table, and which was meant.
fn keys(table: &dyn TableLike, given: &str) -> String {
    help_for(given, &table.iter().map(|(key, _)| key).collect::<Vec<_>>())
}
