//! An error that no caller tells from another: it is read by a person.

use std::fmt::Display;
use std::path::Path;

/// What is wrong, after its place (a file, line, key or job) and before what to do, each behind a
/// colon. An error that a caller matches is a variant of an enum instead.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Fault(String);

/// The [`Fault`] with a message, written as for [`format!`].
#[macro_export]
macro_rules! fault {
    ($($message:tt)*) => {
        $crate::fault::Fault::from(format!($($message)*))
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

/// Maps the error of reading `path`, for use in `map_err`.
pub fn unread<E: Display>(path: &Path) -> impl FnOnce(E) -> Fault {
    move |error| fault!("cannot read {}: {error}", path.display())
}

/// Maps the error of writing `path`, for use in `map_err`.
pub fn unwritten<E: Display>(path: &Path) -> impl FnOnce(E) -> Fault {
    move |error| fault!("cannot write {}: {error}", path.display())
}
