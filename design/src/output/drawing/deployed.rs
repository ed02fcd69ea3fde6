//! The deployed sheet with its target; the hinge windows are coloured by their opening angle.

use crate::equilibrium::load_step::LoadStep;
use crate::output::canvas::{Anchor, number};
use crate::output::deployment_states::{kept, states_before};
use crate::output::drawing::page::{ACCENT, ColourScale, INK, MUTED, PANELS, Page};
use crate::scene::design_run::Designed;
use crate::scene::placement::placed;
use crate::scene::{HingeModel, LoadConfig, Scene, SupportKind};
use crate::sheet::cut_sheet::Sheet;
use crate::sheet::hinge_window::Window;
use crate::sheet::kinematics::{
    Configuration, deployed as moved, deployed_corners, hinge_deformations,
};
use crate::sheet::topology::is_even;

/// The sheet of a scene in the configuration (u_x, u_y, phi) of its panels.
pub fn deployed(scene: &Scene, sheet: &Sheet, configuration: &[[f64; 3]]) -> String {
    let state = State::new(scene, sheet, configuration);
    let openings_deg = &state.openings_deg;
    let mean = openings_deg.iter().sum::<f64>() / openings_deg.len() as f64;
    let max = openings_deg
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    let subtitle = format!(
        "Deployed: mean hinge opening {mean:.1}\u{b0}, maximum {max:.1}\u{b0}. Target dashed"
    );
    let scale = ColourScale::covering(openings_deg.iter().copied());
    state.drawn(state.extent(), &subtitle, &scale)
}

/// The frames of the deployment of a run: at most `most` states from the flat sheet to the last one, on the same page
/// and in the same colours.
pub fn deployment_frames(scene: &Scene, designed: &Designed, most: usize) -> Vec<String> {
    let deployment = &designed.best.deployment;
    let before = states_before(&designed.problem, deployment);
    let all: Vec<&LoadStep> = before.iter().chain(&deployment.path).collect();
    let index = kept(all.len(), most);
    let states: Vec<State> = (index.iter())
        .map(|&i| State::new(scene, &deployment.sheet, &all[i].configuration))
        .collect();
    let extent: Vec<[f64; 2]> = states.iter().flat_map(State::extent).collect();
    let openings = states
        .iter()
        .flat_map(|state| state.openings_deg.iter().copied());
    let scale = ColourScale::covering(openings);
    let frame = |(&i, state): (&usize, &State)| {
        let place = match scene.config.hinge {
            HingeModel::Pin => format!("opening {:.1}\u{b0}", state.openings_deg[0]),
            _ => format!(
                "load step {i} of {}, load factor {:.2}",
                all.len() - 1,
                all[i].load_factor
            ),
        };
        state.drawn(
            extent.clone(),
            &format!("Deployment: {place}. Target dashed"),
            &scale,
        )
    };
    std::iter::zip(&index, &states).map(frame).collect()
}

/// The drawn state.
struct State<'a> {
    scene: &'a Scene,
    sheet: &'a Sheet,
    configuration: Configuration,
    openings_deg: Vec<f64>,
}

impl<'a> State<'a> {
    fn new(scene: &'a Scene, sheet: &'a Sheet, configuration: &[[f64; 3]]) -> Self {
        let deformations = hinge_deformations(sheet, configuration);
        Self {
            scene,
            sheet,
            configuration: placed(scene, sheet, configuration),
            openings_deg: deformations
                .iter()
                .map(|it| it.theta.to_degrees())
                .collect(),
        }
    }

    /// The picture of the state on a page around the points `extent`.
    fn drawn(&self, extent: Vec<[f64; 2]>, subtitle: &str, scale: &ColourScale) -> String {
        let mut page = Page::around(extent, &self.scene.config.title, subtitle, true);
        let ghost = page.dashed(MUTED, 0.8, 3.0);
        page.canvas.polygon(&self.sheet.outline.corners, &ghost);
        self.panels(&mut page);
        self.windows(&mut page, scale);
        let target = page.dashed(ACCENT, 2.2, 9.0);
        page.canvas.polygon(self.scene.target.points(), &target);
        self.supports(&mut page);
        self.loads(&mut page);
        page.colour_scale(scale, "\u{3b8} (deg)");
        page.finish()
    }

    /// The deployed position of a point of panel k.
    fn moved(&self, k: usize, point: [f64; 2]) -> [f64; 2] {
        moved(&self.sheet.panels[k], self.configuration[k], point)
    }

    /// The deployed centroid of the panel at [column, row].
    fn centroid(&self, [column, row]: [usize; 2]) -> [f64; 2] {
        let k = self.sheet.grid.panel(column, row);
        self.moved(k, self.sheet.panels[k].centroid)
    }

