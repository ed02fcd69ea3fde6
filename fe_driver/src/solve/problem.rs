//! What a kind of finite-element problem must state, so that it can be solved, attempted again and
//! kept.

use crate::{AttemptKind, FailureKind, short_hash};
use hinge::HingeSample;
use mesher::Tier;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Debug;
use std::io;

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
