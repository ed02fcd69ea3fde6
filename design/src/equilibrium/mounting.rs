//! A sheet that is mounted: fasteners are put in one after the other, each when its hole was pulled
//! to its place.
//!
//! The hole of the first fastener lies on its place, and the flat sheet is turned so that the
//! second hole lies in the direction of its own. Then one hole after the other is pulled straight to
//! its place, while the holes before it stay on theirs and the others are free.

use crate::{
    equilibrium::{
        hinged_sheet::HingedSheet,
        load_step::{LoadStep, Status},
        solver::EquilibriumSolver,
        supports::{Dof, Support},
    },
    geometry::plane::{complex, point, turn_less_one},
    sheet::kinematics::{Configuration, Motion},
};
use support::{Fault, refuse};

/// Number of load steps on the way of a hole.
const STEPS: usize = 4;

/// A fastener that is put in.
#[derive(Clone, Debug)]
pub struct MountingStep {
    /// Index of its panel.
    pub panel: usize,
    /// Length of the way of its hole to its place (mm); zero for the first one.
    pub way: f64,
    /// Largest force of the hand on the way (N).
    pub force: f64,
    /// The equilibria on the way; none for the first one. It ends early if no equilibrium is
    /// found.
    pub path: Vec<LoadStep>,
    /// The sheet when it is put in.
    pub end: Configuration,
}

impl EquilibriumSolver {
    /// The panels with a fastener, in the order of the supports: supports of both translations, some
    /// of which move, open the sheet. Empty if a support holds only one translation, and if a load
    /// or a weight acts on the sheet.
    pub fn fastened(&self) -> Vec<usize> {
        let translations = self.supports.iter().filter(|support| support.dof != Dof::Phi);
        let mut panels: Vec<usize> = translations.map(|support| support.panel).collect();
        let count = panels.len();
        panels.dedup();
        let mut acting = self.loads.as_flattened().iter().chain(&self.weight);
        let moves = self.supports.iter().any(|support| support.value != 0.0);
        let only_fasteners = count == 2 * panels.len() && acting.all(|load| *load == 0.0);
        if moves && only_fasteners && panels.len() > 1 { panels } else { Vec::new() }
    }

    /// The fasteners in their order, up to the first whose hole does not reach its place; the sheet
    /// begins in the configuration in which it rests. An error if there are none.
    pub fn mounted(
        &self,
        sheet: HingedSheet,
        resting: &[Motion],
    ) -> Result<Vec<MountingStep>, Fault> {
        let panels = self.fastened();
        let [first, second, ..] = panels[..] else {
            refuse!("the sheet has no fasteners that open it");
        };
        let flat = self.laid(sheet, resting, [first, second]);
        let mut steps = vec![MountingStep {
            panel: first,
            way: 0.0,
            force: 0.0,
            path: Vec::new(),
            end: flat.clone(),
        }];
        let mut start = flat;
        for count in 1..panels.len() {
            let step = self.pulled(sheet, start, &panels[..=count])?;
            start = step.end.clone();
            let last = step.path.last().map(|last| last.status);
            steps.push(step);
            if last == Some(Status::Diverged) {
                break;
            }
        }
        Ok(steps)
    }

    /// The resting sheet with the hole of a panel on its place, turned so that the hole of another
    /// lies in the direction of its own.
    fn laid(
        &self,
        sheet: HingedSheet,
        resting: &[Motion],
        [first, second]: [usize; 2],
    ) -> Configuration {
        let panels = &sheet.sheet.panels;
        let motions = self.support_motions();
        let at =
            |panel: usize, [x, y, _]: Motion| complex(panels[panel].reference) + complex([x, y]);
        let from = at(first, resting[first]);
        let [place, other] = [first, second].map(|panel| at(panel, motions[panel]));
        let angle = ((other - place) / (at(second, resting[second]) - from)).arg();
        let moved = |(panel, motion): (usize, &Motion)| {
            let [x, y, phi] = *motion;
            let turned = turn_less_one(angle) * (at(panel, *motion) - from);
            let [x, y] = point(complex([x, y]) + place - from + turned);
            [x, y, phi + angle]
        };
        resting.iter().enumerate().map(moved).collect()
    }

