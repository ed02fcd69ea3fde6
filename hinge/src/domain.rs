//! The training domain: the set of hinge states that a database covers, which is smaller than their
//! bounding box.
//!
//! In the scaled coordinates y = ((eta_a, eta_s, theta) - centre) / half-range, the states at
//! ligament widths near w_lig satisfy m . y <= s(m; w_lig) for each of the 26 directions m with
//! components -1, 0 and 1; s is the support function of these states. The domain is the set where
//! the gauge satisfies
//!
//! ```text
//! gamma = (sum over m of max(0, m . y / s(m; w_lig))^p)^(1/p) <= 1,      p = 24
//! ```
//!
//! and w_lig, alpha and rho_f lie in their intervals. gamma is smooth except at the centre, where
//! it vanishes. It rounds the corners of the polytope inwards and grows in proportion to the
//! distance from the centre.
//!
//! In plates, eta_a is measured from the mean path of the states, c_1 theta + c_2 theta^2 by least
//! squares: their ligaments turn freely along a curve, and a polytope around a curve holds states
//! far beyond any ray. If hinges have holes of several radii, eta_a and eta_s belong to the hinge
//! with the paper's hole and the same net ligament ([`NetLigament`]).
//!
//! s is stored at widths in geometric progression and is blended between them with zero slope at
//! both ends, so that gamma is twice differentiable in w_lig. (Klosowski et al., "Efficient
//! collision detection using bounding volume hierarchies of k-DOPs", 1998.)

mod directions;
mod stored_domain;

use crate::domain::directions::{DIRECTION, DIRECTIONS, EXPONENT, ROUNDED, norm};
use crate::net_ligament::{NetLigament, NetLigamentJet};
use crate::{HingeConstants, HingeDeformation, HingeDesign, Jet};
use serde::{Deserialize, Serialize};
use std::array::from_fn;
use support::{Extremes, vectors::dot};

/// The states that a surrogate was trained on; section 2.4. The domain is computed from the data
/// and stored with the weights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "stored_domain::Stored")]
pub struct TrainingDomain {
    /// Interval of the ligament width (mm).
    pub w_lig: [f64; 2],
    /// Interval of the cut angle (rad).
    pub alpha: [f64; 2],
    /// Interval of the radius of the hole over w_lig, if hinges have holes of several radii.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holes: Option<[f64; 2]>,
    /// c_1 and c_2 of the mean path.
    #[serde(skip_serializing_if = "is_straight")]
    mean_path: [f64; 2],
    /// Centre of (eta_a, eta_s, theta), eta_a from the mean path.
    centre: [f64; 3],
    half_range: [f64; 3],
    /// s(m), one row for each stored width, from the narrowest to the widest.
    supports: Vec<[f64; DIRECTIONS]>,
}

/// The domain of one hinge: the states of its width.
#[derive(Clone, Debug)]
pub struct Section {
    ligament: NetLigament,
    /// Width of the hinge in whose measures the domain is (mm).
    w_lig: f64,
    /// s(m)
    supports: [f64; DIRECTIONS],
}

impl TrainingDomain {
    /// Whether the state of one hinge lies in the domain.
    pub fn contains(&self, design: &HingeDesign, deformation: &HingeDeformation) -> bool {
        self.has_ligament(design) && !self.is_beyond(1.0, &self.section(design), deformation)
    }

    /// Whether the width, the angle and the hole of a ligament are within their intervals.
    fn has_ligament(&self, design: &HingeDesign) -> bool {
        let within =
            |[minimum, maximum]: [f64; 2], value: f64| minimum <= value && value <= maximum;
        within(self.w_lig, design.w_lig)
            && within(self.alpha, design.alpha)
            && (self.holes).is_none_or(|holes| within(holes, design.fillet_ratio))
    }

    /// 1 - gamma of the state: 1 at the centre of the domain, 0 at its edge, negative outside.
    pub fn depth(&self, design: &HingeDesign, deformation: &HingeDeformation) -> f64 {
        1.0 - self.gauge(design, deformation)
    }

    /// The gauge gamma.
    pub fn gauge(&self, design: &HingeDesign, deformation: &HingeDeformation) -> f64 {
        norm(self.ratios(&self.section(design), deformation))
    }

