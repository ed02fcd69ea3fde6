//! The deformation path of a window solve: (a, s, theta) as a function of lambda in [0, 1].
//!
//! The database consists of rays (section 2.4): straight rays for films; the rays of plates bend
//! like the free turn of a ligament. Paths recorded from deployed sheets measure the error of
//! ignoring the loading path (section 5.2). All are piecewise linear and start at the undeformed
//! state.

use hinge::{HingeDeformation, HingeDesign, Regime};
use serde::{Deserialize, Serialize};
use std::array::from_fn;
use support::interpolation::piece;

/// A piecewise linear path from the undeformed state at lambda = 0 to its end at lambda = 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Knot>", into = "Vec<Knot>")]
pub struct DeformationPath {
    /// (lambda, state), with lambda increasing from 0 to 1.
    knots: Vec<Knot>,
}

type Knot = (f64, HingeDeformation);

/// Number of straight pieces of a ray that bends: the free turn of 60 degrees is met within 0.0004
/// w_lig.
const PIECES: u32 = 10;

impl From<DeformationPath> for Vec<Knot> {
    fn from(path: DeformationPath) -> Self {
        path.knots
    }
}

impl TryFrom<Vec<Knot>> for DeformationPath {
    type Error = &'static str;

    fn try_from(knots: Vec<Knot>) -> Result<Self, Self::Error> {
        match &knots[..] {
            [first, .., last] if first.0 == 0.0 && last.0 == 1.0 => Ok(Self { knots }),
            _ => Err("a path leads from lambda = 0 to lambda = 1"),
        }
    }
}

impl DeformationPath {
    /// The straight ray to `end`.
    pub fn straight(end: HingeDeformation) -> Self {
        Self { knots: vec![(0.0, HingeDeformation::default()), (1.0, end)] }
    }

    /// The ray to `end` of a ligament of the width `w_lig` (mm): eta_s and theta grow in
    /// proportion, and so does the distance of eta_a from the free turn of the regime. With lambda
    /// it reaches every state between as the ray to that state does. Sheets of plates take such
    /// paths: the forces at their end differ from the forces of paths recorded in sheets by half as
    /// much as the forces of straight rays do.
    pub fn ray(end: HingeDeformation, regime: Regime, w_lig: f64) -> Self {
        let [_, curvature] = regime.free_opening();
        if curvature == 0.0 {
            return Self::straight(end);
        }
        let bend = curvature * w_lig * end.theta * end.theta.abs();
        let state = |i: u32| {
            let lambda = f64::from(i) / f64::from(PIECES);
            let straight = end.at(lambda);
            HingeDeformation { a: straight.a - bend * lambda * (1.0 - lambda), ..straight }
        };
        let states: Vec<_> = (1..=PIECES).map(state).collect();
        Self::through(&states).expect("there are states")
    }

    /// The path through `states`, equally spaced in lambda; `None` without a state.
    pub fn through(states: &[HingeDeformation]) -> Option<Self> {
        let fraction = |i: usize| (i + 1) as f64 / states.len() as f64;
        let recorded = states.iter().enumerate();
        let mut knots = vec![(0.0, HingeDeformation::default())];
        knots.extend(recorded.map(|(i, state)| (fraction(i), *state)));
        (knots.len() > 1).then_some(Self { knots })
    }

    /// The values of lambda at which the path may have a corner, including its ends.
    pub fn corners(&self) -> impl Iterator<Item = f64> {
        self.knots.iter().map(|(lambda, _)| *lambda)
    }

    /// The end of the longest part of the path before it turns back: from there on the hinge is
    /// unloaded. `None` if it never turns back, by more than a right angle where each component is
    /// relative to its largest value on the path.
    pub fn turn(&self) -> Option<f64> {
        let largest: [f64; 3] = from_fn(|c| {
            let values = self.knots.iter().map(|(_, state)| state.to_array()[c].abs());
            values.fold(f64::MIN_POSITIVE, f64::max)
        });
        let leg = |i: usize| -> [f64; 3] {
            let [from, to] = [i, i + 1].map(|i| self.knots[i].1.to_array());
            from_fn(|c| (to[c] - from[c]) / largest[c])
        };
        let turns_back = |&i: &usize| {
            let legs = std::iter::zip(leg(i - 1), leg(i));
            legs.map(|(before, after)| before * after).sum::<f64>() < 0.0
        };
        let (mut begin, mut longest) = (0.0, (0.0, None));
        for i in (1..self.knots.len() - 1).filter(turns_back) {
            let turn = self.knots[i].0;
            if turn - begin > longest.0 {
                longest = (turn - begin, Some(turn));
            }
            begin = turn;
        }
        longest.1
    }

    /// The state at `lambda` in [0, 1].
    pub fn at(&self, lambda: f64) -> HingeDeformation {
        let ((_, from), (_, to), fraction) = piece(&self.knots, |(at, _)| *at, lambda);
        let (x, y) = (from.to_array(), to.to_array());
        from_fn(|i| x[i] + fraction * (y[i] - x[i])).into()
    }
}

/// One design driven from the undeformed state to `end`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ray {
    /// The hinge design.
    pub design: HingeDesign,
    /// The deformation at lambda = 1.
    pub end: HingeDeformation,
}

impl Ray {
    /// The ray with its path: see [`DeformationPath::ray`].
    pub fn driven(self, regime: Regime) -> HingePath {
        let Self { design, end } = self;
        let path = DeformationPath::ray(end, regime, design.w_lig);
        HingePath { design, path }
    }

    /// The ray of the mirrored design; see [`HingeDeformation::mirrored`].
    pub fn mirrored(&self) -> Self {
        Self { design: self.design.mirrored(), end: self.end.mirrored() }
    }
}

