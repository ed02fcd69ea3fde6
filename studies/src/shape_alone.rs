//! A scene that asks for the shape alone.

use design::scene::{ObjectiveConfig, SceneConfig};

/// The scene without the objectives on the hinge deformation.
pub fn shape_alone(config: &SceneConfig) -> SceneConfig {
    let mut config = config.clone();
    config.objective = ObjectiveConfig {
        compression: 0.0,
        shear: 0.0,
        balance: false,
        ..config.objective
    };
    config
}
