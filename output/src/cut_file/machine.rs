//! Machines and services: what their files hold, and what they can cut.

use crate::cut_file::{
    cut_drawing::{CutDrawing, Pen},
    cut_lines::CutLines,
    sheet_drawing::registration_marks,
};
use design::geometry::polygon::{bounds, distance_to_outline, size};
use serde::{Deserialize, Serialize};
use std::path::Path;
use support::{Extremes, Fault, ensure, refuse, toml_file};

/// The shipped table.
const SHIPPED: &str = include_str!("../../../configs/machines.toml");

/// A table of machines and services, `configs/machines.toml`.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machines {
    /// Machines, by what their files hold.
    #[serde(default)]
    pub machine: Vec<Machine>,
    /// Services, by what they can cut.
    #[serde(default)]
    pub service: Vec<Service>,
}

/// What the file for a machine holds.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// The name on the command line, which is also the name of the folder of its files.
    pub name: String,
    /// What it is, in a line.
    pub says: String,
    /// Whether it cuts nothing but lines: slits of one pass.
    #[serde(default)]
    lines: bool,
    /// Width that the tool removes and the paths allow for (mm); `None`: cutting.kerf of the scene.
    tool_kerf: Option<f64>,
    /// Length by which an open slit is cut beyond the outline (mm); `None`: the length of the
    /// scene.
    over_run: Option<f64>,
    /// Diameter of the smallest hole that the tool cuts (mm).
    #[serde(default)]
    least_hole: f64,
    /// Whether marks are drawn.
    marks: bool,
    /// The colours of cuts and of marks; `None`: each layer has its own.
    colours: Option<[Pen; 2]>,
}

/// What a service can cut; lengths in mm, those ending in `_t` in thicknesses.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Service {
    /// Its name.
    pub name: String,
    /// Where it says so.
    pub source: String,
    /// The machine whose files it takes.
    #[serde(default = "compensating")]
    pub machine: String,
    #[serde(default)]
    hole: f64,
    #[serde(default)]
    hole_t: f64,
    #[serde(default)]
    slot: f64,
    #[serde(default)]
    slot_t: f64,
    #[serde(default)]
    bridge: f64,
    #[serde(default)]
    bridge_t: f64,
    #[serde(default)]
    edge: f64,
    #[serde(default)]
    edge_t: f64,
    size: Option<[f64; 2]>,
}

/// Most services allow for their kerf themselves.
fn compensating() -> String {
    "laser-service".to_owned()
}

/// The smallest features of a sheet, and its size (mm).
#[derive(Clone, Copy, Debug, Serialize, derive_more::Display)]
#[display("smallest hole {hole:.2} mm, slits {slot:.2} mm, narrowest ligament next to its hole {bridge:.2} mm, hole to edge {edge:.2} mm; sheet {:.1} x {:.1} mm", size[0], size[1])]
pub struct Features {
    /// Diameter of the smallest hole.
    pub hole: f64,
    /// Width of the slits.
    pub slot: f64,
    /// The narrowest ligament next to its hole.
    pub bridge: f64,
    /// The least distance of a hole from the outline.
    pub edge: f64,
    /// Width and height of the sheet.
    pub size: [f64; 2],
}

impl Machines {
    /// The shipped machines and services.
    ///
    /// # Panics
    /// Never: a test reads the table.
    pub fn shipped() -> Self {
        let table = toml_file::parse(SHIPPED, Path::new("configs/machines.toml"));
        table.expect("the shipped table is valid")
    }
}

impl Service {
    /// The smallest features that it cuts in a sheet of the given thickness, and the size of its
    /// largest sheet (mm).
    pub fn limits(&self, thickness: f64) -> Features {
        let limit = |mm: f64, thicknesses: f64| mm.max(thicknesses * thickness);
        Features {
            hole: limit(self.hole, self.hole_t),
            slot: limit(self.slot, self.slot_t),
            bridge: limit(self.bridge, self.bridge_t),
            edge: limit(self.edge, self.edge_t),
            size: self.size.unwrap_or([f64::INFINITY; 2]),
        }
    }

    /// What it refuses of a sheet of the given thickness (mm), with both sizes and what to change.
    pub fn refusals(&self, features: &Features, thickness: f64) -> Vec<String> {
        let least = self.limits(thickness);
        let small = [
            (
                "holes of",
                features.hole,
                least.hole,
                "process.hole_diameter (or fillet_ratio), ligament.range",
            ),
            ("slits of", features.slot, least.slot, "process.slit_width"),
            ("ligaments of", features.bridge, least.bridge, "ligament.range"),
            ("holes to the edge of", features.edge, least.edge, "ligament.range"),
        ]
        .into_iter()
        .filter(|(_, found, least, _)| found < least)
        .map(|(what, found, least, keys)| {
            format!("{what} {found:.2} mm, at least {least:.2} mm ({keys})")
        });
        let large = (!fits(features.size, least.size)).then(|| {
            let ([width, height], [widest, highest]) = (features.size, least.size);
            format!("a sheet of {width:.0} x {height:.0} mm, at most {widest:.0} x {highest:.0} mm")
        });
        small.chain(large).collect()
    }
}

