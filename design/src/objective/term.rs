//! What a term of the objective is: a function of a deployed sheet, with its derivatives in what
//! the sheet consists of.

use crate::{
    equilibrium::load_step::LoadStep,
    hinge_law::HingeGradient,
    sheet::cut_sheet::{Sheet, SheetGradient},
};
use faer::c64;
use std::iter::zip;
use std::{fmt::Debug, sync::Arc};
use support::{Point, vectors};

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
    /// Weight, in mm^2 over the unit of the term.
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
    pub outline: &'a [Point],
}

/// The gradient of weighted terms.
#[derive(Debug)]
pub struct TermGradient {
    /// Gradient in the deployed positions of P.
    pub by_outline: Vec<Point>,
    /// Gradient in the measures of each hinge at each load step, for the sum over hinges instead of
    /// their mean.
    pub by_measures: Vec<Vec<MeasureGradient>>,
    /// Gradient in the state and the design of each hinge at each load step.
    pub by_states: Vec<Vec<HingeGradient>>,
    /// Gradient in the flat sheet, at fixed states and designs of its hinges.
    pub by_sheet: SheetGradient,
}

/// A sum over the panels of functions of their corners, times `scale`. `function` adds its value
/// to the sum, and its gradient.
pub(crate) fn over_panels(
    at: &Deployed,
    weight: f64,
    scale: f64,
    gradient: &mut TermGradient,
    function: impl Fn(&[Point; 4], &mut f64, &mut [c64; 4]),
) -> f64 {
    let mut value = 0.0;
    for (panel, sums) in zip(&at.sheet.panels, &mut gradient.by_sheet.corners) {
        let mut by_corners = [c64::ZERO; 4];
        function(&panel.corners, &mut value, &mut by_corners);
        for (sum, by_corner) in zip(sums, by_corners) {
            *sum += weight * (scale * by_corner);
        }
    }
    scale * value
}

/// The gradient in the measures of a hinge at a load step.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeasureGradient {
    /// Derivative in eta_a.
    pub eta_a: f64,
    /// Derivative in eta_s.
    pub eta_s: f64,
    /// Derivative in D.
    pub damage: f64,
    /// Derivative in D_peak.
    pub peak_damage: f64,
}

impl TermGradient {
    /// The gradient of no term.
    pub fn zeros(at: &Deployed) -> Self {
        let (hinges, steps) = (at.sheet.hinges.len(), at.path.len());
        Self {
            by_outline: vec![[0.0; 2]; at.outline.len()],
            by_measures: vec![vec![MeasureGradient::default(); steps]; hinges],
            by_states: vec![vec![HingeGradient::default(); steps]; hinges],
            by_sheet: SheetGradient::zeros(&at.sheet.topology),
        }
    }

    /// Adds `weight` times a gradient in the deployed positions of P.
    pub fn add_by_outline(&mut self, weight: f64, by_outline: &[Point]) {
        let sums = self.by_outline.as_flattened_mut();
        vectors::add(sums, by_outline.as_flattened(), weight);
    }
}

/// A term of panels with the given corners, and its gradient in them.
#[cfg(test)]
pub(crate) fn on_panels(term: &dyn Term, panels: &[[[f64; 2]; 4]]) -> (f64, Vec<[[f64; 2]; 4]>) {
    use crate::{
        pattern::{
            coordinates::PatternCoordinates,
            cut_pattern::{CutPattern, Outline},
            grid::Grid,
        },
        sheet::cut_sheet::{HingePoint, SheetOptions},
    };
    let grid = Grid { m: 2, n: 2 };
    let uniform = PatternCoordinates::uniform(grid);
    let pattern = CutPattern::new(grid, Outline::rectangle(2.0, 2.0), &uniform).unwrap();
    let process = hinge::HingeConstants::PAPER.into();
    let options = SheetOptions { hinge_point: HingePoint::Corner, process };
    let mut sheet = Sheet::new(&pattern, &[0.1; 4], options).unwrap();
    sheet.panels.truncate(panels.len());
    for (panel, corners) in sheet.panels.iter_mut().zip(panels) {
        panel.corners = *corners;
    }
    let at = Deployed { sheet: &sheet, path: &[], outline: &[] };
    let mut gradient = TermGradient::zeros(&at);
    let value = term.evaluate(&at, 1.0, &mut gradient);
    let by_corners = gradient.by_sheet.corners.into_iter();
    (value, by_corners.map(|corners| corners.map(crate::geometry::plane::point)).collect())
}
