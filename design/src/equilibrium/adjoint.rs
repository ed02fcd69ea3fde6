//! The adjoint of the equilibria; (20). With g_i the gradient of the objective with respect to q_i,
//!
//! ```text
//! H_i lambda_i = g_i,     dL/dp -= sum_i sum_h d/dp [ grad W(eps_h(q_i, p); p) . D eps_h(q_i,
//! p)[lambda_i] ]
//! ```
//!
//! which is local to each hinge in p = (attachment point, reference points, angle of e_sec, w_lig,
//! alpha). Each load step reuses the factors of its own tangent, refined against that tangent. For
//! the constants of (11) the bracket is `eps_c e_c . D eps_h[lambda]`, for the loads it is `-zeta
//! lambda`, for the weight minus its virtual work. Under displacement control the system has the
//! border of the stroke, whose condition (f . q)/F = stroke also depends on the loads. A function
//! that depends on the load factor zeta_i, by g_zeta, has the condition (f . lambda_i)/F =
//! -g_zeta/F.
//!
//! The supports resist with the forces r = grad Pi at the supported degrees of freedom. For a
//! function that depends on them, by g_r, lambda is -g_r there, and the equations of the free
//! degrees of freedom have the right-hand side g_i + H g_r.

use crate::{
    equilibrium::{
        hinged_sheet::HingedSheet,
        load_step::LoadStep,
        potential::{Branch, PathStage},
        refined_solve::refined_solve,
        solver::EquilibriumSolver,
        weight::add_weight_gradient,
    },
    hinge_law::{HingeGradient, Order},
    sheet::{
        cut_sheet::SheetGradient,
        kinematics::{
            HingeGeometryGradient, HingeMotion, Motion, add_at_hinge, add_motions, at_hinge,
        },
    },
};
use std::borrow::Cow;
use std::iter::zip;
use support::vectors::dot;

/// Backward error of an adjoint solve above which the tangent is considered singular.
pub(crate) const SINGULAR: f64 = 1e-6;

/// A singular tangent, for which the adjoint does not exist.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the tangent is singular at load factor {load_factor:.4}: the gradient does not exist")]
pub struct SingularTangent {
    /// The load factor of the singular tangent.
    pub load_factor: f64,
}

/// The gradient of a function of the path.
pub(crate) struct PathGradient<'a> {
    /// `by_states[h][i]`: in hinge h at load step i.
    pub by_states: &'a [Vec<HingeGradient>],
    /// Gradient in the load factor of the last load step; read under displacement control only.
    pub by_load_factor: f64,
    /// Gradient in the last configuration.
    pub by_last: Vec<Motion>,
    /// Gradient in the forces (F_x, F_y, M) of the supports in the last state; zero at free degrees
    /// of freedom. `None` if it depends on none.
    pub by_reactions: Option<Vec<Motion>>,
}

/// Results of the adjoint other than the gradient in the sheet.
pub(crate) struct AdjointSums {
    /// Gradient with respect to (F_x, F_y, M) of every panel at full load.
    pub loads: Vec<Motion>,
    /// Gradient with respect to (k_a, k_s, k_theta) of every hinge; zero for a law without such
    /// constants.
    pub constants: Vec<[f64; 3]>,
    /// lambda of the last state, a virtual motion of every panel: the function changes by minus the
    /// work on it of an additional force of the hinges.
    pub virtual_motion: Vec<Motion>,
    /// Maximum componentwise backward error of the solves.
    pub residual: f64,
}

