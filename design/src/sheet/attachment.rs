//! The room that the hole or the clip at an attachment point needs.

use crate::{
    geometry::{
        plane::{I, complex, dot, point},
        polygon::{distance, edges, nearest_on_segment},
    },
    sheet::cut_sheet::{AttachmentPoint, PanelPoint, Sheet, SheetGradient},
};
use faer::c64;
use support::Point;

/// What a hole or a clip is measured to.
#[derive(Clone, Copy, Debug)]
pub enum Obstacle {
    /// Distance from the centre of a hole to the line between two corners of the panel.
    Edge([usize; 2]),
    /// Distance from the centre of a hole to the tip of a hinge.
    HoleToHinge(usize),
    /// Distance from a clip to the tip of a hinge.
    ClipToHinge(usize),
    /// Length of the edge on which a clip is.
    Ends([usize; 2]),
}

/// The room that a hole or a clip has at one obstacle.
#[derive(Clone, Copy, Debug)]
pub struct Clearance {
    /// What the distance is measured to.
    pub obstacle: Obstacle,
    /// The distance (mm).
    pub distance: f64,
    /// The smallest distance that can be made (mm).
    pub least: f64,
}

impl AttachmentPoint {
    /// All clearances of its hole and its clip. A hole leaves its radius of material to the edges
    /// of its panel; hole and clip leave the windows of the hinges of the panel free; a clip is no
    /// longer than its edge.
    pub fn clearances(&self, sheet: &Sheet) -> Vec<Clearance> {
        let panel = &sheet.panels[self.panel];
        let hinges = sheet.hinges.iter().enumerate();
        let hinges = hinges.filter(|(_, hinge)| hinge.panels().contains(&self.panel));
        let process = sheet.options.process;
        let (r_win, half_slit) = (process.r_win, 0.5 * process.slit_width);
        let mut clearances = Vec::new();
        let mut add = |obstacle, least| {
            clearances.push(Clearance {
                obstacle,
                distance: self.distance(sheet, obstacle),
                least,
            });
        };
        if let Some(diameter) = self.hole {
            for (i, _) in edges(&panel.corners).enumerate() {
                add(Obstacle::Edge([i, (i + 1) % 4]), diameter + half_slit);
            }
            for (h, _) in hinges.clone() {
                add(Obstacle::HoleToHinge(h), r_win + 0.5 * diameter);
            }
        }
        if let (Some(width), PanelPoint::Middle(ends)) = (self.clip, self.point) {
            add(Obstacle::Ends(ends), width);
            for (h, _) in hinges {
                add(Obstacle::ClipToHinge(h), r_win);
            }
        }
        clearances
    }

    /// The ends of its clip (mm).
    pub fn clip_ends(&self, sheet: &Sheet) -> Option<[Point; 2]> {
        let (Some(width), PanelPoint::Middle(ends)) = (self.clip, self.point) else {
            return None;
        };
        let [p, q] = ends.map(|corner| complex(sheet.panels[self.panel].corners[corner]));
        let (middle, half) = (0.5 * (p + q), (q - p) * (0.5 * width / (q - p).norm()));
        Some([point(middle - half), point(middle + half)])
    }

    fn distance(&self, sheet: &Sheet, obstacle: Obstacle) -> f64 {
        let [from, to] = self.nearest(sheet, obstacle);
        distance(from, to)
    }

    /// The two points between which the distance to an obstacle is measured (mm).
    fn nearest(&self, sheet: &Sheet, obstacle: Obstacle) -> [Point; 2] {
        let panel = &sheet.panels[self.panel];
        let centre = panel.position(self.point);
        match obstacle {
            Obstacle::Edge(ends) => {
                let [p, q] = ends.map(|corner| panel.corners[corner]);
                [centre, nearest_on_segment(centre, p, q)]
            }
            Obstacle::HoleToHinge(h) => [centre, sheet.hinges[h].tip],
            Obstacle::ClipToHinge(h) => {
                let tip = sheet.hinges[h].tip;
                let [p, q] = self.clip_ends(sheet).unwrap_or([centre; 2]);
                [nearest_on_segment(tip, p, q), tip]
            }
            Obstacle::Ends(ends) => ends.map(|corner| panel.corners[corner]),
        }
    }

    /// Adds the gradient of `weight` times the distance to an obstacle, which is positive. A
    /// nearest point stays where it is on its segment, along which the distance is stationary.
    pub(crate) fn add_distance_gradient(
        &self,
        sheet: &Sheet,
        obstacle: Obstacle,
        weight: f64,
        gradient: &mut SheetGradient,
    ) {
        let panel = &sheet.panels[self.panel];
        let [from, to] = self.nearest(sheet, obstacle).map(complex);
        let away = (from - to) * (weight / (from - to).norm());
        let mut by_corners = [c64::ZERO; 4];
        match obstacle {
            Obstacle::Edge([p, q]) => {
                by_corners = panel.pullback(self.point, away);
                let [start, end] = [p, q].map(|corner| complex(panel.corners[corner]));
                let along = dot(to - start, end - start) / (end - start).norm_sqr();
                by_corners[p] -= away * (1.0 - along);
                by_corners[q] -= away * along;
            }
            Obstacle::HoleToHinge(h) => {
                by_corners = panel.pullback(self.point, away);
                gradient.tips[h] -= away;
            }
            Obstacle::ClipToHinge(h) => {
                gradient.tips[h] -= away;
                if let PanelPoint::Middle([p, q]) = self.point {
                    // A point at a constant length from the middle of the edge, along its
                    // direction.
                    let [start, end] = [p, q].map(|corner| complex(panel.corners[corner]));
                    let edge = end - start;
                    let across = I * edge / edge.norm();
                    let from_middle = dot(from - 0.5 * (start + end), edge) / edge.norm();
                    let turning = across * (dot(away, across) * from_middle / edge.norm());
                    by_corners[p] += 0.5 * away - turning;
                    by_corners[q] += 0.5 * away + turning;
                }
            }
            Obstacle::Ends([p, q]) => {
                by_corners[p] += away;
                by_corners[q] -= away;
            }
        }
        for (sum, by_corner) in std::iter::zip(&mut gradient.corners[self.panel], by_corners) {
            *sum += by_corner;
        }
    }
}
