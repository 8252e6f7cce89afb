//! From the text of a formula to its operations.
//!
//! | rule | |
//! |---|---|
//! | sum | product (`+` product, `-` product)* |
//! | product | signed (`*` signed, `/` signed)* |
//! | signed | `-` signed, `+` signed, power |
//! | power | atom, atom `^` signed |
//! | atom | number, name, name `(` sum (`,` sum) `)`, `(` sum `)`, `[` sum (`,` sum)* `]` |
//!
//! In brackets numbers are a vector, and vectors of one length the rows of a matrix.
//!
//! So −2^2 = −(2²), 2^−1 = ½ and 2^3^2 = 2^(3²). Each part is a [`Value`]: a number, a vector or a matrix. Vectors
//! and matrices are there while a formula is read; what becomes of it are operations on numbers.

use super::functions::{CALLED, Called, Function, Operator, angle_unit};
use super::names::{Meaning, Names, continues_name, starts_name};
use super::tape::{Builder, LENGTH_MAX, Tape};
use super::value::Value;
use crate::reader::{help_for, is_in_range};

/// Names of units that people write after a number.
const UNITS: [&str; 38] = [
    "m", "mm", "um", "nm", "cm", "km", "s", "ms", "us", "ns", "min", "h", "d", "g", "kg", "N",
    "mN", "kN", "Nm", "Nms", "J", "W", "V", "A", "T", "mT", "nT", "G", "K", "Pa", "Hz", "kHz",
    "MHz", "GHz", "rpm", "eV", "keV", "MeV",
];

/// The help for a number with a comma.
pub const DECIMAL_POINT: &str = "a number is written with a decimal point, not a comma: 0.5";

/// What is wrong with a formula.
#[derive(Debug)]
pub(super) struct Mistake {
    pub(super) message: String,
    /// The character, from 0.
    pub(super) at: usize,
    pub(super) help: Option<String>,
    /// True if it follows from the mistakes of a named formula, which are known.
    pub(super) is_known: bool,
    /// True for a name of what may change with time, where it may not.
    pub(super) varies: bool,
    /// True if it is one whatever the names mean.
    pub(super) is_of_form: bool,
}

impl Mistake {
    fn new(message: String, at: usize) -> Self {
        Mistake { message, at, help: None, is_known: false, varies: false, is_of_form: false }
    }
}

/// The largest depth of parentheses, signs and powers. Each level is one call.
const NESTING_MAX: usize = 64;

/// Longer texts are not formulas.
const TEXT_MAX: usize = 1 << 16;

/// The entries of a formula, row by row, and the number of its rows: of a number, one and 1.
pub(super) struct Parsed {
    pub(super) rows: usize,
    pub(super) entries: Vec<Tape>,
}

pub(super) fn parse(text: &str, names: &Names) -> Result<Parsed, Mistake> {
    let plain = |message: String| Mistake { is_of_form: true, ..Mistake::new(message, 0) };
    if text.len() > TEXT_MAX {
        return Err(plain(format!(
            "a formula of {} bytes, expected at most {TEXT_MAX}",
            text.len()
        )));
    }
    let (text, build) = (text.chars().collect::<Vec<_>>(), Builder::default());
    let mut parser = Parser { text: &text, names, at: 0, depth: 0, build };
    let root = parser.sum()?;
    if parser.peek().is_some() {
        return Err(parser.expected_operator("the end"));
    }
    let entries = root.entries.iter().map(|&entry| parser.build.finish(entry)).collect();
    let too_long = || plain(format!("a formula of more than {LENGTH_MAX} operations"));
    Ok(Parsed { rows: root.rows, entries: Option::ok_or_else(entries, too_long)? })
}

/// The number at the end of a text, as in `2*1e-5`.
fn number_at_end(text: &[char]) -> Option<String> {
    let text: String = text.iter().collect();
    let text = text.trim_end();
    let starts = text.char_indices().filter(|(at, c)| {
        let is_within = text[..*at].ends_with(|c: char| continues_name(c) || c == '.');
        !is_within && c.is_ascii_digit()
    });
    let mut rests = starts.map(|(at, _)| &text[at..]);
    rests.find(|rest| rest.parse::<f64>().is_ok()).map(str::to_owned)
}

