//! Finds all mistakes of a section. The value with a mistake is replaced by a harmless one, and the section is read again.

use core::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::read::{ReadError, Value};
use super::refusal::Refusal;
use super::suggest::suggest;
use lieflow::names::near;

/// An error of a reading, with its place.
pub(crate) type Found = (Option<Range<usize>>, ReadError);

/// What a reading finds: the next error, if there is one.
type Next = Option<Found>;

/// Reads a section.
type Reading<'r, 'a> = &'r dyn Fn(&Value<'a>) -> Next;

/// A section of a scene, in which values with mistakes are replaced.
struct Mending<'a> {
    text: &'a str,
    value: Value<'a>,
    /// The places of the replaced values.
    places: Vec<Range<usize>>,
    /// The keys of replaced and removed values. A mistake in a formula that uses one of them is not told.
    names: Vec<String>,
    /// Those of these keys whose value was not a formula. A message that contains one of them is not told.
    values: Vec<String>,
    /// The removed keys.
    left_out: Vec<String>,
    /// True if other values may not fit a replacement, for example because it has another size.
    loose: bool,
}

/// Replacements of each type, in the order in which they are tried. The flag is true if a replacement has a size that
/// other values may not fit.
const LITERALS: [(&str, bool); 10] = [
    ("[]", true),
    ("{}", true),
    ("1", false),
    ("2", true),
    ("true", false),
    ("\"0\"", false),
    ("[1, 1]", false),
    ("[1, 1, 1]", false),
    ("[1, 0, 0, 0]", false),
    ("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]", false),
];

/// Replacements of formulas: a constant, a function of t, and a vector.
const FORMULAS: [&str; 3] = ["\"0\"", "\"2*t\"", "\"[0, 0, 0]\""];

/// The number in a row and a column, from 0. A list is the first row.
type Pattern = fn(usize, usize) -> &'static str;

/// Replacements of numbers: all ones; the identity or a unit vector; all zeros; all twos. The flag is that of
/// [`LITERALS`].
const PATTERNS: [(Pattern, bool); 4] = [
    (|_, _| "1", false),
    (|i, j| if i == j { "1" } else { "0" }, false),
    (|_, _| "0", false),
    (|_, _| "2", true),
];

/// A replacement to try, with the flag of [`LITERALS`].
type Candidate<'a> = (DeValue<'a>, bool);

/// The place of a missing key.
const NOWHERE: Range<usize> = usize::MAX..usize::MAX;

/// A step on the way to a value.
enum Step {
    Key(String),
    Place(usize),
}

impl<'a> Mending<'a> {
    fn of(text: &'a str, value: Value<'a>) -> Self {
        let (places, names, values, left_out) = Default::default();
        Mending { text, value, places, names, values, left_out, loose: false }
    }

    /// True if the error may come from a replacement.
    fn explains(&self, (place, error): &Found) -> bool {
        match error {
            ReadError::MissingKey(table, key) => {
                let named = |given: &String| suggest(given, &[key]).is_some();
                self.places.contains(table) || self.left_out.iter().any(named)
            }
            ReadError::UnknownKey(..) | ReadError::Wrong(..) => false,
            ReadError::Refused(Refusal { key, message, .. }) => {
                let place = place.clone().unwrap_or(NOWHERE);
                let message = message.replace(key.as_deref().unwrap_or("\n"), "");
                let text = self.text.get(place.clone()).unwrap_or_default();
                let of_the_section = place == self.value.span();
                self.loose
                    || of_the_section && !self.left_out.is_empty()
                    || self.places.iter().any(|mended| !apart(mended, &place))
                    || says_any(&message, &self.values)
                    || !of_the_section && says_any(text, &self.with_formulas_of(&self.names))
            }
        }
    }

