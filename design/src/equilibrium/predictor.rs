//! Positions on an equilibrium path and the cubic between two of them.
//!
//! A path is a curve in (load parameter, configuration, hinge forces). Between two of its points
//! with known rates it is interpolated by the cubic of Hermite, whose error is of fourth order in
//! the length; the same cubic extrapolates it.

use crate::sheet::kinematics::Configuration;
use support::vectors;

/// A position on the path, or a rate along it.
#[derive(Clone, Debug)]
pub(crate) struct PathPoint {
    /// Fraction of the loads, the stroke and the support motions.
    pub at: f64,
    pub configuration: Configuration,
    /// Forces of the hinges.
    pub forces: Vec<[f64; 3]>,
}

impl PathPoint {
    /// A linear combination of positions.
    pub(crate) fn sum<const N: usize>(terms: [(f64, &Self); N]) -> Self {
        let combined = |part: fn(&Self) -> &[[f64; 3]]| {
            let mut sum = vec![[0.0; 3]; part(terms[0].1).len()];
            for (weight, position) in terms {
                vectors::add(sum.as_flattened_mut(), part(position).as_flattened(), weight);
            }
            sum
        };
        Self {
            at: terms.iter().map(|(weight, position)| weight * position.at).sum(),
            configuration: combined(|position| &position.configuration),
            forces: combined(|position| &position.forces),
        }
    }
}

/// The path between two points, by its length from the first.
pub(crate) struct PathArc {
    pub from: PathPoint,
    pub from_rate: PathPoint,
    pub to: PathPoint,
    pub to_rate: PathPoint,
    pub length: f64,
}

impl PathArc {
    /// The weights of `from`, `from_rate`, `to` and `to_rate` at a length.
    fn weights(&self, length: f64) -> [f64; 4] {
        let u = length / self.length;
        let (square, rest) = (u * u, u - 1.0);
        [
            (1.0 + 2.0 * u) * rest * rest,
            self.length * u * rest * rest,
            square * (3.0 - 2.0 * u),
            self.length * square * rest,
        ]
    }

    pub(crate) fn position(&self, length: f64) -> PathPoint {
        let [a, b, c, d] = self.weights(length);
        PathPoint::sum([(a, &self.from), (b, &self.from_rate), (c, &self.to), (d, &self.to_rate)])
    }

    /// The load parameter at a length.
    pub(crate) fn at(&self, length: f64) -> f64 {
        let [a, b, c, d] = self.weights(length);
        a * self.from.at + b * self.from_rate.at + c * self.to.at + d * self.to_rate.at
    }

    /// The rate of the load parameter at a length.
    pub(crate) fn slope(&self, length: f64) -> f64 {
        let u = length / self.length;
        let chord = (self.to.at - self.from.at) / self.length;
        6.0 * u * (1.0 - u) * chord
            + (1.0 - u) * (1.0 - 3.0 * u) * self.from_rate.at
            + u * (3.0 * u - 2.0) * self.to_rate.at
    }

    /// The position with a given load parameter between the load parameters of the two points.
    pub(crate) fn at_load(&self, at: f64) -> PathPoint {
        let length = bisected(0.0, self.length, |length| self.at(length) < at);
        let position = self.position(length);
        PathPoint { at, ..position }
    }
}

/// The number between `low` and `high` up to which a condition holds.
pub(crate) fn bisected(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position(at: f64, x: f64) -> PathPoint {
        PathPoint { at, configuration: vec![[x, 2.0 * x, 1.0]], forces: vec![[-x, 0.0, 0.0]] }
    }

    /// q = s^3 - s, t = s + s^2 from s = 1 to 3, and beyond.
    #[test]
    fn cubics_are_reproduced_inside_and_outside_the_arc() {
        let x = |s: f64| s * s * s - s;
        let t = |s: f64| s + s * s;
        let rate = |s: f64| PathPoint {
            configuration: vec![[3.0 * s * s - 1.0, 2.0 * (3.0 * s * s - 1.0), 0.0]],
            forces: vec![[1.0 - 3.0 * s * s, 0.0, 0.0]],
            at: 1.0 + 2.0 * s,
        };
        let arc = PathArc {
            from: position(t(1.0), x(1.0)),
            from_rate: rate(1.0),
            to: position(t(3.0), x(3.0)),
            to_rate: rate(3.0),
            length: 2.0,
        };
        for s in [1.0, 1.7, 2.9, 4.2] {
            let found = arc.position(s - 1.0);
            assert!((found.at - t(s)).abs() < 1e-12 && (arc.at(s - 1.0) - t(s)).abs() < 1e-12);
            assert!((found.configuration[0][1] - 2.0 * x(s)).abs() < 1e-11);
            assert!((found.configuration[0][2] - 1.0).abs() < 1e-12);
            assert!((found.forces[0][0] + x(s)).abs() < 1e-11);
        }
        let read = arc.at_load(t(2.2));
        assert!((read.configuration[0][0] - x(2.2)).abs() < 1e-11);
        assert_eq!(read.at, t(2.2));
    }
}
