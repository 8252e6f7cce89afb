//! `kind = "matrix-ode"`: an equation ẏ = λ_*(f(t, y))(y) with f(t, y) ∈ 𝔤 in formulas.
//!
//! | action | ẏ | kept by the action |
//! |---|---|---|
//! | translation | f y, y ∈ G | yᵀMy = M |
//! | linear | f y | yᵀMy |
//! | conjugation | f y − y f | tr yᵏ |
//! | coadjoint | y fᵀ − fᵀ y | tr yᵏ |
//! | lagrangian | c + dy − ya − yby, f = \[a b; c d\] in sp(2m), y symmetric | |
//!
//! Of U(n) and SU(n) y and f are complex, and ᵀ is †. M is that of the group; GL(n) and SL(n) have none. The projection
//! of f on 𝔤 is integrated: it takes rounding away. An f that is not in 𝔤 at the start, or at a point beside it, is
//! refused, and an f that leaves 𝔤 later ends the run. Where f depends on t alone the equation is of linear type, and
//! Magnus methods fit.

mod equation;

use std::sync::Arc;

use lieflow::dense::largest_entry;
use lieflow::groups::{GroupMatrix, LieAlgebra, LieGroup, MatrixGroup};
use lieflow_runs::spaces::MatrixAction;

use self::equation::Equation;
use super::algebra::{ALGEBRAS, Algebra};
use super::body::TYPED;
use super::entries::{NAMED_MAX, above_diagonal, check_rows, check_symmetric, side_of, whole};
use super::prelude::*;
use crate::formula::{Formula, Names, Text, Texts};
use crate::problem::row_columns;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "matrix-ode",
    equation: "ẏ = f y (translation, linear), f y − y f (conjugation), y fᵀ − fᵀ y (coadjoint; fᴴ for u and su), c + d y − y a − y b y \
               (lagrangian, f = [a b; c d]), f(t, y) in the algebra",
    summary: "an equation on matrices in formulas, by the action of a matrix group",
    ..Kind::of::<Keys, Equation>(|section| read_with(section, read))
};

keys! { Keys [sample_keys formula_keys] {
    group: String =
        "\"so\", \"sl\", \"gl\", \"sp\", \"so(p,q)\", or of complex matrices \"u\", \"su\"; also with n, as \
         \"SO(4)\"",
    action: Option<String> =
        "\"translation\", \"linear\", \"conjugation\", \"coadjoint\" or, of sp, \"lagrangian\"; optional: \
         translation",
    field: Vec<Texts> =
        "n rows of n formulas, n at most 9: f in the algebra, by the time t and the entries y11, y12, ... of the \
         point, of complex ones re11, re12, ..., im11, ...; of so also a list of the n(n-1)/2 formulas above the \
         diagonal, row by row",
    field_imaginary: Option<Vec<Texts>> =
        "of u and su: the imaginary part of f, n rows of n formulas; optional, 0",
    start: Option<Table> =
        "initial point, n rows, of n numbers, for linear of 1 to 9; for translation in the group and optional, the \
         identity; for lagrangian symmetric, n/2 rows of n/2",
    start_imaginary: Option<Table> = "of u and su: its imaginary part; optional, 0",
} }

