//! A scene at another level than its own.

use crate::{
    checked_scene::Scene, checks, hinge_model::PinConfig, keys::SceneConfig, level::Level,
    loaded_hinge::springs_at_start,
};
use support::Fault;

/// The opening of pins at the start (deg), where a scene names none.
const PIN_OPENING: f64 = 25.0;

impl Scene {
    /// The learned levels for which the scene names networks, from the cheapest to the most
    /// expensive.
    pub fn learned_levels(&self) -> Vec<Level> {
        let has = |level: &Level| {
            let config = SceneConfig { level: *level, ..self.config.clone() };
            level.is_learned() && checks::level(&config).is_ok()
        };
        Level::ALL.into_iter().filter(has).collect()
    }

    /// The scene at another level. What the level does not have is left out: at `pin` supports,
    /// loads and drive, below `draft` what the objective reads from a learned law. A scene without
    /// springs gets the springs of its learned law.
    pub fn at_level(&self, level: Level) -> Result<Self, Fault> {
        let mut config = self.config.clone();
        config.level = level;
        if !level.is_learned() {
            (config.objective.damage, config.objective.domain) = (0.0, 0.0);
        }
        match level {
            Level::Pin => {
                config.pin.get_or_insert(PinConfig { opening_deg: PIN_OPENING, held: false });
                config.clear_actuation();
            }
            Level::Linear => {
                let springs = |weights| springs_at_start(&self.config, weights);
                config.linear = config.linear.or_else(|| self.weights().map(springs));
            }
            _ => {}
        }
        self.changed(config)
    }
}
