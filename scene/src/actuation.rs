//! Supports and loads as written in a scene, with panels named by [column, row].

use crate::rounding::rounded;
use design::{
    pattern::grid::{EDGES, Grid},
    sheet::{cut_sheet::PanelPoint, topology::Topology},
};
use hinge::STANDARD_GRAVITY;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use support::Point;

/// A supported panel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportConfig {
    /// The panel [column, row], counted from [0, 0] at the lower left.
    pub panel: [usize; 2],
    /// Which motions of the point are prescribed, and whether the panel may turn about it.
    pub kind: SupportKind,
    /// The point of the panel that is held: `"centroid"`, the middle of its edge `"bottom"`,
    /// `"right"`, `"top"` or `"left"`, or a point [x, y] of the flat sheet (mm).
    #[serde(default)]
    pub at: At,
    /// Diameter of a hole at the point for a nail or a hook (mm).
    #[schemars(range(min = 0.05, max = 200.0))]
    pub hole: Option<f64>,
    /// Width of a clip that holds the edge `at` of a clamped panel (mm).
    #[schemars(range(min = 1.0, max = 2e3))]
    pub clip: Option<f64>,
    /// Displacement [x, y] of the supported translations at full load (mm); zero for free ones.
    #[serde(default)]
    #[schemars(inner(range(min = -1e5, max = 1e5)))]
    pub displacement: Point,
    /// Rotation at full load, counter-clockwise (deg); zero unless the rotation is supported.
    #[serde(default)]
    #[schemars(range(min = -720.0, max = 720.0))]
    pub rotation_deg: f64,
}

/// Which motions of a point of a panel a support prescribes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SupportKind {
    /// Both translations and the rotation.
    Clamp,
    /// Both translations.
    Pin,
    /// Rolls along x: the translation along y is prescribed.
    RollerX,
    /// Rolls along y: the translation along x is prescribed.
    RollerY,
}

/// A point of a panel; as text what stands before the name of its panel, nothing for its centroid.
#[derive(
    Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, derive_more::Display,
)]
#[serde(
    untagged,
    expecting = "expected \"centroid\", \"bottom\", \"right\", \"top\", \"left\" or a point [x, y] of the flat sheet (mm)"
)]
#[schemars(inline)]
pub enum At {
    /// By its name.
    Named(NamedPoint),
    /// [x, y] in the flat sheet (mm); it does not move with the cuts.
    #[display("the point ({}, {}) of ", rounded(_0[0]), rounded(_0[1]))]
    Point(Point),
}

/// A point of a panel that moves with its cuts.
#[derive(
    Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, derive_more::Display,
)]
#[serde(rename_all = "kebab-case")]
pub enum NamedPoint {
    /// The centroid of the panel.
    #[display("")]
    Centroid,
    /// The middle of its lower edge.
    #[display("the middle of the lower edge of ")]
    Bottom,
    /// The middle of its right edge.
    #[display("the middle of the right edge of ")]
    Right,
    /// The middle of its upper edge.
    #[display("the middle of the upper edge of ")]
    Top,
    /// The middle of its left edge.
    #[display("the middle of the left edge of ")]
    Left,
}

/// A dead load at a point of a panel: it keeps its direction, and its point moves with the panel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadConfig {
    /// The panel [column, row], counted from [0, 0] at the lower left.
    pub panel: [usize; 2],
    /// The point of the panel that is pulled, as for supports.
    #[serde(default)]
    pub at: At,
    /// Diameter of a hole at the point for a hook (mm).
    #[schemars(range(min = 0.05, max = 200.0))]
    pub hole: Option<f64>,
    /// Width of a clip on the edge `at`, from which the load hangs (mm).
    #[schemars(range(min = 1.0, max = 2e3))]
    pub clip: Option<f64>,
    /// Mass of a weight (g) that hangs from the point of a `hanging` sheet, besides `force`.
    #[schemars(range(min = 1e-3, max = 1e7))]
    pub mass_g: Option<f64>,
    /// Force [x, y] at full load (N); zero along supported translations.
    #[serde(default)]
    #[schemars(inner(range(min = -1e5, max = 1e5)))]
    pub force: [f64; 2],
    /// Couple at full load, counter-clockwise (N mm); zero if the rotation is supported.
    #[serde(default)]
    #[schemars(range(min = -1e8, max = 1e8))]
    pub couple: f64,
}

/// A dead traction along an edge of the flat sheet. Its resultant is divided equally among the
/// panels of the edge and acts at their centroids, so the loads do not change with the pattern.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EdgeLoadConfig {
    /// The loaded edge.
    pub edge: SheetEdge,
    /// Traction [x, y] at full load (N/mm).
    #[schemars(inner(range(min = -1e3, max = 1e3)))]
    pub traction: [f64; 2],
}

/// An edge of the outline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SheetEdge {
    /// The edge from the south-west to the south-east corner.
    Bottom,
    /// The edge from the south-east to the north-east corner.
    Right,
    /// The edge from the north-west to the north-east corner.
    Top,
    /// The edge from the south-west to the north-west corner.
    Left,
}

