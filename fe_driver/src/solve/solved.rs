//! The result of a solve: its samples, or why and where it failed.

use crate::{Solve, SolveFolder, SolveRecord, SolveState, WindowSolve};
use std::fmt;
use std::path::PathBuf;
use support::file_error::FileError;

/// A solve with its record and its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Solved<S: Solve = WindowSolve> {
    /// Id of the solve.
    pub id: String,
    /// What was to be solved.
    pub solve: S,
    /// How it ended.
    pub record: SolveRecord,
    /// The converged increments of the attempt that reached furthest; empty without one.
    pub samples: S::Samples,
    /// Folder of its last attempt, which remains if the solve failed.
    pub work: PathBuf,
}

/// What was not solved to the end of its path.
#[derive(Clone, Debug, PartialEq)]
pub struct Unsolved<S: Solve = WindowSolve> {
    /// What was to be solved.
    pub solve: S,
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
    pub(crate) fn result<S: Solve>(&self) -> Result<Option<Solved<S>>, FileError> {
        let SolveState::<S>::Ended(ended) = self.state()? else {
            return Ok(None);
        };
        let (solve, record) = *ended;
        if !record.is_closed() {
            return Ok(None);
        }
        let samples = match record.rows {
            0 => S::Samples::default(),
            _ => self.samples::<S>(&record)?,
        };
        Ok(Some(Solved { id: solve.id(), solve, record, samples, work: self.work() }))
    }
}

impl<S: Solve> Solved<S> {
    /// The samples, or why the path was not followed to its end.
    pub fn complete(&self) -> Result<&S::Samples, Box<Unsolved<S>>> {
        match self.record.failure {
            None => Ok(&self.samples),
            Some(failure) => Err(Box::new(Unsolved {
                solve: self.solve.clone(),
                attempts: self.record.attempts,
                lambda: self.record.lambda,
                reason: (self.record.message.clone()).unwrap_or_else(|| failure.to_string()),
                work: self.work.clone(),
            })),
        }
    }
}

impl<S: Solve> fmt::Display for Unsolved<S> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        // The first line: the others quote the end of the solver's log, which is in the folder.
        let reason = self.reason.lines().next().unwrap_or_default();
        write!(
            f,
            "{}: {reason} ({} attempts, the furthest to lambda = {:.3}; {})",
            self.solve.description(),
            self.attempts,
            self.lambda,
            self.work.display()
        )
    }
}
