//! The load steps of a sheet that differs little from another whose path is known, as in successive
//! designs: each state is corrected from the state of the known path, without increments between
//! the load steps.
//!
//! The known state is first carried over by the hinge law linearised about it,
//!
//! ```text
//! f = f_0 + K_0 (eps - eps_0) + C_0 (g - g_0),     g = (w_lig, alpha, rho_f)
//! ```
//!
//! whose equilibrium in the new sheet requires no evaluation of the hinges. Newton's method then
//! corrects it, every load step by itself. The states are the states of a followed path as long as
//! the path has no jump. A jump that appears between two load steps is not noticed: paths must be
//! followed from the flat sheet now and then.

use crate::{
    equilibrium::{
        hinged_sheet::HingedSheet,
        load_step::{LoadStep, Status},
        potential::{Branch, PathStage, moved},
        predictor::PathPoint,
        solver::EquilibriumSolver,
    },
    hinge_law::{HingeEnergy, Order, PreparedLaw},
};
use hinge::{HingeDeformation, HingeDesign};
use rayon::prelude::*;
use std::array::from_fn;
use std::iter::zip;
use support::vectors::dot;

/// Maximum distance of an equilibrium from the equilibrium of the linearised law (rad, or panel
/// sizes for hinge translations).
const NEARBY: f64 = 0.02;
/// Motion of the panels of a known state to the supports and the stroke at its load parameter,
/// relative to their largest motion, that rounding may cause.
const ROUNDED: f64 = 1e-9;

/// The equilibrium path of a sheet.
#[derive(Clone, Debug)]
pub struct WarmStart {
    /// The designs of the hinges.
    pub designs: Vec<HingeDesign>,
    /// All load steps. Without the mixed derivatives of the hinges C_0 is zero.
    pub steps: Vec<LoadStep>,
}

/// A hinge law linearised about one state of every hinge.
struct LinearisedLaw<'a> {
    deformations: &'a [HingeDeformation],
    energies: &'a [HingeEnergy],
    /// Changes of w_lig (mm), alpha (rad) and rho_f.
    changes: &'a [[f64; 3]],
}

impl PreparedLaw for LinearisedLaw<'_> {
    fn energies(&self, deformations: &[HingeDeformation], _order: Order) -> Vec<HingeEnergy> {
        let hinges = deformations.iter().enumerate();
        hinges.map(|(h, to)| self.energy(h, *to)).collect()
    }
}

impl LinearisedLaw<'_> {
    fn energy(&self, hinge: usize, to: HingeDeformation) -> HingeEnergy {
        let (from, known) = (self.deformations[hinge], self.energies[hinge]);
        let strain = [to.a - from.a, to.s - from.s, to.theta - from.theta];
        let by_strain = known.tangent.map(|row| dot(&row, &strain));
        let by_design = (known.mixed).map(|row| dot(&row.to_array(), &self.changes[hinge]));
        let start: [f64; 3] = from_fn(|c| known.forces[c] + by_design[c]);
        HingeEnergy {
            w: known.w + dot(&start, &strain) + 0.5 * dot(&by_strain, &strain),
            forces: from_fn(|c| start[c] + by_strain[c]),
            ..known
        }
    }
}

impl EquilibriumSolver {
    /// The load steps of a sheet near the sheet of the path `known`. `None` if the known path is
    /// not complete or jumps, or if a state is not a stable equilibrium close to the known one:
    /// then the path must be followed.
    pub fn path_near(&self, sheet: HingedSheet, known: &WarmStart) -> Option<Vec<LoadStep>> {
        let (weighed, loaded) = known.steps.split_at_checked(self.weight_steps())?;
        let near = |stage, steps| {
            let ends: Vec<f64> = self.ends(stage).collect();
            self.steps_near(sheet, stage, &ends, &known.designs, steps)
        };
        let mut path = near(PathStage::Weight, weighed)?;
        path.extend(near(PathStage::Actuation, loaded)?);
        Some(path)
    }

    /// The state at full load of a sheet near another one, whose last known state is there; `None`
    /// as for a path.
    pub fn end_near(&self, sheet: HingedSheet, known: &WarmStart) -> Option<Vec<LoadStep>> {
        let last = known.steps.last_chunk::<1>()?;
        self.steps_near(sheet, PathStage::Actuation, &[1.0], &known.designs, last)
    }

