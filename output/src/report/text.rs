//! The report as text for people: about sixty lines for a small sheet.

use crate::report::columns::{columns, fixed, rounded};
use crate::report::{HingeRow, Report};
use design::objective::scores::{Scores, shown};
use scene::analysis::design_checks::WholeSheet;
use scene::analysis::levels::Levels;
use std::cmp::Ordering;
use std::fmt;
use support::severity::Severity;

/// Maximum number of hinges of which all are listed.
const ALL_LISTED: usize = 24;
/// Number of hinges that are listed of a larger sheet.
const WORST_LISTED: usize = 20;

const LEGEND: &str = "\
w_lig    ligament width; alpha: angle between the cuts
theta    opening in the last state of the path
eta      a / w_lig and s / w_lig there: axial opening and shear of the ligament over its width
D        maximum along the path of the mean damage of the ligament, and D_peak of its most strained 1 %,
         which tears at 1; ?: not known, since the hinge left the training domain of its law; -: no prediction
domain   whether every state of the path is inside the training domain
";

const GAMMA: &str = "Gamma    (21): moment of the weight of a panel that lies on a surface over the moment of its folded ligament\n";

const OUTLINE_ROSE: &str = "\
The outline error is larger than at the start although the loss is smaller: the loss also weighs how well the outline
covers the target, and the terms above. Lower their weights in [objective] for a closer outline.
";

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(
            f,
            "{}: level {}\n{}",
            self.title,
            self.facts.level,
            self.miss()
        )?;
        if let Some(text) = self.about_cut_files() {
            writeln!(f, "{text}")?;
        }
        (self.errors()).try_for_each(|error| writeln!(f, "- {error}"))?;
        writeln!(f, "{}\n\n{}", self.end_of_search(), self.objective())?;
        let facts = self.fact_rows();
        let width = facts.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        for (name, value) in facts {
            writeln!(f, "{name:<width$}  {value}")?;
        }
        if let Some(budget) = &self.budget {
            write!(f, "\n{}", budget.text())?;
        }
        let gamma = if self.states_gamma() { GAMMA } else { "" };
        writeln!(f, "\n{}\n{LEGEND}{gamma}", self.hinge_table())?;
        let warned = (self.warnings.iter()).any(|warning| warning.severity > Severity::Note);
        writeln!(f, "{}", if warned { "warnings" } else { "no warnings" })?;
        (self.warnings.iter()).try_for_each(|warning| writeln!(f, "- {warning}"))
    }
}

impl Report {
    /// The facts of the run, the spread of the ensemble and the number of warnings, as names and values with units.
    pub fn fact_rows(&self) -> Vec<(&'static str, String)> {
        let mut rows = self.facts.rows();
        let hashes = rows.iter().position(|(name, _)| name.starts_with("hash"));
        let mut further: Vec<_> = (self.climb().into_iter())
            .map(|line| ("ladder", line))
            .collect();
        if let Some(estimate) = &self.estimate {
            let percent = |x: f64| format!("{:.1} %", 100.0 * x);
            let text = format!(
                "{} networks; standard deviation inside the domain: energy {}, forces {}, D_peak {}",
                estimate.networks,
                percent(estimate.energy),
                percent(estimate.forces),
                estimate.damage_peak.map_or("-".into(), percent)
            );
            further.push(("ensemble", text));
        }
        further.extend(self.checks.levels.as_ref().map(level_row));
        further.extend(self.checks.whole_sheet.as_ref().map(whole_sheet_row));
        let count = |severity| {
            let severities = self.warnings.iter().map(|warning| warning.severity);
            severities.filter(|found| *found == severity).count()
        };
        let [errors, warnings, notes] =
            [Severity::Error, Severity::Warning, Severity::Note].map(count);
        let text = format!("errors {errors}, warnings {warnings}, notes {notes}");
        further.push(("findings", text));
        let at = hashes.unwrap_or(rows.len());
        rows.splice(at..at, further);
        rows
    }

    /// The objective at the start and at the best design.
    fn objective(&self) -> String {
        let rows = |scores: &Scores| {
            let mut rows = vec![("outline error (mm)".to_owned(), scores.outline_error)];
            let values = scores.terms.values().copied();
            rows.extend(self.terms.iter().cloned().zip(values));
            rows.push(("loss (mm^2)".to_owned(), scores.loss));
            if self.facts.has_domain {
                rows.push(("inside domain (%)".to_owned(), 100.0 * scores.share_inside));
            }
            rows
        };
        let mut table = vec![["", "start", "best"].map(str::to_owned).to_vec()];
        let pairs = std::iter::zip(rows(&self.before), rows(&self.after));
        table.extend(pairs.map(|((name, before), (_, after))| {
            vec![format!("{name:<20}"), shown(before), shown(after)]
        }));
        let rose = self.after.outline_error > self.before.outline_error;
        let why = if rose && self.after.loss < self.before.loss {
            OUTLINE_ROSE
        } else {
            ""
        };
        columns(&table, &[]) + why
    }

