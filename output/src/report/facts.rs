//! The facts of a run: what the sheet is made of, how far it opens under which load, what the hinge
//! law rests on. Report, page, JSON and studio show this list.

mod design;
mod load;
mod mounting;

pub(crate) use mounting::{open_by_hand, step as mounting_step};

use crate::report::{
    deployed::{DeployedDesign, FinishedRun},
    numbers::rounded,
};
use analysis::unit::Unit;
use serde::Serialize;
use serde_json::Value;

/// A fact of the best design of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Fact {
    /// Its name; several facts of a run may have the same.
    pub label: &'static str,
    /// A number in `unit`, several, a text or an object; null if unknown.
    pub value: Value,
    /// The unit of numbers.
    pub unit: Unit,
    /// Value and unit in words.
    pub text: String,
    /// The page that explains it.
    pub page: &'static str,
}

type Facts = fn(&DeployedDesign, &FinishedRun) -> Vec<Fact>;

/// The pages that explain facts, and the facts.
const FACTS: [(&str, Facts); 10] = [
    ("docs/RUN-PAGE.md", design::material_and_size),
    ("docs/NUMERICS.md", load::load_and_stroke),
    ("docs/HOLDING.md", load::holding_and_weight),
    ("docs/HOLDING.md", mounting::mounting),
    ("docs/HOLDING.md", mounting::what_if),
    ("docs/FIRST-SHEET.md", design::services),
    ("docs/LIMITS.md", load::springback_and_creep),
    ("docs/MATERIALS.md", design::domain_and_weights),
    ("docs/CHOOSE.md", design::levels_and_findings),
    ("docs/RUN-PAGE.md", design::hashes),
];

/// All facts of a run.
pub(super) fn facts(of: &DeployedDesign, run: &FinishedRun) -> Vec<Fact> {
    let mut all = Vec::new();
    for (page, facts) in FACTS {
        all.extend(facts(of, run).into_iter().map(|fact| Fact { page, ..fact }));
    }
    all
}

/// A fact that is said in words.
fn fact(label: &'static str, value: impl Serialize, text: impl Into<String>) -> Fact {
    let value = serde_json::to_value(value).unwrap_or_default();
    Fact { label, value, unit: Unit::None, text: text.into(), page: "" }
}

/// A fact that is a number, with `digits` and a remark.
fn number(label: &'static str, value: f64, digits: usize, unit: Unit, remark: &str) -> Fact {
    let text = format!("{} {unit}{remark}", rounded(value, digits));
    Fact { unit, ..fact(label, value, text) }
}

/// A fact that is a text.
fn text(label: &'static str, text: String) -> Fact {
    fact(label, &text, text.clone())
}
