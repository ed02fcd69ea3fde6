//! The result of a solve: its samples, or why and where it failed.

use crate::{Solve, SolveFolder, SolveRecord, SolveState, WindowSolve};
use std::path::PathBuf;
use support::fault;
use support::fault::Fault;
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
    pub fn complete(&self) -> Result<&S::Samples, Fault> {
        let Self { solve, record, work, .. } = self;
        let Some(failure) = record.failure else {
            return Ok(&self.samples);
        };
        let message = record.message.clone().unwrap_or_else(|| failure.to_string());
        // The first line: the others quote the end of the solver's log, which is in the folder.
        let reason = message.lines().next().unwrap_or_default();
        Err(fault!(
            "{}: {reason} ({} attempts, the furthest to lambda = {:.3}; {})",
            solve.description(),
            record.attempts,
            record.lambda,
            work.display()
        ))
    }
}
