//! The findings about a design, to be checked before cutting. A rule finds one, or nothing, and
//! says what docs/WARNINGS.md explains; report, page, JSON and studio show what is found.

mod geometry;
mod law;
mod load;

use crate::report::deployed::DeployedDesign;
use serde::Serialize;
use std::{cmp::Reverse, fmt};
use support::severity::Severity;

/// A limit of the model or of fabrication that a design exceeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    /// The name of the rule that found it.
    pub concern: &'static str,
    /// The consequence.
    pub severity: Severity,
    /// The hinges concerned; empty if the whole sheet is concerned.
    pub hinges: Vec<usize>,
    /// The limit that is exceeded, in words.
    pub message: String,
    /// What helps.
    pub remedy: &'static str,
}

/// A rule about designs.
#[derive(Clone, Copy)]
pub struct Rule {
    /// Its name for programs.
    pub concern: &'static str,
    /// The usual consequence of its findings.
    pub severity: Severity,
    /// What it finds.
    pub subject: &'static str,
    /// What that means.
    pub meaning: &'static str,
    /// What helps.
    pub remedy: &'static str,
    find: fn(&DeployedDesign) -> Option<Found>,
}

/// What a rule finds of a design.
struct Found {
    /// The consequence, if it is not the usual one.
    severity: Option<Severity>,
    hinges: Vec<usize>,
    message: String,
}

/// First the rules about the sheet, then about its hinge law, then about its path and loads.
pub fn rules() -> impl Iterator<Item = Rule> {
    geometry::RULES.into_iter().chain(law::RULES).chain(load::RULES)
}

/// All that the rules find, the most severe first.
pub(super) fn findings(of: &DeployedDesign) -> Vec<Warning> {
    let mut warnings: Vec<Warning> =
        rules().filter_map(|rule| Some(rule.warning((rule.find)(of)?))).collect();
    let by_elements = of.whole_sheet().into_iter().flat_map(|sheet| &sheet.findings);
    warnings.extend(by_elements.map(|finding| {
        let message = format!("by finite elements, {}", finding.message);
        load::WHOLE_SHEET.warning(found(message).with(finding.severity))
    }));
    warnings.sort_by_key(|warning| Reverse(warning.severity));
    warnings
}

const fn rule(
    concern: &'static str,
    severity: Severity,
    [subject, meaning, remedy]: [&'static str; 3],
    find: fn(&DeployedDesign) -> Option<Found>,
) -> Rule {
    Rule { concern, severity, subject, meaning, remedy, find }
}

fn found(message: impl Into<String>) -> Found {
    Found { severity: None, hinges: Vec::new(), message: message.into() }
}

/// A finding about the hinges, if there are any.
fn at(hinges: Vec<usize>, message: impl Into<String>) -> Option<Found> {
    (!hinges.is_empty()).then(|| Found { hinges, ..found(message) })
}

impl Found {
    fn with(self, severity: Severity) -> Self {
        Self { severity: Some(severity), ..self }
    }
}

impl Rule {
    fn warning(&self, Found { severity, hinges, message }: Found) -> Warning {
        let Self { concern, remedy, .. } = *self;
        Warning { concern, severity: severity.unwrap_or(self.severity), hinges, message, remedy }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        const NAMED: usize = 12;
        write!(f, "{}: {}", self.severity, self.message)?;
        let named: Vec<String> = self.hinges.iter().take(NAMED).map(usize::to_string).collect();
        match self.hinges.len() {
            0 => Ok(()),
            1 => write!(f, " (hinge {})", named[0]),
            2..=NAMED => write!(f, " (hinges {})", named.join(", ")),
            all => write!(f, " (hinges {} and {} more)", named.join(", "), all - NAMED),
        }
    }
}
