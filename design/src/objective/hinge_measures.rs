//! Functionals of the deformation path of the hinges; (17)-(19): means over the hinges of a
//! function of one measure along the path of a hinge.

use crate::{
    equilibrium::load_step::LoadStep,
    hinge_law::{DamageMeasure, HingeGradient},
    objective::term::{Deployed, MeasureGradient, TermGradient},
};
use std::iter::zip;

/// A dimensionless measure of the state of a hinge.
#[derive(Clone, Copy, Debug)]
pub enum HingeMeasure {
    /// eta_a = a / w_lig.
    AxialOpening,
    /// eta_s = s / w_lig.
    Shear,
    /// D or D_peak; without values along the path if the hinge law predicts none.
    Damage(DamageMeasure),
}

impl HingeMeasure {
    /// The derivative in the measure.
    fn of(self, gradient: &mut MeasureGradient) -> &mut f64 {
        match self {
            Self::AxialOpening => &mut gradient.eta_a,
            Self::Shear => &mut gradient.eta_s,
            Self::Damage(DamageMeasure::Mean) => &mut gradient.damage,
            Self::Damage(DamageMeasure::Peak) => &mut gradient.peak_damage,
        }
    }

    /// Its values along the path of a hinge.
    fn along(self, at: &Deployed, hinge: usize) -> Vec<f64> {
        let w_lig = at.sheet.hinges[hinge].w_lig;
        let value = |step: &LoadStep| match self {
            Self::AxialOpening => Some(step.deformations[hinge].eta(w_lig)[0]),
            Self::Shear => Some(step.deformations[hinge].eta(w_lig)[1]),
            Self::Damage(measure) => Some(measure.known(step.damage.get(hinge)?).unwrap_or(0.0)),
        };
        at.path.iter().filter_map(value).collect()
    }

    /// The mean over hinges of a function of the values of the measure along the path, which is
    /// given with its slopes in these values; the slopes, which contain the weight of the term, are
    /// added to `gradient`.
    pub fn mean_over_hinges(
        self,
        at: &Deployed,
        gradient: &mut TermGradient,
        function: impl Fn(&[f64]) -> (f64, Vec<f64>),
    ) -> f64 {
        let per_hinge = 1.0 / at.sheet.hinges.len() as f64;
        let mut mean = 0.0;
        for (h, sums) in gradient.by_measures.iter_mut().enumerate() {
            let (value, slopes) = function(&self.along(at, h));
            mean += per_hinge * value;
            for (sum, slope) in zip(sums, slopes) {
                *self.of(sum) += slope;
            }
        }
        mean
    }
}

/// Adds the gradient in the measures to `by_states`, the gradient in each hinge at each load step.
pub(crate) fn add_by_states(at: &Deployed, gradient: &mut TermGradient) {
    let per_hinge = 1.0 / at.sheet.hinges.len() as f64;
    let by_hinges = zip(&gradient.by_measures, &mut gradient.by_states);
    for (h, (by_measures, by_states)) in by_hinges.enumerate() {
        let w_lig = at.sheet.hinges[h].w_lig;
        let by_steps = zip(by_measures, by_states);
        for (step, (by, sums)) in at.path.iter().zip(by_steps) {
            let [eta_a, eta_s] = step.deformations[h].eta(w_lig);
            let by_width = -(by.eta_a * eta_a + by.eta_s * eta_s) / w_lig;
            let mut slopes =
                HingeGradient::from([by.eta_a / w_lig, by.eta_s / w_lig, 0.0, by_width, 0.0, 0.0]);
            if let Some(damage) = step.damage.get(h) {
                let measures =
                    [(by.damage, damage.gradient), (by.peak_damage, damage.peak_gradient)];
                for (by_damage, gradient) in measures.into_iter().filter(|(by, _)| *by != 0.0) {
                    slopes += gradient * by_damage;
                }
            }
            *sums += slopes * per_hinge;
        }
    }
}