    /// Pulls the hole of the last of some panels to its place; the others are on theirs.
    fn pulled(
        &self,
        sheet: HingedSheet,
        start: Configuration,
        panels: &[usize],
    ) -> Result<MountingStep, Fault> {
        let panel = panels[panels.len() - 1];
        let held = self.supports.iter().filter(|support| panels.contains(&support.panel));
        let left = |it: &Support| it.value - start[it.panel][it.dof.index()];
        let supports: Vec<Support> = held.map(|it| Support { value: left(it), ..*it }).collect();
        let pulling = Self {
            attachment_points: self.attachment_points.clone(),
            stop: self.stop.clone(),
            ..Self::new(self.topology.clone(), &supports, &[], STEPS, self.settings)?
        };
        let [x, y, _] = pulling.support_motions()[panel];
        let path = pulling.path_from(sheet, start.clone());
        let force = |step: &LoadStep| {
            let [x, y, _] = pulling.reactions(sheet, &step.configuration)[panel];
            x.hypot(y)
        };
        Ok(MountingStep {
            panel,
            way: x.hypot(y),
            force: path.iter().map(force).fold(0.0, f64::max),
            end: path.last().map_or(start, |last| last.configuration.clone()),
            path,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::settings::SolverSettings;
    use crate::hinge_law::{HingeLaw, LinearLaw};
    use crate::pattern::coordinates::PatternCoordinates;
    use crate::pattern::cut_pattern::{CutPattern, Outline};
    use crate::pattern::grid::Grid;
    use crate::sheet::cut_sheet::{AttachmentPoint, HingePoint, PanelPoint, Sheet, SheetOptions};
    use crate::sheet::ideal_deployment::ideal_deployment;
    use crate::sheet::kinematics::deployed;
    use hinge::HingeConstants;

    const GRID: Grid = Grid { m: 3, n: 3 };

    /// A sheet of squares, and the places of three of its middles when it opens by 0.8 rad.
    fn sheet() -> (Sheet, Vec<AttachmentPoint>, Vec<Support>) {
        let pattern = CutPattern::new(
            GRID,
            Outline::rectangle(90.0, 90.0),
            &PatternCoordinates::uniform(GRID),
        );
        let options =
            SheetOptions { hinge_point: HingePoint::Corner, process: HingeConstants::PAPER.into() };
        let widths = vec![2.0; GRID.hinge_count()];
        let sheet = Sheet::new(&pattern.unwrap(), &widths, options).unwrap();
        let opened = ideal_deployment(&sheet, 0.8);
        let (mut points, mut supports) = (Vec::new(), Vec::new());
        for panel in [0, 8, 2] {
            let middle = sheet.panels[panel].centroid;
            let point = PanelPoint::Fixed(middle);
            points.push(AttachmentPoint { panel, point, ..AttachmentPoint::default() });
            let to = deployed(&sheet.panels[panel], opened[panel], middle);
            for (axis, dof) in [Dof::UX, Dof::UY].into_iter().enumerate() {
                supports.push(Support { panel, dof, value: to[axis] - middle[axis] });
            }
        }
        (sheet.attached_at(&points), points, supports)
    }

    #[test]
    fn holes_reach_their_places_one_after_the_other_and_the_sheet_ends_as_if_all_moved_at_once() {
        let (sheet, points, supports) = sheet();
        let settings = SolverSettings::default();
        let solver = EquilibriumSolver::new(GRID, &supports, &[], 8, settings).unwrap();
        let solver = solver.attached_at(points);
        let law = LinearLaw::uniform([5.0, 4.0, 3.0], GRID.hinge_count());
        let law = law.prepare(&sheet.designs());
        let hinged =
            HingedSheet { sheet: &sheet, law: &*law, contact: None, damage_gradient: false };
        assert_eq!(solver.fastened(), [0, 8, 2]);
        let flat = vec![[0.0; 3]; GRID.panel_count()];
        let steps = solver.mounted(hinged, &flat).unwrap();
        let panels: Vec<usize> = steps.iter().map(|step| step.panel).collect();
        assert_eq!(panels, [0, 8, 2]);
        for (count, step) in steps.iter().enumerate() {
            for support in &supports[..2 * (count + 1)] {
                let at = step.end[support.panel][support.dof.index()];
                assert!((at - support.value).abs() < 1e-9, "{support:?}: {at}");
            }
        }
        // The work of a hand that begins without a force is at most its largest force times way.
        assert!(steps[1].force > 0.0 && steps[1].way > 10.0);
        let at_once = solver.path(hinged).pop().unwrap().configuration;
        let last = &steps[2].end;
        for (one, other) in std::iter::zip(at_once.as_flattened(), last.as_flattened()) {
            assert!((one - other).abs() < 1e-6, "{one} {other}");
        }
    }

    #[test]
    fn a_sheet_with_a_load_or_a_roller_has_no_fasteners() {
        let (.., supports) = sheet();
        let settings = SolverSettings::default();
        let of = |supports: &[Support]| {
            EquilibriumSolver::new(GRID, supports, &[], 8, settings).unwrap()
        };
        assert!(of(&supports[1..]).fastened().is_empty());
        let mut loads = vec![[0.0; 3]; GRID.panel_count()];
        loads[4][0] = 1.0;
        assert!(of(&supports).loaded(&loads).unwrap().fastened().is_empty());
    }
}
