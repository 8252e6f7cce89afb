//! Scene files and their runs.

use std::path::PathBuf;
use std::sync::Arc;

use lieflow::Direction;
use lieflow_model::problem::Plan;
use lieflow_model::scene::{self, SceneEvent};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{argument, refused};
use crate::field::Raised;
use crate::model::schema_of;
use crate::run::{Rows, Seen, Watching};
use crate::tree::untree;

/// A scene.
#[pyclass(frozen, module = "lieflow._lieflow")]
pub(crate) struct Scene(scene::Scene);

#[pymethods]
impl Scene {
    /// The scene of a file or of a bundled name, with settings such as `time.dt=0.01`.
    #[new]
    fn new(py: Python<'_>, path: PathBuf, settings: Vec<String>) -> PyResult<Self> {
        let opened = py.detach(|| scene::Scene::open_with(&path, &settings));
        opened.map(Scene).map_err(|error| argument(py, "scene", error.to_string(), ""))
    }
    #[getter]
    fn title(&self) -> &str {
        &self.0.title
    }
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }
    #[getter]
    fn text(&self) -> &str {
        &self.0.text
    }
    #[getter]
    fn method(&self) -> String {
        self.0.method.label()
    }
    #[getter]
    fn quantities(&self) -> Vec<String> {
        self.0.quantities.clone()
    }
    #[getter]
    fn t_span(&self) -> [f64; 2] {
        self.0.grid.t_span()
    }
    /// Each event: its formula, the zero that ends the run or 0, its direction, its name.
    #[getter]
    fn events(&self) -> Vec<(&str, u64, i32, &str)> {
        let sign = |direction| match direction {
            Direction::Rising => 1,
            Direction::Falling => -1,
            Direction::Both => 0,
        };
        let all = self.0.events.iter();
        all.map(|event| {
            let SceneEvent { name, direction, stop_after, text, .. } = event;
            (&**text, stop_after.unwrap_or_default(), sign(*direction), &**name)
        })
        .collect()
    }
    #[getter]
    fn kind(&self) -> &'static str {
        self.0.problem.kind().name
    }
    /// The keys of the problem.
    fn keys<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        untree(py, &self.0.keys)
    }
    /// What is wrong with the numbers of the problem, though they can be integrated.
    #[getter]
    fn warnings(&self) -> &[String] {
        self.0.problem.warnings()
    }
    /// Runs it: the schema of the rows, and the dict of the result.
    fn run<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let refuse = |error: lieflow::Error| refused(py, "scene", &error);
        let computed = self.0.computed();
        let model = self.0.model_with(self.0.layer, &computed).map_err(refuse)?;
        let raised = Arc::new(Raised::default());
        let plan = self.0.plan(model.schema()).map_err(refuse)?;
        let mut seen = Seen::default();
        seen.found = plan.events.iter().map(|_| Rows::default()).collect();
        drop(plan);
        self.0.forget_losses();
        let (done, lost) = py.detach(|| {
            let plan = match self.0.plan(model.schema()) {
                Ok(plan) => Plan { cancel: Some(&*raised.stop), ..plan },
                Err(error) => return (Err(error.into()), None),
            };
            let mut watcher = Watching { callback: None, raised: &raised, seen: &mut seen };
            let done = model.drive(&self.0.method, plan, &mut watcher);
            let lost = done.as_ref().err().and_then(|error| self.0.lost_in_words(error));
            (done, lost)
        });
        let width = model.schema().columns().count();
        let status = done.map(|outcome| outcome.status);
        let result = seen.into_dict(py, &raised, status, (&[width], "h_max"), None)?;
        result.set_item("form", model.problem_type(&self.0.method))?;
        if let Some(lost) = lost {
            result.set_item("message", lost)?;
        }
        Ok((schema_of(model.schema()).into_pyobject(py)?.into_any(), result))
    }
}

/// The names of the bundled scenes.
#[pyfunction]
pub(crate) fn bundled() -> Vec<&'static str> {
    scene::BUNDLED.iter().map(|scene| scene.name).collect()
}
