//! f as formulas in t and the numbers of y.

use std::sync::Arc;

use lieflow::RunError;
use lieflow::samples::Samples;

use super::OwnField;
use crate::formula::{Formula, Lost, Texts};
use crate::kinds::prelude::*;
use crate::reader::{Mistakes, Tree, amount};

keys! { Keys [sample_keys formula_keys] {
    field: Vec<Texts> = "the formulas of each part",
} }

/// f as formulas in t and the numbers of y.
#[derive(Clone, Debug)]
pub struct Formulas {
    formulas: Arc<[Formula]>,
    /// The number of numbers of t and y.
    variables: usize,
}

/// Up to this number of variables a call needs no memory.
const FEW: usize = 40;

impl Formulas {
    /// The formulas of a table with the keys `field`, `parameters`, `let`, `samples` and `interpolation`. `variables` are
    /// the names of the numbers of y, and entry `i` of `field` has `counts[i]` values.
    ///
    /// # Errors
    /// [`Mistakes`], by the paths of keys.
    pub fn read(variables: &[String], counts: &[usize], keys: &Tree) -> Result<Self, Mistakes> {
        keys.read(|values| read_with(values, |keys| Self::of(variables, counts, keys)))
    }

    fn of(variables: &[String], counts: &[usize], mut keys: Keys) -> Result<Self, ReadError> {
        let (named, samples) = (keys.formula_keys(), keys.sample_keys());
        let all = core::iter::once("t").chain(variables.iter().map(String::as_str));
        let (names, field) = (named.names("field", all, samples), keys.field);
        let (mut names, field) = all!(names, field)?;
        if field.len() != counts.len() {
            let message =
                format!("found {}, expected {}", amount(field.len(), "parts"), counts.len());
            return Err(Refusal::at("field", message).into());
        }
        let (mut formulas, mut mistakes) = (Vec::new(), ReadError::default());
        mistakes.keep(names.take_mistakes());
        for (i, (texts, &count)) in field.iter().zip(counts).enumerate() {
            formulas.extend(mistakes.keep(texts.read(&"field".index(i), count, &names)));
        }
        let formulas: Vec<Formula> = formulas.into_iter().flatten().collect();
        mistakes.or(Some(Formulas { formulas: formulas.into(), variables: 1 + variables.len() }))
    }

    /// f.
    pub fn field(&self) -> Arc<OwnField> {
        let Formulas { formulas, variables } = self.clone();
        let evaluate = move |values: &[f64], out: &mut [f64]| {
            out.iter_mut().zip(&*formulas).for_each(|(out, formula)| *out = formula.value(values));
        };
        Arc::new(move |t, y, out| {
            let (mut few, mut many) = ([0.0; FEW], Vec::new());
            let values = match few.get_mut(..variables) {
                Some(few) => few,
                None => {
                    many.resize(variables, 0.0);
                    &mut *many
                }
            };
            values[0] = t;
            values[1..].copy_from_slice(y);
            evaluate(values, out);
            true
        })
    }

    /// Does f depend on y?
    pub fn depends_on_y(&self) -> bool {
        self.formulas.iter().any(|formula| (1..self.variables).any(|i| formula.uses(i)))
    }

    /// The samples that the formulas name: a run stays in their span.
    pub fn samples(&self) -> Option<&Samples> {
        self.formulas.first()?.samples()
    }

    /// Forgets which formulas had no finite value in this thread.
    pub fn forget(&self) {
        self.formulas.iter().take(1).for_each(Formula::forget);
    }

    /// The formula by which a run in this thread ended with this error.
    pub fn lost_by(&self, error: &RunError) -> Option<Lost> {
        self.formulas.first()?.lost_by(error)
    }
}
