//! The facts of a run: what the sheet is made of, how far it opens under which load, what the hinge
//! law rests on. Report, page, JSON and studio show this list.

mod law;
mod load;
pub(super) mod reached;
mod run;
pub(super) mod sheet;
mod springback;

use crate::report::deployed::{Deployed, Run};
use crate::report::numbers::rounded;
use analysis::unit::Unit;
use serde::Serialize;
use serde_json::Value;

/// A fact of the best design of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fact {
    /// Its name for programs; several facts of a run may have the same.
    pub key: &'static str,
    /// Its name for people.
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

type Facts = fn(&Deployed, &Run) -> Vec<Fact>;

/// The pages that explain facts, and the facts.
const FACTS: [(&str, Facts); 7] = [
    ("docs/RUN-PAGE.md", sheet::material_and_size),
    ("docs/NUMERICS.md", reached::load_and_stroke),
    ("docs/HOLDING.md", load::holding_and_weight),
    ("docs/LIMITS.md", springback::springback_and_creep),
    ("docs/MATERIALS.md", law::domain_and_weights),
    ("docs/CHOOSE.md", run::levels_and_findings),
    ("docs/RUN-PAGE.md", sheet::hashes),
];

/// All facts of a run.
pub(super) fn facts(of: &Deployed, run: &Run) -> Vec<Fact> {
    let mut all = Vec::new();
    for (page, facts) in FACTS {
        all.extend(facts(of, run).into_iter().map(|fact| Fact { page, ..fact }));
    }
    all
}

/// A fact whose value is said in words.
fn fact(
    [key, label]: [&'static str; 2],
    value: impl Serialize,
    unit: Unit,
    text: impl Into<String>,
) -> Fact {
    let value = serde_json::to_value(value).unwrap_or_default();
    Fact { key, label, value, unit, text: text.into(), page: "" }
}

/// A fact that is a number, with `digits` and a remark.
fn number(names: [&'static str; 2], value: f64, digits: usize, unit: Unit, remark: &str) -> Fact {
    fact(names, value, unit, format!("{} {unit}{remark}", rounded(value, digits)))
}

/// A fact that is a text.
fn text(names: [&'static str; 2], text: String) -> Fact {
    fact(names, &text, Unit::None, text.clone())
}
