//! Landmarks of a nominal curve: 0.2 % offset yield, upper yield, draw plateau, natural draw ratio,
//! onset of necking.
//!
//! Between the upper yield and the natural draw ratio a neck runs along the specimen: its material
//! is at two stretches, and the nominal strain is their average. The curve is local again where the
//! neck has covered the specimen and the stress rises from the plateau.

use crate::regression::{interpolated, mean};
use serde::Serialize;
use support::vectors::{add, dot};
use support::{Extremes, Point};

/// Plastic strain at the yield stress Rp0.2 (ISO 6892-1).
const OFFSET: f64 = 0.002;
/// Fall or rise of the stress, over the stress before, that is a landmark.
const CHANGE: f64 = 0.02;
/// The same in standard deviations of the noise.
const NOISE: f64 = 6.0;
/// Number of points at which the end of a plateau is searched.
const POINTS: usize = 300;

/// The draw of a specimen that necks and draws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Draw {
    /// Nominal stress at the upper yield (MPa).
    pub upper_yield: f64,
    /// Nominal strain at the upper yield.
    pub upper_yield_strain: f64,
    /// Nominal stress of the draw plateau (MPa).
    pub plateau: f64,
    /// Stretch of the drawn material.
    pub draw_ratio: f64,
    /// Row of the upper yield.
    #[serde(skip)]
    pub(super) top: usize,
}

/// How a specimen ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpecimenEnd {
    /// It broke, or the record ends, while its deformation was uniform.
    Uniform,
    /// It necked at the maximum force.
    Neck,
    /// The record ends before the neck had covered the specimen.
    Drawing,
}

/// The nominal stress (MPa) at which the curve crosses the line of slope `young` through the strain
/// 0.2 %, after the row `from`; `None` if it does not.
pub(super) fn offset_yield(curve: &[Point], young: f64, from: usize) -> Option<f64> {
    let rows = curve.iter().skip(from).map(|row| [row[1], row[0] - row[1] / young]);
    let rows: Vec<Point> = rows.collect();
    let after = 1 + rows.iter().skip(1).position(|row| row[1] >= OFFSET)?;
    let sharp = (rows[after - 1][1] < 0.5 * OFFSET).then_some(OFFSET);
    Some(yield_stress(&rows, after, OFFSET, sharp))
}

/// The stress at the plastic strain `at` of a curve [stress, plastic strain] that exceeds it from
/// the row `after` on. Between the rows before and after a sharp yield it is where the curve after
/// it, continued to the plastic strain `back`, begins.
pub(super) fn yield_stress(curve: &[Point], after: usize, at: f64, back: Option<f64>) -> f64 {
    let on = |row: usize, strain: f64| {
        let [from, to] = [curve[row], curve[row + 1]];
        from[0] + (to[0] - from[0]) * (strain - from[1]) / (to[1] - from[1])
    };
    let between = on(after - 1, at.max(curve[after - 1][1]));
    let rises = curve.get(after + 1).is_some_and(|next| next[1] > curve[after][1]);
    let begins = back.filter(|_| rises).map_or(between, |back| on(after, back));
    begins.min(curve[after][0]).max(between)
}

/// The draw of a curve after the row `from`; `None` if it does not neck or breaks in the neck.
/// `given` is the natural draw ratio if it was measured.
pub(super) fn draw(
    curve: &[Point],
    from: usize,
    noise: f64,
    given: Option<f64>,
) -> Result<Option<Draw>, String> {
    let Some(top) = peak(curve, from, noise) else { return Ok(None) };
    let [upper_yield_strain, upper_yield] = curve[top];
    let change = change(upper_yield, noise);
    let higher = curve[top..].iter().position(|row| row[1] > upper_yield + change);
    let region = higher.map_or(curve.len(), |rows| top + rows);
    let low = (top..region).smallest_by(|row| curve[*row][1]).unwrap_or(top);
    let high = highest(curve, low, region);
    let lowest = curve[low][1];
    let fallen = lowest + 0.25 * (upper_yield - lowest);
    let start = (top..low).find(|&row| curve[row][1] <= fallen).unwrap_or(low);
    let found = |plateau, draw_ratio| {
        Ok(Some(Draw { upper_yield, upper_yield_strain, plateau, draw_ratio, top }))
    };
    let end = curve[curve.len() - 1][0];
    if curve[high][1] - lowest >= change {
        let [plateau, natural] = plateau_end(&curve[start..=high]);
        let stretch = 1.0 + end;
        return match given {
            // A short drop is a serration of the flow curve and no neck.
            _ if natural < 1.5 * upper_yield_strain => draw(curve, high, noise, given),
            Some(given) if given > stretch => Err(format!(
                "ends at a stretch of {stretch:.2}, after its stress has risen from the draw plateau: the draw ratio {given} is \
                 beyond it; give the initial section over the section of the drawn neck, or leave --draw-ratio out"
            )),
            given => found(plateau, given.unwrap_or(1.0 + natural)),
        };
    }
    // A diffuse neck falls faster and faster until the break; a plateau covers most of what follows
    // the peak.
    let after = end - upper_yield_strain;
    if end - curve[start][0] < 0.5 * after || after < 3.0 * upper_yield_strain {
        return Ok(None);
    }
    let plateau = mean(&curve[start..])[1];
    given.map_or_else(
        || {
            Err(format!(
                "draws at {plateau:.2} MPa and ends at a strain of {end:.2}, before its stress rises again: measure the section \
                 of the drawn neck and give --draw-ratio, the initial section over it"
            ))
        },
        |ratio| found(plateau, ratio),
    )
}

