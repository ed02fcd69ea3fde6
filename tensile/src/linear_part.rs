//! The linear part of a curve: Young's modulus, and the strain at which its line reaches zero
//! stress.
//!
//! The seed is the steepest window over a tenth of the maximum stress. It is extended in both
//! directions while the rows stay on its line, and the line is fitted again. Of a metal the line is
//! then fitted to the rows between a tenth and half of the yield stress: its first rows may be
//! steeper, because the specimen straightens. ISO 527-1 and ASTM D638 extend the line to zero
//! stress: the strain there is the slack and toe of the curve, and is subtracted from all strains.

use crate::landmarks::highest;
use crate::regression::Regression;
use serde::Serialize;
use std::ops::Range;
use support::{Extremes, Point};

/// The linear part of a curve.
#[derive(Debug, Serialize)]
pub struct LinearPart {
    /// Slope (MPa).
    pub young: f64,
    /// Standard error of the slope (MPa), from the distances of the rows to the line.
    pub error: f64,
    /// Strain at which the line has zero stress.
    pub toe: f64,
    /// Strains of the first and the last row, from the toe.
    pub strain: [f64; 2],
    /// Number of rows.
    pub rows: usize,
    /// Index of the first row.
    #[serde(skip)]
    pub(super) first: usize,
}

/// Fraction of the maximum stress that the seed covers.
const SEED: f64 = 0.1;
/// Distance of a row from the line, over the elastic strain at the maximum stress, at which the
/// linear part ends.
const STRAIGHT: f64 = 0.005;
/// Minimum number of rows of the seed.
const MIN_SEED: usize = 3;
/// Half the 95 % interval of a slope from 3, 4, ... rows, over its standard error.
const STUDENT: [f64; 5] = [12.7, 4.3, 3.2, 2.8, 2.6];
/// Largest yield stress over modulus of a metal, and the stresses, over the yield stress, between
/// which its line is fitted.
const METAL: f64 = 0.008;
const BETWEEN: [f64; 2] = [0.1, 0.5];
/// Number of extensions. More of them would follow the bend of a law without a linear part, such as
/// Ramberg and Osgood's.
const EXTENSIONS: usize = 3;

impl LinearPart {
    /// The linear part of a curve [strain, stress (MPa)] with increasing strain and the given
    /// `noise` of strain and stress; `None` for a curve without a rising part.
    pub(super) fn find(curve: &[Point], noise: [f64; 2]) -> Option<Self> {
        let end = highest(curve, 0, curve.len()) + 1;
        let maximum = curve.get(end - 1)?[1];
        let mut part = seed(&curve[..end], (SEED * maximum).max(12.0 * noise[1]), noise)?;
        for _ in 0..EXTENSIONS {
            let straight = STRAIGHT * maximum / part.young;
            let tolerance = straight + 3.0 * f64::hypot(noise[0], noise[1] / part.young);
            let off_line =
                |row: &Point| (row[0] - part.toe - row[1] / part.young).abs() > tolerance;
            let last = part.first + part.rows;
            let first = curve[..part.first].iter().rposition(off_line).map_or(0, |row| row + 1);
            let last = curve[last..end].iter().position(off_line).map_or(end, |row| last + row);
            part = Self::through(curve, first..last)?;
        }
        Some(part)
    }

    /// Whether the 95 % interval of the slope is above zero.
    pub(super) fn is_known(&self) -> bool {
        STUDENT[self.rows.saturating_sub(MIN_SEED).min(STUDENT.len() - 1)] * self.error < self.young
    }

    /// The line of a metal with the yield stress `yields` (MPa) through its `rows` [strain, stress
    /// (MPa)] as measured, in their order, in place of this one; `None` for another material, or
    /// for fewer than three rows. The line does not begin before the record.
    pub(super) fn of_metal(&self, rows: &[Point], yields: f64) -> Option<Self> {
        let [low, high] = BETWEEN.map(|part| part * yields);
        let low = low.max((self.strain[0] * self.young).min(0.5 * high));
        let loading = rows.iter().take_while(|row| row[1] <= high);
        let used: Vec<Point> = loading.filter(|row| row[1] >= low).copied().collect();
        let line = Self::through(&used, 0..used.len())?;
        let toe = line.toe.max(rows[0][0] - rows[0][1] / line.young);
        let strains = || used.iter().map(|row| row[0] - toe);
        (yields <= METAL * self.young && used.len() >= MIN_SEED).then(|| Self {
            toe,
            strain: [strains().fold(self.strain[0] - toe, f64::min), strains().largest()],
            ..line
        })
    }

    /// The line through rows, if it rises.
    pub(super) fn through(curve: &[Point], rows: Range<usize>) -> Option<Self> {
        let first = rows.start;
        let rows = &curve[rows];
        let Regression { mean: [strain, stress], slope, error, .. } = Regression::new(rows);
        let toe = strain - stress / slope;
        (slope > 0.0 && slope.is_finite()).then(|| Self {
            young: slope,
            error,
            toe,
            strain: [rows[0], rows[rows.len() - 1]].map(|row| row[0] - toe),
            rows: rows.len(),
            first,
        })
    }
}

/// The window over the stress `span` whose slope, less twice its standard error from the noise, is
/// largest.
fn seed(curve: &[Point], span: f64, noise: [f64; 2]) -> Option<LinearPart> {
    let mut last = 0;
    let windows = (0..curve.len()).map_while(|first| {
        last = last.max(first + MIN_SEED - 1);
        last += curve.get(last..)?.iter().position(|row| row[1] - curve[first][1] >= span)?;
        let Regression { squares, slope, .. } = Regression::new(&curve[first..=last]);
        let error = f64::hypot(noise[1], slope * noise[0]) / squares.sqrt();
        Some((slope - 2.0 * error, first..last + 1))
    });
    let finite = windows.filter(|(score, _)| score.is_finite());
    let (_, rows) = finite.largest_by(|(score, _)| *score)?;
    LinearPart::through(curve, rows)
}
