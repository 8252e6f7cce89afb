//! `kind = "lyapunov"`: the Lyapunov exponents of a polynomial vector field by continuous QR; see
//! [`Lyapunov`].

use faer::Mat;
use lieflow::Error;
use lieflow::actions::LeftTranslation;
use lieflow::groups::{GroupMatrix, LieGroup, MatrixGroup, Product, Translations};
use lieflow::problems::Lyapunov;
use lieflow::scalar::{Ops, tally};
use serde::Deserialize;
use toml::de::ValueDeserializer;

use super::flow::{Flow, Growth};
use super::system::System;
use super::{Figure, KeyInfo, Kind, Law, ProblemSpec, QuantityInfo, Scale};
use crate::model::Layer;
use crate::scene::values::{List, Real, Whole};
use crate::scene::{ReadError, Refusal};

/// The entry in the list of kinds.
pub(super) const KIND: Kind = Kind {
    name: "lyapunov",
    equation: "ẋ = F(x), Ẏ = DF(x)Y = d(QR)/dt, growth ln R_ii",
    summary: "Lyapunov exponents of a polynomial vector field by continuous QR",
    keys: &[
        KeyInfo { name: "x", meaning: "initial point" },
        KeyInfo {
            name: "terms",
            meaning: "a list of {of, coefficient, powers}: coefficient · x_1^powers[0] · … is a term \
                      of the derivative of x_of",
        },
    ],
    quantities: &[
        QuantityInfo { name: "x", columns: &["x1", "…", "xn"], meaning: "the point" },
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
    ],
    read,
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    x: List,
    terms: Vec<TermKeys>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TermKeys {
    of: Whole<1>,
    coefficient: Real,
    powers: Vec<Whole<0>>,
}

/// c xᵏ, a term of ẋ_of.
#[derive(Clone, Debug)]
struct Term {
    of: usize,
    coefficient: f64,
    powers: Vec<i32>,
}

impl Term {
    /// Its value, and with `by` its derivative by that coordinate.
    fn value(&self, x: &Mat<f64>, by: Option<usize>) -> f64 {
        let mut value = self.coefficient;
        // A product for each coordinate, and those of its power.
        let products = |power: &i32| (*power).max(1) as usize;
        tally(|| Ops::muls(self.powers.iter().map(products).sum()) + Ops::adds(1));
        for (i, &power) in self.powers.iter().enumerate() {
            value *= match (by == Some(i), power) {
                (true, 0) => 0.0,
                (true, _) => f64::from(power) * x[(i, 0)].powi(power - 1),
                (false, _) => x[(i, 0)].powi(power),
            };
        }
        value
    }
}

/// The field, and the initial point.
#[derive(Clone, Debug)]
struct Exponents {
    terms: Vec<Term>,
    x: Vec<f64>,
}

/// Higher powers are not meant.
const POWER_MAX: u64 = 64;

fn read(section: ValueDeserializer<'_>) -> Result<Box<dyn ProblemSpec>, ReadError> {
    let keys = Keys::deserialize(section)?;
    let x = keys.x.values();
    let n = x.len();
    if n == 0 {
        return Err(Refusal::at("x", "no numbers, expected at least one").into());
    }
    let mut terms = Vec::new();
    for (i, term) in keys.terms.iter().enumerate() {
        let refused = |message| Refusal::at(format!("terms[{i}]"), message);
        if term.of.0 > n as u64 {
            return Err(refused(format!("of = {}, expected 1 to {n}", term.of.0)).into());
        }
        if term.powers.len() != n {
            let found = term.powers.len();
            return Err(refused(format!("found {found} powers, expected {n}")).into());
        }
        if let Some(power) = term.powers.iter().find(|power| power.0 > POWER_MAX) {
            return Err(refused(format!("power {}, expected at most {POWER_MAX}", power.0)).into());
        }
        terms.push(Term {
            of: term.of.0 as usize - 1,
            coefficient: term.coefficient.0,
            powers: term.powers.iter().map(|power| power.0 as i32).collect(),
        });
    }
    Ok(Box::new(Exponents { terms, x }))
}

type Point = (GroupMatrix, Growth);

impl System for Exponents {
    type Problem = Flow<Product<MatrixGroup, Translations<Growth>>, LeftTranslation>;

    fn kind(&self) -> &'static Kind {
        &KIND
    }
    fn layer(&self) -> Layer {
        Layer::General
    }
    fn problem(&self) -> Result<(Self::Problem, Point), Error> {
        let (n, terms) = (self.x.len(), self.terms.clone());
        let field = move |_: f64, x: &Mat<f64>, dx: &mut Mat<f64>, jacobian: &mut Mat<f64>| {
            dx.fill(0.0);
            jacobian.fill(0.0);
            for term in &terms {
                dx[(term.of, 0)] += term.value(x, None);
                for j in 0..n {
                    jacobian[(term.of, j)] += term.value(x, Some(j));
                }
            }
        };
        let system = Lyapunov::new(n, field)?;
        let start = system.state(&self.x)?;
        Ok(Flow::nonlinear(system, LeftTranslation, start))
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
            "x" => numbered("x"),
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
