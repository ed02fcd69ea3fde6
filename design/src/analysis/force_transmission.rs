//! How a deployed sheet transmits its loads from panel to panel; section 3.2, Table 1.
//!
//! Every hinge is an interface of two panels. In the frame of (a, s, theta) its force has a normal component
//! f_n = dW/da, positive in tension, and a tangential component f_t = dW/ds. The transmitted force is the sum of
//! |f_n| and |f_t| over the interfaces. With the springs of (11) the energy of an interface splits into
//! f_n a / 2, f_s s / 2 and M theta / 2, the last being rotational. For other laws these products are not
//! energies, and only the fractions of the force are meaningful.

use crate::hinge_law::Order;
use crate::objective::design_problem::{Deployment, DesignError, DesignProblem};
use crate::sheet::cut_sheet::Panel;
use crate::sheet::kinematics::{HingeMotion, deployed};

/// One hinge of the deployed sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// Panels A and B.
    pub panels: [usize; 2],
    /// Deployed position of the hinge on panel A (mm).
    pub at: [f64; 2],
    /// f_n (N), positive in tension.
    pub normal: f64,
    /// f_t (N).
    pub tangential: f64,
    /// f_n a / 2 + f_s s / 2: the energy stored in opening and shear (N mm).
    pub translational: f64,
    /// M theta / 2: the energy stored in rotation (N mm).
    pub rotational: f64,
}

/// The interfaces of a deployed sheet and the deployed positions of its panels.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceTransmission {
    /// One per hinge.
    pub interfaces: Vec<Interface>,
    /// Deployed centroids (mm).
    pub centroids: Vec<[f64; 2]>,
    /// The moment transmitted through each panel.
    pub moments: Vec<PanelMoment>,
    /// Areas of the panels (mm^2).
    pub areas: Vec<f64>,
}

/// The moment transmitted through a panel, read in three ways (N mm): half the sum of the magnitudes of the moments that
/// act on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PanelMoment {
    /// Of the interfaces, each with its force and its rotational spring, and of the couple on the panel, which balances
    /// them, about its reference point.
    pub interfaces: f64,
    /// Of the rotational springs alone.
    pub springs: f64,
    /// Of the forces of the interfaces alone, about the reference point.
    pub forces: f64,
}

/// Fractions of the total, each in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransmissionShares {
    /// Fraction of the transmitted force that is tension.
    pub tension: f64,
    /// Fraction of the transmitted force that is compression.
    pub compression: f64,
    /// Fraction of the transmitted force that is shear.
    pub shear: f64,
    /// Fraction of the energy that is stored in rotation.
    pub rotation: f64,
    /// In the quarter of interfaces with the largest force: fraction of the energy not stored in rotation.
    pub non_rotational: f64,
}

/// Fraction of the interfaces or panels that are considered strongly loaded.
const STRONG: f64 = 0.25;
/// Fraction of the panels that are considered to carry the moment.
const MOMENT_PANELS: f64 = 0.1;

impl Interface {
    /// Magnitude of the force (N).
    pub fn force(&self) -> f64 {
        self.normal.hypot(self.tangential)
    }
}

impl ForceTransmission {
    /// At full load of a deployment of `problem`, whose model must be an equilibrium.
    pub fn new(problem: &DesignProblem, deployment: &Deployment) -> Result<Self, DesignError> {
        let mechanics = problem.model.mechanics().ok_or(DesignError::NoMechanics)?;
        let (sheet, last) = (&deployment.sheet, deployment.final_step());
        let law = mechanics.law.prepare(&sheet.designs());
        let energies = law.energies(&last.deformations, Order::Forces);
        let mut moments = vec![PanelMoment::default(); sheet.panels.len()];
        let mut couples = vec![0.0; sheet.panels.len()];
        for (h, (hinge, energy)) in std::iter::zip(&sheet.hinges, &energies).enumerate() {
            let motion = HingeMotion::new(sheet, h, &last.configuration);
            let [_, _, on_a, _, _, on_b] = motion.forces(energy.forces);
            // The spring exerts opposite moments on panels A and B.
            let spring = energy.forces[2];
            for (panel, moment, spring) in [
                (hinge.panel_a(), on_a, -spring),
                (hinge.panel_b(), on_b, spring),
            ] {
                moments[panel].interfaces += 0.5 * f64::abs(moment);
                moments[panel].springs += 0.5 * f64::abs(spring);
                moments[panel].forces += 0.5 * f64::abs(moment - spring);
                couples[panel] += moment;
            }
        }
        for (moment, couple) in std::iter::zip(&mut moments, couples) {
            moment.interfaces += 0.5 * f64::abs(couple);
        }
        let hinges = std::iter::zip(&sheet.hinges, &last.deformations);
        let interfaces = std::iter::zip(hinges, energies).map(|((hinge, deformation), energy)| {
            let [normal, tangential, moment] = energy.forces;
            let a = hinge.panel_a();
            Interface {
                panels: [a, hinge.panel_b()],
                at: deployed(&sheet.panels[a], last.configuration[a], hinge.attachment),
                normal,
                tangential,
                translational: 0.5 * (normal * deformation.a + tangential * deformation.s),
                rotational: 0.5 * moment * deformation.theta,
            }
        });
        let centroid =
            |(panel, motion): (&Panel, &[f64; 3])| deployed(panel, *motion, panel.centroid);
        Ok(Self {
            interfaces: interfaces.collect(),
            centroids: std::iter::zip(&sheet.panels, &last.configuration)
                .map(centroid)
                .collect(),
            moments,
            areas: sheet.panels.iter().map(|panel| panel.area).collect(),
        })
    }