impl Machine {
    /// The drawing of a sheet for this machine, in cutting order; an error if the paths do not
    /// exist.
    pub fn drawing(&self, cuts: &CutLines) -> Result<CutDrawing, Fault> {
        let mut drawing = self.paths(cuts)?.in_cutting_order(cuts.outlines[0][0]);
        if self.marks {
            registration_marks(&mut drawing, self.over_run(cuts));
        }
        drawing.pens = self.colours;
        Ok(drawing)
    }

    /// The paths in a sheet and the marks on it, in the order of the pattern; an error if they do
    /// not exist.
    fn paths(&self, cuts: &CutLines) -> Result<CutDrawing, Fault> {
        let Some(kerf) = self.tool_kerf.or(cuts.cutting.kerf) else {
            refuse!(
                "the paths of this machine allow for the width that its tool removes, which is not known: set cutting.kerf (mm) in the \
                 scene"
            );
        };
        let lines = self.lines || cuts.is_one_pass(kerf);
        // Lines of no width are the middles of slits, for drawing programs.
        ensure!(
            !lines || kerf <= 0.0 || cuts.is_one_pass(kerf),
            "the slits are {} mm wide (process.slit_width), and the tool cuts lines of {kerf} mm: use a machine that cuts \
             around slits, or design slits as wide as the tool cuts (cutting.kerf)",
            cuts.slit_width
        );
        let mut cuts = cuts.clone();
        cuts.cutting.over_run = self.over_run(&cuts);
        Ok(cuts.paths(kerf, lines, self.least_hole, self.marks))
    }

    fn over_run(&self, cuts: &CutLines) -> f64 {
        self.over_run.unwrap_or(cuts.cutting.over_run)
    }
}

/// Whether a part with these sides fits on a place in either orientation.
pub(crate) fn fits(part: [f64; 2], place: [f64; 2]) -> bool {
    let ascending = |[a, b]: [f64; 2]| [a.min(b), a.max(b)];
    std::iter::zip(ascending(part), ascending(place)).all(|(part, place)| part <= place)
}

impl CutLines {
    /// The smallest features of the sheet.
    pub fn features(&self) -> Features {
        let least = |values: &mut dyn Iterator<Item = f64>| values.smallest();
        let to_edge = |centre: [f64; 2]| {
            let all = self.outlines.iter().map(|outline| distance_to_outline(centre, outline));
            all.smallest()
        };
        let attached = (self.attachments.iter())
            .filter_map(|attachment| Some((attachment.at, 0.5 * attachment.hole?)));
        let holes: Vec<([f64; 2], f64)> =
            (self.holes.iter()).map(|hole| (hole.centre, hole.radius)).chain(attached).collect();
        Features {
            hole: least(&mut holes.iter().map(|(_, radius)| 2.0 * radius)),
            slot: self.slit_width,
            bridge: least(&mut (0..self.holes.len()).map(|hinge| self.caliper(hinge))),
            edge: least(&mut holes.iter().map(|(centre, radius)| to_edge(*centre) - radius)),
            size: size(bounds(self.outlines.iter().flatten().copied())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_service_names_its_source_and_refuses_what_is_too_small() {
        let machines = Machines::shipped();
        assert!(machines.service.len() >= 5);
        let coarse =
            Features { hole: 10.0, slot: 10.0, bridge: 10.0, edge: 10.0, size: [100.0, 50.0] };
        let fine =
            Features { hole: 0.5, slot: 0.1, bridge: 0.4, edge: 0.4, size: [5000.0, 5000.0] };
        for service in &machines.service {
            assert!(service.source.contains('/'), "{}", service.name);
            assert_eq!(service.refusals(&coarse, 3.0), [""; 0]);
            assert!(!service.refusals(&fine, 3.0).is_empty(), "{}", service.name);
        }
        let whys = machines.service[0].refusals(&fine, 3.0);
        assert_eq!(whys.len(), 3, "{whys:?}");
        let narrow = "slits of 0.10 mm, at least 1.50 mm (process.slit_width)";
        assert!(whys[1].contains(narrow), "{whys:?}");
    }
}