    /// These names, and those of the named formulas that need one of them.
    fn with_formulas_of(&self, names: &[String]) -> Vec<String> {
        let mut names = names.to_vec();
        let lets = self.value.get_ref().get("let").and_then(|lets| lets.get_ref().as_table());
        loop {
            let needs = |value: &Value<'_>| {
                says_any(self.text.get(value.span()).unwrap_or_default(), &names)
            };
            let further: Vec<String> = lets
                .into_iter()
                .flat_map(DeTable::iter)
                .filter(|(name, value)| needs(value) && !names.iter().any(|n| n == name.get_ref()))
                .map(|(name, _)| name.get_ref().to_string())
                .collect();
            if further.is_empty() {
                return names;
            }
            names.extend(further);
        }
    }

    /// Replaces the value with the error and reads again. Returns `None` if no replacement is known to be harmless.
    fn mend(&mut self, (place, error): &Found, read: Reading<'_, 'a>) -> Option<Next> {
        let place = place.clone()?;
        let mut path = Vec::new();
        let found = path_to(&self.value, &place, &mut path);
        match error {
            ReadError::Refused(_) if self.loose || !found => return None,
            ReadError::Refused(_) => {
                // Not the section as a whole.
                path.last()?;
                if is_of_numbers(at(&mut self.value, &path)?.get_ref()) {
                    path.truncate(of_key(&path));
                }
                let wrong = at(&mut self.value, &path)?.get_ref();
                // Numbers of one list may belong together, formulas do not.
                let (of_one, candidates) = (!matches!(wrong, DeValue::String(_)), alike(wrong));
                return self.try_each(&path, candidates, of_one, read);
            }
            ReadError::UnknownKey(.., names) => self.take_away(&place, names)?,
            ReadError::MissingKey(_, key) => {
                let DeValue::Table(table) = at(&mut self.value, &path)?.get_mut() else {
                    return None;
                };
                let nothing = Spanned::new(NOWHERE, DeValue::Boolean(false));
                table.insert(Spanned::new(NOWHERE, (*key).into()), nothing);
                path.push(Step::Key((*key).into()));
                return self.try_literals(&path, read);
            }
            ReadError::Wrong(..) => {
                let within = found && !path.is_empty();
                if let Some(next) = within.then(|| self.try_literals(&path, read)).flatten() {
                    return Some(next);
                }
                self.loose = true;
                self.take_away(&place, &[])?;
            }
        }
        Some(read(&self.value))
    }

    /// Removes the entry of a table, or renames it if one of these names has a similar spelling.
    fn take_away(&mut self, place: &Range<usize>, names: &[&str]) -> Option<()> {
        let mut gone = None;
        at_entry(self.value.get_mut(), place, &mut |table, key| {
            if !rename(table, &key, names) {
                gone = table.remove(key.as_str()).map(|value| (key, value));
            }
        })
        .then_some(())?;
        if let Some((key, value)) = gone {
            self.loose |= !is_of_numbers(value.get_ref());
            for names in [&mut self.left_out, &mut self.names, &mut self.values] {
                names.push(key.clone());
            }
        }
        Some(())
    }

    fn try_literals(&mut self, path: &[Step], read: Reading<'_, 'a>) -> Option<Next> {
        let literals = LITERALS.iter().filter_map(|(text, loose)| Some((literal(text)?, *loose)));
        self.try_each(path, literals.collect(), true, read)
    }

    /// Tries the replacements in turn and keeps the first one that causes no error at this place. With `of_one` no other
    /// mistake in the same list is told.
    fn try_each(
        &mut self,
        path: &[Step],
        candidates: Vec<Candidate<'a>>,
        of_one: bool,
        read: Reading<'_, 'a>,
    ) -> Option<Next> {
        let place = at(&mut self.value, path)?.span();
        let whole = self.value.span();
        let before = at(&mut self.value, path)?.get_ref().clone();
        for (mut candidate, loose) in candidates {
            move_to(&mut candidate, &place);
            *at(&mut self.value, path)?.get_mut() = candidate;
            let next = read(&self.value);
            let harmless = match &next {
                // The keys of a table are mended next.
                Some((_, ReadError::MissingKey(..))) => true,
                Some((Some(other), _)) => *other == whole || apart(other, &place),
                _ => true,
            };
            if harmless {
                let of_key = &path[..of_key(path)];
                if let Some(Step::Key(key)) = of_key.last() {
                    self.names.push(key.clone());
                    self.values.extend(of_one.then(|| key.clone()));
                }
                let all = if of_one { of_key } else { path };
                self.places.extend([at(&mut self.value, all)?.span(), place]);
                self.loose |= loose;
                return Some(next);
            }
        }
        *at(&mut self.value, path)?.get_mut() = before;
        None
    }
}

