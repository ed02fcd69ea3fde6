//! The local curve [true stress, plastic strain] of rows at which the strain is uniform:
//! sigma = s (1 + e), eps_p = ln(1 + e) - sigma / E.

use crate::landmarks::{Draw, yield_stress};
use crate::regression::{mean, non_decreasing, pools};
use support::Point;

/// Plastic strain above which no yield can be read from a curve: its noise is too large.
const MAX_ONSET: f64 = 5e-3;

/// A row [nominal strain, nominal stress] as [logarithmic strain, true stress].
pub(super) fn true_row(&[strain, stress]: &Point) -> Point {
    [strain.ln_1p(), stress * (1.0 + strain)]
}

/// [true stress, plastic strain] of a nominal row.
fn local(row: &Point, young: f64) -> Point {
    let [strain, stress] = true_row(row);
    [stress, strain - stress / young]
}

/// The local curve from the end of the elastic part on: its stress at the plastic strain `onset`
/// becomes the stress at zero plastic strain. A film may reach its upper yield before: its curve is
/// then one row.
pub(super) fn first_part(
    curve: &[Point],
    young: f64,
    onset: f64,
    draws: bool,
) -> Option<Vec<Point>> {
    let rows: Vec<Point> = curve.iter().map(|row| local(row, young)).collect();
    let after = rows.iter().rposition(|row| row[1] <= onset)? + 1;
    let yields = if after < rows.len() {
        yield_stress(&rows, after, onset, Some(0.0))
    } else {
        draws.then(|| rows[after - 1][0])?
    };
    let mut part = vec![[yields, 0.0]];
    part.extend(&rows[after..]);
    (onset < MAX_ONSET && yields > 0.0).then(|| monotone(&part))
}

/// The local curve from the natural draw ratio on.
pub(super) fn second_part(curve: &[Point], draw: &Draw, young: f64) -> Vec<Point> {
    let drawn = curve.partition_point(|row| 1.0 + row[0] <= draw.draw_ratio);
    let mut part = vec![local(&[draw.draw_ratio - 1.0, draw.plateau], young)];
    part.extend(curve[drawn..].iter().map(|row| local(row, young)));
    monotone(&part)
}

/// The curve [stress, plastic strain] with increasing strain and non-decreasing stress. The first
/// row is unchanged.
fn monotone(curve: &[Point]) -> Vec<Point> {
    let [first, start] = curve[0];
    let pools = pools(curve[1..].iter().map(|row| row[1].max(start)), true).into_iter();
    let mut rows = vec![curve[0]];
    rows.extend(pools.map(|pool| mean(&curve[1..][pool])).filter(|row| row[1] > start));
    let stresses: Vec<f64> = rows.iter().map(|row| row[0].max(first)).collect();
    let stresses = non_decreasing(&stresses).into_iter();
    stresses.zip(rows).map(|(stress, row)| [stress, row[1]]).collect()
}

// The local hardening curve where the measured curve is not local.
//
// **Drawing.** Between the upper yield (stretch lambda_u) and the natural draw ratio lambda_n a
// neck runs along the specimen under the constant nominal stress s of the plateau. Each element
// passes from lambda_u to lambda_n, so the work per volume on the local curve equals the work of
// the machine,
//
//   int sigma d(eps) = s (lambda_n - lambda_u),
//
// which is Maxwell's rule of equal areas. The two ends are measured: the true stress sigma_u at
// the upper yield, and sigma_n = lambda_n s. Between them sigma = sigma_u + (sigma_n - sigma_u)
// x^m is assumed, where x is the fraction of the plastic strain; the work determines m. If the
// work is less than sigma_u would need even without hardening, the upper yield is cut to the mean
// stress of the draw: the Luders band of a mild steel.
//
// **Diffuse neck.** From the maximum force at (sigma_m, eps_m) on, the tangent of Considere's
// condition d(sigma)/d(eps) = sigma is continued: sigma = sigma_m (1 + eps - eps_m). It is an
// upper bound for a law that saturates.

/// The local curve of the material in the running neck.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColdDrawing {
    /// [true stress (MPa), plastic strain] at the upper yield.
    pub from: Point,
    /// The same at the natural draw ratio.
    pub to: Point,
    /// Mean true stress (MPa) over the plastic strain.
    pub mean: f64,
}

