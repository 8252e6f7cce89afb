//! The keys of kinds: what is read and what listings say, stated once; and those that several kinds share.
//!
//! `keys! { Keys { … } }` states the keys of a kind. `keys! { Keys [formula_keys] { … } }` has those of a group too,
//! and a method that takes them out, `formula_keys()`. A dimension may follow the type: `inertia: Reals<3> [INERTIA] = …`.

use lieflow::samples::Interpolation;
use lieflow_runs::schema::Dimension;

use super::kind::{KeyInfo, Kind, ReadForms};
use super::quantity::Quantity;
use super::system::System;
use crate::formula::{Names, Parameters};
use crate::reader::{Read, ReadError, Shape, all, seen};

/// The keys of a kind, as listings show them.
pub(crate) trait KeyTable {
    /// In the order of listings.
    const INFO: &'static [KeyInfo];
}

impl Kind {
    /// An entry without its texts: keys, the quantities of a system, and what reads the keys.
    pub(crate) const fn of<K: KeyTable, S: System>(read: ReadForms) -> Kind {
        let quantities = || S::QUANTITIES.iter().map(Quantity::info).collect();
        let (time, instead) = (Dimension::TIME, &[]);
        Kind { name: "", equation: "", summary: "", time, keys: K::INFO, instead, quantities, read }
    }
}

/// The keys of a kind, and groups of keys before and after them.
macro_rules! keys {
    ($name:ident [$group:ident $($more:ident)*] { $($own:tt)* }) => {
        $group! { $name [$($more)*] { $($own)* } }
    };
    ($name:ident [] { $($own:tt)* }) => {
        keys! { $name { $($own)* } }
    };
    ($name:ident { $($key:ident: $type:ty $([$dimension:ident])? = $meaning:expr,)* }) => {
        $crate::reader::read_by_keys! {
            struct $name {
                $($key: $crate::reader::Key<$type>,)*
                // Numbers know them before a kind reads its keys.
                #[allow(dead_code)]
                parameters: $crate::reader::Key<$crate::formula::Parameters>,
            }
        }

        impl $crate::problem::KeyTable for $name {
            const INFO: &'static [$crate::problem::KeyInfo] = &[
                $($crate::problem::KeyInfo {
                    name: $crate::reader::key_name(stringify!($key)),
                    meaning: $meaning,
                    shape: <$type as $crate::reader::Read>::SHAPE,
                    optional: <$type as $crate::reader::Read>::OPTIONAL,
                    dimension: lieflow_runs::schema::Dimension::first(&[$(lieflow_runs::schema::Dimension::$dimension)?]),
                },)*
                $crate::problem::PARAMETERS,
            ];
        }
    };
}
pub(crate) use keys;

/// A group of keys: the table of their values, and the macro that adds them to those of a kind, before or after. The table
/// may have keys that every kind has, too.
macro_rules! group {
    (
        $(#[$doc:meta])* $table:ident in ($($room:tt)+) = $method:ident $dollar:tt,
        $(with { $($with:ident: $with_type:ty,)* })?
        before { $($before:ident: $before_type:ty $([$before_dimension:ident])? = $before_meaning:expr,)* }
        after { $($after:ident: $after_type:ty $([$after_dimension:ident])? = $after_meaning:expr,)* }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub(crate) struct $table {
            $($(pub(crate) $with: $crate::reader::Key<$with_type>,)*)?
            $(pub(crate) $before: $crate::reader::Key<$before_type>,)*
            $(pub(crate) $after: $crate::reader::Key<$after_type>,)*
        }

        macro_rules! $method {
            ($dollar name:ident [$dollar ($dollar more:ident)*] { $dollar ($dollar own:tt)* }) => {
                $crate::problem::keys! { $dollar name [$dollar ($dollar more)*] {
                    $($before: $before_type $([$before_dimension])? = $before_meaning,)*
                    $dollar ($dollar own)*
                    $($after: $after_type $([$after_dimension])? = $after_meaning,)*
                } }

                impl $dollar name {
                    /// Takes the keys of the group out.
                    fn $method(&mut self) -> $($room)+::$table {
                        use $crate::reader::take;
                        $($room)+::$table {
                            $($($with: take(&mut self.$with),)*)?
                            $($before: take(&mut self.$before),)*
                            $($after: take(&mut self.$after),)*
                        }
                    }
                }
            };
        }
        pub(crate) use $method;
    };
}

/// The key of the constants, of every kind.
pub(crate) const PARAMETERS: KeyInfo = KeyInfo {
    name: "parameters",
    meaning: "constants for formulas and for numbers, which may be texts such as \"m*a^2/6\" or \"5*deg\": a table \
              [problem.parameters] of names with numbers, or with formulas of others; optional",
    shape: Parameters::SHAPE,
    optional: true,
    dimension: None,
};

/// The key of a file of samples.
pub(crate) const SAMPLES: KeyInfo = KeyInfo {
    name: "samples",
    meaning: "the name of a CSV file of samples, beside the scene: a line of names, t first, and rows of numbers; \
              the other columns are variables of the formulas, functions of t; optional",
    shape: Shape::Samples,
    optional: true,
    dimension: None,
};

pub(crate) use group;

group! {
    /// The keys of samples, of every kind with formulas in t.
    SampleKeys in (crate::problem) = sample_keys $,
    before {}
    after {
        samples: Option<crate::formula::SamplesFile> = crate::problem::SAMPLES.meaning,
        interpolation: Option<String> =
            "what lies between samples: \"linear\", \"cubic\", \"previous\" for values that are held or, of increments \
             over the interval before each time, \"mean-rate\"; optional, linear",
    }
}

group! {
    /// The keys of names, of every kind that reads formulas.
    FormulaKeys in (crate::problem) = formula_keys $,
    with { parameters: crate::formula::Parameters, }
    before {}
    after {
        r#let: crate::formula::Lets =
            "formulas with names, for other formulas: a table [problem.let] of names and formulas; a list of formulas, \
             or a formula such as \"cross(w, b)\", is a vector, and rows of formulas are a matrix; optional",
    }
}

impl SampleKeys {
    /// The keys of a problem without samples.
    pub(crate) fn none() -> Self {
        SampleKeys { samples: Ok(None), interpolation: Ok(None) }
    }
}

impl FormulaKeys {
    /// The names of these variables, the samples, the constants and the named formulas. A variable that is not a valid name is
    /// refused at `key`. The mistakes of named formulas are those of [`Names::checked`].
    ///
    /// # Errors
    /// As [`Parameters::names`](crate::formula::Parameters::names) and [`Names::with_samples`].
    pub(crate) fn names<N: Into<String>>(
        &self,
        key: &str,
        variables: impl IntoIterator<Item = N>,
        SampleKeys { samples, interpolation }: SampleKeys,
    ) -> Result<Names, ReadError> {
        let parameters = seen(&self.parameters);
        let names = parameters.and_then(|parameters| parameters.names(key, variables));
        let interpolation = interpolation
            .and_then(|name| Ok(name.as_deref().map(Interpolation::named).transpose()?));
        let (names, samples, interpolation) = all!(names, samples, interpolation)?;
        let names = names.with_samples(samples, interpolation)?;
        Ok(names.with_lets("let", seen(&self.r#let)?))
    }
}
