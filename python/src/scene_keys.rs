//! The keys of a scene, and names of choices, as Python gives them.

use crate::{errors, waiting::unlocked};
use design::SearchMethod;
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};
use scene::{Level, Scene, SceneConfig};
use std::path::Path;

/// The scene with the keys of a dict.
pub(crate) fn scene_of(keys: &Bound<PyDict>, folder: &Path) -> PyResult<Scene> {
    let py = keys.py();
    let text: String = py.import("kirigami.files")?.call_method1("_json", (keys,))?.extract()?;
    let path = folder.join("scene (dict)");
    let keys: toml::Value = serde_json::from_str(&text).map_err(errors::scene)?;
    let text = toml::to_string(&keys).map_err(errors::scene)?;
    let config: SceneConfig = support::toml_file::parse(&text, &path).map_err(errors::scene)?;
    unlocked(|| Scene::new(config, &path))?.map_err(errors::scene)
}

pub(crate) fn read_level(name: &str) -> PyResult<Level> {
    Level::named(name).ok_or_else(|| {
        let names = Level::ALL.map(Level::name).join(", ");
        PyValueError::new_err(format!("`level` is \"{name}\", expected one of {names}"))
    })
}

pub(crate) fn read_method(name: &str) -> PyResult<SearchMethod> {
    match name {
        "adam" => Ok(SearchMethod::Adam),
        "lbfgs" => Ok(SearchMethod::Lbfgs),
        _ => Err(PyValueError::new_err(format!(
            "`method` is \"{name}\", expected \"adam\" or \"lbfgs\""
        ))),
    }
}
