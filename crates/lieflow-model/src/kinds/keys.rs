//! The keys of kinds: what is read and what listings say, stated once; and those that several kinds share.
//!
//! `keys! { Keys { … } }` states the keys of a kind. `keys! { Keys [formula_keys] { … } }` has those of a group too,
//! and a method that takes them out, `formula_keys()`.

use super::prelude::{KeyInfo, Refusal};
use crate::scene::formula::Names;

/// The keys of a kind, as listings show them.
pub(super) trait KeyTable {
    /// In the order of listings.
    const INFO: &'static [KeyInfo];
}

/// The keys of a kind, and groups of keys before and after them.
macro_rules! keys {
    ($name:ident [$group:ident $($more:ident)*] { $($own:tt)* }) => {
        $group! { $name [$($more)*] { $($own)* } }
    };
    ($name:ident [] { $($own:tt)* }) => {
        keys! { $name { $($own)* } }
    };
    ($name:ident { $($key:ident: $type:ty = $meaning:expr,)* }) => {
        $crate::scene::read::read_by_keys! { struct $name { $($key: $type,)* } }

        impl $crate::kinds::KeyTable for $name {
            const INFO: &'static [$crate::kinds::KeyInfo] = &[$($crate::kinds::KeyInfo {
                name: $crate::scene::read::key_name(stringify!($key)),
                meaning: $meaning,
            },)*];
        }
    };
}
pub(super) use keys;

/// A group of keys: the table of their values, and the macro that adds them to those of a kind, before or after.
macro_rules! group {
    (
        $(#[$doc:meta])* $table:ident = $method:ident $dollar:tt,
        before { $($before:ident: $before_type:ty = $before_meaning:expr,)* }
        after { $($after:ident: $after_type:ty = $after_meaning:expr,)* }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Default)]
        pub(crate) struct $table {
            $(pub(crate) $before: $before_type,)*
            $(pub(crate) $after: $after_type,)*
        }

        macro_rules! $method {
            ($dollar name:ident [$dollar ($dollar more:ident)*] { $dollar ($dollar own:tt)* }) => {
                keys! { $dollar name [$dollar ($dollar more)*] {
                    $($before: $before_type = $before_meaning,)*
                    $dollar ($dollar own)*
                    $($after: $after_type = $after_meaning,)*
                } }

                impl $dollar name {
                    /// Takes the keys of the group out.
                    fn $method(&mut self) -> $crate::kinds::keys::$table {
                        $crate::kinds::keys::$table {
                            $($before: core::mem::take(&mut self.$before),)*
                            $($after: core::mem::take(&mut self.$after),)*
                        }
                    }
                }
            };
        }
        pub(super) use $method;
    };
}

/// The key of the constants.
pub(super) const PARAMETERS: KeyInfo = KeyInfo {
    name: "parameters",
    meaning: "constants for the formulas: a table [problem.parameters] of names and numbers; optional",
};

/// The key of a file of samples.
pub(crate) const SAMPLES: KeyInfo = KeyInfo {
    name: "samples",
    meaning: "the name of a CSV file of samples, beside the scene: a line of names, t first, and rows of numbers; \
              the other columns are variables of the formulas, functions of t; optional",
};

group! {
    /// The keys of samples, of every kind with formulas in t.
    SampleKeys = sample_keys $,
    before {}
    after {
        samples: Option<crate::scene::formula::SamplesFile> = crate::kinds::keys::SAMPLES.meaning,
        interpolation: Option<String> =
            "what lies between samples: \"linear\", \"cubic\" or, of increments over the interval before each \
             time, \"mean-rate\"; optional, linear",
    }
}

group! {
    /// The keys of names, of every kind that reads formulas.
    FormulaKeys = formula_keys $,
    before {}
    after {
        parameters: crate::scene::formula::Parameters = crate::kinds::keys::PARAMETERS.meaning,
        r#let: crate::scene::formula::Lets =
            "formulas with names, for other formulas: a table [problem.let] of names and formulas; a list of formulas, \
             or a formula such as \"cross(w, b)\", is a vector; optional",
    }
}

group! {
    /// The keys of a body and its start, of every kind of bodies. The library's moments are about principal axes.
    BodyKeys = body_keys $,
    before {
        inertia: Option<crate::scene::values::Diagonal> =
            "principal moments of inertia [J1, J2, J3], or the tensor of inertia as three rows",
        inverse_inertia: Option<crate::scene::values::Reals<3>> = "their reciprocals, instead of inertia",
        shape: Option<crate::kinds::body::Shape> =
            "instead of inertia: {kind = \"box\", mass, sides = [a, b, c]}, {kind = \"ellipsoid\", mass, \
             semi_axes}, {kind = \"cylinder\", mass, radius, height}",
        omega_body: Option<crate::scene::values::Reals<3>> = "initial angular velocity in the body",
        momentum_body: Option<crate::scene::values::Reals<3>> =
            "initial angular momentum in the body, instead of omega_body",
        omega_space: Option<crate::scene::values::Reals<3>> =
            "initial angular velocity in space, instead of omega_body",
        momentum_space: Option<crate::scene::values::Reals<3>> =
            "initial angular momentum in space, instead of omega_body",
        attitude: Option<crate::scene::values::Rows<3>> =
            "initial rotation from body to space, three rows; optional, the identity",
        quaternion: Option<crate::scene::values::Reals<4>> =
            "the same as a unit quaternion [w, x, y, z], instead of attitude; a rigid-body is then integrated by its \
             quaternion",
    }
    after {}
}

impl FormulaKeys {
    /// The names of these variables, the samples, the constants and the named formulas. A variable that is no name is
    /// refused at `key`.
    ///
    /// # Errors
    /// As [`Parameters::names`], [`Names::with_samples`] and [`Names::with_lets`].
    pub(super) fn names<N: Into<String>>(
        &self,
        key: &str,
        variables: impl IntoIterator<Item = N>,
        SampleKeys { samples, interpolation }: SampleKeys,
    ) -> Result<Names, Refusal> {
        let names = self.parameters.names(key, variables)?;
        names.with_samples(samples, interpolation.as_deref())?.with_lets("let", &self.r#let)
    }
}
