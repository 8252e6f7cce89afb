//! Where the end comes from that errors are measured against.

use lieflow::catalog::MethodSpec;
use lieflow_figures::number::typed;

/// Where the end comes from that errors are measured against.
#[derive(Clone, Debug, PartialEq)]
pub enum Reference {
    /// The exact solution.
    Exact {
        /// How far rounding moves its end. `None` if the reference is not a compared method.
        rounding: Option<Rounding>,
    },
    /// A run at the finest tolerance.
    Own {
        /// Its method.
        by: String,
        /// The independent one that it is compared with.
        beside: String,
        /// The relative distance of the two: an estimate of the error of the reference.
        apart: f64,
        /// The limit of their steps, where longer ones pass over something short.
        largest: Option<f64>,
    },
}

/// How far rounding moves the end of the exact solution when it is taken in many steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// The largest relative distance from the end in one step.
    pub apart: f64,
    /// The largest number of steps that was tried.
    pub steps: u64,
}

impl Reference {
    /// An estimate of the relative error of the reference.
    pub fn error(&self) -> Option<f64> {
        match self {
            Reference::Exact { rounding } => rounding.map(|rounding| rounding.apart),
            Reference::Own { apart, .. } => Some(*apart),
        }
    }

    /// The floor: nothing can be said of smaller relative errors.
    pub fn floor(&self) -> f64 {
        self.error().unwrap_or_default().max(f64::EPSILON)
    }

    /// The reference of the errors, in sentences.
    pub fn in_words(&self) -> String {
        match self {
            Reference::Exact { rounding: None } => {
                "Errors are measured against the exact solution.".into()
            }
            Reference::Exact { rounding: Some(Rounding { apart, steps }) } => format!(
                "Errors are measured against the exact solution. Taken in 2 to {steps} steps, the exact \
                 solution itself moves by up to {}: smaller errors are rounding.",
                typed(*apart, 1)
            ),
            Reference::Own { by, beside, apart, largest } => {
                let run = format!(
                    "Errors are measured against a run of {by} at a tolerance of {TIGHT:e}"
                );
                let limited = largest.map(|h| {
                    let h = typed(h, 2);
                    format!(", in steps of at most {h}: longer ones pass over something short, such as a pulse")
                });
                format!(
                    "{run}{}. It agrees with a run of {beside} to {}: smaller errors cannot be seen.",
                    limited.unwrap_or_default(),
                    typed(*apart, 1)
                )
            }
        }
    }
}

/// The tolerance of a reference run.
pub(super) const TIGHT: f64 = 1e-13;
/// The methods of a reference, of different kinds: the first two that fit are taken.
pub(super) fn reference_methods() -> Vec<MethodSpec> {
    let with = |name: &str, tableau: &str| MethodSpec {
        tableau: Some(tableau.into()),
        ..MethodSpec::new(name, None)
    };
    vec![
        with("rkmk", "dop853"),
        MethodSpec::new("taylor16", None),
        MethodSpec::new("magnus8", None),
        MethodSpec::new("gauss6", None),
        MethodSpec::new("cf-ls5", None),
        with("rk", "dop853"),
    ]
}