    /// The columns of Table 1.
    pub fn shares(&self) -> TransmissionShares {
        let sum = |part: &dyn Fn(&Interface) -> f64| self.interfaces.iter().map(part).sum::<f64>();
        let (tension, compression, shear) = (
            sum(&|interface| interface.normal.max(0.0)),
            sum(&|interface| (-interface.normal).max(0.0)),
            sum(&|interface| interface.tangential.abs()),
        );
        let transmitted = tension + compression + shear;
        let rotational = sum(&|interface| interface.rotational);
        let strong = self.strongest(Interface::force);
        let of_strong = |part: &dyn Fn(&Interface) -> f64| -> f64 {
            strong.iter().map(|&h| part(&self.interfaces[h])).sum()
        };
        let translational = of_strong(&|interface| interface.translational);
        // A sheet without loads transmits no force.
        let share = |part: f64, whole: f64| {
            Some(part / whole)
                .filter(|share| share.is_finite())
                .unwrap_or(0.0)
        };
        TransmissionShares {
            tension: share(tension, transmitted),
            compression: share(compression, transmitted),
            shear: share(shear, transmitted),
            rotation: share(
                rotational,
                rotational + sum(&|interface| interface.translational),
            ),
            non_rotational: share(
                translational,
                translational + of_strong(&|interface| interface.rotational),
            ),
        }
    }

    /// The quarter of interfaces with the largest `size`, as far as it is positive.
    pub fn strongest(&self, size: impl Fn(&Interface) -> f64) -> Vec<usize> {
        let sizes: Vec<f64> = self.interfaces.iter().map(size).collect();
        let mut strongest = upper_part(&sizes, STRONG);
        strongest.retain(|&h| sizes[h] > 0.0);
        strongest
    }

    /// Spearman's rank correlation between the force of an interface and the fraction of its energy that is
    /// not stored in rotation; zero if one of the two is constant.
    pub fn rank_correlation(&self) -> f64 {
        let force = self.interfaces.iter().map(Interface::force).collect();
        let share = |interface: &Interface| {
            interface.translational / (interface.translational + interface.rotational)
        };
        correlation(
            &ranks(force),
            &ranks(self.interfaces.iter().map(share).collect()),
        )
    }

    /// How many times more likely than by chance a neighbour of a strongly loaded panel is strongly loaded, the load
    /// of a panel being the sum over its interfaces. One if there are too few panels.
    pub fn clustering(&self) -> f64 {
        let mut loads = vec![0.0; self.centroids.len()];
        for interface in &self.interfaces {
            for panel in interface.panels {
                loads[panel] += interface.force();
            }
        }
        let strong = upper_part(&loads, STRONG);
        let is_strong = |panel: usize| strong.contains(&panel);
        let (mut beside, mut both) = (0.0, 0.0);
        for Interface { panels: [a, b], .. } in &self.interfaces {
            for (panel, neighbour) in [(a, b), (b, a)] {
                if is_strong(*panel) {
                    beside += 1.0;
                    both += f64::from(u8::from(is_strong(*neighbour)));
                }
            }
        }
        let chance = (strong.len() as f64 - 1.0) / (loads.len() as f64 - 1.0);
        let ratio = both / beside / chance;
        if ratio.is_finite() { ratio } else { 1.0 }
    }