const ACTIONS: [(&str, MatrixAction); 5] = [
    ("translation", MatrixAction::Translation),
    ("linear", MatrixAction::Linear),
    ("conjugation", MatrixAction::Conjugation),
    ("coadjoint", MatrixAction::Coadjoint),
    ("lagrangian", MatrixAction::Lagrangian),
];

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let (formulas, samples) = (keys.formula_keys(), keys.sample_keys());
    let named = keys.group.and_then(|group| {
        let unknown = || Refusal::unknown("group", &group, &ALGEBRAS);
        Ok((Algebra::named(&group).ok_or_else(unknown)?, group))
    });
    let action = keys.action.and_then(|action| {
        let action = action.as_deref().unwrap_or("translation");
        let unknown = || Refusal::unknown("action", action, &ACTIONS.map(|(name, _)| name));
        let (_, action) = ACTIONS.iter().find(|(name, _)| *name == action).ok_or_else(unknown)?;
        Ok(*action)
    });
    let ((named, group), action) = all!(named, action)?;
    let algebra = named.algebra;
    let complex = algebra.is_complex();
    let given = |key: &'static str, given: bool| (given && !complex).then_some(key);
    let imaginary = given("field_imaginary", !matches!(keys.field_imaginary, Ok(None)))
        .or_else(|| given("start_imaginary", !matches!(keys.start_imaginary, Ok(None))));
    if let Some(key) = imaginary {
        let message = format!("{group} has real matrices; complex ones are of u and su");
        return Err(Refusal::at(key, message).into());
    }
    let Keys { field, field_imaginary, start: real, start_imaginary, .. } = keys;
    let (field, field_imaginary, real, start_imaginary) =
        all!(field, field_imaginary, real, start_imaginary)?;
    let (n, by_upper, mut field) = entries_of(algebra, "field", field)?;
    if !(1..=NAMED_MAX).contains(&n) {
        let message = format!("found {}, expected 1 to {NAMED_MAX}", amount(n, "rows"));
        return Err(Refusal::at("field", message).into());
    }
    if let Some(imaginary) = field_imaginary {
        let (rows, _, imaginary) = entries_of(algebra, "field_imaginary", imaginary)?;
        if rows != n {
            let message = format!("found {}, expected {n} as field has", amount(rows, "rows"));
            return Err(Refusal::at("field_imaginary", message).into());
        }
        let below = |((i, j), key, text)| ((n + i, j), key, text);
        field.extend(imaginary.into_iter().map(below));
    }
    named.check_size(n, "field")?;
    let group = algebra.group(n, "field")?;
    if action == MatrixAction::Lagrangian && algebra != Algebra::Sp {
        return Err(Refusal::at("action", "lagrangian is an action of sp").into());
    }
    let (mut notes, mut mistakes) = (Vec::new(), ReadError::default());
    let start = start(algebra, &group, action, [real, start_imaginary], &mut notes);
    // Only of this action the start says how many entries a point has.
    let shape = match action {
        MatrixAction::Linear => seen(&start).map(|start| [n, start.ncols()]),
        MatrixAction::Lagrangian => Ok([n / 2, n / 2]),
        _ => Ok([n, n]),
    };
    let names = shape.and_then(|shape| {
        let variables = ["t".to_owned()].into_iter().chain(entry_names(algebra, shape));
        formulas.names("field", variables, samples)
    });
    let formulas = field.into_iter().filter_map(|(place, key, Text(text))| {
        let formula = match &names {
            Ok(names) => Formula::read(&key, &text, names),
            Err(_) => Formula::check_form(&key, &text).and_then(|()| Err(ReadError::known())),
        };
        Some((place, mistakes.keep(formula)?))
    });
    let field: Arc<[_]> = formulas.collect();
    let (names, start) = (mistakes.keep(names.and_then(Names::checked)), mistakes.keep(start));
    let (names, start) = mistakes.or(names.zip(start))?;
    let linear = (1..names.variables().len()).all(|y| field.iter().all(|(_, f)| !f.uses(y)));
    let equation = Equation { algebra, group, action, field, by_upper, linear, start, notes };
    Ok(Forms::of(equation))
}

/// The letters of the parts of a matrix.
fn letters(algebra: Algebra) -> &'static [&'static str] {
    if algebra.is_complex() { &["re", "im"] } else { &["y"] }
}

/// The names of the entries of a matrix: of a complex one the real and then the imaginary parts.
fn entry_names(algebra: Algebra, [rows, columns]: [usize; 2]) -> Vec<String> {
    letters(algebra).iter().flat_map(|letter| row_columns(letter, rows, columns)).collect()
}

/// Formulas, each with its row and its column and its place in the scene.
type Entries = Vec<((usize, usize), String, Text)>;

