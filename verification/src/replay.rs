//! The hinges of a sheet solved along their paths in it, and compared with a surrogate at every
//! load step.

use crate::recorded_path::RecordedPath;
use crate::verification_error::VerificationError;
use dataset::ComparedState;
use fe_driver::{SolveService, WindowSolve};
use hinge::{HingeDeformation, HingeSample, SheetMaterial};
use mesher::Tier;
use serde::Serialize;
use std::fmt;
use surrogate::Surrogate;

/// One hinge, by the surrogate and by finite elements.
pub struct ReplayedHinge {
    /// Its states, in the order of the load steps.
    pub states: Vec<ComparedState>,
    /// Fraction of the states inside the training domain.
    pub inside: f64,
}

/// The hinges of a sheet, by a surrogate and by finite elements.
pub struct Replay {
    /// The design, for a person.
    pub name: String,
    /// Mesh tier of the windows.
    pub tier: Tier,
    /// The hinges that finite elements followed along their paths.
    pub hinges: Vec<ReplayedHinge>,
    /// The others.
    pub unsolved: Vec<UnsolvedHinge>,
}

/// A hinge of a sheet that finite elements did not follow along its path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnsolvedHinge {
    /// Number of the hinge.
    pub hinge: usize,
    /// Its window, why it was not solved, and the folder of its last attempt.
    pub reason: String,
}

impl fmt::Display for UnsolvedHinge {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "hinge {}: {}", self.hinge, self.reason)
    }
}

/// Finite elements for the hinges of sheets.
#[derive(Clone, Copy)]
pub struct ElementWindows<'a> {
    /// Tier of the meshes.
    pub tier: Tier,
    /// Solves the windows.
    pub service: &'a SolveService<'a>,
}

/// Hinges of a sheet, solved along their paths.
#[derive(Default)]
pub(crate) struct SolvedPaths {
    /// The states of every hinge by finite elements; `None` if it was not solved.
    pub samples: Vec<Option<Vec<HingeSample>>>,
    /// The hinges that were not.
    pub unsolved: Vec<UnsolvedHinge>,
    /// CPU time of the windows (s).
    pub cpu_seconds: f64,
}

impl ElementWindows<'_> {
    /// Solves hinges along their paths; an error if none is solved.
    pub(crate) fn solve(
        &self,
        paths: &[RecordedPath],
        material: &SheetMaterial,
    ) -> Result<SolvedPaths, VerificationError> {
        let versions = self.service.versions();
        let solve = |path: &RecordedPath| {
            let problem = path.problem(material, self.tier)?;
            Ok::<_, VerificationError>(WindowSolve::new(problem, &versions))
        };
        let solves: Vec<WindowSolve> = paths.iter().map(solve).collect::<Result<_, _>>()?;
        let mut solved = SolvedPaths::default();
        for (path, window) in paths.iter().zip(self.service.solve(&solves)?) {
            solved.cpu_seconds += window.record.cpu_seconds;
            match window.complete() {
                Ok(samples) => solved.samples.push(Some(samples.clone())),
                Err(failed) => {
                    solved.samples.push(None);
                    solved
                        .unsolved
                        .push(UnsolvedHinge { hinge: path.hinge, reason: failed.to_string() });
                }
            }
        }
        match &solved.unsolved[..] {
            [first, ..] if solved.unsolved.len() == paths.len() => {
                Err(VerificationError::NoHinge(first.to_string()))
            }
            _ => Ok(solved),
        }
    }
}

impl Replay {
    /// Compares a surrogate with the solved windows of hinges of the scene along their paths in the
    /// design, which has a name for a person.
    pub fn new(
        windows: &ElementWindows,
        (paths, name): (Vec<RecordedPath>, &str),
        material: &SheetMaterial,
        surrogate: &Surrogate,
    ) -> Result<Self, VerificationError> {
        let solved = windows.solve(&paths, material)?;
        let hinges = paths.into_iter().zip(solved.samples);
        let hinges = hinges
            .filter_map(|(path, samples)| Some(ReplayedHinge::new(&path, &samples?, surrogate)))
            .collect();
        Ok(Self { name: name.to_owned(), tier: windows.tier, hinges, unsolved: solved.unsolved })
    }

    /// The states of each hinge.
    pub(crate) fn groups(&self) -> Vec<&[ComparedState]> {
        self.hinges.iter().map(|hinge| &hinge.states[..]).collect()
    }
}

impl ReplayedHinge {
    fn new(path: &RecordedPath, solved: &[HingeSample], surrogate: &Surrogate) -> Self {
        let count = path.states.len();
        let computed = (1..=count).map(|k| HingeSample::at(solved, k as f64 / count as f64));
        let designs = vec![path.design; count];
        let predicted = surrogate.samples(&designs, &path.states);
        let domain = surrogate.domain();
        let inside = |state: &HingeDeformation| domain.contains(&path.design, state);
        // Damage grows along the path: it is not known once a state was outside the training
        // domain.
        let left = path.states.iter().position(|state| !inside(state));
        let known = |(k, value): (usize, &HingeSample)| match left {
            Some(left) if k >= left => HingeSample { d: f64::NAN, d_peak: None, ..*value },
            _ => *value,
        };
        let states = (predicted.iter().enumerate().map(known))
            .zip(computed)
            .filter_map(|(value, reference)| Some(ComparedState::new(&value, &reference?)))
            .collect();
        Self {
            inside: path.states.iter().filter(|state| inside(state)).count() as f64 / count as f64,
            states,
        }
    }
}
