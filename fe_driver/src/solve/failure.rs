//! Why an attempt failed: the message of the solver on the problem, or what happened on the
//! machine.

use serde::{Deserialize, Serialize};
use strum::VariantNames;
use support::fault::Fault;

/// Why a solve has no samples, or only samples of a part of its path. Records and tables use its
/// name.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    strum::Display,
    strum::EnumString,
    strum::VariantNames,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
#[strum(parse_err_ty = Fault, parse_err_fn = unknown)]
pub enum FailureKind {
    /// The design, the material or the path is impossible.
    InvalidInput,
    /// gmsh failed, or its mesh was rejected.
    MeshFailed,
    /// The solver refused its input deck.
    NotStarted,
    /// The increment fell below the allowed minimum.
    Diverged,
    /// Terminated at the time limit.
    TimedOut,
    /// Terminated because it wrote a file that is larger than any result.
    TooMuchOutput,
    /// Energy and work disagree.
    EnergyImbalance,
}

/// What ended an attempt before the end of its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The problem, as far as its solver says: the next step of the ladder may help.
    Problem(FailureKind),
    /// The machine: the solver was killed, or its output is damaged or missing. The same attempt
    /// may succeed.
    Machine,
    /// A request to stop.
    Stop,
    /// What would end every other attempt too: a missing tool, a full disk.
    Run,
}

/// The error for a name that is no kind of failure.
fn unknown(name: &str) -> Fault {
    let known = FailureKind::VARIANTS.join(", ");
    Fault::from(format!("unknown failure `{name}`; choose one of {known}"))
}

impl FailureKind {
    /// Whether the mechanics of the solve caused the failure: another run of the same attempts ends
    /// there again.
    pub(crate) fn is_repeatable(self) -> bool {
        matches!(self, Self::Diverged | Self::EnergyImbalance)
    }
}
