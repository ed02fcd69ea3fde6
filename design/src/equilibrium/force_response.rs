//! The first-order response of an equilibrium to an error of its hinge forces. With df_h the error
//! of (F_a, F_s, M_theta) at hinge h and B the rates of the hinge states,
//!
//! ```text
//! H dq + mu c = -B^T df,    c . dq = 0,    dP = -mu            prescribed stroke c . q, load P H
//! dq = -B^T df,                          dP = 0              dead loads H dq = -B^T df,
//! dP = v . B^T df     supports moved by U, v = dq/d(displacement) on the path
//! ```
//!
//! which takes one solve with the factors of the tangent.

use crate::{
    equilibrium::{
        adjoint::SINGULAR,
        displacement_control::{Stroke, magnitude},
        hinged_sheet::HingedSheet,
        load_step::LoadStep,
        refined_solve::refined_solve,
        solver::EquilibriumSolver,
    },
    hinge_law::Order,
    sheet::{
        cut_sheet::Sheet,
        kinematics::{Configuration, HingeMotion, Motion, add_at_hinge, at_hinge},
    },
};
use support::vectors::dot;

/// An equilibrium whose hinge forces may have errors.
pub struct ForceResponse<'a> {
    solver: &'a EquilibriumSolver,
    sheet: &'a Sheet,
    step: &'a LoadStep,
    motions: Vec<HingeMotion>,
    /// If supports move the sheet: rates of (a, s, theta) of every hinge along the path, by their
    /// displacement.
    path_rates: Option<Vec<Motion>>,
}

/// What an error of the hinge forces changes.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetChange {
    /// Changes of the motions (u_x, u_y, phi) of the panels (mm, mm, rad).
    pub motions: Configuration,
    /// Change of the load that the prescribed displacement takes (N; N mm if couples or rotations
    /// move the sheet); `None` under dead loads.
    pub load: Option<f64>,
}

impl<'a> ForceResponse<'a> {
    /// The response of a load step; `None` if its tangent is singular.
    pub fn new(
        solver: &'a EquilibriumSolver,
        hinged: HingedSheet<'a>,
        step: &'a LoadStep,
    ) -> Option<Self> {
        let mut response = Self {
            solver,
            sheet: hinged.sheet,
            step,
            motions: HingeMotion::all(hinged.sheet, &step.configuration),
            path_rates: None,
        };
        if magnitude(&solver.loads).is_none() {
            response.path_rates = Some(response.rates_along_path(hinged)?);
        }
        Some(response)
    }

    /// The response to errors (F_a, F_s, M_theta) of the forces of some hinges, given with their
    /// indices (N, N, N mm); `None` if the tangent is singular.
    pub fn to(&self, errors: &[(usize, [f64; 3])]) -> Option<SheetChange> {
        let mut forces = vec![[0.0; 3]; self.sheet.panels.len()];
        for &(h, error) in errors {
            let on_panels = self.motions[h].forces(error).map(|force| -force);
            add_at_hinge(&mut forces, &self.sheet.hinges[h], on_panels);
        }
        let (motions, mu) = self.solve(&forces, self.solver.stroke())?;
        let by_path = self.path_rates.as_ref().map(|rates| {
            let work = errors.iter().map(|(h, error)| dot(error, &rates[*h]));
            work.sum()
        });
        let by_stroke = self.solver.is_driven().then_some(-mu);
        Some(SheetChange { motions, load: by_path.or(by_stroke) })
    }

    fn solve(&self, forces: &[Motion], stroke: Option<&Stroke>) -> Option<(Configuration, f64)> {
        let pattern = &self.solver.pattern;
        let rhs = pattern.gather(forces);
        let tangent = self.step.tangent.as_ref()?;
        let solution = refined_solve(pattern, tangent, stroke, (&rhs, 0.0))?;
        (solution.error < SINGULAR).then(|| (pattern.spread(&solution.x), solution.mu))
    }

    /// See `path_rates`; `None` if the tangent is singular or nothing moves the supports.
    fn rates_along_path(&self, hinged: HingedSheet) -> Option<Vec<Motion>> {
        let prescribed = self.solver.support_motions();
        let (size, _) = magnitude(&prescribed)?;
        let energies = hinged.energies(&self.step.deformations, Order::Tangent);
        let mut forces = vec![[0.0; 3]; prescribed.len()];
        let hinges = || self.sheet.hinges.iter().zip(&self.motions);
        for ((hinge, motion), energy) in hinges().zip(&energies) {
            let block = motion.stiffness(&energy.tangent, energy.forces);
            let moved = at_hinge(hinge, &prescribed);
            add_at_hinge(&mut forces, hinge, block.map(|row| -dot(&row, &moved)));
        }
        let (mut path, _) = self.solve(&forces, None)?;
        for (motion, prescribed) in std::iter::zip(&mut path, &prescribed) {
            (0..3).for_each(|d| motion[d] = (motion[d] + prescribed[d]) / size);
        }
        let rates = hinges().map(|(hinge, motion)| motion.rates(at_hinge(hinge, &path)));
        Some(rates.collect())
    }
}
