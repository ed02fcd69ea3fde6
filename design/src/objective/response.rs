//! The equilibrium at full load as a function, and the product of its derivative with a vector: for
//! objectives, networks and optimisers of other programs.
//!
//! ```text
//! (design, loads, thickness, stresses)  ->  (deployed corners, reactions, load factor)
//! ```
//!
//! With lambda of (20) for a function of these outputs and f the forces of the hinge law, all
//! stresses, by a factor e, and the thickness t change the function by
//!
//! ```text
//! d/dlog e = -sum_h f_h . D eps_h[lambda],    d/dlog t = -sum_h (df_h/dlog t) . D eps_h[lambda] +
//! lambda . (weight)
//! ```
//!
//! A hinge of another thickness is a geometrically similar one, W(a, s, theta, w_lig; t) = t^3
//! W(a/t, s/t, theta, w_lig/t; 1), so that Euler's theorem gives df/dlog t from the second
//! derivatives of W.

use crate::{
    equilibrium::{
        hinged_sheet::HingedSheet, load_step::LoadStep, solver::EquilibriumSolver,
        warm_start::WarmStart, weight::weights_of_panels,
    },
    hinge_law::{HingeEnergy, HingeGradient, Order},
    objective::{
        design_gradient::Partials,
        design_problem::{Deployment, DesignError, DesignProblem, Model, converged},
    },
    pattern::design_vector::DesignVector,
    sheet::{
        cut_sheet::SheetGradient,
        kinematics::{HingeMotion, Motion, at_hinge, deployed_corners},
    },
};
use hinge::HingeDeformation;
use std::iter::zip;
use support::{Point, fault, vectors::dot};

/// Inputs of the equilibrium other than the design; by default the inputs of the problem.
#[derive(Debug, PartialEq)]
pub struct Conditions {
    /// (F_x, F_y, M) on every panel at full load (N, N, N mm); `None` for the loads of the problem.
    pub loads: Option<Vec<Motion>>,
    /// Thickness over the thickness of the problem.
    pub thickness: f64,
    /// All stresses at equal strain over the stresses of the problem.
    pub stress: f64,
}

impl Default for Conditions {
    fn default() -> Self {
        Self { loads: None, thickness: 1.0, stress: 1.0 }
    }
}

/// The equilibrium at full load.
pub struct Response {
    /// Its path is only the last state.
    pub deployment: Deployment,
    /// Forces (F_x, F_y, M) by which the supports hold every panel (N, N, N mm), about the point
    /// where it is held; zero where it is free.
    pub reactions: Vec<Motion>,
}

impl Response {
    /// The state at full load.
    pub fn state(&self) -> &LoadStep {
        self.deployment.final_step()
    }

    /// Deployed corners SW, SE, NE, NW of every panel (mm).
    pub fn corners(&self) -> Vec<[Point; 4]> {
        deployed_corners(&self.deployment.sheet, &self.state().configuration)
    }
}

/// The gradient of a function in the outputs of a response.
#[derive(Debug)]
pub struct ResponseCotangent {
    /// Gradient in the deployed corners of every panel.
    pub corners: Vec<[Point; 4]>,
    /// Gradient in the reactions.
    pub reactions: Vec<Motion>,
    /// Gradient in the load factor.
    pub load_factor: f64,
}

/// The gradient of a function of a response in the inputs.
#[derive(Debug)]
pub struct ResponseGradient {
    /// Gradient in the design.
    pub design: DesignVector,
    /// Gradient in (F_x, F_y, M) on every panel at full load; zero at the supports, where no load
    /// is possible, and under a prescribed stroke in the forces on panels without a force: the sum
    /// of all magnitudes, which the stroke refers to, has a kink there.
    pub loads: Vec<Motion>,
    /// Gradient in the logarithm of the thickness; `None` if the hinge law does not determine it.
    pub thickness: Option<f64>,
    /// Gradient in the logarithm of all stresses at equal strain; `None` if the hinge law does not
    /// determine it.
    pub stress: Option<f64>,
}

impl DesignProblem {
    /// The same problem under other conditions.
    pub fn under(&self, conditions: &Conditions) -> Result<Self, DesignError> {
        let mechanics = self.model.equilibrium()?;
        let mut mechanics = mechanics.scaled(conditions.thickness, conditions.stress)?;
        if let Some(loads) = &conditions.loads {
            mechanics.solver = mechanics.solver.loaded(loads)?;
        }
        Ok(Self {
            model: Model::Equilibrium(Box::new(mechanics)),
            objective: self.objective.clone(),
            topology: self.topology.clone(),
            ..*self
        })
    }

    /// The equilibrium of a design at full load, corrected from the last of the `known` ones of
    /// another design or under other conditions if that is near enough, or else at the end of the
    /// path from the flat sheet.
    pub fn response(
        &self,
        design: &DesignVector,
        known: Option<&WarmStart>,
    ) -> Result<Response, DesignError> {
        self.responded(design, |solver, hinged| {
            let near = known.and_then(|known| solver.end_near(hinged, known));
            let followed = near.is_none();
            (near.unwrap_or_else(|| solver.load_steps_at(hinged, &[1.0])), followed)
        })
    }

