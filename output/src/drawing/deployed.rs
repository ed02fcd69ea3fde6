//! The deployed sheet with its target; the hinge windows are coloured by their opening angle.

use crate::{
    deployment_states::{kept, states_before},
    display::{Canvas, Style},
    drawing::{
        load_marks,
        page::{ACCENT, ColourScale, INK, MUTED, Page, panels, windows},
    },
};
use design::{
    equilibrium::load_step::LoadStep,
    objective::design_problem::Deployment,
    sheet::{
        cut_sheet::Sheet,
        kinematics::{Configuration, deployed as moved, deployed_boundaries, hinge_deformations},
    },
};
use scene::{Scene, design_run::Designed, placement::placed};
use support::Point;

/// The sheet of a scene in the state that is compared with the target, with the loads there.
pub fn deployed(scene: &Scene, deployment: &Deployment) -> String {
    let state = DeployedState::new(scene, &deployment.sheet, deployment.final_step());
    let openings_deg = &state.openings_deg;
    let mean = openings_deg.iter().sum::<f64>() / openings_deg.len() as f64;
    let max = openings_deg.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let actuation = if scene.hinge.carries_load() { ". Panels in the plane" } else { "" };
    let subtitle = format!(
        "Deployed: mean hinge opening {mean:.1}\u{b0}, maximum {max:.1}\u{b0}{actuation}. Target dashed"
    );
    let scale = ColourScale::covering(openings_deg.iter().copied());
    state.drawn(state.extent(), &subtitle, &scale)
}

/// The frames of the deployment of a run: at most `most` states from the flat sheet to the last
/// one, on the same page and in the same colours.
pub fn deployment_frames(scene: &Scene, designed: &Designed, most: usize) -> Vec<String> {
    let deployment = &designed.best.deployment;
    let before = states_before(&designed.problem, deployment);
    let all: Vec<&LoadStep> = before.iter().chain(&deployment.path).collect();
    let index = kept(all.len(), most);
    let states: Vec<DeployedState> =
        (index.iter()).map(|&i| DeployedState::new(scene, &deployment.sheet, all[i])).collect();
    let extent: Vec<Point> = states.iter().flat_map(DeployedState::extent).collect();
    let openings = states.iter().flat_map(|state| state.openings_deg.iter().copied());
    let scale = ColourScale::covering(openings);
    let frame = |(&i, state): (&usize, &DeployedState)| {
        let place = if scene.hinge.carries_load() {
            format!("load step {i} of {}, load factor {:.2}", all.len() - 1, all[i].load_factor)
        } else {
            format!("opening {:.1}\u{b0}", state.openings_deg[0])
        };
        state.drawn(extent.clone(), &format!("Deployment: {place}. Target dashed"), &scale)
    };
    std::iter::zip(&index, &states).map(frame).collect()
}

struct DeployedState<'a> {
    scene: &'a Scene,
    sheet: &'a Sheet,
    step: &'a LoadStep,
    configuration: Configuration,
    openings_deg: Vec<f64>,
}

impl<'a> DeployedState<'a> {
    fn new(scene: &'a Scene, sheet: &'a Sheet, step: &'a LoadStep) -> Self {
        let deformations = hinge_deformations(sheet, &step.configuration);
        Self {
            scene,
            sheet,
            step,
            configuration: placed(scene, sheet, &step.configuration),
            openings_deg: deformations.iter().map(|eps| eps.theta.to_degrees()).collect(),
        }
    }

    /// The picture of the state on a page around the points `extent`.
    fn drawn(&self, extent: Vec<Point>, subtitle: &str, scale: &ColourScale) -> String {
        let mut page = Page::around(extent, &self.scene.config.title, subtitle, true);
        let canvas = &mut page.canvas;
        let ghost = canvas.dashed(MUTED, 0.8, 3.0);
        if self.sheet.topology.is_full() {
            canvas.polygon(&self.sheet.outline.corners, ghost);
        }
        let boundaries = deployed_boundaries(self.sheet, &self.configuration);
        let line = canvas.stroke(INK, 1.1);
        panels(canvas, &self.sheet.topology, boundaries, line);
        let style = |h| Style::fill(scale.colour(self.openings_deg[h])).opacity(0.85, 1.0);
        windows(canvas, self.sheet, style, |k, point| {
            moved(&self.sheet.panels[k], self.configuration[k], point)
        });
        self.target(canvas);
        load_marks::draw(canvas, self.scene, self.sheet, self.step);
        page.colour_scale(scale, "\u{3b8} (deg)");
        page.finish()
    }

    /// Points that enclose everything drawn.
    fn extent(&self) -> Vec<Point> {
        let mut points = deployed_boundaries(self.sheet, &self.configuration).concat();
        points.extend(&self.scene.target.points);
        points.extend(load_marks::extent(self.scene, self.sheet, self.step));
        points
    }

    fn target(&self, canvas: &mut Canvas) {
        let style = canvas.dashed(ACCENT, 2.2, 9.0);
        let target = &self.scene.target;
        for contour in target.holes.iter().chain([&target.points]) {
            canvas.polygon(contour, style);
        }
    }
}