/// More mistakes than this are not looked for in a value.
const MENDED_MAX: usize = 64;

/// Reads a value, or finds all its mistakes. A mistake is mended in a copy, and the copy is read for the next one, until
/// nothing can be mended. A mistake that may follow from the mending is left out.
///
/// # Errors
/// The mistakes in the order in which they were found, the first of them that of the value as it is.
pub(crate) fn every_mistake<'a, T>(
    text: &'a str,
    value: Value<'a>,
    place: &dyn Fn(&Value<'a>, &ReadError) -> Option<Range<usize>>,
    read: impl Fn(&Value<'_>) -> Result<T, ReadError>,
) -> Result<T, Vec<Found>> {
    let attempt = |value: &Value<'a>| read(value).map_err(|error| (place(value, &error), error));
    let first = match attempt(&value) {
        Ok(read) => return Ok(read),
        Err(found) => found,
    };
    Err(mistakes_from(first, Mending::of(text, value), &|value| attempt(value).err()))
}

/// The mistakes from the first one on.
fn mistakes_from<'a>(first: Found, mut mending: Mending<'a>, read: Reading<'_, 'a>) -> Vec<Found> {
    let (mut mistakes, mut next) = (Vec::new(), Some(first));
    for _ in 0..MENDED_MAX {
        let Some(found) = next else { break };
        let follows = mending.explains(&found);
        next = mending.mend(&found, read).flatten();
        if !follows {
            mistakes.push(found);
        }
    }
    mistakes
}

/// The number of steps of a path up to its last key.
fn of_key(path: &[Step]) -> usize {
    path.iter().rposition(|step| matches!(step, Step::Key(_))).map_or(0, |last| last + 1)
}

/// True if two places do not overlap.
fn apart(a: &Range<usize>, b: &Range<usize>) -> bool {
    a != b && (a.end <= b.start || b.end <= a.start)
}

/// True if a text contains one of these names, or an entry `b1` of a name `b`.
fn says_any(text: &str, names: &[String]) -> bool {
    let mut words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.any(|word| {
        let whole = word.trim_end_matches(|c: char| c.is_ascii_digit());
        names.iter().any(|name| name == word || name == whole)
    })
}

/// Parses one of the replacements above.
fn literal(text: &'static str) -> Option<DeValue<'static>> {
    DeValue::parse(text).ok().map(Spanned::into_inner)
}

/// The replacements with the shape of a value.
fn alike<'a>(value: &DeValue<'a>) -> Vec<Candidate<'a>> {
    match value {
        DeValue::String(_) => {
            FORMULAS.iter().filter_map(|text| Some((literal(text)?, false))).collect()
        }
        _ => PATTERNS.map(|(pattern, loose)| (filled(value, &[], pattern), loose)).into(),
    }
}

