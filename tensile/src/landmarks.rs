//! Landmarks of a nominal curve: 0.2 % offset yield, upper yield, draw plateau, natural draw ratio,
//! onset of necking.
//!
//! Between the upper yield and the natural draw ratio a neck runs along the specimen: its material
//! is at two stretches, and the nominal strain is their average. The curve is local again where the
//! neck has covered the specimen and the stress rises from the plateau.

use crate::regression::interpolated;
use serde::Serialize;

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
    /// Whether the ratio was given, and not found on the curve.
    pub ratio_given: bool,
    /// Row of the upper yield.
    #[serde(skip)]
    pub(super) top: usize,
}

/// How a specimen ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// It broke, or the record ends, while its deformation was uniform.
    Uniform,
    /// It necked at the maximum force.
    Neck,
    /// The record ends before the neck had covered the specimen.
    Drawing,
}

/// The nominal stress (MPa) at which the curve crosses the line of slope `young` through the strain
/// 0.2 %, after the row `from`; `None` if it does not.
pub(super) fn offset_yield(curve: &[[f64; 2]], young: f64, from: usize) -> Option<f64> {
    let above = |row: &[f64; 2]| row[1] - young * (row[0] - OFFSET);
    let after = &curve[from.min(curve.len())..];
    let at = after.windows(2).position(|pair| above(&pair[1]) <= 0.0)?;
    let crossed = |[a, b]: [[f64; 2]; 2]| {
        let [before, after] = [above(&a), above(&b)];
        a[1] + before / (before - after) * (b[1] - a[1])
    };
    let [a, b] = [after[at], after[at + 1]];
    let between = if above(&a) > 0.0 { crossed([a, b]) } else { a[1] };
    // Rows before and after a sharp yield: it is where the curve after it begins.
    let sharp = above(&a) > 0.5 * young * OFFSET;
    let next = after.get(at + 2).filter(|next| sharp && above(next) < above(&b));
    let begins = next.map_or(between, |next| crossed([b, *next]));
    Some(begins.min(b[1]).max(between))
}

/// The draw of a curve after the row `from`; `None` if it does not neck or breaks in the neck.
/// `given` is the natural draw ratio if it was measured.
pub(super) fn draw(
    curve: &[[f64; 2]],
    mut from: usize,
    noise: f64,
    given: Option<f64>,
) -> Result<Option<Draw>, String> {
    let stress = |row: usize| curve[row][1];
    let end = curve.len();
    while let Some(top) = peak(curve, from, noise) {
        let change = change(stress(top), noise);
        let region = (top..end).find(|&row| stress(row) > stress(top) + change);
        let region = region.unwrap_or(end);
        let low = lowest(curve, top, region);
        let high = highest(curve, low, region);
        let fallen = stress(low) + 0.25 * (stress(top) - stress(low));
        let start = (top..region).find(|&row| stress(row) <= fallen).unwrap_or(low);
        let strain = |row: usize| curve[row][0];
        let found = |plateau, draw_ratio, ratio_given| Draw {
            upper_yield: stress(top),
            upper_yield_strain: strain(top),
            plateau,
            draw_ratio,
            ratio_given,
            top,
        };
        if stress(high) - stress(low) >= change {
            let [plateau, natural] = plateau_end(&curve[start..=high]);
            // A short drop is a serration of the flow curve and no neck.
            if natural - strain(top) >= 0.5 * strain(top) {
                let stretch = 1.0 + strain(end - 1);
                if let Some(given) = given.filter(|given| *given > stretch) {
                    return Err(format!(
                        "ends at a stretch of {stretch:.2}, after its stress has risen from the draw plateau: the draw ratio {given} is \
                         beyond it; give the initial section over the section of the drawn neck, or leave --draw-ratio out"
                    ));
                }
                let draw_ratio = given.unwrap_or(1.0 + natural);
                return Ok(Some(found(plateau, draw_ratio, given.is_some())));
            }
            from = high;
            continue;
        }
        // A diffuse neck falls faster and faster until the break; a plateau covers most of what
        // follows the peak.
        let [tail, after] = [start, top].map(|row| strain(end - 1) - strain(row));
        if tail < 0.5 * after || after < 3.0 * strain(top) {
            return Ok(None);
        }
        let plateau = curve[start..].iter().map(|row| row[1]).sum::<f64>() / (end - start) as f64;
        return match given {
            Some(ratio) => Ok(Some(found(plateau, ratio, true))),
            None => Err(format!(
                "draws at {plateau:.2} MPa and ends at a strain of {:.2}, before its stress rises again: measure the section \
                 of the drawn neck and give --draw-ratio, the initial section over it",
                strain(end - 1)
            )),
        };
    }
    Ok(None)
}