    /// A stable equilibrium at full load next to the last state of a known path: where Newton's
    /// method leads from it, or else a descent in energy. It need not be on the path from the flat
    /// sheet. `None` if there is none.
    pub(crate) fn full_load_near(&self, sheet: HingedSheet, known: &WarmStart) -> Option<LoadStep> {
        let last = known.steps.last()?;
        let changes = changes(sheet, &known.designs);
        let mut branch = Branch::new(self, sheet, PathStage::Actuation);
        let start = branch.carried_over(1.0, last, &changes)?;
        let found = branch.stable_near(&start).ok()?;
        let step = branch.load_step(found, 0);
        (step.status != Status::Almost).then_some(step)
    }

    /// The load steps that end at load parameters, each from the known one there; `None` unless
    /// there is one for each.
    fn steps_near(
        &self,
        sheet: HingedSheet,
        stage: PathStage,
        ends: &[f64],
        designs: &[HingeDesign],
        known: &[LoadStep],
    ) -> Option<Vec<LoadStep>> {
        let smooth = |step: &LoadStep| {
            matches!(step.status, Status::Converged | Status::LeftDomain) && step.jumps == 0
        };
        if known.len() != ends.len() || !known.iter().all(smooth) {
            return None;
        }
        let changes = changes(sheet, designs);
        let near = |(at, step): (&f64, &LoadStep), before: &[LoadStep]| {
            let mut branch = Branch::new(self, sheet, stage);
            let forces = before.iter().flat_map(|step| &step.hinges).map(|hinge| hinge.forces);
            branch.force = branch.force.max(branch.largest(forces));
            branch.load_step_near(*at, step, &changes)
        };
        let steps = ends.par_iter().zip(known).enumerate();
        steps.map(|(before, step)| near(step, &known[..before])).collect()
    }
}

/// Changes of w_lig (mm), alpha (rad) and rho_f of all hinges since the given designs.
fn changes(sheet: HingedSheet, since: &[HingeDesign]) -> Vec<[f64; 3]> {
    let designs = zip(sheet.sheet.designs(), since);
    let changes = designs.map(|(to, from)| {
        [to.w_lig - from.w_lig, to.alpha - from.alpha, to.fillet_ratio - from.fillet_ratio]
    });
    changes.collect()
}

impl Branch<'_> {
    fn load_step_near(
        &mut self,
        at: f64,
        known: &LoadStep,
        changes: &[[f64; 3]],
    ) -> Option<LoadStep> {
        let start = self.carried_over(at, known, changes)?;
        let found = self.balanced(start.clone())?;
        if self.distance(&found.state, &start) > NEARBY {
            return None;
        }
        // An unstable state is `Almost` an equilibrium, too.
        let step = self.load_step(found, 0);
        (step.status != Status::Almost).then_some(step)
    }

    /// Moves a known state to the supports and the stroke at its load parameter, which other places
    /// of fasteners and loads in another direction change.
    fn hold_at(&self, position: &mut PathPoint) {
        let configuration = vec![[0.0; 3]; position.configuration.len()];
        let mut held = position.clone();
        self.hold(&mut held, &PathPoint { at: 0.0, configuration, forces: Vec::new() });
        let motion = moved(&held.configuration, &position.configuration, -1.0);
        let [motion, size] = [&motion, &position.configuration]
            .map(|of| of.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs())));
        if motion > ROUNDED * size {
            *position = held;
        }
    }

    /// The equilibrium of this sheet with the hinge law linearised about the states of a known load
    /// step.
    fn carried_over(
        &mut self,
        at: f64,
        known: &LoadStep,
        changes: &[[f64; 3]],
    ) -> Option<PathPoint> {
        let law =
            LinearisedLaw { deformations: &known.deformations, energies: &known.hinges, changes };
        let linearised =
            HingedSheet { law: &law, contact: None, damage_gradient: false, ..self.sheet };
        let mut branch = Branch::new(self.solver, linearised, self.stage);
        let mut start = PathPoint {
            at,
            configuration: known.configuration.clone(),
            forces: known.hinges.iter().map(|hinge| hinge.forces).collect(),
        };
        self.hold_at(&mut start);
        let found = branch.close(start, None, f64::INFINITY).ok();
        self.effort.iterations += branch.effort.iterations;
        self.effort.factorisations += branch.effort.factorisations;
        Some(found?.position)
    }
}
