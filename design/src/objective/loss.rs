//! The design objective: the Chamfer distance of the deployed outline to the target, functionals of
//! the deformation paths of the hinges (16), and penalties.

use crate::objective::{
    hinge_measures::add_by_states,
    shape::ShapeDistance,
    term::{Deployed, Term, TermGradient, Weighted, in_words},
};
use indexmap::IndexMap;

/// The unweighted terms of the objective by name, in their order.
pub type TermValues = IndexMap<String, f64>;

/// The terms of the objective and their weights.
#[derive(Clone, Debug)]
pub struct Objective {
    /// The Chamfer distance, with the weight 1.
    pub shape: ShapeDistance,
    /// The functionals of (17)-(19); reported with zero weight too.
    pub functionals: Vec<Weighted>,
    /// The penalties; zero without weight.
    pub penalties: Vec<Weighted>,
}

/// The objective and its partial derivatives at a deployment.
#[derive(Debug)]
pub(crate) struct ObjectiveValue {
    /// L of (16).
    pub loss: f64,
    pub terms: TermValues,
    /// Gradient of the loss; the gradient in the states of the hinges contains the gradient in
    /// their measures.
    pub gradient: TermGradient,
}

impl Objective {
    /// The terms of one sheet with their weights, in the order of [`TermValues`].
    pub(crate) fn terms(&self) -> impl Iterator<Item = (&dyn Term, f64)> {
        let others = self.functionals.iter().chain(&self.penalties);
        let others = others.map(|Weighted { weight, term }| (&**term, *weight));
        std::iter::once((&self.shape as &dyn Term, 1.0)).chain(others)
    }

    /// The names of all terms with their units and weights, in the order of the [`TermValues`] of
    /// an evaluation.
    pub fn weights(&self) -> impl Iterator<Item = (&'static str, Option<&'static str>, f64)> {
        self.terms().map(|(term, weight)| (term.name(), term.unit(), weight))
    }

    /// The names of all terms in words, with their units.
    pub fn labels(&self) -> Vec<String> {
        let label = |(name, unit, _): (&str, Option<&str>, f64)| {
            let unit = unit.map(|unit| format!(" ({unit})"));
            in_words(name) + &unit.unwrap_or_default()
        };
        self.weights().map(label).collect()
    }

    /// Whether the gradient of the objective needs the gradient of the damage of the hinges.
    pub(crate) fn needs_damage_gradient(&self) -> bool {
        self.terms().any(|(term, weight)| weight != 0.0 && term.needs_damage_gradient())
    }

    /// Evaluates a deployed sheet.
    pub(crate) fn evaluate(&self, at: &Deployed) -> ObjectiveValue {
        let mut gradient = TermGradient::zeros(at);
        let mut terms = TermValues::new();
        let mut value = |term: &dyn Term, weight: f64, counts: bool| {
            let value = if counts { term.evaluate(at, weight, &mut gradient) } else { 0.0 };
            terms.insert(term.name().to_owned(), value);
            weight * value
        };
        let shape = value(&self.shape, 1.0, true);
        let functionals = self.functionals.iter();
        let functionals: f64 =
            functionals.map(|Weighted { weight, term }| value(&**term, *weight, true)).sum();
        let mut loss = shape + functionals;
        for Weighted { weight, term } in &self.penalties {
            // A penalty without weight may be infinite: panels may then have any shape.
            loss += value(&**term, *weight, *weight != 0.0);
        }
        add_by_states(at, &mut gradient);
        ObjectiveValue { loss, terms, gradient }
    }
}
