//! Where scenes and their files are found: a path, standard input, or those that come with the program.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use super::bundled::{BUNDLED, Bundled};
use super::error::SceneError;
use super::files::text_of;
use super::run::Scene;
use super::set;
use crate::kinds::KINDS;
use crate::reader::{help_for, suggest};

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// [`SceneError`], also for a file that cannot be read.
    pub fn load(path: &Path) -> Result<Scene, SceneError> {
        Found::file(path)?.read(&[])
    }

    /// The bundled scene of that name.
    ///
    /// # Errors
    /// [`SceneError`] for an unknown name.
    pub fn bundled(name: &str) -> Result<Scene, SceneError> {
        Found::bundled(name)?.read(&[])
    }

    /// Opens a scene by the path of its file or by its bundled name. `-` is standard input.
    ///
    /// # Errors
    /// [`SceneError`].
    pub fn open(scene: &Path) -> Result<Scene, SceneError> {
        Self::open_with(scene, &[])
    }

    /// Opens a scene and changes it by settings, which are texts such as `time.dt=0.01`, `problem.inertia=[1, 2, 3]` or
    /// `problem.inertia[2]=2.5`. A place in a list counts from 1. Nothing after the `=` takes the key away.
    ///
    /// # Errors
    /// [`SceneError`], also for a setting that cannot be used.
    pub fn open_with(scene: &Path, settings: &[String]) -> Result<Scene, SceneError> {
        Found::open(scene)?.read(settings)
    }
}

/// The text of a scene, and where it was found.
struct Found {
    /// What messages call it; its file stem is the scene's name.
    source: String,
    text: String,
    /// The folder of the files that it names, where it is not bundled.
    folder: Option<PathBuf>,
}

impl Found {
    fn read(self, settings: &[String]) -> Result<Scene, SceneError> {
        let text = set::with_settings(&self.source, &self.text, settings)?;
        Scene::read(&self.source, [&text, &self.text], self.folder.as_deref())
    }

    fn file(path: &Path) -> Result<Self, SceneError> {
        let source = path.display().to_string();
        let unreadable = |why: String| SceneError::new(&source, why);
        if path.is_dir() {
            return Err(unreadable("this is a folder, expected a scene file".into()));
        }
        let file = File::open(path);
        let file = file.map_err(|error| unreadable(format!("cannot read the scene: {error}")))?;
        let text = text_of(file, "scene").map_err(unreadable)?;
        Ok(Found { source, text, folder: path.parent().map(Into::into) })
    }

    fn standard_input() -> Result<Self, SceneError> {
        let source = "stdin";
        let text = text_of(io::stdin().lock(), "scene");
        let text = text.map_err(|why| SceneError::new(source, why))?;
        Ok(Found { source: source.into(), text, folder: Some(PathBuf::new()) })
    }

    fn bundled(name: &str) -> Result<Self, SceneError> {
        let Bundled { name, text } = Bundled::named(name).ok_or_else(|| unknown_scene(name))?;
        Ok(Found { source: format!("{name}.toml"), text: (*text).into(), folder: None })
    }

    fn open(scene: &Path) -> Result<Self, SceneError> {
        let name = scene.to_string_lossy();
        if name == "-" {
            return Self::standard_input();
        }
        let bundled = Bundled::named(&name).is_some();
        if scene.is_file() || (scene.exists() && !bundled) {
            return Self::file(scene);
        }
        let stem = name.strip_suffix(".toml").unwrap_or(&name);
        let a_path = name.contains(['/', '\\', '.']) && Bundled::named(stem).is_none();
        if a_path { Self::file(scene) } else { Self::bundled(&name) }
    }
}

/// No scene has this name.
pub fn unknown_scene(name: &str) -> SceneError {
    let names: Vec<&str> = BUNDLED.iter().map(|scene| scene.name).collect();
    let kinds: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
    let help = match suggest(name, &kinds).filter(|_| suggest(name, &names).is_none()) {
        Some(kind) => {
            format!("`{kind}` is a kind of problem: lieflow scenes {kind} lists its scenes")
        }
        None => help_for(name, &names),
    };
    SceneError::new(name, "neither a file nor a bundled scene".into()).with_help(Some(help))
}
