//! The linear part of a curve: Young's modulus, and the strain at which its line reaches zero
//! stress.
//!
//! The seed is the steepest window over a tenth of the maximum stress. It is extended in both
//! directions while the rows stay on its line, and the line is fitted again. Of a metal the line is
//! then fitted to the rows between a tenth and half of the yield stress: its first rows may be
//! steeper, because the specimen straightens. ISO 527-1 and ASTM D638 extend the line to zero
//! stress: the strain there is the slack and toe of the curve, and is subtracted from all strains.

use crate::regression::Regression;
use serde::Serialize;

/// The linear part of a curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
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

/// The rows of a linear part with their regression line.
struct Line {
    first: usize,
    last: usize,
    slope: f64,
    error: f64,
    /// Strain at zero stress.
    zero: f64,
    /// Sum of the squared deviations of the strain from its mean.
    squares: f64,
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
    pub(super) fn find(curve: &[[f64; 2]], noise: [f64; 2]) -> Option<Self> {
        let top = (0..curve.len()).max_by(|a, b| curve[*a][1].total_cmp(&curve[*b][1]))?;
        let maximum = curve[top][1];
        let mut line = seed(&curve[..=top], (SEED * maximum).max(12.0 * noise[1]), noise)?;
        for _ in 0..EXTENSIONS {
            let straight = STRAIGHT * maximum / line.slope;
            let tolerance = straight + 3.0 * f64::hypot(noise[0], noise[1] / line.slope);
            let on_line =
                |row: &[f64; 2]| (row[0] - line.zero - row[1] / line.slope).abs() <= tolerance;
            let (mut first, mut last) = (line.first, line.last);
            while first > 0 && on_line(&curve[first - 1]) {
                first -= 1;
            }
            while last < top && on_line(&curve[last + 1]) {
                last += 1;
            }
            if (first, last) == (line.first, line.last) {
                break;
            }
            line = Line::fitted(curve, first, last).filter(|line| line.slope > 0.0)?;
        }
        Some(line.part(curve))
    }

    /// Whether the 95 % interval of the slope is above zero.
    pub(super) fn is_known(&self) -> bool {
        STUDENT[self.rows.saturating_sub(MIN_SEED).min(STUDENT.len() - 1)] * self.error < self.young
    }

    /// The line of a metal with the yield stress `yields` (MPa) through its `rows` [strain, stress
    /// (MPa)] as measured, in their order, in place of this one; `None` for another material, or
    /// for fewer than three rows. The line does not begin before the record.
    pub(super) fn of_metal(&self, rows: &[[f64; 2]], yields: f64) -> Option<Self> {
        if yields > METAL * self.young {
            return None;
        }
        let [low, high] = BETWEEN.map(|part| part * yields);
        let low = low.max((self.strain[0] * self.young).min(0.5 * high));
        let loading = rows.iter().take_while(|row| row[1] <= high);
        let used: Vec<[f64; 2]> = loading.filter(|row| row[1] >= low).copied().collect();
        let line = Self::through(&used, 0, used.len().checked_sub(1)?)?;
        let toe = line.toe.max(rows[0][0] - rows[0][1] / line.young);
        let strains = || used.iter().map(|row| row[0] - toe);
        (used.len() >= MIN_SEED).then(|| Self {
            toe,
            strain: [strains().fold(self.strain[0] - toe, f64::min), strains().fold(0.0, f64::max)],
            ..line
        })
    }

    /// The line through the rows `first` to `last`, if it rises.
    pub(super) fn through(curve: &[[f64; 2]], first: usize, last: usize) -> Option<Self> {
        let line = (last > first).then(|| Line::fitted(curve, first, last))??;
        (line.slope > 0.0).then(|| line.part(curve))
    }
}

impl Line {
    /// The regression of the stress on the strain.
    fn fitted(curve: &[[f64; 2]], first: usize, last: usize) -> Option<Self> {
        let Regression { mean: [strain, stress], squares, slope, error } =
            Regression::new(&curve[first..=last]);
        slope.is_finite().then(|| Self {
            first,
            last,
            slope,
            error,
            zero: strain - stress / slope,
            squares,
        })
    }

    /// Standard error of the slope for the noise of strain and stress.
    fn error_of(&self, noise: [f64; 2]) -> f64 {
        f64::hypot(noise[1], self.slope * noise[0]) / self.squares.sqrt()
    }

    fn part(&self, curve: &[[f64; 2]]) -> LinearPart {
        LinearPart {
            young: self.slope,
            error: self.error,
            toe: self.zero,
            strain: [self.first, self.last].map(|row| curve[row][0] - self.zero),
            rows: self.last - self.first + 1,
            first: self.first,
        }
    }
}

/// The window over the stress `span` whose slope, less twice its standard error, is largest.
fn seed(curve: &[[f64; 2]], span: f64, noise: [f64; 2]) -> Option<Line> {
    let mut last = 0;
    let mut best: Option<(f64, Line)> = None;
    for first in 0..curve.len() {
        let from = curve[first][1];
        last = last.max(first + MIN_SEED - 1);
        while last < curve.len() && curve[last][1] - from < span {
            last += 1;
        }
        if last >= curve.len() {
            break;
        }
        if let Some(line) = Line::fitted(curve, first, last) {
            let score = line.slope - 2.0 * line.error_of(noise);
            if line.slope > 0.0 && best.as_ref().is_none_or(|(other, _)| score > *other) {
                best = Some((score, line));
            }
        }
    }
    best.map(|(_, line)| line)
}
