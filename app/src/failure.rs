//! Why a work did not come to its end.

/// A run that was stopped before its work was finished.
#[derive(Debug, thiserror::Error)]
#[error("stopped with {left} {what} left; run the same command again to continue")]
pub struct Unfinished {
    /// Number of items left.
    pub left: usize,
    /// The items, in the plural.
    pub what: &'static str,
}

/// The error and its causes, each printed once.
pub fn message(error: &anyhow::Error) -> String {
    error.chain().fold(String::new(), |text, cause| match cause.to_string() {
        cause if text.contains(&cause) => text,
        cause if text.is_empty() => cause,
        cause => format!("{text}: {cause}"),
    })
}
