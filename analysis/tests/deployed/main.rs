//! Shipped scenes deployed: their error budget, their levels, and how they are mounted.

mod error_budget;
mod levels;
mod mounting;

use scene::{Scene, SceneConfig};
use std::path::{Path, PathBuf};

/// A scene file of the repository.
fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes").join(name)
}

/// A scene of the repository, changed.
fn changed(name: &str, change: impl FnOnce(&mut SceneConfig)) -> Scene {
    let mut config: SceneConfig = support::toml_file::read(&shipped(name)).unwrap();
    change(&mut config);
    Scene::new(config, &shipped(name)).unwrap()
}
