//! From the text of a formula to its operations.
//!
//! | rule | |
//! |---|---|
//! | sum | product (`+` product, `-` product)* |
//! | product | signed (`*` signed, `/` signed)* |
//! | signed | `-` signed, `+` signed, power |
//! | power | atom, atom `^` signed |
//! | atom | number, name, name `(` sum (`,` sum) `)`, `(` sum `)` |
//!
//! So −2^2 = −(2²), 2^−1 = ½ and 2^3^2 = 2^(3²).

use super::super::help_for;
use super::functions::{CALLED, Called, Function, Operator};
use super::names::{Meaning, Names, continues_name, starts_name};
use super::tape::{Builder, LENGTH_MAX, Tape};

/// What is wrong with a formula.
#[derive(Debug)]
pub(super) struct Mistake {
    pub(super) message: String,
    pub(super) help: Option<String>,
}

/// Parentheses, signs and powers within each other, at most: each is a call of its own.
const NESTING_MAX: usize = 64;

/// Longer texts are not formulas.
const TEXT_MAX: usize = 1 << 16;

pub(super) fn parse(text: &str, names: &Names) -> Result<Tape, Mistake> {
    let plain = |message: String| Mistake { message, help: None };
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
        return Err(parser.expected("an operator or the end"));
    }
    let too_long = || plain(format!("a formula of more than {LENGTH_MAX} operations"));
    parser.build.finish(root).ok_or_else(too_long)
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
        Mistake { message: format!("{message} at character {} of the formula", at + 1), help: None }
    }
    /// What is next was not expected.
    fn expected(&mut self, what: &str) -> Mistake {
        let next = self.peek();
        let found = next.map_or("nothing more".into(), |c| format!("`{}`", c.escape_debug()));
        let mut mistake = self.mistake(&format!("found {found}, expected {what}"), self.at);
        let before = self.at.checked_sub(1).and_then(|at| self.text.get(at)).copied();
        mistake.help = match (before, next) {
            (Some('*'), Some('*')) => Some("a power is written x^2".into()),
            (Some(_), Some(c)) if what.contains("operator") && (starts_name(c) || c == '(') => {
                Some("a product is written 2*x".into())
            }
            _ => None,
        };
        mistake
    }

    fn sum(&mut self) -> Result<usize, Mistake> {
        let mut sum = self.product()?;
        while let Some(sign) = self.take(&['+', '-']) {
            let next = self.product()?;
            let operator = if sign == '+' { Operator::Add } else { Operator::Sub };
            sum = self.build.combine(operator, sum, next);
        }
        Ok(sum)
    }
    fn product(&mut self) -> Result<usize, Mistake> {
        let mut product = self.signed()?;
        while let Some(sign) = self.take(&['*', '/']) {
            let next = self.signed()?;
            let operator = if sign == '*' { Operator::Mul } else { Operator::Div };
            product = self.build.combine(operator, product, next);
        }
        Ok(product)
    }
    /// All that lies within something else passes here.
    fn signed(&mut self) -> Result<usize, Mistake> {
        if self.depth == NESTING_MAX {
            return Err(self.mistake(&format!("more than {NESTING_MAX} levels"), self.at));
        }
        self.depth += 1;
        let signed = match self.take(&['-', '+']) {
            Some('-') => self.signed().map(|x| self.build.apply(Function::Neg, x)),
            Some(_) => self.signed(),
            None => self.power(),
        };
        self.depth -= 1;
        signed
    }
    fn power(&mut self) -> Result<usize, Mistake> {
        let base = self.atom()?;
        match self.take(&['^']) {
            None => Ok(base),
            Some(_) => {
                let exponent = self.signed()?;
                Ok(self.build.combine(Operator::Pow, base, exponent))
            }
        }
    }
    fn atom(&mut self) -> Result<usize, Mistake> {
        match self.peek() {
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if starts_name(c) => self.name(),
            Some('(') => {
                self.at += 1;
                let inside = self.sum()?;
                self.close()?;
                Ok(inside)
            }
            _ => Err(self.expected("a number, a name or a parenthesis")),
        }
    }
    fn close(&mut self) -> Result<(), Mistake> {
        match self.take(&[')']) {
            Some(_) => Ok(()),
            None => Err(self.expected("an operator or `)`")),
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
            Ok(x) if x.is_finite() => Ok(self.build.number(x)),
            Ok(_) => Err(self.mistake(&format!("the number {digits} is out of range"), start)),
            Err(_) => Err(self.mistake(&format!("`{digits}` is no number"), start)),
        }
    }

    fn name(&mut self) -> Result<usize, Mistake> {
        let start = self.at;
        let name = self.take_while(continues_name);
        if self.peek() == Some('(') {
            return self.call(&name, start);
        }
        match self.names.meaning(&name) {
            Some(Meaning::Variable(index)) => Ok(self.build.variable(index)),
            Some(Meaning::Sample(column)) => Ok(self.build.sample(column, 0)),
            Some(Meaning::Number(x)) => Ok(self.build.number(x)),
            None if CALLED.iter().any(|(called, _)| *called == name) => {
                Err(self.expected(&format!("`(` after {name}")))
            }
            None => Err(Mistake {
                help: Some(help_for(&name, &self.names.all())),
                ..self.mistake(&format!("unknown name `{name}`"), start)
            }),
        }
    }
    fn call(&mut self, name: &str, start: usize) -> Result<usize, Mistake> {
        let Some((_, called)) = CALLED.iter().find(|(called, _)| *called == name) else {
            if self.names.meaning(name).is_some() {
                return Err(self.expected("an operator or the end"));
            }
            let names: Vec<&str> = CALLED.iter().map(|(name, _)| *name).collect();
            let mistake = self.mistake(&format!("unknown function `{name}`"), start);
            return Err(Mistake { help: Some(help_for(name, &names)), ..mistake });
        };
        self.at += 1;
        let first = self.sum()?;
        match called {
            Called::One(function) => {
                self.close()?;
                Ok(self.build.apply(*function, first))
            }
            Called::Two(operator) => {
                if self.take(&[',']).is_none() {
                    return Err(self.expected(&format!("`,`: {name} takes two numbers")));
                }
                let second = self.sum()?;
                self.close()?;
                Ok(self.build.combine(*operator, first, second))
            }
        }
    }
}
