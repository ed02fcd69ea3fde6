//! What moves a sheet along its path, how far, and against which load.
//!
//! ```text
//! displacement  c . q,    c = f / F      load  zeta F                 moved by loads f of total magnitude F
//! displacement  zeta D                   load  R . U / D              moved by supports, by U of total magnitude D
//! ```
//!
//! The area below the curve is in both cases the work done on the sheet; for one force it is the
//! displacement of its panel along the force. F and D are sums of the magnitudes of forces or
//! translations, or, if there are none, of couples or rotations.
//!
//! The load may have a maximum on the path if a stroke or a motion is prescribed. A dead load,
//! such as a hung weight, opens the sheet only as far as the first state that carries it.

use crate::unit::Unit;
use design::equilibrium::displacement_control::{magnitude, work};
use design::equilibrium::load_step::LoadStep;
use design::objective::design_problem::{Deployment, Mechanics};
use serde::Serialize;
use std::iter::{once, zip};

/// What moves the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mover {
    /// Dead loads, or their prescribed stroke.
    Loads,
    /// Supports with a prescribed motion.
    Supports,
}

/// Load against displacement along a path.
#[derive(Debug, PartialEq)]
pub struct ActuationCurve {
    /// What moves the sheet.
    pub mover: Mover,
    /// Whether forces or translations move it; otherwise displacements are angles and loads are
    /// couples.
    pub translational: bool,
    /// (displacement from the flat sheet, load) of the flat sheet, or of the sheet under its
    /// weight, and of every load step: mm and N, or rad and N mm.
    pub points: Vec<[f64; 2]>,
}

impl ActuationCurve {
    /// Whether a motion is prescribed, and the load is a result.
    pub fn is_prescribed(&self, mechanics: &Mechanics) -> bool {
        mechanics.solver.is_driven() || self.mover == Mover::Supports
    }

    /// The curve through the load steps of a deployment by `mechanics`; `None` if nothing moves the
    /// sheet.
    pub fn new(mechanics: &Mechanics, deployment: &Deployment) -> Option<Self> {
        Self::through(mechanics, deployment, loaded(deployment))
    }

    /// The curve through the load steps and states between them, for which the path is followed once
    /// more.
    pub fn resolved(mechanics: &Mechanics, deployment: &Deployment) -> Option<Self> {
        let law = mechanics.law.prepare(&deployment.sheet.designs());
        let hinged = mechanics.hinged(&deployment.sheet, &*law, false);
        let solver = &mechanics.solver;
        let parts = (1..PARTS).map(|part| f64::from(part) / f64::from(PARTS));
        let is_new = |part: &f64| solver.load_parameters().all(|known| known != *part);
        let between: Vec<f64> = parts.filter(is_new).collect();
        let steps = solver.load_steps_at(hinged, &between);
        let known = zip(solver.load_parameters(), loaded(deployment));
        let mut states: Vec<_> = zip(between, &steps).chain(known).collect();
        states.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        Self::through(mechanics, deployment, states.into_iter().map(|(_, step)| step))
    }