/// The value with its numbers replaced by those of a pattern. `at` has the indices of the lists around it.
fn filled<'a>(value: &DeValue<'a>, at: &[usize], pattern: Pattern) -> DeValue<'a> {
    let mut copy = value.clone();
    match &mut copy {
        DeValue::Integer(_) | DeValue::Float(_) => {
            let [.., i, j] = [&[0, 0], at].concat()[..] else { return copy };
            return literal(pattern(i, j)).unwrap_or(copy);
        }
        DeValue::Array(list) => {
            for (i, entry) in list.iter_mut().enumerate() {
                *entry.get_mut() = filled(entry.get_ref(), &[at, &[i]].concat(), pattern);
            }
        }
        DeValue::Table(table) => {
            for (_, entry) in table.iter_mut() {
                *entry.get_mut() = filled(entry.get_ref(), &[], pattern);
            }
        }
        _ => {}
    }
    copy
}

/// True for a number, and for a list of numbers.
fn is_of_numbers(value: &DeValue<'_>) -> bool {
    match value {
        DeValue::Integer(_) | DeValue::Float(_) => true,
        DeValue::Array(list) => list.iter().all(|entry| is_of_numbers(entry.get_ref())),
        _ => false,
    }
}

/// Sets the place of all entries of a value.
fn move_to(value: &mut DeValue<'_>, place: &Range<usize>) {
    if let DeValue::Array(list) = value {
        for entry in list.iter_mut() {
            let mut inner = core::mem::replace(entry.get_mut(), DeValue::Boolean(false));
            move_to(&mut inner, place);
            *entry = Spanned::new(place.clone(), inner);
        }
    }
}

/// Writes the steps to the outermost value at this place into `path`. Returns false if there is no such value.
fn path_to(value: &Value<'_>, place: &Range<usize>, path: &mut Vec<Step>) -> bool {
    if value.span() == *place {
        return true;
    }
    let mut into = |step: Step, entry: &Value<'_>| {
        path.push(step);
        let found = path_to(entry, place, path);
        if !found {
            path.pop();
        }
        found
    };
    match value.get_ref() {
        DeValue::Table(table) => {
            table.iter().any(|(key, entry)| into(Step::Key(key.get_ref().to_string()), entry))
        }
        DeValue::Array(list) => {
            list.iter().enumerate().any(|(i, entry)| into(Step::Place(i), entry))
        }
        _ => false,
    }
}

/// The value at the end of a path.
fn at<'v, 'a>(value: &'v mut Value<'a>, path: &[Step]) -> Option<&'v mut Value<'a>> {
    path.iter().try_fold(value, |value, step| match (value.get_mut(), step) {
        (DeValue::Table(table), Step::Key(key)) => table.get_mut(key.as_str()),
        (DeValue::Array(list), Step::Place(i)) => list.get_mut(*i),
        _ => None,
    })
}

/// Calls `act` on the innermost table entry that contains a place. Returns false if no entry contains it.
fn at_entry<'a>(
    value: &mut DeValue<'a>,
    place: &Range<usize>,
    act: &mut dyn FnMut(&mut DeTable<'a>, String),
) -> bool {
    let found = match value {
        DeValue::Table(table) => {
            table.iter_mut().any(|(_, value)| at_entry(value.get_mut(), place, act))
        }
        DeValue::Array(list) => list.iter_mut().any(|entry| at_entry(entry.get_mut(), place, act)),
        _ => false,
    };
    let DeValue::Table(table) = value else { return found };
    let holds = |span: Range<usize>| span.start <= place.start && place.end <= span.end;
    let mut entries = table.iter();
    let entry = entries.find(|(key, value)| holds(key.span()) || holds(value.span()));
    match entry.map(|(key, _)| key.get_ref().to_string()) {
        Some(key) if !found => {
            act(table, key);
            true
        }
        _ => found,
    }
}

/// Renames an entry if one of these names has a similar spelling and is free.
pub(crate) fn rename(table: &mut DeTable<'_>, given: &str, names: &[&str]) -> bool {
    let Some(meant) = near(given, names).filter(|meant| !table.contains_key(*meant)) else {
        return false;
    };
    table.remove_entry(given).is_some_and(|(key, value)| {
        table.insert(Spanned::new(key.span(), meant.to_owned().into()), value);
        true
    })
}
