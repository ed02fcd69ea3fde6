//! Converts printed frames to hinge samples: energy, work, forces, damage.

use crate::calculix::dat::Frame;
use crate::calculix::model::WindowModel;
use crate::calculix::panel_motion::{PanelMotion, rotated};
use crate::solve::lean::Lean;
use hinge::{
    HingeDeformation, HingeDesign, HingeForces, HingeSample, SheetMaterial, StrainVolumes,
};
use mesher::WindowMesh;
use std::f64::consts::PI;

/// D_peak is the mean over the most strained part of the window whose volume is this fraction of the ligament's
/// half-disc volume.
const PEAK_FRACTION: f64 = 0.01;

/// One sample per frame, in the order of the frames.
pub(crate) fn samples(model: &WindowModel, frames: &[Frame]) -> Vec<HingeSample> {
    let (mesh, material) = (model.mesh, model.material);
    let mut before = Driven::default();
    let energies = frames.iter().map(|frame| frame.energy.abs());
    let largest_w = energies.fold(f64::MIN_POSITIVE, f64::max);
    let mut w_work = 0.0;
    frames
        .iter()
        .map(|frame| {
            let lean = model.lean.unwrap_or_default().at(frame.lambda);
            let driven = Driven::new(mesh, model.path.at(frame.lambda), lean, &frame.reactions);
            w_work += driven.work_since(&before);
            let Driven {
                deformation,
                forces,
                ..
            } = driven;
            let [f_z, m_x, m_y] = driven.out_of_plane;
            before = driven;
            let volumes = mesh.gauss_volumes.iter().flatten().copied();
            let points = frame.peeq.iter().copied().zip(volumes).collect();
            let damage = Damage::new(points, &mesh.design, mesh.thickness, material);
            HingeSample {
                lambda: frame.lambda,
                a: deformation.a,
                s: deformation.s,
                theta: deformation.theta,
                w: frame.energy,
                w_work,
                w_elastic: elastic_energy(mesh, material, &frame.stress),
                f_a: forces.f_a,
                f_s: forces.f_s,
                m_theta: forces.m_theta,
                f_z: Some(f_z),
                m_x: Some(m_x),
                m_y: Some(m_y),
                plastic_integral: damage.plastic_integral,
                d: damage.d,
                d_window: damage.plastic_integral / (material.fracture_strain * mesh.volume()),
                d_peak: Some(damage.d_peak),
                strain_max: Some(damage.strain_max),
                strain_volumes: Some(damage.strain_volumes),
                uz_max: (frame.displacements.iter().take(mesh.bottom.len()))
                    .fold(0.0, |most, [_, _, uz]| uz.abs().max(most)),
                energy_residual: (frame.energy - w_work).abs() / largest_w,
            }
        })
        .collect()
}

/// What panel B does, and the forces conjugate to it.
#[derive(Clone, Copy, Default)]
struct Driven {
    deformation: HingeDeformation,
    lean: Lean,
    forces: HingeForces,
    /// Force out of the plane, and moments about O on panel B and the axes that turn with it.
    out_of_plane: [f64; 3],
}

impl Driven {
    /// From the reactions on arc B.
    fn new(
        mesh: &WindowMesh,
        deformation: HingeDeformation,
        lean: Lean,
        reactions: &[(usize, [f64; 3])],
    ) -> Self {
        let tip = mesh.design.tip();
        // In the axes that turn with panel B.
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for (node, [f_x, f_y, f_z]) in reactions {
            let [x, y, z] = mesh.nodes[*node];
            let flat = [x - tip[0], y - tip[1], z];
            let mut arm = lean.displacement(flat);
            arm[2] -= lean.lift;
            (0..3).for_each(|i| arm[i] += flat[i]);
            let [f_x, f_y] = rotated([*f_x, *f_y], -deformation.theta);
            let f = [f_x, f_y, *f_z];
            for i in 0..3 {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                force[i] += f[i];
                moment[i] += arm[j] * f[k] - arm[k] * f[j];
            }
        }
        let [f_x, f_y, f_z] = force;
        let [m_x, m_y, m_z] = moment;
        let in_plane = rotated([f_x, f_y], deformation.theta);
        Self {
            deformation,
            lean,
            forces: PanelMotion::new(&deformation).forces(in_plane, m_z),
            out_of_plane: [f_z, m_x, m_y],
        }
    }

