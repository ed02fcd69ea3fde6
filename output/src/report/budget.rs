//! The error budget of a run as a table, and what it leaves out.

use crate::report::columns::{columns, fixed};
use crate::report::self_weight::SelfWeight;
use design::objective::shape::TargetState;
use scene::analysis::error_budget::{Effect, ErrorBudget};
use serde::Serialize;

/// The error budget of the best design.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Budget {
    /// Causes and their sum: standard deviations.
    #[serde(flatten)]
    pub errors: ErrorBudget,
    /// What no contribution contains.
    pub not_modelled: Vec<&'static str>,
    /// Whether the load is prescribed.
    #[serde(skip)]
    dead_loads: bool,
}

/// What the model leaves out of every sheet.
const NEVER_MODELLED: [&str; 4] = [
    "creep",
    "panels and clips that bend, which moves corners little in whole sheets",
    "contact of the flanks of a cut",
    "the error of the finest mesh",
];

/// What the model leaves out of an unloaded sheet.
const UNDER_LOAD: &str =
    "the law of released hinges: the errors apply to the sheet under load, before it was unloaded";

/// What the page and the report say above the table.
pub(crate) const BUDGET_HEADING: &str = "error budget of the deployed sheet: standard deviations";

impl Budget {
    pub(super) fn new(
        errors: ErrorBudget,
        weight: &SelfWeight,
        dead_loads: bool,
        target_state: TargetState,
    ) -> Self {
        let by_posture = weight.left_out();
        let released = (target_state == TargetState::Released).then_some(UNDER_LOAD);
        let left_out = by_posture.into_iter().chain(released);
        Self {
            errors,
            not_modelled: left_out.chain(NEVER_MODELLED).collect(),
            dead_loads,
        }
    }

    /// Head, units, one row a cause, and the sum.
    pub fn rows(&self) -> Vec<[String; 5]> {
        let head = ["cause", "corners, rms", "maximum", "load", "from"];
        let units = ["", "mm", "mm", "%", ""];
        let mut rows = vec![head.map(str::to_owned), units.map(str::to_owned)];
        rows.extend(self.errors.contributions.iter().map(|part| {
            let [rms, maximum, load] = self.cells(part.effect.as_ref());
            [
                part.cause.name().to_owned(),
                rms,
                maximum,
                load,
                part.source.clone(),
            ]
        }));
        let [rms, maximum, load] = self.cells(Some(&self.errors.total));
        let [name, squares] = if self.errors.total.at_least {
            [
                "at least",
                "root of the sum of the squares of what is known",
            ]
        } else {
            ["in all", "root of the sum of the squares"]
        };
        rows.push([name.to_owned(), rms, maximum, load, squares.to_owned()]);
        rows
    }

    fn cells(&self, effect: Option<&Effect>) -> [String; 3] {
        let Some(effect) = effect else {
            return ["not known", "-", "-"].map(str::to_owned);
        };
        let [rms, maximum] = effect.corners.map(|length| fixed(length, 3));
        let load = match effect.load {
            Some(load) => fixed(100.0 * load, 2),
            None if self.dead_loads => "prescribed".into(),
            None => "-".into(),
        };
        [rms, maximum, load]
    }

    /// What the sum leaves out, as one line.
    pub fn left_out(&self) -> String {
        format!("not in the budget: {}", self.not_modelled.join("; "))
    }

    /// The table as lines.
    pub(super) fn text(&self) -> String {
        let rows = self.rows().into_iter().map(Vec::from);
        let table = columns(&rows.collect::<Vec<_>>(), &[0, 4]);
        format!("{BUDGET_HEADING}\n{table}{}\n", self.left_out())
    }
}
