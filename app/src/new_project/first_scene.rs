//! The first scene of a project: a sheet whose middle panel at the bottom is moved away from that
//! at the top.
//!
//! A shipped A4 scene, of a film or of a plate, with lengths in proportion to the thickness and as
//! many panels as fit. The target is the rectangle that the uniform sheet of rigid panels a x b
//! fills when every hinge opens by theta; (6):
//!
//! ```text
//! pitch = (a cos(theta/2) + b sin(theta/2),  b cos(theta/2) + a sin(theta/2))
//! ```
//!
//! It is rotated about the held panel by the rotation that the panel would have in the symmetric
//! deployment.

use crate::{
    new_project::{
        cut_from::CutFrom,
        edited::{heading, map, scale, set},
        template::Template,
    },
    own_drawing::OwnDrawing,
};
use analysis::fit::scene::SIDE;
use anyhow::{Context, Result};
use hinge::{MIN_W_LIG, Regime};
use scene::{CuttingConfig, Paper, rounded};
use std::{array::from_fn, path::Path};
use support::{Point, relative_path};
use toml_edit::{Array, DocumentMut, Item, Table, value};

/// Minimum side of a panel over the radius of a window: windows of neighbouring hinges do not
/// overlap.
pub const PANEL: f64 = 3.5;
/// The largest opening of a hinge that is planned for a first sheet (rad): 25 degrees.
pub const OPENING: f64 = 0.436;
/// Widths of the clips at the top and at the bottom over the widths of their edges.
const HELD: f64 = 0.21;
const PULLED: f64 = 0.14;
/// Name of the law of released hinges in the folder of weights.
const SPRINGBACK: &str = "springback.json";
/// The network of drafts that stands next to weights.
const DRAFT: &str = "small.safetensors";
/// Kerf of the shipped plate, which is as wide as the kerf of the shipped film or wider (mm).
const WIDEST_KERF: f64 = 0.2;
/// Widest ligament of a plate that nothing holds flat, over its thickness: with 0.93, plates of
/// PETG and aluminium leave their plane (docs/results/flatness).
const WIDEST_OF_PLATE: f64 = 0.7;
/// Weight of the damage times the damage term of ligaments that turn freely by the planned opening,
/// as in the shipped plate. The scale of the term is of the database, so that one weight would be
/// too large for one material and too small for another.
const DAMAGE_OF_PLATE: f64 = 0.0155;
/// Fewest panels along a side: below three, no panel has a neighbour on both sides.
const FEWEST: usize = 3;
/// Fewest panels along a side of an even pattern, whose panels are equal: a loop of four.
const FEWEST_EVEN: usize = 2;

pub(super) struct FirstScene {
    pub(super) regime: Regime,
    size: [f64; 2],
    panels: [usize; 2],
    thickness: f64,
    cut_from: Option<CutFrom>,
    /// theta of the target (rad).
    pub(super) opening: f64,
    /// Whether the ligaments of a plate may be wider than stays flat by itself.
    pub(super) any_width: bool,
    /// The damage term of ligaments opened so, if there are weights.
    pub(super) damage: Option<f64>,
}

impl FirstScene {
    /// The scene of a sheet of the given thickness and size (mm), or of the largest one that is cut
    /// from a stock. Without either it has the size of A4, or is as much larger as it is thicker
    /// than the shipped sheet. A sheet is a film if it is large enough for its thickness, and else
    /// a plate; an error if it is too thin for that. `trained` is the regime of the weights that
    /// are named, if there are any. An even pattern, which is laid over a drawing later, needs fewer
    /// and smaller panels.
    pub(super) fn new(
        size: Option<[f64; 2]>,
        cut_from: Option<CutFrom>,
        thickness: f64,
        trained: Option<Regime>,
        is_even: bool,
    ) -> Result<Self> {
        let CuttingConfig { over_run, .. } = CuttingConfig::default();
        let largest = cut_from.map(|stock| stock.largest_sheet(over_run, WIDEST_KERF));
        let size = size.or(largest.transpose()?);
        let plate = Regime::usual(thickness) == Regime::Plate;
        let regime = match (trained, size) {
            (Some(trained), _) => trained,
            (None, None) if plate => Regime::Plate,
            (None, Some(size))
                if plate && panels_of(size, thickness, Regime::Film, (FEWEST, PANEL)).is_none() =>
            {
                Regime::Plate
            }
            (None, _) => Regime::Film,
        };
        let template = Template::of(regime);
        let larger = f64::max(thickness / template.thickness, 1.0);
        let size = size.unwrap_or(Paper::A4.size().map(|side| rounded(larger * side)));
        let (fewest, side) = if is_even { (FEWEST_EVEN, SIDE) } else { (FEWEST, PANEL) };
        let panels = panels_of(size, thickness, regime, (fewest, side)).with_context(|| {
            let per_thickness = side * template.r_win / template.thickness;
            let thickest = size[0].min(size[1]) / fewest as f64 / per_thickness;
            let or_thicker = if regime == Regime::Film {
                format!(", or a plate from {} mm on", Regime::THINNEST_PLATE)
            } else {
                String::new()
            };
            format!(
                "a sheet of {thickness} mm with {regime} ligaments has panels of at least {:.0} mm, and needs {fewest} of them along each \
                 side: use a larger sheet (--size, --stock) or a thinner one (--thickness, at most {thickest:.2} mm for this \
                 size){or_thicker}",
                per_thickness * thickness
            )
        })?;
        Ok(Self {
            regime,
            size,
            panels,
            thickness,
            cut_from,
            opening: OPENING,
            any_width: false,
            damage: None,
        })
    }

