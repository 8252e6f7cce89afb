//! `kind = "oja"`: Oja's flow on n×k matrices with orthonormal columns, which finds the leading
//! eigenvectors of a symmetric matrix; see [`Oja`].

use lieflow::dense::{multiply, norm, qr};
use lieflow::problems::Oja;
use lieflow_runs::spaces::{MatrixAction, OnMatrices};

use super::entries::{ROUNDING, check_rows, eigenvalues, rows, symmetric};
use super::on_m::check_number;
use super::prelude::*;

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "oja",
    equation: "Ẋ = AX − XXᵀAX",
    summary: "Oja's flow on orthonormal columns, to the leading eigenvectors of a symmetric matrix",
    ..Kind::of::<Keys, OjaFlow>(|section| read_with(section, read))
};

keys! { Keys {
    a: Table = "the symmetric matrix A",
    x: Table = "the initial n×k matrix; its columns are made orthonormal",
} }

/// The flow with X(t₀).
#[derive(Clone, Debug)]
struct OjaFlow {
    flow: Oja,
    a: Mat<f64>,
    x: Mat<f64>,
}

type Q = Quantity<OjaFlow>;

/// Columns that depend on each other up to this part of their length span no k-dimensional space.
const DEPENDENT: f64 = 1e-8;

fn read(keys: Keys) -> Result<Forms, ReadError> {
    let a = keys.a.and_then(|a| symmetric("a", &a, None, ROUNDING));
    let x = keys.x.and_then(|x| {
        let x = x.columns("x")?;
        if let Ok(a) = &a {
            check_rows("x", &x, a.nrows())?;
        }
        orthonormal(&x)
    });
    let (a, x) = all!(a, x)?;
    let flow = Oja::new(a.clone(), x.ncols())?;
    Ok(Forms::of(OjaFlow { flow, a, x }))
}

/// The orthonormal columns of the factor Q of independent columns.
fn orthonormal(x: &Mat<f64>) -> Result<Mat<f64>, ReadError> {
    if x.ncols() > x.nrows() {
        let message = format!("{} columns of {} rows depend on each other", x.ncols(), x.nrows());
        return Err(Refusal::at("x", message).into());
    }
    let (q, r) = qr(x.as_ref());
    let depends = |j: &usize| r[(*j, *j)].abs() <= DEPENDENT * norm(x.subcols(*j, 1));
    if let Some(j) = (0..x.ncols()).find(depends) {
        let message = format!(
            "column {} is a sum of multiples of the columns before it, expected independent columns",
            j + 1
        );
        return Err(Refusal::at("x", message).into());
    }
    Ok(Mat::from_fn(x.nrows(), x.ncols(), |i, j| q[(i, j)] * r[(j, j)].signum()))
}

/// ‖XᵀX − 𝟙‖.
fn defect(x: &Mat<f64>) -> f64 {
    let one = Mat::<f64>::identity(x.ncols(), x.ncols());
    norm((multiply(x.transpose(), x.as_ref()) - one).as_ref())
}

impl System for OjaFlow {
    type Problem = OnMatrices;

    const STATE: &'static [&'static str] = &["x"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers("x", &["x11", "…", "xnk"], "the entries of X, row by row", |_, _, x, row| {
            row.extend(rows(x))
        })
        .of_matrix("x", |oja| [oja.x.nrows(), oja.x.ncols()]),
        Q::number(
            "trace",
            "trace of X'AX, which grows to the sum of the leading eigenvalues",
            |oja, _, x| oja.flow.trace(x),
        ),
        Q::number("stiefel_defect", "distance of X'X from the identity", |_, _, x| defect(x))
            // Degree 0: the classical form of the equation keeps it on the manifold alone.
            .kept(Law::by_the_action(0).on_scale(Scale::One))
            .of_distance(),
    ];

    fn problem(&self) -> Result<Start<OnMatrices>, Error> {
        Ok((OnMatrices::new(self.flow.clone(), MatrixAction::Linear), self.x.clone()))
    }
    fn check_state(&self, arg: &str, x: &Mat<f64>) -> Result<(), Error> {
        let distance = format!("the distance of {arg}ᵀ{arg} from the identity");
        check_number(distance, defect(x), 0.0, 1.0, "that of orthonormal columns")
    }
    fn modelled(&self) -> String {
        format!("{} orthonormal columns in {} dimensions", self.x.ncols(), self.x.nrows())
    }
    fn figure(&self) -> Figure {
        Figure::Lines("trace")
    }
    fn facts(&self) -> Vec<Property> {
        let leading = eigenvalues(&self.a).iter().rev().take(self.x.ncols()).sum();
        vec![Property::of("sum_of_the_leading_eigenvalues", leading)]
    }
}
