//! The ladder of attempts at a solve.

use serde::{Deserialize, Serialize};

/// The attempts in their order, each made after an earlier one has failed by the mechanics or the
/// mesh of the problem. Which of them are made is for each kind of problem to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::Display)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum AttemptKind {
    /// The solve as requested.
    Requested,
    /// Shorter increments on the same mesh.
    ShorterIncrements,
    /// Shorter increments on the next finer mesh.
    FinerTier,
    /// With inertia, which carries a sheet over a snap that has no static path.
    Dynamic,
}
