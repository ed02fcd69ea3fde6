//! A rigid panel of the flat sheet: its centroid, its area and their derivatives.

use crate::geometry::plane::{I, complex, cross, dot, point};
use crate::geometry::region::Ring;
use crate::pattern::grid::{NW, SE, SW};
use crate::sheet::topology::Trim;
use faer::c64;
use std::array::from_fn;
use support::{Fault, Point, ensure};

/// A point of a panel in the flat sheet.
#[derive(Clone, Copy, Debug, Default)]
pub enum PanelPoint {
    /// The centroid of the area.
    #[default]
    Centroid,
    /// The middle between two corners.
    Middle([usize; 2]),
    /// A point that does not move with the cuts (mm).
    Fixed(Point),
}

/// A rigid panel in the flat sheet.
#[derive(Clone, Debug)]
pub struct Panel {
    /// SW, SE, NE, NW of its cell (mm).
    pub corners: [Point; 4],
    /// The polygon that it is, counter-clockwise: the corners, unless it is trimmed (mm).
    pub boundary: Vec<Point>,
    pub(crate) trim: Option<Trim>,
    /// The point whose motion is (u_x, u_y), where the panel is held or pulled.
    pub point: PanelPoint,
    /// Its position (mm).
    pub reference: Point,
    /// The centroid of the area (mm).
    pub centroid: Point,
    /// mm^2
    pub area: f64,
}

impl Panel {
    pub(super) fn new(
        panel: usize,
        corners: [Point; 4],
        trim: Option<Trim>,
    ) -> Result<Self, Fault> {
        let boundary = boundary(&corners, trim.as_ref());
        let mean = boundary.iter().copied().map(complex).sum::<c64>() / boundary.len() as f64;
        let arms: Vec<c64> = boundary.iter().map(|corner| complex(*corner) - mean).collect();
        let sectors = sectors(&arms);
        let area = 0.5 * sectors.iter().sum::<f64>();
        ensure!(
            area > 0.0 && area.is_finite(),
            "panel {panel} has the area {area} mm^2, which must be positive: its cuts have collapsed"
        );
        let next = |j: usize| (j + 1) % arms.len();
        let moment: c64 = (0..arms.len()).map(|j| (arms[j] + arms[next(j)]) * sectors[j]).sum();
        let centroid = point(mean + moment / (6.0 * area));
        Ok(Self {
            corners,
            boundary,
            trim,
            point: PanelPoint::Centroid,
            reference: centroid,
            centroid,
            area,
        })
    }

    /// Whether the panel is not its cell.
    pub fn is_trimmed(&self) -> bool {
        self.trim.is_some()
    }

    /// Whether a corner of its cell is a corner of the panel.
    pub fn has_corner(&self, corner: usize) -> bool {
        const CORNERS: [Point; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        self.trim.as_ref().is_none_or(|trim| trim.contains(&CORNERS[corner]))
    }

    /// The position of a point of the panel in the flat sheet (mm).
    pub fn position(&self, point: PanelPoint) -> Point {
        match point {
            PanelPoint::Centroid => self.centroid,
            PanelPoint::Middle([from, to]) => {
                [0, 1].map(|c| 0.5 * (self.corners[from][c] + self.corners[to][c]))
            }
            PanelPoint::Fixed(position) => position,
        }
    }

    /// The gradient in the corners of a function with the given gradient in one point of the
    /// boundary.
    pub(crate) fn corner_pullback(&self, point: usize, gradient: c64) -> [c64; 4] {
        let [south_east, north_west] = match &self.trim {
            None => return from_fn(|corner| f64::from(corner == point) * gradient),
            Some(trim) => trim[point],
        };
        let mut corners = [c64::ZERO; 4];
        corners[SW] = gradient * (1.0 - south_east - north_west);
        corners[SE] = gradient * south_east;
        corners[NW] = gradient * north_west;
        corners
    }

    /// The same with a gradient in each point of the boundary.
    fn boundary_pullback(&self, gradients: &[c64]) -> [c64; 4] {
        let by_points = gradients.iter().enumerate();
        by_points.fold([c64::ZERO; 4], |sum, (point, gradient)| {
            let corners = self.corner_pullback(point, *gradient);
            from_fn(|corner| sum[corner] + corners[corner])
        })
    }

    /// The gradient in the corners of a function with the given gradient in a point.
    pub(super) fn pullback(&self, point: PanelPoint, gradient: c64) -> [c64; 4] {
        match point {
            PanelPoint::Centroid => self.centroid_pullback(gradient),
            PanelPoint::Middle(ends) => {
                let mut corners = [c64::ZERO; 4];
                for corner in ends {
                    corners[corner] += gradient / 2.0;
                }
                corners
            }
            PanelPoint::Fixed(_) => [c64::ZERO; 4],
        }
    }

    /// The gradient in the corners of a function with the given derivative in the area.
    pub(super) fn area_pullback(&self, derivative: f64) -> [c64; 4] {
        let count = self.boundary.len();
        let corner = |j: usize| complex(self.boundary[j % count]);
        let along = |j: usize| corner(j + 1) - corner(j + count - 1);
        let by_boundary: Vec<c64> = (0..count).map(|j| -0.5 * derivative * I * along(j)).collect();
        self.boundary_pullback(&by_boundary)
    }

    /// The gradient in the corners of a function with the given gradient in the centroid.
    ///
    /// Let p_j be the vectors from the centroid and S_j = p_j x p_(j+1). The centroid moves by
    /// sum_j [(dp_j + dp_(j+1)) S_j + (p_j + p_(j+1)) dS_j] / (3 sum_j S_j).
    fn centroid_pullback(&self, gradient: c64) -> [c64; 4] {
        let arm = |corner: &Point| complex(*corner) - complex(self.centroid);
        let arms: Vec<c64> = self.boundary.iter().map(arm).collect();
        let sectors = sectors(&arms);
        let scaled = gradient / (3.0 * sectors.iter().sum::<f64>());
        let mut by_boundary = vec![c64::ZERO; arms.len()];
        for j in 0..arms.len() {
            let next = (j + 1) % arms.len();
            let by_sector = dot(scaled, arms[j] + arms[next]);
            by_boundary[j] += scaled * sectors[j] - I * arms[next] * by_sector;
            by_boundary[next] += scaled * sectors[j] + I * arms[j] * by_sector;
        }
        self.boundary_pullback(&by_boundary)
    }
}

/// The polygon that a panel is, counter-clockwise (mm).
pub fn boundary(corners: &[Point; 4], trim: Option<&Trim>) -> Ring {
    let along = |c: usize, to: usize| corners[to][c] - corners[SW][c];
    let in_cell =
        |[x, y]: &Point| [0, 1].map(|c| corners[SW][c] + x * along(c, SE) + y * along(c, NW));
    trim.map_or_else(|| corners.to_vec(), |trim| trim.iter().map(in_cell).collect())
}

/// Twice the signed areas of the triangles between the origin and the panel's edges.
fn sectors(arms: &[c64]) -> Vec<f64> {
    (0..arms.len()).map(|j| cross(arms[j], arms[(j + 1) % arms.len()])).collect()
}