    /// A draft of the equilibrium of a design at full load next to the last state of a `known`
    /// path, an error if there is none there; without one at the end of the path from the flat sheet,
    /// which may end on another branch than a draft next to another.
    pub fn draft(
        &self,
        design: &DesignVector,
        known: Option<&WarmStart>,
    ) -> Result<Response, DesignError> {
        let Some(known) = known else { return self.response(design, None) };
        self.responded(design, |solver, hinged| {
            (solver.full_load_near(hinged, known).into_iter().collect(), false)
        })
    }

    /// The response of a design whose configuration at full load is known.
    pub fn response_at(
        &self,
        design: &DesignVector,
        configuration: &[Motion],
    ) -> Result<Response, DesignError> {
        self.responded(design, |solver, hinged| {
            (vec![solver.full_load(hinged, configuration.to_vec())], false)
        })
    }

    fn responded(
        &self,
        design: &DesignVector,
        solve: impl FnOnce(&EquilibriumSolver, HingedSheet) -> (Vec<LoadStep>, bool),
    ) -> Result<Response, DesignError> {
        let mechanics = self.model.equilibrium()?;
        let (pattern, sheet) = self.cut(design)?;
        mechanics.solver.check_supports(&sheet)?;
        let law = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(&sheet, &*law, false);
        let (path, followed) = solve(&mechanics.solver, hinged);
        let state = path.last().ok_or_else(|| fault!("no equilibrium is near the known one"))?;
        let reactions = mechanics.solver.reactions(hinged, &converged(state)?.configuration);
        drop(law);
        Ok(Response { deployment: Deployment { pattern, sheet, path, followed }, reactions })
    }

    /// The gradient in the inputs of a response of this problem to `design` of a function with the
    /// gradient `by` in its outputs.
    pub fn response_pullback(
        &self,
        design: &DesignVector,
        response: &Response,
        by: &ResponseCotangent,
    ) -> Result<ResponseGradient, DesignError> {
        let mechanics = self.model.equilibrium()?;
        let (sheet, state) = (&response.deployment.sheet, response.state());
        let designs = sheet.designs();
        let law = mechanics.law.prepare(&designs);
        let corners: Vec<_> = (0..sheet.panels.len())
            .flat_map(|panel| (0..4).map(move |corner| (panel, corner)))
            .collect();
        let reactions = mechanics.solver.at_supports(&by.reactions);
        let of_supports = reactions.as_flattened().iter().any(|force| *force != 0.0);
        let partials = Partials {
            path: &response.deployment.path,
            outline: &corners,
            by_outline: by.corners.as_flattened(),
            by_states: &vec![vec![HingeGradient::default()]; sheet.hinges.len()],
            by_load_factor: by.load_factor,
            by_sheet: SheetGradient::zeros(&sheet.topology),
            by_reactions: of_supports.then_some(reactions),
        };
        let gradient =
            self.design_gradient(design, &response.deployment, Some((mechanics, &*law)), partials)?;
        let virtual_motion = &gradient.virtual_motion;
        let motions = HingeMotion::all(sheet, &state.configuration);
        let energies = law.energies(&state.deformations, Order::Design);
        // Minus the virtual work of forces of the hinges.
        let work = |forces: &dyn Fn(usize) -> [f64; 3]| -> f64 {
            let hinges = zip(&sheet.hinges, &motions).enumerate();
            let works = hinges.map(|(h, (hinge, motion))| {
                dot(&forces(h), &motion.rates(at_hinge(hinge, virtual_motion)))
            });
            -works.sum::<f64>()
        };
        let weight = weights_of_panels(sheet, mechanics.solver.weight, &state.configuration);
        let of_weight: f64 =
            zip(weight, virtual_motion).map(|(weight, motion)| dot(&weight.force, motion)).sum();
        let thickness =
            |h: usize| by_thickness(&energies[h], &state.deformations[h], designs[h].w_lig);
        let [of_thickness, of_stress] = mechanics.law.scales();
        Ok(ResponseGradient {
            design: gradient.design,
            loads: mechanics.solver.in_loads(&gradient.sensitivities.loads),
            thickness: of_thickness.then(|| work(&thickness) + of_weight),
            stress: of_stress.then(|| work(&|h| energies[h].forces)),
        })
    }
}

/// The derivative of (F_a, F_s, M_theta) in the logarithm of the thickness: with all lengths in
/// proportion F_a and F_s grow with its square and M_theta with its cube.
pub fn by_thickness(energy: &HingeEnergy, at: &HingeDeformation, w_lig: f64) -> [f64; 3] {
    std::array::from_fn(|c| {
        let degree = if c == 2 { 3.0 } else { 2.0 };
        let [by_a, by_s, _] = energy.tangent[c];
        degree * energy.forces[c] - at.a * by_a - at.s * by_s - w_lig * energy.mixed[c].w_lig
    })
}