    /// Points that enclose everything drawn.
    fn extent(&self) -> Vec<[f64; 2]> {
        let arrow = 0.25 * self.sheet.outline.size();
        let arrows = self.scene.config.loads.iter().map(|load| {
            let ([x, y], [c, s]) = (self.centroid(load.panel), direction(load));
            [x + arrow * c, y + arrow * s]
        });
        let mut points = deployed_corners(self.sheet, &self.configuration).concat();
        points.extend(self.scene.target.points());
        points.extend(arrows);
        points
    }

    fn panels(&self, page: &mut Page) {
        let edge = 1.1 * page.unit;
        let corners = deployed_corners(self.sheet, &self.configuration);
        for (k, corners) in corners.iter().enumerate() {
            let fill = PANELS[usize::from(!is_even(self.sheet.grid, k))];
            let style = format!(
                "fill=\"{fill}\" stroke=\"{INK}\" stroke-width=\"{edge:.4}\" \
                 stroke-linejoin=\"round\""
            );
            page.canvas.polygon(corners, &style);
        }
    }

    /// Draws each window in two parts, which move with their panels.
    fn windows(&self, page: &mut Page, scale: &ColourScale) {
        let hinges = self.sheet.hinges.iter().zip(Window::of_sheet(self.sheet));
        for ((hinge, window), &opening_deg) in hinges.zip(&self.openings_deg) {
            let style = format!(
                "fill=\"{}\" fill-opacity=\"0.85\"",
                scale.colour(opening_deg)
            );
            for k in [hinge.panel_a(), hinge.panel_b()] {
                let part = window.inside(&self.sheet.panels[k]);
                let part: Vec<_> = part.into_iter().map(|point| self.moved(k, point)).collect();
                page.canvas.polygon(&part, &style);
            }
        }
    }

    /// Draws a square on a clamped panel, a triangle on a pinned one, a disc on a roller.
    fn supports(&self, page: &mut Page) {
        let size = 9.0 * page.unit;
        let style = format!("fill=\"{INK}\"");
        for support in &self.scene.config.supports {
            let [x, y] = self.centroid(support.panel);
            let around = |[a, b]: [f64; 2]| [x + a * size, y + b * size];
            match support.kind {
                SupportKind::Clamp => {
                    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
                    page.canvas.polygon(&square.map(around), &style);
                }
                SupportKind::Pin => {
                    let triangle = [[-1.2, -1.4], [1.2, -1.4], [0.0, 0.6]];
                    page.canvas.polygon(&triangle.map(around), &style);
                }
                SupportKind::RollerX | SupportKind::RollerY => {
                    page.canvas.circle([x, y], size, &style);
                }
            }
        }
    }

    /// Draws an arrow along a force and a curved arrow for a couple, each with its full magnitude.
    fn loads(&self, page: &mut Page) {
        let u = page.unit;
        let (stroke, fill) = (page.stroke(ACCENT, 3.0), format!("fill=\"{ACCENT}\""));
        let label = page.haloed(ACCENT);
        for load in &self.scene.config.loads {
            let [x, y] = self.centroid(load.panel);
            let [c, s] = direction(load);
            if [c, s] != [0.0; 2] {
                let at = |[along, aside]: [f64; 2]| {
                    let (along, aside) = (u * along, u * aside);
                    [x + along * c - aside * s, y + along * s + aside * c]
                };
                page.canvas.line([x, y], at([52.0, 0.0]), &stroke);
                let head = [[68.0, 0.0], [50.0, 8.0], [50.0, -8.0]];
                page.canvas.polygon(&head.map(at), &fill);
                let [x, y] = at([84.0 + 26.0 * c.abs(), 0.0]);
                let force = f64::hypot(load.force[0], load.force[1]);
                let force = format!("{} N", number(to_four_digits(force)));
                let below = [x, y - 5.0 * u];
                page.canvas
                    .text(below, 14.0 * u, Anchor::Middle, &label, &force);
            }
            if load.couple != 0.0 {
                let sense = if load.couple > 0.0 {
                    '\u{21ba}'
                } else {
                    '\u{21bb}'
                };
                let couple = format!("{sense} {} N mm", number(load.couple.abs()));
                let below = [x, y - 26.0 * u];
                page.canvas
                    .text(below, 16.0 * u, Anchor::Middle, &label, &couple);
            }
        }
    }
}

fn to_four_digits(value: f64) -> f64 {
    let scale = 10f64.powf(3.0 - value.log10().floor());
    (value * scale).round() / scale
}

/// Unit vector of a force; zero if there is no force.
fn direction(load: &LoadConfig) -> [f64; 2] {
    let magnitude = f64::hypot(load.force[0], load.force[1]);
    if magnitude > 0.0 {
        load.force.map(|component| component / magnitude)
    } else {
        [0.0; 2]
    }
}
