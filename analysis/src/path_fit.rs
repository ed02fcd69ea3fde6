//! The state of a path and the rigid motion that fit measured points.
//!
//! A mark m of the sheet, a corner or the centre of a panel, lies at p_m(x) if the sheet is at the
//! position x of its path. Its measurement is
//!
//! ```text
//! z_m = turn p_m(x) + shift + error,
//! ```
//!
//! with one unknown rigid motion, and one unknown scale if requested. x and the motion have the
//! least sum of squared errors over all points. Residuals are in the frame of the design, in mm.

use crate::measured_points::{FittedPoint, MeasuredPoint};
use crate::shape_path::{PathShape, ShapePath};
use design::geometry::plane::{complex, point};
use design::geometry::similarity::{Correspondence, Scale, Similarity};
use support::Extremes;

/// Minimum number of points: four points are eight numbers, for at most five unknowns.
pub const MIN_POINTS: usize = 4;
/// Movement of the points per load step below which they do not move, relative to the size of the
/// sheet.
const LEAST_SPEED: f64 = 1e-6;

/// A state of the path with the motion that moves it onto the measured points.
#[derive(Debug)]
pub struct Fit {
    /// Position on the path, in load steps from the flat sheet.
    pub position: f64,
    /// Load factor and panel motions at this position.
    pub shape: PathShape,
    /// Motion from the frame of the design (mm) into the frame of the measurement.
    pub motion: Similarity,
    /// One entry for each measured point, in the order of the measurement.
    pub points: Vec<FittedPoint>,
}

/// The unknowns of a measurement.
pub(crate) struct PathFit<'a> {
    pub path: &'a ShapePath<'a>,
    pub points: &'a [MeasuredPoint],
    pub scale: Scale,
}

impl PathFit<'_> {
    /// Number of unknowns: the position on the path, the motion and, if requested, the scale.
    fn unknowns(&self) -> f64 {
        1.0 + self.scale.unknowns()
    }

    /// Predicted and measured positions of the points at a position of the path.
    fn pairs(&self, position: f64) -> Vec<Correspondence> {
        let configuration = self.path.at(position).configuration;
        let pair = |point: &MeasuredPoint| {
            let predicted = point.mark.deployed(self.path.sheet, &configuration);
            [complex(predicted), complex(point.position)]
        };
        self.points.iter().map(pair).collect()
    }

    /// The position on the path with the least sum of squares: the best load step, then a
    /// golden-section search between its neighbours.
    pub(crate) fn best_position(&self) -> f64 {
        let misfit = |position: f64| {
            let pairs = self.pairs(position);
            let motion = Similarity::least_squares(&pairs, self.scale);
            motion.map_or(f64::INFINITY, |motion| squares(&pairs, motion))
        };
        let steps = (0..self.path.shapes.len()).map(|step| step as f64);
        let best = steps
            .map(|step| (step, misfit(step)))
            .smallest_by(|found| found.1)
            .map_or(0.0, |(step, _)| step);
        golden_minimum((best - 1.0).max(0.0), (best + 1.0).min(self.path.end()), misfit)
    }

    /// The points and their predictions at a position of the path; `None` if the points coincide.
    pub(crate) fn fit(&self, position: f64) -> Option<Fit> {
        let pairs = self.pairs(position);
        let motion = Similarity::least_squares(&pairs, self.scale)?;
        let points = std::iter::zip(self.points, pairs);
        Some(Fit {
            position,
            shape: self.path.at(position),
            motion,
            points: points
                .map(|(measured, [predicted, image])| FittedPoint {
                    mark: measured.mark,
                    measured: point(motion.back(image)),
                    predicted: point(predicted),
                })
                .collect(),
        })
    }

    /// Gauss-Newton: the variance of the position x is sigma^2 / |dp/dx|^2, with the part of dp/dx
    /// that is no rigid motion (and no change of scale) of the points. `None` if there is no such
    /// part, as for the corners of one panel, or if the standard error of x exceeds the length of
    /// the whole path.
    pub(crate) fn load_factor_error(&self, fit: &Fit) -> Option<f64> {
        /// Difference of two positions, in load steps.
        const STEP: f64 = 1e-3;
        let (position, end) = (fit.position, self.path.end());
        let free = 2.0 * self.points.len() as f64 - self.unknowns();
        let pairs = self.pairs(position);
        let sigma = (squares(&pairs, fit.motion) / free).sqrt();
        let step = if position + STEP <= end { STEP } else { -STEP };
        let ahead = self.pairs(position + step);
        let change: Vec<Correspondence> =
            std::iter::zip(&pairs, &ahead).map(|(here, there)| [here[0], there[0]]).collect();
        let rigid = Similarity::least_squares(&change, self.scale)?;
        let speed = squares(&change, rigid).sqrt() / STEP;
        if speed <= LEAST_SPEED * self.path.sheet.outline.size() || sigma / speed > end {
            return None;
        }
        let factors = [position, position + step].map(|at| self.path.at(at).load_factor);
        let error = sigma / speed * ((factors[1] - factors[0]) / step).abs();
        (end > 0.0 && free > 0.0 && error.is_finite()).then_some(error)
    }
}

/// Sum of the squared residuals of a motion (mm^2).
fn squares(pairs: &[Correspondence], motion: Similarity) -> f64 {
    pairs.iter().map(|pair| motion.residual(pair).powi(2)).sum()
}

/// The minimum of a function with one minimum between `low` and `high`, to 1e-9 of one load step.
fn golden_minimum(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_8;
    let inner = |low: f64, high: f64| [high - RATIO * (high - low), low + RATIO * (high - low)];
    let [mut a, mut b] = inner(low, high);
    let [mut f_a, mut f_b] = [a, b].map(&f);
    while high - low > 1e-9 {
        if f_a <= f_b {
            high = b;
            (b, f_b) = (a, f_a);
            a = inner(low, high)[0];
            f_a = f(a);
        } else {
            low = a;
            (a, f_a) = (b, f_b);
            b = inner(low, high)[1];
            f_b = f(b);
        }
    }
    // The ends of the path belong to it.
    let candidates = [low, 0.5 * (low + high), high].map(|x| (x, f(x)));
    let best = candidates.into_iter().smallest_by(|found| found.1);
    best.map_or(low, |(x, _)| x)
}
