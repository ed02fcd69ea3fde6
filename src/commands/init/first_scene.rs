//! The first scene of a project: a sheet whose middle panel at the bottom is moved away from that at the top.
//!
//! The shipped A4 scene, with lengths in proportion to the thickness and the panels as small as their windows allow. The
//! target is the rectangle that the uniform sheet of rigid panels a x b fills when every hinge opens by theta; (6):
//!
//! ```text
//! pitch = (a cos(theta/2) + b sin(theta/2),  b cos(theta/2) + a sin(theta/2))
//! ```
//!
//! It is rotated about the held panel by the rotation that the panel would have in the symmetric deployment.

use crate::commands::init::edited::{heading, scale, set};
use anyhow::{Result, ensure};
use design::scene::rounded;
use std::path::Path;
use toml_edit::{Array, DocumentMut};

const SCENE: &str = include_str!("../../../configs/scenes/a4-polyester.toml");
/// Width and height of the shipped scene's sheet, its thickness, and the radius of its windows (mm).
const A4: [f64; 2] = [210.0, 297.0];
const THICKNESS: f64 = 0.1;
const R_WIN: f64 = 20.0;
/// Minimum side of a panel over the radius of a window: windows of neighbouring hinges do not overlap.
const PANEL: f64 = 3.5;
/// theta (rad): 25 degrees.
const OPENING: f64 = 0.436;
/// Widths of the clips at the top and at the bottom over those of their edges.
const HELD: f64 = 0.21;
const PULLED: f64 = 0.14;
/// Fewest panels along a side: below three, no panel has a neighbour on both sides.
const FEWEST: usize = 3;

pub(super) struct FirstScene {
    size: [f64; 2],
    panels: [usize; 2],
    thickness: f64,
}

impl FirstScene {
    /// The scene of a sheet of the given thickness and size (mm); an error if it is too thick for its size. Without a size
    /// it is of A4, or as much larger as it is thicker than the shipped sheet.
    pub(super) fn new(size: Option<[f64; 2]>, thickness: f64) -> Result<Self> {
        let larger = f64::max(thickness / THICKNESS, 1.0);
        let size = size.unwrap_or(A4.map(|side| rounded(larger * side)));
        let panel = PANEL * R_WIN * thickness / THICKNESS;
        let panels = size.map(|side| (side / panel) as usize);
        let least = FEWEST as f64;
        let thickest = size[0].min(size[1]) / least / PANEL / R_WIN * THICKNESS;
        ensure!(
            panels.iter().all(|&count| count >= FEWEST),
            "a sheet of {thickness} mm has panels of at least {panel:.0} mm, and needs {FEWEST} of them along each side: \
             use a larger sheet (--size) or a thinner one (--thickness, at most {:.2} mm for this size)",
            thickest
        );
        Ok(Self {
            size,
            panels,
            thickness,
        })
    }

    /// The scene file, in a folder with `material.toml`.
    pub(super) fn text(&self, weights: &Path) -> Result<String> {
        let factor = self.thickness / THICKNESS;
        let [columns, rows] = self.panels;
        let (held, pulled) = ([columns / 2, rows - 1], [columns / 2, 0]);
        let mut scene: DocumentMut = SCENE.parse()?;
        heading(
            &mut scene,
            "# A sheet whose middle panel at the bottom is moved away from that at the top, written by `kirigami init`.\n\
             # The panels are held flat, as between two clear plates that lie: a thin sheet that nothing holds leaves its plane\n\
             # and opens less. Friction on the plates is not modelled.\n\
             # Lengths in mm, forces in N, couples in N mm; paths are relative to this file.\n\n",
        );
        set(&mut scene["title"], "My first sheet");
        set(&mut scene["material"], "material.toml");
        set(&mut scene["thickness"], self.thickness);
        set(&mut scene["output"], "design");
        set(&mut scene["sheet"]["size"], Array::from_iter(self.size));
        set(&mut scene["sheet"]["panels"], whole(self.panels));
        for key in ["start", "range"] {
            scale(&mut scene["ligament"][key], factor);
        }
        scale(&mut scene["process"]["r_win"], factor);
        let surrogate = &mut scene["surrogate"];
        set(&mut surrogate["weights"], weights.display().to_string());
        if let Some(surrogate) = surrogate.as_table_mut() {
            surrogate.remove("ensemble");
        }
        // Clips as wide, relative to the edge that they hold, as those of the template.
        let edge = self.size[0] / self.panels[0] as f64;
        for (list, panel, part) in [("supports", held, HELD), ("loads", pulled, PULLED)] {
            let attached = &mut scene[list][0];
            set(&mut attached["panel"], whole(panel));
            set(&mut attached["clip"], rounded(part * edge));
        }
        let Target {
            centre,
            size,
            rotation_deg,
            stroke,
        } = self.target(held);
        set(&mut scene["drive"]["stroke"], rounded(stroke));
        let target = &mut scene["target"]["rectangle"];
        set(&mut target["centre"], Array::from_iter(centre.map(rounded)));
        set(&mut target["size"], Array::from_iter(size.map(rounded)));
        set(&mut target["rotation_deg"], rounded(rotation_deg));
        Ok(scene.to_string())
    }

