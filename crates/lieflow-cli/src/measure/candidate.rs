//! What is compared: methods with their parts, on a layer, in steps of one size or of their own.

use std::collections::HashSet;

use lieflow::catalog::{Family, MethodInfo, MethodSpec, Property, TABLEAUS, all_methods};
use lieflow::names::same;

use crate::error::CliError;
use lieflow_model::problem::Layer;
use lieflow_model::reader::suggest;
use lieflow_model::scene::Scene;

/// A method on a layer.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Candidate {
    /// The method.
    pub method: MethodSpec,
    /// The layer.
    pub layer: Layer,
    /// Does it choose its steps by their error?
    pub adaptive: bool,
}

impl Candidate {
    /// RKMK4 with a map on a layer.
    pub fn rkmk4(map: &str, layer: Layer) -> Self {
        Candidate { method: MethodSpec::new("rkmk4", Some(map)), layer, adaptive: false }
    }

    /// Classical RK4 on the entries.
    pub fn rk4(layer: Layer) -> Self {
        Candidate { method: MethodSpec::new("rk4", None), layer, adaptive: false }
    }

    /// Its name in tables and legends where there is one layer.
    pub fn name(&self) -> String {
        let steps = if self.adaptive { ", adaptive" } else { "" };
        self.method.label() + steps
    }

    /// Its name in tables and legends where there are two layers.
    pub fn label(&self) -> String {
        let layer = if self.layer == Layer::General { ", general" } else { "" };
        self.name() + layer
    }