    /// Whether Gamma is stated, which is of a sheet that lies on a surface.
    fn states_gamma(&self) -> bool {
        self.facts.gamma_min.is_some()
    }

    /// The hinges; of a large sheet those that are nearest to failure.
    fn hinge_table(&self) -> String {
        let mut listed: Vec<&HingeRow> = self.hinges.iter().collect();
        let mut head = String::new();
        if listed.len() > ALL_LISTED {
            listed.sort_by(|one, other| worst_first(one, other));
            listed.truncate(WORST_LISTED);
            head = format!(
                "the worst {WORST_LISTED} of {} hinges: first those that left the domain, then by damage and strain;\n\
                 all hinges: report.json and run.html\n",
                self.hinges.len()
            );
        }
        let names = [
            "hinge", "panels", "w_lig", "alpha", "theta", "eta_a", "eta_s", "D", "D_peak",
            "domain", "Gamma",
        ];
        let units = ["", "", "mm", "deg", "deg"];
        let mut table = vec![
            names.map(str::to_owned).to_vec(),
            units.map(str::to_owned).to_vec(),
        ];
        table.extend(listed.into_iter().map(HingeRow::cells));
        if !self.states_gamma() {
            // The last column.
            table
                .iter_mut()
                .for_each(|row| row.truncate(names.len() - 1));
        }
        head + &columns(&table, &[])
    }
}

/// How far the levels of a run are from its finest one.
fn level_row(levels: &Levels) -> (&'static str, String) {
    let finest = levels.levels.last().map_or("", |level| level.level.name());
    let others = levels.levels.iter().filter_map(|level| {
        let corners = level.difference.as_ref()?.corners[1];
        Some(format!("`{}` {}", level.level, rounded(corners, 2)))
    });
    let others: Vec<String> = others.collect();
    let text = format!(
        "largest difference of a corner to `{finest}`, mm: {}",
        others.join(", ")
    );
    ("levels", text)
}

/// The whole sheet by finite elements in one line.
fn whole_sheet_row(sheet: &WholeSheet) -> (&'static str, String) {
    let [rms, largest] = sheet.corners.map(|length| rounded(length, 2));
    let load = sheet.load.map_or(String::new(), |[law, elements]| {
        let [law, elements] = [law, elements].map(|load| rounded(load, 4));
        format!("; load {elements} N, {law} N by the hinge law")
    });
    let text = format!(
        "by finite elements, {}: panels tilt by up to {} deg; corners {rms} mm (rms), {largest} mm at most, from the hinge law{load}",
        sheet.support.in_words(),
        rounded(sheet.tilt_deg, 2)
    );
    ("whole sheet", text)
}

impl HingeRow {
    fn cells(&self) -> Vec<String> {
        let unknown = if self.inside { "-" } else { "?" };
        let [damage, peak] = [self.damage, self.damage_peak]
            .map(|damage| damage.map_or(unknown.into(), |damage| fixed(damage, 4)));
        vec![
            self.hinge.to_string(),
            format!("{}-{}", self.panels[0], self.panels[1]),
            fixed(self.w_lig, 2),
            fixed(self.alpha_deg, 1),
            fixed(self.theta_deg, 1),
            fixed(self.eta_a, 3),
            fixed(self.eta_s, 3),
            damage,
            peak,
            if self.inside { "inside" } else { "left" }.to_owned(),
            self.gamma.map_or("-".to_owned(), |gamma| rounded(gamma, 3)),
        ]
    }

    /// Damage, or without it the translation of the ligament over its width.
    fn strain(&self) -> f64 {
        let translation = self.eta_a.abs().max(self.eta_s.abs());
        self.damage_peak.or(self.damage).unwrap_or(translation)
    }
}

/// The order of hinges by their distance from failure.
pub(crate) fn worst_first(one: &HingeRow, other: &HingeRow) -> Ordering {
    let by_strain = other.strain().total_cmp(&one.strain());
    one.inside.cmp(&other.inside).then(by_strain)
}
