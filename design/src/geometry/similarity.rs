//! The rigid motion, with or without a change of scale, that maps one set of labelled points onto
//! another.
//!
//! It is, in complex numbers, z -> turn z + shift: |turn| is the scale and arg(turn) the rotation.
//! If p' and m' are relative to their means, sum |m - turn p - shift|^2 is least at
//!
//! ```text
//! turn = sum conj(p') m' / sum |p'|^2,     shift = mean(m) - turn mean(p),
//! ```
//!
//! the plane case of Umeyama (IEEE Trans. PAMI 13, 1991, 376). At a fixed scale, turn is divided by
//! its magnitude.

use faer::c64;

/// Whether the scale is a part of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// The scale is 1.
    Given,
    /// The scale is fitted.
    Free,
}

impl Scale {
    /// Number of unknowns of a motion with this scale.
    pub fn unknowns(self) -> f64 {
        match self {
            Self::Given => 3.0,
            Self::Free => 4.0,
        }
    }
}

/// z -> turn z + shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// Scale and rotation.
    pub turn: c64,
    /// The image of the origin.
    pub shift: c64,
}

/// A point and its image.
pub type Correspondence = [c64; 2];

impl Similarity {
    /// The least-squares fit; `None` if the points, or their images, coincide.
    pub fn least_squares(pairs: &[Correspondence], scale: Scale) -> Option<Self> {
        let count = pairs.len() as f64;
        let mean = |i: usize| pairs.iter().map(|pair| pair[i]).sum::<c64>() / count;
        let (from, to) = (mean(0), mean(1));
        let (mut product, mut square) = (c64::ZERO, 0.0);
        for [p, m] in pairs {
            product += (p - from).conj() * (m - to);
            square += (p - from).norm_sqr();
        }
        let turn = match scale {
            Scale::Given => product / product.norm(),
            Scale::Free => product / square,
        };
        let usable = turn.is_finite() && turn.norm() > 0.0;
        usable.then(|| Self { turn, shift: to - turn * from })
    }

    /// Distance of the image from its prediction, as a length before the motion.
    pub fn residual(&self, [p, m]: &Correspondence) -> f64 {
        (m - self.of(*p)).norm() / self.scale()
    }

    /// The image of a point.
    pub fn of(&self, z: c64) -> c64 {
        self.turn * z + self.shift
    }

    /// The point of an image.
    pub fn back(&self, z: c64) -> c64 {
        (z - self.shift) / self.turn
    }

    /// Lengths after the motion over lengths before it.
    pub fn scale(&self) -> f64 {
        self.turn.norm()
    }

    /// The rotation (rad).
    pub fn rotation(&self) -> f64 {
        self.turn.arg()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOTION: Similarity =
        Similarity { turn: c64::new(0.6, 1.7), shift: c64::new(-300.0, 40.0) };

    fn pairs(motion: Similarity) -> Vec<Correspondence> {
        let numbers = (0..60).map(f64::from);
        let points = numbers.map(|i| c64::new(37.0 * i % 101.0, 53.0 * i % 89.0));
        points.map(|point| [point, motion.of(point)]).collect()
    }

    #[test]
    fn a_similarity_is_recovered_and_inverted() {
        let fit = Similarity::least_squares(&pairs(MOTION), Scale::Free).unwrap();
        assert!((fit.turn - MOTION.turn).norm() < 1e-14);
        assert!((fit.shift - MOTION.shift).norm() < 1e-12);
        let point = c64::new(3.0, -8.0);
        assert!((fit.back(fit.of(point)) - point).norm() < 1e-12);
    }

    #[test]
    fn a_given_scale_leaves_the_rotation_of_the_free_fit() {
        let [given, free] = [Scale::Given, Scale::Free]
            .map(|scale| Similarity::least_squares(&pairs(MOTION), scale).unwrap());
        assert!((given.scale() - 1.0).abs() < 1e-15);
        assert!((given.rotation() - free.rotation()).abs() < 1e-14);
    }

    /// The sum of squares is stationary at the fit.
    #[test]
    fn every_small_change_of_the_fit_increases_the_sum_of_squares() {
        let mut pairs = pairs(MOTION);
        for (i, pair) in pairs.iter_mut().enumerate() {
            pair[1] += c64::cis(i as f64) * (i % 7) as f64;
        }
        let sum = |fit: Similarity| -> f64 {
            pairs.iter().map(|[p, m]| (m - fit.of(*p)).norm_sqr()).sum()
        };
        let fit = Similarity::least_squares(&pairs, Scale::Free).unwrap();
        for step in [c64::ONE, -c64::ONE, c64::I, -c64::I] {
            let [mut turned, mut shifted] = [fit; 2];
            turned.turn += 1e-4 * step;
            shifted.shift += 1e-3 * step;
            assert!(sum(turned) > sum(fit) && sum(shifted) > sum(fit));
        }
    }

    #[test]
    fn coinciding_points_have_no_fit() {
        let same = [[c64::ONE, c64::I]; 5];
        for scale in [Scale::Given, Scale::Free] {
            assert_eq!(Similarity::least_squares(&same, scale), None);
            assert_eq!(Similarity::least_squares(&[], scale), None);
        }
    }
}
