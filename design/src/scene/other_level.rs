//! A scene at another level than its own.

use crate::hinge_law::Order;
use crate::objective::shape::TargetState;
use crate::scene::checked_scene::Scene;
use crate::scene::checks;
use crate::scene::hinge_model::{LinearConstants, PinConfig};
use crate::scene::keys::SceneConfig;
use crate::scene::level::Level;
use crate::scene::loaded_hinge::TYPICAL_SECANT;
use crate::scene::scene_error::SceneError;
use hinge::HingeDeformation;
use std::f64::consts::FRAC_PI_2;

/// The opening of pins at the start (deg), where a scene names none.
const PIN_OPENING: f64 = 25.0;

impl Scene {
    /// The learned levels for which the scene names networks, from the cheapest to the dearest.
    pub fn learned_levels(&self) -> Vec<Level> {
        let has = |level: &Level| {
            let config = SceneConfig {
                level: *level,
                ..self.config.clone()
            };
            level.is_learned() && checks::level(&config).is_ok()
        };
        Level::ALL.into_iter().filter(has).collect()
    }

    /// The scene at another level. What the level does not have is left out: at `pin` supports, loads and drive, below `draft` what the
    /// objective reads from a learned law. Springs, where the scene has none, are the secants of its learned law.
    pub fn at_level(&self, level: Level) -> Result<Self, SceneError> {
        let mut config = self.config.clone();
        config.level = level;
        if !level.is_learned() {
            let objective = &mut config.objective;
            (objective.damage, objective.domain) = (0.0, 0.0);
            objective.target_state = TargetState::Loaded;
        }
        match level {
            Level::Pin => {
                config.pin.get_or_insert(PinConfig {
                    opening_deg: PIN_OPENING,
                    held: false,
                });
                config.supports.clear();
                config.loads.clear();
                config.edge_loads.clear();
                config.opening_couples.clear();
                config.drive = None;
            }
            Level::Linear => config.linear = config.linear.or_else(|| self.springs()),
            _ => {}
        }
        self.changed(config)
    }

    /// The secants of the learned law at 20 degrees, of a hinge with the start width and cuts at a right angle; `None` without such a law.
    fn springs(&self) -> Option<LinearConstants> {
        let surrogate = self.weights()?;
        let hinge = (self.config.process).hinge(self.config.ligament.start, FRAC_PI_2);
        let prepared = surrogate.prepare(&[hinge]);
        let turned = HingeDeformation::from([0.0, 0.0, TYPICAL_SECANT]);
        let energy = &surrogate.evaluate(&prepared, &[turned], Order::Tangent)[0];
        Some(LinearConstants {
            k_a: energy.tangent[0][0],
            k_s: energy.tangent[1][1],
            k_theta: energy.forces[2] / TYPICAL_SECANT,
        })
    }
}
