//! Rigid panels and hinges of the cut endpoints: centroids, cut frames, cut angles, cut tips; and
//! the exact vector-Jacobian product of this map.
//!
//! The slit of C_ij is the segment [A, B]. On each of its flanks is one hinge, at x_ij and at
//! x'_ij. There C_ij (or the outline edge) is the secondary cut, and the neighbouring cut that ends
//! there is the main cut. With m the unit vector from the corner C along the main cut and e_sec =
//! (B - A)/L at x, (A - B)/L at x',
//!
//! ```text
//! alpha = atan2(-m . e_sec_perp, m . e_sec),     O = C + w_lig / sin(alpha) m        (7)
//! ```

pub use crate::sheet::panel::{Panel, PanelPoint};
use crate::{
    geometry::{
        plane::{I, complex, cross, dot, point},
        region::{Region, Ring},
    },
    pattern::{
        cut_pattern::{CutPattern, Outline},
        grid::{Grid, NE, NW, SE, SW},
    },
    sheet::{
        cutting_process::CuttingProcess,
        topology::{HingeSite, PanelCorner, Topology},
    },
};
use faer::c64;
use hinge::HingeDesign;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::iter::zip;
use std::sync::Arc;
use support::{Fault, Point, ensure, refuse};

/// The point at which the hinge deformation (8) is measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HingePoint {
    /// The ideal corner shared by the two panels, as in the paper.
    Corner,
    /// The tip O of the main cut, where the window is driven: exact for the surrogate.
    CutTip,
}

/// A point at which a panel is held or pulled.
#[derive(Clone, Debug, Default)]
pub struct AttachmentPoint {
    /// What is attached.
    pub name: String,
    /// Index of the panel.
    pub panel: usize,
    /// The point of the panel.
    pub point: PanelPoint,
    /// Diameter of a hole for a nail or a hook (mm).
    pub hole: Option<f64>,
    /// Width of a clip on an edge of the panel (mm).
    pub clip: Option<f64>,
}

/// Options of the sheet that a pattern defines.
#[derive(Clone, Copy, Debug)]
pub struct SheetOptions {
    /// The point at which (8) is measured.
    pub hinge_point: HingePoint,
    /// The cutting tool and the windows.
    pub process: CuttingProcess,
}

/// The ligament that joins two panels.
#[derive(Clone, Copy, Debug)]
pub struct Hinge {
    /// The two panels and the cuts that bound the hinge.
    pub site: HingeSite,
    /// The ideal corner C, shared by the two panels (mm).
    pub corner: Point,
    /// The tip O of the main cut (mm).
    pub tip: Point,
    /// The point at which (8) is measured: `corner` or `tip` (mm).
    pub attachment: Point,
    /// Unit vector along the secondary cut.
    pub e_sec: Point,
    /// Unit vector from the corner along the main cut.
    pub main: Point,
    /// Material between O and the finished edge of the secondary cut (mm).
    pub w_lig: f64,
    /// Distance of O from the line of the secondary cut (mm): w_lig plus half of the slit, or
    /// only w_lig if that line is the outline of the sheet, which is cut to its finished edge.
    pub set_back: f64,
    /// Angle between the cuts, measured into the material (rad).
    pub alpha: f64,
    /// Radius of the hole about O over w_lig.
    pub fillet_ratio: f64,
}

/// The flat sheet: rigid panels joined by hinges.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Its panels and hinges.
    pub topology: Arc<Topology>,
    /// Outline of the pattern.
    pub outline: Outline,
    /// Options with which the sheet was computed.
    pub options: SheetOptions,
    /// Row by row.
    pub panels: Vec<Panel>,
    /// Ordered by vertex, row by row; at each vertex x before x'.
    pub hinges: Vec<Hinge>,
    /// Cut endpoints of the pattern.
    points: Vec<Point>,
}

/// The gradient of a function of the sheet with respect to all quantities of the sheet.
#[derive(Debug)]
pub struct SheetGradient {
    /// Gradient in the corners SW, SE, NE, NW of every panel, at fixed reference, centroid and
    /// area.
    pub corners: Vec<[c64; 4]>,
    /// Gradient in the reference point of every panel.
    pub references: Vec<c64>,
    /// Gradient in the centroid of every panel, at a fixed reference point.
    pub centroids: Vec<c64>,
    /// Gradient in the area of every panel.
    pub areas: Vec<f64>,
    /// Gradient in the attachment point of every hinge.
    pub attachments: Vec<c64>,
    /// Gradient in the tip of the main cut of every hinge, at a fixed attachment point.
    pub tips: Vec<c64>,
    /// Gradient in the angle of e_sec, per hinge.
    pub frame_angles: Vec<f64>,
    /// Gradient in alpha, per hinge.
    pub alphas: Vec<f64>,
    /// Gradient in w_lig, per hinge, at a fixed attachment point and a fixed radius of the hole
    /// over w_lig.
    pub widths: Vec<f64>,
    /// Gradient in the radius of the hole over w_lig, per hinge.
    pub holes: Vec<f64>,
}