    /// The curve through load steps, beginning before the loads; `None` if nothing moves the sheet.
    fn through<'a>(
        mechanics: &Mechanics,
        deployment: &Deployment,
        steps: impl IntoIterator<Item = &'a LoadStep>,
    ) -> Option<Self> {
        let (solver, sheet) = (&mechanics.solver, &deployment.sheet);
        let (mover, direction) = match magnitude(solver.loads()) {
            Some(_) => (Mover::Loads, solver.loads().to_vec()),
            None => (Mover::Supports, solver.support_motions()),
        };
        let (size, translational) = magnitude(&direction)?;
        let law = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(sheet, &*law, false);
        let point = |zeta: f64, configuration: &[[f64; 3]]| match mover {
            Mover::Loads => [work(&direction, configuration) / size, zeta * size],
            Mover::Supports => {
                let forces = solver.holding_forces(hinged, 1.0, configuration);
                [zeta * size, work(&direction, &forces) / size]
            }
        };
        let of_step = |step: &LoadStep| point(step.load_factor, &step.configuration);
        let start = deployment.weight_steps().last();
        let start = start.map_or_else(|| point(0.0, &solver.flat()), of_step);
        let points = once(start).chain(steps.into_iter().map(of_step)).collect();
        Some(Self { mover, translational, points })
    }

    /// The maximum of the load, in the direction of the displacement.
    pub fn peak(&self) -> LoadPeak {
        let (points, sense) = (self.forwards(), self.sense());
        let top = highest(&points);
        let [displacement, load] = self.vertex_at(&points, top);
        let [_, last] = points[points.len() - 1];
        let reached = first_reached(&points).map_or(0.0, |i| {
            let [[x, f], [next, higher]] = [points[i], points[i + 1]];
            x + (next - x) * (last - f) / (higher - f)
        });
        LoadPeak {
            displacement: sense * displacement,
            load: sense * load,
            dead_load_reaches: (load - last > self.least()).then_some(sense * reached),
        }
    }

    /// The maxima and minima of the load on the way, in turn: there a dead load would make the
    /// sheet jump. Changes of the load below a thousandth of its maximum do not count.
    pub fn limit_points(&self) -> Vec<LimitPoint> {
        let (points, sense) = (self.forwards(), self.sense());
        let least = self.least();
        let mut found = Vec::new();
        let (mut rises, mut extreme) = (true, 0);
        for (i, [_, load]) in points.iter().enumerate() {
            let beyond = load - points[extreme][1];
            if (beyond >= 0.0) == rises {
                extreme = i;
            } else if beyond.abs() > least {
                if extreme > 0 {
                    let [displacement, load] = self.vertex_at(&points, extreme);
                    found.push(LimitPoint {
                        is_maximum: rises,
                        displacement: sense * displacement,
                        load: sense * load,
                    });
                }
                (rises, extreme) = (!rises, i);
            }
        }
        found
    }

    /// The least difference of two loads that counts.
    fn least(&self) -> f64 {
        let sizes = self.points.iter().map(|point| point[1].abs());
        SAME_LOAD * sizes.fold(0.0, f64::max)
    }

    /// An extreme of the load near a point, between its neighbours.
    fn vertex_at(&self, points: &[[f64; 2]], i: usize) -> [f64; 2] {
        match points.get(i.wrapping_sub(1)..i + 2) {
            Some(&[before, top, after]) => vertex(before, top, after),
            _ => points[i],
        }
    }

    /// The points with their signs changed if the displacement is negative at the end.
    fn forwards(&self) -> Vec<[f64; 2]> {
        let sense = self.sense();
        let points = self.points.iter();
        points.map(|point| point.map(|value| sense * value)).collect()
    }

    fn sense(&self) -> f64 {
        let [end, _] = self.points[self.points.len() - 1];
        if end < 0.0 { -1.0 } else { 1.0 }
    }

    /// Units of displacement and load.
    pub fn units(&self) -> [Unit; 2] {
        if self.translational {
            [Unit::Millimetre, Unit::Newton]
        } else {
            [Unit::Radian, Unit::NewtonMillimetre]
        }
    }
}

/// The maximum load of a path on which a displacement is prescribed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadPeak {
    /// Displacement at the maximum: mm or rad.
    pub displacement: f64,
    /// Maximum load: N or N mm.
    pub load: f64,
    /// The displacement at which the path first carries the load of its end, if it exceeds that
    /// load before its end: a dead load of that size moves the sheet no further. 0 if the sheet
    /// must be held back at the end.
    pub dead_load_reaches: Option<f64>,
}

/// A maximum or minimum of the load along a path on which a displacement is prescribed.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LimitPoint {
    /// Whether the load is larger there than on both sides.
    pub is_maximum: bool,
    /// Displacement: mm or rad.
    pub displacement: f64,
    /// Load: N or N mm.
    pub load: f64,
}

/// Difference, over the largest load, below which two loads count as equal.
const SAME_LOAD: f64 = 1e-3;

/// Number of parts of a resolved path.
const PARTS: u32 = 200;

/// The index of the point of maximum load.
fn highest(points: &[[f64; 2]]) -> usize {
    let by_load = |&i: &usize, &j: &usize| points[i][1].total_cmp(&points[j][1]);
    (0..points.len()).max_by(by_load).unwrap_or(0)
}