/// The gradient, with respect to the sheet, of a function of the path: the direct dependence
/// through the hinge states, and the dependence through the equilibria. The result is added to
/// `by_sheet`.
pub(crate) fn adjoint(
    solver: &EquilibriumSolver,
    sheet: HingedSheet,
    path: &[LoadStep],
    PathGradient { by_states, by_load_factor, by_last, by_reactions }: PathGradient,
    by_sheet: &mut SheetGradient,
) -> Result<AdjointSums, SingularTangent> {
    let mut by_configurations = vec![vec![[0.0; 3]; by_last.len()]; path.len()];
    by_configurations[path.len() - 1] = by_last;
    let mut sums = AdjointSums {
        loads: vec![[0.0; 3]; sheet.sheet.panels.len()],
        constants: vec![[0.0; 3]; sheet.sheet.hinges.len()],
        virtual_motion: Vec::new(),
        residual: 0.0,
    };
    for (i, (step, mut by_q)) in zip(path, by_configurations).enumerate() {
        let is_last = i + 1 == path.len();
        if !is_last && by_states.iter().all(|hinge| hinge[i] == HingeGradient::default()) {
            continue;
        }
        let hinges = || sheet.sheet.hinges.iter().enumerate();
        let motions = HingeMotion::all(sheet.sheet, &step.configuration);
        for (h, hinge) in hinges() {
            add_at_hinge(&mut by_q, hinge, motions[h].forces(by_states[h][i].state));
        }
        let by_supports = by_reactions.as_ref().filter(|_| is_last);
        let held = by_supports.map(|by_reactions| held_motion(solver, sheet, step, by_reactions));
        if let Some(held) = &held {
            add_motions(&mut by_q, &held.resistance, -1.0);
        }
        let rhs = solver.pattern.gather(&by_q);
        let stroke = solver.stroke();
        let by_load_factor = if is_last { by_load_factor } else { 0.0 };
        let slack = stroke.map_or(0.0, |stroke| stroke.slack(by_load_factor));
        let solution = (step.tangent.as_ref())
            .and_then(|tangent| refined_solve(&solver.pattern, tangent, stroke, (&rhs, slack)))
            .filter(|solution| solution.error < SINGULAR)
            .ok_or(SingularTangent { load_factor: step.load_factor })?;
        sums.residual = sums.residual.max(solution.error);
        let mut lambda = solver.pattern.spread(&solution.x);
        if let Some(held) = &held {
            add_motions(&mut lambda, &held.motion, 1.0);
        }
        add_motions(&mut sums.loads, &lambda, step.load_factor);
        if let Some(stroke) = stroke {
            let by_loads = stroke.by_loads(&solver.loads, &step.configuration);
            add_motions(&mut sums.loads, &by_loads, -solution.mu);
        }
        let weight = solver.weight.map(|component| step.weight * component);
        let configuration = &step.configuration;
        if weight != [0.0; 2] {
            add_weight_gradient(by_sheet, sheet.sheet, weight, configuration, &lambda);
        }
        let energies = match step.order {
            Order::Design => Cow::Borrowed(&step.hinges),
            _ => Cow::Owned(sheet.energies(&step.deformations, Order::Design)),
        };
        for (h, hinge) in hinges() {
            let virtual_motion = at_hinge(hinge, &lambda);
            let (energy, rates) = (&energies[h], motions[h].rates(virtual_motion));
            let against = |row: [f64; 3]| dot(&row, &rates);
            let by_state = by_states[h][i];
            let weights = std::array::from_fn(|c| by_state.state[c] - against(energy.tangent[c]));
            let turning = motions[h].rates_geometry_gradient(energy.forces, virtual_motion);
            let stretching = motions[h].geometry_gradient(weights);
            add_geometry(by_sheet, h, hinge.panels(), &stretching, 1.0);
            add_geometry(by_sheet, h, hinge.panels(), &turning, -1.0);
            if sheet.law.has_constants() {
                let eps = step.deformations[h].to_array();
                (0..3).for_each(|c| sums.constants[h][c] -= eps[c] * rates[c]);
            }
            let (by_state, mixed) = (by_state.design, energy.mixed);
            by_sheet.widths[h] += by_state.w_lig - against(mixed.map(|row| row.w_lig));
            by_sheet.alphas[h] += by_state.alpha - against(mixed.map(|row| row.alpha));
            by_sheet.holes[h] += by_state.hole - against(mixed.map(|row| row.hole));
        }
        sums.virtual_motion = lambda;
    }
    Ok(sums)
}

/// The virtual motion of the supports, and the forces that resist it.
struct HeldMotion {
    motion: Vec<Motion>,
    resistance: Vec<Motion>,
}

/// The virtual motion of the supports for a function with the given gradient in their forces, minus
/// that gradient.
fn held_motion(
    solver: &EquilibriumSolver,
    sheet: HingedSheet,
    step: &LoadStep,
    by_reactions: &[Motion],
) -> HeldMotion {
    let mut motion = vec![[0.0; 3]; by_reactions.len()];
    add_motions(&mut motion, by_reactions, -1.0);
    let branch = Branch::new(solver, sheet, PathStage::Actuation);
    let state = branch.state(1.0, step.configuration.clone(), Order::Tangent);
    let state = state.expect("the energy of an equilibrium is finite");
    HeldMotion { resistance: branch.resistance(&state, &motion), motion }
}

fn add_geometry(
    by_sheet: &mut SheetGradient,
    hinge: usize,
    [a, b]: [usize; 2],
    gradient: &HingeGeometryGradient,
    sign: f64,
) {
    by_sheet.attachments[hinge] += sign * gradient.attachment;
    by_sheet.references[a] += sign * gradient.reference_a;
    by_sheet.references[b] += sign * gradient.reference_b;
    by_sheet.frame_angles[hinge] += sign * gradient.frame_angle;
}