    /// The rectangle of the sheet opened by [`OPENING`] with the panel `held` fixed, and the distance by which the
    /// middle of the lower edge of its column moves along it.
    fn target(&self, held: [usize; 2]) -> Target {
        let panel: [f64; 2] = std::array::from_fn(|i| self.size[i] / self.panels[i] as f64);
        let (sin, cos) = (0.5 * OPENING).sin_cos();
        let [a, b] = panel;
        let pitch = [a * cos + b * sin, b * cos + a * sin];
        // Even panels rotate by -theta/2, odd ones by theta/2; the held panel stays.
        let sign = if (held[0] + held[1]).is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
        let rotation = sign * 0.5 * OPENING;
        let fixed: [f64; 2] = std::array::from_fn(|i| (held[i] as f64 + 0.5) * panel[i]);
        // From the held panel to the middle of the sheet, before the rotation.
        let arm: [f64; 2] = std::array::from_fn(|i| {
            (0.5 * (self.panels[i] as f64 - 1.0) - held[i] as f64) * pitch[i]
        });
        let (sin, cos) = rotation.sin_cos();
        let steps = self.panels[1] - 1;
        let length = steps as f64;
        // An odd number of panels away, the pulled panel turns by the opening, and the middle of its lower edge with it.
        let turned = if steps % 2 == 1 { OPENING } else { 0.0 };
        let lifted = 0.5 * panel[1] * (1.0 - turned.cos());
        Target {
            centre: [
                fixed[0] + cos * arm[0] - sin * arm[1],
                fixed[1] + sin * arm[0] + cos * arm[1],
            ],
            size: std::array::from_fn(|i| self.panels[i] as f64 * pitch[i]),
            rotation_deg: rotation.to_degrees(),
            stroke: length * (pitch[1] * cos - panel[1]) - lifted,
        }
    }
}

struct Target {
    centre: [f64; 2],
    size: [f64; 2],
    rotation_deg: f64,
    stroke: f64,
}

fn whole(panel: [usize; 2]) -> Array {
    panel.into_iter().map(|index| index as i64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published rectangle of the sheet of section 4.3, opened by 25 degrees.
    #[test]
    fn the_target_is_the_opened_sheet() {
        let scene = FirstScene {
            size: [2438.4, 1219.2],
            panels: [3, 3],
            thickness: 0.5,
        };
        let target = scene.target([1, 1]);
        assert!((target.size[0] - 2644.5).abs() < 0.5, "{:?}", target.size);
        assert!((target.size[1] - 1718.1).abs() < 0.5, "{:?}", target.size);
        let middle = [1219.2, 609.6];
        assert!(std::iter::zip(target.centre, middle).all(|(x, y)| (x - y).abs() < 1e-9));
    }

    #[test]
    fn a_sheet_that_is_too_thick_is_refused_with_the_thickness_that_fits() {
        let message = FirstScene::new(Some(A4), 0.5).err().unwrap().to_string();
        assert!(message.contains("at most 0.10 mm"), "{message}");
        assert_eq!(FirstScene::new(Some(A4), 0.1).unwrap().panels, [3, 4]);
    }

    #[test]
    fn without_a_size_the_sheet_is_large_enough_for_its_thickness() {
        for (thickness, size) in [
            (0.05, A4),
            (0.1, A4),
            (0.5, [1050.0, 1485.0]),
            (1.5, [3150.0, 4455.0]),
        ] {
            let scene = FirstScene::new(None, thickness).unwrap();
            assert_eq!(scene.size, size);
            assert!(scene.panels.iter().all(|&count| count >= FEWEST));
        }
    }
}