    /// Mean area of the tenth of panels with the largest moment, relative to the median area.
    pub fn moment_panels(&self, moment: impl Fn(&PanelMoment) -> f64) -> f64 {
        let moments: Vec<f64> = self.moments.iter().map(moment).collect();
        let most = upper_part(&moments, MOMENT_PANELS);
        let mean = most.iter().map(|&k| self.areas[k]).sum::<f64>() / most.len() as f64;
        let mut areas = self.areas.clone();
        areas.sort_by(f64::total_cmp);
        let last = areas.len() - 1;
        mean / (0.5 * (areas[last / 2] + areas[last.div_ceil(2)]))
    }
}

/// The indices of the fraction `part` of values that are the largest, in descending order.
fn upper_part(values: &[f64], part: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    order.truncate((part * values.len() as f64).ceil() as usize);
    order
}

/// The rank of each value in ascending order.
fn ranks(values: Vec<f64>) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut ranks = vec![0.0; values.len()];
    for (rank, i) in order.into_iter().enumerate() {
        ranks[i] = rank as f64;
    }
    ranks
}

/// Pearson's correlation; zero if one of the two is constant.
fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (mean_x, mean_y) = (mean(x), mean(y));
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in std::iter::zip(x, y) {
        let (dx, dy) = (x - mean_x, y - mean_y);
        (xy, xx, yy) = (xy + dx * dy, xx + dx * dx, yy + dy * dy);
    }
    let variances = xx * yy;
    if variances > 0.0 {
        xy / variances.sqrt()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn through(interfaces: f64) -> PanelMoment {
        PanelMoment {
            interfaces,
            ..PanelMoment::default()
        }
    }

    fn interface(
        panels: [usize; 2],
        normal: f64,
        tangential: f64,
        energies: [f64; 2],
    ) -> Interface {
        Interface {
            panels,
            at: [0.0; 2],
            normal,
            tangential,
            translational: energies[0],
            rotational: energies[1],
        }
    }

    #[test]
    fn shares_of_four_interfaces_by_hand() {
        let transmission = ForceTransmission {
            interfaces: vec![
                interface([0, 1], 6.0, 0.0, [3.0, 1.0]),
                interface([1, 2], -2.0, 1.0, [1.0, 3.0]),
                interface([2, 3], 0.0, -1.0, [0.0, 4.0]),
                interface([3, 4], 0.0, 0.0, [0.0, 8.0]),
            ],
            centroids: vec![[0.0; 2]; 5],
            moments: [1.0, 0.0, 7.0, 0.0, 2.0].map(through).to_vec(),
            areas: vec![2.0, 1.0, 6.0, 4.0, 9.0],
        };
        // A tenth of five panels is the third alone.
        assert_eq!(transmission.moment_panels(|moment| moment.interfaces), 1.5);
        let shares = transmission.shares();
        assert_eq!(shares.tension, 0.6);
        assert_eq!((shares.compression, shares.shear), (0.2, 0.2));
        assert_eq!(shares.rotation, 0.8);
        // A quarter of four interfaces is the first alone.
        assert_eq!(shares.non_rotational, 0.75);
        assert_eq!(transmission.strongest(|interface| interface.normal), [0]);
        assert!(
            transmission
                .strongest(|interface| interface.normal - 10.0)
                .is_empty()
        );
    }

    #[test]
    fn the_rank_correlation_is_that_of_the_ranks() {
        let rank = |values: &[f64]| ranks(values.to_vec());
        let growing = [1.0, 2.0, 5.0, 9.0];
        assert_eq!(
            correlation(&rank(&growing), &rank(&[0.1, 0.2, 0.3, 7.0])),
            1.0
        );
        assert_eq!(
            correlation(&rank(&growing), &rank(&[4.0, 3.0, 2.0, 1.0])),
            -1.0
        );
    }

    #[test]
    fn loaded_panels_in_one_place_are_clustered() {
        // A chain of eight panels with two strongly loaded ones: adjacent, and far apart.
        let chain = |loaded: &[usize]| {
            let force = |h: usize| if loaded.contains(&h) { 9.0 } else { 1.0 };
            ForceTransmission {
                interfaces: (0..7)
                    .map(|h| interface([h, h + 1], force(h), 0.0, [0.0; 2]))
                    .collect(),
                centroids: vec![[0.0; 2]; 8],
                moments: vec![PanelMoment::default(); 8],
                areas: vec![1.0; 8],
            }
        };
        // Of panels 3 and 4 each has one strongly loaded neighbour besides each other.
        assert!((chain(&[2, 3, 4]).clustering() - 0.5 * 7.0).abs() < 1e-12);
        assert_eq!(chain(&[0, 6]).clustering(), 0.0);
    }
}
