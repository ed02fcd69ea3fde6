//! Why an attempt at a solve has failed.

use crate::calculix::dat::DatError;
use crate::sheet::invalid_sheet_problem::InvalidSheetProblem;
use hinge::InvalidMaterial;
use mesher::MeshError;
use std::process::ExitStatus;
use support::file_error::FileError;
use support::program::ToolError;

/// Why a solve has no samples, or only samples of a part of the path.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SolveError {
    #[error(transparent)]
    Material(#[from] InvalidMaterial),
    #[error("the end of the ray contains a number that is not finite: {0:?}")]
    Ray(hinge::HingeDeformation),
    #[error(transparent)]
    Sheet(#[from] InvalidSheetProblem),
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Solver(#[from] ToolError),
    #[error("the solver refused its input ({status})\nthe end of its log:\n{tail}")]
    NotStarted { status: ExitStatus, tail: String },
    #[error(
        "the solver ended with {status} and says neither that it has finished nor why not\nthe end of its log:\n{tail}"
    )]
    Silent { status: ExitStatus, tail: String },
    #[error("the solver diverged at lambda = {lambda}\nthe end of its log:\n{tail}")]
    Diverged { lambda: f64, tail: String },
    #[error("the solver reports success, but its output ends at lambda = {lambda}")]
    Truncated { lambda: f64 },
    #[error(
        "the solver's output and its status file disagree on the increment at lambda = {lambda}"
    )]
    Skipped { lambda: f64 },
    #[error(transparent)]
    Output(#[from] DatError),
    #[error(
        "the energy and the work of the whole ray differ by {residual:.2e} of the energy \
         (limit {MAX_ENERGY_RESIDUAL})"
    )]
    EnergyImbalance { residual: f64 },
    #[error(transparent)]
    File(#[from] FileError),
}

/// Maximum |W - work| / W accepted at the end of a complete path. A partial path is not checked;
/// its samples contain the residual.
pub(crate) const MAX_ENERGY_RESIDUAL: f64 = 0.01;

impl SolveError {
    /// Whether the attempt was stopped on request.
    pub fn is_stop(&self) -> bool {
        matches!(
            self,
            Self::Solver(ToolError::Stopped { .. })
                | Self::Mesh(MeshError::Gmsh(ToolError::Stopped { .. }))
        )
    }
}
