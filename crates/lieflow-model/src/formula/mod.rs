//! Formulas: functions of a user's own, as text in a scene.
//!
//! | | |
//! |---|---|
//! | numbers | `2`, `0.5`, `1e-3`, `pi`, `e`, the names of `[problem.parameters]` |
//! | units of angles | `deg` `arcmin` `arcsec` `turn` `rev` `rad` and `rpm`, numbers in radians: `5*deg` |
//! | variables | those that the key says, such as `t`, `w1`, `g33`; the columns of a file of samples |
//! | named formulas | the names of `[problem.let]` |
//! | operators | `+` `-` `*` `/` `^` and parentheses; −2^2 = −4, 2^−1 = ½, 2^3^2 = 2^9; whole powers are products |
//! | functions | sin cos tan asin acos atan sinh cosh tanh exp ln log10 sqrt abs sign, atan2(y, x) min(x, y) max(x, y) |
//! | vectors | `[a, b, c]`; `w` where `w1`, `w2`, … have a meaning; `g` where `g11`, `g12`, … have one, a matrix |
//! | of vectors | `+` `-`, products with numbers and matrices, dot cross norm transpose |
//!
//! A number of a scene may be a formula of numbers, too: it is evaluated while the scene is read.
//!
//! A formula is read once, to a list of operations; its derivative is another one. Evaluating it allocates
//! nothing and cannot fail: where it has no value, the value is NaN, and the formula is kept to be named.
//!
//! The crates for expressions have one thing or another of what is needed: powers before signs and to the
//! right, `1e-3`, mistakes with their place, derivatives, operations that are counted. None has all.

mod calculus;
mod expression;
mod functions;
mod lets;
mod lost;
mod names;
mod numbers;
mod parameters;
mod parse;
mod samples;
mod tape;
#[cfg(test)]
mod tests;
mod text;
mod value;

pub use expression::{Formula, without_value};
pub use lets::Lets;
pub(crate) use lost::NEAR;
pub use lost::{Lost, Which};
pub use names::Names;
pub(crate) use names::entry_name;
pub(crate) use numbers::{Constants, Instead, of_keys};
pub use parameters::Parameters;
pub use parse::DECIMAL_POINT;
pub use samples::SamplesFile;
pub use text::{NamedTexts, Text, Texts};
