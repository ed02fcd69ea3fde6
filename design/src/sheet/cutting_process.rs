//! What the cutting tool leaves at every hinge: its hole, the kerf, and the window for which the
//! hinge was measured.

use hinge::{HingeConstants, HingeDesign};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The hole at the tip of a main cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hole {
    /// Its radius as a multiple of w_lig.
    Ratio(f64),
    /// Its diameter (mm), the same at every hinge: a drill, or the smallest hole of a laser.
    Diameter(f64),
}

/// The cutting tool and the windows of the hinges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "ProcessKeys", into = "ProcessKeys")]
#[schemars(with = "ProcessKeys")]
pub struct CuttingProcess {
    /// The hole at the tip of every main cut.
    pub hole: Hole,
    /// Width the cutting tool removes (mm).
    pub kerf: f64,
    /// Radius of a hinge's window (mm).
    pub r_win: f64,
}

/// The cutting tool and the windows of the hinges.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ProcessKeys {
    /// Radius of the hole at the tip of a main cut, as a multiple of w_lig, above 0 and below 1;
    /// the paper cuts 0.16. Either this or `hole_diameter`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fillet_ratio: Option<f64>,
    /// Diameter of the hole at the tip of every main cut (mm), above kerf. Either this or
    /// `fillet_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hole_diameter: Option<f64>,
    /// Width the cutting tool removes along the main cut (mm), above 0 and below the diameter of
    /// the hole. It may differ from the kerf of the weights: in a film from 0.002 to 0.15 w_lig it
    /// changes W by less than 0.5 % and the force by less than 2.5 %, in a plate from 0.05 to 0.64
    /// w_lig by less than 0.4 and 3.5 %.
    kerf: f64,
    /// Radius of the half-disc of sheet assigned to the hinge (mm), above 2.5 w_lig. For learned
    /// hinges it is the radius of the weights, times the thickness of the sheet over the thickness
    /// in the training.
    r_win: f64,
}

/// Why `[process]` does not define a hole.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "[process] needs either fillet_ratio (radius of the hole over w_lig) or hole_diameter (mm)"
)]
struct OneHole;

impl TryFrom<ProcessKeys> for CuttingProcess {
    type Error = OneHole;

    fn try_from(keys: ProcessKeys) -> Result<Self, OneHole> {
        let hole = match (keys.fillet_ratio, keys.hole_diameter) {
            (Some(ratio), None) => Hole::Ratio(ratio),
            (None, Some(diameter)) => Hole::Diameter(diameter),
            (None, None) | (Some(_), Some(_)) => return Err(OneHole),
        };
        let ProcessKeys { kerf, r_win, .. } = keys;
        Ok(Self { hole, kerf, r_win })
    }
}

impl From<CuttingProcess> for ProcessKeys {
    fn from(CuttingProcess { hole, kerf, r_win }: CuttingProcess) -> Self {
        let [fillet_ratio, hole_diameter] = match hole {
            Hole::Ratio(ratio) => [Some(ratio), None],
            Hole::Diameter(diameter) => [None, Some(diameter)],
        };
        Self { fillet_ratio, hole_diameter, kerf, r_win }
    }
}

impl From<HingeConstants> for CuttingProcess {
    fn from(constants: HingeConstants) -> Self {
        Self {
            hole: Hole::Ratio(constants.fillet_ratio),
            kerf: constants.kerf,
            r_win: constants.r_win,
        }
    }
}

impl CuttingProcess {
    /// The hinge of width `w_lig` (mm) and cut angle `alpha` (rad).
    pub fn hinge(&self, w_lig: f64, alpha: f64) -> HingeDesign {
        HingeDesign {
            w_lig,
            alpha,
            fillet_ratio: match self.hole {
                Hole::Ratio(ratio) => ratio,
                Hole::Diameter(diameter) => 0.5 * diameter / w_lig,
            },
            kerf: self.kerf,
            r_win: self.r_win,
        }
    }

    /// Radius of the hole of a hinge of width `w_lig` (mm).
    pub fn hole_radius(&self, w_lig: f64) -> f64 {
        match self.hole {
            Hole::Ratio(ratio) => ratio * w_lig,
            Hole::Diameter(diameter) => 0.5 * diameter,
        }
    }

    /// Derivative of the radius of a hinge's hole in w_lig.
    pub(crate) fn radius_by_width(&self) -> f64 {
        match self.hole {
            Hole::Ratio(ratio) => ratio,
            Hole::Diameter(_) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_has_one_hole_by_ratio_or_by_diameter() {
        let read = |hole: &str| {
            toml::from_str::<CuttingProcess>(&format!("{hole}\nkerf = 0.2\nr_win = 100.0"))
        };
        let drilled = read("hole_diameter = 2.0").unwrap();
        assert_eq!(drilled.hinge(10.0, 1.5).fillet_ratio, 0.1);
        let radii = [10.0, 5.0].map(|w_lig| drilled.hole_radius(w_lig));
        assert_eq!(radii, [1.0; 2]);
        let papers = read("fillet_ratio = 0.16").unwrap();
        assert_eq!(papers, HingeConstants::PAPER.into());
        assert_eq!(papers.hole_radius(10.0), 1.6);
        for both in ["", "hole_diameter = 2.0\nfillet_ratio = 0.16"] {
            let message = read(both).unwrap_err().to_string();
            assert!(message.contains("either fillet_ratio"), "{message}");
        }
        for process in [drilled, papers] {
            let text = toml::to_string(&process).unwrap();
            assert_eq!(toml::from_str::<CuttingProcess>(&text).unwrap(), process);
            let slope = (process.hole_radius(10.001) - process.hole_radius(9.999)) / 0.002;
            assert!((process.radius_by_width() - slope).abs() < 1e-9);
        }
    }
}
