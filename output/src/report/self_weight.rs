//! The weight of a sheet and the friction of a sheet that lies on a surface. Neither is in the model; beside the load they
//! say whether they can be left out.

use crate::report::columns::rounded;
use design::analysis::localisation::GRAVITY;
use serde::Serialize;

/// Coefficient of friction between a sheet and a floor or a table.
const FRICTION: f64 = 0.3;

/// Weight and friction of the uncut sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SelfWeight {
    /// Weight (N).
    pub weight: f64,
    /// Friction that the sheet has on a horizontal surface while all its panels slide, with the coefficient 0.3 (N).
    pub friction: f64,
    /// Weight over the load at the end of the path; `None` if that is zero or no force, or without equilibrium.
    pub over_load: Option<f64>,
}

impl SelfWeight {
    /// Of a sheet with the given mass, beside a force (N) if there is one.
    pub(super) fn new(mass_kg: f64, load: Option<f64>) -> Self {
        let weight = 1e-3 * GRAVITY * mass_kg;
        let load = load.map(f64::abs).filter(|load| *load > 0.0);
        Self {
            weight,
            friction: FRICTION * weight,
            over_load: load.map(|load| weight / load),
        }
    }

    pub(super) fn beside_load(&self) -> String {
        let of_load = |over_load: Option<f64>| {
            over_load.map_or(String::new(), |ratio| format!(", {}", of_the_load(ratio)))
        };
        format!(
            "{} N{}; friction on a surface, at mu = {FRICTION}, {} N{}",
            rounded(self.weight, 3),
            of_load(self.over_load),
            rounded(self.friction, 3),
            of_load(self.over_load.map(|ratio| FRICTION * ratio)),
        )
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
    fn weight_and_friction_stand_beside_the_load() {
        // The A4 sheet of film: 0.00867 kg, pulled by 0.525 N.
        let film = SelfWeight::new(0.008_67, Some(-0.525));
        assert!((film.over_load.unwrap() - 0.162).abs() < 5e-4);
        assert_eq!(
            film.beside_load(),
            "0.0851 N, 16 % of the load; friction on a surface, at mu = 0.3, 0.0255 N, 4.9 % of the load"
        );
        // The bell: 161 kg and 28 N.
        let bell = SelfWeight::new(161.0, Some(28.0)).beside_load();
        assert!(
            bell.contains("56 times the load") && bell.contains("17 times"),
            "{bell}"
        );
    }

    #[test]
    fn without_a_load_there_is_no_ratio() {
        for load in [None, Some(0.0)] {
            let weight = SelfWeight::new(1.0, load);
            assert_eq!(weight.over_load, None);
            assert!((weight.weight - 9.81).abs() < 1e-12);
            assert!(!weight.beside_load().contains("load"));
        }
    }
}
