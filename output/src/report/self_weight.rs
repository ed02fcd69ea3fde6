//! The weight of a sheet compared with its load, and what follows from how the sheet is held out of
//! its plane.

use crate::report::numbers::rounded;
use scene::{Posture, Scene};

/// The weight of the uncut sheet and how it acts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SelfWeight {
    /// What keeps the panels in their plane; `None` if the scene does not say.
    pub posture: Option<Posture>,
    /// Weight (N).
    pub weight: f64,
    /// Weight over the load at the end of the path; `None` if that is zero or no force, or without
    /// equilibrium.
    pub over_load: Option<f64>,
    /// Whether the weight acts in the model.
    pub is_modelled: bool,
    /// Mass of the weights that hang from the sheet over the mass of the sheet; 0 without any.
    pub hung: f64,
}

impl SelfWeight {
    /// The weight of a sheet with the given mass (kg), compared with a force (N) if there is one.
    pub fn new(scene: &Scene, mass_kg: f64, load: Option<f64>) -> Self {
        let weight = hinge::STANDARD_GRAVITY * mass_kg;
        let load = load.map(f64::abs).filter(|load| *load > 0.0);
        // Under a prescribed stroke a mass is a direction only.
        let dead = scene.config.drive.is_none();
        let hung: f64 =
            (scene.config.loads.iter()).filter(|_| dead).filter_map(|load| load.mass_g).sum();
        Self {
            posture: scene.config.posture.map(|posture| posture.kind),
            weight,
            over_load: load.map(|load| weight / load),
            is_modelled: scene.weight_by_area() != [0.0; 2],
            hung: 1e-3 * hung / mass_kg,
        }
    }

    pub fn lies(&self) -> bool {
        self.posture == Some(Posture::Lying)
    }

    /// Effects in the plane that are not modelled for the out-of-plane restraint; `None` if there
    /// are none, and if the scene states no restraint.
    pub fn left_out(&self) -> Option<&'static str> {
        match self.posture? {
            Posture::HeldFlat => Some(
                "what holds the panels flat, and its friction; the weight of the sheet, if its plane is not horizontal",
            ),
            Posture::Lying => Some("in the design, friction"),
            Posture::Hanging if self.is_modelled => None,
            Posture::Hanging | Posture::Free => Some("the weight of the sheet"),
        }
    }

    /// A multiple of the weight, compared with the load at the end of the path.
    pub fn relative_to_load(&self, multiple: f64) -> String {
        let relative = self.over_load.map(|ratio| format!(", {}", of_the_load(multiple * ratio)));
        format!("{} N{}", rounded(multiple * self.weight, 3), relative.unwrap_or_default())
    }
}

/// A ratio to the load in words.
pub(super) fn of_the_load(ratio: f64) -> String {
    if ratio < 10.0 {
        format!("{} % of the load", rounded(100.0 * ratio, 2))
    } else {
        format!("{} times the load", rounded(ratio, 2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_is_compared_with_the_load() {
        let weight = |weight, over_load| SelfWeight {
            posture: None,
            weight,
            over_load,
            is_modelled: false,
            hung: 0.0,
        };
        // The A4 sheet of film: 0.00867 kg, pulled by 0.525 N.
        let film = weight(0.0851, Some(0.162));
        assert_eq!(film.relative_to_load(1.0), "0.0851 N, 16 % of the load");
        assert_eq!(film.relative_to_load(0.3), "0.0255 N, 4.9 % of the load");
        // The bell: 161 kg and 28 N.
        assert_eq!(weight(1579.0, Some(56.4)).relative_to_load(1.0), "1579 N, 56 times the load");
        assert_eq!(weight(9.81, None).relative_to_load(1.0), "9.81 N");
    }
}
