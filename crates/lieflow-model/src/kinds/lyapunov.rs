//! `kind = "lyapunov"`: the Lyapunov exponents of a user's vector field by continuous QR; the field is in
//! formulas and its Jacobian by their derivatives. See [`Lyapunov`].

use std::sync::Arc;

use faer::Mat;
use lieflow::Error;
use lieflow::actions::LeftTranslation;
use lieflow::groups::{GroupMatrix, LieGroup, MatrixGroup};
use lieflow::problems::Lyapunov;
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::flow::{Growing, Growth};
use super::old_system::System;
use super::{Figure, KeyInfo, Kind, Law, PARAMETERS, ProblemSpec, QuantityInfo, Scale};
use crate::model::Layer;
use crate::scene::formula::{Formula, Names, Parameters, read_all};
use crate::scene::values::List;
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "lyapunov",
    equation: "ẋ = F(t, x), Ẏ = DF(t, x)Y = d(QR)/dt, growth ln R_ii",
    summary: "Lyapunov exponents of a vector field of one's own by continuous QR",
    keys: &[
        KeyInfo { name: "x", meaning: "initial point, at most 128 numbers" },
        KeyInfo {
            name: "variables",
            meaning: "names of the coordinates, [\"x\", \"y\", ...]; optional: x1, x2, ...",
        },
        KeyInfo {
            name: "field",
            meaning: "a formula for the derivative of each coordinate, in the time t and the coordinates",
        },
        PARAMETERS,
    ],
    quantities: || {
        vec![
            QuantityInfo {
                name: "x",
                columns: &["…"],
                meaning: "the point, by the names of its coordinates",
            },
            QuantityInfo {
                name: "growth",
                columns: &["s1", "…", "sn"],
                meaning: "logarithms of the growth of perturbations, in falling order",
            },
            QuantityInfo {
                name: "exponents",
                columns: &["e1", "…", "en"],
                meaning: "growth over time: the exponents where the time is long; 0 at the start",
            },
            QuantityInfo {
                name: "frame",
                columns: &["q11", "…", "qnn"],
                meaning: "directions of the perturbations, row by row",
            },
            QuantityInfo {
                name: "frame_defect",
                columns: &["frame_defect"],
                meaning: "distance of Q'Q from the identity",
            },
        ]
    },
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    x: List,
    variables: Option<Vec<String>>,
    field: Vec<String>,
    #[serde(default)]
    parameters: Parameters,
}

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

/// The most operations of formulas that are derived, each counted for every coordinate in it.
const DERIVED_MAX: usize = 1 << 18;

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let x = keys.x.values();
    let n = x.len();
    if !(1..=MAX).contains(&n) {
        return Err(Refusal::at("x", format!("found {n} numbers, expected 1 to {MAX}")).into());
    }
    let numbered = || (1..=n).map(|i| format!("x{i}")).collect();
    let variables = keys.variables.unwrap_or_else(numbered);
    let lists = [("variables", "names", variables.len()), ("field", "formulas", keys.field.len())];
    if let Some((key, what, found)) = lists.into_iter().find(|(.., found)| *found != n) {
        let message = format!("found {found} {what}, expected {n} as x has numbers");
        return Err(Refusal::at(key, message).into());
    }
    let names = ["t".into()].into_iter().chain(variables);
    let names = keys.parameters.names("variables", names)?;
    let field = read_all("field", &keys.field, &names)?;
    let derived = |f: &Formula| f.operations() * (1..=n).filter(|&j| f.uses(j)).count();
    if field.iter().map(derived).sum::<usize>() > DERIVED_MAX {
        let message = format!("its derivatives take more than {DERIVED_MAX} operations");
        return Err(Refusal::at("field", message).into());
    }
    let by = |(i, f): (usize, &Formula)| {
        let key = format!("field[{i}]");
        (1..=n).map(|j| f.derivative(&key, j)).collect::<Result<Vec<_>, _>>()
    };
    let jacobian = field.iter().enumerate().map(by).collect::<Result<Vec<_>, _>>()?.concat();
    Ok(Box::new(Exponents { names, field: field.into(), jacobian: jacobian.into(), x }))
}

/// t and x, for formulas.
fn values(t: f64, x: &[f64]) -> [f64; 1 + MAX] {
    let mut values = [t; 1 + MAX];
    values[1..].iter_mut().zip(x).for_each(|(value, x)| *value = *x);
    values
}

type Point = (GroupMatrix, Growth);

impl System for Exponents {
    type Problem = Growing;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Point), Error> {
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
    fn check_start(&self, t0: f64) -> Result<(), Refusal> {
        let (n, values) = (self.x.len(), values(t0, &self.x));
        for i in 0..n {
            let key = format!("field[{i}]");
            self.field[i].check(&key, &values)?;
            for (j, name) in self.names.variables()[1..].iter().enumerate() {
                let slope = self.jacobian[i * n + j].value::<f64>(&values);
                if !slope.is_finite() {
                    let message =
                        format!("{key}: its derivative by {name} is {slope} at the start");
                    return Err(Refusal::at(key, message));
                }
            }
        }
        Ok(())
    }
    fn modelled(&self) -> String {
        format!("point, frame in SO({0}) and growth in {0} directions", self.x.len())
    }
    fn state(&self) -> &'static [&'static str] {
        &["x", "growth", "frame"]
    }
    fn laws(&self) -> Vec<Law> {
        vec![Law::of_the_action("frame_defect", 2).on_scale(Scale::One)]
    }
    fn columns(&self, quantity: &QuantityInfo) -> Vec<String> {
        let n = self.x.len();
        let numbered = |name: &str| (1..=n).map(|i| format!("{name}{i}")).collect();
        match quantity.name {
            "x" => self.names.variables()[1..].to_vec(),
            "growth" => numbered("s"),
            "exponents" => numbered("e"),
            "frame" => (1..=n).flat_map(|i| (1..=n).map(move |j| format!("q{i}{j}"))).collect(),
            other => vec![other.into()],
        }
    }
    fn show(&self, quantity: &str, t: f64, (q, (growth, x)): &Point, row: &mut Vec<f64>) {
        let n = self.x.len();
        match quantity {
            "x" => row.extend(x.col_as_slice(0)),
            "growth" => row.extend(growth.col_as_slice(0)),
            "exponents" => {
                let over = if t == 0.0 { 1.0 } else { t };
                row.extend(growth.col_as_slice(0).iter().map(|s| s / over));
            }
            "frame" => row.extend((0..n).flat_map(|i| (0..n).map(move |j| q[(i, j)]))),
            _ => row.push(MatrixGroup::so(n).map_or(f64::NAN, |group| group.defect(q))),
        }
    }
    fn figure(&self) -> Figure {
        Figure::Lines("exponents")
    }
}
