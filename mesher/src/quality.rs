//! The checks that a mesh must pass before it is solved.

use crate::{Boundary, ElementKind, PlaneMesh, Window, WindowMesh, sides};
use support::fault::Fault;
use support::{fault, refuse};

/// Maximum accepted ratio of the longest to the shortest in-plane edge of an element.
const MAX_ASPECT: f64 = 40.0;
/// Maximum accepted relative error of the meshed area. A quadratic edge over an arc of 80 deg, the
/// coarsest in use, has an error of 0.3 % of the window.
pub(crate) const MAX_AREA_ERROR: f64 = 0.01;

/// Quality measures of a mesh that passed the checks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshQuality {
    /// Minimum over all elements of the ratio of the smallest to the largest Jacobian determinant
    /// at the Gauss points of an element; in (0, 1].
    pub jacobian_ratio: f64,
    /// Maximum ratio of the longest to the shortest in-plane edge of an element.
    pub aspect: f64,
    /// Meshed volume divided by the thickness (mm^2).
    pub area: f64,
    /// |area - exact| / exact.
    pub area_error: f64,
}

impl WindowMesh {
    /// Returns the quality measures of the mesh, or its first defect.
    pub fn quality(&self) -> Result<MeshQuality, Fault> {
        for boundary in [Boundary::ArcA, Boundary::ArcB] {
            if self.plane.edges.iter().all(|(of, _)| *of != boundary) {
                refuse!("the mesh has no edge on {boundary:?}");
            }
        }
        let (jacobian_ratio, largest_aspect) = check_elements(&self.plane, &self.gauss_volumes)?;
        let (area, exact) = (self.volume() / self.thickness, Window(&self.design).area());
        let area_error = (area - exact).abs() / exact;
        if area_error > MAX_AREA_ERROR {
            return Err(wrong_area(area, exact));
        }
        Ok(MeshQuality { jacobian_ratio, aspect: largest_aspect, area, area_error })
    }
}

pub(crate) fn wrong_area(area: f64, exact: f64) -> Fault {
    fault!("the area of the mesh is {area} mm^2, but its shape has {exact} mm^2")
}

/// The minimum ratio of Jacobians and the maximum aspect ratio of solid elements, layers of the
/// faces of a plane mesh, or their first defect.
pub(crate) fn check_elements(
    plane: &PlaneMesh,
    gauss_volumes: &[Vec<f64>],
) -> Result<(f64, f64), Fault> {
    let mut jacobian_ratio = 1.0_f64;
    for (element, volumes) in gauss_volumes.iter().enumerate() {
        let kind = ElementKind::of(&plane.faces[element % plane.faces.len()]);
        let jacobians = (0..).zip(volumes).map(|(point, v)| v / kind.gauss_weight(point));
        let minimum = jacobians.clone().fold(f64::INFINITY, f64::min);
        let maximum = jacobians.fold(0.0, f64::max);
        if minimum <= 0.0 || minimum.is_nan() {
            refuse!("element {element} is folded: its Jacobian is {minimum} mm^3 at a Gauss point");
        }
        jacobian_ratio = jacobian_ratio.min(minimum / maximum);
    }
    let mut largest_aspect = 1.0_f64;
    for (element, face) in plane.faces.iter().enumerate() {
        let lengths = sides(face).map(|[from, to, _]| {
            let [p, q] = [from, to].map(|node| plane.nodes[node]);
            (q[0] - p[0]).hypot(q[1] - p[1])
        });
        let longest = lengths.clone().fold(0.0, f64::max);
        let aspect = longest / lengths.fold(f64::INFINITY, f64::min);
        if aspect > MAX_ASPECT {
            refuse!(
                "element {element} is a sliver: the ratio of its longest to its shortest edge is {aspect} > {MAX_ASPECT}"
            );
        }
        largest_aspect = largest_aspect.max(aspect);
    }
    Ok((jacobian_ratio, largest_aspect))
}
