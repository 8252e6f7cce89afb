//! `kind = "toda"`, `"double-bracket"` and `"qr-flow"`: flows L̇ = \[B(L), L\] of symmetric matrices that
//! keep the eigenvalues; see [`IsospectralFlow`].

use lieflow::dense::norm;
use lieflow::problems::{IsospectralFlow, toda_lattice};
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::entries::{
    ROUNDING, check_symmetric, columns_at, diagonal, eigenvalues, numbered, symmetric, upper,
    upper_columns,
};
use super::on_m;
use super::prelude::*;

/// The entry of Toda's flow in the list of kinds.
pub(super) const TODA: Kind = Kind {
    name: "toda",
    equation: "L̇ = [L₋ᵀ − L₋, L], L₋ what is below the diagonal",
    summary: "Toda's flow of a symmetric matrix, and the lattice of particles in Flaschka's variables",
    ..Kind::of::<TodaKeys, Isospectral>(|section| read_with(section, read_toda))
};

/// The entry of Brockett's flow in the list of kinds.
pub(super) const DOUBLE_BRACKET: Kind = Kind {
    name: "double-bracket",
    equation: "L̇ = [[N, L], L], N diagonal",
    summary: "Brockett's flow of a symmetric matrix, which diagonalises and sorts",
    ..Kind::of::<DoubleBracketKeys, Isospectral>(|section| read_with(section, read_double_bracket))
};

/// The entry of the QR flow in the list of kinds.
pub(super) const QR_FLOW: Kind = Kind {
    name: "qr-flow",
    equation: "L̇ = [log(L)₋ᵀ − log(L)₋, L]: L(k) is the k-th iterate",
    summary: "the flow through the iterates of the QR algorithm of a positive definite matrix",
    ..Kind::of::<QrKeys, Isospectral>(|section| read_with(section, read_qr))
};

keys! { TodaKeys {
    positions: Option<List> = "initial positions of the particles",
    momenta: Option<List> = "their momenta",
    matrix: Option<Table> = "a symmetric matrix, instead of particles",
} }

keys! { DoubleBracketKeys {
    matrix: Table = "the initial symmetric matrix",
    order: List = "the diagonal of N: eigenvalues end sorted as it is",
} }

keys! { QrKeys {
    matrix: Table = "the initial matrix, symmetric and positive",
} }

/// A flow with its initial matrix.
#[derive(Clone, Debug)]
struct Isospectral {
    flow: IsospectralFlow,
    matrix: Mat<f64>,
    /// Is it for positive matrices alone?
    is_of_positive: bool,
}

type Q = Quantity<Isospectral>;

/// The symmetric matrix under the key `matrix`.
fn matrix_of(table: &Table) -> Result<Mat<f64>, ReadError> {
    symmetric("matrix", table, None, ROUNDING)
}

fn read_toda(keys: TodaKeys) -> Result<Forms, ReadError> {
    let TodaKeys { positions, momenta, matrix, .. } = keys;
    let (positions, momenta, matrix) = all!(positions, momenta, matrix)?;
    let matrix = match exactly_one(("positions", positions), ("matrix", matrix))? {
        Either::First(positions) => {
            let (q, p) = (positions.values(), momenta.map_or(Vec::new(), |p| p.values()));
            if p.len() != q.len() {
                let message = format!(
                    "found {} momenta, expected {}, one for each position",
                    p.len(),
                    q.len()
                );
                return Err(Refusal::at("momenta", message).into());
            }
            toda_lattice(&q, &p).map_err(|_| {
                let message = "two neighbours overlap so far that their force is not finite";
                Refusal::at("positions", message)
            })?
        }
        Either::Second(_) if momenta.is_some() => {
            return Err(Refusal::at("momenta", "a matrix has no momenta; leave momenta out").into());
        }
        Either::Second(matrix) => matrix_of(&matrix)?,
    };
    let flow = IsospectralFlow::toda(matrix.nrows())?;
    Ok(Forms::of(Isospectral { flow, matrix, is_of_positive: false }))
}

