//! The state of a path and the rigid motion that fit measured points, some of which are wrong.
//!
//! A mark m of the sheet, a corner or the centre of a panel, lies at p_m(x) if the sheet is at the position x of its
//! path. Its measurement is
//!
//! ```text
//! z_m = turn p_m(x) + shift + error,
//! ```
//!
//! with one unknown rigid motion, and one unknown scale if requested. Three rules find x, the motion and the outliers:
//!
//! 1. Start: the two-point motion with the least median of the residuals over all load steps.
//! 2. Concentration: x and the motion by least squares over the half of the points with the smallest residuals, until
//!    this half is the same (least trimmed squares; Rousseeuw and Van Driessen, Data Min. Knowl. Discov. 12, 2006, 29).
//! 3. Outliers: residuals above c sigma are left out, and x and the motion are fitted again, until they are the same
//!    points. sigma is the standard deviation of one coordinate by the median absolute deviation: residual lengths
//!    with Gaussian errors have the Rayleigh distribution, whose median is sigma sqrt(2 ln 2). P(length > c sigma) =
//!    exp(-c^2 / 2), so that with c = sqrt(2 ln(20 n)) one of twenty measurements of n points loses a correct point. The fit
//!    to the nearest points makes the median of few residuals too small: sigma is multiplied by 1 + 5 / (n - u / 2) for u
//!    unknowns (Rousseeuw and Leroy, Robust Regression and Outlier Detection, 1987, section 5.1).
//!
//! Half of the points may be wrong by any amount. Residuals are in the frame of the design, in mm.

use crate::analysis::marks::{FittedPoint, MeasuredPoint};
use crate::analysis::shape_path::{Shape, ShapePath};
use crate::geometry::plane::{complex, point};
use crate::geometry::similarity::{Pair, Scale, Similarity, median};
use std::f64::consts::LN_2;

/// Minimum number of points: four points are eight numbers, for at most five unknowns.
pub const MIN_POINTS: usize = 4;
/// sigma is at least this fraction of the size of the sheet, so that rounding errors of an exact measurement are no
/// outliers.
const LEAST_SIGMA: f64 = 1e-6;
/// Maximum number of repetitions of rules 2 and 3. Both end earlier unless two sets of points alternate.
const MAX_REPETITIONS: usize = 50;

/// A state of the path with the motion that moves it onto the measured points.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Position on the path, in load steps from the flat sheet.
    pub position: f64,
    /// Load factor and panel motions at this position.
    pub shape: Shape,
    /// From the frame of the design (mm) into that of the measurement.
    pub motion: Similarity,
    /// One entry for each measured point, in the order of the measurement.
    pub points: Vec<FittedPoint>,
}

impl Fit {
    /// The points of the fit, without outliers.
    pub fn kept(&self) -> impl Iterator<Item = &FittedPoint> {
        self.points.iter().filter(|point| !point.outlier)
    }
}

/// A position on the path with its motion.
pub(crate) type Placed = (f64, Similarity);

/// The unknowns of a measurement, as functions of the points that are used.
pub(crate) struct Problem<'a> {
    pub path: &'a ShapePath<'a>,
    pub points: &'a [MeasuredPoint],
    pub scale: Scale,
}

