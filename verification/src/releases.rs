//! Hinges deformed along straight rays and unloaded, by finite elements: the deformation without
//! forces and the stiffness about it.
//!
//! The window of a hinge is driven, and where it is without forces is not known before. Its path
//! leads to the state that it reaches, back to a guess of that deformation, and from there to and
//! fro in a, s and theta. Unloading is elastic (and yields the other way where residual stresses
//! are large): forces on this tour give the stiffness, and Newton's method the next guess, in a
//! window that is deformed again from the flat state. A guess too far back, at which the hinge has
//! yielded the other way, shows by a step that is hardly shorter than the one before: then the next
//! guess is half as far from the reached state.

use crate::verification_error::VerificationError;
use faer::linalg::solvers::{Llt, Solve};
use faer::{Col, Mat, Side};
use fe_driver::{DeformationPath, HingePath, SolveService, WindowProblem, WindowSolve};
use hinge::{HingeDeformation, HingeDesign, HingeSample, ReleasedHinge, ReleasedSample};
use hinge::{Regime, SheetMaterial};
use mesher::Tier;
use std::array::from_fn;

/// Unloaded hinges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Releases {
    /// One row a hinge, in the order of the list.
    pub rows: Vec<ReleasedSample>,
    /// Why the others have none.
    pub failed: Vec<String>,
    /// CPU time of all windows (s).
    pub cpu_seconds: f64,
    /// Number of windows.
    pub windows: usize,
}

/// Most windows of a hinge.
const ROUNDS: usize = 12;
/// A guess is good if Newton's step from it is shorter than this part of its distance from the
/// reached state: what the step leaves is of second order.
const ENOUGH: f64 = 0.05;
/// A step is no longer than this part of the distance of the reached state from the flat one.
const LONGEST_STEP: f64 = 0.5;
/// A step that is longer than this part of the one before is not made.
const SHORTENS: f64 = 0.7;
/// Amplitudes of the tour in eta_a, eta_s and theta (rad); smaller about a guess closer to the
/// reached state than [`FAR`].
const AMPLITUDES: [f64; 3] = [0.02, 0.02, 0.05];
/// Distance of the guess from the reached state in (eta_a, eta_s, theta) from which on the tour has
/// its amplitudes.
const FAR: f64 = 0.1;
/// Numbers of legs to the reached state and back; the tour has two for each direction. All have the
/// same number of increments.
const LEGS: [usize; 2] = [10, 4];

/// Unloads hinges at the end of their rays. `guess` is where they are expected to be without
/// forces.
pub fn releases(
    windows: &SolveService,
    hinges: &[HingePath],
    material: &SheetMaterial,
    tier: Tier,
    guess: impl Fn(&HingeDesign, &HingeDeformation) -> HingeDeformation,
) -> Result<Releases, VerificationError> {
    let versions = windows.versions();
    let mut found = Releases::default();
    let mut rows = vec![None; hinges.len()];
    let mut open: Vec<Released> = (hinges.iter().enumerate())
        .map(|(index, HingePath { design, path })| {
            let (design, reached) = (*design, path.at(1.0));
            Released {
                index,
                design,
                reached,
                guess: guess(&design, &reached),
                step: f64::INFINITY,
            }
        })
        .collect();
    for _ in 0..ROUNDS {
        let problem = |hinge: &Released| WindowProblem::new(hinge.path(), material, tier);
        let solves: Vec<WindowSolve> =
            (open.iter()).map(|hinge| WindowSolve::new(problem(hinge), &versions)).collect();
        let solved = windows.solve(&solves)?;
        found.windows += solved.len();
        let mut further = Vec::new();
        for (hinge, window) in open.into_iter().zip(&solved) {
            found.cpu_seconds += window.record.cpu_seconds;
            let next = match window.complete() {
                Ok(samples) => hinge.next(samples),
                Err(unsolved) => Next::Failed(unsolved.to_string()),
            };
            match next {
                Next::Row(row) => rows[hinge.index] = Some(row),
                Next::Guess(guess, step) => further.push(Released { guess, step, ..hinge }),
                Next::Failed(reason) => found.failed.push(reason),
            }
        }
        open = further;
    }
    let unknown =
        |hinge: &Released| format!("{}: forces remain after {ROUNDS} windows", hinge.name());
    found.failed.extend(open.iter().map(unknown));
    found.rows = rows.into_iter().flatten().collect();
    Ok(found)
}

/// Where a hinge is expected without forces before anything is known: films spring back nearly to
/// the flat state.
pub fn first_guess(
    material: &SheetMaterial,
    design: &HingeDesign,
    reached: &HingeDeformation,
) -> HingeDeformation {
    match material.regime(design.w_lig) {
        Regime::Film => reached.at(0.3),
        Regime::Plate => reached.at(0.75),
    }
}

/// A hinge on its way to the deformation without forces.
#[derive(Clone, Copy)]
struct Released {
    index: usize,
    design: HingeDesign,
    reached: HingeDeformation,
    guess: HingeDeformation,
    /// Length of the step to the guess; infinite without one.
    step: f64,
}

/// The hinge that a window measures.
enum Next {
    Row(ReleasedSample),
    /// And the length of Newton's step to it.
    Guess(HingeDeformation, f64),
    Failed(String),
}

