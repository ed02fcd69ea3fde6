//! Mistakes of a measurement file: a mirrored sheet, another order of the corners, a wrong unit, panels that were
//! swapped or numbered wrongly.

use crate::analysis::marks::{FittedPoint, MeasuredPoint};
use crate::analysis::robust_pose::{Fit, Problem};
use crate::geometry::polygon;
use crate::geometry::similarity::Scale;
use crate::sheet::cut_sheet::Sheet;
use serde::Serialize;
use std::fmt;

/// A mistake is reported if its correction reduces the median residual to less than this fraction.
const BETTER: f64 = 0.5;

/// The orders in which the corners of a quadrilateral can be counted: entry c is the true corner of the corner that
/// was numbered c. Four counter-clockwise ones, then four clockwise ones.
const ORDERS: [[usize; 4]; 8] = [
    [0, 1, 2, 3],
    [1, 2, 3, 0],
    [2, 3, 0, 1],
    [3, 0, 1, 2],
    [0, 3, 2, 1],
    [1, 0, 3, 2],
    [2, 1, 0, 3],
    [3, 2, 1, 0],
];

/// A mistake that concerns all points.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum Misread {
    #[error(
        "the points are a mirror image of the sheet (median residual {mirrored:.3} mm if mirrored, {level:.3} mm if \
         not): y counts downwards in pictures (--y-down), and a sheet seen from below is mirrored too"
    )]
    Mirrored { level: f64, mirrored: f64 },
    #[error(
        "the corners are numbered in another order: what the file calls corners 0, 1, 2, 3 are the corners \
         {order:?} (median residual {ordered:.3} mm with this order, {level:.3} mm without); corner 0 is SW in the \
         flat sheet, and they count counter-clockwise"
    )]
    CornerOrder {
        order: [usize; 4],
        level: f64,
        ordered: f64,
    },
    #[error(
        "the points fit at the scale {factor:.4}, not at 1 (median residual {scaled:.3} mm, {level:.3} mm at 1): \
         name their unit (--unit), or fit the scale (--scale free)"
    )]
    Scale {
        factor: f64,
        level: f64,
        scaled: f64,
    },
}

/// A panel whose points fit other marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Renumbered {
    /// The panel by its number in the measurement.
    pub panel: usize,
    /// The panel where its points lie.
    pub lies_at: usize,
    /// The corners where its corners 0, 1, 2, 3 lie.
    pub corners: [usize; 4],
}

impl fmt::Display for Renumbered {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self {
            panel,
            lies_at,
            corners,
        } = self;
        write!(f, "the points of P{panel} lie ")?;
        if panel != lies_at {
            write!(f, "where P{lies_at} is")?;
        }
        if *corners != ORDERS[0] {
            let also = if panel == lies_at { "" } else { ", " };
            write!(f, "{also}at the corners {corners:?} instead of 0, 1, 2, 3")?;
        }
        Ok(())
    }
}

/// An error if another reading of the points reduces the median residual `level` (mm) by half.
pub(crate) fn misread(problem: &Problem, level: f64) -> Result<(), Misread> {
    let points = problem.points;
    let median = |points: &[MeasuredPoint]| {
        problem
            .start(points)
            .map_or(f64::INFINITY, |(_, _, median)| median)
    };
    let mirrored = median(&each(points, |point| point.position[1] *= -1.0));
    let orders = ORDERS[1..].iter().map(|&order| {
        let reordered = each(points, |point| {
            point.mark.corner = point.mark.corner.map(|corner| order[corner]);
        });
        (order, median(&reordered))
    });
    let ordered = orders.min_by(|a, b| a.1.total_cmp(&b.1));
    let (order, ordered) = ordered.expect("there are seven other orders");
    let free = Problem {
        scale: Scale::Free,
        ..*problem
    };
    let (factor, scaled) = free
        .start(points)
        .map_or((1.0, f64::INFINITY), |(_, motion, median)| {
            (motion.scale(), median)
        });
    let least = mirrored.min(ordered).min(scaled);
    if least > BETTER * level {
        Ok(())
    } else if least == mirrored {
        Err(Misread::Mirrored { level, mirrored })
    } else if least == ordered {
        Err(Misread::CornerOrder {
            order,
            level,
            ordered,
        })
    } else {
        Err(Misread::Scale {
            factor,
            level,
            scaled,
        })
    }
}

fn each(points: &[MeasuredPoint], change: impl Fn(&mut MeasuredPoint)) -> Vec<MeasuredPoint> {
    let mut changed = points.to_vec();
    changed.iter_mut().for_each(change);
    changed
}

/// The panels whose measured points are all outliers and all lie within `limit` (mm) of other marks: those of
/// another panel, or of the same panel in another order.
///
/// A single corner is no evidence; a single centre is.
pub(crate) fn renumbered(sheet: &Sheet, fit: &Fit, limit: f64) -> Vec<Renumbered> {
    let mut by_panel: Vec<Vec<&FittedPoint>> = vec![Vec::new(); sheet.panels.len()];
    for point in &fit.points {
        by_panel[point.mark.panel].push(point);
    }
    let wrong = |points: &[&FittedPoint]| {
        let corners = points.iter().filter(|point| point.mark.corner.is_some());
        points.iter().all(|point| point.outlier) && (corners.count() != 1 || points.len() > 1)
    };
    let found = by_panel.iter().enumerate().filter_map(|(panel, points)| {
        if points.is_empty() || !wrong(points) {
            return None;
        }
        let distance = |other: &Renumbered| -> f64 {
            let farthest = points.iter().map(|point| {
                let mut mark = point.mark;
                mark.panel = other.lies_at;
                mark.corner = mark.corner.map(|corner| other.corners[corner]);
                polygon::distance(
                    point.measured,
                    mark.deployed(sheet, &fit.shape.configuration),
                )
            });
            farthest.fold(0.0, f64::max)
        };
        let others = (0..sheet.panels.len()).flat_map(|lies_at| {
            ORDERS.map(|corners| Renumbered {
                panel,
                lies_at,
                corners,
            })
        });
        let nearest = others
            .map(|other| (other, distance(&other)))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        (nearest.1 <= limit).then_some(nearest.0)
    });
    found.collect()
}
