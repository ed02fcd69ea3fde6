//! The hinges of a sheet solved along their paths in it, and compared with a surrogate at every load step.

use crate::recorded_path::RecordedPath;
use crate::verification_error::VerificationError;
use dataset::ComparedState;
use fe_driver::{SolveService, Solved, WindowSolve};
use hinge::{HingeDeformation, HingeSample, SheetMaterial};
use mesher::Tier;
use serde::Serialize;
use std::fmt;
use surrogate::Surrogate;

/// One hinge, by the surrogate and by finite elements.
pub struct ReplayedHinge {
    /// The hinge with its path.
    pub path: RecordedPath,
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

impl ElementWindows<'_> {
    /// The windows of hinges solved along their paths, in the same order.
    pub(crate) fn solve(
        &self,
        paths: &[RecordedPath],
        material: &SheetMaterial,
    ) -> Result<Vec<Solved>, VerificationError> {
        let versions = self.service.versions();
        let solve = |path: &RecordedPath| {
            let problem = path.problem(material, self.tier)?;
            Ok::<_, VerificationError>(WindowSolve::new(problem, &versions))
        };
        let solves: Vec<WindowSolve> = paths.iter().map(solve).collect::<Result<_, _>>()?;
        Ok(self.service.solve(&solves)?)
    }
}

impl Replay {
    /// Compares a surrogate with the solved windows of hinges of the scene along their paths in the design, which has a
    /// name for a person.
    pub fn new(
        windows: &ElementWindows,
        (paths, name): (Vec<RecordedPath>, &str),
        material: &SheetMaterial,
        surrogate: &Surrogate,
    ) -> Result<Self, VerificationError> {
        let solved = windows.solve(&paths, material)?;
        let (mut hinges, mut unsolved) = (Vec::new(), Vec::new());
        for (path, window) in paths.into_iter().zip(&solved) {
            match window.complete() {
                Ok(samples) => hinges.push(ReplayedHinge::new(path, samples, surrogate)),
                Err(failed) => unsolved.push(UnsolvedHinge {
                    hinge: path.hinge,
                    reason: failed.to_string(),
                }),
            }
        }
        if let [failed, ..] = &unsolved[..]
            && hinges.is_empty()
        {
            return Err(VerificationError::NoHingeReplayed(failed.to_string()));
        }
        Ok(Self {
            name: name.to_owned(),
            tier: windows.tier,
            hinges,
            unsolved,
        })
    }

    /// The states of each hinge.
    pub fn groups(&self) -> Vec<&[ComparedState]> {
        self.hinges.iter().map(|hinge| &hinge.states[..]).collect()
    }
}

impl ReplayedHinge {
    fn new(path: RecordedPath, solved: &[HingeSample], surrogate: &Surrogate) -> Self {
        let count = path.states.len();
        let computed = (1..=count).map(|k| HingeSample::at(solved, k as f64 / count as f64));
        let designs = vec![path.design; count];
        let predicted = surrogate.samples(&designs, &path.states);
        let domain = surrogate.domain();
        let inside = |state: &HingeDeformation| domain.contains(&path.design, state);
        // Damage grows along the path: it is not known once a state was outside the training domain.
        let left = path.states.iter().position(|state| !inside(state));
        let known = |(k, value): (usize, &HingeSample)| match left {
            Some(left) if k >= left => HingeSample {
                d: f64::NAN,
                d_peak: None,
                ..*value
            },
            _ => *value,
        };
        let states = (predicted.iter().enumerate().map(known))
            .zip(computed)
            .filter_map(|(value, reference)| Some(ComparedState::new(&value, &reference?)))
            .collect();
        Self {
            inside: path.states.iter().filter(|state| inside(state)).count() as f64 / count as f64,
            path,
            states,
        }
    }
}