    /// The scene file in a folder with `material.toml`; with the outline of a drawing as its target
    /// if there is one.
    pub(super) fn text(
        &self,
        folder: &Path,
        weights: &Path,
        drawing: Option<&OwnDrawing>,
    ) -> Result<String> {
        let template = Template::of(self.regime);
        let factor = self.thickness / template.thickness;
        let [columns, rows] = self.panels;
        let (held, pulled) = ([columns / 2, rows - 1], [columns / 2, 0]);
        let mut scene: DocumentMut = template.scene.parse()?;
        heading(
            &mut scene,
            &format!(
                "# A sheet whose middle panel at the bottom is moved away from that at the top, written by `kirigami init`.\n{}\
                 # Lengths in mm, forces in N, couples in N mm; paths are relative to this file.\n\n",
                template.description
            ),
        );
        set(&mut scene["title"], "My first sheet");
        set(&mut scene["material"], "material.toml");
        set(&mut scene["thickness"], self.thickness);
        set(&mut scene["output"], "design");
        set(&mut scene["sheet"]["size"], Array::from_iter(self.size));
        set(&mut scene["sheet"]["panels"], whole(self.panels));
        if let Some(cut_from) = self.cut_from {
            cut_from.write(&mut scene["cutting"]);
        }
        for key in ["start", "range"] {
            map(&mut scene["ligament"][key], |width| rounded(factor * width).max(MIN_W_LIG));
        }
        scale(&mut scene["process"]["r_win"], factor);
        name_weights(&mut scene["surrogate"], weights, folder)?;
        // Clips as wide, relative to the edge that they hold, as the clips of the template.
        let edge = self.size[0] / self.panels[0] as f64;
        for (list, panel, part) in [("supports", held, HELD), ("loads", pulled, PULLED)] {
            let attached = &mut scene[list][0];
            set(&mut attached["panel"], whole(panel));
            set(&mut attached["clip"], rounded(part * edge));
        }
        let OpenedSheet { centre, size, rotation_deg, pull, stroke } = self.target(held);
        set(&mut scene["drive"]["stroke"], rounded(stroke));
        set(&mut scene["loads"][0]["force"], Array::from_iter(pull));
        if self.regime == Regime::Plate {
            set(&mut scene["posture"]["down"], Array::from_iter(pull));
        }
        if let Some(drawing) = drawing {
            scene["target"] = placed(drawing, centre, size[0] * size[1])?;
            return Ok(scene.to_string());
        }
        if let Some(range) = scene["ligament"]["range"].as_array_mut()
            && self.regime == Regime::Plate
            && !self.any_width
        {
            range.replace(1, rounded(WIDEST_OF_PLATE * self.thickness));
            if let Some(damage) = self.damage {
                let weight = (1e4 * DAMAGE_OF_PLATE / damage).round() / 1e4;
                set(&mut scene["objective"]["damage"], weight);
            }
        }
        let target = &mut scene["target"]["rectangle"];
        set(&mut target["centre"], Array::from_iter(centre.map(rounded)));
        set(&mut target["size"], Array::from_iter(size.map(rounded)));
        set(&mut target["rotation_deg"], rounded(rotation_deg));
        Ok(scene.to_string())
    }