impl SheetGradient {
    /// A zero gradient.
    pub fn zeros(topology: &Topology) -> Self {
        let (panels, hinges) = (topology.panel_count(), topology.hinge_count());
        Self {
            corners: vec![[c64::ZERO; 4]; panels],
            references: vec![c64::ZERO; panels],
            centroids: vec![c64::ZERO; panels],
            areas: vec![0.0; panels],
            attachments: vec![c64::ZERO; hinges],
            tips: vec![c64::ZERO; hinges],
            frame_angles: vec![0.0; hinges],
            alphas: vec![0.0; hinges],
            widths: vec![0.0; hinges],
            holes: vec![0.0; hinges],
        }
    }
}

impl Sheet {
    /// The sheet of all cells of `pattern` with one ligament width (mm) per hinge.
    pub fn new(pattern: &CutPattern, w_lig: &[f64], options: SheetOptions) -> Result<Self, Fault> {
        Self::of_cells(pattern, pattern.grid.into(), w_lig, options)
    }

    /// The sheet of some cells of `pattern` with one ligament width (mm) per hinge.
    pub fn of_cells(
        pattern: &CutPattern,
        topology: Arc<Topology>,
        w_lig: &[f64],
        options: SheetOptions,
    ) -> Result<Self, Fault> {
        if w_lig.len() != topology.hinge_count() {
            let (found, expected) = (w_lig.len(), topology.hinge_count());
            refuse!("{found} ligament widths for {expected} hinges");
        }
        let shapes = zip(&topology.endpoints, &topology.trims);
        let panels = zip(0.., shapes)
            .map(|(k, (endpoints, trim))| {
                let corners = endpoints.map(|endpoint| pattern.points[endpoint]);
                Panel::new(k, corners, trim.clone())
            })
            .collect::<Result<_, _>>()?;
        let hinges = zip(&topology.sites, w_lig)
            .enumerate()
            .map(|(h, (site, &w_lig))| {
                let slit = topology.has_far_flank(site);
                let half_slit = if slit { 0.5 * options.process.slit_width } else { 0.0 };
                let widths = [w_lig, w_lig + half_slit];
                Hinge::new(h, *site, &pattern.points, widths, options)
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            topology,
            outline: pattern.outline,
            options,
            panels,
            hinges,
            points: pattern.points.clone(),
        })
    }

    /// The edge of the flat sheet: its outer contours, counter-clockwise, and its holes, clockwise
    /// (mm).
    pub fn outlines(&self) -> Vec<Ring> {
        /// Gaps between panels that are rounding errors (mm).
        const ROUNDING: f64 = 1e-3;
        /// Depth of the notches that sharp corners leave where such gaps were (mm).
        const NOTCH: f64 = 6e-3;
        if self.topology.is_full() {
            return vec![self.outline.corners.to_vec()];
        }
        let panels = self.panels.iter().map(|panel| panel.boundary.clone()).collect();
        let joined = Region::union_of(panels).joined(ROUNDING).simplified(NOTCH, |_| false);
        joined.polygons.into_iter().flatten().collect()
    }

    /// The same sheet, held or pulled at other points than the centroids of its panels.
    ///
    /// # Panics
    /// If a point is on a panel that the sheet does not have.
    pub fn attached_at(mut self, points: &[AttachmentPoint]) -> Self {
        for &AttachmentPoint { panel, point, .. } in points {
            let panel = &mut self.panels[panel];
            panel.point = point;
            panel.reference = panel.position(point);
        }
        self
    }

    /// The design vectors g of the hinges; (7).
    pub fn designs(&self) -> Vec<HingeDesign> {
        let CuttingProcess { slit_width, r_win, .. } = self.options.process;
        let design = |hinge: &Hinge| HingeDesign {
            w_lig: hinge.w_lig,
            alpha: hinge.alpha,
            fillet_ratio: hinge.fillet_ratio,
            kerf: slit_width,
            r_win,
        };
        self.hinges.iter().map(design).collect()
    }

    /// The panel corners on the outline of a sheet of all cells, counter-clockwise from the
    /// south-west: (panel, corner).
    pub fn outline_corners(&self) -> Vec<PanelCorner> {
        let Grid { m, n } = self.topology.grid;
        let bottom = (0..m).map(|p| (p, 0, [SW, SE]));
        let right = (0..n).map(|q| (m - 1, q, [SE, NE]));
        let top = (0..m).rev().map(|p| (p, n - 1, [NE, NW]));
        let left = (0..n).rev().map(|q| (0, q, [NW, SW]));
        let cells = bottom.chain(right).chain(top).chain(left);
        let mut ring: Vec<_> = cells
            .filter_map(|(p, q, ends)| Some((self.topology.panel(p, q)?, ends)))
            .flat_map(|(panel, ends)| ends.map(|corner| (panel, corner)))
            .collect();
        ring.dedup();
        ring.pop();
        ring
    }

