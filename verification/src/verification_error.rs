//! Errors of this crate.

use dataset::DatasetError;
use design::objective::design_problem::DesignError;
use fe_driver::{CampaignError, SolveListError};
use mesher::Tier;
use scene::SceneError;
use scene::design_run::InverseDesignError;
use std::path::PathBuf;
use support::file_error::FileError;

/// Why a task has no result.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum VerificationError {
    #[error(transparent)]
    Solve(#[from] SolveListError),
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    #[error(transparent)]
    Dataset(#[from] DatasetError),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Design(#[from] DesignError),
    #[error(transparent)]
    Run(#[from] InverseDesignError),
    #[error("cannot use {0}")]
    File(#[from] FileError),
    #[error("hinge paths need a hinge law with stiffness: the scene has level = \"pin\"")]
    NoStiffness,
    #[error("hinge {0} has no states")]
    NoStates(usize),
    #[error("at least one round is needed")]
    NoRounds,
    #[error("finite elements solved no hinge: {0}. Try another mesh with --tier")]
    NoHinge(String),
    #[error(
        "the weights were trained on the tier `{trained_on}`, which is no mesh tier: pass the \
         tier to compare with as --tier"
    )]
    NoTier { trained_on: String },
    #[error(
        "the scene has no [posture]: say how the sheet is held out of its plane, such as kind = \"held-flat\", or pass --support"
    )]
    NoPosture,
    #[error(
        "the scene does not say in which direction its sheet hangs: set posture.kind = \"hanging\" and posture.down"
    )]
    NoDown,
    #[error(
        "couples on panels have no counterpart in a whole sheet of finite elements, whose panels bend: pull panels by forces"
    )]
    Couples,
    #[error("{0}: a support that turns has no counterpart in a whole sheet of finite elements")]
    TurnedSupport(String),
    #[error(
        "the tier {0} has no structured mesh: whole sheets are meshed with tiny, small, default, fine or reference"
    )]
    NoSheetTier(Tier),
    #[error(
        "the panels are too small for windows of {least:.1} mm radius, the smallest that are meshed: use larger panels or narrower ligaments"
    )]
    NoRoom { least: f64 },
    #[error(
        "there is no panel [{column}, {row}]: the sheet has {m} columns and {n} rows, counted from 0"
    )]
    NoSuchPanel { column: usize, row: usize, m: usize, n: usize },
    #[error(
        "the patch contains a panel that is pulled by a prescribed stroke, whose load it does not know: choose another patch"
    )]
    DrivenPatch,
    #[error(
        "a patch of a hanging sheet must be held flat: its weight comes on before the loads. Use --support held-flat"
    )]
    HangingPatch,
    #[error("whole sheets need supports and loads: the scene has level = \"pin\"")]
    NoLoads,
    #[error("the campaign has no region of rays")]
    NoRegion,
    #[error(
        "every ray failed: read a job's log in {0}, fix the cause, then run `kirigami campaign run --retry`"
    )]
    EveryRayFailed(PathBuf),
}