/// Self-equilibrated couples on the two panels of a hinge that open it. The couple on a panel whose
/// rotation is supported would do no work and is left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OpeningCoupleConfig {
    /// Two neighbouring panels [column, row]; by default every hinge of the sheet.
    pub panels: Option<[[usize; 2]; 2]>,
    /// Couple at full load (N mm), positive to open.
    #[schemars(range(min = -1e8, max = 1e8))]
    pub couple: f64,
}

/// Displacement control: the stroke of the loads is prescribed; the load factor is an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DriveConfig {
    /// Stroke at the end of the path: work of the full loads divided by the sum of their magnitudes
    /// (mm).
    #[schemars(range(min = -1e5, max = 1e5))]
    pub stroke: f64,
}

impl SupportKind {
    /// Whether (u_x, u_y, phi) are prescribed.
    pub fn holds(self) -> [bool; 3] {
        match self {
            Self::Clamp => [true, true, true],
            Self::Pin => [true, true, false],
            Self::RollerX => [false, true, false],
            Self::RollerY => [true, false, false],
        }
    }

    /// Outline of the symbol, in halves of its size: a square, a triangle or a disc.
    pub(super) fn symbol(self) -> Vec<Point> {
        match self {
            Self::Clamp => vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
            Self::Pin => vec![[-1.2, -1.4], [1.2, -1.4], [0.0, 0.6]],
            Self::RollerX | Self::RollerY => {
                let angles = (0..32).map(|i| f64::from(i) * TAU / 32.0);
                angles.map(|angle| [angle.cos(), angle.sin()]).collect()
            }
        }
    }

    /// The direction in which a roller rolls.
    pub(super) fn rail(self) -> Option<Point> {
        match self {
            Self::Clamp | Self::Pin => None,
            Self::RollerX => Some([1.0, 0.0]),
            Self::RollerY => Some([0.0, 1.0]),
        }
    }
}

impl SupportConfig {
    /// A panel that is held at its centroid, where it is.
    pub fn at_centroid(panel: [usize; 2], kind: SupportKind) -> Self {
        Self {
            panel,
            kind,
            at: At::default(),
            hole: None,
            clip: None,
            displacement: [0.0; 2],
            rotation_deg: 0.0,
        }
    }

    /// (u_x, u_y, phi) at full load (mm, mm, rad).
    pub(super) fn motion(&self) -> [f64; 3] {
        let [x, y] = self.displacement;
        [x, y, self.rotation_deg.to_radians()]
    }
}

/// A point of a panel that is held or pulled, with its hole or its clip, as written in a scene.
pub(super) struct Attached {
    /// The key of the support or the load.
    pub key: String,
    /// What is attached.
    pub kind: String,
    pub panel: [usize; 2],
    pub at: At,
    pub hole: Option<f64>,
    pub clip: Option<f64>,
}

/// The name of a value in a scene.
pub(super) fn name(value: impl Serialize) -> String {
    let name = serde_json::to_value(value).unwrap_or_default();
    name.as_str().unwrap_or_default().to_owned()
}

impl LoadConfig {
    /// A force (N) at the centroid of a panel.
    pub fn at_centroid(panel: [usize; 2], force: [f64; 2]) -> Self {
        Self { panel, at: At::default(), hole: None, clip: None, mass_g: None, force, couple: 0.0 }
    }
}

impl Default for At {
    fn default() -> Self {
        Self::Named(NamedPoint::Centroid)
    }
}

impl At {
    /// The point of a panel of a sheet.
    pub(super) fn point(self) -> PanelPoint {
        match (self, self.edge()) {
            (Self::Point(position), _) => PanelPoint::Fixed(position),
            (_, Some(edge)) => PanelPoint::Middle(EDGES[edge as usize]),
            (_, None) => PanelPoint::Centroid,
        }
    }

    /// The edge of the panel in whose middle the point is.
    pub(super) fn edge(self) -> Option<SheetEdge> {
        match self {
            Self::Point(_) | Self::Named(NamedPoint::Centroid) => None,
            Self::Named(NamedPoint::Bottom) => Some(SheetEdge::Bottom),
            Self::Named(NamedPoint::Right) => Some(SheetEdge::Right),
            Self::Named(NamedPoint::Top) => Some(SheetEdge::Top),
            Self::Named(NamedPoint::Left) => Some(SheetEdge::Left),
        }
    }
}

impl LoadConfig {
    /// (F_x, F_y, M), with the hung mass along `down` (N, N, N mm).
    pub(super) fn values(&self, down: Option<[f64; 2]>) -> [f64; 3] {
        let hung = 1e-3 * STANDARD_GRAVITY * self.mass_g.unwrap_or(0.0);
        let [x, y] = [0, 1].map(|c| self.force[c] + down.map_or(0.0, |down| hung * down[c]));
        [x, y, self.couple]
    }
}

impl SheetEdge {
    /// The panels along the edge.
    pub(super) fn panels(self, topology: &Topology) -> Vec<usize> {
        let Grid { m, n } = topology.grid;
        let row = |q| (0..m).filter_map(|p| topology.panel(p, q)).collect();
        let column = |p| (0..n).filter_map(|q| topology.panel(p, q)).collect();
        match self {
            Self::Bottom => row(0),
            Self::Right => column(m - 1),
            Self::Top => row(n - 1),
            Self::Left => column(0),
        }
    }
}