/// One design driven along a path. In a file, a straight path is its `end` alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "InFile", into = "InFile")]
pub struct HingePath {
    /// The hinge design.
    pub design: HingeDesign,
    /// The path of its deformation.
    pub path: DeformationPath,
}

/// A hinge with its path in a file.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum InFile {
    Ray(Ray),
    Path { design: HingeDesign, path: DeformationPath },
}

impl From<InFile> for HingePath {
    fn from(file: InFile) -> Self {
        match file {
            InFile::Ray(ray) => ray.driven(Regime::Film),
            InFile::Path { design, path } => Self { design, path },
        }
    }
}

impl From<HingePath> for InFile {
    fn from(HingePath { design, path }: HingePath) -> Self {
        let end = path.at(1.0);
        if path == DeformationPath::straight(end) {
            Self::Ray(Ray { design, end })
        } else {
            Self::Path { design, path }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeConstants;

    /// A ray of a plate bends like the free turn, and passes through every state as the ray to that
    /// state.
    #[test]
    fn a_ray_of_a_plate_bends_like_the_free_turn() {
        let free = |theta: f64| theta * (0.5 + 0.16 * theta.abs());
        for (theta, pull) in [(1.0, 0.0), (0.8, 0.1), (-0.1, -0.05)] {
            let state = |lambda: f64| {
                let turned = lambda * theta;
                let eta_a = free(turned) + lambda * pull;
                HingeDeformation::from_eta(eta_a, 0.1 * lambda, turned, 2.0)
            };
            let [ray, halfway] =
                [1.0, 0.5].map(|end| DeformationPath::ray(state(end), Regime::Plate, 2.0));
            for i in 0..=20 {
                let lambda = f64::from(i) / 20.0;
                for (path, end) in [(&ray, 1.0), (&halfway, 0.5)] {
                    let [found, exact] = [path.at(lambda), state(end * lambda)];
                    let off = std::iter::zip(found.to_array(), exact.to_array());
                    assert!(off.map(|(x, y)| (x - y).abs()).sum::<f64>() < 1e-3);
                }
            }
            let film = DeformationPath::ray(state(1.0), Regime::Film, 2.0);
            assert_eq!(film, DeformationPath::straight(state(1.0)));
        }
    }

    fn state(eta_a: f64, eta_s: f64, theta_deg: f64) -> HingeDeformation {
        HingeDeformation::from_eta(eta_a, eta_s, theta_deg.to_radians(), 20.0)
    }

    #[test]
    fn a_path_turns_back_where_it_is_unloaded() {
        let through = |states: &[[f64; 3]]| {
            let states: Vec<_> = states.iter().map(|&[a, s, t]| state(a, s, t)).collect();
            DeformationPath::through(&states).unwrap().turn()
        };
        assert_eq!(through(&[[-0.1, 0.0, 40.0]]), None);
        assert_eq!(through(&[[-0.1, 0.0, 20.0], [-0.3, 0.1, 40.0]]), None);
        let released = [[-0.1, 0.0, 20.0], [-0.2, 0.0, 40.0], [-0.2, 0.1, 20.0], [0.0, 0.0, 10.0]];
        assert_eq!(through(&released), Some(0.5));
        // The weight of a sheet turned the hinge the other way before.
        let weighed = [
            [0.0, 0.0, -5.0],
            [-0.1, 0.0, 20.0],
            [-0.2, 0.0, 40.0],
            [0.0, 0.0, 20.0],
            [0.0, 0.0, 10.0],
        ];
        assert_eq!(through(&weighed), Some(0.6));
    }

    #[test]
    fn a_straight_path_is_the_ray() {
        let end = state(-0.1, 0.2, -40.0);
        let path = DeformationPath::straight(end);
        for lambda in [0.0, 0.25, 1.0] {
            assert_eq!(path.at(lambda), end.at(lambda));
        }
    }

    #[test]
    fn states_are_equally_spaced_from_the_undeformed_state() {
        let path = DeformationPath::through(&[state(0.0, 0.0, 30.0), state(-0.2, 0.1, 60.0)]);
        let path = path.unwrap();
        assert_eq!(path.corners().collect::<Vec<_>>(), [0.0, 0.5, 1.0]);
        assert_eq!(path.at(0.5), state(0.0, 0.0, 30.0));
        assert_eq!(path.at(1.0), state(-0.2, 0.1, 60.0));
        let middle = path.at(0.75).to_array();
        for (x, y) in middle.iter().zip(state(-0.1, 0.05, 45.0).to_array()) {
            assert!((x - y).abs() < 1e-14);
        }
        assert_eq!(DeformationPath::through(&[]), None);
    }

    #[test]
    fn a_path_is_read_back_and_a_straight_one_is_written_as_its_end() {
        let design = HingeConstants::PAPER.hinge(18.0, 1.5);
        let [middle, end] =
            [0.2, 0.6].map(|theta| HingeDeformation::from_eta(-0.1, 0.3 * theta, theta, 18.0));
        let ray = Ray { design, end }.driven(Regime::Film);
        let bent =
            HingePath { path: DeformationPath::through(&[middle, end]).unwrap(), ..ray.clone() };
        let text = serde_json::to_string(&ray).unwrap();
        assert_eq!(text, serde_json::to_string(&Ray { design, end }).unwrap());
        for hinge in [ray, bent] {
            let text = serde_json::to_string(&hinge).unwrap();
            assert_eq!(serde_json::from_str::<HingePath>(&text).unwrap(), hinge);
        }
        let empty = text.split("\"end\"").next().unwrap().to_owned() + "\"path\":[]}";
        assert!(serde_json::from_str::<HingePath>(&empty).is_err());
    }
}
