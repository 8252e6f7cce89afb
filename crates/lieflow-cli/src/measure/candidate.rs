//! What is compared: methods with their parts, on a layer, in steps of one size or of their own.

use lieflow::catalog::{Family, MethodInfo, MethodSpec, Property, TABLEAUS, all_methods};
use lieflow::maps::MAPS;

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
                true => MAPS.iter().map(|map| Some(map.name)).collect(),
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
                    if model.fits(&method).is_err() {
                        continue;
                    }
                    let pair = method.has_pair()?;
                    fitting.push(Candidate { method: method.clone(), layer, adaptive: false });
                    if pair {
                        fitting.push(Candidate { method, layer, adaptive: true });
                    }
                }
            }
        }
        Ok(fitting)
    }

    /// The candidates that a name stands for: the name of a method, or a method with parts as in
    /// `rkmk dopri5 cay`. What follows a method in the tables, `, adaptive, general`, may stand in the list
    /// as it does there: pairs go in both kinds of steps anyway, and layers are chosen apart.
    ///
    /// # Errors
    /// A name that stands for none of them.
    pub fn chosen(all: &[Self], names: &[String]) -> Result<Vec<Self>, CliError> {
        let stands_for = |name: &str, candidate: &Candidate| {
            let label = candidate.method.label();
            label == name || label.strip_prefix(name).is_some_and(|rest| rest.starts_with(' '))
        };
        let names = || {
            let names = names.iter().map(|name| name.trim());
            names.filter(|name| !["adaptive", "general"].contains(name))
        };
        if names().next().is_none() {
            return Err(CliError::Message(
                "no method is named, expected names such as \"rkmk4 cay\"".into(),
            ));
        }
        for name in names() {
            if !all.iter().any(|candidate| stands_for(name, candidate)) {
                let mut known: Vec<&str> = all.iter().map(|c| c.method.name.as_str()).collect();
                known.dedup();
                let first = name.split_whitespace().next().unwrap_or_default();
                return Err(CliError::Message(if all_methods().any(|info| info.name == first) {
                    format!(
                        "no method `{name}` fits this scene; `lieflow methods --for` with the scene lists those that fit"
                    )
                } else if TABLEAUS.iter().any(|tableau| tableau.name == first) {
                    format!("`{first}` is a tableau: name it after a method, as in `rkmk {name}`")
                } else {
                    let near = suggest(name, &known).map(|near| format!("did you mean `{near}`?"));
                    let help = near.unwrap_or_else(|| "`lieflow methods` lists them".into());
                    format!("unknown method `{name}`; {help}")
                }));
            }
        }
        let chosen = |candidate: &&Candidate| names().any(|name| stands_for(name, candidate));
        Ok(all.iter().filter(chosen).cloned().collect())
    }
}
