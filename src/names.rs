//! Names: spellings that count as one, and the likely meaning of an unknown name.
//!
//! ```
//! use lieflow::names::{Alias, MethodPart, find, meant};
//! assert_eq!(find("RKMK4", ["rk4", "rkmk4"]), Some("rkmk4"));
//! assert_eq!(meant("cayley", &["exp", "cay"]), Some(Alias { name: "cay", part: None }));
//! let rk45 = Alias { name: "rkmk", part: Some(MethodPart::Tableau("dopri5")) };
//! assert_eq!(meant("rk45", &["rkmk4", "rkmk"]), Some(rk45));
//! ```

use core::fmt;

/// A method or map that another program calls by a different name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Alias<'a> {
    /// The name.
    pub name: &'a str,
    /// The part of the method that the other name stands for.
    pub part: Option<MethodPart>,
}

/// A part of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodPart {
    /// A Runge–Kutta tableau.
    Tableau(&'static str),
    /// A coordinate map.
    Map(&'static str),
}

/// As [`MethodSpec`](crate::catalog::MethodSpec) reads it: `rkmk dopri5`.
impl fmt::Display for Alias<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.part {
            None => f.write_str(self.name),
            Some(MethodPart::Tableau(part) | MethodPart::Map(part)) => {
                write!(f, "{} {part}", self.name)
            }
        }
    }
}

/// What a name of another program, or of a book, is here.
enum Is {
    Method(&'static str),
    OfMethod(MethodPart),
}

impl Is {
    /// The method that a part is a part of, with the part.
    const fn method(&self) -> Alias<'static> {
        match *self {
            Is::Method(name) => Alias { name, part: None },
            Is::OfMethod(part @ MethodPart::Tableau(_)) => Alias { name: "rkmk", part: Some(part) },
            Is::OfMethod(part @ MethodPart::Map(_)) => Alias { name: "rkmk4", part: Some(part) },
        }
    }
}

const fn method(name: &'static str) -> Is {
    Is::Method(name)
}
const fn tableau(name: &'static str) -> Is {
    Is::OfMethod(MethodPart::Tableau(name))
}
const fn map(name: &'static str) -> Is {
    Is::OfMethod(MethodPart::Map(name))
}

/// Names of other programs and books. The tableaus and the maps are in it too: they are no methods.
const OTHER_NAMES: &[(&str, Is)] = &[
    ("rk45", tableau("dopri5")),
    ("ode45", tableau("dopri5")),
    ("dopri", tableau("dopri5")),
    ("dp5", tableau("dopri5")),
    ("dopri54", tableau("dopri5")),
    ("dormand-prince", tableau("dopri5")),
    ("tsit5", tableau("dopri5")),
    ("rk5", tableau("dopri5")),
    ("dop8", tableau("dop853")),
    ("dp8", tableau("dop853")),
    ("dopri8", tableau("dop853")),
    ("rk8", tableau("dop853")),
    ("ode78", tableau("dop853")),
    ("ode89", tableau("dop853")),
    ("ode113", tableau("dop853")),
    ("vern8", tableau("dop853")),
    ("vern9", tableau("dop853")),
    ("vern6", tableau("verner6")),
    ("rk6", tableau("verner6")),
    ("rk23", tableau("bs3")),
    ("ode23", tableau("bs3")),
    ("bogacki-shampine", tableau("bs3")),
    ("rk3", tableau("bs3")),
    ("fehlberg", tableau("rkf45")),
    ("rk2", tableau("midpoint")),
    ("lie-euler", tableau("euler")),
    ("euler-forward", tableau("euler")),
    ("euler", tableau("euler")),
    ("midpoint", tableau("midpoint")),
    ("heun", tableau("heun")),
    ("three-eighths", tableau("three-eighths")),
    ("bs3", tableau("bs3")),
    ("rkf45", tableau("rkf45")),
    ("dopri5", tableau("dopri5")),
    ("verner6", tableau("verner6")),
    ("dop853", tableau("dop853")),
    ("exp", map("exp")),
    ("expm", map("exp")),
    ("exponential", map("exp")),
    ("matrix-exponential", map("exp")),
    ("canonical", map("exp")),
    ("cay", map("cay")),
    ("cayley", map("cay")),
    ("rodrigues", map("cay")),
    ("gibbs", map("cay")),
    ("pade", map("pade22")),
    ("pade22", map("pade22")),
    ("ccsk", map("ccsk")),
    ("ccsk123", map("ccsk123")),
    ("ccskf", map("ccsk123")),
    ("ccsk321", map("ccsk321")),
    ("ccskb", map("ccsk321")),
    ("second-kind", map("ccsk")),
    ("euler-angles", map("ccsk123")),
    ("runge-kutta", method("rkmk4")),
    ("munthe-kaas", method("rkmk4")),
    ("magnus", method("magnus4")),
    ("commutator-free", method("cf4")),
    ("celledoni", method("cf4")),
    ("crouch-grossman", method("cg4")),
    ("taylor", method("taylor12")),
    ("gauss", method("gauss4")),
    ("gauss-legendre", method("gauss4")),
    ("radau", method("gauss6")),
    ("implicit-midpoint", method("midpoint-implicit")),
    ("splitting", method("mr4")),
    ("leapfrog", method("mr2")),
    ("verlet", method("mr2")),
    ("strang", method("mr2")),
    ("stormer-verlet", method("mr2")),
    ("mclachlan-reich", method("mr4")),
    ("moser-veselov", method("dmv10")),
    ("dmv", method("dmv10")),
    ("simo", method("simo-wong")),
    ("buss", method("buss4")),
    ("analytic", method("exact")),
    ("closed-form", method("exact")),
    ("symplectic", method("midpoint-implicit")),
    ("isospectral", method("isospectral4")),
];

