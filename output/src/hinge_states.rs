//! Every hinge at every load step, as one list.

use design::hinge_law::DamageMeasure;
use design::objective::design_problem::Deployment;

/// A hinge at a load step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HingeState {
    /// Number of the load step, from 1.
    pub step: usize,
    /// zeta.
    pub load_factor: f64,
    /// Index of the hinge.
    pub hinge: usize,
    /// Panels A and B.
    pub panels: [usize; 2],
    /// Ligament width (mm).
    pub w_lig: f64,
    /// Cut angle (rad).
    pub alpha: f64,
    /// (a, s, theta) of (8) (mm, mm, rad).
    pub deformation: [f64; 3],
    /// (a, s) over the ligament width.
    pub eta: [f64; 2],
    /// Energy of the hinge, with contact (N mm).
    pub energy: f64,
    /// D and D_peak; `None` if the hinge law does not predict it, or if the state is outside its training domain.
    pub damage: [Option<f64>; 2],
    /// Whether the state is inside the training domain of the hinge law.
    pub inside: bool,
}

/// The states of all hinges, load step by load step.
pub fn hinge_states(deployment: &Deployment) -> Vec<HingeState> {
    let steps = deployment.path.iter().zip(1..);
    let states = steps.flat_map(|(at, step)| {
        let hinges = deployment.sheet.hinges.iter().enumerate();
        hinges.map(move |(h, hinge)| HingeState {
            step,
            load_factor: at.load_factor,
            hinge: h,
            panels: [hinge.panel_a(), hinge.panel_b()],
            w_lig: hinge.w_lig,
            alpha: hinge.alpha,
            deformation: at.deformations[h].to_array(),
            eta: at.deformations[h].eta(hinge.w_lig),
            energy: at.energies[h],
            damage: [DamageMeasure::Mean, DamageMeasure::Peak].map(|measure| {
                let known = measure.known(at.damage.get(h)?);
                known.filter(|_| at.inside[h])
            }),
            inside: at.inside[h],
        })
    });
    states.collect()
}
