//! How the sheet is held out of its plane, as written in a scene.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Coefficient of friction of a sheet on a surface: typical of plastics and metals on smooth dry
/// surfaces; ISO 8295 and ASTM D1894 measure it.
pub const FRICTION: f64 = 0.3;

/// How the sheet is held out of its plane, and in which direction it is heavy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PostureConfig {
    /// What keeps the panels in their plane.
    pub kind: Posture,
    /// The direction [x, y] of gravity in the plane of the flat sheet, such as [0.0, -1.0];
    /// required for `hanging`.
    #[schemars(inner(range(min = -1e3, max = 1e3)))]
    pub down: Option<[f64; 2]>,
}

/// What keeps the panels in their plane. In the model all panels stay in it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Posture {
    /// Plates, a frame or a fabric keep every panel flat.
    HeldFlat,
    /// On a board: the supports are fasteners, which hold their panels on it; nothing keeps the
    /// panels between them in the plane. Its weight is left out.
    Mounted,
    /// It lies on a horizontal surface: its weight presses the panels down, and friction resists
    /// the motion.
    Lying,
    /// Its plane is upright: its weight acts along `down`, and nothing keeps thin panels in the
    /// plane.
    Hanging,
    /// Nothing keeps thin panels in the plane; its weight is left out.
    Free,
}

impl Posture {
    /// How the panels are kept in their plane, in words.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::HeldFlat => "panels held flat",
            Self::Mounted => {
                "mounted on a board, nothing in the way out of the plane between fasteners"
            }
            Self::Lying => "lying on a table without friction, under its own weight",
            Self::Hanging => "hanging under its own weight, nothing in the way out of the plane",
            Self::Free => "free, nothing in the way out of the plane, without weight",
        }
    }
}

impl PostureConfig {
    /// The unit vector along gravity; `None` without a direction.
    pub(super) fn down(&self) -> Option<[f64; 2]> {
        let [x, y] = self.down?;
        let length = x.hypot(y);
        (length > 0.0).then(|| [x / length, y / length])
    }

    /// Whether the weight of the panels is modelled.
    pub fn is_heavy(&self) -> bool {
        self.kind == Posture::Hanging
    }
}
