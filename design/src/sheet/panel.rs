//! A rigid panel of the flat sheet: its centroid, its area and their derivatives.

use crate::geometry::plane::{I, complex, cross, dot, point};
use faer::c64;
use support::fault::{Fault, fault};

/// A point of a panel in the flat sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum PanelPoint {
    /// The centroid of the area.
    #[default]
    Centroid,
    /// The middle between two corners.
    Middle([usize; 2]),
    /// A point that does not move with the cuts (mm).
    Fixed([f64; 2]),
}

/// A rigid panel in the flat sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// SW, SE, NE, NW (mm).
    pub corners: [[f64; 2]; 4],
    /// The point whose motion is (u_x, u_y), where the panel is held or pulled.
    pub point: PanelPoint,
    /// Its position (mm).
    pub reference: [f64; 2],
    /// The centroid of the area (mm).
    pub centroid: [f64; 2],
    /// mm^2
    pub area: f64,
}

impl Panel {
    pub(super) fn new(panel: usize, corners: [[f64; 2]; 4]) -> Result<Self, Fault> {
        let mean = corners.map(complex).iter().sum::<c64>() / 4.0;
        let arms = corners.map(|corner| complex(corner) - mean);
        let sectors = sectors(&arms);
        let area = 0.5 * sectors.iter().sum::<f64>();
        if !(area > 0.0 && area.is_finite()) {
            let what = format!("panel {panel} has the area {area} mm^2, which must be positive");
            return Err(fault("", what, "its cuts have collapsed"));
        }
        let moment: c64 = (0..4).map(|j| (arms[j] + arms[(j + 1) % 4]) * sectors[j]).sum();
        let centroid = point(mean + moment / (6.0 * area));
        Ok(Self { corners, point: PanelPoint::Centroid, reference: centroid, centroid, area })
    }

    /// The position of a point of the panel in the flat sheet (mm).
    pub fn position(&self, point: PanelPoint) -> [f64; 2] {
        match point {
            PanelPoint::Centroid => self.centroid,
            PanelPoint::Middle([from, to]) => {
                [0, 1].map(|c| 0.5 * (self.corners[from][c] + self.corners[to][c]))
            }
            PanelPoint::Fixed(position) => position,
        }
    }

    /// Centroid-to-corner vectors.
    fn arms(&self) -> [c64; 4] {
        self.corners.map(|corner| complex(corner) - complex(self.centroid))
    }

    /// The gradient in the corners of a function with the given gradient in a point.
    pub(super) fn pullback(&self, point: PanelPoint, gradient: [f64; 2]) -> [c64; 4] {
        match point {
            PanelPoint::Centroid => self.centroid_pullback(gradient),
            PanelPoint::Middle(ends) => {
                let mut corners = [c64::ZERO; 4];
                for corner in ends {
                    corners[corner] += complex(gradient) / 2.0;
                }
                corners
            }
            PanelPoint::Fixed(_) => [c64::ZERO; 4],
        }
    }

    /// The gradient in the corners of a function with the given derivative in the area.
    pub(super) fn area_pullback(&self, derivative: f64) -> [c64; 4] {
        let corner = |j: usize| complex(self.corners[j % 4]);
        std::array::from_fn(|j| -0.5 * derivative * I * (corner(j + 1) - corner(j + 3)))
    }

    /// The gradient in the corners of a function with the given gradient in the centroid.
    ///
    /// Let p_j be the vectors from the centroid and S_j = p_j x p_(j+1). The centroid moves by
    /// sum_j [(dp_j + dp_(j+1)) S_j + (p_j + p_(j+1)) dS_j] / (3 sum_j S_j).
    fn centroid_pullback(&self, gradient: [f64; 2]) -> [c64; 4] {
        let gradient = complex(gradient);
        let arms = self.arms();
        let sectors = sectors(&arms);
        let scaled = gradient / (3.0 * sectors.iter().sum::<f64>());
        let mut corners = [c64::ZERO; 4];
        for j in 0..4 {
            let next = (j + 1) % 4;
            let by_sector = dot(scaled, arms[j] + arms[next]);
            corners[j] += scaled * sectors[j] - I * arms[next] * by_sector;
            corners[next] += scaled * sectors[j] + I * arms[j] * by_sector;
        }
        corners
    }
}

/// Twice the signed areas of the triangles between the origin and the panel's edges.
fn sectors(arms: &[c64; 4]) -> [f64; 4] {
    std::array::from_fn(|j| cross(arms[j], arms[(j + 1) % 4]))
}
