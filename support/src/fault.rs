//! Errors that no caller distinguishes, for people to read, and errors of files.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

/// What is wrong, after its place (a file, line, key or job) and before what to do, each behind a
/// colon. An error that a caller matches is a variant of an enum instead.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct Fault(String);

/// The [`Fault`] with a message, written as for [`format!`].
#[macro_export]
macro_rules! fault {
    ($($message:tt)*) => {
        $crate::Fault::from(format!($($message)*))
    };
}

/// Returns the [`Fault`] with a message, written as for [`format!`], or an error made of it.
#[macro_export]
macro_rules! refuse {
    ($($message:tt)*) => {
        return Err($crate::fault!($($message)*).into())
    };
}

impl From<String> for Fault {
    fn from(message: String) -> Self {
        Self(message)
    }
}

/// The fault that another error describes, for use in `map_err`.
pub fn said(error: impl Display) -> Fault {
    error.to_string().into()
}

/// Maps an error at a place, such as a file or a key, for use in `map_err`.
pub fn at<E: Display>(place: impl Display) -> impl FnOnce(E) -> Fault {
    move |error| format!("{place}: {error}").into()
}

/// Returns the fault with a message, given as to `format!`, unless a condition holds.
#[macro_export]
macro_rules! ensure {
    ($holds:expr, $($message:tt)+) => {
        if !$holds {
            $crate::refuse!($($message)+);
        }
    };
}

/// Maps the error of reading `path`, for use in `map_err`.
pub fn unread<E: Display>(path: &Path) -> impl FnOnce(E) -> Fault {
    move |error| fault!("cannot read {}: {error}", path.display())
}

/// Maps the error of writing `path`, for use in `map_err`.
pub fn unwritten<E: Display>(path: &Path) -> impl FnOnce(E) -> Fault {
    move |error| fault!("cannot write {}: {error}", path.display())
}

/// A file that cannot be read, written or parsed.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {source}", path = .path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// Why the operation on the file failed.
    pub source: io::Error,
}

impl FileError {
    /// Maps the error of an operation on `path`, for use in `map_err`.
    pub fn at<E: Into<io::Error>>(path: &Path) -> impl FnOnce(E) -> Self {
        let path = path.to_owned();
        move |source| Self { path, source: source.into() }
    }
}

impl From<FileError> for Fault {
    fn from(FileError { path, source }: FileError) -> Self {
        fault!("{}: {source}", path.display())
    }
}
