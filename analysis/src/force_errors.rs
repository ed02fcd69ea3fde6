//! Errors of the hinge forces of a sheet that have one cause, and how they move the sheet.
//!
//! An error is a sum of modes, independent of each other and each with the standard deviation one:
//! one mode if it is common to all hinges, one a hinge if hinges err independently. The sheet
//! responds to each mode ([`ForceResponse`]), and the squares of the responses add up to the
//! variance.

use design::equilibrium::force_response::{ForceResponse, SheetChange};
use design::equilibrium::load_step::LoadStep;
use design::hinge_law::LENGTHS;
use design::sheet::cut_sheet::Sheet;
use design::sheet::kinematics::deployed_corners;
use hinge::{HingeDeformation, HingeDesign};
use std::array::from_fn;
use std::f64::consts::PI;
use std::iter::zip;
use support::{Extremes, Point};

/// (F_a, F_s, M_theta) at some hinges, with their indices (N, N, N mm).
pub(crate) type Mode = Vec<(usize, [f64; 3])>;

/// Lengths of (log w_lig, alpha) over which the error of a learned law changes, as [`LENGTHS`] are
/// of the state: about a third of the extent of a training domain.
const DESIGN_LENGTHS: [f64; 2] = [0.5, 0.5];
/// Variance that is left out of alike errors, relative to the variance of a hinge.
const LEFT_OUT: f64 = 1e-3;

/// Independent errors of the hinge forces, each with the standard deviation one.
pub(crate) type Modes = Vec<Mode>;

/// One error of all hinges, along `forces`.
pub(crate) fn common(forces: &[[f64; 3]]) -> Modes {
    vec![forces.iter().copied().enumerate().collect()]
}

/// Independent errors of the hinges, along the force of each.
pub(crate) fn along(forces: &[[f64; 3]]) -> Modes {
    forces.iter().copied().enumerate().map(|hinge| vec![hinge]).collect()
}

/// Independent errors of the hinges in any direction: of the given root mean squares of the norm of
/// (F_a, F_s, M_theta / w_lig) (N).
pub(crate) fn isotropic(sizes: &[f64], designs: &[HingeDesign]) -> Modes {
    let of_hinge = |(h, size): (usize, &f64)| {
        let each = size / 3f64.sqrt();
        (0..3).map(move |i| vec![(h, component(i, each, &designs[h]))])
    };
    sizes.iter().enumerate().flat_map(of_hinge).collect()
}

/// The deviations of several networks from their mean, of which the sample covariance is the
/// estimate; each with one force a hinge.
pub(crate) fn spread(networks: &[Vec<[f64; 3]>]) -> Modes {
    let count = networks.len() as f64;
    let deviation = |forces: &[[f64; 3]], h: usize, i: usize| {
        let mean = networks.iter().map(|forces| forces[h][i]).sum::<f64>() / count;
        (forces[h][i] - mean) / (count - 1.0).sqrt()
    };
    let mode = |forces: &Vec<[f64; 3]>| {
        (0..forces.len()).map(|h| (h, from_fn(|i| deviation(forces, h, i)))).collect()
    };
    networks.iter().map(mode).collect()
}

/// Errors with the standard deviations `sizes` (N) of (F_a, F_s, M_theta / w_lig) at each hinge that
/// are alike at hinges of like design and state: a Gaussian process over both, with the mirror
/// symmetry of hinges.
pub(crate) fn alike(
    sizes: &[[f64; 3]],
    designs: &[HingeDesign],
    states: &[HingeDeformation],
) -> Modes {
    let positions: Vec<HingePosition> = zip(designs, states).map(HingePosition::new).collect();
    let mut modes = Modes::new();
    // F_a and M_theta of the mirror image are the same, F_s has the other sign.
    for (parity, components) in [(1.0, &[0, 2][..]), (-1.0, &[1][..])] {
        let columns =
            factor(positions.len(), |h, k| positions[h].correlation(&positions[k], parity));
        for &i in components {
            modes.extend(columns.iter().map(|column| {
                let error =
                    |(h, part): (usize, &f64)| (h, component(i, part * sizes[h][i], &designs[h]));
                column.iter().enumerate().map(error).collect::<Mode>()
            }));
        }
    }
    modes
}

/// The standard deviations of a sheet at a load step whose response is given: of every panel corner,
/// the root of the sum of the variances along x and y (mm), and of the load that the prescribed
/// displacement takes (N or N mm; `None` under dead loads). `None` if its tangent is singular.
pub(crate) fn deviations(
    modes: &Modes,
    response: &ForceResponse,
    sheet: &Sheet,
    step: &LoadStep,
) -> Option<(Vec<f64>, Option<f64>)> {
    let arms = corner_arms(sheet, step);
    let mut variances = vec![0.0; arms.len()];
    let mut of_load = None;
    for mode in modes {
        let SheetChange { motions, load } = response.to(mode)?;
        for ((panel, [x, y]), variance) in arms.iter().zip(&mut variances) {
            let [u_x, u_y, phi] = motions[*panel];
            *variance += (u_x - phi * y).powi(2) + (u_y + phi * x).powi(2);
        }
        if let Some(load) = load {
            *of_load.get_or_insert(0.0) += load * load;
        }
    }
    Some((variances.into_iter().map(f64::sqrt).collect(), of_load.map(f64::sqrt)))
}