    /// Whether the gauge is above a limit, for a hinge with the given section.
    pub fn is_beyond(&self, limit: f64, section: &Section, deformation: &HingeDeformation) -> bool {
        let ratios = self.ratios(section, deformation);
        ratios.into_iter().fold(0.0, f64::max) * ROUNDED > limit && norm(ratios) > limit
    }

    /// The domain of a hinge.
    pub fn section(&self, design: &HingeDesign) -> Section {
        let ligament = self.ligament(design);
        let (row, [blend, ..]) = self.place(design.w_lig);
        Section {
            ligament,
            w_lig: ligament.design(design).w_lig,
            supports: from_fn(|m| self.supports[row][m] + blend * self.rise(row, m)),
        }
    }

    /// m . y / s(m; w_lig)
    fn ratios(&self, section: &Section, deformation: &HingeDeformation) -> [f64; DIRECTIONS] {
        let y = self.scaled(self.measured(&section.ligament, section.w_lig, deformation));
        from_fn(|m| dot(&DIRECTION[m], &y) / section.supports[m])
    }

    /// The gauge gamma with its derivatives in (a, s, theta, w_lig, rho_f). At the centre they do
    /// not exist.
    pub fn gauge_jet(&self, design: &HingeDesign, deformation: &HingeDeformation) -> Jet {
        let y = self.coordinates_jet(design, deformation);
        let y: [Jet; 3] =
            from_fn(|i| (y[i] - Jet::constant(self.centre[i])) * (1.0 / self.half_range[i]));
        let (row, blend) = self.place(design.w_lig);
        let blend = Jet::variable(Jet::W_LIG, design.w_lig).map(blend);
        let ratios: [Jet; DIRECTIONS] = from_fn(|m| {
            let support = Jet::constant(self.supports[row][m]) + blend * self.rise(row, m);
            let components = std::iter::zip(DIRECTION[m], y);
            let along = components.fold(Jet::constant(0.0), |sum, (m, y)| sum + y * m);
            along * support.recip()
        });
        // Ratios are divided by the largest, so that the powers neither overflow nor underflow.
        let largest = ratios.iter().map(|ratio| ratio.value).largest();
        let sum = ratios.iter().filter(|ratio| ratio.value > 0.0);
        let sum = sum
            .fold(Jet::constant(0.0), |sum, ratio| sum + (*ratio * (1.0 / largest)).powf(EXPONENT));
        sum.powf(1.0 / EXPONENT) * largest
    }

    /// The coordinates of the centre of the gauge.
    pub fn centre(&self) -> [f64; 3] {
        self.centre
    }

    /// Intervals of the coordinates that the domain spans over all widths; theta in rad.
    pub fn bounds(&self) -> [[f64; 2]; 3] {
        from_fn(|i| {
            let side = |sign: f64| {
                let axis = DIRECTION.iter().position(|m| m[i] == sign && dot(m, m) == 1.0);
                let axis = axis.expect("the axes are among the directions");
                self.supports.iter().map(|row| row[axis]).largest()
            };
            let (centre, half) = (self.centre[i], self.half_range[i]);
            [centre - half * side(-1.0), centre + half * side(1.0)]
        })
    }

    /// The coordinates in which the domain is a rounded polytope: (eta_a, eta_s, theta), eta_a from
    /// the mean path.
    pub fn coordinates(&self, design: &HingeDesign, deformation: &HingeDeformation) -> [f64; 3] {
        let ligament = self.ligament(design);
        self.measured(&ligament, ligament.design(design).w_lig, deformation)
    }

    fn measured(&self, by: &NetLigament, w_lig: f64, actual: &HingeDeformation) -> [f64; 3] {
        let seen = by.deformation(actual);
        let [eta_a, eta_s] = seen.eta(w_lig);
        [eta_a - self.mean_path(seen.theta), eta_s, seen.theta]
    }

    /// The deformation of a hinge with the given coordinates.
    pub fn state(&self, design: &HingeDesign, [eta_a, eta_s, theta]: [f64; 3]) -> HingeDeformation {
        let ligament = self.ligament(design);
        let w_lig = ligament.design(design).w_lig;
        let eta_a = eta_a + self.mean_path(theta);
        ligament.actual(&HingeDeformation::from_eta(eta_a, eta_s, theta, w_lig))
    }

