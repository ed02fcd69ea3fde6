//! The expected loss under errors of cutting: the mean over the sheets of [`CutSheets`], and its gradient.

use crate::hinge_law::PreparedLaw;
use crate::objective::cut_sheets::{CutSheets, EXCESS};
use crate::objective::design_problem::{
    Deployment, DesignError, DesignProblem, Evaluation, Mechanics, Sensitivities,
};
use crate::pattern::design_vector::DesignVector;
use crate::sheet::deviation::Deviation;

impl DesignProblem {
    /// The weighted excess of the cut sheets over the loss of the sheet as `drawn`; 0 if none counts.
    pub(super) fn weighted_excess(
        &self,
        deployment: &Deployment,
        drawn: f64,
    ) -> Result<f64, DesignError> {
        let Some(sheets) = &self.objective.cut_sheets else {
            return Ok(0.0);
        };
        let losses = self.of_cut_sheets(sheets, deployment, false, |cut, _| self.loss_of(&cut))?;
        let mean = losses.iter().sum::<f64>() / losses.len() as f64;
        Ok(sheets.weight * (mean - drawn))
    }

    /// Adds the weighted excess of the cut sheets, and its gradient, to the evaluation of the sheet as drawn.
    pub(super) fn add_excess(
        &self,
        design: &DesignVector,
        evaluation: &mut Evaluation,
    ) -> Result<(), DesignError> {
        let Some(sheets) = &self.objective.cut_sheets else {
            return Ok(());
        };
        let by_damage = self.objective.needs_damage_gradient();
        let deployment = &evaluation.deployment;
        let found = self.of_cut_sheets(sheets, deployment, by_damage, |cut, law| {
            self.evaluated(design, cut, Some(law))
        })?;
        let share = 1.0 / found.len() as f64;
        let mean = share * found.iter().map(|cut| cut.loss).sum::<f64>();
        let excess = mean - evaluation.loss;
        evaluation.loss += sheets.weight * excess;
        evaluation.terms.insert(EXCESS.to_owned(), excess);
        let residuals = found.iter().map(|cut| cut.adjoint_residual);
        evaluation.adjoint_residual = residuals.fold(evaluation.adjoint_residual, f64::max);
        let parts = std::iter::once((1.0 - sheets.weight, &*evaluation))
            .chain(found.iter().map(|cut| (sheets.weight * share, cut)));
        let parts: Vec<(f64, &Evaluation)> = parts.collect();
        let gradients = parts
            .iter()
            .map(|(part, of)| (*part, of.gradient.to_flat()));
        let gradient = design.with_flat(&sum(gradients));
        let of = |entries: fn(&Sensitivities) -> Vec<f64>| {
            sum((parts.iter()).map(|(part, of)| (*part, entries(&of.sensitivities))))
        };
        let outline = of(|by| by.outline.as_flattened().to_vec());
        let loads = of(|by| by.loads.as_flattened().to_vec());
        let constants = of(|by| by.constants.as_flattened().to_vec());
        evaluation.sensitivities = Sensitivities {
            outline: std::array::from_fn(|corner| [outline[2 * corner], outline[2 * corner + 1]]),
            loads: loads.as_chunks().0.to_vec(),
            constants: constants.as_chunks().0.to_vec(),
        };
        evaluation.gradient = gradient;
        Ok(())
    }

    /// A result of every cut sheet, whose paths are corrected from that of the sheet as drawn.
    fn of_cut_sheets<T>(
        &self,
        sheets: &CutSheets,
        drawn: &Deployment,
        by_damage: bool,
        of: impl Fn(Deployment, (&Mechanics, &dyn PreparedLaw)) -> Result<T, DesignError>,
    ) -> Result<Vec<T>, DesignError> {
        let mechanics = self.model.mechanics().ok_or(DesignError::NoMechanics)?;
        let known = drawn.known_path();
        let one = |deviation: &Deviation| {
            let mechanics = mechanics.as_cut(deviation, sheets.thickness)?;
            let (cut, law) = mechanics.deploy_cut(drawn, deviation, &known, by_damage)?;
            of(cut, (&mechanics, &*law))
        };
        let found: Result<Vec<T>, DesignError> = sheets.deviations.iter().map(one).collect();
        found.map_err(|error| DesignError::CutSheet(Box::new(error)))
    }
}

/// The sum of vectors of one length, each times a number.
fn sum(parts: impl Iterator<Item = (f64, Vec<f64>)>) -> Vec<f64> {
    let scaled = parts.map(|(part, vector)| vector.into_iter().map(|x| part * x).collect());
    scaled
        .reduce(|sum: Vec<f64>, vector| std::iter::zip(sum, vector).map(|(a, b)| a + b).collect())
        .unwrap_or_default()
}
