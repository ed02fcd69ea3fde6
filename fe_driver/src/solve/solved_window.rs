//! The result of a window solve: its samples, or why and where it failed.

use crate::solve::hinge_path::HingePath;
use crate::solve::solve_folder::{SolveFolder, SolveRecord, SolveState};
use crate::solve::window_solve::WindowSolve;
use hinge::HingeSample;
use std::fmt;
use std::path::PathBuf;
use support::file_error::FileError;

/// A solve with its record and its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedWindow {
    /// Id of the solve.
    pub id: String,
    /// What was to be solved.
    pub solve: WindowSolve,
    /// How it ended.
    pub record: SolveRecord,
    /// One sample per converged increment of the attempt that reached furthest; empty without one.
    pub samples: Vec<HingeSample>,
    /// Folder of its last attempt, which remains if the solve failed.
    pub work: PathBuf,
}

/// A window that was not solved to the end of its path.
#[derive(Clone, Debug, PartialEq)]
pub struct UnsolvedWindow {
    /// The hinge and its path.
    pub hinge: HingePath,
    /// Number of attempts.
    pub attempts: u32,
    /// Lambda of the last converged increment of any attempt.
    pub lambda: f64,
    /// The error of the last attempt.
    pub reason: String,
    /// Folder of the last attempt, with its deck and its log.
    pub work: PathBuf,
}

impl SolveFolder {
    /// The closed solve with its samples; `None` if it is not closed.
    pub(crate) fn result(&self) -> Result<Option<SolvedWindow>, FileError> {
        let SolveState::Ended(ended) = self.state()? else {
            return Ok(None);
        };
        let (solve, record) = *ended;
        if !record.is_closed() {
            return Ok(None);
        }
        let samples = match record.rows {
            0 => Vec::new(),
            _ => self.samples(&record)?,
        };
        Ok(Some(SolvedWindow {
            id: solve.id(),
            solve,
            record,
            samples,
            work: self.work(),
        }))
    }
}

impl SolvedWindow {
    /// The samples, or why the path was not followed to its end.
    pub fn complete(&self) -> Result<&[HingeSample], Box<UnsolvedWindow>> {
        match self.record.failure {
            None => Ok(&self.samples),
            Some(failure) => Err(Box::new(UnsolvedWindow {
                hinge: self.solve.problem.hinge.clone(),
                attempts: self.record.attempts,
                lambda: self.record.lambda,
                reason: (self.record.message.clone()).unwrap_or_else(|| failure.to_string()),
                work: self.work.clone(),
            })),
        }
    }

    /// Fraction of the wall time, from mesh to samples, in which the solver did not run.
    pub fn overhead(&self) -> f64 {
        1.0 - self.record.solver_seconds / self.record.wall_seconds
    }
}

impl fmt::Display for UnsolvedWindow {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let HingePath { design, path } = &self.hinge;
        let end = path.at(1.0);
        let [eta_a, eta_s] = end.eta(design.w_lig);
        // The first line: the others quote the end of the solver's log, which is in the folder.
        let reason = self.reason.lines().next().unwrap_or_default();
        write!(
            f,
            "w_lig {:.2} mm, alpha {:.1} deg, path to (eta_a, eta_s, theta) = ({eta_a:.3}, {eta_s:.3}, {:.2} deg): {reason} \
             ({} attempts, the furthest to lambda = {:.3}; {})",
            design.w_lig,
            design.alpha.to_degrees(),
            end.theta.to_degrees(),
            self.attempts,
            self.lambda,
            self.work.display()
        )
    }
}