/// The index of the first interval in which the load of the end is reached; `None` if that is not
/// positive.
fn first_reached(points: &[[f64; 2]]) -> Option<usize> {
    let [_, last] = *points.last()?;
    let reaches = |pair: &[[f64; 2]]| pair[1][1] >= last;
    points.windows(2).position(reaches).filter(|_| last > 0.0)
}

/// The vertex of the parabola through three points, the second of which is the highest.
fn vertex([x0, f0]: [f64; 2], [x1, f1]: [f64; 2], [x2, f2]: [f64; 2]) -> [f64; 2] {
    let [left, right] = [(f1 - f0) / (x1 - x0), (f2 - f1) / (x2 - x1)];
    let curvature = (right - left) / (x2 - x0);
    let slope = left + curvature * (x1 - x0);
    let ahead = -0.5 * slope / curvature;
    if ahead.is_finite() && (x0 - x1..=x2 - x1).contains(&ahead) {
        [x1 + ahead, f1 + 0.5 * slope * ahead]
    } else {
        [x1, f1]
    }
}

/// The load steps of a deployment under loads.
fn loaded(deployment: &Deployment) -> &[LoadStep] {
    &deployment.path[deployment.weight_steps().len()..]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use testkit::derivatives::assert_close;

    fn curve(load: impl Fn(f64) -> f64, end: f64) -> ActuationCurve {
        let points = (0..=40).map(|i| end * f64::from(i) / 40.0);
        ActuationCurve {
            mover: Mover::Loads,
            translational: true,
            points: points.map(|x| [x, load(x)]).collect(),
        }
    }

    #[test]
    fn the_maximum_lies_between_the_points() {
        for sense in [1.0, -1.0] {
            let peak = curve(|x| 10.0 * x.sin(), sense * 0.8 * PI).peak();
            assert_close(peak.load, sense * 10.0, 1e-4);
            assert_close(peak.displacement, sense * 0.5 * PI, 1e-3);
            // sin 0.8 pi = sin 0.2 pi
            assert_close(peak.dead_load_reaches.unwrap(), sense * 0.2 * PI, 1e-3);
        }
    }

    #[test]
    fn a_load_that_increases_has_its_maximum_at_the_end() {
        let peak = curve(|x| x * x, 2.0).peak();
        let expected = LoadPeak { displacement: 2.0, load: 4.0, dead_load_reaches: None };
        assert_eq!(peak, expected);
        // Nor does a dead load stop at a maximum below the load at the end.
        let rises = curve(|x| x + 0.9 * (3.0 * x).sin(), 6.9).peak();
        assert_eq!(rises.dead_load_reaches, None);
        // The weight of a hanging sheet may hold its hook down all the way.
        let peak = curve(|x| x - 3.0, 2.0).peak();
        assert_eq!((peak.load, peak.dead_load_reaches), (-1.0, None));
        // A sheet that does not move has no load.
        let peak = curve(|_| 0.0, 0.0).peak();
        assert_eq!((peak.load, peak.dead_load_reaches), (0.0, None));
    }

    #[test]
    fn a_sheet_that_is_held_back_at_its_end_is_opened_by_no_dead_load() {
        let peak = curve(f64::sin, 1.5 * PI).peak();
        assert_close(peak.load, 1.0, 1e-4);
        assert_eq!(peak.dead_load_reaches, Some(0.0));
    }

    #[test]
    fn limit_points_separate_the_stable_parts() {
        // x + 1.5 sin 2x rises to x = 0.955, falls to 2.186, and rises again.
        for sense in [1.0, -1.0] {
            let found = curve(|x| x + 1.5 * (2.0 * x).sin(), sense * 3.0).limit_points();
            let [maximum, minimum] = found[..] else {
                panic!("{found:?}");
            };
            assert!(maximum.is_maximum && !minimum.is_maximum);
            let at = 0.5 * (-1.0_f64 / 3.0).acos();
            assert_close(maximum.displacement, sense * at, 2e-3);
            assert_close(minimum.displacement, sense * (PI - at), 2e-3);
        }
        assert!(curve(|x| x * x, 2.0).limit_points().is_empty());
        assert!(curve(|_| 0.0, 1.0).limit_points().is_empty());
    }
}