    /// What the catalog knows of the method.
    fn info(&self) -> Option<&'static MethodInfo> {
        self.method.info().ok()
    }

    /// The kind of method that it is.
    pub fn kind(&self) -> Option<Family> {
        self.info().map(|info| info.family)
    }

    /// The figure that it belongs to: its tableau, or the kind of a method that has none.
    pub fn figure(&self) -> &str {
        match self.method.name.as_str() {
            "rkmk4" | "rk4" => "rk4",
            _ => match &self.method.tableau {
                Some(tableau) => tableau,
                None => self.kind().map_or("", Family::name),
            },
        }
    }

    /// The invariants that the catalog promises, in words.
    pub fn keeps(&self) -> String {
        self.info().map_or_else(String::new, MethodInfo::preserves_in_words)
    }

    /// Does the catalog say that it keeps the energy, or keeps it within bounds (symplectic)?
    pub fn keeps_energy(&self) -> bool {
        let keeps =
            |info: &MethodInfo| info.keeps(Property::Energy) || info.keeps(Property::Symplectic);
        self.info().is_some_and(keeps)
    }

    /// Evaluations of f, of F or of A in a step of one size, as the catalog states its cost; none for
    /// an implicit method, whose number depends on the step, and for one that evaluates no field.
    pub fn evaluations_per_step(&self) -> Option<u64> {
        self.method.evaluations().ok()?
    }

    /// Everything in the catalog that runs on the problem of `scene` on this layer, each method with
    /// the tableaus and maps that it takes, in steps of one size, and those that estimate their own
    /// error in steps of their own too. A tableau that has a method of its own is listed under that.
    ///
    /// # Errors
    /// The problem cannot be set up.
    pub fn all_that_fit(
        scene: &Scene,
        quantities: &[&str],
        layer: Layer,
    ) -> Result<Vec<Self>, CliError> {
        let model = scene.model_with(layer, quantities)?;
        let mut fitting = Vec::new();
        for info in all_methods() {
            let none = [None];
            let maps: Vec<Option<&str>> = match info.takes_map() {
                true => info.takes().map(|map| Some(map.name)).collect(),
                false => none.into(),
            };
            let tableaus: Vec<Option<&str>> = match info.takes_tableau {
                true => TABLEAUS.iter().filter(|t| t.name != "rk4").map(|t| Some(t.name)).collect(),
                false => none.into(),
            };
            for tableau in &tableaus {
                for map in &maps {
                    let mut method = MethodSpec::new(info.name, *map);
                    method.tableau = tableau.map(Into::into);
                    if model.fits(&method).is_ok() {
                        fitting.extend(Candidate::by(method, layer)?);
                    }
                }
            }
        }
        Ok(fitting)
    }

    /// A method on a layer, in steps of one size, and in steps of its own if it estimates its error.
    fn by(method: MethodSpec, layer: Layer) -> Result<impl Iterator<Item = Self>, CliError> {
        let adaptive =
            method.has_pair()?.then(|| Candidate { method: method.clone(), layer, adaptive: true });
        Ok([Candidate { method, layer, adaptive: false }].into_iter().chain(adaptive))
    }

    /// Is it this method with these parts? Parts that are not given may be any.
    fn is_with(&self, given: &MethodSpec) -> bool {
        let MethodSpec { name, map, tableau, q } = &self.method;
        let is_part = |given: &Option<String>, part| given.is_none() || given == part;
        *name == given.name
            && is_part(&given.map, map)
            && is_part(&given.tableau, tableau)
            && *q == given.q
    }

    /// The candidates that these names stand for: the name of a method, or a method with parts as in
    /// `rkmk dopri5 cay`. A method with parts that the list does not have, as `rkmk4 q=2`, is one more candidate if it fits
    /// the scene. What follows a method in the tables, `, adaptive, general`, may stand among the names as it does there:
    /// pairs go in both kinds of steps anyway, and layers are chosen apart. They are in the order of the list.
    ///
    /// # Errors
    /// A name that stands for none of them.
    pub fn chosen(
        scene: &Scene,
        quantities: &[&str],
        all: &[Self],
        names: &[String],
    ) -> Result<Vec<Self>, CliError> {
        let names = names.iter().map(|name| name.trim());
        let names: Vec<&str> =
            names.filter(|name| !["adaptive", "general"].contains(name)).collect();
        if names.is_empty() {
            return Err(CliError::Message(
                "no method is named, expected names such as \"rkmk4 cay\"".into(),
            ));
        }
        let mut layers: Vec<Layer> = all.iter().map(|candidate| candidate.layer).collect();
        layers.dedup();
        let mut chosen: Vec<Self> = Vec::new();
        for name in names {
            let given = match name.parse::<MethodSpec>() {
                Ok(given) => given,
                Err(error) => return Err(not_known(all, name, &error)),
            };
            let before = chosen.len();
            chosen.extend(all.iter().filter(|candidate| candidate.is_with(&given)).cloned());
            if chosen.len() > before {
                continue;
            }
            let mut why = None;
            for &layer in &layers {
                match scene.model_with(layer, quantities)?.fits(&given) {
                    Ok(_) => chosen.extend(Candidate::by(given.clone(), layer)?),
                    Err(error) => why = Some(error),
                }
            }
            if chosen.len() == before {
                let why = why.map_or_else(String::new, |why| format!(": {why}"));
                return Err(CliError::Message(format!(
                    "no method `{name}` fits this scene{why}; `lieflow methods --for` with the scene lists those that fit"
                )));
            }
        }
        let mut seen = HashSet::new();
        chosen.retain(|candidate| seen.insert(candidate.clone()));
        chosen.sort_by_key(|one| all.iter().position(|other| other == one).unwrap_or(all.len()));
        Ok(chosen)
    }
}

/// The message about a name that is no method, or has parts that the method does not take.
fn not_known(all: &[Candidate], name: &str, error: &lieflow::Error) -> CliError {
    let first = name.split_whitespace().next().unwrap_or_default();
    CliError::Message(if all_methods().any(|info| same(info.name, first)) {
        format!("there is no method `{name}`: {error}")
    } else if TABLEAUS.iter().any(|tableau| same(tableau.name, first)) {
        format!("`{first}` is a tableau: name it after a method, as in `rkmk {name}`")
    } else {
        let mut known: Vec<&str> = all.iter().map(|c| c.method.name.as_str()).collect();
        known.dedup();
        let near = suggest(name, &known).map(|near| format!("did you mean `{near}`?"));
        let help = near.unwrap_or_else(|| "`lieflow methods` lists them".into());
        format!("unknown method `{name}`; {help}")
    })
}
