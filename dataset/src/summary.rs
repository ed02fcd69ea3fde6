//! The summary of a database as text.

use crate::check::repeated;
use crate::database::Database;
use crate::manifest::Manifest;
use crate::noise::noise;
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

/// Prints information for judging a database before training: histograms, residuals, coverage of
/// the box, noise, and states solved more than once.
pub struct Details<'a>(pub &'a Database);

/// Number of bins of a histogram, and of cells along each side of the coverage.
const BINS: usize = 8;

impl fmt::Display for Details<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let rows = self.0.rows();
        writeln!(
            f,
            "{:18} rows in {BINS} bins from minimum to maximum",
            "column"
        )?;
        for name in ["w_lig", "alpha", "a", "s", "theta", "W", "D", "D_peak"] {
            let values = values(rows, name);
            let counts = histogram(&values).map(|count| format!("{count:6}"));
            let counts = if values.is_empty() {
                "not known".into()
            } else {
                counts.join(" ")
            };
            writeln!(f, "{name:18} {counts}")?;
        }
        let mut residuals: Vec<f64> = rows.iter().map(|row| row.sample.energy_residual).collect();
        residuals.sort_by(f64::total_cmp);
        let quantile = |share: f64| residuals[(share * (residuals.len() - 1) as f64) as usize];
        writeln!(
            f,
            "energy residual    median {:.1e}, 90 % {:.1e}, 99 % {:.1e}, maximum {:.1e}",
            quantile(0.5),
            quantile(0.9),
            quantile(0.99),
            quantile(1.0),
        )?;
        let cells = BINS * BINS;
        writeln!(
            f,
            "coverage           {} of {cells} cells of (w_lig, alpha), {} of {cells} of (w_lig, theta)",
            covered(rows, |row| [row.design.w_lig, row.design.alpha]),
            covered(rows, |row| [row.design.w_lig, row.sample.theta]),
        )?;
        writeln!(
            f,
            "noise along rays   {:>10} {:>10}  of the root mean square",
            "all", "median"
        )?;
        for (name, [all, median]) in noise(rows) {
            writeln!(
                f,
                "{name:18} {:8.3} % {:8.3} %",
                100.0 * all,
                100.0 * median
            )?;
        }
        writeln!(f, "states solved more than once: {}", repeated(rows).len())
    }
}

/// The values of a column of numbers in the rows that have one.
fn values(rows: &[Row], name: &str) -> Vec<f64> {
    if let Some(column) = schema::NUMBERS.iter().find(|column| column.name == name) {
        return rows.iter().map(column.get).collect();
    }
    match name {
        schema::D_PEAK => rows.iter().filter_map(|row| row.sample.d_peak).collect(),
        _ => Vec::new(),
    }
}

/// The bin of each value, between the minimum and the maximum of all values.
fn bins(values: &[f64]) -> impl Iterator<Item = usize> {
    let minimum = values.iter().copied().fold(f64::INFINITY, f64::min);
    let maximum = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let width = (maximum - minimum).max(f64::MIN_POSITIVE) / BINS as f64;
    let bin = move |value: &f64| (((value - minimum) / width) as usize).min(BINS - 1);
    values.iter().map(bin)
}

fn histogram(values: &[f64]) -> [usize; BINS] {
    let mut counts = [0; BINS];
    bins(values).for_each(|bin| counts[bin] += 1);
    counts
}

/// Number of cells in the plane of two quantities that contain a row.
fn covered(rows: &[Row], point: fn(&Row) -> [f64; 2]) -> usize {
    let [x, y] = [0, 1].map(|k| rows.iter().map(|row| point(row)[k]).collect::<Vec<f64>>());
    bins(&x).zip(bins(&y)).collect::<BTreeSet<_>>().len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::rows;

    /// Rows of older databases have no D_peak.
    #[test]
    fn a_value_that_some_rows_lack_is_counted_where_it_is_known() {
        let mut rows = rows(2);
        rows[0].sample.d_peak = None;
        assert_eq!(values(&rows, "D_peak").len(), rows.len() - 1);
        assert_eq!(values(&rows, "W").len(), rows.len());
    }

    #[test]
    fn histograms_count_every_value_and_constants_are_in_one_bin() {
        assert_eq!(histogram(&[0.0, 1.0, 7.9, 8.0]), [1, 1, 0, 0, 0, 0, 0, 2]);
        assert_eq!(histogram(&[3.0; 5]), [5, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(histogram(&[]).iter().sum::<usize>(), 0);
    }

    #[test]
    fn a_state_and_its_mirror_image_are_one() {
        let mut rows = rows(4);
        assert_eq!(repeated(&rows).len(), 0);
        let mut images = crate::mirror::with_mirrored(&rows[..3]).split_off(3);
        (images.iter_mut()).for_each(|image| image.job += "-image");
        rows.extend(images);
        assert_eq!(repeated(&rows).len(), 3);
        assert!(covered(&rows, |row| [row.design.w_lig, row.sample.theta]) > 8);
    }
}