struct Parser<'a> {
    text: &'a [char],
    names: &'a Names,
    at: usize,
    depth: usize,
    build: Builder,
}

impl Parser<'_> {
    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        while self.text.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }
    /// The next character where it is one of these; it is passed.
    fn take(&mut self, wanted: &[char]) -> Option<char> {
        let found = self.peek().filter(|c| wanted.contains(c))?;
        self.at += 1;
        Some(found)
    }
    /// The characters from here on that are wanted; they are passed.
    fn take_while(&mut self, wanted: impl Fn(char) -> bool) -> String {
        let rest = &self.text[self.at.min(self.text.len())..];
        let taken: String = rest.iter().copied().take_while(|&c| wanted(c)).collect();
        self.at += taken.chars().count();
        taken
    }

    fn mistake(&self, message: &str, at: usize) -> Mistake {
        let message = format!("{message} at character {} of the formula", at + 1);
        Mistake::new(message, at)
    }
    /// A mistake whatever the names mean.
    fn of_form(&self, message: &str, at: usize) -> Mistake {
        Mistake { is_of_form: true, ..self.mistake(message, at) }
    }
    /// What is next was not expected.
    fn expected(&mut self, what: &str) -> Mistake {
        let next = self.peek();
        let found = match next {
            Some(c) => format!("found `{}`, expected {what}", c.escape_debug()),
            None => format!("the formula ends here; expected {what}"),
        };
        let mut mistake = self.of_form(&found, self.at);
        let before = self.at.checked_sub(1).and_then(|at| self.text.get(at)).copied();
        mistake.help = match (before, next) {
            (Some('*'), Some('*')) => Some("a power is written x^2".into()),
            (Some('0'..='9'), Some(','))
                if self.text.get(self.at + 1).is_some_and(char::is_ascii_digit) =>
            {
                Some(DECIMAL_POINT.into())
            }
            (_, Some('°')) => Some("degrees are written 5*deg".into()),
            (_, Some('<' | '>' | '=')) => Some("a formula is a number, and no comparison".into()),
            _ => None,
        };
        mistake
    }

    /// What is next was not expected, but an operator or this.
    fn expected_operator(&mut self, or: &str) -> Mistake {
        let mut mistake = self.expected(&format!("an operator or {or}"));
        if self.peek().is_some_and(|c| starts_name(c) || c == '(') {
            mistake.help = Some(self.as_product());
        }
        mistake
    }

    /// How the product of what is before this place and what is next is written.
    fn as_product(&self) -> String {
        let (before, next) = self.text.split_at(self.at);
        let word = |c: &&char| continues_name(**c) || **c == '.';
        let first: Vec<char> = before
            .iter()
            .rev()
            .skip_while(|c| c.is_whitespace())
            .take_while(word)
            .copied()
            .collect();
        let first: String = first.into_iter().rev().collect();
        let second: String = next.iter().take_while(word).collect();
        if first.is_empty() || second.is_empty() {
            return "a product is written 2*x".into();
        }
        let is_call = next.get(second.chars().count()) == Some(&'(');
        let is_known = self.names.varies(&second) || self.names.meaning(&second).is_some();
        match (angle_unit(&second), number_at_end(before)) {
            (true, _) => {
                format!("write {first}*{second}; other units than those of angles are left out")
            }
            (false, Some(number)) if !is_call && !is_known => match second.as_str() {
                "i" | "j" => format!(
                    "formulas are real: an imaginary part {number} has a key of its own, as in hamiltonian_imaginary"
                ),
                second if second.starts_with('_') => {
                    "the digits of a number are written without `_`".into()
                }
                second if UNITS.contains(&second) => {
                    format!("write {number}; units are left out, but for those of angles")
                }
                second => format!("a product is written {first}*{second}"),
            },
            _ => format!("a product is written {first}*{second}"),
        }
    }

    fn sum(&mut self) -> Result<Value, Mistake> {
        let mut sum = self.product()?;
        while let Some((at, sign)) = self.operator(&['+', '-']) {
            let next = self.product()?;
            let operator = if sign == '+' { Operator::Add } else { Operator::Sub };
            sum = self.combine(operator, sum, next, at)?;
        }
        Ok(sum)
    }
    fn product(&mut self) -> Result<Value, Mistake> {
        let mut product = self.signed()?;
        while let Some((at, sign)) = self.operator(&['*', '/']) {
            let next = self.signed()?;
            let operator = if sign == '*' { Operator::Mul } else { Operator::Div };
            product = self.combine(operator, product, next, at)?;
        }
        Ok(product)
    }
    /// One of these signs with its place; it is passed.
    fn operator(&mut self, wanted: &[char]) -> Option<(usize, char)> {
        self.take(wanted).map(|sign| (self.at - 1, sign))
    }
    fn combine(
        &mut self,
        operator: Operator,
        x: Value,
        y: Value,
        at: usize,
    ) -> Result<Value, Mistake> {
        x.combine(operator, &y, &mut self.build)
            .map_err(|(message, help)| Mistake { help, ..self.mistake(&message, at) })
    }
    /// All that lies within something else passes here.
    fn signed(&mut self) -> Result<Value, Mistake> {
        if self.depth == NESTING_MAX {
            return Err(self.of_form(&format!("more than {NESTING_MAX} levels"), self.at));
        }
        self.depth += 1;
        let signed = match self.take(&['-', '+']) {
            Some('-') => self.signed().map(|x| x.map(|x| self.build.apply(Function::Neg, x))),
            Some(_) => self.signed(),
            None => self.power(),
        };
        self.depth -= 1;
        signed
    }
    fn power(&mut self) -> Result<Value, Mistake> {
        let base = self.atom()?;
        match self.operator(&['^']) {
            None => Ok(base),
            Some((at, _)) => {
                let exponent = self.signed()?;
                self.combine(Operator::Pow, base, exponent, at)
            }
        }
    }
    fn atom(&mut self) -> Result<Value, Mistake> {
        match self.peek() {
            Some(c) if c.is_ascii_digit() || c == '.' => self.number().map(Value::number),
            Some(c) if starts_name(c) => self.name(),
            Some('(') => {
                self.at += 1;
                let inside = self.sum()?;
                self.close()?;
                Ok(inside)
            }
            Some('[') => {
                self.at += 1;
                let Value { rows: length, mut entries } = self.entry(None)?;
                let mut rows = 1;
                while self.take(&[',']).is_some() {
                    entries.extend(self.entry(Some(length))?.entries);
                    rows += 1;
                }
                match self.take(&[']']) {
                    Some(_) => Ok(Value { rows, entries }),
                    None => Err(self.expected("`,` or `]`")),
                }
            }
            _ => Err(self.expected("a number, a name or a parenthesis")),
        }
    }
    /// A component of a vector that is written out, or a row of a matrix: of this length, where the first one has it.
    fn entry(&mut self, length: Option<usize>) -> Result<Value, Mistake> {
        let (at, value) = (self.at, self.sum()?);
        if value.columns() == 1 && length.is_none_or(|length| value.rows == length) {
            return Ok(value);
        }
        let expected = match length {
            None => "a number or a row of numbers".into(),
            Some(1) => "a number".into(),
            Some(length) => format!("a row of {length} numbers"),
        };
        Err(self.mistake(&format!("found {value}, expected {expected}"), at))
    }
    fn close(&mut self) -> Result<(), Mistake> {
        match self.take(&[')']) {
            Some(_) => Ok(()),
            None => Err(self.expected_operator("`)`")),
        }
    }

    fn number(&mut self) -> Result<usize, Mistake> {
        let start = self.at;
        let mut digits = self.take_while(|c| c.is_ascii_digit() || c == '.');
        // An exponent, where digits follow: `2e` is 2 and a name.
        let rest = &self.text[self.at..];
        let signed = matches!(rest, ['e' | 'E', '+' | '-', ..]);
        let skipped = if signed { 2 } else { 1 };
        if let [Some('e' | 'E'), Some('0'..='9')] = [rest.first(), rest.get(skipped)] {
            digits.extend(&rest[..skipped]);
            self.at += skipped;
            digits += &self.take_while(|c| c.is_ascii_digit());
        }
        match digits.parse::<f64>() {
            Ok(x) if is_in_range(x, &digits) => Ok(self.build.number(x)),
            Ok(_) => Err(self.of_form(&format!("the number {digits} is out of range"), start)),
            Err(_) => Err(self.of_form(&format!("`{digits}` is not a number"), start)),
        }
    }

    fn name(&mut self) -> Result<Value, Mistake> {
        let start = self.at;
        let name = self.take_while(continues_name);
        if self.peek() == Some('(') {
            return self.call(&name, start);
        }
        if let Some(value) = self.value_of(&name) {
            return Ok(value);
        }
        if CALLED.iter().any(|(called, _)| *called == name) {
            return Err(self.expected(&format!("`(` after {name}")));
        }
        if self.names.is_open() {
            return Ok(Value::number(self.build.number(1.0)));
        }
        if let Some(why) = self.names.unusable(&name) {
            let reason = why.unwrap_or_default();
            let message = format!("`{name}` of [problem.let] has no meaning here ({reason})");
            return Err(Mistake { is_known: why.is_none(), ..self.mistake(&message, start) });
        }
        let varies = self.names.varies(&name);
        let (message, help) = match varies {
            true => (format!("`{name}` may change with time"), None),
            false => (format!("unknown name `{name}`"), Some(self.names.help_for(&name))),
        };
        let unit = "units are left out, but for those of angles".to_string();
        let unit = (!varies && UNITS.contains(&&*name)).then_some(unit);
        let help = unit.into_iter().chain(help).chain([self.names.where_to_state(&name)]);
        let help = Some(help.collect::<Vec<_>>().join("; "));
        Err(Mistake { help, varies, ..self.mistake(&message, start) })
    }
    /// A number of that name; the vector of x1, x2, … by the name x; the matrix of x11, x12, … by the name x.
    fn value_of(&mut self, name: &str) -> Option<Value> {
        if self.names.is_unusable(name) {
            return None;
        }
        if let Some(number) = self.number_of(name) {
            return Some(Value::number(number));
        }
        let (rows, names) = self.names.numbers_of(name)?;
        let entries = names.iter().map(|name| self.number_of(name)).collect::<Option<_>>()?;
        Some(Value { rows, entries })
    }
    fn number_of(&mut self, name: &str) -> Option<usize> {
        Some(match self.names.meaning(name)? {
            Meaning::Variable(index) => self.build.variable(index),
            Meaning::Sample(column) => self.build.sample(column, 0),
            Meaning::Number(x) => self.build.number(x),
            Meaning::Formula(entry) => self.build.include(&entry.tape),
        })
    }
    fn call(&mut self, name: &str, start: usize) -> Result<Value, Mistake> {
        let Some(called) = Called::named(name) else {
            if self.names.meaning(name).is_some() {
                return Err(self.expected_operator("the end"));
            }
            let names: Vec<&str> = Called::names().collect();
            let mistake = self.of_form(&format!("unknown function `{name}`"), start);
            let help = match name {
                "log" => "did you mean `ln`? `log10` is that of base 10".into(),
                name => help_for(name, &names),
            };
            return Err(Mistake { help: Some(help), ..mistake });
        };
        self.at += 1;
        let first = self.sum()?;
        let second = match called.second() {
            None => None,
            Some(_) if self.take(&[',']).is_some() => Some(self.sum()?),
            Some(takes) => return Err(self.expected(&format!("`,`: {name} takes {takes}"))),
        };
        if self.peek() == Some(',') {
            let mistake = self.expected_operator("`)`");
            let takes = format!("{name} takes {}", called.takes());
            let comma = mistake.help.clone().filter(|_| second.is_none());
            let help = [Some(takes), comma].into_iter().flatten().collect::<Vec<_>>().join("; ");
            return Err(Mistake { help: Some(help), ..mistake });
        }
        self.close()?;
        first.call(called, second.as_ref(), &mut self.build).map_err(|found| {
            let message = format!("{name} of {found}, expected {}", called.takes());
            self.mistake(&message, start)
        })
    }
}