    /// The rectangle of the sheet opened by its opening with the panel `held` fixed, and the pull at
    /// the middle of the lower edge of its column.
    fn target(&self, held: [usize; 2]) -> OpenedSheet {
        let panel: [f64; 2] = from_fn(|i| self.size[i] / self.panels[i] as f64);
        let (sin, cos) = (0.5 * self.opening).sin_cos();
        let [a, b] = panel;
        let pitch = [a * cos + b * sin, b * cos + a * sin];
        // Even panels rotate by -theta/2, odd ones by theta/2; the held panel stays.
        let sign = if (held[0] + held[1]).is_multiple_of(2) { 1.0 } else { -1.0 };
        let rotation = sign * 0.5 * self.opening;
        let fixed: [f64; 2] = from_fn(|i| (held[i] as f64 + 0.5) * panel[i]);
        // From the held panel to the middle of the sheet, before the rotation.
        let arm: [f64; 2] =
            from_fn(|i| (0.5 * (self.panels[i] as f64 - 1.0) - held[i] as f64) * pitch[i]);
        let (sin, cos) = rotation.sin_cos();
        let steps = self.panels[1] - 1;
        // An odd number of panels away, the pulled panel turns by the opening, and the middle of
        // its lower edge with it.
        let turned = if steps % 2 == 1 { sign * self.opening } else { 0.0 };
        let (turned_sin, turned_cos) = turned.sin_cos();
        let (down, half) = (steps as f64 * pitch[1], 0.5 * panel[1]);
        // From the middle of the held panel to the pulled point, in the opened and in the flat
        // sheet.
        let opened = [sin * down + turned_sin * half, -cos * down - turned_cos * half];
        let flat = -(steps as f64) * panel[1] - half;
        // A film is pulled along its edge; a plate hangs in the line of its clips, so that the
        // upper one carries no moment.
        let pull = match self.regime {
            Regime::Film => [0.0, -1.0],
            Regime::Plate => {
                let [x, y] = [opened[0], opened[1] - half];
                [x, y].map(|part| rounded(part / x.hypot(y)))
            }
        };
        OpenedSheet {
            centre: [
                fixed[0] + cos * arm[0] - sin * arm[1],
                fixed[1] + sin * arm[0] + cos * arm[1],
            ],
            size: from_fn(|i| self.panels[i] as f64 * pitch[i]),
            rotation_deg: rotation.to_degrees(),
            pull,
            stroke: opened[0] * pull[0] + (opened[1] - flat) * pull[1],
        }
    }
}

/// Names weights, and what stands next to them, in the table `[surrogate]` of a scene in `folder`.
fn name_weights(surrogate: &mut Item, weights: &Path, folder: &Path) -> Result<()> {
    // A folder elsewhere may be moved without the files of the program.
    let is_here = std::path::absolute(folder)?.starts_with(std::env::current_dir()?);
    let named = |file: &Path| -> Result<String> {
        let named = match is_here || file.starts_with(folder) {
            true => relative_path::from_folder(folder, file)?,
            false => std::path::absolute(file)?,
        };
        Ok(named.display().to_string())
    };
    set(&mut surrogate["weights"], named(weights)?);
    let Some(surrogate) = surrogate.as_table_mut() else { return Ok(()) };
    surrogate.remove("ensemble");
    // The law of released hinges and the smaller network stand next to the weights of their material.
    for (key, name) in [("springback", SPRINGBACK), ("draft", DRAFT)] {
        match weights.with_file_name(name) {
            file if file.is_file() => set(&mut surrogate[key], named(&file)?),
            _ => _ = surrogate.remove(key),
        }
    }
    Ok(())
}

/// The table `[target]` of a drawing, centred at `centre` (mm) and the given area (mm^2).
fn placed(drawing: &OwnDrawing, centre: Point, area: f64) -> Result<Item> {
    let (centre, height) = drawing.placed(centre, area)?;
    let mut svg = Table::new();
    svg["file"] = value(drawing.name("").display().to_string());
    svg["centre"] = value(Array::from_iter(centre));
    svg["height"] = value(height);
    svg.decor_mut().set_prefix(
        "\n# A drawing, with the area of the opened sheet: move it by `centre` and scale it by `height` (mm).\n",
    );
    let mut target = Table::new();
    target.set_implicit(true);
    target["svg"] = Item::Table(svg);
    Ok(Item::Table(target))
}

/// The panels along each side: of the usual size if the fewest fit, else as few; `None` if these are
/// smaller than `side`, over the radius of a window.
fn panels_of(
    size: [f64; 2],
    thickness: f64,
    regime: Regime,
    (fewest, side): (usize, f64),
) -> Option<[usize; 2]> {
    let template = Template::of(regime);
    let r_win = template.r_win * thickness / template.thickness;
    let along = |length: f64| ((length / (template.panel * r_win)) as usize).max(fewest);
    let panels = size.map(along);
    let fits = |(length, count): (f64, usize)| length >= side * r_win * count as f64;
    std::iter::zip(size, panels).all(fits).then_some(panels)
}

/// The opened sheet.
struct OpenedSheet {
    centre: Point,
    size: [f64; 2],
    rotation_deg: f64,
    /// Direction in which it is pulled open.
    pull: [f64; 2],
    /// Displacement of the pulled point in this direction (mm).
    stroke: f64,
}

