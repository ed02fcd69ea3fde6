//! Supports and loads in a state of the path: a symbol on every supported panel, with the number of
//! its fastener on a board, an arrow along every force, a curved arrow in the sense of every couple.

use crate::{
    display::{Anchor, Canvas, Style},
    drawing::page::{ACCENT, INK},
    report::rounded,
};
use design::{
    equilibrium::load_step::LoadStep,
    sheet::{cut_sheet::Sheet, kinematics::deployed as moved},
};
use scene::{Posture, Scene, placement::placed};
use std::f64::consts::PI;
use support::{Extremes, Point};

/// Half the size of the symbol of a support, in units of the picture, as the lengths below.
const SUPPORT: f64 = 9.0;
/// Length of the arrow of the largest force, the length that no arrow is below, and length and half
/// width of a head.
const LONGEST: f64 = 68.0;
const SHORTEST: f64 = 24.0;
const HEAD: [f64; 2] = [18.0, 8.0];
/// Radius of a curved arrow, and the angle that it leaves open.
const RADIUS: f64 = 22.0;
const OPEN: f64 = 0.3 * PI;
/// Loads below this fraction of the largest one are rounding.
const NEGLIGIBLE: f64 = 1e-6;
/// Reach of an arrow and its label from the point at which it acts, over the size of the sheet.
const REACH: f64 = 0.16;

/// The force (N, N) and the couple (N mm) of the loads on a panel in a state.
struct PanelLoad {
    at: Point,
    force: [f64; 2],
    couple: f64,
}

impl PanelLoad {
    fn on_panels(scene: &Scene, sheet: &Sheet, step: &LoadStep) -> Vec<Self> {
        let placed = placed(scene, sheet, &step.configuration);
        let mut sums = vec![[0.0; 3]; sheet.panels.len()];
        for load in scene.actuation().boundary_loads() {
            sums[load.panel][load.dof.index()] += step.load_factor * load.value;
        }
        let most = |of: fn(&[f64; 3]) -> f64| sums.iter().map(of).largest();
        let (force, couple) = (most(|[x, y, _]| x.hypot(*y)), most(|[.., moment]| moment.abs()));
        let kept = |value: f64, size: f64, largest: f64| {
            if size > NEGLIGIBLE * largest { value } else { 0.0 }
        };
        (sums.iter().enumerate())
            .map(|(k, &[x, y, moment])| Self {
                at: moved(&sheet.panels[k], placed[k], sheet.panels[k].reference),
                force: [x, y].map(|component| kept(component, x.hypot(y), force)),
                couple: kept(moment, moment.abs(), couple),
            })
            .filter(|load| load.force != [0.0; 2] || load.couple != 0.0)
            .collect()
    }

    fn size(&self) -> f64 {
        self.force[0].hypot(self.force[1])
    }
}

/// Points that enclose arrows and labels (mm).
pub(super) fn extent(scene: &Scene, sheet: &Sheet, step: &LoadStep) -> Vec<Point> {
    let reach = REACH * sheet.outline.size();
    (PanelLoad::on_panels(scene, sheet, step).iter())
        .map(|load| {
            let size = f64::max(load.size(), f64::MIN_POSITIVE);
            [0, 1].map(|axis| load.at[axis] + reach * load.force[axis] / size)
        })
        .collect()
}