    /// The corners of the boundaries of panels that belong to no hinge and are on the outline of the
    /// opened sheet.
    pub fn free_outline_corners(&self) -> Vec<PanelCorner> {
        if !self.topology.outer.is_empty() {
            return self.topology.outer.clone();
        }
        let mut corners = self.outline_corners();
        corners.retain(|corner| {
            let belongs = |hinge: &Hinge| [hinge.site.a, hinge.site.b].contains(corner);
            !self.hinges.iter().any(belongs)
        });
        corners
    }

    /// Gradients in the pattern's cut endpoints and in w_lig, from a gradient in the sheet.
    pub fn pullback(&self, gradient: &SheetGradient) -> (Vec<c64>, Vec<f64>) {
        let mut points = vec![c64::ZERO; self.points.len()];
        for (k, panel) in self.panels.iter().enumerate() {
            let by_parts = [
                gradient.corners[k],
                panel.pullback(panel.point, gradient.references[k]),
                panel.pullback(PanelPoint::Centroid, gradient.centroids[k]),
                panel.area_pullback(gradient.areas[k]),
            ];
            for (corner, &endpoint) in self.topology.endpoints[k].iter().enumerate() {
                let by_corner = by_parts.iter().map(|by_corners| by_corners[corner]);
                points[endpoint] += by_corner.sum::<c64>();
            }
        }
        let mut widths = gradient.widths.clone();
        for (h, hinge) in self.hinges.iter().enumerate() {
            let radius_by_width = self.options.process.radius_by_width();
            widths[h] += gradient.holes[h] * (radius_by_width - hinge.fillet_ratio) / hinge.w_lig;
            let (attachment, mut by_tip) = (gradient.attachments[h], gradient.tips[h]);
            points[hinge.site.corner] += attachment + by_tip;
            if self.options.hinge_point == HingePoint::CutTip {
                by_tip += attachment;
            }
            let (sin, cos) = hinge.alpha.sin_cos();
            let main = complex(hinge.main);
            let along = dot(by_tip, main);
            widths[h] += along / sin;
            let by_alpha = gradient.alphas[h] - along * hinge.set_back * cos / (sin * sin);
            let by_main_angle = dot(by_tip, I * main) * hinge.set_back / sin;
            // alpha is the angle of e_sec minus the angle of m.
            let by_frame_angle = gradient.frame_angles[h] + by_alpha;
            self.angle_pullback(&mut points, hinge.site.secondary, by_frame_angle);
            let main_cut = [hinge.site.corner, hinge.site.main_end];
            self.angle_pullback(&mut points, main_cut, by_main_angle - by_alpha);
        }
        (points, widths)
    }

    /// Adds the gradient of `weight` times the angle of the segment between two cut endpoints.
    fn angle_pullback(&self, points: &mut [c64], [from, to]: [usize; 2], weight: f64) {
        let segment = complex(self.points[to]) - complex(self.points[from]);
        let gradient = I * segment * (weight / segment.norm_sqr());
        points[to] += gradient;
        points[from] -= gradient;
    }
}

impl Hinge {
    fn new(
        hinge: usize,
        site: HingeSite,
        points: &[Point],
        [w_lig, set_back]: [f64; 2],
        options: SheetOptions,
    ) -> Result<Self, Fault> {
        ensure!(
            w_lig > 0.0 && w_lig.is_finite(),
            "w_lig[{hinge}] = {w_lig} mm is not a positive finite number"
        );
        let unit = |from: usize, to: usize| {
            let segment = complex(points[to]) - complex(points[from]);
            segment / segment.norm()
        };
        let e_sec = unit(site.secondary[0], site.secondary[1]);
        let main = unit(site.corner, site.main_end);
        // m rotated by alpha is e_sec.
        let alpha = cross(main, e_sec).atan2(dot(main, e_sec));
        ensure!(
            alpha > 0.0 && alpha < std::f64::consts::PI,
            "hinge {hinge} has the cut angle {} deg, outside (0, 180): its cuts have collapsed",
            alpha.to_degrees()
        );
        let corner = points[site.corner];
        let hinge = Self {
            site,
            corner,
            tip: corner,
            attachment: corner,
            e_sec: point(e_sec),
            main: point(main),
            w_lig,
            set_back,
            alpha,
            fillet_ratio: options.process.hinge(w_lig, alpha).fillet_ratio,
        };
        Ok(hinge.with_tip(set_back, options.hinge_point))
    }

    /// The hinge with its tip at another distance from the line of the secondary cut (mm).
    fn with_tip(self, set_back: f64, hinge_point: HingePoint) -> Self {
        let along = complex(self.main) * (set_back / self.alpha.sin());
        let tip = point(complex(self.corner) + along);
        Self {
            tip,
            attachment: match hinge_point {
                HingePoint::Corner => self.corner,
                HingePoint::CutTip => tip,
            },
            set_back,
            ..self
        }
    }

    /// Indices of panels A and B.
    pub fn panels(&self) -> [usize; 2] {
        [self.site.a.0, self.site.b.0]
    }

    /// Index of panel A.
    pub fn panel_a(&self) -> usize {
        self.site.a.0
    }

    /// Index of panel B.
    pub fn panel_b(&self) -> usize {
        self.site.b.0
    }
}
