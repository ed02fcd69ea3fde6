//! The summary of a database as text.

use crate::database::Database;
use crate::manifest::{FinerMesh, Manifest};
use crate::schema::COLUMNS;
use crate::split::Subset;
use fe_driver::SolvedRay;
use mesher::Tier;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use support::Joined;
use support::table::Table;

/// What a summary states of the rays beyond the manifest.
#[derive(Debug)]
pub(crate) struct Contents {
    /// The minimum and the maximum of every column; infinite without a number.
    ranges: [[f64; 2]; COLUMNS.len()],
    /// Number of rays that were solved on another tier than the tier of their campaign, by the tier
    /// on which they were solved.
    other_tiers: BTreeMap<Tier, usize>,
}

impl Default for Contents {
    fn default() -> Self {
        Self {
            ranges: [[f64::INFINITY, f64::NEG_INFINITY]; COLUMNS.len()],
            other_tiers: BTreeMap::new(),
        }
    }
}

impl Contents {
    /// Adds a ray.
    pub(crate) fn add(&mut self, ray: &SolvedRay) {
        for sample in &ray.samples {
            for ([minimum, maximum], column) in self.ranges.iter_mut().zip(&COLUMNS) {
                let value = column.number(ray, sample).unwrap_or(f64::NAN);
                *minimum = minimum.min(value);
                *maximum = maximum.max(value);
            }
        }
        if !ray.at_requested_tier() {
            *self.other_tiers.entry(ray.solved_tier).or_default() += 1;
        }
    }
}

impl fmt::Display for Database {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mut contents = Contents::default();
        self.rays().iter().for_each(|ray| contents.add(ray));
        contents.summary(self.manifest(), f)
    }
}

impl Contents {
    /// Prints counts, the finer mesh, rejected rows, the rays on another mesh, the split, and what
    /// each column holds.
    pub(crate) fn summary(&self, manifest: &Manifest, f: &mut fmt::Formatter) -> fmt::Result {
        let Manifest { rows, rays, partial_rays, geometries, material, tier, cpu_s, .. } = manifest;
        writeln!(
            f,
            "{rows} rows of {rays} rays ({partial_rays} partial) over {geometries} geometries; \
             {material}, tier {tier}; {cpu_s:.0} CPU s"
        )?;
        if let Some(FinerMesh { tier, rays, cpu_s }) = &manifest.finer {
            writeln!(f, "{rays} of the rays also on tier {tier}; {cpu_s:.0} CPU s")?;
        }
        let count: usize = self.other_tiers.values().sum();
        if count > 0 {
            let were = if count == 1 { "ray was" } else { "rays were" };
            let tiers = self.other_tiers.iter().map(|(tier, count)| format!("{tier} ({count})"));
            let tiers = tiers.joined(", ");
            writeln!(f, "{count} {were} solved on another mesh after a failure: {tiers}")?;
        }
        let [law, settings] = [&manifest.material_hashes, &manifest.settings_hashes].map(known);
        writeln!(f, "material law {law}, campaign settings {settings}")?;
        for (reason, count) in &manifest.rejected {
            writeln!(f, "rejected {count} rows: {reason}")?;
        }
        let [training, validation, test] = [Subset::Training, Subset::Validation, Subset::Test]
            .map(|part| manifest.split.jobs(part).len());
        writeln!(
            f,
            "split by geometry: {training} rays for training, {validation} for validation, \
             {test} for test"
        )?;
        let head = ["column", "minimum", "maximum", "unit", "meaning"];
        let mut numbers = Table::new(head).left(&[0, 3, 4]);
        let mut texts = Table::new(["column of text", "meaning"]).left(&[0, 1]);
        for (column, range) in COLUMNS.iter().zip(self.ranges) {
            if column.is_text() {
                texts.row([column.name, column.meaning]);
                continue;
            }
            let [minimum, maximum] = &range.map(limit);
            numbers.row([column.name, minimum, maximum, column.unit, column.meaning]);
        }
        writeln!(f, "\n{numbers}\n\n{texts}")
    }
}

