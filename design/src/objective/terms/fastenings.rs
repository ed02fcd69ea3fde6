//! Penalty on holes and clips without room: the sum over the clearances of all attachments of
//!
//! ```text
//! max(0, l/d - 1)^2,      l = 1.1 d_min
//! ```
//!
//! d is the distance of a hole or a clip from an edge of its panel or from a hinge, d_min the
//! smallest that can be made. The penalty grows without bound as d vanishes.

use crate::{
    objective::term::{Deployed, Term, TermGradient},
    sheet::cut_sheet::AttachmentPoint,
};

/// Distance from which on a clearance costs nothing, over the smallest one that can be made.
const MARGIN: f64 = 1.1;

/// The penalty on holes and clips without room.
#[derive(Debug)]
pub struct Fastenings {
    /// The points at which panels are held or pulled.
    pub attachments: Vec<AttachmentPoint>,
}

impl Term for Fastenings {
    fn name(&self) -> &'static str {
        "fastenings"
    }

    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64 {
        let mut value = 0.0;
        for attachment in &self.attachments {
            for clearance in attachment.clearances(at.sheet) {
                let wanted = MARGIN * clearance.least / clearance.distance;
                let lacking = f64::max(wanted - 1.0, 0.0);
                value += lacking * lacking;
                if lacking > 0.0 {
                    let slope = -2.0 * lacking * wanted / clearance.distance;
                    attachment.add_distance_gradient(
                        at.sheet,
                        clearance.obstacle,
                        weight * slope,
                        &mut gradient.by_sheet,
                    );
                }
            }
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::coordinates::PatternCoordinates;
    use crate::pattern::cut_pattern::{CutPattern, Outline};
    use crate::pattern::grid::Grid;
    use crate::sheet::cut_sheet::{HingePoint, PanelPoint, Sheet, SheetOptions};
    use crate::sheet::cutting_process::CuttingProcess;
    use hinge::HingeConstants;
    use testkit::derivatives::assert_gradient;

    const GRID: Grid = Grid { m: 3, n: 3 };

    /// A sheet of squares of 50 mm whose cut endpoints and widths are moved by `x`.
    fn sheet(x: &[f64]) -> Sheet {
        let outline = Outline::rectangle(150.0, 150.0);
        let coordinates = PatternCoordinates::uniform(GRID);
        let mut pattern = CutPattern::new(GRID, outline, &coordinates).unwrap();
        let count = pattern.points.len();
        for (point, moved) in pattern.points.iter_mut().zip(x.chunks(2)) {
            (0..2).for_each(|c| point[c] += moved[c]);
        }
        let options = SheetOptions {
            hinge_point: HingePoint::Corner,
            process: CuttingProcess { r_win: 12.0, ..HingeConstants::PAPER.into() },
        };
        let widths = x[2 * count..].iter().map(|w| 2.0 + w).collect::<Vec<f64>>();
        Sheet::new(&pattern, &widths, options).unwrap()
    }

    fn attachment(point: PanelPoint, hole: Option<f64>, clip: Option<f64>) -> AttachmentPoint {
        AttachmentPoint { panel: 1, point, hole, clip, ..AttachmentPoint::default() }
    }

    #[test]
    fn holes_and_clips_cost_where_they_lack_room_and_gradients_agree_with_differences() {
        let outline = Outline::rectangle(150.0, 150.0);
        let coordinates = PatternCoordinates::uniform(GRID);
        let points = CutPattern::new(GRID, outline, &coordinates).unwrap().points;
        let mut wave = (1..).map(|i: i32| f64::from(i * i).sin());
        let x: Vec<f64> = (0..2 * points.len() + GRID.hinge_count())
            .map(|_| 0.3 * wave.next().unwrap())
            .collect();
        let (edge, fixed) = (PanelPoint::Middle([0, 1]), PanelPoint::Fixed([70.0, 12.0]));
        let cases = [
            (attachment(PanelPoint::Centroid, Some(4.0), None), false),
            (attachment(PanelPoint::Centroid, Some(24.0), None), true),
            (attachment(fixed, Some(12.0), None), true),
            (attachment(edge, None, Some(10.0)), false),
            (attachment(edge, None, Some(48.0)), true),
        ];
        for (attachment, costs) in cases {
            let term = Fastenings { attachments: vec![attachment.clone()] };
            let all = |x: &[f64]| {
                let sheet = sheet(x);
                let at = Deployed { sheet: &sheet, path: &[], outline: &[] };
                let mut gradient = TermGradient::zeros(&at);
                let value = term.evaluate(&at, 1.0, &mut gradient);
                let (by_points, by_widths) = sheet.pullback(&gradient.by_sheet);
                let by_points = by_points.into_iter().flat_map(|it| [it.re, it.im]);
                (value, by_points.chain(by_widths).collect::<Vec<f64>>())
            };
            let (value, gradient) = all(&x);
            assert_eq!(value > 0.0, costs, "{attachment:?}: {value}");
            let allowed = |_| 1e-6 * value + 1e-9;
            assert_gradient(|x| all(x).0, &x, &gradient, 1e-6, allowed);
        }
    }
}
