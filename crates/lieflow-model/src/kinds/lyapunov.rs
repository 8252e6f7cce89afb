//! `kind = "lyapunov"`: the Lyapunov exponents of a vector field by continuous QR. The field is in formulas, and
//! their derivatives are its Jacobian. See [`Lyapunov`].

use std::sync::Arc;

use lieflow::actions::LeftTranslation;
use lieflow::groups::{LieGroup, MatrixGroup};
use lieflow::problems::Lyapunov;
use lieflow_runs::spaces::Growing;

use super::entries::{numbered, rows};
use super::prelude::*;
use crate::formula::{Formula, Names, Texts, without_value};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "lyapunov",
    equation: "ẋ = F(t, x), Ẏ = DF(t, x)Y = d(QR)/dt, growth ln R_ii",
    summary: "Lyapunov exponents of a vector field in formulas, by continuous QR",
    ..Kind::of::<Keys, Exponents>(|section| read_with(section, read))
};

keys! { Keys [formula_keys sample_keys] {
    x: List = "initial point, at most 128 numbers",
    variables: Option<Vec<String>> = "names of the coordinates, [\"x\", \"y\", ...]; optional: x1, x2, ...",
    field: Texts = "a formula for the derivative of each coordinate, in the time t and the coordinates",
} }

/// The field and its Jacobian, row by row, and the initial point.
#[derive(Clone, Debug)]
struct Exponents {
    /// t, and the coordinates.
    names: Names,
    field: Arc<[Formula]>,
    jacobian: Arc<[Formula]>,
    x: Vec<f64>,
}

/// The most coordinates: their values lie on the stack.
const MAX: usize = 128;

/// The most operations in the formulas of the field, each formula counted for every coordinate in it: what its
/// derivatives take.
const DERIVED_MAX: usize = 1 << 18;

fn read(mut keys: Keys) -> Result<Forms, ReadError> {
    let (formulas, samples) = (keys.formula_keys(), keys.sample_keys());
    let x = keys.x.and_then(|x| match x.values() {
        x if (1..=MAX).contains(&x.len()) => Ok(x),
        x => {
            let message = format!("found {}, expected 1 to {MAX}", amount(x.len(), "numbers"));
            Err(Refusal::at("x", message).into())
        }
    });
    // The names are known also where x is wrong.
    let variables = keys.variables.and_then(|variables| {
        let variables = match variables {
            Some(variables) => variables,
            None => numbered("x", seen(&x)?.len()),
        };
        match &x {
            Ok(x) if variables.len() != x.len() => {
                let (found, n) = (amount(variables.len(), "names"), x.len());
                let message = format!("found {found}, expected {n} as x has numbers");
                Err(Refusal::at("variables", message).into())
            }
            _ => Ok(variables),
        }
    });
    let count = seen(&x).map(Vec::len).or(seen(&variables).map(Vec::len));
    let names = variables.and_then(|variables| {
        formulas.names("variables", ["t".into()].into_iter().chain(variables), samples)
    });
    let field = keys.field.and_then(|field| field.read_by("field", count.ok(), seen(&names)));
    let names = names.and_then(Names::checked);
    let (x, names, field) = all!(x, names, field)?;
    let n = x.len();
    let derived = |f: &Formula| f.operations() * (1..=n).filter(|&j| f.uses(j)).count();
    if field.iter().map(derived).sum::<usize>() > DERIVED_MAX {
        let message = format!("its derivatives take more than {DERIVED_MAX} operations");
        return Err(Refusal::at("field", message).into());
    }
    let by = |f: &Formula| (1..=n).map(|j| f.derivative(j)).collect::<Result<Vec<_>, _>>();
    let jacobian = field.iter().map(by).collect::<Result<Vec<_>, _>>()?.concat();
    let (field, jacobian) = (field.into(), jacobian.into());
    let system = Exponents { names, field, jacobian, x };
    Q::check_names(&system, "variables", &system.names.variables()[1..], &["x"])?;
    Ok(Forms::of(system))
}

/// t and x, for formulas.
fn values(t: f64, x: &[f64]) -> [f64; 1 + MAX] {
    let mut values = [t; 1 + MAX];
    values[1..].iter_mut().zip(x).for_each(|(value, x)| *value = *x);
    values
}

type Q = Quantity<Exponents>;

impl System for Exponents {
    type Problem = Growing;

    const STATE: &'static [&'static str] = &["x", "growth", "frame"];
    const QUANTITIES: &'static [Q] = &[
        Q::numbers(
            "x",
            &["…"],
            "the point, by the names of its coordinates",
            |_, _, (_, (_, x)), row| row.extend(x.col_as_slice(0)),
        )
        .with_columns(|system| system.names.variables()[1..].to_vec()),
        Q::numbers(
            "growth",
            &["s1", "…", "sn"],
            "logarithms of the growth of perturbations along the columns of `frame`",
            |_, _, (_, (growth, _)), row| row.extend(growth.col_as_slice(0)),
        )
        .with_columns(|system| numbered("s", system.x.len())),
        Q::numbers(
            "exponents",
            &["e1", "…", "en"],
            "growth over time, in falling order: the exponents where the time is long; 0 at the start",
            |_, at, (_, (growth, _)), row| {
                let (first, time) = (row.len(), if at.since_start == 0.0 { 1.0 } else { at.since_start });
                row.extend(growth.col_as_slice(0).iter().map(|s| s / time));
                row[first..].sort_unstable_by(|a, b| b.total_cmp(a));
            },
        )
        .with_columns(|system| numbered("e", system.x.len())),
        Q::numbers(
            "frame",
            &["q11", "…", "qnn"],
            "directions of the perturbations, row by row",
            |_, _, (q, _), row| row.extend(rows(q)),
        )
        .of_matrix("q", |system| [system.x.len(); 2]),
        Q::number("frame_defect", "distance of Q'Q from the identity", |_, _, (q, _)| {
            MatrixGroup::so(q.nrows()).map_or(f64::NAN, |group| group.defect(q))
        })
        .kept(Law::by_the_action(2).on_scale(Scale::One))
        .of_distance(),
    ];

    fn problem(&self) -> Result<Start<Growing>, Error> {
        let (n, field, by) = (self.x.len(), self.field.clone(), self.jacobian.clone());
        let field = move |t: f64, x: &Mat<f64>, dx: &mut Mat<f64>, jacobian: &mut Mat<f64>| {
            let values = values(t, x.col_as_slice(0));
            for i in 0..n {
                dx[(i, 0)] = field[i].value(&values);
                for j in 0..n {
                    jacobian[(i, j)] = by[i * n + j].value(&values);
                }
            }
        };
        let system = Lyapunov::new(n, field)?;
        let start = system.state(&self.x)?;
        Ok((Growing::new(system, LeftTranslation), start))
    }
    fn check_start(&self, t0: f64) -> Vec<Refusal> {
        without_value(self.field.iter().chain(&*self.jacobian), &values(t0, &self.x))
    }
    fn formula(&self) -> Option<&Formula> {
        self.field.first()
    }
    fn modelled(&self) -> String {
        format!("point, frame in SO({0}) and growth in {0} directions", self.x.len())
    }
    fn figure(&self) -> Figure {
        Figure::Lines("exponents")
    }
}
