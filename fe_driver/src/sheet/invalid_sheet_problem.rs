//! Errors of sheet problems.

/// Why a sheet problem cannot be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum InvalidSheetProblem {
    #[error("panel {0} has no nodes where it is held or pulled")]
    NoPanel(usize),
    #[error("nothing pulls the sheet: it needs a load")]
    NoLoad,
    #[error("no panel is held: the sheet is free to move")]
    NothingHeld,
    #[error(
        "nothing keeps the sheet in its plane, and no panel is clamped: it would fall out of it; clamp a panel, or hold it flat"
    )]
    Falls,
}