/// A force of `size` (N) in one component of (F_a, F_s, M_theta / w_lig).
fn component(i: usize, size: f64, design: &HingeDesign) -> [f64; 3] {
    let mut force = [0.0; 3];
    force[i] = if i == 2 { size * design.w_lig } else { size };
    force
}

/// The corners of all panels: the panel, and its arm from the reference point of the panel in the
/// deployed sheet (mm).
fn corner_arms(sheet: &Sheet, step: &LoadStep) -> Vec<(usize, Point)> {
    let corners = deployed_corners(sheet, &step.configuration);
    let panels = corners.iter().enumerate().flat_map(|(k, corners)| {
        let ([x, y], [u_x, u_y, _]) = (sheet.panels[k].reference, step.configuration[k]);
        let arm = move |corner: &Point| (k, [corner[0] - x - u_x, corner[1] - y - u_y]);
        corners.iter().map(arm)
    });
    panels.collect()
}

/// Design and state of a hinge and of its mirror image, in units of the lengths.
struct HingePosition {
    own: [f64; 5],
    mirrored: [f64; 5],
}

impl HingePosition {
    fn new((design, state): (&HingeDesign, &HingeDeformation)) -> Self {
        let [eta_a, eta_s] = state.eta(design.w_lig);
        let ([a, s, theta], [width, angle]) = (LENGTHS, DESIGN_LENGTHS);
        let log_width = design.w_lig.ln() / width;
        let at = |eta_s: f64, alpha: f64| {
            [eta_a / a, eta_s / s, state.theta / theta, log_width, alpha / angle]
        };
        Self { own: at(eta_s, design.alpha), mirrored: at(-eta_s, PI - design.alpha) }
    }

    /// The correlation of the errors of two hinges in a quantity that has the sign `parity` in the
    /// mirror image.
    fn correlation(&self, other: &Self, parity: f64) -> f64 {
        let near = |x: &[f64; 5], y: &[f64; 5]| {
            let squares = zip(x, y).map(|(x, y)| (x - y).powi(2));
            (-0.5 * squares.sum::<f64>()).exp()
        };
        let symmetric = near(&self.own, &other.own) + parity * near(&self.own, &other.mirrored);
        let variance = |of: &Self| 1.0 + parity * near(&of.own, &of.mirrored);
        // A hinge that is its own mirror image has no odd error.
        let scale = (variance(self) * variance(other)).sqrt();
        if scale > 0.0 { symmetric / scale } else { 0.0 }
    }
}

/// The columns of L with L L' = K up to [`LEFT_OUT`], by Cholesky's method with pivoting.
fn factor(n: usize, k: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    let mut left: Vec<f64> = (0..n).map(|h| k(h, h)).collect();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    while let Some(pivot) = (0..n).largest_by(|h| left[*h])
        && left[pivot] > LEFT_OUT
    {
        let root = left[pivot].sqrt();
        let entry = |h: usize| {
            let known: f64 = columns.iter().map(|column| column[h] * column[pivot]).sum();
            (k(h, pivot) - known) / root
        };
        let column: Vec<f64> = (0..n).map(entry).collect();
        zip(&mut left, &column).for_each(|(left, part)| *left -= part * part);
        columns.push(column);
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeConstants;

    fn variance(errors: &Modes, h: usize, k: usize, i: usize) -> f64 {
        let at = |mode: &Mode, h: usize| {
            let here = mode.iter().filter(|(hinge, _)| *hinge == h);
            here.map(|(_, force)| force[i]).sum::<f64>()
        };
        let modes = errors.iter();
        modes.map(|mode| at(mode, h) * at(mode, k)).sum()
    }

    fn hinges() -> (Vec<HingeDesign>, Vec<HingeDeformation>) {
        let design = |alpha| HingeConstants::PAPER.hinge(18.0, alpha);
        // A hinge, one far from it, and the mirror image of the first.
        let designs = vec![design(1.3), design(1.3), design(PI - 1.3)];
        let states = [[-2.0, 3.0, 0.5], [-2.0, -10.0, 0.1], [-2.0, -3.0, 0.5]];
        (designs, states.map(HingeDeformation::from).to_vec())
    }

    #[test]
    fn alike_errors_have_their_sizes_and_the_symmetry_of_hinges() {
        let (designs, states) = hinges();
        let sizes = vec![[1.0, 2.0, 3.0]; 3];
        let errors = alike(&sizes, &designs, &states);
        let arms = [1.0, 1.0, 18.0];
        for (i, size, sign) in [(0, 1.0, 1.0), (1, 2.0, -1.0), (2, 3.0, 1.0)] {
            let expected: f64 = f64::powi(size * arms[i], 2);
            for (other, covariance) in [(0, expected), (1, 0.0), (2, sign * expected)] {
                let found = variance(&errors, 0, other, i);
                let error = (found - covariance).abs() / expected;
                assert!(error < 1e-2, "{i}, {other}: {found} {covariance}");
            }
        }
    }

    #[test]
    fn the_spread_of_networks_is_their_sample_covariance() {
        let networks = [[1.0, 4.0], [2.0, 2.0], [6.0, 3.0]];
        let networks = networks.map(|[one, two]| vec![[one, 0.0, 0.0], [two, 0.0, 0.0]]);
        let errors = spread(&networks);
        assert!((variance(&errors, 0, 0, 0) - 7.0).abs() < 1e-12);
        assert!((variance(&errors, 0, 1, 0) + 0.5).abs() < 1e-12);
    }
}
