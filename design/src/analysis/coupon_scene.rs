//! The scene of a specimen of a coupon: two by two panels about one void, which hang from a hook and are pulled by a weight.
//!
//! ```text
//!  hook o-----+-----+     The panels with the hooks do not turn against each other. They move apart as the four hinges open, and
//!       |     '     |     the line from hook to hook stays vertical: pattern and hooks are their own image when turned by half a
//!       +- - -+- - -+     turn, and the centre of gravity is on that line.
//!       |     '     |
//!       +-----+-----o weight
//! ```

use crate::geometry::polygon::distance;
use crate::objective::shape::TargetState;
use crate::objective::target::TargetShape;
use crate::scene::{
    At, LoadConfig, ObjectiveConfig, Posture, PostureConfig, Scene, SceneConfig, SheetConfig,
    StartConfig, SupportConfig, SupportKind, ToleranceConfig,
};

/// Diameter of the holes for the hooks (mm), the smallest that a drag knife cuts.
pub const HOOK_HOLE: f64 = 5.0;
/// Distance of their centres from the edges of the specimen, in diameters: a hole and a half beside a hole.
const TO_EDGE: f64 = 2.0;
/// Side of a panel over the radius of a window: those of neighbouring hinges and the holes of the hooks do not overlap.
const PANEL: f64 = 3.7;
/// The side of a specimen is a multiple of this (mm).
const STEP: f64 = 5.0;
/// The panels with the hooks, [column, row].
const HELD: [usize; 2] = [0, 1];
const PULLED: [usize; 2] = [1, 0];

/// A specimen: all ligaments are `width` wide (mm), and the sides of the panels make the angle `corner_deg` at the lower left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    pub width: f64,
    pub corner_deg: f64,
}

impl Shape {
    /// The scene of the specimen for the sheet of `scene`, without its weight.
    pub fn scene(self, scene: &Scene, name: &str) -> std::io::Result<SceneConfig> {
        let located = scene.located()?;
        let process = located.process;
        let side = (2.0 * PANEL * process.r_win / STEP).ceil() * STEP;
        let (sin, cos) = self.corner_deg.to_radians().sin_cos();
        // To a nanometre: the cosine of 90 degrees is not quite 0.
        let along = |x: f64, y: f64| [x + cos * y, sin * y].map(|x| (1e6 * x).round() / 1e6);
        let corners = [
            along(0.0, 0.0),
            along(side, 0.0),
            along(side, side),
            along(0.0, side),
        ];
        let off = TO_EDGE * HOOK_HOLE / sin;
        let hooks = [along(off, side - off), along(side - off, off)];
        let length = distance(hooks[0], hooks[1]);
        let down = [0, 1].map(|c| (hooks[1][c] - hooks[0][c]) / length);
        let mut config = SceneConfig {
            title: format!("Coupon, specimen {name}"),
            output: name.into(),
            sheet: SheetConfig {
                size: None,
                corners: Some(corners),
                panels: [2, 2],
            },
            start: StartConfig::default(),
            tolerances: ToleranceConfig::default(),
            posture: Some(PostureConfig {
                kind: Posture::Hanging,
                down: Some(down),
                weight: None,
                friction: None,
            }),
            supports: vec![SupportConfig {
                panel: HELD,
                kind: SupportKind::Pin,
                at: At::Point(hooks[0]),
                hole: Some(HOOK_HOLE),
                clip: None,
                displacement: [0.0; 2],
                rotation_deg: 0.0,
            }],
            loads: vec![LoadConfig {
                panel: PULLED,
                at: At::Point(hooks[1]),
                hole: Some(HOOK_HOLE),
                clip: None,
                mass_g: None,
                force: [0.0; 2],
                couple: 0.0,
            }],
            contact: None,
            edge_loads: Vec::new(),
            opening_couples: Vec::new(),
            drive: None,
            // A specimen is not searched: it opens onto itself.
            target: TargetShape::Polygon {
                vertices: corners.to_vec(),
            },
            objective: ObjectiveConfig {
                target_state: TargetState::Loaded,
                balance: false,
                min_panel_width: 0.0,
                peak_load: 0.0,
                robust: 0.0,
                ..located.objective
            },
            ..located
        };
        config.ligament.start = self.width;
        config.optimiser.start_noise = 0.0;
        if let Some(learned) = &mut config.surrogate {
            learned.ensemble.clear();
            learned.springback = None;
        }
        Ok(config)
    }
}

/// The positions of the hooks in a specimen (mm).
pub(super) fn hooks(config: &SceneConfig) -> Option<[[f64; 2]; 2]> {
    match (config.supports.first()?.at, config.loads.first()?.at) {
        (At::Point(held), At::Point(pulled)) => Some([held, pulled]),
        _ => None,
    }
}