/// The number of rows of a field, and its formulas: all, or of so those above the diagonal alone, which is said.
fn entries_of(
    algebra: Algebra,
    key: &str,
    field: Vec<Texts>,
) -> Result<(usize, bool, Entries), Refusal> {
    let (mut rows, mut above) = (Vec::new(), Vec::new());
    for entry in field {
        match entry {
            Texts::List(row) => rows.push(row),
            Texts::One(text) => above.push(text),
        }
    }
    let n = rows.len();
    if above.is_empty() {
        if let Some(i) = rows.iter().position(|row| row.len() != n) {
            let message =
                format!("row {} has {}, expected {n}", i + 1, amount(rows[i].len(), "formulas"));
            return Err(Refusal::at(key.index(i), message));
        }
        let places = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let entries = places.zip(rows.into_iter().flatten());
        let with_key = |((i, j), text)| ((i, j), key.cell(i, j), text);
        return Ok((n, false, entries.map(with_key).collect()));
    }
    match (algebra, side_of(above.len())) {
        (Algebra::So, Some(n)) if rows.is_empty() => {
            let entries = above_diagonal(n).zip(above).enumerate();
            let with_key = |(k, (place, text))| (place, key.index(k), text);
            Ok((n, true, entries.map(with_key).collect()))
        }
        _ => {
            let message = format!(
                "found {} in no row, expected n rows of n formulas or, of so, the n(n-1)/2 formulas \
                 above the diagonal",
                amount(above.len(), "formulas")
            );
            Err(Refusal::at(key, message))
        }
    }
}

/// The initial point, where the action takes it.
fn start(
    algebra: Algebra,
    group: &MatrixGroup,
    action: MatrixAction,
    [real, imaginary]: [Option<Table>; 2],
    notes: &mut Vec<String>,
) -> Result<Mat<f64>, ReadError> {
    let n = if algebra.is_complex() { group.n() / 2 } else { group.n() };
    let refused = |message: String| Refusal::at("start", message);
    let mut start = match (real, action) {
        (Some(table), _) => table.columns("start")?,
        (None, MatrixAction::Translation) => Mat::identity(n, n),
        (None, _) => return Err(Refusal::section("missing key `start` in [problem]").into()),
    };
    let (rows, columns) = match action {
        MatrixAction::Lagrangian => (n / 2, n / 2),
        MatrixAction::Linear => (n, start.ncols()),
        _ => (n, n),
    };
    if columns > NAMED_MAX {
        return Err(refused(format!(
            "found rows of {columns} numbers, expected at most {NAMED_MAX}"
        ))
        .into());
    }
    if (start.nrows(), start.ncols()) != (rows, columns) {
        let (found, of) = (start.nrows(), start.ncols());
        return Err(refused(format!(
            "found {found} rows of {of} numbers, expected {rows} rows of {columns} as field has them"
        ))
        .into());
    }
    if algebra.is_complex() {
        let imaginary = match imaginary {
            Some(table) => table.matrix("start_imaginary", Some(columns))?,
            None => Mat::zeros(rows, columns),
        };
        check_rows("start_imaginary", &imaginary, rows)?;
        let both = Mat::from_fn(2 * rows, columns, |i, j| match i < rows {
            true => start[(i, j)],
            false => imaginary[(i - rows, j)],
        });
        start = if action == MatrixAction::Linear { both } else { whole(both.as_ref()) };
    }
    if action == MatrixAction::Lagrangian {
        check_symmetric("start", &start, 0.0)?;
    }
    if action == MatrixAction::Translation
        && let Err(error) = check_start(group, &start)
    {
        let help = Some(algebra.form_of_group(n));
        let off = || Refusal::from(error).renamed(&[("g: ", "start: ")]).about("start");
        let not_on = || Refusal { help, ..off() };
        let near = nearby(group, &start).ok_or_else(not_on)?;
        let moved = largest_entry((&near - &start).as_ref());
        notes.push(format!(
                "start: it is replaced by an element of {} nearby, which moves its entries by up to {moved:.1e}",
                group.name()
            ));
        start = near;
    }
    Ok(start)
}

/// Checks that a matrix is an element of the group. One that a run has grown or damped may be singular to working accuracy.
fn check_start(group: &MatrixGroup, x: &Mat<f64>) -> Result<(), Error> {
    let is_start = || group.check_member(&GroupMatrix::new_unchecked(x.clone())).is_ok();
    match group.element(x.clone()) {
        Err(Error::Singular { .. }) if is_start() => Ok(()),
        checked => checked.map(drop),
    }
}

/// The element of the group that a matrix of few digits stands for.
fn nearby(group: &MatrixGroup, x: &Mat<f64>) -> Option<Mat<f64>> {
    let mut g = GroupMatrix::new_unchecked(x.clone());
    let [mut a, mut b] = [group.identity(), group.identity()];
    group.correct(&mut g, [&mut a, &mut b]);
    let near = largest_entry((&*g - x).as_ref()) <= TYPED && group.element((*g).clone()).is_ok();
    near.then(|| (*g).clone())
}
