//! Rows of a record that are not a monotone loading: unloading loops, rows after the break,
//! repeated and shaking strains.

use crate::isotonic::pools;
use crate::record::RecordRow;
use serde::Serialize;

/// Why a row is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Unloading and reloading up to the strain before it.
    Unloading,
    /// After the break of the specimen.
    Broken,
    /// Slack and toe, below the linear part.
    Toe,
}

/// A row that is not used.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DroppedRow {
    /// Number of the line in the file, from 1.
    pub line: u64,
    /// Nominal strain.
    pub strain: f64,
    /// Nominal stress (MPa).
    pub stress: f64,
    /// Why.
    pub cause: Cause,
}

/// The monotone part of a record.
#[derive(Clone, Debug)]
pub(super) struct Cleaned {
    /// [strain, stress (MPa)] with increasing strain.
    pub curve: Vec<[f64; 2]>,
    /// The rows that were dropped.
    pub dropped: Vec<DroppedRow>,
    /// Number of rows that were averaged with their neighbours, because their strain does not
    /// increase.
    pub averaged: usize,
    /// Standard deviations of the noise of strain and stress.
    pub noise: [f64; 2],
}

/// Fall of the strain, in standard deviations of its noise, that is an unloading and not noise.
const LOOP: f64 = 10.0;
/// A specimen is broken where its stress falls below this fraction of the stress before, and stays
/// there.
const BROKEN: f64 = 0.5;
/// Minimum number of rows from which noise is estimated: in fewer, it cannot be distinguished from
/// the bend of the curve.
const MIN_NOISE_ROWS: usize = 20;
/// Number of rows whose median is the stress before the break.
const BEFORE: usize = 5;

/// The monotone part of the rows; the error is the line from which the strain falls for most of the
/// file.
pub(super) fn cleaned(rows: &[RecordRow]) -> Result<Cleaned, u64> {
    let noise =
        [noise(rows.iter().map(|row| row.strain)), noise(rows.iter().map(|row| row.stress))];
    let mut dropped = Vec::new();
    let mut drop = |row: &RecordRow, cause| {
        dropped.push(DroppedRow { line: row.line, strain: row.strain, stress: row.stress, cause });
    };
    let is_loading = loading(rows, LOOP * noise[0]);
    let unloading = is_loading.iter().filter(|loading| !**loading).count();
    if 2 * unloading > rows.len() {
        let first = is_loading.iter().position(|loading| !loading);
        return Err(first.map_or(0, |index| rows[index].line));
    }
    let mut kept = Vec::with_capacity(rows.len());
    for (row, loading) in rows.iter().zip(&is_loading) {
        if *loading { kept.push(*row) } else { drop(row, Cause::Unloading) }
    }
    let end = break_of(&kept);
    kept.drain(end..).for_each(|row| drop(&row, Cause::Broken));
    let pools = pools(kept.iter().map(|row| row.strain), true);
    let mean = |rows: &[RecordRow], value: fn(&RecordRow) -> f64| {
        rows.iter().map(value).sum::<f64>() / rows.len() as f64
    };
    let curve: Vec<[f64; 2]> = pools
        .into_iter()
        .map(|pool| {
            let rows = &kept[pool];
            [mean(rows, |row| row.strain), mean(rows, |row| row.stress)]
        })
        .collect();
    Ok(Cleaned { averaged: kept.len() - curve.len(), curve, dropped, noise })
}

/// Whether each row belongs to the loading. If the strain falls by more than `fall` below its
/// maximum, the rows after the maximum are unloading until the strain exceeds it again.
fn loading(rows: &[RecordRow], fall: f64) -> Vec<bool> {
    let mut loading = vec![true; rows.len()];
    let mut top = 0;
    for index in 1..rows.len() {
        if rows[index].strain > rows[top].strain {
            top = index;
        } else if rows[index].strain < rows[top].strain - fall {
            loading[top + 1..=index].fill(false);
        } else if !loading[index - 1] {
            loading[index] = false;
        }
    }
    loading
}

/// Number of rows up to the break: from there on the stress stays below a fraction of the stress
/// before.
fn break_of(rows: &[RecordRow]) -> usize {
    let stress = |index: usize| rows[index].stress;
    let median_before = |index: usize| {
        let mut before: Vec<f64> = (index.saturating_sub(BEFORE)..index).map(stress).collect();
        before.sort_by(f64::total_cmp);
        before.get(before.len() / 2).copied().unwrap_or(0.0)
    };
    let top = (0..rows.len()).max_by(|a, b| stress(*a).total_cmp(&stress(*b)));
    let mut later = 0.0;
    let mut end = rows.len();
    for index in (top.unwrap_or(0) + 1..rows.len()).rev() {
        later = stress(index).max(later);
        if later < BROKEN * median_before(index) {
            end = index;
        }
    }
    // The first rows of the fall are above the limit.
    while end < rows.len() && end > 1 && stress(end - 1) < 0.9 * median_before(end - 1) {
        end -= 1;
    }
    end
}

/// Standard deviation of the noise of a smooth sequence: the median absolute third difference over
/// its expectation for independent normal noise, 0.6745 sqrt(20).
fn noise(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    if values.len() < MIN_NOISE_ROWS {
        return 0.0;
    }
    let mut differences: Vec<f64> =
        (values.windows(4)).map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs()).collect();
    differences.sort_by(f64::total_cmp);
    let median = differences.get(differences.len() / 2).copied();
    median.unwrap_or(0.0) / (0.6745 * 20f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(values: &[[f64; 2]]) -> Vec<RecordRow> {
        let numbered = values.iter().enumerate();
        numbered
            .map(|(index, &[strain, stress])| RecordRow { line: index as u64 + 2, strain, stress })
            .collect()
    }

    #[test]
    fn shaking_strains_are_averaged() {
        // A deterministic noise of about the standard deviation 0.29.
        let shake = |i: i32| 1e-3 * ((f64::from(i) * 0.618_034).fract() - 0.5);
        let values: Vec<[f64; 2]> =
            (0..400).map(|i| [2e-4 * f64::from(i) + shake(i), f64::from(i)]).collect();
        let cleaned = cleaned(&rows(&values)).unwrap();
        assert!(cleaned.dropped.is_empty() && cleaned.averaged > 50);
        for [strain, stress] in &cleaned.curve[5..] {
            assert!((strain - 2e-4 * stress).abs() < 5e-4);
        }
        assert!((1e-4..1e-3).contains(&cleaned.noise[0]), "{:?}", cleaned.noise);
    }
}
