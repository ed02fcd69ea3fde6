//! Whether panels with arbitrary corners form one sheet: the three conditions of section 3.1.
//!
//! Every hinge joins its two panels, no two panels overlap, and the flat panels cover the sheet.
//! Areas are integrated along horizontal lines, which is valid for panels of any shape.

use design::geometry::plane::{complex, cross, dot};
use design::geometry::polygon::{area, edges};
use design::objective::design_problem::Deployment;
use design::objective::terms::panel_width::thinnest_panel;
use design::pattern::cut_pattern::Outline;
use design::pattern::grid::Grid;
use design::scene::Scene;
use design::scene::placement::placed;
use design::sheet::kinematics::deployed_corners;
use design::sheet::topology::hinge_sites;

/// Number of lines over the height of the panels; the relative error of the areas is about 1e-5.
const LINES: usize = 4000;

/// Panels by their corners, flat and deployed (mm).
#[derive(Clone, Debug, PartialEq)]
pub struct Tessellation {
    pub grid: Grid,
    pub outline: Outline,
    pub flat: Vec<[[f64; 2]; 4]>,
    pub deployed: Vec<[[f64; 2]; 4]>,
}

/// Deviations from the three conditions; zero if they hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Defects {
    /// Maximum distance of two corners that a hinge joins, relative to the sheet's side, flat and deployed.
    pub gap: [f64; 2],
    /// Area that is covered twice or more, relative to the sheet's, flat and deployed.
    pub overlap: [f64; 2],
    /// Area of the flat sheet that no panel covers, relative to the sheet's.
    pub void: f64,
    /// Area outside the flat sheet that panels cover, relative to the sheet's.
    pub outside: f64,
}

/// Shape measures of the worst panels of a flat sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstPanels {
    /// Minimum angle at a corner (deg).
    pub sharpest_deg: f64,
    /// Minimum distance of a corner from an edge of its panel that does not end at it (mm).
    pub thinnest: f64,
    /// Minimum area, relative to the mean.
    pub least: f64,
}

impl Tessellation {
    /// The tessellation of a sheet, deployed in the position in which the objective compares it with the target.
    pub fn from_deployment(scene: &Scene, deployment: &Deployment) -> Self {
        let sheet = &deployment.sheet;
        let configuration = placed(scene, sheet, &deployment.final_step().configuration);
        Self {
            grid: sheet.grid,
            outline: sheet.outline,
            flat: sheet.panels.iter().map(|panel| panel.corners).collect(),
            deployed: deployed_corners(sheet, &configuration),
        }
    }

    pub fn defects(&self) -> Defects {
        let sheet = self.outline.area();
        let [flat_overlap, void, outside] = self.areas(&self.flat);
        let [deployed_overlap, ..] = self.areas(&self.deployed);
        Defects {
            gap: [&self.flat, &self.deployed].map(|panels| self.gap(panels) / sheet.sqrt()),
            overlap: [flat_overlap / sheet, deployed_overlap / sheet],
            void: void / sheet,
            outside: outside / sheet,
        }
    }

    /// The defects with the maxima over further deployed states in the place of those of the deployed state.
    pub fn defects_in(&self, states: impl Iterator<Item = Vec<[[f64; 2]; 4]>>) -> Defects {
        let (mut worst, sheet) = (self.defects(), self.outline.area());
        for panels in states {
            let [overlap, ..] = self.areas(&panels);
            worst.gap[1] = f64::max(worst.gap[1], self.gap(&panels) / sheet.sqrt());
            worst.overlap[1] = f64::max(worst.overlap[1], overlap / sheet);
        }
        worst
    }

    pub fn worst_panels(&self) -> WorstPanels {
        let mean = self.outline.area() / self.flat.len() as f64;
        let mut worst = WorstPanels {
            sharpest_deg: f64::INFINITY,
            thinnest: thinnest_panel(&self.flat),
            least: f64::INFINITY,
        };
        for panel in &self.flat {
            for j in 0..4 {
                let [before, corner, after] = [j, j + 1, j + 2].map(|j| complex(panel[j % 4]));
                let (back, ahead) = (before - corner, after - corner);
                let angle = cross(ahead, back).atan2(dot(ahead, back));
                worst.sharpest_deg = worst.sharpest_deg.min(angle.to_degrees());
            }
            worst.least = worst.least.min(area(panel) / mean);
        }
        worst
    }

    fn gap(&self, panels: &[[[f64; 2]; 4]]) -> f64 {
        let gaps = hinge_sites(self.grid).into_iter().map(|site| {
            let [p, q] = [site.a, site.b].map(|(panel, corner)| panels[panel][corner]);
            f64::hypot(p[0] - q[0], p[1] - q[1])
        });
        gaps.fold(0.0, f64::max)
    }