/// Names of other programs and books, and what each is here.
pub fn other_names() -> impl Iterator<Item = (&'static str, Alias<'static>)> {
    OTHER_NAMES.iter().map(|(name, is)| (*name, is.method()))
}

/// A name in lower case without hyphens, underscores, parentheses and spaces.
pub fn plain(name: &str) -> String {
    letters(name).collect()
}

/// The letters that count.
fn letters(name: &str) -> impl Iterator<Item = char> {
    let counts = |c: &char| !matches!(c, '-' | '_' | '(' | ')') && !c.is_whitespace();
    name.chars().filter(counts).flat_map(char::to_lowercase)
}

/// True if these are two spellings of one name, by [`plain`].
pub fn same(a: &str, b: &str) -> bool {
    a == b || letters(a).eq(letters(b))
}

/// The name that `given` spells, as it stands among these.
pub fn find<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    names.into_iter().find(|name| same(name, given))
}

/// The name that was meant: another spelling, a name of another program, or the closest one where it is close.
pub fn meant<'a>(given: &str, names: &[&'a str]) -> Option<Alias<'a>> {
    let listed = |name| names.iter().find(|listed| **listed == name).copied();
    let here = |is: &Is| {
        let Alias { name, part } = is.method();
        let alone =
            part.and_then(|(MethodPart::Tableau(name) | MethodPart::Map(name))| listed(name));
        let meant = alone.map(|name| Alias { name, part: None });
        meant.or_else(|| Some(Alias { name: listed(name)?, part }))
    };
    let alone = |name| Alias { name, part: None };
    let spelt = find(given, names.iter().copied()).map(alone);
    let other = OTHER_NAMES.iter().find(|(name, _)| same(name, given));
    spelt.or_else(|| other.and_then(|(_, is)| here(is))).or_else(|| near(given, names).map(alone))
}

/// The name that is spelt most like `given`, where that is close.
pub fn near<'a>(given: &str, names: &[&'a str]) -> Option<&'a str> {
    let given = plain(given);
    let length = given.chars().count();
    let allowed = match length {
        0..=1 => 0,
        2..=3 => 1,
        4..=5 => 2,
        n => n / 3,
    };
    let distance = |name: &str| {
        let name = plain(name);
        // A name that was cut short is close whatever is missing, also with a slip in a long one.
        let cut = |k| name.chars().take(k).collect::<String>();
        let slips = |k| strsim::damerau_levenshtein(&given, &cut(k));
        let slips = (length.max(3)..=length + 1).map(slips).min().unwrap_or(usize::MAX);
        match slips <= length / 6 {
            true => Some(slips),
            false => Some(strsim::damerau_levenshtein(&given, &name)).filter(|d| *d <= allowed),
        }
    };
    let close = names.iter().filter_map(|&name| Some((distance(name)?, name)));
    close.min_by_key(|(distance, _)| *distance).map(|(_, name)| name)
}

/// Longer lists are left out where a name of them was meant.
const LISTED: usize = 24;

/// What was expected, in words, behind what was meant.
pub fn expected(meant: Option<&str>, names: &[&str]) -> String {
    let expected = match names {
        [] => "nothing is expected here".into(),
        [name] => format!("expected {name}"),
        names => format!("expected one of {}", names.join(", ")),
    };
    match meant {
        None => expected,
        Some(meant) if names.len() > LISTED => meant.into(),
        Some(meant) => format!("{meant} ({expected})"),
    }
}

/// What was expected instead of `given`, in words: `did you mean `cay`? (expected one of exp, cay)`.
pub(crate) fn help(given: &str, names: &[&str]) -> String {
    let meant = meant(given, names).map(|meant| format!("did you mean `{meant}`?"));
    expected(meant.as_deref(), names)
}