    /// The coordinates as functions of (a, s, theta, w_lig, rho_f).
    pub fn coordinates_jet(
        &self,
        design: &HingeDesign,
        deformation: &HingeDeformation,
    ) -> [Jet; 3] {
        let state = deformation.to_array();
        let ligament = NetLigamentJet::new(design, self.hole());
        let [a, s, theta] = ligament.deformation(from_fn(|i| Jet::variable(i, state[i])));
        let per_width = ligament.width.recip();
        [a * per_width - self.mean_path_jet(theta), s * per_width, theta]
    }

    /// The deformation with the given coordinates, as functions of (a, s, theta, w_lig, rho_f).
    pub fn state_jet(&self, design: &HingeDesign, [eta_a, eta_s, theta]: [Jet; 3]) -> [Jet; 3] {
        let ligament = NetLigamentJet::new(design, self.hole());
        let eta_a = eta_a + self.mean_path_jet(theta);
        ligament.actual([eta_a * ligament.width, eta_s * ligament.width, theta])
    }

    /// c_1 and c_2 of the mean path from which eta_a is counted; `None` if it is counted from zero.
    pub fn curve(&self) -> Option<[f64; 2]> {
        (!is_straight(&self.mean_path)).then_some(self.mean_path)
    }

    /// eta_a of the mean path.
    fn mean_path(&self, theta: f64) -> f64 {
        let [first, second] = self.mean_path;
        theta * (first + second * theta)
    }

    fn mean_path_jet(&self, theta: Jet) -> Jet {
        let [first, second] = self.mean_path;
        theta.map([self.mean_path(theta.value), first + 2.0 * second * theta.value, 2.0 * second])
    }

    /// The hole, over w_lig, of the hinges in whose measures the domain is; `None`: in the measures
    /// of the hinges themselves.
    fn hole(&self) -> Option<f64> {
        self.holes.map(|_| HingeConstants::PAPER.fillet_ratio)
    }

    /// The map of a hinge to that in whose measures the domain is.
    fn ligament(&self, design: &HingeDesign) -> NetLigament {
        NetLigament::new(design, self.hole().unwrap_or(design.fillet_ratio))
    }

    fn scaled(&self, x: [f64; 3]) -> [f64; 3] {
        from_fn(|i| (x[i] - self.centre[i]) / self.half_range[i])
    }

    /// Fractional index of a width among the `widths` stored widths, counted from 0.
    fn along(&self, w_lig: f64, widths: usize) -> f64 {
        let [minimum, maximum] = self.w_lig;
        let steps = (widths - 1) as f64;
        let share = (w_lig / minimum).ln() / (maximum / minimum).ln();
        if share.is_finite() { (share * steps).clamp(0.0, steps) } else { 0.0 }
    }

    /// The row of supports at or below a width, and the blending weight 6 x^5 - 15 x^4 + 10 x^3 of
    /// the next row, with its derivatives in w_lig.
    fn place(&self, w_lig: f64) -> (usize, [f64; 3]) {
        let widths = self.supports.len();
        let along = self.along(w_lig, widths);
        let row = (along as usize).min(widths.saturating_sub(2));
        let x = along - row as f64;
        let [minimum, maximum] = self.w_lig;
        let slope = (widths - 1) as f64 / (maximum / minimum).ln() / w_lig;
        if widths == 1 || !slope.is_finite() {
            return (row, [0.0; 3]);
        }
        let first = 30.0 * (x * (1.0 - x)).powi(2);
        let second = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x);
        let blend = x * x * x * (x * (6.0 * x - 15.0) + 10.0);
        (row, [blend, first * slope, second * slope * slope - first * slope / w_lig])
    }

    /// Difference of the support at the next stored width and at this one.
    fn rise(&self, row: usize, m: usize) -> f64 {
        let next = self.supports.get(row + 1).unwrap_or(&self.supports[row]);
        next[m] - self.supports[row][m]
    }
}

