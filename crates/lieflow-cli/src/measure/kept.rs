//! Which methods keep an invariant for long times.

use lieflow::catalog::{MethodInfo, MethodSpec, Property};
use lieflow_model::reader::help_for;
use lieflow_model::scene::Scene;
use lieflow_model::schema::Observable;

use crate::error::CliError;

/// An invariant of a scene that methods are asked to keep.
#[derive(Clone, Debug)]
pub struct Kept(Observable);

impl Kept {
    /// The invariant of that name.
    ///
    /// # Errors
    /// The exact motion of the scene keeps no quantity of that name.
    pub fn of(scene: &Scene, name: &str) -> Result<Self, CliError> {
        let quantities: Vec<&str> = scene.quantities.iter().map(String::as_str).collect();
        let invariants = scene.problem.invariants(&quantities);
        let Some(known) = invariants.iter().find(|known| lieflow::names::same(known, name)) else {
            let message = match invariants.is_empty() {
                true => "the exact motion keeps no quantity of this scene".into(),
                false => {
                    format!("no invariant `{name}` of this scene: {}", help_for(name, &invariants))
                }
            };
            return Err(CliError::Message(format!("--keep: {message}")));
        };
        let model = scene.model_with(scene.layer, &[known])?;
        Ok(Kept(model.schema().get(known)?.clone()))
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        self.0.name
    }

    /// Does a method keep it: to rounding, or an energy within bounds?
    pub fn by(&self, method: &MethodSpec) -> bool {
        let keeps = |info: &MethodInfo| {
            let is_bounded = self.0.name == "energy" && info.keeps(Property::Symplectic);
            self.0.promised_by(info) || is_bounded
        };
        method.info().is_ok_and(keeps)
    }
}
