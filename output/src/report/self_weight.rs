//! The weight of a sheet compared with its load, and what follows from how the sheet is held out of
//! its plane.

use crate::report::numbers::rounded;
use analysis::localisation::elasto_gravity_length;
use scene::{FRICTION, Posture, Scene};
use serde::Serialize;

/// The weight of the uncut sheet and how it acts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SelfWeight {
    /// What keeps the panels in their plane; `None` if the scene does not say.
    pub posture: Option<Posture>,
    /// Weight (N).
    pub weight: f64,
    /// Weight over the load at the end of the path; `None` if that is zero or no force, or without
    /// equilibrium.
    pub over_load: Option<f64>,
    /// Whether the weight acts in the model.
    pub is_modelled: bool,
    /// Mass of the weights that hang from the sheet over the mass of the sheet; `None` if no weight
    /// hangs from it.
    pub hung: Option<f64>,
    /// Friction and bending of a sheet that lies on a surface.
    pub lying: Option<Lying>,
}

/// A sheet that lies on a surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lying {
    /// Friction while all panels slide (N), with the coefficient [`FRICTION`].
    pub friction: f64,
    /// The length l_eg at which the weight of a plate bends it as much as its stiffness resists
    /// (mm).
    pub bending_length: f64,
    /// The radius of the windows of hinges (mm).
    pub window: f64,
}

impl SelfWeight {
    /// The weight of a sheet with the given mass (kg), compared with a force (N) if there is one.
    pub(super) fn new(scene: &Scene, mass_kg: f64, load: Option<f64>) -> Self {
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
            hung: (hung > 0.0).then(|| 1e-3 * hung / mass_kg),
            lying: Lying::new(scene, weight),
        }
    }

    /// Effects in the plane that are not modelled for the out-of-plane restraint; `None` if there
    /// are none, and if the scene states no restraint.
    pub(super) fn left_out(&self) -> Option<&'static str> {
        match self.posture? {
            Posture::HeldFlat => Some(
                "what holds the panels flat, and its friction; the weight of the sheet, if its plane is not horizontal",
            ),
            Posture::Lying => Some("in the design, friction"),
            Posture::Hanging if self.is_modelled => None,
            Posture::Hanging | Posture::Free => Some("the weight of the sheet"),
        }
    }

    /// Names and values.
    pub(super) fn rows(&self) -> Vec<(&'static str, String)> {
        let modelled = if self.is_modelled { "modelled" } else { "not modelled" };
        let weight = self.beside_load(self.weight);
        let mut rows = vec![("weight", format!("{weight}; {modelled}"))];
        if let Some(lying) = &self.lying {
            rows.extend(lying.rows(self));
        }
        rows
    }

    /// A force compared with the load at the end of the path.
    pub(super) fn beside_load(&self, force: f64) -> String {
        let ratio = self.over_load.map(|ratio| ratio * force / self.weight);
        let relative = ratio.map_or(String::new(), |ratio| format!(", {}", of_the_load(ratio)));
        format!("{} N{relative}", rounded(force, 3))
    }
}

impl Lying {
    fn new(scene: &Scene, weight: f64) -> Option<Self> {
        (scene.config.posture?.kind == Posture::Lying).then(|| Self {
            friction: FRICTION * weight,
            bending_length: elasto_gravity_length(&scene.material),
            window: scene.config.process.r_win,
        })
    }

    fn rows(&self, of: &SelfWeight) -> Vec<(&'static str, String)> {
        let force = of.beside_load(self.friction);
        let mut rows = vec![(
            "friction",
            format!("{force}, while all panels slide at mu = {FRICTION}; not in the design"),
        )];
        let length = rounded(self.bending_length, 3);
        let ratio = rounded(self.bending_length / self.window, 2);
        let text = format!("l_eg {length} mm, {ratio} times the radius of a window");
        rows.push(("bending by weight", text));
        rows
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

    fn weight(weight: f64, over_load: Option<f64>) -> SelfWeight {
        SelfWeight { posture: None, weight, over_load, is_modelled: false, hung: None, lying: None }
    }

    #[test]
    fn a_force_stands_beside_the_load() {
        // The A4 sheet of film: 0.00867 kg, pulled by 0.525 N.
        let film = weight(0.0851, Some(0.162));
        assert_eq!(film.beside_load(0.0851), "0.0851 N, 16 % of the load");
        assert_eq!(film.beside_load(0.02553), "0.0255 N, 4.9 % of the load");
        // The bell: 161 kg and 28 N.
        let bell = weight(1579.0, Some(56.4)).rows();
        assert!(bell[0].1.contains("56 times the load; not modelled"), "{bell:?}");
    }

    #[test]
    fn without_a_load_there_is_no_ratio() {
        assert_eq!(weight(9.81, None).beside_load(9.81), "9.81 N");
    }
}
