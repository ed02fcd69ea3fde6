//! What a term of the objective is: a function of a deployed sheet, with its derivatives in what
//! the sheet consists of.

use crate::{
    equilibrium::load_step::LoadStep,
    hinge_law::HingeGradient,
    pattern::fit_variables::FitVariables,
    sheet::cut_sheet::{Sheet, SheetGradient},
};
use std::{fmt::Debug, sync::Arc};
use support::vectors;

/// A term of the objective.
pub trait Term: Debug + Send + Sync {
    /// Its name in run states, reports and listings.
    fn name(&self) -> &'static str;

    /// The unit of its value, unless that is dimensionless.
    fn unit(&self) -> Option<&'static str> {
        None
    }

    /// Whether its derivatives need the gradient of the damage of the hinges.
    fn needs_damage_gradient(&self) -> bool {
        false
    }

    /// Its value. The gradient of `weight` times the value is added to `gradient`.
    fn evaluate(&self, at: &Deployed, weight: f64, gradient: &mut TermGradient) -> f64;
}

/// The name of a term in a text.
pub fn in_words(name: &str) -> String {
    name.replace('_', " ")
}

/// A term with its weight.
#[derive(Clone, Debug)]
pub struct Weighted {
    /// In mm^2 over the unit of the term.
    pub weight: f64,
    /// The term.
    pub term: Arc<dyn Term>,
}

impl Weighted {
    /// A term with a weight.
    pub fn new(weight: f64, term: impl Term + 'static) -> Self {
        let term = Arc::new(term);
        Self { weight, term }
    }
}

/// A deployed sheet, as the terms see it.
#[derive(Clone, Copy)]
pub struct Deployed<'a> {
    /// The flat sheet.
    pub sheet: &'a Sheet,
    /// The load steps, without the flat state.
    pub path: &'a [LoadStep],
    /// The deployed positions of the outline points P (mm).
    pub outline: &'a [[f64; 2]],
    /// How the sheet is fitted to its target.
    pub fit: Option<FitVariables>,
}

/// The gradient of weighted terms.
#[derive(Clone, Debug, PartialEq)]
pub struct TermGradient {
    /// In the deployed positions of P.
    pub by_outline: Vec<[f64; 2]>,
    /// Of the sum over hinges, of which terms are the mean: in the measures (eta_a, eta_s, D,
    /// D_peak) of a hinge at a load step.
    pub by_measures: Vec<Vec<[f64; 4]>>,
    /// In the state and the design of each hinge at each load step.
    pub by_states: Vec<Vec<HingeGradient>>,
    /// In the flat sheet, at fixed states and designs of its hinges.
    pub by_sheet: SheetGradient,
    /// In size and rotation of a fitted target.
    pub by_fit: [f64; 2],
}

impl TermGradient {
    /// The gradient of no term.
    pub fn zeros(at: &Deployed) -> Self {
        let (hinges, steps) = (at.sheet.hinges.len(), at.path.len());
        Self {
            by_outline: vec![[0.0; 2]; at.outline.len()],
            by_measures: vec![vec![[0.0; 4]; steps]; hinges],
            by_states: vec![vec![HingeGradient::default(); steps]; hinges],
            by_sheet: SheetGradient::zeros(at.sheet.grid),
            by_fit: [0.0; 2],
        }
    }

    /// Adds `weight` times a gradient in the deployed positions of P.
    pub fn add_by_outline(&mut self, weight: f64, by_outline: &[[f64; 2]]) {
        let sums = self.by_outline.as_flattened_mut();
        vectors::add(sums, by_outline.as_flattened(), weight);
    }

    /// Adds `weight` times a gradient in the flat corners of every panel.
    pub fn add_by_corners(&mut self, weight: f64, by_corners: &[[[f64; 2]; 4]]) {
        let sums = self.by_sheet.corners.as_flattened_mut().as_flattened_mut();
        let entries = by_corners.as_flattened().as_flattened();
        vectors::add(sums, entries, weight);
    }
}
