//! What is cut at every hinge: its hole, the slit, and the window for which the hinge was measured.

use hinge::{HingeConstants, HingeDesign};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

/// The hole at the tip of a main cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoleSize {
    /// Its radius as a multiple of w_lig.
    Ratio(f64),
    /// Its diameter (mm), the same at every hinge: a drill, or the smallest hole of a laser.
    Diameter(f64),
}

/// What is cut at a hinge, and its window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "ProcessKeys", into = "ProcessKeys")]
#[schemars(with = "ProcessKeys")]
pub struct CuttingProcess {
    /// The hole at the tip of every main cut.
    pub hole: HoleSize,
    /// Width of the slits (mm).
    pub slit_width: f64,
    /// Radius of a hinge's window (mm).
    pub r_win: f64,
}

/// What is cut at a hinge, and its window.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ProcessKeys {
    /// Radius of the hole at the tip of a main cut, as a multiple of w_lig, above 0 and below 1;
    /// the paper cuts 0.16. Either this or `hole_diameter`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fillet_ratio: Option<f64>,
    /// Diameter of the hole at the tip of every main cut (mm), above `slit_width`. Either this or
    /// `fillet_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hole_diameter: Option<f64>,
    /// Width of the finished slits (mm), above 0 and below the diameter of the hole. It may differ
    /// from the slit of the weights: in a film from 0.002 to 0.15 w_lig it changes W by less than
    /// 0.5 % and the force by less than 2.5 %, in a plate from 0.05 to 0.64 w_lig by less than 0.4
    /// and 3.5 %.
    slit_width: f64,
    /// The key of earlier scenes.
    #[serde(default, skip_serializing, deserialize_with = "earlier_kerf")]
    #[schemars(skip)]
    kerf: (),
    /// Radius of the half-disc of sheet assigned to the hinge (mm), above 2.5 w_lig. For learned
    /// hinges it is the radius of the weights, times the thickness of the sheet over the thickness
    /// in the training.
    r_win: f64,
}

/// A kerf was the width of the slits for some machines and the width that the tool removes for
/// others.
fn earlier_kerf<'de, D: Deserializer<'de>>(_: D) -> Result<(), D::Error> {
    Err(D::Error::custom(
        "is now two keys: process.slit_width, the width of the slits (mm), and cutting.kerf, the width that the tool removes (mm)",
    ))
}

impl TryFrom<ProcessKeys> for CuttingProcess {
    type Error = &'static str;

    fn try_from(keys: ProcessKeys) -> Result<Self, Self::Error> {
        let hole = match (keys.fillet_ratio, keys.hole_diameter) {
            (Some(ratio), None) => HoleSize::Ratio(ratio),
            (None, Some(diameter)) => HoleSize::Diameter(diameter),
            (None, None) | (Some(_), Some(_)) => {
                return Err(
                    "[process] needs either fillet_ratio (radius of the hole over w_lig) or hole_diameter (mm)",
                );
            }
        };
        let ProcessKeys { slit_width, kerf: (), r_win, .. } = keys;
        Ok(Self { hole, slit_width, r_win })
    }
}

impl From<CuttingProcess> for ProcessKeys {
    fn from(CuttingProcess { hole, slit_width, r_win }: CuttingProcess) -> Self {
        let [fillet_ratio, hole_diameter] = match hole {
            HoleSize::Ratio(ratio) => [Some(ratio), None],
            HoleSize::Diameter(diameter) => [None, Some(diameter)],
        };
        Self { fillet_ratio, hole_diameter, slit_width, kerf: (), r_win }
    }
}

impl From<HingeConstants> for CuttingProcess {
    fn from(constants: HingeConstants) -> Self {
        Self {
            hole: HoleSize::Ratio(constants.fillet_ratio),
            slit_width: constants.kerf,
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
                HoleSize::Ratio(ratio) => ratio,
                HoleSize::Diameter(diameter) => 0.5 * diameter / w_lig,
            },
            kerf: self.slit_width,
            r_win: self.r_win,
        }
    }

    /// Radius of the hole of a hinge of width `w_lig` (mm).
    pub fn hole_radius(&self, w_lig: f64) -> f64 {
        match self.hole {
            HoleSize::Ratio(ratio) => ratio * w_lig,
            HoleSize::Diameter(diameter) => 0.5 * diameter,
        }
    }

    /// Derivative of the radius of a hinge's hole in w_lig.
    pub(crate) fn radius_by_width(&self) -> f64 {
        match self.hole {
            HoleSize::Ratio(ratio) => ratio,
            HoleSize::Diameter(_) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_has_one_hole_by_ratio_or_by_diameter() {
        let read = |hole: &str| {
            toml::from_str::<CuttingProcess>(&format!("{hole}\nslit_width = 0.2\nr_win = 100.0"))
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
        let earlier = read("hole_diameter = 2.0\nkerf = 0.1").unwrap_err().to_string();
        assert!(earlier.contains("process.slit_width") && earlier.contains("cutting.kerf"));
        for process in [drilled, papers] {
            let text = toml::to_string(&process).unwrap();
            assert_eq!(toml::from_str::<CuttingProcess>(&text).unwrap(), process);
            let slope = (process.hole_radius(10.001) - process.hole_radius(9.999)) / 0.002;
            assert!((process.radius_by_width() - slope).abs() < 1e-9);
        }
    }
}
