//! The report as parts for people: about sixty lines for a small sheet.

use crate::report::{BUDGET_HEADING, HingeRow, Report, numbers::rounded};
use design::objective::scores::{Scores, shown};
use std::cmp::Ordering;
use support::{
    document::Document,
    severity::Severity,
    table::{Cell, Columns, Table},
};

/// Maximum number of hinges that are all listed.
const ALL_LISTED: usize = 24;
/// Number of hinges that are listed of a larger sheet.
const WORST_LISTED: usize = 20;

const LEGEND: &str = "\
w_lig    ligament width; alpha: angle between the cuts
theta    opening in the last state of the path
eta      a / w_lig and s / w_lig there: axial opening and shear of the ligament over its width
D        maximum along the path of the mean damage of the ligament, and D_peak of its most strained 1 %,
         which tears at 1; ?: not known, since the hinge left the training domain of its law; -: no prediction
domain   whether every state of the path is inside the training domain";

const OUTLINE_ROSE: &str = "\
The outline error rose while the loss fell: of the Chamfer distance, its square is only the part from the corners of the sheet
to the target. The other part, from the target to the corners, is large where panels are, and terms such as damage have weights.";

impl Report {
    /// The report as parts for people.
    pub fn document(&self) -> Document {
        let mut page = Document::default();
        let mut head = format!("{}: level {}\n{}", self.title, self.level, self.miss);
        if let Some(text) = self.about_cut_files() {
            head += "\n";
            head += text;
        }
        page.text(head);
        page.list(self.errors());
        let [start, best] = [&self.before, &self.after].map(|scores| rounded(scores.loss, 4));
        let search = self.end_of_search();
        page.text(format!("{search}; loss, which is minimised: {start} at the start, {best} mm^2"));
        if self.after.loss != self.before.loss {
            page.table(self.objective());
        }
        if self.rose() {
            page.text(OUTLINE_ROSE);
        }
        let mut facts = Table::new(["", ""]).left(&[0, 1]);
        for fact in &self.facts {
            facts.row([fact.label, &fact.text]);
        }
        page.table(facts);
        if let Some(budget) = &self.budget {
            page.text(BUDGET_HEADING);
            page.table(budget.table());
            page.text(budget.left_out());
        }
        self.add_hinges(&mut page);
        let warned = (self.warnings.iter()).any(|warning| warning.severity > Severity::Note);
        page.text(if warned { "warnings" } else { "no warnings" });
        page.list(&self.warnings);
        page
    }

    /// The objective at the start and at the best design.
    fn objective(&self) -> Table {
        let rows = |scores: &Scores| {
            let mut rows = vec![
                ("loss (mm^2)".to_owned(), scores.loss),
                ("outline error (mm)".to_owned(), scores.outline_error),
            ];
            let values = scores.terms.values().copied();
            rows.extend(self.terms.iter().cloned().zip(values));
            if self.has_domain {
                rows.push(("inside domain (%)".to_owned(), 100.0 * scores.share_inside));
            }
            rows
        };
        let mut table = Table::new(["", "start", "best"]);
        let pairs = std::iter::zip(rows(&self.before), rows(&self.after));
        for ((name, before), (_, after)) in pairs {
            table.row([name, shown(before), shown(after)]);
        }
        table
    }

    /// Whether the outline is further off although the loss is smaller.
    fn rose(&self) -> bool {
        let [before, after] = [&self.before, &self.after];
        after.outline_error > before.outline_error && after.loss < before.loss
    }

    /// The hinges; of a large sheet those that are nearest to failure.
    fn add_hinges(&self, page: &mut Document) {
        let mut listed: Vec<&HingeRow> = self.hinges.iter().collect();
        if listed.len() > ALL_LISTED {
            listed.sort_by(|one, other| worst_first(one, other));
            listed.truncate(WORST_LISTED);
            page.text(format!(
                "the worst {WORST_LISTED} of {} hinges: first those that left the domain, then by damage and strain; \
                 all hinges: report.json and run.html",
                self.hinges.len()
            ));
        }
        page.table(hinge_columns().table(listed));
        page.text(LEGEND);
    }
}

/// The columns of a table of hinges.
fn hinge_columns() -> Columns<'static, HingeRow> {
    let damage = |row: &HingeRow, damage: Option<f64>| {
        let unknown = if row.inside { "-" } else { "?" };
        Cell::known(damage.map(|damage| Cell::fixed(damage, 4)), unknown)
    };
    Columns::new()
        .column("hinge", |row: &HingeRow| row.hinge)
        .column("panels", |row| format!("{}-{}", row.panels[0], row.panels[1]))
        .column("w_lig\nmm", |row| Cell::fixed(row.w_lig, 2))
        .column("alpha\ndeg", |row| Cell::fixed(row.alpha_deg, 1))
        .column("theta\ndeg", |row| Cell::fixed(row.theta_deg, 1))
        .column("eta_a", |row| Cell::fixed(row.eta_a, 3))
        .column("eta_s", |row| Cell::fixed(row.eta_s, 3))
        .column("D", move |row| damage(row, row.damage))
        .column("D_peak", move |row| damage(row, row.damage_peak))
        .column("domain", |row| if row.inside { "inside" } else { "left" })
}

impl HingeRow {
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