    /// Area covered twice or more, area of the sheet that is not covered, and covered area outside it (mm^2).
    fn areas(&self, panels: &[[[f64; 2]; 4]]) -> [f64; 3] {
        let corners = || panels.iter().flatten().chain(&self.outline.corners);
        let low = corners().map(|p| p[1]).fold(f64::INFINITY, f64::min);
        let high = corners().map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max);
        let spacing = (high - low) / LINES as f64;
        let mut areas = [0.0; 3];
        for i in 0..LINES {
            let y = low + spacing * (i as f64 + 0.5);
            let mut covered: Vec<[f64; 2]> = (panels.iter())
                .flat_map(|panel| crossings(panel, y))
                .collect();
            covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let sheet = crossings(&self.outline.corners, y);
            let inside = once(&covered, &sheet);
            let all = once(&covered, &[[f64::NEG_INFINITY, f64::INFINITY]]);
            let lengths = [twice(&covered), length(&sheet) - inside, all - inside];
            for (area, length) in std::iter::zip(&mut areas, lengths) {
                *area += spacing * length;
            }
        }
        areas
    }
}

/// The intervals of a horizontal line inside a polygon (even-odd rule).
fn crossings(polygon: &[[f64; 2]], y: f64) -> Vec<[f64; 2]> {
    let mut xs: Vec<f64> = edges(polygon)
        .filter(|(p, q)| (p[1] <= y) != (q[1] <= y))
        .map(|(p, q)| p[0] + (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1]))
        .collect();
    xs.sort_by(f64::total_cmp);
    xs.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Sum of the lengths of intervals [from, to].
fn length(intervals: &[[f64; 2]]) -> f64 {
    intervals.iter().map(|[from, to]| to - from).sum()
}

/// Length covered by two or more intervals, which must be sorted by their starts.
fn twice(sorted: &[[f64; 2]]) -> f64 {
    let (mut reached, mut reached_twice, mut twice) = (f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0);
    for [from, to] in sorted {
        let shared = reached.min(*to);
        twice += (shared - from.max(reached_twice)).max(0.0);
        reached_twice = f64::max(reached_twice, shared);
        reached = reached.max(*to);
    }
    twice
}

/// Length of `within` that the sorted intervals cover.
fn once(sorted: &[[f64; 2]], within: &[[f64; 2]]) -> f64 {
    let mut once = 0.0;
    for [low, high] in within {
        let mut reached = *low;
        for [from, to] in sorted {
            once += (to.min(*high) - from.max(reached)).max(0.0);
            reached = reached.max(*to);
        }
    }
    once
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_covered_three_times_counts_once() {
        assert_eq!(twice(&[[0.0, 1.0], [0.0, 1.0], [0.0, 1.0]]), 1.0);
        assert_eq!(twice(&[[0.0, 2.0], [0.5, 1.0], [0.8, 3.0]]), 1.5);
        assert_eq!(twice(&[[0.0, 1.0], [1.0, 2.0]]), 0.0);
    }

    #[test]
    fn shifted_panels_have_gaps_overlaps_and_voids() {
        let square = |x: f64, y: f64| [[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
        let tiles = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let flat: Vec<_> = tiles.iter().map(|&[x, y]| square(x, y)).collect();
        let mut moved = flat.clone();
        moved[3] = square(0.8, 1.0);
        let mut tessellation = Tessellation {
            grid: Grid { m: 2, n: 2 },
            outline: Outline::rectangle(2.0, 2.0),
            deployed: flat.clone(),
            flat,
        };
        let whole = tessellation.defects();
        let squares = WorstPanels {
            sharpest_deg: 90.0,
            thinnest: 1.0,
            least: 1.0,
        };
        assert_eq!(tessellation.worst_panels(), squares);
        assert_eq!(
            (whole.gap, whole.overlap, whole.void, whole.outside),
            ([0.0; 2], [0.0; 2], 0.0, 0.0)
        );
        tessellation.flat = moved;
        let defects = tessellation.defects();
        assert!((defects.gap[0] - 0.1).abs() < 1e-12 && defects.gap[1] == 0.0);
        assert!((defects.overlap[0] - 0.05).abs() < 1e-12 && defects.overlap[1] == 0.0);
        assert!((defects.void - 0.05).abs() < 1e-12 && defects.outside == 0.0);
        tessellation.flat[3] = square(1.0, 1.2);
        let defects = tessellation.defects();
        assert!((defects.outside - 0.05).abs() < 1e-3, "{defects:?}");
    }
}
