//! Readings of section 3.2 for the load capacity: supports, direction of the transverse load, contact.

use design::scene::{ContactConfig, SceneConfig};

/// One reading.
pub struct Reading {
    pub name: &'static str,
    pub change: fn(&mut SceneConfig),
}

/// Barrier of the contact: from a void angle of zero to this angle (deg).
const PHI_MIN_DEG: f64 = -5.73;

/// The first is that of the scene.
pub const READINGS: [Reading; 8] = [
    Reading {
        name: "pin at the loaded border, load inwards",
        change: |_| (),
    },
    Reading {
        name: "pin at the loaded border, load outwards",
        change: turn_round,
    },
    Reading {
        name: "roller at the loaded border, load inwards",
        change: swap_supports,
    },
    Reading {
        name: "roller at the loaded border, load outwards",
        change: |config| {
            swap_supports(config);
            turn_round(config);
        },
    },
    Reading {
        name: "as the first, pull on the other middle panel",
        change: |config| config.loads[0].panel[1] = config.sheet.panels[1] / 2,
    },
    Reading {
        name: "as the first, contact 10 times as stiff",
        change: |config| contact(config, 10.0, PHI_MIN_DEG),
    },
    Reading {
        name: "as the first, contact a hundredth as stiff",
        change: |config| contact(config, 0.01, PHI_MIN_DEG),
    },
    Reading {
        name: "as the first, contact infinite at a fifth of the angle",
        change: |config| contact(config, 1.0, 0.2 * PHI_MIN_DEG),
    },
];

fn turn_round(config: &mut SceneConfig) {
    config.loads[1].scale(-1.0);
}

fn swap_supports(config: &mut SceneConfig) {
    if let [one, other, ..] = &mut config.supports[..] {
        std::mem::swap(&mut one.panel, &mut other.panel);
    }
}

/// Stiffness relative to the default, ten times k_theta.
fn contact(config: &mut SceneConfig, stiffness: f64, phi_min_deg: f64) {
    let k_theta = config.linear.map_or(0.0, |linear| linear.k_theta);
    config.contact = Some(ContactConfig {
        stiffness: 10.0 * stiffness * k_theta,
        phi_min_deg,
        phi_cut_deg: 0.0,
    });
}