/// A limit of a range; `-` if no row has a value.
fn limit(value: f64) -> String {
    if value.is_finite() { format!("{value:.6}") } else { "-".into() }
}

/// Hashes as readable text.
fn known(hashes: &BTreeSet<String>) -> String {
    let known = hashes.iter().map(String::as_str).filter(|hash| !hash.is_empty()).joined(" + ");
    if known.is_empty() { "not known".into() } else { known }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::tests::{finer, rays};
    use crate::split::SplitPlan;
    use hinge::HingeSample;
    use testkit::changed;

    fn summary(rays: Vec<SolvedRay>) -> String {
        let database = Database::collect(rays, &SplitPlan::default());
        database.unwrap().to_string()
    }

    #[test]
    fn a_finer_mesh_has_a_line_of_its_own() {
        let both = summary([rays(10), finer(rays(4))].concat());
        let lines: Vec<&str> = both.lines().collect();
        assert_eq!(
            lines[..2],
            [
                "140 rows of 10 rays (1 partial) over 10 geometries; film, tier default; 100 CPU s",
                "4 of the rays also on tier reference; 40 CPU s"
            ]
        );
        assert!(!summary(rays(10)).contains("of the rays also on tier"));
    }

    #[test]
    fn rays_on_another_mesh_are_counted_by_its_tier() {
        let retried = |tiers: &[(&str, Tier)]| {
            let text = summary(changed(rays(10), |ray| {
                if let Some((_, tier)) = tiers.iter().find(|(job, _)| ray.job == *job) {
                    ray.solved_tier = *tier;
                }
            }));
            let mut lines = text.lines().map(str::to_owned);
            lines.find(|line| line.contains("after a failure"))
        };
        assert_eq!(retried(&[]), None);
        assert_eq!(
            retried(&[("job-007", Tier::Fine)]).unwrap(),
            "1 ray was solved on another mesh after a failure: fine (1)"
        );
        let three = [("job-002", Tier::Fine), ("job-005", Tier::Plate), ("job-007", Tier::Fine)];
        assert_eq!(
            retried(&three).unwrap(),
            "3 rays were solved on another mesh after a failure: fine (2), plate (1)"
        );
    }

    #[test]
    fn every_column_has_a_line_with_its_unit_and_its_meaning() {
        let text = summary(rays(10));
        for column in &COLUMNS {
            let name = format!(" {} ", column.name);
            let mut lines = text.lines().filter(|line| line.starts_with(&name));
            let line = lines.next().unwrap();
            assert!(line.ends_with(column.meaning) && !column.meaning.is_empty(), "{line}");
            assert!(column.unit.is_empty() || line.contains(&format!("   {} ", column.unit)));
            assert_eq!(lines.next(), None, "{name}");
        }
        let mut damage = text.lines().filter(|line| line.starts_with(" D "));
        let words: Vec<_> = damage.next().unwrap().split_whitespace().collect();
        assert_eq!(words[..4], ["D", "0.001000", "0.010000", "mean"], "{text}");
    }

    #[test]
    fn a_column_without_values_has_no_range() {
        let mut unknown = rays(10);
        unknown[0].samples[7].d_peak = None;
        let range = |rays: Vec<SolvedRay>| {
            let text = summary(rays);
            let mut lines = text.lines().map(str::split_whitespace);
            let mut of_peak = lines.find(|words| words.clone().next() == Some("D_peak"));
            let words = of_peak.as_mut().unwrap().skip(1).take(2);
            words.map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(range(unknown.clone()), ["0.010000", "0.100000"]);
        let none = |sample: &mut HingeSample| sample.d_peak = None;
        unknown.iter_mut().flat_map(|ray| &mut ray.samples).for_each(none);
        assert_eq!(range(unknown), ["-", "-"]);
    }
}
