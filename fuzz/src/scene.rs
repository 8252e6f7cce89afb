//! The scene parser on any text: a scene whose problem and grid are checked, or an error that has
//! something to say.

use lieflow_cli::scene::Scene;

/// Parse the bytes as a scene.
pub fn parse(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    match Scene::parse("fuzz", &text) {
        Ok(scene) => drop(scene.model()),
        Err(error) => assert!(!error.to_string().is_empty(), "{text:?}"),
    }
}