/// Draws the supports and the loads of a state. Of equal loads the first has a label.
pub(super) fn draw(canvas: &mut Canvas, scene: &Scene, sheet: &Sheet, step: &LoadStep) {
    supports(canvas, scene, sheet, step);
    let unit = canvas.unit;
    let loads = PanelLoad::on_panels(scene, sheet, step);
    let largest = loads.iter().map(PanelLoad::size).largest();
    let mut labelled: Vec<String> = Vec::new();
    let mut label = |canvas: &mut Canvas, key: String, [x, y]: Point, text: &str| {
        if !labelled.contains(&key) {
            labelled.push(key);
            let (below, style) = ([x, y - 5.0 * unit], canvas.haloed(ACCENT));
            canvas.text(below, 14.0 * unit, Anchor::Middle, style, text);
        }
    };
    for load in &loads {
        let [x, y] = load.at;
        if load.force != [0.0; 2] {
            let size = load.size();
            let [c, s] = load.force.map(|component| component / size);
            let at = |[along, aside]: Point| {
                let (along, aside) = (unit * along, unit * aside);
                [x + along * c - aside * s, y + along * s + aside * c]
            };
            let tip = SHORTEST + (LONGEST - SHORTEST) * size / largest;
            let neck = tip - HEAD[0];
            let head = [[tip, 0.0], [neck, HEAD[1]], [neck, -HEAD[1]]];
            arrow(canvas, &[[x, y], at([neck + 2.0, 0.0])], head.map(at));
            let text = format!("{} N", rounded(size, 4));
            let [x, y] = load.force.map(|component| rounded(component, 4));
            let key = format!("{x} {y}");
            // The half width of a character and the half height of a text are 4.1 and 8 units.
            let width = 4.1 * text.chars().count() as f64;
            let beyond = tip + 8.0 + width * c.abs() + 8.0 * s.abs();
            label(canvas, key, at([beyond, 0.0]), &text);
        }
        if load.couple != 0.0 {
            curved_arrow(canvas, load.at, load.couple.signum());
            // On the side that the arrow of the force leaves free.
            let side = if load.force[1] < 0.0 { 1.0 } else { -1.0 };
            let text = format!("{} N mm", rounded(load.couple.abs(), 4));
            let at = [x, y + side * (RADIUS + 18.0) * unit];
            label(canvas, rounded(load.couple, 4), at, &text);
        }
    }
}

fn supports(canvas: &mut Canvas, scene: &Scene, sheet: &Sheet, step: &LoadStep) {
    let placed = placed(scene, sheet, &step.configuration);
    let mounted = scene.config.posture.is_some_and(|posture| posture.kind == Posture::Mounted);
    let (half, style) = (SUPPORT * canvas.unit, canvas.haloed(INK));
    for (place, support) in scene.actuation().supports.iter().enumerate() {
        let k = support.panel;
        let [x, y] = moved(&sheet.panels[k], placed[k], sheet.panels[k].reference);
        let around = |[a, b]: &Point| [x + a * half, y + b * half];
        let corners: Vec<_> = support.symbol.iter().map(around).collect();
        canvas.polygon(&corners, Style::fill(INK));
        if mounted {
            let number = (place + 1).to_string();
            canvas.text(around(&[1.4, -0.5]), 1.6 * half, Anchor::Start, style, &number);
        }
    }
}

fn arrow(canvas: &mut Canvas, shaft: &[Point], head: [Point; 3]) {
    canvas.polyline(shaft, canvas.stroke(ACCENT, 3.0));
    canvas.polygon(&head, Style::fill(ACCENT));
}

/// A curved arrow about a point, counter-clockwise for the sense 1, clockwise for -1.
fn curved_arrow(canvas: &mut Canvas, [x, y]: Point, sense: f64) {
    // Symmetric about the vertical axis, open at the bottom.
    let [from, to] = [-PI / 2.0 + OPEN, 1.5 * PI - OPEN];
    let at = |radius: f64, angle: f64| {
        let radius = radius * canvas.unit;
        [x + sense * radius * angle.cos(), y + radius * angle.sin()]
    };
    let length = HEAD[0] / RADIUS;
    let arc = (0..=24).map(|i| from + f64::from(i) / 24.0 * (to - length - from));
    let neck = to - length;
    let head = [at(RADIUS, to + 0.1), at(RADIUS - HEAD[1], neck), at(RADIUS + HEAD[1], neck)];
    let arc: Vec<_> = arc.map(|angle| at(RADIUS, angle)).collect();
    arrow(canvas, &arc, head);
}