impl Released {
    /// To the reached state, back to the guess, and to and fro about it.
    fn path(&self) -> HingePath {
        let [out, back] = LEGS;
        let guess = self.guess.to_array();
        let mut states: Vec<_> =
            (1..=out).map(|k| self.reached.at(k as f64 / out as f64)).collect();
        states.extend((0..back).rev().map(|k| self.towards_reached(k as f64 / back as f64)));
        let amplitude = (self.distance() / FAR).min(1.0);
        for i in 0..3 {
            let mut away = guess;
            away[i] += amplitude * AMPLITUDES[i] * self.lengths()[i];
            states.extend([away.into(), self.guess]);
        }
        HingePath {
            design: self.design,
            path: DeformationPath::through(&states).expect("the path has legs"),
        }
    }

    /// For a person.
    fn name(&self) -> String {
        format!(
            "w_lig {:.2} mm, alpha {:.1} deg, unloaded at theta {:.1} deg",
            self.design.w_lig,
            self.design.alpha.to_degrees(),
            self.reached.theta.to_degrees()
        )
    }

    /// Units of (a, s, theta).
    fn lengths(&self) -> [f64; 3] {
        [self.design.w_lig, self.design.w_lig, 1.0]
    }

    /// Length of a vector in units of (w_lig, w_lig, 1).
    fn length(&self, of: [f64; 3]) -> f64 {
        let squares = (0..3).map(|i| (of[i] / self.lengths()[i]).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// Distance of the guess from the reached state, in units of (w_lig, w_lig, 1).
    fn distance(&self) -> f64 {
        let (guess, reached) = (self.guess.to_array(), self.reached.to_array());
        self.length(from_fn(|i| reached[i] - guess[i]))
    }

    /// The state at a part of the way from the guess to the reached state.
    fn towards_reached(&self, share: f64) -> HingeDeformation {
        let (guess, reached) = (self.guess.to_array(), self.reached.to_array());
        from_fn(|i| guess[i] + share * (reached[i] - guess[i])).into()
    }

    fn next(&self, samples: &[HingeSample]) -> Next {
        let [out, back] = LEGS;
        let all = (out + back + 6) as f64;
        let tour = (out + back) as f64 / all - 1e-9;
        let tour: Vec<_> = samples.iter().filter(|at| at.lambda >= tour).collect();
        let (Some((forces, stiffness)), Some(reached)) =
            (self.response(&tour), HingeSample::at(samples, out as f64 / all))
        else {
            return Next::Failed(format!(
                "{}: the tour about the guess has no stiffness",
                self.name()
            ));
        };
        let step = solved(stiffness, forces.map(|force| -force));
        let Some(step) = step.filter(|step| self.length(*step) < SHORTENS * self.step) else {
            let middle = self.towards_reached(0.5);
            return Next::Guess(middle, f64::INFINITY);
        };
        let guess = self.guess.to_array();
        let length = self.length(step);
        let longest = LONGEST_STEP * self.length(self.reached.to_array());
        let made = (longest / length).min(1.0);
        let rest: HingeDeformation = from_fn(|i| guess[i] + made * step[i]).into();
        if length > ENOUGH * self.distance() {
            return Next::Guess(rest, length);
        }
        Next::Row(ReleasedSample::new(
            &self.design,
            &self.reached,
            &reached.forces(),
            reached.d_peak,
            &ReleasedHinge { rest, stiffness },
        ))
    }

    /// Forces at the guess and the symmetric stiffness about it, by least squares; moments count as
    /// forces at w_lig.
    fn response(&self, tour: &[&HingeSample]) -> Option<([f64; 3], [[f64; 3]; 3])> {
        /// Places of (K_aa, K_as, K_a theta, K_ss, K_s theta, K_theta theta) among the nine
        /// unknowns.
        const STIFFNESS: [[usize; 3]; 3] = [[3, 4, 5], [4, 6, 7], [5, 7, 8]];
        let lengths = self.lengths();
        let guess = self.guess.to_array();
        let mut normal = Mat::<f64>::zeros(9, 9);
        let mut right = Col::<f64>::zeros(9);
        for at in tour {
            let state = at.deformation().to_array();
            let moved: [f64; 3] = from_fn(|i| (state[i] - guess[i]) / lengths[i]);
            for (i, force) in at.forces().to_array().into_iter().enumerate() {
                let mut row = [0.0; 9];
                row[i] = 1.0;
                (0..3).for_each(|j| row[STIFFNESS[i][j]] += moved[j]);
                for (p, x) in row.into_iter().enumerate() {
                    right[p] += x * force * lengths[i];
                    (0..9).for_each(|q| normal[(p, q)] += x * row[q]);
                }
            }
        }
        let found = Llt::new(normal.as_ref(), Side::Lower).ok()?.solve(right);
        let forces = from_fn(|i| found[i] / lengths[i]);
        let stiffness =
            from_fn(|i| from_fn(|j| found[STIFFNESS[i][j]] / (lengths[i] * lengths[j])));
        Some((forces, stiffness))
    }
}

/// The solution of a symmetric system; `None` unless its matrix is positive definite.
pub(crate) fn solved(matrix: [[f64; 3]; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    let matrix = Mat::from_fn(3, 3, |i, j| matrix[i][j]);
    let factor = Llt::new(matrix.as_ref(), Side::Lower).ok()?;
    let found = factor.solve(Col::from_fn(3, |i| right[i]));
    Some(from_fn(|i| found[i]))
}