/// Whether eta_a is measured from zero.
fn is_straight(mean_path: &[f64; 2]) -> bool {
    *mean_path == [0.0; 2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::stored_domain::MOST_WIDTHS;

    fn design(w_lig: f64) -> HingeDesign {
        HingeConstants::PAPER.hinge(w_lig, 1.3)
    }

    fn with_hole(w_lig: f64, fillet_ratio: f64) -> HingeDesign {
        HingeDesign { fillet_ratio, ..design(w_lig) }
    }

    /// Ends of rays in a cone, and their mirror images: tension and shear increase with the
    /// rotation and decrease with the width.
    fn cone() -> Vec<(HingeDesign, HingeDeformation)> {
        let part = |i: usize, prime: f64| (i as f64 * prime).fract() * 2.0 - 1.0;
        let state = |i: usize| {
            let w_lig = 10.0 * 2f64.powf(part(i, 0.618_033_988_7));
            let theta = 0.5 + 0.5 * part(i, 0.414_213_562_4);
            let size = 0.3 * theta * 5.0 / w_lig;
            let [x, y] = [part(i, 0.732_050_807_6), part(i, 0.236_067_977_5)];
            let state = HingeDeformation::from_eta(size * x, size * y, theta, w_lig);
            (HingeConstants::PAPER.hinge(w_lig, 1.3), state)
        };
        let states = (0..20_000).map(state);
        states.flat_map(|(g, x)| [(g, x), (g.mirrored(), x.mirrored())]).collect()
    }

    /// The same states about a ligament that turns freely along a curve, narrower in eta_a.
    fn bent() -> Vec<(HingeDesign, HingeDeformation)> {
        let bend = |(design, x): (HingeDesign, HingeDeformation)| {
            let [eta_a, eta_s] = x.eta(design.w_lig);
            let free = x.theta * (0.5 + 0.3 * x.theta);
            let eta_a = free + 0.3 * eta_a;
            let state = HingeDeformation::from_eta(eta_a, eta_s, x.theta, design.w_lig);
            (design, state)
        };
        cone().into_iter().map(bend).collect()
    }

    fn domain(states: &[(HingeDesign, HingeDeformation)]) -> TrainingDomain {
        TrainingDomain::covering(states.iter().copied()).unwrap()
    }

    #[test]
    fn the_domain_contains_the_states_but_not_the_corners_of_their_bounding_box() {
        let states = cone();
        let domain = domain(&states);
        let share = |domain: &TrainingDomain| {
            let inside = states.iter().filter(|(g, x)| domain.contains(g, x));
            inside.count() as f64 / states.len() as f64
        };
        assert!(share(&domain) > 0.75, "{}", share(&domain));
        let at = |eta_a: f64, theta: f64, w_lig: f64| {
            let state = HingeDeformation::from_eta(eta_a, 0.0, theta, w_lig);
            domain.contains(&design(w_lig), &state)
        };
        // A corner of the box that no ray reaches, and a width at which the range is smaller than
        // at others.
        assert!(at(0.2, 0.9, 5.5) && !at(0.2, 0.2, 5.5));
        assert!(at(0.06, 0.9, 18.0) && !at(0.2, 0.9, 18.0));
        assert!(at(0.0, 0.0, 10.0), "the flat state");
        let [eta_a, ..] = domain.bounds();
        assert!((eta_a[1] - 0.3).abs() < 0.03 && (eta_a[0] + 0.3).abs() < 0.03, "{eta_a:?}");
    }

    /// Between the ends of the curve a polytope would hold the chord, which is beyond the states on
    /// either side.
    #[test]
    fn a_domain_follows_a_curved_path() {
        let domain = domain(&bent());
        let at = |eta_a: f64, theta: f64| {
            let state = HingeDeformation::from_eta(eta_a, 0.0, theta, 10.0);
            domain.contains(&design(10.0), &state)
        };
        for theta in [0.2, 0.5, 0.8] {
            let free = theta * (0.5 + 0.3 * theta);
            assert!(at(free, theta) && !at(free + 0.1, theta) && !at(free - 0.1, theta));
        }
        let state = HingeDeformation::from_eta(0.4, 0.02, 0.6, 10.0);
        let found = domain.state(&design(10.0), domain.coordinates(&design(10.0), &state));
        let difference = std::iter::zip(found.to_array(), state.to_array());
        assert!(difference.into_iter().all(|(x, y)| (x - y).abs() < 1e-12));
    }

    #[test]
    fn mirror_images_have_the_same_depth() {
        let domain = domain(&cone());
        for (a, s, theta) in [(0.1, 0.2, 0.5), (-0.3, 0.05, 0.1), (0.02, -0.07, 1.4)] {
            let state = HingeDeformation::from_eta(a, s, theta, 9.0);
            let depth = domain.depth(&design(9.0), &state);
            let image = domain.depth(&design(9.0).mirrored(), &state.mirrored());
            assert!((depth - image).abs() < 1e-13, "{depth} {image}");
        }
    }

    #[test]
    fn the_derivatives_of_the_gauge_agree_with_finite_differences() {
        let several = cone().into_iter().enumerate().map(|(i, (g, x))| {
            let fillet_ratio = [0.05, 0.16, 0.3][i % 3];
            (HingeDesign { fillet_ratio, ..g }, x)
        });
        for states in [cone(), several.collect(), bent()] {
            derivatives_agree(&domain(&states));
        }
    }

    fn derivatives_agree(domain: &TrainingDomain) {
        for x in
            [[0.9, -0.4, 0.5, 8.0, 0.2], [-2.0, 3.0, 1.5, 14.0, 0.16], [0.1, 0.2, -0.1, 5.2, 0.05]]
        {
            let jet =
                |x: [f64; 5]| domain.gauge_jet(&with_hole(x[3], x[4]), &[x[0], x[1], x[2]].into());
            let found = jet(x);
            let value = domain.gauge(&with_hole(x[3], x[4]), &[x[0], x[1], x[2]].into());
            assert!((found.value - value).abs() < 1e-13 * value);
            for i in 0..5 {
                let h = 1e-5;
                let at = |step: f64| jet(from_fn(|j| if i == j { x[j] + step } else { x[j] }));
                let (plus, minus) = (at(h), at(-h));
                let slope = (plus.value - minus.value) / (2.0 * h);
                assert!((found.gradient[i] - slope).abs() < 1e-7 * slope.abs().max(1.0), "{i}");
                for j in 0..5 {
                    let slope = (plus.gradient[j] - minus.gradient[j]) / (2.0 * h);
                    let error = (found.hessian[i][j] - slope).abs();
                    assert!(error < 1e-5 * slope.abs().max(1.0), "{i} {j}: {slope}");
                }
            }
        }
    }

    #[test]
    fn the_gauge_is_twice_differentiable_across_the_stored_widths() {
        let domain = domain(&cone());
        assert_eq!(domain.supports.len(), MOST_WIDTHS);
        let state = HingeDeformation { a: 1.0, s: 0.3, theta: 0.7 };
        for width in [10.0 / 2f64.sqrt(), 10.0, 20.0] {
            let at = |step: f64| domain.gauge_jet(&design(width + step), &state);
            let (plus, minus) = (at(1e-6), at(-1e-6));
            assert!((plus.gradient[3] - minus.gradient[3]).abs() < 1e-6);
            assert!((plus.hessian[3][3] - minus.hessian[3][3]).abs() < 1e-3);
        }
    }

    #[test]
    fn a_box_a_single_state_and_no_state_are_handled() {
        let state = [[-0.5, 0.25], [-0.5, 0.5], [0.0, 1.25]];
        let corner = |k: usize| [0, 1, 2].map(|i: usize| state[i][(k >> i) & 1]);
        let ends = |k| {
            let [eta_a, eta_s, theta] = corner(k);
            let end = |w_lig| HingeDeformation::from_eta(eta_a, eta_s, theta, w_lig);
            [8.0, 16.0].map(|w_lig| (design(w_lig), end(w_lig)))
        };
        let boxed = domain(&(0..8).flat_map(ends).collect::<Vec<_>>());
        let deep = |eta_a, eta_s, theta| {
            boxed.depth(&design(9.0), &HingeDeformation::from_eta(eta_a, eta_s, theta, 9.0))
        };
        assert!(deep(-0.125, 0.475, 0.625) > 0.0 && deep(-0.125, 0.525, 0.625) < 0.0);
        assert!(deep(0.0, 0.0, 0.0) > 0.0 && deep(-0.125, 0.0, 0.625) == 1.0);
        assert!(!boxed.contains(&design(4.0), &HingeDeformation::default()));
        let one = domain(&[(design(9.0), HingeDeformation { a: 1.0, s: 0.0, theta: 0.5 })]);
        assert!(one.contains(&design(9.0), &HingeDeformation::default()));
        assert!(TrainingDomain::covering([]).is_none());
    }

    #[test]
    fn a_domain_round_trips_exactly_and_a_spoilt_one_is_refused() {
        let domain = domain(&cone());
        let text = serde_json::to_string(&domain).unwrap();
        assert_eq!(serde_json::from_str::<TrainingDomain>(&text).unwrap(), domain);
        let spoilt = text.replacen("\"supports\":[[", "\"supports\":[[-", 1);
        let message = serde_json::from_str::<TrainingDomain>(&spoilt).unwrap_err().to_string();
        assert!(message.contains("supports > 0"), "{message}");
    }
}
