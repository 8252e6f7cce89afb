//! Formulas that lose their value in a run: the last ones are kept, so that a run that ends by one can name it.

use core::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, ThreadId};

use super::names::{Entry, Names, continues_name};
use super::tape::Tape;
use lieflow::StepError;
use lieflow::error::Plain;

/// Where a formula stands, and what its names mean.
pub(super) struct Origin {
    pub(super) key: String,
    pub(super) text: String,
    /// The variable by which the formula of the text is derived.
    pub(super) by: Option<usize>,
    pub(super) names: Names,
}

/// What is stated, and not what a run lost.
impl fmt::Debug for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Origin").field("key", &self.key).field("text", &self.text).finish()
    }
}

/// A formula that has no finite value at a point where its variables have one.
#[derive(Clone, Debug)]
struct Loss {
    origin: Arc<Origin>,
    tape: Tape,
    values: Vec<f64>,
}

/// The first and the last loss of a thread.
type OfThread = (ThreadId, [Option<Loss>; 2]);

/// What formulas of the same names lost, for each thread apart: runs in several threads may have the same formulas.
#[derive(Debug, Default)]
pub(super) struct Losses(Mutex<Vec<OfThread>>);

/// The losses of so many threads are kept. Those of the oldest are then forgotten.
const THREADS: usize = 256;

/// Which of the losses since the last [`Formula::forget`](super::Formula::forget).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The first one.
    First,
    /// The last one.
    Last,
}

impl Losses {
    /// Keeps a formula without a value. A formula is not kept if one of its variables has no value either: then it only
    /// follows.
    #[cold]
    pub(super) fn see(&self, origin: &Arc<Origin>, tape: &Tape, values: &[f64]) {
        if !tape.inputs().all(|at| values.get(at).is_some_and(|x| x.is_finite())) {
            return;
        }
        let loss = || Loss { origin: origin.clone(), tape: tape.clone(), values: values.to_vec() };
        let mut threads = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let me = thread::current().id();
        let place = threads.iter().position(|(thread, _)| *thread == me).unwrap_or_else(|| {
            if threads.len() == THREADS {
                threads.remove(0);
            }
            threads.push((me, [None, None]));
            threads.len() - 1
        });
        let (_, [first, last]) = &mut threads[place];
        first.get_or_insert_with(loss);
        // At one point the first formula counts.
        if last.as_ref().is_none_or(|last| last.values != values) {
            *last = Some(loss());
        }
    }

    /// Forgets what this thread lost.
    pub(super) fn forget(&self) {
        let me = thread::current().id();
        let mut threads = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        threads.retain(|(thread, _)| *thread != me);
    }

    /// The loss of this thread in words.
    pub(super) fn tell(&self, which: Which) -> Option<Lost> {
        let me = thread::current().id();
        let threads = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (_, losses) = threads.iter().find(|(thread, _)| *thread == me)?;
        losses[which as usize].as_ref().map(Loss::named)
    }
}

/// A formula without a finite value, and the point.
#[derive(Clone, Debug, PartialEq)]
pub struct Lost {
    /// The key of the formula that a run needs.
    pub key: String,
    /// The named formula that has no value first, where that is one.
    pub through: Option<String>,
    /// The text of the formula, or of the named one.
    pub text: String,
    /// The variable of the derivative, where that has no value.
    pub by: Option<String>,
    /// The value.
    pub value: f64,
    /// The variables of the formula, or of the named one, with their values.
    pub at: Vec<(String, f64)>,
}

impl Loss {
    /// The formula, or the first named one that it needs and that has no value.
    fn named(&self) -> Lost {
        let Loss { origin, tape, values } = self;
        let names = &origin.names;
        let value = |tape: &Tape| tape.value(values, names.samples());
        let needed = needed(&origin.text, names);
        let lost = |entry: &&Entry| !value(&entry.tape).is_finite();
        let through =
            names.formulas().iter().filter(|entry| needed.contains(&&*entry.key)).find(lost);
        let (of, text) = through.map_or((tape, &origin.text), |entry| (&entry.tape, &entry.text));
        let variable = |at: usize| names.variables().get(at).cloned().unwrap_or_default();
        let mut inputs: Vec<usize> = of.inputs().collect();
        inputs.sort_unstable();
        inputs.dedup();
        Lost {
            key: origin.key.clone(),
            through: through.map(|entry| entry.key.clone()),
            text: text.clone(),
            by: origin.by.filter(|_| through.is_none()).map(variable),
            value: value(of),
            at: inputs.into_iter().map(|at| (variable(at), values[at])).collect(),
        }
    }
}

impl Lost {
    /// The time, where the formula depends on it.
    pub fn t(&self) -> Option<f64> {
        self.at.iter().find(|(name, _)| name == "t").map(|(_, t)| *t)
    }
}

/// The keys of the named formulas that a text needs, also through others.
fn needed<'a>(text: &str, names: &'a Names) -> Vec<&'a str> {
    let says = |text: &str, entry: &Entry| {
        text.split(|c| !continues_name(c)).any(|word| entry.belongs_to(word))
    };
    let mut needed: Vec<&Entry> = Vec::new();
    // An entry needs only those before it.
    for entry in names.formulas().iter().rev() {
        if says(text, entry) || needed.iter().any(|above| says(&above.text, entry)) {
            needed.push(entry);
        }
    }
    needed.into_iter().map(|entry| &*entry.key).collect()
}

/// The distance of the time where a formula has no value from that where steps become too small.
pub(crate) const NEAR: f64 = 1e-6;

/// Is the reason a value that is not finite?
pub(super) fn is_of_values(error: &StepError) -> bool {
    matches!(error, StepError::NonFiniteRhs { .. } | StepError::NotFinite { .. })
}

/// Variables that are shown.
const SHOWN: usize = 9;

impl Lost {
    /// The first variables with their values, as in `x = 1, y = 2`.
    pub(super) fn place(&self) -> String {
        let shown = self.at.iter().take(SHOWN);
        let shown = shown.map(|(name, x)| format!("{name} = {}", Plain(x)));
        let rest = (self.at.len() > SHOWN).then(|| "…".into());
        shown.chain(rest).collect::<Vec<String>>().join(", ")
    }
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Lost { key, through, text, by, value, at } = self;
        if let Some(by) = by {
            write!(f, "the derivative by {by} of ")?;
        }
        write!(f, "{} = {text}", through.as_ref().unwrap_or(key))?;
        if through.is_some() {
            write!(f, ", which {key} needs,")?;
        }
        write!(f, " is {value}")?;
        if at.is_empty() { Ok(()) } else { write!(f, " at {}", self.place()) }
    }
}