fn whole(panel: [usize; 2]) -> Array {
    panel.into_iter().map(|index| index as i64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use analysis::fit::opening::safe_opening;
    use surrogate::Surrogate;

    /// The published rectangle of the sheet of section 4.3, opened by 25 degrees.
    #[test]
    fn the_target_is_the_opened_sheet() {
        let scene = FirstScene {
            size: [2438.4, 1219.2],
            panels: [3, 3],
            thickness: 0.5,
            cut_from: None,
            regime: Regime::Film,
            opening: OPENING,
            any_width: false,
            damage: None,
        };
        let target = scene.target([1, 1]);
        assert!((target.size[0] - 2644.5).abs() < 0.5, "{:?}", target.size);
        assert!((target.size[1] - 1718.1).abs() < 0.5, "{:?}", target.size);
        let middle = [1219.2, 609.6];
        assert!(std::iter::zip(target.centre, middle).all(|(x, y)| (x - y).abs() < 1e-9));
    }

    /// Polypropylene, PETG and steel bear the usual opening; aluminium tears at 24 to 28 degrees.
    #[test]
    fn a_material_that_tears_early_opens_less() {
        for (material, degrees) in [
            ("polypropylene-3mm", 25.0),
            ("petg-3mm", 25.0),
            ("aluminium-2mm", 20.0),
            ("s235-2mm", 25.0),
        ] {
            let root = Path::new(env!("CARGO_MANIFEST_DIR"));
            let weights = root.join("../data").join(material).join("medium.safetensors");
            let weights = Surrogate::load(&weights).unwrap();
            let w_lig = 0.5 * weights.domain().w_lig.iter().sum::<f64>();
            let angles = [weights.domain().alpha[0], std::f64::consts::FRAC_PI_2];
            let opening = safe_opening(&weights, w_lig, &angles, OPENING);
            assert!((opening.to_degrees() - degrees).abs() < 0.1, "{material}: {opening}");
        }
    }

    /// The shipped A4 plate and film are their own projects.
    #[test]
    fn the_stroke_is_along_the_pull() {
        let strokes = [(0.1, 30.4), (3.0, 45.4)].map(|(thickness, shipped)| {
            let scene =
                FirstScene::new(Some(Paper::A4.size()), None, thickness, None, false).unwrap();
            let text = scene.text(Path::new("."), Path::new("weights.safetensors"), None).unwrap();
            let text: DocumentMut = text.parse().unwrap();
            let stroke = text["drive"]["stroke"].as_float().unwrap();
            assert!((stroke - shipped).abs() < 0.1, "{stroke}");
            text["loads"][0]["force"].to_string()
        });
        assert!(strokes[0].contains("[0.0, -1.0]"), "{strokes:?}");
        assert!(strokes[1].contains("[0.216") && strokes[1].contains("-0.976"), "{strokes:?}");
    }

    #[test]
    fn a_sheet_too_thick_for_a_film_and_too_thin_for_a_plate_is_refused() {
        let a4 = Some(Paper::A4.size());
        let first = |size, thickness| FirstScene::new(size, None, thickness, None, false);
        let message = first(a4, 0.5).err().unwrap().to_string();
        assert!(message.contains("at most 0.10 mm"), "{message}");
        let film = first(a4, 0.1).unwrap();
        assert_eq!((film.panels, film.regime), ([3, 4], Regime::Film));
        let plate = first(a4, 3.0).unwrap();
        assert_eq!((plate.panels, plate.regime), ([3, 4], Regime::Plate));
        let message = first(a4, 8.0).err().unwrap().to_string();
        assert!(message.contains("at most 5.00 mm"), "{message}");
        // An even pattern needs two panels of nine thicknesses.
        let small = Some([60.0, 40.0]);
        let even = FirstScene::new(small, None, 2.0, None, true).unwrap();
        assert_eq!((even.panels, even.regime), ([2, 2], Regime::Plate));
        assert!(first(small, 2.0).is_err());
        // Large enough for the ligaments of a film, and with weights of one regime.
        let large = first(Some([4400.0, 6300.0]), 2.0).unwrap();
        assert_eq!(large.regime, Regime::Film);
        let trained = FirstScene::new(None, None, 1.5, Some(Regime::Film), false).unwrap();
        assert_eq!(trained.size, [3150.0, 4455.0]);
    }

    #[test]
    fn without_a_size_the_sheet_is_large_enough_for_its_thickness() {
        let a4 = Paper::A4.size();
        for (thickness, size) in
            [(0.05, a4), (0.1, a4), (0.5, [1050.0, 1485.0]), (2.0, a4), (6.0, [420.0, 594.0])]
        {
            let scene = FirstScene::new(None, None, thickness, None, false).unwrap();
            assert_eq!(scene.size, size);
            assert!(scene.panels.iter().all(|&count| count >= FEWEST));
        }
    }
}