fn read_double_bracket(keys: DoubleBracketKeys) -> Result<Forms, ReadError> {
    let matrix = keys.matrix.and_then(|table| table.matrix("matrix", None));
    let symmetry = seen(&matrix).and_then(|l| Ok(check_symmetric("matrix", l, ROUNDING)?));
    let order = keys.order.and_then(|order| {
        let (order, n) = (order.values(), seen(&matrix)?.nrows());
        let message = || format!("found {}, expected {n}", amount(order.len(), "numbers"));
        match order.len() == n {
            true => Ok(order),
            false => Err(Refusal::at("order", message()).into()),
        }
    });
    let (matrix, (), order) = all!(matrix, symmetry, order)?;
    let flow = IsospectralFlow::double_bracket(&order)?;
    Ok(Forms::of(Isospectral { flow, matrix, is_of_positive: false }))
}

fn read_qr(keys: QrKeys) -> Result<Forms, ReadError> {
    let matrix = matrix_of(&keys.matrix?)?;
    let (smallest, is_positive) = smallest(&matrix);
    if !is_positive {
        let message = format!("an eigenvalue is {smallest:.4}, expected all eigenvalues to be > 0");
        return Err(Refusal::at("matrix", message).into());
    }
    let flow = IsospectralFlow::qr(matrix.nrows())?;
    Ok(Forms::of(Isospectral { flow, matrix, is_of_positive: true }))
}

/// The smallest eigenvalue, and whether it is positive.
fn smallest(matrix: &Mat<f64>) -> (f64, bool) {
    let smallest = eigenvalues(matrix).first().copied().unwrap_or(f64::NAN);
    (smallest, smallest > 0.0)
}

impl System for Isospectral {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["matrix"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "matrix",
            &["l11", "…", "lnn"],
            "the entries on and above the diagonal, row by row",
            |_, _, l, row| row.extend(upper(l)),
        )
        .with_columns(|flow| upper_columns("l", flow.matrix.nrows())),
        Q::numbers("diagonal", &["l11", "…", "lnn"], "the diagonal", |_, _, l, row| {
            row.extend(diagonal(l));
        })
        .with_columns(|flow| {
            let n = flow.matrix.nrows();
            columns_at("l", n, (0..n).map(|i| (i, i)))
        }),
        Q::number("off_diagonal", "Frobenius norm of what is off the diagonal", |_, _, l| {
            let off = |i: usize, j: usize| if i == j { 0.0 } else { l[(i, j)] };
            norm(Mat::from_fn(l.nrows(), l.nrows(), off).as_ref())
        }),
        Q::numbers(
            "eigenvalues",
            &["e1", "…", "en"],
            "the eigenvalues in ascending order",
            |_, _, l, row| row.extend(eigenvalues(l)),
        )
        .with_columns(|flow| numbered("e", flow.matrix.nrows()))
        .kept(Law::by_the_action(0).on_scale(Scale::Terms))
        // Rounding moves each by a part of the largest.
        .in_terms(|_, l| norm(l.as_ref())),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        let action = MatrixAction::Conjugation;
        Ok((OnMatrices::new(self.flow.clone(), action), self.matrix.clone()))
    }
    fn check_state(&self, arg: &str, l: &Mat<f64>) -> Result<(), Error> {
        on_m::check_symmetric(arg, l)?;
        if !self.is_of_positive {
            return Ok(());
        }
        let (smallest, is_positive) = smallest(l);
        on_m::check_least(is_positive, format!("an eigenvalue of {arg}"), smallest, "a number > 0")
    }
    fn modelled(&self) -> String {
        format!("symmetric {0}×{0} matrix, conjugated by SO({0})", self.matrix.nrows())
    }
    fn figure(&self) -> Figure {
        Figure::Lines("diagonal")
    }
}
