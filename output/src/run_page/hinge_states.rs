//! The states of panels and hinges along the path.

use crate::{
    deployment_states::{kept, states_before},
    report::force_spreads,
    run_page::packed::packed,
};
use analysis::actuation_curve::ActuationCurve;
use design::{
    equilibrium::load_step::LoadStep,
    hinge_law::{DamageMeasure, Order},
    objective::design_problem::{Deployment, DesignProblem, Mechanics},
    sheet::cut_sheet::Sheet,
};
use scene::{Scene, placement::placed};
use serde_json::{Value, json};
use surrogate::Surrogate;

/// Maximum number of numbers in the states: 4 bytes each, and a third more in base64, are 4 MB. Of
/// a longer path or a larger sheet every second, third, ... state is left out, but never the flat
/// and the last one.
const MOST_NUMBERS: usize = 750_000;
/// Numbers of a panel and of a hinge in a state.
const OF_PANEL: usize = 3;
const OF_HINGE: usize = 11;

/// The states of a deployment, each list with one entry, or one row, for each state; NaN is not
/// known, and null a list of which nothing is. With the spread of several networks.
pub(super) fn hinge_states(
    scene: &Scene,
    problem: &DesignProblem,
    deployment: &Deployment,
    networks: &[Surrogate],
) -> Value {
    let sheet = &deployment.sheet;
    let before = states_before(problem, deployment);
    let all: Vec<&LoadStep> = before.iter().chain(&deployment.path).collect();
    let size = OF_PANEL * sheet.panels.len() + OF_HINGE * sheet.hinges.len();
    let index = kept(all.len(), MOST_NUMBERS / size);
    let shown: Vec<&LoadStep> = index.iter().map(|&i| all[i]).collect();
    let mechanics = problem.model.mechanics();
    let by_hinge = |of: &dyn Fn(usize, usize) -> f64| {
        let numbers = |&i: &usize| (0..sheet.hinges.len()).map(move |h| of(i, h));
        packed(index.iter().flat_map(numbers))
    };
    let damage = |measure: DamageMeasure| {
        let known = known_damage(deployment, before.len(), measure)?;
        Some(by_hinge(&|i, h| known[i][h]))
    };
    let of_mechanics =
        mechanics.map(|mechanics| forces_and_reactions(scene, mechanics, sheet, &shown));
    let (forces, reactions) = of_mechanics.unzip();
    let weight_steps = deployment.weight_steps().len();
    let curve = mechanics.and_then(|mechanics| ActuationCurve::new(mechanics, deployment));
    let curve = curve.map(|curve| {
        let before = std::iter::repeat_n(None, weight_steps);
        before.chain(curve.points.into_iter().map(Some)).collect::<Vec<_>>()
    });
    let spread = force_spreads(networks, deployment).map(|spreads| {
        // The flat sheet has no forces.
        by_hinge(&|i, h| match i.checked_sub(1) {
            None => 0.0,
            Some(step) => spreads.get(step).map_or(f64::NAN, |of| 100.0 * of[h]),
        })
    });
    let states = || shown.iter();
    let motions = states().flat_map(|state| placed(scene, sheet, &state.configuration));
    let deformations = states().flat_map(|state| &state.deformations);
    json!({
        // Number of states, those that are left out included, and the index of each state shown.
        "of": all.len(),
        "index": index,
        "load_factor": states().map(|state| state.load_factor).collect::<Vec<_>>(),
        // Number of load steps in which the weight comes on, before the steps of the loads.
        "weight_steps": weight_steps,
        "status": states().map(|state| state.status).collect::<Vec<_>>(),
        // (displacement, load) of what moves the sheet, for all states of the path; null before the
        // whole weight is on.
        "curve": curve,
        // (u_x, u_y, phi) of the panels (mm, mm, rad).
        "motions": packed(motions.flatten()),
        // (a, s, theta) of the hinges (mm, mm, rad).
        "deformations": packed(deformations.flat_map(|eps| eps.to_array())),
        // Whether the hinges are inside the training domain.
        "inside": by_hinge(&|i, h| f64::from(u8::from(all[i].inside[h]))),
        // Energies of the hinges under load (N mm).
        "energy": mechanics.map(|_| by_hinge(&|i, h| all[i].energies[h])),
        // (F_a, F_s, M_theta) of the hinges (N, N, N mm).
        "forces": forces,
        // D and D_peak, known up to the state in which a hinge leaves the training domain.
        "damage": damage(DamageMeasure::Mean),
        "damage_peak": damage(DamageMeasure::Peak),
        // Standard deviation of the forces over the ensemble (%), relative to the forces on the path.
        "spread": spread,
        // (F_x, F_y, M) of every support of the scene (N, N, N mm); zero in the free directions.
        "reactions": reactions.unwrap_or_default(),
    })
}

/// (F_a, F_s, M_theta) of every hinge and (F_x, F_y, M) of every support of the scene in states.
fn forces_and_reactions(
    scene: &Scene,
    mechanics: &Mechanics,
    sheet: &Sheet,
    states: &[&LoadStep],
) -> (String, String) {
    let supports = scene.actuation().supports;
    let law = mechanics.law.prepare(&sheet.designs());
    let hinged = mechanics.hinged(sheet, &*law, false);
    let (mut forces, mut reactions) = (Vec::new(), Vec::new());
    for state in states {
        let energies = hinged.energies(&state.deformations, Order::Forces);
        forces.extend(energies.iter().flat_map(|energy| energy.forces));
        let on_panels = mechanics.solver.holding_forces(hinged, state.weight, &state.configuration);
        reactions.extend(supports.iter().flat_map(|support| {
            let held = std::iter::zip(support.motion, on_panels[support.panel]);
            held.map(|(motion, force)| motion.map_or(0.0, |_| force))
        }));
    }
    (packed(forces), packed(reactions))
}

/// The damage of every hinge in every state: zero in the states before the path, NaN from the state
/// in which the hinge is first outside the training domain; `None` if the law predicts none.
fn known_damage(
    deployment: &Deployment,
    before: usize,
    measure: DamageMeasure,
) -> Option<Vec<Vec<f64>>> {
    let known = |state: &LoadStep, h: usize| measure.known(state.damage.get(h)?);
    known(&deployment.path[0], 0)?;
    let mut states = vec![vec![0.0_f64; deployment.sheet.hinges.len()]; before];
    for state in &deployment.path {
        let earlier = &states[states.len() - 1];
        let of_hinge = |h: usize| {
            if state.inside[h] && !earlier[h].is_nan() {
                known(state, h).unwrap_or(f64::NAN)
            } else {
                f64::NAN
            }
        };
        states.push((0..earlier.len()).map(of_hinge).collect());
    }
    Some(states)
}
