//! The error budget of a run as a table, and what it leaves out.

use analysis::error_budget::{Effect, ErrorBudget};
use serde::Serialize;
use support::table::{Cell, Table};

/// The error budget of the best design.
#[derive(Clone, Debug, Serialize)]
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

/// What the page and the report say above the table.
pub(crate) const BUDGET_HEADING: &str = "error budget of the deployed sheet: standard deviations";

impl Budget {
    pub(super) fn new(
        errors: ErrorBudget,
        left_out: Option<&'static str>,
        dead_loads: bool,
    ) -> Self {
        let not_modelled = left_out.into_iter().chain(NEVER_MODELLED).collect();
        Self { errors, not_modelled, dead_loads }
    }

    /// One row a cause, and the sum.
    pub fn table(&self) -> Table {
        let head = ["cause", "corners, rms\nmm", "maximum\nmm", "load\n%", "from"];
        let mut table = Table::new(head).left(&[0, 4]);
        for part in &self.errors.contributions {
            let [rms, maximum, load] = self.cells(part.effect.as_ref());
            let [cause, source] = [part.cause.name(), &part.source].map(Cell::text);
            table.row([cause, rms, maximum, load, source]);
        }
        let [rms, maximum, load] = self.cells(Some(&self.errors.total));
        let [name, squares] = if self.errors.total.at_least {
            ["at least", "root of the sum of the squares of what is known"]
        } else {
            ["in all", "root of the sum of the squares"]
        };
        table.row([Cell::text(name), rms, maximum, load, Cell::text(squares)]);
        table
    }

    fn cells(&self, effect: Option<&Effect>) -> [Cell; 3] {
        let Some(effect) = effect else {
            return ["not known", "-", "-"].map(Cell::text);
        };
        let [rms, maximum] = effect.corners.map(|length| Cell::fixed(length, 3));
        let load = match effect.load {
            None if self.dead_loads => Cell::text("prescribed"),
            load => Cell::fixed(load.map(|load| 100.0 * load), 2),
        };
        [rms, maximum, load]
    }

    /// What the sum leaves out, as one line.
    pub fn left_out(&self) -> String {
        format!("not in the budget: {}", self.not_modelled.join("; "))
    }
}
