//! Displacement, plastic strain and stress of a solved window as a VTK grid.
//!
//! CalculiX prints strain and stress at the Gauss points. A cell of the grid has their means by
//! volume, and the maximum of the plastic strain; nothing is extrapolated to the nodes.

use crate::{Frame, WindowModel};
use mesher::vtk_grid;
use support::vtk::{Field, UnstructuredGrid};

/// Places of VTK's components XX, YY, ZZ, XY, YZ, XZ in a printed stress (xx, yy, zz, xy, xz, yz).
const VTK_ORDER: [usize; 6] = [0, 1, 2, 3, 5, 4];

impl WindowModel<'_> {
    /// The undeformed window with the fields of an increment that printed the displacements of all
    /// nodes.
    pub(crate) fn grid(&self, frame: &Frame) -> UnstructuredGrid {
        let points = self.mesh.recipe.element().gauss_points();
        let strains = || frame.peeq.chunks(points);
        let volumes = || self.mesh.gauss_volumes.iter();
        let mean = |values: &dyn Fn(usize) -> f64, volumes: &[f64]| {
            let sum: f64 = volumes.iter().enumerate().map(|(i, volume)| values(i) * volume).sum();
            sum / volumes.iter().sum::<f64>()
        };
        let plastic: Vec<f64> = std::iter::zip(strains(), volumes())
            .map(|(strain, volumes)| mean(&|i| strain[i], volumes))
            .collect();
        let stresses: Vec<[f64; 6]> = std::iter::zip(frame.stress.chunks(points), volumes())
            .map(|(stress, volumes)| VTK_ORDER.map(|c| mean(&|i| stress[i][c], volumes)))
            .collect();
        let most = || strains().map(|strain| strain.iter().copied().fold(0.0, f64::max));
        let fracture = self.material.fracture_strain;
        let displacements = frame.displacements.iter().copied();
        UnstructuredGrid {
            point_data: vec![Field::vector("displacement (mm)", displacements)],
            cell_data: vec![
                Field::scalar("plastic strain", plastic.iter().copied()),
                Field::scalar("plastic strain, maximum", most()),
                Field::scalar("local D", plastic.iter().map(|strain| strain / fracture)),
                Field::scalar("local D, maximum", most().map(|strain| strain / fracture)),
                Field::vector("stress (MPa)", stresses.iter().copied()),
                Field::scalar("von Mises stress (MPa)", stresses.iter().map(von_mises)),
            ],
            ..vtk_grid(self.mesh)
        }
    }
}

/// The equivalent stress of (xx, yy, zz, xy, yz, xz).
fn von_mises([xx, yy, zz, xy, yz, xz]: &[f64; 6]) -> f64 {
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + xz * xz)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_and_shear_stress_have_their_equivalents() {
        assert_eq!(von_mises(&[3.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 3.0);
        assert!((von_mises(&[0.0, 0.0, 0.0, 0.0, 2.0, 0.0]) - 12.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(von_mises(&[5.0, 5.0, 5.0, 0.0, 0.0, 0.0]), 0.0);
    }
}