impl ColdDrawing {
    /// The curve between the end of the measured one and the natural draw ratio `ratio` under the
    /// nominal stress `plateau` (MPa). `None` if the ratio is not beyond the upper yield.
    pub(crate) fn new(from: Point, plateau: f64, ratio: f64, young: f64) -> Option<Self> {
        let [sigma, plastic] = from;
        let stress = ratio * plateau;
        let to = [stress, ratio.ln() - stress / young];
        let stretch = (plastic + sigma / young).exp();
        let elastic = (stress * stress - sigma * sigma) / (2.0 * young);
        let work = plateau * (ratio - stretch) - elastic;
        let mean = work / (to[1] - plastic);
        (to[1] > plastic && mean > 0.0).then_some(Self { from, to, mean })
    }

    /// The true stress (MPa) at the upper yield: that measured, or less if the plateau is too low
    /// for it.
    pub(crate) fn yields_at(&self) -> f64 {
        self.from[0].min(self.mean).min(self.to[0])
    }

    /// `count` points up to the natural draw ratio, at which the measured curve continues.
    pub(crate) fn points(&self, count: usize) -> Vec<Point> {
        let [sigma, plastic] = [self.yields_at(), self.from[1]];
        let rise = self.to[0] - sigma;
        // A cut yield stress is constant up to the natural draw ratio.
        let exponent =
            if self.mean > sigma { rise / (self.mean - sigma) - 1.0 } else { f64::INFINITY };
        let point = |index: usize| {
            let x = index as f64 / count as f64;
            [sigma + rise * x.powf(exponent), plastic + x * (self.to[1] - plastic)]
        };
        (1..=count).map(point).collect()
    }
}

/// The true stress (MPa) at the plastic strain `plastic` beyond the maximum force at `from`;
/// Considere.
pub(super) fn beyond_maximum_force(from: Point, plastic: f64, young: f64) -> f64 {
    // eps - eps_m contains the elastic part (sigma - sigma_m) / E.
    let [sigma, start] = from;
    sigma * (1.0 + (plastic - start) / (1.0 - sigma / young))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_work_of_the_draw_is_that_of_the_machine() {
        let young = 3000.0;
        let from = [45.0, 0.01];
        let drawing = ColdDrawing::new(from, 33.6, 3.28, young).unwrap();
        let points = drawing.points(20_000);
        let mut work = 0.0;
        let mut before = from;
        for point in points {
            assert!(point[0] >= before[0] && point[1] > before[1]);
            let strain = point[1] - before[1] + (point[0] - before[0]) / young;
            work += 0.5 * (point[0] + before[0]) * strain;
            before = point;
        }
        let machine = 33.6 * (3.28 - (0.01 + 45.0 / young).exp());
        assert!((work / machine - 1.0).abs() < 1e-6, "{work} {machine}");
        assert!((before[0] - 3.28 * 33.6).abs() < 1e-9);
    }

    #[test]
    fn a_low_plateau_cuts_the_upper_yield() {
        let drawing = ColdDrawing::new([252.5, 1e-5], 240.0, 1.02, 210e3).unwrap();
        let cut = drawing.yields_at();
        assert!((240.0..245.0).contains(&cut), "{cut}");
        let points = drawing.points(100);
        assert!(points[..99].iter().all(|[stress, _]| *stress == cut));
        assert!(ColdDrawing::new([252.5, 0.1], 240.0, 1.02, 210e3).is_none());
    }

    #[test]
    fn beyond_the_maximum_the_force_falls() {
        let (from, young) = ([400.0, 0.15], 70e3);
        let force = |plastic: f64| {
            let stress = beyond_maximum_force(from, plastic, young);
            stress * (-(plastic + stress / young)).exp()
        };
        let maximum = 400.0 * (-(0.15 + 400.0 / young)).exp();
        let step = 1e-4;
        assert!((force(0.15) - maximum).abs() < 1e-9);
        assert!(((force(0.15 + step) - maximum) / (step * maximum)).abs() < 1e-4);
        assert!(force(0.5) < maximum && force(1.0) < force(0.5));
    }
}
