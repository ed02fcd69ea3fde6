//! What a program that solves must do; CalculiX is one, the fake of the tests another.

use crate::{
    AttemptKind, FailureKind, SolveError, SolveFolder, SolveRecord, SolveState, WindowSolve,
    short_hash,
};
use hinge::HingeSample;
use mesher::Tier;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use support::{Fault, FileError, fault};

/// A program that solves problems of one kind. Attempts run in parallel.
pub trait Solver<S: Solve = WindowSolve>: Sync {
    /// The versions that are a part of the identity of its solves.
    fn versions(&self) -> ToolVersions;

    /// Makes one attempt at a solve in the folder `work`, where its inputs, its log and its output
    /// remain.
    ///
    /// It is terminated after `limit`, and soon after `stop` becomes true. If the path stops early,
    /// at the time limit or by a signal, its converged increments are returned. An error means that
    /// nothing was solved, or that the attempt was stopped on request.
    fn attempt(
        &self,
        solve: &S,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution<S::Samples>, SolveError>;
}

impl<S: Solve, T: Solver<S> + ?Sized> Solver<S> for &T {
    fn versions(&self) -> ToolVersions {
        (**self).versions()
    }

    fn attempt(
        &self,
        solve: &S,
        work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution<S::Samples>, SolveError> {
        (**self).attempt(solve, work, limit, stop)
    }
}

/// The result of an attempt: samples, and whether they reach the end of the path.
#[derive(Debug, Default)]
pub struct Solution<P = Vec<HingeSample>> {
    /// The converged increments, in order of lambda; empty if the output is not valid.
    pub samples: P,
    /// Why the samples are not the samples of a valid complete path; `None` for a complete path.
    pub stopped: Option<SolveError>,
    /// Number of elements of the mesh.
    pub elements: usize,
    /// User and system time of the solver (s), if the operating system reports it.
    pub cpu_seconds: Option<f64>,
    /// Wall time from the mesh to the samples (s).
    pub wall_seconds: f64,
    /// Wall time of the solver (s), a part of `wall_seconds`; zero if it was terminated.
    pub solver_seconds: f64,
    /// Maximum resident memory of the solver (MiB), if the operating system reports it.
    pub peak_memory_mib: Option<f64>,
    /// Newton iterations, including the iterations of cut-back increments.
    pub iterations: usize,
}

/// Versions of the external programs that determine a result.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, derive_more::Display)]
#[display("gmsh {gmsh} and ccx {ccx}")]
pub struct ToolVersions {
    /// Version of gmsh.
    pub gmsh: String,
    /// Version of CalculiX.
    pub ccx: String,
}

// What a kind of finite-element problem must state, so that it can be solved, attempted again and
// kept.

/// A finite-element problem with everything that determines its result: two problems of one id have
/// the same result.
pub trait Solve: Clone + Debug + PartialEq + Send + Sync + Serialize + DeserializeOwned {
    /// What is kept of its converged increments.
    type Samples: SolvedPath;

    /// The id: 16 hexadecimal digits, a hash of the problem.
    fn id(&self) -> String {
        short_hash(self)
    }

    /// Tier of its mesh.
    fn tier(&self) -> Tier;

    /// The problem in a line, for a person.
    fn description(&self) -> String;

    /// The attempt after `attempt`, which `failure` ended; `None` if there is none left. `lambda`
    /// is the furthest that any attempt has reached.
    fn next_attempt(
        &self,
        attempt: AttemptKind,
        failure: FailureKind,
        lambda: f64,
    ) -> Option<AttemptKind>;

    /// What is solved in an attempt.
    fn attempted(&self, attempt: AttemptKind) -> Self;
}

/// The converged increments of a solve, in order of lambda.
pub trait SolvedPath: Clone + Debug + Default + PartialEq + Send {
    /// Name of its file in the folder of a solve.
    const FILE: &'static str;

    /// Number of increments.
    fn len(&self) -> usize;

    /// Whether no increment converged.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Lambda of the last increment; 0 without any.
    fn reached(&self) -> f64;

    /// The contents of the file, from which every number is read back exactly.
    fn to_bytes(&self) -> io::Result<Vec<u8>>;

    /// Reads the contents of the file; an error of the kind [`io::ErrorKind::InvalidData`] if they
    /// are damaged.
    fn from_bytes(bytes: &[u8]) -> io::Result<Self>;
}

impl SolvedPath for Vec<HingeSample> {
    const FILE: &'static str = "rows.csv";

    fn len(&self) -> usize {
        self.len()
    }

    fn reached(&self) -> f64 {
        self.last().map_or(0.0, |last| last.lambda)
    }

    fn to_bytes(&self) -> io::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for sample in self {
            writer.serialize(sample)?;
        }
        Ok(writer.into_inner().expect("a vector takes every byte"))
    }

    fn from_bytes(bytes: &[u8]) -> io::Result<Self> {
        let rows = csv::Reader::from_reader(bytes).into_deserialize();
        rows.collect::<Result<_, csv::Error>>()
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
    }
}

// The result of a solve: its samples, or why and where it failed.

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
