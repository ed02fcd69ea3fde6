//! The units of what is computed of a sheet.

use serde::{Serialize, Serializer};

/// A unit, written as its symbol; none for texts, counts and ratios.
#[derive(Clone, Copy, Debug, PartialEq, derive_more::Display)]
#[allow(missing_docs, reason = "the names are the units")]
pub enum Unit {
    #[display("")]
    None,
    #[display("mm")]
    Millimetre,
    #[display("rad")]
    Radian,
    #[display("kg")]
    Kilogram,
    #[display("N")]
    Newton,
    #[display("N mm")]
    NewtonMillimetre,
    #[display("N/mm")]
    NewtonPerMillimetre,
    #[display("N mm/rad")]
    NewtonMillimetrePerRadian,
    #[display("%")]
    Percent,
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
