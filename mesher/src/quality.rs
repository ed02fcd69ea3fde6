//! What a mesh must satisfy before a solver is started on it.

use crate::mesh::WindowMesh;
use crate::msh::{Boundary, sides};
use crate::window::Window;

/// Largest accepted ratio of an element's in-plane edges.
const MAX_ASPECT: f64 = 40.0;
/// Largest accepted relative error of the meshed area. A quadratic edge that turns by 80 deg, the
/// coarsest there is, loses 0.3 % of the window.
const MAX_AREA_ERROR: f64 = 0.01;

/// Measures of a mesh that passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshQuality {
    /// Smallest over largest Jacobian determinant within an element, at the Gauss points; in (0, 1].
    pub jacobian_ratio: f64,
    /// Largest ratio of the in-plane edges of an element.
    pub aspect: f64,
    /// Meshed volume over thickness (mm^2).
    pub area: f64,
    /// |area - exact| / exact.
    pub area_error: f64,
}

/// Why a mesh is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshDefect {
    #[error("element {element} is folded: its Jacobian is {jacobian} mm^3 at a Gauss point")]
    Folded { element: usize, jacobian: f64 },
    #[error("element {element} is a sliver: its edges differ by a factor {aspect} > {MAX_ASPECT}")]
    Sliver { element: usize, aspect: f64 },
    #[error("the mesh covers {area} mm^2, the window {exact} mm^2")]
    Area { area: f64, exact: f64 },
    #[error("no edge lies on {0:?}")]
    NoBoundary(Boundary),
}

impl WindowMesh {
    /// Measures the mesh, or says what is wrong with it.
    pub fn quality(&self) -> Result<MeshQuality, MeshDefect> {
        for boundary in [Boundary::ArcA, Boundary::ArcB] {
            if self.plane.edges.iter().all(|(of, _)| *of != boundary) {
                return Err(MeshDefect::NoBoundary(boundary));
            }
        }
        let kind = self.recipe.element();
        let mut jacobian_ratio = 1.0_f64;
        for (element, volumes) in self.gauss_volumes.iter().enumerate() {
            let jacobians = (0..)
                .zip(volumes)
                .map(|(point, v)| v / kind.gauss_weight(point));
            let least = jacobians.clone().fold(f64::INFINITY, f64::min);
            let greatest = jacobians.fold(0.0, f64::max);
            if least <= 0.0 || least.is_nan() {
                let jacobian = least;
                return Err(MeshDefect::Folded { element, jacobian });
            }
            jacobian_ratio = jacobian_ratio.min(least / greatest);
        }
        let mut largest_aspect = 1.0_f64;
        for (element, face) in self.plane.faces.iter().enumerate() {
            let lengths = sides(face).map(|[from, to, _]| {
                let [p, q] = [from, to].map(|node| self.plane.nodes[node]);
                (q[0] - p[0]).hypot(q[1] - p[1])
            });
            let longest = lengths.clone().fold(0.0, f64::max);
            let aspect = longest / lengths.fold(f64::INFINITY, f64::min);
            if aspect > MAX_ASPECT {
                return Err(MeshDefect::Sliver { element, aspect });
            }
            largest_aspect = largest_aspect.max(aspect);
        }
        let (area, exact) = (self.volume() / self.thickness, Window(&self.design).area());
        let area_error = (area - exact).abs() / exact;
        if area_error > MAX_AREA_ERROR {
            return Err(MeshDefect::Area { area, exact });
        }
        Ok(MeshQuality {
            jacobian_ratio,
            aspect: largest_aspect,
            area,
            area_error,
        })
    }
}
