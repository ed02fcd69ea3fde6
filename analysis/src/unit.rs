//! The units of what is computed of a sheet.

use serde::{Serialize, Serializer};
use std::fmt;

/// A unit, written as its symbol; none for texts, counts and ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are the units")]
pub enum Unit {
    None,
    Millimetre,
    Radian,
    Kilogram,
    Newton,
    NewtonMillimetre,
    NewtonPerMillimetre,
    NewtonMillimetrePerRadian,
    Percent,
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::None => "",
            Self::Millimetre => "mm",
            Self::Radian => "rad",
            Self::Kilogram => "kg",
            Self::Newton => "N",
            Self::NewtonMillimetre => "N mm",
            Self::NewtonPerMillimetre => "N/mm",
            Self::NewtonMillimetrePerRadian => "N mm/rad",
            Self::Percent => "%",
        })
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
