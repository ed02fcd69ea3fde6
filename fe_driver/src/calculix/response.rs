//! Converts printed frames to hinge samples: energy, work, forces, damage.

use crate::{OutputFrame, PanelMotion, WindowModel, rotated};
use hinge::{HingeDeformation, HingeDesign, HingeSample, SheetMaterial};
use mesher::WindowMesh;
use std::f64::consts::PI;

/// D_peak is the mean over the most strained part of the window whose volume is this fraction of
/// the ligament's half-disc volume.
const PEAK_FRACTION: f64 = 0.01;

/// One sample per frame, in the order of the frames.
pub(crate) fn samples(model: &WindowModel, frames: &[OutputFrame]) -> Vec<HingeSample> {
    let (mesh, material) = (model.mesh, model.material);
    let mut before = [[0.0; 3]; 2];
    let energies = frames.iter().map(|frame| frame.energy.abs());
    let largest_w = energies.fold(f64::MIN_POSITIVE, f64::max);
    let mut w_work = 0.0;
    frames
        .iter()
        .map(|frame| {
            let deformation = model.path.at(frame.lambda);
            let forces = arc_forces(mesh, &deformation, &frame.reactions);
            let state = [deformation.to_array(), forces];
            w_work += trapezoid(before, state);
            before = state;
            let [f_a, f_s, m_theta] = forces;
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
                f_a,
                f_s,
                m_theta,
                plastic_integral: damage.plastic_integral,
                d: damage.d,
                d_peak: Some(damage.d_peak),
                uz_max: (frame.displacements.iter().take(mesh.bottom.len()))
                    .fold(0.0, |most, [_, _, uz]| uz.abs().max(most)),
                energy_residual: (frame.energy - w_work).abs() / largest_w,
            }
        })
        .collect()
}

/// The forces conjugate to (a, s, theta), from the resultant of the reactions on arc B and their
/// moment about the current position of O on panel B.
fn arc_forces(
    mesh: &WindowMesh,
    deformation: &HingeDeformation,
    reactions: &[(usize, [f64; 3])],
) -> [f64; 3] {
    let tip = mesh.design.tip();
    let (mut force, mut moment) = ([0.0; 2], 0.0);
    for (node, [fx, fy, _]) in reactions {
        let [x, y, _] = mesh.nodes[*node];
        let arm = rotated([x - tip[0], y - tip[1]], deformation.theta);
        force[0] += fx;
        force[1] += fy;
        moment += arm[0] * fy - arm[1] * fx;
    }
    PanelMotion::new(deformation).forces(force, moment)
}

/// Work between two states: mean force times change of deformation.
fn trapezoid([from, force_from]: [[f64; 3]; 2], [to, force_to]: [[f64; 3]; 2]) -> f64 {
    (0..3).map(|i| 0.5 * (force_from[i] + force_to[i]) * (to[i] - from[i])).sum()
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

/// Damage measures of a hinge from its accumulated plastic strain; see the fields of
/// [`HingeSample`].
pub(crate) struct Damage {
    plastic_integral: f64,
    pub d: f64,
    pub d_peak: f64,
}

impl Damage {
    /// Evaluates (strain, volume) at the Gauss points of the window.
    pub(crate) fn new(
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
        }
    }
}

/// The mean strain over the first `volume` of `points`, each (strain, volume). Only the required
/// part of the last point's volume is counted.
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
        let state = |x: f64| [[x, 2.0 * x, 0.5 * x], [3.0 * x, 2.0 * x, 7.0 * x]];
        let work = trapezoid(state(0.0), state(0.3)) + trapezoid(state(0.3), state(1.0));
        assert!((work - 0.5 * (3.0 + 4.0 + 3.5)).abs() < 1e-14);
    }
}