/// The last row after `from` at which the strain is uniform, and how the specimen ends.
pub(super) fn uniform_end(curve: &[[f64; 2]], from: usize, noise: f64) -> (usize, End) {
    let last = curve.len() - 1;
    let top = highest(curve, from, curve.len());
    if from > last {
        (last, End::Drawing)
    } else if curve[last][1] < curve[top][1] - change(curve[top][1], noise) {
        (top, End::Neck)
    } else {
        (last, End::Uniform)
    }
}

/// The first maximum after `from` below which the stress falls.
fn peak(curve: &[[f64; 2]], from: usize, noise: f64) -> Option<usize> {
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

fn lowest(curve: &[[f64; 2]], from: usize, to: usize) -> usize {
    let rows = from..to;
    rows.min_by(|a, b| curve[*a][1].total_cmp(&curve[*b][1])).unwrap_or(from)
}

pub(super) fn highest(curve: &[[f64; 2]], from: usize, to: usize) -> usize {
    let rows = from..to;
    rows.max_by(|a, b| curve[*a][1].total_cmp(&curve[*b][1])).unwrap_or(from)
}

/// Stress and strain at the end of a plateau: of all constants that continue as a parabola, the
/// closest to the curve in the sense of least squares.
fn plateau_end(curve: &[[f64; 2]]) -> [f64; 2] {
    let [from, to] = [curve[0][0], curve[curve.len() - 1][0]];
    let strain = |point: usize| from + (to - from) * point as f64 / POINTS as f64;
    let stresses: Vec<f64> =
        (0..=POINTS).map(|point| interpolated(curve, 1, strain(point))).collect();
    let mut best = [f64::INFINITY, stresses[0], from];
    let mut sum = 0.0;
    for end in 0..POINTS {
        sum += stresses[end];
        let level = sum / (end + 1) as f64;
        let rise = |point: usize| ((point - end) as f64, stresses[point] - level);
        // Normal equations of y = b x + c x^2.
        let [mut xx, mut xxx, mut xxxx, mut xy, mut xxy] = [0.0; 5];
        for (x, y) in (end + 1..=POINTS).map(rise) {
            xx += x * x;
            xxx += x * x * x;
            xxxx += x * x * x * x;
            xy += x * y;
            xxy += x * x * y;
        }
        let determinant = xx * xxxx - xxx * xxx;
        let (b, c) = if determinant > 1e-9 * xx * xxxx {
            ((xy * xxxx - xxy * xxx) / determinant, (xx * xxy - xxx * xy) / determinant)
        } else {
            (xy / xx, 0.0)
        };
        let flat: f64 = stresses[..=end].iter().map(|s| (s - level).powi(2)).sum();
        let rising = (end + 1..=POINTS).map(rise);
        let error = flat + rising.map(|(x, y)| (y - b * x - c * x * x).powi(2)).sum::<f64>();
        if error < best[0] {
            best = [error, level, strain(end)];
        }
    }
    [best[1], best[2]]
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
        assert_eq!((given.draw_ratio, given.ratio_given), (3.28, true));
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
