//! An error that no caller tells from another: it is read by a person.

use std::fmt;
use std::path::Path;

/// Where something is wrong (a file, line, key or job), what is wrong, and what to do. Empty texts
/// are left out of the message. An error that a caller matches is a variant of an enum instead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The place, such as `supports[2].panel`.
    pub place: String,
    /// The mistake, with its values and units.
    pub what: String,
    /// The remedy, in the imperative.
    pub remedy: String,
}

/// The fault at `place`.
pub fn fault(
    place: impl Into<String>,
    what: impl Into<String>,
    remedy: impl Into<String>,
) -> Fault {
    Fault { place: place.into(), what: what.into(), remedy: remedy.into() }
}

impl From<String> for Fault {
    /// A mistake in words, without a place.
    fn from(what: String) -> Self {
        fault("", what, "")
    }
}

impl From<&str> for Fault {
    fn from(what: &str) -> Self {
        what.to_owned().into()
    }
}

/// The fault that another error describes, for use in `map_err`.
pub fn said(error: impl fmt::Display) -> Fault {
    error.to_string().into()
}

/// Maps an error at a place, such as a file or a key, for use in `map_err`.
pub fn at<E: fmt::Display>(place: impl fmt::Display) -> impl FnOnce(E) -> Fault {
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

/// Returns the fault with a message, given as to `format!`.
#[macro_export]
macro_rules! refuse {
    ($($message:tt)+) => {
        return Err($crate::Fault::from(format!($($message)+)).into())
    };
}

/// Maps the error of reading `path`, for use in `map_err`.
pub fn unread<E: fmt::Display>(path: &Path) -> impl FnOnce(E) -> Fault {
    move |error| format!("cannot read {}: {error}", path.display()).into()
}

/// Maps the error of writing `path`, for use in `map_err`.
pub fn unwritten<E: fmt::Display>(path: &Path) -> impl FnOnce(E) -> Fault {
    move |error| format!("cannot write {}: {error}", path.display()).into()
}

impl fmt::Display for Fault {
    fn fmt(&self, text: &mut fmt::Formatter) -> fmt::Result {
        let Self { place, what, remedy } = self;
        let texts = [place, what, remedy].map(String::as_str);
        let said = texts.into_iter().filter(|text| !text.is_empty());
        text.write_str(&said.collect::<Vec<_>>().join(": "))
    }
}

impl std::error::Error for Fault {}

#[cfg(test)]
mod tests {
    use super::fault;

    #[test]
    fn empty_texts_are_left_out() {
        let whole = fault("supports", "a sheet without supports has no equilibrium", "add one");
        assert_eq!(
            whole.to_string(),
            "supports: a sheet without supports has no equilibrium: add one"
        );
        assert_eq!(fault("", "no rows", "").to_string(), "no rows");
    }
}
