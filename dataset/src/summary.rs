//! The summary of a database as text.

use crate::database::Database;
use crate::manifest::Manifest;
use crate::rows::Row;
use crate::schema;
use crate::split::Part;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// What a summary states of the rows beyond the manifest.
#[derive(Clone, Debug)]
pub(crate) struct Contents {
    /// The minimum and the maximum of every column of numbers.
    ranges: [[f64; 2]; schema::NUMBERS.len()],
    /// The rays that were solved on another tier than that of their campaign, with that tier.
    other_tiers: BTreeMap<String, String>,
}

impl Default for Contents {
    /// Of no rows.
    fn default() -> Self {
        Self {
            ranges: [[f64::INFINITY, f64::NEG_INFINITY]; schema::NUMBERS.len()],
            other_tiers: BTreeMap::new(),
        }
    }
}

impl Contents {
    /// Adds rows.
    pub fn add(&mut self, rows: &[Row]) {
        for row in rows {
            for ([minimum, maximum], column) in self.ranges.iter_mut().zip(&schema::NUMBERS) {
                let value = (column.get)(row);
                *minimum = minimum.min(value);
                *maximum = maximum.max(value);
            }
            if !row.is_as_asked() {
                (self.other_tiers).insert(row.job.clone(), row.solved_tier.clone());
            }
        }
    }
}

impl fmt::Display for Database {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mut contents = Contents::default();
        contents.add(self.rows());
        Summary {
            manifest: self.manifest(),
            contents: &contents,
        }
        .fmt(f)
    }
}

/// Prints counts, rejected rows, the rays on another mesh, the split, and the range of every column of numbers.
pub(crate) struct Summary<'a> {
    pub manifest: &'a Manifest,
    pub contents: &'a Contents,
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let manifest = self.manifest;
        writeln!(
            f,
            "{} rows of {} rays ({} partial) over {} geometries; {}, tier {}; {:.0} CPU s",
            manifest.rows,
            manifest.rays,
            manifest.partial_rays,
            manifest.geometries,
            manifest.material,
            manifest.tier,
            manifest.cpu_s,
        )?;
        writeln!(
            f,
            "material law {}, campaign settings {}",
            known(&manifest.material_hashes),
            known(&manifest.settings_hashes),
        )?;
        for (reason, count) in &manifest.rejected {
            writeln!(f, "rejected {count} rows: {reason}")?;
        }
        for (job, tier) in &self.contents.other_tiers {
            writeln!(f, "ray {job} was solved on the mesh {tier}")?;
        }
        let rays = |part| manifest.split.jobs(part).len();
        writeln!(
            f,
            "split by geometry: {} rays for training, {} for validation, {} for test",
            rays(Part::Training),
            rays(Part::Validation),
            rays(Part::Test),
        )?;
        writeln!(
            f,
            "{:18} {:>14} {:>14}  unit",
            "column", "minimum", "maximum"
        )?;
        for (column, [minimum, maximum]) in schema::NUMBERS.iter().zip(self.contents.ranges) {
            let (name, unit) = (column.name, column.unit);
            writeln!(f, "{name:18} {minimum:14.6} {maximum:14.6}  {unit}")?;
        }
        Ok(())
    }
}

/// Hashes as readable text.
fn known(hashes: &BTreeSet<String>) -> String {
    let known: Vec<&str> = hashes
        .iter()
        .map(String::as_str)
        .filter(|hash| !hash.is_empty())
        .collect();
    if known.is_empty() {
        "not known".into()
    } else {
        known.join(" + ")
    }
}
