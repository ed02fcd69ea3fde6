//! Rows of a record that are not a monotone loading: unloading loops, rows after the break,
//! repeated and shaking strains.

use crate::record::{Exclusion, RecordRow};
use crate::regression::{mean, pools};
use support::statistics::median;
use support::{Extremes, Point};

/// The monotone part of a record.
#[derive(Debug)]
pub(super) struct Cleaned {
    /// [strain, stress (MPa)] with increasing strain.
    pub curve: Vec<Point>,
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

/// The monotone part of the rows, which marks the others; the error is the line from which the
/// strain falls for most of the file.
pub(super) fn cleaned(rows: &mut [RecordRow]) -> Result<Cleaned, u64> {
    let noise = [|row: &RecordRow| row.strain, |row: &RecordRow| row.stress]
        .map(|value| noise(&rows.iter().map(value).collect::<Vec<_>>()));
    mark_unloading(rows, LOOP * noise[0]);
    let mut unloading = rows.iter().filter(|row| row.cause.is_some());
    if let Some(first) = unloading.next().filter(|_| 2 * (unloading.count() + 1) > rows.len()) {
        return Err(first.line);
    }
    let mut kept: Vec<&mut RecordRow> = rows.iter_mut().filter(|row| row.cause.is_none()).collect();
    let end = break_of(&kept.iter().map(|row| row.stress).collect::<Vec<_>>());
    kept.drain(end..).for_each(|row| row.cause = Some(Exclusion::Broken));
    let kept: Vec<Point> = kept.iter().map(|row| [row.strain, row.stress]).collect();
    let pools = pools(kept.iter().map(|row| row[0]), true).into_iter();
    let curve: Vec<Point> = pools.map(|pool| mean(&kept[pool])).collect();
    Ok(Cleaned { averaged: kept.len() - curve.len(), curve, noise })
}

/// If the strain falls by more than `fall` below its maximum, the rows after the maximum are
/// unloading until the strain exceeds it again.
fn mark_unloading(rows: &mut [RecordRow], fall: f64) {
    let mut top = 0;
    for index in 1..rows.len() {
        if rows[index].strain > rows[top].strain {
            top = index;
        } else if rows[index].strain < rows[top].strain - fall {
            rows[top + 1..=index].iter_mut().for_each(|row| row.cause = Some(Exclusion::Unloading));
        } else {
            rows[index].cause = rows[index - 1].cause;
        }
    }
}

/// Number of rows up to the break: from there on the stress stays below a fraction of the stress
/// before.
fn break_of(stresses: &[f64]) -> usize {
    let before = |index: usize| median(stresses[index.saturating_sub(BEFORE)..index].to_vec());
    let top = (0..stresses.len()).largest_by(|row| stresses[*row]);
    let mut later = 0.0;
    let mut end = stresses.len();
    for index in (top.unwrap_or(0) + 1..stresses.len()).rev() {
        later = stresses[index].max(later);
        if later < BROKEN * before(index) {
            end = index;
        }
    }
    // The first rows of the fall are above the limit.
    while end < stresses.len() && end > 1 && stresses[end - 1] < 0.9 * before(end - 1) {
        end -= 1;
    }
    end
}

/// Standard deviation of the noise of a smooth sequence: the median absolute third difference over
/// its expectation for independent normal noise, 0.6745 sqrt(20).
fn noise(values: &[f64]) -> f64 {
    if values.len() < MIN_NOISE_ROWS {
        return 0.0;
    }
    let differences = values.windows(4).map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs());
    median(differences.collect()) / (0.6745 * 20f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shaking_strains_are_averaged() {
        // A deterministic noise of about the standard deviation 0.29.
        let shake = |i: i32| 1e-3 * ((f64::from(i) * 0.618_034).fract() - 0.5);
        let row = |i| {
            let (strain, stress) = (2e-4 * f64::from(i) + shake(i), f64::from(i));
            RecordRow { line: 1, strain, stress, cause: None }
        };
        let mut rows: Vec<RecordRow> = (0..400).map(row).collect();
        let cleaned = cleaned(&mut rows).unwrap();
        assert!(rows.iter().all(|row| row.cause.is_none()) && cleaned.averaged > 50);
        for [strain, stress] in &cleaned.curve[5..] {
            assert!((strain - 2e-4 * stress).abs() < 5e-4);
        }
        assert!((1e-4..1e-3).contains(&cleaned.noise[0]), "{:?}", cleaned.noise);
    }
}