    /// Work from another state to this one: mean force times change of motion.
    fn work_since(&self, before: &Self) -> f64 {
        let conjugate = |of: &Self| {
            let [lift, x, y] = of.out_of_plane;
            let motion = of.deformation.to_array();
            let [by_x, by_y] = of.lean.tilt;
            let forces = of.forces.to_array();
            [
                (motion[0], forces[0]),
                (motion[1], forces[1]),
                (motion[2], forces[2]),
                (of.lean.lift, lift),
                (by_x, x),
                (by_y, y),
            ]
        };
        std::iter::zip(conjugate(before), conjugate(self))
            .map(|((from, f), (to, g))| 0.5 * (f + g) * (to - from))
            .sum()
    }
}

/// Integral of sigma : C^-1 : sigma / 2 over the window (N mm), assuming small elastic strains.
fn elastic_energy(mesh: &WindowMesh, material: &SheetMaterial, stress: &[[f64; 6]]) -> f64 {
    let (young, poisson) = (material.young, material.poisson);
    mesh.gauss_volumes
        .iter()
        .flatten()
        .zip(stress)
        .map(|(volume, [xx, yy, zz, xy, xz, yz])| {
            let trace = xx + yy + zz;
            let square = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + xz * xz + yz * yz);
            volume * ((1.0 + poisson) * square - poisson * trace * trace) / (2.0 * young)
        })
        .sum()
}

/// Damage measures of a hinge from its accumulated plastic strain; see the fields of [`HingeSample`].
pub(crate) struct Damage {
    plastic_integral: f64,
    pub d: f64,
    pub d_peak: f64,
    strain_max: f64,
    strain_volumes: StrainVolumes,
}

impl Damage {
    /// From (strain, volume) at the Gauss points of its window.
    pub fn new(
        mut points: Vec<(f64, f64)>,
        design: &HingeDesign,
        thickness: f64,
        material: &SheetMaterial,
    ) -> Self {
        points.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        let plastic_integral = points.iter().map(|(strain, volume)| strain * volume).sum();
        let ligament = 0.5 * PI * design.w_lig.powi(2) * thickness;
        let fracture = material.fracture_strain;
        Self {
            plastic_integral,
            d: plastic_integral / (fracture * ligament),
            d_peak: mean_of_first(&points, PEAK_FRACTION * ligament) / fracture,
            strain_max: points.first().map_or(0.0, |(strain, _)| *strain),
            strain_volumes: StrainVolumes::from_points(points),
        }
    }
}

/// The mean strain over the first `volume` of `points`, each (strain, volume). Only the required part of the
/// last point's volume is counted.
fn mean_of_first(points: &[(f64, f64)], volume: f64) -> f64 {
    let mut left = volume;
    let mut sum = 0.0;
    for (strain, own) in points {
        let part = own.min(left);
        sum += strain * part;
        left -= part;
    }
    sum / volume
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_the_mean_over_a_fixed_volume() {
        let points = [(0.4, 0.5), (0.1, 1.5), (0.0, 98.0)];
        assert_eq!(mean_of_first(&points, 0.25), 0.4);
        assert!((mean_of_first(&points, 1.0) - 0.25).abs() < 1e-15);
        assert!((mean_of_first(&points, 4.0) - 0.0875).abs() < 1e-15);
        // Splitting a point changes nothing.
        let split = [(0.4, 0.2), (0.4, 0.3), (0.1, 1.5)];
        assert!((mean_of_first(&split, 1.0) - 0.25).abs() < 1e-15);
        // Volume that the points do not cover counts as unstrained.
        assert_eq!(mean_of_first(&points[..1], 1.0), 0.2);
    }

    #[test]
    fn the_trapezoid_is_exact_for_a_linear_force() {
        let state = |x: f64| Driven {
            deformation: [x, 2.0 * x, 0.5 * x].into(),
            forces: HingeForces {
                f_a: 3.0 * x,
                f_s: 2.0 * x,
                m_theta: 7.0 * x,
            },
            lean: Lean {
                lift: 0.1 * x,
                tilt: [0.0, 0.2 * x],
            },
            out_of_plane: [4.0 * x, 9.0 * x, 5.0 * x],
        };
        let [start, middle, end] = [0.0, 0.3, 1.0].map(state);
        let work = middle.work_since(&start) + end.work_since(&middle);
        assert!((work - 0.5 * (3.0 + 4.0 + 3.5 + 0.4 + 1.0)).abs() < 1e-14);
    }
}