impl Problem<'_> {
    /// Number of unknowns: the position on the path, the motion and, if requested, the scale.
    fn unknowns(&self) -> f64 {
        1.0 + self.scale.unknowns()
    }

    /// Predicted and measured positions of `points` at a position of the path.
    fn pairs<'p>(
        &self,
        position: f64,
        points: impl IntoIterator<Item = &'p MeasuredPoint>,
    ) -> Vec<Pair> {
        let configuration = self.path.at(position).configuration;
        let pair = |point: &MeasuredPoint| {
            let predicted = point.mark.deployed(self.path.sheet, &configuration);
            [complex(predicted), complex(point.position)]
        };
        points.into_iter().map(pair).collect()
    }

    fn pairs_of(&self, position: f64, kept: &[usize]) -> Vec<Pair> {
        self.pairs(position, kept.iter().map(|&index| &self.points[index]))
    }

    /// Rule 1: the load step and the motion with the least median residual (mm), and that median.
    pub(crate) fn start(&self, points: &[MeasuredPoint]) -> Option<(f64, Similarity, f64)> {
        let steps = (0..self.path.shapes.len()).filter_map(|step| {
            let pairs = self.pairs(step as f64, points);
            let (motion, median) = Similarity::least_median(&pairs, self.scale)?;
            Some((step as f64, motion, median))
        });
        steps.min_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// Rules 2 and 3: the fit, the points that it uses, and the residual above which a point is an outlier (mm).
    pub(crate) fn robust(&self, mut placed: Placed) -> Option<(Placed, Vec<usize>, f64)> {
        let count = self.points.len();
        let half = (count / 2 + 1).max(MIN_POINTS);
        let nearest = |residuals: &[f64]| {
            let mut order: Vec<usize> = (0..count).collect();
            order.sort_by(|&i, &j| residuals[i].total_cmp(&residuals[j]));
            order.truncate(half);
            order.sort_unstable();
            order
        };
        let mut kept = Vec::new();
        for _ in 0..MAX_REPETITIONS {
            let next = nearest(&self.residuals(placed));
            if next == kept {
                break;
            }
            placed = self.least_squares(&next)?;
            kept = next;
        }
        let few = 1.0 + 5.0 / (count as f64 - 0.5 * self.unknowns());
        let cutoff = few * (2.0 * (20.0 * count as f64).ln()).sqrt();
        let least = LEAST_SIGMA * self.path.sheet.outline.size();
        let mut limit = f64::INFINITY;
        for _ in 0..MAX_REPETITIONS {
            let residuals = self.residuals(placed);
            let sigma = median(&mut residuals.clone()) / (2.0 * LN_2).sqrt();
            limit = cutoff * sigma.max(least);
            let next: Vec<usize> = (0..count).filter(|&i| residuals[i] <= limit).collect();
            if next == kept {
                break;
            }
            placed = self.least_squares(&next)?;
            kept = next;
        }
        Some((placed, kept, limit))
    }

    /// The distances of all points from their predictions (mm).
    fn residuals(&self, (position, motion): Placed) -> Vec<f64> {
        let pairs = self.pairs(position, self.points);
        pairs.iter().map(|pair| motion.residual(pair)).collect()
    }

    /// The position on the path and the motion with the least sum of squares over the points `kept`: the best load
    /// step, then a golden-section search between its neighbours.
    fn least_squares(&self, kept: &[usize]) -> Option<Placed> {
        let misfit = |position: f64| -> f64 {
            let pairs = self.pairs_of(position, kept);
            let Some(motion) = Similarity::least_squares(&pairs, self.scale) else {
                return f64::INFINITY;
            };
            pairs.iter().map(|pair| motion.residual(pair).powi(2)).sum()
        };
        let end = self.path.end();
        let steps = (0..self.path.shapes.len()).map(|step| step as f64);
        let best = steps
            .map(|step| (step, misfit(step)))
            .min_by(|a, b| a.1.total_cmp(&b.1))?
            .0;
        let position = golden_minimum((best - 1.0).max(0.0), (best + 1.0).min(end), misfit);
        self.motion_at(position, kept)
    }

    pub(crate) fn motion_at(&self, position: f64, kept: &[usize]) -> Option<Placed> {
        let motion = Similarity::least_squares(&self.pairs_of(position, kept), self.scale)?;
        Some((position, motion))
    }

    /// Gauss-Newton: the variance of the position x is sigma^2 / |dp/dx|^2, with the part of dp/dx that is no rigid
    /// motion (and no change of scale) of the points. `None` if there is no such part, as for the corners of one panel, or
    /// if the standard error of x is that of the whole path.
    pub(crate) fn load_factor_error(
        &self,
        &(position, motion): &Placed,
        kept: &[usize],
    ) -> Option<f64> {
        /// Difference of two positions, in load steps.
        const STEP: f64 = 1e-3;
        let end = self.path.end();
        let free = 2.0 * kept.len() as f64 - self.unknowns();
        let pairs = self.pairs_of(position, kept);
        let squares = |pairs: &[Pair], motion: Similarity| -> f64 {
            pairs.iter().map(|pair| motion.residual(pair).powi(2)).sum()
        };
        let sigma = (squares(&pairs, motion) / free).sqrt();
        let step = if position + STEP <= end { STEP } else { -STEP };
        let ahead = self.pairs_of(position + step, kept);
        let change: Vec<Pair> = std::iter::zip(&pairs, &ahead)
            .map(|(here, there)| [here[0], there[0]])
            .collect();
        let rigid = Similarity::least_squares(&change, self.scale)?;
        let speed = squares(&change, rigid).sqrt() / STEP;
        if speed <= LEAST_SIGMA * self.path.sheet.outline.size() || sigma / speed > end {
            return None;
        }
        let factors = [position, position + step].map(|at| self.path.at(at).load_factor);
        let error = sigma / speed * ((factors[1] - factors[0]) / step).abs();
        (end > 0.0 && free > 0.0 && error.is_finite()).then_some(error)
    }

    pub(crate) fn fit(&self, (position, motion): Placed, kept: &[usize]) -> Fit {
        let pairs = self.pairs(position, self.points);
        let points = std::iter::zip(self.points, pairs).enumerate();
        Fit {
            position,
            shape: self.path.at(position),
            motion,
            points: points
                .map(|(index, (measured, [predicted, image]))| FittedPoint {
                    mark: measured.mark,
                    measured: point(motion.back(image)),
                    predicted: point(predicted),
                    outlier: !kept.contains(&index),
                })
                .collect(),
        }
    }
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
    let best = candidates.into_iter().min_by(|x, y| x.1.total_cmp(&y.1));
    best.map_or(low, |(x, _)| x)
}