/// The last row after `from` at which the strain is uniform, and how the specimen ends.
pub(super) fn uniform_end(curve: &[Point], from: usize, noise: f64) -> (usize, SpecimenEnd) {
    let last = curve.len() - 1;
    let top = highest(curve, from, curve.len());
    if from > last {
        (last, SpecimenEnd::Drawing)
    } else if curve[last][1] < curve[top][1] - change(curve[top][1], noise) {
        (top, SpecimenEnd::Neck)
    } else {
        (last, SpecimenEnd::Uniform)
    }
}

/// The first maximum after `from` below which the stress falls.
fn peak(curve: &[Point], from: usize, noise: f64) -> Option<usize> {
    let mut top = from;
    for row in from..curve.len() {
        if curve[row][1] > curve[top][1] {
            top = row;
        } else if curve[row][1] < curve[top][1] - change(curve[top][1], noise) {
            return Some(top);
        }
    }
    None
}

fn change(stress: f64, noise: f64) -> f64 {
    (CHANGE * stress).max(NOISE * noise)
}

/// The last of the highest rows.
pub(super) fn highest(curve: &[Point], from: usize, to: usize) -> usize {
    let rows = from..to;
    rows.largest_by(|row| curve[*row][1]).unwrap_or(from)
}

/// Stress and strain at the end of a plateau: of all constants that continue as a parabola, the
/// closest to the curve in the sense of least squares.
fn plateau_end(curve: &[Point]) -> Point {
    let [from, to] = [curve[0][0], curve[curve.len() - 1][0]];
    let strain = |point: usize| from + (to - from) * point as f64 / POINTS as f64;
    let stresses: Vec<f64> =
        (0..=POINTS).map(|point| interpolated(curve, 1, strain(point))).collect();
    let mut best = [f64::INFINITY, stresses[0], from];
    for end in 0..POINTS {
        let level = stresses[..=end].iter().sum::<f64>() / (end + 1) as f64;
        let rising: Vec<f64> = (0..=POINTS).map(|point| point.saturating_sub(end) as f64).collect();
        let mut bend: Vec<f64> = rising.iter().map(|x| x * x).collect();
        let mut left: Vec<f64> = stresses.iter().map(|stress| stress - level).collect();
        without(&mut bend, &rising);
        without(&mut left, &rising);
        without(&mut left, &bend);
        let error = dot(&left, &left);
        if error < best[0] {
            best = [error, level, strain(end)];
        }
    }
    [best[1], best[2]]
}

/// Removes the part of `vector` along another.
fn without(vector: &mut [f64], other: &[f64]) {
    let along = dot(vector, other) / dot(other, other).max(f64::MIN_POSITIVE);
    add(vector, other, -along);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve of `count` rows up to the strain `end`.
    fn curve(end: f64, count: u32, stress: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
        let strains = (0..=count).map(|i| end * f64::from(i) / f64::from(count));
        strains.map(|strain| [strain, stress(strain)]).collect()
    }

    /// Upper yield of 44 MPa at 2 %, plateau of 34 MPa, rise from the strain 2.28.
    fn drawn(strain: f64) -> f64 {
        let rise = (strain - 2.28f64).max(0.0);
        match strain {
            x if x < 0.02 => 2200.0 * x,
            x if x < 0.1 => 44.0 - 10.0 * (x - 0.02) / 0.08,
            _ => 34.0 + 3.0 * rise + 2.0 * rise * rise,
        }
    }

    #[test]
    fn a_plateau_without_a_rise_needs_the_ratio() {
        let short = curve(1.5, 1500, drawn);
        let missing = draw(&short, 10, 0.0, None).unwrap_err();
        let (_, plateau) = missing.split_once("draws at ").unwrap();
        let plateau: f64 = plateau.split(' ').next().unwrap().parse().unwrap();
        assert!((plateau - 34.0).abs() < 0.2 && missing.contains("--draw-ratio"), "{missing}");
        let given = draw(&short, 10, 0.0, Some(3.28)).unwrap().unwrap();
        assert_eq!(given.draw_ratio, 3.28);
    }

    /// 33 for 3.3, on a strip that ends at a stretch of 4.5.
    #[test]
    fn a_ratio_beyond_the_end_of_a_drawn_specimen_is_refused() {
        let long = curve(3.5, 3500, drawn);
        let refused = draw(&long, 10, 0.0, Some(33.0)).unwrap_err();
        assert!(
            refused.contains("a stretch of 4.50") && refused.contains("ratio 33 "),
            "{refused}"
        );
        let given = draw(&long, 10, 0.0, Some(3.3)).unwrap().unwrap();
        assert_eq!(given.draw_ratio, 3.3);
    }

    #[test]
    fn a_lueders_band_is_a_draw_and_a_serration_is_none() {
        let steel = |x: f64| match x {
            x if x < 0.0012 => 210e3 * x,
            x if x < 0.0015 => 252.0 - 12.0 * (x - 0.0012) / 0.0003,
            x if x < 0.02 => 240.0,
            x => 240.0 + 1000.0 * (x - 0.02),
        };
        let found = draw(&curve(0.1, 10_000, steel), 100, 0.0, None).unwrap().unwrap();
        assert!((found.draw_ratio - 1.02).abs() < 5e-4, "{found:?}");
        let serrated =
            |x: f64| 100.0 + 500.0 * x - if (0.05..0.052).contains(&x) { 5.0 } else { 0.0 };
        assert_eq!(draw(&curve(0.1, 1000, serrated), 0, 0.0, None), Ok(None));
    }
}
